//! How hair joins braids: at which stitches, how many hairs at each, and how many at none.

use super::hair::MeasuredHair;
use std::collections::{BTreeMap, BTreeSet};

/// How hair joins braids.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Joined {
    /// Growing hairs that join.
    pub grown: usize,
    /// Extension hairs fed in.
    pub fed: usize,
    /// Hairs of braids that join at no stitch.
    pub unjoined: usize,
    /// Number of stitches with joining hair, of all braids.
    pub stitches: usize,
    /// Number of stitches without any, between a braid's first and last with some.
    pub empty_stitches: usize,
    /// Fewest, median and most hairs that join at a stitch where any do.
    pub a_stitch: [usize; 3],
}

/// How the hair of braids joins them; `None` if it carries no stitches.
pub fn measure(hair: &MeasuredHair) -> Option<Joined> {
    let (braid, stitch) = (hair.whole("braid")?, hair.whole("stitch")?);
    let fed = hair.whole("fed").unwrap_or_else(|| vec![0; hair.len()]);
    let mut counts: BTreeMap<(i64, i64), usize> = BTreeMap::new();
    let mut out =
        Joined { grown: 0, fed: 0, unjoined: 0, stitches: 0, empty_stitches: 0, a_stitch: [0; 3] };
    for i in (0..hair.len()).filter(|i| braid[*i] != 0) {
        match (stitch[i] >= 0, fed[i] > 0) {
            (false, _) => out.unjoined += 1,
            (true, true) => out.fed += 1,
            (true, false) => {
                out.grown += 1;
                *counts.entry((braid[i], stitch[i])).or_default() += 1;
            }
        }
    }
    out.stitches = counts.len();
    for braid in counts.keys().map(|(b, _)| *b).collect::<BTreeSet<i64>>() {
        let of = || counts.keys().filter(|(b, _)| *b == braid).map(|(_, s)| *s);
        let span = of().max()? - of().min()? + 1;
        out.empty_stitches += span as usize - of().count();
    }
    let mut sizes: Vec<usize> = counts.into_values().collect();
    sizes.sort_unstable();
    if let (Some(low), Some(high)) = (sizes.first(), sizes.last()) {
        out.a_stitch = [*low, sizes[sizes.len() / 2], *high];
    }
    (out.grown + out.fed > 0).then_some(out)
}

#[cfg(test)]
mod tests {
    use super::super::hair::tests::read_of;
    use super::*;
    use crate::eval::PlainHost;
    use crate::formats::usd::read::ReadValues;
    use glam::Vec3;

    #[test]
    fn hair_per_stitch_is_counted() {
        let hair: &[Vec3] = &[Vec3::ZERO, Vec3::Y];
        let stitch = ReadValues::Int(vec![0, 0, 0, 2, 2, -1, 1, 1]);
        let primvars = [
            ("braid", ReadValues::Int(vec![5, 5, 5, 5, 5, 5, 0, 6])),
            ("stitch", stitch),
            ("fed", ReadValues::Int(vec![0, 0, 0, 0, 1, 0, 0, 0])),
        ];
        let read = read_of(&[hair; 8], &primvars);
        let joined = measure(&MeasuredHair::read(&read, &PlainHost)).unwrap();
        assert_eq!((joined.grown, joined.fed, joined.unjoined), (5, 1, 1));
        assert_eq!((joined.stitches, joined.empty_stitches, joined.a_stitch), (3, 1, [1, 1, 3]));
    }
}
