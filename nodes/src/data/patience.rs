//! How much may be tried yet: what bounds the search for a way out of the skin.
//!
//! Counted in looks at the skin and not by a clock, so that what is found is the same everywhere. Whoever makes one piece of work
//! gives it as it goes, so much for each point: what comes later changes nothing of what came before.

use std::sync::atomic::{AtomicU64, Ordering};

/// What is left, in looks: one place in the air, or one question for the closest point.
#[derive(Debug)]
pub struct Patience {
    left: AtomicU64,
    shut: AtomicU64,
}

/// After so many searches that found no way into the open nobody believes in one: among strewn parts there is none, beside ears
/// and in mouths there is.
const HOPELESS: u64 = 8;

impl Patience {
    /// For so many looks.
    pub fn new(looks: u64) -> Self {
        Self { left: AtomicU64::new(looks), shut: AtomicU64::new(0) }
    }
    /// For so many more.
    pub fn add(&self, looks: u64) {
        self.left.store(self.left().saturating_add(looks), Ordering::Relaxed);
    }
    /// Takes so many off, or all there are.
    pub fn take(&self, looks: u64) {
        self.left.store(self.left().saturating_sub(looks), Ordering::Relaxed);
    }
    /// What is left.
    pub fn left(&self) -> u64 {
        self.left.load(Ordering::Relaxed)
    }
    /// Notes that a search found no way into the open.
    pub fn note_shut(&self) {
        self.shut.fetch_add(1, Ordering::Relaxed);
    }
    /// Whether so many did that what is free will do.
    pub fn is_hopeless(&self) -> bool {
        self.shut.load(Ordering::Relaxed) >= HOPELESS
    }
}
