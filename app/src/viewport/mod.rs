//! The viewport: the groom as it is, drawn beside the window.

pub mod projection;
