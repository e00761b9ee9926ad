//! *Save a picture*: how large, how clean, from where, before what and in which light; one or a turntable.
//!
//! Each option is one of `coif render`; what is shown, and in which colours, is as in the viewport.

use super::export::Content;
use super::export_panel::{WIDE, WIDTH, rows};
use super::file_field::FileField;
use super::life::PRESENT;
use crate::core::documents::Purpose;
use crate::core::room::Room;
use crate::core::state::State;
use crate::editor::Editor;
use crate::jobs::render::files::with_number;
use crate::jobs::render::{LONGEST, MOST_FRAMES, MOST_SAMPLES, RenderRequest, Turns};
use crate::scene::lights::Lights;
use crate::widgets::text::{set_name, spoken};
use crate::widgets::{panel, theme};
use coif_nodes::define::Type;
use coif_shaders::camera::Viewpoint;
use egui::{Button, ComboBox, DragValue, Grid, Slider};
use std::path::Path;

/// The panel's name among windows.
pub(in crate::editor) const PANEL: &str = "save picture";

/// What is chosen in the panel. It stays for the next time.
pub(crate) struct PicturePanel {
    pub(in crate::editor) is_open: bool,
    pub(super) file: FileField,
    pub(super) size: [u32; 2],
    pub(super) samples: u32,
    /// In the words of `coif render --camera`.
    pub(super) camera: String,
    /// Degrees that the light is turned by, here and in the viewport: what is turned there is turned here.
    light: f32,
    shown_light: f32,
    transparent: bool,
    floor: bool,
    turntable: bool,
    pub(super) frames: u32,
    turns: Turns,
}

impl Default for PicturePanel {
    fn default() -> Self {
        Self {
            is_open: false,
            file: FileField::default(),
            size: [1920, 1080],
            samples: 64,
            camera: PRESENT.to_owned(),
            light: 0.0,
            shown_light: 0.0,
            transparent: false,
            floor: true,
            turntable: false,
            frames: 48,
            turns: Turns::Camera,
        }
    }
}

/// Sizes that are often wanted.
const SIZES: [(&str, [u32; 2]); 6] = [
    ("HD", [1280, 720]),
    ("Full HD", [1920, 1080]),
    ("4K", [3840, 2160]),
    ("Square", [1080, 1080]),
    ("Large square", [2048, 2048]),
    ("Upright", [1080, 1920]),
];

/// Samples in a pixel, and what they are good for.
const SAMPLES: [(u32, &str, &str); 3] = [
    (16, "Draft", "16 samples: grainy, for trying out"),
    (64, "Still", "64 samples: clean"),
    (256, "Poster", "256 samples: clean also in close-ups, four times as long"),
];

impl PicturePanel {
    /// Forgets what was meant for another document.
    pub(super) fn forget(&mut self) {
        self.file = FileField::default();
        PRESENT.clone_into(&mut self.camera);
    }

    fn ending(&self) -> String {
        crate::files::extension_of(Path::new(self.file.typed.trim()))
    }

    fn end_in(&mut self, ending: &str) {
        self.file.end_in(ending, Purpose::Picture.endings().1);
    }

    /// Gives the file's name a place for numbers, or takes it away, as the series wants it.
    fn name_series(&mut self) {
        let named = with_number(Path::new(self.file.typed.trim()), self.turntable);
        self.file.typed = named.display().to_string();
    }

    /// What is drawn, of what the viewport shows.
    fn request(&self, shown: RenderRequest) -> RenderRequest {
        RenderRequest {
            size: self.size,
            samples: self.samples,
            cameras: vec![self.camera.clone()],
            lights: Lights { turn: self.light, ..shown.lights },
            transparent: self.transparent,
            floor: self.floor,
            frames: if self.turntable { self.frames } else { 1 },
            turns: self.turns,
            ..shown
        }
    }
}

impl Editor {
    /// Opens the panel, with a file beside the groom offered, in the light of the viewport.
    pub(super) fn open_picture_panel(&mut self) {
        let offered = self.offered_file(Purpose::Picture);
        let light = self.viewport.options.turn;
        let panel = &mut self.documents.picture_panel;
        if let Some(path) = offered {
            panel.file.offer(&with_number(&path, panel.turntable));
        }
        panel.file.forget();
        (panel.is_open, panel.light, panel.shown_light) = (true, light, light);
    }

    /// The panel, where it is open.
    pub(super) fn picture_panel(&mut self, ctx: &egui::Context) {
        let mut asked = std::mem::take(&mut self.documents.picture_panel);
        if !asked.is_open {
            self.documents.picture_panel = asked;
            return;
        }
        let shown_light = self.viewport.options.turn;
        if asked.shown_light != shown_light {
            (asked.light, asked.shown_light) = (shown_light, shown_light);
        }
        let (mut open, mut close, mut browse, mut save, mut cancel) =
            (true, false, false, None, None);
        let shown = self.place_of(Room::Viewport).map(|rect| rect.size() * ctx.pixels_per_point());
        let place = panel::beside(panel::room(ctx), self.place_of(Room::Viewport), WIDE..=WIDE);
        let window = panel::window("Save a picture", PANEL, ctx).default_pos(place.min);
        window.open(&mut open).collapsible(false).show(ctx, |ui| {
            panel::body(ui, WIDTH, |ui| {
                ui.set_width(WIDTH);
                let wake = self.documents.waker();
                Grid::new("save picture").num_columns(2).show(ui, |ui| {
                    ui.label("File");
                    browse = asked.file.ui(ui);
                    ui.end_row();
                    formats(ui, &mut asked);
                    size(ui, &mut asked, shown);
                    samples(ui, &mut asked);
                    camera(ui, &mut asked, &self.state);
                    light(ui, &mut asked);
                    series(ui, &mut asked);
                });
                let path = asked.file.path().ok_or("no file is named");
                let path = self.can_export().and(path);
                ui.add_space(6.0);
                ui.horizontal(|ui| {
                    let name = if asked.turntable { "Save pictures" } else { "Save picture" };
                    let button = ui.add_enabled(path.is_ok(), Button::new(name));
                    let why = path.as_ref().err().copied().unwrap_or_default();
                    let tip = "Draw it beside the window: you can go on editing";
                    let button = button.on_hover_text(tip).on_disabled_hover_text(why);
                    save = path.ok().filter(|_| button.clicked());
                    close = ui.button("Close").clicked();
                    asked.file.notice(ui, &wake);
                });
                cancel = rows(&self.documents.exports, ui);
            });
        });
        asked.is_open = open && !close;
        if let Some(path) = save {
            asked.file.typed = Purpose::Picture.complete(path).display().to_string();
            asked.name_series();
            if let Some(path) = asked.file.path() {
                let request = asked.request(self.viewport.options.picture());
                self.export(Content::Picture(request.into()), path);
            }
        }
        self.documents.picture_panel = asked;
        if browse {
            self.ask(Purpose::Picture, None);
        }
        if let Some(number) = cancel {
            self.documents.exports.cancel(number);
        }
    }

    /// A file was chosen for the panel, which asks for an ending of its own where none was chosen.
    pub(super) fn browsed_picture(&mut self, path: &Path) {
        let panel = &mut self.documents.picture_panel;
        let ending = panel.ending();
        let known = Purpose::Picture.endings().1;
        panel.file.typed = path.display().to_string();
        if !known.contains(&&*panel.ending()) {
            panel.end_in(if known.contains(&&*ending) { &ending } else { known[0] });
        }
        panel.name_series();
    }
}

fn formats(ui: &mut egui::Ui, asked: &mut PicturePanel) {
    ui.label("Format");
    ui.horizontal_wrapped(|ui| {
        let now = asked.ending();
        for (ending, tip) in [
            ("png", "For a display, with its tone mapping"),
            ("exr", "Scene-linear light, with coverage in the alpha channel, for compositing"),
        ] {
            let chosen = theme::choice(ui, now == ending, &format!(".{ending}"));
            if chosen.on_hover_text(tip).clicked() {
                asked.end_in(ending);
            }
        }
    });
    ui.end_row();
}

fn size(ui: &mut egui::Ui, asked: &mut PicturePanel, shown: Option<egui::Vec2>) {
    ui.label("Size");
    ui.horizontal(|ui| {
        let shown = shown.map(|size| {
            let side = |length: f32| (length.round() as u32).clamp(1, LONGEST);
            ("As the viewport", [side(size.x), side(size.y)])
        });
        let mut all = SIZES.into_iter().chain(shown);
        let name = all.find(|(_, size)| *size == asked.size).map_or("Own", |(name, _)| name);
        let combo = ComboBox::from_id_salt("picture size").selected_text(name);
        let combo = combo.show_ui(ui, |ui| {
            for (name, size) in SIZES.into_iter().chain(shown) {
                let label = format!("{name}: {} x {}", size[0], size[1]);
                ui.selectable_value(&mut asked.size, size, label);
            }
        });
        set_name(ui, &combo.response, "Size");
        let mut side = |at: usize, name: &str| {
            let value = DragValue::new(&mut asked.size[at]).range(1..=LONGEST).suffix(" px");
            let field = ui.add(value).on_hover_text(name);
            set_name(ui, &field, name);
        };
        side(0, "Width");
        side(1, "Height");
    });
    ui.end_row();
}

fn samples(ui: &mut egui::Ui, asked: &mut PicturePanel) {
    ui.label("Samples");
    ui.horizontal(|ui| {
        let field = ui.add(DragValue::new(&mut asked.samples).range(1..=MOST_SAMPLES));
        set_name(ui, &field, "Samples");
        for (samples, name, tip) in SAMPLES {
            let chosen = theme::choice(ui, asked.samples == samples, name);
            if chosen.on_hover_text(tip).clicked() {
                asked.samples = samples;
            }
        }
    });
    ui.end_row();
}

/// The view of the moment, those of any head, those that the groom has saved, and what the active node gives.
fn cameras(state: &State) -> Vec<(String, String)> {
    let of_heads = Viewpoint::NAMES.map(|name| (name.to_owned(), spoken(&name.replace('-', "_"))));
    let saved = state.document.views.keys().map(|name| (name.clone(), format!("“{name}”")));
    let close = state.active().filter(|id| {
        let def = state.document.def(id);
        def.is_some_and(|def| def.outputs.iter().any(|output| output.ty == Type::Curves))
    });
    let close =
        close.map(|id| (format!("close:{id}"), format!("Close to {}", state.document.name_of(id))));
    let present = (PRESENT.to_owned(), "This view".to_owned());
    [present].into_iter().chain(saved).chain(close).chain(of_heads).collect()
}

fn camera(ui: &mut egui::Ui, asked: &mut PicturePanel, state: &State) {
    ui.label("Camera");
    let all = cameras(state);
    let now = all.iter().find(|(word, _)| *word == asked.camera);
    let now = now.map_or(asked.camera.as_str(), |(_, label)| label);
    let combo = ComboBox::from_id_salt("picture camera").selected_text(now);
    let combo = combo.show_ui(ui, |ui| {
        for (word, label) in &all {
            ui.selectable_value(&mut asked.camera, word.clone(), label);
        }
    });
    set_name(ui, &combo.response, "Camera");
    combo.response.on_hover_text("Saved views, and close-ups of the active node, are listed too");
    ui.end_row();
}

fn light(ui: &mut egui::Ui, asked: &mut PicturePanel) {
    ui.label("Light");
    ui.spacing_mut().slider_width = 200.0;
    let turn = Slider::new(&mut asked.light, -180.0..=180.0).suffix("°").fixed_decimals(0);
    let turn = ui.add(turn).on_hover_text("How far the lights are turned about the head");
    set_name(ui, &turn, "Light");
    ui.end_row();
    ui.label("Background");
    ui.horizontal(|ui| {
        for (transparent, name, tip) in [
            (false, "Of the lights", "The backdrop that goes with the lights"),
            (true, "Transparent", "Nothing: coverage is in the alpha channel"),
        ] {
            let chosen = theme::choice(ui, asked.transparent == transparent, name);
            if chosen.on_hover_text(tip).clicked() {
                asked.transparent = transparent;
            }
        }
        ui.add_enabled(!asked.transparent, egui::Checkbox::new(&mut asked.floor, "Ground"))
            .on_hover_text("The ground under the head, with its shadow")
            .on_disabled_hover_text("It would hide what is to be transparent");
    });
    ui.end_row();
}

fn series(ui: &mut egui::Ui, asked: &mut PicturePanel) {
    ui.label("Turntable");
    ui.horizontal(|ui| {
        let tip = "Pictures all the way round; %04d in the file's name becomes their number";
        let ticked = ui.checkbox(&mut asked.turntable, "Frames").on_hover_text(tip);
        if ticked.changed() {
            asked.name_series();
        }
        let frames = DragValue::new(&mut asked.frames).range(2..=MOST_FRAMES);
        let frames = ui.add_enabled(asked.turntable, frames);
        set_name(ui, &frames, "Number of frames");
        ui.add_enabled_ui(asked.turntable, |ui| {
            for (turns, name, tip) in [
                (Turns::Camera, "Camera goes round", "The camera goes round the head"),
                (Turns::Light, "Light goes round", "The camera stays, the lights go round"),
            ] {
                let chosen = theme::choice(ui, asked.turns == turns, name);
                if chosen.on_hover_text(tip).clicked() {
                    asked.turns = turns;
                }
            }
        });
    });
    ui.end_row();
}
