//! The pen on hair: from samples to gestures of a *Hair sketch*, seen while they are drawn.
//!
//! A touch is a gesture in the document from its first sample on, so what is seen is what the node makes of it, and what stays is
//! what was seen. Without a tool of the shelf in hand the stroke itself says which gesture it is
//! (`coif_nodes::sketch::classify`), and may change its mind until the pen is lifted. Then the gesture learns which curves it
//! changed ([`resolved`]), by what the node gave before and after, and the undo step gets its name.
//!
//! Guarantees: one touch is one step; Escape takes back one that is under way; a touch that does nothing changes nothing, and the
//! place where it ended says why. A touch begins only on hair that is shown as it is: what comes sooner waits, and is not lost.

pub(crate) mod actions;
mod look;
pub(super) mod target;
mod wheel;

pub(super) use look::has_brush;

use super::devices::Input;
use super::sample::{PenSample as Report, Phase, Tool as End};
use super::{Said, Scene};
use crate::core::event::Event;
use crate::core::notes::Note;
use crate::core::projection::Projection;
use crate::core::settings::Evaluate;
use crate::core::state::{Select, State};
use coif_graphs::document::edit::Edit;
use coif_graphs::document::gestures::finish;
use coif_graphs::document::{NodeId, Socket};
use coif_graphs::values::grid::gestures_on_grid;
use coif_nodes::data::curves::Curves;
use coif_nodes::data::gestures::{Gesture, GestureView, Gestures, Layer, PenSample, Tool};
use coif_nodes::data::scalp::HeadFrame;
use coif_nodes::maths::hash::Key;
use coif_nodes::sketch::around::ViewedCurves;
use coif_nodes::sketch::classify::{Guess, classify, is_tap};
use coif_nodes::sketch::hair_sketch::resolved;
use coif_nodes::sketch::level::{Rule, level};
use egui::Pos2;
use glam::Vec2;

/// A touch that stays this near to where it began is no stroke for a tool of the shelf, points.
const STILL: f32 = 3.0;
/// So many frames after the evaluator has answered, what it has not shown will not come.
const PATIENCE: usize = 3;
/// An implant nearer to the middle of the head than this (head units) has no twin on the other side.
const MIDDLE: f32 = 0.5;
/// Hair that an implant grows is rooted this near to it, head units.
const BARE: f32 = 1.0;
/// The most samples of one gesture: four minutes at 1,000 a second. What comes after is not drawn.
const MOST: usize = 240_000;

/// The pen on hair.
#[derive(Default)]
pub(crate) struct Hair {
    /// How deep touches reach; none: as the pressure says, and of a mouse, what it touches.
    pub(crate) level: Option<Layer>,
    touch: Option<Touch>,
    /// The tap before, with when it began: the first of two.
    tap: Option<(f64, Vec<PenSample>)>,
    /// What a touch had to say, where, and until when.
    said: Option<Said>,
    /// Where the colour wheel was pressed down, and where the pen is on it.
    wheel: Option<(Pos2, Pos2)>,
    /// Reports that came before the hair was shown as it is.
    waiting: Vec<Input>,
    answered: usize,
    /// What the pen must see, and whether it is there.
    wanted: (Vec<Socket>, bool),
}

/// A touch under way, or one that was lifted and learns what it did.
struct Touch {
    node: NodeId,
    /// What makes the node, where there was none.
    make: Vec<Edit>,
    begun: bool,
    /// What is in hand; none: the stroke says.
    tool: Option<Tool>,
    eraser: bool,
    /// Whether it has no pressure of its own.
    mouse: bool,
    /// The node's curves before it, and the key of what came in to it.
    before: Curves,
    came_in: Option<Key>,
    view: GestureView,
    middle: Pos2,
    began: f64,
    samples: Vec<PenSample>,
    tap: Option<Vec<PenSample>>,
    guess: Guess,
    /// How deep it reaches, whatever the pressure is.
    fixed: Option<Layer>,
    /// How the pressure tells it else.
    rule: Rule,
    /// Id of the gesture, once it has one.
    id: u64,
    told: Option<Gesture>,
    lifted: bool,
    /// How many curves its twin has changed, where it is the one on the other side of the head.
    twin: Option<usize>,
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

fn pixel(view: &Projection, at: Pos2) -> Vec2 {
    let off = at - view.rect.center();
    Vec2::new(off.x, off.y)
}

/// Whether a device has no pressure of its own.
fn is_mouse(report: &Report) -> bool {
    matches!(report.tool, End::Mouse | End::Finger)
}

impl Hair {
    /// Whether a touch is under way or waits.
    pub(crate) fn is_busy(&self) -> bool {
        self.touch.is_some() || !self.waiting.is_empty()
    }

    /// Whether the pen is down and reaches the skin.
    pub(super) fn reaches_skin(&self) -> bool {
        let down = self.touch.as_ref().filter(|touch| !touch.lifted && !touch.samples.is_empty());
        down.is_some_and(|touch| touch.layer() == Layer::Scalp)
    }

    /// A touch under way never was; one that was lifted stays as it is.
    pub(super) fn stop(&mut self, out: &mut Vec<Event>) {
        self.waiting.clear();
        self.wheel = None;
        let Some(touch) = self.touch.take().filter(|touch| touch.begun) else { return };
        out.push(match touch.told.filter(|_| touch.lifted) {
            Some(told) => Event::EndAs(told.tool.word().to_owned()),
            None => Event::Abort,
        });
    }

    /// One frame: what was lifted is settled, then the reports are taken. `free` tells where a touch may begin.
    pub(super) fn ui(
        &mut self,
        tool: Option<Tool>,
        inputs: Vec<(Input, bool)>,
        scene: &mut Scene,
        now: f64,
    ) {
        if self.touch.as_ref().is_some_and(|touch| touch.is_orphaned(scene.state)) {
            self.touch = None;
        }
        let current = scene.state.run.reports.revision == scene.state.revision;
        let wanted = target::wanted(scene.state);
        let shown = scene.state.shown.as_ref();
        let known = |socket| shown.is_some_and(|shown| shown.curves_of(socket).is_some());
        let known = wanted.iter().all(known);
        let waits = !current || wanted != self.wanted.0;
        let runs = !known && scene.state.run.since.is_some();
        self.answered = if waits || runs { 0 } else { self.answered + 1 };
        self.wanted = (wanted, known);
        if self.touch.as_ref().is_some_and(|touch| touch.lifted) && self.is_current(scene.state) {
            let touch = self.touch.take();
            touch.into_iter().for_each(|touch| self.settle(touch, scene, now));
            // What it changed is seen in the next frame.
            self.answered = 0;
            self.waiting.extend(inputs.into_iter().filter_map(may_begin));
            return;
        }
        let late = std::mem::take(&mut self.waiting).into_iter().map(|input| (input, true));
        for (input, free) in late.chain(inputs).collect::<Vec<_>>() {
            self.take(tool, input, free, scene, now);
        }
        let live = super::ready(scene.state);
        if let Some(touch) = self.touch.as_mut().filter(|touch| live && !touch.lifted) {
            touch.flush(scene);
        }
        // Where hair is evaluated by key alone, what was lifted asks for it.
        let lifted = self.touch.as_ref().is_none_or(|touch| touch.lifted);
        let by_hand = scene.state.settings.evaluate != Evaluate::Live;
        if by_hand && self.is_busy() && lifted && !current && scene.state.run.since.is_none() {
            scene.out.push(Event::Evaluate);
        }
    }

    /// Whether the hair is shown as the document says, or will not be.
    fn is_current(&self, state: &State) -> bool {
        self.answered > PATIENCE || self.answered > 0 && self.wanted.1 && !state.stale()
    }

    fn take(&mut self, tool: Option<Tool>, input: Input, free: bool, scene: &mut Scene, now: f64) {
        let report = &input.sample;
        if self.touch.as_ref().is_some_and(|touch| touch.lifted)
            || !self.waiting.is_empty()
            || report.phase == Phase::Down && free && !self.is_current(scene.state)
        {
            if report.touches() && (report.phase != Phase::Down || free) {
                self.waiting.push(input);
            }
            return;
        }
        if self.turn_wheel(tool, report, free, scene) {
            return;
        }
        match (report.phase, &mut self.touch) {
            (Phase::Down, None) if free => self.begin(tool, report, scene, now),
            (Phase::Move, Some(touch)) => touch.go_on(report),
            (Phase::Up, Some(touch)) => {
                touch.go_on(&Report { pressure: touch.last_pressure(), ..*report });
                touch.flush(scene);
                touch.lifted = true;
                self.lifted(scene, now);
            }
            (Phase::Out, Some(_)) => self.stop(scene.out),
            _ => {}
        }
    }

    /// Whether the report is the colour wheel's.
    fn turn_wheel(
        &mut self,
        tool: Option<Tool>,
        report: &Report,
        free: bool,
        scene: &mut Scene,
    ) -> bool {
        match (report.phase, self.wheel) {
            (Phase::Down, None) if free && self.touch.is_none() => {
                let eraser = report.tool == End::Eraser;
                let on = tool.is_none() && !eraser && self.wheel_follows(report.pos, scene);
                if on {
                    self.wheel = Some((report.pos, report.pos));
                }
                on
            }
            (Phase::Move, Some((middle, _))) => {
                self.wheel = Some((middle, report.pos));
                true
            }
            (Phase::Up, Some((middle, at))) => {
                self.wheel = None;
                // A tap picks nothing.
                if at.distance(middle) > STILL {
                    let mut settings = scene.state.settings.clone();
                    settings.pen.hair_colour = wheel::colour(at - middle);
                    scene.out.push(Event::Settings(settings.into()));
                }
                true
            }
            (Phase::Out, Some(_)) => {
                self.wheel = None;
                true
            }
            _ => false,
        }
    }

    /// Whether the colour wheel is at the pen: nothing else is near.
    fn wheel_follows(&self, at: Pos2, scene: &Scene) -> bool {
        let state = scene.state;
        let rho = target::number(&state.document, target::of(state).as_ref(), "rho");
        let view = seen_from(scene.view, scene.scalp.frame());
        let curves = look::curves(state).unwrap_or_default();
        let ground = ViewedCurves::new(&view, scene.scalp, &curves, rho);
        wheel::is_free(&ground, pixel(scene.view, at), rho)
    }

    /// What a touch begins.
    fn begin(&mut self, tool: Option<Tool>, report: &Report, scene: &mut Scene, now: f64) {
        let (state, out) = (scene.state, &mut *scene.out);
        let document = &state.document;
        let shown = state.shown.as_ref();
        let value = |socket| shown.and_then(|shown| shown.curves_of(socket));
        let at = pixel(scene.view, report.pos);
        let view = seen_from(scene.view, scene.scalp.frame());
        let (node, make, came_in) = match target::of(state) {
            Some(node) => {
                let came_in = target::came_in(document, &node);
                (node, vec![], came_in)
            }
            None => {
                let sources = target::sources(state);
                let rho = target::number(document, None, "rho");
                let under = |socket: &&Socket| {
                    let curves = shown.and_then(|shown| shown.curves_of(socket));
                    let hair = |curves| ViewedCurves::new(&view, scene.scalp, curves, rho).hair(at);
                    curves.is_some_and(hair)
                };
                let after = sources.iter().find(under).or(sources.first());
                if after.is_none() && shown.is_some_and(|shown| shown.curves.curve_count() > 0) {
                    let text = match state.settings.pen.strands {
                        true => {
                            "More than 200,000 strands cannot be combed one by one: show fewer, or turn Strands off"
                        }
                        false => {
                            "This hair grows from no guides that the pen could edit: display guides or clusters"
                        }
                    };
                    self.said = Some(Said::new(report.pos, now, text));
                    return;
                }
                // On a bare head what is sketched is filled with hair, or it would hardly be seen.
                let made = match after {
                    Some(after) => target::make(document, Some(after)),
                    None => {
                        let made = super::recipes::ALL[super::recipes::SKETCH]
                            .edits(document, None, false);
                        made.ok().map(|made| (made.node, made.edits))
                    }
                };
                let Some((node, make)) = made else {
                    let note = "there is no head to sketch on: add a head to the graph";
                    return out.push(Event::Say(Note::warning(note)));
                };
                (node, make, after.cloned())
            }
        };
        // A node that is not there yet changes nothing of what comes in.
        let own = if make.is_empty() { Some(target::output(&node)) } else { came_in.clone() };
        let before = match own.as_ref().map(value) {
            None => Curves::default(),
            Some(Some(curves)) => curves.clone(),
            Some(None) => {
                let text = "the hair to work on is not there: see Messages";
                self.said = Some(Said::new(report.pos, now, text));
                return;
            }
        };
        let began = report.time;
        let tap = self.tap.take().map(|(when, mut tap)| {
            tap.iter_mut().for_each(|sample| sample.time += (when - began) as f32);
            tap
        });
        self.said = None;
        self.touch = Some(Touch {
            came_in: came_in.as_ref().and_then(value).map(Curves::key),
            before,
            view,
            middle: scene.view.rect.center(),
            began,
            samples: vec![],
            tap,
            guess: Guess::Unsure(""),
            fixed: None,
            rule: match state.settings.pen.level_by_mean {
                true => Rule::Mean,
                false => Rule::Highest,
            },
            id: 0,
            told: None,
            lifted: false,
            twin: None,
            begun: false,
            tool,
            eraser: report.tool == End::Eraser,
            mouse: is_mouse(report),
            node,
            make,
        });
        let level = self.level;
        if let Some(touch) = &mut self.touch {
            touch.fixed = touch.fixed_level(level, at, scene);
            touch.go_on(report);
        }
    }

    /// The pen has left the picture: a touch that means nothing ends at once, and a tap is remembered.
    fn lifted(&mut self, scene: &mut Scene, now: f64) {
        let Some(touch) = self.touch.take_if(|touch| touch.told.is_none()) else { return };
        if touch.begun {
            scene.out.push(Event::Abort);
        }
        let rho = touch.rho(scene.state);
        let tap = touch.tool.is_none() && !touch.eraser && is_tap(&touch.samples, rho);
        if let (Guess::Unsure(why), false) = (touch.guess, tap) {
            self.said = Some(Said::new(touch.end(), now, why));
        }
        self.tap = tap.then_some((touch.began, touch.samples));
    }

    /// What was lifted learns what it did, and its step is done; with symmetry once more on the other side.
    fn settle(&mut self, mut touch: Touch, scene: &mut Scene, now: f64) {
        let Some(told) = touch.told.take() else { return };
        let document = &scene.state.document;
        let strands = scene.state.settings.pen.strands;
        let shown =
            scene.state.shown.as_ref().filter(|shown| shown.revision == scene.state.revision);
        let value = |socket| shown.and_then(|shown| shown.curves_of(&socket));
        let came_in = target::came_in(document, &touch.node).and_then(value).map(Curves::key);
        let after = value(target::output(&touch.node)).filter(|_| came_in == touch.came_in);
        let Some(after) = after else {
            scene.out.push(Event::EndAs(told.tool.word().to_owned()));
            return;
        };
        let (node, input) = (touch.node.clone(), target::GESTURES.to_owned());
        let known = resolved(&told, &touch.before, after, scene.scalp);
        let plants = matches!(told.tool, Tool::Implant | Tool::Silhouette | Tool::Scatter);
        let planted = plants && after.key() != touch.before.key();
        let more = after.curve_count().saturating_sub(touch.before.curve_count());
        let changed = match plants {
            // One that takes the place of another is none more.
            true => more.max(usize::from(planted)),
            false => known.curves.len(),
        };
        let bare = planted && came_in.is_some() && bare_root(&known, scene);
        if changed == 0 || bare {
            scene.out.push(match touch.twin {
                Some(_) => Event::Edit(Edit::RemoveGesture { node, input, id: told.id }),
                None => Event::Abort,
            });
            match touch.twin {
                Some(first) => scene.out.push(Event::EndAs(done(told.tool, first, strands))),
                None => {
                    let why = match bare {
                        true => NO_HAIR_HERE.to_owned(),
                        false => nothing_done(scene.state, &touch.node, told.id),
                    };
                    self.said = Some(Said::new(touch.end(), now, why));
                }
            }
            return;
        }
        let known = gestures_on_grid(Gestures(vec![known]).into());
        let Some(gesture) = known.0.first() else { return };
        if *gesture != told {
            let (node, input) = (node.clone(), input.clone());
            let gesture = gesture.clone();
            scene.out.push(Event::Edit(Edit::ReplaceGesture { node, input, gesture }));
        }
        let middle = gesture.root.is_some_and(|root| root.x.abs() < MIDDLE);
        let both = scene.state.settings.pen.symmetry && touch.twin.is_none() && !middle;
        let twin = both.then(|| finish(told.mirrored(), &target::gestures(document, &node)));
        match twin.flatten() {
            Some(twin) => {
                let at = usize::MAX;
                let gesture = twin.clone();
                scene.out.push(Event::Edit(Edit::AddGesture { node, input, at, gesture }));
                let (before, told) = (after.clone(), Some(twin));
                self.touch = Some(Touch { before, told, twin: Some(changed), ..touch });
            }
            None => {
                let all = touch.twin.unwrap_or_default() + changed;
                scene.out.push(Event::EndAs(done(told.tool, all, strands)));
            }
        }
    }
}

/// A report with which a touch may begin or go on later.
fn may_begin((input, free): (Input, bool)) -> Option<Input> {
    (input.sample.touches() && (input.sample.phase != Phase::Down || free)).then_some(input)
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
    let gestures = target::gestures(&state.document, node);
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

impl Touch {
    /// Whether somebody has ended or undone what it has begun.
    fn is_orphaned(&self, state: &State) -> bool {
        self.begun && (!state.gesture || !state.document.nodes.contains_key(self.node.as_str()))
    }

    fn last_pressure(&self) -> f32 {
        self.samples.last().map_or(0.0, |sample| sample.pressure)
    }

    fn rho(&self, state: &State) -> f32 {
        target::number(&state.document, Some(&self.node), "rho")
    }

    /// How deep it reaches where its tool, a key or what a mouse touches says so.
    fn fixed_level(&self, level: Option<Layer>, at: Vec2, scene: &Scene) -> Option<Layer> {
        match (self.tool, level) {
            (Some(Tool::Implant | Tool::Silhouette | Tool::Scatter), _) => Some(Layer::Scalp),
            (Some(Tool::Lengthen | Tool::Pin | Tool::Point | Tool::Redraw), _) => {
                Some(Layer::Nearest)
            }
            (None, None) if self.mouse => {
                let rho = self.rho(scene.state);
                let ground = ViewedCurves::new(&self.view, scene.scalp, &self.before, rho);
                Some(level_of_mouse(&ground, at, self.eraser))
            }
            _ => level,
        }
    }

    /// How deep it reaches.
    fn layer(&self) -> Layer {
        self.fixed.unwrap_or_else(|| level(&self.samples, self.rule))
    }

    /// The next sample.
    fn go_on(&mut self, report: &Report) {
        let off = report.pos - self.middle;
        let at = Vec2::new(off.x, off.y);
        let told = |last: &PenSample| last.at == at && last.pressure == report.pressure;
        if self.samples.last().is_some_and(told) || self.samples.len() >= MOST {
            return;
        }
        let time = (report.time - self.began).max(0.0) as f32;
        let tilt = Vec2::new(report.tilt.x, report.tilt.y);
        self.samples.push(PenSample { at, pressure: report.pressure, time, tilt });
    }

    /// Which gesture it is, as far as it is drawn.
    fn guess(&self, scene: &Scene) -> Guess {
        let (first, last) = (self.samples[0].at, self.samples[self.samples.len() - 1].at);
        let rho = self.rho(scene.state);
        match self.tool {
            Some(Tool::Pin) => Guess::Is(Tool::Pin),
            Some(tool) => match self.is_still() {
                true => Guess::Unsure("The stroke is too short: draw it longer"),
                false => Guess::Is(tool),
            },
            None => {
                let ground = ViewedCurves::new(&self.view, scene.scalp, &self.before, rho);
                let around = ground.around(first, last, self.eraser, self.layer());
                classify(&self.samples, self.tap.as_deref(), &around, rho)
            }
        }
    }

    /// Whether the pen has stayed where it touched.
    fn is_still(&self) -> bool {
        self.samples.iter().all(|s| s.at.distance(self.samples[0].at) <= STILL)
    }

    /// The gesture as far as it is drawn; none while it is none.
    fn gesture(&mut self, scene: &Scene) -> Option<Gesture> {
        self.guess = self.guess(scene);
        let Guess::Is(tool) = self.guess else { return None };
        let settings = &scene.state.settings.pen;
        let brush = matches!(tool, Tool::Smooth | Tool::Puff | Tool::Grab | Tool::Straighten);
        // A tap pins one CV, a stroke all under the brush.
        let pins = self.tool == Some(Tool::Pin) && !self.is_still();
        let sized = brush || pins || matches!(tool, Tool::Comb | Tool::Scatter);
        let size = if sized {
            let depth = scene.view.depth(scene.scalp.frame().origin);
            settings.hair_brush() / scene.view.cm_per_point(depth).max(1e-6)
        } else {
            0.0
        };
        let strength = match tool {
            // From half strength on, hair goes as far as the pen.
            Tool::Comb => (2.0 * settings.strength()).min(1.0),
            Tool::Grab => 1.0,
            _ if brush => 2.0 * settings.strength() * self.press(),
            _ => 1.0,
        };
        let gesture = Gesture {
            id: self.id,
            tool,
            layer: match tool {
                Tool::Implant => Layer::Scalp,
                Tool::Pin if pins => Layer::Through,
                _ => self.layer(),
            },
            view: self.view,
            samples: self.samples.clone(),
            curves: vec![],
            root: None,
            path: vec![],
            colour: settings
                .hair_colour()
                .filter(|_| matches!(tool, Tool::Implant | Tool::Silhouette)),
            size: size.clamp(2.0, 1000.0) * f32::from(u8::from(sized)),
            strength,
        };
        let others = target::gestures(&scene.state.document, &self.node);
        let mut gesture = finish(gesture, &others)?;
        if self.id == 0 {
            self.id = gesture.id;
        }
        gesture.id = self.id;
        Some(gesture)
    }

    /// How strongly a brush is pressed: 1 at half pressure.
    fn press(&self) -> f32 {
        let sum: f32 = self.samples.iter().map(|sample| sample.pressure).sum();
        if self.mouse { 1.0 } else { 2.0 * sum / self.samples.len().max(1) as f32 }
    }

    /// Tells the document what has changed since it was told last.
    fn flush(&mut self, scene: &mut Scene) {
        let wanted = self.gesture(scene);
        if wanted == self.told {
            return;
        }
        if !self.begun {
            self.begun = true;
            scene.out.push(Event::Begin("hair sketched".to_owned()));
            if !self.make.is_empty() {
                scene.out.extend(std::mem::take(&mut self.make).into_iter().map(Event::Edit));
                scene.out.push(Event::Select(Select::Nodes(vec![self.node.clone()])));
            }
        }
        let (node, input) = (self.node.clone(), target::GESTURES.to_owned());
        let edit = match (&wanted, self.told.is_some()) {
            (Some(gesture), true) => Edit::ReplaceGesture { node, input, gesture: gesture.clone() },
            (Some(gesture), false) => {
                Edit::AddGesture { node, input, at: usize::MAX, gesture: gesture.clone() }
            }
            (None, _) => Edit::RemoveGesture { node, input, id: self.id },
        };
        scene.out.push(Event::Edit(edit));
        self.told = wanted;
    }

    /// Where it is on the picture now.
    fn end(&self) -> Pos2 {
        self.line().last().unwrap_or(self.middle)
    }

    /// Where it is on the picture, for its ink.
    fn line(&self) -> impl Iterator<Item = Pos2> {
        self.samples.iter().map(|s| self.middle + egui::Vec2::new(s.at.x, s.at.y))
    }
}

/// A mouse has no pressure: what it begins on says how deep it reaches.
fn level_of_mouse(ground: &ViewedCurves, at: Vec2, eraser: bool) -> Layer {
    match () {
        () if !eraser && ground.end(at).is_some() => Layer::Nearest,
        () if eraser || ground.hair(at) || ground.skin(at).is_none() => Layer::Through,
        () => Layer::Scalp,
    }
}

#[cfg(test)]
mod tests;
