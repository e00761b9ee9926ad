//! What the picture is, in words: in its corner, and in the metadata of saved pictures.

use crate::words::{counted, grouped};

/// What the words are made from.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Facts {
    /// Strands that were evaluated, and how many a final evaluation made last.
    pub strands: usize,
    /// Strands of the last final evaluation of the same outputs.
    pub final_strands: Option<usize>,
    /// All hair was made.
    pub is_final: bool,
    /// Points of the strands.
    pub points: usize,
    /// How long the evaluation took, milliseconds.
    pub evaluation_ms: f64,
    /// The document has changed since.
    pub stale: bool,
    /// Samples of the picture and how many it is to have; none before the first picture.
    pub samples: Option<(u32, u32)>,
    /// Screen pixels across one of the picture.
    pub wide: u32,
    /// Its light is rough.
    pub rough: bool,
    /// How long the picture took from the scene, milliseconds.
    pub draw_ms: f64,
    /// Share of the strands that was drawn.
    pub share: f32,
    /// Some hair is hidden, or some alone is shown.
    pub hidden: bool,
}

impl Facts {
    /// What was made of the groom: "preview 12 % (12,400 of 103,000 strands)" or "final".
    pub fn made(&self) -> String {
        let here = counted(self.strands, "strand");
        let mut text = match (self.is_final, self.final_strands) {
            (true, _) => format!("final, {here}"),
            (false, Some(all)) if all >= self.strands && all > 0 => {
                let percent = 100.0 * self.strands as f64 / all as f64;
                let percent = match percent {
                    p if p < 0.95 => format!("{p:.1}"),
                    p => format!("{p:.0}"),
                };
                let here = grouped(self.strands);
                format!("preview {percent} % ({here} of {})", counted(all, "strand"))
            }
            (false, _) => format!("preview ({here})"),
        };
        if self.stale {
            text = format!("stale: {text}");
        }
        if self.hidden {
            text += ", some hidden";
        }
        if self.share < 0.999 {
            text += &format!(", {:.0} % of them drawn", (self.share * 100.0).max(1.0));
        }
        text
    }

    /// How far the picture is, and what it cost.
    pub fn drawn(&self) -> String {
        let mut parts = vec![];
        match self.samples {
            None => parts.push("drawing".to_owned()),
            Some(_) if self.rough && self.wide > 1 => {
                parts.push(format!("rough, 1/{} resolution", self.wide));
            }
            Some(_) if self.rough => parts.push("rough".to_owned()),
            Some((n, of)) => parts.push(format!("{n} of {of} samples")),
        }
        parts.push(counted(self.points, "point"));
        parts.push(format!("evaluated in {}", duration(self.evaluation_ms)));
        if self.samples.is_some() {
            parts.push(format!("drawn in {}", duration(self.draw_ms)));
        }
        parts.join(", ")
    }
}

/// A time as people read it.
pub(crate) fn duration(ms: f64) -> String {
    if ms < 1000.0 { format!("{ms:.0} ms") } else { format!("{:.1} s", ms / 1e3) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_picture_says_what_it_is() {
        let base = Facts { share: 1.0, wide: 1, ..Facts::default() };
        let preview = Facts { strands: 12_400, final_strands: Some(103_000), ..base.clone() };
        let whole = Facts { strands: 103_000, is_final: true, ..base.clone() };
        let check = |facts: &Facts, expected: &str| assert_eq!(facts.made(), expected);
        check(&preview, "preview 12 % (12,400 of 103,000 strands)");
        check(&Facts { strands: 500, ..preview.clone() }, "preview 0.5 % (500 of 103,000 strands)");
        check(&Facts { final_strands: None, ..preview.clone() }, "preview (12,400 strands)");
        check(&Facts { final_strands: Some(10), ..preview.clone() }, "preview (12,400 strands)");
        check(&whole, "final, 103,000 strands");
        check(&Facts { strands: 1, ..whole.clone() }, "final, 1 strand");
        check(&Facts { stale: true, ..whole.clone() }, "stale: final, 103,000 strands");
        check(&Facts { hidden: true, ..whole.clone() }, "final, 103,000 strands, some hidden");
        check(&Facts { share: 0.25, ..whole }, "final, 103,000 strands, 25 % of them drawn");
    }

    #[test]
    fn the_picture_says_how_far_it_is() {
        let base = Facts {
            points: 155_460,
            evaluation_ms: 84.4,
            draw_ms: 1234.0,
            wide: 1,
            share: 1.0,
            ..Facts::default()
        };
        let check = |facts: &Facts, expected: &str| assert_eq!(facts.drawn(), expected);
        check(&base, "drawing, 155,460 points, evaluated in 84 ms");
        let seen = Facts { samples: Some((4, 32)), ..base };
        check(&seen, "4 of 32 samples, 155,460 points, evaluated in 84 ms, drawn in 1.2 s");
        let rough = Facts { rough: true, wide: 2, samples: Some((1, 32)), ..seen };
        check(&rough, "rough, 1/2 resolution, 155,460 points, evaluated in 84 ms, drawn in 1.2 s");
    }
}
