//! Pen strokes as documents keep them: simplified and on a grid, so that live and replay have the
//! same bits.
//!
//! A stroke is simplified once, at pen-up, before it is first evaluated; from then on it is on the
//! grid in which files hold it exactly (`values/grid.rs`).

use crate::values::grid::Steps;
use coif_nodes::data::strokes::{Sample, Stroke, Strokes};
use coif_nodes::maths::hash::{Key, KeyBuilder};

pub mod cvs;
#[cfg(test)]
mod tests;
pub mod whole;

/// How far the kept stroke may lie from the pen's samples, absolute, in head units (cm): a fifth of
/// a millimetre is a few hair widths and under the tremor of a hand. Larger shows as corners in
/// cornrows; smaller keeps tremor and costs bytes.
pub const TOLERANCE: f32 = 0.02;

/// What simplifying may use of [`TOLERANCE`] once rounding has had its share.
const SHARE: f32 = 0.011;
/// How far pressure may be from the pen's, absolute: 4 of 256 steps. One step would keep the noise
/// of the sensor, a tenth would show where pressure is width.
const PRESSURE_TOLERANCE: f32 = 4.0 / 256.0;
/// How far tilt may be from the pen's, in right angles: 5.6 degrees. A finer one would keep samples for
/// the way a wrist turns, which shows nowhere.
const TILT_TOLERANCE: f32 = 4.0 / 64.0;
/// Samples that are simplified at once. Its worst case is quadratic; a stroke of 2 s has 400
/// samples.
const WINDOW: usize = 2048;

/// A finished stroke from what the pen gave: simplified, on the grid, with an id of its own among
/// `others`.
///
/// Every sample given lies within [`TOLERANCE`] of the stroke; first and last samples stay. Samples
/// that are not finite are left out; none is made when nothing remains.
pub fn finish(samples: &[Sample], others: &Strokes) -> Option<Stroke> {
    let samples: Vec<Sample> = samples.iter().copied().filter(Sample::is_finite).collect();
    let kept = simplify(&samples, SHARE);
    let samples: Vec<Sample> = kept.into_iter().map(|i| Steps::of(&samples[i]).sample()).collect();
    (!samples.is_empty()).then(|| Stroke::new(free_id(&samples, others), samples))
}

fn free_id(samples: &[Sample], others: &Strokes) -> u64 {
    let key = |n: u64| KeyBuilder::new("stroke id").int(n).column(samples).finish();
    new_id(key, |id| others.0.iter().any(|stroke| stroke.id == id))
}

/// The first id that is not taken, of 32 bits of each key, drawn from what was drawn: what two people add
/// to the same node differs when it is merged, and a replay gives the same ids.
pub(super) fn new_id(key: impl Fn(u64) -> Key, is_taken: impl Fn(u64) -> bool) -> u64 {
    let mut ids = (0..).map(|n| u64::from(key(n).0 as u32));
    ids.find(|id| *id != 0 && !is_taken(*id)).unwrap_or_default()
}

/// The numbers of the samples to keep: Douglas and Peucker's method (1973), on position (within `share`),
/// pressure and tilt, in windows whose ends stay.
pub(super) fn simplify(samples: &[Sample], share: f32) -> Vec<usize> {
    let n = samples.len();
    let mut keep = vec![false; n];
    let mut open = vec![];
    for start in (0..n).step_by(WINDOW) {
        let end = (start + WINDOW).min(n - 1);
        (keep[start], keep[end]) = (true, true);
        open.push((start, end));
    }
    while let Some((a, b)) = open.pop() {
        let worst = (a + 1..b)
            .map(|i| (misfit(&samples[a], &samples[b], &samples[i], share), i))
            .max_by(|(x, i), (y, j)| x.total_cmp(y).then(j.cmp(i)));
        if let Some((_, i)) = worst.filter(|(misfit, _)| *misfit > 1.0) {
            keep[i] = true;
            open.extend([(a, i), (i, b)]);
        }
    }
    (0..n).filter(|i| keep[*i]).collect()
}

/// How badly a line from `a` to `b` stands for `s`: over 1 is too badly.
fn misfit(a: &Sample, b: &Sample, s: &Sample, share: f32) -> f32 {
    let (span, to) = (b.position - a.position, s.position - a.position);
    let length2 = span.length_squared();
    // A pen that rests moves in time only.
    let t = if length2 > 0.0 {
        (to.dot(span) / length2).clamp(0.0, 1.0)
    } else if b.time > a.time {
        ((s.time - a.time) / (b.time - a.time)).clamp(0.0, 1.0)
    } else {
        0.0
    };
    let off = (to - span * t).length();
    let pressure = (a.pressure + (b.pressure - a.pressure) * t - s.pressure).abs();
    let tilt = (a.tilt + (b.tilt - a.tilt) * t - s.tilt).abs().max_element();
    (off / share).max(pressure / PRESSURE_TOLERANCE).max(tilt / TILT_TOLERANCE)
}
