//! The panel of settings: what is changed in it counts at once.

use super::actions;
use super::keys::Keys;
use crate::core::event::Event;
use crate::core::settings::{
    Evaluate, MOST_MINUTES, Navigation, SAMPLES, SAVE_MINUTES, SCALES, Settings, Theme,
};
use crate::widgets::panel;
use egui::{DragValue, Grid, Slider};

/// The settings as they are tried in their panel.
#[derive(Default)]
pub(crate) struct Panel {
    pub(crate) is_open: bool,
    /// A size that is still dragged: it would move the slider under the hand.
    scale: Option<f32>,
}

impl Panel {
    /// Shows it, when it is open.
    pub(crate) fn ui(
        &mut self,
        now: &Settings,
        keys: &Keys,
        ctx: &egui::Context,
        out: &mut Vec<Event>,
    ) {
        let mut open = self.is_open;
        let mut new = now.clone();
        panel::window("Settings", "settings", ctx)
            .open(&mut open)
            .resizable(false)
            .pivot(egui::Align2::CENTER_CENTER)
            .default_pos(panel::room(ctx).center())
            .show(ctx, |ui| {
                panel::body(ui, 420.0, |ui| {
                    Grid::new("settings").num_columns(2).spacing([16.0, 8.0]).show(ui, |ui| {
                        self.scale(&mut new, ui);
                        rows(&mut new, keys, ui, out);
                    });
                });
            });
        self.is_open = open;
        if new != *now {
            out.push(Event::Settings(Box::new(new.within_limits())));
        }
    }

    fn scale(&mut self, new: &mut Settings, ui: &mut egui::Ui) {
        let label = ui.label("Interface scale");
        ui.horizontal(|ui| {
            let mut percent = self.scale.unwrap_or(new.scale) * 100.0;
            let range = SCALES.start() * 100.0..=SCALES.end() * 100.0;
            let slider = Slider::new(&mut percent, range).step_by(5.0).suffix(" %");
            let slider = ui.add(slider).labelled_by(label.id);
            self.scale = slider.dragged().then_some(percent / 100.0);
            if (slider.changed() || slider.drag_stopped()) && !slider.dragged() {
                new.scale = percent / 100.0;
            }
            if ui.button("100 %").on_hover_text("The system's own scale").clicked() {
                new.scale = 1.0;
            }
        });
        ui.end_row();
    }
}

fn rows(new: &mut Settings, keys: &Keys, ui: &mut egui::Ui, out: &mut Vec<Event>) {
    ui.label("Theme");
    ui.horizontal(|ui| {
        for (theme, word) in [(Theme::Dark, "dark"), (Theme::Light, "light")] {
            let tip = "Colours of panels and text; the picture stays as it is";
            ui.selectable_value(&mut new.theme, theme, word).on_hover_text(tip);
        }
    });
    ui.end_row();
    ui.label("Contrast");
    ui.checkbox(&mut new.strong_contrast, "stronger")
        .on_hover_text("Text and lines stand out more");
    ui.end_row();
    ui.label("Targets");
    ui.checkbox(&mut new.pen_mode, "large, for a pen")
        .on_hover_text("Buttons and fields are 32 points high instead of 24");
    ui.end_row();
    ui.label("Evaluate");
    ui.horizontal(|ui| {
        for (mode, word, tip) in [
            (Evaluate::Live, "live", "At every change, also during a drag"),
            (Evaluate::OnRelease, "on release", "When a drag ends"),
            (Evaluate::ByKey, "by key", "When asked"),
        ] {
            ui.selectable_value(&mut new.evaluate, mode, word).on_hover_text(tip);
        }
    });
    ui.end_row();
    ui.label("While dragging");
    ui.checkbox(&mut new.final_while_dragging, "make all hair")
        .on_hover_text("Instead of a tenth of the strands. Slow grooms lag behind the pointer");
    ui.end_row();
    let label = ui.label("Samples of a still");
    let samples = DragValue::new(&mut new.samples).range(SAMPLES).speed(1.0);
    ui.add(samples)
        .labelled_by(label.id)
        .on_hover_text("Samples per pixel while nothing moves. More is smoother and slower");
    ui.end_row();
    ui.label("Turn the view");
    ui.horizontal(|ui| {
        for (navigation, word, tip) in [
            (
                Navigation::Maya,
                "Maya, Houdini",
                "Alt or Space with the left, middle and right button",
            ),
            (
                Navigation::Blender,
                "Blender",
                "The middle button, with Shift to move and Ctrl to zoom",
            ),
        ] {
            ui.selectable_value(&mut new.navigation, navigation, word).on_hover_text(tip);
        }
    });
    ui.end_row();
    ui.label("Horizon");
    ui.checkbox(&mut new.trackball, "turn freely, as a ball")
        .on_hover_text("Instead of keeping the horizon level");
    ui.end_row();
    ui.label("Save by itself");
    ui.horizontal(|ui| {
        let mut does = new.save_minutes > 0;
        let tip = "Saves a groom that has a file. Recovery after a crash works without it";
        if ui.checkbox(&mut does, "every").on_hover_text(tip).changed() {
            new.save_minutes = if does { SAVE_MINUTES } else { 0 };
        }
        if does {
            ui.add(DragValue::new(&mut new.save_minutes).range(1..=MOST_MINUTES).suffix(" min"));
        }
    });
    ui.end_row();
    ui.label("At the start");
    ui.checkbox(&mut new.welcome, "show the welcome panel");
    ui.end_row();
    ui.label("Keys");
    ui.horizontal(|ui| {
        if ui.button("Show the keys").on_hover_text("Keys of the focused room").clicked() {
            out.push(Event::Act("window.keys"));
        }
        if ui.button("Copy the table").on_hover_text(COPY_KEYS).clicked() {
            ui.ctx().copy_text(keys.as_table());
        }
    });
    ui.end_row();
    // The pen's room has settings of its own.
    if let Some(action) = actions::by_id("pen.settings") {
        ui.label("Pen");
        if ui.button(action.label).on_hover_text(action.tip).clicked() {
            out.push(Event::Act(action.id));
        }
        ui.end_row();
    }
}

const COPY_KEYS: &str = "Copies the table as text for keys.ron, beside the settings. Its lines override the built-in keys";
