//! Partings, and the hair along them.

use crate::define::NodeDef;

mod baby_hair;
mod edge_partition;
mod given;
mod hairline;
mod lines;
mod medial_lines;
mod midlines;
mod parting_hair;
mod partings;
mod pattern;
#[cfg(test)]
mod respected;
mod stereographic_grid;

pub(crate) const NODES: &[&NodeDef] = &[&partings::NODE, &edge_partition::NODE, &baby_hair::NODE];
