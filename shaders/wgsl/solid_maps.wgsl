// A head with pictures on it: its colour map by its own uvs, and its normals tilted by a normal map.
//
// Tangents are the gradients of the map's uvs on the surface, found in each pixel from its neighbours (Schueler 2013, "Normal
// mapping without precomputed tangents", GPU Pro 4): no tangents have to be there, and mirrored uvs come out right. Guaranteed: a
// tilted normal never turns from the eye what faces it. Not promised: the smooth tangents of MikkTSpace; they differ within large
// triangles.

//#include "points.wgsl"

struct Vertex {
  @location(0) p: vec3f,
  @location(1) n: vec3f,
  // Linear albedo.
  @location(2) colour: vec3f,
  // As in `solid.wgsl`.
  @location(3) material: u32,
  // In the colour map (xy) and in the normal map (zw): 0 to 1 from the left and from the top.
  @location(4) maps: vec4f,
};
struct Varying {
  @builtin(position) position: vec4f,
  @location(0) n: vec3f,
  @location(1) colour: vec3f,
  @location(2) @interpolate(flat) material: u32,
  @location(3) maps: vec4f,
  @location(4) p: vec3f,
};
// As in `solid.wgsl`.
struct Buffers {
  @location(0) normal: vec4f,
  @location(1) albedo: vec4f,
};
struct Numbers {
  colour: vec3f,
  // What is less opaque is not there.
  cutoff: f32,
  normal_scale: f32,
};
@group(1) @binding(0) var<uniform> M: Numbers;
@group(1) @binding(1) var colour_map: texture_2d<f32>;
@group(1) @binding(2) var colour_sampler: sampler;
@group(1) @binding(3) var normal_map: texture_2d<f32>;
@group(1) @binding(4) var normal_sampler: sampler;

@vertex fn seen(v: Vertex) -> Varying {
  return Varying(F.clip_from_world * vec4f(v.p, 1.0), v.n, v.colour, v.material, v.maps, v.p);
}

// The normal at `p`, tilted by what the map holds.
fn tilted(N: vec3f, p: vec3f, uv: vec2f, map: vec3f) -> vec3f {
  let px = dpdx(p); let py = dpdy(p);
  let ux = dpdx(uv); let uy = dpdy(uv);
  let across = cross(py, N); let along = cross(N, px);
  let side = sign(dot(px, across));
  let T = side * (across * ux.x + along * uy.x);
  let B = side * (across * ux.y + along * uy.y);
  let longest = max(dot(T, T), dot(B, B));
  let tilt = (map.xy * (255.0 / 127.5) - 1.0039216) * M.normal_scale;
  // Green is up, and uvs here go down. Where uvs stand still nothing is tilted.
  let out_ = (T * tilt.x - B * tilt.y) * inverseSqrt(max(longest, 1e-30)) + N * max(map.z * 2.0 - 1.0, 0.05);
  return normalize(select(N, out_, longest > 1e-30));
}

@fragment fn store(v: Varying) -> Buffers {
  let texel = textureSample(colour_map, colour_sampler, v.maps.xy);
  let N = normalize(v.n);
  let V = select(normalize(F.eye.xyz - v.p), -F.ahead.xyz, F.ahead.w == 1.0);
  var n = tilted(N, v.p, v.maps.zw, textureSample(normal_map, normal_sampler, v.maps.zw).xyz);
  // What faces the eye goes on to; the back of a sheet stays as it is.
  n = normalize(n + V * max(0.02 - dot(n, V), 0.0));
  n = select(N, n, dot(N, V) > 0.02 && M.normal_scale != 0.0);
  if texel.a < M.cutoff { discard; }
  return Buffers(vec4f(n, f32(v.material) + 1.0), vec4f(sqrt(saturate(v.colour * M.colour * texel.rgb)), 1.0));
}
