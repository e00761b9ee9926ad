//! What the editor knows and what can happen to it: read by rooms, changed in one place.

pub mod action;
mod apply;
pub mod documents;
pub mod event;
pub(crate) mod faces;
pub mod lineage;
pub mod made;
pub mod notes;
pub mod pen;
pub mod projection;
pub mod room;
pub mod settings;
pub mod shown;
pub mod state;
pub mod templates;
pub mod visibility;
