//! All pens, mice and fingers as one stream of samples.
//!
//! Pens come from X11 (`x11.rs`), pens and fingers of touch screens from egui's touches, whose force is the pressure, and
//! everything else from egui's pointer, with a pressure of choice. A pen also moves egui's pointer; those pointer
//! events are known by where they are and left out here, so nothing is drawn twice. Palms: a finger counts only
//! while no pen is near.
//!
//! winit 0.30 has no tablets under Wayland: where the X server beside it knows a pen when the editor starts, the window is a
//! client of XWayland; else a pen is a mouse there, and the settings of pens say so. On macOS it is a mouse, too.

use super::sample::{Buttons, Device, MOUSE, PenSample, Phase, Tool};
use super::x11::{self, PenMessage};
use crate::core::pen::{self, Feel, PenSettings};
use eframe::wgpu::rwh::{HasWindowHandle, RawWindowHandle};
use egui::{Event, PointerButton, Pos2, TouchPhase};
use std::collections::VecDeque;
use std::sync::mpsc::Receiver;

/// How long after its last word a pen that has not said that it left counts as near, seconds. A held pen trembles and
/// so goes on telling.
const NEAR_FOR: f64 = 1.0;
/// How far egui's pointer may be from where a pen was and be the pen's own, points.
pub(super) const SAME_PLACE: f32 = 8.0;
/// How soon the second tap of a double tap comes, seconds.
const DOUBLE_TAP: f64 = 0.4;

/// What is plugged in, and where it is.
#[derive(Default)]
pub struct Devices {
    x11: Option<Receiver<PenMessage>>,
    why_not: String,
    pens: Vec<x11::PenDevice>,
    /// Reports that wait for the next frame.
    waiting: Vec<PenSample>,
    /// The pen that spoke last: when on egui's clock.
    near: Option<f64>,
    /// Where pens were of late, and when: egui's pointer follows them, a frame or more behind.
    trail: VecDeque<(f64, Pos2)>,
    finger: Option<u64>,
    fingers: usize,
    mouse: Mouse,
    hand: Hand,
}

#[derive(Clone, Copy, Debug, Default)]
struct Mouse {
    down: bool,
    buttons: Buttons,
    pos: Pos2,
    before: f64,
}

/// A report as tools get it: pressure through the curve, place through the stabiliser.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Input {
    /// The report.
    pub sample: PenSample,
    /// Whether it is the second touch of a double tap.
    pub double_tap: bool,
    /// Held in the left hand.
    pub left_handed: bool,
}

/// Whether a report of a device counts, by what is known of the pen: palms and the pen's own shadow do not.
fn counts(tool: Tool, pen_near: bool, at_the_pen: bool, fingers_draw: bool) -> bool {
    match tool {
        Tool::Tip | Tool::Eraser => true,
        Tool::Finger => fingers_draw && !pen_near,
        // Also just after the pen has left: the pointer comes late.
        Tool::Mouse => !at_the_pen,
    }
}

/// What of egui's input matters here.
pub struct Frame<'a> {
    /// The events, in order.
    pub events: &'a [Event],
    /// Seconds on egui's clock.
    pub time: f64,
    /// Physical pixels in a point.
    pub pixels_per_point: f32,
    /// Whether Shift is held: full pressure of the mouse.
    pub shift: bool,
}

impl Devices {
    /// Listens to the pens of an X server, on the window that eframe made (`CreationContext` and `Frame` are
    /// handles of it). [`Self::why_not`] says why there are none.
    pub fn connect(&mut self, window: &dyn HasWindowHandle, ctx: &egui::Context) {
        let window = match window.window_handle().map(|handle| handle.as_raw()) {
            Ok(RawWindowHandle::Xlib(handle)) => u32::try_from(handle.window).ok(),
            Ok(RawWindowHandle::Xcb(handle)) => Some(handle.window.get()),
            Ok(RawWindowHandle::Wayland(_)) => {
                self.why_not =
                    "Under Wayland pens have no pressure here. Plug the pen in and start coif \
                     again: it then draws through XWayland, with pressure."
                        .to_owned();
                None
            }
            _ => None,
        };
        let Some(window) = window else { return };
        let ctx = ctx.clone();
        match x11::listen(window, move || ctx.request_repaint()) {
            Ok(told) => self.x11 = Some(told),
            Err(why) => self.why_not = format!("The X server does not tell of pens: {why}"),
        }
    }

    /// Why no pen can have pressure, where that is so; else empty.
    pub fn why_not(&self) -> &str {
        &self.why_not
    }

    /// Names of the pens that are plugged in.
    pub fn pens(&self) -> impl Iterator<Item = &str> {
        self.pens.iter().map(|pen| pen.name.as_str())
    }

    /// Whether a pen was near when the last frame was made.
    pub fn is_near(&self) -> bool {
        self.near.is_some_and(|when| self.mouse.before - when < NEAR_FOR)
    }

    /// Hands in a report, as a backend does. `pos` is in points.
    pub fn push(&mut self, sample: PenSample) {
        self.waiting.push(sample);
    }

    /// All reports since the last frame, in order, those that do not count left out.
    pub fn poll(&mut self, frame: &Frame, settings: &PenSettings) -> Vec<Input> {
        for told in self.x11.iter().flat_map(|told| told.try_iter()) {
            match told {
                PenMessage::Pens(pens) => self.pens = pens,
                PenMessage::Sample(sample) => self.waiting.push(PenSample {
                    pos: (sample.pos.to_vec2() / frame.pixels_per_point).to_pos2(),
                    ..sample
                }),
            }
        }
        let mut reports = std::mem::take(&mut self.waiting);
        for sample in &reports {
            if matches!(sample.tool, Tool::Tip | Tool::Eraser) {
                self.near = (sample.phase != Phase::Out).then_some(frame.time);
                self.trail.push_back((frame.time, sample.pos));
            }
        }
        while self.trail.front().is_some_and(|(when, _)| frame.time - when >= NEAR_FOR) {
            self.trail.pop_front();
        }
        self.of_egui(frame, settings, &mut reports);
        let near = self.near.is_some_and(|when| frame.time - when < NEAR_FOR);
        let mut inputs = vec![];
        for sample in reports {
            let on_trail = |(_, pos): &(f64, Pos2)| pos.distance(sample.pos) < SAME_PLACE;
            let at_the_pen = sample.tool == Tool::Mouse && self.trail.iter().any(on_trail);
            // What has begun ends, whatever comes near meanwhile.
            let begun = self.hand.holds == Some(sample.device);
            if begun || counts(sample.tool, near, at_the_pen, settings.fingers_draw) {
                let feel = self.feel(&sample, settings);
                inputs.extend(self.hand.take(sample, &feel));
            }
        }
        inputs
    }

    fn feel(&self, sample: &PenSample, settings: &PenSettings) -> Feel {
        let pen = self.pens.iter().find(|pen| pen.device == sample.device);
        settings.feel(match (pen, sample.device) {
            (Some(pen), _) => &pen.name,
            (None, MOUSE) => pen::MOUSE,
            (None, _) => pen::TOUCH,
        })
    }

    /// Egui's touches and its pointer as reports.
    fn of_egui(&mut self, frame: &Frame, settings: &PenSettings, reports: &mut Vec<PenSample>) {
        let pressure = if frame.shift { 1.0 } else { settings.mouse_pressure.clamp(0.0, 1.0) };
        let span = (frame.time - self.mouse.before).clamp(0.0, 0.1);
        let count = frame.events.len().max(1) as f64;
        for (i, event) in frame.events.iter().enumerate() {
            // egui tells the time of the frame only: its events are spread over it.
            let time = frame.time - span + span * (i + 1) as f64 / count;
            match event {
                Event::Touch { id, phase, pos, force, .. } => {
                    reports.extend(self.touch(time, id.0, *phase, *pos, *force));
                }
                // egui makes a pointer of the first finger, too.
                _ if self.fingers > 0 => {}
                Event::PointerMoved(pos) => {
                    self.mouse.pos = *pos;
                    let phase = if self.mouse.down { Phase::Move } else { Phase::Hover };
                    reports.push(self.mouse.report(time, phase, pressure));
                }
                Event::PointerButton { pos, button, pressed, .. } => {
                    self.mouse.pos = *pos;
                    match button {
                        PointerButton::Primary => {
                            let was = std::mem::replace(&mut self.mouse.down, *pressed);
                            if was != *pressed {
                                let phase = if *pressed { Phase::Down } else { Phase::Up };
                                reports.push(self.mouse.report(time, phase, pressure));
                            }
                        }
                        PointerButton::Secondary => self.mouse.buttons.barrel = *pressed,
                        PointerButton::Middle => self.mouse.buttons.second = *pressed,
                        _ => {}
                    }
                }
                // A held button goes on telling from outside the window; its release is told, too.
                Event::PointerGone if !self.mouse.down => {
                    reports.push(self.mouse.report(time, Phase::Out, 0.0));
                }
                Event::WindowFocused(false) if self.mouse.down => {
                    self.mouse.down = false;
                    reports.push(self.mouse.report(time, Phase::Up, pressure));
                }
                _ => {}
            }
        }
        self.mouse.before = frame.time;
    }

    /// A touch as a report: of a pen when it has force, else of the one finger that counts. More fingers are a gesture of
    /// the view, and what the first has begun is taken back.
    fn touch(
        &mut self,
        time: f64,
        id: u64,
        phase: TouchPhase,
        pos: Pos2,
        force: Option<f32>,
    ) -> Option<PenSample> {
        let tool = if force.is_some() { Tool::Tip } else { Tool::Finger };
        let phase = match phase {
            TouchPhase::Start => {
                self.fingers += 1;
                if self.fingers > 1 { Phase::Out } else { Phase::Down }
            }
            TouchPhase::Move => Phase::Move,
            TouchPhase::End => Phase::Up,
            TouchPhase::Cancel => Phase::Out,
        };
        if phase == Phase::Down {
            self.finger = Some(id);
        }
        if matches!(phase, Phase::Up) || (phase == Phase::Out && self.finger == Some(id)) {
            self.fingers = self.fingers.saturating_sub(1);
        }
        let second = phase == Phase::Out && self.fingers > 1;
        let first = self.finger.filter(|first| *first == id || second)?;
        if matches!(phase, Phase::Up | Phase::Out) {
            self.finger = None;
        }
        let force = force.unwrap_or(0.5);
        Some(PenSample {
            pressure: if force.is_finite() { force.clamp(0.0, 1.0) } else { 0.5 },
            tool,
            // Any number that no pen of X11 and no mouse has.
            device: Device(0x4000_0000 | first as u32 & 0xffff),
            ..PenSample::mouse(time, phase, pos, 0.0)
        })
    }
}

impl Mouse {
    fn report(&self, time: f64, phase: Phase, pressure: f32) -> PenSample {
        PenSample { buttons: self.buttons, ..PenSample::mouse(time, phase, self.pos, pressure) }
    }
}

/// The hand on the one device that is used now.
#[derive(Clone, Copy, Debug, Default)]
struct Hand {
    /// Which device touches.
    holds: Option<Device>,
    /// Where the steadied line is, and when.
    line: Option<(f64, Pos2)>,
    pressure: f32,
    /// The last touch: when it began, and where.
    tap: Option<(f64, Pos2)>,
    double_tap: bool,
}

impl Hand {
    /// The report as tools get it; none of a device that has to wait until another has ended. A pen need not wait
    /// for mice and fingers: what they have begun ends as if they had left.
    fn take(&mut self, sample: PenSample, feel: &Feel) -> Vec<Input> {
        let input =
            |sample, double_tap| Input { sample, double_tap, left_handed: feel.left_handed };
        let mut inputs = vec![];
        if let Some(device) = self.holds.filter(|device| *device != sample.device) {
            let pen = matches!(sample.tool, Tool::Tip | Tool::Eraser);
            if !pen || sample.phase != Phase::Down {
                return vec![];
            }
            self.holds = None;
            inputs.push(input(PenSample { phase: Phase::Out, device, ..sample }, false));
        }
        let held = self.holds == Some(sample.device);
        let phase = match sample.phase {
            // A second press without a release, or a movement of what never came down.
            Phase::Down if held => Phase::Move,
            Phase::Move if !held => Phase::Hover,
            Phase::Up if !held => Phase::Hover,
            phase => phase,
        };
        let (lag, raw) = (feel.lag(), sample.pos);
        let mut pos = raw;
        match phase {
            Phase::Down => {
                let near = |(when, at): (f64, Pos2)| {
                    (0.0..DOUBLE_TAP).contains(&(sample.time - when))
                        && at.distance(raw) <= feel.double_tap
                };
                self.double_tap = self.tap.is_some_and(near);
                self.tap = (!self.double_tap).then_some((sample.time, raw));
                (self.holds, self.line) = (Some(sample.device), Some((sample.time, raw)));
            }
            Phase::Move if lag > 0.0 => {
                let (before, at) = self.line.unwrap_or((sample.time, raw));
                let part = 1.0 - (-(sample.time - before).max(0.0) / lag).exp();
                pos = at + (raw - at) * part as f32;
                self.line = Some((sample.time, pos));
            }
            Phase::Up | Phase::Out => self.holds = None,
            _ => {}
        }
        // What is reported while lifting is the lifting, not the stroke.
        if matches!(phase, Phase::Down | Phase::Move) {
            self.pressure = feel.pressure(sample.pressure);
        }
        let pressure = match phase {
            Phase::Hover | Phase::Out => 0.0,
            _ => self.pressure,
        };
        inputs.push(input(PenSample { phase, pos, pressure, ..sample }, self.double_tap));
        inputs
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const PEN: Device = Device(9);

    fn pen(time: f64, phase: Phase, x: f32, pressure: f32) -> PenSample {
        let pos = Pos2::new(x, 50.0);
        PenSample {
            pressure,
            tool: Tool::Tip,
            device: PEN,
            ..PenSample::mouse(time, phase, pos, 0.0)
        }
    }
    fn frame(time: f64, events: &[Event]) -> Frame<'_> {
        Frame { events, time, pixels_per_point: 1.0, shift: false }
    }
    fn plain() -> PenSettings {
        let feel = Feel { stabiliser: 0.0, ..Feel::default() };
        PenSettings { devices: [(pen::TOUCH.to_owned(), feel)].into(), ..PenSettings::default() }
    }
    fn press(x: f32, pressed: bool) -> Event {
        Event::PointerButton {
            pos: Pos2::new(x, 50.0),
            button: PointerButton::Primary,
            pressed,
            modifiers: Default::default(),
        }
    }
    fn touch(id: u64, phase: TouchPhase, x: f32, force: Option<f32>) -> Event {
        let pos = Pos2::new(x, 50.0);
        Event::Touch { device_id: egui::TouchDeviceId(0), id: egui::TouchId(id), phase, pos, force }
    }
    fn phases(inputs: &[Input]) -> Vec<(Tool, Phase)> {
        inputs.iter().map(|input| (input.sample.tool, input.sample.phase)).collect()
    }

    #[test]
    fn palms_and_the_pens_own_pointer_do_not_count() {
        // Tool, pen near, at the pen, fingers draw -> counts.
        let table = [
            (Tool::Tip, true, true, true, true),
            (Tool::Eraser, true, false, false, true),
            (Tool::Finger, false, false, true, true),
            (Tool::Finger, true, false, true, false),
            (Tool::Finger, false, false, false, false),
            (Tool::Mouse, false, false, true, true),
            (Tool::Mouse, true, true, true, false),
            (Tool::Mouse, false, true, true, false),
            // Another hand on the mouse while the pen lies on the tablet.
            (Tool::Mouse, true, false, true, true),
        ];
        for (tool, near, at, fingers, expected) in table {
            assert_eq!(counts(tool, near, at, fingers), expected, "{tool:?} {near} {at} {fingers}");
        }
    }

    #[test]
    fn a_pen_and_its_pointer_are_one_stroke() {
        let (mut devices, settings) = (Devices::default(), plain());
        devices.push(pen(0.0, Phase::Hover, 10.0, 0.0));
        devices.push(pen(0.1, Phase::Down, 10.0, 0.3));
        let events = [Event::PointerMoved(Pos2::new(10.0, 50.0)), press(10.0, true)];
        let mut all = devices.poll(&frame(1.0, &events), &settings);
        devices.push(pen(0.2, Phase::Move, 40.0, 0.6));
        devices.push(pen(0.3, Phase::Up, 40.0, 0.0));
        let events = [Event::PointerMoved(Pos2::new(40.0, 50.0)), press(40.0, false)];
        all.extend(devices.poll(&frame(1.1, &events), &settings));
        use Phase::{Down, Hover, Move, Up};
        assert_eq!(phases(&all), [Hover, Down, Move, Up].map(|phase| (Tool::Tip, phase)));
        // Lifting does not take the pressure of the end away.
        let told: Vec<f32> = all.iter().map(|input| input.sample.pressure).collect();
        for (told, expected) in told.iter().zip([0.0, 0.3, 0.6, 0.6]) {
            assert!((told - expected).abs() < 1e-3, "{told} {expected}");
        }
    }

    #[test]
    fn a_pointer_that_comes_a_slow_frame_late_is_still_the_pens() {
        let (mut devices, settings) = (Devices::default(), plain());
        devices.push(pen(0.0, Phase::Down, 10.0, 0.5));
        for k in 1..20 {
            devices.push(pen(0.01 * f64::from(k), Phase::Move, 10.0 + 10.0 * k as f32, 0.5));
        }
        devices.push(pen(0.2, Phase::Up, 200.0, 0.0));
        devices.push(pen(0.2, Phase::Out, 200.0, 0.0));
        let events = [press(10.0, true)];
        assert_eq!(devices.poll(&frame(1.0, &events), &settings).len(), 22);
        let events = [Event::PointerMoved(Pos2::new(110.0, 50.0)), press(200.0, false)];
        let late = devices.poll(&frame(1.3, &events), &settings);
        assert!(late.is_empty(), "{late:?}");
        // Half a minute later the same place is the mouse's.
        assert_eq!(devices.poll(&frame(30.0, &[press(200.0, true)]), &settings).len(), 1);
    }

    #[test]
    fn the_mouse_has_the_pressure_of_choice_and_shift_is_full() {
        let (mut devices, settings) = (Devices::default(), PenSettings::default());
        let down = [press(10.0, true)];
        assert_eq!(devices.poll(&frame(1.0, &down), &settings)[0].sample.pressure, 0.5);
        let moved = [Event::PointerMoved(Pos2::new(30.0, 50.0))];
        let shift = Frame { shift: true, ..frame(1.1, &moved) };
        assert!(devices.poll(&shift, &settings)[0].sample.pressure > 0.999);
        let up = devices.poll(&frame(1.2, &[press(30.0, false)]), &settings);
        assert_eq!(phases(&up), [(Tool::Mouse, Phase::Up)]);
    }

    #[test]
    fn a_pen_goes_before_a_mouse_that_turns_out_to_be_its_shadow() {
        let (mut devices, settings) = (Devices::default(), plain());
        let shadow = devices.poll(&frame(1.0, &[press(10.0, true)]), &settings);
        assert_eq!(phases(&shadow), [(Tool::Mouse, Phase::Down)]);
        devices.push(pen(0.0, Phase::Down, 10.0, 0.4));
        let inputs = devices.poll(&frame(1.01, &[]), &settings);
        let told: Vec<(Device, Phase)> =
            inputs.iter().map(|i| (i.sample.device, i.sample.phase)).collect();
        assert_eq!(told, [(MOUSE, Phase::Out), (PEN, Phase::Down)]);
        let late = devices.poll(&frame(1.02, &[press(10.0, false)]), &settings);
        assert!(late.is_empty(), "{late:?}");
    }

    #[test]
    fn touches_have_force_and_palms_wait() {
        let settings = plain();
        let mut devices = Devices::default();
        let stroke = [
            touch(1, TouchPhase::Start, 10.0, Some(0.2)),
            press(10.0, true),
            touch(1, TouchPhase::Move, 20.0, Some(0.8)),
            touch(1, TouchPhase::End, 20.0, Some(0.0)),
            press(20.0, false),
        ];
        let inputs = devices.poll(&frame(1.0, &stroke), &settings);
        use Phase::{Down, Move, Up};
        assert_eq!(phases(&inputs), [Down, Move, Up].map(|phase| (Tool::Tip, phase)));
        assert!((inputs[1].sample.pressure - 0.8).abs() < 1e-3);
        // The palm, while that pen was just there.
        let palm = [touch(2, TouchPhase::Start, 90.0, None), touch(2, TouchPhase::End, 90.0, None)];
        let mut devices = Devices::default();
        devices.push(pen(0.0, Phase::Hover, 10.0, 0.0));
        let inputs = devices.poll(&frame(1.0, &palm), &settings);
        assert_eq!(phases(&inputs), [(Tool::Tip, Phase::Hover)]);
        // The pen leaves: a finger is a finger.
        devices.push(pen(0.5, Phase::Out, 10.0, 0.0));
        let inputs = devices.poll(&frame(1.5, &palm), &settings);
        assert_eq!(inputs.len(), 3, "{inputs:?}");
    }

    #[test]
    fn two_fingers_are_no_stroke() {
        let (mut devices, settings) = (Devices::default(), plain());
        let pinch = [
            touch(1, TouchPhase::Start, 10.0, None),
            touch(2, TouchPhase::Start, 90.0, None),
            touch(1, TouchPhase::Move, 20.0, None),
            touch(2, TouchPhase::End, 90.0, None),
            touch(1, TouchPhase::End, 20.0, None),
        ];
        let inputs = devices.poll(&frame(1.0, &pinch), &settings);
        let told = [(Tool::Finger, Phase::Down), (Tool::Finger, Phase::Out)];
        assert_eq!(phases(&inputs), told);
        let again =
            [touch(3, TouchPhase::Start, 10.0, None), touch(3, TouchPhase::End, 10.0, None)];
        assert_eq!(devices.poll(&frame(2.0, &again), &settings).len(), 2);
    }

    #[test]
    fn double_taps_are_near_and_quick() {
        // Seconds between the taps, points between them -> double.
        let table = [(0.2, 5.0, true), (0.2, 30.0, false), (0.6, 0.0, false), (0.39, 12.0, true)];
        for (later, apart, double) in table {
            let mut hand = Hand::default();
            let feel = Feel::default();
            hand.take(pen(0.0, Phase::Down, 10.0, 0.5), &feel);
            hand.take(pen(0.05, Phase::Up, 10.0, 0.0), &feel);
            let second = hand.take(pen(later, Phase::Down, 10.0 + apart, 0.5), &feel);
            assert_eq!(second[0].double_tap, double, "{later} {apart}");
        }
        // A third tap begins anew.
        let mut hand = Hand::default();
        let doubles: Vec<bool> = (0..4)
            .map(|k| {
                let time = f64::from(k) * 0.2;
                let down = hand.take(pen(time, Phase::Down, 10.0, 0.5), &Feel::default());
                hand.take(pen(time + 0.05, Phase::Up, 10.0, 0.0), &Feel::default());
                down[0].double_tap
            })
            .collect();
        assert_eq!(doubles, [false, true, false, true]);
    }

    #[test]
    fn the_stabiliser_takes_tremble_out_and_keeps_both_ends() {
        let feel = Feel { stabiliser: 0.4, ..Feel::default() };
        let mut hand = Hand::default();
        let mut line = vec![];
        for k in 0..=100 {
            let phase =
                [Phase::Down, Phase::Move, Phase::Up][usize::from(k > 0) + usize::from(k == 100)];
            let tremble = if k % 2 == 0 { 0.0 } else { 3.0 };
            let mut sample = pen(f64::from(k) * 0.005, phase, k as f32 * 2.0, 0.5);
            sample.pos.y += tremble;
            line.push(hand.take(sample, &feel)[0].sample.pos);
        }
        assert_eq!((line[0].x, line[100].x), (0.0, 200.0));
        let rough = |line: &[Pos2]| -> f32 {
            line.windows(2).map(|w| (w[1].y - w[0].y).abs()).sum::<f32>() / line.len() as f32
        };
        assert!(rough(&line[..100]) < 0.5, "{}", rough(&line[..100]));
    }

    #[test]
    fn reports_in_any_order_leave_a_hand_that_works() {
        let mut hand = Hand::default();
        let all = [Phase::Hover, Phase::Down, Phase::Move, Phase::Up, Phase::Out];
        for k in 0..2000u32 {
            let mix = k.wrapping_mul(2_654_435_761) >> 7;
            let phase = all[(mix % 5) as usize];
            let mut sample = pen(f64::from(k) * 0.01, phase, (mix % 97) as f32, 0.5);
            sample.device = Device(mix / 5 % 3);
            sample.tool = [Tool::Tip, Tool::Finger, Tool::Mouse][(mix / 15 % 3) as usize];
            for input in hand.take(sample, &Feel::default()) {
                let p = input.sample;
                assert!(p.pos.is_finite() && (0.0..=1.0).contains(&p.pressure));
            }
        }
    }
}
