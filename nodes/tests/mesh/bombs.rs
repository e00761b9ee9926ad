//! Small files that name huge meshes, and large files of almost nothing: each is read or refused
//! within the limits, which [`read`] tests.

use crate::measure::read;
use expect_test::{Expect, expect};

/// Bytes of the larger files: enough for 20 times their size to be more than the fixed allowance.
const LARGE: usize = 8 << 20;

#[track_caller]
fn check(extension: &str, bytes: &[u8], expected: Expect) {
    let read = read("a bomb", extension, bytes, &|_| None);
    let told = match &read.result {
        Ok(mesh) => format!("{} triangles", mesh.triangles.len()),
        Err(e) => e.to_string(),
    };
    let per_byte = read.work.held as f64 / read.file_bytes as f64;
    println!(
        "asked {} times, {per_byte:.1} bytes for each of {}: {told}",
        read.work.asked, read.file_bytes
    );
    expected.assert_eq(&told);
}

/// As many repetitions of a text as fit.
fn many(start: &str, text: &str, end: &str) -> Vec<u8> {
    format!("{start}{}{end}", text.repeat(LARGE / text.len())).into_bytes()
}

const THREE: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";

#[test]
fn obj_files_of_one_thing_only() {
    check("obj", &many(THREE, "f 1 2 3\n", ""), expect!["1048576 triangles"]);
    check("obj", &many(THREE, "v 0 0 0\n", "f 1 2 3"), expect!["1 triangles"]);
    check("obj", &many(THREE, "v 0 0 0 1 1 1\n", "f 1 2 3"), expect!["1 triangles"]);
    check("obj", &many(THREE, "vt 0\n", "f 1/1 2/1 3/1"), expect!["1 triangles"]);
    check("obj", &many(THREE, "g a\nf 1 2 3\n", ""), expect!["699050 triangles"]);
    check("obj", &many(THREE, "\n", "f 1 2 3"), expect!["1 triangles"]);
    check("obj", &many(THREE, "\\\n", "f 1 2 3"), expect!["1 triangles"]);
    check("obj", &many(THREE, "x", ""), expect!["file: no triangles: 3 vertices and no faces"]);
    check("obj", &many(THREE, "f\n", "f 1 2 3"), expect!["1 triangles"]);
}

#[test]
fn obj_files_of_large_polygons() {
    check("obj", &many(THREE, " 1", ""), expect!["file: no triangles: 3 vertices and no faces"]);
    check(
        "obj",
        &many(&format!("{THREE}f"), " 1", ""),
        expect!["line 4: a face of more than 65536 corners"],
    );
    let polygon = format!("f{}\n", " 1 2 3".repeat(20_000));
    check(
        "obj",
        &many(&format!("{THREE}vt 0\nf 1/1 2/1 3/1\n"), &polygon, ""),
        expect![
            "file: reading this takes 260 MiB of memory, where a file of this size may take 221"
        ],
    );
    // Every second corner of a comb is an ear, and every ear has to look at all others.
    let mut comb: String = (0..60_000)
        .map(|i| format!("v {i} {} 0\n", if i % 2 == 0 { 0 } else { 1 + i % 7 }))
        .collect();
    comb += "v 60000 -1 0\nv 0 -1 0\n";
    let face: String = (1..=60_002).map(|i| format!(" {i}")).collect();
    check(
        "obj",
        format!("{comb}f{face}\nf{face}\nf{face}\n").as_bytes(),
        expect!["180000 triangles"],
    );
}

#[test]
fn obj_files_of_names() {
    let names: String = (0..700_000).map(|i| format!("g {i}\nf 1 2 3\n")).collect();
    check("obj", format!("{THREE}{names}").as_bytes(), expect!["700000 triangles"]);
}

fn gltf(rest: &str) -> Vec<u8> {
    format!(r#"{{"asset":{{"version":"2.0"}},{rest}}}"#).into_bytes()
}

const ZEROS: &str = r#""accessors":[{"componentType":5126,"type":"VEC3","count":30000}],
    "meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}]"#;

#[test]
fn gltf_files_of_empty_things() {
    for item in ["{},", "0,", "[],", "\"\",", "\"\\n\","] {
        let start = format!(r#"{{"asset":{{"version":"2.0"}},{ZEROS},"nodes":["#);
        let bytes = many(&start, item, "{}]}");
        let read = read("empty things", "gltf", &bytes, &|_| None);
        println!("{item} {} {}", read.work.asked, read.work.held as f64 / read.file_bytes as f64);
        assert_eq!(read.result.is_ok(), item == "{},", "{:?}", read.result.err());
    }
    check(
        "gltf",
        &many("{\"a\":\"", "\\n", "\"}"),
        expect!["asset.version: it is missing: this is not glTF 2.0"],
    );
    check(
        "gltf",
        &many("", "[", ""),
        expect!["line 1 column 128: this is not JSON: recursion limit exceeded"],
    );
}

#[test]
fn gltf_files_that_repeat_a_mesh() {
    let start = gltf(ZEROS);
    let start = std::str::from_utf8(&start).unwrap().strip_suffix('}').unwrap();
    let bytes = many(&format!("{start},\"nodes\":["), "{\"mesh\":0},", "{}]}");
    check(
        "gltf",
        &bytes,
        expect!["nodes[143165]: more than four thousand million vertices or triangles"],
    );
    let zeros = r#""accessors":[{"componentType":5126,"type":"VEC3","count":4e9},
        {"componentType":5121,"type":"SCALAR","count":300}],"meshes":[{"primitives":["#;
    let primitive = r#"{"attributes":{"POSITION":0},"indices":1},"#;
    let start = format!(r#"{{"asset":{{"version":"2.0"}},{zeros}"#);
    check(
        "gltf",
        &many(&start, primitive, "{}]}]}"),
        expect![
            "file: reading this takes 1873 MiB of memory, where a file of this size may take 224"
        ],
    );
}

#[test]
fn gltf_files_that_make_us_look_things_up() {
    // Many nodes show a mesh of many primitives, none of which has a triangle.
    let half = LARGE / 2;
    let primitives = r#"{"mode":1},"#.repeat(half / 11);
    let nodes = r#"{"mesh":0},"#.repeat(half / 11);
    let rest = format!(r#""meshes":[{{"primitives":[{primitives}{{}}]}}],"nodes":[{nodes}{{}}]"#);
    check("gltf", &gltf(&rest), expect!["JSON: its references are too many to follow"]);
    // Many primitives refer to an accessor of many keys.
    let keys = r#""a":0,"#.repeat(half / 6);
    let primitives = r#"{"attributes":{"POSITION":0}},"#.repeat(half / 30);
    let rest = format!(
        r#""accessors":[{{{keys}"componentType":5126,"type":"VEC3","count":3}}],
           "meshes":[{{"primitives":[{primitives}{{}}]}}]"#
    );
    check("gltf", &gltf(&rest), expect!["JSON: its references are too many to follow"]);
    // Nodes in nodes.
    let nodes: String = (1..200_000).map(|i| format!("{{\"children\":[{i}]}},")).collect();
    check(
        "gltf",
        &gltf(&format!(r#"{ZEROS},"nodes":[{nodes}{{"mesh":0}}]"#)),
        expect!["nodes[1024]: it lies in more than 1024 nodes"],
    );
}

#[test]
fn gltf_files_that_move_vertices_over_and_over() {
    // Each of many targets moves all vertices of a mesh that takes no bytes.
    let zeros = r#"{"componentType":5126,"type":"VEC3","count":1200000}"#;
    let sparse = r#"{"componentType":5126,"type":"VEC3","count":1200000,"sparse":{"count":1e6,
        "indices":{},"values":{}}}"#;
    let targets = |n: usize, accessor: &str| {
        let (targets, weights) = (r#"{"POSITION":1},"#.repeat(n), "1,".repeat(n));
        gltf(&format!(
            r#""accessors":[{zeros},{accessor}],"nodes":[{{"mesh":0}}],"meshes":[{{"primitives":[
            {{"attributes":{{"POSITION":0}},"targets":[{targets}{{}}]}}],"weights":[{weights}0]}}]"#
        ))
    };
    check("gltf", &targets(20, zeros), expect!["400000 triangles"]);
    let too_many = || {
        expect![
            "meshes[0].primitives[0]: its morph targets and joints move too many vertices in all: \
             export the mesh with them applied"
        ]
    };
    check("gltf", &targets(20_000, zeros), too_many());
    // Looking for a value in a sparse list takes twenty steps.
    check("gltf", &targets(20, sparse), too_many());
}

#[test]
fn gltf_files_of_joints() {
    let skinned = |sets: &str, rest: &str| {
        gltf(&format!(
            r#""accessors":[{{"componentType":5126,"type":"VEC3","count":3}},
            {{"componentType":5121,"type":"VEC4","count":3}},
            {{"componentType":5126,"type":"VEC4","count":3}}],
            "meshes":[{{"primitives":[{{"attributes":{{"POSITION":0{sets}}}}}]}}],{rest}"#
        ))
    };
    let one_set = r#","JOINTS_0":1,"WEIGHTS_0":2"#;
    // A skin of many joints, and many skins of one.
    let joints = "0,".repeat(LARGE / 8);
    check(
        "gltf",
        &skinned(
            one_set,
            &format!(r#""nodes":[{{"mesh":0,"skin":0}}],"skins":[{{"joints":[{joints}0]}}]"#),
        ),
        expect![
            "skins[0]: reading this takes 150 MiB of memory, where a file of this size may take 104"
        ],
    );
    let n = 40_000;
    let nodes: Vec<String> = (0..n).map(|i| format!("{{\"mesh\":0,\"skin\":{i}}}")).collect();
    let (skins, nodes) = (vec![r#"{"joints":[0]}"#; n].join(","), nodes.join(","));
    check(
        "gltf",
        &skinned(one_set, &format!(r#""nodes":[{nodes}],"skins":[{skins}]"#)),
        expect!["40000 triangles"],
    );
    // Joints that lie deep, and nodes beside them that are many.
    let deep: String = (1..1000).map(|i| format!("{{\"children\":[{i}]}},")).collect();
    let joints: String = (0..LARGE / 40).map(|i| format!("{},", i % 1000)).collect();
    let rest =
        format!(r#""nodes":[{deep}{{"mesh":0,"skin":0}}],"skins":[{{"joints":[{joints}0]}}]"#);
    check("gltf", &skinned(one_set, &rest), expect!["1 triangles"]);
    let nodes = "{},".repeat(LARGE / 12);
    let rest = format!(r#""nodes":[{nodes}{{"mesh":0,"skin":0}}],"skins":[{{"joints":[0]}}]"#);
    check("gltf", &skinned(one_set, &rest), expect!["1 triangles"]);
    // Very many joints a vertex.
    let sets: String =
        (0..LARGE / 128).map(|i| format!(",\"JOINTS_{i}\":1,\"WEIGHTS_{i}\":2")).collect();
    check(
        "gltf",
        &skinned(&sets, r#""nodes":[{"mesh":0,"skin":0}],"skins":[{"joints":[0]}]"#),
        expect!["meshes[0].primitives[0]: its vertices have more than 32 joints: export fewer"],
    );
}
