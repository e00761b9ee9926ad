//! Documents and their evaluation.
