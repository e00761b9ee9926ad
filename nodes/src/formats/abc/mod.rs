//! Alembic: grooms out as `.abc`, for Unreal, Maya and Blender, and curves back in.
//!
//! [`groom`] lays a groom out as objects, `ogawa` turns these into bytes; [`read`] is the way in, `curves` what is looked for there. All
//! our own: there is no crate
//! that writes Alembic.
//!
//! ```text
//! /<Groom>               Xform; user properties groom_version_major 1, groom_version_minor 5, groom_tool, groom_properties
//!   <set>/<set>Shape     Xform over Curves: hair
//!   <set>_guides/...     Xform over Curves: guides
//!   head/headShape       Xform over PolyMesh, where the head is asked for
//! ```
//!
//! **Units and axes.** Centimetres, Y up, no transforms: what Unreal and Maya take as it is. Alembic itself states no unit; Blender
//! takes one for a metre (import with scale 0.01) and turns Y up to Z up itself. Of a file that others wrote, `unit` tells what its unit
//! may be. Where a groom lies down in Unreal, its import
//! wants a rotation of 90 about X.
//!
//! **Basis and end points.** Curves are cubic, `catmullRom`, not periodic, with every CV on the curve, as in USD. Alembic has no word
//! for `pinned`: no CV is doubled, so counts are those of the hair. Unreal and Maya take the CVs, and Blender's Catmull-Rom
//! begins and ends in the first and last one. A renderer that holds to RenderMan's rule draws a curve from its second to its last
//! but one CV; give such a one the USD file, which says pinned. Catmull-Rom is read as uniform there and meant as centripetal here;
//! curves went through [`super::conform`], so both are the same hair.
//!
//! **Attributes** are those of USD under the same names (see [`super::export`]), as GeomParams: `con` one value, `uni` one a
//! curve, `vtx` one a point. `width` is the diameter, one a point: Blender passes over a single one for all, and Unreal reads 0 for
//! that where another set has many. `groom_color` is `displayColor`, one a point, for Unreal takes no other. Values that are the
//! same are in the file once.
//!
//! Unreal takes a file with a mesh in it for no groom: write the head for others only.

mod curves;
pub mod groom;
mod ogawa;
pub mod read;
mod unit;

pub use curves::{AbcCurves, read_curves};
pub use groom::write;
pub use unit::{cm_by_application, cm_by_head};
