//! All pipelines and the layouts of what they bind.
//!
//! Made once a device, in parallel: on a software adapter a pipeline is compiled to machine code, which takes longer than
//! drawing with it. With the feature `hot-reload` they can be made again from changed files; a broken shader leaves the old
//! ones in place.

use crate::gpu::Gpu;
use crate::hair::Model;
use crate::source::Source;
use crate::view::Shading;
use wgpu::{
    BindGroupLayout, BindGroupLayoutEntry, BindingType, BufferBindingType, ComputePipeline,
    RenderPipeline, SamplerBindingType, ShaderStages, StorageTextureAccess, TextureFormat,
    TextureSampleType, TextureViewDimension,
};

/// Normals and materials of solids.
pub(crate) const NORMAL: TextureFormat = TextureFormat::Rgba16Float;
/// Square roots of albedo.
pub(crate) const ALBEDO: TextureFormat = TextureFormat::Rgba8Unorm;
/// Depth, reversed for the camera, straight for lights.
pub(crate) const DEPTH: TextureFormat = TextureFormat::Depth32Float;
/// Openness of voxels.
pub(crate) const OPENNESS: TextureFormat = TextureFormat::Rgba16Float;

/// Corners of tiles.
pub(crate) const CORNERS: TextureFormat = TextureFormat::R32Uint;

/// A vertex of solids as `solid.wgsl` reads it.
#[repr(C)]
#[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable)]
pub(crate) struct Vertex {
    pub(crate) point: [f32; 3],
    pub(crate) normal: [f32; 3],
    pub(crate) colour: [f32; 3],
    pub(crate) material: u32,
}

/// What a compute pass binds.
#[derive(Debug)]
pub(crate) struct Layouts {
    /// `@group(0)`: the frame and a slice of it.
    pub(crate) frame: BindGroupLayout,
    /// `@group(1)`: what shading looks up.
    pub(crate) lookups: BindGroupLayout,
    /// `@group(1)` of solids with pictures.
    pub(crate) maps: BindGroupLayout,
    /// `@group(3)` of each pass.
    pub(crate) visibility: BindGroupLayout,
    pub(crate) density: BindGroupLayout,
    pub(crate) volume: BindGroupLayout,
    pub(crate) opacity: BindGroupLayout,
    pub(crate) sort: BindGroupLayout,
    pub(crate) shade: BindGroupLayout,
}

/// Everything that runs on the device.
#[derive(Debug)]
pub(crate) struct Pipelines {
    pub(crate) clear: ComputePipeline,
    pub(crate) splat: ComputePipeline,
    /// The second pass of 32-bit visibility.
    pub(crate) name: Option<ComputePipeline>,
    pub(crate) density: ComputePipeline,
    pub(crate) volume: ComputePipeline,
    pub(crate) opacity_near: ComputePipeline,
    pub(crate) opacity_count: ComputePipeline,
    pub(crate) sort: ComputePipeline,
    pub(crate) solids: RenderPipeline,
    pub(crate) solids_with_maps: RenderPipeline,
    pub(crate) solids_from_light: RenderPipeline,
}

fn entry(binding: u32, ty: BindingType) -> BindGroupLayoutEntry {
    let computed = matches!(
        ty,
        BindingType::StorageTexture { .. }
            | BindingType::Buffer { ty: BufferBindingType::Storage { read_only: false }, .. }
    );
    let visibility = match computed {
        true => ShaderStages::COMPUTE,
        false => ShaderStages::COMPUTE | ShaderStages::VERTEX_FRAGMENT,
    };
    BindGroupLayoutEntry { binding, visibility, ty, count: None }
}

fn buffer(ty: BufferBindingType, has_dynamic_offset: bool) -> BindingType {
    BindingType::Buffer { ty, has_dynamic_offset, min_binding_size: None }
}

fn texture(sample_type: TextureSampleType, view_dimension: TextureViewDimension) -> BindingType {
    BindingType::Texture { sample_type, view_dimension, multisampled: false }
}

impl Layouts {
    pub(crate) fn new(gpu: &Gpu) -> Self {
        let uniform = |offset| buffer(BufferBindingType::Uniform, offset);
        let read = buffer(BufferBindingType::Storage { read_only: true }, false);
        let write = buffer(BufferBindingType::Storage { read_only: false }, false);
        let float = |filterable, d| texture(TextureSampleType::Float { filterable }, d);
        let (d2, d3) = (TextureViewDimension::D2, TextureViewDimension::D3);
        let depth = texture(TextureSampleType::Depth, d2);
        let depths = texture(TextureSampleType::Depth, TextureViewDimension::D2Array);
        let sampler = BindingType::Sampler(SamplerBindingType::Filtering);
        let openness = BindingType::StorageTexture {
            access: StorageTextureAccess::WriteOnly,
            format: OPENNESS,
            view_dimension: d3,
        };
        let corners = BindingType::StorageTexture {
            access: StorageTextureAccess::WriteOnly,
            format: CORNERS,
            view_dimension: d2,
        };
        let layout = |label, types: &[BindingType]| {
            let entries: Vec<_> =
                types.iter().enumerate().map(|(i, ty)| entry(i as u32, *ty)).collect();
            let descriptor =
                wgpu::BindGroupLayoutDescriptor { label: Some(label), entries: &entries };
            gpu.device.create_bind_group_layout(&descriptor)
        };
        Self {
            frame: layout("frame", &[read, uniform(true)]),
            lookups: layout(
                "lookups",
                &[
                    read,
                    float(true, d2),
                    float(true, d3),
                    sampler,
                    float(true, d3),
                    read,
                    depths,
                    float(false, d2),
                    float(false, d2),
                    depth,
                ],
            ),
            maps: layout(
                "maps",
                &[uniform(false), float(true, d2), sampler, float(true, d2), sampler],
            ),
            visibility: layout("visibility", &[write, write, depth]),
            density: layout("density", &[write]),
            volume: layout("volume", &[read, read, openness]),
            opacity: layout("opacity", &[write]),
            sort: layout("sort", &[read, write, write, corners]),
            shade: layout("shade", &[read, write, texture(TextureSampleType::Uint, d2)]),
        }
    }
}

/// What shading is compiled for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) struct ShadeFor {
    pub(crate) model: Model,
    pub(crate) shading: Shading,
    pub(crate) holds: Holds,
}

/// What tiles of the picture hold at most.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) enum Holds {
    Hair,
    Solids,
    Backdrop,
}

impl Holds {
    pub(crate) const ALL: [Self; 3] = [Self::Hair, Self::Solids, Self::Backdrop];
}

/// A compute pipeline of one entry point of one file.
fn compute(
    gpu: &Gpu,
    source: Source,
    name: &str,
    main: &str,
    groups: &[Option<&BindGroupLayout>],
    constants: &[(&str, f64)],
) -> ComputePipeline {
    let layout = gpu.device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
        label: Some(name),
        bind_group_layouts: groups,
        ..Default::default()
    });
    let module = gpu.device.create_shader_module(wgpu::ShaderModuleDescriptor {
        label: Some(name),
        source: wgpu::ShaderSource::Wgsl(source.text.into()),
    });
    gpu.device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
        label: Some(name),
        layout: Some(&layout),
        module: &module,
        entry_point: Some(main),
        compilation_options: wgpu::PipelineCompilationOptions {
            constants,
            // There is no workgroup memory to be cleared.
            zero_initialize_workgroup_memory: false,
        },
        cache: None,
    })
}

impl Pipelines {
    /// All pipelines but those that shade.
    pub(crate) fn new(gpu: &Gpu, layouts: &Layouts, strands: &BindGroupLayout) -> Self {
        let pass = |name: &str, main: &str, own: &BindGroupLayout, constants: &[(&str, f64)]| {
            let groups = [Some(&layouts.frame), None, Some(strands), Some(own)];
            compute(gpu, Source::of(name), name, main, &groups, constants)
        };
        let visibility = if gpu.wide { "visibility_wide" } else { "visibility_narrow" };
        let seen = &layouts.visibility;
        let opacity =
            |counting| pass("opacity", "splat", &layouts.opacity, &[("counting", counting)]);
        Self {
            clear: pass(visibility, "clear", seen, &[]),
            splat: pass(visibility, "splat", seen, &[]),
            name: (!gpu.wide).then(|| pass(visibility, "splat", seen, &[("naming", 1.0)])),
            density: pass("density", "splat", &layouts.density, &[]),
            volume: pass("volume", "volume", &layouts.volume, &[]),
            opacity_near: opacity(0.0),
            opacity_count: opacity(1.0),
            sort: {
                let (lookups, own) = (Some(&layouts.lookups), Some(&layouts.sort));
                let groups = [Some(&layouts.frame), lookups, None, own];
                compute(gpu, Source::of("shade"), "sort", "sort", &groups, &[])
            },
            solids: raster(gpu, layouts, Raster::Seen),
            solids_with_maps: raster(gpu, layouts, Raster::WithMaps),
            solids_from_light: raster(gpu, layouts, Raster::Lit),
        }
    }
}

/// The pipeline that shades one kind of picture.
pub(crate) fn shade(
    gpu: &Gpu,
    layouts: &Layouts,
    strands: &BindGroupLayout,
    what: ShadeFor,
) -> ComputePipeline {
    let colours = what.shading == Shading::Colour;
    let source = Source::of("shade")
        .with("MODEL", &format!("{}u", what.model as u32))
        .with("HOLDS", &format!("{}u", what.holds as u32))
        .with("COLOURS", if colours { "true" } else { "false" });
    let groups =
        [Some(&layouts.frame), Some(&layouts.lookups), Some(strands), Some(&layouts.shade)];
    compute(gpu, source, "shade", "shade", &groups, &[])
}

/// How solids are drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Raster {
    /// For the camera.
    Seen,
    /// The same, with pictures on them.
    WithMaps,
    /// For a light.
    Lit,
}

fn raster(gpu: &Gpu, layouts: &Layouts, how: Raster) -> RenderPipeline {
    let (camera, maps) = (how != Raster::Lit, how == Raster::WithMaps);
    let frame_and_maps = [Some(&layouts.frame), Some(&layouts.maps)];
    let file = if maps { "solid_maps" } else { "solid" };
    let layout = gpu.device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
        label: Some(file),
        bind_group_layouts: if maps { &frame_and_maps } else { &frame_and_maps[..1] },
        ..Default::default()
    });
    let module = gpu.device.create_shader_module(wgpu::ShaderModuleDescriptor {
        label: Some(file),
        source: wgpu::ShaderSource::Wgsl(Source::of(file).text.into()),
    });
    let attributes = wgpu::vertex_attr_array![
        0 => Float32x3, 1 => Float32x3, 2 => Float32x3, 3 => Uint32
    ];
    let places = wgpu::vertex_attr_array![4 => Float32x4];
    let buffer = |stride: usize, attributes| {
        Some(wgpu::VertexBufferLayout {
            array_stride: stride as u64,
            step_mode: wgpu::VertexStepMode::Vertex,
            attributes,
        })
    };
    let vertices = [buffer(size_of::<Vertex>(), &attributes[..]), buffer(16, &places)];
    let compare = if camera { wgpu::CompareFunction::Greater } else { wgpu::CompareFunction::Less };
    let targets = [NORMAL, ALBEDO].map(|f| Some(wgpu::ColorTargetState::from(f)));
    gpu.device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some(file),
        layout: Some(&layout),
        vertex: wgpu::VertexState {
            module: &module,
            entry_point: Some(if camera { "seen" } else { "lit" }),
            compilation_options: Default::default(),
            buffers: if maps { &vertices } else { &vertices[..1] },
        },
        primitive: Default::default(),
        depth_stencil: Some(wgpu::DepthStencilState {
            format: DEPTH,
            depth_write_enabled: Some(true),
            depth_compare: Some(compare),
            stencil: Default::default(),
            bias: Default::default(),
        }),
        multisample: Default::default(),
        fragment: camera.then(|| wgpu::FragmentState {
            module: &module,
            entry_point: Some("store"),
            compilation_options: Default::default(),
            targets: &targets,
        }),
        multiview_mask: None,
        cache: None,
    })
}
