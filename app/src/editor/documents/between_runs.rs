//! What the editor keeps between runs: settings, layout, keys of one's own, recent files, recovery.

use super::dialogs::System;
use super::journal::{self, Journal};
use super::kept;
use super::recent::Recent;
use crate::core::event::Event;
use crate::core::notes::Note;
use crate::core::settings::Settings;
use crate::editor::{Editor, layout};
use crate::library;
use crate::places::Places;
use crate::widgets::theme;

impl Editor {
    /// Keeps what it keeps in these folders from now on, takes what was kept there, and offers what sessions left that did
    /// not end by themselves.
    pub fn keep_in(&mut self, ctx: &egui::Context, home: Places) {
        let mut told = vec![];
        let (settings, damage) = kept::load::<Settings>(&home.settings());
        self.state.settings = settings.within_limits();
        // It was meant for what was open then.
        self.state.settings.pen.symmetry = false;
        told.extend(damage);
        let (layout, damage) = kept::load_with(&home.layout(), |text| {
            layout::read_layout(text).ok_or_else(|| "is no layout".to_owned())
        });
        told.extend(damage);
        if let Some(layout) = layout {
            self.dock = layout;
        }
        match std::fs::read_to_string(home.keys()) {
            Ok(text) => told.extend(
                self.keys.add(&text).err().map(|why| format!("{}: {why}", home.keys().display())),
            ),
            Err(err) if err.kind() == std::io::ErrorKind::NotFound => {}
            Err(err) => told.push(format!("{}: {err}", home.keys().display())),
        }
        self.templates.folders = library::folders(&home)
            .into_iter()
            .enumerate()
            .map(|(n, folder)| (library::called(n, &folder), folder))
            .collect();
        let documents = &mut self.documents;
        let damage;
        (documents.recent, damage) = Recent::load(home.recent());
        told.extend(damage);
        let recovery = home.recovery();
        documents.leftovers = journal::leftovers(&recovery);
        match Journal::open(&recovery) {
            Ok(journal) => documents.journal = Some(journal),
            Err(err) => told.push(format!(
                "nothing can be recovered after a crash: {}: {err}",
                recovery.display()
            )),
        }
        let wake = documents.wake.clone();
        documents.dialogs.get_or_insert_with(|| Box::new(System::new(wake)));
        documents.settings = Some(self.state.settings.clone());
        documents.home = Some(home);
        told.into_iter().for_each(|text| self.state.apply(Event::Say(Note::warning(text))));
        if let Some(path) = self.state.file.path.clone()
            && let Err(why) = self.documents.recent.add(&path)
        {
            self.state.apply(Event::Say(Note::warning(why)));
        }
        show_settings(self, ctx);
    }

    /// Opens the welcome panel, unless somebody does not want it.
    pub fn greet(&mut self) {
        if self.state.settings.welcome {
            self.apply_to_file(super::DocumentEvent::Welcome(true));
        }
    }

    /// Writes settings and layout.
    pub(crate) fn store_settings(&mut self) {
        let Some(home) = &self.documents.home else { return };
        let stored = kept::store(&home.settings(), &self.state.settings)
            .and_then(|()| kept::store_text(&home.layout(), &layout::write_layout(&self.dock)));
        if let Err(why) = stored {
            self.state.apply(Event::Say(Note::warning(why)));
        }
    }

    /// Whether hair can be exported now, or why not.
    pub(crate) fn can_export(&self) -> Result<(), &'static str> {
        let mut nodes = self.state.document.nodes.values();
        match nodes.any(|node| node.kind == "groom_output") {
            false => Err("the graph has no groom output"),
            true => Ok(()),
        }
    }

    /// Whether an export goes on.
    pub(crate) fn exports(&self) -> Result<(), &'static str> {
        match self.documents.exports.going().is_empty() {
            true => Err("no export goes on"),
            false => Ok(()),
        }
    }
}

/// Settings that changed are shown and kept.
pub(super) fn heed_settings(editor: &mut Editor, ctx: &egui::Context) {
    let now = Some(&editor.state.settings);
    // While a slider is dragged nothing is written.
    if editor.documents.settings.as_ref() == now || ctx.input(|input| input.pointer.any_down()) {
        return;
    }
    editor.documents.settings = now.cloned();
    show_settings(editor, ctx);
    editor.store_settings();
}

fn show_settings(editor: &Editor, ctx: &egui::Context) {
    let settings = &editor.state.settings;
    theme::apply(ctx, settings.theme.of_egui(), settings.pen_mode);
    if settings.strong_contrast {
        theme::strengthen(ctx);
    }
    ctx.set_zoom_factor(settings.scale);
}
