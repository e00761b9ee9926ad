//! Takes the curves of a BasisCurves prim out of its attributes: counts, points, form, widths and primvars that fit each other.
//!
//! Guaranteed: a curve with a point that is no finite number is left out and told, with all of its values, and the others are read.
//! Counts that contradict the points, and tokens of no known curve, are the fault of the whole prim. Columns that do not fit are left
//! out with a note.

use super::super::super::FormatError;
use super::super::form::{FARTHEST, Form, is_position};
use super::ReadCurves;
use super::budget::ReadBudget;
use super::tree::{ParsedValue, PrimAttribute};
use super::values::{
    InterpolationCounts, ReadPrimvar, ReadValues, ReadWidths, Unresolved, is_interpolation,
};
use super::world::World;
use glam::{DMat4, Vec3};

/// A BasisCurves prim while its curves are taken out.
pub(super) struct CurvesPrim<'a> {
    path: &'a str,
    world: &'a World,
    attributes: Vec<PrimAttribute>,
}

/// What was found of a prim.
pub(super) struct PrimCurves {
    /// Its sound curves.
    pub(super) curves: Option<ReadCurves>,
    /// What is wrong with others.
    pub(super) faults: Vec<String>,
    /// It says nothing of any curve.
    pub(super) is_empty: bool,
}

impl<'a> CurvesPrim<'a> {
    pub(super) fn new(path: &'a str, world: &'a World, attributes: Vec<PrimAttribute>) -> Self {
        Self { path, world, attributes }
    }

    /// The curves; the place of an error is the attribute.
    pub(super) fn curves(mut self, budget: &mut ReadBudget) -> Result<PrimCurves, FormatError> {
        let counts = self.take("curveVertexCounts").and_then(|a| a.value);
        let points = self.take("points").and_then(|a| a.value);
        let (Some(counts), Some(points)) = (counts, points) else {
            return Ok(PrimCurves { curves: None, faults: vec![], is_empty: true });
        };
        let mut points = points_of(points)?;
        let counts = counts_of(counts, points.len(), budget)?;
        let [curve_type, basis, wrap] =
            [("type", "cubic"), ("basis", "bezier"), ("wrap", "nonperiodic")]
                .map(|(name, default)| self.token(name, default));
        let form = Form::of(&curve_type, &basis, &wrap)
            .map_err(|(place, reason)| FormatError::at(place, reason))?;
        let mut bad = Bad::of(&counts, &points);
        self.to_world(&mut points);
        if bad.faults.is_empty() {
            bad = Bad::of(&counts, &points);
        }
        let mut notes: Vec<String> = wrong_counts(form, &counts).into_iter().collect();
        let shape = InterpolationCounts::of(form, &counts, points.len());
        let widths = self.widths(&shape, &mut notes, budget)?;
        let primvars = self.primvars(&shape, &mut notes, budget)?;
        let mut curves = ReadCurves {
            path: self.path.to_owned(),
            purpose: self.world.purpose.clone(),
            is_visible: self.world.is_visible,
            counts,
            points,
            form,
            widths,
            primvars,
            notes,
        };
        let is_left = bad.drop_from(&mut curves, budget)?;
        let curves = is_left.then_some(curves);
        Ok(PrimCurves { curves, faults: bad.faults, is_empty: false })
    }

    fn take(&mut self, name: &str) -> Option<PrimAttribute> {
        let index = self.attributes.iter().position(|attribute| attribute.name == name)?;
        // The order of what is left is the file's order of primvars.
        Some(self.attributes.remove(index))
    }

    fn token(&mut self, name: &str, default: &str) -> String {
        match self.take(name).and_then(|attribute| attribute.value) {
            Some(ParsedValue::Texts(texts)) if texts.len() == 1 => texts.into_iter().next(),
            _ => None,
        }
        .unwrap_or_else(|| default.to_owned())
    }

    /// Moves points to the world. An identity is left out, so that such points keep their bits.
    fn to_world(&self, points: &mut [Vec3]) {
        if self.world.centimetres_from_local == DMat4::IDENTITY {
            return;
        }
        for point in points {
            let moved = self.world.centimetres_from_local.transform_point3(point.as_dvec3());
            *point = moved.as_vec3();
        }
    }

    /// Widths: those of `primvars:widths` where there are any, as USD has it.
    fn widths(
        &mut self,
        shape: &InterpolationCounts,
        notes: &mut Vec<String>,
        budget: &mut ReadBudget,
    ) -> Result<Option<ReadWidths>, FormatError> {
        let plain = self.take("widths");
        let primvar = self.take("primvars:widths").filter(|attribute| attribute.value.is_some());
        let indices = self.take("primvars:widths:indices").and_then(|attribute| attribute.value);
        let (attribute, default, indices) = match (primvar, plain, indices) {
            (Some(primvar), _, Some(ParsedValue::Ints(indices))) => {
                (primvar, "constant", Some(indices))
            }
            (Some(primvar), ..) => (primvar, "constant", None),
            (None, Some(plain), _) => (plain, "vertex", None),
            _ => return Ok(None),
        };
        let PrimAttribute { name, type_name, interpolation, value: Some(value), .. } = attribute
        else {
            return Ok(None);
        };
        let mut left_out = |reason: String| {
            notes.push(format!("{name} were left out: {reason}"));
            Ok(None)
        };
        let interpolation = interpolation.unwrap_or_else(|| default.into());
        if !is_interpolation(&interpolation) {
            return left_out(format!("curves have no {interpolation:?} interpolation"));
        }
        // Files state one width for all without saying "constant", and renderers take it so.
        let interpolation = match value.len() {
            1 if indices.is_none() => "constant".into(),
            _ => interpolation,
        };
        let unresolved =
            Unresolved { name: name.clone(), type_name, interpolation: Some(interpolation), value };
        let resolved = match unresolved.resolve(indices.as_deref(), shape, budget)? {
            Ok(resolved) => resolved,
            Err(reason) => return left_out(reason),
        };
        let ReadPrimvar { interpolation, values: ReadValues::Float(mut values), .. } = resolved
        else {
            return left_out("the values are no numbers".into());
        };
        let scale = self.world.width_scale();
        values.iter_mut().for_each(|width| *width = (*width as f64 * scale) as f32);
        match wrong_width(&values) {
            Some(reason) => left_out(reason),
            None => {
                notes.extend(negative_widths(&values));
                Ok(Some(ReadWidths { interpolation, values }))
            }
        }
    }

    fn primvars(
        &mut self,
        shape: &InterpolationCounts,
        notes: &mut Vec<String>,
        budget: &mut ReadBudget,
    ) -> Result<Vec<ReadPrimvar>, FormatError> {
        let mut primvars = Vec::new();
        let mut indices = Vec::new();
        for attribute in std::mem::take(&mut self.attributes) {
            let Some(name) = attribute.name.strip_prefix("primvars:") else { continue };
            match (name.strip_suffix(":indices"), attribute.value) {
                (_, None) => {}
                (Some(of), Some(ParsedValue::Ints(values))) => {
                    indices.push((of.to_owned(), values))
                }
                (_, Some(value)) => primvars.push(Unresolved {
                    name: name.to_owned(),
                    type_name: attribute.type_name,
                    interpolation: attribute.interpolation,
                    value,
                }),
            }
        }
        indices.sort_by(|a, b| a.0.cmp(&b.0));
        let mut read = Vec::new();
        for primvar in primvars {
            let found = indices.binary_search_by(|(of, _)| of.as_str().cmp(&primvar.name)).ok();
            let indices = found.map(|found| indices[found].1.as_slice());
            let name = primvar.name.clone();
            match primvar.resolve(indices, shape, budget)? {
                Ok(primvar) => read.push(primvar),
                Err(reason) => notes.push(format!("primvar {name} was left out: {reason}")),
            }
        }
        Ok(read)
    }
}

/// Why widths cannot be measured; none where they can.
pub(in crate::formats) fn wrong_width(widths: &[f32]) -> Option<String> {
    let wrong = |width: &f32| !width.is_finite() || width.abs() > FARTHEST;
    let index = widths.iter().position(wrong)?;
    let what = match widths[index].is_finite() {
        true => format!("more than {FARTHEST:e} cm"),
        false => "no finite number".to_owned(),
    };
    Some(format!("width {index} is {}, {what}", widths[index]))
}

/// What there is to say of widths below zero, which no hair has.
pub(in crate::formats) fn negative_widths(widths: &[f32]) -> Option<String> {
    let index = widths.iter().position(|width| *width < 0.0)?;
    let n = widths.iter().filter(|width| **width < 0.0).count();
    Some(format!(
        "{n} of {} widths are negative, which no curve has: width {index} is {} cm",
        widths.len(),
        widths[index]
    ))
}

/// What is wrong with curves of which there are none, for their number of points; none where all are curves.
pub(in crate::formats) fn wrong_counts(form: Form, counts: &[u32]) -> Option<String> {
    let wrong = counts.iter().enumerate().filter(|(_, n)| form.spans(**n as usize).is_none());
    let (curve, count) = wrong.clone().next()?;
    Some(format!(
        "{} of {} curves are none: curve {curve} has {count} points, and {form} curves have {}",
        wrong.count(),
        counts.len(),
        form.counts()
    ))
}

/// Which curves have a point that is no position, or none that can be measured.
pub(in crate::formats) struct Bad {
    is_sound: Vec<bool>,
    /// What is wrong, a sentence each.
    pub(in crate::formats) faults: Vec<String>,
}

/// How many such curves are told one by one.
const MOST_FAULTS: usize = 10;

impl Bad {
    pub(in crate::formats) fn of(counts: &[u32], points: &[Vec3]) -> Self {
        let mut out = Self { is_sound: Vec::new(), faults: Vec::new() };
        if points.iter().all(|point| is_position(*point)) {
            return out;
        }
        let (mut first, mut more) = (0, 0);
        for (curve, count) in counts.iter().enumerate() {
            let own = &points[first..first + *count as usize];
            first += own.len();
            let bad = own.iter().position(|point| !is_position(*point));
            out.is_sound.push(bad.is_none());
            let Some(at) = bad else { continue };
            if out.faults.len() < MOST_FAULTS {
                let Vec3 { x, y, z } = own[at];
                let what = match own[at].is_finite() {
                    true => format!("farther off than {FARTHEST:e} cm"),
                    false => "no finite position".to_owned(),
                };
                out.faults.push(format!(
                    "points: curve {curve} was left out: its point {at} is ({x}, {y}, {z}), {what}"
                ));
            } else {
                more += 1;
            }
        }
        if more > 0 {
            out.faults.push(format!("points: {more} more curves were left out so"));
        }
        out
    }

    /// Drops bad curves with all of their values. Gives whether there are curves still.
    pub(in crate::formats) fn drop_from(
        &self,
        curves: &mut ReadCurves,
        budget: &mut ReadBudget,
    ) -> Result<bool, FormatError> {
        if self.faults.is_empty() {
            return Ok(true);
        }
        budget.charge(curves.points.len() as u64)?;
        let ReadCurves { counts, points, form, widths, primvars, .. } = curves;
        if let Some(widths) = widths {
            self.drop_values(&mut widths.values, &widths.interpolation, *form, counts);
        }
        for ReadPrimvar { values, interpolation, .. } in primvars {
            match values {
                ReadValues::Int(v) => self.drop_values(v, interpolation, *form, counts),
                ReadValues::Int64(v) => self.drop_values(v, interpolation, *form, counts),
                ReadValues::Float(v) => self.drop_values(v, interpolation, *form, counts),
                ReadValues::Float2(v) => self.drop_values(v, interpolation, *form, counts),
                ReadValues::Float3(v) => self.drop_values(v, interpolation, *form, counts),
                ReadValues::Text(v) => self.drop_values(v, interpolation, *form, counts),
            }
        }
        self.drop_values(points, "vertex", *form, counts);
        let mut is_sound = self.is_sound.iter();
        counts.retain(|_| is_sound.next() != Some(&false));
        Ok(!counts.is_empty())
    }

    fn drop_values<T>(&self, values: &mut Vec<T>, interpolation: &str, form: Form, counts: &[u32]) {
        let each = |count: &u32| match interpolation {
            "constant" => 0,
            "uniform" => 1,
            "vertex" => *count as usize,
            _ => form.varying(*count as usize),
        };
        if interpolation == "constant" {
            return;
        }
        let sizes = counts.iter().map(each).zip(&self.is_sound);
        let mut keeps = sizes.flat_map(|(n, is_sound)| std::iter::repeat_n(*is_sound, n));
        values.retain(|_| keeps.next() != Some(false));
    }
}

fn points_of(value: ParsedValue) -> Result<Vec<Vec3>, FormatError> {
    match value {
        ParsedValue::Float3s(points) => Ok(points),
        ParsedValue::Doubles { per: 3, values } => {
            let vector = |v: &[f64]| Vec3::new(v[0] as f32, v[1] as f32, v[2] as f32);
            Ok(values.chunks_exact(3).map(vector).collect())
        }
        _ => Err(FormatError::at("points", "the values are no positions")),
    }
}

fn counts_of(
    value: ParsedValue,
    points: usize,
    budget: &mut ReadBudget,
) -> Result<Vec<u32>, FormatError> {
    let error = |reason| Err(FormatError::at("curveVertexCounts", reason));
    let ParsedValue::Ints(signed) = value else {
        return error("the values are no integers".to_owned());
    };
    budget.charge_items::<u32>(signed.len() as u64)?;
    let mut counts = Vec::with_capacity(signed.len());
    let mut counted = 0u64;
    for (curve, &count) in signed.iter().enumerate() {
        let Ok(count) = u32::try_from(count) else {
            return error(format!("curve {curve} has {count} points"));
        };
        counted += count as u64;
        counts.push(count);
    }
    if counted != points as u64 {
        return error(format!("the curves count {counted} points, but there are {points}"));
    }
    Ok(counts)
}
