//! What earlier evaluations made, by key, within a budget of memory.
//!
//! Least recently used goes first. Sizes are as the makers state them: data that two entries share counts
//! twice, so the budget is an upper bound. What the same program holds elsewhere (pictures, documents) is taken from the budget, and
//! what was made for a document that is gone keeps a part of it alone. Keys are 128-bit hashes of everything that made the value; they never leave the
//! process.

use coif_nodes::eval::Kept;
use coif_nodes::maths::hash::Key;
use std::collections::{BTreeMap, HashMap};

/// The most that a cache takes by itself.
const MOST: u64 = 2 << 30;
/// What was made for documents that are gone keeps one part of the budget in so many: enough to go back to the last one soon. As much is
/// left to the cache whatever is held elsewhere.
const PARTS: usize = 4;

/// The budget of an editor's cache in bytes: a quarter of the machine's memory, at most 2 GiB, and 1 GiB
/// where the system does not say how much there is.
pub fn usual_budget() -> usize {
    let memory = std::fs::read_to_string("/proc/meminfo").ok();
    budget_of(memory.and_then(|text| bytes_of(&text)))
}

fn budget_of(memory: Option<u64>) -> usize {
    usize::try_from(memory.map_or(1 << 30, |bytes| bytes / 4).min(MOST)).unwrap_or(usize::MAX)
}

/// All memory, as Linux tells of it.
fn bytes_of(meminfo: &str) -> Option<u64> {
    let line = meminfo.lines().find_map(|line| line.strip_prefix("MemTotal:"))?;
    let kib: u64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    kib.checked_mul(1024)
}

/// Results by key.
#[derive(Default)]
pub struct Cache {
    entries: HashMap<Key, Entry>,
    /// Last use to key: the first is the next to go.
    by_age: BTreeMap<u64, Key>,
    clock: u64,
    bytes: usize,
    budget: usize,
    /// Bytes of the budget that are held elsewhere.
    elsewhere: usize,
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
    /// The most bytes that it may hold.
    pub fn budget(&self) -> usize {
        self.budget
    }
    /// Takes what is held elsewhere from the budget, so that both together stay within it. A quarter of the budget is the cache's own.
    pub fn make_room(&mut self, elsewhere: usize) {
        self.elsewhere = elsewhere;
        self.trim(self.room());
    }
    /// Another document takes the place of the one that all of this was made for: of that the least recently used goes, but for a
    /// quarter of the budget.
    pub fn leave_document(&mut self) {
        self.trim(self.room().min(self.budget / PARTS));
    }
    /// The most bytes that may be held now.
    fn room(&self) -> usize {
        self.budget.saturating_sub(self.elsewhere).max(self.budget / PARTS)
    }
    fn trim(&mut self, most: usize) {
        while self.bytes > most {
            let Some((_, oldest)) = self.by_age.pop_first() else { break };
            if let Some(gone) = self.entries.remove(&oldest) {
                self.bytes -= gone.bytes;
            }
        }
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
    /// Keeps a value instead of what was kept under the key, unless it alone is over what there is room for.
    pub fn keep(&mut self, key: Key, value: Kept, bytes: usize) {
        if let Some(old) = self.entries.remove(&key) {
            self.by_age.remove(&old.used);
            self.bytes -= old.bytes;
        }
        if bytes > self.room() {
            return;
        }
        self.clock += 1;
        self.entries.insert(key, Entry { value, bytes, used: self.clock });
        self.by_age.insert(self.clock, key);
        self.bytes += bytes;
        self.trim(self.room());
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::Arc;

    #[test]
    fn the_budget_is_a_quarter_of_memory_and_at_most_2_gib() {
        let said = |text: &str| budget_of(bytes_of(text));
        assert_eq!(said("MemTotal:        4194304 kB\nMemFree: 1 kB"), 1 << 30);
        assert_eq!(said("MemTotal: 999999999 kB"), 2 << 30);
        for text in ["", "MemTotal: lots", "MemTotal: 99999999999999999999 kB"] {
            assert_eq!(said(text), 1 << 30, "{text}");
        }
        assert!(usual_budget() > 0);
    }

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

    /// A cache of 100 bytes with ten values of ten.
    fn full() -> Cache {
        let mut cache = Cache::new(100);
        (0..10).for_each(|k| cache.keep(Key(k), Arc::new(k), 10));
        assert_eq!(cache.bytes(), 100);
        cache
    }

    #[test]
    fn what_is_held_elsewhere_is_taken_from_the_budget() {
        let mut cache = full();
        cache.make_room(35);
        assert_eq!(cache.bytes(), 60);
        cache.keep(Key(10), Arc::new(10), 10);
        assert_eq!(cache.bytes(), 60);
        assert!(cache.find(Key(10)).is_some() && cache.find(Key(4)).is_none());
        // However much that is, what was made last is kept.
        cache.make_room(usize::MAX);
        assert_eq!(cache.bytes(), 20);
        cache.make_room(0);
        cache.keep(Key(11), Arc::new(11), 80);
        assert_eq!(cache.bytes(), 100);
    }

    #[test]
    fn of_a_document_that_is_gone_a_quarter_of_the_budget_is_kept() {
        let mut cache = full();
        cache.find(Key(0));
        cache.leave_document();
        let there: Vec<u64> =
            (0..10).filter(|k| cache.find(Key(*k)).is_some()).map(|k| k as u64).collect();
        assert_eq!(there, [0, 9], "what was used last");
        // The next document has all the rest.
        (20..28).for_each(|k| cache.keep(Key(k), Arc::new(k), 10));
        assert_eq!(cache.bytes(), 100);
    }
}
