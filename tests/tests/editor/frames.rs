//! The window never waits: frames go on while the evaluator works, and are little work themselves.

use super::harness::{Ui, on_groom, settle};
use crate::work::count;
use coif::core::event::Event;
use coif_graphs::document::edit::Edit;
use coif_graphs::document::{NodeId, Setting};
use coif_nodes::define::Value;

/// Frames during an evaluation.
const FRAMES: usize = 60;
/// Times that a frame asks for memory, and bytes that it holds beside what it found, at most: three times what was measured, and far less
/// than the hair that is made meanwhile.
const ASKED: u64 = 10_000;
const HELD: u64 = 1 << 20;

#[test]
fn frames_go_on_while_a_long_evaluation_runs() {
    let mut ui = on_groom("cornrows");
    settle(&mut ui);
    let hair = |ui: &mut Ui, count: i64| {
        let (node, input) = (NodeId::new("fill").expect("an id"), "count".to_owned());
        let setting = Setting::Known(Value::Int(count));
        ui.state_mut().apply(Event::Edit(Edit::SetInput { node, input, setting }));
        ui.step();
    };
    // A hundred times the hair: far more work than so many frames.
    hair(&mut ui, 17_000);
    let mut most = (0, 0);
    for frame in 0..FRAMES {
        let (_, work) = count(|| ui.step());
        assert!(!ui.state().is_idle(), "frame {frame} waited for the end of the evaluation");
        most = (most.0.max(work.asked), most.1.max(work.held));
    }
    println!(
        "UI thread: {} times asked for memory in a frame at most, {} bytes held",
        most.0, most.1
    );
    assert!(most.0 < ASKED && most.1 < HELD, "{most:?}");
    // What nobody wants any more is stopped.
    hair(&mut ui, 170);
    settle(&mut ui);
}
