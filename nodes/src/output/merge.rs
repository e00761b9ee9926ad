//! Merge: several sets of curves combined, with unique ids.
//!
//! Guarantees: only the ids of tufts with a duplicate are copied; of several curves with one id, the first keeps it.

use crate::data::attributes::{Domain, ID};
use crate::data::curves::{Curves, Tuft};
use crate::data::ids::renewed;
use crate::define::{NodeError, node};
use crate::eval::{EvalCx, Size};
use std::sync::Arc;

node! {
    /// Combines several sets of curves, in the order of the wires.
    ///
    /// Curves whose id is already taken, as when two copies of one branch meet, get new ids: colours, picking and export
    /// need unique ids.
    "merge", version 1, label "Merge", words "join combine add together append union";
    inputs {
        /// Curves to combine.
        curves | in: Vec<Curves>;
    }
    outputs {
        /// All the curves.
        curves: Curves;
    }
}

fn eval(cx: &EvalCx, inputs: Inputs) -> Result<Outputs, NodeError> {
    cx.may_make(&Size::as_many(&inputs.curves))?;
    let tufts: Vec<&Arc<Tuft>> = inputs.curves.iter().flat_map(|c| c.tufts()).collect();
    let (mut ids, mut of) = (vec![], vec![]);
    for (t, tuft) in (0u32..).zip(&tufts) {
        cx.check()?;
        ids.extend((0..tuft.len()).map(|i| tuft.id(i)));
        of.extend((0..tuft.len()).map(|i| (t, i as u32)));
    }
    let fresh = renewed(&ids, || cx.check())?;
    if fresh.is_empty() {
        return Ok(Outputs { curves: Curves::new(tufts.into_iter().cloned().collect()) });
    }
    let none = fresh.iter().filter(|(at, _)| ids[*at as usize] == 0).count();
    let twice = fresh.len() - none;
    let fresh: Vec<(u32, u32, u64)> =
        fresh.into_iter().map(|(at, new)| (of[at as usize].0, of[at as usize].1, new)).collect();
    let mut out: Vec<Arc<Tuft>> = tufts.into_iter().cloned().collect();
    for group in fresh.chunk_by(|a, b| a.0 == b.0) {
        cx.check()?;
        let tuft = &mut out[group[0].0 as usize];
        let mut ids: Vec<u64> = (0..tuft.len()).map(|i| tuft.id(i)).collect();
        group.iter().for_each(|(_, curve, new)| ids[*curve as usize] = *new);
        let mut edit = tuft.edit();
        edit.set(ID, Domain::Curve, ids);
        *tuft = Arc::new(edit.build());
    }
    for (lot, text) in [(twice, "came in with an id that another has"), (none, "had no id")] {
        match lot {
            0 => {}
            1 => cx.remark(format!("1 curve {text} and got a new one")),
            n => cx.remark(format!("{n} curves {text} and got new ones")),
        }
    }
    Ok(Outputs { curves: Curves::new(out) })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::curves::TuftBuilder;
    use crate::testing::{curves_of, run};
    use glam::Vec3;
    use std::collections::BTreeSet;

    fn lot(ids: &[u64]) -> Curves {
        let tufts = ids.chunks(2).map(|ids| {
            let mut b = TuftBuilder::new();
            ids.iter().for_each(|id| b.push_curve(&[Vec3::ZERO, Vec3::Y * (*id as f32 + 1.0)]));
            b.set(ID, Domain::Curve, ids.to_vec());
            Arc::new(b.build())
        });
        Curves::new(tufts.collect())
    }

    #[track_caller]
    fn check(lots: &[&[u64]], said: &[&str]) {
        let set: Vec<_> = lots.iter().map(|ids| ("curves", lot(ids).into())).collect();
        let (out, messages) = run(&NODE, &set);
        assert_eq!(messages, said);
        let merged = curves_of(&out[0]);
        let before: Vec<u64> = lots.iter().flat_map(|l| l.iter().copied()).collect();
        let ids: Vec<u64> = merged.each().map(|(t, i)| t.id(i)).collect();
        assert_eq!(ids.len(), before.len());
        assert_eq!(ids.iter().collect::<BTreeSet<_>>().len(), ids.len(), "{ids:?}");
        for (i, id) in before.iter().enumerate() {
            let first = *id != 0 && !before[..i].contains(id);
            assert_eq!(ids[i] == *id, first, "curve {i}");
        }
    }

    #[test]
    fn every_id_is_there_once_and_the_first_keeps_it() {
        check(&[&[1, 2, 3], &[4, 5]], &[]);
        check(
            &[&[1, 2, 3], &[3, 5]],
            &["1 curve came in with an id that another has and got a new one"],
        );
        let many = "4 curves came in with an id that another has and got new ones";
        check(&[&[1, 2, 3], &[1, 2], &[1, 2]], &[many]);
        check(&[&[0, 2], &[0]], &["2 curves had no id and got new ones"]);
        check(&[], &[]);
    }

    #[test]
    fn tufts_without_repeats_are_the_same_tufts() {
        let (a, b) = (lot(&[1, 2, 3, 4]), lot(&[3, 9]));
        let (out, _) = run(&NODE, &[("in", a.clone().into()), ("curves", b.clone().into())]);
        let tufts = curves_of(&out[0]).tufts();
        assert!(Arc::ptr_eq(&tufts[0], &a.tufts()[0]) && Arc::ptr_eq(&tufts[1], &a.tufts()[1]));
        assert_eq!(tufts[2].points().as_ptr(), b.tufts()[0].points().as_ptr());
    }
}
