//! Display transforms: from scene-linear Rec.709 to the code values that a display is sent; twin of
//! `display.wgsl`.
//!
//! Exposure is applied by the caller before. Guaranteed: results lie in 0 to 1, greys stay grey, and
//! a brighter grey never gets darker. Not guaranteed: the same last bit on a GPU.

use glam::{Mat3, Vec3};

/// How scene-linear light is turned into a picture for a display.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Transform {
    /// Soft shoulder, bright colours go to white as on film: for looking at hair.
    ///
    /// Troy Sobotka's AgX in the form that Blender 4 ships, which is by Eary Chow: Rec.2020 inside, a
    /// sigmoid over stops, 18 % grey stays 18 %. Constants are those that Allen Pestaluky publishes in
    /// "AgX-GLSL-Shaders" (2024), without Chow's mixing of hues; colours outside the display's gamut
    /// are clipped. Encoded for sRGB displays.
    #[default]
    Agx,
    /// The curve of IEC 61966-2-1, clipped: for checking colours against values.
    Srgb,
    /// ITU-R BT.1886 with black at 0 (a power of 2.4), clipped: for broadcast monitors.
    Rec1886,
}

impl Transform {
    /// All transforms.
    pub const ALL: [Self; 3] = [Self::Agx, Self::Srgb, Self::Rec1886];

    /// Its name in pictures' metadata and in lists.
    pub fn name(self) -> &'static str {
        match self {
            Self::Agx => "AgX",
            Self::Srgb => "sRGB",
            Self::Rec1886 => "Rec.1886",
        }
    }

    /// The transform of a name; capital letters do not matter.
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|t| t.name().eq_ignore_ascii_case(name))
    }

    /// Its number in `display.wgsl`.
    pub fn number(self) -> u32 {
        self as u32
    }

    /// Exposed scene-linear light to display code values, 0 to 1.
    pub fn apply(self, linear: Vec3) -> Vec3 {
        let linear = Vec3::from_array(linear.to_array().map(|v| if v.is_nan() { 0.0 } else { v }));
        match self {
            Self::Agx => agx(linear),
            Self::Srgb => srgb(linear),
            Self::Rec1886 => unit(linear).powf(1.0 / 2.4),
        }
    }
}

fn unit(c: Vec3) -> Vec3 {
    c.clamp(Vec3::ZERO, Vec3::ONE)
}

// Columns. From Rec.709 to Rec.2020 with its primaries drawn inwards, and back with them let out
// again. Published to four digits and more; rows are scaled to sum to 1, which keeps greys grey.
const INSET: Mat3 = Mat3::from_cols_array(&[
    0.544_868_6,
    0.140_442_4,
    0.088_831_5,
    0.373_752_3,
    0.754_122_2,
    0.178_885_3,
    0.081_379_1,
    0.105_435_4,
    0.732_283_2,
]);
const OUTSET: Mat3 = Mat3::from_cols_array(&[
    1.964_894,
    -0.299_309_1,
    -0.164_356_4,
    -0.856_007_9,
    1.326_391_9,
    -0.238_207_4,
    -0.108_886_1,
    -0.027_082_8,
    1.402_563_8,
]);
/// The curve spans 10 stops under 18 % grey and 6.5 over it.
const STOPS: f32 = 16.5;
/// log2(0.18) - 10, negated: the lowest stop.
const LOWEST_STOP: f32 = 12.473_931;
/// Where 18 % grey lies among the stops, 10 / 16.5, and the code value that it gets, 0.18^(1/2.4).
const PIVOT: (f32, f32) = (0.606_060_6, 0.489_437_1);
/// Slope at the pivot.
const SLOPE: f32 = 2.4;
/// Scales of toe and shoulder: with x and y the pivot's (or for the shoulder, what is left of 1),
/// `((SLOPE x)^-1.5 ((SLOPE x / y)^1.5 - 1))^(-1/1.5)`, so that the ends of the range reach 0 and 1.
const TOE: f32 = -0.565_675_6;
const SHOULDER: f32 = 0.715_198_3;

fn agx(linear: Vec3) -> Vec3 {
    let inset = INSET * linear.clamp(Vec3::splat(2e-10), Vec3::splat(1e10));
    let shown = inset.map(|v| {
        let x = ((v.log2() + LOWEST_STOP) / STOPS).clamp(0.0, 1.0);
        let scale = if x >= PIVOT.0 { SHOULDER } else { TOE };
        let t = SLOPE * (x - PIVOT.0) / scale;
        let code = PIVOT.1 + scale * t * (1.0 + t * t.max(0.0).sqrt()).powf(-2.0 / 3.0);
        code.clamp(0.0, 1.0).powf(2.4)
    });
    srgb(OUTSET * shown)
}

/// sRGB code values, 0 to 1, of scene-linear light: [`Transform::Srgb`].
pub(crate) fn srgb(linear: Vec3) -> Vec3 {
    unit(linear).map(
        |c| {
            if c <= 0.003_130_8 { 12.92 * c } else { 1.055 * c.powf(1.0 / 2.4) - 0.055 }
        },
    )
}

/// Scene-linear light of sRGB code values, 0 to 1: the inverse of [`Transform::Srgb`].
pub(crate) fn linear_from_srgb(encoded: Vec3) -> Vec3 {
    unit(encoded).map(|c| if c <= 0.04045 { c / 12.92 } else { ((c + 0.055) / 1.055).powf(2.4) })
}

/// Rounds code values to 8 bits by a threshold that depends on the pixel's number only; 0 and 1 stay.
pub(crate) fn dithered(encoded: Vec3, pixel: u32) -> [u8; 3] {
    // Short of 0 and 1 by more than what powers round by, so that the ends are met exactly.
    let threshold = 0.0001 + 0.9998 * ((hash(pixel) >> 8) as f32 / 16_777_216.0);
    // `as` saturates: a value at 1 cannot wrap to 0.
    (unit(encoded) * 255.0 + threshold).to_array().map(|v| v.floor() as u8)
}

/// `hash_u` of `common.wgsl`.
fn hash(x: u32) -> u32 {
    let state = x.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
    let word = ((state >> ((state >> 28) + 4)) ^ state).wrapping_mul(277_803_737);
    (word >> 22) ^ word
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Gpu, Precision};

    /// Greys from -16 to +12 stops around 1, finely stepped, with 0.
    fn greys() -> impl Iterator<Item = f32> {
        std::iter::once(0.0).chain((-3200..2400).map(|i| (i as f32 / 200.0).exp2()))
    }

    #[test]
    fn greys_stay_grey_and_never_get_darker_as_light_grows() {
        for transform in Transform::ALL {
            let mut last = -1.0;
            for grey in greys() {
                let shown = transform.apply(Vec3::splat(grey));
                let spread = shown.max_element() - shown.min_element();
                assert!(spread < 0.002, "{transform:?} {grey} {shown}");
                assert!(shown.y >= last - 1e-6, "{transform:?} {grey}: {} after {last}", shown.y);
                last = shown.y;
            }
            assert!(last > 0.99, "{transform:?} ends at {last}");
            assert!(transform.apply(Vec3::ZERO).max_element() < 0.004);
        }
    }

    #[test]
    fn agx_shows_the_grey_card_in_the_middle_and_keeps_room_above_white() {
        let shown = |v: f32| Transform::Agx.apply(Vec3::splat(v)).y;
        assert!((shown(0.18) - srgb(Vec3::splat(0.18)).y).abs() < 1e-3, "{}", shown(0.18));
        assert!((0.75..0.9).contains(&shown(1.0)), "{}", shown(1.0));
        assert!(shown(8.0) < 0.995 && shown(8.0) > shown(4.0));
    }

    #[test]
    fn nothing_leaves_the_range_of_a_display() {
        let extremes = [0.0, 1e-12, 0.01, 0.5, 1.0, 40.0, 1e9, f32::MAX, f32::INFINITY, -1.0, -1e9];
        let extremes = [&extremes[..], &[f32::NAN, f32::NEG_INFINITY]].concat();
        for transform in Transform::ALL {
            for r in &extremes {
                for g in &extremes {
                    for b in &extremes {
                        let shown = transform.apply(Vec3::new(*r, *g, *b));
                        assert!(shown.cmpge(Vec3::ZERO).all() && shown.cmple(Vec3::ONE).all());
                    }
                }
            }
        }
    }

    #[test]
    fn bright_colours_go_to_white_in_agx_and_are_clipped_in_srgb() {
        let lamp = Vec3::new(30.0, 3.0, 0.5);
        let saturation = |c: Vec3| 1.0 - c.min_element() / c.max_element();
        assert!(saturation(Transform::Agx.apply(lamp)) < 0.35);
        assert!(saturation(Transform::Srgb.apply(lamp * 0.02)) > 0.5);
        assert!(Transform::Srgb.apply(lamp).x > 0.999_999);
    }

    #[test]
    fn srgb_and_its_inverse_cancel_out() {
        for i in 0..=1000 {
            let v = Vec3::splat(i as f32 / 1000.0);
            assert!((linear_from_srgb(Transform::Srgb.apply(v)) - v).abs().max_element() < 2e-6);
        }
        // Published pairs of IEC 61966-2-1: half of the code values is 21.4 % of the light.
        assert!((Transform::Srgb.apply(Vec3::splat(0.2140)).x - 0.5).abs() < 1e-3);
        assert!((Transform::Rec1886.apply(Vec3::splat(0.25)).x - 0.5612).abs() < 1e-3);
    }

    #[test]
    fn rounding_keeps_black_white_and_the_mean() {
        for pixel in 0..1000 {
            assert_eq!(dithered(Vec3::ZERO, pixel), [0; 3]);
            assert_eq!(dithered(Transform::Srgb.apply(Vec3::ONE), pixel), [255; 3]);
        }
        let level = Vec3::splat(100.3 / 255.0);
        let mean = (0..20_000).map(|p| f64::from(dithered(level, p)[0])).sum::<f64>() / 20_000.0;
        assert!((mean - 100.3).abs() < 0.02, "{mean}");
    }

    #[test]
    fn names_lead_back_to_transforms_and_numbers_are_those_of_the_shader() {
        for (number, transform) in Transform::ALL.into_iter().enumerate() {
            assert_eq!(Transform::named(&transform.name().to_lowercase()), Some(transform));
            assert_eq!(transform.number() as usize, number);
        }
        assert_eq!(Transform::named("filmic"), None);
    }

    #[test]
    fn the_shader_shows_what_its_twin_shows() {
        let Ok(gpu) = Gpu::new(Precision::Best) else {
            println!("skipped: the_shader_shows_what_its_twin_shows no graphics adapter");
            return;
        };
        let levels = [0.0, 1e-6, 0.002, 0.0031, 0.02, 0.18, 0.5, 0.9, 1.0, 2.5, 16.0, 900.0];
        let mut colours = vec![];
        for r in levels {
            for g in levels {
                colours.extend(levels.map(|b| Vec3::new(r, g, b)));
            }
        }
        for transform in Transform::ALL {
            let body = format!("let c = display(input[i].xyz, {}u);", transform.number());
            let shown = run(&gpu, &body, &colours);
            for (colour, theirs) in colours.iter().zip(&shown) {
                let ours = transform.apply(*colour);
                let off = (ours - *theirs).abs().max_element();
                assert!(off < 5e-4, "{transform:?} {colour}: {ours} and {theirs}");
            }
        }
        let rounded = run(&gpu, "let c = dithered(input[i].xyz, i);", &colours);
        for (k, (colour, theirs)) in colours.iter().zip(&rounded).enumerate() {
            let ours = dithered(*colour, k as u32).map(f32::from);
            assert_eq!((*theirs * 255.0).round().to_array(), ours, "{colour}");
        }
    }

    /// Runs WGSL that computes `c` from `input[i]` for each colour.
    fn run(gpu: &Gpu, body: &str, colours: &[Vec3]) -> Vec<Vec3> {
        use wgpu::util::DeviceExt;
        let text = format!(
            "{}
            @group(0) @binding(0) var<storage, read> input: array<vec4f>;
            @group(0) @binding(1) var<storage, read_write> result: array<vec4f>;
            @compute @workgroup_size(64) fn main(@builtin(global_invocation_id) id: vec3u) {{
                let i = id.x;
                if i < arrayLength(&input) {{ {body} result[i] = vec4f(c, 1.0); }}
            }}",
            crate::source::Source::of("display").text
        );
        let device = &gpu.device;
        let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: None,
            source: wgpu::ShaderSource::Wgsl(text.into()),
        });
        let pipeline = device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label: None,
            layout: None,
            module: &module,
            entry_point: None,
            compilation_options: Default::default(),
            cache: None,
        });
        let words: Vec<[f32; 4]> = colours.iter().map(|c| c.extend(1.0).to_array()).collect();
        let input = device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
            label: None,
            contents: bytemuck::cast_slice(&words),
            usage: wgpu::BufferUsages::STORAGE,
        });
        let buffer = |usage| {
            let size = input.size();
            device.create_buffer(&wgpu::BufferDescriptor {
                label: None,
                size,
                usage,
                mapped_at_creation: false,
            })
        };
        let result = buffer(wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC);
        let staging = buffer(wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST);
        let bind = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: None,
            layout: &pipeline.get_bind_group_layout(0),
            entries: &[
                wgpu::BindGroupEntry { binding: 0, resource: input.as_entire_binding() },
                wgpu::BindGroupEntry { binding: 1, resource: result.as_entire_binding() },
            ],
        });
        let mut encoder = device.create_command_encoder(&Default::default());
        {
            let mut pass = encoder.begin_compute_pass(&Default::default());
            pass.set_pipeline(&pipeline);
            pass.set_bind_group(0, &bind, &[]);
            pass.dispatch_workgroups(colours.len().div_ceil(64) as u32, 1, 1);
        }
        encoder.copy_buffer_to_buffer(&result, 0, &staging, 0, input.size());
        gpu.queue.submit([encoder.finish()]);
        staging.slice(..).map_async(wgpu::MapMode::Read, |_| {});
        gpu.wait();
        let bytes = staging.slice(..).get_mapped_range().unwrap();
        let words: &[[f32; 4]] = bytemuck::cast_slice(&bytes);
        words.iter().map(|w| Vec3::new(w[0], w[1], w[2])).collect()
    }
}
