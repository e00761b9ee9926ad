//! Tests: hair that is combed to a tie on a parting stays on its side of it. (What grows on a parted scalp or is moved there is held to
//! its laws by `obeys.rs`.)

use crate::define::Value;
use crate::testing::{curves_of, head, run};

#[test]
fn hair_combed_to_a_tie_on_a_parting_stays_on_its_side_and_what_comes_from_farther_is_told() {
    let head = Value::from(head(&[]));
    // Two sections, with a tie on the line between them; six, with the tie standing over two.
    for (count, far) in [(2, false), (6, true)] {
        let set = [
            ("scalp", head.clone()),
            ("pattern", "straight_back".into()),
            ("count", Value::Int(count)),
        ];
        let parted = run(crate::by_id("partings").unwrap(), &set).0.remove(0);
        let Value::Scalp(scalp) = parted else { panic!() };
        let set = [
            ("scalp", Value::from(scalp.clone())),
            ("position", glam::Vec3::new(0.0, 7.2, -6.2).into()),
            ("density", Value::Float(20.0)),
        ];
        let (out, said) = run(crate::by_id("gather").unwrap(), &set);
        let (hair, sections) = (curves_of(&out[0]), scalp.sections().unwrap());
        let passes = |points: &[glam::Vec3]| sections.is_over_line(points);
        let over = hair.each().filter(|(tuft, i)| passes(tuft.curve(*i))).count();
        assert!(hair.curve_count() > 5_000, "{}", hair.curve_count());
        let told = said.iter().any(|text| {
            text.contains(&format!(
                "to their sections, and reach to the hair near them ({over} curves"
            ))
        });
        assert_eq!(
            (over > 0, told),
            (far, far),
            "{count}: {over} of {}; {said:?}",
            hair.curve_count()
        );
    }
}
