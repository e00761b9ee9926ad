//! The strokes of the node that the pen works on, as they lie before the eye: for drawing and for picking.
//!
//! Made anew when strokes, head or view change. Points behind the head are known as such; they are drawn faintly and not
//! picked.

use super::target;
use crate::core::projection::Projection;
use crate::core::state::State;
use coif_graphs::document::NodeId;
use coif_nodes::data::scalp::Scalp;
use coif_nodes::data::strokes::Strokes;
use coif_nodes::maths::hash::curve_id;
use egui::{Pos2, Rect};
use glam::Vec3;
use std::collections::BTreeSet;
use std::sync::Arc;

/// How far behind the skin a point may be and still be seen, cm: strokes lie on it.
const IN_SKIN: f32 = 0.3;
/// Beyond so many points nobody asks what is behind the head: it would take longer than a frame.
const MOST_HIDDEN: usize = 6000;

/// One stroke before the eye.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Shape {
    /// The stroke's stored id.
    pub(crate) id: u64,
    /// Its points in the world, cm.
    pub(crate) points: Vec<Vec3>,
    /// Where each is on the screen; none for what is behind the eye.
    pub(crate) screen: Vec<Option<Pos2>>,
    /// Whether each is before the head.
    pub(crate) seen: Vec<bool>,
    /// The pen does not touch it.
    pub(crate) locked: bool,
}

/// A place of a stroke.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum StrokePlace {
    /// One of its points.
    Point(u64, usize),
    /// Between two: behind which, and the part of the way to the next.
    Line(u64, usize, f32),
}

impl StrokePlace {
    /// Whose place it is.
    pub(crate) fn stroke(self) -> u64 {
        match self {
            StrokePlace::Point(id, _) | StrokePlace::Line(id, ..) => id,
        }
    }
}

/// What the shapes were made of.
#[derive(Clone, PartialEq)]
struct Of {
    view: Projection,
    strokes: Arc<Strokes>,
    scalp: usize,
    locked: BTreeSet<u64>,
    node: Option<NodeId>,
}

/// The shapes of now.
#[derive(Default)]
pub(crate) struct Shapes {
    of: Option<Of>,
    all: Vec<Shape>,
}

impl Shapes {
    /// Brings the shapes up to date.
    pub(crate) fn update(
        &mut self,
        state: &State,
        node: Option<&NodeId>,
        strokes: &Arc<Strokes>,
        scalp: &Arc<Scalp>,
        view: &Projection,
    ) {
        let of = Of {
            view: *view,
            strokes: strokes.clone(),
            scalp: Arc::as_ptr(scalp) as usize,
            locked: state.visibility.locked.clone(),
            node: node.cloned(),
        };
        let same = self.of.as_ref().is_some_and(|before| {
            Arc::ptr_eq(&before.strokes, &of.strokes)
                && before.view == of.view
                && before.scalp == of.scalp
                && before.locked == of.locked
                && before.node == of.node
        });
        if same {
            return;
        }
        let count: usize = strokes.0.iter().map(|stroke| stroke.samples.len()).sum();
        let eye = view.camera.eye;
        let seen = |p: Vec3| {
            let (mut from, mut to) = (eye, p - eye);
            if view.camera.orthographic.is_some() {
                (from, to) = (p - view.axes()[2] * 200.0, view.axes()[2] * 200.0);
            }
            let length = to.length();
            count > MOST_HIDDEN
                || scalp
                    .surface()
                    .ray(from, to / length.max(1e-6), length)
                    .is_none_or(|hit| hit.distance > length - IN_SKIN)
        };
        let seed = node.map_or(0, |node| seed_of(state, node));
        let shape = |stroke: &coif_nodes::data::strokes::Stroke| {
            let points: Vec<Vec3> =
                stroke.samples.iter().map(|s| scalp.place(s.position)).collect();
            let names = [stroke.id, curve_id(stroke.id, seed, 0), curve_id(stroke.id, seed, 1)];
            Shape {
                id: stroke.id,
                screen: points.iter().map(|p| view.screen(*p)).collect(),
                seen: points.iter().map(|p| seen(*p)).collect(),
                points,
                locked: names.iter().any(|name| of.locked.contains(name)),
            }
        };
        self.all = strokes.0.iter().map(shape).collect();
        self.of = Some(of);
    }

    /// Forgets all: there is no head, or no node.
    pub(crate) fn clear(&mut self) {
        *self = Self::default();
    }

    /// The shapes, in drawing order.
    pub(crate) fn all(&self) -> &[Shape] {
        &self.all
    }
    /// The shape of a stroke.
    pub(crate) fn of(&self, id: u64) -> Option<&Shape> {
        self.all.iter().find(|shape| shape.id == id)
    }

    /// What lies nearest to a place of the screen within `reach` points: a point of a stroke if there is one, else a place
    /// on a line.
    pub(crate) fn pick(&self, at: Pos2, reach: f32) -> Option<StrokePlace> {
        let free = || self.all.iter().filter(|shape| !shape.locked);
        let points = free().flat_map(|shape| {
            shape.screen.iter().enumerate().filter_map(move |(i, p)| {
                let distance = p.filter(|_| shape.seen[i])?.distance(at);
                Some((distance, StrokePlace::Point(shape.id, i)))
            })
        });
        let lines = free().flat_map(|shape| {
            shape.screen.windows(2).enumerate().filter_map(move |(i, pair)| {
                let [Some(a), Some(b)] = *pair else { return None };
                let t = along(a, b, at);
                let seen = shape.seen[i] || shape.seen[i + 1];
                seen.then(|| ((a + (b - a) * t).distance(at), StrokePlace::Line(shape.id, i, t)))
            })
        });
        let near = |found: &(f32, StrokePlace)| found.0 <= reach;
        let nearer = |a: &(f32, StrokePlace), b: &(f32, StrokePlace)| a.0.total_cmp(&b.0);
        let point = points.filter(near).min_by(nearer);
        point.or_else(|| lines.filter(near).min_by(nearer)).map(|(_, place)| place)
    }

    /// The strokes that come within `reach` points of a place.
    pub(crate) fn strokes_near(&self, at: Pos2, reach: f32) -> Vec<u64> {
        let near = |shape: &&Shape| {
            let dot = shape.screen.len() == 1
                && shape.screen[0].is_some_and(|p| shape.seen[0] && p.distance(at) <= reach);
            let line = shape.screen.windows(2).enumerate().any(|(i, pair)| match pair {
                [Some(a), Some(b)] => {
                    let t = along(*a, *b, at);
                    (shape.seen[i] || shape.seen[i + 1])
                        && (*a + (*b - *a) * t).distance(at) <= reach
                }
                _ => false,
            });
            !shape.locked && (dot || line)
        };
        self.all.iter().filter(near).map(|shape| shape.id).collect()
    }

    /// The points that are seen within an outline on the screen.
    pub(crate) fn inside(&self, outline: &[Pos2]) -> BTreeSet<(u64, usize)> {
        let bounds = Rect::from_points(outline);
        let mut inside = BTreeSet::new();
        for shape in self.all.iter().filter(|shape| !shape.locked) {
            for (i, p) in shape.screen.iter().enumerate() {
                let Some(p) = p.filter(|p| shape.seen[i] && bounds.contains(*p)) else { continue };
                if is_inside(outline, p) {
                    inside.insert((shape.id, i));
                }
            }
        }
        inside
    }
}

fn seed_of(state: &State, node: &NodeId) -> u64 {
    state.document.node(node.as_str()).and_then(|node| node.seed()).unwrap_or(0) as u64
}

/// Displayed curves that strokes of the node became.
pub(crate) fn curves_of(state: &State, node: &NodeId, strokes: &BTreeSet<u64>) -> BTreeSet<u64> {
    let seed = seed_of(state, node);
    let mirrored = target::choice(&state.document, node, "mirror").as_deref() == Some("both");
    let sides = if mirrored { 2 } else { 1 };
    strokes.iter().flat_map(|id| (0..sides).map(move |side| curve_id(*id, seed, side))).collect()
}

/// Part of the way from `a` to `b` that is nearest to `p`.
fn along(a: Pos2, b: Pos2, p: Pos2) -> f32 {
    let span = b - a;
    let length2 = span.length_sq();
    if length2 > 0.0 { ((p - a).dot(span) / length2).clamp(0.0, 1.0) } else { 0.0 }
}

/// Whether a place lies inside an outline, by the number of times that a line from it crosses the outline.
fn is_inside(outline: &[Pos2], p: Pos2) -> bool {
    let mut inside = false;
    let mut before = match outline.last() {
        Some(last) => *last,
        None => return false,
    };
    for &here in outline {
        let crosses = (here.y > p.y) != (before.y > p.y);
        if crosses && p.x < here.x + (p.y - here.y) / (before.y - here.y) * (before.x - here.x) {
            inside = !inside;
        }
        before = here;
    }
    inside
}

#[cfg(test)]
mod tests {
    use super::*;

    fn shapes() -> Shapes {
        let line = |id, y: f32, seen: bool, locked| Shape {
            id,
            points: vec![Vec3::ZERO; 3],
            screen: [0.0, 50.0, 100.0].map(|x| Some(Pos2::new(x, y))).to_vec(),
            seen: vec![seen; 3],
            locked,
        };
        let all =
            vec![line(1, 0.0, true, false), line(2, 30.0, false, false), line(3, 60.0, true, true)];
        Shapes { of: None, all }
    }

    #[test]
    fn the_nearest_of_what_is_seen_and_free_is_picked() {
        let shapes = shapes();
        let at = |x, y| shapes.pick(Pos2::new(x, y), 10.0);
        assert_eq!(at(52.0, 3.0), Some(StrokePlace::Point(1, 1)));
        assert_eq!(at(75.0, 4.0), Some(StrokePlace::Line(1, 1, 0.5)));
        assert_eq!(at(75.0, 15.0), None);
        // Behind the head, and locked.
        assert_eq!(at(50.0, 30.0), None);
        assert_eq!(at(50.0, 60.0), None);
        assert_eq!(shapes.strokes_near(Pos2::new(30.0, 40.0), 45.0), [1]);
    }

    #[test]
    fn a_lasso_takes_what_lies_inside() {
        let shapes = shapes();
        let hook =
            [(-5.0, -5.0), (60.0, -5.0), (60.0, 5.0), (20.0, 5.0), (20.0, -2.0), (-5.0, -2.0)];
        let hook = hook.map(|(x, y)| Pos2::new(x, y));
        assert_eq!(shapes.inside(&hook), BTreeSet::from([(1, 1)]));
        assert_eq!(shapes.inside(&[]), BTreeSet::new());
    }
}
