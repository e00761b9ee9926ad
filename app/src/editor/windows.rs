//! Windows over the rooms: what shields them, and what Escape closes.
//!
//! Guarantees: what is pressed beside an open list closes it and does nothing else; Escape closes the topmost of what is open.

use super::{Editor, layout};
use crate::core::documents::{DocumentEvent, HeadChoice};
use crate::core::event::{Event, Window};
use crate::core::room::Room;
use crate::core::state::Select;
use crate::widgets::keyboard::escape_at;
use crate::widgets::panel::{id, room};
use egui::{Area, Context, Id, LayerId, Order, Popup, Sense};
use std::collections::BTreeSet;

/// Panels that Escape closes.
const SETTINGS: &str = "settings";
const KEYS: &str = "key sheet";
const WELCOME: &str = "welcome";
const PEN: &str = "pen settings";
const OVER_HAIR: &str = super::documents::over_hair::PANEL;
const RECIPE: &str = "recipe over hair";
const HEAD: &str = "own head";
const TEMPLATE: &str = super::templates::save::PANEL;
const EXPORT: &str = super::documents::export_panel::PANEL;
const PICTURE: &str = super::documents::picture_panel::PANEL;

impl Editor {
    /// Something happens to the window round the rooms.
    pub(super) fn apply_to_window(&mut self, event: Window) {
        match event {
            Window::Settings => self.settings_panel.is_open = !self.settings_panel.is_open,
            Window::Keys => self.key_sheet = !self.key_sheet,
            Window::Palette => self.palette.open(),
            Window::Tour => self.tour.begin(),
            Window::Menu => match self.state.focus {
                Room::Viewport => self.viewport.open_menu_by_key(),
                Room::Canvas => self.canvas.open_menu_by_key(),
                _ => self.outliner.open_menu_by_key(),
            },
            Window::SearchTemplates => self.templates.search(),
            Window::ResetLayout => self.dock = layout::first_layout(),
            Window::NextRoom(step) => self.focus_next(step),
        }
    }

    /// Gives the keys to another open room.
    fn focus_next(&mut self, step: isize) {
        let open: Vec<Room> = self.dock.iter_all_tabs().map(|(_, room)| *room).collect();
        let n = open.len() as isize;
        let at = open.iter().position(|room| *room == self.state.focus).unwrap_or(0) as isize;
        if let Some(room) = open.get((at + step).rem_euclid(n.max(1)) as usize) {
            self.apply(Event::Show(*room));
        }
    }

    /// A press beside an open menu or search closes it, and nothing that lies under it takes the press.
    pub(super) fn shield(&self, ctx: &Context) {
        if !self.palette.is_open() && !self.canvas.searches() && !Popup::is_any_open(ctx) {
            return;
        }
        // The menu bar stays free, so that one menu leads to the next.
        let mut rect = ctx.content_rect();
        rect.min.y = room(ctx).top();
        let id = Id::new("beside what is open");
        Area::new(id).order(Order::Middle).fixed_pos(rect.min).constrain(false).show(ctx, |ui| {
            ui.allocate_rect(rect, Sense::click_and_drag());
        });
        ctx.move_to_top(LayerId::new(Order::Middle, id));
    }

    /// Escape closes what is topmost: a search, then the panel in front. What was typed before it goes with that, what is
    /// typed behind it does not reach it. True where the key is spent.
    pub(super) fn closes_topmost(&mut self, ctx: &Context) -> bool {
        let Some(at) = ctx.input(|input| escape_at(&input.events)) else { return false };
        // These see to it themselves.
        if self.documents.takes_keys() || Popup::is_any_open(ctx) {
            return true;
        }
        let types = self.palette.is_open() || self.canvas.types();
        let held = ctx.input(|input| input.pointer.any_down()) || self.canvas.holds();
        if !types {
            if held {
                return false;
            }
            // A field is left first.
            if self.types {
                return true;
            }
        }
        let closed = self.palette.close()
            || self.canvas.close_search()
            || self.close_front_panel(ctx)
            || self.frees_hair();
        if !closed {
            return false;
        }
        ctx.input_mut(|input| {
            let keys = |event: &egui::Event| {
                matches!(event, egui::Event::Key { pressed: true, .. } | egui::Event::Text(_))
            };
            let mut number = 0;
            input.events.retain(|event| {
                number += 1;
                number - 1 > at || !keys(event)
            });
        });
        true
    }

    /// Over a picture at rest, Escape selects no curve: what was frozen beside the selected ones is free.
    fn frees_hair(&mut self) -> bool {
        let state = &self.state;
        let rests = state.run.since.is_none() && !self.pen.is_drawing();
        let frees = rests && state.focus == Room::Viewport && !state.selection.curves.is_empty();
        if frees {
            self.apply(Event::Select(Select::Curves(BTreeSet::new())));
        }
        frees
    }

    fn close_front_panel(&mut self, ctx: &Context) -> bool {
        let open = [
            (SETTINGS, self.settings_panel.is_open),
            (KEYS, self.key_sheet),
            (WELCOME, self.documents.shows_welcome()),
            (PEN, self.pen.settings_open),
            (HEAD, self.documents.places_head()),
            (RECIPE, self.pen.asked.is_some()),
            (OVER_HAIR, self.documents.mesh.is_some()),
            (TEMPLATE, self.saving_template.is_some()),
            (EXPORT, self.documents.export_panel.is_open),
            (PICTURE, self.documents.picture_panel.is_open),
        ];
        let layers: Vec<LayerId> = ctx.memory(|memory| memory.layer_ids().collect());
        let depth = |name: &str| {
            let layer = LayerId::new(Order::Middle, id(name, ctx));
            layers.iter().position(|other| *other == layer)
        };
        let open = open.into_iter().filter(|(_, open)| *open).map(|(id, _)| id);
        let Some(front) = open.max_by_key(|id| depth(id)) else { return false };
        match front {
            SETTINGS => self.settings_panel.is_open = false,
            KEYS => self.key_sheet = false,
            PEN => self.pen.settings_open = false,
            RECIPE => self.pen.asked = None,
            OVER_HAIR => self.documents.mesh = None,
            TEMPLATE => self.saving_template = None,
            EXPORT => self.documents.export_panel.is_open = false,
            PICTURE => self.documents.picture_panel.is_open = false,
            WELCOME => {
                self.apply(Event::Documents(DocumentEvent::Welcome(false)));
            }
            _ => {
                let cancel = HeadChoice::Cancel;
                self.apply(Event::Documents(DocumentEvent::Head(cancel)));
            }
        }
        true
    }
}
