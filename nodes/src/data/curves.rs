//! Curves in tufts: the one type for guides, clusters, braids and hair.
//!
//! [`Curves`] is an ordered list of [`Tuft`]s. A tuft holds up to 4,096 curves and 65,536 points made from one parent,
//! flat in memory: points, offsets and named columns, each shared until it is changed. The tuft is the unit of parallel
//! work, reuse, cancellation and upload.
//!
//! **Invariant:** a tuft's key is the hash of its content. Two tufts with the same key hold the same hair, whoever made
//!  them, so downstream work with the same result never runs twice.

use super::attributes::{Attribute, Declared, Domain, Item, Name};
use crate::maths::hash::{Key, KeyBuilder};
use glam::Vec3;
use std::ops::Range;
use std::sync::Arc;

/// The most curves a tuft may hold; [`Tuft::split`] cuts larger ones.
pub const MOST_CURVES: usize = 4_096;
/// The most points a tuft may hold.
pub const MOST_POINTS: usize = 65_536;
/// The most points of a curve that game engines take.
pub const MOST_A_CURVE: usize = 255;

/// Curves made from one parent. Immutable; see [`TuftBuilder`].
#[derive(Clone, Debug)]
pub struct Tuft {
    key: Key,
    /// Hash of the points alone.
    points_key: Key,
    points: Arc<Vec<Vec3>>,
    /// Curve `i` owns `points[offsets[i]..offsets[i + 1]]`.
    offsets: Arc<Vec<u32>>,
    /// Sorted by name.
    attributes: Vec<Attribute>,
}

/// Values of one attribute in a tuft, in any domain, with the declared default as fallback.
#[derive(Clone, Copy, Debug)]
pub enum AttributeView<'a, T> {
    /// One value for all.
    Shared(T),
    /// One value per curve.
    Curve(&'a [T]),
    /// One value per point.
    Point(&'a [T]),
}

impl<T: Copy> AttributeView<'_, T> {
    /// The value at point `point` of the tuft, which belongs to curve `curve`.
    #[inline]
    pub fn at(&self, curve: usize, point: usize) -> T {
        match self {
            AttributeView::Shared(value) => *value,
            AttributeView::Curve(values) => values[curve],
            AttributeView::Point(values) => values[point],
        }
    }
}

impl Tuft {
    /// Number of curves.
    pub fn len(&self) -> usize {
        self.offsets.len() - 1
    }
    /// Whether there are no curves.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
    /// Hash of the content.
    pub fn key(&self) -> Key {
        self.key
    }
    /// All points of all curves, root to tip, cm.
    pub fn points(&self) -> &[Vec3] {
        &self.points
    }
    /// Range of curve `i` in [`Self::points`].
    #[inline]
    pub fn range(&self, i: usize) -> Range<usize> {
        self.offsets[i] as usize..self.offsets[i + 1] as usize
    }
    /// The points of curve `i`, root to tip, cm.
    #[inline]
    pub fn curve(&self, i: usize) -> &[Vec3] {
        &self.points[self.range(i)]
    }
    /// Start of each curve in [`Self::points`], and the end of the last.
    pub fn offsets(&self) -> &[u32] {
        &self.offsets
    }
    /// All attributes, by name.
    pub fn attributes(&self) -> &[Attribute] {
        &self.attributes
    }
    /// The attribute with this name.
    pub fn attribute(&self, name: &str) -> Option<&Attribute> {
        let at = self.attributes.binary_search_by(|a| a.name.as_ref().cmp(name)).ok()?;
        Some(&self.attributes[at])
    }
    /// Whether any attribute has a value of its own for each point.
    pub fn differs_by_point(&self) -> bool {
        self.attributes.iter().any(Attribute::differs_by_point)
    }
    /// The values of a declared attribute, or its default if the tuft has none (or one of another type).
    pub fn view<T: Item>(&self, declared: Declared<T>) -> AttributeView<'_, T> {
        self.view_named(declared.name).unwrap_or(AttributeView::Shared(declared.default))
    }
    /// The values of any named attribute, if it has this type.
    pub fn view_named<T: Item>(&self, name: &str) -> Option<AttributeView<'_, T>> {
        let attribute = self.attribute(name)?;
        let values = T::values(&attribute.values)?;
        Some(match (attribute.domain, &values[..]) {
            (_, [one]) => AttributeView::Shared(*one),
            (Domain::Curve, all) => AttributeView::Curve(all),
            (Domain::Point, all) => AttributeView::Point(all),
        })
    }
    /// The stable id of curve `i`.
    pub fn id(&self, i: usize) -> u64 {
        self.view(super::attributes::ID).at(i, self.offsets[i] as usize)
    }
    /// A builder with this tuft's content, whose points stay; unchanged parts stay shared.
    pub fn edit(&self) -> TuftBuilder {
        TuftBuilder {
            points: self.points.clone(),
            points_key: Some(self.points_key),
            offsets: self.offsets.clone(),
            attributes: self.attributes.clone(),
        }
    }
    /// The curves at `pick`, in that order.
    pub fn gather(&self, pick: &[u32]) -> TuftBuilder {
        let mut out = TuftBuilder::new();
        let mut points_picked = vec![];
        for i in pick {
            points_picked.extend(self.range(*i as usize).map(|p| p as u32));
            out.push_curve(self.curve(*i as usize));
        }
        for attribute in &self.attributes {
            let pick = match attribute.domain {
                Domain::Curve => pick,
                Domain::Point => &points_picked,
            };
            out.attributes
                .push(Attribute { values: attribute.values.gather(pick), ..attribute.clone() });
        }
        out
    }
    /// This tuft, or its parts if it exceeds the limits. A curve is never split.
    pub fn split(self) -> Vec<Arc<Tuft>> {
        if self.len() <= MOST_CURVES && self.points.len() <= MOST_POINTS {
            return vec![Arc::new(self)];
        }
        let mut parts = vec![];
        let mut first = 0;
        while first < self.len() {
            let start = self.offsets[first] as usize;
            let mut end = first + 1;
            while end < self.len()
                && end - first < MOST_CURVES
                && self.offsets[end + 1] as usize - start <= MOST_POINTS
            {
                end += 1;
            }
            let stop = self.offsets[end] as usize;
            let part = TuftBuilder {
                points: Arc::new(self.points[start..stop].to_vec()),
                points_key: None,
                offsets: Arc::new(
                    self.offsets[first..=end].iter().map(|o| o - start as u32).collect(),
                ),
                attributes: self
                    .attributes
                    .iter()
                    .map(|a| {
                        let values = match a.domain {
                            Domain::Curve => a.values.slice(first, end),
                            Domain::Point => a.values.slice(start, stop),
                        };
                        Attribute { values, ..a.clone() }
                    })
                    .collect(),
            };
            parts.push(Arc::new(part.build()));
            first = end;
        }
        parts
    }
    /// Bytes held, shared columns counted in full.
    pub fn bytes(&self) -> usize {
        size_of_val(self.points())
            + size_of_val(self.offsets())
            + self.attributes.iter().map(|a| a.values.bytes().1.len() + 64).sum::<usize>()
            + size_of::<Self>()
    }
    /// Reports the address of each buffer that other tufts may share, and its size in bytes.
    pub fn buffers(&self, tell: &mut impl FnMut(usize, usize)) {
        let (points, offsets) = (&self.points, &self.offsets);
        tell(Arc::as_ptr(points) as usize, points.capacity() * size_of::<Vec3>());
        tell(Arc::as_ptr(offsets) as usize, offsets.capacity() * size_of::<u32>());
        for attribute in &self.attributes {
            let (at, bytes) = attribute.values.buffer();
            tell(at, bytes);
        }
    }
    /// Bytes that no other tuft shares.
    pub fn own_bytes(&self) -> usize {
        size_of::<Self>() + self.attributes.capacity() * size_of::<Attribute>()
    }
}

/// A tuft under construction.
#[derive(Clone, Debug, Default)]
pub struct TuftBuilder {
    points: Arc<Vec<Vec3>>,
    /// Their hash, while they are unchanged from a tuft.
    points_key: Option<Key>,
    offsets: Arc<Vec<u32>>,
    attributes: Vec<Attribute>,
}

impl TuftBuilder {
    /// No curves yet.
    pub fn new() -> Self {
        Self::default()
    }
    /// A tuft of these points, with `points_each` points per curve.
    pub fn even(points: Vec<Vec3>, points_each: usize) -> Self {
        let curves = points.len().checked_div(points_each).unwrap_or(0);
        let offsets = (0..=curves).map(|i| (i * points_each) as u32).collect();
        let points = Arc::new(points);
        Self { points, points_key: None, offsets: Arc::new(offsets), attributes: vec![] }
    }
    /// Adds a curve, root first.
    pub fn push_curve(&mut self, points: &[Vec3]) {
        self.points_key = None;
        Arc::make_mut(&mut self.points).extend_from_slice(points);
        let offsets = Arc::make_mut(&mut self.offsets);
        if offsets.is_empty() {
            offsets.push(0);
        }
        offsets.push(self.points.len() as u32);
    }
    /// Number of curves so far.
    pub fn len(&self) -> usize {
        self.offsets.len().saturating_sub(1)
    }
    /// Whether there are no curves yet.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
    /// Range of curve `i` in its points.
    pub(crate) fn range(&self, i: usize) -> Range<usize> {
        self.offsets[i] as usize..self.offsets[i + 1] as usize
    }
    /// Whether an attribute with this name is set.
    pub(super) fn has(&self, name: &str) -> bool {
        self.attributes.iter().any(|attribute| attribute.name == name)
    }
    /// All points, to change in place: hair that exists is moved by `data/route` alone.
    pub(super) fn points_mut(&mut self) -> &mut [Vec3] {
        self.points_key = None;
        Arc::make_mut(&mut self.points).as_mut_slice()
    }
    /// Replaces the points by as many others: hair that exists is moved by `data/route` alone.
    pub(super) fn with_points(mut self, points: Vec<Vec3>) -> Self {
        assert_eq!(points.len(), self.points.len(), "as many points");
        (self.points, self.points_key) = (Arc::new(points), None);
        self
    }
    /// Sets a declared attribute: one value for all, one per curve, or one per point.
    ///
    /// # Panics
    /// If `values` has neither one value nor one per item of the domain.
    pub fn set<T: Item>(&mut self, declared: Declared<T>, domain: Domain, values: Vec<T>) {
        self.set_named(Name::Borrowed(declared.name), domain, values);
    }
    /// [`Self::set`] for an undeclared name.
    pub fn set_named<T: Item>(&mut self, name: Name, domain: Domain, values: Vec<T>) {
        let items = match domain {
            Domain::Curve => self.len(),
            Domain::Point => self.points.len(),
        };
        assert!(values.len() == items || values.len() == 1, "{name}: one value, or one an item");
        self.set_column(Attribute { name, domain, values: T::column(values) });
    }
    /// Adds an attribute, or replaces the one with the same name.
    pub fn set_column(&mut self, attribute: Attribute) {
        self.remove(&attribute.name);
        self.attributes.push(attribute);
    }
    /// Removes an attribute.
    pub fn remove(&mut self, name: &str) {
        self.attributes.retain(|a| a.name != name);
    }
    /// Finishes the tuft: sorts its attributes and hashes its content.
    pub fn build(self) -> Tuft {
        let Self { points, points_key, mut offsets, mut attributes } = self;
        if offsets.is_empty() {
            offsets = Arc::new(vec![0]);
        }
        attributes.retain(|a| !a.values.is_empty());
        attributes.sort_by(|a, b| a.name.cmp(&b.name));
        let column = || KeyBuilder::new("points").column(bytemuck::cast_slice::<_, f32>(&points));
        let points_key = points_key.unwrap_or_else(|| column().finish());
        let mut key = KeyBuilder::new("tuft").key(points_key);
        // Curves of equal length, the usual case, are described by two numbers.
        let each = offsets.get(1).copied().unwrap_or(0);
        let even = offsets.iter().enumerate().all(|(i, o)| *o as usize == i * each as usize);
        key = if even {
            key.int(u64::from(each)).int(offsets.len() as u64)
        } else {
            key.column(&offsets)
        };
        for a in &attributes {
            let (ty, bytes) = a.values.bytes();
            key = key.text(&a.name).int(a.domain as u64).text(ty).column(bytes);
        }
        Tuft { key: key.finish(), points_key, points, offsets, attributes }
    }
}

/// An ordered list of tufts. Cheap to clone.
#[derive(Clone, Debug)]
pub struct Curves {
    tufts: Arc<[Arc<Tuft>]>,
    key: Key,
}

impl Default for Curves {
    fn default() -> Self {
        Self::new(vec![])
    }
}

impl Curves {
    /// Curves from these tufts; empty ones are dropped.
    pub fn new(tufts: Vec<Arc<Tuft>>) -> Self {
        let tufts: Arc<[Arc<Tuft>]> = tufts.into_iter().filter(|t| !t.is_empty()).collect();
        let key = tufts.iter().fold(KeyBuilder::new("curves"), |key, t| key.key(t.key)).finish();
        Self { tufts, key }
    }
    /// The tufts, in order.
    pub fn tufts(&self) -> &[Arc<Tuft>] {
        &self.tufts
    }
    /// Hash of the content.
    pub fn key(&self) -> Key {
        self.key
    }
    /// Number of curves.
    pub fn curve_count(&self) -> usize {
        self.tufts.iter().map(|t| t.len()).sum()
    }
    /// Number of points.
    pub fn point_count(&self) -> usize {
        self.tufts.iter().map(|t| t.points.len()).sum()
    }
    /// Every curve in order: its tuft and its index there.
    pub fn each(&self) -> impl Iterator<Item = (&Tuft, usize)> {
        self.tufts.iter().flat_map(|t| (0..t.len()).map(move |i| (&**t, i)))
    }
    /// Lowest and highest corner of the bounding box, cm; `None` without points.
    pub fn bounds(&self) -> Option<(Vec3, Vec3)> {
        let mut points = self.tufts.iter().flat_map(|t| t.points.iter().copied());
        let first = points.next()?;
        Some(points.fold((first, first), |(lo, hi), p| (lo.min(p), hi.max(p))))
    }
    /// Bytes held.
    pub fn bytes(&self) -> usize {
        self.tufts.iter().map(|t| t.bytes()).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::super::attributes::{ID, RADIUS, WIDTH};
    use super::*;

    fn two() -> TuftBuilder {
        let mut b = TuftBuilder::new();
        b.push_curve(&[Vec3::ZERO, Vec3::Y]);
        b.push_curve(&[Vec3::X, Vec3::X + Vec3::Y, Vec3::X + Vec3::Y * 2.0]);
        b.set(ID, Domain::Curve, vec![7, 8]);
        b
    }

    #[test]
    fn a_missing_attribute_reads_as_its_default() {
        let tuft = two().build();
        assert_eq!(tuft.view(RADIUS).at(1, 4), 1.0);
        assert_eq!(tuft.id(1), 8);
    }

    #[test]
    fn the_key_is_the_content() {
        assert_eq!(two().build().key(), two().build().key());
        let mut wider = two();
        wider.set(WIDTH, Domain::Curve, vec![0.01]);
        assert_ne!(wider.build().key(), two().build().key());
        let mut other = two();
        other.points_mut()[0].x = 1.0;
        assert_ne!(other.build().key(), two().build().key());
        // However the points were changed.
        let tuft = two().build();
        let mut moved = tuft.edit();
        moved.points_mut()[0].x = 1.0;
        let mut points = tuft.points().to_vec();
        points[0].x = 1.0;
        let set = tuft.edit().with_points(points).build();
        assert_eq!(moved.build().key(), set.key());
        let mut longer = tuft.edit();
        longer.push_curve(&[Vec3::ZERO, Vec3::Z]);
        longer.remove(ID.name);
        let mut afresh = two();
        afresh.remove(ID.name);
        afresh.push_curve(&[Vec3::ZERO, Vec3::Z]);
        assert_eq!(longer.build().key(), afresh.build().key());
    }

    #[test]
    fn unchanged_columns_are_shared() {
        let tuft = two().build();
        let mut edit = tuft.edit();
        edit.set(WIDTH, Domain::Curve, vec![0.02]);
        let wider = edit.build();
        assert!(Arc::ptr_eq(&tuft.points, &wider.points));
    }

    #[test]
    fn a_large_tuft_is_cut_between_curves() {
        let mut b = TuftBuilder::even(vec![Vec3::ONE; 10_000 * 16], 16);
        b.set(ID, Domain::Curve, (0..10_000).collect());
        b.set(RADIUS, Domain::Curve, vec![0.5]);
        let parts = b.build().split();
        assert_eq!(parts.iter().map(|t| t.len()).sum::<usize>(), 10_000);
        for part in &parts {
            assert!(part.len() <= MOST_CURVES && part.points().len() <= MOST_POINTS);
            assert_eq!(part.curve(0).len(), 16);
            assert_eq!(part.view(RADIUS).at(3, 0), 0.5);
        }
        assert_eq!(parts[1].id(0), parts[0].len() as u64);
    }
}
