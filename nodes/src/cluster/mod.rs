//! Hair: strands from clusters and between guides.

use crate::define::NodeDef;

pub(crate) const NODES: &[&NodeDef] = &[];
