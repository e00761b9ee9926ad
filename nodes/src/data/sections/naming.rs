//! What sections are called: their ids, their places, and the names by which people and masks mean them.
//!
//! Guarantees: those of [`super`] about ids and names. This is asked once, when a scalp is cut.

use super::{NONE, Section, Sections};
use crate::data::chart::around;
use crate::data::lines::square_to;
use crate::data::scalp::Scalp;
use crate::maths::hash::curve_id;
use glam::Vec3;
use std::collections::{BTreeMap, BTreeSet};

/// A line bounds a section if it runs beside it for at least this long, head units; less is a corner.
pub(in crate::data) const CONTACT: f32 = 0.3;

impl Sections {
    /// All sections that were cut, and what names mean; adds what there is to report.
    pub(super) fn told(
        &self,
        scalp: &Scalp,
        given: &[(String, Vec3)],
        said: &mut Vec<String>,
    ) -> (Vec<Section>, Names) {
        let mut list = match self.are_of_a_mesh() {
            true => self.list().to_vec(),
            false => self.described(scalp),
        };
        let names = self.call(scalp, &mut list, given, said);
        (list, names)
    }

    /// Areas, centres and ids.
    fn described(&self, scalp: &Scalp) -> Vec<Section> {
        let spots = scalp.chart().spots();
        let (seen, labels) = (self.seen(), self.labels());
        let count = labels.iter().filter(|l| **l != NONE).max().map_or(0, |l| *l as usize + 1);
        let mut area = vec![0.0f64; count];
        let mut sum = vec![glam::DVec3::ZERO; count];
        let mut hairline = vec![false; count];
        // Length and mean fraction over which each line runs beside a section, by side.
        let mut beside: BTreeMap<(u32, u64, bool), (f32, f32)> = BTreeMap::new();
        for (cell, label) in labels.iter().enumerate().filter(|(_, l)| **l != NONE) {
            let (slot, spot) = (*label as usize, &spots[cell]);
            let weight = f64::from(spot.area * spot.grows);
            area[slot] += weight;
            sum[slot] += spot.point.as_dvec3() * weight;
            for other in around(cell).take(4) {
                hairline[slot] |= spots[other].grows == 0.0;
            }
        }
        for piece in (0..).map_while(|number| seen.piece(number)) {
            let [left, right] = seen.sides(piece);
            if left == right {
                continue;
            }
            let length = piece.ends[0].distance(piece.ends[1]);
            let line = self.partings()[piece.parting as usize].id;
            for (label, side) in [(left, true), (right, false)] {
                if let Some(label) = label {
                    let entry = beside.entry((label, line, side)).or_default();
                    *entry = (entry.0 + length, entry.1 + length * piece.along);
                }
            }
        }
        let ids = ids(count, beside, CONTACT * scalp.chart().unit());
        let middles = self.middles(scalp, &sum, &area);
        (0..count)
            .map(|slot| Section {
                id: ids[slot],
                name: String::new(),
                area: area[slot] as f32,
                middle: middles[slot],
                at_hairline: hairline[slot],
            })
            .collect()
    }

    /// The centroid of each section or, if that lies outside (a ring), the point farthest from all partings.
    fn middles(&self, scalp: &Scalp, sum: &[glam::DVec3], area: &[f64]) -> Vec<Vec3> {
        let chart = scalp.chart();
        let mut farthest: Vec<(f32, usize)> = vec![(-1.0, 0); sum.len()];
        let seen = self.seen();
        for (cell, label) in self.labels().iter().enumerate().filter(|(_, l)| **l != NONE) {
            let spot = &chart.spots()[cell];
            let d = match seen.piece(seen.cell(cell).nearest()) {
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
    fn call(
        &self,
        scalp: &Scalp,
        list: &mut [Section],
        given: &[(String, Vec3)],
        said: &mut Vec<String>,
    ) -> Names {
        let before = scalp.sections();
        let origins = match before {
            Some(before) => self.origins(before, list.len()),
            None => vec![NONE; list.len()],
        };
        let mut names = Names(BTreeMap::new());
        for (name, old) in before.iter().flat_map(|before| &before.names().0) {
            let now = (0..).zip(&origins).filter(|(_, origin)| old.contains(origin));
            names.0.insert(name.clone(), now.map(|(number, _)| number).collect());
        }
        let mut called: Vec<Option<&str>> = vec![None; list.len()];
        let mut anew: BTreeMap<&str, BTreeSet<u32>> = BTreeMap::new();
        for (name, anchor) in given {
            let Some(at) = scalp.closest_root(*anchor).and_then(|root| self.of(&root)) else {
                said.push(self.misses(scalp, list, name, *anchor));
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
                before.list()[origins[slot] as usize].name.clone()
            }
            _ if self.are_of_a_mesh() => "section".to_owned(),
            _ => whereabouts(scalp, list[slot].middle),
        };
        let bases: Vec<String> = (0..list.len()).map(base).collect();
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
            list[slot].name = name;
        }
        names.0.retain(|_, sections| !sections.is_empty());
        names
    }

    /// For each section, the section of `before` that most of it was cut from, or [`NONE`].
    fn origins(&self, before: &Self, count: usize) -> Vec<u32> {
        let mut shared: BTreeMap<(u32, u32), usize> = BTreeMap::new();
        for (now, old) in self.labels().iter().zip(before.labels()) {
            if *now != NONE && *old != NONE {
                *shared.entry((*now, *old)).or_default() += 1;
            }
        }
        let mut best = vec![(0, NONE); count];
        for ((now, old), cells) in shared {
            let best = &mut best[now as usize];
            if cells > best.0 {
                *best = (cells, old);
            }
        }
        best.into_iter().map(|(_, old)| old).collect()
    }

    /// Message that a name's point lies in no section, and where the nearest section is.
    fn misses(&self, scalp: &Scalp, list: &[Section], name: &str, anchor: Vec3) -> String {
        let cells =
            self.labels().iter().zip(scalp.chart().spots()).filter(|(label, _)| **label != NONE);
        let near = cells.map(|(label, spot)| (spot.point.distance(anchor), *label));
        let near = near.min_by(|a, b| a.0.total_cmp(&b.0));
        let near = near.map_or(String::new(), |(distance, label)| {
            // As names are typed.
            let p = scalp.given(list[label as usize].middle);
            let by = p.to_array().map(|x| (x * 10.0).round() / 10.0);
            format!("; the nearest is {distance:.1} cm away, by {by:?}")
        });
        format!("the name {name:?} stands on no section, but on bare skin{near}")
    }
}

/// Ids of sections, from the length over which each line runs beside them, by side, and its mean fraction along the
/// line. Less than `least` cm is not a border.
pub(in crate::data) fn ids(
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
