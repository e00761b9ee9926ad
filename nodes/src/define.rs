//! How a node describes itself: one `node!` block and one `eval`.
//!
//! The block turns doc comments into tooltips and the manual, defaults and ranges into widgets, and names into typed `Inputs` and
//! `Outputs`, so every name is written once. Every parameter is an input: it has a value or a wire. Ids are chosen by hand and
//! stored in documents; they never change.

use crate::data::curves::Curves;
use crate::data::field::Field;
use crate::data::gestures::Gestures;
use crate::data::ramp::Ramp;
use crate::data::scalp::{HeadFrame, Scalp};
use crate::data::shapes::ShapeList;
use crate::data::strokes::Strokes;
use crate::eval::{EvalCx, TracedScalp};
use crate::maths::hash::{Key, KeyBuilder};
use glam::Vec3;
use std::collections::BTreeMap;
use std::sync::Arc;

pub use crate::error::{NodeError, short};

/// A node as the editor, the scheduler, the file format and the manual see it.
pub struct NodeDef {
    /// Id stored in documents; never changes.
    pub id: &'static str,
    /// Raised when old values change meaning; part of every key.
    pub version: u32,
    /// Label in menus.
    pub label: &'static str,
    /// Search terms: names in the trade and in other tools.
    pub words: &'static str,
    doc: &'static [&'static str],
    /// Makes fewer strands in preview quality, so its keys include the quality.
    pub thins: bool,
    /// Its lengths grow with the head while its input [`SCALES`] is on.
    pub scales: bool,
    /// Inputs.
    pub inputs: &'static [InputDef],
    /// Outputs.
    pub outputs: &'static [OutputDef],
    /// The function: values of each input in order; several for inputs with many wires, none for unset ones. A pure function.
    pub run: fn(&EvalCx, &[Vec<Value>]) -> Result<Vec<Value>, NodeError>,
    refuses: Option<Refuses>,
    masks: Option<Masks>,
}

/// What a node refuses by its inputs alone, before it looks at hair: asked before anything runs, and by `run`.
pub(crate) type Refuses = fn(&KnownInputs) -> Result<(), NodeError>;

/// Names of the masks that the node's scalp may have, where that can be told before it runs. May take as long as reading a mesh.
pub(crate) type Masks = fn(&KnownInputs) -> Option<Vec<String>>;

/// What comes to an input.
#[derive(Clone, Copy, Debug)]
pub enum Arriving<'a> {
    /// Nothing is set or wired.
    Nothing,
    /// This value.
    Value(&'a Value),
    /// What another node gives, once it has run.
    Wire,
}

/// What is known of a node's inputs: before it runs values and whether anything is wired, then all.
pub struct KnownInputs<'a> {
    def: &'static NodeDef,
    first: &'a dyn Fn(usize) -> Arriving<'a>,
}

impl<'a> KnownInputs<'a> {
    /// `first` says what comes to an input first, by its number.
    pub fn new(def: &'static NodeDef, first: &'a dyn Fn(usize) -> Arriving<'a>) -> Self {
        Self { def, first }
    }
    fn at(&self, name: &str) -> Arriving<'a> {
        self.def.input(name).map_or(Arriving::Nothing, |(i, _)| (self.first)(i))
    }
    /// Whether anything comes to an input; an empty path is nothing.
    pub fn arrives(&self, name: &str) -> bool {
        match self.at(name) {
            Arriving::Nothing => false,
            Arriving::Value(Value::Text(text)) => !text.is_empty(),
            Arriving::Value(_) | Arriving::Wire => true,
        }
    }
    /// The value of an input, or its default; none where nobody knows it yet.
    pub fn value(&self, name: &str) -> Option<Value> {
        match self.at(name) {
            Arriving::Nothing => self.def.input(name)?.1.default(),
            Arriving::Value(value) => Some(value.clone()),
            Arriving::Wire => None,
        }
    }
    /// Whether a choice has this value.
    pub fn is(&self, choice: &str, word: &str) -> bool {
        matches!(self.value(choice), Some(Value::Text(is)) if *is == *word)
    }
}

/// Id of the input that lets a node's lengths grow with the head.
pub const SCALES: &str = "scale_with_head";

/// One input: type, default, limits, unit and tooltip.
pub struct InputDef {
    /// Id stored in documents.
    pub name: &'static str,
    /// Former ids, still read from older documents.
    pub old_names: &'static [&'static str],
    doc: &'static [&'static str],
    /// Its type.
    pub ty: Type,
    /// Number of values it takes.
    pub arity: Arity,
    /// Whether the node's pieces note what they read of it.
    traced: bool,
    preset: Preset,
    /// Hard range: typed and wired values are clamped to it with a warning.
    pub hard: Option<(f64, f64)>,
    /// Range of the slider; typed values may go beyond, up to `hard`.
    pub soft: Option<(f64, f64)>,
    /// Unit of the number.
    pub unit: Unit,
    /// A true size that never grows with the head.
    pub fixed: bool,
    /// Search terms: names in the trade and in other tools.
    pub words: &'static str,
    /// Content of its file; `None` for inputs without a file.
    pub holds: Option<Holds>,
    /// Its handle in the viewport.
    pub handle: Option<Handle>,
    /// Returns why the input has no effect beside the node's other values, if it has none.
    pub idle: Option<Idle>,
    /// The group that starts with this input.
    pub opens: Option<Group>,
}

/// Default of an input.
#[derive(Clone, Copy)]
pub(crate) enum Preset {
    /// Required, or optional and unset.
    None,
    /// As written in `node!`.
    Made(fn() -> Value),
    /// As declared by a document.
    Is(&'static Value),
}

/// Content of a file, which selects its reader.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Holds {
    /// A mesh ([`crate::formats::read_mesh`]).
    Mesh,
    /// A picture ([`crate::formats::picture_in::read_picture`]).
    Picture,
}

/// Groups of inputs. The most used inputs come first and have no group.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Group {
    /// Position, and how it lies on the skin.
    Placement,
    /// Direction and shape.
    Shape,
    /// Shape of root and tip.
    RootAndTip,
    /// Ties and bands.
    Tie,
    /// Clumping with neighbours.
    Clumping,
    /// Width, radius and volume.
    Thickness,
    /// Number of CVs, tolerances, and whether lengths grow with the head.
    Detail,
    /// Random variation.
    Randomness,
    /// Declared by a document.
    Declared(&'static str),
}

impl Group {
    /// Label in the inspector and the manual.
    pub fn name(self) -> &'static str {
        match self {
            Group::Placement => "Placement",
            Group::Shape => "Shape",
            Group::RootAndTip => "Root and tip",
            Group::Tie => "Tie",
            Group::Clumping => "Clumping",
            Group::Thickness => "Thickness",
            Group::Detail => "Detail",
            Group::Randomness => "Randomness",
            Group::Declared(name) => name,
        }
    }
    /// Whether it is collapsed at first, being rarely needed.
    pub fn rare(self) -> bool {
        self == Group::Detail
    }
}

/// Given a node's values by input (`None`: unset, or unknown before the node runs), returns why an input has no effect, if it has
/// none.
pub type Idle = fn(&dyn Fn(&str) -> Option<Value>) -> Option<&'static str>;

/// The reason, if a choice has a value other than `word`.
pub(crate) fn unless(
    of: &dyn Fn(&str) -> Option<Value>,
    choice: &str,
    word: &str,
    why: &'static str,
) -> Option<&'static str> {
    matches!(of(choice), Some(Value::Text(is)) if *is != *word).then_some(why)
}

/// Refuses the shape `mesh` where nothing is wired to the input of that name.
pub(crate) fn without_mesh(told: &KnownInputs) -> Result<(), NodeError> {
    if told.is("shape", "mesh") && !told.arrives("mesh") {
        return Err(NodeError::failed(
            "shape is mesh, but nothing is wired to mesh: wire a Head node that reads a closed mesh, or choose \
             another shape",
        ));
    }
    Ok(())
}

/// One output.
pub struct OutputDef {
    /// Id stored in documents.
    pub name: &'static str,
    doc: &'static [&'static str],
    /// Its type.
    pub ty: Type,
}

/// Number of values an input takes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Arity {
    /// Exactly one: a value or a wire.
    One,
    /// At most one. Unset has a meaning of its own, given in the input's doc.
    Optional,
    /// Any number of wires, in the document's order.
    Many,
}

/// Type of an input or output.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Type {
    /// Boolean.
    Bool,
    /// Integer.
    Int,
    /// Number.
    Float,
    /// A number that may vary over the hair.
    Field,
    /// Position or direction.
    Vec3,
    /// Linear Rec.709 colour.
    Colour,
    /// Text.
    Text,
    /// One of several words, each with its doc.
    Choice(&'static [(&'static str, &'static str)]),
    /// Path of a file, relative to the document.
    File,
    /// Ramp.
    Ramp,
    /// Profiles in tiers.
    Shapes,
    /// Pen strokes.
    Strokes,
    /// Pen gestures that edit curves.
    Gestures,
    /// Guides, clusters, braids or hair.
    Curves,
    /// A head.
    Scalp,
}

impl Type {
    /// Name of the type in messages and the manual.
    pub fn name(self) -> &'static str {
        match self {
            Type::Bool => "true or false",
            Type::Int => "whole number",
            Type::Float => "number",
            Type::Field => "field (number, ramp, attribute or mask)",
            Type::Vec3 => "vector",
            Type::Colour => "colour",
            Type::Text => "text",
            Type::Choice(_) => "choice",
            Type::File => "file",
            Type::Ramp => "ramp",
            Type::Shapes => "shape list",
            Type::Strokes => "strokes",
            Type::Gestures => "gestures",
            Type::Curves => "curves",
            Type::Scalp => "scalp",
        }
    }
    /// Whether an output of this type may be wired to an input of type `to`.
    pub fn fits(self, to: Type) -> bool {
        self == to
            || matches!(
                (self, to),
                (Type::Int, Type::Float)
                    | (Type::Int | Type::Float, Type::Field)
                    | (Type::Vec3, Type::Colour)
                    | (Type::Colour, Type::Vec3)
            )
            || matches!(
                (self, to),
                (Type::Choice(some), Type::Choice(all))
                    if some.iter().all(|(word, _)| all.iter().any(|(known, _)| known == word))
            )
    }
}

/// Unit of a number. Documents store cm and degrees; functions use radians internally.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unit {
    /// Plain number.
    None,
    /// Fraction, shown as a percentage.
    Ratio,
    /// Centimetres; fields below 1 cm show millimetres.
    Length,
    /// Degrees.
    Angle,
    /// Count.
    Count,
    /// Count per centimetre.
    PerCm,
    /// Count per square centimetre.
    PerCm2,
    /// Degrees per centimetre.
    AnglePerCm,
}

impl Unit {
    /// The unit after a number, with a leading space; empty for plain numbers.
    pub fn suffix(self) -> &'static str {
        match self {
            Unit::Length => " cm",
            Unit::Angle => " degrees",
            Unit::AnglePerCm => " degrees per cm",
            Unit::PerCm => " per cm",
            Unit::PerCm2 => " per cm2",
            Unit::None | Unit::Ratio | Unit::Count => "",
        }
    }
}

/// Handle of an input in the viewport.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Handle {
    /// A point in space or on the scalp.
    Point,
    /// A circle of this radius.
    Radius,
    /// The circle of a ball whose centre the node's curves carry (`puff_centre`).
    Ball,
    /// A height above the scalp or along a curve.
    Length,
    /// An angle, as an arc.
    Angle,
    /// A position along the source curve.
    Along,
}

/// A file named by a document, read by the scheduler.
#[derive(Debug)]
pub struct FileData {
    /// Path as in the document, for messages.
    pub path: String,
    /// Extension, in lower case, without the dot.
    pub extension: String,
    /// Content.
    pub bytes: Arc<[u8]>,
    /// Files that it refers to, by the names it uses.
    pub sides: BTreeMap<String, Arc<[u8]>>,
}

/// Value on a wire or of an input. Cheap to clone.
#[derive(Clone, Debug)]
pub enum Value {
    /// See [`Type::Bool`].
    Bool(bool),
    /// See [`Type::Int`].
    Int(i64),
    /// See [`Type::Float`]; also a constant [`Type::Field`].
    Float(f32),
    /// See [`Type::Vec3`] and [`Type::Colour`].
    Vec3(Vec3),
    /// See [`Type::Text`]; also the word of a [`Type::Choice`] and the path of a [`Type::File`] before it is read.
    Text(Arc<str>),
    /// See [`Type::Field`].
    Field(Arc<Field>),
    /// See [`Type::Ramp`].
    Ramp(Arc<Ramp>),
    /// See [`Type::Shapes`].
    Shapes(Arc<ShapeList>),
    /// See [`Type::Strokes`].
    Strokes(Arc<Strokes>),
    /// See [`Type::Gestures`].
    Gestures(Arc<Gestures>),
    /// See [`Type::File`].
    File(Arc<FileData>),
    /// See [`Type::Curves`].
    Curves(Curves),
    /// See [`Type::Scalp`].
    Scalp(Arc<Scalp>),
}

impl Value {
    /// The value in words.
    pub fn type_name(&self) -> &'static str {
        match self {
            Value::Bool(_) => Type::Bool.name(),
            Value::Int(_) => Type::Int.name(),
            Value::Float(_) => Type::Float.name(),
            Value::Vec3(_) => Type::Vec3.name(),
            Value::Text(_) => Type::Text.name(),
            Value::Field(_) => "field",
            Value::Ramp(_) => Type::Ramp.name(),
            Value::Shapes(_) => Type::Shapes.name(),
            Value::Strokes(_) => Type::Strokes.name(),
            Value::Gestures(_) => Type::Gestures.name(),
            Value::File(_) => Type::File.name(),
            Value::Curves(_) => Type::Curves.name(),
            Value::Scalp(_) => Type::Scalp.name(),
        }
    }
    /// Hash of the content. A file counts by its bytes, never by its path.
    pub fn key(&self) -> Key {
        match self {
            Value::Bool(b) => KeyBuilder::new("bool").int(u64::from(*b)).finish(),
            Value::Int(i) => KeyBuilder::new("int").int(*i as u64).finish(),
            Value::Float(x) => KeyBuilder::new("float").float(*x).finish(),
            Value::Vec3(v) => KeyBuilder::new("vec3").vec3(*v).finish(),
            Value::Text(text) => KeyBuilder::new("text").text(text).finish(),
            Value::Field(field) => match field.constant() {
                Some(x) => Value::Float(x).key(),
                None => field.add_to(KeyBuilder::new("field")).finish(),
            },
            Value::Ramp(ramp) => ramp.add_to(KeyBuilder::new("ramp")).finish(),
            Value::Shapes(shapes) => shapes.add_to(KeyBuilder::new("shapes")).finish(),
            Value::Strokes(strokes) => strokes.key(),
            Value::Gestures(gestures) => gestures.key(),
            Value::File(file) => {
                let key = KeyBuilder::new("file").text(&file.extension).column(&file.bytes);
                file.sides
                    .iter()
                    .fold(key, |key, (name, bytes)| key.text(name).column(bytes))
                    .finish()
            }
            Value::Curves(curves) => curves.key(),
            Value::Scalp(scalp) => scalp.key(),
        }
    }
    /// Why the value is invalid for any input; `None` if it is valid. NaN and infinities are rejected here, before anything runs.
    pub fn fault(&self) -> Option<String> {
        let finite = match self {
            Value::Float(x) => x.is_finite(),
            Value::Vec3(v) => v.is_finite(),
            Value::Field(field) => field.is_finite(),
            Value::Shapes(shapes) => return shapes.fault(),
            Value::Strokes(strokes) => return strokes.fault(),
            Value::Gestures(gestures) => return gestures.fault(),
            _ => true,
        };
        (!finite).then(|| "not a finite number".to_owned())
    }
    /// Memory that the value points to, bytes.
    pub fn bytes(&self) -> usize {
        match self {
            Value::Curves(curves) => curves.bytes(),
            Value::Scalp(scalp) => scalp.bytes(),
            Value::File(file) => file.bytes.len(),
            Value::Strokes(strokes) => strokes.bytes(),
            Value::Gestures(gestures) => gestures.bytes(),
            Value::Field(field) => field.bytes(),
            _ => 64,
        }
    }
}

macro_rules! values {
    ($($ty:ty => |$x:ident| $value:expr;)*) => {$(
        impl From<$ty> for Value {
            fn from($x: $ty) -> Self {
                $value
            }
        }
    )*};
}
values! {
    bool => |x| Value::Bool(x);
    i64 => |x| Value::Int(x);
    i32 => |x| Value::Int(i64::from(x));
    f32 => |x| Value::Float(x);
    Vec3 => |x| Value::Vec3(x);
    &str => |x| Value::Text(x.into());
    Field => |x| Value::Field(Arc::new(x));
    Arc<Field> => |x| Value::Field(x);
    Ramp => |x| Value::Ramp(Arc::new(x));
    ShapeList => |x| Value::Shapes(Arc::new(x));
    Strokes => |x| Value::Strokes(Arc::new(x));
    Gestures => |x| Value::Gestures(Arc::new(x));
    Curves => |x| Value::Curves(x);
    Scalp => |x| Value::Scalp(Arc::new(x));
    Arc<Scalp> => |x| Value::Scalp(x);
}

/// A Rust type of inputs.
pub trait Input: Sized {
    /// The type in documents.
    const TYPE: Type;
    /// Number of values it takes.
    const ARITY: Arity = Arity::One;
    /// Whether the node's pieces note what they read of it.
    const TRACED: bool = false;
    /// Reads the wired or set value, or the default.
    fn read(cx: &EvalCx, values: &[Value], def: &InputDef) -> Result<Self, NodeError>;
    /// Converts a typed value to true centimetres, of which a typed one is `unit`.
    fn grow(&mut self, _def: &InputDef, _unit: f32) {}
}

/// A Rust type of outputs.
pub trait Output {
    /// The type in documents.
    const TYPE: Type;
}
impl Output for Curves {
    const TYPE: Type = Type::Curves;
}
impl Output for Arc<Scalp> {
    const TYPE: Type = Type::Scalp;
}
impl Output for Arc<Field> {
    const TYPE: Type = Type::Field;
}

/// A field with the hard range of its input, to be bound to curves. Lengths are read in true centimetres: typed numbers, ramps
/// and painted masks grow with the head, while an attribute that is a length, also in a product, is in centimetres already.
#[derive(Clone, Debug)]
pub struct FieldInput {
    /// Source of the number.
    pub field: Arc<Field>,
    /// Hard range of the typed value.
    pub range: (f32, f32),
    /// Centimetres per typed centimetre.
    unit: f32,
}

impl FieldInput {
    /// The same number everywhere, for a node's own use.
    pub(crate) fn everywhere(x: f32) -> Self {
        Self { field: Arc::new(Field::Constant(x)), range: (x, x), unit: 1.0 }
    }
    /// The field on the curves of a tuft; masks need the scalp.
    pub fn on<'a>(
        &'a self,
        tuft: &'a crate::data::curves::Tuft,
        scalp: Option<&Scalp>,
    ) -> Result<crate::data::field::Sampler<'a>, NodeError> {
        Ok(self.field.in_cm(tuft, scalp, self.range, self.unit)?)
    }
    /// The same outside of pieces that run by place: where a field has a mask, which may be a section, nothing is traced
    /// ([`InputDef::key_untraced`]).
    pub fn on_traced<'a>(
        &'a self,
        tuft: &'a crate::data::curves::Tuft,
        scalp: Option<&TracedScalp>,
    ) -> Result<crate::data::field::Sampler<'a>, NodeError> {
        self.on(tuft, scalp.map(TracedScalp::whole))
    }
    /// Whether it is the attribute of this name and nothing else.
    pub fn is_attribute(&self, name: &str) -> bool {
        matches!(&*self.field, Field::Attribute(own) if own == name)
    }
    /// The value, if it is the same everywhere.
    pub fn constant(&self) -> Option<f32> {
        self.field.constant().map(|x| x.max(self.range.0).min(self.range.1) * self.unit)
    }
}

fn one(values: &[Value], def: &InputDef) -> Result<Value, NodeError> {
    if let Some(value) = values.first() {
        return Ok(value.clone());
    }
    def.default().ok_or(NodeError::Unconnected { input: def.name, expected: def.ty.name() })
}

fn wrong(def: &InputDef, found: &Value) -> NodeError {
    NodeError::WrongType { input: def.name, expected: def.ty.name(), found: found.type_name() }
}

fn clamped(cx: &EvalCx, def: &InputDef, x: f64) -> f64 {
    let Some((lo, hi)) = def.hard else { return x };
    let y = x.clamp(lo, hi);
    // Numbers are single precision, so a typed limit may be slightly exceeded. Integers are exact and compared as they are.
    let is_limit = def.ty != Type::Int && x as f32 == y as f32;
    if y != x && !is_limit {
        let unit = def.unit.suffix();
        let x = if def.ty == Type::Int { x.to_string() } else { (x as f32).to_string() };
        cx.warn(format!("{} {x}{unit} is outside {lo} to {hi}{unit} and was clamped", def.name));
    }
    y
}

impl Input for f32 {
    const TYPE: Type = Type::Float;
    fn read(cx: &EvalCx, values: &[Value], def: &InputDef) -> Result<Self, NodeError> {
        let x = match one(values, def)? {
            Value::Float(x) => f64::from(x),
            Value::Int(x) => x as f64,
            other => return Err(wrong(def, &other)),
        };
        Ok(clamped(cx, def, x) as f32)
    }
    fn grow(&mut self, def: &InputDef, unit: f32) {
        *self = def.grown(*self, unit);
    }
}
impl Input for Vec3 {
    const TYPE: Type = Type::Vec3;
    fn read(_: &EvalCx, values: &[Value], def: &InputDef) -> Result<Self, NodeError> {
        match one(values, def)? {
            Value::Vec3(x) => Ok(x),
            other => Err(wrong(def, &other)),
        }
    }
    fn grow(&mut self, def: &InputDef, unit: f32) {
        *self = self.map(|x| def.grown(x, unit));
    }
}
impl Input for i64 {
    const TYPE: Type = Type::Int;
    fn read(cx: &EvalCx, values: &[Value], def: &InputDef) -> Result<Self, NodeError> {
        match one(values, def)? {
            Value::Int(x) if def.hard.is_none() => Ok(x),
            Value::Int(x) => Ok(clamped(cx, def, x as f64) as i64),
            other => Err(wrong(def, &other)),
        }
    }
}
impl Input for FieldInput {
    const TYPE: Type = Type::Field;
    fn read(cx: &EvalCx, values: &[Value], def: &InputDef) -> Result<Self, NodeError> {
        let field = match one(values, def)? {
            Value::Float(x) => Arc::new(Field::Constant(clamped(cx, def, f64::from(x)) as f32)),
            Value::Int(x) => Arc::new(Field::Constant(clamped(cx, def, x as f64) as f32)),
            Value::Ramp(ramp) => Arc::new(Field::Ramp((*ramp).clone())),
            Value::Field(field) => field,
            other => return Err(wrong(def, &other)),
        };
        let (lo, hi) = def.hard.unwrap_or((f64::from(f32::MIN), f64::from(f32::MAX)));
        Ok(Self { field, range: (lo as f32, hi as f32), unit: 1.0 })
    }
    fn grow(&mut self, def: &InputDef, unit: f32) {
        self.unit = def.grown(1.0, unit);
    }
}

impl Input for Arc<Ramp> {
    const TYPE: Type = Type::Ramp;
    fn read(cx: &EvalCx, values: &[Value], def: &InputDef) -> Result<Self, NodeError> {
        let Value::Ramp(ramp) = one(values, def)? else {
            return Err(wrong(def, &one(values, def)?));
        };
        let Some((lo, hi)) = def.hard else { return Ok(ramp) };
        let within = |y: f32| y >= lo as f32 && y <= hi as f32;
        match ramp.stops().iter().find(|(_, y)| !within(*y)) {
            Some((_, y)) => {
                clamped(cx, def, f64::from(*y));
                Ok(Arc::new(ramp.clamped(lo as f32, hi as f32)))
            }
            None => Ok(ramp),
        }
    }
}

macro_rules! plain_inputs {
    ($($ty:ty, $of:ident <= $($variant:ident)|+;)*) => {$(
        impl Input for $ty {
            const TYPE: Type = Type::$of;
            fn read(_: &EvalCx, values: &[Value], def: &InputDef) -> Result<Self, NodeError> {
                match one(values, def)? {
                    $(Value::$variant(x) => Ok(x.into()),)+
                    other => Err(wrong(def, &other)),
                }
            }
        }
    )*};
}
plain_inputs! {
    bool, Bool <= Bool;
    Arc<str>, Text <= Text;
    Arc<ShapeList>, Shapes <= Shapes;
    Arc<Strokes>, Strokes <= Strokes;
    Arc<Gestures>, Gestures <= Gestures;
    Curves, Curves <= Curves;
    Arc<Scalp>, Scalp <= Scalp;
}

/// A linear Rec.709 colour.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Colour(pub Vec3);
impl Input for Colour {
    const TYPE: Type = Type::Colour;
    fn read(_: &EvalCx, values: &[Value], def: &InputDef) -> Result<Self, NodeError> {
        match one(values, def)? {
            Value::Vec3(x) => Ok(Colour(x.max(Vec3::ZERO))),
            other => Err(wrong(def, &other)),
        }
    }
}
impl Input for Arc<FileData> {
    const TYPE: Type = Type::File;
    fn read(_: &EvalCx, values: &[Value], def: &InputDef) -> Result<Self, NodeError> {
        match one(values, def)? {
            Value::File(file) => Ok(file),
            other => Err(wrong(def, &other)),
        }
    }
}
impl Input for Option<Arc<FileData>> {
    const TYPE: Type = Type::File;
    const ARITY: Arity = Arity::Optional;
    fn read(_: &EvalCx, values: &[Value], def: &InputDef) -> Result<Self, NodeError> {
        match values.first() {
            None => Ok(None),
            Some(Value::File(file)) => Ok(Some(file.clone())),
            Some(Value::Text(path)) if path.is_empty() => Ok(None),
            Some(other) => Err(wrong(def, other)),
        }
    }
}
macro_rules! optional_and_many {
    ($($ty:ty, $variant:ident;)*) => {$(
        impl Input for Option<$ty> {
            const TYPE: Type = Type::$variant;
            const ARITY: Arity = Arity::Optional;
            fn read(_: &EvalCx, values: &[Value], def: &InputDef) -> Result<Self, NodeError> {
                match values.first() {
                    None => Ok(None),
                    Some(Value::$variant(x)) => Ok(Some(x.clone())),
                    Some(other) => Err(wrong(def, other)),
                }
            }
        }
        impl Input for Vec<$ty> {
            const TYPE: Type = Type::$variant;
            const ARITY: Arity = Arity::Many;
            fn read(_: &EvalCx, values: &[Value], def: &InputDef) -> Result<Self, NodeError> {
                values
                    .iter()
                    .map(|value| match value {
                        Value::$variant(x) => Ok(x.clone()),
                        other => Err(wrong(def, other)),
                    })
                    .collect()
            }
        }
    )*};
}
optional_and_many! {
    Curves, Curves;
    Arc<Scalp>, Scalp;
}

impl Input for Option<TracedScalp> {
    const TYPE: Type = Type::Scalp;
    const ARITY: Arity = Arity::Optional;
    const TRACED: bool = true;
    fn read(cx: &EvalCx, values: &[Value], def: &InputDef) -> Result<Self, NodeError> {
        let scalp = Option::<Arc<Scalp>>::read(cx, values, def)?;
        Ok(scalp.map(TracedScalp::new))
    }
}

/// An input that may say how large a head is.
pub(crate) trait Headed {
    /// The frame of the head.
    fn frame(&self) -> Option<&HeadFrame>;
}
impl Headed for Arc<Scalp> {
    fn frame(&self) -> Option<&HeadFrame> {
        Some(Scalp::frame(self))
    }
}
impl Headed for TracedScalp {
    fn frame(&self) -> Option<&HeadFrame> {
        Some(self.head().frame())
    }
}
impl<T: Headed> Headed for Option<T> {
    fn frame(&self) -> Option<&HeadFrame> {
        self.as_ref().and_then(T::frame)
    }
}

/// Numbers and shapes that may be unset, such as those that a preset fills in.
macro_rules! optional {
    ($($ty:ty),*) => {$(
        impl Input for Option<$ty> {
            const TYPE: Type = <$ty as Input>::TYPE;
            const ARITY: Arity = Arity::Optional;
            fn read(cx: &EvalCx, values: &[Value], def: &InputDef) -> Result<Self, NodeError> {
                if values.is_empty() {
                    return Ok(None);
                }
                <$ty as Input>::read(cx, values, def).map(Some)
            }
            fn grow(&mut self, def: &InputDef, unit: f32) {
                if let Some(x) = self {
                    x.grow(def, unit);
                }
            }
        }
    )*};
}
optional!(f32, FieldInput, Arc<ShapeList>);

/// Ends a node with what it refuses by its inputs alone, for [`node!`].
pub(crate) fn refuse(def: &'static NodeDef, values: &[Vec<Value>]) -> Result<(), NodeError> {
    let first = |i: usize| {
        let value = values.get(i).and_then(|values| values.first());
        value.map_or(Arriving::Nothing, Arriving::Value)
    };
    def.refused(&KnownInputs::new(def, &first))
}

/// Reads the word of a choice, for [`choice!`].
pub(crate) fn read_choice<T: Copy>(
    values: &[Value],
    def: &InputDef,
    words: &[(&str, T)],
) -> Result<T, NodeError> {
    match one(values, def)? {
        Value::Text(word) => {
            words.iter().find(|(known, _)| **known == *word).map(|(_, it)| *it).ok_or_else(|| {
                let known: Vec<&str> = words.iter().map(|(word, _)| *word).collect();
                NodeError::BadValue {
                    input: def.name,
                    value: format!("{:?}", short(&word)),
                    reason: format!("is none of {}", known.join(", ")),
                }
            })
        }
        other => Err(wrong(def, &other)),
    }
}

/// Label of a choice's word: with the beginning of its doc behind it, if that names it (`4a: coils of 5 mm` for `4a`, where the doc
/// is `Coils of 5 mm (4a): small ...`).
pub fn choice_name(word: &str, explanation: &str) -> String {
    let named = explanation.split_once(':').map(|(name, _)| name.trim());
    let end = format!("({word})");
    let name = named.and_then(|name| name.strip_suffix(end.as_str()));
    let spoken = word.replace('_', " ");
    let mut letters = name.map_or("", str::trim).chars();
    match letters.next() {
        Some(first) => format!("{spoken}: {}{}", first.to_lowercase(), letters.as_str()),
        None => spoken,
    }
}

/// Declares the words of a choice, each with its doc.
macro_rules! choice {
    ($(#[doc = $doc:literal])* $name:ident { $($(#[doc = $word_doc:literal])+ $variant:ident = $word:literal,)+ }) => {
        $(#[doc = $doc])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub(crate) enum $name { $($(#[doc = $word_doc])+ $variant,)+ }
        impl $crate::define::Input for $name {
            const TYPE: $crate::define::Type =
                $crate::define::Type::Choice(&[$(($word, concat!($($word_doc),+))),+]);
            fn read(
                _: &$crate::eval::EvalCx,
                values: &[$crate::define::Value],
                def: &$crate::define::InputDef,
            ) -> Result<Self, $crate::define::NodeError> {
                $crate::define::read_choice(values, def, &[$(($word, $name::$variant)),+])
            }
        }
        impl From<$name> for $crate::define::Value {
            fn from(it: $name) -> Self {
                match it { $($name::$variant => $word.into(),)+ }
            }
        }
    };
}
pub(crate) use choice;

impl InputDef {
    pub(crate) const fn new<T: Input>(
        name: &'static str,
        doc: &'static [&'static str],
        old_names: &'static [&'static str],
    ) -> Self {
        Self {
            name,
            old_names,
            doc,
            ty: T::TYPE,
            arity: T::ARITY,
            traced: T::TRACED,
            preset: Preset::None,
            hard: None,
            soft: None,
            unit: Unit::None,
            fixed: false,
            words: "",
            holds: None,
            handle: None,
            idle: None,
            opens: None,
        }
    }
    /// As declared by a document.
    pub(crate) fn declared(
        (name, old_names, doc, ty, arity): (
            &'static str,
            &'static [&'static str],
            &'static [&'static str],
            Type,
            Arity,
        ),
        preset: Preset,
        (hard, soft, unit): (Option<(f64, f64)>, Option<(f64, f64)>, Unit),
        opens: Option<Group>,
    ) -> Self {
        Self {
            name,
            old_names,
            doc,
            holds: None,
            ty,
            arity,
            traced: false,
            preset,
            hard,
            soft,
            unit,
            fixed: false,
            words: "",
            handle: None,
            idle: None,
            opens,
        }
    }
    pub(crate) const fn opens(mut self, group: Group) -> Self {
        self.opens = Some(group);
        self
    }
    pub(crate) const fn made(mut self, default: fn() -> Value) -> Self {
        self.preset = Preset::Made(default);
        self
    }
    pub(crate) const fn hard(mut self, lo: f64, hi: f64) -> Self {
        self.hard = Some((lo, hi));
        self
    }
    pub(crate) const fn soft(mut self, lo: f64, hi: f64) -> Self {
        self.soft = Some((lo, hi));
        self
    }
    pub(crate) const fn idle(mut self, idle: Idle) -> Self {
        self.idle = Some(idle);
        self
    }
    pub(crate) const fn unit(mut self, unit: Unit) -> Self {
        self.unit = unit;
        self
    }
    pub(crate) const fn fixed(mut self) -> Self {
        self.fixed = true;
        self
    }
    pub(crate) const fn words(mut self, words: &'static str) -> Self {
        self.words = words;
        self
    }
    pub(crate) const fn holds(mut self, holds: Holds) -> Self {
        self.holds = Some(holds);
        self
    }
    pub(crate) const fn handle(mut self, handle: Handle) -> Self {
        self.handle = Some(handle);
        self
    }
    /// The value of a fresh node; `None` for required and unset inputs.
    pub fn default(&self) -> Option<Value> {
        match &self.preset {
            Preset::None => None,
            Preset::Made(make) => Some(make()),
            Preset::Is(value) => Some((*value).clone()),
        }
    }
    /// The key of a value as pieces read it that note what they read: without what they note; none where what is read of it may come of
    /// that unnoted.
    pub fn key_untraced(&self, value: &Value) -> Option<Key> {
        match value {
            Value::Scalp(scalp) if self.traced => Some(scalp.key_untraced()),
            // A mask may be a section, and fields are read outside of pieces too.
            Value::Field(field) if field.has_mask() => None,
            value => Some(value.key()),
        }
    }
    /// Whether it has a default value.
    pub fn has_default(&self) -> bool {
        !matches!(self.preset, Preset::None)
    }
    /// Scales a typed number for a head on which a typed centimetre is `unit` true ones: lengths grow, and counts per centimetre
    /// shrink.
    pub fn grown(&self, x: f32, unit: f32) -> f32 {
        match self.unit {
            _ if self.fixed => x,
            Unit::Length => x * unit,
            Unit::PerCm | Unit::AnglePerCm => x / unit,
            Unit::PerCm2 => x / (unit * unit),
            Unit::None | Unit::Ratio | Unit::Angle | Unit::Count => x,
        }
    }
    /// Tooltip and manual entry.
    pub fn doc(&self) -> String {
        let more = if self.fixed { " It does not grow with the head." } else { "" };
        paragraphs(self.doc) + more
    }
}

impl OutputDef {
    /// As declared by a document.
    pub(crate) fn declared(name: &'static str, doc: &'static [&'static str], ty: Type) -> Self {
        Self { name, doc, ty }
    }
    pub(crate) const fn new<T: Output>(name: &'static str, doc: &'static [&'static str]) -> Self {
        Self { name, doc, ty: T::TYPE }
    }
    /// Tooltip and manual entry.
    pub fn doc(&self) -> String {
        paragraphs(self.doc)
    }
}

impl NodeDef {
    /// The id with its article: "a braid", "an interpolate".
    pub fn with_article(&self) -> String {
        let article = if self.id.starts_with(['a', 'e', 'i', 'o', 'u']) { "an" } else { "a" };
        format!("{article} {}", self.id)
    }
    pub(crate) const fn new(
        (id, version): (&'static str, u32),
        label: &'static str,
        words: &'static str,
        doc: &'static [&'static str],
        inputs: &'static [InputDef],
        outputs: &'static [OutputDef],
        run: fn(&EvalCx, &[Vec<Value>]) -> Result<Vec<Value>, NodeError>,
    ) -> Self {
        let (thins, scales, refuses, masks) = (false, false, None, None);
        Self { id, version, label, words, doc, thins, scales, inputs, outputs, run, refuses, masks }
    }
    pub(crate) const fn refuses(mut self, refuses: Refuses) -> Self {
        self.refuses = Some(refuses);
        self
    }
    pub(crate) const fn masks(mut self, masks: Masks) -> Self {
        self.masks = Some(masks);
        self
    }
    /// Why the node will have no result, as far as its inputs alone tell.
    ///
    /// # Errors
    /// What [`Self::run`] would say.
    pub fn refused(&self, told: &KnownInputs) -> Result<(), NodeError> {
        self.refuses.map_or(Ok(()), |refuses| refuses(told))
    }
    /// Names of the masks that the node's scalp may have; none where only running it tells.
    pub fn mask_names(&self, told: &KnownInputs) -> Option<Vec<String>> {
        self.masks.and_then(|masks| masks(told))
    }
    pub(crate) const fn thins(mut self) -> Self {
        self.thins = true;
        self
    }
    pub(crate) const fn scales(mut self) -> Self {
        self.scales = true;
        self
    }
    /// Whether lengths grow with the head, given these values: [`SCALES`] is on and has an effect.
    pub(crate) fn grows(&self, told: bool, values: &[Vec<Value>]) -> bool {
        let of = |name: &str| {
            let (i, def) = self.input(name)?;
            values.get(i)?.first().cloned().or_else(|| def.default())
        };
        let idle = self.input(SCALES).and_then(|(_, def)| def.idle);
        told && idle.is_none_or(|idle| idle(&of).is_none())
    }
    /// Tooltip and page of the manual.
    pub fn doc(&self) -> String {
        paragraphs(self.doc)
    }
    /// The input with this id, current or former, and its index.
    pub fn input(&self, name: &str) -> Option<(usize, &'static InputDef)> {
        let inputs = self.inputs.iter().enumerate();
        inputs
            .clone()
            .find(|(_, d)| d.name == name)
            .or_else(|| inputs.clone().find(|(_, d)| d.old_names.contains(&name)))
    }
    /// The inputs by group, in order; those before the first group have none.
    pub fn groups(&self) -> impl Iterator<Item = (Option<Group>, &'static [InputDef])> {
        self.inputs.chunk_by(|_, next| next.opens.is_none()).map(|inputs| (inputs[0].opens, inputs))
    }
    /// The output with this id, and its index.
    pub fn output(&self, name: &str) -> Option<(usize, &'static OutputDef)> {
        self.outputs.iter().enumerate().find(|(_, d)| d.name == name)
    }
}

/// Joins doc comment lines into paragraphs.
fn paragraphs(lines: &[&str]) -> String {
    let mut text = String::new();
    for line in lines.iter().map(|line| line.trim()) {
        let gap = match (text.is_empty() || text.ends_with('\n'), line.is_empty()) {
            (true, _) => "",
            (false, true) => "\n\n",
            (false, false) => " ",
        };
        text.push_str(gap);
        text.push_str(line);
    }
    text.trim_end().to_owned()
}

/// Declares a node. See `shape/resample.rs` for a whole file. A [`Group`] in brackets precedes the first input in it
/// (`cluster/interpolate.rs`).
///
/// The flag `thins`: see [`NodeDef::thins`]. The flag `scales`, for nodes with the inputs `scalp` and `scale_with_head`: `eval`
/// gets all numbers except `fixed()` ones in true centimetres; other lengths use [`EvalCx::unit`]. The flag `refuses(function)`:
/// see [`Refuses`]; `eval` need not ask again. The flag `masks(function)`: see [`Masks`].
macro_rules! node {
    (@head $inputs:ident, $values:ident) => { std::option::Option::None };
    (@head $inputs:ident, $values:ident, scales $(, $flag:ident)*) => {
        $crate::define::Headed::frame(&$inputs.scalp).filter(|_| NODE.grows($inputs.scale_with_head, $values))
    };
    (@head $inputs:ident, $values:ident, $other:ident $(, $flag:ident)*) => {
        $crate::define::node!(@head $inputs, $values $(, $flag)*)
    };
    (
        $(#[doc = $doc:literal])*
        $id:literal, version $version:literal, label $label:literal, words $words:literal
            $(, $flag:ident $(($by:ident))?)*;
        inputs {$(
            $([$group:ident])?
            $(#[doc = $in_doc:literal])*
            $input:ident $(| $old:ident)*: $in_ty:ty $(= $default:expr)?
                $(, $opt:ident($($arg:expr),*))*;
        )*}
        outputs { $($(#[doc = $out_doc:literal])* $output:ident: $out_ty:ty;)* }
    ) => {
        struct Inputs { $($input: $in_ty,)* }
        struct Outputs { $($output: $out_ty,)* }

        pub(crate) static NODE: $crate::define::NodeDef = {
            #[allow(unused_imports)]
            use $crate::define::{Group, Handle, Holds, InputDef, OutputDef, Unit::*, Value};
            static INPUTS: &[InputDef] = &[$(
                InputDef::new::<$in_ty>(stringify!($input), &[$($in_doc),*], &[$(stringify!($old)),*])
                    $(.opens(Group::$group))?
                    $(.made(|| Value::from($default)))?
                    $(.$opt($($arg),*))*,
            )*];
            $crate::define::NodeDef::new(
                ($id, $version),
                $label,
                $words,
                &[$($doc),*],
                INPUTS,
                &[$(OutputDef::new::<$out_ty>(stringify!($output), &[$($out_doc),*]),)*],
                |cx, values| {
                    $crate::define::refuse(&NODE, values)?;
                    let mut _at = 0..;
                    let mut inputs = Inputs {$(
                        $input: {
                            let i = _at.next().unwrap_or_default();
                            let set: &[Value] = values.get(i).map_or(&[], Vec::as_slice);
                            <$in_ty as $crate::define::Input>::read(cx, set, &INPUTS[i])?
                        },
                    )*};
                    let cx = &cx.on_head($crate::define::node!(@head inputs, values $(, $flag)*));
                    let mut _defs = INPUTS.iter();
                    $(if let Some(def) = _defs.next() {
                        $crate::define::Input::grow(&mut inputs.$input, def, cx.unit());
                    })*
                    let outputs: Outputs = eval(cx, inputs)?;
                    Ok(vec![$(Value::from(outputs.$output)),*])
                },
            )$(.$flag($($by)?))*
        };
    };
}
pub(crate) use node;
