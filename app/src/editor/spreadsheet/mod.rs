//! The spreadsheet: numbers of tufts, curves and points, of what is displayed, of the selected node, or of what was pinned.
//!
//! Guarantees: a frame costs what its visible cells cost, whatever the number of rows; sorting, filtering and statistics of
//! large tables are done beside the window, and the newest wish alone is answered. Selecting rows selects their curves,
//! and the other way round.

mod filter;
mod order;
mod table;
#[cfg(test)]
mod tests;

use super::evaluation::{Shown, first_output};
use super::event::Event;
use super::notes::Note;
use super::outliner::grouped;
use super::state::{Select, State};
use super::theme;
use coif_nodes::data::curves::Curves;
use egui::{
    Align2, EventFilter, Key, Modifiers, Rect, Response, ScrollArea, Sense, Stroke, TextEdit,
    TextStyle, Ui, WidgetInfo, WidgetType, pos2, vec2,
};
use order::{Answer, Orders, Wish};
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;
use table::{Column, Domain, Table};

const COLUMN: f32 = 92.0;
const BAR: f32 = 12.0;
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
    answer: Option<Arc<Answer>>,
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
                    (tufts, state.document.name_of(&socket.node).to_owned())
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
    fn wish(&self, state: &State) -> Wish {
        Wish {
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
                (Domain::Curve, "Curves", "One row a curve."),
                (Domain::Point, "Points", "One row a point."),
                (Domain::Tuft, "Tufts", "One row a tuft: curves made from one parent."),
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
            crate::inspector::text::set_name(ui, &edit, "Filter rows");
            if edit.changed() {
                self.top = 0.0;
            }
            edit.on_hover_text(
                "Shows rows for which this holds. Words are columns; < <= > >= == != and, or, not, + - * / % and \
                 brackets work.",
            );
            let only = ui.toggle_value(&mut self.only_selected, "Selected");
            only.on_hover_text("Shows the rows of selected curves only.");
            let jump = ui.add_enabled(!state.selection.curves.is_empty(), egui::Button::new("Go to"));
            if jump.on_hover_text("Scrolls to the first selected curve.").clicked() {
                self.go_to_selected(state);
            }
            ui.menu_button("Columns", |ui| self.columns_menu(ui))
                .response
                .on_hover_text("Which columns are shown.");
            ui.toggle_value(&mut self.statistics, "Statistics")
                .on_hover_text("Lowest, highest and mean of each column, and how many are no number.");
            if ui.button("Copy").on_hover_text("Copies selected rows (or all) as CSV.").clicked() {
                self.copy(state, ui, out);
            }
            self.counts(ui);
        });
    }

    fn counts(&self, ui: &mut Ui) {
        let Some(table) = &self.table else { return };
        if let Some(why) = self.answer.as_ref().and_then(|answer| answer.error.as_ref()) {
            ui.colored_label(theme::WARNING, format!("⚠ {why}"));
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
            let pin = pin.on_hover_text("Keeps these numbers, whatever is displayed or changed.");
            if pin.clicked()
                && let Some(table) = &self.table
            {
                let named = state.document.display.as_ref().or(state.active());
                let name = named.map_or("curves", |id| state.document.name_of(id));
                self.follow = Follow::Pinned(name.to_owned(), table.curves().clone());
            }
        });
        crate::inspector::text::set_name(ui, &combo.response, "What the spreadsheet shows");
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

    fn grid(
        &mut self,
        state: &State,
        ui: &mut Ui,
        table: &Table,
        columns: &[&Column],
        out: &mut Vec<Event>,
    ) {
        let height = ui.spacing().interact_size.y.max(18.0) - 4.0;
        let area = ui.available_rect_before_wrap();
        let places = self.places(table);
        let width = COLUMN * columns.len() as f32;
        let bar = Rect::from_min_max(pos2(area.right() - BAR, area.top() + height), area.max);
        let left = Rect::from_min_max(area.min, pos2(bar.left() - 2.0, area.bottom()));
        let mut inner = ui.new_child(egui::UiBuilder::new().max_rect(left));
        ScrollArea::horizontal().id_salt("columns").auto_shrink(false).show(&mut inner, |ui| {
            let view = ui.clip_rect().intersect(left);
            let (rect, _) = ui
                .allocate_exact_size(vec2(width.max(left.width()), left.height()), Sense::hover());
            let visible = visible_columns(view, rect, columns.len());
            let mut from = rect.top();
            self.heads(ui, rect, columns, visible.clone(), height);
            from += height;
            if self.statistics {
                from += self.statistics_rows(ui, rect, columns, visible.clone(), from, height);
            }
            let body = Rect::from_min_max(pos2(rect.left(), from), rect.max);
            let response = ui.interact(body, ui.id().with("rows"), Sense::click());
            let rows = (body.height() / height).max(1.0);
            self.scroll(ui, &response, places, rows);
            self.keys(ui, table, &response, places, rows as usize, out);
            self.clicks(state, ui, table, (&response, body, height), places, out);
            let font = TextStyle::Monospace.resolve(ui.style());
            let painter = ui.painter_at(body.intersect(view));
            let first = self.top as usize;
            for place in first..places.min(first + rows as usize + 2) {
                let row = self.row_at(place);
                let y = body.top() + ((place as f64 - self.top) * f64::from(height)) as f32;
                let line = Rect::from_min_size(pos2(view.left(), y), vec2(view.width(), height));
                let selected = state.selection.curves.len() < 1_000_000
                    && !state.selection.curves.is_empty()
                    && table.ids(row).iter().any(|id| state.selection.curves.contains(id));
                if selected {
                    painter.rect_filled(line, 0.0, theme::SELECTED);
                } else if place % 2 == 1 {
                    painter.rect_filled(line, 0.0, egui::Color32::from_gray(38));
                }
                if self.cursor == Some(place) && response.has_focus() {
                    let stroke = Stroke::new(1.0, theme::ACCENT);
                    painter.rect_stroke(line, 0.0, stroke, egui::StrokeKind::Inside);
                }
                for c in visible.clone() {
                    let right = rect.left() + COLUMN * (c + 1) as f32 - 8.0;
                    let text = table.cell(row, columns[c]).text();
                    let cell = Rect::from_min_max(
                        pos2(right - COLUMN + 12.0, y),
                        pos2(right + 4.0, y + height),
                    );
                    let at = pos2(right, y + height / 2.0);
                    let clipped = painter.with_clip_rect(cell.intersect(painter.clip_rect()));
                    clipped.text(at, Align2::RIGHT_CENTER, text, font.clone(), theme::TEXT);
                }
            }
            let name = "Rows of the spreadsheet";
            response.widget_info(|| WidgetInfo::labeled(WidgetType::Other, true, name));
        });
        self.scroll_bar(ui, bar, places, (left.height() - height) / height);
        ui.advance_cursor_after_rect(area);
    }

    fn heads(
        &mut self,
        ui: &mut Ui,
        rect: Rect,
        columns: &[&Column],
        visible: std::ops::Range<usize>,
        height: f32,
    ) {
        for c in visible {
            let column = columns[c];
            let min = pos2(rect.left() + COLUMN * c as f32, rect.top());
            let head = Rect::from_min_size(min, vec2(COLUMN, height));
            let response = ui.interact(head, ui.id().with(("head", c)), Sense::click());
            let sorted = self.sort.as_ref().filter(|(name, _)| *name == column.name);
            let sign = match sorted {
                Some((_, false)) => " ⏶",
                Some((_, true)) => " ⏷",
                None => "",
            };
            let visuals = ui.style().interact(&response);
            let painter = ui.painter_at(head.shrink2(vec2(1.0, 0.0)));
            painter.rect_filled(head, 0.0, visuals.weak_bg_fill);
            let colour = if sorted.is_some() { theme::ACCENT } else { theme::TEXT };
            let font = TextStyle::Body.resolve(ui.style());
            let text = format!("{}{sign}", column.name);
            let at = head.right_center() - vec2(8.0, 0.0);
            painter.text(at, Align2::RIGHT_CENTER, text, font, colour);
            let name = format!("Sort by {}", column.name);
            response.widget_info(|| WidgetInfo::labeled(WidgetType::Button, true, &name));
            if response.clicked() {
                // Up, down, as it was.
                self.sort = match sorted {
                    None => Some((column.name.clone(), false)),
                    Some((_, false)) => Some((column.name.clone(), true)),
                    Some((_, true)) => None,
                };
            }
            response.on_hover_text(format!("{}: {}\nClick to sort.", column.name, column.doc));
        }
    }

    /// The rows of lowest, highest, mean and NaN; gives how high they are.
    fn statistics_rows(
        &self,
        ui: &Ui,
        rect: Rect,
        columns: &[&Column],
        visible: std::ops::Range<usize>,
        from: f32,
        height: f32,
    ) -> f32 {
        let painter = ui.painter();
        let font = TextStyle::Monospace.resolve(ui.style());
        for c in visible {
            let found = self.answer.as_ref().and_then(|a| a.statistics.get(&columns[c].name));
            let Some(found) = found else { continue };
            let right = rect.left() + COLUMN * (c + 1) as f32 - 8.0;
            let plain = |x: f64| crate::inspector::number::plain(x, 5);
            for (i, text) in [
                format!("min {}", plain(found.min)),
                format!("max {}", plain(found.max)),
                format!("mean {}", plain(found.mean)),
                format!("NaN {}", grouped(found.nans)),
            ]
            .into_iter()
            .enumerate()
            {
                let at = pos2(right, from + height * (i as f32 + 0.5));
                painter.text(at, Align2::RIGHT_CENTER, text, font.clone(), theme::QUIET);
            }
        }
        let bottom = from + height * 4.0;
        painter.hline(rect.x_range(), bottom, Stroke::new(1.0, theme::LINE));
        height * 4.0
    }

    fn scroll(&mut self, ui: &Ui, response: &Response, places: usize, rows: f32) {
        if response.contains_pointer() {
            let (delta, height) = ui.input(|input| {
                (input.smooth_scroll_delta().y, ui.spacing().interact_size.y.max(18.0) - 4.0)
            });
            self.top -= f64::from(delta / height);
        }
        let most = (places as f64 - f64::from(rows.floor())).max(0.0);
        self.top = self.top.clamp(0.0, most);
    }

    fn keys(
        &mut self,
        ui: &Ui,
        table: &Table,
        response: &Response,
        places: usize,
        rows: usize,
        out: &mut Vec<Event>,
    ) {
        if !response.has_focus() || places == 0 {
            return;
        }
        let filter = EventFilter { vertical_arrows: true, ..EventFilter::default() };
        ui.memory_mut(|memory| memory.set_focus_lock_filter(response.id, filter));
        let page = rows.saturating_sub(1).max(1) as isize;
        let moves = [
            (Key::ArrowDown, 1),
            (Key::ArrowUp, -1),
            (Key::PageDown, page),
            (Key::PageUp, -page),
            (Key::Home, isize::MIN / 2),
            (Key::End, isize::MAX / 2),
        ];
        let pressed = |key| ui.input_mut(|input| input.consume_key(Modifiers::NONE, key));
        let by: isize = moves.iter().filter(|(key, _)| pressed(*key)).map(|(_, by)| by).sum();
        if by == 0 {
            return;
        }
        let at = self.cursor.unwrap_or(0) as isize;
        let place = at.saturating_add(by).clamp(0, places as isize - 1) as usize;
        self.cursor = Some(place);
        let last = rows.saturating_sub(2) as f64;
        self.top = self.top.min(place as f64).max(place as f64 - last);
        let ids = table.ids(self.row_at(place)).into_iter().collect();
        out.push(Event::Select(Select::Curves(ids)));
    }

    fn clicks(
        &mut self,
        state: &State,
        ui: &Ui,
        table: &Table,
        (response, body, height): (&Response, Rect, f32),
        places: usize,
        out: &mut Vec<Event>,
    ) {
        let Some(at) = response.interact_pointer_pos().filter(|_| response.clicked()) else {
            return;
        };
        response.request_focus();
        let place = (self.top + f64::from((at.y - body.top()) / height)) as usize;
        if place >= places {
            return;
        }
        let modifiers = ui.input(|input| input.modifiers);
        let ids = |place: usize| table.ids(self.row_at(place));
        let picked: BTreeSet<u64> = if modifiers.command {
            let mut all = state.selection.curves.clone();
            for id in ids(place) {
                if !all.remove(&id) {
                    all.insert(id);
                }
            }
            all
        } else if modifiers.shift {
            let from = self.cursor.unwrap_or(place);
            let (a, b) = (from.min(place), from.max(place));
            (a..=b.min(a + MOST_COPIED)).flat_map(ids).collect()
        } else {
            ids(place).into_iter().collect()
        };
        if !modifiers.shift {
            self.cursor = Some(place);
        }
        out.push(Event::Select(Select::Curves(picked)));
    }

    /// The bar at the right. Rows are counted in f64: a million of them are more points than an f32 tells apart.
    fn scroll_bar(&mut self, ui: &Ui, bar: Rect, places: usize, rows: f32) {
        let response = ui.interact(bar, ui.id().with("bar"), Sense::click_and_drag());
        let painter = ui.painter_at(bar);
        painter.rect_filled(bar, 3.0, theme::GROUND);
        let most = places as f64 - f64::from(rows.floor());
        if most <= 0.0 {
            return;
        }
        let length = (bar.height() * rows / places as f32).max(24.0).min(bar.height());
        let way = f64::from(bar.height() - length).max(1.0);
        if (response.dragged() || response.clicked())
            && let Some(at) = response.interact_pointer_pos()
        {
            let middle = f64::from(at.y - bar.top() - length / 2.0);
            self.top = (middle / way).clamp(0.0, 1.0) * most;
        }
        let y = bar.top() + (self.top / most * way) as f32;
        let thumb = Rect::from_min_size(pos2(bar.left() + 2.0, y), vec2(BAR - 4.0, length));
        let fill = ui.style().interact(&response).weak_bg_fill;
        painter.rect_filled(thumb, 3.0, fill);
    }
}

/// The columns that can be seen.
fn visible_columns(view: Rect, rect: Rect, count: usize) -> std::ops::Range<usize> {
    let first = ((view.left() - rect.left()) / COLUMN).floor().max(0.0) as usize;
    let last = ((view.right() - rect.left()) / COLUMN).ceil().max(0.0) as usize;
    first.min(count)..last.min(count)
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
