//! Parting hairs.

use crate::define::NodeDef;

mod edge_partition;
mod pulled;
pub(crate) mod territory;

pub(crate) const NODES: &[&NodeDef] = &[&edge_partition::NODE];
