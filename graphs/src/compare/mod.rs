//! Two grooms compared, and two people's grooms made one: over documents, never over text.
//!
//! A document is taken apart into facts ([`Fact`]): each thing that can be said of it under a name of its own.
//! A [`diff`](fn@diff) is the facts that are not the same; a [`merge`](fn@merge) takes each fact from whoever changed it.
//! What both changed, each otherwise, is a [`Conflict`]: ours stays, and it is told, in the report and in the document itself,
//! as a comment that every reader knows ([`CONFLICT`](crate::file::CONFLICT)).
//!
//! Guarantees: nothing here knows a kind of node; whatever a document can hold is compared and merged; two documents differ
//! exactly where their diff says so; edits that do not meet merge to the same document in either order. Nothing here opens a
//! file, evaluates, or recurses.

#[cfg(test)]
mod cases;
mod conflict;
mod diff;
mod fact;
mod follow;
mod items;
mod lists;
mod merge;
mod ports;
#[cfg(test)]
mod tests;
mod together;
mod undecided;
mod words;

pub use conflict::{Clash, Conflict};
pub use diff::{Change, Drawn, diff, drawn, is_same_hair};
pub use fact::{Fact, Said, Wire};
pub use merge::{Merged, merge};
pub(crate) use ports::successor;
pub use undecided::{Undecided, undecided};
pub use words::{ChangeLine, change_lines, lines};
