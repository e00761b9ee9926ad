//! Hair through braids: single hairs from the scalp through a braid to its tip.
//!
//! methods.md 2, "Beyond". Braid territory determines where a hair is rooted, how it is combed and where along the row
//! it joins. From there this node continues it: into the outermost strand at that stitch, through the braid inside the
//! strand's tube, to the tie and the end tuft. The tables of a braid are in `tube.rs`.
//!
//! The path of a hair is in `hair_path.rs`, its random deviation in `deviation.rs`.
//!
//! Guarantees: every hair is independent, so that more hairs change none; each stores its braid, strand and stitch,
//! where it joins, and the direction of the braid's front there. Not promised: hairs clear of each other.

use super::band::Band;
use super::braid_territory::ORDER;
use super::hair_path::{BraidHairParams, Entry, HairTracer, Manner};
use super::tube::{Braid, Stitch, TubeParams};
use crate::data::attribute_transfer::{CvPlace, Lineage, carry, evenly, own_parents};
use crate::data::attributes::{
    ALONG, BRAID, BRAID_FRONT, Domain, FED, FIBRE, ID, NORMAL, PARENT, RADIUS, SIDE, STITCH,
    STRAND, TIED, WIDTH, is_look,
};
use crate::data::curves::MOST_A_CURVE;
use crate::data::curves::{AttributeView, Curves, Tuft, TuftBuilder};
use crate::data::scalp::Skin;
use crate::define::{FieldInput, NodeError, choice, node};
use crate::eval::{EvalCx, Piece, Size, TracedScalp};
use crate::maths::hash::{KeyBuilder, curve_id};
use crate::maths::transcendental::sin_cos_turns;
use glam::{Vec2, Vec3};
use std::collections::BTreeMap;
use std::ops::Range;
use std::sync::OnceLock;

node! {
    /// Fills braids with hair that grows: from its root over the scalp to its stitch, into the outermost braid strand
    /// there, through the braid to the tie, and out into the end tuft.
    ///
    /// Wire the hairs of Territory of braids, and the strands and stitches of the Lissajous braid that runs along the
    /// same rows. Set colour and width downstream. Extension hair has its own output, so it can have its own colour.
    "braid_hair", version 1, label "Hair through braids",
        words "strands plait french dutch cornrow canerow knotless knotted extension tuft tail pick up", scales;
    inputs {
        /// Hairs from their roots to the braid, from Territory of braids.
        roots: Curves, words("territory hairs");
        /// Strands of the braids.
        strands: Curves, words("tubes clusters");
        /// Stitches of the braids.
        stitches: Option<Curves>, words("knots");
        /// The head. Hair stays out of it.
        scalp: Option<TracedScalp>;
        /// How much of its strand the hair fills: 1 is the tube that just touches its neighbours; more presses strands
        /// together and closes the gaps between them. Varies along the strand.
        fill: FieldInput = 1.3, hard(0.1, 3.0), soft(0.7, 1.5), unit(Ratio), words("fullness volume radius thickness");
        /// Extra width of a strand over its height: soft hair flattens, which closes the braid and turns its stitches
        /// from beads into leaves. 0 is round.
        broad: f32 = 0.25, hard(-0.5, 2.0), soft(0.0, 0.8), unit(Ratio), words("flat wide leaf shape");
        /// How much the hair of one stitch gathers there: 0 joins evenly along the braid, 1 all at one point.
        bundling: f32 = 0.6, hard(0.0, 1.0), unit(Ratio), words("clump gather stitch grouping");
        /// Number of stitches over which a hair moves from the edge of its strand to its place inside.
        settling: f32 = 0.8, hard(0.05, 10.0), soft(0.2, 3.0), words("blend merge");
        /// Twist of each strand about itself, in degrees per cm.
        twist: f32 = 0.0, hard(-3600.0, 3600.0), soft(-180.0, 180.0), unit(Angle), words("rope roll spin");

        [RootAndTip]
        /// How a free braid begins.
        root_start: RootStart = RootStart::Knotless, words("box braid knotless knot base");
        /// Extra width of the root knot over the braid behind it: 0.5 is half as wide again.
        knot_size: f32 = 0.5, hard(0.0, 5.0), soft(0.0, 1.5), unit(Ratio), words("bulge");
        /// Length of the root knot.
        knot_length: f32 = 0.8, hard(0.01, 20.0), soft(0.2, 2.0), unit(Length);
        /// Random shortening of hairs in the end tuft, which makes the tip thin out; 0 cuts it straight.
        tip_variation: f32 = 0.8, hard(0.0, 1.0), unit(Ratio), words("length random layers taper");
        /// Taper of the end tuft: 0 keeps the width of the strands, 1 ends in a point.
        tip_taper: f32 = 0.8, hard(0.0, 1.0), unit(Ratio), words("point brush");
        /// Random variation in direction within the end tuft.
        tip_frizz: f32 = 0.15, hard(0.0, 2.0), soft(0.0, 1.0), unit(Ratio), words("noise messy");

        [Tie]
        /// Turns of the visible band around each tie that has an end tuft. Less than one counts as one; 0 ties the
        /// braid invisibly.
        band_turns: f32 = 0.0, hard(0.0, 20.0), soft(0.0, 6.0), words("elastic tie wrap bobble bead");
        /// Length of braid that the band covers.
        band_height: f32 = 0.7, hard(0.01, 10.0), soft(0.2, 2.0), unit(Length), words("elastic tie wrap bobble bead"),
            idle(|of| matches!(of("band_turns"), Some(Value::Float(0.0))).then_some("there is no band"));
        /// How much the band narrows the braid: 0 not at all, 0.5 to half its width.
        band_tightness: f32 = 0.3, hard(0.0, 0.9), unit(Ratio), words("elastic tie squeeze pinch"),
            idle(|of| matches!(of("band_turns"), Some(Value::Float(0.0))).then_some("there is no band"));

        [Thickness]
        /// Diameter of a hair at its root.
        width_root: f32 = 0.0075, hard(0.0001, 1.0), soft(0.002, 0.05), unit(Length), fixed(), words("thickness diameter");
        /// Diameter of a hair at its tip.
        width_tip: f32 = 0.0075, hard(0.0001, 1.0), soft(0.0005, 0.05), unit(Length), fixed(), words("thickness diameter taper");

        [Detail]
        /// CVs of a hair per stitch. A hair has at most 255 CVs in all; longer hairs get fewer per stitch.
        points_per_stitch: f32 = 6.0, hard(3.0, 64.0), soft(5.0, 16.0), unit(Count), words("cvs resolution density");
        /// Scale lengths with the size of the head. The width of a hair never scales.
        scale_with_head: bool = true, words("head units");

        [Randomness]
        /// Random deviation of hairs within their strand: 0 is combed smooth, 1 crosses the whole strand.
        frizz: f32 = 0.06, hard(0.0, 1.0), unit(Ratio), words("noise messy definition texture");
        /// Fraction of hairs that leave the braid and stand off.
        flyaways: f32 = 0.01, hard(0.0, 1.0), soft(0.0, 0.1), unit(Ratio), words("stray frizz fuzz halo");
        /// How far the longest flyaways stand off, as the length of hair that leaves the braid.
        flyaway_length: f32 = 1.2, hard(0.05, 50.0), soft(0.3, 5.0), unit(Length);
        /// Random seed for this node. It changes ids too.
        seed: i64 = 0;
    }
    outputs {
        /// The growing hair, with its braid, strand, stitch and side, the front of the braid where it joins, and the
        /// fraction along the row at each point (before it joins, that of the joining point).
        curves: Curves;
        /// The extension hair fed into the braids.
        extension: Curves;
        /// Bands that tie the braids. Fill them with Cluster to strands, but do not wire its scalp, which would root
        /// them there.
        bands: Curves;
    }
}

choice! {
    /// How a free braid begins.
    RootStart {
        /// Hair runs straight in, and the braid grows from it.
        Knotless = "knotless",
        /// A knot at the scalp.
        Knotted = "knotted",
    }
}

fn eval(cx: &EvalCx, inputs: Inputs) -> Result<Outputs, NodeError> {
    let head = inputs.scalp.as_ref().map(TracedScalp::head);
    // Strands and stitches by row; a work item reads those of the rows that its hairs belong to.
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
    cx.may_make_most((inputs.roots.curve_count() * MOST_A_CURVE) as f64, || {
        Ok(foreseen(&inputs, stitch_curves))
    })?;
    let braids: Vec<OnceLock<Option<Braid>>> = (0..of_strands).map(|_| OnceLock::new()).collect();
    let skin = head.map(|head| cx.skin(head));
    let (skin, for_hair) = (skin.as_ref(), skin.and_then(Skin::for_hair));
    let manner = Manner {
        settling: inputs.settling,
        frizz: inputs.frizz,
        tip_variation: inputs.tip_variation,
        tip_taper: inputs.tip_taper,
        tip_frizz: inputs.tip_frizz,
        flyaways: inputs.flyaways,
        flyaway_length: inputs.flyaway_length,
        unit: cx.unit(),
        dice: cx.dice(inputs.seed, "braid hair"),
    };
    let fill: Vec<_> = all.tufts()[..of_strands]
        .iter()
        .map(|tuft| inputs.fill.on_traced(tuft, inputs.scalp.as_ref()))
        .collect::<Result<_, _>>()?;
    let knot = match inputs.root_start {
        RootStart::Knotted => Some((inputs.knot_size, inputs.knot_length)),
        RootStart::Knotless => None,
    };
    let (turns, height) = (inputs.band_turns, inputs.band_height);
    let band = Band::new(turns, height, inputs.band_tightness);
    let strands_of = |row: u64| -> Option<usize> {
        let tufts = by_row.get(&row)?;
        tufts.iter().map(|n| *n as usize).find(|n| *n < of_strands)
    };
    let of_row = |row: u64| -> Option<(&Braid, &Tuft)> {
        let n = strands_of(row)?;
        let tufts = &by_row[&row];
        let made = braids[n].get_or_init(|| {
            let strands = &all.tufts()[n];
            let stitches = tufts.iter().filter(|n| **n as usize >= of_strands);
            let stitches =
                stitches.flat_map(|n| stitches_of(&all.tufts()[*n as usize], row)).collect();
            let asked = TubeParams {
                per_stitch: inputs.points_per_stitch,
                fill: &fill[n],
                broad: inputs.broad,
                twist: inputs.twist.to_radians(),
                knot,
                band,
                skin,
            };
            Braid::new(strands, stitches, &asked)
        });
        Some((made.as_ref()?, &*all.tufts()[n]))
    };
    let needs = |_: usize, tuft: &Tuft| {
        let mut needed: Vec<u32> = vec![];
        for i in 0..tuft.len() {
            needed.extend(by_row.get(&row_of(tuft, i)).into_iter().flatten());
            if matches!(tuft.view(PARENT), AttributeView::Shared(_)) {
                break;
            }
        }
        needed.sort_unstable();
        needed.dedup();
        needed
    };
    let placed = cx.by_place(inputs.scalp.as_ref());
    let [curves, extension] =
        placed.each_tuft_with(&inputs.roots, &all, needs, |tuft, _, piece| {
            let filler = Filler {
                inputs: &inputs,
                tracer: HairTracer::new(&manner, piece.scalp(), for_hair.as_ref()),
            };
            filler.fill(tuft, &of_row, piece)
        })?;
    let of_band = |n: usize| {
        let key = KeyBuilder::new("band").key(all.tufts()[n].key());
        let needed = needs(n, &all.tufts()[n]);
        needed.iter().fold(key, |key, n| key.key(all.tufts()[*n as usize].key())).finish()
    };
    let tied = if band.is_some() { of_strands } else { 0 };
    let [bands] =
        placed.each_item(tied, &Size::of(&[("bands", tied as f64)]), of_band, |n, piece| {
            let (tuft, mut out) = (&all.tufts()[n], TuftBuilder::new());
            // A braid stored in several tufts is tied once.
            let row = if tuft.is_empty() { None } else { Some(row_of(tuft, 0)) };
            let row = row.filter(|row| strands_of(*row) == Some(n));
            let (Some(band), Some((braid, _))) = (band, row.and_then(&of_row)) else {
                return Ok([out.build()]);
            };
            match &braid.waist {
                None => {
                    piece.trouble(braid.id, "a braid without a tuft behind its tie has no band")
                }
                Some(waist) if waist.limited => piece.trouble(
                    braid.id,
                    "a band is lower than band_height: the braid or its tuft is too short for it",
                ),
                Some(_) => {}
            }
            if let Some((points, radius, front)) = band.round(braid, skin) {
                out.push_curve(&points);
                out.set(ID, Domain::Curve, vec![curve_id(braid.id, inputs.seed as u64, BANDS)]);
                out.set(PARENT, Domain::Curve, vec![braid.id]);
                out.set(RADIUS, Domain::Curve, vec![radius]);
                out.set(NORMAL, Domain::Curve, vec![front]);
            }
            Ok([out.build()])
        })?;
    Ok(Outputs { curves, extension, bands })
}

/// Lower bound for the points of all hairs between entry and tie. Hairs that leave the braid before, and hairs with a
/// given length, may have fewer.
fn foreseen(inputs: &Inputs, stitches: &Curves) -> Size {
    /// Stitches over which a hair may slide before it joins, plus the one that it ends in.
    const SHORTER: f32 = 4.0;
    /// Points may be this much farther apart than requested: on the inside of bends, and to end with a whole step.
    const FARTHER: f32 = 1.5;
    // Number of stitches of a row, and the position of the last one along it.
    let mut rows: BTreeMap<u64, (usize, f32)> = BTreeMap::new();
    for (tuft, i) in stitches.each() {
        let row = rows.entry(row_of(tuft, i)).or_default();
        row.0 += tuft.range(i).len();
        row.1 = tuft.range(i).map(|p| tuft.view(ALONG).at(i, p)).fold(row.1, f32::max);
    }
    let most = MOST_A_CURVE as f32 / FARTHER;
    let mut points = 0.0f64;
    for tuft in inputs.roots.tufts() {
        let (along, fibre) = (tuft.view(ALONG), tuft.view(FIBRE));
        for i in 0..tuft.len() {
            let first = tuft.range(i).start;
            let row = rows.get(&row_of(tuft, i)).filter(|(_, last)| *last > 0.0);
            let (Some((count, last)), false) = (row, fibre.at(i, first) > 0.0) else { continue };
            // One stitch on each side.
            let left = (1.0 - along.at(i, first) / last) * *count as f32 * 0.5 - SHORTER;
            let wanted = left * inputs.points_per_stitch / FARTHER;
            points += f64::from(wanted.clamp(0.0, most));
        }
    }
    let stay = f64::from((1.0 - 2.0 * inputs.flyaways).max(0.0));
    Size::of(&[("points of all hairs in their braids, at least", points * stay)])
}

/// Index from which a band's id is made from its braid.
const BANDS: u64 = 1 << 41;

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
    tracer: HairTracer<'a>,
}

/// Hairs under construction.
#[derive(Default)]
struct Made<'b> {
    hair: TuftBuilder,
    /// The strand that each runs in.
    runs_in: Vec<(&'b Tuft, usize)>,
    pick: Vec<u32>,
    ids: Vec<u64>,
    parents: Vec<u64>,
    braids: Vec<u64>,
    tied: Vec<f32>,
    strands: Vec<i32>,
    stitches: Vec<i32>,
    fronts: Vec<Vec3>,
    along: Vec<f32>,
}

impl Filler<'_> {
    fn fill<'b>(
        mut self,
        tuft: &Tuft,
        of_row: &(dyn Fn(u64) -> Option<(&'b Braid, &'b Tuft)> + Sync),
        piece: &mut Piece,
    ) -> Result<[Tuft; 2], NodeError> {
        let fed = tuft.view(FED);
        let along = tuft.view(ALONG);
        // Hair without a count, such as that of boxes, fills its strand evenly.
        let order: Option<AttributeView<f32>> = tuft.view_named(ORDER);
        let fibre = tuft.view(FIBRE);
        let side = tuft.view(SIDE);
        let mut made = [Made::default(), Made::default()];
        let dice = self.tracer.manner.dice;
        let mut points = vec![];
        for i in 0..tuft.len() {
            piece.tick()?;
            let first = tuft.range(i).start;
            let Some((braid, strands)) = of_row(row_of(tuft, i)) else {
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
            let wish = BraidHairParams {
                id,
                fed: is_fed,
                order: order
                    .map_or_else(|| dice.unit(id, 3), |order| order.at(i, first))
                    .clamp(1e-4, 1.0),
                length: fibre.at(i, first),
            };
            let front = match self.tracer.trace(braid, way, &entry, &wish) {
                Ok(front) => front,
                Err(why) => {
                    piece.trouble(tuft.id(i), why);
                    continue;
                }
            };
            let made = &mut made[usize::from(is_fed)];
            points.clear();
            points.extend(self.tracer.beads.iter().map(|bead| bead.p));
            made.hair.push_curve(&points);
            made.along.extend(self.tracer.beads.iter().map(|bead| bead.along));
            made.runs_in.push((strands, entry.tube));
            made.fronts.push(front);
            made.pick.push(i as u32);
            made.ids.push(id);
            made.parents.push(braid.tubes[entry.tube].id);
            made.braids.push(braid.id);
            made.tied.push(braid.tied);
            made.strands.push(braid.tubes[entry.tube].strand);
            made.stitches.push(entry.stitch);
        }
        Ok(made.map(|made| self.described(made, tuft)))
    }

    /// Entry point of a hair, from the position along the row that it is combed to.
    fn entry(
        &self,
        braid: &Braid,
        id: u64,
        way: &[Vec3],
        along: f32,
        side: i32,
        fed: bool,
    ) -> Entry {
        let dice = self.tracer.manner.dice;
        let (sin, cos) = sin_cos_turns(dice.unit(id, 0));
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
                Entry { tube, t, stitch: stitch.number, q, slides: true }
            }
            None => {
                let tube = match fed {
                    true => dice.below(id, 1, braid.tubes.len() as u32) as usize,
                    false => braid.first_strand(way[0]),
                };
                // A braid without stitches is joined where the row says.
                let t = braid.tubes[tube].step_at(along);
                let t = t + 0.3 * braid.per_stitch * dice.unit(id, 2);
                Entry { tube, t, stitch: 0, q, slides: along > 0.0 }
            }
        }
    }

    fn described(&self, made: Made, tuft: &Tuft) -> Tuft {
        let mut hair = made.hair;
        if hair.is_empty() {
            return hair.build();
        }
        let ranges: Vec<Range<usize>> = (0..hair.len()).map(|i| hair.range(i)).collect();
        let mut places: Vec<CvPlace> = vec![];
        if tuft.differs_by_point() {
            for (i, range) in made.pick.iter().zip(&ranges) {
                places.extend(on_way(tuft, *i as usize, &made.along[range.clone()]));
            }
        }
        // It goes on as it came; when it was to join and how long to be is done.
        carry(tuft, &made.pick, &places, &mut hair);
        [FIBRE.name, ORDER].iter().for_each(|name| hair.remove(name));
        hair.set(ID, Domain::Curve, made.ids);
        hair.set(PARENT, Domain::Curve, made.parents);
        hair.set(BRAID, Domain::Curve, made.braids);
        hair.set(TIED, Domain::Curve, made.tied);
        hair.set(STRAND, Domain::Curve, made.strands);
        hair.set(STITCH, Domain::Curve, made.stitches);
        hair.set(BRAID_FRONT, Domain::Curve, made.fronts);
        let (root, tip) = (self.inputs.width_root, self.inputs.width_tip);
        if root == tip {
            hair.set(WIDTH, Domain::Curve, vec![root]);
        } else {
            let width = |n: usize, k: usize| root + (tip - root) * k as f32 / (n - 1).max(1) as f32;
            let each = ranges.iter().map(ExactSizeIterator::len);
            let all = each.flat_map(|n| (0..n).map(move |k| width(n, k)));
            hair.set(WIDTH, Domain::Point, all.collect());
        }
        let own = own_parents(hair.len());
        let lineage = Lineage {
            parent: &|i| made.runs_in[i as usize],
            of: &|i| &own[i],
            places: &|i| {
                let (strands, strand) = made.runs_in[i as usize];
                let along = made.along[ranges[i as usize].clone()].iter();
                along.map(|along| on_strand(strands, strand, *along)).collect()
            },
            takes: &is_look,
        };
        lineage.pass_on(&mut hair);
        hair.set(ALONG, Domain::Point, made.along);
        hair.build()
    }
}

/// Where on its way to the braid each point of a hair lies; at the end of that once it has joined. (`along` is that of the place
/// where it joins up to there.)
fn on_way(tuft: &Tuft, i: usize, along: &[f32]) -> Vec<CvPlace> {
    let first = tuft.range(i).start as u32;
    let joined = along.partition_point(|u| *u <= along[0]).min(along.len());
    let mut places = evenly(tuft.curve(i), joined);
    let end = (tuft.curve(i).len() as u32 - 2, 1.0);
    places.resize(along.len(), end);
    places.iter().map(|(before, t)| (first + before, *t)).collect()
}

/// Where on a strand the fraction `u` of its source lies.
fn on_strand(strands: &Tuft, strand: usize, u: f32) -> CvPlace {
    let AttributeView::Point(all) = strands.view(ALONG) else { return (0, 0.0) };
    let along = &all[strands.range(strand)];
    let before = along.partition_point(|at| *at <= u).clamp(1, along.len() - 1) - 1;
    let (a, b) = (along[before], along[before + 1]);
    (before as u32, if b > a { ((u - a) / (b - a)).clamp(0.0, 1.0) } else { 0.0 })
}
