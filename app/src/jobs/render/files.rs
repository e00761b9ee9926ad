//! The files of pictures: their formats by their endings, and names with a place for what tells several apart. Each mistake is one line
//! that says what can be written instead.

use crate::files::extension_of;
use crate::jobs::stop::Stop;
use std::path::{Path, PathBuf};

/// What a picture is written as.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Format {
    /// 8 bits a channel, for a display.
    Png,
    /// Scene-linear floats.
    Exr,
}

impl Format {
    /// All of them: what their files end in.
    pub(crate) const ALL: [(&'static str, Self); 2] = [("png", Self::Png), ("exr", Self::Exr)];

    /// The format of a file, by its ending.
    fn of(path: &Path) -> Option<Self> {
        let ending = extension_of(path);
        Self::ALL.into_iter().find(|(known, _)| *known == ending).map(|(_, format)| format)
    }
}

/// How many pictures are drawn, and what tells their files apart.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Series {
    /// One picture.
    One,
    /// A turntable, by number.
    Turntable,
    /// Several cameras, by name.
    Cameras,
}

/// The formats of the files to write; their names hold a number exactly when there is a turntable, and `%s`, which any may hold,
/// when there are several cameras.
pub(crate) fn formats(out: &[PathBuf], series: Series) -> Result<Vec<Format>, Stop> {
    if out.is_empty() {
        return Err(Stop::refused("--out FILE is needed: a picture is written as .png or .exr"));
    }
    out.iter()
        .map(|path| {
            let fault = |reason: &str| Stop::refused(format!("--out {}: {reason}", path.display()));
            let format = Format::of(path)
                .ok_or_else(|| fault("pictures are written as .png or .exr"))?;
            match (place_of_number(path), place_of_name(path), series) {
                (None, _, Series::Turntable) => Err(fault(
                    "a turntable is many files; put %04d where their number goes, as in turn.%04d.png",
                )),
                (_, None, Series::Cameras) => Err(fault(
                    "several cameras are several files; put %s where their name goes, as in groom-%s.png",
                )),
                (Some(_), _, Series::One | Series::Cameras) => {
                    Err(fault("is numbered, which is for --turntable N and that is not given"))
                }
                _ => Ok(format),
            }
        })
        .collect()
}

/// Where in a file's name the number goes: the text before, the digits it has at least, the text after.
fn place_of_number(path: &Path) -> Option<(&str, usize, &str)> {
    let name = path.file_name()?.to_str()?;
    for (start, _) in name.match_indices('%') {
        let rest = &name[start + 1..];
        let width = rest.len() - rest.trim_start_matches(|c: char| c.is_ascii_digit()).len();
        let digits = &rest[..width];
        let known = digits.is_empty() || (digits.starts_with('0') && digits.len() <= 2);
        if let Some(after) = rest[width..].strip_prefix('d').filter(|_| known) {
            return Some((&name[..start], digits.parse().unwrap_or(1), after));
        }
    }
    None
}

/// Where in a file's name the name of a camera goes: the text before and after.
fn place_of_name(path: &Path) -> Option<(&str, &str)> {
    path.file_name()?.to_str()?.split_once("%s")
}

/// The file of one of several cameras. A name without a place for it stays as it is.
pub(crate) fn called(path: &Path, camera: &str) -> PathBuf {
    let plain: String =
        camera.chars().map(|c| if c.is_alphanumeric() || c == '_' { c } else { '-' }).collect();
    match place_of_name(path) {
        Some((before, after)) => path.with_file_name(format!("{before}{plain}{after}")),
        None => path.to_owned(),
    }
}

/// The file of one picture of a turntable, numbered from 1. A name without a number stays as it is.
pub(crate) fn numbered(path: &Path, number: u32) -> PathBuf {
    match place_of_number(path) {
        Some((before, digits, after)) => {
            path.with_file_name(format!("{before}{number:0digits$}{after}"))
        }
        None => path.to_owned(),
    }
}

/// The file with a place for the number of a turntable's pictures, or without.
#[cfg(feature = "editor")]
pub(crate) fn with_number(path: &Path, wanted: bool) -> PathBuf {
    let name = match (place_of_number(path), wanted) {
        (Some((before, _, after)), false) => {
            format!("{}{after}", before.strip_suffix('.').unwrap_or(before))
        }
        (None, true) => {
            let part = |part: Option<&std::ffi::OsStr>| {
                part.unwrap_or_default().to_string_lossy().into_owned()
            };
            match (part(path.file_stem()), part(path.extension())) {
                (stem, ending) if ending.is_empty() => format!("{stem}.%04d"),
                (stem, ending) => format!("{stem}.%04d.{ending}"),
            }
        }
        _ => return path.to_owned(),
    };
    path.with_file_name(name)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn said<T>(result: Result<T, Stop>) -> Result<T, String> {
        result.map_err(|stop| stop.lines().join("\n"))
    }

    #[test]
    fn series_and_only_they_have_a_place_for_what_tells_them_apart() {
        use Series::{Cameras, One, Turntable};
        let check = |name: &str, series: Series, expected: Result<Format, &str>| {
            let found = said(formats(&[PathBuf::from(name)], series));
            match (found, expected) {
                (Ok(found), Ok(expected)) => assert_eq!(found, [expected], "{name}"),
                (Err(found), Err(words)) => assert!(found.contains(words), "{name}: {found}"),
                (found, _) => panic!("{name}: {found:?}"),
            }
        };
        check("a.png", One, Ok(Format::Png));
        check("a.EXR", One, Ok(Format::Exr));
        check("a%04d.png", Turntable, Ok(Format::Png));
        check("100%.png", One, Ok(Format::Png));
        check("a%04d.png", One, Err("--turntable"));
        check("a.png", Turntable, Err("%04d"));
        check("a%4d.png", Turntable, Err("%04d"));
        check("%04d/a.png", Turntable, Err("%04d"));
        check("a-%s.png", Cameras, Ok(Format::Png));
        check("a.png", Cameras, Err("%s"));
        check("%s/a.png", Cameras, Err("%s"));
        check("a-%s.png", One, Ok(Format::Png));
        check("a-%s-%04d.png", Turntable, Ok(Format::Png));
        check("a-%s-%04d.png", Cameras, Err("--turntable"));
        check("a%04d.png", Cameras, Err("%s"));
        check("a.jpg", One, Err(".png or .exr"));
        check("a", One, Err(".png or .exr"));
        assert!(said(formats(&[], One)).unwrap_err().contains("--out"));
    }

    #[cfg(feature = "editor")]
    #[test]
    fn a_number_has_its_place_exactly_when_it_is_wanted() {
        let check = |one: &str, many: &str| {
            assert_eq!(with_number(Path::new(one), true), Path::new(many));
            assert_eq!(with_number(Path::new(many), false), Path::new(one));
            assert_eq!(with_number(Path::new(many), true), Path::new(many));
            assert_eq!(with_number(Path::new(one), false), Path::new(one));
        };
        check("f/turn.png", "f/turn.%04d.png");
        check("v1.2.exr", "v1.2.%04d.exr");
        check("f/turn", "f/turn.%04d");
    }

    #[test]
    fn pictures_of_several_cameras_are_called_after_them() {
        for (name, camera, expected) in [
            ("f/afro-%s.png", "close tip", "f/afro-close-tip.png"),
            ("%s.exr", "close:rows", "close-rows.exr"),
            ("%s.png", "../up", "---up.png"),
            ("still.png", "front", "still.png"),
        ] {
            assert_eq!(called(Path::new(name), camera), Path::new(expected));
        }
    }

    #[test]
    fn pictures_of_a_turntable_are_numbered_as_their_name_asks() {
        for (name, number, expected) in [
            ("f/turn.%04d.png", 7, "f/turn.0007.png"),
            ("%d.exr", 12, "12.exr"),
            ("100%_%03d.png", 12345, "100%_12345.png"),
            ("still.png", 3, "still.png"),
        ] {
            assert_eq!(numbered(Path::new(name), number), Path::new(expected));
        }
    }
}
