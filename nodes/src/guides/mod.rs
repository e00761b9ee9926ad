//! Guides: curves drawn or grown to shape hair.

use crate::define::NodeDef;

mod stroke_input;

pub(crate) const NODES: &[&NodeDef] = &[&stroke_input::NODE];
