//! The menu of the right button over the picture: what can be done with the hair, the head or the nothing that is there.
//!
//! A press that is dragged moves the eye as before; one that is let go where it was opens the menu, once it is known what lies
//! there. The key for menus opens it too. Its entries are actions of the table.

use super::drawing::HairHit;
use super::parts::PointedHead;
use super::select::{Level, together_with};
use super::{Clicked, Purpose, Viewport, hud};
use crate::core::action;
use crate::core::event::Event;
use crate::core::state::{Select, State};
use crate::widgets::panel;
use egui::{Pos2, Response};

/// Actions on hair; empty lines part them.
const HAIR: &[&str] = &[
    "view.select_node",
    "view.what_made",
    "view.reveal",
    "",
    "view.frame_selected",
    "view.isolate",
    "view.hide",
    "view.lock",
    "view.show_all",
    "",
    "view.select_kin",
];

/// Actions on a head.
const HEAD: &[&str] = &["view.frame_head", "view.select_head", "view.head"];

/// Actions that leave out an area that is not a separate part of the mesh.
const AREAS: &[&str] = &["pen.leave_out", "pen.leave_out_painted"];

/// Actions where nothing is.
const NOTHING: &[&str] = &["view.frame_all", "view.show_all"];

/// The menu of the picture.
#[derive(Default)]
pub(super) struct Menu {
    /// Somebody asked for it with a key.
    pub(super) by_key: bool,
    /// It opens here.
    opens: Option<Pos2>,
    on: On,
    /// The head that lies there.
    head: Option<PointedHead>,
}

/// What the menu is about.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
enum On {
    Hair,
    Head,
    #[default]
    Nothing,
}

impl Viewport {
    /// Opens the menu where it is asked for, and shows it.
    pub(super) fn menu(
        &mut self,
        state: &State,
        ui: &egui::Ui,
        response: &Response,
        out: &mut Vec<Event>,
    ) {
        let mut at = None;
        // The other buttons of a pen turn the view.
        if response.secondary_clicked() && !self.pen.near {
            at = ui.input(|input| input.pointer.interact_pos());
        }
        if std::mem::take(&mut self.menu.by_key) {
            let pointer = ui.input(|input| input.pointer.hover_pos());
            at = Some(pointer.filter(|at| self.part.contains(*at)).unwrap_or(self.part.center()));
        }
        if let Some(at) = at {
            let pane = self.hand();
            if !self.part.contains(at) {
                // What is only looked at has nothing that could be done.
                self.open_menu(state, at, None, false, out);
            } else if pane.drawing.is_some() && pane.on_screen.is_some() {
                self.question(at, Purpose::Menu);
            } else {
                // Without pictures only the head is found.
                let head = PointedHead::new(state, &self.projection().ray(at)).is_some();
                self.open_menu(state, at, None, head, out);
            }
        }
        let (on, opens) = (self.menu.on, self.menu.opens.take());
        let head = self.menu.head.clone();
        let skin = |ui: &mut egui::Ui, out: &mut Vec<Event>| {
            head.iter().for_each(|head| head.ui(state, ui, out));
            action::menu(state.table, AREAS, ui, out);
        };
        panel::menu_at(response, opens, |ui| match on {
            On::Hair => {
                action::menu(state.table, HAIR, ui, out);
                if head.is_some() {
                    panel::submenu(ui, "Skin below", |ui| skin(ui, out));
                }
            }
            On::Head => {
                action::menu(state.table, HEAD, ui, out);
                ui.separator();
                skin(ui, out);
                ui.separator();
                panel::submenu(ui, "Light and skin", |ui| {
                    hud::looks(&mut self.options, ui, out);
                });
                self.views_menu(state, ui, out);
            }
            On::Nothing => {
                action::menu(state.table, NOTHING, ui, out);
                ui.separator();
                self.views_menu(state, ui, out);
                panel::submenu(ui, "Show", |ui| hud::shows(&mut self.options, state, ui));
                panel::submenu(ui, "Over the picture", |ui| hud::over(&mut self.options, ui));
                panel::submenu(ui, "Light and look", |ui| {
                    hud::looks(&mut self.options, ui, out);
                });
            }
        });
    }

    fn views_menu(&mut self, state: &State, ui: &mut egui::Ui, out: &mut Vec<Event>) {
        panel::submenu(ui, "Look from", |ui| hud::views(self, state, ui, out));
    }

    /// Opens the menu on what was found there. Hair that is not selected is, with all of its braid or cluster.
    pub(super) fn open_menu(
        &mut self,
        state: &State,
        at: Pos2,
        hair: Option<HairHit>,
        head: bool,
        out: &mut Vec<Event>,
    ) {
        self.menu.opens = Some(at);
        self.menu.head = PointedHead::new(state, &self.projection().ray(at)).filter(|_| head);
        self.menu.on = match (&hair, head) {
            (Some(_), _) => On::Hair,
            (None, true) => On::Head,
            (None, false) => On::Nothing,
        };
        let Some((hair, shown)) = hair.zip(state.shown.as_ref()) else { return };
        self.meant = Some(hair.id());
        if state.selection.curves.contains(&hair.id()) {
            return;
        }
        let kin = |level| together_with(&shown.curves, (&hair.tuft, hair.curve), level, None);
        let (braid, cluster) = (kin(Level::Braid), kin(Level::Cluster));
        let (level, ids) = match braid.len() > 1 {
            true => (Level::Braid, braid),
            false => (Level::Cluster, cluster),
        };
        out.push(Event::Select(Select::Curves(ids)));
        out.push(Event::Trace(hair.id()));
        self.clicked = Some(Clicked { hair, level, tracing: true });
    }
}
