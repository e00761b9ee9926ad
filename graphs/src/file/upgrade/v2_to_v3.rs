//! Format 2 to 3: makers only make.
//!
//! *Interpolate* and *Cluster to strands* also clumped, shortened, frayed and tapered the hair that they made. Nodes of their own do
//! that now, on any hair: each maker becomes the chain of nodes that gives the same hair. Random lengths of *Interpolate* are the
//! ones that they were; wisps, waves and strays of *Cluster to strands* are drawn anew.

use super::FormatUpgrade;
use crate::document::{FileEntry, Frame, Node, NodeId, Point, Setting, Socket};
use crate::text::values::placed_value;
use coif_nodes::data::field::Field;
use coif_nodes::define::{Type, Value};
use std::collections::BTreeMap;
use std::f32::consts::PI;
use std::sync::Arc;

const INTERPOLATE: &str = "interpolate";
const FILL: &str = "cluster_to_strands";

/// The inputs that these nodes had.
const FORMER: [(&str, &[&str]); 2] = [
    (INTERPOLATE, &["clump", "clump_along", "length_variation", "push_out"]),
    (
        FILL,
        &[
            "profile",
            "inherit_colour",
            "colour",
            "flatness",
            "flat_angle",
            "twist",
            "wisps",
            "root_clump",
            "tip_clump",
            "width_root",
            "width_tip",
            "most_points",
            "push_out",
            "length_variation",
            "jitter",
            "stray",
            "stray_amount",
        ],
    ),
];

/// Shortening of *Interpolate* where its file does not say any.
const LENGTH_VARIATION: f32 = 0.1;
/// Both widths of *Cluster to strands* where its file does not say any, cm.
const WIDTH: f32 = 0.008;
/// CVs of its strands, and the most that they could have.
const POINTS: f32 = 16.0;
const MOST_POINTS: f32 = 255.0;
/// Nodes that need a head only for masks, of which they are given none.
const WITHOUT_HEAD: [&str; 2] = ["set_colour", "set_width"];
/// Distance from node to node on the canvas.
const PITCH: f32 = 220.0;

pub(super) fn is_former(kind: &str, input: &str) -> bool {
    FORMER.iter().any(|(known, inputs)| *known == kind && inputs.contains(&input))
}

pub(super) fn split_makers(upgrade: &mut FormatUpgrade) {
    let of_kind = |kind: &str| FORMER.iter().any(|(known, _)| *known == kind);
    let nodes = upgrade.document.nodes.iter().filter(|(_, node)| of_kind(&node.kind));
    let makers: Vec<(NodeId, bool)> =
        nodes.map(|(id, node)| (id.clone(), node.kind == FILL)).collect();
    let mut grown = vec![];
    for (id, fills) in makers {
        let mut chain = Chain::new(upgrade, id);
        if fills {
            chain.fill()
        } else {
            chain.interpolate()
        }
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
}

impl Taken {
    /// The value as this type, if it is set and nothing is wired.
    fn value(&self, ty: Type) -> Option<Value> {
        let setting = self.setting.as_ref().filter(|_| self.wires.is_empty())?;
        match setting {
            Setting::Known(value) => Some(value.clone()),
            Setting::Raw(text) => placed_value(ty, text).ok(),
        }
    }
    /// The number, if it is the same for all hair.
    fn number(&self) -> Option<f32> {
        match self.value(Type::Field)? {
            Value::Float(x) => Some(x),
            Value::Int(n) => Some(n as f32),
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

/// A maker and the nodes that are put before and behind it.
struct Made {
    maker: NodeId,
    before: Vec<NodeId>,
    after: Vec<NodeId>,
}

struct Chain<'u, 'd> {
    upgrade: &'u mut FormatUpgrade<'d>,
    made: Made,
}

impl<'u, 'd> Chain<'u, 'd> {
    fn new(upgrade: &'u mut FormatUpgrade<'d>, maker: NodeId) -> Self {
        Self { upgrade, made: Made { maker, before: vec![], after: vec![] } }
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
        (setting.is_some() || !wires.is_empty()).then_some(Taken { from, setting, wires, bends })
    }

    /// What an input of the maker has, left there.
    fn read(&self, input: &str) -> Option<Taken> {
        let from = Socket::new(self.made.maker.clone(), input);
        let document = &self.upgrade.document;
        let wires = document.wires(&from.node, input).to_vec();
        let setting = document.node(from.node.as_str())?.inputs.get(input).cloned();
        let there = setting.is_some() || !wires.is_empty();
        there.then_some(Taken { from, setting, wires, bends: vec![] })
    }

    /// Gives an input of a node what another one had.
    fn put(&mut self, to: &NodeId, input: &str, taken: Option<Taken>) {
        let Some(Taken { from, setting, wires, bends }) = taken else { return };
        let socket = Socket::new(to.clone(), input);
        let entry =
            |socket: &Socket| FileEntry::Input(socket.node.clone(), socket.name.to_string());
        let done = &mut self.upgrade.done;
        done.moved.push((entry(&from), entry(&socket)));
        done.moved.push((FileEntry::Link(from.clone()), FileEntry::Link(socket.clone())));
        if !wires.is_empty() {
            self.upgrade.document.links.insert(socket.clone(), wires);
            self.upgrade.document.set_all_bends(&socket, bends);
        }
        let Some(node) = self.upgrade.document.nodes.get_mut(to) else { return };
        let ty = coif_nodes::by_id(&node.kind).and_then(|def| def.input(input)).map(|it| it.1.ty);
        let setting = match (setting, ty) {
            (Some(Setting::Raw(text)), Some(ty)) => match placed_value(ty, &text) {
                Ok(value) => Some(Setting::Known(value)),
                Err(wrong) => {
                    self.upgrade.lose(&from, &wrong.reason);
                    Some(Setting::Raw(text))
                }
            },
            (setting, _) => setting,
        };
        if let (Some(setting), Some(node)) = (setting, self.upgrade.document.nodes.get_mut(to)) {
            Arc::make_mut(node).inputs.insert(input.to_owned(), setting);
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
            self.upgrade.lose(&taken.from, why);
        }
    }

    /// A new node beside the maker, called after it.
    fn add(&mut self, kind: &str, word: &str) -> NodeId {
        let maker = &self.made.maker;
        let document = &mut self.upgrade.document;
        let id = document.free_id_in(maker.group().as_ref(), &format!("{}_{word}", maker.word()));
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
        if push_out
            .as_ref()
            .is_some_and(|it| !matches!(it.value(Type::Bool), Some(Value::Bool(true))))
        {
            let why = "hair always stays out of the skin, except as deep as the attribute allow_depth of what it is made from: \
                       dropped";
            self.lose(&push_out, why);
        }
    }

    /// *Interpolate*: cut, then clumped to the nearest guide.
    fn interpolate(&mut self) {
        let variation = self.take("length_variation");
        if number_or(&variation, LENGTH_VARIATION) != Some(0.0) {
            let length = self.behind("length", "length");
            self.set(&length, "variation", LENGTH_VARIATION);
            self.put(&length, "variation", variation);
            self.set(&length, "distribution", "even");
            self.copy("seed", &length, "seed");
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
        if is_other(&share, 0.0) && number_or(&distance, 1.0) != Some(0.0) {
            let stray = self.behind("stray", "stray");
            self.put(&stray, "share", share);
            self.set(&stray, "distance", 1.0f32);
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
        match inherit.as_ref().map(|inherit| inherit.value(Type::Bool)) {
            None | Some(Some(Value::Bool(true))) => {}
            Some(Some(Value::Bool(false))) => {
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
        let is_level = |ramp: Value| match ramp {
            Value::Ramp(ramp) => ramp.stops().iter().all(|(_, factor)| *factor == 1.0),
            _ => false,
        };
        let tapers = profile.as_ref().is_some_and(|it| !it.value(Type::Ramp).is_some_and(is_level));
        let shapes = is_other(&flatness, 1.0) || is_other(&turn, 0.0) || is_other(&twist, 0.0);
        if tapers || shapes {
            let section = self.before("cross_section", "section");
            if tapers {
                let radius = self.take("radius");
                self.put(&section, "radius", radius);
                self.put(&section, "profile", profile);
            }
            self.put(&section, "flatness", flatness);
            self.put(&section, "turn", turn);
            self.put(&section, "twist", twist);
            self.copy("scale_with_head", &section, "scale_with_head");
        }
    }

    /// Strands drawn together to wisps, or to the middle of the cluster.
    fn wisps(&mut self, root_radius: f32) {
        let (wisps, root, tip) =
            (self.take("wisps"), self.take("root_clump"), self.take("tip_clump"));
        if !is_other(&root, 0.0) && !is_other(&tip, 0.0) {
            return;
        }
        let clump = self.clump();
        match (number_or(&root, 0.0), number_or(&tip, 0.0)) {
            (Some(root), Some(tip)) if root > 0.0 => {
                let most = root.max(tip);
                self.set(&clump, "amount", most);
                self.ramp(&clump, "along", true, vec![(0.0, root / most), (1.0, tip / most)]);
            }
            (Some(_), _) => self.put(&clump, "amount", tip),
            (None, _) => {
                self.lose(
                    &tip,
                    "Clump has one amount, and a ramp along the hair: set the ramp: dropped",
                );
                self.put(&clump, "amount", root.clone());
                self.ramp(&clump, "along", false, vec![(0.0, 1.0), (1.0, 1.0)]);
            }
        }
        if is_other(&root, 0.0) {
            self.lose(
                &root,
                "strands gather from their roots on, and roots stay where they are now",
            );
        }
        match number_or(&wisps, 0.0) {
            Some(0.0) => self.draw_to_parents(&clump, "curves"),
            Some(wisps) => {
                let area = PI * root_radius * root_radius;
                let density = if area > 0.0 { wisps / area } else { wisps };
                self.set(&clump, "density", density.clamp(0.01, 1000.0));
                self.copy("seed", &clump, "seed");
                self.copy("scale_with_head", &clump, "scale_with_head");
            }
            None => {
                self.lose(&wisps, "Clump takes wisps per square centimetre: set density: dropped")
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
        let ends = [&root, &tip].map(|width| number_or(width, WIDTH));
        let maker = self.made.maker.clone();
        if ends[0].is_some() && ends[0] == ends[1] {
            self.put(&maker, "width", root);
            return;
        }
        self.put(&maker, "width", root.clone());
        let set = self.behind("set_width", "width");
        self.set(&set, "root", WIDTH);
        self.set(&set, "tip", WIDTH);
        self.put(&set, "root", root);
        self.put(&set, "tip", tip);
    }

    /// The most CVs that strands may have.
    fn points(&mut self) {
        let most = self.take("most_points");
        let points = self.read("points");
        let limit = number_or(&most, MOST_POINTS);
        let is_beyond = |number: f32| limit.is_some_and(|limit| number > limit);
        if number_or(&points, POINTS).is_some_and(is_beyond) {
            let maker = self.made.maker.clone();
            self.set(&maker, "points", limit.unwrap_or(MOST_POINTS) as i64);
        } else if is_other(&most, MOST_POINTS) {
            let why = "strands have as many CVs as points says, and twisted ones up to 255: use Resample for another limit: dropped";
            self.lose(&most, why);
        }
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
    match taken.value(Type::Field) {
        Some(Value::Float(x)) => x,
        Some(Value::Field(field)) => at_root(&field),
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
