//! The first reading of an OBJ file: how much of everything there is, and what is to be left out.

use super::lines::{TextLines, split_keyword, words};
use super::{MOST_CORNERS, at_line};
use crate::data::mesh::MeshError;
use crate::formats::mesh_in::{NameTable, WELD_BYTES_PER_POINT, WELD_BYTES_PER_TRIANGLE};

/// What the first reading finds: how much of everything there is.
#[derive(Debug, Default)]
pub(super) struct Count {
    pub(super) points: u64,
    pub(super) uvs: u64,
    pub(super) triangles: u64,
    pub(super) colours: bool,
    pub(super) materials: bool,
    pub(super) parts: bool,
    /// Bytes for names of materials and parts.
    pub(super) names: u64,
    pub(super) lines_and_points: u64,
    pub(super) free_form: u64,
    pub(super) short_faces: u64,
    pub(super) first_short_face: usize,
    pub(super) unknown: u64,
    pub(super) first_unknown: usize,
}

impl Count {
    pub(super) fn of(text: &[u8]) -> Result<Self, MeshError> {
        let mut count = Self::default();
        let mut lines = TextLines::new(text);
        while let Some((line, text)) = lines.next() {
            let (keyword, rest) = split_keyword(text);
            match keyword {
                b"v" => {
                    count.points += 1;
                    count.colours |= words(rest).nth(5).is_some();
                }
                b"vt" => count.uvs += 1,
                b"f" => {
                    let corners = words(rest).take(MOST_CORNERS + 1).count();
                    if corners > MOST_CORNERS {
                        let reason = format!("a face of more than {MOST_CORNERS} corners");
                        return Err(at_line(line, reason));
                    }
                    if corners < 3 {
                        count.short_faces += 1;
                        if count.short_faces == 1 {
                            count.first_short_face = line;
                        }
                    }
                    count.triangles += corners.saturating_sub(2) as u64;
                }
                b"usemtl" => {
                    count.materials = true;
                    count.names += NameTable::memory(rest.len());
                }
                b"o" | b"g" => {
                    count.parts = true;
                    count.names += NameTable::memory(rest.len());
                }
                b"l" | b"p" => count.lines_and_points += 1,
                b"curv" | b"curv2" | b"surf" => count.free_form += 1,
                // Looks, display and the statements that go with free-form shapes.
                b"vn" | b"vp" | b"s" | b"mtllib" | b"mg" | b"cstype" | b"deg" | b"bmat"
                | b"step" | b"parm" | b"trim" | b"hole" | b"scrv" | b"sp" | b"end" | b"con"
                | b"usemap" | b"maplib" | b"bevel" | b"c_interp" | b"d_interp" | b"lod"
                | b"shadow_obj" | b"trace_obj" | b"ctech" | b"stech" => {}
                keyword if keyword.is_empty() || keyword[0] == b'#' => {}
                _ => {
                    count.unknown += 1;
                    if count.unknown == 1 {
                        count.first_unknown = line;
                    }
                }
            }
        }
        if count.points > u64::from(u32::MAX) || count.triangles > u64::from(u32::MAX) {
            return Err(MeshError::at("file", "more than four thousand million vertices or faces"));
        }
        Ok(count)
    }

    /// Bytes the second reading allocates, at most.
    pub(super) fn memory(&self, file_bytes: usize) -> u64 {
        let or_none = |yes: bool, bytes: u64| if yes { bytes } else { 0 };
        let point = 12 + WELD_BYTES_PER_POINT + or_none(self.colours, 12);
        let triangle = WELD_BYTES_PER_TRIANGLE
            + 12
            + or_none(self.uvs > 0, 24)
            + or_none(self.materials, 4)
            + or_none(self.parts, 4);
        // A joined line is at most the file, in a vector that grew by doubling.
        self.points * point
            + self.uvs * 8
            + self.triangles * triangle
            + self.names
            + 3 * file_bytes as u64
    }
}

pub(super) fn no_triangles(count: &Count) -> MeshError {
    let what = if count.short_faces > 0 {
        format!("only {} faces with fewer than 3 corners", count.short_faces)
    } else if count.lines_and_points > 0 {
        format!("only {} lines and points", count.lines_and_points)
    } else if count.free_form > 0 {
        "only free-form curves and surfaces: convert them to polygons".to_owned()
    } else if count.points > 0 {
        format!("{} vertices and no faces", count.points)
    } else {
        "neither vertices nor faces".to_owned()
    };
    MeshError::at("file", format!("no triangles: {what}"))
}
