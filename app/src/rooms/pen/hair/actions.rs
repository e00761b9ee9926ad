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
        _ => Err("pick a hair tool first: H sketches"),
    }
}

/// What can be done by name.
pub(crate) const ACTIONS: &[Of<Pen>] = &[
    hair!(
        "hair.sketch",
        None,
        "Sketch with the pen",
        "Draw from the skin to implant, from a tip to lengthen, over hair to comb. Loops twist, scribbles frizz, two taps pin; the eraser cuts.",
        "gesture pen paper hairstyle groom implant"
    ),
    hair!(
        "hair.implant",
        Some(Tool::Implant),
        "Implant clusters",
        "Draw from the skin: a new cluster grows along the stroke. Begun on another's root, it replaces that cluster.",
        "plant grow add hair lock"
    ),
    hair!(
        "hair.lengthen",
        Some(Tool::Lengthen),
        "Lengthen clusters",
        "Draw from a tip: the cluster grows on along the stroke.",
        "extend longer grow"
    ),
    hair!(
        "hair.comb",
        Some(Tool::Comb),
        "Comb hair",
        "Pull hair along with the pen. Roots and lengths stay, and hair stays out of the head.",
        "brush style drag push groom"
    ),
    hair!(
        "hair.cut",
        Some(Tool::Cut),
        "Cut hair",
        "Draw across hair to cut it there, at the angle of the stroke. At level 3, remove hair rooted under the stroke.",
        "scissors trim shorten remove delete"
    ),
    hair!(
        "hair.density",
        Some(Tool::Density),
        "Change density",
        "Draw circles over clusters: clockwise raises the density by 5 % each, counterclockwise lowers it.",
        "fuller thinner fill count"
    ),
    hair!(
        "hair.twist",
        Some(Tool::Twist),
        "Twist hair",
        "Draw loops over a cluster: each twists it by 15 degrees, from there to its tip.",
        "twirl curl roll turn"
    ),
    hair!(
        "hair.frizz",
        Some(Tool::Frizz),
        "Frizz hair",
        "Scribble across a cluster: the wider, the more frizz.",
        "scribble flyaway noise messy"
    ),
    hair!(
        "hair.pin",
        Some(Tool::Pin),
        "Pin hair",
        "Tap on hair to pin its nearest CV against combing, or draw to pin all under the brush. Begin on a pin to free.",
        "hairpin lock hold fix bobby freeze brush"
    ),
    hair!(
        "hair.smooth",
        Some(Tool::Smooth),
        "Smooth hair",
        "Smooth hair under the brush.",
        "relax even"
    ),
    hair!(
        "hair.puff",
        Some(Tool::Puff),
        "Puff hair",
        "Lift hair under the brush off the skin.",
        "volume lift raise"
    ),
    hair!(
        "hair.grab",
        Some(Tool::Grab),
        "Grab hair",
        "Grab hair under the brush and move it along.",
        "move pull drag"
    ),
    hair!(
        "hair.straighten",
        Some(Tool::Straighten),
        "Straighten hair",
        "Straighten hair under the brush between root and tip.",
        "iron flat"
    ),
    hair!(
        "hair.point",
        Some(Tool::Point),
        "Move points of hair",
        "Move the nearest CV of a cluster; no other CV moves.",
        "cv vertex handle tweak"
    ),
    hair!(
        "hair.redraw",
        Some(Tool::Redraw),
        "Re-draw hair",
        "Draw from anywhere on a cluster: from there to its tip, it follows the stroke.",
        "redraw correct fix overdraw"
    ),
    hair!(
        "hair.scatter",
        Some(Tool::Scatter),
        "Scatter clusters",
        "Draw from a cluster over the skin: copies of it are placed along the stroke where there is room.",
        "copy duplicate clone paint plant fill many"
    ),
    hair!(
        "hair.silhouette",
        Some(Tool::Silhouette),
        "Draw a cluster's silhouette",
        "Draw an outline from the skin and back: a cluster grows along its middle, as wide as the outline.",
        "outline shape leaf lock taper wide"
    ),
    Action {
        id: "hair.strands",
        label: "Strands",
        tip: "Edit single strands instead of the clusters or guides they grow from, for finishing. Edits stay with each strand.",
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
        "Touch only the cluster nearest to the eye, at any pressure. Again: by pressure."
    ),
    level!(
        "hair.level_2",
        Through,
        "Level 2: through",
        "Touch all hair down to the head, at any pressure. Again: by pressure."
    ),
    level!(
        "hair.level_3",
        Scalp,
        "Level 3: scalp",
        "Touch the skin and what is rooted there, at any pressure. Again: by pressure."
    ),
];
