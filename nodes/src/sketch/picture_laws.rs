//! Tests: hair stays in the picture where the pen drew it, on heads, over what stands out of them, at three zooms.

use super::hair_sketch::resolved;
use super::hand::off_line;
use super::laws::{drawn, length, line, points};
use super::random_laws::out_of;
use super::seen::Seen;
use super::silhouette::MedialLine;
use crate::data::curves::Curves;
use crate::data::gestures::{Gesture, GestureView, Layer, PenSample, Tool};
use crate::data::scalp::Scalp;
use crate::maths::spline::{Spline, SplineParam};
use crate::maths::transcendental::sin_cos;
use crate::testing::{head, shared_head};
use glam::{Vec2, Vec3};
use std::sync::Arc;

/// Half heights of pictures: the whole head, a third of it, and two fingers' breadth.
const ZOOMS: [f32; 3] = [0.25, 0.1, 0.04];
/// How far hair may be from where it was drawn, pixels.
const OFF: f32 = 3.0;

/// A place of the skin in a direction from the middle of the head, seen from another; where a stroke goes from there.
struct Place {
    name: &'static str,
    root: Vec3,
    from: Vec3,
    way: Vec2,
}

const PLACES: [Place; 4] = [
    Place {
        name: "from the crown over the brow",
        root: Vec3::new(0.1, 0.9, 0.42),
        from: Vec3::new(0.0, 0.15, 1.0),
        way: Vec2::new(0.15, 1.0),
    },
    Place {
        name: "from the temple over the ear",
        root: Vec3::new(1.0, 0.35, 0.2),
        from: Vec3::new(1.0, 0.1, 0.1),
        way: Vec2::new(0.35, 1.0),
    },
    Place {
        name: "over the crown",
        root: Vec3::new(-0.3, 0.95, -0.2),
        from: Vec3::new(0.1, 1.0, 0.2),
        way: Vec2::new(1.0, 0.3),
    },
    Place {
        name: "from the brow over the nose",
        root: Vec3::new(-0.25, 0.3, 1.0),
        from: Vec3::new(0.1, 0.1, 1.0),
        way: Vec2::new(0.45, 1.0),
    },
];

impl Place {
    /// The view in which the root is in the middle of the picture.
    fn view(&self, scalp: &Scalp, half_height: f32) -> GestureView {
        let frame = scalp.frame();
        let way = frame.vector_from_head(self.root.normalize());
        let far = frame.origin + way * (4.0 * frame.radius);
        let hit = scalp.surface().ray(far, -way, f32::MAX).expect("the skin");
        let target = frame.head_from_point(hit.point);
        let eye = target + self.from.normalize() * 60.0;
        let up = if self.from.normalize().y > 0.9 { Vec3::NEG_Z } else { Vec3::Y };
        GestureView { eye, target, up, half_height, parallel: false, pixels: 1000.0 }
    }
    /// A wave of this length from the root, pixels.
    fn stroke(&self, long: f32) -> Vec<Vec2> {
        let way = self.way.normalize();
        let at = |k: i32| {
            let t = k as f32 / 60.0;
            let (sin, _) = sin_cos(std::f32::consts::TAU * t);
            way * (long * t) + way.perp() * (0.12 * long * sin)
        };
        (0..=60).map(at).collect()
    }
}

fn heads() -> Vec<(&'static str, Arc<Scalp>)> {
    let test = "hair_lands_where_the_pen_drew";
    let real = shared_head(test, "lps_head/LeePerrySmith.glb", &[]);
    [("built-in", Some(head(&[]))), ("lps", real)]
        .into_iter()
        .filter_map(|(name, scalp)| Some((name, scalp?)))
        .collect()
}

/// The drawn curve through CVs in the picture.
fn picture(seen: &Seen, cvs: &[Vec3]) -> Vec<Vec2> {
    let spline = Spline::new(cvs).expect("a curve");
    (0..=400).filter_map(|k| seen.pixel(spline.at(k as f32 / 400.0))).collect()
}

/// How far the drawn curve through CVs and a stroke are from each other at most, and their ends, pixels.
fn apart(seen: &Seen, cvs: &[Vec3], stroke: &[Vec2]) -> f32 {
    let curve = picture(seen, cvs);
    let far =
        |from: &[Vec2], to: &[Vec2]| from.iter().map(|p| off_line(to, *p)).fold(0.0, f32::max);
    let ends = curve[curve.len() - 1].distance(stroke[stroke.len() - 1]);
    far(&curve, stroke).max(far(stroke, &curve)).max(ends)
}

fn with_view(view: GestureView, tool: Tool, layer: Layer, line: &[Vec2]) -> Gesture {
    Gesture { view, ..drawn(tool, layer, line) }
}

/// The node's result for these gestures on a bare head, and what it says of them.
fn sketch(scalp: &Arc<Scalp>, gestures: &[Gesture]) -> (Curves, Vec<String>) {
    let (curves, mut told) = super::laws::sketch_on(scalp, None, gestures);
    told.retain(|text| !text.starts_with("lengths are "));
    (curves, told)
}

fn only(curves: &Curves) -> Vec<Vec3> {
    assert_eq!(curves.curve_count(), 1);
    curves.tufts()[0].points().to_vec()
}

/// Every head, place and zoom, with the view, how it shows the head, and words for it.
fn each(mut check: impl FnMut(&Arc<Scalp>, &Place, GestureView, &Seen, &str)) {
    for (name, scalp) in heads() {
        for place in &PLACES {
            for zoom in ZOOMS {
                let view = place.view(&scalp, zoom);
                let seen = Seen::new(&view, scalp.frame());
                check(&scalp, place, view, &seen, &format!("{name}, {}, {zoom}", place.name));
            }
        }
    }
}

#[test]
fn hair_lands_where_the_pen_drew() {
    each(|scalp, place, view, seen, said| {
        let stroke = place.stroke(350.0);
        let implant = with_view(view, Tool::Implant, Layer::Scalp, &stroke);
        let (curves, told) = sketch(scalp, std::slice::from_ref(&implant));
        assert!(told.is_empty(), "{said}: {told:?}");
        let cvs = only(&curves);
        let off = apart(seen, &cvs, &stroke);
        println!("{said}: implant {off:.2} pixels off, {} CVs, {:.1} cm", cvs.len(), length(&cvs));
        assert!(off <= OFF, "{said}: {off}");
        for p in &cvs[1..] {
            assert!(out_of(scalp, *p) > 0.0 && seen.sees(scalp, *p), "{said}: {p}");
        }
        // What a document keeps of it leads to the same.
        let kept = resolved(&implant, &Curves::default(), &curves, scalp);
        let again = only(&sketch(scalp, &[kept]).0);
        assert!(apart(seen, &again, &stroke) <= OFF, "{said}");

        // On from beside its tip, and anew from beside its middle, another way.
        let tip = seen.pixel(cvs[cvs.len() - 1]).expect("a tip");
        let middle = seen.pixel(cvs[cvs.len() / 2]).expect("a middle");
        for (tool, joint) in [(Tool::Lengthen, tip), (Tool::Redraw, middle)] {
            let by = joint + Vec2::new(8.0, -4.0);
            let on: Vec<Vec2> =
                place.stroke(200.0).iter().map(|p| by + Vec2::new(-p.x, p.y)).collect();
            let more = with_view(view, tool, Layer::Nearest, &on);
            let (longer, told) = sketch(scalp, &[implant.clone(), more]);
            assert!(told.is_empty(), "{said}: {told:?}");
            let is = only(&longer);
            let curve = picture(seen, &is);
            // (It joins the curve on its first 27 pixels.)
            let rest: Vec<Vec2> = on.iter().copied().filter(|p| p.distance(on[0]) > 30.0).collect();
            let off = rest.iter().map(|p| off_line(&curve, *p)).fold(0.0, f32::max);
            let off = off.max(curve[curve.len() - 1].distance(on[on.len() - 1]));
            println!("{said}: {} {off:.2} pixels off", tool.word());
            assert!(off <= OFF, "{said}: {tool:?} {off}");
        }
    });
}

#[test]
fn a_lock_beside_another_lies_on_the_head_as_it_does() {
    let scalp = head(&[]);
    let view = PLACES[0].view(&scalp, ZOOMS[0]);
    let one = with_view(view, Tool::Implant, Layer::Scalp, &line([0.0, 0.0], [40.0, 270.0]));
    let beside = |s: &PenSample| PenSample { at: s.at + Vec2::X * 70.0, ..*s };
    let two = Gesture { id: 2, samples: one.samples.iter().map(beside).collect(), ..one.clone() };
    let (curves, _) = sketch(&scalp, &[one, two]);
    let high = |cvs: &[Vec3]| -> f32 {
        let off = cvs.iter().map(|p| scalp.surface().closest(*p).expect("the skin").distance);
        off.fold(0.0, f32::max)
    };
    let all: Vec<f32> = points(&curves).values().map(|cvs| high(cvs)).collect();
    println!("{all:?}");
    assert!(all.len() == 2 && (all[0] - all[1]).abs() < 0.7, "{all:?}");
}

#[test]
fn an_outlined_lock_lies_along_the_middle_of_its_outline() {
    each(|scalp, place, view, seen, said| {
        let spine = place.stroke(300.0);
        let half = |k: usize| 30.0 * sin_cos(std::f32::consts::PI * k as f32 / 60.0).0;
        let side = |sign: f32| {
            let spine = &spine;
            move |k: usize| {
                let along = spine[(k + 1).min(60)] - spine[k.max(1) - 1];
                spine[k] + along.normalize().perp() * (sign * half(k))
            }
        };
        let outline: Vec<Vec2> =
            (0..=60).map(side(1.0)).chain((0..60).rev().map(side(-1.0))).collect();
        let leaf = with_view(view, Tool::Silhouette, Layer::Scalp, &outline);
        let (curves, told) = sketch(scalp, &[leaf]);
        assert!(told.is_empty(), "{said}: {told:?}");
        let middle = MedialLine::of(&outline, 30.0).expect("an outline").line;
        let off = apart(seen, &only(&curves), &middle);
        println!("{said}: silhouette {off:.2} pixels off");
        assert!(off <= OFF, "{said}: {off}");
    });
}

#[test]
fn a_point_moves_in_the_picture_as_far_as_the_pen() {
    each(|scalp, place, view, seen, said| {
        let implant = with_view(view, Tool::Implant, Layer::Scalp, &place.stroke(350.0));
        let was = only(&sketch(scalp, std::slice::from_ref(&implant)).0);
        let at = seen.pixel(was[was.len() - 1]).expect("a tip");
        // Back over the head.
        let way = Vec2::new(-30.0, -120.0);
        let pull =
            with_view(view, Tool::Point, Layer::Nearest, &line(at.into(), (at + way).into()));
        let is = only(&sketch(scalp, &[implant, pull]).0);
        let off = seen.pixel(is[is.len() - 1]).expect("a tip").distance(at + way);
        assert!(off < 0.5 && out_of(scalp, is[is.len() - 1]) > 0.0, "{said}: {off}");
    });
}

#[test]
fn hair_under_the_comb_goes_as_far_as_the_pen_between_its_cvs_too() {
    each(|scalp, place, view, seen, said| {
        // A lock of three to five segments, whatever the zoom is: CVs are up to 200 pixels apart.
        let wide = place.view(scalp, ZOOMS[0]);
        let implant = with_view(wide, Tool::Implant, Layer::Scalp, &place.stroke(300.0));
        let (before, _) = sketch(scalp, std::slice::from_ref(&implant));
        let was = only(&before);
        // Between two CVs as far down its first half as the picture shows, so that there is hair to follow the pen.
        let curve = Spline::new(&was).expect("a curve");
        let places = (1..=was.len() / 2).rev().map(|span| SplineParam { span, t: 0.5 });
        let mut shown = places.filter(|place| {
            let p = curve.point(*place);
            seen.pixel(p).is_some_and(|at| at.length() < 480.0) && seen.sees(scalp, p)
        });
        let place = shown.next().expect("hair in the picture");
        let at = seen.pixel(curve.point(place)).expect("seen");
        let ends = [0, 1].map(|k| seen.pixel(was[place.span + k]).expect("seen"));
        let along = ends[1] - ends[0];
        for side in [1.0, -1.0] {
            // Aside, and a little back, or the hair would not reach.
            let to = at + Vec2::new(-60.0, 45.0 * side).rotate(along.normalize());
            let comb = with_view(view, Tool::Comb, Layer::Through, &line(at.into(), to.into()));
            let all = [implant.clone(), Gesture { size: 60.0, ..comb }];
            let (after, told) = sketch(scalp, &all);
            assert!(told.is_empty(), "{said}: {told:?}");
            let is = only(&after);
            let off = off_line(&picture(seen, &is), to);
            println!("{said}: combed to {off:.2} pixels, {} CVs from {}", is.len(), was.len());
            assert!(off <= OFF, "{said}: {off}");
            assert_eq!(is[0], was[0], "{said}");
            assert!((length(&is) / length(&was) - 1.0).abs() < 0.01, "{said}");
            assert!(is[1..].iter().all(|p| out_of(scalp, *p) > -2e-3), "{said}");
            // At half the strength half as far or so.
            let half = Gesture { strength: 0.5, ..all[1].clone() };
            let is = only(&sketch(scalp, &[implant.clone(), half]).0);
            let left = off_line(&picture(seen, &is), to);
            assert!((20.0..65.0).contains(&left), "{said}: {left}");
        }
    });
}

#[test]
fn a_comb_that_finds_hair_held_says_so() {
    let scalp = head(&[]);
    let place = &PLACES[0];
    let view = place.view(&scalp, ZOOMS[0]);
    let seen = Seen::new(&view, scalp.frame());
    let implant = with_view(view, Tool::Implant, Layer::Scalp, &place.stroke(350.0));
    let was = only(&sketch(&scalp, std::slice::from_ref(&implant)).0);
    let tip = seen.pixel(was[was.len() - 1]).expect("a tip");
    let pin = with_view(view, Tool::Pin, Layer::Nearest, &[tip]);
    let comb = |from: Vec2, size: f32| {
        let way = line(from.into(), (from + Vec2::X * 80.0).into());
        Gesture { size, ..with_view(view, Tool::Comb, Layer::Through, &way) }
    };
    let at = seen.pixel(was[2]).expect("seen");
    let (same, told) = sketch(&scalp, &[implant.clone(), pin, comb(at, 40.0)]);
    assert_eq!(points(&same).into_values().next(), Some(was.clone()));
    assert!(told[0].contains("a pin holds this hair"), "{told:?}");
    // What is free is combed, whatever a pin before it holds.
    let pin = with_view(view, Tool::Pin, Layer::Nearest, &[at]);
    let (after, told) = sketch(&scalp, &[implant, pin, comb(tip, 40.0)]);
    let is = only(&after);
    assert!(told.is_empty() && is[..=2] == was[..=2] && is.last() != was.last(), "{told:?}");
}
