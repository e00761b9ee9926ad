//! Solids on the GPU: one vertex and one index buffer for all of them, and the pictures on them.

use crate::gpu::Gpu;
use crate::maps::{self, MaterialMaps};
use crate::pipelines::{Layouts, Vertex};
use crate::surface::{Material, Solid};
use glam::{Vec2, Vec3};
use std::ops::Range;
use std::sync::Arc;
use wgpu::BufferUsages;

/// Triangles of solids; those that cast shadows come first.
#[derive(Debug)]
pub(crate) struct Solids {
    pub(crate) vertices: wgpu::Buffer,
    /// Where each vertex lies in its maps; empty where there are none.
    pub(crate) places: wgpu::Buffer,
    pub(crate) indices: wgpu::Buffer,
    /// Triangles in all, and how many of them, from the start, cast shadows.
    pub(crate) triangles: u32,
    pub(crate) casting: u32,
    /// All triangles, in order.
    pub(crate) runs: Vec<Run>,
    /// What was uploaded of each head's materials.
    maps: Vec<Bound>,
    /// Box around all that cast, cm.
    pub(crate) bounds: Option<(Vec3, Vec3)>,
}

/// The materials of a head and what each is drawn with.
type Bound = (Arc<[MaterialMaps]>, Vec<wgpu::BindGroup>);

/// Triangles that are drawn alike.
#[derive(Debug)]
pub(crate) struct Run {
    pub(crate) triangles: Range<u32>,
    /// Of the ground its height: it is not there for who looks from below.
    pub(crate) ground: Option<f32>,
    /// The pictures on them.
    pub(crate) maps: Option<wgpu::BindGroup>,
}

impl Solids {
    /// Pictures that `old` ones have are not sent again.
    pub(crate) fn new(gpu: &Gpu, layouts: &Layouts, solids: &[Solid], old: Option<&Self>) -> Self {
        let mut order: Vec<&Solid> = solids.iter().collect();
        order.sort_by_key(|s| !s.casts);
        let mut vertices = vec![];
        let mut places: Vec<[Vec2; 2]> = vec![];
        let (mut runs, mut bound): (Vec<Run>, Vec<Bound>) = (vec![], vec![]);
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
            let begin = indices.len() as u32 / 3;
            let mut end = begin;
            indices.extend(solid.triangles.iter().flatten().map(|i| i + first));
            if let Some(mapped) = &solid.maps {
                let is_same = |known: &&Bound| Arc::ptr_eq(&known.0, &mapped.materials);
                if !bound.iter().any(|known| is_same(&known)) {
                    let known = old.and_then(|old| old.maps.iter().find(is_same)).cloned();
                    bound.push(known.unwrap_or_else(|| {
                        let bind = |material| maps::bind(gpu, layouts, material);
                        (mapped.materials.clone(), mapped.materials.iter().map(bind).collect())
                    }));
                }
                let groups = bound.iter().find(is_same).map_or(&[][..], |(_, groups)| groups);
                places.resize(first as usize, Default::default());
                places.extend_from_slice(&mapped.uvs);
                for (triangles, material) in &mapped.runs {
                    let triangles = triangles.start + begin..triangles.end + begin;
                    runs.push(Run { triangles: end..triangles.start, ground: None, maps: None });
                    end = triangles.end;
                    let maps = groups.get(*material).cloned();
                    runs.push(Run { triangles, ground: None, maps });
                }
            }
            let lies_at = solid.points.first().map(|p| p.y);
            let ground = lies_at.filter(|_| solid.material == Material::Ground);
            runs.push(Run { triangles: end..indices.len() as u32 / 3, ground, maps: None });
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
            places: buffer("places in maps", bytemuck::cast_slice(&places), BufferUsages::VERTEX),
            runs,
            maps: bound,
            indices: buffer("indices", bytemuck::cast_slice(&indices), BufferUsages::INDEX),
            triangles: indices.len() as u32 / 3,
            casting,
            bounds,
        }
    }
}
