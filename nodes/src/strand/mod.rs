//! Strands: modifiers of hair, whatever made it. Each takes curves and gives the same curves, bent or cut.
//!
//! What they share: `data/route` (a hair as they read it; roots, lengths, skin and partings after a change), `seeds.rs` and `waves.rs`
//! (places and numbers drawn in space). A node file reads inputs, calls these and sets its output.

use crate::define::NodeDef;

mod clump;
mod coarse;
mod frizz;
#[cfg(test)]
mod laws;
mod length;
mod middles;
mod noise;
mod seeds;
pub(crate) mod shorten;
mod stray;
mod waves;

pub(crate) const NODES: &[&NodeDef] =
    &[&clump::NODE, &frizz::NODE, &length::NODE, &noise::NODE, &stray::NODE];
