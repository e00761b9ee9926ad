//! Bytes to data and data to bytes. Nothing here opens a file or knows a path.

pub mod chunks;
pub mod error;
pub mod hair;
pub mod usd;

pub use chunks::Chunks;
pub use error::FormatError;
