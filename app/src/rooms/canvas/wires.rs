//! Wires on the canvas: which there are, the way they run, and which of them something touches.
//! Pure.

use crate::core::faces::Faces;
use crate::core::faces::arrange::{pos, sound};
use coif_graphs::document::{Document, NodeId, Socket};
use coif_nodes::define::Type;
use egui::{Pos2, Rect, Vec2, vec2};
use egui_graph::bezier;
use egui_graph::edge::EdgeShape;
use std::collections::BTreeMap;

/// One wire: the input that it ends at, and its number there.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub(crate) struct Wire {
    /// Its input.
    pub to: Socket,
    /// Which of the input's wires.
    pub at: usize,
}

impl Wire {
    /// The output that it comes from; none when it is gone.
    pub(crate) fn from<'a>(&self, document: &'a Document) -> Option<&'a Socket> {
        document.links.get(&self.to)?.get(self.at)
    }
}

/// The way a wire runs.
#[derive(Clone, Debug)]
pub(super) struct Run {
    /// Which.
    pub wire: Wire,
    /// Where it comes from.
    pub from: Socket,
    /// What it carries, as its output says.
    pub ty: Option<Type>,
    /// The points it is drawn through by hand.
    pub bends: Vec<Pos2>,
    path: bezier::Path,
    /// Holds all of it.
    pub bounds: Rect,
}

/// How wires curve.
const SHAPE: EdgeShape = EdgeShape::Flow { curvature: 0.5, min_span: 36.0 };

/// The way from an output's end to an input's through bends.
pub(super) fn path(from: Pos2, bends: &[Pos2], to: Pos2) -> bezier::Path {
    SHAPE.path((from, vec2(1.0, 0.0)), bends, (to, vec2(-1.0, 0.0)))
}

impl Run {
    /// A wire between two ends.
    pub(super) fn new(
        wire: Wire,
        from: Socket,
        ty: Option<Type>,
        ends: (Pos2, Pos2),
        bends: Vec<Pos2>,
    ) -> Self {
        let path = path(ends.0, &bends, ends.1);
        // A cubic lies within the box of its handles.
        let handles = path.segments().iter().flat_map(|s| [s.from, s.ctrl1, s.ctrl2, s.to]);
        let bounds = Rect::from_points(&handles.collect::<Vec<_>>());
        Self { wire, from, ty, bends, path, bounds }
    }

    /// Points along it, about so far apart; farther where it is very long.
    pub(super) fn points(&self, apart: f32) -> Vec<Pos2> {
        self.path.flatten(self.apart(apart)).collect()
    }

    fn apart(&self, wanted: f32) -> f32 {
        wanted.max(self.bounds.size().max_elem() / 400.0)
    }

    /// How far a place is from it, and before which bend a new one would go.
    pub(super) fn distance(&self, to: Pos2) -> (f32, usize) {
        let mut best = (f32::INFINITY, 0);
        for (bend, piece) in self.path.segments().iter().enumerate() {
            let points: Vec<Pos2> = piece.flatten(self.apart(6.0)).collect();
            for pair in points.windows(2) {
                let d = distance_to_line(to, pair[0], pair[1]);
                if d < best.0 {
                    best = (d, bend);
                }
            }
        }
        best
    }

    /// Whether it crosses a line of straight pieces.
    pub(super) fn crosses(&self, line: &[Pos2]) -> bool {
        let Some(reach) =
            line.iter().copied().map(|p| Rect::from_min_max(p, p)).reduce(Rect::union)
        else {
            return false;
        };
        if !self.bounds.intersects(reach) {
            return false;
        }
        let points = self.points(6.0);
        points.windows(2).any(|a| line.windows(2).any(|b| cross(a[0], a[1], b[0], b[1])))
    }

    /// Whether it runs through a box.
    pub(super) fn touches(&self, rect: Rect) -> bool {
        self.bounds.intersects(rect) && self.path.intersects_rect(self.apart(6.0), rect)
    }
}

/// Every wire whose two ends can be seen, in the order of the document. `bent` replaces the bends of
/// one wire, and `corner` tells where nodes stand now.
pub(super) fn runs(
    document: &Document,
    faces: &Faces,
    corner: impl Fn(&NodeId) -> Option<Pos2>,
    bent: Option<(&Wire, &[Pos2])>,
) -> Vec<Run> {
    let mut runs = vec![];
    for (to, from) in &document.links {
        let Some(face) = faces.all.get(&to.node) else { continue };
        let Some(end) = corner(&to.node) else { continue };
        for (at, from) in from.iter().enumerate() {
            let (Some(other), Some(start)) = (faces.all.get(&from.node), corner(&from.node)) else {
                continue;
            };
            let (Some(out), Some(plug)) = (other.output(&from.name), face.plug_of(&to.name, at))
            else {
                continue;
            };
            let wire = Wire { to: to.clone(), at };
            let bends = match bent {
                Some((moved, bends)) if *moved == wire => bends.to_vec(),
                _ => document.bends_of(to, at).iter().map(|p| sound(pos(*p))).collect(),
            };
            let ends = (other.output_at(start, out), face.input_at(end, plug));
            runs.push(Run::new(wire, from.clone(), other.outputs[out].ty, ends, bends));
        }
    }
    runs
}

/// The nearest wire within `reach`, and before which bend a new one would go.
pub(super) fn nearest(runs: &[Run], to: Pos2, reach: f32) -> Option<(&Run, usize)> {
    let near = runs.iter().filter(|run| run.bounds.expand(reach).contains(to));
    near.map(|run| (run, run.distance(to)))
        .filter(|(_, (distance, _))| *distance <= reach)
        .min_by(|(_, (a, _)), (_, (b, _))| a.total_cmp(b))
        .map(|(run, (_, bend))| (run, bend))
}

/// Wires by the output that they come from.
pub(super) fn of_output(document: &Document, output: &Socket) -> Vec<Wire> {
    let mut wires = vec![];
    for (to, from) in &document.links {
        let ours = from.iter().enumerate().filter(|(_, from)| *from == output);
        wires.extend(ours.map(|(at, _)| Wire { to: to.clone(), at }));
    }
    wires
}

/// The wires of each input, the last first: the order in which they can be taken off one by one
/// without their numbers changing.
pub(super) fn last_first(wires: impl IntoIterator<Item = Wire>) -> Vec<Wire> {
    let mut by_input: BTreeMap<Socket, Vec<usize>> = BTreeMap::new();
    for wire in wires {
        by_input.entry(wire.to).or_default().push(wire.at);
    }
    let mut ordered = vec![];
    for (to, mut numbers) in by_input {
        numbers.sort_unstable();
        numbers.dedup();
        ordered.extend(numbers.into_iter().rev().map(|at| Wire { to: to.clone(), at }));
    }
    ordered
}

fn distance_to_line(p: Pos2, a: Pos2, b: Pos2) -> f32 {
    let line = b - a;
    let t = (p - a).dot(line) / line.length_sq().max(f32::MIN_POSITIVE);
    p.distance(a + line * t.clamp(0.0, 1.0))
}

/// Whether the lines a-b and c-d meet.
fn cross(a: Pos2, b: Pos2, c: Pos2, d: Pos2) -> bool {
    let side = |p: Pos2, q: Pos2, r: Pos2| {
        let (u, v): (Vec2, Vec2) = (q - p, r - p);
        (u.x * v.y - u.y * v.x) > 0.0
    };
    side(a, b, c) != side(a, b, d) && side(c, d, a) != side(c, d, b)
}

/// Detects a node shaken with the hand: several quick turns to and fro.
#[derive(Clone, Debug, Default)]
pub(super) struct Shake {
    /// Where the last turn was, which way it went on, and when.
    turn: Option<(Pos2, f32, f64)>,
    turns: u32,
    last: Option<Pos2>,
}

impl Shake {
    /// A new place of the pointer, in points of the screen, at a time in seconds. True when it has
    /// been shaken.
    pub(super) fn moved(&mut self, to: Pos2, now: f64) -> bool {
        let Some(last) = self.last.replace(to) else { return false };
        let way = (to.x - last.x).signum();
        if (to.x - last.x).abs() < 1.0 {
            return false;
        }
        match self.turn {
            Some((_, _, since)) if now - since > 0.4 => {
                *self = Self { last: Some(to), ..Self::default() }
            }
            Some((_, before, _)) if before == way => {}
            Some((at, _, _)) if (last.x - at.x).abs() < 15.0 => self.turn = Some((at, way, now)),
            Some(_) => {
                self.turns += 1;
                self.turn = Some((last, way, now));
            }
            None => self.turn = Some((last, way, now)),
        }
        if self.turns < 4 {
            return false;
        }
        *self = Self::default();
        true
    }
}

/// The middle of a wire's box, for tests and words.
#[cfg(test)]
pub(super) fn middle(run: &Run) -> Pos2 {
    let points = run.points(4.0);
    points.get(points.len() / 2).copied().unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rooms::canvas::testing::{document, faces, id};
    use coif_graphs::document::Point;
    use egui::pos2;

    fn all(document: &Document) -> Vec<Run> {
        let faces = faces(document);
        runs(document, &faces, |id| faces.corners.get(id).copied(), None)
    }

    #[test]
    fn wires_start_and_end_at_their_sockets() {
        let document = document("cornrows");
        let faces = faces(&document);
        let runs = all(&document);
        assert_eq!(runs.len(), document.links.values().map(Vec::len).sum::<usize>());
        for run in &runs {
            let points = run.points(5.0);
            let from = &faces.all[&run.from.node];
            let corner = faces.corners[&run.from.node];
            let start = from.output_at(corner, from.output(&run.from.name).unwrap());
            assert!(points[0].distance(start) < 0.1, "{run:?}");
            assert!(run.distance(middle(run)).0 < 0.1);
            assert!(run.bounds.contains(middle(run)));
        }
    }

    #[test]
    fn a_new_bend_goes_between_those_it_is_drawn_between() {
        let mut document = document("cornrows");
        let to = Socket::new(id("colour"), "curves");
        let bends = vec![Point(850.0, 300.0), Point(860.0, 500.0)];
        document.bends.insert(to.clone(), vec![bends]);
        let runs = all(&document);
        let run = runs.iter().find(|run| run.wire.to == to).unwrap();
        assert_eq!(run.bends.len(), 2);
        for bend in &run.bends {
            assert!(run.distance(*bend).0 < 0.1, "it does not pass {bend:?}");
        }
        let points = run.points(4.0);
        let nth = |share: f32| points[((points.len() - 1) as f32 * share) as usize];
        assert_eq!(run.distance(nth(0.02)).1, 0);
        let between = run.bends[0] + (run.bends[1] - run.bends[0]) * 0.5;
        assert_eq!(nearest(&runs, between, 60.0).map(|(_, bend)| bend), Some(1));
        assert_eq!(run.distance(nth(0.98)).1, 2);
    }

    #[test]
    fn a_line_cuts_what_it_crosses_and_nothing_else() {
        let document = document("cornrows");
        let runs = all(&document);
        let run = runs.iter().find(|run| run.wire.to.node == id("braids_out")).unwrap();
        let at = middle(run);
        let line = [at - vec2(0.0, 15.0), at + vec2(0.0, 15.0)];
        let cut: Vec<&Socket> =
            runs.iter().filter(|r| r.crosses(&line)).map(|r| &r.wire.to).collect();
        assert_eq!(cut, [&run.wire.to]);
        assert!(!run.crosses(&[]) && !run.crosses(&line[..1]));
        assert!(run.touches(Rect::from_center_size(at, vec2(8.0, 8.0))));
    }

    #[test]
    fn wires_come_off_last_first() {
        let wire = |to: &str, at| Wire { to: to.parse().unwrap(), at };
        let order = last_first([wire("a.x", 0), wire("b.x", 1), wire("a.x", 2), wire("a.x", 0)]);
        assert_eq!(order, [wire("a.x", 2), wire("a.x", 0), wire("b.x", 1)]);
    }

    #[test]
    fn shaking_is_told_from_dragging() {
        let shaken = |places: &[f32], step: f64| {
            let mut shake = Shake::default();
            let mut now = 0.0;
            places.iter().any(|x| {
                now += step;
                shake.moved(pos2(*x, 5.0), now)
            })
        };
        let to_and_fro: Vec<f32> =
            (0..40).map(|i| [0.0, 20.0, 40.0, 60.0, 40.0, 20.0][i % 6]).collect();
        assert!(shaken(&to_and_fro, 0.02));
        assert!(!shaken(&to_and_fro, 0.3), "slowly");
        let trembling: Vec<f32> = (0..40).map(|i| [0.0, 5.0][i % 2]).collect();
        assert!(!shaken(&trembling, 0.02));
        let straight: Vec<f32> = (0..40).map(|i| i as f32 * 9.0).collect();
        assert!(!shaken(&straight, 0.02));
    }
}
