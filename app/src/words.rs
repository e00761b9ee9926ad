//! Numbers as people read them, in messages of the command line and of the window; and what a line of a message may hold.

/// The most letters of what a message quotes.
const MOST_QUOTED: usize = 80;
/// The most letters of a path, whose end tells most.
const MOST_OF_A_PATH: usize = 400;
/// The most letters of a line.
const MOST_OF_A_LINE: usize = 2000;
/// So many problems are told; the rest is counted.
pub(crate) const MOST_PROBLEMS: usize = 50;

/// A text as a terminal may see it: nothing in it but line ends and tabs steers the terminal, words that are longer than what may
/// be quoted are cut, and so are lines. All that commands print goes through here, for much of it is quoted from files.
pub(crate) fn plain(text: &str) -> String {
    let mut out = String::with_capacity(text.len().min(4 * MOST_OF_A_LINE));
    for (n, line) in text.split('\n').enumerate() {
        if n > 0 {
            out.push('\n');
        }
        let mut left = MOST_OF_A_LINE;
        for part in line.split_inclusive([' ', '\t']) {
            let most = if part.contains(['/', '\\']) { MOST_OF_A_PATH } else { MOST_QUOTED };
            let most = most.min(left);
            part.chars().take(most).for_each(|c| show(c, &mut out));
            // What ends a word does not make it long.
            let word = part.trim_end_matches([' ', '\t']);
            if word.chars().nth(most).is_some() {
                out.push('…');
                out.push_str(&part[word.len()..]);
            } else if most < part.chars().count() {
                out.push_str(&part[word.len()..]);
            }
            left = left.saturating_sub(part.chars().count());
            if left == 0 {
                if !out.ends_with('…') {
                    out.push('…');
                }
                break;
            }
        }
    }
    out
}

fn show(c: char, out: &mut String) {
    // Marks that turn the direction of text make it read as another.
    let turns =
        matches!(c, '\u{200e}' | '\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{2066}'..='\u{2069}');
    if (c.is_control() && c != '\t') || turns {
        out.extend(c.escape_default());
    } else {
        out.push(c);
    }
}

/// JSON as a terminal may see it: what is left of control characters is escaped, which changes nothing that it says.
pub(crate) fn plain_json(json: &str) -> String {
    let mut out = String::with_capacity(json.len());
    for c in json.chars() {
        match c {
            '\u{7f}'..='\u{9f}'
            | '\u{200e}'
            | '\u{200f}'
            | '\u{2028}'..='\u{202e}'
            | '\u{2066}'..='\u{2069}' => {
                out += &format!("\\u{:04x}", c as u32);
            }
            c => out.push(c),
        }
    }
    out
}

/// The first problems of many, as a terminal may see them, and how many more there are.
pub(crate) fn first_of(mut problems: Vec<String>) -> Vec<String> {
    let more = problems.len().saturating_sub(MOST_PROBLEMS);
    problems.truncate(MOST_PROBLEMS);
    problems.iter_mut().for_each(|problem| *problem = plain(problem));
    if more > 0 {
        problems.push(format!("and {} more of the kind", grouped(more)));
    }
    problems
}

/// A number in groups of three digits: 1,204.
pub(crate) fn grouped(number: usize) -> String {
    let digits = number.to_string();
    let mut text = String::new();
    for (i, digit) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i).is_multiple_of(3) {
            text.push(',');
        }
        text.push(digit);
    }
    text
}

/// A measured number with three digits that count: 4.59, 0.0254, 194, 1,230.
#[cfg(feature = "editor")]
pub(crate) fn rounded(number: f64) -> String {
    let places = 2 - number.abs().log10().floor().clamp(-300.0, 300.0) as i32;
    match usize::try_from(places) {
        Ok(places) => {
            let text = format!("{number:.places$}");
            let short = text.trim_end_matches('0').trim_end_matches('.');
            if text.contains('.') && number != 0.0 {
                short.to_owned()
            } else {
                format!("{number:.0}")
            }
        }
        Err(_) => {
            let step = 10f64.powi(-places);
            format!("{:.0}", (number / step).round() * step)
        }
    }
}

/// So many of something, whose plural ends in s: "1 strand", "1,204 strands".
#[cfg(feature = "editor")]
pub(crate) fn counted(number: usize, one: &str) -> String {
    format!("{} {one}{}", grouped(number), if number == 1 { "" } else { "s" })
}

/// `x` with at most `digits` digits that count, without zeros at its end.
#[cfg(feature = "editor")]
pub(crate) fn shortest(x: f64, digits: usize) -> String {
    if !x.is_finite() {
        return x.to_string();
    }
    let magnitude = if x == 0.0 { 0 } else { x.abs().log10().floor() as i32 };
    let decimals = (digits as i32 - 1 - magnitude).clamp(0, 12) as usize;
    let mut text = format!("{x:.decimals$}");
    if text.contains('.') {
        text.truncate(text.trim_end_matches('0').trim_end_matches('.').len());
    }
    if text == "-0" { "0".to_owned() } else { text }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[cfg(feature = "editor")]
    #[test]
    fn measured_numbers_have_three_digits_that_count() {
        for (number, expected) in [
            (4.5946727, "4.59"),
            (193.703, "194"),
            (0.0254, "0.0254"),
            (1.0, "1"),
            (0.5, "0.5"),
            (12.04, "12"),
            (9.996, "10"),
            (1234.5, "1230"),
            (-2.719, "-2.72"),
            (0.0, "0"),
        ] {
            assert_eq!(rounded(number), expected);
        }
    }

    #[test]
    fn what_is_quoted_neither_steers_a_terminal_nor_fills_it() {
        let check = |text: &str, expected: &str| assert_eq!(plain(text), expected);
        check("a node: fine, 1.5 cm\n\ttwo", "a node: fine, 1.5 cm\n\ttwo");
        check("\u{1b}[2J\r\u{7}\u{9b}1m \u{202e}x", "\\u{1b}[2J\\r\\u{7}\\u{9b}1m \\u{202e}x");
        check(&"a".repeat(100_000), &("a".repeat(80) + "…"));
        let many = plain(&"word ".repeat(100_000));
        assert!(many.chars().count() < 2100, "{}", many.len());
        let path = format!("/{}/groom.ron", "folder".repeat(40));
        check(&path, &path);
        assert_eq!(plain_json("\"\u{9b}\u{202e}é\""), "\"\\u009b\\u202eé\"");
        let many = first_of(vec!["p".to_owned(); 1052]);
        assert_eq!((many.len(), many[50].as_str()), (51, "and 1,002 more of the kind"));
    }

    #[test]
    fn long_numbers_are_grouped() {
        for (number, expected) in
            [(0, "0"), (999, "999"), (1000, "1,000"), (1_234_567, "1,234,567")]
        {
            assert_eq!(grouped(number), expected);
        }
    }
}
