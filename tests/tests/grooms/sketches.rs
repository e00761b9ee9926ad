//! The grooms that a pen drew, replayed on other heads.

use coif_graphs::document::{NodeId, Setting, Socket};
use coif_graphs::schedule::files::DiskFiles;
use coif_graphs::schedule::request::plan;
use coif_graphs::schedule::run::{CancelToken, Evaluator, OnFailure, Quiet};
use coif_graphs::{file, grooms};
use coif_nodes::define::Value;
use coif_nodes::eval::{PlainHost, Quality};
use coif_nodes::laws::{MeasuredHair, depth};
use coif_tests::{RealHead, smooth_heads};
use std::sync::Arc;

fn median(mut values: Vec<f32>) -> f32 {
    values.sort_by(f32::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or_default()
}

/// Only the sketch is evaluated, not its hair.
#[test]
fn what_a_pen_drew_on_the_built_in_head_stands_on_others() {
    const NAME: &str = "what_a_pen_drew_on_the_built_in_head_stands_on_others";
    let heads: Vec<_> = smooth_heads(NAME).collect();
    let id = |text: &str| NodeId::new(text).expect("an id");
    for name in ["sketch_bob", "sketch_ponytail", "sketch_mohawk"] {
        let text = grooms::by_name(name).expect("a shipped groom");
        let mut document = file::read(text).expect("it reads").document;
        for RealHead { name: head, mesh } in &heads {
            let node = document.nodes.get_mut("head").expect("a head");
            let mesh = Setting::Known(Value::Text(mesh.as_str().into()));
            Arc::make_mut(node).inputs.insert("mesh".to_owned(), mesh);
            let targets =
                [Socket::new(id("hair_sketch"), "curves"), Socket::new(id("head"), "scalp")];
            let plan = plan(&document, &targets, Quality::Final, &DiskFiles::default());
            let evaluator = Evaluator::new(2, 0).expect("threads");
            let outcome = evaluator.run(
                &plan.expect("a plan"),
                OnFailure::Stop,
                &CancelToken::default(),
                &Quiet,
            );
            let [Some(Value::Curves(curves)), Some(Value::Scalp(scalp))] = &outcome.targets[..]
            else {
                panic!("{name} on {head}: {:?}", outcome.nodes)
            };
            let report = outcome.nodes.iter().find(|node| node.name == "hair_sketch");
            let told = &report.expect("a report").gestures;
            // Head units are cm of a head of the built-in one's size.
            let unit = scalp.frame().unit();
            let drift = median(told.iter().filter_map(|one| one.drift).collect()) / unit;
            let turned = median(told.iter().filter_map(|one| one.turned).collect());
            let lost: Vec<_> = told.iter().filter(|one| !one.orphaned.is_empty()).collect();
            println!(
                "{name} on {head}: drift {:.2} mm, turned {turned:.2} degrees, {} curves, {} with orphans",
                drift * 10.0,
                curves.curve_count(),
                lost.len()
            );
            assert!(drift < 0.2, "{name} on {head}: {drift}");
            assert!(turned < 5.0, "{name} on {head}: {turned}");
            assert!(lost.is_empty(), "{name} on {head}: {lost:?}");
            let deep = depth::measure(&MeasuredHair::of(curves, &PlainHost), scalp).deepest_cm;
            // Between the points of what was drawn too, where its hair keeps out of the skin.
            assert!(deep < 0.3 * unit, "{name} on {head}: {deep} cm under the skin");
        }
    }
}
