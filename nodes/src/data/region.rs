//! Where hair grows on a head, and what follows from it: the head's own region, or one that was chosen behind it.
//!
//! A chosen region lies inside drawn lines, where a field says, or both. Between vertices it is as exact as what it is
//! made of: triangles in which lines or the field change are asked at the very place.
//!
//! Guarantees: the region depends on the head, the lines and the field alone, and no head holds a second copy of its mesh
//! for it. Not promised: dabs of a painted mask that are smaller than the spacing at which triangles are looked at.

use super::chart::Chart;
use super::drawn::DrawnRegion;
use super::field::{Field, FieldFault};
use super::outline::for_middles;
use super::rough::Rough;
use super::scalp::{Root, Scalp};
use super::spread::RegionTree;
use crate::error::NodeError;
use crate::maths::hash::{Key, KeyBuilder};
use glam::Vec2;
use std::sync::{Arc, OnceLock};

/// A region of one head; the head's own where nothing is chosen.
#[derive(Default)]
pub(super) struct Region {
    pub(super) chosen: Option<ChosenRegion>,
    pub(super) rough: OnceLock<Option<Rough>>,
    pub(super) spread: OnceLock<RegionTree>,
    pub(super) chart: OnceLock<Chart>,
}

impl From<ChosenRegion> for Region {
    fn from(chosen: ChosenRegion) -> Self {
        Self { chosen: Some(chosen), ..Self::default() }
    }
}

impl Region {
    /// Bytes held.
    pub(super) fn bytes(&self) -> usize {
        self.chosen.as_ref().map_or(0, ChosenRegion::bytes)
            + self.spread.get().map_or(0, RegionTree::bytes)
            + self.chart.get().map_or(0, Chart::bytes)
    }
}

/// A region that was chosen on a head.
pub(crate) struct ChosenRegion {
    key: Key,
    drawn: Option<DrawnRegion>,
    field: Arc<Field>,
    /// Whether hair grows only where it grows on that head anyway.
    within: bool,
    /// The head that the field is read on, with its partings.
    on: Arc<Scalp>,
    /// Value at each vertex.
    values: Vec<f32>,
    /// Triangles in which values cannot be interpolated from the corners.
    exact: Vec<bool>,
    area: f32,
}

/// Spacing of the places at which triangles are looked at, head units ...
const SPACING: f32 = 0.2;
/// ... but no more of them than this on the whole mesh, where it is large, or in one triangle.
const MOST: f32 = 1e6;
const MOST_BESIDE: f32 = 64.0;
/// Places that are looked at together.
const BATCH: usize = 65_536;

impl ChosenRegion {
    /// The region of `on` inside `drawn` and where `field` says, with `within` only where hair grows on it already. `check` is
    /// asked between batches.
    ///
    /// # Errors
    /// If the field cannot be read on the skin, or `check` says to stop.
    pub(crate) fn new(
        on: &Arc<Scalp>,
        drawn: Option<DrawnRegion>,
        (field, within): (&Arc<Field>, bool),
        check: &dyn Fn() -> Result<(), NodeError>,
    ) -> Result<Self, NodeError> {
        let surface = on.surface();
        let count = surface.triangles.len();
        let head = if field.has_mask() || within { on.key() } else { on.whole() };
        let key = KeyBuilder::new("chosen region").key(head).int(u64::from(within));
        let mut key = field.add_to(key);
        if let Some(drawn) = &drawn {
            key = key.key(drawn.key());
        }
        let mut chosen = Self {
            key: key.finish(),
            drawn,
            field: field.clone(),
            within,
            on: on.clone(),
            values: vec![0.0; surface.points.len()],
            exact: vec![false; count],
            area: 0.0,
        };
        let is_known = |t: &usize| !surface.is_gone(*t as u32);
        let areas: Vec<f32> =
            (0..count as u32).map(|t| 0.5 * surface.area_vector(t).length()).collect();
        let whole: f32 = (0..count).filter(is_known).map(|t| areas[t]).sum();
        let spacing = (SPACING * on.frame().unit()).max((whole / MOST).sqrt());
        let mut area = 0.0f64;
        let looks = |t: usize| {
            let beside = (2.0 * areas[t]).sqrt() / spacing;
            beside.ceil().clamp(1.0, MOST_BESIDE) as u32
        };
        let triangles: Vec<usize> = (0..count).filter(is_known).collect();
        let (mut rest, mut places) = (triangles.as_slice(), vec![]);
        while !rest.is_empty() {
            check()?;
            places.clear();
            let fit = rest.iter().take_while(|t| {
                let is_room = places.len() < BATCH;
                if is_room {
                    let t = **t as u32;
                    places.extend([Vec2::ZERO, Vec2::X, Vec2::Y].map(|bary| (t, bary)));
                    for_middles(looks(t as usize), |bary| places.push((t, bary)));
                }
                is_room
            });
            let batch;
            (batch, rest) = rest.split_at(fit.count());
            let values = chosen.read(&places)?;
            let mut values = values.as_slice();
            for t in batch {
                let n = looks(*t);
                let own;
                (own, values) = values.split_at(3 + (n * n) as usize);
                for (v, x) in surface.triangles[*t].iter().zip(own) {
                    chosen.values[*v as usize] = *x;
                }
                chosen.exact[*t] = own.iter().any(|x| *x != own[0]);
                let sum: f64 = own[3..].iter().map(|x| f64::from(*x)).sum();
                area += f64::from(areas[*t]) * sum / f64::from(n * n);
            }
        }
        if let Some(drawn) = &chosen.drawn {
            // Lines pass between the places looked at, too.
            for (t, exact) in (0..).zip(&mut chosen.exact) {
                *exact |= drawn.highest(t).is_some();
            }
        }
        chosen.area = area as f32;
        Ok(chosen)
    }

    /// The values at places of the skin.
    fn read(&self, places: &[(u32, Vec2)]) -> Result<Vec<f32>, FieldFault> {
        let roots: Vec<Root> = places.iter().map(|(t, bary)| self.on.root(*t, *bary)).collect();
        let mut values = self.field.on_skin(&roots, &self.on)?;
        if self.within {
            let grows = places.iter().map(|(t, bary)| self.on.grows(*t, *bary));
            values.iter_mut().zip(grows).for_each(|(x, grows)| *x *= grows);
        }
        if let Some(drawn) = &self.drawn {
            let surface = self.on.surface();
            let inside = places.iter().map(|(t, bary)| drawn.at(surface, *t, *bary));
            values.iter_mut().zip(inside).for_each(|(x, inside)| *x *= inside);
        }
        Ok(values)
    }

    /// The value at a point of a triangle; `None` where the corners tell it.
    pub(super) fn at(&self, triangle: u32, bary: Vec2) -> Option<f32> {
        self.exact.get(triangle as usize).filter(|exact| **exact)?;
        self.read(&[(triangle, bary)]).ok()?.first().copied()
    }
    /// Upper bound of the values in a triangle; `None` if the corners bound them.
    pub(super) fn highest(&self, triangle: u32) -> Option<f32> {
        self.exact[triangle as usize].then_some(1.0)
    }
    /// Value at each vertex.
    pub(super) fn values(&self) -> &[f32] {
        &self.values
    }
    /// Area in cm2, weighted by the values.
    pub(crate) fn area(&self) -> f32 {
        self.area
    }
    /// Hash of the content.
    pub(super) fn key(&self) -> Key {
        self.key
    }
    fn bytes(&self) -> usize {
        let drawn = self.drawn.as_ref().map_or(0, DrawnRegion::bytes);
        size_of_val(&self.values[..]) + self.exact.len() + self.field.bytes() + drawn
    }
}
