// Head, ground and tubes: rasterised to normal, albedo and depth for the camera, and to depth alone for the lights.

//#include "points.wgsl"

struct Vertex {
  @location(0) p: vec3f,
  @location(1) n: vec3f,
  // Linear albedo.
  @location(2) colour: vec3f,
  // 0 skin, 1 clay, 2 ground, 3 flat.
  @location(3) material: u32,
};
struct Varying {
  @builtin(position) position: vec4f,
  @location(0) n: vec3f,
  @location(1) colour: vec3f,
  @location(2) @interpolate(flat) material: u32,
};
struct Buffers {
  // xyz unit; w: material + 1.
  @location(0) normal: vec4f,
  // Square roots of the albedo, so that dark skins keep their steps.
  @location(1) albedo: vec4f,
};

@vertex fn seen(v: Vertex) -> Varying {
  return Varying(F.clip_from_world * vec4f(v.p, 1.0), v.n, v.colour, v.material);
}
@fragment fn store(v: Varying) -> Buffers {
  return Buffers(vec4f(normalize(v.n), f32(v.material) + 1.0), vec4f(sqrt(v.colour), 1.0));
}
@vertex fn lit(v: Vertex) -> @builtin(position) vec4f {
  return F.lights[S.light].clip_from_world * vec4f(v.p, 1.0);
}
