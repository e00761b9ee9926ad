//! The pen: from devices to strokes in the document.
//!
//! `devices.rs` makes one stream of samples of all pens, mice and fingers; a tool turns those of a touch (`touch.rs`) into what an
//! input of one node (`target.rs`) holds: strokes (`strokes.rs`), gestures on hair (`hair/`), or a mask (`mask/`). A touch is one
//! undo step. What is drawn is seen in the frame in which its samples arrive; the document, and so the hair downstream,
//! follows whenever the evaluator has answered the last change, and in full when the pen is lifted.
//!
//! Guarantees: the stroke that stays is a function of the samples alone; a touch whose stroke or node goes away
//! meanwhile (an undo, another document) ends without a word; egui's own pointer never draws what a pen draws.
//! The room knows nothing of evaluation: it reads what is shown.

pub mod actions;
pub mod devices;
mod drawing;
mod edits;
pub(crate) mod hair;
mod hairline;
mod leave_out;
pub(crate) mod mask;
mod overlay;
mod panel;
mod partings;
pub(crate) mod recipes;
pub mod sample;
mod shapes;
mod strokes;
mod target;
#[cfg(test)]
mod tests;
mod touch;
mod x11;

use crate::core::action::Of;
use crate::core::event::Event;
use crate::core::notes::Note;
use crate::core::pen::Holds;
use crate::core::projection::{self, Projection};
use crate::core::state::State;
use crate::widgets::icons::{self, Icon};
use coif_graphs::document::{NodeId, Socket};
use coif_nodes::data::gestures::Tool;
use coif_nodes::data::scalp::Scalp;
use coif_nodes::data::strokes::{Mode, Strokes};
use devices::{Devices, Frame, Input};
use drawing::Lie;
use egui::{Key, Pos2};
use hairline::Hairline;
use sample::Phase;
use shapes::Shapes;
use std::collections::BTreeSet;
use std::sync::Arc;
use target::Fills;
use touch::Touches;
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

/// A tool as it stands in the bar: what it is called, its action, and its icon.
type ToolEntry = (PenTool, &'static str, &'static str, Icon);

/// The tools of the bar, grouped as hands think: to select, draw, comb, cut, shape and paint. Within a group, what
/// works on hair comes before what works on strokes.
const TOOLS: &[&[ToolEntry]] = &[
    &[
        (PenTool::Select, "Select", "pen.select", icons::SELECT),
        (PenTool::Hair(Some(Tool::Point)), "Points", "hair.point", icons::HAIR_POINTS),
        (PenTool::Points, "Stroke points", "pen.points", icons::STROKE_POINTS),
    ],
    &[
        (PenTool::Hair(None), "Sketch", "hair.sketch", icons::SKETCH),
        (PenTool::Hair(Some(Tool::Implant)), "Implant", "hair.implant", icons::IMPLANT),
        (PenTool::Hair(Some(Tool::Lengthen)), "Lengthen", "hair.lengthen", icons::LENGTHEN),
        (PenTool::Hair(Some(Tool::Redraw)), "Re-draw", "hair.redraw", icons::REDRAW_HAIR),
        (PenTool::Hair(Some(Tool::Scatter)), "Scatter", "hair.scatter", icons::SCATTER),
        (PenTool::Hair(Some(Tool::Silhouette)), "Silhouette", "hair.silhouette", icons::SILHOUETTE),
        (PenTool::Draw, "Draw", "pen.draw", icons::DRAW),
        (PenTool::Redraw, "Re-draw stroke", "pen.redraw", icons::REDRAW_STROKE),
    ],
    &[
        (PenTool::Hair(Some(Tool::Comb)), "Comb", "hair.comb", icons::COMB_HAIR),
        (PenTool::Hair(Some(Tool::Smooth)), "Smooth", "hair.smooth", icons::SMOOTH_HAIR),
        (PenTool::Hair(Some(Tool::Grab)), "Grab", "hair.grab", icons::GRAB),
        (PenTool::Comb, "Comb strokes", "pen.comb", icons::COMB_STROKES),
        (PenTool::Smooth, "Smooth strokes", "pen.smooth_brush", icons::SMOOTH_STROKES),
    ],
    &[
        (PenTool::Hair(Some(Tool::Cut)), "Cut", "hair.cut", icons::CUT),
        (PenTool::Erase, "Erase strokes", "pen.erase", icons::ERASE_STROKES),
    ],
    &[
        (PenTool::Hair(Some(Tool::Straighten)), "Straighten", "hair.straighten", icons::STRAIGHTEN),
        (PenTool::Hair(Some(Tool::Puff)), "Puff", "hair.puff", icons::PUFF),
        (PenTool::Hair(Some(Tool::Twist)), "Twist", "hair.twist", icons::TWIST),
        (PenTool::Hair(Some(Tool::Frizz)), "Frizz", "hair.frizz", icons::FRIZZ),
        (PenTool::Hair(Some(Tool::Density)), "Density", "hair.density", icons::DENSITY),
        (PenTool::Hair(Some(Tool::Pin)), "Pin", "hair.pin", icons::PIN),
    ],
    &[
        (PenTool::Mask(Mode::Paint), "Paint", "mask.paint", icons::PAINT),
        (PenTool::Mask(Mode::Erase), "Erase mask", "mask.erase", icons::ERASE_MASK),
        (PenTool::Mask(Mode::Smooth), "Smooth mask", "mask.smooth", icons::SMOOTH_MASK),
        (PenTool::Mask(Mode::Flood), "Flood", "mask.flood", icons::FLOOD),
    ],
];

impl PenTool {
    /// What the bar and the corner of the picture say.
    pub fn label(self) -> &'static str {
        self.entry().map_or("", |(_, label, ..)| label)
    }

    fn entry(self) -> Option<&'static ToolEntry> {
        TOOLS.iter().copied().flatten().find(|(tool, ..)| *tool == self)
    }

    /// Whether it works on strokes.
    fn is_on_strokes(self) -> bool {
        self != Self::Select && self.fills() == Fills::Strokes
    }

    /// Whether it works with a disc on the scalp.
    fn has_brush(self) -> bool {
        match self {
            Self::Erase | Self::Comb | Self::Smooth => true,
            Self::Mask(mode) => mode != Mode::Flood,
            _ => false,
        }
    }

    /// What it fills.
    fn fills(self) -> Fills {
        match self {
            Self::Hair(_) => Fills::Hair,
            Self::Mask(_) => Fills::Mask,
            _ => Fills::Strokes,
        }
    }
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
    /// One stroke.
    fn of_stroke(id: u64) -> Self {
        Self { strokes: [id].into(), ..Self::default() }
    }
    /// One point of a stroke.
    fn of_point(id: u64, at: usize) -> Self {
        Self { points: [(id, at)].into(), ..Self::default() }
    }
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
    hairline: Hairline,
    /// What it does to hair.
    pub(crate) hair: hair::Hair,
    /// What it paints.
    pub(crate) mask: mask::Mask,
    touches: Touches,
    /// What a touch had to say.
    said: Option<Said>,
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

/// What tools read and change in a frame.
struct Scene<'a> {
    state: &'a State,
    view: Projection,
    scalp: &'a Arc<Scalp>,
    /// The node that the tool in hand fills, where there is one, and its strokes.
    node: Option<NodeId>,
    strokes: Arc<Strokes>,
    shapes: &'a Shapes,
    picked: &'a mut StrokeSelection,
    hair: &'a mut hair::Hair,
    mask: &'a mut mask::Mask,
    hairline: &'a mut Hairline,
    said: &'a mut Option<Said>,
    modifiers: egui::Modifiers,
    /// Seconds on egui's clock.
    now: f64,
    /// How near to something the pen must be to mean it, points.
    reach: f32,
    out: &'a mut Vec<Event>,
}

impl Scene<'_> {
    /// Says why a touch did nothing, where it ended.
    fn say(&mut self, at: Pos2, text: impl Into<String>) {
        *self.said = Some(Said { at, until: self.now + TELLS, text: text.into() });
    }
    /// Where strokes of the node lie.
    fn lie(&self) -> Lie {
        let choice = |node| target::choice(&self.state.document, node, "project");
        let project = self.node.as_ref().and_then(choice);
        if project.as_deref() == Some("free") { Lie::Space } else { Lie::Scalp }
    }
    /// Whether the node draws strokes on both sides of the head, or would if it were there.
    fn is_mirrored(&self) -> bool {
        let choice = |node| target::choice(&self.state.document, node, "mirror");
        match &self.node {
            Some(node) => choice(node).as_deref() == Some("both"),
            None => self.state.settings.pen.symmetry,
        }
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
            skin: self.touches.reaches_skin(),
        }
    }

    /// Whether a touch is under way.
    pub fn is_drawing(&self) -> bool {
        self.touches.is_drawing()
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
        let inputs = self.inputs(state, view, ui, hovered);
        let scalp = state.shown.as_ref().and_then(|shown| shown.scalp());
        let fills = self.tool.fills();
        self.touches.keep(scalp.map(|_| fills), state, out);
        let Some(scalp) = scalp else {
            self.shapes.clear();
            return out.extend(self.no_head(&inputs, state));
        };
        let node = target::of(state, fills);
        let strokes =
            node.as_ref().map_or_else(Arc::default, |id| target::strokes(&state.document, id));
        if fills == Fills::Strokes {
            self.follow(state, node.as_ref(), &strokes);
        }
        match self.tool.is_on_strokes() {
            true => self.shapes.update(state, node.as_ref(), &strokes, scalp, view),
            false => self.shapes.clear(),
        }
        let shown = fills != Fills::Hair || self.hair.is_shown(state);
        let mut scene = Scene {
            state,
            view: *view,
            scalp,
            node,
            strokes,
            shapes: &self.shapes,
            picked: &mut self.picked,
            hair: &mut self.hair,
            mask: &mut self.mask,
            hairline: &mut self.hairline,
            said: &mut self.said,
            modifiers: ctx.input(|input| input.modifiers),
            now: ctx.input(|input| input.time),
            reach: if state.settings.pen_mode { 16.0 } else { 12.0 },
            out,
        };
        if self.touches.is_drawing() && ctx.input(|input| input.key_down(Key::Escape)) {
            self.touches.stop(scene.out);
        }
        self.touches.ui(self.tool, inputs, shown, &mut scene);
        if self.touches.is_drawing() && fills == Fills::Strokes {
            press_by_wheel(ctx, &mut scene);
        }
        overlay::paint(self.tool, &self.touches, ui, &mut scene);
        if self.touches.is_busy() {
            ctx.request_repaint();
        }
    }

    /// What the devices said, each report with whether a touch may begin there: on the picture, and not to turn the view.
    fn inputs(
        &mut self,
        state: &State,
        view: &Projection,
        ui: &egui::Ui,
        hovered: bool,
    ) -> Vec<(Input, bool)> {
        let ctx = ui.ctx();
        // egui's pointer may trail a pen by a frame, or have left a button already when a slow frame ends; what it is over counts where
        // both are at one place. Over a button that is only clicked it is over the picture too, which is dragged.
        let pointer = ctx.input(|input| input.pointer.hover_pos());
        let free = |at: Pos2| {
            let known = pointer.is_some_and(|p| p.distance(at) < devices::SAME_PLACE);
            let layer = ctx.layer_id_at(at).is_none_or(|layer| layer == ui.layer_id());
            let seen = view.rect.intersect(ui.clip_rect());
            seen.contains(at) && layer && is_on_picture(ui, at) && (hovered || !known)
        };
        let pixels_per_point = ctx.pixels_per_point();
        let inputs = ctx.input(|input| {
            let frame = Frame {
                events: &input.events,
                time: input.time,
                pixels_per_point,
                shift: input.modifiers.shift,
            };
            self.devices.poll(&frame, &state.settings.pen)
        });
        let turns = turns_view(ctx);
        let told = inputs.into_iter().map(|input| {
            let sample = input.sample;
            let here = free(sample.pos);
            self.touches.hover = (sample.phase != Phase::Out && here).then_some(input);
            match sample.phase {
                Phase::Down => self.strip = vec![sample.pressure],
                Phase::Move if self.strip.len() < 4096 => self.strip.push(sample.pressure),
                _ => {}
            }
            // Barrel buttons, and the keys that turn the view, are the view's.
            (input, here && !turns && !sample.buttons.barrel && !sample.buttons.second)
        });
        told.collect()
    }

    /// What is said of touches where there is no head.
    fn no_head(&self, inputs: &[(Input, bool)], state: &State) -> Option<Event> {
        let down = |(input, free): &(Input, bool)| input.sample.phase == Phase::Down && *free;
        let current = state.run.reports.revision == state.revision;
        let draws = self.tool != PenTool::Select && current && inputs.iter().any(down);
        let note = "there is no head to draw on: add a head to the graph";
        draws.then(|| Event::Say(Note::warning(note)))
    }

    /// Picks a stroke of a node, whose curves need not be selected.
    pub(crate) fn pick(&mut self, node: NodeId, id: u64, selected: &BTreeSet<u64>) {
        self.node = Some(node);
        self.picked = StrokeSelection::of_stroke(id);
        self.followed = selected.clone();
    }

    /// What is picked are strokes that are there, and without a tool in hand those whose curves are selected in other rooms.
    fn follow(&mut self, state: &State, node: Option<&NodeId>, strokes: &Strokes) {
        if self.node.as_ref() != node {
            (self.node, self.picked) = (node.cloned(), StrokeSelection::default());
        }
        self.picked.keep(strokes);
        let selected = &state.selection.curves;
        if self.tool == PenTool::Select && self.followed != *selected {
            self.followed = selected.clone();
            let curves = |id: u64| {
                node.map_or_else(BTreeSet::new, |node| shapes::curves_of(state, node, &[id].into()))
            };
            let ids = strokes.0.iter().map(|stroke| stroke.id);
            let strokes = ids.filter(|id| !curves(*id).is_disjoint(selected)).collect();
            self.picked = StrokeSelection { strokes, ..StrokeSelection::default() };
        }
    }
}

/// The wheel changes the pressure of a mouse while it draws.
fn press_by_wheel(ctx: &egui::Context, scene: &mut Scene) {
    let by = ctx.input(|input| input.smooth_scroll_delta().y);
    let settings = &scene.state.settings;
    let level = (settings.pen.mouse_pressure + by * 0.002).clamp(0.0, 1.0);
    if by != 0.0 && level != settings.pen.mouse_pressure {
        let mut settings = settings.clone();
        settings.pen.mouse_pressure = level;
        scene.out.push(Event::Settings(settings.into()));
    }
}

/// Whether keys are held that make the pointer turn the view.
fn turns_view(ctx: &egui::Context) -> bool {
    ctx.input(|input| input.modifiers.alt || input.key_down(Key::Space))
}

/// Whether nothing that can be pressed lies over the picture at a place, as the last frame had it.
fn is_on_picture(ui: &egui::Ui, at: Pos2) -> bool {
    let picture = projection::picture(ui);
    ui.ctx().viewport(|shown| {
        let mut over = shown.prev_pass.widgets.get_layer(ui.layer_id());
        let _ = over.find(|it| it.id == picture);
        !over.any(|it| it.sense.interactive() && it.interact_rect.contains(at))
    })
}
