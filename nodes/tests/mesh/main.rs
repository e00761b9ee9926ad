//! Mesh readers on whole files: real heads, files made to break readers, and files we break here.
//!
//! Every read in these tests is measured: it may not panic, take 5 s, or hold more memory than
//! `mesh_in::limits` allows.
//! Curves of Alembic are measured here too, for the sake of the allocator that counts. Files in `../shared` are not part of the repository; tests that need
//! them say so and pass without them.
#![expect(unsafe_code, reason = "counting allocations takes a global allocator, which is unsafe")]

mod alembic;
mod bad_files;
mod bombs;
mod broken;
mod measure;
mod real_files;
