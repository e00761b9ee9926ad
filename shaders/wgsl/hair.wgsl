// What hair sends to the viewer: of a light (`hair_light`) and of the sky (`hair_sky`), by one of three
// models. The Rust twins are in `hair/mod.rs`. A deep layer of white hair returns the light of an even
// sky within 3 per cent (Karis, Chiang) and none returns more (tests); every result is finite and >= 0. Not
// known here: whether hairs lie behind the one that is seen. They always do, so that a lone hair far from
// its head is brighter than it should be.
//
// A hair that is seen gets light that met no hair (the model of one hair), light that came through the
// hairs in front and light that the hairs behind send back (`hair_scatter.wgsl`, equal for Karis and
// Chiang). Kajiya-Kay keeps its own diffuse term for all three.
//#include "common.wgsl"
//#include "environment.wgsl"
//#include "hair_fibre.wgsl"
//#include "hair_chiang.wgsl"
//#include "hair_karis.wgsl"
//#include "hair_kajiya_kay.wgsl"
//#include "hair_scatter.wgsl"

// Radiance towards V for a distant light of irradiance 1 on a surface that faces it. L, V, T unit: to the
// light, to the viewer, along the hair to its tip. `fibres`, >= 0: hairs between light and hair, on
// average. `xi` in 0..1: where across the hair the ray meets it; only Chiang asks.
fn hair_light(m: Hair, L: vec3f, V: vec3f, T: vec3f, fibres: f32, xi: f32) -> vec3f {
  let a = hair_angles(L, V, T);
  let n = max(fibres, 0.0);
  let hairs = hair_scatter(m.sigma, a.sin_o);
  let direct = exp(-n);
  if m.model == 0u {
    // The hairs behind have this colour too and light this one from there.
    let near = 0.5 + 0.5 * a.cos_phi;
    let colour = hair_kajiya_kay_colour(hairs.deep, hairs.surface);
    let behind = vec3f(1.0) + colour * (1.6 * near * near * near);
    return scatter_reaches(hairs, n) * hair_kajiya_kay_diffuse(colour, a) * behind
      + vec3f(direct * hair_kajiya_kay_highlight(m, a));
  }
  var one = vec3f(0.0);
  // Where a ten-thousandth is left of the light, its colour does not matter.
  if n < 9.0 {
    if m.model == 1u {
      one = hair_karis(m, a, hairs.gains);
    } else {
      one = hair_chiang(m, a, clamp(2.0 * xi - 1.0, -1.0, 1.0));
    }
  }
  return one * direct + scatter_many(hairs, a, n);
}

// Radiance towards V of the sky's light. `facing` unit: out of the hair; light comes from that half, and
// what the hairs return of it from the other. `open` in 0..1: how much of it nothing stands before.
fn hair_sky(m: Hair, V: vec3f, T: vec3f, facing: vec3f, open: f32, xi: f32) -> vec3f {
  let sin_o = clamp(dot(T, V), -1.0, 1.0);
  let hairs = hair_scatter(m.sigma, sin_o);
  // The middles of the two lobes: mirrored at the hair, and straight on.
  let across = V - T * sin_o;
  let near = normalize(across - T * sin_o + facing * 1e-4);
  let far = normalize(facing * 1e-4 - across - T * sin_o);
  // Hairs that stand before let through what they do; a head that stands before lets through nothing.
  let reached = exp((hairs.loss * 0.75 + vec3f(0.25)) * log(clamp(open, 1e-4, 1.0)));
  let all = sky(facing, vec2f(0.6666667, 0.25));
  let wide = vec2f(0.55, 0.15);
  let front = sky(normalize(near + facing * 0.5 + T * 1e-4), wide);
  if m.model == 0u {
    let colour = hair_kajiya_kay_colour(hairs.deep, hairs.surface);
    return reached
      * (colour * all * (1.0 - HAIR_HIGHLIGHT) + front * (HAIR_HIGHLIGHT * m.specular));
  }
  let rim = sky(normalize(far + facing * 0.5 + T * 1e-4), wide);
  let inner = hairs.deep * all;
  let seen_near = sat(0.5 + 0.7 * dot(facing, near));
  let seen_far = sat(0.5 + 0.7 * dot(facing, far));
  // The surface reflects its share around the viewer, seven tenths of it back.
  let back = max(hairs.back + vec3f(0.7 * hairs.surface * (m.specular - 1.0)), vec3f(0.0));
  return reached
    * (back * mix(inner, front, seen_near) + hairs.forward * mix(inner, rim, seen_far));
}
