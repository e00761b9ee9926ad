//! Solids on the GPU: one vertex and one index buffer for all of them.

use crate::gpu::Gpu;
use crate::surface::{Material, Solid};
use glam::Vec3;
use wgpu::BufferUsages;

/// A vertex as `solid.wgsl` reads it.
#[repr(C)]
#[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable)]
pub(crate) struct Vertex {
    point: [f32; 3],
    normal: [f32; 3],
    colour: [f32; 3],
    material: u32,
}

/// Triangles of solids; those that cast shadows come first.
#[derive(Debug)]
pub(crate) struct Solids {
    pub(crate) vertices: wgpu::Buffer,
    pub(crate) indices: wgpu::Buffer,
    /// Triangles in all, and how many of them, from the start, cast shadows.
    pub(crate) triangles: u32,
    pub(crate) casting: u32,
    /// Box around all that cast, cm.
    pub(crate) bounds: Option<(Vec3, Vec3)>,
}

impl Solids {
    pub(crate) fn new(gpu: &Gpu, solids: &[Solid]) -> Self {
        let mut order: Vec<&Solid> = solids.iter().collect();
        order.sort_by_key(|s| !s.casts);
        let mut vertices = vec![];
        let mut indices: Vec<u32> = vec![];
        let mut casting = 0;
        let mut bounds = None;
        for solid in order {
            let first = vertices.len() as u32;
            let material = match solid.material {
                Material::Skin => 0,
                Material::Clay => 1,
                Material::Ground => 2,
                Material::Flat => 3,
            };
            for (i, p) in solid.points.iter().enumerate() {
                vertices.push(Vertex {
                    point: p.to_array(),
                    normal: solid.normals[i].to_array(),
                    colour: solid.colours[i].to_array(),
                    material,
                });
                if solid.casts {
                    let (lo, hi) = bounds.unwrap_or((*p, *p));
                    bounds = Some((lo.min(*p), hi.max(*p)));
                }
            }
            indices.extend(solid.triangles.iter().flatten().map(|i| i + first));
            if solid.casts {
                casting = indices.len() as u32 / 3;
            }
        }
        let buffer = |label, bytes: &[u8], usage| {
            let buffer = gpu.device.create_buffer(&wgpu::BufferDescriptor {
                label: Some(label),
                size: (bytes.len() as u64).max(64),
                usage: usage | BufferUsages::COPY_DST,
                mapped_at_creation: false,
            });
            gpu.queue.write_buffer(&buffer, 0, bytes);
            buffer
        };
        Self {
            vertices: buffer("vertices", bytemuck::cast_slice(&vertices), BufferUsages::VERTEX),
            indices: buffer("indices", bytemuck::cast_slice(&indices), BufferUsages::INDEX),
            triangles: indices.len() as u32 / 3,
            casting,
            bounds,
        }
    }
}
