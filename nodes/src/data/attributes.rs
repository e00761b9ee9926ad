//! Named, typed columns of curves, and the names that nodes agree on.
//!
//! A column holds one value for each curve or each point of a tuft, or a single value that all share.
//! A missing attribute reads as its declared default, so no node has to ask whether it is there.

use glam::{Vec2, Vec3};
use std::borrow::Cow;
use std::sync::Arc;

/// An attribute's name: one of the declared ones, or the user's own.
pub type Name = Cow<'static, str>;

/// What a column has one value for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Domain {
    /// One value per curve.
    Curve,
    /// One value per point (CV).
    Point,
}

/// The values of an attribute: as many as its domain has items, or one for all.
#[derive(Clone, Debug, PartialEq)]
pub enum Column {
    /// Numbers.
    F32(Arc<Vec<f32>>),
    /// Whole numbers.
    I32(Arc<Vec<i32>>),
    /// Ids.
    U64(Arc<Vec<u64>>),
    /// Texture coordinates.
    Vec2(Arc<Vec<Vec2>>),
    /// Vectors and linear Rec.709 colours.
    Vec3(Arc<Vec<Vec3>>),
}

/// A type that a column can hold.
pub trait Item: Copy + PartialEq + Send + Sync + bytemuck::NoUninit + 'static {
    /// The column of these values.
    fn column(values: Vec<Self>) -> Column;
    /// The values of a column of this type.
    fn values(column: &Column) -> Option<&Arc<Vec<Self>>>;
}

macro_rules! items {
    ($($ty:ty => $variant:ident),*) => {$(
        impl Item for $ty {
            fn column(values: Vec<Self>) -> Column {
                Column::$variant(Arc::new(values))
            }
            fn values(column: &Column) -> Option<&Arc<Vec<Self>>> {
                match column {
                    Column::$variant(values) => Some(values),
                    _ => None,
                }
            }
        }
    )*};
}
items!(f32 => F32, i32 => I32, u64 => U64, Vec2 => Vec2, Vec3 => Vec3);

impl Column {
    /// How many values are stored (1 may stand for all).
    pub fn len(&self) -> usize {
        match self {
            Column::F32(v) => v.len(),
            Column::I32(v) => v.len(),
            Column::U64(v) => v.len(),
            Column::Vec2(v) => v.len(),
            Column::Vec3(v) => v.len(),
        }
    }
    /// Whether nothing is stored.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
    /// The stored bytes and the name of the type, for hashing and files.
    pub fn bytes(&self) -> (&'static str, &[u8]) {
        match self {
            Column::F32(v) => ("f32", bytemuck::cast_slice(v)),
            Column::I32(v) => ("i32", bytemuck::cast_slice(v)),
            Column::U64(v) => ("u64", bytemuck::cast_slice(v)),
            Column::Vec2(v) => ("vec2", bytemuck::cast_slice(v)),
            Column::Vec3(v) => ("vec3", bytemuck::cast_slice(v)),
        }
    }
    /// Where the values lie, which others may share, and the bytes that they hold.
    pub fn buffer(&self) -> (usize, usize) {
        fn of<T>(values: &Arc<Vec<T>>) -> (usize, usize) {
            (Arc::as_ptr(values) as usize, values.capacity() * size_of::<T>())
        }
        match self {
            Column::F32(v) => of(v),
            Column::I32(v) => of(v),
            Column::U64(v) => of(v),
            Column::Vec2(v) => of(v),
            Column::Vec3(v) => of(v),
        }
    }
    /// The values at `pick`, in that order; a shared value stays one value.
    pub fn gather(&self, pick: &[u32]) -> Column {
        fn picked<T: Item>(values: &Arc<Vec<T>>, pick: &[u32]) -> Column {
            T::column(pick.iter().map(|i| values[*i as usize]).collect())
        }
        if self.len() == 1 {
            return self.clone();
        }
        match self {
            Column::F32(v) => picked(v, pick),
            Column::I32(v) => picked(v, pick),
            Column::U64(v) => picked(v, pick),
            Column::Vec2(v) => picked(v, pick),
            Column::Vec3(v) => picked(v, pick),
        }
    }
    /// The values from `start` to `end`; a shared value stays one value.
    pub fn slice(&self, start: usize, end: usize) -> Column {
        fn cut<T: Item>(values: &[T], start: usize, end: usize) -> Column {
            T::column(values[start..end].to_vec())
        }
        if self.len() == 1 {
            return self.clone();
        }
        match self {
            Column::F32(v) => cut(v, start, end),
            Column::I32(v) => cut(v, start, end),
            Column::U64(v) => cut(v, start, end),
            Column::Vec2(v) => cut(v, start, end),
            Column::Vec3(v) => cut(v, start, end),
        }
    }
}

/// What a curve without the attribute `name` has, as one value of the type that `like` holds: the declared default where
/// name and type are those of a declared attribute, else zero.
pub fn default_of(name: &str, like: &Column) -> Column {
    let zero = match like {
        Column::F32(_) => f32::column(vec![0.0]),
        Column::I32(_) => i32::column(vec![0]),
        Column::U64(_) => u64::column(vec![0]),
        Column::Vec2(_) => Vec2::column(vec![Vec2::ZERO]),
        Column::Vec3(_) => Vec3::column(vec![Vec3::ZERO]),
    };
    let same =
        |declared: &Column| std::mem::discriminant(declared) == std::mem::discriminant(&zero);
    declared_default(name).filter(same).unwrap_or(zero)
}

/// A named column.
#[derive(Clone, Debug, PartialEq)]
pub struct Attribute {
    /// Its name, as files show it.
    pub name: Name,
    /// What it has values for.
    pub domain: Domain,
    /// The values.
    pub values: Column,
}

impl Attribute {
    /// Whether it has a value of its own for each point.
    pub fn differs_by_point(&self) -> bool {
        self.domain == Domain::Point && self.values.len() != 1
    }
}

/// How hair that is made from other curves, its parents, comes by an attribute of theirs. What a maker sets itself counts
/// instead.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CarryRule {
    /// A mix of the values of all parents, weighted as their shapes are; of points, of what each parent has there along its
    /// length. Numbers, vectors and colours that nothing else is said of.
    Blended,
    /// That of the nearest parent; of points, that of its point before. Ids and counts.
    Inherited,
    /// The value of the nearest parent if it has one for the whole curve; values per point are not passed on.
    Whole,
    /// None: it says something of the parent alone.
    Own,
}

/// The rule by which hair comes by an attribute with this name: as declared, else by the type that `like` holds.
pub fn carry_of(name: &str, like: &Column) -> CarryRule {
    match RULES.iter().find(|(declared, _)| *declared == name) {
        Some((_, rule)) => *rule,
        None if matches!(like, Column::I32(_) | Column::U64(_)) => CarryRule::Inherited,
        None => CarryRule::Blended,
    }
}

/// An attribute that nodes agree on: its name, type and what is read where it is missing.
#[derive(Clone, Copy, Debug)]
pub struct Declared<T> {
    /// The name in files and fields.
    pub name: &'static str,
    /// What a curve without it has.
    pub default: T,
    /// What it means, with its unit.
    pub doc: &'static str,
}

/// What the values of a declared attribute count: `cm` (true centimetres), `degrees`, or nothing.
pub fn unit_of(name: &str) -> &'static str {
    UNITS.iter().find(|(declared, _)| *declared == name).map_or("", |(_, unit)| unit)
}

/// Whether an attribute is declared as a length, in true centimetres.
pub(super) fn is_length(name: &str) -> bool {
    unit_of(name) == "cm"
}

macro_rules! declare {
    ($($(#[doc = $doc:literal])*
    $id:ident: $ty:ty = $name:literal, $default:expr $(, $unit:ident)? $(=> $rule:ident)?;)*) => {
        $($(#[doc = $doc])* pub const $id: Declared<$ty> =
            Declared { name: $name, default: $default, doc: concat!($($doc),*) };)*
        /// Name, type and meaning of every declared attribute, for the manual.
        pub const DECLARED: &[(&str, &str, &str)] =
            &[$(($name, stringify!($ty), concat!($($doc),*))),*];

        /// What the values of each count.
        const UNITS: &[(&str, &str)] = &[$(($name, stringify!($($unit)?))),*];

        /// How hair comes by those of which not their type says it.
        const RULES: &[(&str, CarryRule)] = &[$($(($name, CarryRule::$rule),)?)*];

        fn declared_default(name: &str) -> Option<Column> {
            match name {
                $($name => Some(<$ty as Item>::column(vec![$default])),)*
                _ => None,
            }
        }
    };
}

/// Shares of a hair between which its [`CURL_DIAMETER`] holds: curls grow from the root on and open toward the tip.
pub const CURL_MIDDLE: [f32; 2] = [0.3, 0.9];

declare! {
    /// Stable id of the curve: 64-bit hash of its parent's id, the seed of the node that made it, and its index. 0:
    /// none.
    ID: u64 = "id", 0 => Own;
    /// Id of the curve it was made from. 0: none.
    PARENT: u64 = "parent", 0 => Own;
    /// Scalp triangle under the root; -1: not bound.
    ROOT_TRIANGLE: i32 = "root_triangle", -1 => Own;
    /// Barycentric coordinates of the root: weights of the triangle's second and third corner.
    ROOT_BARY: Vec2 = "root_bary", Vec2::ZERO => Own;
    /// Texture coordinates of the scalp at the root.
    ROOT_UV: Vec2 = "root_uv", Vec2::ZERO => Own;
    /// Scalp normal closest to the point (or to the root). Unit; zero: unknown.
    SCALP_NORMAL: Vec3 = "scalp_normal", Vec3::ZERO => Whole;
    /// Radius of the cross-section of a cluster or braid strand, cm.
    RADIUS: f32 = "radius", 1.0, cm;
    /// Diameter of a hair, cm.
    WIDTH: f32 = "width", 0.008, cm;
    /// Rotation about the curve of what follows it, degrees, accumulated from the root.
    ROLL: f32 = "roll", 0.0, degrees;
    /// Thickness of a cluster's cross-section relative to its width, 0.02 to 1: 1 is round.
    FLATNESS: f32 = "flatness", 1.0;
    /// How far strands wander from their cluster, 0 to 1.
    FRIZZ: f32 = "frizz", 0.0;
    /// How densely a cluster is filled, 0 to 1.
    DENSITY: f32 = "density", 0.5;
    /// 1 for a CV held in place by a hairpin, 0 for a free one.
    PINNED: i32 = "pinned", 0 => Own;
    /// Normal, pointing out of the hair, of the plane through a cluster's tip that cuts its strands. Unit; zero: not
    /// cut.
    CUT: Vec3 = "cut", Vec3::ZERO => Whole;
    /// Pressure of the pen at each point of a stroke, 0 to 1. It stays with the stroke.
    PRESSURE: f32 = "pressure", 0.0 => Own;
    /// Arc length that a drawn curve had before it was cut, cm; 0: not cut.
    UNCUT: f32 = "uncut_length", 0.0, cm => Own;
    /// Colour, linear Rec.709.
    COLOUR: Vec3 = "colour", Vec3::new(0.09, 0.05, 0.03);
    /// Depth below the skin that the curve may reach, cm.
    ALLOW_DEPTH: f32 = "allow_depth", 0.0, cm => Whole;
    /// Normal of the curve's frame at each point. Unit; zero: unknown.
    NORMAL: Vec3 = "normal", Vec3::ZERO => Whole;
    /// Id of the braid that a strand, stitch or hair belongs to. 0: none.
    BRAID: u64 = "braid", 0;
    /// Direction that the front of the braid faces where this hair joins it. Unit; zero: unknown.
    BRAID_FRONT: Vec3 = "braid_front", Vec3::ZERO => Whole;
    /// Fraction of the source's arc length at which a braid is tied; the end tuft lies beyond it.
    TIED: f32 = "tied", 1.0 => Whole;
    /// Index of the strand within its braid, from 0.
    STRAND: i32 = "strand", 0;
    /// Position of a braid strand in its cycle at the root, 0 to 1.
    PHASE: f32 = "phase", 0.0 => Whole;
    /// Position of a point along the source, as a fraction of arc length, 0 to 1.
    ALONG: f32 = "along", 0.0 => Whole;
    /// Side of the source: -1 left, 1 right (seen along the curve, normal up).
    SIDE: i32 = "side", 0;
    /// Index of the curve's group, such as the stitch that hair from a parting runs to.
    GROUP: i32 = "group", 0;
    /// Arc length before shortening or coiling, cm; 0: unchanged.
    FIBRE: f32 = "fibre_length", 0.0, cm;
    /// Distance of the root from where it was drawn, after the drawing is transferred to this head, cm.
    DRIFT: f32 = "drift", 0.0, cm => Whole;
    /// Id of the section of the scalp, between partings, that the root lies in. 0: none.
    SECTION: u64 = "section", 0;
    /// Id of the parting that a curve on the scalp is a piece of. 0: none.
    PARTING: u64 = "parting", 0;
    /// Index of the stitch at which a hair joins its braid, from 0; -1: none.
    STITCH: i32 = "stitch", -1;
    /// 1 for extension hair fed into a braid, 0 for hair that grows.
    FED: i32 = "fed", 0;
    /// Requested curl diameter in the middle of this hair, from 0.3 to 0.9 of its length, cm; 0: not curled.
    CURL_DIAMETER: f32 = "curl_diameter", 0.0, cm;
    /// Requested mean length of the source curve per turn, cm; 0: not curled.
    CURL_PITCH: f32 = "curl_pitch", 0.0, cm;
    /// Fraction by which the hair's span is shorter than the hair, 0 to 1.
    SHRINKAGE: f32 = "shrinkage", 0.0;
    /// Id of the puff, bun or tail that a hair belongs to. 0: none.
    PUFF: u64 = "puff", 0;
    /// Centre of the outline that the tips of a puff lie on, cm.
    PUFF_CENTRE: Vec3 = "puff_centre", Vec3::ZERO, cm => Whole;
    /// Distance from the puff's centre to its outline at the end of this hair, cm; 0: none.
    PUFF_RADIUS: f32 = "puff_radius", 0.0, cm => Whole;
    /// Requested angle from the top of a puff down to which its tips reach, degrees; 0: unknown.
    PUFF_COVERAGE: f32 = "puff_coverage", 0.0, degrees => Whole;
    /// Requested roughness of a puff's outline: how much deeper the innermost tips end than the outermost, as a
    /// fraction of the radius; how far tips may lie off the outline, cm; and the fraction of hairs that may stick out.
    PUFF_EDGE: Vec3 = "puff_edge", Vec3::ZERO => Whole;
    /// Centre of the ring where hair leaves the tie that holds it, cm.
    TIE: Vec3 = "tie", Vec3::ZERO, cm => Whole;
    /// Radius of that ring, cm; 0: no tie holds the hair.
    TIE_RADIUS: f32 = "tie_radius", 0.0, cm => Whole;
}

/// Thickness that a braid needs at a point of its row for the hair picked up so far, as a fraction of the largest.
pub(crate) const GIRTH: &str = "girth";
/// Fraction of a row's hair that has joined its braid up to a point of the row.
pub(crate) const JOINED: &str = "joined";

/// How clusters and strands are shaped and filled: passed on to those made from them, not to the hair that fills them.
pub(crate) const OF_CLUSTERS: &[&str] =
    &[RADIUS.name, ROLL.name, FLATNESS.name, FRIZZ.name, DENSITY.name, CUT.name, GIRTH, JOINED];

/// Whether an attribute is a user's own, or says how hair looks: what hair takes from a curve that it runs along without being
/// made from it.
pub(crate) fn is_look(name: &str) -> bool {
    let is_declared = DECLARED.iter().any(|(declared, ..)| *declared == name);
    name == COLOUR.name || name == WIDTH.name || !(is_declared || OF_CLUSTERS.contains(&name))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_attribute_counts_what_its_meaning_says() {
        // (An edge holds three numbers, of which one is a length.)
        for (name, _, meaning) in DECLARED.iter().filter(|(name, ..)| *name != PUFF_EDGE.name) {
            for unit in ["cm", "degrees"] {
                let says = meaning.contains(&format!(", {unit}"));
                assert_eq!(says, unit_of(name) == unit, "{name}: {meaning}");
            }
        }
    }
}
