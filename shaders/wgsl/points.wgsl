// Strands as they lie in memory: points of all curves, one after the other, and the blocks of them that are drawn.
// A chunk is one binding of at most 128 MiB; ids of points are counted over all chunks.

//#include "common.wgsl"
//#include "frame.wgsl"

// What one dispatch works on. The Rust twin is `Slice` in `strands.rs`.
struct Slice {
  // First block (or row of pixels) and how many.
  first: u32,
  count: u32,
  // Id of the chunk's first point, less one; and how many points it has.
  base: u32,
  points: u32,
  // Light, texels that a walk advances by, workgroups along x.
  light: u32,
  stride: u32,
  groups: u32,
  // Words from one pixel to the next in what shows ids.
  words: u32,
};
@group(0) @binding(1) var<uniform> S: Slice;

// xyz in cm; w: radius in cm as f16 (low half), 15 bits of u, and the highest bit on a curve's last point.
@group(2) @binding(0) var<storage, read> points: array<vec4u>;
// What a point's colour is made of: see `view.rs`.
@group(2) @binding(1) var<storage, read> paint: array<u32>;
// First point, points (at most 64), what widths are multiplied by to stand for strands that are not drawn (f32), 0.
@group(2) @binding(2) var<storage, read> blocks: array<vec4u>;

struct Lane {
  // The point that a thread starts its segment at.
  k: u32,
  gain: f32,
  live: bool,
};

// The thread's point: one workgroup of 64 a block.
fn lane(group: vec3u, thread: u32) -> Lane {
  let number = group.x + group.y * S.groups;
  if number >= S.count { return Lane(0u, 0.0, false); }
  let block = blocks[S.first + number];
  let k = block.x + thread;
  return Lane(k, bitcast<f32>(block.z), thread < block.y && (points[k].w >> 31u) == 0u);
}

fn place(q: vec4u) -> vec3f { return bitcast<vec3f>(q.xyz); }
fn radius(q: vec4u) -> f32 { return unpack2x16float(q.w & 0xffffu).x; }
fn along(q: vec4u) -> f32 { return f32((q.w >> 16u) & 0x7fffu) * (1.0 / 32767.0); }
fn is_root(q: vec4u) -> bool { return (q.w & 0x7fff0000u) == 0u; }
fn is_last(q: vec4u) -> bool { return (q.w >> 31u) == 1u; }

// What a segment's random numbers start from: where it lies in space, and not where it lies in memory, so that a picture does
// not depend on what was uploaded before. Two segments at the very same place draw the very same pixels.
fn seed_of(qa: vec4u, qb: vec4u) -> u32 {
  let far = qb.x ^ ((qb.y << 11u) | (qb.y >> 21u)) ^ ((qb.z << 22u) | (qb.z >> 10u));
  return hash_u(qa.x + hash_u(qa.y + hash_u(qa.z + hash_u(far))));
}

// Cubic through the ends of a segment whose tangents are differences by arc length, so that uneven CVs do not swing out.
struct Segment {
  a: vec3f,
  b: vec3f,
  // Derivatives at the ends, cm for the whole segment.
  da: vec3f,
  db: vec3f,
};

fn segment(k: u32, qa: vec4u, qb: vec4u) -> Segment {
  let a = place(qa); let b = place(qb);
  let ab = b - a; let l = length(ab);
  var da = ab; var db = ab;
  if !is_root(qa) {
    let before = a - place(points[k - 1u]);
    da = (before + ab) * (l / max(l + length(before), 1e-9));
  }
  if !is_last(qb) {
    let after = place(points[k + 2u]) - b;
    db = (ab + after) * (l / max(l + length(after), 1e-9));
  }
  return Segment(a, b, da, db);
}
fn on_segment(s: Segment, t: f32) -> vec3f {
  let v = 1.0 - t;
  return v * v * (1.0 + 2.0 * t) * s.a + v * v * t * s.da - t * t * v * s.db + t * t * (1.0 + 2.0 * v) * s.b;
}
fn tangent(s: Segment, t: f32) -> vec3f {
  let v = 1.0 - t;
  let d = 6.0 * t * v * (s.b - s.a) + v * (1.0 - 3.0 * t) * s.da + t * (3.0 * t - 2.0) * s.db;
  let l = length(d);
  if l > 1e-12 { return d / l; }
  return vec3f(0.0, 1.0, 0.0);
}
