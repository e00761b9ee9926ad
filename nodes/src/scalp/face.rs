//! Finds the direction of a face, and whether there is one.
//!
//! The outline of a head (its extent from the vertical axis through its cranium, level by level, in all directions) is
//! mirrored in every vertical plane through the centre; the plane with the best match passes through the face. Which
//! end of the plane has the face is decided by likeness to the face of the built-in bust: noses, eye sockets and cheeks
//! have relief that hair does not have. Reach alone would not do: a bun may reach farther than a nose, and so may the
//! corner of a pair of glasses.
//!
//! Guarantees: bounded work for any mesh; level, unit directions. Not promised: a face on a head that has none, or
//! whose face is covered; [`Face::likeness`] detects that.

use super::bust;
use super::fit::{self, CELL, Fit};
use crate::data::scalp::HEAD_RADIUS;
use crate::maths::transcendental::{atan2, sin_cos_turns};
use glam::Vec3;
use std::f32::consts::TAU;
use std::sync::OnceLock;

/// A face, or what was taken for one.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Face {
    /// Its direction: level and unit.
    pub(crate) looks: Vec3,
    /// How it was found.
    pub(crate) by: By,
    /// Likeness to the bust's face, -1 to 1: people have 0.7 and more, other sides of heads and hair 0.4 and less.
    pub(crate) likeness: f32,
}

/// How a face was found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum By {
    /// In the head's mirror plane.
    Mirror,
    /// By likeness alone, on a head without a mirror plane.
    Likeness,
    /// Toward the point farthest from the vertical axis, as a last resort.
    Farthest,
}

/// Anything with at least this likeness is a face.
pub(crate) const FACE: f32 = 0.55;

/// An end that exceeds the other's likeness by this much has the face, even if both are low: a face with hardly a nose.
const CLEARLY: f32 = 0.2;

/// Levels of a head's outline, from [`LOW`] to [`HIGH`] around the centre, in radii.
const LEVELS: usize = 18;
const LOW: f32 = -1.2;
const HIGH: f32 = 0.6;
/// Directions of the outline, and the number of them that a face covers, 48 degrees to each side of its centre ...
const DIRECTIONS: usize = 240;
const WINDOW: usize = 64;
/// ... and the same for a glimpse, with the size of the cells of its outline, in radii.
const FEW_DIRECTIONS: usize = 60;
const SMALL_WINDOW: usize = 16;
const LARGE_CELL: f32 = 1.0 / 10.0;
/// Number of cells that suffices for it.
const ENOUGH: usize = 12_000;
/// Largest distance of a head from the vertical axis, in radii.
const WIDEST: f32 = 1.7;
/// The nose is below this level, in radii.
const UNDER_BROWS: f32 = -0.1;
/// Differences between both sides are capped at this value: a parting, the frame of a pair of glasses, half a shoulder.
const UNLIKE: f32 = 0.15;
/// Largest angle between nose and mirror plane, as a fraction of all directions.
const NOSE: usize = 40;

/// Levels of a face: from the chin to the middle of the forehead ...
const FACE_LEVELS: std::ops::Range<usize> = 1..16;
/// ... which may be this many levels higher or lower than the bust's.
const HIGHER: isize = 3;
/// Relief is capped at this value, in radii ...
const OUT: f32 = 0.2;
/// ... and below this value counts as smooth.
const SMOOTH: f32 = 0.01;
/// Penalty of a direction whose plane is no better a mirror plane than average.
const MIRRORS: f32 = 0.5;
/// A mirror plane has at most this fraction of the average mismatch ...
const IS_MIRROR: f32 = 0.5;
/// ... and at most this fraction in the rough test.
const HARDLY_MIRRORS: f32 = 0.75;
/// Fraction of the directions at a level that must be known.
const KNOWN: f32 = 0.66;

/// Extent of a head from its vertical axis, in radii, by level and direction; 0 where there is nothing.
struct Outline<const N: usize, const W: usize> {
    levels: Vec<[f32; N]>,
    /// Direction to the farthest point below the brows.
    farthest: Vec3,
}

type Fine = Outline<DIRECTIONS, WINDOW>;
type Coarse = Outline<FEW_DIRECTIONS, SMALL_WINDOW>;

/// Relief of a face, level by level, with its surroundings subtracted; `None` where too little is known.
type Relief<const W: usize> = [Option<[f32; W]>; LEVELS];

/// The direction of the face of a head with this cranium; `None` if there is nothing below its brows.
pub(crate) fn face(points: &[Vec3], triangles: &[[u32; 3]], fit: &Fit) -> Option<Face> {
    let outline = Fine::of(points, triangles, fit, CELL, usize::MAX);
    let unlike = outline.unlike();
    if let Some((turns, best)) = mirror(&unlike) {
        let ends = [0, 1].map(|end| best + end * DIRECTIONS);
        let alike = ends.map(|way| outline.likeness(way, bust_face()));
        let reach = ends.map(|way| outline.reach(way));
        // A cap of hair has two mirror planes, and no face below its brows.
        if reach[0].max(reach[1]) == 0.0 {
            return None;
        }
        let is_told = alike[0].max(alike[1]) >= FACE || (alike[0] - alike[1]).abs() >= CLEARLY;
        let back = if is_told { alike[1] > alike[0] } else { reach[1] > reach[0] };
        let likeness = alike[usize::from(back)];
        let (sin, cos) = sin_cos_turns(if back { turns + 0.5 } else { turns });
        let found = Face { looks: Vec3::new(sin, 0.0, cos), by: By::Mirror, likeness };
        if likeness >= FACE {
            return Some(found);
        }
        return Some(outline.most_alike(&unlike).unwrap_or(found));
    }
    let farthest = || {
        let looks = outline.farthest.try_normalize()?;
        Some(Face { looks, by: By::Farthest, likeness: 0.0 })
    };
    outline.most_alike(&unlike).or_else(farthest)
}

/// Rough score for a face on a head with this cranium: its likeness in the mirror plane, or `anywhere`; -1 if there is
/// none.
pub(crate) fn glimpse(points: &[Vec3], triangles: &[[u32; 3]], fit: &Fit, anywhere: bool) -> f32 {
    static FACE: OnceLock<Relief<SMALL_WINDOW>> = OnceLock::new();
    let face = FACE.get_or_init(|| Coarse::of_bust(LARGE_CELL, ENOUGH).relief(0));
    let outline = Coarse::of(points, triangles, fit, LARGE_CELL, ENOUGH);
    if anywhere {
        let ways = (0..2 * FEW_DIRECTIONS).step_by(2);
        return ways.map(|way| outline.likeness(way, face)).fold(-1.0, f32::max);
    }
    let unlike = outline.unlike();
    let best = least(&unlike);
    if unlike[best] > HARDLY_MIRRORS * median(&unlike) {
        return -1.0;
    }
    let ends = [best, best + FEW_DIRECTIONS];
    let near = ends
        .into_iter()
        .flat_map(|end| end + 2 * FEW_DIRECTIONS - 1..=end + 2 * FEW_DIRECTIONS + 1);
    near.map(|way| outline.likeness(way, face)).fold(-1.0, f32::max)
}

impl<const N: usize, const W: usize> Outline<N, W> {
    /// From cells of this size, and not many more than `enough`.
    fn of(points: &[Vec3], triangles: &[[u32; 3]], fit: &Fit, cell: f32, enough: usize) -> Self {
        let points: Vec<Vec3> = points.iter().map(|p| (*p - fit.centre) / fit.radius).collect();
        let mut levels = vec![[0.0f32; N]; LEVELS];
        let mut farthest = Vec3::ZERO;
        let mut cells = fit::cells(&points, triangles, LOW, cell);
        cells.retain(|cell| {
            (LOW..HIGH).contains(&cell.at.y) && cell.at.with_y(0.0).length() <= WIDEST
        });
        let every = (cells.len() / enough).max(1);
        for cell in cells.iter().step_by(every) {
            let (out, high) = (cell.at.with_y(0.0), cell.at.y);
            let reach = out.length();
            let turns = atan2(out.x, out.z) / TAU;
            let level = ((high - LOW) / (HIGH - LOW) * LEVELS as f32) as usize;
            let direction = (turns.rem_euclid(1.0) * N as f32) as usize % N;
            let at = &mut levels[level.min(LEVELS - 1)][direction];
            *at = at.max(reach);
            if high < UNDER_BROWS && reach > farthest.length() {
                farthest = out;
            }
        }
        Self { levels, farthest }
    }

    /// The outline of the built-in bust.
    fn of_bust(cell: f32, enough: usize) -> Self {
        let bust = bust::adult();
        // Its cranium is known from its description.
        let fit = Fit { centre: Vec3::ZERO, radius: HEAD_RADIUS, ..Fit::default() };
        Self::of(&bust.points, &bust.triangles, &fit, cell, enough)
    }

    /// Mismatch of both sides of each vertical plane. Plane `k` passes through the edges between directions: the k-th
    /// half direction from +z.
    fn unlike(&self) -> [f32; N] {
        let mut all = [0.0; N];
        for level in &self.levels {
            // All planes side by side, for vectorization.
            let twice: Vec<f32> = level.iter().chain(level).copied().collect();
            let mut here = [0.0; N];
            for (i, out) in level.iter().enumerate() {
                let mirrored = &twice[N - 1 - i..][..N];
                for (sum, other) in here.iter_mut().zip(mirrored) {
                    *sum += (out - other).abs().min(UNLIKE);
                }
            }
            all.iter_mut().zip(&here).for_each(|(all, here)| *all += here);
        }
        all
    }

    /// Its extent around a half direction, below the brows.
    fn reach(&self, way: usize) -> f32 {
        let faces = ((UNDER_BROWS - LOW) / (HIGH - LOW) * LEVELS as f32) as usize;
        let about = way / 2 + N;
        let near = about - N / NOSE..about + N / NOSE;
        let levels = self.levels[..faces].iter();
        levels.flat_map(|level| near.clone().map(|i| level[i % N])).fold(0.0, f32::max)
    }

    /// Relief around a half direction.
    fn relief(&self, way: usize) -> Relief<W> {
        let ahead = |i: usize| (way / 2 + N + i - W / 2) % N;
        std::array::from_fn(|at| standing_out(std::array::from_fn(|i| self.levels[at][ahead(i)])))
    }

    /// Likeness of the relief around a half direction to the bust's face, -1 to 1.
    fn likeness(&self, way: usize, face: &Relief<W>) -> f32 {
        let mine = self.relief(way);
        let whole: f32 = face[FACE_LEVELS].iter().flatten().flatten().map(|x| x * x).sum();
        let shifted = (-HIGHER..=HIGHER).map(|by| {
            let (mut both, mut own) = (0.0, 0.0);
            for (level, face) in FACE_LEVELS.zip(&face[FACE_LEVELS]) {
                let at = level.checked_add_signed(by);
                let mine = at.and_then(|at| mine.get(at)?.as_ref());
                let (Some(mine), Some(face)) = (mine, face) else { continue };
                both += mine.iter().zip(face).map(|(a, b)| a * b).sum::<f32>();
                own += mine.iter().map(|a| a * a + SMOOTH * SMOOTH).sum::<f32>();
            }
            both / (own * whole).sqrt().max(f32::MIN_POSITIVE)
        });
        shifted.fold(-1.0, f32::max)
    }
}

impl Fine {
    /// The most facelike of all directions; `None` if no direction resembles a face. An ear resembles a nose, but no
    /// head has a mirror plane through its ears.
    fn most_alike(&self, unlike: &[f32]) -> Option<Face> {
        let usual = median(unlike).max(f32::MIN_POSITIVE);
        let all = (0..2 * DIRECTIONS).step_by(2).map(|way| (way, self.likeness(way, bust_face())));
        let doubt = |way: usize| MIRRORS * unlike[way % DIRECTIONS] / usual;
        let (way, likeness) = all
            .filter(|(_, likeness)| *likeness >= FACE)
            .max_by(|a, b| (a.1 - doubt(a.0)).total_cmp(&(b.1 - doubt(b.0))))?;
        let (sin, cos) = sin_cos_turns(0.5 * way as f32 / DIRECTIONS as f32);
        Some(Face { looks: Vec3::new(sin, 0.0, cos), by: By::Likeness, likeness })
    }
}

/// The mirror plane of an outline: the angle about the axis to one of its ends, and the nearest half direction; `None`
/// if all planes match about equally.
fn mirror(unlike: &[f32]) -> Option<(f32, usize)> {
    let best = least(unlike);
    if unlike[best] > IS_MIRROR * median(unlike) {
        return None;
    }
    // Between planes: the minimum of the parabola through it and its neighbours.
    let side = |by: usize| unlike[(best + by) % DIRECTIONS];
    let (before, after) = (side(DIRECTIONS - 1), side(1));
    let bend = before + after - 2.0 * unlike[best];
    let part = if bend > 0.0 { (0.5 * (before - after) / bend).clamp(-0.5, 0.5) } else { 0.0 };
    Some((0.5 * (best as f32 + part) / DIRECTIONS as f32, best))
}

/// The first of the smallest.
fn least(of: &[f32]) -> usize {
    (0..of.len()).min_by(|a, b| of[*a].total_cmp(&of[*b])).unwrap_or(0)
}

fn median(of: &[f32]) -> f32 {
    let mut sorted = of.to_vec();
    sorted.sort_by(f32::total_cmp);
    sorted[sorted.len() / 2]
}

/// The relief of the built-in bust's face.
fn bust_face() -> &'static Relief<WINDOW> {
    static RELIEF: OnceLock<Relief<WINDOW>> = OnceLock::new();
    RELIEF.get_or_init(|| Fine::of_bust(CELL, usize::MAX).relief(0))
}

/// A level after subtracting its offset, slope and curvature; `None` if too little of it is known.
fn standing_out<const N: usize>(mut level: [f32; N]) -> Option<[f32; N]> {
    let known = level.map(|x| x > 0.0);
    if (known.iter().filter(|known| **known).count() as f32) < KNOWN * N as f32 {
        return None;
    }
    let nearest = |i: usize| {
        let ways = (0..N).flat_map(|by| [i.checked_sub(by), Some(i + by)]).flatten();
        ways.filter(|j| *j < N).find(|j| known[*j])
    };
    level = std::array::from_fn(|i| nearest(i).map_or(0.0, |j| level[j]));
    let across = |i: usize| (i as f32 + 0.5 - (N / 2) as f32) / (N / 2) as f32;
    let mean_square = (0..N).map(|i| across(i) * across(i)).sum::<f32>() / N as f32;
    let shapes: [fn(f32, f32) -> f32; 3] = [|_, _| 1.0, |x, _| x, |x, mean| x * x - mean];
    for shape in shapes {
        let shape: [f32; N] = std::array::from_fn(|i| shape(across(i), mean_square));
        let square: f32 = shape.iter().map(|x| x * x).sum();
        let part = level.iter().zip(&shape).map(|(a, b)| a * b).sum::<f32>() / square;
        level.iter_mut().zip(&shape).for_each(|(x, shape)| *x -= part * shape);
    }
    Some(level.map(|x| x.clamp(-OUT, OUT)))
}
