//! Documents and their evaluation, without windows.
//!
//! **Invariant:** nothing here knows a window, a GPU or a widget. Files that documents name are read by
//! [`schedule::files`] only; [`file::save`] writes the document itself.

pub mod clipboard;
pub mod compare;
pub mod document;
pub mod file;
pub mod grooms;
pub mod schedule;
pub mod template;
pub mod text;
pub mod trace;
pub mod values;
#[cfg(test)]
#[path = "../../tests/src/waiting.rs"]
mod waiting;
#[cfg(test)]
#[path = "../../tests/src/work.rs"]
mod work;
