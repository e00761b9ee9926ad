//! Sphere puff: hair gathered at its base that ends on a perfect sphere (Lightyear 3.2).
//!
//! Roots on a disc of the scalp are mapped to the sphere with their azimuth kept and areas in proportion: the fraction
//! of the disc inside a root equals the fraction of the covered cap inside its tip. Guides stand on rows and columns of
//! that map; the fill interpolates directions between the surrounding guides by slerp.
//!
//! Any other outline replaces the sphere along the same directions.
//!
//! Guarantees: guides end on the sphere to 1e-4 of its radius, leave the scalp along its normal and stay outside it;
//! more fill only adds hairs; on a parted scalp all of a puff's hair is rooted in the section of its centre; with
//! `flatten` at 1 no tip lies over the plane to another puff of the node, and none closer to the skin than the
//! clearance. Not promised: that without `flatten`, a sphere low enough to dip into the head keeps its tips outside (a
//! warning counts them).

use super::At;
use super::outline::PuffOutline;
use super::press::{self, Wall};
use super::tie::Tie;
use crate::data::attributes::{
    Domain, FIBRE, ID, PARENT, PUFF, PUFF_CENTRE, PUFF_COVERAGE, PUFF_EDGE, PUFF_RADIUS, ROOT_BARY,
    ROOT_TRIANGLE, ROOT_UV, SCALP_NORMAL, SECTION,
};
use crate::data::curves::{Curves, Tuft, TuftBuilder};
use crate::data::route::makers::lift;
use crate::data::scalp::{Root, Scalp, Skin};
use crate::define::{NodeError, choice, node, unless, without_mesh};
use crate::eval::{EvalCx, Piece, Size};
use crate::maths::frame::{across, any_normal};
use crate::maths::hash::{Dice, KeyBuilder, curve_id};
use crate::maths::low_discrepancy::disc;
use crate::maths::nearest::KdTree;
use crate::maths::spline::Spline;
use crate::maths::transcendental::{acos, atan2, cos, sin, sin_cos, sin_cos_turns};
use glam::{Vec2, Vec3};
use std::f32::consts::{PI, TAU};
use std::ops::Range;
use std::sync::Arc;

node! {
    /// Makes a puff: hair rooted in a circle on the scalp and gathered by a tie, with its tips on a perfect sphere.
    ///
    /// `guides` are rows and columns of curves that end on the sphere; `curves` is the hair between them. Follow it
    /// with Shape-list curl, with length at `fibre` or `span`, to curl the puff and keep its outline.
    "sphere_puff", version 1, label "Sphere puff",
        words "puff afro bun buns space pom ball bunches sphere silhouette", thins, scales,
        refuses(without_mesh);
    inputs {
        /// Head that the puff grows on.
        scalp: Arc<Scalp>;
        /// Curves whose roots or tips are the centres of puffs, such as braids: one puff for each. Without them, one puff
        /// sits at `position`.
        placements: Option<Curves>, words("points roots tips several");
        /// The end of each of `placements` at which its puff sits.
        at: At = At::Roots, words("end root tip place");
        /// Size puffs at `placements` by their spacing: where the sphere's radius is more than three quarters of the distance to the
        /// next, the puff is smaller in all its sizes.
        fit: bool = false, words("size room spacing small shrink overlap rows");
        /// Ties that puffs grow out of, one puff per tie, from Gather into tie. They set position and direction, and
        /// replace the inputs position, root radius, tie height and tightness.
        ties: Option<Curves>, words("gather base elastic band");
        /// Position of the puff in head units from the centre of the cranium: the point of the scalp in this direction.
        position: Vec3 = Vec3::new(0.0, 8.0, -4.0), handle(Handle::Point), words("place pick centre");
        /// Radius on the scalp within which hair is rooted.
        root_radius: f32 = 3.0, hard(0.01, 30.0), soft(0.5, 8.0), unit(Length), handle(Handle::Radius), words("base section");
        /// Radius of the sphere.
        sphere_radius: f32 = 6.0, hard(0.1, 60.0), soft(2.0, 15.0), unit(Length), handle(Handle::Ball), words("size ball");
        /// Set the number of hairs, or their density at the roots.
        fill: Fill = Fill::Count;
        /// Hairs per puff, when by count. Raising it only adds hairs.
        count: i64 = 6000, hard(0.0, 1000000.0), soft(500.0, 20000.0), unit(Count), words("amount hairs strands"),
            idle(|of| unless(of, "fill", "count", "the number goes by density"));
        /// Hairs per square centimetre of root area, when by density.
        density: f32 = 200.0, hard(0.0, 5000.0), soft(20.0, 600.0), unit(PerCm2), words("amount hairs strands"),
            idle(|of| unless(of, "fill", "density", "the number goes by count"));
        /// Fraction of length that hair will lose when it is curled; `fibre_length` is lengthened accordingly. A curl
        /// that keeps the fiber length then ends at the sphere, unless it shrinks more.
        shrinkage: f32 = 0.75, hard(0.0, 0.95), soft(0.0, 0.9), unit(Ratio), words("fibre length curl");

        [Placement]
        /// Depth below the sphere at which the outermost tips end, as a fraction of its radius.
        depth_from: f32 = 0.0, hard(0.0, 0.95), soft(0.0, 0.5), unit(Ratio), words("tip depth soft");
        /// Depth below the sphere at which the innermost tips end, as a fraction of its radius.
        depth_to: f32 = 0.1, hard(0.0, 0.95), soft(0.0, 0.5), unit(Ratio), words("tip depth soft");

        [Shape]
        /// Outline that the tips lie on.
        shape: Shape = Shape::Sphere, words("outline silhouette ellipsoid mesh drawn trim topiary");
        /// Half axes of the ellipsoid in sphere radii: to the puff's right, along its axis, forward.
        stretch: Vec3 = Vec3::ONE, words("ellipsoid egg oval flat wide tall"),
            idle(|of| unless(of, "shape", "ellipsoid", "the outline is no ellipsoid"));
        /// Closed mesh for the tips, used at its own position: wire a Head node that reads it, with no fit. The puff is
        /// centred on the mesh.
        mesh: Option<Arc<Scalp>>, words("volume outline topiary");
        /// Closed outline in front view, drawn around the sphere's centre.
        front: Option<Curves>, words("outline silhouette draw stroke");
        /// Closed outline in side view, drawn around the sphere's centre.
        side: Option<Curves>, words("outline silhouette draw stroke");
        /// How flat the puffs of this node are where they meet, and where they meet the head: 0 lets them overlap, 1
        /// ends them at the plane between them and just above the skin. Press puffs does this across nodes.
        flatten: f32 = 0.0, hard(0.0, 1.0), unit(Ratio), words("press collide touch");
        /// Height of the sphere's centre above the scalp. Unset: the sphere's radius, so that it rests on the scalp.
        offset: Option<f32>, hard(0.0, 100.0), soft(0.0, 20.0), unit(Length), handle(Handle::Length), words("height centre");
        /// Angle from the top of the sphere down to which tips reach: 90 degrees is the upper half, 175 (the largest)
        /// all but the base.
        coverage: f32 = 140.0, hard(10.0, 175.0), soft(60.0, 160.0), unit(Angle), handle(Handle::Angle), words("cap cone");
        /// Path of the hair from the tie to the sphere, from 0 (straight) to 1 (through the centre, ending square to
        /// the sphere).
        bulge: f32 = 0.5, hard(0.0, 1.0), unit(Ratio), words("round swell");

        [Tie]
        /// Height above the scalp at which the hair is tied.
        tie_height: f32 = 1.0, hard(0.0, 30.0), soft(0.0, 4.0), unit(Length), handle(Handle::Length), words("root gather band elastic");
        /// How tightly the tie gathers the hair, from 0 (as wide as its roots) to 1 (nearly a point).
        tightness: f32 = 0.5, hard(0.0, 1.0), unit(Ratio), words("root gather band elastic");

        [Detail]
        /// Rows of guides from the top down, evenly spaced by area.
        rows: i64 = 6, hard(1.0, 200.0), soft(2.0, 16.0), unit(Count);
        /// Guides per row.
        columns: i64 = 16, hard(3.0, 400.0), soft(6.0, 40.0), unit(Count);
        /// CVs per curve.
        points: i64 = 24, hard(6.0, 1000.0), soft(8.0, 64.0), unit(Count), words("cvs resolution segments");
        /// Scale lengths with the size of the head.
        scale_with_head: bool = true;

        [Randomness]
        /// How far tips may lie inside or outside the outline; most lie close to it. 0 is a clean outline.
        edge_softness: f32 = 0.0, hard(0.0, 20.0), soft(0.0, 1.5), unit(Length), words("fuzzy halo frizz natural");
        /// Fraction of hairs that stick out of the outline.
        stray: f32 = 0.0, hard(0.0, 1.0), soft(0.0, 0.1), unit(Ratio), words("flyaways loose");
        /// Largest distance by which they stick out.
        stray_length: f32 = 0.8, hard(0.0, 20.0), soft(0.0, 3.0), unit(Length), words("flyaways loose"),
            idle(|of| matches!(of("stray"), Some(Value::Float(0.0))).then_some("no hair strays"));
        /// Random seed for this node. It changes ids too.
        seed: i64 = 0;
    }
    outputs {
        /// Rows and columns of curves that end on the sphere. Their parent is the puff.
        guides: Curves;
        /// The hair. Its parents are the nearest guides, so curls clump by guide.
        curves: Curves;
    }
}

choice! {
    /// Outline that the tips lie on.
    Shape {
        /// A sphere.
        Sphere = "sphere",
        /// An ellipsoid with its own size along three axes.
        Ellipsoid = "ellipsoid",
        /// A closed mesh.
        Mesh = "mesh",
        /// Outlines drawn in front and side view; the sphere where one is missing.
        Drawn = "drawn",
    }
}

choice! {
    /// What sets the number of hairs.
    Fill {
        /// Per puff.
        Count = "count",
        /// Per square centimetre of root area.
        Density = "density",
    }
}

fn eval(cx: &EvalCx, inputs: Inputs) -> Result<Outputs, NodeError> {
    let scalp = &*inputs.scalp;
    let skin = cx.skin(scalp);
    let unit = cx.unit();
    let dice = cx.dice(inputs.seed, "puff");
    let puffs: Vec<Puff> = match (&inputs.ties, &inputs.placements) {
        (Some(ties), _) => {
            let ties = Tie::all(cx, scalp, ties);
            ties.iter().map(|tie| Puff::tied(&inputs, skin, unit, tie)).collect()
        }
        (_, Some(placements)) => {
            let middles = super::placed(cx, scalp, placements, inputs.at)?;
            let sizes = match inputs.fit {
                true => rooms(&middles)
                    .map(|room| (room / inputs.sphere_radius).clamp(LEAST, 1.0))
                    .collect(),
                false => vec![1.0; middles.len()],
            };
            let puff = |((m, parent), size)| Puff::new(&inputs, skin, unit, (m, parent), size);
            middles.into_iter().zip(sizes).map(puff).collect()
        }
        _ => match super::picked(scalp, inputs.position) {
            Some(middle) => vec![Puff::new(&inputs, skin, unit, (middle, 0), 1.0)],
            None => return Err(NodeError::failed("the scalp has no surface to place a puff on")),
        },
    };
    let puffs = beside(puffs);
    if inputs.flatten > 0.0 && puffs.len() == 1 {
        cx.remark(
            "flatten presses this puff against the head alone: Press puffs presses it against puffs of other nodes",
        );
    }
    let density = |puff: &Puff| inputs.density * PI * puff.root_radius * puff.root_radius;
    let count = match inputs.fill {
        Fill::Count => inputs.count as usize,
        Fill::Density => puffs.first().map_or(0.0, density) as usize,
    };
    let count = cx.makes_each(puffs.len(), count.min(MOST_HAIRS));
    // Each puff has one work item for its guides, and one for each batch of hairs.
    let pieces = 1 + count.div_ceil(HAIRS_A_PIECE);
    let key = |i: usize| {
        let puff = &puffs[i / pieces];
        let key = KeyBuilder::new("puff").int(puff.id).vec3(puff.middle.point).vec3(puff.axis);
        let key = key.vec3(puff.right).float(puff.root_radius).float(puff.tie_height);
        let key = key.float(puff.radius);
        // Drawn outlines and neighbouring puffs are read as well.
        let key =
            [&inputs.front, &inputs.side].into_iter().flatten().fold(key, |k, c| k.key(c.key()));
        let key =
            puff.walls.iter().map(Wall::key_parts).fold(key, |key, (v, at)| key.vec3(v).float(at));
        key.int((i % pieces) as u64).finish()
    };
    let name = if inputs.fill == Fill::Count { "count" } else { "hairs" };
    let size = [("puffs", puffs.len()), (name, count), ("points", inputs.points as usize)];
    let size = Size::of(&size.map(|(name, n)| (name, n as f64)));
    let [guides, curves] = cx.each_item(puffs.len() * pieces, &size, key, |i, piece| {
        let puff = &puffs[i / pieces];
        let none = || TuftBuilder::new().build();
        Ok(match i % pieces {
            0 => [puff.guides(piece)?, none()],
            part => {
                let from = (part - 1) * HAIRS_A_PIECE;
                [none(), puff.hair(from..count.min(from + HAIRS_A_PIECE), dice, piece)?]
            }
        })
    })?;
    Ok(Outputs { guides, curves })
}

/// For each place, [`ROOM`] of the distance to the next, cm.
fn rooms(middles: &[(Root, u64)]) -> impl Iterator<Item = f32> {
    let tree = KdTree::new(middles.iter().map(|(middle, _)| middle.point));
    let mut near = vec![];
    middles.iter().map(move |(middle, _)| {
        tree.find(middle.point, 2, &mut near);
        near.get(1).map_or(f32::MAX, |(square, _)| ROOM * square.sqrt())
    })
}

/// Radius of a puff that is sized by spacing, of the distance to the next: puffs press against each other.
const ROOM: f32 = 0.75;
/// The smallest size of a puff that has no room, of what is asked.
const LEAST: f32 = 0.02;
/// Hairs per work item.
const HAIRS_A_PIECE: usize = 1024;
/// The most hairs of one puff at any density.
const MOST_HAIRS: usize = 1_000_000;
/// Samples of a path before its CVs are spaced evenly.
const SAMPLES: usize = 64;
/// Height above the skin of hair pressed onto the head, cm on a head of average size.
const CLEARANCE: f32 = 0.1;
/// Largest error of the approximate distance from the skin, cm.
const ABOUT: f32 = 0.1;
/// Steps from the centre of a puff to a tip at which the skin is sampled, and bisections of the step that contains it.
const STEPS: usize = 32;
const HALVINGS: usize = 12;

/// One puff: its position and sizes in cm, and the directions of its guides.
struct Puff<'a> {
    inputs: &'a Inputs,
    skin: Skin<'a>,
    id: u64,
    /// Value of [`PUFF`] of its hairs.
    puff: u64,
    middle: Root,
    /// Its axis. Unit.
    axis: Vec3,
    /// Axes of the root disc; azimuth 0 is `right`.
    right: Vec3,
    ahead: Vec3,
    centre: Vec3,
    root_radius: f32,
    radius: f32,
    tie_height: f32,
    /// Radius of the hair in the tie, in root radii.
    tie_width: f32,
    /// One head unit, cm.
    unit: f32,
    outline: PuffOutline<'a>,
    /// Planes between it and its neighbours.
    walls: Vec<Wall>,
    /// By row and column, from the sphere's centre. Unit.
    directions: Vec<Vec3>,
}

impl<'a> Puff<'a> {
    /// A puff on the skin, with all its sizes times `size`.
    fn new(
        inputs: &'a Inputs,
        skin: Skin<'a>,
        unit: f32,
        (middle, parent): (Root, u64),
        size: f32,
    ) -> Self {
        let frame = inputs.scalp.frame();
        let ahead = across(frame.forward, middle.normal)
            .or_else(|| across(frame.up, middle.normal))
            .unwrap_or_else(|| any_normal(middle.normal));
        let tie = Tie {
            id: parent,
            foot: middle,
            axis: middle.normal,
            right: ahead.cross(middle.normal),
            height: inputs.tie_height * size,
            radius: inputs.root_radius * size,
        };
        let id = curve_id(parent, inputs.seed as u64, 0);
        let tie_width = 1.0 - 0.98 * inputs.tightness;
        Self::on(inputs, skin, unit, &tie, (id, id, tie_width), size)
    }

    /// A puff that grows out of a tie.
    fn tied(inputs: &'a Inputs, skin: Skin<'a>, unit: f32, tie: &Tie) -> Self {
        let id = curve_id(tie.id, inputs.seed as u64, 0);
        Self::on(inputs, skin, unit, tie, (id, tie.id, 1.0), 1.0)
    }

    fn on(
        inputs: &'a Inputs,
        skin: Skin<'a>,
        unit: f32,
        tie: &Tie,
        (id, of, tie_width): (u64, u64, f32),
        size: f32,
    ) -> Self {
        let offset = inputs.offset.unwrap_or(inputs.sphere_radius) * size;
        let mut puff = Self {
            inputs,
            skin,
            id,
            puff: of,
            middle: tie.foot,
            axis: tie.axis,
            right: tie.right,
            ahead: tie.ahead(),
            centre: tie.foot.point + tie.axis * offset,
            root_radius: tie.radius,
            radius: inputs.sphere_radius * size,
            tie_height: tie.height,
            tie_width,
            unit,
            outline: PuffOutline::Sphere,
            walls: vec![],
            directions: vec![],
        };
        puff.outline = puff.outlined();
        let (rows, columns) = (inputs.rows as usize, inputs.columns as usize);
        puff.directions = (0..rows * columns)
            .map(|i| {
                let polar = puff.polar((i / columns + 1) as f32 / rows as f32);
                puff.direction(polar, (i % columns) as f32 / columns as f32)
            })
            .collect();
        puff
    }

    /// The requested outline; a mesh also sets the centre.
    fn outlined(&mut self) -> PuffOutline<'a> {
        let inputs = self.inputs;
        match inputs.shape {
            Shape::Sphere => PuffOutline::Sphere,
            Shape::Ellipsoid => PuffOutline::Ellipsoid(inputs.stretch.abs()),
            Shape::Mesh => match &inputs.mesh {
                Some(mesh) => {
                    let (low, high) = mesh.surface().bounds();
                    self.centre = 0.5 * (low + high);
                    PuffOutline::Mesh(
                        mesh.surface(),
                        self.centre,
                        [self.right, self.axis, self.ahead],
                    )
                }
                None => PuffOutline::Sphere,
            },
            Shape::Drawn => {
                let (centre, axis) = (self.centre, self.axis);
                let radii = |lines: &Option<Curves>, aside: Vec3| match lines {
                    Some(lines) => PuffOutline::drawn(lines, self.radius, |p| {
                        Vec2::new((p - centre).dot(aside), (p - centre).dot(axis))
                    }),
                    None => PuffOutline::drawn(&Curves::default(), self.radius, |_| Vec2::ZERO),
                };
                PuffOutline::Drawn(
                    radii(&inputs.front, self.right),
                    radii(&inputs.side, self.ahead),
                )
            }
        }
    }

    /// Distance of the outline from the centre in a direction, cm.
    fn reach(&self, direction: Vec3) -> f32 {
        let d = direction;
        let local = Vec3::new(d.dot(self.right), d.dot(self.axis), d.dot(self.ahead));
        self.outline.reach(local, self.radius)
    }

    /// A tip, pulled back to the planes between this puff and its neighbours, and out of the head.
    fn pressed(&self, tip: Vec3) -> Vec3 {
        let flatten = self.inputs.flatten;
        if flatten <= 0.0 {
            return tip;
        }
        let off = tip - self.centre;
        let now = press::pressed(off, &self.walls, flatten);
        let tip = if now == off { tip } else { self.centre + now };
        self.pressed_on_head(tip)
    }

    /// A tip below the skin as seen from the puff's centre, pulled back along that line to just above it: tips keep the
    /// spread of the outline's directions, where the nearest skin would bunch them up.
    fn pressed_on_head(&self, tip: Vec3) -> Vec3 {
        let (over, off) = (self.over_skin(), tip - self.centre);
        let at = |t: f32| self.centre + off * t;
        let is_low =
            |t: f32| self.skin.about(at(t)) < over + ABOUT && self.skin.distance(at(t)) < over;
        // From a centre inside the head nothing is visible.
        if is_low(0.0) {
            return lift(&self.skin, tip, over).0;
        }
        let Some(first) = (1..=STEPS).find(|k| is_low(*k as f32 / STEPS as f32)) else {
            return tip;
        };
        let (mut clear, mut low) = ((first - 1) as f32 / STEPS as f32, first as f32 / STEPS as f32);
        for _ in 0..HALVINGS {
            let middle = 0.5 * (clear + low);
            if is_low(middle) { low = middle } else { clear = middle }
        }
        lift(&self.skin, tip.lerp(at(clear), self.inputs.flatten), over).0
    }

    /// Height above the skin of hair pressed onto the head, cm; 0 if none is.
    fn over_skin(&self) -> f32 {
        CLEARANCE * self.unit * self.inputs.flatten
    }

    /// The point of the outline in a direction from the centre.
    fn on_outline(&self, direction: Vec3) -> Vec3 {
        self.pressed(self.centre + direction * self.reach(direction))
    }

    /// The angle from the top that encloses the fraction `area` of the covered cap.
    fn polar(&self, area: f32) -> f32 {
        acos(1.0 - area * (1.0 - cos(self.inputs.coverage.to_radians())))
    }

    /// The direction from the sphere's centre at an angle from the top and an azimuth in turns.
    fn direction(&self, polar: f32, azimuth: f32) -> Vec3 {
        let ((sin, cos), (y, x)) = (sin_cos(polar), sin_cos_turns(azimuth));
        self.axis * cos + (self.right * x + self.ahead * y) * sin
    }

    /// The root at a position of the unit disc; on a parted scalp, in the section of the centre.
    fn root(&self, place: Vec2) -> Option<Root> {
        let place = place * self.root_radius;
        let over = self.middle.point + self.right * place.x + self.ahead * place.y;
        let scalp = &self.inputs.scalp;
        let root = scalp.closest_root(over)?;
        Some(scalp.kept_in_section(self.middle.point, root))
    }

    /// The id of the guide in a row and column.
    fn guide_id(&self, row: usize, column: usize) -> u64 {
        let number = (1 << 40) | (row << 20) | column;
        curve_id(self.id, self.inputs.seed as u64, number as u64)
    }

    fn guides(&self, piece: &mut Piece) -> Result<Tuft, NodeError> {
        let columns = self.inputs.columns as usize;
        let mut out = Bundle::default();
        for (i, direction) in self.directions.iter().enumerate() {
            piece.tick()?;
            let (row, column) = (i / columns, i % columns);
            let area = (row + 1) as f32 / self.inputs.rows as f32;
            let (y, x) = sin_cos_turns(column as f32 / columns as f32);
            let tip = self.on_outline(*direction);
            let id = self.guide_id(row, column);
            if self.skin.distance(tip) < 0.0 {
                piece.trouble(id, DIPS);
            }
            let radius = tip.distance(self.centre);
            self.grow(Vec2::new(x, y) * area.sqrt(), tip, radius, (id, self.id), &mut out);
        }
        Ok(out.build(self))
    }

    fn hair(&self, which: Range<usize>, dice: Dice, piece: &mut Piece) -> Result<Tuft, NodeError> {
        let shift = [dice.unit(self.id, 0), dice.unit(self.id, 1)];
        let (from, to) = (self.inputs.depth_from, self.inputs.depth_to);
        let mut out = Bundle::default();
        for k in which {
            piece.tick()?;
            let place = Vec2::from(disc(k as u32, shift));
            let (direction, (row, column)) = self.between(place);
            let id = curve_id(self.id, self.inputs.seed as u64, k as u64);
            let depth = dice.range(id, 2, from.min(to), from.max(to));
            let mut reach = self.reach(direction) * (1.0 - depth);
            let soft = self.inputs.edge_softness;
            if soft > 0.0 {
                let aside = dice.signed(id, 3);
                reach = (reach + soft * aside * aside * aside).max(0.2 * self.radius);
            }
            if self.inputs.stray > 0.0 && dice.unit(id, 4) < self.inputs.stray {
                let over = dice.unit(id, 5);
                reach += self.inputs.stray_length * over * over;
            }
            let tip = self.pressed(self.centre + direction * reach);
            // Where the sphere dips into the head, hair ends on the skin.
            let tip = lift(&self.skin, tip, 0.0).0;
            // The visible outline is where the outermost tips end.
            let outline = self.on_outline(direction).distance(self.centre);
            let radius = outline * self.outermost();
            self.grow(place, tip, radius, (id, self.guide_id(row, column)), &mut out);
        }
        Ok(out.build(self))
    }

    /// Distance of the outermost tips from the centre, as a fraction of the outline's.
    fn outermost(&self) -> f32 {
        1.0 - self.inputs.depth_from.min(self.inputs.depth_to)
    }

    /// The direction at a position of the unit disc, by slerp between the four surrounding guides (the axis replaces
    /// the row inside the first), and the row and column of the nearest guide.
    fn between(&self, place: Vec2) -> (Vec3, (usize, usize)) {
        let (rows, columns) = (self.inputs.rows as usize, self.inputs.columns as usize);
        let area = place.length_squared().min(1.0);
        let rows_out = area * rows as f32;
        let row = (rows_out as usize).min(rows - 1);
        let column = (atan2(place.y, place.x) / TAU).rem_euclid(1.0) * columns as f32;
        let (first, beside) = (column as usize % columns, column.fract());
        let at = |row: usize, column: usize| match row {
            0 => self.axis,
            row => self.directions[(row - 1) * columns + column % columns],
        };
        // Rows are evenly spaced in area, not in angle.
        let angle = |row: usize| self.polar(row as f32 / rows as f32);
        let (inner, outer) = (angle(row), angle(row + 1));
        let out = ((self.polar(area) - inner) / (outer - inner)).clamp(0.0, 1.0);
        let along = |row| slerp(at(row, first), at(row, first + 1), beside);
        let nearest = (rows_out.round() as usize).clamp(1, rows) - 1;
        let nearest_column = (first + usize::from(beside >= 0.5)) % columns;
        (slerp(along(row), along(row + 1), out), (nearest, nearest_column))
    }

    /// Adds the curve from a position of the unit disc to a tip, where the outline is at this distance from the centre.
    fn grow(&self, place: Vec2, tip: Vec3, radius: f32, ids: (u64, u64), out: &mut Bundle) {
        let Some(root) = self.root(place) else { return };
        let up = self.axis;
        let aside = (self.right * place.x + self.ahead * place.y) * self.root_radius;
        let tie_width = self.tie_width;
        let tie = self.middle.point + up * self.tie_height + aside * tie_width;
        // A parabola that leaves the tie turned toward the axis by `bulge` times its chord's angle from the axis
        // arrives turned away by the same angle: perpendicular to a sphere that rests on the tie, if `bulge` is 1.
        // Angles grow with the distance from the axis and keep their order, so hairs do not cross.
        let way = tip - tie;
        let straight = way.normalize_or(up);
        let angle = acos(straight.dot(up)) * self.inputs.bulge;
        let bend = tie
            + slerp(straight, up, self.inputs.bulge) * (0.5 * way.length() / cos(angle).max(0.2));
        // From the root straight along the normal for one CV, on to the tie (a cubic), then to the tip (the parabola).
        // All hairs of a puff do so at the same pace: differences are proportional to the distance from the axis, which
        // keeps them in order.
        let drawn_in = 0.5 * self.root_radius * (1.0 - tie_width);
        let pace = (self.tie_height * self.tie_height + drawn_in * drawn_in).sqrt();
        let spacing = (pace + 1.5 * self.radius) / (self.inputs.points - 1) as f32;
        let from = root.point + root.normal * spacing.min(0.5 * self.tie_height);
        let (leaving, passing) = (root.normal * pace, (bend - tie).normalize_or(up) * pace);
        out.path.clear();
        out.path.push(root.point);
        for k in 0..SAMPLES / 2 {
            let t = k as f32 / (SAMPLES / 2) as f32;
            let (t2, t3) = (t * t, t * t * t);
            out.path.push(
                from * (2.0 * t3 - 3.0 * t2 + 1.0)
                    + leaving * (t3 - 2.0 * t2 + t)
                    + tie * (3.0 * t2 - 2.0 * t3)
                    + passing * (t3 - t2),
            );
        }
        for k in 0..=SAMPLES / 2 {
            let t = k as f32 / (SAMPLES / 2) as f32;
            let s = 1.0 - t;
            out.path.push(tie * (s * s) + bend * (2.0 * s * t) + tip * (t * t));
        }
        let n = out.path.len();
        // Hair pressed onto the head slides along above it, from the tie on.
        let over = self.over_skin();
        let height = |u: f32| over * (2.0 * u - 1.0).max(0.0);
        for (k, p) in out.path[..n - 1].iter_mut().enumerate().skip(1) {
            *p = lift(&self.skin, *p, height(2.0 * k as f32 / n as f32)).0;
        }
        if out.spline.rebuild(&out.path).is_err() {
            return;
        }
        out.points.clear();
        let Bundle { spline, points, .. } = out;
        spline.resample(self.inputs.points as usize, |p| points.push(p));
        let last = points.len() - 1;
        points[0] = root.point;
        points[last] = tip;
        points[1] = root.point + root.normal * points[1].distance(root.point);
        for (k, p) in points[..last].iter_mut().enumerate().skip(1) {
            *p = lift(&self.skin, *p, height(2.0 * k as f32 / last as f32)).0;
        }
        out.tuft.push_curve(&out.points);
        out.ids.push(ids);
        out.radii.push(radius);
        out.fibres.push(out.spline.length() / (1.0 - self.inputs.shrinkage));
        out.roots.push(root);
    }
}

pub(super) const DIPS: &str =
    "guides end inside the head: raise the offset or lower the coverage or the sphere's radius";

/// Interpolates two unit vectors at constant speed along the shortest arc.
fn slerp(a: Vec3, b: Vec3, t: f32) -> Vec3 {
    let angle = acos(a.dot(b));
    if angle < 1e-3 {
        return a.lerp(b, t).normalize_or(a);
    }
    ((a * sin((1.0 - t) * angle) + b * sin(t * angle)) / sin(angle)).normalize_or(a)
}

/// Puffs with the planes to their neighbours, where they press against each other.
fn beside(mut puffs: Vec<Puff>) -> Vec<Puff> {
    let centres: Vec<Vec3> = puffs.iter().map(|puff| puff.centre).collect();
    for (i, puff) in puffs.iter_mut().enumerate().filter(|(_, puff)| puff.inputs.flatten > 0.0) {
        let others = centres.iter().enumerate().filter(|(j, _)| *j != i);
        puff.walls = others.map(|(_, other)| Wall::half_way(puff.centre, *other)).collect();
    }
    puffs
}

/// Curves of one puff under construction.
#[derive(Default)]
struct Bundle {
    tuft: TuftBuilder,
    /// Own id and the parent's.
    ids: Vec<(u64, u64)>,
    roots: Vec<Root>,
    fibres: Vec<f32>,
    /// Distances of the outline from the centre.
    radii: Vec<f32>,
    path: Vec<Vec3>,
    points: Vec<Vec3>,
    spline: Spline,
}

impl Bundle {
    fn build(self, puff: &Puff) -> Tuft {
        let mut tuft = self.tuft;
        fn each<T>(roots: &[Root], of: impl Fn(&Root) -> T) -> Vec<T> {
            roots.iter().map(of).collect()
        }
        let roots = &self.roots;
        tuft.set(ID, Domain::Curve, self.ids.iter().map(|(id, _)| *id).collect());
        tuft.set(PARENT, Domain::Curve, self.ids.iter().map(|(_, parent)| *parent).collect());
        tuft.set(ROOT_TRIANGLE, Domain::Curve, each(roots, |root| root.triangle as i32));
        tuft.set(ROOT_BARY, Domain::Curve, each(roots, |root| root.bary));
        tuft.set(ROOT_UV, Domain::Curve, each(roots, |root| root.uv));
        tuft.set(SCALP_NORMAL, Domain::Curve, each(roots, |root| root.normal));
        if let Some(sections) = puff.inputs.scalp.sections() {
            let id = |root: &Root| sections.id_of(root).unwrap_or_default();
            tuft.set(SECTION, Domain::Curve, each(roots, id));
        }
        tuft.set(FIBRE, Domain::Curve, self.fibres);
        tuft.set(PUFF, Domain::Curve, vec![puff.puff]);
        tuft.set(PUFF_CENTRE, Domain::Curve, vec![puff.centre]);
        let is_ball = matches!(puff.outline, PuffOutline::Sphere) && puff.walls.is_empty();
        let one = |all: f32| {
            let is_one = |radius: &f32| (radius - all).abs() <= 1e-5 * all;
            (is_ball && self.radii.iter().all(is_one)).then(|| vec![all])
        };
        // For guides and for hair.
        let radii = one(puff.radius).or_else(|| one(puff.radius * puff.outermost()));
        let radii = radii.unwrap_or(self.radii);
        tuft.set(PUFF_RADIUS, Domain::Curve, radii);
        tuft.set(PUFF_COVERAGE, Domain::Curve, vec![puff.inputs.coverage]);
        let inputs = puff.inputs;
        let deeper = (inputs.depth_to - inputs.depth_from).abs() / puff.outermost();
        let edge = Vec3::new(deeper, inputs.edge_softness, inputs.stray);
        tuft.set(PUFF_EDGE, Domain::Curve, vec![edge]);
        tuft.build()
    }
}
