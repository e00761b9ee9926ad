//! The messages room: everything that is wrong with the groom, what its nodes said, and what was done. Errors, warnings and
//! notes differ by shape and colour; each leads to its node and can be copied.
//!
//! What a merge left to decide is there with what decides it, until it is decided.
//!
//! What is wrong with the document is said before anything runs; what nodes say is of their last run. Nothing is said
//! twice: a node whose document is wrong is not repeated as failed. Remedies are the kernel's own words.

mod made;

use crate::core::action::ActionLookup;
use crate::core::documents;
use crate::core::event::Event;
use crate::core::notes::{Gravity, Note};
use crate::core::room::Room;
use crate::core::state::{Select, State};
use crate::widgets::text::spoken;
use coif_graphs::compare::{Undecided, undecided};
use coif_graphs::document::edit::Edit;
use coif_graphs::document::graph::{Severity, check};
use coif_graphs::document::{Document, NodeId};
use coif_nodes::define::{NodeError, Type};
use egui::{Align, Label, Layout, RichText, ScrollArea};
use std::collections::BTreeSet;
use std::sync::Arc;

/// One message, as it is shown.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Message {
    /// How bad it is.
    pub gravity: Gravity,
    /// The node that it is about.
    pub node: Option<NodeId>,
    /// What people call that node, and the input.
    pub place: String,
    /// What is wrong: value, limit.
    pub text: String,
    /// What to do about it.
    pub remedy: String,
    /// How many curves it is about, of how many.
    pub curves: (usize, usize),
    /// Those of them that are known by id.
    pub ids: Vec<u64>,
    /// The input whose file is missing.
    pub missing: Option<String>,
    /// Whether a node would make more than it may.
    pub too_large: bool,
    /// What decides it, where a merge left it: what keeps ours, and what takes theirs.
    pub decides: Option<(Edit, Option<Edit>)>,
}

impl Message {
    fn new(gravity: Gravity, place: impl Into<String>, text: impl Into<String>) -> Self {
        Self {
            gravity,
            node: None,
            place: place.into(),
            text: text.into(),
            remedy: String::new(),
            curves: (0, 0),
            ids: vec![],
            missing: None,
            too_large: false,
            decides: None,
        }
    }

    /// As one line of text.
    pub(crate) fn line(&self) -> String {
        let mut line = format!("{}: ", self.gravity.name());
        if !self.place.is_empty() {
            line += &format!("{}: ", self.place);
        }
        line += &self.text;
        line += &self.curves_in_words().map_or(String::new(), |words| format!(" ({words})"));
        if !self.remedy.is_empty() {
            line += &format!("; {}", self.remedy);
        }
        line
    }

    fn curves_in_words(&self) -> Option<String> {
        let (n, of) = self.curves;
        use crate::words::{counted, grouped};
        match (n, of) {
            (0, _) => None,
            (n, of) if of >= n => Some(format!("{} of {}", grouped(n), counted(of, "curve"))),
            (n, _) => Some(counted(n, "curve")),
        }
    }
}

/// Everything that there is to say about a state, the worst first.
pub(crate) fn all(state: &State) -> Vec<Message> {
    let mut all = of_document(&state.document);
    all.extend(undecided(&state.document).into_iter().map(|left| of_merge(&state.document, left)));
    let told: BTreeSet<NodeId> = all
        .iter()
        .filter(|message| message.gravity == Gravity::Error)
        .filter_map(|message| message.node.clone())
        .collect();
    all.extend(state.notes.all().iter().rev().map(|note| of_note(&state.document, note)));
    let reports = &state.run.reports;
    for bad in &reports.refused {
        let Ok(id) = NodeId::new(&bad.node) else { continue };
        if told.contains(&id) || !state.document.nodes.contains_key(&id) {
            continue;
        }
        let mut message = about(&state.document, &id, Gravity::Error, &bad.reason);
        if bad.reason.ends_with("no such file") {
            message.missing = file_input(&state.document, &id, &bad.reason);
            "find the file, or use the built-in head".clone_into(&mut message.remedy);
        }
        all.push(message);
    }
    for (id, report) in &reports.nodes {
        if !state.document.nodes.contains_key(id) {
            continue;
        }
        if let Some(error) = &report.error
            && *error != NodeError::Cancelled
            && !told.contains(id)
        {
            let mut message = about(&state.document, id, Gravity::Error, &error.to_string());
            message.too_large = matches!(error, NodeError::TooLarge(_)) && !state.allow_large;
            all.push(message);
        }
        for said in &report.messages {
            let gravity = if said.warning { Gravity::Warning } else { Gravity::Note };
            let mut message = about(&state.document, id, gravity, &said.text);
            message.curves = (said.count as usize, report.curves);
            message.ids.clone_from(&said.curves);
            all.push(message);
        }
    }
    all.sort_by_key(|message| std::cmp::Reverse(message.gravity));
    // What two ways lead to is one thing.
    let mut told = BTreeSet::new();
    all.retain(|message| {
        let text = message.text.trim_end_matches('.').to_lowercase();
        told.insert((message.node.clone(), text))
    });
    all
}

fn of_document(document: &Document) -> Vec<Message> {
    let of = |problem: coif_graphs::document::graph::Problem| {
        let gravity = match problem.severity {
            Severity::Error if problem.needed => Gravity::Error,
            _ => Gravity::Warning,
        };
        let mut message = about(document, &problem.node, gravity, &problem.text);
        if let Some(socket) = &problem.socket {
            message.place += &format!(", {}", spoken(socket));
        }
        message.remedy = problem.remedy;
        message
    };
    check(document).into_iter().map(of).collect()
}

/// What a merge left, without the name that the comment begins with where the node is named anyway.
fn of_merge(document: &Document, left: Undecided) -> Message {
    let Undecided { node, text, keep, take } = left;
    let text = format!("merge conflict: {text}");
    let mut message = match &node {
        Some(id) => about(document, id, Gravity::Warning, &text),
        None => Message::new(Gravity::Warning, "", text),
    };
    message.remedy = match &take {
        Some(_) => "ours is there now; keep it, or take theirs".to_owned(),
        None => "ours is there now; keep it, or make it as theirs and then keep it".to_owned(),
    };
    message.decides = Some((keep, take));
    message
}

fn about(document: &Document, id: &NodeId, gravity: Gravity, text: &str) -> Message {
    let node = Some(id.clone());
    Message { node, ..Message::new(gravity, document.name_of(id), text) }
}

fn of_note(document: &Document, note: &Note) -> Message {
    let mut place =
        note.node.as_ref().map_or_else(String::new, |id| document.name_of(id).into_owned());
    if let Some(input) = &note.input {
        place += &format!(", {}", spoken(input));
    }
    Message { node: note.node.clone(), ..Message::new(note.gravity, place, note.text.clone()) }
}

/// The file input that a refusal is about: it begins with the input's name.
fn file_input(document: &Document, id: &NodeId, reason: &str) -> Option<String> {
    let def = document.def(id)?;
    let files = def.inputs.iter().filter(|input| input.ty == Type::File);
    let named = files.map(|input| input.name).find(|name| reason.starts_with(&format!("{name}: ")));
    named.map(str::to_owned)
}

/// The room. Keeps what was said until something changes, and which kinds are shown.
pub(crate) struct Messages {
    of: Option<(u64, u64, usize, usize)>,
    all: Arc<[Message]>,
    shown: [bool; 3],
}

impl Default for Messages {
    fn default() -> Self {
        Self { of: None, all: Arc::new([]), shown: [true; 3] }
    }
}

const KINDS: [(Gravity, &str); 3] =
    [(Gravity::Error, "errors"), (Gravity::Warning, "warnings"), (Gravity::Note, "notes")];

impl Messages {
    /// What is said about a state.
    fn of(&mut self, state: &State) -> Arc<[Message]> {
        let reports = Arc::as_ptr(&state.run.reports).addr();
        let notes = state.notes.count();
        let now = Some((state.changes, state.revision, reports, notes));
        // While something is dragged, what was said stands; it is all said again behind it.
        if self.of != now && !(state.gesture && self.of.is_some()) {
            (self.of, self.all) = (now, all(state).into());
        }
        self.all.clone()
    }

    /// Shows the room.
    pub(crate) fn ui(&mut self, state: &State, ui: &mut egui::Ui, out: &mut Vec<Event>) {
        made::ui(state, ui, out);
        let all = self.of(state);
        ui.horizontal(|ui| {
            for ((gravity, name), shown) in KINDS.into_iter().zip(&mut self.shown) {
                let count = all.iter().filter(|message| message.gravity == gravity).count();
                gravity.mark(ui);
                ui.toggle_value(shown, format!("{count} {name}"))
                    .on_hover_text(format!("Show the {name}"));
            }
            ui.separator();
            let lines: Vec<String> = self.chosen(&all).map(|message| message.line()).collect();
            let copy = ui.add_enabled(!lines.is_empty(), egui::Button::new("Copy all"));
            if copy.on_hover_text("Copy all listed messages").clicked() {
                ui.ctx().copy_text(lines.join("\n"));
            }
            let said = !state.notes.all().is_empty();
            let clear = ui.add_enabled(said, egui::Button::new("Clear"));
            if clear.on_hover_text("Clear the log; current problems stay").clicked() {
                out.push(Event::Hush);
            }
        });
        ui.separator();
        let chosen: Vec<&Message> = self.chosen(&all).collect();
        if chosen.is_empty() {
            ui.label(RichText::new("Nothing to say.").weak());
        }
        ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
            for (at, message) in chosen.into_iter().enumerate() {
                ui.push_id(at, |ui| row(message, state.table, ui, out));
            }
        });
    }

    fn chosen<'a>(&self, all: &'a [Message]) -> impl Iterator<Item = &'a Message> + use<'a> {
        let shown = self.shown;
        all.iter().filter(move |message| {
            KINDS.iter().zip(shown).any(|((gravity, _), on)| on && *gravity == message.gravity)
        })
    }
}

fn row(message: &Message, table: ActionLookup, ui: &mut egui::Ui, out: &mut Vec<Event>) {
    ui.horizontal_top(|ui| {
        message.gravity.mark(ui);
        ui.with_layout(Layout::right_to_left(Align::Min), |ui| {
            if ui.small_button("Copy").on_hover_text("Copy this message").clicked() {
                ui.ctx().copy_text(message.line());
            }
            if let Some(node) = &message.node
                && ui
                    .small_button("Go to")
                    .on_hover_text("Select the node and show it on the canvas")
                    .clicked()
            {
                go_to(node, out);
            }
            if !message.ids.is_empty() {
                let all = message.ids.len() == message.curves.0;
                let word = if all {
                    "Select the curves".to_owned()
                } else {
                    format!("Select the first {}", message.ids.len())
                };
                if ui.small_button(word).on_hover_text("Select them in the viewport").clicked() {
                    let ids = message.ids.iter().copied().collect();
                    out.push(Event::Select(Select::Curves(ids)));
                }
            }
            let allows = message.too_large.then(|| table("evaluate.allow_large"));
            if let Some(action) = allows.flatten()
                && ui.small_button(action.label).on_hover_text(action.tip).clicked()
            {
                out.push(Event::Act(action.id));
            }
            if let (Some(node), Some(input)) = (&message.node, &message.missing) {
                missing(node, input, ui, out);
            }
            ui.with_layout(Layout::left_to_right(Align::Min), |ui| {
                ui.vertical(|ui| {
                    let mut text = message.text.clone();
                    if let Some(words) = message.curves_in_words() {
                        text += &format!(" ({words})");
                    }
                    if !message.place.is_empty() {
                        text = format!("{}: {text}", message.place);
                    }
                    ui.add(Label::new(text).wrap());
                    if !message.remedy.is_empty() {
                        ui.add(Label::new(RichText::new(&message.remedy).weak()).wrap());
                    }
                    if let Some((keep, take)) = &message.decides {
                        ui.horizontal_wrapped(|ui| decide(keep, take.as_ref(), ui, out));
                    }
                });
            });
        });
    });
}

/// The buttons that decide what a merge left.
fn decide(keep: &Edit, take: Option<&Edit>, ui: &mut egui::Ui, out: &mut Vec<Event>) {
    if ui.small_button("Keep ours").on_hover_text("Keep our version").clicked() {
        out.push(Event::Edit(keep.clone()));
    }
    let button = ui.add_enabled(take.is_some(), egui::Button::new("Take theirs").small());
    let button = button
        .on_hover_text("Set their version")
        .on_disabled_hover_text("The conflict comment is cut off: compare with their file");
    if let Some(edit) = take.filter(|_| button.clicked()) {
        out.push(Event::Edit(edit.clone()));
    }
}

fn missing(node: &NodeId, input: &str, ui: &mut egui::Ui, out: &mut Vec<Event>) {
    if ui
        .small_button("Use the built-in head")
        .on_hover_text("Use it instead of the missing file")
        .clicked()
    {
        out.push(Event::Edit(Edit::UnsetInput { node: node.clone(), input: input.to_owned() }));
    }
    if ui.small_button("Find…").on_hover_text("Choose the file's new location").clicked() {
        out.push(Event::Documents(documents::DocumentEvent::Find(node.clone(), input.to_owned())));
    }
}

fn go_to(node: &NodeId, out: &mut Vec<Event>) {
    out.push(Event::Select(Select::Nodes(vec![node.clone()])));
    out.push(Event::Show(Room::Inspector));
    out.push(Event::Show(Room::Canvas));
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::core::state::OpenFile;
    use crate::editor::Editor;
    use coif_graphs::document::Setting;
    use coif_nodes::define::Value;
    use egui_kittest::Harness;
    use egui_kittest::kittest::Queryable;

    fn on(name: &str, edits: Vec<Edit>) -> Harness<'static, Editor> {
        let text = coif_graphs::grooms::by_name(name).unwrap();
        let document = coif_graphs::file::read(text).unwrap().document;
        let mut editor = Editor::new(&egui::Context::default(), document, OpenFile::default());
        edits.into_iter().for_each(|edit| editor.apply(Event::Edit(edit)));
        editor.apply(Event::Show(Room::Messages));
        Harness::builder()
            .with_size(egui::vec2(1400.0, 900.0))
            .build_ui_state(|ui, editor: &mut Editor| editor.ui(ui), editor)
    }
    fn until(ui: &mut Harness<'static, Editor>, label: &str) {
        crate::testing::until(label, || {
            ui.step();
            ui.query_all_by_label_contains(label).next().is_some()
        });
    }
    fn set_mesh(path: &str) -> Edit {
        let setting = Setting::Known(Value::Text(path.into()));
        Edit::SetInput { node: NodeId::new("head").unwrap(), input: "mesh".to_owned(), setting }
    }
    fn display_head() -> Edit {
        Edit::SetDisplay(NodeId::new("head").ok())
    }

    #[test]
    fn a_missing_file_is_told_with_what_to_do_and_done() {
        let mut ui = on("braids", vec![display_head(), set_mesh("/no/such.obj")]);
        until(&mut ui, "mesh: /no/such.obj: no such file");
        ui.get_all_by_label("Go to").next().unwrap().click();
        ui.step();
        assert_eq!(ui.state().state.selection.active, NodeId::new("head").ok());
        ui.state_mut().apply(Event::Show(Room::Messages));
        ui.step();
        ui.get_by_label("Use the built-in head").click();
        ui.step();
        let head = &ui.state().state.document.nodes["head"];
        assert!(!head.inputs.contains_key("mesh"));
    }

    #[test]
    fn what_is_wrong_with_the_document_is_told_once_with_its_remedy() {
        let mut ui = on("braids", vec![display_head()]);
        let document = &ui.state().state.document;
        let (to, _) = document.links.iter().find(|(to, _)| &*to.name == "scalp").unwrap();
        let cut = Edit::SetWires { to: to.clone(), from: vec![] };
        let place = format!("{}, Scalp", document.name_of(&to.node));
        ui.state_mut().apply(Event::Edit(cut));
        let all = all(&ui.state().state);
        let about: Vec<&Message> = all.iter().filter(|m| m.place == place).collect();
        assert_eq!(about.len(), 1, "{all:?}");
        assert!(!about[0].remedy.is_empty() && about[0].line().contains(&place));
        assert!(all.is_sorted_by_key(|m| std::cmp::Reverse(m.gravity)));
    }

    #[test]
    fn what_a_merge_left_is_decided_by_buttons_and_saving_writes_none_of_it() {
        let folder = crate::testing::Folder::new("conflicts");
        let base = coif_graphs::file::read(coif_graphs::grooms::by_name("braids").unwrap());
        let base = base.unwrap().document;
        let braid = base.nodes.iter().find(|(_, node)| node.kind == "lissajous_braid");
        let braid = braid.map(|(id, _)| id.clone()).unwrap();
        let with = |strands: i32, seed: u64| {
            let mut document = base.clone();
            let setting = Setting::Known(Value::Int(strands.into()));
            let (node, input) = (braid.clone(), "strands".to_owned());
            Edit::SetInput { node, input, setting }.apply(&mut document).unwrap();
            Edit::SetSeed(seed).apply(&mut document).unwrap();
            document
        };
        let (ours, theirs) = (with(4, 11), with(5, 12));
        let merged = coif_graphs::compare::merge(&base, &ours, &theirs).document;
        let path = folder.path("merged.ron");
        std::fs::write(&path, coif_graphs::file::write(&merged)).unwrap();
        let mut ui = on("start", vec![]);
        let open = documents::DocumentEvent::Open(path.clone());
        ui.state_mut().apply(Event::Documents(documents::DocumentEvent::New(None)));
        ui.state_mut().apply(Event::Documents(open));
        ui.run_steps(3);
        let said = ui.state().state.notes.all().last().unwrap().text.clone();
        assert!(said.contains("2 conflicts of a merge left to decide"), "{said}");
        let left = |ui: &Harness<'static, Editor>| -> Vec<String> {
            let all = all(&ui.state().state).into_iter();
            all.filter(|message| message.decides.is_some()).map(|message| message.text).collect()
        };
        let before = left(&ui);
        assert!(
            before.len() == 2 && before[0].contains("base 0, ours 11, theirs 12"),
            "{before:?}"
        );
        // Theirs for the seed, ours for the braid; each is one step.
        ui.get_all_by_label("Take theirs").next().unwrap().click();
        ui.run_steps(2);
        assert_eq!(ui.state().state.document.seed, 12);
        assert_eq!(left(&ui).len(), 1);
        ui.get_all_by_label("Keep ours").next().unwrap().click();
        ui.run_steps(2);
        assert_eq!(left(&ui), Vec::<String>::new());
        assert_eq!(ui.state().state.history.done(), 2);
        ui.state_mut().apply(Event::Documents(documents::DocumentEvent::Save));
        ui.run_steps(2);
        let text = std::fs::read_to_string(&path).unwrap();
        assert!(!text.contains(coif_graphs::file::CONFLICT), "{text}");
        let saved = coif_graphs::file::read(&text).unwrap();
        assert_eq!((saved.document, saved.conflicts), (with(4, 12), vec![]));
        ui.state_mut().apply(Event::Undo);
        ui.run_steps(2);
        assert_eq!(left(&ui).len(), 1);
    }

    #[test]
    fn counts_of_curves_are_said_in_words_and_select_them() {
        let mut message = Message::new(Gravity::Warning, "rows".to_owned(), "too short");
        message.curves = (1204, 30_000);
        message.remedy = "make them longer".to_owned();
        assert_eq!(
            message.line(),
            "warning: rows: too short (1,204 of 30,000 curves); make them longer"
        );
        message.curves = (3, 0);
        assert_eq!(message.curves_in_words().as_deref(), Some("3 curves"));
    }
}
