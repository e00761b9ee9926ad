//! The life of documents, driven as hands drive it: dialogs that are answered, buttons that are pressed, processes that are
//! killed.

mod exporting;
mod memory;

use super::dialogs::Answer;
use super::dialogs::fake::Fake;
use super::journal::leftovers;
use super::life;
use crate::core::documents::{DocumentEvent, Purpose};
use crate::core::event::Event;
use crate::core::notes::Gravity;
use crate::core::settings::Settings;
use crate::core::state::OpenFile;
use crate::editor::Editor;
use crate::places::Places;
use crate::testing::{Folder, until};
use coif_graphs::document::edit::Edit;
use coif_graphs::document::{Document, NodeId, Setting, Socket};
use coif_graphs::file;
use coif_nodes::define::Value;
use egui::{ViewportCommand, ViewportEvent, ViewportId};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use std::path::{Path, PathBuf};
use std::sync::Arc;

type Ui = Harness<'static, Editor>;

fn on(document: Document, file: OpenFile) -> (Ui, Fake) {
    let mut editor = Editor::new(&egui::Context::default(), document, file);
    let fake = Fake::default();
    editor.documents.dialogs = Some(Box::new(fake.clone()));
    let ui = Harness::builder()
        .with_size(egui::vec2(1200.0, 800.0))
        .build_ui_state(|ui, editor: &mut Editor| editor.ui(ui), editor);
    (ui, fake)
}

fn on_empty_head() -> (Ui, Fake) {
    on(life::empty_head(), OpenFile::default())
}

fn act(ui: &mut Ui, id: &str) {
    ui.state_mut().act(id);
    ui.step();
    ui.step();
}

fn does(ui: &mut Ui, event: DocumentEvent) {
    ui.state_mut().apply(Event::Documents(event));
    ui.step();
    ui.step();
}

fn edit(ui: &mut Ui, edit: Edit) {
    ui.state_mut().apply(Event::Edit(edit));
    ui.step();
}

fn press(ui: &mut Ui, label: &str) {
    ui.get_by_label(label).click();
    ui.step();
    ui.step();
}

fn said(ui: &Ui, gravity: Gravity) -> Vec<String> {
    let notes = ui.state().state.notes.all().iter();
    notes.filter(|note| note.gravity == gravity).map(|note| note.text.clone()).collect()
}

fn read(path: &Path) -> Document {
    file::read(&std::fs::read_to_string(path).unwrap()).unwrap().document
}

fn is_changed(ui: &Ui) -> bool {
    ui.state().state.history.is_changed()
}

#[test]
fn what_is_saved_is_opened_again_and_known_as_recent() {
    let folder = Folder::new("life");
    let (mut ui, fake) = on_empty_head();
    edit(&mut ui, Edit::SetSeed(7));
    assert!(is_changed(&ui));
    fake.answers(Answer::Chosen(folder.path("front rows")));
    act(&mut ui, "file.save");
    let path = folder.path("front rows.ron");
    assert_eq!(fake.asked.lock().unwrap()[0].purpose, Purpose::Save);
    assert_eq!(read(&path), ui.state().state.document);
    assert!(!is_changed(&ui) && ui.state().title() == "front rows.ron");
    edit(&mut ui, Edit::SetSeed(8));
    act(&mut ui, "file.save");
    assert_eq!((read(&path).seed, fake.asked.lock().unwrap().len()), (8, 1));
    act(&mut ui, "file.empty");
    assert_eq!(ui.state().state.document.seed, 0);
    fake.answers(Answer::Chosen(path.clone()));
    act(&mut ui, "file.open");
    assert_eq!(ui.state().state.document.seed, 8);
    assert_eq!(ui.state().documents.recent.files(), [path]);
    assert_eq!(said(&ui, Gravity::Error), Vec::<String>::new());
    // The next question for a mesh begins where the last file was.
    fake.answers(Answer::Nothing);
    act(&mut ui, "file.head");
    assert_eq!(fake.asked.lock().unwrap().last().unwrap().folder, folder.root());
    // Somebody closes a dialog: nothing happens.
    fake.answers(Answer::Nothing);
    act(&mut ui, "file.save_as");
    assert!(said(&ui, Gravity::Error).is_empty() && ui.state().documents.asking.is_none());
}

#[test]
fn saving_elsewhere_keeps_meshes_found_and_a_failed_save_changes_nothing() {
    let folder = Folder::new("life-paths");
    std::fs::create_dir(folder.path("deep")).unwrap();
    let (mut ui, _) = on_empty_head();
    let head = NodeId::new("head").unwrap();
    let mesh = folder.path("head.obj");
    let setting = Setting::Known(Value::Text(mesh.to_str().unwrap().into()));
    edit(&mut ui, Edit::SetInput { node: head, input: "mesh".to_owned(), setting });
    let path = |path: &Path| match &read(path).node("head").unwrap().inputs["mesh"] {
        Setting::Known(Value::Text(path)) => path.to_string(),
        other => panic!("{other:?}"),
    };
    does(&mut ui, DocumentEvent::SaveTo(folder.path("a.ron")));
    assert_eq!(path(&folder.path("a.ron")), "head.obj");
    does(&mut ui, DocumentEvent::SaveTo(folder.path("deep/a.ron")));
    assert_eq!(path(&folder.path("deep/a.ron")), "../head.obj");
    let before = ui.state().state.document.clone();
    does(&mut ui, DocumentEvent::SaveTo(folder.path("nowhere/a.ron")));
    assert_eq!(said(&ui, Gravity::Error).len(), 1);
    assert_eq!(ui.state().state.document, before);
    assert_eq!(ui.state().state.file.path, Some(folder.path("deep/a.ron")));
}

fn close_requested(ui: &mut Ui) -> Vec<ViewportCommand> {
    let root = ui.input_mut().viewports.get_mut(&ViewportId::ROOT).unwrap();
    root.events.push(ViewportEvent::Close);
    step_commands(ui)
}

fn step_commands(ui: &mut Ui) -> Vec<ViewportCommand> {
    ui.step();
    ui.output().viewport_output[&ViewportId::ROOT].commands.clone()
}

#[test]
fn closing_asks_once_and_only_where_something_is_unsaved() {
    let folder = Folder::new("life-close");
    let (mut ui, _) = on_empty_head();
    assert!(!close_requested(&mut ui).contains(&ViewportCommand::CancelClose));
    assert!(step_commands(&mut ui).contains(&ViewportCommand::Close));
    let unsaved = || {
        let (mut ui, fake) = on_empty_head();
        edit(&mut ui, Edit::SetSeed(7));
        assert!(close_requested(&mut ui).contains(&ViewportCommand::CancelClose));
        ui.step();
        (ui, fake)
    };
    let (mut ui, _) = unsaved();
    press(&mut ui, "Cancel");
    assert!(ui.query_by_label("Discard").is_none());
    assert!(close_requested(&mut ui).contains(&ViewportCommand::CancelClose));
    ui.step();
    ui.get_by_label("Discard").click();
    ui.step();
    assert!(step_commands(&mut ui).contains(&ViewportCommand::Close));
    assert!(!close_requested(&mut ui).contains(&ViewportCommand::CancelClose));
    let (mut ui, fake) = unsaved();
    fake.answers(Answer::Chosen(folder.path("saved.ron")));
    ui.get_by_label("Save").click();
    ui.step();
    let mut closed = false;
    until("it closes", || {
        closed |= step_commands(&mut ui).contains(&ViewportCommand::Close);
        closed
    });
    assert_eq!(read(&folder.path("saved.ron")).seed, 7);
    // Where saving fails or is not wanted after all, nothing is lost.
    let (mut ui, fake) = unsaved();
    fake.answers(Answer::Nothing);
    press(&mut ui, "Save");
    ui.step();
    assert!(!ui.state().documents.leaving && is_changed(&ui));
}

#[test]
fn every_shipped_groom_and_the_empty_head_begin_new_documents() {
    let (mut ui, _) = on_empty_head();
    act(&mut ui, "file.new");
    assert!(ui.state().documents.shows_welcome());
    for (name, text) in coif_graphs::grooms::ALL {
        does(&mut ui, DocumentEvent::New(Some(name)));
        assert_eq!(ui.state().state.document, file::read(text).unwrap().document);
        assert!(!is_changed(&ui) && ui.state().state.file.path.is_none());
    }
    does(&mut ui, DocumentEvent::New(None));
    assert_eq!(ui.state().state.document, life::empty_head());
    assert!(coif_graphs::document::graph::check(&life::empty_head()).is_empty());
}

#[test]
fn every_action_of_the_room_can_be_done_or_says_why_and_nothing_is_written_without_a_home() {
    let before = std::fs::read_dir(".").unwrap().count();
    let mut editor =
        Editor::new(&egui::Context::default(), life::empty_head(), OpenFile::default());
    assert!(editor.documents.dialogs.is_none());
    editor.apply(Event::Edit(Edit::SetSeed(1)));
    let mut ui = Harness::builder()
        .with_size(egui::vec2(1200.0, 800.0))
        .build_ui_state(|ui, editor: &mut Editor| editor.ui(ui), editor);
    for action in super::actions::ACTIONS {
        act(&mut ui, action.id);
        ui.key_press(egui::Key::Escape);
        ui.step();
        ui.key_press(egui::Key::Enter);
        ui.step();
        assert!(!ui.state().documents.leaving, "{}", action.id);
    }
    assert_eq!(ui.state().state.document.seed, 1);
    assert_eq!(std::fs::read_dir(".").unwrap().count(), before);
}

#[derive(Debug)]
struct Dropped(PathBuf);

impl egui::DroppedFile for Dropped {
    fn path(&self) -> &Path {
        &self.0
    }
    fn bytes(&self) -> Result<Vec<u8>, String> {
        std::fs::read(&self.0).map_err(|err| err.to_string())
    }
}

fn drop_on(ui: &mut Ui, path: &Path) {
    ui.input_mut().dropped_files.push(Arc::new(Dropped(path.to_owned())));
    ui.step();
    ui.step();
}

#[test]
fn grooms_and_meshes_are_dropped_on_the_window() {
    let folder = Folder::new("life-drop");
    let groom = folder.path("x.ron");
    std::fs::write(&groom, coif_graphs::grooms::by_name("puffs").unwrap()).unwrap();
    let (mut ui, _) = on_empty_head();
    drop_on(&mut ui, &groom);
    assert_eq!(ui.state().state.file.path.as_ref(), Some(&groom));
    edit(&mut ui, Edit::SetSeed(99));
    drop_on(&mut ui, &groom);
    assert_eq!(ui.state().state.document.seed, 99, "it asks first");
    press(&mut ui, "Discard");
    assert_ne!(ui.state().state.document.seed, 99);
    drop_on(&mut ui, &folder.path("notes.txt"));
    assert!(said(&ui, Gravity::Warning)[0].contains("drop a groom (.ron), a mesh"));
    // A mesh beside the groom becomes its head, by a short name, in one step.
    std::fs::write(folder.path("head.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").unwrap();
    let before = ui.state().state.document.clone();
    drop_on(&mut ui, &folder.path("head.obj"));
    assert_eq!(ui.state().state.document, before, "it asks what becomes of the hair");
    press(&mut ui, "With the hair");
    ui.run_steps(3);
    let head = life::head_of(&ui.state().state.document, None).unwrap();
    let mesh = |ui: &Ui| ui.state().state.document.nodes[&head].inputs.get("mesh").cloned();
    assert_eq!(mesh(&ui), Some(Setting::Known(Value::Text("head.obj".into()))));
    let done = ui.state().state.history.done();
    press(&mut ui, "+90°");
    press(&mut ui, "z");
    press(&mut ui, "Accept");
    assert_eq!(ui.state().state.history.done(), done, "all of it is one step");
    let node = &ui.state().state.document.nodes[&head];
    assert_eq!(node.inputs["turn"], Setting::Known(Value::Float(90.0)));
    assert_eq!(node.inputs["up"], Setting::Known(Value::Text("z".into())));
    act(&mut ui, "edit.undo");
    assert_eq!(ui.state().state.document, before);
    // Without the hair it is one step, too, and is taken back whole.
    drop_on(&mut ui, &folder.path("head.obj"));
    press(&mut ui, "Instead of the hair");
    ui.run_steps(3);
    assert_eq!(ui.state().state.document.nodes.keys().collect::<Vec<_>>(), [&head]);
    press(&mut ui, "-90°");
    // What is said of the mesh moves the buttons.
    until("it is evaluated", || {
        ui.step();
        ui.state().is_idle()
    });
    ui.run_steps(3);
    press(&mut ui, "Cancel");
    assert_eq!(ui.state().state.document, before);
}

/// A bust and a bun, in a mesh file of two objects.
fn bust_with_a_bun() -> String {
    use std::fmt::Write;
    let bust = coif_nodes::scalp::bust::adult();
    let mut text = "o Head\n".to_owned();
    for p in &bust.points {
        let _ = writeln!(text, "v {} {} {}", p.x, p.y, p.z);
    }
    for [a, b, c] in &bust.triangles {
        let _ = writeln!(text, "f {} {} {}", a + 1, b + 1, c + 1);
    }
    // An octahedron that stands on the crown.
    let _ = writeln!(text, "o Top_Bun");
    for [x, y, z] in [[3, 10, 0], [0, 10, 3], [-3, 10, 0], [0, 10, -3], [0, 14, 0], [0, 7, 0]] {
        let _ = writeln!(text, "v {x} {y} {z}");
    }
    let n = bust.points.len();
    for [a, b, c] in
        [[1, 5, 2], [2, 5, 3], [3, 5, 4], [4, 5, 1], [2, 6, 1], [3, 6, 2], [4, 6, 3], [1, 6, 4]]
    {
        let _ = writeln!(text, "f {} {} {}", a + n, b + n, c + n);
    }
    text
}

#[test]
fn a_photographed_sphere_that_is_dropped_lights_the_picture() {
    let folder = Folder::new("life-sphere");
    let (mut ui, _) = on_empty_head();
    let mut sphere = b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 4 +X 8\n".to_vec();
    sphere.extend([128, 128, 128, 129].repeat(32));
    std::fs::write(folder.path("sky.hdr"), sphere).unwrap();
    std::fs::write(folder.path("broken.exr"), "no sphere").unwrap();
    let dropped = |ui: &mut Ui, name: &str| {
        drop_on(ui, &folder.path(name));
        until("it is read", || {
            ui.step();
            !ui.state().viewport.is_reading()
        });
        ui.step();
        ui.state().viewport.options.lights()
    };
    let lights = dropped(&mut ui, "sky.hdr");
    let (around, _) = lights.around.expect("it is taken");
    assert_eq!(around.path, folder.path("sky.hdr"));
    assert!(said(&ui, Gravity::Note).pop().unwrap().starts_with("lit by "));
    assert!(!is_changed(&ui), "the groom names no file of light");
    let kept = dropped(&mut ui, "broken.exr");
    assert_eq!(kept.around.map(|(around, _)| around), Some(around.clone()));
    let told = said(&ui, Gravity::Warning).pop().unwrap();
    assert!(told.contains("broken.exr: ") && told.contains("neither"), "{told}");
    // Pictures are saved in the same light, and a rig takes its place.
    press(&mut ui, "Look ⏷");
    ui.run_steps(2);
    press(&mut ui, "Lights: sky.hdr ⏵");
    ui.run_steps(2);
    press(&mut ui, "backlit");
    ui.run_steps(2);
    let options = &ui.state().viewport.options;
    assert_eq!((options.lights().around, options.rig()), (None, "backlit"));
}

#[test]
fn what_looks_like_hair_is_named_in_the_panel_and_left_out_by_a_tick() {
    let folder = Folder::new("life-leave-out");
    std::fs::write(folder.path("head.obj"), bust_with_a_bun()).unwrap();
    let (mut ui, _) = on_empty_head();
    drop_on(&mut ui, &folder.path("head.obj"));
    let head = life::head_of(&ui.state().state.document, None).unwrap();
    let left_out = |ui: &Ui| {
        let node = &ui.state().state.document.nodes[&head];
        node.inputs.get("leave_out").cloned()
    };
    until("its parts are listed", || {
        ui.step();
        ui.query_by_label("Top_Bun").is_some()
    });
    ui.get_by_label("hair, or worn?");
    assert_eq!(left_out(&ui), None, "nothing is ticked by itself");
    press(&mut ui, "Top_Bun");
    assert_eq!(left_out(&ui), Some(Setting::Known(Value::Text("Top_Bun".into()))));
    until("it is gone", || {
        ui.step();
        let shown = ui.state().state.shown.as_ref();
        shown.and_then(|shown| Some(shown.scalp()?.surface().bounds().1.y < 10.0)) == Some(true)
    });
    ui.get_by_label("Top_Bun");
    press(&mut ui, "Top_Bun");
    assert_eq!(left_out(&ui), None);
}

#[test]
fn a_file_that_others_change_is_told_and_reloaded_kept_or_compared() {
    let folder = Folder::new("life-disk");
    let path = folder.path("a.ron");
    let (mut ui, _) = on_empty_head();
    does(&mut ui, DocumentEvent::SaveTo(path.clone()));
    let looks = |ui: &Ui| ui.state().documents.watch.looks();
    let before = looks(&ui);
    until("it was looked at", || looks(&ui) >= before + 3);
    ui.step();
    assert!(!ui.state().documents.is_changed_on_disk(), "what we saved is no news");
    let mut theirs = ui.state().state.document.clone();
    theirs.seed = 5;
    let bald = NodeId::new("bald").unwrap();
    theirs.nodes.insert(bald.clone(), theirs.fresh_node("head", &bald).into());
    std::fs::write(&path, file::write(&theirs)).unwrap();
    until("it is noticed", || {
        ui.step();
        ui.state().documents.is_changed_on_disk()
    });
    ui.step();
    ui.run_steps(3);
    press(&mut ui, "Compare");
    ui.run_steps(3);
    let told: Vec<&str> = ui.state().compare().unwrap().lines().collect();
    assert_eq!(told, ["seed: 0 to 5", "bald: added (Head)"]);
    press(&mut ui, "Keep mine");
    assert!(ui.query_by_label("Compare").is_none());
    assert_eq!(ui.state().state.document.seed, 0);
    theirs.seed = 6;
    std::fs::write(&path, file::write(&theirs)).unwrap();
    until("it is noticed", || {
        ui.step();
        ui.state().documents.is_changed_on_disk()
    });
    ui.step();
    press(&mut ui, "Reload");
    assert_eq!(ui.state().state.document, theirs);
    assert!(!is_changed(&ui) && !ui.state().documents.is_changed_on_disk());
}

#[test]
fn hostile_files_are_told_and_change_nothing() {
    let folder = Folder::new("life-hostile");
    let (mut ui, _) = on_empty_head();
    let before = ui.state().state.document.clone();
    let deep = format!("(format: 1, nodes: {}", "{".repeat(100_000));
    let texts: [&[u8]; 7] = [
        b"",
        b"\xff\xfe\x00",
        b"(",
        b"[1, 2]",
        b"(format: 999)",
        deep.as_bytes(),
        b"(format: 1, nodes: {\"A B\": ()})",
    ];
    for (i, text) in texts.iter().enumerate() {
        let path = folder.path(&format!("{i}.ron"));
        std::fs::write(&path, text).unwrap();
        drop_on(&mut ui, &path);
        let told = said(&ui, Gravity::Error);
        assert_eq!(told.len(), i + 1, "{told:?}");
        assert!(told[i].contains(&format!("{i}.ron")), "{told:?}");
    }
    does(&mut ui, DocumentEvent::Open(folder.root().to_owned()));
    does(&mut ui, DocumentEvent::Open(folder.path("none.ron")));
    assert_eq!(said(&ui, Gravity::Error).len(), texts.len() + 2);
    assert_eq!(ui.state().state.document, before);
}

/// Adds some guides and an output to the empty head.
fn few_guides(ui: &mut Ui) {
    let [head, guides, out] = ["head", "guides", "out"].map(|id| NodeId::new(id).unwrap());
    let document = &ui.state().state.document;
    let add = |id: &NodeId, kind: &str| Edit::AddNode {
        id: id.clone(),
        node: document.fresh_node(kind, id).into(),
        at: None,
    };
    let wire = |from: &NodeId, output: &str, to: &NodeId, input: &str| Edit::Connect {
        from: Socket::new(from.clone(), output),
        to: Socket::new(to.clone(), input),
        at: None,
    };
    let several = vec![
        add(&guides, "scatter_guides"),
        add(&out, "groom_output"),
        wire(&head, "scalp", &guides, "scalp"),
        wire(&guides, "curves", &out, "curves"),
        Edit::SetInput {
            node: guides.clone(),
            input: "count".to_owned(),
            setting: Setting::Known(Value::Int(60)),
        },
    ];
    edit(ui, Edit::Several(several));
}

#[test]
fn a_document_with_a_file_is_saved_by_itself_unless_somebody_wants_it_not() {
    let folder = Folder::new("life-itself");
    let path = folder.path("a.ron");
    let (mut ui, _) = on_empty_head();
    does(&mut ui, DocumentEvent::SaveTo(path.clone()));
    let long_ago = |ui: &mut Ui| {
        ui.state_mut().documents.saved_at = -1e6;
        ui.step();
    };
    edit(&mut ui, Edit::SetSeed(3));
    let usual = ui.state().state.settings.clone();
    let never = Settings { save_minutes: 0, ..usual.clone() };
    ui.state_mut().apply(Event::Settings(Box::new(never)));
    long_ago(&mut ui);
    assert_eq!(read(&path).seed, 0);
    ui.state_mut().apply(Event::Settings(Box::new(usual)));
    ui.state_mut().apply(Event::Begin(String::new()));
    long_ago(&mut ui);
    assert_eq!(read(&path).seed, 0, "not within a gesture");
    ui.state_mut().apply(Event::End);
    long_ago(&mut ui);
    assert_eq!(read(&path).seed, 3);
    edit(&mut ui, Edit::SetSeed(4));
    ui.step();
    assert_eq!(read(&path).seed, 3, "not yet again");
}

#[test]
fn hostile_meshes_are_told_by_the_node_and_can_be_taken_back() {
    let bad = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../shared/data/bad/made_here"));
    let Ok(entries) = std::fs::read_dir(bad) else {
        return println!("skipped: hostile meshes need ../shared");
    };
    let mut paths: Vec<PathBuf> = entries.flatten().map(|entry| entry.path()).collect();
    paths.retain(|path| {
        let ending = path.extension().unwrap_or_default().to_string_lossy().to_lowercase();
        ["obj", "glb", "usdz"].contains(&&*ending)
    });
    paths.sort();
    assert!(paths.len() >= 8);
    let (mut ui, _) = on_empty_head();
    let before = ui.state().state.document.clone();
    let mut refused = 0;
    for path in paths {
        drop_on(&mut ui, &path);
        until("it is evaluated", || {
            ui.step();
            let state = &ui.state().state;
            ui.state().is_idle() && state.run.reports.revision == state.revision
        });
        let said = crate::rooms::messages::all(&ui.state().state);
        refused += usize::from(said.iter().any(|m| {
            m.gravity == Gravity::Error && m.node.as_ref().is_some_and(|id| id.as_str() == "head")
        }));
        press(&mut ui, "Cancel");
        assert_eq!(ui.state().state.document, before, "{}", path.display());
    }
    assert!(refused >= 6, "{refused}");
}

#[cfg(unix)]
#[test]
fn what_is_read_or_read_only_is_not_written_over_and_links_stay() {
    use std::os::unix::fs::{PermissionsExt, symlink};
    let folder = Folder::new("life-over");
    let mesh = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    std::fs::write(folder.path("head.obj"), mesh).unwrap();
    let (mut ui, _) = on_empty_head();
    few_guides(&mut ui);
    let head = life::head_of(&ui.state().state.document, None).unwrap();
    let link = folder.path("link.ron");
    symlink("real.ron", &link).unwrap();
    does(&mut ui, DocumentEvent::SaveTo(link.clone()));
    assert!(link.is_symlink() && folder.path("real.ron").is_file());
    let setting = Setting::Known(Value::Text("head.obj".into()));
    edit(&mut ui, Edit::SetInput { node: head, input: "mesh".into(), setting });
    does(&mut ui, DocumentEvent::Save);
    let saved = std::fs::read_to_string(folder.path("real.ron")).unwrap();
    assert!(saved.contains("head.obj") && link.is_symlink());
    let mut refused = |act: &dyn Fn(&mut Ui), why: &str| {
        act(&mut ui);
        exporting::all_written(&mut ui);
        let told = said(&ui, Gravity::Error);
        assert!(told.last().is_some_and(|text| text.contains(why)), "{told:?}");
        assert_eq!(std::fs::read_to_string(folder.path("head.obj")).unwrap(), mesh);
        assert_eq!(std::fs::read_to_string(folder.path("real.ron")).unwrap(), saved);
    };
    symlink("head.obj", folder.path("mesh.ron")).unwrap();
    let over_mesh = DocumentEvent::SaveTo(folder.path("mesh.ron"));
    refused(&|ui| does(ui, over_mesh.clone()), "which is read");
    std::fs::hard_link(folder.path("real.ron"), folder.path("a.usdc")).unwrap();
    refused(&|ui| exporting::export(ui, folder.path("a.usdc")), "which is read");
    let locked = std::fs::Permissions::from_mode(0o444);
    std::fs::set_permissions(folder.path("real.ron"), locked).unwrap();
    refused(&|ui| does(ui, DocumentEvent::Save), "is read-only; choose another name");
}

#[test]
fn where_the_system_has_no_dialog_the_browser_of_the_window_serves() {
    let folder = Folder::new("life-browser");
    let path = folder.path("a.ron");
    std::fs::write(&path, coif_graphs::grooms::by_name("braids").unwrap()).unwrap();
    let (mut ui, fake) = on(life::empty_head(), OpenFile::at(folder.path("b.ron")));
    fake.answers(Answer::NoDialog);
    act(&mut ui, "file.open");
    until("the folder is read", || {
        ui.step();
        ui.query_by_label("a.ron").is_some()
    });
    press(&mut ui, "a.ron");
    press(&mut ui, "Open");
    assert_eq!(ui.state().state.file.path, Some(path));
    // The system is not asked again, and the keyboard does it too.
    act(&mut ui, "file.save_as");
    assert_eq!(fake.asked.lock().unwrap().len(), 1);
    ui.step();
    let typed = "c.ron";
    ui.event(egui::Event::Key {
        key: egui::Key::A,
        physical_key: None,
        pressed: true,
        repeat: false,
        modifiers: egui::Modifiers::COMMAND,
    });
    ui.event(egui::Event::Text(typed.to_owned()));
    ui.step();
    ui.key_press(egui::Key::Enter);
    ui.step();
    ui.step();
    assert_eq!(ui.state().state.file.path, Some(folder.path("c.ron")));
    act(&mut ui, "file.open");
    ui.key_press(egui::Key::Escape);
    ui.step();
    ui.step();
    assert!(ui.state().documents.browser.is_none());
}

#[test]
fn settings_and_layout_are_kept_and_damaged_ones_are_told() {
    let folder = Folder::new("life-settings");
    let home = Places::under(folder.root());
    let ctx = egui::Context::default();
    let (mut ui, _) = on_empty_head();
    ui.state_mut().keep_in(&ctx, home.clone());
    ui.state_mut().greet();
    ui.step();
    assert!(ui.state().documents.shows_welcome(), "a first start");
    let mut settings = ui.state().state.settings.clone();
    (settings.scale, settings.trackball, settings.welcome) = (1.5, true, false);
    ui.state_mut().apply(Event::Settings(Box::new(settings.clone())));
    ui.step();
    ui.step();
    assert_eq!(ui.ctx.zoom_factor(), 1.5);
    does(&mut ui, DocumentEvent::Close);
    drop(ui);
    let (mut ui, _) = on_empty_head();
    ui.state_mut().keep_in(&ctx, home.clone());
    assert_eq!(ui.state().state.settings, settings);
    ui.state_mut().greet();
    assert!(!ui.state().documents.shows_welcome());
    drop(ui);
    std::fs::write(home.settings(), "(scale: oops").unwrap();
    std::fs::write(home.layout(), "[]").unwrap();
    std::fs::write(home.keys(), "nonsense").unwrap();
    let (mut ui, _) = on_empty_head();
    ui.state_mut().keep_in(&ctx, home.clone());
    ui.step();
    assert_eq!(ui.state().state.settings, Default::default());
    let told = said(&ui, Gravity::Warning);
    assert!(told[0].contains("settings.ron.bad") && told[1].contains("layout.ron.bad"), "{told:?}");
    assert!(told[2].contains("keys.ron") && folder.path("settings.ron.bad").exists());
}

#[test]
fn what_a_crash_left_is_offered_restored_kept_or_discarded() {
    let folder = Folder::new("life-crash");
    let home = Places::under(folder.root());
    let ctx = egui::Context::default();
    let crash = |seed: u64| {
        let (mut ui, _) = on_empty_head();
        ui.state_mut().keep_in(&ctx, home.clone());
        edit(&mut ui, Edit::SetSeed(seed));
        until("it is safe", || ui.state().documents.is_safe());
    };
    crash(11);
    let (mut ui, _) = on_empty_head();
    ui.state_mut().keep_in(&ctx, home.clone());
    ui.step();
    press(&mut ui, "Restore");
    assert_eq!(ui.state().state.document.seed, 11);
    assert!(is_changed(&ui), "it is not saved");
    until("it is safe", || ui.state().documents.is_safe());
    // Crashed again: it is still there, once.
    drop(ui);
    let seeds = || leftovers(&home.recovery()).iter().map(|l| l.document.seed).collect::<Vec<_>>();
    assert_eq!(seeds(), [11]);
    let (mut ui, _) = on_empty_head();
    ui.state_mut().keep_in(&ctx, home.clone());
    ui.step();
    press(&mut ui, "Keep for later");
    assert!(ui.query_by_label("Restore").is_none());
    assert_eq!(seeds(), [11]);
    drop(ui);
    let (mut ui, _) = on_empty_head();
    ui.state_mut().keep_in(&ctx, home.clone());
    ui.step();
    press(&mut ui, "Discard");
    assert!(seeds().is_empty());
    // What was saved or closed as somebody wanted is not offered.
    edit(&mut ui, Edit::SetSeed(12));
    does(&mut ui, DocumentEvent::SaveTo(folder.path("saved.ron")));
    until("it is safe", || ui.state().documents.is_safe());
    drop(ui);
    assert!(seeds().is_empty());
}

/// Changes a document step after step until it is killed; each step is a gesture of several edits. Says on stdout which
/// steps were done, and which were safe.
#[test]
#[ignore = "is run and killed by the test below"]
fn child_that_is_killed() {
    let Some(folder) = std::env::var_os("COIF_TEST_KILL") else { return };
    let groom = coif_graphs::grooms::by_name("cornrows").unwrap();
    let mut document = file::read(groom).unwrap().document;
    document.display = Some(NodeId::new("head").unwrap());
    let (mut ui, _) = on(document, OpenFile::default());
    let home = Places::under(Path::new(&folder));
    ui.state_mut().keep_in(&egui::Context::default(), home);
    // What runs tests has not ended its line.
    println!();
    for n in 1.. {
        ui.state_mut().apply(Event::Begin(String::new()));
        ui.state_mut().apply(Event::Edit(Edit::SetSeed(n)));
        ui.step();
        ui.state_mut().apply(Event::Edit(Edit::SetTitle(format!("step {n}"))));
        ui.state_mut().apply(Event::End);
        ui.step();
        println!("did {n}");
        if n % 3 == 0 {
            until("it is safe", || ui.state().documents.is_safe());
            println!("safe {n}");
        }
    }
}

#[cfg(unix)]
#[test]
fn a_process_killed_at_any_moment_loses_at_most_what_was_not_yet_safe() {
    use std::io::{BufRead, BufReader, Read};
    use std::process::{Command, Stdio};
    let folder = Folder::new("life-kill");
    let recovery = Places::under(folder.root()).recovery();
    let mut lost = vec![];
    for round in 0..20u64 {
        let mut child = Command::new(std::env::current_exe().unwrap())
            .args(["--exact", "editor::documents::tests::child_that_is_killed"])
            .args(["--ignored", "--nocapture", "--test-threads=1"])
            .env("COIF_TEST_KILL", folder.root())
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        let mut out = BufReader::new(child.stdout.take().unwrap());
        let mut text = String::new();
        while !text.contains("did 1\n") {
            assert!(out.read_line(&mut text).unwrap() > 0, "{text}");
        }
        // Spread over some steps, so that every part of a step is hit.
        std::thread::sleep(std::time::Duration::from_micros(round * 7919 % 90_000));
        child.kill().unwrap();
        child.wait().unwrap();
        out.read_to_string(&mut text).unwrap();
        let last = |word: &str| {
            let lines = text.lines().filter_map(|line| line.strip_prefix(word));
            lines.filter_map(|rest| rest.split(' ').next()?.parse::<u64>().ok()).max().unwrap_or(0)
        };
        let (did, safe) = (last("did "), last("safe "));
        let left = leftovers(&recovery);
        let found = left.first().map_or(0, |left| left.document.seed);
        assert!(left.len() <= 1, "one for each session");
        assert!((safe..=did + 1).contains(&found), "safe {safe}, found {found}, did {did}");
        for left in left {
            // The document after a whole step, in everything that the step changed.
            assert_eq!(left.document.title, format!("step {found}"));
            assert!(left.document.nodes.len() > 3);
            left.discard();
        }
        lost.push(did.saturating_sub(found));
    }
    lost.sort_unstable();
    println!("steps lost: {lost:?}");
}

#[test]
fn saving_and_exporting_begin_in_the_grooms_folder() {
    let (heads, grooms) = (Folder::new("life-heads"), Folder::new("life-grooms"));
    std::fs::write(heads.path("head.obj"), bust_with_a_bun()).unwrap();
    let (mut ui, fake) = on_empty_head();
    few_guides(&mut ui);
    does(&mut ui, DocumentEvent::SaveTo(grooms.path("a.ron")));
    // Another folder was the last that anybody chose in.
    fake.answers(Answer::Chosen(heads.path("head.obj")));
    act(&mut ui, "file.head");
    press(&mut ui, "Cancel");
    for action in ["file.save_as", "file.export", "file.picture", "file.open"] {
        fake.answers(Answer::Nothing);
        act(&mut ui, action);
        if ui.query_by_label("Browse…").is_some() {
            press(&mut ui, "Browse…");
            press(&mut ui, "Close");
        }
        let asked = fake.asked.lock().unwrap().last().cloned().unwrap();
        assert_eq!(asked.folder, grooms.root(), "{action}");
    }
    fake.answers(Answer::Nothing);
    act(&mut ui, "file.head");
    assert_eq!(fake.asked.lock().unwrap().last().unwrap().folder, heads.root());
}

/// The built-in head as another program would export it: scaled, and far from the origin.
fn far_head(folder: &Folder) -> PathBuf {
    let bust = coif_nodes::scalp::bust::adult();
    let mut text = String::new();
    for p in &bust.points {
        let p = *p * 0.4 + glam::Vec3::new(400.0, -900.0, 250.0);
        text += &format!("v {} {} {}\n", p.x, p.y, p.z);
    }
    for [a, b, c] in &bust.triangles {
        text += &format!("f {} {} {}\n", a + 1, b + 1, c + 1);
    }
    let path = folder.path("far.obj");
    std::fs::write(&path, text).unwrap();
    path
}

#[test]
fn a_head_of_ones_own_begins_a_new_groom_from_the_welcome_panel_and_is_framed() {
    let folder = Folder::new("life-far-head");
    let puffs = file::read(coif_graphs::grooms::by_name("puffs").unwrap()).unwrap().document;
    let (mut ui, fake) = on(puffs, OpenFile::default());
    ui.run_steps(2);
    act(&mut ui, "file.new");
    fake.answers(Answer::Chosen(far_head(&folder)));
    press(&mut ui, "Your own head…");
    ui.step();
    let kinds = |ui: &Ui| -> Vec<String> {
        ui.state().state.document.nodes.values().map(|node| node.kind.clone()).collect()
    };
    assert_eq!(kinds(&ui), ["head"], "the groom that was there is not put on it");
    let accept = ui.get_by_label("Accept").rect();
    until("the head is read and framed", || {
        ui.step();
        ui.state().is_idle() && ui.state().viewport.is_idle()
    });
    ui.run_steps(3);
    assert_eq!(ui.get_by_label("Accept").rect(), accept, "what was found moves no button");
    let editor = ui.state();
    let (view, shown) = (editor.viewport.projection(), editor.state.shown.as_ref().unwrap());
    let frame = shown.scalp().unwrap().frame();
    let picture = editor.place_of(crate::core::room::Room::Viewport).unwrap();
    let panel = crate::widgets::panel::id("own head", &ui.ctx);
    let panel = ui.ctx.memory(|memory| memory.area_rect(panel)).unwrap();
    for (what, at) in [
        ("crown", frame.origin + frame.up * frame.radius),
        ("nose", frame.origin + frame.forward * frame.radius),
        ("chin", frame.origin - frame.up * frame.radius),
    ] {
        let seen = view.screen(at).expect(what);
        assert!(picture.contains(seen) && !panel.contains(seen), "{what} at {seen:?}, {panel:?}");
    }
    // The face looks at the eye.
    let to_eye = (view.camera.eye - frame.origin).normalize();
    assert!(to_eye.dot(frame.forward) > 0.8, "{to_eye}");
    // So are its nodes.
    let room = editor.place_of(crate::core::room::Room::Canvas).unwrap();
    let Editor { canvas, state, .. } = ui.state_mut();
    let node = canvas.place(state, &NodeId::new("head").unwrap()).unwrap();
    let off = canvas.to_screen(node.center()) - room.center();
    assert!(off.length() < 40.0, "{off}");
    // The same once more asks once more how it stands.
    press(&mut ui, "Accept");
    assert!(!ui.state().documents.places_head());
    fake.answers(Answer::Chosen(folder.path("far.obj")));
    act(&mut ui, "file.head");
    assert!(ui.state().documents.places_head());
}
