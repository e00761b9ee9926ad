//! What must run for the targets, in an order in which it can.
//!
//! A plan is checked: every wire fits, every value is of its input's type and finite, every file is read, and there is no
//! cycle. So running it can only fail in the nodes themselves.

use crate::document::budget::Budget;
use coif_nodes::define::{NodeDef, Type, Value};
use coif_nodes::eval::Quality;

/// Where one value of an input comes from.
#[derive(Clone, Debug)]
pub enum Source {
    /// It is set.
    Value(Value),
    /// An output of an earlier step.
    Wire {
        /// Number of the step.
        step: usize,
        /// Number of its output.
        output: usize,
    },
}

/// One node to run.
#[derive(Clone)]
pub struct Step {
    /// Its id in the document.
    pub name: String,
    /// Its kind.
    pub def: &'static NodeDef,
    /// Whether it only passes its first curves through.
    pub bypass: bool,
    /// For each input of the kind, in order: nothing, a value, or wires.
    pub inputs: Vec<Vec<Source>>,
}

impl Step {
    /// The steps that it reads, once for each wire.
    pub(super) fn wires(&self) -> impl Iterator<Item = usize> {
        #[cfg(test)]
        LOOKED_AT.with(|looks| looks.set(looks.get() + 1));
        self.inputs.iter().flatten().filter_map(|source| match source {
            Source::Wire { step, .. } => Some(*step),
            Source::Value(_) => None,
        })
    }

    /// Whether it could be passed by: it gives curves alone, and some come in.
    pub(super) fn can_pass_on(&self) -> bool {
        let mut inputs = self.def.inputs.iter().zip(&self.inputs);
        self.def.outputs.iter().all(|output| output.ty == Type::Curves)
            && inputs.any(|(input, from)| input.ty == Type::Curves && !from.is_empty())
    }
}

#[cfg(test)]
thread_local! {
    /// How often the wires of a step were asked for.
    pub(super) static LOOKED_AT: std::cell::Cell<usize> = const { std::cell::Cell::new(0) };
}

/// What a node says that is passed by and could not be.
pub(super) const NOTHING_TO_PASS: &str = "bypassed, but it has no curves to pass on";

/// What must run.
#[derive(Clone)]
pub struct Plan {
    /// The document's seed.
    pub seed: u64,
    /// How much hair is made.
    pub quality: Quality,
    /// Whether a node may make more points than a groom is to have, as many as memory holds. No key knows it.
    pub allow_large: bool,
    /// What it may take, where that is held: a node that would make more points does not run. No key knows it.
    pub budget: Budget,
    /// **Invariant:** a step's wires lead to earlier steps only.
    pub steps: Vec<Step>,
    /// Steps and outputs that are asked for.
    pub targets: Vec<(usize, usize)>,
}
