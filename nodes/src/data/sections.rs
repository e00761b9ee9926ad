//! Sections: what partings cut the scalp into, and which of them a root lies in.
//!
//! methods.md 3, "partings first". On the flat map of the scalp ([`super::chart`]), cells of a fine grid are joined if
//! the segment between their centres crosses no parting; each connected set is a section. A point belongs to the
//! section of a cell centre that it reaches without crossing a parting, so that borders are as sharp as the lines
//! although the grid is not.
//!
//! Guarantees: two points on the two sides of a cutting line belong to the sections on their own sides, however close
//! they are; distances to partings are straight and exact to the lines' segments; ids derive from the lines that bound
//! a section and from their sides, so that moving a line, or cutting elsewhere, keeps them; a name refers to the same
//! skin however often it is cut again ([`Names`]). Not promised: a section narrower than a cell (1.1 mm), which is bare
//! skin.

use super::chart::{ChartProjection, around, cell_of, cross, middle};
pub(crate) use super::cut::off_the_scalp;
use super::cut::{Cut, Lines, cut, square_to};
use super::mesh_cut::MeshCut;
use super::read_set::{Digests, read_all, read_cell};
use super::scalp::{Root, Scalp};
use crate::maths::hash::{Key, KeyBuilder, curve_id};
use glam::{Vec2, Vec3};
use std::collections::{BTreeMap, BTreeSet};
use std::sync::OnceLock;

/// A parting line on the scalp.
#[derive(Clone, Debug)]
pub struct Parting {
    /// Stable id, never 0.
    pub id: u64,
    /// Points on the scalp, at most a few millimetres apart.
    pub points: Vec<Vec3>,
    /// Half the width of its bare skin, cm: no hair is rooted closer to it.
    pub half_width: f32,
    /// Whether a pattern drew it: where it divides nothing, or only slivers, it is dropped.
    pub of_pattern: bool,
}

/// A piece of scalp between partings.
#[derive(Clone, Debug)]
pub struct Section {
    /// Stable id, never 0.
    pub id: u64,
    /// Name for people: the given one, or one made from the section it was cut from, or from its position. Unique.
    pub name: String,
    /// Area of skin on which hair grows, cm2.
    pub area: f32,
    /// A point of the scalp at its centre.
    pub middle: Vec3,
    /// Whether it reaches the hairline.
    pub at_hairline: bool,
}

/// Position of a point of the scalp relative to the partings.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place {
    /// Index of the section.
    pub section: u32,
    /// Straight distance to the parting whose bare skin is nearest, cm; a large number if there is none.
    pub distance: f32,
    /// Half the width of that parting, cm.
    pub bare: f32,
    /// Whether hair may be rooted there: off the bare skin of partings.
    pub free: bool,
}

/// The sections of one scalp.
pub struct Sections {
    key: Key,
    whole: Key,
    spread: ChartProjection,
    /// Half the width of the widest parting, cm.
    widest: f32,
    list: Vec<Section>,
    partings: Vec<Parting>,
    names: Names,
    /// Sections cut along the mesh, if the map does not show the region.
    mesh: Option<MeshCut>,
    lines: Lines,
    /// Distance of the skin from the centre in each cell, cm.
    out: Vec<f32>,
    /// Index of each cell's section, or [`NONE`].
    labels: Vec<u32>,
    digests: OnceLock<Digests>,
}

/// No section; no segment.
pub const NONE: u32 = u32::MAX;
/// Skin this much farther out or in than the skin on the map is another layer, such as an ear, and in no section, cm.
const LAYER: f32 = 1.0;
/// A line bounds a section if it runs beside it for at least this long, cm; less is a corner.
const CONTACT: f32 = 0.3;
/// Distance reported where there are no partings, cm.
pub(super) const FAR: f32 = 1e4;

impl Sections {
    /// Cuts a scalp. `names` are given names, each with a point in what it names; names of existing sections stay. Also
    /// returns what there is to report.
    pub fn new(
        scalp: &Scalp,
        partings: Vec<Parting>,
        names: &[(String, Vec3)],
    ) -> (Self, Vec<String>) {
        let mut key = KeyBuilder::new("sections");
        for parting in &partings {
            key = key
                .int(parting.id)
                .int(u64::from(parting.of_pattern))
                .float(parting.half_width)
                .column(bytemuck::cast_slice::<_, f32>(&parting.points));
        }
        for (name, anchor) in names {
            key = key.text(name).vec3(*anchor);
        }
        if let Some(before) = scalp.sections() {
            key = key.key(before.key());
        }
        let spread = scalp.chart().spread();
        let (mut mesh, mut list, mut said) = (None, vec![], vec![]);
        let cut = if scalp.is_on_map() {
            cut(scalp, partings)
        } else {
            let (parted, sections, slivers, gaps) = MeshCut::new(scalp, &partings);
            list = sections;
            said.extend(gaps);
            let parted = mesh.insert(parted);
            Cut::told(scalp, partings, slivers, |p| parted.under(p))
        };
        let mut sections = Self {
            key: key.finish(),
            whole: scalp.key(),
            spread,
            widest: cut.partings.iter().fold(0.0, |widest, line| line.half_width.max(widest)),
            list,
            partings: cut.partings,
            names: Names::default(),
            mesh,
            lines: cut.lines,
            out: scalp.chart().spots().iter().map(|spot| spread.out(spot.point)).collect(),
            labels: cut.labels,
            digests: OnceLock::new(),
        };
        if cut.slivers > 0 {
            let n = cut.slivers;
            said.push(match n {
                1 => "1 sliver of skin between partings is too small for a section and stays bare"
                    .to_owned(),
                _ => format!(
                    "{n} slivers of skin between partings are too small for sections and stay bare"
                ),
            });
        }
        if sections.mesh.is_none() {
            sections.describe(scalp);
        }
        sections.call(scalp, names, &mut said);
        (sections, said)
    }

    /// Hash of the cuts.
    pub fn key(&self) -> Key {
        read_all();
        self.key
    }
    /// Key of the scalp before it was parted.
    pub fn whole(&self) -> Key {
        self.whole
    }
    /// All sections, in the order of their indices.
    pub fn list(&self) -> &[Section] {
        read_all();
        &self.list
    }
    /// The lines.
    pub fn partings(&self) -> &[Parting] {
        read_all();
        &self.partings
    }
    /// What each name refers to.
    pub fn names(&self) -> &Names {
        read_all();
        &self.names
    }
    /// Half the width of the widest parting, cm.
    pub fn widest_half(&self) -> f32 {
        self.widest
    }
    /// Index of the section of each cell of the map, or [`NONE`].
    pub fn labels(&self) -> &[u32] {
        read_all();
        &self.labels
    }
    /// Index of the section of a cell of the map, or [`NONE`].
    pub(super) fn label(&self, cell: usize) -> u32 {
        read_cell(cell);
        self.labels[cell]
    }
    /// Digests by place, computed on first use.
    pub(super) fn digests(&self) -> &Digests {
        self.digests.get_or_init(|| {
            let id = |label| self.list.get(label as usize).map_or(0, |section| section.id);
            self.lines.digests(&self.labels, id, self.widest)
        })
    }
    /// Id of the section that a point of the scalp lies in.
    pub fn id_at(&self, point: Vec3) -> Option<u64> {
        let section = self.of_point(point)?;
        Some(self.list[section as usize].id)
    }
    /// Id of the section that a root lies in.
    pub fn id_of(&self, root: &Root) -> Option<u64> {
        let section = self.of(root)?;
        Some(self.list[section as usize].id)
    }
    /// Index of the section under a point.
    pub(super) fn of_point(&self, point: Vec3) -> Option<u32> {
        match &self.mesh {
            Some(mesh) => {
                read_all();
                mesh.under(point)
            }
            None => self.section_at(self.spread.flat(point)),
        }
    }
    /// Index of the section under a root.
    pub fn of(&self, root: &Root) -> Option<u32> {
        match &self.mesh {
            Some(mesh) => {
                read_all();
                mesh.at(root.triangle, root.bary)
            }
            None => self.section_at(self.spread.flat(root.point)),
        }
    }
    /// Whether the sections were cut along a mesh that the map does not show: hair is not led within them.
    pub fn are_of_a_mesh(&self) -> bool {
        self.mesh.is_some()
    }
    /// Straight distance (cm) from a root to the nearest parting.
    pub fn distance(&self, root: &Root) -> f32 {
        self.distance_at(self.spread.flat(root.point), root.point)
    }
    /// Section and distance of a point of the scalp; `None` where there is no section.
    pub fn at(&self, point: Vec3) -> Option<Place> {
        self.place(self.of_point(point)?, point)
    }
    /// The same of a root, without a search for the triangle that it lies in.
    pub fn at_root(&self, root: &Root) -> Option<Place> {
        self.at_over(root.point, (root.triangle, root.bary))
    }
    /// The same of a point whose closest point of the scalp is known, as a triangle and weights.
    pub(crate) fn at_over(&self, point: Vec3, (triangle, bary): (u32, Vec2)) -> Option<Place> {
        let section = match &self.mesh {
            Some(mesh) => {
                read_all();
                mesh.at(triangle, bary)
            }
            None => self.section_at(self.spread.flat(point)),
        };
        self.place(section?, point)
    }

    fn place(&self, section: u32, point: Vec3) -> Option<Place> {
        let q = self.spread.flat(point);
        if self.mesh.is_none() && (self.spread.out(point) - self.out[cell_of(q)?]).abs() > LAYER {
            return None;
        }
        let (distance, i) = self.nearest_at(q, point).unwrap_or((FAR, NONE));
        let bare = self.lines.half_width(i);
        Some(Place { section, distance, bare, free: distance >= bare })
    }

    fn section_at(&self, q: Vec2) -> Option<u32> {
        self.lines.label_at(&self.labels, q)
    }

    fn distance_at(&self, q: Vec2, p: Vec3) -> f32 {
        self.nearest_at(q, p).map_or(FAR, |(distance, _)| distance)
    }

    /// The segment whose bare skin is nearest, and the distance to the segment (not to its bare skin), cm.
    fn nearest_at(&self, q: Vec2, p: Vec3) -> Option<(f32, u32)> {
        let own = cell_of(q);
        if own.is_none() && self.mesh.is_none() {
            return None;
        }
        let mut best = (FAR, NONE, FAR);
        let mut see = |i: u32| {
            if let Some(piece) = self.lines.pieces.get(i as usize) {
                let distance = square_to(piece.ends, p).sqrt();
                let clear = distance - piece.half_width;
                if clear < best.0 {
                    best = (clear, i, distance);
                }
            }
        };
        // This list has all segments within a cell's width; the cells' own lists have those beyond.
        self.lines.near_place(p).iter().for_each(|i| see(*i));
        if let Some(own) = own {
            self.lines.near_cell(own).iter().for_each(|i| see(*i));
            see(self.lines.nearest[own]);
            around(own).for_each(|cell| see(self.lines.nearest[cell]));
        }
        (best.1 != NONE).then_some((best.2, best.1))
    }
    /// Whether the segment between two points in space crosses a parting, or comes as near to it as the fraction
    /// `aside` of half its width, at most a quarter of a centimetre off it.
    pub(crate) fn passed(&self, from: Vec3, to: Vec3, aside: f32) -> bool {
        self.lines.last_passed(2, |k| [from, to][k], aside).is_some()
    }
    /// The last point of a hair up to which it crosses a parting, at most a quarter of a centimetre off it.
    pub(crate) fn last_passed(&self, n: usize, hair: impl Fn(usize) -> Vec3) -> Option<usize> {
        self.lines.last_passed(n, hair, 0.0)
    }
    /// Whether a hair crosses a parting, at most a quarter of a centimetre off it.
    pub(crate) fn is_over_line(&self, hair: &[Vec3]) -> bool {
        self.last_passed(hair.len(), |k| hair[k]).is_some()
    }
    /// The segment of a parting whose bare skin is nearest to a point of the scalp, and half its width.
    pub(super) fn nearest_piece(&self, p: Vec3) -> Option<([Vec3; 2], f32)> {
        let (_, i) = self.nearest_at(self.spread.flat(p), p)?;
        let piece = &self.lines.pieces[i as usize];
        Some((piece.ends, piece.half_width))
    }
    /// Straight distance (cm) from a point of the scalp, inside a section or not, to the nearest parting.
    pub(super) fn distance_to(&self, p: Vec3) -> Option<f32> {
        Some(self.nearest_at(self.spread.flat(p), p)?.0)
    }
    /// Distance of the centre of a cell of the map from the nearest parting, cm.
    pub(super) fn clear(&self, cell: usize) -> f32 {
        read_cell(cell);
        self.lines.clear[cell]
    }

    /// Whether the segment between two points of the scalp crosses a parting.
    pub fn crosses(&self, from: Vec3, to: Vec3) -> bool {
        if self.mesh.is_some() {
            return self.passed(from, to, 0.0);
        }
        let (p, q) = (self.spread.flat(from), self.spread.flat(to));
        let steps = ((q - p).length() / super::chart::CELL).ceil().clamp(1.0, 1e4) as usize;
        let crossed = |i: &u32| {
            let [a, b] = self.lines.pieces[*i as usize].flat;
            cross(p, q, a, b)
        };
        let mut cells = (0..=steps).filter_map(|k| cell_of(p.lerp(q, k as f32 / steps as f32)));
        cells.any(|cell| self.lines.near_cell(cell).iter().any(crossed))
    }

    /// Areas, centres and ids.
    fn describe(&mut self, scalp: &Scalp) {
        let spots = scalp.chart().spots();
        let count = self.labels.iter().filter(|l| **l != NONE).max().map_or(0, |l| *l as usize + 1);
        let mut area = vec![0.0f64; count];
        let mut sum = vec![glam::DVec3::ZERO; count];
        let mut hairline = vec![false; count];
        // Length and mean fraction over which each line runs beside a section, by side.
        let mut beside: BTreeMap<(u32, u64, bool), (f32, f32)> = BTreeMap::new();
        for (cell, label) in self.labels.iter().enumerate().filter(|(_, l)| **l != NONE) {
            let (slot, spot) = (*label as usize, &spots[cell]);
            let weight = f64::from(spot.area * spot.grows);
            area[slot] += weight;
            sum[slot] += spot.point.as_dvec3() * weight;
            for other in around(cell).take(4) {
                hairline[slot] |= spots[other].grows == 0.0;
                if self.labels[other] == *label {
                    continue;
                }
                let (p, q) = (middle(cell), middle(other));
                let step = spot.point.distance(spots[other].point);
                for i in self.lines.near_cell(cell) {
                    let piece = &self.lines.pieces[*i as usize];
                    let [a, b] = piece.flat;
                    if cross(p, q, a, b) {
                        let side = (b - a).perp_dot(p - a) >= 0.0;
                        let line = self.partings[piece.parting as usize].id;
                        let entry = beside.entry((*label, line, side)).or_default();
                        *entry = (entry.0 + step, entry.1 + step * piece.along);
                    }
                }
            }
        }
        let ids = ids(count, beside, CONTACT);
        let middles = self.middles(scalp, &sum, &area);
        self.list = (0..count)
            .map(|slot| Section {
                id: ids[slot],
                name: String::new(),
                area: area[slot] as f32,
                middle: middles[slot],
                at_hairline: hairline[slot],
            })
            .collect();
    }

    /// The centroid of each section or, if that lies outside (a ring), the point farthest from all partings.
    fn middles(&self, scalp: &Scalp, sum: &[glam::DVec3], area: &[f64]) -> Vec<Vec3> {
        let chart = scalp.chart();
        let mut farthest: Vec<(f32, usize)> = vec![(-1.0, 0); sum.len()];
        for (cell, label) in self.labels.iter().enumerate().filter(|(_, l)| **l != NONE) {
            let spot = &chart.spots()[cell];
            let d = match self.lines.pieces.get(self.lines.nearest[cell] as usize) {
                Some(piece) => square_to(piece.ends, spot.point),
                None => 0.0,
            };
            let best = &mut farthest[*label as usize];
            if d * spot.grows > best.0 {
                *best = (d * spot.grows, cell);
            }
        }
        let one = |slot: usize| {
            let centre = (sum[slot] / area[slot].max(1e-9)).as_vec3();
            let root = chart.root(scalp, chart.flat(centre));
            let inside = root.filter(|root| {
                self.of(root) == Some(slot as u32)
                    && self.distance(root) > 0.25 * farthest[slot].0.max(0.0).sqrt()
            });
            inside.map_or(chart.spots()[farthest[slot].1].point, |root| root.point)
        };
        (0..sum.len()).map(one).collect()
    }

    /// Names all sections.
    fn call(&mut self, scalp: &Scalp, given: &[(String, Vec3)], said: &mut Vec<String>) {
        let before = scalp.sections();
        let origins = match before {
            Some(before) => self.origins(before),
            None => vec![NONE; self.list.len()],
        };
        let mut names = Names(BTreeMap::new());
        for (name, old) in before.iter().flat_map(|before| &before.names.0) {
            let now = (0..).zip(&origins).filter(|(_, origin)| old.contains(origin));
            names.0.insert(name.clone(), now.map(|(number, _)| number).collect());
        }
        let mut called: Vec<Option<&str>> = vec![None; self.list.len()];
        let mut anew: BTreeMap<&str, BTreeSet<u32>> = BTreeMap::new();
        for (name, anchor) in given {
            let Some(at) = scalp.closest_root(*anchor).and_then(|root| self.of(&root)) else {
                said.push(self.misses(scalp, name, *anchor));
                continue;
            };
            anew.entry(name).or_default().insert(at);
            match called[at as usize] {
                None => called[at as usize] = Some(name),
                Some(first) if first != name => said.push(format!(
                    "{first:?} and {name:?} stand on one section: either name means all of it"
                )),
                Some(_) => {}
            }
        }
        for (name, now) in &anew {
            let now: Vec<u32> = now.iter().copied().collect();
            if let Some(old) = names.0.insert((*name).to_owned(), now.clone())
                && old.iter().any(|number| !now.contains(number))
            {
                said.push(format!(
                    "{name:?} names a section of an earlier cut and another part of it, or another section, here: from here on it \
                     means what it names here"
                ));
            }
        }
        // Sections without a given name are named after the section they were cut from, and after their position.
        let base = |slot: usize| match (called[slot], before) {
            (Some(name), _) => name.to_owned(),
            (None, Some(before)) if origins[slot] != NONE => {
                before.list[origins[slot] as usize].name.clone()
            }
            _ if self.mesh.is_some() => "section".to_owned(),
            _ => whereabouts(scalp, self.list[slot].middle),
        };
        let bases: Vec<String> = (0..self.list.len()).map(base).collect();
        let mut together: BTreeMap<&str, usize> = BTreeMap::new();
        for base in &bases {
            *together.entry(base).or_default() += 1;
        }
        let mut numbers: BTreeMap<&str, usize> = BTreeMap::new();
        for (slot, base) in bases.iter().enumerate() {
            let alone = [u32::try_from(slot).expect("few sections")];
            let mut name = base.clone();
            // A name belongs to one section: if several share it, or if it refers to more than one, they are numbered.
            let is_own =
                |name: &str, names: &Names| names.0.get(name).is_none_or(|all| *all == alone);
            if together[base.as_str()] > 1 || !is_own(base, &names) {
                loop {
                    let number = numbers.entry(base).or_default();
                    *number += 1;
                    name = format!("{base} {number}");
                    if is_own(&name, &names) {
                        break;
                    }
                }
            }
            names.0.insert(name.clone(), alone.to_vec());
            self.list[slot].name = name;
        }
        names.0.retain(|_, sections| !sections.is_empty());
        self.names = names;
    }

    /// For each section, the section of `before` that most of it was cut from, or [`NONE`].
    fn origins(&self, before: &Self) -> Vec<u32> {
        let mut shared: BTreeMap<(u32, u32), usize> = BTreeMap::new();
        for (now, old) in self.labels.iter().zip(&before.labels) {
            if *now != NONE && *old != NONE {
                *shared.entry((*now, *old)).or_default() += 1;
            }
        }
        let mut best = vec![(0, NONE); self.list.len()];
        for ((now, old), cells) in shared {
            let best = &mut best[now as usize];
            if cells > best.0 {
                *best = (cells, old);
            }
        }
        best.into_iter().map(|(_, old)| old).collect()
    }

    /// Message that a name's point lies in no section, and where the nearest section is.
    fn misses(&self, scalp: &Scalp, name: &str, anchor: Vec3) -> String {
        let cells =
            self.labels.iter().zip(scalp.chart().spots()).filter(|(label, _)| **label != NONE);
        let near = cells.map(|(label, spot)| (spot.point.distance(anchor), *label));
        let near = near.min_by(|a, b| a.0.total_cmp(&b.0));
        let near = near.map_or(String::new(), |(distance, label)| {
            format!("; the nearest is {distance:.1} cm away, by {:?}", self.place_of(scalp, label))
        });
        format!("the name {name:?} stands on no section, but on bare skin{near}")
    }

    /// A section's centre in the head frame, as names are typed.
    fn place_of(&self, scalp: &Scalp, number: u32) -> [f32; 3] {
        let p = scalp.given(self.list[number as usize].middle);
        p.to_array().map(|x| (x * 10.0).round() / 10.0)
    }

    /// Bytes held.
    pub fn bytes(&self) -> usize {
        self.lines.bytes()
            + self.mesh.as_ref().map_or(0, MeshCut::bytes)
            + self.partings.iter().map(|p| 12 * p.points.len() + 64).sum::<usize>()
            + 4 * (self.labels.len() + self.out.len())
            + self.list.len() * 128
    }
}

/// Ids of sections, from the length over which each line runs beside them, by side, and its mean fraction along the
/// line. Less than `least` cm is not a border.
pub(super) fn ids(
    count: usize,
    beside: BTreeMap<(u32, u64, bool), (f32, f32)>,
    least: f32,
) -> Vec<u64> {
    let mut bounds: Vec<Vec<(u64, bool, f32)>> = vec![vec![]; count];
    for ((label, line, side), (length, along)) in beside {
        if length >= least {
            bounds[label as usize].push((line, side, along / length));
        }
    }
    let id = |bounds: &[(u64, bool, f32)]| {
        let step = |id, (line, side, _): &(u64, bool, f32)| curve_id(id, *line, u64::from(*side));
        bounds.iter().fold(curve_id(0, SECTION_TAG, 0), step)
    };
    let mut ids: Vec<u64> = bounds.iter().map(|b| id(b)).collect();
    // Sections between the same lines, such as those of two lines that cross twice, are distinguished by position along
    // the first.
    let mut order: Vec<(u64, f32, usize)> = (0..count)
        .map(|slot| (ids[slot], bounds[slot].first().map_or(0.0, |b| b.2), slot))
        .collect();
    order.sort_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)).then(a.2.cmp(&b.2)));
    let mut same = 0;
    for pair in order.windows(2) {
        same = if pair[0].0 == pair[1].0 { same + 1 } else { 0 };
        if same > 0 {
            ids[pair[1].2] = curve_id(pair[1].0, SECTION_TAG, same);
        }
    }
    ids
}

/// Parses names with points in head units, such as `left puff 4 7 -3; fringe 0 6 8`; also returns the entries that are
/// invalid.
pub fn named_points(text: &str) -> (Vec<(String, Vec3)>, Vec<String>) {
    let (mut names, mut faults) = (vec![], vec![]);
    for entry in text.split([';', '\n']).map(str::trim).filter(|e| !e.is_empty()) {
        let words: Vec<&str> = entry.split_whitespace().collect();
        let at = words.len().saturating_sub(3);
        let numbers: Vec<f32> = words[at..].iter().filter_map(|w| w.parse().ok()).collect();
        match numbers[..] {
            [x, y, z] if at > 0 && x.is_finite() && y.is_finite() && z.is_finite() => {
                names.push((words[..at].join(" "), Vec3::new(x, y, z)));
            }
            _ => {
                faults.push(format!("{entry:?} is no name with a point, such as \"fringe 0 6 8\""))
            }
        }
    }
    (names, faults)
}

/// What the names of a scalp's sections refer to: each to the indices of one or more sections. The name of a section
/// that was cut again refers to all its parts.
#[derive(Clone, Debug, Default)]
pub struct Names(BTreeMap<String, Vec<u32>>);

impl Names {
    /// The indices of the sections that a name refers to, ascending.
    pub fn get(&self, name: &str) -> Option<&[u32]> {
        self.0.get(name).map(Vec::as_slice)
    }
    /// Every name with its sections.
    pub fn each(&self) -> impl Iterator<Item = (&str, &[u32])> {
        self.0.iter().map(|(name, numbers)| (name.as_str(), numbers.as_slice()))
    }
}

/// Mixed into the ids of sections.
const SECTION_TAG: u64 = 0x5EC7;

impl std::fmt::Debug for Sections {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "Sections({} by {} partings)", self.list.len(), self.partings.len())
    }
}

/// Position of a point of the scalp, in words.
fn whereabouts(scalp: &Scalp, p: Vec3) -> String {
    let h = scalp.given(p);
    let d = h.try_normalize().unwrap_or(Vec3::Y);
    let area = if d.y < -0.25 && d.z < 0.0 {
        "nape"
    } else if d.y > 0.86 {
        if d.z < -0.12 { "crown" } else { "top" }
    } else if d.z > 0.45 {
        if d.x.abs() > 0.62 { "temple" } else { "front" }
    } else if d.z < -0.5 {
        if d.y > 0.55 { "crown" } else { "back" }
    } else if d.x.abs() > 0.55 {
        if d.z > 0.2 { "temple" } else { "side" }
    } else {
        "top"
    };
    let side = match h.x {
        x if x > 0.4 => "left",
        x if x < -0.4 => "right",
        _ => "middle",
    };
    format!("{area} {side}")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::scalp::tests::shared_ball;
    use crate::maths::hash::Dice;
    use crate::maths::transcendental::sin_cos_turns;

    /// A line over the ball in the plane x = `x` (or z = `x`), from one edge of the scalp to the other.
    fn across(id: u64, x: f32, turned: bool) -> Parting {
        let points = (0..=120).map(|k| {
            let (s, c) = sin_cos_turns(k as f32 / 240.0 - 0.25);
            let r = (8.9f32 * 8.9 - x * x).sqrt();
            let p = Vec3::new(x, c * r, s * r);
            let p = if turned { Vec3::new(p.z, p.y, p.x) } else { p };
            shared_ball().closest_root(p).unwrap().point
        });
        Parting { id, points: points.collect(), of_pattern: false, half_width: 0.08 }
    }
    fn cut(lines: Vec<Parting>, names: &[(String, Vec3)]) -> (Sections, Vec<String>) {
        Sections::new(&shared_ball(), lines, names)
    }
    fn ids(sections: &Sections) -> BTreeSet<u64> {
        sections.list().iter().map(|s| s.id).collect()
    }

    #[test]
    fn a_point_has_the_section_of_its_own_side_however_near_the_line() {
        let lines = vec![across(1, -3.0, false), across(2, 0.2, false), across(3, 4.0, true)];
        let (sections, said) = cut(lines, &[]);
        assert_eq!((sections.list().len(), said.len()), (6, 0), "{said:?}");
        let scalp = shared_ball();
        let dice = Dice::new(1, 0, "points");
        let mut of_side: BTreeMap<(bool, bool, bool), u32> = BTreeMap::new();
        let mut close = 0;
        for id in 0..20_000 {
            let near = [-3.0, 0.2][id as usize % 2] + 0.1 * dice.signed(id, 5);
            let x = if id % 3 == 0 { near } else { 7.0 * dice.signed(id, 0) };
            let d = Vec3::new(x, 1.0 + 5.0 * dice.unit(id, 1), 7.0 * dice.signed(id, 2));
            let p = scalp.closest_root(d.normalize() * 8.9).unwrap().point;
            if p.y < 0.6 {
                continue;
            }
            let place = sections.at(p).unwrap();
            // The lines' points lie on flat triangles: in between, they are a few hundredths of a millimetre off the
            // plane.
            let off = [p.x + 3.0, p.x - 0.2, p.z - 4.0];
            if off.iter().any(|x| x.abs() < 0.01) {
                continue;
            }
            close += u32::from(off.iter().any(|x| x.abs() < 0.05));
            let side = (off[0] > 0.0, off[1] > 0.0, off[2] > 0.0);
            assert_eq!(*of_side.entry(side).or_insert(place.section), place.section, "{p}");
            assert_eq!(place.free, place.distance >= 0.08);
            let least = off.iter().map(|x| x.abs()).fold(f32::MAX, f32::min);
            // Closer than that, the planes of the lines are as far as the lines.
            if least < 0.4 && p.y > 2.0 {
                assert!((place.distance - least).abs() < 0.02 + 0.2 * least, "{place:?} {least}");
            }
        }
        assert!(of_side.len() == 6 && close > 300, "{} {close}", of_side.len());
    }

    #[test]
    fn moving_a_line_or_cutting_elsewhere_keeps_ids() {
        let three =
            |x: f32| vec![across(1, -3.0, false), across(2, x, false), across(3, 3.0, true)];
        let (a, _) = cut(three(0.5), &[]);
        let (b, _) = cut(three(1.4), &[]);
        assert_eq!(ids(&a), ids(&b));
        let mut more = three(0.5);
        more.push(across(9, 5.5, false));
        let (c, _) = cut(more, &[]);
        // The two sections right of line 2 are cut in two each; the other four are unchanged.
        assert_eq!(ids(&a).intersection(&ids(&c)).count(), 4);
        assert_eq!(c.list().len(), 8);
        assert_eq!(ids(&c).len(), 8);
    }

    #[test]
    fn names_stay_and_tell_of_merging_and_splitting() {
        let name = |name: &str, x: f32| (name.to_owned(), Vec3::new(x, 8.0, 0.0));
        let names = [name("left", 4.0), name("right", -4.0)];
        let (two, said) = cut(vec![across(1, 0.3, false)], &names);
        assert!(said.is_empty() && two.names().get("left") != two.names().get("right"), "{said:?}");
        let (one, said) = cut(vec![], &names);
        assert_eq!(one.list()[0].name, "left");
        assert_eq!(
            said,
            ["\"left\" and \"right\" stand on one section: either name means all of it"]
        );
        assert_eq!(one.names().get("right"), Some(&[0][..]));
        // A repeated name is a single part, for masks as for people.
        let (both, said) = cut(vec![across(1, 0.3, false)], &[name("all", 4.0), name("all", -4.0)]);
        assert_eq!(both.names().get("all"), Some(&[0, 1][..]), "{said:?}");
        let called: BTreeSet<&str> = both.list().iter().map(|s| s.name.as_str()).collect();
        assert_eq!((called, said.len()), (BTreeSet::from(["all 1", "all 2"]), 0));
        let (_, said) = cut(vec![], &[("chin".to_owned(), Vec3::new(0.0, -8.9, 0.0))]);
        assert!(said.len() == 1 && said[0].contains("on no section"), "{said:?}");
    }

    #[test]
    fn a_section_that_is_cut_on_stays_the_union_of_its_parts() {
        let name = |name: &str, x: f32, z: f32| (name.to_owned(), Vec3::new(x, 7.0, z));
        let front = across(1, 3.0, true);
        let (first, _) =
            cut(vec![front.clone()], &[name("front", 0.0, 6.0), name("rest", 0.0, -3.0)]);
        let scalp = shared_ball().parted(first.into());
        let more = |names: &[(String, Vec3)]| {
            let lines = vec![front.clone(), across(2, -2.0, false), across(3, 2.0, false)];
            Sections::new(&scalp, lines, names)
        };
        let check = |names: &[(String, Vec3)], means: &[(&str, usize)], called: &[&str]| {
            let (sections, said) = more(names);
            assert!(said.is_empty(), "{said:?}");
            for (name, parts) in means {
                let numbers = sections.names().get(name).unwrap_or_default();
                assert_eq!(numbers.len(), *parts, "{name}");
            }
            let mut now: Vec<&str> = sections.list().iter().map(|s| s.name.as_str()).collect();
            now.sort();
            assert_eq!(now, called);
            // Where hair is within the union and not by whose lines it was cut.
            for p in
                [Vec3::new(-5.0, 5.0, 5.0), Vec3::new(0.0, 8.0, 0.0), Vec3::new(5.0, 6.0, -2.0)]
            {
                let at = sections.at(p).unwrap().section;
                let is = |name| sections.names().get(name).unwrap().contains(&at);
                assert_eq!((is("front"), is("rest")), (p.z > 3.0, p.z < 3.0), "{p}");
            }
        };
        let unnamed = ["front 1", "front 2", "front 3", "rest 1", "rest 2", "rest 3"];
        check(&[], &[("front", 3), ("rest", 3), ("rest 2", 1)], &unnamed);
        let names = [name("left", 5.0, -1.0), name("right", -5.0, -1.0)];
        let called = ["front 1", "front 2", "front 3", "left", "rest 1", "right"];
        check(&names, &[("front", 3), ("rest", 3), ("left", 1)], &called);
    }

    #[test]
    fn hair_over_a_parting_passes_it_and_hair_beside_it_does_not() {
        let line = across(1, 0.0, false);
        let p = line.points[60].midpoint(line.points[61]);
        let (sections, _) = cut(vec![line], &[]);
        let up = p.normalize();
        let check = |height: f32, from: f32, to: f32, passes: bool| {
            let at = |x: f32| p + up * height + Vec3::X * x;
            assert_eq!(sections.passed(at(from), at(to), 0.25), passes, "{height} {from} {to}");
        };
        check(0.1, -0.5, 0.5, true);
        check(0.2, -0.1, 0.3, true);
        check(0.4, -0.5, 0.5, false);
        check(0.1, 0.1, 0.5, false);
        check(0.1, 0.01, 0.5, true);
    }

    #[test]
    fn a_hair_looked_at_by_boxes_passes_where_its_ways_one_by_one_do() {
        let (sections, _) = cut(vec![across(1, -3.0, false), across(3, 4.0, true)], &[]);
        let dice = Dice::new(2, 0, "hairs");
        let mut over = 0;
        for id in 0..4000 {
            // From short steps to such as no box is looked at for.
            let step = 0.02 * (1u32 << (id % 10)) as f32;
            let some = |k: u64| Vec3::from([0, 1, 2].map(|axis| dice.signed(id, 10 * k + axis)));
            let mut hair = vec![some(0).normalize_or(Vec3::Y) * 9.0];
            for k in 1..3 + id % 40 {
                hair.push(hair[k as usize - 1] + some(k) * step);
            }
            let one = |k: &usize| sections.passed(hair[*k - 1], hair[*k], 0.0);
            let last = (1..hair.len()).rev().find(one);
            assert_eq!(sections.last_passed(hair.len(), |k| hair[k]), last, "{id}");
            over += usize::from(last.is_some());
        }
        assert!(over > 100, "{over}");
        // No number, no end, no points.
        for p in [Vec3::NAN, Vec3::INFINITY, Vec3::splat(-1e30), Vec3::splat(3e38)] {
            sections.is_over_line(&[Vec3::Y, p, Vec3::Y, -p]);
        }
        assert!(!sections.is_over_line(&[]) && !sections.is_over_line(&[Vec3::Y]));
    }

    #[test]
    fn a_line_that_ends_in_hair_cuts_nothing() {
        let mut line = across(1, 0.0, false);
        line.points.truncate(60);
        let (sections, _) = cut(vec![line.clone()], &[]);
        assert_eq!(sections.list().len(), 1);
        let p = line.points[40];
        let root = shared_ball().closest_root(p + Vec3::X * 0.05).unwrap();
        assert!(sections.distance(&root) < 0.06);
        assert!(sections.crosses(p + Vec3::X, p - Vec3::X));
        assert!(!sections.crosses(p + Vec3::X, p + Vec3::X * 2.0));
    }
}
