//! What made a hair, as the messages room lists it: nodes, and the strokes and gestures in them (`graphs/src/trace.rs` has the law).
//!
//! It is found beside the window, when nothing else is evaluated; a change of the groom stops it. A list stays until another hair is
//! asked for or it is closed, and says when the groom has changed since.

use crate::core::event::Event;
use crate::core::made::HairTrace;
use crate::core::room::Room;
use crate::core::state::{Select, State};
use coif_graphs::trace::{Found, Part, Traced};
use egui::{Align, Label, Layout, RichText};

/// A line of the list.
struct Row<'a> {
    part: &'a Part,
    text: String,
    tip: &'static str,
}

fn rows(made: &HairTrace) -> Vec<Row<'_>> {
    let found = made.traced.iter().flat_map(|traced| &traced.found);
    found.map(|found| row(made, found)).collect()
}

fn row<'a>(made: &'a HairTrace, Found { part, alone }: &'a Found) -> Row<'a> {
    let name = made.document.name_of(part.node());
    let text = match part {
        Part::Node(_) => name.into_owned(),
        Part::Drawn { .. } => format!("{name}: {}", part.describe(&made.document)),
    };
    let tip = match alone {
        true => "This hair depends on it. Click to select it",
        false => "This hair depends on it, or on others that do the same. Click to select it",
    };
    Row { part, text, tip }
}

/// The list, over the messages; nothing where nobody asked.
pub(crate) fn ui(state: &State, ui: &mut egui::Ui, out: &mut Vec<Event>) {
    if let Some(far) = &state.run.tracing {
        ui.horizontal(|ui| {
            ui.spinner();
            let (known, of) = (far.of - far.open, far.of);
            ui.label(format!("What made this hair: {known} of {of} parts known"));
            if ui.button("Stop").on_hover_text("Stop the search").clicked() {
                out.push(Event::Stop);
            }
        });
        ui.separator();
    }
    let Some(made) = &state.made else { return };
    let text = match &made.traced {
        Ok(Traced { hair, found, parts, evaluations, .. }) => {
            let found = found.len();
            format!(
                "Hair {hair:016x} was made by {found} of {parts} parts ({evaluations} evaluations)"
            )
        }
        Err(why) => format!("What made the hair is not known: {why}"),
    };
    ui.horizontal(|ui| {
        // First what must be in sight, then the line that is cut.
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            if ui.small_button("Close").on_hover_text("Clear the list").clicked() {
                out.push(Event::Made(None));
            }
            ui.with_layout(Layout::left_to_right(Align::Center), |ui| {
                ui.add(Label::new(RichText::new(text).strong()).truncate());
            });
        });
    });
    if made.document != state.document {
        ui.label(RichText::new("The groom has changed since.").weak());
    }
    let height = ui.available_height() * 0.6;
    egui::ScrollArea::vertical().id_salt("made").max_height(height).show(ui, |ui| {
        for row in rows(made) {
            if ui.link(row.text).on_hover_text(row.tip).clicked() {
                go_to(row.part, out);
            }
        }
    });
    ui.separator();
}

/// Selects a node, or a stroke where the pen can show it.
fn go_to(part: &Part, out: &mut Vec<Event>) {
    out.push(Event::Select(Select::Nodes(vec![part.node().clone()])));
    out.push(Event::Show(Room::Inspector));
    if let Part::Drawn { node, id, .. } = part {
        out.push(Event::PickStroke(node.clone(), *id));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::core::shown::first_output;
    use crate::core::state::OpenFile;
    use crate::editor::Editor;
    use crate::testing;
    use coif_graphs::document::NodeId;
    use coif_graphs::document::edit::Edit;
    use egui_kittest::Harness;
    use egui_kittest::kittest::Queryable;
    use std::collections::BTreeSet;

    /// The window on a groom that displays a node; what made the first hair of it is asked for and found.
    fn asked(groom: &str, display: &str) -> Harness<'static, Editor> {
        let text = coif_graphs::grooms::by_name(groom).unwrap();
        let document = coif_graphs::file::read(text).unwrap().document;
        let mut editor = Editor::new(&egui::Context::default(), document, OpenFile::default());
        let node = NodeId::new(display).unwrap();
        editor.apply(Event::Edit(Edit::SetDisplay(Some(node.clone()))));
        let mut ui = Harness::builder()
            .with_size(egui::vec2(1400.0, 900.0))
            .build_ui_state(|ui, editor: &mut Editor| editor.ui(ui), editor);
        let socket = first_output(&ui.state().state.document, &node).unwrap();
        testing::until("hair is shown", || {
            ui.step();
            let state = &ui.state().state;
            let shown = state.shown.as_ref().filter(|shown| shown.is_final() && !state.stale());
            shown.is_some_and(|shown| shown.curves_of(&socket).is_some())
        });
        let shown = ui.state().state.shown.clone().unwrap();
        let (tuft, i) = shown.curves.each().next().unwrap();
        let hair = BTreeSet::from([tuft.id(i)]);
        ui.state_mut().apply(Event::Select(Select::Curves(hair)));
        ui.state_mut().act("view.what_made");
        testing::until("it is known", || {
            ui.step();
            ui.query_all_by_label_contains(" was made by ").next().is_some()
        });
        ui
    }

    fn click(ui: &mut Harness<'static, Editor>, label: &str) {
        ui.get_all_by_label_contains(label).next().unwrap().click();
        ui.step();
    }

    #[test]
    fn what_made_a_hair_is_listed_and_each_line_leads_to_its_node() {
        let mut ui = asked("sketch_bob", "strands");
        let made = ui.state().state.made.clone().unwrap();
        let lines: Vec<String> = rows(&made).into_iter().map(|row| row.text).collect();
        assert_eq!((&*lines[0], &*lines[lines.len() - 1]), ("Head", "strands"), "{lines:?}");
        assert!(lines.iter().all(|line| ui.query_all_by_label(line).next().is_some()), "{lines:?}");
        click(&mut ui, ": gesture ");
        let state = &ui.state().state;
        let active = state.active().expect("a node is selected");
        assert_eq!(state.document.nodes[active].kind, "hair_sketch");
        assert!(state.made.is_some() && state.run.tracing.is_none());
        click(&mut ui, "Close");
        assert!(ui.state().state.made.is_none());
    }

    #[test]
    fn a_stroke_that_made_a_hair_is_picked_by_the_pen() {
        let mut ui = asked("braids", "anchors");
        let made = ui.state().state.made.clone().unwrap();
        let drawn = made.traced.as_ref().unwrap().found.iter().find_map(|found| match found.part {
            Part::Drawn { id, .. } => Some(id),
            Part::Node(_) => None,
        });
        click(&mut ui, ": stroke ");
        ui.step();
        assert_eq!(ui.state().pen.picked.strokes, drawn.into_iter().collect());
    }
}
