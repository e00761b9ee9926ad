//! Mesh files in: picks the reader by extension, after a look at the first bytes.
//!
//! **Guarantees** for any bytes: no panic, an answer within seconds, and never more than
//! [`mesh_in::limits`](self::limits) memory held at once. What comes back satisfies
//! [`Mesh::check`]; all of its points are used; points at the same place are joined where that undoes
//! a cut and not where things merely touch; it has at least one triangle.
//! **Not promised:** anything about the shape. Holes, several parts, non-manifold edges and
//! triangles without area load as they are. Nothing here opens a file: other files a mesh needs
//! (the `.bin` of a `.gltf`) come through `side`, by the relative name the mesh file gives them.

pub mod limits;
mod names;
mod polygon;
mod weld;

pub(super) use names::{NAMELESS, NameTable};
pub(super) use polygon::Clipper;
pub(super) use weld::{Weld, finish};
pub(super) const WELD_BYTES_PER_POINT: u64 = weld::BYTES_PER_POINT;
pub(super) const WELD_BYTES_PER_TRIANGLE: u64 = weld::BYTES_PER_TRIANGLE;

use super::{gltf, obj};
use crate::data::mesh::{Mesh, MeshError};
use std::sync::Arc;

/// Part of every cache key made from a mesh file: goes up whenever a reader gives other values for
/// the same bytes.
pub const READER_VERSION: u32 = 2;

/// The extensions [`read_mesh`] reads, in lower case and without the dot. A `.vrm` is a `.glb` with another name.
pub const EXTENSIONS: &[&str] = &["obj", "gltf", "glb", "vrm"];

/// Gives the bytes of a file beside the mesh file, by relative name with `/` between folders, or
/// nothing where there is none.
pub type Side<'a> = &'a dyn Fn(&str) -> Option<Arc<[u8]>>;

/// Reads a mesh from a file's bytes, by the file's extension (any case, without the dot).
///
/// Errors: another extension than [`EXTENSIONS`], content of another kind than the extension says,
/// and whatever [`obj::read`] and [`gltf::read`] refuse.
pub fn read_mesh(extension: &str, bytes: &[u8], side: Side) -> Result<Mesh, MeshError> {
    let extension = extension.trim_start_matches('.').to_ascii_lowercase();
    if !EXTENSIONS.contains(&extension.as_str()) {
        return Err(refuse_extension(&extension));
    }
    if bytes.is_empty() {
        return Err(MeshError::at("file", "it is empty"));
    }
    let gltf = is_gltf(&extension);
    if let Some((kind, holds_gltf)) = kind_of(bytes)
        && holds_gltf != gltf
    {
        return Err(MeshError::at("file", format!("it is named .{extension} but holds {kind}")));
    }
    if gltf { gltf::read(bytes, side) } else { obj::read(bytes) }
}

/// The other files that [`read_mesh`] will ask `side` for: relative names, each once.
/// Empty where there are none or where the bytes are no mesh.
pub fn side_files(extension: &str, bytes: &[u8]) -> Vec<String> {
    let extension = extension.trim_start_matches('.').to_ascii_lowercase();
    if is_gltf(&extension) { gltf::side_files(bytes) } else { Vec::new() }
}

/// Whether files of an extension, in lower case, are glTF.
pub(super) fn is_gltf(extension: &str) -> bool {
    matches!(extension, "gltf" | "glb" | "vrm")
}

fn refuse_extension(extension: &str) -> MeshError {
    let what = match extension {
        "fbx" => "FBX is not read".to_owned(),
        "abc" => "Alembic meshes are not read".to_owned(),
        "usd" | "usda" | "usdc" | "usdz" => "USD meshes are not read".to_owned(),
        "" => "a file without an extension is not read".to_owned(),
        other => format!("`.{}` is not read", limits::excerpt(other.as_bytes())),
    };
    MeshError::at("file", format!("{what}: export the mesh as .obj, .gltf, .glb or .vrm"))
}

/// What the first bytes say a file is, and whether a glTF reader takes it; nothing for plain text.
fn kind_of(bytes: &[u8]) -> Option<(&'static str, bool)> {
    const MAGIC: &[(&[u8], &str)] = &[
        (b"\x89PNG", "a PNG picture"),
        (b"\xff\xd8\xff", "a JPEG picture"),
        (b"II*\0", "a TIFF picture"),
        (b"MM\0*", "a TIFF picture"),
        (b"\x76\x2f\x31\x01", "an OpenEXR picture"),
        (b"GIF8", "a GIF picture"),
        (b"PK\x03\x04", "a ZIP archive"),
        (b"\x1f\x8b", "a gzip archive"),
        (b"BLENDER", "a Blender scene"),
        (b"Kaydara FBX", "an FBX scene"),
        (b"; FBX", "an FBX scene"),
        (b"Ogawa", "an Alembic scene"),
        (b"PXR-USDC", "a USD scene"),
        (b"#usda", "a USD scene"),
        (b"%PDF", "a PDF document"),
        (b"HAIR", "hair strands"),
        (b"ply\n", "a PLY mesh"),
        (b"ply\r", "a PLY mesh"),
        (b"solid ", "an STL mesh"),
    ];
    if bytes.starts_with(b"glTF") {
        return Some(("a binary glTF scene", true));
    }
    if let Some((_, kind)) = MAGIC.iter().find(|(magic, _)| bytes.starts_with(magic)) {
        return Some((kind, false));
    }
    let text = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    let json = text.iter().find(|b| !b.is_ascii_whitespace()) == Some(&b'{');
    json.then_some(("a JSON document", true))
}

#[cfg(test)]
mod tests {
    use super::*;
    use expect_test::{Expect, expect};

    #[track_caller]
    fn check(extension: &str, bytes: &[u8], expected: Expect) {
        let answer = match read_mesh(extension, bytes, &|_| None) {
            Ok(mesh) => format!("{} triangles", mesh.triangles.len()),
            Err(e) => e.to_string(),
        };
        expected.assert_eq(&answer);
    }

    const TRIANGLE: &[u8] = b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";

    #[test]
    fn an_extension_counts_in_any_case_and_with_its_dot() {
        check(".OBJ", TRIANGLE, expect!["1 triangles"]);
    }

    #[test]
    fn other_formats_are_refused_with_those_that_are_read() {
        let says =
            |text: &str| format!("file: {text}: export the mesh as .obj, .gltf, .glb or .vrm");
        for (extension, text) in [
            ("fbx", "FBX is not read"),
            ("abc", "Alembic meshes are not read"),
            ("usdc", "USD meshes are not read"),
            ("", "a file without an extension is not read"),
            ("stl", "`.stl` is not read"),
        ] {
            let e = read_mesh(extension, TRIANGLE, &|_| None).unwrap_err();
            assert_eq!(e.to_string(), says(text));
        }
    }

    #[test]
    fn a_file_with_a_lying_name_is_told_by_its_first_bytes() {
        check(
            "obj",
            b"\x89PNG\r\n\x1a\n",
            expect!["file: no triangles: neither vertices nor faces"],
        );
        check(
            "glb",
            b"\x89PNG\r\n\x1a\n",
            expect!["file: it is named .glb but holds a PNG picture"],
        );
        check("obj", b"glTF", expect!["file: it is named .obj but holds a binary glTF scene"]);
        check(
            "obj",
            b" {\"asset\":{}}",
            expect!["file: it is named .obj but holds a JSON document"],
        );
        check("vrm", TRIANGLE, expect!["line 1 column 1: this is not JSON: expected value"]);
        check("vrm", b"\x89PNG", expect!["file: it is named .vrm but holds a PNG picture"]);
        check("gltf", TRIANGLE, expect!["line 1 column 1: this is not JSON: expected value"]);
        check("glb", b"", expect!["file: it is empty"]);
    }

    #[test]
    fn only_gltf_asks_for_other_files() {
        let gltf = br#"{"asset":{"version":"2.0"},"buffers":[{"uri":"a.bin","byteLength":1}]}"#;
        assert_eq!(side_files("gltf", gltf), ["a.bin"]);
        assert_eq!(side_files(".VRM", gltf), ["a.bin"]);
        assert!(side_files("obj", gltf).is_empty());
    }
}
