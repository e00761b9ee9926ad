//! A template drawn small, and the picture kept in its file.
//!
//! Guarantees: the same template, drawn by the same driver, gets the same bytes; the text of a picture is at most 64 KiB; what else the
//! file says stays as it is. A program that was built without pictures says so.

use super::progress::Tell;
use super::stop::Stop;
use crate::files::{Role, Together};
use crate::library;
use coif_graphs::document::{Document, Thumbnail};
use coif_graphs::file;
use coif_graphs::schedule::run::CancelToken;
use std::path::{Path, PathBuf};

/// Width and height, pixels.
pub(crate) const SIZE: u32 = 256;
/// Where it is seen from, where nobody says otherwise: face, one side and all hair.
pub(crate) const CAMERA: &str = "three-quarter";

/// Draws the template of a file and writes the file with the picture, to be put in place with what else is written.
pub(crate) fn renew(
    path: &Path,
    size: u32,
    camera: &str,
    tell: &dyn Tell,
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
    let drawn = of(&document, folder, size, camera, tell, cancel, files).map_err(|stop| {
        let named = |line: &String| format!("{}: {line}", path.display());
        Stop(stop.0, stop.lines().iter().map(named).collect())
    })?;
    document.thumbnail = Some(drawn);
    let written = files.write_text(path, &file::write(&document), cancel);
    written.map_err(|why| Stop::unwritten(path, &why, cancel))
}

/// A groom drawn small. Paths in it are relative to `folder`.
#[cfg(feature = "render")]
pub(crate) fn of(
    document: &Document,
    folder: PathBuf,
    size: u32,
    camera: &str,
    tell: &dyn Tell,
    cancel: &CancelToken,
    files: &mut Together,
) -> Result<Thumbnail, Stop> {
    use super::evaluate::Opened;
    use super::render::{RenderRequest, draw_one};
    let opened = Opened::of(document.clone(), folder, "the template".to_owned(), false)?;
    // All hair, for a tenth of it is another style; few samples, for it is small.
    let asked = RenderRequest {
        size: [size; 2],
        cameras: vec![camera.to_owned()],
        samples: 32,
        ..RenderRequest::default()
    };
    let drawn = draw_one(&asked, &opened, cancel, tell, files)?;
    // Of three bytes base64 makes four.
    let most = Thumbnail::WRITTEN / 4 * 3;
    let exposure = asked.rig(0.0).exposure;
    let png = coif_shaders::small::small_png(&drawn, asked.transform, exposure, most);
    let png = png.map_err(|err| Stop::failed(err.to_string()))?;
    Thumbnail::new(png).map_err(Stop::failed)
}

/// Nothing can be drawn.
#[cfg(not(feature = "render"))]
pub(crate) fn of(
    _: &Document,
    _: PathBuf,
    _: u32,
    _: &str,
    _: &dyn Tell,
    _: &CancelToken,
    _: &mut Together,
) -> Result<Thumbnail, Stop> {
    Err(Stop::refused("this coif was built without pictures: it draws no thumbnails"))
}
