//! The head: where hair grows, and curves brought to it.

pub mod bust;
mod fit;
mod head;
mod region;

use crate::define::NodeDef;

pub(crate) const NODES: &[&NodeDef] = &[&head::NODE];
