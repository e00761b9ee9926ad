// Deep opacity maps (Yuksel & Keyser 2008) by computation: the depth where hair begins as a light sees it, then the
// fibres that the light crosses in four layers behind that depth. Integer atomics, so the order of threads changes nothing.
// A walk visits every `stride`-th texel and counts it `stride` times: readers blur over more than that.

//#include "points.wgsl"

// [light][y][x], five words: 1 - depth as float bits (0 where there is no hair), then the fibres in each layer alone, fixed point.
@group(3) @binding(0) var<storage, read_write> maps: array<atomic<u32>>;

override counting: bool = false;

const UNITS: f32 = 4096.0;

fn layer_of(behind: f32) -> u32 {
  return select(select(select(3u, 2u, behind < 1.6), 1u, behind < 0.5), 0u, behind < 0.12);
}

@compute @workgroup_size(64)
fn splat(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) thread: u32) {
  let l = lane(group, thread);
  if !l.live { return; }
  let light = F.lights[S.light];
  let texels = light.extent.z;
  let qa = points[l.k]; let qb = points[l.k + 1u];
  let ca = light.clip_from_world * vec4f(place(qa), 1.0);
  let cb = light.clip_from_world * vec4f(place(qb), 1.0);
  var a = vec3f((vec2f(ca.x, -ca.y) * 0.5 + 0.5) * texels, ca.z);
  var b = vec3f((vec2f(cb.x, -cb.y) * 0.5 + 0.5) * texels, cb.z);
  let steep = abs(b.y - a.y) > abs(b.x - a.x);
  if steep { a = a.yxz; b = b.yxz; }
  if b.x < a.x { let swap = a; a = b; b = swap; }
  let d = b - a;
  let texel = light.extent.x / texels;
  let stride = f32(S.stride);
  // A segment that lies along the light still shades one texel.
  let columns = max(d.x, 1.0);
  // In texels: length of the segment times its diameter, spread over the columns that are visited.
  let share = length(d.xy) / columns;
  let end_on = max(share, sat(1.0 - d.x));
  // Light passes 100 fibres as little as any more, and sums of this fit.
  let fibres = min(end_on * (radius(qa) + radius(qb)) * l.gain / texel * stride, 100.0);
  let seed = seed_of(qa, qb);
  let first = rnd(seed + S.light) * stride;
  for (var i = first; i < columns; i += stride) {
    let t = sat(i / columns);
    let at = mix(a, b, t);
    let xy = vec2i(floor(select(at.xy, at.yx, steep)));
    if any(xy < vec2i(0)) || any(xy >= vec2i(i32(texels))) { continue; }
    let k = (S.light * u32(texels) + u32(xy.y)) * u32(texels) + u32(xy.x);
    let near = bitcast<u32>(sat(1.0 - at.z));
    if counting {
      let start = 1.0 - bitcast<f32>(atomicLoad(&maps[k * 5u]));
      let behind = (at.z - start) * light.extent.y;
      atomicAdd(&maps[k * 5u + 1u + layer_of(behind)], u32(fibres * UNITS + rnd(seed + 3u + u32(i))));
    } else {
      atomicMax(&maps[k * 5u], near);
    }
  }
}
