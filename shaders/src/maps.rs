//! Pictures that lie on a head: read from PNG and JPEG, with smaller copies of themselves for what is far away, and sent to the GPU.
//!
//! Colours are sRGB and are averaged as light; normals are averaged as vectors. JPEG is for looking at alone: its standard leaves
//! last bits to the reader, so evaluation refuses it and knows nothing of this.
//! Guaranteed for any bytes: no panic, and no more memory than [`MOST`] pixels take in the decoder. Not read: other formats, and
//! colour profiles.

use crate::display::{linear_from_srgb, srgb};
use crate::gpu::Gpu;
use crate::pipelines::Layouts;
use coif_nodes::formats::looks::TextureWrap;
use coif_nodes::formats::picture_in::without_profile;
use glam::{Affine2, Vec3};
use image::metadata::Orientation;
use image::{DynamicImage, ImageDecoder, ImageFormat, ImageReader, Limits};
use std::io::Cursor;
use std::sync::{Arc, OnceLock};
use wgpu::TextureFormat;
use zune_jpeg::JpegDecoder;
use zune_jpeg::zune_core::{bytestream::ZCursor, colorspace::ColorSpace, options::DecoderOptions};

/// The most pixels of a picture that is read: 8192 by 8192.
pub const MOST: u64 = 1 << 26;
/// The longest side that is kept; longer ones are halved.
pub const LONGEST: u32 = 8192;
/// A map of heights is grey, one of normals is blue: by so much of 255, on average, blue is above red and green.
const BLUE: u64 = 40;
/// What is wrong is quoted up to so many letters.
const QUOTED: usize = 80;

/// What the numbers of a picture are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Colours, sRGB.
    Colour,
    /// Normals in tangent space.
    Normal,
}

/// A picture and its smaller copies: red, green, blue and alpha of each pixel, row by row from the top.
#[derive(Clone, PartialEq)]
pub struct Texels {
    kind: Kind,
    size: [u32; 2],
    /// Each half as large as the one before, down to one pixel.
    levels: Vec<Vec<u8>>,
}

impl std::fmt::Debug for Texels {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "Texels({} x {}, {:?})", self.size[0], self.size[1], self.kind)
    }
}

impl Texels {
    /// Reads a PNG or JPEG file.
    ///
    /// # Errors
    /// What is wrong with it and what to do, in one line.
    pub fn read(bytes: &[u8], kind: Kind) -> Result<Self, String> {
        let (size, rgba) = match image::guess_format(bytes) {
            Ok(ImageFormat::Png) => read_png(bytes)?,
            Ok(ImageFormat::Jpeg) => read_jpeg(bytes)?,
            _ => {
                return Err("it is no picture that can be read: give a PNG or JPEG file".to_owned());
            }
        };
        let mut texels = Self { kind, size, levels: vec![rgba] };
        let mut size = size;
        while size != [1, 1] {
            let last = texels.levels.last().map_or(&[][..], Vec::as_slice);
            let next = halved(last, size, kind);
            texels.levels.push(next);
            size = size.map(half);
        }
        while texels.size.into_iter().max() > Some(LONGEST) {
            texels.halve();
        }
        Ok(texels)
    }

    /// Width and height, pixels.
    pub fn size(&self) -> [u32; 2] {
        self.size
    }

    /// How many pixels it has, without its copies.
    pub fn count(&self) -> u64 {
        u64::from(self.size[0]) * u64::from(self.size[1])
    }

    /// Keeps the smaller copies alone; a single pixel stays.
    pub fn halve(&mut self) {
        if self.levels.len() > 1 {
            self.levels.remove(0);
            self.size = self.size.map(half);
        }
    }

    /// Whether it is blue, as maps of normals are and maps of heights are not.
    pub fn is_of_normals(&self) -> bool {
        let Some(pixels) = self.levels.first() else { return false };
        let sum = |at: usize| pixels.chunks_exact(4).map(|c| u64::from(c[at])).sum::<u64>();
        let least = BLUE * self.count();
        sum(2) >= sum(0).max(sum(1)) + least
    }
}

fn half(side: u32) -> u32 {
    (side / 2).max(1)
}

fn told(reason: impl std::fmt::Display) -> String {
    let mut text = reason.to_string().replace(['\n', '\r'], " ");
    if text.chars().count() > QUOTED {
        text = text.chars().take(QUOTED).collect::<String>() + "…";
    }
    format!("it cannot be read: {text}; save it anew as PNG or JPEG")
}

fn check_size(width: u64, height: u64) -> Result<(), String> {
    match width * height {
        0 => Err("it has no pixels".to_owned()),
        count if count > MOST => {
            Err(format!("it has {width} x {height} pixels, more than 8192 x 8192: save it smaller"))
        }
        _ => Ok(()),
    }
}

fn read_png(bytes: &[u8]) -> Result<([u32; 2], Vec<u8>), String> {
    let plain = without_profile(bytes);
    let mut reader = ImageReader::with_format(Cursor::new(&*plain), ImageFormat::Png);
    let mut limits = Limits::default();
    limits.max_alloc = Some(8 * MOST);
    reader.limits(limits);
    let mut decoder = reader.into_decoder().map_err(told)?;
    let (width, height) = decoder.dimensions();
    check_size(u64::from(width), u64::from(height))?;
    let turned = decoder.orientation().unwrap_or(Orientation::NoTransforms);
    if turned != Orientation::NoTransforms {
        return Err("it is stored turned or mirrored: save it upright".to_owned());
    }
    let picture = DynamicImage::from_decoder(decoder).map_err(told)?;
    Ok(([width, height], picture.into_rgba8().into_raw()))
}

fn read_jpeg(bytes: &[u8]) -> Result<([u32; 2], Vec<u8>), String> {
    let options = DecoderOptions::default()
        .set_strict_mode(false)
        .set_max_width(usize::MAX)
        .set_max_height(usize::MAX)
        .jpeg_set_out_colorspace(ColorSpace::RGB);
    let mut decoder = JpegDecoder::new_with_options(ZCursor::new(bytes), options);
    decoder.decode_headers().map_err(|err| told(format!("{err:?}")))?;
    let (width, height) = decoder.dimensions().unwrap_or_default();
    check_size(width as u64, height as u64)?;
    let rgb = decoder.decode().map_err(|err| told(format!("{err:?}")))?;
    if rgb.len() != 3 * width * height {
        return Err(told("its pixels are not red, green and blue"));
    }
    let rgba = rgb.chunks_exact(3).flat_map(|c| [c[0], c[1], c[2], 255]).collect();
    Ok(([width as u32, height as u32], rgba))
}

/// The picture at half its size: each pixel is the mean of four.
fn halved(pixels: &[u8], [width, height]: [u32; 2], kind: Kind) -> Vec<u8> {
    let (light, bytes) = tables();
    let (w, h) = (width as usize, height as usize);
    let [to_w, to_h] = [width, height].map(|n| half(n) as usize);
    let mut out = Vec::with_capacity(4 * to_w * to_h);
    for y in 0..to_h {
        let rows = [2 * y, (2 * y + 1).min(h - 1)];
        for x in 0..to_w {
            let columns = [2 * x, (2 * x + 1).min(w - 1)];
            let four = rows.map(|y| columns.map(|x| 4 * (y * w + x)));
            let four = four.as_flattened();
            let sum = |channel: usize| -> u32 {
                four.iter().map(|at| u32::from(pixels[at + channel])).sum()
            };
            match kind {
                Kind::Colour => {
                    for channel in 0..3 {
                        let sum: f32 =
                            four.iter().map(|at| light[usize::from(pixels[at + channel])]).sum();
                        out.push(bytes[(sum * (0.25 * 65535.0) + 0.5) as usize]);
                    }
                }
                // Their length is made whole where they are looked up.
                Kind::Normal => out.extend([0, 1, 2].map(|c| ((sum(c) + 2) / 4) as u8)),
            }
            out.push(((sum(3) + 2) / 4) as u8);
        }
    }
    out
}

/// The light of each sRGB number, and the number of each of 65,536 steps of light.
fn tables() -> &'static (Vec<f32>, Vec<u8>) {
    static TABLES: OnceLock<(Vec<f32>, Vec<u8>)> = OnceLock::new();
    TABLES.get_or_init(|| {
        let light = |n: u32| linear_from_srgb(Vec3::splat(n as f32 / 255.0)).x;
        let number = |n: u32| srgb(Vec3::splat(n as f32 / 65535.0)).x;
        let light = (0..256).map(light).collect();
        let bytes = (0..65536).map(|n| (number(n) * 255.0 + 0.5) as u8).collect();
        (light, bytes)
    })
}

/// A picture and how it is laid.
#[derive(Clone, Debug, PartialEq)]
pub struct Map {
    /// The picture.
    pub texels: Arc<Texels>,
    /// Which set of uvs it lies by: 0 is the head's own.
    pub set: u32,
    /// From uvs, v up, to the picture: 0 to 1 from the left and from the top.
    pub picture_from_uv: Affine2,
    /// Beyond the left and right, and beyond the top and bottom.
    pub wrap: [TextureWrap; 2],
    /// Whether pixels stay hard squares.
    pub nearest: bool,
}

/// What one material of a head is drawn with.
#[derive(Clone, Debug, PartialEq)]
pub struct MaterialMaps {
    /// Linear colour, by which the map is multiplied; none is the skin tone where there is no map, and white where there is.
    pub colour: Option<Vec3>,
    /// Its colours.
    pub colour_map: Option<Map>,
    /// Its normals, green up.
    pub normal_map: Option<Map>,
    /// How far these tilt.
    pub normal_scale: f32,
    /// What is less opaque than this is not there.
    pub cutoff: f32,
}

impl MaterialMaps {
    /// Whether it says how triangles look; else they have the skin tone.
    pub fn is_drawn(&self) -> bool {
        self.colour.is_some() || self.colour_map.is_some() || self.normal_map.is_some()
    }
}

/// A material as `solid_maps.wgsl` reads it.
#[repr(C)]
#[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable)]
struct Numbers {
    colour: [f32; 3],
    cutoff: f32,
    normal_scale: f32,
    none: [f32; 3],
}

/// What a material's triangles are drawn with.
pub(crate) fn bind(gpu: &Gpu, layouts: &Layouts, material: &MaterialMaps) -> wgpu::BindGroup {
    use wgpu::util::{BufferInitDescriptor, DeviceExt};
    let numbers = Numbers {
        colour: material.colour.unwrap_or(Vec3::ONE).to_array(),
        cutoff: material.cutoff,
        normal_scale: if material.normal_map.is_some() { material.normal_scale } else { 0.0 },
        none: [0.0; 3],
    };
    let numbers = gpu.device.create_buffer_init(&BufferInitDescriptor {
        label: Some("material"),
        contents: bytemuck::bytes_of(&numbers),
        usage: wgpu::BufferUsages::UNIFORM,
    });
    let maps = [(&material.colour_map, Kind::Colour), (&material.normal_map, Kind::Normal)];
    let [colour, normal] = maps.map(|(map, kind)| {
        let plain = || Texels { kind, size: [3, 3], levels: vec![vec![255; 36]] };
        let view = match map {
            Some(map) => upload(gpu, &map.texels),
            None => upload(gpu, &plain()),
        };
        (view, sampler(gpu, map.as_ref()))
    });
    let view = wgpu::BindingResource::TextureView;
    let resources = [
        numbers.as_entire_binding(),
        view(&colour.0),
        wgpu::BindingResource::Sampler(&colour.1),
        view(&normal.0),
        wgpu::BindingResource::Sampler(&normal.1),
    ];
    let entries: Vec<_> = (0u32..)
        .zip(resources)
        .map(|(binding, resource)| wgpu::BindGroupEntry { binding, resource })
        .collect();
    gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: Some("material"),
        layout: &layouts.maps,
        entries: &entries,
    })
}

fn upload(gpu: &Gpu, texels: &Texels) -> wgpu::TextureView {
    let most = gpu.device.limits().max_texture_dimension_2d;
    let mut size = texels.size;
    let mut levels = &texels.levels[..];
    while size.into_iter().max() > Some(most) && levels.len() > 1 {
        (size, levels) = (size.map(half), &levels[1..]);
    }
    let extent =
        |[width, height]: [u32; 2]| wgpu::Extent3d { width, height, depth_or_array_layers: 1 };
    let texture = gpu.device.create_texture(&wgpu::TextureDescriptor {
        label: Some("map"),
        size: extent(size),
        mip_level_count: levels.len() as u32,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: match texels.kind {
            Kind::Colour => TextureFormat::Rgba8UnormSrgb,
            Kind::Normal => TextureFormat::Rgba8Unorm,
        },
        usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
        view_formats: &[],
    });
    for (mip_level, level) in (0u32..).zip(levels) {
        let place = wgpu::TexelCopyTextureInfo { mip_level, ..texture.as_image_copy() };
        let layout = wgpu::TexelCopyBufferLayout {
            offset: 0,
            bytes_per_row: Some(4 * size[0]),
            rows_per_image: Some(size[1]),
        };
        gpu.queue.write_texture(place, level, layout, extent(size));
        size = size.map(half);
    }
    texture.create_view(&Default::default())
}

fn sampler(gpu: &Gpu, map: Option<&Map>) -> wgpu::Sampler {
    let [u, v] = map.map_or([TextureWrap::Repeat; 2], |map| map.wrap).map(|wrap| match wrap {
        TextureWrap::Repeat => wgpu::AddressMode::Repeat,
        TextureWrap::Mirror => wgpu::AddressMode::MirrorRepeat,
        TextureWrap::Clamp => wgpu::AddressMode::ClampToEdge,
    });
    let hard = map.is_some_and(|map| map.nearest);
    gpu.device.create_sampler(&wgpu::SamplerDescriptor {
        label: Some("map"),
        address_mode_u: u,
        address_mode_v: v,
        mag_filter: if hard { wgpu::FilterMode::Nearest } else { wgpu::FilterMode::Linear },
        min_filter: wgpu::FilterMode::Linear,
        mipmap_filter: wgpu::MipmapFilterMode::Linear,
        ..Default::default()
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use image::{Rgb, RgbImage, Rgba, RgbaImage};

    fn png(picture: impl Into<DynamicImage>) -> Vec<u8> {
        let mut bytes = Cursor::new(vec![]);
        picture.into().write_to(&mut bytes, ImageFormat::Png).expect("a PNG");
        bytes.into_inner()
    }

    #[test]
    fn a_smaller_copy_has_the_light_of_the_picture() {
        // Half of the pixels black, half white: half the light, which is 188 of 255 in sRGB.
        let board = RgbaImage::from_fn(4, 2, |x, y| match (x + y) % 2 {
            0 => Rgba([0, 0, 0, 255]),
            _ => Rgba([255, 255, 255, 55]),
        });
        let texels = Texels::read(&png(board.clone()), Kind::Colour).expect("a picture");
        assert_eq!((texels.size(), texels.levels.len()), ([4, 2], 3));
        // Alpha is no light: the mean of 255 and 55.
        assert_eq!(texels.levels[1], [188, 188, 188, 155].repeat(2));
        assert_eq!(texels.levels[2], [188, 188, 188, 155]);
        let texels = Texels::read(&png(board), Kind::Normal).expect("a picture");
        assert_eq!(texels.levels[2], [128, 128, 128, 155]);
    }

    #[test]
    fn sides_that_are_no_powers_of_two_and_long_strips_have_copies_down_to_one_pixel() {
        for (width, height, levels) in [(1, 1, 1), (3, 5, 3), (7, 1, 3), (20_000, 2, 14)] {
            let picture = RgbImage::from_pixel(width, height, Rgb([10, 200, 30]));
            let texels = Texels::read(&png(picture), Kind::Colour).expect("a picture");
            // 20,000 is halved twice until it is at most 8,192.
            assert_eq!(texels.levels.len(), if width == 20_000 { 13 } else { levels });
            assert!(texels.size[0] <= LONGEST);
            for level in &texels.levels {
                assert!(level.chunks(4).all(|c| c == [10, 200, 30, 255]));
            }
        }
    }

    #[test]
    fn normals_are_told_from_heights() {
        for (pixel, is) in
            [([128, 128, 255], true), ([150, 110, 230], true), ([128; 3], false), ([255; 3], false)]
        {
            let picture = RgbImage::from_pixel(2, 2, Rgb(pixel));
            let texels = Texels::read(&png(picture), Kind::Normal).expect("a picture");
            assert_eq!(texels.is_of_normals(), is, "{pixel:?}");
        }
    }

    #[test]
    fn what_is_no_picture_is_told_in_one_line() {
        let whole = png(RgbImage::from_pixel(64, 64, Rgb([1, 2, 3])));
        // A header that says 65,536 by 65,536.
        let mut huge = whole.clone();
        huge[16..24].copy_from_slice(&[0, 1, 0, 0, 0, 1, 0, 0]);
        for (bytes, says) in [
            (&b""[..], "PNG or JPEG"),
            (b"GIF89a", "PNG or JPEG"),
            (&whole[..whole.len() - 20], "cannot be read"),
            (&huge, ""),
            (b"\xff\xd8\xff\xe0\x00\x10JFIF", "cannot be read"),
        ] {
            let said = Texels::read(bytes, Kind::Colour).expect_err("no picture");
            assert!(said.contains(says) && said.lines().count() == 1, "{said}");
        }
    }
}
