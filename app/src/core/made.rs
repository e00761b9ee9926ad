//! What made a hair: nodes, and the strokes and gestures in them (`graphs/src/trace.rs` has the law).

use coif_graphs::document::Document;
use coif_graphs::trace::{NotTraced, Traced};

/// What was found of a hair.
#[derive(Clone, Debug)]
pub struct HairTrace {
    /// What made it, or why that is not known.
    pub traced: Result<Traced, NotTraced>,
    /// The groom that it was found in.
    pub document: Document,
}
