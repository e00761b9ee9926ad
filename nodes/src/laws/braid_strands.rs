//! The strands of braids: centre lines, thickness and front, from tubes or from the hair they are made of.
//!
//! A braid is what has one `braid` number, a strand what has one `strand` number in it. A strand of one curve with a `radius` is
//! a tube and taken as it is. Of a strand of many hairs the middle counts, and the disc that would spread as they do; a
//! hair counts from where it has joined (`along` rises from there on) to where the braid is `tied`, the farthest fifth (flyaways, hair on its way in) does
//! not. A strand begins where it has a twentieth of its hair. What tells the front is `normal` at each point, or
//! `braid_front`, the front where a hair joins: each hair knows it for the place where it does.

use super::hair::{AttributeValues, MeasuredHair};
use crate::data::scalp::Skin;
use crate::maths::spline::{Spline, SplineParam};
use glam::Vec3;
use std::collections::BTreeMap;

/// A braid, each strand at the same places along it.
pub(super) struct SampledBraid {
    /// Whether its strands are single tubes, whose radii were made to touch.
    pub(super) tubes: bool,
    pub(super) strands: Vec<Vec<StrandSample>>,
    /// Curves of each hair or tube: their numbers among all.
    pub(super) curves: Vec<Vec<usize>>,
}

/// A strand at one place along its braid.
#[derive(Clone, Copy, Default)]
pub(super) struct StrandSample {
    pub(super) middle: Vec3,
    pub(super) radius: f32,
    /// Front of the braid as it is told; zero where it is not.
    pub(super) front: Vec3,
    /// How near the hair comes to the skin, cm; none for tubes and far from it.
    pub(super) gap: Option<f32>,
}

/// Hairs of a strand that its middle is found from.
const MOST_HAIRS: usize = 800;
/// Fewer hairs than this make no strand.
const FEWEST: usize = 3;
/// One in so many of a strand's hairs make a strand.
const A_STRAND: usize = 20;
/// How far along the braid the front where a hair joins is that of the braid.
const AS_JOINED: f32 = 0.015;
/// The share of hairs that counts, nearest to the middle first.
const COUNTS: f32 = 0.8;

/// All braids, by number.
pub(super) fn braids(hair: &MeasuredHair, skin: Option<&Skin>) -> Vec<SampledBraid> {
    let (Some(braid), Some(strand)) = (hair.whole("braid"), hair.whole("strand")) else {
        return vec![];
    };
    let mut members: BTreeMap<i64, BTreeMap<i64, Vec<usize>>> = BTreeMap::new();
    for i in (0..hair.len()).filter(|i| braid[*i] != 0 && hair.curve(*i).len() > 1) {
        members.entry(braid[i]).or_default().entry(strand[i]).or_default().push(i);
    }
    let members: Vec<BTreeMap<i64, Vec<usize>>> =
        members.into_values().filter(|strands| strands.len() > 1).collect();
    let radius = hair.numbers("radius");
    let columns = Columns {
        along: hair.numbers("along").filter(AttributeValues::is_of_points),
        tied: hair.numbers("tied"),
        normal: hair.vectors("normal").filter(AttributeValues::is_of_points),
        joins: hair.vectors("braid_front"),
        stitch: hair.whole("stitch"),
        radius: radius.filter(AttributeValues::is_of_points),
        skin,
    };
    hair.in_parts(members.len(), 1, |part| columns.braid(hair, &members[part.start]))
        .into_iter()
        .flatten()
        .collect()
}

struct Columns<'a> {
    along: Option<AttributeValues<'a, f32>>,
    tied: Option<AttributeValues<'a, f32>>,
    normal: Option<AttributeValues<'a, Vec3>>,
    joins: Option<AttributeValues<'a, Vec3>>,
    stitch: Option<Vec<i64>>,
    radius: Option<AttributeValues<'a, f32>>,
    skin: Option<&'a Skin<'a>>,
}

impl Columns<'_> {
    fn braid(
        &self,
        hair: &MeasuredHair,
        members: &BTreeMap<i64, Vec<usize>>,
    ) -> Option<SampledBraid> {
        let curves: Vec<Vec<usize>> = members.values().cloned().collect();
        let tubes = curves.iter().all(|c| c.len() == 1) && self.radius.is_some();
        // Stitch curves, for one, have the number of their braid too.
        if !tubes && curves.iter().any(|c| c.len() < FEWEST) {
            return None;
        }
        let strands: Vec<Vec<Option<StrandSample>>> = if tubes {
            let most = curves.iter().map(|c| hair.curve(c[0]).len()).max()?;
            let each = |c: &Vec<usize>| self.tube(hair, c[0], most * 8);
            curves.iter().map(each).collect::<Option<_>>()?
        } else {
            // All strands at the same places, however long the ways of their hair are.
            let longest = curves.iter().flatten().map(|i| hair.curve(*i).len()).max()?;
            curves.iter().map(|c| self.bundle(hair, c, longest)).collect()
        };
        // The longest run of places at which all strands are there.
        let n = strands.iter().map(Vec::len).min()?;
        let (mut best, mut start) = (0..0, 0);
        for k in 0..=n {
            if k == n || strands.iter().any(|s| s[k].is_none()) {
                if k - start > best.len() {
                    best = start..k;
                }
                start = k + 1;
            }
        }
        let cut =
            |s: &Vec<Option<StrandSample>>| s[best.clone()].iter().copied().flatten().collect();
        let strands = strands.iter().map(cut).collect();
        (best.len() > 8).then_some(SampledBraid { tubes, strands, curves })
    }

    fn tube(
        &self,
        hair: &MeasuredHair,
        curve: usize,
        count: usize,
    ) -> Option<Vec<Option<StrandSample>>> {
        let points = hair.curve(curve);
        let first = hair.range(curve).start;
        let mut spline = Spline::default();
        hair.spline(curve, &mut spline).ok()?;
        let last = spline.span_count() - 1;
        let along = |k: usize| match &self.along {
            Some(along) => along.at(curve, first + k),
            None => k as f32 / points.len() as f32,
        };
        let (from, to) = (along(0), along(points.len() - 1));
        let mut span = 0;
        let section = |k: usize| {
            let u = from + (to - from) * k as f32 / (count - 1) as f32;
            while span < last && along(span + 1) < u {
                span += 1;
            }
            let (a, b) = (along(span), along(span + 1));
            let t = if b > a { ((u - a) / (b - a)).clamp(0.0, 1.0) } else { 0.0 };
            let radius = self.radius.as_ref().map_or(0.0, |r| {
                let (a, b) = (r.at(curve, first + span), r.at(curve, first + span + 1));
                a + (b - a) * t
            });
            Some(StrandSample {
                middle: spline.point(SplineParam { span, t }),
                radius,
                front: self.normal.as_ref().map_or(Vec3::ZERO, |n| n.at(curve, first + span)),
                gap: None,
            })
        };
        Some((0..count).map(section).collect())
    }

    /// The middle of many hairs of at most `longest` points at even places along them.
    fn bundle(
        &self,
        hair: &MeasuredHair,
        curves: &[usize],
        longest: usize,
    ) -> Vec<Option<StrandSample>> {
        let mut chosen = curves.to_vec();
        if let Some(stitch) = &self.stitch {
            chosen.sort_by_key(|i| (stitch[*i], *i));
        }
        let every = chosen.len().div_ceil(MOST_HAIRS).max(1);
        let chosen: Vec<usize> = chosen.into_iter().step_by(every).collect();
        // Hairs that are all sampled at the same places are best taken there.
        let count = if self.along.is_some() { (2 * longest).clamp(64, 510) } else { longest };
        let hairs: Vec<Vec<(f32, Vec3, Vec3)>> =
            chosen.iter().map(|i| self.hair(hair, *i)).collect();
        let mut at = vec![0; hairs.len()];
        let mut here = vec![];
        let fewest = (hairs.len() / A_STRAND).max(FEWEST);
        (0..count)
            .map(|k| {
                let u = k as f32 / (count - 1) as f32;
                here.clear();
                for (hair, at) in hairs.iter().zip(&mut at) {
                    while *at + 2 < hair.len() && hair[*at + 1].0 < u {
                        *at += 1;
                    }
                    let [Some(a), Some(b)] = [hair.get(*at), hair.get(*at + 1)] else { continue };
                    if a.0 <= u + 1e-6 && u <= b.0 + 1e-6 {
                        let t =
                            if b.0 > a.0 { ((u - a.0) / (b.0 - a.0)).clamp(0.0, 1.0) } else { 0.0 };
                        here.push((a.1.lerp(b.1, t), a.2.lerp(b.2, t)));
                    }
                }
                middle(&mut here, fewest, self.skin)
            })
            .collect()
    }

    /// Points of a hair from where it has joined: fraction along the braid, place, front.
    fn hair(&self, hair: &MeasuredHair, curve: usize) -> Vec<(f32, Vec3, Vec3)> {
        let (points, first) = (hair.curve(curve), hair.range(curve).start);
        if let Some(along) = &self.along {
            let at = |k: usize| along.at(curve, first + k);
            let joined = at(0);
            let mut last = joined;
            let tied = self.tied.as_ref().map_or(1.0, |tied| tied.at(curve, first));
            let rises = |k: &usize| {
                let more = at(*k) > last && at(*k) <= tied;
                last = last.max(at(*k));
                more
            };
            let front = |k: usize| match (&self.normal, &self.joins) {
                (Some(normal), _) => normal.at(curve, first + k),
                (None, Some(joins)) if at(k) < joined + AS_JOINED => joins.at(curve, first + k),
                _ => Vec3::ZERO,
            };
            let rising: Vec<usize> = (0..points.len()).filter(rises).collect();
            return rising.into_iter().map(|k| (at(k), points[k], front(k))).collect();
        }
        let front = |k: usize| self.normal.as_ref().map_or(Vec3::ZERO, |n| n.at(curve, first + k));
        let length: f32 = points.windows(2).map(|w| w[0].distance(w[1])).sum();
        let mut s = 0.0;
        (0..points.len())
            .map(|k| {
                s += if k > 0 { points[k].distance(points[k - 1]) } else { 0.0 };
                ((s / length.max(1e-9)).min(1.0), points[k], front(k))
            })
            .collect()
    }
}

fn middle(here: &mut [(Vec3, Vec3)], fewest: usize, skin: Option<&Skin>) -> Option<StrandSample> {
    if here.len() < fewest {
        return None;
    }
    let front = here.iter().map(|p| p.1).sum::<Vec3>().normalize_or_zero();
    let mean = |all: &[(Vec3, Vec3)]| all.iter().map(|p| p.0).sum::<Vec3>() / all.len() as f32;
    let mut about = mean(here);
    let counting = ((here.len() as f32 * COUNTS).ceil() as usize).clamp(FEWEST, here.len());
    for _ in 0..2 {
        let off = |p: &(Vec3, Vec3)| p.0.distance_squared(about);
        here.select_nth_unstable_by(counting - 1, |a, b| off(a).total_cmp(&off(b)));
        about = mean(&here[..counting]);
    }
    let spread: f32 =
        here[..counting].iter().map(|p| p.0.distance_squared(about)).sum::<f32>() / counting as f32;
    let share = counting as f32 / here.len() as f32;
    let gap = skin
        .filter(|skin| skin.about(about) < 1.0)
        .map(|skin| here[..counting].iter().map(|p| skin.about(p.0)).fold(f32::MAX, f32::min));
    Some(StrandSample {
        middle: about,
        // Within the share of a disc's area nearest to its middle, the mean square is half the share of its radius's.
        radius: (2.0 * spread / share).sqrt(),
        front,
        gap,
    })
}
