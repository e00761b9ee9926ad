//! Messages and behaviour for meshes that are not plain heads: inverted parts, two heads, flat things, things worn.

use super::laws::{adult, bust_shape, named, on_the_bust};
use super::worn::WornMesh;
use super::*;
use crate::define::Value;
use crate::scalp::find::Search;

fn said(shapes: &[(&str, &WornMesh)]) -> (Arc<Scalp>, Vec<String>) {
    adult(&[("mesh", named(shapes, |p| p))])
}

#[track_caller]
fn says(said: &[String], parts: &[&str]) {
    assert!(said.iter().any(|s| parts.iter().all(|part| s.contains(part))), "{parts:?}: {said:?}");
}

#[test]
fn a_part_that_is_inside_out_is_turned_and_named() {
    let turned = |mut shape: WornMesh| {
        shape.triangles.iter_mut().for_each(|t| t.swap(1, 2));
        shape
    };
    // (Balls of [`WornMesh`] show their inside.)
    let bun = turned(WornMesh::ball(Vec3::new(0.0, -4.0, -16.0), Vec3::splat(6.0)));
    let bust = bust_shape();
    let whole = said(&[("Head", &bust), ("Bun", &bun)]).0;
    for (head, other, name) in [
        (turned(bust.clone()), bun.clone(), "those of \"Head\""),
        (bust.clone(), turned(bun.clone()), "those of \"Bun\""),
    ] {
        let (scalp, said) = said(&[("Head", &head), ("Bun", &other)]);
        says(&said, &["triangles are inside out", name]);
        assert!(!said.iter().any(|s| s.starts_with("the mesh is inside out")), "{said:?}");
        // Seen from above, the crown shows its front, and so does the part beside it.
        for at in [Vec3::Y * 30.0, Vec3::new(1.0, -4.5, -30.0)] {
            let (a, b) = (scalp.surface(), whole.surface());
            let hits = [a, b].map(|surface| surface.closest(at).unwrap());
            assert!(a.signed_distance(at, &hits[0]) > 0.0, "{name} {at}");
            assert_eq!(a.face_normal(hits[0].triangle), b.face_normal(hits[1].triangle), "{name}");
        }
    }
}

#[test]
fn a_second_head_is_told_with_what_to_do() {
    let bust = bust_shape();
    let beside = bust.clone().placed(|p| p + Vec3::X * 50.0);
    let heads = [("Anna", &bust), ("Ben", &beside)];
    let (scalp, said) = said(&heads);
    let (this, other) =
        if scalp.frame().origin.x < 25.0 { ("Anna", "Ben") } else { ("Ben", "Anna") };
    let (has, grows) =
        (format!("has another head, {other:?}"), format!("hair grows on {this:?} alone"));
    says(&said, &[&has, &grows, "(leave_out), or choose where", "region"]);
    let (scalp, said) = adult(&[("mesh", named(&heads, |p| p)), ("leave_out", this.into())]);
    assert!(!said.iter().any(|s| s.contains("another head")), "{said:?}");
    assert_eq!(scalp.frame().origin.x < 25.0, other == "Anna");
}

/// Shapes as one piece: a triangle leads from each to the next.
fn joined(shapes: &[WornMesh]) -> WornMesh {
    let mut all = WornMesh::default();
    for shape in shapes {
        let first = all.points.len() as u32;
        all = all.and(shape);
        if first > 0 {
            all.triangles.push([0, 1, first]);
        }
    }
    all
}

/// What is said first of all that is no remark on how the file was read.
fn first(said: &[String]) -> &str {
    let others = ["left out: ", "the file states no units", " vertices touch others"];
    said.iter().find(|said| !others.iter().any(|other| said.contains(other))).unwrap()
}

#[test]
fn a_knee_is_no_head_and_is_told_first_with_what_the_parts_look_like() {
    // The bust's head as a knee, a thigh as high as three heads over it, and a box for a head.
    let block = |at: Vec3, half: Vec3| {
        let ball = WornMesh::ball(Vec3::ZERO, Vec3::ONE);
        ball.placed(|p| at + p.clamp(Vec3::splat(-0.5), Vec3::splat(0.5)) * 2.0 * half)
    };
    let knee = bust_shape();
    let thigh = block(Vec3::Y * 35.0, Vec3::new(6.0, 28.0, 6.0));
    let robot = block(Vec3::Y * 75.0, Vec3::new(20.0, 12.0, 15.0));
    let parts = [("Knee.R", &knee), ("Thigh", &thigh), ("Head", &robot)];
    let (scalp, said) = said(&parts);
    assert_eq!(*scalp.frame(), HeadFrame::IDENTITY, "{said:?}");
    assert!(first(&said).starts_with("no human cranium was found"), "{said:?}");
    says(
        &said,
        &["\"Knee.R\": like a cranium, but the mesh goes on above it", "the others in leave_out"],
    );
    says(&said, &["\"Thigh\": round as a cranium, without a face; \"Head\": without a cranium"]);
    assert!(!said.iter().any(|s| s.contains("over the crown")), "{said:?}");
    // Without a leg above it, it is a head like any other, and so it is under any hat.
    let leave = [("mesh", named(&parts, |p| p)), ("leave_out", "Thigh, Head".into())];
    assert!(adult(&leave).0.frame().radius > 8.0);
    let hat = block(Vec3::Y * 18.0, Vec3::new(7.0, 14.0, 7.0));
    let (scalp, said) = self::said(&[("Head", &knee), ("thing", &hat)]);
    assert!(scalp.frame().radius > 8.0, "{said:?}");
    let Some(file) = crate::testing::shared_file("reported/3/robot_knee.glb") else { return };
    let (scalp, said) = adult(&[("mesh", Value::File(file))]);
    assert_eq!(*scalp.frame(), HeadFrame::IDENTITY, "{said:?}");
    says(&said, &["\"Knee.L\", \"Knee.R\": like a cranium, but the mesh goes on above it"]);
}

#[test]
fn several_people_in_one_piece_are_told_first_and_hair_grows_on_one() {
    let bust = bust_shape();
    // All as high as the first, and the middle one higher.
    for lift in [0.0, 6.0] {
        let at =
            |k: f32| bust.clone().placed(|p| p + Vec3::new(45.0 * k, lift * (1.0 - k * k), 0.0));
        let statue = joined(&[at(-1.0), at(0.0), at(1.0)]);
        let (scalp, said) = said(&[("statue", &statue)]);
        says(
            &said,
            &["3 alike: the mesh has other heads at (", "alone", "cut them apart", "region"],
        );
        assert!(first(&said).starts_with("3 alike"), "{said:?}");
        assert!((scalp.frame().radius - HEAD_RADIUS).abs() < 0.1, "{}", scalp.frame().radius);
        let area = area(scalp.surface(), scalp.region());
        assert!((500.0..700.0).contains(&area), "{lift}: {area} cm2");
    }
}

#[test]
fn a_ball_has_no_face_and_no_neck_which_is_told_first() {
    let ball = WornMesh::ball(Vec3::Y * 50.0, Vec3::splat(9.0));
    let (_, said) = said(&[("Bulb", &ball)]);
    assert!(first(&said).contains("has no face and no neck under it"), "{said:?}");
    let pole = WornMesh::ball(Vec3::ZERO, Vec3::new(3.0, 42.0, 3.0));
    let (_, said) = self::said(&[("Bulb", &ball), ("Pole", &pole)]);
    assert!(first(&said).contains("has no face. If it is no head"), "{said:?}");
    says(&said, &["has no face", "leave_out", "\"Bulb\": round as a cranium, without a face"]);
}

#[test]
fn of_real_heads_nothing_is_doubted() {
    for name in [
        "lps_head/LeePerrySmith.glb",
        "ict_head/generic_neutral_mesh.obj",
        "sintel/sintel.obj",
        "snowden_scan/snowden.obj",
        "reported/head_plain.glb",
        "reported/head_skinned_cm_zup.glb",
        "reported/head_with_ponytail.glb",
        "reported/3/head_and_cap.glb",
    ] {
        let Some(file) = crate::testing::shared_file(name) else { return };
        let (_, said) = adult(&[("mesh", Value::File(file))]);
        for doubt in
            ["no human cranium", "taken for the head", "another head", "other heads", "Its parts: "]
        {
            assert!(!said.iter().any(|s| s.contains(doubt)), "{name}: {said:?}");
        }
    }
}

#[test]
fn a_flat_mesh_is_measured_across() {
    // 1000 units across and flat: mm, 1 m across, and not 1 km.
    let sheet = WornMesh {
        points: [(0.0, 0.0), (1000.0, 0.0), (1000.0, 800.0), (0.0, 800.0)]
            .map(|(x, z)| Vec3::new(x, 0.0, z))
            .to_vec(),
        triangles: vec![[0, 2, 1], [0, 3, 2]],
    };
    let (scalp, said) = said(&[("sheet", &sheet)]);
    says(&said, &["by its width (it is flat) of 1000 they are mm"]);
    assert_eq!(scalp.surface().bounds().1, Vec3::new(100.0, 0.0, 80.0));
}

#[test]
fn glasses_do_not_stand_over_the_crown() {
    let (bust, glasses, hat) = (bust_shape(), on_the_bust(11, 3), on_the_bust(10, 2));
    let (_, told) = said(&[("Head", &bust), ("thing", &glasses)]);
    assert!(!told.iter().any(|s| s.contains("over the crown")), "{told:?}");
    says(&told, &["\"thing\" may be hair or worn"]);
    let (_, told) = said(&[("Head", &bust), ("thing", &hat)]);
    says(&told, &["\"thing\" stands over the crown"]);
}

#[test]
fn many_parts_that_are_no_heads_cost_no_more_than_a_head_does() {
    // Balls in a heap: each has a cranium, and none has a face. With each of six axes up, each was once examined as
    // closely as a head.
    let spent = |shape: &WornMesh| {
        let pieces = Pieces::of(&shape.points, &shape.triangles);
        let mut search = Search::new(&shape.points, &shape.triangles, &pieces);
        for up in Up::ALL {
            let tried = search.try_up(up, &|| Ok(())).unwrap();
            search.head(&tried, up == Up::Y, &|| Ok(())).unwrap();
        }
        search.spent()
    };
    let at = |k: i32| Vec3::new((k % 5) as f32, (k / 5) as f32, (k % 3) as f32) * 25.0;
    let heap = (0..20).fold(WornMesh::default(), |heap, k| {
        heap.and(&WornMesh::ball(at(k), Vec3::new(8.0, 9.0, 8.5)))
    });
    let (heap, head) = (spent(&heap), spent(&bust_shape()));
    assert!(heap < 4 * head, "{heap} {head}");
}
