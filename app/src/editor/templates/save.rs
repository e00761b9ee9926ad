//! *Save as template*: the selected group, the selected nodes or the whole groom become a file of the library.
//!
//! Guarantees: the groom does not change; no file is overwritten unless it holds this very template. The file is written on a thread,
//! and its picture is drawn afterwards, so *Templates* lists it at once.

use crate::core::event::Event;
use crate::core::notes::Note;
use crate::core::state::State;
use crate::core::templates::ShelfRow;
use crate::editor::Editor;
use crate::files::{Role, Together};
use crate::library::fitted::say_home;
use crate::library::new::{MadeOf, NewTemplate, bad_word, file_name, is_another};
use crate::rooms::templates::at_work::Written;
use crate::widgets::text::{set_name, spoken};
use crate::widgets::{panel, theme};
use coif_graphs::document::{Document, Node, NodeId, Origin, Setting};
use coif_graphs::schedule::run::CancelToken;
use coif_graphs::{file, template, text};
use coif_nodes::define::{Type, short};
use egui::{Checkbox, ComboBox, Grid, RichText, ScrollArea, TextEdit};
use std::path::{Path, PathBuf};
use std::sync::PoisonError;

/// The panel's name among windows.
pub(in crate::editor) const PANEL: &str = "save template";
/// How wide the panel is, in points.
const WIDTH: f32 = 380.0;

/// What is typed into the panel.
pub(crate) struct SaveTemplate {
    choices: Vec<MadeOf>,
    of: MadeOf,
    title: String,
    /// Follows the title until it is typed.
    name: Option<String>,
    version: String,
    description: String,
    author: String,
    licence: String,
    draws: bool,
    /// Which of the library's folders.
    folder: usize,
    inputs: Vec<InputChoice>,
    said: Option<String>,
}

/// An input that can be one of the template's.
struct InputChoice {
    /// As node.input, within the group.
    path: String,
    label: String,
    value: String,
    exposed: bool,
}

impl SaveTemplate {
    /// What it can be made of: what is selected, and the whole groom. A group and several nodes come first; a single node is more often
    /// selected for its values.
    fn choices(state: &State) -> Vec<MadeOf> {
        let nodes = &state.selection.nodes;
        let group = state.active().filter(|_| nodes.len() == 1);
        let is_group = |id: &&NodeId| state.document.node(id.as_str()).is_some_and(Node::is_group);
        match group.filter(is_group) {
            Some(group) => vec![MadeOf::Group(group.clone()), MadeOf::All],
            None if nodes.is_empty() => vec![MadeOf::All],
            None if nodes.len() == 1 => vec![MadeOf::All, MadeOf::Nodes(nodes.clone())],
            None => vec![MadeOf::Nodes(nodes.clone()), MadeOf::All],
        }
    }

    fn new(state: &State) -> Self {
        let choices = Self::choices(state);
        let of = choices[0].clone();
        let [title, description] = Self::words(state, &of);
        let mut new = Self {
            choices,
            of,
            title,
            name: None,
            version: "1.0".to_owned(),
            description,
            author: String::new(),
            licence: String::new(),
            draws: true,
            folder: 0,
            inputs: vec![],
            said: None,
        };
        new.find_inputs(state);
        new
    }

    /// The title and description that the groom suggests.
    fn words(state: &State, of: &MadeOf) -> [String; 2] {
        let document = &state.document;
        match of {
            MadeOf::Group(group) => {
                let note = document.node(group.as_str()).map(|node| node.note.clone());
                [document.name_of(group).into_owned(), note.unwrap_or_default()]
            }
            MadeOf::Nodes(_) => Default::default(),
            MadeOf::All => [document.title.clone(), String::new()],
        }
    }

    /// Makes it of something else. What was typed stays.
    fn turn_to(&mut self, state: &State, of: MadeOf) {
        let [was, is] = [&self.of, &of].map(|of| Self::words(state, of));
        for ((word, was), is) in
            [&mut self.title, &mut self.description].into_iter().zip(was).zip(is)
        {
            if *word == was {
                *word = is;
            }
        }
        self.of = of;
        self.find_inputs(state);
    }

    fn find_inputs(&mut self, state: &State) {
        (self.inputs, self.said) = match self.template().grouped(&state.document) {
            Ok((grouped, group)) => (inputs(&grouped, &group), None),
            Err(why) => (vec![], Some(why)),
        };
    }

    fn name(&self) -> String {
        self.name.clone().unwrap_or_else(|| word_of(&self.title))
    }

    fn template(&self) -> NewTemplate {
        let exposed = self.inputs.iter().filter(|input| input.exposed);
        let some = |text: &str| Some(text.trim().to_owned()).filter(|text| !text.is_empty());
        NewTemplate {
            of: self.of.clone(),
            exposed: exposed.map(|input| input.path.clone()).collect(),
            title: some(&self.title),
            description: some(&self.description),
            origin: Origin {
                name: self.name(),
                version: self.version.trim().to_owned(),
                author: self.author.trim().to_owned(),
                licence: self.licence.trim().to_owned(),
                ..Origin::default()
            },
        }
    }

    /// The template and its file; `shelf` is what the library has.
    fn made(
        &self,
        state: &State,
        folder: &Path,
        shelf: &[ShelfRow],
    ) -> Result<(Document, PathBuf), String> {
        let wanted = self.template();
        let Origin { name, version, .. } = &wanted.origin;
        let words = [("the name", name), ("the version", version)];
        let bad =
            words.into_iter().find_map(|(what, word)| Some(format!("{what} {}", bad_word(word)?)));
        if let Some(why) = bad {
            return Err(why);
        }
        let target = folder.join(file_name(name, version)?);
        // The library uses only the first template of a name and version.
        let taken = shelf.iter().find_map(|row| match row {
            ShelfRow::Found(it)
                if it.origin.name == *name
                    && it.origin.version == *version
                    && it.path.as_ref() != Some(&target) =>
            {
                Some(&it.place)
            }
            _ => None,
        });
        if let Some(place) = taken {
            return Err(format!(
                "{name} {version} is a template already ({place}): give this one another name or version"
            ));
        }
        let mut made = wanted.of(&state.document)?;
        say_home(&mut made, |head| state.landmarks_of(head));
        let group = template::group_of(&made)?;
        match is_another(&target, &template::hash(&made, group)) {
            Some(why) => Err(format!("{why}: give it another name or version")),
            None => Ok((made, target)),
        }
    }
}

/// A title as libraries know it: small letters, words joined by underscores.
fn word_of(title: &str) -> String {
    let spaced: String = title
        .chars()
        .flat_map(char::to_lowercase)
        .map(|c| if c.is_alphanumeric() { c } else { ' ' })
        .collect();
    spaced.split_whitespace().collect::<Vec<_>>().join("_")
}

/// Inputs in a group that are set and not wired: a template can expose these.
fn inputs(document: &Document, group: &NodeId) -> Vec<InputChoice> {
    let mut found = vec![];
    let named =
        |name: &str| document.inside(group).filter(|(id, _)| document.name_of(id) == name).count();
    for (id, node) in document.inside(group) {
        let Some(def) = document.def(id) else { continue };
        let within = &id.as_str()[group.as_str().len() + 1..];
        // Nodes that share a name are told apart by their path.
        let name = document.name_of(id);
        let name = match named(&name) {
            1 => name.into_owned(),
            _ => format!("{name} ({within})"),
        };
        for input in def.inputs {
            let Some(Setting::Known(value)) = node.inputs.get(input.name) else { continue };
            let drawn = matches!(input.ty, Type::Strokes | Type::Gestures);
            if drawn || !document.wires(id, input.name).is_empty() || input.name == "seed" {
                continue;
            }
            found.push(InputChoice {
                path: format!("{within}.{}", input.name),
                label: format!("{name}: {}", spoken(input.name).to_lowercase()),
                value: short(&text::write_value(value)),
                exposed: false,
            });
        }
    }
    found.sort_by_key(|input: &InputChoice| input.label.to_lowercase());
    found
}

impl Editor {
    pub(super) fn ask_to_save_template(&mut self) {
        // By the time a name is typed, the library's names are known.
        let wake = self.documents.waker();
        self.templates.shelf.look(self.templates.folders.clone(), move || wake());
        self.saving_template = Some(SaveTemplate::new(&self.state));
    }

    /// The panel, where it is open.
    pub(in crate::editor) fn save_template_panel(&mut self, ctx: &egui::Context) {
        let Some(mut asked) = self.saving_template.take() else { return };
        let folders = &self.templates.folders;
        let (mut open, mut save, mut cancel) = (true, false, false);
        panel::window("Save as template", PANEL, ctx).open(&mut open).collapsible(false).show(
            ctx,
            |ui| {
                panel::body(ui, WIDTH, |ui| {
                    ui.set_max_width(WIDTH);
                    for of in asked.choices.clone() {
                        let what = match &of {
                            MadeOf::All => "The whole groom, without its head".to_owned(),
                            MadeOf::Group(id) => {
                                format!("The group {}", self.state.document.name_of(id))
                            }
                            MadeOf::Nodes(nodes) => match nodes.first() {
                                Some(one) if nodes.len() == 1 => {
                                    format!("The node {}", self.state.document.name_of(one))
                                }
                                _ => format!("The {} selected nodes", nodes.len()),
                            },
                        };
                        if ui.radio(asked.of == of, what).clicked() && asked.of != of {
                            asked.turn_to(&self.state, of);
                        }
                    }
                    fields(ui, &mut asked, folders);
                    exposed(ui, &mut asked.inputs);
                    let draws = Checkbox::new(&mut asked.draws, "Render a thumbnail");
                    ui.add(draws)
                        .on_hover_text("Render the template and store the picture in its file");
                    if let Some(why) = &asked.said {
                        ui.label(RichText::new(format!("⚠ {why}")).color(theme::WARNING.of(ui)));
                    }
                    ui.horizontal(|ui| {
                        save = ui.button("Save").clicked();
                        cancel = ui.button("Cancel").clicked();
                    });
                });
            },
        );
        if save {
            let folder = folders.get(asked.folder).map(|(_, folder)| folder.clone());
            let made = folder.ok_or_else(|| "no folder for templates is known".to_owned());
            let shelf = self.templates.shelf.rows();
            match made.and_then(|folder| asked.made(&self.state, &folder, &shelf)) {
                Ok((made, target)) => {
                    self.write_template(made, target, asked.draws);
                    return;
                }
                Err(why) => asked.said = Some(why),
            }
        }
        if open && !cancel {
            self.saving_template = Some(asked);
        }
    }

    fn write_template(&mut self, made: Document, target: PathBuf, draws: bool) {
        let done = Written::default();
        let (to, wake) = (done.clone(), self.documents.waker());
        let begun = std::thread::Builder::new().name("template".to_owned()).spawn(move || {
            let written = written(&made, &target).map(|()| (target, draws));
            *to.lock().unwrap_or_else(PoisonError::into_inner) = Some(written);
            wake();
        });
        match begun {
            Ok(_) => self.templates.at_work.writing = Some(done),
            Err(why) => self.apply(Event::Say(Note::error(why.to_string()))),
        }
    }

    /// Tells what became of a template that was written; the shelf looks, and its picture is drawn.
    pub(super) fn settle_written(&mut self, ctx: &egui::Context) {
        let writing = &mut self.templates.at_work.writing;
        let done = writing
            .as_ref()
            .and_then(|done| done.lock().unwrap_or_else(PoisonError::into_inner).take());
        let Some(done) = done else { return };
        *writing = None;
        match done {
            Ok((path, draws)) => {
                let text = format!("template saved as {}", path.display());
                self.apply(Event::Say(Note::done(text)));
                self.templates.look(ctx);
                if draws {
                    self.make_thumbnail(path);
                }
            }
            Err(why) => self.apply(Event::Say(Note::error(why))),
        }
    }
}

fn fields(ui: &mut egui::Ui, asked: &mut SaveTemplate, folders: &[(String, PathBuf)]) {
    let line = |ui: &mut egui::Ui, name: &str, text: &mut String, hint: &str| {
        ui.label(name);
        let field = TextEdit::singleline(text).hint_text(hint).desired_width(f32::INFINITY);
        let field = ui.add(field);
        set_name(ui, &field, name);
        ui.end_row();
        field.changed()
    };
    Grid::new("save template").num_columns(2).show(ui, |ui| {
        line(ui, "Title", &mut asked.title, "what people call it");
        let mut name = asked.name();
        if line(ui, "Name", &mut name, "what libraries know it by") {
            asked.name = Some(name);
        }
        line(ui, "Version", &mut asked.version, "such as 1.0");
        line(ui, "Description", &mut asked.description, "what it makes");
        line(ui, "Author", &mut asked.author, "");
        line(ui, "Licence", &mut asked.licence, "such as CC-BY-4.0");
        ui.label("Where to");
        let called = |at: usize| folders.get(at).map_or("", |(name, _)| name.as_str());
        let combo = ComboBox::from_id_salt("template folder").selected_text(called(asked.folder));
        let combo = combo.show_ui(ui, |ui| {
            for (at, (name, path)) in folders.iter().enumerate() {
                ui.selectable_value(&mut asked.folder, at, name)
                    .on_hover_text(path.display().to_string());
            }
        });
        set_name(ui, &combo.response, "Where to");
        ui.end_row();
    });
}

/// A tick for each input that the template may have as its own.
fn exposed(ui: &mut egui::Ui, inputs: &mut [InputChoice]) {
    if inputs.is_empty() {
        return;
    }
    ui.label("Inputs of the template")
        .on_hover_text("What is ticked is set on the template itself; all else stays inside");
    ScrollArea::vertical().max_height(140.0).auto_shrink([false, true]).show(ui, |ui| {
        for input in inputs {
            ui.checkbox(&mut input.exposed, &input.label).on_hover_text(&input.value);
        }
    });
}

fn written(made: &Document, target: &Path) -> Result<(), String> {
    let named = |why: String| format!("{}: {why}", target.display());
    if let Some(folder) = target.parent() {
        std::fs::create_dir_all(folder).map_err(|err| named(err.to_string()))?;
    }
    let (cancel, mut files) = (CancelToken::default(), Together::default());
    files
        .writes(target, Role::Output, format!("the template {}", target.display()))
        .and_then(|()| files.allowed())
        .map_err(named)?;
    files.write_text(target, &file::write(made), &cancel).map_err(|why| named(why.to_string()))?;
    files.place(&cancel).map_err(|(path, why)| format!("{}: {why}", path.display()))
}
