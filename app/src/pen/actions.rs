//! What the pen room can do by name: tools, brushes, symmetry, what happens to picked strokes and points, recipes.

use super::{Picked, StrokeTool, edits, recipes, target};
use crate::editor::Editor;
use crate::editor::actions::{Action, always};
use crate::editor::event::Event;
use crate::editor::notes::Note;
use crate::editor::rooms::Room;
use crate::editor::settings::Settings;
use crate::editor::state::Select;
use coif_graphs::document::edit::Edit;
use coif_graphs::document::strokes::finish;
use coif_graphs::document::{NodeId, Setting};
use coif_nodes::define::Value;
use std::collections::BTreeSet;

/// A tool that is taken up.
macro_rules! tool {
    ($id:literal, $tool:ident, $label:literal, $tip:literal, $words:literal) => {
        Action {
            id: $id,
            label: $label,
            tip: $tip,
            words: $words,
            menu: "Pen",
            when: always,
            run: |editor| editor.pen.tool = StrokeTool::$tool,
        }
    };
}

/// A change of a setting of the pen.
fn set(editor: &mut Editor, change: impl FnOnce(&mut super::settings::Settings)) {
    let mut settings: Settings = editor.state.settings.clone();
    change(&mut settings.pen);
    editor.apply(Event::Settings(settings.into()));
}

/// What can be done by name.
pub(crate) const ACTIONS: &[Action] = &[
    tool!(
        "pen.select",
        Select,
        "Select and turn",
        "The pointer selects in the viewport and turns the view; the pen does not draw.",
        "arrow pick none"
    ),
    tool!(
        "pen.draw",
        Draw,
        "Draw strokes",
        "Draw on the scalp, or in space where the node says so. Makes a stroke input where there is none.",
        "pencil sketch row guide line brush"
    ),
    tool!(
        "pen.points",
        Points,
        "Edit points",
        "Click, box or (with Ctrl) lasso points of strokes, and drag them. Double click a line to add a point.",
        "cv cvs vertex move handles control"
    ),
    tool!(
        "pen.redraw",
        Redraw,
        "Re-draw a part",
        "Draw a part of a stroke anew, from where you begin beside it to where you end.",
        "redraw correct fix overdraw"
    ),
    tool!(
        "pen.erase",
        Erase,
        "Erase strokes",
        "Removes every stroke that the brush passes. The eraser end of a pen always does.",
        "rubber delete remove"
    ),
    tool!(
        "pen.comb",
        Comb,
        "Comb strokes",
        "Pulls strokes the way the pen moves; roots stay. With Shift it smooths.",
        "brush drag pull groom"
    ),
    tool!(
        "pen.smooth_brush",
        Smooth,
        "Smooth with a brush",
        "Takes the wiggles out of strokes under the brush; ends stay.",
        "relax even"
    ),
    Action {
        id: "pen.brush_smaller",
        label: "Smaller brush",
        tip: "Makes the brush smaller by a fifth.",
        words: "size radius",
        menu: "",
        when: always,
        run: |editor| set(editor, |pen| pen.brush = (pen.brush() / 1.25).max(0.05)),
    },
    Action {
        id: "pen.brush_larger",
        label: "Larger brush",
        tip: "Makes the brush larger by a quarter.",
        words: "size radius",
        menu: "",
        when: always,
        run: |editor| set(editor, |pen| pen.brush = (pen.brush() * 1.25).min(20.0)),
    },
    Action {
        id: "pen.weaker",
        label: "Weaker brush",
        tip: "Makes a pass of the brush do less.",
        words: "strength opacity",
        menu: "",
        when: always,
        run: |editor| set(editor, |pen| pen.strength = (pen.strength() - 0.1).max(0.05)),
    },
    Action {
        id: "pen.stronger",
        label: "Stronger brush",
        tip: "Makes a pass of the brush do more.",
        words: "strength opacity",
        menu: "",
        when: always,
        run: |editor| set(editor, |pen| pen.strength = (pen.strength() + 0.1).min(1.0)),
    },
    Action {
        id: "pen.lighter",
        label: "Lighter mouse pressure",
        tip: "Lowers the pressure that a mouse draws with. Shift is always full pressure.",
        words: "force level",
        menu: "Pen",
        when: always,
        run: |editor| set(editor, |pen| pen.mouse_pressure = (pen.mouse_pressure - 0.1).max(0.0)),
    },
    Action {
        id: "pen.heavier",
        label: "Heavier mouse pressure",
        tip: "Raises the pressure that a mouse draws with. Shift is always full pressure.",
        words: "force level",
        menu: "Pen",
        when: always,
        run: |editor| set(editor, |pen| pen.mouse_pressure = (pen.mouse_pressure + 0.1).min(1.0)),
    },
    Action {
        id: "pen.symmetry",
        label: "Symmetry",
        tip: "Draws every stroke of the node on the other side of the head too; near the middle strokes snap to it.",
        words: "mirror both sides live x",
        menu: "Pen",
        when: always,
        run: symmetry,
    },
    Action {
        id: "pen.settings",
        label: "Pen settings",
        tip: "Pressure curve, stabiliser and double tap of each pen, with a strip to try them on.",
        words: "tablet stylus calibrate preferences left-handed",
        menu: "Pen",
        when: always,
        run: |editor| editor.pen.settings_open = !editor.pen.settings_open,
    },
    Action {
        id: "strokes.delete",
        label: "Delete strokes or points",
        tip: "Removes the picked strokes, or the picked points.",
        words: "remove erase cv",
        menu: "Pen",
        when: anything_picked,
        run: delete,
    },
    Action {
        id: "strokes.mirror_once",
        label: "Mirror strokes once",
        tip: "Adds the mirror images of the picked strokes as strokes of their own.",
        words: "symmetry flip copy other side",
        menu: "Pen",
        when: anything_picked,
        run: mirror_once,
    },
    Action {
        id: "recipe.cornrows",
        label: recipes::ALL[0].label,
        tip: recipes::ALL[0].tip,
        words: "recipe braid canerow plait",
        menu: "Pen",
        when: a_head,
        run: |editor| cook(editor, 0),
    },
    Action {
        id: "recipe.flat_twists",
        label: recipes::ALL[1].label,
        tip: recipes::ALL[1].tip,
        words: "recipe rope two strand",
        menu: "Pen",
        when: a_head,
        run: |editor| cook(editor, 1),
    },
    Action {
        id: "recipe.locks",
        label: recipes::ALL[2].label,
        tip: recipes::ALL[2].tip,
        words: "recipe clump cluster fringe wisp",
        menu: "Pen",
        when: a_head,
        run: |editor| cook(editor, 2),
    },
];

fn anything_picked(editor: &Editor) -> Result<(), &'static str> {
    match editor.pen.picked == Picked::default() {
        true => Err("pick strokes first: with \"Edit points\", click one"),
        false => Ok(()),
    }
}

fn a_head(editor: &Editor) -> Result<(), &'static str> {
    let head = target::head(&editor.state.document);
    head.map(|_| ()).ok_or("there is no head: add a head to the graph")
}

/// The node that the pen works on and the name of its input.
fn at(editor: &Editor) -> Option<(NodeId, &'static str)> {
    let node = target::of(&editor.state)?;
    let kind = &editor.state.document.node(node.as_str())?.kind;
    Some((node.clone(), target::strokes_input(kind)?))
}

/// Makes edits in one step, named after the node.
fn step(editor: &mut Editor, node: &NodeId, words: &str, edits: Vec<Edit>) {
    if edits.is_empty() {
        return;
    }
    let words = format!("{}: {words}", editor.state.document.name_of(node));
    editor.apply(Event::Begin(words));
    editor.apply(Event::Edit(Edit::Several(edits)));
    editor.apply(Event::End);
}

/// Toggles the mirror of the node that the pen works on; with none, of the one that drawing will make.
fn symmetry(editor: &mut Editor) {
    let document = &editor.state.document;
    let node = target::of(&editor.state);
    let mirror = node.as_ref().and_then(|id| target::choice(document, id, "mirror"));
    let (Some(node), Some(mirror)) = (node, mirror) else {
        set(editor, |pen| pen.symmetry = !pen.symmetry);
        return;
    };
    let both = mirror != "both";
    let word = if both { "both" } else { "none" };
    let setting = Setting::Known(Value::Text(word.into()));
    let edit = Edit::SetInput { node: node.clone(), input: "mirror".to_owned(), setting };
    set(editor, |pen| pen.symmetry = both);
    step(editor, &node, if both { "symmetry on" } else { "symmetry off" }, vec![edit]);
}

fn delete(editor: &mut Editor) {
    let Some((node, input)) = at(editor) else { return };
    let strokes = target::strokes(&editor.state.document, &node);
    let picked = std::mem::take(&mut editor.pen.picked);
    let mut edits = vec![];
    for stroke in &strokes.0 {
        let gone: BTreeSet<usize> =
            picked.points.iter().filter(|(id, _)| *id == stroke.id).map(|(_, at)| *at).collect();
        let whole = picked.strokes.contains(&stroke.id) || gone.len() + 2 > stroke.samples.len();
        let (node, input) = (node.clone(), input.to_owned());
        if whole && (picked.strokes.contains(&stroke.id) || !gone.is_empty()) {
            edits.push(Edit::RemoveStroke { node, input, id: stroke.id });
        } else if !gone.is_empty() {
            let left = stroke.samples.iter().enumerate().filter(|(i, _)| !gone.contains(i));
            let stroke = edits::edited(stroke, left.map(|(_, sample)| *sample).collect());
            edits.push(Edit::ReplaceStroke { node, input, stroke });
        }
    }
    let words = if picked.strokes.is_empty() { "points deleted" } else { "strokes deleted" };
    step(editor, &node, words, edits);
}

fn mirror_once(editor: &mut Editor) {
    let Some((node, input)) = at(editor) else { return };
    let mut strokes = (*target::strokes(&editor.state.document, &node)).clone();
    let mut edits = vec![];
    for id in editor.pen.picked.touched() {
        let Some(stroke) = strokes.0.iter().find(|stroke| stroke.id == id) else { continue };
        let mut twin = stroke.samples.clone();
        for sample in &mut twin {
            sample.position.x = -sample.position.x;
            sample.tilt.x = -sample.tilt.x;
        }
        let Some(twin) = finish(&twin, &strokes) else { continue };
        strokes.0.push(twin.clone());
        let (node, input) = (node.clone(), input.to_owned());
        edits.push(Edit::AddStroke { node, input, at: usize::MAX, stroke: twin });
    }
    step(editor, &node, "strokes mirrored", edits);
}

/// Makes a recipe and takes up the pen.
fn cook(editor: &mut Editor, recipe: usize) {
    let Some(recipe) = recipes::ALL.get(recipe) else { return };
    let state = &editor.state;
    let mirror = state.settings.pen.symmetry;
    let Some((rows, edits)) = recipe.edits(&state.document, state.active(), mirror) else {
        editor.apply(Event::Say(Note::warning(format!("{}: it could not be made", recipe.label))));
        return;
    };
    editor.apply(Event::Begin(format!("recipe: {}", recipe.label.to_lowercase())));
    editor.apply(Event::Edit(Edit::Several(edits)));
    editor.apply(Event::End);
    editor.apply(Event::Select(Select::Nodes(vec![rows.clone()])));
    editor.apply(Event::Pin(Some(rows)));
    editor.apply(Event::Show(Room::Viewport));
    editor.pen.tool = StrokeTool::Draw;
}
