//! Comment frames behind the nodes, and the small map of the whole canvas.

use super::edits::{FRAME_TITLE, frame_rect};
use super::look;
use super::text::line;
use crate::core::faces::Faces;
use crate::widgets::theme;
use coif_graphs::document::{Document, Frame, NodeId};
use egui::accesskit::Role;
use egui::{Pos2, Rect, Response, Sense, Stroke, StrokeKind, Ui, Vec2, pos2, vec2};
use std::collections::BTreeMap;

/// What was done to a frame.
pub(super) struct FrameResponse {
    /// Its name.
    pub name: String,
    /// On its title.
    pub title: Response,
    /// On its lower right corner.
    pub corner: Response,
}

/// A frame where it is while the hand holds it: moved, or resized.
pub(super) fn held(frame: &Frame, by: Vec2, resized: bool) -> Rect {
    let mut rect = frame_rect(frame);
    if resized {
        rect.max = (rect.max + by).max(rect.min + vec2(80.0, FRAME_TITLE * 2.0));
        rect
    } else {
        rect.translate(by)
    }
}

/// Whether a frame stands in a group, or in none: its name begins with the group's id where it does.
pub(super) fn stands_in(document: &Document, name: &str, group: Option<&NodeId>) -> bool {
    let within = name.rsplit_once('/').and_then(|(within, _)| NodeId::new(within).ok());
    within.filter(|within| document.nodes.contains_key(within)).as_ref() == group
}

/// Draws every frame of a group, or those in none; `rect` tells where each is now.
pub(super) fn show(
    ui: &Ui,
    document: &Document,
    group: Option<&NodeId>,
    scale: f32,
    selected: Option<&str>,
    rect: impl Fn(&str, &Frame) -> Rect,
) -> Vec<FrameResponse> {
    let mut touched = vec![];
    for (name, frame) in &document.frames {
        if !stands_in(document, name, group) {
            continue;
        }
        let rect = rect(name, frame);
        let colour = look::frame_colour(frame.colour);
        let p = ui.painter();
        let fill = theme::SUNKEN.of(ui).lerp_to_gamma(colour, 0.16);
        let edge =
            if selected == Some(name) { theme::ACCENT.of(ui) } else { colour.gamma_multiply(0.8) };
        p.rect(rect, 6.0, fill, Stroke::new(1.2, edge), StrokeKind::Middle);
        let bar = Rect::from_min_size(rect.min, vec2(rect.width(), FRAME_TITLE));
        let text = if frame.text.is_empty() { "Frame" } else { &frame.text };
        // The title stays readable from far away.
        let size = (14.0 / scale.clamp(0.25, 1.0)).min(rect.height() / 3.0).max(14.0);
        let title = line(ui, text, size, theme::TEXT.of(ui), rect.width() - 16.0);
        title.show(p, pos2(rect.left() + 9.0, rect.top() + 4.0), theme::TEXT.of(ui));
        let grip = Rect::from_min_max(rect.max - vec2(18.0, 18.0), rect.max);
        for off in [5.0, 9.0] {
            let ends = [rect.max - vec2(off, 3.0), rect.max - vec2(3.0, off)];
            p.line_segment(ends, Stroke::new(1.0, colour));
        }
        let id = ui.id().with(("frame", name));
        let title = ui.interact(bar, id, Sense::click_and_drag());
        ui.ctx().accesskit_node_builder(title.id, |node| {
            node.set_role(Role::Group);
            node.set_label(format!("{text}: frame"));
        });
        let corner = ui.interact(grip, id.with("corner"), Sense::drag());
        let corner = corner.on_hover_cursor(egui::CursorIcon::ResizeNwSe);
        touched.push(FrameResponse { name: name.clone(), title, corner });
    }
    touched
}

const MAP: Vec2 = vec2(168.0, 108.0);

/// The map's widget.
pub(super) fn map_id() -> egui::Id {
    egui::Id::new("canvas map")
}

/// The corner of `area` in which the map hides least: the one it was in while nothing comes under it, else that with the
/// smallest part of nodes under it, the lower right first.
fn corner(area: Rect, nodes: &[Rect], last: usize) -> (usize, Pos2) {
    let room = area.shrink(10.0);
    let corners = [
        room.max - MAP,
        pos2(room.left(), room.bottom() - MAP.y),
        pos2(room.right() - MAP.x, room.top()),
        room.min,
    ];
    let hidden = |at: usize| -> f32 {
        let map = Rect::from_min_size(corners[at], MAP).expand(4.0);
        nodes
            .iter()
            .map(|node| node.intersect(map))
            .filter(Rect::is_positive)
            .map(|r| r.area())
            .sum()
    };
    let order = [last % 4, 0, 1, 2, 3];
    let least = order.into_iter().min_by(|a, b| hidden(*a).total_cmp(&hidden(*b))).unwrap_or(0);
    (least, corners[least])
}

/// Draws the map in a corner of `area` where it hides no node; gives the place of the canvas that was pressed on it.
/// `onto_screen` leads there from the canvas.
pub(super) fn map(
    ui: &Ui,
    area: Rect,
    faces: &Faces,
    corners: &BTreeMap<NodeId, Pos2>,
    seen: Rect,
    onto_screen: &dyn Fn(Pos2) -> Pos2,
) -> Option<Pos2> {
    if area.width() < MAP.x * 2.2 || area.height() < MAP.y * 1.8 {
        return None;
    }
    let nodes = faces.all.values();
    let boxes: Vec<(Rect, usize, bool)> = nodes
        .filter_map(|face| {
            let rect = Rect::from_min_size(*corners.get(&face.id)?, face.size());
            Some((rect, face.stage, face.displayed))
        })
        .collect();
    let all = boxes.iter().map(|(rect, ..)| *rect).reduce(Rect::union)?;
    // Nothing to find when all of it is in sight.
    if seen.contains_rect(all) {
        return None;
    }
    let all = all.union(seen.intersect(all.expand(all.size().max_elem()))).expand(20.0);
    let id = map_id();
    let last = ui.data(|data| data.get_temp::<usize>(id)).unwrap_or(0);
    // Under the hand it stays.
    let held =
        ui.ctx().read_response(id.with("face")).is_some_and(|r| r.is_pointer_button_down_on());
    let on_screen = |(rect, ..): &(Rect, usize, bool)| {
        Rect::from_two_pos(onto_screen(rect.min), onto_screen(rect.max))
    };
    let nodes: Vec<Rect> = boxes.iter().filter(|_| !held).map(on_screen).collect();
    let (number, at) = corner(area, &nodes, last);
    ui.data_mut(|data| data.insert_temp(id, number));
    let shown = egui::Area::new(id).order(egui::Order::Middle).fixed_pos(at).show(ui.ctx(), |ui| {
        let (rect, _) = ui.allocate_exact_size(MAP, Sense::hover());
        let response = ui.interact(rect, id.with("face"), Sense::click_and_drag());
        response.widget_info(|| {
            egui::WidgetInfo::labeled(egui::WidgetType::Image, true, "Map of the canvas")
        });
        let p = ui.painter().with_clip_rect(rect);
        p.rect(
            rect,
            4.0,
            theme::GROUND.of(ui).gamma_multiply(0.92),
            Stroke::new(1.0, theme::LINE.of(ui)),
            StrokeKind::Inside,
        );
        let inner = rect.shrink(5.0);
        let scale = (inner.size() / all.size()).min_elem();
        let shift = inner.center() - scale * all.center().to_vec2();
        let onto = |r: Rect| {
            Rect::from_min_max(shift + scale * r.min.to_vec2(), shift + scale * r.max.to_vec2())
        };
        for (rect, stage, displayed) in &boxes {
            let colour = if *displayed {
                theme::ACCENT.of(ui)
            } else {
                look::stage_colour(*stage).of(ui).gamma_multiply(0.7)
            };
            p.rect_filled(onto(*rect).expand(0.5), 1.0, colour);
        }
        p.rect(
            onto(seen),
            2.0,
            theme::STRONG.of(ui).gamma_multiply(0.055),
            Stroke::new(1.0, theme::TEXT.of(ui)),
            StrokeKind::Inside,
        );
        let pressed = response.dragged() || response.clicked();
        let pointer = response.interact_pointer_pos().filter(|_| pressed)?;
        Some(((pointer - shift) / scale).to_pos2())
    });
    shown.inner
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_map_stands_where_it_hides_no_node_and_stays_there() {
        let area = Rect::from_min_size(Pos2::ZERO, vec2(800.0, 400.0));
        let node = |x: f32, y: f32| Rect::from_min_size(pos2(x, y), vec2(172.0, 100.0));
        // Corners: 0 lower right, 1 lower left, 2 upper right, 3 upper left.
        let check = |nodes: &[Rect], last: usize, expected: usize| {
            let (at, place) = corner(area, nodes, last);
            assert_eq!(at, expected, "{nodes:?} after {last}");
            assert!(area.contains_rect(Rect::from_min_size(place, MAP)));
        };
        check(&[], 0, 0);
        check(&[node(600.0, 280.0)], 0, 1);
        check(&[node(600.0, 280.0), node(20.0, 290.0)], 0, 2);
        // It does not leap back while its place is free.
        check(&[node(20.0, 10.0)], 2, 2);
        // Where all are taken, the one with the least under it.
        let all = [node(600.0, 280.0), node(20.0, 290.0), node(700.0, 10.0), node(20.0, 10.0)];
        check(&all, 0, 2);
    }
}
