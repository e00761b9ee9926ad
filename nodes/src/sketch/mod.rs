//! Sketching on the head: pen gestures that make and edit curves (methods.md 7; Fu et al. 2007, "Sketching
//! hairstyles").
//!
//! One file per gesture, each a function from the current curves to the curves after the gesture; `hair_sketch` replays
//! a list of them. Nothing here knows a window: live and replayed gestures are the same call.

use crate::define::NodeDef;

pub mod around;
mod brush;
pub mod classify;
mod comb;
mod cut;
mod density;
#[cfg(test)]
mod drawing;
mod frizz;
pub mod grow;
pub mod hair_sketch;
mod hand;
#[cfg(test)]
mod laws;
pub mod level;
mod lock;
#[cfg(test)]
mod picture_laws;
mod pin;
mod point;
#[cfg(test)]
mod random_laws;
mod redraw;
mod relax;
#[cfg(test)]
mod replay_laws;
mod scatter;
pub mod seen;
mod silhouette;
mod soft;
pub mod stroke_shape;
mod twist;

/// The nodes of this folder.
pub const NODES: &[&NodeDef] = &[&hair_sketch::NODE];
