//! Scalp projection: projects curves onto the surface.
//!
//! Guarantees: at full amount, every point of the curve, also between its CVs, lies within the tolerance of its offset
//! from the scalp (as far as 512 CVs allow); amount 0 moves nothing; roots are bound, and every point knows the scalp
//! normal. Not promised: a path around protrusions. The closest point jumps across a crease, such as the one behind the
//! ear; smoothing bridges that.

use super::lay::{bind, laid, scalp_normals};
use crate::data::attribute_transfer::carry;
use crate::data::attributes::{Domain, SCALP_NORMAL};
use crate::data::curves::{Curves, Tuft, TuftBuilder};
use crate::data::field::Sampler;
use crate::data::scalp::{Root, Scalp};
use crate::define::{FieldInput, NodeError, choice, node};
use crate::eval::{EvalCx, Piece};
use crate::maths::polyline::{self, Polyline};
use crate::maths::spline::{Spline, SplineParam};
use glam::Vec3;
use std::sync::Arc;

node! {
    /// Projects curves onto the scalp at an offset and binds their roots to it.
    ///
    /// Points are added until the curve follows the surface between its points too. Each curve gets a root and scalp
    /// normals, which braids and partings use.
    "scalp_projection", version 1, label "Scalp projection", words "project snap stick shrinkwrap attach bind root hair curves to surface ray", scales;
    inputs {
        /// Curves to project.
        curves: Curves;
        /// The head.
        scalp: Arc<Scalp>;
        /// How much of each curve is projected.
        what: What = What::Whole, words("root only attach");
        /// Height of the curves above the scalp; negative is below the skin. A ramp runs from root to tip.
        offset: FieldInput = 0.0, hard(-2.0, 20.0), soft(0.0, 2.0), unit(Length), handle(Handle::Length), words("height lift distance");
        /// Blend from the original curve (0) to the projected one (100%). A ramp runs from root to tip.
        amount: FieldInput = 1.0, hard(0.0, 1.0), unit(Ratio), words("blend mix strength");
        /// Length over which the projected curve is smoothed, where closest points jump or bunch up. 0 takes the
        /// closest points as they are.
        smoothing: f32 = 0.5, hard(0.0, 20.0), soft(0.0, 2.0), unit(Length), words("smooth relax");

        [Detail]
        /// Add points until the curve follows the scalp between them. Off keeps the point count.
        refine: bool = true, words("resample subdivide points");
        /// Largest distance between curve and scalp between two points.
        tolerance: f32 = 0.02, hard(0.0005, 10.0), soft(0.005, 0.2), unit(Length), words("precision error");
        /// Scale offset, smoothing and tolerance with the size of the head.
        scale_with_head: bool = true, words("head units");
    }
    outputs {
        /// The projected curves, with roots and scalp normals at every point.
        curves: Curves;
    }
}

choice! {
    /// How much of each curve is projected.
    What {
        /// The whole curve.
        Whole = "whole",
        /// The root only; the rest stays in place.
        Root = "root",
    }
}

/// The most CVs a curve is refined to.
const MOST_POINTS: usize = 512;
/// Spacing of the projected samples, cm on a head of average size.
const FINE: f32 = 0.1;

fn eval(cx: &EvalCx, inputs: Inputs) -> Result<Outputs, NodeError> {
    let [curves] = cx.each_tuft(&inputs.curves, |tuft, piece| {
        Ok([projected(cx.unit(), &inputs, tuft, piece)?])
    })?;
    Ok(Outputs { curves })
}

fn projected(
    unit: f32,
    inputs: &Inputs,
    tuft: &Tuft,
    piece: &mut Piece,
) -> Result<Tuft, NodeError> {
    let scalp = &*inputs.scalp;
    let offset = inputs.offset.on(tuft, Some(scalp))?;
    let amount = inputs.amount.on(tuft, Some(scalp))?;
    let mut out = TuftBuilder::new();
    let mut spline = Spline::default();
    let mut kept = vec![];
    let mut roots: Vec<Root> = vec![];
    let mut places: Vec<(u32, f32)> = vec![];
    let mut normals = vec![];
    for i in 0..tuft.len() {
        piece.tick()?;
        if let Err(fault) = spline.rebuild(tuft.curve(i)) {
            piece.trouble(tuft.id(i), fault);
            continue;
        }
        let wish =
            Wish { scalp, tuft, curve: i, spline: &spline, offset: &offset, amount: &amount, unit };
        let (points, us) = match inputs.what {
            What::Whole => wish.whole(inputs),
            What::Root => wish.root(),
        };
        let Some(root) = scalp.closest_root(points[0]) else {
            piece.trouble(tuft.id(i), "a curve that no scalp is near to was left out");
            continue;
        };
        kept.push(i as u32);
        roots.push(root);
        normals.extend(scalp_normals(scalp, &points));
        let first = tuft.offsets()[i];
        places.extend(us.iter().map(|place| (first + place.span as u32, place.t)));
        out.push_curve(&points);
    }
    carry(tuft, &kept, &places, &mut out);
    if !kept.is_empty() {
        out.set(SCALP_NORMAL, Domain::Point, normals);
        bind(&mut out, &roots);
    }
    Ok(out.build())
}

/// The requested position of a curve.
struct Wish<'a> {
    scalp: &'a Scalp,
    tuft: &'a Tuft,
    curve: usize,
    spline: &'a Spline,
    offset: &'a Sampler<'a>,
    amount: &'a Sampler<'a>,
    /// Centimetres per head unit.
    unit: f32,
}

impl Wish<'_> {
    /// A field's value at a position on the old curve, interpolated between its points.
    fn value(&self, field: &Sampler, place: SplineParam) -> f32 {
        let first = self.tuft.offsets()[self.curve] as usize;
        let (from, to) = (place.span, place.span + 1);
        let [a, b] = [from, to].map(|k| field.at(self.curve, first + k, self.spline.u_of_cv(k)));
        a + (b - a) * place.t
    }
    fn amount_at(&self, place: SplineParam) -> f32 {
        self.value(self.amount, place)
    }
    fn offset_at(&self, place: SplineParam) -> f32 {
        self.value(self.offset, place)
    }

    fn kept(&self) -> (Vec<Vec3>, Vec<SplineParam>) {
        let points = self.tuft.curve(self.curve).to_vec();
        let last = points.len() - 1;
        let place = |k: usize| match k {
            k if k == last => SplineParam { span: last - 1, t: 1.0 },
            k => SplineParam { span: k, t: 0.0 },
        };
        let places = (0..points.len()).map(place).collect();
        (points, places)
    }

    fn root(&self) -> (Vec<Vec3>, Vec<SplineParam>) {
        let (mut points, places) = self.kept();
        let to = laid(self.scalp, points[0], self.offset_at(places[0])).0;
        points[0] = points[0].lerp(to, self.amount_at(places[0]));
        (points, places)
    }

    fn whole(&self, inputs: &Inputs) -> (Vec<Vec3>, Vec<SplineParam>) {
        let (old, old_places) = self.kept();
        if old_places.iter().all(|place| self.amount_at(*place) == 0.0) {
            return (old, old_places);
        }
        let length = self.spline.length();
        let n = ((length / (FINE * self.unit)).ceil() as usize).clamp(16, polyline::MOST) + 1;
        let places: Vec<SplineParam> =
            (0..n).map(|k| self.spline.locate(k as f32 / (n - 1) as f32)).collect();
        let here: Vec<Vec3> = places.iter().map(|place| self.spline.point(*place)).collect();
        let mut on_scalp: Vec<Vec3> = here.iter().map(|p| laid(self.scalp, *p, 0.0).0).collect();
        let h = length / (n - 1) as f32;
        let sigma = inputs.smoothing / h;
        let rounds = (2.0 * sigma * sigma).round().clamp(0.0, 256.0) as usize;
        if rounds > 0 {
            polyline::filter(&mut on_scalp, rounds);
        }
        let line: Vec<Vec3> = (0..n)
            .map(|k| {
                let to = laid(self.scalp, on_scalp[k], self.offset_at(places[k])).0;
                here[k] + (to - here[k]) * self.amount_at(places[k])
            })
            .collect();
        let line = Polyline::new(line);
        if line.length() <= 0.0 {
            return (old, old_places);
        }
        // Leaves a margin for the error between samples.
        let tolerance = 0.8 * inputs.tolerance;
        let mut count = old.len();
        loop {
            let (points, at) = self.cut(&line, &places, count);
            if !inputs.refine || count >= MOST_POINTS {
                return (points, at);
            }
            // The law holds for the spline, so the spline is measured.
            let off = match Spline::new(&points) {
                Ok(spline) => self.worst(&spline, &line, &places),
                Err(_) => return (points, at),
            };
            if off <= tolerance {
                return (points, at);
            }
            // The error of a cubic decreases at least with the square of the spacing.
            let growth = (off / tolerance).sqrt().clamp(1.25, 3.0);
            count = ((count as f32 * growth).ceil() as usize).min(MOST_POINTS);
        }
    }

    /// `count` points evenly spaced along `line`, whose points correspond to `places` of the old curve.
    fn cut(
        &self,
        line: &Polyline,
        places: &[SplineParam],
        count: usize,
    ) -> (Vec<Vec3>, Vec<SplineParam>) {
        let step = line.length() / (count - 1) as f32;
        let at: Vec<SplineParam> =
            (0..count).map(|k| self.between(line, places, k as f32 * step)).collect();
        let mut points = line.evenly(count);
        for (p, place) in points.iter_mut().zip(&at) {
            if self.amount_at(*place) == 1.0 {
                *p = laid(self.scalp, *p, self.offset_at(*place)).0;
                // Once more from there: the closest point to a lifted point is below it.
                *p = laid(self.scalp, *p, self.offset_at(*place)).0;
            }
        }
        (points, at)
    }

    fn between(&self, line: &Polyline, places: &[SplineParam], s: f32) -> SplineParam {
        let (k, t) = line.place(s);
        let u = |place: SplineParam| {
            let [a, b] = [place.span, place.span + 1].map(|k| self.spline.u_of_cv(k));
            a + (b - a) * place.t
        };
        let next = places[(k + 1).min(places.len() - 1)];
        self.spline.locate(u(places[k]) + (u(next) - u(places[k])) * t)
    }

    /// The largest distance of `spline` from its requested position, in steps of a fifth of a span.
    fn worst(&self, spline: &Spline, line: &Polyline, places: &[SplineParam]) -> f32 {
        let mut worst = 0.0f32;
        for span in 0..spline.span_count() {
            for part in 1..5 {
                let place = SplineParam { span, t: part as f32 / 5.0 };
                let p = spline.point(place);
                let u0 = spline.u_of_cv(span);
                let u = u0 + (spline.u_of_cv(span + 1) - u0) * place.t;
                let from = self.between(line, places, u * line.length());
                let off = if self.amount_at(from) == 1.0 {
                    let Some(hit) = self.scalp.surface().closest(p) else { return 0.0 };
                    let d = self.scalp.surface().signed_distance(p, &hit);
                    (d - self.offset_at(from)).abs()
                } else {
                    let (k, _) = line.place(u * line.length());
                    let reach = (line.length() / spline.span_count() as f32).max(1e-6);
                    let per = line.length() / (line.points.len() - 1) as f32;
                    let around = (reach / per).ceil() as usize + 1;
                    let near = k.saturating_sub(around)..(k + around + 2).min(line.points.len());
                    let nearest = line.points[near]
                        .windows(2)
                        .map(|w| p.distance(crate::maths::nearest_on([w[0], w[1]], p).0));
                    nearest.fold(f32::MAX, f32::min)
                };
                worst = worst.max(off);
            }
        }
        worst
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::attributes::{ID, RADIUS, ROOT_BARY, ROOT_TRIANGLE};
    use crate::data::ramp::Ramp;
    use crate::data::scalp::{HeadFrame, REGION};
    use crate::define::Value;
    use crate::maths::closest::Surface;
    use crate::maths::hash::Dice;
    use crate::testing::{curves_of, run};

    fn on(surface: Surface) -> Arc<Scalp> {
        let region = vec![1.0; surface.points.len()];
        Arc::new(Scalp::new(
            surface,
            None,
            HeadFrame::IDENTITY,
            [(REGION.to_owned(), region)].into(),
        ))
    }

    fn bust() -> Arc<Scalp> {
        let mesh = crate::scalp::bust::adult();
        on(Surface::new(mesh.points, mesh.triangles))
    }

    /// Lines of a few points over the top of the head, up to 2 cm off it.
    fn coarse(n: u64) -> Curves {
        let dice = Dice::new(5, 0, "coarse");
        let mut b = TuftBuilder::new();
        for id in 0..n {
            let turn = |k: u64| {
                let (s, c) = crate::maths::transcendental::sin_cos_turns(dice.unit(id, 50 + k));
                let up = dice.range(id, 60 + k, 0.2, 1.0);
                let flat = (1.0 - up * up).max(0.0f32).sqrt();
                Vec3::new(s * flat, up, c * flat)
            };
            let (from, to) = (turn(0), turn(1));
            let count = 3 + dice.below(id, 9, 5) as u64;
            let points: Vec<Vec3> = (0..count)
                .map(|k| {
                    let t = k as f32 / (count - 1) as f32;
                    let way = (from * (1.0 - t) + to * t).normalize_or(Vec3::Y);
                    way * (9.5 + dice.signed(id, k) * 1.5)
                })
                .collect();
            b.push_curve(&points);
        }
        b.set(ID, Domain::Curve, (1..=n).collect());
        Curves::new(vec![b.build().into()])
    }

    fn laid_on(scalp: &Arc<Scalp>, curves: &Curves, set: &[(&str, Value)]) -> Curves {
        let fixed = [("curves", curves.clone().into()), ("scalp", scalp.clone().into())];
        let (out, said) = run(&NODE, &[&fixed, set].concat());
        assert!(said.is_empty(), "{said:?}");
        curves_of(&out[0]).clone()
    }

    fn off(scalp: &Scalp, p: Vec3, offset: f32) -> f32 {
        let hit = scalp.surface().closest(p).unwrap();
        (scalp.surface().signed_distance(p, &hit) - offset).abs()
    }

    #[test]
    fn coarse_lines_lie_on_the_surface_between_their_points_too() {
        let (scalp, lines) = (bust(), coarse(60));
        for offset in [0.0, 0.3] {
            let curves = laid_on(&scalp, &lines, &[("offset", Value::Float(offset))]);
            assert_eq!(curves.curve_count(), 60);
            let mut worst = 0.0f32;
            for (tuft, i) in curves.each() {
                let spline = Spline::new(tuft.curve(i)).unwrap();
                for k in 0..=300 {
                    worst = worst.max(off(&scalp, spline.at(k as f32 / 300.0), offset));
                }
                for w in tuft.curve(i).windows(3) {
                    let ratio = w[0].distance(w[1]) / w[1].distance(w[2]);
                    assert!((0.8..1.25).contains(&ratio), "{ratio}");
                }
            }
            println!("offset {offset}: worst {worst} cm, {} points", curves.point_count());
            assert!(worst < 0.02, "offset {offset}: {worst}");
        }
    }

    #[test]
    fn no_amount_changes_nothing_but_binds() {
        let (scalp, lines) = (bust(), coarse(20));
        let curves = laid_on(&scalp, &lines, &[("amount", Value::Float(0.0))]);
        assert_eq!(curves.tufts()[0].points(), lines.tufts()[0].points());
        assert_eq!(curves.tufts()[0].offsets(), lines.tufts()[0].offsets());
        assert!(curves.tufts()[0].view(ROOT_TRIANGLE).at(0, 0) >= 0);
        // Half an amount is halfway between.
        let half = laid_on(
            &scalp,
            &lines,
            &[("amount", Value::Float(0.5)), ("refine", Value::Bool(false))],
        );
        assert_eq!(half.point_count(), lines.point_count());
        for (tuft, i) in half.each() {
            let before = off(&scalp, lines.tufts()[0].curve(i)[0], 0.0);
            let after = off(&scalp, tuft.curve(i)[0], 0.0);
            assert!((after - 0.5 * before).abs() < 0.02 + 0.05 * before, "{i}: {before} {after}");
        }
    }

    #[test]
    fn roots_are_bound_where_they_are_and_attributes_come_along() {
        let (scalp, lines) = (bust(), coarse(20));
        let mut edit = lines.tufts()[0].edit();
        let radii = (0..lines.point_count()).map(|k| k as f32).collect();
        edit.set(RADIUS, Domain::Point, radii);
        let lines = Curves::new(vec![edit.build().into()]);
        let curves = laid_on(&scalp, &lines, &[]);
        let tuft = &curves.tufts()[0];
        for i in 0..tuft.len() {
            let range = tuft.range(i);
            let triangle = tuft.view(ROOT_TRIANGLE).at(i, range.start);
            let root = scalp.root(triangle as u32, tuft.view(ROOT_BARY).at(i, range.start));
            assert!(root.point.distance(tuft.curve(i)[0]) < 1e-3);
            assert_eq!(tuft.id(i), i as u64 + 1);
            let old = lines.tufts()[0].range(i);
            let radius = tuft.view(RADIUS);
            assert_eq!(radius.at(i, range.start), old.start as f32);
            assert!((radius.at(i, range.end - 1) - (old.end - 1) as f32).abs() < 1e-3);
            for p in range {
                assert!((tuft.view(SCALP_NORMAL).at(i, p).length() - 1.0).abs() < 1e-4);
            }
        }
    }

    #[test]
    fn the_root_alone_can_be_pulled_and_an_offset_can_run_along() {
        let (scalp, lines) = (bust(), coarse(20));
        let curves = laid_on(&scalp, &lines, &[("what", "root".into())]);
        for (tuft, i) in curves.each() {
            let old = lines.tufts()[0].curve(i);
            assert_eq!(tuft.curve(i)[1..], old[1..]);
            assert!(off(&scalp, tuft.curve(i)[0], 0.0) < 1e-4);
        }
        let ramp = Value::Ramp(Arc::new(Ramp::linear(0.0, 2.0)));
        let curves = laid_on(&scalp, &lines, &[("offset", ramp)]);
        for (tuft, i) in curves.each() {
            let points = tuft.curve(i);
            assert!(off(&scalp, points[0], 0.0) < 1e-3);
            let tip = points[points.len() - 1];
            assert!(off(&scalp, tip, 2.0) < 0.05, "{}", off(&scalp, tip, 2.0));
        }
    }

    #[test]
    fn what_is_no_curve_is_left_out_and_named() {
        let mut b = TuftBuilder::new();
        b.push_curve(&[Vec3::Y * 9.0; 3]);
        b.push_curve(&[Vec3::Y * 9.0, Vec3::NAN]);
        b.push_curve(&[Vec3::ZERO, Vec3::Y * 9.0]);
        b.set(ID, Domain::Curve, vec![1, 2, 3]);
        let curves = Curves::new(vec![b.build().into()]);
        let (out, said) = run(&NODE, &[("curves", curves.into()), ("scalp", bust().into())]);
        assert_eq!(curves_of(&out[0]).curve_count(), 1);
        assert_eq!(said.len(), 2, "{said:?}");
        assert!(curves_of(&out[0]).tufts()[0].points().iter().all(|p| p.is_finite()));
    }
}
