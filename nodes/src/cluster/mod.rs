//! Hair: strands from clusters and between guides.

use crate::define::NodeDef;

mod bias;
mod cells;
mod cluster_to_strands;
mod cross_section;
pub(crate) mod cross_sections;
mod interpolate;
#[cfg(test)]
mod laws;
mod plan;
mod separation;

pub(crate) const NODES: &[&NodeDef] =
    &[&cross_section::NODE, &cluster_to_strands::NODE, &interpolate::NODE, &separation::NODE];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn makers_take_only_what_making_needs() {
        for maker in [&cluster_to_strands::NODE, &interpolate::NODE] {
            assert!(maker.inputs.len() <= 13, "{}: {} inputs", maker.id, maker.inputs.len());
        }
    }
}
