//! The spreadsheet: numbers of tufts, curves and points, of what is displayed, of the selected node, or of what was pinned.
//!
//! Guarantees: a frame costs what its visible cells cost, whatever the number of rows; sorting, filtering and statistics of
//! large tables are done beside the window, and the newest wish alone is answered. Selecting rows selects their curves,
//! and the other way round.

mod filter;
mod grid;
mod order;
mod table;
#[cfg(test)]
mod tests;

use crate::core::event::Event;
use crate::core::notes::Note;
use crate::core::shown::{Shown, first_output};
use crate::core::state::State;
use crate::widgets::panel;
use crate::widgets::theme;
use crate::words::grouped;
use coif_nodes::data::curves::Curves;
use egui::{ScrollArea, TextEdit, Ui};
use order::{Orders, RowOrder, RowQuery};
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;
use table::{Column, Domain, Table};

/// The most rows that are copied at once.
const MOST_COPIED: usize = 100_000;

/// Which curves are shown.
#[derive(Clone, Debug, Default)]
enum Follow {
    /// What the viewport shows.
    #[default]
    Displayed,
    /// The first output of the active node.
    Active,
    /// These, with what they are called, until unpinned.
    Pinned(String, Curves),
}

/// What the spreadsheet remembers between frames.
#[derive(Default)]
pub(crate) struct Spreadsheet {
    follow: Follow,
    domain: Domain,
    table: Option<Arc<Table>>,
    /// Columns that differ from what is shown at first.
    chosen: BTreeMap<String, bool>,
    sort: Option<(String, bool)>,
    filter: String,
    only_selected: bool,
    statistics: bool,
    orders: Orders,
    answer: Option<Arc<RowOrder>>,
    /// The first visible row, with its fraction.
    top: f64,
    /// The row that keys move from.
    cursor: Option<usize>,
}

impl Spreadsheet {
    /// Shows the table and says what is selected in it.
    pub(crate) fn ui(&mut self, state: &State, ui: &mut Ui, out: &mut Vec<Event>) {
        self.look(state);
        let wish = self.wish(state);
        if let Some(answer) = self.orders.answer(ui.ctx(), &self.table, wish) {
            self.answer = Some(answer);
        }
        self.bar(state, ui, out);
        let Some(table) = self.table.clone() else {
            ui.weak("No curves: display a node that makes some.");
            return;
        };
        let columns: Vec<&Column> =
            table.columns().iter().filter(|column| self.is_shown(column)).collect();
        self.grid(state, ui, &table, &columns, out);
    }

    /// The curves to show now, and the nodes that they come from, each with the number of its tufts.
    fn source(&self, state: &State) -> Option<(Curves, Vec<(usize, String)>)> {
        if let Follow::Pinned(_, curves) = &self.follow {
            return Some((curves.clone(), vec![]));
        }
        let shown: &Shown = state.shown.as_deref()?;
        match &self.follow {
            Follow::Active => {
                let socket = first_output(&state.document, state.active()?)?;
                Some((shown.curves_of(&socket)?.clone(), vec![]))
            }
            _ => {
                let part = |socket| {
                    let tufts = shown.curves_of(socket).map_or(0, |curves| curves.tufts().len());
                    (tufts, state.document.name_of(&socket.node).into_owned())
                };
                let parts: Vec<_> = shown.sockets.iter().map(part).collect();
                let all: usize = parts.iter().map(|(tufts, _)| tufts).sum();
                let whole = all == shown.curves.tufts().len();
                Some((shown.curves.clone(), if whole { parts } else { vec![] }))
            }
        }
    }

    /// Makes the table anew where the curves are others.
    fn look(&mut self, state: &State) {
        let Some((curves, parts)) = self.source(state) else {
            self.table = None;
            return;
        };
        let same = self.table.as_ref().is_some_and(|table| {
            table.curves().key() == curves.key() && table.domain() == self.domain
        });
        if !same {
            self.table = Some(Arc::new(Table::new(curves, self.domain, &parts)));
        }
    }

    fn is_shown(&self, column: &Column) -> bool {
        self.chosen.get(&column.name).copied().unwrap_or(column.at_first)
    }

    /// What is wanted of the order of rows.
    fn wish(&self, state: &State) -> RowQuery {
        RowQuery {
            sort: self.sort.clone(),
            filter: self.filter.trim().to_owned(),
            only: self.only_selected.then(|| state.selection.curves.clone()),
            statistics: self.statistics,
        }
    }

    /// The row of the table that stands at a place of the order.
    fn row_at(&self, place: usize) -> usize {
        let rows = self.answer.as_ref().and_then(|answer| answer.rows.as_ref());
        rows.map_or(place, |rows| rows.get(place).map_or(usize::MAX, |row| *row as usize))
    }

    /// How many rows the order has.
    fn places(&self, table: &Table) -> usize {
        let rows = self.answer.as_ref().and_then(|answer| answer.rows.as_ref());
        rows.map_or_else(|| table.rows(), |rows| rows.len())
    }

    fn bar(&mut self, state: &State, ui: &mut Ui, out: &mut Vec<Event>) {
        ui.horizontal_wrapped(|ui| {
            for (domain, label, tip) in [
                (Domain::Curve, "Curves", "One row per curve."),
                (Domain::Point, "Points", "One row per CV."),
                (Domain::Tuft, "Tufts", "One row per tuft: curves made from one parent."),
            ] {
                let chosen = ui.selectable_label(self.domain == domain, label).on_hover_text(tip);
                if chosen.clicked() && self.domain != domain {
                    self.domain = domain;
                    (self.top, self.cursor, self.answer) = (0.0, None, None);
                    self.look(state);
                }
            }
            ui.separator();
            self.follow_menu(state, ui);
            let edit = TextEdit::singleline(&mut self.filter)
                .hint_text("length < 2 and radius > 0.5")
                .min_size(ui.spacing().interact_size)
                .vertical_align(egui::Align::Center)
                .desired_width(220.0);
            let edit = ui.add(edit);
            crate::widgets::text::set_name(ui, &edit, "Filter rows");
            if edit.changed() {
                self.top = 0.0;
            }
            edit.on_hover_text(
                "Show only rows that match. Names are columns; < <= > >= == != and or not + - * / % and brackets work.",
            );
            let only = ui.toggle_value(&mut self.only_selected, "Selected");
            only.on_hover_text("Show only rows of selected curves.");
            let jump = ui.add_enabled(!state.selection.curves.is_empty(), egui::Button::new("Go to"));
            if jump.on_hover_text("Scroll to the first selected curve.").clicked() {
                self.go_to_selected(state);
            }
            ui.menu_button("Columns", |ui| panel::list(ui, |ui| self.columns_menu(ui)))
                .response
                .on_hover_text("Choose the columns to show.");
            ui.toggle_value(&mut self.statistics, "Statistics")
                .on_hover_text("Minimum, maximum and mean of each column, and how many values are not numbers.");
            if ui.button("Copy").on_hover_text("Copy the selected rows, or all, as CSV.").clicked() {
                self.copy(state, ui, out);
            }
            self.counts(ui);
        });
    }

    fn counts(&self, ui: &mut Ui) {
        let Some(table) = &self.table else { return };
        if let Some(why) = self.answer.as_ref().and_then(|answer| answer.error.as_ref()) {
            ui.colored_label(theme::WARNING.of(ui), format!("⚠ {why}"));
            return;
        }
        let (places, all) = (self.places(table), table.rows());
        ui.weak(match places == all {
            true => format!("{} rows", grouped(all)),
            false => format!("{} of {} rows", grouped(places), grouped(all)),
        });
        if self.orders.is_working() {
            ui.spinner();
        }
    }

    fn follow_menu(&mut self, state: &State, ui: &mut Ui) {
        let label = match &self.follow {
            Follow::Displayed => "Displayed".to_owned(),
            Follow::Active => "Selected node".to_owned(),
            Follow::Pinned(name, _) => format!("Pinned: {name}"),
        };
        let combo = egui::ComboBox::from_id_salt("follow").selected_text(label).show_ui(ui, |ui| {
            let displayed = matches!(self.follow, Follow::Displayed);
            if ui.selectable_label(displayed, "Displayed").clicked() {
                self.follow = Follow::Displayed;
            }
            let active = matches!(self.follow, Follow::Active);
            if ui.selectable_label(active, "Selected node").clicked() {
                self.follow = Follow::Active;
            }
            let pin = ui.selectable_label(matches!(self.follow, Follow::Pinned(..)), "Pin these");
            let pin = pin.on_hover_text("Freeze these numbers, whatever is displayed or changed.");
            if pin.clicked()
                && let Some(table) = &self.table
            {
                let named = state.document.display.as_ref().or(state.active());
                let name = named.map(|id| state.document.name_of(id).into_owned());
                let name = name.unwrap_or_else(|| "curves".to_owned());
                self.follow = Follow::Pinned(name, table.curves().clone());
            }
        });
        crate::widgets::text::set_name(ui, &combo.response, "What the spreadsheet shows");
    }

    fn columns_menu(&mut self, ui: &mut Ui) {
        let Some(table) = self.table.clone() else { return };
        ScrollArea::vertical().max_height(400.0).show(ui, |ui| {
            for column in table.columns() {
                let mut on = self.is_shown(column);
                let check = ui.checkbox(&mut on, &column.name).on_hover_text(column.doc);
                if check.changed() {
                    self.chosen.insert(column.name.clone(), on);
                }
            }
        });
    }

    fn go_to_selected(&mut self, state: &State) {
        let Some(table) = &self.table else { return };
        let rows: BTreeSet<u32> = table.of_curves(&state.selection.curves).into_iter().collect();
        let place = match self.answer.as_ref().and_then(|answer| answer.rows.as_ref()) {
            Some(order) => order.iter().position(|row| rows.contains(row)),
            None => rows.first().map(|row| *row as usize),
        };
        if let Some(place) = place {
            self.top = place.saturating_sub(2) as f64;
            self.cursor = Some(place);
        }
    }

    fn copy(&self, state: &State, ui: &Ui, out: &mut Vec<Event>) {
        let Some(table) = &self.table else { return };
        let columns: Vec<&Column> =
            table.columns().iter().filter(|column| self.is_shown(column)).collect();
        let selected = &state.selection.curves;
        let picked = table.of_curves(selected).into_iter().collect::<BTreeSet<u32>>();
        let places = 0..self.places(table);
        let rows = places.map(|place| self.row_at(place));
        let rows = rows.filter(|row| picked.is_empty() || picked.contains(&(*row as u32)));
        let rows: Vec<usize> = rows.take(MOST_COPIED).collect();
        ui.ctx().copy_text(csv(table, &columns, &rows));
        let count = grouped(rows.len());
        let most = if rows.len() == MOST_COPIED { ", the most that is copied" } else { "" };
        out.push(Event::Say(Note::done(format!("Copied {count} rows as CSV{most}"))));
    }
}

/// Rows as CSV, with a line of names.
fn csv(table: &Table, columns: &[&Column], rows: &[usize]) -> String {
    let quoted = |text: &str| match text.contains([',', '"', '\n']) {
        true => format!("\"{}\"", text.replace('"', "\"\"")),
        false => text.to_owned(),
    };
    let mut text = String::new();
    let line = |cells: Vec<String>, text: &mut String| {
        text.push_str(&cells.join(","));
        text.push('\n');
    };
    line(columns.iter().map(|column| quoted(&column.name)).collect(), &mut text);
    for row in rows {
        let cells = columns.iter().map(|column| quoted(&table.cell(*row, column).text()));
        line(cells.collect(), &mut text);
    }
    text
}
