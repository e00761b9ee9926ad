//! Pen strokes as a document stores them: in the head frame, so that they transfer to another head. Mask strokes have a
//! brush; their samples are the dabs.

use crate::maths::hash::{Key, KeyBuilder};
use glam::{Vec2, Vec3};

/// One sample of the pen.
#[derive(Clone, Copy, Debug, Default, PartialEq, bytemuck::NoUninit)]
#[repr(C)]
pub struct Sample {
    /// Pen position in the head frame (right, up, forward from the cranium's centre), in head units (cm on a head of
    /// radius 8.9 cm).
    pub position: Vec3,
    /// 0 to 1.
    pub pressure: f32,
    /// Seconds since the stroke began.
    pub time: f32,
    /// Tilt of the pen to the right and toward the user, as a fraction of 90 degrees, each -1 to 1; 0 is upright, and
    /// the value of devices without tilt.
    pub tilt: Vec2,
}

impl Sample {
    /// Whether all its numbers are finite.
    pub fn is_finite(&self) -> bool {
        self.position.is_finite()
            && self.pressure.is_finite()
            && self.time.is_finite()
            && self.tilt.is_finite()
    }
}

/// What a stroke does to a painted mask.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Mode {
    /// Blends the mask toward 1.
    Paint,
    /// Blends the mask toward 0.
    Erase,
    /// Smooths the mask.
    Smooth,
    /// Sets the whole section, or head, to the strength.
    Flood,
}

impl Mode {
    /// Every mode and its word in documents.
    pub const ALL: &[(Mode, &str)] = &[
        (Mode::Paint, "paint"),
        (Mode::Erase, "erase"),
        (Mode::Smooth, "smooth"),
        (Mode::Flood, "flood"),
    ];
    /// Its word in documents and messages.
    pub fn word(self) -> &'static str {
        Self::ALL.iter().find(|(mode, _)| *mode == self).map_or("", |(_, word)| word)
    }
    /// The mode with this word.
    pub fn named(word: &str) -> Option<Self> {
        Self::ALL.iter().find(|(_, own)| *own == word).map(|(mode, _)| *mode)
    }
}

/// The brush of a mask stroke.
#[derive(Clone, Debug, PartialEq)]
pub struct Brush {
    /// What it does.
    pub mode: Mode,
    /// Radius of a dab, head units; within [`Brush::RADII`].
    pub radius: f32,
    /// Effect of one pass at full pressure, 0 to 1; for a flood, the value.
    pub strength: f32,
    /// Whether it also acts on the other side of the head.
    pub mirrored: bool,
    /// Whether the stroke is closed: it then acts on everything inside, the smaller part of the surface.
    pub closed: bool,
    /// The section of a parted scalp that it is limited to; empty: none.
    pub section: String,
}

impl Default for Brush {
    fn default() -> Self {
        Self {
            mode: Mode::Paint,
            radius: 1.0,
            strength: 1.0,
            mirrored: false,
            closed: false,
            section: String::new(),
        }
    }
}

impl Brush {
    /// The smallest and the largest brush, head units.
    pub const RADII: (f32, f32) = (0.05, 30.0);

    fn fault(&self) -> Option<String> {
        let (low, high) = Self::RADII;
        if !(low..=high).contains(&self.radius) {
            return Some(format!(
                "the radius {:?} of its brush is outside {low} to {high}",
                self.radius
            ));
        }
        if !(0.0..=1.0).contains(&self.strength) {
            return Some(format!("its strength {:?} is outside 0 to 1", self.strength));
        }
        None
    }
}

/// One stroke, root first.
#[derive(Clone, Debug, PartialEq)]
pub struct Stroke {
    /// Stored with the stroke, unique within its list, never 0.
    pub id: u64,
    /// At least one.
    pub samples: Vec<Sample>,
    /// The samples as drawn, kept from the first edit on so that the stroke can be fitted again; empty before. Ignored
    /// by evaluation and keys.
    pub drawn: Vec<Sample>,
    /// The brush of a mask stroke; `None` for a curve.
    pub brush: Option<Brush>,
}

/// The strokes of one node, in drawing order.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Strokes(pub Vec<Stroke>);

impl Stroke {
    /// A stroke as it was drawn.
    pub fn new(id: u64, samples: Vec<Sample>) -> Self {
        Self { id, samples, drawn: vec![], brush: None }
    }
    /// Hash of the content.
    pub fn key(&self) -> Key {
        let key = KeyBuilder::new("stroke").int(self.id).column(&self.samples);
        let Some(brush) = &self.brush else { return key.finish() };
        key.text(brush.mode.word())
            .float(brush.radius)
            .float(brush.strength)
            .int(u64::from(brush.mirrored) + 2 * u64::from(brush.closed))
            .text(&brush.section)
            .finish()
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
    /// Why the list cannot be used; `None` if it can.
    pub fn fault(&self) -> Option<String> {
        let mut seen = std::collections::BTreeSet::new();
        for (i, stroke) in self.0.iter().enumerate() {
            if stroke.id == 0 || !seen.insert(stroke.id) {
                return Some(format!("stroke {i}: its id {} is 0 or used before", stroke.id));
            }
            if !stroke.samples.iter().chain(&stroke.drawn).all(Sample::is_finite) {
                return Some(format!("stroke {i}: a sample is not a finite number"));
            }
            if let Some(fault) = stroke.brush.as_ref().and_then(Brush::fault) {
                return Some(format!("stroke {i}: {fault}"));
            }
        }
        None
    }
}
