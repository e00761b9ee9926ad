//! Materials of a glTF file, for whoever draws it: base colours and normal maps of those that triangles have.
//!
//! Source: glTF 2.0 specification, sections 3.8 to 3.9; KHR_texture_transform and, for old files,
//! KHR_materials_pbrSpecularGlossiness. Not read: roughness, light that a material gives off, and pictures of other formats than
//! PNG and JPEG (WebP, KTX2), which are told.

use super::buffers::{Buffers, decode_data_uri, is_data, side_name};
use super::json::{Doc, JsonValue};
use super::{Table, Tables, Take, glb, index_or, name_of, read_as, whole_or};
use crate::data::mesh::MeshError;
use crate::formats::looks::{Looks, Material, Picture, TextureMap, TextureWrap, rises, upright};
use crate::formats::mesh_in::limits::{Budget, excerpt};
use crate::formats::mesh_in::{NAMELESS, Side};
use crate::maths::transcendental::sin_cos;
use glam::{Affine2, Mat2, Vec2, Vec3};
use std::collections::BTreeMap;
use std::sync::Arc;

/// Materials whose maps are shown, and pictures; the rest is told.
const MOST: usize = 256;
/// Opacity that counts as there, where the file gives no limit but mixes.
const HALF: f32 = 0.5;

/// Reads the looks of a `.gltf` or `.glb`.
///
/// # Errors
/// Those of [`read`](super::read).
pub(in crate::formats) fn read_looks(bytes: &[u8], side: Side) -> Result<Looks, MeshError> {
    let mesh = read_as(bytes, side, Take { numbered: true, ..Take::default() })?;
    let parts = glb::split(bytes)?;
    let mut budget = Budget::new(bytes.len());
    let doc = Doc::parse(parts.json, &mut budget)?;
    let tables = Tables::new(&doc, Take::default(), &mut budget)?;
    let mut reader = Reader {
        textures: Table::new(&doc, "textures", &mut budget)?,
        images: Table::new(&doc, "images", &mut budget)?,
        samplers: Table::new(&doc, "samplers", &mut budget)?,
        tables: &tables,
        buffers: Buffers::new(parts.bin, side),
        side,
        budget,
        numbers: BTreeMap::new(),
        looks: Looks::default(),
    };
    for number in &mesh.materials {
        let material = match number.parse() {
            Ok(number) => reader.material(number)?,
            Err(_) => Material::plain(NAMELESS.to_owned()),
        };
        doc.tire(20)?;
        reader.looks.materials.push(material);
    }
    let mut looks = reader.looks;
    let maps = looks.materials.iter().flat_map(|m| [&m.colour_map, &m.normal_map]).flatten();
    let sets: Vec<u32> = maps.map(|map| map.set).filter(|set| *set != 0).collect();
    for uv_set in sets {
        if looks.uvs.contains_key(&uv_set) {
            continue;
        }
        let uvs = read_as(bytes, side, Take { uv_set, ..Take::default() })?.uvs;
        looks.uvs.insert(uv_set, uvs.unwrap_or_default());
    }
    looks.rises = rises(&mesh.triangles);
    looks.material_of = mesh.material_of;
    Ok(looks)
}

struct Reader<'r, 'a> {
    tables: &'r Tables<'a>,
    textures: Table<'a>,
    images: Table<'a>,
    samplers: Table<'a>,
    buffers: Buffers<'a>,
    side: Side<'a>,
    budget: Budget,
    /// Of the file's pictures those that are shown, or why they cannot be.
    numbers: BTreeMap<u32, Result<usize, String>>,
    looks: Looks,
}

impl<'a> Reader<'_, 'a> {
    fn material(&mut self, number: u32) -> Result<Material, MeshError> {
        let json = self.tables.materials.item(number, "a primitive")?;
        let name = name_of(json).map_or_else(|| format!("material {number}"), str::to_owned);
        let mut material = Material::plain(name);
        let extension =
            |name: &str| json.get("extensions").and_then(|extensions| extensions.get(name));
        let old = extension("KHR_materials_pbrSpecularGlossiness");
        let (body, factor, map) = match (json.get("pbrMetallicRoughness"), old) {
            (_, Some(old)) => (Some(old), "diffuseFactor", "diffuseTexture"),
            (body, None) => (body, "baseColorFactor", "baseColorTexture"),
        };
        let factor = body.and_then(|body| numbers::<4>(body.get(factor)?));
        if let Some([r, g, b, _]) = factor {
            let colour = Vec3::new(r, g, b).clamp(Vec3::ZERO, Vec3::ONE);
            material.colour = (colour != Vec3::ONE).then_some(colour);
        }
        let colour_map = body.and_then(|body| body.get(map));
        self.looks.names_colours |= colour_map.is_some();
        material.colour_map = self.map(&material.name, "base colour", colour_map);
        let normal_map = json.get("normalTexture");
        material.normal_map = self.map(&material.name, "normal", normal_map);
        if let Some(scale) = normal_map.and_then(|map| real(map.get("scale")?)) {
            material.normal_scale = scale.clamp(-16.0, 16.0);
        }
        material.cutoff = match json.get("alphaMode").and_then(JsonValue::text) {
            Some("MASK") => json.get("alphaCutoff").and_then(real).unwrap_or(HALF).clamp(0.0, 1.0),
            Some("BLEND") => HALF,
            _ => 0.0,
        };
        Ok(material)
    }

    /// A map, or none and a remark.
    fn map(
        &mut self,
        material: &str,
        what: &str,
        info: Option<JsonValue<'a>>,
    ) -> Option<TextureMap> {
        match self.found(info?) {
            Ok(map) => Some(map),
            Err(reason) => {
                let material = excerpt(material.as_bytes());
                let remark =
                    format!("material \"{material}\": its {what} map is not shown: {reason}");
                if self.looks.remarks.len() < MOST {
                    self.looks.remarks.push(remark);
                }
                None
            }
        }
    }

    fn found(&mut self, info: JsonValue<'a>) -> Result<TextureMap, String> {
        let said = |err: MeshError| err.to_string();
        let number = index_or(info, "index", "a map").map_err(said)?;
        let number = number.ok_or_else(|| "it names no texture".to_owned())?;
        let texture = self.textures.item(number, "a map").map_err(said)?;
        let place = format!("textures[{number}]");
        let Some(image) = index_or(texture, "source", &place).map_err(said)? else {
            let extension = texture.get("extensions").and_then(|all| all.members().next());
            return Err(match extension {
                Some((name, _)) => format!(
                    "its picture is of a kind that is not read ({}): save it as PNG or JPEG",
                    excerpt(name.as_bytes())
                ),
                None => format!("{place} names no picture"),
            });
        };
        let (mut wrap, mut nearest) = ([TextureWrap::Repeat; 2], false);
        if let Some(number) = index_or(texture, "sampler", &place).map_err(said)? {
            let sampler = self.samplers.item(number, &place).map_err(said)?;
            wrap =
                ["wrapS", "wrapT"].map(|key| match sampler.get(key).and_then(JsonValue::whole) {
                    Some(33071) => TextureWrap::Clamp,
                    Some(33648) => TextureWrap::Mirror,
                    _ => TextureWrap::Repeat,
                });
            nearest = sampler.get("magFilter").and_then(JsonValue::whole) == Some(9728);
        }
        let mut set = whole_or(info, "texCoord", Some(0), "a map").map_err(said)?;
        let mut picture_from_uv = upright();
        let moved = info.get("extensions").and_then(|e| e.get("KHR_texture_transform"));
        if let Some(moved) = moved {
            set = whole_or(moved, "texCoord", Some(set), "a map").map_err(said)?;
            picture_from_uv = transform(moved) * picture_from_uv;
        }
        let set = u32::try_from(set).ok().filter(|set| *set < 16);
        let set = set.ok_or_else(|| "it lies by a set of uvs beyond the 15th".to_owned())?;
        let picture = self.picture(image)?;
        Ok(TextureMap { picture, set, picture_from_uv, wrap, nearest, doubtful: false })
    }

    fn picture(&mut self, number: u32) -> Result<usize, String> {
        if let Some(known) = self.numbers.get(&number) {
            return known.clone();
        }
        let read = match self.looks.pictures.len() < MOST {
            true => self.read(number),
            false => Err(format!("the file has more than {MOST} pictures")),
        };
        let found = read.map(|picture| {
            self.looks.pictures.push(picture);
            self.looks.pictures.len() - 1
        });
        self.numbers.insert(number, found.clone());
        found
    }

    fn read(&mut self, number: u32) -> Result<Picture, String> {
        let said = |err: MeshError| err.to_string();
        let place = format!("images[{number}]");
        let image = self.images.item(number, "a texture").map_err(said)?;
        let name = name_of(image).map_or_else(|| place.clone(), |n| excerpt(n.as_bytes()));
        let bytes: Arc<[u8]> = match image.get("uri").and_then(JsonValue::text) {
            Some(uri) if is_data(uri) => {
                self.budget.take(&place, 2 * uri.len() as u64).map_err(said)?;
                decode_data_uri(uri).map_err(|e| format!("{place}: {e}"))?.into()
            }
            Some(uri) => {
                let file = side_name(uri)?;
                let bytes = (self.side)(&file);
                let file = excerpt(file.as_bytes());
                let bytes =
                    bytes.ok_or_else(|| format!("the file \"{file}\" beside it is missing"))?;
                return Ok(Picture { name: file, bytes });
            }
            None => self.view(image, &place).map_err(said)?,
        };
        Ok(Picture { name, bytes })
    }

    /// The bytes of a picture that lies in a buffer.
    fn view(&mut self, image: JsonValue<'a>, place: &str) -> Result<Arc<[u8]>, MeshError> {
        let Some(number) = index_or(image, "bufferView", place)? else {
            return Err(MeshError::at(place, "it has neither a uri nor a bufferView"));
        };
        let view = self.tables.views.item(number, place)?;
        let place = format!("bufferViews[{number}]");
        let Some(buffer) = index_or(view, "buffer", &place)? else {
            return Err(MeshError::at(place, "buffer is missing"));
        };
        let start = whole_or(view, "byteOffset", Some(0), &place)?;
        let length = whole_or(view, "byteLength", None, &place)?;
        self.buffers.open(self.tables, buffer, &place, &mut self.budget)?;
        self.budget.take(&place, length)?;
        let range = usize::try_from(start)
            .ok()
            .zip(start.checked_add(length).and_then(|end| usize::try_from(end).ok()));
        let bytes = self.buffers.get(buffer).unwrap_or_default();
        let found = range.and_then(|(start, end)| bytes.get(start..end));
        let beyond = || MeshError::at(&place, "it reaches past the end of its buffer");
        Ok(found.ok_or_else(beyond)?.into())
    }
}

/// KHR_texture_transform: scaled, turned counter-clockwise as one looks at the picture, then moved. From v down to v down. (The
/// formula in the extension's text turns the other way than its words; programs follow the words.)
fn transform(json: JsonValue) -> Affine2 {
    let pair = |key: &str, or: Vec2| {
        json.get(key).and_then(|value| numbers::<2>(value)).map_or(or, Vec2::from_array)
    };
    let turn = json.get("rotation").and_then(real).filter(|turn| turn.abs() < 1e4).unwrap_or(0.0);
    let (sin, cos) = sin_cos(turn);
    let turned = Mat2::from_cols(Vec2::new(cos, -sin), Vec2::new(sin, cos));
    let scaled = Mat2::from_diagonal(pair("scale", Vec2::ONE));
    Affine2::from_mat2_translation(turned * scaled, pair("offset", Vec2::ZERO))
}

fn real(value: JsonValue) -> Option<f32> {
    value.number().map(|x| x as f32).filter(|x| x.is_finite())
}

/// As many finite numbers; three stand for four with a last 1.
fn numbers<const N: usize>(value: JsonValue) -> Option<[f32; N]> {
    let mut all = [1.0; N];
    let mut n = 0;
    for (to, value) in all.iter_mut().zip(value.items()) {
        *to = real(value)?;
        n += 1;
    }
    (n + usize::from(N == 4) >= N).then_some(all)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A triangle with two sets of uvs, three materials' worth of JSON, and what was read of the first.
    fn looks(more: &str, material: &str) -> Looks {
        let mut bin = vec![];
        let corners = [[0f32, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
        corners.iter().flatten().for_each(|x| bin.extend(x.to_le_bytes()));
        for set in [0.0f32, 0.5] {
            let uvs = corners.iter().flat_map(|[x, y, _]| [x * 0.25 + set, y * 0.25 + set]);
            uvs.for_each(|x| bin.extend(x.to_le_bytes()));
        }
        bin.extend(*b"picture!");
        let json = format!(
            r#"{{"asset":{{"version":"2.0"}},"scenes":[{{"nodes":[0]}}],"nodes":[{{"mesh":0}}],
            "buffers":[{{"uri":"a.bin","byteLength":92}}],
            "bufferViews":[{{"buffer":0,"byteLength":36}},{{"buffer":0,"byteOffset":36,"byteLength":24}},
              {{"buffer":0,"byteOffset":60,"byteLength":24}},{{"buffer":0,"byteOffset":84,"byteLength":8}}],
            "accessors":[{{"bufferView":0,"componentType":5126,"type":"VEC3","count":3}},
              {{"bufferView":1,"componentType":5126,"type":"VEC2","count":3}},
              {{"bufferView":2,"componentType":5126,"type":"VEC2","count":3}}],
            "meshes":[{{"primitives":[{{"attributes":{{"POSITION":0,"TEXCOORD_0":1,"TEXCOORD_1":2}},"material":0}}]}}],
            "materials":[{material}]{more}}}"#
        );
        let side = |name: &str| match name {
            "a.bin" => Some(Arc::from(&bin[..])),
            "maps/face 1.jpg" => Some(Arc::from(&b"beside"[..])),
            _ => None,
        };
        crate::formats::read_looks("gltf", json.as_bytes(), &side).expect("a mesh")
    }

    const PICTURES: &str = r#","images":[{"bufferView":3,"mimeType":"image/png"},
        {"uri":"maps/face%201.jpg"},{"uri":"data:image/png;base64,Zm9v"},{"uri":"none.png"}],
        "samplers":[{"wrapS":33071,"wrapT":33648,"magFilter":9728}],
        "textures":[{"source":0,"sampler":0},{"source":1},{"source":2},{"source":3},
        {"extensions":{"KHR_texture_basisu":{"source":0}}}]"#;

    fn base(map: &str) -> String {
        format!(r#"{{"name":"Face","pbrMetallicRoughness":{{"baseColorTexture":{map}}}}}"#)
    }

    #[test]
    fn pictures_come_from_buffers_data_uris_and_files_beside() {
        for (texture, bytes) in [(0, "picture!"), (1, "beside"), (2, "foo")] {
            let looks = looks(PICTURES, &base(&format!(r#"{{"index":{texture}}}"#)));
            let map = looks.materials[0].colour_map.as_ref().expect("a map");
            assert_eq!(&*looks.pictures[map.picture].bytes, bytes.as_bytes());
            let wrap = if texture == 0 {
                [TextureWrap::Clamp, TextureWrap::Mirror]
            } else {
                [TextureWrap::Repeat; 2]
            };
            assert_eq!((map.wrap, map.nearest, map.set), (wrap, texture == 0, 0));
            assert_eq!((looks.material_of, looks.rises), (vec![0], vec![true]));
        }
    }

    #[test]
    fn what_cannot_be_had_is_told_with_its_material() {
        for (texture, says) in [
            (3, "the file \"none.png\" beside it is missing"),
            (4, "(KHR_texture_basisu): save it as PNG or JPEG"),
            (5, "textures[5], where there are 5"),
        ] {
            let looks = looks(PICTURES, &base(&format!(r#"{{"index":{texture}}}"#)));
            assert!(looks.materials[0].colour_map.is_none());
            let [remark] = &looks.remarks[..] else { panic!("{:?}", looks.remarks) };
            let begins = "material \"Face\": its base colour map is not shown: ";
            assert!(remark.starts_with(begins) && remark.contains(says), "{remark}");
        }
    }

    #[test]
    fn a_map_lies_by_the_set_of_uvs_that_it_names_moved_as_it_says() {
        let moved = r#"{"index":0,"texCoord":0,"extensions":{"KHR_texture_transform":
            {"offset":[0.5,0.25],"rotation":1.5707963267948966,"scale":[2,4],"texCoord":1}}}"#;
        let looks = looks(PICTURES, &base(moved));
        let map = looks.materials[0].colour_map.as_ref().expect("a map");
        assert_eq!(map.set, 1);
        // The file's second set begins at (0.5, 0.5), v down; v up that is (0.5, 0.5) too.
        let uv = looks.uvs[&1][0][0];
        assert_eq!(uv, Vec2::splat(0.5));
        // Scaled: (1, 2). A quarter turn counter-clockwise in a picture that goes down: (x, y) becomes (y, -x): (2, -1).
        // Moved: (2.5, -0.75).
        let at = map.picture_from_uv.transform_point2(uv);
        assert!(at.distance(Vec2::new(2.5, -0.75)) < 1e-6, "{at}");
    }

    #[test]
    fn colours_that_are_plain_white_are_none() {
        for (factor, colour) in [
            ("[1,1,1,1]", None),
            ("[1,1,1,0.5]", None),
            ("[0.5,0.25,2,1]", Some(Vec3::new(0.5, 0.25, 1.0))),
            ("[0.5,\"x\",0,1]", None),
        ] {
            let json = format!(r#"{{"pbrMetallicRoughness":{{"baseColorFactor":{factor}}}}}"#);
            let looks = looks("", &json);
            assert_eq!(looks.materials[0].colour, colour, "{factor}");
            assert_eq!(looks.materials[0].name, "material 0");
        }
    }

    #[test]
    fn what_lets_light_through_is_cut_out() {
        for (mode, cutoff) in [
            (r#""alphaMode":"MASK","alphaCutoff":0.25"#, 0.25),
            (r#""alphaMode":"MASK""#, 0.5),
            (r#""alphaMode":"BLEND""#, 0.5),
            (r#""alphaMode":"OPAQUE""#, 0.0),
        ] {
            assert_eq!(looks("", &format!("{{{mode}}}")).materials[0].cutoff, cutoff);
        }
    }
}
