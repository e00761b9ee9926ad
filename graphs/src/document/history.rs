//! Undo and redo without end, in steps that people recognise.
//!
//! A step is one gesture: everything between [`History::begin`] and [`History::end`], or one edit
//! outside of it. Within a step, edits that pass over the same thing (a slider being dragged) are
//! one entry. Changes that are no steps (what is displayed) are applied to the document directly.

use super::edit::{Edit, EditError};
use super::{Document, Frame, Node, NodeId, Setting};
use coif_nodes::define::{Value, short};
use std::collections::BTreeSet;
use std::sync::Arc;

/// What was done to a document, and what was taken back.
#[derive(Clone, Debug, Default)]
pub struct History {
    done: Vec<HistoryStep>,
    undone: Vec<HistoryStep>,
    open: Option<HistoryStep>,
    /// How many steps were done when the document was saved; none when that state cannot be reached
    /// any more.
    saved: Option<usize>,
}

/// One step of a history.
#[derive(Clone, Debug)]
pub struct HistoryStep {
    /// What it did, for people: "front rows: strands 3 to 4".
    pub words: String,
    /// What leads to the other side: inverses in the order in which the edits happened.
    back: Vec<Edit>,
}

impl HistoryStep {
    /// The nodes that the step changed, for showing what it did. They need not exist now.
    pub fn nodes(&self) -> BTreeSet<NodeId> {
        let mut nodes = BTreeSet::new();
        let mut open: Vec<&Edit> = self.back.iter().collect();
        while let Some(edit) = open.pop() {
            match edit {
                Edit::Several(edits) => open.extend(edits),
                edit => nodes.extend(node_of(edit).cloned()),
            }
        }
        nodes
    }
}

fn node_of(edit: &Edit) -> Option<&NodeId> {
    use Edit as E;
    match edit {
        E::AddNode { id, .. }
        | E::RemoveNode { id }
        | E::ReplaceNode { id, .. }
        | E::Move { id, .. }
        | E::SetLabel { id, .. }
        | E::SetNodeNote { id, .. }
        | E::SetBypass { id, .. }
        | E::SetCollapsed { id, .. } => Some(id),
        E::SetInput { node, .. }
        | E::UnsetInput { node, .. }
        | E::AddStroke { node, .. }
        | E::RemoveStroke { node, .. }
        | E::ReplaceStroke { node, .. }
        | E::AddGesture { node, .. }
        | E::RemoveGesture { node, .. }
        | E::ReplaceGesture { node, .. } => Some(node),
        E::Connect { to, .. }
        | E::Disconnect { to, .. }
        | E::Reorder { to, .. }
        | E::SetWires { to, .. }
        | E::SetBends { to, .. } => Some(&to.node),
        E::SetDisplay(id) => id.as_ref(),
        E::SetTitle(_)
        | E::SetNote(_)
        | E::SetSeed(_)
        | E::SetComment { .. }
        | E::SetFrame { .. }
        | E::SetView { .. }
        | E::SetLook(_)
        | E::SetThumbnail(_)
        | E::SetBudget(_)
        | E::Several(_) => None,
    }
}

impl History {
    /// The history of a document that is just opened or made: nothing to save.
    pub fn new() -> Self {
        Self { saved: Some(0), ..Self::default() }
    }

    /// Makes a change: part of the open gesture, else a step of its own. On an error nothing has
    /// changed.
    pub fn edit(&mut self, document: &mut Document, edit: &Edit) -> Result<(), EditError> {
        let inverse = edit.apply(document)?;
        match &mut self.open {
            Some(step) => push(step, inverse),
            None => {
                self.commit(document, HistoryStep { words: String::new(), back: vec![inverse] })
            }
        }
        Ok(())
    }

    /// Makes a change as part of the last step when that changed the very same thing, else as a
    /// step of its own. For nudges that follow each other quickly; the caller has the clock.
    pub fn nudge(&mut self, document: &mut Document, edit: &Edit) -> Result<(), EditError> {
        if self.open.is_some() || self.saved == Some(self.done.len()) {
            return self.edit(document, edit);
        }
        let inverse = edit.apply(document)?;
        match self.done.pop() {
            Some(step) if matches!(&step.back[..], [one] if one.covers(&inverse)) => {
                self.commit(document, HistoryStep { words: String::new(), back: step.back });
            }
            last => {
                self.done.extend(last);
                self.commit(document, HistoryStep { words: String::new(), back: vec![inverse] });
            }
        }
        Ok(())
    }

    /// Begins a gesture: what follows is one step called `words`, or what it did when these are
    /// empty. Ends a gesture that is still open.
    pub fn begin(&mut self, document: &Document, words: &str) {
        self.end(document);
        self.open = Some(HistoryStep { words: words.to_owned(), back: vec![] });
    }

    /// Calls the open gesture something else: what it did is often known at its end alone.
    pub fn call(&mut self, words: &str) {
        if let Some(step) = &mut self.open {
            words.clone_into(&mut step.words);
        }
    }

    /// Ends the open gesture. One that changed nothing is no step.
    pub fn end(&mut self, document: &Document) {
        if let Some(step) = self.open.take().filter(|step| !step.back.is_empty()) {
            self.commit(document, step);
        }
    }

    /// Takes the open gesture back as if it had never begun.
    pub fn abort(&mut self, document: &mut Document) -> Result<(), EditError> {
        match self.open.take() {
            Some(step) => turn(document, step).map(|_| ()),
            None => Ok(()),
        }
    }

    /// Takes the last step back (with the open gesture, if any); gives its words, none when there
    /// is none.
    pub fn undo(&mut self, document: &mut Document) -> Result<Option<&str>, EditError> {
        self.end(document);
        let Some(step) = self.done.last().cloned() else { return Ok(None) };
        let step = turn(document, step)?;
        self.done.pop();
        self.undone.push(step);
        Ok(self.undone.last().map(|step| step.words.as_str()))
    }

    /// Does the last step that was taken back again; gives its words.
    pub fn redo(&mut self, document: &mut Document) -> Result<Option<&str>, EditError> {
        self.end(document);
        let Some(step) = self.undone.last().cloned() else { return Ok(None) };
        let step = turn(document, step)?;
        self.undone.pop();
        self.done.push(step);
        Ok(self.done.last().map(|step| step.words.as_str()))
    }

    /// Undoes or redoes until `done` steps are done (all that there are, when that is more).
    pub fn jump(&mut self, document: &mut Document, done: usize) -> Result<(), EditError> {
        self.end(document);
        while self.done.len() > done {
            self.undo(document)?;
        }
        while self.done.len() < done && !self.undone.is_empty() {
            self.redo(document)?;
        }
        Ok(())
    }

    /// Every step in the order of doing; the first [`History::done`] of them are done, the others
    /// taken back.
    pub fn steps(&self) -> impl Iterator<Item = &HistoryStep> {
        self.done.iter().chain(self.undone.iter().rev())
    }

    /// How many steps are done.
    pub fn done(&self) -> usize {
        self.done.len()
    }

    /// Says that the document was saved as it is now.
    pub fn mark_saved(&mut self, document: &Document) {
        self.end(document);
        self.saved = Some(self.done.len());
    }

    /// Bytes that hold what can be taken back and done again.
    pub fn bytes(&self) -> usize {
        let steps = self.done.iter().chain(&self.undone).chain(&self.open);
        steps.flat_map(|step| &step.back).map(Edit::bytes).sum()
    }

    /// Whether the document differs by a step from what was saved.
    pub fn is_changed(&self) -> bool {
        self.saved != Some(self.done.len())
            || self.open.as_ref().is_some_and(|step| !step.back.is_empty())
    }

    /// Says settings in other words everywhere in what can be taken back or done again, without changing what they mean:
    /// paths, when the file that they are relative to moves. `change` is given the name of an input.
    pub fn reword(&mut self, change: &dyn Fn(&str, &mut Setting)) {
        let steps = self.done.iter_mut().chain(&mut self.undone).chain(&mut self.open);
        let mut edits: Vec<&mut Edit> = steps.flat_map(|step| &mut step.back).collect();
        while let Some(edit) = edits.pop() {
            match edit {
                Edit::Several(several) => edits.extend(several),
                Edit::SetInput { input, setting, .. } => change(input, setting),
                Edit::AddNode { node, .. } | Edit::ReplaceNode { node, .. } => {
                    for (input, setting) in &mut Arc::make_mut(node).inputs {
                        change(input, setting);
                    }
                }
                _ => {}
            }
        }
    }

    fn commit(&mut self, document: &Document, mut step: HistoryStep) {
        if step.words.is_empty() {
            step.words = words(document, &step.back);
        }
        self.undone.clear();
        if self.saved.is_some_and(|saved| saved > self.done.len()) {
            self.saved = None;
        }
        self.done.push(step);
    }
}

fn push(step: &mut HistoryStep, inverse: Edit) {
    // Only the last entry may stand for the newer one: between others, the order of edits matters.
    if !step.back.last().is_some_and(|last| last.covers(&inverse)) {
        step.back.push(inverse);
    }
}

/// Goes to the other side of a step; gives the step that leads back. On an error the document is as
/// before.
fn turn(document: &mut Document, step: HistoryStep) -> Result<HistoryStep, EditError> {
    let edits: Vec<Edit> = step.back.into_iter().rev().collect();
    let back = match Edit::Several(edits).apply(document)? {
        Edit::Several(mut inverse) => {
            inverse.reverse();
            inverse
        }
        other => vec![other],
    };
    Ok(HistoryStep { words: step.words, back })
}

/// What edits did, said from their inverses and what came out.
fn words(document: &Document, back: &[Edit]) -> String {
    let first = back.first().map_or(String::new(), |edit| one_in_words(document, edit));
    match back.len() {
        0 | 1 => first,
        n => format!("{first} and {} more", n - 1),
    }
}

fn one_in_words(document: &Document, inverse: &Edit) -> String {
    use Edit as E;
    let name = |id: &NodeId| document.name_of(id).into_owned();
    let kind =
        |id: &str| coif_nodes::by_id(id).map_or_else(|| spoken(id), |def| def.label.to_owned());
    // As it was called while it was there.
    let label = |node: &Arc<super::Node>, id: &NodeId| {
        let mut then = document.clone();
        then.nodes.insert(id.clone(), node.clone());
        then.name_of(id).into_owned()
    };
    match inverse {
        E::RemoveNode { id } => format!("{}: added", name(id)),
        E::AddNode { id, node, .. } => format!("{}: removed", label(node, id)),
        E::ReplaceNode { id, node } => match document.node(id.as_str()) {
            Some(new) if new.kind != node.kind => {
                format!("{}: {} to {}", name(id), kind(&node.kind), kind(&new.kind))
            }
            Some(new) if new.interface != node.interface => {
                format!("{}: {}", name(id), ports_in_words(node, new))
            }
            _ => format!("{}: several values", name(id)),
        },
        E::SetInput { node, input, setting } => {
            let (before, after) = (said(Some(setting)), now(document, node, input));
            let unit = unit(document, node, input);
            format!("{}: {} {before} to {after}{unit}", name(node), spoken(input))
        }
        E::UnsetInput { node, input } => {
            let new = document.node(node.as_str()).and_then(|n| n.inputs.get(input));
            let default = document
                .def(node)
                .and_then(|def| def.input(input)?.1.default())
                .map(Setting::Known);
            match new {
                Some(new) => {
                    let (before, after) = (said(default.as_ref()), said(Some(new)));
                    let unit = unit(document, node, input);
                    format!("{}: {} {before} to {after}{unit}", name(node), spoken(input))
                }
                None => format!("{}: {}", name(node), spoken(input)),
            }
        }
        E::Connect { to, .. }
        | E::Disconnect { to, .. }
        | E::Reorder { to, .. }
        | E::SetWires { to, .. } => match document.links.get(to).map(Vec::as_slice) {
            None => format!("{}: {} unwired", name(&to.node), spoken(&to.name)),
            Some([from]) => {
                format!("{}: {} wired to {}", name(&to.node), spoken(&to.name), name(&from.node))
            }
            Some(_) => format!("{}: wires of {}", name(&to.node), spoken(&to.name)),
        },
        E::Move { id, .. } => format!("{}: moved", name(id)),
        E::SetTitle(_) => format!("title {:?}", document.title),
        E::SetNote(_) => "note".to_owned(),
        E::SetSeed(old) => format!("seed {old} to {}", document.seed),
        E::SetDisplay(_) => match &document.display {
            Some(id) => format!("{}: displayed", name(id)),
            None => "nothing displayed".to_owned(),
        },
        E::SetLabel { id, label } => {
            let before = label.clone().unwrap_or_else(|| spoken(id.as_str()));
            format!("{before} called {}", name(id))
        }
        E::SetNodeNote { id, .. } => format!("{}: note", name(id)),
        E::SetBends { to, .. } => format!("{}: wire of {} bent", name(&to.node), spoken(&to.name)),
        E::SetCollapsed { id, collapsed: true } => format!("{}: drawn whole", name(id)),
        E::SetCollapsed { id, collapsed: false } => format!("{}: drawn small", name(id)),
        E::SetFrame { name, frame } => {
            format!("frame {name}: {}", changed(frame.as_ref(), document.frames.get(name)))
        }
        E::SetView { name, .. } => match document.views.get(name) {
            Some(_) => format!("view {name}: saved"),
            None => format!("view {name}: removed"),
        },
        E::SetBudget(_) => "budget".to_owned(),
        E::SetLook(_) => "light and skin".to_owned(),
        E::SetThumbnail(_) => "thumbnail".to_owned(),
        E::SetBypass { id, bypass: true } => format!("{}: works again", name(id)),
        E::SetBypass { id, bypass: false } => format!("{}: bypassed", name(id)),
        E::SetComment { .. } => "comment".to_owned(),
        E::AddStroke { node, .. } => format!("{}: stroke removed", name(node)),
        E::RemoveStroke { node, .. } => format!("{}: stroke added", name(node)),
        E::ReplaceStroke { node, .. } => format!("{}: stroke changed", name(node)),
        E::AddGesture { node, .. } => format!("{}: gesture removed", name(node)),
        E::RemoveGesture { node, .. } => format!("{}: gesture added", name(node)),
        E::ReplaceGesture { node, .. } => format!("{}: gesture changed", name(node)),
        E::Several(edits) => match &edits[..] {
            // What went with a node or with a wire is no news of its own.
            [first @ E::AddNode { .. }, rest @ ..]
                if !rest.iter().any(|edit| is_news(first, edit)) =>
            {
                one_in_words(document, first)
            }
            [first @ E::SetWires { .. }, rest @ ..]
                if rest.iter().all(|edit| matches!(edit, E::SetBends { .. })) =>
            {
                one_in_words(document, first)
            }
            _ => words(document, edits),
        },
    }
}

/// Whether an edit is more than what comes back with the node that `first` adds.
fn is_news(first: &Edit, edit: &Edit) -> bool {
    match (first, edit) {
        (Edit::AddNode { id: group, .. }, Edit::AddNode { id, .. }) => !id.is_inside(group),
        (_, edit) => matches!(edit, Edit::Several(_)),
    }
}

/// What became of the ports of a group or of parameters.
fn ports_in_words(old: &Node, new: &Node) -> String {
    let of = |node: &Node| {
        let (inputs, outputs) =
            node.interface.map_or((&[][..], &[][..]), |i| (i.inputs(), i.outputs()));
        inputs.iter().chain(outputs).map(|port| port.name.clone()).collect::<Vec<_>>()
    };
    let (old, new) = (of(old), of(new));
    let gone = old.iter().find(|name| !new.contains(name));
    let come = new.iter().find(|name| !old.contains(name));
    match (gone, come) {
        (None, Some(come)) => format!("{} added to its ports", spoken(come)),
        (Some(gone), None) => format!("{} removed from its ports", spoken(gone)),
        (Some(gone), Some(come)) if old.len() == new.len() => {
            format!("port {} renamed to {}", spoken(gone), spoken(come))
        }
        _ => "ports".to_owned(),
    }
}

/// The unit of a number that an input is set to; nothing for what is no number.
fn unit(document: &Document, id: &NodeId, input: &str) -> &'static str {
    let node = document.node(id.as_str());
    let is_number = node.and_then(|node| node.inputs.get(input)).is_some_and(|now| match now {
        Setting::Known(Value::Float(_) | Value::Int(_)) => true,
        Setting::Known(Value::Field(field)) => field.constant().is_some(),
        _ => false,
    });
    let def = document.def(id).filter(|_| is_number);
    def.and_then(|def| def.input(input)).map_or("", |(_, input)| input.unit.suffix())
}

/// What became of a frame.
fn changed(old: Option<&Frame>, new: Option<&Frame>) -> &'static str {
    match (old, new) {
        (None, _) => "added",
        (_, None) => "removed",
        (Some(old), Some(new)) if old.text != new.text => "text",
        (Some(old), Some(new)) if old.colour != new.colour => "colour",
        (Some(old), Some(new)) if old.size != new.size => "size",
        _ => "moved",
    }
}

/// A name of files as people read it.
fn spoken(name: &str) -> String {
    name.replace('_', " ")
}

/// A number with three digits that count.
fn number(x: f64) -> String {
    if x == 0.0 || !x.is_finite() || x.abs() >= 1000.0 {
        return format!("{x:.0}");
    }
    let (mut decimals, mut size) = (2usize, x.abs());
    while size < 1.0 && decimals < 9 {
        (decimals, size) = (decimals + 1, size * 10.0);
    }
    while size >= 10.0 && decimals > 0 {
        (decimals, size) = (decimals - 1, size / 10.0);
    }
    let text = format!("{x:.decimals$}");
    if !text.contains('.') {
        return text;
    }
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

fn said(setting: Option<&Setting>) -> String {
    match setting {
        Some(Setting::Known(Value::Float(x))) => number(f64::from(*x)),
        Some(Setting::Known(Value::Vec3(v))) => {
            v.to_array().map(|x| number(f64::from(x))).join(" ")
        }
        Some(Setting::Known(Value::Bool(on))) => if *on { "on" } else { "off" }.to_owned(),
        Some(Setting::Known(Value::Text(text))) => short(&spoken(text)),
        Some(Setting::Known(Value::Field(field))) if field.constant().is_some() => {
            number(f64::from(field.constant().unwrap_or_default()))
        }
        Some(Setting::Known(value)) => short(&crate::text::write_value(value)),
        Some(Setting::Raw(text)) => short(text),
        None => "default".to_owned(),
    }
}

/// What an input is now: set, or its default.
fn now(document: &Document, node: &NodeId, input: &str) -> String {
    said(document.node(node.as_str()).and_then(|node| node.inputs.get(input)))
}

#[cfg(test)]
mod tests {
    use super::super::testing::Random;
    use super::super::{Node, Point, SavedView, Socket};
    use super::*;

    fn id(text: &str) -> NodeId {
        NodeId::new(text).unwrap()
    }
    fn add(name: &str) -> Edit {
        let node = Node { kind: "resample".into(), ..Node::default() };
        Edit::AddNode { id: id(name), node: node.into(), at: None }
    }
    fn count(n: i64) -> Edit {
        let setting = Setting::Known(Value::Int(n));
        Edit::SetInput { node: id("a"), input: "count".into(), setting }
    }
    fn steps(history: &History) -> Vec<&str> {
        history.steps().map(|step| step.words.as_str()).collect()
    }

    #[test]
    fn a_drag_is_one_step_however_many_values_it_passed() {
        let (mut document, mut history) = (Document::default(), History::new());
        history.edit(&mut document, &add("a")).unwrap();
        let before = document.clone();
        history.begin(&document, "");
        for n in 17..400 {
            history.edit(&mut document, &count(n)).unwrap();
        }
        history.end(&document);
        assert_eq!(steps(&history), ["Resample: added", "Resample: count 16 to 399"]);
        assert_eq!(history.done[1].back.len(), 1);
        assert_eq!(history.done[1].nodes(), [id("a")].into());
        let after = document.clone();
        assert_eq!(history.undo(&mut document).unwrap(), Some("Resample: count 16 to 399"));
        assert_eq!(document, before);
        history.redo(&mut document).unwrap();
        assert_eq!(document, after);
    }

    #[test]
    fn a_changed_length_is_told_with_its_unit() {
        let (mut document, mut history) = (Document::default(), History::new());
        let node = Node { kind: "edge_partition".into(), ..Node::default() };
        let add = Edit::AddNode { id: id("a"), node: node.into(), at: None };
        history.edit(&mut document, &add).unwrap();
        for width in [0.15, 0.284] {
            let setting = Setting::Known(Value::Float(width));
            let input = "parting_width".into();
            history.edit(&mut document, &Edit::SetInput { node: id("a"), input, setting }).unwrap();
        }
        let last = steps(&history).pop().unwrap();
        assert_eq!(last, "Edge partition: parting width 0.15 to 0.284 cm");
    }

    #[test]
    fn nudges_of_one_field_are_one_step_and_of_another_a_new_one() {
        let (mut document, mut history) = (Document::default(), History::new());
        history.edit(&mut document, &add("a")).unwrap();
        history.edit(&mut document, &count(17)).unwrap();
        history.nudge(&mut document, &count(18)).unwrap();
        history.nudge(&mut document, &count(19)).unwrap();
        history.nudge(&mut document, &Edit::SetTitle("new".into())).unwrap();
        let words = ["Resample: added", "Resample: count 16 to 19", "title \"new\""];
        assert_eq!(steps(&history), words);
    }

    #[test]
    fn a_gesture_that_is_aborted_or_changes_nothing_is_no_step() {
        let (mut document, mut history) = (Document::default(), History::new());
        history.edit(&mut document, &add("a")).unwrap();
        let before = document.clone();
        history.begin(&document, "recipe");
        history.edit(&mut document, &add("b")).unwrap();
        history.edit(&mut document, &count(3)).unwrap();
        assert!(history.edit(&mut document, &add("b")).is_err());
        history.abort(&mut document).unwrap();
        assert_eq!((&document, history.done()), (&before, 1));
        history.begin(&document, "nothing");
        history.end(&document);
        assert_eq!(history.done(), 1);
    }

    #[test]
    fn saved_is_where_saving_was_until_that_cannot_be_reached() {
        let (mut document, mut history) = (Document::default(), History::new());
        assert!(!history.is_changed());
        history.edit(&mut document, &add("a")).unwrap();
        history.edit(&mut document, &count(3)).unwrap();
        history.mark_saved(&document);
        history.undo(&mut document).unwrap();
        assert!(history.is_changed());
        history.redo(&mut document).unwrap();
        assert!(!history.is_changed());
        // A nudge after saving is a change of its own.
        history.nudge(&mut document, &count(4)).unwrap();
        assert!(history.is_changed());
        history.jump(&mut document, 1).unwrap();
        history.edit(&mut document, &count(9)).unwrap();
        history.undo(&mut document).unwrap();
        assert!(history.is_changed());
        history.jump(&mut document, 9).unwrap();
        assert!(history.is_changed());
    }

    #[test]
    fn what_is_reworded_is_so_in_every_state() {
        let (mut document, mut history) = (Document::default(), History::new());
        history.edit(&mut document, &add("a")).unwrap();
        for n in [3, 4, 5] {
            history.edit(&mut document, &count(n)).unwrap();
        }
        history.edit(&mut document, &Edit::RemoveNode { id: id("a") }).unwrap();
        history.undo(&mut document).unwrap();
        history.undo(&mut document).unwrap();
        let reword = |input: &str, setting: &mut Setting| {
            if let ("count", Setting::Known(Value::Int(n))) = (input, setting) {
                *n *= 10;
            }
        };
        history.reword(&reword);
        let node = document.nodes.get_mut("a").map(Arc::make_mut).unwrap();
        node.inputs.iter_mut().for_each(|(input, setting)| reword(input, setting));
        let mut seen = vec![];
        for at in [1, 2, 3, 4, 5, 4] {
            history.jump(&mut document, at).unwrap();
            let node = document.node("a");
            seen.push(node.and_then(|node| node.inputs.get("count").cloned()));
        }
        let known = |n: i64| Some(Setting::Known(Value::Int(n)));
        assert_eq!(seen, [None, known(30), known(40), known(50), None, known(50)]);
    }

    #[test]
    fn steps_say_what_they_did() {
        let (mut document, mut history) = (Document::default(), History::new());
        let curves = |text: &str| Socket::new(id(text), "curves");
        let wire = Edit::Connect { from: curves("a"), to: curves("b"), at: None };
        let frame = |text: &str, colour: u8, right: f32| {
            let (at, size) = (Point(right, 0.0), Point(100.0, 50.0));
            let frame = Frame { at, size, text: text.into(), colour };
            Edit::SetFrame { name: "front".into(), frame: Some(frame) }
        };
        let view = SavedView {
            eye: [0.0, 0.0, 60.0],
            target: [0.0; 3],
            up: [0.0, 1.0, 0.0],
            focal_mm: 85.0,
            orthographic: None,
        };
        let edits = [
            add("a"),
            add("b"),
            wire,
            Edit::SetLabel { id: id("a"), label: Some("front rows".into()) },
            count(3),
            Edit::UnsetInput { node: id("a"), input: "count".into() },
            Edit::SetBypass { id: id("b"), bypass: true },
            Edit::Disconnect { to: curves("b"), at: 0 },
            Edit::Move { id: id("b"), to: Some(Point(1.0, 2.0)) },
            Edit::Connect { from: curves("a"), to: curves("b"), at: None },
            Edit::SetBends { to: curves("b"), at: 0, bends: vec![Point(1.0, 2.0)] },
            Edit::SetCollapsed { id: id("b"), collapsed: true },
            Edit::Disconnect { to: curves("b"), at: 0 },
            Edit::Connect { from: curves("a"), to: curves("b"), at: None },
            Edit::RemoveNode { id: id("a") },
            frame("Front", 0, 0.0),
            frame("Temples", 0, 0.0),
            frame("Temples", 3, 0.0),
            frame("Temples", 3, 9.0),
            Edit::SetFrame { name: "front".into(), frame: None },
            Edit::SetView { name: "hero".into(), view: Some(view) },
            Edit::SetView { name: "hero".into(), view: None },
            Edit::SetSeed(3),
        ];
        for edit in edits {
            history.edit(&mut document, &edit).unwrap();
        }
        expect_test::expect![[r#"
            Resample: added
            b: added
            b: curves wired to a
            a called front rows
            front rows: count 16 to 3
            front rows: count 3 to default
            b: bypassed
            b: curves unwired
            b: moved
            b: curves wired to front rows
            b: wire of curves bent
            b: drawn small
            b: curves unwired
            b: curves wired to front rows
            front rows: removed
            frame front: added
            frame front: text
            frame front: colour
            frame front: moved
            frame front: removed
            view hero: saved
            view hero: removed
            seed 0 to 3"#]]
        .assert_eq(&steps(&history).join("\n"));
    }

    #[test]
    fn everything_can_be_taken_back_and_done_again() {
        for seed in 0..20 {
            let mut random = Random::new(seed);
            let (mut document, mut history) = (Document::default(), History::new());
            let mut states = vec![document.clone()];
            for _ in 0..40 {
                history.begin(&document, "");
                for _ in 0..random.below(5) {
                    let edit = random.edit(&document);
                    let _ = history.edit(&mut document, &edit);
                }
                history.end(&document);
                if history.done() == states.len() {
                    states.push(document.clone());
                }
            }
            for _ in 0..60 {
                let at = random.below(states.len());
                history.jump(&mut document, at).unwrap();
                assert_eq!(document, states[at], "seed {seed} step {at}");
            }
        }
    }
}
