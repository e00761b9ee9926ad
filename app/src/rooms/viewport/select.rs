//! Which curves belong together, and which of them are seen.
//!
//! Pure functions of curves. Nothing here changes a groom.

use crate::core::visibility::Visibility;
use coif_nodes::data::attributes::{BRAID, PARENT, STRAND};
use coif_nodes::data::curves::{Curves, Tuft};
use std::collections::BTreeSet;
use std::sync::Arc;

/// What a curve can be called by: its id, what it was made from, and its braid. Zero names nothing.
pub fn names(tuft: &Tuft, curve: usize) -> [u64; 3] {
    let first = tuft.range(curve).start;
    [tuft.id(curve), tuft.view(PARENT).at(curve, first), tuft.view(BRAID).at(curve, first)]
}

/// The curves that are not hidden. Tufts that are seen whole are shared.
pub(super) fn visible(curves: &Curves, visibility: &Visibility) -> Curves {
    if visibility.shows_all() {
        return curves.clone();
    }
    let seen = curves.tufts().iter().filter_map(|tuft| {
        let seen: Vec<u32> = (0..tuft.len())
            .filter(|i| visibility.shows(&names(tuft, *i)))
            .map(|i| i as u32)
            .collect();
        match seen.len() {
            0 => None,
            n if n == tuft.len() => Some(tuft.clone()),
            _ => Some(Arc::new(tuft.gather(&seen).build())),
        }
    });
    Curves::new(seen.collect())
}

/// How much one click takes; the next click on the same place takes more.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Level {
    /// One hair.
    Hair,
    /// All hair of the curve that it was made from.
    Cluster,
    /// The strand of its braid.
    Strand,
    /// The braid.
    Braid,
    /// All that its node made.
    Node,
}

impl Level {
    /// From one hair to all of them.
    pub const ALL: [Self; 5] = [Self::Hair, Self::Cluster, Self::Strand, Self::Braid, Self::Node];

    /// What it is called.
    pub fn name(self) -> &'static str {
        match self {
            Self::Hair => "hair",
            Self::Cluster => "cluster",
            Self::Strand => "strand",
            Self::Braid => "braid",
            Self::Node => "node",
        }
    }
}

/// A curve's place in the groom.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Kin {
    id: u64,
    parent: u64,
    braid: u64,
    strand: i32,
}

fn kin(tuft: &Tuft, curve: usize) -> Kin {
    let [id, parent, braid] = names(tuft, curve);
    Kin { id, parent, braid, strand: tuft.view(STRAND).at(curve, tuft.range(curve).start) }
}

/// The ids of all curves that belong with one at a level; only the node's own hair is `made`, where it is known.
pub fn together_with(
    curves: &Curves,
    (tuft, curve): (&Tuft, usize),
    level: Level,
    made: Option<&Curves>,
) -> BTreeSet<u64> {
    let one = kin(tuft, curve);
    let ids = |curves: &Curves, with: &dyn Fn(Kin) -> bool| -> BTreeSet<u64> {
        curves.each().map(|(t, i)| kin(t, i)).filter(|k| with(*k)).map(|k| k.id).collect()
    };
    match level {
        Level::Hair => [one.id].into(),
        Level::Cluster if one.parent != 0 => ids(curves, &|k| k.parent == one.parent),
        Level::Strand if one.braid != 0 => {
            ids(curves, &|k| (k.braid, k.strand) == (one.braid, one.strand))
        }
        Level::Braid if one.braid != 0 => ids(curves, &|k| k.braid == one.braid),
        Level::Node => ids(made.unwrap_or(curves), &|_| true),
        _ => [one.id].into(),
    }
}

/// The next level that takes more than the last, from the last one on; hair again after the node.
pub fn next_level(
    curves: &Curves,
    of: (&Tuft, usize),
    last: Level,
    made: Option<&Curves>,
) -> (Level, BTreeSet<u64>) {
    let had = together_with(curves, of, last, made);
    let after = Level::ALL.into_iter().skip_while(|level| *level != last).skip(1);
    for level in after {
        let more = together_with(curves, of, level, made);
        if more.len() > had.len() {
            return (level, more);
        }
    }
    (Level::Hair, together_with(curves, of, Level::Hair, made))
}

#[cfg(test)]
mod tests {
    use super::*;
    use coif_nodes::data::attributes::{Domain, ID};
    use coif_nodes::data::curves::TuftBuilder;
    use glam::Vec3;

    /// Two tufts of six curves: ids 1 to 12, parents 100 and 101, braid 7 of two strands in the second tuft.
    fn groom() -> Curves {
        let tuft = |first: u64, parent: u64, braid: u64| {
            let mut b = TuftBuilder::new();
            (0..6).for_each(|i| b.push_curve(&[Vec3::X * i as f32, Vec3::Y]));
            b.set(ID, Domain::Curve, (first..first + 6).collect());
            b.set(PARENT, Domain::Curve, vec![parent]);
            b.set(BRAID, Domain::Curve, vec![braid]);
            b.set(STRAND, Domain::Curve, vec![0, 0, 0, 1, 1, 1]);
            Arc::new(b.build())
        };
        Curves::new(vec![tuft(1, 100, 0), tuft(7, 101, 7)])
    }

    fn ids(curves: &Curves) -> Vec<u64> {
        curves.each().map(|(t, i)| t.id(i)).collect()
    }

    #[test]
    fn hidden_and_lone_curves_are_found_by_any_of_their_names() {
        let all = groom();
        let check = |hidden: &[u64], alone: &[u64], expected: &[u64]| {
            let visibility = Visibility {
                hidden: hidden.iter().copied().collect(),
                alone: alone.iter().copied().collect(),
                ..Visibility::default()
            };
            assert_eq!(ids(&visible(&all, &visibility)), expected, "{hidden:?} {alone:?}");
        };
        check(&[], &[], &(1..=12).collect::<Vec<_>>());
        check(&[100], &[], &(7..=12).collect::<Vec<_>>());
        check(&[3, 7], &[], &[1, 2, 4, 5, 6]);
        check(&[], &[7], &(7..=12).collect::<Vec<_>>());
        check(&[8], &[7], &[7, 9, 10, 11, 12]);
        check(&[], &[999], &[]);
    }

    #[test]
    fn what_is_seen_whole_is_shared() {
        let all = groom();
        let visibility = Visibility { hidden: [9].into(), ..Visibility::default() };
        let seen = visible(&all, &visibility);
        assert!(Arc::ptr_eq(&seen.tufts()[0], &all.tufts()[0]));
        assert_eq!(seen.curve_count(), 11);
    }

    #[test]
    fn each_click_takes_more_and_the_last_begins_again() {
        let all = groom();
        let tuft = all.tufts()[1].clone();
        let mut level = Level::Hair;
        let mut steps = vec![];
        for _ in 0..3 {
            let (next, taken) = next_level(&all, (&tuft, 4), level, None);
            steps.push((next, taken.len()));
            level = next;
        }
        // The cluster is the braid here, so strand and braid add nothing to it.
        assert_eq!(steps, [(Level::Cluster, 6), (Level::Node, 12), (Level::Hair, 1)]);
        let strand = together_with(&all, (&tuft, 4), Level::Strand, None);
        assert_eq!(strand, [10, 11, 12].into());
        let loose = all.tufts()[0].clone();
        assert_eq!(together_with(&all, (&loose, 0), Level::Braid, None), [1].into());
    }
}
