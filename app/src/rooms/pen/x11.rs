//! Pens under X11 and XWayland: XInput2's valuators, read on a connection of our own.
//!
//! egui and winit 0.30 drop pressure on X11, so a second connection asks the server for the motion and the buttons of
//! every slave pointer that reports an absolute pressure, on our window. Samples arrive while winit holds its grab, at
//! the device's full rate, with parts of pixels and the server's time. The core pointer goes on telling egui where the
//! pen is, which is how pens click ordinary widgets.
//!
//! Guarantees: devices that are plugged in later are found; a server that goes away ends the thread and nothing
//! else; every sample keeps what [`PenSample`] promises, whatever the server reports.
//! Not promised: that a driver tells when the pen leaves its reach (then nothing more arrives).

use super::sample::{Buttons, Clock, Device, PenSample, Phase, Tool};
use egui::{Pos2, Vec2};
use std::collections::BTreeMap;
use std::sync::mpsc::{Receiver, Sender, channel};
use x11rb::connection::Connection as _;
use x11rb::errors::ReplyError;
use x11rb::protocol::Event;
use x11rb::protocol::xinput::{
    self, ButtonPressEvent, ConnectionExt as _, DeviceClassData, DeviceType, EventMask, Fp3232,
    ValuatorMode, XIEventMask,
};
use x11rb::protocol::xproto::ConnectionExt as _;
use x11rb::rust_connection::RustConnection;

/// What the thread tells.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum PenMessage {
    /// The pens that are plugged in now.
    Pens(Vec<PenDevice>),
    /// A report. `pos` is in physical pixels of the window here.
    Sample(PenSample),
}

/// A pen that the server knows.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct PenDevice {
    /// Its number.
    pub(crate) device: Device,
    /// Its name.
    pub(crate) name: String,
    /// Which end it is: drivers make a device of each.
    pub(crate) tool: Tool,
    axes: Axes,
}

/// Number and range of a valuator.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Axis {
    number: u16,
    min: f64,
    max: f64,
}

#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Axes {
    pressure: Option<Axis>,
    tilt_x: Option<Axis>,
    tilt_y: Option<Axis>,
    twist: Option<Axis>,
}

impl Axis {
    /// Where the value is in the axis' range, 0 to 1; none when the event does not tell or the range is empty.
    fn read(&self, event: &ButtonPressEvent) -> Option<f32> {
        let has =
            |n: usize| event.valuator_mask.get(n / 32).is_some_and(|w| w >> (n % 32) & 1 == 1);
        let number = usize::from(self.number);
        if !has(number) {
            return None;
        }
        // Only the valuators of the mask are sent, in order.
        let at = (0..number).filter(|n| has(*n)).count();
        let part = (real(*event.axisvalues.get(at)?) - self.min) / (self.max - self.min);
        part.is_finite().then(|| part.clamp(0.0, 1.0) as f32)
    }
}

fn real(x: Fp3232) -> f64 {
    f64::from(x.integral) + f64::from(x.frac) / 4_294_967_296.0
}

/// What is remembered of a device: an event tells only what changed.
#[derive(Clone, Copy, Debug, Default)]
struct Memory {
    clock: Clock,
    down: bool,
    pressure: f32,
    tilt: Vec2,
    twist: f32,
}

/// Kinds of events that are understood.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    Motion,
    Press,
    Release,
}

/// The sample that an event is.
fn decode(pen: &PenDevice, memory: &mut Memory, kind: Kind, event: &ButtonPressEvent) -> PenSample {
    let read = |axis: Option<Axis>| axis.and_then(|axis| axis.read(event));
    memory.pressure = read(pen.axes.pressure).unwrap_or(memory.pressure);
    let tilt = |axis, before: f32| read(axis).map_or(before, |part| part * 2.0 - 1.0);
    memory.tilt =
        Vec2::new(tilt(pen.axes.tilt_x, memory.tilt.x), tilt(pen.axes.tilt_y, memory.tilt.y));
    memory.twist = read(pen.axes.twist).map_or(memory.twist, |part| part * 360.0);
    const TIP: u32 = 1;
    let phase = match (kind, event.detail, memory.down) {
        (Kind::Press, TIP, _) => Phase::Down,
        (Kind::Release, TIP, _) => Phase::Up,
        (_, _, true) => Phase::Move,
        (_, _, false) => Phase::Hover,
    };
    memory.down = matches!(phase, Phase::Down | Phase::Move);
    // The mask is the state before the event.
    let held = |button: u32| match kind {
        Kind::Press if event.detail == button => true,
        Kind::Release if event.detail == button => false,
        _ => event.button_mask.first().is_some_and(|mask| mask >> button & 1 == 1),
    };
    PenSample {
        time: memory.clock.seconds(event.time),
        phase,
        pos: Pos2::new(event.event_x as f32 / 65536.0, event.event_y as f32 / 65536.0),
        pressure: if phase == Phase::Hover { 0.0 } else { memory.pressure },
        tilt: memory.tilt,
        twist: memory.twist,
        tool: pen.tool,
        // Numbered as drivers number them: 3 is the lower button (a right click), 2 the upper one.
        buttons: Buttons { barrel: held(3), second: held(2) },
        device: pen.device,
    }
}

/// The end of a pen that a device of this name is. Drivers name them "... Pen eraser" or "... Eraser (0x...)".
fn tool_of(name: &str) -> Tool {
    if name.to_ascii_lowercase().contains("eraser") { Tool::Eraser } else { Tool::Tip }
}

/// A connection that listens.
struct Listener {
    connection: RustConnection,
    window: u32,
    labels: [u32; 4],
    pens: Vec<PenDevice>,
}

impl Listener {
    fn new(window: u32) -> Result<Self, Box<dyn std::error::Error + Send + Sync>> {
        let (connection, screen) = RustConnection::connect(None)?;
        connection.xinput_xi_query_version(2, 2)?.reply()?;
        let root = connection.setup().roots.get(screen).ok_or("the server has no screen")?.root;
        let hotplug =
            EventMask { deviceid: xinput::Device::ALL.into(), mask: vec![XIEventMask::HIERARCHY] };
        connection.xinput_xi_select_events(root, &[hotplug])?.check()?;
        let mut labels = [0; 4];
        let names = ["Abs Pressure", "Abs Tilt X", "Abs Tilt Y", "Abs Rotary Z"];
        for (label, name) in labels.iter_mut().zip(names) {
            *label = connection.intern_atom(false, name.as_bytes())?.reply()?.atom;
        }
        Ok(Self { connection, window, labels, pens: vec![] })
    }

    /// Finds the pens of now and asks for their events.
    fn look(&mut self) -> Result<(), ReplyError> {
        let all = self.connection.xinput_xi_query_device(xinput::Device::ALL)?.reply()?;
        let slave = |t| t == DeviceType::SLAVE_POINTER || t == DeviceType::FLOATING_SLAVE;
        self.pens.clear();
        for info in all.infos.iter().filter(|info| slave(info.type_)) {
            let mut axes = Axes::default();
            for class in &info.classes {
                let DeviceClassData::Valuator(v) = &class.data else { continue };
                let axis = Axis { number: v.number, min: real(v.min), max: real(v.max) };
                let [pressure, tilt_x, tilt_y, twist] = self.labels;
                match v.label {
                    label if label == pressure && v.mode == ValuatorMode::ABSOLUTE => {
                        axes.pressure = Some(axis);
                    }
                    label if label == tilt_x => axes.tilt_x = Some(axis),
                    label if label == tilt_y => axes.tilt_y = Some(axis),
                    label if label == twist => axes.twist = Some(axis),
                    _ => {}
                }
            }
            if axes.pressure.is_some() {
                let name = String::from_utf8_lossy(&info.name).into_owned();
                let (device, tool) = (Device(u32::from(info.deviceid)), tool_of(&name));
                self.pens.push(PenDevice { device, name, tool, axes });
                // A device may be gone again before it is asked: the next change of the hierarchy tells.
                let _ = self.select(info.deviceid);
            }
        }
        self.connection.flush()?;
        Ok(())
    }

    fn select(&self, id: u16) -> Result<(), ReplyError> {
        let mask = XIEventMask::MOTION | XIEventMask::BUTTON_PRESS | XIEventMask::BUTTON_RELEASE;
        let events = EventMask { deviceid: id, mask: vec![mask] };
        self.connection.xinput_xi_select_events(self.window, &[events])?.check()?;
        // Leaving the reach of the tablet is told by the first version of the extension only.
        if let Ok(small) = u8::try_from(id) {
            let open = self.connection.xinput_open_device(small)?.reply()?;
            let near = open.class_info.iter().find(|c| c.class_id == xinput::InputClass::PROXIMITY);
            if let Some(near) = near {
                let out = u32::from(near.event_type_base) + 1;
                let class = u32::from(small) << 8 | out;
                self.connection.xinput_select_extension_event(self.window, &[class])?.check()?;
            }
        }
        Ok(())
    }

    /// Tells until nobody listens or the server is gone.
    fn listen(mut self, tell: &Sender<PenMessage>, wake: &dyn Fn()) {
        let mut memory: BTreeMap<Device, Memory> = BTreeMap::new();
        loop {
            let Ok(event) = self.connection.wait_for_event() else { return };
            let (event, kind) = match event {
                Event::XinputMotion(event) => (event, Kind::Motion),
                Event::XinputButtonPress(event) => (event, Kind::Press),
                Event::XinputButtonRelease(event) => (event, Kind::Release),
                Event::XinputProximityOut(event) => {
                    let device = Device(u32::from(event.device_id & 0x7f));
                    let Some(pen) = self.pens.iter().find(|pen| pen.device == device) else {
                        continue;
                    };
                    let memory = memory.entry(device).or_default();
                    memory.down = false;
                    let sample = PenSample {
                        time: memory.clock.seconds(event.time),
                        phase: Phase::Out,
                        pos: Pos2::new(f32::from(event.event_x), f32::from(event.event_y)),
                        pressure: 0.0,
                        tilt: memory.tilt,
                        twist: memory.twist,
                        tool: pen.tool,
                        buttons: Buttons::default(),
                        device,
                    };
                    if tell.send(PenMessage::Sample(sample)).is_err() {
                        return;
                    }
                    wake();
                    continue;
                }
                Event::XinputHierarchy(_) => {
                    let before = self.pens.clone();
                    if self.look().is_err() {
                        return;
                    }
                    if before != self.pens {
                        let _ = tell.send(PenMessage::Pens(self.pens.clone()));
                        wake();
                    }
                    continue;
                }
                _ => continue,
            };
            let device = Device(u32::from(event.deviceid));
            let Some(pen) = self.pens.iter().find(|pen| pen.device == device) else { continue };
            let sample = decode(pen, memory.entry(device).or_default(), kind, &event);
            if tell.send(PenMessage::Sample(sample)).is_err() {
                return;
            }
            wake();
        }
    }
}

/// Whether the X server has a pen with pressure now. Asked before there is a window.
pub(crate) fn has_pens() -> bool {
    // No window has the number 0, so nothing is heard; the devices are listed all the same.
    Listener::new(0).is_ok_and(|mut listener| listener.look().is_ok() && !listener.pens.is_empty())
}

/// Starts listening to pens on a window of the X server that `DISPLAY` names; `wake` is called after each report, on
/// another thread. The reason in words where there is no such server or it has no XInput2.
pub(crate) fn listen(
    window: u32,
    wake: impl Fn() + Send + 'static,
) -> Result<Receiver<PenMessage>, Box<dyn std::error::Error + Send + Sync>> {
    let mut listener = Listener::new(window)?;
    listener.look()?;
    let (tell, told) = channel();
    let _ = tell.send(PenMessage::Pens(listener.pens.clone()));
    let thread = std::thread::Builder::new().name("pen".into());
    thread.spawn(move || listener.listen(&tell, &wake))?;
    Ok(told)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pen() -> PenDevice {
        let axis = |number, min, max| Some(Axis { number, min, max });
        PenDevice {
            device: Device(9),
            name: "Stylus".into(),
            tool: Tool::Tip,
            axes: Axes {
                pressure: axis(2, 0.0, 1000.0),
                tilt_x: axis(3, -64.0, 64.0),
                tilt_y: axis(35, -64.0, 64.0),
                twist: axis(36, -900.0, 899.0),
            },
        }
    }
    /// An event that tells these valuators, ascending.
    fn event(time: u32, detail: u32, held: &[u32], valuators: &[(usize, f64)]) -> ButtonPressEvent {
        let mut valuator_mask = vec![0u32; 2];
        for (n, _) in valuators {
            valuator_mask[n / 32] |= 1 << (n % 32);
        }
        let fixed = |x: f64| Fp3232 {
            integral: x.floor() as i32,
            frac: ((x - x.floor()) * 4_294_967_296.0) as u32,
        };
        ButtonPressEvent {
            response_type: 35,
            extension: 131,
            sequence: 1,
            length: 0,
            event_type: 6,
            deviceid: 9,
            time,
            detail,
            root: 1,
            event: 2,
            child: 0,
            root_x: 0,
            root_y: 0,
            event_x: 100 * 65536 + 32768,
            event_y: 40 * 65536,
            sourceid: 9,
            flags: 0u32.into(),
            mods: Default::default(),
            group: Default::default(),
            button_mask: vec![held.iter().fold(0, |mask, b| mask | 1 << b)],
            valuator_mask,
            axisvalues: valuators.iter().map(|(_, x)| fixed(*x)).collect(),
        }
    }

    #[test]
    fn a_stroke_of_events_is_a_stroke_of_samples() {
        use Kind::{Motion, Press, Release};
        let mut memory = Memory::default();
        // What the server sends -> phase, pressure, tilt.
        let table: &[(Kind, ButtonPressEvent, Phase, f32, [f32; 2])] = &[
            (Motion, event(100, 0, &[], &[(0, 5.0), (1, 5.0)]), Phase::Hover, 0.0, [0.0; 2]),
            (Motion, event(101, 0, &[], &[(3, 32.0)]), Phase::Hover, 0.0, [0.5, 0.0]),
            (Press, event(102, 1, &[], &[(0, 5.0), (2, 250.0)]), Phase::Down, 0.25, [0.5, 0.0]),
            (Motion, event(103, 0, &[1], &[(2, 500.5)]), Phase::Move, 0.5005, [0.5, 0.0]),
            // Nothing told: as before.
            (Motion, event(104, 0, &[1], &[(0, 6.0)]), Phase::Move, 0.5005, [0.5, 0.0]),
            (Motion, event(105, 0, &[1], &[(35, -64.0)]), Phase::Move, 0.5005, [0.5, -1.0]),
            // A barrel button during a stroke is no end of it.
            (Press, event(106, 3, &[1], &[]), Phase::Move, 0.5005, [0.5, -1.0]),
            // Out of its range, and not as many values as the mask promises.
            (Motion, event(107, 0, &[1, 3], &[(2, 4e6)]), Phase::Move, 1.0, [0.5, -1.0]),
            (Release, event(108, 1, &[1, 3], &[(2, 0.0)]), Phase::Up, 0.0, [0.5, -1.0]),
            (Motion, event(109, 0, &[3], &[(2, 700.0)]), Phase::Hover, 0.0, [0.5, -1.0]),
        ];
        for (i, (kind, event, phase, pressure, tilt)) in table.iter().enumerate() {
            let sample = decode(&pen(), &mut memory, *kind, event);
            assert_eq!((sample.phase, sample.tilt), (*phase, Vec2::from(*tilt)), "{i}");
            assert!((sample.pressure - pressure).abs() < 1e-6, "{i}: {}", sample.pressure);
            assert_eq!(sample.time, i as f64 / 1000.0);
            assert_eq!(sample.pos, Pos2::new(100.5, 40.0));
            assert_eq!(sample.buttons.barrel, (6..=9).contains(&i), "{i}");
        }
    }

    #[test]
    fn events_that_lie_are_survived() {
        let mut short = event(0, 1, &[], &[(2, 300.0)]);
        short.axisvalues.clear();
        short.button_mask.clear();
        let sample = decode(&pen(), &mut Memory::default(), Kind::Press, &short);
        assert_eq!(sample.pressure, 0.0);
        let mut pen = pen();
        pen.axes.pressure = Some(Axis { number: 2, min: 5.0, max: 5.0 });
        let full = event(0, 1, &[], &[(2, 300.0)]);
        assert_eq!(decode(&pen, &mut Memory::default(), Kind::Press, &full).pressure, 0.0);
        pen.axes.pressure = Some(Axis { number: u16::MAX, min: 0.0, max: 5.0 });
        assert_eq!(decode(&pen, &mut Memory::default(), Kind::Press, &full).pressure, 0.0);
    }

    #[test]
    fn erasers_are_told_by_their_names() {
        let table = [
            ("Wacom Intuos Pro M Pen stylus", Tool::Tip),
            ("Wacom Intuos Pro M Pen eraser", Tool::Eraser),
            ("HUION Tablet Eraser (0x123)", Tool::Eraser),
            ("xwayland-tablet eraser:12", Tool::Eraser),
        ];
        for (name, tool) in table {
            assert_eq!(tool_of(name), tool, "{name}");
        }
    }
}
