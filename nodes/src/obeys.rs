//! Tests: every node that makes or moves hair on a head obeys, whatever hair it is given.
//!
//! Which nodes these are, and what they take, is read from their declarations: all that take a scalp and give curves. Each runs on every
//! parted head; what moves hair runs on hair of all that makes some, as it is declared and with numbers drawn from its sliders. The laws:
//! no hair is rooted in a parting or leads over one near its root, neither a point nor what is drawn between points lies deeper in the
//! skin than its hair may, no id is there twice, and all numbers are finite. A new node is held to them by being listed.

use crate::data::attributes::{ALLOW_DEPTH, ROOT_TRIANGLE};
use crate::data::curves::{Curves, Tuft};
use crate::data::scalp::Scalp;
use crate::define::{Arity, InputDef, NodeDef, NodeError, Type, Value};
use crate::eval::{Log, PlainHost, Quality};
use crate::long::is_long;
use crate::maths::hash::Dice;
use crate::testing::{curves_of, head, run_on, shared_head};
use std::cell::RefCell;
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

mod carried;
mod nudge;

/// What lies over partings, and at most so large a share of it: all where it is no hair or does so by what it is for, and little that is
/// known and should be less. No other node may.
const OVER_PARTINGS: &[(&str, f32)] = &[
    // Hair falls where its weight takes it, over partings on its way down.
    ("hang", 1.0),
    // Lays lines onto the skin, such as partings themselves.
    ("scalp_projection", 1.0),
    // As wide as is asked: over the lines of boxes that are narrower.
    ("lissajous_braid", 0.25),
    ("braid_hair", 0.015),
    ("braid_territory", 0.002),
    // Of wide clusters that come near to a line.
    ("cluster_to_strands", 0.035),
    // Of hair that winds up and down where it was straight.
    ("shape_list_curl", 0.01),
];
/// Whose hair dips into the skin between its points, and at most so large a share of it: what is spaced, joined or cut anew after it was
/// set clear. Export leads these out; no other node may.
const DIPS: &[(&str, f32)] = &[
    ("baby_hair", 0.01),
    ("braid_hair", 0.015),
    ("braid_territory", 0.005),
    ("cluster_to_strands", 0.01),
    ("gather", 0.012),
    ("length", 0.003),
    ("shape_list_curl", 0.01),
];
/// Where what an input takes comes from, if no node gives it by that name.
const FROM: &[(&str, &str, &str)] = &[
    ("guides", "scatter_guides", "curves"),
    ("placements", "partings", "middles"),
    ("roots", "braid_territory", "curves"),
    ("source", "partings", "rows"),
    ("strands", "lissajous_braid", "curves"),
    ("strokes", "scatter_guides", "curves"),
];
/// What is said to nodes whatever the head: mostly so much that each run is short.
fn said() -> Vec<(&'static str, &'static str, Value)> {
    let (float, int) = (Value::Float, Value::Int);
    vec![
        ("scatter_guides", "count", int(700)),
        ("scatter_guides", "length", float(6.0)),
        ("interpolate", "by", "density".into()),
        ("interpolate", "density", float(6.0)),
        ("sphere_puff", "count", int(400)),
        ("gather", "density", float(3.0)),
        // Else hair comes to its tie from behind partings, which is told.
        ("gather", "own_section", true.into()),
        ("braid_territory", "density", float(3.0)),
        ("edge_partition", "per_cm", float(3.0)),
        ("baby_hair", "per_cm", float(3.0)),
        ("cluster_to_strands", "strands", int(6)),
    ]
}
/// The most hairs of one maker that others are given.
const MOST: usize = 80;
/// So deep (cm) a point may lie for what is rounded.
const ROUNDED: f32 = 1e-3;
/// Hair that has left the skin may pass over partings: so many points are near the root.
const NEAR: usize = 8;
/// The share of a node's hair that may have a point in the skin.
const POINTS_IN: &[(&str, f32)] = &[("braid_territory", 0.001)];
const OVER: &str = "over partings";
const ROOTED: &str = "rooted in partings";
const IN: &str = "in the skin";
const DRAWN: &str = "drawn into the skin between points";

type Set = Vec<(&'static str, Value)>;

/// The nodes that are held to the laws.
fn nodes() -> impl Iterator<Item = &'static NodeDef> {
    crate::all().filter(|node| {
        node.outputs.iter().any(|out| out.ty == Type::Curves)
            && node.inputs.iter().any(|input| input.ty == Type::Scalp)
    })
}

/// The share of a node's hair that may lie over partings.
fn spared(node: &NodeDef) -> f32 {
    share(OVER_PARTINGS, node)
}

fn share(of: &[(&str, f32)], node: &NodeDef) -> f32 {
    of.iter().find(|(id, _)| *id == node.id).map_or(0.0, |(_, share)| *share)
}

/// Curves that a node does not run without.
fn needed(node: &NodeDef) -> impl Iterator<Item = &'static InputDef> {
    let is_needed = |input: &&InputDef| input.ty == Type::Curves && input.arity == Arity::One;
    node.inputs.iter().filter(is_needed)
}

/// Some of the hairs that obey, of ids that are not there yet.
fn few(scalp: &Scalp, curves: &Curves, ids: &mut BTreeSet<u64>) -> Curves {
    let every = curves.curve_count().div_ceil(MOST).max(1);
    let mut n = 0;
    let tufts = curves.tufts().iter().map(|tuft| {
        let pick = (0..tuft.len() as u32).filter(|i| {
            n += 1;
            let i = *i as usize;
            n % every == 0 && broken(scalp, tuft, i).next().is_none() && ids.insert(tuft.id(i))
        });
        Arc::new(tuft.gather(&pick.collect::<Vec<_>>()).build())
    });
    Curves::new(tufts.collect())
}

/// A parted head, and what nodes have made on it.
struct Bench {
    name: String,
    scalp: Arc<Scalp>,
    made: RefCell<BTreeMap<&'static str, Vec<Value>>>,
}

impl Bench {
    fn new(name: &str, whole: Arc<Scalp>, cells: &str, count: i64) -> Self {
        let set = [
            ("scalp", Value::from(whole)),
            ("pattern", "straight_back".into()),
            ("count", Value::Int(count)),
            ("cells", cells.into()),
            ("cell_length", Value::Float(5.0)),
        ];
        let node = crate::by_id("partings").unwrap();
        let made = run_on(node, &set, &PlainHost, &Log::default(), Quality::Final).unwrap();
        let Value::Scalp(scalp) = &made[0] else { panic!() };
        let (scalp, made) = (scalp.clone(), RefCell::new([("partings", made)].into()));
        Self { name: format!("{name}, {cells}"), scalp, made }
    }

    /// What a node gives with what is usual, made on the first call.
    fn made(&self, node: &'static NodeDef) -> Vec<Value> {
        if let Some(made) = self.made.borrow().get(node.id) {
            return made.clone();
        }
        let made = self.run(node, &self.usual(node)).expect("little is made");
        self.made.borrow_mut().insert(node.id, made.clone());
        made
    }

    /// Of that what has a name.
    fn output(&self, id: &'static str, name: &str) -> Value {
        let node = crate::by_id(id).unwrap();
        let at = node.outputs.iter().position(|out| out.name == name).unwrap();
        self.made(node).remove(at)
    }

    /// None where a node refuses to make so much.
    fn run(&self, node: &NodeDef, set: &Set) -> Option<Vec<Value>> {
        match run_on(node, set, &PlainHost, &Log::default(), Quality::Final) {
            Err(NodeError::TooLarge(_)) => None,
            made => Some(made.unwrap_or_else(|err| panic!("{}, {}: {err}", self.name, node.id))),
        }
    }

    /// What a node runs with where nothing else is said.
    fn usual(&self, node: &'static NodeDef) -> Set {
        let mut set: Set = vec![];
        for input in node.inputs.iter().filter(|input| input.ty == Type::Scalp) {
            if input.name == "scalp" {
                set.push((input.name, self.scalp.clone().into()));
            }
        }
        let gives = |other: &&NodeDef| {
            let has = |name: &str| other.outputs.iter().any(|out| out.name == name);
            other.id != node.id && needed(node).all(|input| has(input.name))
        };
        // One node that gives all of it, told by more than that hair is `curves`.
        let is_told = needed(node).any(|input| input.name != "curves");
        let one = nodes().find(gives).filter(|_| is_told);
        for input in needed(node) {
            let from = FROM.iter().find(|(name, from, _)| *name == input.name && *from != node.id);
            let value = match (from, one) {
                (Some((_, id, output)), _) if input.name == "roots" => {
                    few(&self.scalp, curves_of(&self.output(id, output)), &mut BTreeSet::new())
                        .into()
                }
                (Some((_, id, output)), _) => self.output(id, output),
                (None, Some(one)) => self.output(one.id, input.name),
                (None, None) => self.hair().into(),
            };
            set.push((input.name, value));
        }
        let said = said().into_iter().filter(|(id, ..)| *id == node.id);
        set.extend(said.map(|(_, name, value)| (name, value)));
        set
    }

    /// Hair of all nodes that make some of nothing but a head, lines and roots.
    fn hair(&self) -> Curves {
        if let Some(all) = self.made.borrow().get("all hair") {
            return curves_of(&all[0]).clone();
        }
        let makes = |node: &&NodeDef| needed(node).all(|input| input.name != "curves");
        let makers = nodes()
            .filter(makes)
            .filter(|node| node.outputs.iter().any(|out| out.name == "curves"));
        let mut ids = BTreeSet::new();
        let tufts = makers.flat_map(|node| {
            let made = self.output(node.id, "curves");
            few(&self.scalp, curves_of(&made), &mut ids).tufts().to_vec()
        });
        let all = Curves::new(tufts.collect());
        self.made.borrow_mut().insert("all hair", vec![all.clone().into()]);
        all
    }

    /// Another seed; and where a node moves hair, half of its numbers and choices drawn from what its sliders offer. What says how much
    /// is made stays.
    fn drawn(&self, node: &'static NodeDef) -> Set {
        let mut set = self.usual(node);
        let (dice, moves) = (Dice::new(3, 0, &self.name), node.input("curves").is_some());
        for (k, input) in (0..).zip(node.inputs) {
            let known = set.iter().any(|(name, _)| *name == input.name);
            let (x, is_drawn) = (dice.unit(1, k), moves && dice.unit(0, k) < 0.5);
            let number = || {
                let (low, high) = input.soft.or(input.hard)?;
                Some(Value::Float((low + (high - low) * f64::from(x)) as f32))
            };
            let value = match input.ty {
                Type::Int if input.name == "seed" => Some(Value::Int(8)),
                _ if known || !is_drawn => None,
                Type::Float | Type::Field => number(),
                Type::Choice(words) => Some(words[(x * words.len() as f32) as usize].0.into()),
                _ => None,
            };
            set.extend(value.map(|value| (input.name, value)));
        }
        set
    }

    /// What is wrong with what a node has made of this.
    fn judged(&self, node: &NodeDef, made: &[Value], set: &Set, faults: &mut Vec<String>) {
        let is_said =
            |(_, value): &&(&str, Value)| !matches!(value, Value::Curves(_) | Value::Scalp(_));
        for (value, _) in made.iter().zip(node.outputs).filter(|(_, out)| out.name == "curves") {
            let hair = curves_of(value);
            for (law, count) in self::faults(&self.scalp, hair) {
                let most = match law {
                    OVER | ROOTED => spared(node),
                    DRAWN => share(DIPS, node),
                    IN => share(POINTS_IN, node),
                    _ => 0.0,
                };
                if count as f32 <= most * hair.curve_count() as f32 {
                    continue;
                }
                let (of, set) =
                    (hair.curve_count(), set.iter().filter(is_said).collect::<Vec<_>>());
                let Self { name, .. } = self;
                faults.push(format!("{name}, {}: {count} of {of} hairs {law}; {set:?}", node.id));
            }
        }
    }
}

/// The laws that a hair breaks.
fn broken(scalp: &Scalp, tuft: &Tuft, i: usize) -> impl Iterator<Item = &'static str> {
    let (sections, skin) = (scalp.sections().unwrap(), scalp.skin());
    let (points, first) = (tuft.curve(i), tuft.range(i).start);
    let depth = tuft.view(ALLOW_DEPTH);
    let may = |k: usize| ROUNDED + depth.at(i, first + k).max(0.0);
    let is_rooted = tuft.attribute(ROOT_TRIANGLE.name).is_some();
    let laws = [
        ("not finite", !points.iter().all(|p| p.is_finite())),
        (ROOTED, is_rooted && !scalp.free(points[0])),
        (OVER, sections.is_over_line_before(points, NEAR)),
        (IN, (1..points.len()).any(|k| skin.distance(points[k]) < -may(k))),
        (DRAWN, skin.has_dip(points, |k| depth.at(i, first + k))),
    ];
    laws.into_iter().filter(|(_, is_broken)| *is_broken).map(|(law, _)| law)
}

/// How many hairs break which law.
fn faults(scalp: &Scalp, hair: &Curves) -> BTreeMap<&'static str, usize> {
    let (mut found, mut ids) = (BTreeMap::new(), BTreeSet::new());
    for (tuft, i) in hair.each() {
        let twice = (!ids.insert(tuft.id(i))).then_some("of an id that is there twice");
        for law in broken(scalp, tuft, i).chain(twice) {
            *found.entry(law).or_default() += 1;
        }
    }
    found
}

/// Every parted head.
fn heads() -> Vec<Bench> {
    let built_in = head(&[]);
    let mut all = vec![
        Bench::new("the built-in head", built_in.clone(), "whole", 8),
        Bench::new("the built-in head", built_in, "boxes", 8),
    ];
    for name in ["lps_head/LeePerrySmith.glb", "ict_head/generic_neutral_mesh.obj"] {
        if let Some(scalp) = shared_head("nodes obey on heads of others", name, &[]) {
            all.push(Bench::new(name, scalp, "whole", 6));
        }
    }
    all
}

#[test]
fn whatever_makes_or_moves_hair_keeps_it_out_of_the_skin_and_off_partings() {
    let mut faults = vec![];
    let long = is_long();
    for (number, bench) in heads().into_iter().enumerate() {
        // The built-in head in whole sections sees all nodes; in boxes, and on each of two heads of others, every third, each another.
        let sees = |k: usize| long || number == 0 || k % 3 == number % 3;
        let nodes = nodes().filter(|node| spared(node) < 1.0).enumerate();
        for (_, node) in nodes.filter(|(k, _)| sees(*k)) {
            bench.judged(node, &bench.made(node), &bench.usual(node), &mut faults);
            let drawn = bench.drawn(node);
            if let Some(made) = bench.run(node, &drawn) {
                bench.judged(node, &made, &drawn, &mut faults);
            }
        }
        nudge::check(&bench, &mut faults);
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}
