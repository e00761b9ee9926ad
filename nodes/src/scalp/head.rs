//! Head: the mesh that hair grows on, its size, where it looks and where its scalp is.
//!
//! methods.md 0.1. The mesh keeps its place: it is scaled to centimetres about its origin (and turned to Y up when its
//! file has Z up), and the head frame says where the cranium is. Hair stored in that frame fits every
//! head. Any mesh that its reader accepts gives a scalp; one without a cranium keeps its own
//! coordinates and says so.

use super::fit::{self, Face, Fit};
use super::{bust, hollow, region};
use crate::data::mesh::Mesh;
use crate::data::scalp::{HEAD_RADIUS, HeadFrame, REGION, Scalp};
use crate::data::strokes::Strokes;
use crate::define::{FileData, NodeError, choice, node};
use crate::eval::EvalCx;
use crate::formats::mesh_in::read_mesh;
use crate::maths::closest::Surface;
use crate::maths::transcendental::{acos, sin_cos};
use glam::Vec3;
use std::collections::BTreeMap;
use std::sync::Arc;

node! {
    /// The head that hair grows on: the built-in bust or a mesh file.
    ///
    /// A sphere is fitted to the cranium; its centre, its radius and the direction of the face make the head frame, in
    /// which strokes and partings are stored, so that a groom finds its place on another head. Units, axes,
    /// size and the region where hair grows are found by themselves, and every one can be set by hand.
    "head", version 1, label "Head", words "skull bust mesh scalp model import obj gltf glb surface emitter character skin";
    inputs {
        /// The head to use while no mesh file is given.
        builtin: Builtin = Builtin::Adult, words("default bust");
        /// A mesh file (.obj, .gltf or .glb), used instead of the built-in head. Its uvs, materials and vertex colours are
        /// kept as uvs and masks.
        mesh: Option<Arc<FileData>>, words("file import model");
        /// What one unit of the file measures. Auto takes what the file states, else what makes the cranium as large as a
        /// person's.
        units: Units = Units::Auto, words("scale metres centimetres inches");
        /// Centimetres in one unit of the file, when units are set to custom.
        scale: f32 = 1.0, hard(0.000001, 1000000.0), soft(0.1, 100.0), words("size");
        /// The file's axis that points up. Meshes with Z up are turned to Y up.
        up: Up = Up::Y, words("axis orientation z-up");
        /// The file's axis that the face looks along. Auto finds the plane that the head mirrors in; within 5 degrees of an
        /// axis it takes the axis.
        forward: Forward = Forward::Auto, words("axis orientation face direction");
        /// Turns forward about the up axis, for a head that looks between two axes; positive to the head's own left.
        turn: f32 = 0.0, hard(-180.0, 180.0), unit(Angle), handle(Handle::Angle), words("yaw rotate");
        /// How the head frame is found.
        fit: FitBy = FitBy::Cranium, words("sphere cranium animal creature");
        /// Radius of the cranium, used instead of the fitted one; 0 keeps what was fitted.
        radius: f32 = 0.0, hard(0.0, 1000.0), soft(0.0, 12.0), unit(Length), handle(Handle::Radius), words("size");
        /// Moves the centre of the cranium, in cm along the head's right, up and forward.
        centre: Vec3 = Vec3::ZERO, handle(Handle::Point), words("center offset origin");
        /// Where hair grows.
        region: Region = Region::Default, words("scalp area growth hairline density map");
        /// The painted mask, or the materials, that say where hair grows. Several materials are separated by commas.
        region_name: Arc<str> = "", words("vertex colour color paint material name");
        /// The hairline as one closed stroke on the head; hair grows on the crown's side of it. Further strokes enclose
        /// further regions.
        hairline: Arc<Strokes> = Strokes::default(), words("edge outline");
        /// Width over which the edge of a default or drawn region fades. 0 is a sharp edge.
        edge: f32 = 0.5, hard(0.0, 10.0), soft(0.0, 2.0), unit(Length), words("soft fade falloff");
    }
    outputs {
        /// The head with its frame, its masks and the region where hair grows.
        scalp: Arc<Scalp>;
    }
}

choice! {
    /// Heads that come with the program.
    Builtin {
        /// An adult bust with ears and neck, bald.
        Adult = "adult",
    }
}

choice! {
    /// What one unit of the file measures.
    Units {
        /// What the file states, else found from the size of the cranium.
        Auto = "auto",
        /// Millimetres.
        Millimetre = "mm",
        /// Centimetres.
        Centimetre = "cm",
        /// Metres.
        Metre = "m",
        /// Inches.
        Inch = "in",
        /// As many centimetres as scale says.
        Custom = "custom",
    }
}

choice! {
    /// The file's axis that points up.
    Up {
        /// Y up, as most files have it.
        Y = "y",
        /// Z up.
        Z = "z",
    }
}

choice! {
    /// The file's axis that the face looks along.
    Forward {
        /// Where the face looks, as found.
        Auto = "auto",
        /// Along the file's X.
        PlusX = "+x",
        /// Against the file's X.
        MinusX = "-x",
        /// Along the file's Y.
        PlusY = "+y",
        /// Against the file's Y.
        MinusY = "-y",
        /// Along the file's Z.
        PlusZ = "+z",
        /// Against the file's Z.
        MinusZ = "-z",
    }
}

choice! {
    /// How the head frame is found.
    FitBy {
        /// By the sphere that the cranium fits best.
        Cranium = "cranium",
        /// Not at all: the file's own origin and axes, for animals and things.
        None = "none",
    }
}

choice! {
    /// Where hair grows.
    Region {
        /// The mask "scalp" or "hairline" where the mesh brings one, else the usual hairline of a head; on a mesh without
        /// a cranium, everywhere.
        Default = "default",
        /// Where the painted mask of the given name is.
        Mask = "mask",
        /// Where the given materials are.
        Material = "material",
        /// Inside the drawn hairline.
        Hairline = "hairline",
    }
}

fn eval(cx: &EvalCx, inputs: Inputs) -> Result<Outputs, NodeError> {
    let mesh = match &inputs.mesh {
        Some(file) => read(file)?,
        None => match inputs.builtin {
            Builtin::Adult => bust::adult(),
        },
    };
    mesh.notes.iter().for_each(|note| cx.remark(note.clone()));
    cx.check()?;
    let (mut points, mut triangles, mut uvs) = (mesh.points, mesh.triangles, mesh.uvs);
    if inputs.up == Up::Z {
        points.iter_mut().for_each(|p| *p = y_up(*p));
    }
    let fit = match inputs.fit {
        FitBy::Cranium => fit::cranium(&points, &triangles, || cx.check())?.filter(Fit::head_like),
        FitBy::None => None,
    };
    if inputs.fit == FitBy::Cranium && fit.is_none() {
        cx.warn("no human cranium was found, so the head frame is the file's own; set fit to none");
    }
    let inside_out = fit.map_or_else(|| volume(&points, &triangles) < 0.0, |fit| fit.inside_out);
    if inside_out {
        cx.warn("the mesh is inside out, so its faces were turned round");
        triangles.iter_mut().for_each(|t| t.swap(1, 2));
        uvs.iter_mut().flatten().for_each(|uv| uv.swap(1, 2));
    }
    let scale = scale(cx, &inputs, mesh.cm_per_unit, &points, fit.as_ref());
    let looks = forward(cx, &inputs, &points, &triangles, fit.as_ref())?;
    points.iter_mut().for_each(|p| *p *= scale);
    if !points.iter().all(|p| p.is_finite() && p.length() < 1e6) {
        return Err(NodeError::failed("scaled to centimetres, the mesh is larger than 10 km"));
    }
    let frame = frame(&inputs, fit.as_ref(), scale, looks);
    if let Some(fit) = fit {
        cx.remark(format!(
            "cranium: radius {:.2} cm, half of the crown within {:.1} %, 95 % within {:.1} % of a sphere",
            frame.radius,
            fit.p50 * 100.0,
            fit.p95 * 100.0
        ));
    }
    let mut surface = Surface::new(points, triangles);
    cx.check()?;
    let mut masks = mesh.masks;
    if let Some(fit) = fit
        && let Some(wall) = {
            let (middle, radius) = (fit.centre * scale, fit.radius * scale);
            hollow::inner_wall(&surface, middle, radius, || cx.check())?
        }
    {
        cx.remark("the head is hollow: no hair grows on its inner wall, mask \"inner_wall\"");
        let mut mask = vec![0.0; surface.points.len()];
        let gone = surface.triangles.iter().zip(&wall).filter(|(_, gone)| **gone);
        gone.flat_map(|(t, _)| t).for_each(|v| mask[*v as usize] = 1.0);
        masks.insert(INNER_WALL.to_owned(), mask);
        surface = surface.without(&wall);
    }
    let of_materials = incident(&surface, &mesh.material_of, &mesh.materials);
    let of_parts = incident(&surface, &mesh.part_of, &mesh.parts);
    masks.extend(of_materials.into_iter().map(|(name, mask)| (format!("material:{name}"), mask)));
    masks.extend(of_parts.into_iter().map(|(name, mask)| (format!("part:{name}"), mask)));
    let mut grows = grows(cx, &inputs, &surface, &frame, fit.is_some(), &masks)?;
    if let Some(wall) = masks.get(INNER_WALL) {
        grows.iter_mut().zip(wall).for_each(|(grows, wall)| *grows *= 1.0 - wall);
    }
    let area = area(&surface, &grows);
    if area > 0.0 {
        cx.remark(format!("scalp: {area:.0} cm2"));
    } else {
        cx.warn("hair grows nowhere: the region is empty");
    }
    masks.insert(REGION.to_owned(), grows);
    Ok(Outputs { scalp: Arc::new(Scalp::new(surface, uvs, frame, masks).with_cm_per_unit(scale)) })
}

fn read(file: &FileData) -> Result<Mesh, NodeError> {
    let side = |name: &str| file.sides.get(name).cloned();
    read_mesh(&file.extension, &file.bytes, &side)
        .map_err(|err| NodeError::Refused { file: file.path.clone(), reason: err.to_string() })
}

/// A point or direction of a file with Z up, in Y up.
fn y_up(p: Vec3) -> Vec3 {
    Vec3::new(p.x, p.z, -p.y)
}

/// A number with the sign of the volume that the triangles enclose, seen from the middle of the box.
fn volume(points: &[Vec3], triangles: &[[u32; 3]]) -> f64 {
    let first = points.first().copied().unwrap_or_default();
    let (lo, hi) = points.iter().fold((first, first), |(lo, hi), p| (lo.min(*p), hi.max(*p)));
    let (middle, size) = ((lo + hi) * 0.5, (hi - lo).max_element().max(f32::MIN_POSITIVE));
    let corner = |v: u32| (points[v as usize] - middle) / size;
    triangles.iter().map(|t| f64::from(corner(t[0]).dot(corner(t[1]).cross(corner(t[2]))))).sum()
}

/// Centimetres in a unit of the file.
fn scale(
    cx: &EvalCx,
    inputs: &Inputs,
    stated: Option<f32>,
    points: &[Vec3],
    fit: Option<&Fit>,
) -> f32 {
    let chosen = match inputs.units {
        Units::Auto => None,
        Units::Millimetre => Some((0.1, "mm")),
        Units::Centimetre => Some((1.0, "cm")),
        Units::Metre => Some((100.0, "m")),
        Units::Inch => Some((2.54, "in")),
        Units::Custom => Some((inputs.scale, "units of the given scale")),
    };
    let believed = |cm: f32| fit.is_none_or(|fit| fit::BELIEVED.contains(&(fit.radius * cm)));
    if let Some((cm, name)) = chosen {
        if let (Some(fit), false) = (fit, believed(cm)) {
            let radius = fit.radius * cm;
            cx.warn(format!(
                "in {name} the cranium has a radius of {radius:.3} cm; a person's has 6 to 12 cm"
            ));
        }
        return cm;
    }
    match (stated, fit) {
        (Some(cm), None) => cm,
        (Some(cm), Some(_)) if believed(cm) => cm,
        (Some(cm), Some(fit)) => {
            let (factor, wrong) = (HEAD_RADIUS / fit.radius, fit.radius * cm);
            cx.warn(format!(
                "the file's units give the cranium a radius of {wrong:.3} cm, a person's has 6 to 12 cm: \
                 it was scaled to {HEAD_RADIUS} cm (custom scale {factor})"
            ));
            factor
        }
        (None, Some(fit)) => match fit::unit_of_radius(fit.radius) {
            Some((cm, name)) => {
                cx.remark(format!(
                    "the file states no units; by the size of the cranium they are {name}"
                ));
                cm
            }
            None => {
                let factor = HEAD_RADIUS / fit.radius;
                cx.warn(format!(
                    "the file states no units and none makes the cranium a person's: it was scaled to \
                     {HEAD_RADIUS} cm (custom scale {factor})"
                ));
                factor
            }
        },
        (None, None) => {
            let low = points.iter().fold(f32::MAX, |y, p| y.min(p.y));
            let high = points.iter().fold(f32::MIN, |y, p| y.max(p.y));
            let (cm, name) = fit::unit_of_height(high - low);
            cx.remark(format!(
                "the file states no units; by its height of {} they are {name}",
                high - low
            ));
            cm
        }
    }
}

/// A face that looks so far from a file's axis, degrees, is taken to look along it: heads are modelled to 2 degrees.
const SNAP_DEGREES: f32 = 5.0;
/// The same for the farthest point, which is a poor sign of where a face looks.
const SNAP_FARTHEST_DEGREES: f32 = 20.0;

/// The mask of a hollow head's inner wall.
const INNER_WALL: &str = "inner_wall";

/// Where the face looks: level and unit, Y up.
fn forward(
    cx: &EvalCx,
    inputs: &Inputs,
    points: &[Vec3],
    triangles: &[[u32; 3]],
    fit: Option<&Fit>,
) -> Result<Vec3, NodeError> {
    let z_up = inputs.up == Up::Z;
    let (axis, name) = match inputs.forward {
        Forward::Auto => return Ok(found(cx, z_up, points, triangles, fit)),
        Forward::PlusX => (Vec3::X, "+x"),
        Forward::MinusX => (Vec3::NEG_X, "-x"),
        Forward::PlusY => (Vec3::Y, "+y"),
        Forward::MinusY => (Vec3::NEG_Y, "-y"),
        Forward::PlusZ => (Vec3::Z, "+z"),
        Forward::MinusZ => (Vec3::NEG_Z, "-z"),
    };
    let axis = if z_up { y_up(axis) } else { axis };
    if axis.y != 0.0 {
        return Err(NodeError::BadValue {
            input: "forward",
            value: format!("{name:?}"),
            reason: format!("is the up axis of this file ({})", if z_up { "z" } else { "y" }),
        });
    }
    Ok(axis)
}

fn found(
    cx: &EvalCx,
    z_up: bool,
    points: &[Vec3],
    triangles: &[[u32; 3]],
    fit: Option<&Fit>,
) -> Vec3 {
    // Y up has Z forward; the same person in a file with Z up looks along -Y.
    let axes: [(Vec3, &str); 4] = [
        (Vec3::Z, if z_up { "-y" } else { "+z" }),
        (Vec3::X, "+x"),
        (Vec3::NEG_Z, if z_up { "+y" } else { "-z" }),
        (Vec3::NEG_X, "-x"),
    ];
    let Some(face) = fit.and_then(|fit| fit::face(points, triangles, fit)) else {
        if fit.is_some() {
            cx.warn(format!("no face was found: forward is {}", axes[0].1));
        }
        return Vec3::Z;
    };
    let (looks, snap) = match face {
        Face::Mirrored(looks) => (looks, SNAP_DEGREES),
        Face::Farthest(looks) => (looks, SNAP_FARTHEST_DEGREES),
    };
    let degrees = |axis: Vec3| acos(looks.dot(axis)).to_degrees();
    if let Some((axis, name)) = axes.iter().find(|(axis, _)| degrees(*axis) <= snap) {
        cx.remark(format!("forward: {name}"));
        return *axis;
    }
    let angle = if looks.x < 0.0 { -1.0 } else { 1.0 } * degrees(Vec3::Z);
    let axis = axes[0].1;
    match face {
        Face::Mirrored(_) => {
            cx.remark(format!("forward: {angle:.1} degrees from {axis}, where the face looks"));
            looks
        }
        Face::Farthest(_) => {
            cx.warn(format!(
                "the head mirrors in no plane, and its farthest point is {angle:.0} degrees from {axis}: forward is \
                 {axis}; if the face looks elsewhere, set turn"
            ));
            Vec3::Z
        }
    }
}

fn frame(inputs: &Inputs, fit: Option<&Fit>, scale: f32, looks: Vec3) -> HeadFrame {
    let (sin, cos) = sin_cos(inputs.turn.to_radians());
    let left = Vec3::Y.cross(looks);
    let forward = (looks * cos + left * sin).normalize_or(Vec3::Z);
    let mut frame = HeadFrame {
        right: Vec3::Y.cross(forward),
        forward,
        origin: fit.map_or(Vec3::ZERO, |fit| fit.centre * scale),
        radius: fit.map_or(HEAD_RADIUS, |fit| fit.radius * scale),
        ..HeadFrame::IDENTITY
    };
    frame.origin += frame.vector_from_head(inputs.centre);
    if inputs.radius > 0.0 {
        frame.radius = inputs.radius;
    }
    frame
}

/// For each name the part of the surface about each vertex that belongs to it.
fn incident(surface: &Surface, of: &[u32], names: &[String]) -> BTreeMap<String, Vec<f32>> {
    let mut all = vec![0.0f32; surface.points.len()];
    let mut out: BTreeMap<String, Vec<f32>> = BTreeMap::new();
    for (t, name) in of.iter().enumerate() {
        let Some(name) = names.get(*name as usize) else { continue };
        let weight = surface.area_vector(t as u32).length();
        if !out.contains_key(name) {
            out.insert(name.clone(), vec![0.0; surface.points.len()]);
        }
        let Some(mask) = out.get_mut(name) else { continue };
        for v in surface.triangles[t] {
            mask[v as usize] += weight;
            all[v as usize] += weight;
        }
    }
    for mask in out.values_mut() {
        for (x, all) in mask.iter_mut().zip(&all) {
            *x = if *all > 0.0 { *x / all } else { 0.0 };
        }
    }
    out
}

fn grows(
    cx: &EvalCx,
    inputs: &Inputs,
    surface: &Surface,
    frame: &HeadFrame,
    is_head: bool,
    masks: &BTreeMap<String, Vec<f32>>,
) -> Result<Vec<f32>, NodeError> {
    let unknown = |value: &str, prefix: &str| {
        let known: Vec<&str> = masks.keys().filter_map(|name| name.strip_prefix(prefix)).collect();
        NodeError::BadValue {
            input: "region_name",
            value: format!("{value:?}"),
            reason: match known.is_empty() {
                true => "is not there: the mesh has none".to_owned(),
                false => format!("is not there; the mesh has: {}", known.join(", ")),
            },
        }
    };
    let check = || cx.check();
    let softness = inputs.edge * frame.unit();
    match inputs.region {
        Region::Default => match masks.get(REGION).or_else(|| masks.get("hairline")) {
            Some(mask) => Ok(mask.clone()),
            None if is_head => region::default_region(surface, frame, softness, &check),
            None => Ok(vec![1.0; surface.points.len()]),
        },
        Region::Mask => {
            let name = inputs.region_name.trim();
            masks.get(name).cloned().ok_or_else(|| unknown(name, ""))
        }
        Region::Material => {
            let mut sum = vec![0.0f32; surface.points.len()];
            for name in inputs.region_name.split(',').map(str::trim) {
                let mask = masks
                    .get(&format!("material:{name}"))
                    .ok_or_else(|| unknown(name, "material:"))?;
                sum.iter_mut().zip(mask).for_each(|(sum, x)| *sum = (*sum + x).min(1.0));
            }
            Ok(sum)
        }
        Region::Hairline => {
            for stroke in &inputs.hairline.0 {
                let positions: Vec<Vec3> = stroke.samples.iter().map(|s| s.position).collect();
                let gap = region::gap(&positions);
                if gap > 0.2 {
                    cx.warn(format!(
                        "hairline stroke {:016x} is open: its ends were joined by a straight line",
                        stroke.id
                    ));
                }
            }
            if !inputs.hairline.0.iter().any(|s| s.samples.len() >= 3) {
                return Err(NodeError::failed("no hairline is drawn: draw a closed stroke"));
            }
            region::hairline_region(surface, frame, &inputs.hairline, softness, &check)
        }
    }
}

/// Area of a mask, cm2.
fn area(surface: &Surface, mask: &[f32]) -> f32 {
    let share = |t: &[u32; 3]| t.iter().map(|v| mask[*v as usize]).sum::<f32>() / 3.0;
    let triangles = surface.triangles.iter().enumerate();
    triangles.map(|(i, t)| share(t) * 0.5 * surface.area_vector(i as u32).length()).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::define::Value;
    use crate::testing::{fails, run};

    /// A file of the shared data; none when it is not on this machine.
    fn file(name: &str) -> Option<Arc<FileData>> {
        let root = concat!(env!("CARGO_MANIFEST_DIR"), "/../../shared/data/");
        let bytes: Arc<[u8]> = std::fs::read(format!("{root}{name}")).ok()?.into();
        let (folder, _) = name.split_once('/')?;
        let sides = crate::formats::mesh_in::side_files(name.rsplit('.').next()?, &bytes)
            .into_iter()
            .filter_map(|side| {
                let bytes = std::fs::read(format!("{root}{folder}/{side}")).ok()?;
                Some((side, bytes.into()))
            })
            .collect();
        let extension = name.rsplit('.').next()?.to_owned();
        Some(Arc::new(FileData { path: name.to_owned(), extension, bytes, sides }))
    }

    const LPS: &str = "lps_head/LeePerrySmith.glb";
    const ICT: &str = "ict_head/generic_neutral_mesh.obj";
    const SINTEL: &str = "sintel/sintel.obj";
    const SCAN: &str = "snowden_scan/snowden.obj";

    #[track_caller]
    fn head(test: &str, name: &str, set: &[(&str, Value)]) -> Option<(Arc<Scalp>, Vec<String>)> {
        let Some(file) = file(name) else {
            println!("skipped: {test} needs ../shared");
            return None;
        };
        let (out, said) = run(&NODE, &[&[("mesh", Value::File(file))], set].concat());
        match &out[0] {
            Value::Scalp(scalp) => Some((scalp.clone(), said)),
            other => panic!("{}", other.type_name()),
        }
    }

    #[test]
    fn the_cranium_of_real_heads_is_where_it_was_measured() {
        // Radius over height, radius in file units, and what 50 and 95 % of the crown keep within.
        for (name, over_height, file_radius, p50, p95) in [
            (LPS, 0.242, 1.925, 0.052, 0.17),
            (ICT, 0.264, 8.92, 0.042, 0.11),
            (SINTEL, 0.227, 0.097, 0.045, 0.16),
        ] {
            let Some(file) = file(name) else {
                println!("skipped: the_cranium_of_real_heads needs ../shared");
                return;
            };
            let mesh = read(&file).unwrap();
            let fit = fit::cranium(&mesh.points, &mesh.triangles, || Ok(())).unwrap().unwrap();
            let low = mesh.points.iter().fold(f32::MAX, |y, p| y.min(p.y));
            let high = mesh.points.iter().fold(f32::MIN, |y, p| y.max(p.y));
            let ratio = fit.radius / (high - low);
            assert!((ratio / over_height - 1.0f32).abs() < 0.01, "{name}: r/height {ratio}");
            assert!((fit.radius / file_radius - 1.0f32).abs() < 0.01, "{name}: r {}", fit.radius);
            assert!(fit.p50 < p50 && fit.p95 < p95, "{name}: {} {}", fit.p50, fit.p95);
        }
    }

    #[test]
    fn a_finer_mesh_of_the_same_surface_has_the_same_cranium() {
        let mesh = bust::adult();
        let before = fit::cranium(&mesh.points, &mesh.triangles, || Ok(())).unwrap().unwrap();
        let (mut points, mut triangles) = (mesh.points.clone(), vec![]);
        for (i, [a, b, c]) in mesh.triangles.iter().copied().enumerate() {
            if i % 3 == 0 {
                let middle = [a, b, c].iter().map(|v| points[*v as usize]).sum::<Vec3>() / 3.0;
                points.push(middle);
                let m = points.len() as u32 - 1;
                triangles.extend([[a, b, m], [b, c, m], [c, a, m]]);
            } else {
                triangles.push([a, b, c]);
            }
        }
        let after = fit::cranium(&points, &triangles, || Ok(())).unwrap().unwrap();
        assert!((after.radius / before.radius - 1.0).abs() < 1e-3, "{before:?} {after:?}");
        assert!(after.centre.distance(before.centre) < 1e-3 * before.radius);
    }

    #[test]
    fn real_heads_get_their_units_their_face_and_their_scalp() {
        // Area in cm2 of the default region.
        for (name, radius, area_cm2, says) in [
            (LPS, 8.9, 576.4, "the file's units give the cranium a radius of 193.703 cm"),
            (ICT, 8.94, 613.9, "by the size of the cranium they are cm"),
            (SINTEL, 9.73, 677.0, "by the size of the cranium they are m"),
        ] {
            let Some((scalp, said)) = head("real_heads", name, &[]) else { return };
            let frame = scalp.frame();
            assert!((frame.radius - radius).abs() < 0.01, "{name}: {}", frame.radius);
            assert!(said.iter().any(|s| s.contains(says)), "{name}: {said:?}");
            assert_eq!((frame.forward, frame.right), (Vec3::Z, Vec3::X), "{name}");
            let area = area(scalp.surface(), scalp.region());
            assert!((area - area_cm2).abs() < 2.0, "{name}: {area} cm2");
        }
    }

    #[test]
    fn a_face_that_looks_between_two_axes_is_found() {
        // The scan's shoulders look elsewhere, and the corner of its glasses, 44 degrees to its right, is farther than its nose.
        let Some((scalp, said)) = head("a_scan", SCAN, &[]) else { return };
        assert!(said.iter().any(|s| s.starts_with("forward: -14.")), "{said:?}");
        let forward = scalp.frame().forward;
        assert!((forward.x + 0.246).abs() < 0.005 && forward.y == 0.0, "{forward}");
        let back = [("turn", Value::Float(14.0))];
        let Some((turned, _)) = head("a_scan", SCAN, &back) else { return };
        assert!(turned.frame().forward.x.abs() < 0.01);
    }

    #[test]
    fn a_head_that_is_turned_is_found_to_look_where_it_was_turned_to() {
        let bust = bust::adult();
        for degrees in [-170.0f32, -90.0, -33.0, -7.0, 0.0, 12.5, 61.0, 180.0] {
            let (sin, cos) = sin_cos(degrees.to_radians());
            let turn = |p: &Vec3| Vec3::new(p.x * cos + p.z * sin, p.y, p.z * cos - p.x * sin);
            let points: Vec<Vec3> = bust.points.iter().map(turn).collect();
            let fit = fit::cranium(&points, &bust.triangles, || Ok(())).unwrap().unwrap();
            let Some(Face::Mirrored(looks)) = fit::face(&points, &bust.triangles, &fit) else {
                panic!("{degrees}: no plane");
            };
            let off = looks.angle_between(turn(&Vec3::Z)).to_degrees();
            assert!(off < 0.5, "{degrees}: {off} degrees off");
        }
    }

    #[test]
    fn every_root_of_a_groom_made_elsewhere_binds_to_its_head() {
        let Some((scalp, _)) = head("every_root", SINTEL, &[]) else { return };
        let path = concat!(
            env!("CARGO_MANIFEST_DIR"),
            "/../../shared/data/sintel/sintel_hair_16points.tfx"
        );
        let bytes = std::fs::read(path).unwrap();
        let word = |at: usize| <[u8; 4]>::try_from(&bytes[at..at + 4]).unwrap();
        let [strands, points, start] = [4, 8, 12].map(|at| u32::from_le_bytes(word(at)) as usize);
        assert_eq!((strands, points), (11_400, 16));
        let mut off = vec![];
        let (mut inside, mut touched) = (0, 0);
        for i in 0..strands {
            let at = start + i * points * 16;
            let p = Vec3::from_array([0, 4, 8].map(|k| f32::from_le_bytes(word(at + k)))) * 100.0;
            let root = scalp.closest_root(p).unwrap();
            off.push(root.point.distance(p));
            let grows = scalp.mask_at(scalp.region(), root.triangle, root.bary);
            touched += u32::from(grows > 0.0);
            inside += u32::from(grows > 0.5);
        }
        off.sort_by(f32::total_cmp);
        let (median, most) = (off[strands / 2], off[strands - 1]);
        assert!((median - 0.037).abs() < 0.001 && most < 0.63, "{median} {most}");
        // The mask has one value a vertex, and edges here are 1.5 cm long: its edge is that coarse.
        assert!(touched as f32 > 0.97 * strands as f32, "{touched}");
        assert!(inside as f32 > 0.94 * strands as f32, "{inside}");
    }

    #[test]
    fn animals_keep_their_own_coordinates() {
        for name in
            ["spot/spot_triangulated.obj", "spot/spot_control_mesh.obj", "rat/street_rat_4k.gltf"]
        {
            let Some((scalp, said)) = head("animals", name, &[]) else { return };
            assert!(said.iter().any(|s| s.starts_with("no human cranium")), "{name}: {said:?}");
            assert_eq!(*scalp.frame(), HeadFrame::IDENTITY);
            assert!(scalp.region().iter().all(|x| *x == 1.0));
        }
    }

    #[test]
    fn eyes_and_teeth_are_no_scalp_and_materials_are() {
        let Some((scalp, _)) = head("eyes_and_teeth", ICT, &[]) else { return };
        for name in ["M_Teeth", "M_GumsTongue", "M_ScleraLeft", "M_IrisRight", "M_EyeLashes"] {
            let mask = scalp.mask(&format!("material:{name}")).unwrap();
            let both = mask.iter().zip(scalp.region()).any(|(a, b)| *a > 0.0 && *b > 0.0);
            assert!(!both, "{name}");
        }
        let set = [("region", "material".into()), ("region_name", "M_BackHead, M_Face".into())];
        let Some((scalp, _)) = head("eyes_and_teeth", ICT, &set) else { return };
        assert!(area(scalp.surface(), scalp.region()) > 1500.0);
        let teeth = scalp.mask("material:M_Teeth").unwrap();
        assert!(teeth.iter().zip(scalp.region()).all(|(a, b)| *a == 0.0 || *b == 0.0));
    }

    #[test]
    fn the_built_in_head_stands_at_the_origin() {
        let scalp = adult(&[]).0;
        let frame = scalp.frame();
        assert!(frame.origin.length() < 0.05 && (frame.radius - HEAD_RADIUS).abs() < 0.05);
        let area = area(scalp.surface(), scalp.region());
        assert!((580.0..650.0).contains(&area), "{area}");
    }

    fn adult(set: &[(&str, Value)]) -> (Arc<Scalp>, Vec<String>) {
        let (out, said) = run(&NODE, set);
        match &out[0] {
            Value::Scalp(scalp) => (scalp.clone(), said),
            other => panic!("{}", other.type_name()),
        }
    }

    /// A file made of a mesh's points and triangles, put through `place`.
    fn obj(mesh: &Mesh, place: impl Fn(Vec3) -> Vec3) -> Value {
        use std::fmt::Write;
        let mut text = String::new();
        for p in mesh.points.iter().map(|p| place(*p)) {
            let _ = writeln!(text, "v {} {} {}", p.x, p.y, p.z);
        }
        for [a, b, c] in &mesh.triangles {
            let _ = writeln!(text, "f {} {} {}", a + 1, b + 1, c + 1);
        }
        let bytes: Arc<[u8]> = text.into_bytes().into();
        let (path, extension) = ("made.obj".to_owned(), "obj".to_owned());
        Value::File(Arc::new(FileData { path, extension, bytes, sides: BTreeMap::new() }))
    }

    #[test]
    fn units_and_axes_of_a_file_are_found_or_told() {
        let bust = bust::adult();
        fn off_x(p: Vec3, degrees: f32) -> Vec3 {
            let (s, c) = sin_cos((90.0 - degrees).to_radians());
            Vec3::new(p.x * c + p.z * s, p.y, -p.x * s + p.z * c)
        }
        let place: [(&str, fn(Vec3) -> Vec3, Vec3); 8] = [
            ("in m", |p| p * 0.01, Vec3::Z),
            ("in mm", |p| p * 10.0, Vec3::Z),
            ("in inches", |p| p / 2.54, Vec3::Z),
            ("in no unit", |p| p * 0.237, Vec3::Z),
            ("facing -x", |p| Vec3::new(-p.z, p.y, p.x), Vec3::NEG_X),
            ("facing 4 degrees off x", |p| off_x(p, 4.0), Vec3::X),
            ("facing 15 degrees off x", |p| off_x(p, 15.0), Vec3::new(0.965926, 0.0, 0.258819)),
            ("moved", |p| p + Vec3::new(30.0, -100.0, 7.0), Vec3::Z),
        ];
        for (what, place, forward) in place {
            let scalp = adult(&[("mesh", obj(&bust, place))]).0;
            let frame = scalp.frame();
            assert!((frame.radius - HEAD_RADIUS).abs() < 0.02, "{what}: {}", frame.radius);
            assert!(frame.forward.distance(forward) < 1e-3, "{what}: {}", frame.forward);
            assert!((frame.right - Vec3::Y.cross(frame.forward)).length() < 1e-6, "{what}");
        }
        // The same bust in a file with Z up comes out as it went in.
        let z_up = obj(&bust, |p| Vec3::new(p.x, -p.z, p.y));
        let scalp = adult(&[("mesh", z_up.clone()), ("up", "z".into())]).0;
        assert!(scalp.surface().bounds().1.distance(adult(&[]).0.surface().bounds().1) < 1e-3);
        assert_eq!(scalp.frame().forward, Vec3::Z);
        let set = [("mesh", z_up), ("up", "z".into()), ("forward", "-z".into())];
        assert_eq!(fails(&NODE, &set), "forward: \"-z\" is the up axis of this file (z)");
    }

    #[test]
    fn what_is_set_by_hand_wins() {
        let set = [
            ("units", "custom".into()),
            ("scale", Value::Float(2.0)),
            ("forward", "+x".into()),
            ("radius", Value::Float(10.0)),
            ("centre", Value::Vec3(Vec3::new(0.0, 1.0, 2.0))),
        ];
        let (scalp, said) = adult(&set);
        let frame = scalp.frame();
        assert_eq!((frame.radius, frame.forward), (10.0, Vec3::X));
        assert!(frame.origin.distance(Vec3::new(2.0, 1.0, 0.0)) < 0.02, "{}", frame.origin);
        assert!(said.iter().any(|s| s.contains("a radius of 17.")), "{said:?}");
        let set = [("fit", "none".into())];
        assert_eq!(*adult(&set).0.frame(), HeadFrame::IDENTITY);
    }

    #[test]
    fn an_inside_out_mesh_is_turned() {
        let mut bust = bust::adult();
        bust.triangles.iter_mut().for_each(|t| t.swap(0, 1));
        let (scalp, said) = adult(&[("mesh", obj(&bust, |p| p))]);
        assert!(said.iter().any(|s| s.starts_with("the mesh is inside out")), "{said:?}");
        let top = scalp.closest_root(Vec3::Y * 20.0).unwrap();
        assert!(top.normal.y > 0.9);
    }

    #[test]
    fn hair_grows_inside_a_drawn_hairline() {
        use crate::data::strokes::{Sample, Stroke};
        use crate::maths::transcendental::sin_cos_turns;
        let ring = |from: u32, to: u32| {
            let sample = |k| {
                let (s, c) = sin_cos_turns(k as f32 / 48.0);
                let position = Vec3::new(s, 0.3, c).normalize() * 9.0;
                Sample { position, pressure: 1.0, ..Sample::default() }
            };
            Stroke::new(1, (from..to).map(sample).collect())
        };
        let set = |from, to| {
            [("region", "hairline".into()), ("hairline", Strokes(vec![ring(from, to)]).into())]
        };
        let (scalp, said) = adult(&set(0, 48));
        let at = |p: Vec3| {
            let root = scalp.closest_root(p).unwrap();
            scalp.mask_at(scalp.region(), root.triangle, root.bary)
        };
        assert_eq!((at(Vec3::Y * 9.0), at(Vec3::NEG_Z * 9.0)), (1.0, 0.0));
        assert!(at(Vec3::new(0.0, 0.55, -1.0) * 9.0) > 0.9);
        assert!(!said.iter().any(|s| s.contains("open")), "{said:?}");
        assert!(adult(&set(0, 30)).1.iter().any(|s| s.contains("is open")));
        assert_eq!(
            fails(&NODE, &[("region", "hairline".into())]),
            "no hairline is drawn: draw a closed stroke"
        );
    }

    #[test]
    fn what_is_wrong_is_named() {
        let file = |name: &str, bytes: &[u8]| {
            let (path, extension) =
                (name.to_owned(), name.rsplit('.').next().unwrap_or("").to_owned());
            Value::File(Arc::new(FileData {
                path,
                extension,
                bytes: bytes.into(),
                sides: BTreeMap::new(),
            }))
        };
        for (name, bytes, says) in [
            ("head.obj", &b"v 0 0 nan"[..], "head.obj: "),
            (
                "head.fbx",
                b"",
                "head.fbx: file: FBX is not read: export the mesh as .obj, .gltf or .glb",
            ),
            ("head.glb", b"glTF", "head.glb: "),
        ] {
            let text = fails(&NODE, &[("mesh", file(name, bytes))]);
            assert!(text.starts_with(says), "{text}");
        }
        let set = [("region", "mask".into()), ("region_name", "beard".into())];
        assert_eq!(
            fails(&NODE, &set),
            "region_name: \"beard\" is not there; the mesh has: hairline, material:eyes, material:iris, \
             material:lips, material:skin"
        );
        // Flat, tiny and thin meshes are no heads, and no trouble either.
        for text in ["v 0 0 0\nv 1 0 0\nv 0 0 1\nf 1 3 2", "v 0 0 0\nv 1 1 0\nv 0 1e-20 0\nf 1 2 3"]
        {
            let (scalp, said) = adult(&[("mesh", file("flat.obj", text.as_bytes()))]);
            assert!(said.iter().any(|s| s.starts_with("no human cranium")), "{said:?}");
            assert_eq!(*scalp.frame(), HeadFrame::IDENTITY);
        }
    }
}
