//! A curve while gestures act on it: its CVs, and the attributes that a gesture may change.
//!
//! Guarantees: an untouched curve is the input tuft itself, to the bit, so that nothing downstream runs for it; a
//! touched curve keeps all its other attributes, mapped by position along the old curve.

use crate::data::attribute_transfer::{CvPlace, carry};
use crate::data::attributes::{
    COLOUR, CUT, DENSITY, DRIFT, Domain, FRIZZ, ID, NORMAL, PINNED, RADIUS, ROLL, ROOT_BARY,
    ROOT_TRIANGLE, ROOT_UV, SCALP_NORMAL, SECTION, UNCUT,
};
use crate::data::curves::{Curves, Tuft, TuftBuilder};
use crate::data::route::makers::lift_exactly;
use crate::data::scalp::{Root, Scalp, Skin};
use crate::maths::frame::smallest_rotation;
use crate::maths::spline::{Spline, SplineParam};
use glam::Vec3;
use std::sync::Arc;

/// A curve and the changes made by gestures.
#[derive(Clone)]
pub(super) struct Lock {
    pub id: u64,
    /// CVs, root first, cm.
    pub points: Vec<Vec3>,
    /// Whether each CV is pinned.
    pub pinned: Vec<bool>,
    /// Roll of the cross-section at each CV, degrees, accumulated from the root.
    pub roll: Vec<f32>,
    pub density: f32,
    pub frizz: f32,
    /// Radius at the root, cm.
    pub radius: f32,
    /// Radius at each CV, cm.
    pub radii: Vec<f32>,
    /// The plane in which its strands end: its normal, and the direction of the tip when it was cut.
    pub cut: Option<[Vec3; 2]>,
    /// The arc length that it had before it was cut, cm; 0: it was not.
    pub uncut: f32,
    /// For each CV, the position in the input curve that its other values come from, in CVs.
    from: Vec<f32>,
    /// A single curve: as it came in, or as it was implanted.
    base: Arc<Tuft>,
    tuft: Arc<Tuft>,
}

impl Lock {
    /// The input curves.
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
        let first =
            |view: crate::data::curves::AttributeView<f32>, other: f32| match points.is_empty() {
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
            uncut: first(base.view(UNCUT), UNCUT.default),
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

    /// A copy with the same number of CVs at another root. It has no pins.
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
        // Attributes that depend only on its position.
        for name in [PINNED.name, NORMAL.name, ROOT_UV.name, SECTION.name] {
            b.remove(name);
        }
        b.set(ID, Domain::Curve, vec![id]);
        root(&mut b, at, drift, scalp);
        Self::new(Arc::new(b.build()))
    }

    /// Its current tuft.
    pub(super) fn tuft(&self) -> &Arc<Tuft> {
        &self.tuft
    }

    pub(super) fn root(&self) -> Vec3 {
        self.points[0]
    }
    pub(super) fn tip(&self) -> Vec3 {
        self.points[self.points.len() - 1]
    }
    /// The last fixed CV: the root, or a pin. CVs before it stay as well.
    pub(super) fn held(&self) -> usize {
        self.pinned.iter().rposition(|pinned| *pinned).unwrap_or(0)
    }
    /// Whether it has a width of its own.
    pub(super) fn is_cluster(&self) -> bool {
        self.base.attribute(RADIUS.name).is_some()
    }
    /// Whether it can be acted on.
    pub(super) fn is_curve(&self) -> bool {
        self.points.len() > 1 && self.points.iter().all(|p| p.is_finite())
    }

    /// Replaces the CVs, each derived from a position among the old ones, in CVs.
    pub(super) fn set_points(&mut self, points: Vec<Vec3>, places: &[f32]) {
        let read = |values: &[f32], at: f32| {
            let k = (at as usize).min(values.len().saturating_sub(2));
            let (a, b) = (values[k], values[(k + 1).min(values.len() - 1)]);
            a + (b - a) * (at - k as f32).clamp(0.0, 1.0)
        };
        let roll = places.iter().map(|at| read(&self.roll, *at)).collect();
        // (Its column is mapped like all others, by `from`.)
        let radii = places.iter().map(|at| read(&self.radii, *at)).collect();
        let from = places.iter().map(|at| read(&self.from, *at)).collect();
        // A pin stays with the CV nearest to its old position.
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

    /// Puts `more[k]` CVs on the drawn curve between the CVs `k` and `k + 1`; those that are there stay.
    pub(super) fn refine(&mut self, more: &[usize], skin: &Skin) {
        let Ok(drawn) = Spline::new(&self.points) else { return };
        let (mut points, mut places) = (vec![], vec![]);
        for (span, p) in self.points.iter().enumerate() {
            points.push(*p);
            places.push(span as f32);
            let count = more.get(span).copied().unwrap_or(0);
            for i in 1..=count {
                let t = i as f32 / (count + 1) as f32;
                points.push(lift_exactly(skin, drawn.point(SplineParam { span, t }), 0.0).0);
                places.push(span as f32 + t);
            }
        }
        self.set_points(points, &places);
    }

    /// The same with a new tuft.
    pub(super) fn done(mut self) -> Arc<Self> {
        let base = &self.base;
        let same = self.from.len() == base.points().len()
            && self.from.iter().enumerate().all(|(k, from)| *from == k as f32);
        let mut b = TuftBuilder::new();
        b.push_curve(&self.points);
        if same {
            base.attributes().iter().for_each(|attribute| b.set_column(attribute.clone()));
        } else {
            let last = base.points().len().saturating_sub(2);
            let place = |from: &f32| {
                let before = (*from as usize).min(last);
                (before as u32, (from - before as f32).clamp(0.0, 1.0))
            };
            let places: Vec<CvPlace> = self.from.iter().map(place).collect();
            carry(base, &[0], &places, &mut b);
        }
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
        // A curve as long as before its cut no longer counts as cut.
        let uncut = if self.uncut > length(&self.points) { self.uncut } else { 0.0 };
        if uncut > 0.0 || base.attribute(UNCUT.name).is_some() {
            b.set(UNCUT, Domain::Curve, vec![uncut]);
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

    /// Bytes held in addition to the input.
    pub(super) fn bytes(&self) -> usize {
        size_of::<Self>() + self.points.len() * (12 + 4 + 4 + 4 + 1) + self.tuft.bytes()
    }
}

/// Sets the root attributes of the curve.
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

/// The direction of a curve's tip, unit.
pub(super) fn way(points: &[Vec3]) -> Vec3 {
    let last = points.len() - 1;
    (points[last] - points[last - 1]).normalize_or(Vec3::Y)
}

/// Arc length of CVs, cm.
pub(super) fn length(points: &[Vec3]) -> f32 {
    points.windows(2).map(|pair| pair[0].distance(pair[1])).sum()
}

/// Properties of an implant other than its CVs.
pub(super) struct Implanted {
    pub root: Root,
    /// One radius, or one per CV, cm.
    pub radii: Vec<f32>,
    pub density: f32,
    pub colour: Option<Vec3>,
    /// Drift of the root, cm.
    pub drift: f32,
}
