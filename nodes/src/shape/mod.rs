//! Nodes that change curves and keep their number: length, place, width, colour.

use crate::define::NodeDef;

pub(crate) mod resample;
mod set_colour;
mod set_width;
mod transform;

pub(crate) const NODES: &[&NodeDef] =
    &[&resample::NODE, &set_colour::NODE, &set_width::NODE, &transform::NODE];
