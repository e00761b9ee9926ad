//! What lights a scene: a rig of a name or a photographed sphere, turned about the vertical.

use crate::files::read_at_most;
use coif_shaders::hdri::Hdri;
use coif_shaders::light::Rig;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// The largest file of surroundings that is read: 8192 x 4096 pixels of three floats, and some room.
const MOST_SURROUNDINGS: u64 = 512 << 20;

/// A photographed sphere that was read from a file.
#[derive(Clone, Debug)]
pub struct Surroundings {
    /// Its file.
    pub path: PathBuf,
    sphere: Arc<Hdri>,
}

impl PartialEq for Surroundings {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.sphere, &other.sphere)
    }
}

impl Surroundings {
    /// Endings of files that may hold one.
    #[cfg(feature = "editor")]
    pub const ENDINGS: &'static [&'static str] = &["hdr", "exr"];

    /// Reads a `.hdr` or `.exr` file.
    ///
    /// # Errors
    /// Why it cannot be: one line, without the file's name.
    pub fn read(path: &Path) -> Result<Self, String> {
        let bytes = read_at_most(path, MOST_SURROUNDINGS)?;
        let sphere = Hdri::read(&bytes).map_err(|err| err.to_string())?;
        Ok(Self { path: path.to_owned(), sphere: Arc::new(sphere) })
    }
}

/// What lights a scene.
#[derive(Clone, Debug, PartialEq)]
pub struct Lights {
    /// The rig's name; for a sphere, the rig that lights where it is taken away.
    pub name: &'static str,
    /// The sphere instead of the rig, and the degrees that it is blurred by behind the head.
    pub around: Option<(Surroundings, f32)>,
    /// Degrees about the vertical, anticlockwise as seen from above.
    pub turn: f32,
}

impl Lights {
    /// The rig itself.
    pub fn rig(&self) -> Rig {
        match &self.around {
            Some((Surroundings { sphere, .. }, blur)) => sphere.rig(self.turn, *blur),
            None => Rig::named(self.name).unwrap_or_default().turned(self.turn),
        }
    }

    /// What it is called.
    pub(crate) fn called(&self) -> String {
        match &self.around {
            Some((around, _)) => around.path.display().to_string(),
            None => self.name.to_owned(),
        }
    }
}
