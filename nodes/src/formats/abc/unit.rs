//! Which unit the numbers of an Alembic file are in, which no such file declares.
//!
//! Guaranteed: the head decides alone where roots lie on it in one unit and in no other; nothing is guessed of an application whose
//! files may be in any unit. Not promised: that an artist did not scale on export.

use super::super::usd::read::ReadCurves;
use crate::maths::closest::Surface;
use glam::Vec3;

/// Units that heads are modelled in, in centimetres: millimetre, centimetre, inch, decimetre, foot, metre.
const UNITS: [f32; 6] = [0.1, 1.0, 2.54, 10.0, 30.48, 100.0];
/// Roots are on a head that half of them are closer to than this, cm.
const ON: f32 = 0.5;
/// And that in any other unit they are so many times as far from.
const CLEARLY: f32 = 4.0;
/// How many roots are looked at.
const MOST_ROOTS: usize = 512;

/// Centimetres in the unit of an application that has one: coif and Maya write centimetres, Blender metres.
pub fn cm_by_application(application: &str) -> Option<f32> {
    let known = [("coif", 1.0), ("Maya", 1.0), ("Autodesk Maya", 1.0), ("Blender", 100.0)];
    known.into_iter().find_map(|(name, cm)| application.starts_with(name).then_some(cm))
}

/// Centimetres in the unit in which roots of these curves lie on a head; none where they lie on it in no unit, or in several.
pub fn cm_by_head(curves: &[ReadCurves], head: &Surface) -> Option<f32> {
    let mut roots: Vec<Vec3> = vec![];
    for read in curves {
        let mut first = 0;
        for count in read.counts.iter().map(|count| *count as usize).filter(|count| *count > 0) {
            roots.push(read.points[first]);
            first += count;
        }
    }
    let step = roots.len().div_ceil(MOST_ROOTS).max(1);
    let middle = |cm: f32| {
        let off = roots.iter().step_by(step).filter_map(|p| Some(head.closest(*p * cm)?.distance));
        let mut off: Vec<f32> = off.collect();
        off.sort_by(f32::total_cmp);
        off.get(off.len() / 2).copied()
    };
    let mut found: Vec<(f32, f32)> =
        UNITS.iter().filter_map(|cm| Some((middle(*cm)?, *cm))).collect();
    found.sort_by(|a, b| a.0.total_cmp(&b.0));
    match found[..] {
        [(off, cm), (next, _), ..] if off < ON && next > (CLEARLY * off).max(ON) => Some(cm),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::scalp::tests::shared_ball;
    use crate::formats::usd::form::Form;

    #[test]
    fn a_head_tells_the_unit_of_what_grows_on_it_and_of_nothing_else() {
        let head = shared_ball();
        let feet: Vec<Vec3> = (0..40)
            .map(|k| Vec3::new((k % 7) as f32 - 3.0, 9.0, (k % 5) as f32 - 2.0))
            .map(|at| head.closest_root(at).unwrap().point)
            .collect();
        let check = |lift: f32, unit: f32, expected: Option<f32>| {
            let points = feet.iter().flat_map(|foot| [*foot + Vec3::Y * lift, *foot * 1.5]);
            let read = ReadCurves {
                path: "/hair".into(),
                purpose: "default".into(),
                is_visible: true,
                counts: vec![2; feet.len()],
                points: points.map(|point| point / unit).collect(),
                form: Form::COIF,
                widths: None,
                primvars: vec![],
                notes: vec![],
            };
            assert_eq!(cm_by_head(&[read], head.surface()), expected, "{lift} {unit}");
        };
        for unit in UNITS {
            check(0.0, unit, Some(unit));
            check(0.05, unit, Some(unit));
        }
        check(3.0, 1.0, None);
        assert_eq!(cm_by_head(&[], head.surface()), None);
    }

    #[test]
    fn applications_of_one_unit_are_known() {
        let check = |name: &str, cm| assert_eq!(cm_by_application(name), cm, "{name}");
        check("Blender", Some(100.0));
        check("Maya 2022 AbcExport v1.0", Some(1.0));
        check("coif 0.4.0", Some(1.0));
        check("Houdini 20.5", None);
        check("", None);
    }
}
