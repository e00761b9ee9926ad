//! Where things stand in a file: entries and comments, which a deserialiser does not tell.
//!
//! Runs on text that was already read, so it may assume valid RON of our own structs; on anything
//! else its answer means nothing, but comes, without a panic and in linear time.

use super::FileError;
use crate::document::{NodeId, Place, Socket};
use std::collections::BTreeMap;

/// What a scan found.
#[derive(Debug, Default)]
pub(super) struct Scan {
    /// Comment lines before entries.
    pub(super) comments: BTreeMap<Place, Vec<Comment>>,
    /// Comments that stand before nothing.
    pub(super) dropped: Vec<Comment>,
    /// Where the value of each entry begins, in bytes.
    pub(super) values: BTreeMap<Place, usize>,
}

/// One comment.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Comment {
    /// In bytes.
    pub(super) at: usize,
    /// With its slashes.
    pub(super) text: String,
}

/// What lies inside a bracket.
#[derive(Clone, Copy)]
enum Inside<'a> {
    Document,
    /// In a group, or in none.
    Nodes(Option<&'a NodeId>),
    Node(&'a NodeId),
    Inputs(&'a NodeId),
    Wired(&'a NodeId),
    Into(&'a NodeId),
    Links,
    Frames,
    Bends,
    Collapsed,
    Views,
    Layout,
}

/// Scans the text of a document.
pub(super) fn scan(text: &str) -> Scan {
    let mut scanner = Scanner { text, at: 0, found: Scan::default(), pending: vec![] };
    scanner.trivia(true);
    scanner.attach(Place::Top);
    // The struct's name, if somebody wrote it.
    scanner.word();
    scanner.trivia(false);
    scanner.entries(Inside::Document);
    while scanner.at < text.len() {
        scanner.trivia(false);
        scanner.token();
    }
    scanner.found.dropped.sort_by_key(|comment| comment.at);
    scanner.found
}

/// The message at a byte of a text.
pub(super) fn error_at(text: &str, at: usize, message: String) -> FileError {
    let before = text.get(..at).unwrap_or(text);
    let line_start = before.rfind('\n').map_or(0, |i| i + 1);
    FileError {
        line: before.matches('\n').count() + 1,
        column: before[line_start..].chars().count() + 1,
        message,
    }
}

/// The messages at bytes of a text, in its order, in one pass: a file can earn thousands.
pub(super) fn errors_at(text: &str, mut said: Vec<(usize, String)>) -> Vec<FileError> {
    said.sort_by_key(|(at, _)| *at);
    let mut here = Here { rest: text, line: 1, column: 1 };
    let mut come = 0;
    let place = |(at, message): (usize, String)| {
        here.pass(at - come);
        come = at;
        FileError { line: here.line, column: here.column, message }
    };
    said.into_iter().map(place).collect()
}

/// A place in a text that goes on: what it has passed is not looked at again, however many messages one line earns.
struct Here<'a> {
    rest: &'a str,
    line: usize,
    column: usize,
}

impl Here<'_> {
    fn pass(&mut self, bytes: usize) {
        let (passed, rest) = self.rest.split_at(bytes);
        self.rest = rest;
        let on_line = match passed.rfind('\n') {
            Some(i) => {
                self.line += passed.matches('\n').count();
                self.column = 1;
                &passed[i + 1..]
            }
            None => passed,
        };
        self.column += on_line.chars().count();
    }
}

/// Where a line and column, both from 1, lie in a text, in bytes.
pub(super) fn offset(text: &str, (line, column): (usize, usize)) -> usize {
    let begin: usize = text.split_inclusive('\n').take(line.saturating_sub(1)).map(str::len).sum();
    let on_line = text[begin..].chars().take(column.saturating_sub(1));
    begin + on_line.map(char::len_utf8).sum::<usize>()
}

/// Where the items of a RON list begin, in bytes.
pub(super) fn items(text: &str) -> Vec<usize> {
    let mut scanner = Scanner { text, at: 0, found: Scan::default(), pending: vec![] };
    let mut starts = vec![];
    scanner.trivia(false);
    // The list's own bracket, then the comma before each item but the first.
    while scanner.rest().starts_with(if starts.is_empty() { '[' } else { ',' }) {
        scanner.skip(1);
        scanner.trivia(false);
        if scanner.rest().is_empty() || scanner.rest().starts_with(']') {
            break;
        }
        starts.push(scanner.at);
        scanner.value();
    }
    starts
}

/// RON text without white space and comments around it.
pub(super) fn trimmed(text: &str) -> &str {
    let mut scanner = Scanner { text, at: 0, found: Scan::default(), pending: vec![] };
    scanner.trivia(false);
    let start = scanner.at;
    let mut end = start;
    while scanner.at < text.len() {
        scanner.token();
        end = scanner.at;
        scanner.trivia(false);
    }
    &text[start..end]
}

struct Scanner<'a> {
    text: &'a str,
    at: usize,
    found: Scan,
    /// Comment lines that wait for the entry below them.
    pending: Vec<Comment>,
}

impl<'a> Scanner<'a> {
    fn rest(&self) -> &'a str {
        &self.text[self.at..]
    }
    fn skip(&mut self, bytes: usize) {
        self.at += bytes;
    }
    /// Skips up to the first character that ends it, by byte length.
    fn skip_to(&mut self, end: impl Fn(char) -> bool) {
        let rest = self.rest();
        self.skip(rest.find(end).unwrap_or(rest.len()));
    }

    /// Skips white space and comments. Where an entry may follow, comment lines wait for it.
    fn trivia(&mut self, before_entry: bool) {
        loop {
            let rest = self.rest();
            let white = |c: char| c.is_whitespace() || matches!(c, '\u{200E}' | '\u{200F}');
            self.skip(rest.len() - rest.trim_start_matches(white).len());
            let (start, rest) = (self.at, self.rest());
            let is_line = rest.starts_with("//");
            if is_line {
                self.skip(rest.find('\n').unwrap_or(rest.len()));
            } else if rest.starts_with("/*") {
                self.block_comment();
            } else {
                return;
            }
            let text = self.text[start..self.at].trim_end().to_owned();
            let before = self.text[..start].trim_end_matches(['\u{FEFF}', ' ', '\t']);
            let alone = before.is_empty() || before.ends_with('\n');
            let comment = Comment { at: start, text };
            if is_line && alone && before_entry {
                self.pending.push(comment);
            } else {
                self.found.dropped.push(comment);
            }
        }
    }

    fn block_comment(&mut self) {
        let mut depth = 0;
        while let Some(i) = self.rest().find(['/', '*']) {
            self.skip(i);
            match self.rest() {
                rest if rest.starts_with("/*") => {
                    self.skip(2);
                    depth += 1;
                }
                rest if rest.starts_with("*/") => {
                    self.skip(2);
                    depth -= 1;
                    if depth == 0 {
                        return;
                    }
                }
                _ => self.skip(1),
            }
        }
        self.at = self.text.len();
    }

    fn attach(&mut self, place: Place) {
        let lines = std::mem::take(&mut self.pending);
        if !lines.is_empty() {
            self.found.comments.entry(place).or_default().extend(lines);
        }
    }

    fn word(&mut self) -> &'a str {
        let start = self.at;
        self.skip_to(|c| !(c.is_alphanumeric() || matches!(c, '_' | '#')));
        &self.text[start..self.at]
    }

    /// Skips one token; comments are none.
    fn token(&mut self) {
        let rest = self.rest();
        let Some(first) = rest.chars().next() else { return };
        let raw = rest.trim_start_matches(['b', 'r']).trim_start_matches('#');
        let lead = &rest[..rest.len() - raw.len()];
        if raw.starts_with('"') && lead.contains('r') {
            let hashes: String = lead.chars().filter(|c| *c == '#').collect();
            let end = format!("\"{hashes}");
            self.skip(lead.len() + 1);
            let rest = self.rest();
            self.skip(rest.find(&end).map_or(rest.len(), |i| i + end.len()));
        } else if first == '"' || rest.starts_with("b\"") {
            self.skip(rest.find('"').map_or(1, |i| i + 1));
            self.skip_quoted('"');
        } else if first == '\'' || rest.starts_with("b'") {
            self.skip(rest.find('\'').map_or(1, |i| i + 1));
            // The character itself may be the quote.
            self.skip(if self.rest().starts_with("'") { 1 } else { 0 });
            self.skip_quoted('\'');
        } else if first.is_alphanumeric() || first == '_' {
            self.word();
        } else {
            self.skip(first.len_utf8());
        }
    }

    fn skip_quoted(&mut self, quote: char) {
        let mut escaped = false;
        for (i, c) in self.rest().char_indices() {
            match c {
                _ if escaped => escaped = false,
                '\\' => escaped = true,
                c if c == quote => return self.skip(i + c.len_utf8()),
                _ => {}
            }
        }
        self.at = self.text.len();
    }

    /// The entries of a bracket of our own, from the bracket on. Anything else is skipped.
    fn entries(&mut self, inside: Inside) {
        if !self.rest().starts_with(['(', '{', '[']) {
            return self.value();
        }
        self.skip(1);
        loop {
            self.trivia(true);
            if self.rest().is_empty() || self.rest().starts_with([')', '}', ']']) {
                self.found.dropped.append(&mut self.pending);
                self.skip(usize::from(!self.rest().is_empty()));
                return;
            }
            let start = self.at;
            self.token();
            let key = key(&self.text[start..self.at]);
            let place = place(inside, &key);
            match &place {
                Some(place) => self.attach(place.clone()),
                None => self.found.dropped.append(&mut self.pending),
            }
            if matches!(inside, Inside::Collapsed | Inside::Into(_)) {
                // Of a list: the entry is its own value.
                self.at = start;
            } else {
                self.trivia(false);
                if self.rest().starts_with(':') {
                    self.skip(1);
                    self.trivia(false);
                }
            }
            match place {
                Some(place) => {
                    self.found.values.entry(place.clone()).or_insert(self.at);
                    self.child(&place);
                }
                None => self.value(),
            }
            self.trivia(false);
            if self.rest().starts_with(',') {
                self.skip(1);
            }
        }
    }

    fn child(&mut self, place: &Place) {
        match place {
            Place::Field(name) => match name.as_str() {
                "nodes" => self.entries(Inside::Nodes(None)),
                "links" => self.entries(Inside::Links),
                "frames" => self.entries(Inside::Frames),
                "bends" => self.entries(Inside::Bends),
                "collapsed" => self.entries(Inside::Collapsed),
                "views" => self.entries(Inside::Views),
                "layout" => self.entries(Inside::Layout),
                _ => self.value(),
            },
            Place::Node(id) => {
                self.word();
                self.trivia(false);
                self.entries(Inside::Node(id));
            }
            Place::NodeField(id, name) => match name.as_str() {
                "inputs" => self.entries(Inside::Inputs(id)),
                "links" => self.entries(Inside::Wired(id)),
                "into" => self.entries(Inside::Into(id)),
                "nodes" => self.entries(Inside::Nodes(Some(id))),
                _ => self.value(),
            },
            _ => self.value(),
        }
    }

    /// Skips a value: up to the comma or the bracket that ends it.
    fn value(&mut self) {
        let mut depth = 0usize;
        loop {
            if depth > 0 {
                // Strokes are long lists of numbers.
                self.skip_to(|c| !matches!(c, '0'..='9' | '-' | ',' | '.' | ' ' | '\n'));
            }
            self.trivia(false);
            match self.rest().chars().next() {
                None => return,
                Some(')' | ']' | '}') if depth == 0 => return,
                Some(',') if depth == 0 => return,
                Some('(' | '[' | '{') => depth += 1,
                Some(')' | ']' | '}') => depth -= 1,
                Some(_) => {}
            }
            self.token();
        }
    }
}

/// The text of a key: of a string what it says, of a word itself.
fn key(token: &str) -> String {
    if token.contains('"') {
        ron::from_str(token).unwrap_or_default()
    } else {
        token.trim_start_matches("r#").to_owned()
    }
}

fn place(inside: Inside, key: &str) -> Option<Place> {
    Some(match inside {
        Inside::Document => Place::Field(key.to_owned()),
        Inside::Nodes(group) => Place::Node(NodeId::within(group, key).ok()?),
        Inside::Node(id) => match key {
            "at" => Place::Layout(id.clone()),
            "collapsed" => Place::Collapsed(id.clone()),
            _ => Place::NodeField(id.clone(), key.to_owned()),
        },
        Inside::Inputs(id) => Place::Input(id.clone(), key.to_owned()),
        Inside::Wired(id) => Place::Link(Socket::new(id.clone(), key)),
        Inside::Into(id) => {
            let wire: super::read::Wire = key.parse().ok()?;
            Place::Link(super::read::within(id.group().as_ref(), wire.to).ok()?)
        }
        Inside::Links => Place::Link(key.parse::<Socket>().ok()?),
        Inside::Frames => Place::Frame(key.to_owned()),
        Inside::Bends => Place::Bends(key.parse::<Socket>().ok()?),
        Inside::Collapsed => Place::Collapsed(NodeId::new(key).ok()?),
        Inside::Views => Place::View(key.to_owned()),
        Inside::Layout => Place::Layout(NodeId::new(key).ok()?),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn messages_on_one_line_are_placed_as_one_by_one_and_the_line_is_passed_once() {
        let text = "ä, b, \u{1F9F6}c,\n\nd, e\nf";
        let all: Vec<usize> = text.char_indices().map(|(at, _)| at).collect();
        let said = all.iter().rev().chain(&all).map(|at| (*at, String::new())).collect();
        for (n, found) in errors_at(text, said).into_iter().enumerate() {
            assert_eq!(found, error_at(text, all[n / 2], String::new()));
        }
        let mut here = Here { rest: text, line: 1, column: 1 };
        here.pass(4);
        assert_eq!((here.rest.len(), here.line, here.column), (text.len() - 4, 1, 4));
    }
}
