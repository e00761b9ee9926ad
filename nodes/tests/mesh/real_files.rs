//! Heads and animals by other people's programs, told in numbers.

use crate::measure::{read_file, shared};
use coif_nodes::data::mesh::Mesh;
use std::collections::BTreeMap;

/// Counts, and what they say of the shape.
fn told(mesh: &Mesh) -> String {
    let mut edges: BTreeMap<(u32, u32), usize> = BTreeMap::new();
    let flat =
        mesh.triangles.iter().filter(|t| t[0] == t[1] || t[1] == t[2] || t[2] == t[0]).count();
    for t in &mesh.triangles {
        for (a, b) in [(t[0], t[1]), (t[1], t[2]), (t[2], t[0])] {
            *edges.entry((a.min(b), a.max(b))).or_default() += 1;
        }
    }
    let open = edges.values().filter(|n| **n == 1).count();
    let crowded = edges.values().filter(|n| **n > 2).count();
    let euler = mesh.points.len() as i64 - edges.len() as i64 + mesh.triangles.len() as i64;
    let (low, high) = mesh
        .points
        .iter()
        .fold((mesh.points[0], mesh.points[0]), |(low, high), p| (low.min(*p), high.max(*p)));
    let size = (high - low).to_array().map(|x| (x * 1000.0).round() / 1000.0);
    format!(
        "{} points, {} triangles, euler {euler}, {open} open edges, {crowded} with three triangles \
         or more, {flat} folded; size {size:?}; uvs {}; materials {:?}; parts {:?}; masks {:?}; \
         notes {:?}",
        mesh.points.len(),
        mesh.triangles.len(),
        if mesh.uvs.is_some() { "yes" } else { "no" },
        mesh.materials,
        mesh.parts,
        mesh.masks.keys().collect::<Vec<_>>(),
        mesh.notes,
    )
}

#[test]
fn real_meshes_come_whole() {
    let Some(data) = shared("real_meshes_come_whole", "") else { return };
    let mut wrong = Vec::new();
    for (file, expected) in EXPECTED {
        let read = read_file(&data.join(file));
        let told = read.result.as_ref().map_or_else(ToString::to_string, told);
        println!(
            "{file}: asked {} times, {} bytes held for {} of the file: {:.1}\n    {told}",
            read.work.asked,
            read.work.held,
            read.file_bytes,
            read.work.held as f64 / read.file_bytes as f64,
        );
        if told != *expected {
            wrong.push(format!("{file}:\n    {told}\nwhere it was\n    {expected}"));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

const EXPECTED: &[(&str, &str)] = &[
    (
        "lps_head/LeePerrySmith.glb",
        "8839 points, 17684 triangles, euler 7, 0 open edges, 10 with three triangles or more, 6 folded; size [8.553, 7.947, 5.181]; uvs yes; materials [\"Material.002\"]; parts [\"LeePerrySmith\"]; masks []; notes []",
    ),
    (
        "lps_head/LeePerrySmith_draco.glb",
        "extensionsRequired: KHR_draco_mesh_compression is not read: export the mesh without it",
    ),
    (
        "ict_head/generic_neutral_mesh.obj",
        "26719 points, 52220 triangles, euler 89, 1040 open edges, 0 with three triangles or more, 0 folded; size [24.832, 33.813, 22.32]; uvs yes; materials [\"M_Face\", \"M_BackHead\", \"M_GumsTongue\", \"M_Teeth\", \"M_ScleraLeft\", \"M_IrisLeft\", \"M_ScleraRight\", \"M_IrisRight\", \"M_LacrimalFluid\", \"M_EyeBlend\", \"M_EyeOcclusion\", \"M_EyeLashes\"]; parts []; masks []; notes [\"345 vertices touch others and stay apart, as in the file\"]",
    ),
    (
        "sintel/sintel.obj",
        "3046 points, 5952 triangles, euler -4, 148 open edges, 0 with three triangles or more, 0 folded; size [0.395, 0.43, 0.22]; uvs yes; materials []; parts [\"GEO-body.unity\"]; masks []; notes []",
    ),
    (
        "sintel/sintel-collider.obj",
        "341 points, 678 triangles, euler 2, 0 open edges, 0 with three triangles or more, 0 folded; size [0.164, 0.323, 0.223]; uvs no; materials []; parts [\"Hair_collider_watertight\"]; masks []; notes []",
    ),
    (
        "sintel/sintel-eyelashes.obj",
        "144 points, 192 triangles, euler 4, 88 open edges, 0 with three triangles or more, 0 folded; size [0.121, 0.029, 0.028]; uvs yes; materials []; parts [\"eyelashes\"]; masks []; notes []",
    ),
    (
        "sintel/sintel-eyes.obj",
        "708 points, 1408 triangles, euler 4, 0 open edges, 0 with three triangles or more, 0 folded; size [0.116, 0.055, 0.054]; uvs yes; materials []; parts [\"GEO-eyeballs\"]; masks []; notes []",
    ),
    (
        "snowden_scan/snowden.obj",
        "54559 points, 109259 triangles, euler -4, 43 open edges, 88 with three triangles or more, 0 folded; size [6.416, 9.258, 5.205]; uvs no; materials []; parts []; masks []; notes []",
    ),
    (
        "rat/street_rat_4k.gltf",
        "28642 points, 57216 triangles, euler 4, 66 open edges, 6 with three triangles or more, 0 folded; size [0.032, 0.034, 0.148]; uvs yes; materials [\"street_rat\"]; parts [\"street_rat\"]; masks []; notes []",
    ),
    (
        "spot/spot_triangulated.obj",
        "2930 points, 5856 triangles, euler 2, 0 open edges, 0 with three triangles or more, 0 folded; size [0.943, 1.69, 1.718]; uvs yes; materials []; parts []; masks []; notes []",
    ),
    (
        "spot/spot_quadrangulated.obj",
        "2930 points, 5856 triangles, euler 2, 0 open edges, 0 with three triangles or more, 0 folded; size [0.943, 1.69, 1.718]; uvs yes; materials []; parts []; masks []; notes []",
    ),
    (
        "spot/spot_control_mesh.obj",
        "188 points, 372 triangles, euler 2, 0 open edges, 0 with three triangles or more, 0 folded; size [1.172, 1.743, 1.774]; uvs yes; materials []; parts []; masks []; notes []",
    ),
    (
        "reported/head_plain.glb",
        "6337 points, 12608 triangles, euler 96, 160 open edges, 97 with three triangles or more, 96 folded; size [0.184, 0.315, 0.213]; uvs no; materials []; parts [\"node 0\"]; masks []; notes []",
    ),
    (
        "reported/head_skinned_cm_zup.glb",
        "6337 points, 12608 triangles, euler 96, 160 open edges, 97 with three triangles or more, 96 folded; size [0.184, 0.315, 0.213]; uvs no; materials []; parts [\"node 2\"]; masks []; notes [\"1 primitives are held by a skin, in the pose that the file is in\"]",
    ),
    (
        "reported/head_skinned_quantized.glb",
        "6242 points, 12608 triangles, euler 192, 64 open edges, 194 with three triangles or more, 192 folded; size [0.184, 0.315, 0.213]; uvs no; materials []; parts [\"node 2\"]; masks []; notes [\"1 primitives are held by a skin, in the pose that the file is in\"]",
    ),
];
