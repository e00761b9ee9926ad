//! What Unreal Engine's groom asset can hold (artists.md, pain 13; the limits are those of the engine's
//! importer): 255 points on a curve, 16,777,216 points in a group.

use super::groom::{Stop, outputs};
use coif_graphs::document::{Document, Socket};
use coif_graphs::schedule::files::DiskFiles;
use coif_graphs::schedule::request::plan;
use coif_graphs::schedule::run::{CancelToken, Evaluator, OnFailure, Quiet};
use coif_nodes::define::Value;
use coif_nodes::eval::Quality;
use std::path::PathBuf;

/// Points a curve may have.
const POINTS_A_CURVE: usize = 255;
/// Points a group may have.
const POINTS_A_GROUP: usize = 1 << 24;

/// Evaluates the document's outputs and tells what is over the limits, one line each.
pub(super) fn limits(document: &Document, folder: PathBuf) -> Result<Vec<String>, Stop> {
    let wanted = outputs(document, &[])?;
    let targets: Vec<Socket> = wanted.iter().map(|w| w.socket.clone()).collect();
    let plan = plan(document, &targets, Quality::Final, &DiskFiles::new(folder))
        .map_err(|err| Stop::refused(err.to_string()))?;
    let evaluator = Evaluator::new(0, 0).map_err(Stop::refused)?;
    let outcome = evaluator.run(&plan, OnFailure::Stop, &CancelToken::default(), &Quiet);
    let mut over = vec![];
    for node in &outcome.nodes {
        over.extend(node.error.iter().map(|err| format!("{}: {err}", node.name)));
    }
    for (socket, value) in targets.iter().zip(&outcome.targets) {
        let Some(Value::Curves(curves)) = value else { continue };
        let long = curves.each().filter(|(t, i)| t.range(*i).len() > POINTS_A_CURVE).count();
        let most = curves.each().map(|(t, i)| t.range(i).len()).max().unwrap_or(0);
        if long > 0 {
            over.push(format!(
                "{socket}: {long} curves have more than {POINTS_A_CURVE} points (the longest {most}), which Unreal cuts; \
                 resample them, or make coils with fewer points a turn"
            ));
        }
        if curves.point_count() > POINTS_A_GROUP {
            over.push(format!(
                "{socket}: {} points are more than the {POINTS_A_GROUP} of an Unreal group; split it into groups",
                curves.point_count()
            ));
        }
    }
    Ok(over)
}
