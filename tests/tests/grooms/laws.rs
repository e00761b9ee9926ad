//! Laws of methods.md on whole grooms, on the built-in head and on real ones, measured on what was written.
//!
//! That guides of a puff end on one sphere is read here alone: the sphere is found in their tips, where `coif measure` takes the one
//! that the file tells.

use coif_nodes::formats::usd::read::ReadCurves;
use coif_tests::{Folder, curves_in, eval, run, smooth_heads};
use glam::DVec3;
use serde_json::Value as Json;
use std::path::PathBuf;

/// Calls `check` for the built-in head and for every real one, with the arguments that choose it.
fn on_every_head(test: &str, check: impl Fn(&str, &[&str])) {
    check("adult", &[]);
    for head in smooth_heads(test) {
        check(head.name, &head.eval_args());
    }
}

/// The curves of some outputs, as a reader of the written file finds them.
fn written(graph: &str, outputs: &[&str], head: &[&str]) -> (Vec<ReadCurves>, PathBuf, Folder) {
    let folder = Folder::new(&format!("laws-{graph}-{}", outputs.join("-")));
    let file = folder.path("groom.usdc");
    let out = file.display().to_string();
    let wanted = outputs.iter().flat_map(|output| ["--output", output]);
    eval(graph, &wanted.chain(["--out", &out]).chain(head.iter().copied()).collect::<Vec<_>>());
    let curves = curves_in(&file);
    (curves, file, folder)
}

#[test]
fn strands_of_a_braid_touch_and_never_pass_through_each_other_on_any_head() {
    let test = "strands_of_a_braid_touch_and_never_pass_through_each_other_on_any_head";
    // Nodes of a groom, with their braids and the strands of each.
    let grooms: [(&str, &[(&str, u64, u64)]); 2] = [
        ("cornrows", &[("braid", 14, 3)]),
        ("braids", &[("braid_3", 4, 3), ("braid_4", 4, 4), ("braid_5", 4, 5), ("braid_6", 4, 6)]),
    ];
    on_every_head(test, |head, scalp| {
        for (graph, nodes) in grooms {
            let sockets: Vec<String> =
                nodes.iter().map(|(node, ..)| format!("{node}.curves")).collect();
            let outputs: Vec<&str> = sockets.iter().map(String::as_str).collect();
            let (_, file, _folder) = written(graph, &outputs, scalp);
            let ran = run(["measure".as_ref(), file.as_os_str(), "--json".as_ref()]);
            let measured: Json = serde_json::from_str(&ran.out).unwrap();
            for (node, braids, strands) in nodes {
                let mut prims = measured.as_array().unwrap().iter();
                let of_node = |prim: &&Json| prim["path"].as_str().unwrap().ends_with(node);
                let found = &prims.find(of_node).expect("a prim of its own")["braids"];
                assert_eq!(found["braids"], *braids, "{graph} {node} on {head}");
                assert_eq!(found["strands"], braids * strands, "{graph} {node} on {head}");
                let overlap = found["worst_overlap"].as_f64().unwrap();
                assert!((0.9..=1.02).contains(&overlap), "{graph} {node} on {head}: {overlap}");
            }
        }
    });
}

#[test]
fn guides_of_a_puff_end_on_one_sphere_on_any_head() {
    on_every_head("guides_of_a_puff_end_on_one_sphere_on_any_head", |head, scalp| {
        let (curves, _, _folder) = written("puffs", &["left.guides"], scalp);
        let mut first = 0;
        let tips: Vec<DVec3> = curves[0]
            .counts
            .iter()
            .map(|count| {
                first += *count as usize;
                curves[0].points[first - 1].as_dvec3()
            })
            .collect();
        assert_eq!(tips.len(), 96, "{head}");
        let (centre, radius) = sphere(&tips);
        let worst =
            tips.iter().map(|tip| (tip.distance(centre) / radius - 1.0).abs()).fold(0.0, f64::max);
        assert!(worst < 1e-4, "{head}: {worst:e} of a radius of {radius}");
    });
}

/// The sphere nearest to points: |p|^2 = 2 c.p + k, by least squares about their mean.
fn sphere(points: &[DVec3]) -> (DVec3, f64) {
    let n = points.len() as f64;
    let mean = points.iter().copied().sum::<DVec3>() / n;
    let mut normal = glam::DMat3::ZERO;
    let mut right = DVec3::ZERO;
    for p in points.iter().map(|p| *p - mean) {
        normal += glam::DMat3::from_cols(p * p.x, p * p.y, p * p.z);
        right += p * (0.5 * p.length_squared());
    }
    let centre = mean + normal.inverse() * right;
    let radius = points.iter().map(|p| p.distance(centre)).sum::<f64>() / n;
    (centre, radius)
}

/// A length grows with the head once, whether it is typed, read from an attribute or a product of both: `twists` are as wide as 2.2
/// times the radius of what they follow.
#[test]
fn a_larger_head_has_larger_hair() {
    let test = "a_larger_head_has_larger_hair";
    let Some(head) = smooth_heads(test).find(|head| head.name == "sintel") else { return };
    let on = |graph: &str, outputs: &[&str], scale: f32| {
        let scale = format!("head.scale={scale}");
        let sized = ["--quality", "preview", "--set", "head.units=custom", "--set", &scale];
        written(graph, outputs, &[&head.eval_args()[..], &sized].concat())
    };
    let [small, large] = [100.0, 120.0].map(|scale| on("clusters", &["hair.curves"], scale).0);
    let hairs = |all: &[ReadCurves]| -> Vec<Vec<glam::Vec3>> {
        let mut from = 0;
        let mut hair = |count: &u32| {
            from += *count as usize;
            all[0].points[from - *count as usize..from].to_vec()
        };
        all[0].counts.iter().map(&mut hair).collect()
    };
    let [small, large] = [hairs(&small), hairs(&large)];
    // By their roots: export may leave out one hair in a thousand, or give it more points.
    let mut off: Vec<f32> = vec![];
    for hair in small.iter().step_by(10) {
        let far = |other: &&Vec<glam::Vec3>| other[0].distance_squared(hair[0] * 1.2);
        let same = large.iter().min_by(|a, b| far(a).total_cmp(&far(b))).unwrap();
        off.extend(hair.iter().zip(same).map(|(a, b)| (*a * 1.2).distance(*b)));
    }
    off.sort_by(f32::total_cmp);
    // (At the ears some take the other way round, and the skin's cells are of one size.)
    let most = off[off.len() * 3 / 4];
    assert!(most < 1e-3, "{most}");
    let stitches = |scale| {
        let (_, file, _folder) = on("twists", &["out.curves"], scale);
        let ran = run(["measure".as_ref(), file.as_os_str(), "--json".as_ref()]);
        let measured: Json = serde_json::from_str(&ran.out).unwrap();
        measured[0]["braids"]["kinds"][0]["stitches"][1].as_f64().unwrap()
    };
    let (small, large) = (stitches(100.0), stitches(120.0));
    assert!((large / small - 1.0).abs() < 0.1, "{small} and {large} stitches a twist");
}

#[test]
fn more_density_only_adds_strands_and_the_rest_keeps_its_ids() {
    let ids = |count: &str| {
        let folder = Folder::new(&format!("laws-density-{count}"));
        let file = folder.path("hair.usda");
        let out = file.display().to_string();
        let set = format!("hair.count={count}");
        eval("clusters", &["--output", "hair.curves", "--set", &set, "--out", &out]);
        let curves = curves_in(&file);
        let id = curves[0].primvars.iter().find(|p| p.name == "id").unwrap();
        match &id.values {
            coif_nodes::formats::usd::read::ReadValues::Int(ids) => {
                ids.iter().copied().collect::<std::collections::BTreeSet<i32>>()
            }
            other => panic!("{other:?}"),
        }
    };
    let (few, many) = (ids("20"), ids("40"));
    assert_eq!((few.len(), many.len()), (4600, 9200));
    assert!(few.is_subset(&many));
}
