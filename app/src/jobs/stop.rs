//! How jobs end: done, or stopped early with a code and what to say.

use coif_graphs::schedule::run::CancelToken;
use std::path::Path;

/// How a job ended, as exit codes say it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Exit {
    /// All done; warnings are allowed.
    Done = 0,
    /// A node on the way to an output failed, none of them has curves, or writing failed.
    Failed = 1,
    /// Wrong before anything ran.
    Refused = 2,
    /// Somebody asked it to end: Ctrl-C, SIGTERM, SIGHUP.
    Interrupted = 130,
}

/// Why an evaluation ended early.
pub(crate) struct Stop(pub(crate) Exit, pub(crate) Vec<String>);

impl Stop {
    /// Wrong before anything ran.
    pub(crate) fn refused(text: impl Into<String>) -> Self {
        Self(Exit::Refused, vec![text.into()])
    }
    /// What to say, a line each.
    pub(crate) fn lines(&self) -> &[String] {
        &self.1
    }
    /// The code that it ends with.
    pub(crate) fn exit(&self) -> Exit {
        self.0
    }
    /// Whether a person ended it.
    #[cfg(any(feature = "render", feature = "editor"))]
    pub(crate) fn is_interruption(&self) -> bool {
        self.0 == Exit::Interrupted
    }
    /// Ended by a person.
    pub(crate) fn interrupted() -> Self {
        Self(Exit::Interrupted, vec!["interrupted".to_owned()])
    }
    /// Failed while it ran.
    pub(crate) fn failed(text: impl Into<String>) -> Self {
        Self(Exit::Failed, vec![text.into()])
    }
    /// A file could not be written, or nobody was to wait for it.
    pub(crate) fn unwritten(path: &Path, reason: &str, cancel: &CancelToken) -> Self {
        match cancel.is_cancelled() {
            true => Self::interrupted(),
            false => Self::failed(format!("{}: {reason}", path.display())),
        }
    }
}

/// What `--strict` says where there are warnings, which are told already.
pub(crate) fn not_strict(graph: impl AsRef<Path>) -> String {
    format!("{}: has warnings, which --strict does not let pass", graph.as_ref().display())
}
