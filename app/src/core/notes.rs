//! What the editor says to people: one list, newest last. Nothing pops up.

use crate::widgets::theme;
use coif_graphs::document::NodeId;

/// How bad it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Gravity {
    /// Something was done.
    Note,
    /// There is a result, but not the one that was meant.
    Warning,
    /// There is none.
    Error,
}

impl Gravity {
    /// What it is called.
    pub fn name(self) -> &'static str {
        match self {
            Self::Note => "note",
            Self::Warning => "warning",
            Self::Error => "error",
        }
    }
    /// Draws its mark: a shape and a colour of its own.
    pub(crate) fn mark(self, ui: &mut egui::Ui) {
        let size = egui::Vec2::splat(ui.text_style_height(&egui::TextStyle::Body));
        let (rect, response) = ui.allocate_exact_size(size, egui::Sense::hover());
        let (middle, r) = (rect.center(), size.x * 0.32);
        let at = |x: f32, y: f32| middle + egui::vec2(x, y) * r;
        let painter = ui.painter();
        match self {
            Self::Note => {
                painter.circle_filled(middle, r * 0.6, theme::DONE.of(ui));
            }
            Self::Warning => {
                let corners = vec![at(0.0, -1.1), at(1.1, 0.9), at(-1.1, 0.9)];
                let none = egui::Stroke::NONE;
                painter.add(egui::Shape::convex_polygon(corners, theme::WARNING.of(ui), none));
            }
            Self::Error => {
                let stroke = egui::Stroke::new(2.0, theme::ERROR.of(ui));
                painter.line_segment([at(-1.0, -1.0), at(1.0, 1.0)], stroke);
                painter.line_segment([at(-1.0, 1.0), at(1.0, -1.0)], stroke);
            }
        }
        response
            .widget_info(|| egui::WidgetInfo::labeled(egui::WidgetType::Label, true, self.name()));
        response.on_hover_text(self.name());
    }
}

/// One thing said.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Note {
    /// How bad it is.
    pub gravity: Gravity,
    /// What it is about, if it is about a node.
    pub node: Option<NodeId>,
    /// Which input of it.
    pub input: Option<String>,
    /// What happened and what to do.
    pub text: String,
    /// Whether it is about the groom as it was then: a change of the groom makes it old.
    pub of_groom: bool,
}

impl Note {
    /// Something was done.
    pub fn done(text: impl Into<String>) -> Self {
        Self { gravity: Gravity::Note, node: None, input: None, text: text.into(), of_groom: false }
    }
    /// Something went wrong, but not all.
    pub fn warning(text: impl Into<String>) -> Self {
        Self { gravity: Gravity::Warning, ..Self::done(text) }
    }
    /// Something could not be done.
    pub fn error(text: impl Into<String>) -> Self {
        Self { gravity: Gravity::Error, ..Self::done(text) }
    }
    /// Shows it with its mark, as one line of a list.
    pub(crate) fn show(&self, ui: &mut egui::Ui) {
        ui.horizontal_top(|ui| {
            self.gravity.mark(ui);
            ui.add(egui::Label::new(&self.text).wrap());
        });
    }
    /// The same, about a node.
    pub fn of(self, node: NodeId) -> Self {
        Self { node: Some(node), ..self }.of_groom()
    }
    /// The same, about the groom as it is now.
    pub fn of_groom(self) -> Self {
        Self { of_groom: true, ..self }
    }
}

/// What was said since the document was opened. What nodes say is not here: it comes with each evaluation
/// (`Shown::reports`).
#[derive(Clone, Debug, Default)]
pub struct Notes {
    said: Vec<Note>,
    /// How many were ever said, and how often all were forgotten.
    count: usize,
}

/// Older notes than so many are forgotten.
const MOST: usize = 500;

impl Notes {
    /// Adds a note behind the others; one that repeats the last is listed once, but news again.
    pub fn say(&mut self, note: Note) {
        self.count += 1;
        if self.said.last() == Some(&note) {
            return;
        }
        if self.said.len() == MOST {
            self.said.remove(0);
        }
        self.said.push(note);
    }
    /// Goes up whenever something is said, or all is forgotten.
    pub fn count(&self) -> usize {
        self.count
    }
    /// Oldest first.
    pub fn all(&self) -> &[Note] {
        &self.said
    }
    /// Forgets all.
    pub fn clear(&mut self) {
        self.said.clear();
        self.count += 1;
    }
}
