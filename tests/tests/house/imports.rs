//! What the modules of a crate import from each other, read from its sources.
//!
//! Guarantees: every path that begins with `crate`, `super` or `self` counts, in `use` and elsewhere, with its file and line; comments,
//! texts and what is compiled for tests alone do not. Not seen: what macros make up.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

/// A path from one module to another.
#[derive(Debug)]
pub(crate) struct Import {
    /// Where it stands: the file, below the crate's `src`, and the line, from 1.
    pub(crate) file: PathBuf,
    pub(crate) line: usize,
    /// The path as it is meant, without `crate`.
    pub(crate) path: String,
    /// The module that it stands in, and the one that it leads to.
    pub(crate) from: Vec<String>,
    pub(crate) to: Vec<String>,
}

/// What every file of a crate imports. `sources` are files below its `src`, with their texts.
pub(crate) fn imports(sources: &[(PathBuf, String)]) -> Vec<Import> {
    let all: BTreeSet<Vec<String>> = sources.iter().map(|(file, _)| module_of(file)).collect();
    code(sources).iter().flat_map(|(file, text)| of_file(file, text, &all)).collect()
}

/// The same sources with blanks for comments, texts and letters, and without what is compiled for tests alone; lines stay.
pub(crate) fn code(sources: &[(PathBuf, String)]) -> Vec<(PathBuf, String)> {
    let bare: Vec<(&PathBuf, String)> =
        sources.iter().map(|(file, text)| (file, without_words(text))).collect();
    let tested: Vec<PathBuf> =
        bare.iter().flat_map(|(file, text)| modules_of_tests(file, text)).collect();
    let is_code = |file: &Path| {
        !tested.iter().any(|test| file.starts_with(test) || file == test.with_extension("rs"))
    };
    let code = bare.iter().filter(|(file, _)| is_code(file));
    code.map(|(file, text)| ((*file).clone(), without_tests(text))).collect()
}

/// The module that a file is.
fn module_of(file: &Path) -> Vec<String> {
    let plain = file.with_extension("");
    let mut parts: Vec<String> =
        plain.iter().map(|part| part.to_string_lossy().into_owned()).collect();
    if parts.last().is_some_and(|last| ["mod", "lib", "main"].contains(&last.as_str())) {
        parts.pop();
    }
    parts
}

fn is_word(c: char) -> bool {
    c.is_alphanumeric() || c == '_'
}

/// The same text with blanks for comments, texts and letters; lines stay.
pub(crate) fn without_words(text: &str) -> String {
    let (mut out, mut rest) = (String::with_capacity(text.len()), text);
    while let Some(c) = rest.chars().next() {
        let before = out.chars().next_back();
        let end = match c {
            '/' if rest.starts_with("//") => rest.find('\n').unwrap_or(rest.len()),
            '/' if rest.starts_with("/*") => rest.find("*/").map_or(rest.len(), |at| at + 2),
            '"' => end_of_text(rest),
            'r' if !before.is_some_and(is_word) || before == Some('b') => {
                raw_text(rest).unwrap_or_default()
            }
            '\'' => end_of_letter(rest),
            _ => 0,
        };
        let (gone, kept) = rest.split_at(if end == 0 { c.len_utf8() } else { end });
        match end {
            0 => out.push(c),
            _ => out.extend(gone.chars().map(|c| if c == '\n' { c } else { ' ' })),
        }
        rest = kept;
    }
    out
}

/// Where a text ends that begins here.
fn end_of_text(rest: &str) -> usize {
    let mut escaped = false;
    for (at, c) in rest.char_indices().skip(1) {
        match c {
            _ if escaped => escaped = false,
            '\\' => escaped = true,
            '"' => return at + 1,
            _ => {}
        }
    }
    rest.len()
}

/// Where a raw text ends, if one begins here.
fn raw_text(rest: &str) -> Option<usize> {
    let marks = rest[1..].len() - rest[1..].trim_start_matches('#').len();
    let inner = rest[1 + marks..].strip_prefix('"')?;
    let end = format!("\"{}", "#".repeat(marks));
    Some(inner.find(&end).map_or(rest.len(), |at| rest.len() - inner.len() + at + end.len()))
}

/// Where a letter ends, if one begins here and no lifetime.
fn end_of_letter(rest: &str) -> usize {
    let mut chars = rest.char_indices().skip(1);
    match (chars.next(), chars.next()) {
        (Some((_, '\\')), Some((from, c))) => {
            let from = from + c.len_utf8();
            rest[from..].find('\'').map_or(0, |at| from + at + 1)
        }
        (Some(_), Some((at, '\''))) => at + 1,
        _ => 0,
    }
}

const TESTS: &str = "#[cfg(test)]";
const OTHER_TESTS: &str = "#[cfg(all(test";

/// Where what is compiled for tests alone begins, from a place on.
fn next_test(text: &str) -> Option<usize> {
    [text.find(TESTS), text.find(OTHER_TESTS)].into_iter().flatten().min()
}

/// The files, or folders, of modules that are declared for tests alone.
fn modules_of_tests(file: &Path, text: &str) -> Vec<PathBuf> {
    let is_root = file.file_stem().is_some_and(|s| ["mod", "lib", "main"].iter().any(|r| s == *r));
    let folder =
        if is_root { file.parent().unwrap_or(file).to_owned() } else { file.with_extension("") };
    let (mut found, mut rest) = (vec![], text);
    while let Some(at) = next_test(rest) {
        rest = &rest[at + TESTS.len()..];
        let item = &rest[..rest.find([';', '{']).unwrap_or(rest.len())];
        let mut words = item.split(|c: char| !is_word(c)).filter(|word| !word.is_empty());
        if words.any(|word| word == "mod")
            && let Some(name) = words.next()
        {
            found.push(folder.join(name));
        }
    }
    found
}

/// The same text without what is compiled for tests alone; lines stay.
fn without_tests(text: &str) -> String {
    let (mut out, mut rest) = (String::new(), text);
    while let Some(at) = next_test(rest) {
        out += &rest[..at];
        let (mut depth, mut end) = (0, rest.len());
        for (i, c) in rest[at..].char_indices() {
            match c {
                '{' => depth += 1,
                '}' => depth -= 1,
                _ => {}
            }
            if depth == 0 && (c == ';' || c == '}') {
                end = at + i + 1;
                break;
            }
        }
        out.extend(rest[at..end].chars().filter(|c| *c == '\n'));
        rest = &rest[end..];
    }
    out + rest
}

/// What one file imports. In modules within it `super` is followed as far as these are deep.
fn of_file(file: &Path, text: &str, all: &BTreeSet<Vec<String>>) -> Vec<Import> {
    let own = module_of(file);
    let (mut found, mut within, mut depth) = (vec![], vec![], 0);
    let mut at = 0;
    while let Some(c) = text[at..].chars().next() {
        let begins =
            is_word(c) && !text[..at].chars().next_back().is_some_and(|b| is_word(b) || b == ':');
        let word = if begins { word_at(&text[at..]) } else { "" };
        match (c, word) {
            ('{', _) => depth += 1,
            ('}', _) => {
                depth -= 1;
                within.retain(|opened| *opened <= depth);
            }
            (_, "mod")
                if text[at..].find(['{', ';']).is_some_and(|i| text[at + i..].starts_with('{')) =>
            {
                within.push(depth + 1);
            }
            (_, "crate" | "super" | "self") if text[at + word.len()..].starts_with("::") => {
                let end = end_of_path(&text[at..]);
                let line = text[..at].matches('\n').count() + 1;
                for path in paths(&text[at..at + end]) {
                    let path = resolved(&own, &path, within.len());
                    let to = (0..=path.len()).rev().map(|n| path[..n].to_vec());
                    let to = to.into_iter().find(|to| all.contains(to)).unwrap_or_default();
                    let (file, path) = (file.to_owned(), path.join("::"));
                    found.push(Import { file, line, path, from: own.clone(), to });
                }
                at += end;
                continue;
            }
            _ => {}
        }
        at += if word.is_empty() { c.len_utf8() } else { word.len() };
    }
    found
}

fn word_at(text: &str) -> &str {
    &text[..text.find(|c: char| !is_word(c)).unwrap_or(text.len())]
}

/// Where a path with all its branches ends.
fn end_of_path(text: &str) -> usize {
    let mut depth = 0;
    for (at, c) in text.char_indices() {
        match c {
            '{' if depth > 0 || text[..at].ends_with("::") => depth += 1,
            '}' if depth > 0 => {
                depth -= 1;
                if depth == 0 {
                    return at + 1;
                }
            }
            _ if depth > 0 || is_word(c) || c == ':' => {}
            _ => return at,
        }
    }
    text.len()
}

/// The single paths of one with branches.
fn paths(text: &str) -> Vec<Vec<String>> {
    let parts = |text: &str| -> Vec<String> {
        let text = text.split(" as ").next().unwrap_or_default();
        let parts = text.split("::").map(str::trim).filter(|part| !part.is_empty());
        parts.map(str::to_owned).collect()
    };
    let Some((head, rest)) = text.split_once('{') else { return vec![parts(text)] };
    let inner = &rest[..rest.rfind('}').unwrap_or(rest.len())];
    let (mut depth, mut from, mut branches) = (0, 0, vec![]);
    for (at, c) in inner.char_indices().chain([(inner.len(), ',')]) {
        match c {
            '{' => depth += 1,
            '}' => depth -= 1,
            ',' if depth == 0 => {
                branches.push(&inner[from..at]);
                from = at + 1;
            }
            _ => {}
        }
    }
    let branches = branches.into_iter().filter(|branch| !branch.trim().is_empty());
    let all = branches.flat_map(paths);
    all.map(|branch| parts(head).into_iter().chain(branch).collect()).collect()
}

/// A path from the root of the crate, as it is meant in a module, `deep` modules within its file.
fn resolved(own: &[String], path: &[String], deep: usize) -> Vec<String> {
    let mut base = match path.first().map(String::as_str) {
        Some("crate") => vec![],
        _ => own.to_vec(),
    };
    let mut left = deep;
    let mut rest = path;
    while let Some((first, more)) = rest.split_first() {
        match first.as_str() {
            "crate" | "self" => {}
            "super" if left > 0 => left -= 1,
            "super" => {
                base.pop();
            }
            _ => break,
        }
        rest = more;
    }
    base.extend(rest.iter().filter(|part| *part != "self").cloned());
    base
}
