//! A stroke while it is drawn: from the pen's places on the screen to samples on the head.
//!
//! Samples are kept in the head's frame and units, as documents keep them, with the pen's pressure, tilt and time. What
//! goes into the document is made from all samples by [`GrowingStroke::stroke`] each time, so the stroke that stays when the
//! pen is lifted is the one that a replay of the same samples gives, bit by bit, and it keeps its id (hence
//! its hair) while it grows.

use super::sample::PenSample;
use crate::core::projection::Projection;
use coif_graphs::document::strokes::finish;
use coif_nodes::data::scalp::Scalp;
use coif_nodes::data::strokes::{Sample, Stroke, Strokes};
use coif_nodes::maths::closest::Hit;
use egui::Pos2;
use glam::{Vec2, Vec3};
use std::sync::Arc;

/// A stroke that stays this near to the middle of the head, in head units, is drawn on it.
const MIDLINE: f32 = 0.3;
/// A stroke begins on the head or beside it, this near to it at most, points of the screen.
const BESIDE: f32 = 40.0;
/// How far over the skin a stroke in space glides, head units.
const OVER: f32 = 0.1;
/// The skin goes on where it is no farther from the last point than this (head units), and four times as far as the pen has moved.
const STEP: f32 = 0.5;
/// The most samples of one stroke: four minutes at 1,000 a second. What comes after is not drawn.
const MOST: usize = 240_000;

/// Where the pen's places on the screen lie in the world.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Lie {
    /// On the scalp.
    Scalp,
    /// In the plane of the view through the last point, the root on the scalp; before the head it glides over the skin.
    Space,
}

/// The skin under a place of the screen.
pub(super) fn skin(scalp: &Scalp, view: &Projection, at: Pos2) -> Option<Hit> {
    let ray = view.ray(at);
    scalp.surface().ray(ray.origin, ray.direction, f32::MAX)
}

/// The point of the scalp that is seen at a place of the screen; where there is none, the one nearest to what would be
/// seen at the depth of `near`.
pub(crate) fn on_scalp(scalp: &Scalp, view: &Projection, at: Pos2, near: Vec3) -> Option<Vec3> {
    skin(scalp, view, at).map(|hit| hit.point).or_else(|| {
        let beside = view.on_plane(at, near, view.axes()[2])?;
        scalp.closest_root(beside).map(|root| root.point)
    })
}

/// A stroke that grows.
#[derive(Clone, Debug)]
pub(crate) struct GrowingStroke {
    scalp: Arc<Scalp>,
    lie: Lie,
    /// Whether strokes along the middle are put on it.
    snap: bool,
    began: f64,
    /// The last point.
    last: Vec3,
    id: u64,
    samples: Vec<Sample>,
    /// The same points in the world, for drawing.
    world: Vec<Vec3>,
}

impl GrowingStroke {
    /// A stroke that begins at a sample; none where there is no scalp under it or near it.
    pub(crate) fn begin(
        scalp: &Arc<Scalp>,
        view: &Projection,
        sample: &PenSample,
        lie: Lie,
        snap: bool,
        others: &Strokes,
    ) -> Option<Self> {
        let middle = scalp.frame().origin;
        let root = on_scalp(scalp, view, sample.pos, middle)?;
        let off = view.screen(root).map_or(f32::MAX, |at| at.distance(sample.pos));
        if off > BESIDE {
            return None;
        }
        let mut line = Self {
            scalp: scalp.clone(),
            lie,
            snap,
            began: sample.time,
            last: root,
            id: 0,
            samples: vec![],
            world: vec![],
        };
        line.push(root, sample);
        // Of the first sample alone, so that it is known now and the same in a replay.
        line.id = finish(&line.samples, others)?.id;
        Some(line)
    }

    /// The next sample.
    pub(crate) fn add(&mut self, view: &Projection, sample: &PenSample) {
        let at = match self.lie {
            Lie::Scalp => on_scalp(&self.scalp, view, sample.pos, self.last),
            Lie::Space => self.in_space(view, sample.pos),
        };
        let Some(at) = at.filter(|_| self.samples.len() < MOST) else { return };
        self.last = at;
        self.push(at, sample);
    }

    /// Over the skin for as long as that goes on under the pen, and from its outline on as deep as it was there; where a head, an ear
    /// or a shoulder is before that, over it.
    fn in_space(&self, view: &Projection, at: Pos2) -> Option<Vec3> {
        let beside = view.on_plane(at, self.last, view.axes()[2])?;
        let ray = view.ray(at);
        let unit = self.scalp.frame().unit();
        let surface = self.scalp.surface();
        let Some(hit) = skin(&self.scalp, view, at) else { return Some(beside) };
        let over = hit.point + surface.smooth_normal(hit.triangle, hit.bary) * (OVER * unit);
        let far = |p: Vec3| (p - ray.origin).dot(ray.direction);
        let under = surface.closest(self.last);
        let lies = under.is_some_and(|near| near.point.distance(self.last) < 2.0 * OVER * unit);
        let step = STEP * unit + 4.0 * beside.distance(self.last);
        let goes_on = lies && over.distance(self.last) < step;
        Some(if goes_on || far(over) < far(beside) { over } else { beside })
    }

    fn push(&mut self, at: Vec3, sample: &PenSample) {
        let position = self.scalp.given(at);
        self.world.push(at);
        self.samples.push(Sample {
            position,
            pressure: sample.pressure,
            time: (sample.time - self.began).max(0.0) as f32,
            tilt: Vec2::new(sample.tilt.x, sample.tilt.y),
        });
    }

    /// The stroke of what was drawn until now; none while it has no length.
    pub(crate) fn stroke(&self) -> Option<Stroke> {
        let mut stroke = finish(&self.samples, &Strokes::default())?;
        stroke.id = self.id;
        if self.snap {
            put_on_midline(&mut stroke.samples);
        }
        let first = stroke.samples.first()?.position;
        stroke.samples.iter().any(|s| s.position.distance(first) > 0.0).then_some(stroke)
    }

    /// All samples until now.
    pub(crate) fn samples(&self) -> &[Sample] {
        &self.samples
    }
    /// Where they are in the world, cm.
    pub(crate) fn world(&self) -> &[Vec3] {
        &self.world
    }
    /// The id that the stroke has.
    pub(crate) fn id(&self) -> u64 {
        self.id
    }
}

/// Puts a stroke that stays within [`MIDLINE`] of the middle of the head exactly there, where it is its own mirror
/// image.
fn put_on_midline(samples: &mut [Sample]) {
    if samples.iter().all(|s| s.position.x.abs() <= MIDLINE) {
        for sample in samples {
            sample.position.x = 0.0;
        }
    }
}
