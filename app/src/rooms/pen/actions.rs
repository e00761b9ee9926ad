//! What the pen room can do by name: tools, brushes, symmetry, what happens to picked strokes and points, recipes.

use super::target::{self, Fills};
use super::{Pen, PenTool, StrokeSelection, leave_out, partings, recipes};
use crate::core::action::{Action, Can, Of, always};
use crate::core::event::Event;
use crate::core::notes::Note;
use crate::core::room::Room;
use crate::core::settings::Settings;
use crate::core::state::{Select, State};
use coif_graphs::document::edit::Edit;
use coif_graphs::document::strokes::cvs;
use coif_graphs::document::strokes::whole::{self, End};
use coif_graphs::document::{NodeId, Setting, wiring};
use coif_nodes::data::gestures::Tool;
use coif_nodes::data::strokes::{Mode, Stroke};
use coif_nodes::define::Value;
use std::collections::BTreeSet;

/// A tool that is taken up.
macro_rules! tool {
    ($id:literal, $tool:ident, $label:literal, $tip:literal, $words:literal) => {
        tool!($id, |pen, _, _| pen.tool = PenTool::$tool, $label, $tip, $words)
    };
    ($id:literal, $tool:ident or $hair:ident, $label:literal, $tip:literal, $words:literal) => {
        tool!(
            $id,
            |pen, state, _| same_on_hair(pen, state, PenTool::$tool, Tool::$hair),
            $label,
            $tip,
            $words
        )
    };
    ($id:literal, $run:expr, $label:literal, $tip:literal, $words:literal) => {
        taken_up($id, $label, $tip, $words, $run)
    };
}

/// An action that takes up a tool: it stands in the pen's menu, and can always be done.
pub(crate) const fn taken_up(
    id: &'static str,
    label: &'static str,
    tip: &'static str,
    words: &'static str,
    run: fn(&mut Pen, &State, &mut Vec<Event>),
) -> Of<Pen> {
    Action { id, label, tip, words, menu: "Pen", when: always, run }
}

/// A recipe that is made.
macro_rules! recipe {
    ($at:literal, $words:literal) => {
        Action {
            id: recipes::ALL[$at].action,
            label: recipes::ALL[$at].label,
            tip: recipes::ALL[$at].tip,
            words: $words,
            menu: "Pen",
            when: always,
            run: |pen, state, out| ask(pen, state, $at, out),
        }
    };
}

/// A change of a setting of the pen.
fn set(
    state: &State,
    out: &mut Vec<Event>,
    change: impl FnOnce(&mut crate::core::pen::PenSettings),
) {
    let mut settings: Settings = state.settings.clone();
    change(&mut settings.pen);
    out.push(Event::Settings(settings.into()));
}

/// A brush of another size: that of the tool in hand.
fn sized(pen: &Pen, state: &State, by: f32, out: &mut Vec<Event>) {
    let hair = matches!(pen.tool, PenTool::Hair(_));
    set(state, out, |pen| match hair {
        true => pen.hair_brush = (pen.hair_brush() * by).clamp(0.1, 50.0),
        false => pen.brush = (pen.brush() * by).clamp(0.05, 20.0),
    });
}

/// Takes up a tool on strokes, or on hair or a mask the one of the same name. Where hair was sketched and no stroke was drawn it is
/// hair that is meant.
fn same_on_hair(pen: &mut Pen, state: &State, strokes: PenTool, hair: Tool) {
    let sketched =
        target::of(state, Fills::Strokes).is_none() && target::of(state, Fills::Hair).is_some();
    pen.tool = match pen.tool {
        PenTool::Mask(_) if matches!(hair, Tool::Point | Tool::Redraw) => strokes,
        PenTool::Hair(_) => PenTool::Hair(Some(hair)),
        PenTool::Select | PenTool::Draw if sketched => PenTool::Hair(Some(hair)),
        PenTool::Mask(mode) => PenTool::Mask(match hair {
            Tool::Cut => Mode::Erase,
            Tool::Smooth => Mode::Smooth,
            _ => mode,
        }),
        _ => strokes,
    };
}

/// What can be done by name.
pub(crate) const ACTIONS: &[Of<Pen>] = &[
    tool!(
        "pen.select",
        Select,
        "Select and turn",
        "Select in the viewport and turn the view, without drawing.",
        "arrow pick none"
    ),
    tool!(
        "pen.draw",
        Draw,
        "Draw strokes",
        "Draw strokes on the scalp, or in space if the node projects none. Adds a Stroke input node if needed.",
        "pencil sketch row guide line brush"
    ),
    Action {
        id: "pen.region",
        label: "Draw region",
        tip: "Draw closed strokes on the head: hair grows inside them. They are the outlines of the selected Region node, else of the head's own region. Again: finish.",
        words: "region hairline outline scalp grow closed where beard brows",
        menu: "Pen",
        when: a_head,
        run: |pen, state, out| {
            let node = target::region(state);
            let off = node.is_some() && state.pinned == node;
            pen.tool = if off { PenTool::Select } else { PenTool::Draw };
            out.push(Event::Pin(node.filter(|_| !off)));
        },
    },
    Action {
        id: "pen.new_region",
        label: "New region",
        tip: "Add a place on the head where other hair grows, such as a beard or brows, and draw its outline.",
        words: "region outline beard brow eyebrow moustache second several area face body",
        menu: "Pen",
        when: a_head,
        run: |pen, state, out| {
            let Some((node, edits)) = target::make_region(&state.document) else { return };
            out.push(Event::Begin("region added".to_owned()));
            out.extend(edits.into_iter().map(Event::Edit));
            out.extend([Event::End, Event::Select(Select::Nodes(vec![node.clone()]))]);
            out.push(Event::Pin(Some(node)));
            pen.tool = PenTool::Draw;
        },
    },
    Action {
        id: "pen.leave_out",
        label: "Leave out an area",
        tip: "Draw around a place on the head, such as a tail, feet or eyes: no hair grows inside. Symmetry leaves it out on both sides.",
        words: "bare exclude without no hair remove region tail feet paws hooves eyes nose outline skin",
        menu: "Pen",
        when: a_head,
        run: |pen, state, out| {
            let mirror = state.settings.pen.symmetry;
            leave_out(pen, PenTool::Draw, leave_out::region(&state.document, mirror), out);
        },
    },
    Action {
        id: "pen.leave_out_painted",
        label: "Leave out by painting",
        tip: "Erase hair from the head with a brush, such as from a tail or feet: none grows where it is erased.",
        words: "bare exclude without no hair remove mask tail feet paws hooves eyes nose erase skin brush",
        menu: "Pen",
        when: a_head,
        run: |pen, state, out| {
            let tool = PenTool::Mask(Mode::Erase);
            leave_out(pen, tool, leave_out::painted(&state.document), out);
        },
    },
    Action {
        id: "pen.partings",
        label: "Edit found partings",
        tip: "Turn the partings found between drawn hair into drawn lines, to move, cut or delete.",
        words: "part parting move remove line hair flow strokes",
        menu: "Pen",
        when: |_, state| partings::can_edit(state),
        run: |pen, state, out| partings::edit(pen, state, out),
    },
    tool!(
        "pen.points",
        Points or Point,
        "Edit points",
        "Select stroke points by click, box or lasso (Ctrl) and drag them. Double-click a stroke to add a point.",
        "cv cvs vertex move handles control"
    ),
    tool!(
        "pen.redraw",
        Redraw or Redraw,
        "Re-draw a part",
        "Redraw part of a stroke, from where you begin beside it to where you end.",
        "redraw correct fix overdraw"
    ),
    tool!(
        "pen.erase",
        Erase or Cut,
        "Erase strokes",
        "Erase strokes under the brush, as the pen's eraser always does. With a hair tool: cut hair.",
        "rubber delete remove"
    ),
    tool!(
        "pen.comb",
        Comb or Comb,
        "Comb strokes",
        "Pull strokes along with the pen; roots stay. Shift smooths. With a hair tool: comb hair.",
        "brush drag pull groom"
    ),
    tool!(
        "pen.smooth_brush",
        Smooth or Smooth,
        "Smooth with a brush",
        "Smooth strokes under the brush; ends stay. With a hair tool: smooth hair.",
        "relax even"
    ),
    Action {
        id: "pen.brush_smaller",
        label: "Smaller brush",
        tip: "Make the brush smaller by a fifth.",
        words: "size radius",
        menu: "",
        when: always,
        run: |pen, state, out| sized(pen, state, 1.0 / 1.25, out),
    },
    Action {
        id: "pen.brush_larger",
        label: "Larger brush",
        tip: "Make the brush larger by a quarter.",
        words: "size radius",
        menu: "",
        when: always,
        run: |pen, state, out| sized(pen, state, 1.25, out),
    },
    Action {
        id: "pen.weaker",
        label: "Weaker brush",
        tip: "Lower the strength of the brush.",
        words: "strength opacity",
        menu: "",
        when: always,
        run: |_, state, out| set(state, out, |pen| pen.strength = (pen.strength() - 0.1).max(0.05)),
    },
    Action {
        id: "pen.stronger",
        label: "Stronger brush",
        tip: "Raise the strength of the brush.",
        words: "strength opacity",
        menu: "",
        when: always,
        run: |_, state, out| set(state, out, |pen| pen.strength = (pen.strength() + 0.1).min(1.0)),
    },
    Action {
        id: "pen.lighter",
        label: "Lighter mouse pressure",
        tip: "Lower the pressure that a mouse draws with. Shift is always full pressure.",
        words: "force level",
        menu: "Pen",
        when: always,
        run: |_, state, out| {
            set(state, out, |pen| pen.mouse_pressure = (pen.mouse_pressure - 0.1).max(0.0))
        },
    },
    Action {
        id: "pen.heavier",
        label: "Heavier mouse pressure",
        tip: "Raise the pressure that a mouse draws with. Shift is always full pressure.",
        words: "force level",
        menu: "Pen",
        when: always,
        run: |_, state, out| {
            set(state, out, |pen| pen.mouse_pressure = (pen.mouse_pressure + 0.1).min(1.0))
        },
    },
    Action {
        id: "pen.symmetry",
        label: "Symmetry",
        tip: "Mirror strokes and gestures to the other side of the head. Strokes near the midline snap to it.",
        words: "mirror both sides live x",
        menu: "Pen",
        when: always,
        run: symmetry,
    },
    Action {
        id: "pen.settings",
        label: "Pen settings",
        tip: "Pressure curve, stabiliser and double tap of each pen, with a strip to test them.",
        words: "tablet stylus calibrate preferences left-handed",
        menu: "Pen",
        when: always,
        run: |pen, _, _| pen.settings_open = !pen.settings_open,
    },
    Action {
        id: "pen.words",
        label: "Words beside tools",
        tip: "Write the names of the pen's tools beside their icons, in as many rows as that takes.",
        words: "names labels icons text bar toolbar",
        menu: "Pen",
        when: always,
        run: |_, state, out| {
            let mut settings = state.settings.clone();
            settings.pen.words = !settings.pen.words;
            out.push(Event::Settings(settings.into()));
        },
    },
    Action {
        id: "strokes.delete",
        label: "Delete strokes or points",
        tip: "Remove the picked strokes or points.",
        words: "remove erase cv",
        menu: "Pen",
        when: anything_picked,
        run: delete,
    },
    Action {
        id: "strokes.all",
        label: "Pick all strokes",
        tip: "Pick every stroke of the pen's node.",
        words: "select everything",
        menu: "Pen",
        when: any_strokes,
        run: pick_all,
    },
    Action {
        id: "strokes.grow",
        label: "Grow the pick",
        tip: "Pick one more point on each side of the picked ones; with a stroke picked, all its points.",
        words: "select more expand",
        menu: "Pen",
        when: anything_picked,
        run: grow,
    },
    Action {
        id: "strokes.reverse",
        label: "Reverse strokes",
        tip: "Reverse the picked strokes: root and tip swap.",
        words: "flip direction turn",
        menu: "Pen",
        when: anything_picked,
        run: |pen, state, out| {
            each(pen, state, out, "strokes reversed", |stroke, _| Some(whole::reversed(stroke)))
        },
    },
    Action {
        id: "strokes.smooth",
        label: "Smooth strokes",
        tip: "Smooth the picked strokes, or around the picked points. Repeat for more.",
        words: "relax even fair",
        menu: "Pen",
        when: anything_picked,
        run: smooth,
    },
    Action {
        id: "strokes.straighten",
        label: "Straighten strokes",
        tip: "Straighten the stroke between the first and last picked points, or all of it without points.",
        words: "line flatten",
        menu: "Pen",
        when: anything_picked,
        run: straighten,
    },
    Action {
        id: "strokes.extend",
        label: "Extend strokes",
        tip: "Extend the picked strokes straight by 1 cm at the tip.",
        words: "longer grow",
        menu: "Pen",
        when: anything_picked,
        run: |pen, state, out| {
            each(pen, state, out, "strokes extended", |stroke, _| {
                whole::extended(stroke, End::Tip, 1.0)
            })
        },
    },
    Action {
        id: "strokes.shorten",
        label: "Shorten strokes",
        tip: "Shorten the picked strokes by 1 cm at the tip.",
        words: "trim cut",
        menu: "Pen",
        when: anything_picked,
        run: |pen, state, out| {
            each(pen, state, out, "strokes shortened", |stroke, _| {
                whole::extended(stroke, End::Tip, -1.0)
            })
        },
    },
    Action {
        id: "strokes.cut",
        label: "Cut strokes",
        tip: "Split strokes at their picked points.",
        words: "split divide",
        menu: "Pen",
        when: points_picked,
        run: cut,
    },
    Action {
        id: "strokes.join",
        label: "Join strokes",
        tip: "Join two picked strokes at their nearest ends.",
        words: "connect merge weld",
        menu: "Pen",
        when: two_picked,
        run: join,
    },
    Action {
        id: "strokes.insert",
        label: "Insert points",
        tip: "Add a point halfway after each picked point, or after every point.",
        words: "subdivide cv add",
        menu: "Pen",
        when: anything_picked,
        run: insert,
    },
    Action {
        id: "strokes.slide_tip",
        label: "Slide towards the tip",
        tip: "Slide the picked points along their strokes by 1 mm, toward the tip.",
        words: "move along",
        menu: "Pen",
        when: points_picked,
        run: |pen, state, out| slide(pen, state, 0.1, out),
    },
    Action {
        id: "strokes.slide_root",
        label: "Slide towards the root",
        tip: "Slide the picked points along their strokes by 1 mm, toward the root.",
        words: "move along",
        menu: "Pen",
        when: points_picked,
        run: |pen, state, out| slide(pen, state, -0.1, out),
    },
    Action {
        id: "strokes.refit",
        label: "Restore drawn strokes",
        tip: "Discard all point edits: the picked strokes are as drawn again.",
        words: "re-fit reset original",
        menu: "Pen",
        when: anything_picked,
        run: |pen, state, out| {
            each(pen, state, out, "strokes as drawn", |stroke, _| Some(cvs::refitted(stroke)))
        },
    },
    Action {
        id: "strokes.mirror_once",
        label: "Mirror strokes once",
        tip: "Add the mirror images of the picked strokes as new strokes.",
        words: "symmetry flip copy other side",
        menu: "Pen",
        when: anything_picked,
        run: mirror_once,
    },
    recipe!(0, "recipe flow direct strokes guides haircut style bob swept back few pen"),
    recipe!(1, "recipe gesture hairstyle pen implant cluster"),
    recipe!(2, "recipe braid canerow plait"),
    recipe!(3, "recipe rope two strand row"),
    recipe!(4, "recipe braid plait hanging three strand"),
    recipe!(5, "recipe rope hanging"),
    recipe!(6, "recipe clump cluster fringe wisp"),
    recipe!(7, "recipe loose hair sleek parting middle"),
    recipe!(8, "recipe loose hair level cut parting side"),
    recipe!(9, "recipe loose hair wavy parting side"),
    recipe!(10, "recipe loose hair bangs forehead"),
    recipe!(11, "recipe tail tied gathered"),
    recipe!(12, "recipe bun ball afro pom"),
    recipe!(13, "recipe kinky round natural 4c"),
    recipe!(14, "recipe loose hair crop fade men barber clippers"),
    recipe!(15, "recipe face facial moustache mustache stubble goatee men"),
    recipe!(16, "recipe face eyebrow eyebrows"),
];

fn anything_picked(pen: &Pen, _: &State) -> Can {
    match pen.picked == StrokeSelection::default() {
        true => Err("pick strokes first: with \"Edit points\", click one"),
        false => Ok(()),
    }
}

fn points_picked(pen: &Pen, _: &State) -> Can {
    match pen.picked.points.is_empty() {
        true => Err("pick points first: with \"Edit points\", click one"),
        false => Ok(()),
    }
}

fn two_picked(pen: &Pen, _: &State) -> Can {
    match pen.picked.touched().len() {
        2 => Ok(()),
        _ => Err("pick two strokes: with \"Edit points\", click one, and the other with Shift"),
    }
}

fn any_strokes(_: &Pen, state: &State) -> Can {
    let strokes = at(state).map(|(node, _)| target::strokes(&state.document, &node));
    match strokes.is_some_and(|strokes| !strokes.0.is_empty()) {
        true => Ok(()),
        false => Err("there are no strokes: draw one"),
    }
}

fn a_head(_: &Pen, state: &State) -> Can {
    let head = target::head(&state.document);
    head.map(|_| ()).ok_or("there is no head: add a head to the graph")
}

/// The node that the pen works on and the name of its input.
fn at(state: &State) -> Option<(NodeId, &'static str)> {
    let node = target::of(state, Fills::Strokes)?;
    let kind = &state.document.node(node.as_str())?.kind;
    Some((node.clone(), target::strokes_input(kind)?))
}

/// Makes edits in one step, named after the node.
pub(super) fn step(
    state: &State,
    node: &NodeId,
    words: &str,
    edits: Vec<Edit>,
    out: &mut Vec<Event>,
) {
    if edits.is_empty() {
        return;
    }
    let words = format!("{}: {words}", state.document.name_of(node));
    out.push(Event::Begin(words));
    out.push(Event::Edit(Edit::Several(edits)));
    out.push(Event::End);
}

/// Takes up a tool for the node that leaves out areas, and adds that node first if needed.
fn leave_out(
    pen: &mut Pen,
    tool: PenTool,
    into: Option<(NodeId, Vec<Edit>)>,
    out: &mut Vec<Event>,
) {
    let Some((node, edits)) = into else { return };
    if !edits.is_empty() {
        out.push(Event::Begin("a place to leave out added".to_owned()));
        out.extend(edits.into_iter().map(Event::Edit));
        out.push(Event::End);
    }
    out.extend([Event::Select(Select::Nodes(vec![node.clone()])), Event::Pin(Some(node))]);
    out.push(Event::Show(Room::Viewport));
    pen.tool = tool;
}

/// Toggles the mirror of the node that the pen works on; with none, of the one that drawing will make.
fn symmetry(pen: &mut Pen, state: &State, out: &mut Vec<Event>) {
    if matches!(pen.tool, PenTool::Mask(_)) {
        return set(state, out, |pen| pen.symmetry = !pen.symmetry);
    }
    let document = &state.document;
    let strokes = !matches!(pen.tool, PenTool::Hair(_));
    let node = target::of(state, Fills::Strokes).filter(|_| strokes);
    let mirror = node.as_ref().and_then(|id| target::choice(document, id, "mirror"));
    let (Some(node), Some(mirror)) = (node, mirror) else {
        set(state, out, |pen| pen.symmetry = !pen.symmetry);
        return;
    };
    let both = mirror != "both";
    let word = if both { "both" } else { "none" };
    let setting = Setting::Known(Value::Text(word.into()));
    let edit = Edit::SetInput { node: node.clone(), input: "mirror".to_owned(), setting };
    set(state, out, |pen| pen.symmetry = both);
    step(state, &node, if both { "symmetry on" } else { "symmetry off" }, vec![edit], out);
}

/// A change of every picked stroke, in one step: what it becomes by its picked points, or none where it stays.
fn each(
    pen: &Pen,
    state: &State,
    out: &mut Vec<Event>,
    words: &str,
    change: impl Fn(&Stroke, &BTreeSet<usize>) -> Option<Stroke>,
) {
    let Some((node, input)) = at(state) else { return };
    let strokes = target::strokes(&state.document, &node);
    let picked = &pen.picked;
    let touched = picked.touched();
    let mut edits = vec![];
    for stroke in strokes.0.iter().filter(|stroke| touched.contains(&stroke.id)) {
        let new = change(stroke, &picked.points_of(stroke.id)).filter(|new| new != stroke);
        edits.extend(new.map(|stroke| Edit::ReplaceStroke {
            node: node.clone(),
            input: input.to_owned(),
            stroke,
        }));
    }
    step(state, &node, words, edits, out);
}

fn smooth(pen: &mut Pen, state: &State, out: &mut Vec<Event>) {
    let reach = state.settings.pen.falloff;
    each(pen, state, out, "strokes smoothed", |stroke, points| {
        let weights = match points.is_empty() {
            true => vec![1.0; stroke.samples.len()],
            false => cvs::falloff(stroke, points, reach),
        };
        Some((0..8).fold(stroke.clone(), |stroke, _| cvs::smoothed(&stroke, &weights)))
    });
}

fn straighten(pen: &mut Pen, state: &State, out: &mut Vec<Event>) {
    each(pen, state, out, "strokes straightened", |stroke, points| {
        let last = stroke.samples.len().checked_sub(1)?;
        let (from, to) = match (points.first(), points.last()) {
            (Some(from), Some(to)) if from < to => (*from, *to),
            _ => (0, last),
        };
        Some(cvs::straightened(stroke, from, to, 1.0))
    });
}

fn insert(pen: &mut Pen, state: &State, out: &mut Vec<Event>) {
    each(pen, state, out, "points inserted", |stroke, points| {
        let ways = cvs::ways(&stroke.samples);
        let gaps = ways.windows(2).enumerate();
        let gaps = gaps.filter(|(i, _)| points.is_empty() || points.contains(i));
        let middles: Vec<f32> = gaps.map(|(_, gap)| (gap[0] + gap[1]) * 0.5).collect();
        // From the tip on: what is inserted changes the ways behind it by a rounding.
        let insert = |stroke, way: &f32| Some(cvs::inserted(&stroke, *way)?.0);
        middles.iter().rev().try_fold(stroke.clone(), insert)
    });
}

fn slide(pen: &Pen, state: &State, by: f32, out: &mut Vec<Event>) {
    each(pen, state, out, "points slid", |stroke, points| {
        // The foremost goes first, so that the others have room.
        let mut order: Vec<usize> = points.iter().copied().collect();
        if by > 0.0 {
            order.reverse();
        }
        Some(order.iter().fold(stroke.clone(), |stroke, cv| cvs::slid(&stroke, *cv, by)))
    });
}

fn pick_all(pen: &mut Pen, state: &State, _: &mut Vec<Event>) {
    let Some((node, _)) = at(state) else { return };
    let strokes = target::strokes(&state.document, &node);
    let strokes = strokes.0.iter().map(|stroke| stroke.id).collect();
    pen.picked = StrokeSelection { strokes, ..StrokeSelection::default() };
}

fn grow(pen: &mut Pen, state: &State, _: &mut Vec<Event>) {
    let Some((node, _)) = at(state) else { return };
    let strokes = target::strokes(&state.document, &node);
    let picked = &mut pen.picked;
    let more: Vec<(u64, usize)> = picked
        .points
        .iter()
        .flat_map(|(id, at)| [(*id, at.saturating_sub(1)), (*id, at + 1)])
        .collect();
    picked.points.extend(more);
    for stroke in strokes.0.iter().filter(|stroke| picked.strokes.contains(&stroke.id)) {
        picked.points.extend((0..stroke.samples.len()).map(|at| (stroke.id, at)));
    }
    picked.keep(&strokes);
}

fn delete(pen: &mut Pen, state: &State, out: &mut Vec<Event>) {
    let Some((node, input)) = at(state) else { return };
    let strokes = target::strokes(&state.document, &node);
    let picked = std::mem::take(&mut pen.picked);
    let touched = picked.touched();
    let mut edits = vec![];
    for stroke in strokes.0.iter().filter(|stroke| touched.contains(&stroke.id)) {
        let (node, input) = (node.clone(), input.to_owned());
        let points = picked.points_of(stroke.id);
        let left = if points.is_empty() { None } else { cvs::deleted(stroke, &points) };
        edits.push(match left {
            Some(stroke) => Edit::ReplaceStroke { node, input, stroke },
            None => Edit::RemoveStroke { node, input, id: stroke.id },
        });
    }
    let words = if picked.points.is_empty() { "strokes deleted" } else { "points deleted" };
    step(state, &node, words, edits, out);
}

fn mirror_once(pen: &mut Pen, state: &State, out: &mut Vec<Event>) {
    let Some((node, input)) = at(state) else { return };
    let mut strokes = (*target::strokes(&state.document, &node)).clone();
    let mut edits = vec![];
    for id in pen.picked.touched() {
        let Some(stroke) = strokes.0.iter().find(|stroke| stroke.id == id) else { continue };
        let twin = cvs::mirrored(stroke, &strokes);
        strokes.0.push(twin.clone());
        let (node, input) = (node.clone(), input.to_owned());
        edits.push(Edit::AddStroke { node, input, at: usize::MAX, stroke: twin });
    }
    step(state, &node, "strokes mirrored", edits, out);
}

fn cut(pen: &mut Pen, state: &State, out: &mut Vec<Event>) {
    let Some((node, input)) = at(state) else { return };
    let mut strokes = (*target::strokes(&state.document, &node)).clone();
    let points = std::mem::take(&mut pen.picked).points;
    let mut edits = vec![];
    // From the tip on, so that numbers of points hold.
    for (id, at) in points.into_iter().rev() {
        let Some(i) = strokes.0.iter().position(|stroke| stroke.id == id) else { continue };
        let Some(way) = cvs::ways(&strokes.0[i].samples).get(at).copied() else { continue };
        let Some((low, high)) = whole::cut(&strokes.0[i], way, &strokes) else { continue };
        strokes.0[i] = low.clone();
        strokes.0.push(high.clone());
        let (node, input) = (node.clone(), input.to_owned());
        edits.push(Edit::ReplaceStroke { node: node.clone(), input: input.clone(), stroke: low });
        edits.push(Edit::AddStroke { node, input, at: usize::MAX, stroke: high });
    }
    step(state, &node, "strokes cut", edits, out);
}

fn join(pen: &mut Pen, state: &State, out: &mut Vec<Event>) {
    let Some((node, input)) = at(state) else { return };
    let strokes = target::strokes(&state.document, &node);
    let touched = pen.picked.touched();
    // In drawing order: the first keeps its name and its root.
    let mut two = strokes.0.iter().filter(|stroke| touched.contains(&stroke.id));
    let (Some(first), Some(second)) = (two.next(), two.next()) else { return };
    let (stroke, id) = (whole::joined(first, second), second.id);
    pen.picked = StrokeSelection::of_stroke(stroke.id);
    let input = input.to_owned();
    let edits = vec![
        Edit::RemoveStroke { node: node.clone(), input: input.clone(), id },
        Edit::ReplaceStroke { node: node.clone(), input, stroke },
    ];
    step(state, &node, "strokes joined", edits, out);
}

/// Makes a recipe on a bare head; over hair it is asked first whether that stays, but for what grows elsewhere.
fn ask(pen: &mut Pen, state: &State, recipe: usize, out: &mut Vec<Event>) {
    let elsewhere = recipes::ALL.get(recipe).is_some_and(recipes::Recipe::grows_elsewhere);
    match wiring::has_hair(&state.document, wiring::Hair::OfHead) && !elsewhere {
        true => {
            pen.asked = Some(recipe);
            out.push(Event::Show(Room::Viewport));
        }
        false => cook(pen, state, recipe, false, out),
    }
}

/// Makes a recipe, instead of the hair that is there or as well, and takes up the pen, where there is something to draw, or else lays it
/// down. Its inputs are selected: what a groomer turns first is what the inspector shows.
pub(super) fn cook(
    pen: &mut Pen,
    state: &State,
    recipe: usize,
    instead: bool,
    out: &mut Vec<Event>,
) {
    let Some(recipe) = recipes::ALL.get(recipe) else { return };
    let mirror = state.settings.pen.symmetry;
    let here = state.landmarks_at_hand();
    let made = match instead {
        true => recipe.instead(&state.document, mirror, here.as_ref()),
        false => recipe.edits(&state.document, state.active(), mirror, here.as_ref()),
    };
    let made = match made {
        Ok(made) => made,
        Err(why) => {
            return out.push(Event::Say(Note::warning(format!("{}: {why}", recipe.label))));
        }
    };
    out.push(Event::Begin(format!("recipe: {}", recipe.label.to_lowercase())));
    out.push(Event::Edit(Edit::Several(made.edits)));
    out.push(Event::End);
    out.push(Event::Select(Select::Nodes(vec![made.inputs])));
    out.push(Event::Show(Room::Viewport));
    match made.drawn {
        Some(drawn) => out.push(Event::TakeUpPen(drawn)),
        None => pen.tool = PenTool::Select,
    }
}

/// The kind of node that fills a head between strokes.
const FLOW: &str = "flow";

impl Pen {
    /// Takes up the tool for a node that is to be drawn into. Where hair fills the head from a few strokes, each stroke plants one: the
    /// tool that guesses would comb with strokes that begin on what is filled already.
    pub(crate) fn take_up(&mut self, state: &State, node: &NodeId) {
        let kind = |id: &NodeId| state.document.node(id.as_str()).map_or("", |node| &node.kind);
        let mut links = state.document.links.iter();
        let flows = links
            .any(|(to, wires)| kind(&to.node) == FLOW && wires.iter().any(|w| w.node == *node));
        self.tool = match kind(node) == super::hair::target::KIND {
            true => PenTool::Hair(flows.then_some(Tool::Implant)),
            false => PenTool::Draw,
        };
    }
}
