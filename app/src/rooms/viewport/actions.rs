//! What can be done with the view by name.

use super::navigation::{FOCALS, with_focal, with_parallel_rays};
use super::select::names;
use super::{Step, Viewport};
use crate::core::action::{Action, Can, Of, always};
use crate::core::documents::{DocumentEvent, Purpose};
use crate::core::event::Event;
use crate::core::room::Room;
use crate::core::state::{Select, State};
use crate::core::visibility::Visibility;
use crate::scene::SHOWS;
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

fn something_shown(_: &Viewport, state: &State) -> Can {
    state.shown.as_ref().map(|_| ()).ok_or("nothing is displayed")
}

fn curves_selected(_: &Viewport, state: &State) -> Can {
    match state.selection.curves.is_empty() {
        true => Err("no curve is selected"),
        false => Ok(()),
    }
}

fn a_head(_: &Viewport, state: &State) -> Can {
    let shown = state.shown.as_ref();
    match shown.is_some_and(|shown| !shown.scalps.is_empty()) {
        true => Ok(()),
        false => Err("no head is displayed"),
    }
}

/// The names by which the selected curves are hidden or alone: their own.
fn selected(state: &State) -> BTreeSet<u64> {
    state.selection.curves.clone()
}

macro_rules! view {
    ($id:literal, $name:literal, $label:literal) => {
        Action {
            id: $id,
            label: $label,
            tip: "Look at the head from here, with all hair in view; close-ups frame this place.",
            words: "camera view look from",
            menu: "View",
            when: something_shown,
            run: |viewport, state, _| viewport.look_from($name, state),
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
            run: |viewport, _, _| {
                let options = &mut viewport.options;
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
            tip: "Nudge the camera.",
            words: "orbit pan zoom keyboard view",
            menu: "",
            when: always,
            run: |viewport, state, _| viewport.step(state, state.now, $step),
        }
    };
}

macro_rules! light {
    ($id:literal, $label:literal, $degrees:expr) => {
        Action {
            id: $id,
            label: $label,
            tip: "Turn the lights about the head; or drag over the picture with Shift and the right button.",
            words: "rotate lamp sun hdri environment key",
            menu: "View",
            when: always,
            run: |viewport, _, _| viewport.options.turn_light($degrees),
        }
    };
}

/// The room's part of the table.
pub(crate) const ACTIONS: &[Of<Viewport>] = &[
    Action {
        id: "view.frame_selected",
        label: "Frame selected",
        tip: "Frame the selected curves, or else the output of the active node.",
        words: "focus zoom fit look at",
        menu: "View",
        when: something_shown,
        run: |viewport, state, _| viewport.frame_selected(state),
    },
    Action {
        id: "view.frame_head",
        label: "Frame the head",
        tip: "Frame skull and face.",
        words: "focus zoom fit look at skull",
        menu: "View",
        when: a_head,
        run: |viewport, state, _| viewport.frame_heads(state),
    },
    Action {
        id: "view.frame_all",
        label: "Frame all",
        tip: "Frame everything.",
        words: "focus zoom fit home",
        menu: "View",
        when: something_shown,
        run: |viewport, state, _| viewport.frame_all(state),
    },
    Action {
        id: "view.back",
        label: "Previous view",
        tip: "Go back to the previous view. Not an undo step.",
        words: "previous camera back",
        menu: "View",
        when: |viewport, _| {
            if viewport.ways().0 { Ok(()) } else { Err("there is no previous view") }
        },
        run: |viewport, _, _| viewport.go(false),
    },
    Action {
        id: "view.forward",
        label: "Next view",
        tip: "Go forward to the next view.",
        words: "next camera forward",
        menu: "View",
        when: |viewport, _| if viewport.ways().1 { Ok(()) } else { Err("there is no next view") },
        run: |viewport, _, _| viewport.go(true),
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
        label: "Orthographic",
        tip: "Switch between perspective and orthographic; the subject keeps its size.",
        words: "orthographic perspective flat isometric",
        menu: "View",
        when: always,
        run: |viewport, _, _| {
            let camera = *viewport.camera();
            let flat = camera.orthographic.is_some();
            viewport.look(with_parallel_rays(&camera, !flat));
        },
    },
    Action {
        id: "view.longer_lens",
        label: "Longer lens",
        tip: "Longer focal length from farther away; the subject keeps its size.",
        words: "focal length zoom lens telephoto",
        menu: "View",
        when: |viewport, _| lens(viewport, 1.25),
        run: |viewport, _, _| set_lens(viewport, 1.25),
    },
    Action {
        id: "view.shorter_lens",
        label: "Shorter lens",
        tip: "Shorter focal length from nearer; the subject keeps its size.",
        words: "focal length wide angle lens",
        menu: "View",
        when: |viewport, _| lens(viewport, 0.8),
        run: |viewport, _, _| set_lens(viewport, 0.8),
    },
    Action {
        id: "view.groom",
        label: "Groom display",
        tip: "Show plain colours, shaded alike for every pigment. Again: the previous display mode.",
        words: "grey clay colours show hair",
        menu: "View",
        when: always,
        run: |viewport, _, _| viewport.options.toggle_groom(),
    },
    Action {
        id: "view.next_show",
        label: "Next colours",
        tip: "Cycle through hair, groom colours, guides, clusters and heat maps.",
        words: "cycle display mode heat map",
        menu: "View",
        when: always,
        run: |viewport, _, _| {
            let options = &mut viewport.options;
            let at = SHOWS.iter().position(|mode| mode.name == options.show).unwrap_or(0);
            SHOWS[(at + 1) % SHOWS.len()].name.clone_into(&mut options.show);
        },
    },
    Action {
        id: "view.brighter",
        label: "Brighter",
        tip: "Raise exposure by half a stop.",
        words: "exposure light gain",
        menu: "View",
        when: always,
        run: |viewport, _, _| viewport.options.expose(STOP),
    },
    Action {
        id: "view.darker",
        label: "Darker",
        tip: "Lower exposure by half a stop.",
        words: "exposure light gain",
        menu: "View",
        when: always,
        run: |viewport, _, _| viewport.options.expose(-STOP),
    },
    light!("view.light_left", "Turn the light left", -TURN),
    light!("view.light_right", "Turn the light right", TURN),
    Action {
        id: "view.surroundings",
        label: "Surroundings…",
        tip: "Light the picture by a photographed sphere (.hdr, .exr). You can also drop one on the window.",
        words: "hdri environment map ibl sky image based lighting exr",
        menu: "View",
        when: always,
        run: |_, _, out| out.push(Event::Documents(DocumentEvent::Ask(Purpose::Surroundings))),
    },
    toggle!(
        "view.head",
        "Show or hide the head",
        "Show or hide the head under the hair.",
        "skin scalp bust",
        head
    ),
    toggle!(
        "view.guides",
        "Guides over the picture",
        "Show the curves that hair follows, as lines.",
        "overlay curves",
        guides
    ),
    toggle!(
        "view.partings",
        "Partings over the picture",
        "Lines on the skin between hair of different braids or guides.",
        "overlay sections",
        partings
    ),
    toggle!(
        "view.roots",
        "Roots over the picture",
        "A dot at each root.",
        "overlay follicles",
        roots
    ),
    toggle!(
        "view.handles",
        "Handles over the picture",
        "Show the active node's handles in the viewport.",
        "gizmo manipulator",
        handles
    ),
    Action {
        id: "view.isolate",
        label: "Isolate",
        tip: "Show only the selected curves; again: show all. The output stays as it is.",
        words: "solo alone local view",
        menu: "View",
        when: |viewport, state| match state.visibility.alone.is_empty() {
            true => curves_selected(viewport, state),
            false => Ok(()),
        },
        run: |_, state, out| {
            let alone = match state.visibility.alone.is_empty() {
                true => selected(state),
                false => BTreeSet::new(),
            };
            out.push(Event::Visibility(Visibility { alone, ..state.visibility.clone() }));
        },
    },
    Action {
        id: "view.hide",
        label: "Hide",
        tip: "Hide the selected curves. The output stays as it is.",
        words: "invisible eye",
        menu: "View",
        when: curves_selected,
        run: |_, state, out| {
            let mut visibility = state.visibility.clone();
            visibility.hidden.extend(selected(state));
            out.push(Event::Visibility(visibility));
            out.push(Event::Select(Select::Curves(BTreeSet::new())));
        },
    },
    Action {
        id: "view.show_all",
        label: "Show all",
        tip: "Show all hair again.",
        words: "unhide reveal visible",
        menu: "View",
        when: |_, state| match state.visibility.shows_all() {
            true => Err("nothing is hidden"),
            false => Ok(()),
        },
        run: |_, state, out| {
            let locked = state.visibility.locked.clone();
            out.push(Event::Visibility(Visibility { locked, ..Visibility::default() }));
        },
    },
    Action {
        id: "view.lock",
        label: "Lock",
        tip: "Lock the selected curves against the pen; again: unlock them.",
        words: "protect freeze",
        menu: "View",
        when: curves_selected,
        run: |_, state, out| {
            let ids = selected(state);
            let mut locked = state.visibility.locked.clone();
            if ids.iter().all(|id| locked.contains(id)) {
                ids.iter().for_each(|id| {
                    locked.remove(id);
                });
            } else {
                locked.extend(ids);
            }
            out.push(Event::Visibility(Visibility { locked, ..state.visibility.clone() }));
        },
    },
    Action {
        id: "view.select_kin",
        label: "Select related hair",
        tip: "Select all hair of the same braids or parent curves.",
        words: "grow selection braid cluster similar",
        menu: "View",
        when: curves_selected,
        run: |_, state, out| {
            let Some(shown) = &state.shown else { return };
            let ids = selected(state);
            let kin = |n: [u64; 3]| n.into_iter().skip(1).rfind(|name| *name != 0);
            let all = || shown.curves.each().map(|(tuft, i)| names(tuft, i));
            let owners: BTreeSet<u64> =
                all().filter(|n| ids.contains(&n[0])).filter_map(kin).collect();
            let more = all().filter(|n| kin(*n).is_some_and(|owner| owners.contains(&owner)));
            let more = ids.iter().copied().chain(more.map(|n| n[0])).collect();
            out.push(Event::Select(Select::Curves(more)));
        },
    },
    Action {
        id: "view.select_node",
        label: "Go to its node",
        tip: "Show the node that made the hair clicked last.",
        words: "maker source canvas find reveal",
        menu: "View",
        when: |viewport, state| match state.active() {
            Some(_) => curves_selected(viewport, state),
            None => Err("it is not known which node made it"),
        },
        run: |_, _, out| {
            out.push(Event::Show(Room::Canvas));
            out.push(Event::Act("canvas.fit_selection"));
        },
    },
    Action {
        id: "view.what_made",
        label: "What made this hair",
        tip: "List the nodes, strokes and gestures that this hair depends on, found by switching parts off.",
        words: "trace provenance where from why source stroke gesture origin debug",
        menu: "View",
        when: |viewport, state| {
            something_shown(viewport, state).and_then(|()| curves_selected(viewport, state))
        },
        run: |viewport, state, out| {
            let meant = viewport.hair_meant(&state.selection.curves);
            out.extend(meant.into_iter().map(Event::WhatMade));
        },
    },
    Action {
        id: "view.reveal",
        label: "Show in the outliner",
        tip: "Scroll the outliner to the braid or cluster of the selected hair.",
        words: "reveal find tree list braid",
        menu: "View",
        when: curves_selected,
        run: |_, _, out| {
            out.push(Event::Reveal);
            out.push(Event::Show(Room::Outliner));
        },
    },
    Action {
        id: "view.select_head",
        label: "Select the head's node",
        tip: "Select the head's node for the inspector.",
        words: "scalp bust mesh",
        menu: "View",
        when: a_head,
        run: |_, state, out| {
            let document = &state.document;
            let shown = state.shown.iter().flat_map(|shown| &shown.sockets);
            let way = upstream(document, shown.map(|socket| &socket.node));
            let is_head = |id: &&NodeId| document.node(id.as_str()).is_some_and(|n| n.is_head());
            if let Some(head) = way.iter().find(is_head) {
                out.push(Event::Select(Select::Nodes(vec![head.clone()])));
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

fn lens(viewport: &Viewport, factor: f32) -> Can {
    let wanted = viewport.camera().focal_mm * factor;
    match (FOCALS.0 * 0.99..=FOCALS.1 * 1.01).contains(&wanted) {
        true => Ok(()),
        false => Err("there are no such lenses"),
    }
}

fn set_lens(viewport: &mut Viewport, factor: f32) {
    let camera = *viewport.camera();
    viewport.look(with_focal(&camera, camera.focal_mm * factor));
}
