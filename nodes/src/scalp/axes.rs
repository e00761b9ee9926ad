//! Axes of a mesh file: which one points up, and which one the face points along.
//!
//! Heads are Y up inside the program; files with another axis up are rotated on reading. Axis names are those of the
//! file.

use crate::define::choice;
use glam::Vec3;

choice! {
    /// Axis of the file that points up.
    Up {
        /// Y up, as in most files.
        Y = "y",
        /// Z up.
        Z = "z",
        /// X up.
        X = "x",
        /// Y down.
        MinusY = "-y",
        /// Z down.
        MinusZ = "-z",
        /// X down.
        MinusX = "-x",
    }
}

choice! {
    /// Axis of the file that the face points along.
    Forward {
        /// Detected from the face.
        Auto = "auto",
        /// The file's +X.
        PlusX = "+x",
        /// The file's -X.
        MinusX = "-x",
        /// The file's +Y.
        PlusY = "+y",
        /// The file's -Y.
        MinusY = "-y",
        /// The file's +Z.
        PlusZ = "+z",
        /// The file's -Z.
        MinusZ = "-z",
    }
}

impl Up {
    /// All axes, likeliest first.
    pub(crate) const ALL: [Self; 6] =
        [Self::Y, Self::Z, Self::X, Self::MinusY, Self::MinusZ, Self::MinusX];

    /// Converts a point or direction of a file with this axis up to Y up. The same person in a file with Z up faces -Y.
    pub(crate) fn turned(self, p: Vec3) -> Vec3 {
        match self {
            Self::Y => p,
            Self::Z => Vec3::new(p.x, p.z, -p.y),
            Self::X => Vec3::new(-p.y, p.x, p.z),
            Self::MinusY => Vec3::new(-p.x, -p.y, p.z),
            Self::MinusZ => Vec3::new(p.x, -p.z, p.y),
            Self::MinusX => Vec3::new(p.y, -p.x, p.z),
        }
    }
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Y => "y",
            Self::Z => "z",
            Self::X => "x",
            Self::MinusY => "-y",
            Self::MinusZ => "-z",
            Self::MinusX => "-x",
        }
    }
}

impl Forward {
    /// The file's axes and their names.
    const AXES: [(Vec3, &str); 6] = [
        (Vec3::X, "+x"),
        (Vec3::NEG_X, "-x"),
        (Vec3::Y, "+y"),
        (Vec3::NEG_Y, "-y"),
        (Vec3::Z, "+z"),
        (Vec3::NEG_Z, "-z"),
    ];

    /// The file's axis; `None` if the face is to be detected.
    pub(crate) fn axis(self) -> Option<Vec3> {
        Some(match self {
            Self::Auto => return None,
            Self::PlusX => Vec3::X,
            Self::MinusX => Vec3::NEG_X,
            Self::PlusY => Vec3::Y,
            Self::MinusY => Vec3::NEG_Y,
            Self::PlusZ => Vec3::Z,
            Self::MinusZ => Vec3::NEG_Z,
        })
    }
    /// Name of the file's axis that lies along `way` after the file is rotated to Y up.
    pub(crate) fn name_of(way: Vec3, up: Up) -> &'static str {
        Self::AXES
            .into_iter()
            .find(|(axis, _)| up.turned(*axis) == way)
            .map_or("", |(_, name)| name)
    }
}
