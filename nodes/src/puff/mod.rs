//! Puffs.

mod sphere_puff;

use crate::define::NodeDef;

pub(crate) const NODES: &[&NodeDef] = &[&sphere_puff::NODE];
