//! The files that a document names, when the document itself moves.
//!
//! Paths in a document are relative to its folder. Saved elsewhere, each names the same file as before: relative ones are
//! written anew, absolute ones become relative when the file lies in or below the new folder, so that a groom travels with
//! its head.

use coif_graphs::document::history::History;
use coif_graphs::document::{Document, NodeId, Setting};
use coif_graphs::schedule::files::{named, path_of};
use coif_nodes::define::Value;
use std::path::{Component, Path, PathBuf};
use std::sync::Arc;

/// Lets a document and its history, whose paths are relative to one folder, be relative to another.
pub(crate) fn move_to(document: &mut Document, history: &mut History, from: &Path, to: &Path) {
    let (from, to) = (settled(from), settled(to));
    if from == to {
        return;
    }
    let change = |input: &str, setting: &mut Setting| {
        if let Some(path) = path_of(input, setting)
            && let Some(moved) = moved(&path, &from, &to)
        {
            *setting = Setting::Known(Value::Text(moved.into()));
        }
    };
    let nodes: Vec<NodeId> = named(document).into_iter().map(|(id, ..)| id.clone()).collect();
    for id in nodes {
        let Some(node) = document.nodes.get_mut(&id) else { continue };
        for (input, setting) in &mut Arc::make_mut(node).inputs {
            change(input, setting);
        }
    }
    history.reword(&change);
}

/// How a document in `folder` names a file.
pub(crate) fn name_in(folder: &Path, file: &Path) -> String {
    let full = std::path::absolute(file).unwrap_or_else(|_| file.to_owned());
    let text = full.to_string_lossy().into_owned();
    moved(&text, &settled(folder), &settled(folder)).unwrap_or(text)
}

/// A folder as the system sees it: without links, so that `..` leads where it is meant to.
fn settled(folder: &Path) -> PathBuf {
    let full = std::path::absolute(folder).or_else(|_| std::env::current_dir()).unwrap_or_default();
    full.canonicalize().unwrap_or(full)
}

/// A path written anew, if it must be.
fn moved(path: &str, from: &Path, to: &Path) -> Option<String> {
    let given = Path::new(path);
    let full = plain(&from.join(given));
    let relative = if given.is_absolute() {
        // The folder may have been reached by another way than the file.
        let settled = full.parent().map(settled)?.join(full.file_name()?);
        below(&settled, to)?
    } else {
        relative(&full, to).unwrap_or(full)
    };
    let text = written(&relative);
    (text != path).then_some(text)
}

fn below(full: &Path, folder: &Path) -> Option<PathBuf> {
    full.strip_prefix(folder).ok().map(Path::to_owned)
}

/// `full` as seen from `folder`; none on another drive.
fn relative(full: &Path, folder: &Path) -> Option<PathBuf> {
    let shared = full.components().zip(folder.components()).take_while(|(a, b)| a == b).count();
    // Less than a root in common: nothing leads from one to the other.
    if shared == 0 {
        return None;
    }
    let up = folder.components().skip(shared).map(|_| Component::ParentDir);
    Some(up.chain(full.components().skip(shared)).collect())
}

/// Without `.` and `..`.
fn plain(path: &Path) -> PathBuf {
    let mut out = PathBuf::new();
    for part in path.components() {
        match part {
            Component::CurDir => {}
            Component::ParentDir => {
                out.pop();
            }
            part => out.push(part),
        }
    }
    out
}

/// As documents write paths on every system: relative ones with slashes.
fn written(path: &Path) -> String {
    if path.is_absolute() {
        return path.to_string_lossy().into_owned();
    }
    let parts: Vec<_> = path.components().map(|part| part.as_os_str().to_string_lossy()).collect();
    parts.join("/")
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;
    use crate::testing::Folder;
    use coif_graphs::document::Node;
    use coif_graphs::document::edit::Edit;

    #[test]
    fn a_path_names_the_same_file_from_another_folder() {
        let check = |path: &str, from: &str, to: &str, expected: &str| {
            let now = moved(path, Path::new(from), Path::new(to));
            assert_eq!(now.as_deref().unwrap_or(path), expected, "{path} from {from} to {to}");
        };
        check("head.obj", "/a/b", "/a/b/c", "../head.obj");
        check("head.obj", "/a/b", "/a", "b/head.obj");
        check("../x/./head.obj", "/a/b", "/q", "../a/x/head.obj");
        check("../../../../head.obj", "/a/b", "/a", "../head.obj");
        check("/x/head.obj", "/a", "/b", "/x/head.obj");
        check("/x/y/head.obj", "/a", "/x", "y/head.obj");
        check("ü ñ/頭.obj", "/a", "/b", "../a/ü ñ/頭.obj");
    }

    #[test]
    fn a_document_and_its_history_move_together() {
        let folder = Folder::new("paths");
        let (from, to) = (folder.path("one"), folder.path("two/deeper"));
        std::fs::create_dir_all(&from).unwrap();
        std::fs::create_dir_all(&to).unwrap();
        let (mut document, mut history) = (Document::default(), History::new());
        let head = NodeId::new("head").unwrap();
        let node = Node { kind: "head".into(), ..Node::default() };
        history
            .edit(&mut document, &Edit::AddNode { id: head.clone(), node: node.into(), at: None })
            .unwrap();
        let set = |path: &str| Edit::SetInput {
            node: head.clone(),
            input: "mesh".to_owned(),
            setting: Setting::Known(Value::Text(path.into())),
        };
        for path in ["a.obj", "b.obj"] {
            history.edit(&mut document, &set(path)).unwrap();
        }
        move_to(&mut document, &mut history, &from, &to);
        let path = |document: &Document| named(document).first().map(|(.., path)| path.to_string());
        assert_eq!(path(&document).as_deref(), Some("../../one/b.obj"));
        history.undo(&mut document).unwrap();
        assert_eq!(path(&document).as_deref(), Some("../../one/a.obj"));
        history.undo(&mut document).unwrap();
        assert_eq!(path(&document), None);
        history.jump(&mut document, 3).unwrap();
        move_to(&mut document, &mut history, &to, &from);
        assert_eq!(path(&document).as_deref(), Some("b.obj"));
    }

    #[test]
    fn a_file_beside_the_document_is_named_shortly() {
        let folder = Folder::new("paths-name");
        let root = folder.root().canonicalize().unwrap();
        assert_eq!(name_in(folder.root(), &folder.path("a/head.obj")), "a/head.obj");
        assert_eq!(name_in(&root, &folder.path("head.obj")), "head.obj");
        assert_eq!(name_in(&root, Path::new("/x/head.obj")), "/x/head.obj");
    }
}
