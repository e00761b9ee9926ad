//! Whether tests take their time: `tests/run.sh --long`.
//!
//! Each crate whose tests ask compiles this file into them, by its path.
#![allow(unreachable_pub, reason = "one crate shows it to others")]

/// Whether tests try all that they can, which takes minutes. Else they try a part, as every change is tested.
pub fn is_long() -> bool {
    std::env::var_os("COIF_LONG").is_some()
}
