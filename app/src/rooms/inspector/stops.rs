//! What can be done to the stops of a ramp by hand. Every result is a ramp again: at least one stop, positions from 0
//! to 1 that do not fall, finite values within the input's range.

use coif_nodes::data::ramp::{Blend, Ramp};

/// The most stops that can be added by hand; documents may hold more.
pub(crate) const MOST: usize = 64;

/// Values that an input takes.
pub(crate) type Limits = (f32, f32);

/// The ramp of these stops, sorted and clamped; `old` where they make none.
fn made(old: &Ramp, blend: Blend, mut stops: Vec<(f32, f32)>, (lo, hi): Limits) -> Ramp {
    for (x, y) in &mut stops {
        *x = x.clamp(0.0, 1.0);
        *y = y.max(lo).min(hi);
    }
    stops.sort_by(|a, b| a.0.total_cmp(&b.0));
    Ramp::new(blend, stops).unwrap_or_else(|_| old.clone())
}

/// A stop more at `x`, where the ramp ran anyway, or at height `y`; and its number.
pub(crate) fn add(ramp: &Ramp, x: f32, y: Option<f32>, limits: Limits) -> (Ramp, usize) {
    let x = if x.is_finite() { x.clamp(0.0, 1.0) } else { 0.5 };
    let at = ramp.stops().partition_point(|stop| stop.0 <= x);
    if ramp.stops().len() >= MOST {
        return (ramp.clone(), at.saturating_sub(1));
    }
    let mut stops = ramp.stops().to_vec();
    stops.insert(at, (x, y.filter(|y| y.is_finite()).unwrap_or_else(|| ramp.at(x))));
    (made(ramp, ramp.blend, stops, limits), at)
}

/// Stop `i` at another place. It stays between its neighbours, so its number stays.
pub(crate) fn put(ramp: &Ramp, i: usize, (x, y): (f32, f32), limits: Limits) -> Ramp {
    let mut stops = ramp.stops().to_vec();
    let before = i.checked_sub(1).and_then(|i| stops.get(i)).map_or(0.0, |stop| stop.0);
    let behind = stops.get(i + 1).map_or(1.0, |stop| stop.0);
    match stops.get_mut(i) {
        Some(stop) if x.is_finite() && y.is_finite() => *stop = (x.max(before).min(behind), y),
        _ => return ramp.clone(),
    }
    made(ramp, ramp.blend, stops, limits)
}

/// Without stop `i`; the last one stays.
pub(crate) fn remove(ramp: &Ramp, i: usize) -> Ramp {
    let mut stops = ramp.stops().to_vec();
    if stops.len() > 1 && i < stops.len() {
        stops.remove(i);
    }
    Ramp::new(ramp.blend, stops).unwrap_or_else(|_| ramp.clone())
}

/// Tip and root change places.
pub(crate) fn flip(ramp: &Ramp) -> Ramp {
    let mut stops: Vec<_> = ramp.stops().iter().rev().map(|(x, y)| (1.0 - x, *y)).collect();
    if ramp.blend == Blend::Step {
        // A step's value holds up to the next stop: seen from the other end it begins there.
        let ends: Vec<f32> = ramp.stops().iter().rev().map(|stop| stop.0).collect();
        let mut from = 0.0;
        for (stop, end) in stops.iter_mut().zip(ends) {
            stop.0 = from;
            from = 1.0 - end;
        }
    }
    Ramp::new(ramp.blend, stops).unwrap_or_else(|_| ramp.clone())
}

/// All values times `factor`.
pub(crate) fn scale(ramp: &Ramp, factor: f32, limits: Limits) -> Ramp {
    let stops = ramp.stops().iter().map(|(x, y)| (*x, y * factor)).collect();
    made(ramp, ramp.blend, stops, limits)
}

/// The same stops, blended in another way.
pub(crate) fn blended(ramp: &Ramp, blend: Blend) -> Ramp {
    Ramp::new(blend, ramp.stops().to_vec()).unwrap_or_else(|_| ramp.clone())
}

/// A shape to begin with: its name, blend and stops, for values from 0 to 1.
pub(crate) type Preset = (&'static str, Blend, &'static [(f32, f32)]);

/// Shapes to begin with, root left, tip right.
pub(crate) const PRESETS: &[Preset] = &[
    ("Constant", Blend::Linear, &[(0.0, 1.0), (1.0, 1.0)]),
    ("Rising", Blend::Linear, &[(0.0, 0.0), (1.0, 1.0)]),
    ("Falling", Blend::Linear, &[(0.0, 1.0), (1.0, 0.0)]),
    ("Soft rise", Blend::Smooth, &[(0.0, 0.0), (1.0, 1.0)]),
    ("Soft fall", Blend::Smooth, &[(0.0, 1.0), (1.0, 0.0)]),
    ("Taper at the tip", Blend::Smooth, &[(0.0, 1.0), (0.7, 1.0), (1.0, 0.0)]),
    ("Taper at both ends", Blend::Smooth, &[(0.0, 0.0), (0.2, 1.0), (0.8, 1.0), (1.0, 0.0)]),
    ("Middle", Blend::Smooth, &[(0.0, 0.0), (0.5, 1.0), (1.0, 0.0)]),
    ("Ends", Blend::Smooth, &[(0.0, 1.0), (0.5, 0.0), (1.0, 1.0)]),
];

/// A preset as high as `ramp` is now, so that it keeps its strength.
pub(crate) fn preset(ramp: &Ramp, (_, blend, shape): Preset, limits: Limits) -> Ramp {
    let highest = ramp
        .stops()
        .iter()
        .fold(0.0f32, |most, (_, y)| if y.abs() > most.abs() { *y } else { most });
    let height = if highest == 0.0 { 1.0f32.max(limits.0).min(limits.1) } else { highest };
    let stops = shape.iter().map(|(x, y)| (*x, y * height)).collect();
    made(ramp, blend, stops, limits)
}

/// The heights that an editor of the ramp should show: what there is with some air, from zero where nothing is below it,
/// up to the slider's end where that is not far; never empty.
pub(crate) fn shown(ramp: &Ramp, slider: (f32, f32)) -> (f32, f32) {
    let (mut lo, mut hi) = (0.0f32, 0.0f32);
    for (_, y) in ramp.stops() {
        (lo, hi) = (lo.min(*y), hi.max(*y));
    }
    let end = |reach: f32, end: f32| match reach {
        0.0 => end,
        // Near enough to the slider's end to show all of it.
        y if y <= end && y * 2.5 >= end => end,
        y => round_up(y * 1.15),
    };
    let top = if hi == 0.0 && lo < 0.0 { 0.0 } else { end(hi, slider.1.max(0.0)) };
    let bottom = if lo == 0.0 && slider.0 >= 0.0 { 0.0 } else { -end(-lo, -slider.0.min(0.0)) };
    if top - bottom < 1e-6 || !(top - bottom).is_finite() {
        (bottom, bottom + 1.0)
    } else {
        (bottom, top)
    }
}

/// The next of 1, 1.5, 2, 3, 5, 7 times a power of ten.
fn round_up(y: f32) -> f32 {
    let power = 10f32.powf(y.log10().floor());
    let next = [1.0, 1.5, 2.0, 3.0, 5.0, 7.0, 10.0].into_iter().find(|n| n * power >= y * 0.9999);
    next.unwrap_or(10.0) * power
}

#[cfg(test)]
mod tests {
    use super::*;

    const ALL: Limits = (f32::MIN, f32::MAX);

    struct Random(u64);
    impl Random {
        fn next(&mut self) -> f32 {
            self.0 = self.0.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            (self.0 >> 40) as f32 / (1u64 << 24) as f32
        }
    }

    #[test]
    fn whatever_is_done_the_result_is_a_ramp_within_the_limits() {
        let mut random = Random(3);
        let limits = (0.0, 1.5);
        for blend in [Blend::Step, Blend::Linear, Blend::Smooth] {
            let mut ramp = Ramp::new(blend, vec![(0.2, 1.0), (0.9, 0.5)]).unwrap();
            for _ in 0..3000 {
                let (x, y) = (random.next() * 1.4 - 0.2, random.next() * 4.0 - 1.0);
                let i = (random.next() * 12.0) as usize;
                ramp = match (random.next() * 8.0) as usize {
                    0 => add(&ramp, x, Some(y), limits).0,
                    1 => remove(&ramp, i),
                    2 => flip(&ramp),
                    3 => scale(&ramp, y, limits),
                    4 => preset(&ramp, PRESETS[i % PRESETS.len()], limits),
                    5 => add(&ramp, f32::NAN, Some(f32::NAN), limits).0,
                    _ => put(&ramp, i, (x, y), limits),
                };
                assert!(Ramp::new(ramp.blend, ramp.stops().to_vec()).is_ok());
                assert!(ramp.stops().iter().all(|(_, y)| (0.0..=1.5).contains(y)), "{ramp:?}");
                assert!(ramp.stops().len() <= MOST);
            }
        }
    }

    #[test]
    fn a_stop_added_where_the_ramp_runs_changes_nothing_of_straight_ones() {
        let ramp = Ramp::linear(0.0, 2.0);
        let (more, at) = add(&ramp, 0.25, None, ALL);
        assert_eq!((at, more.stops()), (1, &[(0.0, 0.0), (0.25, 0.5), (1.0, 2.0)][..]));
        for i in 0..=100 {
            let x = i as f32 / 100.0;
            assert!((more.at(x) - ramp.at(x)).abs() < 1e-6);
        }
        assert_eq!(remove(&more, 1), ramp);
    }

    #[test]
    fn a_stop_stays_between_its_neighbours() {
        let ramp = Ramp::new(Blend::Linear, vec![(0.0, 0.0), (0.5, 1.0), (0.6, 0.0)]).unwrap();
        assert_eq!(put(&ramp, 1, (0.9, 0.2), ALL).stops()[1], (0.6, 0.2));
        assert_eq!(put(&ramp, 1, (-1.0, 3.0), (0.0, 2.0)).stops()[1], (0.0, 2.0));
        assert_eq!(put(&ramp, 2, (7.0, 0.0), ALL).stops()[2], (1.0, 0.0));
        assert_eq!(put(&ramp, 9, (0.5, 0.5), ALL), ramp);
        assert_eq!(remove(&Ramp::constant(1.0), 0), Ramp::constant(1.0));
    }

    #[test]
    fn flipping_mirrors_the_values_and_twice_is_nothing() {
        for blend in [Blend::Step, Blend::Linear, Blend::Smooth] {
            let stops = vec![(0.0, 1.0), (0.25, 3.0), (0.75, 2.0)];
            let ramp = Ramp::new(blend, stops).unwrap();
            let flipped = flip(&ramp);
            for i in 0..100 {
                let x = (i as f32 + 0.5) / 100.0;
                assert!((flipped.at(1.0 - x) - ramp.at(x)).abs() < 1e-5, "{blend:?} {x}");
            }
        }
    }

    #[test]
    fn a_preset_keeps_the_height() {
        let ramp = preset(&Ramp::linear(0.0, 0.4), PRESETS[2], ALL);
        assert_eq!((ramp.at(0.0), ramp.at(1.0)), (0.4, 0.0));
        assert_eq!(preset(&Ramp::constant(0.0), PRESETS[1], (0.0, 0.5)).at(1.0), 0.5);
    }

    #[test]
    fn the_editor_shows_what_there_is_with_some_air() {
        let check = |from: f32, to: f32, slider, want: (f32, f32)| {
            let (lo, hi) = shown(&Ramp::linear(from, to), slider);
            assert!((lo - want.0).abs() + (hi - want.1).abs() < 1e-4, "{from} {to}: {lo} {hi}");
        };
        check(0.0, 1.0, (0.0, 1.0), (0.0, 1.0));
        check(0.5, 0.5, (0.0, 1.0), (0.0, 1.0));
        check(3.0, 3.0, (0.0, 1.0), (0.0, 5.0));
        check(0.2, 0.4, (0.2, 5.0), (0.0, 0.5));
        check(0.0, 0.0, (0.0, 4.0), (0.0, 4.0));
        check(0.0, 0.0, (-180.0, 180.0), (-180.0, 180.0));
        check(-90.0, 0.0, (-180.0, 180.0), (-180.0, 0.0));
        check(1e30, 1e38, (0.0, 1.0), (0.0, 1.5e38));
    }
}
