//! The canvas room while two documents are compared, and what stands over the picture then.

use super::Compare;
use crate::core::documents::DocumentEvent;
use crate::core::event::Event;
use crate::core::shown::Sides;
use crate::core::state::{Select, State};
use crate::rooms::canvas::{Canvas, Mark};
use crate::rooms::viewport::Compared;
use crate::widgets::theme;
use coif_graphs::document::NodeId;
use egui::{Align, Label, Layout, Rect, RichText, ScrollArea, Ui, UiBuilder, Vec2};

/// Height of what stands over each canvas, points.
const CAPTION: f32 = 22.0;
/// Between the parts of the room.
const GAP: f32 = 4.0;
/// The list takes this share of the room, and no more and no less than these: beside the canvases, or below.
const SHARE: f32 = 0.3;
const BESIDE: (f32, f32) = (190.0, 380.0);
const BELOW: (f32, f32) = (70.0, 200.0);

/// Where the parts of the room are: two canvases of one size with their captions, and the list.
fn parts(room: Rect) -> ([Rect; 2], Rect) {
    let is_wide = room.width() > 2.0 * room.height();
    let (canvases, list) = if is_wide {
        let width = (room.width() * SHARE).clamp(BESIDE.0, BESIDE.1).min(room.width() * 0.5);
        room.split_left_right_at_x(room.right() - width)
    } else {
        let height = (room.height() * SHARE).clamp(BELOW.0, BELOW.1).min(room.height() * 0.5);
        room.split_top_bottom_at_y(room.bottom() - height)
    };
    let (left, right) = canvases.split_left_right_at_fraction(0.5);
    let size = (left.size() - Vec2::splat(GAP)).max(Vec2::ZERO);
    ([left, right].map(|half| Rect::from_min_size(half.min, size)), list)
}

impl Compare {
    /// The room: one's own canvas at the left, the other's at the right, and what differs.
    pub(crate) fn ui(
        &mut self,
        mine: &State,
        canvas: &mut Canvas,
        ui: &mut Ui,
        out: &mut Vec<Event>,
    ) {
        let room = ui.available_rect_before_wrap();
        let ([left, right], list) = parts(room);
        self.bring_into_sight(mine, canvas);
        let below = |rect: Rect| {
            let caption = CAPTION.min(rect.height());
            rect.split_top_bottom_at_y(rect.top() + caption)
        };
        let (caption, place) = below(left);
        says(ui, caption, "yours", &mine.file.name());
        part(ui, "yours", place, |ui| canvas.ui(mine, ui, out));
        self.canvas.see_as(canvas);
        let (caption, place) = below(right);
        says(ui, caption, &self.name, "only to look at");
        part(ui, "other", place, |ui| self.canvas.ui(&self.other, ui, &mut vec![]));
        if canvas.see_as(&self.canvas) {
            ui.ctx().request_repaint();
        }
        part(ui, "differences", list, |ui| self.list(mine, ui, out));
        if !std::mem::replace(&mut self.is_fitted, true) {
            // Once the canvases know their sizes.
            canvas.look_at_all();
            ui.ctx().request_repaint();
        }
    }

    fn list(&mut self, mine: &State, ui: &mut Ui, out: &mut Vec<Event>) {
        ui.horizontal_wrapped(|ui| {
            // First, so that it is seen in the smallest window.
            let close = ui.button("End").on_hover_text("Show your document alone again");
            if close.clicked() {
                out.push(Event::Act("compare.end"));
            }
            self.sides_buttons(ui, out);
            let alike = match () {
                () if self.lines.is_empty() => "the same groom",
                () if self.same_hair => "the same hair",
                () => return,
            };
            ui.label(RichText::new(alike).color(theme::DONE.of(ui)));
        });
        let heading = match self.is_before {
            true => "Changed since it was saved:".to_owned(),
            false => format!("Different in {}:", self.name),
        };
        if !self.lines.is_empty() {
            ui.add(Label::new(RichText::new(heading).weak()).truncate());
        }
        let mut chosen = None;
        ScrollArea::vertical().auto_shrink(false).min_scrolled_height(16.0).show(ui, |ui| {
            for line in &self.lines {
                ui.horizontal_top(|ui| {
                    self.mark_of(line.node.as_ref()).show(ui);
                    match &line.node {
                        None => drop(ui.add(Label::new(&line.text).wrap())),
                        Some(id) => {
                            ui.style_mut().wrap_mode = Some(egui::TextWrapMode::Wrap);
                            let line =
                                ui.link(&line.text).on_hover_text("Show it on both canvases");
                            if line.clicked() {
                                chosen = Some(id.clone());
                            }
                        }
                    }
                });
            }
        });
        if let Some(id) = chosen {
            self.choose(mine, id, out);
        }
    }

    /// How a line's node differs.
    fn mark_of(&self, id: Option<&NodeId>) -> Mark {
        let of = |n: usize| self.marks[n].nodes.get(id?).copied();
        of(0).or_else(|| of(1)).unwrap_or(Mark::Changed)
    }

    /// Selects a node in both, and brings it into sight.
    fn choose(&mut self, mine: &State, id: NodeId, out: &mut Vec<Event>) {
        let nodes: Vec<NodeId> =
            mine.document.nodes.contains_key(&id).then(|| id.clone()).into_iter().collect();
        out.push(Event::Select(Select::Nodes(nodes)));
        let there: Vec<NodeId> =
            self.document.nodes.contains_key(&id).then(|| id.clone()).into_iter().collect();
        self.other.selection.change(Select::Nodes(there));
        self.other.group = id.group().filter(|group| self.document.nodes.contains_key(group));
        self.frames = Some(id);
    }

    /// Brings the node that was chosen into sight of both canvases, wherever each has it.
    fn bring_into_sight(&mut self, mine: &State, canvas: &mut Canvas) {
        let Some(id) = self.frames.take() else { return };
        let places = [canvas.place(mine, &id), self.canvas.place(&self.other, &id)];
        if let Some(part) = places.into_iter().flatten().reduce(Rect::union) {
            canvas.look_at_part(part.expand(60.0));
        }
    }

    fn sides_buttons(&self, ui: &mut Ui, out: &mut Vec<Event>) {
        for (sides, label, tip) in [
            (Sides::Own, "Yours", "Show your groom's hair (F8 switches)"),
            (
                Sides::Other,
                "Its hair",
                "Show the other groom's hair with the same camera (F8 switches)",
            ),
            (Sides::Wipe, "Wipe", "Show both in one picture, with a divider to drag between them"),
            (Sides::Beside, "Side by side", "Show one beside the other, with one camera"),
        ] {
            if theme::choice(ui, self.sides == sides, label).on_hover_text(tip).clicked() {
                out.push(Event::Documents(DocumentEvent::Sides(sides)));
            }
        }
    }

    /// How the picture shows both, and how that is said.
    pub(crate) fn told(&self) -> Compared {
        let name = self.name.clone();
        let said = match (self.sides, &self.other.shown) {
            (Sides::Own, _) => ("Shown: yours".to_owned(), theme::TEXT),
            (Sides::Other, Some(_)) => (format!("Shown: {name}"), theme::ACCENT),
            (Sides::Wipe | Sides::Beside, Some(_)) => {
                (format!("Shown: yours and {name}"), theme::ACCENT)
            }
            (_, None) => {
                let why = if self.answered { "has nothing to show" } else { "is being made" };
                (format!("Shown: yours; {name} {why}"), theme::WARNING)
            }
        };
        Compared { sides: self.sides, name, said }
    }
}

/// A part of the room.
fn part(ui: &mut Ui, name: &str, place: Rect, add: impl FnOnce(&mut Ui)) {
    let layout = Layout::top_down(Align::LEFT);
    ui.scope_builder(UiBuilder::new().id_salt(name).max_rect(place).layout(layout), |ui| {
        ui.set_clip_rect(place.intersect(ui.clip_rect()));
        add(ui);
    });
}

/// What stands over a canvas.
fn says(ui: &mut Ui, place: Rect, what: &str, more: &str) {
    part(ui, what, place, |ui| {
        ui.horizontal(|ui| {
            ui.add(Label::new(RichText::new(what).strong()).truncate());
            ui.add(Label::new(RichText::new(more).weak()).truncate());
        });
    });
}
