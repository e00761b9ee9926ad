//! Attributes of hair that is made from curves, or gets other points: the one place that carries them over.
//!
//! Guarantees: hair made from curves has what these have, a user's own attributes too, each by the rule of its declaration
//! ([`CarryRule`]), but for what its maker has set. Hair that only gets other points keeps all that it has. Along a curve, numbers
//! and vectors are interpolated, ids and counts taken from the point before. What is the same for all is stored once, and what no
//! curve has costs nothing. Where several curves of one name have values of several types, the first type counts.

use crate::data::attributes::{
    Attribute, CarryRule, Column, Domain, FIBRE, Item, Name, ROOT_BARY, ROOT_TRIANGLE, ROOT_UV,
    carry_of, default_of,
};
use crate::data::curves::{Tuft, TuftBuilder};
use crate::maths::spline::{Spline, SplineParam};
use glam::{Vec2, Vec3};
use std::collections::{BTreeMap, BTreeSet};

/// Does the same for a column of any type.
macro_rules! for_type {
    ($column:expr, $ty:ident => $does:expr) => {
        match $column {
            Column::F32(_) => {
                type $ty = f32;
                $does
            }
            Column::I32(_) => {
                type $ty = i32;
                $does
            }
            Column::U64(_) => {
                type $ty = u64;
                $does
            }
            Column::Vec2(_) => {
                type $ty = Vec2;
                $does
            }
            Column::Vec3(_) => {
                type $ty = Vec3;
                $does
            }
        }
    };
}

/// A place among points: the point before it, and the fraction of the way to the next.
pub(crate) type CvPlace = (u32, f32);

/// Gives `out` the attributes of `tuft`: its curves are those of the numbers `kept`, and `places` says where among the points of
/// the tuft each of its points lies (needed only where [`Tuft::differs_by_point`]).
pub(crate) fn carry(tuft: &Tuft, kept: &[u32], places: &[CvPlace], out: &mut TuftBuilder) {
    for attribute in tuft.attributes() {
        let values = match attribute.domain {
            Domain::Curve => attribute.values.gather(kept),
            Domain::Point => between(&attribute.values, places),
        };
        out.set_column(Attribute { values, ..attribute.clone() });
    }
}

/// The same for hair of which such shares of its length are left, or were added: its `fibre_length` goes with them.
pub(crate) fn carry_shares(
    tuft: &Tuft,
    kept: &[u32],
    places: &[CvPlace],
    shares: &[f32],
    out: &mut TuftBuilder,
) {
    carry(tuft, kept, places, out);
    let fibre = tuft.view(FIBRE);
    let of = |(i, share): (&u32, &f32)| {
        fibre.at(*i as usize, tuft.offsets()[*i as usize] as usize) * share
    };
    if tuft.attribute(FIBRE.name).is_some() {
        out.set(FIBRE, Domain::Curve, kept.iter().zip(shares).map(of).collect());
    }
}

/// Binds hair to the root of a curve that it begins at.
pub(crate) fn carry_root(tuft: &Tuft, curve: usize, out: &mut TuftBuilder) {
    for name in [ROOT_TRIANGLE.name, ROOT_BARY.name, ROOT_UV.name] {
        if let Some(attribute) = tuft.attribute(name).filter(|it| it.domain == Domain::Curve) {
            let values = attribute.values.gather(&[curve as u32]);
            out.set_column(Attribute { values, ..attribute.clone() });
        }
    }
}

/// A place on a spline as one among its points.
pub(crate) fn place_of(place: SplineParam) -> CvPlace {
    (place.span as u32, place.t)
}

/// The places of `count` points evenly spaced by arc length along a curve; one where the curve has no length.
pub(crate) fn evenly(curve: &[Vec3], count: usize) -> Vec<CvPlace> {
    let Ok(spline) = Spline::new(curve) else { return vec![(0, 0.0)] };
    let last = count.saturating_sub(1).max(1) as f32;
    (0..count).map(|k| place_of(spline.locate(k as f32 / last))).collect()
}

/// What hair is made from, as its maker tells it.
pub(crate) struct Lineage<'a> {
    /// A curve that hair is made from, by a number of the maker's.
    pub parent: &'a dyn Fn(u32) -> (&'a Tuft, usize),
    /// The parents of a hair, nearest first, and their weights, which sum to 1.
    pub of: &'a dyn Fn(usize) -> &'a [(u32, f32)],
    /// For each point of the hair made from a parent its place among those of the parent, from its root on; or one place for
    /// all. Asked for once a parent, and only where values differ by point.
    pub places: &'a dyn Fn(u32) -> Vec<CvPlace>,
    /// Whether hair of this kind takes an attribute.
    pub takes: &'a dyn Fn(&str) -> bool,
}

/// The parents of hair that has but one, told by [`Lineage::of`]: one for all, with the number 0; or each its own, with the
/// hair's number.
pub(crate) const ONE_PARENT: &[(u32, f32)] = &[(0, 1.0)];
pub(crate) fn own_parents(hairs: usize) -> Vec<[(u32, f32); 1]> {
    (0..hairs as u32).map(|hair| [(hair, 1.0)]).collect()
}

impl Lineage<'_> {
    /// Gives hair what its parents have, but for what its maker has set.
    pub(crate) fn pass_on(&self, out: &mut TuftBuilder) {
        let parents = Parents::new(self, out.len());
        let mut places = BTreeMap::new();
        for name in parents.names() {
            if out.has(&name) || !(self.takes)(&name) {
                continue;
            }
            let (rule, of) = parents.attributes(&name);
            if let Some(first) = of.iter().flatten().next() {
                for_type!(first.values, T => self.pass_one::<T>(&parents, (rule, &of), first, &mut places, out));
            }
        }
    }

    /// Gives hair one attribute: `of` is that of each parent that counts, and `first` the first of them.
    fn pass_one<T: Between>(
        &self,
        parents: &Parents,
        (rule, of): (CarryRule, &[Option<&Attribute>]),
        first: &Attribute,
        places: &mut BTreeMap<u32, Vec<CvPlace>>,
        out: &mut TuftBuilder,
    ) {
        let default = default_of(&first.name, &first.values);
        let Some([default]) = T::values(&default).map(|one| &one[..]) else { return };
        let mut value = |at: usize| {
            let (number, tuft, curve) = parents.all[at];
            match of[at].and_then(|it| Some((it.domain, &T::values(&it.values)?[..]))) {
                None => Values::One(*default),
                Some((_, [one])) => Values::One(*one),
                Some((Domain::Curve, all)) => Values::One(all[curve]),
                Some((Domain::Point, all)) => match &all[tuft.range(curve)] {
                    [first, rest @ ..] if rest.iter().all(|x| x == first) => Values::One(*first),
                    all => match &places.entry(number).or_insert_with(|| (self.places)(number))[..]
                    {
                        [one] => Values::One(T::at(all, *one)),
                        each => Values::Each(each.iter().map(|at| T::at(all, *at)).collect()),
                    },
                },
            }
        };
        let values: Vec<Values<T>> = (0..of.len()).map(&mut value).collect();
        // What no hair reads says nothing.
        let counts = |at: usize| rule == CarryRule::Blended || parents.is_nearest[at];
        let one = values[parents.links[0].0 as usize].at(0);
        let is_one = |values: &Values<T>| matches!(values, Values::One(value) if *value == one);
        if (0..values.len()).filter(|at| counts(*at)).all(|at| is_one(&values[at])) {
            out.set_named(first.name.clone(), first.domain, vec![one]);
            return;
        }
        // However its parents lie in tufts: what is the same all along each hair is one value for it.
        let by_point = values.iter().any(|values| matches!(values, Values::Each(_)));
        let mut all = vec![];
        for hair in 0..out.len() {
            let n = if by_point { out.range(hair).len() } else { 1 };
            let from = all.len();
            let (nearest, others) = parents.of(hair);
            let nearest = &values[nearest as usize];
            all.extend((0..n).map(|k| nearest.at(k)));
            for (other, weight) in others.iter().filter(|_| rule == CarryRule::Blended) {
                let other = &values[*other as usize];
                for (k, sum) in all[from..].iter_mut().enumerate() {
                    *sum = T::toward(*sum, nearest.at(k), other.at(k), *weight);
                }
            }
        }
        let domain = if by_point { Domain::Point } else { Domain::Curve };
        out.set_named(first.name.clone(), domain, all);
    }
}

/// All parents of the hair of a tuft.
struct Parents<'a> {
    /// Each once: its number, its tuft and its curve there.
    all: Vec<(u32, &'a Tuft, usize)>,
    /// Whether it is the nearest of any hair.
    is_nearest: Vec<bool>,
    /// Those of all hairs, as indices into `all`, and their weights.
    links: Vec<(u32, f32)>,
    /// Where those of each hair begin, and the end of the last.
    starts: Vec<usize>,
}

impl<'a> Parents<'a> {
    fn new(told: &Lineage<'a>, hairs: usize) -> Self {
        let mut found = Self { all: vec![], is_nearest: vec![], links: vec![], starts: vec![0] };
        let mut known: BTreeMap<u32, u32> = BTreeMap::new();
        for hair in 0..hairs {
            let first = found.links.len();
            for (number, weight) in (told.of)(hair) {
                let at = *known.entry(*number).or_insert_with(|| {
                    let (tuft, curve) = (told.parent)(*number);
                    found.all.push((*number, tuft, curve));
                    found.is_nearest.push(false);
                    found.all.len() as u32 - 1
                });
                found.is_nearest[at as usize] |= found.links.len() == first;
                found.links.push((at, *weight));
            }
            found.starts.push(found.links.len());
        }
        found
    }

    /// The nearest parent of a hair, and all others with their weights.
    fn of(&self, hair: usize) -> (u32, &[(u32, f32)]) {
        let all = &self.links[self.starts[hair]..self.starts[hair + 1]];
        (all[0].0, &all[1..])
    }

    fn names(&self) -> BTreeSet<Name> {
        let mut names = BTreeSet::new();
        for same in self.all.chunk_by(|a, b| std::ptr::eq(a.1, b.1)) {
            names.extend(same[0].1.attributes().iter().map(|attribute| attribute.name.clone()));
        }
        names
    }

    /// The rule of an attribute, and that of each parent where it counts by that rule.
    fn attributes(&self, name: &str) -> (CarryRule, Vec<Option<&'a Attribute>>) {
        let mut of: Vec<Option<&Attribute>> =
            self.all.iter().map(|(_, tuft, _)| tuft.attribute(name)).collect();
        let first = of.iter().flatten().next();
        let rule = first.map_or(CarryRule::Own, |first| carry_of(name, &first.values));
        for (attribute, is_nearest) in of.iter_mut().zip(&self.is_nearest) {
            *attribute = attribute.filter(|it| match rule {
                CarryRule::Blended => true,
                CarryRule::Inherited => *is_nearest,
                CarryRule::Whole => *is_nearest && !it.differs_by_point(),
                CarryRule::Own => false,
            });
        }
        (rule, of)
    }
}

/// What hair of a parent has of an attribute.
enum Values<T> {
    One(T),
    /// At each of its points.
    Each(Vec<T>),
}

impl<T: Copy> Values<T> {
    #[inline]
    fn at(&self, point: usize) -> T {
        match self {
            Self::One(value) => *value,
            Self::Each(all) => all[point],
        }
    }
}

/// Values along curves: numbers and vectors are interpolated, ids and counts taken from before.
fn between(column: &Column, places: &[CvPlace]) -> Column {
    fn each<T: Between>(column: &Column, places: &[CvPlace]) -> Option<Column> {
        let all = T::values(column).filter(|all| all.len() > 1)?;
        Some(T::column(places.iter().map(|at| T::at(all, *at)).collect()))
    }
    for_type!(column, T => each::<T>(column, places)).unwrap_or_else(|| column.clone())
}

/// A value that may lie between others.
trait Between: Item {
    /// A fraction of the way from one point to the next.
    fn between(a: Self, b: Self, t: f32) -> Self;
    /// `sum`, moved by what another parent differs from the nearest.
    fn toward(sum: Self, nearest: Self, other: Self, weight: f32) -> Self;
    /// The value at a place.
    fn at(all: &[Self], (before, t): CvPlace) -> Self {
        let before = before as usize;
        Self::between(all[before], *all.get(before + 1).unwrap_or(&all[before]), t)
    }
}

macro_rules! mixed {
    ($($ty:ty),*) => {$(
        impl Between for $ty {
            #[inline]
            fn between(a: Self, b: Self, t: f32) -> Self {
                a + (b - a) * t
            }
            #[inline]
            fn toward(sum: Self, nearest: Self, other: Self, weight: f32) -> Self {
                sum + (other - nearest) * weight
            }
        }
    )*};
}
mixed!(f32, Vec2, Vec3);

macro_rules! picked {
    ($($ty:ty),*) => {$(
        impl Between for $ty {
            #[inline]
            fn between(a: Self, b: Self, t: f32) -> Self {
                if t < 1.0 { a } else { b }
            }
            #[inline]
            fn toward(sum: Self, _: Self, _: Self, _: f32) -> Self {
                sum
            }
        }
    )*};
}
picked!(i32, u64);

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::attributes::{COLOUR, ID, NORMAL};

    /// A curve of four points from the origin on, 3 cm long.
    fn curve(id: u64, set: impl FnOnce(&mut TuftBuilder)) -> Tuft {
        let mut b = TuftBuilder::new();
        b.push_curve(&[0.0, 1.0, 2.0, 3.0].map(|x| Vec3::X * x));
        b.set(ID, Domain::Curve, vec![id]);
        set(&mut b);
        b.build()
    }

    /// Two hairs of seven points: one half way between two parents, the other the second's alone.
    fn two(parents: &[Tuft; 2], places: &dyn Fn(u32) -> Vec<CvPlace>) -> Tuft {
        let mut b = TuftBuilder::even(vec![Vec3::ZERO; 14], 7);
        let of: [&[(u32, f32)]; 2] = [&[(0, 0.5), (1, 0.5)], &[(1, 1.0)]];
        let lineage = Lineage {
            parent: &|number| (&parents[number as usize], 0),
            of: &|hair| of[hair],
            places,
            takes: &|name| name != "left",
        };
        lineage.pass_on(&mut b);
        b.build()
    }

    fn by_point(parents: &[Tuft; 2]) -> Tuft {
        two(parents, &|number| evenly(parents[number as usize].curve(0), 7))
    }

    fn all<T: Item>(tuft: &Tuft, name: &str) -> Vec<T> {
        T::values(&tuft.attribute(name).unwrap().values).unwrap().to_vec()
    }

    #[test]
    fn numbers_and_colours_are_mixed_and_ids_are_the_nearest_parents() {
        let parent = |x: f32, id: u64| {
            curve(id, |b| {
                b.set_named("size".into(), Domain::Curve, vec![x]);
                b.set_named("kind".into(), Domain::Curve, vec![x as i32]);
                b.set_named("left".into(), Domain::Curve, vec![x]);
                b.set(COLOUR, Domain::Curve, vec![Vec3::splat(x)]);
                b.set(NORMAL, Domain::Curve, vec![Vec3::splat(x)]);
            })
        };
        let hair = by_point(&[parent(1.0, 7), parent(3.0, 8)]);
        assert_eq!(all::<f32>(&hair, "size"), [2.0, 3.0]);
        assert_eq!(all::<i32>(&hair, "kind"), [1, 3]);
        assert_eq!(all::<Vec3>(&hair, COLOUR.name), [2.0, 3.0].map(Vec3::splat));
        assert_eq!(all::<Vec3>(&hair, NORMAL.name), [1.0, 3.0].map(Vec3::splat));
        assert!(hair.attribute(ID.name).is_none() && hair.attribute("left").is_none());
    }

    #[test]
    fn values_of_points_are_those_of_the_parents_there() {
        let parent = |x: f32, id: u64| {
            curve(id, |b| {
                let each = [0.0, 1.0, 2.0, 3.0].map(|k| x + k);
                b.set_named("size".into(), Domain::Point, each.to_vec());
                b.set_named("kind".into(), Domain::Point, each.map(|x| x as u64).to_vec());
                b.set(NORMAL, Domain::Point, each.map(Vec3::splat).to_vec());
            })
        };
        let hair = by_point(&[parent(10.0, 7), parent(20.0, 8)]);
        let size = all::<f32>(&hair, "size");
        for k in 0..7 {
            let along = 0.5 * k as f32;
            assert!((size[k] - 15.0 - along).abs() < 1e-4, "{size:?}");
            assert!((size[7 + k] - 20.0 - along).abs() < 1e-4, "{size:?}");
        }
        let kind = all::<u64>(&hair, "kind");
        assert_eq!((kind[0], kind[6], kind[7], kind[13]), (10, 13, 20, 23));
        // Which way a point of a guide faces is not which way its hair does.
        assert!(hair.attribute(NORMAL.name).is_none());
    }

    #[test]
    fn what_one_parent_lacks_counts_as_its_default() {
        let bare = || curve(8, |_| ());
        let red = curve(7, |b| b.set(COLOUR, Domain::Curve, vec![Vec3::X]));
        let hair = by_point(&[red.clone(), bare()]);
        let (mixed, default) = ((Vec3::X + COLOUR.default) * 0.5, COLOUR.default);
        let colours = all::<Vec3>(&hair, COLOUR.name);
        assert!(colours[0].distance(mixed) < 1e-6 && colours[1] == default, "{colours:?}");
        let other = curve(8, |b| b.set_named(COLOUR.name.into(), Domain::Curve, vec![4u64]));
        assert_eq!(all::<Vec3>(&by_point(&[red, other]), COLOUR.name)[1], default);
    }

    #[test]
    fn what_is_the_same_for_all_is_stored_once_and_no_place_is_asked_for() {
        let parent = |id: u64, x: f32| {
            curve(id, |b| {
                b.set_named("same".into(), Domain::Curve, vec![0.3f32]);
                b.set_named("spread".into(), Domain::Point, vec![5i32]);
                b.set_named("size".into(), Domain::Curve, vec![x]);
            })
        };
        let hair = two(&[parent(7, 0.1), parent(8, 0.2)], &|_| panic!("asked"));
        assert_eq!(all::<f32>(&hair, "same"), [0.3]);
        assert_eq!(all::<i32>(&hair, "spread"), [5]);
        assert_eq!(all::<f32>(&hair, "size").len(), 2);
    }

    #[test]
    fn the_last_point_of_a_curve_keeps_its_id() {
        let tuft = curve(1, |b| b.set_named("kind".into(), Domain::Point, vec![1u64, 2, 3, 4]));
        let mut b = TuftBuilder::even(tuft.points().to_vec(), 4);
        carry(&tuft, &[0], &[(0, 0.0), (1, 0.0), (2, 0.0), (2, 1.0)], &mut b);
        assert_eq!(all::<u64>(&b.build(), "kind"), [1, 2, 3, 4]);
    }
}
