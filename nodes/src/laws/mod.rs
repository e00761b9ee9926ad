//! Laws of hair, read from finished hair alone: what coif promises of grooms, measured on whatever curves there are, by whomever they
//! were made (methods.md 0 and 2 to 6).
//!
//! A law takes [`Hair`], curves of a groom or of a file, and where it needs one a scalp, and gives a figure; whether it holds is a
//! question to that. What curves do not tell is not judged: the figure is none. `coif measure`, tests of nodes, and what warns of hair
//! that was made read it here and nowhere else; nothing that makes hair does.
//!
//! Guarantees: the same figures for a groom and for the file that was written of it, on every machine and any number of threads. Not
//! promised: figures of curves that are not finite.

mod braid_spine;
mod braid_strands;
pub mod braid_words;
pub mod braids;
pub mod curls;
pub mod depth;
mod drawn;
pub mod hair;
pub mod ids;
pub mod outlines;
pub mod partings;
pub mod roots;
pub mod sections;
pub mod stitches;
pub mod strands;
pub mod ties;

pub use hair::Hair;
