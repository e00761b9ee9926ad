//! Braids: their words and crossings, and the distances between strands and from the skin.
//!
//! Everything is read from curves and their attributes, without the graph. How hair joins braids is in `stitches.rs`.

use super::braid_spine::{BraidView, Spine};
use super::braid_strands::{SampledBraid, StrandSample, braids};
use super::braid_words::{Crossing, Word};
use super::hair::{AttributeValues, MeasuredHair, quantile};
use crate::data::scalp::Scalp;
use glam::Vec3;
use std::cmp::Reverse;
use std::collections::BTreeMap;

/// All braids.
#[derive(Clone, Debug, PartialEq)]
pub struct Braids {
    /// Number of braids.
    pub braids: usize,
    /// Strands of all braids.
    pub strands: usize,
    /// Whether strands are single tubes; otherwise they are made of hair, and their radius is that of its spread.
    pub tubes: bool,
    /// Largest (r_i + r_j) / distance of two strands of a braid: 1 touches, more overlaps. Strands of hair press into one
    /// another; where hair is gathered at the ends, it is not counted.
    pub worst_overlap: f32,
    /// Braids by kind.
    pub kinds: Vec<BraidKind>,
    /// Number of braids that are not one weave throughout.
    pub broken_words: usize,
    /// With a scalp: lowest, median and highest distance of the braids' centre lines from the skin, cm.
    pub height_cm: Option<[f32; 3]>,
    /// With a scalp: smallest, median and largest over the braids of the smallest distance between skin and strands, cm; negative
    /// below the skin.
    pub gap_cm: Option<[f32; 3]>,
}

/// Braids with the same crossings.
#[derive(Clone, Debug, PartialEq)]
pub struct BraidKind {
    /// Number of braids.
    pub braids: usize,
    /// Strands of each.
    pub strands: usize,
    /// Frequency of the weave; `None` if it is no braid.
    pub weave: Option<usize>,
    /// Signs of one stitch, for each pair of strands from the left: whether the strand that goes right is in front.
    pub signs: Vec<bool>,
    /// How strands cross at the outside; `None` if the front of the braid is unknown.
    pub crossing: Option<Crossing>,
    /// Fewest, median and most stitches of a braid.
    pub stitches: [usize; 3],
}

/// Tolerance of the overlap of tubes, relative to their distance.
const TOUCH: f32 = 1.02;

impl Braids {
    /// Whether all are one weave throughout.
    pub fn are_woven(&self) -> bool {
        self.broken_words == 0
    }
    /// Whether no two strands overlap, except for rounding; `None` for strands of hair.
    pub fn keep_apart(&self) -> Option<bool> {
        self.tubes.then_some(self.worst_overlap <= TOUCH)
    }
}

/// All braids of hair or of tubes; `None` without any.
pub fn measure(hair: &MeasuredHair, scalp: Option<&Scalp>) -> Option<Braids> {
    let skin = scalp.map(Scalp::skin);
    let all = braids(hair, skin.as_ref());
    if all.is_empty() {
        return None;
    }
    let root_front = hair.vectors("scalp_normal");
    let found = hair
        .in_parts(all.len(), 1, |part| One::of(hair, &all[part.start], scalp, root_front.as_ref()));
    let mut kinds: BTreeMap<_, Vec<usize>> = BTreeMap::new();
    let mut broken = 0;
    for (one, braid) in found.iter().zip(&all) {
        let Some(word) = &one.word else {
            broken += 1;
            continue;
        };
        broken += usize::from(word.faults > 0 || word.weave().is_none());
        // Where over and under are one braid the front tells nothing.
        let crossing = Some(word.crossing());
        let crossing = crossing.filter(|it| *it == Crossing::Either || one.front_known);
        let signs = Reverse(word.signs.clone());
        let kind = (braid.strands.len(), word.weave(), signs, crossing);
        kinds.entry(kind).or_default().push(word.stitches);
    }
    let kinds =
        kinds.into_iter().map(|((strands, weave, Reverse(signs), crossing), mut stitches)| {
            stitches.sort_unstable();
            let (low, high) = (stitches[0], stitches[stitches.len() - 1]);
            let (braids, middle) = (stitches.len(), stitches[stitches.len() / 2]);
            BraidKind { braids, strands, weave, signs, crossing, stitches: [low, middle, high] }
        });
    let spread = |values: &dyn Fn(&One) -> Option<Vec<f32>>| {
        let mut all: Vec<f32> = found.iter().filter_map(values).flatten().collect();
        all.sort_by(f32::total_cmp);
        (!all.is_empty()).then(|| [0.0, 0.5, 1.0].map(|q| quantile(&all, q)))
    };
    Some(Braids {
        braids: all.len(),
        strands: all.iter().map(|b| b.strands.len()).sum(),
        tubes: all.iter().all(|b| b.tubes),
        worst_overlap: found.iter().map(|one| one.overlap).fold(0.0, f32::max),
        kinds: kinds.collect(),
        broken_words: broken,
        height_cm: spread(&|one| one.heights.clone()),
        gap_cm: spread(&|one| one.gap.map(|gap| vec![gap])),
    })
}

struct One {
    word: Option<Word>,
    front_known: bool,
    overlap: f32,
    heights: Option<Vec<f32>>,
    gap: Option<f32>,
}

impl One {
    fn of(
        hair: &MeasuredHair,
        braid: &SampledBraid,
        scalp: Option<&Scalp>,
        root_front: Option<&AttributeValues<Vec3>>,
    ) -> Self {
        let spine = Spine::of(braid);
        let told = spine.front_cues(hair, braid, scalp, root_front);
        let BraidView { sections, woven: (first, last), word } =
            BraidView::of(&spine, &told, braid);
        let (mut heights, mut gap) = (None, None);
        if let Some(scalp) = scalp {
            let skin = scalp.skin();
            let every = (spine.at.len() / 64).max(1);
            heights = Some(
                spine.at[first..=last].iter().step_by(every).map(|p| far(scalp, *p)).collect(),
            );
            let strands = braid.strands.iter().flat_map(|s| s[first..=last].iter().step_by(2));
            gap = Some(
                strands
                    .map(|s| match (s.gap, skin.distance(s.middle)) {
                        (Some(gap), _) => gap,
                        (None, d) if d < 1.0 => d - s.radius,
                        _ => far(scalp, s.middle) - s.radius,
                    })
                    .fold(f32::MAX, f32::min),
            );
        }
        // What hair is drawn together to at its ends overlaps, as it should.
        let woven = if braid.tubes { 0..sections.len() } else { first..last + 1 };
        let overlap = overlap(braid, woven);
        let front_known = told.iter().any(|front| *front != Vec3::ZERO);
        Self { word, front_known, overlap, heights, gap }
    }
}

fn far(scalp: &Scalp, p: Vec3) -> f32 {
    let surface = scalp.surface();
    surface.closest(p).map_or(0.0, |hit| surface.signed_distance(p, &hit))
}

/// The largest (r_i + r_j) / distance of samples of different strands.
fn overlap(braid: &SampledBraid, woven: std::ops::Range<usize>) -> f32 {
    const BLOCK: usize = 16;
    // The sphere about each block of samples, radii included: blocks that are apart are passed over.
    let blocks: Vec<Vec<(Vec3, f32)>> = braid
        .strands
        .iter()
        .map(|strand| {
            let around = |block: &[StrandSample]| {
                let middle = block.iter().map(|s| s.middle).sum::<Vec3>() / block.len() as f32;
                let reach = |s: &StrandSample| s.middle.distance(middle) + s.radius;
                (middle, block.iter().map(reach).fold(0.0, f32::max))
            };
            strand[woven.clone()].chunks(BLOCK).map(around).collect()
        })
        .collect();
    let strand = |i: usize| braid.strands[i][woven.clone()].chunks(BLOCK);
    let mut worst = 0.0f32;
    for i in 0..braid.strands.len() {
        for j in i + 1..braid.strands.len() {
            for (one, (p, a)) in strand(i).zip(&blocks[i]) {
                for (other, (q, b)) in strand(j).zip(&blocks[j]) {
                    if p.distance_squared(*q) > 2.5 * (a + b) * (a + b) {
                        continue;
                    }
                    for s in one {
                        for t in other {
                            let sum = s.radius + t.radius;
                            let d2 = s.middle.distance_squared(t.middle);
                            worst = worst.max(sum * sum / d2.max(1e-18));
                        }
                    }
                }
            }
        }
    }
    // A pair that is far apart is not looked at.
    worst.sqrt()
}

#[cfg(test)]
mod tests {
    use super::super::hair::tests::read_of;
    use super::*;
    use crate::eval::PlainHost;
    use crate::formats::usd::read::{ReadCurves, ReadValues};
    use crate::maths::transcendental::{cos, sin};

    /// Three strands of a braid of `stitches` stitches an amplitude of 0.4 cm wide, hanging down, as one tube each or as
    /// `hairs` hairs; front is +z.
    fn braid(stitches: f32, hairs: usize, depth: f32, wrong: bool) -> ReadCurves {
        let each = (stitches * 12.0) as usize;
        let (mut curves, mut strand, mut along) = (vec![], vec![], vec![]);
        for i in 0..3 {
            for hair in 0..hairs {
                let turn = hair as f32 * 2.4;
                let out = 0.12 * ((hair as f32 + 0.5) / hairs as f32).sqrt();
                let off =
                    if hairs > 1 { Vec3::new(cos(turn), 0.0, sin(turn)) * out } else { Vec3::ZERO };
                let at = |k: usize| {
                    let u = k as f32 / each as f32 * stitches;
                    let c = (u / 3.0 + i as f32 / 3.0) * std::f32::consts::TAU;
                    let flip = if wrong && (3.0..3.6).contains(&u) { -1.0 } else { 1.0 };
                    Vec3::new(-0.4 * sin(c), -0.6 * u, 0.2 * depth * flip * sin(2.0 * c)) + off
                };
                curves.push((0..each).map(at).collect::<Vec<Vec3>>());
                strand.push(i);
                along.extend((0..each).map(|k| (k + 1) as f32 / each as f32));
            }
        }
        let points = curves.iter().map(Vec::len).sum();
        let refs: Vec<&[Vec3]> = curves.iter().map(Vec::as_slice).collect();
        let mut primvars = vec![
            ("braid", ReadValues::Int(vec![5])),
            ("strand", ReadValues::Int(strand)),
            ("along", ReadValues::Float(along)),
            ("scalp_normal", ReadValues::Float3(vec![Vec3::Z])),
        ];
        if hairs == 1 {
            primvars.push(("radius", ReadValues::Float(vec![0.12; points])));
        }
        read_of(&refs, &primvars)
    }

    #[track_caller]
    fn measured(read: &ReadCurves) -> Braids {
        measure(&MeasuredHair::read(read, &PlainHost), None).unwrap()
    }

    #[test]
    fn braids_of_tubes_and_of_hair_are_read_alike() {
        for hairs in [1, 40] {
            for (depth, crossing) in [(1.0, Crossing::Under), (-1.0, Crossing::Over)] {
                let found = measured(&braid(9.0, hairs, depth, false));
                assert_eq!((found.braids, found.strands, found.broken_words), (1, 3, 0));
                let kind = &found.kinds[0];
                assert_eq!((kind.weave, kind.crossing), (Some(2), Some(crossing)), "{hairs}");
                assert!((8..=9).contains(&kind.stitches[0]), "{:?}", kind.stitches);
                assert!((0.5..1.1).contains(&found.worst_overlap), "{}", found.worst_overlap);
            }
        }
    }

    #[test]
    fn strands_whose_hair_comes_from_farther_are_read_at_the_same_places() {
        let read = braid(9.0, 40, 1.0, false);
        let ReadValues::Float(along) = &read.primvars[2].values else { panic!() };
        // The hair of the first strand comes a long way in many points.
        let (mut points, mut alongs, mut counts, mut first) = (vec![], vec![], vec![], 0);
        for (i, count) in read.counts.iter().enumerate() {
            let way = if i < 40 { 60 } else { 2 };
            let (from, u) = (read.points[first], along[first]);
            points.extend((0..way).map(|k| from + Vec3::X * (0.05 * (way - k) as f32)));
            alongs.extend(std::iter::repeat_n(u, way));
            let all = first..first + *count as usize;
            points.extend_from_slice(&read.points[all.clone()]);
            alongs.extend_from_slice(&along[all.clone()]);
            counts.push(count + way as u32);
            first = all.end;
        }
        let mut read = ReadCurves { points, counts, ..read };
        read.primvars[2].values = ReadValues::Float(alongs);
        let found = measured(&read);
        assert_eq!((found.braids, found.broken_words, found.kinds[0].weave), (1, 0, Some(2)));
    }

    #[test]
    fn a_crossing_the_wrong_way_breaks_the_law() {
        for hairs in [1, 40] {
            assert!(measured(&braid(9.0, hairs, 1.0, false)).are_woven());
            assert!(!measured(&braid(9.0, hairs, 1.0, true)).are_woven(), "{hairs}");
        }
    }
}
