//! Braids.

use crate::define::NodeDef;

#[cfg(test)]
mod any_row;
#[cfg(test)]
mod any_source;
mod band;
mod braid_hair;
mod braid_territory;
mod even;
mod ground;
#[cfg(test)]
mod hair_laws;
#[cfg(test)]
mod laws;
mod lay;
mod lissajous_braid;
#[cfg(test)]
mod reading;
mod stray;
mod tail;
mod through;
mod touch;
mod tube;
mod wander;
mod weave;

pub(crate) const NODES: &[&NodeDef] =
    &[&braid_territory::NODE, &lissajous_braid::NODE, &braid_hair::NODE];
