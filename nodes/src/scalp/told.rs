//! What is known of a head before it is made: the masks that it may have, and what it refuses by its inputs alone.
//!
//! Guarantees: nothing is refused here that the head would not refuse. Not promised: that the rest is made; only the head looks at
//! triangles.

use super::bust;
use super::head::{INNER_WALL, read, unknown_region};
use crate::data::laid::LEAST_POINTS;
use crate::data::mesh::Mesh;
use crate::data::scalp::REGION;
use crate::data::sections::named_points;
use crate::define::{KnownInputs, NodeError, Value};

/// The mesh; none where it is not known yet, or cannot be read.
fn mesh(told: &KnownInputs) -> Option<Mesh> {
    match told.value("mesh") {
        Some(Value::File(file)) => read(&file).ok(),
        None if !told.arrives("mesh") => Some(bust::adult()),
        _ => None,
    }
}

fn text(told: &KnownInputs, name: &str) -> String {
    match told.value(name) {
        Some(Value::Text(text)) => text.to_string(),
        _ => String::new(),
    }
}

/// Names of the mesh's own masks, materials and parts.
fn of_mesh(mesh: Mesh) -> Vec<String> {
    let materials = mesh.materials.iter().map(|name| format!("material:{name}"));
    let parts = mesh.parts.iter().map(|name| format!("part:{name}"));
    mesh.masks.into_keys().chain(materials).chain(parts).collect()
}

/// Names of all masks that the head may have.
pub(super) fn mask_names(told: &KnownInputs) -> Option<Vec<String>> {
    let mut names = of_mesh(mesh(told)?);
    names.extend([REGION.to_owned(), INNER_WALL.to_owned()]);
    if told.is("region", "hairline") {
        names.extend(named_points(&text(told, "names")).0.into_iter().map(|(name, _)| name));
    }
    names.sort();
    names.dedup();
    Some(names)
}

/// A region by a name that the mesh does not have, or by lines that are not drawn.
pub(super) fn refused(told: &KnownInputs) -> Result<(), NodeError> {
    if told.is("region", "hairline")
        && let Some(Value::Strokes(strokes)) = told.value("hairline")
        && strokes.0.iter().all(|stroke| stroke.samples.len() < LEAST_POINTS)
    {
        return Err(NodeError::failed("no outline is drawn: draw a closed stroke"));
    }
    let by_mask = told.is("region", "mask");
    if !by_mask && !told.is("region", "material") {
        return Ok(());
    }
    let Some(mesh) = mesh(told) else { return Ok(()) };
    let (known, named) = (of_mesh(mesh), text(told, "region_name"));
    let (prefix, asked): (&str, Vec<&str>) = match by_mask {
        true => ("", vec![named.trim()]),
        false => ("material:", named.split(',').map(str::trim).collect()),
    };
    let is_known = |name: &str| {
        name == INNER_WALL && by_mask
            || known.iter().any(|it| it.strip_prefix(prefix) == Some(name))
    };
    match asked.into_iter().find(|name| !is_known(name)) {
        Some(name) => Err(unknown_region(name, prefix, known.iter().map(String::as_str))),
        None => Ok(()),
    }
}
