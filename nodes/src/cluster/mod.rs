//! Hair: strands from clusters and between guides.

use crate::define::NodeDef;

mod bias;
mod cluster_to_strands;
mod interpolate;
#[cfg(test)]
mod laws;
mod plan;
pub(crate) mod sections;
mod separation;
mod shape;

pub(crate) const NODES: &[&NodeDef] =
    &[&cluster_to_strands::NODE, &interpolate::NODE, &separation::NODE];
