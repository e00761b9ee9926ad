// The model of Kajiya & Kay 1989, "Rendering fur with three dimensional textures": a diffuse cylinder and
// a cone of highlight. No bindings. The Rust twin is `hair/kajiya_kay.rs`, which says where the
// constants that the paper leaves open come from.
//#include "common.wgsl"
//#include "hair_fibre.wgsl"

// Share of the light that the highlight returns at most.
const HAIR_HIGHLIGHT: f32 = 0.07;

// The colour of many hairs without what their surfaces reflect, which is the highlight's.
fn hair_kajiya_kay_colour(deep: vec3f, surface: f32) -> vec3f {
  let shine = 0.2 * surface;
  return max(deep - vec3f(shine), vec3f(0.0)) / (1.0 - shine);
}

fn hair_kajiya_kay_diffuse(colour: vec3f, a: HairAngles) -> vec3f {
  return colour * ((1.0 - HAIR_HIGHLIGHT) * a.cos_i / (PI * PI));
}

fn hair_kajiya_kay_highlight(m: Hair, a: HairAngles) -> f32 {
  let b = clamp(m.beta_m, 0.1, 0.84);
  let exponent = 0.5 / (b * b * b * b);
  let apart = a.cos_i - a.cos_o;
  let across = a.sin_i + a.sin_o;
  // cos(theta_i + theta_o), with all digits near 1.
  let cosine = 1.0 - 0.5 * (apart * apart + across * across);
  let lobe = exp(exponent * log(max(cosine, 1e-6)));
  return m.specular * HAIR_HIGHLIGHT * lobe * sqrt(exponent) / (2.0 * PI * sqrt(2.0 * PI));
}
