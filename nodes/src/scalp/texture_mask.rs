//! Texture mask: a field from an existing picture, through the head's UVs.
//!
//! Guarantees: values are 0 to 1 as stored in the file. A head without UVs is refused, and so is one whose skin lies in several
//! tiles of UVs where hair grows (UDIM): one picture cannot serve them.

use crate::data::field::Field;
use crate::data::scalp::Scalp;
use crate::data::texture::Texture;
use crate::define::{FileData, NodeError, choice, node};
use crate::eval::{EvalCx, Size};
use crate::formats::picture_in::{self, read_picture};
use crate::maths::hash::KeyBuilder;
use glam::Vec2;
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

node! {
    /// Reads one channel of an image through the head's UVs. Wire it to any field, or to the base of a painted mask.
    "texture_mask", version 1, label "Texture mask",
        words "texture map image picture png tiff tif uv paint weight density length mari substance ptex grey";
    inputs {
        /// PNG or TIFF file, 8 or 16 bits per channel, read as raw data without a colour space.
        file: Arc<FileData>, holds(Holds::Picture), words("image picture map path");
        /// The head; it needs UVs.
        scalp: Arc<Scalp>;
        /// Channel to read.
        channel: Channel = Channel::Luminance, words("red green blue alpha luminance");
        /// Invert the values: black is 1 and white is 0.
        invert: bool = false, words("negative flip opposite");
    }
    outputs {
        /// The channel's value, 0 to 1, at the root of each hair.
        mask: Arc<Field>;
    }
}

choice! {
    /// Channel to read.
    Channel {
        /// Luminance of the pixel.
        Luminance = "luminance",
        /// Red.
        Red = "red",
        /// Green.
        Green = "green",
        /// Blue.
        Blue = "blue",
        /// Alpha; 1 if the file has none.
        Alpha = "alpha",
    }
}

fn eval(cx: &EvalCx, inputs: Inputs) -> Result<Outputs, NodeError> {
    let file = &inputs.file;
    let refused = |reason: String| NodeError::Refused { file: file.path.clone(), reason };
    let Some(uvs) = inputs.scalp.uvs() else {
        return Err(NodeError::failed(
            "the head has no uvs to lay a picture by: paint a mask, or give the mesh uvs",
        ));
    };
    match Layout::of(uvs, &inputs.scalp) {
        Layout::OneTile => {}
        Layout::Repeats(share) => cx.warn(format!(
            "{} of the triangles that hair grows on reach beyond 0 to 1 in their uvs, where the picture repeats",
            percent(share)
        )),
        Layout::Tiles(tiles) => {
            return Err(NodeError::failed(format!(
                "where hair grows, the head's uvs lie in {} tiles (UDIM {}), and textures of several tiles are not read: give a mesh \
                 whose scalp lies in one tile, with the picture of that tile, or paint a mask",
                tiles.len(),
                listed(&tiles)
            )));
        }
    }
    cx.may_make(&Size::of(&[("bytes of a picture", file.bytes.len() as f64)]))?;
    let channel = match inputs.channel {
        Channel::Luminance => picture_in::Channel::Luminance,
        Channel::Red => picture_in::Channel::Of(0),
        Channel::Green => picture_in::Channel::Of(1),
        Channel::Blue => picture_in::Channel::Of(2),
        Channel::Alpha => picture_in::Channel::Of(3),
    };
    let mut grey = read_picture(&file.bytes, channel).map_err(refused)?;
    cx.check()?;
    if inputs.invert {
        grey.pixels.iter_mut().for_each(|x| *x = u16::MAX - *x);
    }
    let source = KeyBuilder::new("picture").int(grey.width as u64).column(&grey.pixels).finish();
    let texture = Texture::new(source, inputs.scalp.clone(), grey.width, grey.pixels);
    let texture = texture.ok_or_else(|| refused("it has no pixels".to_owned()))?;
    Ok(Outputs { mask: Field::Texture(texture.into()).into() })
}

/// How UVs lie where hair grows.
#[derive(Debug, PartialEq)]
enum Layout {
    /// In one tile, whichever.
    OneTile,
    /// Over edges of tiles, for a picture that repeats: which share of the triangles lies beyond 0 to 1.
    Repeats(f32),
    /// In several tiles, hardly any over their edges: their numbers.
    Tiles(BTreeSet<i64>),
}

impl Layout {
    fn of(uvs: &[[Vec2; 3]], scalp: &Scalp) -> Self {
        /// So far over an edge is on it.
        const SLACK: f32 = 1e-3;
        /// The lowest and the highest corner that count, far beyond any layout.
        const FAR: f32 = 1e6;
        /// Fewer than one triangle in so many are slips of whoever laid the UVs out.
        const FEW: usize = 200;
        let grows = |t: &usize| scalp.highest(*t as u32) > 0.0;
        let mut tiles: BTreeMap<i64, usize> = BTreeMap::new();
        let (mut all, mut beyond, mut over) = (0, 0, 0);
        for triangle in (0..uvs.len()).filter(grows) {
            let uvs = uvs[triangle];
            if uvs.iter().any(|uv| !uv.is_finite() || uv.abs().max_element() > FAR) {
                continue;
            }
            let (low, high) = (uvs[0].min(uvs[1]).min(uvs[2]), uvs[0].max(uvs[1]).max(uvs[2]));
            let tile = ((low + high) * 0.5).floor();
            let reaches = |tile: Vec2| {
                (tile - low).max_element() > SLACK || (high - tile).max_element() > 1.0 + SLACK
            };
            // Tiles are counted from 1001, ten in a row; none lies left of them, below, or right of the tenth.
            let is_tile = tile.min_element() >= 0.0 && tile.x < 10.0;
            all += 1;
            beyond += usize::from(reaches(Vec2::ZERO));
            over += usize::from(reaches(tile) || !is_tile);
            *tiles.entry(1001 + tile.x as i64 + 10 * tile.y as i64).or_default() += 1;
        }
        let is_one = tiles.len() < 2 && over == 0;
        tiles.retain(|_, n| *n * FEW >= all);
        match over * FEW < all && tiles.len() > 1 {
            true => Self::Tiles(tiles.into_keys().collect()),
            false if is_one || beyond == 0 => Self::OneTile,
            false => Self::Repeats(beyond as f32 / all as f32),
        }
    }
}

/// A share that is not zero, in words.
fn percent(share: f32) -> String {
    match 100.0 * share {
        small if small < 1.0 => "less than 1 %".to_owned(),
        percent => format!("{percent:.0} %"),
    }
}

/// The first few tiles.
fn listed(tiles: &BTreeSet<i64>) -> String {
    const MOST: usize = 6;
    let mut all: Vec<String> = tiles.iter().take(MOST).map(i64::to_string).collect();
    if tiles.len() > MOST {
        all.push("...".to_owned());
    }
    all.join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::attributes::ROOT_UV;
    use crate::data::curves::Curves;
    use crate::data::strokes::{Brush, Mode, Sample, Stroke, Strokes};
    use crate::define::Value;
    use crate::testing::{curves_of, fails, head, run};
    use image::{GrayImage, ImageFormat, Luma};
    use std::io::Cursor;

    /// A picture that rises from black on its left to white on its right, as a PNG.
    fn ramp() -> Value {
        let picture = GrayImage::from_fn(256, 8, |x, _| Luma([x as u8]));
        let mut bytes = Cursor::new(vec![]);
        picture.write_to(&mut bytes, ImageFormat::Png).unwrap();
        file("ramp.png", &bytes.into_inner())
    }

    fn file(path: &str, bytes: &[u8]) -> Value {
        let (path, extension) = (path.to_owned(), "png".to_owned());
        let file = FileData { path, extension, bytes: bytes.into(), sides: Default::default() };
        Value::File(file.into())
    }

    fn guides(scalp: &Arc<Scalp>) -> Curves {
        let set = [("scalp", scalp.clone().into()), ("count", Value::Int(200))];
        curves_of(&run(crate::by_id("scatter_guides").unwrap(), &set).0[0]).clone()
    }

    fn field(node: &str, set: &[(&str, Value)]) -> (Arc<Field>, Vec<String>) {
        let (mut out, said) = run(crate::by_id(node).unwrap(), set);
        match out.remove(0) {
            Value::Field(field) => (field, said),
            other => panic!("a {}", other.type_name()),
        }
    }

    /// Each curve's value, and the u at its root.
    fn values(field: &Field, curves: &Curves, scalp: &Scalp) -> Vec<(f32, f32)> {
        let all = curves.tufts().iter().flat_map(|tuft| {
            let values = field.on(tuft, Some(scalp), (0.0, 1.0)).unwrap();
            let uv = tuft.view(ROOT_UV);
            let each = 0..tuft.len();
            each.map(|i| (values.at(i, 0, 0.0), uv.at(i, 0).x)).collect::<Vec<_>>()
        });
        all.collect()
    }

    #[test]
    fn hair_reads_the_picture_at_the_uv_of_its_root_and_a_painted_mask_begins_with_it() {
        let scalp = head(&[]);
        let curves = guides(&scalp);
        let set = [("scalp", scalp.clone().into()), ("file", ramp())];
        let (mask, said) = field("texture_mask", &set);
        assert!(said.is_empty(), "{said:?}");
        // Pixel k of 256 is k / 255 at the u of its middle: off by half a pixel at most.
        let read = values(&mask, &curves, &scalp);
        assert!(read.len() == 200 && read.iter().all(|(x, u)| (x - u).abs() < 0.003), "{read:?}");
        let (low, high) = read.iter().fold((1f32, 0f32), |(l, h), (x, _)| (l.min(*x), h.max(*x)));
        assert!(high - low > 0.2, "{low} {high}");
        let (inverted, _) = field("texture_mask", &[&set[..], &[("invert", true.into())]].concat());
        for ((a, _), (b, _)) in read.iter().zip(values(&inverted, &curves, &scalp)) {
            assert!((a + b - 1.0).abs() < 1e-4, "{a} {b}");
        }
        // A stroke erases it where it passes, and leaves it elsewhere.
        let root = curves.tufts()[0].curve(0)[0];
        let position = scalp.frame().head_from_point(root);
        let at = Sample { position, pressure: 1.0, ..Sample::default() };
        let brush = Brush { mode: Mode::Erase, radius: 1.0, ..Brush::default() };
        let stroke = Stroke { brush: Some(brush), ..Stroke::new(1, vec![at]) };
        let set = [
            ("scalp", scalp.clone().into()),
            ("strokes", Strokes(vec![stroke]).into()),
            ("base", Value::Field(mask)),
        ];
        let over = values(&field("paint_mask", &set).0, &curves, &scalp);
        assert!(over[0].0 < 0.01, "{:?}", over[0]);
        let same = read.iter().zip(&over).filter(|(a, b)| a == b).count();
        assert!(same > 150, "{same}");
    }

    #[test]
    fn one_picture_serves_one_tile_of_uvs_and_no_more() {
        use crate::data::scalp::{HeadFrame, REGION};
        use crate::maths::closest::Surface;
        // Two triangles that hair grows on, and one that it does not.
        let points = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0], [5, 0, 0], [6, 0, 0], [5, 1, 0]];
        let points = points.map(|p| glam::IVec3::from(p).as_vec3()).to_vec();
        let surface = || Surface::new(points.clone(), vec![[0, 1, 2], [1, 3, 2], [4, 5, 6]]);
        let region = [vec![1.0; 4], vec![0.0; 3]].concat();
        let triangle = |u: f32, v: f32, size: f32| {
            let at = Vec2::new(u, v);
            [at, at + Vec2::X * size, at + Vec2::Y * size]
        };
        let of = |uvs: [[Vec2; 3]; 3]| {
            let masks = [(REGION.to_owned(), region.clone())].into();
            let scalp = Scalp::new(surface(), Some(uvs.to_vec()), HeadFrame::IDENTITY, masks);
            let set = [("scalp", Value::from(Arc::new(scalp))), ("file", ramp())];
            let uvs_of = |values: &[(&str, Value)]| match &values[0].1 {
                Value::Scalp(scalp) => Layout::of(scalp.uvs().unwrap(), scalp),
                other => panic!("a {}", other.type_name()),
            };
            (uvs_of(&set), set)
        };
        let check = |a: [Vec2; 3], b: [Vec2; 3], expected: Layout| {
            // The body may lie anywhere.
            assert_eq!(of([a, b, triangle(7.25, 3.25, 0.5)]).0, expected, "{a:?} {b:?}");
        };
        let tiles = |numbers: &[i64]| Layout::Tiles(numbers.iter().copied().collect());
        let first = triangle(0.0, 0.0, 1.0);
        check(first, triangle(0.5, 0.5, 0.5), Layout::OneTile);
        check(first, triangle(0.5, 0.5, 0.5004), Layout::OneTile);
        check(triangle(3.0, 1.0, 1.0), triangle(3.5, 1.5, 0.5), Layout::OneTile);
        check(first, triangle(1.0, 0.0, 1.0), tiles(&[1001, 1002]));
        check(triangle(9.0, 0.0, 1.0), triangle(1.25, 2.0, 0.5), tiles(&[1010, 1022]));
        // Over an edge, left of 0 or beyond the tenth of a row nothing is a tile: such pictures repeat.
        check(first, triangle(0.75, 0.0, 0.5), Layout::Repeats(0.5));
        check(first, triangle(-1.0, 0.0, 1.0), Layout::Repeats(0.5));
        check(first, triangle(10.0, 0.0, 1.0), Layout::Repeats(0.5));
        let (_, set) = of([first, triangle(6.0, 0.0, 1.0), first]);
        let fault = fails(&NODE, &set);
        assert!(fault.contains("2 tiles (UDIM 1001, 1007)"), "{fault}");
        let (_, said) = field("texture_mask", &of([first, triangle(0.75, 0.0, 0.5), first]).1);
        assert!(said.len() == 1 && said[0].starts_with("50 % of the triangles"), "{said:?}");
        assert_eq!([0.001, 0.006, 0.126].map(percent), ["less than 1 %", "less than 1 %", "13 %"]);
    }

    #[test]
    fn what_cannot_be_read_is_told() {
        let scalp = || ("scalp", head(&[]).into());
        let told = |set: &[(&str, Value)]| fails(&NODE, set);
        let fault = told(&[scalp()]);
        assert!(fault.contains("file"), "{fault}");
        let fault = told(&[scalp(), ("file", file("a/b.png", b"nothing"))]);
        assert!(fault.contains("a/b.png") && fault.contains("no picture"), "{fault}");
        // (The ball of tests has no UVs.)
        let ball = crate::data::scalp::tests::shared_ball();
        let fault = told(&[("scalp", ball.into()), ("file", ramp())]);
        assert!(fault.contains("no uvs"), "{fault}");
    }
}
