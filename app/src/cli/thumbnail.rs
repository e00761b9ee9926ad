//! `coif template thumbnail`: a template drawn small, and the picture kept in its file.

use super::carry_out::in_one_step;
use super::progress::Bar;
use crate::jobs::stop::Exit;
use crate::jobs::thumbnail::{CAMERA, SIZE, renew};
use clap::Args;
use std::path::PathBuf;

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
            let bar = Bar::new("nodes");
            let renewed = renew(path, args.size, &args.camera, &bar, cancel, files);
            bar.clear();
            renewed.map_err(|stop| vec![stop])?;
        }
        Ok(())
    });
    drawn.map_or_else(|exit| exit, |()| Exit::Done)
}
