//! Unique ids where sets of curves are combined.
//!
//! Guarantees: of several curves with one id, the first keeps it; the others, and all curves without an id, get unused
//! ids. The new ids are a pure function of the ids and their order.

use crate::maths::hash::curve_id;
use std::collections::BTreeSet;

/// Curves that need another id, by their index among all, ascending, with the new id. `go_on` is polled now and then.
///
/// # Errors
/// Returns what `go_on` returns.
pub(crate) fn renewed<E>(
    ids: &[u64],
    go_on: impl Fn() -> Result<(), E>,
) -> Result<Vec<(u32, u64)>, E> {
    let mut seen: Vec<(u64, u32)> = ids.iter().copied().zip(0..).collect();
    go_on()?;
    seen.sort_unstable();
    go_on()?;
    let mut fresh: Vec<(u32, u64)> = vec![];
    let mut given = BTreeSet::new();
    for same in seen.chunk_by(|a, b| a.0 == b.0) {
        let id = same[0].0;
        // The first curve with an id keeps it; nobody keeps 0.
        let first = if id == 0 { 0 } else { 1 };
        for (nth, (_, at)) in (0..).zip(same).skip(first) {
            if fresh.len().is_multiple_of(4096) {
                go_on()?;
            }
            let taken = |new: u64| seen.binary_search_by(|one| one.0.cmp(&new)).is_ok();
            fresh.push((*at, fresh_id(id, nth, |new| !taken(*new) && given.insert(*new))));
        }
    }
    fresh.sort_unstable();
    Ok(fresh)
}

/// A new id for the `nth` curve with one id: the first candidate that `takes` accepts. Each attempt derives from this
/// curve's own id. Deriving it from the rejected candidate would walk along all earlier ids when sets are merged with
/// themselves repeatedly.
fn fresh_id(id: u64, nth: u64, takes: impl FnMut(&u64) -> bool) -> u64 {
    (0..).map(|k| curve_id(id, MERGED + k, nth)).find(takes).unwrap_or_default()
}

/// Seed tag that stands for "made by merging"; the attempts for one curve follow it.
const MERGED: u64 = 0x6D65_7267_6500;

#[cfg(test)]
mod tests {
    use super::*;

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
        // Each earlier merge gave new ids derived from those of the first set, 9 at most.
        assert!(tries <= 10 * asked, "{tries} tries for {asked} ids");
    }
}
