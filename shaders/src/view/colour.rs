//! Colours of views: ramps for numbers, colours of ids, and how a point's colour is packed into a word.
//!
//! Guarantees: lightness of the ramp for numbers only rises, so that it reads without colour vision and in grey; an id has
//! the same colour in every picture; small whole numbers (strands of a braid) lie far apart.
//! Not promised: that two ids never look alike. A few hundred clusters have more ids than eyes tell colours.
//!
//! All colours are linear Rec.709.

use crate::display::linear_from_srgb;
use coif_nodes::maths::hash::mix;
use coif_nodes::maths::transcendental::sin_cos_turns;
use glam::Vec3;

/// The greatest root of absorption that a packed colour of hair holds.
pub(crate) const DEEPEST: f32 = 4.5;
/// What has no value: points without the attribute, hair of no braid. Mid-grey.
pub(crate) const NONE: Vec3 = Vec3::splat(0.18);

/// Roots of absorption in 11, 11 and 10 bits; the root, because colour falls with it.
pub(crate) fn pack_absorption(sigma: Vec3) -> u32 {
    let bits = |s: f32, most: f32| (s.max(0.0).sqrt() / DEEPEST * most).min(most).round() as u32;
    bits(sigma.x, 2047.0) | bits(sigma.y, 2047.0) << 11 | bits(sigma.z, 1023.0) << 22
}

/// Roots of linear colour in 8, 8 and 8 bits: close to what displays do, and one multiplication to undo.
pub(crate) fn pack_colour(colour: Vec3) -> u32 {
    let bits = |c: f32| (c.clamp(0.0, 1.0).sqrt() * 255.0).round() as u32;
    bits(colour.x) | bits(colour.y) << 8 | bits(colour.z) << 16
}

/// An sRGB swatch, `0xRRGGBB`, as linear light.
pub fn swatch(hex: u32) -> Vec3 {
    let [_, r, g, b] = hex.to_be_bytes();
    linear_from_srgb(Vec3::new(r.into(), g.into(), b.into()) / 255.0)
}

/// Stops of viridis, evenly spaced (van der Walt and Smith 2015, the map of matplotlib; given to the public domain).
const VIRIDIS: [u32; 10] = [
    0x440154, 0x482878, 0x3E4A89, 0x31688E, 0x26828E, 0x1F9E89, 0x35B779, 0x6DCD59, 0xB4DE2C,
    0xFDE725,
];
/// Of trouble: the worse, the darker and redder. Stands out of grey hair and of viridis.
const ALARM: [u32; 4] = [0xFFC04D, 0xFF7A1F, 0xF02A1A, 0xC0003C];
/// What is past a limit.
const OVER: u32 = 0xFF0A78;

/// How numbers become colours.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ramp {
    /// Viridis: dark purple, green, yellow. Lightness only rises.
    Viridis,
    /// Grey up to the lowest number, then orange to crimson: for what ought not to be there.
    Alarm,
}

impl Ramp {
    /// The colour at `t`: 0 lowest, 1 highest; clamped. Linear Rec.709.
    pub fn at(self, t: f32) -> Vec3 {
        let stops: &[u32] = match self {
            Self::Viridis => &VIRIDIS,
            Self::Alarm => &ALARM,
        };
        if !t.is_finite() {
            return NONE;
        }
        let place = t.clamp(0.0, 1.0) * (stops.len() - 1) as f32;
        let first = (place as usize).min(stops.len() - 2);
        // Between stops colours are mixed as roots, which is near enough to what displays do.
        let [a, b] = [0, 1].map(|k| swatch(stops[first + k]).map(f32::sqrt));
        let root = a.lerp(b, place - first as f32);
        root * root
    }
}

/// The loud colour of what is past a limit.
pub(crate) fn over() -> Vec3 {
    swatch(OVER)
}

/// A colour of Oklab (Ottosson 2020, "A perceptual color space for image processing") by lightness, chroma and hue in
/// turns; chroma shrinks until the colour can be shown.
fn oklch(lightness: f32, chroma: f32, hue: f32) -> Vec3 {
    let (sin, cos) = sin_cos_turns(hue);
    let mut chroma = chroma;
    loop {
        let (a, b) = (chroma * cos, chroma * sin);
        let l = lightness + 0.396_337_78 * a + 0.215_803_76 * b;
        let m = lightness - 0.105_561_346 * a - 0.063_854_17 * b;
        let s = lightness - 0.089_484_18 * a - 1.291_485_5 * b;
        let (l, m, s) = (l * l * l, m * m * m, s * s * s);
        let colour = Vec3::new(
            4.076_741_7 * l - 3.307_711_6 * m + 0.230_969_94 * s,
            -1.268_438 * l + 2.609_757_4 * m - 0.341_319_4 * s,
            -0.004_196_086_3 * l - 0.703_418_6 * m + 1.707_614_7 * s,
        );
        if chroma < 0.01 || (colour.min_element() >= 0.0 && colour.max_element() <= 1.0) {
            return colour.clamp(Vec3::ZERO, Vec3::ONE);
        }
        chroma *= 0.93;
    }
}

/// The colour of an id: hue from its bits, at one of four lightnesses. 0, which is no id, is grey.
pub(crate) fn of_id(id: u64) -> Vec3 {
    if id == 0 {
        return NONE;
    }
    let bits = mix(id ^ 0x5EED_C010_0B57_0001);
    let hue = (bits >> 40) as f32 / (1u64 << 24) as f32;
    let lightness = [0.52, 0.62, 0.72, 0.82][(bits & 3) as usize];
    oklch(lightness, if bits & 4 == 0 { 0.17 } else { 0.1 }, hue)
}

/// The colour of a small whole number: hues a golden turn apart, so that the first few are as far from each other as
/// they can be, and lightness that changes from one to the next.
pub(crate) fn of_number(number: i64) -> Vec3 {
    // 2^24 / golden ratio, in whole numbers, so that large numbers lose nothing.
    let turn = number.wrapping_mul(10_368_890).rem_euclid(1 << 24);
    let hue = turn as f32 / (1 << 24) as f32;
    oklch([0.72, 0.56, 0.82][number.rem_euclid(3) as usize], 0.15, hue + 0.08)
}

/// The colour of a direction: each axis from 0 (against it) to 1 (along it); no direction is grey.
pub(crate) fn of_direction(direction: Vec3) -> Vec3 {
    direction.try_normalize().map_or(NONE, |d| d * 0.5 + 0.5)
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use coif_nodes::maths::hair_colour::{absorption_of, colour_of};

    pub(crate) fn unpack_colour(word: u32) -> Vec3 {
        let root = [0, 8, 16].map(|at| (word >> at & 255) as f32 / 255.0);
        Vec3::from_array(root.map(|r| r * r))
    }
    pub(crate) fn unpack_absorption(word: u32) -> Vec3 {
        let (r, g, b) = (word & 2047, word >> 11 & 2047, word >> 22);
        let root = Vec3::new(r as f32 / 2047.0, g as f32 / 2047.0, b as f32 / 1023.0) * DEEPEST;
        root * root
    }
    pub(crate) fn luminance(c: Vec3) -> f32 {
        c.dot(Vec3::new(0.2126, 0.7152, 0.0722))
    }

    #[test]
    fn a_packed_colour_is_the_colour() {
        for k in 0..=64 {
            let x = k as f32 / 64.0;
            let colour = Vec3::new(x, x * x, 1.0 - x);
            let back = unpack_colour(pack_colour(colour));
            assert!((back - colour).abs().max_element() < 0.005, "{colour} {back}");
            let sigma = Vec3::new(x, 0.3 * x, 4.5 * x) * 4.5;
            let back = unpack_absorption(pack_absorption(sigma));
            assert!((back.map(f32::sqrt) - sigma.map(f32::sqrt)).abs().max_element() < 0.0023);
        }
        assert_eq!(unpack_absorption(pack_absorption(Vec3::splat(1e9))), Vec3::splat(20.25));
        assert_eq!(pack_absorption(Vec3::splat(-1.0)), 0);
        assert_eq!(unpack_colour(pack_colour(Vec3::splat(9.0))), Vec3::ONE);
    }

    #[test]
    fn a_colour_of_hair_comes_back_from_its_word() {
        for k in 1..=50 {
            let colour = Vec3::new(0.02, 0.01, 0.005) * k as f32;
            let sigma = unpack_absorption(pack_absorption(absorption_of(colour)));
            let back = colour_of(sigma);
            assert!(((back - colour) / colour).abs().max_element() < 0.014, "{colour} {back}");
        }
        assert_eq!(pack_absorption(absorption_of(Vec3::ONE)), 0);
        assert_eq!(pack_absorption(absorption_of(Vec3::ZERO)), u32::MAX);
    }

    #[test]
    fn ramps_change_lightness_one_way() {
        for (ramp, way) in [(Ramp::Viridis, 1.0), (Ramp::Alarm, -1.0)] {
            let at = |k: u32| luminance(ramp.at(k as f32 / 255.0)) * way;
            for k in 0..255 {
                assert!(at(k + 1) > at(k), "{ramp:?} {k}");
            }
            assert_eq!(ramp.at(-3.0), ramp.at(0.0));
            assert_eq!(ramp.at(7.0), ramp.at(1.0));
            assert_eq!(ramp.at(f32::NAN), NONE);
        }
        let end = Ramp::Viridis.at(1.0);
        assert!((end - swatch(0xFDE725)).abs().max_element() < 1e-6, "{end}");
    }

    #[test]
    fn ids_are_told_apart() {
        let apart = |a: Vec3, b: Vec3| (a.map(f32::sqrt) - b.map(f32::sqrt)).length();
        // The strands of a braid.
        for a in 0..9i64 {
            for b in 0..a {
                let d = apart(of_number(a), of_number(b));
                assert!(d > 0.12, "strands {a} and {b}: {d}");
            }
        }
        // Clusters: a given one looks like few others.
        let ids: Vec<Vec3> = (1..=400u64).map(of_id).collect();
        let alike: usize =
            ids.iter().map(|a| ids.iter().filter(|b| apart(*a, **b) < 0.04).count() - 1).sum();
        assert!(alike < 400 * 400 / 25, "{alike}");
        for colour in ids {
            assert!(colour.min_element() >= 0.0 && colour.max_element() <= 1.0);
            assert!((0.08..0.7).contains(&luminance(colour)), "{colour}");
        }
        assert_eq!(of_id(0), NONE);
    }

    #[test]
    fn swatches_are_srgb() {
        let c = swatch(0xFF8000);
        assert_eq!((c.x, c.z), (1.0, 0.0));
        assert!((c.y - 0.215_860_5).abs() < 1e-5, "{c}");
    }
}
