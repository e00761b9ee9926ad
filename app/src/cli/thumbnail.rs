//! `coif template thumbnail`: a template drawn small, and the picture kept in its file.
//!
//! Guarantees: the same template, drawn by the same driver, gets the same bytes; the text of a picture is at most 64 KiB; what else the
//! file says stays as it is. A program that was built without pictures says so.

use super::Exit;
use super::carry_out::{Stop, in_one_step};
use crate::files::{Role, Together};
use crate::library;
use clap::Args;
use coif_graphs::document::{Document, Thumbnail};
use coif_graphs::file;
use coif_graphs::schedule::run::CancelToken;
use std::path::{Path, PathBuf};

/// Width and height, pixels.
pub(crate) const SIZE: u32 = 256;
/// Where it is seen from, where nobody says otherwise: face, one side and all hair.
pub(crate) const CAMERA: &str = "three-quarter";

#[derive(Args)]
pub(super) struct ThumbnailArgs {
    /// The templates, .ron files
    #[arg(required = true)]
    files: Vec<PathBuf>,
    /// Where it is seen from, as for coif render
    #[arg(long, value_name = "NAME", default_value = CAMERA)]
    camera: String,
    /// Width and height in pixels
    #[arg(long, value_name = "PIXELS", default_value_t = SIZE, value_parser = clap::value_parser!(u32).range(32..=256))]
    size: u32,
}

pub(super) fn run(args: &ThumbnailArgs) -> Exit {
    let drawn = in_one_step("no template was written", |files, cancel| {
        for path in &args.files {
            renew(path, args.size, &args.camera, cancel, files).map_err(|stop| vec![stop])?;
        }
        Ok(())
    });
    drawn.map_or_else(|exit| exit, |()| Exit::Done)
}

/// Draws the template of a file and writes the file with the picture, to be put in place with what else is written.
pub(crate) fn renew(
    path: &Path,
    size: u32,
    camera: &str,
    cancel: &CancelToken,
    files: &mut Together,
) -> Result<(), Stop> {
    let named = |why: String| Stop::refused(format!("{}: {why}", path.display()));
    let mut document = library::read(path).map_err(named)?.document;
    files
        .writes(path, Role::Output, format!("the template {}", path.display()))
        .and_then(|()| files.allowed())
        .map_err(Stop::refused)?;
    let folder = path.parent().unwrap_or(Path::new("")).to_owned();
    let drawn = of(&document, folder, size, camera, cancel, files).map_err(|stop| {
        let named = |line: &String| format!("{}: {line}", path.display());
        Stop(stop.0, stop.lines().iter().map(named).collect())
    })?;
    document.thumbnail = Some(drawn);
    let written = files.write_text(path, &file::write(&document), cancel);
    written.map_err(|why| Stop::unwritten(path, &why, cancel))
}

/// A groom drawn small. Paths in it are relative to `folder`.
#[cfg(feature = "render")]
pub(super) fn of(
    document: &Document,
    folder: PathBuf,
    size: u32,
    camera: &str,
    cancel: &CancelToken,
    files: &mut Together,
) -> Result<Thumbnail, Stop> {
    use super::groom::Opened;
    use super::progress::Bar;
    let opened = Opened::of(document.clone(), folder, "the template".to_owned(), false)?;
    let side = format!("{size}x{size}");
    // All hair, for a tenth of it is another style; few samples, for it is small.
    let words = [
        ["graph", "--out", "thumbnail.png"],
        ["--size", &side, "--camera"],
        [camera, "--samples", "32"],
    ];
    let bar = Bar::new("nodes");
    let drawn = super::render::draw_one(&words.concat(), &opened, cancel, &bar, files);
    bar.clear();
    let (picture, transform, exposure) = drawn?;
    // Of three bytes base64 makes four.
    let most = Thumbnail::WRITTEN / 4 * 3;
    let png = coif_shaders::small::small_png(&picture, transform, exposure, most);
    let png = png.map_err(|err| Stop::failed(err.to_string()))?;
    Thumbnail::new(png).map_err(Stop::failed)
}

/// Nothing can be drawn.
#[cfg(not(feature = "render"))]
pub(super) fn of(
    _: &Document,
    _: PathBuf,
    _: u32,
    _: &str,
    _: &CancelToken,
    _: &mut Together,
) -> Result<Thumbnail, Stop> {
    Err(Stop::refused("this coif was built without pictures: it draws no thumbnails"))
}
