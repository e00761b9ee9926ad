//! How the materials of a mesh file look, for whoever draws it: base colours, and maps of colour and of normals.
//!
//! Guarantees for any bytes: what [`read_mesh`](super::read_mesh) guarantees of time and memory; pictures are handed over as they
//! stand in the file, within the same bound on memory; triangles are those of the mesh, in the same order. A picture that cannot be
//! had is told with its material and never an error. **Not promised:** that the bytes of a picture are one. Evaluation reads nothing
//! of this: no key and no hash knows it.

use super::mesh_in::{Side, is_gltf};
use super::{gltf, obj};
use crate::data::mesh::MeshError;
use glam::{Affine2, Vec2, Vec3};
use std::collections::BTreeMap;
use std::sync::Arc;

/// The looks of a mesh file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Looks {
    /// Those that triangles have.
    pub materials: Vec<Material>,
    /// For each triangle of the mesh its material, by number; none where that is past the last.
    pub material_of: Vec<u32>,
    /// Sets of uvs that maps ask for besides the mesh's own: for each corner of each triangle, v up.
    pub uvs: BTreeMap<u32, Vec<[Vec2; 3]>>,
    /// Whether the number of a triangle's third vertex is above the second's: this tells whether a triangle was turned round since.
    pub rises: Vec<bool>,
    /// The pictures that maps show.
    pub pictures: Vec<Picture>,
    /// Whether a material names a colour map, whether or not it can be had.
    pub names_colours: bool,
    /// What cannot be shown: material, picture, and what to do.
    pub remarks: Vec<String>,
}

/// One material.
#[derive(Clone, Debug, PartialEq)]
pub struct Material {
    /// As the file names it.
    pub name: String,
    /// Linear base colour, 0 to 1, by which the colour map is multiplied; none where the file gives none, or plain white.
    pub colour: Option<Vec3>,
    /// The map of its base colour, sRGB.
    pub colour_map: Option<TextureMap>,
    /// The map of its normals in tangent space, green up.
    pub normal_map: Option<TextureMap>,
    /// How far the normal map tilts: its red and green are multiplied by this.
    pub normal_scale: f32,
    /// What of the colour map is less opaque than this is not there; 0 where all of it is.
    pub cutoff: f32,
}

impl Material {
    /// One without looks.
    pub(super) fn plain(name: String) -> Self {
        let (colour, colour_map, normal_map) = (None, None, None);
        Self { name, colour, colour_map, normal_map, normal_scale: 1.0, cutoff: 0.0 }
    }
}

/// How a picture is laid onto triangles.
#[derive(Clone, Debug, PartialEq)]
pub struct TextureMap {
    /// The picture's number.
    pub picture: usize,
    /// Which set of uvs it lies by: 0 is the mesh's own, others are in [`Looks::uvs`].
    pub set: u32,
    /// From uvs, v up, to the picture: 0 to 1 from the left and from the top.
    pub picture_from_uv: Affine2,
    /// Beyond the left and right, and beyond the top and bottom.
    pub wrap: [TextureWrap; 2],
    /// Whether pixels stay hard squares.
    pub nearest: bool,
    /// Whether it has to be found out from its pixels if it is a map of normals or of heights.
    pub doubtful: bool,
}

/// What lies beyond the edge of a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TextureWrap {
    /// The picture again.
    Repeat,
    /// Its mirror image.
    Mirror,
    /// The pixels of the edge.
    Clamp,
}

/// A picture within or beside a mesh file.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    /// For messages.
    pub name: String,
    /// As a file's.
    pub bytes: Arc<[u8]>,
}

/// Reads the looks of a mesh file, by its extension (any case, without the dot). `side` gives the bytes of files beside it.
///
/// # Errors
/// Those of [`read_mesh`](super::read_mesh).
pub fn read_looks(extension: &str, bytes: &[u8], side: Side) -> Result<Looks, MeshError> {
    match extension.trim_start_matches('.').to_ascii_lowercase().as_str() {
        "obj" => obj::read_looks(bytes, side),
        gltf if is_gltf(gltf) => gltf::read_looks(bytes, side),
        _ => Ok(Looks::default()),
    }
}

/// Whether each triangle's third vertex is above its second.
pub(super) fn rises(triangles: &[[u32; 3]]) -> Vec<bool> {
    triangles.iter().map(|[_, b, c]| c > b).collect()
}

/// From v up to a picture that begins at the top.
pub(super) fn upright() -> Affine2 {
    Affine2::from_cols(Vec2::X, Vec2::NEG_Y, Vec2::Y)
}
