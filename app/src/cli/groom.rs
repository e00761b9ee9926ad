//! A groom as commands take it: the options that `eval`, `render` and `trace` share.
//!
//! What is wrong with the options, the graph or what it names is found before anything runs.

use super::given::{apply_scalp, apply_set};
use super::progress::Bar;
use crate::files::Together;
use crate::jobs::evaluate::{self, Evaluated, Opened, nowhere, outputs};
use crate::jobs::open::{Read, read_packed, reads_all, tell_of};
use crate::jobs::report::Report;
use crate::jobs::stop::Stop;
use clap::{Args, ValueEnum};
use coif_graphs::document::graph::leading_nowhere;
use coif_graphs::schedule::run::{CancelToken, Evaluator};
use coif_nodes::eval::Quality;
use std::path::{Path, PathBuf};

/// What is evaluated, and how.
#[derive(Args, Clone, Default)]
pub(crate) struct GroomArgs {
    /// The graph: a .ron file, or the name of a shipped groom
    pub(crate) graph: PathBuf,
    /// Only these outputs, instead of every groom_output
    #[arg(long, value_name = "NODE.SOCKET")]
    pub(crate) output: Vec<String>,
    /// Set an input before evaluating; VALUE is RON, a bare word is text
    #[arg(long, value_name = "NODE.INPUT=VALUE")]
    pub(crate) set: Vec<String>,
    /// Another mesh for the graph's one head node, or for NODE
    #[arg(long, value_name = "[NODE=]FILE")]
    pub(crate) scalp: Vec<String>,
    /// Another seed than the document's
    #[arg(long)]
    pub(crate) seed: Option<u64>,
    /// Number of threads; 0: one for each core
    #[arg(long, default_value_t = 0, hide_default_value = true)]
    pub(crate) threads: usize,
    /// Also make more than 16 million points, as many as memory holds
    #[arg(long)]
    pub(crate) allow_large: bool,
    /// Let it take more than the budget of the graph
    #[arg(long)]
    pub(crate) no_budget: bool,
    /// Warnings and clamped values are errors: nothing is written (exit code 2 before, 1 after anything ran)
    #[arg(long)]
    pub(crate) strict: bool,
    /// How much hair is made
    #[arg(long, value_enum, default_value_t = QualityArg::Final)]
    pub(crate) quality: QualityArg,
}

#[derive(Clone, Copy, Debug, Default, ValueEnum)]
pub(crate) enum QualityArg {
    /// The first tenth of the strands
    Preview,
    /// All strands
    #[default]
    Final,
}

impl From<QualityArg> for Quality {
    fn from(quality: QualityArg) -> Self {
        match quality {
            QualityArg::Preview => Self::Preview,
            QualityArg::Final => Self::Final,
        }
    }
}

impl GroomArgs {
    /// A groom as it is, without any option.
    #[cfg(feature = "render")]
    pub(crate) fn of(graph: &str) -> Self {
        Self { graph: graph.into(), ..Self::default() }
    }

    /// Reads the graph, applies the options, and refuses what cannot be. `files` is told what will be read.
    pub(crate) fn open(&self, report: &mut Report, files: &mut Together) -> Result<Opened, Stop> {
        for scalp in &self.scalp {
            let path = scalp.split_once('=').map_or(scalp.as_str(), |(_, path)| path);
            files.reads(Path::new(path), format!("--scalp {scalp}")).map_err(Stop::refused)?;
        }
        let Read { loaded, folder, shown: graph, .. } = read_packed(&self.graph, self.allow_large)?;
        tell_of(&graph, &loaded, &mut report.warnings);
        let (mut document, folder) = (loaded.document, folder.unwrap_or_default());
        reads_all(&document, &folder, files)?;
        if let Some(seed) = self.seed {
            document.seed = seed;
        }
        for set in &self.set {
            apply_set(&mut document, set)?;
        }
        for scalp in &self.scalp {
            apply_scalp(&mut document, "--scalp", scalp)?;
        }
        reads_all(&document, &folder, files)?;
        report.seed = document.seed;
        report.scalp.clone_from(&self.scalp);
        report.set.clone_from(&self.set);
        let outputs = outputs(&document, &self.output)?;
        if self.output.is_empty() {
            let all = leading_nowhere(&document).into_iter();
            report.notes.extend(all.map(|id| format!("{graph}: {}", nowhere(&id))));
        }
        let (allow_large, holds_budget, strict) = (self.allow_large, !self.no_budget, self.strict);
        Ok(Opened { document, outputs, folder, graph, allow_large, holds_budget, strict })
    }

    /// Evaluates the outputs, by an evaluator that may know some of it already.
    pub(crate) fn evaluate(
        &self,
        opened: &Opened,
        evaluator: Option<&Evaluator>,
        cancel: &CancelToken,
        report: &mut Report,
    ) -> Result<Evaluated, Stop> {
        let bar = Bar::new("nodes");
        let evaluated = match evaluator {
            Some(evaluator) => {
                opened.evaluate_on(evaluator, self.quality(), &[], cancel, &bar, report)
            }
            None => self.evaluator(0, &mut report.warnings).and_then(|evaluator| {
                opened.evaluate_on(&evaluator, self.quality(), &[], cancel, &bar, report)
            }),
        };
        bar.clear();
        evaluated
    }

    pub(crate) fn quality(&self) -> Quality {
        self.quality.into()
    }

    /// What evaluates, with as many threads as were asked for, and a cache of so many bytes.
    pub(crate) fn evaluator(
        &self,
        cache_bytes: usize,
        warnings: &mut Vec<String>,
    ) -> Result<Evaluator, Stop> {
        evaluate::evaluator(self.threads, cache_bytes, warnings)
    }
}
