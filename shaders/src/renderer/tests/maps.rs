//! Pictures on heads: each colour is where its uv says, and a normal map shades as a surface that is tilted so.

use super::*;
use crate::maps::{Kind, Map, MaterialMaps, Texels};
use crate::surface::{Mapped, Tone, head_with_maps};
use coif_nodes::data::scalp::{HeadFrame, REGION, Scalp};
use coif_nodes::formats::looks::{Looks, TextureWrap, read_looks};
use coif_nodes::formats::read_mesh;
use coif_nodes::maths::closest::Surface;
use glam::Affine2;
use image::{DynamicImage, ImageFormat, Rgb, RgbImage};
use std::io::Cursor;

const RED: [u8; 3] = [200, 20, 20];
const GREEN: [u8; 3] = [20, 200, 20];
const BLUE: [u8; 3] = [20, 20, 200];
const YELLOW: [u8; 3] = [200, 200, 20];

fn png(picture: RgbImage) -> Vec<u8> {
    let mut bytes = Cursor::new(vec![]);
    DynamicImage::from(picture).write_to(&mut bytes, ImageFormat::Png).expect("a PNG");
    bytes.into_inner()
}

/// A ball of 6 cm, u from its back to its right about it and v from its top down, and its looks; `material` is the JSON of its
/// only one. The picture is red and green above blue and yellow.
fn ball(material: &str) -> (Scalp, Looks) {
    const ROWS: u16 = 16;
    const COLUMNS: u16 = 32;
    let (mut bin, mut uvs, mut indices) = (vec![], vec![], vec![]);
    for i in 0..=ROWS {
        for j in 0..=COLUMNS {
            let (u, v) = (f32::from(j) / f32::from(COLUMNS), f32::from(i) / f32::from(ROWS));
            let (a, b) = (std::f32::consts::PI * v, std::f32::consts::TAU * (u - 0.5));
            let p = Vec3::new(a.sin() * b.sin(), a.cos(), a.sin() * b.cos()) * 0.06;
            p.to_array().iter().for_each(|x| bin.extend(x.to_le_bytes()));
            [u, v].iter().for_each(|x| uvs.extend(x.to_le_bytes()));
            if i < ROWS && j < COLUMNS {
                let at = i * (COLUMNS + 1) + j;
                let (down, right) = (at + COLUMNS + 1, at + 1);
                indices.extend([at, down, right, right, down, down + 1]);
            }
        }
    }
    let (points, all) = (bin.len() / 12, indices.len());
    let (at_uvs, at_indices) = (bin.len(), bin.len() + uvs.len());
    bin.extend(uvs);
    indices.iter().for_each(|i| bin.extend(i.to_le_bytes()));
    let whole = bin.len();
    let json = format!(
        r#"{{"asset":{{"version":"2.0"}},"scenes":[{{"nodes":[0]}}],"nodes":[{{"mesh":0}}],
        "buffers":[{{"uri":"ball.bin","byteLength":{whole}}}],
        "bufferViews":[{{"buffer":0,"byteLength":{at_uvs}}},
          {{"buffer":0,"byteOffset":{at_uvs},"byteLength":{}}},
          {{"buffer":0,"byteOffset":{at_indices},"byteLength":{}}}],
        "accessors":[{{"bufferView":0,"componentType":5126,"type":"VEC3","count":{points}}},
          {{"bufferView":1,"componentType":5126,"type":"VEC2","count":{points}}},
          {{"bufferView":2,"componentType":5123,"type":"SCALAR","count":{all}}}],
        "meshes":[{{"primitives":[{{"attributes":{{"POSITION":0,"TEXCOORD_0":1}},"indices":2,"material":0}}]}}],
        "images":[{{"uri":"face.png"}}],"textures":[{{"source":0}}],"materials":[{material}]}}"#,
        at_indices - at_uvs,
        whole - at_indices,
    );
    let quarters = RgbImage::from_fn(64, 64, |x, y| {
        Rgb(match (x < 32, y < 32) {
            (true, true) => RED,
            (false, true) => GREEN,
            (true, false) => BLUE,
            (false, false) => YELLOW,
        })
    });
    let side = |name: &str| match name {
        "ball.bin" => Some(Arc::from(&bin[..])),
        _ => Some(Arc::from(png(quarters.clone()))),
    };
    let mesh = read_mesh("gltf", json.as_bytes(), &side).expect("a mesh");
    let looks = read_looks("gltf", json.as_bytes(), &side).expect("its looks");
    let points: Vec<Vec3> = mesh.points.iter().map(|p| *p * 100.0).collect();
    let grows = vec![1.0; points.len()];
    let surface = Surface::new(points, mesh.triangles);
    let masks = [(REGION.to_owned(), grows)].into();
    (Scalp::new(surface, mesh.uvs, HeadFrame::IDENTITY, masks), looks)
}

/// The ball as its file says.
fn head(scalp: &Scalp, looks: &Looks) -> Solid {
    let materials: Vec<MaterialMaps> = looks
        .materials
        .iter()
        .map(|material| MaterialMaps {
            colour: material.colour,
            colour_map: material.colour_map.as_ref().map(|map| Map {
                texels: Arc::new(
                    Texels::read(&looks.pictures[map.picture].bytes, Kind::Colour).expect("a PNG"),
                ),
                set: map.set,
                picture_from_uv: map.picture_from_uv,
                wrap: map.wrap,
                nearest: map.nearest,
            }),
            normal_map: None,
            normal_scale: 1.0,
            cutoff: material.cutoff,
        })
        .collect();
    head_with_maps(scalp, Tone::Monk(5), looks, &materials.into()).expect("its own looks")
}

/// The light of some places of a picture of solids alone, ten pixels a cm about the middle.
fn seen(
    renderer: &mut Renderer,
    rig: &str,
    solid: Solid,
    from: Vec3,
    places: &[(f32, f32)],
) -> Vec<Vec3> {
    let mut scene = Scene::of(vec![]);
    scene.rig = Rig::named(rig).expect("a rig");
    scene.solids = vec![solid];
    scene.camera = Camera { eye: from, orthographic: Some(16.0), ..scene.camera };
    renderer.resize(160, 160).expect("a small picture");
    let picture = scene.draw(renderer);
    let at = |(x, y): &(f32, f32)| {
        let [u, v] = [80.0 + 10.0 * x, 80.0 - 10.0 * y].map(|n| n as usize);
        let [r, g, b, _] = picture.linear[v * 160 + u];
        Vec3::new(r, g, b)
    };
    places.iter().map(at).collect()
}

/// Which of the four colours a light is nearest to, by its hue.
fn colour_of(light: Vec3) -> &'static str {
    let linear = |c: [u8; 3]| Vec3::from(c.map(|n| (f32::from(n) / 255.0).powf(2.2)));
    let all = [("red", RED), ("green", GREEN), ("blue", BLUE), ("yellow", YELLOW)];
    let likeness = |c: [u8; 3]| light.normalize_or_zero().dot(linear(c).normalize());
    let (name, best) = all
        .map(|(name, c)| (name, likeness(c)))
        .into_iter()
        .max_by(|a, b| a.1.total_cmp(&b.1))
        .expect("four");
    if best > 0.95 { name } else { "none" }
}

#[test]
fn each_colour_of_a_head_is_where_its_uv_says_also_at_the_seam() {
    let test = "each_colour_of_a_head_is_where_its_uv_says_also_at_the_seam";
    let Some(mut renderer) = renderer(test) else { return };
    let map = |more: &str| {
        format!(r#"{{"pbrMetallicRoughness":{{"baseColorTexture":{{"index":0{more}}}}}}}"#)
    };
    let corners = [(-2.0, 2.0), (2.0, 2.0), (-2.0, -2.0), (2.0, -2.0)];
    let near_seam = [(-0.4, 2.0), (0.4, 2.0), (-0.4, -2.0), (0.4, -2.0)];
    let shifted = r#","extensions":{"KHR_texture_transform":{"offset":[0.5,0]}}"#;
    for (what, more, from, places, colours) in [
        // From before, u grows to the right and v down, as the picture does.
        ("before", "", Vec3::Z, corners, ["red", "green", "blue", "yellow"]),
        // From behind, its left is the head's own right side, of u over a half.
        ("behind", "", Vec3::NEG_Z, corners, ["green", "red", "yellow", "blue"]),
        ("at the seam", "", Vec3::NEG_Z, near_seam, ["green", "red", "yellow", "blue"]),
        // Half a picture on: what was right is left.
        ("shifted", shifted, Vec3::Z, corners, ["green", "red", "yellow", "blue"]),
    ] {
        let (scalp, looks) = ball(&map(more));
        let lights = seen(&mut renderer, "flat", head(&scalp, &looks), from * 50.0, &places);
        assert_eq!(lights.iter().map(|c| colour_of(*c)).collect::<Vec<_>>(), colours, "{what}");
    }
    // A factor takes the red away: red turns black and yellow green.
    let tinted =
        r#"{"pbrMetallicRoughness":{"baseColorTexture":{"index":0},"baseColorFactor":[0,1,1,1]}}"#;
    let (scalp, looks) = ball(tinted);
    let lights = seen(&mut renderer, "flat", head(&scalp, &looks), Vec3::Z * 50.0, &corners);
    assert_eq!(colour_of(lights[3]), "green");
    assert!(lights[0].max_element() < 0.2 * lights[1].max_element(), "{lights:?}");
    // Without a map its colour is the factor alone.
    let (scalp, looks) = ball(r#"{"pbrMetallicRoughness":{"baseColorFactor":[0,0,0.6,1]}}"#);
    let lights = seen(&mut renderer, "flat", head(&scalp, &looks), Vec3::Z * 50.0, &corners);
    assert!(lights.iter().all(|c| colour_of(*c) == "blue"), "{lights:?}");
}

#[test]
fn every_triangle_of_a_mapped_head_is_there_once_and_files_that_changed_are_told() {
    let (scalp, looks) = ball(r#"{"pbrMetallicRoughness":{"baseColorTexture":{"index":0}}}"#);
    let solid = head(&scalp, &looks);
    let surface = scalp.surface();
    assert_eq!(solid.triangles.len(), surface.triangles.len());
    let place =
        |solid: &[Vec3], t: &[u32; 3]| t.map(|v| solid[v as usize].to_array().map(f32::to_bits));
    let mut ours: Vec<_> = solid.triangles.iter().map(|t| place(&solid.points, t)).collect();
    let mut theirs: Vec<_> = surface.triangles.iter().map(|t| place(&surface.points, t)).collect();
    ours.sort_unstable();
    theirs.sort_unstable();
    assert_eq!(ours, theirs);
    // A vertex of the seam stands twice: more points than the welded mesh has.
    assert!(solid.points.len() > surface.points.len());
    let mut other = looks.clone();
    other.rises.pop();
    let materials: Arc<[MaterialMaps]> = vec![].into();
    assert!(head_with_maps(&scalp, Tone::Monk(5), &other, &materials).is_err());
}

#[test]
fn what_was_left_out_or_turned_round_since_leaves_maps_where_they_lie() {
    let (scalp, mut looks) = ball(r#"{"pbrMetallicRoughness":{"baseColorTexture":{"index":0}}}"#);
    // The corners of each triangle with their places in the map, in any order.
    let corners = |solid: &Solid| {
        let maps = solid.maps.as_ref().expect("maps");
        let corner = |v: &u32| {
            let (p, [uv, _]) = (solid.points[*v as usize], maps.uvs[*v as usize]);
            [p.x, p.y, p.z, uv.x, uv.y].map(f32::to_bits)
        };
        let triangle = |t: &[u32; 3]| {
            let mut all: Vec<_> = t.iter().map(corner).collect();
            all.sort_unstable();
            all
        };
        solid.triangles.iter().map(triangle).collect::<std::collections::BTreeSet<_>>()
    };
    let whole = corners(&head(&scalp, &looks));
    // A hundred triangles fewer, every third of the rest turned round, and uvs that lie in a second set of the file.
    let surface = scalp.surface();
    let kept: Vec<u32> = (100..surface.triangles.len() as u32).collect();
    let turned = kept.iter().map(|t| {
        let [a, b, c] = surface.triangles[*t as usize];
        if t % 3 == 0 { [a, c, b] } else { [a, b, c] }
    });
    let rest = Surface::new(surface.points.clone(), turned.collect());
    let masks = [(REGION.to_owned(), vec![1.0; surface.points.len()])].into();
    let count = kept.len();
    let rest = Scalp::new(rest, None, HeadFrame::IDENTITY, masks).with_kept(Some(kept));
    looks.uvs.insert(1, scalp.uvs().expect("uvs").to_vec());
    looks.materials[0].colour_map.as_mut().expect("a map").set = 1;
    let ours = corners(&head(&rest, &looks));
    assert!(ours.len() > count - 40, "all but those without area at the poles");
    assert_eq!(ours.difference(&whole).count(), 0);
}

/// A sheet with a normal map of one colour; `turn` leads from its x and y, -4 to 4 cm, to the picture.
fn tilted_sheet(pixel: [u8; 3], normal_scale: f32, turn: fn(Vec3) -> Vec2) -> Solid {
    let picture = png(RgbImage::from_pixel(4, 4, Rgb(pixel)));
    let map = Map {
        texels: Arc::new(Texels::read(&picture, Kind::Normal).expect("a PNG")),
        set: 0,
        picture_from_uv: Affine2::IDENTITY,
        wrap: [TextureWrap::Repeat; 2],
        nearest: false,
    };
    let material = MaterialMaps {
        colour: None,
        colour_map: None,
        normal_map: Some(map),
        normal_scale,
        cutoff: 0.0,
    };
    let sheet = sheet(0.0);
    let uvs = sheet.points.iter().map(|p| [Vec2::ZERO, turn(*p)]).collect();
    let maps = Mapped { uvs, runs: vec![(0..2, 0)], materials: vec![material].into() };
    Solid { maps: Some(maps), ..sheet }
}

#[test]
fn a_normal_map_shades_as_a_surface_that_is_tilted_so() {
    let Some(mut renderer) = renderer("a_normal_map_shades_as_a_surface_that_is_tilted_so") else {
        return;
    };
    // 204 of 255 is 0.6, 230 is 0.8, 128 is 0.
    let (right, up) = ([204, 128, 230], [128, 204, 230]);
    let plain = |p: Vec3| Vec2::new(p.x, -p.y) / 8.0;
    let mut shades = vec![];
    for (what, pixel, scale, turn, normal) in [
        ("right", right, 1.0, plain as fn(Vec3) -> Vec2, Vec3::new(0.6, 0.0, 0.8)),
        ("green is up", up, 1.0, plain, Vec3::new(0.0, 0.6, 0.8)),
        ("half as far", right, 0.5, plain, Vec3::new(0.3, 0.0, 0.8)),
        // The picture mirrored: its right is the sheet's left.
        ("mirrored", right, 1.0, |p| Vec2::new(-p.x, -p.y) / 8.0, Vec3::new(-0.6, 0.0, 0.8)),
        // The picture's right is up on the sheet, its top on the left.
        ("turned", right, 1.0, |p| Vec2::new(p.y, p.x) / 8.0, Vec3::new(0.0, 0.6, 0.8)),
        // Uvs that stand still tilt nothing.
        ("still", right, 1.0, |_| Vec2::ZERO, Vec3::Z),
    ] {
        let places = [(0.0, 0.0), (2.5, -1.5)];
        let ours = seen(
            &mut renderer,
            "studio",
            tilted_sheet(pixel, scale, turn),
            Vec3::Z * 50.0,
            &places,
        );
        let normals = vec![normal.normalize(); 4];
        let tilted = Solid { normals, ..sheet(0.0) };
        let theirs = seen(&mut renderer, "studio", tilted, Vec3::Z * 50.0, &places);
        for (a, b) in ours.iter().zip(&theirs) {
            assert!((*a - *b).abs().max_element() < 0.02 * b.max_element(), "{what}: {a} {b}");
        }
        shades.push(theirs[0].y);
    }
    // The light tells tilts apart.
    assert!((shades[0] - shades[5]).abs() > 0.05 * shades[5], "{shades:?}");
}

#[test]
fn uvs_that_no_float_tells_apart_are_laid_at_the_corner_and_no_pixel_is_black() {
    let offsets = ["1e30", "-1e30", "3e38", "1e5"];
    let shifted = offsets.map(|by| {
        format!(
            r#"{{"pbrMetallicRoughness":{{"baseColorTexture":{{"index":0,
            "extensions":{{"KHR_texture_transform":{{"offset":[{by},{by}]}}}}}}}}}}"#
        )
    });
    // 1e30 repeats and 100,000 are beyond the 65,536 that are told: all of it is the picture's corner, where its four colours meet.
    for material in &shifted {
        let (scalp, looks) = ball(material);
        let solid = head(&scalp, &looks);
        let mapped = solid.maps.as_ref().expect("it has maps");
        assert!(mapped.uvs.iter().flatten().all(|uv| *uv == glam::Vec2::ZERO), "{material}");
    }
    let test = "uvs_that_no_float_tells_apart_are_laid_at_the_corner_and_no_pixel_is_black";
    let Some(mut renderer) = renderer(test) else { return };
    let (scalp, looks) = ball(&shifted[0]);
    let corners = [(-2.0, 2.0), (2.0, 2.0), (-2.0, -2.0), (2.0, -2.0)];
    let lights = seen(&mut renderer, "flat", head(&scalp, &looks), Vec3::Z * 50.0, &corners);
    assert!(lights.iter().all(|c| c.is_finite() && c.min_element() > 0.05), "{lights:?}");
}
