//! Places of a head on which no hair is to grow, where they are no parts of its mesh: a tail, feet, the skin about the eyes.
//!
//! A *Region* behind the head grows hair outside of what is drawn, or where a mask is left that the pen erases; what took the head's
//! scalp takes that of the region then. There is one such region for a head, which everything that is left out goes into. Other regions
//! of the head, such as a beard's, stay as they are.

use super::target;
use coif_graphs::document::edit::Edit;
use coif_graphs::document::{Document, NodeId, Setting, Socket};
use coif_nodes::define::Value;

const SCALP: &str = "scalp";
const MASK: &str = "mask";
/// The setting of a region by which hair grows outside of its outlines.
const OUTSIDE: (&str, &str) = ("side", "outside");

/// The region that leaves out what is drawn into it, and the edits that add it if it does not exist yet; `None` without a head. With
/// `mirror`, both sides are left out.
pub(super) fn region(document: &Document, mirror: bool) -> Option<(NodeId, Vec<Edit>)> {
    let head = target::head(document)?;
    let from = Socket::new(head.clone(), SCALP);
    let is_it = |id: &&NodeId| {
        let side = target::choice(document, id, OUTSIDE.0);
        target::is_region(document, id)
            && side.as_deref() == Some(OUTSIDE.1)
            && document.wires(id, SCALP) == std::slice::from_ref(&from)
    };
    if let Some(known) = document.nodes.keys().find(is_it) {
        return Some((known.clone(), vec![]));
    }
    let (id, mut edits) = target::make_region(document)?;
    let mut set = |input: &str, value: Value| {
        let (node, input) = (id.clone(), input.to_owned());
        edits.push(Edit::SetInput { node, input, setting: Setting::Known(value) });
    };
    set(OUTSIDE.0, Value::Text(OUTSIDE.1.into()));
    if mirror {
        set("symmetric", Value::Bool(true));
    }
    edits.push(Edit::SetLabel { id: id.clone(), label: Some("left out".to_owned()) });
    let gives = Socket::new(id.clone(), SCALP);
    let takes = document
        .links
        .iter()
        .filter(|(to, wires)| wires.contains(&from) && !target::is_region(document, &to.node));
    for (to, wires) in takes {
        let wires = wires.iter().map(|wire| if *wire == from { &gives } else { wire });
        edits.push(Edit::SetWires { to: to.clone(), from: wires.cloned().collect() });
    }
    Some((id, edits))
}

/// The mask that the same region grows hair by, to be erased, and the edits that make what there is not. None without a head.
pub(super) fn painted(document: &Document) -> Option<(NodeId, Vec<Edit>)> {
    let head = target::head(document)?;
    let (region, mut edits) = region(document, false)?;
    let is_mask = |id: &NodeId| {
        target::filled(kind(document, id)).is_some_and(|(fills, _)| fills == target::Fills::Mask)
    };
    if let [wire] = document.wires(&region, MASK)
        && is_mask(&wire.node)
    {
        return Some((wire.node.clone(), edits));
    }
    let mut with = document.clone();
    edits.iter().try_for_each(|edit| edit.apply(&mut with).map(drop)).ok()?;
    let made = super::mask::target::KIND;
    let id = with.free_id("left_out");
    let node = with.fresh_node(made, &id);
    edits.extend(target::put(&id, node, &head, Socket::new(head.clone(), SCALP), &with));
    // All of the skin is left before it is erased, and what it was wired from is.
    let base = Socket::new(id.clone(), "base");
    match document.wires(&region, MASK) {
        [] => edits.push(Edit::SetInput {
            node: id.clone(),
            input: base.name.to_string(),
            setting: Setting::Known(Value::Float(1.0)),
        }),
        wires => edits.push(Edit::SetWires { to: base, from: wires.to_vec() }),
    }
    let to = Socket::new(region, MASK);
    edits.push(Edit::SetWires { to, from: vec![Socket::new(id.clone(), MASK)] });
    Some((id, edits))
}

fn kind<'a>(document: &'a Document, id: &NodeId) -> &'a str {
    document.node(id.as_str()).map_or("", |node| &node.kind)
}

#[cfg(test)]
mod tests {
    use crate::core::event::Event;
    use crate::rooms::pen::tests::{Table, draw_on};
    use egui::Pos2;
    use glam::Vec3;

    /// Guides of a head, of which one place is in the middle of the sheet.
    fn table() -> Table {
        let text = r#"(format: 3, nodes: {
            "head": (kind: "head"),
            "guides": (kind: "scatter_guides", links: {"scalp": "head.scalp"}, inputs: {"count": 1500}),
            "out": (kind: "groom_output", links: {"curves": "guides.curves"}),
        })"#;
        draw_on(coif_graphs::file::read(text).expect("it reads").document)
    }

    /// The skin in the middle of the sheet, and how far from it the roots are: the nearest, and how many within 3 cm.
    fn roots(table: &mut Table) -> (f32, usize) {
        let at = table.on_screen(Pos2::new(300.0, 300.0));
        let ray = table.editor().viewport.projection().ray(at);
        let shown = table.editor().state.shown.clone().expect("hair");
        let scalp = shown.scalp().expect("a head");
        let middle = scalp.surface().ray(ray.origin, ray.direction, 1e5).expect("skin").point;
        let far = |(tuft, i): (&coif_nodes::data::curves::Tuft, usize)| {
            Vec3::distance(tuft.curve(i)[0], middle)
        };
        let all: Vec<f32> = shown.curves.each().map(|(tuft, i)| far((tuft, i))).collect();
        assert!(all.len() > 1000, "{} guides", all.len());
        (all.iter().copied().fold(f32::MAX, f32::min), all.iter().filter(|far| **far < 3.0).count())
    }

    /// A circle of 3 cm about the middle of the sheet, and one stroke over and over that fills it.
    fn circle(radius: f32) -> Vec<(Pos2, f32)> {
        let at = |k: usize| Pos2::new(300.0, 300.0) + radius * egui::Vec2::angled(k as f32 * 0.1);
        (0..63).map(|k| (at(k), 1.0)).collect()
    }

    #[test]
    fn inside_of_what_is_drawn_no_hair_grows_and_around_it_as_before() {
        let mut table = table();
        let before = table.editor().state.document.clone();
        assert!(roots(&mut table).0 < 1.0);
        table.editor().act("pen.leave_out");
        table.rest();
        table.draw(&circle(60.0));
        table.rest();
        let (nearest, _) = roots(&mut table);
        assert!((2.4..3.6).contains(&nearest), "{nearest} cm");
        // A second one goes into the same region.
        table.editor().act("pen.leave_out");
        let regions = |table: &mut Table| {
            let document = &table.editor().state.document;
            document.nodes.values().filter(|node| node.kind == "region").count()
        };
        assert_eq!((regions(&mut table), table.done()), (1, 2));
        for _ in 0..2 {
            table.editor().apply(Event::Undo);
        }
        assert_eq!(table.editor().state.document, before);
    }

    #[test]
    fn where_the_pen_erases_no_hair_grows() {
        let mut table = table();
        let (_, before) = roots(&mut table);
        table.editor().act("pen.leave_out_painted");
        table.rest();
        let wide: Vec<(Pos2, f32)> =
            [0.0, 10.0, 20.0, 30.0, 40.0, 50.0, 60.0].into_iter().flat_map(circle).collect();
        for _ in 0..10 {
            table.editor().act("pen.stronger");
        }
        for _ in 0..2 {
            table.draw(&wide);
            table.rest();
            while table.editor().pen.touches.is_busy() {
                table.rest();
            }
        }
        let (_, after) = roots(&mut table);
        assert!(before > 20 && after * 2 < before, "{before} guides, then {after}");
    }
}
