//! The menu bar, the status line and the sheet of keys: all from the table of actions.

use super::Editor;
use super::Event;
use super::actions::{self, Entry, MENUS};
use super::documents;
use super::keys::name_of;
use crate::core::room::Room;
use crate::core::state::Select;
use crate::rooms::viewport::input::drags;
use crate::widgets::text::spoken;
use crate::widgets::{panel, theme};
use coif_graphs::document::NodeId;
use coif_nodes::define::NodeDef;
use egui::{Button, Panel, RichText};

/// The menu bar on top.
pub(crate) fn bar(editor: &mut Editor, ui: &mut egui::Ui) {
    let mut picked = None;
    Panel::top("menus").show(ui, |ui| {
        // Where the window is narrower than the menus, they scroll.
        egui::ScrollArea::horizontal().show(ui, |ui| {
            egui::MenuBar::new().ui(ui, |ui| {
                for menu in MENUS {
                    let all: Vec<Entry> = actions::all().filter(|a| a.menu == *menu).collect();
                    if all.is_empty() {
                        continue;
                    }
                    ui.menu_button(*menu, |ui| {
                        panel::list(ui, |ui| entries(editor, &all, &mut picked, ui));
                    });
                }
            });
        });
    });
    if let Some(action) = picked {
        editor.act(action);
    }
}

/// What a menu lists: entries of a group together, in a menu of their own where the first of them stands.
fn entries(editor: &Editor, all: &[Entry], picked: &mut Option<&'static str>, ui: &mut egui::Ui) {
    for (at, action) in all.iter().enumerate() {
        match action.group() {
            None => entry(editor, action, picked, ui),
            Some(group) if all[..at].iter().any(|before| before.group() == Some(group)) => {}
            Some(group) => {
                panel::submenu(ui, group, |ui| {
                    let own = all.iter().filter(|action| action.group() == Some(group));
                    own.for_each(|action| entry(editor, action, picked, ui));
                });
            }
        }
    }
}

fn entry(editor: &Editor, action: &Entry, picked: &mut Option<&'static str>, ui: &mut egui::Ui) {
    let allowed = action.when(editor);
    let keys = editor.keys.of(action.id).map(|k| name_of(&k));
    let mut button = Button::new(action.label);
    if let Some(keys) = keys {
        button = button.shortcut_text(keys);
    }
    let response = ui
        .add_enabled(allowed.is_ok(), button)
        .on_hover_text(action.tip)
        .on_disabled_hover_text(allowed.err().unwrap_or_default());
    if response.clicked() {
        *picked = Some(action.id);
        ui.close();
    }
}

/// The line at the bottom: what runs, what is written, what was said just now. Its height never changes, whatever it says.
pub(crate) fn status(editor: &mut Editor, ui: &mut egui::Ui) {
    let mut out = vec![];
    Panel::bottom("status").show(ui, |ui| {
        ui.horizontal(|ui| {
            ui.set_min_height(ui.spacing().interact_size.y);
            let run = &editor.state.run;
            match run.since {
                Some(since) => {
                    let seconds = since.elapsed().as_secs_f32();
                    let left = editor.state.left_to_run();
                    let text = format!("evaluating {left}, {seconds:.1} s");
                    ui.spinner();
                    ui.label(text);
                    if ui.button("Stop").on_hover_text("Keep the last picture (Escape)").clicked() {
                        editor.act("evaluate.stop");
                    }
                }
                None if run.tracing.is_some() => {
                    ui.spinner();
                    ui.label("looking for what made the hair");
                    if ui.button("Stop").on_hover_text("Stop the search (Escape)").clicked() {
                        editor.act("evaluate.stop");
                    }
                }
                None if editor.state.stale() => {
                    ui.label("stale");
                }
                None => {
                    ui.label("up to date");
                }
            }
            over_budget(editor, ui, &mut out);
            ui.separator();
            if documents::export_line(&editor.documents, ui, &mut out) {
                return;
            }
            // Old news leaves; the messages keep it.
            if let Some(note) = editor.toasts.news() {
                ui.add(
                    egui::Label::new(RichText::new(&note.text).color(theme::QUIET.of(ui)))
                        .truncate(),
                );
            }
        });
    });
    for event in out {
        editor.apply(event);
    }
}

/// What of the budget is over, with the node that takes most of it; a click selects that node.
fn over_budget(editor: &Editor, ui: &mut egui::Ui, out: &mut Vec<Event>) {
    let state = &editor.state;
    let Some(shown) = state.shown.as_ref().filter(|_| !state.stale()) else { return };
    for used in &shown.over {
        let (most, much) = (used.term.amount(used.limit), used.term.amount(used.used));
        let text =
            format!("over budget: {} {much} of {most} ({})", used.term, state.called(&used.node));
        let said = ui
            .link(RichText::new(text).color(theme::WARNING.of(ui)))
            .on_hover_text(used.to_string());
        let node = NodeId::new(&used.node).ok().filter(|_| said.clicked());
        out.extend(node.map(|id| Event::Select(Select::Nodes(vec![id]))));
    }
}

/// The keys that count in the room that keys are for, and the manual of the active node.
pub(crate) fn key_sheet(editor: &mut Editor, ctx: &egui::Context) {
    let room: Room = editor.state.focus;
    let mut open = true;
    panel::window(format!("Keys: {}", room.title()), "key sheet", ctx)
        .open(&mut open)
        .default_size([440.0, 520.0])
        .show(ctx, |ui| {
            panel::body(ui, 300.0, |ui| {
                egui::Grid::new("keys").num_columns(2).striped(true).show(ui, |ui| {
                    let drags = match room {
                        Room::Viewport => drags(editor.state.settings.navigation),
                        _ => vec![],
                    };
                    for (what, drag) in drags {
                        ui.label(what);
                        ui.monospace(format!("{drag} drag"));
                        ui.end_row();
                    }
                    for (id, keys) in editor.keys.in_room(room) {
                        let Some(action) = actions::by_id(id) else { continue };
                        let names: Vec<String> = keys.iter().map(name_of).collect();
                        if !names.is_empty() {
                            ui.label(action.label).on_hover_text(action.tip);
                            ui.monospace(names.join(", "));
                            ui.end_row();
                        }
                    }
                });
                let state = &editor.state;
                if let Some(def) = state.active().and_then(|id| state.document.def(id)) {
                    manual(def, ui);
                }
            });
        });
    editor.key_sheet = open;
}

/// The page of a node: the words of its declaration.
fn manual(def: &NodeDef, ui: &mut egui::Ui) {
    ui.separator();
    ui.heading(def.label);
    ui.label(def.doc());
    for (group, inputs) in def.groups() {
        if let Some(group) = group {
            ui.add_space(8.0);
            ui.strong(group.name());
        }
        for input in inputs {
            ui.add_space(4.0);
            ui.label(RichText::new(spoken(input.name)).color(theme::ACCENT.of(ui)));
            ui.label(input.doc());
            if let Some((least, most)) = input.hard {
                let unit = input.unit.suffix();
                ui.label(
                    RichText::new(format!("{least} to {most}{unit}")).color(theme::QUIET.of(ui)),
                );
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::core::state::OpenFile;
    use crate::testing;
    use coif_graphs::document::budget::{Budget, Term};
    use coif_graphs::document::edit::Edit;
    use egui_kittest::Harness;
    use egui_kittest::kittest::Queryable;

    #[test]
    fn what_is_over_the_budget_is_told_while_it_is_and_leads_to_its_node() {
        let text = coif_graphs::grooms::by_name("start").unwrap();
        let document = coif_graphs::file::read(text).unwrap().document;
        let mut editor = Editor::new(&egui::Context::default(), document, OpenFile::default());
        let mut budget = Budget::default();
        budget.set(Term::Points, Some(100.0)).unwrap();
        let guides = NodeId::new("guides").unwrap();
        for edit in [Edit::SetDisplay(Some(guides.clone())), Edit::SetBudget(budget)] {
            editor.apply(Event::Edit(edit));
        }
        let mut ui = Harness::builder()
            .with_size(egui::vec2(1400.0, 900.0))
            .build_ui_state(|ui, editor: &mut Editor| editor.ui(ui), editor);
        let told = "over budget: points 3500 of 100";
        testing::until(told, || {
            ui.step();
            ui.query_by_label_contains(told).is_some()
        });
        ui.get_by_label_contains(told).click();
        ui.step();
        assert_eq!(ui.state().state.active(), Some(&guides));
        ui.state_mut().apply(Event::Undo);
        testing::until("nothing is over it", || {
            ui.step();
            !ui.state().state.stale() && ui.query_by_label_contains("over budget").is_none()
        });
    }
}
