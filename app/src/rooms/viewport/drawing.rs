//! Drawing beside the window: one thread owns the graphics device, takes the newest scene and hands over pictures.
//!
//! Guarantees: asking never waits; of several scenes only the newest is drawn; a newer one ends what is being refined, but
//! not a first rough picture, so that pictures come however fast the hand is; a picture that was ended is never handed
//! over. Where nothing can draw, that is said once and everything else works.
//! Not guaranteed: that every scene has a picture.

use super::painter::Painter;
use crate::core::projection::Ray;
use crate::core::visibility::Visibility;
use crate::scene::lights::Lights;
use crate::scene::{Show, Skin};
use coif_nodes::data::curves::{Curves, Tuft};
use coif_nodes::data::scalp::Scalp;
use coif_nodes::maths::closest::Hit;
use coif_shaders::view::{Legend, Shading, View};
use coif_shaders::{Camera, Gpu, Look, Precision, Transform};
use egui::ColorImage;
use glam::Vec3;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::PathBuf;
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

/// A scene and how it is to be drawn. Cheap to clone.
#[derive(Clone, Debug)]
pub struct DrawRequest {
    /// The document's state that it shows.
    pub revision: u64,
    /// All hair that is displayed.
    pub hair: Curves,
    /// How many strands of the final hair each of it stands for, 1 or more.
    pub stands_for: f32,
    /// The curves that it follows; asked for where they are shown.
    pub followed: Curves,
    /// Heads.
    pub scalps: Vec<Arc<Scalp>>,
    /// What of the hair is drawn.
    pub visibility: Visibility,
    /// In which colours.
    pub show: Show,
    /// Whether heads are drawn.
    pub head: bool,
    /// Their skin.
    pub skin: Skin,
    /// The mesh file of each head, where it has one.
    pub files: Vec<Option<PathBuf>>,
    /// What lights it.
    pub lights: Lights,
    /// Brighter than the lights' own exposure, stops.
    pub exposure: f32,
    /// For the display.
    pub transform: Transform,
    /// How hair is drawn.
    pub look: Look,
    /// Where it is seen from.
    pub camera: Camera,
    /// Pixels across and down.
    pub size: [u32; 2],
    /// Samples at rest.
    pub samples: u32,
    /// Something is being dragged: rough pictures are enough.
    pub moving: bool,
}

impl DrawRequest {
    /// Whether two have the same heads.
    pub(super) fn same_scalps(&self, other: &Self) -> bool {
        let both = self.scalps.iter().zip(&other.scalps);
        self.scalps.len() == other.scalps.len() && both.into_iter().all(|(a, b)| Arc::ptr_eq(a, b))
    }
    /// Whether two have the same heads in the same skin.
    pub(super) fn same_heads(&self, other: &Self) -> bool {
        self.same_scalps(other)
            && (self.head, self.skin, &self.files) == (other.head, other.skin, &other.files)
    }
    /// Whether two have the same hair in the same colours.
    pub(super) fn same_hair(&self, other: &Self) -> bool {
        self.hair.key() == other.hair.key()
            && self.stands_for.to_bits() == other.stands_for.to_bits()
            && self.followed.key() == other.followed.key()
            && self.show == other.show
            && self.visibility.hidden == other.visibility.hidden
            && self.visibility.alone == other.visibility.alone
    }
    /// Whether two have the same pixels at rest, but for the number of samples.
    pub(super) fn same_picture(&self, other: &Self) -> bool {
        self.same_hair(other)
            && self.same_heads(other)
            && self.lights == other.lights
            && self.exposure.to_bits() == other.exposure.to_bits()
            && (self.transform, self.look) == (other.transform, other.look)
            && (self.camera, self.size) == (other.camera, other.size)
    }
    /// Whether two ask for the same.
    fn same(&self, other: &Self) -> bool {
        self.same_picture(other)
            && (self.revision, self.samples, self.moving)
                == (other.revision, other.samples, other.moving)
    }
    /// How the shaders take its colours.
    pub(super) fn shading(&self) -> Shading {
        match self.show {
            Show::Hair(View::Hair) => Shading::Hair,
            _ => Shading::Colour,
        }
    }
}

/// A picture for the screen.
#[derive(Clone, Debug)]
pub struct Drawn {
    /// Its pixels, opaque.
    pub image: Arc<ColorImage>,
    /// What it is a picture of.
    pub wanted: DrawRequest,
    /// Samples in it.
    pub samples: u32,
    /// Samples that it is to have at rest.
    pub of: u32,
    /// Pixels of the screen across one of its own.
    pub wide: u32,
    /// Whether its light is rough too.
    pub rough: bool,
    /// Strands that it could show.
    pub strands: usize,
    /// Their points.
    pub points: usize,
    /// Share of them that was drawn.
    pub share: f32,
    /// What its colours mean, for heat maps.
    pub legend: Option<Legend>,
    /// Why it is not what was asked for.
    pub notice: Option<String>,
    /// When its parts were done.
    pub ends: Ends,
}

/// When the parts of a picture were done.
#[derive(Clone, Copy, Debug)]
pub struct Ends {
    /// The thread took the scene.
    pub began: Instant,
    /// Hair was handed to the device.
    pub uploaded: Instant,
    /// The picture was there.
    pub drawn: Instant,
}

impl Ends {
    /// Milliseconds from the scene to the picture.
    pub fn ms(&self) -> f64 {
        (self.drawn - self.began).as_secs_f64() * 1e3
    }
}

/// A question what lies under the pointer.
#[derive(Clone, Copy, Debug)]
pub struct PickQuery {
    /// To know the answer by.
    pub number: u64,
    /// Where in the picture: 0 to 1 from the left and from the top.
    pub at: [f32; 2],
    /// The same place as a half-line.
    pub ray: Ray,
    /// The camera of the picture that was looked at.
    pub camera: Camera,
}

/// What lies there.
#[derive(Clone, Debug)]
pub struct PickResult {
    /// The question's number.
    pub number: u64,
    /// Hair that is seen there, or nearly there.
    pub hair: Option<HairHit>,
    /// The skin there, also under hair.
    pub skin: Option<Hit>,
}

impl PickResult {
    /// The place that is seen, cm.
    pub fn place(&self) -> Option<Vec3> {
        self.hair.as_ref().map(|hair| hair.place).or(self.skin.map(|hit| hit.point))
    }
}

/// A curve that was hit.
#[derive(Clone, Debug)]
pub struct HairHit {
    /// Its tuft.
    pub tuft: Arc<Tuft>,
    /// Its number there.
    pub curve: usize,
    /// The nearest point's number on it.
    pub point: usize,
    /// Where that is, cm.
    pub place: Vec3,
}

impl HairHit {
    /// The curve's id.
    pub fn id(&self) -> u64 {
        self.tuft.id(self.curve)
    }
}

#[derive(Default)]
struct Desk {
    next: Option<DrawRequest>,
    pick: Option<PickQuery>,
    drawn: Option<Drawn>,
    picked: Option<PickResult>,
    fault: Option<String>,
    adapter: Option<String>,
    /// Bytes that pictures and what they are drawn of take on the device.
    bytes: usize,
    /// Whether the scene that was asked for last is drawn as far as it is to be.
    idle: bool,
    closed: bool,
}

struct Shared {
    desk: Mutex<Desk>,
    work: Condvar,
    wake: Box<dyn Fn() + Send + Sync>,
}

impl Shared {
    fn desk(&self) -> MutexGuard<'_, Desk> {
        self.desk.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// The thread, and the desk over which scenes and pictures pass.
pub struct Drawing {
    shared: Arc<Shared>,
    asked: Option<DrawRequest>,
    thread: Option<JoinHandle<()>>,
}

impl Drawing {
    /// Starts the thread. The device is made when the first scene comes. `wake` is called when there is something to look at.
    ///
    /// # Errors
    /// When the system gives no thread.
    pub fn start(wake: impl Fn() + Send + Sync + 'static) -> Result<Self, String> {
        let desk = Mutex::new(Desk { idle: true, ..Desk::default() });
        let shared = Arc::new(Shared { desk, work: Condvar::new(), wake: Box::new(wake) });
        let theirs = shared.clone();
        let thread = std::thread::Builder::new()
            .name("drawing".to_owned())
            .spawn(move || {
                let end = catch_unwind(AssertUnwindSafe(|| serve(&theirs)));
                let fault = match end {
                    Ok(fault) => fault,
                    Err(_) => Some("drawing ended unexpectedly".to_owned()),
                };
                let mut desk = theirs.desk();
                desk.fault = fault;
                desk.idle = true;
                drop(desk);
                (theirs.wake)();
            })
            .map_err(|err| format!("no thread to draw on: {err}"))?;
        Ok(Self { shared, asked: None, thread: Some(thread) })
    }

    /// Asks for a scene instead of what was asked before; nothing happens when it is the same.
    pub fn ask(&mut self, wanted: DrawRequest) {
        if self.asked.as_ref().is_some_and(|asked| asked.same(&wanted)) {
            return;
        }
        self.asked = Some(wanted.clone());
        let mut desk = self.shared.desk();
        desk.next = Some(wanted);
        desk.idle = false;
        drop(desk);
        self.shared.work.notify_one();
    }

    /// Asks what lies at a place, instead of what was asked before.
    pub fn pick(&self, pick: PickQuery) {
        self.shared.desk().pick = Some(pick);
        self.shared.work.notify_one();
    }

    /// The newest picture since the last call.
    pub fn take(&self) -> Option<Drawn> {
        self.shared.desk().drawn.take()
    }

    /// The newest answer since the last call.
    pub fn picked(&self) -> Option<PickResult> {
        self.shared.desk().picked.take()
    }

    /// Why nothing is drawn any more.
    pub fn fault(&self) -> Option<String> {
        self.shared.desk().fault.clone()
    }

    /// Name and driver of what draws, once that is known.
    pub fn adapter(&self) -> Option<String> {
        self.shared.desk().adapter.clone()
    }

    /// Bytes that it takes: on the device, and of the picture on the screen.
    pub fn bytes(&self) -> usize {
        self.shared.desk().bytes
    }

    /// Whether what was asked for last is drawn, and taken.
    pub fn is_idle(&self) -> bool {
        let desk = self.shared.desk();
        desk.idle && desk.drawn.is_none()
    }
}

impl Drop for Drawing {
    fn drop(&mut self) {
        self.shared.desk().closed = true;
        self.shared.work.notify_one();
        if let Some(thread) = self.thread.take() {
            // What it had to say is on the desk, and nobody reads it any more.
            let _ = thread.join();
        }
    }
}

/// A device that lasted this long is worth another.
const LASTED: Duration = Duration::from_secs(10);

/// The drawing thread. Gives why it ended, unless the window was closed.
fn serve(shared: &Shared) -> Option<String> {
    loop {
        let wanted = {
            let mut desk = shared.desk();
            while desk.next.is_none() && !desk.closed {
                desk = shared.work.wait(desk).unwrap_or_else(PoisonError::into_inner);
            }
            if desk.closed {
                return None;
            }
            desk.next.clone()?
        };
        let gpu = match Gpu::new(Precision::Best) {
            Ok(gpu) => Arc::new(gpu),
            Err(err) => return Some(err.to_string()),
        };
        let made = Instant::now();
        let ended = Painter::new(gpu, &wanted).and_then(|painter| draw(shared, painter));
        match ended {
            Ok(()) => return None,
            Err(_) if made.elapsed() > LASTED => {
                // The scene that was being drawn is asked for again, unless there is a newer one.
                shared.desk().next.get_or_insert(wanted);
            }
            Err(err) => return Some(err.to_string()),
        }
    }
}

/// Draws until the window is closed or the device is gone.
fn draw(shared: &Shared, mut painter: Painter) -> Result<(), coif_shaders::RenderError> {
    shared.desk().adapter = Some(painter.adapter());
    loop {
        let mut desk = shared.desk();
        while desk.next.is_none() && desk.pick.is_none() && !desk.closed {
            let pause = painter.pause();
            if !painter.is_done() && pause.is_none() {
                break;
            }
            desk.idle = painter.is_done();
            desk = match pause.filter(|_| !painter.is_done()) {
                Some(pause) => {
                    let waited = shared.work.wait_timeout(desk, pause);
                    waited.unwrap_or_else(PoisonError::into_inner).0
                }
                None => shared.work.wait(desk).unwrap_or_else(PoisonError::into_inner),
            };
        }
        if desk.closed {
            return Ok(());
        }
        let first = painter.is_first();
        let next = if first { None } else { desk.next.take() };
        let pick = if first { None } else { desk.pick.take() };
        drop(desk);
        if let Some(wanted) = next {
            painter.begin(&wanted)?;
        } else if let Some(pick) = pick {
            let picked = painter.pick(&pick);
            shared.desk().picked = Some(picked);
            (shared.wake)();
        } else if let Some(drawn) = painter.advance()? {
            let bytes = painter.bytes();
            let mut desk = shared.desk();
            desk.bytes = bytes + 2 * size_of_val(&drawn.image.pixels[..]);
            desk.drawn = Some(drawn);
            drop(desk);
            (shared.wake)();
        }
    }
}
