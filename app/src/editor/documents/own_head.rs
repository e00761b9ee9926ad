//! One's own head: a mesh takes the place of the head, and a panel shows how it was understood until somebody accepts it.
//!
//! Everything that is tried is one step: each try takes the last one back and is made anew, for as long as nothing else
//! was done in between. What the head node finds (sphere, axes, units, hairline) is told in its own words.

use super::Framing;
use super::life::head_of;
use crate::core::documents::{DocumentEvent, HeadChoice, Placing};
use crate::core::event::Event;
use crate::core::notes::Note;
use crate::core::state::{Select, State};
use crate::editor::Editor;
use crate::widgets::panel;
use coif_graphs::document::edit::{Edit, between};
use coif_graphs::document::{NodeId, Setting, wiring};
use coif_nodes::data::scalp::Part;
use coif_nodes::define::Value;
use egui::{Button, DragValue, Grid, Rect, ScrollArea, Slider};
use std::path::{Path, PathBuf};

/// A head that was not accepted yet.
pub(crate) struct OwnHead {
    node: NodeId,
    path: String,
    placing: Placing,
    /// The parts of the mesh, once it was read.
    parts: Vec<Part>,
    /// How many steps were done when the last try was made.
    done: usize,
    /// The hair that was there goes.
    bald: bool,
}

/// How wide the panel is, in points.
const WIDTH: f32 = 440.0;
/// What its frame takes beside that.
const FRAME: f32 = 28.0;
/// Axes that a face may look along; those that may point up, and what they are called.
const AXES: [&str; 6] = ["+z", "-z", "+x", "-x", "+y", "-y"];
const UPS: [(&str, &str); 6] =
    [("", "y"), ("z", "z"), ("x", "x"), ("-y", "y down"), ("-z", "z down"), ("-x", "x down")];

impl Editor {
    /// A mesh is to become the head; over hair it is asked first whether that stays.
    pub(super) fn ask_mesh(&mut self, path: PathBuf) {
        match wiring::has_hair(&self.state.document, wiring::Hair::All) {
            true => self.documents.mesh = Some(path),
            false => self.try_mesh(&path, false),
        }
    }

    /// A mesh becomes the head: the active one, else the first; a document without gets one. `bald`: the hair that is there goes.
    pub(super) fn try_mesh(&mut self, path: &Path, bald: bool) {
        let state = &self.state;
        let node = head_of(&state.document, state.active())
            .unwrap_or_else(|| state.document.free_id("head"));
        let path = self.name_for(path);
        self.state.history.end(&self.state.document);
        let before = self.state.history.done();
        let placing = Placing::default();
        self.documents.head =
            Some(OwnHead { node: node.clone(), path, placing, parts: vec![], done: before, bald });
        if self.make(&Placing::default(), false) {
            self.documents.welcome.is_open = false;
            self.apply(Event::Select(Select::Nodes(vec![node])));
        } else {
            self.documents.head = None;
        }
    }

    /// Another way to understand the same mesh.
    pub(super) fn try_head(&mut self, placing: &Placing, drags: bool) {
        if self.documents.head.as_ref().is_some_and(|head| head.placing == *placing) {
            self.state.gesture = drags;
            return;
        }
        self.take_back();
        self.make(placing, drags);
    }

    pub(super) fn cancel_head(&mut self) {
        self.take_back();
        self.documents.head = None;
    }

    /// Takes the last try back, when nothing was done since.
    fn take_back(&mut self) {
        let Some(head) = &self.documents.head else { return };
        if head.done > 0 && head.done == self.state.history.done() && self.is_last(&head.node) {
            self.apply(Event::Undo);
        }
    }

    fn is_last(&self, node: &NodeId) -> bool {
        let history = &self.state.history;
        let last = history.done().checked_sub(1).and_then(|at| history.steps().nth(at));
        last.is_some_and(|step| step.words.starts_with(WORDS) && step.nodes().contains(node))
    }

    fn make(&mut self, placing: &Placing, drags: bool) -> bool {
        let Some(head) = &self.documents.head else { return false };
        let (node, path) = (head.node.clone(), head.path.clone());
        let bare = head.bald.then(|| wiring::without_hair(&self.state.document, wiring::Hair::All));
        let mut edits: Vec<Edit> =
            bare.iter().map(|bare| between(&self.state.document, bare)).collect();
        let document = bare.as_ref().unwrap_or(&self.state.document);
        if !document.nodes.contains_key(&node) {
            let fresh = document.fresh_node("head", &node).into();
            edits.push(Edit::AddNode { id: node.clone(), node: fresh, at: None });
        }
        edits.extend(as_edits(&node, &path, placing));
        // Masks and materials of another mesh say nothing of this one; a drawn hairline does.
        let set = |input: &str| document.node(node.as_str())?.inputs.get(input);
        if matches!(set("region"), Some(Setting::Known(Value::Text(by))) if matches!(&**by, "mask" | "material"))
        {
            edits.extend(
                ["region", "region_name"]
                    .map(|input| Edit::UnsetInput { node: node.clone(), input: input.to_owned() }),
            );
        }
        let name = Path::new(&path).file_name().unwrap_or_default().to_string_lossy();
        let before = self.state.changes;
        self.apply(Event::Begin(format!("{WORDS}{name}")));
        self.apply(Event::Edit(Edit::Several(edits)));
        self.apply(Event::End);
        let done = self.state.history.done();
        self.documents.frames = Some((self.state.revision, Framing::Face));
        if let Some(head) = &mut self.documents.head {
            head.placing = placing.clone();
            head.done = done;
        }
        self.state.gesture = drags;
        self.state.changes != before
    }
}

/// What the step is called, before the name of the file.
const WORDS: &str = "own head: ";

fn as_edits(node: &NodeId, path: &str, placing: &Placing) -> Vec<Edit> {
    let mut edits = vec![];
    let mut set = |input: &str, value: Option<Value>| {
        let (node, input) = (node.clone(), input.to_owned());
        edits.push(match value {
            Some(value) => Edit::SetInput { node, input, setting: Setting::Known(value) },
            None => Edit::UnsetInput { node, input },
        });
    };
    let text = |text: &str| Value::Text(text.into());
    let not_zero = |x: f32| (x != 0.0).then_some(Value::Float(x));
    set("mesh", Some(text(path)));
    set("turn", not_zero(placing.turn));
    set("forward", (!placing.forward.is_empty()).then(|| text(placing.forward)));
    set("up", (!placing.up.is_empty()).then(|| text(placing.up)));
    set("leave_out", (!placing.leave_out.is_empty()).then(|| text(&placing.leave_out.join(", "))));
    set("units", (placing.scale > 0.0).then(|| text("custom")));
    set("scale", (placing.scale > 0.0).then_some(Value::Float(placing.scale)));
    set("radius", not_zero(placing.radius));
    set("fit", placing.no_head.then(|| text("none")));
    set("centre", None);
    edits
}

/// The names and patterns of a list.
fn names(text: &str) -> Vec<String> {
    let all = text.split(',').map(|name| name.trim().to_owned());
    all.filter(|name| !name.is_empty()).collect()
}

/// Forgets a head that is gone, by undo or by hand, and notes the parts of one that was read.
pub(super) fn settle(editor: &mut Editor) {
    let document = &editor.state.document;
    let shown = editor.state.shown.as_ref();
    let read = shown.filter(|shown| shown.revision == editor.state.revision);
    if let (Some(head), Some(scalp)) = (&mut editor.documents.head, read.and_then(|s| s.scalp())) {
        head.parts = scalp.parts().to_vec();
    }
    // Parts are also left out by pointing at them.
    if let Some(head) = &mut editor.documents.head
        && let Some(node) = document.node(head.node.as_str())
    {
        head.placing.leave_out = match node.inputs.get("leave_out") {
            Some(Setting::Known(Value::Text(text))) => names(text),
            _ => vec![],
        };
    }
    let gone = editor.documents.head.as_ref().is_some_and(|head| {
        let node = document.node(head.node.as_str());
        let mesh = node.and_then(|node| node.inputs.get("mesh"));
        !matches!(mesh, Some(Setting::Known(Value::Text(path))) if **path == *head.path)
    });
    if gone {
        editor.documents.head = None;
    }
}

/// The panel: what was found, and what can be corrected.
pub(super) fn window(
    head: &OwnHead,
    state: &State,
    picture: Option<Rect>,
    ctx: &egui::Context,
    out: &mut Vec<Event>,
) {
    let mut placing = head.placing.clone();
    let (mut drags, mut choice) = (false, None);
    let place = panel::beside(panel::room(ctx), picture, WIDTH + FRAME..=WIDTH + FRAME);
    panel::window("Your head", "own head", ctx)
        .default_pos(place.min)
        .resizable(false)
        .collapsible(true)
        .show(ctx, |ui| {
            panel::body(ui, WIDTH, |ui| {
                ui.set_max_width(WIDTH);
                let name = Path::new(&head.path).file_name().unwrap_or_default().to_string_lossy();
                ui.label(format!("{name}: is this how it stands?"));
                // Above all that comes and goes, so that they stay where they are.
                ui.horizontal(|ui| {
                    if ui
                        .add(Button::new("Accept"))
                        .on_hover_text("Keep the head as it is")
                        .clicked()
                    {
                        choice = Some(HeadChoice::Accept);
                    }
                    if ui.button("Cancel").on_hover_text("Restore the previous head").clicked() {
                        choice = Some(HeadChoice::Cancel);
                    }
                });
                ui.separator();
                Grid::new("own head placing").num_columns(2).show(ui, |ui| {
                    ui.label("The face looks along");
                    ui.horizontal_wrapped(|ui| {
                        if ui
                            .selectable_label(placing.forward.is_empty(), "find the face")
                            .clicked()
                        {
                            placing.forward = "";
                        }
                        for axis in AXES.into_iter().filter(|axis| is_level(axis, placing.up)) {
                            if ui.selectable_label(placing.forward == axis, axis).clicked() {
                                placing.forward = axis;
                            }
                        }
                    });
                    ui.end_row();
                    ui.label("Up in the file");
                    ui.horizontal(|ui| {
                        for (up, name) in UPS {
                            if ui.selectable_label(placing.up == up, name).clicked() {
                                placing.up = up;
                                placing.forward = "";
                            }
                        }
                    });
                    ui.end_row();
                    ui.label("Turn");
                    ui.horizontal(|ui| {
                        for (by, name) in [(-90.0, "-90°"), (90.0, "+90°")] {
                            if ui.button(name).on_hover_text("Rotate about the up axis").clicked() {
                                placing.turn = wrapped(placing.turn + by);
                            }
                        }
                        let turn =
                            ui.add(Slider::new(&mut placing.turn, -180.0..=180.0).suffix("°"));
                        drags |= turn.dragged();
                    });
                    ui.end_row();
                    ui.label("Scale");
                    ui.horizontal(|ui| {
                        let mut found = placing.scale == 0.0;
                        if ui.checkbox(&mut found, "find").on_hover_text(FIND_SCALE).changed() {
                            placing.scale = if found { 0.0 } else { scale_now(head, state) };
                        }
                        if !found {
                            let speed = placing.scale * 0.01;
                            let field = DragValue::new(&mut placing.scale)
                                .range(1e-6..=1e6)
                                .speed(speed)
                                .custom_formatter(|x, _| crate::words::rounded(x))
                                .suffix(" cm a unit");
                            drags |= ui.add(field).dragged();
                        }
                    });
                    ui.end_row();
                    ui.label("Sphere");
                    ui.horizontal(|ui| {
                        let mut found = placing.radius == 0.0;
                        if ui.checkbox(&mut found, "find").on_hover_text(FIND_SPHERE).changed() {
                            placing.radius = if found { 0.0 } else { radius_now(state) };
                        }
                        if !found {
                            let field = DragValue::new(&mut placing.radius)
                                .range(0.1..=1000.0)
                                .speed(0.02)
                                .suffix(" cm");
                            drags |= ui.add(field).dragged();
                        }
                    });
                    ui.end_row();
                    ui.label("No human head");
                    ui.checkbox(&mut placing.no_head, "keep the file's own axes").on_hover_text(
                        "For animals and props: no cranium is fitted, and hair may grow everywhere",
                    );
                    ui.end_row();
                });
                if !head.parts.is_empty() {
                    ui.separator();
                    ui.label("Leave out what is no head");
                    leave_out(&head.parts, &mut placing, ui);
                }
                ui.separator();
                found(head, state, ui);
            })
        });
    if choice.is_none() && (placing != head.placing || drags != state.gesture) {
        choice = Some(HeadChoice::Try(placing, drags));
    }
    out.extend(choice.map(|choice| Event::Documents(DocumentEvent::Head(choice))));
}

/// A tick for each part of the mesh. What looks like hair stands first and says so; nothing is ticked by itself.
fn leave_out(parts: &[Part], placing: &mut Placing, ui: &mut egui::Ui) {
    ScrollArea::vertical().max_height(130.0).show(ui, |ui| {
        for part in parts.iter().filter(|part| part.is_listed) {
            let before = placing.leave_out.iter().position(|name| *name == part.pattern);
            let mut is_left_out = before.is_some();
            let short: String = part.name.chars().take(MOST_LETTERS).collect();
            ui.horizontal(|ui| {
                let tick = ui.checkbox(&mut is_left_out, short);
                if tick.on_hover_text(format!("{}: {LEAVE_OUT}", part.name)).changed() {
                    match before {
                        Some(at) => drop(placing.leave_out.remove(at)),
                        None => placing.leave_out.push(part.pattern.clone()),
                    }
                }
                if part.is_proposed {
                    ui.weak("hair, or worn?");
                }
            });
        }
    });
}

const LEAVE_OUT: &str =
    "leave it out: no hair grows on it, it is not skin, and the cranium is not fitted to it";
/// A longer name is told by hovering.
const MOST_LETTERS: usize = 32;

/// Whether a face may look along an axis with this one up.
fn is_level(axis: &str, up: &str) -> bool {
    let letter = |axis: &str| axis.chars().last().unwrap_or('y');
    letter(axis) != letter(up)
}

const FIND_SCALE: &str =
    "Use the units that the file states, or those that give the cranium a human size";
const FIND_SPHERE: &str = "Use the best-fitting sphere of the cranium";

fn wrapped(degrees: f32) -> f32 {
    if degrees > 180.0 {
        degrees - 360.0
    } else if degrees < -180.0 {
        degrees + 360.0
    } else {
        degrees
    }
}

fn scale_now(_: &OwnHead, state: &State) -> f32 {
    state.shown.as_ref().and_then(|shown| Some(shown.scalp()?.cm_per_unit())).unwrap_or(1.0)
}

fn radius_now(state: &State) -> f32 {
    state.shown.as_ref().and_then(|shown| Some(shown.scalp()?.frame().radius)).unwrap_or(9.0)
}

/// What the head node found, once it has run on this mesh.
fn found(head: &OwnHead, state: &State, ui: &mut egui::Ui) {
    let reports = &state.run.reports;
    if reports.revision != state.revision {
        ui.label("reading the mesh…");
        return;
    }
    let refused = reports.refused.iter().filter(|bad| bad.node == head.node.as_str());
    for bad in refused {
        Note::error(bad.reason.clone()).show(ui);
    }
    let report = reports.nodes.get(&head.node);
    if let Some(error) = report.and_then(|report| report.error.as_ref()) {
        Note::error(error.to_string()).show(ui);
    }
    if let Some(scalp) = state.shown.as_ref().and_then(|shown| shown.scalp()) {
        let (low, high) = scalp.surface().bounds();
        let size = high - low;
        ui.label(format!(
            "{:.1} x {:.1} x {:.1} cm, {} triangles, {} cm a unit",
            size.x,
            size.y,
            size.z,
            crate::words::grouped(scalp.surface().triangles.len()),
            crate::words::rounded(f64::from(scalp.cm_per_unit()))
        ));
    }
    for message in report.into_iter().flat_map(|report| &report.messages) {
        let note = match message.warning {
            true => Note::warning(message.to_string()),
            false => Note::done(message.to_string()),
        };
        note.show(ui);
    }
}
