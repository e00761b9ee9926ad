//! The parts of a head's mesh, left out by pointing at them: they go into the same list of the head's node as the ticks of the panel of
//! one's own head.
//!
//! A part that is left out can no longer be pointed at; the list of all parts brings it back.

use crate::core::event::Event;
use crate::core::projection::Ray;
use crate::core::state::State;
use crate::widgets::panel;
use coif_graphs::document::edit::Edit;
use coif_graphs::document::graph::upstream;
use coif_graphs::document::{NodeId, Setting, Socket, wiring};
use coif_nodes::data::scalp::{Part, Scalp};
use coif_nodes::define::Value;
use egui::{Button, Ui};
use std::sync::Arc;

/// The input of a head's node that names what is left out.
const LEAVE_OUT: &str = "leave_out";
/// A part that holds more of the skin than this is the body itself.
const MOST: f32 = 0.5;
/// A longer name is told by hovering.
const MOST_LETTERS: usize = 32;

/// The head that the menu is about.
#[derive(Clone)]
pub(super) struct PointedHead {
    /// Where its node is told what to leave out.
    at: Socket,
    scalp: Arc<Scalp>,
    /// The numbers of its parts that were pointed at, without the body itself.
    pointed: Vec<usize>,
}

impl PointedHead {
    /// The nearest head that the ray hits, if any.
    pub(super) fn new(state: &State, ray: &Ray) -> Option<Self> {
        let shown = state.shown.as_ref()?;
        let hit = |scalp: &Arc<Scalp>| {
            let hit = scalp.surface().ray(ray.origin, ray.direction, super::handles::FAR)?;
            Some((scalp.clone(), hit))
        };
        let hits = shown.scalps.iter().filter_map(hit);
        let (scalp, hit) = hits.min_by(|(_, a), (_, b)| a.distance.total_cmp(&b.distance))?;
        let document = &state.document;
        let way = upstream(document, shown.sockets.iter().map(|socket| &socket.node));
        let is_head = |id: &&NodeId| document.node(id.as_str()).is_some_and(|n| n.is_head());
        let head = way.iter().find(is_head)?.clone();
        let at = wiring::set_at(document, &Socket::new(head, LEAVE_OUT));
        let area = |triangles: &mut dyn Iterator<Item = u32>| -> f32 {
            triangles.map(|t| scalp.surface().area_vector(t).length()).sum()
        };
        let whole = area(&mut (0..scalp.surface().triangles.len() as u32));
        let is_pointed_at = |part: &Part| {
            part.holds(hit.triangle)
                && area(&mut part.triangles.iter().cloned().flatten()) < MOST * whole
        };
        let parts = scalp.parts().iter().enumerate();
        let pointed = parts.filter(|(_, part)| is_pointed_at(part)).map(|(i, _)| i).collect();
        Some(Self { at, scalp, pointed })
    }

    /// The entries of the menu: to leave out what was pointed at, and a list of all parts.
    pub(super) fn ui(&self, state: &State, ui: &mut Ui, out: &mut Vec<Event>) {
        if !state.document.links.contains_key(&self.at) {
            for part in self.pointed.iter().map(|i| &self.scalp.parts()[*i]) {
                let entry = ui.button(format!("Leave out this part: {}", short(&part.name)));
                if entry.on_hover_text(format!("{}: {TIP}", part.name)).clicked() {
                    self.set(state, part, true, out);
                    ui.close();
                }
            }
            if self.pointed.is_empty() {
                ui.add_enabled(false, Button::new("Leave out this part"))
                    .on_disabled_hover_text(BODY);
            }
            panel::submenu(ui, "Parts of the head", |ui| self.list(state, ui, out));
        }
    }

    fn list(&self, state: &State, ui: &mut Ui, out: &mut Vec<Event>) {
        let is_shown = |(i, part): &(usize, &Part)| {
            part.is_listed || part.is_left_out || self.pointed.contains(i)
        };
        let mut parts = self.scalp.parts().iter().enumerate().filter(is_shown).peekable();
        if parts.peek().is_none() {
            ui.label("The mesh is in one piece.");
        }
        for (_, part) in parts {
            let mut is_in = !self.left_out(state).contains(&part.pattern);
            // A pattern such as hair* may name several at once.
            let by_another = part.is_left_out && is_in;
            is_in &= !part.is_left_out;
            let tick = egui::Checkbox::new(&mut is_in, short(&part.name));
            let tick = ui.add_enabled(!by_another, tick).on_hover_text(TICK);
            let tick = tick.on_disabled_hover_text(
                "A pattern of the head's leave out names it with others: change it in the inspector.",
            );
            if tick.changed() {
                self.set(state, part, !is_in, out);
                ui.close();
            }
        }
    }

    /// The names and patterns that are left out now.
    fn left_out(&self, state: &State) -> Vec<String> {
        let node = state.document.node(self.at.node.as_str());
        match node.and_then(|node| node.inputs.get(&*self.at.name)) {
            Some(Setting::Known(Value::Text(text))) => {
                let all = text.split(',').map(|name| name.trim().to_owned());
                all.filter(|name| !name.is_empty()).collect()
            }
            _ => vec![],
        }
    }

    fn set(&self, state: &State, part: &Part, left_out: bool, out: &mut Vec<Event>) {
        let mut all = self.left_out(state);
        all.retain(|name| *name != part.pattern);
        all.extend(left_out.then(|| part.pattern.clone()));
        let (node, input) = (self.at.node.clone(), self.at.name.to_string());
        let words = if left_out { "left out" } else { "no longer left out" };
        out.push(Event::Begin(format!("{words}: {}", short(&part.name))));
        out.push(Event::Edit(match all.is_empty() {
            true => Edit::UnsetInput { node, input },
            false => {
                let setting = Setting::Known(Value::Text(all.join(", ").into()));
                Edit::SetInput { node, input, setting }
            }
        }));
        out.push(Event::End);
    }
}

fn short(name: &str) -> String {
    name.chars().take(MOST_LETTERS).collect()
}

const TIP: &str =
    "no hair grows on it, it is not skin, and it is not shown. Parts of the head brings it back.";
const TICK: &str = "Whether this part is skin; without a tick it is left out.";
const BODY: &str = "It is one piece with most of the mesh: leave out an area of it.";
