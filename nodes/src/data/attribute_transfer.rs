//! Attributes of hair that gets other points: the one law by which they are carried over.
//!
//! Guarantees: values of curves stay with their curve; values of points are interpolated where they are numbers or vectors, and
//! taken from the point before where they are ids or counts; what is stored once for all stays so; a `fibre_length` goes with the
//! share of a hair that is left.

use crate::data::attributes::{Attribute, Column, Domain, FIBRE};
use crate::data::curves::{Tuft, TuftBuilder};

/// Gives `out` the attributes of `tuft`: its curves are those of the numbers `kept`, and for each of its points `places` says which
/// old point is before it and what fraction of the way to the next it is off.
pub(crate) fn carry(tuft: &Tuft, kept: &[u32], places: &[(u32, f32)], out: &mut TuftBuilder) {
    for attribute in tuft.attributes() {
        let values = match attribute.domain {
            Domain::Curve => attribute.values.gather(kept),
            Domain::Point => between(&attribute.values, places),
        };
        out.set_column(Attribute { values, ..attribute.clone() });
    }
}

/// The same for hair of which such shares of its length are left, or were added.
pub(crate) fn carry_shares(
    tuft: &Tuft,
    kept: &[u32],
    places: &[(u32, f32)],
    shares: &[f32],
    out: &mut TuftBuilder,
) {
    carry(tuft, kept, places, out);
    let fibre = tuft.view(FIBRE);
    let of = |(i, share): (&u32, &f32)| {
        fibre.at(*i as usize, tuft.offsets()[*i as usize] as usize) * share
    };
    if tuft.attribute(FIBRE.name).is_some() {
        out.set(FIBRE, Domain::Curve, kept.iter().zip(shares).map(of).collect());
    }
}

/// Values between old points: numbers and vectors are interpolated, ids and counts taken from before.
pub(crate) fn between(column: &Column, places: &[(u32, f32)]) -> Column {
    macro_rules! lerp {
        ($variant:ident, $values:expr) => {
            Column::$variant(std::sync::Arc::new(
                places
                    .iter()
                    .map(|(i, t)| {
                        let (a, b) = ($values[*i as usize], $values[*i as usize + 1]);
                        a + (b - a) * *t
                    })
                    .collect(),
            ))
        };
    }
    match column {
        one if one.len() == 1 => one.clone(),
        Column::F32(v) => lerp!(F32, v),
        Column::Vec2(v) => lerp!(Vec2, v),
        Column::Vec3(v) => lerp!(Vec3, v),
        other => other.gather(&places.iter().map(|(i, _)| *i).collect::<Vec<_>>()),
    }
}
