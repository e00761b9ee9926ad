//! The output curves of partings: the lines, the rows of their sections, and the sections' middles.
//!
//! Guarantees: every curve lies on the scalp and is bound to it, carries its parting or section, and has an id that
//! depends only on that. Not promised: rows of sections that are specks.

use super::medial_lines;
use crate::data::attributes::{DRIFT, Domain, ID, PARENT, PARTING, RADIUS, SCALP_NORMAL, SECTION};
use crate::data::chart::{Chart, cell_of};
use crate::data::curves::{Curves, Tuft, TuftBuilder};
use crate::data::scalp::{Root, Scalp};
use crate::data::sections::{Parting, Section, Sections, off_the_scalp};
use crate::define::NodeError;
use crate::eval::EvalCx;
use crate::maths::hash::curve_id;
use crate::maths::polyline::{Polyline, filter};
use crate::maths::spline::Spline;
use crate::scalp::lay::bind;
use glam::{Vec2, Vec3};
use std::collections::BTreeMap;
use std::sync::Arc;

/// Makes the curves.
pub(super) struct Maker<'a> {
    /// The head with its sections.
    pub(super) scalp: &'a Scalp,
    pub(super) chart: &'a Chart,
    /// Centimetres per head unit.
    pub(super) unit: f32,
    pub(super) seed: u64,
    /// The cells of the map that are parted.
    pub(super) part: &'a [bool],
    /// Drift of drawn lines on this head, cm, by the ids of their partings.
    pub(super) drift: BTreeMap<u64, f32>,
}

impl Maker<'_> {
    fn on_scalp(&self, flat: &[Vec2]) -> Vec<Root> {
        flat.iter().filter_map(|q| self.chart.root(self.scalp, *q)).collect()
    }

    /// A parting as a curve.
    pub(super) fn parting(&self, parting: &Parting) -> Option<Tuft> {
        // It begins where it lies on the scalp.
        let off = |p: &&Vec3| {
            self.scalp
                .closest_root(**p)
                .is_none_or(|r| r.point.distance(**p) > 1e-3 * self.chart.unit())
        };
        let root = |p: &Vec3| Some(Root { point: *p, ..self.scalp.closest_root(*p)? });
        let roots: Vec<Root> = parting.points.iter().skip_while(off).filter_map(root).collect();
        if roots.len() < 2 {
            return None;
        }
        let mut b = curve(&roots, parting.id, parting.id);
        let points: Vec<Vec3> = roots.iter().map(|root| root.point).collect();
        b.set(SCALP_NORMAL, Domain::Point, off_the_scalp(self.scalp, &points));
        b.set(PARTING, Domain::Curve, vec![parting.id]);
        if let Some(drift) = self.drift.get(&parting.id) {
            b.set(DRIFT, Domain::Curve, vec![*drift]);
        }
        b.set(RADIUS, Domain::Curve, vec![parting.half_width]);
        Some(b.build())
    }

    /// The centre line of every parted section, starting at the hairline.
    pub(super) fn rows(
        &self,
        cx: &EvalCx,
        sections: &Sections,
        drawn: &[Vec<Vec2>],
        tied: Option<u32>,
    ) -> Result<Curves, NodeError> {
        // A pattern knows the centre lines of its rows better than the shapes between its lines show.
        let mut known: BTreeMap<u32, &[Vec2]> = BTreeMap::new();
        for line in drawn {
            if let Some((section, run)) = medial_lines::longest_run(self.chart, sections, line) {
                known.entry(section).or_insert(run);
            }
        }
        let members = medial_lines::members(sections);
        let mut rows = vec![];
        for (number, section) in (0..).zip(sections.list()) {
            cx.check()?;
            let cells = &members[number as usize];
            let mine = cells.iter().filter(|c| self.part[**c as usize]).count();
            if 2 * mine < cells.len() || tied == Some(number) {
                continue;
            }
            let line = match known.get(&number) {
                Some(line) => Some(line.to_vec()),
                None => medial_lines::line(self.chart, sections, number, cells)
                    .map(|line| medial_lines::from_the_hairline(self.scalp, sections, line)),
            };
            let Some(line) = line.filter(|line| line.len() >= 2) else { continue };
            let roots = self.on_scalp(&line);
            let mut points: Vec<Vec3> = roots.iter().map(|r| r.point).collect();
            filter(&mut points, 2);
            let smooth = Polyline::new(points);
            if smooth.length() < 0.3 * self.unit {
                continue;
            }
            let n = ((smooth.length() / (0.5 * self.unit)).round() as usize).clamp(4, 400) + 1;
            let even = smooth.evenly(n);
            let roots: Vec<Root> =
                even.iter().filter_map(|p| self.scalp.closest_root(*p)).collect();
            if roots.len() < 2 {
                continue;
            }
            let mut b = curve(&roots, curve_id(section.id, self.seed, 0), section.id);
            b.set(SECTION, Domain::Curve, vec![section.id]);
            b.set(
                RADIUS,
                Domain::Point,
                medial_lines::half_widths(self.scalp, number, &roots, self.unit),
            );
            rows.push(Arc::new(b.build()));
        }
        Ok(Curves::new(rows))
    }

    /// The drawn rows, each with the section that most of it lies in.
    pub(super) fn drawn_rows(
        &self,
        cx: &EvalCx,
        sections: &Sections,
        rows: &Curves,
    ) -> Result<Curves, NodeError> {
        let mut out = vec![];
        for (tuft, i) in rows.each() {
            cx.check()?;
            let Ok(spline) = Spline::new(tuft.curve(i)) else { continue };
            let count = ((spline.length() / (0.25 * self.unit)) as usize).clamp(4, 800);
            let mut cells: BTreeMap<u32, usize> = BTreeMap::new();
            spline.resample(count, |p| {
                let cell = cell_of(self.chart.flat(p)).filter(|c| self.part[*c]);
                if let Some(place) = cell.and_then(|_| sections.at(p)) {
                    *cells.entry(place.section).or_default() += 1;
                }
            });
            let Some((number, _)) = cells.into_iter().max_by_key(|(n, most)| (*most, !*n)) else {
                cx.trouble(tuft.id(i), "a row that lies in no section was left out");
                continue;
            };
            let roots: Vec<Root> =
                tuft.curve(i).iter().filter_map(|p| self.scalp.closest_root(*p)).collect();
            let mut b = tuft.gather(&[i as u32]);
            b.set(SECTION, Domain::Curve, vec![sections.list()[number as usize].id]);
            if roots.len() == tuft.curve(i).len() {
                let widths = medial_lines::half_widths(self.scalp, number, &roots, self.unit);
                b.set(RADIUS, Domain::Point, widths);
            }
            out.push(Arc::new(b.build()));
        }
        Ok(Curves::new(out))
    }

    /// A short curve in the middle of every parted section.
    pub(super) fn middles(&self, sections: &Sections) -> Curves {
        let one = |section: &Section| {
            let root = self.scalp.closest_root(section.middle)?;
            // On a mesh without a map, everything is parted.
            let cell = cell_of(self.chart.flat(root.point));
            if !sections.are_of_a_mesh() && !self.part[cell?] {
                return None;
            }
            let at = |k: i32| root.point + root.normal * (k as f32 / 3.0 * self.unit);
            let mut b = TuftBuilder::new();
            b.push_curve(&(0..4).map(at).collect::<Vec<_>>());
            b.set(ID, Domain::Curve, vec![curve_id(section.id, self.seed, 1)]);
            b.set(PARENT, Domain::Curve, vec![section.id]);
            b.set(SECTION, Domain::Curve, vec![section.id]);
            b.set(SCALP_NORMAL, Domain::Curve, vec![root.normal]);
            // The radius of a disc with the section's area.
            let radius = (section.area / std::f32::consts::PI).sqrt();
            b.set(RADIUS, Domain::Curve, vec![radius]);
            bind(&mut b, &[root]);
            Some(Arc::new(b.build()))
        };
        Curves::new(sections.list().iter().filter_map(one).collect())
    }
}

/// A curve through roots.
fn curve(roots: &[Root], id: u64, parent: u64) -> TuftBuilder {
    let mut b = TuftBuilder::new();
    b.push_curve(&roots.iter().map(|r| r.point).collect::<Vec<_>>());
    b.set(ID, Domain::Curve, vec![id]);
    b.set(PARENT, Domain::Curve, vec![parent]);
    b.set(SCALP_NORMAL, Domain::Point, roots.iter().map(|r| r.normal).collect());
    bind(&mut b, &roots[..1]);
    b
}
