//! The file that a panel writes: typed or browsed for, with a word on what is there already.
//!
//! Guarantee: the disk is looked at on a thread, so that a folder that hangs keeps nobody waiting.

use crate::widgets::text::set_name;
use crate::widgets::theme;
use egui::{Button, Label, RichText, TextEdit};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};

/// Room for the button beside the field, in points.
const BUTTON: f32 = 84.0;

/// A field for a file that is written.
#[derive(Default)]
pub(super) struct FileField {
    pub(super) typed: String,
    /// What was offered, until somebody typed something else.
    offered: String,
    /// What was looked at last, and whether it is there, once that is known.
    looked: Option<(PathBuf, Arc<Mutex<Option<bool>>>)>,
}

impl FileField {
    /// Offers a file, unless another was typed.
    pub(super) fn offer(&mut self, path: &Path) {
        if self.typed == self.offered {
            self.offered = path.display().to_string();
            self.typed.clone_from(&self.offered);
        }
    }

    /// The typed path; `None` if the field is empty.
    pub(super) fn path(&self) -> Option<PathBuf> {
        let typed = self.typed.trim();
        let path = (!typed.is_empty()).then(|| PathBuf::from(typed))?;
        Some(std::path::absolute(&path).unwrap_or(path))
    }

    /// Gives the file's name another ending, or one where it has none of those that are known.
    pub(super) fn end_in(&mut self, ending: &str, known: &[&str]) {
        let typed = self.typed.trim();
        let old = known.iter().find_map(|old| {
            let stem = typed.len().checked_sub(old.len() + 1)?;
            let is_it = typed.get(stem..)?.eq_ignore_ascii_case(&format!(".{old}"));
            is_it.then(|| &typed[..stem])
        });
        self.typed = format!("{}.{ending}", old.unwrap_or(typed).trim_end_matches('.'));
    }

    /// What is there is looked at again.
    pub(super) fn forget(&mut self) {
        self.looked = None;
    }

    /// Whether something is there, as far as that is known.
    fn is_there(&mut self, path: &Path, wake: &Arc<dyn Fn() + Send + Sync>) -> bool {
        if let Some((of, found)) = &self.looked {
            let found = *found.lock().unwrap_or_else(PoisonError::into_inner);
            // One look at a time, however fast somebody types.
            if of == path || found.is_none() {
                return of == path && found == Some(true);
            }
        }
        let found = Arc::default();
        self.looked = Some((path.to_owned(), Arc::clone(&found)));
        let (path, wake) = (path.to_owned(), wake.clone());
        // Without a thread nothing is said.
        let _ = std::thread::Builder::new().name("look".to_owned()).spawn(move || {
            *found.lock().unwrap_or_else(PoisonError::into_inner) = Some(path.exists());
            wake();
        });
        false
    }

    /// The field with its button. True where somebody wants to browse.
    pub(super) fn ui(&mut self, ui: &mut egui::Ui) -> bool {
        ui.horizontal(|ui| {
            let wide = (ui.available_width() - BUTTON).max(80.0);
            let field = TextEdit::singleline(&mut self.typed).desired_width(wide);
            let field = ui.add(field.hint_text("where to write it"));
            set_name(ui, &field, "File");
            ui.add(Button::new("Browse…")).on_hover_text("Choose folder and name").clicked()
        })
        .inner
    }

    /// A word where the file is there already. It stands beside the panel's buttons, where it moves nothing.
    pub(super) fn notice(&mut self, ui: &mut egui::Ui, wake: &Arc<dyn Fn() + Send + Sync>) {
        if let Some(path) = self.path()
            && self.is_there(&path, wake)
        {
            let text =
                RichText::new("replaces the file that is there").color(theme::WARNING.of(ui));
            ui.add(Label::new(text).truncate()).on_hover_text(path.display().to_string());
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_ending_takes_the_place_of_a_known_one_alone() {
        let check = |typed: &str, ended: &str| {
            let mut field = FileField { typed: typed.to_owned(), ..FileField::default() };
            field.end_in("abc", &["usdc", "abc", "hair"]);
            assert_eq!(field.typed, ended);
        };
        check("/a/hair.usdc", "/a/hair.abc");
        check("/a/hair.USDC", "/a/hair.abc");
        check("/a/v1.2", "/a/v1.2.abc");
        check("/a/hair.", "/a/hair.abc");
        check("/a/é", "/a/é.abc");
        check("hair", "hair.abc");
    }

    #[test]
    fn what_is_offered_gives_way_to_what_is_typed() {
        let mut field = FileField::default();
        field.offer(Path::new("/a/one.usdc"));
        field.offer(Path::new("/a/two.usdc"));
        assert_eq!(field.typed, "/a/two.usdc");
        field.typed = "/b/mine.abc".to_owned();
        field.offer(Path::new("/a/three.usdc"));
        assert_eq!(field.path(), Some("/b/mine.abc".into()));
    }
}
