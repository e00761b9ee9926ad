// From the grid of hair and the shell of the head to the light of the surroundings: for each voxel how open it is (0..1) and
// towards where. Voxels with nothing near them are open.

//#include "points.wgsl"

@group(3) @binding(0) var<storage, read> density: array<u32>;
// 1 under the skin, else 0.
@group(3) @binding(1) var<storage, read> shell: array<u32>;
// xyz: mean open direction, not unit; w: openness.
@group(3) @binding(2) var out: texture_storage_3d<rgba16float, write>;

const UNITS: f32 = 1.0e6;
const DIRECTIONS: u32 = 12u;
const STEPS: u32 = 8u;
const STEP_GROWTH: f32 = 1.45;
// Light that meets hair is mostly scattered on: a fibre takes this much of what comes from all around.
const TAKEN: f32 = 0.35;

fn index(q: vec3i) -> i32 {
  if any(q < vec3i(0)) || any(q >= vec3i(F.grid_size.xyz)) { return -1; }
  return (q.z * i32(F.grid_size.y) + q.y) * i32(F.grid_size.x) + q.x;
}

// Fibres crossed on a cm of way: for fibres that lie all ways, pi/4 of their area a volume.
fn extinction(at: vec3f) -> f32 {
  let i = index(vec3i(floor(at)));
  if i < 0 { return 0.0; }
  let cell = F.grid.w;
  return 0.785 * TAKEN * f32(density[i]) / (UNITS * cell * cell * cell) + f32(shell[i]) * 40.0 / cell;
}

@compute @workgroup_size(4, 4, 4)
fn volume(@builtin(global_invocation_id) thread: vec3u) {
  let id = vec3u(thread.xy, thread.z + S.first);
  if any(id >= F.grid_size.xyz) || thread.z >= S.count { return; }
  let centre = vec3i(id);
  var something = false;
  for (var i = 0u; i < 27u; i++) {
    let step_ = vec3i(vec3u(i % 3u, (i / 3u) % 3u, i / 9u)) - 1;
    let near = index(centre + step_); let far = index(centre + step_ * 3);
    if near >= 0 { something = something || density[near] != 0u || shell[near] != 0u; }
    if far >= 0 { something = something || shell[far] != 0u; }
  }
  var sum = vec4f(0.0);
  if something {
    for (var i = 0u; i < DIRECTIONS; i++) {
      // Spherical Fibonacci: directions of equal share.
      let z = 1.0 - (2.0 * f32(i) + 1.0) / f32(DIRECTIONS);
      let r = sqrt(1.0 - z * z); let turn = f32(i) * 2.399963;
      let d = vec3f(r * cos(turn), z, r * sin(turn));
      var crossed = 0.0; var way = 1.0; var step_ = 1.0;
      for (var j = 0u; j < STEPS; j++) {
        crossed += extinction(vec3f(id) + 0.5 + d * way) * step_ * F.grid.w;
        way += step_; step_ *= STEP_GROWTH;
        if crossed > 8.0 { break; }
      }
      sum += vec4f(d, 1.0) * exp(-crossed);
    }
    sum /= f32(DIRECTIONS);
  } else {
    sum = vec4f(0.0, 0.0, 0.0, 1.0);
  }
  textureStore(out, id, sum);
}
