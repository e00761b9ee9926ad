//! The outliner: what the groom is made of, as a tree. Heads; outputs; below each the braids, strands or parents that its hair
//! belongs to, and the nodes that made it.
//!
//! Guarantees: a frame costs what its visible rows cost; the tree is made anew only when the document or what is shown
//! changed, and not while something is dragged. Eyes, locks and isolating are view state and never change a groom.

use super::evaluation::{Shown, displayed};
use super::event::Event;
use super::state::{Select, State};
use super::theme;
use super::visibility::Visibility;
use crate::inspector::text::{set_name, text_field};
use coif_graphs::document::edit::Edit;
use coif_graphs::document::graph;
use coif_graphs::document::{Document, NodeId};
use coif_nodes::data::attributes::{BRAID, PARENT, STRAND};
use coif_nodes::data::curves::{Curves, Tuft};
use egui::{
    Align2, EventFilter, Key, Modifiers, Rect, Response, ScrollArea, Sense, Stroke, TextEdit,
    TextStyle, Ui, WidgetInfo, WidgetType, pos2, vec2,
};
use std::collections::{BTreeMap, BTreeSet};
use std::sync::{Arc, Weak};

/// What a row stands for.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Item {
    /// A head, an output, or a node that made something.
    Node(NodeId),
    /// The nodes that made an output's hair.
    Makers(NodeId),
    /// All hair of an output that belongs to one braid.
    Braid(NodeId, u64),
    /// One strand of a braid.
    Strand(NodeId, u64, i32),
    /// All hair of an output made from one curve.
    Parent(NodeId, u64),
}

/// A line of the tree.
#[derive(Clone, Debug)]
struct Row {
    item: Item,
    /// The output that it stands below, which makes rows of one node tell apart.
    under: Option<NodeId>,
    depth: usize,
    name: String,
    /// What it is, in a word or two.
    kind: String,
    curves: Option<usize>,
    /// Whether what is below it is shown; none where nothing is.
    open: Option<bool>,
    /// What its hair is called by, for eyes, locks and isolating; empty where it has none of its own.
    names: Vec<u64>,
}

/// Hair that belongs together.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
struct Group {
    curves: usize,
    /// By strand: how many curves, and what they are called by.
    strands: BTreeMap<i32, (usize, BTreeSet<u64>)>,
}

/// How the hair of an output belongs together.
#[derive(Clone, Debug, PartialEq, Eq)]
enum Groups {
    Braids(BTreeMap<u64, Group>),
    Parents(BTreeMap<u64, usize>),
    None,
}

/// What the outliner remembers between frames.
#[derive(Default)]
pub(crate) struct Outliner {
    rows: Vec<Row>,
    /// As of which changes and evaluation the rows were made; none: make them anew.
    made: Option<(u64, Weak<Shown>)>,
    groups: BTreeMap<NodeId, Groups>,
    /// What was opened or closed by hand.
    open: BTreeMap<Item, bool>,
    filter: String,
    cursor: usize,
    /// The row that is being renamed: what it stands below, and its node.
    renaming: Option<(Option<NodeId>, NodeId)>,
    /// Whether renaming begins in this frame.
    begun: bool,
}

const INDENT: f32 = 14.0;

impl Outliner {
    /// Shows the tree and says what is done in it.
    pub(crate) fn ui(&mut self, state: &State, ui: &mut Ui, out: &mut Vec<Event>) {
        self.look(state);
        ui.horizontal(|ui| {
            let all = !state.visibility.shows_all();
            let show = ui.add_enabled(all, egui::Button::new("Show all"));
            let width = (ui.available_width() - show.rect.width() - 8.0).max(40.0);
            if show.on_hover_text("Nothing is hidden or isolated any more.").clicked() {
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
            ui.weak(if self.filter.is_empty() { "No nodes yet." } else { "Nothing is called so." });
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
                let socket = super::evaluation::first_output(&state.document, id)?;
                Some(groups(state.shown.as_deref()?.curves_of(&socket)?))
            };
            let found = outputs.iter().map(|id| (id.clone(), of(id).unwrap_or(Groups::None)));
            self.groups = found.collect();
        }
        self.rows = self.tree(state, &outputs);
        self.cursor = self.cursor.min(self.rows.len().saturating_sub(1));
        self.made = Some((state.changes, shown));
    }

    fn toggle(&mut self, i: usize) {
        if let Some(row) = self.rows.get(i)
            && let Some(open) = row.open
        {
            self.open.insert(row.item.clone(), !open);
            self.made = None;
        }
    }

    fn is_open(&self, item: &Item, at_first: bool) -> bool {
        !self.filter.is_empty() || self.open.get(item).copied().unwrap_or(at_first)
    }

    fn tree(&self, state: &State, outputs: &[NodeId]) -> Vec<Row> {
        let document = &state.document;
        let mut all = vec![];
        let heads = document.nodes.iter().filter(|(_, node)| node.kind == "head");
        for (id, _) in heads {
            all.push(node_row(state, id, None, 0, None, vec![]));
        }
        for id in outputs {
            self.output(state, id, &mut all);
        }
        if self.filter.trim().is_empty() {
            return all;
        }
        // What is asked for, and what it stands below.
        let asked: Vec<bool> = all.iter().map(|row| fits(&self.filter, &row.name)).collect();
        let mut keep = asked.clone();
        for i in 0..all.len() {
            if !asked[i] {
                continue;
            }
            let mut depth = all[i].depth;
            for j in (0..i).rev() {
                if all[j].depth < depth {
                    keep[j] = true;
                    depth = all[j].depth;
                }
            }
        }
        all.into_iter().zip(keep).filter(|(_, keep)| *keep).map(|(row, _)| row).collect()
    }

    fn output(&self, state: &State, id: &NodeId, all: &mut Vec<Row>) {
        let document = &state.document;
        let groups = self.groups.get(id).unwrap_or(&Groups::None);
        let names = match groups {
            Groups::Braids(braids) => braids.keys().copied().collect(),
            Groups::Parents(parents) => parents.keys().copied().collect(),
            Groups::None => vec![],
        };
        let item = Item::Node(id.clone());
        let open = self.is_open(&item, true);
        all.push(node_row(state, id, None, 0, Some(open), names));
        if !open {
            return;
        }
        let under = Some(id.clone());
        let row = |item: Item, depth, name, kind: &str, curves, open, names| Row {
            item,
            under: under.clone(),
            depth,
            name,
            kind: kind.to_owned(),
            curves,
            open,
            names,
        };
        match groups {
            Groups::None => {}
            Groups::Parents(parents) => {
                for (n, (parent, curves)) in parents.iter().enumerate() {
                    let item = Item::Parent(id.clone(), *parent);
                    let (name, names) = (format!("Cluster {}", n + 1), vec![*parent]);
                    all.push(row(item, 1, name, "one parent", Some(*curves), None, names));
                }
            }
            Groups::Braids(braids) => {
                for (n, (braid, group)) in braids.iter().enumerate() {
                    let item = Item::Braid(id.clone(), *braid);
                    let many = group.strands.len() > 1;
                    let open = many.then(|| self.is_open(&item, false));
                    let (name, names) = (format!("Braid {}", n + 1), vec![*braid]);
                    all.push(row(item, 1, name, "braid", Some(group.curves), open, names));
                    if open != Some(true) {
                        continue;
                    }
                    for (strand, (curves, names)) in &group.strands {
                        let item = Item::Strand(id.clone(), *braid, *strand);
                        let name = format!("Strand {}", strand + 1);
                        let names = names.iter().copied().collect();
                        all.push(row(item, 2, name, "strand", Some(*curves), None, names));
                    }
                }
            }
        }
        let upstream = graph::upstream(document, [id]);
        let order = graph::order(document).unwrap_or_else(|_| upstream.iter().cloned().collect());
        let is_head =
            |node: &NodeId| document.node(node.as_str()).is_some_and(|n| n.kind == "head");
        let makers: Vec<&NodeId> = order
            .iter()
            .rev()
            .filter(|node| *node != id && upstream.contains(*node) && !is_head(node))
            .collect();
        if makers.is_empty() {
            return;
        }
        let item = Item::Makers(id.clone());
        let open = self.is_open(&item, matches!(groups, Groups::None));
        let name = format!("Made by {} nodes", makers.len());
        all.push(row(item, 1, name, "", None, Some(open), vec![]));
        if open {
            for node in makers {
                all.push(node_row(state, node, Some(id.clone()), 2, None, vec![]));
            }
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
        let is_selected = selected(state, &row.item);
        let painter = ui.painter_at(line);
        if is_selected {
            painter.rect_filled(line, 2.0, theme::SELECTED);
        } else if response.hovered() {
            painter.rect_filled(line, 2.0, egui::Color32::from_gray(42));
        }
        if cursor {
            let stroke = Stroke::new(1.0, theme::ACCENT);
            painter.rect_stroke(line, 2.0, stroke, egui::StrokeKind::Inside);
        }
        let height = line.height();
        let mut left = line.left() + 4.0 + INDENT * row.depth as f32;
        let mut toggled = None;
        if let Some(open) = row.open {
            let arrow = Rect::from_min_size(pos2(left, line.top()), vec2(INDENT + 4.0, height));
            let button = ui.interact(arrow, id.with("arrow"), Sense::click());
            let font = TextStyle::Small.resolve(ui.style());
            let sign = if open { "⏷" } else { "⏵" };
            painter.text(arrow.center(), Align2::CENTER_CENTER, sign, font, theme::QUIET);
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
        let colour = if hidden { theme::QUIET.gamma_multiply(0.7) } else { theme::TEXT };
        let body = TextStyle::Body.resolve(ui.style());
        let small = TextStyle::Small.resolve(ui.style());
        let clip = Rect::from_min_max(pos2(left, line.top()), pos2(right, line.bottom()));
        let text = painter.with_clip_rect(clip.intersect(painter.clip_rect()));
        let middle = line.center().y;
        let count = row.curves.map_or(0.0, |curves| {
            let at = pos2(right, middle);
            let count = grouped(curves);
            text.text(at, Align2::RIGHT_CENTER, count, small.clone(), theme::QUIET).width() + 8.0
        });
        let names = clip.with_max_x((right - count).max(left));
        let text = painter.with_clip_rect(names.intersect(painter.clip_rect()));
        let end = text.text(pos2(left, middle), Align2::LEFT_CENTER, &row.name, body, colour);
        let at = pos2(end.right() + 8.0, middle);
        text.text(at, Align2::LEFT_CENTER, &row.kind, small, theme::QUIET);
        let name = &row.name;
        response.widget_info(|| {
            WidgetInfo::selected(WidgetType::SelectableLabel, true, is_selected, name)
        });
        if !row.names.is_empty() {
            eye_buttons(state, ui, &row, id, line, out);
        }
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
            Item::Node(node) => format!("{}: {node}. Double click renames.", row.kind),
            _ => "Click selects its hair.".to_owned(),
        };
        response.on_hover_text(tip);
        toggled
    }

    fn renaming_here(&self, row: &Row) -> bool {
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
        let typed = text_field(&mut inner, name, &old, hint, (at.width(), 1));
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
        let filter = EventFilter {
            vertical_arrows: true,
            horizontal_arrows: true,
            ..EventFilter::default()
        };
        ui.memory_mut(|memory| memory.set_focus_lock_filter(list.id, filter));
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

/// The eye, the lock and isolating, at the right of a row.
fn eye_buttons(state: &State, ui: &Ui, row: &Row, id: egui::Id, line: Rect, out: &mut Vec<Event>) {
    let height = line.height();
    let view = &state.visibility;
    for (i, what) in ["Hide", "Isolate", "Lock"].into_iter().enumerate() {
        let set = [&view.hidden, &view.alone, &view.locked][i];
        let on = row.names.iter().all(|name| set.contains(name));
        let left = line.right() - height * (3 - i) as f32;
        let at = Rect::from_min_size(pos2(left, line.top()), vec2(height, height));
        let response = ui.interact(at, id.with(what), Sense::click());
        let sign = match (i, on) {
            (0, true) => "–",
            (0, false) => "👁",
            (1, _) => "◎",
            (_, true) => "🔒",
            (_, false) => "🔓",
        };
        let strong = on || response.hovered();
        let colour = match (i, strong) {
            (1, true) if on => theme::ACCENT,
            (_, true) => theme::TEXT,
            // What is not in use steps back.
            (0, false) => theme::QUIET,
            _ => theme::LINE,
        };
        let font = TextStyle::Body.resolve(ui.style());
        ui.painter_at(line).text(at.center(), Align2::CENTER_CENTER, sign, font, colour);
        let name = format!("{what} {}", row.name);
        response.widget_info(|| WidgetInfo::selected(WidgetType::Checkbox, true, on, &name));
        if response.clicked() {
            let new = toggled(set, &row.names);
            let mut view = view.clone();
            *[&mut view.hidden, &mut view.alone, &mut view.locked][i] = new;
            out.push(Event::Visibility(view));
        }
        response.on_hover_text(match i {
            0 => "Hides this hair in the viewport, or shows it again. Space does the same.",
            1 => "Shows this hair alone, with what else is isolated.",
            _ => "Keeps the pen off this hair.",
        });
    }
}

/// The set with all of the names, or without them where it had all.
fn toggled(set: &BTreeSet<u64>, names: &[u64]) -> BTreeSet<u64> {
    let mut set = set.clone();
    if names.iter().all(|name| set.contains(name)) {
        for name in names {
            set.remove(name);
        }
    } else {
        set.extend(names);
    }
    set
}

fn node_row(
    state: &State,
    id: &NodeId,
    under: Option<NodeId>,
    depth: usize,
    open: Option<bool>,
    names: Vec<u64>,
) -> Row {
    let kind = state.document.node(id.as_str()).map_or("", |node| node.kind.as_str());
    let label = coif_nodes::by_id(kind).map_or(kind, |def| def.label);
    let name = state.document.name_of(id).to_owned();
    let report = state.run.reports.nodes.get(id);
    Row {
        item: Item::Node(id.clone()),
        under,
        depth,
        kind: if name == label { String::new() } else { label.to_lowercase() },
        name,
        curves: report.map(|report| report.curves).filter(|curves| *curves > 0),
        open,
        names,
    }
}

/// The outputs of a groom; where it has none, the nodes that are displayed.
fn outputs(document: &Document) -> Vec<NodeId> {
    let output = |(id, node): (&NodeId, _)| {
        let node: &Arc<coif_graphs::document::Node> = node;
        (node.kind == "groom_output").then(|| id.clone())
    };
    let found: Vec<NodeId> = document.nodes.iter().filter_map(output).collect();
    if !found.is_empty() {
        return found;
    }
    displayed(document).into_iter().map(|socket| socket.node).collect()
}

/// What a curve belongs to: its braid and strand, and its parent.
fn kin(tuft: &Tuft, i: usize) -> (u64, i32, u64) {
    let first = tuft.offsets()[i] as usize;
    let (braid, strand) = (tuft.view(BRAID).at(i, first), tuft.view(STRAND).at(i, first));
    (braid, strand, tuft.view(PARENT).at(i, first))
}

/// How curves belong together: by braid where they have one, else by parent where that says something.
fn groups(curves: &Curves) -> Groups {
    let (mut braids, mut parents) = (BTreeMap::<u64, Group>::new(), BTreeMap::<u64, usize>::new());
    for (tuft, i) in curves.each() {
        let (braid, strand, parent) = kin(tuft, i);
        if braid != 0 {
            let group = braids.entry(braid).or_default();
            group.curves += 1;
            let (count, names) = group.strands.entry(strand).or_default();
            *count += 1;
            names.insert(if parent == 0 { tuft.id(i) } else { parent });
        }
        if parent != 0 {
            *parents.entry(parent).or_default() += 1;
        }
    }
    if !braids.is_empty() {
        return Groups::Braids(braids);
    }
    match parents.len() {
        0 => Groups::None,
        _ => Groups::Parents(parents),
    }
}

fn selected(state: &State, item: &Item) -> bool {
    match item {
        Item::Node(node) => state.selection.nodes.contains(node),
        _ => false,
    }
}

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
        Item::Braid(output, braid) => (output, Box::new(move |kin| kin.0 == *braid)),
        Item::Strand(output, braid, strand) => {
            (output, Box::new(move |kin| kin.0 == *braid && kin.1 == *strand))
        }
        Item::Parent(output, parent) => (output, Box::new(move |kin| kin.2 == *parent)),
    };
    let socket = super::evaluation::first_output(&state.document, output);
    let curves = socket.and_then(|socket| state.shown.as_deref()?.curves_of(&socket).cloned());
    let Some(curves) = curves else { return };
    let mut ids = if add { state.selection.curves.clone() } else { BTreeSet::new() };
    ids.extend(curves.each().filter(|(t, i)| belongs(kin(t, *i))).map(|(t, i)| t.id(i)));
    out.push(Event::Select(Select::Curves(ids)));
}

/// Whether a name fits a pattern: a part of it, or with `*` and `?` all of it. Letter case does not count.
fn fits(pattern: &str, name: &str) -> bool {
    let (pattern, name) = (pattern.trim().to_lowercase(), name.to_lowercase());
    if !pattern.contains(['*', '?']) {
        return name.contains(&pattern);
    }
    let (pattern, name): (Vec<char>, Vec<char>) =
        (pattern.chars().collect(), name.chars().collect());
    let (mut p, mut n) = (0, 0);
    // The last star, and how much of the name it takes.
    let mut star: Option<(usize, usize)> = None;
    while n < name.len() {
        if p < pattern.len() && (pattern[p] == '?' || pattern[p] == name[n]) && pattern[p] != '*' {
            (p, n) = (p + 1, n + 1);
        } else if p < pattern.len() && pattern[p] == '*' {
            star = Some((p, n));
            p += 1;
        } else if let Some((at, taken)) = star {
            star = Some((at, taken + 1));
            (p, n) = (at + 1, taken + 1);
        } else {
            return false;
        }
    }
    pattern[p..].iter().all(|c| *c == '*')
}

/// A count with commas: 1,204.
pub(super) fn grouped(n: usize) -> String {
    let digits = n.to_string();
    let mut text = String::new();
    for (i, digit) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i) % 3 == 0 {
            text.push(',');
        }
        text.push(digit);
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::editor::Editor;
    use crate::editor::state::OpenFile;
    use coif_graphs::document::Socket;
    use coif_nodes::data::attributes::{Domain, ID};
    use coif_nodes::data::curves::TuftBuilder;
    use coif_nodes::eval::Quality;
    use egui_kittest::Harness;
    use egui_kittest::kittest::Queryable as _;
    use glam::Vec3;
    use std::time::Instant;

    /// Two braids (7 and 8) of three strands of four hairs; each strand is its hairs' parent.
    fn braids() -> Curves {
        let tuft = |braid: u64| {
            let mut tuft = TuftBuilder::even(vec![Vec3::ZERO; 24], 2);
            let each = |f: &dyn Fn(u64) -> u64| (0..12).map(f).collect::<Vec<u64>>();
            tuft.set(ID, Domain::Curve, each(&|i| braid * 100 + i));
            tuft.set(BRAID, Domain::Curve, vec![braid]);
            tuft.set(STRAND, Domain::Curve, (0..12).map(|i| i / 4).collect());
            tuft.set(PARENT, Domain::Curve, each(&|i| braid * 10 + i / 4));
            Arc::new(tuft.build())
        };
        Curves::new(vec![tuft(7), tuft(8)])
    }

    struct Bench {
        editor: Editor,
        outliner: Outliner,
    }

    fn hands(groom: &str, curves: Curves) -> (Harness<'static, Bench>, NodeId) {
        let text = coif_graphs::grooms::by_name(groom).unwrap();
        let document = coif_graphs::file::read(text).unwrap().document;
        let output = outputs(&document)[0].clone();
        let socket = Socket::new(output.clone(), "curves");
        let mut editor = Editor::new(&egui::Context::default(), document, OpenFile::default());
        editor.state.shown = Some(Arc::new(Shown {
            revision: 1,
            quality: Quality::Final,
            sockets: vec![socket.clone()],
            curves: curves.clone(),
            scalps: vec![],
            values: [(socket, curves.into())].into(),
            final_strands: None,
            ms: 0.0,
        }));
        let bench = Bench { editor, outliner: Outliner::default() };
        let mut hands =
            Harness::builder().with_size(vec2(300.0, 900.0)).with_step_dt(0.02).build_ui_state(
                |ui, bench: &mut Bench| {
                    theme::apply(ui.ctx(), false);
                    let mut out = vec![];
                    bench.outliner.ui(&bench.editor.state, ui, &mut out);
                    for event in out {
                        bench.editor.apply(event);
                    }
                },
                bench,
            );
        hands.run_steps(3);
        (hands, output)
    }

    fn click(hands: &mut Harness<'static, Bench>, label: &str) {
        hands.get_by_label(label).click();
        hands.run_steps(3);
    }

    #[test]
    fn hair_belongs_to_braids_and_strands() {
        let Groups::Braids(found) = groups(&braids()) else { panic!() };
        assert_eq!(found.keys().copied().collect::<Vec<_>>(), [7, 8]);
        assert_eq!(found[&7].curves, 12);
        assert_eq!(found[&8].strands[&2], (4, [82].into()));
        assert_eq!(groups(&Curves::default()), Groups::None);
    }

    #[test]
    fn rows_open_select_hide_isolate_and_lock() {
        let (mut hands, output) = hands("cornrows", braids());
        click(&mut hands, "Braid 2");
        assert_eq!(hands.state().editor.state.selection.curves, (800..812).collect());
        click(&mut hands, "Open Braid 1");
        click(&mut hands, "Strand 2");
        assert_eq!(hands.state().editor.state.selection.curves, (704..708).collect());
        click(&mut hands, "Hide Strand 2");
        click(&mut hands, "Isolate Braid 1");
        click(&mut hands, "Lock Braid 2");
        let view = &hands.state().editor.state.visibility;
        assert_eq!((&view.hidden, &view.alone), (&[71].into(), &[7].into()));
        assert_eq!(view.locked, [8].into());
        assert!(
            view.shows(&[700, 70, 7]) && !view.shows(&[704, 71, 7]) && !view.shows(&[800, 80, 8])
        );
        click(&mut hands, "Show all");
        let view = &hands.state().editor.state.visibility;
        assert!(view.shows_all() && !view.locked.is_empty());
        // An output is selected as a node, and its hair hidden as a whole.
        let name = hands.state().editor.state.document.name_of(&output).to_owned();
        click(&mut hands, &name);
        assert_eq!(hands.state().editor.state.active(), Some(&output));
        click(&mut hands, &format!("Hide {name}"));
        assert_eq!(hands.state().editor.state.visibility.hidden, [7, 8].into());
        assert_eq!(hands.state().editor.state.history.done(), 0);
    }

    #[test]
    fn nodes_that_made_it_are_listed_and_renamed() {
        let (mut hands, output) = hands("cornrows", braids());
        let made = hands.state().outliner.rows.iter().find(|r| matches!(r.item, Item::Makers(_)));
        let label = made.unwrap().name.clone();
        click(&mut hands, &format!("Open {label}"));
        let document = &hands.state().editor.state.document;
        let upstream = graph::upstream(document, [&output]);
        let braid = upstream.iter().find(|id| document.nodes[*id].kind == "lissajous_braid");
        let (braid, name) = (braid.unwrap().clone(), document.name_of(braid.unwrap()).to_owned());
        let at = hands.get_all_by_label(&name).next().unwrap().rect().center();
        // Longer than a double click takes.
        hands.run_steps(30);
        for _ in 0..2 {
            hands.hover_at(at);
            hands.drag_at(at);
            hands.drop_at(at);
        }
        hands.run_steps(3);
        hands.key_press_modifiers(Modifiers::COMMAND, Key::A);
        hands.event(egui::Event::Text("Side rows".into()));
        hands.run_steps(1);
        hands.key_press(Key::Enter);
        hands.run_steps(3);
        let label = hands.state().editor.state.document.nodes[&braid].label.clone();
        assert_eq!(label.as_deref(), Some("Side rows"));
        assert_eq!(hands.state().editor.state.history.done(), 1);
        assert_eq!(hands.state().outliner.renaming, None);
    }

    #[test]
    fn keys_move_open_and_hide() {
        let (mut hands, _) = hands("cornrows", braids());
        click(&mut hands, "Braid 1");
        hands.key_press(Key::ArrowRight);
        hands.run_steps(2);
        hands.get_by_label("Strand 1");
        for _ in 0..2 {
            hands.key_press(Key::ArrowDown);
            hands.run_steps(2);
        }
        assert_eq!(hands.state().editor.state.selection.curves, (704..708).collect());
        hands.key_press(Key::Space);
        hands.run_steps(2);
        assert_eq!(hands.state().editor.state.visibility.hidden, [71].into());
    }

    #[test]
    fn patterns_find_names() {
        for (pattern, name, want) in [
            ("row", "Front rows", true),
            ("row*", "Front rows", false),
            ("*row*", "Front rows", true),
            ("braid ?", "Braid 7", true),
            ("braid ?", "Braid 17", false),
            ("*1*7*", "Braid 1x7", true),
            ("", "x", true),
            ("*", "", true),
            ("a*b*c", "abcbd", false),
        ] {
            assert_eq!(fits(pattern, name), want, "{pattern} {name}");
        }
        let (mut hands, _) = hands("cornrows", braids());
        hands.get_by_label("Filter the outliner").click();
        hands.event(egui::Event::Text("strand 3".into()));
        hands.run_steps(3);
        let names: Vec<_> =
            hands.state().outliner.rows.iter().map(|row| row.name.as_str()).skip(1).collect();
        assert_eq!(names, ["Braid 1", "Strand 3", "Braid 2", "Strand 3"]);
    }

    #[test]
    fn a_frame_of_many_clusters_costs_little() {
        let mut tuft = TuftBuilder::even(vec![Vec3::ZERO; 8_000], 2);
        tuft.set(PARENT, Domain::Curve, (0..4_000).map(|i| i / 2 + 1).collect());
        let tuft = tuft.build();
        let all = (0..25).map(|t| {
            let mut tuft = tuft.edit();
            tuft.set(PARENT, Domain::Curve, (0..4_000).map(|i| t * 2_000 + i / 2 + 1).collect());
            Arc::new(tuft.build())
        });
        let (mut hands, _) = hands("start", Curves::new(all.collect()));
        assert!(hands.state().outliner.rows.len() > 50_000);
        let start = Instant::now();
        hands.run_steps(10);
        let ms = start.elapsed().as_secs_f64() * 100.0;
        println!("outliner of 50,000 clusters: {ms:.2} ms a frame (dev)");
        assert!(ms < 60.0, "{ms}");
    }
}
