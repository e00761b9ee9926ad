//! Typing a name on the canvas: of a node, a frame, or a node's note.

use crate::core::event::Event;
use crate::core::faces::Faces;
use crate::core::notes::Note;
use coif_graphs::document::edit::Edit;
use coif_graphs::document::{Document, Frame, NodeId};
use egui::{Area, Id, Key, Modifiers, Order, Pos2, Rect, TextEdit, Ui, vec2};
use std::collections::BTreeMap;

/// What is named.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum RenameTarget {
    /// A node's label.
    Node(NodeId),
    /// A node's note.
    Note(NodeId),
    /// A frame's title.
    Frame(String),
}

/// A field in which a name is typed.
#[derive(Debug)]
pub(super) struct Naming {
    what: RenameTarget,
    text: String,
    /// The field was shown before; until then a press elsewhere is the one that opened it.
    shown: bool,
    frame: Option<Frame>,
}

impl Naming {
    /// Opens it with the present text.
    pub(super) fn new(what: RenameTarget, now: &str) -> Self {
        Self { what, text: now.to_owned(), shown: false, frame: None }
    }

    /// Whether what is named is there.
    pub(super) fn is_there(&self, document: &Document) -> bool {
        match &self.what {
            RenameTarget::Node(id) | RenameTarget::Note(id) => document.nodes.contains_key(id),
            RenameTarget::Frame(name) => document.frames.contains_key(name),
        }
    }

    /// Where it stands on the canvas.
    pub(super) fn place(
        &mut self,
        document: &Document,
        faces: &Faces,
        corners: &BTreeMap<NodeId, Pos2>,
    ) -> Option<Pos2> {
        match &self.what {
            RenameTarget::Node(id) => corners.get(id).copied(),
            RenameTarget::Note(id) => {
                let height = faces.all.get(id)?.size().y;
                Some(*corners.get(id)? + vec2(0.0, height + 4.0))
            }
            RenameTarget::Frame(name) => {
                self.frame = document.frames.get(name).cloned();
                Some(crate::core::faces::arrange::pos(self.frame.as_ref()?.at))
            }
        }
    }

    /// Shows it at a place of the screen; gives whether it stays open. Enter and a press elsewhere
    /// set the name, Escape does not.
    pub(super) fn show(&mut self, ui: &Ui, bounds: Rect, at: Pos2, out: &mut Vec<Event>) -> bool {
        let ctx = ui.ctx();
        let note = matches!(self.what, RenameTarget::Note(_));
        let key = |m: Modifiers, key: Key| ctx.input_mut(|i| i.consume_key(m, key));
        let escape = key(Modifiers::NONE, Key::Escape);
        let enter =
            key(Modifiers::COMMAND, Key::Enter) || (!note && key(Modifiers::NONE, Key::Enter));
        let (label, hint) = match &self.what {
            RenameTarget::Node(_) => ("Name of the node", "Name"),
            RenameTarget::Note(_) => ("Note of the node", "Note; Ctrl+Enter keeps it"),
            RenameTarget::Frame(_) => ("Title of the frame", "Title"),
        };
        let letters = self.text.chars().count();
        let fresh = !self.shown;
        let area = Area::new(Id::new("canvas naming"))
            .order(Order::Foreground)
            .fixed_pos(at)
            .constrain_to(bounds)
            .show(ctx, |ui| {
                let field = if note {
                    TextEdit::multiline(&mut self.text).desired_rows(4)
                } else {
                    TextEdit::singleline(&mut self.text)
                };
                let field =
                    field.id(Id::new("canvas naming field")).hint_text(hint).desired_width(200.0);
                egui::Frame::popup(ui.style()).inner_margin(4).show(ui, |ui| {
                    let response = ui.add(field);
                    ui.ctx().accesskit_node_builder(response.id, |node| node.set_label(label));
                    response.request_focus();
                    if fresh {
                        select_all(ui.ctx(), response.id, letters);
                    }
                });
            });
        let pressed = ctx.input(|i| i.pointer.any_pressed()) && self.shown;
        let outside =
            pressed && ctx.pointer_latest_pos().is_some_and(|p| !area.response.rect.contains(p));
        self.shown = true;
        if enter || outside {
            self.keep(out);
        }
        !(escape || enter || outside)
    }

    fn keep(&self, out: &mut Vec<Event>) {
        let text = self.text.trim().to_owned();
        let edit = match &self.what {
            RenameTarget::Node(id) => Edit::SetLabel { id: id.clone(), label: Some(text) },
            RenameTarget::Note(id) => Edit::SetNodeNote { id: id.clone(), note: text },
            RenameTarget::Frame(name) => match &self.frame {
                Some(frame) => {
                    let frame = Some(Frame { text, ..frame.clone() });
                    Edit::SetFrame { name: name.clone(), frame }
                }
                None => {
                    out.push(Event::Say(Note::warning("the frame is gone")));
                    return;
                }
            },
        };
        out.push(Event::Edit(edit));
    }
}

fn select_all(ctx: &egui::Context, id: Id, letters: usize) {
    use egui::text::{CCursor, CCursorRange};
    let mut state = egui::text_edit::TextEditState::load(ctx, id).unwrap_or_default();
    let all = CCursorRange::two(CCursor::new(0), CCursor::new(letters));
    state.cursor.set_char_range(Some(all));
    state.store(ctx, id);
}
