//! Interpolate: hair between guides.
//!
//! Where hairs root and which guides they follow is a plan made from the guides' *roots* alone, kept
//! while those stay; shapes are read when the hair of one guide is made. So combing a guide makes again
//! exactly the hair that follows it. Guarantees: roots on the scalp; more only adds hair; weights go to zero where a
//! guide stops counting, so nothing pops as roots move; no point under the skin by more than the guide's
//! `allow_depth`; a hair rooted where a guide is has its shape. Not promised: that partings are respected.

use super::plan::{Hair, Plan};
use crate::data::attributes::{
    ALLOW_DEPTH, Attribute, Domain, ID, PARENT, RADIUS, ROOT_BARY, ROOT_TRIANGLE, ROOT_UV,
    SCALP_NORMAL, WIDTH,
};
use crate::data::curves::{Curves, Tuft, TuftBuilder};
use crate::data::ramp::Ramp;
use crate::data::scalp::{Scalp, Skin};
use crate::define::{FieldInput, NodeError, choice, node};
use crate::eval::{EvalCx, Piece};
use crate::maths::frame::carry;
use crate::maths::hash::{Dice, KeyBuilder, curve_id};
use crate::maths::spline::Spline;
use glam::{Mat3, Vec3};
use std::sync::Arc;

node! {
    /// Grow hair all over the scalp that follows the guides around it.
    ///
    /// Each hair is a blend of the guides nearest to its root, turned with the scalp from theirs to its own. Combing a guide
    /// makes only the hair around it again; raising the density only adds hair.
    "interpolate", version 1, label "Interpolate",
        words "hair generate fill grow children between guides density populate", thins;
    inputs {
        /// Guides to follow.
        guides: Curves;
        /// The head that the hair grows on.
        scalp: Arc<Scalp>;
        /// Whether the number of hairs is given, or how many there are on a square centimetre.
        by: By = By::Density;
        /// Hairs on a square centimetre, when by density. People have 130 to 250.
        density: f32 = 120.0, hard(0.0, 5000.0), soft(1.0, 300.0), unit(PerCm2), words("amount number");
        /// Hairs on the whole region, when by count.
        count: i64 = 20000, hard(0.0, 2000000.0), soft(100.0, 150000.0), unit(Count), words("amount number");
        /// How many of the hairs are kept, from none to all; usually a painted mask.
        mask: FieldInput = 1.0, hard(0.0, 1.0), unit(Ratio), words("area region paint thin");
        /// How many guides shape a hair. More is smoother, fewer keeps the guides' own character; 1 copies the nearest.
        guides_per_hair: i64 = 3, hard(1.0, 16.0), soft(1.0, 8.0), unit(Count), words("neighbours blend");
        /// Guides whose root is farther from the hair's than this do not count, and hair without any is not grown. 0: no limit.
        reach: f32 = 0.0, hard(0.0, 1000.0), soft(0.0, 10.0), unit(Length), words("distance radius"), handle(Handle::Radius);
        /// How much shorter a hair may be than its guides, drawn for each: 0 none, 1 down to nothing. It is cut, not shrunk.
        length_variation: f32 = 0.1, hard(0.0, 0.95), unit(Ratio), words("random vary cut");
        /// How much hair is drawn to the nearest guide.
        clump: FieldInput = 0.0, hard(0.0, 1.0), unit(Ratio), words("gather wisp lock bunch");
        /// How clumping grows from root (left) to tip.
        clump_along: Arc<Ramp> = Ramp::smooth(0.0, 1.0), words("gather profile");
        /// Points on each hair, root and tip included.
        points: i64 = 16, hard(2.0, 1024.0), soft(4.0, 64.0), unit(Count), words("cvs segments resolution");
        /// Diameter of a hair.
        width: f32 = 0.008, hard(0.0001, 1.0), soft(0.002, 0.05), unit(Length), words("thickness diameter");
        /// Whether points under the skin are moved out to it, as far as the nearest guide's allow_depth lets them.
        push_out: bool = true, words("collide scalp intersection penetration");
        /// Seed tag; stored, mixed into ids and randomness.
        seed: i64 = 0;
        /// Whether lengths grow with the size of the head, and the density with its square falls.
        scale_with_head: bool = true;
    }
    outputs {
        /// Hair, gathered in tufts by the nearest guide.
        curves: Curves;
    }
}

choice! {
    /// What decides the number of hairs.
    By {
        /// So many on each square centimetre.
        Density = "density",
        /// So many on the whole region.
        Count = "count",
    }
}

fn eval(cx: &EvalCx, inputs: Inputs) -> Result<Outputs, NodeError> {
    let scalp = &*inputs.scalp;
    let unit = cx.head_unit(Some(scalp), inputs.scale_with_head);
    let guides = one_each(&inputs.guides);
    let asked = super::plan::Asked {
        count: (inputs.by == By::Count).then_some(inputs.count as usize),
        density: inputs.density / (unit * unit),
        mask: &inputs.mask,
        neighbours: inputs.guides_per_hair as usize,
        reach: inputs.reach * unit,
        seed: inputs.seed,
    };
    let plan = Plan::of(cx, &guides, scalp, &asked)?;
    let skin = cx.skin(scalp);
    let maker = Maker {
        inputs: &inputs,
        scalp,
        skin: inputs.push_out.then_some(skin),
        dice: cx.dice(inputs.seed, "length"),
    };
    let key = |i: usize| {
        let group = &plan.groups[i];
        let key = KeyBuilder::new("hair").key(group.key);
        group.guides.iter().fold(key, |key, guide| key.key(guides[*guide as usize].key())).finish()
    };
    let [curves] = cx.each_item(plan.groups.len(), key, |i, piece| {
        let group = &plan.groups[i];
        let hairs = &plan.hairs[group.hairs.clone()];
        // Hairs lie in the list in the order in which density adds them.
        let hairs = &hairs[..cx.thinned(hairs.len())];
        let read: Vec<(&Tuft, Vec3)> = group
            .guides
            .iter()
            .map(|guide| (&*guides[*guide as usize], plan.normals[*guide as usize]))
            .collect();
        let along = &plan.weights[group.weights.clone()];
        Ok([maker.hair(&read, hairs, along, piece)?])
    })?;
    Ok(Outputs { curves })
}

/// Guides one to a tuft: what is read of one changes with it alone.
fn one_each(curves: &Curves) -> Vec<Arc<Tuft>> {
    let mut out = Vec::with_capacity(curves.curve_count());
    for tuft in curves.tufts() {
        match tuft.len() {
            1 => out.push(tuft.clone()),
            n => out.extend((0..n as u32).map(|i| Arc::new(tuft.gather(&[i]).build()))),
        }
    }
    out
}

struct Maker<'a> {
    inputs: &'a Inputs,
    scalp: &'a Scalp,
    skin: Option<Skin<'a>>,
    dice: Dice,
}

/// A guide as hair reads it: points relative to its root at even arc length, `FINE` to a point of the hair.
struct Shape {
    normal: Vec3,
    points: Vec<Vec3>,
}

/// Points of a guide for each span of a hair, so that a hair that is cut reads between them without loss.
const FINE: usize = 4;
/// The most guides that shape one hair.
pub(super) const MOST_GUIDES: usize = 16;

impl Maker<'_> {
    /// The hair of one guide, the first of `guides`.
    fn hair(
        &self,
        guides: &[(&Tuft, Vec3)],
        hairs: &[Hair],
        weights: &[(u16, f32)],
        piece: &mut Piece,
    ) -> Result<Tuft, NodeError> {
        let each = self.inputs.points as usize;
        let fine = if self.inputs.length_variation > 0.0 { FINE } else { 1 };
        let mut shapes = Vec::with_capacity(guides.len());
        for (tuft, normal) in guides {
            let root = tuft.curve(0)[0];
            let mut points = Vec::with_capacity((each - 1) * fine + 2);
            match Spline::new(tuft.curve(0)) {
                Ok(spline) => spline.resample((each - 1) * fine + 1, |p| points.push(p - root)),
                // The plan leaves out guides that are no curves.
                Err(_) => points.resize((each - 1) * fine + 1, Vec3::ZERO),
            }
            // One more, so that the tip lies between two.
            points.push(points[points.len() - 1]);
            shapes.push(Shape { normal: *normal, points });
        }
        let own = guides[0].0;
        let clump = self.inputs.clump.on(own, Some(self.scalp))?;
        let at_u = |k: usize| k as f32 / (each - 1) as f32;
        let clump: Vec<f32> = (0..each)
            .map(|k| {
                let drawn = clump.along(own, 0, at_u(k)) * self.inputs.clump_along.at(at_u(k));
                drawn.clamp(0.0, 1.0)
            })
            .collect();
        let clumps = clump.iter().any(|c| *c > 0.0);
        let depth = own.view(ALLOW_DEPTH);
        let last = own.curve(0).len() - 1;
        let depths: Vec<f32> =
            (0..each).map(|k| depth.at(0, (at_u(k) * last as f32) as usize)).collect();
        let guide_root = own.curve(0)[0];

        let mut points: Vec<Vec3> = Vec::with_capacity(hairs.len() * each);
        let mut turned = [(0usize, Mat3::IDENTITY); MOST_GUIDES];
        for hair in hairs {
            piece.tick()?;
            let id = curve_id(0, self.inputs.seed as u64, u64::from(hair.index));
            let cut = 1.0 - self.inputs.length_variation * self.dice.unit(id, 0);
            let blend = &weights[hair.weights.0 as usize..][..hair.weights.1 as usize];
            for (slot, (guide, weight)) in turned.iter_mut().zip(blend) {
                let from = shapes[*guide as usize].normal;
                *slot = (*guide as usize, rotation(from, hair.normal) * *weight);
            }
            let turned = &turned[..blend.len()];
            points.push(hair.point);
            points.extend((1..each).map(|k| {
                let x = k as f32 * cut * fine as f32;
                let (i, t) = (x as usize, x.fract());
                let mut p = hair.point;
                for (guide, turn) in turned {
                    let [a, b] = [i, i + 1].map(|i| shapes[*guide].points[i]);
                    p += *turn * (a + (b - a) * t);
                }
                if clumps {
                    let [a, b] = [i, i + 1].map(|i| shapes[0].points[i]);
                    p = p.lerp(guide_root + a + (b - a) * t, clump[k]);
                }
                match &self.skin {
                    Some(skin) => skin.push_out(p, depths[k]).0,
                    None => p,
                }
            }));
        }
        let mut out = TuftBuilder::even(points, each);
        let id = |hair: &Hair| curve_id(0, self.inputs.seed as u64, u64::from(hair.index));
        let mine = [ID.name, WIDTH.name, RADIUS.name, SCALP_NORMAL.name];
        let root = [ROOT_TRIANGLE.name, ROOT_BARY.name, ROOT_UV.name];
        for attribute in own.attributes() {
            let name = attribute.name.as_ref();
            if attribute.domain == Domain::Curve && !mine.contains(&name) && !root.contains(&name) {
                out.set_column(Attribute { ..attribute.clone() });
            }
        }
        out.set(ID, Domain::Curve, hairs.iter().map(id).collect());
        out.set(PARENT, Domain::Curve, vec![own.id(0)]);
        out.set(WIDTH, Domain::Curve, vec![self.inputs.width]);
        out.set(ROOT_TRIANGLE, Domain::Curve, hairs.iter().map(|h| h.triangle as i32).collect());
        out.set(ROOT_BARY, Domain::Curve, hairs.iter().map(|h| h.bary).collect());
        if self.scalp.uvs().is_some() {
            let uv = |h: &Hair| self.scalp.root(h.triangle, h.bary).uv;
            out.set(ROOT_UV, Domain::Curve, hairs.iter().map(uv).collect());
        }
        Ok(out.build())
    }
}

/// The smallest rotation from one unit vector to another.
#[inline]
fn rotation(from: Vec3, to: Vec3) -> Mat3 {
    let cos = from.dot(to);
    if cos < -0.98 {
        // Across a head no two neighbours face apart; a mesh may be anything.
        let axes = [Vec3::X, Vec3::Y, Vec3::Z].map(|axis| carry(axis, from, to));
        return Mat3::from_cols(axes[0], axes[1], axes[2]);
    }
    let v = from.cross(to);
    let w = v * (1.0 / (1.0 + cos));
    Mat3::from_cols(
        Vec3::new(cos + w.x * v.x, w.x * v.y + v.z, w.x * v.z - v.y),
        Vec3::new(w.y * v.x - v.z, cos + w.y * v.y, w.y * v.z + v.x),
        Vec3::new(w.z * v.x + v.y, w.z * v.y - v.x, cos + w.z * v.z),
    )
}
