//! A curve while gestures act on it: its CVs, and what of its attributes a gesture may change.
//!
//! Guarantees: a curve that no gesture touches is the tuft that came in, to the bit, so that nothing downstream runs for it; one
//! that is touched keeps all else that it carried, by where along the old curve each CV comes from.

use crate::data::attributes::{
    COLOUR, CUT, Column, DENSITY, DRIFT, Domain, FRIZZ, ID, Item, NORMAL, PINNED, RADIUS, ROLL,
    ROOT_BARY, ROOT_TRIANGLE, ROOT_UV, SCALP_NORMAL, SECTION, default_of,
};
use crate::data::curves::{Curves, Tuft, TuftBuilder};
use crate::data::scalp::{Root, Scalp};
use crate::maths::frame::smallest_rotation;
use glam::{Vec2, Vec3};
use std::sync::Arc;

/// A curve and what gestures have made of it.
#[derive(Clone)]
pub(super) struct Lock {
    pub id: u64,
    /// CVs, root first, cm.
    pub points: Vec<Vec3>,
    /// For each CV whether it is pinned.
    pub pinned: Vec<bool>,
    /// For each CV the turn of the cross-section, degrees, running sum from the root.
    pub roll: Vec<f32>,
    pub density: f32,
    pub frizz: f32,
    /// Radius at the root, cm.
    pub radius: f32,
    /// For each CV the radius there, cm.
    pub radii: Vec<f32>,
    /// The plane in which its strands end, as its normal and the way the tip pointed when it was cut.
    pub cut: Option<[Vec3; 2]>,
    /// For each CV where in the curve that came in its other values come from, in CVs.
    from: Vec<f32>,
    /// One curve: as it came in, or as it was implanted.
    base: Arc<Tuft>,
    tuft: Arc<Tuft>,
}

impl Lock {
    /// The curves as they come in.
    pub(super) fn all(curves: &Curves) -> Vec<Arc<Self>> {
        let mut locks = vec![];
        for tuft in curves.tufts() {
            for i in 0..tuft.len() {
                let one = match tuft.len() {
                    1 => tuft.clone(),
                    _ => Arc::new(tuft.gather(&[i as u32]).build()),
                };
                locks.push(Arc::new(Self::new(one)));
            }
        }
        locks
    }

    fn new(base: Arc<Tuft>) -> Self {
        let points = base.points().to_vec();
        let each = 0..points.len();
        let (pinned, roll, radii) = (base.view(PINNED), base.view(ROLL), base.view(RADIUS));
        let number = |x: f32, other: f32| if x.is_finite() { x } else { other };
        let first = |view: crate::data::curves::View<f32>, other: f32| match points.is_empty() {
            true => other,
            false => number(view.at(0, 0), other),
        };
        Self {
            id: if points.is_empty() { 0 } else { base.id(0) },
            pinned: each.clone().map(|k| pinned.at(0, k) != 0).collect(),
            roll: each.clone().map(|k| number(roll.at(0, k), 0.0)).collect(),
            radii: each.clone().map(|k| number(radii.at(0, k), RADIUS.default)).collect(),
            density: first(base.view(DENSITY), DENSITY.default),
            frizz: first(base.view(FRIZZ), FRIZZ.default),
            radius: first(base.view(RADIUS), RADIUS.default),
            from: each.map(|k| k as f32).collect(),
            cut: (points.len() > 1)
                .then(|| base.view(CUT).at(0, 0))
                .and_then(|normal| Some([normal.try_normalize()?, way(&points)])),
            points,
            tuft: base.clone(),
            base,
        }
    }

    /// A new one.
    pub(super) fn implanted(
        id: u64,
        points: Vec<Vec3>,
        as_asked: &Implanted,
        scalp: &Scalp,
    ) -> Self {
        let mut b = TuftBuilder::new();
        b.push_curve(&points);
        b.set(ID, Domain::Curve, vec![id]);
        let each = if as_asked.radii.len() > 1 { Domain::Point } else { Domain::Curve };
        b.set(RADIUS, each, as_asked.radii.clone());
        b.set(DENSITY, Domain::Curve, vec![as_asked.density]);
        if let Some(colour) = as_asked.colour {
            b.set(COLOUR, Domain::Curve, vec![colour]);
        }
        root(&mut b, &as_asked.root, as_asked.drift, scalp);
        Self::new(Arc::new(b.build()))
    }

    /// The same with as many CVs elsewhere, at a root of its own. It is held by no pin.
    pub(super) fn copied(
        &self,
        id: u64,
        points: Vec<Vec3>,
        at: &Root,
        drift: f32,
        scalp: &Scalp,
    ) -> Self {
        let mut copy = self.clone();
        copy.points = points;
        let mut b = copy.done().tuft.edit();
        // What is known of its place alone.
        for name in [PINNED.name, NORMAL.name, ROOT_UV.name, SECTION.name] {
            b.remove(name);
        }
        b.set(ID, Domain::Curve, vec![id]);
        root(&mut b, at, drift, scalp);
        Self::new(Arc::new(b.build()))
    }

    /// Its tuft as it is now.
    pub(super) fn tuft(&self) -> &Arc<Tuft> {
        &self.tuft
    }

    pub(super) fn root(&self) -> Vec3 {
        self.points[0]
    }
    pub(super) fn tip(&self) -> Vec3 {
        self.points[self.points.len() - 1]
    }
    /// The last CV that holds its place: the root, or a pin. What lies before it stays, too.
    pub(super) fn held(&self) -> usize {
        self.pinned.iter().rposition(|pinned| *pinned).unwrap_or(0)
    }
    /// Whether it can be acted on.
    pub(super) fn is_curve(&self) -> bool {
        self.points.len() > 1 && self.points.iter().all(|p| p.is_finite())
    }

    /// Other CVs, each from a place of those that are there, in CVs.
    pub(super) fn set_points(&mut self, points: Vec<Vec3>, places: &[f32]) {
        let read = |values: &[f32], at: f32| {
            let k = (at as usize).min(values.len().saturating_sub(2));
            let (a, b) = (values[k], values[(k + 1).min(values.len() - 1)]);
            a + (b - a) * (at - k as f32).clamp(0.0, 1.0)
        };
        let roll = places.iter().map(|at| read(&self.roll, *at)).collect();
        // (Its column is kept with all else, by `from`.)
        let radii = places.iter().map(|at| read(&self.radii, *at)).collect();
        let from = places.iter().map(|at| read(&self.from, *at)).collect();
        // A pin stays with the CV nearest to where it was.
        let mut pinned = vec![false; points.len()];
        for (k, _) in self.pinned.iter().enumerate().filter(|(_, pinned)| **pinned) {
            let off = |i: &usize| (places[*i] - k as f32).abs();
            let near = (0..places.len()).min_by(|a, b| off(a).total_cmp(&off(b)));
            if let Some(near) = near.filter(|near| off(near) <= 0.75) {
                pinned[near] = true;
            }
        }
        (self.points, self.roll, self.from, self.pinned) = (points, roll, from, pinned);
        self.radii = radii;
    }

    /// The same with its tuft made anew.
    pub(super) fn done(mut self) -> Arc<Self> {
        let base = &self.base;
        let same = self.from.len() == base.points().len()
            && self.from.iter().enumerate().all(|(k, from)| *from == k as f32);
        let mut b = if same {
            let mut b = base.edit();
            b.set_points(self.points.clone());
            b
        } else {
            let mut b = TuftBuilder::new();
            b.push_curve(&self.points);
            for attribute in base.attributes() {
                let mut one = attribute.clone();
                if one.domain == Domain::Point && one.values.len() > 1 {
                    one.values = along(&one.values, &self.from);
                }
                b.set_column(one);
            }
            b
        };
        let was = Self::new(base.clone());
        if self.density != was.density {
            b.set(DENSITY, Domain::Curve, vec![self.density]);
        }
        if self.frizz != was.frizz {
            b.set(FRIZZ, Domain::Curve, vec![self.frizz]);
        }
        // The plane turns with the tip.
        let cut = self.cut.map(|[normal, was]| smallest_rotation(was, way(&self.points)) * normal);
        if cut.is_some() || base.attribute(CUT.name).is_some() {
            b.set(CUT, Domain::Curve, vec![cut.unwrap_or_default()]);
        }
        if self.roll.iter().any(|roll| *roll != 0.0) || base.attribute(ROLL.name).is_some() {
            b.set(ROLL, Domain::Point, self.roll.clone());
        }
        if self.pinned.iter().any(|pinned| *pinned) || base.attribute(PINNED.name).is_some() {
            b.set(PINNED, Domain::Point, self.pinned.iter().map(|p| i32::from(*p)).collect());
        }
        self.tuft = Arc::new(b.build());
        Arc::new(self)
    }

    /// Bytes held beside what came in.
    pub(super) fn bytes(&self) -> usize {
        size_of::<Self>() + self.points.len() * (12 + 4 + 4 + 4 + 1) + self.tuft.bytes()
    }
}

/// Sets what is known of the one curve's root.
fn root(b: &mut TuftBuilder, root: &Root, drift: f32, scalp: &Scalp) {
    b.set(SCALP_NORMAL, Domain::Curve, vec![root.normal]);
    b.set(ROOT_TRIANGLE, Domain::Curve, vec![root.triangle as i32]);
    b.set(ROOT_BARY, Domain::Curve, vec![root.bary]);
    b.set(DRIFT, Domain::Curve, vec![drift]);
    if scalp.uvs().is_some() {
        b.set(ROOT_UV, Domain::Curve, vec![root.uv]);
    }
    if let Some(section) = scalp.sections().and_then(|s| s.id_at(root.point)) {
        b.set(SECTION, Domain::Curve, vec![section]);
    }
}

/// The way a curve's tip points, unit.
pub(super) fn way(points: &[Vec3]) -> Vec3 {
    let last = points.len() - 1;
    (points[last] - points[last - 1]).normalize_or(Vec3::Y)
}

/// What an implant is beside its CVs.
pub(super) struct Implanted {
    pub root: Root,
    /// One, or one for each CV, cm.
    pub radii: Vec<f32>,
    pub density: f32,
    pub colour: Option<Vec3>,
    /// How far the root lies from where it was drawn, cm.
    pub drift: f32,
}

/// The values of a column at places between CVs; whole numbers and ids are those of the nearest.
fn along(values: &Column, places: &[f32]) -> Column {
    fn each<T: Item>(v: &[T], places: &[f32], mix: impl Fn(T, T, f32) -> T) -> Column {
        let at = |place: &f32| {
            let k = (*place as usize).min(v.len().saturating_sub(2));
            mix(v[k], v[(k + 1).min(v.len() - 1)], (place - k as f32).clamp(0.0, 1.0))
        };
        T::column(places.iter().map(at).collect())
    }
    fn nearest<T>(a: T, b: T, t: f32) -> T {
        if t < 0.5 { a } else { b }
    }
    if values.is_empty() {
        return default_of("", values);
    }
    match values {
        Column::F32(v) => each(v, places, |a, b, t| a + (b - a) * t),
        Column::I32(v) => each(v, places, nearest),
        Column::U64(v) => each(v, places, nearest),
        Column::Vec2(v) => each(v, places, |a: Vec2, b, t| a + (b - a) * t),
        Column::Vec3(v) => each(v, places, |a: Vec3, b, t| a + (b - a) * t),
    }
}
