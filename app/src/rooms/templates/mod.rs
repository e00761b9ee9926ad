//! The room *Templates*: what can be put among the nodes, with pictures, found by what is typed.
//!
//! Guarantees: the window waits for no file and decodes few pictures in a frame; a file that is no template is listed with the reason;
//! what is added is one undo step.

pub(crate) mod at_work;
mod card;
mod pictures;
mod shelf;
#[cfg(test)]
mod tests;

pub(crate) use card::carried;
pub(crate) use shelf::Shelf;

use crate::core::event::Event;
use crate::core::state::State;
use crate::core::templates::{Listed, ShelfRow, TemplateEvent, Which};
use crate::widgets::theme;
use crate::words::counted;
use at_work::AtWork;
use card::Said;
use coif_graphs::document::Point;
use egui::{Key, Modifiers, RichText, ScrollArea, TextEdit, Ui, vec2};
use pictures::Pictures;
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Duration;

/// The room.
#[derive(Default)]
pub(crate) struct Templates {
    /// Folders beside what comes with coif, as people know them.
    pub(crate) folders: Vec<(String, PathBuf)>,
    pub(crate) shelf: Shelf,
    pub(crate) pictures: Pictures,
    pub(crate) at_work: AtWork,
    typed: String,
    /// The key of the row that is chosen.
    chosen: Option<String>,
    /// The frame in which it was seen last, and whether the window had the keyboard.
    seen: Option<u64>,
    focused: bool,
    /// When the folders are looked through next, in seconds of the window.
    looks_at: f64,
    /// The field of the search is to take what is typed.
    search: bool,
    /// The chosen one is to be in sight.
    reveal: bool,
}

/// The folders are looked through so often while the room is seen, seconds.
const EVERY: f64 = 1.0;
/// Height of what is said of the chosen one.
const DETAILS: f32 = 136.0;
/// Where a room is lower there is no place for it.
const LEAST: f32 = 280.0;

impl Templates {
    /// The field of the search takes what is typed next.
    pub(crate) fn search(&mut self) {
        self.search = true;
    }

    /// Types words into the search, and chooses the first that they find.
    #[cfg(test)]
    pub(crate) fn find(&mut self, words: &str) {
        self.typed = words.to_owned();
        let rows = self.shelf.rows();
        let first = self.shown(&rows).first().map(|row| row.key());
        self.chosen = first.filter(|_| !words.is_empty());
    }

    /// The folders are looked through again.
    pub(crate) fn look(&self, ctx: &egui::Context) {
        let ctx = ctx.clone();
        self.shelf.look(self.folders.clone(), move || ctx.request_repaint());
    }

    /// Shows it.
    pub(crate) fn ui(&mut self, state: &State, ui: &mut Ui, out: &mut Vec<Event>) {
        let frame = ui.ctx().cumulative_frame_nr();
        let focused = ui.input(|input| input.focused);
        let opened = self.seen.is_none_or(|seen| seen + 1 < frame);
        // What others put into the folders is seen while the room is, too.
        let now = ui.input(|input| input.time);
        if opened || (focused && !self.focused) || now >= self.looks_at {
            self.look(ui.ctx());
            self.looks_at = now + EVERY;
        }
        ui.ctx().request_repaint_after(Duration::from_secs_f64((self.looks_at - now).max(0.0)));
        (self.seen, self.focused) = (Some(frame), focused);
        self.pictures.begin(frame);
        let rows = self.shelf.rows();
        let shown = self.shown(&rows);
        let typing = self.field(ui, shown.len(), rows.len());
        let keyed = typing
            || (state.focus == crate::core::room::Room::Templates
                && !ui.ctx().egui_wants_keyboard_input());
        let chosen = shown.iter().copied().find(|row| Some(row.key()) == self.chosen).cloned();
        if ui.available_height() > LEAST {
            egui::Panel::bottom("chosen template").resizable(false).exact_size(DETAILS).show(
                ui,
                |ui| {
                    self.details(ui, chosen.as_ref(), out);
                },
            );
        }
        let columns = card::columns(ui.available_width());
        if keyed && !shown.is_empty() {
            self.keys(ui, &shown, columns, typing, out);
        }
        if shown.is_empty() {
            ui.add_space(8.0);
            ui.label(RichText::new(self.nothing()).color(theme::QUIET.of(ui)));
            return;
        }
        self.grid(ui, &shown, columns, out);
    }

    fn nothing(&self) -> &'static str {
        match (self.shelf.is_new(), self.typed.trim().is_empty()) {
            (true, _) => "Reading templates…",
            (false, true) => "There are no templates.",
            (false, false) => "No template matches.",
        }
    }

    /// The rows that have all words that are typed: those first whose title begins with them, and of these the shortest.
    fn shown<'a>(&self, rows: &'a [ShelfRow]) -> Vec<&'a ShelfRow> {
        let words: Vec<String> =
            self.typed.to_lowercase().split_whitespace().map(str::to_owned).collect();
        let mut shown: Vec<&ShelfRow> = rows.iter().filter(|row| row.says(&words)).collect();
        let typed = words.join(" ");
        let titled = |row: &&ShelfRow| row.title().to_lowercase().starts_with(&typed);
        if !typed.is_empty() {
            shown.sort_by_key(|row| match titled(row) {
                true => (false, row.title().len()),
                false => (true, 0),
            });
        }
        shown
    }

    /// The field of the search; whether it has the keyboard.
    fn field(&mut self, ui: &mut Ui, shown: usize, all: usize) -> bool {
        let id = egui::Id::new("search templates");
        let hint = match all {
            0 => "Search templates".to_owned(),
            _ => format!("Search {}", counted(all, "template")),
        };
        let field = TextEdit::singleline(&mut self.typed)
            .id(id)
            .hint_text(hint)
            .vertical_align(egui::Align::Center)
            .min_size(ui.spacing().interact_size)
            .desired_width(f32::INFINITY);
        if std::mem::take(&mut self.search) {
            ui.memory_mut(|memory| memory.request_focus(id));
        }
        let field = ui.add(field);
        ui.ctx().accesskit_node_builder(field.id, |node| node.set_label("Search templates"));
        if field.changed() {
            (self.chosen, self.reveal) = (None, true);
        }
        if !self.typed.trim().is_empty() && ui.available_height() > LEAST {
            ui.label(RichText::new(format!("{shown} of {all}")).small().color(theme::QUIET.of(ui)));
        }
        // Enter leaves a field of one line; it adds what is chosen all the same.
        field.has_focus() || field.lost_focus() && ui.input(|input| input.key_pressed(Key::Enter))
    }

    /// Arrows choose, Enter adds.
    fn keys(
        &mut self,
        ui: &Ui,
        shown: &[&ShelfRow],
        columns: usize,
        typing: bool,
        out: &mut Vec<Event>,
    ) {
        let key = |key: Key| ui.input_mut(|input| input.consume_key(Modifiers::NONE, key));
        let now = shown.iter().position(|row| Some(row.key()) == self.chosen);
        let last = shown.len() - 1;
        let steps = [
            (Key::ArrowDown, columns as isize),
            (Key::ArrowUp, -(columns as isize)),
            (Key::ArrowRight, 1),
            (Key::ArrowLeft, -1),
        ];
        // Left and right move in what is typed.
        for (arrow, by) in steps.into_iter().take(if typing { 2 } else { 4 }) {
            if key(arrow) {
                let to = now.map_or(0, |now| now.saturating_add_signed(by).min(last));
                (self.chosen, self.reveal) = (Some(shown[to].key()), true);
            }
        }
        if ui.input(|input| input.key_pressed(Key::Enter)) {
            // What is typed means the first that it finds.
            let first = now.or((typing && !self.typed.trim().is_empty()).then_some(0));
            if let Some(ShelfRow::Found(it)) = first.map(|at| shown[at]) {
                out.push(add(it, None));
            }
        }
    }

    fn grid(&mut self, ui: &mut Ui, shown: &[&ShelfRow], columns: usize, out: &mut Vec<Event>) {
        let width = (ui.available_width() - 10.0).max(24.0);
        let size = card::size(width, columns);
        let lines = shown.len().div_ceil(columns);
        let mut area = ScrollArea::vertical().auto_shrink(false).min_scrolled_height(16.0);
        if std::mem::take(&mut self.reveal) {
            let at = shown.iter().position(|row| Some(row.key()) == self.chosen).unwrap_or(0);
            area = area.vertical_scroll_offset(card::offset(
                at / columns,
                size.y,
                ui.available_height(),
            ));
        }
        ui.spacing_mut().item_spacing = vec2(card::GAP, card::GAP);
        area.show_rows(ui, size.y, lines, |ui, range| {
            for line in range {
                ui.horizontal(|ui| {
                    for row in shown.iter().skip(line * columns).take(columns) {
                        let key = row.key();
                        let chosen = Some(&key) == self.chosen.as_ref();
                        match card::show(ui, row, (&key, chosen, size), &mut self.pictures) {
                            Said::Nothing => {}
                            Said::Chosen => self.chosen = Some(key),
                            Said::Added => {
                                self.chosen = Some(key);
                                if let ShelfRow::Found(it) = row {
                                    out.push(add(it, None));
                                }
                            }
                        }
                    }
                });
            }
        });
    }

    /// What is said of the chosen one, and what can be done with it.
    fn details(&mut self, ui: &mut Ui, chosen: Option<&ShelfRow>, out: &mut Vec<Event>) {
        let area = ScrollArea::vertical().auto_shrink(false).min_scrolled_height(16.0);
        area.show(ui, |ui| match chosen {
            None => {
                ui.add_space(4.0);
                let text = "Drag a template among the nodes, or press Enter to add it.";
                ui.label(RichText::new(text).color(theme::QUIET.of(ui)));
            }
            Some(ShelfRow::Broken(it)) => {
                ui.add_space(2.0);
                ui.label(
                    RichText::new(format!("⚠ {}", it.path.display())).color(theme::WARNING.of(ui)),
                );
                ui.label(format!("In {}: no template that can be added: {}.", it.place, it.why));
            }
            Some(ShelfRow::Found(it)) => self.of_template(ui, it, out),
        });
    }

    fn of_template(&mut self, ui: &mut Ui, it: &Arc<Listed>, out: &mut Vec<Event>) {
        ui.add_space(2.0);
        ui.horizontal(|ui| {
            let tip = "Add it in the middle of the canvas (Enter)";
            if ui.button("Add").on_hover_text(tip).clicked() {
                out.push(add(it, None));
            }
            let own = it.path.clone().filter(|_| !self.at_work.is_busy());
            let tip = "Render a thumbnail and store it in the template's file";
            let none = if it.path.is_none() {
                "It comes with coif and has its picture"
            } else {
                "A thumbnail is being rendered"
            };
            let button = ui.add_enabled(own.is_some(), egui::Button::new("Make thumbnail"));
            if button.on_hover_text(tip).on_disabled_hover_text(none).clicked() {
                out.extend(own.map(|path| Event::Templates(TemplateEvent::Thumbnail(path))));
            }
            if self.at_work.is_busy() {
                ui.spinner();
            }
            ui.add(egui::Label::new(RichText::new(&it.title).strong()).truncate());
        });
        let line = |ui: &mut Ui, text: String, whole: &str| {
            ui.add(egui::Label::new(RichText::new(text).color(theme::QUIET.of(ui))).truncate())
                .on_hover_text(whole);
        };
        let origin = &it.origin;
        ui.add(egui::Label::new(&it.description).truncate()).on_hover_text(&it.description);
        let some =
            |text: &str, or: &str| if text.is_empty() { or.to_owned() } else { text.to_owned() };
        let needs = origin.needs.join(", ");
        let takes = some(&it.takes, "nothing");
        let needs = if needs.is_empty() {
            format!("takes {takes}")
        } else {
            format!("takes {takes}; needs {needs}")
        };
        line(ui, needs.clone(), &needs);
        let path = it.path.as_ref().map_or(String::new(), |path| path.display().to_string());
        line(ui, format!("version {}, {}", some(&origin.version, "unnamed"), it.place), &path);
        let by = format!(
            "by {}, {}",
            some(&origin.author, "nobody named"),
            some(&origin.licence, "licence not stated")
        );
        let source = some(&origin.source, "Origin of the style not stated.");
        line(ui, by.clone(), &format!("{by}\n{source}"));
    }
}

fn add(it: &Arc<Listed>, at: Option<Point>) -> Event {
    Event::Templates(TemplateEvent::Add { template: Which(it.clone()), at })
}
