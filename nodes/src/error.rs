//! Errors of nodes, and how messages quote values.

/// Why a node has no result. The text is what the user reads on the node, after its name.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum NodeError {
    /// A required input is not wired.
    #[error("{input} is not connected: wire {expected} to it")]
    Unconnected {
        /// Input.
        input: &'static str,
        /// Type it takes.
        expected: &'static str,
    },
    /// A wire or a document carries another type than the input takes.
    #[error("{input} takes a {expected}, not a {found}")]
    WrongType {
        /// Input.
        input: &'static str,
        /// Type it takes.
        expected: &'static str,
        /// Type it got.
        found: &'static str,
    },
    /// An invalid value.
    #[error("{input}: {value} {reason}")]
    BadValue {
        /// Input.
        input: &'static str,
        /// The value, as written in the document.
        value: String,
        /// What is wrong with it and what was expected.
        reason: String,
    },
    /// A file is missing, broken or of an unknown format. Counts as an error of the document: nothing should have run.
    #[error("{file}: {reason}")]
    Refused {
        /// Its path, as in the document.
        file: String,
        /// Place and reason.
        reason: String,
    },
    /// A node would make more than the limit without permission.
    #[error(
        "{0}, and 16.8 million are the most unless more are allowed: ask for less hair or fewer points on each, or allow it \
         (--allow-large; in the editor, Evaluate anyway)"
    )]
    TooLarge(String),
    /// The evaluation was cancelled.
    #[error("cancelled")]
    Cancelled,
    /// Any other failure.
    #[error("{0}")]
    Failed(String),
}

impl NodeError {
    /// A failure with this text.
    pub fn failed(text: impl Into<String>) -> Self {
        NodeError::Failed(text.into())
    }
}

/// The beginning of a text, on one line, for messages about values of any length.
pub fn short(text: &str) -> String {
    const MOST: usize = 60;
    let mut line = String::new();
    for word in text.split_whitespace() {
        if !line.is_empty() {
            line.push(' ');
        }
        // One more character shows that the text is cut.
        line.extend(word.chars().take(MOST + 1));
        if let Some((cut, _)) = line.char_indices().nth(MOST) {
            line.truncate(cut);
            line.push('…');
            break;
        }
    }
    line
}
