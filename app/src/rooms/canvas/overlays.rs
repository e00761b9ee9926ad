//! What lies over the canvas: the reason why a wire is refused, the map, the search, names being typed.

use super::edits::{self, Behind, Link};
use super::finder::{self, Finder, FinderChoice, SearchOutcome, Task};
use super::scene::DrawnScene;
use super::{Canvas, commands, frames, hand, look};
use crate::core::event::Event;
use crate::core::faces::{self, Faces, arrange};
use crate::core::notes::Note;
use crate::core::state::{Select, State};
use crate::widgets::theme;
use coif_graphs::document::edit::Edit;
use coif_graphs::document::{NodeId, wiring};
use egui::{Align2, FontId, Pos2, Rect, Ui, Vec2, pos2, vec2};

impl Canvas {
    /// What lies over the canvas: the reason why not, the map, the search, names being typed.
    pub(super) fn overlays(
        &mut self,
        state: &State,
        faces: &Faces,
        found: &DrawnScene,
        ui: &Ui,
        area: Rect,
        out: &mut Vec<Event>,
    ) {
        if let Some(why) = self.memory.aim.as_ref().and_then(|aim| aim.refused.as_deref())
            && let Some(at) = ui.input(|i| i.pointer.latest_pos())
        {
            reason(ui, area, at, why);
        }
        trail(state, ui, area, out);
        if state.document.nodes.is_empty() && self.memory.finder.is_none() {
            let text = "Tab adds a node";
            let font = FontId::proportional(14.0);
            ui.painter().text(
                area.center(),
                Align2::CENTER_CENTER,
                text,
                font,
                theme::QUIET.of(ui),
            );
        }
        if let Some(to) =
            frames::map(ui, area, faces, &found.corners, self.seen(), &|at| self.to_screen(at))
        {
            self.center_on(to);
        }
        if let Some((wire, at)) = self.memory.insert_at.take() {
            let screen = self.to_screen(at);
            self.memory.finder = Some(Finder::new(Task::Insert(wire, at), screen));
        }
        if let Some(mut finder) = self.memory.finder.take() {
            match finder.show(ui, &state.document, faces, &self.memory.recent) {
                SearchOutcome::Open => self.memory.finder = Some(finder),
                SearchOutcome::Done(Some(pick)) => {
                    self.picked(state, faces, &finder.task, pick, out)
                }
                SearchOutcome::Done(None) => {}
            }
        }
        if let Some(mut naming) = self.memory.naming.take() {
            let spot = naming.place(&state.document, faces, &found.corners);
            let spot = spot.map_or(area.center(), |at| self.to_screen(at));
            if naming.show(ui, area, spot, out) {
                self.memory.naming = Some(naming);
            }
        }
    }

    /// Something was picked in the search.
    pub(super) fn picked(
        &mut self,
        state: &State,
        faces: &Faces,
        task: &Task,
        pick: FinderChoice,
        out: &mut Vec<Event>,
    ) {
        let document = &state.document;
        match (task, pick) {
            (Task::Add { at, link, dropped }, FinderChoice::Kind(def, wired, set)) => {
                // A wire in the hand goes where it was dropped; behind a selected node the new one is inserted.
                let behind = match (wired, dropped) {
                    (true, false) => Behind::Inserted,
                    (true, true) => Behind::Dropped,
                    (false, _) => Behind::Branch,
                };
                let branches = |link: &&Link| match link {
                    Link::From(from) => !dropped && finder::is_in_chain(document, from),
                    Link::To(..) => false,
                };
                let link = link.as_ref().filter(|link| wired || branches(link));
                let (corner, group) = (*at, state.group.as_ref());
                let at = commands::place_new(faces, def, corner, link, *dropped);
                let (mut edit, id) = edits::add(document, def, at, (link, behind), group);
                let mut after = document.clone();
                let said = (edit.apply(&mut after).is_ok() && behind == Behind::Inserted)
                    .then(|| commands::said_of_insertion(document, &after, &id))
                    .flatten();
                if let (Some(_), Some(Link::From(from))) = (&said, link) {
                    let (room, at) = commands::make_room(document, faces, &from.node, def);
                    let place = Edit::Move { id: id.clone(), to: Some(arrange::point(at)) };
                    edit = Edit::Several(vec![edit, room, place]);
                }
                self.memory.used(def);
                out.push(Event::Edit(edits::and_set(edit, &id, def, set)));
                out.push(Event::Select(Select::Nodes(vec![id])));
                out.extend(said.map(|said| Event::Say(Note::done(said))));
            }
            (Task::Insert(wire, at), FinderChoice::Kind(def, _, set)) => {
                let at = *at - vec2(faces::WIDTH / 2.0, faces::HEADER);
                match edits::insert_new(document, def, at, wire) {
                    Ok((edit, id)) => {
                        self.memory.used(def);
                        out.push(Event::Edit(edits::and_set(edit, &id, def, set)));
                        out.push(Event::Select(Select::Nodes(vec![id])));
                    }
                    Err(why) => out.push(Event::Say(Note::warning(why))),
                }
            }
            (Task::Swap(id), FinderChoice::Kind(def, _, set)) => {
                match wiring::change_kind(document, id, def.id) {
                    Ok(edit) => out.push(Event::Edit(edits::and_set(edit, id, def, set))),
                    Err(why) => out.push(Event::Say(Note::error(why).of(id.clone()))),
                }
            }
            (Task::Connect(_), FinderChoice::Plug(from, node, number)) => {
                let plug = faces.all.get(&node).and_then(|face| face.inputs.get(number));
                let edit = plug.and_then(|plug| edits::connect(document, &from, plug, None));
                out.extend(edit.map(Event::Edit));
            }
            (Task::Input(from, lifted, node), FinderChoice::Input(input)) => {
                let plug = faces.all.get(node).map(|face| hand::plug_of(document, face, &input));
                let edit = plug.and_then(|it| edits::connect(document, from, &it, lifted.as_ref()));
                out.extend(edit.map(Event::Edit));
            }
            _ => {}
        }
    }
}

/// The way to the group that is shown: each group that it is in can be gone back to.
fn trail(state: &State, ui: &Ui, area: Rect, out: &mut Vec<Event>) {
    let Some(group) = &state.group else { return };
    let mut way: Vec<Option<NodeId>> = vec![Some(group.clone())];
    while let Some(Some(last)) = way.last() {
        way.push(last.group());
    }
    let at =
        egui::Area::new(trail_id()).order(egui::Order::Middle).fixed_pos(area.min + vec2(8.0, 6.0));
    at.constrain_to(area).show(ui.ctx(), |ui| {
        ui.horizontal(|ui| {
            for (n, place) in way.iter().rev().enumerate() {
                if n > 0 {
                    ui.weak("\u{203A}");
                }
                let name = place.as_ref().map_or("Groom".into(), |id| state.document.name_of(id));
                let name: String = name.chars().take(40).collect();
                if n + 1 == way.len() {
                    ui.strong(name);
                } else if ui.small_button(name).on_hover_text("Go back to this level.").clicked() {
                    out.push(Event::Enter(place.clone()));
                }
            }
        });
    });
}

/// The widget of the way to the group that is shown.
pub(super) fn trail_id() -> egui::Id {
    egui::Id::new("canvas trail")
}

/// Why a wire cannot go where it points, at the pointer.
fn reason(ui: &Ui, area: Rect, at: Pos2, why: &str) {
    let layer = egui::LayerId::new(egui::Order::Tooltip, egui::Id::new("canvas reason"));
    let p = ui.ctx().layer_painter(layer);
    let font = FontId::proportional(12.0);
    let text = p.layout(why.to_owned(), font, theme::ERROR.of(ui), 280.0);
    let size = text.size() + vec2(30.0, 12.0);
    let mut rect = Rect::from_min_size(at + vec2(14.0, 12.0), size);
    rect = rect.translate(vec2(
        (area.right() - rect.right()).min(0.0),
        (area.bottom() - rect.bottom()).min(0.0),
    ));
    p.rect(
        rect,
        4.0,
        theme::GROUND.of(ui),
        egui::Stroke::new(1.0, theme::ERROR.of(ui)),
        egui::StrokeKind::Inside,
    );
    look::error_mark(&p, pos2(rect.left() + 13.0, rect.top() + 14.0), 6.5);
    p.galley(rect.min + vec2(24.0, 6.0), text, theme::ERROR.of(ui));
    // Told to screen readers as well.
    let id = egui::Id::new("canvas reason text");
    let response = ui.interact(Rect::from_min_size(rect.min, Vec2::ZERO), id, egui::Sense::hover());
    response.widget_info(|| egui::WidgetInfo::labeled(egui::WidgetType::Label, true, why));
}
