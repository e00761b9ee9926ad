//! USD: grooms out as `.usda` and `.usdc`, curves in from `.usda`, `.usdc` and `.usdz`.
//!
//! The way out: [`groom`] lays a groom out as a layer of prims ([`spec`]), and [`usda`] or [`usdc`]
//! turns that layer into bytes. The way in is [`read`], which composes the layers of a folder or package; which curve the points that
//! it finds stand for is [`form`]'s. Both ways are our own.

mod coding;
mod float_table;
pub mod form;
pub mod groom;
pub mod read;
pub mod spec;
pub mod usda;
pub mod usdc;
