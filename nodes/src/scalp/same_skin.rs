//! A head that is turned, scaled, or shaped differently elsewhere grows the same hair: roots, ids and bindings follow the
//! skin's triangles, not space.

use crate::data::attributes::{ROOT_BARY, ROOT_TRIANGLE};
use crate::data::curves::Curves;
use crate::data::scalp::{HeadFrame, REGION, Scalp};
use crate::define::{FileData, Value};
use crate::maths::closest::Surface;
use crate::scalp::bust;
use crate::testing::{curves_of, head, run};
use glam::{Quat, Vec2, Vec3};
use std::collections::BTreeMap;
use std::fmt::Write;
use std::sync::Arc;

/// Triangle and weights of each hair's root, by id.
type Rooted = BTreeMap<u64, (i32, Vec2)>;

/// Scattered guides, and the hair between them by count and by density.
fn grown(scalp: &Arc<Scalp>) -> [(&'static str, Rooted); 3] {
    let rooted = |curves: &Curves| -> Rooted {
        let of = |(tuft, i): (&crate::data::curves::Tuft, usize)| {
            (tuft.id(i), (tuft.view(ROOT_TRIANGLE).at(i, 0), tuft.view(ROOT_BARY).at(i, 0)))
        };
        curves.each().map(of).collect()
    };
    let on = [("scalp", Value::from(scalp.clone()))];
    let set = [("count", Value::Int(500))];
    let guides =
        curves_of(&run(crate::by_id("scatter_guides").unwrap(), &[&on[..], &set].concat()).0[0])
            .clone();
    let hair = |by: [(&str, Value); 2]| {
        let led = [("guides", guides.clone().into()), ("points", Value::Int(2))];
        let (out, _) = run(crate::by_id("interpolate").unwrap(), &[&on[..], &led, &by].concat());
        rooted(curves_of(&out[0]))
    };
    let count = hair([("by", "count".into()), ("count", Value::Int(20_000))]);
    let density = hair([("by", "density".into()), ("density", Value::Float(30.0))]);
    [("guides", rooted(&guides)), ("hair by count", count), ("hair by density", density)]
}

/// How many of the roots of one head, of those that `stays` tells, are not there on another with the same id, triangle and
/// weights; and how many there are.
fn lost(before: &Rooted, after: &Rooted, stays: &dyn Fn(i32) -> bool) -> (usize, usize) {
    let all = || before.iter().filter(|(_, (triangle, _))| stays(*triangle));
    (all().filter(|(id, root)| after.get(id) != Some(root)).count(), all().count())
}

/// At most these shares of guides and of hair may be lost.
#[track_caller]
fn check(
    what: &str,
    plain: &Arc<Scalp>,
    other: &Arc<Scalp>,
    [guides, hair]: [f32; 2],
    stays: &dyn Fn(i32) -> bool,
) {
    for ((kind, before), (_, after)) in grown(plain).iter().zip(&grown(other)) {
        let (lost, all) = lost(before, after, stays);
        println!("{what}: {lost} of {all} {kind} are lost");
        let share = if *kind == "guides" { guides } else { hair };
        assert!(all > 100, "{what}: {all} {kind}");
        assert!(lost as f32 <= share * all as f32, "{what}: {lost} of {all} {kind} are lost");
    }
}

/// The built-in head as a file, with its points changed.
fn file(change: &dyn Fn(Vec3) -> Vec3) -> Arc<Scalp> {
    let (bust, mut text) = (bust::adult(), String::new());
    for p in bust.points.iter().map(|p| change(*p)) {
        writeln!(text, "v {} {} {}", p.x, p.y, p.z).unwrap();
    }
    for t in &bust.triangles {
        writeln!(text, "f {} {} {}", t[0] + 1, t[1] + 1, t[2] + 1).unwrap();
    }
    let (path, extension) = ("head.obj".to_owned(), "obj".to_owned());
    let bytes = text.into_bytes().into();
    let file = FileData { path, extension, bytes, sides: BTreeMap::new() };
    head(&[("mesh", Value::File(Arc::new(file)))])
}

#[test]
fn a_head_that_is_turned_or_scaled_keeps_its_roots() {
    let plain = file(&|p| p);
    let turn = Quat::from_axis_angle(Vec3::Y, 29f32.to_radians());
    check("scaled", &plain, &file(&|p| p * 1.2), [0.0, 1e-4], &|_| true);
    // Where the face looks is found to a tenth of a degree, and the soft edge of the region with it.
    check("turned and scaled", &plain, &file(&|p| turn * (p * 1.2)), [0.01, 1e-3], &|_| true);
    // Laid down, with the region that it had.
    let turned = |axis: Vec3, scale: f32| {
        let turn = Quat::from_axis_angle(axis.normalize(), 29f32.to_radians());
        let (surface, frame) = (plain.surface(), plain.frame());
        let points = surface.points.iter().map(|p| turn * *p * scale).collect();
        let frame = HeadFrame {
            origin: turn * frame.origin * scale,
            right: turn * frame.right,
            up: turn * frame.up,
            forward: turn * frame.forward,
            radius: frame.radius * scale,
        };
        let masks = [(REGION.to_owned(), plain.region().to_vec())].into();
        Arc::new(Scalp::new(Surface::new(points, surface.triangles.clone()), None, frame, masks))
    };
    check("about x", &plain, &turned(Vec3::X, 1.0), [0.0, 1e-4], &|_| true);
    check("about a slant", &plain, &turned(Vec3::new(1.0, -2.0, 3.0), 1.2), [0.0, 1e-4], &|_| true);
}

#[test]
fn a_brow_that_is_raised_keeps_the_roots_of_the_rest() {
    let raise = |p: Vec3| {
        let near = (1.0 - p.distance(Vec3::new(3.0, 0.5, 8.5)) / 3.0).max(0.0);
        p + Vec3::new(0.0, 0.4, 0.2) * near
    };
    let plain = file(&|p| p);
    check("brow", &plain, &file(&raise), [0.02, 5e-3], &|_| true);
    // At the crown: skin that is drawn out has more hair, and all other hair is as it was.
    let swell = |p: Vec3| {
        let near = (1.0 - p.distance(Vec3::new(0.0, 9.0, 0.0)) / 4.0).max(0.0);
        p + Vec3::Y * (0.5 * near)
    };
    let corners = |t: i32| plain.surface().corners(u32::try_from(t).unwrap());
    let stays = |t: i32| corners(t).iter().all(|p| swell(*p) == *p);
    check("crown", &plain, &file(&swell), [0.25, 0.02], &stays);
}
