//! What lies under the pointer: asked of the drawing thread, answered a little later.
//!
//! A click selects a curve and the node that made it; the same again selects more of its kin.

use super::drawing::{HairHit, PickQuery};
use super::select::{self, Level};
use super::{Clicked, NEAR, Purpose, Question, Under, Viewport, hud};
use crate::core::event::Event;
use crate::core::projection::Projection;
use crate::core::room::Room;
use crate::core::shown::{Shown, first_output};
use crate::core::state::{Select, State};
use coif_nodes::data::curves::Curves;
use egui::{Pos2, Response};
use std::collections::BTreeSet;

impl Viewport {
    pub(super) fn question(&mut self, at: Pos2, purpose: Purpose) {
        let number = self.number();
        let pane = &self.panes[number];
        let (Some(drawing), Some(screen)) = (&pane.drawing, &pane.on_screen) else { return };
        let camera = screen.drawn.wanted.camera;
        let view = Projection::new(camera, self.rect);
        let part = (at - self.rect.min) / self.rect.size();
        self.questions += 1;
        drawing.pick(PickQuery {
            number: self.questions,
            at: [part.x, part.y],
            ray: view.ray(at),
            camera,
        });
        self.question = Some(Question { number: self.questions, purpose, at });
    }

    pub(super) fn hover(
        &mut self,
        state: &State,
        ui: &egui::Ui,
        response: &Response,
        out: &mut Vec<Event>,
    ) {
        let held = self.drag.is_some() || self.handles.is_dragging() || self.pen.pointer;
        let at = response
            .hover_pos()
            .filter(|at| response.hovered() && !held && self.part.contains(*at));
        let Some(at) = at else {
            self.under = None;
            return;
        };
        let keys = ui.input(|input| input.modifiers);
        if response.clicked() && !self.primary_moves(state, ui) {
            out.push(Event::Focus(Room::Viewport));
            self.question(at, Purpose::Click { more: keys.shift });
        } else if self.question.is_none()
            && self.moves_until.is_none()
            && !state.gesture
            && self.under.as_ref().is_none_or(|under| under.at != at || under.camera != self.camera)
        {
            self.question(at, Purpose::Hover);
        }
        if self.options.card
            && let Some(under) = self.under.as_ref().filter(|under| under.at.distance(at) < NEAR)
            && let Some(hair) = &under.picked.hair
        {
            response.clone().on_hover_ui_at_pointer(|ui| hud::card(hair, ui));
        }
    }

    pub(super) fn take_answer(&mut self, state: &State, out: &mut Vec<Event>) {
        let Some(picked) = self.hand().picked() else { return };
        let Some(question) = self.question.take_if(|q| q.number <= picked.number) else { return };
        let camera = self.hand().on_screen.as_ref().map_or(self.camera, |s| s.drawn.wanted.camera);
        match question.purpose {
            Purpose::Click { more } => self.clicked_on(state, picked.hair.clone(), more, out),
            Purpose::Menu => {
                let (hair, head) = (picked.hair.clone(), picked.skin.is_some());
                self.open_menu(state, question.at, hair, head, out);
            }
            Purpose::Hover => {}
        }
        self.under = Some(Under { at: question.at, camera, picked });
    }

    /// Selects the curve that was clicked; the same again, more of its kin.
    fn clicked_on(
        &mut self,
        state: &State,
        hair: Option<HairHit>,
        more: bool,
        out: &mut Vec<Event>,
    ) {
        let Some((hair, shown)) = hair.zip(state.shown.as_ref()) else {
            self.clicked = None;
            if !more {
                out.push(Event::Select(Select::Curves(BTreeSet::new())));
            }
            return;
        };
        let again = self.clicked.as_ref().filter(|clicked| {
            clicked.hair.id() == hair.id() && state.selection.curves.contains(&hair.id())
        });
        let of = (&*hair.tuft, hair.curve);
        let (level, ids) = match again {
            Some(clicked) => {
                let made = self.made_by_active(state, shown);
                select::next_level(&shown.curves, of, clicked.level, made)
            }
            None => (Level::Hair, [hair.id()].into()),
        };
        let mut selected = ids;
        if more && again.is_none() {
            selected.extend(&state.selection.curves);
        }
        out.push(Event::Select(Select::Curves(selected)));
        self.meant = Some(hair.id());
        out.push(Event::Trace(hair.id()));
        self.clicked = Some(Clicked { hair, level, tracing: true });
    }

    /// Selects the node that made the clicked curve, once it is known.
    pub(super) fn find_maker(&mut self, state: &State, out: &mut Vec<Event>) {
        let Some(clicked) = self.clicked.as_mut().filter(|clicked| clicked.tracing) else { return };
        if let Some(made) = state.traced.first().filter(|made| made.id == clicked.hair.id()) {
            clicked.tracing = false;
            out.push(Event::Select(Select::Nodes(vec![made.node.clone()])));
        }
    }

    /// All that the active node gives.
    fn made_by_active<'a>(&self, state: &State, shown: &'a Shown) -> Option<&'a Curves> {
        let socket = first_output(&state.document, state.active()?)?;
        shown.curves_of(&socket)
    }

    /// The one hair that is meant: that which was clicked last, with either button, while it is selected; else the first that is.
    pub(super) fn hair_meant(&self, selected: &BTreeSet<u64>) -> Option<u64> {
        let clicked = self.meant.filter(|id| selected.contains(id));
        clicked.or_else(|| selected.first().copied())
    }

    /// How much the last click took, for the status line.
    pub(super) fn taken(&self) -> Option<Level> {
        self.clicked.as_ref().map(|clicked| clicked.level)
    }
}
