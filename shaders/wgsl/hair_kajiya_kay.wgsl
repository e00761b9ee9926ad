// The model of Kajiya & Kay 1989, "Rendering fur with three dimensional textures": a diffuse cylinder and
// a cone of highlight. No bindings. The Rust twin is `hair/kajiya_kay.rs`, which says where the
// constants that the paper leaves open come from.
//#include "common.wgsl"
//#include "hair_fibre.wgsl"

// Share of the light that the highlight returns at most.
const HAIR_HIGHLIGHT: f32 = 0.1;

fn hair_kajiya_kay_diffuse(colour: vec3f, a: HairAngles) -> vec3f {
  return colour * ((1.0 - HAIR_HIGHLIGHT) * a.cos_i / (PI * PI));
}

fn hair_kajiya_kay_highlight(m: Hair, a: HairAngles) -> f32 {
  let exponent = max(1.0 / hair_variances(m.beta_m).x, 1.0);
  let apart = a.cos_i - a.cos_o;
  let across = a.sin_i + a.sin_o;
  // cos(theta_i + theta_o), with all digits near 1.
  let cosine = 1.0 - 0.5 * (apart * apart + across * across);
  let lobe = exp(exponent * log(max(cosine, 1e-6)));
  return m.specular * HAIR_HIGHLIGHT * lobe * sqrt(exponent) / (2.0 * PI * sqrt(2.0 * PI));
}
