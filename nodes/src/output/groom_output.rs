//! Groom output: the curves that leave the graph, under a name.
//!
//! Guarantees: the curves pass through unchanged. The exporter reads name and purpose from this node's inputs.

use crate::data::curves::Curves;
use crate::define::{NodeError, node};
use crate::eval::EvalCx;
use std::sync::Arc;

node! {
    /// Marks curves as an output of the graph: a group of this name in exported files.
    "groom_output", version 1, label "Groom output", words "export result group write save usd alembic abc unreal cache final";
    inputs {
        /// Curves to output.
        curves: Curves;
        /// Name of the group in files. Empty: the label of this node.
        name: Arc<str> = "", words("group label");
        /// Mark the curves as guides, for simulation or grooming in other tools, not as hair to render. In Unreal,
        /// guides with the name of a hair group become that group's guides.
        guides: bool = false, words("purpose simulation");
    }
    outputs {
        /// The same curves.
        curves: Curves;
    }
}

fn eval(_: &EvalCx, inputs: Inputs) -> Result<Outputs, NodeError> {
    // Read by the exporter, from the document.
    let _ = (inputs.name, inputs.guides);
    Ok(Outputs { curves: inputs.curves })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::curves::TuftBuilder;
    use crate::testing::{curves_of, run};
    use glam::Vec3;

    #[test]
    fn hands_on_what_comes_in() {
        let mut b = TuftBuilder::new();
        b.push_curve(&[Vec3::ZERO, Vec3::Y]);
        let input = Curves::new(vec![b.build().into()]);
        let (out, _) = run(&NODE, &[("curves", input.clone().into()), ("name", "hair".into())]);
        assert!(Arc::ptr_eq(&input.tufts()[0], &curves_of(&out[0]).tufts()[0]));
    }
}
