//! The words of `coif render`'s options: sizes, numbers within limits, names. Each mistake is one line that says what can be written
//! instead.

use crate::jobs::render::LONGEST;
use crate::jobs::stop::Stop;

/// `WIDTHxHEIGHT` in pixels.
pub(in crate::cli) fn size(text: &str) -> Result<[u32; 2], Stop> {
    let wrong = || {
        Stop::refused(format!(
            "--size {text}: write it as WIDTHxHEIGHT in pixels, each from 1 to {LONGEST}"
        ))
    };
    let (width, height) = text.split_once('x').ok_or_else(wrong)?;
    let side = |text: &str| {
        let digits = !text.is_empty() && text.bytes().all(|b| b.is_ascii_digit());
        text.parse().ok().filter(|side| digits && (1..=LONGEST).contains(side)).ok_or_else(wrong)
    };
    Ok([side(width)?, side(height)?])
}

/// A number within limits.
pub(in crate::cli) fn within(
    option: &str,
    value: f32,
    (lo, hi): (f32, f32),
    unit: &str,
) -> Result<f32, Stop> {
    if (lo..=hi).contains(&value) {
        return Ok(value);
    }
    Err(Stop::refused(format!("{option} {value}: must be from {lo} to {hi}{unit}")))
}

/// A number of things within limits.
pub(super) fn counted(option: &str, value: u32, most: u32) -> Result<u32, Stop> {
    if (1..=most).contains(&value) {
        return Ok(value);
    }
    Err(Stop::refused(format!("{option} {value}: must be from 1 to {most}")))
}

/// One of a few names.
pub(super) fn named<T>(
    option: &str,
    text: &str,
    known: &[&str],
    find: impl FnOnce(&str) -> Option<T>,
) -> Result<T, Stop> {
    find(text).ok_or_else(|| {
        Stop::refused(format!("{option} {text}: is not one of {}", known.join(", ")))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn said<T>(result: Result<T, Stop>) -> Result<T, String> {
        result.map_err(|stop| stop.lines().join("\n"))
    }

    #[test]
    fn a_size_is_two_whole_numbers_of_pixels() {
        for (text, expected) in [("1280x720", [1280, 720]), ("1x16384", [1, 16384])] {
            assert_eq!(said(size(text)), Ok(expected));
        }
        for text in
            ["", "x", "1280", "0x720", "1280x16385", "+1x2", "-1x2", "1 x2", "1x2x3", "1e3x2"]
        {
            let said = said(size(text)).unwrap_err();
            assert!(said.contains("WIDTHxHEIGHT") && said.lines().count() == 1, "{text}: {said}");
        }
    }

    #[test]
    fn numbers_out_of_range_and_what_is_no_number_are_refused() {
        assert_eq!(said(within("--opacity", 0.5, (0.0, 1.0), "")), Ok(0.5));
        for value in [-0.1, 1.1, f32::NAN, f32::INFINITY] {
            let said = said(within("--opacity", value, (0.0, 1.0), "")).unwrap_err();
            assert!(said.contains("from 0 to 1"), "{said}");
        }
        assert_eq!(said(counted("--samples", 3, 4)), Ok(3));
        assert!(said(counted("--samples", 0, 4)).is_err());
        assert!(said(counted("--samples", 5, 4)).is_err());
    }
}
