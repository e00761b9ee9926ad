//! The groom nodes: pure functions from geometry to geometry, one file each.

pub mod data;
pub mod formats;
pub mod scalp;
