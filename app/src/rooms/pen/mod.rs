//! The pen: from devices to strokes in the document.
//!
//! `devices.rs` makes one stream of samples of all pens, mice and fingers; tools turn samples into edits of the
//! strokes of one node (`target.rs`): the pinned one, whatever is displayed. A touch is one gesture and one undo step.
//! What is drawn is seen in the frame in which its samples arrive; the document, and so the hair downstream,
//! follows whenever the evaluator has answered the last change, and in full when the pen is lifted.
//!
//! Guarantees: the stroke that stays is a function of the samples alone; a gesture whose stroke or node goes away
//! meanwhile (an undo, another document) ends without a word; egui's own pointer never draws what a pen draws.
//! The room knows nothing of evaluation: it reads what is shown.

pub mod actions;
pub mod devices;
mod drawing;
mod edits;
mod gestures;
pub(crate) mod hair;
mod hairline;
pub(crate) mod mask;
mod overlay;
mod panel;
mod partings;
pub(crate) mod recipes;
pub mod sample;
mod shapes;
mod target;
#[cfg(test)]
mod tests;
mod x11;

use crate::core::action::Of;
use crate::core::event::Event;
use crate::core::notes::Note;
use crate::core::pen::Holds;
use crate::core::projection::Projection;
use crate::core::state::State;
use coif_graphs::document::{NodeId, Socket};
use coif_nodes::data::gestures::Tool;
use coif_nodes::data::scalp::Scalp;
use coif_nodes::data::strokes::{Mode, Strokes};
use devices::{Devices, Frame, Input};
use egui::{Key, Pos2, Rect};
use gestures::{ActiveTouch, Work};
use sample::Phase;
use shapes::Shapes;
use std::collections::BTreeSet;
use std::sync::Arc;
#[cfg(target_os = "linux")]
pub(crate) use x11::has_pens;

/// What the pen can do by name.
pub(crate) const ACTIONS: &[&[Of<Pen>]] =
    &[actions::ACTIONS, hair::actions::ACTIONS, mask::actions::ACTIONS];

/// What the pen does in the viewport.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum PenTool {
    /// Nothing: the viewport selects and turns.
    #[default]
    Select,
    /// Draws strokes.
    Draw,
    /// Picks points of strokes and moves them.
    Points,
    /// Draws a part of a stroke anew.
    Redraw,
    /// Removes strokes.
    Erase,
    /// Combs strokes the way the pen moves.
    Comb,
    /// Takes wiggles out.
    Smooth,
    /// Works on hair: one gesture of the shelf, or what the stroke itself says.
    Hair(Option<Tool>),
    /// Paints a mask.
    Mask(Mode),
}

/// Tools on hair, as they stand in the bar: what they are called, and their actions.
pub(crate) const HAIR_TOOLS: &[(Option<Tool>, &str, &str)] = &[
    (None, "Sketch", "hair.sketch"),
    (Some(Tool::Implant), "Implant", "hair.implant"),
    (Some(Tool::Lengthen), "Lengthen", "hair.lengthen"),
    (Some(Tool::Comb), "Comb", "hair.comb"),
    (Some(Tool::Cut), "Cut", "hair.cut"),
    (Some(Tool::Density), "Density", "hair.density"),
    (Some(Tool::Twist), "Twist", "hair.twist"),
    (Some(Tool::Frizz), "Frizz", "hair.frizz"),
    (Some(Tool::Pin), "Pin", "hair.pin"),
    (Some(Tool::Smooth), "Smooth", "hair.smooth"),
    (Some(Tool::Puff), "Puff", "hair.puff"),
    (Some(Tool::Grab), "Grab", "hair.grab"),
    (Some(Tool::Straighten), "Straighten", "hair.straighten"),
    (Some(Tool::Point), "Points", "hair.point"),
    (Some(Tool::Redraw), "Re-draw", "hair.redraw"),
    (Some(Tool::Scatter), "Scatter", "hair.scatter"),
    (Some(Tool::Silhouette), "Silhouette", "hair.silhouette"),
];

impl PenTool {
    /// Tools on strokes, as they stand in the bar.
    pub const ALL: [Self; 7] = [
        Self::Select,
        Self::Draw,
        Self::Points,
        Self::Redraw,
        Self::Erase,
        Self::Comb,
        Self::Smooth,
    ];

    /// What the bar and the corner of the picture say.
    pub fn label(self) -> &'static str {
        match self {
            Self::Select => "Select",
            Self::Draw => "Draw",
            Self::Points => "Points",
            Self::Redraw => "Re-draw",
            Self::Erase => "Erase",
            Self::Comb => "Comb",
            Self::Smooth => "Smooth",
            Self::Hair(tool) => hair_tool(tool).1,
            Self::Mask(mode) => mask::tool(mode).0,
        }
    }

    /// The action that takes it up.
    pub fn action(self) -> &'static str {
        match self {
            Self::Select => "pen.select",
            Self::Draw => "pen.draw",
            Self::Points => "pen.points",
            Self::Redraw => "pen.redraw",
            Self::Erase => "pen.erase",
            Self::Comb => "pen.comb",
            Self::Smooth => "pen.smooth_brush",
            Self::Hair(tool) => hair_tool(tool).2,
            Self::Mask(mode) => mask::tool(mode).1,
        }
    }

    /// Whether it works with a disc on the scalp.
    fn has_brush(self) -> bool {
        matches!(self, Self::Erase | Self::Comb | Self::Smooth)
    }
}

fn hair_tool(tool: Option<Tool>) -> (Option<Tool>, &'static str, &'static str) {
    HAIR_TOOLS.iter().find(|(own, ..)| *own == tool).copied().unwrap_or(HAIR_TOOLS[0])
}

/// What is picked of the strokes of the node that the pen works on.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct StrokeSelection {
    /// Strokes.
    pub strokes: BTreeSet<u64>,
    /// Points of strokes, by number.
    pub points: BTreeSet<(u64, usize)>,
}

impl StrokeSelection {
    /// The strokes that are picked or have a picked point.
    pub fn touched(&self) -> BTreeSet<u64> {
        self.strokes.iter().copied().chain(self.points.iter().map(|(id, _)| *id)).collect()
    }
    /// The picked points of a stroke.
    pub(crate) fn points_of(&self, id: u64) -> BTreeSet<usize> {
        self.points.iter().filter(|(of, _)| *of == id).map(|(_, at)| *at).collect()
    }
    /// Forgets what is gone.
    fn keep(&mut self, strokes: &Strokes) {
        let count = |id: u64| strokes.0.iter().find(|s| s.id == id).map_or(0, |s| s.samples.len());
        self.strokes.retain(|id| count(*id) > 0);
        self.points.retain(|(id, at)| *at < count(*id));
    }
}

/// The pen room.
#[derive(Default)]
pub struct Pen {
    /// All that can be pointed with.
    pub devices: Devices,
    /// What it does.
    pub tool: PenTool,
    /// What it has hold of.
    pub picked: StrokeSelection,
    /// Whether the settings of devices are open.
    pub settings_open: bool,
    /// A recipe over hair, while it is asked whether that hair stays.
    pub(crate) asked: Option<usize>,
    /// Whether new nodes hold strokes in space.
    pub free: bool,
    hairline: std::cell::RefCell<hairline::Hairline>,
    /// What it does to hair.
    pub(crate) hair: hair::Hair,
    /// What it paints.
    pub(crate) mask: mask::Mask,
    gesture: Option<ActiveTouch>,
    /// What a touch on strokes had to say.
    said: Option<Said>,
    /// What ended in this frame: it is painted until the document, in the next one, has it.
    ended: Option<Work>,
    hover: Option<Input>,
    /// The strokes before the eye.
    shapes: Shapes,
    /// The picked node: what is picked is forgotten with it.
    node: Option<NodeId>,
    /// The selected curves when strokes were picked by them last.
    followed: BTreeSet<u64>,
    /// Pressure of the last touch, for the test strip.
    strip: Vec<f32>,
}

/// How long the pen's place tells why a touch did nothing, seconds.
const TELLS: f64 = 4.0;

/// Why a touch did nothing, where it ended, and until when that is told.
#[derive(Clone, Debug)]
struct Said {
    at: Pos2,
    until: f64,
    text: String,
}

impl Said {
    fn new(at: Pos2, now: f64, text: impl Into<String>) -> Self {
        Self { at, until: now + TELLS, text: text.into() }
    }
}

/// What a gesture reads.
struct Scene<'a> {
    state: &'a State,
    view: &'a Projection,
    scalp: &'a Arc<Scalp>,
    node: Option<&'a NodeId>,
    strokes: &'a Arc<Strokes>,
    modifiers: egui::Modifiers,
    /// How near to something the pen must be to mean it, points.
    reach: f32,
    out: &'a mut Vec<Event>,
}

impl<'a> Scene<'a> {
    /// What the pen on hair reads: it has strokes of its own.
    fn of_hair(
        state: &'a State,
        view: &'a Projection,
        scalp: &'a Arc<Scalp>,
        ctx: &egui::Context,
        out: &'a mut Vec<Event>,
    ) -> Self {
        static NONE: std::sync::LazyLock<Arc<Strokes>> = std::sync::LazyLock::new(Arc::default);
        let modifiers = ctx.input(|input| input.modifiers);
        Self { state, view, scalp, node: None, strokes: &NONE, modifiers, reach: 0.0, out }
    }
}

impl Pen {
    /// What the pen has hold of at this moment, and the viewport leaves alone.
    /// A picture that is only looked at is turned, and nothing else.
    pub fn holds(&self, ctx: &egui::Context, looks: bool) -> Holds {
        let works = looks || self.tool != PenTool::Select;
        Holds {
            pointer: self.is_drawing() || (works && !turns_view(ctx)),
            wheel: self.is_drawing(),
            near: self.devices.is_near() || looks,
            skin: self.is_on_skin(),
        }
    }

    /// Whether a touch is under way.
    pub fn is_drawing(&self) -> bool {
        self.gesture.is_some() || self.hair.is_drawing() || self.mask.is_drawing()
    }

    /// Whether the pen is down and reaches the skin under hair.
    fn is_on_skin(&self) -> bool {
        matches!(self.tool, PenTool::Hair(_)) && self.hair.reaches_skin()
    }

    /// Outputs that it must see besides what is displayed.
    pub fn wants(&self, state: &State) -> Vec<Socket> {
        match self.tool {
            PenTool::Hair(_) => {
                hair::target::wanted(state).into_iter().chain(partings::output(state)).collect()
            }
            PenTool::Mask(_) => mask::target::wanted(state),
            _ => vec![],
        }
    }

    /// One frame in the viewport: takes what the devices said, says what happened, and paints strokes, brush and cursor
    /// over the picture. `hovered` tells whether egui's pointer is over the picture itself and no widget on it.
    pub fn ui(
        &mut self,
        state: &State,
        view: &Projection,
        ui: &egui::Ui,
        hovered: bool,
        out: &mut Vec<Event>,
    ) {
        let ctx = ui.ctx();
        // egui's pointer may trail a pen by a frame; what it is over counts where both are at one place.
        let pointer = ctx.input(|input| input.pointer.hover_pos());
        let free = |at: Pos2| {
            let known = pointer.is_some_and(|p| p.distance(at) < devices::SAME_PLACE);
            let layer = ctx.layer_id_at(at).is_none_or(|layer| layer == ui.layer_id());
            view.rect.contains(at) && layer && (hovered || !known)
        };
        let settings = &state.settings.pen;
        let pixels_per_point = ctx.pixels_per_point();
        let inputs = ctx.input(|input| {
            let frame = Frame {
                events: &input.events,
                time: input.time,
                pixels_per_point,
                shift: input.modifiers.shift,
            };
            self.devices.poll(&frame, settings)
        });
        for input in &inputs {
            self.note_pressure(input);
        }
        let shown = state.shown.as_ref();
        let Some(scalp) = shown.and_then(|shown| shown.scalp()) else {
            self.gesture = None;
            self.shapes.clear();
            self.hair.stop(out);
            self.mask.stop(out);
            let down = |input: &Input| input.sample.phase == Phase::Down && free(input.sample.pos);
            let current = state.run.reports.revision == state.revision;
            if self.tool != PenTool::Select && current && inputs.iter().any(down) {
                let note = "there is no head to draw on: add a head to the graph";
                out.push(Event::Say(Note::warning(note)));
            }
            return;
        };
        if let PenTool::Mask(mode) = self.tool {
            self.hair.stop(out);
            let mut scene = Scene::of_hair(state, view, scalp, ctx, out);
            self.shapes.clear();
            if let Some(gesture) = self.gesture.take() {
                gesture.abort(&mut scene);
            }
            return self.on_mask(mode, inputs, ui, scene, &free);
        }
        self.mask.stop(out);
        if let PenTool::Hair(tool) = self.tool {
            let scene = Scene::of_hair(state, view, scalp, ctx, out);
            return self.on_hair(tool, inputs, ui, scene, &free);
        }
        self.hair.stop(out);
        let node = target::of(state);
        let strokes =
            node.as_ref().map_or_else(Arc::default, |id| target::strokes(&state.document, id));
        if node != self.node {
            (self.node, self.picked) = (node.clone(), StrokeSelection::default());
        }
        self.picked.keep(&strokes);
        if self.tool == PenTool::Select {
            self.shapes.clear();
            self.follow_selection(state, node.as_ref(), &strokes);
        } else {
            self.shapes.update(state, node.as_ref(), &strokes, scalp, view);
        }
        let mut scene = Scene {
            state,
            view,
            scalp,
            node: node.as_ref(),
            strokes: &strokes,
            modifiers: ctx.input(|input| input.modifiers),
            reach: if state.settings.pen_mode { 16.0 } else { 12.0 },
            out,
        };
        self.ended = None;
        let stopped = ctx.input(|input| input.key_down(Key::Escape));
        if stopped && let Some(gesture) = self.gesture.take() {
            gesture.abort(&mut scene);
        }
        let turns = turns_view(ctx);
        let now = ctx.input(|input| input.time);
        for input in inputs {
            self.take(input, &mut scene, turns, &free, now);
        }
        if let Some(gesture) = &mut self.gesture {
            if gesture.is_orphaned(&scene) {
                self.gesture = None;
            } else if ready(state) {
                gesture.flush(&mut scene);
            }
        }
        if self.gesture.is_some() {
            self.wheel(ctx, &mut scene);
        }
        self.paint(ui, &scene);
        if self.ended.is_some() {
            ctx.request_repaint();
        }
    }

    /// Reports, each with whether a touch may begin there: on the picture, and not to turn the view. The last is hovered.
    fn told(
        &mut self,
        inputs: Vec<Input>,
        ctx: &egui::Context,
        free: &dyn Fn(Pos2) -> bool,
    ) -> Vec<(Input, bool)> {
        let turns = turns_view(ctx);
        let mut told = vec![];
        for input in inputs {
            let sample = input.sample;
            let here = free(sample.pos);
            self.hover = (sample.phase != Phase::Out && here).then_some(input);
            let views = turns || sample.buttons.barrel || sample.buttons.second;
            told.push((input, here && !views));
        }
        told
    }

    /// One frame with a tool for hair in hand.
    fn on_hair(
        &mut self,
        tool: Option<Tool>,
        inputs: Vec<Input>,
        ui: &egui::Ui,
        mut scene: Scene,
        free: &dyn Fn(Pos2) -> bool,
    ) {
        let ctx = ui.ctx();
        self.shapes.clear();
        if let Some(gesture) = self.gesture.take() {
            gesture.abort(&mut scene);
        }
        if ctx.input(|input| input.key_down(Key::Escape)) && self.hair.is_drawing() {
            self.hair.stop(scene.out);
        }
        let told = self.told(inputs, ctx, free);
        let now = ctx.input(|input| input.time);
        self.hair.ui(tool, told, &mut scene, now);
        self.paint_hair(ui, &scene);
        if self.hair.is_busy() {
            ctx.request_repaint();
        }
    }

    /// Picks a stroke of a node, whose curves need not be selected.
    pub(crate) fn pick(&mut self, node: NodeId, id: u64, selected: &BTreeSet<u64>) {
        self.node = Some(node);
        self.picked = StrokeSelection { strokes: [id].into(), ..StrokeSelection::default() };
        self.followed = selected.clone();
    }

    /// Without a tool in hand the strokes whose curves are selected in other rooms are picked.
    fn follow_selection(&mut self, state: &State, node: Option<&NodeId>, strokes: &Strokes) {
        let selected = &state.selection.curves;
        if self.followed == *selected {
            return;
        }
        self.followed = selected.clone();
        let Some(node) = node else { return };
        let is_selected = |id: &u64| {
            shapes::curves_of(state, node, &BTreeSet::from([*id]))
                .iter()
                .any(|c| selected.contains(c))
        };
        let ids = strokes.0.iter().map(|stroke| stroke.id).filter(is_selected).collect();
        self.picked = StrokeSelection { strokes: ids, ..StrokeSelection::default() };
    }

    /// One report: hovering is remembered, a touch begins, goes on or ends.
    fn take(
        &mut self,
        input: Input,
        scene: &mut Scene,
        turns_view: bool,
        free: &dyn Fn(Pos2) -> bool,
        now: f64,
    ) {
        let sample = input.sample;
        self.hover = (sample.phase != Phase::Out && free(sample.pos)).then_some(input);
        match (sample.phase, &mut self.gesture) {
            (Phase::Down, None) => {
                // Barrel buttons, and the keys that turn the view, are the view's.
                let views = turns_view || sample.buttons.barrel || sample.buttons.second;
                if !views && free(sample.pos) {
                    self.said = None;
                    let begun = self.begin(&input, scene);
                    self.gesture = begun.unwrap_or_else(|why| {
                        self.said = Some(Said::new(sample.pos, now, why));
                        None
                    });
                }
            }
            (Phase::Move, Some(gesture)) => {
                gesture.go_on(&sample, scene, &self.shapes, &mut self.picked)
            }
            (Phase::Up, Some(_)) => {
                if let Some(mut gesture) = self.gesture.take() {
                    gesture.go_on(&sample, scene, &self.shapes, &mut self.picked);
                    match gesture.too_short(scene) {
                        true => {
                            gesture.abort(scene);
                            let why = "The stroke is too short: draw it longer";
                            self.said = Some(Said::new(sample.pos, now, why));
                        }
                        false => {
                            if gesture.makes_no_hair(scene) {
                                self.said = Some(Said::new(sample.pos, now, NO_HAIR));
                            }
                            gesture.end(scene, &self.shapes, &mut self.picked);
                            self.ended = Some(gesture.work);
                        }
                    }
                }
            }
            (Phase::Out, Some(_)) => {
                if let Some(gesture) = self.gesture.take() {
                    gesture.abort(scene);
                }
            }
            _ => {}
        }
    }

    /// The wheel changes the pressure of a mouse while it draws.
    fn wheel(&self, ctx: &egui::Context, scene: &mut Scene) {
        let by = ctx.input(|input| input.smooth_scroll_delta().y);
        let settings = &scene.state.settings;
        let level = (settings.pen.mouse_pressure + by * 0.002).clamp(0.0, 1.0);
        if by != 0.0 && level != settings.pen.mouse_pressure {
            let mut settings = settings.clone();
            settings.pen.mouse_pressure = level;
            scene.out.push(Event::Settings(settings.into()));
        }
    }

    fn note_pressure(&mut self, input: &Input) {
        match input.sample.phase {
            Phase::Down => self.strip = vec![input.sample.pressure],
            Phase::Move if self.strip.len() < 4096 => self.strip.push(input.sample.pressure),
            _ => {}
        }
    }

    /// Where the pen is, with a rectangle that labels keep out of: that of the hand.
    fn hand(input: &Input) -> Rect {
        let size = egui::Vec2::new(160.0, 120.0);
        let left = if input.left_handed { input.sample.pos.x - size.x } else { input.sample.pos.x };
        Rect::from_min_size(Pos2::new(left, input.sample.pos.y), size)
    }
}

/// What is said of strokes that nothing grows hair from.
const NO_HAIR: &str =
    "Strokes are no hair yet: take a recipe, or wire them to a node that grows hair from them";

/// Whether the evaluator has answered the last change, so that the next one may come.
fn ready(state: &State) -> bool {
    use crate::core::settings::Evaluate;
    state.settings.evaluate != Evaluate::Live || state.run.reports.revision == state.revision
}

/// Whether keys are held that make the pointer turn the view.
fn turns_view(ctx: &egui::Context) -> bool {
    ctx.input(|input| input.modifiers.alt || input.key_down(Key::Space))
}
