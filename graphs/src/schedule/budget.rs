//! What an evaluation used of a groom's budget, and which node used most of it.
//!
//! Guarantees: points and memory are counted, the same for the same values on every machine; seconds are the wall time of the run.
//! What is over a limit is told with the node that has the largest part. Nothing here changes what is evaluated.

use super::result::{NodeReport, Outcome};
use crate::document::budget::{Budget, Term};
use coif_nodes::define::Value;
use std::fmt;

/// What was used of one term.
#[derive(Clone, Debug, PartialEq)]
pub struct Used {
    /// Which.
    pub term: Term,
    /// The most that there may be.
    pub limit: f64,
    /// How much there is.
    pub used: f64,
    /// The node with the largest part; empty where no node ran.
    pub node: String,
    /// Its part of what all nodes used, 0 to 1: of the time; of the points that nodes give more than they are given; of the bytes.
    pub share: f64,
}

impl Used {
    /// Whether it is more than may be.
    pub fn is_over(&self) -> bool {
        self.used > self.limit
    }
}

impl fmt::Display for Used {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { term, limit, used, node, share } = self;
        let (limit, used) = (term.amount(*limit), term.amount(*used));
        write!(f, "budget: {term}: at most {limit}, and it takes {used}; ")?;
        match node.is_empty() {
            true => write!(f, "no node ran"),
            false => write!(f, "its largest part is {node} ({:.0} %)", share * 100.0),
        }
    }
}

/// What an evaluation used of each term that is limited. The first `outputs` of its targets are what the groom gives.
pub fn used(budget: &Budget, outcome: &Outcome, outputs: usize) -> Vec<Used> {
    let given = outcome.targets.iter().take(outputs).flatten().map(|value| match value {
        Value::Curves(curves) => curves.point_count(),
        _ => 0,
    });
    let points = given.sum::<usize>().max(widest(&outcome.nodes));
    let of = |(term, limit)| {
        let part = |node: &NodeReport| match term {
            Term::Seconds => node.ms,
            Term::Points => node.points.saturating_sub(node.points_read) as f64,
            Term::Mib => node.bytes as f64,
        };
        let all: f64 = outcome.nodes.iter().map(part).sum();
        let used = match term {
            Term::Seconds => outcome.ms / 1e3,
            Term::Points => points as f64,
            Term::Mib => all / f64::from(1 << 20),
        };
        // The first of equals.
        let most = outcome.nodes.iter().rev().max_by(|a, b| part(a).total_cmp(&part(b)));
        let share = most.map_or(0.0, |node| if all > 0.0 { part(node) / all } else { 0.0 });
        Used { term, limit, used, node: most.map_or(String::new(), |n| n.name.clone()), share }
    };
    budget.limits().map(of).collect()
}

/// Points of the node that gives most.
fn widest(nodes: &[NodeReport]) -> usize {
    nodes.iter().map(|node| node.points).max().unwrap_or_default()
}

/// The most points that a node can give without breaking the budget, and what of the budget says so. A point takes 12 bytes at
/// least.
pub fn most_points(budget: &Budget) -> Option<(u64, String)> {
    const BYTES: f64 = 12.0;
    let by_mib = budget.limit(Term::Mib).map(|mib| (mib * f64::from(1 << 20) / BYTES, Term::Mib));
    let by_points = budget.limit(Term::Points).map(|points| (points, Term::Points));
    let (most, term) = by_points.into_iter().chain(by_mib).min_by(|a, b| a.0.total_cmp(&b.0))?;
    let limit = term.amount(budget.limit(term).unwrap_or_default());
    Some((most as u64, format!("the groom's budget of {term} is {limit}")))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn outcome() -> Outcome {
        let node = |name: &str, ms, points_read, points, mib: usize| NodeReport {
            name: name.to_owned(),
            ms,
            points_read,
            points,
            bytes: mib << 20,
            ..NodeReport::default()
        };
        // Much hair passes through the last; the second makes it.
        let nodes = vec![
            node("rows", 500.0, 0, 100, 1),
            node("braid/hair", 100.0, 100, 900, 6),
            node("out", 0.0, 900, 900, 0),
        ];
        Outcome { nodes, ms: 700.0, ..Outcome::default() }
    }

    #[test]
    fn what_is_over_is_told_with_the_node_that_has_the_largest_part() {
        let mut budget = Budget::default();
        assert_eq!(used(&budget, &outcome(), 0), []);
        for (term, limit) in [(Term::Seconds, 0.5), (Term::Points, 899.0), (Term::Mib, 7.0)] {
            budget.set(term, Some(limit)).unwrap();
        }
        let said: Vec<String> = used(&budget, &outcome(), 0)
            .iter()
            .map(|used| format!("{} {used}", used.is_over()))
            .collect();
        assert_eq!(
            said,
            [
                "true budget: seconds: at most 0.5 s, and it takes 0.7 s; its largest part is rows (83 %)",
                "true budget: points: at most 899, and it takes 900; its largest part is braid/hair (89 %)",
                "false budget: mib: at most 7 MiB, and it takes 7 MiB; its largest part is braid/hair (86 %)",
            ]
        );
    }

    #[test]
    fn what_a_node_may_make_hangs_from_the_narrower_term() {
        let mut budget = Budget::default();
        assert_eq!(most_points(&budget), None);
        budget.set(Term::Mib, Some(12.0)).unwrap();
        let (most, said) = most_points(&budget).unwrap();
        assert_eq!((most, &*said), (1 << 20, "the groom's budget of mib is 12 MiB"));
        budget.set(Term::Points, Some(5000.0)).unwrap();
        assert_eq!(most_points(&budget).unwrap().0, 5000);
    }
}
