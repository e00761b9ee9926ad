//! What the documents' room does in every frame: answers and news are taken before the rooms are shown, its windows
//! and bars are shown among them, and what changed is handed to the journal and the watch behind them.

use super::dialogs::{Answer, MESHES};
use super::export::{Ended, ExportRow, ExportState};
use super::remedies::with_remedy;
use super::watch::Change;
use super::{
    Browser, DocumentEvent, Framing, bars, between_runs, browser, over_hair, own_head, welcome,
};
use crate::core::event::Event;
use crate::core::notes::Note;
use crate::core::room::Room;
use crate::core::state::State;
use crate::editor::Editor;
use crate::scene::lights::Surroundings;
use coif_graphs::schedule::files::named;
use egui::ViewportCommand;
use std::path::{Path, PathBuf};

/// Before the rooms are shown.
pub(crate) fn before(editor: &mut Editor, ctx: &egui::Context) {
    if ctx.input(|input| input.viewport().close_requested()) && !editor.documents.leaving {
        editor.apply_to_file(DocumentEvent::Close);
        if !editor.documents.leaving {
            ctx.send_viewport_cmd(ViewportCommand::CancelClose);
        }
    } else if editor.documents.leaving {
        ctx.send_viewport_cmd(ViewportCommand::Close);
    }
    let dropped: Vec<PathBuf> = ctx.input_mut(|input| {
        let files = std::mem::take(&mut input.raw.dropped_files);
        files.iter().map(|file| file.path().to_owned()).collect()
    });
    for path in dropped {
        drop_file(editor, &path);
    }
    let lost = |event: &egui::Event| *event == egui::Event::WindowFocused(false);
    if let Some(dialogs) = &mut editor.documents.dialogs
        && ctx.input(|input| input.events.iter().any(lost))
    {
        dialogs.lost_keyboard();
    }
    match editor.documents.dialogs.as_mut().and_then(|dialogs| dialogs.answer()) {
        Some(Answer::Chosen(path)) => editor.answered(Some(path)),
        Some(Answer::Nothing) => editor.answered(None),
        Some(Answer::NoDialog) => {
            editor.documents.no_dialogs = true;
            if let Some(asking) = &editor.documents.asking {
                editor.documents.browser =
                    Some(Browser::new(asking.question.clone(), editor.documents.wake.clone()));
            }
        }
        None => {}
    }
    for change in editor.documents.watch.changes() {
        changed(editor, &change);
    }
    for row in editor.documents.exports.take_ended() {
        tell_ended(editor, row);
    }
    let documents = &editor.documents;
    if documents.closes_after_export && !documents.leaving && !documents.exports.is_going() {
        editor.leave();
    }
}

/// Says what came of an export.
fn tell_ended(editor: &mut Editor, row: ExportRow) {
    editor.documents.export_panel.file.forget();
    editor.documents.picture_panel.file.forget();
    let ExportState::Ended(ended) = row.state else { return };
    let notes = match ended {
        Ended::Done(written) => {
            let warnings = written.warnings.iter().filter_map(|text| warned(&editor.state, text));
            let notes = written.notes.into_iter().chain([written.words]).map(Note::done);
            warnings.chain(notes).collect()
        }
        Ended::Failed(lines) => {
            let note = |line: &String| Note::error(with_remedy(line, "")).of_groom();
            lines.iter().map(note).collect()
        }
        Ended::Stopped => vec![Note::done("the export was stopped; nothing was written")],
    };
    notes.into_iter().for_each(|note: Note| editor.state.apply(Event::Say(note)));
}

/// A warning of an export, by the name that its node has on screen. None where that node says the same beside its inputs.
fn warned(state: &State, warning: &str) -> Option<Note> {
    let named = warning.split_once(": ").and_then(|(id, text)| {
        let (id, _) = state.document.nodes.get_key_value(id)?;
        Some((id, text))
    });
    let Some((id, text)) = named else { return Some(Note::warning(warning)) };
    let report = state.run.reports.nodes.get(id);
    let known = report.is_some_and(|report| {
        report.messages.iter().any(|message| message.to_string() == text || message.text == text)
    });
    let name = state.document.name_of(id);
    (!known).then(|| Note::warning(format!("{name}: {text}")).of(id.clone()))
}

/// A file dropped on the window: a groom is opened, a mesh becomes the head, a photographed sphere lights the picture.
fn drop_file(editor: &mut Editor, path: &Path) {
    let ending = path.extension().map(|e| e.to_string_lossy().to_lowercase()).unwrap_or_default();
    let event = match ending.as_str() {
        "ron" => DocumentEvent::Open(path.to_owned()),
        mesh if MESHES.contains(&mesh) || mesh.starts_with("usd") || mesh == "fbx" => {
            // What is not read is refused by the reader, which says what to do instead.
            DocumentEvent::Mesh(path.to_owned())
        }
        sphere if Surroundings::ENDINGS.contains(&sphere) => {
            return editor.viewport.surround(path, editor.documents.waker());
        }
        _ => {
            let text = format!(
                "{}: drop a groom (.ron), a mesh (.{}) or surroundings (.{})",
                path.display(),
                MESHES.join(", ."),
                Surroundings::ENDINGS.join(", ."),
            );
            return editor.state.apply(Event::Say(Note::warning(text)));
        }
    };
    editor.apply_to_file(event);
}

fn changed(editor: &mut Editor, change: &Change) {
    let (path, gone) = match change {
        Change::Content(path) => (path, false),
        Change::Gone(path) => (path, true),
    };
    let shown = path.display();
    if editor.state.file.path.as_ref() == Some(path) {
        if gone {
            editor.documents.changed = false;
            let text = format!("{shown} is not there any more; saving writes it again");
            editor.state.apply(Event::Say(Note::warning(text)));
        } else {
            editor.documents.changed = true;
        }
        return;
    }
    // A file that a node names: evaluation reads it again by itself once it is asked.
    editor.state.revision += 1;
    let text =
        if gone { "is not there any more" } else { "changed on the disk and was read again" };
    editor.state.apply(Event::Say(Note::done(format!("{shown} {text}"))));
}

/// Bars under the menu, and windows. What they say is applied at once.
pub(crate) fn panels(editor: &mut Editor, ui: &mut egui::Ui) {
    let ctx = ui.ctx().clone();
    let mut out = vec![];
    bars::show(&editor.documents, ui, &mut out);
    bars::unsaved(&editor.documents, &editor.state, &editor.title(), &ctx, &mut out);
    let documents = &mut editor.documents;
    let rooms = &editor.rooms;
    let picture = rooms.iter().find(|(room, _)| *room == Room::Viewport).map(|(_, rect)| *rect);
    // Where the rooms are is known from the first frame on.
    if !rooms.is_empty() {
        let (welcome, recent) = (&mut documents.welcome, &documents.recent);
        welcome::window(welcome, recent, &editor.state, picture, &ctx, &mut out);
    }
    bars::hovering(&ctx);
    if let Some(path) = documents.mesh.take()
        && over_hair::window(&path, &ctx, &mut out)
    {
        documents.mesh = Some(path);
    }
    if let Some(head) = &editor.documents.head {
        own_head::window(head, &editor.state, picture, &ctx, &mut out);
    }
    for event in out {
        editor.apply(event);
    }
    editor.export_panel(&ctx);
    editor.picture_panel(&ctx);
    let outcome = editor.documents.browser.as_mut().map(|browser| browser.ui(&ctx));
    match outcome {
        Some(browser::BrowserOutcome::Chosen(path)) => {
            editor.documents.browser = None;
            editor.answered(Some(path));
        }
        Some(browser::BrowserOutcome::Closed) => {
            editor.documents.browser = None;
            editor.answered(None);
        }
        Some(browser::BrowserOutcome::Open) | None => {}
    }
}

/// Behind the rooms: what changed becomes safe, and is looked at.
pub(crate) fn after(editor: &mut Editor, ctx: &egui::Context) {
    own_head::settle(editor);
    frame(editor);
    between_runs::heed_settings(editor, ctx);
    save_by_itself(editor, ctx);
    editor.tell_journal();
    let state = &editor.state;
    let watched = (state.changes, state.file.path.clone());
    if !state.gesture && editor.documents.watched.as_ref() != Some(&watched) {
        let folder = &state.file.folder;
        let mut files: Vec<PathBuf> =
            named(&state.document).into_iter().map(|(.., path)| folder.join(&*path)).collect();
        files.extend(state.file.path.clone());
        editor.documents.watch.files(files.iter().map(PathBuf::as_path));
        editor.documents.watched = Some(watched);
    }
    let mark = if state.history.is_changed() { "*" } else { "" };
    let title = format!("{}{mark} - coif", editor.title());
    if title != editor.documents.title {
        ctx.send_viewport_cmd(ViewportCommand::Title(title.clone()));
        editor.documents.title = title;
    }
}

/// Brings into view what is seen first, as soon as it is there.
fn frame(editor: &mut Editor) {
    let (Some((revision, framing)), Some(shown)) = (editor.documents.frames, &editor.state.shown)
    else {
        return;
    };
    if shown.revision < revision {
        return;
    }
    let (then, action) = match (framing, shown.head_alone) {
        (Framing::Face, _) => (None, "view.from_front"),
        (Framing::All, true) => (Some(Framing::Hair), "view.frame_head"),
        (Framing::Hair, true) => return,
        (_, false) => (None, "view.frame_all"),
    };
    editor.documents.frames = then.map(|framing| (revision, framing));
    editor.act(action);
}

/// Saves a document that has a file, when somebody wants that and it was not saved for so long.
fn save_by_itself(editor: &mut Editor, ctx: &egui::Context) {
    let minutes = editor.state.settings.save_minutes;
    let Some(path) = editor.state.file.path.clone() else { return };
    let waits = editor.state.gesture || editor.documents.changed;
    if !editor.state.history.is_changed() {
        editor.documents.saved_at = editor.state.now;
    } else if minutes > 0 && !waits {
        let left = f64::from(minutes) * 60.0 - (editor.state.now - editor.documents.saved_at);
        if left > 0.0 {
            return ctx.request_repaint_after(std::time::Duration::from_secs_f64(left));
        }
        // Tried again after as long, when it fails.
        editor.documents.saved_at = editor.state.now;
        editor.save_to(&path);
    }
}
