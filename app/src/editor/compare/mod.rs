//! Two documents side by side: one's own, and another that is only looked at.
//!
//! What differs is told in the words of `coif diff`, and marked on both canvases; the hair of either is shown in the viewport, with
//! one camera and one light. Guarantees: the other document never changes, nothing of it enters undo or a file; it is evaluated by
//! the same evaluator when that has nothing else to do, and what both share is made once. It is the file as it was when it was
//! chosen: later changes of it are not followed.

#[cfg(test)]
mod tests;
mod ui;

use super::Editor;
use super::documents;
use crate::core::event::Event;
use crate::core::notes::Note;
use crate::core::room::Room;
use crate::core::shown::Sides;
use crate::core::state::{OpenFile, State};
use crate::jobs::evaluation::EvaluationRequest;
use crate::rooms::canvas::{Canvas, DiffMarks, marks};
use coif_graphs::compare::{ChangeLine, change_lines, diff, is_same_hair};
use coif_graphs::document::{Document, NodeId};
use coif_nodes::eval::Quality;
use std::path::Path;
use std::sync::Arc;

/// States of other documents have numbers that one's own never reach.
const FIRST_REVISION: u64 = 1 << 48;

/// Another document, beside one's own.
pub struct Compare {
    /// What it is called.
    name: String,
    /// As it was read.
    document: Document,
    /// Whether it is what one's own was before: then one's own is the later.
    is_before: bool,
    /// What rooms read of it.
    other: State,
    canvas: Canvas,
    /// How the viewport shows the hair of both.
    sides: Sides,
    /// Whether it was evaluated, with or without hair.
    answered: bool,
    /// What differs, as of this number of changes of one's own.
    of: Option<u64>,
    lines: Vec<ChangeLine>,
    /// Of one's own, and of the other.
    marks: [Arc<DiffMarks>; 2],
    /// Nothing that makes hair differs.
    same_hair: bool,
    /// The node that is brought into sight.
    frames: Option<NodeId>,
    /// Whether everything was brought into sight once.
    is_fitted: bool,
    /// The group that one's own canvas showed last.
    group: Option<NodeId>,
}

impl Compare {
    fn new(document: Document, file: OpenFile, name: String, mine: &State) -> Self {
        let mut other = State::new(document.clone(), file, mine.settings.clone(), mine.table);
        other.revision = FIRST_REVISION + mine.revision;
        Self {
            name,
            document,
            is_before: false,
            other,
            canvas: Canvas::to_look_at(),
            sides: Sides::default(),
            answered: false,
            of: None,
            lines: vec![],
            marks: Default::default(),
            same_hair: false,
            frames: None,
            is_fitted: false,
            group: None,
        }
    }

    /// How the viewport is to show the hair of both.
    pub fn sides(&self) -> Sides {
        self.sides
    }

    /// The other state, where its hair is made.
    pub(crate) fn made(&self) -> Option<&State> {
        Some(&self.other).filter(|other| other.shown.is_some())
    }

    /// The other state, if the viewport shows its hair instead of one's own; `None` while that is still being made.
    pub(crate) fn flipped(&self) -> Option<&State> {
        self.made().filter(|_| self.sides == Sides::Other)
    }

    /// The lines on what differs, from the earlier document to the later.
    pub fn lines(&self) -> impl Iterator<Item = &str> {
        self.lines.iter().map(|line| line.text.as_str())
    }

    /// Finds what differs, where one's own is another than last. While something is dragged, what was found stands.
    fn find(&mut self, mine: &State) {
        if self.of == Some(mine.changes) || (mine.gesture && self.of.is_some()) {
            return;
        }
        self.of = Some(mine.changes);
        let (mut a, mut b) = (&mine.document, &self.document);
        if self.is_before {
            std::mem::swap(&mut a, &mut b);
        }
        let changes = diff(a, b);
        self.lines = change_lines(a, b, &changes, true);
        self.same_hair = is_same_hair(a, b, &changes);
        let mut both = marks(a, b, &changes).map(Arc::new);
        if self.is_before {
            both.reverse();
        }
        self.marks = both;
    }

    /// What of one's own the other is looked at with: selection, group, light and settings.
    fn follow(&mut self, mine: &State) {
        let there = |id: &NodeId| self.document.nodes.contains_key(id);
        if self.group != mine.group {
            self.group.clone_from(&mine.group);
            let near = std::iter::successors(mine.group.clone(), NodeId::group);
            self.other.group = near.into_iter().find(there);
        }
        if mine.active().is_some() {
            let selection = &mine.selection;
            self.other.selection.nodes =
                selection.nodes.iter().filter(|id| there(id)).cloned().collect();
            self.other.selection.active = selection.active.clone().filter(there);
        }
        self.other.document.look.clone_from(&mine.document.look);
        if self.other.settings != mine.settings {
            self.other.settings = mine.settings.clone();
        }
    }
}

impl Editor {
    /// The document beside one's own.
    pub fn compare(&self) -> Option<&Compare> {
        self.compare.as_ref()
    }

    /// Shows a groom's file beside one's own; where it cannot be read, says why, and nothing changes.
    pub(crate) fn compare_with(&mut self, path: &Path) {
        let called = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        self.compare_file(path, called, false);
    }

    /// Shows what was saved last beside what was made of it since.
    pub(crate) fn compare_with_saved(&mut self) {
        let Some(path) = self.state.file.path.clone() else { return };
        self.compare_file(&path, format!("{} as saved", self.state.file.name()), true);
    }

    /// Shows what others made of one's own file.
    pub(crate) fn compare_with_disk(&mut self) {
        let Some(path) = self.state.file.path.clone() else { return };
        self.compare_file(&path, format!("{} on the disk", self.state.file.name()), false);
    }

    fn compare_file(&mut self, path: &Path, name: String, is_before: bool) {
        let path = std::path::absolute(path).unwrap_or_else(|_| path.to_owned());
        match documents::life::read(&path) {
            Err(why) => self.state.apply(Event::Say(Note::error(format!("not compared: {why}")))),
            Ok((loaded, _)) => {
                let shown = path.display();
                for warning in loaded.conflicts.iter().chain(&loaded.warnings) {
                    self.state.apply(Event::Say(Note::warning(warning.of_file(shown.to_string()))));
                }
                self.compare_document(loaded.document, OpenFile::at(path.clone()), name);
                if let Some(compare) = &mut self.compare {
                    compare.is_before = is_before;
                }
            }
        }
    }

    /// Shows a document beside one's own.
    pub(crate) fn compare_document(&mut self, document: Document, file: OpenFile, name: String) {
        let mut compare = Compare::new(document, file, name, &self.state);
        if let Some(before) = &self.compare {
            // Each has a number of its own, so that no picture is taken for another's.
            compare.other.revision = compare.other.revision.max(before.other.revision + 1);
        }
        self.compare = Some(compare);
        self.apply(Event::Show(Room::Canvas));
        self.ask_beside();
    }

    fn ask_beside(&self) {
        let (Some(compare), Some(evaluation)) = (&self.compare, &self.evaluation) else { return };
        evaluation.ask_beside(EvaluationRequest {
            revision: compare.other.revision,
            document: compare.document.clone(),
            folder: compare.other.file.folder.clone(),
            also: vec![],
            quality: Quality::Final,
            allow_large: self.state.allow_large,
            afresh: false,
            unknown: false,
            drags: false,
        });
    }

    /// Shows the hair of both another way.
    pub(crate) fn show_sides(&mut self, sides: Sides) {
        let Some(compare) = &mut self.compare else { return };
        compare.sides = sides;
        // Where somebody stopped it, it is made now.
        if sides != Sides::Own && !compare.answered {
            self.ask_beside();
        }
    }

    /// One's own document alone is there again.
    pub(crate) fn end_compare(&mut self) {
        self.compare = None;
        self.canvas.mark(None);
        if let Some(evaluation) = &self.evaluation {
            evaluation.leave_beside();
        }
    }

    /// Before the rooms are shown: what came out, and what differs now.
    pub(super) fn before_compare(&mut self) {
        let finished = self.evaluation.as_ref().and_then(super::Evaluation::take_beside);
        let Some(compare) = &mut self.compare else { return };
        if let Some(finished) = finished
            && finished.reports.revision == compare.other.revision
        {
            compare.other.shown = finished.shown.map(Arc::new);
            compare.other.run.reports = Arc::new(finished.reports);
            compare.answered = true;
        }
        compare.find(&self.state);
        compare.follow(&self.state);
        self.canvas.mark(Some(compare.marks[0].clone()));
        compare.canvas.mark(Some(compare.marks[1].clone()));
    }
}

/// Whether something that the picture of the other says is about the view, and not about the document that is seen.
pub(crate) fn is_of_the_view(event: &Event) -> bool {
    use coif_graphs::document::edit::Edit;
    match event {
        Event::Act(id) => id.starts_with("view.") || id.starts_with("compare."),
        Event::Edit(edit) => {
            matches!(edit, Edit::SetLook(_) | Edit::SetView { view: Some(_), .. })
        }
        Event::Show(_) | Event::Focus(_) | Event::Say(_) => true,
        _ => false,
    }
}
