//! What of the hair one looks at: hidden, alone, locked. A matter of the view, never of the result.

use std::collections::BTreeSet;

/// What is hidden, alone, or locked. Curves are named by their own id or that of a parent (a braid, a section, a
/// stroke), so naming a braid names its hair.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Visibility {
    /// Not drawn.
    pub hidden: BTreeSet<u64>,
    /// When not empty, all that is drawn.
    pub alone: BTreeSet<u64>,
    /// The pen does not touch them.
    pub locked: BTreeSet<u64>,
}

impl Visibility {
    /// Whether a curve with this id and these ancestors is drawn.
    pub fn shows(&self, names: &[u64]) -> bool {
        let any = |set: &BTreeSet<u64>| names.iter().any(|name| set.contains(name));
        !any(&self.hidden) && (self.alone.is_empty() || any(&self.alone))
    }
    /// Whether all is drawn.
    pub fn shows_all(&self) -> bool {
        self.hidden.is_empty() && self.alone.is_empty()
    }
}
