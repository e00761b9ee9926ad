// Numbers that every shader uses: constants, hashes, luminance. No bindings.

const PI: f32 = 3.14159265359;

// PCG hash of a word (Jarzynski & Olano 2020, "Hash functions for GPU rendering").
fn hash_u(x: u32) -> u32 {
  let state = x * 747796405u + 2891336453u;
  let word = ((state >> ((state >> 28u) + 4u)) ^ state) * 277803737u;
  return (word >> 22u) ^ word;
}

// A number in 0..1, never 1, from a word.
fn rnd(x: u32) -> f32 {
  return f32(hash_u(x) >> 8u) * (1.0 / 16777216.0);
}

fn sat(x: f32) -> f32 {
  return clamp(x, 0.0, 1.0);
}

// Luminance of linear Rec.709.
fn lum(c: vec3f) -> f32 {
  return dot(c, vec3f(0.2126, 0.7152, 0.0722));
}
