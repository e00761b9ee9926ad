//! A pen with pressure at a real X server: Xorg on a screen in memory, and a client of its inputtest driver.
//!
//! The protocol is version 1.1 of xf86-input-inputtest: little-endian messages over a unix socket. The driver serves the
//! first client of a socket only, so one [`Tablet`] is one session. Hands rest between what they do, as people do.

use crate::Folder;
use crate::screen::{Screen, has};
use crate::waiting::{LIMIT, until};
use std::io::{Read, Write};
use std::os::unix::fs::MetadataExt;
use std::os::unix::net::UnixStream;
use std::path::Path;
use std::process::{Command, Stdio};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::Duration;

/// The server itself: what lies in `/usr/bin` is a wrapper that wants a console.
const XORG: &str = "/usr/lib/xorg/Xorg";
const DRIVERS: [&str; 2] =
    ["/usr/lib/xorg/modules/drivers/dummy_drv.so", "/usr/lib/xorg/modules/input/inputtest_drv.so"];
/// Size of the screen of `tests/pen/xorg.conf`, pixels.
pub const SIZE: (f64, f64) = (1440.0, 900.0);

/// A screen with a pen.
pub struct Tablet {
    /// What stands on it, and hands for its keys.
    pub screen: Screen,
    /// Both ends of the pen: its tip and its eraser, each a device of its own.
    ends: [UnixStream; 2],
    /// Which is turned to the tablet.
    end: usize,
    _folder: Folder,
    /// One at a time: a hand that draws wants the machine.
    _one: MutexGuard<'static, ()>,
}

static ONE: Mutex<()> = Mutex::new(());

/// Kinds of messages.
const VERSION: u32 = 0;
const SYNC: u32 = 1;
const MOTION: u32 = 2;
const PROXIMITY: u32 = 3;
const BUTTON: u32 = 4;
/// The number of the pressure valuator, which goes from 0 to 1000; places go from 0 to 65535.
const PRESSURE: usize = 4;

impl Tablet {
    /// A tablet; none where the machine has no Xorg for it or we are not root. The caller returns then, having named
    /// itself.
    ///
    /// # Panics
    /// When the server does not come up.
    pub fn start(test: &str) -> Option<Self> {
        let root = std::fs::metadata("/proc/self").is_ok_and(|me| me.uid() == 0);
        let there = [XORG].iter().chain(&DRIVERS).all(|path| Path::new(path).exists());
        if !(root && there && has("xdotool") && has("import")) {
            println!(
                "skipped: {test} needs root and Xorg with its dummy and inputtest drivers \
                 (xserver-xorg-core xserver-xorg-video-dummy xdotool imagemagick)"
            );
            return None;
        }
        let one = ONE.lock().unwrap_or_else(PoisonError::into_inner);
        let folder = Folder::new(&format!("{test}-xorg"));
        let text = include_str!("../pen/xorg.conf");
        let text = text.replace("@FOLDER@", &folder.path("").display().to_string());
        std::fs::write(folder.path("xorg.conf"), text).expect("the configuration is written");
        let number = 600 + std::process::id() % 300;
        let display = format!(":{number}");
        let server = Command::new(XORG)
            .arg(&display)
            .args(["-noreset", "-nolisten", "tcp", "-novtswitch", "-sharevts", "vt7", "-config"])
            .arg(folder.path("xorg.conf"))
            .arg("-logfile")
            .arg(folder.path("log"))
            .current_dir(folder.path(""))
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .expect("Xorg starts");
        let mut screen = Screen::of(server, display);
        let mut connect = |name: &str| {
            let mut pen = None;
            until("the server is up", || {
                let log = || std::fs::read_to_string(folder.path("log")).unwrap_or_default();
                assert!(screen.is_up(), "{}", log());
                let up = Path::new(&format!("/tmp/.X11-unix/X{number}")).exists();
                pen = UnixStream::connect(folder.path(name)).ok().filter(|_| up);
                pen.is_some()
            });
            pen.expect("it is connected")
        };
        let ends = ["pen", "eraser"].map(&mut connect);
        for end in &ends {
            for limit in [UnixStream::set_read_timeout, UnixStream::set_write_timeout] {
                limit(end, Some(LIMIT)).expect("a limit");
            }
        }
        let mut tablet = Self { screen, ends, end: 0, _folder: folder, _one: one };
        for eraser in [true, false] {
            tablet.turn(eraser);
            tablet.send(VERSION, &[1u16.to_le_bytes(), 1u16.to_le_bytes()].concat());
            let mut answer = [0; 12];
            tablet.ends[tablet.end].read_exact(&mut answer).expect("the driver answers");
        }
        Some(tablet)
    }

    /// Turns the eraser to the tablet, or the tip.
    pub fn turn(&mut self, eraser: bool) {
        self.end = usize::from(eraser);
    }

    fn send(&mut self, kind: u32, body: &[u8]) {
        let mut message = Vec::with_capacity(8 + body.len());
        message.extend((8 + body.len() as u32).to_le_bytes());
        message.extend(kind.to_le_bytes());
        message.extend(body);
        self.ends[self.end].write_all(&message).expect("the driver listens");
    }

    /// Waits until the server has taken everything.
    fn sync(&mut self) {
        self.send(SYNC, &[]);
        let mut answer = [0; 8];
        self.ends[self.end].read_exact(&mut answer).expect("the driver answers");
    }

    /// Comes near at a place (pixels), without touching.
    pub fn hover(&mut self, x: f64, y: f64) {
        let at = valuators(x, y, 0.0);
        self.send(PROXIMITY, &[&1u32.to_le_bytes()[..], &[0; 4], &at].concat());
        self.send(MOTION, &[&1u32.to_le_bytes()[..], &[0; 4], &at].concat());
        self.sync();
    }

    /// Moves to a place with a pressure from 0 to 1.
    pub fn go(&mut self, x: f64, y: f64, pressure: f64) {
        let at = valuators(x, y, pressure);
        self.send(MOTION, &[&1u32.to_le_bytes()[..], &[0; 4], &at].concat());
        self.sync();
    }

    /// Touches, or lifts.
    pub fn touch(&mut self, x: f64, y: f64, pressure: f64, down: bool) {
        let at = valuators(x, y, pressure);
        let head = [1u32, 1, u32::from(down), 0].map(u32::to_le_bytes).concat();
        self.send(BUTTON, &[&head[..], &at].concat());
        self.sync();
    }

    /// Leaves.
    pub fn leave(&mut self) {
        let at = valuators(0.0, 0.0, 0.0);
        self.send(PROXIMITY, &[&0u32.to_le_bytes()[..], &[0; 4], &at].concat());
        self.sync();
    }

    /// Comes, taps a place, and goes.
    pub fn tap(&mut self, x: f64, y: f64) {
        for off in [2.0, 1.0, 0.0] {
            self.hover(x - off, y);
            std::thread::sleep(Duration::from_millis(200));
        }
        // Longer than a frame of a busy machine: egui takes no click that begins and ends in one.
        self.touch(x, y, 0.5, true);
        std::thread::sleep(Duration::from_millis(500));
        self.touch(x, y, 0.0, false);
        std::thread::sleep(Duration::from_millis(200));
        self.leave();
    }

    /// Draws through places (pixels), each with its pressure, at 200 reports a second.
    pub fn draw(&mut self, places: &[(f64, f64, f64)]) {
        let (Some(first), Some(last)) = (places.first(), places.last()) else { return };
        for off in [2.0, 1.0, 0.0] {
            self.hover(first.0 - off, first.1);
            std::thread::sleep(Duration::from_millis(60));
        }
        self.touch(first.0, first.1, first.2, true);
        for (x, y, pressure) in &places[1..] {
            self.go(*x, *y, *pressure);
            std::thread::sleep(Duration::from_millis(5));
        }
        self.touch(last.0, last.1, 0.0, false);
        self.leave();
    }
}

/// Place and pressure as the driver takes them: which valuators are told, and 64 numbers, twice.
fn valuators(x: f64, y: f64, pressure: f64) -> Vec<u8> {
    let mut numbers = [0.0f64; 64];
    numbers[0] = x / SIZE.0 * 65535.0;
    numbers[1] = y / SIZE.1 * 65535.0;
    numbers[PRESSURE] = pressure * 1000.0;
    let mask: u64 = 1 | 1 << 1 | 1 << PRESSURE;
    let mut block = vec![0; 4];
    block.extend(mask.to_le_bytes());
    block.extend([0; 4]);
    block.extend(numbers.iter().flat_map(|x| x.to_le_bytes()));
    block.extend([0; 64 * 8]);
    block
}
