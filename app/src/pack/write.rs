//! Packs, written: the manifest, then its files in their order.
//!
//! Guaranteed: the same files give the same bytes on every machine (no clock, one level of compression in Rust, modes and system
//! fixed), and a file that changes while it is packed is an error, never another pack than was told.

use super::gather::{PackFile, Source};
use super::{EXTENSION, Hash, MANIFEST, Manifest};
use std::cell::RefCell;
use std::fs::File;
use std::io::{self, Read, Seek, SeekFrom, Write};
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
    let failed = RefCell::new(None);
    let sound = || failed.borrow().clone().map_or(Ok(()), Err);
    let mut zip = ZipWriter::new(Latched { out: &mut *out, failed: &failed, at: 0, end: 0 });
    let text = serde_json::to_string_pretty(manifest).map_err(|err| err.to_string())? + "\n";
    zip.start_file(MANIFEST, options).map_err(|err| err.to_string())?;
    zip.write_all(text.as_bytes()).map_err(|err| err.to_string())?;
    for item in items {
        zip.start_file(&item.name, options).map_err(|err| err.to_string())?;
        let hash = item.from.each_piece(|piece| {
            zip.write_all(piece).map_err(|err| err.to_string())?;
            sound()
        });
        // What is wrong with the pack is not wrong with the file.
        sound()?;
        match hash {
            Ok(hash) if hash == (item.hash.clone(), item.size) => {}
            Ok(_) => return Err(format!("{} has changed while it was packed", item.name)),
            Err(why) => return Err(format!("{}: {why}", item.name)),
        }
    }
    zip.finish().map_err(|err| err.to_string())?;
    sound()?;
    match out.stream_position() {
        Ok(len) if len >= u64::from(u32::MAX) => Err("would be larger than 4 GiB".to_owned()),
        Ok(_) => Ok(()),
        Err(err) => Err(err.to_string()),
    }
}

/// An output whose first failure is kept for us, and which takes and drops whatever comes after it: a zip that is given up still writes
/// its end, and would say on standard error what it thinks of a full disk.
struct Latched<'a, W> {
    out: &'a mut W,
    failed: &'a RefCell<Option<String>>,
    /// Where the output is, and where it ends: kept up where nothing is written any more.
    at: u64,
    end: u64,
}

impl<W> Latched<'_, W> {
    /// What an operation gave, or what it would have given.
    fn kept<T>(&mut self, done: io::Result<T>, else_done: T) -> io::Result<T> {
        done.or_else(|err| match err.kind() {
            io::ErrorKind::Interrupted => Err(err),
            _ => {
                self.failed.borrow_mut().get_or_insert(err.to_string());
                Ok(else_done)
            }
        })
    }
    fn is_sound(&self) -> bool {
        self.failed.borrow().is_none()
    }
}

impl<W: Write> Write for Latched<'_, W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let done = if self.is_sound() { self.out.write(bytes) } else { Ok(bytes.len()) };
        let written = self.kept(done, bytes.len())?;
        self.at += written as u64;
        self.end = self.end.max(self.at);
        Ok(written)
    }
    fn flush(&mut self) -> io::Result<()> {
        let done = if self.is_sound() { self.out.flush() } else { Ok(()) };
        self.kept(done, ())
    }
}

impl<W: Seek> Seek for Latched<'_, W> {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        let of = |from: u64, by: i64| from.saturating_add_signed(by);
        let at = match to {
            SeekFrom::Start(at) => at,
            SeekFrom::Current(by) => of(self.at, by),
            SeekFrom::End(by) => of(self.end, by),
        };
        let done = if self.is_sound() { self.out.seek(to) } else { Ok(at) };
        self.at = self.kept(done, at)?;
        Ok(self.at)
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
