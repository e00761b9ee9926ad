//! Head: the mesh that hair grows on, with its size, the direction of its face, and its scalp region.
//!
//! methods.md 0.1. The mesh stays in place: it is scaled to centimetres about its origin (and rotated to Y up if its
//! file has Z up), and the head frame locates the cranium. Hair stored in that frame fits every head. Every mesh that a
//! reader accepts gives a scalp; one without a cranium keeps its own coordinates, with a message.

use super::axes::{Forward, Up};
use super::face::{By, FACE};
use super::find::{self, FoundHead, Pieces};
use super::fit::{self, Fit};
use super::parts::{self, Parts};
use super::told::{mask_names, refused};
use super::{bust, choose, drawn, facing, hairline, hollow, landmarks};
use crate::data::landmarks::Landmarks;
use crate::data::mesh::Mesh;
use crate::data::outline::ConnectedSurface;
use crate::data::rough::{Rough, SCRAPS, WIDE};
use crate::data::scalp::{HEAD_RADIUS, HeadFrame, HeadSpace, REGION, Scalp};
use crate::data::strokes::Strokes;
use crate::define::{FileData, NodeError, choice, node, short, unless};
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
    /// A sphere fitted to the cranium and the direction of the face define the head frame: x to the head's left, y up,
    /// z forward, in head units (cm on a head of average size). Strokes and partings are stored in that frame, so a
    /// groom transfers to another head. Units, axes, size and the region where hair grows are detected; every one can
    /// be overridden.
    ///
    /// Parts that are left out grow no hair, and the cranium is not fitted to them. Landmarks fit a groom to another
    /// head: front and nape are where the hairline crosses the midline, the temples where it runs between forehead and
    /// ear, the ears the skin just above them, and crown and chin.
    "head", version 1, label "Head", words "skull bust mesh scalp model import obj gltf glb vrm avatar surface emitter character skin",
        refuses(refused), masks(mask_names);
    inputs {
        /// Built-in head, used while no mesh file is set.
        builtin: Builtin = Builtin::Adult, words("default bust");
        /// Mesh file (.obj, .gltf, .glb or .vrm) to use instead of the built-in head. UVs are kept; materials and vertex
        /// colours become masks.
        mesh: Option<Arc<FileData>>, holds(Holds::Mesh), words("file import model");
        /// Parts of the mesh to ignore, such as hair, hats and glasses: comma-separated names of meshes, nodes, groups
        /// or materials, or "piece 2" for the second largest piece of a mesh without names. `*` matches any text, as in
        /// `hair*, *glasses`; case is ignored. The messages suggest candidates. Eyes, teeth and tongue stay in pictures.
        leave_out: Arc<str> = "", words("hide ignore exclude remove hair hat helmet glasses lashes brows part material");
        /// Where hair grows.
        region: Region = Region::Default, words("scalp area growth hairline density map");
        /// Painted mask, or comma-separated materials, that define where hair grows.
        region_name: Arc<str> = "", words("vertex colour color paint material name");
        /// Edge of the region, as a closed stroke on the skin. Hair grows inside, on the smaller of its two sides. More
        /// strokes add regions; a stroke inside another cuts a hole.
        hairline: Arc<Strokes> = Strokes::default(), words("edge outline");
        /// Names for drawn regions, each with a point inside it in the head frame, such as `beard 0 -7 7; left brow 3 1
        /// 9`. Each becomes a mask. A point outside every stroke selects the outer side of the nearest one.
        names: Arc<str> = "", words("name label several regions mask side");
        /// Fade width at the edge of a default or drawn region. 0 is a sharp edge.
        edge: f32 = 0.5, hard(0.0, 10.0), soft(0.0, 2.0), unit(Length), words("soft fade falloff");
        /// Landmarks of this head that replace the detected ones: name and position in the head frame, such as `crown 0
        /// 8.3 -3.9; chin 0 -10 7.3`. Names: front, nape, left temple, right temple, left ear, right ear, crown, chin, bridge,
        /// nose, mouth. The messages list all positions.
        landmarks: Arc<str> = "", words("points fit markers correspondence hairline nape temple ear crown chin nose mouth");
        /// Landmarks of the head that the groom was made on, as its messages list them. Strokes, names, hairline, masks
        /// and positions are warped so that they meet the landmarks of this head. Leave empty on the original head.
        /// `coif fit` sets it.
        home: Arc<str> = "", words("fit transfer carry map other head source original landmarks warp retarget");

        [Placement]
        /// Length of one unit of the file. Auto reads it from the file, or picks the unit that gives the cranium a
        /// human size.
        units: Units = Units::Auto, words("scale metres centimetres inches");
        /// Centimetres per unit of the file, when units are custom.
        scale: f32 = 1.0, hard(0.000001, 1000000.0), soft(0.1, 100.0), words("size"),
            idle(|of| unless(of, "units", "custom", "the units of the file are known"));
        /// Axis of the file that points up; the mesh is rotated to Y up. If no head is found that way, the other axes
        /// are tried.
        up: Up = Up::Y, words("axis orientation z-up");
        /// Axis of the file that the face points along. Auto finds the mirror plane of the head and the end that looks
        /// like a face, and snaps to an axis within 5 degrees.
        forward: Forward = Forward::Auto, words("axis orientation face direction");
        /// Rotates forward about the up axis, for a head that faces between two axes. Positive turns to the head's own
        /// left.
        turn: f32 = 0.0, hard(-180.0, 180.0), unit(Angle), handle(Handle::Angle), words("yaw rotate");
        /// How the head frame is found.
        fit: FitBy = FitBy::Cranium, words("sphere cranium animal creature");
        /// Radius of the cranium, instead of the fitted one; 0 keeps the fit.
        radius: f32 = 0.0, hard(0.0, 1000.0), soft(0.0, 12.0), unit(Length), handle(Handle::Radius), words("size");
        /// Offset of the cranium's centre, in cm along the head's right, up and forward.
        centre: Vec3 = Vec3::ZERO, handle(Handle::Point), words("center offset origin");
    }
    outputs {
        /// The head with its frame, masks and the region where hair grows.
        scalp: Arc<Scalp>;
    }
}

choice! {
    /// Built-in heads.
    Builtin {
        /// An adult bust with ears and neck, bald.
        Adult = "adult",
    }
}

choice! {
    /// Length of one unit of the file.
    Units {
        /// As the file states, or else derived from the size of the cranium.
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
    /// How the head frame is found.
    FitBy {
        /// By the best-fitting sphere of the cranium.
        Cranium = "cranium",
        /// No fit: the file's own origin and axes, for animals and props.
        None = "none",
    }
}

choice! {
    /// Where hair grows.
    Region {
        /// The mask "scalp" or "hairline" if the mesh has one, else a standard hairline; everywhere on a mesh without a
        /// cranium.
        Default = "default",
        /// Where the painted mask of the given name is.
        Mask = "mask",
        /// On the given materials.
        Material = "material",
        /// Inside the drawn hairline.
        Hairline = "hairline",
    }
}

fn eval(cx: &EvalCx, inputs: Inputs) -> Result<Outputs, NodeError> {
    let mut mesh = match &inputs.mesh {
        Some(file) => read(file)?,
        None => match inputs.builtin {
            Builtin::Adult => bust::adult(),
        },
    };
    mesh.notes.iter().for_each(|note| cx.remark(note.clone()));
    cx.check()?;
    let mut parts = Parts::of(&mesh, &Pieces::of(&mesh.points, &mesh.triangles));
    let (kept, mut aside) = leave_out(cx, &inputs, &mut mesh, &mut parts)?;
    let pieces = Pieces::of(&mesh.points, &mesh.triangles);
    let (mut points, mut triangles, mut uvs) = (mesh.points, mesh.triangles, mesh.uvs);
    cx.check()?;
    let (up, found) = match inputs.fit {
        FitBy::Cranium => {
            let mesh = choose::Choice { points: &points, triangles: &triangles, pieces: &pieces };
            mesh.head(cx, &parts, inputs.up, inputs.forward)?
        }
        FitBy::None => (inputs.up, FoundHead::default()),
    };
    points.iter_mut().for_each(|p| *p = up.turned(*p));
    let fit = found.fit;
    choose::doubt_crown(cx, fit.as_ref(), &parts);
    let is_skin: Vec<bool> = match found.piece {
        Some(piece) => pieces.of.iter().map(|of| *of == piece).collect(),
        None => vec![],
    };
    let over = match (&fit, is_skin.is_empty()) {
        (Some(fit), false) => find::over_the_crown(&points, &triangles, fit, |t| is_skin[t]),
        _ => vec![],
    };
    if let Some(proposal) = parts.propose(&points, &triangles, &is_skin, &over) {
        let (said, is_in_the_way) = proposal.said();
        if is_in_the_way { cx.warn(said) } else { cx.remark(said) }
    }
    cx.check()?;
    let inside_out = fit.map_or_else(|| volume(&points, &triangles) < 0.0, |fit| fit.inside_out);
    if inside_out {
        triangles.iter_mut().for_each(|t| t.swap(1, 2));
        uvs.iter_mut().flatten().for_each(|uv| uv.swap(1, 2));
        if let Some((aside, _)) = &mut aside {
            aside.triangles.iter_mut().for_each(|t| t.swap(1, 2));
            aside.uvs.iter_mut().flatten().for_each(|uv| uv.swap(1, 2));
        }
    }
    let scale = scale(cx, &inputs, mesh.cm_per_unit, &points, fit.as_ref());
    let looks = forward(cx, &inputs, up, &found)?;
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
    let turned = match fit {
        Some(fit) => {
            let (middle, radius) = (fit.centre * scale, fit.radius * scale);
            facing::turned(&surface, middle, radius, || cx.check())?
        }
        None => None,
    };
    if let Some(turned) = &turned {
        let Surface { points, mut triangles, .. } = surface;
        let is_turned = |(_, turned): &(_, &bool)| **turned;
        triangles.iter_mut().zip(turned).filter(is_turned).for_each(|(t, _)| t.swap(1, 2));
        let uvs = uvs.iter_mut().flatten().zip(turned);
        uvs.filter(|(_, turned)| **turned).for_each(|(uv, _)| uv.swap(1, 2));
        surface = Surface::new(points, triangles);
        cx.check()?;
    }
    tell_turned(cx, inside_out, turned, &parts);
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
    let (mut ears, mut guessed) = (vec![], Landmarks::default());
    if fit.is_some() {
        ears = hairline::ears(&surface, &frame, &|| cx.check())?;
        let own = own_region(&masks).map(Vec::as_slice);
        guessed = landmarks::guessed(&surface, &frame, own, &ears);
    }
    let landmarks = landmarks::resolve(cx, &surface, &frame, guessed, &inputs.landmarks);
    let space = HeadSpace::new(frame, landmarks::carry(cx, &inputs.home, &landmarks));
    let mut grows = grows(cx, &inputs, (&surface, &frame), fit.is_some().then_some(&ears), &masks)?;
    if let Some(wall) = masks.get(INNER_WALL) {
        grows.iter_mut().zip(wall).for_each(|(grows, wall)| *grows *= 1.0 - wall);
    }
    let (mut drawn, mut links) = (vec![], None);
    if inputs.region == Region::Hairline {
        let wish = drawn::DrawnRegionParams {
            strokes: &inputs.hairline,
            names: &inputs.names,
            outside: false,
            softness: inputs.edge * frame.unit(),
            may: grows,
        };
        let net = ConnectedSurface::new(&surface);
        drawn = drawn::regions(cx, &net, &space, wish)?;
        links = Some(net.links());
        grows = drawn[0].1.values().to_vec();
        for (name, region) in &drawn[1..] {
            masks.insert(name.clone(), region.values().to_vec());
        }
    } else if !inputs.names.trim().is_empty() {
        cx.warn("names are for drawn regions: set region to hairline and draw them");
    }
    let everywhere =
        fit.is_none() && inputs.region == Region::Default && own_region(&masks).is_none();
    let area = drawn.first().map_or_else(|| area(&surface, &grows), |(_, region)| region.area());
    tell_region(cx, &inputs, &surface, &frame, everywhere, area);
    masks.insert(REGION.to_owned(), grows);
    let scalp = Scalp::new(surface, uvs, frame, masks).with_drawn(drawn, links);
    let scalp = scalp.carried(space).with_landmarks(landmarks);
    if let Some(rough) = scalp.rough() {
        tell_rough(cx, rough, &frame);
    }
    let aside = aside.map(|(mesh, kept)| still_seen(mesh, kept, (up, scale), frame));
    let scalp = scalp.with_cm_per_unit(scale).with_parts(parts.list()).with_kept(kept);
    let scalp = scalp.with_aside(aside);
    Ok(Outputs { scalp: Arc::new(scalp) })
}

/// Reports what hair on a rough mesh is kept out of.
fn tell_rough(cx: &EvalCx, rough: Rough, frame: &HeadFrame) {
    let why = match rough {
        Rough::Folded => {
            let reach = frame.radius;
            format!("more than a quarter of the region faces other skin within {reach:.0} cm")
        }
        Rough::Wide => {
            format!("the region is larger than {:.0} cm2", WIDE * frame.unit() * frame.unit())
        }
        Rough::Strewn => format!("the region is in more than {SCRAPS} parts"),
        Rough::Tangled => {
            "so many triangles cross each other that the mesh has no inside".to_owned()
        }
    };
    const REMEDY: &str = "leave the other parts out (leave_out) or choose a smaller region";
    match rough {
        Rough::Wide => {
            cx.remark(format!("{why}: hair is pushed out of the skin but not led around it"))
        }
        Rough::Folded => cx.warn(format!(
            "{why}: guides are kept out of the skin, hair between them is not; {REMEDY}"
        )),
        Rough::Strewn | Rough::Tangled => {
            cx.warn(format!("{why}: neither guides nor hair are kept out of it; {REMEDY}"))
        }
    }
}

/// Reports what was flipped: all of an `inside_out` mesh, except for what was then flipped back.
fn tell_turned(cx: &EvalCx, inside_out: bool, turned: Option<Vec<bool>>, parts: &Parts) {
    let Some(mut turned) = turned else {
        if inside_out {
            cx.warn("the mesh is inside out, so its faces were turned round");
        }
        return;
    };
    turned.iter_mut().for_each(|turned| *turned ^= inside_out);
    let (count, all) = (turned.iter().filter(|turned| **turned).count(), turned.len());
    let of = match parts.listed_mostly_in(&turned) {
        names if names.is_empty() => String::new(),
        names => format!(", those of {names}"),
    };
    cx.warn(format!(
        "{count} of {all} triangles are inside out{of}, so their faces were turned round"
    ));
}

/// What is left out and still seen, as a head of its own on which no hair grows.
fn still_seen(mut mesh: Mesh, kept: Vec<u32>, (up, scale): (Up, f32), frame: HeadFrame) -> Scalp {
    mesh.points.iter_mut().for_each(|p| *p = up.turned(*p) * scale);
    let surface = Surface::new(mesh.points, mesh.triangles);
    let of_materials = incident(&surface, &mesh.material_of, &mesh.materials);
    let named = of_materials.into_iter().map(|(name, mask)| (format!("material:{name}"), mask));
    let mut masks: BTreeMap<String, Vec<f32>> = named.collect();
    masks.insert(REGION.to_owned(), vec![0.0; surface.points.len()]);
    Scalp::new(surface, mesh.uvs, frame, masks).with_kept(Some(kept))
}

/// Removes the parts named by `leave_out` from the mesh; returns the indices of the remaining triangles if any were
/// removed, and what of them is still seen, with its indices.
fn leave_out(
    cx: &EvalCx,
    inputs: &Inputs,
    mesh: &mut Mesh,
    parts: &mut Parts,
) -> Result<(Option<Vec<u32>>, Option<(Mesh, Vec<u32>)>), NodeError> {
    let left_out = parts.leave_out(&inputs.leave_out);
    if !left_out.unknown.is_empty() {
        let (unknown, told) = (parts::listed(&left_out.unknown), parts.listed());
        cx.warn(match told.is_empty() {
            true => format!("leave_out: {unknown} matches nothing: the mesh has no parts"),
            false => format!("leave_out: {unknown} matches nothing; the mesh has the parts {told}"),
        });
    }
    let count = left_out.gone.iter().filter(|gone| **gone).count();
    if count == 0 {
        return Ok((None, None));
    }
    if count == mesh.triangles.len() {
        return Err(NodeError::BadValue {
            input: "leave_out",
            value: format!("{:?}", short(&inputs.leave_out)),
            reason: format!("leaves nothing of the mesh; its parts are {}", parts.listed()),
        });
    }
    cx.remark(format!("left out: {count} of {} triangles", mesh.triangles.len()));
    let numbers = |of: &[bool], wanted: bool| -> Vec<u32> {
        (0u32..).zip(of).filter(|(_, of)| **of == wanted).map(|(t, _)| t).collect()
    };
    let aside = left_out.seen.contains(&true).then(|| {
        let mut aside = mesh.clone();
        aside.leave_out(&left_out.seen.iter().map(|seen| !seen).collect::<Vec<_>>());
        (aside, numbers(&left_out.seen, true))
    });
    mesh.leave_out(&left_out.gone);
    Ok((Some(numbers(&left_out.gone, false)), aside))
}

/// Scalp area of a person, cm2, and an upper limit for any on a head of average size.
const USUAL_SCALP: &str = "600 to 900 cm2";
const MOST_SCALP: f32 = 1500.0;

/// Reports the size of the region, and what to do if it is not a scalp.
fn tell_region(
    cx: &EvalCx,
    inputs: &Inputs,
    surface: &Surface,
    frame: &HeadFrame,
    everywhere: bool,
    area: f32,
) {
    if area <= 0.0 {
        return cx.warn("hair grows nowhere: the region is empty");
    }
    cx.remark(format!("scalp: {}", drawn::area(area)));
    let whole: f32 =
        (0..surface.triangles.len()).map(|t| 0.5 * surface.area_vector(t as u32).length()).sum();
    let share = 100.0 * area / whole.max(f32::MIN_POSITIVE);
    if inputs.fit == FitBy::Cranium && everywhere {
        return cx.warn(format!(
            "without a cranium no hairline is known: hair grows on {share:.0} % of the mesh, {area:.0} cm2, where a person's scalp \
             has {USUAL_SCALP}; to choose where, set region to hairline, mask or material"
        ));
    }
    if inputs.fit == FitBy::Cranium && area > MOST_SCALP * frame.unit() * frame.unit() {
        let remedy = match inputs.region {
            Region::Default => {
                "leave out what is no skin (leave_out), or draw a hairline (region: hairline)"
            }
            Region::Mask | Region::Material => "choose less with region_name",
            Region::Hairline => "draw the hairline closer about the crown",
        };
        cx.warn(format!(
            "hair grows on {area:.0} cm2, {share:.0} % of the mesh; a person's scalp has {USUAL_SCALP}: {remedy}"
        ));
    }
}

/// A mesh whose height is below this fraction of its width is flat.
const FLAT: f32 = 1e-3;

pub(super) fn read(file: &FileData) -> Result<Mesh, NodeError> {
    let side = |name: &str| file.sides.get(name).cloned();
    read_mesh(&file.extension, &file.bytes, &side)
        .map_err(|err| NodeError::Refused { file: file.path.clone(), reason: err.to_string() })
}

/// A number with the sign of the volume enclosed by the triangles, seen from the centre of the bounding box.
fn volume(points: &[Vec3], triangles: &[[u32; 3]]) -> f64 {
    let first = points.first().copied().unwrap_or_default();
    let (lo, hi) = points.iter().fold((first, first), |(lo, hi), p| (lo.min(*p), hi.max(*p)));
    let (middle, size) = ((lo + hi) * 0.5, (hi - lo).max_element().max(f32::MIN_POSITIVE));
    let corner = |v: u32| (points[v as usize] - middle) / size;
    triangles.iter().map(|t| f64::from(corner(t[0]).dot(corner(t[1]).cross(corner(t[2]))))).sum()
}

/// Centimetres per unit of the file.
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
        (stated, Some(fit)) => {
            let wrong = stated.map(|cm| {
                let radius = fit.radius * cm;
                format!("the file's units give the cranium a radius of {radius:.3} cm, a person's has 6 to 12 cm: ")
            });
            let known = fit::unit_of_radius(fit.radius);
            match (wrong, known) {
                (None, Some((_, name))) => cx.remark(format!(
                    "the file states no units; by the size of the cranium they are {name}"
                )),
                (Some(wrong), Some((_, name))) => {
                    cx.warn(format!(
                        "{wrong}by its size the units are {name}, and so they were read"
                    ));
                }
                (wrong, None) => {
                    let factor = HEAD_RADIUS / fit.radius;
                    let why = wrong.unwrap_or_else(|| {
                        "the file states no units and none makes the cranium a person's: "
                            .to_owned()
                    });
                    cx.warn(format!(
                        "{why}it was scaled to {HEAD_RADIUS} cm (custom scale {factor})"
                    ));
                }
            }
            known.map_or(HEAD_RADIUS / fit.radius, |(cm, _)| cm)
        }
        (None, None) => {
            let first = points.first().copied().unwrap_or_default();
            let ends = points.iter().fold((first, first), |(lo, hi), p| (lo.min(*p), hi.max(*p)));
            let size = ends.1 - ends.0;
            // A flat mesh has no meaningful height.
            let (what, size) = match size.y < FLAT * size.max_element() {
                true => ("width (it is flat)", size.max_element()),
                false => ("height", size.y),
            };
            let (cm, name) = fit::unit_of_height(size);
            cx.remark(format!("the file states no units; by its {what} of {size} they are {name}"));
            cm
        }
    }
}

/// A face within this many degrees of a file axis snaps to it: heads are modeled to 2 degrees.
const SNAP_DEGREES: f32 = 5.0;
/// The same for the farthest point, a weak indication of where a face looks.
const SNAP_FARTHEST_DEGREES: f32 = 20.0;

/// Name of the mask of a hollow head's inner wall.
pub(super) const INNER_WALL: &str = "inner_wall";

/// Direction of the face: level and unit, Y up.
fn forward(cx: &EvalCx, inputs: &Inputs, up: Up, found: &FoundHead) -> Result<Vec3, NodeError> {
    let Some(axis) = inputs.forward.axis() else { return Ok(looks(cx, up, found)) };
    let axis = up.turned(axis);
    if axis.y != 0.0 {
        return Err(NodeError::BadValue {
            input: "forward",
            value: format!("{:?}", Forward::name_of(axis, up)),
            reason: format!("is the up axis of this file ({})", up.name()),
        });
    }
    Ok(axis)
}

/// Direction of the detected face.
fn looks(cx: &EvalCx, up: Up, found: &FoundHead) -> Vec3 {
    let axes = [Vec3::Z, Vec3::X, Vec3::NEG_Z, Vec3::NEG_X];
    let first = Forward::name_of(Vec3::Z, up);
    let Some(face) = found.face else {
        if found.fit.is_some() {
            cx.warn(format!(
                "no face was found: forward is {first}; if the face looks elsewhere, set forward"
            ));
        }
        return Vec3::Z;
    };
    let snap = if face.by == By::Farthest { SNAP_FARTHEST_DEGREES } else { SNAP_DEGREES };
    let degrees = |axis: Vec3| acos(face.looks.dot(axis)).to_degrees();
    let angle = if face.looks.x < 0.0 { -1.0 } else { 1.0 } * degrees(Vec3::Z);
    let axis = axes.into_iter().find(|axis| degrees(*axis) <= snap);
    if face.by == By::Farthest && axis.is_none() {
        cx.warn(format!(
            "the head mirrors in no plane, and its farthest point is {angle:.0} degrees from {first}: forward is \
             {first}; if the face looks elsewhere, set turn"
        ));
        return Vec3::Z;
    }
    let told = match axis {
        Some(axis) => format!("forward: {}", Forward::name_of(axis, up)),
        None => format!("forward: {angle:.1} degrees from {first}, where the face looks"),
    };
    match face.likeness >= FACE {
        true => cx.remark(told),
        false => cx.warn(format!(
            "{told}: the head reaches farthest there, but nothing there looks like a face; if it looks elsewhere, set forward"
        )),
    }
    axis.unwrap_or(face.looks)
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

/// For each name, the fraction of the surface around each vertex that belongs to it.
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

/// The mesh's own mask for where hair grows.
fn own_region(masks: &BTreeMap<String, Vec<f32>>) -> Option<&Vec<f32>> {
    masks.get(REGION).or_else(|| masks.get("hairline"))
}

/// A region by a name that is none of the `known` ones with the prefix.
pub(super) fn unknown_region<'a>(
    value: &str,
    prefix: &str,
    known: impl Iterator<Item = &'a str>,
) -> NodeError {
    let mut known: Vec<&str> = known.filter_map(|name| name.strip_prefix(prefix)).collect();
    known.sort_unstable();
    NodeError::BadValue {
        input: "region_name",
        value: format!("{value:?}"),
        reason: match known.is_empty() {
            true => "is not there: the mesh has none".to_owned(),
            false => format!("is not there; the mesh has: {}", known.join(", ")),
        },
    }
}

/// `ears` are the vertices of both ears; `None` if the mesh is not a head.
fn grows(
    cx: &EvalCx,
    inputs: &Inputs,
    (surface, frame): (&Surface, &HeadFrame),
    ears: Option<&Vec<Vec3>>,
    masks: &BTreeMap<String, Vec<f32>>,
) -> Result<Vec<f32>, NodeError> {
    let unknown =
        |value: &str, prefix: &str| unknown_region(value, prefix, masks.keys().map(String::as_str));
    let check = || cx.check();
    let softness = inputs.edge * frame.unit();
    match inputs.region {
        Region::Default => match (own_region(masks), ears) {
            (Some(mask), _) => Ok(mask.clone()),
            (None, Some(ears)) => hairline::default_region(surface, frame, softness, ears, &check),
            (None, None) => Ok(vec![1.0; surface.points.len()]),
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
        Region::Hairline => match ears.is_some() {
            true => hairline::outer_skin(surface, frame, &check),
            false => Ok(vec![1.0; surface.points.len()]),
        },
    }
}

/// Area of a mask, cm2.
fn area(surface: &Surface, mask: &[f32]) -> f32 {
    let share = |t: &[u32; 3]| t.iter().map(|v| mask[*v as usize]).sum::<f32>() / 3.0;
    let triangles = surface.triangles.iter().enumerate();
    triangles.map(|(i, t)| share(t) * 0.5 * surface.area_vector(i as u32).length()).sum()
}

#[cfg(test)]
mod doubtful;
#[cfg(test)]
mod laws;
#[cfg(test)]
mod worn;
