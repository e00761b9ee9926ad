//! Landmarks: named points on a head, used to fit a groom from one head to another. Eight lie around the cranium, three in the face.
//!
//! Positions are in head units in the head frame (x to the head's left, y up, z forward), like strokes. As text they
//! are written like region names: `crown 0 9.9 -4.1; chin 0 -9 6.5`. Any landmark may be missing; unknown ones are
//! never invented.

use super::sections::named_points;
use glam::Vec3;
use std::fmt;

/// A point that every head has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Landmark {
    /// Where the hairline crosses the middle of the forehead.
    Front,
    /// Where the hairline crosses the middle of the neck.
    Nape,
    /// The hairline between forehead and ear, on the head's left.
    LeftTemple,
    /// The same on its right.
    RightTemple,
    /// The skin above the ear, where hair passes around it, on the head's left.
    LeftEar,
    /// The same on its right.
    RightEar,
    /// The top of the back of the head.
    Crown,
    /// The point of the chin.
    Chin,
    /// The deepest point of the bridge of the nose, between the eyes.
    Bridge,
    /// The tip of the nose.
    Nose,
    /// The middle of the mouth, where the lips meet.
    Mouth,
}

impl Landmark {
    /// All of them, in writing order.
    pub const ALL: [Self; 11] = [
        Self::Front,
        Self::Nape,
        Self::LeftTemple,
        Self::RightTemple,
        Self::LeftEar,
        Self::RightEar,
        Self::Crown,
        Self::Chin,
        Self::Bridge,
        Self::Nose,
        Self::Mouth,
    ];

    /// Its name as it is typed.
    pub fn name(self) -> &'static str {
        match self {
            Self::Front => "front",
            Self::Nape => "nape",
            Self::LeftTemple => "left temple",
            Self::RightTemple => "right temple",
            Self::LeftEar => "left ear",
            Self::RightEar => "right ear",
            Self::Crown => "crown",
            Self::Chin => "chin",
            Self::Bridge => "bridge",
            Self::Nose => "nose",
            Self::Mouth => "mouth",
        }
    }

    /// Whether it lies in the face. Grooms of earlier versions do not know these.
    pub fn is_in_face(self) -> bool {
        matches!(self, Self::Bridge | Self::Nose | Self::Mouth)
    }

    /// All names, for messages.
    pub fn names() -> String {
        Self::ALL.map(Self::name).join(", ")
    }
}

/// Landmarks at most this far apart are equal, head units: they are written to 0.001.
const SAME: f32 = 0.001;

/// The known landmarks of a head, in head units.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Landmarks([Option<Vec3>; Landmark::ALL.len()]);

impl Landmarks {
    /// Parses landmarks as users type them; also returns a line for each entry that is invalid.
    pub fn parse(text: &str) -> (Self, Vec<String>) {
        let (points, mut faults) = named_points(text);
        let mut out = Self::default();
        for (name, at) in points {
            let known = Landmark::ALL.into_iter().find(|mark| mark.name() == name.to_lowercase());
            match known {
                None => faults.push(format!(
                    "{:?} is no landmark; landmarks are {}",
                    crate::error::short(&name),
                    Landmark::names()
                )),
                Some(mark) if out.get(mark).is_some() => {
                    faults.push(format!("{name:?} is there twice; the first counts"));
                }
                Some(mark) => out.set(mark, Some(at)),
            }
        }
        (out, faults)
    }

    /// Position of a landmark; `None` if unknown.
    pub fn get(&self, mark: Landmark) -> Option<Vec3> {
        self.0[mark as usize]
    }
    /// Sets one.
    pub fn set(&mut self, mark: Landmark, at: Option<Vec3>) {
        self.0[mark as usize] = at.filter(|at| at.is_finite());
    }
    /// Those that are known.
    pub fn each(&self) -> impl Iterator<Item = (Landmark, Vec3)> {
        Landmark::ALL.into_iter().zip(self.0).filter_map(|(mark, at)| Some((mark, at?)))
    }
    /// Names of the unknown landmarks, for messages; `None` if all are known.
    pub fn missing(&self) -> Option<String> {
        self.missing_of(|_| true)
    }
    /// The same among those that are `asked` for.
    pub fn missing_of(&self, asked: impl Fn(Landmark) -> bool) -> Option<String> {
        let gone =
            Landmark::ALL.into_iter().filter(|mark| asked(*mark) && self.get(*mark).is_none());
        let gone: Vec<&str> = gone.map(Landmark::name).collect();
        (!gone.is_empty()).then(|| gone.join(", "))
    }
    /// Whether both know the same landmarks, at the same positions to 0.01 mm.
    pub fn same(&self, other: &Self) -> bool {
        Landmark::ALL.into_iter().all(|mark| match (self.get(mark), other.get(mark)) {
            (Some(a), Some(b)) => a.distance(b) <= SAME,
            (a, b) => a == b,
        })
    }
}

/// As users type them, to a thousandth.
impl fmt::Display for Landmarks {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (i, (mark, at)) in self.each().enumerate() {
            // (Adding 0 makes -0 plain.)
            let [x, y, z] = at.to_array().map(|x| (x * 1000.0).round() / 1000.0 + 0.0);
            let between = if i > 0 { "; " } else { "" };
            write!(f, "{between}{} {x} {y} {z}", mark.name())?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::maths::hash::Dice;

    #[test]
    fn what_is_written_is_read_back_as_the_same() {
        let dice = Dice::new(3, 0, "landmarks");
        for id in 0..500 {
            let mut all = Landmarks::default();
            for (k, mark) in (0u64..).zip(Landmark::ALL) {
                let at = |axis| dice.signed(id, 3 * k + axis) * 14.0;
                let known = dice.unit(id, 100 + k) < 0.8;
                all.set(mark, known.then(|| Vec3::new(at(0), at(1), at(2))));
            }
            let (read, faults) = Landmarks::parse(&all.to_string());
            assert!(read.same(&all) && faults.is_empty(), "{all} {read} {faults:?}");
            assert_eq!(read.to_string(), all.to_string());
        }
    }

    #[test]
    fn what_is_no_landmark_is_told_and_the_rest_is_read() {
        let (read, faults) =
            Landmarks::parse("crown 0 9 -4; brow 0 0 9; Chin 0 -9 7\n; chin 1 1 1; nape 1 2; x");
        assert_eq!(read.to_string(), "crown 0 9 -4; chin 0 -9 7");
        assert_eq!(read.missing_of(Landmark::is_in_face).unwrap(), "bridge, nose, mouth");
        assert_eq!(
            read.missing().unwrap(),
            "front, nape, left temple, right temple, left ear, right ear, bridge, nose, mouth"
        );
        assert!(
            faults.len() == 4 && faults.iter().any(|fault| fault.contains("brow")),
            "{faults:?}"
        );
    }
}
