//! Numerics: deterministic to the last bit on every machine, each with its source.
//!
//! **Invariant:** no function here calls the system's maths library, fuses a multiply with an add, or
//! depends on thread order.

pub mod box_tree;
pub mod closest;
pub mod distance_field;
pub mod frame;
pub mod hair_colour;
pub mod hash;
pub mod low_discrepancy;
pub mod nearest;
pub mod rail;
pub mod readings;
pub mod spline;
pub mod transcendental;
mod triangle_tree;
