//! One touch of the pen, whatever tool is in hand: samples in, one step in the document out.
//!
//! What a tool does with a touch is its [`Work`]: it takes samples and tells what the input of a node should hold now.
//! [`TouchStep::tell`] turns the difference to what the document knows into edits, so live and final edits are made in one way, and
//! nothing is told twice. [`Touches`] is the way from samples to works, the same for all tools.
//!
//! Guarantees: one touch is one step; what takes it back (Escape, a pen that leaves, a tool that fills another input, a head that
//! goes) takes it back whole, but for what was lifted already: that stays as it is. A touch whose step somebody else has ended or
//! undone ends without a word. Samples that come before a touch may begin or go on wait, and are not lost.

use super::devices::Input;
use super::sample::{PenSample, Phase};
use super::target::{self, Fills};
use super::{PenTool, Scene, hair, mask, strokes};
use crate::core::event::Event;
use crate::core::projection::Projection;
use crate::core::settings::Evaluate;
use crate::core::state::{Select, State};
use coif_graphs::document::edit::Edit;
use coif_graphs::document::{Document, NodeId};
use coif_nodes::data::gestures::Gesture;
use coif_nodes::data::strokes::Stroke;
use egui::{Painter, Pos2};
use std::collections::BTreeMap;

/// What a tool does with a touch.
pub(super) trait Work {
    /// The next sample; with the last one the pen is lifted.
    fn go_on(&mut self, sample: &PenSample, scene: &Scene);

    /// What the input should hold now. What is not named stays as it is.
    fn wants(&mut self, _step: &TouchStep, _scene: &Scene) -> Wanted {
        vec![]
    }

    /// The pen is lifted, or what that waited for is there: tells the rest, and how the touch ends.
    fn end(&mut self, step: &mut TouchStep, scene: &mut Scene) -> Outcome {
        step.tell(self.wants(step, scene), scene);
        Outcome::Done
    }

    /// What is seen over the picture while it lasts.
    fn paint(&self, _painter: &Painter, _scene: &Scene) {}

    /// Whether it reaches the skin under hair.
    fn reaches_skin(&self) -> bool {
        false
    }
}

/// What a touch begins; none where it does nothing. The error is why, for people.
pub(super) type Begun = Result<Option<Touch>, &'static str>;

/// Strokes or gestures by id; none for one that goes.
pub(super) type Wanted = Vec<(u64, Option<DrawnItem>)>;

/// One of what an input holds.
#[derive(Clone, PartialEq)]
pub(super) enum DrawnItem {
    Stroke(Stroke),
    Gesture(Gesture),
}

/// How a touch ends.
pub(super) enum Outcome {
    /// It is a step.
    Done,
    /// What it did is known once the hair is shown. Until then its step has the words of now.
    Waits,
    /// It never was.
    Nothing,
}

/// How far a touch is.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Stage {
    /// The document knows nothing of it: it may still mean nothing.
    New,
    /// Its step is open.
    Told,
    /// The pen is lifted, and it waits for the hair.
    Lifted,
}

/// What of a touch the document knows.
pub(super) struct TouchStep {
    pub(super) node: NodeId,
    input: &'static str,
    /// What makes the node, where there was none.
    make: Vec<Edit>,
    /// What the step is called.
    pub(super) words: String,
    /// Where the pen was last.
    pub(super) at: Pos2,
    stage: Stage,
    told: BTreeMap<u64, Option<DrawnItem>>,
}

impl TouchStep {
    /// Tells the document what has changed since it was told last.
    pub(super) fn tell(&mut self, wanted: Wanted, scene: &mut Scene) {
        let mut edits = vec![];
        for (id, wanted) in wanted {
            if self.told.get(&id) != Some(&wanted) {
                edits.extend(self.edit(id, wanted.clone(), &scene.state.document));
                self.told.insert(id, wanted);
            }
        }
        let edit = match edits.len() {
            0 => return,
            1 => edits.remove(0),
            _ => Edit::Several(edits),
        };
        if self.stage == Stage::New {
            self.stage = Stage::Told;
            scene.out.push(Event::Begin(self.words.clone()));
            if !self.make.is_empty() {
                scene.out.extend(self.make.drain(..).map(Event::Edit));
                scene.out.push(Event::Select(Select::Nodes(vec![self.node.clone()])));
            }
        }
        scene.out.push(Event::Edit(edit));
    }

    /// One more edit of the step, where it has begun.
    pub(super) fn also(&self, edit: Option<Edit>, scene: &mut Scene) {
        scene.out.extend(edit.filter(|_| self.stage != Stage::New).map(Event::Edit));
    }

    fn edit(&self, id: u64, wanted: Option<DrawnItem>, document: &Document) -> Option<Edit> {
        let held = || target::strokes(document, &self.node).0.iter().any(|held| held.id == id);
        let told = self.told.get(&id);
        let there = told.map_or_else(held, Option::is_some);
        let gesture = matches!(told, Some(Some(DrawnItem::Gesture(_))));
        let (node, input, at) = (self.node.clone(), self.input.to_owned(), usize::MAX);
        use DrawnItem::{Gesture, Stroke};
        match (wanted, there) {
            (Some(Stroke(stroke)), true) => Some(Edit::ReplaceStroke { node, input, stroke }),
            (Some(Stroke(stroke)), false) => Some(Edit::AddStroke { node, input, at, stroke }),
            (Some(Gesture(gesture)), true) => Some(Edit::ReplaceGesture { node, input, gesture }),
            (Some(Gesture(gesture)), false) => Some(Edit::AddGesture { node, input, at, gesture }),
            (None, true) if gesture => Some(Edit::RemoveGesture { node, input, id }),
            (None, true) => Some(Edit::RemoveStroke { node, input, id }),
            (None, false) => None,
        }
    }

    /// Whether somebody else has ended or undone what it has begun.
    fn is_orphaned(&self, state: &State) -> bool {
        let is_there = state.gesture && state.document.nodes.contains_key(&self.node);
        self.stage != Stage::New && !is_there
    }

    /// Ends the step: it stays or never was.
    fn close(self, stays: bool, out: &mut Vec<Event>) {
        let end = if stays { Event::EndAs(self.words) } else { Event::Abort };
        out.extend((self.stage != Stage::New).then_some(end));
    }
}

/// A touch under way, or one that was lifted and waits.
pub(super) struct Touch {
    step: TouchStep,
    work: Box<dyn Work>,
}

impl Touch {
    /// A touch that fills a node, with the edits that make it where it is not there, and what its step is called.
    pub(super) fn new(
        (node, make): (NodeId, Vec<Edit>),
        fills: Fills,
        words: impl Into<String>,
        work: impl Work + 'static,
        scene: &Scene,
    ) -> Self {
        let input = target::input(&scene.state.document, &node, fills);
        let (stage, told, at) = (Stage::New, BTreeMap::new(), Pos2::ZERO);
        let step = TouchStep { node, input, make, words: words.into(), at, stage, told };
        Self { step, work: Box::new(work) }
    }

    fn go_on(&mut self, sample: &PenSample, scene: &Scene) {
        self.step.at = sample.pos;
        self.work.go_on(sample, scene);
    }
}

/// The touches of the pen: the one under way, what just ended, and what is to come.
#[derive(Default)]
pub(super) struct Touches {
    touch: Option<Touch>,
    /// What ended in this frame: it is painted until the document, in the next one, has it.
    ended: Option<Box<dyn Work>>,
    /// Reports that came before a touch could begin or go on, each with what was seen then: the view may turn meanwhile.
    waiting: Vec<(Input, Projection)>,
    /// Where the pen is over the picture.
    pub(super) hover: Option<Input>,
    /// What the tool in hand fills; none without a head.
    fills: Option<Fills>,
}

impl Touches {
    /// Whether the pen is down.
    pub(super) fn is_drawing(&self) -> bool {
        self.touch.is_some() && !self.is_lifted()
    }

    fn is_lifted(&self) -> bool {
        self.touch.as_ref().is_some_and(|touch| touch.step.stage == Stage::Lifted)
    }

    /// Whether something waits for what is shown.
    fn waits(&self) -> bool {
        self.is_lifted() || !self.waiting.is_empty()
    }

    /// Whether there is something to be done or painted in the next frame.
    pub(super) fn is_busy(&self) -> bool {
        self.is_drawing() || self.waits() || self.ended.is_some()
    }

    /// Whether the pen is down and reaches the skin under hair.
    pub(super) fn reaches_skin(&self) -> bool {
        self.is_drawing() && self.seen().is_some_and(|work| work.reaches_skin())
    }

    /// What is painted.
    pub(super) fn seen(&self) -> Option<&dyn Work> {
        let work = self.touch.as_ref().map(|touch| &touch.work);
        work.or(self.ended.as_ref()).map(|work| &**work)
    }

    /// Lets go of what is gone, or was begun with a tool that fills something else.
    pub(super) fn keep(&mut self, fills: Option<Fills>, state: &State, out: &mut Vec<Event>) {
        self.ended = None;
        self.touch.take_if(|touch| touch.step.is_orphaned(state));
        if self.fills != fills {
            self.fills = fills;
            self.stop(out);
        }
    }

    /// A touch under way never was; one that was lifted stays as it is.
    pub(super) fn stop(&mut self, out: &mut Vec<Event>) {
        self.waiting.clear();
        if let Some(Touch { step, .. }) = self.touch.take() {
            let stays = step.stage == Stage::Lifted;
            step.close(stays, out);
        }
    }

    /// One frame: what was lifted ends, then the reports are taken, each with whether a touch may begin there. `shown` tells whether
    /// what touches work on is shown as the document says.
    pub(super) fn ui(
        &mut self,
        tool: PenTool,
        inputs: Vec<(Input, bool)>,
        mut shown: bool,
        scene: &mut Scene,
    ) {
        if shown && self.is_lifted() {
            self.end(scene);
            // What it changed is seen in the next frame.
            scene.hair.changed();
            shown = false;
        }
        let view = scene.view;
        let late = std::mem::take(&mut self.waiting).into_iter();
        let late = late.map(|(input, view)| (input, true, view));
        for (input, free, seen) in
            late.chain(inputs.into_iter().map(|(input, free)| (input, free, view)))
        {
            scene.view = seen;
            let phase = input.sample.phase;
            let begins = phase == Phase::Down && free;
            let counts = begins || matches!(phase, Phase::Move | Phase::Up);
            if self.waits() || begins && !shown {
                self.waiting.extend(counts.then_some((input, seen)));
            } else if phase != Phase::Down || begins {
                self.take(tool, &input, scene);
            }
        }
        scene.view = view;
        let state = scene.state;
        let live = state.settings.evaluate == Evaluate::Live;
        let answered = state.run.reports.revision == state.revision;
        if self.is_drawing() {
            // The next change comes when the evaluator has answered the last one.
            if let Some(touch) = self.touch.as_mut().filter(|_| answered || !live) {
                touch.step.tell(touch.work.wants(&touch.step, scene), scene);
            }
        } else if self.waits() && !live && !answered && state.run.since.is_none() {
            // Where hair is evaluated by key alone, what waits for it asks for it.
            scene.out.push(Event::Evaluate);
        }
    }

    /// One report: a touch begins, goes on or ends.
    fn take(&mut self, tool: PenTool, input: &Input, scene: &mut Scene) {
        let sample = &input.sample;
        match (sample.phase, &mut self.touch) {
            (Phase::Down, None) => {
                *scene.said = None;
                let begun = match tool {
                    PenTool::Hair(tool) => hair::begin(tool, sample, scene),
                    PenTool::Mask(mode) => mask::begin(mode, sample, scene),
                    tool => strokes::begin(tool, input, scene),
                };
                match begun {
                    Ok(touch) => self.touch = touch,
                    Err(why) => scene.say(sample.pos, why),
                }
            }
            (Phase::Move, Some(touch)) => touch.go_on(sample, scene),
            (Phase::Up, Some(touch)) => {
                touch.go_on(sample, scene);
                self.end(scene);
            }
            (Phase::Out, Some(_)) => self.stop(scene.out),
            _ => {}
        }
    }

    /// Ends the touch, or leaves it waiting for the hair.
    fn end(&mut self, scene: &mut Scene) {
        let Some(mut touch) = self.touch.take() else { return };
        match touch.work.end(&mut touch.step, scene) {
            Outcome::Nothing => touch.step.close(false, scene.out),
            Outcome::Waits => {
                touch.step.stage = Stage::Lifted;
                self.touch = Some(touch);
            }
            Outcome::Done => {
                touch.step.close(true, scene.out);
                self.ended = Some(touch.work);
            }
        }
    }
}
