//! What a pen says, whatever it is plugged into: one [`PenSample`] a report of the device.
//!
//! Shaped like the tablet data of winit 0.31, so that our own backends can go when egui hands that on. A sample is a
//! report, not an interpretation: pressure curves, stabilisers, palms and double taps come after (`device.rs`).
//!
//! Guaranteed of every sample that a backend gives: all numbers are finite and within the ranges stated here, and times
//! of one device never go back.

use egui::{Pos2, Vec2};

/// What happened.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Phase {
    /// Moved near the surface without touching it.
    Hover,
    /// Touched it.
    Down,
    /// Moved while touching.
    Move,
    /// Was lifted.
    Up,
    /// Left the surface's reach.
    Out,
}

/// What touched or hovered.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Tool {
    /// The writing end of a pen.
    Tip,
    /// Its other end.
    Eraser,
    /// A mouse, or anything that moves the pointer and has no pressure.
    Mouse,
    /// A finger.
    Finger,
}

/// Buttons that are held, beside the tip's contact.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Buttons {
    /// The lower barrel button, the right one of a mouse.
    pub barrel: bool,
    /// The upper barrel button, the middle one of a mouse.
    pub second: bool,
}

/// A device for as long as it is plugged in.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Device(pub u32);

/// The pointer that is no pen.
pub const MOUSE: Device = Device(u32::MAX);

/// One report of a device.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PenSample {
    /// Seconds on the device's own clock; only differences mean something.
    pub time: f64,
    /// What happened.
    pub phase: Phase,
    /// Where in the window, in egui's points.
    pub pos: Pos2,
    /// 0 to 1. 0 while hovering.
    pub pressure: f32,
    /// How far the pen leans right and towards its holder, degrees / 90: -1 to 1.
    pub tilt: Vec2,
    /// Turn about its own axis, degrees from 0 to 360.
    pub twist: f32,
    /// Which end of what.
    pub tool: Tool,
    /// Held buttons.
    pub buttons: Buttons,
    /// Which device.
    pub device: Device,
}

impl PenSample {
    /// A mouse at `pos` with a pressure of choice.
    pub fn mouse(time: f64, phase: Phase, pos: Pos2, pressure: f32) -> Self {
        Self {
            time,
            phase,
            pos,
            pressure,
            tilt: Vec2::ZERO,
            twist: 0.0,
            tool: Tool::Mouse,
            buttons: Buttons::default(),
            device: MOUSE,
        }
    }
    /// Whether the device touches the surface or has just stopped.
    pub fn touches(&self) -> bool {
        matches!(self.phase, Phase::Down | Phase::Move | Phase::Up)
    }
}

/// The millisecond clock of a display server, which starts again after 49.7 days, as seconds that never go back.
#[derive(Clone, Copy, Debug, Default)]
pub struct Clock {
    last: Option<u32>,
    milliseconds: u64,
}

impl Clock {
    /// Seconds since the first time told. A time a little before the last one counts as the last.
    pub fn seconds(&mut self, milliseconds: u32) -> f64 {
        let step = milliseconds.wrapping_sub(*self.last.get_or_insert(milliseconds));
        if step < u32::MAX / 2 {
            self.milliseconds += u64::from(step);
            self.last = Some(milliseconds);
        }
        self.milliseconds as f64 / 1000.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_clock_goes_on_over_its_end_and_never_back() {
        let mut clock = Clock::default();
        let seconds = [u32::MAX - 999, u32::MAX, 500, 400, 1500].map(|t| clock.seconds(t));
        assert_eq!(seconds, [0.0, 0.999, 1.5, 1.5, 2.5]);
    }
}
