//! Partings: hairs that cross one, and hairs rooted in one.
//!
//! [`Partings`] are read from hair alone. Where the parted scalp itself is at hand, [`over_lines`] asks its map, and looks at as much
//! hair as it is asked to: that is for what warns while a groom is written.
//!
//! Partings are curves with a `parting` number, mostly guides; their `radius` is half the parting's width and
//! their `scalp_normal` the way off the skin. A hair can cross a parting only where it lies on the scalp: from its root until it
//! is farther off the skin than 0.25 cm, has joined a braid or has passed the tie that holds it, behind which it hangs. Where
//! `along` is told point by point a hair has joined where that begins to grow; the step that leads into its strand is the
//! braid's, which may be wider than its section.

use super::hair::{AttributeValues, MeasuredHair, in_parts};
use super::ties::TieAttributes;
use crate::data::curves::Curves;
use crate::data::scalp::Scalp;
use crate::data::sections::Sections;
use crate::eval::Host;
use crate::formats::conform::{joins as joins_its_braid, leading, passes_its_tie};
use crate::maths::drawn_span::DrawnSpan;
use crate::maths::nearest_on;
use glam::Vec3;
use std::cmp::Ordering;
use std::ops::Range;
use std::sync::Arc;

/// How hair keeps to partings.
#[derive(Clone, Debug, PartialEq)]
pub struct Parted {
    /// Partings, of all that tell some together.
    pub partings: usize,
    /// Half their width, cm: smallest and largest.
    pub half_width_cm: [f32; 2],
    /// Number of hairs that cross one on the scalp.
    pub crossing: usize,
    /// Number of hairs rooted within half the width of one.
    pub rooted_in: usize,
}

/// Height above the skin, cm, beyond which hair passes over a parting without crossing it.
const ON: f32 = 0.25;
/// Length, cm, up to which hair of a braid counts where it does not carry the place it joins.
const TO_ITS_BRAID: f32 = 1.0;
/// Depth of a root within a parting's width that counts as rounding, cm.
const ROUNDING: f32 = 0.005;

/// A segment of a parting.
#[derive(Clone, Copy)]
struct Piece {
    from: Vec3,
    to: Vec3,
    up: Vec3,
    half: f32,
}

/// All partings, indexed by place.
pub struct Partings {
    count: usize,
    half: [f32; 2],
    pieces: Vec<Piece>,
    low: Vec3,
    size: [usize; 3],
    cells: Vec<Vec<u32>>,
}

const CELL: f32 = 0.5;

impl Partings {
    /// The partings among all these curves; `None` without any.
    pub fn of(all: &[MeasuredHair]) -> Option<Self> {
        let mut pieces = vec![];
        let mut ids = vec![];
        for hair in all {
            let Some(parting) = hair.whole("parting") else { continue };
            let (radius, normal) = (hair.numbers("radius"), hair.vectors("scalp_normal"));
            for i in (0..hair.len()).filter(|i| parting[*i] != 0) {
                ids.push(parting[i]);
                let first = hair.range(i).start;
                for (k, w) in hair.curve(i).windows(2).enumerate() {
                    let up = normal
                        .as_ref()
                        .map_or(Vec3::ZERO, |n| n.at(i, first + k) + n.at(i, first + k + 1));
                    pieces.push(Piece {
                        from: w[0],
                        to: w[1],
                        up: up.normalize_or_zero(),
                        half: radius.as_ref().map_or(0.0, |r| r.at(i, first + k)),
                    });
                }
            }
        }
        let first = pieces.first()?;
        ids.sort_unstable();
        ids.dedup();
        let half =
            pieces.iter().fold([first.half; 2], |[lo, hi], p| [lo.min(p.half), hi.max(p.half)]);
        let (lo, hi) = pieces.iter().fold((first.from, first.from), |(lo, hi), p| {
            (lo.min(p.from).min(p.to), hi.max(p.from).max(p.to))
        });
        let margin = Vec3::splat(ON.max(half[1]) + 0.1);
        let (low, high) = (lo - margin, hi + margin);
        let size = ((high - low) / CELL).to_array().map(|x| (x.max(0.0) as usize + 1).min(400));
        let mut out = Self {
            count: ids.len(),
            half,
            pieces,
            low,
            size,
            cells: vec![vec![]; size[0] * size[1] * size[2]],
        };
        for n in 0..out.pieces.len() {
            let p = out.pieces[n];
            let (a, b) = (p.from.min(p.to) - margin, p.from.max(p.to) + margin);
            let (a, b) = (out.clamped(a), out.clamped(b));
            for x in a[0]..=b[0] {
                for y in a[1]..=b[1] {
                    for z in a[2]..=b[2] {
                        let cell = (x * size[1] + y) * size[2] + z;
                        out.cells[cell].push(n as u32);
                    }
                }
            }
        }
        Some(out)
    }

    fn clamped(&self, p: Vec3) -> [usize; 3] {
        let at = ((p - self.low) / CELL).to_array();
        [0, 1, 2].map(|a| (at[a].max(0.0) as usize).min(self.size[a] - 1))
    }

    fn near(&self, p: Vec3) -> impl Iterator<Item = &Piece> {
        let at = (p - self.low) / CELL;
        let inside = at.min_element() >= 0.0
            && [at.x, at.y, at.z].iter().zip(self.size).all(|(x, n)| *x < n as f32);
        let cell = if inside {
            let [x, y, z] = self.clamped(p);
            &self.cells[(x * self.size[1] + y) * self.size[2] + z][..]
        } else {
            &[]
        };
        cell.iter().map(|n| &self.pieces[*n as usize])
    }

    /// How hair keeps to them.
    pub fn judge(&self, hair: &MeasuredHair) -> Parted {
        let joined = hair.numbers("along").filter(AttributeValues::is_of_points);
        let braid = hair.whole("braid");
        let tied = TieAttributes::of(hair);
        let is_smooth = hair.is_of_coifs_form();
        let parts = hair.in_parts(hair.len(), 1000, |part| {
            let (mut crossing, mut rooted_in) = (0, 0);
            for i in part {
                let points = hair.curve(i);
                let Some(root) = points.first() else { continue };
                rooted_in +=
                    usize::from(self.near(*root).any(|p| p.distance(*root) < p.half - ROUNDING));
                let braided = braid.as_ref().is_some_and(|b| b[i] != 0);
                let held = tied.as_ref().and_then(|tied| tied.until(hair, i));
                let mut s = 0.0;
                let until = match &joined {
                    Some(along) if braided => joins(along, i, hair.range(i)),
                    _ => points.len(),
                };
                for (k, w) in points.windows(2).enumerate().take(until) {
                    s += w[0].distance(w[1]);
                    let hangs = held.is_some_and(|held| s > held);
                    if hangs || braided && joined.is_none() && s > TO_ITS_BRAID {
                        break;
                    }
                    let span = match is_smooth {
                        true => DrawnSpan::of(points, k),
                        false => DrawnSpan::straight(w[0], w[1]),
                    };
                    if self.crossed(&span) {
                        crossing += 1;
                        break;
                    }
                }
            }
            (crossing, rooted_in)
        });
        Parted {
            partings: self.count,
            half_width_cm: self.half,
            crossing: parts.iter().map(|p| p.0).sum(),
            rooted_in: parts.iter().map(|p| p.1).sum(),
        }
    }

    /// Whether a span crosses a parting on the skin.
    fn crossed(&self, span: &DrawnSpan) -> bool {
        // It is tested in pieces shorter than a cell.
        let (_, radius) = span.ball();
        let pieces = (2.0 * radius / (0.5 * CELL)).ceil().clamp(1.0, 200.0) as usize;
        (0..pieces).any(|k| {
            let at = |k: usize| span.at(k as f32 / pieces as f32);
            let (a, b) = (at(k), at(k + 1));
            self.near((a + b) * 0.5).any(|piece| piece.is_crossed(a, b))
        })
    }
}

/// How many steps a hair of a braid takes before the one that leads into its strand, by where it is `along` its braid.
fn joins(along: &AttributeValues<f32>, i: usize, points: Range<usize>) -> usize {
    let root = along.at(i, points.start);
    // What is no number says nothing of a braid: such a hair is judged to its end.
    let grows = |k: usize| along.at(i, k).partial_cmp(&root) == Some(Ordering::Greater);
    let on_way = points.take_while(|k| !grows(*k)).count();
    on_way.saturating_sub(2)
}

impl Piece {
    fn distance(&self, p: Vec3) -> f32 {
        p.distance(nearest_on([self.from, self.to], p).0)
    }
    fn is_crossed(&self, a: Vec3, b: Vec3) -> bool {
        let along = self.to - self.from;
        let aside = self.up.cross(along);
        let side = |p: Vec3| (p - self.from).dot(aside);
        let (sa, sb) = (side(a), side(b));
        if (sa > 0.0) == (sb > 0.0) || aside == Vec3::ZERO {
            return false;
        }
        let q = a.lerp(b, sa / (sa - sb)) - self.from;
        let t = q.dot(along) / along.length_squared().max(1e-12);
        // Where a line climbs an ear its way is nearly the skin's normal, so only the distance from it tells how near it is.
        (0.0..1.0).contains(&t) && q.distance(along * t) < ON
    }
}

/// Of every so many curves one, how many lead over a parting of the scalps `parted`, and how many were looked at. Hair of a braid
/// counts up to where it joins that, hair that is held by a tie up to that. None where somebody asked to stop.
pub fn over_lines(
    curves: &Curves,
    parted: &[Arc<Scalp>],
    every: usize,
    host: &dyn Host,
) -> Option<[usize; 2]> {
    let sections = leading(parted);
    if sections.is_empty() {
        return Some([0; 2]);
    }
    let every = every.max(1);
    let tufts = curves.tufts();
    let starts: Vec<usize> = tufts
        .iter()
        .scan(0, |next, tuft| Some(std::mem::replace(next, *next + tuft.len())))
        .collect();
    let found = in_parts(host, tufts.len(), 1, |part| {
        let (tuft, start) = (&tufts[part.start], starts[part.start]);
        let first = start.next_multiple_of(every) - start;
        let (mut over, mut looked) = (0, 0);
        for i in (first..tuft.len()).step_by(every).take_while(|_| !host.cancelled()) {
            let points = tuft.curve(i);
            let free = joins_its_braid(tuft, i).or_else(|| passes_its_tie(tuft, i));
            let until = free.map_or(points.len(), |last| last + 1);
            let is_over = |sections: &&Sections| sections.is_over_line_before(points, until);
            over += usize::from(sections.iter().any(is_over));
            looked += 1;
        }
        [over, looked]
    });
    let sum = |sum: [usize; 2], [over, looked]: [usize; 2]| [sum[0] + over, sum[1] + looked];
    (!host.cancelled()).then(|| found.into_iter().fold([0; 2], sum))
}

#[cfg(test)]
mod tests {
    use super::super::hair::tests::read_of;
    use super::*;
    use crate::data::attributes::{Domain, TIE, TIE_RADIUS};
    use crate::data::curves::TuftBuilder;
    use crate::eval::PlainHost;
    use crate::formats::conform::tests::{arc, parted_ball};
    use crate::formats::usd::read::{ReadCurves, ReadValues};

    /// A parting along z on the plane y = 0.
    fn parting() -> ReadCurves {
        let line: Vec<Vec3> = (0..10).map(|k| Vec3::Z * k as f32).collect();
        read_of(
            &[&line],
            &[
                ("parting", ReadValues::Int(vec![7])),
                ("radius", ReadValues::Float(vec![0.1])),
                ("scalp_normal", ReadValues::Float3(vec![Vec3::Y])),
            ],
        )
    }

    #[track_caller]
    fn check(hair: &[Vec3], crossing: usize, rooted_in: usize) {
        let (parting, hair) = (parting(), read_of(&[hair], &[]));
        let partings = Partings::of(&[MeasuredHair::read(&parting, &PlainHost)]).unwrap();
        let found = partings.judge(&MeasuredHair::read(&hair, &PlainHost));
        assert_eq!((found.crossing, found.rooted_in), (crossing, rooted_in));
        assert_eq!((found.partings, found.half_width_cm), (1, [0.1; 2]));
    }

    #[test]
    fn hair_crosses_only_where_it_lies_on_the_skin() {
        let at = |x: f32, y: f32| Vec3::new(x, y, 4.5);
        check(&[at(-1.0, 0.0), at(-0.5, 0.1), at(0.5, 0.1), at(1.0, 0.5)], 1, 0);
        check(&[at(-1.0, 0.0), at(-0.5, 0.5), at(0.5, 0.5), at(1.0, 0.5)], 0, 0);
        check(&[at(-1.0, 0.0), at(-0.5, 0.1), at(-0.3, 0.1)], 0, 0);
        check(&[at(-30.0, 0.0), at(30.0, 0.1)], 1, 0);
        check(&[at(-0.05, 0.0), at(-2.0, 0.1)], 0, 1);
        let beyond = Vec3::Z * 10.0;
        check(&[at(-1.0, 0.0) + beyond, at(1.0, 0.0) + beyond], 0, 0);
    }

    #[test]
    fn hair_in_its_braid_may_pass_over_and_none_on_its_way_to_it() {
        let parting = parting();
        // `along` tells where each point is in the braid; on its way to it a hair has the place where it will join.
        let check = |along: [f32; 5], crossing: usize| {
            let at = |x: f32| Vec3::new(x, 0.05, 4.5);
            let hair = read_of(
                &[&[at(-1.0), at(-0.2), at(0.2), at(0.6), at(1.0)]],
                &[
                    ("braid", ReadValues::Int(vec![3])),
                    ("along", ReadValues::Float(along.to_vec())),
                ],
            );
            let partings = Partings::of(&[MeasuredHair::read(&parting, &PlainHost)]).unwrap();
            let found = partings.judge(&MeasuredHair::read(&hair, &PlainHost));
            assert_eq!(found.crossing, crossing, "{along:?}");
        };
        check([0.0, 0.0, 0.1, 0.2, 0.3], 0);
        check([0.3, 0.3, 0.4, 0.5, 0.6], 0);
        check([0.3, 0.3, 0.3, 0.4, 0.5], 0);
        check([0.3, 0.3, 0.3, 0.3, 0.4], 1);
        check([0.0, 0.0, 0.0, 0.0, 0.1], 1);
        check([0.3, 0.3, 0.3, 0.3, 0.3], 1);
        check([f32::NAN; 5], 1);
        check([f32::NAN, 0.3, 0.4, 0.5, 0.6], 1);
    }

    #[test]
    fn hair_may_hang_over_behind_the_tie_that_it_passes_and_not_before() {
        let parting = parting();
        let check = |tie: Vec3, radius: f32, crossing: usize| {
            let at = |x: f32| Vec3::new(x, 0.05, 4.5);
            let hair = read_of(
                &[&[at(-1.0), at(-0.6), at(-0.2), at(0.2), at(0.6)]],
                &[
                    ("tie", ReadValues::Float3(vec![tie])),
                    ("tie_radius", ReadValues::Float(vec![radius])),
                ],
            );
            let partings = Partings::of(&[MeasuredHair::read(&parting, &PlainHost)]).unwrap();
            let found = partings.judge(&MeasuredHair::read(&hair, &PlainHost));
            assert_eq!(found.crossing, crossing, "{tie} {radius}");
        };
        let before = Vec3::new(-0.6, 0.4, 4.5);
        check(before, 0.3, 0);
        // Behind the parting, not passed, and no tie at all.
        check(Vec3::new(0.6, 0.4, 4.5), 0.3, 1);
        check(before + Vec3::Y, 0.3, 1);
        check(before, 0.0, 1);
        check(before, f32::INFINITY, 1);
        check(before, f32::NAN, 1);
        check(Vec3::NAN, 0.3, 1);
    }

    #[test]
    fn hair_leads_over_a_parting_before_its_tie_and_not_behind() {
        let hair: Vec<Vec3> = (-6..=6)
            .map(|k| {
                let (x, y) = arc(2 * k, 8.95);
                Vec3::new(x, y, 0.1)
            })
            .collect();
        let check = |tie: Vec3, radius: f32, over: usize| {
            let mut b = TuftBuilder::new();
            b.push_curve(&hair);
            b.set(TIE, Domain::Curve, vec![tie]);
            b.set(TIE_RADIUS, Domain::Curve, vec![radius]);
            let curves = Curves::new(vec![Arc::new(b.build())]);
            let found = over_lines(&curves, &parted_ball(), 1, &PlainHost).unwrap();
            assert_eq!(found, [over, 1], "{tie} {radius}");
        };
        let before = hair[3] + Vec3::Y * 0.4;
        check(before, 0.3, 0);
        check(before + Vec3::Y, 0.3, 1);
        check(hair[10], 0.3, 1);
        check(before, 0.0, 1);
        check(before, f32::NAN, 1);
        check(Vec3::NAN, 0.3, 1);
    }
}
