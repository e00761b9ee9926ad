//! The values of curl types (methods.md 4): starting points that any value set on the node replaces.
//!
//! Sizes and pitches are estimates, to be replaced by measurements. The names `2a` to `4c` are aliases that stylists
//! use; they describe wavy, curly and coily hair and imply no ranking.

use super::shape_list_curl::Preset;
use crate::data::shapes::{ShapeList, Tier, TurnProfile};
use TurnProfile::{Circle, Ellipse, Lame, Polygon, Rose};

/// Everything that a preset fills in.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct PresetValues {
    pub(crate) shapes: ShapeList,
    /// Fraction of turns with a profile of tier A, 0 to 1.
    pub(crate) uniformity: f32,
    /// Ratio of tier B to tier C.
    pub(crate) b_to_c: f32,
    /// cm: twice the RMS radius.
    pub(crate) diameter: f32,
    /// Length of source per turn, cm.
    pub(crate) pitch: f32,
    /// Smallest radius of a corner, in RMS radii.
    pub(crate) rounding: f32,
    /// Fraction of a turn over which it blends into the next.
    pub(crate) blend: f32,
    /// Fraction of turns that are Z-bends.
    pub(crate) z_bends: f32,
    /// Fraction of turns before which the direction reverses.
    pub(crate) switchbacks: f32,
    /// Fraction of turns that are nearly straight.
    pub(crate) skipped: f32,
    /// How closely the hairs of a clump follow one curl.
    pub(crate) definition: f32,
    /// R(A, F, P, O): per-turn ranges, as fractions of amplitude and frequency, in turns, and in amplitudes.
    pub(crate) ranges: [f32; 4],
    /// Turns over which the curl grows to its full size.
    pub(crate) rise: f32,
    /// Variation of clumps in size and pitch over the head.
    pub(crate) spread: f32,
}

impl Preset {
    /// The preset's values.
    pub(crate) fn numbers(self) -> PresetValues {
        // Half-height over RMS radius of a flat wave is the square root of 2.
        let wave = |half_height: f32| 2.0 * half_height * std::f32::consts::FRAC_1_SQRT_2;
        let rose = |petals, depth| Rose { petals, depth };
        let (a, b, c) = (Tier::A, Tier::B, Tier::C);
        let list = |shapes: &[(Tier, TurnProfile)]| ShapeList(shapes.to_vec());
        let plain = PresetValues {
            shapes: list(&[(a, Circle)]),
            uniformity: 1.0,
            b_to_c: 4.0,
            diameter: 1.0,
            pitch: 1.5,
            rounding: 0.05,
            blend: 0.5,
            z_bends: 0.0,
            switchbacks: 0.0,
            skipped: 0.0,
            definition: 1.0,
            ranges: [0.0; 4],
            rise: 1.5,
            spread: 0.2,
        };
        let wavy = |half_height, pitch, ratio, uniformity, definition| PresetValues {
            shapes: list(&[(a, Ellipse(ratio)), (b, Circle), (c, Lame(3.0))]),
            b_to_c: 9.0,
            diameter: wave(half_height),
            pitch,
            uniformity,
            definition,
            blend: 1.0,
            rise: 0.5,
            ranges: [0.25, 0.15, 0.04, 0.1],
            ..plain.clone()
        };
        let curly = |diameter, pitch, uniformity, definition| PresetValues {
            shapes: list(&[(a, Circle), (b, Ellipse(0.7)), (c, Lame(3.0))]),
            diameter,
            pitch,
            uniformity,
            definition,
            blend: 0.7,
            rise: 0.75,
            ranges: [0.12, 0.1, 0.03, 0.08],
            ..plain.clone()
        };
        let coily = |diameter, pitch, uniformity, definition| PresetValues {
            shapes: list(&[(a, Polygon(3)), (a, Polygon(4)), (a, Polygon(5)), (b, Circle)]),
            b_to_c: 2.0,
            diameter,
            pitch,
            uniformity,
            definition,
            rise: 2.0,
            ..plain.clone()
        };
        match self {
            Preset::Custom => plain,
            Preset::Type2a => wavy(0.6, 8.0, 0.05, 0.9, 0.75),
            Preset::Type2b => wavy(0.7, 6.0, 0.1, 0.85, 0.8),
            Preset::Type2c => wavy(0.8, 4.0, 0.25, 0.8, 0.85),
            Preset::Type3a => curly(2.5, 6.0, 0.85, 0.93),
            Preset::Type3b => curly(1.5, 3.0, 0.8, 0.92),
            Preset::Type3c => PresetValues {
                shapes: list(&[
                    (a, Circle),
                    (a, Ellipse(0.7)),
                    (b, Polygon(4)),
                    (b, Polygon(5)),
                    (c, rose(3, 0.25)),
                ]),
                rounding: 0.3,
                rise: 1.25,
                ranges: [0.15, 0.12, 0.04, 0.12],
                switchbacks: 0.02,
                ..curly(0.8, 1.4, 0.75, 0.88)
            },
            Preset::Type4a => {
                let mut numbers = PresetValues {
                    rounding: 0.35,
                    ranges: [0.15, 0.12, 0.04, 0.15],
                    switchbacks: 0.04,
                    ..coily(0.5, 0.7, 0.8, 0.85)
                };
                numbers.shapes.0.push((c, rose(3, 0.3)));
                numbers
            }
            Preset::Type4b => PresetValues {
                shapes: list(&[
                    (a, Lame(0.7)),
                    (b, Polygon(3)),
                    (b, Polygon(4)),
                    (c, rose(3, 0.4)),
                ]),
                rounding: 0.2,
                blend: 0.35,
                z_bends: 0.6,
                switchbacks: 0.2,
                skipped: 0.06,
                ranges: [0.25, 0.2, 0.05, 0.25],
                ..coily(0.4, 0.45, 0.75, 0.5)
            },
            Preset::Type4c => PresetValues {
                shapes: list(&[
                    (a, Polygon(5)),
                    (b, Polygon(3)),
                    (b, Polygon(4)),
                    (c, rose(3, 0.5)),
                    (c, rose(2, 0.5)),
                ]),
                rounding: 0.4,
                blend: 0.85,
                z_bends: 0.5,
                switchbacks: 0.35,
                skipped: 0.15,
                ranges: [0.4, 0.35, 0.1, 0.5],
                spread: 0.35,
                ..coily(0.3, 0.25, 0.6, 0.1)
            },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::Preset;
    use crate::curl::shape_list_curl::NODE;
    use crate::define::{Type, choice_name};

    #[test]
    fn presets_are_shown_by_their_own_sizes() {
        let Type::Choice(words) = NODE.input("preset").unwrap().1.ty else { panic!() };
        let all = [
            Preset::Type2a,
            Preset::Type2b,
            Preset::Type2c,
            Preset::Type3a,
            Preset::Type3b,
            Preset::Type3c,
            Preset::Type4a,
            Preset::Type4b,
            Preset::Type4c,
        ];
        assert_eq!(words.len(), 1 + all.len());
        assert_eq!(choice_name(words[0].0, words[0].1.trim()), "custom");
        for ((word, tip), preset) in words[1..].iter().zip(all) {
            let numbers = preset.numbers();
            // A wave is described by its height, from crest to trough.
            let wide = if word.starts_with('2') { 2f32.sqrt() } else { 1.0 } * numbers.diameter;
            let name = choice_name(word, tip.trim());
            let mm = |cm: f32| (cm * 100.0).round() / 10.0;
            let sizes = [format!(" {} mm ", mm(wide)), format!(" {} mm ", mm(numbers.pitch))];
            assert!(
                sizes.iter().all(|size| format!("{name} ").contains(size)),
                "{name}: {sizes:?}"
            );
            assert!(name.starts_with(&format!("{word}: ")), "{name}");
        }
    }
}
