//! The layers of a stage: which files they are, read once each.
//!
//! Asset paths are taken as beside the layer that names them. What lies outside the folder of the file that was opened (or outside
//! its package) is never asked for, whatever a path says; nor are URLs, absolute paths and variables.

use super::super::super::FormatError;
use super::budget::ReadBudget;
use super::tree::ParsedLayer;
use super::{crate_file, package, text};
use std::collections::BTreeMap;

/// The most layers of a stage.
const MOST_LAYERS: usize = 1000;

/// Gives the bytes of a file by its path from the folder of the file that was opened, with `/` between names and no `..`; or says
/// why it does not.
pub type Beside<'a> = &'a mut dyn FnMut(&str) -> Result<Vec<u8>, String>;

/// Where a layer lies.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct Name {
    /// The package that it is in, from the folder.
    package: Option<String>,
    /// From the folder, or from the root of the package.
    path: String,
}

pub(super) struct Layers<'a> {
    beside: Beside<'a>,
    /// Bytes and name of the file that was opened.
    opened: (&'a [u8], &'a str),
    loaded: Vec<(Name, ParsedLayer)>,
    known: BTreeMap<Name, Result<usize, String>>,
    packages: BTreeMap<String, Vec<u8>>,
}

impl<'a> Layers<'a> {
    /// Reads the layer that a file opens with, which gets the number 0.
    pub(super) fn open(
        bytes: &'a [u8],
        file_name: &'a str,
        beside: Beside<'a>,
        budget: &mut ReadBudget,
    ) -> Result<Self, FormatError> {
        let (name, content) = if package::is_package(bytes) {
            let (path, content) = package::root_layer(bytes)?;
            (Name { package: Some(file_name.to_owned()), path }, content)
        } else {
            (Name { package: None, path: file_name.to_owned() }, bytes)
        };
        let layer = parsed(content, budget)?;
        let known = BTreeMap::from([(name.clone(), Ok(0))]);
        let opened = (bytes, file_name);
        let loaded = vec![(name, layer)];
        Ok(Self { beside, opened, loaded, known, packages: BTreeMap::new() })
    }

    pub(super) fn layer(&self, number: usize) -> &ParsedLayer {
        &self.loaded[number].1
    }

    pub(super) fn layer_mut(&mut self, number: usize) -> &mut ParsedLayer {
        &mut self.loaded[number].1
    }

    /// The number of the layer that `asset` names in the layer `from`, or why it is not read.
    pub(super) fn find(
        &mut self,
        from: usize,
        asset: &str,
        budget: &mut ReadBudget,
    ) -> Result<usize, String> {
        let name = named(&self.loaded[from].0, asset)?;
        if let Some(known) = self.known.get(&name) {
            return known.clone();
        }
        let found = self.read(&name, budget).map(|layer| {
            self.loaded.push((name.clone(), layer));
            self.loaded.len() - 1
        });
        self.known.insert(name, found.clone());
        found
    }

    fn read(&mut self, name: &Name, budget: &mut ReadBudget) -> Result<ParsedLayer, String> {
        if self.loaded.len() >= MOST_LAYERS {
            return Err(format!("more than {MOST_LAYERS} layers are not read"));
        }
        let layer = match &name.package {
            Some(package) => {
                let bytes = if package == self.opened.1 {
                    self.opened.0
                } else {
                    if !self.packages.contains_key(package) {
                        let bytes = (self.beside)(package)?;
                        budget.allow_for_file(bytes.len());
                        self.packages.insert(package.clone(), bytes);
                    }
                    self.packages.get(package).map_or(&[][..], Vec::as_slice)
                };
                let content = if name.path.is_empty() {
                    package::root_layer(bytes).map_err(|error| error.to_string())?.1
                } else {
                    package::find(bytes, &name.path)?
                };
                parsed(content, budget)
            }
            None => {
                let bytes = (self.beside)(&name.path)?;
                budget.allow_for_file(bytes.len());
                parsed(&bytes, budget)
            }
        };
        layer.map_err(|error| error.to_string())
    }
}

fn parsed(bytes: &[u8], budget: &mut ReadBudget) -> Result<ParsedLayer, FormatError> {
    let mut layer = if bytes.starts_with(crate_file::MAGIC) {
        crate_file::read(bytes, budget)?
    } else if bytes.starts_with(text::MAGIC) {
        text::read(bytes, budget)?
    } else {
        return Err(FormatError::at("byte 0", "neither #usda nor a crate file begins here"));
    };
    layer.index(budget)?;
    Ok(layer)
}

/// What the layer that `asset` names in the layer `from` is called.
fn named(from: &Name, asset: &str) -> Result<Name, String> {
    let is_absolute = asset.starts_with(['/', '\\']) || asset.get(1..2) == Some(":");
    if is_absolute || asset.contains("://") {
        return Err("only files beside the one that was opened, or below it, are read".to_owned());
    }
    if asset.contains("${") || asset.starts_with('`') || asset.contains(":SDF_FORMAT_ARGS:") {
        return Err("variables and arguments in paths are not resolved".to_owned());
    }
    let (asset, inside) = match asset.split_once('[') {
        Some((asset, inside)) => (asset, inside.strip_suffix(']')),
        None => (asset, None),
    };
    let mut names: Vec<&str> = from.path.split('/').collect();
    names.pop();
    for name in asset.split('/') {
        match name {
            "" | "." => {}
            ".." => {
                let outside = "it lies outside the folder or package that was opened";
                names.pop().ok_or_else(|| outside.to_owned())?;
            }
            name => names.push(name),
        }
    }
    let path = names.join("/");
    let is_package = path.to_ascii_lowercase().ends_with(".usdz");
    match (&from.package, is_package) {
        (Some(_), true) => Err("packages in packages are not read".to_owned()),
        (Some(package), false) => Ok(Name { package: Some(package.clone()), path }),
        (None, true) => {
            Ok(Name { package: Some(path), path: inside.unwrap_or_default().to_owned() })
        }
        (None, false) => Ok(Name { package: None, path }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn assets_lie_beside_their_layer_and_never_outside() {
        let check = |from: &str, asset: &str, expected: Option<&str>| {
            let from = Name { package: None, path: from.to_owned() };
            assert_eq!(named(&from, asset).ok().map(|name| name.path).as_deref(), expected);
        };
        check("a.usda", "b.usda", Some("b.usda"));
        check("a.usda", "./b/../c/d.usda", Some("c/d.usda"));
        check("parts/a.usda", "../b.usda", Some("b.usda"));
        check("parts/a.usda", "../../b.usda", None);
        for outside in ["../b.usda", "/etc/b.usda", "C:\\b.usda", "http://x/b.usda", "b/../../c"] {
            check("a.usda", outside, None);
        }
        check("a.usda", "b_${WHO}.usda", None);
    }
}
