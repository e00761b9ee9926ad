//! `coif render`: a saved graph to pictures.
//!
//! What is wrong with the words is said before anything runs.

pub(super) mod words;

use super::Exit;
use super::carry_out::carry_out;
use super::groom::GroomArgs;
use super::progress::Bar;
use crate::files::Together;
use crate::jobs::open::writes_all;
use crate::jobs::render::files::{self, Format, Series};
use crate::jobs::render::{self, MOST_FRAMES, MOST_SAMPLES, RenderRequest, Turns};
use crate::jobs::report::Report;
use crate::jobs::stop::Stop;
use crate::scene::lights::{Lights, Surroundings};
use crate::scene::{Show, Skin};
use clap::Args;
use coif_graphs::document::Document;
use coif_graphs::schedule::run::CancelToken;
use coif_shaders::display::Transform;
use coif_shaders::light::Rig;
use coif_shaders::{Look, Model};
use std::path::PathBuf;
use words::within;

/// What is taken where nobody asks for another.
pub(super) const SIZE: &str = "1280x720";
pub(super) const CAMERA: &str = "three-quarter";
const SAMPLES: u32 = 64;
const VIEW: &str = "hair";
const DISPLAY: &str = "agx";
const MODEL: &str = "karis";
const TURNS: &str = "camera";
/// What may be behind the head.
const BACKGROUNDS: [&str; 2] = ["lights", "transparent"];

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
        default_value = SIZE,
        allow_hyphen_values = true
    )]
    size: String,
    /// front, left, right, back, top, under, three-quarter, crown, nape, hairline, temple-left, temple-right, a view that was
    /// saved in the graph, or close:NODE to fill the picture with what NODE gives. Given several times:
    /// as many pictures of one evaluation, with %s in the file's name for theirs
    #[arg(long, value_name = "NAME|SAVED|close:NODE", default_value = CAMERA)]
    camera: Vec<String>,
    /// Focal length over a film 24 mm high: 85, or a saved view's own
    #[arg(long, value_name = "MM", allow_negative_numbers = true)]
    focal: Option<f32>,
    /// This many pictures around the head; %04d in the file's name becomes their number, from 1
    #[arg(long, value_name = "N")]
    turntable: Option<u32>,
    /// What goes round in a turntable: camera, light
    #[arg(long, value_name = "WHAT", default_value = TURNS)]
    turn: String,
    /// Samples in a pixel: 1 is grainy, 64 a clean still
    #[arg(long, value_name = "N", default_value_t = SAMPLES)]
    samples: u32,
    /// What is shown: hair; guides, the curves that hair follows; clusters, the same as tubes; or an attribute as colours
    #[arg(long, value_name = "hair|guides|clusters|ATTRIBUTE", default_value = VIEW)]
    view: String,
    /// Lights: studio, backlit, overcast, flat, dark-hair, neutral; else those saved with the groom, else studio
    #[arg(long, value_name = "RIG")]
    light: Option<String>,
    /// Light from a photographed sphere instead: .hdr or .exr, equirectangular
    #[arg(long, value_name = "FILE")]
    hdri: Option<PathBuf>,
    /// Turn the lights, or that sphere, about the vertical, in degrees, anticlockwise as seen from above: what is saved with the
    /// groom's lights, else 0
    #[arg(
        long,
        visible_alias = "hdri-rotation",
        value_name = "DEG",
        allow_negative_numbers = true
    )]
    light_rotation: Option<f32>,
    /// Blur that sphere behind the head, in degrees; its light stays as it is
    #[arg(long, value_name = "DEG", allow_negative_numbers = true)]
    hdri_blur: Option<f32>,
    /// Brighter or darker than the lights' own exposure, in stops: what is saved with the groom's lights, else 0
    #[arg(long, value_name = "EV", allow_negative_numbers = true)]
    exposure: Option<f32>,
    /// How a .png is made for a display: agx, srgb, rec1886
    #[arg(long, value_name = "TRANSFORM", default_value = DISPLAY)]
    display: String,
    /// How hair scatters light: karis, chiang, kajiya-kay
    #[arg(long, value_name = "MODEL", default_value = MODEL)]
    model: String,
    /// Skin of the head: file, the colours and normal maps that its own file brings; 1 (lightest) to 10 on the Monk scale; clay;
    /// auto, the file's where it has a colour map and else 5. Without it the one saved with the groom, else auto
    #[arg(long, value_name = "auto|file|1..10|clay")]
    skin: Option<String>,
    /// Heat on the skin: where hair grows (region), or what a mask says (mask=NAME: a mask of the head, a section, or a node that
    /// paints one)
    #[arg(long, value_name = "region[=NODE]|mask=NAME")]
    overlay: Option<String>,
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
    /// What is seen behind the head: lights, the backdrop that goes with them; transparent, nothing, with coverage in the alpha channel
    /// and no ground
    #[arg(long, value_name = "WHAT", default_value = BACKGROUNDS[0])]
    background: String,
    /// No ground under the head; from below none is drawn anyway
    #[arg(long)]
    no_floor: bool,
    /// Write what was made, and what happened, as JSON to a file (- for stdout)
    #[arg(long, value_name = "FILE|-")]
    report: Option<PathBuf>,
}

impl RenderArgs {
    /// A picture of a groom as it is.
    fn of(graph: &str, out: &str) -> Self {
        Self {
            groom: GroomArgs::of(graph),
            out: vec![out.into()],
            size: SIZE.to_owned(),
            camera: vec![CAMERA.to_owned()],
            focal: None,
            turntable: None,
            turn: TURNS.to_owned(),
            samples: SAMPLES,
            view: VIEW.to_owned(),
            light: None,
            hdri: None,
            light_rotation: None,
            hdri_blur: None,
            exposure: None,
            display: DISPLAY.to_owned(),
            model: MODEL.to_owned(),
            skin: None,
            overlay: None,
            opacity: 1.0,
            share: 1.0,
            chart: false,
            background: BACKGROUNDS[0].to_owned(),
            no_head: false,
            no_floor: false,
            report: None,
        }
    }
}

impl RenderArgs {
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
                args.light_rotation = args.light_rotation.or(Some(look.turn));
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
    fn understood(&self) -> Result<RenderRequest, Stop> {
        let show = self.view.parse();
        let show: Show = show.map_err(|reason| Stop::refused(format!("--view {reason}")))?;
        let models = Model::ALL.map(Model::name);
        let displays = Transform::ALL.map(|t| t.name().to_lowercase().replace('.', ""));
        let displays = displays.each_ref().map(String::as_str);
        let turns = |text: &str| {
            Turns::ALL.into_iter().find(|(word, _)| *word == text).map(|(_, turns)| turns)
        };
        let display =
            |text: &str| displays.iter().position(|name| *name == text).map(|i| Transform::ALL[i]);
        Ok(RenderRequest {
            size: words::size(&self.size)?,
            files: self.files()?,
            frames: match self.turntable {
                Some(n) => words::counted("--turntable", n, MOST_FRAMES)?,
                None => 1,
            },
            turns: words::named("--turn", &self.turn, &Turns::ALL.map(|(word, _)| word), turns)?,
            samples: words::counted("--samples", self.samples, MOST_SAMPLES)?,
            focal_mm: self
                .focal
                .map(|focal| within("--focal", focal, (1.0, 10_000.0), " mm"))
                .transpose()?,
            show,
            view: self.view.clone(),
            lights: self.lights()?,
            exposure: within("--exposure", self.exposure.unwrap_or(0.0), (-20.0, 20.0), " stops")?,
            transparent: words::named("--background", &self.background, &BACKGROUNDS, |word| {
                BACKGROUNDS.iter().position(|known| *known == word)
            })? == 1,
            transform: words::named("--display", &self.display, &displays, display)?,
            look: Look {
                model: words::named("--model", &self.model, &models, Model::named)?,
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
            overlay: self
                .overlay
                .as_deref()
                .map(|text| text.parse().map_err(|why| Stop::refused(format!("--overlay {why}"))))
                .transpose()?,
            cameras: self.camera.clone(),
            chart: self.chart,
            head: !self.no_head,
            floor: !self.no_floor,
            quality: self.groom.quality(),
            threads: self.groom.threads,
        })
    }

    /// The files of pictures, with their formats.
    fn files(&self) -> Result<Vec<(PathBuf, Format)>, Stop> {
        let formats = files::formats(&self.out, self.series()?)?;
        Ok(self.out.iter().cloned().zip(formats).collect())
    }

    /// Tells `files` of all that will be written.
    fn claim(&self, files: &mut Together) -> Result<(), Stop> {
        // Names that are none are told as such, and nothing else is written there meanwhile.
        let Ok(named) = self.files() else { return writes_all(self.out.iter().cloned(), files) };
        let frames = self.turntable.unwrap_or(1).min(MOST_FRAMES);
        RenderRequest {
            files: named,
            cameras: self.camera.clone(),
            frames,
            ..RenderRequest::default()
        }
        .claim(files)
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
    fn lights(&self) -> Result<Lights, Stop> {
        let turn =
            within("--light-rotation", self.light_rotation.unwrap_or(0.0), ROTATIONS, " degrees")?;
        let blur = within("--hdri-blur", self.hdri_blur.unwrap_or(0.0), (0.0, 180.0), " degrees")?;
        match (&self.light, &self.hdri) {
            (Some(_), Some(_)) => {
                Err(Stop::refused("--light and --hdri: the light comes from one of them"))
            }
            (light, None) => {
                if self.hdri_blur.is_some() {
                    let text = "--hdri-blur needs --hdri: it blurs the picture behind the head";
                    return Err(Stop::refused(text));
                }
                let known = |name: &str| Rig::NAMES.into_iter().find(|known| *known == name);
                let name = light.as_deref().unwrap_or(Rig::NAMES[0]);
                let name = words::named("--light", name, &Rig::NAMES, known)?;
                Ok(Lights { name, around: None, turn })
            }
            (None, Some(path)) => {
                let fault =
                    |reason: String| Stop::refused(format!("--hdri {}: {reason}", path.display()));
                let around = Surroundings::read(path).map_err(fault)?;
                Ok(Lights { name: Rig::NAMES[0], around: Some((around, blur)), turn })
            }
        }
    }
}

/// Degrees that may be asked for.
const ROTATIONS: (f32, f32) = (-36000.0, 36000.0);

/// Draws a groom as it is, for somebody who waits to see anything at all: with half the samples of a still.
pub(super) fn plainly(graph: &str, out: &str) -> Exit {
    run(&RenderArgs { samples: SAMPLES / 2, ..RenderArgs::of(graph, out) })
}

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
    let drawn = render::draw(&asked, &opened, None, cancel, &bar, report, files);
    bar.clear();
    drawn
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
