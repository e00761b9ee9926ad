//! Which way a face looks, and whether there is one.
//!
//! The outline of a head (how far it reaches from the vertical axis through its cranium, level by level, all round) is
//! mirrored in every vertical plane through the centre; the plane in which it is most alike goes through the face. Which of
//! the plane's two ends has the face is told by likeness to the face of the built-in bust: noses, sockets and cheeks stand
//! out where hair does not. A bun may reach farther than a nose, and the corner of a pair of glasses may too.
//!
//! Guarantees: bounded work for any mesh; level, unit directions. Not promised: a face on a head that has none, or whose face
//! is covered; [`Face::likeness`] tells.

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
    /// Where it looks: level and unit.
    pub(crate) looks: Vec3,
    /// How that was found.
    pub(crate) by: By,
    /// How much it is like the bust's, -1 to 1: people have 0.7 and more, other sides of heads and hair 0.4 and less.
    pub(crate) likeness: f32,
}

/// How a face was found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum By {
    /// In the plane that the head mirrors in.
    Mirror,
    /// By its likeness alone, on a head that mirrors in no plane.
    Likeness,
    /// Towards the point farthest from the vertical axis, for want of anything else.
    Farthest,
}

/// What is as like a face as this is one.
pub(crate) const FACE: f32 = 0.55;

/// An end that is so much more like a face than the other has it, though neither is much like one: a face with hardly a nose.
const CLEARLY: f32 = 0.2;

/// Levels that the outline of a head is taken at, from [`LOW`] to [`HIGH`] about the centre, in radii.
const LEVELS: usize = 18;
const LOW: f32 = -1.2;
const HIGH: f32 = 0.6;
/// Directions that it is taken in.
const DIRECTIONS: usize = 240;
/// What is farther from the vertical axis is no head, in radii.
const WIDEST: f32 = 1.7;
/// The nose is below this, in radii.
const UNDER_BROWS: f32 = -0.1;
/// What is less alike than this on both sides counts no more: a parting, the frame of a pair of glasses, half a shoulder.
const UNLIKE: f32 = 0.15;
/// The nose is not farther than this from the plane in which the head mirrors, in directions.
const NOSE: usize = 6;

/// A face is looked at so far to each side, in directions: 48 degrees ...
const SIDE: usize = 32;
/// ... at these levels: from the chin to the middle of the forehead ...
const FACE_LEVELS: std::ops::Range<usize> = 1..16;
/// ... and may lie so many levels higher or lower than the bust's.
const HIGHER: isize = 3;
/// What stands out farther than this counts no more, in radii ...
const OUT: f32 = 0.2;
/// ... and what stands out by less is smooth.
const SMOOTH: f32 = 0.01;
/// How much a direction is doubted in whose plane the head mirrors no better than usual.
const MIRRORS: f32 = 0.5;
/// Of so many directions at a level at least this share must be known.
const KNOWN: f32 = 0.66;

/// How far a head reaches from its vertical axis, in radii: by level and direction; 0 where nothing is.
struct Outline {
    levels: Vec<[f32; DIRECTIONS]>,
    /// The way to the farthest point below the brows.
    farthest: Vec3,
}

/// One level of a face, once what is round about it is taken off: what stands out of it.
type Relief = [f32; 2 * SIDE];

/// Where the face of a head with this cranium looks; none where nothing is below its brows.
pub(crate) fn face(points: &[Vec3], triangles: &[[u32; 3]], fit: &Fit) -> Option<Face> {
    let outline = Outline::of(points, triangles, fit);
    let unlike = outline.unlike();
    if let Some((turns, best)) = mirror(&unlike) {
        let ends = [0, 1].map(|end| best + end * DIRECTIONS);
        let alike = ends.map(|way| outline.likeness(way));
        let reach = ends.map(|way| outline.reach(way));
        // A cap of hair mirrors in two planes, and has no face below its brows.
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

impl Outline {
    fn of(points: &[Vec3], triangles: &[[u32; 3]], fit: &Fit) -> Self {
        let points: Vec<Vec3> = points.iter().map(|p| (*p - fit.centre) / fit.radius).collect();
        let mut levels = vec![[0.0f32; DIRECTIONS]; LEVELS];
        let mut farthest = Vec3::ZERO;
        for cell in fit::cells(&points, triangles, LOW, CELL) {
            let (out, high) = (cell.at.with_y(0.0), cell.at.y);
            let reach = out.length();
            if !(LOW..HIGH).contains(&high) || reach > WIDEST {
                continue;
            }
            let turns = atan2(out.x, out.z) / TAU;
            let level = ((high - LOW) / (HIGH - LOW) * LEVELS as f32) as usize;
            let direction = (turns.rem_euclid(1.0) * DIRECTIONS as f32) as usize % DIRECTIONS;
            let at = &mut levels[level.min(LEVELS - 1)][direction];
            *at = at.max(reach);
            if high < UNDER_BROWS && reach > farthest.length() {
                farthest = out;
            }
        }
        Self { levels, farthest }
    }

    /// How little the outline is alike on both sides of each vertical plane. Plane `k` goes through the edges between
    /// directions: the k-th half direction from +z.
    fn unlike(&self) -> Vec<f32> {
        let unlike = |k: usize| -> f32 {
            let mirrored = |i: usize| (2 * DIRECTIONS + k - 1 - i) % DIRECTIONS;
            let off = |level: &[f32; DIRECTIONS]| -> f32 {
                (0..DIRECTIONS).map(|i| (level[i] - level[mirrored(i)]).abs().min(UNLIKE)).sum()
            };
            self.levels.iter().map(off).sum()
        };
        (0..DIRECTIONS).map(unlike).collect()
    }

    /// How far it reaches about a half direction, below the brows.
    fn reach(&self, way: usize) -> f32 {
        let faces = ((UNDER_BROWS - LOW) / (HIGH - LOW) * LEVELS as f32) as usize;
        let about = way / 2 + DIRECTIONS;
        let near = about - NOSE..about + NOSE;
        let levels = self.levels[..faces].iter();
        levels.flat_map(|level| near.clone().map(|i| level[i % DIRECTIONS])).fold(0.0, f32::max)
    }

    /// What stands out about a half direction, level by level; none where too little is known.
    fn relief(&self, way: usize) -> Vec<Option<Relief>> {
        let ahead = |i: usize| (way / 2 + DIRECTIONS + i - SIDE) % DIRECTIONS;
        self.levels
            .iter()
            .map(|level| standing_out(std::array::from_fn(|i| level[ahead(i)])))
            .collect()
    }

    /// How much what lies about a half direction is like the face of the bust, -1 to 1.
    fn likeness(&self, way: usize) -> f32 {
        let (mine, face) = (self.relief(way), bust_face());
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

    /// Where it is most like a face of all directions; none where it is like one nowhere. An ear is like a nose, but no head
    /// mirrors in the plane through its ears.
    fn most_alike(&self, unlike: &[f32]) -> Option<Face> {
        let usual = median(unlike).max(f32::MIN_POSITIVE);
        let all = (0..2 * DIRECTIONS).step_by(2).map(|way| (way, self.likeness(way)));
        let doubt = |way: usize| MIRRORS * unlike[way % DIRECTIONS] / usual;
        let (way, likeness) = all
            .filter(|(_, likeness)| *likeness >= FACE)
            .max_by(|a, b| (a.1 - doubt(a.0)).total_cmp(&(b.1 - doubt(b.0))))?;
        let (sin, cos) = sin_cos_turns(0.5 * way as f32 / DIRECTIONS as f32);
        Some(Face { looks: Vec3::new(sin, 0.0, cos), by: By::Likeness, likeness })
    }
}

/// The plane in which an outline mirrors: turns about the axis to one of its ends, and the nearest half direction; none where
/// it is about as much alike in every plane.
fn mirror(unlike: &[f32]) -> Option<(f32, usize)> {
    let best = (0..DIRECTIONS).min_by(|a, b| unlike[*a].total_cmp(&unlike[*b]))?;
    if unlike[best] > 0.5 * median(unlike) {
        return None;
    }
    // Between planes: the bottom of the parabola through it and its neighbours.
    let side = |by: usize| unlike[(best + by) % DIRECTIONS];
    let (before, after) = (side(DIRECTIONS - 1), side(1));
    let bend = before + after - 2.0 * unlike[best];
    let part = if bend > 0.0 { (0.5 * (before - after) / bend).clamp(-0.5, 0.5) } else { 0.0 };
    Some((0.5 * (best as f32 + part) / DIRECTIONS as f32, best))
}

fn median(of: &[f32]) -> f32 {
    let mut sorted = of.to_vec();
    sorted.sort_by(f32::total_cmp);
    sorted[sorted.len() / 2]
}

/// The relief of the built-in bust's face.
fn bust_face() -> &'static [Option<Relief>] {
    static RELIEF: OnceLock<Vec<Option<Relief>>> = OnceLock::new();
    RELIEF.get_or_init(|| {
        let bust = bust::adult();
        // Its cranium is where its own description says.
        let fit = Fit { centre: Vec3::ZERO, radius: HEAD_RADIUS, ..Fit::default() };
        Outline::of(&bust.points, &bust.triangles, &fit).relief(0)
    })
}

/// What is left of a level once its height, slope and bend are taken off; none where too little of it is known.
fn standing_out(mut level: Relief) -> Option<Relief> {
    const N: usize = 2 * SIDE;
    let known = level.map(|x| x > 0.0);
    if (known.iter().filter(|known| **known).count() as f32) < KNOWN * N as f32 {
        return None;
    }
    let nearest = |i: usize| {
        let ways = (0..N).flat_map(|by| [i.checked_sub(by), Some(i + by)]).flatten();
        ways.filter(|j| *j < N).find(|j| known[*j])
    };
    level = std::array::from_fn(|i| nearest(i).map_or(0.0, |j| level[j]));
    let across = |i: usize| (i as f32 + 0.5 - SIDE as f32) / SIDE as f32;
    let mean_square = (0..N).map(|i| across(i) * across(i)).sum::<f32>() / N as f32;
    let shapes: [fn(f32, f32) -> f32; 3] = [|_, _| 1.0, |x, _| x, |x, mean| x * x - mean];
    for shape in shapes {
        let shape: Relief = std::array::from_fn(|i| shape(across(i), mean_square));
        let square: f32 = shape.iter().map(|x| x * x).sum();
        let part = level.iter().zip(&shape).map(|(a, b)| a * b).sum::<f32>() / square;
        level.iter_mut().zip(&shape).for_each(|(x, shape)| *x -= part * shape);
    }
    Some(level.map(|x| x.clamp(-OUT, OUT)))
}
