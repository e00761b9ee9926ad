//! What colours hair: pigment, the light that a fibre absorbs, and the colour that a head of such hair shows.
//!
//! Guarantees: the three agree with each other, for the renderer and every exported file use these functions only:
//! absorption is what pigment gives, colour is what absorption gives, and each way back returns what it
//! came from (relative 1e-4). Same bits on every machine.
//!
//! Not promised: that the colour is what a photograph shows. It is the fitted reflectance of hair so thick that nothing
//! shines through, without the highlights, at one fixed roughness.
//!
//! Absorption (`sigma`) is per fibre radius, one number for each of linear Rec.709's red, green and blue.

use super::transcendental::{exp, ln};
use glam::Vec3;

/// Azimuthal roughness that colours are fitted at.
pub const ROUGHNESS: f32 = 0.3;
/// The most absorption that a colour stands for: darker ones are taken as this dark.
pub const MOST: f32 = 20.25;
/// The part of its absorption that a grey hair keeps.
pub const GREY: f32 = 0.04;

/// Absorption of brown-black and of yellow-red pigment, per unit of pigment.
const EUMELANIN: Vec3 = Vec3::new(0.506, 0.841, 1.653);
const PHEOMELANIN: Vec3 = Vec3::new(0.343, 0.733, 1.924);

/// How much steeper colour falls with the root of absorption for a rougher or smoother fibre: the polynomial of Chiang,
/// Bitterli, Tappan, Burley 2016 ("A practical and controllable hair and fur model for production path tracing",
/// section 4.2), for an azimuthal roughness of 0 to 1.
pub fn steepness(roughness: f32) -> f32 {
    let b = roughness;
    5.969 + b * (-0.215 + b * (2.532 + b * (-10.73 + b * (5.574 + b * 0.245))))
}

/// Absorption of hair with `melanin` of 0 (white) to 1 (black), of which `redness` (0 to 1) is red pigment. Both are
/// clamped. The scale is that of the hair shaders of path tracers: 0.97 is black, 0.87 brown, 0.3 blond.
pub fn absorption_of_melanin(melanin: f32, redness: f32) -> Vec3 {
    let pigment = -ln((1.0 - melanin).clamp(1e-4, 1.0));
    EUMELANIN.lerp(PHEOMELANIN, redness.clamp(0.0, 1.0)) * pigment
}

/// Melanin and redness that absorb `sigma`, and by what share of it the nearest pigment misses it: 0 where pigment alone colours
/// the hair, much where dye does. The inverse of [`absorption_of_melanin`], by least squares; white hair has no redness.
pub fn pigment_of(sigma: Vec3) -> (f32, f32, f32) {
    let (e, p) = (EUMELANIN, PHEOMELANIN);
    let (ee, ep, pp) = (e.dot(e), e.dot(p), p.dot(p));
    let (es, ps) = (e.dot(sigma), p.dot(sigma));
    let det = ee * pp - ep * ep;
    let (brown, red) = (((es * pp - ps * ep) / det).max(0.0), ((ps * ee - es * ep) / det).max(0.0));
    // Where one of them would be less than nothing, the other alone is nearest.
    let (brown, red) = match (brown > 0.0, red > 0.0) {
        (true, false) => (es / ee, 0.0),
        (false, true) => (0.0, ps / pp),
        _ => (brown, red),
    };
    let pigment = brown + red;
    let missed = (e * brown + p * red).distance(sigma) / sigma.length().max(1e-3);
    let redness = if pigment > 1e-6 { red / pigment } else { 0.0 };
    (1.0 - exp(-pigment), redness, missed)
}

/// The colour, linear Rec.709, of hair that absorbs `sigma`; negative absorption is none.
pub fn colour_of(sigma: Vec3) -> Vec3 {
    let d = steepness(ROUGHNESS);
    let one = |s: f32| exp(-s.clamp(0.0, MOST).sqrt() * d);
    Vec3::new(one(sigma.x), one(sigma.y), one(sigma.z))
}

/// What hair of this colour absorbs: the inverse of [`colour_of`]. Colours above 1 absorb nothing, 0 absorbs [`MOST`].
pub fn absorption_of(colour: Vec3) -> Vec3 {
    let d = steepness(ROUGHNESS);
    // The root of the most absorption, which is the darkest colour's logarithm.
    let deepest = MOST.sqrt();
    let one = |c: f32| {
        let root = match c > 0.0 {
            true => (-ln(c.min(1.0)) / d).min(deepest),
            false => deepest,
        };
        root * root
    };
    Vec3::new(one(colour.x), one(colour.y), one(colour.z))
}

#[cfg(test)]
#[expect(clippy::disallowed_methods, reason = "what ours is compared with")]
mod tests {
    use super::*;

    #[track_caller]
    fn near(got: Vec3, want: Vec3) {
        let off = ((got - want) / want.max(Vec3::splat(1e-6))).abs().max_element();
        assert!(off < 1e-4, "{got} {want}");
    }

    #[test]
    fn pigment_is_found_again_in_what_it_absorbs_and_in_its_colour() {
        for melanin in [0.02, 0.3, 0.6, 0.87, 0.97] {
            for redness in [0.0, 0.1, 0.5, 0.9, 1.0] {
                let sigma = absorption_of_melanin(melanin, redness);
                for sigma in [sigma, absorption_of(colour_of(sigma))] {
                    let (m, r, missed) = pigment_of(sigma);
                    assert!((m - melanin).abs() < 1e-3, "{melanin} {redness}: {m}");
                    assert!((r - redness).abs() < 1e-2, "{melanin} {redness}: {r}");
                    assert!(missed < 1e-3, "{melanin} {redness}: {missed}");
                }
            }
        }
        // Blue is no pigment's colour; what absorbs nothing is white.
        assert!(pigment_of(absorption_of(Vec3::new(0.01, 0.02, 0.6))).2 > 0.3);
        assert_eq!(pigment_of(Vec3::ZERO), (0.0, 0.0, 0.0));
    }

    #[test]
    fn pigment_absorbs_as_the_published_numbers_say() {
        // A melanin of 1 - 1/e is one unit of pigment.
        let unit = 1.0 - (-1.0f32).exp();
        near(absorption_of_melanin(unit, 0.0), EUMELANIN);
        near(absorption_of_melanin(unit, 1.0), PHEOMELANIN);
        near(absorption_of_melanin(unit, 0.5), Vec3::new(0.4245, 0.787, 1.7885));
        near(absorption_of_melanin(0.99, 0.0), EUMELANIN * 2.0 * 10.0f32.ln());
        assert_eq!(absorption_of_melanin(0.0, 0.7), Vec3::ZERO);
        assert_eq!(absorption_of_melanin(-1.0, 0.0), Vec3::ZERO);
        near(absorption_of_melanin(1.0, 0.0), EUMELANIN * 4.0 * 10.0f32.ln());
    }

    #[test]
    fn the_fit_is_the_published_polynomial() {
        // By hand: 5.969 - .0645 + .22788 - .28971 + .0451494 + .00059535.
        assert!((steepness(0.3) - 5.888_415).abs() < 1e-5, "{}", steepness(0.3));
        assert!((steepness(0.0) - 5.969).abs() < 1e-6);
        assert!((steepness(1.0) - 3.375).abs() < 1e-5);
        // Where the root of absorption is 1/D, the colour is 1/e.
        let sigma = Vec3::splat(1.0 / (5.888_415f32 * 5.888_415));
        near(colour_of(sigma), Vec3::splat((-1.0f32).exp()));
    }

    #[test]
    fn colour_and_absorption_are_each_others_inverse() {
        for k in 0..=40 {
            let x = k as f32 / 40.0;
            for redness in [0.0, 0.4, 1.0] {
                let sigma = absorption_of_melanin(x, redness);
                near(absorption_of(colour_of(sigma)), sigma.min(Vec3::splat(MOST)));
            }
            let colour = Vec3::new(x.powi(6), x, x * x).max(Vec3::splat(1e-11));
            near(colour_of(absorption_of(colour)), colour);
        }
        assert_eq!(absorption_of(Vec3::ZERO), Vec3::splat(MOST));
        assert_eq!(absorption_of(Vec3::new(1.0, 2.0, -1.0)), Vec3::new(0.0, 0.0, MOST));
        assert_eq!(colour_of(Vec3::ZERO), Vec3::ONE);
    }
}
