//! `coif render`: a saved graph to pictures.
//!
//! What is wrong with the words is said before anything runs. The device and its shaders are made on a thread
//! while the graph is evaluated. Files appear only when every picture is complete.

mod feeders;
mod options;

use super::files::Pending;
use super::groom::{Evaluated, GroomArgs, Opened, QualityArg, Stop, carry_out};
use super::progress::Bar;
use super::report::{Picture as About, Report, rounded};
use super::Exit;
use clap::Args;
use coif_graphs::document::{NodeId, Socket};
use coif_graphs::schedule::result::document_hash;
use coif_graphs::schedule::run::CancelToken;
use coif_nodes::data::curves::Curves;
use coif_nodes::data::scalp::HeadFrame;
use coif_nodes::define::{Type, Value};
use coif_shaders::{Camera, Gpu, Look, Precision, Renderer, Subject, Viewpoint, camera};
use options::Format;
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Instant;

#[derive(Args)]
pub(crate) struct RenderArgs {
    #[command(flatten)]
    groom: GroomArgs,
    /// Picture to write: .png for a display, .exr scene-linear
    #[arg(long, value_name = "FILE")]
    out: Vec<PathBuf>,
    /// Width and height in pixels
    #[arg(long, value_name = "WIDTHxHEIGHT", default_value = "1280x720")]
    size: String,
    /// front, left, right, back, top, three-quarter, crown, nape, hairline, temple-left, temple-right, or close:NODE to fill
    /// the picture with what NODE gives
    #[arg(long, value_name = "NAME|close:NODE", default_value = "three-quarter")]
    camera: String,
    /// Focal length over a film 24 mm high
    #[arg(long, value_name = "MM", default_value_t = camera::PORTRAIT_FOCAL, allow_negative_numbers = true)]
    focal: f32,
    /// This many pictures around the head; %04d in the file's name becomes their number, from 1
    #[arg(long, value_name = "N")]
    turntable: Option<u32>,
    /// Samples in a pixel: 1 is grainy, 64 a clean still
    #[arg(long, value_name = "N", default_value_t = 64)]
    samples: u32,
    /// What is shown: hair; guides, the curves that hair follows; clusters, the same as tubes; or an attribute as colours
    #[arg(long, value_name = "hair|guides|clusters|ATTRIBUTE", default_value = "hair")]
    view: String,
    /// Lights: studio, backlit, overcast, flat, dark-hair
    #[arg(long, value_name = "RIG", default_value = "studio")]
    light: String,
    /// Light from a picture of the surroundings instead (.hdr or .exr, latitude and longitude)
    #[arg(long, value_name = "FILE")]
    hdri: Option<PathBuf>,
    /// Turn that picture about the vertical, in degrees
    #[arg(long, value_name = "DEG", allow_negative_numbers = true)]
    hdri_rotation: Option<f32>,
    /// Brighter or darker than the lights' own exposure, in stops
    #[arg(long, value_name = "EV", default_value_t = 0.0, allow_negative_numbers = true)]
    exposure: f32,
    /// How a .png is made for a display: agx, srgb, rec1886
    #[arg(long, value_name = "TRANSFORM", default_value = "agx")]
    display: String,
    /// How hair scatters light: karis, chiang, kajiya-kay
    #[arg(long, value_name = "MODEL", default_value = "karis")]
    model: String,
    /// Skin of the head: 1 (lightest) to 10 on the Monk scale, or clay
    #[arg(long, value_name = "1..10|clay", default_value = "5")]
    skin: String,
    /// See through hair: 1 is hair, 0.1 shows roots and skin
    #[arg(long, value_name = "0..1", default_value_t = 1.0, allow_negative_numbers = true)]
    opacity: f32,
    /// Share of the strands that is drawn; the others' widths are added to theirs
    #[arg(long, value_name = "0..1", default_value_t = 1.0, allow_negative_numbers = true)]
    share: f32,
    /// Show a colour chart and balls beside the head
    #[arg(long)]
    chart: bool,
    /// Only hair
    #[arg(long)]
    no_head: bool,
    /// Write what was made, and what happened, as JSON to a file (- for stdout)
    #[arg(long, value_name = "FILE|-")]
    report: Option<PathBuf>,
}

/// What the words ask for.
struct Asked {
    size: [u32; 2],
    formats: Vec<Format>,
    frames: u32,
    samples: u32,
    focal_mm: f32,
    rig: Rig,
    transform: Transform,
    look: Look,
    skin: SkinTone,
}

impl RenderArgs {
    /// Refuses words that mean nothing, in one line each.
    fn understood(&self) -> Result<Asked, Stop> {
        use options::{counted, files, named, size, within};
        let mut rig = named("--light", &self.light, &Rig::NAMES, Rig::named)?;
        rig.exposure += within("--exposure", self.exposure, -20.0, 20.0, " stops")?;
        if self.hdri_rotation.is_some() && self.hdri.is_none() {
            return Err(Stop::refused("--hdri-rotation turns the picture of --hdri, and there is none"));
        }
        if let Some(path) = &self.hdri {
            let degrees = self.hdri_rotation.unwrap_or(0.0);
            let degrees = within("--hdri-rotation", degrees, -36000.0, 36000.0, " degrees")?;
            rig.environment = environment(path)?.rotated(degrees);
        }
        Ok(Asked {
            size: size(&self.size)?,
            formats: files(&self.out, self.turntable.is_some())?,
            frames: self.turntable.map_or(Ok(1), |n| counted("--turntable", n, MOST_FRAMES))?,
            samples: counted("--samples", self.samples, MOST_SAMPLES)?,
            focal_mm: within("--focal", self.focal, 1.0, 10_000.0, " mm")?,
            rig,
            transform: named("--display", &self.display, &Transform::NAMES, Transform::named)?,
            look: Look {
                model: named("--model", &self.model, &MODELS.map(|(name, _)| name), |text| {
                    MODELS.iter().find(|(name, _)| *name == text).map(|(_, model)| *model)
                })?,
                opacity: within("--opacity", self.opacity, 0.0, 1.0, "")?,
                share: within("--share", self.share, 0.001, 1.0, "")?,
                ..Look::default()
            },
            skin: skin(&self.skin)?,
        })
    }
}

pub(crate) fn run(args: RenderArgs) -> Exit {
    carry_out(
        &args.groom.graph,
        args.report.as_deref(),
        |cancel, report| draw(&args, cancel, report),
        summary,
    )
}

fn draw(args: &RenderArgs, cancel: &CancelToken, report: &mut Report) -> Result<(), Stop> {
    let asked = args.understood()?;
    let opened = args.groom.open(report)?;
    let place = Place::of(&args.camera, &opened)?;
    let followed = match &*args.view {
        "guides" | "clusters" => feeders::feeders(
            &opened.document,
            opened.outputs.iter().map(|output| &output.socket.node),
        ),
        _ => vec![],
    };
    let more: Vec<Socket> = place.socket.iter().chain(&followed).cloned().collect();
    opened.refuse_problems(&more, &mut report.warnings)?;
    let device = Device::start(asked.size, cancel);
    let began = Instant::now();
    let evaluated = args.groom.evaluate(&opened, &more, cancel, report);
    let evaluation_ms = began.elapsed().as_secs_f64() * 1e3;
    // An evaluation that the device's failure ended is no interruption.
    let evaluated = match evaluated {
        Err(stop) if stop.is_interruption() => return Err(device.failure().unwrap_or(stop)),
        evaluated => evaluated?,
    };
    let (mut renderer, device_ms) = device.wait()?;
    todo!()
}

/// Where the picture is seen from.
struct Place {
    /// As it is called.
    name: String,
    /// A view of a head; none when `socket` gives the points to look at.
    view: Option<Viewpoint>,
    socket: Option<Socket>,
}

impl Place {
    fn of(text: &str, opened: &Opened) -> Result<Self, Stop> {
        let fault = |reason: String| Stop::refused(format!("--camera {text}: {reason}"));
        let name = text.to_owned();
        let Some(node) = text.strip_prefix("close:") else {
            let view = Viewpoint::named(text).ok_or_else(|| {
                let known = Viewpoint::NAMES.join(", ");
                fault(format!(
                    "is not one of {known}, close:NODE, and the graph has no saved cameras"
                ))
            })?;
            return Ok(Self { name, view: Some(view), socket: None });
        };
        let id = NodeId::new(node).map_err(|err| fault(err.to_string()))?;
        let found = opened.document.nodes.get(&id);
        let found = found.ok_or_else(|| fault(format!("there is no node {node:?}")))?;
        let def = coif_nodes::by_id(&found.kind)
            .ok_or_else(|| fault(format!("its kind {:?} is not known", found.kind)))?;
        let output = def.outputs.iter().find(|output| output.ty == Type::Curves);
        let output = output.ok_or_else(|| {
            fault(format!("a {} gives no curves that the picture could be filled with", def.id))
        })?;
        Ok(Self { name, view: None, socket: Some(Socket::new(id, output.name)) })
    }
}

/// A renderer in the making.
struct Device {
    thread: JoinHandle<Result<(Renderer, f64), Stop>>,
}

impl Device {
    /// Begins to make it. When that fails, whatever `cancel` stops is stopped.
    fn start(size: [u32; 2], cancel: &CancelToken) -> Self {
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
            made.map(|renderer| (renderer, began.elapsed().as_secs_f64() * 1e3))
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
