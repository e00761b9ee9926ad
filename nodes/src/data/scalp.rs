//! The head that hair grows on: surface, head frame, region, masks and distance field.
//!
//! Coordinates are centimetres in the space of the mesh file (scaled, never moved), so that a groom lies on the head it
//! was made for. UVs, materials and masks may be missing; holes, several parts and non-manifold edges are allowed.

use super::carry::Carry;
use super::chart::Chart;
use super::drawn::DrawnRegion;
use super::landmarks::Landmarks;
use super::links::Links;
use super::outline::ConnectedSurface;
use super::region::{ChosenRegion, Region};
use super::rough::Rough;
use super::sections::Sections;
use super::spread::{RegionTree, highest};
use crate::maths::closest::{Hit, Surface};
use crate::maths::distance_field::DistanceField;
use crate::maths::hash::{Key, KeyBuilder};
use glam::{Vec2, Vec3};
use std::collections::BTreeMap;
use std::ops::Range;
use std::sync::{Arc, OnceLock};

pub use super::skin::Skin;

/// Cranium radius that defines head units, cm: one head unit is a centimetre on a head of this radius.
pub const HEAD_RADIUS: f32 = 8.9;

/// Position and orientation of the head (methods.md 0.1). Axes are orthonormal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HeadFrame {
    /// Centre of the cranium sphere, cm.
    pub origin: Vec3,
    /// To the head's own left, which is the right of the picture when it faces us: up x forward.
    pub right: Vec3,
    /// Up.
    pub up: Vec3,
    /// Direction of the face.
    pub forward: Vec3,
    /// Radius of the cranium sphere, cm.
    pub radius: f32,
}

impl HeadFrame {
    /// A frame at the origin with the file's axes, for meshes that are not heads.
    pub const IDENTITY: Self = Self {
        origin: Vec3::ZERO,
        right: Vec3::X,
        up: Vec3::Y,
        forward: Vec3::Z,
        radius: HEAD_RADIUS,
    };
    /// Centimetres per head unit.
    pub fn unit(&self) -> f32 {
        self.radius / HEAD_RADIUS
    }
    /// A point from the head's own units to cm in its space. (Data of a groom uses [`HeadSpace::place`].)
    pub fn point_from_head(&self, p: Vec3) -> Vec3 {
        self.origin + self.vector_from_head(p) * self.unit()
    }
    /// A point from the head's space (cm) to the head's own units.
    pub fn head_from_point(&self, p: Vec3) -> Vec3 {
        self.head_from_vector(p - self.origin) / self.unit()
    }
    /// A vector from the head frame to the head's space; lengths stay.
    pub fn vector_from_head(&self, v: Vec3) -> Vec3 {
        self.right * v.x + self.up * v.y + self.forward * v.z
    }
    /// A vector from the head's space to the head frame; lengths stay.
    pub fn head_from_vector(&self, v: Vec3) -> Vec3 {
        Vec3::new(v.dot(self.right), v.dot(self.up), v.dot(self.forward))
    }
}

/// Converts data in head units, such as strokes and names, to centimetres on a head; the only place that does. It uses
/// the head frame and, if the groom was made on another head, the map from that one.
#[derive(Clone, Debug)]
pub struct HeadSpace {
    frame: HeadFrame,
    carry: Option<Arc<Carry>>,
}

impl HeadSpace {
    /// Data in the units of a home head is carried by this map to a head with this frame; without a map, data is in the
    /// head's own units.
    pub fn new(frame: HeadFrame, carry: Option<Carry>) -> Self {
        Self { frame, carry: carry.map(Arc::new) }
    }
    /// The head frame. Directions use only this.
    pub fn frame(&self) -> &HeadFrame {
        &self.frame
    }
    /// The map from the home head; `None` on the home head itself.
    pub fn carry(&self) -> Option<&Carry> {
        self.carry.as_deref()
    }
    /// A stored position in this head's own units.
    pub fn own(&self, p: Vec3) -> Vec3 {
        self.carry.as_ref().map_or(p, |carry| carry.at(p))
    }
    /// A stored position in the head's space, cm.
    pub fn place(&self, p: Vec3) -> Vec3 {
        self.frame.point_from_head(self.own(p))
    }
    /// The stored form of a position in the head's space (cm): the inverse of [`Self::place`].
    pub fn given(&self, p: Vec3) -> Vec3 {
        let own = self.frame.head_from_point(p);
        self.carry.as_ref().map_or(own, |carry| carry.back(own))
    }
    /// Direction from the head's centre to a stored position, in the head frame; `None` for the centre itself. Unit.
    pub fn direction(&self, p: Vec3) -> Option<Vec3> {
        self.own(p).try_normalize()
    }
}

/// A point of the scalp that a curve is rooted in.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Root {
    /// Scalp triangle.
    pub triangle: u32,
    /// Weights of its second and third corner.
    pub bary: Vec2,
    /// Texture coordinates there; zero without UVs.
    pub uv: Vec2,
    /// The point, cm.
    pub point: Vec3,
    /// Smooth normal. Unit.
    pub normal: Vec3,
}

/// A named part of the mesh that a head was read from, for choosing parts that are not the head.
#[derive(Clone, Debug, PartialEq)]
pub struct Part {
    /// Name of a node, mesh, group or material, or "piece 2".
    pub name: String,
    /// The form that the head node's `leave_out` uses.
    pub pattern: String,
    /// Whether it is left out.
    pub is_left_out: bool,
    /// Whether the part is suggested for leaving out: it is named like hair or rises above the crown.
    pub is_proposed: bool,
    /// Whether lists name it: not a piece of a mesh whose file has names of its own.
    pub is_listed: bool,
    /// Its triangles, as runs of numbers in rising order; none once it is left out.
    pub triangles: Arc<[Range<u32>]>,
}

impl Part {
    /// Whether a triangle is one of the part's.
    pub fn holds(&self, triangle: u32) -> bool {
        let next = self.triangles.partition_point(|run| run.start <= triangle);
        next.checked_sub(1).is_some_and(|run| self.triangles[run].contains(&triangle))
    }
}

/// A head with everything that nodes ask of it. Parting it ([`Scalp::parted`]) is cheap: everything but the sections is
/// shared.
pub struct Scalp {
    /// Of what is not its sections'.
    key: Key,
    /// For the report only: coordinates are already in cm.
    cm_per_unit: f32,
    /// For the editor only.
    parts: Arc<[Part]>,
    /// For drawing with the file's own textures.
    kept: Option<Arc<[u32]>>,
    /// For drawing only: what was left out and is still seen.
    aside: Option<Arc<Scalp>>,
    /// For fitting a groom to another head.
    landmarks: Landmarks,
    head: Arc<Head>,
    region: Arc<Region>,
    sections: Option<Sections>,
}

/// What a head shares with the same head parted, or with another region.
struct Head {
    surface: Surface,
    uvs: Option<Vec<[Vec2; 3]>>,
    space: HeadSpace,
    /// Mask name to one value per vertex, 0 to 1. Always holds `scalp`, the head's own region where hair grows.
    masks: BTreeMap<String, Vec<f32>>,
    /// Masks that are exact between vertices.
    drawn: Vec<(String, DrawnRegion)>,
    links: OnceLock<Arc<Links>>,
    field: OnceLock<DistanceField>,
}

/// Name of the mask that defines where hair grows.
pub const REGION: &str = "scalp";

impl Scalp {
    /// A scalp. `masks` must hold one value per vertex under each name, and one mask named [`REGION`].
    ///
    /// # Panics
    /// If the region is missing or a mask has the wrong length: a bug in the caller.
    pub fn new(
        surface: Surface,
        uvs: Option<Vec<[Vec2; 3]>>,
        frame: HeadFrame,
        masks: BTreeMap<String, Vec<f32>>,
    ) -> Self {
        assert!(masks.contains_key(REGION), "a scalp has a region");
        assert!(masks.values().all(|m| m.len() == surface.points.len()), "one value a vertex");
        let mut key = KeyBuilder::new("scalp")
            .column(bytemuck::cast_slice::<_, f32>(&surface.points))
            .column(bytemuck::cast_slice::<_, u32>(&surface.triangles))
            .vec3(frame.origin)
            .vec3(frame.up)
            .vec3(frame.forward)
            .float(frame.radius);
        if let Some(uvs) = &uvs {
            key = key.column(bytemuck::cast_slice::<_, f32>(uvs));
        }
        for (name, mask) in &masks {
            key = key.text(name).column(mask);
        }
        Self {
            key: key.finish(),
            cm_per_unit: 1.0,
            parts: Arc::default(),
            kept: None,
            aside: None,
            landmarks: Landmarks::default(),
            head: Arc::new(Head {
                surface,
                uvs,
                space: HeadSpace::new(frame, None),
                masks,
                drawn: vec![],
                links: OnceLock::new(),
                field: OnceLock::new(),
            }),
            region: Arc::default(),
            sections: None,
        }
    }

    /// The same scalp with drawn regions, by the names of their masks, whose values at vertices it already has, and
    /// with its connectivity if the regions computed it.
    ///
    /// # Panics
    /// If the scalp is already shared.
    pub(crate) fn with_drawn(
        mut self,
        drawn: Vec<(String, DrawnRegion)>,
        links: Option<Arc<Links>>,
    ) -> Self {
        let key = KeyBuilder::new("drawn").key(self.key);
        let known = |key: KeyBuilder, (name, region): &(String, DrawnRegion)| {
            key.text(name).key(region.key())
        };
        if !drawn.is_empty() {
            self.key = drawn.iter().fold(key, known).finish();
        }
        let head = Arc::get_mut(&mut self.head).expect("a fresh scalp");
        head.drawn = drawn;
        if let Some(links) = links {
            head.links = links.into();
        }
        self
    }

    /// The same scalp, with this map for grooms from another head; the space must have the scalp's own frame.
    ///
    /// # Panics
    /// If the scalp is already shared.
    pub(crate) fn carried(mut self, space: HeadSpace) -> Self {
        if let Some(carry) = space.carry() {
            self.key = carry.add_to(KeyBuilder::new("carried").key(self.key)).finish();
        }
        Arc::get_mut(&mut self.head).expect("a fresh scalp").space = space;
        self
    }

    /// The same head with its scalp cut into these sections, replacing earlier ones.
    pub fn parted(&self, sections: Sections) -> Self {
        self.with_sections(Some(sections))
    }
    /// The same head without partings.
    pub(crate) fn unparted(&self) -> Self {
        self.with_sections(None)
    }
    /// The same for one piece of work: its sections note what they are asked ([`Sections::noting`]).
    pub(crate) fn noting(&self) -> Self {
        self.with_sections(self.sections.as_ref().map(Sections::noting))
    }
    fn with_sections(&self, sections: Option<Sections>) -> Self {
        Self { sections, ..self.shared() }
    }
    /// The same head, not parted, on which hair grows elsewhere.
    pub(crate) fn with_region(&self, chosen: ChosenRegion) -> Self {
        Self { region: Arc::new(chosen.into()), ..self.shared() }
    }
    fn shared(&self) -> Self {
        Self {
            key: self.key,
            cm_per_unit: self.cm_per_unit,
            parts: self.parts.clone(),
            kept: self.kept.clone(),
            aside: self.aside.clone(),
            landmarks: self.landmarks,
            head: self.head.clone(),
            region: self.region.clone(),
            sections: None,
        }
    }
    /// Whether the map shows the region, as on heads; of an animal it shows only one side of each leg.
    pub(crate) fn is_on_map(&self) -> bool {
        const LEAST: f64 = 0.8;
        let spots = self.chart().spots().iter();
        let on: f64 = spots.map(|spot| f64::from(spot.area * spot.grows)).sum();
        on >= LEAST * self.spread().area()
    }
    /// The sections that partings cut the scalp into; `None` if it is not parted.
    pub fn sections(&self) -> Option<&Sections> {
        self.sections.as_ref()
    }
    /// Whether partings allow a root here: inside a section, and off the bare skin of partings.
    pub fn free(&self, point: Vec3) -> bool {
        self.sections.as_ref().is_none_or(|sections| sections.at(point).is_some_and(|s| s.free))
    }
    /// The same of a root, without a search for the triangle that it lies in.
    pub fn is_free(&self, root: &Root) -> bool {
        self.sections.as_ref().is_none_or(|sections| sections.at_root(root).is_some_and(|s| s.free))
    }
    /// A root or, if it lies on or beyond a parting, its mirror image inside the section of `centre`; for nodes that
    /// place roots around a point.
    pub fn kept_in_section(&self, centre: Vec3, root: Root) -> Root {
        let Some(sections) = &self.sections else { return root };
        let Some(home) = sections.at(centre) else { return root };
        let at_home = |p: Vec3| sections.at(p).is_some_and(|s| s.free && s.section == home.section);
        if at_home(root.point) {
            return root;
        }
        let (mut out, mut back) = (0.0, 1.0);
        let mut kept = root;
        for _ in 0..10 {
            let middle = 0.5 * (out + back);
            match self.closest_root(root.point.lerp(centre, middle)) {
                Some(near) if at_home(near.point) => (back, kept) = (middle, near),
                _ => out = middle,
            }
        }
        if back == 1.0 {
            // The centre itself is on a parting: roots on it move off it, to their own side.
            let mut near = root.triangle;
            let off = self.home(root.point).and_then(|home| home.kept(root.point, &mut near));
            let off = off.and_then(|p| (p - root.point).try_normalize());
            let off = off.or((root.point - centre).try_normalize()).unwrap_or(Vec3::ZERO);
            let tries = (0..16).map(|k| root.point + off * (0.04 * self.frame().unit() * k as f32));
            let mut tries = tries.filter_map(|p| self.closest_root(p));
            return tries.find(|root| self.free(root.point)).unwrap_or(root);
        }
        // As far inside the border as it lay beyond, so that roots do not pile up along it.
        let border = 1.0 - back;
        let mirrored = (border - back).max(0.2 * border);
        let near = self.closest_root(centre.lerp(root.point, mirrored));
        near.filter(|near| at_home(near.point)).unwrap_or(kept)
    }
    /// The scalp as a flat map, computed on first use.
    pub fn chart(&self) -> &Chart {
        let make = || Chart::new(self.surface(), self.frame(), self.region());
        self.region.chart.get_or_init(make)
    }

    /// Stores how many centimetres a unit of the mesh file was taken for.
    pub fn with_cm_per_unit(mut self, cm_per_unit: f32) -> Self {
        self.cm_per_unit = cm_per_unit;
        self
    }
    /// Centimetres per unit of the mesh file.
    pub fn cm_per_unit(&self) -> f32 {
        self.cm_per_unit
    }

    /// Stores the named parts of the mesh.
    pub fn with_parts(mut self, parts: Vec<Part>) -> Self {
        self.parts = parts.into();
        self
    }
    /// The named parts of the mesh; first those that are left out or may have to be.
    pub fn parts(&self) -> &[Part] {
        &self.parts
    }

    /// Stores which triangles of the mesh file are present, by index; without this, all are.
    pub fn with_kept(mut self, kept: Option<Vec<u32>>) -> Self {
        self.kept = kept.map(Into::into);
        self
    }
    /// For each triangle its index in the mesh file; `None` if all are present.
    pub fn kept(&self) -> Option<&[u32]> {
        self.kept.as_deref()
    }

    /// Stores what was left out of the head and is still seen, such as its eyes.
    pub fn with_aside(mut self, aside: Option<Self>) -> Self {
        self.aside = aside.map(Arc::new);
        self
    }
    /// What was left out of the head and is still seen; no hair grows on it, and it is no skin.
    pub fn aside(&self) -> Option<&Self> {
        self.aside.as_deref()
    }

    /// Stores the landmarks.
    pub fn with_landmarks(mut self, landmarks: Landmarks) -> Self {
        self.landmarks = landmarks;
        self
    }
    /// The known landmarks, in head units of this head's frame, on the skin.
    pub fn landmarks(&self) -> &Landmarks {
        &self.landmarks
    }

    /// Hash of the content.
    pub fn key(&self) -> Key {
        let own = self.key_unparted();
        self.sections
            .as_ref()
            .map_or(own, |cut| KeyBuilder::new("parted").key(own).key(cut.key()).finish())
    }
    /// Hash of the head as it was read: the same with another region, and parted.
    pub fn whole(&self) -> Key {
        self.key
    }
    /// Hash of the content without partings.
    fn key_unparted(&self) -> Key {
        let chosen = |chosen: &ChosenRegion| {
            KeyBuilder::new("region").key(self.key).key(chosen.key()).finish()
        };
        self.region.chosen.as_ref().map_or(self.key, chosen)
    }
    /// Hash of the content without what sections note that they are asked: shared by all parted versions of this head, and by no head
    /// that is not parted.
    pub(crate) fn key_untraced(&self) -> Key {
        let own = self.key_unparted();
        let parted = |_| KeyBuilder::new("parted somehow").key(own).finish();
        self.sections.as_ref().map_or(own, parted)
    }
    /// The triangles.
    pub fn surface(&self) -> &Surface {
        &self.head.surface
    }
    /// The triangles with their connectivity, computed on first use.
    pub(crate) fn net(&self) -> ConnectedSurface<'_> {
        let surface = &self.head.surface;
        ConnectedSurface::of(
            surface,
            self.head.links.get_or_init(|| Links::new(surface).into()).clone(),
        )
    }
    /// Texture coordinates of each triangle's corners, if the mesh has them.
    pub fn uvs(&self) -> Option<&[[Vec2; 3]]> {
        self.head.uvs.as_deref()
    }
    /// The head frame.
    pub fn frame(&self) -> &HeadFrame {
        &self.head.space.frame
    }
    /// Conversion of data in head units, on this head.
    pub fn space(&self) -> &HeadSpace {
        &self.head.space
    }
    /// A stored position in head units, to cm ([`HeadSpace::place`]).
    pub fn place(&self, p: Vec3) -> Vec3 {
        self.head.space.place(p)
    }
    /// A position in cm, to its stored form in head units ([`HeadSpace::given`]).
    pub fn given(&self, p: Vec3) -> Vec3 {
        self.head.space.given(p)
    }
    /// Names of all masks that a field may use: those of the head and the sections of a parted scalp.
    pub fn mask_names(&self) -> Vec<String> {
        let sections = self.sections.iter().flat_map(|s| s.names().each());
        let sections = sections.map(|(name, _)| name.to_owned());
        self.head.masks.keys().cloned().chain(sections).collect()
    }
    /// A mask's values, one per vertex.
    pub fn mask(&self, name: &str) -> Option<&[f32]> {
        self.head.masks.get(name).map(Vec::as_slice)
    }
    /// The region where hair grows: 0 to 1 per vertex.
    pub fn region(&self) -> &[f32] {
        self.region.chosen.as_ref().map_or(&self.head.masks[REGION], |chosen| chosen.values())
    }
    /// The region as a tree by which roots are dealt out, computed on first use.
    pub(crate) fn spread(&self) -> &RegionTree {
        self.region.spread.get_or_init(|| {
            RegionTree::new(self.surface(), &|t| self.highest(t), self.kept.as_deref())
        })
    }
    fn drawn(&self, name: &str) -> Option<&DrawnRegion> {
        self.head.drawn.iter().find(|(known, _)| known == name).map(|(_, region)| region)
    }
    /// Value of the region at a point of a triangle, 0 to 1; 0 for a missing triangle.
    pub fn grows(&self, triangle: u32, bary: Vec2) -> f32 {
        let exact = match &self.region.chosen {
            Some(chosen) => chosen.at(triangle, bary),
            None => self.drawn(REGION).map(|drawn| drawn.at(self.surface(), triangle, bary)),
        };
        exact.unwrap_or_else(|| self.mask_at(self.region(), triangle, bary))
    }
    /// Upper bound of the region's value in a triangle.
    pub(crate) fn highest(&self, triangle: u32) -> f32 {
        let exact = match &self.region.chosen {
            Some(chosen) => chosen.highest(triangle),
            None => self.drawn(REGION).and_then(|drawn| drawn.highest(triangle)),
        };
        exact.unwrap_or_else(|| {
            highest(self.region(), self.head.surface.triangles[triangle as usize])
        })
    }
    /// Area of the region if it was drawn or masked, cm2.
    pub(crate) fn exact_area(&self) -> Option<f32> {
        match &self.region.chosen {
            Some(chosen) => Some(chosen.area()),
            None => self.drawn(REGION).map(DrawnRegion::area),
        }
    }
    /// The values of a mask at points of triangles; `None` without a mask of that name.
    pub fn mask_named(&self, name: &str) -> Option<impl Fn(u32, Vec2) -> f32> {
        let (values, drawn) = (self.mask(name)?, self.drawn(name));
        Some(move |triangle, bary| match drawn {
            Some(region) => region.at(&self.head.surface, triangle, bary),
            None => self.mask_at(values, triangle, bary),
        })
    }
    /// A mask's value at a point of a triangle, interpolated from its corners; 0 for a missing triangle.
    pub fn mask_at(&self, mask: &[f32], triangle: u32, bary: Vec2) -> f32 {
        let Some(t) = self.head.surface.triangles.get(triangle as usize) else { return 0.0 };
        let [a, b, c] = t.map(|v| mask[v as usize]);
        a * (1.0 - bary.x - bary.y) + b * bary.x + c * bary.y
    }
    /// The root at a point of a triangle.
    pub fn root(&self, triangle: u32, bary: Vec2) -> Root {
        let uv = self.head.uvs.as_ref().map_or(Vec2::ZERO, |uvs| {
            let [a, b, c] = uvs[triangle as usize];
            a + (b - a) * bary.x + (c - a) * bary.y
        });
        Root {
            triangle,
            bary,
            uv,
            point: self.head.surface.at(triangle, bary),
            normal: self.head.surface.smooth_normal(triangle, bary),
        }
    }
    /// The scalp point closest to `p`; `None` on an empty mesh or if `p` is not finite.
    pub fn closest_root(&self, p: Vec3) -> Option<Root> {
        let Hit { triangle, bary, .. } = self.head.surface.closest(p)?;
        Some(self.root(triangle, bary))
    }
    /// The skin, ready for inside tests. It builds what it needs of the distance field on demand.
    pub fn skin(&self) -> Skin<'_> {
        let head = &*self.head;
        let field = head.field.get_or_init(|| DistanceField::new(&head.surface));
        Skin::new(&head.surface, field, self.rough())
    }
    /// Why hair is not led around this mesh; `None` on heads.
    pub fn rough(&self) -> Option<Rough> {
        let make = || Rough::of(self.surface(), self.region(), self.frame().unit());
        *self.region.rough.get_or_init(make)
    }
    /// Bytes held.
    pub fn bytes(&self) -> usize {
        match (&self.sections, &self.region.chosen) {
            (Some(sections), _) => sections.buffer().1,
            (None, Some(_)) => self.region.bytes(),
            (None, None) => self.head_bytes() + self.region.bytes(),
        }
    }
    /// Reports the buffers of the head and its sections, which other scalps may share, and their current size in bytes:
    /// what is built on demand (the distance field, the chart) counts from then on.
    pub fn buffers(&self, tell: &mut impl FnMut(usize, usize)) {
        tell(Arc::as_ptr(&self.head) as usize, self.head_bytes());
        tell(Arc::as_ptr(&self.region) as usize, self.region.bytes());
        if let Some(aside) = &self.aside {
            aside.buffers(tell);
        }
        if let Some(sections) = &self.sections {
            let (at, bytes) = sections.buffer();
            tell(at, bytes);
        }
    }
    fn head_bytes(&self) -> usize {
        let vertices = self.head.surface.points.len() * (24 + 4 * self.head.masks.len());
        vertices
            + self.head.surface.triangles.len() * 150
            + self.head.field.get().map_or(0, DistanceField::bytes)
            + self.head.links.get().map_or(0, |links| links.bytes())
            + self.head.drawn.iter().map(|(_, region)| region.bytes()).sum::<usize>()
    }
}

impl std::fmt::Debug for Scalp {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "Scalp({} triangles)", self.head.surface.triangles.len())
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use crate::maths::closest::tests::sphere;
    use crate::maths::hash::Dice;

    /// A ball of 8.9 cm whose upper half is scalp.
    pub(crate) fn ball() -> Scalp {
        let surface = sphere(HEAD_RADIUS, 48);
        let region = surface.points.iter().map(|p| f32::from(p.y > 0.0)).collect();
        Scalp::new(surface, None, HeadFrame::IDENTITY, [(REGION.to_owned(), region)].into())
    }

    /// The same ball, for all tests that only read it: its distance field is built once.
    pub(crate) fn shared_ball() -> std::sync::Arc<Scalp> {
        static BALL: OnceLock<std::sync::Arc<Scalp>> = OnceLock::new();
        BALL.get_or_init(|| ball().into()).clone()
    }

    #[test]
    fn nothing_stays_deeper_than_allowed_and_nothing_else_moves() {
        let scalp = ball();
        let skin = scalp.skin();
        let dice = Dice::new(1, 0, "query");
        for id in 0..3000 {
            let p = Vec3::new(dice.signed(id, 0), dice.signed(id, 1), dice.signed(id, 2)) * 11.0;
            let allowed = if id % 2 == 0 { 0.0 } else { 0.3 };
            let exact = |p| skin.exact(p).unwrap().0;
            let before = exact(p);
            let (q, moved) = skin.push_out(p, allowed);
            assert_eq!(moved, before < -allowed, "{p} {before}");
            assert!(exact(q) >= -allowed, "{p} {}", exact(q));
            if moved {
                assert!(exact(q) < -allowed + 0.01);
            } else {
                assert_eq!(p, q);
            }
        }
    }

    #[test]
    fn a_way_out_is_no_longer_than_it_must_be() {
        let scalp = ball();
        let skin = scalp.skin();
        // The given direction leads across the head; the nearest one does not.
        let (p, way) = (Vec3::new(0.3, 8.6, 1.0), Vec3::NEG_Y);
        let out = skin.escape(p, way, 0.1);
        let (height, _) = skin.exact(out).unwrap();
        assert!(height >= 0.1 && out.distance(p) < 0.7, "{out} {height}");
    }

    #[test]
    fn head_units_are_centimetres_on_a_head_of_average_size() {
        let frame = HeadFrame {
            origin: Vec3::new(1.0, 2.0, 3.0),
            right: Vec3::NEG_Z,
            forward: Vec3::X,
            radius: 2.0 * HEAD_RADIUS,
            ..HeadFrame::IDENTITY
        };
        let p = frame.point_from_head(Vec3::new(0.0, 1.0, 2.0));
        assert_eq!(p, Vec3::new(5.0, 4.0, 3.0));
        assert!(frame.head_from_point(p).distance(Vec3::new(0.0, 1.0, 2.0)) < 1e-6);
    }
}
