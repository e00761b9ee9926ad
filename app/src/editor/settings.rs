//! What a person prefers, on this machine. Kept between sessions, never part of a groom.
//!
//! A file of an older version reads with defaults for what it lacks; what it holds beyond is ignored.

use serde::{Deserialize, Serialize};

/// Preferences. Every field has a default, so files may lack any of them.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Settings {
    /// When the graph is evaluated.
    pub evaluate: Evaluate,
    /// Whether all hair is made also while something is dragged.
    pub final_while_dragging: bool,
    /// Size of the interface, 0.75 to 2.5.
    pub scale: f32,
    /// Which mouse buttons and keys turn the view.
    pub navigation: Navigation,
    /// Whether the view turns as a ball, without keeping the horizon level.
    pub trackball: bool,
    /// Samples of a picture at rest.
    pub samples: u32,
    /// Larger targets, for pens: 32 points instead of 24.
    pub pen_mode: bool,
    /// How pens feel, and what the pen's tools do.
    pub pen: crate::pen::settings::Settings,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            evaluate: Evaluate::Live,
            final_while_dragging: false,
            scale: 1.0,
            navigation: Navigation::Maya,
            trackball: false,
            samples: 32,
            pen_mode: false,
            pen: Default::default(),
        }
    }
}

/// When the graph is evaluated.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Evaluate {
    /// At every change.
    Live,
    /// When a drag ends.
    OnRelease,
    /// When asked.
    ByKey,
}

/// Which mouse buttons and keys turn the view.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Navigation {
    /// As in Maya and Houdini: Alt or Space with left, middle and right.
    Maya,
    /// As in Blender: middle, with Shift and Ctrl.
    Blender,
}
