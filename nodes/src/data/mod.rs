//! What wires carry, and what readers and writers exchange with it.

pub mod attributes;
pub mod chart;
pub mod curves;
mod cut;
pub(crate) mod drawn;
pub mod field;
pub mod footprint;
pub mod gestures;
pub mod home;
pub(crate) mod ids;
pub mod lead;
pub mod mesh;
mod mesh_cut;
pub(crate) mod outline;
pub mod painted;
pub mod patience;
mod places;
pub mod ramp;
pub mod rough;
pub mod scalp;
pub mod sections;
pub mod shapes;
mod skin;
pub(crate) mod spread;
pub mod strokes;
pub mod texture;
mod way_round;
