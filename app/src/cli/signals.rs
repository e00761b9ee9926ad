//! Being asked to end: by a person (Ctrl-C), by a farm or container (SIGTERM, SIGUSR1 and SIGUSR2, SIGXCPU), by a terminal that
//! closes (SIGHUP).
//!
//! All are one to the program. A limit on the size of files (SIGXFSZ) is none of them: the write fails, and is told as other
//! failed writes are.

/// Calls `act`, on a thread of its own, whenever somebody asks the process to end.
pub(crate) fn on_end(act: impl Fn() + Clone + Send + 'static) {
    // A second handler in one process can only fail in tests; then Ctrl-C ends it at once.
    let _ = ctrlc::set_handler(act.clone());
    #[cfg(unix)]
    on_end_by_others(act);
}

#[cfg(unix)]
fn on_end_by_others(act: impl Fn() + Send + 'static) {
    use signal_hook::consts::{SIGHUP, SIGTERM, SIGUSR1, SIGUSR2, SIGXCPU, SIGXFSZ};
    use std::sync::{Arc, atomic::AtomicBool};
    // Caught is enough: then the write itself fails.
    let _ = signal_hook::flag::register(SIGXFSZ, Arc::new(AtomicBool::new(false)));
    let ends = [SIGTERM, SIGHUP, SIGUSR1, SIGUSR2, SIGXCPU];
    let ends = ends.into_iter().filter(|signal| !is_ignored(*signal));
    let Ok(mut signals) = signal_hook::iterator::Signals::new(ends) else { return };
    // Without a thread these signals do what they do by themselves: nothing, as they are caught.
    let _ = std::thread::Builder::new().name("signals".to_owned()).spawn(move || {
        for _ in signals.forever() {
            act();
        }
    });
}

/// Whether a signal is to be ignored, as `nohup` asks it of SIGHUP. Only Linux tells.
#[cfg(unix)]
fn is_ignored(signal: i32) -> bool {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let ignored = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    let ignored = ignored.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok());
    ignored.is_some_and(|mask| mask >> (signal - 1) & 1 == 1)
}
