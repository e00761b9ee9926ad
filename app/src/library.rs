//! The library of templates: those that come with coif, a person's own, and those of shows.
//!
//! Folders are searched in order: what comes with coif, `templates` of the settings folder, then each folder of
//! `COIF_TEMPLATES`. Of one name and version the first counts. A file that is no template, or that this version
//! cannot read in full, is told and left out; it never hides the others. Folders are not searched within.

pub(crate) mod bake;
pub(crate) mod fitted;
pub(crate) mod new;

use crate::places::Places;
use coif_graphs::document::graph::{Severity, check};
use coif_graphs::document::{Document, Origin};
use coif_graphs::{file, grooms, template};
use coif_nodes::data::landmarks::Landmarks;
use std::cmp::Ordering;
use std::path::{Path, PathBuf};

/// One template.
pub(crate) struct LibraryEntry {
    /// What it says of itself.
    pub(crate) origin: Origin,
    /// What people call it.
    pub(crate) title: String,
    /// What is said of it.
    pub(crate) description: String,
    /// The hash of what it means.
    pub(crate) hash: String,
    /// Its file; none where it comes with coif.
    pub(crate) path: Option<PathBuf>,
    /// All of it.
    pub(crate) document: Document,
}

impl LibraryEntry {
    /// The template drawn for a head with the landmarks `here`; as it is, where these are not known.
    pub(crate) fn fitted(&self, here: Option<&Landmarks>) -> Document {
        let template = self.document.clone();
        match here {
            Some(here) => fitted::fitted(template, here),
            None => template,
        }
    }

    /// Whether the template, as it was fitted, is another one inside.
    pub(crate) fn is_changed_in(&self, fitted: &Document) -> bool {
        template::group_of(fitted).is_ok_and(|group| template::hash(fitted, group) != self.hash)
    }
}

/// The most files of a folder that are looked at.
const MOST_FILES: usize = 4096;
/// The largest template that is read, bytes.
const MOST_BYTES: u64 = 16 << 20;

/// The folder of a person's own templates.
pub(crate) fn own(places: &Places) -> PathBuf {
    places.config.join("templates")
}

/// Folders that are searched, in order: a person's own, and those of shows.
pub(crate) fn folders(places: &Places) -> Vec<PathBuf> {
    let shows = std::env::var_os("COIF_TEMPLATES").unwrap_or_default();
    let shows = std::env::split_paths(&shows).filter(|path| !path.as_os_str().is_empty());
    std::iter::once(own(places)).chain(shows).collect()
}

/// What people call a folder of that number: their own, or a show's by its name.
#[cfg(feature = "editor")]
pub(crate) fn called(number: usize, folder: &Path) -> String {
    match (number, folder.file_name()) {
        (0, _) => "your own".to_owned(),
        (_, Some(name)) => name.to_string_lossy().into_owned(),
        (_, None) => folder.display().to_string(),
    }
}

/// Every template that is found, and what is wrong with files that are none.
pub(crate) fn all() -> (Vec<LibraryEntry>, Vec<String>) {
    in_folders(&folders(&Places::here()))
}

fn in_folders(folders: &[PathBuf]) -> (Vec<LibraryEntry>, Vec<String>) {
    let (mut found, mut wrong) = (vec![], vec![]);
    let mut add = |read: Result<LibraryEntry, String>, shown: &str| match read {
        Ok(entry) => {
            let same = |known: &LibraryEntry| {
                known.origin.name == entry.origin.name
                    && known.origin.version == entry.origin.version
            };
            if !found.iter().any(same) {
                found.push(entry);
            }
        }
        Err(why) => wrong.push(format!("{shown}: {why}")),
    };
    for (name, text) in grooms::TEMPLATES {
        add(shipped(text), name);
    }
    for folder in folders {
        let all = files(folder);
        for path in &all {
            add(read(path), &path.display().to_string());
        }
    }
    wrong.extend(folders.iter().filter_map(|folder| fault(folder)));
    (found, wrong)
}

/// A template that comes with coif, from its text.
///
/// # Errors
/// It is none.
pub(crate) fn shipped(text: &str) -> Result<LibraryEntry, String> {
    of_text(text.as_bytes(), None)
}

/// The first [`MOST_FILES`] `.ron` files of a folder by name; none where there is no such folder.
pub(crate) fn files(folder: &Path) -> Vec<PathBuf> {
    let all = std::fs::read_dir(folder).into_iter().flatten().flatten();
    let mut all: Vec<PathBuf> = all
        .map(|entry| entry.path())
        .filter(|path| path.extension().is_some_and(|it| it == "ron") && path.is_file())
        .take(MOST_FILES + 1)
        .collect();
    all.sort();
    all.truncate(MOST_FILES);
    all
}

/// What is wrong with a folder of templates that somebody named: it is none, or not all of it is read.
fn fault(folder: &Path) -> Option<String> {
    let shown = folder.display();
    match std::fs::read_dir(folder) {
        // A person's own folder is made when something is put into it.
        Err(err)
            if err.kind() == std::io::ErrorKind::NotFound && *folder == own(&Places::here()) =>
        {
            None
        }
        Err(err) => Some(format!("{shown}: {err}; see COIF_TEMPLATES")),
        Ok(_) => (files(folder).len() == MOST_FILES)
            .then(|| format!("{shown}: has more templates than are read, {MOST_FILES}")),
    }
}

/// A template from its file.
///
/// # Errors
/// It cannot be read, or is no template.
pub(crate) fn read(path: &Path) -> Result<LibraryEntry, String> {
    let about = std::fs::metadata(path).map_err(|err| err.to_string())?;
    if !about.is_file() || about.len() > MOST_BYTES {
        return Err("is no file of at most 16 MiB, as templates are".to_owned());
    }
    of_text(&std::fs::read(path).map_err(|err| err.to_string())?, Some(path.to_owned()))
}

/// A template from its text.
///
/// # Errors
/// It is none.
pub(crate) fn of_text(bytes: &[u8], path: Option<PathBuf>) -> Result<LibraryEntry, String> {
    let loaded = file::read_bytes(bytes).map_err(|err| err.to_string())?;
    // A template of which something would be left out is another template.
    if let Some(said) = loaded.conflicts.first().or(loaded.warnings.first()) {
        return Err(said.to_string());
    }
    let document = loaded.document;
    let group = template::group_of(&document)?.clone();
    let problems = check(&document);
    if let Some(problem) = problems.iter().find(|problem| problem.severity == Severity::Error) {
        return Err(problem.to_string());
    }
    let node = document.node(group.as_str()).ok_or("the group is gone")?;
    let origin = node.template.as_deref().cloned().unwrap_or_default();
    if origin.name.is_empty() {
        return Err("the template has no name".to_owned());
    }
    let (title, description) = (document.name_of(&group).into_owned(), node.note.clone());
    Ok(LibraryEntry {
        hash: template::hash(&document, &group),
        origin,
        title,
        description,
        path,
        document,
    })
}

/// The template that a person names: a file, or a name of the library, with `@version` where it is not to be the newest.
///
/// # Errors
/// There is none.
pub(crate) fn find(named: &str) -> Result<LibraryEntry, String> {
    let path = Path::new(named);
    if path.is_file() {
        return read(path).map_err(|why| format!("{named}: {why}"));
    }
    let (name, version) = named.split_once('@').map_or((named, None), |(name, v)| (name, Some(v)));
    let (all, _) = all();
    let known: Vec<String> = all.iter().map(|entry| entry.origin.name.clone()).collect();
    let fits = |entry: &LibraryEntry| {
        entry.origin.name == name && version.is_none_or(|version| entry.origin.version == version)
    };
    let newest = all.into_iter().filter(fits).reduce(|a, b| {
        if by_version(&b.origin.version, &a.origin.version) == Ordering::Greater { b } else { a }
    });
    newest.ok_or_else(|| format!("there is no template {named:?}; there are {}", known.join(", ")))
}

/// Versions as people count them: part by part, numbers as numbers.
pub(crate) fn by_version(a: &str, b: &str) -> Ordering {
    let parts = |text: &str| -> Vec<Result<u64, String>> {
        text.split('.').map(|part| part.parse().map_err(|_| part.to_owned())).collect()
    };
    let (a, b) = (parts(a), parts(b));
    for (a, b) in a.iter().zip(&b) {
        let order = match (a, b) {
            (Ok(a), Ok(b)) => a.cmp(b),
            // 1.0 comes after 1.beta.
            (Ok(_), Err(_)) => Ordering::Greater,
            (Err(_), Ok(_)) => Ordering::Less,
            (Err(a), Err(b)) => a.cmp(b),
        };
        if order != Ordering::Equal {
            return order;
        }
    }
    a.len().cmp(&b.len())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn versions_are_counted_part_by_part() {
        let mut all = ["1.10", "1.2", "1.beta", "2", "1.2.1", ""];
        all.sort_by(|a, b| by_version(a, b));
        assert_eq!(all, ["", "1.beta", "1.2", "1.2.1", "1.10", "2"]);
    }

    #[test]
    fn at_least_ten_templates_come_with_coif_each_as_it_would_be_saved() {
        let (all, wrong) = in_folders(&[]);
        assert_eq!(wrong, Vec::<String>::new());
        assert!(all.len() >= 10, "{}", all.len());
        for (entry, (name, text)) in all.iter().zip(grooms::TEMPLATES) {
            assert_eq!(entry.origin.name, *name);
            assert_eq!(entry.origin.hash, entry.hash, "{name}: its mark is not its hash");
            assert!(!entry.description.is_empty() && !entry.origin.licence.is_empty(), "{name}");
            assert_eq!(file::write(&entry.document), *text, "{name}: coif fmt it");
            let problems = coif_graphs::document::graph::check(&entry.document);
            assert!(problems.is_empty(), "{name}: {problems:?}");
        }
    }

    #[test]
    fn a_template_that_is_not_read_in_full_is_refused_with_what_would_be_left_out() {
        let text = |default: &str| {
            format!(
                "(format: 3, nodes: {{\"g\": (kind: \"group\", template: (name: \"g\"), interface: (inputs: [\
                 (name: \"a\", type: \"number\", default: {default})]))}})"
            )
        };
        assert!(of_text(text("1.0").as_bytes(), None).is_ok());
        let why = of_text(text("NaN").as_bytes(), None).err().unwrap_or_default();
        assert!(why.contains("port a: its default NaN"), "{why}");
    }
}
