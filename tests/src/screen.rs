//! A screen that nobody sits at: an X server in memory, hands that press its keys and move its pointer, and what it shows.
//!
//! Hands rest between what they do, as people do; nothing is judged by that. A server, and a program started on it, end with the value that holds them.

use crate::waiting::{ends, until};
use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::Duration;

/// An X server (`Xvfb`) with a display of its own.
pub struct Screen {
    server: Child,
    display: String,
}

/// What a screen showed: three bytes a pixel.
pub struct Shot {
    /// Pixels.
    pub width: usize,
    /// Pixels.
    pub height: usize,
    /// Red, green, blue, row by row.
    pub rgb: Vec<u8>,
}

/// The programs that this needs.
const NEEDED: &[&str] = &["Xvfb", "xdotool", "import"];

/// Whether a program can be started.
pub fn has(program: &str) -> bool {
    let found = |folder: std::path::PathBuf| folder.join(program).is_file();
    std::env::var_os("PATH").is_some_and(|path| std::env::split_paths(&path).any(found))
}

impl Screen {
    /// A screen of so many pixels; none where the machine has no such thing. The caller returns then, having named itself.
    ///
    /// # Panics
    /// When the server does not come up.
    pub fn start(test: &str, width: u32, height: u32) -> Option<Self> {
        if !NEEDED.iter().all(|program| has(program)) {
            println!("skipped: {test} needs {} (xvfb xdotool imagemagick)", NEEDED.join(", "));
            return None;
        }
        // The server takes a number that is free, and tells it when it is ready; where it cannot start it ends. It is not to begin anew
        // whenever a client leaves, such as xdotool: who comes just then finds nobody.
        let mut server = Command::new("Xvfb")
            .args(["-displayfd", "1", "-screen", "0", &format!("{width}x{height}x24")])
            .args(["-nolisten", "tcp", "-noreset"])
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .expect("Xvfb starts");
        let mut number = String::new();
        let told = server.stdout.take().map(|out| BufReader::new(out).read_line(&mut number));
        let is_up = matches!(told, Some(Ok(_))) && number.trim().parse::<u32>().is_ok();
        let screen = Self { server, display: format!(":{}", number.trim()) };
        assert!(is_up, "no display can be opened");
        Some(screen)
    }

    /// A screen of a server that was started elsewhere; it ends with this.
    pub fn of(server: Child, display: String) -> Self {
        Self { server, display }
    }

    /// Whether its server runs.
    pub fn is_up(&mut self) -> bool {
        matches!(self.server.try_wait(), Ok(None))
    }

    /// The display's name.
    pub fn display(&self) -> &str {
        &self.display
    }

    /// Has `xdotool` do something.
    ///
    /// # Panics
    /// When it fails.
    pub fn hand<S: AsRef<std::ffi::OsStr>>(&self, args: impl IntoIterator<Item = S>) -> String {
        let done = Command::new("xdotool")
            .args(args)
            .env("DISPLAY", &self.display)
            .output()
            .expect("xdotool starts");
        assert!(done.status.success(), "xdotool: {}", String::from_utf8_lossy(&done.stderr));
        String::from_utf8_lossy(&done.stdout).trim().to_owned()
    }

    /// Waits for a window of this program with this in its title and gives it the keyboard.
    ///
    /// # Panics
    /// When none comes, or the program ends.
    pub fn focus(&self, program: &mut Child, title: &str) -> String {
        let mut window = None;
        until(&format!("a window {title:?} opens"), || {
            if let Ok(Some(ended)) = program.try_wait() {
                panic!("no window {title:?} opens: the program ended ({ended})");
            }
            let found = Command::new("xdotool")
                .args(["search", "--onlyvisible", "--name", title])
                .env("DISPLAY", &self.display)
                .output()
                .expect("xdotool starts");
            let text = String::from_utf8_lossy(&found.stdout).trim().to_owned();
            window = text.lines().last().map(str::to_owned);
            window.is_some()
        });
        let window = window.expect("a window");
        self.hand(["windowfocus", "--sync", &window]);
        window
    }

    /// Presses keys, as in "ctrl+s".
    pub fn key(&self, keys: &str) {
        self.hand(["key", "--clearmodifiers", keys]);
        std::thread::sleep(Duration::from_millis(120));
    }

    /// Types text.
    pub fn write(&self, text: &str) {
        self.hand(["type", "--delay", "25", text]);
        std::thread::sleep(Duration::from_millis(120));
    }

    /// Moves the pointer.
    pub fn point(&self, x: i32, y: i32) {
        self.hand(["mousemove", "--sync", &x.to_string(), &y.to_string()]);
        std::thread::sleep(Duration::from_millis(40));
    }

    /// Clicks at a place.
    pub fn click(&self, x: i32, y: i32) {
        self.point(x, y);
        self.hand(["click", "1"]);
        std::thread::sleep(Duration::from_millis(120));
    }

    /// Drags along places with a button, in small steps as a hand does.
    pub fn drag(&self, button: u32, places: &[(i32, i32)]) {
        let Some((x, y)) = places.first() else { return };
        self.point(*x, *y);
        self.hand(["mousedown", &button.to_string()]);
        std::thread::sleep(Duration::from_millis(60));
        for pair in places.windows(2) {
            for step in 1..=8 {
                let part = |a: i32, b: i32| a + (b - a) * step / 8;
                let (x, y) = (part(pair[0].0, pair[1].0), part(pair[0].1, pair[1].1));
                self.hand(["mousemove", &x.to_string(), &y.to_string()]);
                std::thread::sleep(Duration::from_millis(8));
            }
        }
        std::thread::sleep(Duration::from_millis(60));
        self.hand(["mouseup", &button.to_string()]);
        std::thread::sleep(Duration::from_millis(120));
    }

    /// What the screen shows, also written to a file where a person wants to look at it.
    ///
    /// # Panics
    /// When it cannot be taken.
    pub fn shot(&self, file: &Path) -> Shot {
        let taken = Command::new("import")
            .args(["-window", "root", "-depth", "8"])
            .arg(format!("png24:{}", file.display()))
            .env("DISPLAY", &self.display)
            .status()
            .expect("import starts");
        assert!(taken.success(), "the screen is taken");
        Shot::read(file)
    }
}

impl Drop for Screen {
    fn drop(&mut self) {
        let _ = self.server.kill();
        let _ = self.server.wait();
    }
}

impl Shot {
    /// A PNG of 8-bit RGB.
    ///
    /// # Panics
    /// When it is none.
    pub fn read(file: &Path) -> Self {
        let open =
            std::io::BufReader::new(std::fs::File::open(file).expect("the picture is there"));
        let mut reader = png::Decoder::new(open).read_info().expect("a PNG");
        let mut rgb = vec![0; reader.output_buffer_size().expect("it fits")];
        let info = reader.next_frame(&mut rgb).expect("pixels");
        assert_eq!((info.color_type, info.bit_depth), (png::ColorType::Rgb, png::BitDepth::Eight));
        Self { width: info.width as usize, height: info.height as usize, rgb }
    }

    /// The pixel at a place.
    pub fn at(&self, x: usize, y: usize) -> [u8; 3] {
        let i = (y * self.width + x) * 3;
        [self.rgb[i], self.rgb[i + 1], self.rgb[i + 2]]
    }

    /// How many different colours a rectangle has: few in a bare panel, many where hair is seen.
    pub fn colours(&self, x: std::ops::Range<usize>, y: std::ops::Range<usize>) -> usize {
        let all = y.flat_map(|y| x.clone().map(move |x| (x, y)));
        all.map(|(x, y)| self.at(x, y)).collect::<std::collections::BTreeSet<_>>().len()
    }
}

/// A program that ends with the value that holds it.
pub struct Running(pub Child);

impl Running {
    /// Waits for its end; gives its exit code, none where something killed it.
    pub fn end(&mut self) -> Option<i32> {
        ends("a program that was asked to end", || self.0.wait()).ok()?.code()
    }
}

impl Drop for Running {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}
