//! Nodes that change curves and keep their number: length, place, width, colour.

use crate::define::NodeDef;

mod along;
mod hair_colour;
pub(crate) mod resample;
mod set_colour;
mod set_width;
mod transform;
mod trim;

pub(crate) const NODES: &[&NodeDef] = &[
    &hair_colour::NODE,
    &resample::NODE,
    &set_colour::NODE,
    &set_width::NODE,
    &transform::NODE,
    &trim::NODE,
];
