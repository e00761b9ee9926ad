//! Cluster to strands: hair inside the tubes that clusters are (methods.md 6).
//!
//! Per cluster the frame, centre, radius and roll at every strand point are worked out once; a strand is
//! then a root, a short random walk and one multiplication a point. Guarantees: raising the density only
//! adds strands; only a twisted cluster's strands have more CVs than `points`, and then at most 255; a strand never leaves the radius in the plane across its cluster; no point ends under the
//! skin by more than `allow_depth` (points, not the chords between them); roots lie on the scalp, on a parted one in
//! the section of the cluster's, and so do strands as far along as the cluster itself does; with `fill` roots are as even over the
//! region as between guides ([`super::cells`]), and strands rooted beside the disc join the tube within some of its radii. Not
//! promised: that strands keep clear of each other, or that points of strands pushed off the skin or
//! frizzed are as evenly spaced as the cluster's.

use super::bias::end_on_plane;
use super::cells::{CellParams, Cells};
use super::cross_sections::{
    CrossSection, CrossSections, FilledTube, RootPlace, open_radius, widest_radius,
};
use super::plan::PlannedHair;
use crate::data::attribute_transfer::{Lineage, ONE_PARENT, place_of};
use crate::data::attributes::{
    ALLOW_DEPTH, COLOUR, DENSITY, Domain, FRIZZ, ID, OF_CLUSTERS, PARENT, RADIUS, ROOT_BARY,
    ROOT_TRIANGLE, ROOT_UV, WIDTH,
};
use crate::data::curves::{Curves, Tuft, TuftBuilder};
use crate::data::field::Field;
use crate::data::route::makers::{clear, lift, lift_each};
use crate::data::scalp::{Scalp, Skin};
use crate::define::{FieldInput, NodeError, node};
use crate::eval::{EvalCx, Piece, Size, TracedScalp};
use crate::maths::hash::{Dice, KeyBuilder, curve_id};
use crate::maths::low_discrepancy::disc;
use crate::maths::random_walk::random_walk;
use glam::{Vec2, Vec3};
use std::f32::consts::PI;

node! {
    /// Fills clusters with hair: strands rooted on the scalp around each cluster's root, which run within its radius to the
    /// tip.
    ///
    /// Density fills the cluster; fill shares out the skin between clusters; frizz makes each strand deviate at random. Editing a cluster rebuilds only its own strands; a
    /// higher density only adds strands. Clump, Length and Stray work on what comes out.
    "cluster_to_strands", version 2, label "Cluster to strands",
        words "fill wisp lock locs dreadlocks frizz generate hair strands multiplier sketch twist rope density tube", thins, scales;
    inputs {
        /// Clusters to fill. Their attributes radius, density, frizz, flatness, roll, colour and allow_depth count.
        curves: Curves;
        /// Head that holds the roots and keeps strands out of the skin. Without it, roots fill a disc across the cluster's
        /// root.
        scalp: Option<TracedScalp>;
        /// Strands in a cluster of density 1 and radius 1 cm. The number scales with density and cross-section area.
        strands: i64 = 512, hard(0.0, 65536.0), soft(16.0, 2048.0), unit(Count), words("amount number");
        /// Exact number of strands per cluster. 0: as density and radius ask.
        count: i64 = 0, hard(0.0, 65536.0), soft(0.0, 2000.0), unit(Count), words("amount number");
        /// How full the cluster is, 0 to 1. Read at the root.
        density: FieldInput = Field::Attribute(DENSITY.name.to_owned()), hard(0.0, 1.0), unit(Ratio), words("fullness");
        /// Radius of the cross-section at the cluster's CVs. At the root it sets the place and number of roots; Cross-section shapes
        /// it along the cluster.
        radius: FieldInput = Field::Attribute(RADIUS.name.to_owned()),
            hard(0.0, 100.0), soft(0.05, 3.0), unit(Length), words("thickness size"), handle(Handle::Radius);
        /// How far beyond its disc hair is rooted, up to twice as far between clusters, so that no gap between them and to the hairline
        /// stays bald: each place of the skin goes to the cluster rooted nearest, in its own section. 0: discs alone.
        fill: f32 = 0.0, hard(0.0, 100.0), soft(0.0, 5.0), unit(Length), words("gaps bald between whole region cover reach hairline"),
            idle(|of| matches!(of("count"), Some(Value::Int(1..))).then_some("an exact number of strands is rooted in the disc"));
        /// Diameter of the hair. Set width tapers it.
        width: f32 = 0.008, hard(0.0001, 1.0), soft(0.002, 0.05), unit(Length), fixed(), words("thickness diameter");
        /// Random deviation of strands within the cluster: 0 keeps them parallel, 1 lets them cross it in one step.
        frizz: FieldInput = Field::Attribute(FRIZZ.name.to_owned()),
            hard(0.0, 1.0), unit(Ratio), words("noise messy wander random");
        /// Spacing of random steps along the cluster. 0: one step at each of the cluster's CVs.
        frizz_step: f32 = 2.0, hard(0.0, 1000.0), soft(0.5, 5.0), unit(Length), words("scale frequency");

        [Detail]
        /// CVs per strand, including root and tip. Strongly twisted clusters get more, up to 255, to turn at most 30 degrees per CV.
        points: i64 = 16, hard(2.0, 1024.0), soft(4.0, 64.0), unit(Count), words("cvs segments resolution");
        /// Scale lengths with the size of the head. A radius from an attribute is already in true centimetres.
        scale_with_head: bool = true;
        /// Random seed for this node. It changes ids too.
        seed: i64 = 0;
    }
    outputs {
        /// Hair, one tuft per cluster.
        curves: Curves;
    }
}

/// The most strands one cluster may have.
const MOST: f32 = 262_144.0;
/// The most points all of them may have: what is made at once has to be held.
const MOST_POINTS: f32 = 16_777_216.0;

/// A cluster of fewer strands than this, that would have so many times as many where it is widest, has a root that is nearly closed.
const FEW: f32 = 8.0;
const MANY: f32 = 16.0;

/// What is said of clusters whose strands are coarser than they should be.
pub(super) const COARSE: &str = "strands of a cluster have as many points as they may, and are coarser than its twist asks: twist it less, \
     or raise points";

fn eval(cx: &EvalCx, inputs: Inputs) -> Result<Outputs, NodeError> {
    let cx = &cx.in_lots(inputs.curves.curve_count());
    let unit = cx.unit();
    let skin = inputs.scalp.as_ref().map(|scalp| cx.skin(scalp.head()));
    let filler = Filler {
        roots: cx.dice(inputs.seed, "roots"),
        walk: cx.dice(inputs.seed, "frizz"),
        push: skin.is_none_or(|skin| skin.for_hair().is_some()),
        seed: inputs.seed,
        skin,
    };
    // How many strands a cluster of a density and radius (cm) asks for.
    let strands_in = |density: f32, radius: f32| match inputs.count {
        0 => inputs.strands as f32 * density * (radius / unit) * (radius / unit),
        count => count as f32,
    };
    // The least radius at which there are any.
    let least = |density: f32| match inputs.count {
        0 => unit * (0.5 / (inputs.strands as f32 * density)).sqrt(),
        _ => 0.0,
    };
    // Beforehand: of all clusters, the radius, density and strands of that which asks for most.
    let mut most = (0.0, 0.0, 0.0);
    // Clusters whose root is nearly closed, and of one of them the radius and strands there and where it is widest.
    let (mut thin, mut example) = (0, None);
    let fills = (inputs.fill > 0.0 && inputs.count == 0).then_some(inputs.scalp.as_ref()).flatten();
    // What each cluster asks of a cell, and how many strands it has in its disc.
    let mut asked: Vec<(CellParams, f32)> = vec![];
    for tuft in inputs.curves.tufts() {
        cx.check()?;
        let scalp = inputs.scalp.as_ref();
        let radius = inputs.radius.on_traced(tuft, scalp)?;
        let density = inputs.density.on_traced(tuft, scalp)?;
        for curve in 0..tuft.len() {
            if tuft.curve(curve).is_empty() {
                asked.push(Default::default());
                continue;
            }
            let density = density.at(curve, tuft.range(curve).start, 0.0);
            let least = least(density);
            let last = (tuft.range(curve).len() - 1).max(1) as f32;
            let u = |cv: usize| cv as f32 / last;
            let open = open_radius(tuft, curve, &radius, least, u);
            let strands = strands_in(density, open);
            let per_cm2 = strands_in(density, unit) / (PI * unit * unit);
            asked.push((CellParams { density: per_cm2, radius: open }, strands));
            if (0.5..FEW).contains(&strands) {
                let widest = widest_radius(tuft, curve, &radius, u);
                let there = strands_in(density, widest);
                if there >= MANY * strands {
                    thin += 1;
                    example.get_or_insert([open, strands, widest, there]);
                }
            }
            if strands > most.2 || open >= most.0 && most.2 == 0.0 {
                most = (open, density, strands);
            }
        }
    }
    let cells = match fills {
        Some(scalp) => {
            let asked: Vec<CellParams> = asked.iter().map(|(asked, _)| *asked).collect();
            let settings = (inputs.fill, inputs.points as usize, inputs.seed);
            Cells::new(cx, &inputs.curves, scalp.whole(), settings, &asked)?
        }
        None => Cells::default(),
    };
    let wanted = |number: usize| match cells.of(number) {
        Some(cell) => cell.count() as f32,
        None => asked[number].1,
    };
    // What asks for more is left out.
    let may_be = |strands: &f32| *strands <= MOST && strands * inputs.points as f32 <= MOST_POINTS;
    let all = (0..asked.len()).map(wanted).filter(may_be);
    let all: f64 = all.map(|strands| cx.makes(strands.round() as usize) as f64).sum();
    let points = inputs.points as f64;
    let size = match inputs.count {
        0 => Size::of(&[("strands of all clusters", all), ("points", points)]),
        count => Size::of(&[
            ("clusters", inputs.curves.curve_count() as f64),
            ("count", cx.thinned(count as usize) as f64),
            ("points", points),
        ]),
    };
    if most.2 < 0.5 && inputs.curves.curve_count() > 0 {
        let (radius, density, strands) = most;
        cx.warn(format!(
            "no cluster holds a strand: at their widest, radius {radius:.4} cm and density {density:.4} ask for {strands:.2} \
             (strands {}): raise radius, density or strands, or set count",
            inputs.strands
        ));
    }
    if let Some([radius, strands, widest, there]) = example
        && 2 * thin > inputs.curves.curve_count()
    {
        cx.warn(format!(
            "{thin} of {} clusters have hardly any hair, for strands are counted where a cluster is first open at its root: radius \
             {radius:.4} cm asks for {:.0} there, {widest:.4} cm where it is widest for {there:.0} (strands {}): open the root wider \
             (Cross-section), or set count",
            inputs.curves.curve_count(),
            strands.round(),
            inputs.strands
        ));
    }
    let placed = cx.by_place(inputs.scalp.as_ref());
    let clusters: Vec<(&Tuft, usize)> = inputs.curves.each().collect();
    let key = |number: usize| {
        let (tuft, curve) = clusters[number];
        let key = KeyBuilder::new("cluster").key(tuft.key()).int(curve as u64);
        match cells.of(number) {
            Some(cell) => key.key(cell.key).finish(),
            None => key.finish(),
        }
    };
    let [curves] = placed.each_item(clusters.len(), &size, key, |number, piece| {
        let (tuft, curve) = clusters[number];
        let (id, scalp) = (tuft.id(curve), piece.scalp());
        let mut left_out = |why: &str| {
            piece.trouble(id, why);
            Ok([TuftBuilder::new().build()])
        };
        let first = tuft.range(curve).start;
        let density = inputs.density.on(tuft, scalp)?.at(curve, first, 0.0);
        let sampled = super::cross_sections::CrossSectionParams {
            points: inputs.points as usize,
            radius: &inputs.radius.on(tuft, scalp)?,
            frizz: &inputs.frizz.on(tuft, scalp)?,
            frizz_step: inputs.frizz_step,
            least: least(density),
        };
        let sections = match CrossSections::new(tuft, curve, &sampled, skin.zip(scalp)) {
            Ok(sections) => sections,
            Err(fault) => return left_out(&fault.to_string()),
        };
        let cell = cells.of(number);
        let wanted = match cell {
            Some(cell) => cell.count() as f32,
            None => strands_in(density, sections.root_radius),
        };
        if wanted > MOST {
            return left_out("a cluster that asks for more than 262144 strands was left out");
        }
        if wanted * sections.at.len() as f32 > MOST_POINTS {
            return left_out(
                "a cluster whose strands ask for more than 16 million points was left out",
            );
        }
        if sections.coarse {
            piece.trouble(id, COARSE);
        }
        let count = cx.thinned(wanted.round() as usize);
        let mut strands = match cell {
            Some(cell) => {
                let tube = sections.filled_by(&cell.shape);
                let root = |hair| filler.root_in_cell(id, hair, &tube, &sections);
                filler.fill(cells.roots(cell, count).map(root), &sections, piece)?
            }
            None => {
                let root = |i| filler.root_in_disc(id, i, &sections, scalp);
                filler.fill((0..count as u32).map(root), &sections, piece)?
            }
        };
        inherit(&mut strands, tuft, curve, &sections, inputs.width);
        Ok([strands.build()])
    })?;
    Ok(Outputs { curves })
}

/// What fills all clusters.
struct Filler<'a> {
    roots: Dice,
    walk: Dice,
    push: bool,
    seed: i64,
    skin: Option<Skin<'a>>,
}

/// Where a strand begins.
struct StrandRoot {
    id: u64,
    point: Vec3,
    place: RootPlace,
    /// Triangle, and barycentric and texture coordinates, on a head.
    bound: Option<(u32, Vec2, Vec2)>,
}

impl Filler<'_> {
    /// The `i`-th root in the disc of a cluster.
    fn root_in_disc(
        &self,
        cluster: u64,
        i: u32,
        sections: &CrossSections,
        scalp: Option<&Scalp>,
    ) -> StrandRoot {
        let shift = [self.roots.unit(cluster, 0), self.roots.unit(cluster, 1)];
        let q = Vec2::from(disc(i, shift));
        let mut point = sections.root + sections.disc[0] * q.x + sections.disc[1] * q.y;
        let mut bound = None;
        if let (Some(skin), Some(scalp)) = (&self.skin, scalp)
            && let Some(hit) = skin.closest(point)
        {
            let on_scalp = scalp.root(hit.triangle, hit.bary);
            let on_scalp = scalp.kept_in_section(sections.root, on_scalp);
            point = on_scalp.point;
            bound = Some((on_scalp.triangle, on_scalp.bary, on_scalp.uv));
        }
        let id = curve_id(cluster, self.seed as u64, u64::from(i));
        StrandRoot { id, point, place: RootPlace::within(q), bound }
    }

    /// A root in the cell of a cluster.
    fn root_in_cell(
        &self,
        cluster: u64,
        hair: &PlannedHair,
        tube: &FilledTube,
        sections: &CrossSections,
    ) -> StrandRoot {
        StrandRoot {
            id: curve_id(cluster, self.seed as u64, hair.name),
            point: hair.point,
            place: sections.place(hair.point, tube),
            bound: Some((hair.triangle, hair.bary, hair.uv)),
        }
    }

    /// The strands of a cluster that begin at these roots.
    fn fill(
        &self,
        roots: impl ExactSizeIterator<Item = StrandRoot>,
        sections: &CrossSections,
        piece: &mut Piece,
    ) -> Result<TuftBuilder, NodeError> {
        let (scalp, skin) = (piece.scalp(), self.skin.as_ref().filter(|_| self.push));
        let (each, count) = (sections.at.len(), roots.len());
        let mut points: Vec<Vec3> = Vec::with_capacity(count * each);
        let mut ids = Vec::with_capacity(count);
        let mut triangles = Vec::with_capacity(count);
        let mut barys = Vec::with_capacity(count);
        let mut uvs = Vec::with_capacity(count);
        // What lets a cluster rest in the skin lets its strands: whoever moves them next leaves them there.
        let sinks = sections.sinks;
        let mut depths: Vec<f32> = vec![];
        let wanders = !sections.steps.is_empty();
        // Two equal values before the first and after the last knot keep the walk's ends level.
        let mut walk = vec![Vec2::ZERO; sections.steps.len() + 2];
        // So far the cluster keeps to the section of its root, and so do its strands.
        let home = scalp.and_then(|scalp| scalp.home(sections.root));
        let at_home = home.map_or(1, |home| {
            1 + sections.at[1..].iter().take_while(|section| home.holds(section.centre)).count()
        });
        for StrandRoot { id, point: root, place, bound } in roots {
            piece.tick()?;
            ids.push(id);
            if let Some((triangle, bary, uv)) = bound {
                triangles.push(triangle as i32);
                barys.push(bary);
                uvs.push(uv);
            }
            let first = points.len();
            points.push(root);
            random_walk(self.walk, id, place.across, &sections.steps, &mut walk);
            let walked = |section: &CrossSection| {
                let [a, b, c] = section.weights;
                match walk.get(section.knot..section.knot + 3) {
                    Some([before, here, after]) if wanders => *before * a + *here * b + *after * c,
                    _ => place.across,
                }
            };
            if sinks {
                depths.extend(sections.at.iter().map(|section| section.depth));
            }
            points.extend(sections.at[1..].iter().map(|section| {
                section.point(&place, sections.root_radius, root - sections.root, walked(section))
            }));
            let strand = &mut points[first..];
            if let Some(skin) = skin {
                clear(skin, strand, |k| Some(sections.at[k].depth));
            }
            if let Some((tip, normal)) = sections.cut {
                end_on_plane(strand, tip, normal, sections.root_radius);
                if let Some(skin) = skin {
                    let whole = 1..strand.len();
                    lift_each(skin, strand, whole, |k| -sections.at[k].depth);
                }
            }
            if let (Some(home), Some(triangle)) = (&home, triangles.last()) {
                let strand = points[first..first + at_home].iter_mut().enumerate().skip(1);
                home.lead(strand, *triangle as u32, |k, _, kept| {
                    skin.map_or(kept, |skin| lift(skin, kept, -sections.at[k].depth).0)
                });
                if home.passes(&points[first..first + at_home]) {
                    piece.trouble(
                        id,
                        "a strand that would cross a parting near its root was left out; with more points or thinner clusters there are fewer",
                    );
                    points.truncate(first);
                    depths.truncate(if sinks { first } else { 0 });
                    ids.pop();
                    triangles.pop();
                    barys.pop();
                    uvs.pop();
                }
            }
        }
        let mut out = TuftBuilder::even(points, each);
        out.set(ID, Domain::Curve, ids);
        if sinks {
            out.set(ALLOW_DEPTH, Domain::Point, depths);
        }
        if !triangles.is_empty() {
            out.set(ROOT_TRIANGLE, Domain::Curve, triangles);
            out.set(ROOT_BARY, Domain::Curve, barys);
            if scalp.is_some_and(|scalp| scalp.uvs().is_some()) {
                out.set(ROOT_UV, Domain::Curve, uvs);
            }
        }
        Ok(out)
    }
}

/// Gives strands what their cluster has.
fn inherit(
    strands: &mut TuftBuilder,
    tuft: &Tuft,
    curve: usize,
    sections: &CrossSections,
    width: f32,
) {
    strands.set(PARENT, Domain::Curve, vec![tuft.id(curve)]);
    strands.set(WIDTH, Domain::Curve, vec![width]);
    if tuft.attribute(COLOUR.name).is_none() {
        strands.set(COLOUR, Domain::Curve, vec![COLOUR.default]);
    }
    let lineage = Lineage {
        parent: &|_| (tuft, curve),
        of: &|_| ONE_PARENT,
        places: &|_| sections.places.iter().copied().map(place_of).collect(),
        takes: &|name| !OF_CLUSTERS.contains(&name),
    };
    lineage.pass_on(strands);
}
