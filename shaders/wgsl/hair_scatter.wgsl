// Light that meets many hairs, by dual scattering (Zinke et al. 2008) summed over all bounces. The Rust
// twin is `hair/scatter.rs`, which bakes the table and says what is the paper's and what is ours.
//#include "common.wgsl"
//#include "hair_fibre.wgsl"

// 16 rows by cos(theta_o) of 64 values by absorption: share of light sent forward, share sent back,
// variances of their inclinations (forward, back). Then 16 values for viewers on the tip's side and 16 for
// the root's: what Karis' lobes R, TT, TRT are scaled by, and the share that the surface reflects.
@group(1) @binding(0) var<storage, read> scatter_table: array<vec4f>;

// What one hair does to light on average, by channel.
struct Scatter {
  forward: vec3f,
  back: vec3f,
  v_forward: f32,
  v_back: f32,
  gains: vec3f,
  surface: f32,
  // Loss per hair crossed, and what many hairs return of light that falls on them.
  loss: vec3f,
  deep: vec3f,
};

fn scatter_channel(low: u32, part: f32, k: f32) -> vec4f {
  let left = min(u32(k), 62u);
  let along = k - f32(left);
  let at = low * 64u + left;
  let a = mix(scatter_table[at], scatter_table[at + 1u], along);
  let b = mix(scatter_table[at + 64u], scatter_table[at + 65u], along);
  return mix(a, b, part);
}

fn hair_scatter(sigma: vec3f, sin_o: f32) -> Scatter {
  let row = hair_cosine(sin_o) * 15.0;
  let low = min(u32(row), 14u);
  let part = row - f32(low);
  // sigma = 0.01 (2^(k / 5.74) - 1).
  let k = min(5.74 * log2(1.0 + max(sigma, vec3f(0.0)) * 100.0), vec3f(63.0));
  let r = scatter_channel(low, part, k.x);
  let g = scatter_channel(low, part, k.y);
  let b = scatter_channel(low, part, k.z);
  let side = low + select(1024u, 1040u, sin_o < 0.0);
  let gains = mix(scatter_table[side], scatter_table[side + 1u], part);
  let v = (r.zw + g.zw + b.zw) * (1.0 / 3.0);
  let forward = vec3f(r.x, g.x, b.x);
  let back = vec3f(r.y, g.y, b.y);
  let kept = vec3f(1.0) - forward;
  let loss = sqrt(max(kept * kept - back * back, vec3f(0.0)));
  let deep = back / max(kept + loss, vec3f(1e-4));
  return Scatter(forward, back, v.x, v.y, gains.xyz, gains.w, loss, deep);
}

// Share of light that reaches a hair behind `fibres` others, whether it met them or not.
fn scatter_reaches(hairs: Scatter, fibres: f32) -> vec3f {
  let sideways = fibres * (1.0 / 12.0);
  return max(exp(hairs.loss * -fibres) / (1.0 + sideways * sideways), vec3f(exp(-fibres)));
}

// Light that met other hairs first: f cos(theta_i) summed with what reached the hair.
fn scatter_many(hairs: Scatter, a: HairAngles, fibres: f32) -> vec3f {
  let direct = exp(-fibres);
  let reached = scatter_reaches(hairs, fibres);
  let s = 0.5 - 0.5 * a.cos_phi;
  let far = s * s * (3.0 - 2.0 * s);

  // Through the hairs in front. At least one was crossed; on average this many.
  let crossed = select(1.0, fibres / max(1.0 - direct, 1e-4), fibres > 0.01);
  let v1 = mix(hairs.v_back, hairs.v_forward, far) + crossed * hairs.v_forward;
  let along1 = hair_longitudinal(a.sin_i, a.cos_i, a.sin_o, a.cos_o, min(v1, 2.0));
  let through = (reached - vec3f(direct)) * mix(hairs.back, hairs.forward, far) * (along1 / PI);

  // From the hairs behind, which are those away from the viewer. The light that they had is the light on
  // the viewer's side: a soft cosine whose integral over phi is pi.
  let f = (hairs.forward.x + hairs.forward.y + hairs.forward.z) * (1.0 / 3.0);
  let b = (hairs.back.x + hairs.back.y + hairs.back.z) * (1.0 / 3.0);
  let b3 = b * b * b;
  let width = (1.0 + 0.7 * f * f)
    * (b * sqrt(2.0 * hairs.v_forward + hairs.v_back) + b3 * sqrt(2.0 * hairs.v_forward + 3.0 * hairs.v_back))
    / max(b + b3 * (2.0 * sqrt(hairs.v_forward) + 3.0 * sqrt(hairs.v_back)), 1e-6);
  let v2 = clamp(width * width + (crossed - 1.0) * hairs.v_forward, 1e-3, 2.0);
  let along2 = hair_longitudinal(a.sin_i, a.cos_i, a.sin_o, a.cos_o, v2);
  let near = 1.0 - s;
  let behind = reached * hairs.deep * hairs.forward * (along2 * 1.6 / PI * near * near * near);
  return through + behind;
}
