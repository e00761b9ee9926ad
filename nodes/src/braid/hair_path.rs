//! One hair: from its root over the scalp into its strand, through the braid inside the strand's tube, and out into the
//! end tuft.
//!
//! The idea: a hair keeps its place in the strand's cross-section. Joining hair enters at the outside, and earlier hair
//! forms the core: with F(u) the fraction of hair that has joined up to u, a hair that joined at u0 lies at sqrt(F(u0)
//! / F(u)) of the radius. The tube is then evenly full everywhere, whatever joins where, and no hair has to make room
//! for another. A hair joins in the direction of its strand: one that would have to turn back slides on along the
//! strand until it enters forward.
//!
//! Guarantees: a hair begins at its root, has at most [`MOST_A_CURVE`], evenly spaced, and stays inside its strand's
//! tube once it has joined (except for flyaways and the end tuft) and out of the skin. On a parted scalp it crosses no
//! parting before the step that leads into its strand; a hair without such a path is dropped and reported. Not
//! promised: hairs clear of each other.

use super::deviation::{CrossSectionWalk, Flyaway};
use super::even::{Bead, EvenSampler, chords, relax, spline_point};
use super::tube::{Braid, Tube, place};
use crate::data::curves::MOST_A_CURVE;
use crate::data::route::makers::{clear, lift, lift_drawn};
use crate::data::route::section_guard::Home;
use crate::data::scalp::{Scalp, Skin};
use crate::maths::catmull_rom_agreement::Chords;
use crate::maths::hash::Dice;
use crate::maths::smoothstep;
use glam::{Vec2, Vec3};

/// Margin of the point spacing over the minimum that keeps to that limit.
const SPARE: f32 = 1.12;
/// Points closer than this (cm) are set off the skin by the distance field, whose error is smaller.
const CLEAR: f32 = 0.025;
/// Evenly spaced points may be this close (cm) and no closer.
const LEAST: f32 = 0.008;

/// A step this deep (cm) below the skin passes through a thin part of it.
const THROUGH: f32 = 0.08;
/// Rounds of leading a hair over the edges of the skin.
const ROUNDS: usize = 4;

/// Settings of hairs in their braid. Lengths in cm.
pub(super) struct Manner {
    /// Stitches over which a hair moves to its place.
    pub(super) settling: f32,
    pub(super) frizz: f32,
    pub(super) tip_variation: f32,
    pub(super) tip_taper: f32,
    pub(super) tip_frizz: f32,
    pub(super) flyaways: f32,
    pub(super) flyaway_length: f32,
    /// Centimetres per head unit.
    pub(super) unit: f32,
    pub(super) dice: Dice,
}

/// Settings of one hair.
pub(super) struct BraidHairParams {
    pub(super) id: u64,
    pub(super) fed: bool,
    /// Fraction of the braid's hair that joined before it.
    pub(super) order: f32,
    /// Its length, cm; 0: to the end.
    pub(super) length: f32,
}

/// Where a hair enters its braid.
pub(super) struct Entry {
    pub(super) tube: usize,
    /// Step number.
    pub(super) t: f32,
    pub(super) stitch: i32,
    /// Its place in the unit disc.
    pub(super) q: Vec2,
    /// Whether it may slide along its strand. Hair of a free braid gathers where the braid begins.
    pub(super) slides: bool,
}

/// Traces hairs, one after another.
pub(super) struct HairTracer<'a> {
    pub(super) manner: &'a Manner,
    pub(super) skin: Option<&'a Skin<'a>>,
    pub(super) scalp: Option<&'a Scalp>,
    /// The last traced hair.
    pub(super) beads: Vec<Bead>,
    even: EvenSampler,
    /// Its points before the skin moved them.
    raw: Vec<Bead>,
}

impl<'a> HairTracer<'a> {
    pub(super) fn new(
        manner: &'a Manner,
        scalp: Option<&'a Scalp>,
        skin: Option<&'a Skin<'a>>,
    ) -> Self {
        Self { manner, skin, scalp, beads: vec![], raw: vec![], even: EvenSampler::default() }
    }

    /// Traces a hair; returns the front of the braid where it joins, or why there is no path.
    pub(super) fn trace(
        &mut self,
        braid: &Braid,
        way: &[Vec3],
        entry: &Entry,
        wish: &BraidHairParams,
    ) -> Result<Vec3, &'static str> {
        self.beads.clear();
        let tube = &braid.tubes[entry.tube];
        let (t, come) = self.joins(braid, tube, way, entry, wish);
        let section = tube.section(t);
        // The same spacing on the scalp as in the braid, however long the path is.
        let rest = braid.step * (tube.last() - t);
        let whole = if wish.length > 0.0 { rest.min(wish.length) } else { rest };
        let spacing = braid.spacing(section.along).max(SPARE * whole / MOST_A_CURVE as f32);
        let mut reached = (0.0, spacing);
        if !wish.fed {
            let end = place(&section, come * share(wish, section.joined));
            reached = self.comb(way, end, tube.tangent(t), spacing);
            self.beads.iter_mut().for_each(|bead| bead.along = section.along);
        }
        self.braided(braid, tube, (t, come, entry.q), wish, reached);
        self.rest(section.along);
        if !wish.fed {
            if self.crosses(section.along, spacing) {
                self.keep_in_section(way, section.along);
            }
            if self.crosses(section.along, spacing) {
                return Err(
                    "a hair that only a way over a parting leads to its braid was left out",
                );
            }
            if self.is_torn(section.along) {
                return Err(
                    "a hair that only a way through the skin leads to its braid was left out",
                );
            }
        }
        Ok(tube.front(t))
    }

    /// The section that the path of a hair stays in, on a parted scalp.
    fn own_section(&self, way: &[Vec3]) -> Option<Home<'a>> {
        let home = self.scalp.and_then(|scalp| scalp.home(way[0]));
        home.filter(|home| home.holds(way[way.len() - 1]))
    }

    /// Number of points of a hair on its path over the scalp. The step after them leads into its strand, which may be
    /// wider than its section.
    fn on_way(&self, joined: f32) -> usize {
        self.beads.partition_point(|bead| bead.along <= joined).saturating_sub(1)
    }

    /// Whether a hair crosses a parting on its path. A step into its strand much longer than `spacing` belongs to the
    /// path: exported, it is many steps.
    fn crosses(&self, joined: f32, spacing: f32) -> bool {
        let Some(sections) = self.scalp.and_then(Scalp::sections) else { return false };
        let on_way = self.on_way(joined);
        let far = |from: usize, to: usize| self.beads[from].p.distance(self.beads[to].p);
        let long =
            on_way > 0 && on_way < self.beads.len() && far(on_way - 1, on_way) > 1.5 * spacing;
        // As it is drawn, which the next points have a say in.
        let asked = on_way + usize::from(long);
        let drawn: Vec<Vec3> = self.beads.iter().take(asked + 2).map(|bead| bead.p).collect();
        sections.is_over_line_before(&drawn, asked)
    }

    /// Whether a hair on a parted scalp passes through a thin part of the skin. As a last resort, export leads such
    /// hair around it, without regard for partings.
    fn is_torn(&self, joined: f32) -> bool {
        let (Some(_), Some(skin)) = (self.scalp.and_then(Scalp::sections), self.skin) else {
            return false;
        };
        let on_way = &self.beads[..(self.on_way(joined) + 1).min(self.beads.len())];
        on_way.windows(2).any(|w| {
            let middle = (w[0].p + w[1].p) * 0.5;
            w[0].near && lift(skin, middle, -THROUGH).1
        })
    }

    /// Moves back what even spacing and the skin have led over a parting.
    fn keep_in_section(&mut self, way: &[Vec3], joined: f32) {
        let Some(home) = self.own_section(way) else { return };
        let on_way = self.on_way(joined);
        let points = self.beads[..on_way].iter_mut().map(|bead| &mut bead.p);
        home.lead(points.enumerate().skip(1), 0, |_, _, kept| {
            self.skin.map_or(kept, |skin| lift(skin, kept, 0.0).0)
        });
    }

    /// Sets a hair on the skin with even spacing: first out of the skin, then evenly spaced, over an edge step by step;
    /// a hair torn by an ear is led around it. Before `joined` it is on its path.
    fn rest(&mut self, joined: f32) {
        self.settle(joined);
        let Some(skin) = self.skin else { return };
        let Some(last) = self.beads.iter().rposition(|bead| bead.near && !bead.clear) else {
            return;
        };
        let mut points: Vec<Vec3> = self.beads.iter().map(|bead| bead.p).collect();
        lift_drawn(skin, &mut points, 1..last + 1, |_| 0.0);
        self.beads.iter_mut().zip(points).for_each(|(bead, p)| bead.p = p);
    }

    /// [`Self::rest`], as far as the distance field covers.
    fn settle(&mut self, joined: f32) {
        let on_way = |beads: &[Bead]| beads.partition_point(|bead| bead.along <= joined);
        self.raw.clear();
        self.raw.extend_from_slice(&self.beads);
        for round in 0..ROUNDS {
            if round > 0 {
                let way = on_way(&self.beads);
                relax(&mut self.beads[..way]);
            }
            self.lift(CLEAR);
            self.even.out(&mut self.beads);
            if !self.lift(LEAST) || Chords::of(chords(&self.beads)).ratio < 1.2 {
                return;
            }
        }
        let Some(skin) = self.skin else { return };
        let mut way: Vec<Vec3> = self.raw[..on_way(&self.raw)].iter().map(|bead| bead.p).collect();
        let Some(end) = way.last().copied() else { return };
        let led = clear(skin, &mut way, |_| Some(-CLEAR));
        // It joins where it would have joined.
        if led && way[way.len() - 1].distance(end) < 0.1 * self.manner.unit {
            std::mem::swap(&mut self.beads, &mut self.raw);
            self.beads.iter_mut().zip(way).for_each(|(bead, p)| bead.p = p);
            self.lift(CLEAR);
            self.even.out(&mut self.beads);
            self.lift(LEAST);
        }
    }

    /// Lifts points that may be closer to the skin than `height`; returns whether any was lifted.
    fn lift(&mut self, height: f32) -> bool {
        let Some(skin) = self.skin else { return false };
        let mut moved = false;
        for bead in self.beads.iter_mut().skip(1).filter(|bead| bead.near) {
            let (over, clear) = over(skin, bead.p, height);
            moved |= over != bead.p;
            (bead.p, bead.clear) = (over, clear);
        }
        moved
    }

    /// Where a hair enters, as a step number, and its place in the unit disc: from the side that it comes from, and
    /// forward.
    fn joins(
        &self,
        braid: &Braid,
        tube: &Tube,
        way: &[Vec3],
        entry: &Entry,
        wish: &BraidHairParams,
    ) -> (f32, Vec2) {
        /// Positions tried per stitch, and number of stitches.
        const TRIED: (f32, f32) = (8.0, 3.0);
        /// Paths shorter than this slide, cm on a head of average size.
        const TURN: f32 = 3.0;
        /// Cosine of the largest angle between hair and strand.
        const FORWARDS: f32 = 0.7;
        if wish.fed {
            return (entry.t, entry.q * 0.4);
        }
        // From far away there is room to turn.
        let short = way[0].distance(way[way.len() - 1]) < TURN * self.manner.unit;
        let slides = if short && entry.slides { TRIED.0 * TRIED.1 } else { 0.0 };
        let last = (tube.tie - braid.per_stitch).max(entry.t);
        let (mut best, mut found) = (f32::MIN, (entry.t, entry.q));
        let mut first = None;
        let home = self.own_section(way);
        for k in 0..=slides as usize {
            let t = (entry.t + k as f32 * braid.per_stitch / TRIED.0).min(last);
            let section = tube.section(t);
            // If its strand crosses a parting, the hair would have to cross it first.
            if k > 0 && home.is_some_and(|home| !home.holds(section.centre)) {
                break;
            }
            let from = way[way.len() - 1] - section.centre;
            let x = Vec2::new(
                from.dot(section.x.normalize_or_zero()),
                from.dot(section.y.normalize_or_zero()),
            );
            let come = (entry.q * 0.5 + x.normalize_or_zero()).normalize_or(entry.q);
            let end = place(&section, come * share(wish, section.joined));
            let forwards = (end - way[0]).normalize_or_zero().dot(tube.tangent(t));
            if forwards > best + 1e-3 {
                (best, found) = (forwards, (t, come));
            }
            first.get_or_insert(found);
            if best > FORWARDS {
                return found;
            }
            if t >= last {
                break;
            }
        }
        // Behind the end of a row nothing leads forward: around it, in the direction of the path.
        first.unwrap_or(found)
    }

    /// The hair in its strand from step `t` on, entering at `come` and moving to `q`; `reached` is its length so far
    /// and the spacing of its points.
    fn braided(
        &mut self,
        braid: &Braid,
        tube: &Tube,
        (from, come, q): (f32, Vec2, Vec2),
        wish: &BraidHairParams,
        reached: (f32, f32),
    ) {
        /// The last step may be this much longer than planned.
        const LONGER: f32 = 1.1;
        /// Largest relative change of length from one step to the next.
        const SLOWLY: f32 = 0.15;
        let manner = self.manner;
        let beads = &mut self.beads;
        // How far it goes: to its own end, or through the end tuft.
        let brush = braid.brush.len() as f32;
        // Most end early and few reach the end, so that an end tuft of any thickness thins out to nothing.
        let drawn = [3, 30, 31].map(|salt| manner.dice.unit(wish.id, salt));
        let shorter = manner.tip_variation * drawn.into_iter().fold(0.0, f32::max);
        let until = if brush > 0.0 {
            tube.tie + (brush - 1.0) * (1.0 - shorter)
        } else {
            tube.last() - 0.5 * braid.per_stitch * shorter
        };
        let mut until = until.max(from + 2.0);
        if wish.length > 0.0 {
            until = until.min(from + ((wish.length - reached.0) / braid.step).max(2.0));
        }
        let leaves = manner.leaves(braid, wish.id, from, until);
        if let Some((_, end)) = leaves {
            until = end;
        }
        // Even steps of the hair, not of its strand: on the inside of a bend it is shorter. They begin with the spacing
        // of the path over the scalp.
        let room = (MOST_A_CURVE - beads.len().min(MOST_A_CURVE - 3) - 1) as f32;
        let fine = braid.spacing(tube.section(from).along);
        let spacing = fine.max(SPARE * (until - from) * braid.step / room);
        let mut last = reached.1.clamp(0.4 * spacing, 2.0 * spacing);
        let (mut t, mut gone) = (from, if wish.fed { 0.0 } else { reached.0 - reached.1 });
        let settle = manner.settling * braid.per_stitch;
        let mut walk = CrossSectionWalk::new(manner, wish.id, braid.step);
        let mut parted: Option<Flyaway> = None;
        let mut bristle: Option<Vec2> = None;
        while beads.len() < MOST_A_CURVE {
            let section = tube.section(t);
            let mut size = share(wish, section.joined);
            let mut here = come + (q - come) * smoothstep((t - from) / settle);
            if let Some((start, end)) = leaves {
                // Flyaways come from the surface.
                size += (0.97 - size).max(0.0) * smoothstep(1.0 + (t - start) / settle);
                if t >= start && t > from {
                    let parted =
                        *parted.get_or_insert_with(|| Flyaway::new(tube, start, here * size, end));
                    let p = parted.at((t - start) * braid.step, manner, wish.id);
                    beads.push(Bead::new(p, section.along, true));
                    if t >= until {
                        break;
                    }
                    last = (last * (1.0 + SLOWLY)).min(spacing);
                    t += last / braid.step;
                    continue;
                }
            }
            here = (here * size + walk.at(t)).clamp_length_max(1.0);
            let mut p = place(&section, here);
            let mut near = tube.near(t);
            if brush > 0.0 && t > tube.tie {
                let offset = *bristle.get_or_insert_with(|| {
                    let tied = place(&tube.section(tube.tie), here);
                    let b = braid.bristle(0.0);
                    Vec2::new((tied - b.centre).dot(b.x), (tied - b.centre).dot(b.y))
                });
                let beyond = t - tube.tie;
                let far = beyond / brush;
                let b = braid.bristle(beyond);
                let narrow = b.size * (1.0 - manner.tip_taper * far * far);
                let loose = walk.loose() * (manner.tip_frizz * far * beyond * braid.step * 0.25);
                let o = offset * narrow + loose;
                let free = b.centre + b.x * o.x + b.y * o.y;
                p = p.lerp(free, smoothstep(beyond / braid.per_stitch));
                near = true;
            }
            let before = beads.last().map_or(p, |bead| bead.p);
            let far = p.distance(before);
            if wish.length > 0.0 && gone + LONGER * far > wish.length && beads.len() > 2 {
                let part = ((wish.length - gone) / far.max(1e-6)).clamp(0.0, LONGER);
                beads.push(Bead::new(before.lerp(p, part), section.along, near));
                break;
            }
            gone += far;
            beads.push(Bead::new(p, section.along, near));
            if t >= until {
                break;
            }
            // So that it ends with a whole step.
            let rest = wish.length - gone;
            let wanted =
                if rest > 0.0 { rest / (rest / spacing).round().max(1.0) } else { spacing };
            last += (wanted - last).clamp(-SLOWLY * last, SLOWLY * last);
            // The pace half a step ahead.
            let guess = last / braid.step;
            let pace = if t + guess > tube.tie && brush > 0.0 {
                braid.step
            } else {
                tube.pace(t + 0.5 * guess, here)
            };
            t += (last / pace.max(1e-6)).clamp(0.3 * guess, 4.0 * guess);
        }
    }

    /// Beads of the path over the scalp, bent to end at `end` in the direction `along`, without that end; returns its
    /// length and the spacing of its points.
    fn comb(&mut self, way: &[Vec3], end: Vec3, along: Vec3, spacing: f32) -> (f32, f32) {
        const SAMPLES: usize = 16;
        let n = way.len();
        let on_way = |s: f32| {
            let x = s * (n - 1) as f32;
            let k = (x as usize).min(n - 2);
            spline_point(|k| way[k], n, k, x - k as f32)
        };
        let root = way[0];
        let (chord, aside) = (end - root, end - way[n - 1]);
        // The farther the end is from that of the path, the less the path counts.
        let astray = smoothstep(1.6 * aside.length() / chord.length().max(1e-6) - 0.4);
        let combed = |s: f32| {
            let bent = on_way(s) + aside * smoothstep(s);
            bent.lerp(root + chord * s, astray)
        };
        let arriving = (end - combed(0.94)) / 0.06;
        let turn = along * (0.8 * chord.length()) - arriving;
        // Bent to its strand, it still stays in the section of its path.
        let at = |k: usize| k as f32 / SAMPLES as f32;
        let mut fine: [Vec3; SAMPLES + 1] = std::array::from_fn(|k| {
            let s = at(k);
            combed(s) + turn * (s * s * (s - 1.0))
        });
        if let Some(home) = self.own_section(way) {
            home.lead(fine[..SAMPLES].iter_mut().enumerate().skip(1), 0, |_, _, kept| kept);
        }
        let mut lengths = [0.0f32; SAMPLES + 1];
        for k in 0..=SAMPLES {
            let s = at(k);
            if k > 0 {
                if let (Some(skin), true) = (self.skin, k < SAMPLES) {
                    fine[k] = over(skin, fine[k], (6.0 * s).min(1.0) * CLEAR).0;
                }
                lengths[k] = lengths[k - 1] + fine[k].distance(fine[k - 1]);
            }
        }
        let total = lengths[SAMPLES];
        let count = ((total / spacing).round() as usize).clamp(1, 200);
        let near = self.skin.is_some();
        self.beads.push(Bead::new(root, 0.0, near));
        let mut k = 0;
        for i in 1..count {
            let s = total * i as f32 / count as f32;
            while k + 1 < SAMPLES && lengths[k + 1] < s {
                k += 1;
            }
            let t = ((s - lengths[k]) / (lengths[k + 1] - lengths[k]).max(1e-9)).clamp(0.0, 1.0);
            let p = spline_point(|k| fine[k], SAMPLES + 1, k, t);
            self.beads.push(Bead::new(p, 0.0, near));
        }
        (total, total / count as f32)
    }
}

impl Manner {
    /// Where a flyaway leaves its braid and where it ends (step numbers); `None` for most hairs.
    fn leaves(&self, braid: &Braid, id: u64, from: f32, until: f32) -> Option<(f32, f32)> {
        if self.dice.unit(id, 4) >= self.flyaways {
            return None;
        }
        let at = from + (until - from) * (0.08 + 0.9 * self.dice.unit(id, 5));
        let length = self.flyaway_length * self.dice.range(id, 6, 0.25, 1.0);
        Some((at, at + length / braid.step))
    }
}

/// Distance from the centre of the strand where this much has `joined`, as a fraction of the radius.
#[inline]
fn share(wish: &BraidHairParams, joined: f32) -> f32 {
    (wish.order / joined.max(1e-4)).sqrt().min(1.0)
}

/// `p`, or the point above it that is at least `height` above the skin; and whether [`Skin::push_out`] is known to
/// leave it there.
#[inline]
fn over(skin: &Skin, p: Vec3, height: f32) -> (Vec3, bool) {
    match skin.roughly(p) {
        // This deep, the field's direction out is not accurate enough.
        Some((d, _, doubt)) if d < -0.05 || (doubt > 0.05 && d - doubt < height) => {
            (lift(skin, p, height).0, false)
        }
        Some((d, out, _)) if d < height => (p + out.normalize_or_zero() * (height - d), false),
        Some((d, _, doubt)) => (p, d > doubt),
        None => (p, true),
    }
}

#[cfg(test)]
mod tests {
    use super::super::laws::heads;
    use super::*;

    #[test]
    fn what_is_told_to_be_out_of_the_skin_is_left_there() {
        let mut left = 0;
        for head in heads() {
            let skin = &head.skin();
            let dice = Dice::new(7, 0, "points about a head");
            let (low, high) = head.surface().bounds();
            for i in 0..40_000 {
                let x = Vec3::from_array([0, 1, 2].map(|k| dice.range(i, k, -0.05, 1.05)));
                let p = low + (high - low) * x;
                let near = lift(skin, p, 0.0).0 + Vec3::Y * dice.range(i, 3, -0.1, 0.1);
                for height in [CLEAR, LEAST] {
                    let (p, clear) = over(skin, near, height);
                    left += usize::from(clear);
                    assert!(!clear || lift(skin, p, 0.0) == (p, false), "{near} {height}");
                }
            }
            for p in [f32::NAN, f32::INFINITY, -f32::MAX, 1e30].map(Vec3::splat) {
                let (p, clear) = over(skin, p, LEAST);
                let (kept, moved) = lift(skin, p, 0.0);
                assert!(
                    !clear
                        || (!moved
                            && kept.to_array().map(f32::to_bits) == p.to_array().map(f32::to_bits))
                );
            }
        }
        assert!(left > 10_000, "{left}");
    }
}
