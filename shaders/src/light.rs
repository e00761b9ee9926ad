//! Light rigs: three lights and the surroundings, as a photographer sets them up.
//!
//! Irradiance is on a surface that faces the light, in the units of the picture. Guaranteed: an 18 %
//! grey card that faces the camera comes to a middle value (0.10 to 0.30) in every named rig, before
//! shadows. Not guaranteed: physical units; a rig is in proportion to the card, not to the sun.

use crate::camera::{Camera, Sphere};
use crate::environment::{Backdrop, Environment, lamp, luminance};
use crate::frame;
use glam::camera::rh::proj::directx::orthographic;
use glam::{Mat3, Mat4, Quat, Vec3};
use std::f32::consts::PI;

/// Reflectance of a photographer's grey card.
pub const GREY_CARD: f32 = 0.18;
/// Texels across the map that a light sees the subject in.
const MAP_TEXELS: f32 = 1024.0;
/// How far behind what casts a shadow it usually falls in hair, cm: a lock's depth. With a light's
/// size this gives the width that its shadows are blurred over.
const SHADOW_THROW: f32 = 3.0;

/// A distant light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Light {
    /// Unit, to the light.
    pub towards: Vec3,
    /// On a surface that faces it; zero is off.
    pub irradiance: Vec3,
    /// Angle that it is seen under, degrees: what makes its shadows soft.
    pub size_degrees: f32,
}

impl Light {
    /// No light.
    pub const OFF: Self = Self { towards: Vec3::Y, irradiance: Vec3::ZERO, size_degrees: 1.0 };

    fn new(towards: [f32; 3], strength: f32, tint: Vec3, size_degrees: f32) -> Self {
        // Tints change the colour and not the brightness.
        let irradiance = strength * tint / luminance(tint);
        Self { towards: Vec3::from(towards).normalize(), irradiance, size_degrees }
    }
}

const WHITE: Vec3 = Vec3::ONE;
/// About 5000 K against a white of 6500 K.
const WARM: Vec3 = Vec3::new(1.12, 0.99, 0.83);
/// About 8000 K against a white of 6500 K.
const COOL: Vec3 = Vec3::new(0.92, 0.99, 1.14);

/// Lights, surroundings and exposure.
#[derive(Clone, Debug, PartialEq)]
pub struct Rig {
    /// The first two cast the shadow of every strand; the third is the fill, shadowed by the density
    /// of the hair.
    pub lights: [Light; 3],
    /// Lights and surroundings turn with the camera about the vertical, as with a subject on a
    /// turntable: x is to the camera's right, y up, z towards the camera.
    pub with_camera: bool,
    /// Light from all around.
    pub environment: Environment,
    /// Stops that the picture is brightened by, so that the grey card comes to a middle value.
    pub exposure: f32,
}

impl Rig {
    /// Names of all rigs, the default first.
    pub const NAMES: [&'static str; 6] =
        ["studio", "backlit", "overcast", "flat", "dark-hair", "neutral"];

    /// The rig of a name; none for names that are not in [`Self::NAMES`].
    pub fn named(name: &str) -> Option<Self> {
        let even = |radiance: f32| move |_| Vec3::splat(radiance);
        let plain = |radiance: f32| Backdrop::Plain(Vec3::splat(radiance));
        let sweep = |middle: f32, edge: f32| Backdrop::Sweep {
            middle: Vec3::new(0.965, 1.0, 1.08) * middle,
            edge: Vec3::new(0.965, 1.0, 1.08) * edge,
        };
        // The number is what the grey card comes to.
        let (card, lights, environment) = match name {
            // A warm key high on the left, a cool rim from behind on the right, a weak fill.
            "studio" => (
                0.19,
                [
                    Light::new([-0.75, 0.75, 0.65], 4.0, WARM, 24.0),
                    Light::new([0.70, 0.60, -0.90], 3.3, COOL, 16.0),
                    Light::new([0.90, 0.10, 0.60], 0.8, COOL, 60.0),
                ],
                Environment::studio(),
            ),
            // Two lights from behind draw the outline and shine through; the front lives on bounce.
            "backlit" => (
                0.115,
                [
                    Light::new([0.55, 0.75, -1.00], 6.0, WARM, 12.0),
                    Light::new([-0.90, 0.30, -0.80], 3.2, COOL, 14.0),
                    Light::new([-0.30, 0.25, 1.00], 0.7, WHITE, 90.0),
                ],
                Environment::of(
                    |d| {
                        let back = lamp(d, Vec3::new(0.2, 0.5, -1.0), 0.4);
                        Vec3::splat(0.16 + 0.12 * d.y.max(0.0)) + Vec3::new(1.1, 1.0, 0.9) * back
                    },
                    sweep(0.075, 0.018),
                ),
            ),
            // A white sky: almost all from the surroundings, a broad light from above for form.
            "overcast" => (
                0.19,
                [
                    Light::new([-0.20, 1.00, 0.35], 1.0, WHITE, 90.0),
                    Light::new([0.30, 1.00, -0.50], 0.7, WHITE, 90.0),
                    Light::OFF,
                ],
                Environment::of(
                    |d| {
                        // Three times as bright overhead as at the horizon (CIE overcast sky).
                        let sky = (1.0 + 2.0 * d.y.max(0.0)) / 3.0;
                        let ground = ((-6.0 * d.y).clamp(0.0, 1.0), Vec3::new(0.20, 0.19, 0.17));
                        (Vec3::new(0.97, 1.0, 1.05) * sky).lerp(ground.1, ground.0)
                    },
                    plain(0.30),
                ),
            ),
            // For grooming: no side is dark, nothing shines, edges still show.
            "flat" => (
                0.20,
                [
                    Light::new([-0.25, 0.45, 1.00], 1.0, WHITE, 60.0),
                    Light::new([0.60, 0.80, 0.20], 0.5, WHITE, 60.0),
                    Light::new([0.50, -0.20, 0.80], 0.25, WHITE, 90.0),
                ],
                Environment::of(even(0.6), plain(0.11)),
            ),
            // Black hair is seen by what it reflects: a large key, and kickers from both sides behind
            // against a lighter wall.
            "dark-hair" => (
                0.23,
                [
                    Light::new([-0.55, 0.80, 0.75], 3.6, WHITE, 50.0),
                    Light::new([0.95, 0.45, -0.55], 3.6, COOL, 24.0),
                    Light::new([-0.95, 0.40, -0.60], 2.9, WARM, 24.0),
                ],
                Environment::of(
                    |d| {
                        let over = lamp(d, Vec3::new(0.0, 1.0, 0.25), 0.55);
                        let sides = lamp(d, Vec3::X, 0.4) + lamp(d, Vec3::NEG_X, 0.4);
                        Vec3::splat(0.45 + 1.5 * over + 0.45 * sides)
                    },
                    sweep(0.40, 0.16),
                ),
            ),
            // For judging colour: the studio, all white.
            "neutral" => return Self::named("studio").map(|rig| rig.in_white()),
            _ => return None,
        };
        let rig = Self { lights, with_camera: true, environment, exposure: 0.0 };
        Some(rig.balanced(card))
    }

    /// The same rig in white light, as bright as before.
    pub fn in_white(&self) -> Self {
        let white = |l: Light| Light { irradiance: Vec3::splat(luminance(l.irradiance)), ..l };
        Self { lights: self.lights.map(white), environment: self.environment.grey(), ..*self }
    }

    /// The same rig turned about the vertical, anticlockwise as seen from above: lights and surroundings, but for
    /// the backdrop, which is seen and not cast. As bright as before.
    pub fn turned(&self, degrees: f32) -> Self {
        if degrees % 360.0 == 0.0 || !degrees.is_finite() {
            return self.clone();
        }
        let turn = Quat::from_rotation_y(degrees.to_radians());
        let lights = self.lights.map(|l| Light { towards: turn * l.towards, ..l });
        Self { lights, environment: self.environment.turned(turn), ..*self }
    }

    /// Luminance of an unshadowed grey card that faces `n` (in the rig's own directions), exposed.
    pub fn grey_card(&self, n: Vec3) -> f32 {
        let direct: Vec3 =
            self.lights.iter().map(|l| l.irradiance * l.towards.dot(n).max(0.0)).sum();
        let irradiance = luminance(direct + self.environment.irradiance(n));
        GREY_CARD / PI * irradiance * self.exposure.exp2()
    }

    /// With all light but the backdrop's scaled so that a grey card that faces the camera comes to a
    /// value. A rig without light stays dark.
    fn balanced(mut self, card: f32) -> Self {
        let scale = card / self.grey_card(Vec3::Z).max(1e-6);
        for light in &mut self.lights {
            light.irradiance *= scale;
        }
        self.environment.sh = self.environment.sh.map(|c| c * scale);
        self
    }

    /// The turn from the rig's own directions to the world's.
    fn turn(&self, camera: &Camera) -> Quat {
        if !self.with_camera {
            return Quat::IDENTITY;
        }
        let ahead = camera.ahead();
        let (across, up) = camera.across_and_up();
        // The level way into the picture, also when it is seen from straight above or below: ahead
        // gives the cosine of the slope and up its sine, so that one grows as the other vanishes.
        let level = |v: Vec3| Vec3::new(v.x, 0.0, v.z);
        let rise = ahead.y;
        let into = level(ahead) * (1.0 - rise * rise).max(0.0).sqrt() - level(up) * rise;
        // A camera that lies on its side has neither; its right is level at least.
        let into = into
            .try_normalize()
            .unwrap_or_else(|| Vec3::Y.cross(level(across)).normalize_or(Vec3::NEG_Z));
        Quat::from_mat3(&Mat3::from_cols(into.cross(Vec3::Y), Vec3::Y, -into))
    }

    /// The lights in the world, as a camera has them.
    pub fn lights_in_world(&self, camera: &Camera) -> [Light; 3] {
        let turn = self.turn(camera);
        self.lights.map(|l| Light { towards: turn * l.towards, ..l })
    }

    /// The surroundings in the world, as a camera has them.
    pub fn environment_in_world(&self, camera: &Camera) -> Environment {
        match self.with_camera {
            true => self.environment.turned(self.turn(camera)),
            false => self.environment.clone(),
        }
    }

    /// The lights as the frame block holds them; their maps cover `bounds`.
    pub(crate) fn lights_for(&self, camera: &Camera, bounds: Sphere) -> [frame::Light; 3] {
        let sound = bounds.centre.is_finite() && bounds.radius.is_finite();
        let centre = if sound { bounds.centre } else { Vec3::ZERO };
        let radius = if sound { bounds.radius.max(0.1) * 1.01 } else { 1.0 };
        let mut kind = [1.0, 1.0, 2.0].into_iter();
        self.lights_in_world(camera).map(|light| {
            let kind = kind.next().unwrap_or(0.0);
            let towards = light.towards.normalize_or(Vec3::Y);
            let on = light.irradiance.max_element() > 0.0;
            let eye = Camera {
                eye: centre + towards * radius,
                target: centre,
                up: if towards.y.abs() > 0.95 { Vec3::X } else { Vec3::Y },
                focal_mm: 50.0,
                orthographic: None,
            };
            let clip_from_view = orthographic(-radius, radius, -radius, radius, 0.0, 2.0 * radius);
            let clip: Mat4 = clip_from_view * eye.view();
            let half_angle = light.size_degrees.clamp(0.0, 120.0).to_radians() * 0.5;
            let blur = (SHADOW_THROW * half_angle.tan()).max(2.0 * radius / MAP_TEXELS);
            frame::Light {
                towards: towards.extend(if on { kind } else { 0.0 }).to_array(),
                irradiance: light.irradiance.max(Vec3::ZERO).extend(blur).to_array(),
                clip_from_world: clip.to_cols_array_2d(),
                extent: [2.0 * radius, 2.0 * radius, MAP_TEXELS, 0.0],
            }
        })
    }
}

impl Default for Rig {
    fn default() -> Self {
        let off = || Self {
            lights: [Light::OFF; 3],
            with_camera: true,
            environment: Environment::studio(),
            exposure: 0.0,
        };
        Self::named(Self::NAMES[0]).unwrap_or_else(off)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn camera(eye: Vec3, up: Vec3) -> Camera {
        Camera { eye, target: Vec3::ZERO, up, focal_mm: 85.0, orthographic: None }
    }

    fn each_rig(check: impl Fn(&str, Rig)) {
        for name in Rig::NAMES {
            check(name, Rig::named(name).unwrap());
        }
        assert_eq!(Rig::named("sunset"), None);
    }

    #[test]
    fn a_grey_card_comes_to_a_middle_value_in_every_rig() {
        each_rig(|name, rig| {
            let card = rig.grey_card(Vec3::Z);
            assert!((0.10..0.30).contains(&card), "{name} {card}");
        });
    }

    #[test]
    fn every_light_is_sound() {
        each_rig(|name, rig| {
            for light in rig.lights {
                assert!((light.towards.length() - 1.0).abs() < 1e-5, "{name}");
                assert!(light.irradiance.min_element() >= 0.0, "{name}");
                assert!((0.5..=90.0).contains(&light.size_degrees), "{name}");
            }
            assert!(rig.environment.mean().min_element() > 0.0, "{name}");
        });
    }

    #[test]
    fn a_turned_rig_lights_from_elsewhere_and_as_brightly() {
        each_rig(|name, rig| {
            let quarter = rig.turned(90.0);
            // What came from the front comes from the right.
            let (before, now) = (rig.grey_card(Vec3::Z), quarter.grey_card(Vec3::X));
            assert!((before - now).abs() < 1e-4, "{name}: {before} {now}");
            assert_eq!(quarter.exposure, rig.exposure);
            assert_eq!(rig.turned(-720.0), rig, "{name}");
            let back = quarter.turned(-90.0);
            for (a, b) in back.lights.iter().zip(rig.lights) {
                assert!(a.towards.distance(b.towards) < 1e-5, "{name}");
            }
        });
    }

    #[test]
    fn white_light_is_white_and_as_bright() {
        each_rig(|name, rig| {
            let white = rig.in_white();
            assert!((white.grey_card(Vec3::Z) - rig.grey_card(Vec3::Z)).abs() < 1e-4, "{name}");
            for l in white.lights {
                assert_eq!(l.irradiance.max_element(), l.irradiance.min_element());
            }
            let sky = white.environment.irradiance(Vec3::new(0.6, 0.0, 0.8));
            assert_eq!(sky.max_element(), sky.min_element());
        });
    }

    #[test]
    fn flat_light_is_even_and_backlight_comes_from_behind() {
        let flat = Rig::named("flat").unwrap();
        let around = [Vec3::X, Vec3::NEG_X, Vec3::Z, Vec3::Y].map(|n| flat.grey_card(n));
        let most = around.iter().copied().fold(0.0, f32::max);
        let least = around.iter().copied().fold(f32::MAX, f32::min);
        assert!(most < 2.0 * least, "{around:?}");
        let backlit = Rig::named("backlit").unwrap();
        assert!(backlit.grey_card(Vec3::NEG_Z) > 3.0 * backlit.grey_card(Vec3::Z));
    }

    #[test]
    fn dark_hair_is_edged_from_both_sides_and_the_studio_from_one() {
        let strongest = |name: &str, side: f32| {
            let lights = Rig::named(name).unwrap().lights;
            let behind = lights.iter().filter(|l| l.towards.z < 0.0 && l.towards.x * side > 0.0);
            behind.map(|l| luminance(l.irradiance)).fold(0.0, f32::max)
        };
        let studio = strongest("studio", 1.0);
        assert_eq!(strongest("studio", -1.0), 0.0);
        for side in [1.0, -1.0] {
            assert!(strongest("dark-hair", side) > 0.5 * studio, "{side}");
        }
    }

    #[test]
    fn lights_turn_with_the_camera_and_stay_level() {
        let rig = Rig::named("studio").unwrap();
        for degrees in [0.0, 33.0, 90.0, 180.0, 270.0] {
            let front = camera(Vec3::Z * 100.0, Vec3::Y);
            let turned = front.turned(Vec3::ZERO, Vec3::Y, degrees);
            let (across, up) = turned.across_and_up();
            for (light, own) in rig.lights_in_world(&turned).iter().zip(&rig.lights) {
                let seen = Vec3::new(
                    light.towards.dot(across),
                    light.towards.dot(up),
                    -light.towards.dot(turned.ahead()),
                );
                assert!(seen.distance(own.towards) < 1e-4, "{degrees} {seen}");
            }
            let n = -turned.ahead();
            let sky = rig.environment_in_world(&turned).irradiance(n);
            assert!(sky.distance(rig.environment.irradiance(Vec3::Z)) < 1e-3);
        }
        let fixed = Rig { with_camera: false, ..rig };
        let side = camera(Vec3::X * 100.0, Vec3::Y);
        assert_eq!(fixed.lights_in_world(&side), fixed.lights);
        assert_eq!(fixed.environment_in_world(&side), fixed.environment);
    }

    #[test]
    fn rising_over_the_head_does_not_swing_the_lights() {
        let rig = Rig::named("studio").unwrap();
        let level = rig.lights_in_world(&camera(Vec3::Z * 100.0, Vec3::Y));
        for degrees in [-89.0f32, -45.0, 10.0, 60.0, 89.0, 89.99] {
            let (sin, cos) = degrees.to_radians().sin_cos();
            let raised = camera(Vec3::new(0.0, sin, cos) * 100.0, Vec3::Y);
            for (a, b) in rig.lights_in_world(&raised).iter().zip(&level) {
                assert!(a.towards.distance(b.towards) < 1e-2, "{degrees}");
            }
        }
        let top = rig.lights_in_world(&camera(Vec3::Y * 100.0, Vec3::NEG_Z));
        assert!(top[0].towards.distance(level[0].towards) < 1e-4);
        let lying = rig.lights_in_world(&camera(Vec3::Z * 100.0, Vec3::X));
        assert!(lying.iter().all(|l| l.towards.is_finite()));
    }

    #[test]
    fn a_lights_map_covers_the_bounds_from_its_near_end_to_its_far_end() {
        let bounds = Sphere { centre: Vec3::new(3.0, -9.0, 1.0), radius: 30.0 };
        each_rig(|name, rig| {
            let camera = camera(Vec3::new(30.0, 40.0, 70.0), Vec3::Y);
            let in_world = rig.lights_in_world(&camera);
            for (light, own) in rig.lights_for(&camera, bounds).iter().zip(in_world) {
                let clip = Mat4::from_cols_array_2d(&light.clip_from_world);
                let at = |p: Vec3| clip.project_point3(p);
                for k in 0..50 {
                    let (sin, cos) = (k as f32 * 2.4).sin_cos();
                    let y = k as f32 / 25.0 - 0.98;
                    let r = (1.0 - y * y).max(0.0).sqrt();
                    let p = at(bounds.centre + Vec3::new(r * cos, y, r * sin) * bounds.radius);
                    assert!(p.truncate().abs().max_element() <= 1.0, "{name} {p}");
                    assert!((0.0..=1.0).contains(&p.z), "{name} {p}");
                }
                let (near, far) = (at(bounds.centre + own.towards * 20.0), at(bounds.centre));
                assert!(near.z < far.z && (far.z - 0.5).abs() < 1e-3);
                // Depth and width are in cm as they say.
                assert!(((far.z - near.z) * light.extent[1] - 20.0).abs() < 1e-2);
                assert!(light.irradiance[3] > 0.0 && light.irradiance[3] < 5.0);
            }
        });
    }

    #[test]
    fn lights_that_are_off_say_so_and_poor_bounds_are_borne() {
        let rig = Rig::named("overcast").unwrap();
        let camera = camera(Vec3::Z * 100.0, Vec3::Y);
        let poor = [
            Sphere { centre: Vec3::NAN, radius: 1.0 },
            Sphere { centre: Vec3::ZERO, radius: 0.0 },
            Sphere { centre: Vec3::ZERO, radius: f32::INFINITY },
        ];
        for bounds in poor {
            let lights = rig.lights_for(&camera, bounds);
            assert_eq!(lights.map(|l| l.towards[3]), [1.0, 1.0, 0.0]);
            let finite =
                |l: &frame::Light| l.clip_from_world.iter().flatten().all(|v| v.is_finite());
            assert!(lights.iter().all(finite));
        }
    }
}
