//! A browser for files inside the window, for where the system has no dialog: by mouse, pen and keyboard alike.
//!
//! Folders are read on a thread, so that one which hangs is only empty.

use super::dialogs::Question;
use crate::widgets::panel;
use egui::text::{CCursor, CCursorRange};
use egui::{Button, Id, Key, ScrollArea, TextEdit};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};

/// Entries of a folder that are shown.
const MOST: usize = 2000;

/// An open browser.
pub(crate) struct Browser {
    pub(crate) question: Question,
    folder: PathBuf,
    /// The path or name that is typed.
    typed: String,
    listing: Arc<Mutex<Listing>>,
    fresh: bool,
    wake: Arc<dyn Fn() + Send + Sync>,
}

#[derive(Default)]
struct Listing {
    of: PathBuf,
    folders: Vec<String>,
    files: Vec<String>,
    fault: Option<String>,
    is_done: bool,
}

/// What came of a frame.
pub(crate) enum BrowserOutcome {
    /// It stays open.
    Open,
    /// Somebody chose.
    Chosen(PathBuf),
    /// Somebody closed it.
    Closed,
}

impl Browser {
    /// A browser for a question.
    pub(crate) fn new(question: Question, wake: Arc<dyn Fn() + Send + Sync>) -> Self {
        let folder = match question.folder.as_os_str().is_empty() {
            // Where it was started from, as a shell has it.
            true => std::env::current_dir().ok().or_else(std::env::home_dir).unwrap_or_default(),
            false => std::path::absolute(&question.folder).unwrap_or_default(),
        };
        let typed = if question.purpose.saves() { question.name.clone() } else { String::new() };
        let listing = Arc::default();
        let mut browser =
            Self { question, folder: PathBuf::new(), typed, listing, fresh: true, wake };
        browser.enter(folder);
        browser
    }

    fn enter(&mut self, folder: PathBuf) {
        self.folder.clone_from(&folder);
        self.listing = Arc::default();
        let (listing, wake) = (self.listing.clone(), self.wake.clone());
        let endings = self.question.purpose.endings().1;
        // Without a thread the list stays empty; the path can be typed.
        let _ = std::thread::Builder::new().name("folder".to_owned()).spawn(move || {
            let read = list(&folder, endings);
            *listing.lock().unwrap_or_else(PoisonError::into_inner) = read;
            wake();
        });
    }

    /// What is typed, as a path.
    fn target(&self) -> PathBuf {
        self.folder.join(self.typed.trim())
    }

    /// Shows it.
    pub(crate) fn ui(&mut self, ctx: &egui::Context) -> BrowserOutcome {
        let mut outcome = BrowserOutcome::Open;
        let (mut open, mut enter) = (true, None);
        let purpose = self.question.purpose;
        panel::window(purpose.title(), "file browser", ctx)
            .open(&mut open)
            .collapsible(false)
            .default_size([460.0, 380.0])
            .pivot(egui::Align2::CENTER_CENTER)
            .default_pos(panel::room(ctx).center())
            .show(ctx, |ui| {
                let rest = ui.available_height() - 3.0 * ui.spacing().interact_size.y - 32.0;
                panel::body(ui, 220.0, |ui| {
                    ui.horizontal(|ui| {
                        let up = self.folder.parent().map(Path::to_owned);
                        let button = ui.add_enabled(up.is_some(), Button::new("Up"));
                        if button.on_hover_text("Parent folder").clicked() {
                            enter = up;
                        }
                        ui.add(egui::Label::new(self.folder.display().to_string()).truncate());
                    });
                    ScrollArea::vertical().max_height(rest.max(48.0)).auto_shrink(false).show(
                        ui,
                        |ui| {
                            let listing =
                                self.listing.lock().unwrap_or_else(PoisonError::into_inner);
                            if let Some(fault) = &listing.fault {
                                ui.label(fault);
                            } else if !listing.is_done {
                                ui.label("reading the folder…");
                            } else if listing.folders.is_empty() && listing.files.is_empty() {
                                ui.label("no matching files here");
                            }
                            for name in &listing.folders {
                                if ui.selectable_label(false, format!("🗀 {name}")).clicked() {
                                    enter = Some(listing.of.join(name));
                                }
                            }
                            for name in &listing.files {
                                let line = ui.selectable_label(*name == self.typed, name);
                                if line.clicked() {
                                    self.typed.clone_from(name);
                                }
                                if line.double_clicked() {
                                    outcome = BrowserOutcome::Chosen(listing.of.join(name));
                                }
                            }
                        },
                    );
                    let id = Id::new("file browser name");
                    let mut field = TextEdit::singleline(&mut self.typed)
                        .id(id)
                        .hint_text("name, or a whole path")
                        .desired_width(f32::INFINITY)
                        .show(ui);
                    if std::mem::take(&mut self.fresh) {
                        field.response.request_focus();
                        // What is typed takes the place of the name that is offered.
                        let all = CCursor::new(self.typed.chars().count());
                        let all = CCursorRange::two(CCursor::default(), all);
                        field.state.cursor.set_char_range(Some(all));
                        field.state.store(ui.ctx(), id);
                    }
                    let field = field.response;
                    ui.ctx().accesskit_node_builder(field.id, |node| node.set_label("File name"));
                    let entered =
                        field.lost_focus() && ui.input(|input| input.key_pressed(Key::Enter));
                    ui.horizontal(|ui| {
                        let target = self.target();
                        let exists = target.is_file();
                        let word = match (purpose.saves(), exists) {
                            (true, true) => "Replace the file",
                            (true, false) => "Save",
                            (false, _) => "Open",
                        };
                        let ready = !self.typed.trim().is_empty();
                        let pressed = ui.add_enabled(ready, Button::new(word)).clicked();
                        // What would be replaced takes more than Enter in a field.
                        if (pressed || (entered && !(purpose.saves() && exists))) && ready {
                            if target.is_dir() {
                                self.typed.clear();
                                enter = Some(target);
                            } else {
                                outcome = BrowserOutcome::Chosen(target);
                            }
                        }
                        if ui.button("Cancel").clicked() {
                            outcome = BrowserOutcome::Closed;
                        }
                    });
                });
            });
        if let Some(folder) = enter {
            self.enter(folder);
        }
        if !open || ctx.input(|input| input.key_pressed(Key::Escape)) {
            outcome = BrowserOutcome::Closed;
        }
        outcome
    }
}

fn list(folder: &Path, endings: &[&str]) -> Listing {
    let mut out = Listing { of: folder.to_owned(), is_done: true, ..Listing::default() };
    let entries = match std::fs::read_dir(folder) {
        Ok(entries) => entries,
        Err(err) => {
            out.fault = Some(err.to_string());
            return out;
        }
    };
    for entry in entries.flatten().take(MOST) {
        let name = entry.file_name().to_string_lossy().into_owned();
        if name.starts_with('.') {
            continue;
        }
        let path = entry.path();
        let ending = path.extension().map(|e| e.to_string_lossy().to_lowercase());
        if path.is_dir() {
            out.folders.push(name);
        } else if ending.is_some_and(|ending| endings.contains(&&*ending)) {
            out.files.push(name);
        }
    }
    out.folders.sort_by_key(|name| name.to_lowercase());
    out.files.sort_by_key(|name| name.to_lowercase());
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::Folder;

    #[test]
    fn a_path_that_is_typed_takes_the_place_of_the_name_that_is_offered() {
        use crate::core::documents::Purpose;
        let folder = Folder::new("browser-name");
        let question = Question {
            purpose: Purpose::Save,
            folder: folder.root().to_owned(),
            name: "start.ron".to_owned(),
        };
        let browser = Browser::new(question, Arc::new(|| {}));
        let mut hands = egui_kittest::Harness::builder().build_ui_state(
            |ui, (browser, chosen): &mut (Browser, Option<PathBuf>)| {
                if let BrowserOutcome::Chosen(path) = browser.ui(ui.ctx()) {
                    *chosen = Some(path);
                }
            },
            (browser, None),
        );
        hands.run_steps(3);
        let path = folder.path("elsewhere.ron");
        hands.event(egui::Event::Text(path.display().to_string()));
        hands.run_steps(2);
        assert_eq!(hands.state().0.typed, path.display().to_string());
        hands.key_press(Key::Enter);
        hands.run_steps(2);
        assert_eq!(hands.state().1, Some(path));
    }

    #[test]
    fn folders_come_first_and_only_files_that_fit() {
        let folder = Folder::new("browser");
        for name in ["b.OBJ", "a.obj", "c.txt", ".hidden.obj"] {
            std::fs::write(folder.path(name), "").unwrap();
        }
        std::fs::create_dir(folder.path("Heads")).unwrap();
        let found = list(folder.root(), &["obj"]);
        assert_eq!(
            (found.folders, found.files),
            (vec!["Heads".to_owned()], vec!["a.obj".into(), "b.OBJ".into()])
        );
        assert!(list(&folder.path("none"), &["obj"]).fault.is_some());
    }
}
