//! What became of a groom on another head, in numbers. The fields are a contract: `docs/fit.md` has them.

use crate::jobs::report::{Fit, Parted, Roots};
use crate::jobs::stop::Stop;
use coif_graphs::document::NodeId;
use coif_nodes::data::curves::Curves;
use coif_nodes::data::scalp::Scalp;
use coif_nodes::eval::PlainHost;
use coif_nodes::formats::export;
use coif_nodes::laws::{MeasuredHair, depth};
use glam::Vec3;
use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write;
use std::sync::Arc;

/// What a graph gave on one head.
pub(super) struct FitResult {
    pub(super) groups: Vec<export::HairGroup>,
    pub(super) scalp: Arc<Scalp>,
    pub(super) parted: Vec<(NodeId, Arc<Scalp>)>,
    /// Curves of the nodes that root some.
    pub(super) sources: Vec<(NodeId, Curves)>,
}

/// What lies farther from where it is to lie has missed it, cm on a head of average size.
const MISSES: f32 = 0.5;

impl Fit {
    /// What `made`, on a head to which `carried` has the map, is beside what was there at home. `check` may end the work.
    pub(super) fn of(
        home: &FitResult,
        carried: &Scalp,
        made: &FitResult,
        (landmarks, baked): (&str, bool),
        check: &dyn Fn() -> Result<(), Stop>,
    ) -> Result<Self, Stop> {
        let heads = [&*home.scalp, carried];
        let mut roots = vec![];
        for ((node, before), (_, after)) in home.sources.iter().zip(&made.sources) {
            check()?;
            roots.push(Roots::of(node.to_string(), heads, before, after));
        }
        for before in &home.groups {
            check()?;
            let after = made.groups.iter().find(|after| after.name == before.name);
            let none = Curves::default();
            let after = after.map_or(&none, |after| &after.curves);
            roots.push(Roots::of(format!("output {}", before.name), heads, &before.curves, after));
        }
        let sections = home.parted.iter().zip(&made.parted);
        let (mut inside, mut deepest) = (0, 0f32);
        for group in made.groups.iter().filter(|group| !group.guides) {
            let (some, deep) = under_the_skin(&group.curves, &made.scalp, check)?;
            (inside, deepest) = (inside + some, deepest.max(deep));
        }
        let carry = carried.space().carry();
        Ok(Self {
            home: landmarks.to_owned(),
            landmarks: carried.landmarks().to_string(),
            part: carry.map_or(1.0, |carry| carry.part()),
            stretch: stretch(carried),
            baked,
            roots,
            sections: sections.map(|((node, a), (_, b))| Parted::of(node, a, b)).collect(),
            inside,
            deepest_cm: deepest,
        })
    }

    /// For a person.
    pub(super) fn report(&self) -> String {
        let mut text = format!("landmarks: {}\n", self.landmarks);
        let [low, middle, high] = self.stretch;
        let _ = writeln!(
            text,
            "the map stretches the region by {low:.2} to {high:.2}, {middle:.2} in the middle; {:.0} % of it is taken",
            self.part * 100.0
        );
        for Roots { name, home, here, lost, new, outside, missed, drift_cm } in &self.roots {
            let drift = drift_cm.map_or(String::new(), |[a, b, c]| {
                format!(", drift {a:.2} cm, 95 % {b:.2}, most {c:.2}")
            });
            let _ = writeln!(
                text,
                "{name}: {home} roots at home, {here} here{drift}; {lost} lost, {new} new, {outside} outside the region, {missed} missed"
            );
        }
        for Parted { node, home, here, gone, new } in &self.sections {
            let list = |what: &str, names: &[String]| match names.is_empty() {
                true => String::new(),
                false => format!("; {what}: {}", names.join(", ")),
            };
            let (gone, new) = (list("gone", gone), list("new", new));
            let _ = writeln!(text, "{node}: {home} sections at home, {here} here{gone}{new}");
        }
        let _ = writeln!(text, "{} hairs inside the head", self.inside);
        text
    }
}

impl Roots {
    fn of(name: String, [home, here]: [&Scalp; 2], before: &Curves, after: &Curves) -> Self {
        let (was, is) = (by_id(before), by_id(after));
        let grows = |scalp: &Scalp, p: Vec3| {
            scalp.closest_root(p).is_some_and(|root| scalp.grows(root.triangle, root.bary) >= 0.5)
        };
        let both = was.iter().filter_map(|(id, p)| Some((*p, *is.get(id)?)));
        let both: Vec<(Vec3, Vec3)> = both.collect();
        let mut drift: Vec<f32> =
            both.iter().map(|(p, q)| here.place(home.given(*p)).distance(*q)).collect();
        drift.sort_by(f32::total_cmp);
        let at = |part: f32| drift[((drift.len() - 1) as f32 * part) as usize];
        let far = MISSES * here.frame().unit();
        Self {
            name,
            home: was.len(),
            here: is.len(),
            lost: was.len() - both.len(),
            new: is.len() - both.len(),
            outside: both.iter().filter(|(p, q)| grows(home, *p) && !grows(here, *q)).count(),
            missed: drift.iter().filter(|off| **off > far).count(),
            drift_cm: (!drift.is_empty()).then(|| [0.5, 0.95, 1.0].map(at)),
        }
    }
}

impl Parted {
    fn of(node: &NodeId, before: &Scalp, after: &Scalp) -> Self {
        let names = |scalp: &Scalp| -> BTreeSet<String> {
            let list = scalp.sections().map_or(&[][..], |sections| sections.list());
            list.iter().map(|section| section.name.clone()).collect()
        };
        let (was, is) = (names(before), names(after));
        Self {
            node: node.to_string(),
            home: was.len(),
            here: is.len(),
            gone: was.difference(&is).cloned().collect(),
            new: is.difference(&was).cloned().collect(),
        }
    }
}

/// The first point of each curve by its id.
fn by_id(curves: &Curves) -> BTreeMap<u64, Vec3> {
    let first = |(tuft, i): (&coif_nodes::data::curves::Tuft, usize)| {
        Some((tuft.id(i), *tuft.curve(i).first()?))
    };
    curves.each().filter_map(first).collect()
}

/// How many curves go deeper under the skin than they may (and 0.001 cm of rounding), and how deep the deepest point lies.
fn under_the_skin(
    curves: &Curves,
    scalp: &Scalp,
    check: &dyn Fn() -> Result<(), Stop>,
) -> Result<(usize, f32), Stop> {
    let (mut inside, mut deepest) = (0, 0f32);
    for tuft in curves.tufts() {
        check()?;
        let one = Curves::new(vec![tuft.clone()]);
        let found = depth::measure(&MeasuredHair::of(&one, &PlainHost), scalp);
        (inside, deepest) = (inside + found.curves, deepest.max(found.deepest_cm));
    }
    Ok((inside, deepest))
}

/// Least, middle and most stretch of the map over the region.
fn stretch(scalp: &Scalp) -> [f32; 3] {
    let space = scalp.space();
    let Some(carry) = space.carry() else { return [1.0; 3] };
    let grown =
        scalp.surface().points.iter().zip(scalp.region()).filter(|(_, grows)| **grows > 0.5);
    let all = grown.map(|(p, _)| carry.stretch(space.given(*p)));
    let mut all: Vec<[f32; 3]> = all.collect();
    if all.is_empty() {
        return [1.0; 3];
    }
    all.sort_by(|a, b| a[1].total_cmp(&b[1]));
    let middle = all[all.len() / 2][1];
    let least = all.iter().fold(f32::MAX, |least, one| least.min(one[0]));
    [least, middle, all.iter().fold(0.0, |most, one| f32::max(most, one[2]))]
}
