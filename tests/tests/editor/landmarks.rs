//! Landmarks dragged over real heads in the whole window: what the document says then, and what undo gives back.

use super::harness::settle;
use super::story::{Hand, Story};
use coif::core::documents;
use coif::core::event::Event;
use coif::core::state::Select;
use coif_graphs::document::edit::Edit;
use coif_graphs::document::{NodeId, Setting, Socket};
use coif_nodes::data::landmarks::{Landmark, Landmarks};
use coif_nodes::data::scalp::Scalp;
use coif_nodes::define::Value;
use coif_tests::{Folder, shared};
use egui::{Event as Input, Modifiers, PointerButton, Pos2, Vec2};
use egui_kittest::kittest::Queryable as _;
use std::sync::Arc;

/// Landmarks of the built-in head, roughly: a home.
const HOME: &str = "front 0 7 7.2; nape 0 -6 -7; left temple 6 2 4.4; right temple -6 2 4.4; left ear 6.7 -2 0; \
                    right ear -6.7 -2 0; crown 0 8.3 -3.9; chin 0 -10 7.3";

fn head() -> NodeId {
    NodeId::new("head").expect("an id")
}

impl Story {
    /// A bare head of this mesh, selected, and with this home.
    fn on_head(mesh: &std::path::Path, name: &'static str, home: &str, folder: &Folder) -> Self {
        let mut story = Self::begin(name, Hand::Mouse, folder);
        let editor = story.ui.state_mut();
        editor.apply(Event::Documents(documents::DocumentEvent::New(None)));
        editor.apply(Event::Documents(documents::DocumentEvent::Mesh(mesh.to_owned())));
        settle(&mut story.ui);
        story.click("Accept");
        let editor = story.ui.state_mut();
        if !home.is_empty() {
            let (node, input) = (head(), "home".to_owned());
            let setting = Setting::Known(Value::Text(home.into()));
            editor.apply(Event::Edit(Edit::SetInput { node, input, setting }));
        }
        editor.apply(Event::Select(Select::Nodes(vec![head()])));
        story.sees_head();
        story
    }

    fn sees_head(&mut self) {
        settle(&mut self.ui);
        while !self.ui.state().viewport.is_idle() {
            self.ui.step();
        }
        self.ui.run_steps(3);
    }

    fn scalp(&self) -> Arc<Scalp> {
        let shown = self.ui.state().state.shown.as_ref().expect("a head");
        let Value::Scalp(scalp) = &shown.values[&Socket::new(head(), "scalp")] else {
            panic!("a head gives a scalp");
        };
        scalp.clone()
    }

    /// What the document states.
    fn said(&self) -> (String, Landmarks) {
        let node = &self.ui.state().state.document.nodes["head"];
        let text = match node.inputs.get("landmarks") {
            Some(Setting::Known(Value::Text(text))) => text.to_string(),
            None => String::new(),
            other => panic!("{other:?}"),
        };
        let (said, faults) = Landmarks::parse(&text);
        assert_eq!(faults, Vec::<String>::new());
        (text, said)
    }

    fn place(&self, label: &str) -> Option<Pos2> {
        self.ui.query_all_by_label(label).next().map(|node| node.rect().center())
    }

    fn right_click(&mut self, at: Pos2) {
        for pressed in [true, false] {
            self.ui.event(Input::PointerMoved(at));
            let (button, modifiers) = (PointerButton::Secondary, Modifiers::NONE);
            self.ui.event(Input::PointerButton { pos: at, button, pressed, modifiers });
            self.ui.run_steps(2);
        }
        self.ui.run_steps(2);
    }
}

#[test]
fn a_dragged_landmark_is_on_the_skin_where_it_was_put_and_undo_takes_it_back() {
    const NAME: &str = "a_dragged_landmark_is_on_the_skin_where_it_was_put_and_undo_takes_it_back";
    for (name, mesh, home) in [
        ("landmarks-ict", "data/ict_head/generic_neutral_mesh.obj", ""),
        ("landmarks-sintel", "data/sintel/sintel.obj", HOME),
    ] {
        let Some(mesh) = shared(NAME, mesh) else { return };
        let folder = Folder::new(name);
        let mut story = Story::on_head(&mesh, name, home, &folder);
        story.picture("1-guessed");
        let guessed = *story.scalp().landmarks();
        assert_eq!(guessed.missing(), None, "{name}");
        // From the front the back of the head is hidden.
        assert!(story.place("Landmark nape, guessed").is_none(), "{name}");
        let steps = story.ui.state().state.history.done();
        // The temple is near the edge of the head, off which there is no skin.
        for (mark, by) in [
            (Landmark::Chin, Vec2::new(14.0, -9.0)),
            (Landmark::LeftTemple, Vec2::new(-14.0, -9.0)),
        ] {
            let label = format!("Landmark {}, guessed", mark.name());
            let from = story.place(&label).unwrap_or_else(|| panic!("{name}: {label}"));
            let before = story.said().1;
            story.drag(&label, by);
            story.sees_head();
            let (scalp, (text, said)) = (story.scalp(), story.said());
            let at = scalp.frame().point_from_head(said.get(mark).expect("it is stated"));
            let off = scalp.surface().closest(at).expect("skin").point.distance(at);
            assert!(off < 1e-4, "{name}: {off} cm from the skin: {text}");
            let view = story.ui.state().viewport.projection();
            let drawn = view.screen(at).expect("it is seen");
            assert!(drawn.distance(from + by) < 0.1, "{name}: {drawn} for {}", from + by);
            // Nothing else is stated, and the evaluation went along.
            for other in Landmark::ALL.into_iter().filter(|other| *other != mark) {
                assert_eq!(said.get(other), before.get(other), "{name}: {text}");
            }
            let here = scalp.landmarks().get(mark).expect("it is known");
            assert!(scalp.frame().point_from_head(here).distance(at) < 1e-4, "{name}");
            assert!(story.place(&format!("Landmark {}, set", mark.name())).is_some(), "{name}");
        }
        assert_eq!(story.ui.state().state.history.done(), steps + 2, "{name}: one step a drag");
        story.picture("2-set");
        // The right button leaves the one to be guessed again, and undo has it back.
        let at = story.place("Landmark chin, set").expect("it is there");
        story.right_click(at);
        story.picture("3-menu");
        story.click("Guess again");
        story.sees_head();
        let said = story.said().1;
        assert!(said.get(Landmark::Chin).is_none() && said.get(Landmark::LeftTemple).is_some());
        assert_eq!(story.scalp().landmarks().get(Landmark::Chin), guessed.get(Landmark::Chin));
        for _ in 0..3 {
            story.ui.state_mut().apply(Event::Undo);
        }
        story.sees_head();
        assert_eq!(story.said().0, "", "{name}");
        assert_eq!(*story.scalp().landmarks(), guessed, "{name}");
    }
}
