//! The block of numbers that a whole sample shares; twin of `frame.wgsl`, where each is explained.

use crate::twins::twins;

twins! { "frame":
    /// A light as shaders see it.
    struct Light {
        towards: [f32; 4],
        irradiance: [f32; 4],
        clip_from_world: [[f32; 4]; 4],
        extent: [f32; 4],
    }
    /// What a whole sample shares.
    struct Frame {
        clip_from_world: [[f32; 4]; 4],
        world_from_clip: [[f32; 4]; 4],
        eye: [f32; 4],
        ahead: [f32; 4],
        viewport: [f32; 4],
        mode: [u32; 4],
        hair: [f32; 4],
        cover: [f32; 4],
        grid: [f32; 4],
        grid_size: [u32; 4],
        roots: [f32; 4],
        roots_size: [u32; 4],
        sky: [[f32; 4]; 9],
        lights: [Light; 3],
    }
}
