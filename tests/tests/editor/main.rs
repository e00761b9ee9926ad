//! The editor as a whole, without a window: what hands do, and what must be true afterwards.

mod compare;
mod frames;
mod fuzz;
mod grooms;
mod harness;
mod landmarks;
mod own_head;
mod stories;
mod story;
mod tasks;
mod tour;
#[path = "../../src/work.rs"]
mod work;
