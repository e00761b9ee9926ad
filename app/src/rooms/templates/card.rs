//! A template as a card: its picture with its name, to press on, to drag into the canvas.

use super::pictures::{Pictures, Thumbnail};
use crate::core::templates::{DraggedTemplate, Listed, ShelfRow};
use crate::widgets::theme;
use egui::{
    Align2, Color32, Context, CursorIcon, DragAndDrop, FontId, Id, Key, LayerId, Order, Pos2, Rect,
    Sense, Ui, Vec2, pos2, vec2,
};

/// Room between cards.
pub(super) const GAP: f32 = 6.0;
/// The width of a card that is gone for.
const WIDTH: f32 = 112.0;
/// What stands under a picture: two lines.
const WORDS: f32 = 34.0;

/// What was done to a card.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Said {
    Nothing,
    Chosen,
    Added,
}

/// How many cards there are in a line.
pub(super) fn columns(width: f32) -> usize {
    ((width - 10.0 + GAP) / (WIDTH + GAP)).round().clamp(1.0, 12.0) as usize
}

/// The size of a card: together they take the width that there is.
pub(super) fn size(width: f32, columns: usize) -> Vec2 {
    let side = (width - GAP * (columns - 1) as f32) / columns as f32;
    vec2(side, side.min(256.0) + WORDS)
}

/// How far to scroll so that a line stands in the middle.
pub(super) fn offset(line: usize, height: f32, room: f32) -> f32 {
    (line as f32 * (height + GAP) - (room - height) / 2.0).max(0.0)
}

/// Shows one; says what was done to it.
pub(super) fn show(
    ui: &mut Ui,
    row: &ShelfRow,
    (key, chosen, size): (&str, bool, Vec2),
    pictures: &mut Pictures,
) -> Said {
    let (_, rect) = ui.allocate_space(size);
    let response = ui.interact(rect, Id::new(("template", key)), Sense::click_and_drag());
    let title = row.title().to_owned();
    response.widget_info(|| {
        egui::WidgetInfo::selected(egui::WidgetType::SelectableLabel, true, chosen, &title)
    });
    let fill = match (chosen, response.hovered() || response.has_focus()) {
        (true, _) => theme::SELECTED.of(ui),
        (false, true) => theme::RAISED.of(ui),
        (false, false) => theme::GROUND.of(ui),
    };
    let painter = ui.painter().with_clip_rect(ui.clip_rect().intersect(rect));
    painter.rect_filled(rect, 4.0, fill);
    let picture =
        Rect::from_min_size(rect.min, vec2(rect.width(), rect.height() - WORDS)).shrink(4.0);
    let side = picture.size().min_elem();
    let square = Rect::from_center_size(picture.center(), Vec2::splat(side));
    let words = |text: &str, at: Pos2, size: f32, colour: Color32| {
        let font = FontId::proportional(size);
        let mut job = egui::text::LayoutJob::simple_singleline(text.to_owned(), font, colour);
        job.wrap = egui::text::TextWrapping::truncate_at_width((rect.width() - 8.0).max(8.0));
        let galley = painter.layout_job(job);
        painter.galley(at - vec2(galley.size().x / 2.0, 0.0), galley, colour);
    };
    let under = pos2(rect.center().x, picture.bottom() + 3.0);
    match row {
        ShelfRow::Found(it) => {
            let text = match pictures.of(key, it, ui.ctx()) {
                Thumbnail::Here(texture) => {
                    let [w, h] = texture.size().map(|side| side as f32);
                    let fit = vec2(w, h) * (side / w.max(h));
                    let uv = Rect::from_min_max(Pos2::ZERO, pos2(1.0, 1.0));
                    let at = Rect::from_center_size(square.center(), fit);
                    painter.image(texture.id(), at, uv, Color32::WHITE);
                    ""
                }
                Thumbnail::Later => "…",
                Thumbnail::None => "no picture",
                Thumbnail::Damaged => "⚠ damaged picture",
            };
            if !text.is_empty() {
                painter.rect_filled(square, 2.0, theme::SUNKEN.of(ui));
                words(text, square.center() - vec2(0.0, 6.0), 11.0, theme::QUIET.of(ui));
            }
            words(&title, under, 13.0, theme::TEXT.of(ui));
            let version = format!("{} · {}", it.origin.version, place_of(it));
            words(&version, under + vec2(0.0, 16.0), 11.0, theme::QUIET.of(ui));
        }
        ShelfRow::Broken(it) => {
            painter.rect_filled(square, 2.0, theme::SUNKEN.of(ui));
            painter.text(
                square.center(),
                Align2::CENTER_CENTER,
                "⚠",
                FontId::proportional(22.0),
                theme::WARNING.of(ui),
            );
            words(&title, under, 13.0, theme::WARNING.of(ui));
            words(&it.why, under + vec2(0.0, 16.0), 11.0, theme::QUIET.of(ui));
        }
    }
    if response.has_focus() {
        painter.rect_stroke(
            rect,
            4.0,
            egui::Stroke::new(1.0, theme::ACCENT.of(ui)),
            egui::StrokeKind::Inside,
        );
    }
    if let ShelfRow::Found(it) = row
        && response.drag_started()
    {
        response.dnd_set_drag_payload(DraggedTemplate {
            template: it.clone(),
            picture: pictures.of(key, it, ui.ctx()).texture(),
        });
    }
    let enter = response.has_focus() && ui.input(|input| input.key_pressed(Key::Enter));
    let said =
        match (response.double_clicked() || enter, response.clicked() || response.drag_started()) {
            (true, _) => Said::Added,
            (false, true) => Said::Chosen,
            (false, false) => Said::Nothing,
        };
    response.on_hover_text(tip(row));
    said
}

fn place_of(it: &Listed) -> &str {
    if it.path.is_none() { "coif" } else { &it.place }
}

fn tip(row: &ShelfRow) -> String {
    match row {
        ShelfRow::Found(it) => {
            let tags = it.origin.tags.join(", ");
            if tags.is_empty() {
                it.description.clone()
            } else {
                format!("{}\n{tags}", it.description)
            }
        }
        ShelfRow::Broken(it) => it.why.clone(),
    }
}

impl Thumbnail<'_> {
    fn texture(self) -> Option<egui::TextureHandle> {
        match self {
            Thumbnail::Here(texture) => Some(texture.clone()),
            _ => None,
        }
    }
}

/// Draws the template in the hand at the pointer, which lies over the canvas or elsewhere; Escape lets go of it.
pub(crate) fn carried(ctx: &Context, over: bool) {
    let Some(held) = DragAndDrop::payload::<DraggedTemplate>(ctx) else { return };
    if ctx.input(|input| input.key_pressed(Key::Escape)) {
        DragAndDrop::clear_payload(ctx);
        return;
    }
    ctx.set_cursor_icon(if over { CursorIcon::Copy } else { CursorIcon::NoDrop });
    let Some(at) = ctx.pointer_latest_pos() else { return };
    let painter = ctx.layer_painter(LayerId::new(Order::Tooltip, Id::new("template in the hand")));
    let rect = Rect::from_min_size(at + vec2(10.0, 10.0), Vec2::splat(64.0));
    painter.rect_filled(rect.expand(2.0), 4.0, theme::SELECTED.of(ctx));
    match &held.picture {
        Some(texture) => {
            let uv = Rect::from_min_max(Pos2::ZERO, pos2(1.0, 1.0));
            painter.image(texture.id(), rect, uv, Color32::WHITE);
        }
        None => {
            let font = FontId::proportional(11.0);
            painter.text(
                rect.center(),
                Align2::CENTER_CENTER,
                &held.template.title,
                font,
                theme::TEXT.of(ctx),
            );
        }
    }
}
