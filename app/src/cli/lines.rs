//! On which line of a graph's text an input stands, for messages about what was read from it.
//!
//! The text has been read before, so it is only walked: brackets, strings, comments and the names before colons. Of text that could not
//! be read lines may be wrong or missing; nothing else comes of it.

use std::collections::HashMap;

/// Lines of nodes, their inputs and wires, from 1.
pub(super) struct Lines(HashMap<Vec<String>, usize>);

impl Lines {
    /// Those of a document's text.
    pub(super) fn of(text: &str) -> Self {
        /// Nodes, their names, what is said of them, their inputs.
        const DEEPEST: usize = 5;
        let mut lines = HashMap::new();
        // The name under which each open bracket stands, and the last name seen within it.
        let mut path: Vec<String> = vec![];
        let (mut line, mut rest) = (1, text);
        while let Some(c) = rest.chars().next() {
            let length = match c {
                '"' => string(rest),
                'r' if rest[1..].starts_with(['"', '#']) => raw(rest),
                '/' if rest.starts_with("//") => rest.find('\n').unwrap_or(rest.len()),
                '/' if rest.starts_with("/*") => rest.find("*/").map_or(rest.len(), |at| at + 2),
                c if c.is_alphabetic() || c == '_' => {
                    rest.find(|c: char| !c.is_alphanumeric() && c != '_').unwrap_or(rest.len())
                }
                c => c.len_utf8(),
            };
            let word = &rest[..length];
            match c {
                '(' | '{' | '[' => path.push(String::new()),
                ')' | '}' | ']' => drop(path.pop()),
                '"' | '_' | 'a'..='z' | 'A'..='Z'
                    if path.len() <= DEEPEST && rest[length..].trim_start().starts_with(':') =>
                {
                    if let Some(name) = path.last_mut() {
                        *name = word.trim_matches('"').to_owned();
                        lines.entry(path.clone()).or_insert(line);
                    }
                }
                _ => {}
            }
            line += word.matches('\n').count();
            rest = &rest[length..];
        }
        Self(lines)
    }

    /// The line of an input as it is set or wired, else of its node.
    pub(super) fn of_input(&self, node: &str, input: Option<&str>) -> Option<usize> {
        let find = |path: &[&str]| {
            let path: Vec<String> = path.iter().map(|name| (*name).to_owned()).collect();
            self.0.get(&path).copied()
        };
        let of_input = input.and_then(|input| {
            find(&["nodes", node, "inputs", input])
                .or_else(|| find(&["links", &format!("{node}.{input}")]))
        });
        of_input.or_else(|| find(&["nodes", node]))
    }
}

/// Bytes of a string in quotes.
fn string(text: &str) -> usize {
    let mut is_escaped = false;
    for (at, c) in text.char_indices().skip(1) {
        match c {
            _ if is_escaped => is_escaped = false,
            '\\' => is_escaped = true,
            '"' => return at + 1,
            _ => {}
        }
    }
    text.len()
}

/// Bytes of a raw string.
fn raw(text: &str) -> usize {
    let hashes = text[1..].chars().take_while(|c| *c == '#').count();
    let end = format!("\"{}", "#".repeat(hashes));
    let from = (hashes + 2).min(text.len());
    text.get(from..).and_then(|rest| rest.find(&end)).map_or(text.len(), |at| from + at + end.len())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn inputs_wires_and_nodes_are_found_on_their_lines() {
        let text = "(\n title: \"nodes: {\",\n nodes: {\n  // \"a\": (\n  \"a\": (kind: \"k\",\n   inputs: {\"n\": 1,\n    \"m\": \
                    r#\"\n\"#}),\n  \"b\": (kind: \"k\"),\n },\n links: {\n  \"b.n\": \"a.n\",\n },\n)\n";
        let lines = Lines::of(text);
        let found = |node, input| lines.of_input(node, input);
        // The raw string of m takes a line.
        assert_eq!(found("a", Some("n")), Some(6));
        assert_eq!(found("a", Some("m")), Some(7));
        assert_eq!(found("a", Some("none")), Some(5));
        assert_eq!(found("b", None), Some(9));
        assert_eq!(found("b", Some("n")), Some(12));
        assert_eq!(found("c", None), None);
        for cut in 0..text.len() {
            Lines::of(&text[..cut]);
        }
        Lines::of("r#");
        Lines::of("((((\"");
    }
}
