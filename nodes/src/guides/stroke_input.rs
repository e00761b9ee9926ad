//! Stroke input: pen strokes of the document as curves on a head.
//!
//! Strokes are stored in the head frame and in head units, so they transfer to another head. Each stroke makes one
//! tuft, keyed by the stroke: drawing one more makes one more.
//!
//! Guarantees: every curve is bound to the scalp where it starts; projected curves keep their offset from the scalp at
//! every CV, or lie higher where they would cut through folds between CVs; free ones never run below the skin. A stroke
//! without length is dropped and named in a message.

use crate::data::attributes::{DRIFT, Domain, ID, PRESSURE, RADIUS, SCALP_NORMAL};
use crate::data::curves::{Curves, Tuft, TuftBuilder};
use crate::data::route::makers::lift;
use crate::data::scalp::{Root, Scalp, Skin};
use crate::data::strokes::{Stroke, Strokes};
use crate::define::{FieldInput, NodeError, choice, node};
use crate::eval::{EvalCx, Piece, Size};
use crate::maths::hash::{KeyBuilder, curve_id};
use crate::maths::polyline::{self, Polyline};
use crate::maths::spline::{Spline, SplineParam};
use crate::scalp::lay;
use glam::Vec3;
use std::sync::Arc;

node! {
    /// Curves drawn with the pen: braid rows, partings, guides or centre curves of clusters.
    ///
    /// Draw them on the head in the viewport. Strokes are projected onto the scalp, or kept as drawn in space with the
    /// root on the scalp.
    "stroke_input", version 1, label "Stroke input", words "draw pen pencil sketch stylus curve guide row parting line tablet", scales;
    inputs {
        /// The strokes, root first. Draw them in the viewport; they are stored in the head frame.
        strokes: Arc<Strokes> = Strokes::default(), words("drawn pen");
        /// The head that the strokes are drawn on.
        scalp: Arc<Scalp>;
        /// Radius of the cluster or braid around the curve. A ramp runs from root to tip.
        radius: FieldInput = 1.0, hard(0.001, 100.0), soft(0.05, 3.0), unit(Length), handle(Handle::Radius), words("width size thickness");
        /// How much pen pressure scales the radius: at 0 it has no effect, at 100% the radius goes from zero at no
        /// pressure to full at full pressure.
        pressure_radius: f32 = 0.0, hard(0.0, 1.0), unit(Ratio), words("pen pressure width");
        /// Mirror strokes to the other side of the head.
        mirror: Mirror = Mirror::None, words("symmetry symmetrise flip x");

        [Placement]
        /// Keep strokes on the scalp, or free in space.
        project: Project = Project::Scalp, words("surface snap stick");
        /// Height of projected strokes above the scalp; negative is below the skin. A ramp runs from root to tip.
        offset: FieldInput = 0.0, hard(-2.0, 20.0), soft(0.0, 2.0), unit(Length), handle(Handle::Length), words("height lift");

        [Detail]
        /// Length over which the drawn line is smoothed, to remove hand tremor. 0 keeps it as drawn.
        smoothing: f32 = 0.3, hard(0.0, 20.0), soft(0.0, 2.0), unit(Length), words("smooth stabilise jitter");
        /// Distance between CVs. Each curve gets the count that comes closest.
        spacing: f32 = 0.5, hard(0.01, 100.0), soft(0.1, 2.0), unit(Length), words("resample resolution points cvs");
        /// Scale lengths with the size of the head. Strokes always scale.
        scale_with_head: bool = true, words("head units");
        /// Random seed for this node. It changes ids too.
        seed: i64 = 0;
    }
    outputs {
        /// One curve per stroke and per mirror image, in drawing order, with radius, pressure, root, scalp normals and
        /// drift (how far the root moved to lie on this head).
        curves: Curves;
    }
}

choice! {
    /// Keep strokes on the scalp, or free in space.
    Project {
        /// Projects every point to the closest point of the scalp.
        Scalp = "scalp",
        /// As drawn: the root snaps to the scalp, and points below the skin are pushed out.
        Free = "free",
    }
}

choice! {
    /// Mirror strokes to the other side of the head.
    Mirror {
        /// Each stroke once.
        None = "none",
        /// Each stroke and its mirror image, except strokes on the midline.
        Both = "both",
    }
}

/// A stroke within this distance of the midline (head units) is its own mirror image.
const MIDLINE: f32 = 0.1;

fn eval(cx: &EvalCx, inputs: Inputs) -> Result<Outputs, NodeError> {
    let skin = cx.skin(&inputs.scalp);
    let mut drawn: Vec<(&Stroke, bool)> = vec![];
    for stroke in &inputs.strokes.0 {
        drawn.push((stroke, false));
        let off_midline = stroke.samples.iter().any(|s| s.position.x.abs() > MIDLINE);
        if inputs.mirror == Mirror::Both && off_midline {
            drawn.push((stroke, true));
        }
    }
    let key = |i: usize| {
        let (stroke, mirrored) = drawn[i];
        KeyBuilder::new("drawn").key(stroke.key()).int(u64::from(mirrored)).finish()
    };
    let samples: usize = drawn.iter().map(|(stroke, _)| stroke.samples.len()).sum();
    let size = Size::of(&[("samples of strokes", samples as f64)]);
    let [curves] = cx.each_item(drawn.len(), &size, key, |i, piece| {
        let (stroke, mirrored) = drawn[i];
        Ok([drawn_curve(&inputs, stroke, mirrored, (&skin, cx.unit()), piece)?])
    })?;
    Ok(Outputs { curves })
}

/// The tuft of one stroke: one curve, or none if it has no length.
fn drawn_curve(
    inputs: &Inputs,
    stroke: &Stroke,
    mirrored: bool,
    (skin, unit): (&Skin, f32),
    piece: &mut Piece,
) -> Result<Tuft, NodeError> {
    piece.tick()?;
    let scalp = &*inputs.scalp;
    let id = curve_id(stroke.id, inputs.seed as u64, u64::from(mirrored));
    let side = if mirrored { Vec3::new(-1.0, 1.0, 1.0) } else { Vec3::ONE };
    let (mut points, mut pressures): (Vec<Vec3>, Vec<f32>) = (vec![], vec![]);
    for sample in &stroke.samples {
        let p = scalp.place(sample.position * side);
        if p.is_finite() && points.last().is_none_or(|last| last.distance(p) > NEAR) {
            points.push(p);
            pressures.push(sample.pressure.clamp(0.0, 1.0));
        }
    }
    if points.len() < 2 {
        piece.trouble(stroke.id, "a stroke without length was left out");
        return Ok(TuftBuilder::new().build());
    }
    let drawn = points[0];
    let hand = Polyline::new(points);
    let pressure_at = |part: f32| {
        let (i, t) = hand.place(part * hand.length());
        pressures[i] + (pressures[(i + 1).min(pressures.len() - 1)] - pressures[i]) * t
    };
    let smooth = hand.smoothed(inputs.smoothing);
    let spacing = inputs.spacing;
    let fine = ((smooth.length() / (0.25 * spacing)).ceil() as usize).clamp(8, polyline::MOST);
    let mut line = smooth.evenly(fine + 1);
    let met =
        |p: Vec3| lay::met(scalp, p).map_or((p, Vec3::ZERO), |root| (root.point, root.normal));
    match inputs.project {
        Project::Scalp => {
            for _ in 0..ROUNDS {
                let before = line.clone();
                line.iter_mut().for_each(|p| *p = met(*p).0);
                if !torn(&before, &line) {
                    break;
                }
                line = Polyline::new(line).smoothed(MENDED * unit).evenly(fine + 1);
            }
        }
        Project::Free => {
            let start = met(line[0]).0;
            if start.distance(line[0]) > NEAR {
                line.insert(0, start);
            } else {
                line[0] = start;
            }
        }
    }
    line.dedup_by(|a, b| a.distance(*b) <= NEAR);
    let Ok(spline) = Spline::new(&line) else {
        piece.trouble(stroke.id, "a stroke that the scalp has no room for was left out");
        return Ok(TuftBuilder::new().build());
    };
    let n = ((spline.length() / spacing).round() as usize).clamp(2, polyline::MOST - 1) + 1;
    let mut points = Vec::with_capacity(n);
    spline.resample(n, |p| points.push(p));
    let mut normals = vec![Vec3::ZERO; n];
    for (k, (p, normal)) in points.iter_mut().zip(&mut normals).enumerate() {
        if inputs.project == Project::Free && k > 0 {
            *p = lift(skin, *p, 0.0).0;
            *normal = lay::laid(scalp, *p, 0.0).1;
        } else {
            (*p, *normal) = met(*p);
        }
    }
    let root: Option<Root> = scalp.closest_root(points[0]);
    let part = |k: usize| k as f32 / (n - 1) as f32;
    let pressure: Vec<f32> = (0..n).map(|k| pressure_at(part(k))).collect();
    let mut tuft = TuftBuilder::new();
    tuft.push_curve(&points);
    tuft.set(ID, Domain::Curve, vec![id]);
    tuft.set(SCALP_NORMAL, Domain::Point, normals.clone());
    tuft.set(PRESSURE, Domain::Point, pressure.clone());
    lay::bind(&mut tuft, root.as_slice());
    if let Some(root) = &root {
        tuft.set(DRIFT, Domain::Curve, vec![root.point.distance(drawn)]);
    }
    let bound = tuft.build();
    let radius = inputs.radius.on(&bound, Some(scalp))?;
    let offset = inputs.offset.on(&bound, Some(scalp))?;
    let by_pressure = |k: usize| 1.0 + inputs.pressure_radius * (pressure[k] - 1.0);
    let radii = (0..n).map(|k| radius.at(0, k, part(k)) * by_pressure(k)).collect();
    if inputs.project == Project::Scalp {
        over_folds(&mut points, &normals, skin, scalp.frame().radius);
        for (k, p) in points.iter_mut().enumerate() {
            *p += normals[k] * offset.at(0, k, part(k));
        }
    }
    let mut tuft = TuftBuilder::even(points, n);
    bound.attributes().iter().for_each(|attribute| tuft.set_column(attribute.clone()));
    tuft.set(RADIUS, Domain::Point, radii);
    Ok(tuft.build())
}

/// Whether adjacent points are now far apart: on rough skin, closest points jump from ridge to ridge.
fn torn(before: &[Vec3], after: &[Vec3]) -> bool {
    let step = |line: &[Vec3], k: usize| line[k].distance(line[k + 1]);
    (0..before.len() - 1).any(|k| step(after, k) > 2.0 * step(before, k) + FOLD)
}

/// The most projections before a line is accepted.
const ROUNDS: usize = 4;
/// Smoothing length of a torn line between projections, cm on a head of average size.
const MENDED: f32 = 0.5;

/// Lifts CVs between which a curve cuts through folds of the skin, until it lies over them; the root stays. A smooth
/// head bends by a few thousandths of a centimetre between CVs, and nothing is lifted.
fn over_folds(points: &mut [Vec3], normals: &[Vec3], skin: &Skin, radius: f32) {
    let last = points.len() - 1;
    let chord: Vec<f32> =
        points.windows(2).map(|w| SAGS * w[0].distance_squared(w[1]) / radius).collect();
    let out = |k: usize| {
        let about = &normals[k.saturating_sub(2)..(k + 3).min(last + 1)];
        about.iter().sum::<Vec3>().try_normalize().unwrap_or(normals[k])
    };
    let mut lifted = vec![0.0f32; last + 1];
    for _ in 0..LIFTS {
        let Ok(spline) = Spline::new(points) else { return };
        let mut lifts = vec![0.0f32; last + 1];
        for span in 0..last {
            for t in [0.25, 0.5, 0.75] {
                let depth = -skin.distance(spline.point(SplineParam { span, t }));
                if depth > FOLD + chord[span] {
                    lifts[span] = lifts[span].max(depth);
                    lifts[span + 1] = lifts[span + 1].max(depth);
                }
            }
        }
        if lifts.iter().all(|lift| *lift == 0.0) {
            return;
        }
        for k in 1..=last {
            let lift = lifts[k].min(HIGHEST - lifted[k]);
            points[k] += out(k) * lift;
            lifted[k] += lift;
        }
    }
}

/// Points closer than this (cm) coincide.
const NEAR: f32 = 1e-4;
/// Projected curves cut through the skin between their CVs by at most this, cm.
const FOLD: f32 = 0.02;
/// Plus the sag of a spline's end span into a ball: this times its squared chord over the ball's radius.
const SAGS: f32 = 0.1;
/// Rounds of lifting CVs.
const LIFTS: usize = 6;
/// The most that CVs are lifted, cm: anything higher is not a fold.
const HIGHEST: f32 = 0.5;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::attributes::{ROOT_BARY, ROOT_TRIANGLE};
    use crate::data::ramp::Ramp;
    use crate::data::scalp::{HEAD_RADIUS, HeadFrame, REGION};
    use crate::data::strokes::Sample;
    use crate::define::Value;
    use crate::eval::{Log, Quality};
    use crate::maths::closest::Surface;
    use crate::maths::closest::tests::sphere;
    use crate::maths::transcendental::{atan2, sin};
    use crate::testing::{Memory, curves_of, run, run_on};
    use std::sync::atomic::Ordering;

    fn ball(radius: f32) -> Arc<Scalp> {
        let surface = sphere(radius, 64);
        let region = vec![1.0; surface.points.len()];
        let frame = HeadFrame { radius, ..HeadFrame::IDENTITY };
        Arc::new(Scalp::new(surface, None, frame, [(REGION.to_owned(), region)].into()))
    }

    /// A line from the forehead backward, `x` off the midline, 1 cm over a head of average size.
    fn back(id: u64, x: f32) -> Stroke {
        let samples = (0..=30)
            .map(|k| {
                let (s, c) =
                    crate::maths::transcendental::sin_cos_turns(k as f32 / 30.0 * 0.4 - 0.1);
                let position = Vec3::new(x, c * 9.9, -s * 9.9);
                let (pressure, time) = (k as f32 / 30.0, k as f32 * 0.01);
                Sample { position, pressure, time, ..Sample::default() }
            })
            .collect();
        Stroke::new(id, samples)
    }

    #[test]
    fn what_the_skin_tears_apart_is_told_from_what_only_bends() {
        let line: Vec<Vec3> = (0..40).map(|k| Vec3::X * (0.1 * k as f32)).collect();
        let bent: Vec<Vec3> = line.iter().map(|p| *p + Vec3::Y * (0.05 * p.x * p.x)).collect();
        assert!(!torn(&line, &bent));
        let mut leaps = bent.clone();
        leaps[20..].iter_mut().for_each(|p| *p += Vec3::Z * 0.4);
        assert!(torn(&line, &leaps));
    }

    #[test]
    fn few_cvs_on_a_smooth_head_are_not_lifted_off_it() {
        let scalp = ball(HEAD_RADIUS);
        for spacing in [0.5f32, 2.0, 4.0] {
            let curves = drawn(&scalp, vec![back(7, 2.0)], &[("spacing", spacing.into())]);
            for p in curves.tufts()[0].curve(0) {
                let off = scalp.surface().closest(*p).unwrap().distance;
                assert!(off < 1e-3, "{off} at spacing {spacing}");
            }
        }
    }

    fn drawn(scalp: &Arc<Scalp>, strokes: Vec<Stroke>, set: &[(&str, Value)]) -> Curves {
        let fixed = [("scalp", scalp.clone().into()), ("strokes", Strokes(strokes).into())];
        let (out, said) = run(&NODE, &[&fixed, set].concat());
        assert!(said.iter().all(|s| s.starts_with("lengths are ")), "{said:?}");
        curves_of(&out[0]).clone()
    }

    #[test]
    fn projected_strokes_lie_at_their_offset_on_any_head() {
        for (radius, unit) in [(HEAD_RADIUS, 1.0), (2.0 * HEAD_RADIUS, 2.0)] {
            let scalp = ball(radius);
            let set = [("offset", Value::Float(0.4)), ("spacing", Value::Float(0.5))];
            let curves = drawn(&scalp, vec![back(7, 2.0)], &set);
            let tuft = &curves.tufts()[0];
            let spline = Spline::new(tuft.curve(0)).unwrap();
            for k in 0..=200 {
                let p = spline.at(k as f32 / 200.0);
                let hit = scalp.surface().closest(p).unwrap();
                let d = scalp.surface().signed_distance(p, &hit);
                assert!((d - 0.4 * unit).abs() < 0.01 * unit, "{k}: {d}");
            }
            for w in tuft.curve(0).windows(3) {
                let ratio = w[0].distance(w[1]) / w[1].distance(w[2]);
                assert!((0.84..1.19).contains(&ratio), "{ratio}");
            }
            let step = tuft.curve(0)[0].distance(tuft.curve(0)[1]);
            assert!((step - 0.5 * unit).abs() < 0.05 * unit, "{step}");
            // It was drawn 1 cm over a head of average size, starting 2 cm beside the midline.
            let drift = tuft.view(DRIFT).at(0, 0) / unit;
            assert!((drift - (1.0 + 0.2)).abs() < 0.05, "{drift}");
            // The binding is the scalp point under the first CV.
            let triangle = tuft.view(ROOT_TRIANGLE).at(0, 0);
            let root = scalp.root(triangle as u32, tuft.view(ROOT_BARY).at(0, 0));
            assert!((root.point.distance(tuft.curve(0)[0]) - 0.4 * unit).abs() < 1e-3);
            assert!((tuft.view(SCALP_NORMAL).at(0, 3).length() - 1.0).abs() < 1e-5);
        }
    }

    #[test]
    fn projected_strokes_lie_over_folds_of_the_skin() {
        let mut rough = sphere(HEAD_RADIUS, 64);
        for p in &mut rough.points {
            let fold = sin(20.0 * atan2(p.z, p.y));
            *p *= 1.0 + 0.02 * fold;
        }
        let surface = Surface::new(rough.points, rough.triangles);
        let region = vec![1.0; surface.points.len()];
        let frame = HeadFrame::IDENTITY;
        let scalp =
            Arc::new(Scalp::new(surface, None, frame, [(REGION.to_owned(), region)].into()));
        let curves = drawn(&scalp, vec![back(1, 0.3)], &[("spacing", 0.7.into())]);
        let points = curves.tufts()[0].curve(0);
        let spline = Spline::new(points).unwrap();
        let skin = scalp.skin();
        let deepest = (1..points.len() - 1)
            .flat_map(|span| [0.25, 0.5, 0.75].map(|t| spline.point(SplineParam { span, t })))
            .map(|p| -skin.distance(p))
            .fold(0.0, f32::max);
        assert!(deepest < 1.5 * FOLD, "{deepest}");
        let lifted = points.iter().filter(|p| skin.distance(**p) > FOLD).count();
        assert!(lifted > points.len() / 8 && skin.distance(points[0]) < 1e-3, "{lifted}");
    }

    #[test]
    fn free_strokes_stay_as_drawn_and_start_on_the_scalp() {
        let scalp = ball(HEAD_RADIUS);
        let set = [("project", "free".into()), ("smoothing", Value::Float(0.0))];
        let curves = drawn(&scalp, vec![back(7, 2.0)], &set);
        let points = curves.tufts()[0].curve(0);
        assert!(scalp.surface().closest(points[0]).unwrap().distance < 1e-3);
        let off = |p: &Vec3| (p.with_x(0.0).length() - 9.9).abs();
        assert!(
            points[4..].iter().all(|p| off(p) < 0.05 && (p.x - 2.0).abs() < 0.05),
            "{points:?}"
        );
        // A stroke through the head comes out of it.
        let at = |x| Sample { position: Vec3::new(x, 3.0, 1.0), ..Sample::default() };
        let through = |id| Stroke::new(id, [-9.0, 0.0, 9.0].map(at).to_vec());
        let curves = drawn(&scalp, vec![through(3)], &set);
        for p in curves.tufts()[0].curve(0) {
            let hit = scalp.surface().closest(*p).unwrap();
            assert!(scalp.surface().signed_distance(*p, &hit) > -1e-3, "{p}");
        }
    }

    #[test]
    fn pressure_makes_the_radius_and_a_ramp_runs_along_it() {
        let scalp = ball(HEAD_RADIUS);
        let radius = |set: &[(&str, Value)]| {
            let curves = drawn(&scalp, vec![back(7, 2.0)], set);
            let tuft = curves.tufts()[0].clone();
            let n = tuft.curve(0).len();
            [0, n / 2, n - 1].map(|k| tuft.view(RADIUS).at(0, k))
        };
        assert_eq!(radius(&[]), [1.0; 3]);
        let [a, b, c] = radius(&[("pressure_radius", Value::Float(1.0))]);
        assert!(a < 0.01 && (b - 0.5).abs() < 0.03 && c > 0.99, "{a} {b} {c}");
        let ramp = Value::Ramp(Arc::new(Ramp::linear(2.0, 1.0)));
        let [a, b, c] = radius(&[("radius", ramp)]);
        assert!(a == 2.0 && (b - 1.5).abs() < 0.03 && c == 1.0, "{a} {b} {c}");
    }

    #[test]
    fn mirrored_twins_have_their_own_ids_and_the_midline_has_none() {
        let scalp = ball(HEAD_RADIUS);
        let curves = drawn(&scalp, vec![back(7, 2.0), back(8, 0.0)], &[("mirror", "both".into())]);
        let ids: Vec<u64> = curves.each().map(|(tuft, i)| tuft.id(i)).collect();
        assert_eq!(ids, [curve_id(7, 0, 0), curve_id(7, 0, 1), curve_id(8, 0, 0)]);
        let (one, twin) = (&curves.tufts()[0], &curves.tufts()[1]);
        for (a, b) in one.points().iter().zip(twin.points()) {
            assert!(a.distance(*b * Vec3::new(-1.0, 1.0, 1.0)) < 1e-3, "{a} {b}");
        }
        assert_eq!(drawn(&scalp, vec![back(7, 2.0)], &[]).curve_count(), 1);
    }

    #[test]
    fn smoothing_takes_the_tremble_out_and_keeps_the_ends() {
        let scalp = ball(HEAD_RADIUS);
        let mut wild = back(7, 2.0);
        for (k, s) in wild.samples.iter_mut().enumerate() {
            s.position.x += if k % 2 == 0 { 0.2 } else { -0.2 };
        }
        let rough = |smoothing: f32| {
            let curves =
                drawn(&scalp, vec![wild.clone()], &[("smoothing", Value::Float(smoothing))]);
            let length = Spline::new(curves.tufts()[0].curve(0)).unwrap().length();
            (length, curves.tufts()[0].curve(0)[0])
        };
        let ((l0, a), (l1, b)) = (rough(0.0), rough(1.0));
        let straight = Spline::new(drawn(&scalp, vec![back(7, 2.0)], &[]).tufts()[0].curve(0));
        assert!(l1 < l0 && l1 / straight.unwrap().length() < 1.03, "{l0} {l1}");
        assert!(a.distance(b) < 1e-4);
    }

    #[test]
    fn a_dot_is_named_and_the_rest_is_drawn() {
        let scalp = ball(HEAD_RADIUS);
        let dot = Stroke::new(9, back(9, 1.0).samples[..1].to_vec());
        let strokes = Strokes(vec![dot, back(7, 2.0)]);
        let (out, said) = run(&NODE, &[("scalp", scalp.into()), ("strokes", strokes.into())]);
        assert_eq!(curves_of(&out[0]).curve_count(), 1);
        assert_eq!(said, ["a stroke without length was left out (curve 0000000000000009)"]);
    }

    #[test]
    fn one_more_stroke_makes_one_more_tuft() {
        let (scalp, host) = (ball(HEAD_RADIUS), Memory::default());
        let ran = |strokes: Vec<Stroke>| {
            let log = Log::default();
            let set = [("scalp", scalp.clone().into()), ("strokes", Strokes(strokes).into())];
            run_on(&NODE, &set, &host, &log, Quality::Final).unwrap();
            log.tufts_run.load(Ordering::Relaxed)
        };
        assert_eq!(ran(vec![back(1, 1.0), back(2, 2.0)]), 2);
        assert_eq!(ran(vec![back(1, 1.0), back(2, 2.0), back(3, 3.0)]), 1);
        assert_eq!(ran(vec![back(1, 1.0), back(2, 2.5), back(3, 3.0)]), 1);
        assert_eq!(ran(vec![back(2, 2.5), back(3, 3.0)]), 0);
    }
}
