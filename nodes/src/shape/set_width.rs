//! Set width: the width of hair from root to tip.
//!
//! Guarantees: nothing else changes and nothing else is copied; a constant width is stored once.

use super::along::{ValueDomain, lay};
use crate::data::attributes::{Domain, WIDTH};
use crate::data::curves::Curves;
use crate::data::field::Sampler;
use crate::data::ramp::Ramp;
use crate::data::route::bundle::{Hairs, Tell};
use crate::data::scalp::Scalp;
use crate::define::{FieldInput, NodeError, node};
use crate::eval::EvalCx;
use crate::maths::lanes::{Eight, Simd, f32x8, ops::*, pick};
use std::sync::Arc;

node! {
    /// Sets the width of hairs from root to tip.
    "set_width", version 1, label "Set width", words "width thickness taper radius diameter profile hair curve tip modifier";
    inputs {
        /// Hair to change.
        curves: Curves;
        /// The head; only masks need it.
        scalp: Option<Arc<Scalp>>;
        /// Diameter at the root. Human hair has 0.005 to 0.012 cm; slightly more often renders better.
        root: f32 = 0.008, hard(0.0, 10.0), soft(0.001, 0.05), unit(Length), words("thickness diameter");
        /// Diameter at the tip.
        tip: f32 = 0.003, hard(0.0, 10.0), soft(0.0, 0.05), unit(Length), words("thickness diameter");
        /// Blend from the root width (0) to the tip width (1), along the hair.
        profile: Arc<Ramp> = Ramp::linear(0.0, 1.0), words("taper shape falloff");
        /// Multiplies the width: a mask, an attribute or a number.
        scale: FieldInput = 1.0, hard(0.0, 1000.0), soft(0.0, 2.0), unit(None);
        /// Random variation in width between hairs: 0.2 means by up to a fifth.
        variation: f32 = 0.0, hard(0.0, 1.0), unit(Ratio), words("random vary");
        /// Random seed for this node.
        seed: i64 = 0;
    }
    outputs {
        /// The same hair, with the new width.
        curves: Curves;
    }
}

fn eval(cx: &EvalCx, inputs: Inputs) -> Result<Outputs, NodeError> {
    let scalp = inputs.scalp.as_deref();
    let dice = cx.dice(inputs.seed, "width");
    let (root, tip) = (inputs.root, inputs.tip);
    let stops = inputs.profile.stops();
    let level = root == tip || stops.iter().all(|stop| stop.1 == stops[0].1);
    let along = |u: f32| (root + (tip - root) * inputs.profile.at(u)).max(0.0);
    let [curves] = cx.each_tuft(&inputs.curves, |tuft, piece| {
        let scale = inputs.scale.on(tuft, scalp)?;
        let of = |id: u64| 1.0 + inputs.variation * dice.signed(id, 0);
        let vary = |i: usize| of(tuft.id(i));
        let level = level && scale.is_of_curves();
        let alike = inputs.variation == 0.0 && inputs.scale.constant().is_some();
        let held = ValueDomain::fewest(level, alike);
        if held == ValueDomain::Point {
            let profile = &*inputs.profile;
            let mut widths = Widths { root, tip, profile, scale, of, own: Eight::default() };
            let widths = piece.tell(tuft, &mut widths)?;
            let mut out = tuft.edit();
            out.set(WIDTH, Domain::Point, widths);
            return Ok([out.build()]);
        }
        let value =
            |vary: &f32, i: usize, point: usize, u: f32| along(u) * scale.at(i, point, u) * *vary;
        Ok([lay(piece, tuft, WIDTH, held, vary, value)?])
    })?;
    Ok(Outputs { curves })
}

/// Widths that vary along the hair.
struct Widths<'a, V> {
    root: f32,
    tip: f32,
    profile: &'a Ramp,
    scale: Sampler<'a>,
    /// Factor of the hair with this id, and the factors of the present bundle.
    of: V,
    own: Eight,
}

impl<V: Fn(u64) -> f32> Tell for Widths<'_, V> {
    #[inline(always)]
    fn tell<S: Simd>(&mut self, hairs: &Hairs<S>, k: usize, u: f32x8<S>) -> f32x8<S> {
        if k == 0 {
            self.own.set(hairs.own(&self.of));
        }
        let width = self.root + (self.tip - self.root) * self.profile.at_each(u);
        let width = pick(width.simd_gt(0.0), width, hairs.s.splat_f32x8(0.0));
        width * hairs.field_at(&self.scale, k, u) * self.own.get(hairs.s)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::attributes::ID;
    use crate::data::curves::TuftBuilder;
    use crate::data::field::Field;
    use crate::define::Value;
    use crate::testing::{curves_of, run};
    use glam::Vec3;

    fn hair() -> Curves {
        let mut b = TuftBuilder::new();
        b.push_curve(&[0.0, 1.0, 4.0].map(|y| Vec3::new(0.0, y, 0.0)));
        b.push_curve(&[0.0, 2.0, 4.0].map(|y| Vec3::new(1.0, y, 0.0)));
        b.set(ID, Domain::Curve, vec![5, 6]);
        b.set_named("thin".into(), Domain::Curve, vec![1.0f32, 0.5]);
        Curves::new(vec![b.build().into()])
    }

    #[track_caller]
    fn check(set: &[(&str, Value)], want: &[f32]) {
        let (out, _) = run(&NODE, &[&[("curves", hair().into())], set].concat());
        let (before, after) = (&hair().tufts()[0].clone(), &curves_of(&out[0]).tufts()[0].clone());
        assert_eq!(before.points(), after.points());
        let width = after.attribute(WIDTH.name).unwrap();
        let crate::data::attributes::Column::F32(values) = &width.values else { panic!() };
        assert_eq!(values.len(), want.len(), "{values:?}");
        for (a, b) in values.iter().zip(want) {
            assert!((a - b).abs() < 1e-6, "{values:?} {want:?}");
        }
    }

    #[test]
    fn the_width_goes_from_root_to_tip_by_arc_length_and_is_stored_as_few_times_as_it_can() {
        let (root, tip) = (("root", Value::Float(0.1)), |x| ("tip", Value::Float(x)));
        check(&[root.clone(), tip(0.1)], &[0.1]);
        check(&[root.clone(), tip(0.0)], &[0.1, 0.075, 0.0, 0.1, 0.05, 0.0]);
        let thin = ("scale", Field::Attribute("thin".into()).into());
        check(&[root.clone(), tip(0.1), thin.clone()], &[0.1, 0.05]);
        check(&[root.clone(), tip(0.0), thin], &[0.1, 0.075, 0.0, 0.05, 0.025, 0.0]);
        check(&[root, tip(7.0), ("profile", Ramp::constant(0.0).into())], &[0.1]);
    }

    #[test]
    fn variation_is_each_hairs_own() {
        let set = [("curves", hair().into()), ("variation", Value::Float(0.5))];
        let (out, _) = run(&NODE, &set);
        let tuft = &curves_of(&out[0]).tufts()[0];
        let width = tuft.view(WIDTH);
        assert_ne!(width.at(0, 0), width.at(1, 3));
        assert!((width.at(0, 2) / width.at(0, 0) - 0.003 / 0.008).abs() < 1e-5);
    }

    #[test]
    fn what_is_not_changed_is_shared() {
        let (out, _) = run(&NODE, &[("curves", hair().into())]);
        // One hair is left as it was in memory, too: points are not copied.
        let input = hair();
        let (again, _) = run(&NODE, &[("curves", input.clone().into())]);
        let pointer = |curves: &Curves| curves.tufts()[0].points().as_ptr();
        assert_eq!(pointer(&input), pointer(curves_of(&again[0])));
        assert_eq!(curves_of(&out[0]).key(), curves_of(&again[0]).key());
    }
}
