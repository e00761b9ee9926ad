//! The pen on the head: what a stroke means, and what it does to curves.

pub mod classify;
#[cfg(test)]
mod hand;
pub mod stroke_shape;
