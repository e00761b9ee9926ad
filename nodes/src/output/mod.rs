//! What leaves the graph.

use crate::define::NodeDef;

pub(crate) const NODES: &[&NodeDef] = &[];
