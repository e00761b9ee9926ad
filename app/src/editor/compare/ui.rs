//! The canvas room while two documents are compared, and what stands over the picture then.

use super::Compare;
use crate::canvas::{Canvas, Mark};
use crate::editor::event::Event;
use crate::editor::state::{Select, State};
use crate::editor::theme;
use coif_graphs::document::NodeId;
use egui::{Align, Button, Label, Layout, Rect, RichText, ScrollArea, Ui, UiBuilder, vec2};

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
    let half = GAP * 0.5;
    let inner = if is_wide { vec2(-half, 0.0) } else { vec2(0.0, -half) };
    let left = Rect::from_min_max(left.min, left.max + inner - vec2(half, 0.0));
    let right = Rect::from_min_size(
        right.min + vec2(half, 0.0) + if is_wide { vec2(-half, 0.0) } else { vec2(0.0, 0.0) },
        left.size(),
    );
    let list = Rect::from_min_max(list.min - inner, list.max);
    ([left, right], list)
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
    }

    fn list(&mut self, mine: &State, ui: &mut Ui, out: &mut Vec<Event>) {
        ui.horizontal_wrapped(|ui| {
            self.flip_button(ui, out);
            let close = ui.button("End").on_hover_text("Shows your document alone again");
            if close.clicked() {
                out.push(Event::Act("compare.end"));
            }
            let alike = match () {
                () if self.lines.is_empty() => "the same groom",
                () if self.same_hair => "the same hair",
                () => return,
            };
            ui.label(RichText::new(alike).color(theme::DONE));
        });
        let heading = match self.is_before {
            true => "Changed since it was saved:".to_owned(),
            false => format!("Otherwise in {}:", self.name),
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
                            let button = Button::new(&line.text).frame(false).wrap();
                            let pressed = ui.add(button).on_hover_text("Shows it on both canvases");
                            if pressed.clicked() {
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

    fn flip_button(&self, ui: &mut Ui, out: &mut Vec<Event>) {
        let tip = "Shows the other's hair with the same camera, or yours again (F8)";
        let button = ui.selectable_label(self.flipped, "Its hair").on_hover_text(tip);
        if button.clicked() {
            out.push(Event::Act("compare.flip"));
        }
    }

    /// Whose hair the picture shows, over its upper right corner.
    pub(crate) fn over_the_picture(&self, picture: Rect, ui: &mut Ui, out: &mut Vec<Event>) {
        let place = picture.shrink(8.0);
        let layout = Layout::right_to_left(Align::Min);
        ui.scope_builder(
            UiBuilder::new().id_salt("whose hair").max_rect(place).layout(layout),
            |ui| {
                let (text, colour) = match (self.flipped, &self.other.shown) {
                    (false, _) => ("Hair: yours".to_owned(), theme::TEXT),
                    (true, Some(_)) => (format!("Hair: {}", self.name), theme::ACCENT),
                    (true, None) if self.answered => {
                        (format!("Hair: yours; {} has nothing to show", self.name), theme::WARNING)
                    }
                    (true, None) => {
                        (format!("Hair: yours; {} is being made", self.name), theme::WARNING)
                    }
                };
                ui.visuals_mut().widgets.inactive.weak_bg_fill =
                    egui::Color32::from_black_alpha(170);
                let button = Button::new(RichText::new(text).color(colour)).truncate();
                if ui
                    .add(button)
                    .on_hover_text("Shows the other's hair, or yours again (F8)")
                    .clicked()
                {
                    out.push(Event::Act("compare.flip"));
                }
            },
        );
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
