//! How much work something is, counted: what a thread asks of the allocator. The same on every machine, however busy.
//!
//! A test program that includes this file, by its path, has an allocator that counts. What is counted is of the thread that asks
//! alone, since tests run beside each other. Work that allocates nothing is not seen.
#![allow(unsafe_code, reason = "an allocator is unsafe")]
#![allow(dead_code, unreachable_pub, reason = "each crate needs a part of it")]

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;

thread_local! {
    static HELD: Cell<i64> = const { Cell::new(0) };
    static MOST: Cell<i64> = const { Cell::new(0) };
    static ASKED: Cell<u64> = const { Cell::new(0) };
}

/// Work that was counted.
#[derive(Clone, Copy, Debug)]
pub struct Work {
    /// Times that memory was asked for.
    pub asked: u64,
    /// Bytes held at the worst moment.
    pub held: u64,
}

/// Does something, and counts its work on this thread.
pub fn count<T>(work: impl FnOnce() -> T) -> (T, Work) {
    let (before, asked) = (HELD.get(), ASKED.get());
    MOST.set(before);
    let given = work();
    let held = (MOST.get() - before).max(0) as u64;
    (given, Work { asked: ASKED.get() - asked, held })
}

/// Gets something whose memory is not counted as held, within [`count`].
pub fn uncounted<T>(get: impl FnOnce() -> T) -> T {
    let (held, most, asked) = (HELD.get(), MOST.get(), ASKED.get());
    let given = get();
    HELD.set(held);
    MOST.set(most);
    ASKED.set(asked);
    given
}

struct Counting;

fn hold(bytes: i64) {
    HELD.set(HELD.get() + bytes);
    MOST.set(MOST.get().max(HELD.get()));
    ASKED.set(ASKED.get() + u64::from(bytes > 0));
}

// Growing in place is not counted as such: the default `realloc` allocates, copies and frees, which is the worst that an allocator
// does.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        hold(layout.size() as i64);
        unsafe { System.alloc(layout) }
    }

    unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
        hold(layout.size() as i64);
        unsafe { System.alloc_zeroed(layout) }
    }

    unsafe fn dealloc(&self, place: *mut u8, layout: Layout) {
        hold(-(layout.size() as i64));
        unsafe { System.dealloc(place, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;
