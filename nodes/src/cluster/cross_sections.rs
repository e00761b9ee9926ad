//! Cross-sections of a cluster at the CVs of its strands, computed once for all strands.

use super::cells::CellMoments;
use crate::data::attributes::{ALLOW_DEPTH, CUT, FLATNESS, NORMAL, ROLL, SCALP_NORMAL};
use crate::data::curves::{AttributeView, MOST_A_CURVE, Tuft};
use crate::data::field::Sampler;
use crate::data::scalp::{Scalp, Skin};
use crate::maths::frame::{Frame, across, any_normal, carry, frames};
use crate::maths::random_walk::smooth;
use crate::maths::smoothstep;
use crate::maths::spline::{CurveFault, Spline, SplineParam};
use crate::maths::transcendental::{atan2, sin_cos};
use glam::{Mat2, Vec2, Vec3};

/// Largest rotation of the cross-section between two CVs of a strand, degrees.
const TURN: f32 = 30.0;
/// Strands reach the plane across the cluster within this many radii from the root. With less, strands rooted in front of a
/// cluster that leaves at a flat angle would have to run back.
const REACH: f32 = 1.25;
/// Strands that are rooted beside the disc have joined the tube after this many times their distance from it.
const JOINS: f32 = 3.0;
/// Added to the mean square of a cell each way, in radii, so that one which is no wider than a line fills part of the tube.
const THIN: f32 = 1e-3;
/// Largest number of steps of the random walk along a cluster.
const MOST_STEPS: f32 = 4096.0;

/// Settings of a cluster.
pub(super) struct CrossSectionParams<'a> {
    pub points: usize,
    pub radius: &'a Sampler<'a>,
    pub frizz: &'a Sampler<'a>,
    /// Spacing of frizz steps, cm; 0: one step per CV.
    pub frizz_step: f32,
    /// Smallest radius, cm, that holds a strand.
    pub least: f32,
}

/// Data shared by all strands of a cluster.
pub(super) struct CrossSections {
    /// Root of the cluster.
    pub root: Vec3,
    /// Fraction along the cluster where it first opens: see [`open_radius`].
    pub root_radius: f32,
    /// Plane in which strands end: a point, and the unit normal out of the hair.
    pub cut: Option<(Vec3, Vec3)>,
    /// Half axes of the disc of roots in the scalp's tangent plane, cm.
    pub disc: [Vec3; 2],
    /// The same of the disc before it is flattened.
    round: [Vec3; 2],
    /// The thin axis of the cross-section, and how upright the cluster leaves the skin: 0 along it, 1 straight up.
    thin: Vec2,
    upright: f32,
    /// One per CV of a strand; that of the root is unused.
    pub at: Vec<CrossSection>,
    /// Largest step of the walk to each of its knots, in radii; empty without frizz.
    pub steps: Vec<f32>,
    /// Whether strands need more CVs than they may have.
    pub coarse: bool,
    /// Whether the cluster sets its allowed depth under the skin per CV.
    pub sinks: bool,
    /// Where on the cluster they lie.
    pub places: Vec<SplineParam>,
}

/// The cross-section at one CV of the strands.
pub(super) struct CrossSection {
    pub centre: Vec3,
    /// Half axes, cm; radius and roll are included.
    pub x: Vec3,
    pub y: Vec3,
    /// Index of the first of three knots of the walk, and the weight of each.
    pub knot: usize,
    pub weights: [f32; 3],
    /// Allowed depth of the CV under the skin, cm.
    pub depth: f32,
    /// Distance along the cluster, cm.
    along: f32,
    tangent: Vec3,
    pub radius: f32,
}

/// Where a strand is rooted, in radii of the cluster's disc.
#[derive(Clone, Copy)]
pub(super) struct RootPlace {
    /// Its place across the tube.
    pub across: Vec2,
    /// How far beside the tube it begins.
    pub beside: Vec2,
    /// Its distance from the cluster's root; 1 at least.
    pub far: f32,
}

/// How a cell fills a tube: see [`CrossSections::filled_by`].
pub(super) struct FilledTube {
    middle: Vec2,
    inverse: Mat2,
}

impl RootPlace {
    /// In the disc.
    pub(super) fn within(across: Vec2) -> Self {
        Self { across, beside: Vec2::ZERO, far: 1.0 }
    }
}

impl CrossSection {
    /// The point of a strand at `d` across the tube (in radii), rooted `offset` from the cluster's root. It is no farther from the
    /// centre line than the radius, or than its root was.
    #[inline]
    pub(super) fn point(&self, place: &RootPlace, root_radius: f32, offset: Vec3, d: Vec2) -> Vec3 {
        let mut d = d;
        if place.beside != Vec2::ZERO {
            let far = place.beside.length() * root_radius;
            d += place.beside * (1.0 - smoothstep(self.along / (JOINS * far)));
        }
        let p = self.centre + self.x * d.x + self.y * d.y;
        let share = (1.0 - self.along / (REACH * root_radius * place.far).max(1e-6)).max(0.0);
        if share <= 0.0 {
            return p;
        }
        let blended = (p - self.centre).lerp(offset, share);
        let along = self.tangent * blended.dot(self.tangent);
        self.centre + along + (blended - along).clamp_length_max(self.radius * place.far)
    }
}

impl CrossSections {
    pub(super) fn new(
        tuft: &Tuft,
        curve: usize,
        asked: &CrossSectionParams,
        head: Option<(Skin, &Scalp)>,
    ) -> Result<Self, CurveFault> {
        let spline = Spline::new(tuft.curve(curve))?;
        let (cvs, length) = (tuft.range(curve), spline.length());
        let sample = |field: &Sampler, place: SplineParam, u: f32| {
            between(place, |cv| field.at(curve, cvs.start + cv, u))
        };
        let rolls = rolls(tuft, curve);
        let roll_at = |place: SplineParam| between(place, |cv| rolls[cv]).to_radians();
        let (us, places, coarse) = strand_points(&spline, asked, &rolls);

        let (root, tangent) = (tuft.curve(curve)[0], spline.tangent(places[0]));
        let radius_at = |place: SplineParam, u: f32| sample(asked.radius, place, u);
        let root_radius =
            open_radius(tuft, curve, asked.radius, asked.least, |cv| spline.u_of_cv(cv));
        let hit = head.and_then(|(skin, scalp)| Some((skin.closest(root)?, scalp)));
        let normal = match hit {
            Some((hit, scalp)) => scalp.surface().smooth_normal(hit.triangle, hit.bary),
            None => tuft.view(SCALP_NORMAL).at(curve, cvs.start).try_normalize().unwrap_or(tangent),
        };
        let upright = Frame { tangent: normal, normal: any_normal(normal) };
        let start = carry(upright.normal, normal, tangent);
        let upright = upright.rolled(roll_at(places[0]));

        let depth = tuft.view(ALLOW_DEPTH);
        let spans = match asked.frizz_step {
            step if step > 0.0 => (length / step).round().clamp(1.0, MOST_STEPS) as usize,
            _ => spline.span_count(),
        };
        let steps: Vec<f32> = (0..=spans)
            .map(|knot| match asked.frizz_step {
                step if step > 0.0 => {
                    let u = knot as f32 / spans as f32;
                    sample(asked.frizz, spline.locate(u), u)
                }
                _ => asked.frizz.at(curve, cvs.start + knot, spline.u_of_cv(knot)),
            })
            .collect();
        let carried = frames(&spline, &us, Some(start), |_, _, _| None);
        let flatness = tuft.view(FLATNESS);
        let flat = Flat::new(flatness, tuft.view(NORMAL).at(curve, cvs.start), normal, &carried);
        // A flatness that is not finite counts as round.
        let thin = |place: SplineParam| {
            between(place, |cv| {
                Some(flatness.at(curve, cvs.start + cv)).filter(|x| x.is_finite()).unwrap_or(1.0)
            })
            .clamp(0.02, 1.0)
        };
        let at = carried
            .into_iter()
            .zip(us.iter().zip(&places))
            .map(|(frame, (&u, &place))| {
                let radius = radius_at(place, u);
                let frame = frame.rolled(roll_at(place));
                let axes = [frame.normal * radius, frame.binormal() * radius];
                let [x, y] = flat.pressed(axes, thin(place));
                let (knot, weights) = smooth(match asked.frizz_step {
                    step if step > 0.0 => u * spans as f32,
                    _ => place.span as f32 + place.t,
                });
                CrossSection {
                    centre: spline.point(place),
                    x,
                    y,
                    knot,
                    weights,
                    depth: between(place, |cv| depth.at(curve, cvs.start + cv)),
                    along: u * length,
                    tangent: frame.tangent,
                    radius,
                }
            })
            .collect();
        let round = [upright.normal * root_radius, upright.binormal() * root_radius];
        let disc = flat.pressed(round, thin(places[0]));
        let steps = if steps.iter().all(|s| *s <= 0.0) { vec![] } else { steps };
        let sinks = matches!(depth, AttributeView::Point(all) if all[cvs.clone()].iter().any(|depth| *depth > 0.0));
        let cut = tuft.view(CUT).at(curve, cvs.start).try_normalize();
        let cut = cut.map(|normal| (tuft.curve(curve)[cvs.len() - 1], normal));
        Ok(Self {
            root,
            cut,
            root_radius,
            disc,
            round,
            thin: Vec2::from(flat.thin),
            upright: flat.upright,
            at,
            steps,
            places,
            coarse,
            sinks,
        })
    }

    /// How a cell fills the tube: its middle becomes that of the tube, and it is as wide as that each way.
    pub(super) fn filled_by(&self, cell: &CellMoments) -> FilledTube {
        let [x, y] = self.round.map(|axis| axis / axis.length_squared().max(1e-12));
        let [to_x, to_y] = [cell.moment * x, cell.moment * y];
        let [xx, xy, yy] = [x.dot(to_x) + THIN, x.dot(to_y), y.dot(to_y) + THIN];
        // The square root of a 2 x 2 matrix, by Cayley and Hamilton; in a disc, a coordinate is half the radius in the root mean square.
        let root = (xx * yy - xy * xy).max(0.0).sqrt();
        let scale = (xx + yy + 2.0 * root).sqrt();
        let sqrt = Mat2::from_cols_array(&[xx + root, xy, xy, yy + root]) * (2.0 / scale);
        FilledTube { middle: self.across(cell.middle), inverse: sqrt.inverse() }
    }

    /// A vector in radii of the round disc.
    fn across(&self, offset: Vec3) -> Vec2 {
        Vec2::from(self.round.map(|axis| offset.dot(axis) / axis.length_squared().max(1e-12)))
    }

    /// The place of a strand that is rooted at `root` in a cell: what is rooted beside the disc begins beside the tube, not above or
    /// below it.
    pub(super) fn place(&self, root: Vec3, tube: &FilledTube) -> RootPlace {
        let q = self.across(root - self.root);
        let across = (tube.inverse * (q - tube.middle)).clamp_length_max(1.0);
        let beside = q - across;
        let beside = beside - self.thin * (beside.dot(self.thin) * (1.0 - self.upright));
        RootPlace { across, beside, far: q.length().max(1.0) }
    }
}

/// Radius (cm) that sets the roots and the number of strands: at the first CV where the cluster holds a strand, so a tube that
/// starts in a point is not empty; the largest radius if no CV does. `u` is the fraction along at each CV.
pub(super) fn open_radius(
    tuft: &Tuft,
    curve: usize,
    radius: &Sampler,
    least: f32,
    u: impl Fn(usize) -> f32,
) -> f32 {
    let open = radii(tuft, curve, radius, &u).find(|radius| *radius > least);
    open.unwrap_or_else(|| widest_radius(tuft, curve, radius, u))
}

/// The largest radius of all CVs, cm.
pub(super) fn widest_radius(
    tuft: &Tuft,
    curve: usize,
    radius: &Sampler,
    u: impl Fn(usize) -> f32,
) -> f32 {
    radii(tuft, curve, radius, &u).fold(0.0, f32::max)
}

/// The radius at each CV, cm.
fn radii(
    tuft: &Tuft,
    curve: usize,
    radius: &Sampler,
    u: &impl Fn(usize) -> f32,
) -> impl Iterator<Item = f32> {
    let cvs = tuft.range(curve);
    (0..cvs.len()).map(move |cv| radius.at(curve, cvs.start + cv, u(cv)))
}

/// The thin axis of flat cross-sections.
struct Flat {
    /// The thin axis in a frame: its components along the normal and the binormal.
    thin: [f32; 2],
    /// How nearly the cluster leaves the root along the normal that the thin axis follows, 0 to 1.
    upright: f32,
    /// All cross-sections are round.
    round: bool,
}

impl Flat {
    /// The thin axis is the curve's own normal where it has one, else the skin's normal at the place where the cluster leaves the
    /// root.
    fn new(flatness: AttributeView<f32>, own: Vec3, skin: Vec3, carried: &[Frame]) -> Self {
        let round = matches!(flatness, AttributeView::Shared(flat) if flat >= 1.0);
        let (frame, wanted) = match own.try_normalize() {
            Some(own) => (carried.first(), own),
            None => (carried.get(carried.len() / 6), skin),
        };
        let angle = frame.map_or(0.0, |frame| {
            let wanted = across(wanted, frame.tangent).unwrap_or(frame.normal);
            atan2(wanted.dot(frame.binormal()), wanted.dot(frame.normal))
        });
        let (sin, cos) = sin_cos(angle);
        let upright = frame.map_or(0.0, |frame| wanted.dot(frame.tangent).abs().min(1.0));
        Self { thin: [cos, sin], upright, round }
    }
    /// Half axes of a cross-section with this ratio of thickness to width.
    fn pressed(&self, [x, y]: [Vec3; 2], thickness: f32) -> [Vec3; 2] {
        if self.round || thickness >= 1.0 {
            return [x, y];
        }
        let [c, s] = self.thin;
        let thin = x * c + y * s;
        let less = 1.0 - thickness;
        [x - thin * (c * less), y - thin * (s * less)]
    }
}

/// Interpolates between CVs.
fn between(place: SplineParam, at: impl Fn(usize) -> f32) -> f32 {
    let (a, b) = (at(place.span), at(place.span + 1));
    a + (b - a) * place.t
}

/// The roll at each CV, degrees.
fn rolls(tuft: &Tuft, curve: usize) -> Vec<f32> {
    let (roll, cvs) = (tuft.view(ROLL), tuft.range(curve));
    // A roll that is not finite counts as 0.
    cvs.map(|cv| Some(roll.at(curve, cv)).filter(|roll| roll.is_finite()).unwrap_or(0.0)).collect()
}

/// Positions of a strand's CVs: evenly along the cluster, and enough that it rolls by at most [`TURN`] between two. The last
/// value is whether that exceeds the limit, which is then used.
fn strand_points(
    spline: &Spline,
    asked: &CrossSectionParams,
    rolls: &[f32],
) -> (Vec<f32>, Vec<SplineParam>, bool) {
    let most_points = asked.points.max(MOST_A_CURVE);
    let mut count = asked.points;
    loop {
        let us: Vec<f32> = (0..count).map(|k| k as f32 / (count - 1) as f32).collect();
        let places: Vec<SplineParam> = us.iter().map(|u| spline.locate(*u)).collect();
        let roll = |place: SplineParam| between(place, |cv| rolls[cv]);
        let most = places.windows(2).map(|w| (roll(w[1]) - roll(w[0])).abs()).fold(0.0, f32::max);
        let fine = most <= TURN * 1.001;
        if fine || count >= most_points {
            return (us, places, !fine);
        }
        count = (((count - 1) as f32 * most / TURN).ceil() as usize + 1).min(most_points);
    }
}
