//! Puffs and other gathered hair.

mod bun;
mod bundle;
mod dome;
mod gather;
#[cfg(test)]
mod gather_laws;
#[cfg(test)]
mod laws;
pub(crate) mod outline;
mod press;
#[cfg(test)]
mod press_laws;
mod press_puffs;
mod sphere_puff;
mod tail;
mod tie;

use crate::data::attributes::BRAID;
use crate::data::curves::{Curves, Tuft};
use crate::data::scalp::{Root, Scalp};
use crate::define::{NodeDef, NodeError, choice};
use crate::eval::EvalCx;
use glam::Vec3;
use std::collections::BTreeMap;

pub(crate) const NODES: &[&NodeDef] =
    &[&gather::NODE, &sphere_puff::NODE, &press_puffs::NODE, &tail::NODE, &bun::NODE];

/// The most positions of puffs or ties: each searches its paths over the whole head.
const MOST_PLACES: usize = 256;

choice! {
    /// Which end of each placement is the place.
    At {
        /// Its root.
        Roots = "roots",
        /// Its tip, where it lies near the scalp. The strands of a braid have one place together.
        Tips = "tips",
    }
}

/// The farthest from the scalp that the tip of a placement may lie, in head units.
const FARTHEST_TIP: f32 = 4.0;

/// The places that placements mark on the scalp, with their ids.
fn placed(
    cx: &EvalCx,
    scalp: &Scalp,
    placements: &Curves,
    at: At,
) -> Result<Vec<(Root, u64)>, NodeError> {
    let ends = match at {
        At::Roots => roots(placements),
        At::Tips => tips(placements),
    };
    let count = ends.len();
    if count > MOST_PLACES {
        return Err(NodeError::BadValue {
            input: "placements",
            value: format!("{count} curves"),
            reason: format!("are more than {MOST_PLACES} places: wire fewer curves"),
        });
    }
    let mut out = vec![];
    for (end, id) in ends {
        match (scalp.closest_root(end), at) {
            (Some(middle), At::Tips) if middle.point.distance(end) > FARTHEST_TIP * cx.unit() => {
                cx.trouble(id, "the tip of a placement hangs off the scalp and was left out");
            }
            (Some(middle), _) => out.push((middle, id)),
            (None, At::Roots) => cx.trouble(id, "a placement without a root was left out"),
            (None, At::Tips) => cx.trouble(id, "a placement without a tip was left out"),
        }
    }
    Ok(out)
}

fn roots(placements: &Curves) -> Vec<(Vec3, u64)> {
    let root = |tuft: &Tuft, i: usize| tuft.curve(i).first().copied().unwrap_or(Vec3::NAN);
    placements.each().map(|(tuft, i)| (root(tuft, i), tuft.id(i))).collect()
}

/// The tips, with the ids of their curves; of the strands of a braid the middle of all tips, with its id.
fn tips(placements: &Curves) -> Vec<(Vec3, u64)> {
    let mut out: Vec<(Vec3, u64, f32)> = vec![];
    let mut braids: BTreeMap<u64, usize> = BTreeMap::new();
    for (tuft, i) in placements.each() {
        let tip = tuft.curve(i).last().copied().unwrap_or(Vec3::NAN);
        let braid = tuft.view(BRAID).at(i, tuft.range(i).start);
        match braids.get(&braid).filter(|_| braid != BRAID.default) {
            Some(at) => {
                let (sum, _, count) = &mut out[*at];
                (*sum, *count) = (*sum + tip, *count + 1.0);
            }
            None => {
                let id = if braid == BRAID.default { tuft.id(i) } else { braid };
                braids.insert(braid, out.len());
                out.push((tip, id, 1.0));
            }
        }
    }
    out.into_iter().map(|(sum, id, count)| (sum / count, id)).collect()
}

/// The scalp in a direction (head units) from the centre of the cranium: the outermost surface there, or else the
/// closest.
fn picked(scalp: &Scalp, position: Vec3) -> Option<Root> {
    let frame = scalp.frame();
    let to = scalp.place(position);
    let out = (to - frame.origin).try_normalize().unwrap_or(frame.up);
    let (low, high) = scalp.surface().bounds();
    let reach = low.distance(high) + frame.origin.distance(0.5 * (low + high));
    let hit = scalp.surface().ray(frame.origin + out * reach, -out * reach, 1.0);
    hit.map(|hit| scalp.root(hit.triangle, hit.bary)).or_else(|| scalp.closest_root(to))
}
