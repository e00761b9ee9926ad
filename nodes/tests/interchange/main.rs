//! Grooms to other programs and back: one test program for all formats of curves.

mod alembic;
mod common;
mod hair;
mod openusd;
mod stage;
mod usd;
