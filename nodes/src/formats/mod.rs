//! Bytes to data and data to bytes. Nothing here opens a file or knows a path.

pub mod abc;
pub mod chunks;
pub mod conform;
pub mod error;
pub mod export;
mod file_ids;
pub mod gltf;
pub mod hair;
pub mod looks;
pub mod mesh_in;
pub mod obj;
pub mod picture_in;
mod repair;
pub mod usd;

pub use chunks::Chunks;
pub use error::FormatError;
pub use looks::read_looks;
pub use mesh_in::{read_mesh, side_files};
