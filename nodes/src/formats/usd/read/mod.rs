//! Reads BasisCurves out of `.usda`, `.usdc` and `.usdz` bytes.
//!
//! `text` and `crate_file` turn bytes into a layer of prim specs (`tree`), of which only what curves need is decoded; `package` finds
//! layers in a `.usdz`, `layers` those that others name, and `compose` makes the prims of a stage of them. Here curves are gathered
//! (`curves`), walked down from the root for transforms, purpose and visibility (`world`), and brought to centimetres with Y up.
//!
//! Guaranteed: hostile bytes give an error, never a panic, an endless loop or more memory than 64 MiB + 20 times the length of all
//! files read, and 256 MiB for curves that are brought in more than once, and half as much for the arcs that do it. Sublayers, references, payloads, classes, selected variants
//! and instances are followed as far as `compose` says; what is left out is told, and what is wrong with one prim or one curve does
//! not hide the others. Of animated values the default counts, else the earliest sample.

pub(in crate::formats) mod budget;
mod compose;
mod crate_arcs;
mod crate_file;
mod curves;
mod layers;
mod package;
mod text;
mod tree;
mod values;
mod world;

use super::super::FormatError;
use super::form::Form;
use glam::{DMat4, DVec3, Vec3};
pub use layers::Beside;
use tree::Stage;
pub use values::{ReadPrimvar, ReadValues, ReadWidths};
use world::World;

pub(in crate::formats) use curves::{Bad, negative_widths, wrong_counts, wrong_width};
pub(in crate::formats) use values::InterpolationCounts;
pub(in crate::formats) use world::width_scale;

/// What a file has of curves.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ReadStage {
    /// Curves prims that have points, in file order.
    pub curves: Vec<ReadCurves>,
    /// What was left out, at most a hundred entries and one for the rest.
    pub left_out: Vec<LeftOut>,
}

/// Something of a file that was not read.
#[derive(Clone, Debug, PartialEq)]
pub struct LeftOut {
    /// Path of the prim; `/` for the layer itself.
    pub path: String,
    /// What it is: `reference`, `payload`, `sublayer`, `variant set`, `curves`, the type of a prim and so on.
    pub kind: String,
    /// Where it leads, as in `@hair.usda@</head>`; empty where it leads nowhere.
    pub asset: String,
    /// Why it was left out.
    pub reason: String,
    /// Curves are missing for it: the file contradicts itself there, or they are of a kind that is not read. Else there is only
    /// something that is not followed or not found.
    pub is_broken: bool,
}

/// The curves of one BasisCurves prim, in centimetres, Y up.
#[derive(Clone, Debug, PartialEq)]
pub struct ReadCurves {
    /// Path of the prim.
    pub path: String,
    /// `default`, `render`, `proxy` or `guide`, inherited as USD has it.
    pub purpose: String,
    /// Neither it nor a prim above is invisible.
    pub is_visible: bool,
    /// Points of each curve; 0 and 1 are possible. They add up to the points.
    pub counts: Vec<u32>,
    /// Root to tip in world space: finite, centimetres, Y up.
    pub points: Vec<Vec3>,
    /// Which curve the points stand for.
    pub form: Form,
    /// Diameters in centimetres, scaled as the transforms scale volumes.
    pub widths: Option<ReadWidths>,
    /// Everything else under `primvars:`, values as written, indices resolved.
    pub primvars: Vec<ReadPrimvar>,
    /// What was left out and why, one sentence each.
    pub notes: Vec<String>,
}

impl ReadCurves {
    /// Makes all lengths so many times as large: points and widths. 1 keeps their bits.
    pub fn scale(&mut self, factor: f32) {
        if factor == 1.0 {
            return;
        }
        let widths = self.widths.iter_mut().flat_map(|widths| &mut widths.values);
        widths.for_each(|width| *width *= factor);
        self.points.iter_mut().for_each(|point| *point *= factor);
    }
}

/// Reads all BasisCurves of a file.
///
/// The bytes decide what they are; `file_name` (without a folder) only has to end as USD files do. `beside` gives the files that
/// this one names, those in its folder and below.
///
/// # Errors
/// Damaged bytes with the line or byte, and units that are no length. What is wrong with one prim is told in what is left out.
pub fn read_stage(bytes: &[u8], file_name: &str, beside: Beside) -> Result<ReadStage, FormatError> {
    let extension = file_name.rsplit_once('.').map_or("", |(_, extension)| extension);
    let known = ["usd", "usda", "usdc", "usdz"];
    if !known.iter().any(|known| extension.eq_ignore_ascii_case(known)) {
        return Err(FormatError::at("file name", format!(".{extension} is no USD file")));
    }
    let mut budget = budget::ReadBudget::for_file(bytes.len());
    let mut told = Told::default();
    let mut layers = layers::Layers::open(bytes, file_name, beside, &mut budget)?;
    let stage = compose::compose(&mut layers, bytes.len(), &mut told, &mut budget)?;
    gather(stage, told, &mut budget)
}

fn gather(
    mut stage: Stage,
    mut told: Told,
    budget: &mut budget::ReadBudget,
) -> Result<ReadStage, FormatError> {
    let centimetres_from_stage = centimetres_from_stage(&stage)?;
    let worlds = World::of_prims(&stage, centimetres_from_stage, budget)?;
    let mut found = Vec::new();
    if let Some(axis) = stage.up_axis.as_deref().filter(|axis| !matches!(*axis, "Y" | "Z")) {
        told.leave_out(LeftOut {
            path: "/".into(),
            kind: "upAxis".into(),
            asset: String::new(),
            reason: format!("{axis:?} is none of \"Y\", \"Z\"; Y was taken"),
            is_broken: true,
        });
    }
    for (index, world) in worlds.iter().enumerate() {
        tell_unread(&stage, index, &mut told, budget)?;
        if stage.prims[index].type_name != "BasisCurves" {
            continue;
        }
        let path = stage.path(index, budget)?;
        let broken = |reason: String| LeftOut {
            path: path.clone(),
            kind: "curves".into(),
            asset: String::new(),
            reason,
            is_broken: true,
        };
        if let Err(error) = world.check(&stage, budget) {
            told.leave_out(broken(format!("the transform of {error}")));
            continue;
        }
        let attributes = std::mem::take(&mut stage.prims[index].attributes);
        match curves::CurvesPrim::new(&path, world, attributes).curves(budget) {
            Ok(curves::PrimCurves { curves, faults, is_empty }) => {
                faults.into_iter().for_each(|fault| told.leave_out(broken(fault)));
                if is_empty {
                    let reason = "it has no points, or no curveVertexCounts".to_owned();
                    told.leave_out(LeftOut { is_broken: false, ..broken(reason) });
                }
                found.extend(curves);
            }
            Err(error) => told.leave_out(broken(error.to_string())),
        }
    }
    Ok(ReadStage { curves: found, left_out: told.all() })
}

/// Tells which values of a prim have samples in time that are not read, and which transform operations do nothing.
fn tell_unread(
    stage: &Stage,
    index: usize,
    told: &mut Told,
    budget: &mut budget::ReadBudget,
) -> Result<(), FormatError> {
    let prim = &stage.prims[index];
    let animated: Vec<&tree::PrimAttribute> =
        prim.attributes.iter().filter(|attribute| attribute.unread > 0).collect();
    let idle = world::operations_without_value(prim);
    if animated.is_empty() && idle.is_empty() {
        return Ok(());
    }
    if told.is_full() {
        told.more += usize::from(!animated.is_empty()) + usize::from(!idle.is_empty());
        return Ok(());
    }
    let path = stage.path(index, budget)?;
    let mut leave_out = |kind: &str, reason: String| {
        let (path, kind) = (path.clone(), kind.to_owned());
        told.leave_out(LeftOut { path, kind, asset: String::new(), reason, is_broken: false });
    };
    if let Some(most) = animated.iter().map(|attribute| attribute.unread).max() {
        let names = listed(animated.iter().map(|attribute| attribute.name.as_str()));
        leave_out(
            "time samples",
            format!(
                "{names}: up to {most} samples are not read; the default counts, else the earliest"
            ),
        );
    }
    if !idle.is_empty() {
        let names = listed(idle.into_iter());
        leave_out("xformOpOrder", format!("{names}: no value that is read, so nothing is done"));
    }
    Ok(())
}

/// The first few names.
fn listed<'a>(names: impl Iterator<Item = &'a str>) -> String {
    const MOST: usize = 8;
    let clipped = |name: &'a str| name.chars().take(64).collect::<String>();
    let mut all: Vec<String> = names.take(MOST + 1).map(clipped).collect();
    if all.len() > MOST {
        all[MOST] = "more".to_owned();
    }
    all.join(", ")
}

/// What is left out, bounded.
#[derive(Default)]
pub(in crate::formats) struct Told {
    list: Vec<LeftOut>,
    more: usize,
    is_more_broken: bool,
}

/// How much of what is left out is told one by one.
const MOST_TOLD: usize = 100;

impl Told {
    fn is_full(&self) -> bool {
        self.list.len() >= MOST_TOLD
    }

    fn more(&mut self) {
        self.more += 1;
    }

    pub(in crate::formats) fn leave_out(&mut self, what: LeftOut) {
        if self.is_full() {
            self.more += 1;
            self.is_more_broken |= what.is_broken;
        } else {
            self.list.push(what);
        }
    }

    pub(in crate::formats) fn all(mut self) -> Vec<LeftOut> {
        if self.more > 0 {
            self.list.push(LeftOut {
                path: "/".into(),
                kind: "more".into(),
                asset: String::new(),
                reason: format!("{} more were left out and are not told one by one", self.more),
                is_broken: self.is_more_broken,
            });
        }
        self.list
    }
}

/// Scale and axes of the layer: USD's defaults are centimetres, Y up.
fn centimetres_from_stage(stage: &Stage) -> Result<DMat4, FormatError> {
    let meters_per_unit = stage.meters_per_unit.unwrap_or(0.01);
    if !(meters_per_unit.is_finite() && meters_per_unit > 0.0) {
        let reason = format!("{meters_per_unit} is no length");
        return Err(FormatError::at("metersPerUnit", reason));
    }
    // Dividing, not multiplying by 100: 0.01 then gives 1 exactly, and points keep their bits.
    let scale = DMat4::from_scale(DVec3::splat(meters_per_unit / 0.01));
    let y_up = DMat4::from_cols_array_2d(&[
        [1.0, 0.0, 0.0, 0.0],
        [0.0, 0.0, -1.0, 0.0],
        [0.0, 1.0, 0.0, 0.0],
        [0.0, 0.0, 0.0, 1.0],
    ]);
    match stage.up_axis.as_deref() {
        Some("Z") => Ok(y_up * scale),
        _ => Ok(scale),
    }
}

/// Reads curves of a file alone, or the first thing that is wrong with it: what tests ask for.
#[cfg(test)]
pub(crate) fn read_alone(bytes: &[u8], extension: &str) -> Result<Vec<ReadCurves>, String> {
    let nothing = &mut |_: &str| Err("there is nothing beside it".to_owned());
    let read = read_stage(bytes, &format!("file.{extension}"), nothing);
    let read = read.map_err(|error| error.to_string())?;
    match read.left_out.iter().find(|what| what.is_broken) {
        Some(what) => Err(format!("{}.{}", what.path, what.reason)),
        None => Ok(read.curves),
    }
}
