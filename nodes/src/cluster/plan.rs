//! The plan of an interpolation: where hair roots, which guides shape each hair, and with what weights. It depends on the guides'
//! roots alone.

use crate::data::attributes::{Domain, ROOT_BARY, ROOT_TRIANGLE};
use crate::data::curves::{Tuft, TuftBuilder};
use crate::data::scalp::{Root, Scalp};
use crate::data::sections::Sections;
use crate::define::{FieldInput, NodeError};
use crate::eval::{EvalCx, Size};
use crate::guides::even_roots::{EvenRoot, EvenRoots};
use crate::maths::hash::{Dice, Key, KeyBuilder};
use crate::maths::nearest::KdTree;
use crate::maths::spline::{CurveFault, Spline};
use glam::{Vec2, Vec3};
use std::ops::Range;
use std::sync::Arc;

/// Settings of a plan.
pub(super) struct PlanParams<'a> {
    /// Number of hairs, of which the mask keeps its share; `None`: by density.
    pub count: Option<usize>,
    /// Hairs per cm2.
    pub density: f32,
    pub mask: &'a FieldInput,
    /// CVs per hair.
    pub points: usize,
    pub neighbours: usize,
    /// Guides farther than this are ignored, cm; 0: no limit.
    pub reach: f32,
    pub seed: i64,
}

/// A hair without a shape.
#[derive(Clone, Copy)]
pub(super) struct PlannedHair {
    /// Index in the list of even roots, and name there.
    pub index: u32,
    pub name: u64,
    pub triangle: u32,
    pub bary: Vec2,
    pub uv: Vec2,
    pub point: Vec3,
    pub normal: Vec3,
    /// Start and number of its entries in the batch's list of weights.
    weights: (u32, u32),
}

/// Hair whose nearest guide is the same.
pub(super) struct GuideHair {
    pub key: Key,
    /// Guides that shape it, its own first.
    pub guides: Vec<u32>,
    /// Its hair, for [`Plan::hair`], in the order in which a rising density adds it.
    pub hairs: Vec<HairIndex>,
}

/// Index of a hair: its batch, and its index in the batch.
pub(super) type HairIndex = (u32, u32);

/// All hair without shapes, grouped by nearest guide.
#[derive(Default)]
pub(super) struct Plan {
    pub groups: Vec<GuideHair>,
    found: Vec<Found>,
    /// Scalp normal at each guide's root.
    pub normals: Vec<Vec3>,
    /// Id of the section that each guide is rooted in; 0 on a scalp without partings.
    pub sections: Vec<u64>,
    /// Hairs left out because their section has no guide.
    pub led_by_none: usize,
    /// Number of requested hairs that were not found in ten times as many candidates.
    pub missing: usize,
}

/// Approximate number of roots per piece of work: a stretch of the row in which all triangles lie, so they are close on the scalp.
const BATCH: usize = 2048;
/// Smallest number of candidates to search for missing hair.
const ROUND: usize = 4096;
/// Candidates that are looked up together.
const CHUNK: usize = 16 * BATCH;
/// Number of candidates after which the total size is checked.
const LONG_ROUND: usize = 1 << 20;
/// Approximate number of pieces of work in which groups are assembled.
const PIECES: usize = 64;
/// Where partings separate guides, this many times the requested number of guides is searched.
const BEYOND: usize = 4;

/// Hair of one batch, along the curve, with guide indices and weights, nearest first.
#[derive(Default)]
struct Found {
    hairs: Vec<PlannedHair>,
    weights: Vec<(u32, f32)>,
    led_by_none: usize,
    /// Indices of hairs that count and that the mask leaves out.
    left_out: Vec<u32>,
}

impl Found {
    /// Indices of all hairs that count.
    fn counted(&self) -> impl Iterator<Item = u32> {
        self.hairs.iter().map(|hair| hair.index).chain(self.left_out.iter().copied())
    }
}

/// A place in the list of even roots, and whether the mask keeps the hair there.
type Place = (Listed, Root, bool);

impl Plan {
    /// The plan for these guides (one per tuft), from the cache or made.
    pub(super) fn of(
        cx: &EvalCx,
        guides: &[Arc<Tuft>],
        scalp: &Scalp,
        asked: &PlanParams,
    ) -> Result<Arc<Plan>, NodeError> {
        // A guide without a valid spline is ignored. Building the spline is the test; it takes a microsecond.
        let faults = each_guide(cx, guides, |_, tuft| Spline::new(tuft.curve(0)).err())?;
        let root = |(tuft, fault): (&Arc<Tuft>, Option<CurveFault>)| match fault {
            None => tuft.curve(0)[0],
            Some(fault) => {
                cx.trouble(tuft.id(0), fault);
                Vec3::NAN
            }
        };
        let roots: Vec<Vec3> = guides.iter().zip(faults).map(root).collect();
        // The key covers only what the plan reads, so a change of width or clumping keeps the plan.
        let key = KeyBuilder::new("plan")
            .int(cx.seed)
            .key(scalp.key())
            .int(asked.count.map_or(u64::MAX, |count| count as u64))
            .float(asked.density)
            .int(asked.neighbours as u64)
            .float(asked.reach)
            .int(asked.seed as u64);
        let key = asked.mask.field.add_to(key).float(asked.mask.range.0).float(asked.mask.range.1);
        let key = guides.iter().zip(&roots).fold(key, |key, (tuft, root)| {
            let bary = tuft.view(ROOT_BARY).at(0, 0);
            let triangle = tuft.view(ROOT_TRIANGLE).at(0, 0);
            key.vec3(*root).int(triangle as u64).float(bary.x).float(bary.y)
        });
        cx.memo(key.finish(), || {
            let plan = Self::new(cx, guides, &roots, scalp, asked)?;
            let of_groups = plan.groups.iter().map(|group| size_of_val(&group.hairs[..]) + 256);
            let of_hair = plan
                .found
                .iter()
                .map(|found| size_of_val(&found.hairs[..]) + size_of_val(&found.weights[..]));
            let bytes = of_groups.chain(of_hair).sum();
            Ok((plan, bytes))
        })
    }

    fn new(
        cx: &EvalCx,
        guides: &[Arc<Tuft>],
        roots: &[Vec3],
        scalp: &Scalp,
        asked: &PlanParams,
    ) -> Result<Plan, NodeError> {
        let skin = cx.skin(scalp);
        let surface = scalp.surface();
        let normals = each_guide(cx, guides, |i, tuft| {
            let bound = u32::try_from(tuft.view(ROOT_TRIANGLE).at(0, 0)).ok();
            match bound.filter(|t| (*t as usize) < surface.triangles.len()) {
                Some(t) => surface.smooth_normal(t, tuft.view(ROOT_BARY).at(0, 0)),
                None => skin
                    .closest(roots[i])
                    .map_or(Vec3::Y, |hit| surface.smooth_normal(hit.triangle, hit.bary)),
            }
        })?;
        let finder = Finder {
            forest: Forest::new(roots, scalp),
            even: EvenRoots::new(scalp, cx.dice(asked.seed, "roots")),
            keep: cx.dice(asked.seed, "mask"),
            roots,
            scalp,
            asked,
        };
        let area = finder.even.area();
        let wanted = asked.count.unwrap_or_else(|| (f64::from(asked.density) * area) as usize);
        // By density, one pass over the list. By count, passes until enough are found: a soft edge, a parting or a reach may reject
        // many; the limit is ten times the count.
        let last = if asked.count.is_some() { wanted.saturating_mul(10) } else { wanted };
        let last = match asked.count {
            Some(_) => last.saturating_mul(finder.even.places_for_one() as usize),
            None => last,
        };
        let last = last.min(wanted.saturating_mul(10).max(20_000_000)).min(u32::MAX as usize);
        let mut found: Vec<Found> = vec![];
        let (mut start, mut count, mut kept) = (0, 0, 0);
        while start < last && count < wanted && area > 0.0 && !guides.is_empty() {
            let round = (wanted - count).clamp(ROUND, LONG_ROUND).min(last - start);
            let mut more = finder.round(cx, start as u32..(start + round) as u32)?;
            let mut indices: Vec<u32> = more.iter().flat_map(Found::counted).collect();
            let new = indices.len();
            if new > wanted - count {
                // The requested number is reached within this pass.
                let (_, end, _) = indices.select_nth_unstable(wanted - count);
                more.iter_mut().for_each(|found| found.hairs.retain(|hair| hair.index < *end));
            }
            more.iter_mut().for_each(|found| found.left_out = vec![]);
            kept += more.iter().map(|found| found.hairs.len()).sum::<usize>();
            found.append(&mut more);
            count += new;
            start += round;
            if start < last && count < wanted {
                let so_far = ("hairs so far", cx.thinned(kept) as f64);
                cx.may_make(&Size::of(&[so_far, ("points", asked.points as f64)]))?;
            }
        }
        let grows = area > 0.0 && !guides.is_empty();
        let missing = asked.count.filter(|_| grows).map_or(0, |_| wanted.saturating_sub(count));
        let mut plan = Plan {
            groups: vec![],
            missing,
            led_by_none: found.iter().map(|found| found.led_by_none).sum(),
            found,
            normals,
            sections: finder.forest.ids,
        };
        plan.groups = plan.grouped(cx)?;
        Ok(plan)
    }

    /// A hair, its guides, nearest first, and their weights, which sum to 1.
    pub(super) fn hair(&self, (batch, i): HairIndex) -> (&PlannedHair, &[(u32, f32)]) {
        let found = &self.found[batch as usize];
        let hair = &found.hairs[i as usize];
        let (at, count) = hair.weights;
        (hair, &found.weights[at as usize..][..count as usize])
    }

    /// The hair of all batches, by nearest guide.
    fn grouped(&self, cx: &EvalCx) -> Result<Vec<GuideHair>, NodeError> {
        let places = || {
            (0..).zip(&self.found).flat_map(|(batch, found)| {
                let own = |hair: &PlannedHair| found.weights[hair.weights.0 as usize].0 as usize;
                (0..).zip(&found.hairs).map(move |(i, hair)| (own(hair), (hair.index, (batch, i))))
            })
        };
        // First the end of each guide's hair in the list, then its start.
        let mut ends = vec![0; self.normals.len()];
        places().for_each(|(guide, _)| ends[guide] += 1);
        let mut all = 0;
        for end in &mut ends {
            all += *end;
            *end = all;
        }
        let mut begins = ends.clone();
        let mut order: Vec<(u32, HairIndex)> = vec![(0, (0, 0)); all];
        for (guide, hair) in places() {
            begins[guide] -= 1;
            order[begins[guide]] = hair;
        }
        let led: Vec<usize> =
            (0..ends.len()).filter(|guide| begins[*guide] < ends[*guide]).collect();
        let each = led.len().div_ceil(PIECES).max(1);
        let pieces = cx.map(led.len().div_ceil(each), |piece| {
            let (mut slots, mut told) = (vec![NO_SLOT; ends.len()], vec![]);
            let led = led[piece * each..].iter().take(each).map(|guide| {
                let mut hairs = order[begins[*guide]..ends[*guide]].to_vec();
                hairs.sort_unstable();
                let hairs = hairs.into_iter().map(|(_, place)| place).collect();
                self.group(*guide as u32, hairs, &mut slots, &mut told)
            });
            Ok(led.collect::<Vec<GuideHair>>())
        })?;
        Ok(pieces.into_iter().flatten().collect())
    }

    /// One group. `slots` has [`NO_SLOT`] for each guide, before and after; `told` is scratch memory.
    fn group(
        &self,
        guide: u32,
        hairs: Vec<HairIndex>,
        slots: &mut [u32],
        told: &mut Vec<u64>,
    ) -> GuideHair {
        let both = |a: u32, b: u32| u64::from(a) << 32 | u64::from(b);
        let mut guides = vec![guide];
        slots[guide as usize] = 0;
        told.clear();
        for place in &hairs {
            let (hair, blend) = self.hair(*place);
            told.extend([hair.name, blend.len() as u64]);
            for (guide, weight) in blend {
                let slot = &mut slots[*guide as usize];
                if *slot == NO_SLOT {
                    *slot = guides.len() as u32;
                    guides.push(*guide);
                }
                told.push(both(*slot, weight.to_bits()));
            }
        }
        guides.iter().for_each(|guide| slots[*guide as usize] = NO_SLOT);
        let key = KeyBuilder::new("group").column(told);
        let key = guides.iter().fold(key, |key, g| key.vec3(self.normals[*g as usize]));
        GuideHair { key: key.finish(), guides, hairs }
    }
}

/// For guides that have no slot in a group.
const NO_SLOT: u32 = u32::MAX;

/// Data about each guide, computed in pieces.
fn each_guide<T: Send + Sync>(
    cx: &EvalCx,
    guides: &[Arc<Tuft>],
    tell: impl Fn(usize, &Tuft) -> T + Sync,
) -> Result<Vec<T>, NodeError> {
    let each = guides.len().div_ceil(PIECES).max(1);
    let pieces = cx.map(guides.len().div_ceil(each), |piece| {
        let all = piece * each..guides.len().min((piece + 1) * each);
        Ok(all.map(|i| tell(i, &guides[i])).collect::<Vec<T>>())
    })?;
    Ok(pieces.into_iter().flatten().collect())
}

/// An even root by its index in the list, and its name.
type Listed = (u32, u64);

/// Finds roots, and the guides of each.
struct Finder<'a> {
    forest: Forest<'a>,
    even: EvenRoots<'a>,
    keep: Dice,
    roots: &'a [Vec3],
    scalp: &'a Scalp,
    asked: &'a PlanParams<'a>,
}

impl Finder<'_> {
    /// The hair of a range of the list, in batches that are consecutive along the curve.
    fn round(&self, cx: &EvalCx, indices: Range<u32>) -> Result<Vec<Found>, NodeError> {
        let bits = (indices.len() / BATCH).max(1).ilog2();
        let mut batches: Vec<Vec<u64>> = vec![];
        batches.resize_with(1 << bits, || Vec::with_capacity((indices.len() >> bits) + 8));
        let all = cx.map(indices.len().div_ceil(CHUNK), |chunk| {
            let from = indices.start + (chunk * CHUNK) as u32;
            let listed = from..indices.end.min(from + CHUNK as u32);
            let along = |i: u32| u64::from(self.even.along(i)) << 32 | u64::from(i);
            Ok(listed.map(along).collect::<Vec<u64>>())
        })?;
        for along in all.into_iter().flatten() {
            batches[(along >> 32 >> (32 - bits)) as usize].push(along);
        }
        cx.map(batches.len(), |b| {
            let mut along = batches[b].clone();
            along.sort_unstable();
            self.batch(along.into_iter().map(|one| one as u32))
        })
    }

    /// The hair with these indices, which are close along the curve.
    fn batch(&self, indices: impl Iterator<Item = u32>) -> Result<Found, NodeError> {
        let root = |i: u32| {
            let EvenRoot { name, triangle, bary } = self.even.get(i)?;
            Some(((i, name), self.scalp.root(triangle, bary)))
        };
        let rooted: Vec<(Listed, Root)> = indices.filter_map(root).collect();
        let chance = |(_, name): Listed| self.keep.unit(name, 0);
        let mut rooted = masked(rooted, self.asked.mask, self.scalp, chance)?;
        if self.asked.count.is_none() {
            rooted.retain(|(.., kept)| *kept);
        }
        let mut found = Found::default();
        // For each hair, its tree of guides and its distance from the next parting.
        let mut places = vec![(0, f32::MAX); rooted.len()];
        if let Some(cut) = self.forest.cut {
            places.clear();
            rooted.retain(|(_, root, kept)| {
                let Some(place) = cut.at_root(root).filter(|place| place.free) else {
                    return false;
                };
                let tree = place.section as usize;
                let is_led = self.forest.trees[tree].is_some();
                found.led_by_none += usize::from(!is_led && *kept);
                if is_led {
                    places.push((tree, place.distance));
                }
                is_led
            });
        }
        let points: Vec<Vec3> = rooted.iter().map(|(_, root, _)| root.point).collect();
        found.hairs.reserve_exact(rooted.len());
        found.weights.reserve(rooted.len() * self.asked.neighbours);
        let mut start = 0;
        for run in places.chunk_by(|a, b| a.0 == b.0) {
            let Some(tree) = &self.forest.trees[run[0].0] else { continue };
            let points = &points[start..start + run.len()];
            tree.find_each(points, self.asked.neighbours + 1, |i, near| {
                self.forest.open_to(tree, points[i], run[i].1, self.roots, near);
                let at = found.weights.len();
                weigh(near, self.asked, &mut found.weights);
                let count = found.weights.len() - at;
                let ((index, name), root, kept) = &rooted[start + i];
                if count > 0 && !kept {
                    found.weights.truncate(at);
                    found.left_out.push(*index);
                } else if count > 0 {
                    found.hairs.push(PlannedHair {
                        index: *index,
                        name: *name,
                        triangle: root.triangle,
                        bary: root.bary,
                        uv: root.uv,
                        point: root.point,
                        normal: root.normal,
                        weights: (at as u32, count as u32),
                    });
                }
            });
            start += run.len();
        }
        Ok(found)
    }
}

/// Guides by section. A hair is shaped only by guides of its own section, and not by those behind a parting that ends within the
/// section.
struct Forest<'a> {
    cut: Option<&'a Sections>,
    /// One per section that has guides, or one for a scalp without partings.
    trees: Vec<Option<KdTree>>,
    ids: Vec<u64>,
}

impl<'a> Forest<'a> {
    fn new(roots: &[Vec3], scalp: &'a Scalp) -> Self {
        let Some(cut) = scalp.sections() else {
            let trees = vec![Some(KdTree::new(roots.iter().copied()))];
            return Self { cut: None, trees, ids: vec![0; roots.len()] };
        };
        let at: Vec<Option<u32>> =
            roots.iter().map(|p| cut.at(*p).map(|place| place.section)).collect();
        let mut of: Vec<Vec<(Vec3, u32)>> = vec![vec![]; cut.list().len()];
        for ((p, number), at) in roots.iter().zip(0..).zip(&at) {
            if let Some(section) = at {
                of[*section as usize].push((*p, number));
            }
        }
        let tree = |of: Vec<(Vec3, u32)>| (!of.is_empty()).then(|| KdTree::numbered(of));
        let trees = of.into_iter().map(tree).collect();
        let id = |at: &Option<u32>| at.map_or(0, |at| cut.list()[at as usize].id);
        Self { cut: Some(cut), trees, ids: at.iter().map(id).collect() }
    }
    /// The guides nearest to `p` that no parting separates from it, nearest first; all nearby ones if a parting separates every
    /// one. `parting` is the distance to the next parting, cm.
    fn open_to(
        &self,
        tree: &KdTree,
        p: Vec3,
        parting: f32,
        roots: &[Vec3],
        near: &mut Vec<(f32, u32)>,
    ) {
        let (Some(cut), Some((far, _))) = (self.cut, near.last()) else { return };
        if parting * parting > *far {
            return;
        }
        let open = |(_, guide): &(f32, u32)| !cut.crosses(p, roots[*guide as usize]);
        if near.iter().all(open) {
            return;
        }
        let count = near.len();
        tree.find(p, count * BEYOND, near);
        if near.iter().any(open) {
            near.retain(open);
        }
        near.truncate(count);
    }
}

/// The roots, with which of them the mask keeps.
fn masked(
    roots: Vec<(Listed, Root)>,
    mask: &FieldInput,
    scalp: &Scalp,
    chance: impl Fn(Listed) -> f32,
) -> Result<Vec<Place>, NodeError> {
    if mask.constant() == Some(1.0) {
        return Ok(roots.into_iter().map(|(i, root)| (i, root, true)).collect());
    }
    let mut b = TuftBuilder::even(roots.iter().map(|(_, r)| r.point).collect(), 1);
    b.set(ROOT_TRIANGLE, Domain::Curve, roots.iter().map(|(_, r)| r.triangle as i32).collect());
    b.set(ROOT_BARY, Domain::Curve, roots.iter().map(|(_, r)| r.bary).collect());
    let tuft = b.build();
    let mask = mask.on(&tuft, Some(scalp))?;
    let kept = |slot, i| chance(i) < mask.at(slot, slot, 0.0);
    Ok((0..).zip(roots).map(|(slot, (i, root))| (i, root, kept(slot, i))).collect())
}

/// Adds the guides of a hair with their weights, nearest first: (1/d - 1/R)^2, where R is the distance of the first guide that is
/// ignored, so that a guide's weight is zero when another replaces it.
fn weigh(near: &[(f32, u32)], asked: &PlanParams, blend: &mut Vec<(u32, f32)>) {
    let first = blend.len();
    let mut horizon = near.get(asked.neighbours).map_or(f32::MAX, |(d2, _)| d2.sqrt());
    if asked.reach > 0.0 {
        horizon = horizon.min(asked.reach);
    }
    let mut sum = 0.0;
    for (d2, guide) in near.iter().take(asked.neighbours) {
        // A hair at a guide's root copies the guide: a thousandth of a millimetre counts as the same place.
        let d = d2.sqrt().max(1e-4);
        let share = (1.0 / d - 1.0 / horizon).max(0.0);
        if d >= horizon && blend.len() > first || asked.reach > 0.0 && d >= asked.reach {
            break;
        }
        blend.push((*guide, share * share));
        sum += share * share;
    }
    if sum > 0.0 {
        blend[first..].iter_mut().for_each(|(_, weight)| *weight /= sum);
    } else if blend.len() > first {
        // All are as far as the first ignored guide: the nearest alone is used.
        blend.truncate(first + 1);
        blend[first].1 = 1.0;
    }
}
