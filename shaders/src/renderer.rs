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
use crate::pipelines::{
    self, ALBEDO, CORNERS, DEPTH, Holds, Layouts, NORMAL, OPENNESS, Pipelines, ShadeFor,
};
use crate::solids::Solids;
use crate::strands::{Blocks, Slice, Strands, Uploaded};
use crate::surface::{RootGrid, Solid, solid_voxels};
use crate::view::{Paint, Shading};
use bytemuck::Zeroable;
use coif_nodes::data::curves::{Curves, Tuft};
use glam::{Mat4, Vec2, Vec3};
use std::collections::{HashMap, VecDeque};
use std::sync::Arc;
use std::time::{Duration, Instant};
use wgpu::{BufferUsages as B, TextureUsages as U};

mod shown;

/// How long a slice should take on the adapter. Shorter costs submissions, longer makes whoever waits feel it; half of
/// the 50 ms that a viewport may block.
const SLICE: Duration = Duration::from_millis(25);
/// Texels across a light's depth map of solids and its opacity map.
const SOLID_MAP: u32 = 1024;
const OPACITY_MAP: u32 = 1024;
/// Bytes of a texel of an opacity map.
const TEXEL: u64 = 20;
/// Texels that the walks of one opacity map may visit in all. More is slower, less is grainier; at 6 million the pictures of
/// 100,000 strands differ from the full walk by less than their own grain after 32 samples.
const OPACITY_VISITS: f64 = 6.0e6;
/// Standard deviation of the camera's shake, pixels: a Gaussian filter that keeps single hairs fine.
const FILTER_PIXELS: f32 = 0.38;
/// Bytes from one slice's parameters to the next: the alignment that every adapter grants.
const SLICE_STRIDE: u64 = 256;
/// Tiles that one slice of shading may sort, and how many corners of them stand in a row; as `shade.wgsl` has it.
const TILES: u32 = 65_535;
const ROW: u32 = 256;
/// No tiles yet, for hair, solids and the backdrop: workgroups along x, y and z, and room.
const NO_TILES: [[u32; 4]; 3] = [[0, 1, 1, 0]; 3];
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

/// Targets of the size of the picture.
#[derive(Debug)]
struct Targets {
    normal: wgpu::TextureView,
    albedo: wgpu::TextureView,
    depth: wgpu::TextureView,
    /// Ids, or words that hold them.
    shown: wgpu::Buffer,
    sums: wgpu::Buffer,
    visibility: wgpu::BindGroup,
    /// Tiles of a slice by what they hold, and what it begins as: no tiles.
    tiles: wgpu::Buffer,
    no_tiles: wgpu::Buffer,
    sort: wgpu::BindGroup,
    shade: wgpu::BindGroup,
}

/// The grid of light around hair.
#[derive(Debug)]
struct Grid {
    density: wgpu::Buffer,
    openness: wgpu::TextureView,
    density_group: wgpu::BindGroup,
    volume_group: wgpu::BindGroup,
}

/// What lights see: solids in depth maps, hair in deep opacity maps.
#[derive(Debug)]
struct Maps {
    opacity: wgpu::Buffer,
    /// One view a light to draw into, and one of all to read.
    depth_of: Vec<wgpu::TextureView>,
    depths: wgpu::TextureView,
    opacity_group: wgpu::BindGroup,
}

/// What shading looks up that neither hair nor solids change. A backdrop may be large, so it is not sent at every turn of
/// the camera.
#[derive(Debug)]
struct Tables {
    scatter: wgpu::Buffer,
    backdrop: wgpu::TextureView,
    roots: wgpu::TextureView,
    sampler: wgpu::Sampler,
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
        let solids = Solids::new(&gpu, &[]);
        let look = Look::default();
        let table = bake(&look);
        let maps = Maps::new(&gpu, &layouts);
        let grid = Grid::new(&gpu, &layouts, [3; 3], &[0; 27]);
        let rig = Rig::default();
        let tables = Tables::new(&gpu, &table, &rig, None);
        let lookups = lookups(&gpu, &layouts, &targets, &maps, &grid, &tables);
        Ok(Self {
            drawn: strands.blocks(&gpu, 1.0),
            shadowing: strands.blocks(&gpu, 1.0),
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
        self.solids = Solids::new(&self.gpu, &solids);
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
        if old.share != look.share {
            self.drawn = self.strands.blocks(&self.gpu, look.share);
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

#[cfg(test)]
mod tests;

// --- work ---------------------------------------------------------------------------------------

impl Renderer {
    /// Does one slice of work.
    fn slice(&mut self) {
        if self.work.is_empty() {
            self.plan();
        }
        let mut encoder = self.gpu.device.create_command_encoder(&Default::default());
        let mut slices: Vec<Slice> = vec![];
        let mut done: Vec<(Pass, u32)> = vec![];
        let mut sampled = 0;
        let aim = SLICE.as_secs_f64() * 1e3;
        let mut expected = 0.0;
        while let Some(step) = self.work.front().copied() {
            match step {
                Step::Ready => self.stale = Stale::default(),
                Step::Sampled => sampled += 1,
                Step::Run { pass, part, next, end } => {
                    let all = end - next;
                    // A pass of unknown cost begins with a sixteenth.
                    let n = match self.rates[pass as usize] {
                        Some(rate) => ((aim - expected) / rate.max(1e-9)) as u32,
                        None => all.div_ceil(16),
                    };
                    let n = match pass {
                        // Tiles that one list holds.
                        Pass::Shade => n.min(TILES / self.width.div_ceil(8) * 8),
                        _ => n,
                    };
                    let n = n.clamp(granule(pass), all.max(granule(pass)));
                    let n = n.next_multiple_of(granule(pass)).min(all);
                    // A pass over nothing would teach that it is fast.
                    if n > 0 {
                        self.encode(&mut encoder, &mut slices, pass, part, next, n);
                        expected += self.rates[pass as usize].unwrap_or(aim) * f64::from(n);
                        done.push((pass, n));
                    }
                    if n < all {
                        self.work[0] = Step::Run { pass, part, next: next + n, end };
                        break;
                    }
                }
            }
            self.work.pop_front();
            // A sample's own numbers are written before it begins, so two cannot share a submission.
            let one_kind = done.windows(2).all(|d| d[0].0 == d[1].0);
            let next_kind = match self.work.front() {
                Some(Step::Run { pass, .. }) => done.last().is_none_or(|d| d.0 == *pass),
                _ => true,
            };
            let known = done.iter().all(|d| self.rates[d.0 as usize].is_some());
            // On a CPU every pass is timed by itself; a GPU would idle between them.
            let stop =
                if self.gpu.is_software() || !known { !(one_kind && next_kind) } else { false };
            if sampled > 0 || stop || expected >= aim || slices.len() + 4 > MOST_SLICES as usize {
                break;
            }
        }
        let start = Instant::now();
        self.submit(encoder, &slices);
        let ms = start.elapsed().as_secs_f64() * 1e3;
        self.measured(&done, ms);
        self.samples += sampled;
    }

    fn submit(&self, encoder: wgpu::CommandEncoder, slices: &[Slice]) {
        let mut bytes = vec![0u8; slices.len() * SLICE_STRIDE as usize];
        for (i, slice) in slices.iter().enumerate() {
            let at = i * SLICE_STRIDE as usize;
            bytes[at..at + size_of::<Slice>()].copy_from_slice(bytemuck::bytes_of(slice));
        }
        self.gpu.queue.write_buffer(&self.slice_buffer, 0, &bytes);
        self.gpu.queue.submit([encoder.finish()]);
        self.gpu.wait();
    }

    /// Learns from a slice how long its passes take.
    fn measured(&mut self, done: &[(Pass, u32)], ms: f64) {
        let weight = |d: &(Pass, u32)| self.rates[d.0 as usize].unwrap_or(1.0) * f64::from(d.1);
        let weights: Vec<f64> = done.iter().map(weight).collect();
        let all: f64 = weights.iter().sum();
        for ((pass, n), weight) in done.iter().zip(weights) {
            let part = if all > 0.0 { ms * weight / all } else { 0.0 };
            let rate = (part / f64::from((*n).max(1))).max(1e-7);
            let old = &mut self.rates[*pass as usize];
            // New measurements count half: machines are noisy, scenes change.
            *old = Some(old.map_or(rate, |old| 0.5 * (old + rate)));
            self.spent[*pass as usize].0 += part;
            self.spent[*pass as usize].1 += u64::from(*n);
        }
    }

    /// The steps up to the end of the next sample.
    fn plan(&mut self) {
        if self.stale != Stale::default() {
            self.plan_lookups();
        }
        self.compile_shade();
        self.write_frame();
        let rows = self.height;
        let run = |pass, part, end| Step::Run { pass, part, next: 0, end };
        self.work.push_back(run(Pass::Solids, 0, self.solids.triangles.max(1)));
        self.work.push_back(run(Pass::Clear, 0, rows));
        let passes: &[Pass] =
            if self.gpu.wide { &[Pass::Splat] } else { &[Pass::Splat, Pass::Name] };
        for pass in passes {
            for (part, blocks) in self.drawn.iter().enumerate() {
                self.work.push_back(run(*pass, part, blocks.count));
            }
        }
        for part in 0..self.drawn.len() {
            self.work.push_back(run(Pass::Shade, part, rows));
        }
        self.work.push_back(Step::Sampled);
    }

    /// Makes what shading looks up anew, as far as it is stale.
    fn plan_lookups(&mut self) {
        let stale = self.stale;
        let geometry = stale.hair || stale.solids;
        if geometry || stale.lights {
            if stale.hair {
                self.drawn = self.strands.blocks(&self.gpu, self.look.share);
            }
            self.plan_light(geometry);
        }
        if stale.tables {
            self.tables = Tables::new(&self.gpu, &self.table, &self.rig, self.roots.as_ref());
        }
        let (targets, tables) = (&self.targets, &self.tables);
        self.lookups = lookups(&self.gpu, &self.layouts, targets, &self.maps, &self.grid, tables);
        if let Some(roots) = &self.roots {
            self.frame.roots = roots.lower.extend(roots.cell).to_array();
            self.frame.roots_size = [roots.size[0], roots.size[1], roots.size[2], 1];
        } else {
            self.frame.roots_size = [0; 4];
        }
        self.work.push_back(Step::Ready);
    }

    fn plan_light(&mut self, geometry: bool) {
        let hair = self.strands.bounds();
        let all = match (hair, self.solids.bounds) {
            (Some((lo, hi)), Some((low, high))) => {
                // The surroundings of hair matter; a whole body's do not.
                let reach = Vec3::splat((hi - lo).max_element() * 0.5 + 15.0);
                let middle = (lo + hi) * 0.5;
                Some((lo.min(low.max(middle - reach)), hi.max(high.min(middle + reach))))
            }
            (hair, solids) => hair.or(solids),
        };
        let (lo, hi) = all.unwrap_or((Vec3::splat(-10.0), Vec3::splat(10.0)));
        let bounds = Sphere::around(lo, hi);
        let opacity_map = self.effort.opacity_map();
        let holds =
            |ball: Sphere| ball.centre.distance(bounds.centre) + bounds.radius <= ball.radius;
        let stays = self.effort == Effort::Moving
            && !(self.stale.lights || self.stale.solids)
            && holds(self.lit);
        if !stays {
            // With room for hair to move in.
            let room = if self.effort == Effort::Moving { 1.1 } else { 1.0 };
            self.lit = Sphere { radius: bounds.radius * room, ..bounds };
            self.frame.lights = self.rig.lights_for(&self.camera, self.lit);
            for light in &mut self.frame.lights {
                light.extent[2] = opacity_map as f32;
            }
        }
        let run = |pass, part, end| Step::Run { pass, part, next: 0, end };
        let blocks = |shadowing: &[Blocks], pass, light: usize| -> Vec<Step> {
            let parts = shadowing.iter().enumerate();
            parts.map(|(i, b)| run(pass, (light << 16) | i, b.count)).collect()
        };
        let mut encoder = self.gpu.device.create_command_encoder(&Default::default());
        if geometry {
            // The voxels: around hair, and as much of the head as light bounces off near it.
            let (low, high) = match hair {
                Some((a, b)) => ((a - 4.0).max(lo - 1.0), (b + 4.0).min(hi + 1.0)),
                None => (lo, hi),
            };
            let cell = ((high - low).max_element() / self.effort.voxels()).max(0.05);
            let size = ((high - low) / cell).ceil().to_array().map(|n| (n as u32 + 1) | 1);
            self.frame.grid = low.extend(cell).to_array();
            self.frame.grid_size = [size[0], size[1], size[2], u32::from(hair.is_some())];
            // Opacity maps are thinned so that their walks stay within a budget.
            let texel = f64::from(self.frame.lights[0].extent[0]) / f64::from(opacity_map);
            let over = (self.strands.length() / texel / self.effort.visits()).max(1e-9);
            self.opacity_stride = over.clamp(1.0, 2.0) as u32;
            let share = (f64::from(self.opacity_stride) / over).clamp(0.125, 1.0) as f32;
            let share = share.min(self.effort.shadowing() / self.strands.points().max(1) as f32);
            self.shadowing = self.strands.blocks(&self.gpu, share);
            let shell = solid_voxels(&self.solid_meshes, low, cell, size);
            self.grid = Grid::new(&self.gpu, &self.layouts, size, &shell);
            encoder.clear_buffer(&self.grid.density, 0, None);
            self.work.extend(blocks(&self.shadowing, Pass::Density, 0));
            self.work.push_back(run(Pass::Volume, 0, size[2].div_ceil(4)));
        }
        let texels = 3 * u64::from(opacity_map) * u64::from(opacity_map);
        encoder.clear_buffer(&self.maps.opacity, 0, Some(texels * TEXEL));
        self.gpu.queue.submit([encoder.finish()]);
        for light in 0..3 {
            if !stays {
                self.work.push_back(run(Pass::SolidShadow, light, self.solids.casting.max(1)));
            }
            self.work.extend(blocks(&self.shadowing, Pass::OpacityNear, light));
            self.work.extend(blocks(&self.shadowing, Pass::OpacityCount, light));
        }
    }

    fn write_frame(&mut self) {
        let size = Vec2::new(self.width as f32, self.height as f32);
        let projection = self.camera.projection(size.x / size.y);
        let jitter = shake(self.samples) * 2.0 / size;
        let clip_from_world =
            Mat4::from_translation(jitter.extend(0.0)) * projection * self.camera.view();
        let frame = &mut self.frame;
        frame.clip_from_world = clip_from_world.to_cols_array_2d();
        frame.world_from_clip = clip_from_world.inverse().to_cols_array_2d();
        let cm_per_pixel = 2.0 / (projection.y_axis.y * size.y);
        frame.eye = self.camera.eye.extend(cm_per_pixel).to_array();
        let ahead = (self.camera.target - self.camera.eye).normalize_or(Vec3::NEG_Z);
        let orthographic = if self.camera.orthographic.is_some() { 1.0 } else { 0.0 };
        frame.ahead = ahead.extend(orthographic).to_array();
        frame.viewport = [size.x, size.y, 1.0 / size.x, 1.0 / size.y];
        frame.mode = [self.samples, self.effort.taps(), 0, self.rig.environment.backdrop_kind()];
        let look = &self.look;
        frame.hair = [look.beta_m, look.beta_n, look.tilt_degrees.to_radians(), look.specular];
        let darkness = self.roots.as_ref().map_or(0.0, |roots| roots.darkness);
        frame.cover = [look.opacity, 0.0, look.scalp_tint * darkness, 0.0];
        frame.sky = self.rig.environment_in_world(&self.camera).sky();
        self.gpu.queue.write_buffer(&self.frame_buffer, 0, bytemuck::bytes_of(frame));
    }

    /// Records units `first..first + n` of a pass.
    fn encode(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        slices: &mut Vec<Slice>,
        pass: Pass,
        part: usize,
        first: u32,
        n: u32,
    ) {
        let (light, chunk) = (part >> 16, part & 0xffff);
        let offset = slices.len() as u32 * SLICE_STRIDE as u32;
        let mut slice = Slice { first, count: n, light: light as u32, ..Zeroable::zeroed() };
        match pass {
            Pass::SolidShadow => {
                slice.light = part as u32;
                slices.push(slice);
                let view = &self.maps.depth_of[part];
                self.raster(encoder, offset, None, view, first, n.min(self.solids.casting));
            }
            Pass::Solids => {
                slices.push(slice);
                let t = &self.targets;
                let colours = Some([&t.normal, &t.albedo]);
                self.raster(
                    encoder,
                    offset,
                    colours,
                    &t.depth,
                    first,
                    n.min(self.solids.triangles),
                );
            }
            Pass::Clear => {
                slices.push(slice);
                let groups = [self.width.div_ceil(8), n.div_ceil(8).max(1), 1];
                let own = &self.targets.visibility;
                self.dispatch(
                    encoder,
                    &self.pipelines.clear,
                    offset,
                    &self.drawn[part].group,
                    own,
                    groups,
                );
            }
            Pass::Shade => {
                slice.base = self.strands.chunks[part].base;
                slice.points = self.strands.capacity(part);
                slice.words = if self.gpu.wide { 2 } else { 1 };
                slices.push(slice);
                let targets = &self.targets;
                let strands = &self.drawn[part].group;
                let size = size_of_val(&NO_TILES) as u64;
                encoder.copy_buffer_to_buffer(&targets.no_tiles, 0, &targets.tiles, 0, size);
                let tiles = self.width.div_ceil(8) * n.div_ceil(8);
                let groups = [tiles.div_ceil(64).max(1), 1, 1];
                let sort = &self.pipelines.sort;
                self.dispatch(encoder, sort, offset, strands, &targets.sort, groups);
                // Only the first chunk shades what holds no hair.
                let all = if part == 0 { &Holds::ALL[..] } else { &Holds::ALL[..1] };
                let mut pass = encoder.begin_compute_pass(&Default::default());
                pass.set_bind_group(0, &self.frame_group, &[offset]);
                pass.set_bind_group(1, &self.lookups, &[]);
                pass.set_bind_group(2, strands, &[]);
                pass.set_bind_group(3, &targets.shade, &[]);
                for holds in all {
                    pass.set_pipeline(&self.shades[&self.shade_for(*holds)]);
                    match n {
                        // To compile it.
                        0 => pass.dispatch_workgroups(1, 1, 1),
                        _ => pass.dispatch_workgroups_indirect(&targets.tiles, 16 * *holds as u64),
                    }
                }
            }
            Pass::Volume => {
                slice.first = first * 4;
                slice.count = n * 4;
                slices.push(slice);
                let [x, y, ..] = self.frame.grid_size;
                let groups = [x.div_ceil(4), y.div_ceil(4), n.max(1)];
                let own = &self.grid.volume_group;
                let strands = &self.drawn[0].group;
                self.dispatch(encoder, &self.pipelines.volume, offset, strands, own, groups);
            }
            Pass::Density | Pass::OpacityNear | Pass::OpacityCount | Pass::Splat | Pass::Name => {
                let p = &self.pipelines;
                let (pipeline, own, blocks) = match pass {
                    Pass::Density => (&p.density, &self.grid.density_group, &self.shadowing),
                    Pass::OpacityNear => {
                        (&p.opacity_near, &self.maps.opacity_group, &self.shadowing)
                    }
                    Pass::OpacityCount => {
                        (&p.opacity_count, &self.maps.opacity_group, &self.shadowing)
                    }
                    Pass::Name => {
                        (p.name.as_ref().unwrap_or(&p.splat), &self.targets.visibility, &self.drawn)
                    }
                    _ => (&p.splat, &self.targets.visibility, &self.drawn),
                };
                let blocks = &blocks[chunk];
                slice.base = self.strands.chunks[blocks.chunk].base;
                slice.points = self.strands.capacity(blocks.chunk);
                slice.stride = self.opacity_stride;
                slice.groups = n.clamp(1, 65_535);
                slices.push(slice);
                let groups = [slice.groups, n.div_ceil(slice.groups).max(1), 1];
                self.dispatch(encoder, pipeline, offset, &blocks.group, own, groups);
            }
        }
    }

    fn dispatch(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        pipeline: &wgpu::ComputePipeline,
        offset: u32,
        strands: &wgpu::BindGroup,
        own: &wgpu::BindGroup,
        [x, y, z]: [u32; 3],
    ) {
        let mut pass = encoder.begin_compute_pass(&Default::default());
        pass.set_pipeline(pipeline);
        pass.set_bind_group(0, &self.frame_group, &[offset]);
        pass.set_bind_group(1, &self.lookups, &[]);
        pass.set_bind_group(2, strands, &[]);
        pass.set_bind_group(3, own, &[]);
        pass.dispatch_workgroups(x, y, z);
    }

    fn raster(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        offset: u32,
        colours: Option<[&wgpu::TextureView; 2]>,
        depth: &wgpu::TextureView,
        first: u32,
        n: u32,
    ) {
        let clear = first == 0;
        let far = if colours.is_some() { 0.0 } else { 1.0 };
        let attachments = colours.map(|views| {
            views.map(|view| {
                Some(wgpu::RenderPassColorAttachment {
                    view,
                    depth_slice: None,
                    resolve_target: None,
                    ops: wgpu::Operations {
                        load: match clear {
                            true => wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT),
                            false => wgpu::LoadOp::Load,
                        },
                        store: wgpu::StoreOp::Store,
                    },
                })
            })
        });
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("solids"),
            color_attachments: attachments.as_ref().map_or(&[], |a| a),
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: depth,
                depth_ops: Some(wgpu::Operations {
                    load: if clear { wgpu::LoadOp::Clear(far) } else { wgpu::LoadOp::Load },
                    store: wgpu::StoreOp::Store,
                }),
                stencil_ops: None,
            }),
            ..Default::default()
        });
        pass.set_pipeline(match colours {
            Some(_) => &self.pipelines.solids,
            None => &self.pipelines.solids_from_light,
        });
        pass.set_bind_group(0, &self.frame_group, &[offset]);
        pass.set_vertex_buffer(0, self.solids.vertices.slice(..));
        pass.set_index_buffer(self.solids.indices.slice(..), wgpu::IndexFormat::Uint32);
        if n > 0 {
            pass.draw_indexed(first * 3..(first + n) * 3, 0, 0..1);
        }
    }
}

/// Units of a pass that cannot be parted: a workgroup's rows, or enough triangles that a pass over the picture pays.
fn granule(pass: Pass) -> u32 {
    match pass {
        Pass::Clear | Pass::Shade => 8,
        Pass::Solids | Pass::SolidShadow => 16_384,
        Pass::Volume => 1,
        _ => 64,
    }
}

/// Where sample number `i` looks within its pixel: Gaussian, from the Halton sequence in 2 and 3.
fn shake(i: u32) -> Vec2 {
    let halton = |base: u32| {
        let (mut i, mut f, mut x) = (i + 1, 1.0f32, 0.0);
        while i > 0 {
            f /= base as f32;
            x += f * (i % base) as f32;
            i /= base;
        }
        x
    };
    let r = FILTER_PIXELS * (-2.0 * halton(2).max(1e-4).ln()).sqrt();
    Vec2::from_angle(std::f32::consts::TAU * halton(3)) * r
}

// --- what passes draw into ----------------------------------------------------------------------

fn view_of(
    gpu: &Gpu,
    label: &str,
    size: [u32; 3],
    dimension: wgpu::TextureDimension,
    format: wgpu::TextureFormat,
    usage: U,
) -> wgpu::Texture {
    gpu.device.create_texture(&wgpu::TextureDescriptor {
        label: Some(label),
        size: wgpu::Extent3d { width: size[0], height: size[1], depth_or_array_layers: size[2] },
        mip_level_count: 1,
        sample_count: 1,
        dimension,
        format,
        usage,
        view_formats: &[],
    })
}

fn storage(gpu: &Gpu, label: &str, size: u64) -> wgpu::Buffer {
    gpu.device.create_buffer(&wgpu::BufferDescriptor {
        label: Some(label),
        size: size.max(16),
        usage: B::STORAGE | B::COPY_DST | B::COPY_SRC,
        mapped_at_creation: false,
    })
}

fn group(
    gpu: &Gpu,
    layout: &wgpu::BindGroupLayout,
    resources: &[wgpu::BindingResource],
) -> wgpu::BindGroup {
    let entries: Vec<_> = resources
        .iter()
        .enumerate()
        .map(|(i, r)| wgpu::BindGroupEntry { binding: i as u32, resource: r.clone() })
        .collect();
    gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: None,
        layout,
        entries: &entries,
    })
}

const D2: wgpu::TextureDimension = wgpu::TextureDimension::D2;
const D3: wgpu::TextureDimension = wgpu::TextureDimension::D3;

impl Targets {
    fn new(gpu: &Gpu, layouts: &Layouts, width: u32, height: u32) -> Self {
        let drawn = U::RENDER_ATTACHMENT | U::TEXTURE_BINDING;
        let texture = |label, format| {
            view_of(gpu, label, [width, height, 1], D2, format, drawn)
                .create_view(&Default::default())
        };
        let (normal, albedo) = (texture("normals", NORMAL), texture("albedo", ALBEDO));
        let depth = texture("depth", DEPTH);
        let pixels = u64::from(width) * u64::from(height);
        // Wide words hold depth and id; else keys and ids are apart.
        let keys = storage(gpu, "visibility", if gpu.wide { 8 * pixels } else { 4 * pixels });
        let ids = storage(gpu, "ids", if gpu.wide { 16 } else { 4 * pixels });
        let shown = if gpu.wide { keys.clone() } else { ids.clone() };
        let sums = storage(gpu, "sums", 16 * pixels);
        let depth_view = || wgpu::BindingResource::TextureView(&depth);
        let visibility = group(
            gpu,
            &layouts.visibility,
            &[keys.as_entire_binding(), ids.as_entire_binding(), depth_view()],
        );
        let tiles = gpu.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("tiles"),
            size: size_of_val(&NO_TILES) as u64,
            usage: B::STORAGE | B::COPY_DST | B::INDIRECT,
            mapped_at_creation: false,
        });
        let no_tiles = storage(gpu, "no tiles", size_of_val(&NO_TILES) as u64);
        gpu.queue.write_buffer(&no_tiles, 0, bytemuck::cast_slice(&NO_TILES));
        let usage = U::STORAGE_BINDING | U::TEXTURE_BINDING;
        let corners = view_of(gpu, "corners of tiles", [ROW, 3 * ROW, 1], D2, CORNERS, usage)
            .create_view(&Default::default());
        let corners = wgpu::BindingResource::TextureView(&corners);
        let buffer = wgpu::Buffer::as_entire_binding;
        let sort_what = [buffer(&shown), buffer(&sums), buffer(&tiles), corners.clone()];
        let sort = group(gpu, &layouts.sort, &sort_what);
        let shade = group(gpu, &layouts.shade, &[buffer(&shown), buffer(&sums), corners]);
        Self { visibility, tiles, no_tiles, sort, shade, normal, albedo, depth, shown, sums }
    }
}

impl Grid {
    fn new(gpu: &Gpu, layouts: &Layouts, size: [u32; 3], shell: &[u32]) -> Self {
        let voxels: u64 = size.iter().map(|n| u64::from(*n)).product();
        let density = storage(gpu, "density", voxels * 4);
        let solid = storage(gpu, "shell", voxels * 4);
        gpu.queue.write_buffer(&solid, 0, bytemuck::cast_slice(shell));
        let usage = U::STORAGE_BINDING | U::TEXTURE_BINDING;
        let openness =
            view_of(gpu, "openness", size, D3, OPENNESS, usage).create_view(&Default::default());
        let density_group = group(gpu, &layouts.density, &[density.as_entire_binding()]);
        let volume_group = group(
            gpu,
            &layouts.volume,
            &[
                density.as_entire_binding(),
                solid.as_entire_binding(),
                wgpu::BindingResource::TextureView(&openness),
            ],
        );
        Self { density, openness, density_group, volume_group }
    }
}

impl Maps {
    fn new(gpu: &Gpu, layouts: &Layouts) -> Self {
        let texels = 3 * u64::from(OPACITY_MAP) * u64::from(OPACITY_MAP);
        let opacity = storage(gpu, "opacity maps", texels * TEXEL);
        let opacity_group = group(gpu, &layouts.opacity, &[opacity.as_entire_binding()]);
        let usage = U::RENDER_ATTACHMENT | U::TEXTURE_BINDING;
        let depth = view_of(gpu, "solids from lights", [SOLID_MAP, SOLID_MAP, 3], D2, DEPTH, usage);
        let depth_of = (0..3)
            .map(|layer| {
                depth.create_view(&wgpu::TextureViewDescriptor {
                    dimension: Some(wgpu::TextureViewDimension::D2),
                    base_array_layer: layer,
                    array_layer_count: Some(1),
                    ..Default::default()
                })
            })
            .collect();
        let depths = depth.create_view(&wgpu::TextureViewDescriptor {
            dimension: Some(wgpu::TextureViewDimension::D2Array),
            ..Default::default()
        });
        Self { opacity, depth_of, depths, opacity_group }
    }
}

impl Tables {
    fn new(gpu: &Gpu, table: &ScatterTable, rig: &Rig, roots: Option<&RootGrid>) -> Self {
        let scatter = storage(gpu, "scatter table", size_of_val(&table.values[..]) as u64);
        gpu.queue.write_buffer(&scatter, 0, bytemuck::cast_slice(&table.values));
        let texture =
            |label, size: [u32; 3], dimension, format: wgpu::TextureFormat, bytes: &[u8]| {
                let usage = U::TEXTURE_BINDING | U::COPY_DST;
                let texture = view_of(gpu, label, size, dimension, format, usage);
                let row = size[0] * format.block_copy_size(None).unwrap_or(1);
                gpu.queue.write_texture(
                    texture.as_image_copy(),
                    bytes,
                    wgpu::TexelCopyBufferLayout {
                        offset: 0,
                        bytes_per_row: Some(row),
                        rows_per_image: Some(size[1]),
                    },
                    texture.size(),
                );
                texture.create_view(&Default::default())
            };
        let (w, h, map) = rig.environment.backdrop_map();
        let map: Vec<half::f16> = map.iter().flatten().map(|x| half::f16::from_f32(*x)).collect();
        let backdrop = texture(
            "backdrop",
            [w, h, 1],
            D2,
            wgpu::TextureFormat::Rgba16Float,
            bytemuck::cast_slice(&map),
        );
        let (size, values_of_roots) = match roots {
            Some(roots) => (roots.size, &roots.values[..]),
            // Not of one texel, nor of a power of two: software adapters compile for that.
            None => ([3; 3], &[0u8; 27][..]),
        };
        let roots = texture("roots", size, D3, wgpu::TextureFormat::R8Unorm, values_of_roots);
        let sampler = gpu.device.create_sampler(&wgpu::SamplerDescriptor {
            mag_filter: wgpu::FilterMode::Linear,
            min_filter: wgpu::FilterMode::Linear,
            ..Default::default()
        });
        Self { scatter, backdrop, roots, sampler }
    }
}

fn lookups(
    gpu: &Gpu,
    layouts: &Layouts,
    targets: &Targets,
    maps: &Maps,
    grid: &Grid,
    tables: &Tables,
) -> wgpu::BindGroup {
    let view = |v| wgpu::BindingResource::TextureView(v);
    group(
        gpu,
        &layouts.lookups,
        &[
            tables.scatter.as_entire_binding(),
            view(&tables.backdrop),
            view(&tables.roots),
            wgpu::BindingResource::Sampler(&tables.sampler),
            view(&grid.openness),
            maps.opacity.as_entire_binding(),
            view(&maps.depths),
            view(&targets.normal),
            view(&targets.albedo),
            view(&targets.depth),
        ],
    )
}
