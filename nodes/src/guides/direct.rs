//! Directions over the skin, blended from drawn strokes: the flow of fur, drawn instead of chosen.
//!
//! Guarantees: beside a stroke hair lies along it; between strokes it turns from one to the other; strokes on the other side
//! of something thin, such as an ear, count little. The order of strokes does not matter but for rounding.

use crate::data::curves::Curves;
use crate::data::scalp::Scalp;
use crate::maths::frame::{across, smallest_rotation};
use crate::maths::nearest::KdTree;
use glam::Vec3;

/// Spacing of the places at which strokes are read, head units, and the most in one segment.
const SPACING: f32 = 0.5;
const MOST: f32 = 64.0;
/// The places that are blended.
const NEAREST: usize = 32;
/// Within this distance of a stroke hair lies along it, head units.
const BESIDE: f32 = 0.3;

/// Strokes as directions.
pub(super) struct Directions {
    tree: KdTree,
    /// Tangent and normal of the skin, one a place. Unit.
    ways: Vec<(Vec3, Vec3)>,
    beside: f32,
}

impl Directions {
    /// Of strokes on this scalp; `None` if none of them leads anywhere.
    pub(super) fn of(strokes: &Curves, scalp: &Scalp) -> Option<Self> {
        let unit = scalp.frame().unit();
        let (mut places, mut ways) = (vec![], vec![]);
        for (tuft, i) in strokes.each() {
            for pair in tuft.curve(i).windows(2) {
                let way = pair[1] - pair[0];
                let Some(tangent) = way.try_normalize() else { continue };
                let pieces = (way.length() / (SPACING * unit)).ceil().clamp(1.0, MOST);
                for k in 0..pieces as u32 {
                    let place = pair[0] + way * ((k as f32 + 0.5) / pieces);
                    let Some(root) = scalp.closest_root(place) else { continue };
                    let Some(tangent) = across(tangent, root.normal) else { continue };
                    places.push(place);
                    ways.push((tangent, root.normal));
                }
            }
        }
        let beside = BESIDE * unit;
        (!places.is_empty()).then(|| Self { tree: KdTree::new(places), ways, beside })
    }

    /// The direction at a place of the skin, not normalized; `None` where strokes cancel each other out.
    pub(super) fn at(&self, p: Vec3, normal: Vec3, near: &mut Vec<(f32, u32)>) -> Option<Vec3> {
        self.tree.find(p, NEAREST, near);
        let mut sum = Vec3::ZERO;
        for (square, i) in near.iter() {
            let (tangent, own) = self.ways[*i as usize];
            let facing = (0.5 + 0.5 * own.dot(normal)).max(0.01);
            let near = self.beside * self.beside / (square + self.beside * self.beside);
            sum += smallest_rotation(own, normal) * tangent * (near * near * facing * facing);
        }
        sum.try_normalize()
    }
}
