//! Nodes that change curves: length, position, width, colour; by hand, single hairs, or remove them.

use crate::define::NodeDef;

mod along;
mod hair_colour;
mod override_strands;
pub(crate) mod resample;
mod set_colour;
mod set_width;
mod transform;
mod trim;

pub(crate) const NODES: &[&NodeDef] = &[
    &hair_colour::NODE,
    &override_strands::NODE,
    &resample::NODE,
    &set_colour::NODE,
    &set_width::NODE,
    &transform::NODE,
    &trim::NODE,
];
