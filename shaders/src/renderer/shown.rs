//! The picture so far for a display, made on the GPU: what a viewport shows many times a second.
//!
//! A quarter of the bytes of a [`Picture`](crate::picture::Picture) are read back, and the CPU computes nothing.
//! Guaranteed: within one step of 255 of what [`Picture::encoded`](crate::picture::Picture::encoded) gives. Not guaranteed:
//! the same bytes, for powers differ in their last bits; files are written from pictures.

use super::{Renderer, group, storage};
use crate::display::Transform;
use crate::gpu::Gpu;
use crate::source::Source;
use crate::twins::twins;
use wgpu::BufferUsages as B;

twins! { "shown":
    /// How sums become bytes.
    struct Showing {
        width: u32,
        height: u32,
        transform: u32,
        gain: f32,
    }
}

/// What the last step of showing runs on.
#[derive(Debug)]
pub(super) struct Show {
    pipeline: wgpu::ComputePipeline,
    numbers: wgpu::Buffer,
    /// Of the picture's size, once it was asked for.
    room: Option<Room>,
}

/// Buffers for pictures of one size.
#[derive(Debug)]
struct Room {
    bytes: wgpu::Buffer,
    staging: wgpu::Buffer,
    group: wgpu::BindGroup,
}

impl Show {
    pub(super) fn new(gpu: &Gpu) -> Self {
        let module = gpu.device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some("shown"),
            source: wgpu::ShaderSource::Wgsl(Source::of("shown").text.into()),
        });
        let pipeline = gpu.device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label: Some("shown"),
            layout: None,
            module: &module,
            entry_point: Some("show"),
            compilation_options: Default::default(),
            cache: None,
        });
        let numbers = gpu.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("shown"),
            size: size_of::<Showing>() as u64,
            usage: B::UNIFORM | B::COPY_DST,
            mapped_at_creation: false,
        });
        Self { pipeline, numbers, room: None }
    }

    /// Forgets buffers of another size.
    pub(super) fn resized(&mut self) {
        self.room = None;
    }
}

impl Renderer {
    /// The picture as far as it is, for a display: red, green, blue and 255 of each pixel, row by row from the top. Black
    /// before the first sample is whole. `exposure` is in stops. A sample that is being shaded is finished first.
    pub fn shown(&mut self, transform: Transform, exposure: f32) -> Vec<u8> {
        while self.half_shaded() && self.lost().is_none() {
            self.slice();
        }
        let (width, height) = (self.width, self.height);
        let pixels = width as usize * height as usize;
        let mut rgba = vec![];
        if self.samples > 0 && self.lost().is_none() {
            let gain = exposure.exp2() / self.samples as f32;
            let numbers = Showing { width, height, transform: transform.number(), gain };
            rgba = self.read_shown(&numbers);
        }
        if rgba.len() != 4 * pixels {
            // Nothing is there yet, or nothing is read from a device that is gone.
            rgba = [0, 0, 0, 255].repeat(pixels);
        }
        rgba
    }

    /// Compiles what showing needs.
    pub(super) fn warm_up_shown(&mut self) {
        let numbers = Showing { width: self.width, height: self.height, transform: 0, gain: 0.0 };
        self.read_shown(&numbers);
    }

    fn read_shown(&mut self, numbers: &Showing) -> Vec<u8> {
        let gpu = &self.gpu;
        let size = u64::from(numbers.width) * u64::from(numbers.height) * 4;
        let show = &mut self.show;
        let room = show.room.get_or_insert_with(|| {
            let bytes = storage(gpu, "shown", size);
            let staging = gpu.device.create_buffer(&wgpu::BufferDescriptor {
                label: Some("shown, read back"),
                size,
                usage: B::COPY_DST | B::MAP_READ,
                mapped_at_creation: false,
            });
            let group = group(
                gpu,
                &show.pipeline.get_bind_group_layout(0),
                &[
                    self.targets.sums.as_entire_binding(),
                    bytes.as_entire_binding(),
                    show.numbers.as_entire_binding(),
                ],
            );
            Room { bytes, staging, group }
        });
        gpu.queue.write_buffer(&show.numbers, 0, bytemuck::bytes_of(numbers));
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        {
            let mut pass = encoder.begin_compute_pass(&Default::default());
            pass.set_pipeline(&show.pipeline);
            pass.set_bind_group(0, &room.group, &[]);
            pass.dispatch_workgroups(numbers.width.div_ceil(8), numbers.height.div_ceil(8), 1);
        }
        encoder.copy_buffer_to_buffer(&room.bytes, 0, &room.staging, 0, size);
        gpu.queue.submit([encoder.finish()]);
        room.staging.slice(..).map_async(wgpu::MapMode::Read, |_| {});
        gpu.wait();
        let rgba = match room.staging.slice(..).get_mapped_range() {
            Ok(bytes) => bytes.to_vec(),
            Err(_) => vec![],
        };
        room.staging.unmap();
        rgba
    }
}
