//! What a person prefers, on this machine. Kept between sessions, never part of a groom.
//!
//! A file of an older version reads with defaults for what it lacks; what it holds beyond is ignored, and numbers that mean
//! nothing are brought to what does. What is changed in the panel counts at once.

use super::actions;
use super::event::Event;
use super::keys::Keys;
use super::panel;
use egui::{DragValue, Grid, Slider};
use serde::{Deserialize, Serialize};

/// Preferences. Every field has a default, so files may lack any of them.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Settings {
    /// When the graph is evaluated.
    pub evaluate: Evaluate,
    /// Whether all hair is made also while something is dragged.
    pub final_while_dragging: bool,
    /// Size of the interface, 0.75 to 2.5.
    pub scale: f32,
    /// Which mouse buttons and keys turn the view.
    pub navigation: Navigation,
    /// Whether the view turns as a ball, without keeping the horizon level.
    pub trackball: bool,
    /// Samples of a picture at rest.
    pub samples: u32,
    /// Larger targets, for pens: 32 points instead of 24.
    pub pen_mode: bool,
    /// How pens feel, and what the pen's tools do.
    pub pen: crate::pen::settings::Settings,
    /// Whether text and lines stand out more than the theme makes them.
    pub strong_contrast: bool,
    /// A document that has a file is saved by itself after so many minutes with changes; 0: never.
    pub save_minutes: u32,
    /// Whether the welcome panel opens with the window.
    pub welcome: bool,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            evaluate: Evaluate::Live,
            final_while_dragging: false,
            scale: 1.0,
            navigation: Navigation::Maya,
            trackball: false,
            samples: 32,
            pen_mode: false,
            pen: Default::default(),
            strong_contrast: false,
            save_minutes: 0,
            welcome: true,
        }
    }
}

/// Sizes that the interface can have.
const SCALES: std::ops::RangeInclusive<f32> = 0.75..=2.5;
/// Samples that a picture at rest may have.
const SAMPLES: std::ops::RangeInclusive<u32> = 1..=4096;
/// The longest time between two saves.
const MOST_MINUTES: u32 = 600;

impl Settings {
    /// The same with every number within what means something.
    pub fn within_limits(mut self) -> Self {
        if !self.scale.is_finite() {
            self.scale = 1.0;
        }
        self.scale = self.scale.clamp(*SCALES.start(), *SCALES.end());
        self.samples = self.samples.clamp(*SAMPLES.start(), *SAMPLES.end());
        self.save_minutes = self.save_minutes.min(MOST_MINUTES);
        self
    }
}

/// When the graph is evaluated.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Evaluate {
    /// At every change.
    Live,
    /// When a drag ends.
    OnRelease,
    /// When asked.
    ByKey,
}

/// Which mouse buttons and keys turn the view.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Navigation {
    /// As in Maya and Houdini: Alt or Space with left, middle and right.
    Maya,
    /// As in Blender: middle, with Shift and Ctrl.
    Blender,
}

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
            if ui.button("100 %").on_hover_text("The size that the system asks for").clicked() {
                new.scale = 1.0;
            }
        });
        ui.end_row();
    }
}

fn rows(new: &mut Settings, keys: &Keys, ui: &mut egui::Ui, out: &mut Vec<Event>) {
    ui.label("Contrast");
    ui.checkbox(&mut new.strong_contrast, "stronger").on_hover_text("Brighter text and lines");
    ui.end_row();
    ui.label("Targets");
    ui.checkbox(&mut new.pen_mode, "large, for a pen")
        .on_hover_text("What can be pressed is 32 points high instead of 24");
    ui.end_row();
    ui.label("Evaluate");
    ui.horizontal(|ui| {
        for (mode, word, tip) in [
            (Evaluate::Live, "live", "At every change, also while something is dragged"),
            (Evaluate::OnRelease, "on release", "When a drag ends"),
            (Evaluate::ByKey, "by key", "When asked"),
        ] {
            ui.selectable_value(&mut new.evaluate, mode, word).on_hover_text(tip);
        }
    });
    ui.end_row();
    ui.label("While dragging");
    ui.checkbox(&mut new.final_while_dragging, "make all hair")
        .on_hover_text("Instead of a tenth of the strands; slow grooms will lag behind the hand");
    ui.end_row();
    let label = ui.label("Samples of a still");
    let samples = DragValue::new(&mut new.samples).range(SAMPLES).speed(1.0);
    ui.add(samples).labelled_by(label.id).on_hover_text(
        "How often a pixel is drawn while nothing moves; more is smoother and takes longer",
    );
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
        let tip = "Writes a groom that has a file. Recovery after a crash needs none of this";
        if ui.checkbox(&mut does, "every").on_hover_text(tip).changed() {
            new.save_minutes = if does { 10 } else { 0 };
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
        if ui.button("Show the keys").on_hover_text("Of the room that keys are for").clicked() {
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

const COPY_KEYS: &str =
    "As text for a file keys.ron beside the settings, whose lines go before the program's own";

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn settings_come_back_lack_what_is_new_and_mean_something() {
        let set = Settings { scale: 1.25, trackball: true, ..Settings::default() };
        let text = ron::to_string(&set).unwrap();
        assert_eq!(ron::from_str::<Settings>(&text).unwrap(), set);
        let older: Settings = ron::from_str("(samples: 7, gone_since: [1, (2)])").unwrap();
        assert_eq!(older, Settings { samples: 7, ..Settings::default() });
        let wild: Settings =
            ron::from_str("(scale: inf, samples: 0, save_minutes: 4000000000)").unwrap();
        let tame = wild.within_limits();
        assert_eq!((tame.scale, tame.samples, tame.save_minutes), (1.0, 1, 600));
    }
}
