//! Curls.

mod drawn;
#[cfg(test)]
mod laws;
mod pattern;
mod preset;
mod profile;
mod shape_list_curl;
#[cfg(test)]
mod turn_laws;
mod winding;

use crate::define::NodeDef;

pub(crate) const NODES: &[&NodeDef] = &[&shape_list_curl::NODE];
