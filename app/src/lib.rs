//! coif: a groom editor made of nodes. The window, and the command line beside it.
//!
//! The program's `main` only hands over to [`main`]. What is public here is public for the tests of the whole
//! program; nobody else links to it.

mod cli;
#[cfg(feature = "editor")]
pub mod core;
#[cfg(feature = "editor")]
pub mod editor;
#[cfg(feature = "render")]
mod feeders;
mod files;
mod jobs;
mod library;
#[cfg(test)]
#[path = "../../tests/src/long.rs"]
mod long;
mod pack;
pub mod places;
#[cfg(feature = "editor")]
pub mod rooms;
#[cfg(feature = "render")]
pub mod scene;
#[cfg(all(test, feature = "editor"))]
mod testing;
#[cfg(test)]
#[path = "../../tests/src/waiting.rs"]
mod waiting;
#[cfg(feature = "editor")]
pub mod widgets;
mod words;
#[cfg(test)]
#[path = "../../tests/src/work.rs"]
mod work;

/// Runs what the words of the command line ask for.
pub fn main() -> std::process::ExitCode {
    cli::main()
}
