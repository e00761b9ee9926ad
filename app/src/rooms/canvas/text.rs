//! Text on the canvas: one line, cut off where there is no more room, and sharp at every zoom.
//!
//! egui scales what was laid out for another size, which blurs. So letters are laid out as large as
//! they come to be on the screen, and given to the scene the other way scaled.

use egui::emath::TSTransform;
use egui::epaint::TextShape;
use egui::text::{LayoutJob, TextFormat, TextWrapping};
use egui::{Color32, FontId, Galley, Painter, Pos2, Shape, Ui, Vec2};
use std::sync::Arc;

/// The most letters that are laid out.
const LONGEST: usize = 160;

/// A line of text, ready to be shown.
pub(super) struct TextLine {
    galley: Arc<Galley>,
    scale: f32,
}

/// Lays out the first line of a text, in units of the canvas.
pub(super) fn line(ui: &Ui, text: &str, size: f32, colour: Color32, room: f32) -> TextLine {
    let to_screen = ui.ctx().layer_transform_to_global(ui.layer_id());
    let scale = to_screen.map_or(1.0, |t| t.scaling).max(0.01);
    let text: String = text.lines().next().unwrap_or_default().chars().take(LONGEST).collect();
    // In half points, so that zooming does not fill the atlas with letters of every size.
    let size = ((size * scale * 2.0).round() / 2.0).max(1.0);
    let format = TextFormat::simple(FontId::proportional(size), colour);
    let mut job = LayoutJob::single_section(text, format);
    job.wrap = TextWrapping {
        max_width: (room * scale).max(1.0),
        max_rows: 1,
        break_anywhere: true,
        overflow_character: Some('\u{2026}'),
    };
    TextLine { galley: ui.painter().layout_job(job), scale }
}

impl TextLine {
    /// Width and height, in units of the canvas.
    pub(super) fn size(&self) -> Vec2 {
        self.galley.size() / self.scale
    }

    /// Whether it had no room for all of its letters.
    pub(super) fn is_cut(&self) -> bool {
        self.galley.elided
    }

    /// Paints it with its upper left corner at a place.
    pub(super) fn show(self, painter: &Painter, at: Pos2, colour: Color32) {
        let mut shape = Shape::Text(TextShape::new(Pos2::ZERO, self.galley, colour));
        if self.scale != 1.0 {
            shape.transform(TSTransform::from_scaling(1.0 / self.scale));
        }
        shape.translate(at.to_vec2());
        painter.add(shape);
    }
}
