//! Names of materials and parts, numbered in the order triangles first use them.

use std::collections::BTreeMap;

/// Stands for "no name" where other triangles of the mesh have one.
pub(crate) const NAMELESS: &str = "(none)";

/// A list of different names and the way back from a name to its number.
#[derive(Debug, Default)]
pub(crate) struct Names {
    list: Vec<String>,
    numbers: BTreeMap<String, u32>,
}

impl Names {
    /// The number of a name, which is added if it is new.
    pub(crate) fn number(&mut self, name: &str) -> u32 {
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
