//! What a person prefers, on this machine. Kept between sessions, never part of a groom.
//!
//! A file of an older version reads with defaults for what it lacks; what it holds beyond is ignored, and numbers that mean
//! nothing are brought to what does.

use crate::core::pen;
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
    /// Whether the window is dark or light.
    pub theme: Theme,
    /// Which mouse buttons and keys turn the view.
    pub navigation: Navigation,
    /// Whether the view turns as a ball, without keeping the horizon level.
    pub trackball: bool,
    /// Samples of a picture at rest.
    pub samples: u32,
    /// Larger targets, for pens: 32 points instead of 24.
    pub pen_mode: bool,
    /// How pens feel, and what the pen's tools do.
    pub pen: pen::PenSettings,
    /// Whether text and lines stand out more than the theme makes them.
    pub strong_contrast: bool,
    /// A document that has a file is saved by itself after so many minutes with changes; 0: never.
    pub save_minutes: u32,
    /// Whether the welcome panel opens with the window.
    pub welcome: bool,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            evaluate: Evaluate::Live,
            final_while_dragging: false,
            scale: 1.0,
            theme: Theme::Dark,
            navigation: Navigation::Maya,
            trackball: false,
            samples: 32,
            pen_mode: false,
            pen: Default::default(),
            strong_contrast: false,
            save_minutes: SAVE_MINUTES,
            welcome: true,
        }
    }
}

/// Sizes that the interface can have.
pub(crate) const SCALES: std::ops::RangeInclusive<f32> = 0.75..=2.5;
/// Samples that a picture at rest may have.
pub(crate) const SAMPLES: std::ops::RangeInclusive<u32> = 1..=4096;
/// How long changes of a document that has a file wait at first until they are saved, minutes.
pub(crate) const SAVE_MINUTES: u32 = 10;
/// The longest time between two saves.
pub(crate) const MOST_MINUTES: u32 = 600;

impl Settings {
    /// The same with every number within what means something.
    pub fn within_limits(mut self) -> Self {
        if !self.scale.is_finite() {
            self.scale = 1.0;
        }
        self.scale = self.scale.clamp(*SCALES.start(), *SCALES.end());
        self.samples = self.samples.clamp(*SAMPLES.start(), *SAMPLES.end());
        self.save_minutes = self.save_minutes.min(MOST_MINUTES);
        self
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

/// Whether the window is dark or light. The picture is the same.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Theme {
    /// Light text on dark panels.
    Dark,
    /// Dark text on light panels.
    Light,
}

impl Theme {
    /// The other one.
    #[must_use]
    pub fn other(self) -> Self {
        match self {
            Self::Dark => Self::Light,
            Self::Light => Self::Dark,
        }
    }
    /// What egui calls it.
    pub fn of_egui(self) -> egui::Theme {
        match self {
            Self::Dark => egui::Theme::Dark,
            Self::Light => egui::Theme::Light,
        }
    }
}

/// Which mouse buttons and keys turn the view.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Navigation {
    /// As in Maya and Houdini: Alt or Space with left, middle and right.
    Maya,
    /// As in Blender: middle, with Shift and Ctrl.
    Blender,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn settings_come_back_lack_what_is_new_and_mean_something() {
        let set =
            Settings { scale: 1.25, trackball: true, theme: Theme::Light, ..Settings::default() };
        let text = ron::to_string(&set).unwrap();
        assert_eq!(ron::from_str::<Settings>(&text).unwrap(), set);
        let older: Settings = ron::from_str("(samples: 7, gone_since: [1, (2)])").unwrap();
        assert_eq!(older, Settings { samples: 7, ..Settings::default() });
        let wild: Settings =
            ron::from_str("(scale: inf, samples: 0, save_minutes: 4000000000)").unwrap();
        let tame = wild.within_limits();
        assert_eq!((tame.scale, tame.samples, tame.save_minutes), (1.0, 1, 600));
    }
}
