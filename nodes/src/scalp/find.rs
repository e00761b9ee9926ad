//! Which of a mesh's pieces is the head, where its cranium is and where its face looks.
//!
//! Avatars bring hair, hats and glasses of their own. A sphere laid through all of them is the hair's and not the head's, so
//! every large piece is tried alone: the one that has a whole cranium and a face is the head. Where the whole mesh gives the same
//! answer, that one stands.
//!
//! Guarantees: bounded work for any mesh ([`MOST_TRIED`] pieces). Not promised: a head that is one piece with what stands
//! on it has the sphere of both; [`Fit::is_bare`] tells.

use super::face::{self, By, FACE, Face};
use super::fit::{self, Fit, Patches};
use crate::define::NodeError;
use glam::{DVec3, Vec3};
use std::collections::BTreeMap;

/// What hangs together by common vertices.
pub(crate) struct Pieces {
    /// The piece of each triangle.
    pub(crate) of: Vec<u32>,
    /// The area of each piece, largest first, in squares of the mesh's units.
    areas: Vec<f64>,
}

/// So many of the largest pieces are tried.
const MOST_TRIED: usize = 24;
/// Without so many of the largest, each by itself, all the others are tried.
const MOST_WITHOUT: usize = 8;
/// A head has at least this share of the surface of the largest: of a dressed body it has a tenth, and an eye a fiftieth of it.
const LEAST_AREA: f64 = 0.025;
/// So much of the sphere's upper half is covered by a whole cranium.
const WHOLE: f32 = 0.85;
/// The sphere of the whole mesh stands where it is as near as this to that of the head alone, in radii ...
const SAME_SPHERE: f32 = 0.002;
/// ... and the face so near, as a cosine: 10 degrees.
const SAME_FACE: f32 = 0.985;

/// A head as it was found.
#[derive(Clone, Debug, Default)]
pub(crate) struct Found {
    /// The cranium; none where no sphere fits.
    pub(crate) fit: Option<Fit>,
    /// The face; none where there is nothing to take for one.
    pub(crate) face: Option<Face>,
    /// The piece that is the head; none where none is by itself.
    pub(crate) piece: Option<u32>,
}

impl Found {
    /// Whether it has a whole cranium, and a face in the plane that it mirrors in.
    pub(crate) fn is_sure(&self) -> bool {
        self.likeness() >= FACE
            && self.fit.is_some_and(|fit| fit.cover >= WHOLE)
            && self.face.is_some_and(|face| face.by == By::Mirror)
    }
    /// Whether nothing stands on its crown.
    pub(crate) fn is_bare(&self) -> bool {
        self.fit.is_some_and(|fit| fit.is_bare())
    }
    /// How much its face is like one; -1 where it has none or no cranium.
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

/// The head of a mesh, Y up. Whether it is `likely` that there is one says how much is tried. `check` is called now and then
/// and may stop the work.
pub(crate) fn head(
    points: &[Vec3],
    triangles: &[[u32; 3]],
    pieces: &Pieces,
    likely: bool,
    check: impl Fn() -> Result<(), NodeError>,
) -> Result<Found, NodeError> {
    let one = |points: &[Vec3], triangles: &[[u32; 3]]| -> Result<Found, NodeError> {
        let fit = fit::cranium(points, triangles, &check)?;
        let face = fit.filter(Fit::head_like).and_then(|fit| face::face(points, triangles, &fit));
        Ok(Found { fit, face, piece: None })
    };
    let whole = one(points, triangles)?;
    let tried = pieces.large();
    if pieces.areas.len() <= 1 {
        return Ok(Found { piece: whole.is_sure().then_some(0), ..whole });
    }
    let mut best: Option<Found> = None;
    for piece in tried.clone() {
        check()?;
        let (points, triangles) = pieces.only(points, triangles, |other| other == piece);
        let found = one(&points, &triangles)?;
        let before = best.as_ref().map_or(-1.0, Found::likeness);
        if found.is_sure() && found.likeness() > before {
            best = Some(Found { piece: Some(piece), ..found });
        }
    }
    if let Some(best) = best {
        let same = whole.agrees(&best);
        return Ok(if same { Found { piece: best.piece, ..whole } } else { best });
    }
    // No piece is a head by itself, as where face and skull are two: one may stand in the way of the others.
    let mut best = whole;
    if !likely || (best.is_sure() && best.is_bare()) {
        return Ok(best);
    }
    let before = best.likeness();
    for piece in tried.clone().take(MOST_WITHOUT) {
        check()?;
        let (points, triangles) = pieces.only(points, triangles, |other| other != piece);
        let found = one(&points, &triangles)?;
        if found.is_sure() && found.likeness() > best.likeness().max(before + 0.05) {
            best = found;
        }
    }
    // A head may be cut off under its hair. Then the sphere is the hair's, and the face still the head's.
    if let Some(fit) = best.fit.filter(|fit| fit.head_like() && best.likeness() < FACE) {
        for piece in tried {
            let (points, triangles) = pieces.only(points, triangles, |other| other == piece);
            let face = face::face(&points, &triangles, &fit);
            let likeness = face.map_or(-1.0, |face| face.likeness);
            if likeness >= FACE && likeness > best.likeness() {
                best.face = face;
            }
        }
    }
    Ok(best)
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
        let mut areas: BTreeMap<u32, f64> = BTreeMap::new();
        for (t, piece) in triangles.iter().zip(&of) {
            let [a, b, c] = t.map(|v| points[v as usize].as_dvec3());
            *areas.entry(*piece).or_default() += 0.5 * DVec3::length((b - a).cross(c - a));
        }
        let mut sorted: Vec<(u32, f64)> = areas.into_iter().collect();
        sorted.sort_by(|a, b| b.1.total_cmp(&a.1).then(a.0.cmp(&b.0)));
        for (rank, (vertex, _)) in (0..).zip(&sorted) {
            to[*vertex as usize] = rank;
        }
        let of = of.into_iter().map(|vertex| to[vertex as usize]).collect();
        Self { of, areas: sorted.into_iter().map(|(_, area)| area).collect() }
    }

    /// How many there are.
    pub(crate) fn count(&self) -> usize {
        self.areas.len()
    }
    /// Those that are large enough to be a head.
    fn large(&self) -> std::ops::Range<u32> {
        let least = LEAST_AREA * self.areas.first().copied().unwrap_or(0.0);
        let large = self.areas.iter().take(MOST_TRIED).filter(|area| **area >= least);
        0..large.count() as u32
    }

    /// The mesh of some pieces alone.
    fn only(
        &self,
        points: &[Vec3],
        triangles: &[[u32; 3]],
        keeps: impl Fn(u32) -> bool,
    ) -> (Vec<Vec3>, Vec<[u32; 3]>) {
        only(points, triangles, |t| keeps(self.of[t]))
    }
}

/// The mesh of some triangles alone.
fn only(
    points: &[Vec3],
    triangles: &[[u32; 3]],
    keeps: impl Fn(usize) -> bool,
) -> (Vec<Vec3>, Vec<[u32; 3]>) {
    const NEW: u32 = u32::MAX;
    let (mut to, mut kept) = (vec![NEW; points.len()], vec![]);
    let own = triangles.iter().enumerate().filter(|(t, _)| keeps(*t)).map(|(_, t)| {
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

/// What stands over the crown no farther than this counts, in radii from the centre ...
const REACH: f32 = 2.5;
/// ... and nothing nearer to the skin than this: a second scalp that hair is to grow on.
const OVER: f32 = 0.04;

/// For each triangle the patches of the sphere in which it stands over the crown, one bit each; none for skin.
pub(crate) fn over_the_crown(
    points: &[Vec3],
    triangles: &[[u32; 3]],
    fit: &Fit,
    is_skin: impl Fn(usize) -> bool,
) -> Vec<u128> {
    let points: Vec<Vec3> = points.iter().map(|p| (*p - fit.centre) / fit.radius).collect();
    let cells = fit::cells(&points, triangles, 0.0, 2.0 * fit::CELL);
    let cells = || {
        let seen = cells.iter().map(|cell| (cell.of, cell.at.length(), Patches::above(cell.at)));
        seen.filter_map(|(of, far, at)| Some((of, far, at?)))
    };
    let mut skin = [0.0f32; Patches::COUNT];
    for (_, far, at) in cells().filter(|(of, ..)| is_skin(*of)) {
        skin[at] = skin[at].max(far);
    }
    let mut over = vec![0; triangles.len()];
    for (of, far, at) in cells().filter(|(of, ..)| !is_skin(*of)) {
        if (skin[at] + OVER..REACH).contains(&far) {
            over[of] |= 1 << at;
        }
    }
    over
}
