//! Guides: the curves that hair follows.

use crate::define::NodeDef;

pub(crate) mod even_roots;
mod scatter_guides;

pub(crate) const NODES: &[&NodeDef] = &[&scatter_guides::NODE];
