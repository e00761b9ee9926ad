//! Curls.

use crate::define::NodeDef;

pub(crate) const NODES: &[&NodeDef] = &[];
