//! The head: where hair grows, and curves brought to it.

use crate::define::NodeDef;

pub(crate) const NODES: &[&NodeDef] = &[];
