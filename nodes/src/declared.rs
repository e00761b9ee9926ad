//! Nodes declared by documents: groups, their borders, and the parameters of a graph.
//!
//! Editor and scheduler see a node by its [`NodeDef`]. Those of built-in nodes are static; these are made from the list of
//! [`Port`]s in a document. Each list is made into definitions once and kept for good, so an [`Interface`] is a pointer, and two
//! are equal when their lists are. Memory holds only lists that were read or made in this run.
//!
//! None of these nodes runs: a plan replaces them by the wires and values that pass through.

use crate::data::field::Field;
use crate::define::{
    Arity, Group, InputDef, NodeDef, NodeError, OutputDef, Preset, Type, Unit, Value,
};
use crate::eval::EvalCx;
use crate::maths::hash::{Key, KeyBuilder};
use std::collections::{BTreeMap, BTreeSet};
use std::fmt;
use std::sync::{Mutex, PoisonError};

/// Kind of a node that contains others.
pub const GROUP: &str = "group";
/// Kind of a group's inner node with its inputs.
pub const GROUP_INPUT: &str = "group_input";
/// Kind of a group's inner node with its outputs.
pub const GROUP_OUTPUT: &str = "group_output";
/// Kind of the node with named values that other nodes read.
pub const PARAMETERS: &str = "parameters";

/// Kinds of nodes whose inputs and outputs are declared by documents.
pub const KINDS: [&str; 4] = [GROUP, GROUP_INPUT, GROUP_OUTPUT, PARAMETERS];

/// Largest number of ports on one side of an interface.
pub const MOST_PORTS: usize = 256;
/// Largest length of a port's name, bytes.
pub const LONGEST_NAME: usize = 64;

/// One input or output of an interface.
#[derive(Clone, Debug)]
pub struct Port {
    /// `[a-z][a-z0-9_]*`, at most 64 bytes; unique on its side.
    pub name: String,
    /// Former names, in older versions of a template.
    pub was: Vec<String>,
    /// Tooltip; may be empty.
    pub doc: String,
    /// Its type.
    pub ty: Type,
    /// Number of values it takes; one for outputs.
    pub arity: Arity,
    /// Value if nothing is set or wired; without one, readers use their own defaults.
    pub default: Option<Value>,
    /// Hard range of numbers.
    pub hard: Option<(f64, f64)>,
    /// Range of the slider.
    pub soft: Option<(f64, f64)>,
    /// Unit of a number.
    pub unit: Unit,
    /// Heading in the inspector that starts with this port; empty for none.
    pub section: String,
}

impl Port {
    /// A port with this name and type, and defaults for the rest.
    pub fn new(name: &str, ty: Type) -> Self {
        Self {
            name: name.to_owned(),
            was: vec![],
            doc: String::new(),
            ty,
            arity: Arity::Optional,
            default: None,
            hard: None,
            soft: None,
            unit: Unit::None,
            section: String::new(),
        }
    }

    /// A port with the name `name`, described like the input `of`.
    pub fn like(name: &str, of: &InputDef) -> Self {
        let arity =
            if of.arity == Arity::One && of.has_default() { Arity::Optional } else { of.arity };
        let (hard, soft, unit) = (of.hard, of.soft, of.unit);
        Self {
            doc: of.doc(),
            arity,
            default: of.default(),
            hard,
            soft,
            unit,
            ..Self::new(name, of.ty)
        }
    }

    fn add_to(&self, key: KeyBuilder) -> KeyBuilder {
        let Self { name, was, doc, ty, arity, default, hard, soft, unit, section } = self;
        let key = was.iter().fold(key.int(was.len() as u64), |key, name| key.text(name));
        let mut key = key.text(name).text(doc).text(section).text(ty.name());
        if let Type::Choice(words) = ty {
            key = words
                .iter()
                .fold(key.int(words.len() as u64), |key, (word, doc)| key.text(word).text(doc));
        }
        key = key.int(*arity as u64).int(*unit as u64);
        for range in [hard, soft] {
            key = match range {
                Some((lo, hi)) => key.int(1).int(lo.to_bits()).int(hi.to_bits()),
                None => key.int(0),
            };
        }
        match default {
            Some(value) => key.int(1).text(value.type_name()).key(value.key()),
            None => key.int(0),
        }
    }

    /// A value clamped to the range of the port: numbers, and the stops of ramps.
    pub fn clamped(&self, value: Value) -> Value {
        clamped(self.hard, value)
    }
}

/// A value with its number, or the stops of its ramp, clamped to a range.
pub fn clamped(range: Option<(f64, f64)>, value: Value) -> Value {
    let Some((lo, hi)) = range else { return value };
    let (lo32, hi32) = (lo as f32, hi as f32);
    match value {
        Value::Float(x) => Value::Float(x.max(lo32).min(hi32)),
        Value::Int(x) => Value::Int(x.max(lo as i64).min(hi as i64)),
        Value::Ramp(ramp) => Value::Ramp(ramp.clamped(lo32, hi32).into()),
        Value::Field(field) => match &*field {
            Field::Ramp(ramp) => Field::Ramp(ramp.clamped(lo32, hi32)).into(),
            _ => Value::Field(field),
        },
        value => value,
    }
}

/// Why a list of ports is invalid.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum BadInterface {
    /// An invalid name.
    #[error(
        "{0:?} is no name of a port: use a lower case letter, then letters, digits and underscores, at most 64"
    )]
    Name(String),
    /// A duplicate name.
    #[error("two ports are called {0}: give each a name of its own")]
    Twice(String),
    /// Too many ports.
    #[error("there are {0} ports, and at most 256 can be")]
    TooMany(usize),
    /// An invalid default or range.
    #[error("{0}: {1}")]
    Bad(String, String),
}

/// Inputs and outputs of a group, or the parameters of a graph: a pointer to their definitions.
#[derive(Clone, Copy)]
pub struct Interface(&'static Declared);

struct Declared {
    inputs: Vec<Port>,
    outputs: Vec<Port>,
    key: Key,
    group: NodeDef,
    group_input: NodeDef,
    group_output: NodeDef,
    parameters: NodeDef,
}

impl PartialEq for Interface {
    fn eq(&self, other: &Self) -> bool {
        std::ptr::eq(self.0, other.0)
    }
}
impl Eq for Interface {}

impl fmt::Debug for Interface {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let names =
            |ports: &[Port]| ports.iter().map(|p| p.name.clone()).collect::<Vec<_>>().join(" ");
        write!(f, "[{} -> {}]", names(&self.0.inputs), names(&self.0.outputs))
    }
}

impl Default for Interface {
    /// Without ports.
    fn default() -> Self {
        // An empty list is valid.
        Self::new(vec![], vec![]).unwrap_or_else(|_| unreachable!())
    }
}

impl Interface {
    /// The interface with these ports.
    ///
    /// # Errors
    /// An invalid or duplicate name, more than 256 ports on a side, or a range that ends before it begins.
    pub fn new(inputs: Vec<Port>, outputs: Vec<Port>) -> Result<Self, BadInterface> {
        prove(&inputs)?;
        prove(&outputs)?;
        static KNOWN: Mutex<BTreeMap<Key, &'static Declared>> = Mutex::new(BTreeMap::new());
        let key = KeyBuilder::new("interface").int(inputs.len() as u64);
        let key = inputs.iter().chain(&outputs).fold(key, |key, port| port.add_to(key)).finish();
        let mut known = KNOWN.lock().unwrap_or_else(PoisonError::into_inner);
        Ok(Self(
            known.entry(key).or_insert_with(|| Box::leak(Box::new(declare(inputs, outputs, key)))),
        ))
    }

    /// The same without texts for people: tooltips, headings, slider ranges and former names.
    pub fn without_words(self) -> Self {
        let bare = |ports: &[Port]| -> Vec<Port> {
            let bare = |port: &Port| Port {
                was: vec![],
                doc: String::new(),
                soft: None,
                section: String::new(),
                ..port.clone()
            };
            ports.iter().map(bare).collect()
        };
        // A subset of a valid list is valid.
        Self::new(bare(self.inputs()), bare(self.outputs())).unwrap_or(self)
    }

    /// The inputs.
    pub fn inputs(self) -> &'static [Port] {
        &self.0.inputs
    }
    /// The outputs.
    pub fn outputs(self) -> &'static [Port] {
        &self.0.outputs
    }
    /// Hash of the whole interface.
    pub fn key(self) -> Key {
        self.0.key
    }
    /// The definition of a node of a kind in [`KINDS`] with this interface; `None` for other kinds.
    pub fn def(self, kind: &str) -> Option<&'static NodeDef> {
        match kind {
            GROUP => Some(&self.0.group),
            GROUP_INPUT => Some(&self.0.group_input),
            GROUP_OUTPUT => Some(&self.0.group_output),
            PARAMETERS => Some(&self.0.parameters),
            _ => None,
        }
    }
}

/// Whether this is a valid name of a port.
pub fn is_name(name: &str) -> bool {
    let first = name.starts_with(|c: char| c.is_ascii_lowercase());
    let rest = name.bytes().all(|b| b.is_ascii_lowercase() || b.is_ascii_digit() || b == b'_');
    first && rest && name.len() <= LONGEST_NAME
}

fn prove(ports: &[Port]) -> Result<(), BadInterface> {
    if ports.len() > MOST_PORTS {
        return Err(BadInterface::TooMany(ports.len()));
    }
    let mut seen = BTreeSet::new();
    for port in ports {
        let bad = |why: String| Err(BadInterface::Bad(port.name.clone(), why));
        if !is_name(&port.name) {
            return Err(BadInterface::Name(port.name.chars().take(LONGEST_NAME).collect()));
        }
        if !seen.insert(&port.name) {
            return Err(BadInterface::Twice(port.name.clone()));
        }
        for (lo, hi) in [port.hard, port.soft].into_iter().flatten() {
            if !(lo.is_finite() && hi.is_finite() && lo < hi) {
                return bad(format!(
                    "its range is {lo} to {hi}; the first must be less than the second"
                ));
            }
        }
        if let Some(fault) = port.default.as_ref().and_then(Value::fault) {
            return bad(format!("its default is {fault}"));
        }
    }
    Ok(())
}

/// A text that is kept for good, once.
fn kept(text: &str) -> &'static str {
    static KNOWN: Mutex<BTreeSet<&'static str>> = Mutex::new(BTreeSet::new());
    let mut known = KNOWN.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some(known) = known.get(text) {
        return known;
    }
    let kept: &'static str = Box::leak(text.to_owned().into_boxed_str());
    known.insert(kept);
    kept
}

/// The type of a choice among these words, each with its doc.
pub fn choice(words: &[(String, String)]) -> Type {
    static KNOWN: Mutex<BTreeSet<&'static [(&'static str, &'static str)]>> =
        Mutex::new(BTreeSet::new());
    let words: Vec<(&'static str, &'static str)> =
        words.iter().map(|(word, doc)| (kept(word), kept(doc))).collect();
    let mut known = KNOWN.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some(known) = known.get(&words[..]) {
        return Type::Choice(known);
    }
    let words: &'static [_] = Box::leak(words.into_boxed_slice());
    known.insert(words);
    Type::Choice(words)
}

fn lines(doc: &str) -> &'static [&'static str] {
    Box::leak(doc.lines().map(kept).collect())
}

fn takes(port: &Port, default: bool) -> InputDef {
    let preset = match &port.default {
        Some(value) if default => Preset::Is(Box::leak(Box::new(value.clone()))),
        _ => Preset::None,
    };
    let opens = (!port.section.is_empty()).then(|| Group::Declared(kept(&port.section)));
    let was: &'static [&'static str] = Box::leak(port.was.iter().map(|name| kept(name)).collect());
    InputDef::declared(
        (kept(&port.name), was, lines(&port.doc), port.ty, port.arity),
        preset,
        (port.hard, port.soft, port.unit),
        opens,
    )
}

fn gives(port: &Port) -> OutputDef {
    OutputDef::declared(kept(&port.name), lines(&port.doc), port.ty)
}

fn declare(inputs: Vec<Port>, outputs: Vec<Port>, key: Key) -> Declared {
    fn all<T>(ports: &[Port], make: impl Fn(&Port) -> T) -> &'static [T] {
        Box::leak(ports.iter().map(make).collect())
    }
    let taken = all(&inputs, |port| takes(port, true));
    let def = |id, label, words, doc, inputs, outputs| {
        NodeDef::new((id, 1), label, words, doc, inputs, outputs, not_run)
    };
    Declared {
        group: def(
            GROUP,
            "Group",
            "subnet container nest asset gizmo",
            &[
                "Holds other nodes; its inputs and outputs are declared by whoever made it. Enter it to see them.",
            ],
            taken,
            all(&outputs, gives),
        ),
        group_input: def(
            GROUP_INPUT,
            "Inputs",
            "subnet in",
            &["What comes into the group: its inputs, for the nodes inside."],
            &[],
            all(&inputs, gives),
        ),
        group_output: def(
            GROUP_OUTPUT,
            "Outputs",
            "subnet out",
            &["What goes out of the group: each output gives what is wired to it here."],
            all(&outputs, |port| takes(&Port { arity: Arity::Optional, ..port.clone() }, false)),
            &[],
        ),
        parameters: def(
            PARAMETERS,
            "Parameters",
            "variables globals settings spare channel expose",
            &[
                "Values with names that many nodes read: set once here, or with --set on the command line.",
            ],
            taken,
            all(&inputs, gives),
        ),
        inputs,
        outputs,
        key,
    }
}

/// Plans never contain these nodes as steps.
fn not_run(_: &EvalCx, _: &[Vec<Value>]) -> Result<Vec<Value>, NodeError> {
    Err(NodeError::failed("a group is not run itself, but the nodes in it"))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn port(name: &str) -> Port {
        Port {
            hard: Some((0.0, 2.0)),
            default: Some(Value::Float(0.5)),
            ..Port::new(name, Type::Float)
        }
    }

    #[test]
    fn the_same_ports_are_the_same_interface_and_any_difference_is_another() {
        let made = |change: &dyn Fn(&mut Port)| {
            let mut changed = port("radius");
            change(&mut changed);
            Interface::new(vec![changed], vec![Port::new("curves", Type::Curves)]).unwrap()
        };
        let plain = made(&|_| {});
        assert_eq!(plain, made(&|_| {}));
        let changes: [&dyn Fn(&mut Port); 10] = [
            &|p| p.name = "width".into(),
            &|p| p.doc = "How wide.".into(),
            &|p| p.ty = Type::Field,
            &|p| p.ty = choice(&[("a".into(), String::new())]),
            &|p| p.arity = Arity::One,
            &|p| p.default = None,
            &|p| p.default = Some(Value::Int(0)),
            &|p| p.hard = Some((0.0, 3.0)),
            &|p| p.unit = Unit::Length,
            &|p| p.section = "Shape".into(),
        ];
        for (n, change) in changes.iter().enumerate() {
            assert_ne!(plain, made(change), "change {n}");
        }
        let swapped =
            Interface::new(vec![Port::new("curves", Type::Curves)], vec![port("radius")]).unwrap();
        assert_ne!(plain, swapped);
    }

    #[test]
    fn both_sides_of_a_group_say_what_it_declares() {
        let both = vec![port("radius"), Port { section: "Curl".into(), ..port("length") }];
        let interface = Interface::new(both, vec![Port::new("curves", Type::Curves)]).unwrap();
        let def = |kind| interface.def(kind).unwrap();
        assert_eq!(def(GROUP).input("length").unwrap().1.opens.unwrap().name(), "Curl");
        assert!(matches!(def(GROUP).inputs[0].default(), Some(Value::Float(x)) if x == 0.5));
        assert_eq!(def(GROUP_INPUT).outputs.len(), 2);
        assert!(def(GROUP_INPUT).inputs.is_empty() && def(GROUP_OUTPUT).outputs.is_empty());
        assert_eq!(def(GROUP_OUTPUT).input("curves").unwrap().1.ty, Type::Curves);
        assert_eq!(def(PARAMETERS).output("radius").unwrap().1.ty, Type::Float);
        assert!(interface.def("head").is_none());
    }

    #[test]
    fn what_is_no_interface_says_why() {
        #[track_caller]
        fn check(inputs: Vec<Port>, says: &str) {
            assert_eq!(Interface::new(inputs, vec![]).unwrap_err().to_string(), says);
        }
        check(vec![port("a"), port("a")], "two ports are called a: give each a name of its own");
        check(
            vec![port("Big Hair")],
            "\"Big Hair\" is no name of a port: use a lower case letter, then letters, digits and underscores, at most 64",
        );
        check(
            vec![Port { hard: Some((2.0, 1.0)), ..port("a") }],
            "a: its range is 2 to 1; the first must be less than the second",
        );
        check(
            vec![Port { default: Some(Value::Float(f32::NAN)), ..port("a") }],
            "a: its default is not a finite number",
        );
        check(
            (0..257).map(|n| port(&format!("p{n}"))).collect(),
            "there are 257 ports, and at most 256 can be",
        );
    }

    #[test]
    fn values_are_clamped_as_the_port_says() {
        assert!(matches!(port("a").clamped(Value::Float(9.0)), Value::Float(x) if x == 2.0));
        assert!(matches!(
            Port { hard: Some((1.0, 3.0)), ..port("a") }.clamped(Value::Int(0)),
            Value::Int(1)
        ));
    }
}
