//! What the renderer's passes draw into and read from: textures, buffers and their groups.
//!
//! Guarantees: everything is made at once and whole, for the sizes given. Not promised: that the adapter has room; sizes are
//! checked before ([`super::RenderError::Size`]).

use super::OPACITY_MAP;
use crate::gpu::Gpu;
use crate::hair::ScatterTable;
use crate::light::Rig;
use crate::pipelines::{ALBEDO, CORNERS, DEPTH, Layouts, NORMAL, OPENNESS};
use crate::surface::RootGrid;
use wgpu::{BufferUsages as B, TextureUsages as U};

/// Texels across a light's depth map of solids.
const SOLID_MAP: u32 = 1024;
/// Bytes of a texel of an opacity map.
pub(super) const TEXEL: u64 = 20;
/// Tiles that one slice of shading may sort, and how many corners of them stand in a row; as `shade.wgsl` has it.
pub(super) const TILES: u32 = 65_535;
const ROW: u32 = 256;
/// No tiles yet, for hair, solids and the backdrop: workgroups along x, y and z, and room.
pub(super) const NO_TILES: [[u32; 4]; 3] = [[0, 1, 1, 0]; 3];

/// Targets of the size of the picture.
#[derive(Debug)]
pub(super) struct Targets {
    pub(super) normal: wgpu::TextureView,
    pub(super) albedo: wgpu::TextureView,
    pub(super) depth: wgpu::TextureView,
    /// Ids, or words that hold them.
    pub(super) shown: wgpu::Buffer,
    pub(super) sums: wgpu::Buffer,
    pub(super) visibility: wgpu::BindGroup,
    /// Tiles of a slice by what they hold, and what it begins as: no tiles.
    pub(super) tiles: wgpu::Buffer,
    pub(super) no_tiles: wgpu::Buffer,
    pub(super) sort: wgpu::BindGroup,
    pub(super) shade: wgpu::BindGroup,
}

/// The grid of light around hair.
#[derive(Debug)]
pub(super) struct Grid {
    pub(super) density: wgpu::Buffer,
    pub(super) openness: wgpu::TextureView,
    pub(super) density_group: wgpu::BindGroup,
    pub(super) volume_group: wgpu::BindGroup,
}

/// What lights see: solids in depth maps, hair in deep opacity maps.
#[derive(Debug)]
pub(super) struct Maps {
    pub(super) opacity: wgpu::Buffer,
    /// One view a light to draw into, and one of all to read.
    pub(super) depth_of: Vec<wgpu::TextureView>,
    pub(super) depths: wgpu::TextureView,
    pub(super) opacity_group: wgpu::BindGroup,
}

/// What shading looks up that neither hair nor solids change. A backdrop may be large, so it is not sent at every turn of
/// the camera.
#[derive(Debug)]
pub(super) struct Tables {
    pub(super) scatter: wgpu::Buffer,
    pub(super) backdrop: wgpu::TextureView,
    pub(super) roots: wgpu::TextureView,
    pub(super) sampler: wgpu::Sampler,
}

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

pub(super) fn storage(gpu: &Gpu, label: &str, size: u64) -> wgpu::Buffer {
    gpu.device.create_buffer(&wgpu::BufferDescriptor {
        label: Some(label),
        size: size.max(16),
        usage: B::STORAGE | B::COPY_DST | B::COPY_SRC,
        mapped_at_creation: false,
    })
}

pub(super) fn group(
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
    pub(super) fn new(gpu: &Gpu, layouts: &Layouts, width: u32, height: u32) -> Self {
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
    pub(super) fn new(gpu: &Gpu, layouts: &Layouts, size: [u32; 3], shell: &[u32]) -> Self {
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
    pub(super) fn new(gpu: &Gpu, layouts: &Layouts) -> Self {
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
    pub(super) fn new(
        gpu: &Gpu,
        table: &ScatterTable,
        rig: &Rig,
        roots: Option<&RootGrid>,
    ) -> Self {
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

pub(super) fn lookups(
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
