//! The room from outside: the drawing thread on a small groom, and what hands find on the picture.

use super::drawing::{DrawRequest, Drawing, Drawn, PickQuery};
use super::navigation::orbit;
use super::*;
use crate::core::projection::Projection;
use crate::scene::Skin;
use crate::scene::lights::Lights;
use crate::testing::until;
use coif_nodes::data::attributes::{Domain, ID, WIDTH};
use coif_nodes::data::curves::TuftBuilder;
use coif_nodes::data::scalp::{HeadFrame, REGION};
use coif_nodes::maths::closest::Surface;
use coif_nodes::maths::hash::Dice;
use coif_shaders::surface::Tone;
use coif_shaders::view::View;
use coif_shaders::{Gpu, Look, Precision, Renderer, Rig, Transform};

/// A ball of 6 cm under a few hundred hairs.
fn wanted() -> DrawRequest {
    let dice = Dice::new(7, 1, "room");
    let mut tuft = TuftBuilder::new();
    for k in 0..300 {
        let out = Vec3::new(dice.signed(k, 1), dice.unit(k, 2), dice.signed(k, 3));
        let out = out.normalize_or(Vec3::Y);
        tuft.push_curve(&[out * 6.0, out * 8.0, out * 9.0 + Vec3::X]);
    }
    tuft.set(ID, Domain::Curve, (1..=300).collect());
    tuft.set(WIDTH, Domain::Curve, vec![0.1]);
    DrawRequest {
        revision: 1,
        hair: Curves::new(vec![Arc::new(tuft.build())]),
        stands_for: 1.0,
        followed: Curves::default(),
        scalps: vec![Arc::new(ball())],
        visibility: Default::default(),
        show: Show::Hair(View::Hair),
        head: true,
        skin: Skin::Tone(Tone::Clay),
        files: vec![],
        lights: Lights { name: "flat", around: None, turn: 0.0 },
        exposure: 0.0,
        transform: Transform::Agx,
        look: Look::default(),
        camera: Camera {
            eye: Vec3::new(0.0, 8.0, 90.0),
            target: Vec3::ZERO,
            up: Vec3::Y,
            focal_mm: PORTRAIT_FOCAL,
            orthographic: None,
        },
        size: [90, 66],
        samples: 4,
        moving: false,
    }
}

/// A ball of 6 cm, of few triangles.
fn ball() -> Scalp {
    let (rows, columns) = (12u32, 16u32);
    let at = |i: u32, j: u32| {
        let (a, b) = (
            std::f32::consts::PI * i as f32 / rows as f32,
            std::f32::consts::TAU * j as f32 / columns as f32,
        );
        6.0 * Vec3::new(a.sin() * b.sin(), a.cos(), a.sin() * b.cos())
    };
    let points: Vec<Vec3> = (0..=rows).flat_map(|i| (0..columns).map(move |j| at(i, j))).collect();
    let mut triangles = vec![];
    for i in 0..rows {
        for j in 0..columns {
            let k = |i: u32, j: u32| i * columns + j % columns;
            triangles.push([k(i, j), k(i + 1, j), k(i + 1, j + 1)]);
            triangles.push([k(i, j), k(i + 1, j + 1), k(i, j + 1)]);
        }
    }
    let frame = HeadFrame { radius: 6.0, ..HeadFrame::IDENTITY };
    let region = [(REGION.to_owned(), vec![1.0; points.len()])].into();
    Scalp::new(Surface::new(points, triangles), None, frame, region)
}

/// A thread that draws; says so where nothing can draw.
fn drawing(test: &str) -> Option<Drawing> {
    if let Err(err) = Gpu::new(Precision::Best) {
        println!("skipped: {test} {err}");
        return None;
    }
    Some(Drawing::start(|| {}).expect("a thread"))
}

/// All pictures until the thread rests.
fn pictures(drawing: &Drawing) -> Vec<Drawn> {
    let mut all = vec![];
    until("it comes to rest", || {
        let rests = drawing.is_idle();
        all.extend(drawing.take());
        assert_eq!(drawing.fault(), None);
        rests
    });
    all
}

#[test]
fn samples_rise_to_the_picture_that_the_command_line_makes() {
    let Some(mut drawing) = drawing("samples_rise_to_the_picture") else { return };
    let wanted = wanted();
    drawing.ask(wanted.clone());
    let all = pictures(&drawing);
    let at_rest: Vec<u32> = all.iter().filter(|d| !d.rough).map(|d| d.samples).collect();
    assert!(at_rest.windows(2).all(|pair| pair[0] < pair[1]), "{at_rest:?}");
    let last = all.last().expect("a picture");
    assert_eq!((last.samples, last.of, last.wide, last.rough), (4, 4, 1, false));
    assert_eq!(last.image.size, [90, 66]);
    // The same by the ways of `coif render`.
    let gpu = Arc::new(Gpu::new(Precision::Best).expect("an adapter"));
    let mut renderer = Renderer::new(gpu, 90, 66).expect("a small picture");
    renderer.set_look(&wanted.look);
    renderer.set_rig(&Rig::named("flat").expect("a rig"));
    let dressed =
        crate::scene::Dressed::of(&wanted.show, (&wanted.hair, 1.0), &wanted.followed, None)
            .expect("hair");
    let (mut solids, _) = crate::scene::heads(&wanted.scalps, wanted.skin, &[]);
    solids.extend(dressed.ground(&solids));
    renderer.set_solids(solids);
    renderer.set_roots(dressed.roots);
    renderer.set_hair(&dressed.drawn, &dressed.paint);
    renderer.set_camera(&wanted.camera);
    assert!(renderer.render(4, &|_| false));
    let exposure = Rig::named("flat").expect("a rig").exposure;
    let theirs = renderer.picture().encoded(Transform::Agx, exposure);
    let ours: Vec<u8> = last.image.pixels.iter().flat_map(|c| c.to_array()).collect();
    assert_eq!(ours.len(), theirs.len());
    assert!(ours.iter().zip(&theirs).all(|(a, b)| a.abs_diff(*b) <= 1));
    assert!(ours.iter().any(|b| *b > 120) && ours.chunks(4).any(|c| c[0] < 90));
    // Asking for the same again draws nothing; asking for more samples goes on.
    drawing.ask(wanted.clone());
    assert!(pictures(&drawing).is_empty());
    drawing.ask(DrawRequest { samples: 8, ..wanted });
    let more: Vec<u32> = pictures(&drawing).iter().map(|d| d.samples).collect();
    assert_eq!(more, [8]);
}

#[test]
fn the_newest_scene_wins_and_what_was_ended_is_never_shown() {
    let Some(mut drawing) = drawing("the_newest_scene_wins") else { return };
    let first = DrawRequest { samples: 512, ..wanted() };
    drawing.ask(first.clone());
    // The first scene is being refined, which takes long.
    until("a picture comes", || drawing.take().is_some());
    let turned = |k: u32| {
        let camera = orbit(&first.camera, Vec3::ZERO, Vec3::Y, 10.0 * k as f32, 0.0);
        DrawRequest { revision: 1 + u64::from(k), camera, samples: 2, ..first.clone() }
    };
    (1..=9).for_each(|k| drawing.ask(turned(k)));
    let all = pictures(&drawing);
    let last = all.last().expect("a picture");
    assert_eq!((last.wanted.revision, last.samples), (10, 2));
    assert_eq!(last.wanted.camera, turned(9).camera);
    let revisions: Vec<u64> = all.iter().map(|d| d.wanted.revision).collect();
    assert!(
        revisions.is_sorted() && revisions.iter().all(|r| [1, 2, 10].contains(r)),
        "{revisions:?}"
    );
    let ended = |d: &Drawn| d.wanted.revision != 1 || d.samples < 512;
    assert!(all.iter().all(ended), "nobody waits for 512 samples");
}

#[test]
fn while_something_moves_pictures_come_and_rest_follows() {
    let Some(mut drawing) = drawing("while_something_moves_pictures_come") else { return };
    let still = wanted();
    let (mut seen, mut asked) = (vec![], 0);
    until("a picture comes while it moves", || {
        asked += 1;
        let camera = orbit(&still.camera, Vec3::ZERO, Vec3::Y, asked as f32, 0.0);
        drawing.ask(DrawRequest { camera, moving: true, ..still.clone() });
        seen.extend(drawing.take());
        asked >= 40 && !seen.is_empty()
    });
    assert!(seen.iter().all(|d| d.rough), "rough pictures come while it moves");
    drawing.ask(still.clone());
    let rest = pictures(&drawing);
    let last = rest.last().expect("a picture");
    assert!(!last.rough && last.samples == 4 && last.wanted.camera == still.camera);
}

#[test]
fn what_lies_under_the_pointer_is_hair_or_skin_or_nothing() {
    let Some(mut drawing) = drawing("what_lies_under_the_pointer") else { return };
    let wanted = wanted();
    drawing.ask(wanted.clone());
    pictures(&drawing);
    let rect = Rect::from_min_size(Pos2::ZERO, Vec2::new(90.0, 66.0));
    let view = Projection::new(wanted.camera, rect);
    let ask = |at: Pos2| {
        let number = (at.x * 1e3 + at.y) as u64 + 1;
        let part = at.to_vec2() / rect.size();
        let ray = view.ray(at);
        drawing.pick(PickQuery { number, at: [part.x, part.y], ray, camera: wanted.camera });
        let mut answer = None;
        until("an answer comes", || {
            answer = drawing.picked().filter(|picked| picked.number == number);
            answer.is_some()
        });
        answer.expect("an answer")
    };
    let tuft = wanted.hair.tufts()[0].clone();
    let (mut right, mut found) = (0, 0);
    for curve in (0..300).step_by(7) {
        let tip = tuft.curve(curve)[1];
        let Some(at) = view.screen(tip).filter(|at| rect.contains(*at)) else { continue };
        let picked = ask(at);
        if let Some(hair) = &picked.hair {
            found += 1;
            let seen = view.screen(hair.place).expect("it is before the eye");
            right += usize::from(seen.distance(at) < 14.0 && hair.id() == tuft.id(hair.curve));
        }
    }
    assert!(found > 10 && right == found, "{right} of {found}");
    let skin = ask(view.screen(Vec3::new(0.0, -1.0, 6.0)).expect("before the eye"));
    let hit = skin.skin.expect("the ball is there");
    assert!((hit.point.length() - 6.0).abs() < 0.3 && hit.point.z > 4.0);
    let nothing = ask(Pos2::new(1.0, 1.0));
    assert!(nothing.hair.is_none() && nothing.skin.is_none() && nothing.place().is_none());
}

#[test]
fn pictures_are_of_the_windows_size_but_never_too_large() {
    let check = |size: [f32; 2], per_point: f32, expected: [u32; 2]| {
        assert_eq!(pixels(Vec2::from(size), per_point), expected);
    };
    check([900.0, 600.0], 1.0, [900, 600]);
    check([900.0, 600.0], 2.0, [1800, 1200]);
    check([0.0, 5.0], 1.0, [1, 5]);
    let [w, h] = pixels(Vec2::new(3840.0, 2160.0), 2.0);
    assert!(w <= 4096 && w * h <= 6_010_000 && (w as f32 / h as f32 - 16.0 / 9.0).abs() < 0.01);
}

// --- the room in a window that nobody sees, without a device -------------------------------------

mod window {
    use super::super::actions::ACTIONS;
    use super::*;
    use crate::core::state::{OpenFile, Select};
    use crate::editor::Editor;
    use coif_graphs::document::{Document, NodeId, Setting};
    use coif_graphs::{file, grooms};
    use coif_nodes::define::Value;
    use egui::{Event as Input, Key, Modifiers};
    use egui_kittest::Harness;
    use egui_kittest::kittest::Queryable;

    type Ui = Harness<'static, Editor>;

    /// The editor on a shipped groom, evaluated and framed, without pictures.
    fn on_groom(name: &str) -> Ui {
        let text = grooms::by_name(name).expect("a shipped groom");
        let mut document = file::read(text).expect("it reads").document;
        // Little hair, for these tests are not about hair.
        for node in document.nodes.values_mut() {
            let inputs = &mut Arc::make_mut(node).inputs;
            for name in ["count", "density"] {
                match inputs.get_mut(name) {
                    Some(Setting::Known(Value::Int(n))) => *n = (*n).min(60),
                    Some(Setting::Known(Value::Float(x))) => *x = x.min(2.0),
                    _ => {}
                }
            }
        }
        on(document)
    }

    fn on(document: Document) -> Ui {
        let editor = Editor::new(&egui::Context::default(), document, OpenFile::default());
        let mut ui = Harness::builder()
            .with_size(Vec2::new(1400.0, 900.0))
            .with_max_steps(64)
            .build_ui_state(|ui, editor: &mut Editor| editor.ui(ui), editor);
        settle(&mut ui);
        ui
    }

    fn settle(ui: &mut Ui) {
        let mut calm = 0;
        until("it comes to rest", || {
            ui.step();
            let rests = ui.state().is_idle() && ui.state().viewport.is_idle();
            calm = if rests { calm + 1 } else { 0 };
            calm == 3
        });
    }

    #[test]
    fn a_view_that_is_asked_for_while_the_head_is_alone_stays_when_the_hair_comes() {
        let mut ui = on_groom("puffs");
        let whole = ui.state().state.shown.clone().expect("a result");
        let alone = crate::core::shown::Shown {
            revision: whole.revision,
            quality: whole.quality,
            sockets: whole.sockets.clone(),
            curves: Default::default(),
            scalps: whole.scalps.clone(),
            values: whole.values.clone(),
            head_alone: true,
            stands_for: 1.0,
            final_strands: None,
            ms: 0.0,
            over: vec![],
        };
        let mut viewport = Viewport::default();
        let mut seen = |shown: Arc<crate::core::shown::Shown>, name: Option<&str>| {
            ui.state_mut().state.shown = Some(shown);
            let state = &ui.state().state;
            viewport.frame_first(state);
            name.into_iter().for_each(|name| viewport.look_from(name, state));
            until("the eye has a place", || {
                viewport.take_framing();
                viewport.framing.is_none()
            });
            viewport.camera
        };
        let front = seen(alone.into(), Some("front"));
        assert_eq!(seen(whole, None), front);
    }

    fn drag(ui: &mut Ui, from: Pos2, to: Pos2, button: PointerButton, modifiers: Modifiers) {
        ui.event(Input::PointerMoved(from));
        ui.step();
        ui.event_modifiers(
            Input::PointerButton { pos: from, button, pressed: true, modifiers },
            modifiers,
        );
        ui.step();
        for k in 1..=8 {
            ui.event_modifiers(Input::PointerMoved(from.lerp(to, k as f32 / 8.0)), modifiers);
            ui.step();
        }
        ui.event_modifiers(
            Input::PointerButton { pos: to, button, pressed: false, modifiers },
            modifiers,
        );
        ui.step();
    }

    fn camera(ui: &Ui) -> Camera {
        *ui.state().viewport.camera()
    }

    #[test]
    fn hands_turn_carry_and_zoom_and_the_view_goes_back() {
        let mut ui = on_groom("start");
        let first = camera(&ui);
        let middle = ui.state().viewport.rect.center();
        let by = Vec2::new(120.0, -40.0);
        let alt = Modifiers::ALT;
        drag(&mut ui, middle, middle + by, PointerButton::Primary, alt);
        let turned = camera(&ui);
        assert!(turned.eye.distance(first.eye) > 5.0, "it turned");
        assert!(turned.across_and_up().0.y.abs() < 1e-3, "the horizon is level");
        drag(&mut ui, middle, middle + by, PointerButton::Middle, alt);
        let carried = camera(&ui);
        assert!(carried.ahead().distance(turned.ahead()) < 1e-4 && carried.eye != turned.eye);
        ui.event(Input::PointerMoved(middle));
        ui.step();
        ui.event(Input::MouseWheel {
            unit: egui::MouseWheelUnit::Point,
            delta: Vec2::new(0.0, 120.0),
            modifiers: Modifiers::NONE,
            phase: egui::TouchPhase::Move,
        });
        for _ in 0..60 {
            ui.step();
        }
        let closer = camera(&ui);
        assert!(closer.eye.distance(closer.target) < 0.95 * carried.eye.distance(carried.target));
        for expected in [carried, turned, first] {
            ui.state_mut().act("view.back");
            let found = camera(&ui);
            assert!(found.eye.distance(expected.eye) < 1e-3, "{found:?} {expected:?}");
        }
        ui.state_mut().act("view.forward");
        assert!(camera(&ui).eye.distance(turned.eye) < 1e-3);
        // A plain drag leaves the view alone.
        drag(&mut ui, middle, middle + by, PointerButton::Primary, Modifiers::NONE);
        assert!(camera(&ui).eye.distance(turned.eye) < 1e-3);
        assert!(!ui.state().state.history.is_changed(), "views are no steps");
    }

    #[test]
    fn a_drag_turns_the_light_in_one_step_and_leaves_the_eye() {
        let mut ui = on_groom("start");
        let seen = camera(&ui);
        let middle = ui.state().viewport.rect.center();
        let to = middle + Vec2::new(100.0, 30.0);
        drag(&mut ui, middle, to, PointerButton::Secondary, Modifiers::SHIFT);
        ui.run_steps(3);
        let turn = |ui: &Ui| {
            let look = ui.state().state.document.look.as_ref();
            (ui.state().viewport.options.turn, look.map_or(0.0, |look| look.turn))
        };
        let (shown, kept) = turn(&ui);
        assert!((shown - 40.0).abs() < 0.1, "{shown}: to the right");
        assert!((kept - shown).abs() < 0.1, "{kept}");
        assert_eq!((camera(&ui), ui.state().state.history.done()), (seen, 1));
        assert!(ui.state().is_idle(), "no hair is made anew");
        ui.state_mut().act("edit.undo");
        ui.run_steps(3);
        assert_eq!(turn(&ui), (0.0, 0.0));
        // Without Shift it is none of the light's.
        drag(&mut ui, middle, to, PointerButton::Secondary, Modifiers::NONE);
        ui.run_steps(3);
        assert_eq!(turn(&ui), (0.0, 0.0));
        ui.state_mut().act("view.light_left");
        ui.run_steps(3);
        assert_eq!(turn(&ui), (-15.0, -15.0));
    }

    #[test]
    fn menus_over_the_picture_change_how_it_is_looked_at() {
        let mut ui = on_groom("start");
        let pick = |ui: &mut Ui, menu: &str, entry: &str| {
            ui.get_by_label_contains(menu).click();
            ui.run_steps(3);
            ui.get_by_label(entry).click();
            ui.run_steps(3);
        };
        pick(&mut ui, "Hair ⏷", "Groom by braid");
        assert_eq!(ui.state().viewport.options.show, "braid");
        pick(&mut ui, "Over it ⏷", "Partings");
        assert!(ui.state().viewport.options.partings);
        ui.key_press(Key::Escape);
        ui.run_steps(3);
        pick(&mut ui, "From ⏷", "Back");
        settle(&mut ui);
        assert!(camera(&ui).eye.z < -20.0, "it is seen from behind");
    }

    #[test]
    fn light_and_skin_are_kept_with_the_groom() {
        let mut ui = on_groom("start");
        let look = |ui: &Ui| ui.state().state.document.look.clone();
        assert_eq!((look(&ui), ui.state().state.history.is_changed()), (None, false));
        ui.state_mut().viewport.options.skin = 9;
        ui.run_steps(3);
        let chosen = look(&ui).expect("it is kept");
        assert_eq!((chosen.skin.as_str(), chosen.light.as_str()), ("9", "studio"));
        assert!(ui.state().is_idle(), "no hair is made anew");
        ui.state_mut().act("edit.undo");
        ui.run_steps(3);
        assert_eq!(
            (look(&ui), ui.state().viewport.options.skin),
            (None, crate::rooms::viewport::options::SKIN_AUTO)
        );
        // Another groom brings its own, and one without any begins as at first.
        let mut document = ui.state().state.document.clone();
        let light = "dark-hair".to_owned();
        document.look = Some(SavedLook { light, exposure: 1.0, turn: 0.0, skin: "clay".into() });
        ui.state_mut().act("edit.redo");
        ui.run_steps(3);
        assert_eq!(ui.state().viewport.options.skin, 9);
        let mut ui = on(document);
        ui.run_steps(3);
        let options = &ui.state().viewport.options;
        assert_eq!((options.rig(), options.exposure, options.skin), ("dark-hair", 1.0, 0));
        assert!(!ui.state().state.history.is_changed());
    }

    #[test]
    fn the_corner_says_what_the_picture_is_also_without_one() {
        let mut ui = on_groom("start");
        let strands = ui.state().state.shown.as_ref().expect("hair").curves.curve_count();
        let text = format!("final, {} strands", crate::words::grouped(strands));
        ui.get_by_label(&text);
        ui.get_by_label_contains("displayed: ");
        ui.state_mut().state.revision += 1;
        ui.step();
        ui.get_by_label_contains("stale: ");
        assert!(ui.state().viewport.caption(&ui.state().state).contains("strands"));
    }

    #[test]
    fn every_action_of_the_room_can_be_done_or_says_why_not() {
        let mut ui = on_groom("cornrows");
        for round in 0..2 {
            for action in ACTIONS {
                ui.state_mut().act(action.id);
                ui.step();
            }
            let id = |ui: &Ui| {
                let shown = ui.state().state.shown.clone().expect("hair");
                shown.curves.each().map(|(tuft, i)| tuft.id(i)).nth(7).expect("hair")
            };
            let chosen = [id(&ui)].into();
            ui.state_mut().apply(Event::Select(Select::Curves(chosen)));
            assert!(camera(&ui).eye.is_finite(), "round {round}");
        }
        settle(&mut ui);
        // Light and skin are the groom's; nothing else is.
        ui.state_mut().apply(Event::Edit(Edit::SetLook(None)));
        let text = grooms::by_name("cornrows").expect("a shipped groom");
        let read = file::read(text).expect("it reads").document;
        let now = &ui.state().state.document;
        assert_eq!(
            (&now.links, &now.views, now.nodes.len()),
            (&read.links, &read.views, read.nodes.len())
        );
    }

    #[test]
    fn hair_is_isolated_hidden_and_shown_again() {
        let mut ui = on_groom("cornrows");
        let shown = ui.state().state.shown.clone().expect("hair");
        let one = shown.curves.each().map(|(tuft, i)| tuft.id(i)).next().expect("hair");
        ui.state_mut().apply(Event::Select(Select::Curves([one].into())));
        ui.state_mut().act("view.isolate");
        assert_eq!(ui.state().state.visibility.alone, [one].into());
        ui.state_mut().act("view.isolate");
        assert!(ui.state().state.visibility.shows_all());
        ui.state_mut().act("view.hide");
        assert!(ui.state().state.visibility.hidden.contains(&one));
        assert!(ui.state().state.selection.curves.is_empty());
        ui.state_mut().act("view.show_all");
        assert!(ui.state().state.visibility.shows_all());
        ui.state_mut().apply(Event::Select(Select::Curves([one].into())));
        ui.state_mut().act("view.select_kin");
        assert!(ui.state().state.selection.curves.len() > 10);
        ui.state_mut().act("view.lock");
        assert!(ui.state().state.visibility.locked.len() > 10);
        ui.state_mut().act("view.lock");
        assert!(ui.state().state.visibility.locked.is_empty());
    }

    /// A press of the right button that is let go where it was opens a menu of what is there; a drag turns the view as before.
    #[test]
    fn the_right_button_opens_the_menu_of_what_is_there() {
        let mut ui = on_groom("start");
        let rect = ui.state().viewport.rect;
        let press = |ui: &mut Ui, at: Pos2| {
            ui.event(Input::PointerMoved(at));
            ui.step();
            for pressed in [true, false] {
                let (button, modifiers) = (PointerButton::Secondary, Modifiers::NONE);
                ui.event(Input::PointerButton { pos: at, button, pressed, modifiers });
                ui.step();
            }
            ui.run_steps(4);
        };
        let close = |ui: &mut Ui| {
            ui.key_press(Key::Escape);
            ui.run_steps(3);
        };
        let says = |ui: &Ui, words: &str| ui.query_by_label_contains(words).is_some();
        press(&mut ui, rect.center());
        assert!(says(&ui, "Frame the head") && says(&ui, "Light and skin"), "a head");
        let before = camera(&ui);
        ui.get_by_label("Frame the head").click();
        ui.run_steps(3);
        settle(&mut ui);
        assert!(camera(&ui) != before && !says(&ui, "Frame the head"));
        let corner = rect.right_center() - Vec2::new(20.0, 0.0);
        press(&mut ui, corner);
        assert!(says(&ui, "Frame all") && says(&ui, "Over the picture"), "nothing");
        assert!(!says(&ui, "Frame the head"));
        close(&mut ui);
        // A drag is no press.
        let before = camera(&ui);
        let to = rect.center() + Vec2::new(0.0, 80.0);
        drag(&mut ui, rect.center(), to, PointerButton::Secondary, Modifiers::ALT);
        ui.run_steps(4);
        assert!(camera(&ui) != before && !says(&ui, "Light and skin"));
        // Keys open it where the pointer is.
        ui.event(Input::PointerMoved(rect.center()));
        ui.run_steps(2);
        ui.key_press_modifiers(Modifiers::SHIFT, Key::F10);
        ui.run_steps(4);
        assert!(says(&ui, "Light and skin"));
        close(&mut ui);
        // On hair: it is selected with what it belongs to.
        let shown = ui.state().state.shown.clone().expect("hair");
        let tuft = shown.curves.tufts()[0].clone();
        let hair = HairHit { tuft, curve: 0, point: 0, place: Vec3::ZERO };
        let editor = ui.state_mut();
        let mut out = vec![];
        editor.viewport.open_menu(&editor.state, corner, Some(hair.clone()), true, &mut out);
        out.into_iter().for_each(|event| editor.apply(event));
        ui.run_steps(4);
        assert!(ui.state().state.selection.curves.contains(&hair.id()));
        assert!(says(&ui, "Show in the outliner"));
        ui.get_by_label("Isolate").click();
        ui.run_steps(3);
        assert!(ui.state().state.visibility.alone.contains(&hair.id()));
    }

    fn leave_out_of(ui: &Ui) -> Option<Setting> {
        let document = &ui.state().state.document;
        let head = document.nodes.values().find(|node| node.is_head()).expect("a head");
        head.inputs.get("leave_out").cloned()
    }

    /// Opens the menu where a place of the skin is seen.
    fn menu_at(ui: &mut Ui, place: Vec3) {
        let at = ui.state().viewport.projection().screen(place).expect("it is seen");
        ui.event(Input::PointerMoved(at));
        ui.run_steps(2);
        ui.key_press_modifiers(Modifiers::SHIFT, Key::F10);
        ui.run_steps(4);
    }

    #[test]
    fn a_part_of_the_head_is_left_out_by_pointing_at_it_and_comes_back_by_the_list() {
        let mut ui = on(file::read(r#"(format: 3, nodes: {
            "head": (kind: "head"),
            "guides": (kind: "scatter_guides", links: {"scalp": "head.scalp"}, inputs: {"count": 200}),
            "out": (kind: "groom_output", links: {"curves": "guides.curves"}),
        })"#).unwrap().document);
        ui.state_mut().act("view.from_front");
        settle(&mut ui);
        let scalp = ui.state().state.shown.as_ref().unwrap().scalp().unwrap().clone();
        let triangles = |ui: &Ui| {
            ui.state().state.shown.as_ref().unwrap().scalp().unwrap().surface().triangles.len()
        };
        let whole = triangles(&ui);
        let part = scalp.parts().iter().find(|part| part.name == "eyes").expect("eyes").clone();
        // Where the left eye stands out the most.
        let middles = part
            .triangles
            .iter()
            .cloned()
            .flatten()
            .map(|t| scalp.surface().at(t, glam::Vec2::splat(1.0 / 3.0)));
        let eye = middles.filter(|p| p.x > 0.0).max_by(|a, b| a.z.total_cmp(&b.z)).unwrap();
        menu_at(&mut ui, eye);
        ui.get_by_label("Leave out this part: eyes").click();
        ui.run_steps(3);
        assert_eq!(leave_out_of(&ui), Some(Setting::Known(Value::Text("eyes".into()))));
        assert_eq!(ui.state().state.history.done(), 1);
        settle(&mut ui);
        let held: usize = part.triangles.iter().map(|run| run.len()).sum();
        assert_eq!(triangles(&ui), whole - held);
        // It is skin no more: the list has it, and the ticks are the panel's.
        menu_at(&mut ui, eye);
        ui.get_by_label_contains("Parts of the head").click();
        ui.run_steps(3);
        ui.get_by_label("eyes").click();
        ui.run_steps(3);
        assert_eq!(leave_out_of(&ui), None);
        settle(&mut ui);
        assert_eq!(triangles(&ui), whole);
        ui.state_mut().act("edit.undo");
        assert!(leave_out_of(&ui).is_some());
        ui.state_mut().act("edit.redo");
        settle(&mut ui);
        // The face is one piece with the rest: an area is drawn instead.
        menu_at(&mut ui, scalp.frame().point_from_head(Vec3::new(0.0, 3.0, 9.5)));
        ui.get_by_label("Leave out this part");
        ui.get_by_label("Leave out an area").click();
        ui.run_steps(3);
        let document = &ui.state().state.document;
        let region = document
            .nodes
            .iter()
            .find(|(_, node)| node.kind == "region")
            .expect("a region")
            .0
            .clone();
        assert_eq!(ui.state().state.pinned.as_ref(), Some(&region));
        let wired =
            |node: &str| document.wires(&NodeId::new(node).unwrap(), "scalp")[0].to_string();
        assert_eq!(
            (wired("guides"), wired("region")),
            ("region.scalp".to_owned(), "head.scalp".to_owned())
        );
        settle(&mut ui);
        // By painting it is the same region.
        ui.state_mut().act("pen.leave_out_painted");
        ui.run_steps(3);
        let document = &ui.state().state.document;
        let kinds = |kind: &str| document.nodes.values().filter(|node| node.kind == kind).count();
        assert_eq!((kinds("region"), kinds("paint_mask")), (1, 1));
        assert_eq!(document.wires(&region, "mask").len(), 1);
        let mask = document.wires(&region, "mask")[0].node.clone();
        assert_eq!(ui.state().state.pinned.as_ref(), Some(&mask));
        for done in (1..=2).rev() {
            ui.state_mut().act("edit.undo");
            assert_eq!(ui.state().state.history.done(), done + 1);
        }
        assert!(ui.state().state.document.nodes.values().all(|node| node.kind != "region"));
    }

    #[test]
    fn parameters_have_the_handles_of_what_reads_them() {
        let mut document = file::read(grooms::by_name("puffs").unwrap()).unwrap().document;
        for node in document.nodes.values_mut() {
            if let Some(Setting::Known(Value::Int(n))) = Arc::make_mut(node).inputs.get_mut("count")
            {
                *n = (*n).min(60);
            }
        }
        let socket: coif_graphs::document::Socket = "left.sphere_radius".parse().unwrap();
        let was = document.nodes[&socket.node].inputs.get("sphere_radius").cloned();
        let (edit, port) = coif_graphs::document::groups::expose(&document, &socket).unwrap();
        edit.apply(&mut document).unwrap();
        let mut ui = on(document);
        ui.state_mut().apply(Event::Select(Select::Nodes(vec![port.node.clone()])));
        settle(&mut ui);
        let grip = ui.get_by_label("Handle of sphere_radius").rect().center();
        drag(&mut ui, grip, grip + Vec2::new(25.0, -10.0), PointerButton::Primary, Modifiers::NONE);
        settle(&mut ui);
        let document = &ui.state().state.document;
        let now = document.nodes[&port.node].inputs.get("sphere_radius");
        assert!(now.is_some() && now != was.as_ref(), "{now:?}");
        assert!(!document.nodes[&socket.node].inputs.contains_key("sphere_radius"));
        assert_eq!(ui.state().state.history.done(), 1);
    }

    #[test]
    fn a_handle_drags_its_input_in_one_step() {
        let mut ui = on_groom("puffs");
        let node = NodeId::new("left").expect("an id");
        ui.state_mut().apply(Event::Select(Select::Nodes(vec![node.clone()])));
        settle(&mut ui);
        let value =
            |ui: &Ui| match ui.state().state.document.nodes[&node].inputs.get("sphere_radius") {
                Some(Setting::Known(Value::Float(x))) => *x,
                _ => 6.0,
            };
        let before = value(&ui);
        let grip = ui.get_by_label("Handle of sphere_radius").rect().center();
        let outwards = (grip - ui.state().viewport.rect.center()).normalized() * 30.0;
        drag(&mut ui, grip, grip + outwards, PointerButton::Primary, Modifiers::NONE);
        settle(&mut ui);
        let after = value(&ui);
        assert!(after != before && (0.1..=60.0).contains(&after), "{before} {after}");
        assert_eq!(ui.state().state.history.done(), 1, "one step");
        assert!(!ui.state().state.gesture);
        ui.state_mut().act("edit.undo");
        assert_eq!(value(&ui), before);
    }

    /// The circle of a puff is round its ball: its middle is the `puff_centre` of its curves, its radius what they lie on. From
    /// behind the head the grip of the position is not seen and cannot be taken, until the head is not shown.
    #[test]
    fn a_puffs_circle_is_round_its_ball_and_the_head_hides_handles() {
        use coif_nodes::data::attributes::{PUFF_CENTRE, PUFF_RADIUS};
        let mut ui = on_groom("puffs");
        let node = NodeId::new("left").expect("an id");
        ui.state_mut().apply(Event::Select(Select::Nodes(vec![node.clone()])));
        ui.state_mut().act("view.from_left");
        settle(&mut ui);
        let shown = ui.state().state.shown.clone().expect("hair");
        let socket = crate::core::shown::first_output(&ui.state().state.document, &node);
        let curves = shown.curves_of(&socket.expect("it gives curves")).expect("curves").clone();
        let tuft = &curves.tufts()[0];
        let (centre, radius) = (tuft.view(PUFF_CENTRE).at(0, 0), tuft.view(PUFF_RADIUS).at(0, 0));
        let view = ui.state().viewport.projection();
        let middle = view.screen(centre).expect("before the eye");
        let expected = radius / view.cm_per_point(view.depth(centre));
        let grip = ui.get_by_label("Handle of sphere_radius").rect().center();
        let found = grip.distance(middle);
        assert!((found - expected).abs() < 0.02 * expected, "{found} for {expected}");
        // At the side of the head where the puff is not, the head stands before its root.
        ui.get_by_label("Handle of position");
        ui.state_mut().act("view.from_right");
        settle(&mut ui);
        assert!(ui.query_by_label("Handle of position").is_none(), "the head stands before it");
        ui.state_mut().act("view.head");
        ui.run_steps(3);
        ui.get_by_label("Handle of position");
    }

    #[test]
    fn views_are_saved_under_names_and_come_back() {
        let mut ui = on_groom("start");
        let saved = camera(&ui);
        ui.state_mut().viewport.view_name = "hero".to_owned();
        ui.get_by_label_contains("From ⏷").click();
        ui.run_steps(3);
        // It may lie below what the window has room for.
        ui.get_by_label("Save view").scroll_to_me();
        ui.run_steps(8);
        ui.get_by_label("Save view").click();
        ui.run_steps(3);
        assert!(ui.state().state.document.views.contains_key("hero"));
        ui.state_mut().act("view.from_back");
        settle(&mut ui);
        assert!(camera(&ui).eye.distance(saved.eye) > 10.0);
        if ui.query_by_label("hero").is_none() {
            ui.get_by_label_contains("From ⏷").click();
            ui.run_steps(3);
        }
        ui.get_by_label("hero").click();
        ui.run_steps(3);
        assert_eq!(camera(&ui), saved);
        ui.state_mut().act("edit.undo");
        assert!(ui.state().state.document.views.is_empty());
    }
}
