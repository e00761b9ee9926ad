//! A braid as its hair uses it: for each strand the cross-sections at fine even steps, the stitches, and the end tuft.
//! Computed once per braid, so that a point of a hair costs one lookup and a few multiplications.

use super::band::{Band, Waist};
use crate::data::attributes as attr;
use crate::data::curves::{AttributeView, Tuft};
use crate::data::field::Sampler;
use crate::data::scalp::Skin;
use crate::maths::frame::{across, any_normal};
use crate::maths::smoothstep;
use crate::maths::spline::Spline;
use crate::maths::transcendental::sin_cos;
use glam::{Vec2, Vec3};

/// Settings of the tubes. Lengths in cm.
pub(super) struct TubeParams<'a> {
    pub(super) per_stitch: f32,
    /// Factor of the strands' radius.
    pub(super) fill: &'a Sampler<'a>,
    /// Extra width of the strands over their height.
    pub(super) broad: f32,
    /// Radians per cm.
    pub(super) twist: f32,
    /// Extra thickness of the braid in a root knot, and the knot's length; `None` without one.
    pub(super) knot: Option<(f32, f32)>,
    /// The band that ties the braid.
    pub(super) band: Option<Band>,
    pub(super) skin: Option<&'a Skin<'a>>,
}

/// Table steps between two points of a hair: with linear interpolation, they are accurate to a fiftieth of a hair's
/// width.
pub(super) const FINE: f32 = 4.0;
/// Fraction of the inside of a bend that hair may fill.
const INSIDE: f32 = 0.8;
/// Hair farther than this (cm) from the skin need not be kept out of it.
const NEAR: f32 = 0.05;
/// Number of stitches that determine the local stitch length.
const OF_STITCHES: usize = 4;
/// Smallest fraction of the usual spacing.
const FINEST: f32 = 0.35;
/// Steps of the shortest end tuft.
const LEAST_TUFT: f32 = 6.0;
/// The most steps of one strand's table.
const MOST: f32 = 8192.0;

/// A cross-section.
#[derive(Clone, Copy)]
pub(super) struct TubeSection {
    pub(super) centre: Vec3,
    /// Half axes: to the braid's right, and away from its back.
    pub(super) x: Vec3,
    pub(super) y: Vec3,
    /// Curvature of the strand toward each axis, relative to the axis: 1 bends about the axis's end.
    bend: Vec2,
    pub(super) along: f32,
    /// Fraction of the braid's hair that has joined.
    pub(super) joined: f32,
}

impl TubeSection {
    #[inline]
    fn between(a: &Self, b: &Self, t: f32) -> Self {
        Self {
            centre: a.centre + (b.centre - a.centre) * t,
            x: a.x + (b.x - a.x) * t,
            y: a.y + (b.y - a.y) * t,
            bend: a.bend + (b.bend - a.bend) * t,
            along: a.along + (b.along - a.along) * t,
            joined: a.joined + (b.joined - a.joined) * t,
        }
    }
}

/// A strand of the braid.
pub(super) struct Tube {
    pub(super) id: u64,
    pub(super) strand: i32,
    at: Vec<TubeSection>,
    /// Front of the braid, unit, and whether the skin is near, at the same steps.
    beside: Vec<(Vec3, bool)>,
    /// Step number at the tie.
    pub(super) tie: f32,
}

impl Tube {
    /// The cross-section at a step number, clamped to the strand.
    #[inline]
    pub(super) fn section(&self, t: f32) -> TubeSection {
        let t = t.clamp(0.0, (self.at.len() - 1) as f32);
        let k = (t as usize).min(self.at.len() - 2);
        TubeSection::between(&self.at[k], &self.at[k + 1], t - k as f32)
    }
    /// Unit direction of the strand at a step number.
    pub(super) fn tangent(&self, t: f32) -> Vec3 {
        let k = (t.max(0.0) as usize).min(self.at.len() - 2);
        (self.at[k + 1].centre - self.at[k].centre).normalize_or(Vec3::Y)
    }
    /// The front of the braid at a step number.
    pub(super) fn front(&self, t: f32) -> Vec3 {
        self.beside[(t.max(0.0) as usize).min(self.beside.len() - 1)].0
    }
    /// Whether hair of the strand may come near the skin at a step number.
    #[inline]
    pub(super) fn near(&self, t: f32) -> bool {
        let k = (t.max(0.0) as usize).min(self.beside.len() - 2);
        self.beside[k].1 || self.beside[k + 1].1
    }
    /// The step number at a fraction along the braid's source.
    pub(super) fn step_at(&self, along: f32) -> f32 {
        let after = self.at.partition_point(|s| s.along <= along);
        let k = after.clamp(1, self.at.len() - 1) - 1;
        let span = self.at[k + 1].along - self.at[k].along;
        let t = if span > 0.0 { (along - self.at[k].along) / span } else { 0.0 };
        k as f32 + t.clamp(0.0, 1.0)
    }
    /// How far one step moves the place `q` of the cross-section, cm.
    #[inline]
    pub(super) fn pace(&self, t: f32, q: Vec2) -> f32 {
        let k = (t.max(0.0) as usize).min(self.at.len() - 2);
        place(&self.at[k + 1], q).distance(place(&self.at[k], q))
    }
    pub(super) fn last(&self) -> f32 {
        (self.at.len() - 1) as f32
    }
}

/// A point where hair is picked up.
#[derive(Clone, Copy)]
pub(super) struct Stitch {
    pub(super) along: f32,
    pub(super) side: i32,
    pub(super) strand: i32,
    pub(super) number: i32,
}

/// A cross-section beyond the tie.
#[derive(Clone, Copy)]
pub(super) struct Bristles {
    pub(super) centre: Vec3,
    /// Unit.
    pub(super) x: Vec3,
    pub(super) y: Vec3,
    /// Its size as a fraction of that at the tie.
    pub(super) size: f32,
}

/// A braid ready to be filled.
pub(super) struct Braid {
    pub(super) id: u64,
    /// Position of the tie along the source.
    pub(super) tied: f32,
    pub(super) tubes: Vec<Tube>,
    pub(super) stitches: Vec<Stitch>,
    /// One per step from the tie on; empty if the braid has no end tuft.
    pub(super) brush: Vec<Bristles>,
    /// Its centre line at the band that ties it; `None` without one.
    pub(super) waist: Option<Waist>,
    /// cm.
    pub(super) step: f32,
    /// Steps of a strand per stitch.
    pub(super) per_stitch: f32,
}

impl Braid {
    /// The braid of these strands (one tuft); `None` if they are not curves.
    pub(super) fn new(
        strands: &Tuft,
        mut stitches: Vec<Stitch>,
        asked: &TubeParams,
    ) -> Option<Self> {
        stitches.sort_by(|a, b| a.along.total_cmp(&b.along).then(a.number.cmp(&b.number)));
        let splines: Vec<Spline> = (0..strands.len())
            .map(|i| Spline::new(strands.curve(i)).ok())
            .collect::<Option<_>>()?;
        let first = splines.first()?;
        // The tie is half a stitch behind the last one.
        let most = stitches.iter().fold(0.0f32, |most, s| most.max(s.along));
        let count = (stitches.len() / 2).max(1) as f32;
        let tie_along =
            if stitches.is_empty() { 1.0 } else { (most * (1.0 + 0.35 / count)).min(1.0) };
        let along = strands.view(attr::ALONG);
        let reached = |i: usize| {
            let range = strands.range(i);
            let cv = range.clone().take_while(|k| along.at(i, *k) <= tie_along).count();
            splines[i].u_of_cv(cv.saturating_sub(1).min(range.len() - 1)) * splines[i].length()
        };
        let braided = reached(0).max(1e-3 * first.length());
        let spacing = if stitches.is_empty() {
            2.0 * first.length() / first.span_count() as f32
        } else {
            braided / (count * asked.per_stitch)
        };
        let step = (spacing / FINE).max(first.length() / MOST);
        let knot = asked.knot.map(|knot| Knot::new(strands, &splines, step, knot));
        let tubes: Vec<Tube> = (0..splines.len())
            .map(|i| {
                let cut = Cut { spline: &splines[i], step, tie: tie_along, knot: knot.as_ref() };
                Self::tube(strands, i, &cut, asked)
            })
            .collect();
        let mut braid = Self {
            id: strands.view(attr::BRAID).at(0, 0),
            tied: strands.view(attr::TIED).at(0, 0),
            tubes,
            stitches,
            brush: vec![],
            waist: None,
            step,
            per_stitch: braided / (count * step),
        };
        if let Some(band) = asked.band.filter(|_| braid.tuft() >= LEAST_TUFT) {
            braid.tie_up(&band, asked.skin);
        }
        braid.brush = braid.bristles();
        Some(braid)
    }

    /// Steps of the end tuft.
    fn tuft(&self) -> f32 {
        self.tubes.iter().map(|t| t.last() - t.tie).fold(f32::MAX, f32::min)
    }

    /// Draws the strands together in a band behind the tie, with decreasing effect on both sides.
    fn tie_up(&mut self, band: &Band, skin: Option<&Skin>) {
        let waist = band.waist(&self.tubes, self.step);
        for tube in &mut self.tubes {
            for k in 0..tube.at.len() {
                let Some((middle, along)) = waist.at_step(k as f32 - tube.tie) else { continue };
                let (s, keeps) = (&mut tube.at[k], band.keeps(&waist, along));
                s.centre = middle + (s.centre - middle) * keeps;
                (s.x, s.y) = (s.x * keeps, s.y * keeps);
                let reach = (s.x.length_squared() + s.y.length_squared()).sqrt() + NEAR;
                tube.beside[k].1 |= skin.is_some_and(|skin| !skin.is_clear(s.centre, reach));
            }
            bend(&mut tube.at, self.step);
        }
        self.waist = Some(waist);
    }

    fn tube(strands: &Tuft, i: usize, cut: &Cut, asked: &TubeParams) -> Tube {
        let Cut { spline, step, tie, knot } = *cut;
        let range = strands.range(i);
        let (radius, normal) = (strands.view(attr::RADIUS), strands.view(attr::NORMAL));
        let along = strands.view(attr::ALONG);
        let joined: AttributeView<f32> =
            strands.view_named(attr::JOINED).unwrap_or(AttributeView::Shared(1.0));
        let steps = (spline.length() / step).floor().max(2.0) as usize;
        let mut at = Vec::with_capacity(steps + 1);
        let mut beside = Vec::with_capacity(steps + 1);
        for k in 0..=steps {
            let s = (k as f32 * step).min(spline.length());
            let place = spline.locate_length(s);
            let (a, b) = (range.start + place.span, range.start + place.span + 1);
            let mix = |view: &AttributeView<f32>| {
                let (a, b) = (view.at(i, a), view.at(i, b));
                a + (b - a) * place.t
            };
            let tangent = spline.tangent(place);
            let up = normal.at(i, a).lerp(normal.at(i, b), place.t);
            let y = across(up, tangent).unwrap_or_else(|| any_normal(tangent));
            let x = tangent.cross(y);
            let along = mix(&along);
            let thick = mix(&radius) * asked.fill.at(i, a, along);
            let (centre, grown) =
                knot.map_or((spline.point(place), 1.0), |knot| knot.moved(k, spline.point(place)));
            let thick = thick * grown;
            let (sin, cos) = sin_cos(asked.twist * s);
            let front = y;
            // Wide in the braid, whatever its own twist: soft strands give way to each other.
            let (x, y) =
                (x * (thick * (1.0 + asked.broad)), y * (thick * (1.0 - 0.3 * asked.broad)));
            let reach = x.length().max(y.length()) + NEAR;
            let near = asked.skin.is_some_and(|skin| !skin.is_clear(centre, reach));
            beside.push((front, near));
            at.push(TubeSection {
                centre,
                x: x * cos + y * sin,
                y: y * cos - x * sin,
                bend: Vec2::ZERO,
                along,
                joined: mix(&joined).clamp(0.0, 1.0),
            });
        }
        bend(&mut at, step);
        let tube = Tube {
            id: strands.id(i),
            strand: strands.view(attr::STRAND).at(i, range.start),
            at,
            beside,
            tie: 0.0,
        };
        let tie = if tie >= 1.0 { tube.last() } else { tube.step_at(tie) };
        Tube { tie, ..tube }
    }

    fn bristles(&self) -> Vec<Bristles> {
        let left = self.tuft();
        if left < LEAST_TUFT {
            return vec![];
        }
        let n = self.tubes.len() as f32;
        let centre =
            |k: f32| self.tubes.iter().map(|t| t.section(t.tie + k).centre).sum::<Vec3>() / n;
        let spread = |k: f32| {
            let c = centre(k);
            self.tubes.iter().map(|t| t.section(t.tie + k).centre.distance(c)).sum::<f32>() / n
        };
        let whole = spread(0.0).max(1e-4);
        let mut y = self.tubes[0].section(self.tubes[0].tie).y;
        (0..=left as usize)
            .map(|k| {
                let k = k as f32;
                let tangent = (centre(k + 1.0) - centre((k - 1.0).max(0.0))).normalize_or(Vec3::Y);
                y = across(y, tangent).unwrap_or_else(|| any_normal(tangent));
                Bristles { centre: centre(k), x: tangent.cross(y), y, size: spread(k) / whole }
            })
            .collect()
    }
    /// How far (cm) the hair of the strands reaches from the braid's centre this many steps beyond the tie, in a unit
    /// direction.
    pub(super) fn reach(&self, middle: Vec3, beyond: f32, out: Vec3) -> f32 {
        let reach = |tube: &Tube| {
            let section = tube.section(tube.tie + beyond);
            let thick = Vec2::new(section.x.dot(out), section.y.dot(out)).length();
            (section.centre - middle).dot(out) + thick
        };
        self.tubes.iter().map(reach).fold(0.0, f32::max)
    }
    /// The bristles this many steps beyond the tie; straight on past their end.
    #[inline]
    pub(super) fn bristle(&self, beyond: f32) -> Bristles {
        let last = self.brush.len() - 1;
        let t = beyond.clamp(0.0, last as f32);
        let k = (t as usize).min(last - 1);
        let (a, b, f) = (&self.brush[k], &self.brush[k + 1], t - k as f32);
        Bristles {
            centre: a.centre.lerp(b.centre, f),
            x: a.x.lerp(b.x, f),
            y: a.y.lerp(b.y, f),
            size: a.size + (b.size - a.size) * f,
        }
    }
    /// Spacing (cm) of the points of a hair that enters at a position: where stitches are short it needs more, and
    /// keeps them, since its points are even.
    pub(super) fn spacing(&self, along: f32) -> f32 {
        let n = self.stitches.len();
        let even = FINE * self.step;
        if n < 2 * OF_STITCHES {
            return even;
        }
        let mean = (self.stitches[n - 1].along - self.stitches[0].along) / (n - 1) as f32;
        let from = self.stitches.partition_point(|s| s.along < along).min(n - OF_STITCHES);
        let here = (self.stitches[from + OF_STITCHES - 1].along - self.stitches[from].along)
            / (OF_STITCHES - 1) as f32;
        // Stitches from a file may be anywhere.
        let share = here / mean.max(1e-9);
        if share.is_finite() { even * share.clamp(FINEST, 1.0) } else { even }
    }
    /// The stitch nearest to a position on a side.
    pub(super) fn stitch(&self, along: f32, side: i32) -> Option<&Stitch> {
        let far = |s: &&Stitch| (s.along - along).abs();
        let on_side = self.stitches.iter().filter(|s| s.side == side || side == 0);
        on_side.min_by(|a, b| far(a).total_cmp(&far(b)).then(a.number.cmp(&b.number)))
    }
    pub(super) fn tube_of(&self, strand: i32) -> Option<usize> {
        self.tubes.iter().position(|tube| tube.strand == strand)
    }
    /// The strand for hair that reaches the root of the braid from `p`: hair from one side goes into the strand of that
    /// side.
    pub(super) fn first_strand(&self, p: Vec3) -> usize {
        let n = self.tubes.len();
        let start = self.tubes.iter().map(|t| t.at[0].centre).sum::<Vec3>() / n as f32;
        let right = self
            .tubes
            .iter()
            .map(|t| t.at[0].x.normalize_or_zero())
            .sum::<Vec3>()
            .normalize_or(Vec3::X);
        let off = (p - start).normalize_or_zero().dot(right).clamp(-1.0, 1.0);
        let part = 0.5 + crate::maths::transcendental::asin(off) / std::f32::consts::PI;
        let rank = ((part * n as f32) as usize).min(n - 1);
        // Strands from left to right where they have left the root.
        let mut order: Vec<usize> = (0..n).collect();
        let x = |i: &usize| {
            let s = &self.tubes[*i].at[0];
            (s.centre - start).dot(right)
        };
        order.sort_by(|a, b| x(a).total_cmp(&x(b)).then(a.cmp(b)));
        order[rank]
    }
}

/// Computes the curvature of a strand at each section, over the spacing of two points of a hair.
fn bend(at: &mut [TubeSection], step: f32) {
    let h = FINE as usize;
    for k in h..at.len().saturating_sub(h) {
        let turn = at[k - h].centre + at[k + h].centre - at[k].centre * 2.0;
        let bent = turn / (h as f32 * step * (h as f32 * step));
        at[k].bend = Vec2::new(bent.dot(at[k].x), bent.dot(at[k].y));
    }
}

/// A place in a cross-section. On the inside of a bend, hair is compressed so that none lies beyond the centre of the
/// bend, where it would run backward.
#[inline]
pub(super) fn place(section: &TubeSection, q: Vec2) -> Vec3 {
    let inward = section.bend.dot(q).max(0.0) * (1.0 / INSIDE);
    let q = q / (1.0 + inward * inward).sqrt();
    section.centre + section.x * q.x + section.y * q.y
}

/// How the strands of a braid are divided into sections.
#[derive(Clone, Copy)]
struct Cut<'a> {
    spline: &'a Spline,
    step: f32,
    /// Position of the tie along the source.
    tie: f32,
    knot: Option<&'a Knot>,
}

/// A root knot: where strands are still gathered, the braid is as wide as behind the knot plus the requested extra
/// width.
struct Knot {
    /// The braid's centre at each step of the knot, and the growth around it.
    at: Vec<(Vec3, f32)>,
}

/// Largest growth of a bundle.
const MOST_GROWN: f32 = 20.0;

impl Knot {
    fn new(strands: &Tuft, splines: &[Spline], step: f32, (size, length): (f32, f32)) -> Self {
        // A knot as long as a short braid covers all of it.
        let length = splines.iter().fold(length, |least, spline| least.min(spline.length()));
        let steps = ((length / step).ceil() as usize).max(1);
        let radius = strands.view(attr::RADIUS);
        // The centre of the strands at this distance along them, and how far the outermost reaches from it.
        let outline = |k: usize| {
            let place =
                |spline: &Spline| spline.locate_length((k as f32 * step).min(spline.length()));
            let centre = |spline: &Spline| spline.point(place(spline));
            let middle = splines.iter().map(centre).sum::<Vec3>() / splines.len() as f32;
            let reach = splines.iter().enumerate().map(|(i, spline)| {
                let thick = radius.at(i, strands.range(i).start + place(spline).span);
                centre(spline).distance(middle) + thick
            });
            (middle, reach.fold(0.0, f32::max))
        };
        // Stitches stand out from the mean width.
        let behind = (steps..=2 * steps).map(|k| outline(k).1).sum::<f32>() / (steps + 1) as f32;
        let wanted = behind * (1.0 + size);
        let at = (0..steps).map(|k| {
            let (middle, reach) = outline(k);
            let grown = (wanted / reach.max(1e-6)).clamp(1.0, MOST_GROWN);
            (middle, 1.0 + (grown - 1.0) * bump(k as f32 * step / length))
        });
        Self { at: at.collect() }
    }

    /// Position of a strand's centre in the knot, and its extra thickness there.
    fn moved(&self, k: usize, p: Vec3) -> (Vec3, f32) {
        let (middle, grown) = self.at.get(k).copied().unwrap_or((p, 1.0));
        (middle + (p - middle) * grown, grown)
    }
}

/// A bulge: 1 at a half, 0 from 1 on and at 0.
fn bump(x: f32) -> f32 {
    if x >= 1.0 {
        0.0
    } else {
        let y = 4.0 * x * (1.0 - x);
        smoothstep(y)
    }
}
