//! The one error of all readers and writers: where, and what is wrong there.

/// Why bytes are no groom, or a groom cannot be written as a format. Without the file's name.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{place}: {reason}")]
pub struct FormatError {
    /// Line, byte, prim or curve, as exact as the reader or writer knows it.
    pub place: String,
    /// What is wrong there, with the number and its limit where there is one.
    pub reason: String,
}

impl FormatError {
    /// An error at a place.
    pub fn at(place: impl Into<String>, reason: impl Into<String>) -> Self {
        Self { place: place.into(), reason: reason.into() }
    }
}

/// A failed write has no place in the data: the disk or pipe behind the writer failed.
impl From<std::io::Error> for FormatError {
    fn from(error: std::io::Error) -> Self {
        Self::at("output", error.to_string())
    }
}
