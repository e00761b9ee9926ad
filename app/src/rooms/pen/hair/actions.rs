//! What can be done by name while the pen works on hair: its tools, and how deep touches reach.

use super::super::actions::taken_up;
use super::super::{Pen, PenTool};
use crate::core::action::{Action, Can, Of};
use crate::core::event::Event;
use crate::core::state::State;
use coif_nodes::data::gestures::{Layer, Tool};

/// A tool on hair that is taken up.
macro_rules! hair {
    ($id:literal, $tool:expr, $label:literal, $tip:literal, $words:literal) => {
        taken_up($id, $label, $tip, $words, |pen, _, _| pen.tool = PenTool::Hair($tool))
    };
}

/// How deep touches on hair reach; the same again: as the pressure says.
macro_rules! level {
    ($id:literal, $level:ident, $label:literal, $tip:literal) => {
        Action {
            id: $id,
            label: $label,
            tip: $tip,
            words: "layer depth pressure light heavy",
            menu: "",
            when: on_hair,
            run: |pen, _, _| {
                let level = &mut pen.hair.level;
                *level = Some(Layer::$level).filter(|new| *level != Some(*new));
            },
        }
    };
}

fn on_hair(pen: &Pen, _: &State) -> Can {
    match pen.tool {
        PenTool::Hair(_) => Ok(()),
        _ => Err("take up a tool for hair first: H sketches"),
    }
}

/// What can be done by name.
pub(crate) const ACTIONS: &[Of<Pen>] = &[
    hair!(
        "hair.sketch",
        None,
        "Sketch with the pen",
        "Draw on the head, and the stroke says what it is: from the skin it implants a cluster, from a tip it lengthens one, over hair it combs; loops twist, a scribble frizzes, two taps pin. The pen's eraser cuts across hair, and circles change its density.",
        "gesture pen paper hairstyle groom implant"
    ),
    hair!(
        "hair.implant",
        Some(Tool::Implant),
        "Implant clusters",
        "Draw from the skin: a new cluster grows along the stroke. One begun on the root of another takes its place.",
        "plant grow add hair lock"
    ),
    hair!(
        "hair.lengthen",
        Some(Tool::Lengthen),
        "Lengthen clusters",
        "Draw on from a tip: the cluster goes on along the stroke.",
        "extend longer grow"
    ),
    hair!(
        "hair.comb",
        Some(Tool::Comb),
        "Comb hair",
        "Hair goes along with the pen; roots and lengths stay, and it stays out of the head.",
        "brush style drag push groom"
    ),
    hair!(
        "hair.cut",
        Some(Tool::Cut),
        "Cut hair",
        "Draw straight across hair: it ends there, on a bias if the stroke has one. At level 3 what is rooted under the stroke is removed.",
        "scissors trim shorten remove delete"
    ),
    hair!(
        "hair.density",
        Some(Tool::Density),
        "Change density",
        "Draw circles over clusters: each clockwise one fills them by 5 % more, the others by 5 % less.",
        "fuller thinner fill count"
    ),
    hair!(
        "hair.twist",
        Some(Tool::Twist),
        "Twist hair",
        "Draw loops over a cluster: each turns it by 15 degrees, from there to its tip.",
        "twirl curl roll turn"
    ),
    hair!(
        "hair.frizz",
        Some(Tool::Frizz),
        "Frizz hair",
        "Scribble to and fro across a cluster: the wider, the more its strands wander.",
        "scribble flyaway noise messy"
    ),
    hair!(
        "hair.pin",
        Some(Tool::Pin),
        "Pin hair",
        "Tap on hair: its nearest point holds its place whatever combs it. Tap again to free it.",
        "hairpin lock hold fix bobby"
    ),
    hair!(
        "hair.smooth",
        Some(Tool::Smooth),
        "Smooth hair",
        "Takes wiggles out of hair under the brush.",
        "relax even"
    ),
    hair!(
        "hair.puff",
        Some(Tool::Puff),
        "Puff hair",
        "Lifts hair under the brush off the skin.",
        "volume lift raise"
    ),
    hair!(
        "hair.grab",
        Some(Tool::Grab),
        "Grab hair",
        "Takes hold of hair under the brush and takes it along.",
        "move pull drag"
    ),
    hair!(
        "hair.straighten",
        Some(Tool::Straighten),
        "Straighten hair",
        "Draws hair under the brush straight between its root and its tip.",
        "iron flat"
    ),
    hair!(
        "hair.point",
        Some(Tool::Point),
        "Move points of hair",
        "Takes the nearest point of a cluster and puts it where you like; no other point moves.",
        "cv vertex handle tweak"
    ),
    hair!(
        "hair.redraw",
        Some(Tool::Redraw),
        "Re-draw hair",
        "Draw on from anywhere on a cluster: from there to its tip it follows the stroke.",
        "redraw correct fix overdraw"
    ),
    hair!(
        "hair.scatter",
        Some(Tool::Scatter),
        "Scatter clusters",
        "Draw from a cluster over the skin: copies of it stand along the stroke wherever there is room.",
        "copy duplicate clone paint plant fill many"
    ),
    hair!(
        "hair.silhouette",
        Some(Tool::Silhouette),
        "Draw a cluster's silhouette",
        "Draw an outline from the skin and back to it: a cluster grows along its middle, as wide as it.",
        "outline shape leaf lock taper wide"
    ),
    Action {
        id: "hair.strands",
        label: "Strands",
        tip: "Work on single strands instead of the clusters or guides that they grow from: a fine comb, for the last touch. Each strand keeps what was done to it.",
        words: "fine comb hairs single flyaway detail",
        menu: "Pen",
        when: on_hair,
        run: |_, state, out| {
            let mut settings = state.settings.clone();
            settings.pen.strands = !settings.pen.strands;
            out.push(Event::Settings(settings.into()));
        },
    },
    level!(
        "hair.level_1",
        Nearest,
        "Level 1: nearest",
        "Touches on hair reach the cluster nearest to the eye, whatever the pressure is. The same key again: as the pressure says."
    ),
    level!(
        "hair.level_2",
        Through,
        "Level 2: through",
        "Touches on hair reach all of it down to the head, whatever the pressure is. The same key again: as the pressure says."
    ),
    level!(
        "hair.level_3",
        Scalp,
        "Level 3: scalp",
        "Touches reach the skin, and what is rooted there, whatever the pressure is. The same key again: as the pressure says."
    ),
];
