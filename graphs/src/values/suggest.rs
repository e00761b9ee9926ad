//! "Did you mean": the known word that is nearest to what was written.

/// The word of `known` that needs the fewest single-letter changes (insert, delete, replace, swap
/// of neighbours), when that is few enough to be a slip: one, or a third of the word's letters.
pub(crate) fn nearest<'a>(word: &str, known: impl Iterator<Item = &'a str>) -> Option<&'a str> {
    let few = (word.chars().count() / 3).max(1);
    known
        .map(|candidate| (distance(word, candidate, few), candidate))
        .filter(|(d, _)| *d <= few)
        .min()
        .map(|(_, candidate)| candidate)
}

/// Optimal string alignment distance; anything over `most` may be given as `most + 1`.
fn distance(a: &str, b: &str, most: usize) -> usize {
    let (a, b): (Vec<char>, Vec<char>) = (a.chars().collect(), b.chars().collect());
    if a.len().abs_diff(b.len()) > most {
        return most + 1;
    }
    let mut before: Vec<usize> = vec![];
    let mut last: Vec<usize> = (0..=b.len()).collect();
    for i in 1..=a.len() {
        let mut row = vec![i];
        for j in 1..=b.len() {
            let replaced = last[j - 1] + usize::from(a[i - 1] != b[j - 1]);
            let mut best = replaced.min(last[j] + 1).min(row[j - 1] + 1);
            if i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1] {
                best = best.min(before[j - 2] + 1);
            }
            row.push(best);
        }
        before = std::mem::replace(&mut last, row);
    }
    last[b.len()]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slips_are_found_and_other_words_are_not() {
        let known = ["count", "curves", "spacing", "by"];
        let near = |word: &str| nearest(word, known.into_iter());
        for (word, meant) in [
            ("cuont", Some("count")),
            ("Count", Some("count")),
            ("curve", Some("curves")),
            ("spcing", Some("spacing")),
            ("colour", None),
            ("", None),
            ("x", None),
            ("bi", Some("by")),
        ] {
            assert_eq!(near(word), meant, "{word}");
        }
        assert_eq!(distance("abcdef", "badcfe", 9), 3);
    }
}
