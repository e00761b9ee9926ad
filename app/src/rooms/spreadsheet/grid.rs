//! The grid of the spreadsheet: headings, statistics, rows; scrolled, clicked and walked by keys.

use super::table::{Column, Table};
use super::{MOST_COPIED, Spreadsheet};
use crate::core::event::Event;
use crate::core::state::{Select, State};
use crate::widgets::theme;
use crate::words::grouped;
use egui::{
    Align2, Color32, EventFilter, Key, Modifiers, Painter, Rect, Response, ScrollArea, Sense,
    Stroke, StrokeKind, TextStyle, Ui, WidgetInfo, WidgetType, pos2, vec2,
};
use std::collections::BTreeSet;
use std::ops::Range;

const BAR: f32 = 12.0;

/// Where columns lie.
struct Layout<'a> {
    columns: &'a [&'a Column],
    /// The left end of each column from that of the first, and the right end of the last.
    lefts: Vec<f32>,
    rect: Rect,
    /// Those that can be seen.
    visible: Range<usize>,
    height: f32,
}

impl<'a> Layout<'a> {
    fn lefts(columns: &[&Column]) -> Vec<f32> {
        let mut lefts = vec![0.0];
        for (i, column) in columns.iter().enumerate() {
            lefts.push(lefts[i] + if column.ids { 148.0 } else { 112.0 });
        }
        lefts
    }

    fn new(columns: &'a [&'a Column], rect: Rect, view: Rect, height: f32) -> Self {
        let lefts = Self::lefts(columns);
        let first = lefts[1..].partition_point(|end| rect.left() + end < view.left());
        let last = lefts.partition_point(|left| rect.left() + left < view.right());
        Self { columns, lefts, rect, visible: first..last.min(columns.len()), height }
    }

    /// The visible columns, each with its cell in the line at `top`.
    fn cells(&self, top: f32) -> impl Iterator<Item = (&'a Column, Rect)> {
        let (rect, height) = (self.rect, self.height);
        self.visible.clone().map(move |c| {
            let min = pos2(rect.left() + self.lefts[c], top);
            let max = pos2(rect.left() + self.lefts[c + 1], top + height);
            (self.columns[c], Rect::from_min_max(min, max))
        })
    }
}

/// Text at the right of its cell, cut off at the left where it is too long.
fn write(painter: &Painter, cell: Rect, text: &str, font: &egui::FontId, colour: Color32) {
    let clip = cell.shrink2(vec2(4.0, 0.0)).intersect(painter.clip_rect());
    let at = cell.right_center() - vec2(8.0, 0.0);
    painter.with_clip_rect(clip).text(at, Align2::RIGHT_CENTER, text, font.clone(), colour);
}

impl Spreadsheet {
    pub(super) fn grid(
        &mut self,
        state: &State,
        ui: &mut Ui,
        table: &Table,
        columns: &[&Column],
        out: &mut Vec<Event>,
    ) {
        let height = row_height(ui);
        let area = ui.available_rect_before_wrap();
        let places = self.places(table);
        let bar = Rect::from_min_max(pos2(area.right() - BAR, area.top() + height), area.max);
        let left = Rect::from_min_max(area.min, pos2(bar.left() - 2.0, area.bottom()));
        let width = Layout::lefts(columns).last().copied().unwrap_or(0.0);
        let mut inner = ui.new_child(egui::UiBuilder::new().max_rect(left));
        ScrollArea::horizontal().id_salt("columns").auto_shrink(false).show(&mut inner, |ui| {
            let view = ui.clip_rect().intersect(left);
            let size = vec2(width.max(left.width()), left.height());
            let (rect, _) = ui.allocate_exact_size(size, Sense::hover());
            let layout = Layout::new(columns, rect, view, height);
            self.heads(ui, &layout);
            let mut from = rect.top() + height;
            if self.statistics {
                self.statistics_rows(ui, &layout, from);
                from += height * 4.0;
            }
            let body = Rect::from_min_max(pos2(rect.left(), from), rect.max);
            let response = ui.interact(body, ui.id().with("rows"), Sense::click());
            let rows = (body.height() / height).max(1.0);
            self.scroll(ui, &response, places, rows);
            self.keys(ui, table, &response, places, rows as usize, out);
            self.clicks(state, ui, table, (&response, body, height), places, out);
            let painter = ui.painter_at(body.intersect(view));
            let font = TextStyle::Monospace.resolve(ui.style());
            let first = self.top as usize;
            for place in first..places.min(first + rows as usize + 2) {
                let row = self.row_at(place);
                let y = body.top() + ((place as f64 - self.top) * f64::from(height)) as f32;
                let line = Rect::from_min_size(pos2(view.left(), y), vec2(view.width(), height));
                if table.is_about(row, &state.selection.curves) {
                    painter.rect_filled(line, 0.0, theme::SELECTED.of(ui));
                } else if place % 2 == 1 {
                    painter.rect_filled(line, 0.0, theme::STRIPE.of(ui));
                }
                if self.cursor == Some(place) && response.has_focus() {
                    let stroke = Stroke::new(1.0, theme::ACCENT.of(ui));
                    painter.rect_stroke(line, 0.0, stroke, StrokeKind::Inside);
                }
                for (column, cell) in layout.cells(y) {
                    write(
                        &painter,
                        cell,
                        &table.cell(row, column).text(),
                        &font,
                        theme::TEXT.of(ui),
                    );
                }
            }
            let name = "Rows of the spreadsheet";
            response.widget_info(|| WidgetInfo::labeled(WidgetType::Other, true, name));
        });
        self.scroll_bar(ui, bar, places, (left.height() - height) / height);
        ui.advance_cursor_after_rect(area);
    }

    fn heads(&mut self, ui: &mut Ui, layout: &Layout) {
        for (column, head) in layout.cells(layout.rect.top()) {
            let id = ui.id().with(("head", &column.name));
            let response = ui.interact(head, id, Sense::click());
            let sorted = self.sort.as_ref().filter(|(name, _)| *name == column.name);
            let sign = match sorted {
                Some((_, false)) => " ⏶",
                Some((_, true)) => " ⏷",
                None => "",
            };
            let visuals = ui.style().interact(&response);
            ui.painter().rect_filled(head.shrink2(vec2(0.5, 0.0)), 0.0, visuals.weak_bg_fill);
            let colour = if sorted.is_some() { theme::ACCENT.of(ui) } else { theme::TEXT.of(ui) };
            let font = TextStyle::Body.resolve(ui.style());
            write(ui.painter(), head, &format!("{}{sign}", column.name), &font, colour);
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

    /// The rows of lowest, highest, mean and NaN.
    fn statistics_rows(&self, ui: &Ui, layout: &Layout, from: f32) {
        let font = TextStyle::Monospace.resolve(ui.style());
        let plain = |x: f64| crate::words::shortest(x, 5);
        for (column, cell) in layout.cells(from) {
            let found = self.answer.as_ref().and_then(|a| a.statistics.get(&column.name));
            let Some(found) = found else { continue };
            let lines = [
                format!("min {}", plain(found.min)),
                format!("max {}", plain(found.max)),
                format!("mean {}", plain(found.mean)),
                format!("NaN {}", grouped(found.nans)),
            ];
            for (i, text) in lines.iter().enumerate() {
                let cell = cell.translate(vec2(0.0, layout.height * i as f32));
                write(ui.painter(), cell, text, &font, theme::QUIET.of(ui));
            }
        }
        let bottom = from + layout.height * 4.0;
        ui.painter().hline(layout.rect.x_range(), bottom, Stroke::new(1.0, theme::LINE.of(ui)));
    }

    fn scroll(&mut self, ui: &Ui, response: &Response, places: usize, rows: f32) {
        if response.contains_pointer() {
            let delta = ui.input(|input| input.smooth_scroll_delta().y);
            self.top -= f64::from(delta / row_height(ui));
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
        painter.rect_filled(bar, 3.0, theme::GROUND.of(ui));
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

fn row_height(ui: &Ui) -> f32 {
    ui.spacing().interact_size.y.max(18.0) - 4.0
}
