//! Parting hairs.

use crate::define::NodeDef;

mod edge_partition;
mod pulled;
mod territory;

pub(crate) const NODES: &[&NodeDef] = &[&edge_partition::NODE];
