//! What the window and the command line have done for them: typed requests, carried out alike for both.
//!
//! Guarantees: nothing here knows who asks, or in which words; files are put in place together or not at all.

pub(crate) mod evaluate;
#[cfg(feature = "editor")]
pub(crate) mod evaluation;
pub(crate) mod export;
pub(crate) mod memory;
pub(crate) mod open;
pub(crate) mod progress;
#[cfg(feature = "render")]
pub(crate) mod render;
pub(crate) mod report;
pub(crate) mod stop;
pub(crate) mod thumbnail;
pub(crate) mod unreal;
