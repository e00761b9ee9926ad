//! Where things stand in a file: entries and comments, which a deserialiser does not tell.
//!
//! Runs on text that was already read, so it may assume valid RON of our own structs; on anything
//! else its answer means nothing, but comes, without a panic and in linear time.

use super::FileError;
use crate::document::{FileEntry, NodeId, Socket};
use crate::text::tokens::{Comment, Tokens};
use std::collections::BTreeMap;

/// What a scan found.
#[derive(Debug, Default)]
pub(super) struct Scan {
    /// Comment lines before entries.
    pub(super) comments: BTreeMap<FileEntry, Vec<Comment>>,
    /// Comments that stand before nothing.
    pub(super) dropped: Vec<Comment>,
    /// Where the value of each entry begins, in bytes.
    pub(super) values: BTreeMap<FileEntry, usize>,
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
    let mut scanner = Scanner { tokens: Tokens::of(text), found: Scan::default() };
    scanner.tokens.trivia(true);
    scanner.attach(FileEntry::Top);
    // The struct's name, if somebody wrote it.
    scanner.tokens.word();
    scanner.tokens.trivia(false);
    scanner.entries(Inside::Document);
    while scanner.tokens.at < text.len() {
        scanner.tokens.trivia(false);
        scanner.tokens.token();
    }
    let Scanner { tokens: Tokens { mut dropped, .. }, found } = scanner;
    dropped.sort_by_key(|comment| comment.at);
    Scan { dropped, ..found }
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

struct Scanner<'a> {
    tokens: Tokens<'a>,
    found: Scan,
}

impl Scanner<'_> {
    fn attach(&mut self, place: FileEntry) {
        let lines = std::mem::take(&mut self.tokens.pending);
        if !lines.is_empty() {
            self.found.comments.entry(place).or_default().extend(lines);
        }
    }

    /// The entries of a bracket of our own, from the bracket on. Anything else is skipped.
    fn entries(&mut self, inside: Inside) {
        if !self.tokens.rest().starts_with(['(', '{', '[']) {
            return self.tokens.value();
        }
        self.tokens.skip(1);
        loop {
            self.tokens.trivia(true);
            if self.tokens.rest().is_empty() || self.tokens.rest().starts_with([')', '}', ']']) {
                self.tokens.dropped.append(&mut self.tokens.pending);
                self.tokens.skip(usize::from(!self.tokens.rest().is_empty()));
                return;
            }
            let start = self.tokens.at;
            self.tokens.token();
            let key = key(&self.tokens.text[start..self.tokens.at]);
            let place = place(inside, &key);
            match &place {
                Some(place) => self.attach(place.clone()),
                None => self.tokens.dropped.append(&mut self.tokens.pending),
            }
            if matches!(inside, Inside::Collapsed | Inside::Into(_)) {
                // Of a list: the entry is its own value.
                self.tokens.at = start;
            } else {
                self.tokens.trivia(false);
                if self.tokens.rest().starts_with(':') {
                    self.tokens.skip(1);
                    self.tokens.trivia(false);
                }
            }
            match place {
                Some(place) => {
                    self.found.values.entry(place.clone()).or_insert(self.tokens.at);
                    self.child(&place);
                }
                None => self.tokens.value(),
            }
            self.tokens.trivia(false);
            if self.tokens.rest().starts_with(',') {
                self.tokens.skip(1);
            }
        }
    }

    fn child(&mut self, place: &FileEntry) {
        match place {
            FileEntry::Field(name) => match name.as_str() {
                "nodes" => self.entries(Inside::Nodes(None)),
                "links" => self.entries(Inside::Links),
                "frames" => self.entries(Inside::Frames),
                "bends" => self.entries(Inside::Bends),
                "collapsed" => self.entries(Inside::Collapsed),
                "views" => self.entries(Inside::Views),
                "layout" => self.entries(Inside::Layout),
                _ => self.tokens.value(),
            },
            FileEntry::Node(id) => {
                self.tokens.word();
                self.tokens.trivia(false);
                self.entries(Inside::Node(id));
            }
            FileEntry::NodeField(id, name) => match name.as_str() {
                "inputs" => self.entries(Inside::Inputs(id)),
                "links" => self.entries(Inside::Wired(id)),
                "into" => self.entries(Inside::Into(id)),
                "nodes" => self.entries(Inside::Nodes(Some(id))),
                _ => self.tokens.value(),
            },
            _ => self.tokens.value(),
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

fn place(inside: Inside, key: &str) -> Option<FileEntry> {
    Some(match inside {
        Inside::Document => FileEntry::Field(key.to_owned()),
        Inside::Nodes(group) => FileEntry::Node(NodeId::within(group, key).ok()?),
        Inside::Node(id) => match key {
            "at" => FileEntry::Layout(id.clone()),
            "collapsed" => FileEntry::Collapsed(id.clone()),
            _ => FileEntry::NodeField(id.clone(), key.to_owned()),
        },
        Inside::Inputs(id) => FileEntry::Input(id.clone(), key.to_owned()),
        Inside::Wired(id) => FileEntry::Link(Socket::new(id.clone(), key)),
        Inside::Into(id) => {
            let wire: super::read::WireEntry = key.parse().ok()?;
            FileEntry::Link(super::read::within(id.group().as_ref(), wire.to).ok()?)
        }
        Inside::Links => FileEntry::Link(key.parse::<Socket>().ok()?),
        Inside::Frames => FileEntry::Frame(key.to_owned()),
        Inside::Bends => FileEntry::Bends(key.parse::<Socket>().ok()?),
        Inside::Collapsed => FileEntry::Collapsed(NodeId::new(key).ok()?),
        Inside::Views => FileEntry::View(key.to_owned()),
        Inside::Layout => FileEntry::Layout(NodeId::new(key).ok()?),
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
