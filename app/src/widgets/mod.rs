//! Widgets that rooms and windows share: how they look, icons, and windows, menus and fields. They know nothing of documents.

pub(crate) mod icons;
pub(crate) mod keyboard;
pub(crate) mod panel;
pub(crate) mod text;
pub mod theme;
