//! Wavefront OBJ meshes in.
//!
//! Reads `v` (with vertex colours), `vt`, `f`, `o`, `g` and `usemtl`; leaves out lines, points and
//! free-form shapes with a note, and everything about looks (`mtllib`, `vn`, `s`) without one. No
//! `.mtl` file is needed: a material is its name. Polygons of any shape become triangles in order.
//!
//! **Guarantees:** errors name the line; nothing is guessed. A number that is none, an index that
//! leads nowhere and a face cut short by a typing error refuse the file. What exporters do write by
//! mistake is repaired with a note: faces of one or two corners, uvs that are no numbers, uvs on
//! some faces only. **Not promised:** units and axes (the format has none).
//!
//! The file is read three times: to count, so that memory is reckoned and refused before it is
//! allocated ([`limits`](super::mesh_in::limits)); for vertices and uvs; then for faces, which may
//! stand above the vertices they name. We read it ourselves because the
//! `tobj` crate (4.0.5) drops material names when the `.mtl` is absent, tells no line in its errors,
//! does not know CR line ends and holds 27 bytes for each byte of a file of plain triangles.

mod count;
mod lines;
mod looks;

use super::mesh_in::limits::{Budget, excerpt};
use super::mesh_in::{Clipper, NAMELESS, NameTable, Weld, finish};
use crate::data::mesh::{Mesh, MeshError};
use count::{Count, no_triangles};
use glam::{Vec2, Vec3};
use lines::{TextLines, split_keyword, words};
pub(super) use looks::read_looks;

/// Corners a face may have. Larger ones come from no modeller, and one face is cut in memory that
/// no budget sees (about 60 bytes a corner).
const MOST_CORNERS: usize = 65_536;

/// The masks that vertex colours become.
pub(super) const COLOUR_MASKS: [&str; 3] = ["colour.r", "colour.g", "colour.b"];

/// Reads an OBJ file's bytes.
///
/// Text is UTF-8, or anything else that agrees with ASCII where it matters; names that are not
/// UTF-8 get replacement characters. Errors name the line, from 1.
pub fn read(bytes: &[u8]) -> Result<Mesh, MeshError> {
    let text = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    refuse_other_encodings(text)?;
    let count = Count::of(text)?;
    if count.triangles == 0 {
        return Err(no_triangles(&count));
    }
    let mut budget = Budget::new(bytes.len());
    budget.take("file", count.memory(bytes.len()))?;

    let mut reader = Reader::new(&count);
    let mut lines = TextLines::new(text);
    while let Some((line, text)) = lines.next() {
        match split_keyword(text) {
            (b"v", rest) => reader.read_point(line, rest)?,
            (b"vt", rest) => reader.read_uv(line, rest)?,
            _ => {}
        }
    }
    let mut lines = TextLines::new(text);
    while let Some((line, text)) = lines.next() {
        match split_keyword(text) {
            (b"v", _) => reader.n_points_above += 1,
            (b"vt", _) => reader.n_uvs_above += 1,
            (b"f", rest) => reader.read_face(line, rest)?,
            (b"usemtl", name) => reader.material.iter_mut().for_each(|m| m.set(name)),
            (b"o" | b"g", name) => reader.part.iter_mut().for_each(|p| p.set(name)),
            _ => {}
        }
    }
    reader.into_mesh()
}

fn refuse_other_encodings(text: &[u8]) -> Result<(), MeshError> {
    if text.starts_with(b"\xff\xfe") || text.starts_with(b"\xfe\xff") {
        return Err(MeshError::at("line 1", "the text is UTF-16: save it as UTF-8 or ASCII"));
    }
    // UTF-16 without its mark, or no text at all; further down a zero byte is a bad number.
    if let Some(i) = text.iter().take(1024).position(|b| *b == 0) {
        return Err(MeshError::at(format!("byte {i}"), "a zero byte: this is not OBJ text"));
    }
    Ok(())
}

fn at_line(line: usize, reason: impl Into<String>) -> MeshError {
    MeshError::at(format!("line {line}"), reason)
}

/// One corner of a face: positions in the lists of vertices and uvs.
#[derive(Clone, Copy, Debug)]
struct Corner {
    point: u32,
    uv: Option<u32>,
}

/// A statement that lasts until the next of its kind; numbered when a face first uses it, so that
/// names nothing uses are not listed.
#[derive(Debug, Default)]
struct Current {
    name: String,
    number: Option<u32>,
    names: NameTable,
    number_of: Vec<u32>,
}

impl Current {
    fn new(triangles: usize) -> Self {
        Self {
            name: NAMELESS.to_owned(),
            number_of: Vec::with_capacity(triangles),
            ..Self::default()
        }
    }

    fn set(&mut self, name: &[u8]) {
        let name = if name.is_empty() { NAMELESS.as_bytes() } else { name };
        self.name = String::from_utf8_lossy(name).into_owned();
        self.number = None;
    }

    fn repeat(&mut self, times: usize) {
        let Self { name, names, .. } = self;
        let number = *self.number.get_or_insert_with(|| names.number(name));
        self.number_of.resize(self.number_of.len() + times, number);
    }
}

struct Reader<'a> {
    count: &'a Count,
    mesh: Mesh,
    uv_list: Vec<Vec2>,
    corner_uvs: Vec<[Vec2; 3]>,
    material: Option<Current>,
    part: Option<Current>,
    colours: [Vec<f32>; 3],
    colour_is_whole: bool,
    n_coloured: usize,
    n_points_above: usize,
    n_uvs_above: usize,
    n_uv_not_finite: usize,
    n_without_uv: usize,
    first_fanned: Option<usize>,
    clipper: Clipper,
    // Scratch, kept from face to face.
    corners: Vec<Corner>,
    ring: Vec<Vec3>,
    cut: Vec<[u32; 3]>,
}

impl<'a> Reader<'a> {
    fn new(count: &'a Count) -> Self {
        let n_triangles = count.triangles as usize;
        let n_points = count.points as usize;
        let n_coloured = if count.colours { n_points } else { 0 };
        Self {
            mesh: Mesh {
                points: Vec::with_capacity(n_points),
                triangles: Vec::with_capacity(n_triangles),
                ..Mesh::default()
            },
            uv_list: Vec::with_capacity(count.uvs as usize),
            corner_uvs: Vec::with_capacity(if count.uvs > 0 { n_triangles } else { 0 }),
            material: count.materials.then(|| Current::new(n_triangles)),
            part: count.parts.then(|| Current::new(n_triangles)),
            colours: [(); 3].map(|()| Vec::with_capacity(n_coloured)),
            colour_is_whole: true,
            n_coloured: 0,
            n_points_above: 0,
            n_uvs_above: 0,
            n_uv_not_finite: 0,
            n_without_uv: 0,
            first_fanned: None,
            clipper: Clipper::default(),
            corners: Vec::new(),
            ring: Vec::new(),
            cut: Vec::new(),
            count,
        }
    }

    fn read_point(&mut self, line: usize, rest: &[u8]) -> Result<(), MeshError> {
        // x y z, then nothing, a weight (1), a colour (3) or a colour with alpha (4).
        let mut values = [0.0; 7];
        let mut n = 0;
        for (value, word) in values.iter_mut().zip(words(rest)) {
            *value = number(line, word)?;
            if !value.is_finite() {
                return Err(at_line(line, format!("`{}` is not a finite number", excerpt(word))));
            }
            n += 1;
        }
        if n < 3 {
            return Err(at_line(line, format!("a vertex takes 3 coordinates, here are {n}")));
        }
        let [x, y, z, r, g, b, _] = values;
        self.mesh.points.push(Vec3::new(x, y, z));
        if self.count.colours {
            // Not a number stands for "none" until the scale of the others is known.
            let colour = if n >= 6 { [r, g, b] } else { [f32::NAN; 3] };
            if n >= 6 {
                self.n_coloured += 1;
                self.colour_is_whole &= colour.iter().all(|c| c.fract() == 0.0);
            }
            for (channel, value) in self.colours.iter_mut().zip(colour) {
                channel.push(value);
            }
        }
        Ok(())
    }

    fn read_uv(&mut self, line: usize, rest: &[u8]) -> Result<(), MeshError> {
        let mut uv = [0.0; 2];
        let mut n = 0;
        for (value, word) in uv.iter_mut().zip(words(rest)) {
            *value = number(line, word)?;
            n += 1;
        }
        if n == 0 {
            return Err(at_line(line, "a uv without a number"));
        }
        let mut uv = Vec2::from_array(uv);
        if !uv.is_finite() {
            self.n_uv_not_finite += 1;
            uv = Vec2::ZERO;
        }
        self.uv_list.push(uv);
        Ok(())
    }

    fn read_face(&mut self, line: usize, rest: &[u8]) -> Result<(), MeshError> {
        self.corners.clear();
        for word in words(rest) {
            let corner = self.corner(line, word)?;
            self.corners.push(corner);
        }
        if self.corners.len() < 3 {
            return Ok(());
        }
        self.ring.clear();
        self.ring.extend(self.corners.iter().map(|c| self.mesh.points[c.point as usize]));
        self.cut.clear();
        if !self.clipper.triangulate(&self.ring, &mut self.cut) {
            self.first_fanned.get_or_insert(line);
        }

        let corners = &self.corners;
        let corner = |i: u32| corners[i as usize];
        self.mesh.triangles.extend(self.cut.iter().map(|t| t.map(|i| corner(i).point)));
        if self.count.uvs > 0 {
            let whole = corners.iter().all(|c| c.uv.is_some());
            self.n_without_uv += if whole { 0 } else { self.cut.len() };
            let uv = |i: u32| corner(i).uv.map_or(Vec2::ZERO, |uv| self.uv_list[uv as usize]);
            self.corner_uvs.extend(self.cut.iter().map(|t| t.map(uv)));
        }
        for current in [&mut self.material, &mut self.part].into_iter().flatten() {
            current.repeat(self.cut.len());
        }
        Ok(())
    }

    /// `7`, `7/2`, `7//4` or `7/2/4`: vertex, uv and normal.
    fn corner(&self, line: usize, word: &[u8]) -> Result<Corner, MeshError> {
        let mut fields = word.split(|b| *b == b'/');
        let point = fields.next().unwrap_or_default();
        let point = index(line, "vertex", point, self.n_points_above, self.count.points)?;
        let uv = match fields.next().unwrap_or_default() {
            [] => None,
            uv => Some(index(line, "uv", uv, self.n_uvs_above, self.count.uvs)?),
        };
        // Normals are not used, so where they lead does not matter.
        let normal = fields.next().unwrap_or_default();
        let is_digit = |b: &u8| b.is_ascii_digit() || matches!(b, b'-' | b'+');
        if !normal.iter().all(is_digit) || fields.next().is_some() {
            let reason = format!("`{}` is not vertex/uv/normal", excerpt(word));
            return Err(at_line(line, reason));
        }
        Ok(Corner { point, uv })
    }

    fn into_mesh(self) -> Result<Mesh, MeshError> {
        let Self { count, mut mesh, .. } = self;
        if self.n_without_uv < mesh.triangles.len() && count.uvs > 0 {
            mesh.uvs = Some(self.corner_uvs);
            note(&mut mesh, self.n_without_uv, "triangles have no uv and got (0, 0)");
        }
        if let Some(material) = self.material {
            (mesh.materials, mesh.material_of) = material.names.into_columns(material.number_of);
        }
        if let Some(part) = self.part {
            (mesh.parts, mesh.part_of) = part.names.into_columns(part.number_of);
        }
        if count.colours {
            add_colours(&mut mesh, self.colours, self.colour_is_whole, self.n_coloured);
        }
        let finished = finish(&mut mesh, Weld::IfManifold)?;
        let n_apart = finished.n_kept_apart;
        note(&mut mesh, finished.n_unused, "vertices that no face uses were left out");
        note(&mut mesh, n_apart, "vertices touch others and stay apart, as in the file");
        note(&mut mesh, self.n_uv_not_finite, "uvs are not finite numbers and became (0, 0)");
        note(&mut mesh, count.lines_and_points as usize, "lines and points were left out");
        note(&mut mesh, count.free_form as usize, "free-form curves and surfaces were left out");
        if count.short_faces > 0 {
            let (n, line) = (count.short_faces, count.first_short_face);
            let text =
                format!("{n} faces with fewer than 3 corners were left out, from line {line}");
            mesh.notes.push(text);
        }
        if let Some(line) = self.first_fanned {
            let text = format!("concave polygons from line {line} on were cut as fans: too many");
            mesh.notes.push(text);
        }
        if count.unknown > 0 {
            let (n, line) = (count.unknown, count.first_unknown);
            mesh.notes
                .push(format!("{n} lines that OBJ does not know were skipped, from line {line}"));
        }
        Ok(mesh)
    }
}

fn note(mesh: &mut Mesh, n: usize, text: &str) {
    if n > 0 {
        mesh.notes.push(format!("{n} {text}"));
    }
}

/// Colours as masks, between 0 and 1 whatever the file counts in.
fn add_colours(mesh: &mut Mesh, mut colours: [Vec<f32>; 3], whole: bool, n_coloured: usize) {
    let largest = colours.iter().flatten().copied().fold(0.0, f32::max);
    let bytes = whole && largest > 1.0 && largest <= 255.0;
    if bytes {
        mesh.notes.push("vertex colours count to 255 and were divided by it".to_owned());
        for value in colours.iter_mut().flatten() {
            *value /= 255.0;
        }
    }
    // White where the file gives none, as programs draw it.
    for value in colours.iter_mut().flatten().filter(|c| c.is_nan()) {
        *value = 1.0;
    }
    let outside = colours.iter().flatten().filter(|c| !(0.0..=1.0).contains(*c)).count();
    for value in colours.iter_mut().flatten() {
        *value = value.clamp(0.0, 1.0);
    }
    note(mesh, outside, "vertex colour values outside 0 to 1 were cut off there");
    let without = mesh.points.len() - n_coloured;
    note(mesh, without, "vertices have no colour and got white");
    mesh.masks = COLOUR_MASKS.map(str::to_owned).into_iter().zip(colours).collect();
}

/// A number as C and its exporters write one; infinite and NaN where the text says so or is too
/// large for single precision.
fn number(line: usize, word: &[u8]) -> Result<f32, MeshError> {
    std::str::from_utf8(word)
        .ok()
        .and_then(|word| word.parse().ok())
        .ok_or_else(|| at_line(line, format!("`{}` is not a number", excerpt(word))))
}

/// A position in a list of `total` things, `above` of which stand above this line. OBJ counts from
/// 1, or backwards from the last with -1.
fn index(line: usize, what: &str, word: &[u8], above: usize, total: u64) -> Result<u32, MeshError> {
    let parsed = std::str::from_utf8(word).ok().and_then(|word| word.parse::<i64>().ok());
    let Some(number) = parsed else {
        return Err(at_line(line, format!("`{}` is no {what} of a face", excerpt(word))));
    };
    let position = match number {
        0 => return Err(at_line(line, format!("{what} 0, where OBJ counts from 1"))),
        1.. => number - 1,
        ..0 => number.saturating_add(above as i64),
    };
    if position < 0 {
        return Err(at_line(line, format!("{what} {number} counts back past the first")));
    }
    if position as u64 >= total {
        return Err(at_line(line, format!("{what} {number} is past the last, {total}")));
    }
    Ok(position as u32)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Everything a mesh holds, or the error, as lines of text.
    fn told(result: Result<Mesh, MeshError>) -> String {
        let mesh = match result {
            Ok(mesh) => mesh,
            Err(e) => return format!("{e}\n"),
        };
        mesh.check().unwrap();
        let points: Vec<_> = mesh.points.iter().map(|p| p.to_array()).collect();
        let mut text = format!("points {points:?}\ntriangles {:?}\n", mesh.triangles);
        if let Some(uvs) = &mesh.uvs {
            let uvs: Vec<_> = uvs.iter().map(|t| t.map(|uv| uv.to_array())).collect();
            text += &format!("uvs {uvs:?}\n");
        }
        for (what, names, of) in [
            ("materials", &mesh.materials, &mesh.material_of),
            ("parts", &mesh.parts, &mesh.part_of),
        ] {
            if !names.is_empty() {
                text += &format!("{what} {names:?} {of:?}\n");
            }
        }
        for (name, values) in &mesh.masks {
            text += &format!("{name} {values:?}\n");
        }
        for note in &mesh.notes {
            text += &format!("note: {note}\n");
        }
        text
    }

    #[track_caller]
    fn check(text: impl AsRef<[u8]>, expected: &[&str]) {
        assert_eq!(told(read(text.as_ref())).lines().collect::<Vec<_>>(), expected);
    }

    /// What comes after three good vertices.
    #[track_caller]
    fn check_face(text: &str, expected: &[&str]) {
        let text = format!("v 0 0 0\nv 1 0 0\nv 0 1 0\n{text}\n");
        let told = told(read(text.as_bytes()));
        let usual = "points [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]\n";
        let told = told.strip_prefix(usual).unwrap_or(&told);
        assert_eq!(told.lines().collect::<Vec<_>>(), expected);
    }

    #[test]
    fn corners_come_with_or_without_uv_and_normal() {
        let vt = "vt 0.25 0.5\nvt 1\nvn 0 0 1\n";
        check_face("f 1 2 3", &["triangles [[0, 1, 2]]"]);
        check_face(
            &format!("{vt}f 1/1/1 2/2/1 3/1/1"),
            &["triangles [[0, 1, 2]]", "uvs [[[0.25, 0.5], [1.0, 0.0], [0.25, 0.5]]]"],
        );
        check_face(
            &format!("{vt}f 1/1 2/2 3/-1"),
            &["triangles [[0, 1, 2]]", "uvs [[[0.25, 0.5], [1.0, 0.0], [1.0, 0.0]]]"],
        );
        check_face(&format!("{vt}f 1//1 2//1 3//1"), &["triangles [[0, 1, 2]]"]);
        check_face("f 1/ 2/ 3//", &["triangles [[0, 1, 2]]"]);
    }

    #[test]
    fn indices_count_from_either_end_and_may_lead_down_the_file() {
        check_face("f -3 -2 -1", &["triangles [[0, 1, 2]]"]);
        check(
            "f 1/1 2/1 3/1\nvt .5 .5\nv 0 0 0\nv 1 0 0\nv 0 1 0",
            &[
                "points [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]",
                "triangles [[0, 1, 2]]",
                "uvs [[[0.5, 0.5], [0.5, 0.5], [0.5, 0.5]]]",
            ],
        );
    }

    #[test]
    fn a_uv_for_some_faces_is_filled_and_told() {
        check_face(
            "vt 1 1\nf 1/1 2/1 3/1\nf 1 2/1 3/1\nf 1 2 3",
            &[
                "triangles [[0, 1, 2], [0, 1, 2], [0, 1, 2]]",
                "uvs [[[1.0, 1.0], [1.0, 1.0], [1.0, 1.0]], [[0.0, 0.0], [1.0, 1.0], [1.0, 1.0]], [[0.0, 0.0], [0.0, 0.0], [0.0, 0.0]]]",
                "note: 2 triangles have no uv and got (0, 0)",
            ],
        );
        check_face("vt 1 1\nf 1 2 3", &["triangles [[0, 1, 2]]"]);
        check_face(
            "vt nan 1\nvt 0 1 0\nf 1/1 2/2 3/2",
            &[
                "triangles [[0, 1, 2]]",
                "uvs [[[0.0, 0.0], [0.0, 1.0], [0.0, 1.0]]]",
                "note: 1 uvs are not finite numbers and became (0, 0)",
            ],
        );
    }

    #[test]
    fn materials_and_parts_are_numbered_as_faces_use_them() {
        check_face(
            "usemtl unused\nf 1 2 3\ng\no a head\nusemtl  skin tone \nf 1 2 3\ng left  ear\nf 1 2 3\no a head\nusemtl\nf 1 2 3",
            &[
                "triangles [[0, 1, 2], [0, 1, 2], [0, 1, 2], [0, 1, 2]]",
                "materials [\"unused\", \"skin tone\", \"(none)\"] [0, 1, 1, 2]",
                "parts [\"(none)\", \"a head\", \"left  ear\"] [0, 1, 2, 1]",
            ],
        );
        check_face(
            "f 1 2 3\nusemtl skin\no\nf 1 2 3",
            &["triangles [[0, 1, 2], [0, 1, 2]]", "materials [\"(none)\", \"skin\"] [0, 1]"],
        );
        check_face("o\ng\nusemtl\nf 1 2 3", &["triangles [[0, 1, 2]]"]);
    }

    #[test]
    fn vertex_colours_become_masks() {
        check(
            "v 0 0 0 1 0.5 0\nv 1 0 0 0 0 0.25 1\nv 0 1 0\nv 0 0 0 0 0 0\nf 1 2 3\nf 4 2 3",
            &[
                "points [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]",
                "triangles [[0, 1, 2], [0, 1, 2]]",
                "colour.b [0.0, 0.25, 1.0]",
                "colour.g [0.5, 0.0, 1.0]",
                "colour.r [1.0, 0.0, 1.0]",
                "note: 1 vertices have no colour and got white",
            ],
        );
        check(
            "v 0 0 0 255 51 0\nv 1 0 0 0 0 0\nv 0 1 0\nf 1 2 3",
            &[
                "points [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]",
                "triangles [[0, 1, 2]]",
                "colour.b [0.0, 0.0, 1.0]",
                "colour.g [0.2, 0.0, 1.0]",
                "colour.r [1.0, 0.0, 1.0]",
                "note: vertex colours count to 255 and were divided by it",
                "note: 1 vertices have no colour and got white",
            ],
        );
        check(
            "v 0 0 0 1.5 -1 0\nv 1 0 0 0 0 0\nv 0 1 0 0 0 0\nf 1 2 3",
            &[
                "points [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]",
                "triangles [[0, 1, 2]]",
                "colour.b [0.0, 0.0, 0.0]",
                "colour.g [0.0, 0.0, 0.0]",
                "colour.r [1.0, 0.0, 0.0]",
                "note: 2 vertex colour values outside 0 to 1 were cut off there",
            ],
        );
        check(
            "v 0 0 0 1\nv 1 0 0 1\nv 0 1 0 1\nf 1 2 3",
            &[
                "points [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]",
                "triangles [[0, 1, 2]]",
            ],
        );
    }

    #[test]
    fn polygons_are_cut_and_keep_their_uvs_and_names() {
        check(
            "v 0 0 0\nv 2 2 0\nv 0 1 0\nv -2 2 0\nvt 0 0\nvt 1 1\nvt 2 2\nvt 3 3\nusemtl m\nf 1/1 2/2 3/3 4/4",
            &[
                "points [[0.0, 0.0, 0.0], [2.0, 2.0, 0.0], [0.0, 1.0, 0.0], [-2.0, 2.0, 0.0]]",
                "triangles [[0, 1, 2], [3, 0, 2]]",
                "uvs [[[0.0, 0.0], [1.0, 1.0], [2.0, 2.0]], [[3.0, 3.0], [0.0, 0.0], [2.0, 2.0]]]",
                "materials [\"m\"] [0, 0]",
            ],
        );
    }

    #[test]
    fn equal_places_are_joined_and_strays_left_out() {
        check(
            "v 9 9 9\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv -0 0 0\nf 2 3 4\nf 5 4 3",
            &[
                "points [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]",
                "triangles [[0, 1, 2], [0, 2, 1]]",
                "note: 1 vertices that no face uses were left out",
            ],
        );
    }

    #[test]
    fn text_comes_with_any_line_end_mark_or_continuation() {
        for text in [
            "v 0 0 0\r\nv 1 0 0\r\nv 0 1 0\r\nf 1 2 3\r\n",
            "v 0 0 0\rv 1 0 0\rv 0 1 0\rf 1 2 3",
            "\u{feff}v 0 0 0\nv 1 0 0\n\n\n  v\t0 1 0  \n#c\\\nf 1 2 3",
            "v 0 \\\n0 0\nv 1 0 0\nv 0 1 0\nf 1 \\\r\n2 \\\r3\\",
        ] {
            let mesh = read(text.as_bytes()).unwrap();
            assert_eq!((mesh.points.len(), mesh.triangles.len()), (3, 1), "{text:?}");
        }
        check("v 0 0 0\\\n\n\nv 1 0 zero", &["file: no triangles: 2 vertices and no faces"]);
    }

    #[test]
    fn numbers_are_read_as_c_writes_them() {
        check(
            "v .8e-001 -.7e+02 +5.\nv 1 0 0\nv 0 1 0\nf 1 2 3",
            &[
                "points [[0.08, -70.0, 5.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]",
                "triangles [[0, 1, 2]]",
            ],
        );
        for (word, says) in [
            ("nan", "`nan` is not a finite number"),
            ("-inf", "`-inf` is not a finite number"),
            ("1e400", "`1e400` is not a finite number"),
            ("1e39", "`1e39` is not a finite number"),
            ("1.#IND", "`1.#IND` is not a number"),
            ("0,5", "`0,5` is not a number"),
            ("0x10", "`0x10` is not a number"),
        ] {
            let e = read(format!("v 0 0 0\nv 0 {word} 0\nf 1 1 1").as_bytes()).unwrap_err();
            assert_eq!(e.to_string(), format!("line 2: {says}"));
        }
    }

    #[test]
    fn what_is_no_triangle_is_left_out_and_told() {
        check_face(
            "f 1 2\nf\nl 1 2 3\np 1\nsurf 0 1\nwhat 3\nf 1 2 3",
            &[
                "triangles [[0, 1, 2]]",
                "note: 2 lines and points were left out",
                "note: 1 free-form curves and surfaces were left out",
                "note: 2 faces with fewer than 3 corners were left out, from line 4",
                "note: 1 lines that OBJ does not know were skipped, from line 9",
            ],
        );
        check_face("f 1 2", &["file: no triangles: only 1 faces with fewer than 3 corners"]);
        check_face("l 1 2", &["file: no triangles: only 1 lines and points"]);
        check_face(
            "cstype bspline\nsurf 0 1 0 1 1 2",
            &["file: no triangles: only free-form curves and surfaces: convert them to polygons"],
        );
        check_face("", &["file: no triangles: 3 vertices and no faces"]);
        check("just some words", &["file: no triangles: neither vertices nor faces"]);
        check("", &["file: no triangles: neither vertices nor faces"]);
    }

    #[test]
    fn a_wrong_face_is_refused_with_its_line() {
        check_face("f 1 2 4", &["line 4: vertex 4 is past the last, 3"]);
        check_face("f 0 1 2", &["line 4: vertex 0, where OBJ counts from 1"]);
        check_face("f -1 -2 -4", &["line 4: vertex -4 counts back past the first"]);
        check_face(
            "f 1 2 99999999999999999999",
            &["line 4: `99999999999999999999` is no vertex of a face"],
        );
        check_face(
            "f 1 2 -9223372036854775808",
            &["line 4: vertex -9223372036854775808 counts back past the first"],
        );
        check_face("f a b c", &["line 4: `a` is no vertex of a face"]);
        check_face("f 1/2/3/4 2 3", &["line 4: uv 2 is past the last, 0"]);
        check_face("f 1//x 2 3", &["line 4: `1//x` is not vertex/uv/normal"]);
        check_face("f 1/1 2 3", &["line 4: uv 1 is past the last, 0"]);
        check_face("v 1 2\nf 1 2 3", &["line 4: a vertex takes 3 coordinates, here are 2"]);
        check_face("vt\nf 1 2 3", &["line 4: a uv without a number"]);
        check_face(
            &format!("f{}", " 1".repeat(MOST_CORNERS + 1)),
            &["line 4: a face of more than 65536 corners"],
        );
    }

    #[test]
    fn other_encodings_are_refused() {
        check([0xff, 0xfe, b'v', 0], &["line 1: the text is UTF-16: save it as UTF-8 or ASCII"]);
        check([b'v', 0, b' ', 0], &["byte 1: a zero byte: this is not OBJ text"]);
        check(
            b"v 0 0 0\nv 1 0 0\nv 0 1 0\no n\xe9\nf 1 2 3",
            &[
                "points [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]",
                "triangles [[0, 1, 2]]",
                "parts [\"n�\"] [0]",
            ],
        );
    }
}
