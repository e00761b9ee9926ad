//! Hair is frozen beside what is selected: every tool, what a replay makes, and the way out.

use super::*;
use crate::core::event::Event;
use crate::core::state::Select;
use coif_graphs::document::Setting;
use coif_graphs::document::edit::Edit;
use coif_nodes::data::attributes::PARENT;
use std::collections::{BTreeMap, BTreeSet};

/// Two clusters side by side in front, with hair grown from them, and their ids from left to right.
fn two() -> (Salon, [u64; 2]) {
    let mut salon = Salon::open(head(), "hair.sketch");
    for x in [250.0, 350.0] {
        salon.draw(&Salon::line([x, 140.0], [x, 420.0]), HEAVY);
    }
    // Discs alone: what fills the skin between them changes no stroke, and takes its time.
    let (node, input) = (NodeId::new("strands").expect("an id"), "fill".to_owned());
    let setting = Setting::Known(Value::Float(0.0));
    salon.0.editor().apply(Event::Edit(Edit::SetInput { node, input, setting }));
    salon.rest();
    let ids = ids(&salon.curves());
    (salon, [ids[0], ids[1]])
}

fn ids(curves: &Curves) -> Vec<u64> {
    curves.each().map(|(tuft, i)| tuft.id(i)).collect()
}

impl Salon {
    /// Selects the strands that grow from curves of the sketch.
    fn select_hair_of(&mut self, of: &[u64]) {
        let shown = self.0.editor().state.shown.clone().expect("a result");
        let strands = shown
            .curves
            .each()
            .filter(|(tuft, i)| of.contains(&tuft.view(PARENT).at(*i, tuft.range(*i).start)));
        let strands: BTreeSet<u64> = strands.map(|(tuft, i)| tuft.id(i)).collect();
        assert!(strands.len() > 10, "{}", strands.len());
        self.0.editor().apply(Event::Select(Select::Curves(strands)));
    }
    /// The curves that a stroke changes or removes, taken back again.
    fn changed(&mut self, tool: &str, places: &[Pos2], pressure: f32) -> Vec<u64> {
        let whole = |curves: &Curves| -> BTreeMap<u64, _> {
            curves
                .each()
                .map(|(tuft, i)| (tuft.id(i), tuft.gather(&[i as u32]).build().key()))
                .collect()
        };
        let (was, done) = (whole(&self.curves()), self.0.done());
        self.0.editor().act(tool);
        self.0.rest();
        self.draw(places, pressure);
        let is = whole(&self.curves());
        let farmed = content_hash(&self.farmed());
        assert_eq!(farmed, content_hash(&self.curves()), "{tool}: a replay");
        if self.0.done() > done {
            self.0.editor().apply(Event::Undo);
            self.rest();
        }
        was.iter().filter(|(id, key)| is.get(id) != Some(key)).map(|(id, _)| *id).collect()
    }
}

/// Across both clusters, to and fro so often.
fn across(times: i32) -> Vec<Pos2> {
    let way = |k: i32| match k % 2 {
        0 => Salon::line([215.0, 300.0 + 4.0 * k as f32], [395.0, 302.0 + 4.0 * k as f32]),
        _ => Salon::line([395.0, 302.0 + 4.0 * k as f32], [215.0, 304.0 + 4.0 * k as f32]),
    };
    (0..times).flat_map(way).collect()
}

#[test]
fn tools_act_on_the_selected_curves_alone_and_so_does_a_replay() {
    let (mut salon, [left, right]) = two();
    let tools = ["comb", "cut", "smooth", "puff", "grab", "straighten", "pin", "frizz"];
    let mut moves_both = vec![];
    for tool in tools {
        let id = format!("hair.{tool}");
        let places = match tool {
            "frizz" => across(5),
            "grab" => Salon::line([300.0, 300.0], [330.0, 300.0]),
            _ => across(1),
        };
        salon.0.editor().apply(Event::Select(Select::Curves(BTreeSet::new())));
        let all = salon.changed(&id, &places, MIDDLE);
        if all.len() == 2 {
            moves_both.push(tool);
        }
        for one in [left, right] {
            salon.select_hair_of(&[one]);
            let changed = salon.changed(&id, &places, MIDDLE);
            // Hair that is smooth or straight already stays as it is.
            let expected = if tool == "frizz" || all.contains(&one) { vec![one] } else { vec![] };
            assert_eq!(changed, expected, "{tool}: of {all:?}");
        }
    }
    assert!(
        ["comb", "cut", "puff", "grab", "pin"].iter().all(|t| moves_both.contains(t)),
        "{moves_both:?}"
    );
}

#[test]
fn a_stroke_over_frozen_hair_alone_changes_nothing_says_so_and_escape_frees_it() {
    let (mut salon, [left, right]) = two();
    let mut settings = salon.0.editor().state.settings.clone();
    settings.pen.hair_brush = 0.5;
    salon.0.editor().apply(Event::Settings(settings.into()));
    let beside = Salon::line([352.0, 260.0], [365.0, 330.0]);
    salon.select_hair_of(&[left]);
    assert_eq!(salon.changed("hair.comb", &beside, LIGHT), Vec::<u64>::new());
    let said = |salon: &mut Salon| salon.0.editor().pen.said.take().map(|said| said.text);
    assert_eq!(said(&mut salon).as_deref(), Some(super::super::free::FROZEN));
    // What is selected elsewhere freezes all, and the sketch's own curves may be selected too.
    salon.0.editor().apply(Event::Select(Select::Curves([12345].into())));
    assert_eq!(salon.changed("hair.comb", &beside, LIGHT), Vec::<u64>::new());
    salon.0.editor().apply(Event::Select(Select::Curves([left, right].into())));
    assert_eq!(salon.changed("hair.comb", &beside, LIGHT), [right]);
    // Symmetry carries nothing over to what is frozen on the other side.
    salon.0.editor().apply(Event::Select(Select::Curves([right].into())));
    salon.0.editor().act("pen.symmetry");
    salon.0.editor().act("hair.comb");
    salon.draw(&beside, LIGHT);
    assert_eq!(salon.gestures().0.len(), 3);
    assert_eq!(salon.gestures().0[2].curves, [right]);
    salon.0.editor().state.focus = crate::core::room::Room::Viewport;
    salon.0.harness.key_press(egui::Key::Escape);
    salon.rest();
    assert!(salon.0.editor().state.selection.curves.is_empty());
    // Both sides are free again.
    assert_eq!(salon.changed("hair.comb", &beside, LIGHT).len(), 2);
}

#[test]
fn an_implant_takes_the_place_of_no_frozen_cluster() {
    let (mut salon, [left, right]) = two();
    salon.0.editor().apply(Event::Select(Select::Curves([left].into())));
    salon.0.editor().act("hair.implant");
    salon.rest();
    // On the root of the frozen one it stands beside it; on that of the free one it takes its place.
    salon.draw(&Salon::line([350.0, 141.0], [380.0, 400.0]), HEAVY);
    let all = ids(&salon.curves());
    assert!(all.len() == 3 && all.contains(&left) && all.contains(&right), "{all:x?}");
    assert_eq!(salon.gestures().0[2].curves, Vec::<u64>::new());
    salon.draw(&Salon::line([250.0, 141.0], [220.0, 400.0]), HEAVY);
    let all = ids(&salon.curves());
    assert!(all.len() == 3 && !all.contains(&left) && all.contains(&right), "{all:x?}");
    assert_eq!(content_hash(&salon.farmed()), content_hash(&salon.curves()), "a replay");
}
