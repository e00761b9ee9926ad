//! What can be done by name while masks are painted.

use super::super::actions::taken_up;
use super::{Mode, take_up};
use crate::core::action::{Action, Of, always};
use crate::rooms::pen::Pen;

/// A tool that is taken up.
macro_rules! paints {
    ($id:literal, $mode:ident, $label:literal, $tip:literal, $words:literal) => {
        taken_up($id, $label, $tip, $words, |pen, _, _| take_up(pen, Mode::$mode))
    };
}

/// What can be done by name.
pub(crate) const ACTIONS: &[Of<Pen>] = &[
    paints!(
        "mask.paint",
        Paint,
        "Paint a mask",
        "Paint on the head: a number from 0 to 1 that any field can read. Makes a paint mask where there is none.",
        "brush weight map density length region dab heat"
    ),
    paints!(
        "mask.erase",
        Erase,
        "Erase a mask",
        "Takes away what is painted on the head. The eraser end of a pen always does.",
        "rubber remove brush weight map"
    ),
    paints!(
        "mask.smooth",
        Smooth,
        "Smooth a mask",
        "Evens out what is painted under the brush.",
        "blur soften relax brush weight map"
    ),
    paints!(
        "mask.flood",
        Flood,
        "Flood a mask",
        "Touch the head: the section, or the whole head where it is not parted, gets the strength as its value.",
        "fill bucket all section clear weight map"
    ),
    Action {
        id: "mask.hairline",
        label: "Paint inside closed strokes",
        tip: "Strokes of a mask are closed lines, and act on all that lies inside: a hairline with a soft edge.",
        words: "closed outline region lasso",
        menu: "Pen",
        when: always,
        run: |pen, _, _| pen.mask.closed = !pen.mask.closed,
    },
    Action {
        id: "mask.by_section",
        label: "Paint by section",
        tip: "Strokes of a mask keep to the section of the parted scalp that they begin in.",
        words: "parting border within",
        menu: "Pen",
        when: always,
        run: |pen, _, _| pen.mask.by_section = !pen.mask.by_section,
    },
];
