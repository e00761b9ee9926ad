//! Guides: the curves that hair follows.

use crate::define::NodeDef;

pub(crate) const NODES: &[&NodeDef] = &[];
