//! One number: drag it, type it, nudge it.
//!
//! Dragging sideways runs over the slider's range (Shift fine, Ctrl in large steps), a click types, Up and Down nudge
//! while typing, Alt+click asks for the default. The field changes nothing itself: it says what was done.

use super::number::{NumberEdit, Scale};
use crate::widgets::theme;
use egui::text::{CCursor, CCursorRange};
use egui::{
    Align2, CursorIcon, FontSelection, Id, Key, Modifiers, Rect, Response, Sense, Stroke,
    StrokeKind, TextEdit, TextStyle, Ui, Vec2, WidgetInfo, pos2,
};

/// What was done to a number.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Done {
    /// It is being dragged and is this now.
    Dragged(f64),
    /// This was typed.
    Typed(NumberEdit),
    /// It was nudged by so much.
    Nudged(f64),
    /// What was typed cannot be read.
    Refused(String),
    /// The default is wanted.
    Reset,
}

/// A field for one number.
pub(crate) struct NumberField<'a> {
    /// What it is called for those who cannot see it, and in tests.
    pub(crate) name: &'a str,
    /// The number; none when it is not set.
    pub(crate) value: Option<f64>,
    /// What is shown instead of the number, where several nodes differ.
    pub(crate) instead: Option<&'a str>,
    /// What is shown when it is not set.
    pub(crate) unset: Option<&'a str>,
    /// How it is shown and limited.
    pub(crate) scale: &'a Scale,
}

/// A drag under way.
#[derive(Clone, Copy)]
struct Drag {
    /// The number at its beginning, and how far the hand went since, both in document units.
    from: f64,
    gone: f64,
}

/// Text that is being typed, and the number it began with.
#[derive(Clone, Default)]
struct Typing {
    text: String,
    of: Option<f64>,
}

impl NumberField<'_> {
    /// Shows the field as wide as `width`.
    pub(crate) fn show(self, ui: &mut Ui, width: f32) -> (Response, Option<Done>) {
        let size = Vec2::new(width, ui.spacing().interact_size.y);
        // By name and not by order: what appears above must not end a drag.
        let id = ui.id().with(self.name);
        ui.memory_mut(|memory| memory.interested_in_focus(id, ui.layer_id()));
        let (response, mut done) = if ui.memory(|memory| memory.has_focus(id)) {
            self.typed(ui, id, size)
        } else {
            let (response, done) = self.dragged(ui, id, size);
            // The keyboard went elsewhere by a click or Tab: what was typed counts.
            let left = ui.data_mut(|data| data.remove_temp::<Typing>(id));
            (response, done.or_else(|| self.read(ui, &left?)))
        };
        use egui::accesskit::{Action, ActionData};
        ui.input(|input| {
            let steps = input.num_accesskit_action_requests(id, Action::Increment) as f64
                - input.num_accesskit_action_requests(id, Action::Decrement) as f64;
            if steps != 0.0 {
                done = Some(Done::Nudged(steps * self.scale.step(self.value.unwrap_or(0.0))));
            }
            for request in input.accesskit_action_requests(id, Action::SetValue) {
                if let Some(ActionData::NumericValue(x)) = request.data
                    && x.is_finite()
                {
                    done = Some(Done::Typed(NumberEdit::Set(x)));
                }
            }
        });
        response.widget_info(|| {
            WidgetInfo::slider(ui.is_enabled(), self.value.unwrap_or(0.0), self.name)
        });
        let text = self.text();
        ui.ctx().accesskit_node_builder(response.id, |node| {
            node.set_value(text);
            node.add_action(Action::SetValue);
            node.add_action(Action::Increment);
            node.add_action(Action::Decrement);
            if let Some((lo, hi)) = self.scale.hard {
                node.set_min_numeric_value(lo);
                node.set_max_numeric_value(hi);
            }
        });
        (response, done)
    }

    fn text(&self) -> String {
        match (self.instead, self.value) {
            (Some(instead), _) => instead.to_owned(),
            (None, Some(x)) => self.scale.text(x),
            (None, None) => self.unset.unwrap_or("unset").to_owned(),
        }
    }

    fn typed(&self, ui: &mut Ui, id: Id, size: Vec2) -> (Response, Option<Done>) {
        // A number that changed meanwhile (nudged, undone) goes before what was typed.
        let kept = ui.data_mut(|data| data.remove_temp::<Typing>(id));
        let kept = kept.filter(|typing| typing.of == self.value);
        let fresh = kept.is_none();
        let mut typing = kept.unwrap_or_else(|| Typing { text: self.first(), of: self.value });
        if fresh {
            let all = CCursorRange::two(CCursor::new(0), CCursor::new(typing.text.chars().count()));
            let mut state = TextEdit::load_state(ui.ctx(), id).unwrap_or_default();
            state.cursor.set_char_range(Some(all));
            state.store(ui.ctx(), id);
        }
        let nudges = nudges(ui, id);
        let response = ui.add_sized(
            size,
            TextEdit::singleline(&mut typing.text)
                .id(id)
                .margin(egui::Margin::symmetric(6, 2))
                .horizontal_align(egui::Align::Max)
                .vertical_align(egui::Align::Center)
                .font(FontSelection::from(TextStyle::Body)),
        );
        if nudges != 0.0 {
            let step = self.scale.step(self.value.unwrap_or(0.0));
            return (response, Some(Done::Nudged(nudges * step)));
        }
        if response.lost_focus() {
            let done = self.read(ui, &typing);
            return (response, done);
        }
        ui.data_mut(|data| data.insert_temp(id, typing));
        (response, None)
    }

    /// The text that typing begins with.
    fn first(&self) -> String {
        self.value.map_or(String::new(), |x| self.scale.exact(x))
    }

    /// What typed text does when the field is left.
    fn read(&self, ui: &Ui, typing: &Typing) -> Option<Done> {
        let left = ui.input(|input| input.key_pressed(Key::Escape));
        let same = typing.of != self.value || typing.text == self.first();
        if left || same || typing.text.trim().is_empty() {
            return None;
        }
        Some(self.scale.read(&typing.text).map_or_else(Done::Refused, Done::Typed))
    }

    fn dragged(&self, ui: &mut Ui, id: Id, size: Vec2) -> (Response, Option<Done>) {
        let (rect, _) = ui.allocate_exact_size(size, Sense::hover());
        let response = ui.interact(rect, id, Sense::click_and_drag());
        let response = response.on_hover_and_drag_cursor(CursorIcon::ResizeHorizontal);
        self.paint(ui, rect, &response);
        let modifiers = ui.input(|input| input.modifiers);
        if response.clicked() {
            if modifiers.alt {
                return (response, Some(Done::Reset));
            }
            ui.data_mut(|data| data.remove::<Typing>(id));
            ui.memory_mut(|memory| memory.request_focus(id));
            return (response, None);
        }
        if !response.dragged() {
            return (response, None);
        }
        let now = self.value.unwrap_or_else(|| self.beginning());
        let mut drag = ui
            .data(|data| data.get_temp::<Drag>(id))
            .filter(|_| !response.drag_started())
            .unwrap_or(Drag { from: now, gone: 0.0 });
        let step = self.scale.step(now);
        let per_point = match self.scale.slider {
            Some((lo, hi)) if hi > lo => (hi - lo) / f64::from(size.x.max(20.0)),
            _ => step * 0.25,
        };
        let fine = if modifiers.shift { 0.1 } else { 1.0 };
        drag.gone += f64::from(moved(&response).x) * per_point * fine;
        ui.data_mut(|data| data.insert_temp(id, drag));
        let grid = match (modifiers.shift, modifiers.command || modifiers.ctrl) {
            _ if self.scale.whole => 1.0,
            (true, _) => step / 10.0,
            (_, true) => step * 10.0,
            _ => step,
        };
        let mut x = self.scale.snap(drag.from + drag.gone, grid);
        // A drag ends at the slider's ends, unless typing went beyond before.
        if let Some((lo, hi)) = self.scale.slider.filter(|(lo, hi)| lo < hi) {
            x = x.max(lo.min(drag.from)).min(hi.max(drag.from));
        }
        if let Some((lo, hi)) = self.scale.hard {
            x = x.max(lo).min(hi);
        }
        // What documents hold is an f32.
        let changed = self.value.is_none_or(|old| old as f32 != x as f32);
        (response, changed.then_some(Done::Dragged(x)))
    }

    /// Where a drag of a number begins that is not set.
    fn beginning(&self) -> f64 {
        let (lo, hi) = self.scale.slider.unwrap_or((0.0, 0.0));
        self.scale.snap((lo + hi) / 2.0, self.scale.step(0.0))
    }

    fn paint(&self, ui: &Ui, rect: Rect, response: &Response) {
        let visuals = ui.style().interact(response);
        let painter = ui.painter_at(rect.expand(1.0));
        let rounding = visuals.corner_radius;
        painter.rect(rect, rounding, theme::SUNKEN.of(ui), Stroke::NONE, StrokeKind::Inside);
        if let (Some(x), Some((lo, hi)), None) = (self.value, self.scale.slider, self.instead)
            && hi > lo
        {
            let part = |x: f64| ((x - lo) / (hi - lo)).clamp(0.0, 1.0) as f32;
            // Ranges that run through zero fill from there.
            let (a, b) = (part(x), part(0f64.clamp(lo, hi)));
            let bar = Rect::from_min_max(
                pos2(egui::lerp(rect.x_range(), a.min(b)), rect.top()),
                pos2(egui::lerp(rect.x_range(), a.max(b)), rect.bottom()),
            );
            let fill = if response.hovered() || response.dragged() {
                theme::SELECTED.of(ui)
            } else {
                theme::RAISED.of(ui)
            };
            painter.rect(bar, rounding, fill, Stroke::NONE, StrokeKind::Inside);
            let at = egui::lerp(rect.x_range(), a).clamp(rect.left() + 1.0, rect.right() - 1.0);
            let mark =
                theme::ACCENT.of(ui).gamma_multiply(if response.hovered() { 1.0 } else { 0.55 });
            painter.vline(at, rect.y_range().shrink(1.0), Stroke::new(1.5, mark));
        }
        let line = if response.hovered() { visuals.bg_stroke.color } else { theme::LINE.of(ui) };
        painter.rect_stroke(rect, rounding, Stroke::new(1.0, line), StrokeKind::Inside);
        let quiet = self.value.is_none() || self.instead.is_some();
        painter.text(
            pos2(rect.right() - 7.0, rect.center().y),
            Align2::RIGHT_CENTER,
            self.text(),
            TextStyle::Body.resolve(ui.style()),
            if quiet { theme::QUIET.of(ui) } else { theme::TEXT.of(ui) },
        );
    }
}

/// How far the hand went since the last frame; when a drag begins, since the press.
pub(crate) fn moved(response: &Response) -> Vec2 {
    let begun = response.drag_started().then(|| response.total_drag_delta()).flatten();
    begun.unwrap_or_else(|| response.drag_delta())
}

/// Steps asked for by Up and Down, or by the wheel over the field that has the keyboard; Shift fine, Ctrl large.
fn nudges(ui: &mut Ui, id: Id) -> f64 {
    let mut steps = 0.0;
    ui.input_mut(|input| {
        for (modifiers, size) in
            [(Modifiers::SHIFT, 0.1), (Modifiers::COMMAND, 10.0), (Modifiers::NONE, 1.0)]
        {
            steps += size * input.count_and_consume_key(modifiers, Key::ArrowUp) as f64;
            steps -= size * input.count_and_consume_key(modifiers, Key::ArrowDown) as f64;
        }
    });
    let over = ui.ctx().read_response(id).is_some_and(|last| last.contains_pointer());
    if over {
        ui.input_mut(|input| {
            let before = steps;
            for event in &input.events {
                if let egui::Event::MouseWheel { delta, modifiers, .. } = event
                    && delta.y != 0.0
                {
                    let size = if modifiers.shift { 0.1 } else { 1.0 };
                    steps += size * f64::from(delta.y.signum());
                }
            }
            if steps != before {
                input.smooth_scroll_delta = Vec2::ZERO;
            }
        });
    }
    steps
}
