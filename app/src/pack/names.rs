//! Which names files may have in a pack: those that lead to the same place, below a folder, on every system.
//!
//! A name is words with slashes between them. Guaranteed of a set of names without a fault: none leads out of the folder it is put
//! in, none is a device, none has letters that cannot be seen or that turn others round, and no two are one file where neither case
//! nor the spelling of a letter (composed, or put together of parts) counts. Not looked at: letters that only look alike.

use std::collections::BTreeMap;
use unicode_normalization::UnicodeNormalization;

/// The most bytes of a name, and of a word of it.
const MOST_NAME: usize = 240;
const MOST_WORD: usize = 120;
/// The most words of a name.
const MOST_DEEP: usize = 16;

/// What is wrong with a name; none where nothing is.
pub(crate) fn fault(name: &str) -> Option<String> {
    if name.len() > MOST_NAME {
        return Some(format!("its name is longer than {MOST_NAME} bytes"));
    }
    if name.contains('\\') {
        return Some("its name has a backslash: folders are parted by /".to_owned());
    }
    if name.starts_with('/') {
        return Some("its name begins at the root".to_owned());
    }
    let words: Vec<&str> = name.split('/').collect();
    if words.len() > MOST_DEEP {
        return Some(format!("its name has more than {MOST_DEEP} folders"));
    }
    words.into_iter().find_map(of_word)
}

fn of_word(word: &str) -> Option<String> {
    if word == ".." {
        return Some("its name leads out of the folder".to_owned());
    }
    if word.is_empty() || word == "." {
        return Some("its name has an empty part".to_owned());
    }
    if word.starts_with('.') {
        return Some(
            "a part of its name begins with a dot: what is hidden may steer other programs"
                .to_owned(),
        );
    }
    if word.len() > MOST_WORD {
        return Some(format!("a part of its name is longer than {MOST_WORD} bytes"));
    }
    let odd = |c: &char| c.is_control() || matches!(c, ':' | '<' | '>' | '"' | '|' | '?' | '*');
    if let Some(c) = word.chars().find(odd) {
        return Some(format!("its name has {c:?}, which not every system has in names"));
    }
    if let Some(c) = word.chars().find(is_unseen) {
        return Some(format!(
            "its name has {c:?}, which is not seen or turns letters round, so that it reads as another name"
        ));
    }
    if word.ends_with(['.', ' ']) || word.starts_with(' ') {
        return Some(
            "a part of its name begins or ends with a blank, or ends with a dot".to_owned(),
        );
    }
    let stem = word.split('.').next().unwrap_or(word).trim_end().to_ascii_lowercase();
    is_device(&stem).then(|| format!("its name is that of a device on Windows, {stem}"))
}

/// Marks of direction, and what has no width. Not the joiners, which names in some scripts need.
fn is_unseen(c: &char) -> bool {
    matches!(c,
        // Overrides, embeddings, isolates and marks of direction.
        '\u{61c}' | '\u{200e}' | '\u{200f}' | '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}'
        // Soft hyphen, zero-width space, separators of lines, invisible operators, byte order mark, annotations, tags.
        | '\u{ad}' | '\u{180e}' | '\u{200b}' | '\u{2028}' | '\u{2029}' | '\u{2060}'..='\u{2064}'
        | '\u{206a}'..='\u{206f}' | '\u{feff}' | '\u{fff9}'..='\u{fffb}' | '\u{e0000}'..='\u{e007f}')
}

/// A name as disks compare it on which neither case nor the spelling of a letter counts.
fn folded(name: &str) -> String {
    let large: String = name.nfd().collect::<String>().to_uppercase();
    large.to_lowercase().nfd().collect()
}

fn is_device(stem: &str) -> bool {
    let numbered = stem.strip_prefix("com").or_else(|| stem.strip_prefix("lpt"));
    let is_number = |text: &str| {
        let mut chars = text.chars();
        matches!((chars.next(), chars.next()), (Some('0'..='9' | '¹' | '²' | '³'), None))
    };
    matches!(stem, "con" | "prn" | "aux" | "nul" | "conin$" | "conout$" | "clock$")
        || numbered.is_some_and(is_number)
}

/// The first name that is one with another where neither case nor the spelling of a letter counts, or that is a folder of another, and
/// what is wrong with it.
pub(crate) fn clash<'a>(names: impl Iterator<Item = &'a str>) -> Option<(&'a str, String)> {
    let mut known: BTreeMap<String, &str> = BTreeMap::new();
    for name in names {
        if let Some(other) = known.insert(folded(name), name) {
            let why = match name == other {
                true => "is there twice".to_owned(),
                false if name.nfd().eq(other.nfd()) => {
                    format!(
                        "is the same file as {other} on macOS: both are spelt alike, of other code points"
                    )
                }
                false => format!("is the same file as {other} where case does not count"),
            };
            return Some((name, why));
        }
    }
    known.iter().find_map(|(folded, name)| {
        let folders = folded.match_indices('/').map(|(at, _)| &folded[..at]);
        let file = folders.filter_map(|folder| known.get(folder)).next()?;
        Some((*name, format!("lies in {file}, which is a file")))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_that_lead_elsewhere_on_some_system_are_refused() {
        let good = [
            "a",
            "a.obj",
            "heads/face 1.obj",
            "Köpfe/Ñ-1.png",
            "a/b/c",
            "com",
            "communes.obj",
            "lpt10",
            "مو\u{200c}ها/شانه.obj",
            "e\u{301}.obj",
        ];
        for name in good {
            assert_eq!(fault(name), None, "{name}");
        }
        let deep = ["a"; 17].join("/");
        let long = "a".repeat(121);
        let longer = ["a".repeat(100), "b".repeat(100), "c".repeat(100)].join("/");
        let bad = [
            "",
            ".git/hooks/post-merge",
            "a/.ssh",
            "/a",
            "../a",
            "a/../b",
            "..",
            "./a",
            "a//b",
            "a/",
            "C:/a",
            "c:a",
            "a\\b",
            "..\\a",
            "a\0b",
            "a\nb",
            "con",
            "NUL.txt",
            "heads/Aux.obj",
            "com1",
            "LPT9.x",
            "com¹",
            "nul .txt",
            "a.",
            "a /b",
            " a",
            "a:stream",
            "a?",
            "a*",
            "a\u{202e}jbo.exe",
            "\u{2067}a\u{2069}.obj",
            "heads/a\u{200f}b.obj",
            "a\u{200b}.obj",
            "\u{feff}a.obj",
            "a\u{e0041}.obj",
            &deep,
            &long,
            &longer,
        ];
        for name in bad {
            assert!(fault(name).is_some(), "{name:?}");
        }
    }

    #[test]
    fn two_names_of_one_file_clash() {
        let clashes = |names: &[&str]| clash(names.iter().copied()).is_some();
        assert!(!clashes(&["a", "b", "c/a", "c/b"]));
        for names in [
            ["a", "a"],
            ["a", "A"],
            ["heads/É", "Heads/é"],
            ["a", "a/b"],
            ["A/b", "a"],
            // Composed and put together, as macOS takes for one; also in folders, and where case differs as well.
            ["\u{e9}.obj", "e\u{301}.obj"],
            ["K\u{f6}pfe/a", "Ko\u{308}pfe/a"],
            ["k\u{f6}pfe", "KO\u{308}PFE/a"],
            ["\u{1e69}", "s\u{307}\u{323}"],
            ["\u{ac00}", "\u{1100}\u{1161}"],
            ["\u{212b}", "\u{e5}"],
            ["ΚΟΜΗΣ", "κομης"],
            ["κομης", "κομησ"],
            ["Straße", "STRASSE"],
        ] {
            assert!(clashes(&names), "{names:?}");
        }
        assert!(!clashes(&["e", "é", "E\u{302}", "o"]));
    }
}
