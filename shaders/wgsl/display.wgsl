// From scene-linear Rec.709 to what a display is sent. The Rust twin is `display.rs`; sources are there.
//#include "common.wgsl"

// AgX in the form that Blender 4 ships: greys stay grey, bright colours go to white, 18 % stays 18 %.
fn agx(linear: vec3f) -> vec3f {
  let inset = mat3x3f(
    0.5448686, 0.1404424, 0.0888315,
    0.3737523, 0.7541222, 0.1788853,
    0.0813791, 0.1054354, 0.7322832) * clamp(linear, vec3f(2e-10), vec3f(1e10));
  let x = clamp((log2(inset) + 12.473931) / 16.5, vec3f(0.0), vec3f(1.0));
  let scale = select(vec3f(-0.5656756), vec3f(0.7151983), x >= vec3f(0.6060606));
  let t = 2.4 * (x - 0.6060606) / scale;
  let root = pow(1.0 + t * sqrt(max(t, vec3f(0.0))), vec3f(-2.0 / 3.0));
  let shown = pow(clamp(0.4894371 + scale * t * root, vec3f(0.0), vec3f(1.0)), vec3f(2.4));
  return srgb(mat3x3f(
    1.9648940, -0.2993091, -0.1643564,
    -0.8560079, 1.3263919, -0.2382074,
    -0.1088861, -0.0270828, 1.4025638) * shown);
}

fn srgb(linear: vec3f) -> vec3f {
  let c = clamp(linear, vec3f(0.0), vec3f(1.0));
  return select(1.055 * pow(c, vec3f(1.0 / 2.4)) - 0.055, 12.92 * c, c <= vec3f(0.0031308));
}

fn rec1886(linear: vec3f) -> vec3f {
  return pow(clamp(linear, vec3f(0.0), vec3f(1.0)), vec3f(1.0 / 2.4));
}

// Exposed scene-linear light to display code values 0 to 1. 0 AgX, 1 sRGB, 2 Rec.1886.
fn display(linear: vec3f, transform: u32) -> vec3f {
  switch transform {
    case 0u: { return agx(linear); }
    case 1u: { return srgb(linear); }
    default: { return rec1886(linear); }
  }
}

// Rounded to 8 bits by a threshold that depends on the pixel's number only, so that gradients do not
// band and the picture is the same each time. 0 and 1 stay.
fn dithered(encoded: vec3f, pixel: u32) -> vec3f {
  let threshold = 0.0001 + 0.9998 * rnd(pixel);
  return floor(clamp(encoded, vec3f(0.0), vec3f(1.0)) * 255.0 + threshold) / 255.0;
}
