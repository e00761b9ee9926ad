//! Messages and behaviour for meshes that are not plain heads: inverted parts, two heads, flat things, things worn.

use super::laws::{adult, bust_shape, named, on_the_bust};
use super::worn::WornMesh;
use super::*;

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
