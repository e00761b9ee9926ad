//! Lists of samples and points in columns of whole steps of a grid: the first one, then each one's
//! distance from the one before: small numbers are short.

use std::fmt::Write as _;

/// Samples on one line: a changed sample changes one or two short lines in each column.
const A_LINE: usize = 12;
/// More steps than any place, pressure or time has; sums of them stay exact.
const MOST_STEPS: i64 = 1 << 32;

/// The columns of one kind of list.
pub(super) struct Columns<const N: usize> {
    pub(super) names: [&'static str; N],
    /// The number of the first column that is left out, with those behind it, where all say nothing.
    pub(super) optional: usize,
    /// What stands in a row.
    pub(super) row: &'static str,
}

impl<const N: usize> Columns<N> {
    /// Rows from columns as files have them.
    pub(super) fn rows(&self, columns: [Vec<i64>; N]) -> Result<Vec<[i64; N]>, String> {
        let Self { names, optional, row } = self;
        let count = columns[0].len();
        let is_short = |(i, column): (usize, &Vec<i64>)| {
            column.len() != count && (i < *optional || !column.is_empty())
        };
        if let Some(i) = columns.iter().enumerate().position(is_short) {
            let (name, found, first) = (names[i], columns[i].len(), names[0]);
            return Err(format!("{name} has {found} {row}s, {first} has {count}"));
        }
        let mut at = [0i64; N];
        let mut rows = Vec::with_capacity(count);
        for i in 0..count {
            for (sum, column) in at.iter_mut().zip(&columns) {
                *sum = sum.saturating_add(column.get(i).copied().unwrap_or_default());
                if sum.abs() > MOST_STEPS {
                    return Err(format!("{row} {i} is not on earth"));
                }
            }
            rows.push(at);
        }
        Ok(rows)
    }

    /// Writes rows in columns. Where there are lines, their numbers begin them: indentation would be a
    /// fifth of the file.
    pub(super) fn write(&self, out: &mut String, rows: &[[i64; N]], lines: bool) {
        let says_nothing = rows.iter().all(|row| row[self.optional..].iter().all(|x| *x == 0));
        let count = if says_nothing { self.optional } else { N };
        for (c, name) in self.names.iter().enumerate().take(count) {
            let _ = write!(out, "{}{name}: [", if c > 0 { ", " } else { "" });
            let mut last = 0;
            let steps = rows.iter().map(|row| {
                let step = row[c] - last;
                last = row[c];
                step
            });
            numbers(out, steps, A_LINE, lines);
        }
    }
}

/// Writes the numbers of a list and its end, so many on a line.
pub(super) fn numbers<T: std::fmt::Display>(
    out: &mut String,
    numbers: impl Iterator<Item = T>,
    a_line: usize,
    lines: bool,
) {
    for (i, number) in numbers.enumerate() {
        out.push_str(if i > 0 { "," } else { "" });
        if lines && i % a_line == 0 {
            out.push('\n');
        }
        let _ = write!(out, "{number}");
    }
    out.push_str(if lines { "\n]" } else { "]" });
}
