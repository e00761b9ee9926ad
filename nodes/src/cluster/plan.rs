//! Where the hair between guides roots, and which guides each follows how much: from the guides' roots alone.

use super::interpolate::MOST_GUIDES;
use crate::data::attributes::{Domain, ROOT_BARY, ROOT_TRIANGLE};
use crate::data::curves::{Tuft, TuftBuilder};
use crate::data::scalp::{Root, Scalp};
use crate::data::sections::Sections;
use crate::define::{FieldInput, NodeError};
use crate::eval::EvalCx;
use crate::guides::even_roots::EvenRoots;
use crate::maths::hash::{Key, KeyBuilder};
use crate::maths::nearest::Nearest;
use crate::maths::spline::Spline;
use glam::{Vec2, Vec3};
use std::ops::Range;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

/// What the artist asks of the plan.
pub(super) struct Asked<'a> {
    /// Hairs in all; none: by density.
    pub count: Option<usize>,
    /// Hairs a cm2.
    pub density: f32,
    pub mask: &'a FieldInput,
    pub neighbours: usize,
    /// cm; 0: no limit.
    pub reach: f32,
    pub seed: i64,
}

/// A hair before it has a shape.
pub(super) struct Hair {
    /// Number in the list of even roots.
    pub index: u32,
    pub triangle: u32,
    pub bary: Vec2,
    pub point: Vec3,
    pub normal: Vec3,
    /// Where its guides stand in the group's weights, and how many.
    pub weights: (u32, u32),
}

/// The hair nearest to one guide.
pub(super) struct Group {
    pub key: Key,
    /// Guides that shape it, its own first.
    pub guides: Vec<u32>,
    pub hairs: Range<usize>,
    pub weights: Range<usize>,
}

/// All hair before it has a shape, gathered by nearest guide.
#[derive(Default)]
pub(super) struct Plan {
    pub groups: Vec<Group>,
    /// By group, then in the order in which density adds them.
    pub hairs: Vec<Hair>,
    /// For each hair: number in the group's `guides` and weight. Weights of a hair add up to one.
    pub weights: Vec<(u16, f32)>,
    /// Scalp normal at each guide's root.
    pub normals: Vec<Vec3>,
    /// Id of the section that each guide is rooted in; 0 where the scalp is not parted.
    pub sections: Vec<u64>,
    /// Hairs left out because no guide stands in their section.
    pub led_by_none: usize,
}

/// Roots found in one piece of work.
const BATCH: usize = 4096;
/// Where a parting stands before guides so many times as many are asked.
const BEYOND: usize = 4;

/// A root with its guides, nearest first.
struct Found {
    index: u32,
    root: Root,
    blend: [(u32, f32); MOST_GUIDES],
    count: u32,
}

impl Plan {
    /// The plan for these guides (one a tuft), made or remembered.
    pub(super) fn of(
        cx: &EvalCx,
        guides: &[Arc<Tuft>],
        scalp: &Scalp,
        asked: &Asked,
    ) -> Result<Arc<Plan>, NodeError> {
        let mut roots = Vec::with_capacity(guides.len());
        for tuft in guides {
            // A guide without a shape shapes nothing. Building the spline is the test, a microsecond each.
            roots.push(match Spline::new(tuft.curve(0)) {
                Ok(_) => tuft.curve(0)[0],
                Err(fault) => {
                    cx.trouble(tuft.id(0), fault);
                    Vec3::NAN
                }
            });
        }
        // Only what the plan reads: a change of width or clumping keeps it.
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
        let key = key.finish();
        if let Some(plan) = cx.host.find(key).and_then(|kept| kept.downcast::<Plan>().ok()) {
            return Ok(plan);
        }
        let plan = Arc::new(Self::new(cx, guides, &roots, scalp, asked)?);
        let bytes = plan.hairs.len() * size_of::<Hair>()
            + plan.weights.len() * size_of::<(u16, f32)>()
            + plan.groups.len() * 256;
        cx.host.keep(key, plan.clone(), bytes);
        Ok(plan)
    }

    fn new(
        cx: &EvalCx,
        guides: &[Arc<Tuft>],
        roots: &[Vec3],
        scalp: &Scalp,
        asked: &Asked,
    ) -> Result<Plan, NodeError> {
        let skin = cx.skin(scalp);
        let surface = scalp.surface();
        let normals: Vec<Vec3> = guides
            .iter()
            .zip(roots)
            .map(|(tuft, root)| {
                let bound = u32::try_from(tuft.view(ROOT_TRIANGLE).at(0, 0)).ok();
                match bound.filter(|t| (*t as usize) < surface.triangles.len()) {
                    Some(t) => surface.smooth_normal(t, tuft.view(ROOT_BARY).at(0, 0)),
                    None => skin
                        .closest(*root)
                        .map_or(Vec3::Y, |hit| surface.smooth_normal(hit.triangle, hit.bary)),
                }
            })
            .collect();
        let forest = Forest::new(roots, scalp);
        let even = EvenRoots::new(scalp, cx.dice(asked.seed, "roots"));
        let keep = cx.dice(asked.seed, "mask");
        let wanted =
            asked.count.unwrap_or_else(|| (f64::from(asked.density) * even.area()) as usize);
        // By density: the list is gone through once. By count: until as many are found as asked for, which a soft
        // edge, a mask or a reach may make more than that; ten times is where one gives up.
        let last = if asked.count.is_some() { wanted.saturating_mul(10) } else { wanted };
        let last = last.min(20_000_000);
        let led_by_none = AtomicUsize::new(0);
        let mut hairs: Vec<Found> = vec![];
        let mut start = 0;
        while start < last && hairs.len() < wanted && even.area() > 0.0 && !guides.is_empty() {
            let round = (wanted - hairs.len()).max(BATCH).min(last - start);
            let batches = round.div_ceil(BATCH);
            let found: Vec<OnceLock<Vec<Found>>> = (0..batches).map(|_| OnceLock::new()).collect();
            let fault = Mutex::new(None);
            cx.host.for_each(batches, &|b| {
                if cx.host.cancelled() {
                    return;
                }
                let from = (start + b * BATCH) as u32;
                let to = (start + round).min(start + (b + 1) * BATCH) as u32;
                let some: Vec<(u32, Root)> =
                    (from..to).filter_map(|i| Some((i, even.root(i)?))).collect();
                let some = match masked(some, asked.mask, scalp, |i| keep.unit(u64::from(i), 0)) {
                    Ok(some) => some,
                    Err(err) => {
                        *fault.lock().unwrap_or_else(PoisonError::into_inner) = Some(err);
                        return;
                    }
                };
                let mut near = vec![];
                let mut alone = 0;
                let blend = |(index, root): (u32, Root)| {
                    let Some(tree) = forest.tree_at(root.point) else {
                        alone += 1;
                        return None;
                    };
                    forest.candidates(tree, root.point, roots, asked.neighbours + 1, &mut near);
                    let (blend, count) = weigh(&near, asked);
                    (count > 0).then_some(Found { index, root, blend, count })
                };
                let found = found[b].set(some.into_iter().filter_map(blend).collect());
                if found.is_ok() {
                    led_by_none.fetch_add(alone, Ordering::Relaxed);
                }
            });
            if let Some(fault) = fault.into_inner().unwrap_or_else(PoisonError::into_inner) {
                return Err(fault);
            }
            cx.check()?;
            hairs.extend(found.into_iter().filter_map(OnceLock::into_inner).flatten());
            start += round;
        }
        hairs.truncate(wanted);
        let mut plan = Self::grouped(hairs, normals);
        plan.sections = forest.ids;
        plan.led_by_none = led_by_none.into_inner();
        Ok(plan)
    }

    fn grouped(found: Vec<Found>, normals: Vec<Vec3>) -> Self {
        let mut order: Vec<Vec<u32>> = vec![vec![]; normals.len()];
        for (i, hair) in (0..).zip(&found) {
            order[hair.blend[0].0 as usize].push(i);
        }
        let mut plan = Plan { normals, ..Plan::default() };
        plan.hairs.reserve_exact(found.len());
        for (guide, members) in (0..).zip(order).filter(|(_, members)| !members.is_empty()) {
            let (first, first_weight) = (plan.hairs.len(), plan.weights.len());
            let mut guides = vec![guide];
            let mut key = KeyBuilder::new("group");
            for i in members {
                let Found { index, root, blend, count } = &found[i as usize];
                key = key.int(u64::from(*index));
                let at = (plan.weights.len() - first_weight) as u32;
                for (guide, weight) in &blend[..*count as usize] {
                    let slot = guides.iter().position(|g| g == guide).unwrap_or_else(|| {
                        guides.push(*guide);
                        guides.len() - 1
                    });
                    key = key.int(slot as u64).float(*weight);
                    plan.weights.push((slot as u16, *weight));
                }
                plan.hairs.push(Hair {
                    index: *index,
                    triangle: root.triangle,
                    bary: root.bary,
                    point: root.point,
                    normal: root.normal,
                    weights: (at, *count),
                });
            }
            let key = guides.iter().fold(key, |key, g| key.vec3(plan.normals[*g as usize]));
            plan.groups.push(Group {
                key: key.finish(),
                guides,
                hairs: first..plan.hairs.len(),
                weights: first_weight..plan.weights.len(),
            });
        }
        plan
    }
}

/// Guides by the section that they are rooted in: those of another section have no say, however near they are, nor have those
/// beyond a parting that ends within the section.
struct Forest<'a> {
    cut: Option<&'a Sections>,
    /// One for each section (with guides), or one for a scalp that is not parted.
    trees: Vec<Option<Nearest>>,
    ids: Vec<u64>,
}

impl<'a> Forest<'a> {
    fn new(roots: &[Vec3], scalp: &'a Scalp) -> Self {
        let Some(cut) = scalp.sections() else {
            let trees = vec![Some(Nearest::new(roots.iter().copied()))];
            return Self { cut: None, trees, ids: vec![0; roots.len()] };
        };
        let at: Vec<Option<u32>> =
            roots.iter().map(|p| cut.at(*p).map(|place| place.section)).collect();
        // A tree leaves out what is not finite, and keeps the others' numbers.
        let of = |section: u32| {
            let own = |(p, at): (&Vec3, &Option<u32>)| {
                if *at == Some(section) { *p } else { Vec3::NAN }
            };
            at.contains(&Some(section)).then(|| Nearest::new(roots.iter().zip(&at).map(own)))
        };
        let trees = (0..cut.list().len() as u32).map(of).collect();
        let id = |at: &Option<u32>| at.map_or(0, |at| cut.list()[at as usize].id);
        Self { cut: Some(cut), trees, ids: at.iter().map(id).collect() }
    }
    /// The `count` guides nearest to `p` that no parting stands before, nearest first; all that are near where one stands before
    /// every one of them.
    fn candidates(
        &self,
        tree: &Nearest,
        p: Vec3,
        roots: &[Vec3],
        count: usize,
        near: &mut Vec<(f32, u32)>,
    ) {
        tree.find(p, count, near);
        let (Some(cut), Some((far, _))) = (self.cut, near.last()) else { return };
        if cut.at(p).is_none_or(|place| place.distance * place.distance > *far) {
            return;
        }
        let open = |(_, guide): &(f32, u32)| !cut.crosses(p, roots[*guide as usize]);
        if near.iter().all(open) {
            return;
        }
        tree.find(p, count * BEYOND, near);
        if near.iter().any(open) {
            near.retain(open);
        }
        near.truncate(count);
    }
    fn tree_at(&self, p: Vec3) -> Option<&Nearest> {
        let at = match self.cut {
            Some(cut) => cut.at(p)?.section as usize,
            None => 0,
        };
        self.trees[at].as_ref()
    }
}

/// Those of the roots that a mask keeps.
fn masked(
    roots: Vec<(u32, Root)>,
    mask: &FieldInput,
    scalp: &Scalp,
    chance: impl Fn(u32) -> f32,
) -> Result<Vec<(u32, Root)>, NodeError> {
    if mask.constant() == Some(1.0) {
        return Ok(roots);
    }
    let mut b = TuftBuilder::even(roots.iter().map(|(_, r)| r.point).collect(), 1);
    b.set(ROOT_TRIANGLE, Domain::Curve, roots.iter().map(|(_, r)| r.triangle as i32).collect());
    b.set(ROOT_BARY, Domain::Curve, roots.iter().map(|(_, r)| r.bary).collect());
    let tuft = b.build();
    let mask = mask.on(&tuft, Some(scalp))?;
    let kept = (0..).zip(roots).filter(|(slot, (i, _))| chance(*i) < mask.at(*slot, *slot, 0.0));
    Ok(kept.map(|(_, root)| root).collect())
}

/// The guides of a hair with their weights, nearest first: (1/d - 1/R)^2 with R the distance of the first guide
/// that does not count, so that a guide's weight is zero when another takes its place.
fn weigh(near: &[(f32, u32)], asked: &Asked) -> ([(u32, f32); MOST_GUIDES], u32) {
    let mut blend = [(0, 0.0); MOST_GUIDES];
    let mut horizon = near.get(asked.neighbours).map_or(f32::MAX, |(d2, _)| d2.sqrt());
    if asked.reach > 0.0 {
        horizon = horizon.min(asked.reach);
    }
    let (mut count, mut sum) = (0, 0.0);
    for ((d2, guide), slot) in near.iter().take(asked.neighbours).zip(&mut blend) {
        // A hair on a guide's root is its copy: a thousandth of a millimetre is as near as nothing.
        let d = d2.sqrt().max(1e-4);
        let share = 1.0 / d - 1.0 / horizon;
        if d >= horizon && count > 0 || asked.reach > 0.0 && d >= asked.reach {
            break;
        }
        *slot = (*guide, share.max(0.0) * share.max(0.0));
        sum += slot.1;
        count += 1;
    }
    if sum > 0.0 {
        blend.iter_mut().for_each(|slot| slot.1 /= sum);
    } else {
        // All as near as the first that does not count: the nearest alone.
        blend[0].1 = 1.0;
        count = count.min(1);
    }
    (blend, count)
}
