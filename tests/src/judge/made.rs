//! Grooms and recipes made in this process, as a file of coif has them.

use super::Soup;
use coif_graphs::document::{Document, Setting, Socket};
use coif_graphs::file;
use coif_graphs::schedule::files::DiskFiles;
use coif_graphs::schedule::request::plan;
use coif_graphs::schedule::run::{CancelToken, Evaluator, OnFailure, Quiet};
use coif_nodes::data::scalp::{HeadFrame, Scalp};
use coif_nodes::define::Value;
use coif_nodes::eval::Quality;
use coif_nodes::formats::conform::conform;
use coif_nodes::formats::export::{About, Format, HairGroup, write};
use coif_nodes::formats::usd::read::{ReadCurves, read_stage};
use glam::DVec3;
use std::io::Cursor;
use std::path::Path;
use std::sync::Arc;

/// Hair on a head.
pub struct Made {
    /// The prims of hair as a reader of the written file finds them, guides left out.
    pub curves: Vec<ReadCurves>,
    /// The skin of the head in centimetres, as it was evaluated: coif scales the mesh of the file, and turns what has Z up. Inner
    /// walls of hollow heads and what was left out are no skin.
    pub skin: Soup,
    /// Where the head is, for naming places.
    pub frame: HeadFrame,
    /// Curves that the export left out because it found no way out of the skin, or kept all the same.
    pub astray: usize,
}

/// Makes the hair of a graph, given as its text; paths in it are from `folder`. `head` is the mesh for all of its heads.
///
/// # Errors
/// It is no graph, or it does not evaluate to hair on a head.
pub fn make(
    text: &str,
    folder: &Path,
    head: Option<&Path>,
    quality: Quality,
    evaluator: &Evaluator,
) -> Result<Made, String> {
    let document = document_on(text, head)?;
    let outputs = sockets(&document, "groom_output", "curves");
    let (heads, parted) =
        (sockets(&document, "head", "scalp"), sockets(&document, "partings", "scalp"));
    let targets: Vec<Socket> = [&outputs[..], &heads, &parted].concat();
    let mut given = evaluated(&document, &targets, folder, quality, evaluator)?.into_iter();
    let hair: Vec<Option<Value>> = given.by_ref().take(outputs.len()).collect();
    let head = only_head(given.by_ref().take(heads.len()))?;
    let parted: Vec<Arc<Scalp>> = scalps(given).collect();
    let cancel = CancelToken::default();
    let host = evaluator.host(&cancel);
    let (mut groups, mut astray) = (vec![], 0);
    for (socket, value) in outputs.iter().zip(hair) {
        let node = document.node(socket.node.as_str());
        let is_guide = node.and_then(|node| node.inputs.get("guides"));
        let Some(Value::Curves(curves)) = value else { continue };
        if matches!(is_guide, Some(Setting::Known(Value::Bool(true)))) || curves.curve_count() == 0
        {
            continue;
        }
        let skin = head.skin().for_hair();
        let conformed = conform(&curves, skin, &parted, false, &host).ok_or("stopped")?;
        astray += conformed.changes.astray;
        let (name, curves) = (socket.node.to_string(), conformed.curves);
        groups.push(HairGroup { name, guides: false, curves });
    }
    Ok(Made { curves: written(&groups)?, skin: skin(&head)?, frame: *head.frame(), astray })
}

/// The skin and the frame of the head that a graph puts its hair on, as [`make`] has them.
///
/// # Errors
/// It is no graph, or it has not one head.
pub fn head_of(
    text: &str,
    folder: &Path,
    head: Option<&Path>,
    evaluator: &Evaluator,
) -> Result<(Soup, HeadFrame), String> {
    let document = document_on(text, head)?;
    let heads = sockets(&document, "head", "scalp");
    let given = evaluated(&document, &heads, folder, Quality::Preview, evaluator)?;
    let head = only_head(given.into_iter())?;
    Ok((skin(&head)?, *head.frame()))
}

fn document_on(text: &str, head: Option<&Path>) -> Result<Document, String> {
    let mut document = file::read(text).map_err(|err| err.to_string())?.document;
    head.inspect(|head| put_on(&mut document, head));
    Ok(document)
}

/// An output of all nodes of a kind.
fn sockets(document: &Document, kind: &str, output: &str) -> Vec<Socket> {
    let nodes = document.nodes.iter().filter(|(_, node)| node.kind == kind);
    nodes.map(|(id, _)| Socket::new(id.clone(), output)).collect()
}

fn evaluated(
    document: &Document,
    targets: &[Socket],
    folder: &Path,
    quality: Quality,
    evaluator: &Evaluator,
) -> Result<Vec<Option<Value>>, String> {
    let plan =
        plan(document, targets, quality, &DiskFiles::new(folder)).map_err(|err| err.to_string())?;
    let outcome = evaluator.run(&plan, OnFailure::Stop, &CancelToken::default(), &Quiet);
    let failed = outcome.nodes.iter().find_map(|node| Some((&node.name, node.error.as_ref()?)));
    match failed {
        Some((node, err)) => Err(format!("{node}: {err}")),
        None => Ok(outcome.targets),
    }
}

fn scalps(given: impl Iterator<Item = Option<Value>>) -> impl Iterator<Item = Arc<Scalp>> {
    given.filter_map(|value| match value {
        Some(Value::Scalp(scalp)) => Some(scalp),
        _ => None,
    })
}

fn only_head(given: impl Iterator<Item = Option<Value>>) -> Result<Arc<Scalp>, String> {
    let heads: Vec<_> = scalps(given).collect();
    match &heads[..] {
        [head] => Ok(head.clone()),
        heads => Err(format!("{} heads, not one", heads.len())),
    }
}

/// Puts another mesh under all heads of a graph.
fn put_on(document: &mut Document, mesh: &Path) {
    let heads = document.nodes.iter_mut().filter(|(_, node)| node.is_head());
    for (id, node) in heads {
        let text = Value::Text(mesh.to_string_lossy().into());
        Arc::make_mut(node).inputs.insert("mesh".to_owned(), Setting::Known(text));
        document.links.remove(&Socket::new(id.clone(), "mesh"));
    }
}

/// Curves as a reader finds them in the file that is written of them.
fn written(groups: &[HairGroup]) -> Result<Vec<ReadCurves>, String> {
    let about = About {
        title: "judged".to_owned(),
        generator: "coif".to_owned(),
        graph_hash: String::new(),
        seed: 0,
        sections: [].into(),
    };
    let mut file = Cursor::new(vec![]);
    write(Format::Usdc, groups, &[], &about, &mut file, &|| false)
        .map_err(|err| err.to_string())?;
    let nothing = &mut |_: &str| Err("there is nothing beside it".to_owned());
    let read = read_stage(file.get_ref(), "judged.usdc", nothing).map_err(|err| err.to_string())?;
    match read.left_out.first() {
        Some(left) => Err(format!("{}: {}", left.path, left.reason)),
        None => Ok(read.curves),
    }
}

/// Positions and triangles of what is skin.
fn skin(head: &Scalp) -> Result<Soup, String> {
    let surface = head.surface();
    let points: Vec<_> = surface.points.iter().map(|p| p.as_dvec3()).collect();
    let all = (0..).zip(&surface.triangles);
    let own: Vec<[u32; 3]> =
        all.filter(|(t, _)| !surface.is_gone(*t)).map(|(_, corners)| *corners).collect();
    Soup::new(&points, &own).ok_or_else(|| "the head has no triangles".to_owned())
}

/// What is about a place of a head, for people: roughly, by the head's own frame.
pub fn region(at: DVec3, frame: &HeadFrame) -> &'static str {
    let own = frame.head_from_point(at.as_vec3());
    let (x, y, z) = (own.x.abs(), own.y, own.z);
    match () {
        () if y < -13.0 && (x > 7.0 || z.abs() > 7.0 || y < -17.0) => "shoulder",
        () if y < -9.0 && z < 4.0 => "neck",
        () if x > 6.2 && (-7.0..1.5).contains(&y) && z < -2.0 => "behind the ear",
        () if x > 6.2 && (-7.0..1.5).contains(&y) && z < 3.0 => "ear",
        () if y < -5.0 && z < 0.0 => "nape",
        () if z > 5.0 && y < 3.0 => "face",
        () if y > 5.0 => "top",
        () if z < -4.0 => "back",
        () => "side",
    }
}
