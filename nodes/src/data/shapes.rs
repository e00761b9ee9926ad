//! The list of profiles that a curl is made from (Lightyear, 3.1), as a document states it.
//!
//! This is only the specification: which profiles, in which tier. The curl node turns it into 4,096 entries and into
//! points.

use crate::maths::hash::KeyBuilder;
use glam::Vec2;

/// The profile of one turn: a closed curve.
#[derive(Clone, Debug, PartialEq)]
pub enum TurnProfile {
    /// A circle: the helix.
    Circle,
    /// An ellipse by the ratio of its axes, above 0 up to 1.
    Ellipse(f32),
    /// A Lamé curve (superellipse) with this exponent, 0.3 to 20: 2 is a circle, less is pinched, more is square.
    Lame(f32),
    /// A regular polygon of 3 to 12 sides.
    Polygon(u32),
    /// A polar rose 1 + depth cos(petals phi): 2 to 12 petals, depth 0 to 0.95.
    Rose {
        /// Number of petals.
        petals: u32,
        /// Depth of the waist between petals.
        depth: f32,
    },
    /// Drawn points of a closed Catmull-Rom curve, at least three.
    Custom(Vec<Vec2>),
}

impl TurnProfile {
    /// The fewest and the most points of a drawn profile.
    pub const CORNERS: (usize, usize) = (3, 256);
    /// Points of a drawn profile are closer to the centre than this.
    pub const FARTHEST: f32 = 1e3;
}

/// How often a profile occurs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Tier {
    /// Primary: its probability is U, the uniformity.
    A,
    /// Secondary.
    B,
    /// Tertiary.
    C,
}

/// Profiles with their tiers; within a tier, all are equally likely.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ShapeList(pub Vec<(Tier, TurnProfile)>);

impl ShapeList {
    /// Why the list cannot be used, in words for the artist; `None` if it can.
    pub fn fault(&self) -> Option<String> {
        let within = |x: f32, lo: f32, hi: f32| x.is_finite() && (lo..=hi).contains(&x);
        for (_, section) in &self.0 {
            let fault = match section {
                TurnProfile::Circle => None,
                TurnProfile::Ellipse(ratio) if within(*ratio, 0.01, 1.0) => None,
                TurnProfile::Ellipse(ratio) => {
                    Some(format!("Ellipse({ratio}): the ratio runs from 0.01 to 1"))
                }
                TurnProfile::Lame(e) if within(*e, 0.3, 20.0) => None,
                TurnProfile::Lame(e) => {
                    Some(format!("Lame({e}): the exponent runs from 0.3 to 20"))
                }
                TurnProfile::Polygon(n) if (3..=12).contains(n) => None,
                TurnProfile::Polygon(n) => {
                    Some(format!("Polygon({n}): a polygon has 3 to 12 sides"))
                }
                TurnProfile::Rose { petals, depth }
                    if (2..=12).contains(petals) && within(*depth, 0.0, 0.95) =>
                {
                    None
                }
                TurnProfile::Rose { petals, depth } => {
                    Some(format!("Rose({petals}, {depth}): 2 to 12 petals, depth from 0 to 0.95"))
                }
                TurnProfile::Custom(points) => {
                    let (fewest, most) = TurnProfile::CORNERS;
                    let usable = (fewest..=most).contains(&points.len())
                        && points
                            .iter()
                            .all(|p| p.is_finite() && p.length() < TurnProfile::FARTHEST)
                        && points.iter().any(|p| p.distance(points[0]) > 1e-4);
                    (!usable).then(|| {
                        format!(
                            "Custom: {fewest} to {most} finite points nearer than {} to (0, 0), not all at one place",
                            TurnProfile::FARTHEST
                        )
                    })
                }
            };
            if fault.is_some() {
                return fault;
            }
        }
        (!self.0.iter().any(|(tier, _)| *tier == Tier::A))
            .then(|| "a shape list needs at least one shape in tier A".to_owned())
    }

    /// Adds the list to a key.
    pub fn add_to(&self, key: KeyBuilder) -> KeyBuilder {
        self.0.iter().fold(key.int(self.0.len() as u64), |key, (tier, section)| {
            let key = key.int(*tier as u64);
            match section {
                TurnProfile::Circle => key.text("circle"),
                TurnProfile::Ellipse(ratio) => key.text("ellipse").float(*ratio),
                TurnProfile::Lame(e) => key.text("lame").float(*e),
                TurnProfile::Polygon(n) => key.text("polygon").int(u64::from(*n)),
                TurnProfile::Rose { petals, depth } => {
                    key.text("rose").int(u64::from(*petals)).float(*depth)
                }
                TurnProfile::Custom(points) => {
                    points.iter().fold(key.text("custom").int(points.len() as u64), |key, p| {
                        key.float(p.x).float(p.y)
                    })
                }
            }
        })
    }
}
