// Skin: how it takes light, and the shadow that dense hair roots lay on it.
//
// Light that enters comes out beside where it entered, red the farthest: the cosine of the light's angle is wrapped around the
// terminator by a width for each channel and scaled so that no energy is made (McAuley 2013, "Extending physically based shading
// for games", course notes of GDC). Over it lies an oily surface of two lobes (GGX, weights and roughness after Jimenez et al.
// 2015, "Separable subsurface scattering"), f0 0.028 for an index of 1.4. What the surface reflects does not enter.
// Guaranteed: never more light out than in, from any side. Not promised: reciprocity, which the wrap gives up.

//#include "common.wgsl"
//#include "environment.wgsl"

@group(1) @binding(2) var root_grid: texture_3d<f32>;
@group(1) @binding(3) var root_sampler: sampler;

// How far light of each channel reaches around the terminator, as a cosine.
const WRAP: vec3f = vec3f(0.16, 0.07, 0.04);
const SKIN_F0: f32 = 0.028;
// Albedo of skin that is full of black hair.
const DARKEST: f32 = 0.06;
// Density of roots that the texture has as 1, in full heads: `MOST` of `surface/roots.rs`.
const MOST_ROOTS: f32 = 3.0;
// Squared roughness (alpha) of the dull and the sharp lobe, and the dull one's share.
const DULL: f32 = 0.34;
const SHARP: f32 = 0.12;
const DULL_SHARE: f32 = 0.8;

// What both lobes together mirror of even light, by the cosine of the view: our own fit, nowhere below and at most 0.015 over what the
// lobes add up to.
fn skin_mirror(nv: f32) -> f32 {
  return 0.0245 + 0.174 * pow(1.0 - nv, 2.6);
}

fn skin_lobe(alpha: f32, nh: f32, nl: f32, nv: f32) -> f32 {
  let a2 = alpha * alpha;
  let d = nh * nh * (a2 - 1.0) + 1.0;
  // Height-correlated masking (Heitz 2014), with the 4 nl nv of the reflection's density in it.
  let g = 0.5 / (nl * sqrt(nv * nv * (1.0 - a2) + a2) + nv * sqrt(nl * nl * (1.0 - a2) + a2));
  return a2 / (PI * d * d) * g;
}

// Radiance towards V for a distant light of unit irradiance on a surface that faces it.
fn skin_light(albedo: vec3f, N: vec3f, V: vec3f, L: vec3f) -> vec3f {
  let nl = dot(N, L);
  let nv = clamp(dot(N, V), 0.02, 1.0);
  let wrapped = max(vec3f(nl) + WRAP, vec3f(0.0)) / ((1.0 + WRAP) * (1.0 + WRAP));
  var c = albedo * wrapped * ((1.0 - skin_mirror(nv)) / PI);
  if nl > 0.0 {
    let H = normalize(L + V);
    let nh = sat(dot(N, H));
    let f = SKIN_F0 + (1.0 - SKIN_F0) * pow(1.0 - sat(dot(V, H)), 5.0);
    let lobes = DULL_SHARE * skin_lobe(DULL, nh, nl, nv) + (1.0 - DULL_SHARE) * skin_lobe(SHARP, nh, nl, nv);
    c += vec3f(f * lobes * nl);
  }
  return c;
}

// Radiance towards V for the light of the surroundings, of which `open` (0..1) arrives.
fn skin_sky(albedo: vec3f, N: vec3f, V: vec3f, open: f32) -> vec3f {
  let nv = clamp(dot(N, V), 0.02, 1.0);
  let mirror = skin_mirror(nv);
  // Band gains of the wrapped cosine of the green channel; red and blue differ by less than what is seen.
  let diffuse = albedo * sky(N, vec2f(0.643, 0.216)) * (1.0 - mirror);
  // A hollow shades the mirrored sky sooner than the whole one (Lagarde and de Rousiers 2014, "Moving Frostbite to physically based
  // rendering", 4.10.2).
  let seen = sat(pow(nv + open, exp2(-16.0 * DULL - 1.0)) - 1.0 + open);
  return diffuse * open + sky(reflect(-V, N), vec2f(0.8, 0.5)) * (mirror * seen);
}

fn roots_at(uvw: vec3f) -> f32 {
  return textureSampleLevel(root_grid, root_sampler, uvw, 0.0).r;
}

// How dense roots are at a place in cells from the grid's corner, of 0..1 as the texture has it: by the quadratic B-spline, whose
// 27 cells eight linear reads take. Linear alone, cells along the axes would show as scallops along a parting.
fn root_density(at: vec3f) -> f32 {
  let own = floor(at);
  let t = at - own - 0.5;
  // A read between a cell and the one before (or behind) it has the outer one's weight and half of the middle one's.
  let half_middle = 0.375 - 0.5 * t * t;
  let before = 0.5 * (0.5 - t) * (0.5 - t);
  let behind = 0.5 * (0.5 + t) * (0.5 + t);
  let low = before + half_middle;
  let high = behind + half_middle;
  let size = vec3f(F.roots_size.xyz);
  let near = (own - 0.5 + half_middle / low) / size;
  let far = (own + 0.5 + behind / high) / size;
  let below = low.x * roots_at(near) + high.x * roots_at(vec3f(far.x, near.yz));
  let above = low.x * roots_at(vec3f(near.x, far.y, near.z)) + high.x * roots_at(vec3f(far.xy, near.z));
  let below_far = low.x * roots_at(vec3f(near.xy, far.z)) + high.x * roots_at(vec3f(far.x, near.y, far.z));
  let above_far = low.x * roots_at(vec3f(near.x, far.yz)) + high.x * roots_at(far);
  return low.z * (low.y * below + high.y * above) + high.z * (low.y * below_far + high.y * above_far);
}

// Skin between dense roots: its own colour, darker by the hair in it, as a shaved head's is.
fn scalp_tint(p: vec3f, albedo: vec3f) -> vec3f {
  if F.roots_size.w == 0u { return albedo; }
  let at = (p - F.roots.xyz) / F.roots.w;
  if any(at < vec3f(0.0)) || any(at > vec3f(F.roots_size.xyz)) { return albedo; }
  // Below a quarter of a full head's density skin is skin: partings and the blur at the hairline.
  let dense = smoothstep(0.25, 0.9, MOST_ROOTS * root_density(at));
  // Less of red than of blue comes through, but what is left of dark hair under skin looks cool. Skin that is as dark as hair
  // under it hardly changes.
  let under = max(albedo * vec3f(0.3, 0.31, 0.34), min(albedo, vec3f(DARKEST)));
  return mix(albedo, under, F.cover.z * dense);
}
