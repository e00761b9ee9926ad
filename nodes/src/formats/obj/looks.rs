//! Materials of an OBJ file, from the `.mtl` files that it names: colours, colour maps and normal maps.
//!
//! Reads `Kd`, `map_Kd`, `norm`, and `map_Bump` or `bump`, of which its pixels tell whether it is a map of normals. A picture is
//! looked for where it is named and else, as many programs write paths of the machine that they ran on, by its name alone beside
//! the mesh. Not promised: anything about other statements, which are skipped.

use super::lines::{TextLines, split_keyword, words};
use super::read;
use crate::data::mesh::MeshError;
use crate::formats::looks::{Looks, Material, Picture, TextureMap, TextureWrap, rises, upright};
use crate::formats::mesh_in::Side;
use crate::formats::mesh_in::limits::excerpt;
use glam::{Affine2, Vec2, Vec3};
use std::collections::BTreeMap;

/// Files of materials that are read, and pictures that are shown.
const MOST_LIBRARIES: usize = 16;
const MOST_PICTURES: usize = 256;
/// Colours darker than this over a map mean that the program wrote none: nobody paints a map to show it black.
const BLACK: f32 = 1e-3;

/// Reads the looks of an OBJ file.
///
/// # Errors
/// Those of [`read`].
pub(in crate::formats) fn read_looks(bytes: &[u8], side: Side) -> Result<Looks, MeshError> {
    let mesh = read(bytes)?;
    let mut reader = Reader { side, numbers: BTreeMap::new(), looks: Looks::default() };
    let mut known: BTreeMap<String, Material> = BTreeMap::new();
    for name in libraries(bytes) {
        let plain = plain_name(&name);
        match plain.as_deref().and_then(side) {
            Some(text) => reader.read(&text, &mesh.materials, &mut known),
            None => {
                let name = excerpt(name.as_bytes());
                let remark = format!("the file \"{name}\" of its materials is missing beside it");
                reader.looks.remarks.push(remark);
            }
        }
    }
    let mut looks = reader.looks;
    let found = mesh
        .materials
        .iter()
        .map(|name| known.get(name).cloned().unwrap_or_else(|| Material::plain(name.clone())));
    looks.materials = found.collect();
    looks.rises = rises(&mesh.triangles);
    looks.material_of = mesh.material_of;
    Ok(looks)
}

/// The files that `mtllib` lines name. A name may hold spaces, and a line several names.
fn libraries(bytes: &[u8]) -> Vec<String> {
    let mut all: Vec<String> = vec![];
    let mut lines = TextLines::new(bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes));
    while let Some((_, line)) = lines.next() {
        let (b"mtllib", rest) = split_keyword(line) else { continue };
        let rest = String::from_utf8_lossy(rest).into_owned();
        let lower = rest.to_ascii_lowercase();
        let names: Vec<&str> = match lower.matches(".mtl").count() {
            0 | 1 => vec![rest.as_str()],
            _ => rest.split_whitespace().collect(),
        };
        for name in names {
            if !name.is_empty() && !all.iter().any(|known| known == name) {
                all.push(name.to_owned());
            }
        }
        if all.len() >= MOST_LIBRARIES {
            all.truncate(MOST_LIBRARIES);
            break;
        }
    }
    all
}

struct Reader<'a> {
    side: Side<'a>,
    numbers: BTreeMap<String, Result<usize, String>>,
    looks: Looks,
}

impl Reader<'_> {
    /// Adds the materials of a file that `wanted` names.
    fn read(&mut self, text: &[u8], wanted: &[String], known: &mut BTreeMap<String, Material>) {
        let mut current: Option<Material> = None;
        let mut lines = TextLines::new(text.strip_prefix(b"\xef\xbb\xbf").unwrap_or(text));
        while let Some((_, line)) = lines.next() {
            let (keyword, rest) = split_keyword(line);
            let keyword = keyword.to_ascii_lowercase();
            if keyword == b"newmtl" {
                keep(&mut current, known);
                let name = String::from_utf8_lossy(rest).into_owned();
                let is_new = wanted.contains(&name) && !known.contains_key(&name);
                current = is_new.then(|| Material::plain(name));
                continue;
            }
            let Some(material) = &mut current else { continue };
            match &keyword[..] {
                b"kd" => {
                    if let Some(colour) = numbers::<3>(rest) {
                        let colour = Vec3::from_array(colour).clamp(Vec3::ZERO, Vec3::ONE);
                        material.colour = (colour != Vec3::ONE).then_some(colour);
                    }
                }
                b"map_kd" => {
                    self.looks.names_colours = true;
                    material.colour_map = self.map(&material.name, "colour", rest).map(|(m, _)| m);
                }
                b"norm" | b"map_kn" => {
                    let map = self.map(&material.name, "normal", rest);
                    if let Some((map, scale)) = map {
                        (material.normal_map, material.normal_scale) = (Some(map), scale);
                    }
                }
                b"map_bump" | b"bump" if material.normal_map.is_none() => {
                    if let Some((map, scale)) = self.map(&material.name, "bump", rest) {
                        let map = TextureMap { doubtful: true, ..map };
                        (material.normal_map, material.normal_scale) = (Some(map), scale);
                    }
                }
                _ => {}
            }
        }
        keep(&mut current, known);
    }

    /// A map and its multiplier, or none and a remark.
    fn map(&mut self, material: &str, what: &str, rest: &[u8]) -> Option<(TextureMap, f32)> {
        let options = Options::of(rest);
        match self.picture(&options.name) {
            Ok(picture) => {
                let from =
                    Affine2::from_scale_angle_translation(options.scale, 0.0, options.offset);
                let wrap =
                    [if options.clamp { TextureWrap::Clamp } else { TextureWrap::Repeat }; 2];
                let map = TextureMap {
                    picture,
                    set: 0,
                    picture_from_uv: upright() * from,
                    wrap,
                    nearest: false,
                    doubtful: false,
                };
                Some((map, options.multiplier))
            }
            Err(reason) => {
                let material = excerpt(material.as_bytes());
                let remark =
                    format!("material \"{material}\": its {what} map is not shown: {reason}");
                if self.looks.remarks.len() < MOST_PICTURES {
                    self.looks.remarks.push(remark);
                }
                None
            }
        }
    }

    fn picture(&mut self, name: &str) -> Result<usize, String> {
        if let Some(known) = self.numbers.get(name) {
            return known.clone();
        }
        let shown = excerpt(name.as_bytes());
        let last = name.rsplit(['/', '\\']).next().unwrap_or_default();
        let tried = [plain_name(name), plain_name(last)];
        let bytes = tried.iter().flatten().find_map(|name| (self.side)(name));
        let found = match bytes {
            _ if self.numbers.len() >= MOST_PICTURES => {
                Err(format!("the file has more than {MOST_PICTURES} pictures"))
            }
            None => Err(format!("the file \"{shown}\" is missing: lay it beside the mesh")),
            Some(bytes) => {
                self.looks.pictures.push(Picture { name: shown, bytes });
                Ok(self.looks.pictures.len() - 1)
            }
        };
        if self.numbers.len() < MOST_PICTURES {
            self.numbers.insert(name.to_owned(), found.clone());
        }
        found
    }
}

fn keep(current: &mut Option<Material>, known: &mut BTreeMap<String, Material>) {
    let Some(mut material) = current.take() else { return };
    let dark = material.colour.is_some_and(|colour| colour.max_element() < BLACK);
    if material.colour_map.is_some() && dark {
        material.colour = None;
    }
    known.insert(material.name.clone(), material);
}

/// A relative name of a file beside or below, with `/` between folders; none where it leads elsewhere.
fn plain_name(name: &str) -> Option<String> {
    let name = name.replace('\\', "/");
    let is_elsewhere = name.starts_with('/') || name.contains(':');
    let steps: Vec<&str> = name.split('/').filter(|step| !matches!(*step, "" | ".")).collect();
    let is_plain = !is_elsewhere && !steps.is_empty() && !steps.contains(&"..");
    let printable = !name.chars().any(char::is_control);
    (is_plain && printable).then(|| steps.join("/"))
}

/// What stands before a map's name.
struct Options {
    name: String,
    scale: Vec2,
    offset: Vec2,
    multiplier: f32,
    clamp: bool,
}

impl Options {
    fn of(rest: &[u8]) -> Self {
        let mut options = Self {
            name: String::new(),
            scale: Vec2::ONE,
            offset: Vec2::ZERO,
            multiplier: 1.0,
            clamp: false,
        };
        let mut rest = rest.trim_ascii();
        while rest.starts_with(b"-") {
            let (option, after) = split_keyword(rest);
            // Vectors have one to three numbers; the rest have as many words as said here.
            let (fewest, most) = match option {
                b"-o" | b"-s" | b"-t" => (1, 3),
                b"-mm" => (2, 2),
                b"-bm" | b"-boost" | b"-texres" | b"-blendu" | b"-blendv" | b"-cc" | b"-clamp"
                | b"-imfchan" | b"-type" => (1, 1),
                // A name that begins with a dash.
                _ => break,
            };
            let (mut after, mut given) = (after, vec![]);
            while given.len() < most {
                let (word, behind) = split_keyword(after);
                if word.is_empty() || (given.len() >= fewest && number(word).is_none()) {
                    break;
                }
                given.push(word);
                after = behind;
            }
            let value = |i: usize| given.get(i).copied().and_then(number);
            let pair = |or: Vec2| Vec2::new(value(0).unwrap_or(or.x), value(1).unwrap_or(or.y));
            match option {
                b"-o" => options.offset = pair(options.offset),
                b"-s" => options.scale = pair(options.scale),
                b"-bm" => options.multiplier = value(0).unwrap_or(1.0).clamp(-16.0, 16.0),
                b"-clamp" => options.clamp = given.first() == Some(&&b"on"[..]),
                _ => {}
            }
            rest = after;
        }
        options.name = String::from_utf8_lossy(rest).into_owned();
        options
    }
}

fn number(word: &[u8]) -> Option<f32> {
    std::str::from_utf8(word).ok()?.parse().ok().filter(|x: &f32| x.is_finite())
}

fn numbers<const N: usize>(rest: &[u8]) -> Option<[f32; N]> {
    let mut all = [0.0; N];
    let mut found = words(rest);
    for to in &mut all {
        *to = number(found.next()?)?;
    }
    Some(all)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::formats::read_looks;
    use std::sync::Arc;

    const OBJ: &[u8] = b"mtllib my head.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\n\
        usemtl skin\nf 1/1 2/2 3/3\nusemtl cloth\nf 3/3 1/1 2/2\n";

    fn looks(mtl: &str) -> Looks {
        let side = |name: &str| match name {
            "my head.mtl" => Some(Arc::from(mtl.as_bytes())),
            "maps/face 1.png" | "face.png" => Some(Arc::from(name.as_bytes())),
            _ => None,
        };
        read_looks("OBJ", OBJ, &side).expect("a mesh")
    }

    #[test]
    fn materials_go_by_name_and_maps_by_path_or_by_name_alone() {
        for (path, found) in [
            ("maps/face 1.png", "maps/face 1.png"),
            ("maps\\face 1.png", "maps/face 1.png"),
            ("C:\\me\\maps\\face.png", "face.png"),
            ("/home/me/face.png", "face.png"),
            ("../face.png", "face.png"),
        ] {
            let looks =
                looks(&format!("newmtl other\nmap_Kd x\nnewmtl skin\nKd 1 1 1\nmap_Kd {path}\n"));
            assert_eq!((looks.material_of, looks.rises), (vec![0, 1], vec![true, true]));
            let map = looks.materials[0].colour_map.as_ref().expect(path);
            assert_eq!(&*looks.pictures[map.picture].bytes, found.as_bytes());
            assert_eq!((looks.materials[0].colour, looks.remarks), (None, vec![]));
            assert!(looks.materials[1].colour_map.is_none());
        }
    }

    #[test]
    fn options_of_a_map_move_it() {
        let looks = looks(
            "newmtl skin\nmap_Kd -clamp on -s 2 4 -o 0.5 0.25 0 -blendu on face.png\nbump -bm 0.5 face.png\n",
        );
        let material = &looks.materials[0];
        let map = material.colour_map.as_ref().expect("a map");
        // (0.25, 0.125), v up, scaled: (0.5, 0.5); moved: (1, 0.75); from the top: (1, 0.25).
        let at = map.picture_from_uv.transform_point2(Vec2::new(0.25, 0.125));
        assert!(at.distance(Vec2::new(1.0, 0.25)) < 1e-6, "{at}");
        assert_eq!(map.wrap, [TextureWrap::Clamp; 2]);
        let bump = material.normal_map.as_ref().expect("a map");
        assert!(bump.doubtful && material.normal_scale == 0.5);
    }

    #[test]
    fn black_over_a_map_is_no_colour_and_alone_it_is() {
        assert_eq!(looks("newmtl skin\nKd 0 0 0\nmap_Kd face.png").materials[0].colour, None);
        let mtl = "newmtl skin\nKd 0 0 0\nnewmtl cloth\nKd 0.5 0.25 0\n";
        let colours: Vec<_> = looks(mtl).materials.iter().map(|m| m.colour).collect();
        assert_eq!(colours, [Some(Vec3::ZERO), Some(Vec3::new(0.5, 0.25, 0.0))]);
    }

    #[test]
    fn what_is_missing_is_told() {
        let missing = looks("newmtl skin\nmap_Kd gone.png\n").remarks;
        let says = "material \"skin\": its colour map is not shown: the file \"gone.png\" is missing: lay it beside the mesh";
        assert_eq!(missing, [says]);
        let none = read_looks("obj", OBJ, &|_| None).expect("a mesh");
        assert_eq!(
            none.remarks,
            ["the file \"my head.mtl\" of its materials is missing beside it"]
        );
    }
}
