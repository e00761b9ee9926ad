//! The adapter that draws: which one, what it can, and what to do when there is none.
//!
//! Prefers a real GPU and takes a software one where there is no other. Only limits that WebGPU
//! guarantees are asked for; larger bindings and 64-bit atomics are used where the adapter has them.

use std::sync::{Arc, OnceLock};
use wgpu::{Backends, Features, Limits};

/// Which visibility buffer is drawn into.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Precision {
    /// 64-bit where the adapter has 64-bit atomics, else 32-bit.
    #[default]
    Best,
    /// 32-bit keys in two passes, which every adapter can.
    Narrow,
}

/// Why nothing can be drawn. One line for a person.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum GpuError {
    /// No adapter at all.
    #[error(
        "no graphics adapter was found; install a Vulkan driver: your GPU's own, or the software one \
         (Debian and Ubuntu: apt-get install libvulkan1 mesa-vulkan-drivers; Fedora: dnf install \
         vulkan-loader mesa-vulkan-drivers)"
    )]
    NoAdapter,
    /// An adapter that cannot run our shaders.
    #[error("the graphics adapter {name} cannot draw hair: {reason}")]
    TooSmall {
        /// The adapter's own name.
        name: String,
        /// What it lacks.
        reason: String,
    },
}

/// A device to draw on. Shared by all renderers of the program.
#[derive(Debug)]
pub struct Gpu {
    /// Makes buffers, textures and pipelines.
    pub device: wgpu::Device,
    /// Takes work.
    pub queue: wgpu::Queue,
    /// The adapter's name and driver, for messages and pictures' metadata.
    pub info: wgpu::AdapterInfo,
    /// Why the device is gone, once it is.
    lost: Arc<OnceLock<String>>,
    /// Whether visibility is kept in 64-bit words.
    pub(crate) wide: bool,
}

impl Gpu {
    /// The best adapter of this machine.
    ///
    /// # Errors
    /// When there is none, or none that can run our shaders.
    pub fn new(precision: Precision) -> Result<Self, GpuError> {
        let descriptor = wgpu::InstanceDescriptor {
            backends: Backends::from_env().unwrap_or(Backends::PRIMARY),
            ..wgpu::InstanceDescriptor::new_without_display_handle()
        };
        let instance = wgpu::Instance::new(descriptor);
        let options = wgpu::RequestAdapterOptions {
            power_preference: wgpu::PowerPreference::HighPerformance,
            ..Default::default()
        };
        let adapter = pollster::block_on(instance.request_adapter(&options))
            .map_err(|_| GpuError::NoAdapter)?;
        Self::on(&adapter, precision)
    }

    /// A device on an adapter that was chosen elsewhere (by the window).
    ///
    /// # Errors
    /// When the adapter cannot run our shaders.
    pub fn on(adapter: &wgpu::Adapter, precision: Precision) -> Result<Self, GpuError> {
        let info = adapter.get_info();
        let too_small = |reason: String| GpuError::TooSmall { name: info.name.clone(), reason };
        if info.backend == wgpu::Backend::Gl {
            let why =
                "OpenGL cannot read depth in a shader as hair needs it; install its Vulkan driver";
            return Err(too_small(why.to_owned()));
        }
        let has = adapter.limits();
        let needs = Limits::default();
        if has.max_storage_buffers_per_shader_stage < needs.max_storage_buffers_per_shader_stage {
            return Err(too_small(format!(
                "it binds {} storage buffers to a shader and {} are needed; update its driver",
                has.max_storage_buffers_per_shader_stage,
                needs.max_storage_buffers_per_shader_stage
            )));
        }
        let wide_features = Features::SHADER_INT64 | Features::SHADER_INT64_ATOMIC_MIN_MAX;
        let wide = precision == Precision::Best && adapter.features().contains(wide_features);
        let mut features = adapter.features() & Features::TIMESTAMP_QUERY;
        if wide {
            features |= wide_features;
        }
        let limits = Limits {
            max_buffer_size: has.max_buffer_size.min(1 << 31),
            max_texture_dimension_2d: has.max_texture_dimension_2d,
            ..needs
        };
        let request = wgpu::DeviceDescriptor {
            label: Some("coif"),
            required_features: features,
            required_limits: limits,
            ..Default::default()
        };
        let (device, queue) = pollster::block_on(adapter.request_device(&request))
            .map_err(|err| too_small(err.to_string()))?;
        let lost = Arc::new(OnceLock::new());
        let told = lost.clone();
        device.set_device_lost_callback(move |_, message| {
            // The first reason is the one that counts.
            let _ = told.set(message);
        });
        Ok(Self { device, queue, info, lost, wide })
    }

    /// Whether the adapter is a program on the CPU, on which long work blocks everything.
    pub fn is_software(&self) -> bool {
        self.info.device_type == wgpu::DeviceType::Cpu
    }

    /// Why the device takes no more work, once it was lost. It does not come back: make another.
    pub fn lost(&self) -> Option<&str> {
        self.lost.get().map(String::as_str)
    }

    /// Bytes that the device's buffers and textures take; 0 where the system does not tell.
    pub fn bytes(&self) -> usize {
        let report = self.device.generate_allocator_report();
        report
            .map_or(0, |report| usize::try_from(report.total_allocated_bytes).unwrap_or(usize::MAX))
    }

    /// Waits until all submitted work is done.
    pub(crate) fn wait(&self) {
        // A wait without a limit fails only when the device is lost, and then `lost` says so.
        let _ = self.device.poll(wgpu::PollType::Wait { submission_index: None, timeout: None });
    }
}
