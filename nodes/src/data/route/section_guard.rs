//! Home: the section that a hair is rooted in, and how its way over the skin is kept there.
//!
//! A hair goes straight where its section lets it, and round corners by the shortest way through the cells of the map, pulled
//! tight. What still comes too near to a parting is moved off it.
//!
//! Guarantees: a kept point lies in its section, or on forehead or neck farther than `BEYOND` from any parting, half of a
//! parting's bare skin or more off every line; points farther off than a parting's bare skin stay where they are; a line beside
//! which hair is kept is approached smoothly, so that hair lies along it and does not pile up. Not promised: anything for hair
//! higher off the skin than [`FREE`], which passes over partings.

use crate::data::chart::{CELL, around, cell_of};
use crate::data::scalp::{Root, Scalp};
use crate::data::sections::{NONE, Place, Sections};
use crate::data::skin::Skin;
use crate::maths::{nearest_on, smoothstep};
use glam::Vec3;
use std::cmp::Reverse;
use std::collections::{BTreeMap, BinaryHeap};

/// Hair this high off the skin passes over partings; what is lower than half of it lies on the skin, head units.
const FREE: f32 = 0.7;
/// Beyond this (head units) a cell's own distance tells that no parting is near a point in it: its diagonal, and a half more.
const NEAR: f32 = 0.24;
/// A piece of hair nearer to a parting than such a share of half its bare skin touches it.
const TOUCHING: f32 = 0.5;
/// Skin without hair so far (head units) from any parting is no other section's.
const BEYOND: f32 = 1.0;
/// Hair over a fold that comes nearer to a parting than such a share of half its bare skin counts as on its other side.
const BESIDE: f32 = 0.3;
/// Rounds in which a point is moved off one line after the other: a corner has two.
const ROUNDS: usize = 6;

/// Points of a way round corners, and rounds in which it is pulled tight.
const ON_WAY: usize = 17;
const PULLS: usize = 24;

/// The ways through a section to one of its points.
pub(crate) struct Ways<'a> {
    home: Home<'a>,
    to: Vec3,
    /// The next cell on the way from each.
    next: BTreeMap<u32, u32>,
}

/// The section that a hair is rooted in.
#[derive(Clone, Copy)]
pub(crate) struct Home<'a> {
    scalp: &'a Scalp,
    sections: &'a Sections,
    number: u32,
}

impl Scalp {
    /// The section under a root; none where the scalp is not parted, or not there, or where no map shows it.
    pub(crate) fn home(&self, root: Vec3) -> Option<Home<'_>> {
        let sections = self.sections().filter(|all| !all.are_of_a_mesh())?;
        let number = sections.at(root)?.section;
        Some(Home { scalp: self, sections, number })
    }

    /// The section that a root counts to, also where it lies beyond the edge of the map.
    pub(crate) fn home_of(&self, root: &Root) -> Option<Home<'_>> {
        let sections = self.sections().filter(|all| !all.are_of_a_mesh())?;
        let number = sections.of(root)?;
        Some(Home { scalp: self, sections, number })
    }
}

impl Home<'_> {
    /// So many head units in cm.
    fn cm(&self, units: f32) -> f32 {
        units * self.scalp.frame().unit()
    }

    /// How far within the section a point of the scalp is, cm: the distance from the nearest parting, negative in other sections.
    fn within(&self, p: Vec3) -> f32 {
        match self.sections.at(p) {
            Some(place) if place.section == self.number => place.distance,
            Some(place) => -place.distance,
            None => self.sections.distance_to(p).map_or(0.0, |distance| -distance),
        }
    }

    /// Whether a point lies in the section, or so high that it lies in none.
    pub(crate) fn holds(&self, p: Vec3) -> bool {
        self.is_free(p) || {
            let hit = self.scalp.skin().closest_within(p, self.cm(FREE));
            hit.is_none_or(|hit| self.within(hit.point) >= 0.0)
        }
    }

    /// Height over the skin (cm) from which hair passes over partings freely.
    pub(super) fn free(&self) -> f32 {
        self.cm(FREE)
    }

    /// Height over the skin (cm) from which no segment counts as crossing a parting.
    pub(super) fn over_lines(&self) -> f32 {
        // The skin may be lower between two points of a line.
        self.sections.over_lines() + self.cm(0.05)
    }

    /// Whether the distance of its root from the nearest parting rules out that a hair, as drawn through these points, crosses one. False
    /// means unknown.
    pub(super) fn is_off_lines(&self, hair: &[Vec3]) -> bool {
        let (Some(root), chart) = (hair.first(), self.scalp.chart()) else { return true };
        let Some(cell) = cell_of(chart.flat(*root)) else { return false };
        let clear = self.sections.clear(cell) - chart.spots()[cell].point.distance(*root);
        let reach = clear - self.over_lines() - self.cm(NEAR);
        // The drawn curve reaches at most a third farther from the root than its points; twice is a safe bound.
        reach > 0.0 && hair.iter().all(|p| 4.0 * p.distance_squared(*root) < reach * reach)
    }

    /// Whether the section lies under a point, however far.
    pub(crate) fn is_under(&self, p: Vec3) -> bool {
        self.sections.of_point(p) == Some(self.number)
    }

    /// Whether a hair leads over a parting on the skin.
    pub(crate) fn passes(&self, hair: &[Vec3]) -> bool {
        self.sections.is_over_line(hair)
    }

    /// Whether its first `n` points do.
    pub(crate) fn passes_before(&self, hair: &[Vec3], n: usize) -> bool {
        self.sections.is_over_line_before(hair, n)
    }

    /// Whether a glance tells that a point needs no keeping: most hair hangs far from any skin, where a search takes longest.
    fn is_free(&self, p: Vec3) -> bool {
        self.scalp.skin().stands_off(p, self.cm(FREE)) || self.is_clear_by(0.0, p)
    }

    /// Whether a glance tells that no parting is nearer to a point than `more` (cm) and what hair keeps off it.
    fn is_clear_by(&self, more: f32, p: Vec3) -> bool {
        let chart = self.scalp.chart();
        let Some(cell) = cell_of(chart.flat(p)) else { return true };
        let height = p.distance(chart.origin()) - chart.out(cell);
        // Off the skin what lies below is told by the skin's slope.
        let least = self.sections.widest_half() + self.cm(NEAR) + height.abs() + more;
        let least = match self.sections.label(cell) {
            own if own == self.number => least,
            // Forehead and neck.
            NONE => least.max(self.cm(BEYOND) + height.abs() + more),
            _ => return false,
        };
        self.sections.clear(cell) > least
    }

    /// One step of a hair kept in the section: `p`, or what `then` makes of the point beside it that is, for straight to the side may be
    /// into the head. `near` is a triangle of the head near it, and becomes the nearest.
    pub(crate) fn keep(&self, p: Vec3, near: &mut u32, then: impl FnOnce(Vec3) -> Vec3) -> Vec3 {
        match self.kept(p, near) {
            Some(kept) if kept != p => then(kept),
            _ => p,
        }
    }

    /// [`Self::keep`] of points of a hair, each with its number, from a triangle near the first on; `then` is given the number, where the
    /// point was and where it is kept.
    pub(crate) fn lead<'p>(
        &self,
        points: impl IntoIterator<Item = (usize, &'p mut Vec3)>,
        mut near: u32,
        then: impl Fn(usize, Vec3, Vec3) -> Vec3,
    ) {
        for (k, p) in points {
            let was = *p;
            *p = self.keep(was, &mut near, |kept| then(k, was, kept));
        }
    }

    /// `p`, or where it lies on the skin in another section or on a parting, the point beside it that does not; `near` is a
    /// triangle of the head near it, and becomes the nearest. None where none is found.
    pub(in crate::data) fn kept(&self, p: Vec3, near: &mut u32) -> Option<Vec3> {
        if self.is_free(p) {
            return Some(p);
        }
        let skin = self.scalp.skin();
        let hit = skin.foot(p, near)?;
        let height = skin.height_over(p, &hit);
        // From half of it on, hair rises off the skin.
        let lying = (2.0 * (1.0 - height / self.cm(FREE))).clamp(0.0, 1.0);
        if lying == 0.0 {
            return Some(p);
        }
        let off = self.off_partings(&skin, hit.point, near)? - hit.point;
        Some(p + off * smoothstep(lying))
    }

    /// A point of the scalp moved into the section and off its partings.
    fn off_partings(&self, skin: &Skin, mut at: Vec3, near: &mut u32) -> Option<Vec3> {
        for _ in 0..ROUNDS {
            let within = self.within(at);
            let Some(([a, b], bare)) = self.sections.nearest_piece(at) else { return Some(at) };
            // On forehead and neck there is no section to be brought back to where no parting is near.
            let beyond = within < -self.cm(BEYOND) && self.sections.at(at).is_none();
            if within >= bare || beyond {
                return Some(at);
            }
            let least = 0.5 * bare;
            // As it is at the edge of the bare skin and never less than the least, without a kink.
            let wanted = least + (bare - least) * (bare - least) / (2.0 * bare - least - within);
            let along = b - a;
            let (on_line, _) = nearest_on([a, b], at);
            let hit = skin.closest_from(at, Some(*near))?;
            let normal = skin.smooth_normal(&hit);
            let aside = along.cross(normal).normalize_or_zero();
            let mut away = (at - on_line).reject_from_normalized(normal);
            away = match within.abs() > self.cm(0.02) {
                true => away.normalize_or_zero() * within.signum(),
                // On the line itself the way home is that of its two sides which leads there.
                false => match self.within(on_line + aside * self.cm(0.05)) > 0.0 {
                    true => aside,
                    false => -aside,
                },
            };
            let hit = skin.closest_from(at + away * (wanted - within), Some(*near))?;
            (at, *near) = (hit.point, hit.triangle);
        }
        // Narrower than a parting's bare skin: in the section at least.
        (self.within(at) > 0.0).then_some(at)
    }

    /// Whether a piece of hair on the skin crosses a parting, or comes so near to it that who looks may say so.
    pub(crate) fn crosses(&self, from: Vec3, to: Vec3) -> bool {
        // A long piece may pass over a tongue of another section between two points that are far from it.
        let half = 0.5 * from.distance(to);
        if self.is_clear_by(half, from) && self.is_clear_by(half, to) {
            return false;
        }
        // In a fold of the skin the map tells two sides apart that hair over the fold knows nothing of.
        if self.sections.passed(from, to, BESIDE) {
            return true;
        }
        let skin = self.scalp.skin();
        let below = |p: Vec3| skin.closest_within(p, self.cm(FREE)).map(|hit| hit.point);
        let (Some(a), Some(b)) = (below(from), below(to)) else { return false };
        // On a bent scalp the straight piece does not lie over the straight way between its ends, so that its middle may touch a
        // corner of a line that the way passes.
        let touches =
            |place: Place| place.section != self.number || place.distance < TOUCHING * place.bare;
        let middle = below((from + to) * 0.5).and_then(|p| self.sections.at(p));
        self.sections.crosses(a, b) || middle.is_some_and(touches)
    }

    /// Whether the straight way between two points of the scalp keeps to the section.
    pub(crate) fn is_straight(&self, from: Vec3, to: Vec3) -> bool {
        let chart = self.scalp.chart();
        let (p, q) = (chart.flat(from), chart.flat(to));
        let steps = (p.distance(q) / CELL).ceil().clamp(1.0, 400.0);
        (0..=steps as u32).all(|k| {
            let at = cell_of(p.lerp(q, k as f32 / steps));
            at.is_some_and(|cell| self.sections.label(cell) == self.number)
        })
    }
}

impl<'a> Home<'a> {
    /// The ways to a point of the section.
    pub(crate) fn ways(&self, to: Vec3) -> Ways<'a> {
        let chart = self.scalp.chart();
        let mut far: BTreeMap<u32, f32> = BTreeMap::new();
        let mut next = BTreeMap::new();
        let mut heap = BinaryHeap::new();
        if let Some(cell) = cell_of(chart.flat(to)) {
            heap.push(Reverse((0u32, cell as u32)));
            far.insert(cell as u32, 0.0);
        }
        while let Some(Reverse((bits, cell))) = heap.pop() {
            let d = f32::from_bits(bits);
            if far.get(&cell).is_some_and(|known| d > *known) {
                continue;
            }
            let here = chart.spots()[cell as usize].point;
            for other in around(cell as usize).filter(|o| self.sections.label(*o) == self.number) {
                // Along a parting the way is long.
                let clear = self.sections.clear(other) > self.sections.widest_half();
                let step = here.distance(chart.spots()[other].point);
                let to = d + step * if clear { 1.0 } else { 4.0 };
                if far.get(&(other as u32)).is_none_or(|known| to < *known) {
                    far.insert(other as u32, to);
                    next.insert(other as u32, cell);
                    // Distances are not negative, so their bits are in their order.
                    heap.push(Reverse((to.to_bits(), other as u32)));
                }
            }
        }
        Ways { home: *self, to, next }
    }
}

impl Ways<'_> {
    /// The way from a point of the scalp, at even parts of it; none where none leads from there.
    pub(crate) fn from(&self, from: Vec3) -> Option<Vec<Vec3>> {
        let chart = self.home.scalp.chart();
        let own = cell_of(chart.flat(from))?;
        let known = |cell: &usize| self.next.contains_key(&(*cell as u32));
        let mut cell = std::iter::once(own).chain(around(own)).find(known)? as u32;
        let mut line = vec![from];
        while let Some(on) = self.next.get(&cell).filter(|_| line.len() < 4096) {
            line.push(chart.spots()[cell as usize].point);
            cell = *on;
        }
        line.push(self.to);
        let mut way = crate::maths::polyline::Polyline::new(line).evenly(ON_WAY);
        let mut near = self.home.scalp.closest_root(from)?.triangle;
        for _ in 0..PULLS {
            for k in 1..ON_WAY - 1 {
                let between = (way[k - 1] + way[k + 1]) * 0.5;
                let hit = self.home.scalp.skin().closest_from(between, Some(near))?;
                near = hit.triangle;
                way[k] = self.home.kept(hit.point, &mut near).unwrap_or(way[k]);
            }
        }
        Some(way)
    }
}
