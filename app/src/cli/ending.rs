//! How a command ends that is asked to (Ctrl-C, SIGTERM …): in order where that takes no longer than [`PATIENCE`], else at once.
//!
//! Work looks now and then whether somebody asked it to stop, and most of it stops within milliseconds. What cannot look (giving
//! gigabytes of memory back, sorting millions of ids, waiting for a disk) is not waited for: the process ends in the midst of it.
//!
//! Guarantees: either way the exit code is 130, every output is as it was before and nothing lies beside it; and who has begun to put
//! files in place, or to take them back, comes to the end of that. Not guaranteed: that a report which is written at once names nodes.

use super::{Exit, complain, signals};
use crate::files;
use crate::jobs::stop::Stop;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

/// How long work that was asked to stop may take to.
const PATIENCE: Duration = Duration::from_millis(20);

/// Who ends the process: the command itself, or who waited for it in vain.
#[derive(Default)]
pub(super) struct Ending {
    is_taken: Arc<AtomicBool>,
    is_ours: bool,
}

impl Ending {
    /// Whether it is up to the caller, who is the first to ask.
    fn take(is_taken: &AtomicBool) -> bool {
        !is_taken.swap(true, Ordering::AcqRel)
    }

    /// The command ends by itself from here on. Does not return where the process is being ended already.
    pub(super) fn begin(&mut self) {
        while !self.is_ours {
            self.is_ours = Self::take(&self.is_taken);
            if !self.is_ours {
                // Until the process is gone, which is a matter of milliseconds.
                std::thread::park();
            }
        }
    }

    /// Calls `stop` when somebody asks the process to end, and ends it unless the command does so soon. `last_words` come before.
    pub(super) fn on_request_to_end(
        &self,
        stop: impl Fn() + Clone + Send + 'static,
        last_words: impl Fn() + Clone + Send + 'static,
    ) {
        let is_taken = self.is_taken.clone();
        signals::on_end(move || {
            stop();
            std::thread::sleep(PATIENCE);
            if Self::take(&is_taken) {
                last_words();
                files::end(Exit::Interrupted as i32);
            }
        });
    }
}

/// Ends the process as soon as somebody asks: for commands that write no files.
pub(super) fn at_once() {
    signals::on_end(|| {
        Stop::interrupted().lines().iter().for_each(complain);
        files::end(Exit::Interrupted as i32);
    });
}
