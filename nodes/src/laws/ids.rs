//! Ids, which no two curves share.

use super::hair::MeasuredHair;

/// Curves whose id another curve of the same hair has too; none where there are no ids.
pub fn repeated(hair: &MeasuredHair) -> Option<usize> {
    let mut ids = hair.whole("id")?;
    ids.sort_unstable();
    Some(ids.windows(2).filter(|w| w[0] == w[1]).count())
}

/// For each hair that has ids, how many of its curves share theirs with a curve of another.
pub fn shared(all: &[MeasuredHair]) -> Vec<Option<usize>> {
    let ids: Vec<Option<Vec<i64>>> = all.iter().map(|hair| hair.whole("id")).collect();
    let of_hair = |(p, ids): (usize, &Option<Vec<i64>>)| {
        ids.iter().flatten().map(|id| (*id, p)).collect::<Vec<_>>()
    };
    let mut all: Vec<(i64, usize)> = ids.iter().enumerate().flat_map(of_hair).collect();
    all.sort_unstable();
    let mut shared: Vec<Option<usize>> = ids.iter().map(|ids| ids.as_ref().map(|_| 0)).collect();
    for same in all.chunk_by(|a, b| a.0 == b.0).filter(|same| same[0].1 != same[same.len() - 1].1) {
        same.iter().for_each(|(_, p)| *shared[*p].get_or_insert(0) += 1);
    }
    shared
}
