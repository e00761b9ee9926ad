//! What can be said of the braids of a file: word, crossing, distances of strands, height over the skin, hair per stitch.

use super::prim::{Column, Prim, in_parts, quantile};
use super::spine::{Spine, View};
use super::strands::{Braid, Section, braids};
use super::word::{Crossing, Word};
use coif_nodes::data::scalp::Scalp;
use glam::Vec3;
use serde::Serialize;
use std::collections::{BTreeMap, BTreeSet};

/// The braids of one prim.
#[derive(Serialize)]
pub(super) struct Braids {
    pub(super) braids: usize,
    /// Strands of all braids.
    pub(super) strands: usize,
    /// Whether strands are single tubes; else they are made of hair, and their radius is that of its spread.
    pub(super) tubes: bool,
    /// Largest (r_i + r_j) / distance of two strands of a braid: 1 touches, more overlaps. Strands of hair press into one
    /// another, and what is drawn together at their ends is left out.
    pub(super) worst_overlap: f32,
    /// Braids of a kind together.
    pub(super) kinds: Vec<Kind>,
    /// Braids whose crossings are not those of one weave all along.
    pub(super) broken_words: usize,
    /// With a scalp: lowest, middle and highest distance, cm, of the braids' middle lines from the skin.
    pub(super) height_cm: Option<[f32; 3]>,
    /// With a scalp: the smallest, over the braids the middle of the smallest, and the largest smallest distance, cm,
    /// between skin and strands, negative where they reach into it.
    pub(super) gap_cm: Option<[f32; 3]>,
    pub(super) joined: Option<Joined>,
}

/// Braids with the same crossings.
#[derive(Serialize)]
pub(super) struct Kind {
    pub(super) braids: usize,
    pub(super) strands: usize,
    /// Frequency of the weave; null: none is braided so.
    pub(super) weave: Option<usize>,
    /// One stitch's factor: `s1` the pair farthest left, `^-1` where the strand going right is behind.
    pub(super) factor: String,
    /// `under`, `over`, `either` (both are the same braid), or `not known` where nothing in the file tells its front.
    pub(super) crossing: &'static str,
    /// Fewest, middle and most stitches of a braid.
    pub(super) stitches: [usize; 3],
}

/// How hair joins braids.
#[derive(Serialize)]
pub(super) struct Joined {
    /// Hairs that grow and join.
    pub(super) grown: usize,
    /// Extension hairs fed in.
    pub(super) fed: usize,
    /// Hairs of braids that join at no stitch.
    pub(super) unjoined: usize,
    /// Stitches at which hair joins, of all braids.
    pub(super) stitches: usize,
    /// Stitches between a braid's first and last with hair at which none joins.
    pub(super) empty_stitches: usize,
    /// Fewest, middle and most hairs joined at a stitch where any do.
    pub(super) a_stitch: [usize; 3],
}

pub(super) fn measure(prim: &Prim, scalp: Option<&Scalp>) -> Option<Braids> {
    let skin = scalp.map(Scalp::skin);
    let all = braids(prim, skin.as_ref());
    let joined = joined(prim);
    if all.is_empty() {
        return None;
    }
    let root_front = prim.vectors("scalp_normal");
    let found = in_parts(all.len(), 1, |part| {
        let braid = &all[part.start];
        One::of(prim, braid, scalp, root_front.as_ref())
    });
    let mut kinds: BTreeMap<(usize, Option<usize>, String, &'static str), Vec<usize>> =
        BTreeMap::new();
    let mut broken = 0;
    for (one, braid) in found.iter().zip(&all) {
        let Some(word) = &one.word else {
            broken += 1;
            continue;
        };
        broken += usize::from(word.faults > 0 || word.weave().is_none());
        let crossing = match (word.crossing(), one.front_known) {
            (Crossing::Either, _) => "either",
            (_, false) => "not known",
            (Crossing::Under, true) => "under",
            (Crossing::Over, true) => "over",
        };
        let kind = (braid.strands.len(), word.weave(), word.factor(), crossing);
        kinds.entry(kind).or_default().push(word.stitches);
    }
    let kinds = kinds.into_iter().map(|((strands, weave, factor, crossing), mut stitches)| {
        stitches.sort_unstable();
        let (low, high) = (stitches[0], stitches[stitches.len() - 1]);
        let stitches_ = [low, stitches[stitches.len() / 2], high];
        Kind { braids: stitches.len(), strands, weave, factor, crossing, stitches: stitches_ }
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
        joined,
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
        prim: &Prim,
        braid: &Braid,
        scalp: Option<&Scalp>,
        root_front: Option<&Column<Vec3>>,
    ) -> Self {
        let spine = Spine::of(braid);
        let told = spine.told(prim, braid, scalp, root_front);
        let View { sections, woven: (first, last), word } = View::of(&spine, &told, braid);
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
fn overlap(braid: &Braid, woven: std::ops::Range<usize>) -> f32 {
    const BLOCK: usize = 16;
    // The sphere about each block of samples, radii included: blocks that are apart are passed over.
    let blocks: Vec<Vec<(Vec3, f32)>> = braid
        .strands
        .iter()
        .map(|strand| {
            let around = |block: &[Section]| {
                let middle = block.iter().map(|s| s.middle).sum::<Vec3>() / block.len() as f32;
                let reach = |s: &Section| s.middle.distance(middle) + s.radius;
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

pub(super) fn joined(prim: &Prim) -> Option<Joined> {
    let (braid, stitch) = (prim.whole("braid")?, prim.whole("stitch")?);
    let fed = prim.whole("fed").unwrap_or_else(|| vec![0; prim.len()]);
    let mut counts: BTreeMap<(i64, i64), usize> = BTreeMap::new();
    let mut out =
        Joined { grown: 0, fed: 0, unjoined: 0, stitches: 0, empty_stitches: 0, a_stitch: [0; 3] };
    for i in (0..prim.len()).filter(|i| braid[*i] != 0) {
        match (stitch[i] >= 0, fed[i] > 0) {
            (false, _) => out.unjoined += 1,
            (true, true) => out.fed += 1,
            (true, false) => {
                out.grown += 1;
                *counts.entry((braid[i], stitch[i])).or_default() += 1;
            }
        }
    }
    out.stitches = counts.len();
    for braid in counts.keys().map(|(b, _)| *b).collect::<BTreeSet<i64>>() {
        let of = || counts.keys().filter(|(b, _)| *b == braid).map(|(_, s)| *s);
        let span = of().max()? - of().min()? + 1;
        out.empty_stitches += span as usize - of().count();
    }
    let mut sizes: Vec<usize> = counts.into_values().collect();
    sizes.sort_unstable();
    if let (Some(low), Some(high)) = (sizes.first(), sizes.last()) {
        out.a_stitch = [*low, sizes[sizes.len() / 2], *high];
    }
    (out.grown + out.fed > 0).then_some(out)
}
