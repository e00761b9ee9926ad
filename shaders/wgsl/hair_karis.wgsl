// The far-field model of Karis 2016, "Physically based hair shading in Unreal" (SIGGRAPH course), from
// his fits of R, TT and TRT. No bindings. The Rust twin is `hair/karis.rs`, where it is said what is
// ours: the base colour is exp(-4 sigma), TRT is as wide as Chiang's, and each lobe is scaled to the energy of Chiang's.
//#include "common.wgsl"
//#include "hair_fibre.wgsl"

fn hair_gaussian(deviation: f32, x: f32) -> f32 {
  let z = x / deviation;
  return exp(-0.5 * z * z) / (deviation * 2.5066283);
}

// f cos(theta_i).
fn hair_karis(m: Hair, a: HairAngles, gains: vec3f) -> vec3f {
  let across = a.sin_i + a.sin_o;
  let cos_both = a.cos_i * a.cos_o;
  // Of half the difference of the inclinations, and of phi / 2.
  let cos_d = sqrt(max(0.5 + 0.5 * (cos_both + a.sin_i * a.sin_o), 1e-4));
  let cos_half = sqrt(max(0.5 + 0.5 * a.cos_phi, 0.0));
  let b = clamp(m.beta_m, 0.02, 1.0);
  let b2 = b * b;

  let s = sin(-2.0 * m.tilt);
  let c = cos(-2.0 * m.tilt);
  let shift = 2.0 * s * (c * cos_half * a.cos_o + s * a.sin_o);
  let cos_surface = sqrt(max(0.5 + 0.5 * (a.sin_i * a.sin_o + cos_both * a.cos_phi), 0.0));
  let r = gains.x * m.specular * 0.25 * cos_half * hair_schlick(cos_surface)
    * hair_gaussian(b2 * 1.41421356 * max(cos_half, 0.05), across - shift);

  let ratio = 1.0 / (1.19 / cos_d + 0.36 * cos_d);
  let h = cos_half * (1.0 + ratio * (0.6 - 0.8 * a.cos_phi));
  let enters = 1.0 - hair_schlick(cos_d * hair_cosine(min(h, 1.0)));
  let length = 2.0 * hair_cosine(min(h * ratio, 1.0)) / cos_d;
  let tt = gains.y * exp(-3.65 * a.cos_phi - 3.98) * enters * enters
    * hair_gaussian(0.5 * b2, across - m.tilt);

  let f = hair_schlick(0.5 * cos_d);
  let trt = gains.z * exp(17.0 * a.cos_phi - 16.78) * (1.0 - f) * (1.0 - f) * f
    * hair_turned(a, -sin(4.0 * m.tilt), cos(4.0 * m.tilt), hair_variances(m.beta_m).z);

  return vec3f(r) + tt * exp(m.sigma * -length) + trt * exp(m.sigma * (-3.2 / cos_d));
}
