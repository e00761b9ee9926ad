//! What a plan's nodes will refuse, known before any of them runs: by what each says of its inputs
//! ([`refused`](coif_nodes::define::NodeDef::refused)), and masks that the head under the hair does not have.
//!
//! Guarantees: nothing is refused that evaluates. Not promised: that the rest does; sections and hair are known to nodes alone.

use super::plan::{NOTHING_TO_PASS, Plan, Source, Step};
use super::request::BadRequest;
use coif_nodes::data::field::FieldFault;
use coif_nodes::define::{Arriving, InputDef, KnownInputs, Type, Value};

/// Everything that the nodes of a plan will refuse, in the order in which they would run. As slow as reading a head's mesh, where
/// hair asks for a mask that not every head has.
pub fn foreseen(plan: &Plan) -> Vec<BadRequest> {
    plan.steps.iter().filter_map(|step| refused(plan, step)).collect()
}

fn first(step: &Step, input: usize) -> Arriving<'_> {
    match step.inputs.get(input).and_then(|sources| sources.first()) {
        None => Arriving::Nothing,
        Some(Source::Value(value)) => Arriving::Value(value),
        Some(Source::Wire { .. }) => Arriving::Wire,
    }
}

fn refused(plan: &Plan, step: &Step) -> Option<BadRequest> {
    let bad = |reason: String| BadRequest { node: step.name.clone(), reason };
    if step.bypass {
        return (!step.can_pass_on()).then(|| bad(NOTHING_TO_PASS.to_owned()));
    }
    let arriving = |input: usize| first(step, input);
    let told = KnownInputs::new(step.def, &arriving);
    if let Err(err) = step.def.refused(&told) {
        return Some(bad(err.to_string()));
    }
    step.def.inputs.iter().enumerate().find_map(|(i, input)| {
        let Arriving::Value(Value::Field(field)) = arriving(i) else { return None };
        let names = field.mask_names();
        if names.is_empty() || is_idle(input, &told) {
            return None;
        }
        let fault = match masks_under(plan, step) {
            None => FieldFault::NoScalp((*names.first()?).to_owned()),
            Some(known) => {
                let known = known?;
                let unknown = names.into_iter().find(|name| !known.iter().any(|it| it == name))?;
                FieldFault::NoMask { name: unknown.to_owned(), known: known.join(", ") }
            }
        };
        Some(bad(format!("{}: {fault}", input.name)))
    })
}

/// Whether the node does not read an input, given its other values.
fn is_idle(input: &InputDef, told: &KnownInputs) -> bool {
    input.idle.is_some_and(|idle| idle(&|name| told.value(name)).is_some())
}

/// The masks of the scalp that a step stands on, none within where only evaluating it tells; none where it stands on none.
fn masks_under(plan: &Plan, step: &Step) -> Option<Option<Vec<String>>> {
    let scalp = step.def.inputs.iter().position(|input| input.ty == Type::Scalp)?;
    let Source::Wire { step, .. } = step.inputs.get(scalp)?.first()? else { return None };
    let under = plan.steps.get(*step)?;
    let arriving = |input: usize| first(under, input);
    Some(under.def.mask_names(&KnownInputs::new(under.def, &arriving)))
}
