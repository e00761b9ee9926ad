// Deferred shading: every pixel once a sample, whatever it shows (hair, a solid or the backdrop), into the accumulator.
//
// A dispatch shades the pixels whose hair lies in its chunk; the first chunk's also shades those without hair.

//#include "points.wgsl"
//#include "environment.wgsl"
//#include "hair.wgsl"
//#include "skin.wgsl"

@group(1) @binding(4) var openness: texture_3d<f32>;
@group(1) @binding(5) var<storage, read> maps: array<u32>;
@group(1) @binding(6) var solid_from_light: texture_depth_2d_array;
@group(1) @binding(7) var solid_normal: texture_2d<f32>;
@group(1) @binding(8) var solid_albedo: texture_2d<f32>;
@group(1) @binding(9) var solid_depth: texture_depth_2d;

// Ids of what each pixel shows: the low words of wide visibility, or the ids of the narrow.
@group(3) @binding(0) var<storage, read> shown: array<u32>;
// Linear rgb and coverage, summed over samples.
@group(3) @binding(1) var<storage, read_write> sums: array<vec4f>;

// Which tiles of 8 x 8 pixels hold hair, which a solid and no hair, which neither: the workgroups of the dispatch of each
// (the first number is how many tiles, then 1, 1, 0), and their corners in eighths, 256 a row, 256 rows for each of the three.
// Software adapters run all of a shader for every pixel whatever it shows, so that tiles are shaded by what they hold.
@group(3) @binding(2) var<storage, read_write> tiles: array<atomic<u32>>;
@group(3) @binding(3) var corners: texture_storage_2d<r32uint, write>;
@group(3) @binding(2) var listed: texture_2d<u32>;
// What the tiles of this build hold at most: 0 hair, 1 solids, 2 the backdrop.
const HOLDS: u32 = 0u;

// What this build of the shader shades, so that each is compiled without the others: the model (0 Kajiya-Kay, 1 Karis,
// 2 Chiang), and whether paint is a view's colours. `pipelines.rs` sets both.
const MODEL: u32 = 1u;
const COLOURS: bool = false;

// Ends of the first three layers of the opacity maps, cm: those of `opacity.wgsl`.
const ENDS: vec3f = vec3f(0.12, 0.5, 1.6);
const LAST: f32 = 6.0;

// Fibres that stand between a light behind a lock and its near side: less and dark hair glows orange at every edge, more and
// fair hair loses its rim.
const LOCK: f32 = 2.5;

struct Shadow {
  // Fibres between the light and the point, and how much of the light passes the solids.
  fibres: f32,
  passed: f32,
  // How much passes hair that lets nothing through.
  clear_: f32,
};

// What lies between a point and a light: the opacity map, blurred over the light's own softness. `bias` in cm.
fn shadow(number: u32, p: vec3f, bias: f32, seed: u32) -> Shadow {
  let light = F.lights[number];
  let c = light.clip_from_world * vec4f(p, 1.0);
  let texels = light.extent.z;
  let at = (vec2f(c.x, -c.y) * 0.5 + 0.5) * texels;
  if any(at < vec2f(0.0)) || any(at >= vec2f(texels)) { return Shadow(0.0, 1.0, 1.0); }
  // Shadows fade towards the border of the map, so that none ends in a line.
  let border = min(at, texels - at) * (10.0 / texels);
  let inside = sat(min(border.x, border.y));
  let reach = light.irradiance.w / light.extent.x * texels;
  let solid_texels = f32(textureDimensions(solid_from_light).x);
  let turn = rnd(seed) * 6.2831853;
  let taps = F.mode.y;
  var sum = Shadow(0.0, 0.0, 0.0);
  for (var i = 0u; i < taps; i++) {
    let angle = turn + f32(i) * 2.399963;
    let r = reach * sqrt((f32(i) + rnd(seed + i + 1u)) / f32(taps));
    let tap = clamp(at + r * vec2f(cos(angle), sin(angle)), vec2f(0.0), vec2f(texels - 1.0));
    let q = vec2u(tap);
    let k = ((number * u32(texels) + q.y) * u32(texels) + q.x) * 5u;
    let near = maps[k];
    var fibres = 0.0;
    if near != 0u {
      let behind = (c.z - (1.0 - bitcast<f32>(near))) * light.extent.y - bias;
      if behind > 0.0 {
        // Layers hold what lies in them alone; within one it is spread evenly.
        let v = vec4f(vec4u(maps[k + 1u], maps[k + 2u], maps[k + 3u], maps[k + 4u])) * (1.0 / 4096.0);
        fibres = v.x * sat(behind / ENDS.x) + v.y * sat((behind - ENDS.x) / (ENDS.y - ENDS.x))
          + v.z * sat((behind - ENDS.y) / (ENDS.z - ENDS.y)) + v.w * sat((behind - ENDS.z) / (LAST - ENDS.z));
      }
    }
    let solid = textureLoad(solid_from_light, vec2i(tap / texels * solid_texels), number, 0);
    let passed = select(0.0, 1.0, (c.z - solid) * light.extent.y < 0.15 + bias);
    sum.fibres += fibres; sum.passed += passed; sum.clear_ += passed * exp(-fibres);
  }
  let share = inside / f32(taps);
  return Shadow(sum.fibres * share, 1.0 - inside + sum.passed * share, 1.0 - inside + sum.clear_ * share);
}

// xyz: towards the open (unit), w: how open. Read somewhere within a voxel and a half, so that over the samples voxels do not show.
fn open_at(p: vec3f, otherwise: vec3f, seed: u32) -> vec4f {
  let shake = (vec3f(rnd(seed + 91u), rnd(seed + 92u), rnd(seed + 93u)) - 0.5) * 3.0;
  let uvw = ((p - F.grid.xyz) / F.grid.w + shake) / vec3f(F.grid_size.xyz);
  let v = textureSampleLevel(openness, root_sampler, uvw, 0.0);
  // Towards the grid's border what it holds fades to open, so that no edge shows.
  let deep = min(uvw, 1.0 - uvw) * 8.0;
  let inside = sat(min(deep.x, min(deep.y, deep.z)));
  let to = v.xyz * inside + otherwise * 0.05;
  return vec4f(to / max(length(to), 1e-6), mix(1.0, v.w, inside));
}

fn unpack_absorption(word: u32) -> vec3f {
  let s = vec3f(vec3u(word & 0x7ffu, (word >> 11u) & 0x7ffu, word >> 22u)) * (4.5 / vec3f(2047.0, 2047.0, 1023.0));
  return s * s;
}
fn unpack_colour(word: u32) -> vec3f {
  let s = vec3f(vec3u(word & 0xffu, (word >> 8u) & 0xffu, (word >> 16u) & 0xffu)) * (1.0 / 255.0);
  return s * s;
}

// Hair in colours of a view: the same light and shadow on all, so that form reads whatever the pigment.
fn groom(base: vec3f, p: vec3f, T: vec3f, V: vec3f, seed: u32) -> vec3f {
  var c = vec3f(0.0);
  for (var i = 0u; i < 3u; i++) {
    let light = F.lights[i];
    if light.towards.w == 0.0 { continue; }
    let L = light.towards.xyz;
    let s = shadow(i, p, 0.0, seed + i * 8u);
    let across = sqrt(max(1.0 - dot(T, L) * dot(T, L), 0.0));
    let H = normalize(L + V);
    let th = dot(T, H);
    let shine = 0.06 * pow(max(1.0 - th * th, 0.0), 40.0);
    let lit = s.passed * exp(-0.45 * s.fibres);
    c += lit * light.irradiance.rgb * (base * across * 0.8 / PI + shine * 0.5 / PI);
  }
  let out_ = normalize(V - T * dot(V, T) + vec3f(1e-6));
  let o = open_at(p, out_, seed);
  return c + base * sky(o.xyz, vec2f(0.667, 0.25)) * o.w;
}

fn pigmented(sigma: vec3f, p: vec3f, T: vec3f, V: vec3f, seed: u32) -> vec3f {
  let m = Hair(sigma, F.hair.x, F.hair.y, F.hair.z, F.hair.w, MODEL);
  let xi = rnd(seed + 77u);
  var c = vec3f(0.0);
  for (var i = 0u; i < 3u; i++) {
    let light = F.lights[i];
    if light.towards.w == 0.0 { continue; }
    let s = shadow(i, p, 0.0, seed + i * 8u);
    if s.passed == 0.0 { continue; }
    let L = light.towards.xyz;
    // A hair that is seen lies on the near side of its lock, and light from behind has crossed the rest of the lock, of which a
    // texel of the map knows nothing.
    let cos_phi = dot(normalize(L - T * dot(T, L) + vec3f(1e-6)), normalize(V - T * dot(V, T) + vec3f(1e-6)));
    let fibres = s.fibres + LOCK * sat(-cos_phi);
    c += s.passed * light.irradiance.rgb * hair_light(m, L, V, T, fibres, xi);
  }
  let out_ = normalize(V - T * dot(V, T) + vec3f(1e-6));
  let o = open_at(p, out_, seed);
  return c + hair_sky(m, V, T, o.xyz, o.w, xi);
}

fn hair(k: u32, at: vec2f, seed: u32) -> vec3f {
  let qa = points[k]; let qb = points[k + 1u];
  let s = segment(k, qa, qb);
  let ca = F.clip_from_world * vec4f(s.a, 1.0); let cb = F.clip_from_world * vec4f(s.b, 1.0);
  let a = (vec2f(ca.x, -ca.y) / ca.w * 0.5 + 0.5) * F.viewport.xy;
  let b = (vec2f(cb.x, -cb.y) / cb.w * 0.5 + 0.5) * F.viewport.xy;
  let d = b - a;
  let t = sat(dot(at - a, d) / max(dot(d, d), 1e-6));
  let p = on_segment(s, t);
  let T = tangent(s, t);
  let V = select(normalize(F.eye.xyz - p), -F.ahead.xyz, F.ahead.w == 1.0);
  if COLOURS { return groom(mix(unpack_colour(paint[k]), unpack_colour(paint[k + 1u]), t), p, T, V, seed); }
  return pigmented(mix(unpack_absorption(paint[k]), unpack_absorption(paint[k + 1u]), t), p, T, V, seed);
}

fn solid(pixel: vec2u, depth: f32, behind: vec3f, seed: u32) -> vec3f {
  let n = textureLoad(solid_normal, vec2i(pixel), 0);
  let root = textureLoad(solid_albedo, vec2i(pixel), 0).rgb;
  let material = u32(n.w + 0.5) - 1u;
  let ndc = vec2f((f32(pixel.x) + 0.5) * F.viewport.z, (f32(pixel.y) + 0.5) * F.viewport.w) * vec2f(2.0, -2.0) + vec2f(-1.0, 1.0);
  let w = F.world_from_clip * vec4f(ndc, depth, 1.0);
  let p = w.xyz / w.w;
  let V = select(normalize(F.eye.xyz - p), -F.ahead.xyz, F.ahead.w == 1.0);
  // The far side of a thin sheet is seen as its near side.
  let N = normalize(n.xyz) * select(-1.0, 1.0, dot(n.xyz, V) > -0.2);
  var albedo = root * root;
  if material == 3u { return albedo; }
  if material == 0u { albedo = scalp_tint(p, albedo); }
  let o = open_at(p + N * F.grid.w * 2.0, N, seed);
  var c = vec3f(0.0);
  // What the ground would get without hair and head, so that it only darkens the backdrop.
  var whole = vec3f(0.0);
  for (var i = 0u; i < 3u; i++) {
    let light = F.lights[i];
    if light.towards.w == 0.0 { continue; }
    let s = shadow(i, p + N * 0.05, 0.06, seed + i * 8u);
    let E = light.irradiance.rgb;
    if material == 2u {
      let nl = max(dot(N, light.towards.xyz), 0.0);
      c += E * nl * s.clear_; whole += E * nl;
    } else {
      c += E * s.clear_ * skin_light(albedo, N, V, light.towards.xyz);
    }
  }
  if material == 2u {
    let above = sky(N, vec2f(0.667, 0.25)) * PI;
    // The disc ends softly: its albedo holds how much of it is there.
    return behind * mix(vec3f(1.0), (c + above * o.w) / max(whole + above, vec3f(1e-4)), albedo.r);
  }
  return c + skin_sky(albedo, N, V, o.w);
}

// Sorts the tiles of the rows from `S.first` on.
@compute @workgroup_size(64)
fn sort(@builtin(global_invocation_id) thread: vec3u) {
  let across = (u32(F.viewport.x) + 7u) / 8u;
  let all = across * ((S.count + 7u) / 8u);
  if thread.x >= all { return; }
  let corner = vec2u(thread.x % across, thread.x / across) * 8u + vec2u(0u, S.first);
  var holds = 2u;
  for (var k = 0u; k < 64u; k++) {
    let pixel = corner + vec2u(k % 8u, k / 8u);
    if pixel.x >= u32(F.viewport.x) || pixel.y >= u32(F.viewport.y) { continue; }
    let id = shown[(pixel.y * u32(F.viewport.x) + pixel.x) * S.words];
    if id != 0u { holds = 0u; }
    else if textureLoad(solid_depth, vec2i(pixel), 0) > 0.0 { holds = min(holds, 1u); }
  }
  let place = atomicAdd(&tiles[holds * 4u], 1u);
  let at = vec2u(place % 256u, place / 256u + holds * 256u);
  textureStore(corners, at, vec4u(corner.x / 8u | (corner.y / 8u << 16u), 0u, 0u, 0u));
}

@compute @workgroup_size(8, 8)
fn shade(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_id) thread: vec3u) {
  let entry = vec2u(group.x % 256u, group.x / 256u + HOLDS * 256u);
  let corner = textureLoad(listed, entry, 0).r;
  let pixel = vec2u(corner & 0xffffu, corner >> 16u) * 8u + thread.xy;
  if f32(pixel.x) >= F.viewport.x || f32(pixel.y) >= F.viewport.y || pixel.y >= S.first + S.count { return; }
  let i = pixel.y * u32(F.viewport.x) + pixel.x;
  let id = shown[i * S.words];
  let seed = hash_u(i * 31u + hash_u(F.mode.x * 0x9E3779B9u + 1u));
  let at = vec2f(pixel) + 0.5;
  var c: vec4f;
  if id == 0u || HOLDS > 0u {
    if S.base != 0u { return; }
    let ndc = at * F.viewport.zw * vec2f(2.0, -2.0) + vec2f(-1.0, 1.0);
    let far = F.world_from_clip * vec4f(ndc, 1e-5, 1.0);
    let ray = select(normalize(far.xyz / far.w - F.eye.xyz), F.ahead.xyz, F.ahead.w == 1.0);
    let behind = backdrop(ndc, ray);
    let depth = textureLoad(solid_depth, vec2i(pixel), 0);
    c = vec4f(behind, 0.0);
    if HOLDS < 2u && depth > 0.0 { c = vec4f(solid(pixel, depth, behind, seed), 1.0); }
  } else {
    if id <= S.base || id > S.base + S.points { return; }
    c = vec4f(hair(id - S.base - 1u, at, seed), 1.0);
  }
  // A sample that is no number would stay in the sum for ever. By its bits, for compilers take it that there are none.
  let none = (bitcast<vec4u>(c) & vec4u(0x7f800000u)) == vec4u(0x7f800000u);
  c = vec4f(clamp(select(c.rgb, vec3f(0.0), none.rgb), vec3f(-1e4), vec3f(1e4)), c.a);
  sums[i] = select(sums[i], vec4f(0.0), F.mode.x == 0u) + c;
}
