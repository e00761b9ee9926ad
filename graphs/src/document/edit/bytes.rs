//! How much memory a document and what can be taken back of it hold: lists of strokes and gestures, settings and pictures.
//!
//! Estimates for a budget. What two edits or documents share counts in both, so a sum is an upper bound; names and wires count by
//! the entry.

use super::Edit;
use crate::document::{Document, Node, Setting};
use coif_nodes::data::gestures::Gesture;
use coif_nodes::data::strokes::Stroke;
use std::mem::{size_of, size_of_val};

/// What an entry takes besides what it holds: its name, and its place in a map.
const ENTRY: usize = 96;

impl Setting {
    fn bytes(&self) -> usize {
        match self {
            Self::Known(value) => value.bytes(),
            Self::Raw(text) => text.len(),
        }
    }
}

impl Node {
    fn bytes(&self) -> usize {
        let inputs = self.inputs.values().map(|setting| ENTRY + setting.bytes());
        size_of::<Self>() + inputs.sum::<usize>()
    }
}

impl Document {
    /// Bytes held.
    pub fn bytes(&self) -> usize {
        let nodes = self.nodes.values().map(|node| ENTRY + node.bytes()).sum::<usize>();
        nodes + ENTRY * self.links.len()
    }
}

fn of_stroke(stroke: &Stroke) -> usize {
    size_of_val(&stroke.samples[..]) + size_of_val(&stroke.drawn[..])
}

fn of_gesture(one: &Gesture) -> usize {
    size_of_val(&one.samples[..]) + size_of_val(&one.curves[..]) + size_of_val(&one.path[..])
}

impl Edit {
    /// Bytes held.
    pub fn bytes(&self) -> usize {
        let held = match self {
            Self::AddNode { node, .. } | Self::ReplaceNode { node, .. } => node.bytes(),
            Self::SetInput { setting, .. } => setting.bytes(),
            Self::AddStroke { stroke, .. } | Self::ReplaceStroke { stroke, .. } => {
                of_stroke(stroke)
            }
            Self::AddGesture { gesture, .. } | Self::ReplaceGesture { gesture, .. } => {
                of_gesture(gesture)
            }
            Self::Several(edits) => edits.iter().map(Self::bytes).sum(),
            _ => 0,
        };
        size_of::<Self>() + held
    }
}
