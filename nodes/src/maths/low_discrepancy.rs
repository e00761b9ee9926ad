//! Point sets that fill evenly from the first point on, so that more density only ever adds points.

/// The `i`-th point of the R2 sequence in the unit square (M. Roberts, 2018, "The unreasonable
/// effectiveness of quasirandom sequences"), shifted by `shift`. Prefix-stable: the first n points
/// are the same whatever comes after.
#[inline]
pub fn r2(i: u32, shift: [f32; 2]) -> [f32; 2] {
    // 1/g and 1/g^2 of the plastic number g as 32-bit fractions: integer steps wrap exactly and never
    // lose precision, however far the sequence runs.
    const A: u32 = 3_242_174_889;
    const B: u32 = 2_447_445_414;
    let fraction = |step: u32, shift: f32| {
        let start = (shift.fract().abs() * 4_294_967_296.0) as u32;
        let bits = start.wrapping_add(step.wrapping_mul(i.wrapping_add(1)));
        (bits >> 8) as f32 * (1.0 / (1u32 << 24) as f32)
    };
    [fraction(A, shift[0]), fraction(B, shift[1])]
}

/// The `i`-th point of an even filling of the unit disc (area-preserving map of [`r2`]).
#[inline]
pub fn disc(i: u32, shift: [f32; 2]) -> [f32; 2] {
    let [a, b] = r2(i, shift);
    let radius = a.sqrt();
    let (sin, cos) = super::transcendental::sin_cos_turns(b);
    [radius * cos, radius * sin]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_prefix_fills_the_square_evenly() {
        for n in [64u32, 256, 1024, 4096] {
            let cells = 4;
            let mut counts = [0u32; 16];
            for i in 0..n {
                let [x, y] = r2(i, [0.3, 0.8]);
                counts[(y * cells as f32) as usize * cells + (x * cells as f32) as usize] += 1;
            }
            let want = n / 16;
            for count in counts {
                assert!(count.abs_diff(want) <= 2 + want / 16, "{n}: {counts:?}");
            }
        }
    }

    #[test]
    fn the_disc_is_filled_to_its_edge_and_not_beyond() {
        let inside_half =
            (0..1000).map(|i| disc(i, [0.0, 0.0])).filter(|p| p[0] * p[0] + p[1] * p[1] < 0.25);
        let count = inside_half.count();
        assert!((245..255).contains(&count), "{count}");
    }
}
