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

mod handle;
mod naming;

use super::chart::cell_of;
use super::cut::{Cut, cut};
pub(crate) use super::lines::off_the_scalp;
use super::mesh_cut::MeshCut;
use super::scalp::{Root, Scalp};
use crate::maths::drawn_span::bent;
use crate::maths::hash::{Key, KeyBuilder};
use glam::{Vec2, Vec3};
pub use handle::Sections;
pub(super) use naming::{CONTACT, ids};
pub use naming::{Names, named_points};

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

/// No section; no segment.
pub const NONE: u32 = u32::MAX;
/// Skin this much farther out or in than the skin on the map is another layer, such as an ear, and in no section, head
/// units.
const LAYER: f32 = 1.0;
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
        let (mut mesh, mut said) = (None, vec![]);
        let cut = if scalp.is_on_map() {
            cut(scalp, partings)
        } else {
            let (parted, list, slivers, gaps) = MeshCut::new(scalp, &partings);
            said.extend(gaps);
            let (parted, _) = mesh.insert((parted, list));
            Cut::told(scalp, partings, slivers, |p| parted.under(p))
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
        let sections = Self::cut(scalp, key.finish(), cut, mesh);
        let (list, names) = sections.told(scalp, names, &mut said);
        (sections.called(list, names), said)
    }

    /// Hash of the cuts.
    pub fn key(&self) -> Key {
        self.all().key
    }
    /// All sections, in the order of their indices.
    pub fn list(&self) -> &[Section] {
        &self.all().list
    }
    /// The lines.
    pub fn partings(&self) -> &[Parting] {
        &self.all().partings
    }
    /// What each name refers to.
    pub fn names(&self) -> &Names {
        &self.all().names
    }
    /// Index of the section of each cell of the map, or [`NONE`].
    pub fn labels(&self) -> &[u32] {
        &self.all().labels
    }
    /// Index of the section of a cell of the map, or [`NONE`].
    pub(super) fn label(&self, cell: usize) -> u32 {
        self.seen().cell(cell).label()
    }
    /// Id of the section that a point of the scalp lies in.
    pub fn id_at(&self, point: Vec3) -> Option<u64> {
        Some(self.id(self.of_point(point)?))
    }
    /// Id of the section that a root lies in.
    pub fn id_of(&self, root: &Root) -> Option<u64> {
        Some(self.id(self.of(root)?))
    }
    /// Index of the section under a point.
    pub(super) fn of_point(&self, point: Vec3) -> Option<u32> {
        match self.mesh() {
            Some(mesh) => mesh.under(point),
            None => self.section_under(point),
        }
    }
    /// Index of the section under a root.
    pub fn of(&self, root: &Root) -> Option<u32> {
        self.of_over(root.point, (root.triangle, root.bary))
    }
    fn of_over(&self, point: Vec3, (triangle, bary): (u32, Vec2)) -> Option<u32> {
        match self.mesh() {
            Some(mesh) => mesh.at(triangle, bary),
            None => self.section_under(point),
        }
    }
    fn section_under(&self, point: Vec3) -> Option<u32> {
        self.seen().label_at(self.spread().flat(point))
    }
    /// Straight distance (cm) from a root to the nearest parting.
    pub fn distance(&self, root: &Root) -> f32 {
        self.distance_to(root.point).unwrap_or(FAR)
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
    pub(crate) fn at_over(&self, point: Vec3, on_scalp: (u32, Vec2)) -> Option<Place> {
        self.place(self.of_over(point, on_scalp)?, point)
    }

    fn place(&self, section: u32, point: Vec3) -> Option<Place> {
        let (spread, q) = (self.spread(), self.spread().flat(point));
        if !self.are_of_a_mesh() {
            let off = (spread.out(point) - self.out(cell_of(q)?)).abs();
            if off > LAYER * spread.unit() {
                return None;
            }
        }
        let (distance, i) = self.nearest_at(q, point).unwrap_or((FAR, NONE));
        let bare = self.seen().half_width(i);
        Some(Place { section, distance, bare, free: distance >= bare })
    }

    /// The segment whose bare skin is nearest, and the distance to the segment (not to its bare skin), cm.
    fn nearest_at(&self, q: Vec2, p: Vec3) -> Option<(f32, u32)> {
        let own = cell_of(q);
        if own.is_none() && !self.are_of_a_mesh() {
            return None;
        }
        self.seen().nearest_at(own, p)
    }
    /// Whether the segment between two points in space crosses a parting, or comes as near to it as the fraction
    /// `aside` of half its width, at most a quarter of a head unit off it.
    pub(crate) fn passed(&self, from: Vec3, to: Vec3, aside: f32) -> bool {
        self.seen().last_passed(2, |k| [from, to][k], aside).is_some()
    }
    /// The last point of a hair up to which it crosses a parting, at most a quarter of a head unit off it.
    pub(crate) fn last_passed(&self, n: usize, hair: impl Fn(usize) -> Vec3) -> Option<usize> {
        self.seen().last_passed(n, hair, 0.0)
    }
    /// Largest distance from a parting at which a segment counts as crossing it, cm.
    pub(crate) fn over_lines(&self) -> f32 {
        self.seen().half_place()
    }
    /// Whether a hair, as it is drawn through its points, crosses a parting, at most a quarter of a head unit off it.
    pub(crate) fn is_over_line(&self, hair: &[Vec3]) -> bool {
        self.is_over_line_before(hair, hair.len())
    }
    /// Whether its first `n` points do.
    pub(crate) fn is_over_line_before(&self, hair: &[Vec3], n: usize) -> bool {
        let drawn = bent(hair, n);
        self.last_passed(drawn.len(), |k| drawn[k]).is_some()
    }
    /// The segment of a parting whose bare skin is nearest to a point of the scalp, and half its width.
    pub(super) fn nearest_piece(&self, p: Vec3) -> Option<([Vec3; 2], f32)> {
        let (_, i) = self.nearest_at(self.spread().flat(p), p)?;
        let piece = self.seen().piece(i)?;
        Some((piece.ends, piece.half_width))
    }
    /// Straight distance (cm) from a point of the scalp, inside a section or not, to the nearest parting.
    pub(super) fn distance_to(&self, p: Vec3) -> Option<f32> {
        Some(self.nearest_at(self.spread().flat(p), p)?.0)
    }
    /// Distance of the centre of a cell of the map from the nearest parting, cm.
    pub(super) fn clear(&self, cell: usize) -> f32 {
        self.seen().cell(cell).clear()
    }

    /// Whether the segment between two points of the scalp crosses a parting.
    pub fn crosses(&self, from: Vec3, to: Vec3) -> bool {
        match self.are_of_a_mesh() {
            true => self.passed(from, to, 0.0),
            false => self.seen().crosses(self.spread().flat(from), self.spread().flat(to)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::scalp::tests::shared_ball;
    use crate::maths::hash::Dice;
    use crate::maths::transcendental::sin_cos_turns;
    use std::collections::{BTreeMap, BTreeSet};

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
        let scalp = shared_ball().parted(first);
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
