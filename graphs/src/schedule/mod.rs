//! From a document to hair: request, plan, run, cache, result.
//!
//! A [`plan::Plan`] lists what the targets need, in order. An [`run::Evaluator`] runs it on its threads, asks its
//! [`cache::Cache`] before every node and every tuft, and gives a [`result::Outcome`]: values, and for each node
//! what ran, what was reused and what it said.

pub mod budget;
pub mod cache;
pub mod files;
pub mod foreseen;
mod held;
pub mod plan;
pub mod request;
pub mod result;
pub mod run;
