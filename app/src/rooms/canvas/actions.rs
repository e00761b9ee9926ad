//! The canvas's part of the table of actions.

use super::{Canvas, Clipboard};
use crate::core::event::Event;
use crate::core::faces::arrange::Line;
use crate::core::state::State;
use crate::editor::Editor;
use crate::editor::actions::{Action, always};
use coif_graphs::document::{Node, NodeId};
use egui::{Vec2, vec2};

type When = fn(&Editor) -> Result<(), &'static str>;

/// Lets the canvas do something, and applies what happened.
fn canvas(editor: &mut Editor, act: impl Fn(&mut Canvas, &State) -> Vec<Event>) {
    for event in act(&mut editor.canvas, &editor.state) {
        editor.apply(event);
    }
}

const fn node(
    id: &'static str,
    label: &'static str,
    tip: &'static str,
    words: &'static str,
    when: When,
    run: fn(&mut Editor),
) -> Action {
    Action { id, label, tip, words, menu: "Node", when, run }
}

fn active(editor: &Editor) -> Result<(), &'static str> {
    editor.state.active().map(|_| ()).ok_or("no node is selected")
}
fn selected(editor: &Editor) -> Result<(), &'static str> {
    if editor.state.selection.nodes.is_empty() { Err("no node is selected") } else { Ok(()) }
}
fn two(editor: &Editor) -> Result<(), &'static str> {
    if editor.state.selection.nodes.len() < 2 {
        Err("fewer than two nodes are selected")
    } else {
        Ok(())
    }
}
fn is_group(editor: &Editor, id: &NodeId) -> bool {
    editor.state.document.node(id.as_str()).is_some_and(Node::is_group)
}
fn a_group(editor: &Editor) -> Result<(), &'static str> {
    let any = editor.state.selection.nodes.iter().any(|id| is_group(editor, id));
    if any { Ok(()) } else { Err("no group is selected") }
}
fn one_group(editor: &Editor) -> Result<(), &'static str> {
    let one = editor.state.active().is_some_and(|id| is_group(editor, id));
    if one { Ok(()) } else { Err("no group is selected") }
}
fn nodes(editor: &Editor) -> Result<(), &'static str> {
    if editor.state.document.nodes.is_empty() { Err("there are no nodes") } else { Ok(()) }
}
fn something(editor: &Editor) -> Result<(), &'static str> {
    let holds = editor.canvas.holds_something(&editor.state);
    if holds { Ok(()) } else { Err("nothing is selected on the canvas") }
}
fn one_wire(editor: &Editor) -> Result<(), &'static str> {
    let one = editor.canvas.memory.wires.len() == 1;
    if one { Ok(()) } else { Err("not one wire is selected") }
}
fn nameable(editor: &Editor) -> Result<(), &'static str> {
    let frame = editor.canvas.memory.frame.is_some();
    if frame { Ok(()) } else { active(editor) }
}

const STEP: f32 = 16.0;
const LEFT: Vec2 = vec2(-1.0, 0.0);
const RIGHT: Vec2 = vec2(1.0, 0.0);
const UP: Vec2 = vec2(0.0, -1.0);
const DOWN: Vec2 = vec2(0.0, 1.0);

/// A step of the selection: in no menu, keys and the palette have it.
macro_rules! steps {
    ($($id:literal, $label:literal, $way:ident;)*) => {[
        $(Action {
            id: concat!("canvas.", $id),
            label: concat!("Select the node ", $label),
            tip: "Moves the selection along wires, or to the node that lies this way.",
            words: "arrow walk next",
            menu: "",
            when: nodes,
            run: |editor| canvas(editor, |canvas, state| canvas.step(state, $way)),
        },
        Action {
            id: concat!("node.move_", $id),
            label: concat!("Move nodes ", $label),
            tip: "Moves the selected nodes on the canvas a little.",
            words: "nudge arrow position",
            menu: "",
            when: selected,
            run: |editor| canvas(editor, |canvas, state| canvas.nudge(state, STEP * $way)),
        },)*
    ]};
}

const STEPS: [Action; 8] = steps! {
    "left", "to the left", LEFT;
    "right", "to the right", RIGHT;
    "up", "above", UP;
    "down", "below", DOWN;
};

/// What can be done on the canvas by name.
pub(crate) const ACTIONS: &[&[Action]] = &[&NODES, &VIEWS, &STEPS];

const NODES: [Action; 31] = [
    node(
        "canvas.add",
        "Add node\u{2026}",
        "Searches a node by name, words of the trade or words of other tools, and adds it. With a node selected it proposes a wire.",
        "new create search tab",
        always,
        |editor| canvas(editor, Canvas::add),
    ),
    node(
        "node.display",
        "Display",
        "Shows this node in the viewport, whatever is selected. Again: shows the outputs.",
        "view flag eye show",
        active,
        |editor| canvas(editor, Canvas::display),
    ),
    node(
        "node.solo",
        "Solo",
        "Shows this node for a moment; again, what was shown before.",
        "isolate peek preview",
        |editor| if editor.canvas.memory.solo.is_some() { Ok(()) } else { active(editor) },
        |editor| canvas(editor, Canvas::solo),
    ),
    node(
        "node.bypass",
        "Bypass",
        "Lets the selected nodes pass their input through, or work again.",
        "disable mute skip off",
        selected,
        |editor| canvas(editor, Canvas::bypass),
    ),
    node(
        "node.pin",
        "Pin for the pen",
        "The pen works on this node, whatever is displayed. Again: lets it go.",
        "draw stroke edit lock",
        active,
        |editor| canvas(editor, Canvas::pin),
    ),
    node(
        "node.rename",
        "Rename",
        "Gives the node, or the selected frame, another name.",
        "label title call",
        nameable,
        |editor| canvas(editor, Canvas::rename),
    ),
    node(
        "node.note",
        "Note\u{2026}",
        "Writes a note on the node. It is shown with the node and kept in the file.",
        "comment text remark",
        active,
        |editor| canvas(editor, Canvas::note),
    ),
    node(
        "node.collapse",
        "Collapse",
        "Draws the selected nodes small, or whole again.",
        "fold minimise hide expand",
        selected,
        |editor| canvas(editor, Canvas::collapse),
    ),
    node(
        "node.swap",
        "Change the kind\u{2026}",
        "Makes another kind of the node. Values and wires that fit are kept.",
        "replace swap type convert",
        active,
        |editor| canvas(editor, Canvas::swap),
    ),
    node(
        "canvas.connect",
        "Wire to\u{2026}",
        "Searches the input that a wire from this node goes to.",
        "connect link plug",
        active,
        |editor| canvas(editor, Canvas::connect),
    ),
    node(
        "node.disconnect",
        "Disconnect",
        "Takes the wires off the selected nodes; hair runs past them. With wires selected: takes these off.",
        "unplug cut extract shake",
        |editor| if editor.canvas.memory.wires.is_empty() { selected(editor) } else { Ok(()) },
        |editor| canvas(editor, Canvas::disconnect),
    ),
    node(
        "node.duplicate",
        "Duplicate",
        "Copies the selected nodes beside themselves, with the wires they take.",
        "clone copy",
        selected,
        |editor| canvas(editor, Canvas::duplicate),
    ),
    node(
        "canvas.cut",
        "Cut",
        "Copies the selected nodes as text and removes them.",
        "clipboard",
        selected,
        |editor| editor.canvas.memory.clipboard = Some(Clipboard::Cut),
    ),
    node(
        "canvas.copy",
        "Copy",
        "Copies the selected nodes as text: it can be pasted here, in another groom, or in a mail.",
        "clipboard ron text",
        selected,
        |editor| editor.canvas.memory.clipboard = Some(Clipboard::Copy),
    ),
    node(
        "canvas.paste",
        "Paste",
        "Adds nodes from text: what was copied here, or a whole groom.",
        "clipboard ron text insert",
        always,
        |editor| editor.canvas.memory.clipboard = Some(Clipboard::Paste),
    ),
    node(
        "node.delete",
        "Delete",
        "Removes what is selected on the canvas: nodes, wires, a bend or a frame. Wires through removed nodes heal.",
        "remove erase dissolve",
        something,
        |editor| canvas(editor, Canvas::delete),
    ),
    node(
        "canvas.frame_nodes",
        "Frame the nodes",
        "Puts a comment frame round the selected nodes. They move with it.",
        "comment group box backdrop network",
        selected,
        |editor| canvas(editor, Canvas::frame_nodes),
    ),
    node(
        "canvas.group",
        "Group",
        "Puts the selected nodes into one node. What they take and give becomes its inputs and outputs.",
        "subnet nest container gizmo asset collapse",
        selected,
        |editor| canvas(editor, Canvas::group),
    ),
    node(
        "canvas.ungroup",
        "Ungroup",
        "Takes the selected groups apart: their nodes stand in their place, with the same values and wires.",
        "explode expand subnet",
        a_group,
        |editor| canvas(editor, Canvas::ungroup),
    ),
    node(
        "canvas.enter",
        "Enter the group",
        "Shows the nodes in the selected group. Double-click does the same.",
        "dive inside open subnet",
        one_group,
        |editor| canvas(editor, Canvas::enter),
    ),
    node(
        "canvas.leave",
        "Leave the group",
        "Shows what the group is in.",
        "up back out subnet",
        |editor| editor.state.group.as_ref().map(|_| ()).ok_or("no group is entered"),
        |editor| canvas(editor, Canvas::leave),
    ),
    node(
        "canvas.tidy",
        "Lay out",
        "Places the selected nodes, or all, in the order in which hair flows.",
        "arrange auto layout tidy clean",
        nodes,
        |editor| canvas(editor, Canvas::tidy),
    ),
    node(
        "canvas.align_left",
        "Align left",
        "Brings the selected nodes to the left edge of the outermost.",
        "arrange column",
        two,
        |editor| canvas(editor, |c, state| c.align(state, Line::Left)),
    ),
    node(
        "canvas.align_right",
        "Align right",
        "Brings the selected nodes to the right edge of the outermost.",
        "arrange column",
        two,
        |editor| canvas(editor, |c, state| c.align(state, Line::Right)),
    ),
    node(
        "canvas.align_top",
        "Align top",
        "Brings the selected nodes to the upper edge of the topmost.",
        "arrange row",
        two,
        |editor| canvas(editor, |c, state| c.align(state, Line::Top)),
    ),
    node(
        "canvas.align_bottom",
        "Align bottom",
        "Brings the selected nodes to the lower edge of the lowest.",
        "arrange row",
        two,
        |editor| canvas(editor, |c, state| c.align(state, Line::Bottom)),
    ),
    node(
        "canvas.distribute",
        "Distribute",
        "Makes the gaps between the selected nodes equal.",
        "arrange spread space even",
        two,
        |editor| canvas(editor, Canvas::distribute),
    ),
    node(
        "canvas.select_all",
        "Select all nodes",
        "Selects every node.",
        "everything",
        nodes,
        |editor| canvas(editor, Canvas::select_all),
    ),
    node(
        "canvas.select_upstream",
        "Select upstream",
        "Selects everything that feeds the selected nodes.",
        "inputs before history",
        selected,
        |editor| canvas(editor, |c, state| c.select_flow(state, false)),
    ),
    node(
        "canvas.select_downstream",
        "Select downstream",
        "Selects everything that hangs from the selected nodes.",
        "outputs after dependents",
        selected,
        |editor| canvas(editor, |c, state| c.select_flow(state, true)),
    ),
    node(
        "canvas.next_wire",
        "Select the next wire",
        "Selects the wires of the active node one after the other.",
        "link connection cycle",
        |editor| if editor.canvas.memory.wires.is_empty() { active(editor) } else { Ok(()) },
        |editor| canvas(editor, Canvas::next_wire),
    ),
];

const VIEWS: [Action; 4] = [
    Action {
        id: "canvas.fit_all",
        label: "Frame all nodes",
        tip: "Brings every node into sight.",
        words: "zoom fit home overview",
        menu: "View",
        when: always,
        run: |editor| canvas(editor, |canvas, state| canvas.fit(state, false)),
    },
    Action {
        id: "canvas.fit_selection",
        label: "Frame the selected nodes",
        tip: "Brings the selected nodes into sight.",
        words: "zoom fit focus",
        menu: "View",
        when: always,
        run: |editor| canvas(editor, |canvas, state| canvas.fit(state, true)),
    },
    Action {
        id: "canvas.wire_earlier",
        label: "Wire earlier",
        tip: "Moves the selected wire up among those of its input.",
        words: "order reorder up",
        menu: "",
        when: one_wire,
        run: |editor| canvas(editor, |canvas, state| canvas.reorder(state, -1)),
    },
    Action {
        id: "canvas.wire_later",
        label: "Wire later",
        tip: "Moves the selected wire down among those of its input.",
        words: "order reorder down",
        menu: "",
        when: one_wire,
        run: |editor| canvas(editor, |canvas, state| canvas.reorder(state, 1)),
    },
];
