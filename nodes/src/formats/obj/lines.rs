//! OBJ text as lines and words. Bytes, since nothing but names is ever more than ASCII.

/// Lines of text in any of the three line ends, with `\` at an end carrying on in the next line.
pub(super) struct TextLines<'a> {
    rest: &'a [u8],
    number: usize,
    joined: Vec<u8>,
}

impl<'a> TextLines<'a> {
    pub(super) fn new(text: &'a [u8]) -> Self {
        Self { rest: text, number: 0, joined: Vec::new() }
    }

    /// The next line and its number; where it goes on over several, the number of the first.
    pub(super) fn next(&mut self) -> Option<(usize, &[u8])> {
        let mut line = self.one()?;
        let number = self.number;
        // Comments do not carry on: `# made from C:\heads\` is a whole line.
        let comment = line.trim_ascii_start().starts_with(b"#");
        if comment || line.last() != Some(&b'\\') {
            return Some((number, line));
        }
        self.joined.clear();
        while let Some(start) = line.strip_suffix(b"\\") {
            self.joined.extend_from_slice(start);
            self.joined.push(b' ');
            line = self.one().unwrap_or_default();
        }
        self.joined.extend_from_slice(line);
        Some((number, &self.joined))
    }

    fn one(&mut self) -> Option<&'a [u8]> {
        if self.rest.is_empty() {
            return None;
        }
        self.number += 1;
        let end = self.rest.iter().position(|b| matches!(b, b'\n' | b'\r'));
        let (line, rest) = match end {
            None => (self.rest, &[][..]),
            Some(end) => {
                let two = self.rest[end..].starts_with(b"\r\n");
                (&self.rest[..end], &self.rest[end + 1 + usize::from(two)..])
            }
        };
        self.rest = rest;
        Some(line)
    }
}

pub(super) fn words(line: &[u8]) -> impl Iterator<Item = &[u8]> {
    line.split(|b| b.is_ascii_whitespace() || *b == 0x0b).filter(|word| !word.is_empty())
}

/// The first word of a line and what follows it.
pub(super) fn split_keyword(line: &[u8]) -> (&[u8], &[u8]) {
    let line = line.trim_ascii();
    let end = line.iter().position(u8::is_ascii_whitespace).unwrap_or(line.len());
    (&line[..end], line[end..].trim_ascii())
}
