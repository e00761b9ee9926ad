//! The head: where hair grows, and curves brought to it.

use crate::define::NodeDef;

pub mod bust;

pub(crate) const NODES: &[&NodeDef] = &[];
