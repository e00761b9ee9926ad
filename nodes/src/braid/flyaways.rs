//! Flyaways: short hairs that leave a braid.
//!
//! Guarantees: each has its random length, from a third of the longest to all of it; a higher number only adds; with a
//! known skin, none lies in it; it looks like its strand where it leaves it. Not promised: that they stay clear of the braid.

use crate::data::attribute_transfer::{Lineage, own_parents, place_of};
use crate::data::attributes::{self as attr, Domain};
use crate::data::curves::{Tuft, TuftBuilder};
use crate::data::route::makers::lift;
use crate::data::scalp::Skin;
use crate::define::NodeError;
use crate::eval::Piece;
use crate::maths::frame;
use crate::maths::hash::{Dice, curve_id};
use crate::maths::spline::Spline;
use glam::Vec3;

/// CVs of a flyaway.
const CVS: usize = 8;

/// A braid strand as input for flyaways.
pub(crate) struct FlyawayStrand<'a> {
    pub(crate) spline: &'a Spline,
    pub(crate) radii: &'a [f32],
    /// Centre of the braid at each CV.
    pub(crate) centres: Vec<Vec3>,
    /// The strand itself.
    pub(crate) hair: (&'a Tuft, usize),
}

/// `count` hairs of up to `longest` cm on the strands of one braid, kept out of the skin. A higher count only adds.
pub(crate) fn flyaways(
    strands: &[FlyawayStrand],
    (braid, tag): (u64, u64),
    count: usize,
    longest: f32,
    skin: Option<&Skin>,
    dice: Dice,
    piece: &mut Piece,
) -> Result<Tuft, NodeError> {
    let mut out = TuftBuilder::new();
    let (mut ids, mut parents, mut leaves) = (vec![], vec![], vec![]);
    for index in 0..count as u64 {
        piece.tick()?;
        let id = curve_id(braid, tag, (1 << 33) + index);
        let strand = &strands[dice.below(id, 0, strands.len() as u32) as usize];
        let u = dice.unit(id, 1);
        let place = strand.spline.locate(u);
        let (p, tangent) = (strand.spline.point(place), strand.spline.tangent(place));
        let away = frame::across(p - strand.centres[place.span], tangent)
            .unwrap_or_else(|| frame::any_normal(tangent));
        let frame = frame::Frame { tangent, normal: away }.rolled(1.2 * dice.signed(id, 2));
        let length = longest * dice.range(id, 3, 1.0 / 3.0, 1.0);
        // Runs along the strand at first, then springs away and bends to one side.
        let (lift, bend) = (dice.range(id, 4, 0.25, 0.9), 0.5 * dice.signed(id, 5));
        let from = p + frame.normal * (0.9 * strand.radii[place.span]);
        let way = |k: usize| {
            let t = k as f32 / (CVS - 1) as f32;
            let across = frame.normal * lift + frame.binormal() * bend;
            tangent * (t * (1.0 - 0.3 * t)) + across * (t * t)
        };
        let whole: f32 = (1..CVS).map(|k| way(k).distance(way(k - 1))).sum();
        let mut points = vec![from];
        for k in 1..CVS {
            let step = (way(k) - way(k - 1)) * (length / whole);
            points.push(out_of(skin, points[k - 1], step));
        }
        out.push_curve(&points);
        ids.push(id);
        parents.push(strand.hair.0.id(strand.hair.1));
        leaves.push((strand.hair, place_of(place)));
    }
    if !ids.is_empty() {
        out.set(attr::ID, Domain::Curve, ids);
        out.set(attr::PARENT, Domain::Curve, parents);
        out.set(attr::BRAID, Domain::Curve, vec![braid]);
    }
    let own = own_parents(leaves.len());
    let lineage = Lineage {
        parent: &|hair| leaves[hair as usize].0,
        of: &|hair| &own[hair],
        // As it is where it leaves the strand.
        places: &|hair| vec![leaves[hair as usize].1],
        takes: &attr::is_look,
    };
    lineage.pass_on(&mut out);
    Ok(out.build())
}

/// End point of a step, turned along the skin if that is in the way.
fn out_of(skin: Option<&Skin>, from: Vec3, step: Vec3) -> Vec3 {
    let far = step.length();
    let Some(skin) = skin else { return from + step };
    // Short enough that no step ends deeper than the distance field covers.
    let parts = (far / 0.4).ceil().clamp(1.0, 128.0);
    let to = (0..parts as usize).fold(from, |at, _| lift(skin, at + step / parts, 0.0).0);
    let turned = from + (to - from).normalize_or_zero() * far;
    lift(skin, turned, 0.0).0
}
