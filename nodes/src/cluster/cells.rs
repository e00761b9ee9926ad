//! Cells: the skin around clusters shared out among them, each place to the cluster that is rooted nearest.
//!
//! Roots are those that hair between guides has ([`Plan`], of one guide per hair), so they are even over the region, end at its
//! hairline, keep out of partings and belong to a cluster of their own section. Guarantees: a higher density only adds roots; a
//! cluster's key changes with its own roots alone. A cluster that is rooted where no hair grows, or that has no place to itself, has
//! no cell.

use super::plan::{HairIndex, Plan, PlanParams, PlannedHair};
use crate::data::curves::{Curves, Tuft};
use crate::data::scalp::Scalp;
use crate::define::{FieldInput, NodeError};
use crate::eval::{EvalCx, Size};
use crate::maths::hash::{Key, KeyBuilder};
use crate::maths::nearest::KdTree;
use crate::maths::spline::Spline;
use glam::{Mat3, Vec3};
use std::f32::consts::PI;
use std::sync::Arc;

/// Roots per square head unit by which the shape of a cell is told, whatever the density of its hair.
const MEASURE: f32 = 20.0;
/// Fewer of them tell no shape.
const FEW: usize = 8;

/// How much farther than beside them hair is rooted between clusters.
const BETWEEN: f32 = 2.0;
/// A place lies between two clusters if the cosine of the angle at which it sees them is below this: 100 degrees. Where three meet it
/// sees each two at 120; from beside a row, all at less than 90. So many clusters about it are looked at.
const OPPOSITE: f32 = -0.17;
const ABOUT: usize = 12;

/// What a cluster asks of its cell.
#[derive(Clone, Copy, Default)]
pub(super) struct CellParams {
    /// Strands per cm2.
    pub density: f32,
    /// Radius of its disc, cm.
    pub radius: f32,
}

/// The cells of clusters, by the number of the cluster.
#[derive(Default)]
pub(super) struct Cells {
    plan: Arc<Plan>,
    of: Vec<Option<ClusterCell>>,
}

/// Where a cell lies about the root of its cluster, told by places whose number does not hang from the density of its hair.
#[derive(Clone, Copy)]
pub(super) struct CellMoments {
    /// Its middle, cm from the root.
    pub middle: Vec3,
    /// Mean of the squares and products of offsets from there, cm2.
    pub moment: Mat3,
}

impl CellMoments {
    /// Of places by their offsets from the root; of too few as of the disc.
    fn of(offsets: &[Vec3], radius: f32) -> Self {
        if offsets.len() < FEW {
            let moment = Mat3::from_diagonal(Vec3::splat(0.25 * radius * radius));
            return Self { middle: Vec3::ZERO, moment };
        }
        let share = 1.0 / offsets.len().max(1) as f32;
        let middle = offsets.iter().sum::<Vec3>() * share;
        let product = |p: &Vec3| {
            let d = *p - middle;
            Mat3::from_cols(d * d.x, d * d.y, d * d.z)
        };
        let moment = offsets.iter().map(product).fold(Mat3::ZERO, |sum, one| sum + one) * share;
        Self { middle, moment }
    }
}

/// The roots of one cluster.
pub(super) struct ClusterCell {
    /// Hash of its roots.
    pub key: Key,
    pub shape: CellMoments,
    /// In the order in which a rising density adds them.
    hairs: Vec<HairIndex>,
}

impl ClusterCell {
    pub(super) fn count(&self) -> usize {
        self.hairs.len()
    }
}

impl Cells {
    /// Cells that reach `fill` cm beyond the discs, and [`BETWEEN`] times that between clusters, for strands of `points` CVs.
    pub(super) fn new(
        cx: &EvalCx,
        curves: &Curves,
        scalp: &Scalp,
        (fill, points, seed): (f32, usize, i64),
        asked: &[CellParams],
    ) -> Result<Self, NodeError> {
        let area = scalp.spread().area();
        let densest = asked.iter().map(|one| one.density).fold(0.0, f32::max);
        let reached = |one: &CellParams| {
            let reach = one.radius + BETWEEN * fill;
            f64::from(one.density * PI * reach * reach)
        };
        let strands = asked.iter().map(reached).sum::<f64>().min(f64::from(densest) * area);
        let strands = cx.thinned(strands as usize) as f64;
        cx.may_make(&Size::of(&[("strands of all clusters", strands), ("points", points as f64)]))?;
        let all: Vec<(&Tuft, usize)> = curves.each().collect();
        let shares = |number: usize| {
            let (tuft, i) = all[number];
            let root = tuft.curve(i).first().and_then(|root| scalp.closest_root(*root));
            asked[number].density > 0.0
                && root.is_some_and(|root| scalp.grows(root.triangle, root.bary) > 0.0)
                && Spline::new(tuft.curve(i)).is_ok()
        };
        let sharing: Vec<usize> = (0..all.len()).filter(|number| shares(*number)).collect();
        let measure = MEASURE / (cx.unit() * cx.unit());
        let most = |of: fn(&CellParams) -> f32| {
            sharing.iter().map(|number| of(&asked[*number])).fold(0.0, f32::max)
        };
        let everywhere = FieldInput::everywhere(1.0);
        let params = PlanParams {
            count: None,
            density: most(|one| one.density).max(measure),
            mask: &everywhere,
            points,
            neighbours: 1,
            reach: most(|one| one.radius) + BETWEEN * fill,
            seed,
        };
        let guide = |number: &usize| {
            let (tuft, i) = all[*number];
            Arc::new(tuft.gather(&[i as u32]).build())
        };
        let guides: Vec<Arc<Tuft>> = sharing.iter().map(guide).collect();
        let plan = Plan::of(cx, &guides, scalp, &params)?;
        let rooted = KdTree::new(guides.iter().map(|guide| guide.points()[0]));
        // Whether another cluster stands on the side away from this one.
        let is_between = |p: Vec3, root: Vec3| {
            let (mut near, to) = (vec![], (root - p).normalize_or_zero());
            rooted.find(p, ABOUT, &mut near);
            let reach = params.reach * params.reach;
            let opposite = |at: usize| {
                let other = (guides[at].points()[0] - p).normalize_or_zero();
                other.dot(to) < OPPOSITE
            };
            near.iter().any(|(square, at)| *square <= reach && opposite(*at as usize))
        };
        let mut of: Vec<Option<ClusterCell>> = all.iter().map(|_| None).collect();
        for group in &plan.groups {
            let number = sharing[group.guides[0] as usize];
            let CellParams { density, radius } = asked[number];
            let root = all[number].0.curve(all[number].1)[0];
            // The list of roots up to here has so many per cm2.
            let listed = |per_cm2: f32| (f64::from(per_cm2) * area) as u32;
            let near: Vec<(&PlannedHair, HairIndex)> = group
                .hairs
                .iter()
                .map(|at| (plan.hair(*at).0, *at))
                .filter(|(hair, _)| {
                    let beyond = hair.point.distance(root) - radius;
                    beyond <= fill || beyond <= BETWEEN * fill && is_between(hair.point, root)
                })
                .collect();
            let up_to = |last: u32| near.iter().filter(move |(hair, _)| hair.index < last);
            let hairs: Vec<HairIndex> = up_to(listed(density)).map(|(_, at)| *at).collect();
            if hairs.is_empty() {
                continue;
            }
            let measured = up_to(listed(measure)).map(|(hair, _)| hair.point - root);
            let shape = CellMoments::of(&measured.collect::<Vec<Vec3>>(), radius);
            let moment = shape.moment.to_cols_array();
            let key = KeyBuilder::new("cell").vec3(shape.middle).column(&moment);
            let key = hairs.iter().fold(key, |key, hair| key.int(plan.hair(*hair).0.name));
            of[number] = Some(ClusterCell { key: key.finish(), shape, hairs });
        }
        Ok(Self { plan, of })
    }

    /// The cell of a cluster.
    pub(super) fn of(&self, number: usize) -> Option<&ClusterCell> {
        self.of.get(number)?.as_ref()
    }

    /// The first roots of a cell.
    pub(super) fn roots<'a>(
        &'a self,
        cell: &'a ClusterCell,
        count: usize,
    ) -> impl ExactSizeIterator<Item = &'a PlannedHair> {
        cell.hairs.iter().take(count).map(|hair| self.plan.hair(*hair).0)
    }
}

#[cfg(test)]
mod tests {
    use crate::data::attributes::{Domain, ID, PARENT, ROOT_BARY, ROOT_TRIANGLE};
    use crate::data::curves::{Curves, Tuft};
    use crate::data::scalp::Scalp;
    use crate::define::Value;
    use crate::eval::{Log, Quality};
    use crate::guides::even_roots::EvenRoots;
    use crate::maths::hash::Dice;
    use crate::maths::nearest::KdTree;
    use crate::testing::{Memory, curves_of, run, run_on, with_points};
    use glam::Vec3;
    use std::sync::Arc;
    use std::sync::atomic::Ordering;

    const STRANDS: i64 = 64;

    fn number(name: &str, x: f32) -> (&str, Value) {
        (name, Value::Float(x))
    }

    /// The built-in head, parted in the middle where that is asked for.
    fn head(parted: bool) -> Arc<Scalp> {
        let head = crate::testing::head(&[]);
        let set = [
            ("scalp", head.clone().into()),
            ("pattern", "straight_back".into()),
            ("count", 3i32.into()),
        ];
        let partings = crate::by_id("partings").unwrap();
        match run(partings, &set).0.remove(0) {
            Value::Scalp(scalp) if parted => scalp,
            _ => head,
        }
    }

    /// Clusters all over the head, as far apart as hands draw them.
    fn clusters(scalp: &Arc<Scalp>) -> Curves {
        let set = [("scalp", scalp.clone().into()), ("count", 45i32.into()), number("length", 9.0)];
        curves_of(&run(crate::by_id("scatter_guides").unwrap(), &set).0[0]).clone()
    }

    fn set(scalp: &Arc<Scalp>, curves: &Curves, fill: f32) -> Vec<(&'static str, Value)> {
        vec![
            ("scalp", scalp.clone().into()),
            ("curves", curves.clone().into()),
            ("strands", Value::Int(STRANDS)),
            number("density", 1.0),
            number("radius", 1.0),
            number("fill", fill),
        ]
    }

    fn filled(scalp: &Arc<Scalp>, curves: &Curves, fill: f32) -> Curves {
        let node = crate::by_id("cluster_to_strands").unwrap();
        let (out, said) = run(node, &set(scalp, curves, fill));
        let said: Vec<_> = said.iter().filter(|said| !said.contains("lengths")).collect();
        assert!(said.iter().all(|said| said.contains("parting")), "{said:?}");
        curves_of(&out[0]).clone()
    }

    fn roots(hair: &Curves) -> Vec<Vec3> {
        hair.each().map(|(tuft, i)| tuft.curve(i)[0]).collect()
    }

    /// Places of the region where hair grows in full, away from its edge.
    fn places(scalp: &Scalp, count: u32) -> Vec<Vec3> {
        let even = EvenRoots::new(scalp, Dice::new(9, 9, "places"));
        let root = |i| even.root(i).map(|(_, root)| root);
        let full =
            (0..count).filter_map(root).filter(|root| scalp.grows(root.triangle, root.bary) > 0.99);
        full.map(|root| root.point).collect()
    }

    #[test]
    fn clusters_that_fill_leave_no_skin_bare_up_to_the_hairline_and_are_even() {
        for parted in [false, true] {
            let scalp = head(parted);
            let clusters = clusters(&scalp);
            let barest = |hair: &Curves| {
                let tree = KdTree::new(roots(hair));
                let mut near = vec![];
                let mut off = |p: &Vec3| {
                    tree.find(*p, 1, &mut near);
                    near[0].0.sqrt()
                };
                places(&scalp, 4000).iter().map(&mut off).fold(0.0, f32::max)
            };
            let (discs, full) = (filled(&scalp, &clusters, 0.0), filled(&scalp, &clusters, 5.0));
            assert!(barest(&discs) > 1.0, "{}", barest(&discs));
            assert!(barest(&full) < 0.8, "parted {parted}: {}", barest(&full));
            // As dense as its clusters are, everywhere alike.
            let tree = KdTree::new(roots(&full));
            let dense = STRANDS as f32 / std::f32::consts::PI;
            let (mut near, mut counts) = (vec![], vec![]);
            let inside = |p: &Vec3| {
                let around = |k: u32| {
                    let to =
                        [Vec3::X, Vec3::Y, Vec3::Z][k as usize / 2] * [1.2, -1.2][k as usize % 2];
                    scalp.closest_root(*p + to).unwrap()
                };
                (0..6).all(|k| scalp.grows(around(k).triangle, around(k).bary) > 0.99)
            };
            for p in places(&scalp, 400).into_iter().filter(inside) {
                let area = crate::testing::area_within(&scalp, p, 1.0);
                tree.find(p, 400, &mut near);
                let count = near.iter().filter(|(square, _)| *square < 1.0).count();
                counts.push(count as f32 / (area * dense));
            }
            counts.sort_by(f32::total_cmp);
            let middle = &counts[counts.len() / 20..counts.len() * 19 / 20];
            let [least, most] = [middle[0], middle[middle.len() - 1]];
            assert!(least > if parted { 0.6 } else { 0.75 } && most < 1.3, "{least} {most}");
        }
    }

    #[test]
    fn between_clusters_hair_fills_twice_as_far_as_beside_them() {
        let scalp = head(false);
        // Seven in a ring about the crown, and a row along the middle of the head.
        let grown = |at: Vec<Vec3>| {
            let tuft = |(n, p): (usize, Vec3)| {
                let root = scalp.closest_root(p).unwrap();
                let mut b = crate::data::curves::TuftBuilder::new();
                let points: Vec<Vec3> =
                    (0..8).map(|k| root.point + root.normal * k as f32).collect();
                b.push_curve(&points);
                b.set(ID, Domain::Curve, vec![n as u64 + 1]);
                Arc::new(b.build())
            };
            Curves::new(at.into_iter().enumerate().map(tuft).collect())
        };
        let barest = |clusters: &Curves, fill: f32, p: Vec3| {
            let p = scalp.closest_root(p).unwrap().point;
            let hair = roots(&filled(&scalp, clusters, fill));
            hair.iter().map(|root| root.distance(p)).fold(f32::MAX, f32::min)
        };
        let frame = scalp.frame();
        let top = frame.origin + frame.up * 20.0;
        let ring = (0..7).map(|k| {
            let (sin, cos) = crate::maths::transcendental::sin_cos(k as f32 * 0.9);
            frame.origin + Vec3::new(6.0 * cos, 6.0, 6.0 * sin)
        });
        let ring = grown(ring.collect());
        assert!(barest(&ring, 2.0, top) > 1.0, "too far for this");
        assert!(barest(&ring, 4.0, top) < 0.5, "{}", barest(&ring, 4.0, top));
        // Beside a row, hair reaches no farther than it is told to.
        let row = grown((0..6).map(|k| Vec3::new(0.0, 20.0, 5.0 - 2.5 * k as f32)).collect());
        let hair = roots(&filled(&scalp, &row, 3.0));
        let far = |p: &Vec3| {
            let each = row.tufts().iter().map(|tuft| tuft.points()[0].distance(*p));
            each.fold(f32::MAX, f32::min)
        };
        let astray: Vec<&Vec3> = hair.iter().filter(|p| far(p) > 4.01).collect();
        assert!(hair.len() > 500 && astray.is_empty(), "{}: {astray:?}", hair.len());
    }

    #[test]
    fn hair_that_fills_belongs_to_a_cluster_of_its_section_and_is_bound_to_the_skin() {
        let scalp = head(true);
        let clusters = clusters(&scalp);
        let cut = scalp.sections().unwrap();
        let hair = filled(&scalp, &clusters, 5.0);
        for (tuft, i) in hair.each() {
            let parent = tuft.view(PARENT).at(i, tuft.range(i).start);
            let own = clusters.each().find(|(cluster, k)| cluster.id(*k) == parent).unwrap();
            let (root, of) = (tuft.curve(i)[0], own.0.curve(own.1)[0]);
            assert_eq!(cut.at(root).map(|at| at.section), cut.at(of).map(|at| at.section));
            let triangle = u32::try_from(tuft.view(ROOT_TRIANGLE).at(i, 0)).unwrap();
            let bound = scalp.surface().at(triangle, tuft.view(ROOT_BARY).at(i, 0));
            assert!(bound.distance(root) < 1e-4);
            assert!(root.distance(of) <= 6.0 + 1e-4);
        }
    }

    #[test]
    fn more_density_only_adds_and_one_moved_cluster_makes_few_again() {
        let (scalp, host) = (head(false), Memory::default());
        let clusters = clusters(&scalp);
        let node = crate::by_id("cluster_to_strands").unwrap();
        let grow = |clusters: &Curves, density: f32| {
            let mut set = set(&scalp, clusters, 5.0);
            set.retain(|(name, _)| *name != "density");
            set.push(number("density", density));
            let log = Log::default();
            let out = run_on(node, &set, &host, &log, Quality::Final).unwrap();
            (curves_of(&out[0]).clone(), log.tufts_run.load(Ordering::Relaxed))
        };
        let ((half, _), (full, _)) = (grow(&clusters, 0.5), grow(&clusters, 1.0));
        assert!(half.curve_count().abs_diff(full.curve_count() / 2) < 60);
        for (few, many) in half.tufts().iter().zip(full.tufts()) {
            assert_eq!(few.points(), &many.points()[..few.points().len()]);
            assert!((0..few.len()).all(|i| few.id(i) == many.id(i)));
        }
        // One cluster of 45 that moves, root and all, by 4 mm along the skin.
        let moved = |(n, tuft): (usize, &Arc<Tuft>)| match n {
            20 => {
                let to = scalp.closest_root(tuft.curve(0)[0] + Vec3::new(0.3, 0.2, 0.2)).unwrap();
                let by = to.point - tuft.curve(0)[0];
                Arc::new(with_points(tuft, |points| points.iter_mut().for_each(|p| *p += by)))
            }
            _ => tuft.clone(),
        };
        let other = Curves::new(clusters.tufts().iter().enumerate().map(moved).collect());
        let (_, ran) = grow(&other, 1.0);
        assert!((2..=10).contains(&ran), "{ran} clusters");
    }
}
