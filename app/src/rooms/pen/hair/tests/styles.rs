//! The shipped sketches, as a hand draws them: pen reports into the window, nothing else.
//!
//! A style is a list of views and of strokes seen from them. `UPDATE_EXPECT=1` writes the grooms anew; else each must be what its
//! script draws, to within what other windows and fonts make of it.

use super::super::super::sample::{Device, PenSample as Report, Phase, Tool as End};
use super::super::super::target::{self as filled, Fills};
use super::super::super::tests::{Table, draw_on, head};
use super::super::target;
use crate::core::event::Event;
use crate::long::is_long;
use coif_graphs::document::edit::Edit;
use coif_graphs::document::{Document, Node, NodeId, Point, Setting, Socket, wiring};
use coif_nodes::data::gestures::{Gestures, Tool};
use coif_nodes::data::ramp::{Blend, Ramp};
use coif_nodes::data::scalp::Scalp;
use coif_nodes::define::Value;
use coif_shaders::camera::Camera;
use egui::Pos2;
use glam::Vec3;
use std::sync::Arc;

/// Pen reports a second.
const RATE: f64 = 125.0;
/// How fast the pen goes on the screen, points a second.
const SPEED: f32 = 450.0;
/// From one stroke to the next, and from one view to the next, seconds.
const PAUSE: f64 = 0.9;
const TURN: f64 = 2.5;

/// A hand with a pen before the window.
struct Hand {
    table: Table,
    scalp: Arc<Scalp>,
    /// Seconds that it has taken.
    took: f64,
}

impl Hand {
    /// Opens the recipe for clusters on the bare head.
    fn begin(colour: [u8; 3]) -> Self {
        let mut hand = Self::begin_with("recipe.sketch_hair", colour);
        // Discs alone: what fills the skin between them changes no stroke, and takes its time.
        hand.set("strands", "fill", Value::Float(0.0));
        hand
    }

    fn begin_with(recipe: &str, colour: [u8; 3]) -> Self {
        let mut table = draw_on(head());
        table.editor().act(recipe);
        table.rest();
        let scalp = table.editor().state.shown.as_ref().and_then(|shown| shown.scalp().cloned());
        let mut hand = Self { table, scalp: scalp.expect("a head"), took: 0.0 };
        hand.colour(colour);
        hand
    }

    fn colour(&mut self, colour: [u8; 3]) {
        let editor = self.table.editor();
        let mut settings = editor.state.settings.clone();
        settings.pen.hair_colour = Some(colour);
        editor.apply(Event::Settings(settings.into()));
    }

    /// Hair between the clusters, along them: nodes take a sketch as they take any guides.
    fn between(&mut self, count: i64) {
        let id = |text: &str| NodeId::new(text).expect("an id");
        let node = |kind: &str, inputs: &[(&str, Value)]| {
            let inputs = inputs.iter().map(|(n, v)| ((*n).to_owned(), Setting::Known(v.clone())));
            Arc::new(Node { kind: kind.to_owned(), inputs: inputs.collect(), ..Node::default() })
        };
        let inputs = [
            ("by", Value::Text("count".into())),
            ("count", Value::Int(count)),
            ("points", Value::Int(16)),
            ("seed", Value::Int(5)),
        ];
        let ends = [("variation", Value::Float(0.4)), ("distribution", Value::Text("even".into()))];
        let clump = [
            ("amount", Value::Float(0.15)),
            ("attribute", Value::Text("parent".into())),
            ("levels", Value::Int(1)),
            ("strays", Value::Float(0.0)),
            ("keep_length", Value::Bool(false)),
        ];
        let add =
            |name: &str, node, x, y| Edit::AddNode { id: id(name), node, at: Some(Point(x, y)) };
        let wire = |from: (&str, &str), to: (&str, &str), at| Edit::Connect {
            from: Socket::new(id(from.0), from.1),
            to: Socket::new(id(to.0), to.1),
            at,
        };
        let edits = vec![
            add("between", node("interpolate", &inputs), 520.0, 140.0),
            add("ends", node("length", &ends), 740.0, 140.0),
            add("drawn", node("clump", &clump), 960.0, 140.0),
            add("all", node("merge", &[]), 1180.0, 0.0),
            wire(("hair_sketch", "curves"), ("between", "guides"), None),
            wire(("head", "scalp"), ("between", "scalp"), None),
            wire(("between", "curves"), ("ends", "curves"), None),
            wire(("head", "scalp"), ("ends", "scalp"), None),
            wire(("ends", "curves"), ("drawn", "curves"), None),
            wire(("hair_sketch", "curves"), ("drawn", "centres"), None),
            wire(("head", "scalp"), ("drawn", "scalp"), None),
            wire(("strands_width", "curves"), ("all", "curves"), None),
            wire(("drawn", "curves"), ("all", "curves"), Some(1)),
            Edit::SetWires {
                to: Socket::new(id("colour"), "curves"),
                from: vec![Socket::new(id("all"), "curves")],
            },
        ];
        self.table.editor().apply(Event::Edit(Edit::Several(edits)));
    }

    /// A number of the sketch, or of a node behind it, where it is set.
    fn set(&mut self, node: &str, input: &str, value: Value) {
        let input = Socket::new(NodeId::new(node).expect("an id"), input);
        let at = wiring::set_at(&self.table.editor().state.document, &input);
        let (node, input) = (at.node, at.name.to_string());
        let edit = Edit::SetInput { node, input, setting: Setting::Known(value) };
        self.table.editor().apply(Event::Edit(edit));
    }

    /// Looks at the head from a side, degrees: 0 is its face, 90 its left ear; `up` is how far from above.
    fn look(&mut self, side: f32, up: f32) {
        let frame = self.scalp.frame();
        let (side, up) = (side.to_radians(), up.to_radians());
        let way = Vec3::new(side.sin() * up.cos(), up.sin(), side.cos() * up.cos());
        let camera = Camera {
            eye: frame.point_from_head(way * 110.0),
            target: frame.point_from_head(Vec3::new(0.0, -3.0, 0.0)),
            up: Vec3::Y,
            focal_mm: 85.0,
            orthographic: None,
        };
        self.table.editor().viewport.look(camera);
        self.rest();
        self.took += TURN;
    }

    fn rest(&mut self) {
        loop {
            self.table.rest();
            if !self.table.editor().pen.touches.is_busy() {
                return;
            }
        }
    }

    fn report(&mut self, phase: Phase, at: Pos2, pressure: f32, end: End) {
        self.table.time += 1.0 / RATE;
        let report = Report::mouse(self.table.time, phase, at, pressure);
        let report = Report { tool: end, device: Device(9), ..report };
        self.table.editor().pen.devices.push(report);
    }

    /// A stroke through places of the screen, at a steady speed.
    fn draw(&mut self, places: &[Pos2], pressure: f32, end: End) {
        self.table.time += 1.0;
        let step = SPEED / RATE as f32;
        let mut line = vec![places[0]];
        for pair in places.windows(2) {
            let count = (pair[0].distance(pair[1]) / step).ceil().max(1.0) as i32;
            line.extend(
                (1..=count).map(|k| pair[0] + (pair[1] - pair[0]) * (k as f32 / count as f32)),
            );
        }
        self.report(Phase::Hover, line[0], 0.0, end);
        self.report(Phase::Down, line[0], pressure, end);
        for at in &line[1..] {
            self.report(Phase::Move, *at, pressure, end);
        }
        self.report(Phase::Up, line[line.len() - 1], 0.0, end);
        self.took += line.len() as f64 / RATE + PAUSE;
        self.rest();
    }

    /// Where a point of the head's frame is on the screen.
    fn screen(&mut self, p: Vec3) -> Pos2 {
        let p = self.scalp.frame().point_from_head(p);
        self.table.editor().viewport.projection().screen(p).expect("before the eye")
    }

    /// The skin in a direction from the middle of the head.
    fn skin(&self, way: Vec3) -> Vec3 {
        let frame = self.scalp.frame();
        let way = way.normalize();
        let from = frame.point_from_head(way * 40.0);
        let hit = self.scalp.surface().ray(from, frame.vector_from_head(-way), f32::MAX);
        frame.head_from_point(hit.expect("the skin").point)
    }

    /// Plants a cluster at a place of the skin, along a curve of the head's frame.
    fn plant(&mut self, root: (f32, f32), then: &[Vec3]) {
        self.plant_at(at(root.0, root.1, 1.0), then);
    }

    /// Plants a cluster in a direction from the middle of the head.
    fn plant_at(&mut self, way: Vec3, then: &[Vec3]) {
        let root = self.skin(way);
        let mut curve = vec![root];
        curve.extend(then);
        let places: Vec<Pos2> = smooth(&curve).into_iter().map(|p| self.screen(p)).collect();
        self.draw(&places, 0.9, End::Tip);
    }

    /// Draws through points of the head's frame.
    fn through(&mut self, points: &[Vec3], pressure: f32, end: End) {
        let places: Vec<Pos2> = smooth(points).into_iter().map(|p| self.screen(p)).collect();
        self.draw(&places, pressure, end);
    }

    /// Two taps on a point of the head's frame.
    fn pin(&mut self, at: Vec3) {
        let at = self.screen(at);
        for _ in 0..2 {
            self.table.time -= 0.8;
            self.draw(&[at, at], 0.4, End::Tip);
        }
    }

    /// The curves of the sketch in the head's frame, in their order.
    fn curves(&mut self) -> Vec<Vec<Vec3>> {
        let frame = *self.scalp.frame();
        let state = &self.table.editor().state;
        let node = filled::of(state, Fills::Hair).expect("a sketch");
        let shown = state.shown.as_ref().expect("a result");
        let curves = shown.curves_of(&target::output(&node)).expect("curves");
        let each = curves.each();
        each.map(|(tuft, i)| tuft.curve(i).iter().map(|p| frame.head_from_point(*p)).collect())
            .collect()
    }

    /// How wide locks are along their way.
    fn profile(&mut self, stops: &[(f32, f32)]) {
        let ramp = Ramp::new(Blend::Smooth, stops.to_vec()).expect("a ramp");
        self.set("strands_section", "profile", Value::Ramp(Arc::new(ramp)));
    }

    /// The tips of all curves.
    fn tips(&mut self) -> Vec<Vec3> {
        self.curves().iter().filter_map(|curve| curve.last().copied()).collect()
    }

    fn document(mut self, title: &str, note: &str) -> (Document, f64) {
        let editor = self.table.editor();
        let mut document = editor.state.document.clone();
        (document.title, document.note) = (title.to_owned(), note.to_owned());
        let output = NodeId::new("out").expect("an id");
        let named = Setting::Known(Value::Text("hair".into()));
        if let Some(node) = document.nodes.get_mut(&output) {
            Arc::make_mut(node).inputs.insert("name".to_owned(), named);
        }
        (document, self.took)
    }
}

/// A curve through points, four pieces between each two.
fn smooth(points: &[Vec3]) -> Vec<Vec3> {
    let at = |k: i32| points[k.clamp(0, points.len() as i32 - 1) as usize];
    let mut out = vec![];
    for k in 0..points.len() as i32 - 1 {
        let (a, b, c, d) = (at(k - 1), at(k), at(k + 1), at(k + 2));
        for step in 0..6 {
            let t = step as f32 / 6.0;
            let (t2, t3) = (t * t, t * t * t);
            out.push(
                0.5 * (2.0 * b
                    + (c - a) * t
                    + (2.0 * a - 5.0 * b + 4.0 * c - d) * t2
                    + (3.0 * b - a - 3.0 * c + d) * t3),
            );
        }
    }
    out.push(at(points.len() as i32 - 1));
    out
}

/// A point of the head's frame by its side and height, degrees, and distance from the middle.
fn at(side: f32, up: f32, far: f32) -> Vec3 {
    let (side, up) = (side.to_radians(), up.to_radians());
    Vec3::new(side.sin() * up.cos(), up.sin(), side.cos() * up.cos()) * far
}

/// A bob with a parting on its left, planted side by side from the nape up.
fn bob() -> (Document, f64) {
    let mut hand = Hand::begin([66, 40, 28]);
    hand.set("hair_sketch", "radius", Value::Float(2.2));
    hand.set("strands_section", "flatness", Value::Float(0.55));
    hand.set("strands_clump", "amount", Value::Float(0.1));
    hand.profile(&[(0.0, 0.75), (0.25, 1.0), (0.8, 0.9), (1.0, 0.6)]);
    // Where it falls to: by the chin, a little inwards.
    let ends = |side: f32, out: f32| {
        let (x, z) = side.to_radians().sin_cos();
        [
            Vec3::new(x * (out + 0.4), -4.0, z * (out + 0.2)),
            Vec3::new(x * (out + 0.6), -8.5, z * (out + 0.4)),
            Vec3::new(x * (out - 0.4), -12.5, z * (out - 0.5)),
        ]
    };
    let mut row = |view: f32, up: f32, height: f32, sides: &[f32], out: f32| {
        hand.look(view, up);
        for side in sides {
            let over = at(*side, height - 22.0, out + 0.6);
            let [a, b, c] = ends(*side, out);
            let then = if height > 15.0 { vec![over, a, b, c] } else { vec![a, b, c] };
            hand.plant((*side, height), &then);
        }
    };
    row(180.0, 5.0, -8.0, &[150.0, 180.0, 210.0], 9.3);
    row(180.0, 15.0, 22.0, &[142.0, 167.0, 193.0, 218.0], 9.9);
    row(100.0, 8.0, 2.0, &[114.0], 9.2);
    row(260.0, 8.0, 2.0, &[246.0], 9.2);
    row(95.0, 15.0, 30.0, &[68.0, 93.0, 118.0], 9.5);
    row(265.0, 15.0, 30.0, &[292.0, 267.0, 242.0], 9.5);
    row(180.0, 35.0, 50.0, &[135.0, 165.0, 195.0, 228.0], 10.2);
    row(80.0, 30.0, 55.0, &[58.0, 88.0, 118.0], 9.8);
    row(280.0, 30.0, 55.0, &[300.0, 265.0], 10.0);
    // From the parting over the forehead to the other side, and over the crown.
    hand.look(328.0, 40.0);
    for (side, up, low) in [(40.0, 74.0, 292.0), (30.0, 60.0, 305.0), (26.0, 46.0, 320.0)] {
        let [a, b, c] = ends(low - 22.0, 9.6);
        hand.plant((side, up), &[at(side - 45.0, up + 3.0, 9.6), at(low, 38.0, 10.2), a, b, c]);
    }
    hand.look(195.0, 55.0);
    for (side, up, low) in
        [(300.0, 76.0, 262.0), (180.0, 84.0, 225.0), (220.0, 68.0, 205.0), (140.0, 70.0, 160.0)]
    {
        let [a, b, c] = ends(low, 10.0);
        hand.plant((side, up), &[at(low, 66.0, 10.0), at(low, 36.0, 10.5), a, b, c]);
    }
    // What was drawn from the front hangs too far before it: combed back from the side.
    hand.look(270.0, 8.0);
    for turn in [0.0, 14.0] {
        let way = |up: f32, far: f32| at(324.0 - turn, up, far);
        hand.through(&[way(24.0, 11.0), at(306.0 - turn, 2.0, 10.4)], 0.5, End::Tip);
        hand.through(&[way(-16.0, 11.0), at(306.0 - turn, -30.0, 11.0)], 0.5, End::Tip);
    }
    hand.document("Sketched bob", "Some thirty clusters drawn with the pen in a minute and a half.")
}

/// A pony tail: hair from all round the hairline to a tie at the back, pinned there, and the tail from it.
fn ponytail() -> (Document, f64) {
    let mut hand = Hand::begin([46, 28, 20]);
    hand.set("hair_sketch", "radius", Value::Float(1.8));
    hand.set("strands_section", "flatness", Value::Float(0.35));
    hand.profile(&[(0.0, 0.6), (0.15, 1.0), (0.45, 0.55), (0.7, 0.9), (1.0, 0.25)]);
    let tie = at(180.0, 30.0, 9.6);
    // From each side to behind the ear, seen from there; the rest of the way seen from the back.
    let mut side = |view: f32, up: f32, roots: &[(f32, f32)]| {
        hand.look(view, up);
        for root in roots {
            let step = |part: f32| {
                at(root.0 + (180.0 - root.0) * part, root.1 + (30.0 - root.1) * part, 9.4)
            };
            hand.plant(*root, &[step(0.25), step(0.5)]);
        }
    };
    side(90.0, 12.0, &[(58.0, 30.0), (75.0, 10.0), (72.0, 52.0), (100.0, 34.0), (110.0, 8.0)]);
    side(270.0, 12.0, &[(302.0, 30.0), (285.0, 10.0), (288.0, 52.0), (260.0, 34.0), (250.0, 8.0)]);
    side(180.0, 10.0, &[(150.0, -8.0), (210.0, -8.0), (180.0, -14.0)]);
    side(180.0, 70.0, &[(10.0, 58.0), (335.0, 58.0), (100.0, 80.0), (260.0, 80.0)]);
    hand.look(180.0, 30.0);
    for tip in hand.tips() {
        hand.through(&[tip, tip.lerp(tie, 0.5) * 1.04, tie], 0.2, End::Tip);
    }
    // Pins where all meet, then the tail from their ends.
    hand.look(90.0, 10.0);
    for tip in hand.tips() {
        hand.pin(tip);
    }
    for tip in hand.tips() {
        let fall = [(0.4, -1.6), (-0.4, -3.4), (-5.0, -4.6), (-12.0, -4.2), (-18.0, -2.6)];
        let mut way = vec![tip];
        way.extend(fall.map(|(y, z)| tip + Vec3::new(0.0, y, z)));
        hand.through(&way, 0.2, End::Tip);
    }
    hand.between(50_000);
    hand.document(
        "Sketched ponytail",
        "Clusters drawn to a tie, pinned there, and lengthened to a tail.",
    )
}

/// A Mohawk: a row along the middle that stands, frizzed, in two reds.
fn mohawk() -> (Document, f64) {
    let mut hand = Hand::begin([120, 14, 26]);
    hand.set("hair_sketch", "radius", Value::Float(1.3));
    hand.profile(&[(0.0, 0.8), (0.35, 1.0), (0.8, 0.9), (1.0, 0.45)]);
    hand.look(90.0, 4.0);
    let mut tips = vec![];
    for k in 0..15 {
        let turn = 44.0 + 8.8 * k as f32;
        let way = |degrees: f32, far: f32| {
            let (y, z) = degrees.to_radians().sin_cos();
            Vec3::new(0.0, y * far, z * far)
        };
        let tall = 17.5 - 0.025 * (turn - 95.0).abs();
        hand.colour(if k % 2 == 0 { [120, 14, 26] } else { [176, 38, 30] });
        hand.plant_at(
            way(turn, 1.0) + Vec3::X * 0.09,
            &[way(turn + 1.0, 12.0), way(turn + 3.0, 15.0), way(turn + 7.0, tall)],
        );
        tips.push(way(turn + 4.0, 14.5));
    }
    // To and fro across each tip.
    for at in tips.iter().step_by(3) {
        let at = hand.screen(*at);
        let swing = |k: i32| {
            let saw = ((k % 12) - 6).abs() as f32 / 3.0 - 1.0;
            at + egui::Vec2::new(saw * 34.0, 0.4 * k as f32)
        };
        hand.draw(&(0..61).map(swing).collect::<Vec<_>>(), 0.2, End::Tip);
    }
    hand.document("Sketched Mohawk", "A row of clusters that stand along the middle of the head.")
}

/// The recipe that hair flows by, with few hairs.
fn flowing(colour: [u8; 3]) -> Hand {
    let mut hand = Hand::begin_with("recipe.flow_hair", colour);
    // A stroke that begins on hair plants one, too.
    let implant = super::super::super::PenTool::Hair(Some(Tool::Implant));
    assert_eq!(hand.table.editor().pen.tool, implant);
    hand.set("hair", "count", Value::Int(1500));
    hand
}

/// Nine thousand hairs that flow, and what they grow on.
fn full(mut hand: Hand) -> (Vec<Vec<Vec3>>, Arc<Scalp>) {
    hand.set("hair", "count", Value::Int(9000));
    hand.rest();
    hair(&mut hand)
}

/// A bob parted in the middle: ten strokes, from the parting to the jaw, over all of the head.
fn ten_strokes() -> Hand {
    let mut hand = flowing([58, 36, 26]);
    let mut row = |view: f32, up: f32, strokes: &[(Vec3, f32)]| {
        hand.look(view, up);
        for (root, side) in strokes {
            // Over the widest part of the head, then down to the jaw.
            let over = |up: f32, far: f32| at(*side, up, far);
            let down = |y: f32, far: f32| {
                let (x, z) = side.to_radians().sin_cos();
                Vec3::new(x * far, y, z * far)
            };
            hand.plant_at(
                *root,
                &[over(32.0, 9.8), over(4.0, 9.9), down(-5.0, 9.6), down(-11.0, 9.2)],
            );
        }
    };
    let beside = |x: f32, z: f32| Vec3::new(x, 8.6, z);
    row(
        85.0,
        22.0,
        &[(beside(0.7, 3.6), 62.0), (beside(0.7, 0.6), 82.0), (beside(0.7, -2.6), 104.0)],
    );
    row(
        275.0,
        22.0,
        &[(beside(-0.7, 3.6), 298.0), (beside(-0.7, 0.6), 278.0), (beside(-0.7, -2.6), 256.0)],
    );
    row(
        180.0,
        22.0,
        &[
            (Vec3::new(1.0, 7.6, -5.4), 140.0),
            (Vec3::new(0.5, 6.4, -7.4), 166.0),
            (Vec3::new(-0.5, 6.4, -7.4), 194.0),
            (Vec3::new(-1.0, 7.6, -5.4), 220.0),
        ],
    );
    hand
}

/// Swept back from the hairline: five strokes, over the top and along the sides.
fn five_strokes() -> Hand {
    let mut hand = flowing([40, 30, 24]);
    hand.look(0.0, 70.0);
    for x in [-4.6f32, 0.0, 4.6] {
        let line = |z: f32, y: f32| Vec3::new(x, y - 0.08 * x * x, z);
        hand.plant_at(line(6.0, 6.3), &[line(3.0, 8.9), line(-2.0, 9.6), line(-6.0, 7.6)]);
    }
    for side in [1.0f32, -1.0] {
        hand.look(90.0 * side, 10.0);
        let line = |y: f32, z: f32| Vec3::new(8.2 * side, y, z);
        hand.plant_at(line(2.2, 4.4), &[line(3.4, 1.0), line(2.6, -3.0), line(-0.5, -6.0)]);
    }
    hand
}

/// All hair that is shown.
fn hair(hand: &mut Hand) -> (Vec<Vec<Vec3>>, Arc<Scalp>) {
    let frame = *hand.scalp.frame();
    let state = &hand.table.editor().state;
    let shown = state.shown.as_ref().expect("a result");
    let scalp = shown.scalp().cloned().expect("a head");
    let curves = shown.curves_of(&Socket::new(NodeId::new("colour").expect("an id"), "curves"));
    let each = curves.expect("hair").each();
    let of = |(tuft, i): (&coif_nodes::data::curves::Tuft, usize)| -> Vec<Vec3> {
        tuft.curve(i).iter().map(|p| frame.head_from_point(*p)).collect()
    };
    (each.map(of).collect(), scalp)
}

/// How far (cm) from the next hair's root the skin lies at most where hair grows.
fn barest(hair: &[Vec<Vec3>], scalp: &Scalp) -> f32 {
    let roots: Vec<Vec3> = hair.iter().map(|points| points[0]).collect();
    let frame = scalp.frame();
    let surface = scalp.surface();
    let third = glam::Vec2::splat(1.0 / 3.0);
    let triangles = (0..surface.triangles.len() as u32).filter(|t| scalp.grows(*t, third) >= 1.0);
    let skin = triangles.step_by(7).map(|t| frame.head_from_point(scalp.root(t, third).point));
    let near = |p: Vec3| roots.iter().map(|root| root.distance(p)).fold(f32::MAX, f32::min);
    skin.map(near).fold(0.0, f32::max)
}

#[test]
fn ten_strokes_are_a_full_bob_parted_in_the_middle_and_level_at_the_jaw() {
    let mut hand = ten_strokes();
    let made = gestures(&hand.table.editor().state.document);
    assert_eq!(made.0.len(), 10);
    let took = hand.took;
    let (all, scalp) = full(hand);
    assert!((5000..10_000).contains(&all.len()), "{}", all.len());
    assert!(barest(&all, &scalp) < 0.8, "{}", barest(&all, &scalp));
    // Hair of the top ends at the jaw, within a little, and on its own side.
    let top: Vec<&Vec<Vec3>> = all.iter().filter(|points| points[0].y > 6.5).collect();
    let tips: Vec<Vec3> = top.iter().map(|points| points[points.len() - 1]).collect();
    let mut heights: Vec<f32> = tips.iter().map(|tip| tip.y).collect();
    heights.sort_by(f32::total_cmp);
    let share = |k: f32| heights[(k * (heights.len() - 1) as f32) as usize];
    println!("took {:.0} s; tips at {:.1}, {:.1}, {:.1}", took, share(0.1), share(0.5), share(0.9));
    assert!((-12.5..-9.5).contains(&share(0.5)) && share(0.9) - share(0.1) < 3.0);
    let front = top.iter().zip(&tips).filter(|(points, _)| points[0].z > -3.0);
    let over = front.clone().filter(|(points, tip)| points[0].x * tip.x < 0.0).count();
    assert!(over * 200 < front.count(), "{over} lie on the other side");
}

#[test]
fn five_strokes_sweep_all_hair_back() {
    let mut hand = five_strokes();
    let made = gestures(&hand.table.editor().state.document);
    assert_eq!(made.0.len(), 5);
    let (all, scalp) = full(hand);
    assert!(barest(&all, &scalp) < 0.8, "{}", barest(&all, &scalp));
    let front = all.iter().filter(|points| points[0].z > 0.0);
    let back = front.clone().filter(|points| points[points.len() - 1].z < points[0].z - 1.0);
    let (front, back) = (front.count(), back.count());
    assert!(back * 100 > front * 97, "{back} of {front}");
}

const STYLES: [(&str, fn() -> (Document, f64)); 3] =
    [("sketch_bob", bob), ("sketch_ponytail", ponytail), ("sketch_mohawk", mohawk)];

/// The gestures of a document's sketch.
fn gestures(document: &Document) -> Arc<Gestures> {
    filled::gestures(document, &NodeId::new("hair_sketch").expect("an id"))
}

#[test]
fn shipped_sketches_are_what_a_pen_draws_in_two_minutes() {
    let update = std::env::var_os("UPDATE_EXPECT").is_some();
    if update {
        // The sample of the recipe.
        let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR"))
            .join("../graphs/templates/flow_hair.ron");
        let text = std::fs::read_to_string(&path).expect("the template is shipped");
        let mut template = coif_graphs::file::read(&text).expect("it reads").document;
        let drawn = gestures(&ten_strokes().table.editor().state.document);
        let sketch = NodeId::new("hair_sketch").expect("an id");
        let node = Arc::make_mut(template.nodes.get_mut(&sketch).expect("a sketch"));
        node.inputs.insert("gestures".to_owned(), Setting::Known(Value::Gestures(drawn)));
        std::fs::write(&path, coif_graphs::file::write(&template)).expect("it is written");
    }
    let only = std::env::var("COIF_SKETCH").ok();
    for (name, draw) in STYLES {
        // The longest of them is drawn by `tests/run.sh --long` alone.
        let waits = name == "sketch_ponytail" && !update && !is_long();
        if only.as_ref().map_or(waits, |only| only != name) {
            continue;
        }
        let (document, took) = draw();
        let made = gestures(&document);
        let count = |tool: Tool| made.0.iter().filter(|gesture| gesture.tool == tool).count();
        println!(
            "{name}: {} implants, {} lengthened, {} pins, {took:.0} s",
            count(Tool::Implant),
            count(Tool::Lengthen),
            count(Tool::Pin)
        );
        let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR"))
            .join(format!("../graphs/grooms/{name}.ron"));
        if update {
            let written = coif_graphs::file::write(&document);
            std::fs::write(&path, written).expect("the groom is written");
            continue;
        }
        let text = std::fs::read_to_string(&path).expect("the groom is shipped");
        let shipped = gestures(&coif_graphs::file::read(&text).expect("it reads").document);
        assert_eq!(shipped.0.len(), made.0.len(), "{name}");
        for (shipped, made) in shipped.0.iter().zip(&made.0) {
            assert_eq!((shipped.tool, shipped.layer), (made.tool, made.layer), "{name}");
            let off = shipped.root.zip(made.root).map_or(0.0, |(a, b)| a.distance(b));
            assert!(off < 0.3, "{name}: {off}");
        }
    }
}
