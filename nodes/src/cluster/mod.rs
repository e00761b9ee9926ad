//! Hair: strands from clusters and between guides.

use crate::define::NodeDef;

mod bias;
mod cluster_to_strands;
pub(crate) mod cross_sections;
mod interpolate;
#[cfg(test)]
mod laws;
mod plan;
mod separation;
mod shape;

pub(crate) const NODES: &[&NodeDef] =
    &[&cluster_to_strands::NODE, &interpolate::NODE, &separation::NODE];
