//! Mesh readers on whole files: real heads, files made to break readers, and files we break here.
//!
//! Every read in these tests is measured: it may not panic or hang, nor hold more memory than
//! `mesh_in::limits` allows, nor ask for it more than twice for each byte of the file.
//! Curves of Alembic are measured here too, for the sake of the allocator that counts. Files in `../shared` are not part of the repository; tests that need
//! them say so and pass without them.

mod alembic;
mod bad_files;
mod bombs;
mod broken;
mod measure;
mod real_files;
#[path = "../../../tests/src/waiting.rs"]
mod waiting;
#[path = "../../../tests/src/work.rs"]
mod work;
