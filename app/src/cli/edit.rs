//! `coif edit`: the window, on a graph or on the start-up groom.

use super::{Exit, complain, signals};
use crate::core::state::OpenFile;
use crate::editor::{self, Editor};
use crate::files::{self, extension_of};
use clap::Args;
use std::path::PathBuf;

#[derive(Args, Default)]
pub(crate) struct EditArgs {
    /// The graph: a .ron file, or the name of a shipped groom
    pub(super) graph: Option<PathBuf>,
    /// Another graph, shown beside it with all that differs
    #[arg(long, value_name = "OTHER", requires = "graph")]
    compare: Option<PathBuf>,
}

/// Whether there is anything to open a window on. Only Linux has machines without.
pub(crate) fn has_display() -> bool {
    let is_set = |name: &str| std::env::var_os(name).is_some_and(|value| !value.is_empty());
    !cfg!(target_os = "linux") || is_set("DISPLAY") || is_set("WAYLAND_DISPLAY")
}

pub(crate) fn run(args: &EditArgs) -> Exit {
    let opened = |path: &PathBuf| {
        open(path).map_err(|stop| {
            stop.lines().iter().for_each(complain);
            if is_mesh(path) {
                complain(
                    "a mesh opens in the window: start coif, and choose it in Your head (Ctrl+K, \"own head\")",
                );
            }
            Exit::Refused
        })
    };
    let both = match (&args.graph, &args.compare) {
        (None, _) => Ok((Editor::start_up(), None)),
        (Some(path), None) => opened(path).map(|mine| (mine, None)),
        (Some(path), Some(other)) => {
            let name = other.file_name().unwrap_or_default().to_string_lossy().into_owned();
            let both = opened(path).and_then(|mine| Ok((mine, opened(other)?)));
            both.map(|(mine, (document, file))| (mine, Some((document, file, name))))
        }
    };
    let ((document, file), other) = match both {
        Ok(both) => both,
        Err(exit) => return exit,
    };
    if !has_display() {
        complain("there is no display to open a window on; coif eval and coif render need none");
        return Exit::Failed;
    }
    // Steps that nobody saved are offered at the next start.
    signals::on_end(|| files::end(Exit::Interrupted as i32));
    match editor::run(document, file, other, args.graph.is_none()) {
        Ok(()) => Exit::Done,
        Err(why) => {
            complain(why);
            Exit::Failed
        }
    }
}

/// Whether a file is called as meshes are, which people hand over for grooms.
fn is_mesh(path: &std::path::Path) -> bool {
    coif_nodes::formats::mesh_in::EXTENSIONS.contains(&&*extension_of(path))
}

fn open(
    path: &PathBuf,
) -> Result<(coif_graphs::document::Document, OpenFile), crate::jobs::stop::Stop> {
    let mut warnings = vec![];
    let (document, _) = crate::jobs::open::load(path, &mut warnings)?;
    warnings.iter().for_each(|warning| complain(format!("warning: {warning}")));
    // A shipped groom is opened by name and has no file of its own yet.
    let file = if path.exists() {
        OpenFile::at(std::path::absolute(path).unwrap_or_else(|_| path.clone()))
    } else {
        OpenFile::default()
    };
    Ok((document, file))
}
