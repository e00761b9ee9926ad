//! What a groom may take: seconds, points and memory, each where somebody set a limit.
//!
//! **Invariant:** every limit is finite and over 0, and so many points are a whole number. Nothing that is evaluated, no key and no
//! hash knows of it; [`crate::schedule::budget`] says what was used and who used it.

use std::fmt;

/// What is limited.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Term {
    /// Wall time of an evaluation.
    Seconds,
    /// Points of all outputs together, and of any node on the way.
    Points,
    /// MiB that the values of all nodes hold.
    Mib,
}

impl Term {
    /// All of them, in the order of files.
    pub const ALL: [Self; 3] = [Self::Seconds, Self::Points, Self::Mib];

    /// Its name in files.
    pub fn word(self) -> &'static str {
        match self {
            Term::Seconds => "seconds",
            Term::Points => "points",
            Term::Mib => "mib",
        }
    }

    /// So much of it, for a person.
    pub fn amount(self, x: f64) -> String {
        match self {
            Term::Seconds => format!("{} s", rounded(x)),
            Term::Points if x >= 1e6 => format!("{} million", rounded(x / 1e6)),
            Term::Points => format!("{x}"),
            Term::Mib => format!("{} MiB", rounded(x)),
        }
    }
}

impl fmt::Display for Term {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.word())
    }
}

/// Three digits tell budgets apart, and fewer where there are no more.
fn rounded(x: f64) -> f64 {
    let digits = if x >= 100.0 { 1.0 } else { 1000.0 };
    let rounded = (x * digits).round() / digits;
    if rounded > 0.0 { rounded } else { x }
}

/// Limits; a term without one is not limited.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Budget([Option<f64>; 3]);

// No limit is NaN.
impl Eq for Budget {}

/// Whole numbers up to here are exact.
const MOST_POINTS: f64 = (1u64 << 53) as f64;

impl Budget {
    /// The limit of a term.
    pub fn limit(&self, term: Term) -> Option<f64> {
        self.0[term as usize]
    }

    /// Every term that is limited.
    pub fn limits(&self) -> impl Iterator<Item = (Term, f64)> {
        Term::ALL.into_iter().zip(self.0).filter_map(|(term, limit)| Some((term, limit?)))
    }

    /// Whether nothing is limited.
    pub fn is_empty(&self) -> bool {
        self.0 == [None; 3]
    }

    /// Limits a term, or lets it free.
    ///
    /// # Errors
    /// The limit is none: 0, below it, no finite number, or a part of a point.
    pub fn set(&mut self, term: Term, limit: Option<f64>) -> Result<(), String> {
        if let Some(x) = limit {
            if !(x.is_finite() && x > 0.0) {
                return Err(format!(
                    "{term}: {x:?} is no limit: give a finite number over 0, or leave {term} out"
                ));
            }
            if term == Term::Points && (x.fract() != 0.0 || x > MOST_POINTS) {
                return Err(format!("{term}: {x:?} is no whole number of points"));
            }
        }
        self.0[term as usize] = limit;
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn limits_are_finite_numbers_over_zero_and_points_are_whole() {
        for term in Term::ALL {
            for bad in [0.0, -0.0, -1.5, f64::NAN, f64::INFINITY] {
                let mut budget = Budget::default();
                let said = budget.set(term, Some(bad)).unwrap_err();
                assert!(said.contains(&format!("{term}: {bad:?}")), "{said}");
                assert!(budget.is_empty());
            }
            let mut budget = Budget::default();
            assert_eq!(budget.set(term, Some(2.5)).is_ok(), term != Term::Points);
            assert_eq!(budget.set(term, Some(4e6)), Ok(()));
            assert_eq!(budget.limits().collect::<Vec<_>>(), [(term, 4e6)]);
            assert_eq!(budget.set(term, None), Ok(()));
            assert!(budget.is_empty());
        }
    }

    #[test]
    fn amounts_are_said_as_people_say_them() {
        let said = [
            (Term::Points, 5e6, "5 million"),
            (Term::Points, 4_123_456.0, "4.123 million"),
            (Term::Points, 999.0, "999"),
            (Term::Seconds, 0.5, "0.5 s"),
            (Term::Seconds, 0.000_01, "0.00001 s"),
            (Term::Mib, 900.04, "900 MiB"),
        ];
        for (term, x, want) in said {
            assert_eq!(term.amount(x), want);
        }
    }
}
