//! Files made by others to break readers, with what we make of each.

use crate::measure::{files, read_file, shared};
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

/// Triangles, materials and parts, or the error.
fn verdict(path: &Path) -> String {
    match read_file(path).result {
        Err(e) => e.to_string(),
        Ok(mesh) => {
            let materials = mesh.materials.iter().map(|m| format!(" {m}")).collect::<String>();
            let parts = mesh.parts.iter().map(|p| format!(" {p}")).collect::<String>();
            format!("{}{materials} |{parts}", mesh.triangles.len())
        }
    }
}

/// Every file of a folder has its line, and every line its file.
#[track_caller]
fn check(test: &str, folder: &str, extensions: &[&str], expected: &[(&str, &str)]) {
    let Some(folder) = shared(test, folder) else { return };
    let mut left: BTreeMap<_, _> = expected.iter().copied().collect();
    let mut wrong = Vec::new();
    for path in files(&folder, extensions) {
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        let verdict = verdict(&path);
        if left.remove(name.as_str()) != Some(verdict.as_str()) {
            wrong.push(format!("        ({name:?}, {verdict:?}),"));
        }
    }
    assert!(wrong.is_empty() && left.is_empty(), "{}\nmissing: {left:?}", wrong.join("\n"));
}

#[test]
fn obj_files_of_tinyobj_load_or_say_why_not() {
    check(
        "obj_files_of_tinyobj_load_or_say_why_not",
        "bad/obj_tinyobj",
        &["obj"],
        &[
            ("models__colorspace-issue-184.obj", "1 default | Test"),
            (
                "models__invalid-face-definition.obj",
                "file: no triangles: only 2 faces with fewer than 3 corners",
            ),
            ("models__invalid-relative-texture-index.obj", "line 2: vertex 1 is past the last, 0"),
            (
                "models__invalid-relative-vertex-index.obj",
                "line 1: vertex -4 counts back past the first",
            ),
            ("models__issue-138.obj", "12 test1 test2 | test1 test2"),
            ("models__issue-140-zero-face-idx.obj", "line 16: vertex 0, where OBJ counts from 1"),
            ("models__issue-161-inconsistent-f.obj", "12 cube | cube"),
            ("models__issue-162-smoothing-group.obj", "12 test1 test2 | test1 test2"),
            ("models__issue-235-usemtl-then-o.obj", "2 None None1 | Plane.001 Plane"),
            ("models__issue-244-mtl-searchpaths.obj", "2 None None1 | Plane.001 Plane"),
            ("models__issue-246-usemtl-whitespace.obj", "1 1 | Plane.001"),
            (
                "models__issue-248-texres-texopt.obj",
                "12 white red green | front cube back  cube right cube top cube left cube bottom cube",
            ),
            ("models__issue-295-trianguation-failure.obj", "28 | invalid"),
            ("models__issue-319-002.obj", "14 |"),
            ("models__issue-319-003.obj", "8 |"),
            ("models__issue-330.obj", "3 |"),
            (
                "models__issue-356-leading-spaces-newmtl.obj",
                "file: no triangles: neither vertices nor faces",
            ),
            ("models__issue-92.obj", "1 default | Test"),
            ("models__issue-95-2.obj", "1 default | Test"),
            ("models__issue-95.obj", "1 default | Test"),
            ("models__leading-decimal-dot-issue-201.obj", "1 default | Test"),
            ("models__leading-zero-in-exponent-notation-issue-210.obj", "1 default | Test"),
            ("models__line-prim.obj", "file: no triangles: only 2 lines and points"),
            (
                "models__missing_material_file.obj",
                "36 white light green red | floor light ceiling back_wall green_wall red_wall short_block tall_block",
            ),
            (
                "models__mtl filename with whitespace issue46.obj",
                "12 green | front cube back cube right cube left cube top cube bottom cube",
            ),
            ("models__mtllib-multiple-files-issue-112.obj", "1 default | Test"),
            ("models__points-prim.obj", "file: no triangles: only 1 lines and points"),
            ("models__test-nan.obj", "line 12: `nan` is not a finite number"),
            (
                "models__texture-filename-with-whitespace.obj",
                "12 white red green | front cube back cube right cube top cube left cube bottom cube",
            ),
            ("models__texture-options-issue-85.obj", "1 default | Test"),
            ("models__tr-and-d-issue-43.obj", "400 Material.001 Material.002 | Cube"),
            ("models__usemtl-issue-104.obj", "6 | floor"),
            ("models__usemtl-issue-68.obj", "400 Material.001 Material.003 | Cube"),
            (
                "tests__issue-177.obj",
                "12 white red green | front cube back cube right cube top cube left cube bottom cube",
            ),
        ],
    );
}

#[test]
fn files_made_here_load_or_say_why_not() {
    check(
        "files_made_here_load_or_say_why_not",
        "bad/made_here",
        &["obj", "glb"],
        &[
            ("concave_ngon_nonmanifold.obj", "42 |"),
            ("cr_only.obj", "1 |"),
            (
                "glb_bad_total_length.glb",
                "byte 402448: the file is cut off: it should have 4294967295 bytes",
            ),
            ("glb_header_only.glb", "byte 12: the file is cut off: it should have 402448 bytes"),
            (
                "glb_json_chunk_len_huge.glb",
                "byte 12: a chunk of 2147483632 bytes, where 402428 are left",
            ),
            ("glb_truncated.glb", "byte 201224: the file is cut off: it should have 402448 bytes"),
            ("glb_version_99.glb", "byte 4: glTF binary version 99, where only 2 is read"),
            ("hostile.obj", "byte 183: a zero byte: this is not OBJ text"),
            ("long_line.obj", "line 4: a face of more than 65536 corners"),
            ("lying_extension_is_png.glb", "file: it is named .glb but holds a PNG picture"),
            ("utf16.obj", "line 1: the text is UTF-16: save it as UTF-8 or ASCII"),
        ],
    );
}

/// Rules of glTF that a file may break and load, and why that does no harm here.
const HARMLESS: &[(&str, &str)] = &[
    (
        "ACCESSOR_INDEX_PRIMITIVE_RESTART",
        "the largest index restarts nothing: it is a vertex or past them",
    ),
    ("ACCESSOR_INVALID_SIGN", "tangents are not read"),
    ("ACCESSOR_NON_CLAMPED", "colours are cut off at 0 and 1"),
    ("ACCESSOR_VECTOR3_NON_UNIT", "normals are not read"),
    ("EMPTY_ENTITY", "an empty list holds nothing that is missing"),
    ("KHR_MATERIALS_VARIANTS_NON_UNIQUE_VARIANT", "variants of materials are not read"),
    ("MESH_INVALID_WEIGHTS_COUNT", "a target without a weight moves nothing, which is told"),
    ("MESH_PRIMITIVES_UNEQUAL_TARGETS_COUNT", "each primitive has its own targets"),
    ("MESH_PRIMITIVE_ATTRIBUTES_ACCESSOR_UNSIGNED_INT", "it is an attribute that is not read"),
    ("MESH_PRIMITIVE_INDEXED_SEMANTIC_CONTINUITY", "of uvs and colours only the first are read"),
    ("MESH_PRIMITIVE_INVALID_ATTRIBUTE", "attributes of other names are not read"),
    ("MESH_PRIMITIVE_JOINTS_WEIGHTS_MISMATCH", "no skin holds it, so its joints are not read"),
    ("MESH_PRIMITIVE_MORPH_TARGET_INVALID_ATTRIBUTE_COUNT", "targets of weight 0 are not read"),
    ("MESH_PRIMITIVE_MORPH_TARGET_NO_BASE_ACCESSOR", "of targets only positions are read"),
    ("MESH_PRIMITIVE_NO_TANGENT_SPACE", "tangents are not read"),
    ("MESH_PRIMITIVE_POSITION_ACCESSOR_WITHOUT_BOUNDS", "stated bounds are not read"),
    ("MESH_PRIMITIVE_TOO_FEW_TEXCOORDS", "pictures are not read"),
    ("NODE_SKIN_NO_SCENE", "joints count wherever they lie"),
    ("NODE_SKIN_WITH_NON_SKINNED_MESH", "its node places it, which is told"),
    ("NODE_WEIGHTS_INVALID", "a weight without a target moves nothing, which is told"),
    ("NON_REQUIRED_EXTENSION", "KHR_mesh_quantization is known, required or not"),
    ("UNDEFINED_PROPERTY", "it is a property that is not read, or it would be missed"),
    ("UNEXPECTED_EXTENSION_OBJECT", "extensions in other places are not read"),
    ("UNRESOLVED_REFERENCE", "it is of something that is not read, or it would be missed"),
    ("UNSATISFIED_DEPENDENCY", "extensions that others lean on are not read"),
];

/// Valid files with triangles that do not load all the same.
const REFUSED: &[(&str, &str)] = &[
    ("base/data/mesh/primitive_no_position.gltf", "file: no triangles in its 1 meshes"),
    // The validator does not ask for bytes that nothing else says are there.
    (
        "base/data/root/named_objects.gltf",
        "buffers[0]: it has no bytes: neither a uri nor a binary chunk",
    ),
    (
        "base/data/root/unused_objects.gltf",
        "buffers[0]: it has no bytes: neither a uri nor a binary chunk",
    ),
];

/// Each file comes with the verdict of Khronos' validator.
#[test]
fn gltf_files_load_unless_the_validator_finds_an_error_we_mind() {
    let test = "gltf_files_load_unless_the_validator_finds_an_error_we_mind";
    let Some(folder) = shared(test, "bad/gltf_validator") else { return };
    let mut wrong = Vec::new();
    let (mut n_loaded, mut n_loaded_with_errors, mut n_refused) = (0, 0, 0);
    let mut codes_met = BTreeSet::new();
    for path in files(&folder, &["gltf", "glb"]) {
        let report = std::fs::read(format!("{}.report.json", path.display())).unwrap();
        let report: serde_json::Value = serde_json::from_slice(&report).unwrap();
        let messages = report["issues"]["messages"].as_array().into_iter().flatten();
        let errors: BTreeSet<String> = messages
            .filter(|m| m["severity"] == 0)
            .map(|m| m["code"].as_str().unwrap().to_owned())
            .collect();
        let n_triangles = report["info"]["totalTriangleCount"].as_u64().unwrap_or(0);
        let name = path.strip_prefix(&folder).unwrap().to_string_lossy().into_owned();
        match read_file(&path).result {
            Ok(mesh) => {
                n_loaded += 1;
                n_loaded_with_errors += usize::from(!errors.is_empty());
                let n = mesh.triangles.len() as u64;
                if n != n_triangles {
                    wrong.push(format!("{name}: {n} triangles, where it has {n_triangles}"));
                }
                for error in &errors {
                    if !HARMLESS.iter().any(|(code, _)| code == error) {
                        wrong.push(format!("{name}: loaded in spite of {error}"));
                    }
                }
                codes_met.extend(errors);
            }
            Err(e) => {
                n_refused += 1;
                let listed = REFUSED.contains(&(name.as_str(), e.to_string().as_str()));
                if errors.is_empty() && n_triangles > 0 && !listed {
                    wrong.push(format!("{name}: valid, but {e}"));
                }
            }
        }
    }
    for (code, _) in HARMLESS {
        if !codes_met.contains(*code) {
            wrong.push(format!("no file that loads has {code}"));
        }
    }
    println!("{n_loaded} loaded, {n_loaded_with_errors} of them with errors; {n_refused} refused");
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}
