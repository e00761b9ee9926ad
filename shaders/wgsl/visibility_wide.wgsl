// Visibility in 64-bit words: depth above, id of the point below, so that one atomic decides. The nearest wins, and of
// equals the highest id, whatever the order of threads.

//#include "splat.wgsl"

@group(3) @binding(0) var<storage, read_write> visible: array<atomic<u64>>;
@group(3) @binding(2) var solid_depth: texture_depth_2d;

fn put(pixel: u32, depth: f32, id: u32, tag: u32) {
  atomicMax(&visible[pixel], (u64(bitcast<u32>(max(depth, 0.0))) << 32u) | u64(id));
}

@compute @workgroup_size(8, 8)
fn clear(@builtin(global_invocation_id) thread: vec3u) {
  let at = vec2u(thread.x, thread.y + S.first);
  if f32(at.x) >= F.viewport.x || f32(at.y) >= F.viewport.y { return; }
  let depth = textureLoad(solid_depth, vec2i(at), 0);
  atomicStore(&visible[at.y * u32(F.viewport.x) + at.x], u64(bitcast<u32>(max(depth, 0.0))) << 32u);
}

@compute @workgroup_size(64)
fn splat(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) thread: u32) {
  let l = lane(group, thread);
  if l.live { walk(l.k, l.gain); }
}
