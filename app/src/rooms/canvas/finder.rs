//! The search that opens on the canvas: to add a node, to change one's kind, or to find the socket
//! that a wire goes to. Keyboard first: type, arrows, Enter, Escape.

use super::edits::{Link, PLACES, PLACES_AT};
use super::hand::{Fixed, Loose};
use super::search::{self, Hints, SearchEntry, Why};
use super::text::{self, line};
use super::wires::Wire;
use crate::core::faces::{Face, Faces, words};
use crate::widgets::panel;
use crate::widgets::text::spoken;
use crate::widgets::theme;
use coif_graphs::document::{Document, NodeId, Socket, wiring};
use coif_nodes::define::{InputDef, NodeDef, Type};
use egui::{Align2, Area, Frame, Id, Key, Modifiers, Order, Pos2, RichText, Sense, TextEdit, vec2};
use std::collections::BTreeMap;

/// What is looked for.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Task {
    /// A kind of node to add.
    Add {
        /// On the canvas.
        at: Pos2,
        /// What it is wired to.
        link: Option<Link>,
        /// Whether a wire was dropped here: its end comes to lie at `at`.
        dropped: bool,
    },
    /// A kind of node to put on a wire, at a place of the canvas.
    Insert(Wire, Pos2),
    /// Another kind for a node.
    Swap(NodeId),
    /// An input for a wire from a node.
    Connect(NodeId),
    /// An input of a node for a wire from an output, with the wire that was lifted off another.
    Input(Socket, Option<Wire>, NodeId),
}

/// What was picked.
#[derive(Clone)]
pub(super) enum FinderChoice {
    /// A kind of node, whether it is wired as the task says, and an input that is set: what was typed is a choice of it.
    Kind(&'static NodeDef, bool, Option<(&'static str, &'static str)>),
    /// A wire from an output to an input, by its node and its number among the node's plugs.
    Plug(Socket, NodeId, usize),
    /// An input, also one that the canvas does not show.
    Input(Socket),
}

/// An open search.
#[derive(Debug)]
pub(super) struct Finder {
    /// What for.
    pub task: Task,
    /// Where it opens, on the screen.
    at: Pos2,
    typed: String,
    chosen: usize,
    fresh: bool,
}

/// One line of the list.
struct Line {
    label: String,
    beside: String,
    tip: String,
    pick: FinderChoice,
}

/// The most lines that are listed.
const MOST: usize = 40;
const WIDTH: f32 = 300.0;

/// What an open search became this frame.
pub(super) enum SearchOutcome {
    /// It stays open.
    Open,
    /// It is closed; with what was picked, if anything was.
    Done(Option<FinderChoice>),
}

impl Finder {
    /// Opens a search at a place of the screen.
    pub(super) fn new(task: Task, at: Pos2) -> Self {
        Self { task, at, typed: String::new(), chosen: 0, fresh: true }
    }

    /// Shows it.
    pub(super) fn show(
        &mut self,
        ui: &egui::Ui,
        document: &Document,
        faces: &Faces,
        recent: &[String],
    ) -> SearchOutcome {
        let ctx = ui.ctx();
        let key = |m: Modifiers, key: Key| ctx.input_mut(|i| i.consume_key(m, key));
        let (up, down) = (key(Modifiers::NONE, Key::ArrowUp), key(Modifiers::NONE, Key::ArrowDown));
        let escape = key(Modifiers::NONE, Key::Escape);
        let alone = key(Modifiers::SHIFT, Key::Enter);
        let enter = key(Modifiers::NONE, Key::Enter) || alone;
        let lines = self.lines(document, faces, recent);
        let last = lines.len().saturating_sub(1);
        self.chosen = self.chosen.min(last);
        if down {
            self.chosen = if self.chosen == last { 0 } else { self.chosen + 1 };
        }
        if up {
            self.chosen = self.chosen.checked_sub(1).unwrap_or(last);
        }
        let mut picked = None;
        // In a small window the answers go before what the keys do.
        let room = panel::room(ctx);
        let hints = room.height() > 200.0;
        let area = Area::new(panel::id("canvas search", ctx))
            .order(Order::Foreground)
            .fixed_pos(self.at)
            .pivot(Align2::LEFT_TOP)
            .constrain_to(room)
            .show(ctx, |ui| {
                Frame::popup(ui.style()).show(ui, |ui| {
                    ui.set_width(WIDTH.min(room.width() - 24.0).max(24.0));
                    self.field(ui);
                    let most =
                        (room.height() - if hints { 110.0 } else { 52.0 }).clamp(16.0, 300.0);
                    self.list(ui, &lines, (up || down, most), &mut picked);
                    if hints {
                        ui.separator();
                        let hint =
                            RichText::new(self.hint(document, lines.get(self.chosen))).small();
                        ui.add(egui::Label::new(hint.color(theme::QUIET.of(ui))).truncate());
                    }
                });
            });
        if enter {
            picked = lines.get(self.chosen).map(|line| line.pick.clone());
        }
        if let (true, Some(FinderChoice::Kind(def, _, set))) = (alone, &picked) {
            return SearchOutcome::Done(Some(FinderChoice::Kind(def, false, *set)));
        }
        let outside = !self.fresh
            && ctx.input(|i| i.pointer.any_pressed())
            && ctx.pointer_latest_pos().is_some_and(|p| !area.response.rect.contains(p));
        self.fresh = false;
        if picked.is_some() || escape || outside {
            return SearchOutcome::Done(picked);
        }
        SearchOutcome::Open
    }

    fn field(&mut self, ui: &mut egui::Ui) {
        let (name, hint) = match &self.task {
            Task::Add { .. } => ("Search nodes", "Add node"),
            Task::Insert(..) => ("Search nodes", "Insert node"),
            Task::Swap(_) => ("Search kinds", "Change to"),
            Task::Connect(_) | Task::Input(..) => ("Search inputs", "Wire to"),
        };
        let field = TextEdit::singleline(&mut self.typed)
            .id(Id::new("canvas search field"))
            .hint_text(hint)
            .desired_width(f32::INFINITY);
        // Before it is shown, so that it takes what was typed since it was asked for.
        ui.memory_mut(|memory| memory.request_focus(Id::new("canvas search field")));
        let response = ui.add(field);
        ui.ctx().accesskit_node_builder(response.id, |node| node.set_label(name));
        if response.changed() {
            self.chosen = 0;
        }
    }

    fn list(
        &self,
        ui: &mut egui::Ui,
        lines: &[Line],
        (moved, most): (bool, f32),
        picked: &mut Option<FinderChoice>,
    ) {
        if lines.is_empty() {
            ui.add_space(4.0);
            ui.label(RichText::new("Nothing matches.").color(theme::QUIET.of(ui)));
        }
        let list = egui::ScrollArea::vertical().max_height(most).min_scrolled_height(16.0);
        let list = list.auto_shrink([false, true]);
        list.show(ui, |ui| {
            ui.spacing_mut().item_spacing.y = 0.0;
            for (i, line) in lines.iter().enumerate() {
                let row = row(ui, line, i == self.chosen).on_hover_text(&line.tip);
                if i == self.chosen && moved {
                    row.scroll_to_me(None);
                }
                if row.clicked() {
                    *picked = Some(line.pick.clone());
                }
            }
        });
    }

    /// What the keys do, in one line.
    fn hint(&self, document: &Document, chosen: Option<&Line>) -> String {
        let places = chosen.and_then(|line| match line.pick {
            FinderChoice::Kind(_, _, Some((PLACES_AT, end))) => Some(end),
            _ => None,
        });
        match &self.task {
            Task::Add { link: Some(Link::From(from)), .. } if places.is_some() => {
                let (end, name) = (places.unwrap_or_default(), document.name_of(&from.node));
                format!("Enter adds it at the {end} of {name}")
            }
            Task::Add { link: Some(Link::From(from)), dropped: false, .. }
                if is_in_chain(document, from) =>
            {
                let name = document.name_of(&from.node);
                format!("Enter inserts after {name}, Shift+Enter branches")
            }
            Task::Add { link: Some(Link::From(from)), .. } => {
                let name = document.name_of(&from.node);
                format!("Enter adds and wires to {name}, Shift+Enter adds alone")
            }
            Task::Add { link: Some(Link::To(to, _)), .. } => {
                let name = document.name_of(&to.node);
                format!("Enter adds and feeds {name}, Shift+Enter adds alone")
            }
            Task::Add { .. } => "Enter adds, Escape closes".to_owned(),
            Task::Insert(..) => "Enter inserts on the wire, Escape closes".to_owned(),
            Task::Swap(_) => "Enter changes the kind; what fits is kept".to_owned(),
            Task::Connect(from) => format!("Enter wires {} to it", document.name_of(from)),
            Task::Input(from, ..) => {
                format!("Enter wires {} to it", document.name_of(&from.node))
            }
        }
    }

    fn lines(&self, document: &Document, faces: &Faces, recent: &[String]) -> Vec<Line> {
        match &self.task {
            Task::Connect(from) => {
                let outputs = faces.all.get(from).map_or(&[][..], |face| &face.outputs);
                let several = outputs.len() > 1;
                let each = outputs.iter().flat_map(|output| {
                    plugs(document, faces, &output.socket, &self.typed, several)
                });
                let mut found: Vec<_> = each.collect();
                found.sort_by_key(|(order, _)| *order);
                found.into_iter().take(MOST).map(|(_, line)| line).collect()
            }
            Task::Input(from, _, node) => faces
                .all
                .get(node)
                .map_or_else(Vec::new, |face| inputs(document, face, from, &self.typed)),
            Task::Add { link, .. } => {
                let fits =
                    |def: &&'static NodeDef| link.as_ref().is_none_or(|l| takes(document, l, def));
                let dropped = matches!(self.task, Task::Add { dropped: true, .. });
                let near = link.as_ref().map(|link| match link {
                    Link::From(socket) | Link::To(socket, _) => &socket.node,
                });
                let hints = Hints { recent, after: followers(document, near) };
                // A wire in the hand wants what it fits; a selected node only proposes.
                let among = coif_nodes::all().filter(|def| !dropped || fits(def));
                let mut found = search::find(&self.typed, among, &hints);
                if !dropped && self.typed.trim().is_empty() {
                    found.sort_by_key(|def| !fits(def));
                }
                let lines = found.into_iter().flat_map(|def| {
                    let link = link.as_ref().filter(|_| fits(&def));
                    by_ends(kind_line(def, &self.typed), link, document, def)
                });
                lines.take(MOST).collect()
            }
            Task::Insert(wire, _) => {
                let Some(from) = wire.from(document) else { return vec![] };
                let near = Some(&from.node);
                let (into, out) = (Link::From(from.clone()), Link::To(wire.to.clone(), None));
                let fits = |def: &&'static NodeDef| {
                    takes(document, &into, def) && takes(document, &out, def)
                };
                let hints = Hints { recent, after: followers(document, near) };
                let found = search::find(&self.typed, coif_nodes::all().filter(fits), &hints);
                found.into_iter().take(MOST).map(|def| kind_line(def, &self.typed)).collect()
            }
            Task::Swap(id) => {
                let old = document.node(id.as_str()).map_or("", |node| node.kind.as_str());
                let among = coif_nodes::all().filter(|def| def.id != old);
                let hints = Hints { recent, after: BTreeMap::new() };
                let found = search::find(&self.typed, among, &hints).into_iter();
                found.take(MOST).map(|def| kind_line(def, &self.typed)).collect()
            }
        }
    }
}

/// Draws a line of the list, over its whole width.
fn row(ui: &mut egui::Ui, shown: &Line, chosen: bool) -> egui::Response {
    let (rect, row) = ui.allocate_exact_size(vec2(ui.available_width(), 24.0), Sense::click());
    row.widget_info(|| {
        egui::WidgetInfo::selected(egui::WidgetType::SelectableLabel, true, chosen, &shown.label)
    });
    if chosen || row.hovered() {
        let fill = if chosen { theme::SELECTED.of(ui) } else { theme::RAISED.of(ui) };
        ui.painter().rect_filled(rect, 3.0, fill);
    }
    let beside = line(ui, &shown.beside, 11.0, theme::QUIET.of(ui), rect.width() / 2.0);
    let room = rect.width() - beside.size().x - 24.0;
    let label = line(ui, &shown.label, 13.0, theme::TEXT.of(ui), room);
    let height = |line: &text::TextLine| rect.center().y - line.size().y / 2.0;
    let at = egui::pos2(rect.right() - 8.0 - beside.size().x, height(&beside));
    beside.show(ui.painter(), at, theme::QUIET.of(ui));
    let at = egui::pos2(rect.left() + 8.0, height(&label));
    label.show(ui.painter(), at, theme::TEXT.of(ui));
    row
}

fn kind_line(def: &'static NodeDef, typed: &str) -> Line {
    let why = search::why(typed, def);
    let set = match why {
        Some(Why::Choice(input, word)) => Some((input, word)),
        _ => None,
    };
    let stage = coif_nodes::STAGES.iter().find(|(_, nodes)| nodes.iter().any(|n| n.id == def.id));
    let doc = def.doc();
    Line {
        label: match why {
            Some(why) => format!("{}: {}", def.label, why.text()),
            None => def.label.to_owned(),
        },
        beside: stage.map_or("", |(stage, _)| stage).to_owned(),
        tip: doc.split("\n\n").next().unwrap_or_default().to_owned(),
        pick: FinderChoice::Kind(def, true, set),
    }
}

/// A kind that takes the wire as places has a line for each end that these may stand at, the tips first where the wire brings braids.
fn by_ends(
    line: Line,
    link: Option<&Link>,
    document: &Document,
    def: &'static NodeDef,
) -> Vec<Line> {
    let Some(Link::From(from)) = link else { return vec![line] };
    let given = wiring::output_type(document, from);
    let taken = given.and_then(|ty| wiring::taking(def, ty));
    let ends = taken.filter(|input| input.name == PLACES).and_then(|_| def.input(PLACES_AT));
    let Some((_, InputDef { ty: Type::Choice(words), .. })) = ends else { return vec![line] };
    let kind = document.node(from.node.as_str()).map(|node| node.kind.as_str());
    let braids = coif_nodes::STAGES
        .iter()
        .any(|(stage, nodes)| *stage == "braid" && nodes.iter().any(|it| Some(it.id) == kind));
    let mut words: Vec<&'static str> = words.iter().map(|(word, _)| *word).collect();
    if braids {
        words.reverse();
    }
    let of = |word: &'static str| Line {
        label: format!("{}: {PLACES_AT} {word}", def.label),
        beside: line.beside.clone(),
        tip: line.tip.clone(),
        pick: FinderChoice::Kind(def, true, Some((PLACES_AT, word))),
    };
    words.into_iter().map(of).collect()
}

/// Whether a kind can be wired so.
fn takes(document: &Document, link: &Link, def: &'static NodeDef) -> bool {
    match link {
        Link::From(from) => {
            wiring::output_type(document, from).is_none_or(|ty| wiring::taking(def, ty).is_some())
        }
        Link::To(to, _) => wiring::input_def(document, to)
            .is_none_or(|input| wiring::giving(def, input.ty).is_some()),
    }
}

/// How often each kind follows the kind of a node, in this document.
fn followers<'a>(document: &'a Document, near: Option<&NodeId>) -> BTreeMap<&'a str, usize> {
    let kind = |id: &NodeId| document.node(id.as_str()).map(|node| node.kind.as_str());
    let Some(near) = near.and_then(kind) else { return BTreeMap::new() };
    let mut after: BTreeMap<&str, usize> = BTreeMap::new();
    for (to, from) in &document.links {
        if let (true, Some(kind)) =
            (from.iter().any(|f| kind(&f.node) == Some(near)), kind(&to.node))
        {
            *after.entry(kind).or_default() += 1;
        }
    }
    after
}

/// How a line stands among others: what fits the letters, what is free, what is of the very type,
/// what is needed.
type Standing = (search::Score, bool, bool, bool);

/// The inputs that an output can be wired to, those that wait for one first.
fn plugs(
    document: &Document,
    faces: &Faces,
    from: &Socket,
    typed: &str,
    name_output: bool,
) -> Vec<(Standing, Line)> {
    let loose = wiring::LooseWire::from_output(document, from.clone());
    let given = wiring::output_type(document, from);
    let mut found = vec![];
    for face in faces.all.values() {
        for (number, plug) in face.inputs.iter().enumerate() {
            if loose.reason(&plug.socket).is_some() {
                continue;
            }
            let mut label = format!("{}: {}", face.label, plug.label());
            let entry =
                SearchEntry { label: &label, id: face.id.as_str(), ..SearchEntry::default() };
            let Some(score) = search::score(typed, &entry) else { continue };
            let here = document.wires(&face.id, &plug.socket.name);
            let wired = plug.wire.and_then(|at| here.get(at));
            if wired == Some(from) {
                continue;
            }
            let beside = match (wired, plug.needed) {
                (Some(from), _) => format!("has {}", document.name_of(&from.node)),
                (None, true) => "needed".to_owned(),
                (None, false) => plug.ty.map_or("", Type::name).to_owned(),
            };
            let tip = face.def.and_then(|def| def.input(&plug.socket.name));
            let tip = tip.map_or(String::new(), |(_, input)| input.doc());
            if name_output {
                label = format!("{} ⏵ {label}", words(&from.name));
            }
            let order = (score, wired.is_some(), plug.ty != given, !plug.needed);
            let pick = FinderChoice::Plug(from.clone(), face.id.clone(), number);
            found.push((order, Line { label, beside, tip, pick }));
        }
    }
    found.sort_by_key(|(order, _)| *order);
    found
}

/// The inputs of a node that take a wire from an output, in their order; those that fit what was typed best first.
fn inputs(document: &Document, face: &Face, from: &Socket, typed: &str) -> Vec<Line> {
    let loose = Loose { fixed: Fixed::Output(from.clone()), lifted: None, held: false };
    let mut found = vec![];
    for socket in loose.taking(document, face) {
        let def = wiring::input_def(document, &socket);
        let label = spoken(&socket.name);
        let entry = SearchEntry {
            label: &label,
            id: &socket.name,
            words: def.map_or("", |input| input.words),
            ..SearchEntry::default()
        };
        let Some(score) = search::score(typed, &entry) else { continue };
        let here = document.wires(&socket.node, &socket.name);
        let beside = match (here.first(), def) {
            (Some(has), _) => format!("has {}", document.name_of(&has.node)),
            (None, def) => def.map_or("", |input| short_name(input.ty)).to_owned(),
        };
        let tip = def.map_or(String::new(), InputDef::doc);
        found.push((score, Line { label, beside, tip, pick: FinderChoice::Input(socket) }));
    }
    found.sort_by_key(|(score, _)| *score);
    found.into_iter().map(|(_, line)| line).collect()
}

/// The name of a type without what explains it in brackets.
pub(super) fn short_name(ty: Type) -> &'static str {
    let name = ty.name();
    name.split(" (").next().unwrap_or(name)
}

/// Whether something takes from an output, so that what is added behind it is inserted.
pub(super) fn is_in_chain(document: &Document, from: &Socket) -> bool {
    document.links.values().any(|wires| wires.contains(from))
}

/// An output or input in words.
pub(super) fn plain(document: &Document, socket: &Socket) -> String {
    format!("{}: {}", document.name_of(&socket.node), words(&socket.name))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rooms::canvas::edits::{self, Behind};
    use crate::rooms::canvas::testing::{document, faces, socket};
    use coif_graphs::document::Setting;
    use coif_nodes::define::Value;

    #[test]
    fn a_dropped_wire_is_offered_only_what_it_fits() {
        let document = document("cornrows");
        let labels = |link: Link, dropped: bool| -> Vec<String> {
            let task = Task::Add { at: Pos2::ZERO, link: Some(link), dropped };
            let finder = Finder::new(task, Pos2::ZERO);
            let lines = finder.lines(&document, &faces(&document), &[]);
            lines.into_iter().map(|line| line.label).collect()
        };
        let scalp = labels(Link::From(socket("head.scalp")), true);
        assert!(scalp.contains(&"Scatter guides".to_owned()), "{scalp:?}");
        assert!(!scalp.contains(&"Resample".to_owned()), "{scalp:?}");
        let feeds = labels(Link::To(socket("rows.scalp"), None), true);
        assert_eq!(feeds, ["Head", "Region", "Partings"]);
        // A selected node proposes what fits, but all can be had.
        let all = labels(Link::From(socket("head.scalp")), false);
        assert_eq!(all.len(), coif_nodes::all().count());
        assert_eq!(all[..scalp.len()].len(), scalp.len());
        // What takes the wire as places is offered at either end.
        let task = Link::From(socket("braid.curves"));
        let ends: Vec<String> =
            labels(task, false).into_iter().filter(|it| it.starts_with("Sphere puff")).collect();
        assert_eq!(ends, ["Sphere puff: at tips", "Sphere puff: at roots"]);
        // There each has room beside the next.
        let def = coif_nodes::by_id("sphere_puff").expect("a kind");
        let (edit, id) = edits::add(&document, def, Pos2::ZERO, (None, Behind::Branch), None);
        let mut after = document.clone();
        edits::and_set(edit, &id, def, Some((PLACES_AT, "tips")))
            .apply(&mut after)
            .expect("it fits");
        let set = |input: &str| after.nodes[&id].inputs.get(input).cloned();
        assert_eq!(set("fit"), Some(Setting::Known(Value::Bool(true))));
        // What follows the node in this groom comes first.
        assert_eq!(labels(Link::From(socket("fill.curves")), true)[0], "Set width");
    }

    #[test]
    fn inputs_that_wait_for_a_wire_come_first() {
        let mut document = document("cornrows");
        document.links.remove(&socket("fill.curves"));
        let plugs = |typed: &str| -> Vec<Line> {
            let found = plugs(&document, &faces(&document), &socket("braid.curves"), typed, false);
            found.into_iter().map(|(_, line)| line).collect()
        };
        let lines = plugs("");
        assert_eq!(lines[0].label, format!("{}: curves", document.name_of(&socket("fill.x").node)));
        assert_eq!(lines[0].beside, "needed");
        assert!(lines.iter().all(|line| !line.label.contains("rows: ")), "a circle is offered");
        assert_eq!(plugs("partings out").len(), 1);
    }
}
