//! Numbers as people type and read them: units, arithmetic, and the limits of an input.
//!
//! A number field shows one unit (millimetres where an input is small, percent for ratios); a bare number means that
//! unit, every other unit of the same kind can be typed. Documents hold cm, degrees and fractions of one: what this
//! module returns is in those. It never returns what is not finite, and reads any text in time linear in its length.

use crate::words::shortest;
use coif_nodes::define::{InputDef, Type, Unit};

/// The longest text that is read; arithmetic is short.
const LONGEST: usize = 200;
/// The deepest nesting of brackets and signs.
const DEEPEST: usize = 32;

/// How the numbers of an input are shown, stepped and limited.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Scale {
    unit: Unit,
    /// The shown unit in units of the document: 0.1 where millimetres are shown.
    shown: f64,
    suffix: &'static str,
    /// Where the slider ends, in document units; none where no end is known.
    pub(crate) slider: Option<(f64, f64)>,
    /// Values outside are clamped.
    pub(crate) hard: Option<(f64, f64)>,
    /// Only whole numbers.
    pub(crate) whole: bool,
}

/// What was typed: a number, or a change of the one there is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum NumberEdit {
    /// This number, in document units.
    Set(f64),
    /// `+=` and `-=`.
    Add(f64),
    /// `*=` and `/=`.
    Times(f64),
}

impl NumberEdit {
    /// The new number, where `old` was.
    pub(crate) fn apply(self, old: f64) -> f64 {
        match self {
            NumberEdit::Set(x) => x,
            NumberEdit::Add(x) => old + x,
            NumberEdit::Times(x) => old * x,
        }
    }
}

impl Scale {
    /// For the numbers of an input.
    pub(crate) fn of(def: &InputDef) -> Self {
        Self::new(def.unit, def.soft.or(def.hard), def.hard, def.ty == Type::Int)
    }

    /// For numbers of a unit.
    pub(crate) fn new(
        unit: Unit,
        slider: Option<(f64, f64)>,
        hard: Option<(f64, f64)>,
        whole: bool,
    ) -> Self {
        let small = slider.is_some_and(|(lo, hi)| lo.abs().max(hi.abs()) <= 1.0);
        let (shown, suffix) = match unit {
            Unit::Length if small => (0.1, " mm"),
            Unit::Length => (1.0, " cm"),
            Unit::Angle => (1.0, "°"),
            Unit::Ratio => (0.01, " %"),
            Unit::PerCm => (1.0, " /cm"),
            Unit::PerCm2 => (1.0, " /cm²"),
            Unit::AnglePerCm => (1.0, "°/cm"),
            Unit::None | Unit::Count => (1.0, ""),
        };
        Self { unit, shown, suffix, slider, hard, whole }
    }

    /// The number as the field shows it: at most three digits that count, whole numbers whole, with its unit.
    pub(crate) fn text(&self, x: f64) -> String {
        let digits = if self.whole { 19 } else { 3 };
        format!("{}{}", shortest(x / self.shown, digits), self.suffix)
    }

    /// The number as the field shows it while it is typed: every digit that counts.
    pub(crate) fn exact(&self, x: f64) -> String {
        // Seven digits are what an f32 tells apart; whole numbers are told in full.
        let digits = if self.whole { 19 } else { 7 };
        format!("{}{}", shortest(x / self.shown, digits), self.suffix)
    }

    /// A range in the shown unit.
    pub(crate) fn range(&self, (lo, hi): (f64, f64)) -> String {
        format!(
            "{} to {}{}",
            shortest(lo / self.shown, 7),
            shortest(hi / self.shown, 7),
            self.suffix
        )
    }

    /// The step of one nudge: a round number in the shown unit, a hundredth of the slider or less; 1 for whole numbers.
    pub(crate) fn step(&self, x: f64) -> f64 {
        if self.whole {
            return 1.0;
        }
        let span = match self.slider {
            Some((lo, hi)) if hi > lo && (hi - lo).is_finite() => hi - lo,
            _ => x.abs().max(1.0 * self.shown) * 10.0,
        };
        let step = 10f64.powf((span / self.shown / 100.0).log10().floor()) * self.shown;
        if step.is_finite() && step > 0.0 { step } else { self.shown }
    }

    /// `x` on the grid of `step`.
    pub(crate) fn snap(&self, x: f64, step: f64) -> f64 {
        let x = if self.whole { x.round() } else { (x / step).round() * step };
        // The grid's own rounding shows in the sixth digit of small units.
        if self.whole {
            x
        } else {
            shortest(x / self.shown, 9).parse::<f64>().unwrap_or(x) * self.shown
        }
    }

    /// `x` within the hard range, and what to say when it was not.
    pub(crate) fn clamp(&self, x: f64) -> (f64, Option<String>) {
        let rounded = if self.whole { x.round() } else { x };
        let (lo, hi) = self.hard.unwrap_or((f64::from(f32::MIN), f64::from(f32::MAX)));
        let y = rounded.max(lo).min(hi);
        let said = if y != rounded {
            let (side, end) = if y > rounded { ("below", lo) } else { ("above", hi) };
            Some(format!("{} is {side} {}, which is used", self.text(rounded), self.text(end)))
        } else if rounded != x {
            Some(format!("{} is no whole number, {} is used", self.text(x), self.text(y)))
        } else {
            None
        };
        (y, said)
    }

    /// Reads what was typed. The error says what is wrong with it, without a full stop.
    pub(crate) fn read(&self, text: &str) -> Result<NumberEdit, String> {
        if text.len() > LONGEST {
            return Err("the text is too long for a number".to_owned());
        }
        let mut rest = text.trim();
        let relative = ["+=", "-=", "*=", "/="].into_iter().find(|sign| rest.starts_with(sign));
        rest = rest[relative.map_or(0, str::len)..].trim_end();
        for ending in self.endings() {
            rest = rest.strip_suffix(ending).map_or(rest, str::trim_end);
        }
        let mut parser = Parser { scale: self, rest: rest.trim_start() };
        let Quantity { x, with_unit, .. } = parser.sum(0)?;
        if !parser.rest.is_empty() {
            return Err(format!("{:?} was not expected", short(parser.rest)));
        }
        let in_units = if with_unit { x } else { x * self.shown };
        let entry = match relative {
            None => NumberEdit::Set(in_units),
            Some("+=") => NumberEdit::Add(in_units),
            Some("-=") => NumberEdit::Add(-in_units),
            Some(sign) if with_unit && self.unit != Unit::Ratio => {
                return Err(format!("{sign} takes a plain number"));
            }
            Some("*=") => NumberEdit::Times(x),
            Some(_) => NumberEdit::Times(1.0 / x),
        };
        let (NumberEdit::Set(y) | NumberEdit::Add(y) | NumberEdit::Times(y)) = entry;
        if y.is_finite() { Ok(entry) } else { Err("the result is not a finite number".to_owned()) }
    }

    /// Endings that say the unit the field has anyway, and that arithmetic would take for division.
    fn endings(&self) -> &'static [&'static str] {
        match self.unit {
            Unit::PerCm | Unit::AnglePerCm => &["/cm", "per cm"],
            Unit::PerCm2 => &["/cm²", "/cm2", "per cm2", "per cm²"],
            _ => &[],
        }
    }

    /// The unit of this word in document units, where it is one of this field's kind.
    fn unit_of(&self, word: &str) -> Option<f64> {
        Some(match (self.unit, word) {
            (Unit::Length, "um" | "µm" | "μm") => 1e-4,
            (Unit::Length, "mm") => 0.1,
            (Unit::Length, "cm") => 1.0,
            (Unit::Length, "m") => 100.0,
            (Unit::Length, "in" | "inch" | "inches" | "\"") => 2.54,
            (Unit::Length, "ft" | "'") => 30.48,
            (Unit::Angle | Unit::AnglePerCm, "deg" | "degree" | "degrees" | "°") => 1.0,
            (Unit::Angle | Unit::AnglePerCm, "rad" | "radians") => 1f64.to_degrees(),
            (Unit::Angle | Unit::AnglePerCm, "turn" | "turns") => 360.0,
            (Unit::Ratio, "%" | "percent") => 0.01,
            _ => return None,
        })
    }
}

fn short(text: &str) -> String {
    text.chars().take(20).collect()
}

#[derive(Clone, Copy)]
struct Quantity {
    x: f64,
    /// Whether `x` is in document units; else it is a plain number.
    with_unit: bool,
    /// The unit it was written in, in document units.
    unit: f64,
}

struct Parser<'a> {
    scale: &'a Scale,
    /// What is left, without spaces at its start.
    rest: &'a str,
}

impl Parser<'_> {
    fn take(&mut self, any_of: &[char]) -> Option<char> {
        let c = self.rest.chars().next().filter(|c| any_of.contains(c))?;
        self.rest = self.rest[c.len_utf8()..].trim_start();
        Some(c)
    }

    fn sum(&mut self, depth: usize) -> Result<Quantity, String> {
        let mut sum = self.product(depth)?;
        while let Some(sign) = self.take(&['+', '-', '−']) {
            let mut part = self.product(depth)?;
            // Next to a number with a unit, a bare one has the unit that the field shows.
            if sum.with_unit != part.with_unit {
                let bare = if sum.with_unit { &mut part } else { &mut sum };
                bare.x *= self.scale.shown;
                bare.with_unit = true;
            }
            sum.x += if sign == '+' { part.x } else { -part.x };
        }
        Ok(sum)
    }

    fn product(&mut self, depth: usize) -> Result<Quantity, String> {
        let mut product = self.factor(depth)?;
        while let Some(sign) = self.take(&['*', '/', '×', '÷']) {
            let by = self.factor(depth)?;
            let times = matches!(sign, '*' | '×');
            let ratio = self.scale.unit == Unit::Ratio;
            match (times, product.with_unit, by.with_unit) {
                (true, true, true) if !ratio => {
                    return Err("two numbers with units cannot be multiplied".to_owned());
                }
                // A quarter turn, a third of a millimetre: what else could 1/4 turn mean?
                (false, false, true) if !ratio => {
                    let scalar = by.x / by.unit;
                    product = Quantity { x: product.x / scalar * by.unit, ..by };
                    continue;
                }
                (true, a, b) => product.with_unit = a || b,
                (false, a, b) => product.with_unit = if ratio { a || b } else { a && !b },
            }
            product.x = if times { product.x * by.x } else { product.x / by.x };
        }
        Ok(product)
    }

    fn factor(&mut self, depth: usize) -> Result<Quantity, String> {
        if depth >= DEEPEST {
            return Err("brackets are nested too deep".to_owned());
        }
        let mut quantity = if let Some(sign) = self.take(&['-', '−', '+']) {
            let inner = self.factor(depth + 1)?;
            return Ok(Quantity { x: if sign == '+' { inner.x } else { -inner.x }, ..inner });
        } else if self.take(&['(']).is_some() {
            let inner = self.sum(depth + 1)?;
            self.take(&[')']).ok_or("a closing bracket is missing")?;
            inner
        } else if let Some(rest) = self.rest.strip_prefix("pi").or(self.rest.strip_prefix('π')) {
            self.rest = rest.trim_start();
            Quantity { x: std::f64::consts::PI, with_unit: false, unit: 1.0 }
        } else {
            Quantity { x: self.digits()?, with_unit: false, unit: 1.0 }
        };
        if let Some(word) = self.word() {
            // Percent is a plain number wherever it is not the field's own unit.
            let unit = match self.scale.unit_of(word) {
                None if word == "%" => 0.01,
                Some(unit) if !quantity.with_unit => {
                    (quantity.with_unit, quantity.unit) = (true, unit);
                    unit
                }
                Some(_) => return Err(format!("{word} stands behind a number that has a unit")),
                None => return Err(format!("{} is no unit here", short(word))),
            };
            quantity.x *= unit;
            self.rest = self.rest[word.len()..].trim_start();
        }
        Ok(quantity)
    }

    /// The unit that comes next, letters or one sign.
    fn word(&self) -> Option<&str> {
        let letters = self.rest.find(|c: char| !c.is_alphabetic()).unwrap_or(self.rest.len());
        let sign = self.rest.chars().next().filter(|c| ['%', '°', '"', '\''].contains(c));
        match (letters, sign) {
            (0, Some(sign)) => Some(&self.rest[..sign.len_utf8()]),
            (0, None) => None,
            (n, _) => Some(&self.rest[..n]),
        }
    }

    fn digits(&mut self) -> Result<f64, String> {
        let text = self.rest;
        let mut end = text
            .find(|c: char| !(c.is_ascii_digit() || c == '.' || c == ','))
            .unwrap_or(text.len());
        // An exponent, where digits follow it.
        let tail = &text[end..];
        let exponent = tail.strip_prefix(['e', 'E']).map(|t| {
            let sign = usize::from(t.starts_with(['+', '-']));
            let digits = t[sign..].find(|c: char| !c.is_ascii_digit()).unwrap_or(t.len() - sign);
            (sign, digits)
        });
        if let Some((sign, digits @ 1..)) = exponent.filter(|_| end > 0) {
            end += 1 + sign + digits;
        }
        if end == 0 {
            return Err(match text {
                "" => "a number is missing".to_owned(),
                _ => format!("{} is no number", short(text)),
            });
        }
        let number = text[..end].replace(',', ".");
        let x = number.parse().map_err(|_| format!("{} is no number", short(&text[..end])))?;
        self.rest = text[end..].trim_start();
        Ok(x)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn scale(unit: Unit, slider: (f64, f64)) -> Scale {
        Scale::new(unit, Some(slider), None, false)
    }

    #[test]
    fn units_and_arithmetic_are_read() {
        let cm = scale(Unit::Length, (0.0, 40.0));
        let mm = scale(Unit::Length, (0.0, 0.5));
        let ratio = scale(Unit::Ratio, (0.0, 1.0));
        let angle = scale(Unit::Angle, (0.0, 90.0));
        let plain = scale(Unit::None, (0.0, 1.0));
        let per = scale(Unit::PerCm, (0.0, 9.0));
        let twist = scale(Unit::AnglePerCm, (-20.0, 20.0));
        let check = |scale: &Scale, text: &str, want: f64| match scale.read(text) {
            Ok(NumberEdit::Set(x)) => assert!((x - want).abs() < 1e-9, "{text}: {x}"),
            other => panic!("{text}: {other:?}"),
        };
        for (scale, text, want) in [
            (&cm, "3", 3.0),
            (&cm, "3mm", 0.3),
            (&cm, " 2 in ", 5.08),
            (&cm, "2\"", 5.08),
            (&cm, "1m", 100.0),
            (&cm, "1 + 5mm", 1.5),
            (&cm, "(1+2)*3mm", 0.9),
            (&cm, "1/3", 1.0 / 3.0),
            (&cm, "6mm/3", 0.2),
            (&cm, "6mm/3mm", 2.0),
            (&cm, "0,5", 0.5),
            (&cm, "1e-1cm", 0.1),
            (&cm, "--2", 2.0),
            (&cm, "50% * 4", 2.0),
            (&mm, "3", 0.3),
            (&mm, "3 + 1cm", 1.3),
            (&mm, "0.4cm", 0.4),
            (&ratio, "50%", 0.5),
            (&ratio, "50", 0.5),
            (&ratio, "100/3", 1.0 / 3.0),
            (&ratio, "50% * 50%", 0.25),
            (&angle, "0.5rad", 0.5f64.to_degrees()),
            (&angle, "45deg", 45.0),
            (&angle, "45°", 45.0),
            (&angle, "1/4 turn", 90.0),
            (&mm, "1/4 cm", 0.25),
            (&angle, "pi/2 * 1rad", 90.0),
            (&plain, "50%", 0.5),
            (&plain, "2*(1 − 0.25)", 1.5),
            (&per, "12 /cm", 12.0),
            (&per, "12/4", 3.0),
            (&twist, "5°/cm", 5.0),
            (&twist, "1/4 turn per cm", 90.0),
        ] {
            check(scale, text, want);
        }
    }

    #[test]
    fn what_changes_the_old_number_is_read() {
        let mm = scale(Unit::Length, (0.0, 0.5));
        let ratio = scale(Unit::Ratio, (0.0, 1.0));
        let check = |scale: &Scale, text: &str, old: f64, want: f64| {
            let new = scale.read(text).unwrap().apply(old);
            assert!((new - want).abs() < 1e-12, "{text}: {new}");
        };
        check(&mm, "+=0.2", 0.1, 0.12);
        check(&mm, "-= 1mm", 0.3, 0.2);
        check(&mm, "*=2", 0.1, 0.2);
        check(&mm, "/=4", 0.4, 0.1);
        check(&mm, "*=50%", 0.4, 0.2);
        check(&ratio, "+=10", 0.5, 0.6);
        check(&ratio, "*=50%", 0.5, 0.25);
    }

    #[test]
    fn what_is_no_number_says_why() {
        let cm = scale(Unit::Length, (0.0, 40.0));
        let deep = "(".repeat(150);
        let long = "1+".repeat(5000);
        for (text, why) in [
            ("", "a number is missing"),
            ("three", "three is no number"),
            ("3 kg", "kg is no unit here"),
            ("3deg", "deg is no unit here"),
            ("1/0", "the result is not a finite number"),
            ("NaN", "NaN is no number"),
            ("inf", "inf is no number"),
            ("1e999", "the result is not a finite number"),
            ("1.2.3", "1.2.3 is no number"),
            ("(1", "a closing bracket is missing"),
            ("1 2", "\"2\" was not expected"),
            ("2cm*3cm", "two numbers with units cannot be multiplied"),
            ("*=2cm", "*= takes a plain number"),
            ("/=0", "the result is not a finite number"),
            (&deep, "brackets are nested too deep"),
            (&long, "the text is too long for a number"),
        ] {
            assert_eq!(cm.read(text).unwrap_err(), why, "{text}");
        }
    }

    #[test]
    fn any_text_is_read_or_refused() {
        let letters: Vec<char> = "0123456789.,eE+-*/()%°\" cminradpi−×é".chars().collect();
        let mut seed = 1u64;
        for unit in [Unit::Length, Unit::Ratio, Unit::Angle, Unit::PerCm2, Unit::None] {
            let scale = scale(unit, (0.0, 1.0));
            for _ in 0..4000 {
                let mut text = String::new();
                for _ in 0..12 {
                    seed = seed.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
                    text.push(letters[(seed >> 33) as usize % letters.len()]);
                }
                if let Ok(entry) = scale.read(&text) {
                    let (NumberEdit::Set(x) | NumberEdit::Add(x) | NumberEdit::Times(x)) = entry;
                    assert!(x.is_finite(), "{text}");
                }
            }
        }
    }

    #[test]
    fn numbers_are_shown_in_the_unit_of_their_input_and_read_back() {
        let check = |unit, slider, x: f64, want: &str| {
            let scale = scale(unit, slider);
            assert_eq!(scale.text(x), want);
            let Ok(NumberEdit::Set(back)) = scale.read(&scale.exact(x)) else { panic!("{want}") };
            assert!((back - x).abs() <= 1e-6 * x.abs(), "{x} {back}");
        };
        check(Unit::Length, (0.0, 0.5), 0.04f32.into(), "0.4 mm");
        check(Unit::Length, (0.5, 40.0), 6.0, "6 cm");
        check(Unit::Length, (0.0, 40.0), 123456.0, "123456 cm");
        check(Unit::Ratio, (0.0, 1.0), 0.7f32.into(), "70 %");
        check(Unit::Angle, (0.0, 90.0), 35.0, "35°");
        check(Unit::PerCm2, (0.0, 200.0), 100.5, "100 /cm²");
        check(Unit::None, (0.0, 1.0), -0.0, "0");
        check(Unit::None, (0.0, 1.0), 0.1f32.into(), "0.1");
        check(Unit::None, (0.0, 1.0), 1.0f64 / 3.0, "0.333");
    }

    #[test]
    fn limits_clamp_with_words() {
        let scale = Scale::new(Unit::Length, Some((0.0, 0.5)), Some((0.0, 10.0)), false);
        assert_eq!(scale.clamp(0.3), (0.3, None));
        let (x, said) = scale.clamp(20.0);
        assert_eq!((x, said.unwrap().as_str()), (10.0, "200 mm is above 100 mm, which is used"));
        let (x, said) = scale.clamp(-1.0);
        assert_eq!((x, said.unwrap().as_str()), (0.0, "-10 mm is below 0 mm, which is used"));
        let whole = Scale::new(Unit::Count, Some((2.0, 9.0)), Some((2.0, 9.0)), true);
        let (x, said) = whole.clamp(2.5);
        assert_eq!((x, said.unwrap().as_str()), (3.0, "2.5 is no whole number, 3 is used"));
    }

    #[test]
    fn steps_are_round_and_fine_enough_for_the_slider() {
        let step = |unit, slider| scale(unit, slider).step(0.0);
        let near = |a: f64, b: f64| assert!((a / b - 1.0).abs() < 1e-9, "{a} {b}");
        near(step(Unit::Length, (0.5, 40.0)), 0.1);
        near(step(Unit::Length, (0.0, 0.5)), 0.001);
        near(step(Unit::Ratio, (0.0, 1.0)), 0.01);
        near(step(Unit::Angle, (-180.0, 180.0)), 1.0);
        near(step(Unit::Length, (0.002, 0.02)), 0.0001);
        near(Scale::new(Unit::None, None, None, false).step(0.0), 0.1);
        near(Scale::new(Unit::Count, Some((2.0, 7.0)), None, true).step(0.0), 1.0);
        let ratio = scale(Unit::Ratio, (0.0, 1.0));
        assert_eq!(ratio.snap(0.30000000000000004, 0.01), 0.3);
    }
}
