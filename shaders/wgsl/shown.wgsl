// The picture so far as a display takes it: sums of samples to 8 bits a channel. The Rust twin is `Picture::encoded`.

//#include "display.wgsl"

struct Showing {
  // Pixels across and down.
  width: u32,
  height: u32,
  // Number of the display transform.
  transform: u32,
  // What sums are multiplied by: exposure over the number of samples.
  gain: f32,
};

@group(0) @binding(0) var<storage, read> sums: array<vec4f>;
// Red in the lowest byte, alpha 255 in the highest.
@group(0) @binding(1) var<storage, read_write> bytes: array<u32>;
@group(0) @binding(2) var<uniform> D: Showing;

@compute @workgroup_size(8, 8)
fn show(@builtin(global_invocation_id) pixel: vec3u) {
  if pixel.x >= D.width || pixel.y >= D.height { return; }
  let i = pixel.y * D.width + pixel.x;
  let c = vec3u(dithered(display(sums[i].rgb * D.gain, D.transform), i) * 255.0 + 0.5);
  bytes[i] = c.r | (c.g << 8u) | (c.b << 16u) | 0xff000000u;
}
