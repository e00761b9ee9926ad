//! Grey ball, chrome ball and 24-patch chart in the lower left corner of a picture: what the light is,
//! and whether colours arrive.
//!
//! Guaranteed: shown with the rig's own exposure and the sRGB transform, each patch has its published
//! code values. The balls stand in the rig's light alone: nothing in the scene shadows them or is
//! mirrored. Not guaranteed: anything in pictures too small for a patch of one pixel.

use crate::camera::Camera;
use crate::display::linear_from_srgb;
use crate::environment::{Backdrop, Environment};
use crate::light::{GREY_CARD, Light, Rig};
use crate::picture::Picture;
use glam::{Vec2, Vec3};
use std::f32::consts::PI;

/// sRGB code values of the ColorChecker Classic's patches, row by row from dark skin to black, as X-Rite
/// publishes them ("Colorimetric values for ColorChecker family of targets"; the chart is by McCamy,
/// Marcus & Davidson 1976).
pub const PATCHES: [[u8; 3]; 24] = [
    [115, 82, 68],
    [194, 150, 130],
    [98, 122, 157],
    [87, 108, 67],
    [133, 128, 177],
    [103, 189, 170],
    [214, 126, 44],
    [80, 91, 166],
    [193, 90, 99],
    [94, 60, 108],
    [157, 188, 64],
    [224, 163, 46],
    [56, 61, 150],
    [70, 148, 73],
    [175, 54, 60],
    [231, 199, 31],
    [187, 86, 149],
    [8, 133, 161],
    [243, 243, 242],
    [200, 200, 200],
    [160, 160, 160],
    [122, 122, 121],
    [85, 85, 85],
    [52, 52, 52],
];
/// Patches in a row.
const COLUMNS: u32 = 6;
/// What chrome mirrors of the light that falls on it.
const CHROME: f32 = 0.9;
/// The frame around the patches, linear.
const FRAME: f32 = 0.02;
/// Samples across a pixel of a ball.
const FINE: u32 = 4;

/// Where things are, in pixels from the upper left corner.
struct Layout {
    /// Side of a patch with the gap beside it.
    patch: u32,
    /// Left and upper edge of the whole.
    corner: (u32, u32),
}

impl Layout {
    /// None where a patch would be smaller than a pixel.
    fn new(width: u32, height: u32) -> Option<Self> {
        let patch = (height * 3 / 100).min(width / 18);
        let corner = (patch, height.checked_sub(5 * patch)?);
        (patch > 0).then_some(Self { patch, corner })
    }

    /// Left edges of the grey ball, the chrome ball and the chart; all are four patches high.
    fn left_edges(&self) -> [u32; 3] {
        [0, 9 * self.patch / 2, 9 * self.patch].map(|x| self.corner.0 + x)
    }

    /// Left and upper edge of a patch.
    fn patch_at(&self, k: u32) -> (u32, u32) {
        let x = self.left_edges()[2] + k % COLUMNS * self.patch;
        (x, self.corner.1 + k / COLUMNS * self.patch)
    }

    /// Width of the frame to the left of and above each patch.
    fn gap(&self) -> u32 {
        self.patch / 8
    }
}

/// Draws balls and chart over the lower left corner of a picture that `rig` lights and `camera` sees.
/// Nothing is drawn in a picture that is too small or whose pixels do not fit its size.
pub fn draw(picture: &mut Picture, rig: &Rig, camera: &Camera) {
    let Some(layout) = Layout::new(picture.width, picture.height) else { return };
    if picture.linear.len() != picture.width as usize * picture.height as usize {
        return;
    }
    let mut set = |x: u32, y: u32, colour: Vec3, cover: f32| {
        let pixel = &mut picture.linear[(y * picture.width + x) as usize];
        let [r, g, b, a] = *pixel;
        let mixed = Vec3::new(r, g, b).lerp(colour, cover);
        *pixel = mixed.extend(a + (1.0 - a) * cover).to_array();
    };

    // Patches are reference values and not lit: what the rig's exposure adds later is taken off here.
    let unexposed = (-rig.exposure).exp2();
    let (side, gap) = (layout.patch, layout.gap());
    for (k, patch) in (0u32..).zip(PATCHES) {
        let (left, top) = layout.patch_at(k);
        let colour = linear_from_srgb(Vec3::from_array(patch.map(|v| f32::from(v) / 255.0)));
        for y in 0..side {
            for x in 0..side {
                let inside = x >= gap && y >= gap;
                let shown = if inside { colour } else { Vec3::splat(FRAME) };
                set(left + x, top + y, shown * unexposed, 1.0);
            }
        }
    }

    let lights = rig.lights_in_world(camera);
    let environment = rig.environment_in_world(camera);
    let (across, up) = camera.across_and_up();
    let towards_eye = -camera.ahead();
    let [grey_left, chrome_left, _] = layout.left_edges();
    let grey = |n: Vec3| grey_ball(&lights, &environment, n);
    let chrome = |n: Vec3| {
        let mirrored = 2.0 * n.dot(towards_eye) * n - towards_eye;
        CHROME * mirrored_light(&lights, &environment, mirrored)
    };
    let shades: [(u32, &dyn Fn(Vec3) -> Vec3); 2] = [(grey_left, &grey), (chrome_left, &chrome)];
    let diameter = 4 * side;
    for (left, shade) in shades {
        for y in 0..diameter {
            for x in 0..diameter {
                let (mut sum, mut hits) = (Vec3::ZERO, 0.0);
                for k in 0..FINE * FINE {
                    let part = Vec2::new((k % FINE) as f32 + 0.5, (k / FINE) as f32 + 0.5);
                    let at = Vec2::new(x as f32, y as f32) + part / FINE as f32;
                    let p = at * (2.0 / diameter as f32) - 1.0;
                    let depth = 1.0 - p.length_squared();
                    if depth >= 0.0 {
                        sum += shade(across * p.x - up * p.y + towards_eye * depth.sqrt());
                        hits += 1.0;
                    }
                }
                if hits > 0.0 {
                    set(left + x, layout.corner.1 + y, sum / hits, hits / (FINE * FINE) as f32);
                }
            }
        }
    }
}

/// Radiance of an 18 % grey surface that faces `n`.
fn grey_ball(lights: &[Light; 3], environment: &Environment, n: Vec3) -> Vec3 {
    let direct: Vec3 = lights.iter().map(|l| l.irradiance * l.towards.dot(n).max(0.0)).sum();
    GREY_CARD / PI * (direct + environment.irradiance(n))
}

/// Radiance from a direction: the surroundings, and each light as a disc of its size.
fn mirrored_light(lights: &[Light; 3], environment: &Environment, d: Vec3) -> Vec3 {
    if let Backdrop::Map(map) = &environment.backdrop {
        // The map still holds the lamps that the lights were made of.
        return map.at(d);
    }
    let mut radiance = environment.radiance(d, [1.0, 1.0]);
    for light in lights {
        let (sin, cos) = (light.size_degrees.clamp(0.5, 170.0).to_radians() * 0.5).sin_cos();
        if light.towards.dot(d) >= cos {
            // Irradiance of a disc of even radiance that is seen under this half angle.
            radiance += light.irradiance / (PI * sin * sin);
        }
    }
    radiance
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::display::Transform;
    use crate::environment::RadianceMap;
    use std::sync::Arc;

    fn camera() -> Camera {
        let eye = Vec3::new(0.0, 10.0, 120.0);
        Camera { eye, target: Vec3::ZERO, up: Vec3::Y, focal_mm: 85.0, orthographic: None }
    }

    fn drawn(rig: &Rig, width: u32, height: u32) -> Picture {
        let mut picture = Picture::plain(width, height, [0.3, 0.2, 0.1, 0.0]);
        draw(&mut picture, rig, &camera());
        picture
    }

    fn pixel(picture: &Picture, x: u32, y: u32) -> Vec3 {
        let [r, g, b, _] = picture.linear[(y * picture.width + x) as usize];
        Vec3::new(r, g, b)
    }

    /// Middles of the grey ball and the chrome ball.
    fn middles(picture: &Picture) -> [(u32, u32); 2] {
        let layout = Layout::new(picture.width, picture.height).unwrap();
        let [grey, chrome, _] = layout.left_edges();
        [grey, chrome].map(|x| (x + 2 * layout.patch, layout.corner.1 + 2 * layout.patch))
    }

    #[test]
    fn patches_are_shown_with_their_published_values_at_the_rigs_own_exposure() {
        for exposure in [-2.0, 0.0, 3.5] {
            let rig = Rig { exposure, ..Rig::default() };
            let picture = drawn(&rig, 640, 360);
            let encoded = picture.encoded(Transform::Srgb, exposure);
            let layout = Layout::new(640, 360).unwrap();
            for (k, patch) in (0u32..).zip(PATCHES) {
                let (x, y) = layout.patch_at(k);
                let at = 4 * ((y + layout.patch / 2) * 640 + x + layout.patch / 2) as usize;
                for (ours, published) in encoded[at..at + 3].iter().zip(patch) {
                    assert!(ours.abs_diff(published) <= 1, "patch {k}: {ours} for {published}");
                }
            }
        }
    }

    #[test]
    fn the_middle_of_the_grey_ball_is_the_grey_card_of_the_rig() {
        for name in Rig::NAMES {
            let rig = Rig::named(name).unwrap();
            let picture = drawn(&rig, 640, 360);
            let [(x, y), _] = middles(&picture);
            let towards_eye = -camera().ahead();
            // The rig stays level; the camera looks down by a few degrees.
            let card = rig.grey_card(towards_eye);
            let around =
                [(1, 1), (1, 0), (0, 1), (0, 0)].map(|(i, k)| pixel(&picture, x - i, y - k));
            let ours = crate::environment::luminance(around.iter().sum::<Vec3>() / 4.0);
            assert!((ours / card - 1.0).abs() < 0.01, "{name}: {ours} for {card}");
        }
    }

    #[test]
    fn the_chrome_ball_mirrors_a_light_where_it_must() {
        let behind_eye =
            Light { towards: -camera().ahead(), irradiance: Vec3::ONE, size_degrees: 20.0 };
        let rig = Rig { lights: [behind_eye, Light::OFF, Light::OFF], ..Rig::default() };
        let rig = Rig { with_camera: false, ..rig };
        let picture = drawn(&rig, 640, 360);
        let [_, (x, y)] = middles(&picture);
        let radiance = 1.0 / (PI * 10f32.to_radians().sin().powi(2));
        let lit = pixel(&picture, x, y).x;
        assert!(lit > CHROME * radiance && lit < CHROME * radiance + 2.0, "{lit} {radiance}");
        // Mirrored angles are twice the ball's: a light of 10 degrees around is gone past 5.
        let side = Layout::new(640, 360).unwrap().patch;
        assert!(pixel(&picture, x + side, y).x < 0.5 * lit);
    }

    #[test]
    fn a_mirrored_map_is_not_lit_twice() {
        let map = Arc::new(RadianceMap::of(32, 16, |_| Vec3::splat(0.7)));
        let environment = Environment { backdrop: Backdrop::Map(map), ..Environment::studio() };
        let rig = Rig { environment, with_camera: false, ..Rig::default() };
        let picture = drawn(&rig, 640, 360);
        let [_, (x, y)] = middles(&picture);
        assert!((pixel(&picture, x, y).x - CHROME * 0.7).abs() < 1e-3);
    }

    #[test]
    fn the_rest_of_the_picture_stays_and_what_is_drawn_covers() {
        let picture = drawn(&Rig::default(), 640, 360);
        let layout = Layout::new(640, 360).unwrap();
        let right = layout.left_edges()[2] + COLUMNS * layout.patch;
        let bottom = layout.corner.1 + 4 * layout.patch;
        assert!(right < 640 / 2 && bottom < 360 && layout.corner.1 > 360 / 2);
        for y in 0..360 {
            for x in 0..640 {
                let inside =
                    (layout.corner.0..right).contains(&x) && (layout.corner.1..bottom).contains(&y);
                let there = picture.linear[(y * 640 + x) as usize];
                assert!(inside || there == [0.3, 0.2, 0.1, 0.0], "{x} {y}");
            }
        }
        let (x, y) = layout.patch_at(9);
        assert_eq!(picture.linear[(y * 640 + x) as usize][3], 1.0);
    }

    #[test]
    fn small_and_broken_pictures_are_borne() {
        for (width, height) in [(0, 0), (1, 1), (17, 400), (400, 20), (18, 34), (40, 40)] {
            drawn(&Rig::default(), width, height);
        }
        let mut broken = Picture { width: 900, ..Picture::plain(90, 900, [0.0; 4]) };
        draw(&mut broken, &Rig::default(), &camera());
        assert!(broken.linear.iter().all(|p| *p == [0.0; 4]));
    }
}
