//! The canvas's part of the table of actions.

use super::{Canvas, Clipboard, commands};
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
    if one { Ok(()) } else { Err("select exactly one wire") }
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
            tip: "Move the selection along wires, or to the next node in this direction.",
            words: "arrow walk next",
            menu: "",
            when: nodes,
            run: |canvas, state, out| out.extend(canvas.step(state, $way)),
        },
        Action {
            id: concat!("node.move_", $id),
            label: concat!("Move nodes ", $label),
            tip: "Nudge the selected nodes on the canvas.",
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
pub(crate) const ACTIONS: &[&[Of<Canvas>]] = &[&NODES, &VIEWS, &STEPS, &PUFFS];

/// Listed with the recipes of the pen: that is where people look for puffs.
const PUFFS: [Of<Canvas>; 1] = [Action {
    id: "recipe.puffs_at_ends",
    label: "Puffs at the ends of braids",
    tip: "Add a puff at the end of each braid, row or twist, as large as its neighbours leave room for.",
    words: "cornrows bunches pom tips afro",
    menu: "Pen",
    when: |_, state| commands::braid(state).map(|_| ()).ok_or("there are no braids"),
    run: |canvas, state, out| out.extend(canvas.puffs_at_ends(state)),
}];

const NODES: [Of<Canvas>; 31] = [
    node(
        "canvas.add",
        "Add node\u{2026}",
        "Search a node by its name, or its name in other tools, and add it. With a node selected, a wire is proposed.",
        "new create search tab",
        always,
        |canvas, state, out| out.extend(canvas.add(state)),
    ),
    node(
        "node.display",
        "Display",
        "Display this node in the viewport, whatever is selected. Again: display the outputs.",
        "view flag eye show",
        active,
        |canvas, state, out| out.extend(canvas.display(state)),
    ),
    node(
        "node.solo",
        "Solo",
        "Display this node for now; again: what was displayed before.",
        "isolate peek preview",
        |canvas, state| if canvas.memory.solo.is_some() { Ok(()) } else { active(canvas, state) },
        |canvas, state, out| out.extend(canvas.solo(state)),
    ),
    node(
        "node.bypass",
        "Bypass",
        "Bypass the selected nodes, or enable them again.",
        "disable mute skip off",
        selected,
        |canvas, state, out| out.extend(canvas.bypass(state)),
    ),
    node(
        "node.pin",
        "Pin for the pen",
        "Keep the pen on this node, whatever is displayed. Again: unpin it.",
        "draw stroke edit lock",
        active,
        |canvas, state, out| out.extend(canvas.pin(state)),
    ),
    node(
        "node.rename",
        "Rename",
        "Rename the node, or the selected frame.",
        "label title call",
        nameable,
        |canvas, state, out| out.extend(canvas.rename(state)),
    ),
    node(
        "node.note",
        "Note\u{2026}",
        "Write a note on the node, shown with it and saved in the file.",
        "comment text remark",
        active,
        |canvas, state, out| out.extend(canvas.note(state)),
    ),
    node(
        "node.collapse",
        "Collapse",
        "Collapse or expand the selected nodes.",
        "fold minimise hide expand",
        selected,
        |canvas, state, out| out.extend(canvas.collapse(state)),
    ),
    node(
        "node.swap",
        "Change the kind\u{2026}",
        "Replace the node by another kind. Values and wires that fit are kept.",
        "replace swap type convert",
        active,
        |canvas, state, out| out.extend(canvas.swap(state)),
    ),
    node(
        "canvas.connect",
        "Wire to\u{2026}",
        "Search an input to wire this node to.",
        "connect link plug",
        active,
        |canvas, state, out| out.extend(canvas.connect(state)),
    ),
    node(
        "node.disconnect",
        "Disconnect",
        "Unwire the selected nodes; their neighbours are wired to each other. With wires selected: remove these.",
        "unplug cut extract shake",
        |canvas, state| {
            if canvas.memory.wires.is_empty() { selected(canvas, state) } else { Ok(()) }
        },
        |canvas, state, out| out.extend(canvas.disconnect(state)),
    ),
    node(
        "node.duplicate",
        "Duplicate",
        "Duplicate the selected nodes, with their incoming wires.",
        "clone copy",
        selected,
        |canvas, state, out| out.extend(canvas.duplicate(state)),
    ),
    node(
        "canvas.cut",
        "Cut",
        "Copy the selected nodes as text and remove them.",
        "clipboard",
        selected,
        |canvas, _, _| canvas.memory.clipboard = Some(Clipboard::Cut),
    ),
    node(
        "canvas.copy",
        "Copy",
        "Copy the selected nodes as text. Paste it here, into another groom or into a message.",
        "clipboard ron text",
        selected,
        |canvas, _, _| canvas.memory.clipboard = Some(Clipboard::Copy),
    ),
    node(
        "canvas.paste",
        "Paste",
        "Add nodes from copied text, or a whole groom.",
        "clipboard ron text insert",
        always,
        |canvas, _, _| canvas.memory.clipboard = Some(Clipboard::Paste),
    ),
    node(
        "node.delete",
        "Delete",
        "Remove the selected nodes, wires, bend or frame. Wires through removed nodes are reconnected.",
        "remove erase dissolve",
        something,
        |canvas, state, out| out.extend(canvas.delete(state)),
    ),
    node(
        "canvas.frame_nodes",
        "Frame the nodes",
        "Put a comment frame around the selected nodes. They move with it.",
        "comment group box backdrop network",
        selected,
        |canvas, state, out| out.extend(canvas.frame_nodes(state)),
    ),
    node(
        "canvas.group",
        "Group",
        "Group the selected nodes into one. Wires across its border become its inputs and outputs.",
        "subnet nest container gizmo asset collapse",
        selected,
        |canvas, state, out| out.extend(canvas.group(state)),
    ),
    node(
        "canvas.ungroup",
        "Ungroup",
        "Replace the selected groups by the nodes in them, with the same values and wires.",
        "explode expand subnet",
        a_group,
        |canvas, state, out| out.extend(canvas.ungroup(state)),
    ),
    node(
        "canvas.enter",
        "Enter the group",
        "Show the nodes in the selected group. Also: double-click it.",
        "dive inside open subnet",
        one_group,
        |canvas, state, out| out.extend(canvas.enter(state)),
    ),
    node(
        "canvas.leave",
        "Leave the group",
        "Leave this group for the graph around it.",
        "up back out subnet",
        |_, state| state.group.as_ref().map(|_| ()).ok_or("no group is entered"),
        |canvas, state, out| out.extend(canvas.leave(state)),
    ),
    node(
        "canvas.tidy",
        "Lay out",
        "Lay out the selected nodes, or all, in the order of data flow.",
        "arrange auto layout tidy clean",
        nodes,
        |canvas, state, out| out.extend(canvas.tidy(state)),
    ),
    node(
        "canvas.align_left",
        "Align left",
        "Align the left edges of the selected nodes.",
        "arrange column",
        two,
        |canvas, state, out| out.extend(canvas.align(state, Alignment::Left)),
    ),
    node(
        "canvas.align_right",
        "Align right",
        "Align the right edges of the selected nodes.",
        "arrange column",
        two,
        |canvas, state, out| out.extend(canvas.align(state, Alignment::Right)),
    ),
    node(
        "canvas.align_top",
        "Align top",
        "Align the upper edges of the selected nodes.",
        "arrange row",
        two,
        |canvas, state, out| out.extend(canvas.align(state, Alignment::Top)),
    ),
    node(
        "canvas.align_bottom",
        "Align bottom",
        "Align the lower edges of the selected nodes.",
        "arrange row",
        two,
        |canvas, state, out| out.extend(canvas.align(state, Alignment::Bottom)),
    ),
    node(
        "canvas.distribute",
        "Distribute",
        "Make the gaps between the selected nodes equal.",
        "arrange spread space even",
        two,
        |canvas, state, out| out.extend(canvas.distribute(state)),
    ),
    node(
        "canvas.select_all",
        "Select all nodes",
        "Select every node.",
        "everything",
        nodes,
        |canvas, state, out| out.extend(canvas.select_all(state)),
    ),
    node(
        "canvas.select_upstream",
        "Select upstream",
        "Select all nodes that the selected ones depend on.",
        "inputs before history",
        selected,
        |canvas, state, out| out.extend(canvas.select_flow(state, false)),
    ),
    node(
        "canvas.select_downstream",
        "Select downstream",
        "Select all nodes that depend on the selected ones.",
        "outputs after dependents",
        selected,
        |canvas, state, out| out.extend(canvas.select_flow(state, true)),
    ),
    node(
        "canvas.next_wire",
        "Select the next wire",
        "Cycle through the wires of the active node.",
        "link connection cycle",
        |canvas, state| if canvas.memory.wires.is_empty() { active(canvas, state) } else { Ok(()) },
        |canvas, state, out| out.extend(canvas.next_wire(state)),
    ),
];

const VIEWS: [Of<Canvas>; 4] = [
    Action {
        id: "canvas.fit_all",
        label: "Frame all nodes",
        tip: "Fit all nodes in the canvas.",
        words: "zoom fit home overview",
        menu: "View",
        when: always,
        run: |canvas, state, out| out.extend(canvas.fit(state, false)),
    },
    Action {
        id: "canvas.fit_selection",
        label: "Frame the selected nodes",
        tip: "Fit the selected nodes in the canvas.",
        words: "zoom fit focus",
        menu: "View",
        when: always,
        run: |canvas, state, out| out.extend(canvas.fit(state, true)),
    },
    Action {
        id: "canvas.wire_earlier",
        label: "Wire earlier",
        tip: "Move the selected wire up in the order of its input.",
        words: "order reorder up",
        menu: "",
        when: one_wire,
        run: |canvas, state, out| out.extend(canvas.reorder(state, -1)),
    },
    Action {
        id: "canvas.wire_later",
        label: "Wire later",
        tip: "Move the selected wire down in the order of its input.",
        words: "order reorder down",
        menu: "",
        when: one_wire,
        run: |canvas, state, out| out.extend(canvas.reorder(state, 1)),
    },
];
