//! The head: where hair grows, masks painted on it, and curves projected onto it.

mod axes;
pub mod bust;
#[cfg(test)]
mod carry_laws;
mod choose;
pub(crate) mod detour;
mod drawn;
mod face;
mod facing;
mod find;
mod fit;
mod geodesic;
pub(crate) mod hairline;
mod head;
mod hollow;
#[cfg(test)]
mod landmark_laws;
mod landmarks;
pub(crate) mod lay;
mod other_side;
mod paint_mask;
mod parts;
#[cfg(test)]
mod posed_heads;
mod region;
#[cfg(test)]
mod same_skin;
mod scalp_projection;
mod sketch;
pub(crate) mod territory;
mod texture_mask;
mod told;

use crate::define::NodeDef;

pub(crate) const NODES: &[&NodeDef] =
    &[&head::NODE, &paint_mask::NODE, &region::NODE, &scalp_projection::NODE, &texture_mask::NODE];
