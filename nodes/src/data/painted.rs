//! A painted mask on one head: the number that a list of brush strokes produces at each point of the skin.
//!
//! Strokes apply in order, each as a whole: where a pass overlaps itself it counts once, and its samples are joined, so
//! that the speed of the hand leaves no trace. The value at a point depends on the dabs only, never on the mesh's
//! vertices, so that coarse and fine heads show the same mask. On another head, each sample goes to the skin nearest to
//! its position in the head frame.
//!
//! Guarantees: values are 0 to 1; a stroke changes nothing beyond its reach, and nothing on skin that faces away from
//! it, such as the back of an ear painted in front; the inside of a closed stroke is determined along the skin
//! (`outline.rs`), exactly in each triangle. Not promised: useful results for a closed stroke that does not divide the
//! skin; this is reported.

mod dabs;
mod even;

use super::field::{Field, FieldFault};
use super::laid::{ClosedStroke, LEAST_POINTS};
use super::scalp::{Root, Scalp};
use super::strokes::{Brush, Mode, Sample, Stroke, Strokes};
use crate::error::NodeError;
use crate::maths::hash::{Key, KeyBuilder};
use crate::maths::{smoothstep, soft_edge};
use dabs::{DabSegment, Dabs};
pub use even::GridMeans;
use glam::{Vec2, Vec3};
use std::cell::OnceCell;
use std::sync::Arc;

/// A mask painted on a head by strokes.
pub struct Painted {
    key: Key,
    scalp: Arc<Scalp>,
    base: Arc<Field>,
    layers: Vec<Layer>,
    dabs: Dabs,
    /// Layers that also act where none of their dabs is near, in order.
    wide: Vec<u32>,
    edges: Edges,
}

/// How strokes fade out.
#[derive(Clone, Copy, Debug)]
pub struct Edges {
    /// Fraction of a dab's radius over which it fades: 0 is a hard edge, 1 fades from the centre.
    pub softness: f32,
    /// Width over which the inside of a closed stroke fades, cm.
    pub line: f32,
}

/// One stroke on this head.
struct Layer {
    mode: Mode,
    strength: f32,
    /// Indices of the sections that it and its mirror image are limited to; empty: the head has no such section.
    sections: Option<[Vec<u32>; 2]>,
    /// Its closed line and that of its mirror image.
    lines: Option<[Option<Arc<ClosedStroke>>; 2]>,
    /// Its number of points, if too few to close.
    too_few: Option<usize>,
    /// What a smooth stroke blends the mask toward.
    even: Option<Arc<GridMeans>>,
}

/// Skin that faces away by more than the first cosine is not reached; from the second cosine on it is fully reached.
const AWAY: (f32, f32) = (-0.5, 0.0);

impl Painted {
    /// The mask that the strokes make of `base` on this head. `known` finds or computes the smoothing of a stroke by
    /// its key, and `laid` its closed line.
    ///
    /// # Errors
    /// If the base cannot be read on the scalp, and what `check` returns.
    pub(crate) fn new(
        scalp: Arc<Scalp>,
        strokes: &Strokes,
        base: Arc<Field>,
        edges: Edges,
        check: &dyn Fn() -> Result<(), NodeError>,
        known: &dyn Fn(
            Key,
            &dyn Fn() -> Result<GridMeans, NodeError>,
        ) -> Result<Arc<GridMeans>, NodeError>,
        laid: &dyn Fn(Key, &dyn Fn() -> ClosedStroke) -> Result<Arc<ClosedStroke>, NodeError>,
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
            let layer = Layer::new(&scalp, (number, stroke), &edges, &mut pieces, laid)?;
            if layer.lines.is_some() || layer.mode == Mode::Flood {
                wide.push(number);
            }
            layers.push(layer);
        }
        let dabs = Dabs::new(pieces, scalp.surface().bounds(), check)?;
        let mut painted = Self { key, scalp, base, layers, dabs, wide, edges };
        for (number, before) in (0u32..).zip(keys) {
            if painted.layers[number as usize].mode != Mode::Smooth {
                continue;
            }
            let key = KeyBuilder::new("evened").key(before).key(strokes.0[number as usize].key());
            let even = known(key.finish(), &|| GridMeans::new(&painted, number, check))?;
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
    /// Its value before the first stroke.
    pub fn base(&self) -> &Arc<Field> {
        &self.base
    }
    /// Bytes held.
    pub fn bytes(&self) -> usize {
        let evened = self.layers.iter().filter_map(|layer| layer.even.as_ref());
        let evened: usize = evened.map(|even| even.bytes()).sum();
        let lines = self.layers.iter().filter_map(|layer| layer.lines.as_ref()).flatten().flatten();
        let lines: usize = lines.map(|laid| laid.bytes()).sum();
        self.dabs.bytes() + evened + lines + 64 * self.layers.len()
    }
    /// What is wrong with closed strokes, in words, each with the stroke's number from 1.
    pub(crate) fn faults(&self) -> impl Iterator<Item = String> {
        (1..).zip(&self.layers).flat_map(|(number, layer): (u32, &Layer)| {
            let few = layer
                .too_few
                .map(|count| format!("stroke {number} has {count} points and encloses nothing"));
            let told = layer.lines.iter().flatten().zip(["", "the twin of "]);
            let told = told.flat_map(move |(laid, twin)| {
                let faults = laid.iter().flat_map(|laid| &laid.faults);
                faults.map(move |fault| format!("{twin}stroke {number} {fault}"))
            });
            few.into_iter().chain(told)
        })
    }
    /// Whether it depends on partings.
    pub fn reads_sections(&self) -> bool {
        self.base.has_mask() || self.layers.iter().any(|layer| layer.sections.is_some())
    }

    /// The value at a point of the skin, given the value of the base there; 0 to 1.
    pub fn at(&self, place: &Root, base: f32) -> f32 {
        self.before(u32::MAX, (place.triangle, place.bary), place.point, || place.normal, base)
    }

    /// The value at a point of a triangle of its head.
    pub(super) fn on_triangle(&self, triangle: u32, bary: Vec2, base: f32) -> f32 {
        let surface = self.scalp.surface();
        let normal = || surface.smooth_normal(triangle, bary);
        self.before(u32::MAX, (triangle, bary), surface.at(triangle, bary), normal, base)
    }

    /// The values at points of the skin.
    ///
    /// # Errors
    /// If the base cannot be read on the scalp.
    pub fn on(&self, places: &[Root]) -> Result<Vec<f32>, FieldFault> {
        let bases = self.base.on_skin(places, &self.scalp)?;
        Ok(places.iter().zip(bases).map(|(place, base)| self.at(place, base)).collect())
    }

    /// The value after the first `count` strokes at a point of a triangle; its normal is computed only if needed.
    fn before(
        &self,
        count: u32,
        (triangle, bary): (u32, Vec2),
        point: Vec3,
        normal: impl Fn() -> Vec3,
        base: f32,
    ) -> f32 {
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
            // For each side: how much it is covered, and how far the line is.
            let (mut cover, mut far) = ([0.0f32; 2], [f32::MAX; 2]);
            while let Some(i) = near.get(k)
                && self.dabs.piece(*i).layer == number
            {
                k += 1;
                let piece = self.dabs.piece(*i);
                let half = usize::from(piece.half);
                if layer.lines.is_some() {
                    far[half] = far[half].min(piece.square(point).0.sqrt());
                } else {
                    cover[half] =
                        cover[half].max(self.covered(piece, point, || *out.get_or_init(&normal)));
                }
            }
            match (&layer.lines, layer.mode) {
                (Some(lines), _) => {
                    let surface = self.scalp.surface();
                    for ((cover, far), laid) in cover.iter_mut().zip(far).zip(lines) {
                        let Some(laid) = laid else { continue };
                        let inside = laid.outline.holds(surface, triangle, bary);
                        *cover = soft_edge(if inside { far } else { -far }, self.edges.line);
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

    /// How much a segment of a stroke covers a point.
    #[inline]
    fn covered(&self, piece: &DabSegment, point: Vec3, normal: impl Fn() -> Vec3) -> f32 {
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
        pressure * faces * smoothstep(x)
    }

    fn section(&self, point: Vec3) -> Option<u32> {
        Some(self.scalp.sections()?.at(point)?.section)
    }
}

impl Layer {
    /// A stroke on this head; its segments are added to `pieces`.
    fn new(
        scalp: &Scalp,
        (number, stroke): (u32, &Stroke),
        edges: &Edges,
        pieces: &mut Vec<DabSegment>,
        laid: &dyn Fn(Key, &dyn Fn() -> ClosedStroke) -> Result<Arc<ClosedStroke>, NodeError>,
    ) -> Result<Self, NodeError> {
        let usual = Brush::default();
        let brush = stroke.brush.as_ref().unwrap_or(&usual);
        let halves = [Some(false), brush.mirrored.then_some(true)];
        let sides = halves.map(|half| half.map(|twin| on_skin(scalp, stroke, twin)));
        let to_close = brush.closed && brush.mode != Mode::Smooth;
        let closed = to_close && stroke.samples.len() >= LEAST_POINTS;
        let line = |twin: bool| {
            let key = KeyBuilder::new("closed line").key(scalp.whole()).key(stroke.key());
            laid(key.int(u64::from(twin)).finish(), &|| on_mesh(scalp, stroke, twin))
        };
        let lines = match closed {
            true => Some([halves[0].map(line).transpose()?, halves[1].map(line).transpose()?]),
            false => None,
        };
        for (half, side) in (0u8..).zip(&sides) {
            let line = lines.as_ref().and_then(|lines| lines[usize::from(half)].as_ref());
            let (ends, reach) = match line {
                Some(laid) => {
                    let pieces = laid.outline.pieces().iter();
                    (pieces.map(|piece| piece.ends.map(Dab::at)).collect(), 0.5 * edges.line)
                }
                None if closed || brush.mode == Mode::Flood => continue,
                None => {
                    let dabs = side.as_deref().unwrap_or_default();
                    (passes(dabs), brush.radius * scalp.frame().unit())
                }
            };
            let made = ends.into_iter().map(|ends| DabSegment::new(ends, reach, number, half));
            pieces.extend(made);
        }
        Ok(Self {
            mode: brush.mode,
            strength: brush.strength,
            sections: sections_of(scalp, brush, &sides),
            lines,
            too_few: (to_close && !closed).then_some(stroke.samples.len()),
            even: None,
        })
    }
}

/// A sample on the skin.
#[derive(Clone, Copy)]
struct Dab {
    point: Vec3,
    normal: Vec3,
    pressure: f32,
}

impl Dab {
    /// A sample of a line, which has no side and no strength.
    fn at(point: Vec3) -> Self {
        Self { point, normal: Vec3::ZERO, pressure: 0.0 }
    }
}

/// Segments from each sample to the next; a single sample is a dot.
fn passes(dabs: &[Dab]) -> Vec<[Dab; 2]> {
    match dabs {
        [dot] => vec![[*dot; 2]],
        _ => dabs.windows(2).map(|pair| [pair[0], pair[1]]).collect(),
    }
}

/// Position of a sample of a stroke, or of its mirror image, cm.
fn place(scalp: &Scalp, sample: &Sample, twin: bool) -> Vec3 {
    let side = if twin { Vec3::new(-1.0, 1.0, 1.0) } else { Vec3::ONE };
    scalp.frame().point_from_head(sample.position * side)
}

/// The samples of a stroke, or of its mirror image, on the skin.
fn on_skin(scalp: &Scalp, stroke: &Stroke, twin: bool) -> Vec<Dab> {
    let dab = |sample: &Sample| {
        let root = scalp.closest_root(place(scalp, sample, twin))?;
        let pressure = sample.pressure.clamp(0.0, 1.0);
        Some(Dab { point: root.point, normal: root.normal, pressure })
    };
    stroke.samples.iter().filter_map(dab).collect()
}

/// The closed line of a stroke, or of its mirror image. Distances to it come from the dabs.
fn on_mesh(scalp: &Scalp, stroke: &Stroke, twin: bool) -> ClosedStroke {
    let points: Vec<Vec3> =
        stroke.samples.iter().map(|sample| place(scalp, sample, twin)).collect();
    ClosedStroke::new(&scalp.net(), scalp.space(), &points, 0.0)
}

/// The sections that a stroke and its mirror image are limited to: the named one, and the one in which the mirror image
/// begins.
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
