//! Which rows are shown in which order, and what their columns hold together: worked out beside the window.
//!
//! Guarantees: small tables are answered at once; of several wishes only the newest is answered, and a newer one stops the
//! work for an older one. Not guaranteed: that what is shown meanwhile is what was wished last.

use super::filter::Filter;
use super::table::{Statistics, Table, sorted, statistics};
use std::collections::{BTreeMap, BTreeSet};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, channel};
use std::sync::{Arc, Weak};

/// Tables of fewer cells to look at are answered within the frame.
const AT_ONCE: usize = 20_000;

/// What is wanted.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct RowQuery {
    /// By which column, and whether the highest comes first.
    pub(super) sort: Option<(String, bool)>,
    /// An expression; empty lets all pass.
    pub(super) filter: String,
    /// Only rows of these curves.
    pub(super) only: Option<BTreeSet<u64>>,
    /// Whether columns are summed up.
    pub(super) statistics: bool,
}

/// What came out.
#[derive(Debug, Default)]
pub(super) struct RowOrder {
    /// The rows in order; none: all, as they are.
    pub(super) rows: Option<Vec<u32>>,
    /// By column; columns without numbers have none.
    pub(super) statistics: BTreeMap<String, Statistics>,
    /// Why the filter could not be used.
    pub(super) error: Option<String>,
}

/// The work under way.
#[derive(Default)]
pub(super) struct Orders {
    asked: Option<(Weak<Table>, RowQuery)>,
    running: Option<(Arc<AtomicBool>, Receiver<RowOrder>)>,
}

impl Orders {
    /// Asks, where something else is wanted than before, and gives a new answer when there is one.
    pub(super) fn answer(
        &mut self,
        ctx: &egui::Context,
        table: &Option<Arc<Table>>,
        wish: RowQuery,
    ) -> Option<Arc<RowOrder>> {
        let table = table.as_ref()?;
        let asked = self
            .asked
            .as_ref()
            .is_some_and(|(of, asked)| of.as_ptr() == Arc::as_ptr(table) && *asked == wish);
        if !asked {
            self.stop();
            self.asked = Some((Arc::downgrade(table), wish.clone()));
            let columns = if wish.statistics { table.columns().len() } else { 1 };
            if table.rows() * columns <= AT_ONCE || wish == RowQuery::default() {
                return Some(Arc::new(work(table, &wish, &|| false)));
            }
            let (stop, (send, receive)) = (Arc::new(AtomicBool::new(false)), channel());
            self.running = Some((stop.clone(), receive));
            let (table, ctx) = (table.clone(), ctx.clone());
            let thread = std::thread::Builder::new().name("spreadsheet".to_owned());
            let spawned = thread.spawn(move || {
                let answer = work(&table, &wish, &|| stop.load(Ordering::Relaxed));
                // Nobody waits any more when something else was wished.
                if send.send(answer).is_ok() {
                    ctx.request_repaint();
                }
            });
            if spawned.is_err() {
                self.running = None;
            }
            return None;
        }
        let (_, receive) = self.running.as_ref()?;
        let answer = receive.try_recv().ok()?;
        self.running = None;
        Some(Arc::new(answer))
    }

    /// Whether something is being worked out.
    pub(super) fn is_working(&self) -> bool {
        self.running.is_some()
    }

    fn stop(&mut self) {
        if let Some((stop, _)) = self.running.take() {
            stop.store(true, Ordering::Relaxed);
        }
    }
}

impl Drop for Orders {
    fn drop(&mut self) {
        self.stop();
    }
}

/// Works a wish out; whatever comes out after `stop` is thrown away.
fn work(table: &Table, wish: &RowQuery, stop: &dyn Fn() -> bool) -> RowOrder {
    let mut answer = RowOrder::default();
    if !wish.filter.is_empty() {
        match Filter::read(&wish.filter).and_then(|filter| table.filtered(&filter, stop)) {
            Ok(rows) => answer.rows = rows,
            Err(why) => answer.error = Some(why),
        }
    }
    if let Some(ids) = &wish.only {
        let of = table.of_curves(ids);
        answer.rows = Some(match answer.rows {
            None => of,
            Some(rows) => {
                let of: BTreeSet<u32> = of.into_iter().collect();
                rows.into_iter().filter(|row| of.contains(row)).collect()
            }
        });
    }
    if let Some((name, descending)) = &wish.sort
        && let Some(column) = table.column(name)
        && let Some(numbers) = table.numbers(column, stop)
        && !stop()
    {
        let rows = answer.rows.take().unwrap_or_else(|| (0..table.rows() as u32).collect());
        answer.rows = Some(sorted(rows, &numbers, *descending));
    }
    if wish.statistics {
        for column in table.columns().iter().filter(|column| !column.ids) {
            let Some(numbers) = table.numbers(column, stop) else { break };
            let found = match &answer.rows {
                Some(rows) => statistics(rows.iter().map(|row| numbers[*row as usize])),
                None => statistics(numbers.into_iter()),
            };
            if let Some(found) = found {
                answer.statistics.insert(column.name.clone(), found);
            }
        }
    }
    answer
}
