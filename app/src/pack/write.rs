//! Packs, written: the manifest, then its files in their order.
//!
//! Guaranteed: the same files give the same bytes on every machine (no clock, one level of compression in Rust, modes and system
//! fixed), and a file that changes while it is packed is an error, never another pack than was told.

use super::gather::{PackFile, Source};
use super::{EXTENSION, Hash, MANIFEST, Manifest};
use std::fs::File;
use std::io::{Read, Seek, Write};
use std::path::Path;
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, DateTime, System, ZipWriter};

/// How much deflate tries.
const LEVEL: i64 = 6;

/// Refuses a target whose name says that it is something else.
pub(crate) fn named_as_pack(out: &Path) -> Result<(), String> {
    match super::is_pack(out) {
        true => Ok(()),
        false => Err(format!("{}: packs end in .{EXTENSION}", out.display())),
    }
}

/// Writes a pack of `items`, which are those of the manifest.
///
/// # Errors
/// In one line, with the file that it is about.
pub(crate) fn write(
    manifest: &Manifest,
    items: &[PackFile],
    out: &mut (impl Write + Seek),
) -> Result<(), String> {
    let options = SimpleFileOptions::default()
        .compression_method(CompressionMethod::Deflated)
        .compression_level(Some(LEVEL))
        .last_modified_time(DateTime::default())
        .unix_permissions(0o644)
        .system(System::Unix);
    let mut zip = ZipWriter::new(&mut *out);
    let text = serde_json::to_string_pretty(manifest).map_err(|err| err.to_string())? + "\n";
    zip.start_file(MANIFEST, options).map_err(|err| err.to_string())?;
    zip.write_all(text.as_bytes()).map_err(|err| err.to_string())?;
    for item in items {
        zip.start_file(&item.name, options).map_err(|err| err.to_string())?;
        let hash =
            item.from.each_piece(|piece| zip.write_all(piece).map_err(|err| err.to_string()));
        match hash {
            Ok(hash) if hash == (item.hash.clone(), item.size) => {}
            Ok(_) => return Err(format!("{} has changed while it was packed", item.name)),
            Err(why) => return Err(format!("{}: {why}", item.name)),
        }
    }
    zip.finish().map_err(|err| err.to_string())?;
    match out.stream_position() {
        Ok(len) if len >= u64::from(u32::MAX) => Err("would be larger than 4 GiB".to_owned()),
        Ok(_) => Ok(()),
        Err(err) => Err(err.to_string()),
    }
}

impl Source {
    /// Gives all of its bytes in turn, and their hash and number.
    ///
    /// # Errors
    /// It cannot be read, or whoever takes the bytes cannot. One line without the name.
    pub(super) fn each_piece(
        &self,
        mut take: impl FnMut(&[u8]) -> Result<(), String>,
    ) -> Result<(String, u64), String> {
        let mut hash = Hash::new();
        let mut add = |piece: &[u8]| {
            hash.add(piece);
            take(piece)
        };
        let mut len = 0;
        match self {
            Source::Bytes(bytes) => {
                add(bytes)?;
                len = bytes.len() as u64;
            }
            Source::File(path) => {
                let mut file = File::open(path).map_err(|err| err.to_string())?;
                let mut piece = vec![0; 1 << 16];
                loop {
                    let read = file.read(&mut piece).map_err(|err| err.to_string())?;
                    if read == 0 {
                        break;
                    }
                    len += read as u64;
                    add(&piece[..read])?;
                }
            }
        }
        Ok((hash.text(), len))
    }
}
