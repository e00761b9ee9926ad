//! Documents and their evaluation, without windows.
//!
//! **Invariant:** nothing here knows a window, a GPU or a widget. Files are read by [`schedule::files`] only.

pub mod schedule;
