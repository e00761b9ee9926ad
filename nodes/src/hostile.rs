//! Hostile inputs: whatever a document, a file or another node can hand to a node gives a sane result or an error.
//!
//! Each node runs with every single value of [`hostile`] and then with many throws of several at once.
//! It must not panic, must come to an end when asked to stop, must not make what no memory holds, and what it gives must be
//! finite numbers. Values that are not finite are refused before anything runs, by documents and by readers of files; so none is tried here.

use crate::data::attributes::{self as attr, Attribute, Domain, Item};
use crate::data::curves::{Curves, TuftBuilder};
use crate::data::field::Field;
use crate::data::ramp::{Blend, Ramp};
use crate::data::scalp::{HeadFrame, REGION, Scalp};
use crate::data::shapes::{ShapeList, Tier, TurnProfile};
use crate::data::strokes::{Brush, Mode, Sample, Stroke, Strokes};
use crate::define::{InputDef, NodeDef, Type, Value};
use crate::eval::{Host, Log, PlainHost, Quality};
use crate::long::is_long;
use crate::maths::closest::{Surface, tests::sphere};
use crate::maths::hash::Dice;
use crate::testing::run_on;
use crate::waiting::ends;
use glam::{Vec2, Vec3};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::sync::atomic::{AtomicU32, Ordering};

/// What makes little hair of nodes that make much; every node is tried.
const FEW: &[(&str, &[(&str, f32)])] = &[
    ("scatter_guides", &[("count", 60.0)]),
    ("braid_territory", &[("density", 2.0)]),
    ("edge_partition", &[("per_cm", 1.0)]),
    ("interpolate", &[("count", 60.0)]),
    ("baby_hair", &[("per_cm", 1.0)]),
    ("gather", &[("density", 2.0)]),
    ("sphere_puff", &[("count", 60.0)]),
    ("cluster_to_strands", &[("strands", 16.0)]),
];
/// Throws of several hostile values at once, for each node.
fn throws() -> u64 {
    if is_long() { 60 } else { 4 }
}
/// How often a node may look whether to stop before it is asked to, as people do whom much hair takes too long.
const LOOKS: u32 = 64;
/// The most that a node may make.
const MOST_BYTES: usize = 1 << 30;

/// Asks to stop after some looks.
#[derive(Default)]
struct Patience(AtomicU32);

impl Host for Patience {
    fn for_each(&self, n: usize, f: &(dyn Fn(usize) + Sync)) {
        PlainHost.for_each(n, f);
    }
    fn cancelled(&self) -> bool {
        self.0.fetch_add(1, Ordering::Relaxed) >= LOOKS
    }
}

/// A ball whose scalp is a cap of a few square centimetres.
fn scalp() -> Arc<Scalp> {
    let surface = sphere(8.9, 48);
    let region = surface.points.iter().map(|p| f32::from(p.y > 8.6)).collect();
    Scalp::new(surface, None, HeadFrame::IDENTITY, [(REGION.to_owned(), region)].into()).into()
}

fn scalps() -> Vec<Value> {
    let of = |surface: Surface, region: f32| -> Value {
        let region = vec![region; surface.points.len()];
        Scalp::new(surface, None, HeadFrame::IDENTITY, [(REGION.to_owned(), region)].into()).into()
    };
    let triangle = |side: f32| {
        let points = vec![Vec3::Y * 9.0, Vec3::new(side, 9.0, 0.0), Vec3::new(0.0, 9.0, side)];
        Surface::new(points, vec![[0, 2, 1]])
    };
    vec![
        of(sphere(8.9, 24), 0.0),
        of(triangle(1.0), 1.0),
        of(triangle(0.0), 1.0),
        of(Surface::new(vec![], vec![]), 1.0),
    ]
}

/// Hairs that stand on the cap, bound to nothing.
pub(crate) fn hairs(count: usize) -> Curves {
    let mut b = TuftBuilder::new();
    for k in 0..count {
        let x = 0.3 * k as f32;
        b.push_curve(&[0, 1, 2, 3, 4].map(|j| Vec3::new(x, 8.9 + j as f32, 0.1 * (j * j) as f32)));
    }
    b.set(attr::ID, Domain::Curve, (1..=count as u64).collect());
    b.set(attr::RADIUS, Domain::Point, vec![0.2; 5 * count]);
    Curves::new(vec![Arc::new(b.build())])
}

/// The same hairs, all that is known of them being `value`.
fn with_all(value: f32) -> Curves {
    let hairs = hairs(3);
    let tuft = &hairs.tufts()[0];
    let mut b = TuftBuilder::even(tuft.points().to_vec(), 5);
    for (name, ty, _) in attr::DECLARED {
        let domain = if ["u64", "i32"].contains(ty) { Domain::Curve } else { Domain::Point };
        let n = if domain == Domain::Curve { 3 } else { 15 };
        let values = match *ty {
            "f32" => f32::column(vec![value; n]),
            "i32" => i32::column(vec![value as i32; n]),
            "u64" => u64::column(vec![value as u64; n]),
            "Vec2" => Vec2::column(vec![Vec2::splat(value); n]),
            _ => Vec3::column(vec![Vec3::splat(value); n]),
        };
        b.set_column(Attribute { name: (*name).into(), domain, values });
    }
    Curves::new(vec![Arc::new(b.build())])
}

/// The same hairs, each of a puff of its own that reaches `radius` far: about its tip, its root, beside it, and beyond all.
fn in_puffs(radius: f32) -> Curves {
    let hairs = hairs(4);
    let tuft = &hairs.tufts()[0];
    let mut b = TuftBuilder::even(tuft.points().to_vec(), 5);
    let middles = [tuft.points()[4], tuft.points()[5], Vec3::new(0.9, 11.0, 0.0), Vec3::ONE * 1e30];
    b.set(attr::ID, Domain::Curve, (1..=4).collect());
    b.set(attr::PUFF, Domain::Curve, vec![1, 2, 3, 4]);
    b.set(attr::PUFF_CENTRE, Domain::Curve, middles.to_vec());
    b.set(attr::PUFF_RADIUS, Domain::Curve, vec![radius, 3.0, radius, radius]);
    Curves::new(vec![Arc::new(b.build())])
}

fn curves() -> Vec<Value> {
    let of = |all: &[&[Vec3]]| {
        let mut b = TuftBuilder::new();
        all.iter().for_each(|points| b.push_curve(points));
        Curves::new(vec![Arc::new(b.build())])
    };
    let line = |length: f32| [0.0, 0.5, 1.0].map(|t| Vec3::Y * 8.9 + Vec3::ONE * (length * t));
    let apart: Vec<Vec3> =
        (0..300).map(|k| Vec3::new(if k % 2 == 0 { 0.0 } else { 40.0 }, 9.0, 0.0)).collect();
    let mut all = vec![
        Curves::default(),
        of(&[]),
        of(&[&[Vec3::Y * 8.9]]),
        of(&[&[Vec3::Y * 8.9; 2], &[Vec3::ZERO; 9]]),
        of(&[&[Vec3::ZERO, Vec3::Y], &[]]),
        of(&[&apart, &apart]),
        of(&vec![&[Vec3::Y * 9.0][..]; 2000]),
    ];
    all.extend([1e-30, 1e-4, 300.0, 1e6, 1e19, 1e30, 3e38].map(|length| of(&[&line(length)])));
    all.extend([-1.0, 0.0, 1e-30, 1e30].map(with_all));
    all.extend([1e-30, 3.0, 1e30, f32::MAX].map(in_puffs));
    all.into_iter().map(Value::Curves).collect()
}

/// Strokes with brushes of every kind: one dab, many at one place, all over the head and far off it, closed ones that cross
/// themselves, lie on one line or have no inside.
fn strokes() -> Vec<Strokes> {
    let at = |p: Vec3| Sample { position: p, pressure: 1.0, ..Sample::default() };
    let dice = Dice::new(9, 0, "strokes");
    let any = |k: u64| Vec3::new(dice.signed(k, 0), dice.signed(k, 1), dice.signed(k, 2)) * 12.0;
    let places: [Vec<Vec3>; 6] = [
        vec![Vec3::Y * 9.0],
        vec![Vec3::Y * 9.0; 200],
        vec![Vec3::ZERO, Vec3::Y * 9.0, Vec3::NEG_Y * 9.0, Vec3::ZERO],
        (0..40).map(any).collect(),
        vec![Vec3::splat(1e30), Vec3::splat(-1e30), Vec3::X * 1e-30],
        (0..40).map(|k| Vec3::new(k as f32 * 0.2, 8.0, 0.0)).collect(),
    ];
    let mut lists = vec![];
    for (radius, closed, mirrored) in
        [(0.05, false, true), (1.0, false, false), (30.0, false, true), (1.0, true, true)]
    {
        let each = places.iter().flat_map(|p| Mode::ALL.iter().map(move |(mode, _)| (p, *mode)));
        let of = |(id, (places, mode)): (u64, (&Vec<Vec3>, Mode))| {
            let section = if id % 3 == 0 { "nothing".to_owned() } else { String::new() };
            let brush = Brush { mode, radius, strength: 0.7, mirrored, closed, section };
            let samples = places.iter().map(|p| at(*p)).collect();
            Stroke { brush: Some(brush), ..Stroke::new(id, samples) }
        };
        lists.push(Strokes((1..).zip(each).map(of).collect()));
    }
    lists
}

const NUMBERS: [f32; 8] = [0.0, -0.0, -1.0, 1e-30, 1e30, -1e30, f32::MAX, 16_777_216.0];

/// What may come in at an input at worst. Ranges are the node's own: what lies outside them is clamped, as from documents, so that of
/// numbers which come to be the same one is tried.
fn hostile(input: &InputDef) -> Vec<Value> {
    let arrives = |value: &Value| {
        let number = match value {
            Value::Float(x) => f64::from(*x),
            Value::Int(n) => *n as f64,
            _ => return None,
        };
        let (low, high) = input.hard.unwrap_or((f64::NEG_INFINITY, f64::INFINITY));
        Some(number.clamp(low, high).to_bits())
    };
    let mut seen = std::collections::BTreeSet::new();
    let mut all = worst(input);
    all.retain(|value| arrives(value).is_none_or(|number| seen.insert(number)));
    all
}

fn worst(input: &InputDef) -> Vec<Value> {
    let ramps = || {
        let stops = [
            vec![(0.0, 0.0)],
            vec![(0.0, -1e30), (1.0, 1e30)],
            vec![(0.5, 0.0), (0.5, f32::MAX)],
            vec![(-1e30, 1.0), (1e30, -1.0)],
        ];
        stops.into_iter().filter_map(|stops| Ramp::new(Blend::Smooth, stops).ok())
    };
    match input.ty {
        Type::Bool => vec![true.into(), false.into()],
        Type::Int => [i64::MIN, -1, 0, 1, 3, i64::MAX].map(Value::Int).to_vec(),
        Type::Float => NUMBERS.map(Value::Float).to_vec(),
        Type::Field => {
            let fields = [Field::Attribute("nothing".into()), Field::Mask("nothing".into())];
            let fields = fields.into_iter().map(|field| Value::Field(Arc::new(field)));
            let ramps = ramps().map(|ramp| Value::Field(Arc::new(Field::Ramp(ramp))));
            NUMBERS.map(Value::Float).into_iter().chain(fields).chain(ramps).collect()
        }
        Type::Vec3 | Type::Colour => {
            let mut all = NUMBERS.map(|x| Value::Vec3(Vec3::splat(x))).to_vec();
            all.extend([Vec3::X * 1e30, Vec3::Y * 1e-30, Vec3::NEG_Y].map(Value::Vec3));
            all
        }
        Type::Ramp => ramps().map(|ramp| Value::Ramp(Arc::new(ramp))).collect(),
        Type::Choice(words) => words.iter().map(|(word, _)| Value::Text((*word).into())).collect(),
        Type::Text => {
            // The last two name hair without ids.
            let all = [
                "",
                "\0",
                "a,,;1e99 nan",
                "0 turn 20, lift -170, length 3; 0 width 2, colour 1 0 0",
                "0 remove",
            ];
            all.map(|text| Value::Text(text.into())).to_vec()
        }
        Type::Shapes => {
            let flat = TurnProfile::Custom(vec![Vec2::ZERO, Vec2::X * 999.0, Vec2::X * 5.0]);
            let lists = [
                vec![],
                vec![(Tier::A, flat)],
                vec![(Tier::C, TurnProfile::Ellipse(0.01)), (Tier::C, TurnProfile::Lame(20.0))],
            ];
            lists.map(|list| Value::Shapes(Arc::new(ShapeList(list)))).to_vec()
        }
        Type::Curves => curves(),
        Type::Scalp => scalps(),
        Type::Gestures => {
            use crate::data::gestures::{Gestures, Layer, Tool, tests::gesture};
            // Every tool on every layer, under the pen, and of the curves that are there.
            let all = |curves: &[u64]| {
                let each =
                    Tool::ALL.iter().flat_map(|tool| Layer::ALL.iter().map(move |l| (tool.0, l.0)));
                let of = |(i, (tool, layer)): (u64, (Tool, Layer))| {
                    let mut one = gesture(i, tool);
                    (one.layer, one.curves) = (layer, curves.to_vec());
                    one
                };
                Gestures((1..).zip(each).map(of).collect())
            };
            vec![all(&[]).into(), all(&[0, 1, 2, 3, 4, 0xdead]).into()]
        }
        Type::Strokes => strokes().into_iter().map(Value::from).collect(),
        Type::File => vec![],
    }
    .into_iter()
    .filter(|value| value.fault().is_none())
    .collect()
}

/// What makes little hair of this node.
fn few(id: &str) -> &'static [(&'static str, f32)] {
    FEW.iter().find(|(of, _)| *of == id).map_or(&[], |(_, few)| few)
}

/// What a node runs with where nothing else is said.
pub(crate) fn usual(node: &NodeDef) -> Vec<(&'static str, Value)> {
    let mut set = vec![];
    let make = |id: &str, set: &[(&'static str, Value)]| {
        let set: Vec<_> = [("scalp", scalp().into())].iter().chain(set).cloned().collect();
        let node = crate::by_id(id).unwrap();
        let made = run_on(node, &set, &PlainHost, &Log::default(), Quality::Final).unwrap();
        node.outputs.iter().map(|out| out.name).zip(made).collect::<Vec<_>>()
    };
    // What others make for it.
    let mut wired: Vec<(&str, Value)> = vec![];
    match node.id {
        "tail" | "bun" => wired = make("gather", &[("density", 2.0f32.into())]),
        "braid_hair" => {
            let rows = [("source", hairs(3).into()), ("density", 2.0f32.into())];
            let ground = make("braid_territory", &rows);
            let braids = make("lissajous_braid", &[("source", ground[1].1.clone())]);
            wired = vec![
                ("roots", ground[0].1.clone()),
                ("strands", braids[0].1.clone()),
                ("stitches", braids[1].1.clone()),
            ];
            set.push(("band_turns", 3.0f32.into()));
        }
        _ => {}
    }
    for input in node.inputs {
        let few = few(node.id).iter().find(|(name, _)| *name == input.name);
        let value = match (input.name, input.ty) {
            ("scalp", _) => scalp().into(),
            (name, Type::Curves) if wired.iter().any(|(of, _)| *of == name) => {
                wired.iter().find(|(of, _)| *of == name).unwrap().1.clone()
            }
            ("curves" | "source", _) => hairs(3).into(),
            (_, Type::Int) if few.is_some() => Value::Int(few.unwrap().1 as i64),
            _ if few.is_some() => Value::Float(few.unwrap().1),
            _ => continue,
        };
        set.push((input.name, value));
    }
    set
}

/// What a node does wrong with these inputs; none where it does well.
fn wrong(node: &NodeDef, set: &[(&'static str, Value)]) -> Option<String> {
    let log = Log::default();
    let run = || run_on(node, set, &Patience::default(), &log, Quality::Final);
    let what = std::fmt::from_fn(|f| {
        write!(f, "{}", node.id)?;
        set.iter().try_for_each(|(name, value)| write!(f, ", {name} = {}", shown(value)))
    });
    match ends(what, || catch_unwind(AssertUnwindSafe(run))) {
        Err(panic) => {
            let said = panic.downcast_ref::<String>().cloned();
            let said = said.or(panic.downcast_ref::<&str>().map(|said| (*said).to_owned()));
            Some(format!("panics: {}", said.unwrap_or_default()))
        }
        Ok(Ok(out)) => {
            let bytes: usize = out.iter().map(Value::bytes).sum();
            let finite = out.iter().all(|value| match value {
                Value::Curves(curves) => {
                    curves.tufts().iter().all(|t| t.points().iter().all(|p| p.is_finite()))
                }
                other => other.fault().is_none(),
            });
            if bytes > MOST_BYTES {
                Some(format!("makes {bytes} bytes"))
            } else {
                (!finite).then(|| "gives what is not a finite number".to_owned())
            }
        }
        Ok(Err(_)) => None,
    }
}

fn shown(value: &Value) -> String {
    let text: String = format!("{value:?}").split_whitespace().collect::<Vec<_>>().join(" ");
    text.chars().take(160).collect()
}

#[test]
fn hostile_inputs_never_panic_hang_or_eat_memory() {
    let mut found = vec![];
    // What a head may be handed at worst are files, which readers have tests of their own for.
    for node in crate::all().filter(|node| node.id != "head") {
        let id = node.id;
        let usual = usual(node);
        assert_eq!(wrong(node, &usual), None, "{id} as usual");
        let with = |more: Vec<(&'static str, Value)>| {
            let mut set = usual.clone();
            set.retain(|(name, _)| more.iter().all(|(other, _)| other != name));
            set.extend(more);
            set
        };
        let all: Vec<(&InputDef, Vec<Value>)> =
            node.inputs.iter().map(|input| (input, hostile(input))).collect();
        let mut runs = 0;
        for (input, values) in &all {
            for value in values {
                runs += 1;
                if let Some(fault) = wrong(node, &with(vec![(input.name, value.clone())])) {
                    found.push(format!("{id}.{} = {}: {fault}", input.name, shown(value)));
                }
            }
        }
        let dice = Dice::new(5, 0, id);
        for throw in 0..throws() {
            let share = dice.range(throw, 0, 0.05, 0.6);
            let some = all.iter().enumerate().filter(|(k, (_, values))| {
                let many = few(id).iter().any(|(name, _)| *name == all[*k].0.name);
                !many && !values.is_empty() && dice.unit(throw, 1 + *k as u64) < share
            });
            let set: Vec<(&'static str, Value)> = some
                .map(|(k, (input, values))| {
                    let pick = dice.below(throw, 100 + k as u64, values.len() as u32) as usize;
                    (input.name, values[pick].clone())
                })
                .collect();
            runs += 1;
            if let Some(fault) = wrong(node, &with(set.clone())) {
                let set: Vec<String> =
                    set.iter().map(|(name, value)| format!("{name} = {}", shown(value))).collect();
                found.push(format!("{id}, {}: {fault}", set.join(", ")));
            }
        }
        println!("{id}: {runs} runs");
    }
    assert!(found.is_empty(), "{} faults:\n{}", found.len(), found.join("\n"));
}
