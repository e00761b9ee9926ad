//! The history room: every step in words, the present one marked. A click goes there, and what the step changed is
//! selected. A step that becomes the present one is brought into sight.

use crate::core::event::Event;
use crate::core::state::{Select, State};
use crate::widgets::theme;
use egui::{RichText, ScrollArea};

/// Shows the room.
pub(crate) fn ui(state: &State, ui: &mut egui::Ui, out: &mut Vec<Event>) {
    let done = state.history.done();
    let steps: Vec<_> = state.history.steps().collect();
    ui.horizontal(|ui| {
        for (word, tip, event, can) in [
            ("Undo", "Undo the last step", Event::Undo, done > 0),
            ("Redo", "Redo it", Event::Redo, done < steps.len()),
        ] {
            if ui.add_enabled(can, egui::Button::new(word)).on_hover_text(tip).clicked() {
                out.push(event);
            }
        }
        ui.label(RichText::new(format!("{done} of {} steps", steps.len())).weak());
    });
    ui.separator();
    let height = ui.spacing().interact_size.y;
    // Whoever scrolls stays where they are until another step is the present one. A frame may be laid out more than once.
    let (kept, frame) = (ui.id().with("present step"), ui.ctx().cumulative_frame_nr());
    // Where lines become higher, they lie elsewhere.
    let now = (done, steps.len(), height.to_bits());
    let is_new = ui.data_mut(|data| {
        let since = data.get_temp_mut_or_insert_with(kept, || (now, frame));
        if since.0 != now {
            *since = (now, frame);
        }
        since.1 == frame
    });
    ScrollArea::vertical().auto_shrink(false).show_rows(ui, height, steps.len() + 1, |ui, rows| {
        if is_new {
            let line = height + ui.spacing().item_spacing.y;
            let top = ui.max_rect().top() + line * (done as f32 - rows.start as f32);
            let lines = egui::Rangef::new(top - line, top + 2.0 * line);
            let lines = egui::Rect::from_x_y_ranges(ui.max_rect().x_range(), lines);
            ui.scroll_to_rect_animation(lines, None, egui::style::ScrollAnimation::none());
        }
        for at in rows {
            let words = match at.checked_sub(1).and_then(|at| steps.get(at)) {
                Some(step) => step.words.clone(),
                None => "As it was opened".to_owned(),
            };
            let mark = if at == done { "▶ " } else { "" };
            let mut text = RichText::new(format!("{mark}{words}"));
            if at > done {
                text = text.color(theme::QUIET.of(ui)).italics();
            }
            let line = ui.selectable_label(at == done, text);
            if line.on_hover_text("Go to the state after this step").clicked() {
                out.push(Event::Jump(at));
                let changed = at.checked_sub(1).and_then(|at| steps.get(at));
                let nodes = changed.map(|step| step.nodes().into_iter().collect());
                out.extend(nodes.map(|nodes| Event::Select(Select::Nodes(nodes))));
            }
        }
    });
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::core::room::Room;
    use crate::core::state::OpenFile;
    use crate::editor::Editor;
    use coif_graphs::document::edit::Edit;
    use coif_graphs::document::{Document, NodeId};
    use egui_kittest::Harness;
    use egui_kittest::kittest::Queryable;

    #[test]
    fn the_present_step_is_in_sight_wherever_it_is() {
        let context = egui::Context::default();
        let mut editor = Editor::new(&context, Document::default(), OpenFile::default());
        for seed in 1..200 {
            editor.apply(Event::Edit(Edit::SetSeed(seed)));
        }
        editor.apply(Event::Show(Room::History));
        let mut ui = Harness::builder()
            .with_size(egui::vec2(1366.0, 768.0))
            .build_ui_state(|ui, editor: &mut Editor| editor.ui(ui), editor);
        for to in [199, 0, 120, 121, 199] {
            ui.state_mut().apply(Event::Jump(to));
            ui.run_steps(30);
            let room = ui.state().place_of(Room::History).expect("the room is shown");
            let marked = ui.get_by_label_contains("▶ ").rect();
            assert!(room.contains_rect(marked), "step {to} is at {marked:?}, the room {room:?}");
        }
        // Scrolling away is left alone.
        ui.state_mut().apply(Event::Jump(0));
        ui.run_steps(30);
        let room = ui.state().place_of(Room::History).expect("the room is shown");
        ui.event(egui::Event::PointerMoved(room.center()));
        let (unit, delta) = (egui::MouseWheelUnit::Line, egui::vec2(0.0, -40.0));
        let (modifiers, phase) = (egui::Modifiers::NONE, egui::TouchPhase::Move);
        ui.event(egui::Event::MouseWheel { unit, delta, modifiers, phase });
        ui.run_steps(30);
        assert!(ui.query_by_label_contains("▶ ").is_none(), "it was scrolled out of sight");
    }

    #[test]
    fn a_click_goes_to_a_step_and_selects_what_it_changed() {
        let context = egui::Context::default();
        let mut editor = Editor::new(&context, Document::default(), OpenFile::default());
        let ids = ["a", "b", "c"].map(|id| NodeId::new(id).unwrap());
        for id in &ids {
            let node = editor.state.document.fresh_node("resample", id).into();
            editor.apply(Event::Edit(Edit::AddNode { id: id.clone(), node, at: None }));
        }
        editor.apply(Event::Show(Room::History));
        let words: Vec<String> =
            editor.state.history.steps().map(|step| step.words.clone()).collect();
        let mut ui = Harness::builder()
            .with_size(egui::vec2(1400.0, 900.0))
            .build_ui_state(|ui, editor: &mut Editor| editor.ui(ui), editor);
        ui.step();
        ui.get_by_label("3 of 3 steps");
        ui.get_by_label(&format!("▶ {}", words[2]));
        ui.get_by_label(&words[1]).click();
        ui.run_steps(2);
        let state = &ui.state().state;
        assert_eq!((state.history.done(), state.selection.active.as_ref()), (2, Some(&ids[1])));
        ui.get_by_label("As it was opened").click();
        ui.run_steps(2);
        assert!(ui.state().state.document.nodes.is_empty());
        ui.get_by_label("0 of 3 steps");
        ui.get_by_label(&words[2]).click();
        ui.run_steps(2);
        assert_eq!(ui.state().state.document.nodes.len(), 3);
    }
}
