//! Bytes to data and data to bytes. Nothing here opens a file or knows a path.

/// Names of the files that a file of this extension refers to and that its reader needs.
pub fn side_files(_extension: &str, _bytes: &[u8]) -> Vec<String> {
    vec![]
}
