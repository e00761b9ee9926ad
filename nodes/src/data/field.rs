//! A number that may vary over the hair: constant, ramp, attribute, mask, painted mask, texture, or a product of these.

use super::attributes::{ALONG, Declared, Domain, ROOT_BARY, ROOT_TRIANGLE};
use super::curves::{AttributeView, Tuft, TuftBuilder};
use super::painted::Painted;
use super::ramp::Ramp;
use super::scalp::{Root, Scalp};
use super::texture::Texture;
use crate::error::NodeError;
use crate::maths::hash::KeyBuilder;
use crate::maths::lanes::{LANES, Simd, f32x8, ops::*, pick};
use glam::Vec2;
use std::sync::Arc;

/// Source of a field's values.
#[derive(Clone, Debug, PartialEq)]
pub enum Field {
    /// The same everywhere; costs nothing.
    Constant(f32),
    /// Along the curve, by the fraction of its arc length from root to tip.
    Ramp(Ramp),
    /// The attribute of this name, per curve or point.
    Attribute(String),
    /// The scalp's mask of this name, at the curve's root.
    Mask(String),
    /// A painted mask, at the curve's root. By wire only.
    Painted(Arc<Painted>),
    /// A texture on the head, at the curve's root. By wire only.
    Texture(Arc<Texture>),
    /// The product of these fields.
    Product(Vec<Field>),
}

/// Why a field has no value on some curves.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum FieldFault {
    /// No curve has the attribute.
    #[error("the curves have no attribute {0:?} that is a number")]
    NoAttribute(String),
    /// The scalp has no such mask.
    #[error("the scalp has no mask {name:?}; it has: {known}")]
    NoMask {
        /// The requested name.
        name: String,
        /// The existing names.
        known: String,
    },
    /// A mask needs the scalp, and none is wired.
    #[error("mask {0:?} needs the scalp wired to this node")]
    NoScalp(String),
}

impl From<FieldFault> for NodeError {
    fn from(fault: FieldFault) -> Self {
        NodeError::Failed(fault.to_string())
    }
}

impl Field {
    /// The value, if it is the same everywhere.
    pub fn constant(&self) -> Option<f32> {
        match self {
            Field::Constant(x) => Some(*x),
            Field::Product(parts) => {
                parts.iter().try_fold(1.0, |product, part| Some(product * part.constant()?))
            }
            _ => None,
        }
    }

    /// The field on the curves of a tuft. Only masks need `scalp`. `range` is the hard range of the input; every value
    /// is clamped to it.
    pub fn on<'a>(
        &'a self,
        tuft: &'a Tuft,
        scalp: Option<&Scalp>,
        range: (f32, f32),
    ) -> Result<Sampler<'a>, FieldFault> {
        self.in_cm(tuft, scalp, range, 1.0)
    }

    /// [`Self::on`] as a length: `unit` centimetres for each one, unless the number is in centimetres already.
    pub fn in_cm<'a>(
        &'a self,
        tuft: &'a Tuft,
        scalp: Option<&Scalp>,
        range: (f32, f32),
        unit: f32,
    ) -> Result<Sampler<'a>, FieldFault> {
        let unit = if is_in_cm(self) { 1.0 } else { unit };
        Ok(Sampler { part: self.part(tuft, scalp)?, range, unit })
    }

    fn part<'a>(&'a self, tuft: &'a Tuft, scalp: Option<&Scalp>) -> Result<Part<'a>, FieldFault> {
        Ok(match self {
            Field::Constant(x) => Part::View(AttributeView::Shared(*x)),
            Field::Ramp(ramp) => Part::Ramp(ramp),
            Field::Attribute(name) => {
                if let Some(view) = tuft.view_named::<f32>(name) {
                    Part::View(view)
                } else if let Some(view) = tuft.view_named::<i32>(name) {
                    Part::Whole(view)
                } else if name == ALONG.name {
                    Part::Along
                } else if let Some(default) = declared_number(name) {
                    Part::View(AttributeView::Shared(default))
                } else {
                    return Err(FieldFault::NoAttribute(name.clone()));
                }
            }
            Field::Mask(name) => {
                let scalp = scalp.ok_or_else(|| FieldFault::NoScalp(name.clone()))?;
                let (triangle, bary) = (tuft.view(ROOT_TRIANGLE), tuft.view(ROOT_BARY));
                let place = |i: usize| {
                    let root = tuft.offsets()[i] as usize;
                    Some((u32::try_from(triangle.at(i, root)).ok()?, bary.at(i, root)))
                };
                // A section of the parted scalp is a mask by its name, sharp at its partings.
                if let Some((sections, numbers)) =
                    scalp.sections().and_then(|s| Some((s, s.names().get(name)?)))
                {
                    let known = scalp.surface().triangles.len();
                    let value = |i: usize| {
                        let (t, bary) = place(i).filter(|(t, _)| (*t as usize) < known)?;
                        sections.of(&scalp.root(t, bary)).filter(|at| numbers.contains(at))
                    };
                    let values = (0..tuft.len()).map(|i| f32::from(value(i).is_some()));
                    return Ok(Part::Roots(values.collect()));
                }
                let mask = scalp.mask_named(name).ok_or_else(|| FieldFault::NoMask {
                    name: name.clone(),
                    known: scalp.mask_names().join(", "),
                })?;
                let value = |i: usize| place(i).map_or(0.0, |(t, bary)| mask(t, bary));
                Part::Roots((0..tuft.len()).map(value).collect())
            }
            Field::Painted(painted) => {
                let own = painted.scalp();
                let base = painted.base().on(tuft, Some(own), (0.0, 1.0))?;
                let places = Places::of(tuft, own, scalp);
                let value = |i: usize| {
                    let base = base.at(i, tuft.offsets()[i] as usize, 0.0);
                    Some(match places.known(i) {
                        Some((at, bary)) => painted.on_triangle(at, bary, base),
                        None => painted.at(&places.nearest(i)?, base),
                    })
                };
                Part::Roots((0..tuft.len()).map(|i| value(i).unwrap_or(0.0)).collect())
            }
            Field::Texture(texture) => {
                let own = texture.scalp();
                let places = Places::of(tuft, own, scalp);
                let value = |i: usize| {
                    let known = places.known(i).map(|(at, bary)| own.root(at, bary));
                    Some(texture.at(&known.or_else(|| places.nearest(i))?))
                };
                Part::Roots((0..tuft.len()).map(|i| value(i).unwrap_or(0.0)).collect())
            }
            Field::Product(parts) => Part::Product(
                parts.iter().map(|part| part.part(tuft, scalp)).collect::<Result<_, _>>()?,
            ),
        })
    }

    /// The values at places of a scalp's skin, 0 to 1.
    ///
    /// # Errors
    /// If it reads hair, or a mask that the scalp does not have.
    pub fn on_skin(&self, places: &[Root], scalp: &Scalp) -> Result<Vec<f32>, FieldFault> {
        if let Some(x) = self.constant() {
            return Ok(vec![x.clamp(0.0, 1.0); places.len()]);
        }
        // Fields read roots: those of curves of one point.
        let mut b = TuftBuilder::even(places.iter().map(|place| place.point).collect(), 1);
        let triangles = places.iter().map(|place| place.triangle as i32).collect();
        b.set(ROOT_TRIANGLE, Domain::Curve, triangles);
        b.set(ROOT_BARY, Domain::Curve, places.iter().map(|place| place.bary).collect());
        let tuft = b.build();
        let values = self.on(&tuft, Some(scalp), (0.0, 1.0))?;
        Ok((0..places.len()).map(|i| values.at(i, i, 0.0)).collect())
    }

    /// Whether it reads hair: an attribute of it, or the way along it.
    pub fn reads_hair(&self) -> bool {
        match self {
            Field::Attribute(_) | Field::Ramp(_) => true,
            Field::Product(parts) => parts.iter().any(Field::reads_hair),
            Field::Constant(_) | Field::Mask(_) | Field::Painted(_) | Field::Texture(_) => false,
        }
    }

    /// Whether it contains a mask, which may be a section of a parted scalp.
    pub fn has_mask(&self) -> bool {
        match self {
            Field::Mask(_) => true,
            Field::Painted(painted) => painted.reads_sections(),
            Field::Product(parts) => parts.iter().any(Field::has_mask),
            Field::Constant(_) | Field::Ramp(_) | Field::Attribute(_) | Field::Texture(_) => false,
        }
    }

    /// Names of the masks that it reads, but for those of other nodes.
    pub fn mask_names(&self) -> Vec<&str> {
        match self {
            Field::Mask(name) => vec![name],
            Field::Product(parts) => parts.iter().flat_map(Field::mask_names).collect(),
            _ => vec![],
        }
    }

    /// Whether it contains something that comes by wire only: a painted mask or a texture.
    pub fn is_wired(&self) -> bool {
        match self {
            Field::Painted(_) | Field::Texture(_) => true,
            Field::Product(parts) => parts.iter().any(Field::is_wired),
            _ => false,
        }
    }

    /// Bytes held.
    pub fn bytes(&self) -> usize {
        match self {
            Field::Painted(painted) => painted.bytes(),
            Field::Texture(texture) => texture.bytes(),
            Field::Product(parts) => parts.iter().map(Field::bytes).sum(),
            _ => 64,
        }
    }

    /// Adds the field to a key.
    pub fn add_to(&self, key: KeyBuilder) -> KeyBuilder {
        match self {
            Field::Constant(x) => key.text("constant").float(*x),
            Field::Ramp(ramp) => ramp.add_to(key.text("ramp")),
            Field::Attribute(name) => key.text("attribute").text(name),
            Field::Mask(name) => key.text("mask").text(name),
            Field::Painted(painted) => key.text("painted").key(painted.key()),
            Field::Texture(texture) => key.text("texture").key(texture.key()),
            Field::Product(parts) => parts
                .iter()
                .fold(key.text("product").int(parts.len() as u64), |key, part| part.add_to(key)),
        }
    }

    /// Whether all of its numbers are finite.
    pub fn is_finite(&self) -> bool {
        match self {
            Field::Constant(x) => x.is_finite(),
            Field::Product(parts) => parts.iter().all(Field::is_finite),
            _ => true,
        }
    }
}

/// Whether the value is a length in centimetres already: an attribute declared in cm, or a product with one. Others, such as the
/// girth of a row, are factors of the typed number.
fn is_in_cm(field: &Field) -> bool {
    match field {
        Field::Attribute(name) => super::attributes::is_length(name),
        Field::Product(parts) => parts.iter().any(is_in_cm),
        _ => false,
    }
}

fn declared_number(name: &str) -> Option<f32> {
    use super::attributes as a;
    let numbers: [Declared<f32>; 9] = [
        a::RADIUS,
        a::WIDTH,
        a::ROLL,
        a::FLATNESS,
        a::FRIZZ,
        a::DENSITY,
        a::ALLOW_DEPTH,
        a::PHASE,
        a::FIBRE,
    ];
    numbers.iter().find(|d| d.name == name).map(|d| d.default)
}

/// Positions of a tuft's roots on a head.
struct Places<'a> {
    tuft: &'a Tuft,
    own: &'a Scalp,
    triangle: AttributeView<'a, i32>,
    bary: AttributeView<'a, Vec2>,
    /// Number of the head's triangles that roots may refer to.
    known: usize,
}

impl<'a> Places<'a> {
    /// Positions on the head of a mask or texture, for curves that grow on `scalp`.
    fn of(tuft: &'a Tuft, own: &'a Scalp, scalp: Option<&Scalp>) -> Self {
        // Roots refer to triangles of the head that the curves grow on.
        let known = match scalp {
            Some(scalp) if scalp.whole() != own.whole() => 0,
            _ => own.surface().triangles.len(),
        };
        let (triangle, bary) = (tuft.view(ROOT_TRIANGLE), tuft.view(ROOT_BARY));
        Self { tuft, own, triangle, bary, known }
    }
    /// The root as the curve stores it.
    fn known(&self, i: usize) -> Option<(u32, Vec2)> {
        let root = self.tuft.offsets()[i] as usize;
        let at = u32::try_from(self.triangle.at(i, root)).ok()?;
        ((at as usize) < self.known).then(|| (at, self.bary.at(i, root)))
    }
    /// The nearest point of the head.
    fn nearest(&self, i: usize) -> Option<Root> {
        self.own.closest_root(*self.tuft.curve(i).first()?)
    }
}

/// A field bound to the curves of one tuft.
#[derive(Debug)]
pub struct Sampler<'a> {
    part: Part<'a>,
    range: (f32, f32),
    /// Factor of the value.
    unit: f32,
}

#[derive(Debug)]
enum Part<'a> {
    View(AttributeView<'a, f32>),
    Whole(AttributeView<'a, i32>),
    Ramp(&'a Ramp),
    Along,
    Roots(Vec<f32>),
    Product(Vec<Part<'a>>),
}

impl Part<'_> {
    fn is_of_curves(&self) -> bool {
        match self {
            Part::View(view) => !matches!(view, AttributeView::Point(_)),
            Part::Whole(view) => !matches!(view, AttributeView::Point(_)),
            Part::Ramp(_) | Part::Along => false,
            Part::Roots(_) => true,
            Part::Product(parts) => parts.iter().all(Part::is_of_curves),
        }
    }
    fn at(&self, curve: usize, point: usize, u: f32) -> f32 {
        match self {
            Part::View(view) => view.at(curve, point),
            Part::Whole(view) => view.at(curve, point) as f32,
            Part::Ramp(ramp) => ramp.at(u),
            Part::Along => u,
            Part::Roots(values) => values[curve],
            Part::Product(parts) => parts.iter().map(|part| part.at(curve, point, u)).product(),
        }
    }
}

impl Sampler<'_> {
    /// The value on curve `curve` at point `point` of the tuft, which lies at the fraction `u` of the curve's length.
    /// NaN (an attribute can hold anything) reads as the low end of the range.
    #[inline]
    pub fn at(&self, curve: usize, point: usize, u: f32) -> f32 {
        if let Part::View(AttributeView::Shared(x)) = self.part {
            return x.max(self.range.0).min(self.range.1) * self.unit;
        }
        self.part.at(curve, point, u).max(self.range.0).min(self.range.1) * self.unit
    }
    /// [`Self::at`] for eight curves.
    #[inline(always)]
    pub(crate) fn at_each<S: Simd>(
        &self,
        curves: &[usize; LANES],
        points: &[usize; LANES],
        u: f32x8<S>,
    ) -> f32x8<S> {
        let s = u.simd;
        let value = match &self.part {
            Part::View(AttributeView::Shared(x)) => s.splat_f32x8(*x),
            Part::Ramp(ramp) => ramp.at_each(u),
            Part::Along => u,
            part => {
                let u = s.as_array_f32x8(u);
                let mut values = [0.0; LANES];
                for (i, value) in values.iter_mut().enumerate() {
                    *value = part.at(curves[i], points[i], u[i]);
                }
                s.load_array_f32x8(values)
            }
        };
        // As in `at`, NaN reads as the low end.
        let value = pick(value.simd_gt(self.range.0), value, s.splat_f32x8(self.range.0));
        let value = pick(value.simd_lt(self.range.1), value, s.splat_f32x8(self.range.1));
        value * self.unit
    }
    /// Whether the value is the same at all points of a curve.
    pub fn is_of_curves(&self) -> bool {
        self.part.is_of_curves()
    }
    /// The value at the fraction `u` of a curve. Attributes are not interpolated: the nearest preceding point counts.
    pub fn along(&self, tuft: &Tuft, curve: usize, u: f32) -> f32 {
        let range = tuft.range(curve);
        let last = range.len().saturating_sub(1);
        let point = range.start + ((u * last as f32) as usize).min(last);
        self.at(curve, point, u)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::attributes::Domain;
    use crate::data::curves::TuftBuilder;
    use glam::Vec3;

    #[test]
    fn a_field_is_clamped_to_the_range_of_its_input_wherever_it_comes_from() {
        let mut b = TuftBuilder::new();
        b.push_curve(&[Vec3::ZERO, Vec3::Y]);
        b.set_named("mine".into(), Domain::Point, vec![f32::NAN, 7.0]);
        let tuft = b.build();
        let attribute = Field::Attribute("mine".into());
        let sampler = attribute.on(&tuft, None, (0.0, 2.0)).unwrap();
        assert_eq!((sampler.at(0, 0, 0.0), sampler.at(0, 1, 1.0)), (0.0, 2.0));
        let product =
            Field::Product(vec![Field::Constant(3.0), Field::Ramp(Ramp::linear(0.0, 1.0))]);
        assert_eq!(product.on(&tuft, None, (0.0, 9.0)).unwrap().at(0, 0, 0.5), 1.5);
        assert_eq!(product.constant(), None);
    }

    #[test]
    fn what_is_typed_grows_with_the_unit_and_lengths_of_attributes_do_not() {
        let mut b = TuftBuilder::new();
        b.push_curve(&[Vec3::ZERO, Vec3::Y]);
        b.set_named("radius".into(), Domain::Curve, vec![3.0f32]);
        b.set_named("density".into(), Domain::Curve, vec![0.5f32]);
        b.set_named("mine".into(), Domain::Curve, vec![3.0f32]);
        let tuft = b.build();
        let attribute = |name: &str| Field::Attribute(name.into());
        let product = |part: Field| Field::Product(vec![part, Field::Constant(0.5)]);
        let check = |field: Field, cm: f32| {
            let sampler = field.in_cm(&tuft, None, (0.0, 2.0), 10.0).unwrap();
            assert_eq!(sampler.at(0, 0, 0.5), cm, "{field:?}");
        };
        check(Field::Constant(1.5), 15.0);
        // Clamped as it was typed.
        check(Field::Constant(3.0), 20.0);
        check(Field::Ramp(Ramp::linear(0.0, 1.0)), 5.0);
        check(attribute("radius"), 2.0);
        check(product(attribute("radius")), 1.5);
        check(product(product(attribute("radius"))), 0.75);
        // A share of what is typed.
        check(attribute("density"), 5.0);
        check(product(attribute("density")), 2.5);
        check(product(attribute("mine")), 15.0);
    }

    #[test]
    fn what_is_not_there_is_named() {
        let tuft = TuftBuilder::new().build();
        let fault = |field: Field| field.on(&tuft, None, (0.0, 1.0)).unwrap_err().to_string();
        assert_eq!(
            fault(Field::Attribute("wetness".into())),
            "the curves have no attribute \"wetness\" that is a number"
        );
        assert_eq!(fault(Field::Mask("x".into())), "mask \"x\" needs the scalp wired to this node");
    }
}
