//! The pen on hair: what a touch begins on it, by what is in hand and what lies under the pen.
//!
//! A touch is a gesture of a *Hair sketch* from its first sample on (`touch.rs`), so what is seen is what the node makes of it, and what
//! stays is what was seen. Beside skin and hair it picks a colour (`wheel.rs`).
//!
//! Guarantees: a touch begins only on hair that is shown as it is; one that does nothing changes nothing, and the place where it ended
//! says why; while curves are selected, what is there of the rest stays as it is.

pub(crate) mod actions;
mod free;
mod look;
pub(super) mod target;
mod touch;
mod wheel;

pub(super) use free::words as frozen;
pub(super) use look::{cursor, has_brush, under};

use super::Scene;
use super::sample::{PenSample as Report, Tool as End};
use super::target::{Fills, number as number_of};
use super::touch::{Begun, Touch};
use crate::core::projection::Projection;
use crate::core::state::State;
use coif_graphs::document::edit::Edit;
use coif_graphs::document::{NodeId, Socket};
use coif_nodes::data::curves::Curves;
use coif_nodes::data::gestures::{GestureView, Layer, PenSample, Tool};
use coif_nodes::data::scalp::HeadFrame;
use coif_nodes::maths::hash::Key;
use coif_nodes::sketch::around::ViewedCurves;
use coif_nodes::sketch::level::Rule;
use egui::Pos2;
use glam::Vec2;
use touch::{HairTouch, InHand, Line};

/// So many frames after the evaluator has answered, what it has not shown will not come.
const PATIENCE: usize = 3;

/// The pen on hair.
#[derive(Default)]
pub(crate) struct Hair {
    /// How deep touches reach; none: as the pressure says, and of a mouse, what it touches.
    pub(crate) level: Option<Layer>,
    /// The tap before, with when it began: the first of two.
    tap: Option<(f64, Vec<PenSample>)>,
    /// For how many frames the evaluator has answered.
    answered: usize,
    /// What the pen must see.
    wanted: Vec<Socket>,
    free: free::FreeCount,
}

/// The view of a projection, as gestures keep it: in the head's frame, with points of the screen for pixels.
pub(super) fn seen_from(view: &Projection, frame: &HeadFrame) -> GestureView {
    let camera = &view.camera;
    let parallel = camera.orthographic.is_some();
    let half_height = 0.5 * view.cm_per_point(1.0) * view.rect.height();
    GestureView {
        eye: frame.head_from_point(camera.eye),
        target: frame.head_from_point(camera.eye + view.axes()[2] * 10.0),
        up: frame.head_from_vector(view.axes()[1]),
        half_height: if parallel { half_height / frame.unit() } else { half_height },
        parallel,
        pixels: view.rect.height(),
    }
}

/// Where the pen is in the picture, and the view that it is seen under.
struct Spot {
    view: GestureView,
    at: Vec2,
    /// How far the pen reaches, pixels.
    rho: f32,
}

impl Spot {
    fn of(scene: &Scene, pos: Pos2) -> Self {
        let off = pos - scene.view.rect.center();
        let view = seen_from(&scene.view, scene.scalp.frame());
        Self { view, at: Vec2::new(off.x, off.y), rho: number(scene, "rho") }
    }
    /// Curves in the view.
    fn ground<'a>(&self, scene: &'a Scene, curves: &'a Curves) -> ViewedCurves<'a> {
        ViewedCurves::new(&self.view, scene.scalp, curves, self.rho)
    }
}

/// A number of the sketch that is there or would be made.
fn number(scene: &Scene, input: &str) -> f32 {
    number_of(&scene.state.document, target::KIND, scene.node.as_ref(), input)
}

/// Whether a device has no pressure of its own.
fn is_mouse(end: End) -> bool {
    matches!(end, End::Mouse | End::Finger)
}

/// Whether the colour wheel is at the pen: nothing else is near.
fn picks_colour(tool: Option<Tool>, end: End, ground: &ViewedCurves, spot: &Spot) -> bool {
    tool.is_none() && end != End::Eraser && wheel::is_free(ground, spot.at, spot.rho)
}

impl Hair {
    /// Whether the hair is shown as the document says, or will not be. Asked once a frame.
    pub(super) fn is_shown(&mut self, state: &State) -> bool {
        let wanted = target::wanted(state);
        let shown = state.shown.as_ref();
        let known = |socket| shown.is_some_and(|shown| shown.curves_of(socket).is_some());
        let known = wanted.iter().all(known);
        let current = state.run.reports.revision == state.revision && wanted == self.wanted;
        let runs = !known && state.run.since.is_some();
        self.answered = if current && !runs { self.answered + 1 } else { 0 };
        self.wanted = wanted;
        self.answered > PATIENCE || self.answered > 0 && known && !state.stale()
    }

    /// The hair was changed: what is shown is not it.
    pub(super) fn changed(&mut self) {
        self.answered = 0;
    }

    /// How deep a touch reaches, where that is known before it.
    fn depth(
        &self,
        tool: Option<Tool>,
        end: End,
        ground: &ViewedCurves,
        at: Vec2,
    ) -> Option<Layer> {
        match (tool, self.level) {
            (Some(Tool::Implant | Tool::Silhouette | Tool::Scatter), _) => Some(Layer::Scalp),
            (Some(Tool::Lengthen | Tool::Pin | Tool::Point | Tool::Redraw), _) => {
                Some(Layer::Nearest)
            }
            // A mouse has no pressure: what it begins on tells.
            (None, None) if is_mouse(end) => Some(match ground.end(at) {
                Some(_) => Layer::Nearest,
                None if ground.hair(at) || ground.skin(at).is_none() => Layer::Through,
                None => Layer::Scalp,
            }),
            (_, level) => level,
        }
    }
}

/// What a touch begins.
pub(super) fn begin(tool: Option<Tool>, report: &Report, scene: &mut Scene) -> Begun {
    let spot = Spot::of(scene, report.pos);
    let curves = target::curves(scene.state, scene.node.as_ref()).unwrap_or_default();
    if picks_colour(tool, report.tool, &spot.ground(scene, &curves), &spot) {
        return Ok(Some(wheel::touch(report.pos, scene)));
    }
    let Sketch { node, make, before, came_in } = sketch(scene, &spot)?;
    let fixed = scene.hair.depth(tool, report.tool, &spot.ground(scene, &before), spot.at);
    let by_mean = scene.state.settings.pen.level_by_mean;
    let rule = if by_mean { Rule::Mean } else { Rule::Highest };
    let hand = InHand { tool, end: report.tool, fixed, rule };
    let line = Line::begin(report, spot.view, scene.view.rect.center());
    let tap = scene.hair.tap.take().map(|(when, mut tap)| {
        tap.iter_mut().for_each(|sample| sample.time += (when - report.time) as f32);
        tap
    });
    let free = free::free(scene.state, &before);
    let work = HairTouch::new(hand, line, tap, (before, free), came_in);
    Ok(Some(Touch::new((node, make), Fills::Hair, "hair sketched", work, scene)))
}

/// A sketch, and the hair in it before a touch.
struct Sketch {
    node: NodeId,
    make: Vec<Edit>,
    before: Curves,
    /// The key of what came in to it.
    came_in: Option<Key>,
}

/// The sketch that a touch goes into, or is made with it.
fn sketch(scene: &Scene, spot: &Spot) -> Result<Sketch, &'static str> {
    let shown = scene.state.shown.as_ref();
    let value = |socket: &Socket| shown.and_then(|shown| shown.curves_of(socket));
    let (node, make, own, came_in) = match &scene.node {
        Some(node) => {
            let came_in = target::came_in(&scene.state.document, node);
            (node.clone(), vec![], Some(target::output(node)), came_in)
        }
        None => {
            let after = source(scene, spot)?;
            let (node, make) = made(scene, after.as_ref())?;
            // A node that is not there yet changes nothing of what comes in.
            (node, make, after.clone(), after)
        }
    };
    let before = match own.as_ref().map(value) {
        None => Curves::default(),
        Some(curves) => curves.cloned().ok_or("the hair to work on is not there: see Messages")?,
    };
    Ok(Sketch { node, make, before, came_in: came_in.as_ref().and_then(value).map(Curves::key) })
}

/// What a new sketch goes behind: the hair under the pen, else the first; none on a bare head.
fn source(scene: &Scene, spot: &Spot) -> Result<Option<Socket>, &'static str> {
    let shown = scene.state.shown.as_ref();
    let sources = target::sources(scene.state);
    let under = |socket: &&Socket| {
        let curves = shown.and_then(|shown| shown.curves_of(socket));
        curves.is_some_and(|curves| spot.ground(scene, curves).hair(spot.at))
    };
    let after = sources.iter().find(under).or(sources.first()).cloned();
    let hair = shown.is_some_and(|shown| shown.curves.curve_count() > 0);
    match (after, scene.state.settings.pen.strands) {
        (None, true) if hair => Err(
            "More than 200,000 strands cannot be combed one by one: show fewer, or turn Strands off",
        ),
        (None, false) if hair => Err(
            "This hair grows from no guides that the pen could edit: display guides or clusters",
        ),
        (after, _) => Ok(after),
    }
}

/// The edits that make a sketch. On a bare head what is sketched is filled with hair, or it would hardly be seen.
fn made(scene: &Scene, after: Option<&Socket>) -> Result<(NodeId, Vec<Edit>), &'static str> {
    let document = &scene.state.document;
    let made = match after {
        Some(after) => target::make(document, after),
        None => {
            // All of it is to be drawn yet.
            let sketch = &super::recipes::ALL[super::recipes::SKETCH];
            let made = sketch.edits(document, None, false, None);
            made.ok().and_then(|made| Some((made.drawn?, made.edits)))
        }
    };
    made.ok_or("there is no head to sketch on: add a head to the graph")
}

#[cfg(test)]
mod tests;
