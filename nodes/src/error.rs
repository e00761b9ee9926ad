//! Why a node gave no result, and how a message quotes what it is about.

/// Why a node gave no result. The text is what the user reads on the node; its name is put before it.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum NodeError {
    /// Nothing is wired to an input the node cannot do without.
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
    /// A value that means nothing here.
    #[error("{input}: {value} {reason}")]
    BadValue {
        /// Input.
        input: &'static str,
        /// The value, as the document writes it.
        value: String,
        /// What is wrong with it and what was expected.
        reason: String,
    },
    /// A file is missing, broken or of a kind that cannot be read. Counts as an error of the document: nothing
    /// should have run.
    #[error("{file}: {reason}")]
    Refused {
        /// Its path, as the document has it.
        file: String,
        /// Place and reason.
        reason: String,
    },
    /// More than a node makes where nobody has allowed it.
    #[error(
        "{0}, and 16.8 million are the most unless more are allowed: ask for less hair or fewer points on each, or allow it \
         (--allow-large; in the editor, Evaluate anyway)"
    )]
    TooLarge(String),
    /// Somebody asked to stop.
    #[error("cancelled")]
    Cancelled,
    /// Anything else.
    #[error("{0}")]
    Failed(String),
}

impl NodeError {
    /// A failure in words.
    pub fn failed(text: impl Into<String>) -> Self {
        NodeError::Failed(text.into())
    }
}

/// The first words of a text, on one line: what a message quotes of something that may be as long as it likes.
pub fn short(text: &str) -> String {
    const MOST: usize = 60;
    let mut line = String::new();
    for word in text.split_whitespace() {
        if !line.is_empty() {
            line.push(' ');
        }
        // One more than may be shown tells that it is cut.
        line.extend(word.chars().take(MOST + 1));
        if let Some((cut, _)) = line.char_indices().nth(MOST) {
            line.truncate(cut);
            line.push('…');
            break;
        }
    }
    line
}
