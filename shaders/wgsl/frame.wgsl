// What a whole sample shares: camera, lights, grids and the hair's material. The Rust twin is `frame.rs`.

struct Light {
  // Unit, towards the light; w: 1 where it owns a deep opacity map, 2 where it is only in the voxels, 0: off.
  towards: vec4f,
  // Irradiance on a surface that faces it; w: radius in cm that its opacity map is blurred over.
  irradiance: vec4f,
  // Orthographic; depth 0 at the near end and 1 at the far end.
  clip_from_world: mat4x4f,
  // Width in cm of the map, depth in cm from near to far, texels across, 0.
  extent: vec4f,
};

struct Frame {
  clip_from_world: mat4x4f,
  world_from_clip: mat4x4f,
  // w: cm a pixel covers at one unit of clip w.
  eye: vec4f,
  // Unit, from the eye into the picture; w: 1 for an orthographic camera.
  ahead: vec4f,
  // Width, height and their inverses, pixels.
  viewport: vec4f,
  // Sample number from 0, places that a look at a shadow map reads, 0, kind of backdrop.
  mode: vec4u,
  // beta_m, beta_n, cuticle tilt in radians, gain of the first highlight.
  hair: vec4f,
  // See-through factor of coverage, 0, strength of the scalp tint, 0.
  cover: vec4f,
  // Lower corner of the voxel grid, w: size of a voxel, cm.
  grid: vec4f,
  // Voxels along x, y, z; w: 1 where there is hair.
  grid_size: vec4u,
  // Lower corner of the grid of roots, w: size of a cell, cm.
  roots: vec4f,
  // Cells along x, y, z; w: 0 where there are none.
  roots_size: vec4u,
  // Spherical harmonics (band 0 to 2) of the environment's radiance.
  sky: array<vec4f, 9>,
  lights: array<Light, 3>,
};

// In a storage buffer: lavapipe (Mesa 22.3) compiles a shader again at every dispatch when uniforms decide its branches, which
// cost 31 ms and 2 MiB each.
@group(0) @binding(0) var<storage, read> F: Frame;
