//! What can be done by name while masks are painted.

use super::super::actions::taken_up;
use crate::core::action::{Action, Of, always};
use crate::rooms::pen::{Pen, PenTool};
use coif_nodes::data::strokes::Mode;

/// A tool that is taken up.
macro_rules! paints {
    ($id:literal, $mode:ident, $label:literal, $tip:literal, $words:literal) => {
        taken_up($id, $label, $tip, $words, |pen, _, _| pen.tool = PenTool::Mask(Mode::$mode))
    };
}

/// What can be done by name.
pub(crate) const ACTIONS: &[Of<Pen>] = &[
    paints!(
        "mask.paint",
        Paint,
        "Paint a mask",
        "Paint a mask on the head, 0 to 1, for any field to read. Adds a Paint mask node if needed.",
        "brush weight map density length region dab heat"
    ),
    paints!(
        "mask.erase",
        Erase,
        "Erase a mask",
        "Erase the mask under the brush, as the pen's eraser always does.",
        "rubber remove brush weight map"
    ),
    paints!(
        "mask.smooth",
        Smooth,
        "Smooth a mask",
        "Smooth the mask under the brush.",
        "blur soften relax brush weight map"
    ),
    paints!(
        "mask.flood",
        Flood,
        "Flood a mask",
        "Fill the touched section, or the whole unparted head, with the strength as its value.",
        "fill bucket all section clear weight map"
    ),
    Action {
        id: "mask.hairline",
        label: "Paint inside closed strokes",
        tip: "Treat mask strokes as closed outlines and paint their inside, with a soft edge.",
        words: "closed outline region lasso",
        menu: "Pen",
        when: always,
        run: |pen, _, _| pen.mask.closed = !pen.mask.closed,
    },
    Action {
        id: "mask.by_section",
        label: "Paint by section",
        tip: "Limit each mask stroke to the section that it begins in.",
        words: "parting border within",
        menu: "Pen",
        when: always,
        run: |pen, _, _| pen.mask.by_section = !pen.mask.by_section,
    },
];
