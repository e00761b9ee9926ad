//! Names of materials and parts, numbered in the order triangles first use them.

use std::collections::BTreeMap;

/// Stands for "no name" where other triangles of the mesh have one.
pub(crate) const NAMELESS: &str = "(none)";

/// Bytes of a name that are kept. Longer ones come from no program, and comparing them would take
/// long.
const LONGEST: usize = 1024;

/// Bytes a new name costs beside its own text, at most: two strings, an entry in the list (which
/// grows by doubling) and one in the map.
const BYTES_PER_NAME: u64 = 160;

/// A list of different names and the way back from a name to its number.
#[derive(Debug, Default)]
pub(crate) struct NameTable {
    list: Vec<String>,
    numbers: BTreeMap<String, u32>,
}

impl NameTable {
    /// Bytes that adding a name costs at most.
    pub(crate) fn memory(name_bytes: usize) -> u64 {
        BYTES_PER_NAME + 3 * name_bytes.min(LONGEST) as u64
    }

    /// A name, or as much of it as is kept.
    pub(crate) fn cut(name: &str) -> String {
        name[..name.floor_char_boundary(LONGEST)].to_owned()
    }

    /// The number of a name, which is added if it is new.
    pub(crate) fn number(&mut self, name: &str) -> u32 {
        let name = &name[..name.floor_char_boundary(LONGEST)];
        if let Some(number) = self.numbers.get(name) {
            return *number;
        }
        let number = self.list.len() as u32;
        self.list.push(name.to_owned());
        self.numbers.insert(name.to_owned(), number);
        number
    }

    /// The list, and the column that goes with it: both empty if no triangle has a name.
    pub(crate) fn into_columns(self, number_of: Vec<u32>) -> (Vec<String>, Vec<u32>) {
        if self.list.iter().all(|name| name == NAMELESS) {
            return (Vec::new(), Vec::new());
        }
        (self.list, number_of)
    }
}
