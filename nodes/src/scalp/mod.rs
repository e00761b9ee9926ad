//! Scalps: the surfaces that hair grows on.

pub mod bust;
