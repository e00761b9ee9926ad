//! A progress line on a terminal, and nothing in a pipe.

use coif_graphs::schedule::run::Progress;
use indicatif::{ProgressBar, ProgressStyle};
use std::io::IsTerminal;

/// Shows how an evaluation goes.
pub(crate) struct Bar(Option<ProgressBar>);

impl Bar {
    /// A bar on stderr when that is a terminal.
    pub(crate) fn new() -> Self {
        let bar = std::io::stderr().is_terminal().then(|| {
            let style = ProgressStyle::with_template("{bar:30} {pos}/{len} nodes  {msg}");
            ProgressBar::new(0).with_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()))
        });
        Self(bar)
    }
    /// Takes the bar away.
    pub(crate) fn clear(&self) {
        if let Some(bar) = &self.0 {
            bar.finish_and_clear();
        }
    }
    /// Says what goes on after the evaluation.
    pub(crate) fn say(&self, text: String) {
        if let Some(bar) = &self.0 {
            bar.set_message(text);
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
        if let Some(bar) = &self.0 {
            bar.set_length(of as u64);
            bar.set_position(nodes as u64);
        }
    }
}
