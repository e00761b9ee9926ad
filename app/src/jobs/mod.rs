//! What the window and the command line have done for them: typed requests, carried out alike for both.

#[cfg(feature = "editor")]
pub(crate) mod evaluation;
