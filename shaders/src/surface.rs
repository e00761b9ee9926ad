//! Solids of a picture: the head with its skin, the ground, clusters as tubes; and what hair does to the skin under it.
//!
//! Guarantees: normals are unit, colours are linear albedo within 0 to 1, triangles name points that are there, and there
//! are as many normals and colours as points. Empty meshes give empty solids.

mod mapped;
mod roots;
mod shell;
mod tubes;

pub use mapped::{Mapped, head_with_maps};
pub use roots::{RootGrid, SPREAD};
pub(crate) use shell::solid_voxels;
pub use tubes::tubes;

use crate::view::swatch;
use coif_nodes::data::scalp::Scalp;
use coif_nodes::maths::smoothstep;
use coif_nodes::maths::transcendental::{pow, sin_cos_turns};
use glam::{Vec2, Vec3};
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
    /// The pictures on it.
    pub maps: Option<Mapped>,
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
            maps: None,
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
    /// and the darkest 2 %. Their luminances are compressed by one power law to 46 % to 5.5 %, about the span of measured skin, and
    /// three quarters of the swatch's own tint are mixed with the red of the blood under it. The law is our choice; the order and the hues are
    /// the scale's.
    pub fn albedo(self) -> Vec3 {
        let Self::Monk(number) = self else { return CLAY };
        let tone = swatch(MONK[usize::from(number.clamp(1, 10)) - 1]);
        let luminance = luminance(tone);
        let (light, dark) = (0.46f32, 0.055f32);
        // ln(light / dark) over ln of the ratio of the first and the last swatch.
        let lit = pow(luminance / 0.8526, 0.5537) * light;
        let tint = (tone / luminance).map(|c| pow(c, 0.75)) * Vec3::new(1.22, 0.945, 0.87);
        let albedo = tint * (lit.max(dark) / self::luminance(tint));
        albedo.clamp(Vec3::ZERO, Vec3::ONE)
    }

    /// Albedo of parts of a face: what their material is called, and the colour.
    fn of_part(self, part: Part) -> Vec3 {
        let skin = self.albedo();
        match part {
            Part::Skin => skin,
            // Thinner skin over more blood: darker, and redder the lighter the skin is.
            Part::Lips => skin * Vec3::new(0.86, 0.6, 0.62),
            Part::White => Vec3::new(0.62, 0.57, 0.53),
            Part::Iris => Vec3::new(0.07, 0.035, 0.018),
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
/// where the mesh names materials for them; triangles of eyes are cut finer, so that the iris is round.
pub fn head_solid(scalp: &Scalp, tone: Tone) -> Solid {
    plain_head(scalp, tone, |_| true)
}

/// The same of the triangles that `has` names by their numbers.
fn plain_head(scalp: &Scalp, tone: Tone, has: impl Fn(usize) -> bool) -> Solid {
    let surface = scalp.surface();
    if tone == Tone::Clay {
        let all = surface.triangles.iter().enumerate();
        return Solid {
            points: surface.points.clone(),
            normals: surface.normals.iter().map(|n| n.normalize_or(Vec3::Y)).collect(),
            colours: vec![CLAY; surface.points.len()],
            triangles: all.filter(|(t, _)| has(*t)).map(|(_, corners)| *corners).collect(),
            ..Solid::empty(Material::Clay)
        };
    }
    let mut head = Solid::empty(Material::Skin);
    let parts = Parts::of(scalp);
    let irises = irises(scalp, &parts);
    // A vertex on a border stands once for each part; lips fade into the skin instead.
    let mut copies: BTreeMap<(u32, Part), u32> = BTreeMap::new();
    for (number, triangle) in surface.triangles.iter().enumerate().filter(|(t, _)| has(*t)) {
        let part = match parts.of_triangle(triangle) {
            Part::Lips => Part::Skin,
            part => part,
        };
        if matches!(part, Part::White | Part::Iris) {
            eye(&mut head, scalp, number as u32, tone, &irises);
            continue;
        }
        let corners = triangle.map(|v| {
            *copies.entry((v, part)).or_insert_with(|| {
                let colour = if part == Part::Skin && parts.holds(Part::Lips, v) {
                    let share = if parts.holds(Part::Skin, v) { 0.4 } else { 1.0 };
                    tone.of_part(Part::Skin).lerp(tone.of_part(Part::Lips), share)
                } else {
                    tone.of_part(part)
                };
                let normal = surface.normals[v as usize];
                head.push(surface.points[v as usize], normal.normalize_or(Vec3::Y), colour)
            })
        });
        head.triangles.push(corners);
    }
    head
}

/// Which materials of a face meet at each vertex.
struct Parts<'a> {
    masks: Vec<(Part, &'a [f32])>,
    present: Vec<Part>,
}

impl<'a> Parts<'a> {
    fn of(scalp: &'a Scalp) -> Self {
        let names = scalp.mask_names();
        let masks: Vec<(Part, &[f32])> = names
            .iter()
            .filter_map(|name| {
                let part = Part::of_material(name.strip_prefix("material:")?);
                Some((part, scalp.mask(name)?))
            })
            .collect();
        let all = [Part::Skin, Part::Lips, Part::White, Part::Iris, Part::Teeth, Part::Lashes];
        let present = all.into_iter().filter(|part| masks.iter().any(|(p, _)| p == part)).collect();
        Self { masks, present }
    }

    fn holds(&self, part: Part, vertex: u32) -> bool {
        self.masks.iter().any(|(p, mask)| *p == part && mask[vertex as usize] > 0.5)
    }

    /// The part that all corners are of; where a border runs through all three, the first.
    fn of_triangle(&self, triangle: &[u32; 3]) -> Part {
        let of_all = |part: &Part| triangle.iter().all(|v| self.holds(*part, *v));
        self.present.iter().copied().find(of_all).unwrap_or(Part::Skin)
    }
}

/// A disc on an eye.
struct Iris {
    centre: Vec3,
    radius: f32,
}

/// The irises: patches of triangles of that material, each as the disc of its area about its middle.
fn irises(scalp: &Scalp, parts: &Parts) -> Vec<Iris> {
    let surface = scalp.surface();
    let mut found: Vec<(Vec3, f32, Vec<u32>)> = vec![];
    for (number, triangle) in (0u32..).zip(&surface.triangles) {
        if !triangle.iter().all(|v| parts.holds(Part::Iris, *v)) {
            continue;
        }
        let area = 0.5 * surface.area_vector(number).length();
        let middle = surface.corners(number).iter().sum::<Vec3>() / 3.0;
        // Patches that this triangle touches become one with it.
        let (touched, apart): (Vec<_>, Vec<_>) =
            found.into_iter().partition(|(.., own)| triangle.iter().any(|v| own.contains(v)));
        let mut patch = (middle * area, area, triangle.to_vec());
        for (sum, size, own) in touched {
            patch = (patch.0 + sum, patch.1 + size, [patch.2, own].concat());
        }
        patch.2.sort_unstable();
        patch.2.dedup();
        found = apart;
        found.push(patch);
    }
    let discs = found.into_iter().filter(|(_, area, _)| *area > 0.0);
    let disc = |(sum, area, _): (Vec3, f32, Vec<u32>)| Iris {
        centre: sum / area,
        radius: (area / std::f32::consts::PI).sqrt(),
    };
    discs.map(disc).collect()
}

/// A triangle of an eye in pieces of a twelfth of an iris, coloured by their distance from its middle.
fn eye(head: &mut Solid, scalp: &Scalp, number: u32, tone: Tone, irises: &[Iris]) {
    const MOST_CUTS: f32 = 16.0;
    let surface = scalp.surface();
    let [a, b, c] = surface.corners(number);
    let middle = (a + b + c) / 3.0;
    let size = a.distance(b).max(b.distance(c)).max(c.distance(a));
    let nearest = |iris: &&Iris| iris.centre.distance(middle);
    let iris = irises.iter().min_by(|x, y| nearest(x).total_cmp(&nearest(y)));
    let cuts = match iris {
        Some(iris) if nearest(&iris) < 1.3 * iris.radius + size => {
            (12.0 * size / iris.radius).ceil().clamp(1.0, MOST_CUTS)
        }
        _ => 1.0,
    };
    let colour = |p: Vec3| {
        let white = tone.of_part(Part::White);
        let Some(iris) = iris else { return white };
        let out = p.distance(iris.centre) / iris.radius;
        let smooth = |from: f32, to: f32| smoothstep((out - from) / (to - from));
        // Pupil, iris, its darker rim, and the white.
        let inner = Vec3::splat(0.004).lerp(tone.of_part(Part::Iris), smooth(0.32, 0.42));
        let rim = inner.lerp(inner * 0.45, smooth(0.75, 0.95));
        rim.lerp(white, smooth(0.95, 1.1))
    };
    let steps = cuts as u32;
    let first = head.points.len() as u32;
    for i in 0..=steps {
        for j in 0..=steps - i {
            let bary = Vec2::new(i as f32 / cuts, j as f32 / cuts);
            let p = surface.at(number, bary);
            head.push(p, surface.smooth_normal(number, bary), colour(p));
        }
    }
    // Row `i` has `steps - i + 1` points.
    let at = |i: u32, j: u32| first + i * (steps + 1) - (i * i.saturating_sub(1)) / 2 + j;
    for i in 0..steps {
        for j in 0..steps - i {
            head.triangles.push([at(i, j), at(i + 1, j), at(i, j + 1)]);
            if i + j + 1 < steps {
                head.triangles.push([at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)]);
            }
        }
    }
}

/// A disc for shadows under all that casts and under all hair, of which `lowest` is the lowest point (infinite without hair); none
/// without solids. It ends softly, so nothing may lie below it: that would vanish behind the disc and come back beside it.
pub fn ground(solids: &[Solid], lowest: f32) -> Option<Solid> {
    const RINGS: u32 = 12;
    const SIDES: u32 = 64;
    /// cm.
    const UNDER_HAIR: f32 = 0.5;
    let points = || {
        let casting = solids.iter().filter(|s| s.casts);
        casting.flat_map(|s| s.points.iter().copied()).filter(|p| p.is_finite())
    };
    let first = points().next()?;
    let (mut lower, upper) = points().fold((first, first), |(lo, hi), p| (lo.min(p), hi.max(p)));
    if lowest < lower.y && lowest.is_finite() {
        // A curve may pass a little below its points, and a floor that stays while hair is combed is not sent anew.
        lower.y = (lowest - UNDER_HAIR).floor();
    }
    let centre = Vec3::new(0.5 * (lower.x + upper.x), lower.y, 0.5 * (lower.z + upper.z));
    // Shadows nearby tell where the head stands; far ones only darken the picture.
    let radius = (upper - lower).length() * 0.8 + 1.0;
    let mut disc = Solid { casts: false, ..Solid::empty(Material::Ground) };
    disc.push(centre, Vec3::Y, Vec3::ONE);
    for ring in 1..=RINGS {
        let out = ring as f32 / RINGS as f32;
        let there = 1.0 - smoothstep(out);
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frame::Frame;
    use crate::gpu::{Gpu, Precision};
    use coif_nodes::data::scalp::{HeadFrame, REGION};
    use coif_nodes::maths::closest::Surface;
    use coif_nodes::scalp::bust;

    /// The bust with its materials as masks, as the head node makes them.
    fn bust_with_materials() -> Scalp {
        let mesh = bust::adult();
        let mut masks: BTreeMap<String, Vec<f32>> =
            [(REGION.to_owned(), vec![1.0; mesh.points.len()])].into();
        for (t, m) in mesh.triangles.iter().zip(&mesh.material_of) {
            let name = format!("material:{}", mesh.materials[*m as usize]);
            let mask = masks.entry(name).or_insert_with(|| vec![0.0; mesh.points.len()]);
            t.iter().for_each(|v| mask[*v as usize] = 1.0);
        }
        let surface = Surface::new(mesh.points, mesh.triangles);
        Scalp::new(surface, None, HeadFrame::IDENTITY, masks)
    }

    #[test]
    fn a_head_is_its_surface_with_eyes_of_their_own() {
        let scalp = bust_with_materials();
        let head = head_solid(&scalp, Tone::Monk(4));
        assert_eq!((head.material, head.casts), (Material::Skin, true));
        assert_eq!(
            (head.points.len(), head.points.len()),
            (head.normals.len(), head.colours.len())
        );
        assert!(head.normals.iter().all(|n| n.is_normalized()));
        let area = |points: &[Vec3], triangles: &[[u32; 3]], of: &dyn Fn([u32; 3]) -> bool| {
            let all = triangles.iter().filter(|t| of(**t)).map(|t| {
                let [a, b, c] = t.map(|v| points[v as usize]);
                0.5 * (b - a).cross(c - a)
            });
            all.fold((0.0, Vec3::ZERO), |(size, sum), v| (size + v.length(), sum + v))
        };
        // Cutting changes neither the surface nor which way it faces.
        let surface = scalp.surface();
        let ours = area(&head.points, &head.triangles, &|_| true);
        let theirs = area(&surface.points, &surface.triangles, &|_| true);
        assert!((ours.0 / theirs.0 - 1.0).abs() < 1e-4 && (ours.1 - theirs.1).length() < 0.05);
        // Two irises of the mesh's size, round, and none of their triangles missing.
        let mesh = bust::adult();
        let iris = mesh.materials.iter().position(|n| n == "iris").unwrap() as u32;
        let there: f32 = (0u32..)
            .zip(&mesh.material_of)
            .filter(|(_, m)| **m == iris)
            .map(|(t, _)| 0.5 * surface.area_vector(t).length())
            .sum();
        let dark = |t: [u32; 3]| t.iter().all(|v| head.colours[*v as usize].max_element() < 0.2);
        let ours = area(&head.points, &head.triangles, &dark).0;
        assert!((ours / there - 1.0).abs() < 0.35, "{ours} {there}");
        let discs = irises(&scalp, &Parts::of(&scalp));
        assert_eq!(discs.len(), 2);
        assert!((discs[0].centre.x + discs[1].centre.x).abs() < 1e-3);
        assert!(discs.iter().all(|d| (0.4..0.8).contains(&d.radius)), "{}", discs[0].radius);
        let clay = head_solid(&scalp, Tone::Clay);
        assert!(clay.colours.iter().all(|c| *c == CLAY) && clay.material == Material::Clay);
        assert_eq!(clay.triangles, surface.triangles);
    }

    #[test]
    fn tones_go_from_light_to_dark_as_skin_does() {
        let all: Vec<Vec3> = (1..=10).map(|n| Tone::Monk(n).albedo()).collect();
        for pair in all.windows(2) {
            // The scale's third tone is a little lighter than its second, and yellower.
            assert!(luminance(pair[1]) < luminance(pair[0]) * 1.03, "{pair:?}");
        }
        for c in &all {
            assert!((0.04..0.47).contains(&luminance(*c)), "{c}");
            assert!(c.x > c.y && c.y > c.z, "skin is redder than green and greener than blue: {c}");
            assert!(c.x / c.z < 5.0 && c.max_element() < 0.75, "{c}");
        }
        assert!((luminance(all[0]) / luminance(all[9]) - 0.46 / 0.055).abs() < 0.3);
        assert_eq!(Tone::Monk(0).albedo(), Tone::Monk(1).albedo());
        assert_eq!(Tone::Monk(99).albedo(), Tone::Monk(10).albedo());
    }

    #[test]
    fn the_ground_lies_under_what_casts() {
        let head = head_solid(&bust_with_materials(), Tone::Clay);
        let lowest = head.points.iter().fold(f32::MAX, |y, p| y.min(p.y));
        let ghost = Solid { casts: false, points: vec![Vec3::NEG_Y * 99.0], ..head.clone() };
        let disc = ground(&[head.clone(), ghost.clone()], lowest + 0.1).unwrap();
        assert!(disc.points.iter().all(|p| p.y == lowest));
        assert!(!disc.casts && disc.material == Material::Ground);
        assert_eq!((disc.colours[0], *disc.colours.last().unwrap()), (Vec3::ONE, Vec3::ZERO));
        for t in &disc.triangles {
            let [a, b, c] = t.map(|v| disc.points[v as usize]);
            assert!((b - a).cross(c - a).y > 0.0);
        }
        assert_eq!(ground(&[], f32::INFINITY), None);
        assert_eq!(ground(&[ghost], -30.0), None);
        // Hair that hangs lower moves it down, and it grows with its distance.
        for (hair, at) in
            [(lowest - 0.1, (lowest - 0.6).floor()), (-100.2, -101.0), (-1e6, -1_000_001.0)]
        {
            let under = ground(std::slice::from_ref(&head), hair).unwrap();
            assert!(under.points.iter().all(|p| p.y == at && p.y < hair), "{hair}");
            assert!(under.points[700].x.abs() >= disc.points[700].x.abs());
        }
        assert_eq!(ground(std::slice::from_ref(&head), f32::NEG_INFINITY), Some(disc.clone()));
        assert_eq!(ground(&[head], f32::NAN), Some(disc));
    }

    #[test]
    fn skin_returns_no_more_light_than_it_gets() {
        let Ok(gpu) = Gpu::new(Precision::Best) else {
            println!("skipped: skin_returns_no_more_light_than_it_gets needs a graphics adapter");
            return;
        };
        // For 32 cosines of the view: what a white and a black skin send back of light that is even all around, summed
        // over distant lights; the same by the surroundings; and by surroundings of which a half arrives.
        let out = furnace(&gpu);
        for (i, [white, black, sky, half]) in out.iter().enumerate() {
            let nv = (i as f32 + 0.5) / 32.0;
            assert!(*white <= 1.0 && *sky <= 1.0, "{nv}: {white} {sky}");
            if nv > 0.2 {
                assert!(*white > 0.98 && *sky > 0.99, "{nv}: {white} {sky}");
            }
            assert!(*black > 0.015 && *black < 0.25, "{nv}: {black}");
            assert!((white - sky).abs() < 0.02, "{nv}: {white} {sky}");
            assert!(*half < 0.5 + 0.05 && *half > 0.3, "{nv}: {half}");
        }
        assert!(out[1][1] > 3.0 * out[31][1], "the surface mirrors more at its edge");
    }

    /// Runs the skin in even light.
    fn furnace(gpu: &Gpu) -> Vec<[f32; 4]> {
        use bytemuck::Zeroable;
        use wgpu::util::DeviceExt;
        // Fewer than 256 steps a loop: software adapters were seen to stop there.
        const BODY: &str = "
            @group(0) @binding(9) var<storage, read_write> result: array<vec4f>;
            @compute @workgroup_size(32) fn main(@builtin(global_invocation_id) id: vec3u) {
                let nv = (f32(id.x) + 0.5) / 32.0;
                let N = vec3f(0.0, 0.0, 1.0);
                let V = vec3f(sqrt(1.0 - nv * nv), 0.0, nv);
                var sum = vec4f(0.0);
                for (var i = 0u; i < 200u; i++) {
                    let z = (f32(i) + 0.5) / 100.0 - 1.0;
                    for (var j = 0u; j < 200u; j++) {
                        let turn = (f32(j) + 0.5) / 200.0 * 2.0 * PI;
                        let r = sqrt(1.0 - z * z);
                        let L = vec3f(r * cos(turn), r * sin(turn), z);
                        sum += vec4f(skin_light(vec3f(1.0), N, V, L), skin_light(vec3f(0.0), N, V, L).r);
                    }
                }
                let white = skin_sky(vec3f(1.0), N, V, 1.0).r;
                let half = skin_sky(vec3f(1.0), N, V, 0.5).r;
                sum *= 4.0 * PI / 40000.0;
                result[id.x] = vec4f(max(sum.r, max(sum.g, sum.b)), sum.a, white, half);
            }";
        let device = &gpu.device;
        let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: None,
            source: wgpu::ShaderSource::Wgsl(
                format!("{}{BODY}", crate::source::Source::of("skin").text).into(),
            ),
        });
        let pipeline = device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label: None,
            layout: None,
            module: &module,
            entry_point: None,
            compilation_options: Default::default(),
            cache: None,
        });
        let mut frame = Frame::zeroed();
        // Radiance 1 from everywhere.
        frame.sky[0] = [1.0 / 0.282_095; 4];
        let shared = device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
            label: None,
            contents: bytemuck::bytes_of(&frame),
            usage: wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::UNIFORM,
        });
        let buffer = |usage| {
            device.create_buffer(&wgpu::BufferDescriptor {
                label: None,
                size: 32 * 16,
                usage,
                mapped_at_creation: false,
            })
        };
        let result = buffer(wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC);
        let staging = buffer(wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST);
        let bind = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: None,
            layout: &pipeline.get_bind_group_layout(0),
            entries: &[
                wgpu::BindGroupEntry { binding: 0, resource: shared.as_entire_binding() },
                wgpu::BindGroupEntry { binding: 9, resource: result.as_entire_binding() },
            ],
        });
        let mut encoder = device.create_command_encoder(&Default::default());
        {
            let mut pass = encoder.begin_compute_pass(&Default::default());
            pass.set_pipeline(&pipeline);
            pass.set_bind_group(0, &bind, &[]);
            pass.dispatch_workgroups(1, 1, 1);
        }
        encoder.copy_buffer_to_buffer(&result, 0, &staging, 0, 32 * 16);
        gpu.queue.submit([encoder.finish()]);
        staging.slice(..).map_async(wgpu::MapMode::Read, |_| {});
        gpu.wait();
        let bytes = staging.slice(..).get_mapped_range().unwrap();
        bytemuck::cast_slice::<u8, [f32; 4]>(&bytes).to_vec()
    }
}
