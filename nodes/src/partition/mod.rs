//! Partings, and the hair along them.

use crate::define::NodeDef;

mod baby_hair;
mod between;
mod edge_partition;
mod given;
mod hairline;
mod lines;
mod middles;
mod net;
mod over;
mod partings;
mod pattern;
mod pulled;
#[cfg(test)]
mod respected;
pub(crate) mod territory;

pub(crate) const NODES: &[&NodeDef] = &[&partings::NODE, &edge_partition::NODE, &baby_hair::NODE];
