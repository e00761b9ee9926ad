//! What can be done with the view by name.

use super::Step;
use super::navigation::{FOCALS, with_focal, with_parallel_rays};
use super::options::SHOWS;
use super::select::names;
use crate::core::event::Event;
use crate::core::room::Room;
use crate::core::state::Select;
use crate::editor::Editor;
use crate::editor::actions::{Action, always};
use coif_graphs::document::NodeId;
use coif_graphs::document::graph::upstream;
use egui::Vec2;
use std::collections::BTreeSet;

/// Degrees that a key turns by.
const TURN: f32 = 15.0;
/// Part of the picture that a key moves it by.
const SHIFT: f32 = 0.1;
/// What a key scales the distance by.
const ZOOM: f32 = 0.8;
/// Stops that a key makes it brighter by.
const STOP: f32 = 0.5;

/// The action of a named view.
pub(super) fn view_action(name: &str) -> &'static str {
    let found =
        ACTIONS.iter().find(|a| a.id.strip_prefix("view.from_") == Some(&name.replace('-', "_")));
    found.map_or("view.frame_all", |action| action.id)
}

fn something_shown(editor: &Editor) -> Result<(), &'static str> {
    editor.state.shown.as_ref().map(|_| ()).ok_or("nothing is displayed")
}

fn curves_selected(editor: &Editor) -> Result<(), &'static str> {
    match editor.state.selection.curves.is_empty() {
        true => Err("no curve is selected"),
        false => Ok(()),
    }
}

fn a_head(editor: &Editor) -> Result<(), &'static str> {
    let shown = editor.state.shown.as_ref();
    match shown.is_some_and(|shown| !shown.scalps.is_empty()) {
        true => Ok(()),
        false => Err("no head is displayed"),
    }
}

fn step(editor: &mut Editor, step: Step) {
    let now = editor.now;
    editor.viewport.step(&editor.state, now, step);
}

/// The names by which the selected curves are hidden or alone: their own.
fn selected(editor: &Editor) -> BTreeSet<u64> {
    editor.state.selection.curves.clone()
}

macro_rules! view {
    ($id:literal, $name:literal, $label:literal) => {
        Action {
            id: $id,
            label: $label,
            tip: "Looks at the head from here, with all hair in the picture; close-ups look at this place.",
            words: "camera view look from",
            menu: "View",
            when: something_shown,
            run: |editor| editor.viewport.look_from($name, &editor.state),
        }
    };
}

macro_rules! toggle {
    ($id:literal, $label:literal, $tip:literal, $words:literal, $field:ident) => {
        Action {
            id: $id,
            label: $label,
            tip: $tip,
            words: $words,
            menu: "View",
            when: always,
            run: |editor| {
                let options = &mut editor.viewport.options;
                options.$field = !options.$field;
            },
        }
    };
}

macro_rules! key_step {
    ($id:literal, $label:literal, $step:expr) => {
        Action {
            id: $id,
            label: $label,
            tip: "Moves the eye a little.",
            words: "orbit pan zoom keyboard view",
            menu: "",
            when: always,
            run: |editor| step(editor, $step),
        }
    };
}

/// The room's part of the table.
pub(crate) const ACTIONS: &[Action] = &[
    Action {
        id: "view.frame_selected",
        label: "Frame selected",
        tip: "Fills the picture with the selected curves, else with what the active node gives.",
        words: "focus zoom fit look at",
        menu: "View",
        when: something_shown,
        run: |editor| editor.viewport.frame_selected(&editor.state),
    },
    Action {
        id: "view.frame_head",
        label: "Frame the head",
        tip: "Fills the picture with skull and face.",
        words: "focus zoom fit look at skull",
        menu: "View",
        when: a_head,
        run: |editor| editor.viewport.frame_heads(&editor.state),
    },
    Action {
        id: "view.frame_all",
        label: "Frame all",
        tip: "Fills the picture with everything.",
        words: "focus zoom fit home",
        menu: "View",
        when: something_shown,
        run: |editor| editor.viewport.frame_all(&editor.state),
    },
    Action {
        id: "view.back",
        label: "View before",
        tip: "Looks from where the eye rested before. No undo step.",
        words: "previous camera back",
        menu: "View",
        when: |editor| if editor.viewport.ways().0 { Ok(()) } else { Err("there is none before") },
        run: |editor| editor.viewport.go(false),
    },
    Action {
        id: "view.forward",
        label: "View after",
        tip: "Goes forward again through the views.",
        words: "next camera forward",
        menu: "View",
        when: |editor| if editor.viewport.ways().1 { Ok(()) } else { Err("there is none after") },
        run: |editor| editor.viewport.go(true),
    },
    view!("view.from_front", "front", "From the front"),
    view!("view.from_left", "left", "From the left"),
    view!("view.from_right", "right", "From the right"),
    view!("view.from_back", "back", "From the back"),
    view!("view.from_top", "top", "From above"),
    view!("view.from_under", "under", "From below"),
    view!("view.from_three_quarter", "three-quarter", "Three quarters"),
    view!("view.from_crown", "crown", "Close to the crown"),
    view!("view.from_nape", "nape", "Close to the nape"),
    view!("view.from_hairline", "hairline", "Close to the hairline"),
    view!("view.from_temple_left", "temple-left", "Close to the left temple"),
    view!("view.from_temple_right", "temple-right", "Close to the right temple"),
    Action {
        id: "view.orthographic",
        label: "Parallel rays",
        tip: "With perspective, or without: what is looked at keeps its size.",
        words: "orthographic perspective flat isometric",
        menu: "View",
        when: always,
        run: |editor| {
            let camera = *editor.viewport.camera();
            let flat = camera.orthographic.is_some();
            editor.viewport.look(with_parallel_rays(&camera, !flat));
        },
    },
    Action {
        id: "view.longer_lens",
        label: "Longer lens",
        tip: "A longer focal length from farther away; what is looked at keeps its size.",
        words: "focal length zoom lens telephoto",
        menu: "View",
        when: |editor| lens(editor, 1.25),
        run: |editor| set_lens(editor, 1.25),
    },
    Action {
        id: "view.shorter_lens",
        label: "Shorter lens",
        tip: "A shorter focal length from nearer; what is looked at keeps its size.",
        words: "focal length wide angle lens",
        menu: "View",
        when: |editor| lens(editor, 0.8),
        run: |editor| set_lens(editor, 0.8),
    },
    Action {
        id: "view.groom",
        label: "Groom display",
        tip: "Plain colours with the same shadows whatever the pigment, and back to what was shown.",
        words: "grey clay colours show hair",
        menu: "View",
        when: always,
        run: |editor| editor.viewport.options.toggle_groom(),
    },
    Action {
        id: "view.next_show",
        label: "Next colours",
        tip: "Shows the next of hair, groom colours, guides, clusters and heat maps.",
        words: "cycle display mode heat map",
        menu: "View",
        when: always,
        run: |editor| {
            let options = &mut editor.viewport.options;
            let at = SHOWS.iter().position(|(words, _)| *words == options.show).unwrap_or(0);
            SHOWS[(at + 1) % SHOWS.len()].0.clone_into(&mut options.show);
        },
    },
    Action {
        id: "view.brighter",
        label: "Brighter",
        tip: "Half a stop more exposure.",
        words: "exposure light gain",
        menu: "View",
        when: always,
        run: |editor| editor.viewport.options.expose(STOP),
    },
    Action {
        id: "view.darker",
        label: "Darker",
        tip: "Half a stop less exposure.",
        words: "exposure light gain",
        menu: "View",
        when: always,
        run: |editor| editor.viewport.options.expose(-STOP),
    },
    toggle!(
        "view.head",
        "Show or hide the head",
        "Shows the head, or only hair.",
        "skin scalp bust",
        head
    ),
    toggle!(
        "view.guides",
        "Guides over the picture",
        "The curves that hair follows, as lines.",
        "overlay curves",
        guides
    ),
    toggle!(
        "view.partings",
        "Partings over the picture",
        "Lines on the skin between hair of different braids or curves.",
        "overlay sections",
        partings
    ),
    toggle!(
        "view.roots",
        "Roots over the picture",
        "A dot where each hair grows.",
        "overlay follicles",
        roots
    ),
    toggle!(
        "view.handles",
        "Handles over the picture",
        "What of the active node can be dragged in the viewport.",
        "gizmo manipulator",
        handles
    ),
    Action {
        id: "view.isolate",
        label: "Isolate",
        tip: "Only the selected curves are shown; again shows all. The result stays as it is.",
        words: "solo alone local view",
        menu: "View",
        when: |editor| match editor.state.visibility.alone.is_empty() {
            true => curves_selected(editor),
            false => Ok(()),
        },
        run: |editor| {
            let alone = match editor.state.visibility.alone.is_empty() {
                true => selected(editor),
                false => BTreeSet::new(),
            };
            editor.state.visibility.alone = alone;
        },
    },
    Action {
        id: "view.hide",
        label: "Hide",
        tip: "The selected curves are not shown. The result stays as it is.",
        words: "invisible eye",
        menu: "View",
        when: curves_selected,
        run: |editor| {
            let ids = selected(editor);
            editor.state.visibility.hidden.extend(ids);
            editor.apply(Event::Select(Select::Curves(BTreeSet::new())));
        },
    },
    Action {
        id: "view.show_all",
        label: "Show all",
        tip: "Nothing is hidden or alone any more.",
        words: "unhide reveal visible",
        menu: "View",
        when: |editor| match editor.state.visibility.shows_all() {
            true => Err("nothing is hidden"),
            false => Ok(()),
        },
        run: |editor| {
            editor.state.visibility.hidden.clear();
            editor.state.visibility.alone.clear();
        },
    },
    Action {
        id: "view.lock",
        label: "Lock",
        tip: "The pen does not touch the selected curves; again unlocks them.",
        words: "protect freeze",
        menu: "View",
        when: curves_selected,
        run: |editor| {
            let ids = selected(editor);
            let locked = &mut editor.state.visibility.locked;
            if ids.iter().all(|id| locked.contains(id)) {
                ids.iter().for_each(|id| {
                    locked.remove(id);
                });
            } else {
                locked.extend(ids);
            }
        },
    },
    Action {
        id: "view.select_kin",
        label: "Select with its kin",
        tip: "Selects all hair of the braids, or of the curves, that the selected hair belongs to.",
        words: "grow selection braid cluster similar",
        menu: "View",
        when: curves_selected,
        run: |editor| {
            let Some(shown) = editor.state.shown.clone() else { return };
            let ids = selected(editor);
            let kin = |n: [u64; 3]| n.into_iter().skip(1).rfind(|name| *name != 0);
            let all = || shown.curves.each().map(|(tuft, i)| names(tuft, i));
            let owners: BTreeSet<u64> =
                all().filter(|n| ids.contains(&n[0])).filter_map(kin).collect();
            let more = all().filter(|n| kin(*n).is_some_and(|owner| owners.contains(&owner)));
            let more = ids.iter().copied().chain(more.map(|n| n[0])).collect();
            editor.apply(Event::Select(Select::Curves(more)));
        },
    },
    Action {
        id: "view.select_node",
        label: "Go to its node",
        tip: "Shows the node that made the hair that was clicked last.",
        words: "maker source canvas find reveal",
        menu: "View",
        when: |editor| match editor.state.active() {
            Some(_) => curves_selected(editor),
            None => Err("it is not known which node made it"),
        },
        run: |editor| {
            editor.apply(Event::Show(Room::Canvas));
            editor.act("canvas.fit_selection");
        },
    },
    Action {
        id: "view.what_made",
        label: "What made this hair",
        tip: "Finds the nodes, strokes and gestures without which the hair would be another, by switching them off one after the other; \
              the messages list them.",
        words: "trace provenance where from why source stroke gesture origin debug",
        menu: "View",
        when: |editor| something_shown(editor).and_then(|()| curves_selected(editor)),
        run: |editor| {
            let meant = editor.viewport.hair_meant(&editor.state.selection.curves);
            meant.into_iter().for_each(|id| editor.apply(Event::WhatMade(id)));
        },
    },
    Action {
        id: "view.reveal",
        label: "Show in the outliner",
        tip: "Scrolls the outliner to the braid or cluster that the selected hair belongs to.",
        words: "reveal find tree list braid",
        menu: "View",
        when: curves_selected,
        run: |editor| {
            editor.outliner.reveal();
            editor.apply(Event::Show(Room::Outliner));
        },
    },
    Action {
        id: "view.select_head",
        label: "Select the head's node",
        tip: "Selects the node that gives the head, for the inspector.",
        words: "scalp bust mesh",
        menu: "View",
        when: a_head,
        run: |editor| {
            let document = &editor.state.document;
            let shown = editor.state.shown.iter().flat_map(|shown| &shown.sockets);
            let way = upstream(document, shown.map(|socket| &socket.node));
            let is_head =
                |id: &&NodeId| document.node(id.as_str()).is_some_and(|n| n.kind == "head");
            if let Some(head) = way.iter().find(is_head) {
                editor.apply(Event::Select(Select::Nodes(vec![head.clone()])));
            }
        },
    },
    key_step!("view.orbit_left", "Orbit left", Step::Orbit { around: -TURN, over: 0.0 }),
    key_step!("view.orbit_right", "Orbit right", Step::Orbit { around: TURN, over: 0.0 }),
    key_step!("view.orbit_up", "Orbit up", Step::Orbit { around: 0.0, over: TURN }),
    key_step!("view.orbit_down", "Orbit down", Step::Orbit { around: 0.0, over: -TURN }),
    key_step!("view.pan_left", "Pan left", Step::Pan(Vec2::new(-SHIFT, 0.0))),
    key_step!("view.pan_right", "Pan right", Step::Pan(Vec2::new(SHIFT, 0.0))),
    key_step!("view.pan_up", "Pan up", Step::Pan(Vec2::new(0.0, -SHIFT))),
    key_step!("view.pan_down", "Pan down", Step::Pan(Vec2::new(0.0, SHIFT))),
    key_step!("view.closer", "Closer", Step::Zoom(ZOOM)),
    key_step!("view.farther", "Farther", Step::Zoom(1.0 / ZOOM)),
];

fn lens(editor: &Editor, factor: f32) -> Result<(), &'static str> {
    let wanted = editor.viewport.camera().focal_mm * factor;
    match (FOCALS.0 * 0.99..=FOCALS.1 * 1.01).contains(&wanted) {
        true => Ok(()),
        false => Err("there are no such lenses"),
    }
}

fn set_lens(editor: &mut Editor, factor: f32) {
    let camera = *editor.viewport.camera();
    editor.viewport.look(with_focal(&camera, camera.focal_mm * factor));
}
