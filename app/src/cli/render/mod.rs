//! `coif render`: a saved graph to pictures.
//!
//! What is wrong with the words is said before anything runs. The device and its shaders are made on a thread
//! while the graph is evaluated. Files appear only when every picture is complete.

mod options;
mod place;

use super::Exit;
use super::carry_out::{Stop, carry_out, writes_all};
use super::groom::{Evaluated, GroomArgs, Opened, QualityArg};
use super::progress::{Bar, Tell};
use super::report::{Picture as About, Report, rounded};
use crate::feeders::feeders;
use crate::files::{Together, read_at_most};
use crate::scene::looks::{FileLooks, Named};
use crate::scene::{self, Dressed, Show, Skin};
use crate::words::grouped;
use clap::Args;
use coif_graphs::document::{Document, Socket};
use coif_graphs::schedule::result::document_hash;
use coif_graphs::schedule::run::CancelToken;
use coif_nodes::data::curves::Curves;
use coif_nodes::data::scalp::{HeadFrame, Scalp};
use coif_nodes::define::Value;
use coif_shaders::camera::Camera;
use coif_shaders::display::Transform;
use coif_shaders::hdri::Hdri;
use coif_shaders::light::Rig;
use coif_shaders::picture::{Picture, Samples};
use coif_shaders::surface::{RootGrid, Solid};
use coif_shaders::view::{Paint, Shading, View};
use coif_shaders::{Gpu, Look, Material, Model, Precision, Renderer, chart};
use options::{Format, Series, within};
use place::Place;
use std::cell::Cell;
use std::path::PathBuf;
use std::sync::Arc;
use std::thread::JoinHandle;
use std::time::Instant;

#[derive(Args, Clone)]
pub(crate) struct RenderArgs {
    #[command(flatten)]
    groom: GroomArgs,
    /// Picture to write: .png for a display, .exr scene-linear
    #[arg(long, value_name = "FILE")]
    out: Vec<PathBuf>,
    /// Width and height in pixels
    #[arg(
        long,
        value_name = "WIDTHxHEIGHT",
        default_value = "1280x720",
        allow_hyphen_values = true
    )]
    size: String,
    /// front, left, right, back, top, under, three-quarter, crown, nape, hairline, temple-left, temple-right, a view that was
    /// saved in the graph, or close:NODE to fill the picture with what NODE gives. Given several times:
    /// as many pictures of one evaluation, with %s in the file's name for theirs
    #[arg(long, value_name = "NAME|SAVED|close:NODE", default_value = "three-quarter")]
    camera: Vec<String>,
    /// Focal length over a film 24 mm high: 85, or a saved view's own
    #[arg(long, value_name = "MM", allow_negative_numbers = true)]
    focal: Option<f32>,
    /// This many pictures around the head; %04d in the file's name becomes their number, from 1
    #[arg(long, value_name = "N")]
    turntable: Option<u32>,
    /// Samples in a pixel: 1 is grainy, 64 a clean still
    #[arg(long, value_name = "N", default_value_t = 64)]
    samples: u32,
    /// What is shown: hair; guides, the curves that hair follows; clusters, the same as tubes; or an attribute as colours
    #[arg(long, value_name = "hair|guides|clusters|ATTRIBUTE", default_value = "hair")]
    view: String,
    /// Lights: studio, backlit, overcast, flat, dark-hair, neutral; else those saved with the groom, else studio
    #[arg(long, value_name = "RIG")]
    light: Option<String>,
    /// Light from a photographed sphere instead: .hdr or .exr, equirectangular
    #[arg(long, value_name = "FILE")]
    hdri: Option<PathBuf>,
    /// Turn that sphere about the vertical, in degrees, anticlockwise as seen from above
    #[arg(long, value_name = "DEG", allow_negative_numbers = true)]
    hdri_rotation: Option<f32>,
    /// Blur that sphere behind the head, in degrees; its light stays as it is
    #[arg(long, value_name = "DEG", allow_negative_numbers = true)]
    hdri_blur: Option<f32>,
    /// Brighter or darker than the lights' own exposure, in stops: what is saved with the groom's lights, else 0
    #[arg(long, value_name = "EV", allow_negative_numbers = true)]
    exposure: Option<f32>,
    /// How a .png is made for a display: agx, srgb, rec1886
    #[arg(long, value_name = "TRANSFORM", default_value = "agx")]
    display: String,
    /// How hair scatters light: karis, chiang, kajiya-kay
    #[arg(long, value_name = "MODEL", default_value = "karis")]
    model: String,
    /// Skin of the head: file, the colours and normal maps that its own file brings; 1 (lightest) to 10 on the Monk scale; clay;
    /// auto, the file's where it has a colour map and else 5. Without it the one saved with the groom, else auto
    #[arg(long, value_name = "auto|file|1..10|clay")]
    skin: Option<String>,
    /// See through hair: 1 is hair, 0.1 shows roots and skin
    #[arg(long, value_name = "0..1", default_value_t = 1.0, allow_negative_numbers = true)]
    opacity: f32,
    /// Share of the strands that is drawn; the others' widths are added to theirs
    #[arg(long, value_name = "0..1", default_value_t = 1.0, allow_negative_numbers = true)]
    share: f32,
    /// Draw a colour chart, a grey and a chrome ball into the lower left corner
    #[arg(long)]
    chart: bool,
    /// Only hair
    #[arg(long)]
    no_head: bool,
    /// No ground under the head; from below none is drawn anyway
    #[arg(long)]
    no_floor: bool,
    /// Write what was made, and what happened, as JSON to a file (- for stdout)
    #[arg(long, value_name = "FILE|-")]
    report: Option<PathBuf>,
}

/// The most pictures of a turntable, and the most samples in a pixel.
const MOST_FRAMES: u32 = 9999;
const MOST_SAMPLES: u32 = 65536;

/// What the words ask for.
struct Asked {
    size: [u32; 2],
    formats: Vec<Format>,
    frames: u32,
    samples: u32,
    /// None where nobody asked for one.
    focal_mm: Option<f32>,
    show: Show,
    rig: Rig,
    transform: Transform,
    look: Look,
    skin: Skin,
}

impl RenderArgs {
    /// What lights the picture, in words.
    fn lit_by(&self) -> String {
        match (&self.hdri, &self.light) {
            (Some(path), _) => path.display().to_string(),
            (None, light) => light.as_deref().unwrap_or(Rig::NAMES[0]).to_owned(),
        }
    }

    /// With the light and skin that are saved with the groom where nothing else is asked for. Those that this version does not
    /// know are told.
    fn as_saved(&self, document: &Document, warnings: &mut Vec<String>) -> Self {
        let mut args = self.clone();
        let Some(look) = &document.look else { return args };
        let mut unknown = |what: &str, word: &str| {
            warnings.push(format!(
                "look: this version has no {what} {word:?}: its own is taken; --{what} chooses another"
            ));
        };
        if args.light.is_none() && args.hdri.is_none() {
            if Rig::NAMES.contains(&look.light.as_str()) {
                args.light = Some(look.light.clone());
                args.exposure = args.exposure.or(Some(look.exposure));
            } else {
                unknown("light", &look.light);
            }
        }
        if args.skin.is_none() {
            match look.skin.parse::<Skin>() {
                Ok(_) => args.skin = Some(look.skin.clone()),
                Err(_) => unknown("skin", &look.skin),
            }
        }
        args
    }

    /// Refuses words that mean nothing, in one line each.
    fn understood(&self) -> Result<Asked, Stop> {
        let show = self.view.parse();
        let show: Show = show.map_err(|reason| Stop::refused(format!("--view {reason}")))?;
        let models = Model::ALL.map(Model::name);
        let displays = Transform::ALL.map(|t| t.name().to_lowercase().replace('.', ""));
        let displays = displays.each_ref().map(String::as_str);
        let display =
            |text: &str| displays.iter().position(|name| *name == text).map(|i| Transform::ALL[i]);
        Ok(Asked {
            size: options::size(&self.size)?,
            formats: options::files(&self.out, self.series()?)?,
            frames: match self.turntable {
                Some(n) => options::counted("--turntable", n, MOST_FRAMES)?,
                None => 1,
            },
            samples: options::counted("--samples", self.samples, MOST_SAMPLES)?,
            focal_mm: self
                .focal
                .map(|focal| within("--focal", focal, (1.0, 10_000.0), " mm"))
                .transpose()?,
            show,
            rig: self.rig()?,
            transform: options::named("--display", &self.display, &displays, display)?,
            look: Look {
                model: options::named("--model", &self.model, &models, Model::named)?,
                opacity: within("--opacity", self.opacity, (0.0, 1.0), "")?,
                share: within("--share", self.share, (0.001, 1.0), "")?,
                ..Look::default()
            },
            skin: match &self.skin {
                Some(skin) => {
                    skin.parse().map_err(|reason| Stop::refused(format!("--skin {reason}")))?
                }
                None => Skin::Auto,
            },
        })
    }

    /// The files of one picture, numbered from 0, seen by a camera.
    fn pictures(&self, number: u32, camera: &str) -> impl Iterator<Item = PathBuf> {
        let named =
            move |path: &PathBuf| options::called(&options::numbered(path, number + 1), camera);
        self.out.iter().map(named)
    }

    /// Tells `files` of all that will be written.
    fn claim(&self, files: &mut Together) -> Result<(), Stop> {
        let named = self.series().and_then(|series| options::files(&self.out, series));
        // Names that are none are told as such, and nothing else is written there meanwhile.
        if named.is_err() {
            return writes_all(self.out.iter().cloned(), files);
        }
        let frames = self.turntable.unwrap_or(1).min(MOST_FRAMES);
        let shots = self.camera.iter().flat_map(|camera| (0..frames).map(move |n| (n, camera)));
        writes_all(shots.flat_map(|(number, camera)| self.pictures(number, camera)), files)
    }

    /// How many pictures are drawn.
    fn series(&self) -> Result<Series, Stop> {
        match (self.turntable, self.camera.len()) {
            (Some(_), 2..) => {
                Err(Stop::refused("--turntable goes around with one --camera; several were given"))
            }
            (Some(_), _) => Ok(Series::Turntable),
            (None, 2..) => Ok(Series::Cameras),
            (None, _) => Ok(Series::One),
        }
    }

    /// Lights and surroundings: those of a name, or those of a file.
    fn rig(&self) -> Result<Rig, Stop> {
        let turn = within("--hdri-rotation", self.hdri_rotation.unwrap_or(0.0), TURNS, " degrees")?;
        let blur = within("--hdri-blur", self.hdri_blur.unwrap_or(0.0), (0.0, 180.0), " degrees")?;
        let exposure = within("--exposure", self.exposure.unwrap_or(0.0), (-20.0, 20.0), " stops")?;
        let mut rig = match (&self.light, &self.hdri) {
            (Some(_), Some(_)) => {
                return Err(Stop::refused("--light and --hdri: the light comes from one of them"));
            }
            (light, None) => {
                if self.hdri_rotation.or(self.hdri_blur).is_some() {
                    let text = "--hdri-rotation and --hdri-blur change the sphere of --hdri, and there is none";
                    return Err(Stop::refused(text));
                }
                let name = light.as_deref().unwrap_or(Rig::NAMES[0]);
                options::named("--light", name, &Rig::NAMES, Rig::named)?
            }
            (None, Some(path)) => {
                let fault =
                    |reason: String| Stop::refused(format!("--hdri {}: {reason}", path.display()));
                let bytes = read_at_most(path, MOST_HDRI).map_err(fault)?;
                let sphere = Hdri::read(&bytes).map_err(|err| fault(err.to_string()))?;
                sphere.rig(turn, blur)
            }
        };
        rig.exposure += exposure;
        Ok(rig)
    }
}

/// The largest file of surroundings that is read: 8192 x 4096 pixels of three floats, and some room.
const MOST_HDRI: u64 = 512 << 20;
/// Degrees that may be asked for.
const TURNS: (f32, f32) = (-36000.0, 36000.0);

pub(crate) fn run(args: &RenderArgs) -> Exit {
    carry_out(
        &args.groom.graph,
        args.report.as_deref(),
        "picture",
        args.groom.strict,
        |cancel, report, files| draw(args, cancel, report, files),
        summary,
    )
}

fn draw(
    args: &RenderArgs,
    cancel: &CancelToken,
    report: &mut Report,
    files: &mut Together,
) -> Result<(), Stop> {
    if let Some(path) = &args.hdri {
        files.reads(path, format!("--hdri {}", path.display())).map_err(Stop::refused)?;
    }
    args.claim(files)?;
    args.understood()?;
    let opened = args.groom.open(report, files)?;
    let args = &args.as_saved(&opened.document, &mut report.warnings);
    let asked = args.understood()?;
    let bar = Bar::new("nodes");
    let drawn = draw_opened(args, &asked, &opened, cancel, &bar, report, files);
    bar.clear();
    drawn
}

/// Draws a graph as somebody has it open. `words` are those of `coif render`, with any graph.
#[cfg(feature = "editor")]
pub(crate) fn draw_open(
    words: &[String],
    opened: &Opened,
    cancel: &CancelToken,
    tell: &dyn Tell,
    report: &mut Report,
    files: &mut Together,
) -> Result<(), Stop> {
    let args = in_words(words.iter().map(String::as_str))?;
    args.claim(files)?;
    draw_opened(&args, &args.understood()?, opened, cancel, tell, report, files)
}

/// What words of `coif render` ask for.
fn in_words<'a>(words: impl Iterator<Item = &'a str>) -> Result<Box<RenderArgs>, Stop> {
    use clap::Parser;
    let words = ["coif", "render"].into_iter().chain(words);
    let args = super::Args::try_parse_from(words).map_err(|err| Stop::refused(err.to_string()))?;
    match args.command {
        Some(super::Command::Render(args)) => Ok(args),
        _ => Err(Stop::refused("no picture was asked for")),
    }
}

/// Draws a graph into memory: one picture, as words of `coif render` describe it, and how it is displayed.
pub(super) fn draw_one(
    words: &[&str],
    opened: &Opened,
    cancel: &CancelToken,
    tell: &dyn Tell,
    files: &mut Together,
) -> Result<(Picture, Transform, f32), Stop> {
    let args = in_words(words.iter().copied())?;
    let asked = args.understood()?;
    let (mut drawn, mut report) = (None, Report::new(String::new()));
    let mut keep = |_: &mut Together, shot: Shot| {
        drawn = Some(shot.picture);
        Ok(vec![])
    };
    draw_shots(&args, &asked, opened, cancel, tell, &mut report, files, &mut keep)?;
    let drawn = drawn.ok_or_else(|| Stop::failed("nothing was drawn"))?;
    Ok((drawn, asked.transform, asked.rig.exposure))
}

/// One picture of a series.
struct Shot<'a> {
    number: u32,
    camera: &'a str,
    picture: Picture,
    texts: &'a [(String, String)],
}

/// What becomes of each picture: the names of the files that hold it.
type Keep<'a> = &'a mut dyn FnMut(&mut Together, Shot) -> Result<Vec<String>, Stop>;

fn draw_opened(
    args: &RenderArgs,
    asked: &Asked,
    opened: &Opened,
    cancel: &CancelToken,
    tell: &dyn Tell,
    report: &mut Report,
    files: &mut Together,
) -> Result<(), Stop> {
    let mut keep = |files: &mut Together, shot: Shot| {
        let Shot { number, camera, picture, texts } = shot;
        let mut written = vec![];
        for (path, format) in args.pictures(number, camera).zip(&asked.formats) {
            tell.say(format!("writing {}", path.display()));
            let done = files.write(&path, cancel, |out| {
                let done = match format {
                    Format::Png => {
                        picture.write_png(out, asked.transform, asked.rig.exposure, texts)
                    }
                    Format::Exr => picture.write_exr(out, Samples::Half, texts),
                };
                done.map_err(|err| err.to_string())
            });
            done.map_err(|reason| Stop::unwritten(&path, &reason, cancel))?;
            written.push(path.display().to_string());
        }
        Ok(written)
    };
    draw_shots(args, asked, opened, cancel, tell, report, files, &mut keep)
}

fn draw_shots(
    args: &RenderArgs,
    asked: &Asked,
    opened: &Opened,
    cancel: &CancelToken,
    tell: &dyn Tell,
    report: &mut Report,
    files: &mut Together,
    keep: Keep,
) -> Result<(), Stop> {
    let places = args.camera.iter().map(|name| Place::of(name, opened));
    let places = places.collect::<Result<Vec<Place>, Stop>>()?;
    let followed = match asked.show {
        Show::Hair(_) => vec![],
        Show::Guides | Show::Clusters => {
            feeders(&opened.document, opened.outputs.iter().map(|output| &output.socket.node))
        }
    };
    let more: Vec<Socket> =
        followed.iter().chain(places.iter().filter_map(Place::socket)).cloned().collect();
    if followed.is_empty() && !matches!(asked.show, Show::Hair(_)) {
        return Err(Stop::refused(format!(
            "--view {}: no node on the way to the outputs makes hair that follows curves",
            args.view
        )));
    }
    opened.refuse_problems(&more, &mut report.warnings)?;
    let named = match (asked.skin, args.no_head) {
        (Skin::Tone(_), _) | (_, true) => vec![],
        _ => opened.head_files(&more),
    };
    let named: Vec<Option<Named>> =
        named.into_iter().map(|file| file.and_then(|file| Named::read(&file))).collect();
    for path in named.iter().flatten().flat_map(|named| &named.beside) {
        let words = format!("{} of the head", path.display());
        files.reads(path, words).map_err(Stop::refused)?;
    }
    files.allowed().map_err(Stop::failed)?;
    let decoding = std::thread::spawn(move || {
        let decoded = |named: Option<Named>| named.map(|named| Arc::new(named.decoded()));
        named.into_iter().map(decoded).collect::<Vec<_>>()
    });
    let shading = match asked.show {
        Show::Hair(View::Hair) => Shading::Hair,
        _ => Shading::Colour,
    };
    let device = Device::start(asked.size, asked.look, shading, cancel);
    let began = Instant::now();
    let evaluated = args.groom.evaluate_telling(opened, &more, cancel, tell, report);
    let evaluation_ms = since(began);
    let mut evaluated = match evaluated {
        // What the device's failure ended was not interrupted by anybody.
        Err(stop) if stop.is_interruption() => return Err(device.failure().unwrap_or(stop)),
        evaluated => evaluated?,
    };
    let (mut renderer, device_ms) = device.wait()?;
    let began = Instant::now();
    let frame = evaluated.scalps.first().map_or(HeadFrame::IDENTITY, |scalp| *scalp.frame());
    let closest = evaluated.more.split_off(followed.len());
    let looks =
        decoding.join().map_err(|_| Stop::failed("a picture of the head cannot be read"))?;
    let scene = Scene::of(asked, args, evaluated, &looks, &mut report.warnings)?;
    let mut closest = closest.iter();
    let stills = places
        .iter()
        .map(|place| place.camera(asked, &scene, place.socket().and_then(|_| closest.next())));
    let stills = stills.collect::<Result<Vec<Camera>, Stop>>()?;
    let description = describe(args, asked, &scene);
    renderer.set_look(&asked.look);
    renderer.set_rig(&asked.rig);
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
        ("view".to_owned(), args.view.clone()),
        ("camera".to_owned(), String::new()),
        ("light".to_owned(), args.lit_by()),
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
        let camera = still.turned(frame.origin, frame.up, turn);
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
        if args.chart {
            chart::draw(&mut picture, &asked.rig, &camera);
        }
        let shot = Shot { number, camera: &place.name, picture, texts: &texts };
        pictures.extend(keep(files, shot)?);
    }
    report.picture = Some(About {
        files: pictures,
        width: asked.size[0],
        height: asked.size[1],
        description,
        view: args.view.clone(),
        camera: args.camera.join(", "),
        light: args.lit_by(),
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
}

impl Scene {
    fn of(
        asked: &Asked,
        args: &RenderArgs,
        evaluated: Evaluated,
        looks: &[Option<Arc<FileLooks>>],
        warnings: &mut Vec<String>,
    ) -> Result<Self, Stop> {
        let Evaluated { groups, scalps, more, sections: _ } = evaluated;
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
        let (mut solids, remarks) = match args.no_head {
            true => (vec![], vec![]),
            false => scene::heads(&scalps, asked.skin, looks),
        };
        warnings.extend(remarks);
        if args.no_floor {
            solids.retain(|solid| solid.material != Material::Ground);
        }
        let Dressed { drawn, paint, tubes, roots } =
            Dressed::of(&asked.show, &hair, &followed, scalp.as_deref())
                .map_err(|reason| Stop::failed(format!("--view {}: {reason}", args.view)))?;
        solids.extend(tubes);
        let frame = scalp.as_ref().map_or(HeadFrame::IDENTITY, |scalp| *scalp.frame());
        let followed = followed.curve_count();
        Ok(Self { frame, scalp, hair, followed, drawn, paint, solids, roots })
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
fn describe(args: &RenderArgs, asked: &Asked, scene: &Scene) -> String {
    let (strands, points) = (scene.hair.curve_count(), scene.hair.point_count());
    let quality = match args.groom.quality {
        QualityArg::Final => "final",
        QualityArg::Preview => "preview (the first tenth)",
    };
    let mut text = format!("{quality}, {} strands, {} points", grouped(strands), grouped(points));
    match asked.show {
        Show::Hair(_) => {}
        Show::Guides | Show::Clusters => {
            text += &format!(", shown as {} {}", grouped(scene.followed), args.view);
        }
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

/// What was made, for a person.
fn summary(report: &Report) -> String {
    let Some(picture) = &report.picture else { return String::new() };
    let memory = report.peak_rss_mib.map_or(String::new(), |m| format!(", {m:.0} MiB"));
    let mut text = format!(
        "{}\n{} samples a pixel on {}\nevaluation {:.2} s, first sample {:.2} s, all {:.2} s{memory}",
        picture.description,
        picture.samples,
        picture.adapter,
        picture.evaluation_ms / 1e3,
        picture.first_sample_ms / 1e3,
        report.total_ms / 1e3,
    );
    match &picture.files[..] {
        [first, .., last] if picture.files.len() > 4 => {
            text += &format!("\nwrote {first} to {last}");
        }
        files => files.iter().for_each(|file| text += &format!("\nwrote {file}")),
    }
    text
}
