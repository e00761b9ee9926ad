//! Hair on the GPU: tufts in slots of a few large buffers, and lists of the blocks of points that are drawn.
//!
//! A tuft that is already there is not sent again: tufts are known by the hash of their content. A slot that falls
//! free takes the next tuft that fits; when more lies free than is used, everything is laid out anew.
//!
//! Guaranteed: positions are uploaded bit for bit; a point costs 20 bytes; a chunk never passes the adapter's limit
//! for one binding. Curves of fewer than two points, or with a point that is no place, are not drawn. Pictures do not depend
//! on what was uploaded before, but for segments at the very same depth in a pixel, of which the one that lies further back in
//! memory is seen. Not guaranteed: which slot a tuft gets.

use crate::gpu::Gpu;
use crate::twins::twins;
use crate::view::Paint;
use coif_nodes::data::attributes::WIDTH;
use coif_nodes::data::curves::{Curves, Tuft};
use coif_nodes::maths::hash::Key;
use glam::Vec3;
use std::collections::BTreeMap;
use std::sync::Arc;
use wgpu::BufferUsages;

twins! { "points":
    /// What one dispatch works on.
    struct Slice {
        first: u32,
        count: u32,
        base: u32,
        points: u32,
        light: u32,
        stride: u32,
        groups: u32,
        words: u32,
    }
}

/// Points that one workgroup draws.
const BLOCK: u32 = 64;
/// Bytes of a point, without its paint.
const POINT: u64 = 16;
/// What is put together before it is handed to the queue, bytes: larger costs memory, smaller costs calls.
const STAGED: usize = 8 << 20;

/// What an upload did.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Uploaded {
    /// Tufts sent.
    pub tufts: usize,
    /// Tufts that were there already.
    pub kept: usize,
    /// Tufts that were there and are not any more.
    pub removed: usize,
    /// Bytes sent, paint included.
    pub bytes: u64,
}

/// Where a tuft lies.
#[derive(Clone, Debug)]
struct Slot {
    tuft: Arc<Tuft>,
    chunk: usize,
    first: u32,
    /// Box around the curves that are drawn, cm.
    bounds: Option<(Vec3, Vec3)>,
    /// Their length in all, cm.
    length: f64,
}

/// One binding's worth of points.
#[derive(Debug)]
pub(crate) struct Chunk {
    pub(crate) points: wgpu::Buffer,
    paint: wgpu::Buffer,
    capacity: u32,
    /// First point and length of what is free, in order, never touching each other.
    free: Vec<(u32, u32)>,
    /// Ids of its points start above this.
    pub(crate) base: u32,
}

/// Blocks of one chunk for one share of the strands.
#[derive(Debug)]
pub(crate) struct Blocks {
    pub(crate) chunk: usize,
    pub(crate) count: u32,
    /// Points, paint and these blocks, for `@group(2)`.
    pub(crate) group: wgpu::BindGroup,
}

/// All hair on the GPU.
#[derive(Debug)]
pub(crate) struct Strands {
    pub(crate) layout: wgpu::BindGroupLayout,
    pub(crate) chunks: Vec<Chunk>,
    slots: Vec<Slot>,
    paint_key: u64,
    most_points: u32,
    /// Points that may lie free whatever is used.
    slack: u64,
}

impl Strands {
    pub(crate) fn new(gpu: &Gpu) -> Self {
        let entry = |binding| wgpu::BindGroupLayoutEntry {
            binding,
            visibility: wgpu::ShaderStages::COMPUTE,
            ty: wgpu::BindingType::Buffer {
                ty: wgpu::BufferBindingType::Storage { read_only: true },
                has_dynamic_offset: false,
                min_binding_size: None,
            },
            count: None,
        };
        let layout = gpu.device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("strands"),
            entries: &[entry(0), entry(1), entry(2)],
        });
        let limits = gpu.device.limits();
        let bytes = limits.max_storage_buffer_binding_size.min(limits.max_buffer_size);
        let most_points = (bytes / POINT).min(1 << 26) as u32;
        let mut strands = Self {
            layout,
            chunks: vec![],
            slots: vec![],
            paint_key: 0,
            most_points,
            slack: 65_536,
        };
        strands.grow(gpu, 1);
        strands
    }

    /// Makes chunks smaller than the adapter's limit, so that a test reaches the second one, and free room too.
    #[cfg(test)]
    pub(crate) fn limit_chunks(&mut self, points: u32) {
        self.most_points = points;
        self.slack = u64::from(points);
    }

    /// Where each tuft lies: its chunk and first point there.
    #[cfg(test)]
    pub(crate) fn places(&self) -> Vec<(Arc<Tuft>, usize, u32)> {
        self.slots.iter().map(|slot| (slot.tuft.clone(), slot.chunk, slot.first)).collect()
    }

    /// Box around all curves that are drawn, cm.
    pub(crate) fn bounds(&self) -> Option<(Vec3, Vec3)> {
        let boxes = self.slots.iter().filter_map(|slot| slot.bounds);
        boxes.reduce(|(a, b), (lo, hi)| (a.min(lo), b.max(hi)))
    }

    /// Total length of all curves that are drawn, cm.
    pub(crate) fn length(&self) -> f64 {
        self.slots.iter().map(|slot| slot.length).sum()
    }

    /// Points of all curves, drawn or not.
    pub(crate) fn points(&self) -> usize {
        self.slots.iter().map(|slot| slot.tuft.points().len()).sum()
    }

    /// Puts these curves, and no others, on the GPU.
    pub(crate) fn set(&mut self, gpu: &Gpu, curves: &Curves, paint: &Paint) -> Uploaded {
        let mut uploaded = Uploaded::default();
        let mut old: BTreeMap<Key, Vec<Slot>> = BTreeMap::new();
        for slot in self.slots.drain(..) {
            old.entry(slot.tuft.key()).or_default().push(slot);
        }
        let mut kept = vec![];
        let mut new = vec![];
        let tufts = curves.tufts().iter().filter(|t| !t.points().is_empty());
        for (number, tuft) in tufts.enumerate() {
            match old.get_mut(&tuft.key()).and_then(Vec::pop) {
                Some(slot) => kept.push((number, slot)),
                None => new.push((number, tuft)),
            }
        }
        for slot in old.into_values().flatten() {
            uploaded.removed += 1;
            self.chunks[slot.chunk].give_back(slot.first, slot.tuft.points().len() as u32);
        }
        uploaded.kept = kept.len();
        let repaint = self.paint_key != paint.key;
        self.paint_key = paint.key;
        let total: u64 = curves.point_count() as u64;
        let held: u64 = self.chunks.iter().map(|c| u64::from(c.capacity)).sum();
        if held > 2 * total + self.slack {
            // More lies free than is used: start over.
            let all = kept.drain(..).map(|(number, slot)| (number, slot.tuft)).collect::<Vec<_>>();
            self.chunks.clear();
            let again = all.into_iter().chain(new.into_iter().map(|(n, t)| (n, t.clone())));
            let mut again: Vec<(usize, Arc<Tuft>)> = again.collect();
            again.sort_by_key(|(number, _)| *number);
            uploaded.kept = 0;
            self.place(gpu, &again, paint, &mut kept, &mut uploaded);
            if self.chunks.is_empty() {
                self.grow(gpu, 1);
            }
        } else {
            let new: Vec<(usize, Arc<Tuft>)> =
                new.into_iter().map(|(n, t)| (n, t.clone())).collect();
            if repaint {
                let mut writer = Writer::new(gpu);
                for (_, slot) in &kept {
                    let words = paint.of(&slot.tuft);
                    let chunk = &self.chunks[slot.chunk];
                    writer.put(
                        &chunk.paint,
                        u64::from(slot.first) * 4,
                        bytemuck::cast_slice(&words),
                    );
                }
                uploaded.bytes += writer.finish();
            }
            self.place(gpu, &new, paint, &mut kept, &mut uploaded);
        }
        kept.sort_by_key(|(number, _)| *number);
        self.slots = kept.into_iter().map(|(_, slot)| slot).collect();
        uploaded
    }

    fn place(
        &mut self,
        gpu: &Gpu,
        tufts: &[(usize, Arc<Tuft>)],
        paint: &Paint,
        slots: &mut Vec<(usize, Slot)>,
        uploaded: &mut Uploaded,
    ) {
        let mut points = Writer::new(gpu);
        let mut paints = Writer::new(gpu);
        let mut rest: u64 = tufts.iter().map(|(_, t)| t.points().len() as u64).sum();
        for (number, tuft) in tufts {
            let size = tuft.points().len() as u32;
            let found = self
                .chunks
                .iter_mut()
                .enumerate()
                .find_map(|(i, chunk)| Some((i, chunk.take(size)?)));
            let found = found.or_else(|| {
                let chunk = self.grow(gpu, rest);
                Some((chunk, self.chunks[chunk].take(size)?))
            });
            rest -= u64::from(size);
            // Every tuft fits a chunk: it has 65,536 points at most, and any adapter binds 128 MiB.
            let Some((chunk, first)) = found else { continue };
            let to = &self.chunks[chunk];
            let Packed { words, bounds, length } = packed(tuft);
            points.put(&to.points, u64::from(first) * POINT, bytemuck::cast_slice(&words));
            paints.put(&to.paint, u64::from(first) * 4, bytemuck::cast_slice(&paint.of(tuft)));
            slots.push((*number, Slot { tuft: tuft.clone(), chunk, first, bounds, length }));
            uploaded.tufts += 1;
        }
        uploaded.bytes += points.finish() + paints.finish();
    }

    /// A new chunk with room for `points` and some more, as far as a binding goes.
    fn grow(&mut self, gpu: &Gpu, points: u64) -> usize {
        let wanted = points + points / 8 + 64;
        let capacity = wanted.min(u64::from(self.most_points)).max(64) as u32;
        let buffer = |label, bytes| {
            gpu.device.create_buffer(&wgpu::BufferDescriptor {
                label: Some(label),
                size: bytes,
                usage: BufferUsages::STORAGE | BufferUsages::COPY_DST | BufferUsages::COPY_SRC,
                mapped_at_creation: false,
            })
        };
        let base = self.chunks.last().map_or(0, |c| c.base + c.capacity);
        self.chunks.push(Chunk {
            points: buffer("points", u64::from(capacity) * POINT),
            paint: buffer("paint", u64::from(capacity) * 4),
            capacity,
            free: vec![(0, capacity)],
            base,
        });
        self.chunks.len() - 1
    }

    /// The blocks that draw `share` (over 0, at most 1) of each tuft's strands, the first of each: any prefix of a tuft is
    /// an even choice. This is the one place where widths make up for strands that are missing: each is as much wider as there are
    /// fewer, of those that are here and are not drawn, and of `stands_for` (1 or more) for each that was never made.
    pub(crate) fn blocks(&self, gpu: &Gpu, share: f32, stands_for: f32) -> Vec<Blocks> {
        let mut lists: Vec<Vec<[u32; 4]>> = vec![vec![]; self.chunks.len()];
        // Neighbours with the same gain become one run, so that tufts of one curve do not cost a workgroup each.
        let mut runs: Vec<(usize, u32, u32, f32)> = vec![];
        for slot in &self.slots {
            let curves = slot.tuft.len();
            let drawn = ((curves as f32 * share).ceil() as usize).clamp(1, curves);
            let points = slot.tuft.offsets()[drawn];
            let gain = stands_for * curves as f32 / drawn as f32;
            match runs.last_mut() {
                Some((chunk, first, n, same))
                    if *chunk == slot.chunk && *first + *n == slot.first && *same == gain =>
                {
                    *n += points;
                }
                _ => runs.push((slot.chunk, slot.first, points, gain)),
            }
        }
        for (chunk, first, points, gain) in runs {
            let mut at = 0;
            while at < points {
                let n = BLOCK.min(points - at);
                lists[chunk].push([first + at, n, gain.to_bits(), 0]);
                at += n;
            }
        }
        let blocks = lists.into_iter().enumerate().map(|(chunk, list)| {
            let bytes: &[u8] = bytemuck::cast_slice(&list);
            let buffer = gpu.device.create_buffer(&wgpu::BufferDescriptor {
                label: Some("blocks"),
                size: (bytes.len() as u64).max(16),
                usage: BufferUsages::STORAGE | BufferUsages::COPY_DST,
                mapped_at_creation: false,
            });
            gpu.queue.write_buffer(&buffer, 0, bytes);
            let Chunk { points, paint, .. } = &self.chunks[chunk];
            let entries: Vec<wgpu::BindGroupEntry> = [points, paint, &buffer]
                .iter()
                .enumerate()
                .map(|(i, b)| wgpu::BindGroupEntry {
                    binding: i as u32,
                    resource: b.as_entire_binding(),
                })
                .collect();
            let group = gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
                label: Some("strands"),
                layout: &self.layout,
                entries: &entries,
            });
            Blocks { chunk, count: list.len() as u32, group }
        });
        blocks.collect()
    }

    /// Points of a chunk that ids may name.
    pub(crate) fn capacity(&self, chunk: usize) -> u32 {
        self.chunks[chunk].capacity
    }

    /// The tuft, curve and point that an id of the visibility buffer names.
    pub(crate) fn named(&self, id: u32) -> Option<(Arc<Tuft>, usize, usize)> {
        let k = id.checked_sub(1)?;
        let slot = self.slots.iter().find(|slot| {
            let first = self.chunks[slot.chunk].base + slot.first;
            (first..first + slot.tuft.points().len() as u32).contains(&k)
        })?;
        let point = k - self.chunks[slot.chunk].base - slot.first;
        let curve = slot.tuft.offsets().partition_point(|o| *o <= point) - 1;
        Some((slot.tuft.clone(), curve, point as usize))
    }
}

impl Chunk {
    fn take(&mut self, size: u32) -> Option<u32> {
        let i = self.free.iter().position(|(_, n)| *n >= size)?;
        let (first, n) = self.free[i];
        if n == size {
            self.free.remove(i);
        } else {
            self.free[i] = (first + size, n - size);
        }
        Some(first)
    }

    fn give_back(&mut self, first: u32, size: u32) {
        let i = self.free.partition_point(|(at, _)| *at < first);
        self.free.insert(i, (first, size));
        if i + 1 < self.free.len() && first + size == self.free[i + 1].0 {
            self.free[i].1 += self.free[i + 1].1;
            self.free.remove(i + 1);
        }
        if i > 0 && self.free[i - 1].0 + self.free[i - 1].1 == first {
            self.free[i - 1].1 += self.free[i].1;
            self.free.remove(i);
        }
    }
}

/// A tuft as the GPU holds it.
struct Packed {
    words: Vec<[u32; 4]>,
    bounds: Option<(Vec3, Vec3)>,
    length: f64,
}

fn packed(tuft: &Tuft) -> Packed {
    let width = tuft.view(WIDTH);
    let mut out =
        Packed { words: Vec::with_capacity(tuft.points().len()), bounds: None, length: 0.0 };
    for i in 0..tuft.len() {
        let range = tuft.range(i);
        let curve = tuft.curve(i);
        let whole: f32 = curve.windows(2).map(|p| p[0].distance(p[1])).sum();
        let inverse = if whole > 0.0 { 1.0 / whole } else { 0.0 };
        let finite = whole.is_finite();
        if finite && curve.len() > 1 {
            out.length += f64::from(whole);
            out.bounds = curve.iter().fold(out.bounds, |b, p| {
                let (lo, hi) = b.unwrap_or((*p, *p));
                Some((lo.min(*p), hi.max(*p)))
            });
        }
        let mut length = 0.0;
        for (j, p) in curve.iter().enumerate() {
            if j > 0 {
                length += curve[j - 1].distance(*p);
            }
            // Only the root has u 0: that is how shaders know it.
            let u = ((length * inverse * 32_767.0) as u32).clamp(u32::from(j > 0), 32_767);
            let radius =
                half::f16::from_f32((0.5 * width.at(i, range.start + j)).clamp(0.0, 100.0));
            let last = u32::from(j + 1 == curve.len() || !finite);
            let word = u32::from(radius.to_bits()) | (u << 16) | (last << 31);
            out.words.push([p.x.to_bits(), p.y.to_bits(), p.z.to_bits(), word]);
        }
    }
    out
}

/// Gathers neighbouring writes to a buffer into few.
struct Writer<'a> {
    gpu: &'a Gpu,
    to: Option<(wgpu::Buffer, u64)>,
    staged: Vec<u8>,
    bytes: u64,
    since_submit: u64,
}

impl<'a> Writer<'a> {
    fn new(gpu: &'a Gpu) -> Self {
        Self { gpu, to: None, staged: vec![], bytes: 0, since_submit: 0 }
    }

    fn put(&mut self, buffer: &wgpu::Buffer, offset: u64, bytes: &[u8]) {
        let follows = self
            .to
            .as_ref()
            .is_some_and(|(b, at)| b == buffer && at + self.staged.len() as u64 == offset);
        if !follows || self.staged.len() + bytes.len() > STAGED {
            self.flush();
            self.to = Some((buffer.clone(), offset));
        }
        self.staged.extend_from_slice(bytes);
    }

    fn flush(&mut self) {
        if let Some((buffer, offset)) = self.to.take()
            && !self.staged.is_empty()
        {
            self.gpu.queue.write_buffer(&buffer, offset, &self.staged);
            self.bytes += self.staged.len() as u64;
            self.since_submit += self.staged.len() as u64;
            self.staged.clear();
            // The queue keeps its own copy until the next submission.
            if self.since_submit > 64 << 20 {
                self.gpu.queue.submit([]);
                self.gpu.wait();
                self.since_submit = 0;
            }
        }
    }

    fn finish(mut self) -> u64 {
        self.flush();
        self.bytes
    }
}
