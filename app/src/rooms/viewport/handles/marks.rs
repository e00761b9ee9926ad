//! Landmarks of the active head, to be dragged along its skin.
//!
//! All that are known are shown: one that the groom states is full, one that was guessed is a ring. A drag writes that one into the
//! head's input `landmarks` and leaves what else is there; the right button takes it out again, and it is where it is guessed.
//! Of a groom that is carried to another head they are that head's, not those of its home.
//! Guaranteed: what is written lies on the skin to 0.0001 cm. Not here: landmarks that were not found; they are set as text.

use super::{Seen, label};
use crate::core::event::Event;
use crate::core::state::State;
use crate::widgets::panel;
use crate::widgets::theme;
use coif_graphs::document::edit::Edit;
use coif_graphs::document::{NodeId, Setting, Socket};
use coif_nodes::data::landmarks::{Landmark, Landmarks};
use coif_nodes::data::scalp::Scalp;
use coif_nodes::data::sections::named_points;
use coif_nodes::define::Value;
use egui::{Color32, Key, PointerButton, Pos2, Rect, Sense, Stroke, Vec2};
use glam::Vec3;
use std::sync::Arc;

/// The input that they are stated in.
const INPUT: &str = "landmarks";

/// What is being dragged.
struct Drag {
    node: NodeId,
    mark: Landmark,
    /// From the mark to where it was taken, points.
    off: Vec2,
    /// Where the pointer was last.
    pointer: Pos2,
    /// Where it is held, cm.
    at: Vec3,
    /// The head that it is on. An evaluation that was stopped may leave none for a moment.
    scalp: Arc<Scalp>,
}

/// The landmarks of the active head.
#[derive(Default)]
pub(super) struct LandmarkHandles {
    drag: Option<Drag>,
}

/// A head whose landmarks can be dragged.
struct Head<'a> {
    node: &'a NodeId,
    scalp: Arc<Scalp>,
    /// What its input says.
    text: &'a str,
}

impl<'a> Head<'a> {
    /// The active node, where it is a head that is shown or that is being `dragged` on, and nobody else says where its landmarks are.
    fn active(state: &'a State, dragged: Option<&Drag>) -> Option<Self> {
        let id = state.active()?;
        let node = state.document.node(id.as_str()).filter(|node| node.is_head())?;
        let text = match node.inputs.get(INPUT) {
            None => "",
            Some(Setting::Known(Value::Text(text))) => &**text,
            Some(_) => return None,
        };
        let output = Socket::new(id.clone(), "scalp");
        let shown = state.shown.as_ref().and_then(|shown| shown.values.get(&output));
        let scalp = match (shown, dragged) {
            (Some(Value::Scalp(scalp)), _) => scalp.clone(),
            (_, Some(drag)) if drag.node == *id => drag.scalp.clone(),
            _ => return None,
        };
        let is_wired = !state.document.wires(id, INPUT).is_empty();
        (!is_wired).then_some(Self { node: id, scalp, text })
    }

    /// The edit that states one landmark, cm, or leaves it to be guessed.
    fn stating(&self, mark: Landmark, at: Option<Vec3>) -> Event {
        let at = at.map(|at| self.scalp.frame().head_from_point(at));
        let text = stated(self.text, mark, at);
        let (node, input) = (self.node.clone(), INPUT.to_owned());
        Event::Edit(match text.is_empty() {
            true => Edit::UnsetInput { node, input },
            false => {
                let setting = Setting::Known(Value::Text(text.into()));
                Edit::SetInput { node, input, setting }
            }
        })
    }
}

impl LandmarkHandles {
    /// Whether one is being dragged.
    pub(super) fn is_dragging(&self) -> bool {
        self.drag.is_some()
    }

    /// Draws them and takes drags of them.
    pub(super) fn ui(
        &mut self,
        state: &State,
        seen: &Seen,
        ui: &mut egui::Ui,
        out: &mut Vec<Event>,
    ) {
        let head = Head::active(state, self.drag.as_ref());
        let is_gone = |drag: &mut Drag| head.as_ref().is_none_or(|head| *head.node != drag.node);
        if self.drag.take_if(is_gone).is_some() {
            out.push(Event::End);
        }
        let Some(head) = head else { return };
        let (said, _) = Landmarks::parse(head.text);
        for (mark, at) in head.scalp.landmarks().each() {
            let held = self.drag.as_ref().filter(|drag| drag.mark == mark);
            let place = held.map_or(head.scalp.frame().point_from_head(at), |drag| drag.at);
            let Some(at) = seen.view.screen(place) else { continue };
            if held.is_some() || !seen.hides(place) {
                let is_set = said.get(mark).is_some() || held.is_some();
                self.show(&head, mark, (place, at), is_set, ui, out);
            }
        }
        self.follow(&head, seen, ui, out);
    }

    fn show(
        &mut self,
        head: &Head,
        mark: Landmark,
        (place, at): (Vec3, Pos2),
        is_set: bool,
        ui: &mut egui::Ui,
        out: &mut Vec<Event>,
    ) {
        let held = self.drag.as_ref().is_some_and(|drag| drag.mark == mark);
        let id = ui.id().with(("landmark", head.node.as_str(), mark.name()));
        let target = Rect::from_center_size(at, Vec2::splat(2.0 * super::TARGET));
        let response = ui.interact(target, id, Sense::click_and_drag());
        let how = if is_set { "set" } else { "guessed" };
        response.widget_info(|| {
            let label = format!("Landmark {}, {how}", mark.name());
            egui::WidgetInfo::labeled(egui::WidgetType::Slider, true, label)
        });
        let told = held || response.hovered();
        let colour = if told { Color32::WHITE } else { theme::ACCENT.dark };
        let fill = if is_set { colour } else { theme::GROUND.dark };
        ui.painter().circle(at, super::GRIP, fill, Stroke::new(2.0, colour));
        let text = match told {
            true => format!("{}: {how}", mark.name()),
            false => mark.name().to_owned(),
        };
        label(ui, at, text);
        if response.drag_started_by(PointerButton::Primary) {
            let pressed = ui.input(|input| input.pointer.press_origin()).unwrap_or(at);
            out.push(Event::Begin(format!("{}: moved", mark.name())));
            let (node, off) = (head.node.clone(), pressed - at);
            let scalp = head.scalp.clone();
            self.drag = Some(Drag { node, mark, off, pointer: pressed, at: place, scalp });
        }
        panel::menu_at(&response, panel::right_click(&response), |ui| {
            let again = ui.add_enabled(is_set, egui::Button::new("Guess again"));
            let again =
                again.on_hover_text(format!("Reset {} to its detected position.", mark.name()));
            if again.on_disabled_hover_text("Already at its detected position.").clicked() {
                out.push(head.stating(mark, None));
                ui.close();
            }
        });
    }

    /// Gives the dragged one the place on the skin that the pointer says.
    fn follow(&mut self, head: &Head, seen: &Seen, ui: &egui::Ui, out: &mut Vec<Event>) {
        let Some(drag) = &mut self.drag else { return };
        if ui.input_mut(|input| input.consume_key(egui::Modifiers::NONE, Key::Escape)) {
            out.push(Event::Abort);
            self.drag = None;
            return;
        }
        let (pointer, down) =
            ui.input(|input| (input.pointer.interact_pos(), input.pointer.primary_down()));
        // A press that is let go where it was states nothing.
        if let Some(pointer) = pointer.filter(|at| *at != drag.pointer) {
            drag.pointer = pointer;
            let ray = seen.view.ray(pointer - drag.off);
            if let Some(hit) = head.scalp.surface().ray(ray.origin, ray.direction, super::FAR) {
                drag.at = hit.point;
                out.push(head.stating(drag.mark, Some(hit.point)));
            }
        }
        if !down {
            out.push(Event::End);
            self.drag = None;
        }
    }
}

/// A text of landmarks in which one is stated, in head units, or no longer. The others stay as they are typed.
fn stated(text: &str, mark: Landmark, at: Option<Vec3>) -> String {
    let is_it = |entry: &str| {
        let (points, _) = named_points(entry);
        points.first().is_some_and(|(name, _)| name.to_lowercase() == mark.name())
    };
    let mut words = at.map(|at| {
        // To 0.00001, as exactly as a head of any size can tell.
        let [x, y, z] = at.to_array().map(|x| (x * 1e5).round() / 1e5 + 0.0);
        format!("{} {x} {y} {z}", mark.name())
    });
    let mut out = String::new();
    for piece in text.split_inclusive([';', '\n']) {
        let entry = piece.trim_end_matches([';', '\n']);
        if !is_it(entry) {
            out += piece;
        } else if let Some(words) = words.take() {
            let before = &entry[..entry.len() - entry.trim_start().len()];
            out += &format!("{before}{words}{}", &piece[entry.len()..]);
        }
    }
    let kept = out.trim().trim_end_matches(';').trim_end();
    match words {
        Some(words) if kept.is_empty() => words,
        Some(words) => format!("{kept}; {words}"),
        None => kept.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use coif_nodes::maths::hash::Dice;

    #[test]
    fn stating_one_landmark_leaves_all_else_of_the_text() {
        let noise = ["", "nose 0 0 9; ", "chin 1 1\n", " ;; ", "Crown 1 2 3; crown 4 5 6;"];
        for seed in 0..400 {
            let dice = Dice::new(seed, 0, "stated");
            let place =
                |k: u64| Vec3::new(dice.signed(k, 0), dice.signed(k, 1), dice.signed(k, 2)) * 14.0;
            let mut all = Landmarks::default();
            for (k, mark) in (0u64..).zip(Landmark::ALL) {
                all.set(mark, (dice.unit(k, 9) < 0.5).then(|| place(k)));
            }
            let text = format!("{}{all}", noise[seed as usize % noise.len()]);
            let mark = Landmark::ALL[(dice.unit(50, 0) * 7.99) as usize];
            let (before, _) = Landmarks::parse(&text);
            let at = place(60);
            let (set, _) = Landmarks::parse(&stated(&text, mark, Some(at)));
            let (unset, _) = Landmarks::parse(&stated(&text, mark, None));
            assert!(set.get(mark).unwrap().distance(at) < 2e-5, "{text:?} {mark:?}");
            assert_eq!(unset.get(mark), None, "{text:?} {mark:?}");
            for other in Landmark::ALL.into_iter().filter(|other| *other != mark) {
                assert_eq!(set.get(other), before.get(other), "{text:?} {mark:?} {other:?}");
                assert_eq!(unset.get(other), before.get(other), "{text:?} {mark:?} {other:?}");
            }
        }
    }

    #[test]
    fn what_else_is_typed_stays_to_the_letter() {
        let at = Some(Vec3::new(0.0, -9.25, 7.0));
        for (before, set, unset) in [
            ("", "chin 0 -9.25 7", ""),
            ("crown 0  9 -4", "crown 0  9 -4; chin 0 -9.25 7", "crown 0  9 -4"),
            ("Chin 1 1 1;\nnose 0 0 9", "chin 0 -9.25 7;\nnose 0 0 9", "nose 0 0 9"),
            ("nape 1 2; chin 1 1 1", "nape 1 2; chin 0 -9.25 7", "nape 1 2"),
        ] {
            assert_eq!(stated(before, Landmark::Chin, at), set);
            assert_eq!(stated(before, Landmark::Chin, None), unset);
        }
    }
}
