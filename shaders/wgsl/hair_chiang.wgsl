// The near-field model of Chiang et al. 2016, "A practical and controllable hair and fur model for
// production path tracing", as pbrt-v4 states it: lobes R, TT, TRT and the rest. No bindings. The Rust
// twin is `hair/chiang.rs`. White hair that absorbs nothing returns all light for every offset.
//#include "common.wgsl"
//#include "hair_fibre.wgsl"

// The trimmed logistic lobe of scale s at an angle x that may be off by whole turns.
fn hair_logistic(x: f32, s: f32) -> f32 {
  let wrapped = x - 2.0 * PI * round(x * (0.5 / PI));
  let e = exp(-abs(wrapped) / s);
  let q = exp(-PI / s);
  return e * (1.0 + q) / (s * (1.0 + e) * (1.0 + e) * (1.0 - q));
}

// f cos(theta_i) for a ray that meets the hair at offset h in -1..1 of its radius.
fn hair_chiang(m: Hair, a: HairAngles, h: f32) -> vec3f {
  let cos_gamma_o = hair_cosine(h);
  let gamma_o = atan2(h, cos_gamma_o);
  let sin_gamma_t = h * a.cos_o * inverseSqrt(HAIR_ETA * HAIR_ETA - a.sin_o * a.sin_o);
  let cos_gamma_t = hair_cosine(sin_gamma_t);
  let gamma_t = atan2(sin_gamma_t, cos_gamma_t);
  let cos_theta_t = hair_cosine(a.sin_o / HAIR_ETA);
  let through = exp(m.sigma * (-2.0 * cos_gamma_t / cos_theta_t));

  let f = hair_fresnel(a.cos_o * cos_gamma_o);
  let tt = through * ((1.0 - f) * (1.0 - f));
  let trt = tt * through * f;
  let rest = trt * through * f / max(vec3f(1.0) - through * f, vec3f(1e-4));

  let phi = atan2(a.sin_phi, a.cos_phi) + 2.0 * gamma_o;
  let s = hair_logistic_scale(m.beta_n);
  // The scales lift the surface: each lobe's cone turns by a multiple of their tilt.
  let s1 = sin(m.tilt);
  let c1 = cos(m.tilt);
  let s2 = 2.0 * s1 * c1;
  let c2 = c1 * c1 - s1 * s1;
  let s4 = 2.0 * s2 * c2;
  let c4 = c2 * c2 - s2 * s2;
  let v = hair_variances(m.beta_m);
  return vec3f(m.specular * f * hair_turned(a, -s2, c2, v.x) * hair_logistic(phi, s))
    + tt * (hair_turned(a, s1, c1, v.y) * hair_logistic(phi - 2.0 * gamma_t - PI, s))
    + trt * (hair_turned(a, s4, c4, v.z) * hair_logistic(phi - 4.0 * gamma_t - 2.0 * PI, s))
    + rest * (hair_longitudinal(a.sin_i, a.cos_i, a.sin_o, a.cos_o, v.z) * (0.5 / PI));
}
