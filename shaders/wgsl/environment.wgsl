// Light from all around: the sky as spherical harmonics, and the backdrop behind the subject.
//
// Radiance is linear Rec.709. `environment.rs` fills the numbers and has `sky` as its twin. The sky is
// smooth: what is narrower than about 60 degrees is not in it (band 2), it belongs to the lights.
//#include "common.wgsl"
//#include "frame.wgsl"

// One texel for a plain backdrop, two for a sweep (middle, edge), else a map of all directions.
@group(1) @binding(1) var backdrop_map: texture_2d<f32>;

// Radiance from around n (unit), blurred by a lobe whose bands 1 and 2 are weighted by `spread`:
// (1, 1) as it is, (2/3, 1/4) the cosine lobe, so that irradiance is PI times this
// (Ramamoorthi & Hanrahan 2001, "An efficient representation for irradiance environment maps").
fn sky(n: vec3f, spread: vec2f) -> vec3f {
  var c = F.sky[0].rgb * 0.282095;
  c += spread.x * 0.488603 * (F.sky[1].rgb * n.y + F.sky[2].rgb * n.z + F.sky[3].rgb * n.x);
  c += spread.y * (
    1.092548 * (F.sky[4].rgb * n.x * n.y + F.sky[5].rgb * n.y * n.z + F.sky[7].rgb * n.x * n.z)
    + 0.315392 * F.sky[6].rgb * (3.0 * n.z * n.z - 1.0)
    + 0.546274 * F.sky[8].rgb * (n.x * n.x - n.y * n.y));
  return max(c, vec3f(0.0));
}

// What is seen where there is nothing: uv -1 to 1 from edge to edge of the picture, y up; `ray` unit,
// from the eye.
fn backdrop(uv: vec2f, ray: vec3f) -> vec3f {
  if F.mode.w == 0u {
    // A studio sweep: a lit pool on the wall behind the subject, darker towards the corners.
    let r = length((uv - vec2f(0.15, 0.1)) * vec2f(0.8, 1.0));
    let middle = textureLoad(backdrop_map, vec2u(0u, 0u), 0).rgb;
    let edge = textureLoad(backdrop_map, vec2u(1u, 0u), 0).rgb;
    return mix(middle, edge, smoothstep(0.0, 1.35, r));
  }
  if F.mode.w == 1u {
    return textureLoad(backdrop_map, vec2u(0u, 0u), 0).rgb;
  }
  // Equirectangular: the middle column looks along -Z, columns go on to the right, the top row is up.
  let size = vec2i(textureDimensions(backdrop_map));
  let u = atan2(ray.x, -ray.z) / (2.0 * PI) + 0.5;
  let v = acos(clamp(ray.y, -1.0, 1.0)) / PI;
  let at = vec2f(u, v) * vec2f(size) - 0.5;
  let low = vec2i(floor(at));
  let part = at - floor(at);
  var c = vec3f(0.0);
  for (var k = 0; k < 4; k++) {
    let step = vec2i(k & 1, k >> 1u);
    let column = (low.x + step.x + size.x) % size.x;
    let row = clamp(low.y + step.y, 0, size.y - 1);
    let weight = mix(1.0 - part, part, vec2f(step));
    c += weight.x * weight.y * textureLoad(backdrop_map, vec2i(column, row), 0).rgb;
  }
  return c;
}
