//! The shipped grooms as whole programs: their hashes, their laws, their styles, on the built-in head and on real ones.
//!
//! A groom is evaluated once a head, written, measured, and judged by every test that asks about it ([`shipped`]).
//! `COIF_PROGRAM` names the build that evaluates, where it is not that of the tests; `tests/run.sh --long` names the release build for
//! farms.

mod fit;
mod golden;
mod hero;
mod laws;
mod light;
mod openusd;
mod packs;
mod pages;
mod shipped;
mod sketches;
mod skin;
