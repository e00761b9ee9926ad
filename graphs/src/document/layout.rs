//! What a document keeps besides its meaning: frames behind nodes, bends of wires, saved views, the light that
//! it is looked at in.
//!
//! Everything here is for people; evaluation never looks at it, and [`document_hash`] leaves it out.
//!
//! **Invariants:** names are not empty and at most [`LONGEST_NAME`] letters; every number is finite, views are within
//! 10 km;
//! bends belong to a wire that is there, and a list of bends does not end in an empty one.
//!
//! [`document_hash`]: crate::file::document_hash

use super::{Document, Point, Socket};
use std::collections::BTreeMap;

/// The most letters of a frame's or a view's name: it is a word of a menu.
pub const LONGEST_NAME: usize = 64;

/// Farther away than any head that is looked at, cm.
const FARTHEST: f32 = 1e6;

/// A box behind nodes that belong together.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Frame {
    /// Its upper left corner.
    pub at: Point,
    /// Width and height, both positive.
    pub size: Point,
    /// What stands on it.
    pub text: String,
    /// Its number among the colours of the canvas.
    pub colour: u8,
}

/// A camera that was saved under a name. Lengths are cm, in the groom's own space.
#[derive(Clone, Copy, Debug)]
pub struct SavedView {
    /// Where the eye is.
    pub eye: [f32; 3],
    /// What it looks at and is turned about.
    pub target: [f32; 3],
    /// The way that is up in the picture.
    pub up: [f32; 3],
    /// Focal length in mm, over a film 24 mm high.
    pub focal_mm: f32,
    /// The height of the picture at the target when all rays are parallel; none for perspective.
    pub orthographic: Option<f32>,
}

impl SavedView {
    fn bits(&self) -> ([[u32; 3]; 3], u32, Option<u32>) {
        let vectors = [self.eye, self.target, self.up].map(|v| v.map(f32::to_bits));
        (vectors, self.focal_mm.to_bits(), self.orthographic.map(f32::to_bits))
    }

    /// Why it cannot be kept under this name; none when it can.
    pub fn fault(&self, name: &str) -> Option<&'static str> {
        let numbers = [self.eye, self.target, self.up].concat();
        let is_length = |x: f32| x > 0.0 && x <= FARTHEST;
        if let Some(fault) = name_fault(name) {
            Some(fault)
        } else if !numbers.iter().all(|x| x.abs() <= FARTHEST) {
            Some("it is farther than 1000000 cm away")
        } else if !is_length(self.focal_mm) || !self.orthographic.is_none_or(is_length) {
            Some("its focal length and its height must be over 0 and at most 1000000")
        } else if self.eye == self.target {
            Some("its eye is where it looks")
        } else {
            None
        }
    }
}

/// Light and skin that a groom is looked at with, in the words of `coif render`. Words that a version does not know are kept;
/// it shows its own light and skin then.
#[derive(Clone, Debug)]
pub struct SavedLook {
    /// The lights.
    pub light: String,
    /// Brighter or darker than the lights' own exposure, stops within ±20.
    pub exposure: f32,
    /// The lights turned about the vertical, anticlockwise as seen from above, degrees within ±180.
    pub turn: f32,
    /// The skin.
    pub skin: String,
}

impl SavedLook {
    /// Why it cannot be kept; none when it can.
    pub fn fault(&self) -> Option<&'static str> {
        let is_word = |text: &str| {
            let letter = |c: char| c.is_ascii_alphanumeric() || c == '-' || c == '_';
            !text.is_empty() && text.len() <= LONGEST_NAME && text.chars().all(letter)
        };
        if !is_word(&self.light) || !is_word(&self.skin) {
            Some("light and skin are words of 1 to 64 letters, digits and hyphens")
        } else if !(-20.0..=20.0).contains(&self.exposure) {
            Some("its exposure is not within -20 to 20 stops")
        } else if !(-180.0..=180.0).contains(&self.turn) {
            Some("its turn is not within -180 to 180 degrees")
        } else {
            None
        }
    }
}

/// By bits, so that equality holds for every value.
impl PartialEq for SavedLook {
    fn eq(&self, other: &Self) -> bool {
        let bits = |look: &Self| [look.exposure, look.turn].map(f32::to_bits);
        (&self.light, &self.skin) == (&other.light, &other.skin) && bits(self) == bits(other)
    }
}
impl Eq for SavedLook {}

/// By bits, so that equality holds for every value.
impl PartialEq for SavedView {
    fn eq(&self, other: &Self) -> bool {
        self.bits() == other.bits()
    }
}
impl Eq for SavedView {}

impl Frame {
    /// Why it cannot be kept under this name; none when it can.
    pub fn fault(&self, name: &str) -> Option<&'static str> {
        let is_width = |x: f32| x.is_finite() && x > 0.0;
        if let Some(fault) = name_fault(name) {
            Some(fault)
        } else if !self.at.is_finite() {
            Some("its place is not a finite number")
        } else if !is_width(self.size.0) || !is_width(self.size.1) {
            Some("its width and height must be over 0")
        } else {
            None
        }
    }
}

fn name_fault(name: &str) -> Option<&'static str> {
    if name.is_empty() {
        Some("it has no name")
    } else if name.chars().count() > LONGEST_NAME {
        Some("its name has more than 64 letters")
    } else {
        None
    }
}

impl Document {
    /// The bends of a wire of an input, from its output on; none where it runs by itself.
    pub fn bends_of(&self, to: &Socket, at: usize) -> &[Point] {
        self.bends.get(to).and_then(|bends| bends.get(at)).map_or(&[], Vec::as_slice)
    }

    /// A name that no frame has yet: `stem`, else with the first free number behind it.
    pub fn free_frame(&self, stem: &str) -> String {
        free_name(&self.frames, stem)
    }

    /// A name that no view has yet: `stem`, else with the first free number behind it.
    pub fn free_view(&self, stem: &str) -> String {
        free_name(&self.views, stem)
    }

    /// Gives an input these bends, for each of its wires in order.
    pub(crate) fn set_all_bends(&mut self, to: &Socket, mut bends: Vec<Vec<Point>>) {
        while bends.last().is_some_and(Vec::is_empty) {
            bends.pop();
        }
        if bends.is_empty() {
            self.bends.remove(to);
        } else {
            self.bends.insert(to.clone(), bends);
        }
    }
}

fn free_name<T>(taken: &BTreeMap<String, T>, stem: &str) -> String {
    let stem: String = stem.trim().chars().take(LONGEST_NAME - 12).collect();
    let stem = if stem.is_empty() { "unnamed".to_owned() } else { stem };
    let mut name = stem.clone();
    for n in 2u32.. {
        if !taken.contains_key(&name) {
            break;
        }
        name = format!("{stem} {n}");
    }
    name
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_cannot_be_kept_says_why() {
        let view = SavedView {
            eye: [0.0, 0.0, 60.0],
            target: [0.0; 3],
            up: [0.0, 1.0, 0.0],
            focal_mm: 85.0,
            orthographic: None,
        };
        let frame = Frame { size: Point(3.0, 2.0), ..Frame::default() };
        let long = "x".repeat(65);
        let cases = [
            (view.fault("hero"), None),
            (view.fault(""), Some("it has no name")),
            (view.fault(&long), Some("its name has more than 64 letters")),
            (SavedView { eye: [0.0; 3], ..view }.fault("x"), Some("its eye is where it looks")),
            (
                SavedView { up: [f32::NAN; 3], ..view }.fault("x"),
                Some("it is farther than 1000000 cm away"),
            ),
            (
                SavedView { orthographic: Some(0.0), ..view }.fault("x"),
                Some("its focal length and its height must be over 0 and at most 1000000"),
            ),
            (frame.fault("front"), None),
            (
                Frame { at: Point(f32::INFINITY, 0.0), ..frame.clone() }.fault("x"),
                Some("its place is not a finite number"),
            ),
            (Frame::default().fault("x"), Some("its width and height must be over 0")),
        ];
        for (i, (found, want)) in cases.into_iter().enumerate() {
            assert_eq!(found, want, "case {i}");
        }
    }

    #[test]
    fn a_free_name_is_the_stem_or_the_first_number_behind_it() {
        let mut document = Document::default();
        let mut made = vec![];
        for stem in ["Hero", "Hero", " Hero ", "", "正面"] {
            let name = document.free_frame(stem);
            document.frames.insert(name.clone(), Frame::default());
            made.push(name);
        }
        assert_eq!(made, ["Hero", "Hero 2", "Hero 3", "unnamed", "正面"]);
        assert!(document.free_view(&"x".repeat(99)).len() <= LONGEST_NAME);
    }
}
