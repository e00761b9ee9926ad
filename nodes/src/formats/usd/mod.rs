//! USD: grooms out as `.usda` and `.usdc`, curves in from `.usda`, `.usdc` and `.usdz`.
//!
//! The way out: [`groom`] lays a groom out as a layer of prims ([`spec`]), and [`usda`] or [`usdc`]
//! turns that layer into bytes. The way in is [`read`]. Both are our own: one layer at a time,
//! without composition (references, payloads, variants and sublayers are not followed).

mod coding;
pub mod form;
pub mod groom;
pub mod read;
pub mod spec;
pub mod usda;
pub mod usdc;
