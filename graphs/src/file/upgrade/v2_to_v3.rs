//! Format 2 to 3: makers only make.
//!
//! *Interpolate* and *Cluster to strands* also clumped, shortened, frayed and tapered the hair that they made. Nodes of their own do
//! that now, on any hair: each maker becomes the chain of nodes that gives the same hair. Random lengths of *Interpolate* are the
//! ones that they were; wisps, waves and strays of *Cluster to strands* are drawn anew.

use super::{FormatUpgrade, entries};
use crate::document::{FileEntry, Frame, Node, NodeId, Point, Setting, Socket};
use crate::text::values::placed_value;
use crate::text::write_value;
use coif_nodes::data::field::Field;
use coif_nodes::declared::{self, Interface};
use coif_nodes::define::{Type, Value};
use std::collections::{BTreeMap, BTreeSet};
use std::f32::consts::PI;
use std::sync::Arc;

const INTERPOLATE: &str = "interpolate";
const FILL: &str = "cluster_to_strands";

/// The inputs that these nodes had: type, and value where a file says none.
const FORMER: [(&str, &[(&str, Type, &str)]); 2] = [
    (
        INTERPOLATE,
        &[
            ("clump", Type::Field, "0.0"),
            ("clump_along", Type::Ramp, "Smooth([(0.0, 0.0), (1.0, 1.0)])"),
            ("length_variation", Type::Float, "0.1"),
            ("push_out", Type::Bool, "true"),
        ],
    ),
    (
        FILL,
        &[
            ("profile", Type::Ramp, "Linear([(0.0, 1.0), (1.0, 1.0)])"),
            ("inherit_colour", Type::Bool, "true"),
            ("colour", Type::Colour, "(0.09, 0.05, 0.03)"),
            ("flatness", Type::Field, "1.0"),
            ("flat_angle", Type::Float, "0.0"),
            ("twist", Type::Field, "0.0"),
            ("wisps", Type::Int, "0"),
            ("root_clump", Type::Float, "0.0"),
            ("tip_clump", Type::Float, "0.0"),
            ("width_root", Type::Float, "0.008"),
            ("width_tip", Type::Float, "0.008"),
            ("most_points", Type::Int, "255"),
            ("push_out", Type::Bool, "true"),
            ("length_variation", Type::Float, "0.0"),
            ("jitter", Type::Float, "0.0"),
            ("stray", Type::Float, "0.0"),
            ("stray_amount", Type::Float, "1.0"),
        ],
    ),
];

/// CVs of the strands of *Cluster to strands* where its file does not say any.
const POINTS: f32 = 16.0;
/// Nodes that need a head only for masks, of which they are given none.
const WITHOUT_HEAD: [&str; 2] = ["set_colour", "set_width"];
/// So long a maker's word may be with the word of a new node behind it.
const LONGEST_STEM: usize = 48;
/// The most wisps that a cluster could have.
const MOST_WISPS: f32 = 4096.0;
/// Distance from node to node on the canvas.
const PITCH: f32 = 220.0;

/// The type and the default of an input that a kind of node had.
fn former(kind: &str, input: &str) -> Option<(Type, &'static str)> {
    let (_, inputs) = FORMER.iter().find(|(known, _)| *known == kind)?;
    inputs.iter().find(|(known, ..)| *known == input).map(|(_, ty, default)| (*ty, *default))
}

pub(super) fn former_type(kind: &str, input: &str) -> Option<Type> {
    former(kind, input).map(|(ty, _)| ty)
}

pub(super) fn split_makers(upgrade: &mut FormatUpgrade) {
    let of_kind = |node: &Node| [INTERPOLATE, FILL].into_iter().find(|kind| node.kind == *kind);
    let nodes = upgrade.document.nodes.iter();
    let makers: Vec<(NodeId, &str)> =
        nodes.filter_map(|(id, node)| Some((id.clone(), of_kind(node)?))).collect();
    let mut grown = vec![];
    for (id, kind) in makers {
        let mut chain = Chain::new(upgrade, id, kind);
        match kind {
            FILL => chain.fill(),
            _ => chain.interpolate(),
        }
        chain.tell_rest();
        grown.push(chain.made);
    }
    make_room(upgrade, &grown);
}

/// What an input was set to, or wired to.
#[derive(Clone)]
struct Taken {
    from: Socket,
    setting: Option<Setting>,
    wires: Vec<Socket>,
    bends: Vec<Vec<Point>>,
    /// What it was where nothing is said; none of inputs that the maker still has.
    default: Option<Value>,
}

impl Taken {
    /// The value, if it is one and nothing is wired.
    fn value(&self) -> Option<&Value> {
        match &self.setting {
            Some(Setting::Known(value)) if self.wires.is_empty() => Some(value),
            _ => None,
        }
    }
    /// The number, if it is the same for all hair.
    fn number(&self) -> Option<f32> {
        match self.value()? {
            Value::Float(x) => Some(*x),
            Value::Int(n) => Some(*n as f32),
            Value::Field(field) => field.constant(),
            _ => None,
        }
    }
}

/// Whether an input was set to anything but this number, or wired.
fn is_other(taken: &Option<Taken>, number: f32) -> bool {
    taken.as_ref().is_some_and(|taken| taken.number() != Some(number))
}

fn number_or(taken: &Option<Taken>, unset: f32) -> Option<f32> {
    taken.as_ref().map_or(Some(unset), Taken::number)
}

/// What an input was where nothing is said.
fn default_of(kind: &str, input: &str) -> Option<Value> {
    former(kind, input).and_then(|(ty, text)| placed_value(ty, text).ok())
}

/// A maker and the nodes that are put before and behind it.
struct Made {
    maker: NodeId,
    before: Vec<NodeId>,
    after: Vec<NodeId>,
}

struct Chain<'u, 'd> {
    upgrade: &'u mut FormatUpgrade<'d>,
    kind: &'static str,
    made: Made,
    /// What was taken from the maker and has not come to lie elsewhere, nor been told.
    rest: BTreeMap<Socket, Taken>,
    /// Whether its clusters twist, which gives strands more CVs.
    twisted: bool,
}

impl<'u, 'd> Chain<'u, 'd> {
    fn new(upgrade: &'u mut FormatUpgrade<'d>, maker: NodeId, kind: &'static str) -> Self {
        let made = Made { maker, before: vec![], after: vec![] };
        Self { upgrade, kind, made, rest: BTreeMap::new(), twisted: false }
    }

    /// Takes what an input of the maker has.
    fn take(&mut self, input: &str) -> Option<Taken> {
        let from = Socket::new(self.made.maker.clone(), input);
        let document = &mut self.upgrade.document;
        let wires = document.links.remove(&from).unwrap_or_default();
        let bends = document.bends.remove(&from).unwrap_or_default();
        let node = document.nodes.get_mut(&from.node)?;
        let setting = match node.inputs.contains_key(input) {
            true => Arc::make_mut(node).inputs.remove(input),
            false => None,
        };
        let default = default_of(self.kind, input);
        let there = setting.is_some() || !wires.is_empty();
        let taken = there.then_some(Taken { from, setting, wires, bends, default })?;
        self.rest.insert(taken.from.clone(), taken.clone());
        Some(taken)
    }

    /// The number that an input of the maker was where nothing is said.
    fn unset(&self, input: &str) -> f32 {
        match default_of(self.kind, input) {
            Some(Value::Float(x)) => x,
            Some(Value::Int(n)) => n as f32,
            _ => 0.0,
        }
    }

    /// What an input of the maker has, left there.
    fn read(&self, input: &str) -> Option<Taken> {
        let from = Socket::new(self.made.maker.clone(), input);
        let document = &self.upgrade.document;
        let wires = document.wires(&from.node, input).to_vec();
        let setting = document.node(from.node.as_str())?.inputs.get(input).cloned();
        let there = setting.is_some() || !wires.is_empty();
        there.then_some(Taken { from, setting, wires, bends: vec![], default: None })
    }

    /// Gives an input of a node what another one had.
    fn put(&mut self, to: &NodeId, input: &str, taken: Option<Taken>) {
        let Some(Taken { from, setting, wires, bends, default }) = taken else { return };
        self.rest.remove(&from);
        let socket = Socket::new(to.clone(), input);
        self.upgrade.move_entries(&from, &socket);
        if let Some(default) = default {
            wires.iter().for_each(|wire| self.keep_default(wire, &default));
        }
        if !wires.is_empty() {
            self.upgrade.document.links.insert(socket.clone(), wires);
            self.upgrade.document.set_all_bends(&socket, bends);
        }
        if let (Some(setting), Some(node)) = (setting, self.upgrade.document.nodes.get_mut(to)) {
            Arc::make_mut(node).inputs.insert(input.to_owned(), setting);
        }
    }

    /// Gives a port without a default the one that its reader had: the new reader may have another.
    fn keep_default(&mut self, wire: &Socket, default: &Value) {
        let document = &mut self.upgrade.document;
        let kind = document.node(wire.node.as_str()).map(|node| node.kind.as_str());
        let (holder, is_group) = match kind {
            Some(declared::GROUP_INPUT) => (wire.node.group(), true),
            Some(declared::PARAMETERS) => (Some(wire.node.clone()), false),
            _ => return,
        };
        let Some(holder) = holder else { return };
        let Some(interface) = document.node(holder.as_str()).and_then(|node| node.interface) else {
            return;
        };
        let mut inputs = interface.inputs().to_vec();
        if let Some(port) = inputs.iter_mut().find(|port| *port.name == *wire.name)
            && port.default.is_none()
            && let Ok(value) = placed_value(port.ty, &write_value(default))
        {
            port.default = Some(value);
            if let Ok(interface) = Interface::new(inputs, interface.outputs().to_vec())
                && let Some(node) = document.nodes.get_mut(&holder)
            {
                Arc::make_mut(node).interface = Some(interface);
            }
        }
        // The group's own input may come from a port that has none either. What is wired from elsewhere than beside it is no wire, and
        // could lead in a circle.
        if is_group {
            let outer = document.wires(&holder, &wire.name).iter();
            let outer = outer.filter(|wire| wire.node.group() == holder.group());
            let outer: Vec<Socket> = outer.cloned().collect();
            outer.iter().for_each(|wire| self.keep_default(wire, default));
        }
    }

    /// Tells what was said of the maker and comes to lie nowhere; comments on it stay with the maker.
    fn tell_rest(&mut self) {
        for taken in std::mem::take(&mut self.rest).into_values() {
            let is_default = match (taken.value(), &taken.default) {
                (Some(value), Some(default)) => value.key() == default.key(),
                _ => false,
            };
            if !is_default {
                self.lose(&Some(taken), "it had no effect here: dropped");
            }
        }
        let maker = FileEntry::Node(self.made.maker.clone());
        for (input, ..) in FORMER.iter().flat_map(|(_, inputs)| *inputs) {
            let from = Socket::new(self.made.maker.clone(), input);
            self.upgrade.done.moved.extend(entries(&from).map(|from| (from, maker.clone())));
        }
    }

    /// Drops what says what is so anyway.
    fn drop(&mut self, taken: &Option<Taken>) {
        if let Some(taken) = taken {
            self.rest.remove(&taken.from);
        }
    }

    /// Gives an input of a node what an input of the maker has, which keeps it.
    fn copy(&mut self, input: &str, to: &NodeId, as_input: &str) {
        let Some(taken) = self.read(input) else { return };
        let moved = self.upgrade.done.moved.len();
        self.put(to, as_input, Some(taken));
        self.upgrade.done.moved.truncate(moved);
    }

    /// Sets an input of a node.
    fn set(&mut self, to: &NodeId, input: &str, value: impl Into<Value>) {
        if let Some(node) = self.upgrade.document.nodes.get_mut(to) {
            let setting = Setting::Known(value.into());
            Arc::make_mut(node).inputs.insert(input.to_owned(), setting);
        }
    }

    fn lose(&mut self, taken: &Option<Taken>, why: &str) {
        if let Some(taken) = taken {
            self.rest.remove(&taken.from);
            self.upgrade.lose(&taken.from, taken.wires.is_empty(), why);
        }
    }

    /// A new node beside the maker, called after it.
    fn add(&mut self, kind: &str, word: &str) -> NodeId {
        let maker = &self.made.maker;
        let document = &mut self.upgrade.document;
        let stem: String = maker.word().chars().take(LONGEST_STEM - word.len()).collect();
        // A wire to a node that is not there must not find this one.
        let named: BTreeSet<&NodeId> = document
            .links
            .iter()
            .flat_map(|(to, from)| [to].into_iter().chain(from))
            .map(|it| &it.node)
            .collect();
        let id = (1u32..)
            .map(|n| match n {
                1 => format!("{stem}_{word}"),
                n => format!("{stem}_{word}_{n}"),
            })
            .map(|stem| document.free_id_in(maker.group().as_ref(), &stem))
            .find(|id| !named.contains(id));
        let Some(id) = id else { return maker.clone() };
        let bypass = document.node(maker.as_str()).is_some_and(|node| node.bypass);
        let node = Node { kind: kind.to_owned(), bypass, ..Node::default() };
        document.nodes.insert(id.clone(), Arc::new(node));
        if !WITHOUT_HEAD.contains(&kind) {
            self.copy("scalp", &id, "scalp");
        }
        id
    }

    /// A new node at the end of the chain, which gives what the chain gave.
    fn behind(&mut self, kind: &str, word: &str) -> NodeId {
        let id = self.add(kind, word);
        let last = self.made.after.last().unwrap_or(&self.made.maker).clone();
        let (gave, gives) =
            (Socket::new(last.clone(), "curves"), Socket::new(id.clone(), "curves"));
        let document = &mut self.upgrade.document;
        for wire in document.links.values_mut().flatten().filter(|wire| **wire == gave) {
            *wire = gives.clone();
        }
        document.links.insert(gives, vec![gave]);
        if document.display.as_ref() == Some(&last) {
            document.display = Some(id.clone());
        }
        self.made.after.push(id.clone());
        id
    }

    /// A new node that takes what the maker took for its curves.
    fn before(&mut self, kind: &str, word: &str) -> NodeId {
        let id = self.add(kind, word);
        let curves = self.take("curves");
        self.put(&id, "curves", curves);
        let maker = Socket::new(self.made.maker.clone(), "curves");
        self.upgrade.document.links.insert(maker, vec![Socket::new(id.clone(), "curves")]);
        self.made.before.push(id.clone());
        id
    }

    /// Drops whether hair is pushed out of the skin, which it always is.
    fn push_out(&mut self) {
        let push_out = self.take("push_out");
        if push_out.as_ref().is_some_and(|it| !matches!(it.value(), Some(Value::Bool(true)))) {
            let why = "hair always stays out of the skin, except as deep as the attribute allow_depth of what it is made from: \
                       dropped";
            self.lose(&push_out, why);
        }
    }

    /// *Interpolate*: cut, then clumped to the nearest guide.
    fn interpolate(&mut self) {
        let (variation, unset) = (self.take("length_variation"), self.unset("length_variation"));
        if number_or(&variation, unset) != Some(0.0) {
            let length = self.behind("length", "length");
            self.set(&length, "variation", unset);
            self.put(&length, "variation", variation);
            self.set(&length, "distribution", "even");
            self.copy("seed", &length, "seed");
        } else {
            self.drop(&variation);
        }
        let (amount, along) = (self.take("clump"), self.take("clump_along"));
        if is_other(&amount, 0.0) {
            let clump = self.clump();
            self.put(&clump, "amount", amount);
            self.put(&clump, "along", along);
            self.draw_to_parents(&clump, "guides");
        }
        self.push_out();
    }

    /// A *Clump* that only draws hair together.
    fn clump(&mut self) -> NodeId {
        let clump = self.behind("clump", "clump");
        self.set(&clump, "levels", 1i64);
        self.set(&clump, "strays", 0.0f32);
        self.set(&clump, "keep_length", false);
        clump
    }

    /// Draws hair to the curve that it was made from.
    fn draw_to_parents(&mut self, clump: &NodeId, curves: &str) {
        self.copy(curves, clump, "centres");
        self.set(clump, "attribute", "parent");
    }

    /// *Cluster to strands*: shaped clusters, then clumped, wavy, stray, cut, tapered and coloured strands.
    fn fill(&mut self) {
        let root_radius = self.read("radius").map_or(1.0, |radius| root_radius(&radius));
        self.shape();
        self.wisps(root_radius);
        self.waves();
        let (share, distance) = (self.take("stray"), self.take("stray_amount"));
        if is_other(&share, 0.0) && number_or(&distance, self.unset("stray_amount")) != Some(0.0) {
            let stray = self.behind("stray", "stray");
            self.put(&stray, "share", share);
            self.set(&stray, "distance", self.unset("stray_amount"));
            self.put(&stray, "distance", distance);
            let along = vec![(0.0, 0.0), (0.25, 0.06), (0.5, 0.25), (0.75, 0.56), (1.0, 1.0)];
            self.ramp(&stray, "along", false, along);
            self.set(&stray, "lift", 0.0f32);
            self.set(&stray, "wave", 0.0f32);
            self.free(&stray);
        }
        let variation = self.take("length_variation");
        if is_other(&variation, 0.0) {
            let length = self.behind("length", "length");
            self.put(&length, "variation", variation);
            self.copy("seed", &length, "seed");
        }
        self.widths();
        let (inherit, colour) = (self.take("inherit_colour"), self.take("colour"));
        match inherit.as_ref().map(Taken::value) {
            None | Some(Some(Value::Bool(true))) => {}
            Some(Some(Value::Bool(false))) => {
                self.drop(&inherit);
                let set = self.behind("set_colour", "colour");
                self.put(&set, "tip", colour.clone());
                self.put(&set, "root", colour);
                self.set(&set, "variation", 0.0f32);
            }
            _ => self.lose(
                &inherit,
                "strands have the colour of their cluster; use Set colour for another: dropped",
            ),
        }
        self.points();
        self.push_out();
    }

    /// A modifier that keeps no lengths, with the maker's randomness and units.
    fn free(&mut self, id: &NodeId) {
        self.set(id, "keep_length", false);
        self.copy("seed", id, "seed");
        self.copy("scale_with_head", id, "scale_with_head");
    }

    fn ramp(&mut self, id: &NodeId, input: &str, smooth: bool, stops: Vec<(f32, f32)>) {
        use coif_nodes::data::ramp::{Blend, Ramp};
        let blend = if smooth { Blend::Smooth } else { Blend::Linear };
        if let Ok(ramp) = Ramp::new(blend, stops) {
            self.set(id, input, Value::Ramp(Arc::new(ramp)));
        }
    }

    /// The cross-section of clusters.
    fn shape(&mut self) {
        let (profile, flatness) = (self.take("profile"), self.take("flatness"));
        let (turn, twist) = (self.take("flat_angle"), self.take("twist"));
        let is_level = |ramp: &Value| match ramp {
            Value::Ramp(ramp) => ramp.stops().iter().all(|(_, factor)| *factor == 1.0),
            _ => false,
        };
        let tapers = profile.as_ref().is_some_and(|it| !it.value().is_some_and(is_level));
        self.twisted = is_other(&twist, 0.0);
        let shapes = is_other(&flatness, 1.0) || is_other(&turn, 0.0) || is_other(&twist, 0.0);
        if tapers || shapes {
            let section = self.before("cross_section", "section");
            if tapers {
                let radius = self.take("radius");
                self.put(&section, "radius", radius);
                self.put(&section, "profile", profile);
            } else {
                self.drop(&profile);
            }
            self.put(&section, "flatness", flatness);
            self.put(&section, "turn", turn);
            self.put(&section, "twist", twist);
            self.copy("scale_with_head", &section, "scale_with_head");
        }
    }

    /// Strands drawn together to wisps, or to the middle of the cluster.
    fn wisps(&mut self, root_radius: f32) {
        let (wisps_of, root, tip) =
            (self.take("wisps"), self.take("root_clump"), self.take("tip_clump"));
        if !is_other(&root, 0.0) && !is_other(&tip, 0.0) {
            return;
        }
        let clump = self.clump();
        let share = |taken| number_or(taken, 0.0).map(|x| x.clamp(0.0, 1.0));
        match (share(&root), share(&tip)) {
            (Some(root), Some(tip_share)) if root > 0.0 => {
                let most = root.max(tip_share);
                self.set(&clump, "amount", most);
                self.ramp(&clump, "along", true, vec![(0.0, root / most), (1.0, tip_share / most)]);
                self.drop(&tip);
            }
            (None, Some(0.0)) => {
                self.put(&clump, "amount", root.clone());
                self.ramp(&clump, "along", false, vec![(0.0, 1.0), (1.0, 1.0)]);
            }
            _ => self.put(&clump, "amount", tip),
        }
        if is_other(&root, 0.0) {
            let why = "strands gather from their roots on, and roots stay where they are now: Clump has one amount, and a ramp along \
                       the hair";
            self.lose(&root, why);
        }
        match number_or(&wisps_of, 0.0) {
            Some(wisps) if wisps > 0.0 => {
                let area = PI * root_radius * root_radius;
                let density = wisps.min(MOST_WISPS) / if area > 0.0 { area } else { 1.0 };
                self.set(&clump, "density", density.clamp(0.01, 1000.0));
                self.copy("seed", &clump, "seed");
                self.copy("scale_with_head", &clump, "scale_with_head");
                self.drop(&wisps_of);
            }
            number => {
                if number.is_none() {
                    let why = "Clump takes wisps per square centimetre: set density, and remove centres: dropped";
                    self.lose(&wisps_of, why);
                }
                self.drop(&wisps_of);
                self.draw_to_parents(&clump, "curves");
            }
        }
    }

    fn waves(&mut self) {
        let jitter = self.take("jitter");
        if is_other(&jitter, 0.0) {
            let noise = self.behind("noise", "waves");
            self.put(&noise, "amplitude", jitter);
            self.set(&noise, "together", "hair");
            self.set(&noise, "wavelength", 3.9f32);
            self.set(&noise, "octaves", 1i64);
            self.ramp(&noise, "along", false, vec![(0.0, 0.0), (0.25, 1.0), (1.0, 1.0)]);
            self.free(&noise);
        }
    }

    fn widths(&mut self) {
        let (root, tip) = (self.take("width_root"), self.take("width_tip"));
        let unset = self.unset("width_root");
        let ends = [&root, &tip].map(|width| number_or(width, unset));
        let maker = self.made.maker.clone();
        if ends[0].is_some() && ends[0] == ends[1] {
            self.put(&maker, "width", root);
            self.drop(&tip);
            return;
        }
        self.put(&maker, "width", root.clone());
        let set = self.behind("set_width", "width");
        self.set(&set, "root", unset);
        self.set(&set, "tip", unset);
        self.put(&set, "root", root);
        self.put(&set, "tip", tip);
    }

    /// The most CVs that strands may have.
    fn points(&mut self) {
        let (most, unset) = (self.take("most_points"), self.unset("most_points"));
        let limit = number_or(&most, unset);
        let asked = number_or(&self.read("points"), POINTS);
        if let (Some(limit), Some(asked)) = (limit, asked)
            && asked > limit
        {
            let maker = self.made.maker.clone();
            self.set(&maker, "points", limit as i64);
        }
        // Of strands whose number of CVs is known, and which a twist gives no more, a lower limit still holds.
        let holds = limit.is_some_and(|limit| limit < unset) && asked.is_some() && !self.twisted;
        if is_other(&most, unset) && !holds {
            let why = "strands have as many CVs as points says, and twisted ones up to 255: use Resample for another limit: dropped";
            self.lose(&most, why);
        }
        self.drop(&most);
    }
}

/// The radius at the root of clusters whose own is 1 cm.
fn root_radius(taken: &Taken) -> f32 {
    fn at_root(field: &Field) -> f32 {
        match field {
            Field::Constant(x) => *x,
            Field::Ramp(ramp) => ramp.at(0.0),
            Field::Product(parts) => parts.iter().map(at_root).product(),
            _ => 1.0,
        }
    }
    match taken.value() {
        Some(Value::Float(x)) => *x,
        Some(Value::Field(field)) => at_root(field),
        _ => 1.0,
    }
}

/// Places new nodes in a row with their makers, and moves what stands to the right of them out of the way.
fn make_room(upgrade: &mut FormatUpgrade, grown: &[Made]) {
    let document = &mut upgrade.document;
    let mut groups: BTreeMap<Option<NodeId>, Vec<(&Made, Point)>> = BTreeMap::new();
    for made in grown {
        if let Some(at) = document.layout.get(&made.maker).filter(|at| at.is_finite()) {
            groups.entry(made.maker.group()).or_default().push((made, *at));
        }
    }
    for (group, mut makers) in groups {
        makers.sort_by(|a, b| b.1.0.total_cmp(&a.1.0));
        // Makers that stand above each other share what is moved: the rightmost columns first.
        for column in makers.chunk_by(|a, b| a.1.0 - b.1.0 < PITCH / 2.0) {
            let count = |(made, _): &(&Made, Point)| made.before.len() + made.after.len();
            let more = column.iter().map(count).max().unwrap_or(0) as f32 * PITCH;
            let right = column[0].1.0;
            let beyond = |x: f32| if x > right { x + more } else { x };
            for (_, at) in document.layout.iter_mut().filter(|(id, _)| id.group() == group) {
                at.0 = beyond(at.0);
            }
            let bends = document.bends.iter_mut().filter(|(to, _)| to.node.group() == group);
            bends.flat_map(|(_, wires)| wires.iter_mut().flatten()).for_each(|bend| {
                bend.0 = beyond(bend.0);
            });
            let frames = document.frames.values_mut().filter(|_| group.is_none());
            frames.for_each(|frame: &mut Frame| {
                let end = beyond(frame.at.0 + frame.size.0);
                frame.at.0 = beyond(frame.at.0);
                frame.size.0 = end - frame.at.0;
            });
        }
        for (made, _) in makers {
            let Some(&Point(x, y)) = document.layout.get(&made.maker) else { continue };
            let row = made.before.iter().chain([&made.maker]).chain(&made.after);
            for (k, id) in row.enumerate() {
                document.layout.insert(id.clone(), Point(x + k as f32 * PITCH, y));
            }
        }
    }
}
