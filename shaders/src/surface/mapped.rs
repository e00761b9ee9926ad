//! A head as its own file's materials look: triangle by triangle with their maps, or the skin tone where they have none.
//!
//! Guaranteed: each triangle is there once, whatever the file says. What has no maps is drawn as without them.

use super::{Material, Part, Parts, Solid, Tone, plain_head};
use crate::maps::MaterialMaps;
use coif_nodes::data::scalp::Scalp;
use coif_nodes::formats::looks::Looks;
use glam::{Vec2, Vec3};
use std::collections::BTreeMap;
use std::ops::Range;
use std::sync::Arc;

/// Repeats of a picture from the first, at most, that a place on it is told in.
const FARTHEST: f32 = 65536.0;

/// Pictures on a solid.
#[derive(Clone, Debug)]
pub struct Mapped {
    /// Where each point lies in its colour map and in its normal map: 0 to 1 from the left and from the top.
    pub uvs: Vec<[Vec2; 2]>,
    /// Triangles that have maps, and their material.
    pub runs: Vec<(Range<u32>, usize)>,
    /// The materials.
    pub materials: Arc<[MaterialMaps]>,
}

impl PartialEq for Mapped {
    fn eq(&self, other: &Self) -> bool {
        self.uvs == other.uvs
            && self.runs == other.runs
            && Arc::ptr_eq(&self.materials, &other.materials)
    }
}

/// The head with the maps of its file's materials, each as `looks` lists it.
///
/// # Errors
/// In one line, where `looks` are not those of the file that the head was read from.
pub fn head_with_maps(
    scalp: &Scalp,
    tone: Tone,
    looks: &Looks,
    materials: &Arc<[MaterialMaps]>,
) -> Result<Solid, String> {
    let surface = scalp.surface();
    let numbers: Vec<u32> = match scalp.kept() {
        Some(kept) => kept.to_vec(),
        None => (0..looks.rises.len() as u32).collect(),
    };
    let last = numbers.iter().max().map_or(0, |n| *n as usize + 1);
    if numbers.len() != surface.triangles.len() || last > looks.rises.len() {
        return Err("its triangles are not those of the head: it was changed meanwhile".to_owned());
    }
    let drawn = |t: usize| {
        let of = *looks.material_of.get(numbers[t] as usize)? as usize;
        materials.get(of).filter(|material| material.is_drawn()).map(|_| of)
    };
    let mut head = plain_head(scalp, tone, |t| drawn(t).is_none());
    let parts = Parts::of(scalp);
    let mut uvs = vec![[Vec2::ZERO; 2]; head.points.len()];
    let mut triangles: Vec<(usize, usize)> =
        (0..surface.triangles.len()).filter_map(|t| Some((drawn(t)?, t))).collect();
    // In the order of the file within each material.
    triangles.sort_unstable();
    let mut runs: Vec<(Range<u32>, usize)> = vec![];
    for same in triangles.chunk_by(|a, b| a.0 == b.0) {
        let of = same[0].0;
        let material = &materials[of];
        let first = head.triangles.len() as u32;
        // A vertex on a seam stands once for each place that it has in the maps.
        let mut copies: BTreeMap<(u32, Part, [u32; 4]), u32> = BTreeMap::new();
        for (_, t) in same {
            let corners = surface.triangles[*t];
            // Turned round since it was read?
            let file = numbers[*t] as usize;
            let turned = looks.rises[file] != (corners[2] > corners[1]);
            let maps = [&material.colour_map, &material.normal_map].map(|map| {
                let Some(map) = map else { return [Vec2::ZERO; 3] };
                let uvs = match map.set {
                    0 => scalp.uvs().and_then(|uvs| uvs.get(*t)).copied(),
                    set => looks
                        .uvs
                        .get(&set)
                        .and_then(|uvs| uvs.get(file))
                        .map(|[a, b, c]| if turned { [*a, *c, *b] } else { [*a, *b, *c] }),
                };
                uvs.unwrap_or_default().map(|uv| {
                    let at = map.picture_from_uv.transform_point2(uv);
                    // So many repeats away a float tells no pixel from the next, and what is drawn between would be no number.
                    if at.abs().max_element() <= FARTHEST { at } else { Vec2::ZERO }
                })
            });
            let part = match material.colour_map.is_some() || material.colour.is_some() {
                true => Part::Skin,
                false => parts.of_triangle(&corners),
            };
            let triangle = [0, 1, 2].map(|i| {
                let (v, at) = (corners[i], [maps[0][i], maps[1][i]]);
                let bits = [at[0].x, at[0].y, at[1].x, at[1].y].map(f32::to_bits);
                *copies.entry((v, part, bits)).or_insert_with(|| {
                    let colour = match material.colour_map.is_some() || material.colour.is_some() {
                        true => Vec3::ONE,
                        false => tone.of_part(part),
                    };
                    let normal = surface.normals[v as usize].normalize_or(Vec3::Y);
                    uvs.push(at);
                    head.push(surface.points[v as usize], normal, colour)
                })
            });
            head.triangles.push(triangle);
        }
        runs.push((first..head.triangles.len() as u32, of));
    }
    head.material = if tone == Tone::Clay { Material::Clay } else { Material::Skin };
    if !runs.is_empty() {
        head.maps = Some(Mapped { uvs, runs, materials: materials.clone() });
    }
    Ok(head)
}
