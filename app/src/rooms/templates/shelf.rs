//! What stands on the shelf of templates: read on a thread, each file once until it changes.
//!
//! Guarantees: the window waits for no file; a file whose time and size are as they were is not read again; what is no template is listed
//! with its reason; documents are not kept, but what is said of them and their small pictures.

use crate::core::templates::{Broken, Listed, ShelfRow};
use crate::library::{self, LibraryEntry};
use coif_graphs::document::Origin;
use coif_graphs::{grooms, template};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::SystemTime;

/// When and how large a file was.
type Stamp = (Option<SystemTime>, u64);

/// What was read, by file.
#[derive(Default)]
struct Known {
    shipped: Vec<ShelfRow>,
    files: BTreeMap<PathBuf, (Stamp, ShelfRow)>,
}

/// The shelf: what is on it, and a thread that looks where somebody asked for it.
#[derive(Default)]
pub(crate) struct Shelf {
    shared: Arc<Mutex<Shared>>,
}

#[derive(Default)]
struct Shared {
    rows: Arc<Vec<ShelfRow>>,
    known: Known,
    is_looking: bool,
    /// Somebody asked again meanwhile.
    again: Option<Vec<(String, PathBuf)>>,
    has_looked: bool,
    /// Files that were read since the beginning.
    reads: usize,
}

impl Shelf {
    fn lock(&self) -> std::sync::MutexGuard<'_, Shared> {
        self.shared.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// What was found when it was looked last.
    pub(crate) fn rows(&self) -> Arc<Vec<ShelfRow>> {
        self.lock().rows.clone()
    }

    /// Whether nothing was found yet because nobody has looked to the end.
    pub(crate) fn is_new(&self) -> bool {
        !self.lock().has_looked
    }

    /// Files that were read since the beginning.
    #[cfg(test)]
    pub(crate) fn reads(&self) -> usize {
        self.lock().reads
    }

    /// Whether a thread looks now.
    pub(crate) fn is_looking(&self) -> bool {
        self.lock().is_looking
    }

    /// Looks what is in folders, named as people know them, on a thread; `wake` is called when that is known.
    pub(crate) fn look(
        &self,
        folders: Vec<(String, PathBuf)>,
        wake: impl Fn() + Send + Sync + 'static,
    ) {
        let mut shared = self.lock();
        if shared.is_looking {
            shared.again = Some(folders);
            return;
        }
        shared.is_looking = true;
        let mut known = std::mem::take(&mut shared.known);
        drop(shared);
        let to = self.shared.clone();
        let shelf = Self { shared: self.shared.clone() };
        let looking = std::thread::Builder::new().name("templates".to_owned()).spawn(move || {
            let mut folders = folders;
            if known.shipped.is_empty() {
                known.shipped = shipped();
                // These are there at once; folders take their time.
                let mut rows = known.shipped.clone();
                sort(&mut rows);
                to.lock().unwrap_or_else(PoisonError::into_inner).rows = Arc::new(rows);
                wake();
            }
            loop {
                let (rows, reads) = looked(&folders, &mut known);
                let mut shared = to.lock().unwrap_or_else(PoisonError::into_inner);
                shared.rows = Arc::new(rows);
                shared.reads += reads;
                shared.has_looked = true;
                match shared.again.take() {
                    Some(again) => folders = again,
                    None => {
                        shared.known = known;
                        shared.is_looking = false;
                        break;
                    }
                }
            }
            wake();
        });
        if looking.is_err() {
            shelf.lock().is_looking = false;
        }
    }
}

/// What comes with coif.
fn shipped() -> Vec<ShelfRow> {
    let row = |(name, text): &(&str, &str)| {
        row(library::shipped(text), Path::new(name), "comes with coif")
    };
    grooms::TEMPLATES.iter().map(row).collect()
}

/// By title, the newest version first; what is broken stands at the end.
fn sort(rows: &mut [ShelfRow]) {
    rows.sort_by(|a, b| match (a, b) {
        (ShelfRow::Found(a), ShelfRow::Found(b)) => {
            let title = a.title.to_lowercase().cmp(&b.title.to_lowercase());
            title.then_with(|| library::by_version(&b.origin.version, &a.origin.version))
        }
        (ShelfRow::Broken(a), ShelfRow::Broken(b)) => a.path.cmp(&b.path),
        (ShelfRow::Found(_), ShelfRow::Broken(_)) => std::cmp::Ordering::Less,
        (ShelfRow::Broken(_), ShelfRow::Found(_)) => std::cmp::Ordering::Greater,
    });
}

/// All rows, and how many files were read for them.
fn looked(folders: &[(String, PathBuf)], known: &mut Known) -> (Vec<ShelfRow>, usize) {
    let (mut rows, mut reads) = (known.shipped.clone(), 0);
    let mut files = BTreeMap::new();
    for (place, folder) in folders {
        for path in library::files(folder) {
            let about = std::fs::metadata(&path).ok();
            let stamp = about.map_or((None, 0), |it| (it.modified().ok(), it.len()));
            let row = match known.files.remove(&path) {
                Some((was, row)) if was == stamp => row,
                _ => {
                    reads += 1;
                    row(library::read(&path), &path, place)
                }
            };
            files.insert(path, (stamp, row.clone()));
            rows.push(hidden(&rows, row));
        }
    }
    known.files = files;
    sort(&mut rows);
    (rows, reads)
}

/// Of one name and version the first counts: another is told with what stands before it.
fn hidden(before: &[ShelfRow], row: ShelfRow) -> ShelfRow {
    let ShelfRow::Found(new) = &row else { return row };
    let same = before.iter().find_map(|row| match row {
        ShelfRow::Found(it)
            if it.origin.name == new.origin.name && it.origin.version == new.origin.version =>
        {
            Some(it)
        }
        _ => None,
    });
    let (Some(first), Some(path)) = (same, &new.path) else { return row };
    let Origin { name, version, .. } = &new.origin;
    let whose = first.path.as_ref().map_or("coif".to_owned(), |path| path.display().to_string());
    let why =
        format!("{name} {version} is taken from {whose}: give this one another name or version");
    Broken::row(path, &new.place, why)
}

fn row(read: Result<LibraryEntry, String>, path: &Path, place: &str) -> ShelfRow {
    match read {
        Ok(entry) => ShelfRow::Found(listed(entry, place).into()),
        Err(why) => Broken::row(path, place, why),
    }
}

fn listed(entry: LibraryEntry, place: &str) -> Listed {
    let LibraryEntry { origin, title, description, hash, path, document } = entry;
    let group = template::group_of(&document).ok();
    let def = group.and_then(|group| document.def(group));
    let wired =
        |ty| matches!(ty, coif_nodes::define::Type::Curves | coif_nodes::define::Type::Scalp);
    let inputs = def.map_or(&[][..], |def| def.inputs).iter().filter(|input| wired(input.ty));
    let takes: Vec<String> = inputs.map(|input| input.name.replace('_', " ")).collect();
    let takes = takes.join(", ");
    let thumbnail = document.thumbnail;
    let place = place.to_owned();
    let Origin { name, version, author, tags, source, .. } = &origin;
    let tags = tags.join(" ");
    let all = [&title, name, &description, author, &tags, source, version, &place];
    let said = all.map(|text| text.to_lowercase()).join("\n");
    Listed { origin, title, description, hash, takes, place, thumbnail, path, said }
}
