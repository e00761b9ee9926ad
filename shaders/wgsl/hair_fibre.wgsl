// What all models of a hair share: its material, the angles of a pair of directions, Fresnel's terms
// and the longitudinal lobe. No bindings. The Rust twin is `hair/fibre.rs`, where the conventions and
// the sources are. Every function is finite for every finite argument.
//#include "common.wgsl"

// Refractive index of keratin (Marschner et al. 2003).
const HAIR_ETA: f32 = 1.55;

struct Hair {
  // Absorption per radius of hair, >= 0.
  sigma: vec3f,
  // Longitudinal and azimuthal roughness, 0..1; below 0.02 they are 0.02.
  beta_m: f32,
  beta_n: f32,
  // Tilt of the cuticle's scales, radians.
  tilt: f32,
  // Gain of the first highlight; 1 is what the models say.
  specular: f32,
  // 0 Kajiya-Kay, 1 Karis, 2 Chiang.
  model: u32,
};

// A pair of directions as the hair sees it: inclinations of light (i) and viewer (o) out of the plane
// that the hair is perpendicular to, and the angle between them seen along the hair.
struct HairAngles {
  sin_i: f32,
  cos_i: f32,
  sin_o: f32,
  cos_o: f32,
  cos_phi: f32,
  sin_phi: f32,
};

// The cosine, >= 0, that goes with a sine.
fn hair_cosine(sine: f32) -> f32 {
  return sqrt(max((1.0 - sine) * (1.0 + sine), 0.0));
}

fn hair_angles(L: vec3f, V: vec3f, T: vec3f) -> HairAngles {
  let sin_i = clamp(dot(T, L), -1.0, 1.0);
  let sin_o = clamp(dot(T, V), -1.0, 1.0);
  let x = dot(L, V) - sin_i * sin_o;
  let y = dot(T, cross(V, L));
  let r = sqrt(x * x + y * y);
  // Along the hair there is no azimuth, and any will do.
  let phi = select(vec2f(1.0, 0.0), vec2f(x, y) / max(r, 1e-6), r > 1e-6);
  return HairAngles(sin_i, hair_cosine(sin_i), sin_o, hair_cosine(sin_o), phi.x, phi.y);
}

// exp(-x) I0(x) for x >= 0, I0 the modified Bessel function (Abramowitz & Stegun 9.8.1, 9.8.2).
fn hair_scaled_bessel(x: f32) -> f32 {
  if x < 3.75 {
    let t = x * x * (1.0 / 14.0625);
    let i0 = 1.0 + t * (3.5156229 + t * (3.0899424 + t * (1.2067492
      + t * (0.2659732 + t * (0.0360768 + t * 0.0045813)))));
    return i0 * exp(-x);
  }
  let t = 3.75 / x;
  let p = 0.39894228 + t * (0.01328592 + t * (0.00225319 + t * (-0.00157565 + t * (0.00916281
    + t * (-0.02057706 + t * (0.02635537 + t * (-0.01647633 + t * 0.00392377)))))));
  return p * inverseSqrt(x);
}

// The longitudinal lobe of d'Eon et al. 2011, equation 7, of variance v around the mirrored inclination.
// Its integral over sin(theta_i) is 1. Written with the half square of the distance of the two
// inclinations, which keeps all digits where the textbook form is infinity times nothing.
fn hair_longitudinal(sin_i: f32, cos_i: f32, sin_o: f32, cos_o: f32, v: f32) -> f32 {
  let apart = cos_i - cos_o;
  let across = sin_i + sin_o;
  let distance = 0.5 * (apart * apart + across * across);
  return exp(-distance / v) * hair_scaled_bessel(cos_i * cos_o / v) / (v * (1.0 - exp(-2.0 / v)));
}

// The longitudinal lobe for a viewer's cone that is turned by the angle of this sine and cosine.
fn hair_turned(a: HairAngles, sine: f32, cosine: f32, v: f32) -> f32 {
  let sin_o = a.sin_o * cosine + a.cos_o * sine;
  let cos_o = abs(a.cos_o * cosine - a.sin_o * sine);
  return hair_longitudinal(a.sin_i, a.cos_i, sin_o, cos_o, v);
}

// Variances of the lobes R, TT and TRT (Chiang et al. 2016, equation 7).
fn hair_variances(beta_m: f32) -> vec3f {
  let b = clamp(beta_m, 0.02, 1.0);
  let b5 = b * b * b * b * b;
  let b10 = b5 * b5;
  let root = 0.726 * b + 0.812 * b * b + 3.7 * b10 * b10;
  return root * root * vec3f(1.0, 0.25, 4.0);
}

// Scale of the azimuthal logistic lobe (Chiang et al. 2016, equation 8).
fn hair_logistic_scale(beta_n: f32) -> f32 {
  let b = clamp(beta_n, 0.02, 1.0);
  let b11 = b * b * b * b * b * b * b * b * b * b * b;
  return 0.62665707 * (0.265 * b + 1.194 * b * b + 5.372 * b11 * b11);
}

// Reflectance of the surface for unpolarised light that comes in at an angle of cosine c, 0..1.
fn hair_fresnel(c: f32) -> f32 {
  let cos_t = sqrt(max(1.0 - (1.0 - c * c) / (HAIR_ETA * HAIR_ETA), 0.0));
  let s = (c - HAIR_ETA * cos_t) / (c + HAIR_ETA * cos_t);
  let p = (HAIR_ETA * c - cos_t) / (HAIR_ETA * c + cos_t);
  return 0.5 * (s * s + p * p);
}

// Schlick's approximation of it, which Karis' fits were made with.
fn hair_schlick(c: f32) -> f32 {
  let x = 1.0 - sat(c);
  let x2 = x * x;
  return 0.04652057 + (1.0 - 0.04652057) * x2 * x2 * x;
}
