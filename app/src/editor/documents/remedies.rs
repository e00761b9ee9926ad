//! What to do about a file that cannot be read or written, beside why it cannot.

/// Reasons, as `files` words them, and what helps.
const REMEDIES: &[(&str, &str)] = &[
    // It says so itself.
    ("write to another file", ""),
    ("folder does not exist", "make the folder, or choose another"),
    ("folder is a file", "choose a folder"),
    ("folder takes no files", "choose another folder"),
    ("folder may not be written", "choose another folder, or allow writing in this one"),
    ("may not be written", "choose another name or folder, or allow writing it"),
    ("is read-only", "choose another name, or allow writing it"),
    ("disk that is read-only", "choose another disk"),
    ("the disk is full", "make room on it, or choose another disk"),
    ("may not be read", "allow reading it, or choose another file"),
    ("no such file", "it may have been moved or renamed: look for it with Open"),
    ("is a folder", "choose a file"),
    ("is not a file", "choose a file"),
];

/// Why something failed, with what to do about it where that is known, else with what helps in general.
pub(super) fn with_remedy(why: &str, else_: &str) -> String {
    let known = REMEDIES.iter().find(|(reason, _)| why.contains(reason));
    let remedy = known.map_or(else_, |(_, remedy)| remedy);
    let why = why.trim_end_matches('.');
    if remedy.is_empty() { why.to_owned() } else { format!("{why}; {remedy}") }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::files::{read_at_most, write_text};
    use crate::testing::Folder;

    #[test]
    fn every_reason_that_files_give_has_its_remedy() {
        let folder = Folder::new("remedies");
        std::fs::write(folder.path("file"), "").unwrap();
        let written = |name: &str| write_text(&folder.path(name), "").unwrap_err();
        let read = |path: &std::path::Path| read_at_most(path, 9).unwrap_err();
        for (why, remedy) in [
            (written("none/x.ron"), "make the folder"),
            (written("file/x.ron"), "choose a folder"),
            (read(&folder.path("none.ron")), "look for it with Open"),
            ("x: its folder takes no files".to_owned(), "choose another folder"),
            (read(folder.root()), "choose a file"),
            ("x: its folder may not be written".to_owned(), "choose another folder"),
            ("x: the disk is full".to_owned(), "make room"),
        ] {
            let said = with_remedy(&why, "");
            assert!(said.starts_with(&why) && said.contains(remedy), "{said}");
        }
        if cfg!(target_os = "linux") {
            let why = write_text(std::path::Path::new("/proc/nope.ron"), "").unwrap_err();
            assert!(why.contains("its folder takes no files"), "{why}");
        }
        assert_eq!(with_remedy("odd", "try again"), "odd; try again");
    }
}
