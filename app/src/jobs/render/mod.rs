//! Pictures of a groom: one, a turntable, or several cameras, of one evaluation.
//!
//! The device and its shaders are made on a thread while the graph is evaluated. Guarantees: files appear only when every picture is
//! complete. What is asked for is typed; who asks, and in which words, is not known here.

pub(crate) mod files;
mod overlay;
mod place;
pub(crate) mod probe;

use super::evaluate::{Evaluated, Opened, evaluator};
use super::open::writes_all;
use super::progress::Tell;
use super::report::{PictureReport, Report, rounded};
use super::stop::Stop;
use crate::feeders::feeders;
use crate::files::Together;
use crate::scene::lights::Lights;
use crate::scene::looks::{FileLooks, HeadLooks};
use crate::scene::{self, Dressed, Show, Skin};
use crate::words::grouped;
use coif_graphs::document::Socket;
use coif_graphs::file::document_hash;
use coif_graphs::schedule::run::{CancelToken, Evaluator};
use coif_nodes::data::curves::Curves;
use coif_nodes::data::scalp::{HeadFrame, Scalp};
use coif_nodes::define::Value;
use coif_nodes::eval::Quality;
use coif_shaders::camera::{Camera, Subject};
use coif_shaders::display::Transform;
use coif_shaders::environment::Backdrop;
use coif_shaders::light::Rig;
use coif_shaders::picture::{Picture, Samples};
use coif_shaders::surface::{RootGrid, Solid};
use coif_shaders::view::{Paint, Shading, View};
use coif_shaders::{Gpu, Look, Precision, Renderer, chart};
use files::Format;
use glam::Vec3;
use overlay::HeatOverlay;
use place::ShotView;
use std::cell::Cell;
use std::path::PathBuf;
use std::sync::Arc;
use std::thread::JoinHandle;
use std::time::Instant;

/// Longest side of a picture, pixels.
pub(crate) const LONGEST: u32 = 16384;
/// The most pictures of a turntable.
pub(crate) const MOST_FRAMES: u32 = 9999;
/// The most samples in a pixel.
pub(crate) const MOST_SAMPLES: u32 = 65536;

/// What is drawn.
#[derive(Clone, Debug)]
pub(crate) struct RenderRequest {
    /// Width and height in pixels.
    pub(crate) size: [u32; 2],
    /// The files of each picture. Of several their names have a place for what tells them apart.
    pub(crate) files: Vec<(PathBuf, Format)>,
    /// Names of views of any head, of views that the graph has saved, or `close:NODE`: a picture for each.
    pub(crate) cameras: Vec<String>,
    /// As many pictures around the head, from one camera, and what goes round.
    pub(crate) frames: u32,
    pub(crate) turns: Turns,
    /// Samples in a pixel.
    pub(crate) samples: u32,
    /// Focal length over a film 24 mm high; none: the camera's own.
    pub(crate) focal_mm: Option<f32>,
    /// What is shown, and its name.
    pub(crate) show: Show,
    pub(crate) view: String,
    /// What lights it, and how much brighter or darker than by its own exposure, stops.
    pub(crate) lights: Lights,
    pub(crate) exposure: f32,
    /// Whether nothing is behind head and hair, and no ground under them.
    pub(crate) transparent: bool,
    /// How pictures for a display are made.
    pub(crate) transform: Transform,
    /// How hair is drawn.
    pub(crate) look: Look,
    /// What colours heads.
    pub(crate) skin: Skin,
    /// What is drawn as heat on heads.
    pub(crate) overlay: Option<HeatOverlay>,
    /// Whether a colour chart, a grey and a chrome ball are drawn into a corner.
    pub(crate) chart: bool,
    /// Whether heads are drawn, and the ground under them.
    pub(crate) head: bool,
    pub(crate) floor: bool,
    /// How much hair is made, and by how many threads; 0: one for each core.
    pub(crate) quality: Quality,
    pub(crate) threads: usize,
}

/// What goes round in a turntable.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum Turns {
    /// The camera about the head.
    #[default]
    Camera,
    /// The light about the head.
    Light,
}

impl Turns {
    /// All of them, with their words.
    pub(crate) const ALL: [(&'static str, Self); 2] =
        [("camera", Self::Camera), ("light", Self::Light)];
}

impl Default for RenderRequest {
    /// A still of a head with all of its hair, in the first lights, without a file.
    fn default() -> Self {
        Self {
            size: [1280, 720],
            files: vec![],
            cameras: vec!["three-quarter".to_owned()],
            frames: 1,
            turns: Turns::Camera,
            samples: 64,
            focal_mm: None,
            show: Show::Hair(View::Hair),
            view: "hair".to_owned(),
            lights: Lights { name: Rig::NAMES[0], around: None, turn: 0.0 },
            exposure: 0.0,
            transparent: false,
            transform: Transform::default(),
            look: Look::default(),
            skin: Skin::Auto,
            overlay: None,
            chart: false,
            head: true,
            floor: true,
            quality: Quality::Final,
            threads: 0,
        }
    }
}

impl RenderRequest {
    /// The files of one picture, numbered from 0, seen by a camera.
    fn files_of(&self, number: u32, camera: &str) -> impl Iterator<Item = (PathBuf, Format)> {
        let named = move |(path, format): &(PathBuf, Format)| {
            (files::called(&files::numbered(path, number + 1), camera), *format)
        };
        self.files.iter().map(named)
    }

    /// The lights for one frame of a light turntable, rotated by this many degrees.
    pub(crate) fn rig(&self, degrees: f32) -> Rig {
        let mut rig = Lights { turn: self.lights.turn + degrees, ..self.lights.clone() }.rig();
        rig.exposure += self.exposure;
        if self.transparent {
            rig.environment.backdrop = Backdrop::Plain(Vec3::ZERO);
        }
        rig
    }

    /// Tells `files` of all that will be written.
    pub(crate) fn claim(&self, files: &mut Together) -> Result<(), Stop> {
        let shots = self.cameras.iter();
        let shots = shots.flat_map(|camera| (0..self.frames).map(move |n| (n, camera)));
        let all = shots.flat_map(|(number, camera)| self.files_of(number, camera));
        writes_all(all.map(|(path, _)| path), files)
    }
}

/// One picture of a series.
struct Shot<'a> {
    number: u32,
    camera: &'a str,
    picture: Picture,
    /// Stops that it is to be brightened by.
    exposure: f32,
    texts: &'a [(String, String)],
}

/// What becomes of each picture: the names of the files that hold it.
type Keep<'a> = &'a mut dyn FnMut(&mut Together, Shot) -> Result<Vec<String>, Stop>;

/// Draws what was asked for of a graph, and writes it. An evaluator that keeps values may be lent; else one is made.
pub(crate) fn draw(
    asked: &RenderRequest,
    opened: &Opened,
    lent: Option<&Evaluator>,
    cancel: &CancelToken,
    tell: &dyn Tell,
    report: &mut Report,
    files: &mut Together,
) -> Result<(), Stop> {
    let mut keep = |files: &mut Together, shot: Shot| {
        let Shot { number, camera, picture, exposure, texts } = shot;
        let mut written = vec![];
        for (path, format) in asked.files_of(number, camera) {
            tell.say(format!("writing {}", path.display()));
            let done = files.write(&path, cancel, |out| {
                let done = match format {
                    Format::Png if asked.transparent => {
                        picture.write_transparent_png(out, asked.transform, exposure, texts)
                    }
                    Format::Png => picture.write_png(out, asked.transform, exposure, texts),
                    Format::Exr => picture.write_exr(out, Samples::Half, texts),
                };
                done.map_err(|err| err.to_string())
            });
            done.map_err(|reason| Stop::unwritten(&path, &reason, cancel))?;
            written.push(path.display().to_string());
        }
        Ok(written)
    };
    draw_shots(asked, opened, lent, cancel, tell, report, files, &mut keep)
}

/// Draws a graph into memory: one picture.
pub(crate) fn draw_one(
    asked: &RenderRequest,
    opened: &Opened,
    cancel: &CancelToken,
    tell: &dyn Tell,
    files: &mut Together,
) -> Result<Picture, Stop> {
    let (mut drawn, mut report) = (None, Report::new(String::new()));
    let mut keep = |_: &mut Together, shot: Shot| {
        drawn = Some(shot.picture);
        Ok(vec![])
    };
    draw_shots(asked, opened, None, cancel, tell, &mut report, files, &mut keep)?;
    drawn.ok_or_else(|| Stop::failed("nothing was drawn"))
}

fn draw_shots(
    asked: &RenderRequest,
    opened: &Opened,
    lent: Option<&Evaluator>,
    cancel: &CancelToken,
    tell: &dyn Tell,
    report: &mut Report,
    files: &mut Together,
    keep: Keep,
) -> Result<(), Stop> {
    let places = asked.cameras.iter().map(|name| ShotView::of(name, opened));
    let places = places.collect::<Result<Vec<ShotView>, Stop>>()?;
    let followed = match asked.show {
        Show::Hair(_) => vec![],
        Show::Guides | Show::Clusters => {
            feeders(&opened.document, opened.outputs.iter().map(|output| &output.socket.node))
        }
    };
    let overlaid = asked.overlay.as_ref().map(|overlay| overlay.socket(&opened.document));
    let overlaid = overlaid.transpose()?.flatten();
    let seen = followed.iter().chain(places.iter().filter_map(ShotView::socket));
    let more: Vec<Socket> = seen.chain(&overlaid).cloned().collect();
    if followed.is_empty() && !matches!(asked.show, Show::Hair(_)) {
        return Err(Stop::refused(format!(
            "--view {}: no node on the way to the outputs makes hair that follows curves",
            asked.view
        )));
    }
    opened.refuse_problems(&more, &mut report.warnings)?;
    let named = match (asked.skin, !asked.head) {
        (Skin::Tone(_), _) | (_, true) => vec![],
        _ => opened.head_files(&more),
    };
    let named: Vec<Option<HeadLooks>> =
        named.into_iter().map(|file| file.and_then(|file| HeadLooks::read(&file))).collect();
    for path in named.iter().flatten().flat_map(|named| &named.beside) {
        let words = format!("{} of the head", path.display());
        files.reads(path, words).map_err(Stop::refused)?;
    }
    files.allowed().map_err(Stop::failed)?;
    let decoding = std::thread::spawn(move || {
        let decoded = |named: Option<HeadLooks>| named.map(|named| Arc::new(named.decoded()));
        named.into_iter().map(decoded).collect::<Vec<_>>()
    });
    let shading = match asked.show {
        Show::Hair(View::Hair) => Shading::Hair,
        _ => Shading::Colour,
    };
    let device = Device::start(asked.size, asked.look, shading, cancel);
    let began = Instant::now();
    let evaluated = match lent {
        Some(lent) => opened.evaluate_on(lent, asked.quality, &more, cancel, tell, report),
        None => evaluator(asked.threads, 0, &mut report.warnings)
            .and_then(|made| opened.evaluate_on(&made, asked.quality, &more, cancel, tell, report)),
    };
    let evaluation_ms = since(began);
    let mut evaluated = match evaluated {
        // What the device's failure ended was not interrupted by anybody.
        Err(stop) if stop.is_interruption() => return Err(device.failure().unwrap_or(stop)),
        evaluated => evaluated?,
    };
    let (mut renderer, device_ms) = device.wait()?;
    let began = Instant::now();
    let frame = evaluated.scalps.first().map_or(HeadFrame::IDENTITY, |scalp| *scalp.frame());
    let mut closest = evaluated.more.split_off(followed.len());
    let overlaid = overlaid.and_then(|_| closest.pop());
    let looks =
        decoding.join().map_err(|_| Stop::failed("a picture of the head cannot be read"))?;
    let heat = match asked.overlay.as_ref().filter(|_| asked.head) {
        Some(overlay) => overlay.solids(&evaluated, overlaid.as_ref(), asked.skin.tone())?,
        None => vec![],
    };
    let mut scene = Scene::of(asked, evaluated, &looks, &mut report.warnings)?;
    scene.solids.extend(heat);
    let mut closest = closest.iter();
    let stills = places.iter().map(|place| {
        place.camera(asked, &scene.subject(), place.socket().and_then(|_| closest.next()))
    });
    let stills = stills.collect::<Result<Vec<Camera>, Stop>>()?;
    let description = describe(asked, &scene);
    renderer.set_look(&Look { stands_for: scene.stands_for, ..asked.look });
    let mut rig = asked.rig(0.0);
    renderer.set_rig(&rig);
    renderer.set_solids(scene.solids);
    renderer.set_roots(scene.roots);
    renderer.set_hair(&scene.drawn, &scene.paint);

    let adapter = adapter(&renderer);
    let mut texts = vec![
        ("Software".to_owned(), format!("coif {}", env!("CARGO_PKG_VERSION"))),
        ("Title".to_owned(), opened.document.title.clone()),
        ("Description".to_owned(), description.clone()),
        ("graph".to_owned(), document_hash(&opened.document)),
        ("hair".to_owned(), hashes(report)),
        ("view".to_owned(), asked.view.clone()),
        ("camera".to_owned(), String::new()),
        ("light".to_owned(), asked.lights.called()),
        ("samples".to_owned(), asked.samples.to_string()),
        ("adapter".to_owned(), adapter.clone()),
    ];
    texts.retain(|(name, text)| !text.is_empty() || name == "camera");
    let first_sample_ms = Cell::new(None);
    let mut pictures = vec![];
    tell.counts("samples");
    let shots = asked.frames * places.len() as u32;
    let total = (shots * asked.samples) as usize;
    for number in 0..shots {
        // A turntable has one place, several places have one frame each.
        let turn = 360.0 * (number % asked.frames) as f32 / asked.frames as f32;
        let (place, still) = {
            let at = (number / asked.frames) as usize;
            (&places[at], &stills[at])
        };
        let camera = match asked.turns {
            Turns::Camera => still.turned(frame.origin, frame.up, turn),
            Turns::Light => *still,
        };
        if asked.turns == Turns::Light && turn != 0.0 {
            rig = asked.rig(turn);
            renderer.set_rig(&rig);
        }
        renderer.set_camera(&camera);
        for (_, text) in texts.iter_mut().filter(|(name, _)| name == "camera") {
            *text = place.in_words(asked);
        }
        let seen = |samples: u32| {
            if samples > 0 && first_sample_ms.get().is_none() {
                first_sample_ms.set(Some(since(began)));
            }
        };
        let whole = renderer.render(asked.samples, &|progress| {
            seen(progress.samples);
            tell.count((number * asked.samples + progress.samples) as usize, total);
            cancel.is_cancelled()
        });
        if !whole {
            let lost = renderer.lost().map(|lost| Stop::failed(lost.to_string()));
            return Err(lost.unwrap_or_else(Stop::interrupted));
        }
        seen(asked.samples);
        let mut picture = renderer.picture();
        if asked.chart {
            chart::draw(&mut picture, &rig, &camera);
        }
        let exposure = rig.exposure;
        let shot = Shot { number, camera: &place.name, picture, exposure, texts: &texts };
        pictures.extend(keep(files, shot)?);
    }
    report.picture = Some(PictureReport {
        files: pictures,
        width: asked.size[0],
        height: asked.size[1],
        description,
        view: asked.view.clone(),
        camera: asked.cameras.join(", "),
        light: asked.lights.called(),
        samples: asked.samples,
        transform: asked.transform.name(),
        adapter,
        evaluation_ms: rounded(evaluation_ms),
        device_ms: rounded(device_ms),
        first_sample_ms: rounded(first_sample_ms.get().unwrap_or_default()),
        draw_ms: rounded(since(began)),
    });
    Ok(())
}

/// What stands before the camera.
struct Scene {
    frame: HeadFrame,
    scalp: Option<Arc<Scalp>>,
    /// All hair of the outputs, and how many curves it follows where these are shown.
    hair: Curves,
    followed: usize,
    /// What is drawn of it, or of what it follows, and its colours.
    drawn: Curves,
    paint: Paint,
    solids: Vec<Solid>,
    roots: Option<RootGrid>,
    /// How many strands of the final hair each that is drawn stands for.
    stands_for: f32,
}

impl Scene {
    /// What views of it are framed by.
    fn subject(&self) -> Subject<'_> {
        let surface = self.scalp.as_deref().map(Scalp::surface);
        Subject { frame: self.frame, surface, hair: &self.hair }
    }

    fn of(
        asked: &RenderRequest,
        evaluated: Evaluated,
        looks: &[Option<Arc<FileLooks>>],
        warnings: &mut Vec<String>,
    ) -> Result<Self, Stop> {
        let Evaluated { groups, scalps, more, stands_for, sections: _, parted: _ } = evaluated;
        // Guides that are handed out besides hair are no hair.
        let only_guides = groups.iter().all(|group| group.guides);
        let hair = together(
            groups.into_iter().filter(|group| only_guides || !group.guides).map(|g| g.curves),
        );
        let followed = together(more.into_iter().filter_map(|value| match value {
            Value::Curves(curves) => Some(curves),
            _ => None,
        }));
        let scalp = scalps.first().cloned();
        let (mut solids, remarks) = match !asked.head {
            true => (vec![], vec![]),
            false => scene::heads(&scalps, asked.skin, looks),
        };
        warnings.extend(remarks);
        let dressed = Dressed::of(&asked.show, (&hair, stands_for), &followed, scalp.as_deref())
            .map_err(|reason| Stop::failed(format!("--view {}: {reason}", asked.view)))?;
        if asked.floor && !asked.transparent {
            solids.extend(dressed.ground(&solids));
        }
        let Dressed { drawn, paint, tubes, roots, stands_for } = dressed;
        solids.extend(tubes);
        let frame = scalp.as_ref().map_or(HeadFrame::IDENTITY, |scalp| *scalp.frame());
        let followed = followed.curve_count();
        Ok(Self { frame, scalp, hair, followed, drawn, paint, solids, roots, stands_for })
    }
}

fn together(all: impl Iterator<Item = Curves>) -> Curves {
    Curves::new(all.flat_map(|curves| curves.tufts().to_vec()).collect())
}

/// A renderer in the making.
struct Device {
    thread: JoinHandle<Result<(Renderer, f64), Stop>>,
}

impl Device {
    /// Begins to make it, with the shaders that a look needs. When that fails, whatever `cancel` stops is stopped.
    fn start(size: [u32; 2], look: Look, shading: Shading, cancel: &CancelToken) -> Self {
        let cancel = cancel.clone();
        let thread = std::thread::spawn(move || {
            let began = Instant::now();
            let made = Gpu::new(Precision::Best)
                .map_err(|err| Stop::failed(err.to_string()))
                .and_then(|gpu| {
                    Renderer::new(Arc::new(gpu), size[0], size[1])
                        .map_err(|err| Stop::refused(err.to_string()))
                });
            if made.is_err() {
                cancel.cancel();
            }
            made.map(|mut renderer| {
                renderer.warm_up(&look, shading);
                (renderer, since(began))
            })
        });
        Self { thread }
    }

    /// The renderer and the milliseconds that making it took.
    fn wait(self) -> Result<(Renderer, f64), Stop> {
        let gone = |_| Stop::failed("the graphics driver ended unexpectedly");
        self.thread.join().map_err(gone)?
    }

    /// Why it could not be made, if it could not.
    fn failure(self) -> Option<Stop> {
        self.wait().err()
    }
}

/// Name and driver of what draws.
fn adapter(renderer: &Renderer) -> String {
    let info = &renderer.gpu().info;
    if info.driver_info.is_empty() {
        return info.name.clone();
    }
    format!("{}, {}", info.name, info.driver_info)
}

/// What the picture is, in words.
fn describe(asked: &RenderRequest, scene: &Scene) -> String {
    let (strands, points) = (scene.hair.curve_count(), scene.hair.point_count());
    let quality = match asked.quality {
        Quality::Final => "final",
        Quality::Preview => "preview (the first tenth)",
        Quality::FirstLook => "preview (the first hundredth)",
    };
    let mut text = format!("{quality}, {} strands, {} points", grouped(strands), grouped(points));
    match asked.show {
        Show::Hair(_) => {}
        Show::Guides | Show::Clusters => {
            text += &format!(", shown as {} {}", grouped(scene.followed), asked.view);
        }
    }
    if scene.stands_for > 1.0 {
        text += &format!(", each drawn {:.1} times as wide", scene.stands_for);
    }
    if asked.look.share < 1.0 {
        text += &format!(", {} % of them drawn", asked.look.share * 100.0);
    }
    if let Some(legend) = &scene.paint.legend {
        text += &format!(", {} {} to {}", legend.name, legend.lowest, legend.highest);
        if !legend.unit.is_empty() {
            text += &format!(" {}", legend.unit);
        }
    }
    // A picture is made only when none failed.
    text + ", no failed nodes"
}

/// Content hash of each output with its group's name.
fn hashes(report: &Report) -> String {
    let all: Vec<String> =
        report.outputs.iter().map(|output| format!("{} {}", output.group, output.hash)).collect();
    all.join(", ")
}

fn since(began: Instant) -> f64 {
    began.elapsed().as_secs_f64() * 1e3
}
