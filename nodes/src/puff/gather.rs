//! Gather: combs hair smoothly over the scalp into a tie.
//!
//! Seen from its tie, every hair keeps its bearing and the order of its distance: a hair rooted farther away lies over
//! those rooted nearer, and farther out in the tie, so that in the half plane of one bearing, hairs are nested
//! hyperbolas over the skin. The thickness of their layers follows from the area of the tie: the hair that passes at a
//! distance is the hair rooted beyond, spread over the circle there.
//!
//! Guarantees: roots on the scalp and unmoved; no point below the skin; ends inside the tie's ring, or above it where
//! it dips into the head; hairs of one tie keep their order unless they stray; more hair only adds hairs; hair of a tie
//! that gathers only its own section crosses no parting, and neither does hair of a section that its tie stands over,
//! except where the skin leaves no path, which is reported. Not promised: equal lengths.

use super::At;
use super::dome::{Dome, Polar};
use super::tie::Tie;
use crate::data::attribute_transfer::{Lineage, evenly};
use crate::data::attributes::{
    Domain, FIBRE, ID, NORMAL, OF_CLUSTERS, PARENT, PUFF, RADIUS, ROOT_BARY, ROOT_TRIANGLE,
    ROOT_UV, SCALP_NORMAL, SECTION, TIE, TIE_RADIUS, WIDTH,
};
use crate::data::curves::{Curves, Tuft, TuftBuilder};
use crate::data::route::makers::{lift, lift_each};
use crate::data::route::section_guard::Home;
use crate::data::scalp::{Root, Scalp, Skin};
use crate::data::sections::Sections;
use crate::define::{FieldInput, NodeError, node};
use crate::eval::{EvalCx, Piece, Size};
use crate::guides::even_roots::EvenRoots;
use crate::maths::catmull_rom_agreement::{AGREE, readings_differ};
use crate::maths::frame::{across, any_normal};
use crate::maths::hash::{Dice, KeyBuilder, curve_id};
use crate::maths::smoothstep;
use crate::maths::spline::Spline;
use crate::maths::transcendental::{sin, sin_cos, sin_cos_turns};
use crate::scalp::detour::{Detour, Towards};
use glam::Vec3;
use std::f32::consts::PI;
use std::sync::Arc;

node! {
    /// Combs hair smoothly over the scalp into a tie: the base of ponytails, buns and puffs.
    ///
    /// Hair takes the shortest way over the head and lies in layers, with hair from farther away on top. Wire `curves`
    /// and `ties` into Tail or Bun, which continue the hair past the tie, or `ties` into Sphere puff. With several
    /// ties, each hair goes to the nearest one, with a parting between them.
    "gather", version 1, label "Gather into tie",
        words "tie ponytail pony tail bun puff elastic band hair tie base sleek slick back comb pull bunches pigtails updo", thins, scales;
    inputs {
        /// The head.
        scalp: Arc<Scalp>;
        /// Hair to gather by its roots, such as that of a section; only the roots are used. Without it, hair is rooted
        /// all over the scalp by `density` and `mask`.
        roots: Option<Curves>, words("section hair");
        /// Curves whose roots or tips are the positions of ties, one tie for each. Without them, one tie sits at
        /// `position`.
        placements: Option<Curves>, words("points several");
        /// The end of each of `placements` at which its tie sits.
        at: At = At::Roots, words("end root tip place");
        /// Position of the tie in head units from the centre of the cranium: the point of the scalp in this direction.
        position: Vec3 = Vec3::new(0.0, 6.5, -7.0), handle(Handle::Point), words("place pick height high low");
        /// Add a second tie at the mirrored position, with a centre parting between them.
        mirror: bool = false, words("symmetry pigtails bunches two");
        /// Hairs per square centimetre. People have 130 to 250.
        density: f32 = 150.0, hard(0.0, 5000.0), soft(20.0, 300.0), unit(PerCm2), words("amount number");
        /// Fraction of hairs to keep; usually a mask or a section.
        mask: FieldInput = 1.0, hard(0.0, 1.0), unit(Ratio), words("area region section paint");
        /// Diameter of a hair.
        width: f32 = 0.007, hard(0.0001, 1.0), soft(0.002, 0.05), unit(Length), fixed(), words("thickness diameter");

        [Placement]
        /// Largest distance over the scalp from which a tie gathers hair. 0: no limit.
        reach: f32 = 0.0, hard(0.0, 200.0), soft(0.0, 20.0), unit(Length), handle(Handle::Radius), words("area section");
        /// On a parted scalp, let each tie gather only hair of its own section.
        own_section: bool = false, words("partings section parted area");
        /// Width of the parting between the hair of two ties.
        parting: f32 = 0.15, hard(0.0, 10.0), soft(0.0, 0.5), unit(Length), words("part line section");
        /// Hairs along the outer edges, at hairline and partings, per hair that grows there. More makes a firm edge
        /// where hair is combed away from bare skin.
        edge_density: f32 = 1.0, hard(1.0, 12.0), soft(1.0, 6.0), words("hairline parting edge dense laid crisp");
        /// Width of the denser band along an edge.
        edge_width: f32 = 0.7, hard(0.0, 10.0), soft(0.2, 2.0), unit(Length), words("hairline parting edge");

        [Shape]
        /// Thickness of the layers of hair: 1 is as thick as fills the tie, 0 lays all hair on the skin.
        volume: f32 = 1.0, hard(0.0, 4.0), soft(0.0, 2.0), unit(Ratio), words("lift body fullness");
        /// Smallest height of the hair above the skin, past its root.
        clearance: f32 = 0.03, hard(0.0, 5.0), soft(0.0, 0.3), unit(Length), words("lift offset");

        [Tie]
        /// Height above the scalp at which hair leaves the tie.
        height: f32 = 1.2, hard(0.1, 30.0), soft(0.3, 4.0), unit(Length), handle(Handle::Length), words("stand off");
        /// Radius of the hair in the tie. A full head of straight hair has 1 to 1.5 cm.
        radius: f32 = 1.2, hard(0.05, 10.0), soft(0.3, 2.5), unit(Length), handle(Handle::Radius), words("thickness girth");
        /// Tilt of the tie from the scalp normal: up over the head, or down when negative.
        lean: f32 = 0.0, hard(-80.0, 80.0), soft(-60.0, 60.0), unit(Angle), handle(Handle::Angle), words("tilt angle direction");
        /// How tightly hair is pulled in: 1 lies flat and bends sharply up into the tie, 0 rises to it from far away.
        tightness: f32 = 0.75, hard(0.0, 1.0), unit(Ratio), words("elastic band tension");
        /// Turns of the band's guide around the tie; 0 makes no band.
        band_turns: f32 = 3.0, hard(0.0, 20.0), soft(0.0, 6.0), words("wrap hair elastic");
        /// Height of the tie that the band covers.
        band_height: f32 = 0.7, hard(0.0, 10.0), soft(0.2, 2.0), unit(Length), words("wrap hair elastic");

        [Detail]
        /// CVs per hair, root and end included.
        points: i64 = 20, hard(4.0, 200.0), soft(8.0, 40.0), unit(Count), words("cvs resolution segments");
        /// Scale lengths with the size of the head.
        scale_with_head: bool = true;

        [Randomness]
        /// Random sideways deviation of hairs on their way to the tie. 0 is perfectly combed.
        wander: f32 = 0.08, hard(0.0, 5.0), soft(0.0, 0.5), unit(Length), words("jitter random messy natural");
        /// Fraction of hairs that stand off from the others on their way.
        stray: f32 = 0.01, hard(0.0, 1.0), soft(0.0, 0.1), unit(Ratio), words("flyaways loose");
        /// Largest distance by which they stand off.
        stray_height: f32 = 0.5, hard(0.0, 10.0), soft(0.0, 2.0), unit(Length), words("flyaways loose");
        /// Random seed for this node. It changes ids too.
        seed: i64 = 0;
    }
    outputs {
        /// Hair from its root to the top of its tie.
        curves: Curves;
        /// The ties: curves from the scalp to where hair is free again, with their radius.
        ties: Curves;
        /// A lock wound around each tie to hide its band. Fill it with Cluster to strands.
        bands: Curves;
    }
}

/// Hairs per work item.
const HAIRS_A_PIECE: usize = 1024;
/// The most hairs at any density.
const MOST_HAIRS: usize = 2_000_000;
/// Number of roots that determine how hair is spread around a tie. They do not depend on the density, so that more hair
/// moves none.
const PROBES: u32 = 8192;
/// Samples of a hair's path before its points are spaced evenly.
const SAMPLES: usize = 40;
/// Message for hair that its tie draws over a parting.
const OVER: &str = "a hair is combed over a parting to its tie: own_section keeps ties to their sections, and reach to the hair near them";
/// Steps in which the fraction of hair within a distance is tabulated, and their length, cm.
const SHARES: usize = 256;
const SHARE_STEP: f32 = 0.2;
/// Samples of a tie's ring for finding the sections that it stands over.
const AROUND: usize = 16;
/// No point is moved farther than this (cm on a head of average size) to keep it off a parting.
const FAR_OFF: f32 = 0.6;

fn eval(cx: &EvalCx, inputs: Inputs) -> Result<Outputs, NodeError> {
    let scalp = &*inputs.scalp;
    let ties = ties(cx, &inputs)?;
    let domes: Vec<Arc<Dome>> =
        ties.iter().map(|tie| Dome::around(cx, scalp, tie)).collect::<Result<_, _>>()?;
    cx.check()?;
    let sections = scalp.sections().filter(|_| inputs.own_section);
    let even = EvenRoots::new(scalp, cx.dice(inputs.seed, "roots"));
    let skin = cx.skin(scalp);
    let mut gatherer = Gatherer {
        inputs: &inputs,
        scalp,
        detour: Detour::new(scalp, &skin),
        skin,
        unit: cx.unit(),
        even,
        ties: ties
            .iter()
            .zip(domes)
            .map(|(tie, dome)| Gathered::new(*tie, dome, scalp, inputs.own_section))
            .collect(),
        sections,
        keep: cx.dice(inputs.seed, "mask"),
        dice: cx.dice(inputs.seed, "gather"),
    };
    let given: Vec<(&Tuft, usize)> = inputs.roots.iter().flat_map(Curves::each).collect();
    gatherer.probe(&given)?;
    let count = match &inputs.roots {
        Some(_) => given.len(),
        None => {
            let wanted = f64::from(inputs.density) * gatherer.even.area();
            (wanted.round() as usize).min(MOST_HAIRS)
        }
    };
    let count = if ties.is_empty() { 0 } else { cx.makes(count) };
    let key = |i: usize| {
        let key =
            KeyBuilder::new("gather").int(i as u64).int(count.min((i + 1) * HAIRS_A_PIECE) as u64);
        let key = gatherer.ties.iter().fold(key, |key, t| {
            let key = key.vec3(t.tie.foot.point).vec3(t.tie.axis).int(t.tie.id);
            t.shares.iter().fold(key, |key, share| key.float(*share))
        });
        let part = given.get(i * HAIRS_A_PIECE..count.min((i + 1) * HAIRS_A_PIECE)).unwrap_or(&[]);
        part.iter().fold(key, |key, (tuft, c)| key.key(tuft.key()).int(*c as u64)).finish()
    };
    let size = Size::of(&[("hairs", count as f64), ("points", inputs.points as f64)]);
    let [curves] = cx.each_item(count.div_ceil(HAIRS_A_PIECE), &size, key, |i, piece| {
        let (from, to) = (i * HAIRS_A_PIECE, count.min((i + 1) * HAIRS_A_PIECE));
        let roots = match &inputs.roots {
            Some(_) => gatherer.given(&given[from..to], piece),
            None => gatherer.rooted(from as u32..to as u32)?,
        };
        Ok([gatherer.hair(&roots, given.get(from..to).unwrap_or(&[]), piece)?])
    })?;
    let tufts = |of: &dyn Fn(&Tie) -> Option<Tuft>| {
        Curves::new(ties.iter().filter_map(|tie| of(tie).map(Arc::new)).collect())
    };
    let band = |tie: &Tie| band(tie, inputs.band_turns, inputs.band_height, inputs.seed);
    Ok(Outputs { curves, ties: tufts(&|tie| Some(tie.curve())), bands: tufts(&band) })
}

fn ties(cx: &EvalCx, inputs: &Inputs) -> Result<Vec<Tie>, NodeError> {
    let (scalp, frame) = (&*inputs.scalp, inputs.scalp.frame());
    let mut feet: Vec<(Root, u64)> = vec![];
    match &inputs.placements {
        Some(placements) => feet.extend(super::placed(cx, scalp, placements, inputs.at)?),
        None => {
            let mut place = inputs.position;
            feet.extend(super::picked(scalp, place).map(|foot| (foot, 0)));
            place.x = -place.x;
            if inputs.mirror && place.x != 0.0 {
                feet.extend(super::picked(scalp, place).map(|foot| (foot, 1)));
            }
            if feet.is_empty() {
                return Err(NodeError::failed("the scalp has no surface to place a tie on"));
            }
        }
    }
    let tie = |(foot, parent): (Root, u64)| {
        let up = across(frame.up, foot.normal).unwrap_or_else(|| any_normal(foot.normal));
        let (sin, cos) = sin_cos(inputs.lean.to_radians());
        let axis = (foot.normal * cos + up * sin).normalize_or(foot.normal);
        let id = curve_id(parent, inputs.seed as u64, 0);
        Tie::new(id, foot, axis, frame.forward, inputs.height, inputs.radius)
    };
    Ok(feet.into_iter().map(tie).collect())
}

/// The lock wound around a tie: from the scalp under it to its top.
fn band(tie: &Tie, turns: f32, height: f32, seed: i64) -> Option<Tuft> {
    let wound = turns * if turns > 0.0 { 1.0 } else { 0.0 };
    let thick = 0.5 * height / turns.max(1.0);
    if wound <= 0.0 || height <= 0.0 {
        return None;
    }
    let steps = (turns * 16.0).ceil() as usize;
    let low = (tie.height - height).max(0.0) + thick;
    let mut points = vec![tie.foot.point];
    points.extend((0..=steps).map(|k| {
        let t = k as f32 / steps as f32;
        let (y, x) = sin_cos_turns(turns * t);
        let out = tie.right * x + tie.ahead() * y;
        let up = low + (tie.height - thick - low).max(0.0) * t;
        tie.foot.point + out * (tie.radius + 0.6 * thick) + tie.axis * up
    }));
    let mut b = TuftBuilder::new();
    b.push_curve(&points);
    b.set(ID, Domain::Curve, vec![curve_id(tie.id, seed as u64, 1 << 41)]);
    b.set(PARENT, Domain::Curve, vec![tie.id]);
    b.set(PUFF, Domain::Curve, vec![tie.id]);
    b.set(RADIUS, Domain::Curve, vec![thick]);
    b.set(NORMAL, Domain::Curve, vec![tie.axis]);
    b.set(SCALP_NORMAL, Domain::Curve, vec![tie.foot.normal]);
    b.set(ROOT_TRIANGLE, Domain::Curve, vec![tie.foot.triangle as i32]);
    b.set(ROOT_BARY, Domain::Curve, vec![tie.foot.bary]);
    Some(b.build())
}

/// Values of a column; a single one if they are all equal.
fn shared<T: PartialEq>(mut values: Vec<T>) -> Vec<T> {
    if values.windows(2).all(|w| w[0] == w[1]) {
        values.truncate(1);
    }
    values
}

/// A tie with the skin and the hair around it.
struct Gathered {
    tie: Tie,
    dome: Arc<Dome>,
    /// The section that it sits in, if only that one is gathered.
    section: Option<u32>,
    /// The sections that its ring stands over: their hair reaches it without crossing a parting.
    under: Vec<u32>,
    /// Fraction of the tie's hair rooted within each distance.
    shares: Vec<f32>,
    /// Thickness of the layer at a distance, times that distance, cm2.
    thickness: f32,
}

impl Gathered {
    fn new(tie: Tie, dome: Arc<Dome>, scalp: &Scalp, own: bool) -> Self {
        let (mut section, mut under) = (None, vec![]);
        if let Some(sections) = scalp.sections() {
            section = sections.of(&tie.foot).filter(|_| own);
            let about = (0..AROUND).map(|k| {
                let (y, x) = sin_cos_turns(k as f32 / AROUND as f32);
                tie.foot.point + (tie.right * x + tie.ahead() * y) * tie.radius
            });
            let about = about.filter_map(|p| scalp.closest_root(p));
            under = about.chain([tie.foot]).filter_map(|root| sections.of(&root)).collect();
            under.sort_unstable();
            under.dedup();
        }
        Self { tie, dome, section, under, shares: vec![0.0; SHARES + 1], thickness: 0.0 }
    }
    /// The fraction of the tie's hair rooted within a distance.
    #[inline]
    fn share(&self, distance: f32) -> f32 {
        let x = (distance * (1.0 / SHARE_STEP)).clamp(0.0, SHARES as f32 - 0.001);
        let (k, f) = (x as usize, x.fract());
        self.shares[k] + (self.shares[k + 1] - self.shares[k]) * f
    }
}

/// Why a root has no tie.
#[derive(Clone, Copy)]
enum Without {
    Section,
    Reach,
    Parting,
}

impl Without {
    /// For hair of the input `roots`.
    fn said(self) -> &'static str {
        match self {
            Self::Section => "hair whose section has no tie was left out (own_section)",
            Self::Reach => "hair out of reach of its tie was left out (reach)",
            Self::Parting => "hair on the parting between two ties was left out (parting)",
        }
    }
}

/// A root, its stable id and its tie.
#[derive(Clone, Copy)]
struct Rooted {
    id: u64,
    /// The curve that it is the hair of, by its number among those given.
    of: Option<u32>,
    root: Root,
    tie: usize,
    place: Polar,
}

struct Gatherer<'a> {
    inputs: &'a Inputs,
    scalp: &'a Scalp,
    skin: Skin<'a>,
    /// Centimetres per head unit.
    unit: f32,
    even: EvenRoots<'a>,
    detour: Detour<'a>,
    /// If ties gather only hair of their own section.
    sections: Option<&'a Sections>,
    ties: Vec<Gathered>,
    keep: Dice,
    dice: Dice,
}

impl Gatherer<'_> {
    /// Measures how hair is spread around each tie.
    fn probe(&mut self, given: &[(&Tuft, usize)]) -> Result<(), NodeError> {
        let distances: Vec<(usize, f32)> = if self.inputs.roots.is_some() {
            let every = given.len().div_ceil(PROBES as usize).max(1);
            let roots = given.iter().step_by(every).filter_map(|(tuft, i)| {
                let root = self.scalp.closest_root(*tuft.curve(*i).first()?)?;
                self.tie_of(&root).ok().map(|(tie, place)| (tie, place.distance))
            });
            roots.collect()
        } else {
            // Hair that only makes edges firm lies on top of the rest and counts as well.
            self.rooted(0..PROBES)?.iter().map(|r| (r.tie, r.place.distance)).collect()
        };
        let mut counts = vec![vec![0u32; SHARES]; self.ties.len()];
        for (tie, distance) in distances {
            counts[tie][((distance / SHARE_STEP) as usize).min(SHARES - 1)] += 1;
        }
        for (gathered, counts) in self.ties.iter_mut().zip(counts) {
            let all = counts.iter().sum::<u32>().max(1) as f32;
            let mut sum = 0;
            for (k, count) in counts.into_iter().enumerate() {
                sum += count;
                gathered.shares[k + 1] = sum as f32 / all;
            }
            let tie = &gathered.tie;
            // Never so thick that it would rise above the tie.
            let most = 1.2 * tie.height / tie.radius;
            gathered.thickness = 0.5 * tie.radius * tie.radius * self.inputs.volume.min(most);
        }
        Ok(())
    }

    /// Roots by index in the list of even roots.
    fn rooted(&self, which: std::ops::Range<u32>) -> Result<Vec<Rooted>, NodeError> {
        let found: Vec<(u64, Root)> = which.filter_map(|i| self.even.root(i)).collect();
        let mut b = TuftBuilder::even(found.iter().map(|(_, r)| r.point).collect(), 1);
        b.set(ROOT_TRIANGLE, Domain::Curve, found.iter().map(|(_, r)| r.triangle as i32).collect());
        b.set(ROOT_BARY, Domain::Curve, found.iter().map(|(_, r)| r.bary).collect());
        let tuft = b.build();
        let mask = self.inputs.mask.on(&tuft, Some(self.scalp))?;
        let mut out = Vec::with_capacity(found.len());
        for (slot, (name, root)) in found.into_iter().enumerate() {
            if self.keep.unit(name, 0) < mask.at(slot, slot, 0.0)
                && let Ok((tie, place)) = self.tie_of(&root)
            {
                let id = curve_id(self.ties[tie].tie.id, self.inputs.seed as u64, name);
                self.edge(id, &root, tie, &mut out);
                out.push(Rooted { id, of: None, root, tie, place });
            }
        }
        Ok(out)
    }

    /// Additional hairs beside one at an outer edge: where, slightly farther from its tie, hair of this tie no longer
    /// grows.
    fn edge(&self, id: u64, root: &Root, tie: usize, out: &mut Vec<Rooted>) {
        let (more, width) = (self.inputs.edge_density - 1.0, self.inputs.edge_width);
        if more <= 0.0 || width <= 0.0 {
            return;
        }
        let away = across(root.point - self.ties[tie].tie.foot.point, root.normal);
        let Some(away) = away else { return };
        let aside = root.normal.cross(away);
        let grows = |p: Vec3| {
            let hit = self.skin.closest(p)?;
            let root = self.scalp.root(hit.triangle, hit.bary);
            let region = self.scalp.grows(root.triangle, root.bary);
            let free = region > 0.5 && self.scalp.free(root.point);
            let (to, place) = if free { self.tie_of(&root).ok()? } else { return None };
            (to == tie).then_some((root, place))
        };
        // Straight away from the tie and to both sides of that: an edge may run along the hair.
        let ahead = |turn: f32| root.point + (away + aside * turn).normalize_or(away) * width;
        if [0.0, 1.0, -1.0].iter().all(|turn| grows(ahead(*turn)).is_some()) {
            return;
        }
        let wanted = more + self.dice.unit(id, 8);
        for k in 0..wanted as u64 {
            let near = |n| self.dice.signed(id, 16 + 2 * k + n) * 0.5 * width;
            if let Some((root, place)) = grows(root.point + away * near(0) + aside * near(1)) {
                let id = curve_id(id, self.inputs.seed as u64, k);
                out.push(Rooted { id, of: None, root, tie, place });
            }
        }
    }

    /// Roots of curves.
    fn given(&self, curves: &[(&Tuft, usize)], piece: &mut Piece) -> Vec<Rooted> {
        let mut out = Vec::with_capacity(curves.len());
        for (number, (tuft, i)) in (0..).zip(curves) {
            let of = Some(number);
            let at = tuft.curve(*i).first().copied().unwrap_or(Vec3::NAN);
            match self.scalp.closest_root(at) {
                Some(root) => match self.tie_of(&root) {
                    Ok((tie, place)) => out.push(Rooted { id: tuft.id(*i), of, root, tie, place }),
                    Err(without) => piece.remark(tuft.id(*i), without.said()),
                },
                None => piece.trouble(tuft.id(*i), "a curve without a root was left out"),
            }
        }
        out
    }

    /// The tie of a root, and its place about it.
    fn tie_of(&self, root: &Root) -> Result<(usize, Polar), Without> {
        let mut best: Option<(usize, Polar)> = None;
        let mut second: Option<(usize, Polar)> = None;
        let section = self.sections.map(|sections| sections.of(root));
        for (i, gathered) in self.ties.iter().enumerate() {
            if section.is_some_and(|section| section != gathered.section) {
                continue;
            }
            let place = gathered.dome.polar(root.point);
            if best.is_none_or(|(_, p)| place.distance < p.distance) {
                (best, second) = (Some((i, place)), best);
            } else if second.is_none_or(|(_, p)| place.distance < p.distance) {
                second = Some((i, place));
            }
        }
        let (tie, place) = best.ok_or(Without::Section)?;
        if self.inputs.reach > 0.0 && place.distance > self.inputs.reach {
            return Err(Without::Reach);
        }
        if let Some((other, farther)) = second {
            // How fast the difference of the two distances grows across the line where they are equal.
            let way = |i: usize| {
                across(self.ties[i].tie.foot.point - root.point, root.normal).unwrap_or(Vec3::ZERO)
            };
            let grows = (way(tie) - way(other)).length();
            if farther.distance - place.distance < 0.5 * self.inputs.parting * grows {
                return Err(Without::Parting);
            }
        }
        Ok((tie, place))
    }

    /// Hair of these roots, which those of the `given` curves may be among.
    fn hair(
        &self,
        roots: &[Rooted],
        given: &[(&Tuft, usize)],
        piece: &mut Piece,
    ) -> Result<Tuft, NodeError> {
        let each = self.inputs.points as usize;
        let mut points = Vec::with_capacity(roots.len() * each);
        let mut lengths = Vec::with_capacity(roots.len());
        let mut way = Vec::with_capacity(SAMPLES + 1);
        let mut kept = Vec::with_capacity(roots.len());
        for rooted in roots {
            piece.tick()?;
            let first = points.len();
            self.comb(rooted, &mut way, &mut points);
            self.evened(&mut points[first..]);
            let home = self.sections.and_then(|_| self.scalp.home_of(&rooted.root));
            let crosses = |home: Home| points[first..].windows(2).any(|w| home.crosses(w[0], w[1]));
            if home.is_some_and(crosses) {
                points.truncate(first);
                let why = "a hair whose way to its tie crosses a parting was left out";
                piece.trouble(rooted.id, why);
                continue;
            }
            if self.sections.is_none()
                && let Some(sections) = self.scalp.sections()
                && sections.is_over_line(&points[first..])
            {
                piece.trouble(rooted.id, OVER);
            }
            kept.push(*rooted);
            let length = points[first..].windows(2).map(|w: &[Vec3]| w[0].distance(w[1])).sum();
            lengths.push(length);
        }
        fn column<T>(roots: &[Rooted], of: impl Fn(&Rooted) -> T) -> Vec<T> {
            roots.iter().map(of).collect()
        }
        let roots = &kept[..];
        let mut b = TuftBuilder::even(points, each);
        let tie = |rooted: &Rooted| self.ties[rooted.tie].tie.id;
        b.set(ID, Domain::Curve, column(roots, |r| r.id));
        b.set(PARENT, Domain::Curve, column(roots, tie));
        b.set(PUFF, Domain::Curve, column(roots, tie));
        // Stored so that the file alone shows whether hair passes through its tie.
        b.set(TIE, Domain::Curve, shared(column(roots, |r| self.ties[r.tie].tie.top())));
        b.set(TIE_RADIUS, Domain::Curve, shared(column(roots, |r| self.ties[r.tie].tie.radius)));
        b.set(ROOT_TRIANGLE, Domain::Curve, column(roots, |r| r.root.triangle as i32));
        b.set(ROOT_BARY, Domain::Curve, column(roots, |r| r.root.bary));
        if self.scalp.uvs().is_some() {
            b.set(ROOT_UV, Domain::Curve, column(roots, |r| r.root.uv));
        }
        b.set(SCALP_NORMAL, Domain::Curve, column(roots, |r| r.root.normal));
        if let Some(sections) = self.scalp.sections() {
            let id = |r: &Rooted| sections.id_at(r.root.point).unwrap_or(0);
            b.set(SECTION, Domain::Curve, column(roots, id));
        }
        b.set(FIBRE, Domain::Curve, lengths);
        b.set(WIDTH, Domain::Curve, vec![self.inputs.width]);
        let links: Vec<[(u32, f32); 1]> =
            roots.iter().map(|rooted| [(rooted.of.unwrap_or_default(), 1.0)]).collect();
        let lineage = Lineage {
            parent: &|number| given[number as usize],
            of: &|hair| &links[hair][..given.len().min(1)],
            places: &|number| {
                let (tuft, i) = given[number as usize];
                evenly(tuft.curve(i), each)
            },
            // Combed anew, it faces elsewhere.
            takes: &|name| name != NORMAL.name && !OF_CLUSTERS.contains(&name),
        };
        lineage.pass_on(&mut b);
        Ok(b.build())
    }

    /// A hair's path into its tie. Along a line of constant bearing, `x` is the distance over the skin and `z` the
    /// height above it: z = layer(x) + c / (x - a), a hyperbola that runs along the skin and turns up along the tie.
    fn comb(&self, rooted: &Rooted, way: &mut Vec<(f32, f32, f32)>, points: &mut Vec<Vec3>) {
        let gathered = &self.ties[rooted.tie];
        let (tie, dome) = (&gathered.tie, &*gathered.dome);
        let from = rooted.place.distance.max(1e-3);
        let share = gathered.share(from);
        let ring = (tie.radius * share.sqrt()).min(0.9 * from);
        let clearance = self.inputs.clearance;
        let layer = |x: f32| {
            let over = (share - gathered.share(x)).max(0.0);
            gathered.thickness * over / x.max(tie.radius)
                + clearance * ((from - x) * 2.0).clamp(0.0, 1.0)
        };
        let room = tie.height - layer(ring);
        let bend = (0.15 + (1.0 - self.inputs.tightness) * 1.2) * self.unit;
        let gap = (bend * bend / room.max(0.05)).min(0.9 * (from - ring)).max(1e-4);
        let (a, far) = (ring - gap, from - ring + gap);
        let share_left = gap / far;
        way.clear();
        let mut length = 0.0;
        for k in 0..=SAMPLES {
            let t = k as f32 / SAMPLES as f32;
            // Even steps far away, decreasing toward the bend.
            let even = far + (gap - far) * t;
            let bent = far * gap / (gap + (far - gap) * t);
            let x = a + even + (bent - even) * t;
            let rise = (gap / (x - a) - share_left) / (1.0 - share_left).max(1e-6);
            let z = layer(x) + room * rise.clamp(0.0, 1.0);
            if let Some((_, x0, z0)) = way.last() {
                length += ((x - x0) * (x - x0) + (z - z0) * (z - z0)).sqrt();
            }
            way.push((length, x, z));
        }
        let last = self.inputs.points as usize - 1;
        let id = rooted.id;
        let dice = self.dice;
        let wander = self.inputs.wander;
        let (sway, turn) = (dice.signed(id, 0) * wander, dice.signed(id, 1) * wander);
        let strays = dice.unit(id, 2) < self.inputs.stray;
        let stray = if strays { dice.unit(id, 3) * self.inputs.stray_height } else { 0.0 };
        let (y, x) = sin_cos_turns(rooted.place.bearing);
        let out = tie.right * x + tie.ahead() * y;
        let side = out.cross(tie.axis);
        // The table is slightly off at the root: the difference fades out along the hair.
        let off = rooted.root.point - dome.at(rooted.place).0;
        // Hair of a section that its tie stands over does not cross another section.
        let home = self.home(rooted);
        let mut k = 1;
        let from_here = points.len();
        points.push(rooted.root.point);
        for n in 1..=last {
            let u = n as f32 / last as f32;
            let s = length * u;
            while k < SAMPLES && way[k].0 < s {
                k += 1;
            }
            let ((s0, x0, z0), (s1, x1, z1)) = (way[k - 1], way[k]);
            let f = if s1 > s0 { ((s - s0) / (s1 - s0)).clamp(0.0, 1.0) } else { 1.0 };
            let (x, z) = (x0 + (x1 - x0) * f, z0 + (z1 - z0) * f);
            let (skin, normal) = dome.at(Polar { distance: x, ..rooted.place });
            let rest = 1.0 - u;
            let mut z = z;
            if stray > 0.0 {
                z += stray * sin(PI * u * u.sqrt());
            }
            // Over the tie, heights are measured along its axis; elsewhere along the skin's normal.
            let near = 1.0 - ((x - tie.radius) / (2.0 * tie.radius)).clamp(0.0, 1.0);
            let near = smoothstep(near);
            let up = normal.lerp(tie.axis, near).normalize_or(normal);
            let mut p = skin + up * z;
            let in_tie = tie.foot.point + out * x + tie.axis * z;
            let held = (z / tie.height).clamp(0.0, 1.0);
            let held = held * held * near;
            p = p.lerp(in_tie, held * held);
            let aside = 4.0 * u * rest * (sway + turn * (1.0 - 2.0 * u) * 1.5);
            let across = if near < 1.0 { up.cross(way_of(skin, tie)) } else { side };
            p += across * aside + off * (rest * rest * rest);
            points.push(p);
        }
        let hair = &mut points[from_here..];
        if let Some(home) = home {
            // Points that would have to move far are over an ear, or are dropped.
            let far = FAR_OFF * self.unit;
            let near = |_, p: Vec3, kept: Vec3| if kept.distance(p) < far { kept } else { p };
            home.lead(hair.iter_mut().enumerate().skip(1), rooted.root.triangle, near);
        }
        let whole = 1..hair.len();
        lift_each(&self.skin, hair, whole, |_| 0.0);
        self.past_ears(&mut points[from_here..]);
        if let Some(end) = points.last_mut() {
            // The ring of a tilted tie may dip into the head.
            *end = self.clear(tie.foot.point + out * ring + tie.axis * tie.height);
        }
    }

    /// The section that a hair stays in along its path.
    fn home(&self, rooted: &Rooted) -> Option<Home<'_>> {
        let number = self.scalp.sections()?.of(&rooted.root)?;
        let stands = self.ties[rooted.tie].under.contains(&number);
        (self.inputs.own_section || stands).then(|| self.scalp.home(rooted.root.point)).flatten()
    }

    /// Where a hair would cross an ear, it runs straight to the point past it, and around what is in between.
    fn past_ears(&self, hair: &mut [Vec3]) {
        let Some(over) = hair.iter().skip(1).rposition(|p| !self.detour.is_free(*p)) else {
            return;
        };
        let past = (over + 3).min(hair.len() - 1);
        let (root, to) = (hair[0], hair[past]);
        let middle = self.scalp.frame().origin;
        let (near, far) = (root.distance(middle), to.distance(middle));
        for (k, p) in hair.iter_mut().enumerate().take(past).skip(1) {
            let t = k as f32 / past as f32;
            let way = (root.lerp(to, t) - middle).normalize_or(root - middle);
            *p = middle + way * (near + (far - near) * t);
        }
        self.detour.reroute(&mut hair[..=past], Towards::Top);
        lift_each(&self.skin, hair, 1..past, |_| 0.0);
    }

    /// Other programs would read a hair with points made uneven by folds as a different curve: it gets even points
    /// before it is tested.
    fn evened(&self, hair: &mut [Vec3]) {
        let last = hair.len() - 1;
        if readings_differ(hair) <= AGREE {
            return;
        }
        let Ok(spline) = Spline::new(hair) else { return };
        let ends = (hair[0], hair[last]);
        let mut k = 0;
        spline.resample(last + 1, |p| {
            hair[k] = if k > 0 && k < last { self.clear(p) } else { p };
            k += 1;
        });
        (hair[0], hair[last]) = ends;
    }

    /// `p`, moved out of the skin.
    #[inline]
    fn clear(&self, p: Vec3) -> Vec3 {
        lift(&self.skin, p, 0.0).0
    }
}

/// Direction from the tie's foot to a point, unit.
#[inline]
fn way_of(p: Vec3, tie: &Tie) -> Vec3 {
    (p - tie.foot.point).normalize_or(tie.right)
}
