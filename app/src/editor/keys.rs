//! The table of keys: `keys.ron`, and what a person's own file overrides.
//!
//! Guarantees: one combination of keys does one thing in a room ([`Keys::clashes`] is empty for what is shipped); keys that
//! type text are left to text fields that have the keyboard. A damaged file of one's own changes nothing and is told.

use super::actions;
use crate::core::room::Room;
use egui::{Event, Key, KeyboardShortcut, Modifiers};
use serde::Deserialize;
use std::collections::BTreeMap;

/// Actions that open a field, which takes what is typed from then on.
const OPENERS: &[&str] =
    &["window.palette", "canvas.add", "canvas.connect", "node.swap", "node.rename", "node.note"];

/// What is shipped.
const SHIPPED: &str = include_str!("keys.ron");

/// One line of the table.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Line {
    action: String,
    keys: Vec<String>,
    context: String,
}

/// Where keys count.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Context {
    /// In every room.
    Anywhere,
    /// In one room.
    In(Room),
}

impl Context {
    fn named(name: &str) -> Option<Self> {
        if name == "anywhere" {
            return Some(Self::Anywhere);
        }
        let room =
            Room::ALL.into_iter().find(|room| format!("{room:?}").eq_ignore_ascii_case(name));
        room.map(Self::In)
    }
}

/// Which keys do what.
#[derive(Clone, Debug, Default)]
pub struct Keys {
    bound: BTreeMap<(Context, String), Vec<KeyboardShortcut>>,
}

impl Keys {
    /// The shipped table.
    ///
    /// # Errors
    /// Never for what is shipped, which a test reads.
    pub fn shipped() -> Result<Self, String> {
        let mut keys = Self::default();
        keys.add(SHIPPED)?;
        Ok(keys)
    }

    /// Overrides lines by those of a text in the form of `keys.ron`.
    ///
    /// # Errors
    /// One line that says what is wrong; nothing is changed then.
    pub fn add(&mut self, text: &str) -> Result<(), String> {
        let lines: Vec<Line> = ron::from_str(text).map_err(|err| err.to_string())?;
        let mut bound = self.bound.clone();
        for line in lines {
            let context = Context::named(&line.context)
                .ok_or_else(|| format!("{}: there is no room {:?}", line.action, line.context))?;
            if actions::by_id(&line.action).is_none() {
                return Err(format!("there is no action {:?}", line.action));
            }
            let keys: Result<Vec<_>, String> = line.keys.iter().map(|text| read(text)).collect();
            bound.insert((context, line.action), keys?);
        }
        self.bound = bound;
        Ok(())
    }

    /// The keys of an action, for menus: those of any room come first.
    pub fn of(&self, action: &str) -> Option<KeyboardShortcut> {
        let found = self.bound.iter().filter(|((_, id), _)| id == action);
        found.flat_map(|(_, keys)| keys).next().copied()
    }

    /// The whole table in the form of `keys.ron`.
    pub fn as_table(&self) -> String {
        let mut text = "[\n".to_owned();
        for ((context, action), keys) in &self.bound {
            let context = match context {
                Context::Anywhere => "anywhere".to_owned(),
                Context::In(room) => format!("{room:?}").to_lowercase(),
            };
            let keys: Vec<String> = keys.iter().map(written).collect();
            text += &format!("    (action: {action:?}, keys: {keys:?}, context: {context:?}),\n");
        }
        text + "]\n"
    }

    /// The lines that count in a room: what is done, and by which keys.
    pub fn in_room(&self, room: Room) -> Vec<(&str, &[KeyboardShortcut])> {
        let counts =
            |context: Context| context == Context::Anywhere || context == Context::In(room);
        let lines = self.bound.iter().filter(|((context, _), _)| counts(*context));
        lines.map(|((_, id), keys)| (id.as_str(), &keys[..])).collect()
    }

    /// Takes the keys that were pressed out of the input and gives what they do, once for each press. Rooms go before what counts
    /// anywhere, more modifiers before fewer. Keys after one that opens a field are left to that. `escapes`: Escape does something here.
    pub fn pressed(&self, ctx: &egui::Context, room: Room, escapes: bool) -> Vec<&'static str> {
        let typing = ctx.egui_wants_keyboard_input();
        let mut lines: Vec<(Context, &str, KeyboardShortcut)> = self
            .bound
            .iter()
            .filter(|((context, _), _)| {
                *context == Context::Anywhere || *context == Context::In(room)
            })
            .flat_map(|((context, id), keys)| keys.iter().map(move |k| (*context, id.as_str(), *k)))
            .collect();
        let weight =
            |m: Modifiers| [m.alt, m.shift, m.command, m.ctrl].iter().filter(|on| **on).count();
        lines.sort_by_key(|(context, _, keys)| {
            (std::cmp::Reverse(weight(keys.modifiers)), *context == Context::Anywhere)
        });
        let escape = KeyboardShortcut::new(Modifiers::NONE, Key::Escape);
        let opens: Vec<KeyboardShortcut> = lines
            .iter()
            .filter(|(_, id, keys)| OPENERS.contains(id) && !(typing && types_text(keys)))
            .map(|(.., keys)| *keys)
            .collect();
        let later = ctx.input_mut(|input| {
            let opened = |event: &Event| match event {
                Event::Key { key, pressed: true, modifiers, .. } => opens
                    .iter()
                    .any(|o| o.logical_key == *key && modifiers.matches_logically(o.modifiers)),
                _ => false,
            };
            let at = input.events.iter().position(opened);
            at.map_or_else(Vec::new, |at| input.events.split_off(at + 1))
        });
        let mut done = vec![];
        for (_, id, keys) in lines {
            if (typing && types_text(&keys)) || (!escapes && keys == escape) {
                continue;
            }
            // In a slow frame a key may be pressed more than once. One that is held repeats once a frame, or it would run away.
            let (mut presses, mut repeats) = (0, 0);
            ctx.input_mut(|input| {
                input.events.retain(|event| match event {
                    Event::Key { key, pressed: true, modifiers, repeat, .. }
                        if *key == keys.logical_key
                            && modifiers.matches_logically(keys.modifiers) =>
                    {
                        *if *repeat { &mut repeats } else { &mut presses } += 1;
                        false
                    }
                    _ => true,
                });
            });
            if let Some(action) = actions::by_id(id) {
                done.extend(std::iter::repeat_n(action.id, presses + repeats.min(1)));
            }
        }
        ctx.input_mut(|input| input.events.extend(later));
        done
    }

    /// Combinations that do two things in one room.
    pub fn clashes(&self) -> Vec<String> {
        let mut clashes = vec![];
        for room in Room::ALL {
            let mut seen: Vec<(KeyboardShortcut, &str)> = vec![];
            for (id, keys) in self.in_room(room) {
                for key in keys {
                    if let Some((_, other)) =
                        seen.iter().find(|(k, other)| k == key && *other != id)
                    {
                        clashes.push(format!("{room:?}: {} is {other} and {id}", name_of(key)));
                    }
                    seen.push((*key, id));
                }
            }
        }
        clashes
    }
}

/// Keys that a text field needs itself.
fn types_text(keys: &KeyboardShortcut) -> bool {
    let plain = !keys.modifiers.command && !keys.modifiers.ctrl && !keys.modifiers.alt;
    let function = matches!(keys.logical_key.name().as_bytes(), [b'F', b'0'..=b'9', ..]);
    let edits = matches!(
        keys.logical_key,
        Key::A | Key::C | Key::V | Key::X | Key::Z | Key::Y | Key::ArrowLeft | Key::ArrowRight
    );
    (plain && !function) || (keys.modifiers.command && edits)
}

/// Reads "Ctrl+Shift+Z".
fn read(text: &str) -> Result<KeyboardShortcut, String> {
    let (mut modifiers, mut rest) = (Modifiers::NONE, text);
    loop {
        let known =
            [("Ctrl+", Modifiers::COMMAND), ("Shift+", Modifiers::SHIFT), ("Alt+", Modifiers::ALT)];
        let Some((prefix, one)) = known.into_iter().find(|(prefix, _)| rest.starts_with(prefix))
        else {
            break;
        };
        rest = &rest[prefix.len()..];
        modifiers |= one;
    }
    let key = Key::from_name(rest).ok_or_else(|| format!("{text:?} is no key"))?;
    Ok(KeyboardShortcut::new(modifiers, key))
}

/// Keys as [`read`] reads them, on every system.
fn written(keys: &KeyboardShortcut) -> String {
    let m = keys.modifiers;
    let parts = [(m.command || m.ctrl, "Ctrl+"), (m.alt, "Alt+"), (m.shift, "Shift+")].into_iter();
    let words: String = parts.filter(|(on, _)| *on).map(|(_, word)| word).collect();
    words + keys.logical_key.name()
}

/// Keys for people: "Ctrl+Shift+Z".
pub fn name_of(keys: &KeyboardShortcut) -> String {
    let m = keys.modifiers;
    let command = if cfg!(target_os = "macos") { "Cmd+" } else { "Ctrl+" };
    let parts = [(m.command || m.ctrl, command), (m.alt, "Alt+"), (m.shift, "Shift+")].into_iter();
    let words: String = parts.filter(|(on, _)| *on).map(|(_, word)| word).collect();
    words + keys.logical_key.symbol_or_name()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shipped_keys_read_and_do_one_thing_each() {
        let keys = Keys::shipped().expect("keys.ron reads");
        assert_eq!(keys.clashes(), Vec::<String>::new());
    }

    #[test]
    fn each_press_within_a_slow_frame_counts_and_a_held_key_repeats_once() {
        #[track_caller]
        fn check(frames: &[&[bool]], expected: &[usize]) {
            let (ctx, keys) = (egui::Context::default(), Keys::shipped().unwrap());
            let key = |pressed: bool| Event::Key {
                key: Key::CloseBracket,
                physical_key: None,
                pressed,
                repeat: false,
                modifiers: Modifiers::NONE,
            };
            let times = frames.iter().map(|events| {
                let events = events.iter().map(|pressed| key(*pressed)).collect();
                ctx.begin_pass(egui::RawInput { events, ..Default::default() });
                let done = keys.pressed(&ctx, Room::Viewport, true);
                let _ = ctx.end_pass();
                assert!(done.iter().all(|id| *id == "pen.brush_larger"), "{done:?}");
                done.len()
            });
            assert_eq!(times.collect::<Vec<_>>(), expected, "{frames:?}");
        }
        check(&[&[true, false]], &[1]);
        check(&[&[true, false, true, false, true, false]], &[3]);
        // Held: the system presses it again without a release.
        check(&[&[true], &[true, true, true], &[true, false], &[]], &[1, 1, 1, 0]);
        check(&[&[true, true, true, false, true]], &[3]);
    }

    #[test]
    fn the_table_reads_as_it_was_written() {
        let keys = Keys::shipped().expect("keys.ron reads");
        let mut back = Keys::default();
        back.add(&keys.as_table()).expect("what was written reads");
        assert_eq!(back.bound, keys.bound);
    }

    #[test]
    fn a_file_of_ones_own_overrides_single_lines_or_nothing() {
        let mut keys = Keys::shipped().expect("keys.ron reads");
        let before = keys.of("edit.undo");
        for bad in [
            "nonsense",
            r#"[(action: "edit.fly", keys: [], context: "anywhere")]"#,
            r#"[(action: "edit.undo", keys: ["Hyper+Z"], context: "anywhere")]"#,
            r#"[(action: "edit.undo", keys: ["Ctrl+Z"], context: "cellar")]"#,
        ] {
            assert!(keys.add(bad).is_err(), "{bad}");
            assert_eq!(keys.of("edit.undo"), before);
        }
        keys.add(r#"[(action: "edit.undo", keys: ["Alt+F4"], context: "anywhere")]"#)
            .expect("it reads");
        assert_eq!(keys.of("edit.undo").map(|k| name_of(&k)).as_deref(), Some("Alt+F4"));
        assert!(keys.of("edit.redo").is_some());
    }
}
