//! Heat on a head: a number at each place of the skin as a colour, in the window while masks are painted and in pictures.
//!
//! Guarantees: the head's triangles are cut finer, so that a small spot shows its own edge and not that of the mesh; so many
//! places on any head that they can be drawn in each frame.

use coif_nodes::data::field::Field;
use coif_nodes::data::scalp::{Root, Scalp};
use coif_shaders::surface::{Material, Solid, Tone};
use coif_shaders::view::swatch;
use glam::{Vec2, Vec3};
use std::collections::BTreeMap;

/// The most places on a head, and how far apart they are to be, head units.
const MOST: usize = 60_000;
const FINE: f32 = 0.3;
/// What lies farther from the middle of the cranium, in its radii, is shoulder.
const FAR: f32 = 1.8;
/// Less is not shown.
pub(crate) const LEAST: f32 = 0.004;
/// In a picture: how much of the skin under it heat hides, and how far it lies over the skin, head units.
const HIDES: f32 = 0.7;
const OVER: f32 = 0.01;

/// Blue, green, yellow, red: sRGB, for a value of 0 to 1.
pub(crate) fn colour(value: f32) -> [u8; 3] {
    const STOPS: [[f32; 3]; 4] =
        [[40.0, 70.0, 255.0], [30.0, 200.0, 120.0], [255.0, 205.0, 40.0], [255.0, 40.0, 25.0]];
    let x = value.clamp(0.0, 1.0) * 3.0;
    let (i, part) = ((x as usize).min(2), x - (x as usize).min(2) as f32);
    [0, 1, 2].map(|k| (STOPS[i][k] + (STOPS[i + 1][k] - STOPS[i][k]) * part) as u8)
}

/// Places on a head, and the triangles between them.
pub(crate) fn places(scalp: &Scalp) -> (Vec<Root>, Vec<[u32; 3]>) {
    let (surface, frame) = (scalp.surface(), scalp.frame());
    let near = |t: &u32| {
        let middle = surface.at(*t, Vec2::splat(1.0 / 3.0));
        !surface.is_gone(*t) && middle.distance(frame.origin) < FAR * frame.radius
    };
    let shown: Vec<u32> = (0..surface.triangles.len() as u32).filter(near).collect();
    let area: f32 = shown.iter().map(|t| surface.area_vector(*t).length()).sum();
    let side = (2.0 * area / shown.len().max(1) as f32).sqrt();
    // A triangle in n x n has about n x n / 2 places of its own.
    let fits = |n: &usize| shown.len() * n * n / 2 <= MOST;
    let most = (1..=6).rev().find(fits).unwrap_or(1);
    let cuts = ((side / (FINE * frame.unit())).ceil() as usize).clamp(1, most) as u32;
    let every = (shown.len() / (4 * MOST)).max(1);
    let (mut places, mut triangles) = (vec![], vec![]);
    let mut known: BTreeMap<(u32, u32, u32), u32> = BTreeMap::new();
    for t in shown.into_iter().step_by(every) {
        let corners = surface.triangles[t as usize];
        // i steps towards the second corner and j towards the third.
        let mut place = |i: u32, j: u32| {
            let k = cuts - i - j;
            let ends = [(corners[0], k), (corners[1], i), (corners[2], j)];
            let mut on: Vec<(u32, u32)> = ends.into_iter().filter(|(_, n)| *n > 0).collect();
            on.sort_unstable();
            let name = match on[..] {
                [(v, _)] => (v, v, 0),
                [(v, n), (w, _)] => (v, w, n),
                _ => (u32::MAX, t, i * cuts + j),
            };
            *known.entry(name).or_insert_with(|| {
                let bary = Vec2::new(i as f32, j as f32) / cuts as f32;
                places.push(scalp.root(t, bary));
                places.len() as u32 - 1
            })
        };
        for i in 0..cuts {
            for j in 0..cuts - i {
                triangles.push([place(i, j), place(i + 1, j), place(i, j + 1)]);
                if i + j + 2 <= cuts {
                    triangles.push([place(i + 1, j), place(i + 1, j + 1), place(i, j + 1)]);
                }
            }
        }
    }
    (places, triangles)
}

/// What a picture shows as heat.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum HeatSource<'a> {
    /// A field: a mask of the head or of a section by its name, or what a node paints.
    Mask(&'a Field),
    /// Where hair grows.
    Region,
}

/// Heat on a head of this tone, to be drawn with it: just over the skin, and nothing where there is none.
///
/// # Errors
/// If the head has no such mask.
pub(crate) fn solid(scalp: &Scalp, heat: &HeatSource, tone: Tone) -> Result<Solid, String> {
    let (places, triangles) = places(scalp);
    let values = match heat {
        HeatSource::Region => places.iter().map(|at| scalp.grows(at.triangle, at.bary)).collect(),
        HeatSource::Mask(field) => {
            field.on_skin(&places, scalp).map_err(|fault| fault.to_string())?
        }
    };
    let over = OVER * scalp.frame().unit();
    let skin = tone.albedo();
    let shown = |value: &f32| {
        let [r, g, b] = colour(*value).map(u32::from);
        let share = HIDES * (value * 5.0).clamp(0.0, 1.0);
        skin.lerp(swatch(r << 16 | g << 8 | b), share)
    };
    let is_seen = |t: &[u32; 3]| t.iter().any(|i| values[*i as usize] >= LEAST);
    Ok(Solid {
        points: places.iter().map(|at| at.point + at.normal * over).collect(),
        normals: places.iter().map(|at| at.normal.normalize_or(Vec3::Y)).collect(),
        colours: values.iter().map(shown).collect(),
        triangles: triangles.into_iter().filter(is_seen).collect(),
        material: Material::Clay,
        casts: false,
        maps: None,
    })
}
