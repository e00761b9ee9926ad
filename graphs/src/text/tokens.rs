//! The tokens of RON text, and the comments between them, which a deserialiser does not tell.
//!
//! Runs on text that was already read, so it may assume valid RON; on anything else its answer means nothing, but comes, without a
//! panic and in linear time.

/// One comment.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Comment {
    /// In bytes.
    pub(crate) at: usize,
    /// With its slashes.
    pub(crate) text: String,
}

/// Where a line and column, both from 1, lie in a text, in bytes.
pub(crate) fn offset(text: &str, (line, column): (usize, usize)) -> usize {
    let begin: usize = text.split_inclusive('\n').take(line.saturating_sub(1)).map(str::len).sum();
    let on_line = text[begin..].chars().take(column.saturating_sub(1));
    begin + on_line.map(char::len_utf8).sum::<usize>()
}

/// Where the items of a RON list begin, in bytes.
pub(crate) fn items(text: &str) -> Vec<usize> {
    let mut tokens = Tokens::of(text);
    let mut starts = vec![];
    tokens.trivia(false);
    // The list's own bracket, then the comma before each item but the first.
    while tokens.rest().starts_with(if starts.is_empty() { '[' } else { ',' }) {
        tokens.skip(1);
        tokens.trivia(false);
        if tokens.rest().is_empty() || tokens.rest().starts_with(']') {
            break;
        }
        starts.push(tokens.at);
        tokens.value();
    }
    starts
}

/// RON text without white space and comments around it.
pub(crate) fn trimmed(text: &str) -> &str {
    let mut tokens = Tokens::of(text);
    tokens.trivia(false);
    let start = tokens.at;
    let mut end = start;
    while tokens.at < text.len() {
        tokens.token();
        end = tokens.at;
        tokens.trivia(false);
    }
    &text[start..end]
}

/// A place in a text, and the comments up to it.
pub(crate) struct Tokens<'a> {
    pub(crate) text: &'a str,
    /// In bytes.
    pub(crate) at: usize,
    /// Comment lines that wait for the entry below them.
    pub(crate) pending: Vec<Comment>,
    /// Comments that stand before nothing.
    pub(crate) dropped: Vec<Comment>,
}

impl<'a> Tokens<'a> {
    /// From the beginning of a text.
    pub(crate) fn of(text: &'a str) -> Self {
        Self { text, at: 0, pending: vec![], dropped: vec![] }
    }
    /// What is left of the text.
    pub(crate) fn rest(&self) -> &'a str {
        &self.text[self.at..]
    }
    pub(crate) fn skip(&mut self, bytes: usize) {
        self.at += bytes;
    }
    /// Skips up to the first character that ends it, by byte length.
    fn skip_to(&mut self, end: impl Fn(char) -> bool) {
        let rest = self.rest();
        self.skip(rest.find(end).unwrap_or(rest.len()));
    }

    /// Skips white space and comments. Where an entry may follow, comment lines wait for it.
    pub(crate) fn trivia(&mut self, before_entry: bool) {
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
                self.dropped.push(comment);
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

    /// Skips a word and gives it.
    pub(crate) fn word(&mut self) -> &'a str {
        let start = self.at;
        self.skip_to(|c| !(c.is_alphanumeric() || matches!(c, '_' | '#')));
        &self.text[start..self.at]
    }

    /// Skips one token; comments are none.
    pub(crate) fn token(&mut self) {
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

    /// Skips a value: up to the comma or the bracket that ends it.
    pub(crate) fn value(&mut self) {
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
