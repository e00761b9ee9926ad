// Hair into a grid of voxels: for each, the summed length times diameter of hair in it (cm2, fixed point). Integer sums, so
// the order of threads changes nothing.

//#include "points.wgsl"

@group(3) @binding(0) var<storage, read_write> density: array<atomic<u32>>;

// Units a cm2. A voxel of 0.3 cm holds at most about 0.5 cm2 of hair; a tangle of 4,000 times that still fits. One segment adds
// no more than makes a voxel black, so that what is as wide as a rope fits too.
const UNITS: f32 = 1.0e6;

@compute @workgroup_size(64)
fn splat(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) thread: u32) {
  let l = lane(group, thread);
  if !l.live { return; }
  let qa = points[l.k]; let qb = points[l.k + 1u];
  let a = place(qa); let b = place(qb);
  let size = length(b - a);
  let n = clamp(u32(size / F.grid.w) + 1u, 1u, 8u);
  let area = min(size / f32(n) * (radius(qa) + radius(qb)) * l.gain, 32.0 * F.grid.w * F.grid.w);
  let seed = seed_of(qa, qb);
  for (var i = 0u; i < n; i++) {
    let t = (f32(i) + rnd(seed + i)) / f32(n);
    let q = vec3i(floor((mix(a, b, t) - F.grid.xyz) / F.grid.w));
    if any(q < vec3i(0)) || any(q >= vec3i(F.grid_size.xyz)) { continue; }
    let u = vec3u(q);
    atomicAdd(&density[(u.z * F.grid_size.y + u.y) * F.grid_size.x + u.x], u32(area * UNITS));
  }
}
