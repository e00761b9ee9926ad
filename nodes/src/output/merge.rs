//! Merge: several lots of curves as one, every id once.
//!
//! Guarantees: nothing is copied but the ids of tufts that hold a repeated one; of curves with one id the first
//! keeps it.

use crate::data::attributes::{Domain, ID};
use crate::data::curves::{Curves, Tuft};
use crate::define::{NodeError, node};
use crate::eval::{EvalCx, Size};
use crate::maths::hash::curve_id;
use std::sync::Arc;

node! {
    /// Put several lots of curves together, in the order of the wires.
    ///
    /// Where the same curve id comes in twice, as from two copies of one branch, later curves get new ids, for ids
    /// must differ for colours, picking and export.
    "merge", version 1, label "Merge", words "join combine add together append union";
    inputs {
        /// Curves to put together.
        curves | in: Vec<Curves>;
    }
    outputs {
        /// All of them.
        curves: Curves;
    }
}

fn eval(cx: &EvalCx, inputs: Inputs) -> Result<Outputs, NodeError> {
    cx.may_make(&Size::as_many(&inputs.curves))?;
    let tufts: Vec<&Arc<Tuft>> = inputs.curves.iter().flat_map(|c| c.tufts()).collect();
    let mut seen: Vec<(u64, u32, u32)> = vec![];
    for (t, tuft) in (0..).zip(&tufts) {
        cx.check()?;
        let ids = tuft.view(ID);
        let first = |i: usize| tuft.offsets()[i] as usize;
        seen.extend((0..tuft.len()).map(|i| (ids.at(i, first(i)), t, i as u32)));
    }
    cx.check()?;
    seen.sort_unstable();
    cx.check()?;
    // Later curves of one id, and all that have none.
    let repeated: Vec<(u64, u32, u32, u64)> = {
        let mut before = 0;
        let mut nth = |at: usize| {
            before = if at > 0 && seen[at - 1].0 == seen[at].0 { before + 1 } else { 0 };
            before
        };
        let all = (0..seen.len()).map(|at| (seen[at].0, seen[at].1, seen[at].2, nth(at)));
        all.filter(|(id, .., nth)| *nth > 0 || *id == 0).collect()
    };
    if repeated.is_empty() {
        return Ok(Outputs { curves: Curves::new(tufts.into_iter().cloned().collect()) });
    }
    let mut fresh: Vec<(u32, u32, u64)> = vec![];
    let mut given = std::collections::BTreeSet::new();
    for (n, (id, tuft, curve, nth)) in repeated.iter().enumerate() {
        if n.is_multiple_of(4096) {
            cx.check()?;
        }
        let taken = |id: u64| seen.binary_search_by(|one| one.0.cmp(&id)).is_ok();
        let new = fresh_id(*id, *nth, |new| !taken(*new) && given.insert(*new));
        fresh.push((*tuft, *curve, new));
    }
    fresh.sort_unstable();
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
    let none = repeated.iter().filter(|(id, ..)| *id == 0).count();
    let twice = repeated.len() - none;
    for (lot, text) in [(twice, "came in with an id that another has"), (none, "had no id")] {
        match lot {
            0 => {}
            1 => cx.remark(format!("1 curve {text} and got a new one")),
            n => cx.remark(format!("{n} curves {text} and got new ones")),
        }
    }
    Ok(Outputs { curves: Curves::new(out) })
}

/// A new id for the `nth` curve of one id: the first that `takes` takes. Each try is another id of this curve. The new id of the
/// one that was taken would be taken, too, where lots were merged with themselves again and again: a walk along all of them.
fn fresh_id(id: u64, nth: u64, takes: impl FnMut(&u64) -> bool) -> u64 {
    (0..).map(|k| curve_id(id, MERGED + k, nth)).find(takes).unwrap_or_default()
}

/// Stands for "made by merging" among seed tags; the tries of one curve follow.
const MERGED: u64 = 0x6D65_7267_6500;

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
    fn lots_merged_with_themselves_again_and_again_find_new_ids_in_as_many_tries_as_merges() {
        let mut ids = BTreeSet::from([1u64, 2, 3]);
        let (mut tries, mut asked) = (0, 0);
        for merge in 0..10 {
            for id in ids.clone() {
                fresh_id(id, 1, |new| {
                    tries += 1;
                    ids.insert(*new)
                });
                asked += 1;
            }
            assert_eq!(ids.len(), 3 << (merge + 1));
        }
        // An id of the first lot has had a new one made of it in each merge before, 9 at most.
        assert!(tries <= 10 * asked, "{tries} tries for {asked} ids");
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
