//! The command palette: every action by name, from the keyboard.
//!
//! Guarantees: what is typed after the key that opens it is typed into it, however much of it comes in one frame; a frame may be
//! long. Not promised: that words find an action that its label, words and id do not have.

use super::Editor;
use super::actions::{self, Entry};
use super::keys::name_of;
use crate::widgets::panel;
use egui::{Align2, Area, Frame, Key, Modifiers, Order, RichText, ScrollArea, TextEdit};

/// What is open, typed and chosen.
#[derive(Default)]
pub(crate) struct Palette {
    open: bool,
    typed: String,
    chosen: usize,
}

impl Palette {
    /// Opens it, empty.
    pub(crate) fn open(&mut self) {
        *self = Self { open: true, ..Self::default() };
    }
    /// Closes it; whether it was open.
    pub(crate) fn close(&mut self) -> bool {
        std::mem::take(&mut self.open)
    }
    /// Whether it takes the keys.
    pub(crate) fn is_open(&self) -> bool {
        self.open
    }
}

/// How well an action answers what was typed; none when it does not. Higher is better.
fn rank(action: &Entry, typed: &str) -> Option<u32> {
    let typed = typed.trim().to_lowercase();
    if typed.is_empty() {
        return Some(0);
    }
    let label = action.label.to_lowercase();
    if label.starts_with(&typed) {
        return Some(4);
    }
    if label.split(' ').any(|word| word.starts_with(&typed)) {
        return Some(3);
    }
    let all = format!("{label} {} {}", action.words, action.id).to_lowercase();
    let words = typed.split_whitespace();
    if words.clone().all(|word| all.split([' ', '.']).any(|w| w.starts_with(word))) {
        return Some(2);
    }
    // The beginnings of its words, each as long as one likes.
    let words: Vec<Vec<char>> = label.split_whitespace().map(|it| it.chars().collect()).collect();
    let typed: Vec<char> = typed.chars().filter(|c| !c.is_whitespace()).collect();
    begins_words(&typed, &words).then_some(1)
}

/// Whether letters are beginnings of these words, in their order: `evno` of *evaluate now*.
fn begins_words(typed: &[char], words: &[Vec<char>]) -> bool {
    if typed.is_empty() {
        return true;
    }
    let Some((word, rest)) = words.split_first() else { return false };
    let same = typed.iter().zip(word).take_while(|(a, b)| a == b).count();
    (1..=same).rev().any(|n| begins_words(&typed[n..], rest)) || begins_words(typed, rest)
}

/// The word that an action was found by, where its label does not say it.
fn why(action: Entry, typed: &str) -> Option<&'static str> {
    let typed = typed.trim().to_lowercase();
    if rank(&action, &typed) != Some(2) {
        return None;
    }
    let label = action.label.to_lowercase();
    let odd = typed.split_whitespace().find(|word| !label.contains(*word))?.to_owned();
    action.words.split(' ').find(|word| word.to_lowercase().starts_with(&odd))
}

/// Actions that answer what was typed, best first.
pub(crate) fn found(typed: &str) -> Vec<Entry> {
    let mut ranked: Vec<(u32, Entry)> =
        actions::all().filter_map(|action| Some((rank(&action, typed)?, action))).collect();
    ranked.sort_by_key(|(rank, _)| std::cmp::Reverse(*rank));
    ranked.into_iter().map(|(_, action)| action).collect()
}

/// Shows it, if it is open; gives the action that was picked.
pub(crate) fn ui(editor: &mut Editor, ctx: &egui::Context) -> Option<&'static str> {
    if !editor.palette.open {
        return None;
    }
    let key = |key: Key| ctx.input_mut(|i| i.consume_key(Modifiers::NONE, key));
    let (up, down) = (key(Key::ArrowUp), key(Key::ArrowDown));
    let (enter, escape) = (key(Key::Enter), key(Key::Escape));
    let mut picked = None;
    let mut typed = std::mem::take(&mut editor.palette.typed);
    let mut chosen = editor.palette.chosen;
    let mut all = vec![];
    // Before the field is shown, so that it takes what was typed since it was asked for.
    let field_id = egui::Id::new("palette field");
    ctx.memory_mut(|memory| memory.request_focus(field_id));
    let room = panel::room(ctx);
    // Small windows have no room to spare.
    let (top, spare) = match room.height() > 300.0 {
        true => (60.0, 120.0),
        false => (room.top() + 1.0, 52.0),
    };
    let area = Area::new("palette".into())
        .order(Order::Foreground)
        .anchor(Align2::CENTER_TOP, [0.0, top])
        .show(ctx, |ui| {
            Frame::popup(ui.style()).show(ui, |ui| {
                ui.set_width(440.0_f32.min(room.width() - 24.0));
                let field = TextEdit::singleline(&mut typed)
                    .id(field_id)
                    .hint_text("What is to be done?")
                    .desired_width(f32::INFINITY);
                if ui.add(field).changed() {
                    chosen = 0;
                }
                all = found(&typed);
                let last = all.len().saturating_sub(1);
                chosen = chosen.min(last);
                chosen = if down { (chosen + 1).min(last) } else { chosen };
                chosen = if up { chosen.saturating_sub(1) } else { chosen };
                // As large with one answer or none as with all: what one looks at stays.
                let most = (room.height() - spare).clamp(16.0, 360.0);
                let list = ScrollArea::new([room.width() < 464.0, true]);
                let list = list.max_height(most).min_scrolled_height(most);
                list.auto_shrink(false).show(ui, |ui| {
                    if all.is_empty() {
                        let text =
                            format!("No action answers to \u{201C}{}\u{201D}.", typed.trim());
                        ui.label(RichText::new(text).weak());
                        ui.label(RichText::new("Nodes are added with Tab over the nodes.").weak());
                    }
                    for (i, action) in all.iter().enumerate() {
                        let allowed = action.when(editor);
                        ui.horizontal(|ui| {
                            let keys = editor.keys.of(action.id).map(|k| name_of(&k));
                            let text = if action.menu.is_empty() {
                                action.label.to_owned()
                            } else {
                                let recipe = action.id.starts_with("recipe.");
                                let menu = if recipe { "Recipe" } else { action.menu };
                                format!("{menu}: {}", action.label)
                            };
                            let text = match why(*action, &typed) {
                                Some(word) => format!("{text} \u{201C}{word}\u{201D}"),
                                None => text,
                            };
                            let row = ui
                                .add_enabled_ui(allowed.is_ok(), |ui| {
                                    ui.selectable_label(i == chosen, text)
                                })
                                .inner
                                .on_hover_text(action.tip)
                                .on_disabled_hover_text(allowed.err().unwrap_or_default());
                            if i == chosen && (up || down) {
                                row.scroll_to_me(None);
                            }
                            if row.clicked() {
                                picked = Some(action.id);
                            }
                            if let Some(keys) = keys {
                                ui.with_layout(
                                    egui::Layout::right_to_left(egui::Align::Center),
                                    |ui| {
                                        ui.label(RichText::new(keys).weak());
                                    },
                                );
                            }
                        });
                    }
                });
            });
        });
    if enter && let Some(action) = all.get(chosen).filter(|a| a.when(editor).is_ok()) {
        picked = Some(action.id);
    }
    let outside = ctx.input(|i| i.pointer.any_pressed())
        && ctx.pointer_latest_pos().is_some_and(|p| !area.response.rect.contains(p));
    editor.palette.open = picked.is_none() && !escape && !outside;
    editor.palette.typed = typed;
    editor.palette.chosen = chosen;
    picked
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::core::state::OpenFile;
    use egui::Event;

    #[test]
    fn what_is_typed_in_the_frame_that_opens_it_is_typed_into_it() {
        let document = super::super::documents::life::empty_head();
        let editor = Editor::new(&egui::Context::default(), document, OpenFile::default());
        let mut hands = egui_kittest::Harness::builder()
            .with_size(egui::vec2(900.0, 700.0))
            .build_ui_state(|ui, editor: &mut Editor| editor.ui(ui), editor);
        hands.run_steps(2);
        let nodes =
            |hands: &egui_kittest::Harness<Editor>| hands.state().state.document.nodes.len();
        let before = nodes(&hands);
        // As one long frame has them: these letters alone are keys of actions.
        let events = &mut hands.input_mut().events;
        let mut key = |key, modifiers| {
            let (physical_key, repeat) = (None, false);
            events.push(Event::Key { key, physical_key, pressed: true, repeat, modifiers });
            if modifiers == Modifiers::NONE && key != Key::Enter {
                events.push(Event::Text(key.name().to_lowercase()));
            }
        };
        key(Key::K, Modifiers::COMMAND);
        for letter in [Key::C, Key::O, Key::R, Key::N, Key::R, Key::O, Key::W, Key::S] {
            key(letter, Modifiers::NONE);
        }
        hands.step();
        assert_eq!(hands.state().palette.typed, "cornrows");
        assert_eq!(nodes(&hands), before);
        hands.key_press(Key::Enter);
        hands.run_steps(2);
        assert!(!hands.state().palette.is_open() && nodes(&hands) > before);
    }

    #[test]
    fn actions_are_found_by_label_word_id_and_letters() {
        for (typed, first) in [
            ("undo", "edit.undo"),
            ("redo", "edit.redo"),
            ("revert", "edit.undo"),
            ("shortcuts", "window.keys"),
            ("cook", "evaluate.now"),
            ("evnow", "evaluate.now"),
            ("spread", "window.spreadsheet"),
        ] {
            assert_eq!(found(typed).first().map(|a| a.id), Some(first), "{typed}");
        }
        assert!(found("qqq").is_empty());
        // Letters that merely stand somewhere in a label, in that order, are no answer.
        for nonsense in ["pen in", "teal", "sole", "rear"] {
            let bogus: Vec<&str> = found(nonsense).iter().map(|it| it.label).collect();
            assert!(bogus.is_empty(), "{nonsense}: {bogus:?}");
        }
    }
}
