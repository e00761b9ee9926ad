//! A painted mask on one head: what a list of strokes with brushes makes of a number at each place of the skin.
//!
//! Strokes count one after the other, each as a whole: where a pass covers itself it counts once, and its samples are joined, so
//! that how fast the hand was leaves no trace. The value at a place comes from the dabs alone, never from the mesh's vertices, so
//! that a coarse head and a fine one show the same picture. On another head each sample goes to the skin nearest to its place in
//! the head's frame.
//!
//! Guarantees: values are 0 to 1; a stroke changes nothing beyond its reach, and nothing on skin that faces away from it, such as
//! the back of an ear that is painted in front. Not promised: that a closed line is right where skin lies over skin, seen from the
//! middle of the head: there all layers are in or out.

mod dabs;
mod even;
mod ring;

use super::attributes::{Domain, ROOT_BARY, ROOT_TRIANGLE};
use super::curves::TuftBuilder;
use super::field::{Field, FieldFault};
use super::scalp::{Root, Scalp};
use super::strokes::{Brush, Mode, Stroke, Strokes};
use crate::define::NodeError;
use crate::maths::hash::{Key, KeyBuilder};
use crate::scalp::region::soft;
use dabs::{Dabs, Piece};
pub use even::Even;
use glam::{Vec2, Vec3};
use ring::Ring;
use std::cell::OnceCell;
use std::sync::Arc;

/// A mask that strokes paint on a head.
pub struct Painted {
    key: Key,
    scalp: Arc<Scalp>,
    base: Arc<Field>,
    layers: Vec<Layer>,
    dabs: Dabs,
    /// The layers that also act where none of their dabs is near, in order.
    wide: Vec<u32>,
    edges: Edges,
}

/// How strokes end.
#[derive(Clone, Copy, Debug)]
pub struct Edges {
    /// The share of a dab's radius over which it fades: 0 is a hard edge, 1 fades from the middle on.
    pub softness: f32,
    /// The width over which the inside of a closed stroke fades, cm.
    pub line: f32,
}

/// One stroke on this head.
struct Layer {
    mode: Mode,
    strength: f32,
    /// Numbers of the sections that it and its twin on the other side keep to; empty: the head has no such section.
    sections: Option<[Vec<u32>; 2]>,
    /// The closed lines of it and its twin.
    rings: Option<[Option<Ring>; 2]>,
    /// What a smooth stroke brings the mask to.
    even: Option<Arc<Even>>,
}

/// Skin that faces away by more than this cosine is not reached, and from the second on wholly.
const AWAY: (f32, f32) = (-0.5, 0.0);

impl Painted {
    /// What the strokes make of `base` on this head. `known` finds or makes what evens out a stroke, by its key.
    ///
    /// # Errors
    /// When the base cannot be read on the scalp, and what `check` gives.
    pub fn new(
        scalp: Arc<Scalp>,
        strokes: &Strokes,
        base: Arc<Field>,
        edges: Edges,
        check: &dyn Fn() -> Result<(), NodeError>,
        known: &dyn Fn(Key, &dyn Fn() -> Result<Even, NodeError>) -> Result<Arc<Even>, NodeError>,
    ) -> Result<Self, NodeError> {
        let by_section = strokes.0.iter().filter_map(|stroke| stroke.brush.as_ref());
        let by_section = by_section.clone().any(|brush| !brush.section.is_empty());
        let head = if by_section || base.has_mask() { scalp.key() } else { scalp.whole() };
        let mut key = base
            .add_to(KeyBuilder::new("painted").key(head))
            .float(edges.softness)
            .float(edges.line)
            .finish();
        let mut keys = vec![];
        let (mut layers, mut pieces, mut wide) = (vec![], vec![], vec![]);
        for (number, stroke) in (0u32..).zip(&strokes.0) {
            check()?;
            keys.push(key);
            key = KeyBuilder::new("painted").key(key).key(stroke.key()).finish();
            let usual = Brush::default();
            let brush = stroke.brush.as_ref().unwrap_or(&usual);
            let halves = [Some(false), brush.mirrored.then_some(true)];
            let sides = halves.map(|half| half.map(|twin| on_skin(&scalp, stroke, twin)));
            let closed = brush.closed && stroke.samples.len() >= 3 && brush.mode != Mode::Smooth;
            let reach = if closed { 0.5 * edges.line } else { brush.radius * scalp.frame().unit() };
            for (half, dabs) in (0u8..).zip(&sides) {
                let dabs = dabs.as_deref().unwrap_or_default();
                let loops = dabs.first().filter(|_| closed);
                let next = dabs.iter().skip(1).chain(loops);
                let ends = dabs.iter().zip(next).map(|(a, b)| [*a, *b]);
                let dot = dabs.first().filter(|_| dabs.len() == 1).map(|dab| [*dab; 2]);
                let whole = brush.mode != Mode::Flood || closed;
                let ends = ends.chain(dot).filter(|_| whole);
                pieces.extend(ends.map(|ends| Piece::new(ends, reach, number, half)));
            }
            let rings = closed
                .then(|| sides.each_ref().map(|dabs| Some(Ring::new(&scalp, dabs.as_deref()?))));
            if rings.is_some() || brush.mode == Mode::Flood {
                wide.push(number);
            }
            layers.push(Layer {
                mode: brush.mode,
                strength: brush.strength,
                sections: sections_of(&scalp, brush, &sides),
                rings,
                even: None,
            });
        }
        let dabs = Dabs::new(pieces, scalp.surface().bounds(), check)?;
        let mut painted = Self { key, scalp, base, layers, dabs, wide, edges };
        for (number, before) in (0u32..).zip(keys) {
            if painted.layers[number as usize].mode != Mode::Smooth {
                continue;
            }
            let key = KeyBuilder::new("evened").key(before).key(strokes.0[number as usize].key());
            let even = known(key.finish(), &|| Even::new(&painted, number, check))?;
            painted.layers[number as usize].even = Some(even);
        }
        Ok(painted)
    }

    /// Hash of the content.
    pub fn key(&self) -> Key {
        self.key
    }
    /// The head that it is painted on.
    pub fn scalp(&self) -> &Arc<Scalp> {
        &self.scalp
    }
    /// What it begins with.
    pub fn base(&self) -> &Arc<Field> {
        &self.base
    }
    /// Bytes held.
    pub fn bytes(&self) -> usize {
        let evened = self.layers.iter().filter_map(|layer| layer.even.as_ref());
        self.dabs.bytes() + evened.map(|even| even.bytes()).sum::<usize>() + 64 * self.layers.len()
    }
    /// Whether it asks where partings lie.
    pub fn reads_sections(&self) -> bool {
        self.base.has_mask() || self.layers.iter().any(|layer| layer.sections.is_some())
    }

    /// The value at a place of the skin, where `base` is what it begins with there, 0 to 1.
    pub fn at(&self, place: &Root, base: f32) -> f32 {
        self.before(u32::MAX, place.point, || place.normal, base)
    }

    /// The value at a point of a triangle of its head.
    pub(super) fn on_triangle(&self, triangle: u32, bary: Vec2, base: f32) -> f32 {
        let surface = self.scalp.surface();
        let normal = || surface.smooth_normal(triangle, bary);
        self.before(u32::MAX, surface.at(triangle, bary), normal, base)
    }

    /// The values at places of the skin.
    ///
    /// # Errors
    /// When the base cannot be read on the scalp.
    pub fn on(&self, places: &[Root]) -> Result<Vec<f32>, FieldFault> {
        let bases = self.bases(places)?;
        Ok(places.iter().zip(bases).map(|(place, base)| self.at(place, base)).collect())
    }

    /// What it begins with at places of the skin.
    fn bases(&self, places: &[Root]) -> Result<Vec<f32>, FieldFault> {
        if let Some(x) = self.base.constant() {
            return Ok(vec![x.clamp(0.0, 1.0); places.len()]);
        }
        let mut b = TuftBuilder::even(places.iter().map(|place| place.point).collect(), 1);
        let triangles = places.iter().map(|place| place.triangle as i32).collect();
        b.set(ROOT_TRIANGLE, Domain::Curve, triangles);
        b.set(ROOT_BARY, Domain::Curve, places.iter().map(|place| place.bary).collect());
        let tuft = b.build();
        let base = self.base.on(&tuft, Some(&self.scalp), (0.0, 1.0))?;
        Ok((0..places.len()).map(|i| base.at(i, i, 0.0)).collect())
    }

    /// The value at a point of the skin with this normal, which is asked for where it matters, after the first `count` strokes.
    fn before(&self, count: u32, point: Vec3, normal: impl Fn() -> Vec3, base: f32) -> f32 {
        let near = self.dabs.near(point);
        let (section, out) = (OnceCell::new(), OnceCell::new());
        let (mut value, mut k, mut w) = (base, 0, 0);
        loop {
            let next = near.get(k).map_or(u32::MAX, |i| self.dabs.piece(*i).layer);
            let wide = self.wide.get(w).copied().unwrap_or(u32::MAX);
            let number = next.min(wide);
            if number >= count.min(self.layers.len() as u32) {
                return value;
            }
            let layer = &self.layers[number as usize];
            w += usize::from(wide == number);
            // Of each side: how much it is covered, and how far the line is.
            let (mut cover, mut far) = ([0.0f32; 2], [f32::MAX; 2]);
            while let Some(i) = near.get(k)
                && self.dabs.piece(*i).layer == number
            {
                k += 1;
                let piece = self.dabs.piece(*i);
                let half = usize::from(piece.half);
                if layer.rings.is_some() {
                    far[half] = far[half].min(piece.square(point).0.sqrt());
                } else {
                    cover[half] =
                        cover[half].max(self.covered(piece, point, || *out.get_or_init(&normal)));
                }
            }
            match (&layer.rings, layer.mode) {
                (Some(rings), _) => {
                    for ((cover, far), ring) in cover.iter_mut().zip(far).zip(rings) {
                        let Some(ring) = ring else { continue };
                        let inside = if ring.holds(point) { far } else { -far };
                        *cover = soft(inside, self.edges.line);
                    }
                }
                (None, Mode::Flood) => cover = [1.0; 2],
                _ => {}
            }
            if let Some(own) = &layer.sections {
                let here = *section.get_or_init(|| self.section(point));
                for (cover, own) in cover.iter_mut().zip(own) {
                    *cover *= f32::from(here.is_some_and(|here| own.contains(&here)));
                }
            }
            let cover = cover[0].max(cover[1]);
            if cover <= 0.0 {
                continue;
            }
            value = match layer.mode {
                Mode::Paint => value + (1.0 - value) * (cover * layer.strength),
                Mode::Erase => value - value * (cover * layer.strength),
                Mode::Flood => value + (layer.strength - value) * cover,
                Mode::Smooth => {
                    let even = layer.even.as_ref().and_then(|even| even.at(point));
                    value + (even.unwrap_or(value) - value) * (cover * layer.strength)
                }
            };
        }
    }

    /// How much of a place a piece of a stroke covers.
    #[inline]
    fn covered(&self, piece: &Piece, point: Vec3, normal: impl Fn() -> Vec3) -> f32 {
        let (square, t) = piece.square(point);
        if square >= piece.reach * piece.reach {
            return 0.0;
        }
        let [a, b] = &piece.ends;
        let faces = (a.normal + (b.normal - a.normal) * t).dot(normal());
        let faces = ((faces - AWAY.0) / (AWAY.1 - AWAY.0)).clamp(0.0, 1.0);
        let pressure = a.pressure + (b.pressure - a.pressure) * t;
        let inner = 1.0 - square.sqrt() / piece.reach;
        let x = if inner < self.edges.softness { inner / self.edges.softness } else { 1.0 };
        pressure * faces * (x * x * (3.0 - 2.0 * x))
    }

    fn section(&self, point: Vec3) -> Option<u32> {
        Some(self.scalp.sections()?.at(point)?.section)
    }
}

/// A sample on the skin.
#[derive(Clone, Copy)]
struct Dab {
    point: Vec3,
    normal: Vec3,
    pressure: f32,
}

/// The samples of a stroke, or of its twin on the other side, on the skin.
fn on_skin(scalp: &Scalp, stroke: &Stroke, twin: bool) -> Vec<Dab> {
    let side = if twin { Vec3::new(-1.0, 1.0, 1.0) } else { Vec3::ONE };
    let dab = |sample: &super::strokes::Sample| {
        let root = scalp.closest_root(scalp.frame().point_from_head(sample.position * side))?;
        let pressure = sample.pressure.clamp(0.0, 1.0);
        Some(Dab { point: root.point, normal: root.normal, pressure })
    };
    stroke.samples.iter().filter_map(dab).collect()
}

/// The sections that a stroke and its twin keep to: that of its name, and that in which the twin begins.
fn sections_of(
    scalp: &Scalp,
    brush: &Brush,
    sides: &[Option<Vec<Dab>>; 2],
) -> Option<[Vec<u32>; 2]> {
    if brush.section.is_empty() {
        return None;
    }
    let Some(sections) = scalp.sections() else { return Some([vec![], vec![]]) };
    let first = sides[1].as_ref().and_then(|dabs| dabs.first());
    let twin = first.and_then(|dab| Some(sections.at(dab.point)?.section));
    let own = sections.names().get(&brush.section).unwrap_or_default();
    Some([own.to_vec(), twin.into_iter().collect()])
}

impl PartialEq for Painted {
    fn eq(&self, other: &Self) -> bool {
        self.key == other.key
    }
}

impl std::fmt::Debug for Painted {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "Painted({} strokes)", self.layers.len())
    }
}

#[cfg(test)]
mod laws;
