//! Every shipped groom opens and is not changed by looking at it; some are shown with all of their hair.

use super::harness::{is_sound, on_groom, settle};
use coif::core::event::Event;
use coif_graphs::{file, grooms};
use coif_tests::long::is_long;

/// The hero whose hair is waited for, beside every sixth of the other grooms; all open, and `grooms` evaluates all of them.
const SHOWN: [&str; 1] = ["cornrows_puffs"];

#[test]
fn every_shipped_groom_opens_unchanged_and_shows_all_of_its_hair() {
    let long = is_long();
    for (i, (name, text)) in grooms::ALL.iter().enumerate() {
        let mut ui = on_groom(name);
        let sixth = !grooms::HEROES.contains(name) && i % 6 == 0;
        if !(long || sixth || SHOWN.contains(name)) {
            ui.run_steps(3);
            let state = &ui.state().state;
            assert_eq!(state.document, file::read(text).expect("valid").document, "{name}");
            assert!(!state.history.is_changed(), "{name}");
            continue;
        }
        settle(&mut ui);
        let state = &ui.state().state;
        let failures = state.run.reports.failures();
        assert!(failures.is_empty(), "{name}: {failures:?}");
        let shown = state.shown.as_ref().expect("something is shown");
        assert!(shown.is_final() && shown.curves.curve_count() > 100, "{name}");
        assert!(shown.scalp().is_some() && !state.stale(), "{name}");
        assert_eq!(state.document, file::read(text).expect("valid").document, "{name}");
        assert!(!state.history.is_changed(), "{name}");
        is_sound(&state.document);
    }
}

#[test]
fn a_displayed_hair_leads_to_the_nodes_that_made_it_and_its_ancestors() {
    let mut ui = on_groom("cornrows");
    settle(&mut ui);
    let shown = ui.state().state.shown.clone().expect("something is shown");
    let (tuft, i) = shown.curves.each().next().expect("hair");
    ui.state_mut().apply(Event::Trace(tuft.id(i)));
    settle(&mut ui);
    let line: Vec<&str> = ui.state().state.traced.iter().map(|a| a.node.as_str()).collect();
    assert_eq!(line, ["fill", "braid", "rows"]);
}
