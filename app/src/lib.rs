//! coif: a groom editor made of nodes. The window, and the command line beside it.
//!
//! The program's `main` only hands over to [`main`]. What is public here is public for the tests of the whole
//! program; nobody else links to it.

#[cfg(feature = "editor")]
pub mod canvas;
mod cli;
#[cfg(feature = "editor")]
pub mod editor;
#[cfg(feature = "render")]
mod feeders;
mod files;
#[cfg(feature = "editor")]
mod inspector;
mod library;
#[cfg(feature = "render")]
mod looks;
mod pack;
#[cfg(feature = "editor")]
pub mod pen;
pub mod places;
#[cfg(feature = "render")]
pub mod scene;
#[cfg(feature = "editor")]
pub mod viewport;
mod words;

/// Runs what the words of the command line ask for.
pub fn main() -> std::process::ExitCode {
    cli::main()
}
