//! What others know of the pen: how each is to feel, as people set it (kept with the settings of the editor, by the name of the
//! device), and what it has hold of.
//!
//! Whatever a settings file says, every answer here is a finite number in its range.

use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Settings of the pen room.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct PenSettings {
    /// By the device's name; the mouse and touch screens have names of their own.
    pub devices: BTreeMap<String, Feel>,
    /// The pressure of a mouse, 0 to 1: it has none of its own.
    pub mouse_pressure: f32,
    /// Whether a finger works as a pen does. Never while a pen is near.
    pub fingers_draw: bool,
    /// Radius of the brush, cm.
    pub brush: f32,
    /// How much a brush does in one pass, 0 to 1. Pressure is on top of it.
    pub strength: f32,
    /// How far along a stroke a moved point takes its neighbours with it, cm.
    pub falloff: f32,
    /// Whether new strokes are drawn on both sides of the head.
    pub symmetry: bool,
    /// How dragged points move.
    pub along: Along,
    /// Radius of the brushes that work on hair, cm at the head.
    pub hair_brush: f32,
    /// How far around what a tool acts on hair follows, cm at the head; 0: none does.
    pub hair_soft: f32,
    /// Colour of clusters that are implanted, sRGB; none: that of the hair downstream.
    pub hair_colour: Option<[u8; 3]>,
    /// Whether the level of a touch on hair is told by the mean pressure of its first 2 pixels, as in the paper, instead of the
    /// highest of its beginning.
    pub level_by_mean: bool,
    /// Whether the bar says what its tools are called, besides their icons.
    pub words: bool,
    /// Whether the pen works on single strands instead of what they grow from. Not kept.
    #[serde(skip)]
    pub strands: bool,
}

impl Default for PenSettings {
    fn default() -> Self {
        Self {
            devices: BTreeMap::new(),
            mouse_pressure: 0.5,
            fingers_draw: true,
            brush: 1.0,
            strength: 0.5,
            falloff: 2.0,
            symmetry: false,
            along: Along::Scalp,
            hair_brush: 3.0,
            hair_soft: 0.0,
            hair_colour: None,
            level_by_mean: false,
            words: false,
            strands: false,
        }
    }
}

/// What a dragged point of a stroke moves along.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Along {
    /// The scalp, at the height that it has.
    #[default]
    Scalp,
    /// The plane of the view.
    View,
    /// The scalp's normal under it.
    Normal,
}

/// The name under which the mouse's feel is kept.
pub const MOUSE: &str = "mouse";
/// The name under which the feel of touch screens and of pens on them is kept.
pub const TOUCH: &str = "touch";

/// The feel of one device.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Feel {
    /// What becomes of its pressure.
    pub curve: Curve,
    /// Pressure up to here counts as none: for worn tips that never lift. 0 to 0.9.
    pub minimum: f32,
    /// How far the line lags behind a trembling hand: 0 not at all, 1 is 150 ms.
    pub stabiliser: f32,
    /// How far apart two taps may be that count as a double tap, in points of the screen.
    pub double_tap: f32,
    /// Held in the left hand: labels go to the left of the pen, where the hand does not cover them.
    pub left_handed: bool,
}

impl Default for Feel {
    fn default() -> Self {
        Self {
            curve: Curve::LINEAR,
            minimum: 0.0,
            stabiliser: 0.2,
            double_tap: 12.0,
            left_handed: false,
        }
    }
}

/// A pressure curve: a cubic Bezier from no pressure to full, by its two inner points (pressure in, pressure out), each
/// 0 to 1.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Curve {
    /// The point that rules light pressure.
    pub light: (f32, f32),
    /// The point that rules heavy pressure.
    pub heavy: (f32, f32),
}

impl Curve {
    /// As the device says.
    pub const LINEAR: Self = Self { light: (1.0 / 3.0, 1.0 / 3.0), heavy: (2.0 / 3.0, 2.0 / 3.0) };
    /// A light hand reaches full pressure.
    pub const SOFT: Self = Self { light: (0.1, 0.4), heavy: (0.5, 1.0) };
    /// Full pressure needs a firm hand.
    pub const FIRM: Self = Self { light: (0.5, 0.0), heavy: (0.9, 0.6) };

    /// What a pressure becomes. Never falls as pressure rises, whatever the points' `in` are.
    pub fn at(&self, pressure: f32) -> f32 {
        let unit = |x: f32| if x.is_finite() { x.clamp(0.0, 1.0) } else { 0.5 };
        let (light, heavy) = (self.light, self.heavy);
        let bezier = |a: f32, b: f32, t: f32| {
            let s = 1.0 - t;
            3.0 * s * s * t * a + 3.0 * s * t * t * b + t * t * t
        };
        let pressure = unit(pressure);
        let (mut low, mut high) = (0.0f32, 1.0f32);
        // With both inner points between 0 and 1 `in` rises along the curve, so halving finds it.
        for _ in 0..24 {
            let middle = (low + high) / 2.0;
            if bezier(unit(light.0), unit(heavy.0), middle) < pressure {
                low = middle;
            } else {
                high = middle;
            }
        }
        bezier(unit(light.1), unit(heavy.1), high).clamp(0.0, 1.0)
    }
}

impl Feel {
    /// The pressure that tools see, of the pressure that the device reports.
    pub fn pressure(&self, reported: f32) -> f32 {
        let minimum = if self.minimum.is_finite() { self.minimum.clamp(0.0, 0.9) } else { 0.0 };
        if reported <= minimum && minimum > 0.0 {
            return 0.0;
        }
        self.curve.at((reported - minimum) / (1.0 - minimum))
    }
    /// The lag of the stabiliser, seconds.
    pub fn lag(&self) -> f64 {
        if self.stabiliser.is_finite() {
            f64::from(self.stabiliser.clamp(0.0, 1.0)) * 0.15
        } else {
            0.0
        }
    }
}

impl PenSettings {
    /// The feel of a device; that of a new one when nobody has set it.
    pub fn feel(&self, name: &str) -> Feel {
        self.devices.get(name).copied().unwrap_or_else(|| match name {
            // A mouse does not tremble, and lag would only be felt.
            MOUSE => Feel { stabiliser: 0.0, ..Feel::default() },
            _ => Feel::default(),
        })
    }
    /// The brush's radius, cm.
    pub fn brush(&self) -> f32 {
        if self.brush.is_finite() { self.brush.clamp(0.05, 20.0) } else { 1.0 }
    }
    /// The radius of brushes on hair, cm.
    pub fn hair_brush(&self) -> f32 {
        if self.hair_brush.is_finite() { self.hair_brush.clamp(0.1, 50.0) } else { 3.0 }
    }
    /// How far around what a tool acts on hair follows, within what makes sense, cm.
    pub fn hair_soft(&self) -> f32 {
        if self.hair_soft.is_finite() { self.hair_soft.clamp(0.0, 50.0) } else { 0.0 }
    }
    /// The colour of implants, linear.
    pub fn hair_colour(&self) -> Option<glam::Vec3> {
        let [r, g, b] = self.hair_colour?;
        let [r, g, b, _] = egui::Rgba::from(egui::Color32::from_rgb(r, g, b)).to_array();
        Some(glam::Vec3::new(r, g, b))
    }
    /// The brush's strength.
    pub fn strength(&self) -> f32 {
        if self.strength.is_finite() { self.strength.clamp(0.01, 1.0) } else { 0.5 }
    }
}

/// What the pen has hold of.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Holds {
    /// A plain touch or click: it picks nothing.
    pub pointer: bool,
    /// The wheel: it does not zoom.
    pub wheel: bool,
    /// A pen is near, so that buttons beside the first are its barrel's.
    pub near: bool,
    /// It works on the skin: hair is to be seen through.
    pub skin: bool,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pressure_curves_rise_from_none_to_full() {
        let nan = Curve { light: (f32::NAN, -9.0), heavy: (7.0, f32::INFINITY) };
        for curve in [Curve::LINEAR, Curve::SOFT, Curve::FIRM, nan] {
            let told: Vec<f32> = (0..=200).map(|k| curve.at(k as f32 / 200.0)).collect();
            assert!(told.windows(2).all(|w| w[0] <= w[1]) && told.iter().all(|p| p.is_finite()));
            assert!(told[0] < 1e-3 && told[200] > 0.999, "{} {}", told[0], told[200]);
        }
        for k in 0..=20 {
            let p = k as f32 / 20.0;
            assert!((Curve::LINEAR.at(p) - p).abs() < 1e-4);
            assert!(Curve::SOFT.at(p) >= p - 1e-4 && Curve::FIRM.at(p) <= p + 1e-4);
        }
    }

    #[test]
    fn a_worn_tip_is_silent_up_to_its_minimum() {
        let feel = Feel { minimum: 0.2, ..Feel::default() };
        let table = [(0.0, 0.0), (0.2, 0.0), (0.6, 0.5), (1.0, 1.0)];
        for (reported, told) in table {
            assert!((feel.pressure(reported) - told).abs() < 1e-4, "{reported}");
        }
        let broken = Feel { minimum: f32::NAN, stabiliser: f32::NAN, ..Feel::default() };
        assert!((broken.pressure(0.5) - 0.5).abs() < 1e-4 && broken.lag() == 0.0);
    }
}
