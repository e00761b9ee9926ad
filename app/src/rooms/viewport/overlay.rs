//! Lines and dots over the picture: selected curves, guides, partings and roots.
//!
//! Curves behind the skull are drawn dimmed, what lies on its far side is not. Partings and roots are found on a thread beside the window, for there may be
//! very many; everything is found once an evaluation. Not guaranteed: that hair before a line hides it; a line that hair hid
//! would be of little use.

use super::options::Options;
use crate::core::projection::Projection;
use crate::core::shown::Shown;
use crate::core::state::State;
use crate::widgets::theme;
use coif_nodes::data::attributes::{BRAID, PARENT};
use coif_nodes::data::curves::{Curves, Tuft};
use coif_nodes::data::scalp::Scalp;
use coif_nodes::maths::hash::Key;
use coif_nodes::maths::nearest::KdTree;
use coif_shaders::Sphere;
use egui::{Color32, Painter, Pos2, Shape, Stroke};
use glam::{Vec2, Vec3};
use std::collections::BTreeSet;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, TryRecvError, channel};

/// Curves that are drawn at most, of those that are selected or followed.
const MOST_CURVES: usize = 600;
/// Points of a curve that are drawn at most.
const MOST_POINTS: usize = 48;
/// Dots that are drawn at most.
const MOST_ROOTS: usize = 12_000;
/// Skin farther than this from every root has no partings, cm.
const GROWN: f32 = 1.5;
/// Part of the head's radius that hides what is behind it: a little less than all, so that what lies on the skin is seen.
const SOLID: f32 = 0.93;

const SELECTED: Color32 = theme::ACCENT.dark;
const GUIDE: Color32 = Color32::from_rgb(120, 200, 255);
const PARTING: Color32 = Color32::from_rgb(255, 235, 160);
const ROOT: Color32 = Color32::from_rgb(150, 230, 170);

/// All of it, as it was last found.
#[derive(Default)]
pub(super) struct Overlay {
    of: Option<Arc<Shown>>,
    selected: (BTreeSet<u64>, Vec<Vec<Vec3>>),
    guides: (Option<Key>, Vec<Vec<Vec3>>),
    skin: Option<SkinLines>,
    finding: Option<Receiver<SkinLines>>,
}

/// What lies on the skin.
#[derive(Clone, Debug, Default)]
struct SkinLines {
    partings: Vec<[Vec3; 2]>,
    roots: Vec<Vec3>,
}

impl Overlay {
    /// Whether partings and roots are being found.
    pub(super) fn is_finding(&self) -> bool {
        self.finding.is_some()
    }

    pub(super) fn ui(
        &mut self,
        state: &State,
        options: &Options,
        followed: &Curves,
        view: &Projection,
        ui: &egui::Ui,
    ) {
        let Some(shown) = &state.shown else { return };
        if !self.of.as_ref().is_some_and(|of| Arc::ptr_eq(of, shown)) {
            self.of = Some(shown.clone());
            self.selected = Default::default();
            (self.skin, self.finding) = (None, None);
        }
        self.take_found();
        let painter = ui.painter_at(view.rect);
        let ball = shown.scalp().map(|scalp| {
            let frame = scalp.frame();
            Sphere { centre: frame.origin, radius: SOLID * frame.radius }
        });
        let draw = Draw { painter: &painter, view, ball };
        if options.partings || options.roots {
            self.skin_lines(shown, ui.ctx());
            let found = self.skin.iter();
            for lines in found {
                if options.roots {
                    lines.roots.iter().for_each(|p| draw.dot(*p, ROOT));
                }
                if options.partings {
                    let seen = |line: &&[Vec3; 2]| !draw.hidden(line[0]);
                    let seen = lines.partings.iter().filter(seen);
                    seen.for_each(|line| draw.line(line, 1.5, PARTING));
                }
            }
        }
        if options.guides {
            if self.guides.0 != Some(followed.key()) {
                let all = followed.each().map(|(tuft, i)| tuft.curve(i));
                self.guides = (Some(followed.key()), thinned(all, followed.curve_count()));
            }
            self.guides.1.iter().for_each(|line| draw.line(line, 1.2, GUIDE));
        }
        if self.selected.0 != state.selection.curves {
            let ids = &state.selection.curves;
            let named = shown.curves.each().filter(|(tuft, i)| ids.contains(&tuft.id(*i)));
            let lines = thinned(named.map(|(tuft, i)| tuft.curve(i)), ids.len());
            self.selected = (ids.clone(), lines);
        }
        self.selected.1.iter().for_each(|line| draw.line(line, 1.5, SELECTED));
    }

    /// Finds partings and roots beside the window's thread.
    fn skin_lines(&mut self, shown: &Arc<Shown>, ctx: &egui::Context) {
        if self.skin.is_some() || self.finding.is_some() {
            return;
        }
        let (send, receive) = channel();
        let (shown, ctx) = (shown.clone(), ctx.clone());
        std::thread::spawn(move || {
            let lines = SkinLines::of(&shown.curves, shown.scalp().map(|scalp| &**scalp));
            // Nobody waits for it any more when there is newer hair.
            let _ = send.send(lines);
            ctx.request_repaint();
        });
        self.finding = Some(receive);
    }

    /// Takes what was found, also when nobody looks at it any more.
    fn take_found(&mut self) {
        match self.finding.as_ref().map(Receiver::try_recv) {
            Some(Ok(lines)) => (self.skin, self.finding) = (Some(lines), None),
            Some(Err(TryRecvError::Disconnected)) => self.finding = None,
            Some(Err(TryRecvError::Empty)) | None => {}
        }
    }
}

/// At most [`MOST_CURVES`] of `count` curves, of at most [`MOST_POINTS`] points each.
fn thinned<'a>(curves: impl Iterator<Item = &'a [Vec3]>, count: usize) -> Vec<Vec<Vec3>> {
    let every = count.div_ceil(MOST_CURVES).max(1);
    let fewer = |points: &[Vec3]| -> Vec<Vec3> {
        let step = points.len().div_ceil(MOST_POINTS).max(1);
        let tip = points.last().filter(|_| !(points.len().max(1) - 1).is_multiple_of(step));
        points.iter().step_by(step).chain(tip).copied().collect()
    };
    curves.step_by(every).map(fewer).filter(|line| line.len() > 1).collect()
}

/// Draws what is in the world.
struct Draw<'a> {
    painter: &'a Painter,
    view: &'a Projection,
    ball: Option<Sphere>,
}

impl Draw<'_> {
    fn hidden(&self, p: Vec3) -> bool {
        self.ball.is_some_and(|ball| behind(self.view, ball, p))
    }

    fn dot(&self, p: Vec3, colour: Color32) {
        let Some(at) = self.view.screen(p).filter(|at| self.view.rect.contains(*at)) else {
            return;
        };
        if !self.hidden(p) {
            let dot = egui::Rect::from_center_size(at, egui::Vec2::splat(1.6));
            self.painter.add(Shape::rect_filled(dot, 0.0, colour));
        }
    }

    /// Runs of what is seen and of what is behind the head.
    fn line(&self, points: &[Vec3], width: f32, colour: Color32) {
        let mut run: Vec<Pos2> = vec![];
        let mut was_hidden = false;
        let end = |run: &mut Vec<Pos2>, hidden: bool| {
            if run.len() > 1 {
                let colour = if hidden { colour.gamma_multiply(0.3) } else { colour };
                self.painter.add(Shape::line(std::mem::take(run), Stroke::new(width, colour)));
            }
            run.clear();
        };
        for p in points {
            let Some(at) = self.view.screen(*p) else {
                end(&mut run, was_hidden);
                continue;
            };
            let hidden = self.hidden(*p);
            if hidden != was_hidden {
                run.push(at);
                end(&mut run, was_hidden);
                was_hidden = hidden;
            }
            run.push(at);
        }
        end(&mut run, was_hidden);
    }
}

/// Whether a ball stands between the eye and a point.
fn behind(view: &Projection, ball: Sphere, p: Vec3) -> bool {
    let eye = match view.camera.orthographic {
        Some(_) => p - view.axes()[2] * 1e4,
        None => view.camera.eye,
    };
    let way = p - eye;
    let t = (ball.centre - eye).dot(way) / way.length_squared().max(1e-12);
    let nearest = eye + way * t.clamp(0.0, 1.0);
    (0.0..1.0).contains(&t) && nearest.distance(ball.centre) < ball.radius
}

impl SkinLines {
    fn of(hair: &Curves, scalp: Option<&Scalp>) -> Self {
        let rooted: Vec<(Vec3, u64)> = hair
            .each()
            .filter_map(|(tuft, i)| Some((*tuft.curve(i).first()?, owner(tuft, i))))
            .filter(|(p, _)| p.is_finite())
            .collect();
        let every = rooted.len().div_ceil(MOST_ROOTS).max(1);
        let roots = rooted.iter().step_by(every).map(|(p, _)| *p).collect();
        let partings = scalp.map_or(vec![], |scalp| partings(scalp, &rooted));
        Self { partings, roots }
    }
}

/// What a curve belongs to where hair is parted: its braid, or what it was made from.
fn owner(tuft: &Tuft, curve: usize) -> u64 {
    let first = tuft.range(curve).start;
    match tuft.view(BRAID).at(curve, first) {
        0 => tuft.view(PARENT).at(curve, first),
        braid => braid,
    }
}

/// Lines on the skin between places whose nearest roots belong to different owners.
fn partings(scalp: &Scalp, rooted: &[(Vec3, u64)]) -> Vec<[Vec3; 2]> {
    /// Into so many parts each side of a triangle is cut.
    const CUTS: usize = 5;
    let surface = scalp.surface();
    let tree = KdTree::new(rooted.iter().map(|(p, _)| *p));
    let mut found = vec![];
    let mut owner_at = |p: Vec3| -> Option<u64> {
        tree.find(p, 1, &mut found);
        let (_, k) = found.first()?;
        let (root, owner) = rooted.get(*k as usize)?;
        (root.distance(p) < GROWN).then_some(*owner)
    };
    let owners: Vec<Option<u64>> = surface.points.iter().map(|p| owner_at(*p)).collect();
    let mut lines = vec![];
    for (number, triangle) in (0u32..).zip(&surface.triangles) {
        let [a, b, c] = triangle.map(|v| owners[v as usize]);
        if a == b && b == c {
            continue;
        }
        let place = |i: usize, j: usize| {
            let bary = Vec2::new(i as f32, j as f32) / CUTS as f32;
            let lift = surface.smooth_normal(number, bary) * 0.03;
            surface.at(number, bary) + lift
        };
        let mut grid = vec![];
        for i in 0..=CUTS {
            for j in 0..=CUTS - i {
                let p = place(i, j);
                grid.push(((i, j), p, owner_at(p)));
            }
        }
        let at =
            |i: usize, j: usize| grid.iter().find(|(ij, ..)| *ij == (i, j)).map(|g| (g.1, g.2));
        for i in 0..CUTS {
            for j in 0..CUTS - i {
                let lower = [at(i, j), at(i + 1, j), at(i, j + 1)];
                let upper = [at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
                for corners in [lower, upper] {
                    if let [Some(a), Some(b), Some(c)] = corners {
                        lines.extend(border([a, b, c]));
                    }
                }
            }
        }
    }
    lines
}

/// The line between the middles of two sides of a small triangle whose ends have different owners. Where nothing grows there
/// is no parting.
fn border(corners: [(Vec3, Option<u64>); 3]) -> Option<[Vec3; 2]> {
    let [a, b, c] = corners;
    let crossed = [(a, b), (b, c), (c, a)]
        .into_iter()
        .filter(|(p, q)| p.1.is_some() && q.1.is_some() && p.1 != q.1)
        .map(|(p, q)| (p.0 + q.0) * 0.5);
    let middles: Vec<Vec3> = crossed.collect();
    match middles[..] {
        [p, q, ..] => Some([p, q]),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::core::projection::tests::{any_camera, any_rect};
    use coif_nodes::data::scalp::{HeadFrame, REGION};
    use coif_nodes::maths::closest::Surface;

    #[test]
    fn what_is_behind_the_head_is_told_from_what_is_before_it() {
        for seed in 0..200 {
            let camera = any_camera(seed);
            let view = Projection::new(camera, any_rect(seed));
            let ball = Sphere { centre: camera.target, radius: 4.0 };
            let ahead = camera.ahead();
            assert!(behind(&view, ball, camera.target + ahead * 6.0), "{seed}");
            assert!(!behind(&view, ball, camera.target - ahead * 6.0), "{seed}");
            let beside = camera.target + view.axes()[0] * 9.0;
            assert!(!behind(&view, ball, beside), "{seed}");
        }
    }

    #[test]
    fn long_and_many_curves_are_thinned_but_keep_their_ends() {
        let line: Vec<Vec3> = (0..1000).map(|i| Vec3::X * i as f32).collect();
        let many: Vec<&[Vec3]> = (0..5000).map(|_| &line[..]).collect();
        let thin = thinned(many.iter().copied(), many.len());
        assert!(thin.len() <= MOST_CURVES && thin.len() > MOST_CURVES / 2);
        for curve in &thin {
            assert!(curve.len() <= MOST_POINTS + 1);
            assert_eq!((curve[0], curve[curve.len() - 1]), (line[0], line[999]));
        }
        assert!(thinned([&line[..1]].into_iter(), 1).is_empty());
        assert_eq!(thinned([&line[..3]].into_iter(), 1)[0].len(), 3);
    }

    #[test]
    fn partings_run_between_owners_and_nowhere_else() {
        let points = vec![
            Vec3::new(-4.0, 0.0, -4.0),
            Vec3::new(-4.0, 0.0, 4.0),
            Vec3::new(4.0, 0.0, -4.0),
            Vec3::new(4.0, 0.0, 4.0),
        ];
        let surface = Surface::new(points, vec![[0, 1, 2], [2, 1, 3]]);
        let region = [(REGION.to_owned(), vec![1.0; 4])].into();
        let scalp = Scalp::new(surface, None, HeadFrame::IDENTITY, region);
        let grown: Vec<(Vec3, u64)> = (-8..=8)
            .flat_map(|x| (-8..=8).map(move |z| Vec3::new(x as f32, 0.0, z as f32) * 0.5))
            .map(|p| (p, if p.x < 0.25 { 1 } else { 2 }))
            .collect();
        let lines = partings(&scalp, &grown);
        assert!(!lines.is_empty());
        for p in lines.iter().flatten() {
            assert!((p.x - 0.25).abs() < 1.7 && p.y.abs() < 0.1, "{p}");
        }
        let whole: Vec<(Vec3, u64)> = grown.iter().map(|(p, _)| (*p, 1)).collect();
        assert!(partings(&scalp, &whole).is_empty());
        assert!(partings(&scalp, &[]).is_empty());
    }
}
