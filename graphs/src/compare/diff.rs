//! What two documents say otherwise, fact by fact.

use super::fact::{Fact, Facts, Said, facts};
use super::items::ListEntry;
use super::lists::is_in_one_order;
use crate::document::{Document, NodeId, Setting};
use coif_nodes::define::Value;
use std::collections::BTreeMap;

/// A fact that two documents say otherwise.
#[derive(Clone, Debug, PartialEq)]
pub struct Change {
    /// Which.
    pub fact: Fact,
    /// What the first says; none where it says nothing.
    pub from: Option<Said>,
    /// What the second says.
    pub to: Option<Said>,
}

/// All that `b` says otherwise than `a`, in the order of [`Fact`]; nothing exactly when they are equal.
pub fn diff(a: &Document, b: &Document) -> Vec<Change> {
    changes(&facts(a), &facts(b))
}

pub(super) fn changes(a: &Facts, b: &Facts) -> Vec<Change> {
    let said = a.keys().chain(b.keys().filter(|fact| !a.contains_key(*fact)));
    let change = |fact: &Fact| {
        let (from, to) = (a.get(fact), b.get(fact));
        (from != to).then(|| Change { fact: fact.clone(), from: from.cloned(), to: to.cloned() })
    };
    let mut all: Vec<Change> = said.filter_map(change).collect();
    all.sort_by(|one, other| one.fact.cmp(&other.fact));
    all
}

/// Whether two documents surely give the same hair: they differ in nothing but names, notes, what is shown, and what stands on the
/// canvas.
pub fn is_same_hair(a: &Document, b: &Document, changes: &[Change]) -> bool {
    !changes.iter().any(|change| counts(a, b, change))
}

fn counts(a: &Document, b: &Document, change: &Change) -> bool {
    match &change.fact {
        Fact::Kind(_) | Fact::Bypass(_) | Fact::Ports(_) | Fact::Seed => true,
        Fact::Input(id, name) => {
            let of = |document: &Document, said: &Option<Said>| {
                value(document, id, name, said).map(|value| value.key())
            };
            let (from, to) = (of(a, &change.from), of(b, &change.to));
            from.is_none() || from != to
        }
        // Bends are for people.
        Fact::Wires(_) => {
            let sources = |said: &Option<Said>| -> Vec<_> {
                said.iter().flat_map(Said::sources).cloned().collect()
            };
            sources(&change.from) != sources(&change.to)
        }
        Fact::Title
        | Fact::Note
        | Fact::Display
        | Fact::Budget(_)
        | Fact::Look
        | Fact::Thumbnail
        | Fact::Label(_)
        | Fact::Template(_)
        | Fact::NodeNote(_)
        | Fact::Frame(_)
        | Fact::View(_)
        | Fact::Layout(_)
        | Fact::Collapsed(_)
        | Fact::Comment(_) => false,
    }
}

/// What an input is set to, or its default; none where nobody knows.
pub(super) fn value(
    document: &Document,
    id: &NodeId,
    input: &str,
    said: &Option<Said>,
) -> Option<Value> {
    match said {
        Some(Said::Setting(Setting::Known(value))) => Some(value.clone()),
        Some(_) => None,
        None => {
            let (_, input) = document.def(id)?.input(input)?;
            input.default()
        }
    }
}

/// How two lists of strokes or gestures differ.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Drawn {
    /// "stroke" or "gesture".
    pub word: &'static str,
    /// Ids of those that came, in their order.
    pub added: Vec<u64>,
    /// Ids of those that went.
    pub removed: Vec<u64>,
    /// Ids of those that are otherwise, and how far the farthest of each moved, in head units (cm on a head of average size); none
    /// where that cannot be told, or where something else of it changed.
    pub changed: Vec<(u64, Option<f32>)>,
    /// Whether what both hold stands in another order.
    pub is_reordered: bool,
}

/// How the strokes or gestures of an input differ; none where it holds none.
pub fn drawn(change: &Change) -> Option<Drawn> {
    let setting = |said: &'_ Option<Said>| match said {
        None => Some(None),
        Some(Said::Setting(setting)) => Some(Some(setting.clone())),
        Some(_) => None,
    };
    let (from, to) = (setting(&change.from)?, setting(&change.to)?);
    if from.is_none() && to.is_none() {
        return None;
    }
    fn between<T: ListEntry>(from: Option<&Setting>, to: Option<&Setting>) -> Option<Drawn> {
        Some(differing(T::of(from)?, T::of(to)?))
    }
    use coif_nodes::data::{gestures::Gesture, strokes::Stroke};
    between::<Stroke>(from.as_ref(), to.as_ref())
        .or_else(|| between::<Gesture>(from.as_ref(), to.as_ref()))
}

fn differing<T: ListEntry>(from: &[T], to: &[T]) -> Drawn {
    let by_id = |all: &[T]| all.iter().map(T::id).zip(all.to_vec()).collect::<BTreeMap<u64, T>>();
    let (old, new) = (by_id(from), by_id(to));
    let ids = |all: &[T]| all.iter().map(T::id).collect::<Vec<u64>>();
    let changed = to.iter().filter_map(|item| {
        let before = old.get(&item.id()).filter(|before| !before.is_same(item))?;
        Some((item.id(), before.moved(item).filter(|moved| *moved > 0.0)))
    });
    Drawn {
        word: T::WORD,
        added: ids(to).into_iter().filter(|id| !old.contains_key(id)).collect(),
        removed: ids(from).into_iter().filter(|id| !new.contains_key(id)).collect(),
        changed: changed.collect(),
        is_reordered: !is_in_one_order(&ids(from), &ids(to)),
    }
}
