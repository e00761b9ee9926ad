//! Which names files may have in a pack: those that lead to the same place, below a folder, on every system.
//!
//! A name is words with slashes between them. Guaranteed of a set of names without a fault: none leads out of the folder it is put
//! in, none is a device, and no two are one file where case does not count. Not looked at: that two spellings of one letter
//! (composed, and put together of parts) are one file on some disks.

use std::collections::BTreeMap;

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
    if word.ends_with(['.', ' ']) || word.starts_with(' ') {
        return Some(
            "a part of its name begins or ends with a blank, or ends with a dot".to_owned(),
        );
    }
    let stem = word.split('.').next().unwrap_or(word).trim_end().to_ascii_lowercase();
    is_device(&stem).then(|| format!("its name is that of a device on Windows, {stem}"))
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

/// The first name that is one with another where case does not count, or that is a folder of another, and what is wrong with it.
pub(crate) fn clash<'a>(names: impl Iterator<Item = &'a str>) -> Option<(&'a str, String)> {
    let mut known: BTreeMap<String, &str> = BTreeMap::new();
    for name in names {
        if let Some(other) = known.insert(name.to_lowercase(), name) {
            let why = match name == other {
                true => "is there twice".to_owned(),
                false => format!("is the same file as {other} where case does not count"),
            };
            return Some((name, why));
        }
    }
    known.iter().find_map(|(lower, name)| {
        let folders = lower.match_indices('/').map(|(at, _)| &lower[..at]);
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
        for names in [["a", "a"], ["a", "A"], ["heads/É", "Heads/é"], ["a", "a/b"], ["A/b", "a"]]
        {
            assert!(clashes(&names), "{names:?}");
        }
    }
}
