//! A gesture at work: what it was drawn over, and which curves it selects.
//!
//! Guarantees: a gesture that names curves acts on those and on no others; missing curves are reported by id. A gesture
//! without names selects what lies under the pen, by its layer, at each replay.

use super::lock::Lock;
use super::relax::CLEARANCE;
use super::seen::Seen;
use crate::data::gestures::{Gesture, Layer, Replayed};
use crate::data::scalp::{Scalp, Skin};
use crate::maths::closest::Hit;
use glam::{Vec2, Vec3};
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

/// The node's settings, in cm of this head.
#[derive(Clone, Copy)]
pub(super) struct Settings {
    pub radius: f32,
    pub segment: f32,
    /// Search radius for neighbours, cm.
    pub tau: f32,
    /// Reach of a comb, pixels.
    pub rho: f32,
    /// Cosine of the largest angle to neighbours that count.
    pub alike: f32,
    pub density: f32,
    /// How much a comb turns with the neighbours, 0 to 1.
    pub follow: f32,
    /// Centimetres per head unit.
    pub unit: f32,
    pub seed: u64,
}

/// A gesture, the head and the view it was drawn in.
pub(super) struct GestureContext<'a> {
    pub gesture: &'a Gesture,
    pub seen: Seen,
    pub scalp: &'a Scalp,
    pub skin: Skin<'a>,
    pub set: Settings,
}

/// Curves as gestures leave them, with messages.
#[derive(Clone, Default)]
pub(super) struct SketchState {
    pub locks: Vec<Arc<Lock>>,
    /// Results of all gestures so far, in order.
    pub replayed: Vec<Arc<Replayed>>,
    /// Result of the current gesture.
    pub now: Replayed,
    /// Bytes that the previous state does not hold.
    pub bytes: usize,
}

impl SketchState {
    /// Before any gesture.
    pub(super) fn of(locks: Vec<Arc<Lock>>) -> Self {
        let bytes = locks.iter().map(|lock| lock.bytes() + 8).sum::<usize>() + size_of::<Self>();
        Self { locks, bytes, ..Self::default() }
    }

    /// Records what the current gesture could not do.
    pub(super) fn say(&mut self, text: impl Into<String>) {
        self.now.said.push(text.into());
    }

    /// Ends the current gesture: reports what it left undone and adds its result to the others.
    pub(super) fn ended(mut self, before: &Self) -> Self {
        let known: BTreeSet<*const Lock> = before.locks.iter().map(Arc::as_ptr).collect();
        let is_new = |lock: &&Arc<Lock>| !known.contains(&Arc::as_ptr(lock));
        let (new, bytes) = self
            .locks
            .iter()
            .filter(is_new)
            .fold((0, 0), |(new, bytes), lock| (new + 1, bytes + lock.bytes()));
        // Of the existing ones.
        self.now.changed += before.locks.len() + new - self.locks.len();
        let (picked, changed) = (self.now.picked, self.now.changed);
        match () {
            () if changed >= picked || !self.now.said.is_empty() && changed == 0 => {}
            () if changed == 0 && picked == 1 => self.say("it leaves its curve as it is"),
            () if changed == 0 => self.say(format!("it changes none of its {picked} curves")),
            () if self.now.named > 0 => {
                self.say(format!(
                    "it leaves {} of its {picked} curves as they are",
                    picked - changed
                ));
            }
            () => {}
        }
        let now = std::mem::take(&mut self.now);
        let lists = (self.locks.len() + self.replayed.len() + 1) * 8;
        self.bytes = bytes + lists + now.bytes() + size_of::<Self>();
        self.replayed.push(Arc::new(now));
        self
    }
}

/// Distance from the pen, in pixels, within which a thin curve counts as under it.
const TOUCH: f32 = 6.0;
/// Nothing is drawn closer to the eye than this, cm.
const NEAREST: f32 = 0.2;
/// Steps towards the eye; the first is this long (cm) at least, and each may be longer than the one before, so that a line of
/// sight along the skin leads out of it too.
const STEPS_OUT: usize = 64;
const STEP_OUT: f32 = 0.25 * CLEARANCE;
const LONGER: f32 = 1.2;

impl GestureContext<'_> {
    /// The pen's path, pixels.
    pub(super) fn line(&self) -> Vec<Vec2> {
        self.gesture.samples.iter().map(|sample| sample.at).collect()
    }
    /// Where the pen touched down, pixels.
    pub(super) fn start(&self) -> Vec2 {
        self.gesture.samples[0].at
    }
    /// Reach of a brush, pixels.
    pub(super) fn reach(&self) -> f32 {
        if self.gesture.size > 0.0 { self.gesture.size } else { 2.0 * self.set.rho }
    }

    /// Indices of the curves that the gesture names; `None` if it names none. Missing ones are reported.
    fn named(&self, sketch: &mut SketchState) -> Option<Vec<usize>> {
        if self.gesture.curves.is_empty() {
            return None;
        }
        let mut wanted: BTreeMap<u64, bool> =
            self.gesture.curves.iter().map(|id| (*id, false)).collect();
        let mut found = vec![];
        for (i, lock) in sketch.locks.iter().enumerate() {
            if let Some(seen) = wanted.get_mut(&lock.id) {
                *seen = true;
                if lock.is_curve() {
                    found.push(i);
                }
            }
        }
        let all = wanted.len();
        let missing: Vec<u64> =
            wanted.into_iter().filter(|(_, seen)| !seen).map(|(id, _)| id).collect();
        if !missing.is_empty() {
            let text = match missing.len() == all {
                true => format!("its {} not there any more", curves(all)),
                false => format!("{} of its {} not there any more", missing.len(), curves(all)),
            };
            sketch.say(text);
        }
        (sketch.now.named, sketch.now.orphaned) = (all, missing);
        Some(found)
    }

    /// Indices of the curves that the gesture acts on: the named ones, or else those that `under` finds.
    pub(super) fn takes(
        &self,
        sketch: &mut SketchState,
        under: impl FnOnce(&Self, &SketchState) -> Vec<usize>,
        nothing: &str,
    ) -> Vec<usize> {
        let named = self.named(sketch);
        let found = named.unwrap_or_else(|| under(self, sketch));
        if found.is_empty() && sketch.now.said.is_empty() {
            sketch.say(nothing);
        }
        sketch.now.picked = found.len();
        found
    }

    /// Curves that the line of sight through a pixel hits before the head, with their distance from the eye (cm),
    /// nearest first.
    pub(super) fn met(&self, sketch: &SketchState, pixel: Vec2) -> Vec<(usize, f32)> {
        let (origin, direction) = self.seen.ray(pixel);
        let head = self.seen.head(self.scalp, pixel).map_or(f32::MAX, |hit| hit.distance);
        let mut met: Vec<(usize, f32)> = vec![];
        for (i, lock) in sketch.locks.iter().enumerate().filter(|(_, lock)| lock.is_curve()) {
            let pieces = lock.points.windows(2).zip(lock.radii.windows(2));
            let nearest = pieces.filter_map(|(pair, radii)| {
                let (apart, far) = between(origin, direction, pair[0], pair[1]);
                let touch =
                    TOUCH * self.seen.cm_per_pixel(self.seen.depth(origin + direction * far));
                let wide = radii[0].max(radii[1]).max(touch);
                // A cluster that lies on the head is in front of it with its nearer half.
                let before = far > 0.0 && far - wide < head;
                (before && apart <= wide).then_some(far)
            });
            if let Some(far) = nearest.min_by(f32::total_cmp) {
                met.push((i, far));
            }
        }
        met.sort_by(|a, b| a.1.total_cmp(&b.1).then(a.0.cmp(&b.0)));
        met
    }

    /// Curves under the pen's start, by layer.
    pub(super) fn under_start(&self, sketch: &SketchState) -> Vec<usize> {
        let met = self.met(sketch, self.start());
        let most = if self.gesture.layer == Layer::Nearest { 1 } else { usize::MAX };
        met.into_iter().take(most).map(|(i, _)| i).collect()
    }

    /// Curves under the pen's start or, if it touched down beside hair and then moved back and forth across it, under
    /// the stroke's centre.
    pub(super) fn under_start_or_middle(&self, sketch: &SketchState) -> Vec<usize> {
        let found = self.under_start(sketch);
        if !found.is_empty() {
            return found;
        }
        let line = self.line();
        let met = self.met(sketch, line.iter().sum::<Vec2>() / line.len() as f32);
        let most = if self.gesture.layer == Layer::Nearest { 1 } else { usize::MAX };
        met.into_iter().take(most).map(|(i, _)| i).collect()
    }

    /// Curves that a stroke passes within `reach` (pixels) on this side of the head, at or between their CVs, clusters as wide
    /// as they are drawn; if the layer asks for one, that under the pen's start, or else the one passed nearest to it.
    pub(super) fn passed(&self, sketch: &SketchState, line: &[Vec2], reach: f32) -> Vec<usize> {
        if self.gesture.layer == Layer::Nearest
            && let Some((i, _)) = self.met(sketch, self.start()).first()
        {
            return vec![*i];
        }
        // How far the curve is from a line, pixels, where it is within its reach and can be seen.
        let near = |i: usize, line: &[Vec2]| -> Option<f32> {
            let lock = &sketch.locks[i];
            let pieces = lock.points.windows(2).enumerate().filter_map(|(k, pair)| {
                let ends = [self.seen.pixel(pair[0])?, self.seen.pixel(pair[1])?];
                let (off, t) = off_piece(line, ends);
                let off = off - self.tube(lock, k).max(self.tube(lock, k + 1));
                let p = pair[0].lerp(pair[1], t);
                (off <= reach && self.seen.sees(self.scalp, p)).then_some(off)
            });
            pieces.min_by(f32::total_cmp)
        };
        let curves = (0..sketch.locks.len()).filter(|i| sketch.locks[*i].is_curve());
        if self.gesture.layer == Layer::Nearest {
            let off = |i: usize| Some((i, near(i, &line[..1])?));
            let nearest = curves.filter_map(off).min_by(|a, b| a.1.total_cmp(&b.1));
            return nearest.into_iter().map(|(i, _)| i).collect();
        }
        curves.filter(|i| near(*i, line).is_some()).collect()
    }

    /// Half the drawn width of a cluster at a CV, pixels; 0 for a curve that is not a cluster.
    pub(super) fn tube(&self, lock: &Lock, k: usize) -> f32 {
        let cm = self.seen.cm_per_pixel(self.seen.depth(lock.points[k]));
        if lock.is_cluster() { lock.radii[k] / cm } else { 0.0 }
    }

    /// The depth of a point under a pixel once it is moved towards the eye until it is `height` (cm) above the skin: it keeps its
    /// place in the picture.
    pub(super) fn out_of_skin(&self, pixel: Vec2, depth: f32, height: f32) -> f32 {
        let (mut depth, mut least) = (depth.max(NEAREST), STEP_OUT);
        for _ in 0..STEPS_OUT {
            let short = height - self.skin.distance(self.seen.at(pixel, depth));
            // Written so that NaN ends it.
            if !(short > 0.0 && depth > NEAREST) {
                break;
            }
            depth = (depth - short.max(least)).max(NEAREST);
            least *= LONGER;
        }
        depth
    }

    /// The same, in front of everything of the head that the pixel shows.
    pub(super) fn before_head(&self, pixel: Vec2, depth: f32, height: f32) -> f32 {
        let skin = self.seen.head(self.scalp, pixel).map(|hit| self.seen.depth(hit.point));
        self.out_of_skin(pixel, skin.map_or(depth, |skin| skin.min(depth)), height)
    }

    /// Where the pen's start hits the head.
    pub(super) fn on_head(&self) -> Option<Hit> {
        self.seen.head(self.scalp, self.start())
    }

    /// The CV of a curve drawn nearest to the pen's start (never the root), and its distance, pixels.
    pub(super) fn nearest_cv(&self, lock: &Lock) -> Option<(usize, f32)> {
        let off = |k: usize| Some((k, self.seen.pixel(lock.points[k])?.distance(self.start())));
        (1..lock.points.len()).filter_map(off).min_by(|a, b| a.1.total_cmp(&b.1))
    }

    /// A curve as drawn: pixels and depths of its CVs; `None` if part of it is behind the eye.
    pub(super) fn drawn(&self, lock: &Lock) -> Option<Vec<(Vec2, f32)>> {
        lock.points.iter().map(|p| Some((self.seen.pixel(*p)?, self.seen.depth(*p)))).collect()
    }
}

/// The number of curves, with a matching verb.
fn curves(count: usize) -> String {
    if count == 1 { "curve is".to_owned() } else { format!("{count} curves are") }
}

/// Distance of a pixel from a polyline.
pub(super) fn off_line(line: &[Vec2], at: Vec2) -> f32 {
    if let [one] = line {
        return one.distance(at);
    }
    let off = |pair: &[Vec2]| {
        let along = pair[1] - pair[0];
        let t = (at - pair[0]).dot(along) / along.length_squared().max(1e-12);
        at.distance(pair[0] + along * t.clamp(0.0, 1.0))
    };
    line.windows(2).map(off).fold(f32::MAX, f32::min)
}

/// Distance between a polyline and a straight piece, and the fraction along the piece where it is least.
pub(super) fn off_piece(line: &[Vec2], [a, b]: [Vec2; 2]) -> (f32, f32) {
    let along = b - a;
    let at = |p: Vec2| {
        let t = ((p - a).dot(along) / along.length_squared().max(1e-12)).clamp(0.0, 1.0);
        (p.distance(a + along * t), t)
    };
    let crossing = |pair: &[Vec2]| {
        let (way, off) = (pair[1] - pair[0], pair[0] - a);
        let slope = along.perp_dot(way);
        let (t, u) = (off.perp_dot(way) / slope, off.perp_dot(along) / slope);
        let within = |x: f32| (0.0..=1.0).contains(&x);
        (slope != 0.0 && within(t) && within(u)).then_some((0.0, t))
    };
    let ends = [0.0, 1.0].map(|t| (off_line(line, a + along * t), t));
    let places = line.iter().map(|p| at(*p)).chain(ends);
    let all = places.chain(line.windows(2).filter_map(crossing));
    all.min_by(|a, b| a.0.total_cmp(&b.0)).unwrap_or((f32::MAX, 0.0))
}

/// Distance of a line of sight from a segment of a curve, and the position along the segment.
fn between(origin: Vec3, direction: Vec3, a: Vec3, b: Vec3) -> (f32, f32) {
    let (along, off) = (b - a, a - origin);
    let (ll, ld) = (along.length_squared(), along.dot(direction));
    let apart = ll - ld * ld;
    let t = match apart > 1e-9 {
        true => ((ld * off.dot(direction) - along.dot(off)) / apart).clamp(0.0, 1.0),
        false => 0.0,
    };
    let p = a + along * t;
    let far = (p - origin).dot(direction);
    (p.distance(origin + direction * far), far)
}
