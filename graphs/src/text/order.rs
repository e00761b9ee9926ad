//! In which order things stand in a file, so that two people who add something seldom add it at the
//! same place: git cannot merge two additions at one place, and it can where a line stands between them.
//!
//! Two laws. *Lots*: entries stand in the order of a hash of their names, with blank lines where the
//! hash passes whole parts of its range; so each new entry has a place of its own among lines that are
//! there already. *After*: what has an order that means something says behind what it comes where
//! that is not where it stands, so that none has a number that a new one would change.

use coif_nodes::maths::hash::KeyBuilder;
use std::collections::BTreeMap;

/// Paragraphs of a list of nodes: 31 blank lines part them.
pub(crate) const NODES: usize = 32;
/// Paragraphs of a list of strokes or gestures.
pub(super) const ITEMS: usize = 16;

/// Paragraphs of a list of frames or views.
pub(crate) const FRAMES: usize = 8;

/// Where a name stands among others.
pub(crate) fn lot(name: &str) -> u32 {
    KeyBuilder::new("lot").text(name).finish().0 as u32
}

/// Things by lot, each with the number of blank lines before it, and the number of them behind all.
pub(crate) fn by_lot<T>(
    things: impl Iterator<Item = T>,
    name: impl Fn(&T) -> String,
    paragraphs: usize,
) -> (Vec<(usize, T)>, usize) {
    let mut drawn: Vec<(u32, T)> = things.map(|thing| (lot(&name(&thing)), thing)).collect();
    drawn.sort_by_key(|(lot, _)| *lot);
    let mut reached = 0;
    let mut blank_before = |lot: u32| {
        let paragraph = ((u64::from(lot) * paragraphs as u64) >> 32) as usize;
        paragraph - std::mem::replace(&mut reached, paragraph)
    };
    let placed: Vec<_> = drawn.into_iter().map(|(lot, thing)| (blank_before(lot), thing)).collect();
    let rest = if placed.is_empty() { 0 } else { blank_before(u32::MAX) };
    (placed, rest)
}

/// The order of things that say behind what they come: the numbers of `said`, which are in the order of
/// the file. What says nothing comes in the file's order, each with all that comes behind it; then what
/// names something that is not there, as after a merge with a branch that removed it; last what only
/// names its like in a circle.
pub(crate) fn in_order<K: Ord + Copy>(said: &[(K, Option<K>)]) -> Vec<usize> {
    let mut number = BTreeMap::new();
    for (n, (name, _)) in said.iter().enumerate() {
        number.entry(*name).or_insert(n);
    }
    let mut behind: Vec<Vec<usize>> = vec![vec![]; said.len()];
    let (mut first, mut lost) = (vec![], vec![]);
    for (n, (_, after)) in said.iter().enumerate() {
        match after {
            None => first.push(n),
            Some(after) => match number.get(after) {
                Some(found) => behind[*found].push(n),
                None => lost.push(n),
            },
        }
    }
    let (mut order, mut taken) = (Vec::with_capacity(said.len()), vec![false; said.len()]);
    for root in first.into_iter().chain(lost).chain(0..said.len()) {
        let mut open = vec![root];
        while let Some(n) = open.pop() {
            if !std::mem::replace(&mut taken[n], true) {
                order.push(n);
                open.extend(behind[n].iter().rev());
            }
        }
    }
    order
}

/// For each thing of a list the one that it says it comes after, by `ranks`: where each stands in the
/// file. [`in_order`] takes it back. As few as can be say anything, and one that comes between two others
/// mostly changes neither: what stands later in the file than all since some thing comes after nothing but
/// what that thing itself does.
pub(crate) fn after<R: Ord>(ranks: &[R]) -> Vec<Option<usize>> {
    let mut open: Vec<usize> = vec![];
    let said = |n: usize| {
        while open.last().is_some_and(|last| ranks[*last] < ranks[n]) {
            open.pop();
        }
        let after = open.last().copied();
        open.push(n);
        after
    };
    (0..ranks.len()).map(said).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_comes_after_another_comes_right_behind_it() {
        #[track_caller]
        fn check(said: &str, expected: &str) {
            let said: Vec<(&str, Option<&str>)> = said
                .split(' ')
                .map(|one| one.split_once('>').map_or((one, None), |(a, b)| (b, Some(a))))
                .collect();
            let order: Vec<&str> = in_order(&said).into_iter().map(|n| said[n].0).collect();
            assert_eq!(order.join(" "), expected);
        }
        check("a b c", "a b c");
        // Written in another order than it means.
        check("b>c a a>b", "a b c");
        // Two branches added behind `b`: in the order of the file, whichever was merged into which.
        check("b>y a a>b b>x", "a b y x");
        // One of them has something behind it, and so has `a`.
        check("a b>y a>b b>x y>z a>c", "a b y z x c");
        // A branch removed `b`.
        check("b>c a a>d", "a d c");
        check("a>b b>a c", "c b a");
        check("a>a", "a");
    }

    #[test]
    fn what_is_said_gives_the_order_back() {
        // A thing stands in the file where its number says: 2 3 1 means that 1 comes last.
        assert_eq!(after(&[2, 3, 1]), [None, None, Some(1)]);
        assert_eq!(after(&[3, 1, 2]), [None, Some(0), Some(0)]);
        assert_eq!(after(&[1, 2, 3]), [None; 3]);
        assert_eq!(after(&[3, 2, 1]), [None, Some(0), Some(1)]);
        let mut random = crate::document::testing::Random::new(4);
        for _ in 0..500 {
            let ranks: Vec<u64> = (0..random.below(12)).map(|_| random.bits()).collect();
            let said = after(&ranks);
            let mut file: Vec<usize> = (0..ranks.len()).collect();
            file.sort_by_key(|n| ranks[*n]);
            let in_file: Vec<_> = file.iter().map(|n| (*n, said[*n])).collect();
            let order: Vec<usize> = in_order(&in_file).into_iter().map(|n| in_file[n].0).collect();
            assert_eq!(order, (0..ranks.len()).collect::<Vec<_>>(), "{ranks:?}");
        }
    }

    #[test]
    fn lots_are_spread_over_all_paragraphs() {
        let (placed, rest) = by_lot(0..1000, |n| format!("node_{n}"), NODES);
        assert_eq!(placed.iter().map(|(blank, _)| blank).sum::<usize>() + rest, NODES - 1);
        assert!(placed.iter().all(|(blank, _)| *blank < 2) && placed.len() == 1000);
    }
}
