//! Braids.

use crate::define::NodeDef;

#[cfg(test)]
mod any_row;
#[cfg(test)]
mod any_source;
mod band;
mod braid_hair;
mod braid_territory;
mod deviation;
mod even;
mod flyaways;
mod ground;
#[cfg(test)]
mod hair_laws;
mod hair_path;
#[cfg(test)]
mod laws;
mod lissajous_braid;
#[cfg(test)]
mod reading;
mod strand_placement;
mod strand_radius;
mod tail;
mod tube;
mod weave;

pub(crate) const NODES: &[&NodeDef] =
    &[&braid_territory::NODE, &lissajous_braid::NODE, &braid_hair::NODE];
