//! WGSL by topic, put together by `//#include "x.wgsl"` lines.
//!
//! A file enters once, before its first reader; a table of lines leads from a place in the whole back
//! to its file. Release builds carry the text; with the feature `hot-reload` it is read from the
//! source folder each time.

use std::borrow::Cow;

macro_rules! files {
    ($($name:literal),* $(,)?) => {
        /// Every WGSL file: its name and its text at build time.
        pub(crate) const FILES: &[(&str, &str)] =
            &[$(($name, include_str!(concat!("../wgsl/", $name, ".wgsl")))),*];
    };
}
files![
    "common",
    "density",
    "display",
    "environment",
    "frame",
    "hair",
    "hair_chiang",
    "hair_fibre",
    "hair_kajiya_kay",
    "hair_karis",
    "hair_scatter",
    "opacity",
    "points",
    "shade",
    "shown",
    "skin",
    "solid",
    "solid_maps",
    "splat",
    "visibility_narrow",
    "visibility_wide",
    "volume",
];

/// A shader put together from files.
#[derive(Debug)]
pub(crate) struct Source {
    /// The WGSL.
    pub(crate) text: String,
    /// For each line of `text`: the file and the line in it, from 1.
    lines: Vec<(&'static str, usize)>,
}

impl Source {
    /// Puts a file together with what it includes.
    ///
    /// # Panics
    /// When a file is named that does not exist: a mistake in this crate, found by its tests.
    pub(crate) fn of(name: &str) -> Self {
        let mut source = Source { text: String::new(), lines: vec![] };
        source.add(name, &mut vec![]);
        source
    }

    /// Gives a constant of the shader another value: the line that begins with `const NAME:` ends with it.
    ///
    /// # Panics
    /// When there is no such line: a mistake in this crate, found by its tests.
    pub(crate) fn with(mut self, name: &str, value: &str) -> Self {
        let start = format!("const {name}:");
        let Some(line) = self.text.lines().find(|line| line.starts_with(&start)) else {
            panic!("there is no constant {name}")
        };
        let declared = line.split('=').next().unwrap_or(line);
        self.text = self.text.replacen(line, &format!("{declared}= {value};"), 1);
        self
    }

    fn add(&mut self, name: &str, seen: &mut Vec<&'static str>) {
        let Some((name, text)) = FILES.iter().find(|(file, _)| *file == name) else {
            panic!("there is no shader file {name:?}")
        };
        if seen.contains(name) {
            return;
        }
        seen.push(name);
        let text = current(name, text);
        for (number, line) in text.lines().enumerate() {
            match line.strip_prefix("//#include \"").and_then(|l| l.strip_suffix(".wgsl\"")) {
                Some(included) => self.add(included, seen),
                None => {
                    self.text.push_str(line);
                    self.text.push('\n');
                    self.lines.push((name, number + 1));
                }
            }
        }
    }

    /// The file and line that a line of the whole (from 1) came from.
    #[cfg_attr(not(any(test, feature = "hot-reload")), expect(dead_code, reason = "for messages"))]
    pub(crate) fn place(&self, line: usize) -> String {
        match self.lines.get(line.wrapping_sub(1)) {
            Some((file, line)) => format!("{file}.wgsl:{line}"),
            None => "past the end".to_owned(),
        }
    }
}

/// Whether the files as they are now are all valid.
#[cfg(feature = "hot-reload")]
pub(crate) fn check() -> Result<(), String> {
    use wgpu::naga;
    for (name, _) in FILES.iter().filter(|(name, _)| *name != "splat") {
        let source = Source::of(name);
        let module = naga::front::wgsl::parse_str(&source.text).map_err(|err| {
            let line = err.location(&source.text).map_or(0, |l| l.line_number as usize);
            format!("{}: {}", source.place(line), err.message())
        })?;
        naga::valid::Validator::new(Default::default(), naga::valid::Capabilities::all())
            .validate(&module)
            .map_err(|err| format!("{name}.wgsl: {}", err.emit_to_string(&source.text)))?;
    }
    Ok(())
}

#[cfg(not(feature = "hot-reload"))]
fn current(_: &str, built_in: &'static str) -> Cow<'static, str> {
    Cow::Borrowed(built_in)
}

#[cfg(feature = "hot-reload")]
fn current(name: &str, built_in: &'static str) -> Cow<'static, str> {
    let path = format!("{}/wgsl/{name}.wgsl", env!("CARGO_MANIFEST_DIR"));
    std::fs::read_to_string(path).map_or(Cow::Borrowed(built_in), Cow::Owned)
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use wgpu::naga;

    /// The module of a file, validated; panics with the file and line of what is wrong.
    pub(crate) fn module(name: &str) -> naga::Module {
        let source = Source::of(name);
        let module = naga::front::wgsl::parse_str(&source.text).unwrap_or_else(|err| {
            let line = err.location(&source.text).map_or(0, |l| l.line_number as usize);
            panic!("{}: {}", source.place(line), err.emit_to_string(&source.text))
        });
        let capabilities = naga::valid::Capabilities::default()
            | naga::valid::Capabilities::SHADER_INT64
            | naga::valid::Capabilities::SHADER_INT64_ATOMIC_MIN_MAX
            | naga::valid::Capabilities::SHADER_FLOAT16_IN_FLOAT32;
        naga::valid::Validator::new(naga::valid::ValidationFlags::all(), capabilities)
            .validate(&module)
            .unwrap_or_else(|err| panic!("{name}: {}", err.emit_to_string(&source.text)));
        module
    }

    #[test]
    fn every_shader_is_valid() {
        // `splat` asks whoever includes it for a function, and is tested with them.
        for (name, _) in FILES.iter().filter(|(name, _)| *name != "splat") {
            module(name);
        }
    }

    #[test]
    fn every_file_in_the_folder_is_listed_and_says_what_it_is() {
        let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/wgsl");
        for entry in std::fs::read_dir(folder).unwrap().flatten() {
            let file = entry.file_name().to_string_lossy().into_owned();
            let name = file.strip_suffix(".wgsl").unwrap_or(&file);
            let (_, text) = FILES.iter().find(|(n, _)| *n == name).expect(&file);
            assert!(text.starts_with("// "), "{file} does not open with what it is");
        }
    }
}
