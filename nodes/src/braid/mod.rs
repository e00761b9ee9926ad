//! Braids.

use crate::define::NodeDef;

#[cfg(test)]
mod laws;
mod lay;
mod lissajous_braid;
mod stray;
mod touch;
mod weave;

pub(crate) const NODES: &[&NodeDef] = &[&lissajous_braid::NODE];
