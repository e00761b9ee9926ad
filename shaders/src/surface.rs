//! Solids of a picture: the head with its skin, the ground, clusters as tubes; and what hair does to the skin under it.
//!
//! Guarantees: normals are unit, colours are linear albedo within 0 to 1, triangles name points that are there, and there
//! are as many normals and colours as points. Empty meshes give empty solids.

mod roots;
mod shell;
mod tubes;

pub use roots::{RootGrid, SPREAD};
pub(crate) use shell::solid_voxels;
pub use tubes::tubes;

use crate::view::swatch;
use coif_nodes::data::scalp::Scalp;
use coif_nodes::maths::transcendental::{pow, sin_cos_turns};
use glam::Vec3;
use std::collections::BTreeMap;

/// How a solid takes light.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Material {
    /// Skin; hair roots tint it.
    Skin,
    /// As skin, without roots: tubes, clay heads.
    Clay,
    /// Only darkens what is behind it; the red of its colour is how much of it is there.
    Ground,
    /// Its colour, whatever the light.
    Flat,
}

/// A mesh with its material.
#[derive(Clone, Debug, PartialEq)]
pub struct Solid {
    /// cm.
    pub points: Vec<Vec3>,
    /// Unit, one a point.
    pub normals: Vec<Vec3>,
    /// Linear albedo, 0 to 1, one a point.
    pub colours: Vec<Vec3>,
    /// Counter-clockwise from outside.
    pub triangles: Vec<[u32; 3]>,
    /// How it takes light.
    pub material: Material,
    /// Whether it shades hair and itself.
    pub casts: bool,
}

impl Solid {
    fn empty(material: Material) -> Self {
        Self {
            points: vec![],
            normals: vec![],
            colours: vec![],
            triangles: vec![],
            material,
            casts: true,
        }
    }

    fn push(&mut self, point: Vec3, normal: Vec3, colour: Vec3) -> u32 {
        self.points.push(point);
        self.normals.push(normal);
        self.colours.push(colour);
        self.points.len() as u32 - 1
    }
}

/// The colour of a head.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Tone {
    /// Neutral grey-beige without features.
    #[default]
    Clay,
    /// One of the ten tones of the Monk Skin Tone scale, 1 (lightest) to 10. Others are taken as the nearest.
    Monk(u8),
}

/// The ten tones, sRGB: Monk, E. (2019), the Monk Skin Tone scale, skintone.google.
const MONK: [u32; 10] = [
    0xF6EDE4, 0xF3E7DB, 0xF7EAD0, 0xEADABA, 0xD7BD96, 0xA07E56, 0x825C43, 0x604134, 0x3A312A,
    0x292420,
];
const CLAY: Vec3 = Vec3::new(0.36, 0.335, 0.315);

impl Tone {
    /// Albedo of bare skin, linear Rec.709.
    ///
    /// The scale's swatches are made to be told apart on a screen, not to be lit: the lightest would reflect 85 % of all light
    /// and the darkest 2 %. Their luminances are compressed by one power law to 46 % to 4.5 %, the span of measured skin, and
    /// half of the swatch's own tint is mixed with the red of the blood under it. The law is our choice; the order and the hues are
    /// the scale's.
    pub fn albedo(self) -> Vec3 {
        let Self::Monk(number) = self else { return CLAY };
        let tone = swatch(MONK[usize::from(number.clamp(1, 10)) - 1]);
        let luminance = luminance(tone);
        let (light, dark) = (0.46f32, 0.045f32);
        // ln(light / dark) over ln of the ratio of the first and the last swatch.
        let lit = pow(luminance / 0.8526, 0.605) * light;
        let tint = (tone / luminance).map(|c| pow(c, 0.65)) * Vec3::new(1.15, 0.955, 0.9);
        let albedo = tint * (lit.max(dark) / self::luminance(tint));
        albedo.clamp(Vec3::ZERO, Vec3::ONE)
    }

    /// Albedo of parts of a face: what their material is called, and the colour.
    fn of_part(self, part: Part) -> Vec3 {
        let skin = self.albedo();
        if self == Self::Clay {
            return CLAY;
        }
        match part {
            Part::Skin => skin,
            // Thinner skin over more blood: darker, and redder the lighter the skin is.
            Part::Lips => skin * Vec3::new(0.86, 0.6, 0.62),
            Part::White => Vec3::new(0.62, 0.57, 0.53),
            Part::Iris => Vec3::new(0.05, 0.03, 0.018),
            Part::Teeth => Vec3::new(0.6, 0.55, 0.46),
            Part::Lashes => Vec3::new(0.02, 0.015, 0.012),
        }
    }
}

/// Luminance of linear Rec.709.
fn luminance(c: Vec3) -> f32 {
    c.dot(Vec3::new(0.2126, 0.7152, 0.0722))
}

/// Parts of a face that have a colour of their own.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Part {
    Skin,
    Lips,
    White,
    Iris,
    Teeth,
    Lashes,
}

impl Part {
    /// The part that a material is named for, in the words that head files use.
    fn of_material(name: &str) -> Self {
        let name = name.to_lowercase();
        let has = |words: &[&str]| words.iter().any(|w| name.contains(w));
        match () {
            () if has(&["lash", "brow"]) => Self::Lashes,
            () if has(&["iris", "pupil"]) => Self::Iris,
            () if has(&["sclera", "eyes", "eyeball", "eye_"]) => Self::White,
            () if has(&["teeth", "tooth"]) => Self::Teeth,
            () if has(&["lip"]) => Self::Lips,
            () => Self::Skin,
        }
    }
}

/// The head as it is lit: smooth normals, and the albedo of its tone at every vertex. Eyes, lips and teeth have their own
/// where the mesh names materials for them.
pub fn head_solid(scalp: &Scalp, tone: Tone) -> Solid {
    let surface = scalp.surface();
    let material = if tone == Tone::Clay { Material::Clay } else { Material::Skin };
    let mut head = Solid::empty(material);
    let masks: Vec<(Part, &[f32])> = scalp
        .mask_names()
        .iter()
        .filter_map(|name| {
            let part = Part::of_material(name.strip_prefix("material:")?);
            Some((part, scalp.mask(name)?))
        })
        .collect();
    let holds = |part: Part, vertex: u32| {
        masks.iter().any(|(p, mask)| *p == part && mask[vertex as usize] > 0.5)
    };
    let parts = [Part::Skin, Part::Lips, Part::White, Part::Iris, Part::Teeth, Part::Lashes];
    let present: Vec<Part> =
        parts.into_iter().filter(|part| masks.iter().any(|(p, _)| p == part)).collect();
    // A vertex on a border stands once for each part; lips fade into the skin instead.
    let mut copies: BTreeMap<(u32, Part), u32> = BTreeMap::new();
    for (number, triangle) in surface.triangles.iter().enumerate() {
        let part = present
            .iter()
            .copied()
            .find(|part| triangle.iter().all(|v| holds(*part, *v)))
            .unwrap_or(Part::Skin);
        let part = if part == Part::Lips { Part::Skin } else { part };
        let corners = triangle.map(|v| {
            *copies.entry((v, part)).or_insert_with(|| {
                let colour = if part == Part::Skin && holds(Part::Lips, v) {
                    let share = if holds(Part::Skin, v) { 0.4 } else { 1.0 };
                    tone.of_part(Part::Skin).lerp(tone.of_part(Part::Lips), share)
                } else {
                    tone.of_part(part)
                };
                let normal = surface.normals[v as usize];
                let normal =
                    normal.try_normalize().unwrap_or_else(|| surface.face_normal(number as u32));
                head.push(surface.points[v as usize], normal, colour)
            })
        });
        head.triangles.push(corners);
    }
    head
}

/// A disc for shadows under all that casts, at the height of its lowest point; none without solids. It ends softly.
pub fn ground(solids: &[Solid]) -> Option<Solid> {
    const RINGS: u32 = 12;
    const SIDES: u32 = 64;
    let points = || {
        let casting = solids.iter().filter(|s| s.casts);
        casting.flat_map(|s| s.points.iter().copied()).filter(|p| p.is_finite())
    };
    let first = points().next()?;
    let (lower, upper) = points().fold((first, first), |(lo, hi), p| (lo.min(p), hi.max(p)));
    let centre = Vec3::new(0.5 * (lower.x + upper.x), lower.y, 0.5 * (lower.z + upper.z));
    // Wide enough for the shadow of a light at 30 degrees.
    let radius = (upper - lower).length() * 1.6 + 1.0;
    let mut disc = Solid { casts: false, ..Solid::empty(Material::Ground) };
    disc.push(centre, Vec3::Y, Vec3::ONE);
    for ring in 1..=RINGS {
        let out = ring as f32 / RINGS as f32;
        let there = 1.0 - out * out * (3.0 - 2.0 * out);
        for side in 0..SIDES {
            let (sin, cos) = sin_cos_turns(side as f32 / SIDES as f32);
            let p = centre + Vec3::new(sin, 0.0, cos) * (radius * out);
            disc.push(p, Vec3::Y, Vec3::splat(there));
        }
    }
    let at = |ring: u32, side: u32| 1 + (ring - 1) * SIDES + side % SIDES;
    for side in 0..SIDES {
        disc.triangles.push([0, at(1, side), at(1, side + 1)]);
        for ring in 1..RINGS {
            let [a, b] = [at(ring, side), at(ring, side + 1)];
            let [c, d] = [at(ring + 1, side), at(ring + 1, side + 1)];
            disc.triangles.extend([[a, c, b], [b, c, d]]);
        }
    }
    Some(disc)
}
