//! What a picture shows at a place: the skin there, its region and sections, and the hair above it.
//!
//! Guarantees: the place is that of the picture that `coif render` draws with the same camera and size, and of the drawn curve, not of its
//! CVs. The skin is that of the nearest head; the hair is the nearest to the eye whose drawn width, or [`REACH`] pixels around it, covers the
//! place. Nothing behind the skin is seen. No graphics device is used.

use super::RenderRequest;
use super::place::ShotView;
use crate::jobs::evaluate::{Evaluated, Opened, evaluator};
use crate::jobs::progress::Tell;
use crate::jobs::report::Report;
use crate::jobs::stop::Stop;
use coif_graphs::document::Socket;
use coif_graphs::schedule::run::CancelToken;
use coif_nodes::data::attributes::WIDTH;
use coif_nodes::data::curves::{Curves, Tuft};
use coif_nodes::data::scalp::{HeadFrame, Scalp};
use coif_nodes::formats::export::HairGroup;
use coif_nodes::maths::drawn_span::DrawnSpan;
use coif_shaders::camera::{Camera, Subject};
use glam::Vec3;
use serde::Serialize;
use std::sync::Arc;

/// Hair drawn within this distance of a place is hit, pixels: a strand is thinner than a pixel.
const REACH: f32 = 1.5;
/// Hair up to this far (cm) behind the skin still counts as seen: roots, and hair that is allowed to lie in the skin.
const BEHIND: f32 = 0.05;
/// No part of a groom lies farther from the eye than this, cm.
const FARTHEST: f32 = 1e5;
/// Number of straight pieces that stand for a span.
const PIECES: usize = 8;

/// What is seen at a place of the picture.
#[derive(Debug, Serialize)]
pub(crate) struct Probed {
    /// Share of the picture's width and height, from its upper left corner.
    pub(crate) at: [f32; 2],
    pub(crate) skin: Option<SeenSkin>,
    pub(crate) hair: Option<SeenHair>,
}

/// The skin at a place.
#[derive(Debug, Serialize)]
pub(crate) struct SeenSkin {
    /// The place, cm.
    pub(crate) cm: [f32; 3],
    /// The same in head units, as strokes and points are written.
    pub(crate) head: [f32; 3],
    /// Smooth normal. Unit.
    pub(crate) normal: [f32; 3],
    /// Triangle, with the weights of its second and third corner.
    pub(crate) triangle: u32,
    pub(crate) bary: [f32; 2],
    /// Of the head's first texture, where it has any.
    pub(crate) uv: Option<[f32; 2]>,
    /// Share of the hair that the region grows there, 0 to 1.
    pub(crate) region: f32,
    /// Of each parting on the way to the outputs, the section there.
    pub(crate) sections: Vec<String>,
    /// From the eye, cm.
    pub(crate) distance: f32,
}

/// The hair at a place.
#[derive(Debug, Serialize)]
pub(crate) struct SeenHair {
    /// 16 hexadecimal digits, as `coif trace` takes them.
    pub(crate) id: String,
    /// The group of the output that it belongs to.
    pub(crate) group: String,
    /// How far along it from its root, 0 to 1 of its CVs.
    pub(crate) along: f32,
    /// The place, cm.
    pub(crate) cm: [f32; 3],
    /// Above the skin, cm, where there is a head.
    pub(crate) above: Option<f32>,
    /// From the eye, cm.
    pub(crate) distance: f32,
}

/// Evaluates a graph, and says what the first camera of a picture sees at these places.
pub(crate) fn probe(
    asked: &RenderRequest,
    places: &[[f32; 2]],
    opened: &Opened,
    cancel: &CancelToken,
    tell: &dyn Tell,
    report: &mut Report,
) -> Result<Vec<Probed>, Stop> {
    let view = ShotView::of(asked.cameras.first().map_or("", String::as_str), opened)?;
    let more: Vec<Socket> = view.socket().cloned().into_iter().collect();
    opened.refuse_problems(&more, &mut report.warnings)?;
    let evaluator = evaluator(asked.threads, 0, &mut report.warnings)?;
    let evaluated = opened.evaluate_on(&evaluator, asked.quality, &more, cancel, tell, report)?;
    let scalp = evaluated.scalps.first().map(|scalp| &**scalp);
    let hair = shown(&evaluated).flat_map(|group| group.curves.tufts().to_vec());
    let hair = Curves::new(hair.collect());
    let subject = Subject {
        frame: scalp.map_or(HeadFrame::IDENTITY, |scalp| *scalp.frame()),
        surface: scalp.map(Scalp::surface),
        hair: &hair,
    };
    let camera = view.camera(asked, &subject, evaluated.more.first())?;
    let [width, height] = asked.size.map(|side| side as f32);
    let eye = Eye { camera, aspect: width / height, pixel: 1.0 / height };
    Ok(places.iter().map(|at| eye.sees(*at, &evaluated)).collect())
}

/// What pictures show: hair, or guides where there is nothing else.
fn shown(evaluated: &Evaluated) -> impl Iterator<Item = &HairGroup> {
    let only_guides = evaluated.groups.iter().all(|group| group.guides);
    evaluated.groups.iter().filter(move |group| only_guides || !group.guides)
}

/// What looks at the groom.
struct Eye {
    camera: Camera,
    aspect: f32,
    /// Share of the picture's height that a pixel takes.
    pixel: f32,
}

impl Eye {
    fn sees(&self, at: [f32; 2], evaluated: &Evaluated) -> Probed {
        let ray = self.camera.ray(at, self.aspect);
        let skins = evaluated.scalps.iter().filter_map(|scalp| skin(ray, scalp, evaluated));
        let skin = skins.min_by(|a, b| a.distance.total_cmp(&b.distance));
        let end = skin.as_ref().map_or(FARTHEST, |skin| skin.distance + BEHIND);
        let mut nearest: Option<(f32, SeenHair)> = None;
        for group in shown(evaluated) {
            for (tuft, i) in group.curves.each() {
                let end = nearest.as_ref().map_or(end, |(distance, _)| *distance);
                let Some((distance, place, along)) = self.on_hair(ray, tuft, i, end) else {
                    continue;
                };
                let seen = SeenHair {
                    id: format!("{:016x}", tuft.id(i)),
                    group: group.name.clone(),
                    along,
                    cm: place.to_array(),
                    above: above(place, evaluated),
                    distance,
                };
                nearest = Some((distance, seen));
            }
        }
        Probed { at, skin, hair: nearest.map(|(_, hair)| hair) }
    }

    /// Where a hair is seen nearer than `end` (cm): how far off, the place, and how far along it.
    fn on_hair(
        &self,
        (origin, direction): (Vec3, Vec3),
        tuft: &Tuft,
        i: usize,
        end: f32,
    ) -> Option<(f32, Vec3, f32)> {
        let (points, width) = (tuft.curve(i), tuft.view(WIDTH));
        let first = tuft.range(i).start;
        let mut nearest: Option<(f32, Vec3, f32)> = None;
        // From the ray, and along it.
        let off = |p: Vec3| {
            let from = p - origin;
            let along = from.dot(direction);
            (from - direction * along, along)
        };
        for k in 0..points.len().saturating_sub(1) {
            let wide = width.at(i, first + k).max(width.at(i, first + k + 1));
            let ends = [points[k], points[k + 1]].map(off);
            let far = ends[0].1.max(ends[1].1);
            let reach = 0.5 * wide + self.camera.covers(REACH * self.pixel, far.max(0.0));
            let span = DrawnSpan::of(points, k);
            if beside(ends[0].0, ends[1].0).1 > reach + span.leaves_chord(1.0) {
                continue;
            }
            let at = |n: usize| span.at(n as f32 / PIECES as f32);
            for n in 0..PIECES {
                let (a, b) = (off(at(n)), off(at(n + 1)));
                let (t, aside) = beside(a.0, b.0);
                let distance = a.1 + (b.1 - a.1) * t;
                let nearer = nearest.map_or(end, |(distance, ..)| distance);
                if aside <= reach && distance > 0.0 && distance < nearer {
                    let along =
                        (k as f32 + (n as f32 + t) / PIECES as f32) / (points.len() - 1) as f32;
                    nearest = Some((distance, at(n).lerp(at(n + 1), t), along));
                }
            }
        }
        nearest
    }
}

/// The skin of a head where a ray meets it.
fn skin(
    (origin, direction): (Vec3, Vec3),
    scalp: &Scalp,
    evaluated: &Evaluated,
) -> Option<SeenSkin> {
    let hit = scalp.surface().ray(origin, direction, FARTHEST)?;
    let root = scalp.root(hit.triangle, hit.bary);
    let name = |parted: &Arc<Scalp>| {
        let id = parted.sections()?.id_of(&root)?;
        evaluated.sections.get(&id).cloned()
    };
    let of_head = evaluated.parted.iter().filter(|parted| parted.whole() == scalp.whole());
    Some(SeenSkin {
        cm: hit.point.to_array(),
        head: scalp.given(hit.point).to_array(),
        normal: root.normal.to_array(),
        triangle: hit.triangle,
        bary: hit.bary.to_array(),
        uv: scalp.uvs().map(|_| root.uv.to_array()),
        region: scalp.grows(hit.triangle, hit.bary),
        sections: of_head.filter_map(name).collect(),
        distance: hit.distance,
    })
}

/// How far a place is above the nearest skin of any head, cm; negative inside.
fn above(place: Vec3, evaluated: &Evaluated) -> Option<f32> {
    let height = |scalp: &Arc<Scalp>| {
        let hit = scalp.surface().closest(place)?;
        Some(scalp.skin().height_over(place, &hit))
    };
    evaluated.scalps.iter().filter_map(height).min_by(f32::total_cmp)
}

/// Where the way from `a` to `b` is nearest to the origin, 0 to 1, and how near.
fn beside(a: Vec3, b: Vec3) -> (f32, f32) {
    let way = b - a;
    let t = (-a.dot(way) / way.length_squared().max(f32::MIN_POSITIVE)).clamp(0.0, 1.0);
    (t, (a + way * t).length())
}
