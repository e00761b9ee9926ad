//! The rooms of the window: each reads the state and says what happened.
//!
//! Guarantees: a room knows neither the editor above it nor another room; what two of them share lies in `core` or `widgets`.

pub mod canvas;
pub(crate) mod history;
pub(crate) mod inspector;
pub(crate) mod messages;
pub(crate) mod outliner;
pub mod pen;
pub(crate) mod spreadsheet;
pub mod templates;
pub mod viewport;
