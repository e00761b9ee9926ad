//! Random documents, values and edits for property tests, from a seed.

use super::budget::{Budget, Term};
use super::edit::Edit;
use super::{
    Document, FileEntry, Frame, Node, NodeId, Origin, Point, SavedLook, SavedView, Setting, Socket,
    Thumbnail, gestures, strokes, thumbnail,
};
use crate::values;
use coif_nodes::data::field::Field;
use coif_nodes::data::gestures::{Gesture, GestureView, Gestures, Layer, PenSample, Tool};
use coif_nodes::data::ramp::{Blend, Ramp};
use coif_nodes::data::shapes::{ShapeList, Tier, TurnProfile};
use coif_nodes::data::strokes::{Brush, Mode, Sample, Stroke, Strokes};
use coif_nodes::declared::{self, Interface, Port};
use coif_nodes::define::{Arity, NodeDef, Type, Unit, Value};
use coif_nodes::maths::hash::Dice;
use glam::{Vec2, Vec3};

/// Draws from a seed.
pub(crate) struct Random(Dice, u64);

/// Texts that a writer can get wrong.
const TEXTS: [&str; 10] = [
    "plain",
    "",
    "two\nlines\r\n\ttab",
    "\"quoted\" \\ back",
    "// no comment /* nor */ this",
    "Übergang 三つ編み \u{1F9D1}\u{200D}\u{1F9B1}",
    "\u{0}\u{7}\u{85}\u{2028}\u{202E}",
    "(a: [1, {\"b\": 'c'}])",
    "r#\"raw\"#",
    "trailing \\",
];

/// Texts that no declaration here explains.
const RAW: [&str; 7] = [
    "Twist(3, [1, 2])",
    "'\"'",
    "r#\"not \" the end\"#",
    "(\n  a: 1, // kept\n  b: /* too */ {\"x\": ()},\n)",
    "1e400",
    "[Some(\"// no comment\"), None]",
    "b\"bytes\"",
];

impl Random {
    pub(crate) fn new(seed: u64) -> Self {
        Self(Dice::new(seed, 0, "documents"), 0)
    }
    pub(crate) fn bits(&mut self) -> u64 {
        self.1 += 1;
        self.0.bits(self.1, 0)
    }
    pub(crate) fn below(&mut self, n: usize) -> usize {
        (self.bits() % n.max(1) as u64) as usize
    }
    pub(crate) fn pick<T: Clone>(&mut self, of: &[T]) -> T {
        of[self.below(of.len())].clone()
    }
    fn chance(&mut self, one_in: usize) -> bool {
        self.below(one_in) == 0
    }
    pub(crate) fn text(&mut self) -> String {
        self.pick(&TEXTS).to_owned()
    }
    fn words(&mut self) -> Option<String> {
        self.chance(2).then(|| self.text()).filter(|text| !text.is_empty())
    }
    /// Any finite number: of every size, and the borders.
    pub(crate) fn number(&mut self) -> f32 {
        let border =
            [0.0, -0.0, 1.0, 0.1, 1e-45, f32::MAX, f32::MIN, 1e16, 16_777_217.0, 1.0 / 3.0];
        let any = f32::from_bits(self.bits() as u32);
        if self.chance(3) || !any.is_finite() { self.pick(&border) } else { any }
    }
    pub(crate) fn unit(&mut self) -> f32 {
        self.below(1001) as f32 / 1000.0
    }
    fn vec3(&mut self) -> Vec3 {
        Vec3::new(self.number(), self.number(), self.number())
    }
    fn ramp(&mut self) -> Ramp {
        let mut at: Vec<f32> = (0..=self.below(5)).map(|_| self.unit()).collect();
        at.sort_by(f32::total_cmp);
        let blend = self.pick(&[Blend::Step, Blend::Linear, Blend::Smooth]);
        Ramp::new(blend, at.into_iter().map(|x| (x, self.number())).collect()).unwrap()
    }
    fn field(&mut self, depth: usize) -> Field {
        match self.below(if depth < 4 { 5 } else { 4 }) {
            0 => Field::Constant(self.number()),
            1 => Field::Ramp(self.ramp()),
            2 => Field::Attribute(self.text()),
            3 => Field::Mask(self.text()),
            _ => Field::Product((0..self.below(4)).map(|_| self.field(depth + 1)).collect()),
        }
    }
    fn shapes(&mut self) -> ShapeList {
        let mut list = vec![(Tier::A, TurnProfile::Circle)];
        for _ in 0..self.below(5) {
            let section = match self.below(6) {
                0 => TurnProfile::Circle,
                1 => TurnProfile::Ellipse(0.01 + 0.99 * self.unit()),
                2 => TurnProfile::Lame(0.3 + 19.0 * self.unit()),
                3 => TurnProfile::Polygon(3 + self.below(10) as u32),
                4 => TurnProfile::Rose {
                    petals: 2 + self.below(11) as u32,
                    depth: 0.95 * self.unit(),
                },
                _ => {
                    let corner = |k: usize| Vec2::new(k as f32 * 1.1, (k * k) as f32);
                    TurnProfile::Custom((0..3 + self.below(5)).map(corner).collect())
                }
            };
            list.push((self.pick(&[Tier::A, Tier::B, Tier::C]), section));
        }
        ShapeList(list)
    }
    /// Samples as a pen gives them: a wavering arc, 5 ms apart.
    pub(crate) fn pen(&mut self, count: usize) -> Vec<Sample> {
        let (lean, bend) = (self.unit(), 0.2 + self.unit());
        (0..count)
            .map(|k| {
                let t = k as f32 * 0.005;
                let tremor = (self.unit() - 0.5) * 0.006;
                let x = 14.0 * t * (1.0 - 0.3 * t);
                let y = 8.0 - bend * x * x * 0.05 + 0.3 * (3.0 * t - lean) * (3.0 * t - lean) * t;
                let z = lean * x + tremor;
                let pressure = (0.2 + t * (1.4 - t) + 4.0 * tremor).clamp(0.0, 1.0);
                let tilt = Vec2::new(lean * (0.2 + 0.1 * t), tremor - 0.1 * bend * t);
                Sample { position: Vec3::new(x, y, z), pressure, time: t, tilt }
            })
            .collect()
    }
    fn brush(&mut self) -> Brush {
        let modes: Vec<Mode> = Mode::ALL.iter().map(|(mode, _)| *mode).collect();
        Brush {
            mode: self.pick(&modes),
            radius: 0.05 + self.below(1000) as f32 * 0.0123,
            strength: self.below(1001) as f32 / 1000.0,
            mirrored: self.chance(2),
            closed: self.chance(3),
            section: if self.chance(2) { self.text() } else { String::new() },
        }
    }
    pub(crate) fn strokes(&mut self) -> Strokes {
        let mut strokes = Strokes::default();
        for _ in 0..self.below(4) {
            let count = 1 + self.below(60);
            let mut pen = self.pen(count);
            if self.chance(2) {
                pen.iter_mut().for_each(|sample| sample.tilt = Vec2::ZERO);
            }
            let mut stroke = strokes::finish(&pen, &strokes).unwrap();
            if self.chance(3) {
                stroke.brush = Some(self.brush());
            }
            if self.chance(3) {
                stroke.drawn.clone_from(&stroke.samples);
                stroke.samples.truncate(1 + count / 2);
            }
            strokes.0.push(stroke);
        }
        strokes
    }
    /// Pen samples on a picture of 1000 pixels: the wavering arc of [`Self::pen`], 40 pixels a cm.
    pub(crate) fn pen_on_picture(&mut self, count: usize) -> Vec<PenSample> {
        let on_picture = |s: &Sample| {
            let at = Vec2::new(s.position.x, s.position.y + s.position.z) * 40.0;
            PenSample { at, pressure: s.pressure, time: s.time, tilt: s.tilt }
        };
        self.pen(count).iter().map(on_picture).collect()
    }
    /// A gesture as the pen makes it, finished, with and without everything that may be left out.
    pub(crate) fn gesture(&mut self, others: &Gestures) -> Gesture {
        let count = 1 + self.below(60);
        let mut samples = self.pen_on_picture(count);
        if self.chance(2) {
            samples.iter_mut().for_each(|sample| sample.tilt = Vec2::ZERO);
        }
        let mut any = |most: f32| (self.unit() - 0.5) * 2.0 * most;
        let eye = Vec3::new(any(40.0), any(40.0), 60.0);
        let (target, up) = (Vec3::new(any(5.0), -0.0, 1e-45), Vec3::new(0.1, 1.0, any(0.1)));
        let (root, colour) = (Vec3::new(any(9.0), any(9.0), -0.0), Vec3::splat(any(1.0).abs()));
        let path = if self.chance(2) { vec![] } else { self.pen(count) };
        let gesture = Gesture {
            id: 0,
            tool: self.pick(Tool::ALL).0,
            layer: self.pick(Layer::ALL).0,
            view: GestureView {
                eye,
                target,
                up,
                half_height: 0.1 + self.unit(),
                parallel: self.chance(2),
                pixels: 1.0 + self.below(3000) as f32,
            },
            samples,
            curves: (0..self.below(4)).map(|_| self.bits()).collect(),
            root: self.chance(2).then_some(root),
            path: path.iter().map(|s| s.position).collect(),
            colour: self.chance(2).then_some(colour),
            size: self.pick(&[0.0, -0.0, 40.0, 1.0 / 3.0]),
            strength: self.pick(&[1.0, 0.0, 2.5]),
        };
        gestures::finish(gesture, others).unwrap()
    }
    pub(crate) fn gestures(&mut self) -> Gestures {
        let mut all = Gestures::default();
        for _ in 0..self.below(4) {
            all.0.push(self.gesture(&all));
        }
        all
    }
    /// A value of the type, in the form that documents have.
    pub(crate) fn value(&mut self, ty: Type) -> Value {
        let value = match ty {
            Type::Bool => Value::Bool(self.chance(2)),
            Type::Int => Value::Int(self.pick(&[0, -1, 7, 123_456, i64::MAX, i64::MIN])),
            Type::Float => Value::Float(self.number()),
            Type::Field => Value::from(self.field(0)),
            Type::Vec3 | Type::Colour => Value::Vec3(self.vec3()),
            Type::Text | Type::File => Value::Text(self.text().into()),
            Type::Choice(words) => Value::Text(self.pick(words).0.into()),
            Type::Ramp => Value::from(self.ramp()),
            Type::Shapes => Value::from(self.shapes()),
            Type::Strokes => Value::from(self.strokes()),
            Type::Gestures => Value::from(self.gestures()),
            Type::Curves | Type::Scalp => panic!("{} come by wire", ty.name()),
        };
        values::fit(ty, value).unwrap()
    }

    fn thumbnail(&mut self) -> Thumbnail {
        let side = 1 + self.below(1024) as u32;
        Thumbnail::new(thumbnail::tests::framed(side, 9, self.below(40))).unwrap()
    }
    fn id(&mut self) -> NodeId {
        NodeId::new(
            self.pick(&[
                "a", "b", "c", "d", "e_1", "far_away", "a/in", "a/out", "a/b", "a/b/c", "c/d",
            ]),
        )
        .unwrap()
    }
    fn input(&mut self) -> String {
        self.pick(&["count", "spacing", "by", "of_tomorrow", "odd \"name\"\n", "curves", "cuont"])
            .to_owned()
    }
    fn socket(&mut self) -> Socket {
        let name = self.pick(&["curves", "in", "scalp"]);
        Socket::new(self.id(), name)
    }
    fn setting(&mut self, kind: &str, input: &str) -> Setting {
        self.setting_of(coif_nodes::by_id(kind), input)
    }
    fn setting_of(&mut self, def: Option<&'static NodeDef>, input: &str) -> Setting {
        match def.and_then(|def| def.input(input)) {
            Some((_, def)) if !matches!(def.ty, Type::Curves | Type::Scalp) => {
                Setting::Known(self.value(def.ty))
            }
            None if self.chance(8) => Setting::Known(self.value(Type::Gestures)),
            _ => Setting::Raw(self.pick(&RAW).into()),
        }
    }
    fn node(&mut self) -> Node {
        let all: Vec<&str> = coif_nodes::all().map(|def| def.id).collect();
        let kind = match self.below(6) {
            5 => self.pick(&declared::KINDS),
            0 => "of_tomorrow",
            1 => self.pick(&all),
            // What holds strokes or gestures.
            2 => self.pick(
                &all.into_iter().filter(|kind| drawn_input(kind).is_some()).collect::<Vec<_>>(),
            ),
            _ => "resample",
        };
        let mut node = Node {
            kind: kind.to_owned(),
            label: self.words(),
            note: self.words().unwrap_or_default(),
            bypass: self.chance(4),
            ..Node::default()
        };
        if declared::KINDS.contains(&kind) && !self.chance(3) {
            node.interface = Some(self.interface());
        }
        if self.chance(4) {
            let mut text = || self.text();
            let origin = Origin {
                name: text(),
                version: text(),
                hash: text(),
                locked: false,
                author: text(),
                licence: text(),
                tags: vec![text(), text()],
                source: text(),
                needs: vec![text()],
            };
            node.template = Some(Origin { locked: self.chance(2), ..origin }.into());
        }
        let def = node.own_def();
        let mut names = vec![self.input(), self.input()];
        let inputs = def.map_or(&[][..], |def| def.inputs).iter();
        names.extend(inputs.map(|input| input.name.to_owned()).filter(|_| self.chance(2)));
        for name in names {
            let setting = self.setting_of(def, &name);
            node.inputs.insert(name, setting);
        }
        node
    }
    fn interface(&mut self) -> Interface {
        let side = |random: &mut Self, names: &[&str]| -> Vec<Port> {
            let mut some = vec![];
            for name in names {
                if !random.chance(3) {
                    some.push(random.port(name));
                }
            }
            some
        };
        let inputs = side(self, &["in", "curves", "scalp", "count", "spacing"]);
        Interface::new(inputs, side(self, &["curves", "scalp", "in"])).unwrap()
    }
    fn port(&mut self, name: &str) -> Port {
        let words = [("low".to_owned(), self.text()), ("high".to_owned(), String::new())];
        let ty = match self.below(8) {
            0 => declared::choice(&words),
            1 => Type::Int,
            2 => Type::Float,
            3 => Type::Field,
            4 => Type::Ramp,
            5 => Type::Strokes,
            _ => Type::Curves,
        };
        let by_wire = matches!(ty, Type::Curves | Type::Scalp);
        let range =
            |random: &mut Self| random.chance(2).then(|| (0.0, f64::from(1.0 + random.unit())));
        Port {
            doc: self.text(),
            arity: self.pick(&[Arity::One, Arity::Optional, Arity::Many]),
            default: (!by_wire && self.chance(2)).then(|| self.value(ty)),
            hard: range(self),
            soft: range(self),
            unit: self.pick(&[Unit::None, Unit::Ratio, Unit::Length, Unit::PerCm2]),
            section: self.text(),
            ..Port::new(name, ty)
        }
    }
    fn point(&mut self) -> Option<Point> {
        (!self.chance(4)).then(|| Point(self.number(), self.number()))
    }
    fn bends(&mut self) -> Vec<Point> {
        (0..self.below(4)).map(|_| Point(self.number(), self.number())).collect()
    }
    fn place(&mut self) -> FileEntry {
        let (id, input) = (self.id(), self.input());
        let field = |random: &mut Self, of: &[&str]| random.pick(of).to_owned();
        match self.below(11) {
            0 => FileEntry::Top,
            1 => {
                let names = [
                    "format",
                    "title",
                    "note",
                    "display",
                    "links",
                    "nodes",
                    "frames",
                    "bends",
                    "collapsed",
                    "views",
                    "look",
                    "budget",
                    "layout",
                ];
                FileEntry::Field(field(self, &names))
            }
            2 => FileEntry::Node(id),
            3 => {
                let names = [
                    "kind",
                    "label",
                    "note",
                    "inputs",
                    "bypass",
                    "links",
                    "into",
                    "interface",
                    "template",
                ];
                FileEntry::NodeField(id, field(self, &names))
            }
            4 => FileEntry::Input(id, input),
            5 => FileEntry::Link(self.socket()),
            6 => FileEntry::Frame(self.text()),
            7 => FileEntry::Bends(self.socket()),
            8 => FileEntry::Collapsed(id),
            9 => FileEntry::View(self.text()),
            _ => FileEntry::Layout(id),
        }
    }
    /// An edit, possible or not.
    pub(crate) fn edit(&mut self, document: &Document) -> Edit {
        let (id, to) = (self.id(), self.socket());
        let kind = document.node(id.as_str()).map_or("", |node| &node.kind).to_owned();
        match self.below(33) {
            0..=2 => Edit::AddNode { id, node: self.node().into(), at: self.point() },
            3 => Edit::RemoveNode { id },
            4 => Edit::ReplaceNode { id, node: self.node().into() },
            5..=6 => {
                let input = self.input();
                let setting = self.setting(&kind, &input);
                Edit::SetInput { node: id, input, setting }
            }
            7 => Edit::UnsetInput { node: id, input: self.input() },
            8..=9 => {
                let at = self.pick(&[None, Some(0), Some(9)]);
                Edit::Connect { from: self.socket(), to, at }
            }
            10 => Edit::Disconnect { to, at: self.below(2) },
            11 => Edit::Reorder { to, from: self.below(3), at: self.below(3) },
            12 => {
                let from = (0..self.below(4)).map(|_| self.socket()).collect();
                Edit::SetWires { to, from }
            }
            13 => Edit::Move { id, to: self.point() },
            14 => Edit::SetTitle(self.text()),
            15 => match self.below(3) {
                0 => Edit::SetNote(self.text()),
                1 => Edit::SetSeed(self.bits()),
                _ => Edit::SetNodeNote { id, note: self.text() },
            },
            16 => Edit::SetDisplay((!self.chance(4)).then_some(id)),
            17 => Edit::SetLabel { id, label: self.words() },
            18 => Edit::SetBypass { id, bypass: self.chance(2) },
            19..=20 => {
                let lines = self.pick(&[&["// one"][..], &["//", "// \"two\" /*"], &[]]);
                let lines = lines.iter().map(|line| (*line).to_owned()).collect();
                Edit::SetComment { place: self.place(), lines }
            }
            21..=22 => {
                let bends = self.bends();
                Edit::SetBends { to, at: self.below(3), bends }
            }
            23 => Edit::SetCollapsed { id, collapsed: !self.chance(3) },
            24..=25 => {
                let frame = Frame {
                    at: Point(self.number(), self.number()),
                    size: Point(self.number().abs(), 30.0),
                    text: self.text(),
                    colour: self.below(256) as u8,
                };
                Edit::SetFrame { name: self.text(), frame: (!self.chance(4)).then_some(frame) }
            }
            26 => {
                let mut near = || [self.number(), self.unit(), -self.unit()].map(|x| x % 2e6);
                let view = SavedView {
                    eye: near(),
                    target: near(),
                    up: near(),
                    focal_mm: 1.0 + self.unit(),
                    orthographic: self.chance(2).then(|| self.unit()),
                };
                Edit::SetView { name: self.text(), view: (!self.chance(4)).then_some(view) }
            }
            27 => {
                let light = self.pick(&["studio", "of-tomorrow", "", "a b"]).to_owned();
                let (exposure, skin) = (30.0 * self.unit(), "5".to_owned());
                let turn = if self.chance(2) { 0.0 } else { 200.0 * self.unit() };
                let look = SavedLook { light, exposure, turn, skin };
                match self.chance(2) {
                    true => Edit::SetThumbnail((!self.chance(4)).then(|| self.thumbnail())),
                    false => Edit::SetLook((!self.chance(4)).then_some(look)),
                }
            }
            28..=29 => self.edit_of_list(document, id),
            30 => {
                let mut budget = Budget::default();
                for term in Term::ALL {
                    let limit = self.chance(2).then(|| f64::from(self.unit().abs() + 0.1));
                    let limit =
                        limit.map(|x| if term == Term::Points { (x * 1e7).round() } else { x });
                    budget.set(term, limit).unwrap();
                }
                Edit::SetBudget(budget)
            }
            _ => {
                let count = self.below(4);
                Edit::Several((0..count).map(|_| self.edit(document)).collect())
            }
        }
    }
    /// An edit of one stroke or gesture, possible or not.
    fn edit_of_list(&mut self, document: &Document, node: NodeId) -> Edit {
        let takes = document.nodes.iter().filter(|(_, node)| drawn_input(&node.kind).is_some());
        let takes: Vec<&NodeId> = takes.map(|(id, _)| id).collect();
        let node = if takes.is_empty() { node } else { self.pick(&takes).clone() };
        let held = document.node(node.as_str());
        let drawn = held.and_then(|node| drawn_input(&node.kind));
        let (input, ty) = drawn.unwrap_or(("strokes", Type::Strokes));
        let setting = held.and_then(|node| node.inputs.get(input));
        let (input, at) = (input.to_owned(), self.below(3));
        match (ty, setting, self.below(3)) {
            (Type::Gestures, Some(Setting::Known(Value::Gestures(all))), n) if n > 0 => {
                let id = all.0.get(at).map_or(1, |gesture| gesture.id);
                let gesture = Gesture { id, ..self.gesture(&Gestures::default()) };
                match n {
                    1 => Edit::RemoveGesture { node, input, id },
                    _ => Edit::ReplaceGesture { node, input, gesture },
                }
            }
            (Type::Gestures, ..) => {
                let gesture = self.gesture(&Gestures::default());
                Edit::AddGesture { node, input, at, gesture }
            }
            (_, Some(Setting::Known(Value::Strokes(all))), n) if n > 0 => {
                let id = all.0.get(at).map_or(1, |stroke| stroke.id);
                let samples = strokes::finish(&self.pen(20), &Strokes::default()).unwrap().samples;
                match n {
                    1 => Edit::RemoveStroke { node, input, id },
                    _ => Edit::ReplaceStroke { node, input, stroke: Stroke::new(id, samples) },
                }
            }
            _ => {
                let stroke = strokes::finish(&self.pen(20), &Strokes::default()).unwrap();
                Edit::AddStroke { node, input, at, stroke }
            }
        }
    }
    /// A document after some edits.
    pub(crate) fn document(&mut self) -> Document {
        let mut document =
            Document { seed: self.bits(), title: self.text(), ..Document::default() };
        for _ in 0..10 + self.below(60) {
            let _ = self.edit(&document).apply(&mut document);
        }
        document
    }
    /// A node that holds strokes, whatever nodes there are.
    pub(crate) fn stroke_node(&mut self) -> Node {
        holding("strokes", self.strokes().into())
    }
    /// A node that holds gestures, whatever nodes there are.
    pub(crate) fn gesture_node(&mut self) -> Node {
        holding("gestures", self.gestures().into())
    }
}

/// The input of a kind that holds strokes or gestures.
fn drawn_input(kind: &str) -> Option<(&'static str, Type)> {
    let mut inputs = coif_nodes::by_id(kind)?.inputs.iter();
    let drawn = inputs.find(|input| matches!(input.ty, Type::Strokes | Type::Gestures))?;
    Some((drawn.name, drawn.ty))
}

fn holding(what: &str, value: Value) -> Node {
    let mut node = Node { kind: format!("of_{what}"), ..Node::default() };
    node.inputs.insert(what.to_owned(), Setting::Known(value));
    node
}
