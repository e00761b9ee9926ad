//! Braid hair: single hairs from the scalp through a braid to its tip.
//!
//! methods.md 2, "Beyond". Braid territory says where a hair is rooted, the way it is combed and where along the row it
//! joins; here it is led on: into the strand that is outermost at that stitch, through the braid within the strand's tube,
//! to the tie and the brush behind it. The tables of a braid are in `tube.rs`.
//!
//! The idea: a hair keeps its place in its strand's cross-section. Hair that joins comes in at the outside, and what was
//! there before is the core: with F(u) the share of hair that has joined up to u, a hair that joined at u0 lies at
//! sqrt(F(u0) / F(u)) of the radius. So the tube is evenly full everywhere, whatever joins where, and no hair has to make
//! room for another.
//!
//! Guarantees: a hair begins at its root and stays within `fill` times its strand's tube once it has joined (flyaways and
//! the brush apart); points are evenly spaced, at most 255; every hair is led by itself, so more of them change none.
//! Not promised: hairs clear of each other.

use super::braid_territory::ORDER;
use super::tube::{Asked, Braid, FINE, Stitch, place};
use crate::data::attributes::{
    ALONG, Attribute, BRAID, Domain, FED, FIBRE, ID, PARENT, SIDE, STITCH, STRAND, WIDTH,
};
use crate::data::curves::{Curves, Tuft, TuftBuilder, View};
use crate::data::scalp::{Scalp, Skin};
use crate::define::{FieldInput, NodeError, choice, node};
use crate::eval::{EvalCx, Piece};
use crate::maths::hash::{Dice, curve_id};
use crate::maths::transcendental::sin_cos_turns;
use glam::{Vec2, Vec3};
use std::collections::BTreeMap;
use std::sync::{Arc, OnceLock};

node! {
    /// Fill braids with hair that grows: from its root over the scalp to its stitch, into the strand that is outermost
    /// there, through the braid to the tie, and out into the tuft.
    ///
    /// Wire the hairs of the Braid territory, and strands and stitches of the Lissajous braid that is laid along the
    /// territory's rows. Colour and width can be changed downstream; extension hair comes out by itself for a colour of
    /// its own.
    "braid_hair", version 1, label "Hair through braids",
        words "strands plait french dutch cornrow canerow knotless knotted extension tuft tail pick up";
    inputs {
        /// The hairs from their roots to the braid, from the Braid territory.
        roots: Curves, words("territory hairs");
        /// The strands of the braids.
        strands: Curves, words("tubes clusters");
        /// The stitches of the braids.
        stitches: Option<Curves>, words("knots");
        /// The head. Hair is kept out of it.
        scalp: Option<Arc<Scalp>>;
        /// How far hair fills its strand: 1 the tube that just touches its neighbours; more presses strands into one
        /// another, which closes the windows between them. Varies along the strand.
        fill: FieldInput = 1.3, hard(0.1, 3.0), soft(0.7, 1.5), unit(Ratio), words("fullness volume radius thickness");
        /// How much broader than high strands are: soft hair gives way, so that the braid is closed and its stitches are
        /// leaves instead of beads. 0 is round.
        broad: f32 = 0.25, hard(-0.5, 2.0), soft(0.0, 0.8), unit(Ratio), words("flat wide leaf shape");
        /// How much the hair of one stitch is gathered there: 0 joins evenly all along the braid, 1 all at one place.
        bundling: f32 = 0.6, hard(0.0, 1.0), unit(Ratio), words("clump gather stitch grouping");
        /// Over how many stitches a hair works its way from the edge of the strand to its place in it.
        settling: f32 = 0.8, hard(0.05, 10.0), soft(0.2, 3.0), words("blend merge");
        /// Turn of each strand in itself, degrees for each centimetre.
        twist: f32 = 0.0, hard(-3600.0, 3600.0), soft(-180.0, 180.0), unit(Angle), words("rope roll spin");
        /// How much hairs wander within their strand: 0 is combed smooth, 1 crosses all of it.
        frizz: f32 = 0.06, hard(0.0, 1.0), unit(Ratio), words("noise messy definition texture");
        /// How a free braid begins.
        root_start: RootStart = RootStart::Knotless, words("box braid knotless knot base");
        /// How much thicker the braid is in the root knot: 0.5 is half as thick again.
        knot_size: f32 = 0.5, hard(0.0, 5.0), soft(0.0, 1.5), unit(Ratio), words("bulge");
        /// Length of the root knot.
        knot_length: f32 = 0.8, hard(0.01, 20.0), soft(0.2, 2.0), unit(Length);
        /// How much shorter than the longest hairs are in the tuft. It makes a tip that thins out; 0 is cut straight.
        tip_variation: f32 = 0.8, hard(0.0, 1.0), unit(Ratio), words("length random layers taper");
        /// How the tuft narrows to its tip: 0 as wide as the strands say, 1 to a point.
        tip_taper: f32 = 0.8, hard(0.0, 1.0), unit(Ratio), words("point brush");
        /// How much hairs differ in direction in the tuft.
        tip_frizz: f32 = 0.15, hard(0.0, 2.0), soft(0.0, 1.0), unit(Ratio), words("noise messy");
        /// Share of hairs that leave the braid somewhere and stand off.
        flyaways: f32 = 0.01, hard(0.0, 1.0), soft(0.0, 0.1), unit(Ratio), words("stray frizz fuzz halo");
        /// How far the longest flyaways stand off by their length.
        flyaway_length: f32 = 1.2, hard(0.05, 50.0), soft(0.3, 5.0), unit(Length);
        /// Points of a hair for one stitch. A hair has at most 255 in all; a longer one has fewer for each stitch.
        points_per_stitch: f32 = 6.0, hard(3.0, 64.0), soft(5.0, 16.0), unit(Count), words("cvs resolution density");
        /// Diameter of a hair at its root.
        width_root: f32 = 0.0075, hard(0.0001, 1.0), soft(0.002, 0.05), unit(Length), words("thickness diameter");
        /// Diameter of a hair at its tip.
        width_tip: f32 = 0.0075, hard(0.0001, 1.0), soft(0.0005, 0.05), unit(Length), words("thickness diameter taper");
        /// Whether lengths typed here grow with the head; the width of a hair never does.
        scale_with_head: bool = true, words("head units");
        /// Seed tag; stored, mixed into ids and randomness.
        seed: i64 = 0;
    }
    outputs {
        /// The hair that grows, with its braid, strand, stitch and side, and the fraction along the row at each point (0
        /// before it joins).
        curves: Curves;
        /// The extension hair that was fed in.
        extension: Curves;
    }
}

choice! {
    /// How a free braid begins.
    RootStart {
        /// The hair runs straight in, and the braid grows from it.
        Knotless = "knotless",
        /// A knot at the scalp.
        Knotted = "knotted",
    }
}

/// The most points of a hair.
const MOST_POINTS: usize = 255;
/// Nearer than this (cm) points are set off the skin by the distance field, whose error is less.
const CLEAR: f32 = 0.025;

fn eval(cx: &EvalCx, inputs: Inputs) -> Result<Outputs, NodeError> {
    let scalp = inputs.scalp.as_deref();
    let unit = cx.head_unit(scalp, inputs.scale_with_head);
    // Strands and stitches by row; a piece reads those of the rows that its hairs belong to.
    let empty = Curves::default();
    let stitch_curves = inputs.stitches.as_ref().unwrap_or(&empty);
    let mut all = inputs.strands.tufts().to_vec();
    let of_strands = all.len();
    all.extend(stitch_curves.tufts().iter().cloned());
    let all = Curves::new(all);
    let mut by_row: BTreeMap<u64, Vec<u32>> = BTreeMap::new();
    for (n, tuft) in (0..).zip(all.tufts()) {
        for i in 0..tuft.len() {
            let tufts = by_row.entry(row_of(tuft, i)).or_default();
            if tufts.last() != Some(&n) {
                tufts.push(n);
            }
        }
    }
    let braids: Vec<OnceLock<Option<Braid>>> = (0..of_strands).map(|_| OnceLock::new()).collect();
    let filler = Filler {
        inputs: &inputs,
        skin: scalp.map(|scalp| cx.skin(scalp)),
        unit,
        dice: cx.dice(inputs.seed, "braid hair"),
    };
    let fill: Vec<_> = all.tufts()[..of_strands]
        .iter()
        .map(|tuft| inputs.fill.on(tuft, scalp))
        .collect::<Result<_, _>>()?;
    let knot = match inputs.root_start {
        RootStart::Knotted => (inputs.knot_size, inputs.knot_length * unit),
        RootStart::Knotless => (0.0, 1.0),
    };
    let of_row = |row: u64| -> Option<&Braid> {
        let tufts = by_row.get(&row)?;
        let n = *tufts.iter().find(|n| (**n as usize) < of_strands)? as usize;
        let made = braids[n].get_or_init(|| {
            let strands = &all.tufts()[n];
            let stitches = tufts.iter().filter(|n| **n as usize >= of_strands);
            let stitches =
                stitches.flat_map(|n| stitches_of(&all.tufts()[*n as usize], row)).collect();
            let asked = Asked {
                per_stitch: inputs.points_per_stitch,
                fill: &fill[n],
                broad: inputs.broad,
                twist: inputs.twist.to_radians(),
                knot,
            };
            Braid::new(strands, stitches, &asked)
        });
        made.as_ref()
    };
    let needs = |_: usize, tuft: &Tuft| {
        let mut needed: Vec<u32> = vec![];
        for i in 0..tuft.len() {
            needed.extend(by_row.get(&row_of(tuft, i)).into_iter().flatten());
            if matches!(tuft.view(PARENT), View::Shared(_)) {
                break;
            }
        }
        needed.sort_unstable();
        needed.dedup();
        needed
    };
    let [curves, extension] = cx.each_tuft_with(&inputs.roots, &all, needs, |tuft, _, piece| {
        filler.fill(tuft, &of_row, piece)
    })?;
    Ok(Outputs { curves, extension })
}

fn row_of(tuft: &Tuft, i: usize) -> u64 {
    tuft.view(PARENT).at(i, tuft.range(i).start)
}

fn stitches_of(tuft: &Tuft, row: u64) -> Vec<Stitch> {
    let (along, side, strand) = (tuft.view(ALONG), tuft.view(SIDE), tuft.view(STRAND));
    let of_row = (0..tuft.len()).filter(|i| row_of(tuft, *i) == row);
    let stitches = of_row.flat_map(|i| {
        (0..).zip(tuft.range(i)).map(move |(number, p)| Stitch {
            along: along.at(i, p),
            side: side.at(i, p).signum(),
            strand: strand.at(i, p),
            number,
        })
    });
    stitches.collect()
}

struct Filler<'a> {
    inputs: &'a Inputs,
    skin: Option<Skin<'a>>,
    unit: f32,
    dice: Dice,
}

/// Where a hair enters its braid.
struct Entry {
    tube: usize,
    /// Step number.
    t: f32,
    stitch: i32,
    /// Its place in the unit disc.
    q: Vec2,
}

/// Hairs while they are made.
#[derive(Default)]
struct Made {
    hair: TuftBuilder,
    pick: Vec<u32>,
    ids: Vec<u64>,
    parents: Vec<u64>,
    braids: Vec<u64>,
    strands: Vec<i32>,
    stitches: Vec<i32>,
    along: Vec<f32>,
}

impl Filler<'_> {
    fn fill<'b>(
        &self,
        tuft: &Tuft,
        of_row: &(dyn Fn(u64) -> Option<&'b Braid> + Sync),
        piece: &mut Piece,
    ) -> Result<[Tuft; 2], NodeError> {
        let fed = tuft.view(FED);
        let along = tuft.view(ALONG);
        // Hair that nobody counted, such as that of boxes, fills its strand evenly.
        let order: Option<View<f32>> = tuft.view_named(ORDER);
        let fibre = tuft.view(FIBRE);
        let side = tuft.view(SIDE);
        let mut made = [Made::default(), Made::default()];
        let (mut points, mut alongs, mut even) = (vec![], vec![], Even::default());
        for i in 0..tuft.len() {
            piece.tick()?;
            let first = tuft.range(i).start;
            let Some(braid) = of_row(row_of(tuft, i)) else {
                piece.trouble(tuft.id(i), "hair of a row without strands was left out");
                continue;
            };
            let way = tuft.curve(i);
            if way.len() < 2 || way.iter().any(|p| !p.is_finite()) {
                piece.trouble(tuft.id(i), "a hair without a way to its braid was left out");
                continue;
            }
            let id = curve_id(tuft.id(i), self.inputs.seed as u64, 0);
            let is_fed = fed.at(i, first) != 0;
            let entry = self.entry(braid, id, way, along.at(i, first), side.at(i, first), is_fed);
            let wish = Wish {
                id,
                fed: is_fed,
                order: order
                    .map_or_else(|| self.dice.unit(id, 3), |order| order.at(i, first))
                    .clamp(1e-4, 1.0),
                length: fibre.at(i, first),
            };
            self.hair(braid, way, &entry, &wish, &mut points, &mut alongs, &mut even);
            let made = &mut made[usize::from(is_fed)];
            made.hair.push_curve(&points);
            made.along.extend_from_slice(&alongs);
            made.pick.push(i as u32);
            made.ids.push(id);
            made.parents.push(braid.tubes[entry.tube].id);
            made.braids.push(braid.id);
            made.strands.push(braid.tubes[entry.tube].strand);
            made.stitches.push(entry.stitch);
        }
        Ok(made.map(|made| self.described(made, tuft)))
    }

    /// Where a hair enters, from the place along the row where it is combed to.
    fn entry(
        &self,
        braid: &Braid,
        id: u64,
        way: &[Vec3],
        along: f32,
        side: i32,
        fed: bool,
    ) -> Entry {
        let (sin, cos) = sin_cos_turns(self.dice.unit(id, 0));
        let q = Vec2::new(cos, sin);
        let stitch =
            if along > 0.0 { braid.stitch(along, if fed { 0 } else { side }) } else { None };
        let found = stitch.and_then(|stitch| Some((stitch, braid.tube_of(stitch.strand)?)));
        match found {
            Some((stitch, tube)) => {
                let joined = along + (stitch.along - along) * self.inputs.bundling;
                let t = braid.tubes[tube].step_at(joined);
                // On its side of the strand; both sides together fill it.
                let q = if fed { q } else { Vec2::new(q.x.abs() * side as f32, q.y) };
                Entry { tube, t, stitch: stitch.number, q }
            }
            None => {
                let tube = match fed {
                    true => self.dice.below(id, 1, braid.tubes.len() as u32) as usize,
                    false => braid.first_strand(way[0]),
                };
                // A braid without stitches is joined where the row says.
                let t = braid.tubes[tube].step_at(along);
                let t = t + 0.3 * braid.per_stitch * self.dice.unit(id, 2);
                Entry { tube, t, stitch: 0, q }
            }
        }
    }

    fn hair(
        &self,
        braid: &Braid,
        way: &[Vec3],
        entry: &Entry,
        wish: &Wish,
        points: &mut Vec<Vec3>,
        alongs: &mut Vec<f32>,
        even: &mut Even,
    ) {
        points.clear();
        alongs.clear();
        let tube = &braid.tubes[entry.tube];
        let spacing = FINE * braid.step;
        let section = tube.section(entry.t);
        let radius = (wish.order / section.joined.max(1e-4)).sqrt().min(1.0);
        // It comes in on the side that it comes from.
        let come = if wish.fed {
            entry.q * 0.4
        } else {
            let from = way[way.len() - 1] - section.centre;
            let x = Vec2::new(
                from.dot(section.x.normalize_or_zero()),
                from.dot(section.y.normalize_or_zero()),
            );
            (entry.q * 0.5 + x.normalize_or_zero()).normalize_or(entry.q)
        };
        let mut reached = (0.0, spacing);
        if !wish.fed {
            let end = place(&section, come * radius);
            reached = self.comb(way, end, tube.tangent(entry.t), spacing, points);
            alongs.resize(points.len(), 0.0);
        }
        // How far it goes: to its own end, or through the brush.
        let brush = braid.brush.len() as f32;
        let until = if brush > 0.0 {
            let u = self.dice.unit(wish.id, 3);
            tube.tie + (brush - 1.0) * (1.0 - self.inputs.tip_variation * u)
        } else {
            tube.last()
                - 0.5 * braid.per_stitch * self.inputs.tip_variation * self.dice.unit(wish.id, 3)
        };
        let mut until = until.max(entry.t + 2.0);
        if wish.length > 0.0 {
            until = until.min(entry.t + ((wish.length - reached.0) / braid.step).max(2.0));
        }
        let leaves = self.leaves(braid, wish.id, entry.t, until);
        if let Some((_, end)) = leaves {
            until = end;
        }
        // Even steps of the hair, not of its strand: on the inside of a bend it is shorter. They begin with what the way
        // over the scalp had.
        let room = (MOST_POINTS - points.len().min(MOST_POINTS - 3) - 1) as f32;
        let spacing = spacing.max(1.12 * (until - entry.t) * braid.step / room);
        let mut last = reached.1.clamp(0.4 * spacing, 2.0 * spacing);
        let (mut t, mut gone) = (entry.t, if wish.fed { 0.0 } else { reached.0 - reached.1 });
        let settle = self.inputs.settling * braid.per_stitch;
        let mut wander = Wander::new(self, wish.id, braid.step);
        let mut parted: Option<Parted> = None;
        let mut bristle: Option<Vec2> = None;
        while points.len() < MOST_POINTS {
            let section = tube.section(t);
            let mut size = (wish.order / section.joined.max(1e-4)).sqrt().min(1.0);
            let settled = smooth((t - entry.t) / settle);
            let mut q = come + (entry.q - come) * settled;
            if let Some((from, end)) = leaves {
                // What stands off comes from the surface.
                size += (0.97 - size).max(0.0) * smooth(1.0 + (t - from) / settle);
                if t >= from && t > entry.t {
                    let parted =
                        *parted.get_or_insert_with(|| Parted::new(tube, from, q * size, end));
                    let p = parted.at((t - from) * braid.step, self, wish.id);
                    points.push(p);
                    alongs.push(section.along);
                    if t >= until {
                        break;
                    }
                    last = (last * 1.15).min(spacing);
                    t += last / braid.step;
                    continue;
                }
            }
            q = (q * size + wander.at(t)).clamp_length_max(1.0);
            let mut p = place(&section, q);
            if brush > 0.0 && t > tube.tie {
                let offset = *bristle.get_or_insert_with(|| {
                    let tied = place(&tube.section(tube.tie), q);
                    let b = braid.bristle(0.0);
                    Vec2::new((tied - b.centre).dot(b.x), (tied - b.centre).dot(b.y))
                });
                let beyond = t - tube.tie;
                let far = beyond / brush;
                let b = braid.bristle(beyond);
                let narrow = b.size * (1.0 - self.inputs.tip_taper * far * far);
                let loose =
                    wander.loose() * (self.inputs.tip_frizz * far * beyond * braid.step * 0.25);
                let o = offset * narrow + loose;
                let free = b.centre + b.x * o.x + b.y * o.y;
                p = p.lerp(free, smooth(beyond / braid.per_stitch));
            }
            let before = points.last().copied().unwrap_or(p);
            let far = p.distance(before);
            if wish.length > 0.0 && gone + far > wish.length && points.len() > 2 {
                let part = ((wish.length - gone) / far.max(1e-6)).clamp(0.0, 1.0);
                points.push(before.lerp(p, part));
                alongs.push(section.along);
                break;
            }
            gone += far;
            points.push(p);
            alongs.push(section.along);
            if t >= until {
                break;
            }
            last += (spacing - last).clamp(-0.15 * last, 0.15 * last);
            // The pace half a step on.
            let guess = last / braid.step;
            let pace = if t + guess > tube.tie && brush > 0.0 {
                braid.step
            } else {
                tube.pace(t + 0.5 * guess, q)
            };
            t += (last / pace.max(1e-6)).clamp(0.3 * guess, 4.0 * guess);
        }
        evened(points, alongs, even);
        for p in points.iter_mut().skip(1) {
            *p = self.over(*p, CLEAR);
        }
    }

    /// Where a flyaway leaves its braid and where it ends (step numbers); none for most hairs.
    fn leaves(&self, braid: &Braid, id: u64, from: f32, until: f32) -> Option<(f32, f32)> {
        if self.dice.unit(id, 4) >= self.inputs.flyaways {
            return None;
        }
        let at = from + (until - from) * (0.08 + 0.9 * self.dice.unit(id, 5));
        let length = self.inputs.flyaway_length * self.unit * self.dice.range(id, 6, 0.25, 1.0);
        Some((at, at + length / braid.step))
    }

    /// Points of the way over the scalp, its end bent to `end` and the direction `along` there, without that end; gives
    /// its length and the spacing of its points.
    fn comb(
        &self,
        way: &[Vec3],
        end: Vec3,
        along: Vec3,
        spacing: f32,
        points: &mut Vec<Vec3>,
    ) -> (f32, f32) {
        const SAMPLES: usize = 16;
        let n = way.len();
        let on_way = |s: f32| {
            let x = s * (n - 1) as f32;
            let k = (x as usize).min(n - 2);
            spline_point(way, k, x - k as f32)
        };
        let last = way[n - 1];
        let aside = end - last;
        let chord = end.distance(way[0]);
        let arriving = (last - on_way(0.94)) / 0.06;
        let turn = along * (0.8 * chord) - arriving;
        // Bent to its strand it still keeps to the section that its way keeps to.
        let home = self.inputs.scalp.as_deref().and_then(|scalp| scalp.home(way[0]));
        let home = home.filter(|home| home.holds(last));
        let mut near = 0;
        let mut fine = [Vec3::ZERO; SAMPLES + 1];
        let mut lengths = [0.0f32; SAMPLES + 1];
        for k in 0..=SAMPLES {
            let s = k as f32 / SAMPLES as f32;
            let (s2, s3) = (s * s, s * s * s);
            fine[k] = on_way(s) + aside * (3.0 * s2 - 2.0 * s3) + turn * (s3 - s2);
            if k > 0 {
                if k < SAMPLES {
                    let kept = home.and_then(|home| home.kept(fine[k], &mut near));
                    fine[k] = kept.unwrap_or(fine[k]);
                    fine[k] = self.over(fine[k], (6.0 * s).min(1.0) * CLEAR);
                }
                lengths[k] = lengths[k - 1] + fine[k].distance(fine[k - 1]);
            }
        }
        let total = lengths[SAMPLES];
        let count = ((total / spacing).round() as usize).clamp(1, 200);
        points.push(way[0]);
        let mut k = 0;
        for i in 1..count {
            let s = total * i as f32 / count as f32;
            while k + 1 < SAMPLES && lengths[k + 1] < s {
                k += 1;
            }
            let t = ((s - lengths[k]) / (lengths[k + 1] - lengths[k]).max(1e-9)).clamp(0.0, 1.0);
            points.push(spline_point(&fine, k, t));
        }
        (total, total / count as f32)
    }

    /// `p` or the point above it that is at least `height` over the skin.
    #[inline]
    fn over(&self, p: Vec3, height: f32) -> Vec3 {
        let Some(skin) = &self.skin else { return p };
        match skin.roughly(p) {
            // So deep, the field's way out is not good enough.
            Some((d, _, doubt)) if d < -0.05 || (doubt > 0.05 && d - doubt < height) => {
                skin.lift(p, height).0
            }
            Some((d, out, _)) if d < height => p + out.normalize_or_zero() * (height - d),
            _ => p,
        }
    }
    fn described(&self, made: Made, tuft: &Tuft) -> Tuft {
        let mut hair = made.hair;
        if hair.is_empty() {
            return hair.build();
        }
        let own = [FIBRE.name, ALONG.name, ORDER];
        for attribute in tuft.attributes() {
            if attribute.domain == Domain::Curve && !own.contains(&attribute.name.as_ref()) {
                let values = attribute.values.gather(&made.pick);
                hair.set_column(Attribute { values, ..attribute.clone() });
            }
        }
        hair.set(ID, Domain::Curve, made.ids);
        hair.set(PARENT, Domain::Curve, made.parents);
        hair.set(BRAID, Domain::Curve, made.braids);
        hair.set(STRAND, Domain::Curve, made.strands);
        hair.set(STITCH, Domain::Curve, made.stitches);
        hair.set(ALONG, Domain::Point, made.along);
        let (root, tip) = (self.inputs.width_root, self.inputs.width_tip);
        if root == tip {
            hair.set(WIDTH, Domain::Curve, vec![root]);
            return hair.build();
        }
        let hair = hair.build();
        let mut width = Vec::with_capacity(hair.points().len());
        for i in 0..hair.len() {
            let n = hair.range(i).len();
            width.extend((0..n).map(|k| root + (tip - root) * k as f32 / (n - 1).max(1) as f32));
        }
        let mut hair = hair.edit();
        hair.set(WIDTH, Domain::Point, width);
        hair.build()
    }
}

/// What a hair asks for.
struct Wish {
    id: u64,
    fed: bool,
    /// Share of the braid's hair that joined before it.
    order: f32,
    /// Its length, cm; 0: to the end.
    length: f32,
}

/// A hair that has left its braid.
#[derive(Clone, Copy)]
struct Parted {
    from: Vec3,
    along: Vec3,
    out: Vec3,
    length: f32,
}

impl Parted {
    fn new(tube: &super::tube::Tube, from: f32, q: Vec2, end: f32) -> Self {
        let section = tube.section(from);
        let out = (section.x * q.x + section.y * q.y).normalize_or(section.y.normalize_or(Vec3::Y));
        let p = place(&section, q);
        let before = place(&tube.section(from - 1.0), q);
        let scale = p.distance(before).max(1e-4);
        Self { from: p, along: (p - before) / scale, out, length: (end - from).max(1.0) * scale }
    }
    fn at(&self, s: f32, filler: &Filler, id: u64) -> Vec3 {
        let x = (s / self.length.max(1e-4)).min(1.0);
        let lift = filler.dice.range(id, 7, 0.15, 0.7);
        let bend = 0.6 * filler.dice.signed(id, 8);
        let aside = self.along.cross(self.out);
        self.from + self.along * (s * (1.0 - 0.2 * x)) + (self.out * lift + aside * bend) * (s * x)
    }
}

/// A hair's own slow wandering in the cross-section.
struct Wander {
    dice: Dice,
    id: u64,
    amount: f32,
    per_step: f32,
    knot: u64,
    from: Vec2,
    to: Vec2,
    loose: Vec2,
}

/// cm between two turns of the wandering.
const WANDER: f32 = 0.9;

impl Wander {
    fn new(filler: &Filler, id: u64, step: f32) -> Self {
        let at = |index: u64| {
            Vec2::new(filler.dice.signed(id, index), filler.dice.signed(id, index + 1))
        };
        Self {
            dice: filler.dice,
            id,
            amount: filler.inputs.frizz,
            per_step: step / (WANDER * filler.unit),
            knot: u64::MAX,
            from: Vec2::ZERO,
            to: Vec2::ZERO,
            loose: at(10),
        }
    }
    #[inline]
    fn at(&mut self, t: f32) -> Vec2 {
        if self.amount <= 0.0 {
            return Vec2::ZERO;
        }
        let x = t * self.per_step;
        let knot = x as u64;
        if knot != self.knot {
            let at = |k: u64| {
                let bits = self.dice.bits(self.id, 100 + k);
                let unit =
                    |bits: u64| (bits & 0xFF_FFFF) as f32 * (2.0 / (1u32 << 24) as f32) - 1.0;
                Vec2::new(unit(bits), unit(bits >> 32)) * self.amount
            };
            self.from = if self.knot.wrapping_add(1) == knot { self.to } else { at(knot) };
            self.to = at(knot + 1);
            self.knot = knot;
        }
        self.from + (self.to - self.from) * smooth(x - knot as f32)
    }
    /// A direction that it keeps.
    fn loose(&self) -> Vec2 {
        self.loose
    }
}

/// Buffers of [`evened`].
#[derive(Default)]
struct Even {
    points: Vec<Vec3>,
    alongs: Vec<f32>,
    lengths: Vec<f32>,
}

/// Moves the points of a hair along it until they are evenly spaced; they nearly are.
fn evened(points: &mut Vec<Vec3>, alongs: &mut Vec<f32>, even: &mut Even) {
    let n = points.len();
    even.lengths.clear();
    even.points.clear();
    even.alongs.clear();
    let mut total = 0.0f32;
    even.lengths.push(0.0);
    for w in points.windows(2) {
        total += w[0].distance(w[1]);
        even.lengths.push(total);
    }
    let mut k = 0;
    for i in 0..n {
        let s = total * i as f32 / (n - 1) as f32;
        while k + 2 < n && even.lengths[k + 1] < s {
            k += 1;
        }
        let t = (s - even.lengths[k]) / (even.lengths[k + 1] - even.lengths[k]).max(1e-9);
        let t = t.clamp(0.0, 1.0);
        even.points.push(spline_point(points, k, t));
        // 0 until it has joined.
        let join = alongs[k] <= 0.0 && t < 1.0;
        even.alongs.push(if join { 0.0 } else { alongs[k] + (alongs[k + 1] - alongs[k]) * t });
    }
    even.points[0] = points[0];
    even.points[n - 1] = points[n - 1];
    std::mem::swap(points, &mut even.points);
    std::mem::swap(alongs, &mut even.alongs);
}

#[inline]
fn smooth(t: f32) -> f32 {
    let t = t.clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

/// Catmull-Rom through even points, its ends extrapolated.
#[inline]
fn spline_point(points: &[Vec3], k: usize, t: f32) -> Vec3 {
    let (b, c) = (points[k], points[k + 1]);
    let a = if k > 0 { points[k - 1] } else { b * 2.0 - c };
    let d = if k + 2 < points.len() { points[k + 2] } else { c * 2.0 - b };
    let (t2, t3) = (t * t, t * t * t);
    a * (t2 - 0.5 * (t3 + t))
        + b * (1.5 * t3 - 2.5 * t2 + 1.0)
        + c * (0.5 * t - 1.5 * t3 + 2.0 * t2)
        + d * (0.5 * (t3 - t2))
}
