// Visibility in 32-bit words, for adapters without 64-bit atomics: one pass finds the nearest key (24 bits of depth and 8
// at random), a second walks the same way and writes the id where its key won. Of equal keys the highest id wins, whatever
// the order of threads.

//#include "splat.wgsl"

@group(3) @binding(0) var<storage, read_write> keys: array<atomic<u32>>;
@group(3) @binding(1) var<storage, read_write> ids: array<atomic<u32>>;
@group(3) @binding(2) var solid_depth: texture_depth_2d;

override naming: bool = false;

fn key(depth: f32, tag: u32) -> u32 {
  return ((bitcast<u32>(clamp(depth, 0.0, 0.999999)) << 2u) & 0xffffff00u) | (tag & 0xffu);
}

fn put(pixel: u32, depth: f32, id: u32, tag: u32) {
  // 0 is left to the solids, so that hair at the very depth of the skin is drawn as with wide words.
  let ours = key(depth, tag);
  if naming {
    if atomicLoad(&keys[pixel]) == ours { atomicMax(&ids[pixel], id); }
  } else {
    atomicMax(&keys[pixel], ours);
  }
}

@compute @workgroup_size(8, 8)
fn clear(@builtin(global_invocation_id) thread: vec3u) {
  let at = vec2u(thread.x, thread.y + S.first);
  if f32(at.x) >= F.viewport.x || f32(at.y) >= F.viewport.y { return; }
  let i = at.y * u32(F.viewport.x) + at.x;
  let depth = textureLoad(solid_depth, vec2i(at), 0);
  atomicStore(&keys[i], key(depth, 0u));
  atomicStore(&ids[i], 0u);
}

@compute @workgroup_size(64)
fn splat(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) thread: u32) {
  let l = lane(group, thread);
  if l.live { walk(l.k, l.gain); }
}
