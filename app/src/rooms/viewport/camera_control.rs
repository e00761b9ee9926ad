//! Where the eye of the viewport stands: named views, framing, hands and keys that move it, and the way back.
//!
//! Places that need a look at all hair are found on a thread of their own. Guaranteed: views are no steps of the document.

use super::navigation::{self, Drag, Motion, Views};
use super::{CALM, NEAR, Viewport, input};
use crate::core::event::Event;
use crate::core::projection::Projection;
use crate::core::shown::{Shown, first_output};
use crate::core::state::State;
use coif_nodes::data::curves::Curves;
use coif_nodes::data::scalp::{HeadFrame, Scalp};
use coif_nodes::define::Value;
use coif_shaders::Camera;
use coif_shaders::camera::{self, Subject, Viewpoint};
use egui::{Key, Modifiers, PointerButton, Pos2, Response, Vec2};
use glam::Vec3;
use std::sync::mpsc::{TryRecvError, channel};

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

impl Viewport {
    /// Puts the eye before a groom that is seen first: before the head, and before all hair once that is made, unless a hand has
    /// moved the eye meanwhile.
    pub(super) fn frame_first(&mut self, state: &State) {
        let is_alone = state.shown.as_ref().is_some_and(|shown| shown.head_alone);
        if self.framed && !is_alone && state.shown.is_some() {
            let before = self.before_hair.take();
            self.framed = before.is_none_or(|before| before != self.camera);
        }
        if !self.framed && self.framing.is_none() && state.shown.is_some() {
            self.look_from("three-quarter", state);
            self.waits_for_hair = is_alone;
        }
    }

    fn aspect(&self) -> f32 {
        let seen = if self.beside { self.part } else { self.rect };
        (seen.width() / seen.height().max(1.0)).clamp(0.05, 20.0)
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

    /// Fills the picture with the heads: skull and face.
    pub fn frame_heads(&mut self, state: &State) {
        let Some(shown) = state.shown.clone() else { return };
        let (camera, aspect) = (self.camera, self.aspect());
        self.find(move || {
            let points = shown.scalps.iter().flat_map(|scalp| skull(scalp));
            navigation::fitted(&camera, points, aspect)
        });
    }

    /// Finds a place for the eye beside the window's thread, for there may be millions of points to look at.
    fn find(&mut self, place: impl FnOnce() -> Option<Camera> + Send + 'static) {
        let (send, receive) = channel();
        self.framing = Some(receive);
        // What was asked for last stays, hair or not.
        (self.before_hair, self.waits_for_hair) = (None, false);
        std::thread::spawn(move || {
            if let Some(camera) = place() {
                // Nobody waits for it any more when the window is closed.
                let _ = send.send(camera);
            }
        });
    }

    pub(super) fn take_framing(&mut self) {
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
                    self.before_hair = std::mem::take(&mut self.waits_for_hair).then_some(camera);
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

    pub(super) fn navigate(
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
        self.turn_light(ui, response, keys, space);
        if let Some((button, drag)) = self.drag {
            let (delta, at, from, down) = ui.input(|input| {
                let pointer = &input.pointer;
                let (at, from) = (pointer.interact_pos(), pointer.press_origin());
                (pointer.delta(), at, from, pointer.button_down(button))
            });
            if let (Some(at), true) = (at, delta != Vec2::ZERO) {
                let view = Projection::new(self.camera, self.rect);
                // A drag over the other picture moves the eye as it does over the one in hand.
                let at = at - self.off(from.unwrap_or(at));
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

    /// The light follows the pointer round the head. All of a drag is one step of the groom's look.
    fn turn_light(&mut self, ui: &egui::Ui, response: &Response, keys: Modifiers, space: bool) {
        let button = PointerButton::Secondary;
        if response.drag_started_by(button)
            && !self.pen.near
            && input::turns_light(button, keys, space)
        {
            self.turns_light = true;
        }
        if !self.turns_light {
            return;
        }
        let (by, down) =
            ui.input(|input| (input.pointer.delta().x, input.pointer.button_down(button)));
        self.options.turn_light(by * navigation::DEGREES_PER_POINT);
        self.turns_light = down;
        if down {
            ui.ctx().set_cursor_icon(egui::CursorIcon::ResizeHorizontal);
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
        let from = from.map(|at| at - self.off(at));
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
        let at = at.map(|at| at - self.off(at));
        self.camera = navigation::dolly(&self.camera, self.pivot(state, at), factor);
        self.moves_until = Some(now + CALM);
    }

    /// Whether the first button would move the eye now.
    pub(super) fn primary_moves(&self, state: &State, ui: &egui::Ui) -> bool {
        let typing = ui.ctx().egui_wants_keyboard_input();
        let space = !typing && ui.input(|input| input.key_down(Key::Space));
        let keys = ui.input(|input| input.modifiers);
        let settings = &state.settings;
        let (preset, ball) = (settings.navigation, settings.trackball);
        input::motion(preset, ball, PointerButton::Primary, keys, space).is_some()
    }
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
