//! Bytes to data and data to bytes. Nothing here opens a file or knows a path.

pub mod gltf;
pub mod mesh_in;
pub mod obj;
