//! Small files of the program's own: settings, layout, recent files. RON, written whole or not at all.
//!
//! What is missing has its default. A damaged file never keeps the program from starting: it is set aside beside itself as
//! `.bad`, and somebody is told.

use crate::files::{set_aside, write_text};
use serde::Serialize;
use serde::de::DeserializeOwned;
use std::io::Read;
use std::path::Path;

/// A larger file is none of ours.
const MOST_BYTES: u64 = 4 << 20;

/// What a file says, and what to tell when it could not be used. A file that is not there is no trouble.
pub(crate) fn load<T: DeserializeOwned + Default>(path: &Path) -> (T, Option<String>) {
    let (read, told) = load_with(path, |text| ron::from_str(text).map_err(|err| err.to_string()));
    (read.unwrap_or_default(), told)
}

/// The same for a file that is read in another way; none where there is nothing to be used.
pub(crate) fn load_with<T>(
    path: &Path,
    read: impl FnOnce(&str) -> Result<T, String>,
) -> (Option<T>, Option<String>) {
    let mut text = String::new();
    let file = match std::fs::File::open(path) {
        Ok(file) => file,
        Err(err) if err.kind() == std::io::ErrorKind::NotFound => return (None, None),
        Err(err) => return (None, Some(format!("{}: {err}", path.display()))),
    };
    let damage = match file.take(MOST_BYTES + 1).read_to_string(&mut text) {
        Err(err) if err.kind() == std::io::ErrorKind::InvalidData => "is no text".to_owned(),
        Err(err) => return (None, Some(format!("{}: {err}", path.display()))),
        Ok(_) if text.len() as u64 > MOST_BYTES => "is too large".to_owned(),
        Ok(_) => match read(&text) {
            Ok(value) => return (Some(value), None),
            Err(why) => why,
        },
    };
    let kept = match set_aside(path) {
        Ok(aside) => format!("it was kept as {}", aside.display()),
        Err(err) => format!("it could not be set aside: {err}"),
    };
    (None, Some(format!("{}: {damage}; defaults are used, {kept}", path.display())))
}

/// Writes a file, and its folder where there is none.
pub(crate) fn store<T: Serialize>(path: &Path, value: &T) -> Result<(), String> {
    let style = ron::ser::PrettyConfig::default();
    let text = ron::ser::to_string_pretty(value, style)
        .map_err(|err| format!("{}: {err}", path.display()))?;
    store_text(path, &(text + "\n"))
}

/// The same for text.
pub(crate) fn store_text(path: &Path, text: &str) -> Result<(), String> {
    let said = |reason: String| format!("{}: {reason}", path.display());
    if let Some(folder) = path.parent() {
        std::fs::create_dir_all(folder).map_err(|err| said(err.to_string()))?;
    }
    write_text(path, text).map_err(said)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::Folder;
    use std::collections::BTreeMap;

    type Words = BTreeMap<String, u32>;

    #[test]
    fn what_was_stored_is_loaded() {
        let folder = Folder::new("kept");
        let path = folder.path("deeper/words.ron");
        let words = Words::from([("é \"quoted\"".to_owned(), 1), (String::new(), 2)]);
        store(&path, &words).unwrap();
        assert_eq!(load::<Words>(&path), (words, None));
        assert_eq!(load::<Words>(&folder.path("none.ron")), (Words::new(), None));
    }

    #[test]
    fn a_damaged_file_is_told_set_aside_and_never_fatal() {
        let folder = Folder::new("kept-bad");
        let deep = "(".repeat(100_000);
        let large = " ".repeat(MOST_BYTES as usize + 1);
        for (i, text) in [&b"{\"a\": }"[..], b"\xff\xfe", b"", deep.as_bytes(), large.as_bytes()]
            .iter()
            .enumerate()
        {
            let path = folder.path(&format!("{i}.ron"));
            std::fs::write(&path, text).unwrap();
            let (words, told) = load::<Words>(&path);
            assert_eq!(words, Words::new());
            let told = told.unwrap();
            assert!(told.contains("defaults are used, it was kept as"), "{told}");
            assert_eq!(std::fs::read(folder.path(&format!("{i}.ron.bad"))).unwrap(), *text);
            assert_eq!(load::<Words>(&path), (Words::new(), None));
        }
        std::fs::create_dir(folder.path("folder.ron")).unwrap();
        assert!(load::<Words>(&folder.path("folder.ron")).1.is_some());
    }
}
