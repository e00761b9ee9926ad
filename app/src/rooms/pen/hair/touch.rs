//! A touch on hair: a gesture of the node while it is drawn, and what became of it once the hair is shown.
//!
//! Without a tool of the shelf in hand the stroke itself says which gesture it is (`coif_nodes::sketch::classify`), and may change its
//! mind until the pen is lifted. Then the gesture learns which curves it changed ([`resolved`]), by what the node gave before and
//! after, and the undo step gets its name; with symmetry it is drawn once more on the other side of the head.

use super::super::Scene;
use super::super::sample::{PenSample as Report, Phase, Tool as End};
use super::super::target::{gestures, number};
use super::super::touch::{DrawnItem, Outcome, TouchStep, Wanted, Work};
use super::{free, is_mouse, look, target};
use crate::core::event::Event;
use crate::core::notes::Note;
use crate::core::state::State;
use crate::words::counted;
use coif_graphs::document::NodeId;
use coif_graphs::document::gestures::finish;
use coif_graphs::values::grid::gestures_on_grid;
use coif_nodes::data::curves::Curves;
use coif_nodes::data::gestures::{Gesture, GestureView, Gestures, Layer, PenSample, Tool};
use coif_nodes::maths::hash::Key;
use coif_nodes::sketch::around::ViewedCurves;
use coif_nodes::sketch::classify::{Guess, classify, is_tap};
use coif_nodes::sketch::grow::rooted;
use coif_nodes::sketch::hair_sketch::resolved;
use coif_nodes::sketch::level::{Rule, level};
use egui::{Painter, Pos2};
use glam::Vec2;
use std::collections::BTreeSet;

/// A touch that stays this near to where it began is no stroke for a tool of the shelf, points.
pub(super) const STILL: f32 = 3.0;
/// An implant nearer to the middle of the head than this (head units) has no twin on the other side.
const MIDDLE: f32 = 0.5;
/// Hair that an implant grows is rooted this near to it, head units.
const BARE: f32 = 1.0;
/// The most samples of one gesture: four minutes at 1,000 a second. What comes after is not drawn.
const MOST: usize = 240_000;

/// What is in hand.
pub(super) struct InHand {
    /// The tool of the shelf; none: the stroke says.
    pub(super) tool: Option<Tool>,
    pub(super) end: End,
    /// How deep it reaches, whatever the pressure is.
    pub(super) fixed: Option<Layer>,
    /// How the pressure tells it else.
    pub(super) rule: Rule,
}

/// What is drawn, in the picture that it is drawn on.
pub(super) struct Line {
    view: GestureView,
    middle: Pos2,
    began: f64,
    pub(super) samples: Vec<PenSample>,
}

impl Line {
    pub(super) fn begin(report: &Report, view: GestureView, middle: Pos2) -> Self {
        let mut line = Self { view, middle, began: report.time, samples: vec![] };
        line.add(report, report.pressure);
        line
    }

    fn add(&mut self, report: &Report, pressure: f32) {
        let off = report.pos - self.middle;
        let at = Vec2::new(off.x, off.y);
        let told = |last: &PenSample| last.at == at && last.pressure == pressure;
        if !self.samples.last().is_some_and(told) && self.samples.len() < MOST {
            let time = (report.time - self.began).max(0.0) as f32;
            let tilt = Vec2::new(report.tilt.x, report.tilt.y);
            self.samples.push(PenSample { at, pressure, time, tilt });
        }
    }

    /// Whether the pen has stayed where it touched.
    fn is_still(&self) -> bool {
        self.samples.iter().all(|s| s.at.distance(self.samples[0].at) <= STILL)
    }

    fn mean_pressure(&self) -> f32 {
        let sum: f32 = self.samples.iter().map(|sample| sample.pressure).sum();
        sum / self.samples.len().max(1) as f32
    }

    /// Where it is on the picture, for its ink.
    pub(super) fn places(&self) -> impl Iterator<Item = Pos2> {
        self.samples.iter().map(|s| self.middle + egui::Vec2::new(s.at.x, s.at.y))
    }
}

/// A gesture while it is drawn, or once more on the other side.
pub(super) struct HairTouch {
    hand: InHand,
    pub(super) line: Line,
    /// The tap before it.
    tap: Option<Vec<PenSample>>,
    pub(super) guess: Guess,
    /// The node's curves before it, and the key of what came in to it.
    pub(super) before: Curves,
    /// The curves that it may act on; none: all.
    free: Option<BTreeSet<u64>>,
    came_in: Option<Key>,
    /// Id of the gesture, once it has one.
    id: u64,
    /// The gesture as the document has it; none while it is none.
    pub(super) told: Option<Gesture>,
    pub(super) lifted: bool,
    /// How many curves were changed on the first side, where it is the twin on the other.
    first: Option<usize>,
    /// How many gave way to what was planted.
    replaced: usize,
}

impl HairTouch {
    pub(super) fn new(
        hand: InHand,
        line: Line,
        tap: Option<Vec<PenSample>>,
        (before, free): (Curves, Option<BTreeSet<u64>>),
        came_in: Option<Key>,
    ) -> Self {
        let (guess, id, told) = (Guess::Unsure(""), 0, None);
        let (lifted, first, replaced) = (false, None, 0);
        Self { hand, line, tap, guess, before, free, came_in, id, told, lifted, first, replaced }
    }

    /// How deep it reaches.
    pub(super) fn layer(&self) -> Layer {
        self.hand.fixed.unwrap_or_else(|| level(&self.line.samples, self.hand.rule))
    }

    /// Which gesture it is, as far as it is drawn.
    fn guess(&self, node: &NodeId, scene: &Scene) -> Guess {
        let samples = &self.line.samples;
        match self.hand.tool {
            Some(tool) if tool != Tool::Pin && self.line.is_still() => {
                Guess::Unsure("The stroke is too short: draw it longer")
            }
            Some(tool) => Guess::Is(tool),
            None => {
                let rho = rho(node, scene);
                let ground = ViewedCurves::new(&self.line.view, scene.scalp, &self.before, rho);
                let (first, last) = (samples[0].at, samples[samples.len() - 1].at);
                let eraser = self.hand.end == End::Eraser;
                let around = ground.around(first, last, eraser, self.layer());
                classify(samples, self.tap.as_deref(), &around, rho)
            }
        }
    }

    /// The gesture as far as it is drawn; none while it is none.
    fn gesture(&mut self, node: &NodeId, scene: &Scene) -> Option<Gesture> {
        self.guess = self.guess(node, scene);
        let Guess::Is(tool) = self.guess else { return None };
        let settings = &scene.state.settings.pen;
        let brush = matches!(tool, Tool::Smooth | Tool::Puff | Tool::Grab | Tool::Straighten);
        // A tap pins one CV, a stroke all under the brush.
        let pins = self.hand.tool == Some(Tool::Pin) && !self.line.is_still();
        let sized = brush || pins || matches!(tool, Tool::Comb | Tool::Scatter);
        // At half pressure a brush has the strength that is set.
        let mouse = is_mouse(self.hand.end);
        let press = if mouse { 1.0 } else { 2.0 * self.line.mean_pressure() };
        let gesture = Gesture {
            id: self.id,
            tool,
            layer: match tool {
                Tool::Implant => Layer::Scalp,
                Tool::Pin if pins => Layer::Through,
                _ => self.layer(),
            },
            view: self.line.view,
            samples: self.line.samples.clone(),
            curves: vec![],
            root: None,
            path: vec![],
            colour: settings
                .hair_colour()
                .filter(|_| matches!(tool, Tool::Implant | Tool::Silhouette)),
            size: match tool {
                _ if tool.is_soft() && self.hand.tool == Some(tool) => {
                    look::soft(scene).clamp(0.0, 1000.0)
                }
                _ if sized => look::brush(scene).clamp(2.0, 1000.0),
                _ => 0.0,
            },
            strength: match tool {
                // From half strength on, hair goes as far as the pen.
                Tool::Comb => (2.0 * settings.strength()).min(1.0),
                Tool::Grab => 1.0,
                _ if brush => 2.0 * settings.strength() * press,
                _ => 1.0,
            },
        };
        let mut gesture = finish(gesture, &gestures(&scene.state.document, node))?;
        if !self.names_its_curves(&mut gesture, &self.before, node, scene) {
            self.guess = Guess::Unsure(free::FROZEN);
            return None;
        }
        // It keeps the first id that it got.
        self.id = if self.id == 0 { gesture.id } else { self.id };
        gesture.id = self.id;
        Some(gesture)
    }

    /// Where hair is frozen, names the curves that a gesture acts on. False where there are none.
    fn names_its_curves(
        &self,
        gesture: &mut Gesture,
        hair: &Curves,
        node: &NodeId,
        scene: &Scene,
    ) -> bool {
        let Some(free) = self.free.as_ref() else { return true };
        let rho = rho(node, scene);
        match gesture.tool {
            Tool::Scatter => return true,
            Tool::Implant | Tool::Silhouette => {
                // With its root told, it takes the place of the curves that it names, and of no others.
                gesture.root = rooted(gesture, scene.scalp, rho);
                gesture.curves = free::rooted_about(gesture, hair, free, scene.scalp);
                return true;
            }
            _ => {}
        }
        gesture.curves = free::passed(gesture, hair, free, (scene.scalp, rho));
        !gesture.curves.is_empty()
    }

    /// The pen has left the picture: a touch that means nothing ends at once, and a tap is remembered.
    fn lift(&mut self, step: &mut TouchStep, scene: &mut Scene) -> Outcome {
        self.lifted = true;
        step.tell(self.wants(step, scene), scene);
        if let Some(told) = &self.told {
            told.tool.word().clone_into(&mut step.words);
            return Outcome::Waits;
        }
        let free = self.hand.tool.is_none() && self.hand.end != End::Eraser;
        let tap = free && is_tap(&self.line.samples, rho(&step.node, scene));
        if let (Guess::Unsure(why), false) = (self.guess, tap) {
            scene.say(step.at, why);
        }
        scene.hair.tap = tap.then(|| (self.line.began, std::mem::take(&mut self.line.samples)));
        Outcome::Nothing
    }

    /// What was lifted learns what it did, and its step is done; with symmetry once more on the other side.
    fn settle(&mut self, step: &mut TouchStep, scene: &mut Scene) -> Outcome {
        let settings = &scene.state.settings.pen;
        let after = self.after(&step.node, scene.state);
        let (Some(told), Some(after)) = (self.told.take(), after) else { return Outcome::Done };
        match (self.did(&told, after, &step.node, scene), self.first) {
            (Err(why), None) => {
                scene.say(step.at, why);
                Outcome::Nothing
            }
            (Err(_), Some(first)) => {
                step.tell(vec![(told.id, None)], scene);
                step.words = done(told.tool, first, settings.strands);
                self.say_what_else(told.tool, &step.words, scene);
                Outcome::Done
            }
            (Ok((known, changed)), first) => {
                if matches!(told.tool, Tool::Implant | Tool::Silhouette) {
                    self.replaced += known.curves.len();
                }
                let middle = known.root.is_some_and(|root| root.x.abs() < MIDDLE);
                let others = gestures(&scene.state.document, &step.node);
                let both = settings.symmetry && first.is_none() && !middle;
                let mut twin = both.then(|| finish(told.mirrored(), &others)).flatten();
                twin.take_if(|twin| !self.names_its_curves(twin, after, &step.node, scene));
                let item = |gesture| Some(DrawnItem::Gesture(gesture));
                step.tell(vec![(told.id, item(known))], scene);
                if let Some(twin) = twin {
                    step.tell(vec![(twin.id, item(twin.clone()))], scene);
                    (self.before, self.told) = (after.clone(), Some(twin));
                    self.first = Some(changed);
                    return Outcome::Waits;
                }
                let all = first.unwrap_or_default() + changed;
                step.words = done(told.tool, all, settings.strands);
                self.say_what_else(told.tool, &step.words, scene);
                Outcome::Done
            }
        }
    }

    /// Says in the status line what may not have been meant: a mouse that combs where it began on hair, and what gave way to an implant.
    fn say_what_else(&self, tool: Tool, words: &str, scene: &mut Scene) {
        let guessed = self.hand.tool.is_none() && is_mouse(self.hand.end);
        let more = match (tool, self.replaced) {
            (Tool::Comb, _) if guessed => "to implant there, choose Implant".to_owned(),
            (_, 0) => return,
            (_, replaced) => format!(
                "it replaced {} rooted there: to keep both, undo and begin farther away",
                counted(replaced, "cluster")
            ),
        };
        scene.out.push(Event::Say(Note::done(format!("{words}; {more}"))));
    }

    /// The node's curves of now, where what came in to it is as it was.
    fn after<'a>(&self, node: &NodeId, state: &'a State) -> Option<&'a Curves> {
        let shown = state.shown.as_ref().filter(|shown| shown.revision == state.revision)?;
        let came_in = target::came_in(&state.document, node);
        let came_in = came_in.and_then(|socket| shown.curves_of(&socket)).map(Curves::key);
        shown.curves_of(&target::output(node)).filter(|_| came_in == self.came_in)
    }

    /// The gesture with what it did, and how many curves it changed; why where it did nothing.
    fn did(
        &self,
        told: &Gesture,
        after: &Curves,
        node: &NodeId,
        scene: &Scene,
    ) -> Result<(Gesture, usize), String> {
        let known = resolved(told, &self.before, after, scene.scalp);
        let plants = matches!(told.tool, Tool::Implant | Tool::Silhouette | Tool::Scatter);
        let planted = plants && after.key() != self.before.key();
        let more = after.curve_count().saturating_sub(self.before.curve_count());
        let changed = match plants {
            // One that takes the place of another is none more.
            true => more.max(usize::from(planted)),
            false => known.curves.len(),
        };
        let bare = planted && self.came_in.is_some() && bare_root(&known, scene);
        let known = gestures_on_grid(Gestures(vec![known]).into());
        match known.0.first() {
            _ if bare => Err(NO_HAIR_HERE.to_owned()),
            Some(known) if changed > 0 => Ok((known.clone(), changed)),
            _ => Err(nothing_done(scene.state, node, told.id)),
        }
    }
}

impl Work for HairTouch {
    fn go_on(&mut self, report: &Report, _: &Scene) {
        // A pen that is lifted presses no more: what it has drawn is told by how it was pressed before.
        let last = self.line.samples.last().filter(|_| report.phase == Phase::Up);
        self.line.add(report, last.map_or(report.pressure, |last| last.pressure));
    }
    fn wants(&mut self, step: &TouchStep, scene: &Scene) -> Wanted {
        self.told = self.gesture(&step.node, scene);
        let told = (self.id, self.told.clone().map(DrawnItem::Gesture));
        if self.id == 0 { vec![] } else { vec![told] }
    }
    fn end(&mut self, step: &mut TouchStep, scene: &mut Scene) -> Outcome {
        match self.lifted {
            true => self.settle(step, scene),
            false => self.lift(step, scene),
        }
    }
    fn paint(&self, painter: &Painter, scene: &Scene) {
        look::touch(self, painter, scene);
    }
    fn reaches_skin(&self) -> bool {
        self.layer() == Layer::Scalp
    }
}

fn rho(node: &NodeId, scene: &Scene) -> f32 {
    number(&scene.state.document, target::KIND, Some(node), "rho")
}

/// What is said of an implant where the graph grows no hair.
const NO_HAIR_HERE: &str =
    "No hair grows here: begin inside the head's region, or choose another region";

/// Whether an implant stands outside the head's region and no displayed hair is rooted within a cluster's radius of it.
fn bare_root(gesture: &Gesture, scene: &Scene) -> bool {
    let scalp = scene.scalp;
    let root = gesture.root.and_then(|root| scalp.closest_root(scalp.place(root)));
    let (Some(root), Some(shown)) = (root, scene.state.shown.as_ref()) else { return false };
    let reach = BARE * scalp.frame().unit();
    let near = |p: &glam::Vec3| p.distance(root.point) <= reach;
    let hair = || shown.curves.each().any(|(tuft, i)| tuft.curve(i).first().is_some_and(near));
    scalp.grows(root.triangle, root.bary) <= 0.0 && !hair()
}

/// What a step is called.
fn done(tool: Tool, curves: usize, strands: bool) -> String {
    let verb = match tool {
        Tool::Implant => "implanted",
        Tool::Lengthen => "lengthened",
        Tool::Cut => "cut",
        Tool::Density => "changed the density of",
        Tool::Twist => "twisted",
        Tool::Frizz => "frizzed",
        Tool::Comb => "combed",
        Tool::Pin => "pinned",
        Tool::Smooth => "smoothed",
        Tool::Puff => "puffed",
        Tool::Grab => "moved",
        Tool::Straighten => "straightened",
        Tool::Point => "moved a point of",
        Tool::Redraw => "re-drew",
        Tool::Scatter => "scattered",
        Tool::Silhouette => "outlined",
    };
    let of = if strands { "strand" } else { "cluster" };
    match curves {
        1 => format!("{verb} a {of}"),
        _ => format!("{verb} {curves} {of}s"),
    }
}

/// Why the last gesture of a node has done nothing, as the node says it.
fn nothing_done(state: &State, node: &NodeId, gesture: u64) -> String {
    let gestures = gestures(&state.document, node);
    let number = gestures.0.iter().position(|one| one.id == gesture).unwrap_or_default();
    let report = state.run.reports.nodes.get(node.as_str());
    let own = report.into_iter().flat_map(|report| &report.messages).find_map(|message| {
        let text = message.text.strip_prefix(&format!("gesture {number} ("))?;
        Some(text.split_once("): ")?.1)
    });
    let text = own.unwrap_or("it changes nothing: begin on hair");
    let mut letters = text.chars();
    letters.next().map_or_else(String::new, |first| first.to_uppercase().chain(letters).collect())
}
