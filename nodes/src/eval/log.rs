//! What an evaluation of one node counts and says.
//!
//! Guarantees: what is said twice is told once, with the number of curves it happened to and the first of them.

use crate::data::gestures::Replayed;
use std::sync::atomic::{AtomicU32, AtomicU64, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

/// How many curves a message names.
pub(super) const MOST_NAMED: usize = 8;

/// Trouble with single curves, told once with their number.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Message {
    /// Whether something was left out or changed (else it is a remark).
    pub warning: bool,
    /// What happened, without the curves.
    pub text: String,
    /// How many curves it happened to; 0: it is not about single curves.
    pub count: u32,
    /// Ids of the first few.
    pub curves: Vec<u64>,
}

impl Message {
    /// The same with the id of the first curve, for reports: other commands take it.
    pub fn with_id(&self) -> String {
        match self.count {
            0 => self.text.clone(),
            1 => format!("{} (curve {:016x})", self.text, self.curves[0]),
            n => format!("{} ({n} curves, first {:016x})", self.text, self.curves[0]),
        }
    }
}

/// For people, who point at curves.
impl std::fmt::Display for Message {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self.count {
            0 => f.write_str(&self.text),
            1 => write!(f, "{} (1 curve)", self.text),
            n => write!(f, "{} ({n} curves)", self.text),
        }
    }
}

/// What an evaluation of one node counted and said.
#[derive(Debug, Default)]
pub struct Log {
    /// Pieces of work (tufts) that ran.
    pub tufts_run: AtomicU32,
    /// Pieces that the cache had.
    pub tufts_reused: AtomicU32,
    /// Strands that were made of those that were asked for, and all of these.
    thinned: [AtomicU64; 2],
    messages: Mutex<Vec<Message>>,
    pub(super) gestures: Mutex<Vec<Arc<Replayed>>>,
}

impl Log {
    /// Strands that the node made of those that its inputs ask for, and all of these; both 0 where it makes none.
    pub fn thinned(&self) -> [u64; 2] {
        [&self.thinned[0], &self.thinned[1]].map(|n| n.load(Ordering::Relaxed))
    }
    pub(super) fn add_thinned(&self, made_of: [usize; 2]) {
        for (sum, n) in self.thinned.iter().zip(made_of) {
            sum.fetch_add(n as u64, Ordering::Relaxed);
        }
    }
    /// What became of the node's gestures, one for each in their order.
    pub fn gestures(&self) -> Vec<Arc<Replayed>> {
        self.gestures.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }
    /// Everything said, repeats joined.
    pub fn messages(&self) -> Vec<Message> {
        self.messages.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }
    pub(super) fn say(&self, message: Message) {
        let mut all = self.messages.lock().unwrap_or_else(PoisonError::into_inner);
        match all.iter_mut().find(|m| m.text == message.text && m.warning == message.warning) {
            Some(same) => {
                same.count += message.count;
                same.curves.extend(message.curves);
                same.curves.truncate(MOST_NAMED);
            }
            None => all.push(message),
        }
    }
}
