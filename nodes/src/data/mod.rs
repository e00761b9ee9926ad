//! What wires carry, and what readers and writers exchange with it.

pub mod mesh;
