//! Partings that are found between drawn hair: shown under the pen, and made drawn lines, which can be moved, cut and deleted.
//!
//! The node *Partings* finds them while its `leave` is above 0. As drawn lines they are strokes of a *Stroke input*, as if the pen had
//! drawn them, and `leave` goes to 180, at which nothing is found any more. One undo step takes all of it back.

use super::{Pen, PenTool, Scene, overlay, target};
use crate::core::action::Can;
use crate::core::event::Event;
use crate::core::notes::Note;
use crate::core::room::Room;
use crate::core::state::{Select, State};
use coif_graphs::document::edit::Edit;
use coif_graphs::document::{Document, NodeId, Setting, Socket, strokes};
use coif_nodes::data::curves::Curves;
use coif_nodes::data::scalp::Scalp;
use coif_nodes::data::strokes::{Sample, Strokes};
use coif_nodes::define::Value;
use coif_nodes::maths::spline::Spline;
use coif_nodes::sketch::seen::Seen;
use egui::{Painter, Pos2, Stroke};
use glam::Vec3;
use std::sync::Arc;

/// At this angle no rows leave each other.
const NOWHERE: f32 = 180.0;
/// Why there is nothing to edit.
const NONE: &str = "no Partings node looks for partings between drawn hair";
/// Distance between samples of a line, head units.
const STEP: f32 = 0.25;

/// The output with the partings that are found between drawn hair, if a node finds some: the selected one, else the first.
pub(super) fn output(state: &State) -> Option<Socket> {
    let finds = |id: &NodeId| finds(&state.document, id);
    let node = state.active().filter(|id| finds(id));
    let node = node.or_else(|| state.document.nodes.keys().find(|id| finds(id)))?;
    Some(Socket::new(node.clone(), "partings"))
}

fn finds(document: &Document, id: &NodeId) -> bool {
    let Some(node) = document.node(id.as_str()).filter(|node| node.kind == "partings") else {
        return false;
    };
    let leave = match node.inputs.get("leave") {
        Some(Setting::Known(Value::Float(angle))) => (1e-3..NOWHERE).contains(angle),
        _ => !document.wires(id, "leave").is_empty(),
    };
    leave && !document.wires(id, "between").is_empty()
}

/// The partings that are found, where they are evaluated.
pub(super) fn shown(state: &State) -> Option<&Curves> {
    let shown = state.shown.as_ref()?;
    shown.curves_of(&output(state)?)
}

/// Paints what is found over the picture, where the head does not hide it.
pub(super) fn paint(painter: &Painter, scene: &Scene) {
    let Some(found) = shown(scene.state) else { return };
    let view = super::hair::seen_from(&scene.view, scene.scalp.frame());
    let seen = Seen::new(&view, scene.scalp.frame());
    for (tuft, i) in found.each() {
        let place = |p: &Vec3| seen.sees(scene.scalp, *p).then(|| scene.view.screen(*p)).flatten();
        let places: Vec<Option<Pos2>> = tuft.curve(i).iter().map(place).collect();
        for run in places.split(Option::is_none) {
            let run: Vec<Pos2> = run.iter().flatten().copied().collect();
            overlay::line(painter, run, Stroke::new(1.0, overlay::LINE));
        }
    }
}

/// Whether partings are found.
pub(super) fn can_edit(state: &State) -> Can {
    output(state).map(|_| ()).ok_or(NONE)
}

/// Makes what is found drawn lines, and takes up the tool for their points.
pub(super) fn edit(pen: &mut Pen, state: &State, out: &mut Vec<Event>) {
    let (node, edits) = match drawn(state) {
        Ok(made) => made,
        Err(why) => return out.push(Event::Say(Note::warning(why))),
    };
    out.push(Event::Begin("edit found partings".to_owned()));
    out.push(Event::Edit(Edit::Several(edits)));
    out.push(Event::End);
    out.push(Event::Select(Select::Nodes(vec![node])));
    out.push(Event::Show(Room::Viewport));
    pen.tool = PenTool::Points;
}

/// The edits that make what is found drawn lines, and the node with them.
///
/// # Errors
/// Why there is nothing to be made, for people.
fn drawn(state: &State) -> Result<(NodeId, Vec<Edit>), &'static str> {
    let found = output(state).ok_or(NONE)?;
    let scalp = state.shown.as_ref().and_then(|shown| shown.scalp());
    let (Some(scalp), Some(curves)) = (scalp, shown(state)) else {
        return Err("the partings are not evaluated yet: try again in a moment");
    };
    let lines = lines(curves, scalp);
    if lines.0.is_empty() {
        return Err("the drawn hair leaves no parting");
    }
    let document = &state.document;
    let (node, mut edits) = target::make(document, false).ok_or("the graph has no head")?;
    let set = |node: &NodeId, input: &str, value: Value| Edit::SetInput {
        node: node.clone(),
        input: input.to_owned(),
        setting: Setting::Known(value),
    };
    edits.push(set(&node, "strokes", Value::Strokes(Arc::new(lines))));
    let parts = &found.node;
    edits.push(Edit::Connect {
        from: Socket::new(node.clone(), "curves"),
        to: Socket::new(parts.clone(), "lines"),
        at: None,
    });
    if !document.wires(parts, "leave").is_empty() {
        edits.push(Edit::SetWires { to: Socket::new(parts.clone(), "leave"), from: vec![] });
    }
    edits.push(set(parts, "leave", Value::Float(NOWHERE)));
    Ok((node, edits))
}

/// Curves on the scalp as strokes.
fn lines(curves: &Curves, scalp: &Scalp) -> Strokes {
    let mut out = Strokes::default();
    for (tuft, i) in curves.each() {
        let Ok(line) = Spline::new(tuft.curve(i)) else { continue };
        let count = (line.length() / (STEP * scalp.frame().unit())).ceil().clamp(1.0, 512.0);
        let mut samples: Vec<Sample> = vec![];
        line.resample(count as usize + 1, |p| {
            samples.push(Sample {
                position: scalp.given(p),
                pressure: 0.5,
                time: 0.02 * samples.len() as f32,
                ..Sample::default()
            });
        });
        out.0.extend(strokes::finish(&samples, &out));
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rooms::pen::tests::{Table, head};
    use coif_graphs::document::Node;
    use coif_nodes::data::strokes::Stroke as Drawn;

    /// A head with hair that is drawn to both sides, and partings between it.
    fn parted() -> Document {
        let mut document = head();
        let id = |text: &str| NodeId::new(text).unwrap();
        let way = |side: f32, z: f32| {
            let at = |x: f32, y: f32| Sample {
                position: Vec3::new(x * side, y, z),
                pressure: 0.5,
                ..Sample::default()
            };
            vec![at(0.8, 9.0), at(4.0, 8.0), at(7.0, 5.0), at(8.2, 1.0)]
        };
        let all = [(1.0, 3.0), (-1.0, 3.0), (1.0, -1.0), (-1.0, -1.0)];
        let drawn = (1..).zip(all).map(|(n, (side, z))| Drawn::new(n, way(side, z))).collect();
        let drawn = Setting::Known(Value::Strokes(Arc::new(Strokes(drawn))));
        let leave = Setting::Known(Value::Float(60.0));
        let node = |kind: &str, input: &str, value: Setting| {
            let inputs = [(input.to_owned(), value)].into();
            Arc::new(Node { kind: kind.to_owned(), inputs, ..Node::default() })
        };
        document.nodes.insert(id("hair"), node("stroke_input", "strokes", drawn));
        document.nodes.insert(id("cut"), node("partings", "leave", leave));
        for (from, to) in [
            (("head", "scalp"), ("hair", "scalp")),
            (("head", "scalp"), ("cut", "scalp")),
            (("hair", "curves"), ("cut", "between")),
        ] {
            let from = Socket::new(id(from.0), from.1);
            document.links.insert(Socket::new(id(to.0), to.1), vec![from]);
        }
        document.display = Some(id("cut"));
        document
    }

    #[test]
    fn found_partings_become_drawn_lines_in_the_same_place_and_one_undo_takes_them_back() {
        let mut table = Table::new(parted());
        table.editor().act("pen.hair");
        table.rest();
        let before = table.editor().state.document.clone();
        let found = shown(&table.editor().state).cloned().expect("they are evaluated");
        assert_eq!(found.curve_count(), 1);
        table.editor().act("pen.partings");
        table.rest();
        let state = &table.editor().state;
        assert!(output(state).is_none(), "nothing is found any more");
        let cut = NodeId::new("cut").unwrap();
        let strokes = state.document.wires(&cut, "lines")[0].node.clone();
        assert_eq!(
            target::of(state, target::Fills::Strokes),
            Some(strokes.clone()),
            "the pen is on the lines"
        );
        let scalp = state.shown.as_ref().and_then(|shown| shown.scalp()).cloned().unwrap();
        let lines = target::strokes(&state.document, &strokes);
        assert_eq!(lines.0.len(), 1);
        let mut line = vec![];
        Spline::new(found.tufts()[0].points()).unwrap().resample(200, |p| line.push(p));
        for sample in &lines.0[0].samples {
            let p = scalp.place(sample.position);
            let off = line.iter().map(|q| q.distance(p)).fold(f32::MAX, f32::min);
            assert!(off < 0.15, "{off}");
        }
        table.editor().act("edit.undo");
        table.rest();
        assert_eq!(table.editor().state.document, before);
    }
}
