//! One touch of the pen: what it has begun, and what of it the document knows.
//!
//! A gesture says what strokes should be now ([`ActiveTouch::wanted`]); [`ActiveTouch::flush`] turns the difference to what it
//! has told the document into edits. So live and final edits are made in one way, and nothing is told twice.

use super::drawing::{GrowingStroke, Lie, on_scalp};
use super::edits::{self, Pass};
use super::sample::{PenSample, Phase, Tool};
use super::shapes::{Shapes, StrokePlace};
use super::target::{self, Fresh};
use super::{Pen, PenTool, Scene, StrokeSelection};
use crate::core::event::Event;
use crate::core::pen::Along;
use crate::core::shown::displayed;
use crate::core::state::Select;
use coif_graphs::document::edit::Edit;
use coif_graphs::document::graph::upstream;
use coif_graphs::document::strokes::{cvs, whole};
use coif_graphs::document::{NodeId, Setting};
use coif_nodes::data::strokes::Stroke;
use coif_nodes::define::Value;
use egui::{Pos2, Rect};
use glam::Vec3;
use std::collections::{BTreeMap, BTreeSet};

/// A press that moved less than this is a click, points.
const CLICK: f32 = 4.0;
/// How far from a stroke the line that re-draws a part of it may begin and end, head units.
const REDRAW: f32 = 2.0;

/// The input of a head that says where hair grows, and its word for the hairline that is drawn.
const REGION: &str = "region";
const HAIRLINE: &str = "hairline";

/// What a touch does.
pub(super) enum Work {
    /// Draws a new stroke.
    Draw(GrowingStroke),
    /// Draws a part of one anew.
    Redraw { line: GrowingStroke, of: Stroke },
    /// Moves picked points.
    Move {
        from: Pos2,
        grabbed: Vec3,
        height: Vec3,
        strokes: Vec<(Stroke, Vec<f32>)>,
        by: Option<Pos2>,
    },
    /// Puts an outline around points.
    Outline { line: Vec<Pos2>, lasso: bool, add: bool },
    /// Removes what it passes.
    Erase,
    /// Passes a brush over strokes. Their paths are kept as exact as they are combed: passes that move a point less than
    /// documents hold would be lost one by one.
    Brush { smooth: bool, last: Vec3, paths: BTreeMap<u64, (Stroke, Vec<Vec3>)> },
}

/// A touch under way.
pub(super) struct ActiveTouch {
    node: NodeId,
    input: &'static str,
    words: String,
    /// What makes the node, where there was none.
    make: Vec<Edit>,
    begun: bool,
    /// Strokes as they should be; none for one that goes.
    wanted: BTreeMap<u64, Option<Stroke>>,
    /// What of it the document was told.
    told: BTreeMap<u64, Option<Stroke>>,
    pub(super) work: Work,
}

impl Pen {
    /// What a touch begins; none where it picks, and why where there is nothing that it could do.
    pub(super) fn begin(
        &mut self,
        input: &super::devices::Input,
        scene: &mut Scene,
    ) -> Result<Option<ActiveTouch>, &'static str> {
        let eraser = input.sample.tool == Tool::Eraser;
        let tool = if eraser { PenTool::Erase } else { self.tool };
        if let Some(why) = no_strokes(tool).filter(|_| scene.strokes.0.is_empty()) {
            return Err(why);
        }
        match (self.begun(tool, input, scene), tool) {
            (None, PenTool::Draw) => Err("A stroke begins on the head: draw from the skin"),
            (None, PenTool::Redraw) => Err("Begin beside the stroke to draw anew"),
            (begun, _) => Ok(begun),
        }
    }

    fn begun(
        &mut self,
        tool: PenTool,
        input: &super::devices::Input,
        scene: &mut Scene,
    ) -> Option<ActiveTouch> {
        let sample = &input.sample;
        let (node, document) = (scene.node.cloned(), &scene.state.document);
        let gesture = |words: &str, work: Work| {
            let node = node?;
            let kind = &document.node(node.as_str())?.kind;
            let input = target::strokes_input(kind)?;
            let words = format!("{}: {words}", document.name_of(&node));
            let (make, wanted, told) = Default::default();
            Some(ActiveTouch { node, input, words, make, begun: false, wanted, told, work })
        };
        match tool {
            PenTool::Select | PenTool::Hair(_) | PenTool::Mask(_) => None,
            PenTool::Draw => self.begin_stroke(sample, scene),
            PenTool::Points => {
                let place = self.shapes.pick(sample.pos, scene.reach);
                match place {
                    Some(StrokePlace::Point(id, i)) => {
                        self.pick_point(id, i, scene);
                        if !self.picked.points.contains(&(id, i)) {
                            return None;
                        }
                        gesture("points moved", self.take_hold(sample, id, i, scene)?)
                    }
                    Some(StrokePlace::Line(id, ..)) if input.double_tap => {
                        self.insert(id, sample.pos, scene);
                        None
                    }
                    Some(StrokePlace::Line(id, ..)) => {
                        self.pick_stroke(id, scene);
                        None
                    }
                    None => {
                        let lasso = scene.modifiers.command;
                        let add = scene.modifiers.shift;
                        gesture("", Work::Outline { line: vec![sample.pos], lasso, add })
                    }
                }
            }
            PenTool::Redraw => {
                let reach = scene.reach * 3.0;
                let picked = self.picked.touched();
                let near = self.shapes.pick(sample.pos, reach).map(StrokePlace::stroke);
                let id = near.or_else(|| picked.first().copied())?;
                let of = scene.strokes.0.iter().find(|stroke| stroke.id == id)?.clone();
                let line = GrowingStroke::begin(
                    scene.scalp,
                    scene.view,
                    sample,
                    scene.lie(),
                    false,
                    scene.strokes,
                )?;
                self.picked =
                    StrokeSelection { strokes: [id].into(), ..StrokeSelection::default() };
                gesture("a stroke re-drawn", Work::Redraw { line, of })
            }
            PenTool::Erase => {
                let mut erasing = gesture("strokes erased", Work::Erase)?;
                erasing.go_on(sample, scene, &self.shapes, &mut self.picked);
                Some(erasing)
            }
            PenTool::Comb | PenTool::Smooth => {
                let smooth = tool == PenTool::Smooth || scene.modifiers.shift;
                let last =
                    on_scalp(scene.scalp, scene.view, sample.pos, scene.scalp.frame().origin)?;
                let words = if smooth { "strokes smoothed" } else { "strokes combed" };
                gesture(words, Work::Brush { smooth, last, paths: BTreeMap::new() })
            }
        }
    }

    fn begin_stroke(&mut self, sample: &PenSample, scene: &mut Scene) -> Option<ActiveTouch> {
        let document = &scene.state.document;
        let (node, make) = match scene.node {
            Some(node) => (node.clone(), vec![]),
            None => {
                let mirror = scene.state.settings.pen.symmetry;
                target::make(document, Fresh { free: self.free, mirror })?
            }
        };
        let fresh = !make.is_empty();
        let lie = if fresh && self.free { Lie::Space } else { scene.lie() };
        let both = if fresh { scene.state.settings.pen.symmetry } else { scene.is_mirrored() };
        let line = GrowingStroke::begin(scene.scalp, scene.view, sample, lie, both, scene.strokes)?;
        let kind = document.node(node.as_str()).map_or(target::KIND, |node| &node.kind);
        let input = target::strokes_input(kind)?;
        let words = match fresh {
            true => "stroke drawn".to_owned(),
            false => format!("{}: stroke drawn", document.name_of(&node)),
        };
        let (wanted, told) = Default::default();
        let work = Work::Draw(line);
        Some(ActiveTouch { node, input, words, make, begun: false, wanted, told, work })
    }

    /// A click on a point: alone, or with Shift one more or one less.
    fn pick_point(&mut self, id: u64, at: usize, scene: &mut Scene) {
        let point = (id, at);
        if scene.modifiers.shift {
            if !self.picked.points.remove(&point) {
                self.picked.points.insert(point);
            }
        } else if !self.picked.points.contains(&point) {
            self.picked = StrokeSelection { points: [point].into(), ..StrokeSelection::default() };
        }
        self.show_picked(scene);
    }

    /// A click on a stroke.
    pub(super) fn pick_stroke(&mut self, id: u64, scene: &mut Scene) {
        if scene.modifiers.shift {
            if !self.picked.strokes.remove(&id) {
                self.picked.strokes.insert(id);
            }
        } else {
            self.picked = StrokeSelection { strokes: [id].into(), ..StrokeSelection::default() };
        }
        self.show_picked(scene);
    }

    /// What other rooms see of what is picked.
    fn show_picked(&self, scene: &mut Scene) {
        if let Some(node) = scene.node {
            let curves = super::shapes::curves_of(scene.state, node, &self.picked.touched());
            scene.out.push(Event::Select(Select::Curves(curves)));
        }
    }

    /// A double tap on a line puts a point there.
    fn insert(&mut self, id: u64, at: Pos2, scene: &mut Scene) {
        let Some(node) = scene.node else { return };
        let Some(stroke) = scene.strokes.0.iter().find(|stroke| stroke.id == id) else { return };
        let Some(StrokePlace::Line(_, i, t)) = self.shapes.pick(at, scene.reach) else { return };
        let ways = cvs::ways(&stroke.samples);
        let (Some(from), Some(to)) = (ways.get(i), ways.get(i + 1)) else { return };
        let kind = scene.state.document.node(node.as_str()).map_or("", |node| &node.kind);
        if let Some((stroke, new)) = cvs::inserted(stroke, from + (to - from) * t)
            && let Some(input) = target::strokes_input(kind)
        {
            let words = format!("{}: point inserted", scene.state.document.name_of(node));
            let edit = Edit::ReplaceStroke { node: node.clone(), input: input.to_owned(), stroke };
            scene.out.extend([Event::Begin(words), Event::Edit(edit), Event::End]);
            self.picked =
                StrokeSelection { points: [(id, new)].into(), ..StrokeSelection::default() };
        }
    }

    /// Takes hold of the picked points by one of them.
    fn take_hold(&self, sample: &PenSample, id: u64, at: usize, scene: &Scene) -> Option<Work> {
        let grabbed = *self.shapes.of(id)?.points.get(at)?;
        let root = scene.scalp.closest_root(grabbed)?;
        let falloff = scene.state.settings.pen.falloff.max(0.0);
        let mut strokes = vec![];
        for stroke in &scene.strokes.0 {
            let points = self.picked.points.iter().filter(|(id, _)| *id == stroke.id);
            let points: BTreeSet<usize> = points.map(|(_, at)| *at).collect();
            if !points.is_empty() {
                strokes.push((stroke.clone(), cvs::falloff(stroke, &points, falloff)));
            }
        }
        Some(Work::Move { from: sample.pos, grabbed, height: root.normal, strokes, by: None })
    }
}

impl Scene<'_> {
    /// Where strokes of the node lie.
    pub(super) fn lie(&self) -> Lie {
        let free = self.node.and_then(|node| target::choice(&self.state.document, node, "project"));
        if free.as_deref() == Some("free") { Lie::Space } else { Lie::Scalp }
    }
    /// Whether the node draws strokes on both sides of the head.
    pub(super) fn is_mirrored(&self) -> bool {
        let mirror =
            self.node.and_then(|node| target::choice(&self.state.document, node, "mirror"));
        mirror.as_deref() == Some("both")
    }
    /// The brush's radius on the screen at a point of the world, points.
    pub(super) fn brush_on_screen(&self, at: Vec3) -> f32 {
        self.state.settings.pen.brush() / self.view.cm_per_point(self.view.depth(at)).max(1e-6)
    }
}

impl ActiveTouch {
    /// The next sample of the touch.
    pub(super) fn go_on(
        &mut self,
        sample: &PenSample,
        scene: &mut Scene,
        shapes: &Shapes,
        picked: &mut StrokeSelection,
    ) {
        match &mut self.work {
            Work::Draw(line) | Work::Redraw { line, .. } => line.add(scene.view, sample),
            Work::Move { from, by, .. } => {
                if by.is_some() || from.distance(sample.pos) > CLICK {
                    *by = Some(sample.pos);
                }
            }
            Work::Outline { line, .. } => line.push(sample.pos),
            Work::Erase => {
                let middle = scene.scalp.frame().origin;
                let at = on_scalp(scene.scalp, scene.view, sample.pos, middle).unwrap_or(middle);
                let reach = scene.brush_on_screen(at).clamp(4.0, 400.0);
                for id in shapes.strokes_near(sample.pos, reach) {
                    self.wanted.insert(id, None);
                    picked.strokes.remove(&id);
                }
            }
            Work::Brush { smooth, last, paths } => {
                let (smooth, from) = (*smooth, *last);
                let Some(at) = on_scalp(scene.scalp, scene.view, sample.pos, from) else { return };
                *last = at;
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
                for shape in shapes.all().iter().filter(|shape| !shape.locked) {
                    let find = |stroke: &&Stroke| stroke.id == shape.id;
                    if !paths.contains_key(&shape.id)
                        && let Some(stroke) = scene.strokes.0.iter().find(find)
                    {
                        let path = edits::path(scene.scalp, stroke);
                        paths.insert(shape.id, (stroke.clone(), path));
                    }
                    let Some((stroke, path)) = paths.get_mut(&shape.id) else { continue };
                    let reached = match smooth {
                        true => pass.smooth(scene.scalp, path),
                        false => pass.comb(scene.scalp, path),
                    };
                    if reached {
                        let stroke = edits::put(scene.scalp, stroke, path);
                        self.wanted.insert(shape.id, Some(stroke));
                    }
                }
            }
        }
    }

    /// Works out what strokes should be now.
    fn want(&mut self, scene: &Scene) {
        match &self.work {
            Work::Draw(line) => {
                if let Some(stroke) = line.stroke() {
                    self.wanted.insert(line.id(), Some(stroke));
                }
            }
            Work::Redraw { line, of } => {
                if let Some(stroke) = whole::redrawn(of, line.samples(), REDRAW) {
                    self.wanted.insert(of.id, Some(stroke));
                }
            }
            Work::Move { grabbed, height, strokes, by: Some(by), .. } => {
                let along = scene.state.settings.pen.along;
                let view = scene.view;
                let to = match along {
                    Along::Scalp => on_scalp(scene.scalp, view, *by, *grabbed),
                    Along::View => view.on_plane(*by, *grabbed, view.axes()[2]),
                    Along::Normal => view.on_line(*by, *grabbed, *height),
                };
                let Some(to) = to else { return };
                let on_scalp = along == Along::Scalp;
                // On the scalp the way is from the scalp under the grabbed point, which may hang over it.
                let from = match scene.scalp.closest_root(*grabbed).filter(|_| on_scalp) {
                    Some(root) => root.point,
                    None => *grabbed,
                };
                for (stroke, weights) in strokes {
                    let by = to - from;
                    let stroke = edits::dragged(scene.scalp, stroke, weights, by, on_scalp);
                    self.wanted.insert(stroke.id, Some(stroke));
                }
            }
            _ => {}
        }
    }

    /// Tells the document what has changed since it was told last.
    pub(super) fn flush(&mut self, scene: &mut Scene) {
        self.want(scene);
        let mut edits = vec![];
        for (id, wanted) in &self.wanted {
            let told = self.told.get(id);
            if told == Some(wanted) {
                continue;
            }
            let there = match told {
                Some(told) => told.is_some(),
                None => scene.strokes.0.iter().any(|stroke| stroke.id == *id),
            };
            let (node, input) = (self.node.clone(), self.input.to_owned());
            edits.extend(match (wanted.clone(), there) {
                (Some(stroke), true) => Some(Edit::ReplaceStroke { node, input, stroke }),
                (Some(stroke), false) => {
                    Some(Edit::AddStroke { node, input, at: usize::MAX, stroke })
                }
                (None, true) => Some(Edit::RemoveStroke { node, input, id: *id }),
                (None, false) => None,
            });
            self.told.insert(*id, wanted.clone());
        }
        if edits.is_empty() {
            return;
        }
        if !self.begun {
            self.begun = true;
            scene.out.push(Event::Begin(self.words.clone()));
            if !self.make.is_empty() {
                scene.out.extend(std::mem::take(&mut self.make).into_iter().map(Event::Edit));
                scene.out.push(Event::Select(Select::Nodes(vec![self.node.clone()])));
            }
        }
        let one = if edits.len() == 1 { edits.pop() } else { None };
        scene.out.push(Event::Edit(one.unwrap_or(Edit::Several(edits))));
    }

    /// The touch is over.
    pub(super) fn end(&mut self, scene: &mut Scene, shapes: &Shapes, picked: &mut StrokeSelection) {
        if let Work::Outline { line, lasso, add } = &self.work {
            take_outline(line, *lasso, *add, shapes, picked);
            return;
        }
        self.flush(scene);
        if self.begun {
            scene.out.extend(self.grows_inside(scene).map(Event::Edit));
            scene.out.push(Event::End);
        }
    }

    /// Whether what it has drawn becomes no hair that is seen: nothing takes the strokes, and other hair is displayed.
    pub(super) fn makes_no_hair(&self, scene: &Scene) -> bool {
        let document = &scene.state.document;
        let draws = matches!(self.work, Work::Draw(_))
            && document.node(self.node.as_str()).is_none_or(|node| node.kind != target::HEAD);
        let shown = displayed(document);
        let way = upstream(document, shown.iter().map(|socket| &socket.node));
        let hair = shown.iter().any(|socket| {
            document.node(socket.node.as_str()).is_some_and(|node| node.kind != target::HEAD)
        });
        let seen = way.contains(&self.node) || shown.iter().any(|s| s.node == self.node);
        draws && hair && !seen
    }

    /// A head takes its region from the hairline that is drawn on it.
    fn grows_inside(&self, scene: &Scene) -> Option<Edit> {
        let (document, node) = (&scene.state.document, &self.node);
        let on_head = document.node(node.as_str()).is_some_and(|held| held.kind == target::HEAD);
        let drawn = on_head && matches!(self.work, Work::Draw(_));
        let other = target::choice(document, node, REGION).is_none_or(|word| word != HAIRLINE);
        let setting = Setting::Known(Value::Text(HAIRLINE.into()));
        let input = REGION.to_owned();
        (drawn && other).then(|| Edit::SetInput { node: node.clone(), input, setting })
    }

    /// Whether it has drawn a stroke that nobody would see.
    pub(super) fn too_short(&self, scene: &Scene) -> bool {
        let Work::Draw(line) = &self.work else { return false };
        let places = || line.world().iter().filter_map(|p| scene.view.screen(*p));
        let first = places().next();
        first.is_some_and(|first| places().all(|at| at.distance(first) < CLICK))
    }

    /// The touch never was.
    pub(super) fn abort(self, scene: &mut Scene) {
        if self.begun {
            scene.out.push(Event::Abort);
        }
    }

    /// Whether somebody has ended or undone what it has begun.
    pub(super) fn is_orphaned(&self, scene: &Scene) -> bool {
        self.begun
            && (!scene.state.gesture
                || !scene.state.document.nodes.contains_key(self.node.as_str()))
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

/// Picks the points within a box from the first to the last place, or within the line. A click picks nothing.
fn take_outline(
    line: &[Pos2],
    lasso: bool,
    add: bool,
    shapes: &Shapes,
    picked: &mut StrokeSelection,
) {
    let (Some(first), Some(last)) = (line.first(), line.last()) else { return };
    let outline = match lasso {
        true => line.to_vec(),
        false => {
            let r = Rect::from_two_pos(*first, *last);
            vec![r.left_top(), r.right_top(), r.right_bottom(), r.left_bottom()]
        }
    };
    if !add {
        *picked = StrokeSelection::default();
    }
    picked.points.extend(shapes.inside(&outline));
}
