//! Grooms to other programs and back: one test program for all formats of curves.

mod common;
mod hair;
mod openusd;
mod stage;
mod usd;
