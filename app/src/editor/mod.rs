//! The editor: rooms around one state.
//!
//! Each frame every room reads the [`State`] and says what happened; [`Editor::apply`] passes it on to whom it
//! concerns, and [`State::apply`] changes the state. The graph is evaluated and pictures are drawn on threads of their own, so
//! that the window never waits.
//!
//! Guarantees: the document changes only by edits that can be undone; what is selected, displayed or docked never changes a
//! groom's hash.

pub mod actions;
pub mod compare;
pub mod documents;
mod fonts;
pub mod keys;
pub mod layout;
mod menus;
mod paced;
mod palette;
mod settings;
mod templates;
#[cfg(test)]
pub(crate) mod tests;
mod toasts;
mod tour;
mod windows;

use crate::core::event::Event;
use crate::core::notes::Note;
use crate::core::room::Room;
use crate::core::settings::{Evaluate, Settings};
use crate::core::shown::{displayed, first_output};
use crate::core::state::{OpenFile, State};
use crate::jobs::evaluation::{Evaluation, EvaluationRequest, Finished};
use crate::places::Places;
use crate::rooms::canvas::Canvas;
use crate::rooms::history;
use crate::rooms::inspector::Inspector;
use crate::rooms::messages::Messages;
use crate::rooms::outliner::Outliner;
use crate::rooms::pen::Pen;
use crate::rooms::spreadsheet::Spreadsheet;
use crate::rooms::templates::{Templates, carried};
use crate::rooms::viewport::Viewport;
use crate::widgets::{panel, theme};
use coif_graphs::document::graph::upstream;
use coif_graphs::document::history::History;
use coif_graphs::document::{Document, Socket};
use coif_graphs::schedule::cache::usual_budget;
use coif_graphs::{file, grooms};
use coif_nodes::eval::Quality;
use compare::Compare;
use documents::Documents;
use egui_dock::{DockArea, DockState};
use keys::Keys;
use paced::Paced;
use palette::Palette;
use std::path::PathBuf;
use toasts::Toasts;
use tour::Tour;

/// Where all hair was made within this time, milliseconds, what is dragged is shown whole.
const QUICK_MS: f64 = 20.0;
/// A final evaluation that took longer (milliseconds) is led by a preview when something changes, as is one of which nothing is known;
/// the picture of one that did not begins anew once.
const SLOW_MS: f64 = 1000.0;

/// The editor.
pub struct Editor {
    /// What it knows.
    pub state: State,
    /// Documents as files.
    pub documents: Documents,
    messages: Messages,
    pub(crate) settings_panel: settings::Panel,
    pub(crate) keys: Keys,
    pub(crate) palette: Palette,
    pub(crate) key_sheet: bool,
    pub(crate) tour: Tour,
    pub(crate) canvas: Canvas,
    inspector: Inspector,
    spreadsheet: Spreadsheet,
    /// The groom on the screen.
    pub viewport: Viewport,
    pub(crate) outliner: Outliner,
    pub(crate) templates: Templates,
    /// The panel *Save as template*, where it is open.
    saving_template: Option<templates::save::SaveTemplate>,
    /// Another document beside this one.
    compare: Option<Compare>,
    /// The pen room: tools, and what they hold.
    pub pen: Pen,
    dock: DockState<Room>,
    toasts: Toasts,
    /// Where the rooms were drawn last.
    rooms: Vec<(Room, egui::Rect)>,
    /// A field had the keyboard when the last frame ended.
    types: bool,
    evaluation: Option<Evaluation>,
    /// What was asked of the evaluation last.
    asked: Option<Wanted>,
    /// Evaluate whatever the mode is.
    forced: bool,
    last_final_ms: f64,
    /// The first state of this document.
    born: u64,
    /// Bytes that documents hold, as of this number of changes.
    documents_bytes: (u64, usize),
}

/// What decides whether to evaluate again.
#[derive(Clone, PartialEq)]
struct Wanted {
    revision: u64,
    quality: Quality,
    also: Vec<Socket>,
    folder: PathBuf,
}

impl Editor {
    /// An editor on a document. The context is asked to repaint when something was evaluated.
    pub fn new(ctx: &egui::Context, document: Document, file: OpenFile) -> Self {
        let settings = Settings::default();
        theme::apply(ctx, settings.theme.of_egui(), settings.pen_mode);
        let mut state = State::new(document, file, settings, actions::named);
        let wake = {
            let ctx = ctx.clone();
            move || ctx.request_repaint()
        };
        let evaluation = Evaluation::start(usual_budget(), wake)
            .inspect_err(|why| {
                state.apply(Event::Say(Note::error(format!("nothing is evaluated: {why}"))))
            })
            .ok();
        let keys = Keys::shipped().unwrap_or_else(|why| {
            state.apply(Event::Say(Note::error(format!("keys.ron: {why}"))));
            Keys::default()
        });
        Self {
            state,
            documents: Documents::new(ctx),
            messages: Messages::default(),
            settings_panel: settings::Panel::default(),
            keys,
            palette: Palette::default(),
            key_sheet: false,
            tour: Tour::default(),
            canvas: Canvas::default(),
            inspector: Inspector::default(),
            spreadsheet: Spreadsheet::default(),
            viewport: Viewport::default(),
            outliner: Outliner::default(),
            templates: Templates::default(),
            saving_template: None,
            compare: None,
            pen: Pen::default(),
            dock: layout::first_layout(),
            toasts: Toasts::default(),
            rooms: vec![],
            types: false,
            evaluation,
            asked: None,
            forced: false,
            // Nothing is known yet: a preview comes first.
            last_final_ms: f64::INFINITY,
            born: 0,
            documents_bytes: (u64::MAX, 0),
        }
    }

    /// The start-up groom.
    pub fn start_up() -> (Document, OpenFile) {
        let text = grooms::by_name("start").unwrap_or_default();
        let document = file::read(text).map(|read| read.document).unwrap_or_default();
        (document, OpenFile::default())
    }

    /// Where a room was drawn last; none where its tab is covered.
    pub fn place_of(&self, room: Room) -> Option<egui::Rect> {
        self.rooms.iter().find(|(it, _)| *it == room).map(|(_, rect)| *rect)
    }

    /// Whether nothing is being evaluated and nothing waits to be.
    pub fn is_idle(&self) -> bool {
        self.evaluation.as_ref().is_none_or(Evaluation::is_idle)
            && self.asked.as_ref().is_some_and(|asked| *asked == self.wanted())
    }

    /// The step of the tour that is to be done, from 0, and how many there are; none off the tour.
    pub fn tour_step(&self) -> Option<(usize, usize)> {
        self.tour.progress()
    }

    /// One frame.
    pub fn ui(&mut self, ui: &mut egui::Ui) {
        let ctx = ui.ctx().clone();
        self.state.now = ctx.input(|input| input.time);
        documents::before(self, &ctx);
        if let Some(finished) = self.evaluation.as_ref().and_then(Evaluation::take) {
            self.finished(finished);
        }
        if let Some(evaluation) = &self.evaluation {
            if let Some(line) = evaluation.take_traced() {
                self.state.traced = line;
            }
            if let Some(made) = evaluation.take_made() {
                self.state.apply(Event::Made(Some(made.into())));
            }
            self.state.run = evaluation.status();
        }
        self.before_compare();
        self.follow_pointer(&ctx);
        let spent = self.closes_topmost(&ctx);
        if !self.palette.is_open() && !self.documents.takes_keys() {
            for action in self.keys.pressed(&ctx, self.state.focus, !spent) {
                self.act(action);
            }
        }
        if let Some(action) = palette::ui(self, &ctx) {
            self.act(action);
        }
        menus::bar(self, ui);
        menus::status(self, ui);
        panel::keep_room(&ctx, ui.available_rect_before_wrap());
        documents::panels(self, ui);
        let mut events = vec![];
        self.rooms.clear();
        let mut dock = std::mem::replace(&mut self.dock, DockState::new(vec![]));
        let (shares, held) = (layout::shares(&dock), layout::held_split(&dock, &ctx));
        let mut tabs = Tabs { editor: self, out: &mut events };
        egui::CentralPanel::default().frame(egui::Frame::NONE.fill(theme::GROUND.of(ui))).show(
            ui,
            |ui| {
                DockArea::new(&mut dock)
                    .style(dock_style(ui))
                    .show_leaf_close_all_buttons(false)
                    .show_leaf_collapse_buttons(false)
                    .show_inside(ui, &mut tabs);
            },
        );
        layout::keep_shares(&mut dock, &shares, held);
        self.dock = dock;
        self.settings_panel.ui(&self.state.settings, &self.keys, &ctx, &mut events);
        if self.key_sheet {
            menus::key_sheet(self, &ctx);
        }
        toasts::ui(self, &ctx);
        tour::ui(self, &ctx);
        for event in events {
            self.apply(event);
        }
        self.settle_templates(&ctx);
        let canvas = self.place_of(Room::Canvas);
        let at = ctx.pointer_latest_pos();
        carried(&ctx, canvas.zip(at).is_some_and(|(canvas, at)| canvas.contains(at)));
        documents::after(self, &ctx);
        self.shield(&ctx);
        self.types = ctx.text_edit_focused();
        self.make_room();
        self.evaluate();
        if self.state.run.since.is_some() {
            ctx.request_repaint_after(std::time::Duration::from_millis(100));
        }
    }

    /// Keys are for the room that the pointer moves over, or that something is dragged from. A pointer at rest leaves them
    /// where other keys led them.
    fn follow_pointer(&mut self, ctx: &egui::Context) {
        let told = |event: &egui::Event| {
            matches!(event, egui::Event::PointerMoved(_) | egui::Event::PointerButton { .. })
        };
        let at = ctx.input(|input| {
            let pointer = &input.pointer;
            let held = pointer.press_origin().filter(|_| pointer.any_down());
            let at = held.or(pointer.latest_pos());
            at.filter(|_| input.events.iter().any(told))
        });
        let Some(at) = at else { return };
        // What stands over the rooms is none of them.
        let over = ctx.layer_id_at(at).filter(|layer| layer.order > egui::Order::Background);
        if over.is_some_and(|layer| !Canvas::owns(layer.id)) {
            return;
        }
        if let Some((room, _)) = self.rooms.iter().find(|(_, rect)| rect.contains(at)) {
            self.state.apply(Event::Focus(*room));
        }
    }

    /// Does an action, or says why it cannot be done.
    pub fn act(&mut self, id: &str) {
        let Some(action) = actions::by_id(id) else { return };
        match action.when(self) {
            Ok(()) => action.run(self),
            Err(why) => {
                self.state.apply(Event::Say(Note::done(format!("{}: {why}", action.label))))
            }
        }
    }

    /// Changes the state by what happened, and lets rooms, files and evaluation have their part in it.
    pub fn apply(&mut self, event: Event) {
        match event {
            Event::Act(id) => self.act(id),
            Event::Trace(id) => {
                if let (Some(evaluation), Some(trace)) = (&self.evaluation, self.state.trace(id)) {
                    evaluation.trace(trace);
                }
            }
            Event::WhatMade(id) => {
                if let (Some(evaluation), Some(trace)) = (&self.evaluation, self.state.trace(id)) {
                    evaluation.what_made(trace);
                    self.apply(Event::Show(Room::Messages));
                }
            }
            Event::PickStroke(node, id) => {
                self.pen.pick(node, id, &self.state.selection.curves);
            }
            Event::TakeUpPen(node) => {
                self.pen.take_up(&self.state, &node);
                self.apply(Event::Pin(Some(node)));
            }
            Event::Evaluate => self.forced = true,
            Event::AllowLarge => {
                self.forced = true;
                self.state.apply(event);
            }
            // The hand is taken back first; what runs for it is stopped by what comes next.
            Event::Stop if self.state.gesture => self.apply(Event::Abort),
            Event::Stop => {
                if let Some(evaluation) = &self.evaluation {
                    evaluation.stop();
                }
            }
            Event::Templates(event) => self.apply_to_templates(event),
            Event::Documents(event) => self.apply_to_file(event),
            Event::Window(event) => self.apply_to_window(event),
            Event::Reveal => self.outliner.reveal(),
            Event::Show(room) => {
                layout::show(&mut self.dock, room);
                self.state.apply(event);
            }
            of_the_state => self.state.apply(of_the_state),
        }
    }

    /// What was of the document before goes with it: its hair, its picture, and symmetry, which was meant for it.
    pub(crate) fn forget_the_last(&mut self) {
        self.born = self.state.revision;
        self.state.shown = None;
        self.viewport.forget(self.born);
        self.canvas.forget();
        self.state.settings.pen.symmetry = false;
    }

    /// Another document takes the place of this one.
    pub(crate) fn replace(&mut self, document: Document, file: OpenFile, history: History) {
        self.end_compare();
        let state = &mut self.state;
        let new = State::new(document, file, state.settings.clone(), state.table);
        let old = std::mem::replace(state, new);
        state.history = history;
        state.revision = old.revision + 1;
        state.changes = old.changes + 1;
        state.shown = old.shown;
        (state.notes, state.focus, state.shelf) = (old.notes, old.focus, old.shelf);
        state.now = old.now;
        if let Some(evaluation) = &self.evaluation {
            evaluation.forget();
        }
        // Also where evaluation waits for a key, a new document is seen.
        self.asked = None;
        // Nothing is known of it: a preview comes first.
        self.last_final_ms = f64::INFINITY;
    }

    fn finished(&mut self, finished: Finished) {
        if let Some(shown) = finished.shown.filter(|shown| shown.revision >= self.born) {
            if shown.is_final() {
                self.last_final_ms = shown.ms;
            }
            self.state.shown = Some(shown.into());
        }
    }

    /// What the evaluation should be about now.
    fn wanted(&self) -> Wanted {
        let state = &self.state;
        let answered = state.run.reports.revision == state.revision;
        let slow = !answered && (self.last_final_ms > SLOW_MS || makes_unknown_hair(state));
        let drags = state.drags_hair() && self.last_final_ms > QUICK_MS;
        let preview = (drags || slow) && !state.settings.final_while_dragging;
        let nodes = [state.active(), state.pinned.as_ref()];
        let also = nodes.into_iter().flatten();
        Wanted {
            revision: state.revision,
            quality: if preview { Quality::Preview } else { Quality::Final },
            also: also
                .filter_map(|id| first_output(&state.document, id))
                .chain(self.viewport.wants(state))
                .chain(self.pen.wants(state))
                .collect(),
            folder: state.file.folder.clone(),
        }
    }

    /// Whether a different document or head is about to be shown. Turning a head by hand does not count.
    fn is_afresh(&self) -> bool {
        self.state.shown.is_none() || self.documents.is_framing() && !self.state.gesture
    }

    /// What evaluation keeps gives way to what pictures, documents and undo hold.
    fn make_room(&mut self) {
        let Some(evaluation) = &self.evaluation else { return };
        if self.documents_bytes.0 != self.state.changes {
            let held = self.state.document.bytes() + self.state.history.bytes();
            self.documents_bytes = (self.state.changes, held);
        }
        evaluation.make_room(self.viewport.bytes() + self.documents_bytes.1);
    }

    /// Asks for an evaluation where one is due.
    fn evaluate(&mut self) {
        let due = match self.state.settings.evaluate {
            Evaluate::Live => true,
            Evaluate::OnRelease => !self.state.gesture,
            Evaluate::ByKey => self.asked.is_none(),
        };
        let wanted = self.wanted();
        if !self.forced && (!due || self.asked.as_ref() == Some(&wanted)) {
            return;
        }
        self.forced = false;
        if let Some(evaluation) = &self.evaluation {
            evaluation.ask(EvaluationRequest {
                revision: wanted.revision,
                document: self.state.document.clone(),
                folder: wanted.folder.clone(),
                also: wanted.also.clone(),
                quality: wanted.quality,
                allow_large: self.state.allow_large,
                afresh: self.is_afresh(),
                unknown: makes_unknown_hair(&self.state),
                drags: self.state.gesture,
            });
        }
        self.asked = Some(wanted);
    }
}

/// Whether what is displayed needs a node that makes strands and has not run yet: nobody knows how long it takes.
fn makes_unknown_hair(state: &State) -> bool {
    let (document, known) = (&state.document, &state.run.reports.nodes);
    let sockets = displayed(document);
    let way = upstream(document, sockets.iter().map(|socket| &socket.node));
    let mut new = way.iter().filter(|id| !known.contains_key(*id));
    new.any(|id| document.def(id).is_some_and(|def| def.thins))
}

fn dock_style(ui: &egui::Ui) -> egui_dock::Style {
    let mut style = egui_dock::Style::from_egui(ui.style());
    style.tab_bar.bg_fill = theme::GROUND.of(ui);
    style.tab_bar.hline_color = theme::LINE.of(ui);
    style.main_surface_border_stroke = egui::Stroke::NONE;
    style.tab.tab_body.stroke = egui::Stroke::NONE;
    style.tab.tab_body.inner_margin = egui::Margin::same(4);
    style.tab.tab_body.bg_fill = theme::PANEL.of(ui);
    style
}

/// Shows the rooms in their tabs.
struct Tabs<'a> {
    editor: &'a mut Editor,
    out: &'a mut Vec<Event>,
}

impl egui_dock::TabViewer for Tabs<'_> {
    type Tab = Room;

    fn id(&mut self, room: &mut Room) -> egui::Id {
        egui::Id::new(("room", *room))
    }
    fn title(&mut self, room: &mut Room) -> egui::WidgetText {
        room.title().into()
    }
    fn ui(&mut self, ui: &mut egui::Ui, room: &mut Room) {
        self.editor.rooms.push((*room, ui.max_rect()));
        let Editor {
            state,
            viewport,
            pen,
            canvas,
            inspector,
            spreadsheet,
            outliner,
            messages,
            templates,
            compare,
            keys,
            ..
        } = &mut *self.editor;
        match room {
            Room::Viewport => {
                let name = |id: &str| keys.of(id).map(|keys| keys::name_of(&keys));
                pen.bar(state, &name, ui, self.out);
                let flipped = compare.as_ref().and_then(Compare::flipped);
                viewport.pen = pen.holds(ui.ctx(), flipped.is_some());
                viewport.compared = compare.as_ref().map(Compare::told);
                let mut said = vec![];
                let other = compare.as_ref().and_then(Compare::made);
                viewport.ui(state, other, ui, &mut said);
                // What is only looked at is not picked, drawn on, or edited.
                said.retain(|event| flipped.is_none() || compare::is_of_the_view(event));
                self.out.append(&mut said);
                let hovered = viewport.is_hovered() && flipped.is_none();
                let clip = ui.clip_rect();
                ui.set_clip_rect(clip.intersect(viewport.part()));
                pen.ui(state, &viewport.projection(), ui, hovered, self.out);
                ui.set_clip_rect(clip);
                pen.settings_window(state, ui.ctx(), self.out);
                pen.recipe_window(state, ui.ctx(), self.out);
            }
            Room::Canvas => match compare {
                Some(compare) => compare.ui(state, canvas, ui, self.out),
                None => canvas.ui(state, ui, self.out),
            },
            Room::Inspector => inspector.ui(state, ui, self.out),
            Room::Outliner => outliner.ui(state, ui, self.out),
            Room::Templates => templates.ui(state, ui, self.out),
            Room::Spreadsheet => spreadsheet.ui(state, ui, self.out),
            Room::Messages => messages.ui(state, ui, self.out),
            Room::History => history::ui(state, ui, self.out),
        }
    }
    fn scroll_bars(&self, _: &Room) -> [bool; 2] {
        [false, false]
    }
}

/// Opens the window on a groom, with another and its name beside it, and returns when it is closed. `greets`: with the welcome panel, unless somebody does not want
/// it.
///
/// # Errors
/// When there is no display or nothing can draw on it.
pub fn run(
    document: Document,
    file: OpenFile,
    other: Option<(Document, OpenFile, String)>,
    greets: bool,
) -> Result<(), String> {
    #[cfg_attr(
        not(target_os = "linux"),
        expect(unused_mut, reason = "only Linux has two kinds of display")
    )]
    let mut options = eframe::NativeOptions {
        viewport: egui::ViewportBuilder::default()
            .with_title("coif")
            .with_app_id("coif")
            .with_inner_size([1440.0, 900.0])
            .with_min_inner_size([640.0, 400.0])
            .with_drag_and_drop(true),
        renderer: eframe::Renderer::Wgpu,
        ..Default::default()
    };
    // Wayland itself tells winit 0.30 of no pen; through XWayland its pressure comes.
    #[cfg(target_os = "linux")]
    if ["WAYLAND_DISPLAY", "DISPLAY"]
        .iter()
        .all(|name| std::env::var_os(name).is_some_and(|v| !v.is_empty()))
        && crate::rooms::pen::has_pens()
    {
        options.event_loop_builder = Some(Box::new(|builder| {
            use winit::platform::x11::EventLoopBuilderExtX11 as _;
            builder.with_x11();
        }));
    }
    eframe::run_native(
        "coif",
        options,
        Box::new(move |cc| {
            fonts::load(&cc.egui_ctx);
            let mut editor = Editor::new(&cc.egui_ctx, document, file);
            editor.viewport.start(&cc.egui_ctx);
            editor.pen.devices.connect(cc, &cc.egui_ctx);
            editor.keep_in(&cc.egui_ctx, Places::here());
            if greets {
                editor.greet();
            }
            editor.tell_conflicts(&editor.state.file.name());
            if let Some((document, file, name)) = other {
                editor.compare_document(document, file, name);
            }
            Ok(Box::new(Window { editor, paced: Paced::default() }))
        }),
    )
    .map_err(|err| err.to_string())
}

/// The window around the editor.
struct Window {
    editor: Editor,
    paced: Paced,
}

impl eframe::App for Window {
    fn ui(&mut self, ui: &mut egui::Ui, _: &mut eframe::Frame) {
        self.editor.ui(ui);
    }

    fn raw_input_hook(&mut self, ctx: &egui::Context, input: &mut egui::RawInput) {
        if self.paced.frame(&mut input.events) {
            ctx.request_repaint();
        }
    }
}
