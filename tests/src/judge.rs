//! A judge of finished hair: how deep the drawn curves dive under the skin, by geometry that is not coif's.
//!
//! It takes positions and triangles of the head from coif, and the bytes of a file that coif writes; of skins, distance fields, closest
//! points and laws of coif it uses none. Curves are what OpenUSD says of them: cubic BasisCurves, `catmullRom`, `pinned`: uniform
//! Catmull-Rom spans, with the phantom ends `2 p0 - p1`.
//!
//! A place of a curve is too deep where the winding number of the head ([`Soup`]) is over one half and the nearest triangle is farther
//! off than `allow_depth` there and [`Judge::tolerance`] allow. `allow_depth` is what coif itself allows a hair: depth of the curve under
//! the skin, cm, one value a CV, linear between (strands of braids that rest on the skin and what they are filled with have it;
//! where the primvar is not written it is 0). Nothing else is allowed: not the hair's width, and not more at its root. Where the
//! nearest point is on an open border, as under an open neck, nothing is too deep.
//!
//! Guaranteed: ten samples a span are judged, all those that could be too deep by their own distance and that of others from the skin
//! (nothing is deeper than half the sum of its neighbours' depths and the way between them); and between these the deepest place of
//! all is found to 0.001 cm, but for what spans a hole, where samples alone count. Roots are within [`ROOT`] of the surface, either
//! side; hair that was fed into a braid has none. The same bits for any number of threads.

mod made;
mod soup;

pub use made::{Made, head_of, make, region};
pub use soup::{Near, Soup};

use coif_nodes::formats::usd::read::{ReadCurves, ReadValues};
use glam::DVec3;
use std::sync::atomic::{AtomicUsize, Ordering};

/// How far a root may be off the surface, cm.
pub const ROOT: f64 = 1e-3;
/// Samples of a span.
const SAMPLES: usize = 10;
/// The deepest place is found to this, cm.
const FOUND_TO: f64 = 1e-3;
/// On a shorter way it is cheaper to look for triangles than to find out again what is inside, cm.
const SHORT: f64 = 1.0;
/// Hairs that are judged one after the other.
const AT_ONCE: usize = 64;

/// How hair is judged.
#[derive(Clone, Copy, Debug)]
pub struct Judge {
    /// How much deeper than allowed is too deep, cm.
    pub tolerance: f64,
    /// Of so many hairs, one.
    pub every: usize,
    /// So many threads.
    pub threads: usize,
}

impl Default for Judge {
    fn default() -> Self {
        Self { tolerance: 0.01, every: 1, threads: 1 }
    }
}

/// A place of a hair, and a length there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place {
    /// How deep beyond what is allowed, or how far off, cm.
    pub by: f64,
    /// The number of the prim, and the hair's in it.
    pub hair: [usize; 2],
    /// Where it is, cm.
    pub at: DVec3,
    /// Where on the curve: the span, and how far in it.
    pub along: f64,
    /// The spans that the curve has.
    pub spans: usize,
}

/// What was found.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Found {
    /// Hairs that were judged.
    pub hairs: usize,
    /// Their samples.
    pub samples: usize,
    /// Places of the curves that had to be looked at for that.
    pub looked: usize,
    /// Samples that are too deep.
    pub deep: usize,
    /// Hairs with such samples.
    pub deep_hairs: usize,
    /// The deepest place, where it is too deep.
    pub deepest: Option<Place>,
    /// Hairs that have no root.
    pub rootless: usize,
    /// Roots farther than [`ROOT`] from the surface.
    pub off: usize,
    /// The farthest of these.
    pub farthest: Option<Place>,
}

impl Found {
    /// Whether no hair is too deep, and no root off the skin.
    pub fn holds(&self) -> bool {
        self.deepest.is_none() && self.off == 0
    }

    /// Both together.
    #[must_use]
    pub fn and(self, other: Self) -> Self {
        let worse = |a: Option<Place>, b: Option<Place>| match (a, b) {
            (Some(a), Some(b)) => Some(if b.by > a.by { b } else { a }),
            (a, b) => a.or(b),
        };
        Self {
            hairs: self.hairs + other.hairs,
            samples: self.samples + other.samples,
            looked: self.looked + other.looked,
            deep: self.deep + other.deep,
            deep_hairs: self.deep_hairs + other.deep_hairs,
            deepest: worse(self.deepest, other.deepest),
            rootless: self.rootless + other.rootless,
            off: self.off + other.off,
            farthest: worse(self.farthest, other.farthest),
        }
    }
}

impl Judge {
    /// Judges the curves of all prims.
    pub fn judge(&self, skin: &Soup, prims: &[ReadCurves]) -> Found {
        let all = prims.iter().enumerate().map(|(prim, curves)| self.prim(skin, prim, curves));
        all.fold(Found::default(), Found::and)
    }

    fn prim(&self, skin: &Soup, prim: usize, curves: &ReadCurves) -> Found {
        let mut firsts = vec![0usize];
        firsts.extend(curves.counts.iter().scan(0, |sum, count| {
            *sum += *count as usize;
            Some(*sum)
        }));
        let allowed = Values::of(curves, "allow_depth", 0.0);
        let fed = Values::of(curves, "fed", 0.0);
        let triangle = Values::of(curves, "skinprim", -1.0);
        let hairs: Vec<usize> = (0..curves.counts.len()).step_by(self.every.max(1)).collect();
        let parts: Vec<&[usize]> = hairs.chunks(AT_ONCE).collect();
        let one = |part: &[usize]| {
            let mut bout = Bout::new(skin, self.tolerance);
            for hair in part {
                let range = firsts[*hair]..firsts[*hair + 1];
                let points = curves.points[range.clone()].iter().map(|p| p.as_dvec3());
                bout.curve.set(points, range.map(|k| allowed.at(*hair, k)));
                let first = firsts[*hair];
                let is_rooted = fed.at(*hair, first) == 0.0 && triangle.at(*hair, first) >= 0.0;
                bout.hair([prim, *hair], is_rooted);
            }
            bout.found
        };
        let next = AtomicUsize::new(0);
        let work = || {
            let mut own = vec![];
            while let Some((n, part)) =
                Some(next.fetch_add(1, Ordering::Relaxed)).and_then(|n| Some((n, parts.get(n)?)))
            {
                own.push((n, one(part)));
            }
            own
        };
        let mut all: Vec<(usize, Found)> = std::thread::scope(|scope| {
            let others: Vec<_> = (1..self.threads).map(|_| scope.spawn(work)).collect();
            let mut all = work();
            all.extend(others.into_iter().flat_map(|other| other.join().expect("no panic")));
            all
        });
        all.sort_by_key(|(n, _)| *n);
        all.into_iter().fold(Found::default(), |sum, (_, found)| sum.and(found))
    }
}

/// A primvar of numbers: one for all, one a curve or one a point; what is taken where there is none is one for all.
enum Values {
    One(f64),
    Curve(Vec<f64>),
    Point(Vec<f64>),
}

impl Values {
    fn of(curves: &ReadCurves, name: &str, else_all: f64) -> Self {
        let Some(primvar) = curves.primvars.iter().find(|primvar| primvar.name == name) else {
            return Self::One(else_all);
        };
        let all: Vec<f64> = match &primvar.values {
            ReadValues::Float(all) => all.iter().map(|x| f64::from(*x)).collect(),
            ReadValues::Int(all) => all.iter().map(|x| f64::from(*x)).collect(),
            other => panic!("{name}: {} values, not numbers", other.len()),
        };
        match primvar.interpolation.as_str() {
            "constant" => Self::One(all[0]),
            "uniform" => Self::Curve(all),
            "vertex" => Self::Point(all),
            other => panic!("{name}: {other}"),
        }
    }
    fn at(&self, hair: usize, point: usize) -> f64 {
        match self {
            Self::One(x) => *x,
            Self::Curve(all) => all[hair],
            Self::Point(all) => all[point],
        }
    }
}

/// A curve as OpenUSD draws it.
#[derive(Default)]
struct Drawn {
    points: Vec<DVec3>,
    allowed: Vec<f64>,
    /// The way to the beginning of each span, at least as long as the curve, and with every change of what is allowed: so far apart,
    /// two places differ in depth beyond what is allowed by no more than this.
    way: Vec<f64>,
}

impl Drawn {
    fn set(&mut self, points: impl Iterator<Item = DVec3>, allowed: impl Iterator<Item = f64>) {
        self.points.clear();
        self.points.extend(points);
        self.allowed.clear();
        self.allowed.extend(allowed);
        self.way.clear();
        self.way.push(0.0);
        let mut way = 0.0;
        for span in 0..self.spans() {
            // No faster than the legs of its Bezier polygon.
            let [a, b, c, d] = self.bezier(span);
            let fastest = 3.0 * a.distance(b).max(b.distance(c)).max(c.distance(d));
            way += fastest + (self.allowed[span + 1] - self.allowed[span]).abs();
            self.way.push(way);
        }
    }
    fn spans(&self) -> usize {
        self.points.len().saturating_sub(1)
    }
    fn bezier(&self, span: usize) -> [DVec3; 4] {
        let p = &self.points;
        let (from, to) = (p[span], p[span + 1]);
        let before = if span > 0 { p[span - 1] } else { 2.0 * from - to };
        let after = p.get(span + 2).copied().unwrap_or(2.0 * to - from);
        [from, from + (to - before) / 6.0, to - (after - from) / 6.0, to]
    }
    /// The span of a place, and how far in it.
    fn split(&self, along: f64) -> (usize, f64) {
        let span = (along as usize).min(self.spans() - 1);
        (span, along - span as f64)
    }
    fn point(&self, along: f64) -> DVec3 {
        let (span, t) = self.split(along);
        let s = 1.0 - t;
        let [a, b, c, d] = self.bezier(span);
        a * (s * s * s) + b * (3.0 * s * s * t) + c * (3.0 * s * t * t) + d * (t * t * t)
    }
    fn allowed(&self, along: f64) -> f64 {
        let (span, t) = self.split(along);
        self.allowed[span] * (1.0 - t) + self.allowed[span + 1] * t
    }
    fn way(&self, along: f64) -> f64 {
        let (span, t) = self.split(along);
        self.way[span] * (1.0 - t) + self.way[span + 1] * t
    }
}

/// A side of the skin.
#[derive(Clone, Copy, PartialEq)]
enum Side {
    In,
    Out,
    /// So near that it does not matter.
    Either,
}

/// A place that was looked at.
#[derive(Clone, Copy)]
struct Seen {
    along: f64,
    p: DVec3,
    way: f64,
    near: Near,
    side: Side,
    /// How deep it is beyond what is allowed, at most.
    by: f64,
}

impl Seen {
    /// Whether it counts as inside.
    fn is_in(&self) -> bool {
        self.side == Side::In && !self.near.on_border
    }
}

/// Some hairs, judged in turn.
struct Bout<'a> {
    skin: &'a Soup,
    tolerance: f64,
    curve: Drawn,
    open: Vec<(usize, Seen, usize, Seen)>,
    finer: Vec<(Seen, Seen)>,
    found: Found,
    number: [usize; 2],
}

impl<'a> Bout<'a> {
    fn new(skin: &'a Soup, tolerance: f64) -> Self {
        let (curve, found) = (Drawn::default(), Found::default());
        Self { skin, tolerance, curve, open: vec![], finer: vec![], found, number: [0; 2] }
    }

    /// Looks at a place, beside others that were looked at.
    fn look(&mut self, along: f64, beside: &[&Seen]) -> Seen {
        self.found.looked += 1;
        let p = self.curve.point(along);
        let near = self.skin.nearest(p, beside.first().map_or(0, |seen| seen.near.triangle));
        // Where no triangle is between, and nothing that spans a hole.
        let is_one_side = |seen: &&&Seen| {
            let off = seen.p.distance(p);
            let are_clear = off < near.distance + seen.near.distance;
            seen.side != Side::Either
                && (are_clear || (off < SHORT && !self.skin.is_between(seen.p, p)))
                && !self.skin.spans(0.5 * (seen.p + p), 0.5 * off)
        };
        let side = if near.distance <= 0.5 * self.tolerance {
            Side::Either
        } else if let Some(seen) = beside.iter().find(is_one_side) {
            seen.side
        } else if self.skin.is_inside(p) {
            Side::In
        } else {
            Side::Out
        };
        let depth = if side == Side::Out { -near.distance } else { near.distance };
        let by = depth - self.curve.allowed(along);
        Seen { along, p, way: self.curve.way(along), near, side, by }
    }

    /// The most that anything between two places may be too deep by.
    fn most(a: &Seen, b: &Seen) -> f64 {
        0.5 * (a.by + b.by + (b.way - a.way))
    }

    /// Whether the curve may pass what spans a hole between two places.
    fn passes(&self, a: &Seen, b: &Seen) -> bool {
        self.skin.spans(0.5 * (a.p + b.p), 0.5 * (b.way - a.way))
    }

    fn hair(&mut self, number: [usize; 2], is_rooted: bool) {
        self.number = number;
        self.found.hairs += 1;
        let spans = self.curve.spans();
        if spans == 0 {
            return;
        }
        let last = spans * SAMPLES;
        self.found.samples += last + 1;
        let at = |k: usize| k as f64 / SAMPLES as f64;
        let before = self.found.deep;
        let root = self.look(0.0, &[]);
        let tip = self.look(at(last), &[]);
        self.found.rootless += usize::from(!is_rooted);
        if is_rooted && root.near.distance > ROOT {
            self.found.off += 1;
            let place = self.place(&root, root.near.distance);
            self.found = Found { farthest: Some(place), ..Found::default() }.and(self.found);
        }
        self.count(&root);
        self.count(&tip);
        self.open.push((0, root, last, tip));
        while let Some((from, a, to, b)) = self.open.pop() {
            let may = Self::most(&a, &b) > self.tolerance;
            if to - from == 1 {
                if may {
                    self.between(a, b);
                }
            } else if may || self.passes(&a, &b) {
                let middle = (from + to) / 2;
                let seen = self.look(at(middle), &[&a, &b]);
                self.count(&seen);
                self.open.push((middle, seen, to, b));
                self.open.push((from, a, middle, seen));
            }
        }
        self.found.deep_hairs += usize::from(self.found.deep > before);
    }

    fn count(&mut self, seen: &Seen) {
        self.found.deep += usize::from(seen.is_in() && seen.by > self.tolerance);
        self.note(seen);
    }

    fn note(&mut self, seen: &Seen) {
        if seen.is_in() && seen.by > self.deepest() {
            self.found.deepest = Some(self.place(seen, seen.by));
        }
    }

    fn deepest(&self) -> f64 {
        self.found.deepest.map_or(self.tolerance, |place| place.by)
    }

    /// Finds what is deeper than all before, between two samples.
    fn between(&mut self, a: Seen, b: Seen) {
        self.finer.push((a, b));
        while let Some((a, b)) = self.finer.pop() {
            if Self::most(&a, &b) <= self.deepest() + FOUND_TO {
                continue;
            }
            let middle = self.look(0.5 * (a.along + b.along), &[&a, &b]);
            self.note(&middle);
            self.finer.push((middle, b));
            self.finer.push((a, middle));
        }
    }

    fn place(&self, seen: &Seen, by: f64) -> Place {
        let spans = self.curve.spans();
        Place { by, hair: self.number, at: seen.p, along: seen.along, spans }
    }
}
