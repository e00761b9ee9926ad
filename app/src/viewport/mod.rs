//! The viewport: the groom as it is, drawn beside the window, and the hands that turn it.
//!
//! Pictures come from a thread of their own ([`drawing`]); the window only puts the newest one on the screen. What one looks
//! at, and from where, is never part of a groom.
//!
//! Guaranteed: a frame never waits for a picture; without a graphics adapter everything else works, and the viewport says
//! why it is empty.

pub mod actions;
mod chrome;
pub mod drawing;
mod handles;
pub mod input;
pub mod navigation;
pub mod options;
mod overlay;
mod painter;
pub mod projection;
pub mod select;
pub mod status;

use crate::editor::evaluation::{Shown, first_output};
use crate::editor::event::Event;
use crate::editor::rooms::Room;
use crate::editor::state::{Select, State};
use crate::feeders::feeders;
use crate::pen::Holds;
use crate::scene::Show;
use coif_graphs::document::Socket;
use coif_nodes::data::curves::Curves;
use coif_nodes::data::scalp::{HeadFrame, Scalp};
use coif_nodes::define::Value;
use coif_shaders::Camera;
use coif_shaders::camera::{self, PORTRAIT_FOCAL, Subject, Viewpoint};
use drawing::{Drawing, Drawn, HairHit, Pick, Picked, Wanted};
use egui::{Key, PointerButton, Pos2, Rect, Response, Sense, TextureHandle, TextureOptions, Vec2};
use glam::Vec3;
use handles::Handles;
use navigation::{Drag, Motion, Views};
use options::Options;
use overlay::Overlay;
use painter::together;
use projection::Projection;
use select::Level;
use std::collections::BTreeSet;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, TryRecvError, channel};
use std::time::Instant;

/// Longest side and number of pixels of a picture: larger windows are drawn a little softer.
const LONGEST: f32 = 4096.0;
const MOST_PIXELS: f32 = 6.0e6;
/// After a step of the view it still counts as moving, seconds.
const CALM: f64 = 0.25;
/// The pointer is taken to be where it was asked about within so many points.
const NEAR: f32 = 6.0;

/// The room.
pub struct Viewport {
    /// How the groom is looked at.
    pub options: Options,
    /// What pictures cost, for the status line and tests.
    pub stats: DrawStats,
    /// What the pen has hold of, and is left alone here.
    pub pen: Holds,
    camera: Camera,
    views: Views,
    /// Whether the eye was put somewhere for this groom.
    framed: bool,
    framing: Option<Receiver<Camera>>,
    drawing: Option<Drawing>,
    fault: Option<String>,
    on_screen: Option<OnScreen>,
    rect: Rect,
    hovered: bool,
    drag: Option<(PointerButton, Drag)>,
    /// The view counts as moving until then, and came to rest when that is over.
    moves_until: Option<f64>,
    questions: u64,
    question: Option<Question>,
    under: Option<Under>,
    /// The curve that was clicked last and how much of its kin is selected.
    clicked: Option<Clicked>,
    followed: Followed,
    overlay: Overlay,
    handles: Handles,
    /// The name that the next saved view gets.
    view_name: String,
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

/// The picture on the screen.
struct OnScreen {
    texture: TextureHandle,
    drawn: Drawn,
}

/// Why it was asked what lies under the pointer.
#[derive(Clone, Copy, PartialEq)]
enum Purpose {
    Hover,
    /// Whether what is selected stays so.
    Click {
        more: bool,
    },
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
    picked: Picked,
}

struct Clicked {
    hair: HairHit,
    level: Level,
    /// It is not known yet which node made it.
    tracing: bool,
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
            stats: DrawStats::default(),
            pen: Holds::default(),
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
            drawing: None,
            fault: None,
            on_screen: None,
            rect: Rect::from_min_size(Pos2::ZERO, Vec2::new(900.0, 600.0)),
            drag: None,
            moves_until: None,
            questions: 0,
            question: None,
            under: None,
            clicked: None,
            followed: Followed::default(),
            overlay: Overlay::default(),
            handles: Handles::default(),
            view_name: String::new(),
        }
    }
}

impl Viewport {
    /// Begins to draw on a thread of its own, which asks the context to repaint. Until then the room shows no picture.
    pub fn start(&mut self, ctx: &egui::Context) {
        let ctx = ctx.clone();
        match Drawing::start(move || ctx.request_repaint()) {
            Ok(drawing) => self.drawing = Some(drawing),
            Err(why) => self.fault = Some(why),
        }
    }

    /// Forgets the eye's place: the next groom is framed anew.
    pub fn reset(&mut self) {
        self.framed = false;
        self.views = Views::default();
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
            self.on_screen.as_ref().map_or(self.camera, |s| s.drawn.wanted.camera),
            self.rect,
        )
    }

    /// Whether the pointer is over the picture itself and no widget on it, or drags it.
    pub fn is_hovered(&self) -> bool {
        self.hovered
    }

    /// Whether the pointer moves the eye now, and nothing else.
    pub fn is_navigating(&self) -> bool {
        self.drag.is_some()
    }

    /// Whether the picture at rest of what was asked for is on the screen.
    pub fn is_idle(&self) -> bool {
        self.drawing.as_ref().is_none_or(Drawing::is_idle)
            && self.framing.is_none()
            && !self.overlay.is_finding()
    }

    /// Why there is no picture.
    pub fn fault(&self) -> Option<String> {
        self.fault.clone().or_else(|| self.drawing.as_ref().and_then(Drawing::fault))
    }

    /// What lies under the pointer, where that is known.
    pub fn under_pointer(&self) -> Option<&Picked> {
        self.under.as_ref().map(|under| &under.picked)
    }

    /// Outputs that it needs besides what is displayed: what hair follows, where that is shown.
    pub fn wants(&self, state: &State) -> Vec<Socket> {
        let Some(shown) = &state.shown else { return vec![] };
        let mut wanted = vec![];
        let follows =
            self.options.guides || matches!(self.options.shown(), Show::Guides | Show::Clusters);
        if follows {
            wanted.extend(feeders(&state.document, shown.sockets.iter().map(|s| &s.node)));
        }
        wanted
    }

    /// One frame of the room.
    pub fn ui(&mut self, state: &State, ui: &mut egui::Ui, out: &mut Vec<Event>) {
        let rect = ui.available_rect_before_wrap();
        self.rect = rect;
        let response = ui.interact(rect, ui.id().with("picture"), Sense::click_and_drag());
        response.widget_info(|| {
            egui::WidgetInfo::labeled(egui::WidgetType::Image, true, "Picture of the groom")
        });
        self.hovered = response.hovered() || response.dragged();
        self.frame_first(state);
        self.take_framing();
        self.take_picture(ui.ctx());
        self.take_answer(state, out);
        self.find_maker(state, out);
        self.navigate(state, ui, &response, out);
        self.ask(state, ui);
        self.paint(state, ui);
        self.overlay_ui(state, ui, out);
        chrome::ui(self, state, ui, out);
        self.hover(state, ui, &response, out);
    }

    // --- where the eye stands -------------------------------------------------------------------

    /// Puts the eye before a groom that is seen first.
    fn frame_first(&mut self, state: &State) {
        if !self.framed && self.framing.is_none() && state.shown.is_some() {
            self.look_from("three-quarter", state);
        }
    }

    fn aspect(&self) -> f32 {
        (self.rect.width() / self.rect.height().max(1.0)).clamp(0.05, 20.0)
    }

    /// Looks from a named view as soon as it is known where that is.
    pub fn look_from(&mut self, name: &str, state: &State) {
        let (Some(view), Some(shown)) = (Viewpoint::named(name), state.shown.clone()) else {
            return;
        };
        let (focal, aspect) = (self.camera.focal_mm, self.aspect());
        let flat = self.camera.orthographic.is_some();
        self.find(move || {
            let scalp = shown.scalp();
            let subject = Subject {
                frame: scalp.map_or(HeadFrame::IDENTITY, |scalp| *scalp.frame()),
                surface: scalp.map(|scalp| scalp.surface()),
                hair: &shown.curves,
            };
            let camera = camera::frame(&view, &subject, focal, aspect);
            Some(navigation::with_parallel_rays(&camera, flat))
        });
    }

    /// Fills the picture with the selected curves, else with what the active node gives, else with everything.
    pub fn frame_selected(&mut self, state: &State) {
        let Some(shown) = state.shown.clone() else { return };
        let selected = state.selection.curves.clone();
        let socket = state.active().and_then(|id| first_output(&state.document, id));
        let (camera, aspect) = (self.camera, self.aspect());
        self.find(move || {
            let chosen = |curves: &Curves| -> Vec<Vec3> {
                let named = curves.each().filter(|(tuft, i)| selected.contains(&tuft.id(*i)));
                named.flat_map(|(tuft, i)| tuft.curve(i).to_vec()).collect()
            };
            let mut points = if selected.is_empty() { vec![] } else { chosen(&shown.curves) };
            if points.is_empty() {
                points = match socket.and_then(|socket| shown.values.get(&socket)) {
                    Some(Value::Curves(curves)) => points_of(curves),
                    Some(Value::Scalp(scalp)) => scalp.surface().points.clone(),
                    _ => vec![],
                };
            }
            if points.is_empty() {
                points = everything(&shown);
            }
            navigation::fitted(&camera, points.into_iter(), aspect)
        });
    }

    /// Fills the picture with everything.
    pub fn frame_all(&mut self, state: &State) {
        let Some(shown) = state.shown.clone() else { return };
        let (camera, aspect) = (self.camera, self.aspect());
        self.find(move || navigation::fitted(&camera, everything(&shown).into_iter(), aspect));
    }

    /// Finds a place for the eye beside the window's thread, for there may be millions of points to look at.
    fn find(&mut self, place: impl FnOnce() -> Option<Camera> + Send + 'static) {
        let (send, receive) = channel();
        self.framing = Some(receive);
        std::thread::spawn(move || {
            if let Some(camera) = place() {
                // Nobody waits for it any more when the window is closed.
                let _ = send.send(camera);
            }
        });
    }

    fn take_framing(&mut self) {
        let Some(receive) = &self.framing else { return };
        match receive.try_recv() {
            Ok(camera) => {
                self.framing = None;
                if self.framed {
                    self.look(camera);
                } else {
                    // The first view of a groom has none before it.
                    self.camera = camera;
                    self.views = Views::default();
                    self.views.rest(&camera);
                    self.framed = true;
                }
            }
            Err(TryRecvError::Empty) => {}
            Err(TryRecvError::Disconnected) => {
                self.framing = None;
                self.framed = true;
            }
        }
    }

    /// The view before this one, or after it.
    pub fn go(&mut self, forward: bool) {
        let found = if forward { self.views.forward() } else { self.views.back() };
        if let Some(camera) = found {
            self.camera = camera;
        }
    }

    /// Whether there is a view before this one, and one after it.
    pub fn ways(&self) -> (bool, bool) {
        self.views.ways()
    }

    /// A step of the view by a key: the eye moves, and rests a moment later.
    pub fn step(&mut self, state: &State, now: f64, step: Step) {
        let pivot = self.pivot(state, None);
        let up = self.vertical(state);
        let view = Projection::new(self.camera, self.rect);
        self.camera = match step {
            Step::Orbit { around, over } => {
                navigation::orbit(&self.camera, pivot, up, around, over)
            }
            Step::Pan(part) => navigation::pan(&view, pivot, part * self.rect.size()),
            Step::Zoom(factor) => navigation::dolly(&self.camera, pivot, factor),
        };
        self.moves_until = Some(now + CALM);
    }

    fn vertical(&self, state: &State) -> Vec3 {
        let scalp = state.shown.as_ref().and_then(|shown| shown.scalp());
        navigation::vertical(scalp.map(|scalp| scalp.frame()))
    }

    /// What a turn is about: what is seen at a place, else the skin there, else a point as far away as what is looked at.
    fn pivot(&self, state: &State, at: Option<Pos2>) -> Vec3 {
        let view = Projection::new(self.camera, self.rect);
        let at = at.unwrap_or(self.rect.center());
        let known = self
            .under
            .as_ref()
            .filter(|under| under.at.distance(at) < NEAR && under.camera == self.camera);
        if let Some(place) = known.and_then(|under| under.picked.place()) {
            return place;
        }
        let ray = view.ray(at);
        let scalps = state.shown.iter().flat_map(|shown| &shown.scalps);
        let hits = scalps.filter_map(|s| s.surface().ray(ray.origin, ray.direction, 1e5));
        let nearest = hits.min_by(|a, b| a.distance.total_cmp(&b.distance));
        nearest.map_or_else(
            || view.at_depth(at, view.depth(self.camera.target).max(navigation::NEAREST)),
            |hit| hit.point,
        )
    }

    fn navigate(
        &mut self,
        state: &State,
        ui: &egui::Ui,
        response: &Response,
        out: &mut Vec<Event>,
    ) {
        let now = ui.input(|input| input.time);
        let typing = ui.ctx().egui_wants_keyboard_input();
        let space = !typing && ui.input(|input| input.key_down(Key::Space));
        let keys = ui.input(|input| input.modifiers);
        let settings = &state.settings;
        for button in [PointerButton::Primary, PointerButton::Middle, PointerButton::Secondary] {
            // The other buttons of a pen are on its barrel.
            let barrel = self.pen.near && button != PointerButton::Primary;
            let motion =
                || input::motion(settings.navigation, settings.trackball, button, keys, space);
            let barrel = barrel.then(|| input::barrel_motion(settings.trackball, keys));
            if response.drag_started_by(button)
                && let Some(motion) = motion().or(barrel)
            {
                self.begin_motion(state, motion, button, ui);
            }
        }
        if let Some((button, drag)) = self.drag {
            let (delta, at, down) = ui.input(|input| {
                let pointer = &input.pointer;
                (pointer.delta(), pointer.interact_pos(), pointer.button_down(button))
            });
            if let (Some(at), true) = (at, delta != Vec2::ZERO) {
                let view = Projection::new(self.camera, self.rect);
                self.camera = drag.moved(&view, at - delta, at);
            }
            if !down {
                self.drag = None;
                self.views.rest(&self.camera);
            }
        }
        if response.hovered() && self.drag.is_none() && !self.pen.wheel {
            self.wheel(state, ui, now);
            let pressed = |button| ui.input(|input| input.pointer.button_pressed(button));
            for (button, action) in
                [(PointerButton::Extra1, "view.back"), (PointerButton::Extra2, "view.forward")]
            {
                if pressed(button) {
                    out.push(Event::Act(action));
                }
            }
        }
        if self.moves_until.is_some_and(|until| now >= until) {
            self.moves_until = None;
            self.views.rest(&self.camera);
        }
        if self.moves_until.is_some() {
            ui.ctx().request_repaint_after(std::time::Duration::from_secs_f64(CALM));
        }
    }

    /// Begins to move the eye about what lies under the pointer. The button ends it.
    pub fn begin_motion(
        &mut self,
        state: &State,
        motion: Motion,
        button: PointerButton,
        ui: &egui::Ui,
    ) {
        let from = ui.input(|input| input.pointer.press_origin().or(input.pointer.interact_pos()));
        let drag = Drag { motion, pivot: self.pivot(state, from), up: self.vertical(state) };
        self.views.rest(&self.camera);
        self.drag = Some((button, drag));
    }

    fn wheel(&mut self, state: &State, ui: &egui::Ui, now: f64) {
        let (scroll, pinch, at) = ui.input(|input| {
            (input.smooth_scroll_delta().y, input.zoom_delta(), input.pointer.hover_pos())
        });
        let factor = input::wheel_factor(scroll) / pinch.max(0.01);
        if (factor - 1.0).abs() < 1e-5 {
            return;
        }
        if self.moves_until.is_none() {
            self.views.rest(&self.camera);
        }
        self.camera = navigation::dolly(&self.camera, self.pivot(state, at), factor);
        self.moves_until = Some(now + CALM);
    }

    // --- pictures -------------------------------------------------------------------------------

    /// Asks for the picture of what is there now.
    fn ask(&mut self, state: &State, ui: &egui::Ui) {
        let Some(shown) = &state.shown else { return };
        if !self.framed {
            return;
        }
        let show = self.options.shown();
        let followed = self.followed(state, shown);
        let moving = state.gesture || self.drag.is_some() || self.moves_until.is_some();
        let wanted = Wanted {
            revision: shown.revision,
            hair: shown.curves.clone(),
            // Lines over the picture are none of the picture.
            followed: if matches!(show, Show::Hair(_)) { Curves::default() } else { followed },
            scalps: shown.scalps.clone(),
            visibility: state.visibility.clone(),
            show,
            head: self.options.head,
            tone: self.options.tone(),
            rig: self.options.rig(),
            exposure: self.options.exposure,
            transform: self.options.transform(),
            look: self.options.look(),
            camera: self.camera,
            size: pixels(self.rect.size(), ui.ctx().pixels_per_point()),
            samples: state.settings.samples.clamp(1, 1024),
            moving,
        };
        if let Some(drawing) = &mut self.drawing {
            drawing.ask(wanted);
        }
    }

    /// The curves that hair follows, as far as they were evaluated.
    fn followed(&mut self, state: &State, shown: &Arc<Shown>) -> Curves {
        let same = self.followed.of.as_ref().is_some_and(|of| Arc::ptr_eq(of, shown));
        if !same {
            let sockets = feeders(&state.document, shown.sockets.iter().map(|s| &s.node));
            let curves = sockets.iter().filter_map(|socket| shown.curves_of(socket).cloned());
            self.followed = Followed { of: Some(shown.clone()), curves: together(curves) };
        }
        self.followed.curves.clone()
    }

    /// Puts the newest picture on the screen.
    fn take_picture(&mut self, ctx: &egui::Context) {
        let Some(drawn) = self.drawing.as_ref().and_then(Drawing::take) else { return };
        let began = Instant::now();
        let image = egui::ImageData::Color(drawn.image.clone());
        let texture = match self.on_screen.take() {
            Some(OnScreen { mut texture, .. }) => {
                texture.set(image, TextureOptions::LINEAR);
                texture
            }
            None => ctx.load_texture("picture of the groom", image, TextureOptions::LINEAR),
        };
        let stats = &mut self.stats;
        stats.pictures += 1;
        stats.texture_ms = began.elapsed().as_secs_f64() * 1e3;
        stats.drawn_ms = drawn.ends.ms();
        stats.uploaded_ms = (drawn.ends.uploaded - drawn.ends.began).as_secs_f64() * 1e3;
        let revision = drawn.wanted.revision;
        if stats.newest.is_none_or(|(newest, ..)| newest != revision) {
            stats.newest = Some((revision, drawn.ends.uploaded, drawn.ends.drawn));
        }
        self.on_screen = Some(OnScreen { texture, drawn });
    }

    fn paint(&self, state: &State, ui: &egui::Ui) {
        let painter = ui.painter_at(self.rect);
        painter.rect_filled(self.rect, 0.0, crate::editor::theme::SUNKEN);
        let Some(OnScreen { texture, drawn }) = &self.on_screen else { return };
        if state.shown.is_none() {
            return;
        }
        // After a change of size the last picture keeps its shape until the next one comes.
        let [width, height] = drawn.wanted.size.map(|n| n as f32);
        let scale = self.rect.height() / height.max(1.0);
        let place = Rect::from_center_size(self.rect.center(), Vec2::new(width, height) * scale);
        let whole = Rect::from_min_max(Pos2::ZERO, Pos2::new(1.0, 1.0));
        painter.image(texture.id(), place, whole, egui::Color32::WHITE);
    }

    // --- what lies under the pointer ------------------------------------------------------------

    fn question(&mut self, at: Pos2, purpose: Purpose) {
        let (Some(drawing), Some(screen)) = (&self.drawing, &self.on_screen) else { return };
        let camera = screen.drawn.wanted.camera;
        let view = Projection::new(camera, self.rect);
        let part = (at - self.rect.min) / self.rect.size();
        self.questions += 1;
        drawing.pick(Pick {
            number: self.questions,
            at: [part.x, part.y],
            ray: view.ray(at),
            camera,
        });
        self.question = Some(Question { number: self.questions, purpose, at });
    }

    fn hover(&mut self, state: &State, ui: &egui::Ui, response: &Response, out: &mut Vec<Event>) {
        let held = self.drag.is_some() || self.handles.is_dragging() || self.pen.pointer;
        let at = response.hover_pos().filter(|_| response.hovered() && !held);
        let Some(at) = at else {
            self.under = None;
            return;
        };
        let keys = ui.input(|input| input.modifiers);
        if response.clicked() && !self.primary_moves(state, ui) {
            out.push(Event::Focus(Room::Viewport));
            self.question(at, Purpose::Click { more: keys.shift });
        } else if self.question.is_none()
            && self.moves_until.is_none()
            && !state.gesture
            && self.under.as_ref().is_none_or(|under| under.at != at || under.camera != self.camera)
        {
            self.question(at, Purpose::Hover);
        }
        if self.options.card
            && let Some(under) = self.under.as_ref().filter(|under| under.at.distance(at) < NEAR)
            && let Some(hair) = &under.picked.hair
        {
            response.clone().on_hover_ui_at_pointer(|ui| chrome::card(hair, ui));
        }
    }

    fn take_answer(&mut self, state: &State, out: &mut Vec<Event>) {
        let Some(picked) = self.drawing.as_ref().and_then(Drawing::picked) else { return };
        let Some(question) = self.question.take_if(|q| q.number <= picked.number) else { return };
        let camera = self.on_screen.as_ref().map_or(self.camera, |s| s.drawn.wanted.camera);
        if let Purpose::Click { more } = question.purpose {
            self.clicked_on(state, picked.hair.clone(), more, out);
        }
        self.under = Some(Under { at: question.at, camera, picked });
    }

    /// Selects the curve that was clicked; the same again, more of its kin.
    fn clicked_on(
        &mut self,
        state: &State,
        hair: Option<HairHit>,
        more: bool,
        out: &mut Vec<Event>,
    ) {
        let Some((hair, shown)) = hair.zip(state.shown.as_ref()) else {
            self.clicked = None;
            if !more {
                out.push(Event::Select(Select::Curves(BTreeSet::new())));
            }
            return;
        };
        let again = self.clicked.as_ref().filter(|clicked| {
            clicked.hair.id() == hair.id() && state.selection.curves.contains(&hair.id())
        });
        let of = (&*hair.tuft, hair.curve);
        let (level, ids) = match again {
            Some(clicked) => {
                let made = self.made_by_active(state, shown);
                select::next_level(&shown.curves, of, clicked.level, made)
            }
            None => (Level::Hair, [hair.id()].into()),
        };
        let mut selected = ids;
        if more && again.is_none() {
            selected.extend(&state.selection.curves);
        }
        out.push(Event::Select(Select::Curves(selected)));
        out.push(Event::Trace(hair.id()));
        self.clicked = Some(Clicked { hair, level, tracing: true });
    }

    /// Selects the node that made the clicked curve, once it is known.
    fn find_maker(&mut self, state: &State, out: &mut Vec<Event>) {
        let Some(clicked) = self.clicked.as_mut().filter(|clicked| clicked.tracing) else { return };
        if let Some(made) = state.traced.first().filter(|made| made.id == clicked.hair.id()) {
            clicked.tracing = false;
            out.push(Event::Select(Select::Nodes(vec![made.node.clone()])));
        }
    }

    /// All that the active node gives.
    fn made_by_active<'a>(&self, state: &State, shown: &'a Shown) -> Option<&'a Curves> {
        let socket = first_output(&state.document, state.active()?)?;
        shown.curves_of(&socket)
    }

    /// How much the last click took, for the status line.
    fn taken(&self) -> Option<Level> {
        self.clicked.as_ref().map(|clicked| clicked.level)
    }

    fn overlay_ui(&mut self, state: &State, ui: &mut egui::Ui, out: &mut Vec<Event>) {
        let view = self.projection();
        self.overlay.ui(state, &self.options, &self.followed.curves, &view, ui);
        // Keys that turn the view leave grips alone.
        let turning = self.drag.is_some() || self.primary_moves(state, ui);
        let free = !turning && !self.pen.pointer;
        if self.options.handles && (free || self.handles.is_dragging()) {
            self.handles.ui(state, &view, ui, out);
        }
    }

    /// Whether the first button would move the eye now.
    fn primary_moves(&self, state: &State, ui: &egui::Ui) -> bool {
        let typing = ui.ctx().egui_wants_keyboard_input();
        let space = !typing && ui.input(|input| input.key_down(Key::Space));
        let keys = ui.input(|input| input.modifiers);
        let settings = &state.settings;
        let (preset, ball) = (settings.navigation, settings.trackball);
        input::motion(preset, ball, PointerButton::Primary, keys, space).is_some()
    }

    /// What the picture is, in one line: for the metadata of saved pictures.
    pub fn caption(&self, state: &State) -> String {
        let facts = chrome::facts(self, state);
        facts.map_or(String::new(), |facts| {
            format!("{}; {}", facts.made(), chrome::names(self, state))
        })
    }
}

/// A step of the view by a key.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Step {
    /// Degrees about the vertical and over the top.
    Orbit {
        /// To the eye's right.
        around: f32,
        /// Up.
        over: f32,
    },
    /// Parts of the picture that what is seen moves by, to the right and down.
    Pan(Vec2),
    /// What the distance is multiplied by.
    Zoom(f32),
}

/// The pixels of a picture for a rectangle of the screen.
fn pixels(size: Vec2, per_point: f32) -> [u32; 2] {
    let size = (size * per_point).max(Vec2::splat(1.0));
    let longest = LONGEST / size.x.max(size.y);
    let many = (MOST_PIXELS / (size.x * size.y)).sqrt();
    let size = size * longest.min(many).min(1.0);
    [size.x.round().max(1.0) as u32, size.y.round().max(1.0) as u32]
}

fn points_of(curves: &Curves) -> Vec<Vec3> {
    curves.tufts().iter().flat_map(|tuft| tuft.points().iter().copied()).collect()
}

/// All hair, or the heads where there is none.
fn everything(shown: &Shown) -> Vec<Vec3> {
    let mut points = points_of(&shown.curves);
    for scalp in &shown.scalps {
        points.extend(skull(scalp));
    }
    points
}

/// What of a head is in every picture: skull and face, not the body under them.
fn skull(scalp: &Scalp) -> Vec<Vec3> {
    let frame = scalp.frame();
    let near = |p: &Vec3| p.distance(frame.origin) < 1.8 * frame.radius;
    let points: Vec<Vec3> = scalp.surface().points.iter().copied().filter(near).collect();
    if points.is_empty() { scalp.surface().points.clone() } else { points }
}

#[cfg(test)]
mod tests;
