//! The renderer's work: what is to be done when something has changed, and doing it slice by slice.
//!
//! Guarantees: a slice takes about as long as [`super::SLICE`] once the passes' rates are known, and a pass that is cut gives the
//! same picture. Not promised: the time of the first slices, which measure the rates.

use super::targets::{Grid, NO_TILES, TEXEL, TILES, Tables, lookups};
use super::{Effort, Look, MOST_SLICES, Pass, Renderer, SLICE, SLICE_STRIDE, Stale, Step};
use crate::camera::Sphere;
use crate::pipelines::Holds;
use crate::strands::{Blocks, Slice};
use crate::surface::solid_voxels;
use bytemuck::Zeroable;
use glam::{Mat4, Vec2, Vec3};
use std::time::Instant;

impl Renderer {
    /// Does one slice of work.
    pub(super) fn slice(&mut self) {
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

    pub(super) fn submit(&self, encoder: wgpu::CommandEncoder, slices: &[Slice]) {
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
                let Look { share, stands_for, .. } = self.look;
                self.drawn = self.strands.blocks(&self.gpu, share, stands_for);
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
            self.shadowing = self.strands.blocks(&self.gpu, share, self.look.stands_for);
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

    pub(super) fn write_frame(&mut self) {
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
    pub(super) fn encode(
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
        let last = first + n;
        if colours.is_none() {
            if n > 0 {
                pass.draw_indexed(first * 3..last * 3, 0, 0..1);
            }
            return;
        }
        for run in &self.solids.runs {
            let (from, to) = (run.triangles.start.max(first), run.triangles.end.min(last));
            let from_below = |height: f32| match self.camera.orthographic {
                Some(_) => self.camera.ahead().y > 0.0,
                None => self.camera.eye.y < height,
            };
            if from >= to || run.ground.is_some_and(from_below) {
                continue;
            }
            match &run.maps {
                None => pass.set_pipeline(&self.pipelines.solids),
                Some(maps) => {
                    pass.set_pipeline(&self.pipelines.solids_with_maps);
                    pass.set_bind_group(1, maps, &[]);
                    pass.set_vertex_buffer(1, self.solids.places.slice(..));
                }
            }
            pass.draw_indexed(from * 3..to * 3, 0, 0..1);
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

/// Standard deviation of the camera's shake, pixels: a Gaussian filter that keeps single hairs fine.
const FILTER_PIXELS: f32 = 0.38;

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
