//! Braid territory: which hair each braid picks up, where, and how it is combed there.
//!
//! methods.md 2, "Beyond". Rows, their territories and the paths over them are in `ground.rs`. Every root of a row's
//! territory joins once, where it is combed to; extension hair joins as requested. Both are counted along the row,
//! which gives the thickness of the braid everywhere (`girth`).
//!
//! Guarantees: roots are evenly spread, bound to the scalp, and half a parting's width away from every parting; a
//! higher density only adds hairs; the distribution of hair along a row does not depend on the density. Not promised:
//! paths that clear the skin by more than the error of the distance field (`braid_hair` handles that).

use super::ground::{Behind, Lane, Owner, RowIndex, UnrolledSide, far_off};
use super::tail::lengthened;
use crate::data::attribute_transfer::{CvPlace, Lineage, carry, own_parents};
use crate::data::attributes::{
    ALONG, Domain, FED, FIBRE, GIRTH, ID, JOINED, OF_CLUSTERS, PARENT, SCALP_NORMAL, SECTION, SIDE,
};
use crate::data::curves::{Curves, MOST_CURVES, Tuft, TuftBuilder};
use crate::data::field::Sampler;
use crate::data::ramp::{Blend, Ramp};
use crate::data::scalp::{Root, Scalp, Skin};
use crate::define::{FieldInput, NodeError, node};
use crate::eval::{EvalCx, Piece, Size};
use crate::guides::even_roots::EvenRoots;
use crate::maths::hash::{Dice, KeyBuilder, curve_id};
use crate::maths::low_discrepancy::r2;
use crate::maths::spline::Spline;
use crate::maths::transcendental::{exp, tan};
use crate::scalp::detour::{Detour, Towards};
use crate::scalp::lay;
use glam::Vec3;
use std::sync::{Arc, OnceLock};

node! {
    /// Divides the hair of a scalp among braid rows: every hair of a row's territory is combed to where the braid picks
    /// it up.
    ///
    /// Wire the rows that braids run along. Each root belongs to its nearest row, with a parting between rows. Wire the
    /// hairs to Hair through braids. The rows come out with the attribute girth, the thickness that the braid needs for
    /// the hair picked up so far: wire them to the Lissajous braid and multiply its width by girth.
    "braid_territory", version 1, label "Territory of braids",
        words "pick up section french dutch cornrow canerow feed in extension add gather roots comb parting row", thins, scales;
    inputs {
        /// The rows, root first: the curves that the braids will follow. They may extend beyond the scalp.
        source: Curves, words("rows braids guides");
        /// The head.
        scalp: Arc<Scalp>;
        /// Hairs per square centimetre. People have 130 to 250.
        density: f32 = 130.0, hard(0.0, 5000.0), soft(1.0, 300.0), unit(PerCm2), words("amount number count");
        /// Width of the bare skin of a parting between two rows. Roots stay half of it away from the middle.
        parting_width: f32 = 0.15, hard(0.0, 5.0), soft(0.0, 0.6), unit(Length), words("gap line skin clean");
        /// Distance from the row to the edge of the braid, where hair enters.
        braid_width: f32 = 1.0, hard(0.0, 50.0), soft(0.2, 4.0), unit(Length), words("size");
        /// Length of the hair. Short hair ends inside the braid and thins it there. 0: all of it reaches the end.
        length: FieldInput = 0.0, hard(0.0, 500.0), soft(0.0, 80.0), unit(Length), words("cut layers");

        [Placement]
        /// Largest distance from which a row picks up hair. 0: no limit, as long as no other row is nearer.
        reach: f32 = 0.0, hard(0.0, 100.0), soft(0.0, 15.0), unit(Length), words("distance section width"), handle(Handle::Radius);
        /// Distance from the front of its row to where each braid begins; hair in front of it is combed back to the
        /// first stitch. Limited to half of the row's length on the scalp. A braid that stands up from the head begins
        /// at its root.
        start: f32 = 1.0, hard(0.0, 50.0), soft(0.0, 5.0), unit(Length), words("first section base");
        /// Where the last hair joins, as a fraction of the row's length on the scalp.
        until: f32 = 0.97, hard(0.05, 1.0), unit(Ratio), handle(Handle::Along), words("last end");

        [Shape]
        /// Angle at which hair is combed along the row on its way to it: 0 is square, 80 nearly along it, negative
        /// against it. Varies along the row.
        pull_angle: FieldInput = 45.0, hard(-80.0, 80.0), unit(Angle), handle(Handle::Angle), words("sweep oblique comb direction back lead");
        /// How hair turns into the braid: 0 is straight from root to braid, 100% leaves the parting square and ends
        /// along the braid.
        sweep: f32 = 0.45, hard(0.0, 1.0), unit(Ratio), words("curve bend comb");
        /// Length by which each row continues past its last point, hanging down over head, neck and shoulders. 0: not
        /// at all.
        tail: f32 = 0.0, hard(0.0, 200.0), soft(0.0, 60.0), unit(Length), words("hang free length pony"), handle(Handle::Length);
        /// Height of the tail above the skin; about half the braid's height.
        tail_height: f32 = 0.8, hard(0.0, 20.0), soft(0.0, 3.0), unit(Length), words("clearance");

        [Thickness]
        /// Extension hairs fed into each row: 0 for none.
        feed: FieldInput = 0.0, hard(0.0, 100000.0), soft(0.0, 5000.0), unit(Count), words("feed in extension knotless add braiding hair kanekalon jumbo");
        /// Distance along the row at which feeding begins. 0 is the first stitch.
        feed_from: f32 = 1.0, hard(0.0, 100.0), soft(0.0, 10.0), unit(Length), words("extension knotless");
        /// Feeding rate along the row, from where it begins (left) to the end (right). A ramp that drops to 0 early
        /// feeds all hair within a few stitches.
        feed_ramp: Arc<Ramp> = fading(), words("amount extension");
        /// Length of extension hair. 0: it reaches the end.
        feed_length: f32 = 0.0, hard(0.0, 500.0), soft(0.0, 120.0), unit(Length), words("extension");

        [Detail]
        /// CVs per hair, from its root to the braid.
        cvs: i64 = 9, hard(3.0, 64.0), soft(5.0, 24.0), unit(Count), words("points resolution");
        /// Scale lengths with the size of the head; density is divided by its square, which keeps the number of hairs.
        scale_with_head: bool = true, words("head units");

        [Randomness]
        /// Random variation of the pull angle.
        unevenness: f32 = 0.15, hard(0.0, 1.0), unit(Ratio), words("random variation natural loose messy");
        /// Random shortening of hairs, when a length is set.
        length_variation: f32 = 0.2, hard(0.0, 1.0), unit(Ratio), words("random layers");
        /// Random seed for this node. It changes ids too.
        seed: i64 = 0;
    }
    outputs {
        /// The hairs from their roots to where they join the braid, with row, side and position along the row.
        curves: Curves;
        /// The rows, starting where their braids begin, with the attributes girth (thickness of the braid, 0 to 1) and
        /// joined (fraction of all hair that has joined so far).
        source: Curves;
    }
}

/// Name of the fraction of a row's hair that joined before a given hair.
pub(super) const ORDER: &str = "join_order";

fn fading() -> Ramp {
    Ramp::new(Blend::Linear, vec![(0.0, 1.0), (0.25, 0.0)]).unwrap_or_else(|_| Ramp::constant(1.0))
}

/// Density of probe hairs per cm2 (head units) from which thickness is computed, whatever the density is.
const PROBES: f32 = 24.0;
/// Bins along a row in which hairs are counted.
const BINS: usize = 256;
/// Smallest thickness of a braid.
const THIN: f32 = 0.12;
/// Length of hair per length of braid, since it winds.
const CRIMP: f32 = 1.12;
/// First index for ids of extension hair.
const EXTENSION: u64 = 1 << 40;
/// Roots per work item.
const BATCH: usize = 2048;
/// Height of hairs above the skin, cm on a head of average size: the minimum, and the addition for overlapping hair.
const CLEAR: (f32, f32) = (0.025, 0.05);

/// Range of distances (cm from the row, on a head of average size) over which paths begin to bend over the ball of the
/// head.
const FAR: [f32; 2] = [4.0, 8.0];

/// A root with its row.
#[derive(Clone, Copy)]
struct Place {
    index: u32,
    name: u64,
    root: Root,
    owner: Owner,
    side: i32,
}

fn eval(cx: &EvalCx, inputs: Inputs) -> Result<Outputs, NodeError> {
    let scalp = &*inputs.scalp;
    let unit = cx.unit();
    let skin = cx.skin(scalp);
    let (mut lanes, mut rows) = (vec![], vec![]);
    for (tuft, curve) in inputs.source.each() {
        cx.check()?;
        let id = tuft.id(curve);
        let laid = lengthened(tuft.curve(curve), inputs.tail, inputs.tail_height, &skin);
        let source = match Spline::new(&laid) {
            Ok(source) => source,
            Err(fault) => {
                cx.trouble(id, fault);
                continue;
            }
        };
        let section = tuft.view(SECTION).at(curve, tuft.range(curve).start);
        match Lane::new(id, &source, scalp, 0.9 * unit, (section != 0).then_some(section)) {
            Some(lane) => {
                lanes.push(lane);
                rows.push((tuft, curve, source));
            }
            None => cx.trouble(id, "a row that is nowhere near the scalp was left out"),
        }
    }
    let ground = RowIndex::new(lanes, scalp);
    let maker = Maker {
        inputs: &inputs,
        scalp,
        ground: &ground,
        parting: inputs.parting_width,
        unit,
        dice: cx.dice(inputs.seed, "territory"),
        even: EvenRoots::new(scalp, cx.dice(inputs.seed, "roots")),
        detour: Detour::new(scalp, &skin),
        skin,
    };
    // The first part of the list of even roots is hair; there may be more probes.
    let last = cx.makes((f64::from(inputs.density) * maker.even.area()).min(20e6) as usize);
    cx.may_make(&Size::of(&[
        ("hairs of the whole scalp", last as f64),
        ("cvs", inputs.cvs as f64),
    ]))?;
    let (places, probes) = maker.places(cx, last)?;
    let mut counted = vec![];
    for (i, (tuft, curve, _)) in rows.iter().enumerate() {
        let wishes = maker.wishes(tuft, *curve)?;
        let row = maker.count(
            i,
            &wishes,
            &places[i][..probes[i]],
            maker.probes() / inputs.density.max(1e-3),
        )?;
        if places[i].is_empty() && row.feed.is_empty() {
            cx.trouble(tuft.id(*curve), "no hair grows on the ground of a row");
        }
        counted.push(row);
    }
    let source =
        rows.iter().zip(&counted).zip(&ground.lanes).map(|(((tuft, curve, source), row), lane)| {
            Arc::new(thickened(tuft, *curve, maker.behind_start(lane, source), row))
        });
    let source = Curves::new(source.collect());

    // Hair of one row is split into parts, so that one large row keeps all threads busy.
    let maps: Vec<[OnceLock<UnrolledSide>; 2]> = rows.iter().map(|_| Default::default()).collect();
    let mut parts = vec![];
    for i in 0..rows.len() {
        let count = places[i].partition_point(|place| (place.index as usize) < last);
        parts.extend(
            (0..count).step_by(PART).map(|from| (i, from, (from + PART).min(count), false)),
        );
        let feed = counted[i].feed.len();
        parts.extend(
            (0..feed)
                .step_by(MOST_CURVES)
                .map(|from| (i, from, (from + MOST_CURVES).min(feed), true)),
        );
    }
    let tufts = source.tufts();
    let key = |n: usize| {
        let (i, from, to, fed) = parts[n];
        let mut key = KeyBuilder::new("territory").key(tufts[i].key()).int(u64::from(fed));
        // The row before its braid begins, as well.
        for p in ground.lanes[i].points() {
            key = p.to_array().into_iter().fold(key, KeyBuilder::float);
        }
        if fed {
            return key.int(from as u64).int(to as u64).finish();
        }
        for place in &places[i][from..to] {
            let owner = &place.owner;
            key = key.int(place.name).float(owner.ahead).float(owner.distance);
        }
        key.finish()
    };
    let hairs: usize = parts.iter().map(|(_, from, to, _)| to - from).sum();
    let size = Size::of(&[("hairs", hairs as f64), ("cvs", inputs.cvs as f64)]);
    let [curves] = cx.each_item(parts.len(), &size, key, |n, piece| {
        let (i, from, to, fed) = parts[n];
        let (tuft, curve, source) = &rows[i];
        let row = (*tuft, *curve, maker.behind_start(&ground.lanes[i], source));
        if fed {
            return Ok([maker.extension(i, row, &counted[i], from..to)]);
        }
        // From the probes, so that more hair changes no path.
        let far = places[i][..probes[i]].iter().map(|place| place.owner.distance);
        let reach = far.fold(0.0f32, f32::max);
        let map = |side: i32| {
            maps[i][usize::from(side > 0)].get_or_init(|| {
                let own = |p: Vec3| maker.whose(p).is_some_and(|o| o.lane == i as u32);
                UnrolledSide::new(&ground.lanes[i], scalp, side, 1.7 * reach + 0.4 * unit, own)
            })
        };
        Ok([maker.hairs(i, row, &counted[i], &places[i][from..to], &map, piece)?])
    })?;
    Ok(Outputs { curves, source })
}

/// Hairs per work item.
const PART: usize = 2048;

/// Distribution of a row's hair along its braid.
struct Row {
    /// Fraction of all hair that has joined up to each border of the [`BINS`].
    joined: Vec<f32>,
    /// Thickness at the borders.
    girth: Vec<f32>,
    /// Where extension hairs join, as fractions of the braid, in the order of their ids.
    feed: Vec<f32>,
    /// Fraction of all hair that joins at the root.
    first: f32,
}

struct Maker<'a> {
    inputs: &'a Inputs,
    scalp: &'a Scalp,
    skin: Skin<'a>,
    ground: &'a RowIndex,
    parting: f32,
    unit: f32,
    dice: Dice,
    even: EvenRoots<'a>,
    detour: Detour<'a>,
}

/// Settings of a row's hair along the row.
struct Wishes<'a> {
    tuft: &'a Tuft,
    curve: usize,
    pull: Sampler<'a>,
    length: Sampler<'a>,
}

impl Maker<'_> {
    fn wishes<'t>(&'t self, tuft: &'t Tuft, curve: usize) -> Result<Wishes<'t>, NodeError> {
        let pull = self.inputs.pull_angle.on(tuft, Some(self.scalp))?;
        let length = self.inputs.length.on(tuft, Some(self.scalp))?;
        Ok(Wishes { tuft, curve, pull, length })
    }
    /// The owner of a position, unless it lies in a parting or too far away.
    fn whose(&self, p: Vec3) -> Option<Owner> {
        self.owner(&self.scalp.closest_root(p)?)
    }
    /// The owner of a root, unless it lies in a parting or too far away.
    fn owner(&self, root: &Root) -> Option<Owner> {
        let p = root.point;
        let section = match self.scalp.sections() {
            Some(cut) => {
                let place = cut.at(root.point)?;
                place.free.then_some(Some(cut.list()[place.section as usize].id))?
            }
            None => None,
        };
        let of_section = |lane: u32| {
            let own = self.ground.lanes[lane as usize].section;
            section.is_none() || own.is_none() || own == section
        };
        let owner = self.ground.owner(self.scalp, p, of_section)?;
        let reach = self.inputs.reach;
        (owner.ahead >= self.parting && (reach <= 0.0 || owner.distance <= reach)).then_some(owner)
    }
    /// Probe hairs per cm2.
    fn probes(&self) -> f32 {
        PROBES / (self.unit * self.unit)
    }
    /// Roots by row, in the order in which density adds them, and the number of probes of each row.
    fn places(&self, cx: &EvalCx, last: usize) -> Result<(Vec<Vec<Place>>, Vec<usize>), NodeError> {
        let probes = (f64::from(self.probes()) * self.even.area()) as usize;
        let last = last.max(probes);
        let batches = last.div_ceil(BATCH);
        let found = cx.map(if self.ground.lanes.is_empty() { 0 } else { batches }, |b| {
            let place = |index: u32| {
                let (name, root) = self.even.root(index)?;
                let owner = self.owner(&root)?;
                let lane = &self.ground.lanes[owner.lane as usize];
                let side = lane.side(root.point, owner.foot, owner.u);
                Some(Place { index, name, root, owner, side })
            };
            let range = (b * BATCH) as u32..last.min((b + 1) * BATCH) as u32;
            Ok(range.filter_map(place).collect::<Vec<Place>>())
        })?;
        let mut rows = vec![vec![]; self.ground.lanes.len()];
        let mut few = vec![0; rows.len()];
        for place in found.into_iter().flatten() {
            let lane = place.owner.lane as usize;
            few[lane] += usize::from((place.index as usize) < probes);
            rows[lane].push(place);
        }
        Ok((rows, few))
    }
    /// Distance from the front of its row to the start of a braid, cm.
    fn start(&self, lane: &Lane) -> f32 {
        self.inputs.start.min(0.5 * lane.scalp_length.min(lane.row.length()))
    }
    /// The braided part of a row's source.
    fn behind_start<'s>(&self, lane: &Lane, source: &'s Spline) -> Behind<'s> {
        Behind { source, from: self.start(lane) / lane.length }
    }
    /// Where along its braid (0 to 1) a root joins, and its length (0: to the end).
    fn joins(&self, lane: &Lane, wishes: &Wishes, place: &Place, id: u64) -> (f32, f32) {
        let on_scalp = lane.row.length();
        let foot = lane.foot(place.root.point, &place.owner, self.far());
        let pull = wishes.pull.along(wishes.tuft, wishes.curve, foot);
        let pull = pull + 14.0 * self.inputs.unevenness * self.dice.signed(id, 0);
        let shift = tan(pull.clamp(-80.0, 80.0).to_radians()) * place.owner.distance;
        // The shift decreases toward the last joining position: nothing joins beyond it.
        let (here, last) = (foot * on_scalp, self.inputs.until * on_scalp);
        let room = (last - here).max(0.0);
        let x = match shift {
            shift if shift > 0.0 && room > 0.0 => here + room * (1.0 - exp(-shift / room)),
            shift if shift > 0.0 => last,
            shift => (here + shift).clamp(0.0, last),
        };
        // The first section is combed to the first stitch. If that is nearer, later hair catches up, so that neighbours
        // stay neighbours.
        let start = self.start(lane);
        let behind = 2.0 * (x - self.inputs.start);
        let x = behind.min(x - start).min(last - start).max(0.0);
        let length = wishes.length.along(wishes.tuft, wishes.curve, place.owner.u);
        let cut = 1.0 - self.inputs.length_variation * self.dice.unit(id, 1);
        (x / (lane.length - start), length * cut)
    }
    /// Counts the hair of a row along it, in probes; an extension hair counts as `share` of one.
    fn count(
        &self,
        i: usize,
        wishes: &Wishes,
        probes: &[Place],
        share: f32,
    ) -> Result<Row, NodeError> {
        let lane = &self.ground.lanes[i];
        let braided = lane.length - self.start(lane);
        let (mut joins, mut ends) = (vec![0.0f32; BINS + 1], vec![0.0f32; BINS + 1]);
        let bin = |u: f32| ((u * BINS as f32).ceil() as usize).min(BINS);
        for place in probes {
            let id = self.id(lane, place);
            let (u, length) = self.joins(lane, wishes, place, id);
            joins[bin(u)] += 1.0;
            if length > 0.0 {
                let end = u + (length - place.owner.distance).max(0.0) / (CRIMP * braided);
                if end < 1.0 {
                    ends[bin(end)] += 1.0;
                }
            }
        }
        let feed = self.feed(lane, (wishes.tuft, wishes.curve))?;
        for u in &feed {
            joins[bin(*u)] += share;
            let end = u + self.inputs.feed_length / (CRIMP * braided);
            if self.inputs.feed_length > 0.0 && end < 1.0 {
                ends[bin(end)] += share;
            }
        }
        let all: f32 = joins.iter().sum::<f32>().max(1e-6);
        let (mut joined, mut alive) = (vec![], vec![]);
        let (mut a, mut b) = (0.0f32, 0.0f32);
        for (joins, ends) in joins.iter().zip(&ends) {
            (a, b) = (a + joins, b + ends);
            joined.push(a / all);
            alive.push((a - b).max(0.0));
        }
        let most = alive.iter().fold(1e-6f32, |most, n| most.max(*n));
        let mut girth: Vec<f32> = alive.iter().map(|n| (n / most).sqrt().max(THIN)).collect();
        // Counting in bins is coarse; smoothing gives a gradual braid.
        for _ in 0..6 {
            let before = girth.clone();
            for k in 1..BINS {
                girth[k] = 0.25 * (before[k - 1] + before[k + 1]) + 0.5 * before[k];
            }
        }
        let first = joined[0];
        Ok(Row { joined, girth, feed, first })
    }
    /// Where a row's extension hairs join.
    fn feed(&self, lane: &Lane, (tuft, curve): (&Tuft, usize)) -> Result<Vec<f32>, NodeError> {
        let count =
            self.inputs.feed.on(tuft, Some(self.scalp))?.along(tuft, curve, 0.0).round() as u32;
        if count == 0 {
            return Ok(vec![]);
        }
        let braided = lane.length - self.start(lane);
        let from = (self.inputs.feed_from / braided).min(1.0);
        const STEPS: usize = 128;
        let mut sums = vec![0.0f32];
        for k in 0..STEPS {
            let amount = self.inputs.feed_ramp.at((k as f32 + 0.5) / STEPS as f32).max(0.0);
            sums.push(sums[k] + amount);
        }
        let all = sums[STEPS];
        let shift = [self.dice.unit(lane.id, 2), 0.0];
        let place = |i: u32| {
            let wanted = r2(i, shift)[0] * all;
            let k = (sums.partition_point(|s| *s <= wanted).max(1) - 1).min(STEPS - 1);
            let t = (wanted - sums[k]) / (sums[k + 1] - sums[k]).max(1e-9);
            from + (1.0 - from) * (k as f32 + t.clamp(0.0, 1.0)) / STEPS as f32
        };
        Ok((0..count).map(place).collect())
    }
    /// Leads a hair of a row past an ear: straight up if that stays in the row's territory, else toward the crown.
    fn past_ears(&self, way: &mut [Vec3], lane: u32) {
        let before = way.to_vec();
        let is_own = |p: &Vec3| {
            self.ground.owner(self.scalp, *p, |_| true).is_none_or(|owner| owner.lane == lane)
        };
        if self.detour.reroute(way, Towards::Top) && !way.iter().all(is_own) {
            way.copy_from_slice(&before);
            self.detour.reroute(way, Towards::Crown);
        }
    }
    fn id(&self, lane: &Lane, place: &Place) -> u64 {
        curve_id(lane.id, self.inputs.seed as u64, place.name)
    }
    /// Hairs of a row from their roots to where they join.
    fn hairs<'m>(
        &self,
        i: usize,
        row: (&Tuft, usize, Behind),
        counted: &Row,
        places: &[Place],
        map: &dyn Fn(i32) -> &'m UnrolledSide,
        piece: &mut Piece,
    ) -> Result<Tuft, NodeError> {
        let lane = &self.ground.lanes[i];
        let cvs = self.inputs.cvs as usize;
        let mut points: Vec<Vec3> = Vec::with_capacity(places.len() * cvs);
        let (mut ids, mut sides, mut along, mut order, mut fibre) =
            (vec![], vec![], vec![], vec![], vec![]);
        let mut found = vec![];
        let wishes = self.wishes(row.0, row.1)?;
        let start = self.start(lane);
        for place in places {
            piece.tick()?;
            let id = self.id(lane, place);
            let (u, length) = self.joins(lane, &wishes, place, id);
            let map = map(place.side);
            let from = map.locate(place.root.point, &mut found);
            // Roots under the braid are combed along beneath it.
            let edge = 0.5 * self.inputs.braid_width * girth_at(counted, u);
            let beside = edge.min(0.8 * map.beside(from));
            let end = (start + u * (lane.length - start)) / lane.row.length();
            let to = (map.column(end), beside);
            let high = (CLEAR.0 + CLEAR.1 * self.dice.unit(id, 2)) * self.unit;
            let foot = lane.foot(place.root.point, &place.owner, self.far());
            let first = points.len();
            // A path that meets an edge, such as that of an ear, is led over it.
            for more in [0.0, 0.3, 0.6] {
                points.truncate(first);
                let sweep = (self.inputs.sweep + more).min(1.0);
                map.way(&place.root, from, to, sweep, cvs, &mut points);
                let corner = lane.row.spline.at(end + (foot - end) * sweep);
                self.across_the_head(&mut points[first..], corner, &place.owner);
                self.past_ears(&mut points[first..], i as u32);
                self.lay(&mut points[first..], high);
                let way = &points[first..];
                let far = place.owner.distance > self.far()[0];
                if !far || is_smooth(way) && !self.goes_under(way) {
                    break;
                }
            }
            ids.push(id);
            sides.push(place.side);
            along.push(u);
            order.push(if u > 0.0 {
                at(&counted.joined, u)
            } else {
                counted.first * self.dice.unit(id, 3)
            });
            fibre.push(length);
        }
        let mut out = TuftBuilder::even(points, cvs);
        if ids.is_empty() {
            return Ok(out.build());
        }
        out.set(SIDE, Domain::Curve, sides);
        out.set(FED, Domain::Curve, vec![0]);
        let roots: Vec<Root> = places.iter().map(|place| place.root).collect();
        out.set(SCALP_NORMAL, Domain::Curve, roots.iter().map(|root| root.normal).collect());
        lay::bind(&mut out, &roots);
        self.describe(&mut out, row, lane, (ids, along, order, fibre));
        Ok(out.build())
    }
    /// Whether a path passes through something that sticks out from the head between its points.
    fn goes_under(&self, way: &[Vec3]) -> bool {
        way.windows(2).any(|w| {
            let deep = |t: f32| self.skin.about(w[0].lerp(w[1], t)) < -0.25 * self.unit;
            deep(0.33) || deep(0.67)
        })
    }
    /// Range of distances over which roots count as far from their row.
    fn far(&self) -> [f32; 2] {
        FAR.map(|d| d * self.unit)
    }
    /// Lays a path on the skin, rising to `high` above it within its first fifth.
    fn lay(&self, way: &mut [Vec3], high: f32) {
        let count = way.len() as f32;
        for (k, p) in way.iter_mut().enumerate().skip(1) {
            let wanted = high * (5.0 * k as f32 / count).min(1.0);
            for _ in 0..3 {
                match self.skin.roughly(*p) {
                    Some((d, _, doubt)) if (d - wanted).abs() < 0.01 && doubt < 0.06 => break,
                    Some((d, out, doubt)) if d > -0.8 && doubt < 0.06 => {
                        *p += out.normalize_or_zero() * (wanted - d);
                    }
                    // Where the columns of the map converge, a path may cut a corner.
                    _ => *p = lay::laid(self.scalp, *p, wanted).0,
                }
            }
        }
    }
    /// Bends long paths over the ball of the head instead, toward the `corner` on the row: the columns of the map,
    /// which are perpendicular to the row, converge there beside the ears like meridians at a pole. Not where that
    /// leads over another row's territory.
    fn across_the_head(&self, way: &mut [Vec3], corner: Vec3, owner: &Owner) {
        let frame = self.scalp.frame();
        let share = far_off(owner.distance, self.far());
        if share <= 0.0 {
            return;
        }
        let (a, b) = (way[0] - frame.origin, way[way.len() - 1] - frame.origin);
        let corner = corner - frame.origin;
        let (low, high, last) = (a.length(), b.length(), (way.len() - 1) as f32);
        let bent = |p: Vec3, k: usize| {
            let s = k as f32 / last;
            let r = 1.0 - s;
            let out = a * (r * r) + corner * (2.0 * r * s) + b * (s * s);
            let over = |out: Vec3| frame.origin + out * (low + (high - low) * s);
            out.try_normalize().map_or(p, |out| p.lerp(over(out), share))
        };
        let is_own = |p: Vec3| self.whose(p).is_none_or(|o| o.lane == owner.lane);
        let looked_at = (2..way.len() - 1).step_by(2);
        if self.ground.lanes.len() > 1 && !looked_at.into_iter().all(|k| is_own(bent(way[k], k))) {
            return;
        }
        for (k, p) in way.iter_mut().enumerate().skip(1) {
            *p = bent(*p, k);
        }
    }
    /// Attributes that growing and extension hair have in common.
    fn describe(
        &self,
        out: &mut TuftBuilder,
        (tuft, curve, source): (&Tuft, usize, Behind),
        lane: &Lane,
        (ids, along, order, fibre): (Vec<u64>, Vec<f32>, Vec<f32>, Vec<f32>),
    ) {
        let own = own_parents(ids.len());
        // As the row is where a hair joins it. Its braid is as thick as it says there, not its hair.
        let lineage = Lineage {
            parent: &|_| (tuft, curve),
            of: &|hair| &own[hair],
            places: &|hair| vec![on_row(source, along[hair as usize], tuft.range(curve).len())],
            takes: &|name| name != SCALP_NORMAL.name && !OF_CLUSTERS.contains(&name),
        };
        out.set(ID, Domain::Curve, ids);
        out.set(PARENT, Domain::Curve, vec![lane.id]);
        out.set(ALONG, Domain::Curve, along.clone());
        out.set_named(ORDER.into(), Domain::Curve, order);
        if fibre.iter().any(|length| *length > 0.0) {
            out.set(FIBRE, Domain::Curve, fibre);
        }
        lineage.pass_on(out);
    }
    /// Extension hairs: short pieces of the row where they are fed in.
    fn extension(
        &self,
        i: usize,
        (tuft, curve, source): (&Tuft, usize, Behind),
        counted: &Row,
        which: std::ops::Range<usize>,
    ) -> Tuft {
        let lane = &self.ground.lanes[i];
        let mut out = TuftBuilder::new();
        let (mut ids, mut along, mut order) = (vec![], vec![], vec![]);
        for k in which {
            let u = counted.feed[k];
            let step = (0.3 * self.unit / source.length()).min(0.5);
            out.push_curve(&[source.at((u - step).max(0.0)), source.at(u.max(step))]);
            let id = curve_id(lane.id, self.inputs.seed as u64, EXTENSION + k as u64);
            ids.push(id);
            along.push(u);
            order.push(if u > 0.0 {
                at(&counted.joined, u)
            } else {
                counted.first * self.dice.unit(id, 3)
            });
        }
        out.set(FED, Domain::Curve, vec![1]);
        if let Some(section) = lane.section {
            out.set(SECTION, Domain::Curve, vec![section]);
        }
        let fibre = vec![self.inputs.feed_length; ids.len()];
        self.describe(&mut out, (tuft, curve, source), lane, (ids, along, order, fibre));
        out.build()
    }
}

/// Whether a path turns nowhere by more than 37 degrees between two points.
fn is_smooth(way: &[Vec3]) -> bool {
    way.windows(3).all(|w| {
        let (a, b) = (w[1] - w[0], w[2] - w[1]);
        a.dot(b) >= 0.8 * (a.length_squared() * b.length_squared()).sqrt()
    })
}

/// Interpolates between the borders of bins.
fn at(values: &[f32], u: f32) -> f32 {
    let x = u.clamp(0.0, 1.0) * BINS as f32;
    let k = (x as usize).min(BINS - 1);
    values[k] + (values[k + 1] - values[k]) * (x - k as f32)
}

fn girth_at(row: &Row, u: f32) -> f32 {
    at(&row.girth, u)
}

/// The place on a row of `cvs` CVs (at least 2) that corresponds to the fraction `u` of its braid; the tip, if the braid extends beyond the
/// row.
fn on_row(source: Behind, u: f32, cvs: usize) -> CvPlace {
    let place = source.place(u);
    let last = cvs.saturating_sub(2);
    if place.span > last { (last as u32, 1.0) } else { (place.span as u32, place.t) }
}

/// The row with its thickness, at as many evenly spaced points as that requires.
fn thickened(tuft: &Tuft, curve: usize, source: Behind, row: &Row) -> Tuft {
    let n = ((source.length() / 0.15).ceil() as usize).clamp(24, 240) + 1;
    let u = |k: usize| k as f32 / (n - 1) as f32;
    let mut out = TuftBuilder::even((0..n).map(|k| source.at(u(k))).collect(), n);
    let cvs = tuft.range(curve);
    let place = |k: usize| {
        let (before, t) = on_row(source, u(k), cvs.len());
        (cvs.start as u32 + before, t)
    };
    carry(tuft, &[curve as u32], &(0..n).map(place).collect::<Vec<_>>(), &mut out);
    let along = |values: &[f32]| (0..n).map(|k| at(values, u(k))).collect();
    out.set_named(GIRTH.into(), Domain::Point, along(&row.girth));
    out.set_named(JOINED.into(), Domain::Point, along(&row.joined));
    out.build()
}
