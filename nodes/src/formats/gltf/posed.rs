//! Small files with skins and morph targets, each with the places that its vertices have by hand.

use super::read;
use std::sync::Arc;

/// The numbers of a file: what was added to it is accessor 0, 1, 2 and so on, each with a view.
#[derive(Default)]
struct Numbers {
    bytes: Vec<u8>,
    accessors: Vec<String>,
    views: Vec<String>,
}

impl Numbers {
    fn add(mut self, kind: &str, component: u32, count: usize, bytes: &[u8]) -> Self {
        let (at, length, view) = (self.bytes.len(), bytes.len(), self.views.len());
        self.bytes.extend(bytes);
        self.views.push(format!(r#"{{"buffer":0,"byteOffset":{at},"byteLength":{length}}}"#));
        self.accessors.push(format!(
            r#"{{"bufferView":{view},"componentType":{component},"type":{kind},"count":{count}}}"#
        ));
        self
    }

    fn floats<const N: usize>(self, kind: &str, rows: &[[f32; N]]) -> Self {
        let bytes: Vec<u8> = rows.iter().flatten().flat_map(|x| x.to_le_bytes()).collect();
        self.add(&format!("\"{kind}\""), 5126, rows.len(), &bytes)
    }

    /// Bytes, which may count as shares of the largest.
    fn bytes<const N: usize>(self, kind: &str, shares: bool, rows: &[[u8; N]]) -> Self {
        let kind = format!("\"{kind}\",\"normalized\":{shares}");
        self.add(&kind, 5121, rows.len(), &rows.concat())
    }

    fn shorts<const N: usize>(self, kind: &str, shares: bool, rows: &[[i16; N]]) -> Self {
        let bytes: Vec<u8> = rows.iter().flatten().flat_map(|x| x.to_le_bytes()).collect();
        self.add(&format!("\"{kind}\",\"normalized\":{shares}"), 5122, rows.len(), &bytes)
    }

    fn json(&self, rest: &str) -> String {
        let (accessors, views, n) =
            (self.accessors.join(","), self.views.join(","), self.bytes.len());
        format!(
            r#"{{"asset":{{"version":"2.0"}},"buffers":[{{"uri":"a.bin","byteLength":{n}}}],
            "bufferViews":[{views}],"accessors":[{accessors}],{rest}}}"#
        )
    }
}

/// Points, triangles and notes, or the error.
fn told(numbers: &Numbers, rest: &str) -> String {
    let side: Arc<[u8]> = Arc::from(numbers.bytes.clone());
    let mesh = match read(numbers.json(rest).as_bytes(), &|_| Some(side.clone())) {
        Ok(mesh) => mesh,
        Err(e) => return e.to_string(),
    };
    mesh.check().unwrap();
    // Places to a millionth: sines and cosines of quarter turns are not whole in files.
    let tidy = |x: f32| (x * 1e6).round() / 1e6 + 0.0;
    let points: Vec<_> = mesh.points.iter().map(|p| p.to_array().map(tidy)).collect();
    let notes = mesh.notes.iter().map(|note| format!("\nnote: {note}")).collect::<String>();
    format!("{points:?} {:?}{notes}", mesh.triangles)
}

#[track_caller]
fn check(numbers: &Numbers, rest: &str, expected: &[&str]) {
    assert_eq!(told(numbers, rest), expected.join("\n"));
}

const HELD: &str = "note: 1 primitives are held by a skin, in the pose that the file is in";
const MORPHED: &str = "note: 1 primitives are morphed as far as the file says";

const CORNERS: [[f32; 3]; 3] = [[1., 0., 0.], [0., 2., 0.], [0., 0., 3.]];

/// A triangle: positions 0, joints 1, weights 2. The first vertex hangs on joint 0, the second to a
/// quarter on it and to three on joint 1, the third on joint 1.
fn triangle() -> Numbers {
    Numbers::default()
        .floats("VEC3", &CORNERS)
        .bytes("VEC4", false, &[[0, 1, 9, 0], [0, 1, 0, 0], [0, 1, 0, 0]])
        .floats("VEC4", &[[1., 0., 0., 0.], [0.25, 0.75, 0., 0.], [0., 1., 0., 0.]])
}

const SKINNED: &str =
    r#""meshes":[{"primitives":[{"attributes":{"POSITION":0,"JOINTS_0":1,"WEIGHTS_0":2}}]}]"#;

fn matrix(scale: f32, origin: [f32; 3]) -> [f32; 16] {
    let [x, y, z] = origin;
    [scale, 0., 0., 0., 0., scale, 0., 0., 0., 0., scale, 0., x, y, z, 1.]
}

#[test]
fn joints_place_what_they_hold_and_the_node_of_the_mesh_does_not() {
    // A quarter turn that lays z up to y up, (x, y, z) to (x, z, -y), and centimetres to metres.
    let nodes = r#""nodes":[{"rotation":[-0.7071067811865476,0,0,0.7071067811865476],
        "scale":[0.01,0.01,0.01],"children":[1,2]},{},{"translation":[0,0,100]},
        {"mesh":0,"skin":0,"scale":[7,7,7],"translation":[9,9,9]}],
        "skins":[{"joints":[1,2],"skeleton":99}],"scenes":[{"nodes":[3]}]"#;
    // Joint 1 stands 1 m up, so three quarters of it lift the second vertex by 0.75 m.
    check(
        &triangle(),
        &format!("{SKINNED},{nodes}"),
        &["[[0.01, 0.0, 0.0], [0.0, 0.75, -0.02], [0.0, 1.03, 0.0]] [[0, 1, 2]]", HELD],
    );
}

#[test]
fn inverse_bind_matrices_come_before_the_pose_of_the_joints() {
    // Joint 1 was bound at (0, 10, 0) and has been moved to (5, 10, 0): what hangs on it moves by 5.
    let numbers =
        triangle().floats("MAT4", &[matrix(1., [0.; 3]), matrix(1., [0., -10., 0.]), [0.; 16]]);
    let rest = format!(
        r#"{SKINNED},"nodes":[{{"children":[1]}},{{"translation":[5,10,0]}},{{"mesh":0,"skin":0}}],
        "skins":[{{"joints":[0,1],"inverseBindMatrices":3}}]"#
    );
    let note = "note: no scene shows a mesh: all nodes were read";
    let points = "[[1.0, 0.0, 0.0], [3.75, 2.0, 0.0], [5.0, 0.0, 3.0]] [[0, 1, 2]]";
    check(&numbers, &rest, &[points, note, HELD]);
}

#[test]
fn quantized_positions_find_their_size_in_the_inverse_bind_matrix_or_the_node() {
    // 32767 and -32767 are 1 and -1; so is -32768.
    let mut numbers = Numbers::default()
        .shorts("VEC3", true, &[[32767, 0, 0, 0], [0, -32768, 0, 0], [0, 0, -32767, 0]])
        .bytes("VEC4", false, &[[0; 4]; 3])
        .bytes("VEC4", true, &[[255, 0, 0, 0]; 3])
        .floats("MAT4", &[matrix(0.5, [1., 2., 3.])]);
    numbers.views[0] = numbers.views[0].replace('}', ",\"byteStride\":8}");
    let rest = format!(
        r#"{SKINNED},"nodes":[{{"translation":[0,0,1]}},{{"mesh":0,"skin":0,"scale":[3,3,3]}}],
        "skins":[{{"joints":[0],"inverseBindMatrices":3}}],"scenes":[{{"nodes":[0,1]}}],
        "extensionsRequired":["KHR_mesh_quantization"]"#
    );
    check(
        &numbers,
        &rest,
        &["[[1.5, 2.0, 4.0], [1.0, 1.5, 4.0], [1.0, 2.0, 3.5]] [[0, 1, 2]]", HELD],
    );
    // Bytes as they are: 200 of a hundredth each are 2.
    let numbers = Numbers::default().bytes("VEC3", false, &[[200, 0, 0], [0, 100, 0], [0, 0, 255]]);
    let rest = r#""meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],
        "nodes":[{"mesh":0,"scale":[0.01,0.01,0.01]}],"scenes":[{"nodes":[0]}]"#;
    check(&numbers, rest, &["[[2.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 2.55]] [[0, 1, 2]]"]);
}

#[test]
fn more_than_four_joints_hold_a_vertex() {
    // Five joints of a fifth each (51 of 255) stand 1, 2, 3, 4 and 5 along x: their mean is 3.
    let joints: String = (1..=5).map(|x| format!(",{{\"translation\":[{x},0,0]}}")).collect();
    let mut numbers = Numbers::default()
        .floats("VEC3", &CORNERS)
        .bytes("VEC4", false, &[[0, 1, 2, 3]; 3])
        .bytes("VEC4", true, &[[51; 4]; 3])
        .shorts("VEC4", false, &[[4, 0, 0, 0]; 3])
        .bytes("VEC4", false, &[[51, 0, 0, 0]; 3]);
    numbers.accessors[3] = numbers.accessors[3].replace("5122", "5123");
    let rest = format!(
        r#""meshes":[{{"primitives":[{{"attributes":{{"POSITION":0,"JOINTS_0":1,"WEIGHTS_0":2,
        "JOINTS_1":3,"WEIGHTS_1":4}}}}]}}],"nodes":[{{"mesh":0,"skin":0}}{joints}],
        "skins":[{{"joints":[1,2,3,4,5]}}],"scenes":[{{"nodes":[0]}}]"#
    );
    let points = "[[4.0, 0.0, 0.0], [3.0, 2.0, 0.0], [3.0, 0.0, 3.0]] [[0, 1, 2]]";
    check(&numbers, &rest, &[points, HELD]);
}

#[test]
fn a_mirrored_skeleton_keeps_outside_outside() {
    let rest = |scales: [i32; 2]| {
        let [a, b] = scales.map(|x| format!("{{\"scale\":[{x},1,1]}}"));
        format!(
            r#"{SKINNED},"nodes":[{{"mesh":0,"skin":0,"scale":[-1,1,1]}},{a},{b}],
            "skins":[{{"joints":[1,2]}}],"scenes":[{{"nodes":[0]}}]"#
        )
    };
    let points = |x: &str| format!("[[{x}, 0.0, 0.0], [0.0, 2.0, 0.0], [0.0, 0.0, 3.0]]");
    // The node of the mesh mirrors nothing, both joints mirror all three corners.
    check(&triangle(), &rest([1, 1]), &[&format!("{} [[0, 1, 2]]", points("1.0")), HELD]);
    check(&triangle(), &rest([-1, -1]), &[&format!("{} [[0, 2, 1]]", points("-1.0")), HELD]);
    // Of the second corner x is scaled by 0.25 - 0.75 = -0.5: with the third, two of three are
    // mirrored; or by 0.75 - 0.25, and only the first is.
    check(&triangle(), &rest([1, -1]), &[&format!("{} [[0, 2, 1]]", points("1.0")), HELD]);
    check(&triangle(), &rest([-1, 1]), &[&format!("{} [[0, 1, 2]]", points("-1.0")), HELD]);
}

#[test]
fn few_corners_of_a_long_list_find_their_own_joints() {
    // Three corners of four vertices, from the last to the second: each corner is a point then. Joint 1
    // mirrors what hangs on it, vertices 1 and 2, and joint 0 moves vertex 3 by 10.
    let numbers = Numbers::default()
        .floats("VEC3", &[[9.; 3], [1., 0., 0.], [2., 2., 0.], [0., 0., 3.]])
        .bytes("VEC4", false, &[[7; 4], [1, 0, 0, 0], [1, 0, 0, 0], [0; 4]])
        .bytes("VEC4", true, &[[255, 0, 0, 0]; 4])
        .bytes("SCALAR", false, &[[3], [2], [1]])
        .floats("VEC3", &[[5.; 3], [0., 1., 0.], [0.; 3], [0.; 3]]);
    let rest = r#""meshes":[{"primitives":[{"attributes":{"POSITION":0,"JOINTS_0":1,"WEIGHTS_0":2},
        "indices":3,"targets":[{"POSITION":4}]}],"weights":[2]}],"nodes":[{"mesh":0,"skin":0},
        {"translation":[10,0,0]},{"scale":[-1,1,1]}],"skins":[{"joints":[1,2]}],
        "scenes":[{"nodes":[0]}]"#;
    let points = "[[10.0, 0.0, 3.0], [-2.0, 2.0, 0.0], [-1.0, 2.0, 0.0]] [[0, 2, 1]]";
    check(&numbers, rest, &[points, HELD, MORPHED]);
}

#[test]
fn one_mesh_in_two_skins_is_two_meshes() {
    let rest = format!(
        r#"{SKINNED},"nodes":[{{"name":"a","mesh":0,"skin":0}},{{"name":"b","mesh":0,"skin":1}},
        {{"translation":[10,0,0]}},{{"translation":[0,0,0]}}],
        "skins":[{{"joints":[2,2]}},{{"joints":[3,3]}}],"scenes":[{{"nodes":[0,1]}}]"#
    );
    check(
        &triangle(),
        &rest,
        &[
            "[[11.0, 0.0, 0.0], [10.0, 2.0, 0.0], [10.0, 0.0, 3.0], [1.0, 0.0, 0.0], \
             [0.0, 2.0, 0.0], [0.0, 0.0, 3.0]] [[0, 1, 2], [3, 4, 5]]",
            &HELD.replace('1', "2"),
        ],
    );
}

#[test]
fn weights_are_shares_whatever_they_sum_to() {
    let weights = |rows: [[f32; 4]; 3]| {
        Numbers::default()
            .floats("VEC3", &CORNERS)
            .bytes("VEC4", false, &[[0, 1, 0, 0]; 3])
            .floats("VEC4", &rows)
    };
    let rest = format!(
        r#"{SKINNED},"nodes":[{{"mesh":0,"skin":0}},{{"translation":[0,0,1]}},
        {{"translation":[0,0,5]}}],"skins":[{{"joints":[1,2]}}],"scenes":[{{"nodes":[0]}}]"#
    );
    // 1 to 3 of 4 is 1 + 3/4 * 4 = 4; below 0 counts as 0, so all of joint 0; nothing is joint 0 too.
    check(
        &weights([[0.5, 1.5, 0., 0.], [1., -1., 0., 0.], [0.; 4]]),
        &rest,
        &[
            "[[1.0, 0.0, 4.0], [0.0, 2.0, 1.0], [0.0, 0.0, 4.0]] [[0, 1, 2]]",
            HELD,
            "note: 1 vertices have no weights in their skin and follow their first joint",
            "note: 2 vertices have weights in their skin that do not sum to 1: scaled",
        ],
    );
    // What rounding does is not told: 0.99 for 1.
    check(
        &weights([[0.99, 0., 0., 0.], [0., 0.99, 0., 0.], [0., 1., 0., 0.]]),
        &rest,
        &["[[1.0, 0.0, 1.0], [0.0, 2.0, 5.0], [0.0, 0.0, 8.0]] [[0, 1, 2]]", HELD],
    );
}

#[test]
fn a_primitive_without_joints_stands_where_its_node_does() {
    let rest = r#""meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],
        "nodes":[{"mesh":0,"skin":0,"translation":[0,0,7]},{"translation":[9,9,9]}],
        "skins":[{"joints":[1]}],"scenes":[{"nodes":[0]}]"#;
    let note = "note: 1 primitives have no joints for their skin: their nodes place them";
    let points = "[[1.0, 0.0, 7.0], [0.0, 2.0, 7.0], [0.0, 0.0, 10.0]] [[0, 1, 2]]";
    check(&triangle(), rest, &[points, note]);
}

#[test]
fn morph_targets_move_vertices_by_the_weights_of_node_or_mesh() {
    // Target 1 lifts the first vertex by 4, target 2 moves all by 127 of 127 in x, the third none.
    let numbers = Numbers::default()
        .floats("VEC3", &CORNERS)
        .floats("VEC3", &[[0., 0., 4.], [0.; 3], [0.; 3]])
        .add("\"VEC3\",\"normalized\":true", 5120, 3, &[127, 0, 0, 127, 0, 0, 127, 0, 0]);
    let rest = |mesh: &str, node: &str| {
        format!(
            r#""meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}},
            "targets":[{{"POSITION":1}},{{"POSITION":2}},{{"NORMAL":7}}]}}]{mesh}}}],
            "nodes":[{{"mesh":0{node}}}],"scenes":[{{"nodes":[0]}}]"#
        )
    };
    let told = |mesh, node, expected: &[&str]| check(&numbers, &rest(mesh, node), expected);
    let as_it_is = "[[1.0, 0.0, 0.0], [0.0, 2.0, 0.0], [0.0, 0.0, 3.0]] [[0, 1, 2]]";
    told("", "", &[as_it_is]);
    told(r#","weights":[0,0,1]"#, "", &[as_it_is]);
    // Half of 4 is 2; minus a half of 1 is 0.5 back.
    let moved = "[[0.5, 0.0, 2.0], [-0.5, 2.0, 0.0], [-0.5, 0.0, 3.0]] [[0, 1, 2]]";
    told(r#","weights":[0.5,-0.5,0]"#, "", &[moved, MORPHED]);
    told(r#","weights":[9,9,9]"#, r#","weights":[0.5,-0.5,0]"#, &[moved, MORPHED]);
    let uneven = "note: 1 primitives have more morph targets or fewer than weights";
    told(r#","weights":[0.5,-0.5]"#, "", &[moved, MORPHED, uneven]);
    told("", r#","weights":["a"]"#, &["nodes[0].weights[0]: \"a\" is no number"]);
    // Without a node the weights of the mesh count.
    let rest = rest(r#","weights":[0.5,-0.5,0]"#, "").replace("\"nodes\"", "\"x\"");
    let note = "note: no node shows a mesh: all meshes were read as they lie";
    let rest = rest.replace("\"scenes\"", "\"y\"");
    check(&numbers, &rest, &[moved, note, MORPHED]);
}

#[test]
fn sparse_targets_move_before_the_skin_does() {
    // The target moves the second vertex alone, by (0, 1, 0); the joint then makes all twice as large.
    let mut numbers = Numbers::default()
        .floats("VEC3", &CORNERS)
        .bytes("VEC4", false, &[[0; 4]; 3])
        .floats("VEC4", &[[1., 0., 0., 0.]; 3])
        .bytes("SCALAR", false, &[[1]])
        .floats("VEC3", &[[0., 1., 0.]]);
    numbers.accessors.push(
        r#"{"componentType":5126,"type":"VEC3","count":3,"sparse":{"count":1,
            "indices":{"bufferView":3,"componentType":5121},"values":{"bufferView":4}}}"#
            .to_owned(),
    );
    let rest = r#""meshes":[{"weights":[1],"primitives":[{"attributes":{"POSITION":0,"JOINTS_0":1,
        "WEIGHTS_0":2},"targets":[{"POSITION":5}]}]}],"nodes":[{"mesh":0,"skin":0},
        {"scale":[2,2,2]}],"skins":[{"joints":[1]}],"scenes":[{"nodes":[0]}]"#;
    let points = "[[2.0, 0.0, 0.0], [0.0, 6.0, 0.0], [0.0, 0.0, 6.0]] [[0, 1, 2]]";
    check(&numbers, rest, &[points, HELD, MORPHED]);
}

#[test]
fn broken_skins_are_refused_with_their_element() {
    let nodes = r#""nodes":[{"mesh":0,"skin":0},{"children":[2]},{}],"scenes":[{"nodes":[0,1]}]"#;
    let joints = r#""skins":[{"joints":[1,2]}]"#;
    let with = |skins: &str, nodes: &str| format!("{SKINNED},{skins},{nodes}");
    let bound = |skin: &str| with(&format!("\"skins\":[{skin}]"), nodes);
    let (one, nan) = (matrix(1., [0.; 3]), [f32::NAN; 16]);
    let mut last_row = one;
    last_row[15] = 2.0;
    let two = r#"{"joints":[1,2],"inverseBindMatrices":3}"#;
    let matrices = |all: &[[f32; 16]]| triangle().floats("MAT4", all);
    let place = "skins[0].inverseBindMatrices";
    for (numbers, rest, says) in [
        (triangle(), with("\"x\":0", nodes), "nodes[0]: it names skins[0], where there are 0".into()),
        (
            triangle(),
            bound("{}"),
            "skins[0].joints: there are none: export the mesh with its skeleton, or without a skin"
                .into(),
        ),
        (
            triangle(),
            bound(r#"{"joints":[1,9]}"#),
            "skins[0].joints[1]: it names nodes[9], where there are 3".into(),
        ),
        (
            triangle(),
            bound(r#"{"joints":[1,"a"]}"#),
            "skins[0].joints[1]: \"a\" is no index of a node".into(),
        ),
        (
            triangle(),
            bound(r#"{"joints":[1]}"#),
            "accessors[1]: element 1 names joint 1, where skins[0] has 1: export the mesh with its \
             whole skeleton"
                .into(),
        ),
        (triangle(), bound(&two.replace('3', "8")), format!("{place}: it names accessors[8], where there are 3")),
        (triangle(), bound(&two.replace('3', "2")), format!("{place}: accessors[2] holds no 4 x 4 matrices of floats")),
        (matrices(&[one]), bound(two), format!("{place}: 1 matrices, where there are 2 joints: export the skin again")),
        (matrices(&[one, nan]), bound(two), format!("{place}: matrix 1 has a number that is not finite: export the skin again")),
        (matrices(&[one, [0.; 16]]), bound(two), format!("{place}: matrix 1 is all zeros: export the skin again")),
        (
            matrices(&[one, last_row]),
            bound(two),
            format!("{place}: matrix 1 does not end in the row 0, 0, 0, 1: export the skin again"),
        ),
        (
            triangle(),
            with(joints, &nodes.replace("[2]},{}", "[2]},{\"children\":[1]}").replace("[0,1]", "[0]")),
            "nodes[1]: it lies in itself or in more than 1024 nodes".into(),
        ),
        (
            triangle(),
            with(joints, &nodes.replace("[2]", "[2,2]").replace("[0,1]", "[0]")),
            "nodes[2]: it lies in two nodes, or twice in one".into(),
        ),
        (
            triangle(),
            with(joints, &nodes.replace("{}]", "{\"translation\":[1e39,0,0]}]")),
            "accessors[0]: element 1 is not at a finite place in nodes[0] by skins[0]".into(),
        ),
        (
            triangle(),
            with(joints, nodes).replace("\"WEIGHTS_0\":2", "\"WEIGHTS_1\":2"),
            "meshes[0].primitives[0]: it has JOINTS_0 without WEIGHTS_0".into(),
        ),
        (
            triangle(),
            with(joints, nodes).replace("\"JOINTS_0\":1", "\"JOINTS_0\":2"),
            "accessors[2]: its numbers are of no kind that joints come in".into(),
        ),
        (
            triangle().floats("VEC4", &[[f32::INFINITY, 0., 0., 0.]; 3]),
            with(joints, nodes).replace("\"WEIGHTS_0\":2", "\"WEIGHTS_0\":3"),
            "accessors[3]: element 0 has a weight that is not a finite number".into(),
        ),
        (
            triangle().floats("VEC4", &[[1.; 4]; 2]),
            with(joints, nodes).replace("\"WEIGHTS_0\":2", "\"WEIGHTS_0\":3"),
            "accessors[3]: 2 elements, where there are 3 positions".into(),
        ),
    ] {
        assert_eq!(told(&numbers, &rest), says);
    }
    // A joint that holds nothing may be broken.
    let spare = format!("{SKINNED},\"skins\":[{}],{nodes}", two.replace("[1,2]", "[1,2,2]"));
    let fine = told(&matrices(&[one, one, nan]), &spare);
    assert!(fine.starts_with("[[1.0, 0.0, 0.0]"), "{fine}");
}
