//! Paint mask: a field that the pen paints on the head.
//!
//! `data/painted.rs` computes the value that brush strokes give each point; here they meet a head.
//!
//! Guarantees: values are 0 to 1 and depend on the strokes only, so that they mean the same on coarse heads, fine heads
//! and other heads; the amount of hair that reads the mask does not change it.

use crate::data::field::Field;
use crate::data::laid::ClosedStroke;
use crate::data::painted::{Edges, GridMeans, Painted};
use crate::data::scalp::Scalp;
use crate::data::strokes::Strokes;
use crate::define::{FieldInput, KnownInputs, NodeError, Value, node};
use crate::eval::{EvalCx, Size};
use crate::maths::hash::Key;
use std::collections::BTreeSet;
use std::sync::Arc;

node! {
    /// A mask painted on the head with the pen: paint, erase, smooth and flood in the viewport, then wire it to any
    /// field.
    ///
    /// Strokes are stored in the head frame, so the mask transfers to another head and stays sharp on a coarse mesh. A
    /// closed stroke works like a hairline: its inside is the mask, with a soft edge.
    "paint_mask", version 1, label "Paint mask",
        words "paint brush map weight density length region area hairline outline draw dab flood smooth erase texture", scales,
        refuses(refused);
    inputs {
        /// Painted strokes, in order. Paint them in the viewport; they are stored in the head frame.
        strokes: Arc<Strokes> = Strokes::default(), words("pen dabs brush painted");
        /// The head. Strokes limited to a section need the parted head.
        scalp: Arc<Scalp>;
        /// Value before the first stroke: a number, a mask of the head, a texture mask or another painted mask.
        base: FieldInput = 0.0, hard(0.0, 1.0), unit(Ratio), words("start texture fill background vertex colour");
        /// Fraction of the brush radius over which a dab fades: 0 is a hard edge, 1 fades from the centre.
        softness: f32 = 1.0, hard(0.0, 1.0), unit(Ratio), words("hardness falloff feather blur");
        /// Fade width inside a closed stroke. 0 is a sharp edge.
        edge: f32 = 0.3, hard(0.0, 10.0), soft(0.0, 2.0), unit(Length), words("hairline soft fade feather");
        /// Scale the edge width with the size of the head. Dabs always scale.
        scale_with_head: bool = true, words("head units");
    }
    outputs {
        /// The painted value, 0 to 1, at the root of each hair. Wire it to any field, such as a mask, density or
        /// length.
        mask: Arc<Field>;
    }
}

fn refused(told: &KnownInputs) -> Result<(), NodeError> {
    on_skin(told, "base")
}

/// Refuses an input that is read on the skin if what it is set to reads hair.
pub(super) fn on_skin(told: &KnownInputs, input: &'static str) -> Result<(), NodeError> {
    let reads = match told.value(input) {
        Some(Value::Field(field)) => field.reads_hair(),
        Some(Value::Ramp(_)) => true,
        _ => false,
    };
    if !reads {
        return Ok(());
    }
    let reason =
        "is read on the scalp, before there is hair: give a number, a mask, or wire a painted mask";
    Err(NodeError::BadValue { input, value: "it".to_owned(), reason: reason.to_owned() })
}

fn eval(cx: &EvalCx, inputs: Inputs) -> Result<Outputs, NodeError> {
    let Inputs { scalp, strokes, base, .. } = inputs;
    let samples: usize = strokes.0.iter().map(|stroke| stroke.samples.len()).sum();
    cx.may_make(&Size::of(&[("samples of strokes", samples as f64)]))?;
    tell_sections(cx, &scalp, &strokes);
    if let (true, Some(x)) = (strokes.0.is_empty(), base.constant()) {
        return Ok(Outputs { mask: Field::Constant(x).into() });
    }
    let edges = Edges { softness: inputs.softness, line: inputs.edge };
    let known = |key: Key, make: &dyn Fn() -> Result<GridMeans, NodeError>| {
        cx.memo(key, || {
            let even = make()?;
            let bytes = even.bytes();
            Ok((even, bytes))
        })
    };
    let laid = |key: Key, make: &dyn Fn() -> ClosedStroke| {
        cx.memo(key, || {
            let laid = make();
            let bytes = laid.bytes();
            Ok((laid, bytes))
        })
    };
    let check = || cx.check();
    let strokes = carried(&scalp, strokes);
    let painted = Painted::new(scalp, &strokes, base.field, edges, &check, &known, &laid)?;
    painted.faults().for_each(|fault| cx.warn(fault));
    Ok(Outputs { mask: Field::Painted(painted.into()).into() })
}

/// The strokes in this head's own units. (So the mirror image of a stroke is mirrored on this head, not on the one it
/// was made on.)
fn carried(scalp: &Scalp, strokes: Arc<Strokes>) -> Arc<Strokes> {
    let space = scalp.space();
    if space.carry().is_none() {
        return strokes;
    }
    let mut out = (*strokes).clone();
    let samples = out.0.iter_mut().flat_map(|stroke| &mut stroke.samples);
    samples.for_each(|sample| sample.position = space.own(sample.position));
    Arc::new(out)
}

/// Whether a field reads something that only hair has.
/// Reports sections that strokes are limited to and the head does not have.
fn tell_sections(cx: &EvalCx, scalp: &Scalp, strokes: &Strokes) {
    let names = strokes.0.iter().filter_map(|stroke| Some(&*stroke.brush.as_ref()?.section));
    let names: BTreeSet<&str> = names.filter(|name| !name.is_empty()).collect();
    let known = |name: &&str| scalp.sections().is_some_and(|all| all.names().get(name).is_some());
    let gone: Vec<&str> = names.into_iter().filter(|name| !known(name)).collect();
    if let [first, ..] = gone[..] {
        cx.warn(format!(
            "strokes keep to {first:?}{}, which this head is not parted into: wire the parted scalp, or name its section so",
            if gone.len() > 1 { format!(" and {} more sections", gone.len() - 1) } else { String::new() },
        ));
    }
}
