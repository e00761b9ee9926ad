//! How tests wait: for what happens, never for so many seconds.
//!
//! One limit for all, so long that a busy machine is never taken for a fault: it ends what hangs and judges nothing. How much work
//! something is, tests count (`work.rs`).
//! Each crate whose tests wait compiles this file into them, by its path.
#![allow(dead_code, unreachable_pub, reason = "each crate needs a part of it")]

use std::fmt::Display;
use std::io::Write as _;
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::time::{Duration, Instant};

/// What takes longer never comes.
pub const LIMIT: Duration = Duration::from_secs(15 * 60);
/// Between two looks.
const PAUSE: Duration = Duration::from_millis(2);

/// Waits for something that another thread or program does.
///
/// # Panics
/// When it does not happen.
#[track_caller]
pub fn until(what: &str, mut happened: impl FnMut() -> bool) {
    let began = Instant::now();
    while !happened() {
        assert!(began.elapsed() < LIMIT, "waited in vain until {what}");
        std::thread::sleep(PAUSE);
    }
}

/// Does work that must come to an end. Where it hangs it is named, and the process aborts, for no thread can be stopped.
pub fn ends<T>(what: impl Display + Send, work: impl FnOnce() -> T) -> T {
    let (working, end) = channel::<()>();
    std::thread::scope(|scope| {
        scope.spawn(move || {
            if end.recv_timeout(LIMIT) == Err(RecvTimeoutError::Timeout) {
                // Not by `eprintln`, which is kept for the end of a test.
                let _ = writeln!(std::io::stderr(), "{what}: it hangs");
                std::process::abort();
            }
        });
        // Goes at the end of the work, also when that panics.
        let _working = working;
        work()
    })
}
