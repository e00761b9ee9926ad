//! How partings cut a mesh that the map does not show, such as an animal's: along its triangles.
//!
//! Corners of triangles are connected if no line crosses the edge between them; a connected set is a section. A point
//! belongs to the section of a corner that it reaches without crossing a line.
//!
//! Guarantees: as in [`super::outline`], borders are as sharp as the lines; the same sections for any order of lines.
//! Not promised: patterns, and hair that is led within its section; both need the map.

use super::chart::cross;
use super::links::{UnionFind, edge};
use super::outline::{SurfaceLine, SurfaceSegment, for_middles, in_triangle, within};
use super::scalp::Scalp;
use super::sections::{NONE, Parting, Section, ids};
use crate::maths::closest::Surface;
use crate::maths::nearest::KdTree;
use glam::{DVec3, Vec2, Vec3};
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

/// Pieces with a smaller fraction of the skin on which hair grows are not sections.
const LEAST: f64 = 0.0005;
/// Samples along a side of a cut triangle, by which its area is divided.
const SHARES: u32 = 16;

/// The sections of a mesh.
pub(super) struct MeshCut {
    scalp: Arc<Scalp>,
    /// The lines, by triangle.
    pieces: Vec<SurfaceSegment>,
    /// Index of each vertex's section, or [`NONE`].
    labels: Vec<u32>,
}

impl MeshCut {
    /// Cuts a mesh. Also returns the sections, without names, how many pieces are too small to be one, and what there
    /// is to report.
    pub(super) fn new(
        scalp: &Scalp,
        partings: &[Parting],
    ) -> (Self, Vec<Section>, usize, Option<String>) {
        let (surface, net) = (scalp.surface(), scalp.net());
        let lines: Vec<SurfaceLine> =
            partings.iter().map(|line| net.line(&line.points, false)).collect();
        let crossed: BTreeSet<(u32, u32)> =
            lines.iter().flat_map(|line| line.crossed.iter().copied()).collect();
        let mut joined = UnionFind::new(surface.points.len());
        for (t, corners) in (0u32..).zip(&surface.triangles) {
            for side in (0..3).map(|k| edge(corners, k)) {
                if !surface.is_gone(t) && !crossed.contains(&side) {
                    joined.join(side);
                }
            }
        }
        // Pieces without any line, such as an eye, belong to the nearest section.
        let touched = net.touched(lines.iter().flat_map(|line| &line.pieces));
        let beside: Vec<u32> =
            (0..surface.points.len() as u32).filter(|v| touched.contains(&net.piece(*v))).collect();
        let near = KdTree::new(beside.iter().map(|v| surface.points[*v as usize]));
        let mut known: BTreeMap<u32, u32> = BTreeMap::new();
        let mut found = vec![];
        let mut label = |v: u32| {
            let piece = net.piece(v);
            if touched.contains(&piece) {
                return joined.root(v);
            }
            *known.entry(piece).or_insert_with(|| {
                near.find(surface.points[v as usize], 1, &mut found);
                found.first().map_or(0, |(_, i)| joined.root(beside[*i as usize]))
            })
        };
        let labels = (0..surface.points.len() as u32).map(&mut label).collect();
        let of = |(number, line): (usize, &SurfaceLine)| {
            line.pieces.iter().map(move |piece| (number, *piece)).collect::<Vec<_>>()
        };
        let mut pieces: Vec<(usize, SurfaceSegment)> =
            lines.iter().enumerate().flat_map(of).collect();
        pieces.sort_by_key(|(_, piece)| piece.triangle);
        let owners: Vec<usize> = pieces.iter().map(|(number, _)| *number).collect();
        let pieces = pieces.into_iter().map(|(_, piece)| piece).collect();
        let mut cut = Self { scalp: Arc::new(scalp.unparted()), pieces, labels };

        // Area and centre of each.
        let mut found: BTreeMap<u32, (f64, DVec3)> = BTreeMap::new();
        for (t, corners) in (0u32..).zip(&surface.triangles) {
            if surface.is_gone(t) {
                continue;
            }
            let whole = 0.5 * f64::from(surface.area_vector(t).length());
            let n = if in_triangle(&cut.pieces, t).is_empty() { 1 } else { SHARES };
            for_middles(n, |bary| {
                let label = cut.at(t, bary).unwrap_or(cut.labels[corners[0] as usize]);
                let area = whole * f64::from(scalp.grows(t, bary)) / f64::from(n * n);
                let entry = found.entry(label).or_default();
                *entry = (entry.0 + area, entry.1 + surface.at(t, bary).as_dvec3() * area);
            });
        }
        let all: f64 = found.values().map(|(area, _)| area).sum();
        let is_section = |area: f64| area > 0.0 && area >= LEAST * all;
        let slivers = found.values().filter(|(area, _)| *area > 0.0 && !is_section(*area)).count();
        // The largest first.
        let mut order: Vec<(u32, f64, Vec3)> = found
            .into_iter()
            .filter(|(_, (area, _))| is_section(*area))
            .map(|(label, (area, sum))| (label, area, (sum / area).as_vec3()))
            .collect();
        order.sort_by(|a, b| b.1.total_cmp(&a.1).then(a.0.cmp(&b.0)));
        let numbers: BTreeMap<u32, u32> =
            order.iter().map(|(label, ..)| *label).zip(0u32..).collect();
        for label in &mut cut.labels {
            *label = numbers.get(label).copied().unwrap_or(NONE);
        }

        // Lines beside each section, with side and length.
        let mut beside: BTreeMap<(u32, u64, bool), (f32, f32)> = BTreeMap::new();
        for (piece, owner) in cut.pieces.iter().zip(&owners) {
            let [a, b] = piece.bary;
            let length = piece.ends[0].distance(piece.ends[1]);
            let corners = surface.triangles[piece.triangle as usize];
            for (v, corner) in corners.iter().zip([Vec2::ZERO, Vec2::X, Vec2::Y]) {
                let label = cut.labels[*v as usize];
                if label != NONE {
                    let side = (b - a).perp_dot(corner - a) >= 0.0;
                    let entry = beside.entry((label, partings[*owner].id, side)).or_default();
                    *entry = (entry.0 + length, 0.0);
                }
            }
        }
        let ids = ids(order.len(), beside, 0.0);
        let mut nearest: Vec<(f32, Vec3)> = vec![(f32::MAX, Vec3::ZERO); order.len()];
        let mut at_edge = vec![false; order.len()];
        for (v, label) in (0u32..).zip(&cut.labels).filter(|(_, label)| **label != NONE) {
            let (p, slot) = (surface.points[v as usize], *label as usize);
            let far = p.distance_squared(order[slot].2);
            at_edge[slot] |= scalp.region()[v as usize] == 0.0;
            if far < nearest[slot].0 && scalp.region()[v as usize] > 0.0 {
                nearest[slot] = (far, p);
            }
        }
        let section = |(slot, (_, area, middle)): (usize, &(u32, f64, Vec3))| Section {
            id: ids[slot],
            name: String::new(),
            area: *area as f32,
            middle: if nearest[slot].0 < f32::MAX { nearest[slot].1 } else { *middle },
            at_hairline: at_edge[slot],
        };
        let list = order.iter().enumerate().map(section).collect();
        let gaps: usize = lines.iter().map(|line| line.gaps.len()).sum();
        let said = (gaps > 0).then(|| {
            let pieces = if gaps == 1 { "1 piece" } else { &format!("{gaps} pieces") };
            format!("{pieces} of partings lead over where the mesh does not hang together, and cut nothing there")
        });
        (cut, list, slivers, said)
    }

    /// Index of the section at a point of a triangle.
    pub(super) fn at(&self, triangle: u32, bary: Vec2) -> Option<u32> {
        let corners = self.surface().triangles.get(triangle as usize)?;
        let (pieces, to) = (in_triangle(&self.pieces, triangle), within(bary, 1e-5));
        let reached = |corner: Vec2| {
            pieces.iter().all(|piece| !cross(corner, to, piece.bary[0], piece.bary[1]))
        };
        let mut all = corners.iter().zip([Vec2::ZERO, Vec2::X, Vec2::Y]);
        let (v, _) = all.find(|(_, corner)| reached(*corner))?;
        Some(self.labels[*v as usize]).filter(|label| *label != NONE)
    }

    /// Index of the section under a point.
    pub(super) fn under(&self, p: Vec3) -> Option<u32> {
        let hit = self.surface().closest(p)?;
        self.at(hit.triangle, hit.bary)
    }

    fn surface(&self) -> &Surface {
        self.scalp.surface()
    }

    /// Bytes held.
    pub(super) fn bytes(&self) -> usize {
        self.pieces.len() * size_of::<SurfaceSegment>() + 4 * self.labels.len()
    }
}
