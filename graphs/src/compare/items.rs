//! Strokes and gestures as items of lists: what is the same, how far one moved, and two versions of one made one.

use crate::document::Setting;
use coif_nodes::data::gestures::{Gesture, Gestures};
use coif_nodes::data::strokes::{Sample, Stroke, Strokes};
use coif_nodes::define::Value;

/// What stands in a list of drawn things.
pub(super) trait ListEntry: Clone + 'static {
    /// What one is called.
    const WORD: &str;
    /// Those of a setting; none of one that holds no such list. What is not set holds none of them.
    fn of(setting: Option<&Setting>) -> Option<&[Self]>;
    /// The setting that holds them.
    fn setting(all: Vec<Self>) -> Setting;
    /// Its name in its list.
    fn id(&self) -> u64;
    /// Whether a file would say the same of both.
    fn is_same(&self, other: &Self) -> bool;
    /// How far the farthest of it moved, in head units; none where nobody can tell.
    fn moved(&self, other: &Self) -> Option<f32>;
    /// What two people made of one; none where both changed one thing of it, each otherwise.
    fn merged(base: &Self, ours: &Self, theirs: &Self) -> Option<Self>;
}

/// The one that was changed, of a thing that at most one of two changed.
pub(super) fn one<T: Clone>(
    same: impl Fn(&T, &T) -> bool,
    base: &T,
    ours: &T,
    theirs: &T,
) -> Option<T> {
    match (same(ours, theirs) || same(base, theirs), same(base, ours)) {
        (true, _) => Some(ours.clone()),
        (_, true) => Some(theirs.clone()),
        _ => None,
    }
}

/// The same of all that stand in rows of one length, one by one; else of the whole rows.
fn each<T: bytemuck::NoUninit>(base: &[T], ours: &[T], theirs: &[T]) -> Option<Vec<T>> {
    let same = |a: &T, b: &T| bytemuck::bytes_of(a) == bytemuck::bytes_of(b);
    if base.len() == ours.len() && base.len() == theirs.len() {
        let rows = base.iter().zip(ours).zip(theirs);
        return rows.map(|((base, ours), theirs)| one(same, base, ours, theirs)).collect();
    }
    let same_rows =
        |a: &&[T], b: &&[T]| a.len() == b.len() && a.iter().zip(*b).all(|(a, b)| same(a, b));
    one(same_rows, &base, &ours, &theirs).map(<[T]>::to_vec)
}

impl ListEntry for Stroke {
    const WORD: &str = "stroke";
    fn of(setting: Option<&Setting>) -> Option<&[Self]> {
        match setting {
            None => Some(&[]),
            Some(Setting::Known(Value::Strokes(strokes))) => Some(&strokes.0),
            _ => None,
        }
    }
    fn setting(all: Vec<Self>) -> Setting {
        Setting::Known(Strokes(all).into())
    }
    fn id(&self) -> u64 {
        self.id
    }
    fn is_same(&self, other: &Self) -> bool {
        fn drawn(stroke: &Stroke) -> &[u8] {
            bytemuck::cast_slice(&stroke.drawn)
        }
        self.key() == other.key() && drawn(self) == drawn(other)
    }
    fn moved(&self, other: &Self) -> Option<f32> {
        /// Places along strokes of other numbers of samples that are held against each other.
        const PLACES: usize = 64;
        let (a, b) = (&self.samples, &other.samples);
        if a.is_empty() || b.is_empty() {
            return None;
        }
        let at = |samples: &[Sample], k: usize| {
            let n = if a.len() == b.len() { k } else { k * (samples.len() - 1) / (PLACES - 1) };
            samples[n].position
        };
        let places = if a.len() == b.len() { a.len() } else { PLACES };
        (0..places).map(|k| (at(a, k) - at(b, k)).length()).max_by(f32::total_cmp)
    }
    fn merged(base: &Self, ours: &Self, theirs: &Self) -> Option<Self> {
        let Self { id, samples, drawn, brush } = base;
        Some(Self {
            id: *id,
            samples: each(samples, &ours.samples, &theirs.samples)?,
            drawn: each(drawn, &ours.drawn, &theirs.drawn)?,
            brush: one(PartialEq::eq, brush, &ours.brush, &theirs.brush)?,
        })
    }
}

impl ListEntry for Gesture {
    const WORD: &str = "gesture";
    fn of(setting: Option<&Setting>) -> Option<&[Self]> {
        match setting {
            None => Some(&[]),
            Some(Setting::Known(Value::Gestures(gestures))) => Some(&gestures.0),
            _ => None,
        }
    }
    fn setting(all: Vec<Self>) -> Setting {
        Setting::Known(Gestures(all).into())
    }
    fn id(&self) -> u64 {
        self.id
    }
    fn is_same(&self, other: &Self) -> bool {
        self.key() == other.key()
    }
    /// What moved on a picture moved nowhere on a head.
    fn moved(&self, _: &Self) -> Option<f32> {
        None
    }
    /// A gesture is one thing: half of one hand's stroke and half of another's mean nothing.
    fn merged(base: &Self, ours: &Self, theirs: &Self) -> Option<Self> {
        one(Self::is_same, base, ours, theirs)
    }
}
