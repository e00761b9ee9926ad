//! Numbers as people read them, in messages of the command line and of the window.

/// A number in groups of three digits: 1,204.
pub(crate) fn grouped(number: usize) -> String {
    let digits = number.to_string();
    let mut text = String::new();
    for (i, digit) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i).is_multiple_of(3) {
            text.push(',');
        }
        text.push(digit);
    }
    text
}

/// A measured number with three digits that count: 4.59, 0.0254, 194, 1,230.
#[cfg(feature = "editor")]
pub(crate) fn rounded(number: f64) -> String {
    let places = 2 - number.abs().log10().floor().clamp(-300.0, 300.0) as i32;
    match usize::try_from(places) {
        Ok(places) => {
            let text = format!("{number:.places$}");
            let short = text.trim_end_matches('0').trim_end_matches('.');
            if text.contains('.') && number != 0.0 {
                short.to_owned()
            } else {
                format!("{number:.0}")
            }
        }
        Err(_) => {
            let step = 10f64.powi(-places);
            format!("{:.0}", (number / step).round() * step)
        }
    }
}

/// So many of something, whose plural ends in s: "1 strand", "1,204 strands".
#[cfg(feature = "editor")]
pub(crate) fn counted(number: usize, one: &str) -> String {
    format!("{} {one}{}", grouped(number), if number == 1 { "" } else { "s" })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[cfg(feature = "editor")]
    #[test]
    fn measured_numbers_have_three_digits_that_count() {
        for (number, expected) in [
            (4.5946727, "4.59"),
            (193.703, "194"),
            (0.0254, "0.0254"),
            (1.0, "1"),
            (0.5, "0.5"),
            (12.04, "12"),
            (9.996, "10"),
            (1234.5, "1230"),
            (-2.718, "-2.72"),
            (0.0, "0"),
        ] {
            assert_eq!(rounded(number), expected);
        }
    }

    #[test]
    fn long_numbers_are_grouped() {
        for (number, expected) in
            [(0, "0"), (999, "999"), (1000, "1,000"), (1_234_567, "1,234,567")]
        {
            assert_eq!(grouped(number), expected);
        }
    }
}
