//! What earlier evaluations made, by key, within a budget of memory.
//!
//! Least recently used goes first. Sizes are as the makers state them: data that two entries share counts
//! twice, so the budget is an upper bound. Keys are 128-bit hashes of everything that made the value; they never leave the
//! process.

use coif_nodes::eval::Kept;
use coif_nodes::maths::hash::Key;
use std::collections::{BTreeMap, HashMap};

/// Results by key.
#[derive(Default)]
pub struct Cache {
    entries: HashMap<Key, Entry>,
    /// Last use to key: the first is the next to go.
    by_age: BTreeMap<u64, Key>,
    clock: u64,
    bytes: usize,
    budget: usize,
}

struct Entry {
    value: Kept,
    bytes: usize,
    used: u64,
}

impl Cache {
    /// A cache of at most so many bytes; 0 keeps nothing.
    pub fn new(budget: usize) -> Self {
        Self { budget, ..Self::default() }
    }
    /// Bytes held, as stated.
    pub fn bytes(&self) -> usize {
        self.bytes
    }
    /// Whether anything can be kept.
    pub fn is_off(&self) -> bool {
        self.budget == 0
    }
    /// What was kept under a key.
    pub fn find(&mut self, key: Key) -> Option<Kept> {
        let entry = self.entries.get_mut(&key)?;
        self.clock += 1;
        self.by_age.remove(&entry.used);
        self.by_age.insert(self.clock, key);
        entry.used = self.clock;
        Some(entry.value.clone())
    }
    /// Keeps a value, unless it alone is over the budget.
    pub fn keep(&mut self, key: Key, value: Kept, bytes: usize) {
        if bytes > self.budget {
            return;
        }
        self.clock += 1;
        if let Some(old) = self.entries.insert(key, Entry { value, bytes, used: self.clock }) {
            self.by_age.remove(&old.used);
            self.bytes -= old.bytes;
        }
        self.by_age.insert(self.clock, key);
        self.bytes += bytes;
        while self.bytes > self.budget {
            let Some((_, oldest)) = self.by_age.pop_first() else { break };
            if let Some(gone) = self.entries.remove(&oldest) {
                self.bytes -= gone.bytes;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::Arc;

    #[test]
    fn the_least_recently_used_goes_first_and_the_budget_holds() {
        let mut cache = Cache::new(100);
        for k in 0..3 {
            cache.keep(Key(k), Arc::new(k), 40);
            assert!(cache.bytes() <= 100);
            cache.find(Key(0));
        }
        let there: Vec<bool> = (0..3).map(|k| cache.find(Key(k)).is_some()).collect();
        assert_eq!(there, [true, false, true]);
        cache.keep(Key(9), Arc::new(9), 101);
        assert!(cache.find(Key(9)).is_none() && cache.find(Key(0)).is_some());
    }
}
