//! coif.
fn main() {}
