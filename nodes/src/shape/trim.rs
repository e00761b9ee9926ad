//! Trim: hair cut to a shape, as with shears.
//!
//! Every hair keeps the part from its root to where it first leaves the shape. Hair that stays inside is unchanged;
//! hair rooted outside the shape keeps a stub.
//!
//! Guarantees: roots, ids and everything inside stay; a cut hair ends on the outline, or as far from it as `softness`
//! says, to 1e-3 of its length, or on the skin above it; it keeps the spacing of its points, and a `fibre_length` in
//! proportion; no point becomes deeper below the skin than the hair allows. Not promised: shapes that are hollow or
//! have arms: outlines are seen from their centre, and the outermost wall in each direction counts.

use crate::data::attributes::ALLOW_DEPTH;
use crate::data::curves::{Curves, Tuft};
use crate::data::route::{Policy, Route};
use crate::data::scalp::Scalp;
use crate::define::{NodeError, choice, node, unless, without_mesh};
use crate::eval::{EvalCx, Piece};
use crate::maths::spline::Spline;
use crate::maths::transcendental::sin_cos;
use crate::puff::outline::PuffOutline;
use crate::strand::shorten::Shortened;
use glam::{Vec2, Vec3};
use std::sync::Arc;

node! {
    /// Cuts hair to a shape: an ellipsoid around the head, a closed mesh, or outlines drawn in front and side view.
    ///
    /// Each hair keeps the part from its root to where it first leaves the shape. Wire it before Shape-list curl, so
    /// that no CVs are spent on hair that gets cut off; it cuts curled hair too.
    "trim", version 1, label "Trim",
        words "trim cut shears scissors haircut barber shape outline silhouette afro round topiary crop clip ellipsoid", scales,
        refuses(without_mesh);
    inputs {
        /// Hair to cut.
        curves: Curves;
        /// The head that the shape is placed on.
        scalp: Arc<Scalp>;
        /// Shape to cut the hair to.
        shape: Shape = Shape::Ellipsoid, words("outline silhouette ellipsoid mesh drawn");
        /// Centre of the shape, in head units (cm on a head of average size) from the centre of the cranium.
        centre: Vec3 = Vec3::new(0.0, 1.5, -1.5), handle(Handle::Point), words("middle position place");
        /// Half axes of the ellipsoid: sideways, up, forward.
        size: Vec3 = Vec3::new(14.0, 14.0, 14.0), unit(Length), words("radius width height depth ellipsoid"),
            idle(|of| unless(of, "shape", "ellipsoid", "the shape is no ellipsoid"));
        /// Length that is left beyond the shape: makes it larger all around. Negative values cut shorter.
        longer: f32 = 0.0, hard(-100.0, 100.0), soft(-10.0, 10.0), unit(Length), words("length shorter grow enlarge offset level");
        /// How far the shape leans back about its centre.
        tilt: f32 = 0.0, hard(-180.0, 180.0), soft(-60.0, 60.0), unit(Angle), words("lean rotate");
        /// Closed mesh to cut to, used at its own position: wire a Head node that reads it, with no fit. The shape is
        /// centred on the mesh.
        mesh: Option<Arc<Scalp>>, words("volume outline topiary");
        /// Closed outline in front view, drawn around the shape's centre.
        front: Option<Curves>, words("outline silhouette draw stroke");
        /// Closed outline in side view, drawn around the shape's centre.
        side: Option<Curves>, words("outline silhouette draw stroke");
        /// How far ends may lie inside or outside the outline; most lie close to it. 0 is a clean cut.
        softness: f32 = 0.0, hard(0.0, 20.0), soft(0.0, 2.0), unit(Length), words("fuzzy uneven natural edge point");
        /// Shortest length that a cut leaves, even outside the shape.
        least: f32 = 0.3, hard(0.0, 100.0), soft(0.0, 3.0), unit(Length), words("minimum stub stubble hairline");
        /// Scale lengths with the size of the head.
        scale_with_head: bool = true;
        /// Random seed for this node.
        seed: i64 = 0;
    }
    outputs {
        /// The same hair, cut to the shape.
        curves: Curves;
    }
}

choice! {
    /// Shape to cut the hair to.
    Shape {
        /// An ellipsoid with its own size along three axes.
        Ellipsoid = "ellipsoid",
        /// A closed mesh.
        Mesh = "mesh",
        /// Outlines drawn in front and side view; the ellipsoid's width, height or depth where one is missing.
        Drawn = "drawn",
    }
}

/// Bisections of the segment of a hair that crosses the outline.
const HALVINGS: usize = 12;
/// Samples per point of a hair at which it is tested against the shape.
const SAMPLES: usize = 3;

fn eval(cx: &EvalCx, inputs: Inputs) -> Result<Outputs, NodeError> {
    let frame = inputs.scalp.frame();
    let (sin, cos) = sin_cos(inputs.tilt.to_radians());
    let axes =
        [frame.right, frame.up * cos - frame.forward * sin, frame.forward * cos + frame.up * sin];
    let mut centre = inputs.scalp.place(inputs.centre);
    let least_size = Vec3::splat(0.01 * cx.unit());
    // Half axes grow by it, so that what is cut level stays level; other outlines are seen from their centre.
    let (size, longer) = match inputs.shape {
        Shape::Ellipsoid => (inputs.size.abs() + inputs.longer, 0.0),
        Shape::Mesh | Shape::Drawn => (inputs.size.abs(), inputs.longer),
    };
    let size = size.max(least_size);
    let outline = match (inputs.shape, &inputs.mesh) {
        (Shape::Ellipsoid, _) | (Shape::Mesh, None) => PuffOutline::Ellipsoid(size),
        (Shape::Mesh, Some(mesh)) => {
            let (low, high) = mesh.surface().bounds();
            centre = 0.5 * (low + high);
            PuffOutline::Mesh(mesh.surface(), centre, axes)
        }
        (Shape::Drawn, _) => {
            let radii = |lines: &Option<Curves>, aside: Vec3, half: f32| match lines {
                Some(lines) => PuffOutline::drawn(lines, half, |p| {
                    Vec2::new((p - centre).dot(aside), (p - centre).dot(axes[1]))
                }),
                None => PuffOutline::drawn(&Curves::default(), half, |_| Vec2::ZERO),
            };
            PuffOutline::Drawn(
                radii(&inputs.front, axes[0], size.x),
                radii(&inputs.side, axes[2], size.z),
            )
        }
    };
    let dice = cx.dice(inputs.seed, "trim");
    let route = Route::new(Some(&inputs.scalp), Policy::default());
    let (soft, least) = (inputs.softness, inputs.least);
    // Distance of a point outside the outline, cm.
    let over = |p: Vec3| {
        let off = p - centre;
        let far = off.length();
        let way = off.try_normalize().unwrap_or(Vec3::Y);
        far - outline.reach(Vec3::new(way.dot(axes[0]), way.dot(axes[1]), way.dot(axes[2])), 1.0)
            - longer
    };
    let [curves] = cx.each_tuft(&inputs.curves, |tuft, piece| {
        let room = |id: u64| {
            let aside = dice.signed(id, 0);
            soft * aside * aside * aside
        };
        Ok([cut(tuft, |p, id| over(p) - room(id), least, (&route, piece))?])
    })?;
    let (mut before, mut after) = (0, 0);
    for (old, new) in inputs.curves.tufts().iter().zip(curves.tufts()) {
        before += old.len();
        after += (0..new.len().min(old.len())).filter(|i| old.curve(*i) != new.curve(*i)).count();
    }
    cx.remark(format!("{after} of {before} hairs were cut"));
    Ok(Outputs { curves })
}

/// Every curve of `tuft` up to where `over` of it and its id first is more than 0, but at least `least` cm. Curves without length
/// are left out and noted.
fn cut(
    tuft: &Tuft,
    over: impl Fn(Vec3, u64) -> f32,
    least: f32,
    (route, piece): (&Route, &mut Piece),
) -> Result<Tuft, NodeError> {
    let mut out = Shortened::new(tuft);
    let mut spline = Spline::default();
    let depth = tuft.view(ALLOW_DEPTH);
    for i in 0..tuft.len() {
        piece.tick()?;
        let (old, first, id) = (tuft.curve(i), tuft.offsets()[i], tuft.id(i));
        if let Err(fault) = spline.rebuild(old) {
            piece.trouble(id, fault);
            continue;
        }
        let end = end(&spline, old.len(), |p| over(p, id)).map(|end| end.max(least));
        match end.filter(|end| *end < spline.length()) {
            None => out.keep(i),
            // Between its points a hair may dip into the skin.
            Some(end) => out.cut(i, &spline, end, |p, span| {
                route.between(p, depth.at(i, first as usize + span))
            }),
        }
    }
    Ok(out.build())
}

/// Arc length from the root at which a curve of `n` points is first outside; `None` if it never is.
fn end(spline: &Spline, n: usize, over: impl Fn(Vec3) -> f32) -> Option<f32> {
    let samples = n * SAMPLES;
    let at = |k: usize| spline.length() * k as f32 / samples as f32;
    let mut cursor = 0;
    let outside = (0..=samples)
        .find(|k| over(spline.point(spline.locate_rising(&mut cursor, at(*k)))) > 0.0)?;
    let Some(before) = outside.checked_sub(1) else { return Some(0.0) };
    let (mut low, mut high) = (at(before), at(outside));
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + high);
        if over(spline.point(spline.locate_length(middle))) > 0.0 {
            high = middle
        } else {
            low = middle
        }
    }
    Some(low)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::attributes::{Domain, FIBRE, ID, ROLL};
    use crate::data::curves::TuftBuilder;
    use crate::data::scalp::tests::shared_ball;
    use crate::define::Value;
    use crate::testing::{curves_of, fails, run};

    /// Hairs that stand off the ball in all directions, 10 cm long.
    fn hair() -> Curves {
        let mut b = TuftBuilder::new();
        for k in 0..60 {
            let y = 1.0 - 2.0 * (k as f32 + 0.5) / 60.0;
            let (s, c) = sin_cos(k as f32 * 2.4);
            let flat = (1.0 - y * y).sqrt();
            let out = Vec3::new(s * flat, y, c * flat);
            let root = shared_ball().closest_root(out * 20.0).unwrap().point;
            let points: Vec<Vec3> = (0..11).map(|k| root + out * k as f32).collect();
            b.push_curve(&points);
        }
        b.set(ID, Domain::Curve, (1..=60).collect());
        b.set(FIBRE, Domain::Curve, vec![30.0; 60]);
        b.set(ROLL, Domain::Point, (0..60).flat_map(|_| (0..11).map(|k| k as f32)).collect());
        Curves::new(vec![b.build().into()])
    }

    fn trimmed(set: &[(&str, Value)]) -> Curves {
        let scalp = [("curves", hair().into()), ("scalp", shared_ball().into())];
        curves_of(&run(&NODE, &[&scalp[..], set].concat()).0[0]).clone()
    }

    #[test]
    fn ends_lie_on_the_shape_and_nothing_else_changes() {
        let (size, centre) = (Vec3::new(13.0, 22.0, 16.0), Vec3::new(0.5, 2.0, -1.0));
        let frame = *shared_ball().frame();
        let middle = frame.point_from_head(centre);
        let unit = frame.unit();
        let out = trimmed(&[("size", size.into()), ("centre", centre.into())]);
        let (old, new) = (&hair().tufts()[0].clone(), &out.tufts()[0].clone());
        assert_eq!(old.len(), new.len());
        let mut cuts = 0;
        for i in 0..old.len() {
            let (a, b) = (old.curve(i), new.curve(i));
            assert_eq!((a[0], old.id(i)), (b[0], new.id(i)));
            let inside = |p: Vec3| ((p - middle) / (size * unit)).length();
            let (tip, long) = (b[b.len() - 1], b[0].distance(b[b.len() - 1]));
            let share = new.view(FIBRE).at(i, new.offsets()[i] as usize) / 30.0;
            assert!((share - long / 10.0).abs() < 1e-3, "{share} {long}");
            assert!((new.view(ROLL).at(i, new.range(i).end - 1) - long).abs() < 0.01);
            if long < 9.999 {
                cuts += 1;
                assert!((inside(tip) - 1.0).abs() < 1e-3 || long < 0.31 * unit, "{}", inside(tip));
                // The rest stays in place: hair that a node led out of the skin stays out of it.
                let kept = b.len() - 1;
                assert!(long < 3.0 || a[..kept] == b[..kept], "{long}");
            } else {
                assert_eq!(a, b);
                assert!(inside(tip) < 1.001);
            }
        }
        assert!((20..60).contains(&cuts), "{cuts}");
    }

    #[test]
    fn longer_enlarges_the_shape_and_keeps_what_is_cut_level_level() {
        let frame = *shared_ball().frame();
        let at = |size: Vec3, longer: f32| {
            let centre = ("centre", Vec3::new(0.0, 9.0, 0.0).into());
            trimmed(&[centre, ("size", size.into()), ("longer", Value::Float(longer))])
        };
        let wide = Vec3::new(50.0, 15.0, 50.0);
        assert_eq!(at(wide, 5.0).key(), at(wide + 5.0, 0.0).key());
        assert_eq!(at(wide, -5.0).key(), at(wide - 5.0, 0.0).key());
        // A flat shape is a level, so far below its centre.
        let level = at(Vec3::new(200.0, 0.0, 200.0), 22.0);
        let deepest = level.each().flat_map(|(tuft, i)| tuft.curve(i).to_vec());
        let deepest = deepest.map(|p| (p - frame.point_from_head(Vec3::Y * 9.0)).dot(frame.up));
        let lowest = deepest.fold(0.0f32, f32::min) / frame.unit();
        assert!((lowest + 22.0).abs() < 0.02, "{lowest}");
    }

    #[test]
    fn a_soft_cut_is_uneven_and_a_stub_stays_outside() {
        let far = |curves: &Curves| {
            let middle = shared_ball().frame().point_from_head(Vec3::ZERO);
            let tips = curves.each().map(|(tuft, i)| *tuft.curve(i).last().unwrap());
            tips.map(|tip| tip.distance(middle)).collect::<Vec<_>>()
        };
        let unit = shared_ball().frame().unit();
        let ball = [("size", Vec3::splat(13.0).into()), ("centre", Vec3::ZERO.into())];
        let clean = far(&trimmed(&ball));
        assert!(clean.iter().all(|r| (r - 13.0 * unit).abs() < 0.01), "{clean:?}");
        let soft = far(&trimmed(&[&ball[..], &[("softness", Value::Float(1.0))]].concat()));
        assert!(soft.iter().all(|r| (r - 13.0 * unit).abs() < 1.01 * unit));
        assert!(soft.iter().any(|r| (r - 13.0 * unit).abs() > 0.3));
        let none = [("size", Vec3::splat(3.0).into()), ("least", Value::Float(0.5))];
        for (tuft, i) in trimmed(&none).each() {
            let curve = tuft.curve(i);
            assert!((curve[0].distance(curve[curve.len() - 1]) - 0.5 * unit).abs() < 1e-3);
        }
    }

    #[test]
    fn a_mesh_that_is_missing_is_told() {
        let set =
            [("curves", hair().into()), ("scalp", shared_ball().into()), ("shape", "mesh".into())];
        assert!(fails(&NODE, &set).contains("nothing is wired to mesh"));
    }
}
