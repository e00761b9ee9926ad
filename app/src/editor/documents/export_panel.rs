//! *Export hair*: what of the hair is written, where and how, with the exports that go on below.
//!
//! Each option is one of `coif eval` or `coif check`. The panel stays open, so that another file can be asked for at once.

use super::export::{Content, Ended, ExportRow, ExportState, Exports, HairChoice};
use super::file_field::FileField;
use crate::core::documents::Purpose;
use crate::core::room::Room;
use crate::editor::Editor;
use crate::files::extension_of;
use crate::jobs::evaluate::{OutputRequest, outputs};
use crate::widgets::text::{icon_button, set_name};
use crate::widgets::{panel, theme};
use coif_graphs::document::{Document, NodeId};
use coif_nodes::eval::Quality;
use coif_nodes::formats::export::Format;
use egui::{Align, Button, Checkbox, Grid, Label, Layout, ProgressBar, RichText, ScrollArea};
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

/// The panel's name among windows.
pub(in crate::editor) const PANEL: &str = "export hair";
/// How wide the panel is, in points.
pub(super) const WIDTH: f32 = 460.0;
/// The same with its frame.
pub(super) const WIDE: f32 = WIDTH + 28.0;
/// How high the list of exports is, whatever it holds, in points: a panel that grew would move its buttons.
const LIST: f32 = 108.0;

/// What is chosen in the panel. It stays for the next time.
#[derive(Default)]
pub(crate) struct ExportPanel {
    pub(in crate::editor) is_open: bool,
    pub(super) file: FileField,
    with_head: bool,
    for_unreal: bool,
    quality: Quality,
    /// Outputs that are not written.
    left_out: BTreeSet<NodeId>,
}

/// What a program wants.
struct Preset {
    name: &'static str,
    tip: &'static str,
    ending: &'static str,
    with_head: bool,
    for_unreal: bool,
}

const PRESETS: [Preset; 4] = [
    Preset {
        name: "Blender",
        tip: ".usdc: widths, colours and ids arrive as attributes",
        ending: "usdc",
        with_head: false,
        for_unreal: false,
    },
    Preset {
        name: "Houdini",
        tip: ".usdc with the head, whose triangles skinprim counts",
        ending: "usdc",
        with_head: true,
        for_unreal: false,
    },
    Preset {
        name: "Maya",
        tip: ".abc with the head",
        ending: "abc",
        with_head: true,
        for_unreal: false,
    },
    Preset {
        name: "Unreal",
        tip: ".abc without a head, checked against Unreal's limits",
        ending: "abc",
        with_head: false,
        for_unreal: true,
    },
];

/// What each format is for.
const FORMATS: [(&str, &str); 4] = [
    ("usdc", "USD, binary: Houdini, Blender, Maya, renderers"),
    ("usda", "USD as text: the same, to be read by people"),
    ("abc", "Alembic: Unreal, Maya"),
    ("hair", "Cem Yuksel's HAIR: renderers and research"),
];

impl ExportPanel {
    /// Forgets what was meant for another document.
    pub(super) fn forget(&mut self) {
        self.file = FileField::default();
        self.left_out.clear();
    }

    fn ending(&self) -> String {
        extension_of(Path::new(self.file.typed.trim()))
    }

    fn end_in(&mut self, ending: &str) {
        self.file.end_in(ending, Purpose::Export.endings().1);
    }

    /// Whether the format that is chosen holds heads.
    fn holds_heads(&self) -> bool {
        Format::of_extension(&self.ending()) != Some(Format::Hair)
    }

    fn is(&self, preset: &Preset) -> bool {
        let mine = (self.ending(), self.with_head, self.for_unreal);
        mine == (preset.ending.to_owned(), preset.with_head, preset.for_unreal)
    }

    fn take(&mut self, preset: &Preset) {
        (self.with_head, self.for_unreal) = (preset.with_head, preset.for_unreal);
        self.end_in(preset.ending);
    }

    /// What is asked for of a document's outputs, or why nothing can be.
    fn choice(&self, all: &[OutputRequest]) -> Result<HairChoice, &'static str> {
        let written = || all.iter().filter(|output| !self.left_out.contains(&output.socket.node));
        let outputs = match written().count() {
            0 => return Err("no output is ticked"),
            // As the command line has it where none is named.
            n if n == all.len() => vec![],
            _ => written().map(|output| output.socket.to_string()).collect(),
        };
        let (quality, for_unreal) = (self.quality, self.for_unreal);
        let with_head = self.with_head && self.holds_heads();
        Ok(HairChoice { outputs, quality, with_head, for_unreal })
    }
}

impl Editor {
    /// Opens the panel, with a file beside the groom offered.
    pub(super) fn open_export_panel(&mut self) {
        let offered = self.offered_file(Purpose::Export);
        let panel = &mut self.documents.export_panel;
        panel.is_open = true;
        offered.into_iter().for_each(|path| panel.file.offer(&path));
        panel.file.forget();
    }

    /// The panel, where it is open.
    pub(super) fn export_panel(&mut self, ctx: &egui::Context) {
        let mut asked = std::mem::take(&mut self.documents.export_panel);
        if !asked.is_open {
            self.documents.export_panel = asked;
            return;
        }
        let all = outputs(&self.state.document, &[]).unwrap_or_default();
        let (mut open, mut close, mut browse, mut export, mut cancel) =
            (true, false, false, None, None);
        let place = panel::beside(panel::room(ctx), self.place_of(Room::Viewport), WIDE..=WIDE);
        let window = panel::window("Export hair", PANEL, ctx).default_pos(place.min);
        window.open(&mut open).collapsible(false).show(ctx, |ui| {
            panel::body(ui, WIDTH, |ui| {
                ui.set_width(WIDTH);
                let wake = self.documents.waker();
                Grid::new("export hair").num_columns(2).show(ui, |ui| {
                    presets(ui, &mut asked);
                    ui.label("File");
                    browse = asked.file.ui(ui);
                    ui.end_row();
                    formats(ui, &mut asked);
                    which(ui, &mut asked, &all, &self.state.document);
                    options(ui, &mut asked);
                });
                let choice = asked.choice(&all).and_then(|choice| {
                    let path = asked.file.path().ok_or("no file is named")?;
                    Ok((choice, path))
                });
                let choice = self.can_export().and(choice);
                ui.add_space(6.0);
                ui.horizontal(|ui| {
                    let button = ui.add_enabled(choice.is_ok(), Button::new("Export"));
                    let why = choice.as_ref().err().copied().unwrap_or_default();
                    let tip = "Write it beside the window: you can go on editing";
                    let button = button.on_hover_text(tip).on_disabled_hover_text(why);
                    export = choice.ok().filter(|_| button.clicked());
                    close = ui.button("Close").clicked();
                    asked.file.notice(ui, &wake);
                });
                cancel = rows(&self.documents.exports, ui);
            });
        });
        asked.is_open = open && !close;
        if let Some((choice, path)) = export {
            let path = Purpose::Export.complete(path);
            asked.file.typed = path.display().to_string();
            self.export(Content::Hair(choice), path);
        }
        self.documents.export_panel = asked;
        if browse {
            self.ask(Purpose::Export, None);
        }
        if let Some(number) = cancel {
            self.documents.exports.cancel(number);
        }
    }

    /// A file was chosen for the panel, which asks for an ending of its own where none was chosen.
    pub(super) fn browsed_export(&mut self, path: PathBuf) {
        let panel = &mut self.documents.export_panel;
        let ending = panel.ending();
        panel.file.typed = path.display().to_string();
        if !FORMATS.iter().any(|(known, _)| *known == panel.ending()) {
            panel.end_in(if ending.is_empty() { FORMATS[0].0 } else { &ending });
        }
    }
}

fn presets(ui: &mut egui::Ui, asked: &mut ExportPanel) {
    ui.label("For").on_hover_text("The options that a program wants");
    ui.horizontal_wrapped(|ui| {
        for preset in &PRESETS {
            let chosen = theme::choice(ui, asked.is(preset), preset.name);
            if chosen.on_hover_text(preset.tip).clicked() {
                asked.take(preset);
            }
        }
    });
    ui.end_row();
}

fn formats(ui: &mut egui::Ui, asked: &mut ExportPanel) {
    ui.label("Format");
    ui.horizontal_wrapped(|ui| {
        let now = asked.ending();
        for (ending, tip) in FORMATS {
            let chosen = theme::choice(ui, now == ending, &format!(".{ending}"));
            if chosen.on_hover_text(tip).clicked() {
                asked.end_in(ending);
            }
        }
    });
    ui.end_row();
}

/// A tick for each output, guides among them.
fn which(ui: &mut egui::Ui, asked: &mut ExportPanel, all: &[OutputRequest], document: &Document) {
    if all.len() < 2 {
        asked.left_out.clear();
        return;
    }
    top_label(ui, "Outputs").on_hover_text("Groom outputs that are written, a group each");
    ui.vertical(|ui| {
        for output in all {
            let node = &output.socket.node;
            let guides = if output.guides { " (guides)" } else { "" };
            let mut ticked = !asked.left_out.contains(node);
            let name = format!("{}{guides}", output.group);
            let tip = format!("What {} gives, a group of the file", document.name_of(node));
            if ui.checkbox(&mut ticked, name).on_hover_text(tip).changed() {
                match ticked {
                    true => asked.left_out.remove(node),
                    false => asked.left_out.insert(node.clone()),
                };
            }
        }
    });
    ui.end_row();
}

fn options(ui: &mut egui::Ui, asked: &mut ExportPanel) {
    ui.label("Hair");
    ui.horizontal_wrapped(|ui| {
        for (quality, name, tip) in [
            (Quality::Final, "All", "Every strand"),
            (Quality::Preview, "A tenth", "The first tenth of the strands, to try things out"),
        ] {
            let chosen = theme::choice(ui, asked.quality == quality, name);
            if chosen.on_hover_text(tip).clicked() {
                asked.quality = quality;
            }
        }
    });
    ui.end_row();
    top_label(ui, "With it");
    ui.vertical(|ui| {
        let holds = asked.holds_heads();
        ui.add_enabled(holds, Checkbox::new(&mut asked.with_head, "The head's mesh"))
            .on_hover_text("For skinprim, and to see the hair on it. Not for Unreal")
            .on_disabled_hover_text(".hair holds no meshes");
        ui.checkbox(&mut asked.for_unreal, "Check for Unreal")
            .on_hover_text("Say what Unreal's importer would cut off or make up");
    });
    ui.end_row();
}

/// A label beside what has several lines.
fn top_label(ui: &mut egui::Ui, text: &str) -> egui::Response {
    ui.with_layout(Layout::top_down(Align::Min), |ui| {
        ui.add_space(3.0);
        ui.label(text)
    })
    .inner
}

/// The exports that go on, and the last that ended; gives the number of one that is to be stopped.
pub(super) fn rows(exports: &Exports, ui: &mut egui::Ui) -> Option<u64> {
    let going = exports.going();
    let mut cancel = None;
    ui.separator();
    ScrollArea::vertical().max_height(LIST).auto_shrink(false).show(ui, |ui| {
        if going.is_empty() && exports.told().next().is_none() {
            ui.label(RichText::new("Nothing is being written").weak());
        }
        for row in going.iter().chain(exports.told()) {
            if one(row, ui) {
                cancel = Some(row.number);
            }
        }
    });
    cancel
}

/// One export; whether it is to be stopped.
fn one(row: &ExportRow, ui: &mut egui::Ui) -> bool {
    let name = row.path.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let (text, colour, part) = match &row.state {
        ExportState::Waits => ("waits for its turn".to_owned(), theme::QUIET.of(ui), None),
        ExportState::Runs(doing, (done, of)) => {
            let part = if *of == 0 { 0.0 } else { *done as f32 / *of as f32 };
            (doing.clone(), theme::TEXT.of(ui), Some(part))
        }
        ExportState::Ended(Ended::Done(written)) => {
            let (ran, of) = written.ran;
            let ran = match ran {
                0 => "nothing evaluated again".to_owned(),
                ran => format!("{ran} of {of} nodes evaluated"),
            };
            (format!("{}; {ran}", written.made), theme::DONE.of(ui), None)
        }
        ExportState::Ended(Ended::Failed(lines)) => {
            // The file is named beside it.
            let named = format!("{}: ", row.path.display());
            (lines.join("; ").replace(&named, ""), theme::ERROR.of(ui), None)
        }
        ExportState::Ended(Ended::Stopped) => ("stopped".to_owned(), theme::QUIET.of(ui), None),
    };
    let mut stop = false;
    ui.horizontal(|ui| {
        if !matches!(row.state, ExportState::Ended(_)) {
            stop = icon_button(ui, "✖", &format!("Stop writing {name}")).clicked();
        }
        if let Some(part) = part {
            let bar = ui.add(ProgressBar::new(part).desired_width(72.0));
            set_name(ui, &bar, &format!("{name} so far"));
        }
        let label = ui.add(Label::new(&name).truncate());
        label.on_hover_text(row.path.display().to_string());
        ui.add(Label::new(RichText::new(&text).color(colour)).truncate()).on_hover_text(text);
    });
    stop
}
