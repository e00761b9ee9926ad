//! Outputs of the graph.

use crate::define::NodeDef;

mod groom_output;
mod merge;

pub(crate) const NODES: &[&NodeDef] = &[&merge::NODE, &groom_output::NODE];
