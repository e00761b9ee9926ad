//! The last touch: points, re-drawing, single strands; what is seen of the skin under hair; where hair grows.

use super::*;
use coif_graphs::document::Setting;

/// The start-up groom with this many hairs.
fn start(hairs: i64) -> Document {
    let text = coif_graphs::grooms::by_name("start").expect("the start-up groom");
    let mut document = coif_graphs::file::read(text).expect("it reads").document;
    let hair = NodeId::new("hair").expect("an id");
    let inputs = &mut Arc::make_mut(document.nodes.get_mut(&hair).expect("hair")).inputs;
    inputs.insert("count".into(), Setting::Known(Value::Int(hairs)));
    document
}

#[test]
fn the_tools_for_strokes_are_those_of_hair_where_hair_was_sketched() {
    let mut salon = Salon::open(head(), "hair.sketch");
    salon.draw(&lock(), HEAVY);
    salon.0.editor().act("pen.select");
    salon.0.editor().act("pen.points");
    assert_eq!(salon.0.editor().pen.tool, super::super::super::PenTool::Hair(Some(Tool::Point)));
    let (was, at) = (salon.curves(), salon.place(0, 4));
    salon.draw(&Salon::line([at.x, at.y], [at.x + 50.0, at.y]), MIDDLE);
    assert_eq!(salon.words(), "moved a point of a cluster");
    let is = salon.curves();
    let cvs = |curves: &Curves| curves.tufts()[0].points().to_vec();
    let moved: Vec<usize> =
        (0..cvs(&was).len()).filter(|k| cvs(&was)[*k] != cvs(&is)[*k]).collect();
    assert_eq!(moved, [4]);
    assert!((salon.place(0, 4).x - at.x - 50.0).abs() < 2.0);
    // From its middle on another way.
    salon.0.editor().act("pen.redraw");
    let at = salon.place(0, 2);
    salon.draw(&Salon::line([at.x, at.y], [at.x - 160.0, at.y + 120.0]), MIDDLE);
    assert_eq!(salon.words(), "re-drew a cluster");
    assert_eq!(cvs(&salon.curves())[..=2], cvs(&is)[..=2]);
    let tip = salon.place(0, 99);
    assert!(tip.distance(Pos2::new(at.x - 160.0, at.y + 120.0)) < 40.0, "{tip}");
    assert_eq!(salon.tools(), [Tool::Implant, Tool::Point, Tool::Redraw]);
    // Each knows whom it changed, and nothing is where no hair is.
    assert!(salon.gestures().0[1..].iter().all(|gesture| gesture.curves.len() == 1));
    salon.draw(&Salon::line([200.0, 120.0], [150.0, 130.0]), MIDDLE);
    assert_eq!(salon.0.done(), 3);
}

#[test]
fn single_strands_are_combed_behind_the_hair_and_keep_it_by_their_ids() {
    let mut salon = Salon::open(start(2000), "hair.comb");
    salon.0.editor().act("hair.strands");
    salon.draw(&Salon::line([300.0, 120.0], [380.0, 150.0]), MIDDLE);
    let node = salon.node().expect("a sketch");
    let document = salon.0.editor().state.document.clone();
    assert_eq!(document.wires(&node, "curves")[0].to_string(), "colour.curves");
    assert_eq!(document.wires(&NodeId::new("out").expect("an id"), "curves")[0].node, node);
    let named = salon.gestures().0[0].curves.clone();
    assert!(!named.is_empty() && named.len() < 1000, "{}", named.len());
    assert_eq!(salon.words(), format!("combed {} strands", named.len()));
    let shown = salon.0.editor().state.shown.clone().expect("a result");
    let hair = Socket::new(NodeId::new("colour").expect("an id"), "curves");
    let was = shown.curves_of(&hair).expect("hair").clone();
    let ids: std::collections::BTreeSet<u64> = was.each().map(|(t, i)| t.id(i)).collect();
    assert!(named.iter().all(|id| ids.contains(id)));
    assert_eq!(salon.curves().curve_count(), was.curve_count());
    // At level 1 it is one strand.
    salon.0.editor().act("hair.level_1");
    let (tuft, i) = was.each().find(|(tuft, i)| tuft.id(*i) == named[0]).expect("a strand");
    let at = salon.0.editor().viewport.projection().screen(tuft.curve(i)[4]).expect("seen");
    let at = salon.0.on_sheet(at);
    salon.draw(&Salon::line([at.x, at.y], [at.x + 40.0, at.y - 30.0]), MIDDLE);
    assert_eq!(salon.words(), "combed a strand");
    // Without it the guides are meant again, with a sketch of their own before the hair.
    salon.0.editor().act("hair.strands");
    salon.0.editor().act("hair.level_1");
    salon.draw(&Salon::line([300.0, 130.0], [230.0, 150.0]), MIDDLE);
    let guides = salon.node().expect("a sketch");
    assert_ne!(guides, node);
    let document = salon.0.editor().state.document.clone();
    assert_eq!(document.wires(&guides, "curves")[0].to_string(), "guides.curves");
    assert_eq!(coif_graphs::document::graph::check(&document), vec![]);
}

#[test]
fn hair_is_seen_through_only_while_the_pen_is_down_on_the_skin() {
    let mut salon = Salon::open(head(), "hair.implant");
    salon.draw(&lock(), MIDDLE);
    let through = |salon: &mut Salon| {
        salon.0.step();
        salon.0.step();
        salon.0.editor().viewport.pen.skin
    };
    let at = Pos2::new(320.0, 200.0);
    for (action, places, pressure, expected) in [
        ("hair.implant", lock(), MIDDLE, true),
        ("hair.comb", Salon::line([310.0, 250.0], [360.0, 260.0]), MIDDLE, false),
        // A hand that presses hard tells it while it draws.
        ("hair.sketch", lock(), HEAVY, true),
        ("hair.level_3", lock(), MIDDLE, true),
    ] {
        salon.0.editor().act(action);
        salon.report(Phase::Hover, at, 0.0, End::Tip);
        assert!(!through(&mut salon), "{action}: before it touches");
        salon.begin(&places, pressure, End::Tip);
        assert_eq!(through(&mut salon), expected, "{action}");
        salon.report(Phase::Up, places[24], 0.0, End::Tip);
        assert!(!through(&mut salon), "{action}: lifted");
        salon.rest();
        salon.report(Phase::Hover, places[24], 0.0, End::Tip);
        assert!(!through(&mut salon), "{action}: between strokes");
    }
}

#[test]
fn an_implant_where_a_groom_grows_no_hair_is_not_kept_and_says_why() {
    let mut salon = Salon::open(start(2000), "hair.implant");
    let before = salon.0.editor().state.document.clone();
    // On the cheek.
    salon.draw(&Salon::line([350.0, 420.0], [360.0, 470.0]), MIDDLE);
    let said = salon.0.editor().pen.said.clone().expect("a word").text;
    assert!(said.contains("No hair grows here"), "{said}");
    assert_eq!((salon.0.done(), salon.0.editor().state.document == before), (0, true));
    // Where hair grows it is one.
    salon.draw(&Salon::line([300.0, 120.0], [330.0, 180.0]), MIDDLE);
    assert_eq!(salon.words(), "implanted a cluster", "{:?}", salon.0.editor().pen.said);
}

#[test]
fn a_comb_has_the_size_of_the_brush_and_takes_hair_as_far_as_the_pen() {
    let mut salon = Salon::open(head(), "hair.sketch");
    salon.draw(&lock(), HEAVY);
    salon.0.editor().act("hair.comb");
    let radius = |salon: &mut Salon| {
        let gestures = salon.gestures();
        gestures.0.last().map_or(0.0, |gesture| gesture.size)
    };
    // Between two CVs, where the lock is half down.
    let at = salon.place(0, 2) + (salon.place(0, 3) - salon.place(0, 2)) * 0.5;
    let to = at + Vec2::new(60.0, -30.0);
    salon.draw(&Salon::line([at.x, at.y], [to.x, to.y]), MIDDLE);
    assert_eq!(salon.words(), "combed a cluster");
    let count = salon.curves().tufts()[0].points().len();
    let near = (0..count).map(|k| salon.place(0, k).distance(to)).fold(f32::MAX, f32::min);
    // CVs are a sixth of the brush apart.
    assert!(near < 12.0, "{near}");
    let wide = radius(&mut salon);
    salon.0.editor().act("pen.brush_smaller");
    salon.draw(&Salon::line([to.x, to.y], [at.x, at.y]), MIDDLE);
    let smaller = radius(&mut salon);
    assert!(smaller > 2.0 && smaller < wide, "{smaller} {wide}");
}

#[test]
fn a_level_by_the_papers_mean_is_told_within_two_pixels() {
    let mut salon = Salon::open(head(), "hair.sketch");
    salon.draw(&lock(), HEAVY);
    // It begins lightly, and is pressed down within the next 80 ms.
    let at = salon.place(0, 4);
    let places = Salon::line([at.x, at.y], [at.x + 60.0, at.y]);
    let press = |salon: &mut Salon| {
        salon.0.time += 1.0;
        for (k, at) in places.iter().enumerate() {
            let phase = if k == 0 { Phase::Down } else { Phase::Move };
            salon.report(phase, *at, if k < 2 { LIGHT } else { MIDDLE }, End::Tip);
        }
        salon.report(Phase::Up, places[24], 0.0, End::Tip);
        salon.rest();
        let gestures = salon.gestures();
        gestures.0.last().map(|gesture| gesture.layer)
    };
    assert_eq!(press(&mut salon), Some(Layer::Through));
    salon.0.editor().apply(crate::core::event::Event::Undo);
    let mut settings = salon.0.editor().state.settings.clone();
    settings.pen.level_by_mean = true;
    salon.0.editor().apply(crate::core::event::Event::Settings(settings.into()));
    assert_eq!(press(&mut salon), Some(Layer::Nearest));
}

#[test]
fn a_closed_stroke_on_the_head_is_where_hair_grows_in_one_step() {
    let mut table = draw_on(start(2000));
    let before = table.editor().state.document.clone();
    table.editor().act("pen.region");
    // A ring about the crown, seen from above and a little in front.
    let ring = |k: i32| {
        let turn = std::f32::consts::TAU * k as f32 / 60.0;
        (Pos2::new(300.0, 290.0) + Vec2::angled(turn) * 70.0, 0.5)
    };
    table.draw(&(0..=60).map(ring).collect::<Vec<_>>());
    table.rest();
    let head = NodeId::new("head").expect("an id");
    let node = table.editor().state.document.node("head").expect("a head").clone();
    let text = |input: &str| node.inputs.get(input).cloned();
    assert_eq!(text("region"), Some(Setting::Known(Value::Text("hairline".into()))));
    assert!(text("hairline").is_some());
    // All hair is inside: within 7 cm or so of the crown, from above.
    let state = &table.editor().state;
    let shown = state.shown.clone().expect("a result");
    assert!(!state.stale() && state.pinned == Some(head.clone()));
    let frame = *shown.scalp().expect("a head").frame();
    let far = shown.curves.each().map(|(tuft, i)| {
        let p = frame.head_from_point(tuft.curve(i)[0]);
        Vec2::new(p.x, p.z).length()
    });
    let far = far.fold(0.0, f32::max);
    assert!(far > 2.0 && far < 6.5, "{far}");
    table.editor().apply(crate::core::event::Event::Undo);
    assert_eq!(table.editor().state.document, before);
    // The same again ends it.
    table.editor().act("pen.region");
    assert_eq!(table.editor().state.pinned, None);
}
