//! The ledger of an evaluation: what each node cost, as a table for people, from the report alone.
//!
//! Guarantees: rows stand slowest first, each group with the sum of what is in it before its nodes; the last row is the sum of all
//! nodes. Bytes that nodes share count where they were made. Not guaranteed: that times add up to the wall time, for nodes run
//! at once.

use crate::jobs::report::Node;
use std::collections::BTreeMap;
use std::fmt::Write as _;

/// Sums over nodes.
#[derive(Clone, Copy, Default)]
struct Cost {
    ms: f64,
    points: usize,
    curves: usize,
    bytes: usize,
    run: u64,
    reused: u64,
}

impl Cost {
    fn of(node: &Node) -> Self {
        Self {
            ms: node.ms,
            points: node.points,
            curves: node.curves,
            bytes: node.bytes,
            run: node.tufts_run.into(),
            reused: node.tufts_reused.into(),
        }
    }

    fn add(&mut self, other: &Self) {
        self.ms += other.ms;
        self.points += other.points;
        self.curves += other.curves;
        self.bytes += other.bytes;
        self.run += other.run;
        self.reused += other.reused;
    }
}

/// A node, or a group with the sum of what is in it.
struct Row {
    cost: Cost,
    is_known: bool,
    inner: BTreeMap<String, Row>,
}

/// What the first column says of itself.
const ORDER: &str = "slowest first";

/// The table, with a line for its columns.
pub(super) fn table(nodes: &[Node]) -> String {
    let mut all = Row { cost: Cost::default(), is_known: false, inner: BTreeMap::new() };
    for node in nodes {
        put(&mut all, node);
    }
    let mut lines = vec![];
    lines_of("", &all, &mut lines);
    lines.push(("all nodes".to_owned(), all.cost, false));
    let names = lines.iter().map(|(name, ..)| name.as_str()).chain([ORDER]);
    let width = names.map(|name| name.chars().count()).max().unwrap_or(0);
    let mut text = format!(
        "{:width$} {:>10} {:>6} {:>10} {:>9} {:>9} {:>10} {:>10}\n",
        ORDER, "ms", "%", "points", "curves", "MiB", "pieces run", "reused"
    );
    for (name, cost, is_known) in lines {
        let Cost { ms, points, curves, bytes, run, reused } = cost;
        let (percent, mib) =
            (100.0 * ms / all.cost.ms.max(1e-9), bytes as f64 / f64::from(1 << 20));
        let known = if is_known { "  all known" } else { "" };
        let _ = writeln!(
            text,
            "{name:width$} {ms:>10.1} {percent:>6.1} {points:>10} {curves:>9} {mib:>9.2} {run:>10} {reused:>10}{known}"
        );
    }
    text
}

/// Adds a node to all groups that it is in.
fn put(all: &mut Row, node: &Node) {
    let cost = Cost::of(node);
    let mut at = all;
    at.cost.add(&cost);
    for word in node.name.split('/') {
        let new = || Row { cost: Cost::default(), is_known: node.cached, inner: BTreeMap::new() };
        at = at.inner.entry(word.to_owned()).or_insert_with(new);
        at.cost.add(&cost);
        at.is_known &= node.cached;
    }
}

fn lines_of(path: &str, row: &Row, lines: &mut Vec<(String, Cost, bool)>) {
    let mut inner: Vec<(&String, &Row)> = row.inner.iter().collect();
    inner.sort_by(|(_, a), (_, b)| b.cost.ms.total_cmp(&a.cost.ms));
    for (word, row) in inner {
        let name = if path.is_empty() { word.clone() } else { format!("{path}/{word}") };
        lines.push((name.clone(), row.cost, row.is_known));
        lines_of(&name, row, lines);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn node(name: &str, ms: f64, points: usize, cached: bool) -> Node {
        Node {
            name: name.to_owned(),
            kind: "resample",
            ms,
            cached,
            tufts_run: 2,
            tufts_reused: 1,
            curves: points / 10,
            points,
            bytes: points << 10,
            messages: vec![],
            gestures: vec![],
        }
    }

    #[test]
    fn groups_have_the_sum_of_what_is_in_them_and_all_nodes_that_of_all() {
        let nodes = [
            node("head", 1.0, 0, true),
            node("row/pen", 2.0, 100, false),
            node("row/in/braid", 4.0, 1000, true),
            node("row/in/hair", 8.0, 9000, true),
            node("out", 9.5, 9000, false),
        ];
        let want = "
            slowest first         ms      %     points    curves       MiB pieces run     reused
            row                 14.0   57.1      10100      1010      9.86          6          3
            row/in              12.0   49.0      10000      1000      9.77          4          2  all known
            row/in/hair          8.0   32.7       9000       900      8.79          2          1  all known
            row/in/braid         4.0   16.3       1000       100      0.98          2          1  all known
            row/pen              2.0    8.2        100        10      0.10          2          1
            out                  9.5   38.8       9000       900      8.79          2          1
            head                 1.0    4.1          0         0      0.00          2          1  all known
            all nodes           24.5  100.0      19100      1910     18.65         10          5
        ";
        let lines = want.lines().map(|line| line.trim_start().to_owned());
        let want: Vec<String> = lines.filter(|line| !line.is_empty()).collect();
        assert_eq!(table(&nodes).lines().collect::<Vec<_>>(), want);
    }
}
