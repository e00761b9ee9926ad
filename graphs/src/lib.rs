//! Documents and their evaluation.

pub mod document;
pub mod file;
