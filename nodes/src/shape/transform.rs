//! Transform: moves, rotates and scales curves.
//!
//! Guarantees: ids stay; direction attributes rotate, length attributes scale; the identity returns the input itself.
//! Not promised: that roots still lie on the scalp; the binding refers to where the curve grew unless it is renewed.

use crate::data::attributes::{
    ALLOW_DEPTH, Domain, FIBRE, Item, NORMAL, PUFF_CENTRE, PUFF_RADIUS, RADIUS, ROOT_BARY,
    ROOT_TRIANGLE, ROOT_UV, SCALP_NORMAL, TIE, TIE_RADIUS, WIDTH,
};
use crate::data::curves::{Curves, TuftBuilder};
use crate::data::route::{Left, carried};
use crate::data::scalp::{HeadFrame, Scalp};
use crate::define::{KnownInputs, NodeError, Value, choice, node};
use crate::eval::EvalCx;
use crate::maths::transcendental::{exp, ln, sin_cos};
use glam::{Mat3, Vec2, Vec3};
use std::sync::Arc;

node! {
    /// Moves, rotates and scales curves as a whole.
    "transform", version 1, label "Transform", words "move translate rotate scale mirror place position xform flip",
        refuses(refused);
    inputs {
        /// Curves to move.
        curves: Curves;
        /// The head: the space "head" uses its frame, and roots can be bound to it again.
        scalp: Option<Arc<Scalp>>;
        /// Axes and units of the values below.
        space: Space = Space::Head, words("local world coordinates");
        /// Translation, applied after rotation and scale.
        translate: Vec3 = Vec3::ZERO, unit(Length), words("offset position move");
        /// Rotation in degrees about the x, then the y, then the z axis.
        rotate: Vec3 = Vec3::ZERO, unit(Angle), words("orient turn");
        /// Scale along each axis, applied before rotation. -1 mirrors.
        scale: Vec3 = Vec3::ONE, words("size mirror");
        /// Point that stays in place under rotation and scale.
        pivot: Vec3 = Vec3::ZERO, unit(Length), words("origin centre center"), handle(Handle::Point);
        /// What happens to the root binding.
        roots: Roots = Roots::Keep, words("binding attach");
    }
    outputs {
        /// The transformed curves.
        curves: Curves;
    }
}

choice! {
    /// Axes and units of the values.
    Space {
        /// The head frame: x to the head's left, y up, z forward, from the centre of the cranium, in head units.
        Head = "head",
        /// World axes and true centimetres.
        World = "world",
    }
}

choice! {
    /// What happens to the root binding.
    Roots {
        /// Keeps the binding to where the curve grew, so that masks read the same as before.
        Keep = "keep",
        /// Binds to the point of the scalp nearest to the new root. Needs the scalp.
        Bind = "bind",
    }
}

/// What needs a scalp and has none, and a scale that leaves nothing.
fn refused(told: &KnownInputs) -> Result<(), NodeError> {
    let (has_scalp, bind) = (told.arrives("scalp"), told.is("roots", "bind"));
    let vector = |name: &str| match told.value(name) {
        Some(Value::Vec3(x)) => x,
        _ => Vec3::NAN,
    };
    let (translate, rotate, scale) = (vector("translate"), vector("rotate"), vector("scale"));
    if !has_scalp && bind {
        return Err(NodeError::failed("scalp is not connected: roots can only be bound to one"));
    }
    if translate == Vec3::ZERO && rotate == Vec3::ZERO && scale == Vec3::ONE {
        return Ok(());
    }
    if scale == Vec3::ZERO {
        let [x, y, z] = scale.to_array();
        return Err(NodeError::BadValue {
            input: "scale",
            value: format!("({x}, {y}, {z})"),
            reason: "leaves no length in any direction".to_owned(),
        });
    }
    if !has_scalp && told.is("space", "head") {
        return Err(NodeError::failed(
            "scalp is not connected: wire it, or choose the space \"world\"",
        ));
    }
    Ok(())
}

fn eval(cx: &EvalCx, inputs: Inputs) -> Result<Outputs, NodeError> {
    let bind = inputs.roots == Roots::Bind;
    let scalp = inputs.scalp.as_deref();
    let identity = inputs.translate == Vec3::ZERO
        && inputs.rotate == Vec3::ZERO
        && inputs.scale == Vec3::ONE
        && !bind;
    if identity {
        return Ok(Outputs { curves: inputs.curves });
    }
    let of_head = scalp.filter(|_| inputs.space == Space::Head);
    let frame = of_head.map_or(HeadFrame::IDENTITY, |scalp| *scalp.frame());
    let head = Mat3::from_cols(frame.right, frame.up, frame.forward);
    let turn = head * rotation(inputs.rotate) * head.transpose();
    let matrix = turn * head * Mat3::from_diagonal(inputs.scale) * head.transpose();
    let pivot = match of_head {
        Some(scalp) => scalp.place(inputs.pivot),
        None => frame.point_from_head(inputs.pivot),
    };
    let shift = frame.vector_from_head(inputs.translate) * frame.unit();
    // Lengths across a curve scale with the cube root of the volume.
    let volume = (inputs.scale.x * inputs.scale.y * inputs.scale.z).abs();
    let grown = if volume > 0.0 { exp(ln(volume) / 3.0) } else { 1.0 };
    let grown = if (grown - 1.0).abs() < 1e-6 { 1.0 } else { grown };
    // Normals transform by the inverse transpose, which is proportional to the cofactors.
    let [a, b, c] = [matrix.x_axis, matrix.y_axis, matrix.z_axis];
    let flip = if a.dot(b.cross(c)) < 0.0 { -1.0 } else { 1.0 };
    let cofactors = Mat3::from_cols(b.cross(c), c.cross(a), a.cross(b)) * flip;
    let skin = scalp.filter(|_| bind).map(|scalp| (cx.skin(scalp), scalp));

    let [curves] = cx.each_tuft(&inputs.curves, |tuft, piece| {
        piece.tick()?;
        let place = |p: Vec3| matrix * (p - pivot) + pivot + shift;
        let is_far = |p: &Vec3| p.is_finite() && !place(*p).is_finite();
        if !grown.is_finite() || tuft.points().iter().any(is_far) {
            (0..tuft.len()).for_each(|i| piece.trouble(tuft.id(i), Left::Far));
            return Ok([tuft.clone()]);
        }
        let mut out = carried(tuft, place);
        for declared in [NORMAL, SCALP_NORMAL] {
            each_value(&mut out, tuft, declared.name, |v: Vec3| {
                (cofactors * v).normalize_or_zero()
            });
        }
        for declared in [PUFF_CENTRE, TIE] {
            each_value(&mut out, tuft, declared.name, place);
        }
        if grown != 1.0 {
            for declared in [RADIUS, WIDTH, ALLOW_DEPTH, FIBRE, PUFF_RADIUS, TIE_RADIUS] {
                each_value(&mut out, tuft, declared.name, |x: f32| x * grown);
            }
        }
        if let Some((skin, scalp)) = &skin {
            let first = |i: usize| place(tuft.points()[tuft.offsets()[i] as usize]);
            let roots: Vec<_> = (0..tuft.len())
                .map(|i| skin.closest(first(i)).map(|hit| scalp.root(hit.triangle, hit.bary)))
                .collect();
            let triangle =
                |r: &Option<crate::data::scalp::Root>| r.map_or(-1, |r| r.triangle as i32);
            out.set(ROOT_TRIANGLE, Domain::Curve, roots.iter().map(triangle).collect());
            let bary = roots.iter().map(|r| r.map_or(Vec2::ZERO, |r| r.bary));
            out.set(ROOT_BARY, Domain::Curve, bary.collect());
            if scalp.uvs().is_some() {
                let uv = roots.iter().map(|r| r.map_or(Vec2::ZERO, |r| r.uv));
                out.set(ROOT_UV, Domain::Curve, uv.collect());
            }
        }
        Ok([out.build()])
    })?;
    Ok(Outputs { curves })
}

/// Applies `f` to every value of an attribute, if the tuft has it.
fn each_value<T: Item>(
    out: &mut TuftBuilder,
    tuft: &crate::data::curves::Tuft,
    name: &str,
    f: impl Fn(T) -> T,
) {
    if let Some(attribute) = tuft.attribute(name)
        && let Some(values) = T::values(&attribute.values)
    {
        let values = T::column(values.iter().map(|v| f(*v)).collect());
        out.set_column(crate::data::attributes::Attribute { values, ..attribute.clone() });
    }
}

/// Rotation about x, then y, then z, degrees.
fn rotation(degrees: Vec3) -> Mat3 {
    let [x, y, z] = degrees.to_array().map(|d| sin_cos((d % 360.0).to_radians()));
    let about_x = Mat3::from_cols(Vec3::X, Vec3::new(0.0, x.1, x.0), Vec3::new(0.0, -x.0, x.1));
    let about_y = Mat3::from_cols(Vec3::new(y.1, 0.0, -y.0), Vec3::Y, Vec3::new(y.0, 0.0, y.1));
    let about_z = Mat3::from_cols(Vec3::new(z.1, z.0, 0.0), Vec3::new(-z.0, z.1, 0.0), Vec3::Z);
    about_z * about_y * about_x
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::scalp::tests::ball;
    use crate::testing::{curves_of, fails, run};

    fn source() -> Curves {
        let mut b = TuftBuilder::new();
        b.push_curve(&[Vec3::X, Vec3::X * 2.0]);
        b.set(NORMAL, Domain::Point, vec![Vec3::Y]);
        b.set(RADIUS, Domain::Curve, vec![0.5]);
        b.set(PUFF_CENTRE, Domain::Curve, vec![Vec3::X * 2.0]);
        b.set(TIE_RADIUS, Domain::Curve, vec![0.5]);
        Curves::new(vec![b.build().into()])
    }

    #[track_caller]
    fn check(set: &[(&str, Value)], points: [Vec3; 2], normal: Vec3, radius: f32) {
        let set = [&[("curves", source().into()), ("space", "world".into())], set].concat();
        let (out, _) = run(&NODE, &set);
        let tuft = &curves_of(&out[0]).tufts()[0];
        for (got, want) in tuft.curve(0).iter().zip(points) {
            assert!(got.distance(want) < 1e-5, "{got} {want}");
        }
        assert!(tuft.view(NORMAL).at(0, 0).distance(normal) < 1e-5);
        assert!((tuft.view(RADIUS).at(0, 0) - radius).abs() < 1e-5);
        // A hair's data about its puff and its tie is transformed as well.
        assert!(tuft.view(PUFF_CENTRE).at(0, 0).distance(points[1]) < 1e-5);
        assert!((tuft.view(TIE_RADIUS).at(0, 0) - radius).abs() < 1e-5);
    }

    #[test]
    fn curves_move_and_what_belongs_to_them_turns_and_scales() {
        let v = |x: f32, y: f32, z: f32| Value::Vec3(Vec3::new(x, y, z));
        let (x, y, z) = (Vec3::X, Vec3::Y, Vec3::Z);
        check(&[], [x, x * 2.0], y, 0.5);
        check(&[("translate", v(0.0, 1.0, 0.0))], [x + y, x * 2.0 + y], y, 0.5);
        check(&[("rotate", v(0.0, 0.0, 90.0))], [y, y * 2.0], -x, 0.5);
        check(&[("rotate", v(0.0, 90.0, 0.0))], [-z, z * -2.0], y, 0.5);
        check(&[("rotate", v(90.0, 0.0, 0.0))], [x, x * 2.0], z, 0.5);
        check(&[("rotate", v(90.0, 0.0, 90.0))], [y, y * 2.0], z, 0.5);
        check(&[("scale", v(2.0, 2.0, 2.0))], [x * 2.0, x * 4.0], y, 1.0);
        check(&[("scale", v(-1.0, 1.0, 1.0))], [-x, x * -2.0], y, 0.5);
        let about = [("scale", v(3.0, 3.0, 3.0)), ("pivot", v(1.0, 0.0, 0.0))];
        check(&about, [x, x * 4.0], y, 1.5);
    }

    #[test]
    fn the_identity_hands_its_input_on_as_it_is() {
        let (input, scalp) = (source(), Value::from(ball()));
        let (out, _) = run(&NODE, &[("curves", input.clone().into()), ("scalp", scalp)]);
        assert!(Arc::ptr_eq(&input.tufts()[0], &curves_of(&out[0]).tufts()[0]));
    }

    #[test]
    fn roots_are_bound_again_when_asked() {
        let scalp = Value::from(ball());
        let up = ("translate", Value::Vec3(Vec3::new(0.0, 9.5, 0.0)));
        let set = [("curves", source().into()), ("scalp", scalp), ("roots", "bind".into()), up];
        let (out, _) = run(&NODE, &set);
        let tuft = &curves_of(&out[0]).tufts()[0];
        assert!(tuft.view(ROOT_TRIANGLE).at(0, 0) >= 0);
    }

    #[test]
    fn what_cannot_be_is_refused() {
        let check = |set: &[(&str, Value)], want: &str| {
            let set = [&[("curves", source().into())], set].concat();
            assert_eq!(fails(&NODE, &set), want);
        };
        let zero = [("space", "world".into()), ("scale", Value::Vec3(Vec3::ZERO))];
        check(&zero, "scale: (0, 0, 0) leaves no length in any direction");
        let head = [("translate", Value::Vec3(Vec3::X))];
        check(&head, "scalp is not connected: wire it, or choose the space \"world\"");
    }
}
