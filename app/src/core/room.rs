//! The rooms of the window.

use serde::{Deserialize, Serialize};

/// A part of the window with a tab of its own.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
pub enum Room {
    /// The groom, and where the pen draws.
    Viewport,
    /// The nodes and their wires.
    Canvas,
    /// What the active node is set to.
    Inspector,
    /// What the groom is made of.
    Outliner,
    /// What can be put among the nodes.
    Templates,
    /// Numbers of curves and points.
    Spreadsheet,
    /// What went wrong, what was done.
    Messages,
    /// Steps that can be taken back.
    History,
}

impl Room {
    /// All rooms, in the menu's order.
    pub const ALL: [Self; 8] = [
        Self::Viewport,
        Self::Canvas,
        Self::Inspector,
        Self::Outliner,
        Self::Templates,
        Self::Spreadsheet,
        Self::Messages,
        Self::History,
    ];

    /// What its tab says.
    pub fn title(self) -> &'static str {
        match self {
            Self::Viewport => "Viewport",
            Self::Canvas => "Nodes",
            Self::Inspector => "Inspector",
            Self::Outliner => "Outliner",
            Self::Templates => "Templates",
            Self::Spreadsheet => "Spreadsheet",
            Self::Messages => "Messages",
            Self::History => "History",
        }
    }
}
