//! Facts and changes in words: for the file as files write them, for people as a groomer says them.
//!
//! Guarantees: what changed is told in short lines, however much it is. Not guaranteed: that names and texts steer no terminal; whoever
//! prints escapes them.

use super::diff::{Change, Drawn, changes, diff, drawn, value};
use super::fact::{Fact, Limit, Said, facts};
use super::follow::led_to;
use super::lists::{is_in_one_order, numbered};
use crate::document::{Document, FileEntry, NodeId, SavedLook, Setting, Socket};
use crate::text::write_value;
use coif_nodes::data::gestures::{Gestures, Tool};
use coif_nodes::declared::{Interface, Port};
use coif_nodes::define::{Type, Value, short};
use std::collections::{BTreeMap, BTreeSet};
use std::fmt;

/// A text on one line: white space is one space, what would steer a terminal is escaped.
pub(super) fn one_line(text: &str) -> String {
    let words: Vec<&str> = text.split_whitespace().collect();
    let mut line = String::new();
    for c in words.join(" ").chars() {
        if c.is_control() { line.extend(c.escape_default()) } else { line.push(c) }
    }
    line
}

/// The first letters of a text.
pub(super) fn cut(text: &str, most: usize) -> String {
    match text.char_indices().nth(most) {
        Some((at, _)) => format!("{}…", &text[..at]),
        None => text.to_owned(),
    }
}

impl fmt::Display for Fact {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Fact::Title => write!(f, "title"),
            Fact::Note => write!(f, "note"),
            Fact::Seed => write!(f, "seed"),
            Fact::Display => write!(f, "display"),
            Fact::Budget(term) => write!(f, "budget: {term}"),
            Fact::Look => write!(f, "look"),
            Fact::Thumbnail => write!(f, "thumbnail"),
            Fact::Kind(id) => write!(f, "{id}: kind"),
            Fact::Label(id) => write!(f, "{id}: label"),
            Fact::NodeNote(id) => write!(f, "{id}: note"),
            Fact::Bypass(id) => write!(f, "{id}: bypass"),
            Fact::Ports(id) => write!(f, "{id}: interface"),
            Fact::Template(id) => write!(f, "{id}: template"),
            Fact::Input(id, name) => write!(f, "{id}.{name}"),
            Fact::Wires(to) => write!(f, "wires of {to}"),
            Fact::Frame(name) => write!(f, "frame {name:?}"),
            Fact::View(name) => write!(f, "view {name:?}"),
            Fact::Layout(id) => write!(f, "{id}: place on the canvas"),
            Fact::Collapsed(id) => write!(f, "{id}: drawn small"),
            Fact::Comment(place) => {
                let node = self.node().map_or_else(String::new, |id| format!(" of {id}"));
                let (FileEntry::Frame(name)
                | FileEntry::View(name)
                | FileEntry::Field(name)
                | FileEntry::NodeField(_, name)
                | FileEntry::Input(_, name)) = place
                else {
                    return write!(f, "comment{node}");
                };
                write!(f, "comment before {name}{node}")
            }
        }
    }
}

impl Fact {
    /// What it is where a document says nothing of it.
    pub(super) fn unsaid(&self) -> &'static str {
        match self {
            Fact::Input(..) => "not set",
            Fact::Wires(_) => "not wired",
            Fact::Seed => "0",
            Fact::Bypass(_) => "off",
            _ => "none",
        }
    }
}

/// What is said, as files write it, on as many lines as it likes.
pub(super) fn plain(said: &Said) -> String {
    match said {
        Said::Yes => "on".to_owned(),
        Said::Text(text) => write_value(&Value::Text(text.as_str().into())),
        Said::Seed(seed) => seed.to_string(),
        Said::Node(id) => id.to_string(),
        Said::Setting(Setting::Known(value)) => write_value(value),
        Said::Setting(Setting::Raw(text)) => text.to_string(),
        Said::Wires(_) => said.sources().map(ToString::to_string).collect::<Vec<_>>().join(" and "),
        Said::Frame(frame) => format!(
            "{:?} of colour {} at ({:?}, {:?})",
            frame.text, frame.colour, frame.at.0, frame.at.1
        ),
        Said::View(view) => {
            format!("eye {:?}, target {:?}, focal_mm {:?}", view.eye, view.target, view.focal_mm)
        }
        Said::Thumbnail(thumbnail) => thumbnail.to_string(),
        Said::Limit(Limit(term, x)) => term.amount(*x),
        Said::Look(SavedLook { light, exposure, turn, skin }) => {
            let turn = if *turn == 0.0 { String::new() } else { format!("turned {turn:?}°, ") };
            format!("light {light:?}, exposure {exposure:?}, {turn}skin {skin:?}")
        }
        Said::Ports(ports) => {
            let one = |port: &Port| {
                let default = port.default.as_ref();
                let default = default.map(|value| format!(" = {}", short(&write_value(value))));
                let range = port.hard.map(|(lo, hi)| format!(" in {lo} to {hi}"));
                [port.name.clone()].into_iter().chain(default).chain(range).collect::<String>()
            };
            let side = |ports: &[Port]| ports.iter().map(one).collect::<Vec<_>>().join(", ");
            format!("{} -> {}", side(ports.inputs()), side(ports.outputs()))
        }
        Said::Template(it) => format!("{} {}", it.name, it.version).trim().to_owned(),
        Said::At(at) => format!("({:?}, {:?})", at.0, at.1),
        Said::Lines(lines) => lines.join(" "),
    }
}

impl Said {
    /// What is said, as files write it.
    pub fn text(&self) -> String {
        plain(self)
    }
}

/// A line on what changed.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ChangeLine {
    /// The node that it is about, if it is about one.
    pub node: Option<NodeId>,
    /// What changed.
    pub text: String,
}

/// All that changed from `a` to `b`, a line each, as a groomer says it: the document's own, then node by node, then what stands
/// beside. Where things stand on the canvas is told in numbers, and only where `all` is asked for.
pub fn lines(a: &Document, b: &Document, all: bool) -> Vec<String> {
    change_lines(a, b, &diff(a, b), all).into_iter().map(|line| line.text).collect()
}

/// The same of changes that are known, each with the node that it is about.
pub fn change_lines(a: &Document, b: &Document, changes: &[Change], all: bool) -> Vec<ChangeLine> {
    let telling = Telling { a, b };
    // A port that has another name now is still the same.
    let ports = changes.iter().any(|change| matches!(change.fact, Fact::Ports(_)));
    let followed = match ports {
        true => {
            let [before, after] = [facts(a), facts(b)];
            self::changes(&led_to(&before, &after), &after)
        }
        false => vec![],
    };
    let changes = if ports { &followed } else { changes };
    let of_none = |text: String| ChangeLine { node: None, text };
    let mut of_node = BTreeMap::<&NodeId, Vec<&Change>>::new();
    let (mut before, mut behind, mut comments) = (vec![], vec![], 0);
    for change in changes {
        match &change.fact {
            Fact::Layout(_) | Fact::Collapsed(_) => {}
            Fact::Comment(_) => comments += 1,
            Fact::Frame(name) => {
                behind.push(of_none(format!("frame {:?}: {}", short(name), became(change))));
            }
            Fact::View(name) => {
                behind.push(of_none(format!("view {:?}: {}", short(name), became(change))));
            }
            fact => match fact.node() {
                Some(id) => of_node.entry(id).or_default().push(change),
                None => before.push(of_none(telling.of_document(change))),
            },
        }
    }
    // What came or went with a group is told by the group.
    let whole = |id: &NodeId| {
        of_node.get(id).into_iter().flatten().any(|change| {
            matches!(change.fact, Fact::Kind(_)) && (change.from.is_none() || change.to.is_none())
        })
    };
    let with_group = |id: &NodeId| {
        whole(id) && std::iter::successors(id.group(), NodeId::group).any(|group| whole(&group))
    };
    let alone: BTreeSet<&NodeId> = of_node.keys().copied().filter(|id| with_group(id)).collect();
    of_node.retain(|id, _| !alone.contains(*id));
    let nodes = of_node.into_iter().flat_map(|(id, changes)| {
        let texts = telling.of_node(id, &changes).into_iter();
        texts.map(|text| ChangeLine { node: Some(id.clone()), text })
    });
    let mut lines: Vec<ChangeLine> = before.into_iter().chain(nodes).chain(behind).collect();
    lines.extend(
        (comments > 0).then(|| of_none(format!("{} changed", counted(comments, "comment")))),
    );
    if all {
        lines.extend(on_the_canvas(changes).into_iter().map(of_none));
    }
    lines
}

/// So many of something, whose plural ends in s.
fn counted(count: usize, one: &str) -> String {
    format!("{count} {one}{}", if count == 1 { "" } else { "s" })
}

fn became(change: &Change) -> &'static str {
    match (&change.from, &change.to) {
        (None, _) => "added",
        (_, None) => "removed",
        _ => "changed",
    }
}

/// What stands elsewhere, in numbers.
fn on_the_canvas(changes: &[Change]) -> Vec<String> {
    let is_bent = |change: &&Change| match (&change.from, &change.to) {
        (Some(from), Some(to)) => {
            matches!(change.fact, Fact::Wires(_)) && from.sources().eq(to.sources())
        }
        _ => false,
    };
    let count = |of: &dyn Fn(&&Change) -> bool| changes.iter().filter(of).count();
    let said = [
        (count(&|c| matches!(c.fact, Fact::Layout(_))), "node", "moved on the canvas"),
        (count(&|c| matches!(c.fact, Fact::Collapsed(_))), "node", "drawn small or whole again"),
        (count(&is_bent), "input", "with wires bent otherwise"),
    ];
    let said = said.into_iter().filter(|(count, ..)| *count > 0);
    said.map(|(count, one, what)| format!("{} {what}", counted(count, one))).collect()
}

/// Two documents, and how people call what is in them.
struct Telling<'a> {
    a: &'a Document,
    b: &'a Document,
}

impl Telling<'_> {
    /// A node by the name that people know, of the later document where it has it, behind those of the groups that it lies in.
    fn name(&self, id: &NodeId) -> String {
        let of = if self.b.nodes.contains_key(id) { self.b } else { self.a };
        let own = short(&of.name_of(id));
        id.group().map_or(own.clone(), |group| format!("{}/{own}", self.name(&group)))
    }

    fn kind(document: &Document, id: &NodeId) -> String {
        let kind = document.node(id.as_str()).map_or("", |node| &node.kind);
        let label = document.def(id).map_or_else(|| short(kind), |def| def.label.to_owned());
        match document.inside(id).count() {
            0 => label,
            n => format!("{label} of {}", counted(n, "node")),
        }
    }

    fn of_document(&self, change: &Change) -> String {
        let said = |said: &Option<Said>| match said {
            None => change.fact.unsaid().to_owned(),
            Some(Said::Node(id)) => self.name(id),
            Some(said) => short(&plain(said)),
        };
        let (from, to) = (said(&change.from), said(&change.to));
        match change.fact {
            Fact::Display => format!("shown: {from} to {to}"),
            Fact::Budget(term) => format!("budget: {term} {from} to {to}"),
            _ => format!("{}: {from} to {to}", change.fact.named().0),
        }
    }

    /// What changed of a node; of one that came or went, that it did.
    fn of_node(&self, id: &NodeId, changes: &[&Change]) -> Vec<String> {
        let name = self.name(id);
        let kind = changes.iter().find(|change| matches!(change.fact, Fact::Kind(_)));
        match kind.map(|kind| (&kind.from, &kind.to)) {
            Some((None, _)) => {
                let wires = changes.iter().filter_map(|change| change.to.as_ref());
                let from: BTreeSet<String> =
                    wires.flat_map(Said::sources).map(|from| self.name(&from.node)).collect();
                let fed = match from.is_empty() {
                    true => String::new(),
                    false => {
                        format!(", fed by {}", from.into_iter().collect::<Vec<_>>().join(", "))
                    }
                };
                return vec![format!("{name}: added ({}){fed}", Self::kind(self.b, id))];
            }
            Some((_, None)) => {
                return vec![format!("{name}: removed ({})", Self::kind(self.a, id))];
            }
            _ => {}
        }
        let lines =
            changes.iter().flat_map(|change| match (&change.fact, &change.from, &change.to) {
                (Fact::Ports(_), Some(Said::Ports(from)), Some(Said::Ports(to))) => {
                    of_interface(&name, *from, *to)
                }
                _ => self.of_fact(id, &name, change).into_iter().collect(),
            });
        lines.collect()
    }

    fn of_fact(&self, id: &NodeId, name: &str, change: &Change) -> Option<String> {
        let text = |said: &Option<Said>| {
            said.as_ref().map_or_else(|| "none".to_owned(), |said| short(&plain(said)))
        };
        let (from, to) = (text(&change.from), text(&change.to));
        Some(match &change.fact {
            Fact::Kind(_) => {
                let (from, to) = (Self::kind(self.a, id), Self::kind(self.b, id));
                format!("{name}: {from} is now {to}")
            }
            Fact::Label(_) => format!("{name}: called {to}, before {from}"),
            Fact::NodeNote(_) => format!("{name}: note {from} to {to}"),
            Fact::Bypass(_) if change.to.is_some() => format!("{name}: bypassed"),
            Fact::Bypass(_) => format!("{name}: bypassed no longer"),
            Fact::Input(_, input) => match drawn(change) {
                Some(drawn) => format!("{name}: {}", of_drawn(input, change, &drawn)),
                None => {
                    let from = self.value(self.a, id, input, &change.from);
                    let to = self.value(self.b, id, input, &change.to);
                    format!("{name}: {} {from} to {to}", short(&input.replace('_', " ")))
                }
            },
            Fact::Wires(to) => return self.of_wires(name, to, change),
            Fact::Ports(_) => format!("{name}: interface {}", became(change)),
            Fact::Template(_) if from == to => format!("{name}: template {to} {}", became(change)),
            Fact::Template(_) => format!("{name}: template {from} to {to}"),
            _ => return None,
        })
    }

    /// An input by the name that one of the documents has for it, where the later one calls it so.
    fn called<'n>(&self, of: &Document, id: &NodeId, input: &'n str) -> &'n str {
        let is_of = |name: &str| of.def(id).is_some_and(|def| def.input(name).is_some());
        let old = self.b.def(id).and_then(|def| def.input(input));
        let old = old.into_iter().flat_map(|(_, input)| input.old_names.iter().copied());
        if is_of(input) { input } else { old.into_iter().find(|name| is_of(name)).unwrap_or(input) }
    }

    /// A value with its unit; of an input that is not set, its default.
    fn value(&self, of: &Document, id: &NodeId, input: &str, said: &Option<Said>) -> String {
        let input = self.called(of, id, input);
        let def = of.def(id).and_then(|def| def.input(input));
        let Some(value) = value(of, id, input, said) else {
            return said.as_ref().map_or_else(|| "not set".to_owned(), |said| short(&plain(said)));
        };
        let unit = def.map_or("", |(_, input)| input.unit.suffix());
        let text = match &value {
            Value::Float(x) if *x == 0.0 || (1e-4..1e7).contains(&x.abs()) => format!("{x}{unit}"),
            Value::Int(x) => format!("{x}{unit}"),
            Value::Bool(on) => if *on { "on" } else { "off" }.to_owned(),
            Value::Text(word) if def.is_some_and(|(_, i)| matches!(i.ty, Type::Choice(_))) => {
                short(word)
            }
            value => short(&write_value(value)),
        };
        if said.is_none() { format!("{text} (default)") } else { text }
    }

    /// Where a wire came from and where it comes from; none where only its bends changed.
    fn of_wires(&self, name: &str, to: &Socket, change: &Change) -> Option<String> {
        let sources = |said: &Option<Said>| -> Vec<Socket> {
            said.iter().flat_map(Said::sources).cloned().collect()
        };
        let (from, now) = (sources(&change.from), sources(&change.to));
        if from == now {
            return None;
        }
        let input = short(&to.name);
        if from.len() <= 1 && now.len() <= 1 {
            let one = |all: &[Socket]| all.first().map_or("nothing".to_owned(), |s| self.source(s));
            return Some(format!("{name}.{input}: from {} to {}", one(&from), one(&now)));
        }
        let (from, now) = (numbered(from.into_iter()), numbered(now.into_iter()));
        let only = |here: &[(Socket, usize)], there: &[(Socket, usize)], what: &str| {
            let there: BTreeSet<_> = there.iter().collect();
            let only = here.iter().filter(|wire| !there.contains(wire));
            let only: Vec<String> = only.map(|(wire, _)| self.source(wire)).collect();
            match only.len() {
                0 => None,
                1..=5 => Some(format!("{what} {}", only.join(", "))),
                n => Some(format!("{what} {} and {} more", only[..3].join(", "), n - 3)),
            }
        };
        let order = (!is_in_one_order(&from, &now)).then(|| "in another order".to_owned());
        let parts = [only(&now, &from, "also from"), only(&from, &now, "no longer from"), order];
        Some(format!(
            "{name}.{input}: {}",
            parts.into_iter().flatten().collect::<Vec<_>>().join("; ")
        ))
    }

    /// The node that a wire comes from, with its output where it gives several.
    fn source(&self, socket: &Socket) -> String {
        let of = if self.b.nodes.contains_key(&socket.node) { self.b } else { self.a };
        let name = self.name(&socket.node);
        match of.def(&socket.node).is_some_and(|def| def.outputs.len() == 1) {
            true => name,
            false => format!("{name}.{}", short(&socket.name)),
        }
    }
}

/// What changed of an interface, port by port.
fn of_interface(name: &str, from: Interface, to: Interface) -> Vec<String> {
    let sides = [("input", from.inputs(), to.inputs()), ("output", from.outputs(), to.outputs())];
    let mut lines = vec![];
    for (side, before, after) in sides {
        let before_of = |port: &Port| {
            let same = before.iter().find(|old| old.name == port.name);
            same.or_else(|| before.iter().find(|old| port.was.contains(&old.name)))
        };
        let gone = |old: &&Port| {
            !after.iter().any(|port| before_of(port).is_some_and(|it| it.name == old.name))
        };
        lines.extend(
            before.iter().filter(gone).map(|old| format!("{name}: {side} {} removed", old.name)),
        );
        for port in after {
            match before_of(port) {
                None => {
                    lines.push(format!("{name}: {side} {} added ({})", port.name, port.ty.name()))
                }
                Some(old) => {
                    let what = of_port(old, port);
                    if !what.is_empty() {
                        lines.push(format!("{name}: {side} {} {}", old.name, what.join(", ")));
                    }
                }
            }
        }
        let kept = |ports: &[Port], there: &dyn Fn(&Port) -> Option<String>| -> Vec<String> {
            ports.iter().filter_map(there).collect()
        };
        let old_order = kept(before, &|old| (!gone(&old)).then(|| old.name.clone()));
        let new_order = kept(after, &|port| before_of(port).map(|old| old.name.clone()));
        if old_order != new_order {
            lines.push(format!("{name}: {side}s in another order"));
        }
    }
    lines
}

/// What changed of a port.
fn of_port(old: &Port, new: &Port) -> Vec<String> {
    let mut what = vec![];
    let mut say = |of: &str, from: String, to: String| {
        if from != to {
            what.push(format!("{of} {from} to {to}"));
        }
    };
    let range = |range: Option<(f64, f64)>| {
        range.map_or_else(|| "none".to_owned(), |(lo, hi)| format!("{lo} to {hi}"))
    };
    let value = |port: &Port| {
        port.default.as_ref().map_or_else(|| "none".to_owned(), |value| short(&write_value(value)))
    };
    say("called", old.name.clone(), new.name.clone());
    say("type", format!("{:?}", old.ty), format!("{:?}", new.ty));
    say("default", value(old), value(new));
    say("range", range(old.hard), range(new.hard));
    say("slider", range(old.soft), range(new.soft));
    say("unit", format!("{:?}", old.unit), format!("{:?}", new.unit));
    say("section", short(&old.section), short(&new.section));
    if old.arity != new.arity {
        what.push("takes another number of values".to_owned());
    }
    if old.doc != new.doc {
        what.push("explained otherwise".to_owned());
    }
    // A default may differ in what is not shown of it.
    let key = |port: &Port| port.default.as_ref().map(Value::key);
    if what.is_empty() && key(old) != key(new) {
        what.push("has another default".to_owned());
    }
    if what.is_empty() && old.was != new.was {
        what.push("had other names before".to_owned());
    }
    what
}

/// Strokes and gestures, by their number.
fn of_drawn(input: &str, change: &Change, drawn: &Drawn) -> String {
    let word = drawn.word;
    let mut parts = match &change.to {
        Some(Said::Setting(Setting::Known(Value::Gestures(all)))) => by_tool(all, &drawn.added),
        _ => vec![(drawn.added.len(), "drawn")],
    };
    parts.push((drawn.removed.len(), "removed"));
    let moved: Vec<f32> = drawn.changed.iter().filter_map(|(_, moved)| *moved).collect();
    let otherwise = drawn.changed.len() - moved.len();
    parts.retain(|(count, _)| *count > 0);
    // The first says what they are.
    let mut said: Vec<String> = vec![];
    let mut say = |count: usize, what: String| {
        said.push(match said.is_empty() {
            true => format!("{} {what}", counted(count, word)),
            false => format!("{count} {what}"),
        });
    };
    parts.into_iter().for_each(|(count, what)| say(count, what.to_owned()));
    if let Some(most) = moved.iter().copied().max_by(f32::total_cmp) {
        let by = if moved.len() == 1 { "by" } else { "by up to" };
        say(moved.len(), format!("moved {by} {most:.2} cm"));
    }
    if otherwise > 0 {
        say(otherwise, "changed".to_owned());
    }
    if drawn.is_reordered {
        said.push(format!("{word}s in another order"));
    }
    if said.is_empty() {
        // An empty list and none are two things to a file.
        said.push(format!("{} {}", short(&input.replace('_', " ")), became(change)));
    }
    said.join(", ")
}

/// Added gestures by what their tools do, in the order of the shelf.
fn by_tool(all: &Gestures, added: &[u64]) -> Vec<(usize, &'static str)> {
    let added: BTreeSet<u64> = added.iter().copied().collect();
    let of = |tool: Tool| all.0.iter().filter(|g| g.tool == tool && added.contains(&g.id)).count();
    Tool::ALL.iter().map(|(tool, _)| (of(*tool), done(*tool))).collect()
}

/// What a tool has done.
fn done(tool: Tool) -> &'static str {
    match tool {
        Tool::Implant => "implanted",
        Tool::Lengthen => "lengthened",
        Tool::Cut => "cut",
        Tool::Density => "filled",
        Tool::Twist => "twisted",
        Tool::Frizz => "frizzed",
        Tool::Comb => "combed",
        Tool::Pin => "pinned",
        Tool::Smooth => "smoothed",
        Tool::Puff => "puffed",
        Tool::Grab => "grabbed",
        Tool::Straighten => "straightened",
        Tool::Point => "pulled",
        Tool::Redraw => "re-drawn",
        Tool::Scatter => "scattered",
        Tool::Silhouette => "outlined",
    }
}
