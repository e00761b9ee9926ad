//! The pictures that the room holds: that of one's own groom, and that of another while two are compared.
//!
//! Guaranteed: both are seen by the same camera in the same light, and each is as large as the room whatever part of it is seen, so
//! that none begins anew when they are shown another way. A picture that is not shown is asked for nothing, and keeps what it has.

use super::drawing::{Drawing, Drawn, PickResult};
use super::{Followed, Viewport};
use crate::core::shown::Sides;
use crate::core::state::State;
use crate::widgets::theme;
use egui::{
    Align2, CursorIcon, FontId, Key, Pos2, Rect, Response, Sense, Stroke, TextureHandle,
    TextureOptions, Vec2,
};

/// Half as wide as the divider can be taken hold of, points.
const GRIP: f32 = 6.0;
/// How far an arrow key moves the divider, as a share of the room's width.
const STEP: f32 = 0.02;
/// How far from either edge of the room the divider stays, as a share of its width.
const MARGIN: f32 = 0.02;

/// How another groom is seen beside one's own.
pub(crate) struct Compared {
    /// Which of the two, and where.
    pub sides: Sides,
    /// What the other is called.
    pub name: String,
    /// What the room's button says, and in which colour.
    pub said: (String, theme::Tint),
}

/// A picture.
#[derive(Default)]
pub(super) struct Pane {
    pub(super) drawing: Option<Drawing>,
    pub(super) on_screen: Option<OnScreen>,
    pub(super) followed: Followed,
    /// Where it lies, and the part of that which is seen; nothing while it is not shown.
    seen: Option<Seen>,
}

/// The picture on the screen.
pub(super) struct OnScreen {
    texture: TextureHandle,
    pub(super) drawn: Drawn,
}

/// Where a picture lies on the screen, and what part of it is seen.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Seen {
    place: Rect,
    part: Rect,
}

/// Where both pictures lie in a room.
fn lay(sides: Sides, room: Rect, divider: f32) -> [Option<Seen>; 2] {
    let whole = Seen { place: room, part: room };
    let halves = |at: f32| room.split_left_right_at_fraction(at);
    match sides {
        Sides::Own => [Some(whole), None],
        Sides::Other => [None, Some(whole)],
        Sides::Wipe => {
            let (left, right) = halves(divider);
            [left, right].map(|part| Some(Seen { part, ..whole }))
        }
        Sides::Beside => {
            let (left, right) = halves(0.5);
            // The middle of each picture is in the middle of its half.
            [left, right].map(|part| {
                let off = part.center() - room.center();
                Some(Seen { place: room.translate(off), part })
            })
        }
    }
}

impl Pane {
    /// Puts the newest picture on the screen; whether there was one.
    pub(super) fn take(&mut self, ctx: &egui::Context, born: u64) -> bool {
        let Some(drawn) = self.drawing.as_ref().and_then(Drawing::take) else { return false };
        if drawn.wanted.revision < born {
            return false;
        }
        let image = egui::ImageData::Color(drawn.image.clone());
        let texture = match self.on_screen.take() {
            Some(OnScreen { mut texture, .. }) => {
                texture.set(image, TextureOptions::LINEAR);
                texture
            }
            None => ctx.load_texture("picture of the groom", image, TextureOptions::LINEAR),
        };
        self.on_screen = Some(OnScreen { texture, drawn });
        true
    }

    /// What was found under the pointer since the last call.
    pub(super) fn picked(&self) -> Option<PickResult> {
        self.drawing.as_ref().and_then(Drawing::picked)
    }

    fn paint(&self, state: &State, ui: &egui::Ui) {
        let Some(Seen { place, part }) = self.seen else { return };
        let painter = ui.painter_at(part);
        painter.rect_filled(part, 0.0, theme::SUNKEN.dark);
        let drawn = self.on_screen.as_ref().filter(|_| state.shown.is_some());
        let Some(OnScreen { texture, drawn }) = drawn else { return };
        // After a change of size the last picture keeps its shape until the next one comes.
        let [width, height] = drawn.wanted.size.map(|n| n as f32);
        let scale = place.height() / height.max(1.0);
        let place = Rect::from_center_size(place.center(), Vec2::new(width, height) * scale);
        let whole = Rect::from_min_max(Pos2::ZERO, Pos2::new(1.0, 1.0));
        painter.image(texture.id(), place, whole, egui::Color32::WHITE);
    }
}

impl Viewport {
    /// The number of the picture in hand: the one that is pointed at, turned and drawn on.
    pub(super) fn number(&self) -> usize {
        usize::from(self.panes[0].seen.is_none() && self.panes[1].seen.is_some())
    }

    /// The picture in hand.
    pub(super) fn hand(&self) -> &Pane {
        &self.panes[self.number()]
    }

    /// How two grooms are shown; one's own alone while the other has no hair yet.
    pub(super) fn sides(&self, other: Option<&State>) -> Sides {
        let sides = self.compared.as_ref().map_or(Sides::Own, |compared| compared.sides);
        if other.is_some() { sides } else { Sides::Own }
    }

    /// Finds where the pictures lie. That of another groom goes when nothing is compared any more.
    pub(super) fn lay(&mut self, sides: Sides, room: Rect) {
        self.room = room;
        let [own, other] = lay(sides, room, self.divider);
        (self.panes[0].seen, self.panes[1].seen) = (own, other);
        let seen = own.or(other).unwrap_or(Seen { place: room, part: room });
        (self.rect, self.part) = (seen.place, seen.part);
        self.beside = sides == Sides::Beside;
        if self.compared.is_none() && self.panes[1].drawing.is_some() {
            let gone = std::mem::take(&mut self.panes[1]);
            // Its thread is waited for, which the window must not do.
            std::thread::spawn(move || drop(gone));
        }
    }

    /// How far the picture that is seen at a place lies from the one in hand.
    pub(super) fn off(&self, at: Pos2) -> Vec2 {
        let seen = self.panes.iter().filter_map(|pane| pane.seen);
        let there = seen.into_iter().find(|seen| seen.part.contains(at));
        there.map_or(Vec2::ZERO, |seen| seen.place.min - self.rect.min)
    }

    /// The part of the room in which the picture in hand is seen.
    pub fn part(&self) -> Rect {
        self.part
    }

    /// Asks for the pictures of what is there now, of those that are shown.
    pub(super) fn ask_all(&mut self, states: [Option<&State>; 2], ui: &egui::Ui) {
        if states[1].is_some() && self.panes[0].drawing.is_some() && self.panes[1].drawing.is_none()
        {
            self.panes[1].drawing = self.begin_drawing(ui.ctx());
        }
        if let Some(other) = states[1] {
            // Of the groom that was compared before nothing is shown.
            let is_old = |screen: &mut OnScreen| screen.drawn.wanted.revision < other.revision;
            self.panes[1].on_screen.take_if(is_old);
        }
        for (number, state) in states.into_iter().enumerate() {
            if let Some(state) = state.filter(|_| self.panes[number].seen.is_some()) {
                self.ask(number, state, ui);
            }
        }
    }

    pub(super) fn paint(&self, states: [Option<&State>; 2], ui: &egui::Ui) {
        for (pane, state) in self.panes.iter().zip(states) {
            if let Some(state) = state {
                pane.paint(state, ui);
            }
        }
    }

    /// The line between two pictures, with what each is called. In a wipe it can be dragged, or moved by arrow keys.
    pub(super) fn divide(&mut self, sides: Sides, ui: &egui::Ui) {
        let Some(compared) = &self.compared else { return };
        let at = match sides {
            Sides::Own | Sides::Other => return,
            Sides::Wipe => self.divider,
            Sides::Beside => 0.5,
        };
        let x = egui::lerp(self.room.x_range(), at);
        let painter = ui.painter_at(self.room);
        for (words, off, align) in [
            ("yours", -8.0, Align2::RIGHT_BOTTOM),
            (compared.name.as_str(), 8.0, Align2::LEFT_BOTTOM),
        ] {
            let (font, ink) = (FontId::proportional(12.0), theme::TEXT.dark);
            let text = painter.layout_no_wrap(words.to_owned(), font, ink);
            let place =
                align.anchor_size(Pos2::new(x + off, self.room.bottom() - 8.0), text.size());
            painter.rect_filled(place.expand(3.0), 3.0, super::hud::SHADE);
            painter.galley(place.min, text, ink);
        }
        let mut line = Stroke::new(1.0, theme::TEXT.dark);
        if sides == Sides::Wipe {
            let grip = Rect::from_x_y_ranges(x - GRIP..=x + GRIP, self.room.y_range());
            let response = ui.interact(grip, ui.id().with("divider"), Sense::click_and_drag());
            response.widget_info(|| {
                egui::WidgetInfo::slider(true, f64::from(at), "Divider between the two grooms")
            });
            if response.hovered() || response.dragged() || response.has_focus() {
                line = Stroke::new(2.0, theme::ACCENT.dark);
                ui.ctx().set_cursor_icon(CursorIcon::ResizeHorizontal);
            }
            self.divider = self.moved(&response, ui);
        }
        painter.vline(x, self.room.y_range(), line);
    }

    /// Where the divider is brought.
    fn moved(&self, response: &Response, ui: &egui::Ui) -> f32 {
        let mut to = self.divider;
        if response.dragged()
            && let Some(at) = response.interact_pointer_pos()
        {
            to = (at.x - self.room.left()) / self.room.width().max(1.0);
        }
        if response.has_focus() {
            crate::widgets::keyboard::keep_arrows(ui, response.id);
            let pressed = |key| ui.input(|input| input.num_presses(key)) as f32;
            to += STEP * (pressed(Key::ArrowRight) - pressed(Key::ArrowLeft));
        }
        to.clamp(MARGIN, 1.0 - MARGIN)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ROOM: Rect = Rect { min: Pos2::new(10.0, 20.0), max: Pos2::new(410.0, 220.0) };

    /// What is seen at a place of the room, as a place in its picture from the picture's middle.
    fn seen(sides: Sides, divider: f32, at: Pos2) -> Vec<(usize, Vec2)> {
        let laid = lay(sides, ROOM, divider).into_iter().enumerate();
        let seen = laid.filter_map(|(number, seen)| Some((number, seen?)));
        let there = seen.filter(|(_, seen)| seen.part.contains(at));
        there.map(|(number, seen)| (number, at - seen.place.center())).collect()
    }

    #[test]
    fn both_pictures_are_as_large_as_the_room_whatever_is_seen_of_them() {
        for sides in [Sides::Own, Sides::Other, Sides::Wipe, Sides::Beside] {
            for seen in lay(sides, ROOM, 0.3).into_iter().flatten() {
                assert_eq!(seen.place.size(), ROOM.size(), "{sides:?}");
            }
        }
    }

    #[test]
    fn a_wipe_shows_one_place_of_both_and_side_by_side_shows_the_middle_of_each() {
        let (left, right) = (Pos2::new(100.0, 120.0), Pos2::new(300.0, 120.0));
        assert_eq!(seen(Sides::Wipe, 0.5, left), [(0, Vec2::new(-110.0, 0.0))]);
        assert_eq!(seen(Sides::Wipe, 0.5, right), [(1, Vec2::new(90.0, 0.0))]);
        assert_eq!(seen(Sides::Wipe, 0.1, left), [(1, Vec2::new(-110.0, 0.0))], "moved away");
        // Places 200 points apart show the same of both heads.
        assert_eq!(seen(Sides::Beside, 0.1, left), [(0, Vec2::new(-10.0, 0.0))]);
        assert_eq!(seen(Sides::Beside, 0.1, right), [(1, Vec2::new(-10.0, 0.0))]);
    }
}
