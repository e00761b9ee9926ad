//! Lists whose items have names: in which order two people's versions of one list go together.
//!
//! As in files (`text/order.rs`), what comes to a list comes behind something: what one person adds stands right behind the item
//! that it was put behind, and where both put something there, the lots of the names tell which comes first. So it is the same
//! whoever merges whom.

use std::collections::{BTreeMap, BTreeSet};

/// Names that are told apart even where an item stands twice in its list: each with how many of its like came before.
pub(super) fn numbered<N: Ord + Clone>(names: impl Iterator<Item = N>) -> Vec<(N, usize)> {
    let mut seen = BTreeMap::<N, usize>::new();
    let number = |name: N| {
        let count = seen.entry(name.clone()).or_default();
        *count += 1;
        (name, *count - 1)
    };
    names.map(number).collect()
}

/// Whether two lists have what both hold in the same order.
pub(super) fn is_in_one_order<K: Ord>(a: &[K], b: &[K]) -> bool {
    let (of_a, of_b): (BTreeSet<&K>, BTreeSet<&K>) = (a.iter().collect(), b.iter().collect());
    a.iter().filter(|k| of_b.contains(k)).eq(b.iter().filter(|k| of_a.contains(k)))
}

/// The `kept` items of two versions of a list in one order, and whether the two contradict each other: then it is that of `ours`.
/// No name may stand twice in a list, and each has a lot of its own.
pub(super) fn in_one_order<K: Ord + Clone, L: Ord>(
    base: &[K],
    ours: &[K],
    theirs: &[K],
    kept: impl Fn(&K) -> bool,
    lot: impl Fn(&K) -> L,
) -> (Vec<K>, bool) {
    let of = |list: &[K]| list.iter().filter(|k| kept(k)).cloned().collect::<BTreeSet<K>>();
    let both: BTreeSet<K> = of(ours).intersection(&of(theirs)).cloned().collect();
    let common =
        |list: &[K]| -> Vec<K> { list.iter().filter(|k| both.contains(k)).cloned().collect() };
    let (first, second, before) = (common(ours), common(theirs), common(base));
    // Of what both added, nobody says where it was.
    let knows_all = before.len() == both.len();
    let contradict = first != second && !(knows_all && (first == before || second == before));
    let order = if knows_all && first == before { second } else { first };

    let [mut ours, mut theirs] = [ours, theirs].map(|list| behind(list, &both, &kept));
    let mut all = vec![];
    for at in std::iter::once(None).chain(order.into_iter().map(Some)) {
        let mut blocks = [&mut ours, &mut theirs].map(|gaps| gaps.remove(&at).unwrap_or_default());
        blocks.sort_by_key(|block| block.first().map(&lot));
        all.extend(at);
        all.extend(blocks.into_iter().flatten());
    }
    (all, contradict)
}

/// What only this list holds, by the item of `both` that it stands behind.
fn behind<K: Ord + Clone>(
    list: &[K],
    both: &BTreeSet<K>,
    kept: impl Fn(&K) -> bool,
) -> BTreeMap<Option<K>, Vec<K>> {
    let (mut gaps, mut at) = (BTreeMap::<_, Vec<K>>::new(), None);
    for k in list.iter().filter(|k| kept(k)) {
        if both.contains(k) {
            at = Some(k.clone());
        } else {
            gaps.entry(at.clone()).or_default().push(k.clone());
        }
    }
    gaps
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::document::testing::Random;
    use crate::text::order::lot;

    #[test]
    fn what_two_add_stands_behind_what_each_put_it_behind() {
        #[track_caller]
        fn check(base: &str, ours: &str, theirs: &str, expected: &str) {
            let split = |list: &str| list.chars().collect::<Vec<char>>();
            let [base, a, b] = [base, ours, theirs].map(split);
            let gone = |k: &char| base.contains(k) && !(a.contains(k) && b.contains(k));
            let merged = |a: &[char], b: &[char]| {
                let (list, contradict) =
                    in_one_order(&base, a, b, |k| !gone(k), |k| lot(&k.to_string()));
                let mark = if contradict { "!" } else { "" };
                format!("{}{mark}", list.into_iter().collect::<String>())
            };
            assert_eq!(merged(&a, &b), expected);
            if !expected.ends_with('!') {
                assert_eq!(merged(&b, &a), expected);
            }
        }
        check("abc", "abc", "abc", "abc");
        check("abc", "axbc", "abyc", "axbyc");
        // Behind one item: each block whole, in the order of their lots.
        let first = if lot("x") < lot("y") { "abxzyc" } else { "abyxzc" };
        check("abc", "abxzc", "abyc", first);
        check("abc", "ac", "abcy", "acy");
        // What it stood behind is gone.
        check("abc", "ac", "abyc", "ayc");
        check("abc", "cab", "abyc", "caby");
        check("abc", "cab", "cab", "cab");
        check("abc", "cab", "bac", "cab!");
        check("", "xy", "xy", "xy");
        check("", "xy", "yx", "xy!");
    }

    #[test]
    fn of_random_lists_nothing_is_lost_and_no_order_that_both_have() {
        let mut random = Random::new(3);
        for _ in 0..2000 {
            let base: Vec<u64> = (0..random.below(7) as u64).collect();
            let mut version = |from: u64| {
                let mut list = base.clone();
                for n in 0..random.below(5) as u64 {
                    match random.below(3) {
                        0 => list.insert(random.below(list.len() + 1), from + n),
                        1 if !list.is_empty() => drop(list.remove(random.below(list.len()))),
                        _ if !list.is_empty() => {
                            let k = list.remove(random.below(list.len()));
                            list.insert(random.below(list.len() + 1), k);
                        }
                        _ => {}
                    }
                }
                list
            };
            let (a, b) = (version(10), version(20));
            let keep = |k: &u64| *k >= 10 || a.contains(k) && b.contains(k);
            let merge = |a: &[u64], b: &[u64]| in_one_order(&base, a, b, keep, u64::clone);
            let (list, contradict) = merge(&a, &b);
            let all: BTreeSet<u64> = a.iter().chain(&b).copied().filter(keep).collect();
            assert_eq!(list.iter().copied().collect::<BTreeSet<_>>(), all);
            assert_eq!(list.len(), all.len());
            assert!(contradict || merge(&b, &a) == (list.clone(), false), "{base:?} {a:?} {b:?}");
            let of = |side: &[u64]| side.iter().copied().filter(keep).collect::<Vec<u64>>();
            if is_in_one_order(&a, &b) {
                assert!(is_in_one_order(&of(&a), &list) && is_in_one_order(&of(&b), &list));
            }
            assert_eq!(in_one_order(&base, &a, &base, |k| a.contains(k), u64::clone).0, a);
            assert_eq!(in_one_order(&base, &a, &a, |_| true, u64::clone), (a.clone(), false));
        }
    }
}
