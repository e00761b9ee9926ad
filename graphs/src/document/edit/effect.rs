//! Which edits can change what is evaluated, and which are for people alone.
//!
//! Guarantees: documents before and after an edit that changes nothing give the same hair by `compare` (a test there asserts it).

use super::Edit;

impl Edit {
    /// Whether the edit may change what is evaluated or displayed, not only names, notes, comments, looks and the layout of the graph.
    pub fn changes_evaluation(&self) -> bool {
        match self {
            Self::Move { .. }
            | Self::SetTitle(_)
            | Self::SetNote(_)
            | Self::SetLabel { .. }
            | Self::SetNodeNote { .. }
            | Self::SetFrame { .. }
            | Self::SetBends { .. }
            | Self::SetCollapsed { .. }
            | Self::SetView { .. }
            | Self::SetLook(_)
            | Self::SetThumbnail(_)
            | Self::SetComment { .. } => false,
            Self::Several(edits) => edits.iter().any(Self::changes_evaluation),
            _ => true,
        }
    }
}
