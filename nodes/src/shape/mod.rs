//! Nodes that change curves and keep their number: length, place, width, colour.

use crate::define::NodeDef;

pub(crate) mod resample;

pub(crate) const NODES: &[&NodeDef] = &[&resample::NODE];
