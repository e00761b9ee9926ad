//! Pen strokes as a document keeps them: in the head's own frame, so that they fit another head.

use crate::maths::hash::{Key, KeyBuilder};
use glam::Vec3;

/// One sample of the pen.
#[derive(Clone, Copy, Debug, PartialEq, bytemuck::NoUninit)]
#[repr(C)]
pub struct Sample {
    /// Where the pen was: head frame (right, up, forward from the cranium's centre), in head units (cm on a head of radius
    /// 8.9 cm).
    pub position: Vec3,
    /// 0 to 1.
    pub pressure: f32,
    /// Seconds since the stroke began.
    pub time: f32,
}

/// One stroke, root first.
#[derive(Clone, Debug, PartialEq)]
pub struct Stroke {
    /// Stored with the stroke, unique within its list, never 0.
    pub id: u64,
    /// At least one.
    pub samples: Vec<Sample>,
}

/// The strokes of one node, in drawing order.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Strokes(pub Vec<Stroke>);

impl Stroke {
    /// Hash of the content.
    pub fn key(&self) -> Key {
        KeyBuilder::new("stroke").int(self.id).column(&self.samples).finish()
    }
}

impl Strokes {
    /// Hash of the content.
    pub fn key(&self) -> Key {
        self.0.iter().fold(KeyBuilder::new("strokes"), |key, s| key.key(s.key())).finish()
    }
    /// Why the list cannot be used; none when it can.
    pub fn fault(&self) -> Option<String> {
        let mut seen = std::collections::BTreeSet::new();
        for (i, stroke) in self.0.iter().enumerate() {
            if stroke.id == 0 || !seen.insert(stroke.id) {
                return Some(format!("stroke {i}: its id {} is 0 or used before", stroke.id));
            }
            let finite =
                |s: &Sample| s.position.is_finite() && s.pressure.is_finite() && s.time.is_finite();
            if !stroke.samples.iter().all(finite) {
                return Some(format!("stroke {i}: a sample is not a finite number"));
            }
        }
        None
    }
}
