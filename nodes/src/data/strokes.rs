//! Pen strokes as a document keeps them: in the head's own frame, so that they fit another head.

use crate::maths::hash::{Key, KeyBuilder};
use glam::{Vec2, Vec3};

/// One sample of the pen.
#[derive(Clone, Copy, Debug, Default, PartialEq, bytemuck::NoUninit)]
#[repr(C)]
pub struct Sample {
    /// Where the pen was: head frame (right, up, forward from the cranium's centre), in head units (cm on a head of radius
    /// 8.9 cm).
    pub position: Vec3,
    /// 0 to 1.
    pub pressure: f32,
    /// Seconds since the stroke began.
    pub time: f32,
    /// How far the pen leans to the right and towards the user, in quotients of 90 degrees, each -1 to 1;
    /// 0 is upright, and what devices without tilt give.
    pub tilt: Vec2,
}

impl Sample {
    /// Whether every number of it is finite.
    pub fn is_finite(&self) -> bool {
        self.position.is_finite()
            && self.pressure.is_finite()
            && self.time.is_finite()
            && self.tilt.is_finite()
    }
}

/// One stroke, root first.
#[derive(Clone, Debug, PartialEq)]
pub struct Stroke {
    /// Stored with the stroke, unique within its list, never 0.
    pub id: u64,
    /// At least one.
    pub samples: Vec<Sample>,
    /// The samples as drawn, kept from the first edit on so that the stroke can be fitted again; empty
    /// before. Means nothing to evaluation and is no part of keys.
    pub drawn: Vec<Sample>,
}

/// The strokes of one node, in drawing order.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Strokes(pub Vec<Stroke>);

impl Stroke {
    /// A stroke as it was drawn.
    pub fn new(id: u64, samples: Vec<Sample>) -> Self {
        Self { id, samples, drawn: vec![] }
    }
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
    /// Bytes held.
    pub fn bytes(&self) -> usize {
        let samples = self.0.iter().map(|stroke| stroke.samples.len() + stroke.drawn.len());
        samples.sum::<usize>() * size_of::<Sample>() + self.0.len() * size_of::<Stroke>()
    }
    /// Why the list cannot be used; none when it can.
    pub fn fault(&self) -> Option<String> {
        let mut seen = std::collections::BTreeSet::new();
        for (i, stroke) in self.0.iter().enumerate() {
            if stroke.id == 0 || !seen.insert(stroke.id) {
                return Some(format!("stroke {i}: its id {} is 0 or used before", stroke.id));
            }
            if !stroke.samples.iter().chain(&stroke.drawn).all(Sample::is_finite) {
                return Some(format!("stroke {i}: a sample is not a finite number"));
            }
        }
        None
    }
}
