// The stochastic line splatter: one thread a segment, work in proportion to covered area.
//
// A segment is walked along its longer screen axis. Where it covers less than a pixel, the walk jumps ahead by a geometric
// variate instead of asking every pixel; where it covers more, whole pixels are drawn across. Samples are pixel centres in
// [a, b), so neighbouring segments never draw one twice. Bent segments are drawn as several chords.
// Segments with an end nearer to the eye than NEAR are left out. A segment's random numbers hang from its place, see `seed_of`.
// Whoever includes this file gives `fn put(pixel: u32, depth: f32, id: u32, tag: u32)`; depth is reversed: larger is nearer, and
// `tag` is random, 1 to 255, the same for all of a segment.

//#include "points.wgsl"

const NEAR: f32 = 0.05;
// Pixels that a thread may draw: so many that a hair is cut thinner only where one segment fills a good part of the picture, and
// so few that no adapter stops for it (lavapipe ends a thread after 65,535 turns of its loops).
const MOST_PIXELS: u32 = 49152u;

struct End { at: vec2f, z: f32, width: f32 };

fn end(p: vec3f, r: f32, size: vec2f) -> End {
  let c = F.clip_from_world * vec4f(p, 1.0);
  let at = (vec2f(c.x, -c.y) / c.w * 0.5 + 0.5) * size;
  return End(at, c.z / c.w, 2.0 * r / (c.w * F.eye.w));
}

fn walk(k: u32, gain: f32) {
  let qa = points[k]; let qb = points[k + 1u];
  let pa = place(qa); let pb = place(qb);
  let near = min((F.clip_from_world * vec4f(pa, 1.0)).w, (F.clip_from_world * vec4f(pb, 1.0)).w);
  if near < NEAR { return; }
  let size = F.viewport.xy;
  let a = end(pa, radius(qa), size); let b = end(pb, radius(qb), size);
  // Behind an eye whose rays are parallel.
  if max(a.z, b.z) > 1.0 { return; }
  let margin = vec2f(4.0 + max(a.width, b.width));
  if any(max(a.at, b.at) < -margin) || any(min(a.at, b.at) > size + margin) { return; }
  let id = S.base + k + 1u;
  var state = hash_u(seed_of(qa, qb) + F.mode.x * 0x9E3779B9u);
  let tag = 1u + state % 255u;
  // How far the curve leaves its chord, in pixels: an eighth of the second difference.
  let s = segment(k, qa, qb);
  let bend = length(s.db - s.da) * 0.125 / (near * F.eye.w);
  let pieces = clamp(u32(sqrt(bend * 4.0)) + select(0u, 1u, bend > 0.0), 1u, 8u);
  var from_ = a;
  for (var i = 1u; i <= pieces; i++) {
    var to = b;
    if i < pieces {
      let t = f32(i) / f32(pieces);
      to = end(on_segment(s, t), mix(radius(qa), radius(qb), t), size);
    }
    state = line(from_, to, gain, size, Drawn(id, tag, MOST_PIXELS / pieces), state);
    from_ = to;
  }
}

// What a line draws, and how many pixels of it at most.
struct Drawn { id: u32, tag: u32, most: u32 };

fn line(from_: End, to: End, gain: f32, size: vec2f, drawn: Drawn, seed: u32) -> u32 {
  var a = from_; var b = to;
  var state = seed;
  let steep = abs(b.at.y - a.at.y) > abs(b.at.x - a.at.x);
  if steep { a.at = a.at.yx; b.at = b.at.yx; }
  if b.at.x < a.at.x { let swap = a; a = b; b = swap; }
  let limit = select(size, size.yx, steep);
  let d = b.at - a.at;
  if d.x < 1e-6 { return state; }
  // Pixels that a column of the walk is covered by, for one pixel of width.
  let slant = length(d) / d.x;
  let i0 = u32(clamp(ceil(a.at.x - 0.5), 0.0, limit.x));
  let i1 = u32(clamp(ceil(b.at.x - 0.5), 0.0, limit.x));
  let most = gain * F.cover.x * slant * max(a.width, b.width);
  // So little is drawn in no picture, and its logarithm is none.
  if !(most > 1e-6) { return state; }
  let sparse = most < 0.95;
  // Where 1 - most would round, two terms of the series are exact.
  let falls = select(log2(1.0 - min(most, 0.95)), -1.442695 * most * (1.0 + 0.5 * most), most < 1e-3);
  let inverse = 1.0 / falls;
  let rows = f32(max(drawn.most / max(i1 - min(i0, i1), 1u), 1u));
  var i = i0;
  loop {
    if sparse {
      state = hash_u(state);
      let jump = log2((f32(state >> 8u) + 0.5) * (1.0 / 16777216.0)) * inverse;
      if jump > f32(i1) { break; }
      i += u32(jump);
    }
    if i >= i1 { break; }
    let t = sat((f32(i) + 0.5 - a.at.x) / d.x);
    state = hash_u(state);
    let xi = f32(state >> 8u) * (1.0 / 16777216.0);
    let cover = gain * F.cover.x * slant * mix(a.width, b.width, t);
    let y = a.at.y + d.y * t;
    var across = 1u;
    if sparse { across = select(0u, 1u, xi * most < cover); } else { across = u32(min(cover + xi, rows)); }
    let depth = mix(a.z, b.z, t);
    let y0 = floor(y - 0.5 * f32(across) + 0.5);
    let end_ = u32(clamp(y0 + f32(across), 0.0, limit.y));
    for (var yy = u32(clamp(y0, 0.0, limit.y)); yy < end_; yy++) {
      let pixel = select(vec2u(i, yy), vec2u(yy, i), steep);
      put(pixel.y * u32(size.x) + pixel.x, depth, drawn.id, drawn.tag);
    }
    i += 1u;
  }
  return state;
}
