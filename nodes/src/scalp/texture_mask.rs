//! Texture mask: a field from an existing picture, through the head's UVs.
//!
//! Guarantees: values are 0 to 1 as stored in the file. A head without UVs is refused.

use crate::data::field::Field;
use crate::data::scalp::Scalp;
use crate::data::texture::Texture;
use crate::define::{FileData, NodeError, choice, node};
use crate::eval::{EvalCx, Size};
use crate::formats::picture_in::{self, read_picture};
use crate::maths::hash::KeyBuilder;
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
    let beyond = uvs
        .iter()
        .flatten()
        .filter(|uv| uv.is_finite() && (uv.max_element() > 1.001 || uv.min_element() < -0.001));
    let beyond = beyond.count();
    if beyond > 0 {
        let share = 100.0 * beyond as f32 / (3 * uvs.len()) as f32;
        cx.warn(format!(
            "{share:.0} % of the head's uvs lie beyond 0 to 1, where the picture repeats: tiles of their own (UDIM) are not read"
        ));
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
