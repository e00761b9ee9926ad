//! Whoever watches a job is told how far it is.

use coif_graphs::schedule::run::{Progress, Quiet};

/// Is told how far long work is: a bar on a terminal, or one in the window.
pub(crate) trait Tell: Progress {
    /// What is counted from now on.
    #[cfg_attr(not(feature = "render"), expect(dead_code, reason = "pictures count samples"))]
    fn counts(&self, what: &'static str);
    /// So many are done.
    fn count(&self, done: usize, of: usize);
    /// Says what goes on.
    fn say(&self, text: String);
}

impl Tell for Quiet {
    fn counts(&self, _: &'static str) {}
    fn count(&self, _: usize, _: usize) {}
    fn say(&self, _: String) {}
}
