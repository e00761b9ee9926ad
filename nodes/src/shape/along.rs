//! Values along hair, for every node that colours or sizes it.
//!
//! Guarantees: values are stored once for all, once per curve or once per point, as few times as the caller allows;
//! nothing else of the tuft changes or is copied.

use crate::data::attributes::{Declared, Domain, Item};
use crate::data::curves::Tuft;
use crate::define::NodeError;
use crate::eval::Piece;
use glam::Vec3;

/// Domain of stored values.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum ValueDomain {
    /// One value for all curves.
    All,
    /// One value per curve.
    Curve,
    /// One value per point.
    Point,
}

impl ValueDomain {
    /// The smallest domain: `level` if values are constant along each curve, `alike` if all curves have the same.
    pub(super) fn fewest(level: bool, alike: bool) -> Self {
        match (level, alike) {
            (true, true) => Self::All,
            (true, false) => Self::Curve,
            (false, _) => Self::Point,
        }
    }
}

/// The tuft with values of `declared`. `own` is called once per curve for what all its points share; `value` for each
/// stored value, with curve, point of the tuft and fraction of the curve's length (0 if one value serves a curve).
pub(super) fn lay<T: Item, C>(
    piece: &mut Piece,
    tuft: &Tuft,
    declared: Declared<T>,
    held: ValueDomain,
    own: impl Fn(usize) -> C,
    value: impl Fn(&C, usize, usize, f32) -> T,
) -> Result<Tuft, NodeError> {
    let mut out = tuft.edit();
    if tuft.is_empty() {
        return Ok(out.build());
    }
    let mut values = Vec::with_capacity(match held {
        ValueDomain::All => 1,
        ValueDomain::Curve => tuft.len(),
        ValueDomain::Point => tuft.points().len(),
    });
    for i in 0..if held == ValueDomain::All { 1 } else { tuft.len() } {
        piece.tick()?;
        let own = own(i);
        let first = tuft.offsets()[i] as usize;
        if held == ValueDomain::Point {
            // Number of values of all earlier curves and of this one so far: the index of the point.
            fractions(tuft.curve(i), |u| values.push(value(&own, i, values.len(), u)));
        } else {
            values.push(value(&own, i, first, 0.0));
        }
    }
    let domain = if held == ValueDomain::Point { Domain::Point } else { Domain::Curve };
    out.set(declared, domain, values);
    Ok(out.build())
}

/// Calls `put` with the fraction of the length at each point of a curve, measured along straight segments.
#[inline]
fn fractions(points: &[Vec3], mut put: impl FnMut(f32)) {
    let span = |pair: &[Vec3]| pair[0].distance(pair[1]);
    let length: f32 = points.windows(2).map(span).sum();
    let scale = if length > 0.0 { 1.0 / length } else { 0.0 };
    let mut at = 0.0;
    if !points.is_empty() {
        put(0.0);
    }
    for pair in points.windows(2) {
        at += span(pair);
        put((at * scale).min(1.0));
    }
}
