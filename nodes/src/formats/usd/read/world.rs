//! What prims inherit: their transform to the world, their purpose, and whether they are visible.
//!
//! Matrices here are for column vectors (`world_from_local * local`); USD writes them for row
//! vectors, which is the same 16 numbers in the same order.

use super::super::super::FormatError;
use super::budget::ReadBudget;
use super::tree::{ParsedValue, Prim, PrimAttribute, Stage};
use glam::{DMat4, DVec3};

/// Most operations in one prim's transform. Maya's pivots need about a dozen; each is searched by
/// name, so a hostile list of them would take the square of its length.
const MOST_OPERATIONS: usize = 64;

/// What a prim inherits from all above it.
pub(super) struct World {
    /// Takes the prim's points to centimetres, Y up.
    pub(super) centimetres_from_local: DMat4,
    pub(super) purpose: String,
    /// Neither the prim nor one above it is invisible.
    pub(super) is_visible: bool,
    /// The prim, this or above, whose transform is not understood. Only an error where curves are.
    pub(super) fault: Option<usize>,
}

impl World {
    /// One for each prim of the stage. `centimetres_from_stage` turns the layer's units and axes.
    pub(super) fn of_prims(
        stage: &Stage,
        centimetres_from_stage: DMat4,
        budget: &mut ReadBudget,
    ) -> Result<Vec<Self>, FormatError> {
        budget.charge_items::<Self>(stage.prims.len() as u64)?;
        let mut worlds: Vec<Self> = Vec::with_capacity(stage.prims.len());
        for (index, prim) in stage.prims.iter().enumerate() {
            let parent = prim.parent.map(|parent| &worlds[parent]);
            let local = Local::of(prim).ok();
            let fault =
                if local.is_none() { Some(index) } else { parent.and_then(|parent| parent.fault) };
            let local = local.unwrap_or(Local::NONE);
            let parent_matrix = match parent {
                Some(parent) if !local.resets_stack => parent.centimetres_from_local,
                _ => centimetres_from_stage,
            };
            let purpose = text_of(prim, "purpose").or(parent.map(|parent| parent.purpose.as_str()));
            worlds.push(Self {
                centimetres_from_local: parent_matrix * local.parent_from_local,
                purpose: budget.text(purpose.unwrap_or("default"))?,
                is_visible: text_of(prim, "visibility") != Some("invisible")
                    && parent.is_none_or(|parent| parent.is_visible),
                fault,
            });
        }
        Ok(worlds)
    }

    /// Refuses curves below a transform that is not understood, with the reason.
    pub(super) fn check(&self, stage: &Stage, budget: &mut ReadBudget) -> Result<(), FormatError> {
        let Some(fault) = self.fault else { return Ok(()) };
        match Local::of(&stage.prims[fault]) {
            Err(reason) => Err(FormatError::at(stage.path(fault, budget)?, reason)),
            Ok(_) => Ok(()),
        }
    }

    /// By how much widths grow.
    pub(super) fn width_scale(&self) -> f64 {
        width_scale(self.centimetres_from_local)
    }
}

/// By how much a transform widens what is as wide as long: the cube root of how much volumes grow, 1 exactly when they
/// do not.
pub(in crate::formats) fn width_scale(matrix: DMat4) -> f64 {
    if matrix == DMat4::IDENTITY {
        return 1.0;
    }
    libm::cbrt(glam::DMat3::from_mat4(matrix).determinant().abs())
}

fn text_of<'p>(prim: &'p Prim, name: &str) -> Option<&'p str> {
    find(prim, name)?.value.as_ref()?.as_text()
}

fn find<'a>(prim: &'a Prim, name: &str) -> Option<&'a PrimAttribute> {
    prim.attributes.iter().find(|attribute| attribute.name == name)
}

/// The transform operations that a prim lists and says no value of that is read: they do nothing, in USD where there is none.
pub(super) fn operations_without_value(prim: &Prim) -> Vec<&str> {
    let order = find(prim, "xformOpOrder").and_then(|attribute| attribute.value.as_ref());
    let Some(ParsedValue::Texts(order)) = order else { return vec![] };
    let names = order.iter().filter(|name| *name != "!resetXformStack!").take(MOST_OPERATIONS);
    let plain = names.map(|name| name.strip_prefix("!invert!").unwrap_or(name));
    plain
        .filter(|name| find(prim, name).is_none_or(|a| a.value.is_none() && !a.is_blocked))
        .collect()
}

/// The transform a prim states itself.
struct Local {
    parent_from_local: DMat4,
    resets_stack: bool,
}

impl Local {
    const NONE: Self = Self { parent_from_local: DMat4::IDENTITY, resets_stack: false };

    fn of(prim: &Prim) -> Result<Self, String> {
        let mut local = Self::NONE;
        let order = find(prim, "xformOpOrder").and_then(|attribute| attribute.value.as_ref());
        let Some(ParsedValue::Texts(order)) = order else { return Ok(local) };
        if order.len() > MOST_OPERATIONS {
            return Err(format!(
                "{} transform operations, more than {MOST_OPERATIONS}",
                order.len()
            ));
        }
        for name in order {
            if name == "!resetXformStack!" {
                local = Self { parent_from_local: DMat4::IDENTITY, resets_stack: true };
                continue;
            }
            let (plain, is_inverse) = match name.strip_prefix("!invert!") {
                Some(plain) => (plain, true),
                None => (name.as_str(), false),
            };
            // An operation that is listed but has no value does nothing, as in USD.
            let value = find(prim, plain).and_then(|attribute| attribute.value.as_ref());
            let Some(value) = value else { continue };
            let matrix = operation(plain, &value.numbers())
                .ok_or_else(|| format!("{plain} is no transform that is known"))?;
            let matrix = if is_inverse { matrix.inverse() } else { matrix };
            if !matrix.is_finite() {
                return Err(format!("{name} has no finite matrix"));
            }
            local.parent_from_local *= matrix;
        }
        Ok(local)
    }
}

/// The matrix of one operation, by its name: `xformOp:<kind>` or `xformOp:<kind>:<suffix>`.
fn operation(name: &str, numbers: &[f64]) -> Option<DMat4> {
    let kind = name.strip_prefix("xformOp:")?.split(':').next()?;
    let angle = || Some(numbers.first()?.to_radians());
    let vector = || match numbers {
        [x, y, z] => Some(DVec3::new(*x, *y, *z)),
        _ => None,
    };
    let along = |axis: DVec3| Some(DMat4::from_translation(axis * *numbers.first()?));
    let scaled =
        |axis: DVec3| Some(DMat4::from_scale(DVec3::ONE + axis * (numbers.first()? - 1.0)));
    match kind {
        "translate" => Some(DMat4::from_translation(vector()?)),
        "translateX" => along(DVec3::X),
        "translateY" => along(DVec3::Y),
        "translateZ" => along(DVec3::Z),
        "scale" => Some(DMat4::from_scale(vector()?)),
        "scaleX" => scaled(DVec3::X),
        "scaleY" => scaled(DVec3::Y),
        "scaleZ" => scaled(DVec3::Z),
        "rotateX" => Some(DMat4::from_rotation_x(angle()?)),
        "rotateY" => Some(DMat4::from_rotation_y(angle()?)),
        "rotateZ" => Some(DMat4::from_rotation_z(angle()?)),
        "orient" => orientation(numbers),
        "transform" => Some(DMat4::from_cols_array(numbers.try_into().ok()?)),
        _ => rotation_in_order(kind.strip_prefix("rotate")?, vector()?),
    }
}

/// As OpenUSD takes a quaternion: the angle from its real part, the axis from the others. Of float
/// parts that are off unit length by 1e-8, normalizing makes another rotation, which shows far from
/// the pivot. No axis: no rotation.
fn orientation(numbers: &[f64]) -> Option<DMat4> {
    let [w, x, y, z] = *numbers else { return None };
    let Some(axis) = DVec3::new(x, y, z).try_normalize() else { return Some(DMat4::IDENTITY) };
    Some(DMat4::from_axis_angle(axis, 2.0 * libm::acos(w.clamp(-1.0, 1.0))))
}

/// Rotations about the axes in the order of the letters: the first letter turns first.
fn rotation_in_order(letters: &str, degrees: DVec3) -> Option<DMat4> {
    if letters.len() != 3 || !"XYZ".chars().all(|axis| letters.contains(axis)) {
        return None;
    }
    let turn = |axis: char| match axis {
        'X' => DMat4::from_rotation_x(degrees.x.to_radians()),
        'Y' => DMat4::from_rotation_y(degrees.y.to_radians()),
        _ => DMat4::from_rotation_z(degrees.z.to_radians()),
    };
    Some(letters.chars().fold(DMat4::IDENTITY, |before, axis| turn(axis) * before))
}
