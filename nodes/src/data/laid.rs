//! A closed pen stroke laid on the skin: what it encloses, and a description of what does not fit.
//!
//! Guarantees: the same messages for drawn regions and painted masks. Not promised: useful results for lines that do
//! not fit.

use super::outline::{ConnectedSurface, Outline};
use super::scalp::HeadSpace;
use glam::Vec3;

/// A line farther from the skin than this was drawn on another head, or off the head; cm on a head of average size.
const MISSES: f32 = 0.5;
/// If the closing line is longer than this fraction of the stroke, the stroke was probably left open by mistake.
const OPEN: f32 = 0.2;
/// Fewer points enclose nothing.
pub(crate) const LEAST_POINTS: usize = 3;

/// A closed stroke on the skin.
pub(crate) struct ClosedStroke {
    /// What it encloses.
    pub(crate) outline: Outline,
    /// What does not fit, each worded to follow the stroke's name.
    pub(crate) faults: Vec<String>,
}

impl ClosedStroke {
    /// Closes the line through points (cm) near the skin. Distances to it are known up to `reach`, cm.
    pub(crate) fn new(
        net: &ConnectedSurface,
        space: &HeadSpace,
        points: &[Vec3],
        reach: f32,
    ) -> Self {
        let at = |p: Vec3| place(space, p);
        let mut faults = vec![];
        if let (true, [from, .., to]) = (gap(points) > OPEN, points) {
            let (from, to) = (at(*from), at(*to));
            faults.push(format!(
                "is open: its ends, at {from} and {to}, were joined by a straight line"
            ));
        }
        let line = net.line(points, true);
        if let Some((p, off)) = line.off.filter(|(_, off)| *off > MISSES * space.frame().unit()) {
            faults.push(format!(
                "misses the skin: at {} it is {off:.1} cm away; it was laid on the nearest skin",
                at(p)
            ));
        }
        let outline = Outline::new(net, &line, reach);
        if let Some([from, to]) = line.gaps.first() {
            faults.push(format!(
                "cannot be led over the skin from {} to {}: what it encloses there is not known",
                at(*from),
                at(*to)
            ));
        } else if outline.is_torn() {
            faults.push(
                "does not part the skin in two: it runs over a hole of the mesh or round a handle"
                    .to_owned(),
            );
        }
        Self { outline, faults }
    }

    /// Bytes held.
    pub(crate) fn bytes(&self) -> usize {
        self.outline.bytes() + self.faults.iter().map(String::len).sum::<usize>()
    }
}

/// Length of the straight closing line relative to the stroke's own length.
fn gap(positions: &[Vec3]) -> f32 {
    let length: f32 = positions.windows(2).map(|w| w[0].distance(w[1])).sum();
    match positions {
        [first, .., last] if length > 0.0 => first.distance(*last) / length,
        _ => 0.0,
    }
}

/// A point as users type it, in head units: those of the home head if the groom was made on another head.
pub(crate) fn place(space: &HeadSpace, p: Vec3) -> String {
    let p = space.given(p);
    format!("({:.1}, {:.1}, {:.1})", p.x, p.y, p.z)
}
