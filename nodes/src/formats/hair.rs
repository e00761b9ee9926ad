//! Cem Yuksel's `.hair`: strands as one binary file, out and in.
//!
//! ```text
//! [header, 128 bytes] [u16 segments per strand] [f32x3 points] [f32 thickness per point]
//! [f32 transparency per point] [f32x3 colours per point]
//! ```
//!
//! All arrays but the points are optional, by the bits of the header. Little-endian. The format
//! states neither units nor axes: the writer says both in the header's text, the reader passes the
//! numbers on as they are. Segments are 16 bits, so a strand has at most 65,536 points.
//!
//! Guaranteed: the same groom gives the same bytes, and the reader allocates no more than the file
//! is long, but for 4 bytes for each strand that the file backs with points.
//! See <http://www.cemyuksel.com/research/hairmodels/>.

use super::{Chunks, FormatError};
use glam::Vec3;
use std::io::{BufWriter, Write};

const MAGIC: [u8; 4] = *b"HAIR";
const HEADER: usize = 128;
/// Where the header's text begins; it fills the rest.
const INFO_AT: usize = 40;
const HAS_SEGMENTS: u32 = 1;
const HAS_POINTS: u32 = 2;
const HAS_THICKNESS: u32 = 4;
const HAS_COLORS: u32 = 16;

/// Strands to be written. Lengths are centimetres, Y up.
#[derive(Clone, Debug)]
pub struct HairSet<'a> {
    /// Points of each strand, 1 to 65,536.
    pub counts: Chunks<'a, i32>,
    /// Root to tip, strand after strand.
    pub points: Chunks<'a, Vec3>,
    /// Diameters.
    pub thickness: Thickness<'a>,
    /// Linear colour for each point, or one for all in the header.
    pub colors: Colors<'a>,
    /// Program and version, for the header's text; what does not fit is cut.
    pub generator: String,
}

/// Diameters in centimetres.
#[derive(Clone, Debug)]
pub enum Thickness<'a> {
    /// One for all, in the header.
    Default(f32),
    /// One for each point.
    Points(Chunks<'a, f32>),
}

/// Linear colours, 0 to 1.
#[derive(Clone, Debug)]
pub enum Colors<'a> {
    /// One for all, in the header.
    Default(Vec3),
    /// One for each point.
    Points(Chunks<'a, Vec3>),
}

/// Strands as read, in the file's own units and axes.
#[derive(Clone, Debug, PartialEq)]
pub struct ReadHair {
    /// Points of each strand, at least 1.
    pub counts: Vec<u32>,
    /// Root to tip, strand after strand; finite.
    pub points: Vec<Vec3>,
    /// One diameter for each point, or one for all.
    pub thickness: Vec<f32>,
    /// The header's text.
    pub info: String,
}

/// Writes strands. The segments array is left out when all strands are equally long.
///
/// # Errors
/// The output failed, counts do not add up to the points, a strand has no point or more than the
/// format can count, or an array is not as long as the points.
pub fn write(hair: &HairSet, out: &mut (impl Write + ?Sized)) -> Result<(), FormatError> {
    let shape = Shape::of(hair)?;
    let mut out = BufWriter::with_capacity(1 << 18, out);
    out.write_all(&header(hair, &shape))?;
    if shape.bits & HAS_SEGMENTS != 0 {
        for &count in hair.counts.values() {
            out.write_all(&((count - 1) as u16).to_le_bytes())?;
        }
    }
    put_all(&hair.points, &mut out)?;
    if let Thickness::Points(thickness) = &hair.thickness {
        put_all(thickness, &mut out)?;
    }
    if let Colors::Points(colors) = &hair.colors {
        put_all(colors, &mut out)?;
    }
    Ok(out.flush()?)
}

fn put_all<T: bytemuck::NoUninit>(
    values: &Chunks<T>,
    out: &mut impl Write,
) -> Result<(), FormatError> {
    values.slices().try_for_each(|slice| Ok(out.write_all(bytemuck::cast_slice(slice))?))
}

fn header(hair: &HairSet, shape: &Shape) -> [u8; HEADER] {
    let (thickness, color) = match (&hair.thickness, &hair.colors) {
        (Thickness::Default(thickness), Colors::Default(color)) => (*thickness, *color),
        (Thickness::Default(thickness), _) => (*thickness, Vec3::ONE),
        (_, Colors::Default(color)) => (0.0, *color),
        _ => (0.0, Vec3::ONE),
    };
    let mut header = [0u8; HEADER];
    header[..4].copy_from_slice(&MAGIC);
    let words = [
        shape.strands,
        shape.points,
        shape.bits,
        shape.default_segments,
        thickness.to_bits(),
        0, // transparency
        color.x.to_bits(),
        color.y.to_bits(),
        color.z.to_bits(),
    ];
    header[4..INFO_AT].copy_from_slice(bytemuck::cast_slice(&words));
    let info = format!("units cm, Y up, {}", hair.generator);
    // Readers print the text as a C string: the last byte stays 0.
    let length = info.floor_char_boundary(HEADER - INFO_AT - 1);
    header[INFO_AT..INFO_AT + length].copy_from_slice(&info.as_bytes()[..length]);
    header
}

/// What the header states of checked strands.
struct Shape {
    strands: u32,
    points: u32,
    bits: u32,
    default_segments: u32,
}

impl Shape {
    fn of(hair: &HairSet) -> Result<Self, FormatError> {
        let mut counted = 0usize;
        let first = hair.counts.values().next().copied().unwrap_or(1);
        let mut bits = HAS_POINTS;
        for (strand, &count) in hair.counts.values().enumerate() {
            check_strand(strand, count)?;
            counted += count as usize;
            if count != first {
                bits |= HAS_SEGMENTS;
            }
        }
        let points = hair.points.len();
        if counted != points {
            return Err(FormatError::at(
                "strands",
                format!("they count {counted} points, but there are {points}"),
            ));
        }
        if let Thickness::Points(thickness) = &hair.thickness {
            bits |= HAS_THICKNESS;
            check_length("thickness", thickness.len(), points)?;
        }
        if let Colors::Points(colors) = &hair.colors {
            bits |= HAS_COLORS;
            check_length("colors", colors.len(), points)?;
        }
        Ok(Self {
            strands: header_count("strands", hair.counts.len())?,
            points: header_count("points", points)?,
            bits,
            default_segments: (first - 1) as u32,
        })
    }
}

fn check_strand(strand: usize, count: i32) -> Result<(), FormatError> {
    if (1..=65_536).contains(&count) {
        return Ok(());
    }
    let place = format!("strand {strand}");
    Err(FormatError::at(
        place,
        format!("{count} points: a .hair strand has 1 to 65536, that is 0 to 65535 segments"),
    ))
}

fn check_length(array: &str, found: usize, points: usize) -> Result<(), FormatError> {
    if found == points {
        return Ok(());
    }
    Err(FormatError::at(array, format!("{found} values for {points} points")))
}

fn header_count(what: &str, count: usize) -> Result<u32, FormatError> {
    let too_many = |_| FormatError::at(what, format!("{count} are more than a .hair file counts"));
    u32::try_from(count).map_err(too_many)
}

/// Reads strands. Transparency, colours, arrays of unknown bits (LuxCore's uvs are one) and whatever
/// else lies behind the thickness are passed over.
///
/// # Errors
/// No `.hair` file, no points in it, an array that ends before the header says, segments that do not
/// add up to the points, or a point or thickness that is no finite number.
pub fn read(bytes: &[u8]) -> Result<ReadHair, FormatError> {
    let (header, arrays) = bytes.split_at_checked(HEADER).ok_or_else(|| {
        FormatError::at("header", format!("{} bytes, shorter than the {HEADER} of it", bytes.len()))
    })?;
    if header[..4] != MAGIC {
        return Err(FormatError::at("byte 0", "no .hair file: it does not begin with HAIR"));
    }
    let word = |at: usize| {
        u32::from_le_bytes([header[at], header[at + 1], header[at + 2], header[at + 3]])
    };
    let (strands, points, bits) = (word(4) as usize, word(8) as usize, word(12));
    if bits & HAS_POINTS == 0 {
        return Err(FormatError::at("byte 12", "the file has no points"));
    }
    let mut arrays = Arrays { rest: arrays, position: HEADER };
    let segments: Option<Vec<u16>> = match bits & HAS_SEGMENTS {
        0 => None,
        _ => Some(arrays.take("segments", strands)?),
    };
    let default_segments = word(16);
    check_counts(segments.as_deref(), strands, points, default_segments)?;
    let points_read: Vec<Vec3> = arrays.take("points", points)?;
    let thickness = match bits & HAS_THICKNESS {
        0 => vec![f32::from_bits(word(20))],
        _ => arrays.take("thickness", points)?,
    };
    check_finite("point", points_read.iter().map(|point| point.is_finite()))?;
    check_finite("thickness", thickness.iter().map(|width| width.is_finite()))?;
    // Only now are there known to be enough points for so many strands.
    let counts = match segments {
        Some(segments) => segments.iter().map(|&count| count as u32 + 1).collect(),
        None if strands == 0 => Vec::new(),
        None => vec![default_segments + 1; strands],
    };
    let info = &header[INFO_AT..];
    let info = info.split(|&byte| byte == 0).next().unwrap_or(info);
    let info = String::from_utf8_lossy(info).into_owned();
    Ok(ReadHair { counts, points: points_read, thickness, info })
}

/// Makes sure that the strands add up to the points. Each has at least one, so there are no more
/// strands than points.
fn check_counts(
    segments: Option<&[u16]>,
    strands: usize,
    points: usize,
    default_segments: u32,
) -> Result<(), FormatError> {
    let counted: u64 = match segments {
        Some(segments) => segments.iter().map(|&count| count as u64 + 1).sum(),
        None => strands as u64 * (default_segments as u64 + 1),
    };
    if counted == points as u64 {
        return Ok(());
    }
    Err(FormatError::at(
        "segments",
        format!("{strands} strands count {counted} points, but the header says {points}"),
    ))
}

fn check_finite(what: &str, values: impl Iterator<Item = bool>) -> Result<(), FormatError> {
    match values.enumerate().find(|(_, finite)| !finite) {
        Some((index, _)) => {
            Err(FormatError::at(format!("{what} {index}"), "the value is no finite number"))
        }
        None => Ok(()),
    }
}

/// The bytes after the header, taken array by array.
struct Arrays<'a> {
    rest: &'a [u8],
    position: usize,
}

impl Arrays<'_> {
    /// Copies the next `count` values, after making sure that the file has them.
    fn take<T: bytemuck::Pod>(&mut self, what: &str, count: usize) -> Result<Vec<T>, FormatError> {
        let length = count.checked_mul(size_of::<T>());
        let Some((head, tail)) = length.and_then(|length| self.rest.split_at_checked(length))
        else {
            let left = self.rest.len();
            return Err(FormatError::at(
                format!("byte {}", self.position),
                format!("the header states {count} {what}, but only {left} bytes follow"),
            ));
        };
        self.rest = tail;
        self.position += head.len();
        let mut values = vec![T::zeroed(); count];
        bytemuck::cast_slice_mut::<T, u8>(&mut values).copy_from_slice(head);
        Ok(values)
    }
}
