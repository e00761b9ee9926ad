//! Tests: everything that grows on a parted scalp keeps off its partings.
//!
//! Laid guides, the hair filled around and between them, hair bent by modifiers, and puffs: no hair is rooted in a parting
//! or crosses one near its root, and none is moved into the head to achieve that. Nodes of partition and braid have their
//! own tests.

use crate::data::curves::Curves;
use crate::data::scalp::Scalp;
use crate::define::Value;
use crate::testing::{curves_of, run};
use std::sync::Arc;

fn node(id: &str, output: &str, set: &[(&str, Value)]) -> Value {
    let node = crate::by_id(id).unwrap();
    let at = node.outputs.iter().position(|it| it.name == output).unwrap();
    run(node, set).0.remove(at)
}

fn curves(id: &str, set: &[(&str, Value)]) -> Curves {
    curves_of(&node(id, "curves", set)).clone()
}

/// The built-in head, parted straight back into strips, or into boxes; and the middles of these.
fn parted(cells: &str) -> (Arc<Scalp>, Curves) {
    let head = node("head", "scalp", &[]);
    let set = [
        ("scalp", head),
        ("pattern", "straight_back".into()),
        ("count", Value::Int(8)),
        ("cells", cells.into()),
        ("cell_length", Value::Float(5.0)),
    ];
    let Value::Scalp(scalp) = node("partings", "scalp", &set) else { panic!() };
    (scalp, curves_of(&node("partings", "middles", &set)).clone())
}

#[track_caller]
fn check(what: &str, scalp: &Scalp, hair: &Curves, least: usize) {
    let sections = scalp.sections().unwrap();
    let (mut rooted, mut over, mut under) = (0, 0, 0);
    let skin = scalp.skin();
    for (tuft, i) in hair.each() {
        let points = tuft.curve(i);
        rooted += usize::from(!scalp.free(points[0]));
        under += points[1..].iter().filter(|p| skin.distance(**p) < -1e-3).count();
        // Hair that has left the skin may pass over.
        let near = points.len().min(8);
        over += usize::from(sections.is_over_line(&points[..near]));
    }
    assert!(hair.curve_count() > least, "{what}: {} hairs", hair.curve_count());
    let found = (rooted, over, under);
    assert_eq!(found, (0, 0, 0), "{what}: rooted in partings, over them; points in the head");
}

#[test]
fn guides_fills_and_puffs_keep_off_partings() {
    for cells in ["whole", "boxes"] {
        let (scalp, middles) = parted(cells);
        let on = || ("scalp", Value::from(scalp.clone()));
        let guides = |set: &[(&'static str, Value)]| {
            let base = [on(), ("count", Value::Int(1500)), ("radius", Value::Float(0.8))];
            curves("scatter_guides", &[&base, set].concat())
        };
        let laid = guides(&[("length", Value::Float(4.0))]);
        check(&format!("laid guides on {cells}"), &scalp, &laid, 1000);
        // Seeds with a guide that swings wider around a corner of its box than its steps did.
        for seed in [8, 12] {
            let laid = guides(&[("length", Value::Float(4.0)), ("seed", Value::Int(seed))]);
            check(&format!("laid guides on {cells}, seed {seed}"), &scalp, &laid, 1000);
        }
        let between = [on(), ("guides", laid.into()), ("density", Value::Float(20.0))];
        let hair = curves("interpolate", &between);
        check(&format!("hair between guides on {cells}"), &scalp, &hair, 5000);
        for id in ["clump", "noise", "frizz", "stray", "length"] {
            let bent = curves(id, &[on(), ("curves", hair.clone().into())]);
            check(&format!("{id} of hair between guides on {cells}"), &scalp, &bent, 5000);
        }
        let upright = guides(&[
            ("count", Value::Int(200)),
            ("length", Value::Float(2.0)),
            ("lie", Value::Float(90.0)),
            ("bend", Value::Float(0.0)),
            ("droop", Value::Float(0.0)),
        ]);
        let clusters = [on(), ("curves", upright.into()), ("strands", Value::Int(60))];
        let hair = curves("cluster_to_strands", &clusters);
        check(&format!("clusters on {cells}"), &scalp, &hair, 5000);
        // The puff's own position is on a parting.
        let puff = curves("sphere_puff", &[on(), ("count", Value::Int(2000))]);
        check(&format!("a puff on {cells}"), &scalp, &puff, 1900);
        let placed = [on(), ("placements", middles.into()), ("count", Value::Int(100))];
        let puffs = curves("sphere_puff", &placed);
        check(&format!("puffs in the middles of {cells}"), &scalp, &puffs, 500);
    }
}

#[test]
fn hair_combed_to_a_tie_on_a_parting_stays_on_its_side_and_what_comes_from_farther_is_told() {
    let head = node("head", "scalp", &[]);
    // Two sections, with a tie on the line between them; six, with the tie standing over two.
    for (count, far) in [(2, false), (6, true)] {
        let set = [
            ("scalp", head.clone()),
            ("pattern", "straight_back".into()),
            ("count", Value::Int(count)),
        ];
        let Value::Scalp(scalp) = node("partings", "scalp", &set) else { panic!() };
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
