//! The viewport: the groom as it is, drawn beside the window, and the hands that turn it.
//!
//! Pictures come from a thread of their own ([`drawing`]); the window only puts the newest one on the screen. What one looks
//! at, and from where, is never part of a groom.
//!
//! Guaranteed: a frame never waits for a picture; without a graphics adapter everything else works, and the viewport says
//! why it is empty.

pub mod actions;
mod camera_control;
pub mod drawing;
mod handles;
mod hud;
pub mod input;
mod menu;
pub mod navigation;
pub mod options;
mod overlay;
mod painter;
mod panes;
mod parts;
mod picking;
pub mod select;
pub mod status;

pub use camera_control::Step;

use crate::core::event::Event;
use crate::core::notes::Note;
use crate::core::pen::Holds;
use crate::core::projection::{self, Projection};
use crate::core::shown::{Shown, Sides};
use crate::core::state::State;
use crate::feeders::feeders;
use crate::scene::lights::Surroundings;
use crate::scene::{Show, looks};
use coif_graphs::document::edit::Edit;
use coif_graphs::document::{SavedLook, Socket};
use coif_nodes::data::curves::Curves;
use coif_nodes::data::scalp::Scalp;
use coif_nodes::define::Value;
use coif_nodes::eval::Quality;
use coif_shaders::camera::PORTRAIT_FOCAL;
use coif_shaders::{Camera, Look};
use drawing::{DrawRequest, Drawing, HairHit, PickResult};
use egui::{PointerButton, Pos2, Rect, Sense, Vec2};
use glam::Vec3;
use handles::Handles;
use navigation::{Drag, Views};
use options::Options;
use overlay::Overlay;
use painter::together;
pub(crate) use panes::Compared;
use panes::Pane;
use select::Level;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, TryRecvError, channel};
use std::time::Instant;

/// Longest side and number of pixels of a picture: larger windows are drawn a little softer.
const LONGEST: f32 = 4096.0;
const MOST_PIXELS: f32 = 6.0e6;
/// Coverage of hair while the pen works on the skin under it.
const SEE_THROUGH: f32 = 0.12;
/// After a step of the view it still counts as moving, seconds.
const CALM: f64 = 0.25;
/// The room until it is shown.
const ROOM: Rect = Rect { min: Pos2::ZERO, max: Pos2::new(900.0, 600.0) };
/// The pointer is taken to be where it was asked about within so many points.
const NEAR: f32 = 6.0;

/// The room.
pub struct Viewport {
    /// How the groom is looked at.
    pub options: Options,
    /// Light and skin as the groom has them, and as the options had them then.
    look: Option<SavedLook>,
    chosen: SavedLook,
    /// What pictures cost, for the status line and tests.
    pub stats: DrawStats,
    /// What the pen has hold of, and is left alone here.
    pub pen: Holds,
    /// How two documents are shown, where two are compared.
    pub(crate) compared: Option<Compared>,
    camera: Camera,
    views: Views,
    /// Whether the eye was put somewhere for this groom.
    framed: bool,
    framing: Option<Receiver<Camera>>,
    /// The eye that was put before a head whose hair was not made yet.
    before_hair: Option<Camera>,
    /// Such an eye is being found.
    waits_for_hair: bool,
    /// One's own picture, and that of another groom.
    panes: [Pane; 2],
    fault: Option<String>,
    /// All of the room that shows pictures.
    room: Rect,
    /// Where the picture in hand lies, and the part of it that is seen.
    rect: Rect,
    part: Rect,
    /// Whether two pictures lie side by side.
    beside: bool,
    /// Where a wipe changes from one groom to the other, as a share of the room's width.
    divider: f32,
    hovered: bool,
    drag: Option<(PointerButton, Drag)>,
    /// The pointer turns the light.
    turns_light: bool,
    /// Surroundings that are being read.
    reading: Option<Reading>,
    /// The view counts as moving until then, and came to rest when that is over.
    moves_until: Option<f64>,
    questions: u64,
    question: Option<Question>,
    under: Option<Under>,
    /// The curve that was clicked last and how much of its kin is selected.
    clicked: Option<Clicked>,
    /// The hair that was clicked last, with either button.
    meant: Option<u64>,
    overlay: Overlay,
    handles: Handles,
    menu: menu::Menu,
    /// The name that the next saved view gets.
    view_name: String,
    /// The first state of the open document.
    born: u64,
}

/// What pictures cost.
#[derive(Clone, Debug, Default)]
pub struct DrawStats {
    /// Pictures that came to the screen.
    pub pictures: u64,
    /// Milliseconds from a scene to its hair on the device, and to its first picture: the last ones.
    pub uploaded_ms: f64,
    /// Milliseconds from a scene to the picture on the screen.
    pub drawn_ms: f64,
    /// Milliseconds of the window's own thread to hand a picture to the display.
    pub texture_ms: f64,
    /// The document's state whose hair was first drawn last, when its hair was on the device, and when the picture was.
    pub newest: Option<(u64, Instant, Instant)>,
}

/// Why it was asked what lies under the pointer.
#[derive(Clone, Copy, PartialEq)]
enum Purpose {
    Hover,
    /// Whether what is selected stays so.
    Click {
        more: bool,
    },
    /// The right button opens the menu.
    Menu,
}

struct Question {
    number: u64,
    purpose: Purpose,
    at: Pos2,
}

/// What lies under the pointer.
struct Under {
    at: Pos2,
    camera: Camera,
    picked: PickResult,
}

struct Clicked {
    hair: HairHit,
    level: Level,
    /// It is not known yet which node made it.
    tracing: bool,
}

/// A file of surroundings that is being read, and what comes of it.
struct Reading {
    path: PathBuf,
    answer: Receiver<Result<Surroundings, String>>,
}

/// The curves that hair follows, of an evaluation.
#[derive(Default)]
struct Followed {
    of: Option<Arc<Shown>>,
    curves: Curves,
}

impl Default for Viewport {
    fn default() -> Self {
        Self {
            options: Options::default(),
            look: None,
            chosen: Options::default().saved(),
            stats: DrawStats::default(),
            pen: Holds::default(),
            compared: None,
            hovered: false,
            camera: Camera {
                eye: Vec3::new(0.0, 4.0, 110.0),
                target: Vec3::new(0.0, 2.0, 0.0),
                up: Vec3::Y,
                focal_mm: PORTRAIT_FOCAL,
                orthographic: None,
            },
            views: Views::default(),
            framed: false,
            framing: None,
            before_hair: None,
            waits_for_hair: false,
            panes: Default::default(),
            fault: None,
            room: ROOM,
            rect: ROOM,
            part: ROOM,
            beside: false,
            divider: 0.5,
            drag: None,
            turns_light: false,
            reading: None,
            moves_until: None,
            questions: 0,
            question: None,
            under: None,
            clicked: None,
            meant: None,
            overlay: Overlay::default(),
            handles: Handles::default(),
            menu: menu::Menu::default(),
            view_name: String::new(),
            born: 0,
        }
    }
}

impl Viewport {
    /// Begins to draw on a thread of its own, which asks the context to repaint. Until then the room shows no picture.
    pub fn start(&mut self, ctx: &egui::Context) {
        self.panes[0].drawing = self.begin_drawing(ctx);
    }

    fn begin_drawing(&mut self, ctx: &egui::Context) -> Option<Drawing> {
        let ctx = ctx.clone();
        let drawing = Drawing::start(move || ctx.request_repaint());
        drawing.map_err(|why| self.fault = Some(why)).ok()
    }

    /// Lights the picture by a photographed sphere, which is read on a thread; what is wrong with it is said.
    pub(crate) fn surround(&mut self, path: &Path, wake: Arc<dyn Fn() + Send + Sync>) {
        let (send, answer) = channel();
        self.reading = Some(Reading { path: path.to_owned(), answer });
        let path = path.to_owned();
        std::thread::spawn(move || {
            // Nobody waits for it any more where another was asked for.
            let _ = send.send(Surroundings::read(&path));
            wake();
        });
    }

    /// Whether surroundings are being read.
    pub fn is_reading(&self) -> bool {
        self.reading.is_some()
    }

    fn take_surroundings(&mut self, out: &mut Vec<Event>) {
        let Some(Reading { path, answer }) = &self.reading else { return };
        let read = match answer.try_recv() {
            Ok(read) => read,
            Err(TryRecvError::Empty) => return,
            Err(TryRecvError::Disconnected) => Err("cannot be read".to_owned()),
        };
        let name = path.display();
        out.push(Event::Say(match &read {
            Ok(_) => Note::done(format!("lit by {name}; Look has the lights as before")),
            Err(why) => Note::warning(format!("{name}: {why}")),
        }));
        if let Ok(around) = read {
            self.options.around = Some(around);
        }
        self.reading = None;
    }

    /// Forgets the picture of a document that is gone, and what comes late of it: states before `born`.
    pub(crate) fn forget(&mut self, born: u64) {
        self.born = born;
        self.panes[0].on_screen = None;
        (self.under, self.clicked, self.question) = (None, None, None);
    }

    /// Where it is seen from.
    pub fn camera(&self) -> &Camera {
        &self.camera
    }

    /// Looks from elsewhere; back leads to where it was.
    pub fn look(&mut self, camera: Camera) {
        self.views.rest(&self.camera);
        self.camera = camera;
        self.views.rest(&camera);
        self.framed = true;
    }

    /// The picture that is seen, for what is drawn over it and for what points at it.
    pub fn projection(&self) -> Projection {
        Projection::new(
            self.hand().on_screen.as_ref().map_or(self.camera, |s| s.drawn.wanted.camera),
            self.rect,
        )
    }

    /// Whether the pointer is over the picture itself and no widget on it, or drags it.
    pub fn is_hovered(&self) -> bool {
        self.hovered
    }

    /// Whether the pointer moves the eye or the light now, and nothing else.
    pub fn is_navigating(&self) -> bool {
        self.drag.is_some() || self.turns_light
    }

    /// Whether the picture at rest of what was asked for is on the screen.
    pub fn is_idle(&self) -> bool {
        self.panes.iter().filter_map(|pane| pane.drawing.as_ref()).all(Drawing::is_idle)
            && self.framing.is_none()
            && !self.overlay.is_finding()
    }

    /// Bytes that pictures take, and what they are drawn of.
    pub fn bytes(&self) -> usize {
        let drawings = self.panes.iter().filter_map(|pane| pane.drawing.as_ref());
        drawings.map(Drawing::bytes).sum()
    }

    /// Why there is no picture.
    pub fn fault(&self) -> Option<String> {
        let drawings = self.panes.iter().filter_map(|pane| pane.drawing.as_ref());
        self.fault.clone().or_else(|| drawings.into_iter().find_map(Drawing::fault))
    }

    /// What lies under the pointer, where that is known.
    pub fn under_pointer(&self) -> Option<&PickResult> {
        self.under.as_ref().map(|under| &under.picked)
    }

    /// Outputs that it needs besides what is displayed: what handles stand about, and what hair follows, where that is shown.
    pub fn wants(&self, state: &State) -> Vec<Socket> {
        let Some(shown) = &state.shown else { return vec![] };
        let mut wanted = handles::wants(state);
        let follows =
            self.options.guides || matches!(self.options.shown(), Show::Guides | Show::Clusters);
        if follows {
            wanted.extend(feeders(&state.document, shown.sockets.iter().map(|s| &s.node)));
        }
        wanted
    }

    /// One frame of the room, with another groom that has hair beside one's own, where two are compared.
    pub fn ui(
        &mut self,
        own: &State,
        other: Option<&State>,
        ui: &mut egui::Ui,
        out: &mut Vec<Event>,
    ) {
        let rect = ui.available_rect_before_wrap();
        let sides = self.sides(other);
        self.lay(sides, rect);
        let (states, state) = match (sides, other) {
            (Sides::Other, Some(other)) => ([None, Some(other)], other),
            _ => ([Some(own), other.filter(|_| sides != Sides::Own)], own),
        };
        let response = ui.interact(rect, projection::picture(ui), Sense::click_and_drag());
        response.widget_info(|| {
            egui::WidgetInfo::labeled(egui::WidgetType::Image, true, "Picture of the groom")
        });
        let on_hand = ui.input(|input| {
            let at = input.pointer.press_origin().or(input.pointer.latest_pos());
            at.is_none_or(|at| self.part.contains(at))
        });
        self.hovered = (response.hovered() || response.dragged()) && on_hand;
        self.follow_look(state, ui, out);
        self.frame_first(state);
        self.take_framing();
        self.take_pictures(ui.ctx());
        self.take_surroundings(out);
        self.take_answer(state, out);
        self.find_maker(state, out);
        self.navigate(state, ui, &response, out);
        self.ask_all(states, ui);
        self.paint(states, ui);
        let clip = ui.clip_rect();
        ui.set_clip_rect(clip.intersect(self.part));
        self.overlay_ui(state, ui, out);
        ui.set_clip_rect(clip);
        self.divide(sides, ui);
        hud::ui(self, state, ui, out);
        self.hover(state, ui, &response, out);
        self.menu(state, ui, &response, out);
    }

    /// Opens the menu of what is under the pointer, for keys.
    pub(crate) fn open_menu_by_key(&mut self) {
        self.menu.by_key = true;
    }

    /// Light and skin are kept with the groom: what the groom says is shown, what was chosen becomes its own, once a hand that
    /// drags has let go.
    fn follow_look(&mut self, state: &State, ui: &egui::Ui, out: &mut Vec<Event>) {
        if state.document.look != self.look {
            self.look = state.document.look.clone();
            self.options.take(self.look.as_ref());
            self.chosen = self.options.saved();
        } else if self.options.saved() != self.chosen && !ui.input(|input| input.pointer.any_down())
        {
            self.chosen = self.options.saved();
            self.look = Some(self.chosen.clone());
            out.push(Event::Edit(Edit::SetLook(self.look.clone())));
        }
    }

    /// Asks for one of the two pictures, of what is there now.
    fn ask(&mut self, number: usize, state: &State, ui: &egui::Ui) {
        let Some(shown) = &state.shown else { return };
        if !self.framed {
            return;
        }
        let show = self.options.shown();
        let followed = self.followed(number, state, shown);
        let moving = state.drags_hair() || self.is_navigating() || self.moves_until.is_some();
        // More of the hair comes soon, and sooner where the processor is left to it.
        let more_comes = shown.head_alone || shown.quality == Quality::FirstLook;
        let moving = moving || more_comes && state.run.since.is_some();
        let through = if self.pen.skin { SEE_THROUGH } else { 1.0 };
        let look = self.options.look();
        let wanted = DrawRequest {
            revision: shown.revision,
            hair: shown.curves.clone(),
            stands_for: shown.stands_for,
            // Lines over the picture are none of the picture.
            followed: if matches!(show, Show::Hair(_)) { Curves::default() } else { followed },
            scalps: shown.scalps.clone(),
            visibility: state.visibility.clone(),
            show,
            head: self.options.head,
            skin: self.options.skin(),
            files: files_of(state, shown),
            lights: self.options.lights(),
            exposure: self.options.exposure,
            transform: self.options.transform(),
            look: Look { opacity: look.opacity * through, ..look },
            camera: self.camera,
            size: pixels(self.rect.size(), ui.ctx().pixels_per_point()),
            samples: state.settings.samples.clamp(1, 1024),
            moving,
        };
        if let Some(drawing) = &mut self.panes[number].drawing {
            drawing.ask(wanted);
        }
    }

    /// The curves that hair follows, as far as they were evaluated.
    fn followed(&mut self, number: usize, state: &State, shown: &Arc<Shown>) -> Curves {
        let known = &mut self.panes[number].followed;
        let same = known.of.as_ref().is_some_and(|of| Arc::ptr_eq(of, shown));
        if !same {
            let sockets = feeders(&state.document, shown.sockets.iter().map(|s| &s.node));
            let curves = sockets.iter().filter_map(|socket| shown.curves_of(socket).cloned());
            *known = Followed { of: Some(shown.clone()), curves: together(curves) };
        }
        known.curves.clone()
    }

    /// Puts the newest pictures on the screen.
    fn take_pictures(&mut self, ctx: &egui::Context) {
        for number in 0..self.panes.len() {
            let began = Instant::now();
            if !self.panes[number].take(ctx, self.born) {
                continue;
            }
            let Some(screen) = &self.panes[number].on_screen else { continue };
            let (ends, revision) = (screen.drawn.ends, screen.drawn.wanted.revision);
            let stats = &mut self.stats;
            stats.pictures += 1;
            stats.texture_ms = began.elapsed().as_secs_f64() * 1e3;
            stats.drawn_ms = ends.ms();
            stats.uploaded_ms = (ends.uploaded - ends.began).as_secs_f64() * 1e3;
            if stats.newest.is_none_or(|(newest, ..)| newest != revision) {
                stats.newest = Some((revision, ends.uploaded, ends.drawn));
            }
        }
    }

    fn overlay_ui(&mut self, state: &State, ui: &mut egui::Ui, out: &mut Vec<Event>) {
        let view = self.projection();
        let number = self.number();
        let followed = &self.panes[number].followed.curves;
        self.overlay.ui(state, &self.options, followed, &view, ui);
        // Keys that turn the view leave grips alone.
        let turning = self.drag.is_some() || self.primary_moves(state, ui);
        let free = !turning && !self.pen.pointer;
        if self.options.handles && (free || self.handles.is_dragging()) {
            self.handles.ui(state, &view, self.options.head, ui, out);
        }
    }

    /// What the picture is, in one line: for the metadata of saved pictures.
    pub fn caption(&self, state: &State) -> String {
        let facts = hud::facts(self, state);
        facts
            .map_or(String::new(), |facts| format!("{}; {}", facts.made(), hud::names(self, state)))
    }
}

/// The mesh file of each head that is shown, where it has one.
fn files_of(state: &State, shown: &Shown) -> Vec<Option<PathBuf>> {
    let file = |scalp: &Arc<Scalp>| {
        let is_it =
            |value: &Value| matches!(value, Value::Scalp(other) if Arc::ptr_eq(scalp, other));
        let mut nodes = shown.values.iter().filter(|(_, value)| is_it(value));
        let folder = &state.file.folder;
        nodes.find_map(|(socket, _)| looks::file_of(&state.document, folder, &socket.node))
    };
    shown.scalps.iter().map(file).collect()
}

/// The pixels of a picture for a rectangle of the screen.
fn pixels(size: Vec2, per_point: f32) -> [u32; 2] {
    let size = (size * per_point).max(Vec2::splat(1.0));
    let longest = LONGEST / size.x.max(size.y);
    let many = (MOST_PIXELS / (size.x * size.y)).sqrt();
    let size = size * longest.min(many).min(1.0);
    [size.x.round().max(1.0) as u32, size.y.round().max(1.0) as u32]
}

#[cfg(test)]
mod tests;
