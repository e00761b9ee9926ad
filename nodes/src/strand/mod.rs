//! Modifiers of hair from any source. Each takes curves and gives the same curves, bent or cut.
//!
//! Shared code: `data/route` (reads a hair; keeps roots, lengths, skin and partings after a change), `seeds.rs` and `waves.rs`
//! (random places and values in space). A node file reads inputs, calls these and sets its output.

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
