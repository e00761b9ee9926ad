//! The head: where hair grows, and curves brought to it.

pub mod bust;

use crate::define::NodeDef;

pub(crate) const NODES: &[&NodeDef] = &[];
