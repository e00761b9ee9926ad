//! A progress line on a terminal, and nothing in a pipe.

use crate::jobs::progress::Tell;
use crate::words::plain;
use coif_graphs::schedule::run::Progress;
use indicatif::{ProgressBar, ProgressStyle};
use std::io::IsTerminal;

/// Shows how long work goes.
pub(crate) struct Bar(Option<ProgressBar>);

impl Bar {
    /// A bar that counts `of` something, on stderr when that is a terminal.
    pub(crate) fn new(of: &'static str) -> Self {
        let bar = std::io::stderr().is_terminal().then(|| {
            let style = ProgressStyle::with_template("{bar:30} {pos}/{len} {prefix}  {msg}");
            ProgressBar::new(0)
                .with_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()))
                .with_prefix(of)
        });
        Self(bar)
    }
    /// Takes the bar away.
    pub(crate) fn clear(&self) {
        if let Some(bar) = &self.0 {
            bar.finish_and_clear();
        }
    }
}

impl Tell for Bar {
    fn counts(&self, what: &'static str) {
        if let Some(bar) = &self.0 {
            bar.set_prefix(what);
        }
    }
    fn count(&self, done: usize, of: usize) {
        if let Some(bar) = &self.0 {
            bar.set_length(of as u64);
            bar.set_position(done as u64);
        }
    }
    fn say(&self, text: String) {
        if let Some(bar) = &self.0 {
            bar.set_message(plain(&text).replace('\n', " "));
        }
    }
}

impl Progress for Bar {
    fn started(&self, node: &str) {
        self.say(node.to_owned());
    }
    fn pieces(&self, node: &str, done: usize, of: usize) {
        if of > 1 {
            self.say(format!("{node} {done}/{of}"));
        }
    }
    fn done(&self, nodes: usize, of: usize) {
        self.count(nodes, of);
    }
}
