//! The tour: five minutes on the real document. Each step is done by the person, and noticed; nothing is done for
//! anybody, and nothing is locked meanwhile.

use super::Editor;
use crate::core::state::State;
use crate::widgets::panel;
use coif_graphs::document::{Document, Setting};
use coif_nodes::define::Value;
use glam::Vec3;

/// One thing to do.
struct Step {
    /// What it is about.
    title: &'static str,
    /// How it is done, by mouse, pen and keys.
    text: &'static str,
    /// Whether it was done since the step began.
    done: fn(&Before, &Editor) -> bool,
}

const STEPS: &[Step] = &[
    Step {
        title: "Walk round the head",
        text: "Hold Alt (or Space) and drag in the viewport. The wheel goes nearer; F looks at what is selected, A at everything.",
        done: |before, editor| {
            let now = before.towards_eye(editor);
            before.eye.angle_between(now).to_degrees() > 10.0
        },
    },
    Step {
        title: "Draw a row",
        text: "Pick Draw in the bar over the picture (P) and draw on the scalp from the hairline to the nape. Hair follows while you draw; Ctrl+Z undoes the stroke.",
        done: |before, editor| strokes(&editor.state.document) > before.strokes,
    },
    Step {
        title: "Braid with four strands",
        text: "Click the node \u{201C}cornrows\u{201D} and set Strands from 3 to 4 in the inspector. Only nodes downstream run again.",
        done: |before, editor| {
            let now = numbers(&editor.state.document, "lissajous_braid", "strands");
            now != before.strands && now.iter().any(|n| !before.strands.contains(n))
        },
    },
    Step {
        title: "Widen the partings",
        text: "Click the node \u{201C}parting hairs\u{201D}, open Placement in the inspector and drag Parting width. More scalp shows.",
        done: |before, editor| {
            let now = numbers(&editor.state.document, "edge_partition", "parting_width");
            now != before.partings
        },
    },
    Step {
        title: "Sketch hair",
        text: "Press H and draw. From the skin, a stroke grows a cluster; from a tip, it lengthens one; over hair, it combs. With a mouse, 1, 2 and 3 set how deep it reaches.",
        done: |before, editor| gestures(&editor.state.document) > before.gestures,
    },
    Step {
        title: "Keep it",
        text: "Ctrl+S saves the groom: plain text, the same hair on every machine.",
        done: |_, editor| editor.state.file.path.is_some() && !editor.state.history.is_changed(),
    },
    Step {
        title: "That was it",
        text: "The groom is yours to go on with. Ctrl+K searches all actions, F1 shows the keys, Recipes start other hair.",
        done: |_, _| false,
    },
];

/// How things were when a step began.
struct Before {
    eye: Vec3,
    strokes: usize,
    gestures: usize,
    strands: Vec<String>,
    partings: Vec<String>,
}

impl Before {
    fn of(editor: &Editor) -> Self {
        let document = &editor.state.document;
        let camera = editor.viewport.camera();
        Self {
            eye: camera.eye - camera.target,
            strokes: strokes(document),
            gestures: gestures(document),
            strands: numbers(document, "lissajous_braid", "strands"),
            partings: numbers(document, "edge_partition", "parting_width"),
        }
    }
    fn towards_eye(&self, editor: &Editor) -> Vec3 {
        let camera = editor.viewport.camera();
        let now = camera.eye - camera.target;
        if now.length_squared() > 0.0 && self.eye.length_squared() > 0.0 { now } else { self.eye }
    }
}

/// Pen strokes of the whole document.
fn strokes(document: &Document) -> usize {
    let settings = document.nodes.values().flat_map(|node| node.inputs.values());
    let count = settings.map(|setting| match setting {
        Setting::Known(Value::Strokes(strokes)) => strokes.0.len(),
        _ => 0,
    });
    count.sum()
}

/// Gestures on hair of the whole document.
fn gestures(document: &Document) -> usize {
    let settings = document.nodes.values().flat_map(|node| node.inputs.values());
    let count = settings.map(|setting| match setting {
        Setting::Known(Value::Gestures(gestures)) => gestures.0.len(),
        _ => 0,
    });
    count.sum()
}

/// What an input is set to, in every node of a kind that sets it.
fn numbers(document: &Document, kind: &str, input: &str) -> Vec<String> {
    let nodes = document.nodes.iter().filter(|(_, node)| node.kind == kind);
    nodes
        .filter_map(|(id, node)| match node.inputs.get(input)? {
            Setting::Known(value) => Some(format!("{id} {:?}", value.key())),
            Setting::Raw(text) => Some(format!("{id} {text}")),
        })
        .collect()
}

/// Where a person is on the tour; not on it when there is no step.
#[derive(Default)]
pub(crate) struct Tour {
    at: Option<(usize, Option<Before>)>,
}

impl Tour {
    /// From the first step.
    pub(crate) fn begin(&mut self) {
        self.at = Some((0, None));
    }
    /// The number of the step and how many there are.
    pub(crate) fn progress(&self) -> Option<(usize, usize)> {
        self.at.as_ref().map(|(step, _)| (*step, STEPS.len()))
    }
}

/// Notices what was done, and shows what comes next in a corner that covers nothing one works on.
pub(crate) fn ui(editor: &mut Editor, ctx: &egui::Context) {
    let Some((mut number, before)) = editor.tour.at.take() else { return };
    let before = before.unwrap_or_else(|| Before::of(editor));
    let Some(step) = STEPS.get(number) else { return };
    let mut next = (step.done)(&before, editor);
    let mut stop = false;
    let room = panel::room(ctx);
    // Where there is no room beside what one works on, it stands above.
    let (corner, off) = match room.height() > 200.0 {
        true => (egui::Align2::LEFT_BOTTOM, [12.0, -44.0]),
        false => (egui::Align2::LEFT_TOP, [1.0, room.top() + 1.0]),
    };
    panel::window(format!("{} of {}: {}", number + 1, STEPS.len(), step.title), "tour", ctx)
        .anchor(corner, off)
        .collapsible(false)
        .resizable(false)
        .show(ctx, |ui| {
            panel::body(ui, 320.0, |ui| {
                ui.set_max_width(320.0);
                ui.label(step.text);
                ui.horizontal(|ui| {
                    let last = number + 1 == STEPS.len();
                    next |=
                        !last && ui.button("Skip").on_hover_text("Go to the next step").clicked();
                    stop = ui
                        .button("End the tour")
                        .on_hover_text("Start it again from the Help menu")
                        .clicked();
                });
            })
        });
    if stop {
        return;
    }
    let before = if next { None } else { Some(before) };
    number += usize::from(next);
    editor.tour.at = (number < STEPS.len()).then_some((number, before));
}

/// Why the tour cannot begin: it needs a braid to change.
pub(crate) fn possible(state: &State) -> Result<(), &'static str> {
    let braids = state.document.nodes.values().any(|node| node.kind == "lissajous_braid");
    if braids { Ok(()) } else { Err("open a groom with braids first, such as cornrows") }
}
