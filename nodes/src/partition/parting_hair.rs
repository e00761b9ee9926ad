//! One hair of the edge partition: its root, its end, and its path over the scalp.
//!
//! A row, its neighbour beside it, and the parting halfway between:
//!
//! ```text
//!   neighbour   ----------------------------->
//!   parting    . . . . . r . . . . . . . . . .     r  root, at u, half a parting's width inside
//!   row        ----------u-----------e-------->    e  end in the braid, pulled along from u
//! ```
//!
//! In the plane of the scalp, a hair is a parabola from root to end, straight or leaving the parting perpendicularly; in
//! height, it follows the skin and rises to its end in the braid.

use crate::data::ramp::Ramp;
use crate::data::route::makers::{lift, lift_each};
use crate::data::scalp::{Root, Scalp, Skin};
use crate::data::sections::Sections;
use crate::maths::closest::Hit;
use crate::maths::spline::{Spline, SplineParam};
use crate::maths::transcendental::{sin_cos, tan};
use crate::scalp::territory::{Row, Station, neighbour};
use glam::Vec3;
use std::cell::Cell;

/// Settings shared by all hairs of a run. Lengths in cm, angles in radians.
pub(crate) struct Rules<'a> {
    pub(crate) scalp: &'a Scalp,
    pub(crate) skin: Skin<'a>,
    /// What hairs are kept out of; none where the mesh has no clear inside ([`Skin::for_hair`]).
    pub(crate) for_hair: Option<Skin<'a>>,
    pub(crate) crossing: bool,
    pub(crate) parting: f32,
    pub(crate) reach: f32,
    pub(crate) open_side: f32,
    pub(crate) sweep: f32,
    pub(crate) tuck: f32,
    pub(crate) group_radius: f32,
    pub(crate) tightness: &'a Ramp,
    pub(crate) cvs: usize,
    /// Smallest height of a hair above the skin, except at its root.
    pub(crate) clear: f32,
}

impl Rules<'_> {
    /// So many rounds of a search; where folds and scraps make it jump, as many as come within a millimetre.
    fn rounds(&self, on_a_head: usize) -> usize {
        if self.for_hair.is_some() { on_a_head } else { on_a_head.min(4) }
    }
}

/// A row and what limits its hairs: other rows and, on a parted scalp, their common section.
pub(crate) struct RowTerritory<'a> {
    pub(crate) scalp: &'a Scalp,
    pub(crate) own: &'a Row,
    pub(crate) left: Vec<&'a Row>,
    pub(crate) right: Vec<&'a Row>,
    pub(crate) section: Option<RowSection<'a>>,
    /// The triangle found last: the next one is near it.
    pub(crate) near: Cell<u32>,
}

/// The section that a row lies in.
#[derive(Clone, Copy)]
pub(crate) struct RowSection<'a> {
    pub(crate) sections: &'a Sections,
    pub(crate) number: u32,
}

impl RowSection<'_> {
    /// Distance of a point inside the section and off the bare skin of its partings, cm; negative elsewhere.
    fn slack(&self, p: Vec3) -> f32 {
        match self.sections.at(p) {
            Some(place) if place.section == self.number => place.distance - place.bare,
            _ => -1.0,
        }
    }
}

/// Settings of one hair.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PartingHairParams {
    /// Fraction of the row beside which it is rooted; below 0 is in front of the row.
    pub(crate) u: f32,
    pub(crate) side: i32,
    /// 0 at the row, 0.5 halfway, 1 at the neighbour.
    pub(crate) mediate: f32,
    /// Angle from the perpendicular toward the row's tip, radians.
    pub(crate) pull: f32,
    pub(crate) lift: f32,
    /// Angle around the braid at which it ends: 0 at its side, a quarter turn on top, radians.
    pub(crate) round: f32,
}

/// Where a hair begins and would end by default.
#[derive(Clone, Copy, Debug)]
pub(crate) struct HairStart {
    pub(crate) root: Root,
    pub(crate) end_u: f32,
    /// How far along the row the end is pulled, as a fraction of its length.
    pulled: f32,
}

impl RowTerritory<'_> {
    fn beside(&self, side: i32) -> &[&Row] {
        if side < 0 { &self.left } else { &self.right }
    }
    /// How much closer `p` is to its own row than to any other.
    pub(crate) fn ahead(&self, p: Vec3) -> f32 {
        let mut other = f32::MAX.sqrt();
        for row in self.left.iter().chain(&self.right) {
            other = row.far_under(self.scalp, p, other);
        }
        other - self.to_own(p)
    }
    /// Twice the distance of `p` from the border of its territory, or less: it may move by half of that without leaving.
    fn margin(&self, p: Vec3) -> f32 {
        let section = self.section.as_ref().map_or(f32::MAX, |home| 2.0 * home.slack(p).max(0.0));
        section.min(self.ahead(p))
    }
    /// Whether `p` is in its own section, and closer to its own row than to any other by `slack`.
    fn is_in_section(&self, p: Vec3, slack: f32) -> bool {
        if self.section.as_ref().is_some_and(|home| home.slack(p) < 0.0) {
            return false;
        }
        let limit = self.to_own(p) + slack;
        let mut others = self.left.iter().chain(&self.right);
        others.all(|row| row.far_under(self.scalp, p, limit) >= limit)
    }
    /// The root below a point.
    fn root(&self, rules: &Rules, p: Vec3) -> Option<Root> {
        let mut near = self.near.get();
        let Hit { triangle, bary, .. } = rules.skin.foot(p, &mut near)?;
        self.near.set(near);
        Some(self.scalp.root(triangle, bary))
    }
    fn to_own(&self, p: Vec3) -> f32 {
        self.own.far(self.scalp, p, self.own.nearest(p).1)
    }
}

/// What lies beside a position of a row, on one side.
#[derive(Clone, Copy)]
struct Beside {
    /// Vector to the neighbour, or to where one would be.
    to: Vec3,
    /// Whether there is a neighbour.
    shared: bool,
    /// Index of the neighbour.
    who: usize,
    /// Scalp normal under the row.
    normal: Vec3,
    /// Largest fraction of the way at which hair may be rooted.
    most: f32,
}

/// What lies beside a row, sampled evenly along it for lookup by the hairs.
pub(crate) struct Reach {
    from: f32,
    per_u: f32,
    sides: [Vec<Option<Beside>>; 2],
}

/// Spacing of these samples, cm.
const LOOK: f32 = 0.2;

impl Reach {
    /// Samples a row from `lead` (a fraction of its length) in front of its root to its end.
    pub(crate) fn new(rules: &Rules, ground: &RowTerritory, lead: f32) -> Self {
        let n = (ground.own.length() * (1.0 + lead) / LOOK).ceil().clamp(4.0, 1000.0);
        let look = |side: i32| {
            let at = |k: usize| beside(rules, ground, (1.0 + lead) * k as f32 / n - lead, side);
            (0..=n as usize).map(at).collect()
        };
        Self { from: -lead, per_u: n / (1.0 + lead), sides: [look(-1), look(1)] }
    }
    /// What lies beside the row at `u`, if the surrounding samples agree.
    fn at(&self, u: f32, side: i32) -> Option<Beside> {
        let list = &self.sides[usize::from(side > 0)];
        let x = (u - self.from) * self.per_u;
        let i = (x as usize).min(list.len() - 2);
        let t = (x - i as f32).clamp(0.0, 1.0);
        let (a, b) = (list[i]?, list[i + 1]?);
        (a.shared == b.shared && a.who == b.who).then(|| Beside {
            to: a.to.lerp(b.to, t),
            normal: a.normal.lerp(b.normal, t),
            most: a.most + (b.most - a.most) * t,
            ..a
        })
    }
    /// What lies beside the nearer of the surrounding samples that has anything.
    fn about(&self, u: f32, side: i32) -> Option<Beside> {
        let list = &self.sides[usize::from(side > 0)];
        let x = (u - self.from) * self.per_u;
        let i = (x as usize).min(list.len() - 2);
        let (a, b) = (list[i], list[i + 1]);
        if x - i as f32 <= 0.5 { a.or(b) } else { b.or(a) }
    }
    /// Whether there is no territory on a side near `u`.
    fn is_bare(&self, u: f32, side: i32) -> bool {
        let list = &self.sides[usize::from(side > 0)];
        let i = (((u - self.from) * self.per_u) as usize).min(list.len() - 2);
        list[i].is_none() && list[i + 1].is_none()
    }
}

/// What lies on one side of a row at `u`; `None` if there is no territory, or none that is the row's own.
fn beside(rules: &Rules, ground: &RowTerritory, u: f32, side: i32) -> Option<Beside> {
    let station = Station::new(ground.own, rules.scalp, u);
    let way = station.side(side);
    let rows = ground.beside(side).iter().copied().enumerate();
    let met = neighbour(&station, side, rows, rules.reach);
    let met = met.map(|(who, q)| (q - station.point, true, who));
    let (to, shared, who) = if let Some(home) = &ground.section {
        // The border of the section takes the place of the parting halfway to a neighbour.
        let inside = |d: &f32| {
            let root = ground.root(rules, station.point + way * *d);
            root.is_some_and(|root| {
                home.slack(root.point) >= 0.0 && grows(rules.scalp, &root) >= 0.5
            })
        };
        let reach = met.map_or(rules.reach, |(to, ..)| 0.5 * to.length());
        let steps = (1..=64).map(|k| k as f32 * 0.1).take_while(|d| *d <= reach);
        let far = steps.clone().take_while(inside).count();
        match met.filter(|_| far == steps.count()) {
            Some(met) => met,
            None if far == 0 => return None,
            None => (way * (0.2 * (far + 1) as f32), true, BORDER),
        }
    } else {
        match met {
            Some(met) => met,
            None if rules.open_side > 0.0 => (way * (2.0 * rules.open_side), false, 0),
            None => return None,
        }
    };
    let mut found = Beside { to, shared, who, normal: station.normal, most: 1.0 };
    let at = |t: f32| place(rules, ground, &station, &found, t);
    let last = at(1.0)?;
    if last.1 < 0.0 {
        found.most = farthest(rules, at, 1.0, last.1)?.1;
    }
    Some(found)
}

/// Index that stands for the border of a section, if it is closer than a row.
const BORDER: usize = usize::MAX;

fn grows(scalp: &Scalp, root: &Root) -> f32 {
    scalp.grows(root.triangle, root.bary)
}

/// The root at a fraction of the way to what lies beside, and its remaining slack.
fn place(
    rules: &Rules,
    ground: &RowTerritory,
    station: &Station,
    beside: &Beside,
    t: f32,
) -> Option<(Root, f32)> {
    let root = ground.root(rules, station.point + beside.to * t)?;
    let slack = if rules.crossing {
        f32::MAX
    } else if let Some(home) = &ground.section {
        home.slack(root.point).min(ground.ahead(root.point) - rules.parting)
    } else if beside.shared {
        ground.ahead(root.point) - rules.parting
    } else {
        // No neighbour on this side: the territory ends where the parting would be.
        let edge = (0.5 - t) * 2.0 * rules.open_side - 0.5 * rules.parting;
        edge.min(ground.ahead(root.point) - rules.parting)
    };
    Some((root, slack.min(if grows(rules.scalp, &root) >= 0.5 { f32::MAX } else { -1.0 })))
}

/// The root of a hair; `None` if there is no territory on that side, or none that is the row's own.
pub(crate) fn start(
    rules: &Rules,
    ground: &RowTerritory,
    reach: &Reach,
    wish: &PartingHairParams,
) -> Option<HairStart> {
    // Among scraps and folds hardly two samples agree: one of them will do.
    let one = || reach.about(wish.u, wish.side).filter(|_| rules.for_hair.is_none());
    let (station, root) = match reach.at(wish.u, wish.side).or_else(one) {
        Some(found) => {
            let station = Station::with_normal(ground.own, wish.u, found.normal);
            let t = wish.mediate.min(found.most);
            let (root, slack) = place(rules, ground, &station, &found, t)?;
            if slack >= 0.0 {
                (station, root)
            } else {
                // The edge bends slightly between two samples: one more query from nearby.
                let at = |t: f32| place(rules, ground, &station, &found, t);
                (station, farthest(rules, at, t, slack)?.0)
            }
        }
        None if reach.is_bare(wish.u, wish.side) => return None,
        None => {
            let found = beside(rules, ground, wish.u, wish.side)?;
            let station = Station::with_normal(ground.own, wish.u, found.normal);
            let t = wish.mediate.min(found.most);
            (station, place(rules, ground, &station, &found, t)?.0)
        }
    };
    // The pull is measured from beside the root, not from the slanted line to the neighbour.
    let off = (root.point - station.point).reject_from_normalized(station.along).length();
    let pulled = tan(wish.pull) * off / ground.own.length();
    Some(HairStart { root, end_u: (wish.u + pulled).clamp(0.0, 1.0), pulled })
}

/// The farthest root with slack, and its fraction of the way, up to `most` (where the slack is `lack`); `None` if the
/// row itself has none.
fn farthest(
    rules: &Rules,
    at: impl Fn(f32) -> Option<(Root, f32)>,
    most: f32,
    lack: f32,
) -> Option<(Root, f32)> {
    let (mut low, mut high) = (0.0, most);
    let (mut found, mut slack) = at(0.0)?;
    let mut lack = lack;
    if slack < 0.0 {
        return None;
    }
    for round in 0..rules.rounds(12) {
        // Between two rows the slack falls nearly linearly, so interpolation is a good guess; bisection every other
        // time keeps it safe at the edge of the hair, where the slack jumps.
        let part = if round % 2 == 0 { slack / (slack - lack) } else { 0.5 };
        let t = low + (high - low) * part.clamp(0.02, 0.98);
        match at(t) {
            Some((root, s)) if s >= 0.0 => (low, slack, found) = (t, s, root),
            other => (high, lack) = (t, other.map_or(-1.0, |(_, s)| s)),
        }
        if slack < NEAR_ENOUGH {
            break;
        }
    }
    Some((found, low))
}

/// Tolerance of the position of such a root, cm.
const NEAR_ENOUGH: f32 = 0.002;

/// Where hairs end in the braid.
#[derive(Clone, Copy, Debug)]
pub(crate) struct HairEnd {
    pub(crate) point: Vec3,
    along: Vec3,
    out: Vec3,
    axis: Vec3,
    radius: f32,
}

/// The point in the braid, at fraction `u` of the row and angle `round`, where hairs from `start` end; `radius` is the
/// braid's there.
pub(crate) fn end(
    rules: &Rules,
    row: &Row,
    start: &Root,
    u: f32,
    (side, round): (i32, f32),
    radius: f32,
) -> HairEnd {
    let station = Station::new(row, rules.scalp, u);
    let (sin, cos) = sin_cos(round);
    let out = station.side(side) * cos + station.normal * sin;
    // A root closer than the braid's side still leaves room for a hair.
    let off = (radius - rules.tuck).max(0.0).min(0.6 * start.point.distance(station.point));
    let point = station.point + out * off;
    let point = rules.for_hair.map_or(point, |skin| lift(&skin, point, rules.clear).0);
    HairEnd { point, along: station.along, out, axis: station.point, radius }
}

impl HairEnd {
    /// A point of the group around this end; `spread` holds three numbers in [-1, 1].
    pub(crate) fn within(&self, rules: &Rules, spread: Vec3) -> Vec3 {
        let ball = spread / spread.length().max(1.0) * rules.group_radius;
        let across = self.along.cross(self.out);
        let p = self.point + self.along * ball.x + self.out * -ball.y.abs() + across * ball.z;
        let flat = (p - self.axis).reject_from_normalized(self.along);
        let p =
            if flat.length() > 0.98 * self.radius { self.point + self.along * ball.x } else { p };
        let lifted = rules.for_hair.map_or(p, |skin| lift(&skin, p, rules.clear).0);
        if lifted.distance(self.point) <= rules.group_radius { lifted } else { self.point }
    }
}

/// The centre hair of a group.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Middle {
    root: Vec3,
    pub(crate) end: HairEnd,
}

/// The hair without randomness that ends at the fraction `wish.u` of the row; `radius` is the braid's there.
pub(crate) fn middle(
    rules: &Rules,
    ground: &RowTerritory,
    reach: &Reach,
    wish: &PartingHairParams,
    radius: f32,
) -> Option<Middle> {
    let beside = start(rules, ground, reach, wish)?;
    let before = PartingHairParams { u: (wish.u - beside.pulled).max(0.0), ..*wish };
    let root = start(rules, ground, reach, &before).unwrap_or(beside).root;
    let end = end(rules, ground.own, &root, wish.u, (wish.side, wish.round), radius);
    Some(Middle { root: root.point, end })
}

/// Writes the `rules.cvs` points of a hair, root first, into `points`; the end comes with the row's direction there.
/// False if root and end coincide.
pub(crate) fn way(
    rules: &Rules,
    ground: &RowTerritory,
    root: &Root,
    (end, along): (Vec3, Vec3),
    lift: f32,
    group: Option<&Middle>,
    points: &mut Vec<Vec3>,
) -> bool {
    points.clear();
    if root.point.distance(end) < 1e-3 {
        return false;
    }
    let bow = |from: Vec3, to: Vec3, s: f32| {
        let corner = to - along * (to - from).dot(along);
        let middle = ((from + to) * 0.5).lerp(corner, rules.sweep);
        from.lerp(middle, s).lerp(middle.lerp(to, s), s)
    };
    let mut feeler = Feeler { skin: &rules.skin, near: root.triangle };
    // Among scraps there is nothing to lie on: from root to end it goes through the air.
    let lies = !rules.skin.has_no_inside();
    let end_height = if lies { feeler.height(end) } else { 0.0 };
    // On a bumpy scalp the smooth normal does not point exactly at the end.
    let aside = if lies { end - feeler.laid(end, end_height).0 } else { Vec3::ZERO };
    feeler.near = root.triangle;
    // While the last verified point is farther inside than this, the next one cannot have left.
    let (mut known, mut sure) = (root.point, 0.0f32);
    let fine = rules.cvs + 2;
    // The centre hair is joined at an equal distance from the end, so that a hair rooted closer to the braid does not
    // first run back to the centre hair's root.
    let part =
        group.map_or(1.0, |g| root.point.distance(end) / g.root.distance(g.end.point).max(1e-3));
    // A hair that approaches the end from the other direction would overshoot it, so it runs separately.
    let same_way = group.map_or(0.0, |g| {
        let (own, middle) = (end - root.point, g.end.point - g.root);
        own.normalize_or_zero().dot(middle.normalize_or_zero()).max(0.0)
    });
    points.push(root.point);
    for k in 1..fine {
        let s = k as f32 / fine as f32;
        let mut p = bow(root.point, end, s);
        if let Some(group) = group {
            let pulled = rules.tightness.at(s).clamp(0.0, 1.0) * (5.0 * s).min(1.0) * same_way;
            let met = (1.0 - (1.0 - s) * part).max(0.0);
            // Hairs of a group end beside each other, so they run beside the centre hair.
            let beside = (end - group.end.point) * s;
            p = p.lerp(bow(group.root, group.end.point, met) + beside, pulled);
        }
        let height = lift * 4.0 * s * (1.0 - s) + end_height * s * s;
        let height = height.max(rules.clear * (s * 8.0).min(1.0));
        if !rules.crossing && 2.0 * p.distance(known) > sure {
            p = kept_in_section(rules, ground, p, 0.25 * rules.parting);
            (known, sure) = (p, (ground.margin(p) - 0.25 * rules.parting).min(SURE));
        }
        points.push(match lies {
            true => feeler.laid(p, height).0 + aside * (s * s),
            false => p + root.normal * height,
        });
    }
    points.push(end);
    let mut spline = Spline::default();
    // Lifting a point makes its neighbours uneven, and evening out may sink one: a few rounds settle both.
    for round in 0..ROUNDS {
        if spline.rebuild(points).is_err() {
            return false;
        }
        points.clear();
        spline.resample(rules.cvs, |p| points.push(p));
        points[0] = root.point;
        points[rules.cvs - 1] = end;
        let goes_on = round + 1 < ROUNDS && rules.for_hair.is_some();
        if !goes_on || !lifted(rules, &mut spline, points, root.triangle) {
            break;
        }
    }
    // In folds that a few rounds do not resolve, and on ridges between two samples, at least the points are out of the
    // skin.
    if let Some(skin) = rules.for_hair {
        lift_each(&skin, points, 1..rules.cvs - 1, |_| 0.0);
    }
    // A border may protrude between two points that are inside.
    let stays = |home: &RowSection| points.windows(2).all(|w| !home.sections.crosses(w[0], w[1]));
    rules.crossing || ground.section.as_ref().is_none_or(stays)
}

/// A point within half of this (cm) of one that is inside is inside as well: over the scalp and past an ear, distances
/// change faster than straight ones.
const SURE: f32 = 0.5;

/// Rounds in which a hair is lifted and made even.
const ROUNDS: usize = 6;

/// Queries the scalp below a sequence of nearby points.
struct Feeler<'a> {
    skin: &'a Skin<'a>,
    near: u32,
}

impl Feeler<'_> {
    fn hit(&mut self, p: Vec3) -> Option<Hit> {
        self.skin.foot(p, &mut self.near)
    }
    /// Height of a point above the skin, cm.
    fn height(&mut self, p: Vec3) -> f32 {
        self.hit(p).map_or(0.0, |hit| self.skin.height_over(p, &hit))
    }
    /// [`crate::scalp::lay::laid`].
    fn laid(&mut self, p: Vec3, height: f32) -> (Vec3, Vec3) {
        match self.hit(p) {
            Some(hit) => {
                let normal = self.skin.smooth_normal(&hit);
                (hit.point + normal * height, normal)
            }
            None => (p, Vec3::ZERO),
        }
    }
}

/// `p`, or a point toward its own row that is at least `slack` closer to it than to any other.
fn kept_in_section(rules: &Rules, ground: &RowTerritory, p: Vec3, slack: f32) -> Vec3 {
    if ground.is_in_section(p, slack) {
        return p;
    }
    let home = ground.own.nearest(p).0;
    let (mut out, mut back) = (0.0, 1.0);
    for _ in 0..rules.rounds(8) {
        let middle = 0.5 * (out + back);
        if ground.is_in_section(p.lerp(home, middle), slack) { back = middle } else { out = middle }
    }
    p.lerp(home, back)
}

/// Lifts points where the curve between them is below the skin; returns whether any was lifted.
fn lifted(rules: &Rules, spline: &mut Spline, points: &mut [Vec3], near: u32) -> bool {
    let mut feeler = Feeler { skin: &rules.skin, near };
    let n = points.len();
    if spline.rebuild(points).is_err() {
        return false;
    }
    let mut any = false;
    for span in 0..n - 1 {
        // The root stays, so its span moves only with its other end, and is sampled close to the root.
        let at: &[f32] = if span == 0 { &[0.08, 0.2, 0.5] } else { &[0.33, 0.67] };
        for &t in at {
            let p = spline.point(SplineParam { span, t });
            let wanted = rules.clear * if span == 0 { 0.1 * t } else { 0.1 };
            let low = wanted - feeler.height(p);
            if low > 0.0 {
                any = true;
                let lever = if span == 0 { (1.0 / t).min(6.0) } else { 1.5 };
                let up = feeler.laid(p, 0.0).1 * (lever * low + 0.2 * rules.clear);
                for k in [span, span + 1] {
                    if k > 0 && k < n - 1 {
                        points[k] += up;
                    }
                }
            }
        }
    }
    any
}
