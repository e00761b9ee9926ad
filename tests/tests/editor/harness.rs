//! An editor driven as a person drives it, without a display.

use coif::core::state::OpenFile;
use coif::editor::Editor;
use coif_graphs::document::Document;
use coif_graphs::document::graph::{Severity, check};
use coif_graphs::{file, grooms};
use coif_tests::waiting::until;
use egui_kittest::Harness;

/// Of the window, points.
pub(crate) const SIZE: egui::Vec2 = egui::vec2(1440.0, 900.0);

/// The editor in a window that nobody sees.
pub(crate) type Ui = Harness<'static, Editor>;

/// An editor on a shipped groom.
pub(crate) fn on_groom(name: &str) -> Ui {
    let text = grooms::by_name(name).expect("a shipped groom");
    on(file::read(text).expect("shipped grooms are valid").document)
}

/// An editor on a document without a file.
pub(crate) fn on(document: Document) -> Ui {
    // The editor needs the context that it lives in; the first frame brings it.
    let ctx = egui::Context::default();
    let editor = Editor::new(&ctx, document, OpenFile::default());
    Harness::builder()
        .with_size(SIZE)
        .with_max_steps(64)
        .build_ui_state(|ui, editor: &mut Editor| editor.ui(ui), editor)
}

/// Frames until nothing is evaluated and nothing waits to be.
pub(crate) fn settle(ui: &mut Ui) {
    until("an evaluation ends", || {
        ui.step();
        ui.state().is_idle()
    });
    ui.step();
}

/// That a document can be evaluated, saved and read again.
#[track_caller]
pub(crate) fn is_sound(document: &Document) {
    let text = file::write(document);
    let back = file::read(&text).unwrap_or_else(|err| panic!("{err}\n{text}"));
    assert_eq!(&back.document, document, "what was written reads the same");
    let wrong: Vec<String> = check(document)
        .iter()
        .filter(|p| p.severity == Severity::Error && p.needed)
        .map(ToString::to_string)
        .collect();
    let only_unwired =
        wrong.iter().all(|text| text.contains("not connected") || text.contains("wire"));
    assert!(only_unwired, "{wrong:?}");
}
