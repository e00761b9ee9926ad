//! Real windows on screens in memory, with a mouse, keys and a pen with pressure.

mod hands;
mod pen;
