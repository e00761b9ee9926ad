//! Edge partition: the hairs between rows of braids, pulled from the parting into the braid.
//!
//! methods.md 3, after section 2.2 of the braids-and-curls talk ("Lightyear"). Rows and their territories are in
//! `scalp/territory.rs`, the single hair in `parting_hair.rs`.
//!
//! Guarantees: roots lie on the scalp and are bound to it; ends lie within the braid's radius around its row; hairs
//! stay out of the skin; ends of a group lie within the group's radius. Without `cross_partings`, every root stays half
//! a parting's width away from the parting and no hair crosses it, whether it is halfway between two rows or a parting
//! of the scalp. A row's hairs depend on that row and its neighbours only (on a parted scalp, those of its own section),
//! so that editing one row recomputes its own hairs and those of its neighbours. Not promised: that hairs of one row
//! never overlap, since combed hair does.

use super::parting_hair::{
    self, Middle, PartingHairParams, Reach, RowSection, RowTerritory, Rules,
};
use crate::data::attribute_transfer::{CvPlace, Lineage, own_parents, place_of};
use crate::data::attributes::{
    ALONG, BRAID, Domain, GROUP, ID, OF_CLUSTERS, PARENT, RADIUS, SCALP_NORMAL, SECTION, SIDE,
    WIDTH,
};
use crate::data::curves::{Curves, Tuft, TuftBuilder};
use crate::data::field::Field;
use crate::data::ramp::Ramp;
use crate::data::scalp::{Root, Scalp};
use crate::define::{FieldInput, KnownInputs, NodeError, choice, node, unless};
use crate::eval::{EvalCx, Piece, Size};
use crate::maths::hash::{Dice, curve_id};
use crate::maths::low_discrepancy::r2;
use crate::scalp::lay;
use crate::scalp::territory::{Overs, Row, Station, neighbour};
use glam::Vec3;
use std::cell::Cell;
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

node! {
    /// Hair pulled from the partings into braids: the combed hair between cornrows.
    ///
    /// Wire the rows that the braids follow. The parting lies halfway between neighbouring rows; hairs are rooted there
    /// and combed over the scalp into the braid, evenly or gathered at each stitch. On a parted scalp (node Partings),
    /// only rows of the same section are neighbours, and hairs stay inside the section.
    "edge_partition", version 1, label "Edge partition", words "parting part side middle hairs section cornrow canerow braid edge guide partition segments pulled comb line", thins, scales,
        refuses(ungrouped);
    inputs {
        /// The rows, root first: the same curves that the braids follow.
        source: Curves, words("rows braids guides");
        /// The head.
        scalp: Arc<Scalp>;
        /// Neighbours to part the rows from. By default, the other rows of the source.
        adjacent: Option<Curves>, words("neighbours adjacent");
        /// Neighbours on the left of the rows (seen along them from outside the head), instead of detected ones.
        left: Option<Curves>, words("adjacent");
        /// Neighbours on the right of the rows, instead of detected ones.
        right: Option<Curves>, words("adjacent");
        /// Stitches from the braid node, for grouping by stitches.
        stitches: Option<Curves>, words("knots");
        /// Curves whose roots mark where hairs gather along the nearest row, for grouping by picked points.
        picked: Option<Curves>, words("points centroids");
        /// Set the number of hairs per centimetre of row, or per row.
        by: By = By::PerCm;
        /// Hairs per centimetre of row, on each side.
        per_cm: f32 = 80.0, hard(0.0, 2000.0), soft(1.0, 200.0), unit(PerCm), words("density count amount"),
            idle(|of| unless(of, "by", "per_cm", "the number is that of a whole row"));
        /// Hairs per row, both sides together.
        total: i64 = 1000, hard(0.0, 1000000.0), soft(10.0, 5000.0), unit(Count), words("count amount"),
            idle(|of| unless(of, "by", "total", "the number is that of a centimetre"));
        /// Where hairs are rooted between their row and its neighbour: 0 at the row, 50% halfway, at the parting, 100%
        /// at the neighbour. Varies along the row.
        mediate: FieldInput = 0.5, hard(0.0, 1.0), unit(Ratio), words("mediate midpoint length position");
        /// Diameter of a hair. A ramp runs from root to end.
        width: FieldInput = 0.008, hard(0.0001, 1.0), soft(0.002, 0.02), unit(Length), fixed(), words("thickness diameter");

        [Placement]
        /// Let roots and hairs cross the partings. Off keeps every hair in its row's territory.
        cross_partings: bool = false, words("overlap territory");
        /// Width of the bare skin along a parting. Roots stay half of it away from the middle.
        parting_width: f32 = 0.15, hard(0.0, 5.0), soft(0.0, 0.6), unit(Length), words("gap line skin");
        /// Largest distance to a neighbour. A row without a neighbour on one side is open there.
        reach: f32 = 6.0, hard(0.01, 100.0), soft(1.0, 15.0), unit(Length), words("distance neighbour search");
        /// Width of the territory on an open side, measured from the row; it also ends where hair stops growing. 0
        /// leaves that side bare.
        open_side: f32 = 1.0, hard(0.0, 50.0), soft(0.0, 4.0), unit(Length), words("outermost hairline edge");
        /// How far in front of the row's root hairs are rooted and swept back into the start of the braid, where hair
        /// grows.
        lead: f32 = 0.6, hard(0.0, 20.0), soft(0.0, 3.0), unit(Length), words("front hairline start");

        [Shape]
        /// Height of the hairs above the scalp at their midpoint. Varies along the row.
        lift: FieldInput = 0.04, hard(0.0, 10.0), soft(0.0, 0.5), unit(Length), handle(Handle::Length), words("height loose puff");
        /// Angle at which hairs are combed along the braid: 0 is square to the row, 80 nearly along it, negative
        /// against it. Varies along the row.
        pull_angle: FieldInput = 50.0, hard(-80.0, 80.0), unit(Angle), handle(Handle::Angle), words("sweep oblique comb direction");
        /// How hairs turn into the braid: 0 is straight from root to end, 100% leaves the parting square and ends along
        /// the braid.
        sweep: f32 = 0.5, hard(0.0, 1.0), unit(Ratio), words("curve bend comb");
        /// Radius of the braid that the hairs end in. Varies along the row; by default, the rows' own radius.
        row_radius: FieldInput = Field::Attribute(RADIUS.name.to_owned()), hard(0.001, 50.0), soft(0.1, 2.0), unit(Length), handle(Handle::Radius), words("braid size envelope");
        /// How far below the braid's surface the hairs end, to hide the ends.
        tuck: f32 = 0.1, hard(0.0, 10.0), soft(0.0, 0.5), unit(Length), words("hide depth inside");

        [Clumping]
        /// Spread the hair ends along the braid, or gather them.
        grouping: Grouping = Grouping::None, words("clump stitch knot gather");
        /// Hairs per group, when grouping by a fixed count.
        every: i64 = 20, hard(1.0, 100000.0), soft(2.0, 200.0), unit(Count), words("k"),
            idle(|of| unless(of, "grouping", "every_k", "hairs are not grouped by number"));
        /// Distance of hair ends from the centre of their group.
        group_radius: f32 = 0.1, hard(0.0, 10.0), soft(0.0, 0.5), unit(Length), handle(Handle::Radius), words("clump spread"),
            idle(|of| matches!(of("grouping"), Some(Value::Text(is)) if *is == *"none").then_some("hairs are not grouped"));
        /// How tightly a group is drawn together, from root to end: 0 meets only at the end, 1 runs as one lock.
        tightness: Arc<Ramp> = Ramp::linear(0.0, 0.7), words("clump profile gather"),
            idle(|of| matches!(of("grouping"), Some(Value::Text(is)) if *is == *"none").then_some("hairs are not grouped"));

        [Detail]
        /// CVs per hair, root and end included.
        cvs: i64 = 10, hard(4.0, 64.0), soft(6.0, 24.0), unit(Count), words("points resolution");
        /// Scale lengths with the size of the head. The number of hairs and their widths stay.
        scale_with_head: bool = true, words("head units");

        [Randomness]
        /// Random scatter of roots from the parting back toward the row: 0 is a single line, 100% the whole way.
        jitter: f32 = 0.3, hard(0.0, 1.0), unit(Ratio), words("random scatter");
        /// Random variation in angle, lift and position around the braid.
        unevenness: f32 = 0.3, hard(0.0, 1.0), unit(Ratio), words("random variation natural messy");
        /// Random seed for this node. It changes ids too.
        seed: i64 = 0;
    }
    outputs {
        /// The hairs, one tuft per row, rooted in the scalp, with their row, side, group and the position along the row
        /// where they end.
        curves: Curves;
    }
}

choice! {
    /// How the number of hairs is set.
    By {
        /// Per centimetre of row and side.
        PerCm = "per_cm",
        /// Per row.
        Total = "total",
    }
}

choice! {
    /// Spread the hair ends along the braid, or gather them.
    Grouping {
        /// Spread evenly.
        None = "none",
        /// At the nearest stitch of the braid on their side.
        Stitches = "stitches",
        /// At the nearest picked point.
        Picked = "picked",
        /// In groups of a fixed count, evenly spaced.
        EveryK = "every_k",
    }
}

/// Role of a curve for a row, as an attribute of the tufts passed to work items.
const ROLE: &str = "role";
const BESIDE: i32 = 0;
const LEFT: i32 = 1;
const RIGHT: i32 = 2;
const STITCHES: i32 = 3;
const PICKED: i32 = 4;

/// Spacing of the positions along a row at which neighbours are searched, cm: less than the thickness of a braid, so
/// that none is missed.
const LOOK: f32 = 0.4;

/// A grouping by curves that are not wired.
fn ungrouped(told: &KnownInputs) -> Result<(), NodeError> {
    // Each grouping by curves has the name of their input.
    let by = ["stitches", "picked"];
    match by.into_iter().find(|by| told.is("grouping", by) && !told.arrives(by)) {
        Some(input) => Err(NodeError::Unconnected { input, expected: "curves" }),
        None => Ok(()),
    }
}

fn eval(cx: &EvalCx, inputs: Inputs) -> Result<Outputs, NodeError> {
    let scalp = &*inputs.scalp;
    let skin = cx.skin(scalp);
    let rules = Rules {
        scalp,
        skin,
        for_hair: skin.for_hair(),
        crossing: inputs.cross_partings,
        parting: inputs.parting_width,
        reach: inputs.reach,
        open_side: inputs.open_side,
        sweep: inputs.sweep,
        tuck: inputs.tuck,
        group_radius: inputs.group_radius,
        tightness: &inputs.tightness,
        cvs: inputs.cvs as usize,
        clear: CLEAR * cx.unit(),
    };
    let others = inputs.adjacent.as_ref().unwrap_or(&inputs.source);
    let lists = [
        (BESIDE, Some(others)),
        (LEFT, inputs.left.as_ref()),
        (RIGHT, inputs.right.as_ref()),
        (STITCHES, inputs.stitches.as_ref().filter(|_| inputs.grouping == Grouping::Stitches)),
        (PICKED, inputs.picked.as_ref().filter(|_| inputs.grouping == Grouping::Picked)),
    ];
    let mut all = vec![];
    for (role, list) in lists {
        for tuft in list.iter().flat_map(|list| list.tufts()) {
            let mut marked = tuft.edit();
            marked.set_named(ROLE.into(), Domain::Curve, vec![role]);
            all.push(Arc::new(marked.build()));
        }
    }
    let all = Curves::new(all);
    // Halfway to the farthest neighbour, and as much again for paths longer than the straight one.
    let reach = rules.reach.max(2.0 * rules.open_side).max(2.0 * inputs.lead);
    let rows = if rules.crossing { 0 } else { inputs.source.curve_count() + all.curve_count() };
    let overs = Overs::new(scalp, rows, reach);
    let rows = inputs.source.tufts().iter().flat_map(|tuft| rows_of(tuft));
    let all_hairs: usize = rows.map(|row| cx.makes(requested(&inputs, &row))).sum();
    let cvs = inputs.cvs as f64;
    cx.may_make(&Size::of(&[("hairs beside all rows", all_hairs as f64), ("cvs", cvs)]))?;
    let map = Map::new(cx, &inputs, &rules, &overs, &all)?;
    let needs = |i: usize, tuft: &Tuft| map.needs(&rules, &overs, inputs.lead, i, tuft);
    let [curves] = cx.each_tuft_with(&inputs.source, &all, needs, |tuft, read, piece| {
        Ok([hairs(cx, &inputs, &rules, &overs, tuft, read, piece)?])
    })?;
    Ok(Outputs { curves })
}

/// Smallest height of hairs above the skin, cm on a head of average size: more than a hair's radius, and enough that a
/// head's flat triangles do not cut through.
const CLEAR: f32 = 0.012;

/// A row in the list of all rows.
struct Known {
    /// Index of its tuft.
    tuft: usize,
    role: i32,
    row: Row,
    section: Option<u32>,
}

/// Positions of everything, for finding what each row must read.
struct Map {
    rows: Vec<Known>,
    /// Index of the tuft, and the source curves of the braids that its stitches belong to.
    stitches: Vec<(usize, Vec<u64>)>,
    /// Index of the tuft, and the source tufts whose rows are nearest to its points.
    picked: Vec<(usize, Vec<usize>)>,
    /// Whether the list begins with the source's own tufts.
    among_themselves: bool,
}

impl Map {
    fn new(
        cx: &EvalCx,
        inputs: &Inputs,
        rules: &Rules,
        overs: &Overs,
        all: &Curves,
    ) -> Result<Self, NodeError> {
        let sources: Vec<(usize, Row)> = inputs
            .source
            .tufts()
            .iter()
            .enumerate()
            .flat_map(|(i, tuft)| rows_of(tuft).map(move |row| (i, overs.give(row))))
            .collect();
        let (mut rows, mut stitches, mut picked) = (vec![], vec![], vec![]);
        for (n, tuft) in all.tufts().iter().enumerate() {
            cx.check()?;
            match role(tuft) {
                STITCHES => {
                    stitches.push((n, (0..tuft.len()).map(|i| braided(tuft, i)).collect()));
                }
                PICKED => {
                    let nearest = |p: Vec3| {
                        let far = |row: &Row| row.far(rules.scalp, p, row.nearest(p).1);
                        let by =
                            |a: &&(usize, Row), b: &&(usize, Row)| far(&a.1).total_cmp(&far(&b.1));
                        sources.iter().min_by(by).map(|(i, _)| *i)
                    };
                    let points = (0..tuft.len()).map(|i| tuft.curve(i)[0]);
                    picked.push((n, points.filter_map(nearest).collect()));
                }
                role => rows.extend(rows_of(tuft).map(|row| {
                    let section = own_section(rules, &row).map(|home| home.number);
                    Known { tuft: n, role, row, section }
                })),
            }
        }
        Ok(Self { rows, stitches, picked, among_themselves: inputs.adjacent.is_none() })
    }

    /// Indices of the tufts that a row's hairs depend on, ascending.
    fn needs(&self, rules: &Rules, overs: &Overs, lead: f32, own: usize, tuft: &Tuft) -> Vec<u32> {
        let is_self = |n: usize| self.among_themselves && n == own;
        let given = |role: i32| self.rows.iter().any(|known| known.role == role);
        let mut needed = BTreeSet::new();
        for row in rows_of(tuft).map(|row| overs.give(row)) {
            let section = own_section(rules, &row).map(|home| home.number);
            let others = || {
                let others = self.rows.iter().enumerate();
                others.filter(|(_, other)| !is_self(other.tuft) && other.section == section)
            };
            let lead = lead / row.length();
            let looks = (row.length() * (1.0 + lead) / LOOK).ceil().clamp(4.0, 512.0) as usize;
            for k in 0..=looks {
                let u = (1.0 + lead) * k as f32 / looks as f32 - lead;
                let station = Station::new(&row, rules.scalp, u);
                for (side, list) in [(-1, LEFT), (1, RIGHT)] {
                    let list = if given(list) { list } else { BESIDE };
                    let rows = others().filter(|(_, other)| other.role == list);
                    let rows = rows.map(|(i, other)| (i, &other.row));
                    let met = neighbour(&station, side, rows, rules.reach);
                    needed.extend(met.map(|(i, _)| self.rows[i].tuft));
                    // Rows that are not beside this position but take part of its territory, such as one that begins
                    // where this one ends.
                    let to = met.map_or(station.side(side) * (2.0 * rules.open_side), |(_, q)| {
                        q - station.point
                    });
                    let middle = station.point + to * 0.5;
                    // No path to the others is shorter than the straight one.
                    let way = row.far(rules.scalp, middle, row.nearest(middle).1);
                    let home = 1.1 * way.max(middle.distance(station.point)) + rules.parting;
                    for (_, other) in others() {
                        if other.row.distance_under(middle, home) < home {
                            needed.insert(other.tuft);
                        }
                    }
                }
            }
        }
        for i in 0..tuft.len() {
            let id = tuft.id(i);
            needed.extend(self.stitches.iter().filter(|(_, of)| of.contains(&id)).map(|s| s.0));
        }
        needed.extend(self.picked.iter().filter(|(_, near)| near.contains(&own)).map(|p| p.0));
        needed.into_iter().filter(|n| !is_self(*n)).map(|n| n as u32).collect()
    }
}

fn rows_of(tuft: &Tuft) -> impl Iterator<Item = Row> {
    (0..tuft.len()).filter_map(|i| Row::new(tuft.id(i), tuft.curve(i)).ok())
}

fn role(tuft: &Tuft) -> i32 {
    tuft.view_named::<i32>(ROLE).map_or(BESIDE, |view| view.at(0, 0))
}

/// Id of the curve that the braid of a stitch curve follows.
fn braided(tuft: &Tuft, curve: usize) -> u64 {
    let root = tuft.range(curve).start;
    match tuft.view(PARENT).at(curve, root) {
        0 => tuft.view(BRAID).at(curve, root),
        parent => parent,
    }
}

/// Where hairs of a row gather.
struct Gather {
    /// Fraction along the row, side (0: both), index.
    places: Vec<(f32, i32, i32)>,
}

impl Gather {
    /// The gathering point nearest to `u` on a side.
    fn nearest(&self, u: f32, side: i32) -> Option<(f32, i32)> {
        let on_side = self.places.iter().filter(|(_, s, _)| *s == side || *s == 0);
        on_side
            .min_by(|a, b| (a.0 - u).abs().total_cmp(&(b.0 - u).abs()))
            .map(|(at, _, number)| (*at, *number))
    }
}

/// The hairs of the rows of one tuft.
fn hairs(
    cx: &EvalCx,
    inputs: &Inputs,
    rules: &Rules,
    overs: &Overs,
    tuft: &Tuft,
    read: &[&Tuft],
    piece: &mut Piece,
) -> Result<Tuft, NodeError> {
    let mut made = Made::default();
    let over = |row: Row| overs.give(row);
    let rows: Vec<Row> = rows_of(tuft).map(over).collect();
    let of_role = |wanted: i32| -> Vec<Row> {
        read.iter().filter(|t| role(t) == wanted).flat_map(|t| rows_of(t)).map(over).collect()
    };
    let [beside, left, right] = [BESIDE, LEFT, RIGHT].map(of_role);
    for i in 0..tuft.len() {
        let own = match Row::new(tuft.id(i), tuft.curve(i)) {
            Ok(row) => over(row),
            Err(fault) => {
                piece.trouble(tuft.id(i), fault);
                continue;
            }
        };
        // Rows of one tuft are neighbours too.
        let siblings: Vec<&Row> = match inputs.adjacent {
            None => rows.iter().filter(|row| row.id != own.id).collect(),
            Some(_) => vec![],
        };
        let section_of_own = own_section(rules, &own);
        let section = section_of_own.map(|home| home.number);
        let shares = |row: &&Row| own_section(rules, row).map(|home| home.number) == section;
        let free: Vec<&Row> = beside.iter().chain(siblings).filter(shares).collect();
        let of_side = |wired: &Option<Curves>, rows| match wired {
            Some(_) => rows,
            None => free.clone(),
        };
        let ground = RowTerritory {
            scalp: rules.scalp,
            left: of_side(&inputs.left, left.iter().filter(shares).collect()),
            right: of_side(&inputs.right, right.iter().filter(shares).collect()),
            own: &own,
            section: section_of_own,
            near: Cell::new(0),
        };
        row_hairs(cx, inputs, rules, (tuft, i), &ground, read, &mut made, piece)?;
    }
    made.tuft(tuft, inputs)
}

/// The section that most of a row lies in; `None` if hairs may cross, or if nothing is parted.
fn own_section<'a>(rules: &Rules<'a>, row: &Row) -> Option<RowSection<'a>> {
    let sections = rules.scalp.sections().filter(|_| !rules.crossing)?;
    let mut votes: BTreeMap<u32, u32> = BTreeMap::new();
    for k in 1..16 {
        let at = sections.at(row.spline.at(k as f32 / 16.0));
        at.into_iter().for_each(|at| *votes.entry(at.section).or_default() += 1);
    }
    let (number, _) = votes.into_iter().rev().max_by_key(|(_, votes)| *votes)?;
    Some(RowSection { sections, number })
}

/// Hairs under construction.
#[derive(Default)]
struct Made {
    hair: TuftBuilder,
    /// The row of each, and the place there that it runs to.
    from: Vec<(usize, CvPlace)>,
    ids: Vec<u64>,
    rows: Vec<u64>,
    braids: Vec<u64>,
    sides: Vec<i32>,
    groups: Vec<i32>,
    ends: Vec<f32>,
    roots: Vec<Root>,
}

impl Made {
    fn tuft(self, rows: &Tuft, inputs: &Inputs) -> Result<Tuft, NodeError> {
        let mut hair = self.hair;
        if hair.is_empty() {
            return Ok(hair.build());
        }
        hair.set(ID, Domain::Curve, self.ids);
        hair.set(PARENT, Domain::Curve, self.rows);
        hair.set(BRAID, Domain::Curve, self.braids);
        hair.set(SIDE, Domain::Curve, self.sides);
        hair.set(ALONG, Domain::Curve, self.ends);
        if inputs.grouping != Grouping::None {
            hair.set(GROUP, Domain::Curve, self.groups);
        }
        let normals = self.roots.iter().map(|root| root.normal).collect();
        hair.set(SCALP_NORMAL, Domain::Curve, normals);
        lay::bind(&mut hair, &self.roots);
        if let Some(sections) = inputs.scalp.sections() {
            let id = |root: &Root| sections.id_of(root).unwrap_or_default();
            hair.set(SECTION, Domain::Curve, self.roots.iter().map(id).collect());
        }
        let own = own_parents(hair.len());
        let lineage = Lineage {
            parent: &|i| (rows, self.from[i as usize].0),
            of: &|i| &own[i],
            places: &|i| vec![self.from[i as usize].1],
            takes: &|name| name != WIDTH.name && !OF_CLUSTERS.contains(&name),
        };
        lineage.pass_on(&mut hair);
        let hair = hair.build();
        let width = inputs.width.on(&hair, Some(&inputs.scalp))?;
        let (mut edit, cvs) = (hair.edit(), inputs.cvs as usize);
        match inputs.width.constant() {
            Some(width) => edit.set(WIDTH, Domain::Curve, vec![width]),
            None => {
                let at = |p: usize| width.at(p / cvs, p, (p % cvs) as f32 / (cvs - 1) as f32);
                edit.set(WIDTH, Domain::Point, (0..hair.points().len()).map(at).collect());
            }
        }
        Ok(edit.build())
    }
}

/// Requested number of hairs of a row.
fn requested(inputs: &Inputs, row: &Row) -> usize {
    let lead = inputs.lead / row.length();
    let a_side = match inputs.by {
        By::PerCm => inputs.per_cm * row.length() * (1.0 + lead),
        By::Total => inputs.total as f32 * 0.5,
    };
    2 * (a_side.round() as usize).min(500_000)
}

fn row_hairs(
    cx: &EvalCx,
    inputs: &Inputs,
    rules: &Rules,
    (tuft, curve): (&Tuft, usize),
    ground: &RowTerritory,
    read: &[&Tuft],
    made: &mut Made,
    piece: &mut Piece,
) -> Result<(), NodeError> {
    let row = ground.own;
    let scalp = Some(&*inputs.scalp);
    let mediate = inputs.mediate.on(tuft, scalp)?;
    let lift = inputs.lift.on(tuft, scalp)?;
    let pull = inputs.pull_angle.on(tuft, scalp)?;
    let radius = inputs.row_radius.on(tuft, scalp)?;
    let radius_at = |u: f32| radius.along(tuft, curve, u);

    let lead = inputs.lead / row.length();
    let count = requested(inputs, row);
    let gather = gather(inputs, ground, count / 2, read);
    let dice = cx.dice(inputs.seed, "edge");
    let braid = braid_id(tuft, curve, row, read);
    let reach = Reach::new(rules, ground, lead);
    let before = made.ids.len();
    let mut points = vec![];
    let mut middles: BTreeMap<i32, Option<Middle>> = BTreeMap::new();
    for k in 0..cx.thinned(count) {
        piece.tick()?;
        let side = if k % 2 == 0 { -1 } else { 1 };
        let id = curve_id(row.id, inputs.seed as u64, k as u64);
        let [a, b] = spot(dice, row.id, side, k / 2);
        let u = a * (1.0 + lead) - lead;
        let along = u.clamp(0.0, 1.0);
        let vary = |index: u64| dice.signed(id, index) * inputs.unevenness;
        let angle = (pull.along(tuft, curve, along) + 12.0 * vary(0)).clamp(-80.0, 80.0);
        let wish = PartingHairParams {
            u,
            side,
            mediate: mediate.along(tuft, curve, along) * (1.0 - inputs.jitter * b),
            pull: angle.to_radians(),
            lift: lift.along(tuft, curve, along) * (1.0 + 0.8 * vary(1)),
            round: (ROUND + 50.0 * vary(2)).to_radians(),
        };
        let Some(start) = parting_hair::start(rules, ground, &reach, &wish) else { continue };
        let root = &start.root;
        let section = rules.scalp.home_of(root).filter(|_| !rules.crossing);
        let stays = |points: &[Vec3]| {
            section.is_none_or(|section| {
                // Nor just behind its end, where the braid crosses.
                let [.., a, b] = points[..] else { return true };
                let behind = b + (b - a).normalize_or_zero() * (0.1 * cx.unit());
                let on = points.iter().copied().chain([behind]);
                !points.iter().zip(on.skip(1)).any(|(a, b)| section.crosses(*a, b))
            })
        };
        let mut combed = |end_u: f32, group: Option<i32>, points: &mut Vec<Vec3>| {
            let radius = radius_at(end_u);
            let middle = group.and_then(|group| {
                *middles.entry(group).or_insert_with(|| {
                    let wish = PartingHairParams {
                        u: end_u,
                        side,
                        mediate: mediate.along(tuft, curve, end_u),
                        pull: pull.along(tuft, curve, end_u).to_radians(),
                        lift: 0.0,
                        round: ROUND.to_radians(),
                    };
                    parting_hair::middle(rules, ground, &reach, &wish, radius)
                })
            });
            let point = match middle {
                Some(middle) => {
                    let spread = [3, 4, 5].map(|i| dice.signed(id, i));
                    middle.end.within(rules, Vec3::from_array(spread))
                }
                None => {
                    parting_hair::end(rules, row, root, end_u, (side, wish.round), radius).point
                }
            };
            let end = (point, row.spline.tangent_at(end_u));
            parting_hair::way(rules, ground, root, end, wish.lift, middle.as_ref(), points)
                && stays(points)
        };
        let (mut end_u, mut group) = (start.end_u, None);
        if let Some((at, number)) = gather.as_ref().and_then(|g| g.nearest(end_u, side)) {
            (end_u, group) = (at, Some(2 * number + i32::from(side > 0)));
        }
        if !combed(end_u, group, &mut points) {
            // Near a parting, the hair runs straight into the braid beside it.
            (end_u, group) = (along, None);
            if section.is_none() || !combed(end_u, group, &mut points) {
                continue;
            }
        }
        made.hair.push_curve(&points);
        made.from.push((curve, place_of(row.spline.locate(end_u))));
        made.ids.push(id);
        made.rows.push(row.id);
        made.braids.push(braid);
        made.sides.push(side);
        made.groups.push(group.unwrap_or(0));
        made.ends.push(end_u);
        made.roots.push(*root);
    }
    if count > 0 && made.ids.len() == before {
        piece.trouble(
            row.id,
            "no ground for hairs beside a row: it meets nobody, or no hair grows there",
        );
    }
    Ok(())
}

/// Spread of hair ends around the braid, degrees above its side.
const ROUND: f32 = 25.0;

/// Evenly distributed numbers in the unit square for the `i`-th hair on a side of a row; the first runs along the row.
fn spot(dice: Dice, row: u64, side: i32, i: usize) -> [f32; 2] {
    let s = u64::from(side > 0);
    r2(i as u32, [dice.unit(row, s), dice.unit(row, 2 + s)])
}

fn gather(inputs: &Inputs, ground: &RowTerritory, a_side: usize, read: &[&Tuft]) -> Option<Gather> {
    let row = ground.own;
    let places = match inputs.grouping {
        Grouping::None => return None,
        Grouping::EveryK => {
            let groups = (a_side as f32 / inputs.every as f32).ceil().max(1.0);
            (0..groups as i32).map(|g| ((g as f32 + 0.5) / groups, 0, g)).collect()
        }
        Grouping::Stitches => {
            let mut places = vec![];
            for tuft in read.iter().filter(|t| role(t) == STITCHES) {
                let (along, side) = (tuft.view(ALONG), tuft.view(SIDE));
                for i in (0..tuft.len()).filter(|i| braided(tuft, *i) == row.id) {
                    for (k, p) in tuft.range(i).enumerate() {
                        places.push((
                            along.at(i, p).clamp(0.0, 1.0),
                            side.at(i, p).signum(),
                            k as i32,
                        ));
                    }
                }
            }
            places
        }
        Grouping::Picked => {
            let mut places = vec![];
            for tuft in read.iter().filter(|t| role(t) == PICKED) {
                for i in 0..tuft.len() {
                    let p = tuft.curve(i)[0];
                    if ground.ahead(p) >= 0.0 {
                        places.push((row.nearest(p).2, 0, places.len() as i32));
                    }
                }
            }
            places
        }
    };
    Some(Gather { places })
}

/// The braid that a row's hairs belong to.
fn braid_id(tuft: &Tuft, curve: usize, row: &Row, read: &[&Tuft]) -> u64 {
    for stitches in read.iter().filter(|t| role(t) == STITCHES) {
        for i in 0..stitches.len() {
            if braided(stitches, i) == row.id {
                return stitches.view(BRAID).at(i, stitches.range(i).start);
            }
        }
    }
    match tuft.view(BRAID).at(curve, tuft.range(curve).start) {
        0 => row.id,
        braid => braid,
    }
}

#[cfg(test)]
mod tests;
