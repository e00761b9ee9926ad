//! `coif probe`: what a picture shows at a place, without drawing it.

use super::groom::GroomArgs;
use super::progress::Bar;
use super::render::{CAMERA, SIZE, words};
use super::{Exit, answer, ending};
use crate::files::Together;
use crate::jobs::render::RenderRequest;
use crate::jobs::render::probe::{Probed, probe};
use crate::jobs::report::Report;
use crate::jobs::stop::Stop;
use crate::words::plain_json;
use clap::Args;
use coif_graphs::schedule::run::CancelToken;
use coif_nodes::define::short;

#[derive(Args)]
pub(crate) struct ProbeArgs {
    #[command(flatten)]
    groom: GroomArgs,
    /// The place: share of the picture's width and height from its upper left corner, 0.5,0.5 in the middle. May be given several times
    #[arg(long, value_name = "X,Y", required = true, allow_hyphen_values = true)]
    at: Vec<String>,
    /// As of coif render: front, left, crown and the like, a view that was saved in the graph, or close:NODE
    #[arg(long, value_name = "NAME|SAVED|close:NODE", default_value = CAMERA)]
    camera: String,
    /// Width and height of the picture in pixels
    #[arg(long, value_name = "WIDTHxHEIGHT", default_value = SIZE, allow_hyphen_values = true)]
    size: String,
    /// Focal length over a film 24 mm high: 85, or a saved view's own
    #[arg(long, value_name = "MM", allow_negative_numbers = true)]
    focal: Option<f32>,
    /// Print JSON instead of words
    #[arg(long)]
    json: bool,
}

/// Most places of one command.
const MOST_PLACES: usize = 1000;

pub(crate) fn run(args: &ProbeArgs) -> Exit {
    ending::at_once();
    let mut report = Report::new(args.groom.graph.display().to_string());
    let found = probed(args, &mut report);
    answer(report, found)
}

/// What is printed.
fn probed(args: &ProbeArgs, report: &mut Report) -> Result<String, Stop> {
    if args.at.len() > MOST_PLACES {
        let n = args.at.len();
        return Err(Stop::refused(format!(
            "--at: {n} places were given, {MOST_PLACES} at most are looked at"
        )));
    }
    let places = args.at.iter().map(|text| place(text)).collect::<Result<Vec<_>, Stop>>()?;
    let focal = |focal| words::within("--focal", focal, (1.0, 10_000.0), " mm");
    let asked = RenderRequest {
        size: words::size(&args.size)?,
        cameras: vec![args.camera.clone()],
        focal_mm: args.focal.map(focal).transpose()?,
        quality: args.groom.quality(),
        threads: args.groom.threads,
        ..RenderRequest::default()
    };
    let opened = args.groom.open(report, &mut Together::default())?;
    let bar = Bar::new("nodes");
    let probed = probe(&asked, &places, &opened, &CancelToken::default(), &bar, report);
    bar.clear();
    let probed = probed?;
    Ok(match args.json {
        true => plain_json(&serde_json::to_string_pretty(&probed).unwrap_or_default()),
        false => probed.iter().map(in_words).collect(),
    })
}

/// A place of the picture, 0 to 1 across and down.
fn place(text: &str) -> Result<[f32; 2], Stop> {
    let numbers: Vec<f32> = text.split(',').filter_map(|word| word.trim().parse().ok()).collect();
    match (&numbers[..], text.split(',').count()) {
        ([x, y], 2) if numbers.iter().all(|x| (0.0..=1.0).contains(x)) => Ok([*x, *y]),
        _ => Err(Stop::refused(format!(
            "--at {}: write it as X,Y, each from 0 (left, top) to 1 (right, bottom)",
            short(text)
        ))),
    }
}

fn in_words(Probed { at: [x, y], skin, hair }: &Probed) -> String {
    let three = |[x, y, z]: &[f32; 3]| format!("{x:.3},{y:.3},{z:.3}");
    let mut text = format!("{x},{y}\n");
    match skin {
        None => text += "  no skin\n",
        Some(skin) => {
            let [u, v] = skin.bary;
            text +=
                &format!("  skin at {} cm, {} in head units\n", three(&skin.cm), three(&skin.head));
            text += &format!("    triangle {} ({u:.3}, {v:.3})", skin.triangle);
            text += &format!(", region {:.0} %", 100.0 * skin.region);
            for section in &skin.sections {
                text += &format!(", section {section}");
            }
            text += &format!(", {:.1} cm from the eye\n", skin.distance);
        }
    }
    match hair {
        None => text += "  no hair\n",
        Some(hair) => {
            text += &format!(
                "  hair {} of {}, {:.0} % along it\n",
                hair.id,
                hair.group,
                100.0 * hair.along
            );
            text += &format!("    at {} cm", three(&hair.cm));
            if let Some(above) = hair.above {
                text += &format!(", {above:.2} cm above the skin");
            }
            text += &format!(", {:.1} cm from the eye\n", hair.distance);
        }
    }
    text
}
