//! The budget of searches for a way out of the skin.
//!
//! It is counted in queries of the skin and not in time, so that results are the same on every machine. It grows with the work,
//! by a fixed number per CV, so that later work changes no earlier result.

use std::sync::atomic::{AtomicU64, Ordering};

/// Remaining budget, in queries: one position in the air, or one search for the closest point.
#[derive(Debug)]
pub struct Patience {
    left: AtomicU64,
    shut: AtomicU64,
}

/// Number of failed searches after which further ones are skipped: among strewn parts no way into the open exists, beside ears
/// and in mouths one does.
const HOPELESS: u64 = 8;

impl Patience {
    /// A budget of `looks` queries.
    pub fn new(looks: u64) -> Self {
        Self { left: AtomicU64::new(looks), shut: AtomicU64::new(0) }
    }
    /// Adds `looks` queries.
    pub fn add(&self, looks: u64) {
        self.left.store(self.left().saturating_add(looks), Ordering::Relaxed);
    }
    /// Spends `looks` queries, or all that remain.
    pub fn take(&self, looks: u64) {
        self.left.store(self.left().saturating_sub(looks), Ordering::Relaxed);
    }
    /// Remaining queries.
    pub fn left(&self) -> u64 {
        self.left.load(Ordering::Relaxed)
    }
    /// Counts a search that found no way into the open.
    pub fn note_shut(&self) {
        self.shut.fetch_add(1, Ordering::Relaxed);
    }
    /// Whether so many searches failed that further ones are skipped.
    pub fn is_hopeless(&self) -> bool {
        self.shut.load(Ordering::Relaxed) >= HOPELESS
    }
}
