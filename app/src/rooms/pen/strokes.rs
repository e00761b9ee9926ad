//! The pen on strokes: what a touch draws, re-draws, moves, picks, erases and combs.
//!
//! Strokes are told as they should be now; how the document learns of it is the touch's own (`touch.rs`).

use super::actions::step;
use super::devices::Input;
use super::drawing::{GrowingStroke, Lie, on_scalp};
use super::edits::{self, Pass};
use super::overlay;
use super::sample::{PenSample, Phase, Tool};
use super::shapes::{StrokePlace, curves_of};
use super::target::{self, Fills};
use super::touch::{Begun, DrawnItem, Outcome, Touch, TouchStep, Wanted, Work};
use super::{PenTool, Scene, StrokeSelection};
use crate::core::event::Event;
use crate::core::pen::Along;
use crate::core::shown::displayed;
use crate::core::state::Select;
use coif_graphs::document::edit::Edit;
use coif_graphs::document::graph::upstream;
use coif_graphs::document::strokes::{cvs, whole};
use coif_graphs::document::{Document, NodeId, Setting};
use coif_nodes::data::strokes::Stroke;
use coif_nodes::define::Value;
use egui::{Painter, Pos2, Rect};
use glam::Vec3;
use std::collections::{BTreeMap, BTreeSet};

/// A press that moved less than this is a click, points.
const CLICK: f32 = 4.0;
/// How far from a stroke the line that re-draws a part of it may begin and end, head units.
const REDRAW: f32 = 2.0;

/// The input of a head that says where hair grows, and its word for the hairline that is drawn.
const REGION: &str = "region";
const HAIRLINE: &str = "hairline";

/// Where no stroke begins.
const OFF_THE_HEAD: &str = "A stroke begins on the head: draw from the skin";
/// What is said of strokes that nothing grows hair from.
const NO_HAIR: &str =
    "Strokes are no hair yet: take a recipe, or wire them to a node that grows hair from them";
const NO_HAIR_IN_REGION: &str =
    "Nothing grows in this region yet: wire its scalp to a node that grows hair";

/// What a touch with a tool begins; none where it picks.
pub(super) fn begin(tool: PenTool, input: &Input, scene: &mut Scene) -> Begun {
    let sample = &input.sample;
    let tool = if sample.tool == Tool::Eraser { PenTool::Erase } else { tool };
    match no_strokes(tool).filter(|_| scene.strokes.0.is_empty()) {
        Some(why) => Err(why),
        None => match tool {
            PenTool::Select | PenTool::Hair(_) | PenTool::Mask(_) => Ok(None),
            PenTool::Draw => draw(sample, scene),
            PenTool::Points => Ok(points(input, scene)),
            PenTool::Redraw => {
                redraw(sample, scene).ok_or("Begin beside the stroke to draw anew").map(Some)
            }
            PenTool::Erase => {
                let mut erasing = Erase(BTreeSet::new());
                erasing.go_on(sample, scene);
                Ok(touch("strokes erased", erasing, scene))
            }
            PenTool::Comb | PenTool::Smooth => Ok(brush(tool, sample, scene)),
        },
    }
}

/// What a tool says where no stroke is drawn yet; none of one that needs none.
fn no_strokes(tool: PenTool) -> Option<&'static str> {
    match tool {
        PenTool::Points => Some("No stroke has points yet: draw one with P"),
        PenTool::Redraw => Some("No stroke is there to draw anew: draw one with P"),
        PenTool::Erase => Some("No stroke is there to erase: H, then K, cuts hair"),
        PenTool::Comb => Some("No stroke is there to comb: H, then C, combs hair"),
        PenTool::Smooth => Some("No stroke is there to smooth: H, then S, smooths hair"),
        PenTool::Select | PenTool::Draw | PenTool::Hair(_) | PenTool::Mask(_) => None,
    }
}

/// A touch on strokes that are there.
fn touch(words: &str, work: impl Work + 'static, scene: &Scene) -> Option<Touch> {
    let node = scene.node.clone()?;
    let words = format!("{}: {words}", scene.state.document.name_of(&node));
    Some(Touch::new((node, vec![]), Fills::Strokes, words, work, scene))
}

/// Draws a new stroke, and makes the node for it where there is none.
struct Draw(GrowingStroke);

fn draw(sample: &PenSample, scene: &Scene) -> Begun {
    let (document, both) = (&scene.state.document, scene.is_mirrored());
    let (made, words) = match &scene.node {
        Some(node) => ((node.clone(), vec![]), format!("{}: stroke drawn", document.name_of(node))),
        None => (target::make(document, both).ok_or(OFF_THE_HEAD)?, "stroke drawn".to_owned()),
    };
    let (lie, others) = (scene.lie(), &scene.strokes);
    let line = GrowingStroke::begin(scene.scalp, &scene.view, sample, lie, both, others);
    let work = Draw(line.ok_or(OFF_THE_HEAD)?);
    Ok(Some(Touch::new(made, Fills::Strokes, words, work, scene)))
}

impl Work for Draw {
    fn go_on(&mut self, sample: &PenSample, scene: &Scene) {
        self.0.add(&scene.view, sample);
    }
    fn wants(&mut self, _: &TouchStep, _: &Scene) -> Wanted {
        vec![(self.0.id(), self.0.stroke().map(DrawnItem::Stroke))]
    }
    fn end(&mut self, step: &mut TouchStep, scene: &mut Scene) -> Outcome {
        if self.is_short(scene) {
            scene.say(step.at, "The stroke is too short: draw it longer");
            return Outcome::Nothing;
        }
        let document = &scene.state.document;
        if !is_seen(document, &step.node) {
            let region = target::is_region(document, &step.node);
            scene.say(step.at, if region { NO_HAIR_IN_REGION } else { NO_HAIR });
        }
        step.tell(self.wants(step, scene), scene);
        step.also(grows_inside(document, &step.node), scene);
        Outcome::Done
    }
    fn paint(&self, painter: &Painter, scene: &Scene) {
        overlay::ink(painter, scene, &self.0);
    }
}

impl Draw {
    /// Whether nobody would see what is drawn.
    fn is_short(&self, scene: &Scene) -> bool {
        let places = || self.0.world().iter().filter_map(|p| scene.view.screen(*p));
        let first = places().next();
        first.is_some_and(|first| places().all(|at| at.distance(first) < CLICK))
    }
}

fn is_head(document: &Document, id: &NodeId) -> bool {
    document.node(id.as_str()).is_some_and(|node| node.kind == target::HEAD)
}

/// Whether strokes of a node become what is displayed, or nothing else is.
fn is_seen(document: &Document, node: &NodeId) -> bool {
    let shown = displayed(document);
    let way = upstream(document, shown.iter().map(|socket| &socket.node));
    let hair = shown.iter().any(|socket| !is_head(document, &socket.node));
    is_head(document, node) || !hair || way.contains(node)
}

/// A head takes its region from the hairline that is drawn on it.
fn grows_inside(document: &Document, node: &NodeId) -> Option<Edit> {
    let other = target::choice(document, node, REGION).is_none_or(|word| word != HAIRLINE);
    let setting = Setting::Known(Value::Text(HAIRLINE.into()));
    let (node, input) = (node.clone(), REGION.to_owned());
    (is_head(document, &node) && other).then_some(Edit::SetInput { node, input, setting })
}

/// Draws a part of a stroke anew.
struct Redraw {
    line: GrowingStroke,
    of: Stroke,
}

fn redraw(sample: &PenSample, scene: &mut Scene) -> Option<Touch> {
    let near = scene.shapes.pick(sample.pos, scene.reach * 3.0).map(StrokePlace::stroke);
    let id = near.or_else(|| scene.picked.touched().first().copied())?;
    let of = scene.strokes.0.iter().find(|stroke| stroke.id == id)?.clone();
    let (lie, others) = (scene.lie(), &scene.strokes);
    let line = GrowingStroke::begin(scene.scalp, &scene.view, sample, lie, false, others)?;
    *scene.picked = StrokeSelection::of_stroke(id);
    touch("a stroke re-drawn", Redraw { line, of }, scene)
}

impl Work for Redraw {
    fn go_on(&mut self, sample: &PenSample, scene: &Scene) {
        self.line.add(&scene.view, sample);
    }
    fn wants(&mut self, _: &TouchStep, _: &Scene) -> Wanted {
        let stroke = whole::redrawn(&self.of, self.line.samples(), REDRAW);
        stroke.into_iter().map(|stroke| (self.of.id, Some(DrawnItem::Stroke(stroke)))).collect()
    }
    fn paint(&self, painter: &Painter, scene: &Scene) {
        overlay::ink(painter, scene, &self.line);
    }
}

/// Picks, inserts or takes hold of points; beside all of them it puts an outline around some.
fn points(input: &Input, scene: &mut Scene) -> Option<Touch> {
    let at = input.sample.pos;
    match scene.shapes.pick(at, scene.reach) {
        Some(StrokePlace::Point(id, i)) => {
            pick(StrokeSelection::of_point(id, i), scene);
            let held = scene.picked.points.contains(&(id, i));
            touch("points moved", Move::of(at, id, i, scene).filter(|_| held)?, scene)
        }
        Some(StrokePlace::Line(id, i, t)) if input.double_tap => {
            insert(id, i, t, scene);
            None
        }
        Some(StrokePlace::Line(id, ..)) => {
            pick(StrokeSelection::of_stroke(id), scene);
            None
        }
        None => {
            let (lasso, add) = (scene.modifiers.command, scene.modifiers.shift);
            touch("", Outline { line: vec![at], lasso, add }, scene)
        }
    }
}

/// A click on a point or a stroke: alone, or with Shift one more or one less. Points that are picked stay so, to be moved together.
fn pick(clicked: StrokeSelection, scene: &mut Scene) {
    let picked = &mut *scene.picked;
    let held = !clicked.points.is_empty() && clicked.points.is_subset(&picked.points);
    if scene.modifiers.shift {
        picked.strokes = &picked.strokes ^ &clicked.strokes;
        picked.points = &picked.points ^ &clicked.points;
    } else if !held {
        *picked = clicked;
    }
    if let Some(node) = &scene.node {
        let curves = curves_of(scene.state, node, &scene.picked.touched());
        scene.out.push(Event::Select(Select::Curves(curves)));
    }
}

/// A double tap on a line puts a point there: behind a point, at a part of the way to the next.
fn insert(id: u64, behind: usize, part: f32, scene: &mut Scene) {
    let stroke = scene.strokes.0.iter().find(|stroke| stroke.id == id);
    let inserted = stroke.and_then(|stroke| {
        let ways = cvs::ways(&stroke.samples);
        let (from, to) = (ways.get(behind)?, ways.get(behind + 1)?);
        cvs::inserted(stroke, from + (to - from) * part)
    });
    if let (Some(node), Some((stroke, new))) = (scene.node.clone(), inserted) {
        let input = target::input(&scene.state.document, &node, Fills::Strokes).to_owned();
        let edit = Edit::ReplaceStroke { node: node.clone(), input, stroke };
        step(scene.state, &node, "point inserted", vec![edit], scene.out);
        *scene.picked = StrokeSelection::of_point(id, new);
    }
}

/// Moves the picked points by one of them.
struct Move {
    from: Pos2,
    grabbed: Vec3,
    height: Vec3,
    strokes: Vec<(Stroke, Vec<f32>)>,
    by: Option<Pos2>,
}

impl Move {
    fn of(from: Pos2, id: u64, at: usize, scene: &Scene) -> Option<Self> {
        let grabbed = *scene.shapes.of(id)?.points.get(at)?;
        let root = scene.scalp.closest_root(grabbed)?;
        let falloff = scene.state.settings.pen.falloff.max(0.0);
        let held = |stroke: &Stroke| {
            let points = scene.picked.points_of(stroke.id);
            (!points.is_empty()).then(|| (stroke.clone(), cvs::falloff(stroke, &points, falloff)))
        };
        let strokes = scene.strokes.0.iter().filter_map(held).collect();
        Some(Self { from, grabbed, height: root.normal, strokes, by: None })
    }

    /// How far the grabbed point is to go.
    fn way(&self, scene: &Scene) -> Option<Vec3> {
        let (by, view) = (self.by?, &scene.view);
        match scene.state.settings.pen.along {
            // The way is from the scalp under the grabbed point, which may hang over it.
            Along::Scalp => {
                let root = scene.scalp.closest_root(self.grabbed);
                let from = root.map_or(self.grabbed, |root| root.point);
                Some(on_scalp(scene.scalp, view, by, self.grabbed)? - from)
            }
            Along::View => Some(view.on_plane(by, self.grabbed, view.axes()[2])? - self.grabbed),
            Along::Normal => Some(view.on_line(by, self.grabbed, self.height)? - self.grabbed),
        }
    }
}

impl Work for Move {
    fn go_on(&mut self, sample: &PenSample, _: &Scene) {
        if self.by.is_some() || self.from.distance(sample.pos) > CLICK {
            self.by = Some(sample.pos);
        }
    }
    fn wants(&mut self, _: &TouchStep, scene: &Scene) -> Wanted {
        let on_scalp = scene.state.settings.pen.along == Along::Scalp;
        let way = self.way(scene);
        let moved = self.strokes.iter().filter_map(|(stroke, weights)| {
            let stroke = edits::dragged(scene.scalp, stroke, weights, way?, on_scalp);
            Some((stroke.id, Some(DrawnItem::Stroke(stroke))))
        });
        moved.collect()
    }
}

/// Puts an outline around points: a box, or a lasso.
struct Outline {
    line: Vec<Pos2>,
    lasso: bool,
    /// Whether what was picked stays so.
    add: bool,
}

impl Work for Outline {
    fn go_on(&mut self, sample: &PenSample, _: &Scene) {
        self.line.push(sample.pos);
    }
    /// A click picks nothing.
    fn end(&mut self, _: &mut TouchStep, scene: &mut Scene) -> Outcome {
        if !self.add {
            *scene.picked = StrokeSelection::default();
        }
        scene.picked.points.extend(scene.shapes.inside(&self.outline()));
        Outcome::Nothing
    }
    fn paint(&self, painter: &Painter, _: &Scene) {
        overlay::outline(painter, self.outline());
    }
}

impl Outline {
    fn outline(&self) -> Vec<Pos2> {
        match (self.line.first(), self.line.last()) {
            (Some(first), Some(last)) if !self.lasso => {
                let r = Rect::from_two_pos(*first, *last);
                vec![r.left_top(), r.right_top(), r.right_bottom(), r.left_bottom()]
            }
            _ => self.line.clone(),
        }
    }
}

/// Removes the strokes that it passes.
struct Erase(BTreeSet<u64>);

impl Work for Erase {
    fn go_on(&mut self, sample: &PenSample, scene: &Scene) {
        let middle = scene.scalp.frame().origin;
        let at = on_scalp(scene.scalp, &scene.view, sample.pos, middle).unwrap_or(middle);
        let scale = scene.view.cm_per_point(scene.view.depth(at)).max(1e-6);
        let reach = (scene.state.settings.pen.brush() / scale).clamp(4.0, 400.0);
        self.0.extend(scene.shapes.strokes_near(sample.pos, reach));
    }
    fn wants(&mut self, _: &TouchStep, _: &Scene) -> Wanted {
        self.0.iter().map(|id| (*id, None)).collect()
    }
}

/// Combs or smooths strokes with a brush.
struct Brush {
    smooth: bool,
    /// Where it was on the head last, cm.
    last: Vec3,
    /// The strokes that it may reach.
    paths: BTreeMap<u64, Path>,
}

/// A stroke under a brush, and where its points are, cm. They are kept as exact as they are combed: passes that move a point less
/// than documents hold would be lost one by one.
struct Path {
    stroke: Stroke,
    points: Vec<Vec3>,
    reached: bool,
}

fn brush(tool: PenTool, sample: &PenSample, scene: &Scene) -> Option<Touch> {
    let smooth = tool == PenTool::Smooth || scene.modifiers.shift;
    let last = on_scalp(scene.scalp, &scene.view, sample.pos, scene.scalp.frame().origin)?;
    let words = if smooth { "strokes smoothed" } else { "strokes combed" };
    touch(words, Brush { smooth, last, paths: BTreeMap::new() }, scene)
}

impl Work for Brush {
    fn go_on(&mut self, sample: &PenSample, scene: &Scene) {
        let Some(at) = on_scalp(scene.scalp, &scene.view, sample.pos, self.last) else { return };
        let from = std::mem::replace(&mut self.last, at);
        if sample.phase == Phase::Up {
            return;
        }
        let settings = &scene.state.settings.pen;
        let pass = Pass {
            at: from,
            by: at - from,
            radius: settings.brush(),
            strength: settings.strength() * sample.pressure,
            on_scalp: scene.lie() == Lie::Scalp,
        };
        // Shapes are the strokes' own, in their order.
        let strokes = scene.shapes.all().iter().zip(&scene.strokes.0);
        for (_, stroke) in strokes.filter(|(shape, _)| !shape.locked) {
            let path = self.paths.entry(stroke.id).or_insert_with(|| Path {
                stroke: stroke.clone(),
                points: edits::path(scene.scalp, stroke),
                reached: false,
            });
            path.reached |= match self.smooth {
                true => pass.smooth(scene.scalp, &mut path.points),
                false => pass.comb(scene.scalp, &mut path.points),
            };
        }
    }
    fn wants(&mut self, _: &TouchStep, scene: &Scene) -> Wanted {
        let reached = self.paths.iter().filter(|(_, path)| path.reached);
        let brushed = |path: &Path| edits::put(scene.scalp, &path.stroke, &path.points);
        reached.map(|(id, path)| (*id, Some(DrawnItem::Stroke(brushed(path))))).collect()
    }
}
