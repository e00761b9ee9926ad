//! Marks on nodes and wires that differ from another document: what was added, removed and changed.
//!
//! Pure but for the drawing. Each mark has a sign besides its colour. Where things stand on the canvas is no difference.

use super::wires::{Run, Wire};
use crate::widgets::theme::{self, Tint};
use coif_graphs::compare::{Change, Fact, Said};
use coif_graphs::document::{Document, NodeId};
use egui::{Painter, Pos2, Rect, Shape, Stroke, StrokeKind, Vec2, vec2};
use std::collections::BTreeMap;

/// How something differs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Mark {
    /// The later document alone has it.
    Added,
    /// The earlier document alone has it.
    Removed,
    /// Both have it, each otherwise.
    Changed,
}

/// The marks of one of two documents.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct DiffMarks {
    /// Nodes; of a group also where what is in it differs.
    pub nodes: BTreeMap<NodeId, Mark>,
    /// Wires.
    pub wires: BTreeMap<Wire, Mark>,
}

/// The marks of two documents, from what changed from the one to the other.
pub(crate) fn marks(a: &Document, b: &Document, changes: &[Change]) -> [DiffMarks; 2] {
    let [mut one, mut other] = [DiffMarks::default(), DiffMarks::default()];
    for change in changes {
        match (&change.fact, change.from.is_some(), change.to.is_some()) {
            (Fact::Kind(id), false, _) => drop(other.nodes.insert(id.clone(), Mark::Added)),
            (Fact::Kind(id), _, false) => drop(one.nodes.insert(id.clone(), Mark::Removed)),
            (Fact::Wires(to), ..) => {
                let (from, now) = (sources(change.from.as_ref()), sources(change.to.as_ref()));
                let wire = |at| Wire { to: to.clone(), at };
                one.wires.extend(only(&from, &now).map(|at| (wire(at), Mark::Removed)));
                other.wires.extend(only(&now, &from).map(|at| (wire(at), Mark::Added)));
            }
            (
                Fact::Kind(id)
                | Fact::Label(id)
                | Fact::NodeNote(id)
                | Fact::Bypass(id)
                | Fact::Ports(id)
                | Fact::Template(id)
                | Fact::Input(id, _),
                ..,
            ) => {
                // Facts of kinds come first: what came or went is marked so.
                for (document, marks) in [(a, &mut one), (b, &mut other)] {
                    if document.nodes.contains_key(id) {
                        marks.nodes.entry(id.clone()).or_insert(Mark::Changed);
                    }
                }
            }
            _ => {}
        }
    }
    for (document, marks) in [(a, &mut one), (b, &mut other)] {
        let wired = marks.wires.keys().map(|wire| &wire.to.node);
        let within: Vec<NodeId> = marks.nodes.keys().chain(wired).cloned().collect();
        for id in within {
            let groups = std::iter::successors(id.group(), NodeId::group);
            for group in groups.filter(|group| document.nodes.contains_key(group)) {
                marks.nodes.entry(group).or_insert(Mark::Changed);
            }
        }
    }
    [one, other]
}

fn sources(said: Option<&Said>) -> Vec<&coif_graphs::document::Socket> {
    match said {
        Some(Said::Wires(wires)) => wires.iter().map(|wire| &wire.from).collect(),
        _ => vec![],
    }
}

/// The numbers of those that the other list lacks, one for one.
fn only<T: PartialEq>(here: &[T], there: &[T]) -> impl Iterator<Item = usize> {
    let count = |all: &[T], of: &T| all.iter().filter(|other| *other == of).count();
    (0..here.len()).filter(move |at| count(&here[..=*at], &here[*at]) > count(there, &here[*at]))
}

impl Mark {
    /// What it is called.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Added => "added",
            Self::Removed => "removed",
            Self::Changed => "changed",
        }
    }
    /// Blue, red and yellow keep apart for every eye.
    pub(crate) fn colour(self) -> Tint {
        match self {
            Self::Added => Tint::new([96, 178, 245], [0, 121, 219]),
            Self::Removed => Tint::new([240, 110, 130], [239, 8, 44]),
            Self::Changed => theme::WARNING,
        }
    }

    /// Its sign: a plus, a minus, a delta.
    pub(crate) fn sign(self, p: &Painter, at: Pos2, r: f32) {
        p.circle(at, r, self.colour().of(p), Stroke::new(r * 0.2, theme::SUNKEN.of(p)));
        let line = Stroke::new(r * 0.32, theme::SUNKEN.of(p));
        let arm = r * 0.55;
        match self {
            Self::Changed => {
                let corners = [vec2(0.0, -1.0), vec2(0.95, 0.7), vec2(-0.95, 0.7)];
                let corners = corners.map(|corner| at + corner * arm).to_vec();
                p.add(Shape::closed_line(corners, Stroke::new(r * 0.24, theme::SUNKEN.of(p))));
            }
            Self::Added | Self::Removed => {
                p.line_segment([at - vec2(arm, 0.0), at + vec2(arm, 0.0)], line);
                if self == Self::Added {
                    p.line_segment([at - vec2(0.0, arm), at + vec2(0.0, arm)], line);
                }
            }
        }
    }

    /// Draws it on a node. `scale` is points of the screen for a unit of the canvas.
    pub(super) fn on_node(self, p: &Painter, rect: Rect, scale: f32) {
        let unit = 1.0 / scale.clamp(0.2, 1.0);
        let edge = Stroke::new(2.0 * unit, self.colour().of(p));
        p.rect_stroke(rect.expand(2.0 * unit), 6.0, edge, StrokeKind::Outside);
        let r = (8.0 * unit).min(rect.height() * 0.5);
        self.sign(p, rect.right_top(), r);
    }

    /// Draws it on a wire.
    pub(super) fn on_wire(self, p: &Painter, run: &Run, scale: f32) {
        let unit = 1.0 / scale.clamp(0.2, 1.0);
        let points = run.points(6.0 * unit);
        let middle = points.get(points.len() / 2).copied();
        p.add(Shape::line(points, Stroke::new(3.4 * unit, self.colour().of(p))));
        if let Some(at) = middle {
            self.sign(p, at, 7.0 * unit);
        }
    }

    /// Shows its sign as part of a line of text.
    pub(crate) fn show(self, ui: &mut egui::Ui) {
        let size = Vec2::splat(ui.text_style_height(&egui::TextStyle::Body));
        let (rect, response) = ui.allocate_exact_size(size, egui::Sense::hover());
        self.sign(ui.painter(), rect.center(), size.x * 0.42);
        response.on_hover_text(self.name());
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rooms::canvas::testing::{document, id, socket};
    use coif_graphs::compare::diff;
    use coif_graphs::document::edit::Edit;

    /// The marks after an edit, in words: those of before, then those of after.
    fn marked(edit: Edit) -> [Vec<String>; 2] {
        let a = document("cornrows");
        let mut b = a.clone();
        edit.apply(&mut b).unwrap();
        let words = |marks: DiffMarks| {
            let nodes = marks.nodes.into_iter().map(|(id, mark)| format!("{id} {}", mark.name()));
            let wires = marks.wires.into_iter();
            let wires = wires.map(|(wire, mark)| format!("{} {}", wire.to, mark.name()));
            nodes.chain(wires).collect::<Vec<String>>()
        };
        marks(&a, &b, &diff(&a, &b)).map(words)
    }

    #[test]
    fn what_differs_is_marked_where_it_is_and_no_more() {
        let check = |edit: Edit, before: &[&str], after: &[&str]| {
            let [a, b] = marked(edit.clone());
            assert_eq!(
                (a, b),
                (
                    before.iter().map(|s| (*s).to_owned()).collect(),
                    after.iter().map(|s| (*s).to_owned()).collect()
                ),
                "{edit:?}"
            );
        };
        let bypass = Edit::SetBypass { id: id("fill"), bypass: true };
        check(bypass, &["fill changed"], &["fill changed"]);
        let at = Some(coif_graphs::document::Point(1.0, 2.0));
        check(Edit::Move { id: id("fill"), to: at }, &[], &[]);
        let rewired =
            Edit::SetWires { to: socket("fill.curves"), from: vec![socket("rows.curves")] };
        check(rewired, &["fill.curves removed"], &["fill.curves added"]);
        let label = Edit::SetLabel { id: id("rows"), label: Some("a".to_owned()) };
        check(label, &["rows changed"], &["rows changed"]);
    }

    #[test]
    fn a_node_that_is_gone_is_marked_with_its_wires_on_its_side_alone() {
        let [before, after] = marked(Edit::RemoveNode { id: id("fill") });
        assert!(before.contains(&"fill removed".to_owned()), "{before:?}");
        assert!(before.contains(&"fill.curves removed".to_owned()), "{before:?}");
        assert!(after.iter().all(|mark| !mark.starts_with("fill ")), "{after:?}");
    }

    #[test]
    fn of_wires_that_are_there_twice_one_may_be_new() {
        assert_eq!(only(&["a", "b", "a"], &["a"]).collect::<Vec<_>>(), [1, 2]);
        assert_eq!(only(&["a"], &["b", "a", "a"]).count(), 0);
    }
}
