//! Laying a weave along a source curve: stations, frames, amplitudes, and the skin underneath.
//!
//! The picture: *stations* are placed along the source, several per stitch. Each has a frame, an amplitude and a
//! position in the weave's cycle, which together place a point of every strand. Points that collide with the skin are
//! pressed or moved off it, and each strand is then resampled evenly along its own length.
//!
//! **Invariant:** whatever moves points in depth keeps their order there, so no crossing is ever undone.

use super::strand_radius::StrandLine;
use super::weave::{BraidSize, OUTLINE, Weave};
use crate::data::route::makers::lift;
use crate::data::scalp::{Scalp, Skin};
use crate::maths::frame::{self, Frame, SkinUnder};
use crate::maths::hash::Dice;
use crate::maths::smoothstep;
use crate::maths::spline::{CurveFault, Spline, SplineParam};
use glam::Vec3;

/// Direction of a braid's front.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Facing {
    /// Carried from the root with minimal twist.
    Carried,
    /// A fixed direction.
    Axis(Vec3),
    /// Away from the skin.
    Skin,
}

/// What happens where a braid reaches into the skin.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Contact {
    /// Pressed onto the skin.
    Flatten,
    /// Moved off the skin as a whole.
    PushOut,
    /// Left as it is.
    Allow,
}

/// The stitch coordinate along the source: the arc length in cm reached at each stitch.
#[derive(Clone, Debug)]
pub(crate) struct Advance {
    pitch: f32,
    /// Arc length at each whole stitch if they are uneven; empty if they are even.
    knots: Vec<f32>,
}

impl Advance {
    /// Stitches of equal length.
    pub(crate) fn even(pitch: f32) -> Self {
        Self { pitch, knots: vec![] }
    }
    /// Stitches of these lengths.
    pub(crate) fn uneven(pitch: f32, lengths: impl Iterator<Item = f32>) -> Self {
        let mut knots = vec![0.0];
        for length in lengths {
            knots.push(knots[knots.len() - 1] + length);
        }
        Self { pitch, knots }
    }
    /// Arc length at stitch coordinate `q`.
    pub(crate) fn s(&self, q: f64) -> f32 {
        let spans = self.knots.len().saturating_sub(1);
        if spans == 0 {
            return (q * f64::from(self.pitch)) as f32;
        }
        let k = (q.max(0.0) as usize).min(spans - 1);
        let length = |k: usize| self.knots[k + 1] - self.knots[k];
        // The harmonic mean of adjacent lengths as slope keeps the cubic monotonic.
        let slope = |k: usize| {
            let (a, b) = (length(k.saturating_sub(1)), length(k.min(spans - 1)));
            2.0 * a * b / (a + b)
        };
        let (m0, m1, rise) = (slope(k), slope(k + 1), length(k));
        let t = (q - k as f64) as f32;
        if t > 1.0 {
            return self.knots[spans] + (t - 1.0) * m1;
        }
        let (c2, c3) = (3.0 * rise - 2.0 * m0 - m1, m0 + m1 - 2.0 * rise);
        self.knots[k] + ((c3 * t + c2) * t + m0) * t
    }
    /// The stitch coordinate at arc length `s`, which must lie within the known stitches.
    pub(crate) fn q(&self, s: f32) -> f64 {
        if self.knots.len() < 2 {
            return f64::from(s) / f64::from(self.pitch);
        }
        let (mut low, mut high) = (0.0, (self.knots.len() - 1) as f64);
        for _ in 0..48 {
            let mid = 0.5 * (low + high);
            if self.s(mid) < s { low = mid } else { high = mid }
        }
        0.5 * (low + high)
    }
}

/// The skin below a braid, and how the braid reacts to it.
#[derive(Clone, Copy)]
pub(crate) struct Below<'a> {
    pub(crate) scalp: &'a Scalp,
    pub(crate) skin: Skin<'a>,
    pub(crate) contact: Contact,
}

/// Everything that determines the positions of a braid's strands.
pub(crate) struct BraidShape<'a> {
    pub(crate) weave: Weave,
    /// At the widest position.
    pub(crate) size: BraidSize,
    pub(crate) advance: Advance,
    /// Stitches up to the tie.
    pub(crate) stitches: f64,
    /// Arc length of the source at the tie.
    pub(crate) tied_at: f32,
    /// Length of the tuft; 0: none.
    pub(crate) tuft: f32,
    pub(crate) flare: f32,
    /// Position of the first strand in its cycle at the root, in cycles.
    pub(crate) phase: f64,
    pub(crate) cvs_per_stitch: usize,
    pub(crate) gather: f32,
    /// Fraction of the full size across and in depth, by the fraction along the source.
    pub(crate) scale: &'a dyn Fn(f32) -> (f32, f32),
    /// Roll in radians, by the fraction along the source.
    pub(crate) roll: &'a dyn Fn(f32) -> f32,
    pub(crate) facing: Facing,
    /// Preferred normal at the root where nothing else determines it.
    pub(crate) start: Option<Vec3>,
    /// Height of the braid's centre above the source: a fixed part, and one that scales with the depth.
    pub(crate) raise: (f32, f32),
    pub(crate) looseness: f32,
    pub(crate) loose: Dice,
    /// Ids of the braid and of its strands.
    pub(crate) braid: u64,
    pub(crate) ids: &'a [u64],
    pub(crate) below: Option<Below<'a>>,
}

/// A braid in space.
pub(crate) struct PlacedBraid {
    /// The strands, evenly resampled.
    pub(crate) lines: Vec<StrandLine>,
    /// Braid normal at each CV of each strand, perpendicular to the strand. Unit.
    pub(crate) normals: Vec<Vec<Vec3>>,
    stations: Vec<Station>,
    /// The strands through the stations.
    raw: Vec<Spline>,
    braided: usize,
    /// CVs of a strand per station.
    finer: f32,
}

struct Station {
    s: f32,
    /// Stitch coordinate.
    q: f64,
    /// Centre of the cross-section.
    centre: Vec3,
    frame: Frame,
    /// Amplitudes, cm.
    a: f32,
    b: f32,
    /// Radius of the tubes at the bottom, cm.
    tube: f32,
    /// Direction away from the skin. Zero: not near any.
    out: Vec3,
    /// Influence of the skin, from 0 at the root of a braid that grows out of it to 1.
    grip: f32,
}

/// How much the tie narrows the braid.
const PINCH: f32 = 0.62;
/// Depth of the bundle in the tie, as a fraction of its width: hair under a band is nearly round.
const ROUND: f32 = 0.8;
/// Amplitude of strands gathered at the root: a bundle in which they lie side by side. Less turns them into wires,
/// since tubes have no thickness where centres meet.
const GATHERED: f32 = 0.3;
/// The weave comes to rest between these numbers of stitches behind the tie: sooner kinks the strands, later continues
/// the braid past the band.
const REST: (f64, f64) = (0.15, 0.65);
/// Largest turn of a source between two stations, radians (about 9 degrees).
const TURN: f32 = 0.15;
/// Stitches shorter than the amplitude wind strands up and need this many times more points at most; beyond that,
/// strands have no visible thickness.
const TIGHT: f32 = 3.0;
/// If there are more stations than this from one even point of a strand to the next, the strand gets more points, until
/// there are at most [`EVEN`] stations between them, and no more than [`MOST_MORE`] times as many.
const UNEVEN: f32 = 1.75;
const EVEN: f32 = 1.25;
const MOST_MORE: f32 = 4.0;
/// The most stations, and points of a strand, that the turns of a source alone can request.
const MOST_FOR_TURNS: f32 = 4096.0;
/// Longest step of an end tuft that the skin may turn, cm.
const TUFT_STEP: f32 = 0.4;
/// The most stations in an end tuft.
const MOST_IN_TUFT: f32 = 256.0;

impl BraidShape<'_> {
    /// Lays the strands along `source`.
    pub(crate) fn lay(&self, source: &Spline) -> Result<PlacedBraid, CurveFault> {
        let (mut stations, braided) = self.stations(source);
        let mut strands: Vec<Vec<Vec3>> = (0..self.weave.strands)
            .map(|i| stations.iter().map(|station| self.point(station, i)).collect())
            .collect();
        // Tubes stay within the braid's height; where the skin presses them, the height before pressing counts.
        let room = |(station, p): (&Station, &Vec3)| {
            let y = (*p - station.centre).dot(station.frame.normal);
            OUTLINE * station.b * (1.0 + self.size.top / self.size.b) - y.abs()
        };
        let rooms: Vec<Vec<f32>> =
            strands.iter().map(|points| stations.iter().zip(points).map(room).collect()).collect();
        if let Some(below) = &self.below {
            self.meet_skin(below, &mut stations, &mut strands);
        }
        let raw =
            strands.iter().map(|points| Spline::new(points)).collect::<Result<Vec<_>, _>>()?;
        let spans = stations.len() - 1;
        let more = raw.iter().map(|spline| more_points(spline, spans)).fold(1.0, f32::max);
        let n = (spans as f32 * more).ceil().min(MOST_FOR_TURNS.max(spans as f32)) as usize + 1;
        let finer = (n - 1) as f32 / spans as f32;
        let mut laid =
            PlacedBraid { lines: vec![], normals: vec![], stations, raw, braided, finer };
        for (i, spline) in laid.raw.iter().enumerate() {
            let (mut points, mut s, mut ups, mut room) = (vec![], vec![], vec![], vec![]);
            for k in 0..n {
                let place = spline.locate(k as f32 / (n - 1) as f32);
                points.push(spline.point(place));
                s.push(laid.along(place));
                ups.push(laid.frame(place).normal);
                let (a, b) = (rooms[i][place.span], rooms[i][place.span + 1]);
                room.push(a + (b - a) * place.t);
            }
            let even = Spline::new(&points)?;
            let normals = ups.iter().enumerate().map(|(k, up)| {
                let tangent = even.tangent_at(even.u_of_cv(k));
                frame::across(*up, tangent).unwrap_or_else(|| frame::any_normal(tangent))
            });
            laid.normals.push(normals.collect());
            laid.lines.push(StrandLine { spline: even, s, room });
        }
        Ok(laid)
    }

    /// Stations from root to tip, and the number of braided spans.
    fn stations(&self, source: &Spline) -> (Vec<Station>, usize) {
        let length = source.length();
        let tight = (self.size.a / self.size.pitch).clamp(1.0, TIGHT);
        let cvs = (self.stitches * self.cvs_per_stitch as f64 * f64::from(tight)).ceil();
        let turns = (total_turn(source) / TURN).min(MOST_FOR_TURNS);
        let braided = cvs.max(f64::from(turns)).max(8.0) as usize;
        let mut places: Vec<(f32, f64)> = (0..=braided)
            .map(|k| {
                let q = self.stitches * k as f64 / braided as f64;
                (self.advance.s(q).min(self.tied_at), q)
            })
            .collect();
        places[braided].0 = self.tied_at;
        if self.tuft > 0.0 {
            let last_step = (self.tied_at - places[braided - 1].0).max(1e-3 * self.tuft);
            let n = (self.tuft / last_step).ceil().clamp(4.0, MOST_IN_TUFT) as usize;
            // A cubic that starts at the weave's own pace and stops smoothly.
            let more = self.rest();
            let until = 3.0 * more * f64::from(self.size.pitch);
            for k in 1..=n {
                let s = self.tuft * k as f32 / n as f32;
                let left = 1.0 - (f64::from(s) / until).min(1.0);
                let q = self.stitches + more * (1.0 - left * left * left);
                places.push((self.tied_at + s, q));
            }
        }
        let us: Vec<f32> = places.iter().map(|(s, _)| (s / length).min(1.0)).collect();
        let under = self.below.as_ref().map(|below| {
            let every = (braided / self.stitches.max(1.0) as usize / 4).max(1);
            let mut few: Vec<f32> = us.iter().copied().step_by(every).collect();
            few.push(1.0);
            SkinUnder::new(below.scalp.surface(), source, few, self.size.a)
        });
        let frames =
            frame::frames(source, &us, self.start, |u, _, _| match (self.facing, &under) {
                (Facing::Skin, Some(under)) => under.normal_target(u),
                (Facing::Axis(axis), _) => Some((axis, 1.0)),
                _ => None,
            });
        let mut tuft = Tassel { reached: length, at: source.at(1.0), way: None };
        let stations = places.iter().zip(&us).zip(frames).map(|(((s, q), u), mut frame)| {
            let (out, held) = under.as_ref().map_or((Vec3::ZERO, 0.0), |under| under.at(*u));
            let (scale_x, scale_y) = (self.scale)(*u);
            let (gather_x, gather_y) = self.gathered(*s);
            let (tie_x, tie_y) = self.tie(*s);
            let (mut x, mut y) = (scale_x * gather_x * tie_x, scale_y * gather_y * tie_y);
            if self.looseness > 0.0 {
                x *= 1.0 + 0.16 * self.looseness * self.waver(*q, 0);
                y *= 1.0 + 0.22 * self.looseness * self.waver(*q, 1);
            }
            let mut centre = source.at(*u);
            if *s > length {
                // A braid on the skin is raised from there by its own height, below.
                let half = self.size.b * y + self.size.top * x.min(y);
                let height = if self.facing == Facing::Skin { 0.0 } else { half };
                (centre, frame) = tuft.lead(*s, frame, self.below.as_ref(), height);
            }
            let mut grip = 1.0;
            if self.facing == Facing::Skin {
                centre += frame.normal * (held * (self.raise.0 + self.raise.1 * y));
            } else {
                grip = smoothstep(s / (2.0 * (self.size.a + self.size.side)));
            }
            Station {
                s: *s,
                q: *q,
                centre,
                frame: frame.rolled((self.roll)(*u)),
                a: self.size.a * x,
                b: self.size.b * y,
                tube: self.size.top * x.min(y),
                out,
                grip,
            }
        });
        (stations.collect(), braided)
    }

    /// Stitches from the tie to where the weave rests: where the strands make the roundest bundle.
    fn rest(&self) -> f64 {
        let n = f64::from(self.weave.strands);
        let roundness = |more: f64| {
            let cycle = self.phase + (self.stitches + more) / n;
            let at: Vec<(f32, f32)> =
                (0..self.weave.strands).map(|i| self.weave.at(i, cycle)).collect();
            let mut least = f32::MAX;
            for (i, a) in at.iter().enumerate() {
                for b in &at[..i] {
                    let (x, y) = (a.0 - b.0, ROUND * (a.1 - b.1));
                    least = least.min(x * x + y * y);
                }
            }
            least
        };
        let tries = (0..=16).map(|k| REST.0 + (REST.1 - REST.0) * f64::from(k) / 16.0);
        let best = tries.map(|more| (roundness(more), more));
        best.fold((-1.0, REST.0), |best, it| if it.0 > best.0 { it } else { best }).1
    }

    /// Factors of the amplitudes where strands gather at the root.
    fn gathered(&self, s: f32) -> (f32, f32) {
        if self.gather <= 0.0 {
            return (1.0, 1.0);
        }
        let t = smoothstep(s / self.gather);
        let round = (ROUND * GATHERED * self.size.a / self.size.b).min(1.0);
        (GATHERED + (1.0 - GATHERED) * t, round + (1.0 - round) * t)
    }

    /// Factors of the amplitudes around the tie and beyond.
    fn tie(&self, s: f32) -> (f32, f32) {
        if self.tuft <= 0.0 {
            return (1.0, 1.0);
        }
        let round = (ROUND * PINCH * self.size.a / self.size.b).max(PINCH);
        let beyond = s - self.tied_at;
        if beyond < 0.0 {
            let t = smoothstep(1.0 + beyond / self.size.pitch);
            return (1.0 + (PINCH - 1.0) * t, 1.0 + (round - 1.0) * t);
        }
        let wider = (1.0 + self.flare * smoothstep(beyond / self.tuft)).max(0.02);
        (PINCH * wider, round * wider)
    }

    /// Smooth noise along the braid, -1 to 1.
    fn waver(&self, q: f64, channel: u64) -> f32 {
        let k = q.max(0.0).floor();
        let at = |k: f64| self.loose.signed(self.braid, 2 * (k as u64) + channel);
        let t = smoothstep((q - k) as f32);
        at(k) * (1.0 - t) + at(k + 1.0) * t
    }

    /// Position of strand `i` at a station.
    fn point(&self, station: &Station, i: u32) -> Vec3 {
        let n = f64::from(self.weave.strands);
        let cycle = self.phase + station.q / n;
        let (mut x, y) = self.weave.at(i, cycle);
        if self.looseness > 0.0 {
            // A bulge where the strand is outermost, of a different size at each pass.
            let pass = (2.0 * (cycle + self.weave.ahead(i))).floor().max(0.0) as u64;
            let x2 = x * x;
            // With more strands, the last crossing is closer to the edge (as 1 - cos(pi / N)): strands bulge less
            // there, or one would pass the next before it turns.
            let fewer = (5.0 / n as f32).min(1.0);
            let most = 0.3 * fewer * fewer * self.looseness;
            x *= 1.0 + most * self.loose.unit(self.ids[i as usize], pass) * x2 * x2;
        }
        station.centre + station.frame.across(station.a * x, station.b * y)
    }

    /// Presses or moves the strands off the skin.
    fn meet_skin(&self, below: &Below, stations: &mut [Station], strands: &mut [Vec<Vec3>]) {
        if below.contact == Contact::Allow {
            return;
        }
        let half = (self.cvs_per_stitch / 2).max(1);
        if below.contact == Contact::Flatten {
            // One ground height for a whole section, rising and falling slowly along the braid: over folds of the skin,
            // strands pressed individually by what is below them would change their order.
            let lacking: Vec<f32> = stations
                .iter()
                .enumerate()
                .map(|(k, station)| {
                    let facing = smoothstep((station.frame.normal.dot(station.out) - 0.3) / 0.4);
                    let lacks = |points: &Vec<Vec3>| lacks(station, points[k], below);
                    let most = strands.iter().map(lacks).fold(0.0, f32::max);
                    most * facing
                })
                .collect();
            let eased = eased_above(&lacking, half);
            for (k, station) in stations.iter().enumerate().filter(|(k, _)| eased[*k] > 0.0) {
                for points in strands.iter_mut() {
                    points[k] = pressed(station, points[k], eased[k] * station.grip);
                }
            }
        }
        // What is still in the skin moves with its whole cross-section, which keeps its shape.
        let lacking: Vec<f32> = stations
            .iter()
            .enumerate()
            .map(|(k, station)| {
                let most = strands.iter().fold(0.0f32, |most, points| {
                    let reach = 2.0 * station.tube;
                    let lacks = distance(below, points[k], reach).map_or(0.0, |d| station.tube - d);
                    most.max(lacks)
                });
                // Pressing leaves a thousandth by rounding.
                if most > 1e-3 * station.tube { most } else { 0.0 }
            })
            .collect();
        if lacking.iter().all(|lack| *lack == 0.0) {
            return;
        }
        let eased = eased_above(&lacking, half);
        for (k, station) in stations.iter_mut().enumerate() {
            let step = station.out * (eased[k] * station.grip);
            station.centre += step;
            strands.iter_mut().for_each(|points| points[k] += step);
        }
    }
}

/// Centre line of an end tuft past the end of its source: straight on, or along the skin where that is in the way.
struct Tassel {
    /// Distance in cm along source and tuft, and the position there.
    reached: f32,
    at: Vec3,
    /// Direction and front, once it has left the source.
    way: Option<Frame>,
}

impl Tassel {
    /// Centre at `s`, and its frame. `last` is the source's frame at its end; the centre stays `height` cm off the
    /// skin.
    fn lead(&mut self, s: f32, last: Frame, below: Option<&Below>, height: f32) -> (Vec3, Frame) {
        let way = *self.way.get_or_insert(last);
        let (far, from) = (s - self.reached, self.at);
        let below = below.filter(|below| below.contact != Contact::Allow);
        let mut to = from;
        // Short enough that no step ends deeper than the distance field covers.
        let steps =
            if below.is_some() { (far / TUFT_STEP).ceil().clamp(1.0, MOST_IN_TUFT) } else { 1.0 };
        for _ in 0..steps as usize {
            to += way.tangent * (far / steps);
            if let Some(below) = below {
                to = lift(&below.skin, to, height).0;
            }
        }
        // Exactly as far as requested, however the skin turned it.
        let tangent = (to - from).try_normalize().unwrap_or(way.tangent);
        self.at = from + tangent * far;
        self.reached = s;
        let normal =
            frame::across(way.normal, tangent).unwrap_or_else(|| frame::any_normal(tangent));
        self.way = Some(Frame { tangent, normal });
        (self.at, Frame { tangent, normal })
    }
}

/// How much the lowest possible position of a strand at `p` is below the skin.
fn lacks(station: &Station, p: Vec3, below: &Below) -> f32 {
    let over_lowest = (p - station.centre).dot(station.frame.normal) + station.b;
    let reach = 2.0 * (station.b + station.tube);
    distance(below, p, reach).map_or(0.0, |d| station.tube - (d - over_lowest))
}

/// A point of a cross-section after pressing from below: the lowest possible position of a strand rests on the skin,
/// the highest stays, and everything between keeps its order.
fn pressed(station: &Station, p: Vec3, lacks: f32) -> Vec3 {
    let depth = 2.0 * station.b;
    if depth <= 0.0 {
        return p;
    }
    // At most this much of the depth is compressed; beyond that, everything is lifted.
    let pressed = lacks.min(0.6 * depth);
    let over_lowest = (p - station.centre).dot(station.frame.normal) + station.b;
    let share = 1.0 - (over_lowest / depth).clamp(0.0, 1.0);
    p + station.frame.normal * (pressed * share + (lacks - pressed))
}

/// Signed distance from the skin if it is below `reach`.
pub(crate) fn distance(below: &Below, p: Vec3, reach: f32) -> Option<f32> {
    // The field covers distances up to a centimetre.
    if reach < 0.95 {
        return Some(below.skin.distance(p)).filter(|d| *d < 0.99);
    }
    let surface = below.scalp.surface();
    surface.closest_within(p, reach).map(|hit| surface.signed_distance(p, &hit))
}

/// A smooth function nowhere below `values`: the maximum of each neighbourhood, averaged over neighbourhoods of the same
/// size.
fn eased_above(values: &[f32], half: usize) -> Vec<f32> {
    let n = values.len();
    let around = |k: usize| k.saturating_sub(half)..(k + half + 1).min(n);
    let high: Vec<f32> =
        (0..n).map(|k| values[around(k)].iter().fold(0.0f32, |most, v| most.max(*v))).collect();
    (0..n)
        .map(|k| {
            let (from, to) = (k as isize - half as isize, k as isize + half as isize);
            let at = |i: isize| high[i.clamp(0, n as isize - 1) as usize];
            (from..=to).map(at).sum::<f32>() / (to - from + 1) as f32
        })
        .collect()
}

/// Factor of points over stations that a strand needs so that its even points also show its crossings. Where a source
/// bends sharply, the outer strands are so much longer that the rest would be left with few points.
fn more_points(spline: &Spline, spans: usize) -> f32 {
    let reached = |k: usize| {
        let place = spline.locate(k as f32 / spans as f32);
        place.span as f32 + place.t
    };
    let widest = (0..spans).map(|k| reached(k + 1) - reached(k)).fold(0.0, f32::max);
    if widest > UNEVEN { (widest / EVEN).min(MOST_MORE) } else { 1.0 }
}

/// Total turn of a curve, radians (chords for arcs: slightly less).
fn total_turn(spline: &Spline) -> f32 {
    let mut last = spline.tangent(SplineParam { span: 0, t: 0.0 });
    let mut total = 0.0;
    for span in 0..spline.span_count() {
        for t in [0.25, 0.5, 0.75, 1.0] {
            let tangent = spline.tangent(SplineParam { span, t });
            total += tangent.distance(last);
            last = tangent;
        }
    }
    total
}

/// A point where a strand is outermost.
pub(crate) struct OutermostPoint {
    /// Stitch coordinate.
    pub(crate) q: f64,
    /// -1 left, 1 right.
    pub(crate) side: i32,
    pub(crate) strand: u32,
}

impl BraidShape<'_> {
    /// The stitches up to the tie, in order; of two at one position, the left one first.
    pub(crate) fn stitches(&self) -> Vec<OutermostPoint> {
        let n = f64::from(self.weave.strands);
        let mut all = vec![];
        for (quarter, side) in [(0.25, self.weave.first_side()), (0.75, -self.weave.first_side())] {
            let first = (quarter - self.phase) * n;
            let mut q = first - first.floor();
            // Values that round to a whole stitch count as one.
            if q > 1.0 - 1e-9 {
                q = 0.0;
            }
            while q < self.stitches - 1e-9 {
                let strand = (first - q).round().rem_euclid(n) as u32;
                all.push(OutermostPoint { q, side, strand });
                q += 1.0;
            }
        }
        all.sort_by(|a, b| {
            (a.q + 1e-7 * f64::from(a.side)).total_cmp(&(b.q + 1e-7 * f64::from(b.side)))
        });
        all
    }
}

impl PlacedBraid {
    /// The position of a stitch coordinate on the strands through the stations.
    fn place(&self, q: f64, stitches: f64) -> SplineParam {
        let x = (q / stitches).clamp(0.0, 1.0) * self.braided as f64;
        let span = (x as usize).min(self.braided - 1);
        SplineParam { span, t: (x - span as f64) as f32 }
    }
    /// Position of strand `strand` at a stitch, its arc length along the source, and the braid's normal.
    pub(crate) fn stitch(&self, stitch: &OutermostPoint, stitches: f64) -> (Vec3, f32, Vec3) {
        let place = self.place(stitch.q, stitches);
        let point = self.raw[stitch.strand as usize].point(place);
        (point, self.along(place), self.frame(place).normal)
    }
    /// CVs of a strand per stitch.
    pub(crate) fn cvs_per_stitch(&self, stitches: f64) -> f32 {
        (self.braided as f64 / stitches) as f32 * self.finer
    }
    fn along(&self, place: SplineParam) -> f32 {
        let (a, b) = (&self.stations[place.span], &self.stations[place.span + 1]);
        a.s + (b.s - a.s) * place.t
    }
    fn frame(&self, place: SplineParam) -> Frame {
        let (a, b) = (&self.stations[place.span].frame, &self.stations[place.span + 1].frame);
        let tangent = a.tangent.lerp(b.tangent, place.t).try_normalize().unwrap_or(a.tangent);
        let normal = a.normal.lerp(b.normal, place.t);
        Frame { tangent, normal: frame::across(normal, tangent).unwrap_or(a.normal) }
    }
    /// Influence of the skin at arc length `s`: 0 at the root of a braid that grows out of it, then 1.
    pub(crate) fn grip(&self, s: f32) -> f32 {
        let after = self.stations.partition_point(|station| station.s <= s);
        self.stations[after.clamp(1, self.stations.len()) - 1].grip
    }
    /// Centre of the braid at arc length `s`.
    pub(crate) fn centre(&self, s: f32) -> Vec3 {
        let after = self.stations.partition_point(|station| station.s <= s);
        self.stations[after.clamp(1, self.stations.len()) - 1].centre
    }
}
