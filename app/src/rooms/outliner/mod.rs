//! The outliner: what the groom is made of, as a tree. Heads; outputs; below each the braids, strands or parents that its hair
//! belongs to, and the nodes that made it.
//!
//! Guarantees: a frame costs what its visible rows cost; the tree is made anew only when the document or what is shown
//! changed, and not while something is dragged. Eyes, locks and isolating are view state and never change a groom.

mod eyes;
#[cfg(test)]
mod tests;
mod tree;

use crate::core::action;
use crate::core::event::Event;
use crate::core::room::Room;
use crate::core::shown::{Shown, first_output};
use crate::core::state::{Select, State};
use crate::core::visibility::Visibility;
use crate::widgets::keyboard::keep_arrows;
use crate::widgets::panel;
use crate::widgets::text::{set_name, spoken, text_field};
use crate::widgets::theme;
use crate::words::grouped;
use coif_graphs::document::edit::Edit;
use coif_graphs::document::graph;
use coif_graphs::document::{Document, NodeId};
use egui::{
    Align2, Key, Modifiers, Rect, Response, ScrollArea, Sense, Stroke, StrokeKind, TextEdit,
    TextStyle, Ui, WidgetInfo, WidgetType, pos2, vec2,
};
use eyes::{EYES, eye_buttons, toggled};
use std::collections::{BTreeMap, BTreeSet};
use std::sync::{Arc, Weak};
use tree::{BESIDE, Groups, Item, Tree, TreeRow, groups, kin, outputs};

/// What the outliner remembers between frames.
#[derive(Default)]
pub(crate) struct Outliner {
    rows: Vec<TreeRow>,
    /// As of which changes and evaluation the rows were made; none: make them anew.
    made: Option<(u64, Weak<Shown>)>,
    groups: BTreeMap<NodeId, Groups>,
    /// What was opened or closed by hand.
    open: BTreeMap<Item, bool>,
    filter: String,
    cursor: usize,
    /// Hair of which something is selected, and as of which selection and evaluation.
    lit: BTreeSet<Item>,
    lit_of: Option<(BTreeSet<u64>, Weak<Shown>)>,
    /// The row that is being renamed: what it stands below, and its node.
    renaming: Option<(Option<NodeId>, NodeId)>,
    /// Whether renaming begins in this frame.
    begun: bool,
    /// The row of what is selected is to be brought in sight.
    reveals: bool,
    /// Somebody asked with a key for the menu of the row at the cursor.
    menu_by_key: bool,
}

const INDENT: f32 = 14.0;

impl Outliner {
    /// Brings the braid or cluster of the selected hair in sight, at the next frame.
    pub(crate) fn reveal(&mut self) {
        self.reveals = true;
    }

    /// Opens the menu of the row at the cursor, at the next frame.
    pub(crate) fn open_menu_by_key(&mut self) {
        self.menu_by_key = true;
    }

    /// Opens what the selected hair stands below, and gives the number of its row.
    fn revealed(&mut self, state: &State) -> Option<usize> {
        if !std::mem::take(&mut self.reveals) {
            return None;
        }
        self.filter.clear();
        let above = self.lit.iter().filter_map(|item| match item {
            Item::Braid(node, _) | Item::Beside(node, _) | Item::Parent(node, _) => Some(node),
            _ => None,
        });
        self.open.extend(above.map(|node| (Item::Node(node.clone()), true)));
        self.made = None;
        self.look(state);
        let found = self.rows.iter().position(|row| self.lit.contains(&row.item))?;
        self.cursor = found;
        Some(found)
    }

    /// Shows the tree and says what is done in it.
    pub(crate) fn ui(&mut self, state: &State, ui: &mut Ui, out: &mut Vec<Event>) {
        self.look(state);
        self.light(state);
        let revealed = self.revealed(state);
        ui.horizontal(|ui| {
            let all = !state.visibility.shows_all();
            let show = ui.add_enabled(all, egui::Button::new("Show all"));
            let width = (ui.available_width() - show.rect.width() - 8.0).max(40.0);
            if show.on_hover_text("Show all hair again.").clicked() {
                let locked = state.visibility.locked.clone();
                out.push(Event::Visibility(Visibility { locked, ..Visibility::default() }));
            }
            let edit = TextEdit::singleline(&mut self.filter)
                .hint_text("Filter by name: row*, left")
                .min_size(ui.spacing().interact_size)
                .vertical_align(egui::Align::Center)
                .desired_width(width.min(ui.available_width()));
            let edit = ui.add(edit);
            set_name(ui, &edit, "Filter the outliner");
            if edit.changed() {
                self.made = None;
            }
        });
        if self.rows.is_empty() {
            ui.weak(if self.filter.is_empty() { "No nodes yet." } else { "No matches." });
            return;
        }
        let height = ui.spacing().interact_size.y;
        let count = self.rows.len();
        ui.spacing_mut().item_spacing.y = 0.0;
        ScrollArea::vertical().auto_shrink(false).show_viewport(ui, |ui, view| {
            let size = vec2(ui.available_width(), height * count as f32);
            let (rect, _) = ui.allocate_exact_size(size, Sense::hover());
            let list = ui.interact(rect, ui.id().with("list"), Sense::focusable_noninteractive());
            self.keys(state, ui, &list, out);
            if let Some(i) = revealed {
                let top = rect.top() + height * i as f32;
                let line = Rect::from_min_size(pos2(rect.left(), top), vec2(10.0, height));
                ui.scroll_to_rect(line, Some(egui::Align::Center));
            }
            let first = (view.top() / height).floor().max(0.0) as usize;
            let last = (view.bottom() / height).ceil().max(0.0) as usize;
            let mut toggled = None;
            for i in first..last.min(count) {
                let min = rect.left_top() + vec2(0.0, height * i as f32);
                let line = Rect::from_min_size(min, vec2(rect.width(), height));
                let cursor = self.cursor == i && list.has_focus();
                toggled = self.row(state, ui, i, line, cursor, &list, out).or(toggled);
            }
            if let Some(i) = toggled {
                self.toggle(i);
            }
            list.widget_info(|| WidgetInfo::labeled(WidgetType::Other, true, "Outliner"));
        });
    }

    /// Makes the rows anew where something changed.
    fn look(&mut self, state: &State) {
        let shown = state.shown.as_ref().map_or_else(Weak::new, Arc::downgrade);
        let made = self.made.as_ref();
        let same_shown = made.is_some_and(|(_, of)| of.ptr_eq(&shown));
        // Counting hair at every move of the hand would be felt.
        let kept = made.is_some() && state.gesture;
        if kept || (same_shown && made.is_some_and(|(changes, _)| *changes == state.changes)) {
            return;
        }
        let outputs = outputs(&state.document);
        if !same_shown || self.groups.len() != outputs.len() {
            let of = |id: &NodeId| {
                let socket = first_output(&state.document, id)?;
                Some(groups(state.shown.as_deref()?.curves_of(&socket)?))
            };
            let found = outputs.iter().map(|id| (id.clone(), of(id).unwrap_or(Groups::None)));
            self.groups = found.collect();
        }
        let Self { groups, open, filter, .. } = self;
        self.rows = Tree { state, groups, open, filter }.rows(&outputs);
        self.cursor = self.cursor.min(self.rows.len().saturating_sub(1));
        self.made = Some((state.changes, shown));
    }

    /// Finds, where the selection changed, which braids, strands and clusters it is of.
    fn light(&mut self, state: &State) {
        let shown = state.shown.as_ref().map_or_else(Weak::new, Arc::downgrade);
        let curves = &state.selection.curves;
        let same = self.lit_of.as_ref().is_some_and(|(of, at)| of == curves && at.ptr_eq(&shown));
        if same || state.gesture {
            return;
        }
        self.lit = BTreeSet::new();
        for (id, groups) in &self.groups {
            let socket = first_output(&state.document, id);
            let of = socket.and_then(|socket| state.shown.as_deref()?.curves_of(&socket));
            let Some(of) = of.filter(|_| !curves.is_empty()) else { continue };
            for (tuft, i) in of.each().filter(|(tuft, i)| curves.contains(&tuft.id(*i))) {
                let (braid, strand, parent) = kin(tuft, i);
                if strand == BESIDE {
                    self.lit.insert(Item::Beside(id.clone(), braid));
                } else if matches!(groups, Groups::Braids(..)) {
                    self.lit.insert(Item::Braid(id.clone(), braid));
                    self.lit.insert(Item::Strand(id.clone(), braid, strand));
                } else {
                    self.lit.insert(Item::Parent(id.clone(), parent));
                }
            }
        }
        self.lit_of = Some((curves.clone(), shown));
    }

    fn toggle(&mut self, i: usize) {
        if let Some(row) = self.rows.get(i)
            && let Some(open) = row.open
        {
            self.open.insert(row.item.clone(), !open);
            self.made = None;
        }
    }

    /// Shows one row; gives its number when it is to be opened or closed.
    fn row(
        &mut self,
        state: &State,
        ui: &mut Ui,
        i: usize,
        line: Rect,
        cursor: bool,
        list: &Response,
        out: &mut Vec<Event>,
    ) -> Option<usize> {
        let row = self.rows[i].clone();
        let id = ui.id().with((&row.under, format!("{:?}", row.item)));
        let response = ui.interact(line, id, Sense::click());
        let is_selected = match &row.item {
            Item::Node(node) => state.selection.nodes.contains(node),
            item => self.lit.contains(item),
        };
        let painter = ui.painter_at(line);
        if is_selected {
            painter.rect_filled(line, 2.0, theme::SELECTED.of(ui));
        } else if response.hovered() {
            painter.rect_filled(line, 2.0, theme::STRIPE.of(ui));
        }
        if cursor {
            let stroke = Stroke::new(1.0, theme::ACCENT.of(ui));
            painter.rect_stroke(line, 2.0, stroke, StrokeKind::Inside);
        }
        let height = line.height();
        let mut left = line.left() + 4.0 + INDENT * row.depth as f32;
        let mut toggled = None;
        if let Some(open) = row.open {
            let arrow = Rect::from_min_size(pos2(left, line.top()), vec2(INDENT + 4.0, height));
            let button = ui.interact(arrow, id.with("arrow"), Sense::click());
            let font = TextStyle::Small.resolve(ui.style());
            let sign = if open { "⏷" } else { "⏵" };
            painter.text(arrow.center(), Align2::CENTER_CENTER, sign, font, theme::QUIET.of(ui));
            let what = if open { "Close" } else { "Open" };
            let name = format!("{what} {}", row.name);
            button.widget_info(|| WidgetInfo::labeled(WidgetType::Button, true, &name));
            toggled = button.clicked().then_some(i);
        }
        left += INDENT + 4.0;
        let eyes = if row.names.is_empty() { 0.0 } else { height * 3.0 };
        let right = line.right() - eyes - 4.0;
        if let (Item::Node(node), true) = (&row.item, self.renaming_here(&row)) {
            let at = Rect::from_min_max(pos2(left, line.top()), pos2(right, line.bottom()));
            self.rename(state, ui, node, at, out);
            return toggled;
        }
        let hidden = !row.names.is_empty()
            && row.names.iter().all(|name| state.visibility.hidden.contains(name));
        let colour =
            if hidden { theme::QUIET.of(ui).gamma_multiply(0.7) } else { theme::TEXT.of(ui) };
        let body = TextStyle::Body.resolve(ui.style());
        let small = TextStyle::Small.resolve(ui.style());
        let clip = Rect::from_min_max(pos2(left, line.top()), pos2(right, line.bottom()));
        let text = painter.with_clip_rect(clip.intersect(painter.clip_rect()));
        let middle = line.center().y;
        let count = row.curves.map_or(0.0, |curves| {
            let at = pos2(right, middle);
            let count = grouped(curves);
            text.text(at, Align2::RIGHT_CENTER, count, small.clone(), theme::QUIET.of(ui)).width()
                + 8.0
        });
        let names = clip.with_max_x((right - count).max(left));
        let text = painter.with_clip_rect(names.intersect(painter.clip_rect()));
        let end = text.text(pos2(left, middle), Align2::LEFT_CENTER, &row.name, body, colour);
        let at = pos2(end.right() + 8.0, middle);
        text.text(at, Align2::LEFT_CENTER, &row.kind, small, theme::QUIET.of(ui));
        let name = &row.name;
        response.widget_info(|| {
            WidgetInfo::selected(WidgetType::SelectableLabel, true, is_selected, name)
        });
        if !row.names.is_empty() {
            eye_buttons(state, ui, &row, id, line, out);
        }
        let by_key = self.cursor == i && std::mem::take(&mut self.menu_by_key);
        let opens = by_key.then_some(line.center()).or_else(|| panel::right_click(&response));
        if opens.is_some() {
            self.cursor = i;
            if !is_selected {
                select(state, &row.item, false, out);
            }
        }
        panel::menu_at(&response, opens, |ui| self.menu(state, ui, &row, out));
        if response.double_clicked()
            && let Item::Node(node) = &row.item
        {
            (self.renaming, self.begun) = (Some((row.under.clone(), node.clone())), true);
        } else if response.clicked() {
            self.cursor = i;
            list.request_focus();
            let add = ui.input(|input| input.modifiers.command || input.modifiers.shift);
            select(state, &row.item, add, out);
        }
        let tip = match &row.item {
            Item::Node(_) if row.kind.is_empty() => "Double-click to rename.".to_owned(),
            Item::Node(_) => format!("{}. Double-click to rename.", spoken(&row.kind)),
            _ => "Click to select its hair.".to_owned(),
        };
        response.on_hover_text(tip);
        toggled
    }

    /// What the right button offers on a row.
    fn menu(&mut self, state: &State, ui: &mut Ui, row: &TreeRow, out: &mut Vec<Event>) {
        let entry = |ui: &mut Ui, can: bool, text: &str, tip: &str| {
            let button = ui.add_enabled(can, egui::Button::new(text));
            let clicked = button.on_hover_text(tip).on_disabled_hover_text(tip).clicked();
            if clicked {
                ui.close();
            }
            clicked
        };
        let below = matches!(row.item, Item::Makers(_));
        if entry(ui, !below, "Select", "Select it, as a click on the row does.") {
            select(state, &row.item, false, out);
        }
        if entry(ui, !below, "Frame", "Frame it in the viewport.") {
            if matches!(row.item, Item::Node(_)) {
                out.push(Event::Select(Select::Curves(BTreeSet::new())));
            }
            select(state, &row.item, false, out);
            out.push(Event::Act("view.frame_selected"));
        }
        if !row.names.is_empty() {
            ui.separator();
            for (eye, signs) in EYES {
                let on = eye.is_on(&state.visibility, &row.names);
                if entry(ui, true, signs[usize::from(on)], eye.tip()) {
                    out.push(eye.toggled(&state.visibility, &row.names));
                }
            }
        }
        if !state.visibility.shows_all() {
            action::menu(state.table, &["view.show_all"], ui, out);
        }
        let of = match &row.item {
            Item::Node(node) => node,
            Item::Makers(node) | Item::Braid(node, _) | Item::Beside(node, _) => node,
            Item::Strand(node, ..) | Item::Parent(node, _) => node,
        };
        ui.separator();
        if let Item::Node(node) = &row.item
            && entry(ui, true, "Rename", "Rename the node.")
        {
            (self.renaming, self.begun) = (Some((row.under.clone(), node.clone())), true);
        }
        let colours = coloured_by(&state.document, of);
        let tip = match colours {
            Some(_) => "Select the node that colours this hair.",
            None => "No node upstream colours this hair: add a Hair colour node.",
        };
        if entry(ui, colours.is_some(), "Colour…", tip)
            && let Some(node) = colours
        {
            out.push(Event::Select(Select::Nodes(vec![node])));
            out.push(Event::Show(Room::Inspector));
        }
    }

    fn renaming_here(&self, row: &TreeRow) -> bool {
        let Item::Node(node) = &row.item else { return false };
        self.renaming.as_ref().is_some_and(|(under, of)| *under == row.under && of == node)
    }

    fn rename(
        &mut self,
        state: &State,
        ui: &mut Ui,
        node: &NodeId,
        at: Rect,
        out: &mut Vec<Event>,
    ) {
        let label = state.document.node(node.as_str()).and_then(|n| n.label.clone());
        let mut inner = ui.new_child(egui::UiBuilder::new().max_rect(at).id_salt(("rename", node)));
        let hint = state.document.name_of(node);
        let old = label.unwrap_or_default();
        let name = "New name";
        if std::mem::take(&mut self.begun) {
            let id = inner.id().with("focus");
            inner.data_mut(|data| data.insert_temp(id, true));
        }
        let field = inner.id().with(name);
        let typed = text_field(&mut inner, name, &old, &hint, (at.width(), 1));
        let left = !inner.memory(|memory| memory.has_focus(field));
        if let Some(label) = typed.as_ref() {
            let label = Some(label.trim().to_owned()).filter(|label| !label.is_empty());
            out.push(Event::Edit(Edit::SetLabel { id: node.clone(), label }));
        }
        if typed.is_some() || left {
            self.renaming = None;
        }
    }

    fn keys(&mut self, state: &State, ui: &Ui, list: &Response, out: &mut Vec<Event>) {
        if !list.has_focus() || self.rows.is_empty() {
            return;
        }
        keep_arrows(ui, list.id);
        let pressed = |key| ui.input_mut(|input| input.consume_key(Modifiers::NONE, key));
        let last = self.rows.len() - 1;
        let before = self.cursor;
        if pressed(Key::ArrowDown) {
            self.cursor = (self.cursor + 1).min(last);
        }
        if pressed(Key::ArrowUp) {
            self.cursor = self.cursor.saturating_sub(1);
        }
        if pressed(Key::Home) {
            self.cursor = 0;
        }
        if pressed(Key::End) {
            self.cursor = last;
        }
        let row = self.rows[self.cursor].clone();
        if self.cursor != before {
            select(state, &row.item, false, out);
            let height = ui.spacing().interact_size.y;
            let top = list.rect.top() + height * self.cursor as f32;
            let line = Rect::from_min_size(pos2(list.rect.left(), top), vec2(10.0, height));
            ui.scroll_to_rect(line, None);
        }
        let wants = (pressed(Key::ArrowRight), pressed(Key::ArrowLeft));
        if let (Some(false), (true, _)) | (Some(true), (_, true)) = (row.open, wants) {
            self.toggle(self.cursor);
        }
        if pressed(Key::Space) && !row.names.is_empty() {
            let toggled = toggled(&state.visibility.hidden, &row.names);
            let visibility = Visibility { hidden: toggled, ..state.visibility.clone() };
            out.push(Event::Visibility(visibility));
        }
        if pressed(Key::F2)
            && let Item::Node(node) = &row.item
        {
            (self.renaming, self.begun) = (Some((row.under.clone(), node.clone())), true);
        }
    }
}

/// The node that gives the hair of a node its colour: the last one before it that sets one.
fn coloured_by(document: &Document, node: &NodeId) -> Option<NodeId> {
    let way = graph::upstream(document, [node]);
    let colours = |id: &&NodeId| {
        let node = document.node(id.as_str());
        way.contains(*id) && node.is_some_and(|n| COLOURS.contains(&n.kind.as_str()))
    };
    graph::order(document).ok()?.iter().rev().find(colours).cloned()
}

/// Kinds of nodes that set the colour of hair.
const COLOURS: [&str; 2] = ["hair_colour", "set_colour"];

/// Selects what a row stands for.
fn select(state: &State, item: &Item, add: bool, out: &mut Vec<Event>) {
    let (output, belongs): (&NodeId, Box<dyn Fn((u64, i32, u64)) -> bool>) = match item {
        Item::Node(node) => {
            let select = match add {
                true => Select::Toggle(node.clone()),
                false => Select::Nodes(vec![node.clone()]),
            };
            out.push(Event::Select(select));
            return;
        }
        Item::Makers(_) => return,
        Item::Braid(output, braid) => {
            (output, Box::new(move |kin| kin.0 == *braid && kin.1 != BESIDE))
        }
        Item::Beside(output, braid) => {
            (output, Box::new(move |kin| kin.0 == *braid && kin.1 == BESIDE))
        }
        Item::Strand(output, braid, strand) => {
            (output, Box::new(move |kin| kin.0 == *braid && kin.1 == *strand))
        }
        Item::Parent(output, parent) => (output, Box::new(move |kin| kin.2 == *parent)),
    };
    let socket = first_output(&state.document, output);
    let curves = socket.and_then(|socket| state.shown.as_deref()?.curves_of(&socket).cloned());
    let Some(curves) = curves else { return };
    let mut ids = if add { state.selection.curves.clone() } else { BTreeSet::new() };
    ids.extend(curves.each().filter(|(t, i)| belongs(kin(t, *i))).map(|(t, i)| t.id(i)));
    out.push(Event::Select(Select::Curves(ids)));
}
