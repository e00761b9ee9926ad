//! The canvas's part of the table of actions.

use super::{Canvas, Clipboard};
use crate::core::action::{Action, Can, Of, always};
use crate::core::event::Event;
use crate::core::faces::arrange::Alignment;
use crate::core::state::State;
use coif_graphs::document::{Node, NodeId};
use egui::{Vec2, vec2};

type Run = fn(&mut Canvas, &State, &mut Vec<Event>);

const fn node(
    id: &'static str,
    label: &'static str,
    tip: &'static str,
    words: &'static str,
    when: fn(&Canvas, &State) -> Can,
    run: Run,
) -> Of<Canvas> {
    Action { id, label, tip, words, menu: "Node", when, run }
}

fn active(_: &Canvas, state: &State) -> Can {
    state.active().map(|_| ()).ok_or("no node is selected")
}
fn selected(_: &Canvas, state: &State) -> Can {
    if state.selection.nodes.is_empty() { Err("no node is selected") } else { Ok(()) }
}
fn two(_: &Canvas, state: &State) -> Can {
    if state.selection.nodes.len() < 2 { Err("fewer than two nodes are selected") } else { Ok(()) }
}
fn is_group(state: &State, id: &NodeId) -> bool {
    state.document.node(id.as_str()).is_some_and(Node::is_group)
}
fn a_group(_: &Canvas, state: &State) -> Can {
    let any = state.selection.nodes.iter().any(|id| is_group(state, id));
    if any { Ok(()) } else { Err("no group is selected") }
}
fn one_group(_: &Canvas, state: &State) -> Can {
    let one = state.active().is_some_and(|id| is_group(state, id));
    if one { Ok(()) } else { Err("no group is selected") }
}
fn nodes(_: &Canvas, state: &State) -> Can {
    if state.document.nodes.is_empty() { Err("there are no nodes") } else { Ok(()) }
}
fn something(canvas: &Canvas, state: &State) -> Can {
    let holds = canvas.holds_something(state);
    if holds { Ok(()) } else { Err("nothing is selected on the canvas") }
}
fn one_wire(canvas: &Canvas, _: &State) -> Can {
    let one = canvas.memory.wires.len() == 1;
    if one { Ok(()) } else { Err("not one wire is selected") }
}
fn nameable(canvas: &Canvas, state: &State) -> Can {
    let frame = canvas.memory.frame.is_some();
    if frame { Ok(()) } else { active(canvas, state) }
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
            run: |canvas, state, out| out.extend(canvas.step(state, $way)),
        },
        Action {
            id: concat!("node.move_", $id),
            label: concat!("Move nodes ", $label),
            tip: "Moves the selected nodes on the canvas a little.",
            words: "nudge arrow position",
            menu: "",
            when: selected,
            run: |canvas, state, out| out.extend(canvas.nudge(state, STEP * $way)),
        },)*
    ]};
}

const STEPS: [Of<Canvas>; 8] = steps! {
    "left", "to the left", LEFT;
    "right", "to the right", RIGHT;
    "up", "above", UP;
    "down", "below", DOWN;
};

/// What can be done on the canvas by name.
pub(crate) const ACTIONS: &[&[Of<Canvas>]] = &[&NODES, &VIEWS, &STEPS];

const NODES: [Of<Canvas>; 31] = [
    node(
        "canvas.add",
        "Add node\u{2026}",
        "Searches a node by name, words of the trade or words of other tools, and adds it. With a node selected it proposes a wire.",
        "new create search tab",
        always,
        |canvas, state, out| out.extend(canvas.add(state)),
    ),
    node(
        "node.display",
        "Display",
        "Shows this node in the viewport, whatever is selected. Again: shows the outputs.",
        "view flag eye show",
        active,
        |canvas, state, out| out.extend(canvas.display(state)),
    ),
    node(
        "node.solo",
        "Solo",
        "Shows this node for a moment; again, what was shown before.",
        "isolate peek preview",
        |canvas, state| if canvas.memory.solo.is_some() { Ok(()) } else { active(canvas, state) },
        |canvas, state, out| out.extend(canvas.solo(state)),
    ),
    node(
        "node.bypass",
        "Bypass",
        "Lets the selected nodes pass their input through, or work again.",
        "disable mute skip off",
        selected,
        |canvas, state, out| out.extend(canvas.bypass(state)),
    ),
    node(
        "node.pin",
        "Pin for the pen",
        "The pen works on this node, whatever is displayed. Again: lets it go.",
        "draw stroke edit lock",
        active,
        |canvas, state, out| out.extend(canvas.pin(state)),
    ),
    node(
        "node.rename",
        "Rename",
        "Gives the node, or the selected frame, another name.",
        "label title call",
        nameable,
        |canvas, state, out| out.extend(canvas.rename(state)),
    ),
    node(
        "node.note",
        "Note\u{2026}",
        "Writes a note on the node. It is shown with the node and kept in the file.",
        "comment text remark",
        active,
        |canvas, state, out| out.extend(canvas.note(state)),
    ),
    node(
        "node.collapse",
        "Collapse",
        "Draws the selected nodes small, or whole again.",
        "fold minimise hide expand",
        selected,
        |canvas, state, out| out.extend(canvas.collapse(state)),
    ),
    node(
        "node.swap",
        "Change the kind\u{2026}",
        "Makes another kind of the node. Values and wires that fit are kept.",
        "replace swap type convert",
        active,
        |canvas, state, out| out.extend(canvas.swap(state)),
    ),
    node(
        "canvas.connect",
        "Wire to\u{2026}",
        "Searches the input that a wire from this node goes to.",
        "connect link plug",
        active,
        |canvas, state, out| out.extend(canvas.connect(state)),
    ),
    node(
        "node.disconnect",
        "Disconnect",
        "Takes the wires off the selected nodes; hair runs past them. With wires selected: takes these off.",
        "unplug cut extract shake",
        |canvas, state| {
            if canvas.memory.wires.is_empty() { selected(canvas, state) } else { Ok(()) }
        },
        |canvas, state, out| out.extend(canvas.disconnect(state)),
    ),
    node(
        "node.duplicate",
        "Duplicate",
        "Copies the selected nodes beside themselves, with the wires they take.",
        "clone copy",
        selected,
        |canvas, state, out| out.extend(canvas.duplicate(state)),
    ),
    node(
        "canvas.cut",
        "Cut",
        "Copies the selected nodes as text and removes them.",
        "clipboard",
        selected,
        |canvas, _, _| canvas.memory.clipboard = Some(Clipboard::Cut),
    ),
    node(
        "canvas.copy",
        "Copy",
        "Copies the selected nodes as text: it can be pasted here, in another groom, or in a mail.",
        "clipboard ron text",
        selected,
        |canvas, _, _| canvas.memory.clipboard = Some(Clipboard::Copy),
    ),
    node(
        "canvas.paste",
        "Paste",
        "Adds nodes from text: what was copied here, or a whole groom.",
        "clipboard ron text insert",
        always,
        |canvas, _, _| canvas.memory.clipboard = Some(Clipboard::Paste),
    ),
    node(
        "node.delete",
        "Delete",
        "Removes what is selected on the canvas: nodes, wires, a bend or a frame. Wires through removed nodes heal.",
        "remove erase dissolve",
        something,
        |canvas, state, out| out.extend(canvas.delete(state)),
    ),
    node(
        "canvas.frame_nodes",
        "Frame the nodes",
        "Puts a comment frame round the selected nodes. They move with it.",
        "comment group box backdrop network",
        selected,
        |canvas, state, out| out.extend(canvas.frame_nodes(state)),
    ),
    node(
        "canvas.group",
        "Group",
        "Puts the selected nodes into one node. What they take and give becomes its inputs and outputs.",
        "subnet nest container gizmo asset collapse",
        selected,
        |canvas, state, out| out.extend(canvas.group(state)),
    ),
    node(
        "canvas.ungroup",
        "Ungroup",
        "Takes the selected groups apart: their nodes stand in their place, with the same values and wires.",
        "explode expand subnet",
        a_group,
        |canvas, state, out| out.extend(canvas.ungroup(state)),
    ),
    node(
        "canvas.enter",
        "Enter the group",
        "Shows the nodes in the selected group. Double-click does the same.",
        "dive inside open subnet",
        one_group,
        |canvas, state, out| out.extend(canvas.enter(state)),
    ),
    node(
        "canvas.leave",
        "Leave the group",
        "Shows what the group is in.",
        "up back out subnet",
        |_, state| state.group.as_ref().map(|_| ()).ok_or("no group is entered"),
        |canvas, state, out| out.extend(canvas.leave(state)),
    ),
    node(
        "canvas.tidy",
        "Lay out",
        "Places the selected nodes, or all, in the order in which hair flows.",
        "arrange auto layout tidy clean",
        nodes,
        |canvas, state, out| out.extend(canvas.tidy(state)),
    ),
    node(
        "canvas.align_left",
        "Align left",
        "Brings the selected nodes to the left edge of the outermost.",
        "arrange column",
        two,
        |canvas, state, out| out.extend(canvas.align(state, Alignment::Left)),
    ),
    node(
        "canvas.align_right",
        "Align right",
        "Brings the selected nodes to the right edge of the outermost.",
        "arrange column",
        two,
        |canvas, state, out| out.extend(canvas.align(state, Alignment::Right)),
    ),
    node(
        "canvas.align_top",
        "Align top",
        "Brings the selected nodes to the upper edge of the topmost.",
        "arrange row",
        two,
        |canvas, state, out| out.extend(canvas.align(state, Alignment::Top)),
    ),
    node(
        "canvas.align_bottom",
        "Align bottom",
        "Brings the selected nodes to the lower edge of the lowest.",
        "arrange row",
        two,
        |canvas, state, out| out.extend(canvas.align(state, Alignment::Bottom)),
    ),
    node(
        "canvas.distribute",
        "Distribute",
        "Makes the gaps between the selected nodes equal.",
        "arrange spread space even",
        two,
        |canvas, state, out| out.extend(canvas.distribute(state)),
    ),
    node(
        "canvas.select_all",
        "Select all nodes",
        "Selects every node.",
        "everything",
        nodes,
        |canvas, state, out| out.extend(canvas.select_all(state)),
    ),
    node(
        "canvas.select_upstream",
        "Select upstream",
        "Selects everything that feeds the selected nodes.",
        "inputs before history",
        selected,
        |canvas, state, out| out.extend(canvas.select_flow(state, false)),
    ),
    node(
        "canvas.select_downstream",
        "Select downstream",
        "Selects everything that hangs from the selected nodes.",
        "outputs after dependents",
        selected,
        |canvas, state, out| out.extend(canvas.select_flow(state, true)),
    ),
    node(
        "canvas.next_wire",
        "Select the next wire",
        "Selects the wires of the active node one after the other.",
        "link connection cycle",
        |canvas, state| if canvas.memory.wires.is_empty() { active(canvas, state) } else { Ok(()) },
        |canvas, state, out| out.extend(canvas.next_wire(state)),
    ),
];

const VIEWS: [Of<Canvas>; 4] = [
    Action {
        id: "canvas.fit_all",
        label: "Frame all nodes",
        tip: "Brings every node into sight.",
        words: "zoom fit home overview",
        menu: "View",
        when: always,
        run: |canvas, state, out| out.extend(canvas.fit(state, false)),
    },
    Action {
        id: "canvas.fit_selection",
        label: "Frame the selected nodes",
        tip: "Brings the selected nodes into sight.",
        words: "zoom fit focus",
        menu: "View",
        when: always,
        run: |canvas, state, out| out.extend(canvas.fit(state, true)),
    },
    Action {
        id: "canvas.wire_earlier",
        label: "Wire earlier",
        tip: "Moves the selected wire up among those of its input.",
        words: "order reorder up",
        menu: "",
        when: one_wire,
        run: |canvas, state, out| out.extend(canvas.reorder(state, -1)),
    },
    Action {
        id: "canvas.wire_later",
        label: "Wire later",
        tip: "Moves the selected wire down among those of its input.",
        words: "order reorder down",
        menu: "",
        when: one_wire,
        run: |canvas, state, out| out.extend(canvas.reorder(state, 1)),
    },
];
