//! Morph targets: how far each vertex is moved towards other shapes of its mesh, as blend shapes do.
//!
//! Source: glTF 2.0 specification, section 3.7.2.2. Weights are those of the node, else those of the
//! mesh, else 0. Only positions move; targets of weight 0 are not looked at.

use super::accessor::{Accessor, Component};
use super::primitive::Primitive;
use super::scene::Draw;
use super::{Notes, Tables, index_or};
use crate::data::mesh::MeshError;
use crate::formats::mesh_in::limits::Budget;

/// Bytes that a target costs at most while its primitive is read.
const BYTES_PER_TARGET: u64 = 320;

/// The targets that move a primitive, each with its weight.
pub(super) fn targets<'a>(
    tables: &Tables<'a>,
    draw: &Draw<'a>,
    primitive: &Primitive<'a>,
    notes: &mut Notes,
    budget: &mut Budget,
) -> Result<Vec<(f64, Accessor<'a>)>, MeshError> {
    let Some(listed) = primitive.targets else { return Ok(Vec::new()) };
    let (weights, owner) = match draw.weights {
        Some(weights) => (Some(weights), draw.place.clone()),
        None => {
            let owner = format!("meshes[{}]", draw.mesh);
            (tables.meshes.item(draw.mesh, &owner)?.get("weights"), owner)
        }
    };
    let Some(weights) = weights else { return Ok(Vec::new()) };
    let mut targets = Vec::new();
    let (mut weights, mut listed) = (weights.items(), listed.items());
    for n in 0.. {
        tables.doc.tire(1)?;
        let (weight, target) = match (weights.next(), listed.next()) {
            (Some(weight), Some(target)) => (weight, target),
            (None, None) => break,
            _ => {
                notes.uneven_targets += 1;
                break;
            }
        };
        let place = format!("{}.targets[{n}]", primitive.place);
        let Some(weight) = weight.number() else {
            let reason = format!("{} is no number", weight.shown());
            return Err(MeshError::at(format!("{owner}.weights[{n}]"), reason));
        };
        if weight == 0.0 {
            continue;
        }
        // It may move normals alone.
        let Some(number) = index_or(target, "POSITION", &place)? else { continue };
        let accessor = Accessor::find(tables, number, &place)?;
        let fits = accessor.width == 3 && accessor.component != Component::U32;
        primitive.fits(&accessor, "positions of morph targets", fits)?;
        budget.take(&place, BYTES_PER_TARGET)?;
        targets.push((weight, accessor));
    }
    notes.morphed += usize::from(!targets.is_empty());
    Ok(targets)
}
