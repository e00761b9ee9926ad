//! The renderer: hair, solids, lights and a camera in; a scene-linear picture out, refined sample by sample.
//!
//! # How a picture is made
//! When hair or lights change: hair is summed into voxels ([`Pass::Density`]); for each voxel it is found how open it is
//! ([`Pass::Volume`]); for each light, solids are drawn into a depth map ([`Pass::SolidShadow`]) and hair into a deep opacity map
//! ([`Pass::OpacityNear`], [`Pass::OpacityCount`]).
//! Then, sample after sample with the camera shaken by a fraction of a pixel: solids are rasterised ([`Pass::Solids`]),
//! visibility starts from their depth ([`Pass::Clear`]), strands are splatted into it ([`Pass::Splat`]; on adapters without
//! 64-bit atomics [`Pass::Name`] follows), and every pixel is shaded once into a sum ([`Pass::Shade`]), tile by tile with what
//! the tile holds: hair, solids, or the backdrop alone.
//! One sample of light [`Effort`] is what a moving view shows; 64 of full effort are a still.
//!
//! # Slices
//! All work is cut into slices that take about 25 ms on the adapter at hand, as measured on the slices before, so that
//! nobody waits long for a software adapter. Between two slices anything may change; what was half done is dropped.
//!
//! **Invariant:** all sums over strands are integer sums and every pixel is shaded on its own, so that pictures are the same
//! to the last bit for any number of threads and any slicing. Random numbers hang from places in space, pixels and samples, so
//! that what was drawn or uploaded before leaves no trace; `strands.rs` names the one exception.

use crate::camera::{Camera, PORTRAIT_FOCAL, Sphere};
use crate::frame::Frame;
use crate::gpu::Gpu;
use crate::hair::{Model, ScatterTable};
use crate::light::Rig;
use crate::picture::Picture;
use crate::pipelines::{self, Holds, Layouts, Pipelines, ShadeFor};
use crate::solids::Solids;
use crate::strands::{Blocks, Slice, Strands, Uploaded};
use crate::surface::{RootGrid, Solid};
use crate::view::{Paint, Shading};
use bytemuck::Zeroable;
use coif_nodes::data::curves::{Curves, Tuft};
use glam::Vec3;
use std::collections::{HashMap, VecDeque};
use std::sync::Arc;
use std::time::{Duration, Instant};
use targets::{Grid, Maps, Tables, Targets, group, lookups, storage};
use wgpu::BufferUsages as B;

mod shown;
mod targets;
#[cfg(test)]
mod tests;
mod work;

/// How long a slice should take on the adapter. Shorter costs submissions, longer makes whoever waits feel it; half of
/// the 50 ms that a viewport may block.
const SLICE: Duration = Duration::from_millis(25);
/// Texels across a light's opacity map.
const OPACITY_MAP: u32 = 1024;
/// Texels that the walks of one opacity map may visit in all. More is slower, less is grainier; at 6 million the pictures of
/// 100,000 strands differ from the full walk by less than their own grain after 32 samples.
const OPACITY_VISITS: f64 = 6.0e6;
/// Bytes from one slice's parameters to the next: the alignment that every adapter grants.
const SLICE_STRIDE: u64 = 256;
/// Slices that one submission may hold.
const MOST_SLICES: u64 = 64;

/// How hair is drawn, whatever its colour.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Look {
    /// Which published model scatters light.
    pub model: Model,
    /// Roughness along the hair, 0.05 to 1.
    pub beta_m: f32,
    /// Roughness around the hair, 0.05 to 1.
    pub beta_n: f32,
    /// Tilt of the cuticle's scales, degrees, 0 to 5.
    pub tilt_degrees: f32,
    /// Gain of the first highlight; 1 is physical.
    pub specular: f32,
    /// Coverage is multiplied by this: 1 is hair, 0.1 lets one see through to the roots. Shadows stay whole.
    pub opacity: f32,
    /// Share of the strands that is drawn, over 0, at most 1; widths make up for the rest.
    pub share: f32,
    /// How many strands of the final hair each strand that is given stands for, 1 or more: it is drawn, and casts shadows, as wide as
    /// all of them together.
    pub stands_for: f32,
    /// How strongly roots darken the skin, 0 to 1.
    pub scalp_tint: f32,
}

impl Default for Look {
    fn default() -> Self {
        Self {
            model: Model::Karis,
            beta_m: 0.3,
            beta_n: 0.3,
            tilt_degrees: 2.5,
            specular: 1.0,
            opacity: 1.0,
            share: 1.0,
            stands_for: 1.0,
            scalp_tint: 0.9,
        }
    }
}

/// How much work the light of a picture is worth.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Effort {
    /// All of it: what is judged, compared and saved.
    #[default]
    Still,
    /// What keeps up with a hand that drags something on a software adapter: coarser voxels and shadow maps, fewer looks at
    /// them, and a light's maps stay where they are while only hair changes. The same picture but for grain and the finest
    /// shadows; it may depend on what was drawn before.
    Moving,
}

impl Effort {
    /// Voxels along the longest side of the grid of light.
    fn voxels(self) -> f32 {
        match self {
            Self::Still => 96.0,
            Self::Moving => 28.0,
        }
    }
    /// Texels across an opacity map.
    fn opacity_map(self) -> u32 {
        match self {
            Self::Still => OPACITY_MAP,
            Self::Moving => OPACITY_MAP / 2,
        }
    }
    /// Texels that the walks of one opacity map may visit in all.
    fn visits(self) -> f64 {
        match self {
            Self::Still => OPACITY_VISITS,
            Self::Moving => OPACITY_VISITS / 4.0,
        }
    }
    /// Points of hair that shadows are made from at most.
    fn shadowing(self) -> f32 {
        match self {
            Self::Still => f32::INFINITY,
            Self::Moving => 60_000.0,
        }
    }
    /// Places of an opacity map that one look reads.
    fn taps(self) -> u32 {
        match self {
            Self::Still => 4,
            Self::Moving => 2,
        }
    }
}

/// Why a picture cannot be drawn.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum RenderError {
    /// The size asked for.
    #[error(
        "a picture of {0} x {1} pixels cannot be drawn here: width and height are 1 to {2}, and at most {3} million pixels"
    )]
    Size(u32, u32, u32, u32),
    /// The device is gone.
    #[error("the graphics adapter stopped: {0}")]
    Lost(String),
}

/// The passes, in the order in which they run.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Pass {
    /// Hair into voxels.
    Density,
    /// How open each voxel is.
    Volume,
    /// Depth of solids from a light.
    SolidShadow,
    /// Where hair begins as a light sees it.
    OpacityNear,
    /// Fibres behind that.
    OpacityCount,
    /// Solids from the camera.
    Solids,
    /// Visibility starts.
    Clear,
    /// Strands into visibility.
    Splat,
    /// Their ids, where visibility has 32 bits.
    Name,
    /// Every pixel.
    Shade,
}

/// Number of [`Pass`]es.
const PASSES: usize = Pass::Shade as usize + 1;

/// What is still to be done: a pass over units `next..end`.
#[derive(Clone, Copy, Debug)]
enum Step {
    Run {
        pass: Pass,
        part: usize,
        next: u32,
        end: u32,
    },
    /// Everything that shading looks up is there.
    Ready,
    /// A sample is whole.
    Sampled,
}

/// How far a picture is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Progress {
    /// Whole samples in it.
    pub samples: u32,
    /// Samples it is to have.
    pub of: u32,
}

/// What has changed since shading's lookups were made.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct Stale {
    hair: bool,
    solids: bool,
    lights: bool,
    tables: bool,
    targets: bool,
}

impl Stale {
    const ALL: Self = Self { hair: true, solids: true, lights: true, tables: true, targets: true };
}

/// Draws one picture, again and again.
pub struct Renderer {
    gpu: Arc<Gpu>,
    layouts: Layouts,
    pipelines: Pipelines,
    /// One for each kind of picture that was asked for.
    shades: HashMap<ShadeFor, wgpu::ComputePipeline>,
    width: u32,
    height: u32,
    targets: Targets,
    show: shown::Show,
    strands: Strands,
    drawn: Vec<Blocks>,
    shadowing: Vec<Blocks>,
    opacity_stride: u32,
    solid_meshes: Vec<Solid>,
    solids: Solids,
    roots: Option<RootGrid>,
    camera: Camera,
    rig: Rig,
    look: Look,
    effort: Effort,
    shading: Shading,
    /// The ball that lights' maps hold.
    lit: Sphere,
    frame: Frame,
    table: ScatterTable,
    tables: Tables,
    maps: Maps,
    grid: Grid,
    /// `@group(1)` of shading.
    lookups: wgpu::BindGroup,
    frame_buffer: wgpu::Buffer,
    slice_buffer: wgpu::Buffer,
    frame_group: wgpu::BindGroup,
    stale: Stale,
    work: VecDeque<Step>,
    samples: u32,
    target_samples: u32,
    /// Milliseconds a unit of each pass took, once known.
    rates: [Option<f64>; PASSES],
    /// Milliseconds spent in each pass, and units done.
    spent: [(f64, u64); PASSES],
}

impl Renderer {
    /// A renderer of pictures of this size. Compiles all shaders, which takes a second or two on a software adapter.
    ///
    /// # Errors
    /// When the adapter has no room for such a picture.
    pub fn new(gpu: Arc<Gpu>, width: u32, height: u32) -> Result<Self, RenderError> {
        check_size(&gpu, width, height)?;
        let layouts = Layouts::new(&gpu);
        let strands = Strands::new(&gpu);
        let pipelines = Pipelines::new(&gpu, &layouts, &strands.layout);
        let buffer = |label, size, usage| {
            gpu.device.create_buffer(&wgpu::BufferDescriptor {
                label: Some(label),
                size,
                usage,
                mapped_at_creation: false,
            })
        };
        let uniform = B::UNIFORM | B::COPY_DST;
        let frame_buffer = buffer("frame", size_of::<Frame>() as u64, B::STORAGE | B::COPY_DST);
        let slice_buffer = buffer("slices", SLICE_STRIDE * MOST_SLICES, uniform);
        let frame_group = gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("frame"),
            layout: &layouts.frame,
            entries: &[
                wgpu::BindGroupEntry { binding: 0, resource: frame_buffer.as_entire_binding() },
                wgpu::BindGroupEntry {
                    binding: 1,
                    resource: wgpu::BindingResource::Buffer(wgpu::BufferBinding {
                        buffer: &slice_buffer,
                        offset: 0,
                        size: wgpu::BufferSize::new(size_of::<Slice>() as u64),
                    }),
                },
            ],
        });
        let targets = Targets::new(&gpu, &layouts, width, height);
        let show = shown::Show::new(&gpu);
        let solids = Solids::new(&gpu, &layouts, &[], None);
        let look = Look::default();
        let table = bake(&look);
        let maps = Maps::new(&gpu, &layouts);
        let grid = Grid::new(&gpu, &layouts, [3; 3], &[0; 27]);
        let rig = Rig::default();
        let tables = Tables::new(&gpu, &table, &rig, None);
        let lookups = lookups(&gpu, &layouts, &targets, &maps, &grid, &tables);
        Ok(Self {
            drawn: strands.blocks(&gpu, 1.0, 1.0),
            shadowing: strands.blocks(&gpu, 1.0, 1.0),
            opacity_stride: 1,
            layouts,
            pipelines,
            shades: HashMap::new(),
            width,
            height,
            targets,
            show,
            strands,
            solid_meshes: vec![],
            solids,
            roots: None,
            camera: Camera {
                eye: Vec3::Z * 100.0,
                target: Vec3::ZERO,
                up: Vec3::Y,
                focal_mm: PORTRAIT_FOCAL,
                orthographic: None,
            },
            rig,
            look,
            effort: Effort::Still,
            shading: Shading::Hair,
            lit: Sphere { centre: Vec3::ZERO, radius: 0.0 },
            frame: Zeroable::zeroed(),
            table,
            tables,
            maps,
            grid,
            lookups,
            frame_buffer,
            slice_buffer,
            frame_group,
            stale: Stale::ALL,
            work: VecDeque::new(),
            samples: 0,
            target_samples: 64,
            rates: [None; PASSES],
            spent: [(0.0, 0); PASSES],
            gpu,
        })
    }

    /// The device that is drawn on.
    pub fn gpu(&self) -> &Arc<Gpu> {
        &self.gpu
    }
    /// Width and height, pixels.
    pub fn size(&self) -> (u32, u32) {
        (self.width, self.height)
    }
    /// Changes the size of the picture.
    ///
    /// # Errors
    /// When the adapter has no room for such a picture; the old size stays.
    pub fn resize(&mut self, width: u32, height: u32) -> Result<(), RenderError> {
        if (width, height) != (self.width, self.height) {
            check_size(&self.gpu, width, height)?;
            self.targets = Targets::new(&self.gpu, &self.layouts, width, height);
            self.show.resized();
            (self.width, self.height) = (width, height);
            self.stale.targets = true;
            self.restart();
        }
        Ok(())
    }
    /// The hair to draw, in the colours of a view. Only tufts that are not there yet are sent; where nothing differs from
    /// what is drawn already, the picture goes on.
    pub fn set_hair(&mut self, curves: &Curves, paint: &Paint) -> Uploaded {
        let uploaded = self.strands.set(&self.gpu, curves, paint);
        let moved = uploaded.tufts + uploaded.removed > 0;
        // Light does not care for paint.
        self.stale.hair |= moved;
        if moved || uploaded.bytes > 0 || self.shading != paint.shading {
            self.shading = paint.shading;
            self.restart();
        }
        uploaded
    }
    /// Head, ground, tubes: all solids there are to be.
    pub fn set_solids(&mut self, solids: Vec<Solid>) {
        self.solids = Solids::new(&self.gpu, &self.layouts, &solids, Some(&self.solids));
        self.solid_meshes = solids;
        self.stale.solids = true;
        self.restart();
    }
    /// Where hair grows, which tints the skin.
    pub fn set_roots(&mut self, roots: Option<RootGrid>) {
        self.roots = roots;
        self.stale.tables = true;
        self.restart();
    }
    /// Where it is seen from.
    pub fn set_camera(&mut self, camera: &Camera) {
        if self.camera != *camera {
            self.camera = *camera;
            self.stale.lights |= self.rig.with_camera;
            self.restart();
        }
    }
    /// What lights it.
    pub fn set_rig(&mut self, rig: &Rig) {
        self.rig = rig.clone();
        self.stale.lights = true;
        self.stale.tables = true;
        self.restart();
    }
    /// How hair is drawn.
    pub fn set_look(&mut self, look: &Look) {
        let old = std::mem::replace(&mut self.look, *look);
        if (old.beta_m, old.beta_n, old.tilt_degrees)
            != (look.beta_m, look.beta_n, look.tilt_degrees)
        {
            self.table = bake(look);
            self.stale.tables = true;
        }
        if (old.share, old.stands_for) != (look.share, look.stands_for) {
            self.drawn = self.strands.blocks(&self.gpu, look.share, look.stands_for);
            // Shadows are made of all strands, whatever share is drawn.
            self.stale.hair |= old.stands_for != look.stands_for;
        }
        self.restart();
    }

    /// How much work the light is worth.
    pub fn set_effort(&mut self, effort: Effort) {
        if self.effort != effort {
            self.effort = effort;
            self.stale.hair = true;
            self.stale.lights = true;
            self.restart();
        }
    }

    /// Compiles what drawing such hair in such a view will need, so that the first picture does not wait for it: a
    /// software adapter compiles a shader when it first runs. What was drawn so far is dropped.
    pub fn warm_up(&mut self, look: &Look, shading: Shading) {
        let (look, shading) = (
            std::mem::replace(&mut self.look, *look),
            std::mem::replace(&mut self.shading, shading),
        );
        self.compile_shade();
        self.write_frame();
        let mut encoder = self.gpu.device.create_command_encoder(&Default::default());
        let mut slices = vec![];
        for pass in ALL.into_iter().filter(|p| *p != Pass::Name || !self.gpu.wide) {
            self.encode(&mut encoder, &mut slices, pass, 0, 0, 0);
        }
        self.submit(encoder, &slices);
        self.warm_up_shown();
        (self.look, self.shading) = (look, shading);
        // Empty passes clear what they would draw into.
        self.stale = Stale::ALL;
        self.restart();
    }

    fn shade_for(&self, holds: Holds) -> ShadeFor {
        // The model does not matter where colours are shown.
        let model = match self.shading {
            Shading::Hair => self.look.model,
            Shading::Colour => Model::default(),
        };
        match holds {
            Holds::Hair => ShadeFor { model, shading: self.shading, holds },
            // Without hair its colours do not matter either.
            _ => ShadeFor { model: Model::default(), shading: Shading::Hair, holds },
        }
    }

    fn compile_shade(&mut self) {
        for what in Holds::ALL.map(|holds| self.shade_for(holds)) {
            let (gpu, layouts, strands) = (&self.gpu, &self.layouts, &self.strands.layout);
            self.shades
                .entry(what)
                .or_insert_with(|| pipelines::shade(gpu, layouts, strands, what));
        }
    }

    /// Reads all shaders anew. On a fault the old ones stay, and what is wrong is said with its file and line.
    ///
    /// # Errors
    /// When a shader is not valid.
    #[cfg(feature = "hot-reload")]
    pub fn reload_shaders(&mut self) -> Result<(), String> {
        crate::source::check()?;
        self.pipelines = Pipelines::new(&self.gpu, &self.layouts, &self.strands.layout);
        self.show = shown::Show::new(&self.gpu);
        self.shades.clear();
        self.restart();
        Ok(())
    }

    /// Drops what is half done; the next sample is the first.
    fn restart(&mut self) {
        self.work.clear();
        self.samples = 0;
    }

    /// How far the picture is.
    pub fn progress(&self) -> Progress {
        Progress { samples: self.samples, of: self.target_samples }
    }

    /// Works on a picture of `samples` samples for about `budget` and comes back: at once when it is done.
    pub fn advance(&mut self, samples: u32, budget: Duration) -> Progress {
        self.target_samples = samples;
        let start = Instant::now();
        while self.samples < samples && self.lost().is_none() {
            self.slice();
            if start.elapsed() >= budget {
                break;
            }
        }
        self.progress()
    }

    /// Why nothing is drawn any more, once the device is gone. A renderer does not come back from that.
    pub fn lost(&self) -> Option<RenderError> {
        self.gpu.lost().map(|reason| RenderError::Lost(reason.to_owned()))
    }

    /// A picture of `samples` samples; false when `cancelled` said so first, or when the device is [`Self::lost`].
    pub fn render(&mut self, samples: u32, cancelled: &dyn Fn(Progress) -> bool) -> bool {
        while self.advance(samples, SLICE).samples < samples {
            if self.lost().is_some() || cancelled(self.progress()) {
                return false;
            }
        }
        true
    }

    /// Milliseconds and units of work of each pass since the renderer was made.
    pub fn spent(&self) -> Vec<(Pass, f64, u64)> {
        ALL.iter().map(|p| (*p, self.spent[*p as usize].0, self.spent[*p as usize].1)).collect()
    }

    /// Whether sums hold a part of the sample that is being made.
    fn half_shaded(&self) -> bool {
        let untouched = |step: &&Step| matches!(step, Step::Run { pass: Pass::Shade, next: 0, .. });
        !self.work.is_empty() && self.work.iter().filter(untouched).count() < self.drawn.len()
    }

    /// The curve, and the point of the tuft, that the middle of a pixel shows in the last sample, or the nearest pixel within
    /// `reach` of it that shows hair. A sample that is being made is finished first.
    pub fn pick(&mut self, x: u32, y: u32, reach: u32) -> Option<(Arc<Tuft>, usize, usize)> {
        if x >= self.width || y >= self.height || self.samples == 0 {
            return None;
        }
        while !self.work.is_empty() && self.lost().is_none() {
            self.slice();
        }
        let words = if self.gpu.wide { 2 } else { 1 };
        let (low, high) = (
            [x.saturating_sub(reach), y.saturating_sub(reach)],
            [(x + reach).min(self.width - 1), (y + reach).min(self.height - 1)],
        );
        let index = |x: u32, y: u32| u64::from(y) * u64::from(self.width) + u64::from(x);
        let first = index(low[0], low[1]);
        let count = index(high[0], high[1]) - first + 1;
        let bytes = read(&self.gpu, &self.targets.shown, first * 4 * words, count * 4 * words);
        let id = |x: u32, y: u32| -> Option<u32> {
            let at = ((index(x, y) - first) * 4 * words) as usize;
            let word = u32::from_le_bytes(bytes.get(at..at + 4)?.try_into().ok()?);
            (word != 0).then_some(word)
        };
        let around = (low[1]..=high[1]).flat_map(|v| (low[0]..=high[0]).map(move |u| (u, v)));
        let far = |u: u32, v: u32| u.abs_diff(x).pow(2) + v.abs_diff(y).pow(2);
        let found = around.filter_map(|(u, v)| Some((far(u, v), id(u, v)?)));
        let (_, nearest) = found.filter(|(far, _)| *far <= reach * reach).min()?;
        self.strands.named(nearest)
    }

    /// The picture as far as it is: black and clear before the first sample is whole. A sample that is being shaded is
    /// finished first, so that all pixels are sums of as many.
    pub fn picture(&mut self) -> Picture {
        while self.half_shaded() && self.lost().is_none() {
            self.slice();
        }
        let size = u64::from(self.width) * u64::from(self.height) * 16;
        let mut bytes = vec![];
        if self.samples > 0 {
            bytes = read(&self.gpu, &self.targets.sums, 0, size);
        }
        // Nothing is read from a device that is gone.
        bytes.resize(size as usize, 0);
        let scale = 1.0 / self.samples.max(1) as f32;
        let linear = bytes
            .chunks_exact(16)
            .map(|c| {
                let at =
                    |i: usize| f32::from_le_bytes([c[i], c[i + 1], c[i + 2], c[i + 3]]) * scale;
                [at(0), at(4), at(8), at(12)]
            })
            .collect();
        Picture { width: self.width, height: self.height, linear }
    }
}

const ALL: [Pass; PASSES] = [
    Pass::Density,
    Pass::Volume,
    Pass::SolidShadow,
    Pass::OpacityNear,
    Pass::OpacityCount,
    Pass::Solids,
    Pass::Clear,
    Pass::Splat,
    Pass::Name,
    Pass::Shade,
];

fn bake(look: &Look) -> ScatterTable {
    ScatterTable::bake(look.beta_m, look.beta_n, look.tilt_degrees.to_radians())
}

fn check_size(gpu: &Gpu, width: u32, height: u32) -> Result<(), RenderError> {
    let limits = gpu.device.limits();
    let side = limits.max_texture_dimension_2d;
    let pixels = (limits.max_storage_buffer_binding_size / 16).min(1 << 28) as u32;
    let fits = (1..=side).contains(&width)
        && (1..=side).contains(&height)
        && u64::from(width) * u64::from(height) <= u64::from(pixels);
    if fits { Ok(()) } else { Err(RenderError::Size(width, height, side, pixels / 1_000_000)) }
}

/// Bytes of a buffer. Waits for all work.
fn read(gpu: &Gpu, buffer: &wgpu::Buffer, offset: u64, size: u64) -> Vec<u8> {
    let staging = gpu.device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("read back"),
        size,
        usage: B::COPY_DST | B::MAP_READ,
        mapped_at_creation: false,
    });
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    encoder.copy_buffer_to_buffer(buffer, offset, &staging, 0, size);
    gpu.queue.submit([encoder.finish()]);
    staging.slice(..).map_async(wgpu::MapMode::Read, |_| {});
    gpu.wait();
    match staging.slice(..).get_mapped_range() {
        Ok(bytes) => bytes.to_vec(),
        Err(_) => vec![],
    }
}
