//! Context of a stroke in the picture: the tips, hair and skin that identify its gesture, and what a touch would do.
//!
//! Guarantees: computed from the current curves and the gesture's own view, never from a window; whatever the head
//! hides does not count.

use super::classify::Around;
use super::hand::off_line;
use super::seen::Seen;
use crate::data::attributes::RADIUS;
use crate::data::curves::Curves;
use crate::data::gestures::{GestureView, Layer};
use crate::data::scalp::Scalp;
use crate::maths::closest::Hit;
use glam::{Vec2, Vec3};

/// Curves on a head, in a view.
pub struct ViewedCurves<'a> {
    seen: Seen,
    scalp: &'a Scalp,
    curves: &'a Curves,
    /// Reach of the pen, pixels.
    rho: f32,
}

/// A thin curve counts as this wide in the picture for crossing tests, pixels.
const THIN: f32 = 3.0;

impl<'a> ViewedCurves<'a> {
    /// Curves on a head in a view. `rho` is the reach of the pen in pixels.
    pub fn new(view: &GestureView, scalp: &'a Scalp, curves: &'a Curves, rho: f32) -> Self {
        Self { seen: Seen::new(view, scalp.frame()), scalp, curves, rho }
    }

    /// The view, in the head's space.
    pub fn seen(&self) -> &Seen {
        &self.seen
    }

    /// The skin under a pixel.
    pub fn skin(&self, at: Vec2) -> Option<Hit> {
        self.seen.head(self.scalp, at)
    }

    /// The curve whose tip is nearest to a pixel within the pen's reach, and the drawn position of its tip.
    pub fn end(&self, at: Vec2) -> Option<(u64, Vec2)> {
        let tips = self.curves.each().filter_map(|(tuft, i)| {
            let tip = *tuft.curve(i).last().filter(|_| tuft.curve(i).len() > 1)?;
            let drawn = self.seen.pixel(tip)?;
            let off = drawn.distance(at);
            (off <= self.rho && self.seen.sees(self.scalp, tip)).then_some((tuft.id(i), drawn, off))
        });
        tips.min_by(|a, b| a.2.total_cmp(&b.2)).map(|(id, drawn, _)| (id, drawn))
    }

    /// Whether there is hair within the pen's reach of a pixel.
    pub fn hair(&self, at: Vec2) -> bool {
        self.curves.each().any(|(tuft, i)| {
            tuft.curve(i).windows(2).any(|pair| {
                let Some([a, b]) = self.drawn(pair) else { return false };
                let off = off_line(&[a, b], at);
                let wide = self.width(tuft.view(RADIUS).at(i, 0), pair[0]);
                off <= self.rho.max(wide) && self.seen.sees(self.scalp, pair[1])
            })
        })
    }

    /// Whether a line from outside to outside crosses the hair of a curve.
    pub fn crosses(&self, from: Vec2, to: Vec2) -> bool {
        self.curves.each().any(|(tuft, i)| {
            let curve = tuft.curve(i);
            let crossed = curve.windows(2).find_map(|pair| {
                let [a, b] = self.drawn(pair)?;
                let t = crossing(from, to, a, b)?;
                let p = pair[0].lerp(pair[1], t);
                self.seen.sees(self.scalp, p).then_some((p, [a, b]))
            });
            crossed.is_some_and(|(p, piece)| {
                let wide = self.width(tuft.view(RADIUS).at(i, 0), p);
                off_line(&piece, from) > wide && off_line(&piece, to) > wide
            })
        })
    }

    /// The context of a stroke from one pixel to another.
    pub fn around(&self, from: Vec2, to: Vec2, eraser: bool, layer: Layer) -> Around {
        Around {
            eraser,
            layer,
            near_end: self.end(from).is_some(),
            starts_on_scalp: self.skin(from).is_some(),
            crosses: eraser && self.crosses(from, to),
        }
    }

    fn drawn(&self, pair: &[Vec3]) -> Option<[Vec2; 2]> {
        Some([self.seen.pixel(pair[0])?, self.seen.pixel(pair[1])?])
    }

    /// Drawn half-width of hair with a radius at a position, pixels.
    fn width(&self, radius: f32, at: Vec3) -> f32 {
        let wide = radius / self.seen.cm_per_pixel(self.seen.depth(at));
        if wide.is_finite() { wide.max(THIN) } else { THIN }
    }
}

/// Where a line crosses a segment of a curve, as a fraction of the segment.
fn crossing(from: Vec2, to: Vec2, a: Vec2, b: Vec2) -> Option<f32> {
    let (line, piece, off) = (to - from, b - a, from - a);
    let across = piece.perp_dot(line);
    if across == 0.0 {
        return None;
    }
    let t = off.perp_dot(line) / across;
    let s = off.perp_dot(piece) / across;
    ((0.0..=1.0).contains(&t) && (0.0..=1.0).contains(&s)).then_some(t)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::attributes::{Domain, ID};
    use crate::data::curves::TuftBuilder;
    use crate::data::gestures::{Tool, tests::gesture};
    use crate::data::scalp::tests::shared_ball;
    use std::sync::Arc;

    #[test]
    fn ends_hair_skin_and_crossings_are_told_where_the_head_does_not_hide_them() {
        // Down before the ball, 1 cm wide, its tip 3 cm under the middle; and the same behind it.
        let lock = |z: f32, id: u64| {
            let mut b = TuftBuilder::new();
            b.push_curve(&[
                Vec3::new(0.0, 8.0, z),
                Vec3::new(0.0, 2.0, z),
                Vec3::new(0.0, -3.0, z),
            ]);
            b.set(ID, Domain::Curve, vec![id]);
            b.set(RADIUS, Domain::Curve, vec![1.0]);
            Arc::new(b.build())
        };
        let ball = shared_ball();
        let view = gesture(1, Tool::Comb).view;
        let check = |curves: &Curves, seen: bool| {
            let ground = ViewedCurves::new(&view, &ball, curves, 30.0);
            let at = |x: f32, y: f32, z: f32| ground.seen().pixel(Vec3::new(x, y, z)).unwrap();
            let z = 12.0;
            let tip = at(0.0, -3.0, z);
            assert_eq!(ground.end(tip + Vec2::new(20.0, 0.0)).map(|end| end.0), seen.then_some(7));
            assert_eq!(ground.end(tip + Vec2::new(31.0, 0.0)), None);
            assert_eq!(ground.hair(at(0.5, 4.0, z)), seen);
            assert!(!ground.hair(at(5.0, 4.0, z)));
            assert!(ground.skin(at(3.0, 0.0, z)).is_some());
            assert!(ground.skin(at(30.0, 0.0, z)).is_none());
            assert_eq!(ground.crosses(at(-3.0, 1.0, z), at(3.0, 1.5, z)), seen);
            // It ends within the hair, or passes under its tip.
            assert!(!ground.crosses(at(-3.0, 1.0, z), at(0.5, 1.0, z)));
            assert!(!ground.crosses(at(-3.0, -5.0, z), at(3.0, -5.0, z)));
            let around = ground.around(tip, at(3.0, 0.0, z), false, Layer::Nearest);
            assert_eq!((around.near_end, around.starts_on_scalp), (seen, true));
        };
        check(&Curves::new(vec![lock(12.0, 7)]), true);
        check(&Curves::new(vec![lock(-12.0, 7)]), false);
        check(&Curves::default(), false);
    }
}
