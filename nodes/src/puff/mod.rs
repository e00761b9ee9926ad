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

use crate::data::curves::Curves;
use crate::data::scalp::{Root, Scalp};
use crate::define::{NodeDef, NodeError};
use crate::eval::EvalCx;
use glam::Vec3;

pub(crate) const NODES: &[&NodeDef] =
    &[&gather::NODE, &sphere_puff::NODE, &press_puffs::NODE, &tail::NODE, &bun::NODE];

/// The most positions of puffs or ties: each searches its paths over the whole head.
const MOST_PLACES: usize = 256;

/// The roots of placements and their ids.
fn placed(cx: &EvalCx, scalp: &Scalp, placements: &Curves) -> Result<Vec<(Root, u64)>, NodeError> {
    let count = placements.curve_count();
    if count > MOST_PLACES {
        return Err(NodeError::BadValue {
            input: "placements",
            value: format!("{count} curves"),
            reason: format!("are more than {MOST_PLACES} places: wire fewer curves"),
        });
    }
    let mut out = vec![];
    for (tuft, i) in placements.each() {
        let at = tuft.curve(i).first().copied().unwrap_or(Vec3::NAN);
        match scalp.closest_root(at) {
            Some(middle) => out.push((middle, tuft.id(i))),
            None => cx.trouble(tuft.id(i), "a placement without a root was left out"),
        }
    }
    Ok(out)
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
