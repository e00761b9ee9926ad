//! Files that a USD file names: those of its own folder and below, nothing else.

use std::path::{Path, PathBuf};

/// The most bytes of all such files.
const MOST_BYTES: u64 = 4 << 30;

/// The folder of a file.
pub(super) struct Folder {
    at: PathBuf,
    left: u64,
}

impl Folder {
    pub(super) fn of(file: &Path) -> Self {
        let at = file.parent().filter(|at| !at.as_os_str().is_empty()).unwrap_or(Path::new("."));
        Self { at: at.to_owned(), left: MOST_BYTES }
    }

    /// The bytes of a file by its path from the folder, or why there are none. Links do not lead out of the folder.
    pub(super) fn read(&mut self, path: &str) -> Result<Vec<u8>, String> {
        let say = |err: std::io::Error| match err.kind() {
            std::io::ErrorKind::NotFound => "there is no such file".to_owned(),
            _ => err.to_string(),
        };
        let folder = self.at.canonicalize().map_err(say)?;
        let file = folder.join(path).canonicalize().map_err(say)?;
        if !file.starts_with(&folder) {
            return Err("it leads outside the folder of the file that was opened".to_owned());
        }
        let about = std::fs::metadata(&file).map_err(say)?;
        if !about.is_file() {
            return Err("it is not a file".to_owned());
        }
        self.left = self
            .left
            .checked_sub(about.len())
            .ok_or_else(|| format!("files beside it take more than {} GiB", MOST_BYTES >> 30))?;
        std::fs::read(&file).map_err(say)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_files_of_the_folder_are_read() {
        let top = std::env::temp_dir().join(format!("coif-beside-{}", std::process::id()));
        std::fs::create_dir_all(top.join("in/deep")).unwrap();
        for name in ["out.usda", "in/a.usda", "in/deep/b.usda"] {
            std::fs::write(top.join(name), name).unwrap();
        }
        let mut folder = Folder::of(&top.join("in/a.usda"));
        let mut read = |path: &str| folder.read(path).map_err(|reason| reason.to_string());
        assert_eq!(read("a.usda").unwrap(), b"in/a.usda");
        assert_eq!(read("deep/b.usda").unwrap(), b"in/deep/b.usda");
        assert!(read("../out.usda").unwrap_err().contains("outside"));
        assert_eq!(read("none.usda").unwrap_err(), "there is no such file");
        assert_eq!(read("deep").unwrap_err(), "it is not a file");
        #[cfg(unix)]
        {
            std::os::unix::fs::symlink(top.join("out.usda"), top.join("in/link.usda")).unwrap();
            assert!(read("link.usda").unwrap_err().contains("outside"));
        }
        std::fs::remove_dir_all(&top).unwrap();
    }
}
