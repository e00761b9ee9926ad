//! Exporting by hand: the panel's options, the queue, and what need not be evaluated again.

use super::super::export::{Content, Ended, ExportState, HairChoice};
use super::*;
use crate::core::settings::Evaluate;

/// Exports all hair to a file.
pub(super) fn export(ui: &mut Ui, path: PathBuf) {
    ui.state_mut().export(Content::Hair(HairChoice::default()), path);
    ui.run_steps(2);
}

/// Waits until all that was asked for is written, or is not.
pub(super) fn all_written(ui: &mut Ui) {
    until("all is written", || {
        ui.step();
        !ui.state().documents.exports.is_going()
    });
}

/// How the last export ended.
fn ended(ui: &Ui) -> Ended {
    match &ui.state().documents.exports.told().next().unwrap().state {
        ExportState::Ended(ended) => ended.clone(),
        other => panic!("{other:?}"),
    }
}

fn set(ui: &mut Ui, node: &str, input: &str, value: Value) {
    let (node, input) = (NodeId::new(node).unwrap(), input.to_owned());
    edit(ui, Edit::SetInput { node, input, setting: Setting::Known(value) });
}

/// Some hair between the guides instead of them, and a second output, of the guides.
fn hair_and_guides(ui: &mut Ui) {
    for (id, kind) in [("hair", "interpolate"), ("guides_out", "groom_output")] {
        let id = NodeId::new(id).unwrap();
        let node = ui.state().state.document.fresh_node(kind, &id).into();
        edit(ui, Edit::AddNode { id, node, at: None });
    }
    for (from, to) in [
        ("head.scalp", "hair.scalp"),
        ("guides.curves", "hair.guides"),
        ("hair.curves", "out.curves"),
        ("guides.curves", "guides_out.curves"),
    ] {
        let [from, to] = [from, to].map(|socket| socket.parse().unwrap());
        edit(ui, Edit::Connect { from, to, at: None });
    }
    // Of a tuft a preview makes 16 hairs at least.
    set(ui, "hair", "density", Value::Float(10.0));
    set(ui, "guides_out", "guides", Value::Bool(true));
}

fn command_line(groom: &Path, out: &Path, more: &[&str]) {
    use clap::Parser;
    #[derive(Parser)]
    struct Words {
        #[command(flatten)]
        eval: crate::cli::eval::EvalArgs,
    }
    let words = ["coif", groom.to_str().unwrap(), "--out", out.to_str().unwrap()];
    let exit = crate::cli::eval::run(Words::parse_from(words.iter().chain(more)).eval);
    assert_eq!(exit, crate::jobs::stop::Exit::Done);
}

#[test]
fn what_the_panel_writes_is_what_the_command_line_writes() {
    let folder = Folder::new("life-export");
    let (mut ui, fake) = on_empty_head();
    ui.state_mut().act("file.export");
    assert_eq!(
        said(&ui, Gravity::Note).last().unwrap(),
        "Export hair…: the graph has no groom output"
    );
    few_guides(&mut ui);
    hair_and_guides(&mut ui);
    let saved = folder.path("guides.ron");
    does(&mut ui, DocumentEvent::SaveTo(saved.clone()));
    act(&mut ui, "file.export");
    // What is pressed before it is exported, and the options that say the same.
    let cases: [(&str, &[&str], &[&str]); 6] = [
        ("all.usdc", &[], &[]),
        ("houdini.usdc", &["Houdini"], &["--with-head"]),
        ("maya.abc", &["Maya"], &["--with-head"]),
        ("unreal.abc", &["Unreal"], &[]),
        ("tenth.usda", &["Blender", ".usda", "A tenth"], &["--quality", "preview"]),
        ("hair.hair", &[".hair", "All", "guides_out (guides)"], &["--output", "out.curves"]),
    ];
    for (name, pressed, _) in cases {
        // A name without an ending gets that of the format.
        let stem = folder.path(name.split('.').next().unwrap());
        fake.answers(Answer::Chosen(stem));
        press(&mut ui, "Browse…");
        pressed.iter().for_each(|label| press(&mut ui, label));
        press(&mut ui, "Export");
    }
    all_written(&mut ui);
    assert_eq!(said(&ui, Gravity::Error), Vec::<String>::new());
    let notes = said(&ui, Gravity::Note);
    for (name, _, words) in cases {
        let theirs = folder.path(&format!("line-{name}"));
        command_line(&saved, &theirs, words);
        let (ours, theirs) = (std::fs::read(folder.path(name)), std::fs::read(theirs));
        assert!(ours.unwrap() == theirs.unwrap(), "{name}");
        let told = format!("exported {}: ", folder.path(name).display());
        let note = notes.iter().find(|note| note.starts_with(&told)).expect(name);
        assert!(note.contains(" curves, "), "{note}");
    }
    let curves = |name: &str| {
        let told = notes.iter().find(|note| note.contains(name)).unwrap();
        told.rsplit(": ").next().unwrap().split(' ').next().unwrap().replace(',', "")
    };
    let [all, tenth]: [usize; 2] = ["all.usdc", "tenth.usda"].map(|n| curves(n).parse().unwrap());
    assert!(tenth > 60 && 4 * (tenth - 60) < all - 60, "{tenth} of {all}, with 60 guides each");
    let unreal: Vec<&String> = notes.iter().filter(|note| note.starts_with("Unreal: ")).collect();
    assert!(unreal.iter().any(|note| note.contains("these guides go with")), "{unreal:?}");
    // The last of them is there already, and nothing can be exported without an output.
    until("it is seen", || {
        ui.step();
        ui.query_by_label("replaces the file that is there").is_some()
    });
    ui.get_by_role_and_label(egui::accesskit::Role::CheckBox, "out").click();
    ui.run_steps(2);
    press(&mut ui, "Export");
    assert!(!ui.state().documents.exports.is_going());
    ui.key_press(egui::Key::Escape);
    ui.run_steps(2);
    assert!(!ui.state().documents.export_panel.is_open);
}

#[test]
fn what_is_evaluated_already_is_not_evaluated_for_an_export() {
    let folder = Folder::new("life-export-known");
    let (mut ui, _) = on_empty_head();
    few_guides(&mut ui);
    until("it is shown in full", || {
        ui.step();
        let shown = ui.state().state.shown.as_ref();
        ui.state().is_idle() && shown.is_some_and(|shown| shown.is_final())
    });
    let ran = |ui: &mut Ui, name: &str| {
        export(ui, folder.path(name));
        all_written(ui);
        match ended(ui) {
            Ended::Done(written) => written.ran,
            other => panic!("{other:?}"),
        }
    };
    assert_eq!(ran(&mut ui, "shown.usdc"), (0, 3));
    // What is not shown yet runs once, for the export, and then for the window no more.
    let mut settings = ui.state().state.settings.clone();
    settings.evaluate = Evaluate::ByKey;
    ui.state_mut().apply(Event::Settings(Box::new(settings)));
    set(&mut ui, "guides", "count", Value::Int(40));
    assert_eq!(ran(&mut ui, "changed.usdc"), (2, 3));
    assert_eq!(ran(&mut ui, "again.abc"), (0, 3));
    act(&mut ui, "evaluate.now");
    until("it is shown", || {
        ui.step();
        let shown = ui.state().state.shown.as_ref();
        shown.is_some_and(|shown| shown.curves.curve_count() == 40)
    });
    let reports = &ui.state().state.run.reports;
    assert!(reports.nodes.values().all(|node| node.cached), "the export's values are kept");
}

#[test]
fn exports_wait_for_their_turn_and_each_can_be_stopped() {
    let folder = Folder::new("life-export-queue");
    let (mut ui, _) = on_empty_head();
    does(&mut ui, DocumentEvent::New(Some("cornrows")));
    export(&mut ui, folder.path("slow.usdc"));
    // Each is of the groom as it was when it was asked for.
    does(&mut ui, DocumentEvent::New(None));
    few_guides(&mut ui);
    act(&mut ui, "file.export");
    export(&mut ui, folder.path("second.usdc"));
    export(&mut ui, folder.path("third.usdc"));
    ui.get_by_label_contains("(2 more to write)");
    press(&mut ui, "Stop writing third.usdc");
    assert!(matches!(ended(&ui), Ended::Stopped));
    does(&mut ui, DocumentEvent::StopExport);
    all_written(&mut ui);
    let written = std::fs::read_dir(folder.root()).unwrap().flatten();
    let names: Vec<_> = written.map(|file| file.file_name()).collect();
    assert_eq!(names, ["second.usdc"]);
    let listed = &ui.state().documents.exports;
    let listed: Vec<_> = listed.told().map(|row| row.path.file_stem().unwrap()).collect();
    assert_eq!(listed, ["second", "slow", "third"], "the newest first");
    ui.get_by_label_contains("60 curves");
}

#[test]
fn the_pictures_of_the_panel_are_those_of_the_command_line() {
    use clap::Parser;
    #[derive(Parser)]
    struct Words {
        #[command(flatten)]
        render: crate::cli::render::RenderArgs,
    }
    let folder = Folder::new("life-picture");
    let (mut ui, fake) = on_empty_head();
    few_guides(&mut ui);
    ui.state_mut().viewport.options.turn_light(10.0);
    ui.run_steps(2);
    act(&mut ui, "file.picture");
    // The panel follows the light that is turned beside it.
    ui.state_mut().viewport.options.turn_light(20.0);
    ui.run_steps(2);
    let saved = folder.path("guides.ron");
    does(&mut ui, DocumentEvent::SaveTo(saved.clone()));
    let panel = &mut ui.state_mut().documents.picture_panel;
    (panel.size, panel.samples, panel.frames) = ([64, 48], 1, 2);
    "front".clone_into(&mut panel.camera);
    for label in ["Transparent", "Frames", "Light goes round"] {
        press(&mut ui, label);
    }
    fake.answers(Answer::Chosen(folder.path("turn")));
    press(&mut ui, "Browse…");
    press(&mut ui, "Save pictures");
    all_written(&mut ui);
    let told = said(&ui, Gravity::Error);
    if told.iter().any(|text| text.contains("adapter")) {
        return println!("skipped: a picture needs something that draws: {told:?}");
    }
    let note = said(&ui, Gravity::Note).pop().unwrap_or_default();
    let words = "turn.%04d.png: 2 pictures, 64 x 48, final, 60 strands";
    assert!(note.contains(words), "{note} {told:?}");
    let (ours, theirs) = (folder.path("turn.0001.png"), folder.path("line.%04d.png"));
    let words = ["coif", saved.to_str().unwrap(), "--out", theirs.to_str().unwrap()];
    let more = "--size 64x48 --samples 1 --camera front --background transparent --turntable 2 --turn light";
    let words = words.into_iter().chain(more.split(' '));
    let exit = crate::cli::render::run(&Words::parse_from(words).render);
    assert_eq!(exit, crate::jobs::stop::Exit::Done);
    let bytes = |name: &str| std::fs::read(folder.path(name)).unwrap();
    for number in ["0001", "0002"] {
        let [ours, theirs] = ["turn", "line"].map(|stem| bytes(&format!("{stem}.{number}.png")));
        assert!(ours == theirs, "{number}");
    }
    let icon = |path: &Path| eframe::icon_data::from_png_bytes(&std::fs::read(path).unwrap());
    let [first, second] = [ours, folder.path("turn.0002.png")].map(|path| icon(&path).unwrap());
    assert_eq!((first.width, first.height), (64, 48));
    let alphas =
        |icon: &egui::IconData| -> Vec<u8> { icon.rgba.chunks(4).map(|pixel| pixel[3]).collect() };
    assert!(alphas(&first).contains(&0) && alphas(&first).contains(&255));
    assert_eq!(alphas(&first), alphas(&second), "the camera stays");
    assert_ne!(first.rgba, second.rgba, "the light goes round");
}

#[test]
fn a_picture_of_the_view_of_the_moment_is_no_saved_view() {
    let folder = Folder::new("life-picture-view");
    let (mut ui, fake) = on_empty_head();
    few_guides(&mut ui);
    act(&mut ui, "file.picture");
    let offered = ui.state().documents.picture_panel.file.path().unwrap();
    assert_eq!(offered.file_name().unwrap(), "untitled.png");
    // A turntable's file has a place for numbers, for as long as it is one; and its format is kept.
    let typed = |ui: &Ui| ui.state().documents.picture_panel.file.typed.clone();
    for (label, ending) in
        [(".exr", "untitled.exr"), ("Frames", "untitled.%04d.exr"), ("Frames", "untitled.exr")]
    {
        press(&mut ui, label);
        assert!(typed(&ui).ends_with(ending), "{label}: {}", typed(&ui));
    }
    fake.answers(Answer::Chosen(folder.path("a")));
    press(&mut ui, "Browse…");
    assert_eq!(typed(&ui), folder.path("a.exr").display().to_string());
    press(&mut ui, "Save picture");
    assert!(ui.state().documents.exports.is_going());
    does(&mut ui, DocumentEvent::StopExport);
    all_written(&mut ui);
    assert!(ui.state().state.document.views.is_empty());
    assert_eq!(std::fs::read_dir(folder.root()).unwrap().count(), 0);
}

#[test]
fn a_stopped_or_refused_export_leaves_no_file() {
    let folder = Folder::new("life-export-stop");
    let (mut ui, _) = on_empty_head();
    does(&mut ui, DocumentEvent::New(Some("cornrows")));
    export(&mut ui, folder.path("a.usdc"));
    does(&mut ui, DocumentEvent::StopExport);
    all_written(&mut ui);
    assert_eq!(
        said(&ui, Gravity::Note).last().unwrap(),
        "the export was stopped; nothing was written"
    );
    // Closing asks, stops it, and waits until its things are put away.
    export(&mut ui, folder.path("b.usdc"));
    assert!(close_requested(&mut ui).contains(&ViewportCommand::CancelClose));
    ui.step();
    press(&mut ui, "Cancel");
    assert!(ui.state().documents.exports.is_going());
    assert!(close_requested(&mut ui).contains(&ViewportCommand::CancelClose));
    ui.step();
    ui.get_by_label("Close").click();
    let mut closed = false;
    until("it closes", || {
        closed |= step_commands(&mut ui).contains(&ViewportCommand::Close);
        closed
    });
    assert!(!ui.state().documents.exports.is_going());
    export(&mut ui, folder.path("a.fbx"));
    all_written(&mut ui);
    assert!(said(&ui, Gravity::Error)[0].contains("grooms are written as"));
    assert_eq!(std::fs::read_dir(folder.root()).unwrap().count(), 0);
}

#[test]
fn the_panel_keeps_its_size_and_its_button_whatever_is_written() {
    let folder = Folder::new("export-still");
    let (mut ui, _) = on_empty_head();
    few_guides(&mut ui);
    act(&mut ui, "file.export");
    ui.run_steps(4);
    let button = |ui: &Ui| ui.get_by_label("Export").rect();
    let before = button(&ui);
    for number in 0..6 {
        export(&mut ui, folder.path(&format!("{number}.usda")));
        assert_eq!(button(&ui), before, "while {number} is written");
    }
    all_written(&mut ui);
    ui.run_steps(4);
    assert_eq!(button(&ui), before);
}
