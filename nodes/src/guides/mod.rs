//! Guides: drawn or grown curves that hair follows.

use crate::define::NodeDef;

mod direct;
pub(crate) mod even_roots;
mod fall;
mod flow;
mod grower;
mod hang;
mod scatter_guides;
mod stroke_input;

pub(crate) const NODES: &[&NodeDef] =
    &[&stroke_input::NODE, &scatter_guides::NODE, &flow::NODE, &hang::NODE];
