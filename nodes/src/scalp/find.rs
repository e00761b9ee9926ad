//! Finds which connected piece of a mesh is the head, its cranium and its face.
//!
//! Avatars come with hair, hats and glasses. A sphere fitted to all of them fits the hair, not the head, so every large
//! piece is tried alone: the one with a whole cranium and a face is the head. If the whole mesh gives the same result,
//! that result is used.
//!
//! Guarantees: bounded work for any mesh ([`MOST_TRIED`] pieces). Not promised: a head in one piece with what stands on
//! it gets the sphere of both; [`Fit::is_bare`] detects that.

use super::axes::Up;
use super::face::{self, By, FACE, Face};
use super::fit::{self, Fit, Patches};
use super::sketch::MeshSamples;
use crate::define::NodeError;
use glam::{DVec3, Vec3};
use std::borrow::Cow;

/// Connected pieces of a mesh: triangles that share vertices.
pub(crate) struct Pieces {
    /// The piece of each triangle.
    pub(crate) of: Vec<u32>,
    /// The area of each piece, largest first, in squared mesh units.
    areas: Vec<f64>,
    /// Triangles sorted by piece, and the start of each piece.
    sorted: Vec<u32>,
    starts: Vec<u32>,
}

/// Number of the largest pieces that are tried.
const MOST_TRIED: usize = 24;
/// Number of the largest pieces that are left out, one at a time, while all others are tried together.
const MOST_WITHOUT: usize = 8;
/// A candidate with this likeness to a face in the rough test may be one after a closer look ...
const PROMISING: f32 = 0.4;
/// ... and this many of the likeliest are examined ...
const MOST_LOOKED_AT: usize = 4;
/// ... as long as they may beat the best one found: the rough test is off by less than this ...
const DOUBT: f32 = 0.15;
/// ... and, except for the likeliest, as long as fewer cells than this were examined; a face costs as much as this
/// many.
const MOST_SPENT: usize = 24_000_000;
const COST_OF_A_FACE: usize = 2_000_000;
/// A candidate with this likeness in the rough test, this many radii away from a head, is another head.
const SURELY: f32 = 0.65;
const APART: f32 = 1.5;
/// What lies nearer to the axis through one of several heads than this belongs to it, in radii.
const BESIDE: f32 = 2.0;
/// Smallest area of a head relative to the largest piece: a head has a tenth of a dressed body, and an eye a fiftieth
/// of a head.
const LEAST_AREA: f64 = 0.025;
/// Fraction of the sphere's upper half that a whole cranium covers.
const WHOLE: f32 = 0.85;
/// The sphere of the whole mesh is used if it agrees with that of the head alone to this many radii ...
const SAME_SPHERE: f32 = 0.002;
/// ... and the directions of the face to this cosine: 10 degrees.
const SAME_FACE: f32 = 0.985;

/// The result of a search for the head.
#[derive(Clone, Debug, Default)]
pub(crate) struct FoundHead {
    /// The cranium; `None` if no sphere fits.
    pub(crate) fit: Option<Fit>,
    /// The face; `None` if nothing resembles one.
    pub(crate) face: Option<Face>,
    /// The piece that is the head; `None` if no single piece is.
    pub(crate) piece: Option<u32>,
    /// Other pieces that are also heads.
    pub(crate) others: Vec<u32>,
    /// Centres of other heads in the same piece, or anywhere where it is no piece of its own; with the same axis up.
    pub(crate) joined: Vec<Vec3>,
}

/// What a piece looks like at a glance.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Look {
    /// A head: a cranium with a face, and nothing above it that is no hat.
    Head,
    /// A cranium above which the mesh goes on, as it does above a knee.
    Beneath,
    /// A cranium without a face.
    Round,
}

impl FoundHead {
    /// Whether it has a whole cranium, and a face in its mirror plane.
    pub(crate) fn is_sure(&self) -> bool {
        self.likeness() >= FACE
            && self.fit.is_some_and(|fit| fit.cover >= WHOLE)
            && self.face.is_some_and(|face| face.by == By::Mirror)
    }
    /// Whether nothing stands on its crown.
    pub(crate) fn is_bare(&self) -> bool {
        self.fit.is_some_and(|fit| fit.is_bare())
    }
    /// Likeness of its face; -1 without a face or cranium.
    pub(crate) fn likeness(&self) -> f32 {
        match (&self.fit, &self.face) {
            (Some(fit), Some(face)) if fit.head_like() => face.likeness,
            _ => -1.0,
        }
    }
    fn agrees(&self, other: &Self) -> bool {
        let (Some(a), Some(b)) = (self.fit, other.fit) else { return false };
        let (Some(face), Some(other)) = (self.face, other.face) else { return false };
        let off = a.centre.distance(b.centre).max((a.radius - b.radius).abs());
        off < SAME_SPHERE * b.radius && face.looks.dot(other.looks) > SAME_FACE
    }
}

/// A part of a mesh.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Which {
    Whole,
    Only(u32),
    Without(u32),
}

impl Which {
    fn keeps(self, piece: u32) -> bool {
        match self {
            Self::Whole => true,
            Self::Only(only) => piece == only,
            Self::Without(without) => piece != without,
        }
    }
}

/// A mesh to find a head in, and the remaining work budget.
pub(crate) struct Search<'a> {
    /// In the file's axes.
    points: &'a [Vec3],
    triangles: &'a [[u32; 3]],
    pieces: &'a Pieces,
    sketch: MeshSamples,
    spent: usize,
}

/// Candidates with one axis up: the mesh's points, and each part that may be a head, likeliest first, with its score.
pub(crate) struct Tried {
    up: Up,
    points: Vec<Vec3>,
    seeming: Vec<Seeming>,
    /// All that have a cranium, in the order of pieces.
    all: Vec<Seeming>,
}

/// A part of the mesh that may be a head: its score, and its sphere from the rough test.
#[derive(Clone, Copy)]
struct Seeming {
    which: Which,
    likeness: f32,
    fit: Fit,
    /// Whether the mesh goes on above it: no head.
    beneath: bool,
}

impl Tried {
    /// The pieces that have a cranium, with what they look like.
    pub(crate) fn looks(&self) -> impl Iterator<Item = (u32, Look)> {
        self.all.iter().filter_map(|seeming| {
            let Which::Only(piece) = seeming.which else { return None };
            let look = match seeming {
                Seeming { beneath: true, .. } => Look::Beneath,
                seeming if seeming.is_head() => Look::Head,
                _ => Look::Round,
            };
            Some((piece, look))
        })
    }
    /// Score of the likeliest part; -1 if there is none.
    pub(crate) fn promises(&self) -> f32 {
        self.seeming.first().map_or(-1.0, |seeming| seeming.likeness)
    }
    /// The axis that is up.
    pub(crate) fn up(&self) -> Up {
        self.up
    }
}

impl<'a> Search<'a> {
    /// Searches a mesh with `points` in the file's axes.
    pub(crate) fn new(points: &'a [Vec3], triangles: &'a [[u32; 3]], pieces: &'a Pieces) -> Self {
        let sketch = MeshSamples::of(points, triangles, pieces);
        Self { points, triangles, pieces, sketch, spent: 0 }
    }

    /// Number of cells examined so far, and the cost of faces in cells.
    #[cfg(test)]
    pub(crate) fn spent(&self) -> usize {
        self.spent
    }

    /// The rough test with one axis up. `check` is called now and then and may stop the work.
    pub(crate) fn try_up(
        &self,
        up: Up,
        check: &impl Fn() -> Result<(), NodeError>,
    ) -> Result<Tried, NodeError> {
        let points: Vec<Vec3> = self.points.iter().map(|p| up.turned(*p)).collect();
        let mut tried = Tried { up, points, seeming: vec![], all: vec![] };
        let mut parts = vec![Which::Whole];
        if self.pieces.count() > 1 {
            parts.extend(self.pieces.large().map(Which::Only));
        }
        tried.all = self.seeming(&tried, parts.into_iter(), check)?;
        tried.seeming = most(tried.all.clone());
        Ok(tried)
    }

    /// Parts that have a cranium.
    fn seeming(
        &self,
        tried: &Tried,
        parts: impl Iterator<Item = Which>,
        check: &impl Fn() -> Result<(), NodeError>,
    ) -> Result<Vec<Seeming>, NodeError> {
        let mut seeming = vec![];
        for which in parts {
            check()?;
            if let Some(fit) = self.sketch.cranium(tried.up, |piece| which.keeps(piece)) {
                let (points, triangles) = self.mesh(tried, which);
                let likeness = face::glimpse(&points, &triangles, &fit, false);
                let alone = matches!(which, Which::Only(_));
                let beneath = alone && self.sketch.goes_on_above(tried.up, &fit);
                seeming.push(Seeming { which, likeness, fit, beneath });
            }
        }
        Ok(seeming)
    }

    fn mesh<'t>(
        &'t self,
        tried: &'t Tried,
        which: Which,
    ) -> (Cow<'t, [Vec3]>, Cow<'t, [[u32; 3]]>) {
        let (points, triangles) = match which {
            Which::Whole => return (Cow::Borrowed(&tried.points), Cow::Borrowed(self.triangles)),
            Which::Only(piece) => {
                let own = self.pieces.triangles(piece).map(|t| &self.triangles[t]);
                only(&tried.points, own)
            }
            Which::Without(piece) => {
                let kept = self.triangles.iter().zip(&self.pieces.of);
                let kept = kept.filter(|(_, of)| **of != piece).map(|(t, _)| t);
                only(&tried.points, kept)
            }
        };
        (Cow::Owned(points), Cow::Owned(triangles))
    }

    /// A part of the mesh, examined as a head.
    fn one(
        &mut self,
        tried: &Tried,
        which: Which,
        check: &impl Fn() -> Result<(), NodeError>,
    ) -> Result<FoundHead, NodeError> {
        check()?;
        let (points, triangles) = self.mesh(tried, which);
        let (found, spent) = examined(&points, &triangles, check)?;
        drop((points, triangles));
        self.spent += spent;
        Ok(found)
    }

    /// Heads that stand beside one another in one piece, or anywhere, highest first, each with its likeness to a face.
    fn joined(
        &self,
        tried: &Tried,
        piece: Option<u32>,
        check: &impl Fn() -> Result<(), NodeError>,
    ) -> Result<Vec<Seeming>, NodeError> {
        let mut heads = vec![];
        let whole = self.sketch.craniums(tried.up, piece).into_iter();
        for fit in whole.filter(|fit| fit.cover >= WHOLE) {
            check()?;
            let (points, triangles) = self.near(tried, &fit);
            let likeness = face::glimpse(&points, &triangles, &fit, false);
            let beneath = self.sketch.goes_on_above(tried.up, &fit);
            heads.push(Seeming { which: Which::Whole, likeness, fit, beneath });
        }
        heads.retain(Seeming::is_head);
        Ok(heads)
    }

    /// The mesh about a cranium, and no other head.
    fn near(&self, tried: &Tried, fit: &Fit) -> (Vec<Vec3>, Vec<[u32; 3]>) {
        let is_near = |v: &u32| {
            let off = (tried.points[*v as usize] - fit.centre) / fit.radius;
            off.with_y(0.0).length() <= BESIDE && off.y.abs() <= 2.0 * BESIDE
        };
        only(&tried.points, self.triangles.iter().filter(|t| t.iter().all(is_near)))
    }

    /// The likeliest of several heads that stand beside one another with this axis up, where the whole mesh shows none.
    pub(crate) fn one_of_many(
        &mut self,
        tried: &Tried,
        check: &impl Fn() -> Result<(), NodeError>,
    ) -> Result<Option<FoundHead>, NodeError> {
        let heads = self.joined(tried, None, check)?;
        if heads.len() < 2 {
            return Ok(None);
        }
        for head in most(heads) {
            let (points, triangles) = self.near(tried, &head.fit);
            let (found, spent) = examined(&points, &triangles, check)?;
            self.spent += spent;
            if found.is_sure() && found.is_bare() {
                let piece = (self.pieces.count() == 1).then_some(0);
                return Ok(Some(FoundHead { piece, ..found }));
            }
        }
        Ok(None)
    }

    /// The head that was found, with what other heads are in its piece.
    pub(crate) fn with_joined(
        &self,
        tried: &Tried,
        found: FoundHead,
        check: &impl Fn() -> Result<(), NodeError>,
    ) -> Result<FoundHead, NodeError> {
        let Some(fit) = found.fit else { return Ok(found) };
        let heads = self.joined(tried, found.piece, check)?;
        let others = heads.iter().filter(|head| head.is_besides(&fit));
        Ok(FoundHead { joined: others.map(|head| head.fit.centre).collect(), ..found })
    }

    /// Whether a cranium stands on something.
    pub(crate) fn has_neck(&self, tried: &Tried, fit: &Fit) -> bool {
        self.sketch.has_neck(tried.up, fit)
    }

    /// The best of these candidates; `None` if none is a head. A candidate that is far more likely than the later ones
    /// can be is accepted at once.
    fn best(
        &mut self,
        tried: &Tried,
        seeming: &[Seeming],
        more_than: f32,
        check: &impl Fn() -> Result<(), NodeError>,
    ) -> Result<Option<(Which, FoundHead)>, NodeError> {
        let mut best: Option<(Which, FoundHead)> = None;
        for (k, Seeming { which, likeness: seems, .. }) in seeming.iter().enumerate() {
            let before = best.as_ref().map_or(more_than, |(_, best)| best.likeness());
            if (k > 0 && self.spent > MOST_SPENT) || before >= seems + DOUBT {
                break;
            }
            let found = self.one(tried, *which, check)?;
            let likeness = found.likeness();
            // Of equal candidates, the first piece.
            let first = best.as_ref().is_some_and(|(other, _)| *which < *other);
            if found.is_sure() && (likeness > before || (likeness == before && first)) {
                best = Some((*which, found));
            }
        }
        Ok(best)
    }

    /// The head of the mesh. `likely` (whether there is one) sets how much is tried.
    pub(crate) fn head(
        &mut self,
        tried: &Tried,
        likely: bool,
        check: &impl Fn() -> Result<(), NodeError>,
    ) -> Result<FoundHead, NodeError> {
        let seems = tried.seeming.iter().any(|seeming| seeming.which == Which::Whole);
        let whole = match likely || (seems && self.spent <= MOST_SPENT) {
            true => self.one(tried, Which::Whole, check)?,
            false => FoundHead::default(),
        };
        let large = self.pieces.large();
        if self.pieces.count() <= 1 {
            return Ok(FoundHead { piece: whole.is_sure().then_some(0), ..whole });
        }
        let pieces = tried.seeming.iter().filter(|seeming| seeming.which != Which::Whole);
        let pieces: Vec<Seeming> = pieces.copied().collect();
        if let Some((Which::Only(piece), best)) = self.best(tried, &pieces, -1.0, check)? {
            let found = if whole.agrees(&best) { whole } else { best };
            let others = tried.all.iter();
            let others = others.filter(|other| found.fit.is_some_and(|fit| other.is_besides(&fit)));
            let others = others.filter_map(|other| match other.which {
                Which::Only(other) => Some(other),
                _ => None,
            });
            return Ok(FoundHead { piece: Some(piece), others: others.collect(), ..found });
        }
        // No piece alone is a head, as when face and skull are separate: one piece may be in the way of the others.
        let mut best = whole;
        if !likely || (best.is_sure() && best.is_bare()) {
            return Ok(best);
        }
        let without = large.clone().take(MOST_WITHOUT).map(Which::Without);
        let seeming = most(self.seeming(tried, without, check)?);
        if let Some((_, found)) = self.best(tried, &seeming, best.likeness() + 0.05, check)? {
            best = found;
        }
        // A head may be cut off under its hair. The sphere is then the hair's, and the face still the head's.
        if let Some(fit) = best.fit.filter(|fit| fit.head_like() && best.likeness() < FACE) {
            let mut seeming = vec![];
            for which in large.map(Which::Only) {
                check()?;
                let (points, triangles) = self.mesh(tried, which);
                let likeness = face::glimpse(&points, &triangles, &fit, true);
                seeming.push(Seeming { which, likeness, fit, beneath: false });
            }
            for Seeming { which, .. } in most(seeming) {
                let (points, triangles) = self.mesh(tried, which);
                let face = face::face(&points, &triangles, &fit);
                let likeness = face.map_or(-1.0, |face| face.likeness);
                if likeness >= FACE && likeness > best.likeness() {
                    best.face = face;
                }
            }
        }
        Ok(best)
    }
}

impl Seeming {
    /// Whether it is clearly a head.
    fn is_head(&self) -> bool {
        let is_whole = self.fit.head_like() && self.fit.cover >= WHOLE;
        is_whole && self.likeness >= SURELY && !self.beneath
    }
    /// Whether it is clearly a head, and a different one from that of this cranium.
    fn is_besides(&self, fit: &Fit) -> bool {
        let apart = self.fit.centre.distance(fit.centre) / fit.radius;
        self.is_head() && apart > APART && (0.5..2.0).contains(&(self.fit.radius / fit.radius))
    }
}

/// The likeliest candidates, best first.
fn most(mut seeming: Vec<Seeming>) -> Vec<Seeming> {
    seeming.retain(|seeming| seeming.likeness >= PROMISING && !seeming.beneath);
    seeming.sort_by(|a, b| b.likeness.total_cmp(&a.likeness).then(a.which.cmp(&b.which)));
    seeming.truncate(MOST_LOOKED_AT);
    seeming
}

impl Pieces {
    /// The pieces of a mesh.
    pub(crate) fn of(points: &[Vec3], triangles: &[[u32; 3]]) -> Self {
        let mut to: Vec<u32> = (0..points.len() as u32).collect();
        fn root(to: &mut [u32], mut v: u32) -> u32 {
            while to[v as usize] != v {
                to[v as usize] = to[to[v as usize] as usize];
                v = to[v as usize];
            }
            v
        }
        let has_area = |t: &&[u32; 3]| {
            let [a, b, c] = t.map(|v| points[v as usize].as_dvec3());
            (b - a).cross(c - a) != DVec3::ZERO
        };
        for [a, b, c] in triangles.iter().filter(has_area) {
            for v in [b, c] {
                let (x, y) = (root(&mut to, *a), root(&mut to, *v));
                to[x.max(y) as usize] = x.min(y);
            }
        }
        let of: Vec<u32> = triangles.iter().map(|t| root(&mut to, t[0])).collect();
        // One for each vertex, for a mesh may have as many pieces as triangles.
        let mut areas = vec![None; points.len()];
        for (t, piece) in triangles.iter().zip(&of) {
            let [a, b, c] = t.map(|v| points[v as usize].as_dvec3());
            let area = areas[*piece as usize].get_or_insert(0.0);
            *area += 0.5 * DVec3::length((b - a).cross(c - a));
        }
        let pieces = (0..).zip(areas).filter_map(|(vertex, area)| Some((vertex, area?)));
        let mut sorted: Vec<(u32, f64)> = pieces.collect();
        sorted.sort_unstable_by(|a, b| b.1.total_cmp(&a.1).then(a.0.cmp(&b.0)));
        for (rank, (vertex, _)) in (0..).zip(&sorted) {
            to[*vertex as usize] = rank;
        }
        let of: Vec<u32> = of.into_iter().map(|vertex| to[vertex as usize]).collect();
        let areas: Vec<f64> = sorted.into_iter().map(|(_, area)| area).collect();
        let mut starts = vec![0; areas.len() + 1];
        of.iter().for_each(|piece| starts[*piece as usize + 1] += 1);
        for piece in 1..starts.len() {
            starts[piece] += starts[piece - 1];
        }
        let (mut next, mut sorted) = (starts.clone(), vec![0; of.len()]);
        for (t, piece) in (0u32..).zip(&of) {
            sorted[next[*piece as usize] as usize] = t;
            next[*piece as usize] += 1;
        }
        Self { of, areas, sorted, starts }
    }

    /// The triangles of a piece, in their order.
    fn triangles(&self, piece: u32) -> impl Iterator<Item = usize> {
        let from = self.starts[piece as usize] as usize..self.starts[piece as usize + 1] as usize;
        self.sorted[from].iter().map(|t| *t as usize)
    }
    /// How many there are.
    pub(crate) fn count(&self) -> usize {
        self.areas.len()
    }
    /// Pieces large enough to be a head.
    pub(crate) fn large(&self) -> std::ops::Range<u32> {
        let least = LEAST_AREA * self.areas.first().copied().unwrap_or(0.0);
        let large = self.areas.iter().take(MOST_TRIED).filter(|area| **area >= least);
        0..large.count() as u32
    }
}

/// A mesh, examined as a head; also what that cost.
fn examined(
    points: &[Vec3],
    triangles: &[[u32; 3]],
    check: &impl Fn() -> Result<(), NodeError>,
) -> Result<(FoundHead, usize), NodeError> {
    let mut spent = COST_OF_A_FACE;
    let fit = fit::cranium(points, triangles, &mut spent, check)?;
    let is_head = fit.filter(Fit::head_like);
    let face = is_head.and_then(|fit| face::face(points, triangles, &fit));
    Ok((FoundHead { fit, face, ..FoundHead::default() }, spent))
}

/// A mesh of only some triangles.
fn only<'t>(
    points: &[Vec3],
    triangles: impl Iterator<Item = &'t [u32; 3]>,
) -> (Vec<Vec3>, Vec<[u32; 3]>) {
    const NEW: u32 = u32::MAX;
    let (mut to, mut kept) = (vec![NEW; points.len()], vec![]);
    let own = triangles.map(|t| {
        t.map(|v| {
            if to[v as usize] == NEW {
                to[v as usize] = kept.len() as u32;
                kept.push(points[v as usize]);
            }
            to[v as usize]
        })
    });
    let own = own.collect();
    (kept, own)
}

/// Parts over the crown count up to this distance from the centre, in radii ...
const REACH: f32 = 2.5;
/// ... and from this distance off the skin: anything nearer is a second scalp that hair is to grow on.
const OVER: f32 = 0.04;

/// For each triangle, the patches of the sphere in which it stands over the crown, one bit each; none for skin.
pub(crate) fn over_the_crown(
    points: &[Vec3],
    triangles: &[[u32; 3]],
    fit: &Fit,
    is_skin: impl Fn(usize) -> bool,
) -> Vec<u128> {
    let points: Vec<Vec3> = points.iter().map(|p| (*p - fit.centre) / fit.radius).collect();
    let cells = fit::cells(&points, triangles, 0.0, 2.0 * fit::CELL);
    let (mut skin, mut others) = ([0.0f32; Patches::COUNT], vec![]);
    for cell in &cells {
        let (far, is_skin) = (cell.at.length(), is_skin(cell.of as usize));
        if !is_skin && !(OVER..REACH).contains(&far) {
            continue;
        }
        match Patches::above(cell.at) {
            Some(at) if is_skin => skin[at] = skin[at].max(far),
            Some(at) => others.push((cell.of, far, at)),
            None => {}
        }
    }
    let mut over = vec![0; triangles.len()];
    for (of, far, at) in others {
        if (skin[at] + OVER..REACH).contains(&far) {
            over[of as usize] |= 1 << at;
        }
    }
    over
}
