//! The ramp editor: root left, tip right.
//!
//! Double click adds a stop, a drag moves it (Shift the value only, Ctrl fine), Delete removes it, arrows nudge it, Ctrl+C
//! and Ctrl+V copy and paste the ramp as text; the numbers of the selected stop stand below. Values may go beyond what is shown, up to the input's hard range; what is
//! shown does not move under the hand.

use super::number::Scale;
use super::slider::{Done, NumberField, moved};
use super::stops::{self, Limits};
use super::target::How;
use crate::widgets::keyboard::keep_arrows;
use crate::widgets::text::{icon_button, set_name};
use crate::widgets::{panel, theme};
use coif_graphs::text::{parse_value, write_value};
use coif_nodes::data::ramp::{Blend, Ramp};
use coif_nodes::define::{Type, Value};
use egui::{
    Align2, ComboBox, Id, Key, Modifiers, Pos2, Rect, Response, Sense, Shape, Stroke, StrokeKind,
    TextEdit, TextStyle, Ui, WidgetInfo, WidgetType, pos2, vec2,
};

/// How near, in points, a stop is picked.
const REACH: f32 = 10.0;
const HEIGHT: f32 = 84.0;

/// What a ramp editor must know.
pub(crate) struct RampField<'a> {
    /// What it is called for those who cannot see it.
    pub(crate) name: &'a str,
    /// Its values' unit and range.
    pub(crate) scale: &'a Scale,
}

/// What is remembered between frames.
#[derive(Clone, Copy, Debug, Default)]
struct Memory {
    selected: Option<usize>,
    drag: Option<Drag>,
}

/// A stop under the hand.
#[derive(Clone, Copy, Debug)]
struct Drag {
    stop: usize,
    /// Where the hand has led it, unclamped.
    at: (f32, f32),
    /// The values that the plot showed when it began.
    shown: (f32, f32),
}

impl RampField<'_> {
    fn limits(&self) -> Limits {
        let (lo, hi) = self.scale.hard.unwrap_or((-1e6, 1e6));
        (lo as f32, hi as f32)
    }

    /// Shows the editor and gives the ramp it becomes.
    pub(crate) fn show(&self, ui: &mut Ui, ramp: &Ramp, width: f32) -> Option<(Ramp, How)> {
        let id = ui.id().with((self.name, "ramp"));
        let mut memory: Memory = ui.data(|data| data.get_temp(id)).unwrap_or_default();
        let most = ramp.stops().len() - 1;
        memory.selected = memory.selected.filter(|i| *i <= most);
        memory.drag = memory.drag.filter(|drag| drag.stop <= most);
        let mut new = None;
        ui.vertical(|ui| {
            ui.spacing_mut().item_spacing.y = 2.0;
            let plotted = self.plot(ui, id, ramp, width, &mut memory);
            let tools = self.tools(ui, id, ramp, width, &mut memory);
            new = plotted.or(tools);
        });
        ui.data_mut(|data| data.insert_temp(id, memory));
        new.filter(|(new, _)| new != ramp)
    }

    fn plot(
        &self,
        ui: &mut Ui,
        id: Id,
        ramp: &Ramp,
        width: f32,
        memory: &mut Memory,
    ) -> Option<(Ramp, How)> {
        let (rect, _) = ui.allocate_exact_size(vec2(width, HEIGHT), Sense::hover());
        let response = ui.interact(rect, id.with("plot"), Sense::click_and_drag());
        let (lo, hi) = self.scale.slider.unwrap_or((0.0, 1.0));
        let fit = || stops::shown(ramp, (lo as f32, hi as f32));
        let shown = memory.drag.map_or_else(fit, |drag| drag.shown);
        let view = View { rect: plotted(rect), shown };
        let new = self.handled(ui, &response, &view, ramp, memory);
        if response.clicked() || response.drag_started() {
            response.request_focus();
        }
        if response.has_focus() {
            keep_arrows(ui, response.id);
        }
        let now = new.as_ref().map_or(ramp, |(new, _)| new);
        view.paint(ui, &response, now, self.scale, memory.selected);
        response.widget_info(|| WidgetInfo::labeled(WidgetType::Other, ui.is_enabled(), self.name));
        response.on_hover_ui(|ui| {
            ui.label("Root left, tip right.");
            ui.weak("Double click adds a point, drag moves it (Shift: value only, Ctrl: fine), Delete removes it.");
        });
        new
    }

    fn handled(
        &self,
        ui: &Ui,
        response: &Response,
        view: &View,
        ramp: &Ramp,
        memory: &mut Memory,
    ) -> Option<(Ramp, How)> {
        let limits = self.limits();
        let near = |at: Pos2| view.nearest(ramp, at);
        if response.drag_started()
            && let Some(at) = ui.input(|input| input.pointer.press_origin())
        {
            memory.drag =
                near(at).map(|stop| Drag { stop, at: ramp.stops()[stop], shown: view.shown });
            memory.selected = near(at).or(memory.selected);
        }
        if response.drag_stopped() || !response.dragged() && !response.drag_started() {
            memory.drag = None;
        }
        if let Some(drag) = memory.drag.as_mut().filter(|_| response.dragged()) {
            let (delta, modifiers) = (moved(response), ui.input(|input| input.modifiers));
            let fine = if modifiers.ctrl || modifiers.command { 0.1 } else { 1.0 };
            let size = view.rect.size();
            if !modifiers.shift {
                drag.at.0 += delta.x / size.x * fine;
            }
            drag.at.1 -= delta.y / size.y * (view.shown.1 - view.shown.0) * fine;
            return Some((stops::put(ramp, drag.stop, drag.at, limits), How::Drag));
        }
        if response.double_clicked()
            && let Some(at) = response.interact_pointer_pos()
        {
            if near(at).is_some() {
                return None;
            }
            let (x, y) = view.place(at);
            let (new, stop) = stops::add(ramp, x, Some(y), limits);
            memory.selected = Some(stop);
            return Some((new, How::Once));
        }
        if response.clicked()
            && let Some(at) = response.interact_pointer_pos()
        {
            memory.selected = near(at);
        }
        if !response.has_focus() {
            return None;
        }
        if let Some(new) = self.pasted(ui, ramp) {
            return Some((new, How::Once));
        }
        let i = memory.selected?;
        let pressed =
            |key| ui.input_mut(|input| input.consume_key(Modifiers::NONE, key)) as i32 as f32;
        if pressed(Key::Delete) + pressed(Key::Backspace) > 0.0 {
            memory.selected = None;
            return Some((stops::remove(ramp, i), How::Once));
        }
        let (x, y) = ramp.stops()[i];
        let right = pressed(Key::ArrowRight) - pressed(Key::ArrowLeft);
        let up = pressed(Key::ArrowUp) - pressed(Key::ArrowDown);
        if right == 0.0 && up == 0.0 {
            return None;
        }
        let step = self.scale.step(f64::from(y)) as f32;
        let new = stops::put(ramp, i, (x + right * 0.01, y + up * step), limits);
        Some((new, How::Nudge))
    }

    /// Copies the ramp as text, or gives what is pasted; for the plot that has the keyboard.
    fn pasted(&self, ui: &Ui, ramp: &Ramp) -> Option<Ramp> {
        let mut new = None;
        let mut copied = false;
        ui.input(|input| {
            for event in &input.events {
                match event {
                    egui::Event::Copy => copied = true,
                    egui::Event::Paste(text) => new = self.read(text),
                    _ => {}
                }
            }
        });
        if copied {
            ui.ctx().copy_text(write_value(&Value::from(ramp.clone())));
        }
        new
    }

    /// A ramp from text, within the limits.
    fn read(&self, text: &str) -> Option<Ramp> {
        let Ok(Value::Ramp(read)) = parse_value(Type::Ramp, text) else { return None };
        Some(stops::scale(&read, 1.0, self.limits()))
    }

    /// The line below the plot: how it blends, what it can begin with, the selected stop.
    fn tools(
        &self,
        ui: &mut Ui,
        id: Id,
        ramp: &Ramp,
        width: f32,
        memory: &mut Memory,
    ) -> Option<(Ramp, How)> {
        let mut new = None;
        let limits = self.limits();
        ui.horizontal(|ui| {
            ui.spacing_mut().item_spacing.x = 3.0;
            let blend = ComboBox::from_id_salt(id.with("blend"))
                .width(60.0)
                .selected_text(blend_name(ramp.blend))
                .show_ui(ui, |ui| {
                    for (blend, tip) in [
                        (Blend::Linear, "Linear between points."),
                        (Blend::Smooth, "Smooth, flat at every point."),
                        (Blend::Step, "Constant up to the next point."),
                    ] {
                        let chosen = ui.selectable_label(ramp.blend == blend, blend_name(blend));
                        if chosen.on_hover_text(tip).clicked() {
                            new = Some((stops::blended(ramp, blend), How::Once));
                        }
                    }
                });
            set_name(ui, &blend.response, &format!("{} blending", self.name));
            let menu = ui.menu_button("…", |ui| {
                new = panel::list(ui, |ui| self.menu(ui, id, ramp)).or(new.take());
            });
            set_name(ui, &menu.response, &format!("{} shape", self.name));
            menu.response.on_hover_text("Presets, flip, scale, copy and paste.");
            let name = format!("{}: add a point", self.name);
            if icon_button(ui, "+", &name).clicked() {
                let (more, at) = stops::add(ramp, 0.5, None, limits);
                memory.selected = Some(at);
                new = Some((more, How::Once));
            }
            if let Some(i) = memory.selected {
                let name = format!("{}: remove the point", self.name);
                if icon_button(ui, "✖", &name).clicked() {
                    new = Some((stops::remove(ramp, i), How::Once));
                    memory.selected = None;
                }
            }
        });
        if let Some(i) = memory.selected
            && let Some(at) = ramp.stops().get(i)
        {
            ui.horizontal(|ui| {
                ui.spacing_mut().item_spacing.x = 3.0;
                new = self.numbers(ui, ramp, i, *at, (width - 3.0) / 2.0).or(new.take());
            });
        }
        new
    }

    fn numbers(
        &self,
        ui: &mut Ui,
        ramp: &Ramp,
        i: usize,
        (x, y): (f32, f32),
        width: f32,
    ) -> Option<(Ramp, How)> {
        let along = Scale::new(coif_nodes::define::Unit::Ratio, Some((0.0, 1.0)), None, false);
        let mut put = None;
        for (name, value, scale, is_x) in
            [("position", x, &along, true), ("value", y, self.scale, false)]
        {
            let name = format!("{} {name}", self.name);
            let value = f64::from(value);
            let field =
                NumberField { name: &name, value: Some(value), instead: None, unset: None, scale };
            let (response, done) = field.show(ui, width);
            response.on_hover_text(match is_x {
                true => "Position of the point, from root (0 %) to tip (100 %).",
                false => "Value of the point.",
            });
            let (to, how) = match done {
                Some(Done::Dragged(to)) => (to, How::Drag),
                Some(Done::Typed(entry)) => (entry.apply(value), How::Once),
                Some(Done::Nudged(by)) => (value + by, How::Nudge),
                _ => continue,
            };
            let to = to as f32;
            put = Some((if is_x { (to, y) } else { (x, to) }, how));
        }
        put.map(|(at, how)| (stops::put(ramp, i, at, self.limits()), how))
    }

    fn menu(&self, ui: &mut Ui, id: Id, ramp: &Ramp) -> Option<(Ramp, How)> {
        let mut new = None;
        let limits = self.limits();
        ui.set_min_width(190.0);
        for preset in stops::PRESETS {
            if ui.button(preset.0).clicked() {
                new = Some(stops::preset(ramp, *preset, limits));
            }
        }
        ui.separator();
        for (label, tip, made) in [
            ("Flip", "Mirror the ramp: root and tip swap.", stops::flip(ramp)),
            ("Half as strong", "Multiply all values by 0.5.", stops::scale(ramp, 0.5, limits)),
            ("Twice as strong", "Multiply all values by 2.", stops::scale(ramp, 2.0, limits)),
        ] {
            if ui.button(label).on_hover_text(tip).clicked() {
                new = Some(made);
            }
        }
        ui.separator();
        if ui.button("Copy as text").clicked() {
            ui.ctx().copy_text(write_value(&Value::from(ramp.clone())));
        }
        // A line that holds the ramp as files write it: paste another over it.
        let line = id.with("text");
        let mut text: String = ui
            .data(|data| data.get_temp(line))
            .unwrap_or_else(|| write_value(&Value::from(ramp.clone())));
        let edit = ui.add(TextEdit::singleline(&mut text).desired_width(180.0));
        set_name(ui, &edit, &format!("{} as text", self.name));
        let edit = edit.on_hover_text("Paste a ramp here and press Enter.");
        if edit.has_focus() {
            ui.data_mut(|data| data.insert_temp(line, text));
        } else if edit.lost_focus() {
            ui.data_mut(|data| data.remove::<String>(line));
            new = self.read(&text).or(new);
        }
        if new.is_some() {
            ui.close();
        }
        new.map(|new| (new, How::Once))
    }
}

/// The part of the frame in which values are drawn; below it stands which end is which.
pub(crate) fn plotted(frame: Rect) -> Rect {
    let inner = frame.shrink2(vec2(9.0, 8.0));
    inner.with_max_y((frame.bottom() - 18.0).max(inner.top() + 1.0))
}

fn blend_name(blend: Blend) -> &'static str {
    match blend {
        Blend::Step => "Constant",
        Blend::Linear => "Linear",
        Blend::Smooth => "Smooth",
    }
}

/// Where values lie on the screen.
struct View {
    rect: Rect,
    shown: (f32, f32),
}

impl View {
    fn pos(&self, (x, y): (f32, f32)) -> Pos2 {
        let (lo, hi) = self.shown;
        pos2(
            egui::lerp(self.rect.x_range(), x),
            egui::lerp(self.rect.bottom()..=self.rect.top(), (y - lo) / (hi - lo)),
        )
    }

    fn place(&self, at: Pos2) -> (f32, f32) {
        let (lo, hi) = self.shown;
        let x = (at.x - self.rect.left()) / self.rect.width().max(1.0);
        let y = (self.rect.bottom() - at.y) / self.rect.height().max(1.0);
        (x.clamp(0.0, 1.0), lo + (hi - lo) * y.clamp(0.0, 1.0))
    }

    fn nearest(&self, ramp: &Ramp, at: Pos2) -> Option<usize> {
        let far = |i: usize| self.pos(ramp.stops()[i]).distance(at);
        let nearest = (0..ramp.stops().len()).min_by(|a, b| far(*a).total_cmp(&far(*b)))?;
        (far(nearest) <= REACH).then_some(nearest)
    }

    fn paint(
        &self,
        ui: &Ui,
        response: &Response,
        ramp: &Ramp,
        scale: &Scale,
        selected: Option<usize>,
    ) {
        let painter = ui.painter_at(response.rect);
        let line = if response.has_focus() { theme::ACCENT.of(ui) } else { theme::LINE.of(ui) };
        let frame = response.rect;
        painter.rect(frame, 3, theme::SUNKEN.of(ui), Stroke::new(1.0, line), StrokeKind::Inside);
        let grid = Stroke::new(1.0, theme::STRIPE.of(ui));
        for i in 0..=4 {
            let x = egui::lerp(self.rect.x_range(), i as f32 / 4.0);
            painter.vline(x, frame.y_range().shrink(1.0), grid);
        }
        painter.hline(frame.x_range().shrink(1.0), self.pos((0.0, 0.0)).y, grid);
        let mut points: Vec<Pos2> = vec![];
        if ramp.blend == Blend::Step {
            for (x, y) in ramp.stops() {
                if let Some(last) = points.last().map(|last| last.y) {
                    points.push(pos2(self.pos((*x, *y)).x, last));
                }
                points.push(self.pos((*x, *y)));
            }
        } else {
            let steps = (self.rect.width() / 3.0).clamp(8.0, 200.0) as usize;
            let even = (0..=steps).map(|i| i as f32 / steps as f32);
            let mut at: Vec<f32> = even.chain(ramp.stops().iter().map(|stop| stop.0)).collect();
            at.sort_by(f32::total_cmp);
            points.extend(at.into_iter().map(|x| self.pos((x, ramp.at(x)))));
        }
        // Outside of its stops a ramp holds its end values.
        let ends = [points.first().copied(), points.last().copied()];
        if let [Some(first), Some(last)] = ends {
            points.insert(0, pos2(self.rect.left(), first.y));
            points.push(pos2(self.rect.right(), last.y));
        }
        painter.add(Shape::line(points, Stroke::new(1.6, theme::ACCENT.of(ui))));
        let hovered = response.hover_pos().and_then(|at| self.nearest(ramp, at));
        for (i, stop) in ramp.stops().iter().enumerate() {
            let size = if hovered == Some(i) { 5.5 } else { 4.5 };
            let fill = if selected == Some(i) { theme::ACCENT.of(ui) } else { theme::PANEL.of(ui) };
            painter.circle(self.pos(*stop), size, fill, Stroke::new(1.5, theme::ACCENT.of(ui)));
        }
        let font = TextStyle::Small.resolve(ui.style());
        let corner = |x: f32, y: f32, align: Align2, text: String| {
            painter.text(pos2(x, y), align, text, font.clone(), theme::QUIET.of(ui));
        };
        let (left, right) = (frame.left() + 4.0, frame.right() - 4.0);
        corner(left, frame.bottom() - 2.0, Align2::LEFT_BOTTOM, "root".to_owned());
        corner(right, frame.bottom() - 2.0, Align2::RIGHT_BOTTOM, "tip".to_owned());
        let (lo, hi) = (f64::from(self.shown.0), f64::from(self.shown.1));
        corner(left, frame.top() + 2.0, Align2::LEFT_TOP, scale.text(hi));
        if lo != 0.0 {
            corner(frame.center().x, frame.bottom() - 2.0, Align2::CENTER_BOTTOM, scale.text(lo));
        }
    }
}
