//! Whatever hands do, the document stays sound and the editor stays up: random clicks, drags, keys, text and actions.

use super::harness::{is_sound, on_groom};
use coif::editor::actions;
use coif_graphs::{file, grooms};
use coif_nodes::maths::hash::KeyBuilder;
use egui::{Event, Key, Modifiers, PointerButton, Pos2, vec2};

/// Numbers that are the same in every run.
struct Dice {
    seed: u64,
    thrown: u64,
}

impl Dice {
    fn below(&mut self, n: usize) -> usize {
        self.thrown += 1;
        let key = KeyBuilder::new("dice").int(self.seed).int(self.thrown).finish();
        (key.0 as u64 % n.max(1) as u64) as usize
    }
    fn one<T: Copy>(&mut self, of: &[T]) -> T {
        of[self.below(of.len())]
    }
    fn place(&mut self) -> Pos2 {
        Pos2::new(self.below(1440) as f32, self.below(900) as f32)
    }
}

const KEYS: &[Key] = &[
    Key::Tab,
    Key::Enter,
    Key::Escape,
    Key::Delete,
    Key::Backspace,
    Key::ArrowLeft,
    Key::ArrowRight,
    Key::ArrowUp,
    Key::ArrowDown,
    Key::Space,
    Key::A,
    Key::B,
    Key::C,
    Key::D,
    Key::F,
    Key::G,
    Key::H,
    Key::K,
    Key::L,
    Key::Q,
    Key::R,
    Key::V,
    Key::X,
    Key::Y,
    Key::Z,
    Key::Slash,
    Key::OpenBracket,
    Key::CloseBracket,
    Key::Num1,
    Key::Num2,
    Key::F2,
    Key::F6,
    Key::F9,
];
const TEXTS: &[&str] =
    &["3", "1/0", "-1e30", "braid", "nan", "+=0.2", "\u{1F980}", "rows", "0.5mm", " "];
/// What would leave the editor, or wait for a person.
const NOT: &[&str] = &["file.open", "file.save", "file.save_as", "file.export", "file.picture"];

#[test]
fn random_events_leave_a_sound_document() {
    throw(0..2, 150);
}

/// In the release build, by `tests/run.sh --long`.
#[test]
#[ignore = "takes minutes"]
fn many_random_events_leave_a_sound_document() {
    // One seed alone: to see what went wrong, or to try others.
    let one = std::env::var("COIF_SEED").ok().and_then(|seed| seed.parse().ok());
    throw(one.map_or(0..20, |one: u64| one..one + 1), 2000);
}

fn throw(seeds: std::ops::Range<u64>, events: u32) {
    for seed in seeds {
        // Heroes are the same nodes with more hair.
        let all = grooms::ALL.iter().map(|(name, _)| *name);
        let light: Vec<&str> = all.filter(|name| !grooms::HEROES.contains(name)).collect();
        let name = light[seed as usize % light.len()];
        let mut ui = on_groom(name);
        let before = ui.state().state.document.clone();
        let mut dice = Dice { seed, thrown: 0 };
        let all: Vec<&str> = actions::all().map(|a| a.id).filter(|id| !NOT.contains(id)).collect();
        for _ in 0..events {
            let at = dice.place();
            let button = dice.one(&[
                PointerButton::Primary,
                PointerButton::Primary,
                PointerButton::Secondary,
                PointerButton::Middle,
            ]);
            let modifiers = dice.one(&[
                Modifiers::NONE,
                Modifiers::NONE,
                Modifiers::NONE,
                Modifiers::SHIFT,
                Modifiers::COMMAND,
                Modifiers::ALT,
                Modifiers::COMMAND | Modifiers::SHIFT,
            ]);
            let press =
                |pos: Pos2, pressed: bool| Event::PointerButton { pos, button, pressed, modifiers };
            match dice.below(10) {
                0..=2 => {
                    ui.event(Event::PointerMoved(at));
                    ui.event(press(at, true));
                    ui.step();
                    ui.event(press(at, false));
                }
                3..=4 => {
                    ui.event(Event::PointerMoved(at));
                    ui.event(press(at, true));
                    ui.step();
                    for _ in 0..dice.below(4) {
                        let by =
                            vec2(dice.below(200) as f32 - 100.0, dice.below(200) as f32 - 100.0);
                        ui.event(Event::PointerMoved(at + by));
                        ui.step();
                    }
                    // Some are never let go where they began to be, as when the pointer leaves the window.
                    let end = dice.place();
                    ui.event(Event::PointerMoved(end));
                    ui.event(press(end, false));
                }
                5..=6 => {
                    // Keys go where the pointer is.
                    if dice.below(2) == 0 {
                        ui.event(Event::PointerMoved(at));
                    }
                    let key = dice.one(KEYS);
                    ui.key_press_modifiers(modifiers, key);
                }
                7 => {
                    let text = dice.one(TEXTS).to_owned();
                    ui.event(Event::Text(text));
                }
                8 => {
                    let id = dice.one(&all);
                    ui.state_mut().act(id);
                }
                _ => {
                    let delta = vec2(0.0, dice.below(200) as f32 - 100.0);
                    ui.event(Event::MouseWheel {
                        unit: egui::MouseWheelUnit::Point,
                        delta,
                        modifiers,
                        phase: egui::TouchPhase::Move,
                    });
                }
            }
            ui.step();
        }
        let editor = ui.state_mut();
        editor.apply(coif::core::event::Event::End);
        is_sound(&editor.state.document);
        // All of it can be taken back, unless another groom was opened on the way.
        editor.apply(coif::core::event::Event::Jump(0));
        editor.state.document.display.clone_from(&before.display);
        // Another groom has another title; one that was edited has its own back by now.
        let other = editor.state.document.title != before.title;
        if !other && editor.state.document != before {
            let (now, then) = (file::write(&editor.state.document), file::write(&before));
            let differs = now.lines().zip(then.lines()).find(|(a, b)| a != b);
            panic!("{name}, seed {seed}: undo does not lead back: {differs:?}");
        }
    }
}
