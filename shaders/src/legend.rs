//! The legend of a heat map, drawn into a finished picture: a colour bar with its name, its unit and three numbers.
//!
//! Letters are a small bitmap font of our own. Guarantees: the same pixels for the same legend and size; nothing is drawn
//! outside the picture, and nothing at all where the legend does not fit. Not promised: that the bar's colours are those of the hair,
//! for hair is lit and goes through the display transform; the bar shows the ramp as it is.

use crate::display::Transform;
use crate::view::{Legend, over};
use glam::Vec3;

/// Size of a letter and the room from one to the next, font pixels.
const LETTER: [usize; 2] = [5, 7];
const ADVANCE: usize = 6;
/// How far letters with a tail hang under the line, font pixels.
const DESCENT: usize = 2;
/// Font pixels around the legend and within its panel.
const MARGIN: usize = 6;
/// Size of the bar, font pixels.
const BAR: [usize; 2] = [120, 8];
/// What of the picture is left under the panel, and the panel's and the letters' own value.
const LEFT: f32 = 0.25;
const PANEL: f32 = 16.0;
const INK: u8 = 235;

/// Draws the legend into the lower left corner of a display-encoded picture of `width` x `height` pixels, four bytes each (red,
/// green, blue, alpha; rows from the top). Returns whether it fitted.
///
/// # Panics
/// When `rgba` does not hold that many pixels.
pub fn draw(rgba: &mut [u8], width: usize, height: usize, legend: &Legend) -> bool {
    assert_eq!(rgba.len(), width * height * 4, "four bytes a pixel");
    let title = match legend.unit.as_str() {
        "" => legend.name.clone(),
        unit => format!("{} ({unit})", legend.name),
    };
    let above = legend.limit.map(|limit| format!("> {}", number(limit)));
    let beside = above.as_ref().map_or(0, |text| MARGIN + BAR[1] + 3 + wide(text));
    let inner = [(BAR[0] + beside).max(wide(&title)), LETTER[1] + 4 + BAR[1] + 3 + LETTER[1]];
    let panel = inner.map(|n| n + 2 * MARGIN);
    let fits = |scale: usize| {
        (panel[0] + 2 * MARGIN) * scale <= width && (panel[1] + 2 * MARGIN) * scale <= height
    };
    // A letter is 14 pixels high in a picture of 720 rows.
    let wanted = ((height + 180) / 360).max(1);
    let Some(scale) = (1..=wanted).rev().find(|scale| fits(*scale)) else { return false };
    let mut canvas = Canvas { rgba, width, scale, left: 0, top: 0 };
    canvas.left = MARGIN * scale;
    canvas.top = height - (panel[1] + MARGIN) * scale;
    for y in 0..panel[1] {
        for x in 0..panel[0] {
            canvas.mix(x, y);
        }
    }
    let row = MARGIN;
    canvas.text(MARGIN, row, &title);
    let row = row + LETTER[1] + 4;
    for x in 0..BAR[0] {
        let colour = encoded(legend.ramp.at(x as f32 / (BAR[0] - 1) as f32));
        (0..BAR[1]).for_each(|y| canvas.fill(MARGIN + x, row + y, colour));
    }
    if let Some(text) = &above {
        let left = MARGIN + BAR[0] + MARGIN;
        for (x, y) in (0..BAR[1]).flat_map(|x| (0..BAR[1]).map(move |y| (x, y))) {
            canvas.fill(left + x, row + y, encoded(over()));
        }
        canvas.text(left + BAR[1] + 3, row, text);
    }
    let row = row + BAR[1] + 3;
    let (low, high) = (number(legend.lowest), number(legend.highest));
    let middle = number(0.5 * (legend.lowest + legend.highest));
    let centre = MARGIN + (BAR[0] - wide(&middle).min(BAR[0])) / 2;
    let right = MARGIN + BAR[0] - wide(&high).min(BAR[0]);
    canvas.text(MARGIN, row, &low);
    // Long numbers at the ends take the middle's room.
    if MARGIN + wide(&low) + 4 <= centre && centre + wide(&middle) + 4 <= right {
        canvas.text(centre, row, &middle);
    }
    canvas.text(right, row, &high);
    true
}

fn encoded(colour: Vec3) -> [u8; 3] {
    Transform::Srgb.apply(colour).to_array().map(|c| (c * 255.0).round() as u8)
}

/// Width of a text, font pixels.
fn wide(text: &str) -> usize {
    (text.chars().count() * ADVANCE).saturating_sub(ADVANCE - LETTER[0])
}

/// A number in three significant digits, without an exponent where it can be read without.
fn number(x: f32) -> String {
    if x == 0.0 || !x.is_finite() {
        return if x == 0.0 { "0".to_owned() } else { "-".to_owned() };
    }
    let digits = x.abs().log10().floor() as i32;
    if !(-4..6).contains(&digits) {
        return format!("{x:.1e}");
    }
    let after = (2 - digits).max(0) as usize;
    let text = format!("{x:.after$}");
    match text.contains('.') {
        true => text.trim_end_matches('0').trim_end_matches('.').to_owned(),
        false => text,
    }
}

/// A picture and the place in it where font pixels begin.
struct Canvas<'a> {
    rgba: &'a mut [u8],
    width: usize,
    scale: usize,
    left: usize,
    top: usize,
}

impl Canvas<'_> {
    /// All bytes of the pixels that a font pixel covers.
    fn each(&mut self, x: usize, y: usize, mut to: impl FnMut(&mut [u8])) {
        for row in 0..self.scale {
            let start = (self.top + y * self.scale + row) * self.width + self.left + x * self.scale;
            for pixel in self.rgba[start * 4..(start + self.scale) * 4].chunks_exact_mut(4) {
                to(pixel);
            }
        }
    }
    fn fill(&mut self, x: usize, y: usize, colour: [u8; 3]) {
        self.each(x, y, |pixel| {
            pixel[..3].copy_from_slice(&colour);
            pixel[3] = 255;
        });
    }
    /// Darkens what is there, so that letters can be read on any picture.
    fn mix(&mut self, x: usize, y: usize) {
        self.each(x, y, |pixel| {
            for value in &mut pixel[..3] {
                *value = (f32::from(*value) * LEFT + PANEL * (1.0 - LEFT)).round() as u8;
            }
            pixel[3] = 255;
        });
    }
    fn text(&mut self, x: usize, y: usize, text: &str) {
        for (k, letter) in text.chars().enumerate() {
            let lower = if "gpqy".contains(letter.to_ascii_lowercase()) { DESCENT } else { 0 };
            for (row, bits) in glyph(letter).into_iter().enumerate() {
                for column in 0..LETTER[0] {
                    if bits >> (LETTER[0] - 1 - column) & 1 == 1 {
                        self.fill(x + k * ADVANCE + column, y + lower + row, [INK; 3]);
                    }
                }
            }
        }
    }
}

/// Seven rows of five pixels, the left one the highest bit. Capitals are drawn small; what has no letter is a frame.
fn glyph(letter: char) -> [u8; 7] {
    match letter.to_ascii_lowercase() {
        ' ' => [0; 7],
        'a' => [0, 0, 0b01110, 0b00001, 0b01111, 0b10001, 0b01111],
        'b' => [0b10000, 0b10000, 0b10110, 0b11001, 0b10001, 0b10001, 0b11110],
        'c' => [0, 0, 0b01110, 0b10001, 0b10000, 0b10001, 0b01110],
        'd' => [0b00001, 0b00001, 0b01101, 0b10011, 0b10001, 0b10001, 0b01111],
        'e' => [0, 0, 0b01110, 0b10001, 0b11111, 0b10000, 0b01110],
        'f' => [0b00110, 0b01001, 0b01000, 0b11100, 0b01000, 0b01000, 0b01000],
        'g' => [0b01111, 0b10001, 0b10001, 0b10001, 0b01111, 0b00001, 0b01110],
        'h' => [0b10000, 0b10000, 0b10110, 0b11001, 0b10001, 0b10001, 0b10001],
        'i' => [0b00100, 0, 0b01100, 0b00100, 0b00100, 0b00100, 0b01110],
        'j' => [0b00010, 0, 0b00110, 0b00010, 0b00010, 0b10010, 0b01100],
        'k' => [0b10000, 0b10000, 0b10010, 0b10100, 0b11000, 0b10100, 0b10010],
        'l' => [0b01100, 0b00100, 0b00100, 0b00100, 0b00100, 0b00100, 0b01110],
        'm' => [0, 0, 0b11010, 0b10101, 0b10101, 0b10001, 0b10001],
        'n' => [0, 0, 0b10110, 0b11001, 0b10001, 0b10001, 0b10001],
        'o' => [0, 0, 0b01110, 0b10001, 0b10001, 0b10001, 0b01110],
        'p' => [0b11110, 0b10001, 0b10001, 0b10001, 0b11110, 0b10000, 0b10000],
        'q' => [0b01111, 0b10001, 0b10001, 0b10001, 0b01111, 0b00001, 0b00001],
        'r' => [0, 0, 0b10110, 0b11001, 0b10000, 0b10000, 0b10000],
        's' => [0, 0, 0b01111, 0b10000, 0b01110, 0b00001, 0b11110],
        't' => [0b01000, 0b01000, 0b11100, 0b01000, 0b01000, 0b01001, 0b00110],
        'u' => [0, 0, 0b10001, 0b10001, 0b10001, 0b10011, 0b01101],
        'v' => [0, 0, 0b10001, 0b10001, 0b10001, 0b01010, 0b00100],
        'w' => [0, 0, 0b10001, 0b10001, 0b10101, 0b10101, 0b01010],
        'x' => [0, 0, 0b10001, 0b01010, 0b00100, 0b01010, 0b10001],
        'y' => [0b10001, 0b10001, 0b10001, 0b10011, 0b01101, 0b00001, 0b01110],
        'z' => [0, 0, 0b11111, 0b00010, 0b00100, 0b01000, 0b11111],
        '0' => [0b01110, 0b10001, 0b10011, 0b10101, 0b11001, 0b10001, 0b01110],
        '1' => [0b00100, 0b01100, 0b00100, 0b00100, 0b00100, 0b00100, 0b01110],
        '2' => [0b01110, 0b10001, 0b00001, 0b00010, 0b00100, 0b01000, 0b11111],
        '3' => [0b11111, 0b00010, 0b00100, 0b00010, 0b00001, 0b10001, 0b01110],
        '4' => [0b00010, 0b00110, 0b01010, 0b10010, 0b11111, 0b00010, 0b00010],
        '5' => [0b11111, 0b10000, 0b11110, 0b00001, 0b00001, 0b10001, 0b01110],
        '6' => [0b00110, 0b01000, 0b10000, 0b11110, 0b10001, 0b10001, 0b01110],
        '7' => [0b11111, 0b00001, 0b00010, 0b00100, 0b01000, 0b01000, 0b01000],
        '8' => [0b01110, 0b10001, 0b10001, 0b01110, 0b10001, 0b10001, 0b01110],
        '9' => [0b01110, 0b10001, 0b10001, 0b01111, 0b00001, 0b00010, 0b01100],
        '.' => [0, 0, 0, 0, 0, 0b01100, 0b01100],
        ',' => [0, 0, 0, 0, 0b01100, 0b00100, 0b01000],
        '-' => [0, 0, 0, 0b01110, 0, 0, 0],
        '+' => [0, 0b00100, 0b00100, 0b11111, 0b00100, 0b00100, 0],
        '/' => [0, 0b00001, 0b00010, 0b00100, 0b01000, 0b10000, 0],
        '_' => [0, 0, 0, 0, 0, 0, 0b11111],
        ':' => [0, 0b01100, 0b01100, 0, 0b01100, 0b01100, 0],
        '(' => [0b00010, 0b00100, 0b01000, 0b01000, 0b01000, 0b00100, 0b00010],
        ')' => [0b01000, 0b00100, 0b00010, 0b00010, 0b00010, 0b00100, 0b01000],
        '>' => [0b01000, 0b00100, 0b00010, 0b00001, 0b00010, 0b00100, 0b01000],
        '%' => [0b11000, 0b11001, 0b00010, 0b00100, 0b01000, 0b10011, 0b00011],
        _ => [0b11111, 0b10001, 0b10001, 0b10001, 0b10001, 0b10001, 0b11111],
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::view::Ramp;
    use std::collections::BTreeSet;

    fn length() -> Legend {
        Legend {
            name: "length".into(),
            unit: "cm".into(),
            lowest: 1.5,
            highest: 42.0,
            ramp: Ramp::Viridis,
            limit: None,
        }
    }

    #[test]
    fn numbers_are_short() {
        for (x, want) in [
            (0.0, "0"),
            (1.5, "1.5"),
            (41.96, "42"),
            (255.0, "255"),
            (0.008, "0.008"),
            (0.001_234, "0.00123"),
            (-3.25, "-3.25"),
            (12_345.6, "12346"),
            (1e-7, "1.0e-7"),
            (3e9, "3.0e9"),
            (f32::NAN, "-"),
        ] {
            assert_eq!(number(x), want);
        }
    }

    #[test]
    fn the_bar_runs_through_the_ramp_in_its_corner() {
        let (width, height) = (1280, 720);
        let mut rgba = vec![200u8; width * height * 4];
        assert!(draw(&mut rgba, width, height, &length()));
        let at = |x: usize, y: usize| &rgba[(y * width + x) * 4..][..3];
        // Two screen pixels a font pixel: the bar starts two margins in, and its row is found by its colour.
        let left = 4 * MARGIN;
        let row = (0..height).find(|y| at(left, *y) == encoded(Ramp::Viridis.at(0.0))).unwrap();
        assert_eq!(at(left + BAR[0] * 2 - 1, row), encoded(Ramp::Viridis.at(1.0)));
        assert_eq!(at(left, row + BAR[1] * 2 - 1), encoded(Ramp::Viridis.at(0.0)));
        let changed: Vec<usize> = (0..width * height).filter(|i| rgba[i * 4] != 200).collect();
        assert!(changed.iter().all(|i| i % width < 320 && i / width > 600), "a corner");
        assert!(changed.len() > 10_000);
    }

    #[test]
    fn a_picture_that_is_too_small_stays_as_it_is() {
        for (width, height) in [(0, 0), (1, 1), (140, 700), (700, 30)] {
            let mut rgba = vec![9u8; width * height * 4];
            assert!(!draw(&mut rgba, width, height, &length()), "{width} x {height}");
            assert!(rgba.iter().all(|v| *v == 9));
        }
        // Where letters of the usual size do not fit, smaller ones may.
        let mut rgba = vec![9u8; 200 * 720 * 4];
        assert!(draw(&mut rgba, 200, 720, &length()));
    }

    #[test]
    fn long_names_limits_and_odd_letters_are_drawn() {
        let legend = Legend {
            name: "a_very_long_attribute_name_of_one's_own \u{1F9D1}".into(),
            limit: Some(255.0),
            lowest: -1.0e-20,
            highest: f32::NAN,
            ..length()
        };
        let mut rgba = vec![0u8; 1280 * 720 * 4];
        assert!(draw(&mut rgba, 1280, 720, &legend));
        let loud = encoded(over());
        assert!(rgba.chunks_exact(4).any(|pixel| pixel[..3] == loud));
    }

    #[test]
    fn every_letter_differs_from_every_other() {
        let letters = "abcdefghijklmnopqrstuvwxyz0123456789.,-+/_:()>% ?";
        let shapes: BTreeSet<[u8; 7]> = letters.chars().map(glyph).collect();
        assert_eq!(shapes.len(), letters.len());
    }
}
