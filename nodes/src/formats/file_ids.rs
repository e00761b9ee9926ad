//! Ids in files: 31 bits, unique over the whole file.
//!
//! Guarantees: guides keep their ids, and hair has none that another curve has or that names what hair was made from (`clumpId`), so
//! a `clumpId` is never the id of hair. Who gets another, and which, is told as where lots are merged (`data/ids.rs`). What is one id in
//! the graph is one number in all prims of the file. Guides without an id, or with that of another guide, get new ones, too.
//!
//! Not promised: the same number in another file, where another curve may have it.

use super::FormatError;
use super::export::HairGroup;
use crate::data::attributes::PARENT;
use crate::data::curves::Curves;
use crate::data::ids::renewed;
use std::collections::BTreeSet;

/// The file numbers of all ids.
pub(super) struct FileIds {
    /// Full ids of curves and of their parents, ascending, and their numbers.
    numbers: Vec<(u64, i32)>,
    /// The full id of each curve, group after group.
    of_groups: Vec<Vec<u64>>,
}

impl FileIds {
    /// The ids of a file with these groups.
    ///
    /// # Errors
    /// The result of `go_on`, which is polled now and then.
    pub(super) fn of(
        groups: &[HairGroup],
        go_on: &dyn Fn() -> Result<(), FormatError>,
    ) -> Result<Self, FormatError> {
        let ids =
            |group: &HairGroup| group.curves.each().map(|(t, i)| t.id(i)).collect::<Vec<u64>>();
        let mut of_groups: Vec<Vec<u64>> = groups.iter().map(ids).collect();
        go_on()?;
        let is_guides = |g: &usize| groups[*g].guides;
        let (guides, hair): (Vec<usize>, Vec<usize>) = (0..groups.len()).partition(is_guides);
        let mut all: Vec<u64> = guides.iter().flat_map(|g| of_groups[*g].iter().copied()).collect();
        let kept: BTreeSet<u64> = all.iter().copied().collect();
        // Parents have their numbers already, whether they are in the file or not.
        let mut reserved: Vec<u64> =
            groups.iter().flat_map(|group| parents(&group.curves)).collect();
        reserved.sort_unstable();
        reserved.dedup();
        reserved.retain(|id| *id != 0 && !kept.contains(id));
        let reserved_at = all.len()..all.len() + reserved.len();
        all.extend(&reserved);
        all.extend(hair.iter().flat_map(|g| of_groups[*g].iter().copied()));
        go_on()?;
        renewed(&all, go_on)?.into_iter().for_each(|(at, new)| all[at as usize] = new);
        let mut give = |groups: &[usize], mut ids: &[u64]| {
            for g in groups {
                let (own, rest) = ids.split_at(of_groups[*g].len());
                of_groups[*g].copy_from_slice(own);
                ids = rest;
            }
        };
        give(&guides, &all[..reserved_at.start]);
        give(&hair, &all[reserved_at.end..]);
        go_on()?;
        Ok(Self { numbers: numbers(&all, reserved_at.end), of_groups })
    }

    /// The number of each curve of a group.
    pub(super) fn of_group(&self, group: usize) -> Vec<i32> {
        self.of_groups[group].iter().map(|id| self.number(*id)).collect()
    }

    /// The number of any id: of a curve, a parent, or something else, such as a braid.
    pub(super) fn number(&self, id: u64) -> i32 {
        match self.numbers.binary_search_by(|one| one.0.cmp(&id)) {
            Ok(at) => self.numbers[at].1,
            Err(_) => fold(id),
        }
    }
}

/// Ids of the curves' parents; often repeated.
fn parents(curves: &Curves) -> Vec<u64> {
    let mut parents: Vec<u64> = vec![];
    for (tuft, i) in curves.each() {
        let parent = tuft.view(PARENT).at(i, tuft.range(i).start);
        if parents.last() != Some(&parent) {
            parents.push(parent);
        }
    }
    parents
}

/// The number of each id, ascending by id: its folded form, or the next free number if that is taken. Of ids that fold to one
/// number, the first `kept` ids keep it before the others, then the smaller one.
fn numbers(ids: &[u64], kept: usize) -> Vec<(u64, i32)> {
    let order = ids.iter().enumerate().map(|(at, id)| (fold(*id), at >= kept, *id));
    let mut order: Vec<(i32, bool, u64)> = order.collect();
    order.sort_unstable();
    let mut taken: Option<BTreeSet<i32>> = None;
    let mut numbers: Vec<(u64, i32)> = Vec::with_capacity(order.len());
    for same in order.chunk_by(|a, b| a.0 == b.0) {
        // Below the last number given to ids of one fold, none is free.
        let mut free = same[0].0;
        for (nth, (folded, _, id)) in same.iter().enumerate() {
            if nth == 0 {
                numbers.push((*id, *folded));
                continue;
            }
            let all = || order.iter().map(|one| one.0).collect();
            let taken = taken.get_or_insert_with(all);
            while !taken.insert(free) {
                free = if free == i32::MAX { 1 } else { free + 1 };
            }
            numbers.push((*id, free));
        }
    }
    numbers.sort_unstable();
    numbers
}

/// A stable id in the 31 bits of an `int` primvar. 0, which means none, stays 0, and nothing else becomes 0.
fn fold(id: u64) -> i32 {
    let folded = ((id ^ (id >> 33)) & 0x7FFF_FFFF) as i32;
    if id == 0 { 0 } else { folded.max(1) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::attributes::{Domain, ID};
    use crate::data::curves::TuftBuilder;
    use glam::Vec3;

    /// A group of curves with these ids, made from those.
    fn group(guides: bool, ids: &[u64], made_from: &[u64]) -> HairGroup {
        let mut b = TuftBuilder::new();
        ids.iter().for_each(|_| b.push_curve(&[Vec3::ZERO, Vec3::Y]));
        b.set(ID, Domain::Curve, ids.to_vec());
        b.set(PARENT, Domain::Curve, made_from.to_vec());
        HairGroup { name: "a".into(), guides, curves: Curves::new(vec![b.build().into()]) }
    }

    /// Numbers of each group's curves. Whatever goes in, no number is there twice, and none of hair is a clump's.
    #[track_caller]
    fn numbers_of(groups: &[HairGroup]) -> Vec<Vec<i32>> {
        let ids = FileIds::of(groups, &|| Ok(())).unwrap();
        let all: Vec<Vec<i32>> = (0..groups.len()).map(|g| ids.of_group(g)).collect();
        let each: BTreeSet<i32> = all.iter().flatten().copied().collect();
        assert_eq!(each.len(), all.iter().map(Vec::len).sum::<usize>(), "{all:?}");
        assert!(!each.contains(&0), "{all:?}");
        let clumps = groups.iter().flat_map(|group| parents(&group.curves)).filter(|id| *id != 0);
        let clumps: BTreeSet<i32> = clumps.map(|id| ids.number(id)).collect();
        for (group, numbers) in groups.iter().zip(&all).filter(|(group, _)| !group.guides) {
            assert!(numbers.iter().all(|id| !clumps.contains(id)), "{}: {all:?}", group.name);
        }
        all
    }

    #[test]
    fn guides_keep_their_ids_and_hair_of_the_same_gets_others() {
        // The hair stands first in the file and was made from the guides 5 and 6, whose ids two of its hairs have.
        let all =
            numbers_of(&[group(false, &[5, 6, 7], &[6, 5, 5]), group(true, &[5, 6], &[0, 0])]);
        assert_eq!((all[1].as_slice(), all[0][2]), (&[5, 6][..], 7));
    }

    #[test]
    fn hair_has_no_id_of_what_hair_was_made_from_though_that_is_not_in_the_file() {
        let all = numbers_of(&[group(false, &[5, 6, 7], &[5, 5, 0])]);
        assert_eq!(all[0][1..], [6, 7]);
    }

    #[test]
    fn curves_of_two_outputs_have_each_their_own_and_the_first_keeps_it() {
        let all =
            numbers_of(&[group(false, &[5, 6], &[0, 0]), group(false, &[6, 5, 0], &[0, 0, 0])]);
        assert_eq!(all[0], [5, 6]);
    }

    #[test]
    fn ids_that_fold_to_one_number_are_told_apart_and_guides_keep_theirs() {
        // Bits 31 and 32 do not reach the number.
        let all = numbers_of(&[
            group(false, &[5, 5 | 1 << 31], &[0, 5 | 1 << 32]),
            group(true, &[5 | 1 << 32, 6], &[0, 0]),
        ]);
        assert_eq!(all[1], [5, 6]);
    }

    #[test]
    fn curves_without_ids_are_numbered_in_no_time() {
        let n = 100_000;
        let none = vec![0; n];
        let group = group(false, &none, &none);
        let curves = Curves::new((*group.curves.tufts()[0]).clone().split());
        // Each searched from 0 on for a free number, which was 5,000,000,000 looks.
        numbers_of(&[HairGroup { curves, ..group }]);
        assert_eq!(numbers(&vec![1 << 31; n], 0).last().unwrap().1, n as i32);
    }

    #[test]
    fn an_id_never_folds_to_none() {
        assert_eq!(fold(0), 0);
        for id in [1 << 31, 1 | 1 << 33, 5, u64::MAX] {
            assert!(fold(id) > 0, "{id:x}");
        }
    }
}
