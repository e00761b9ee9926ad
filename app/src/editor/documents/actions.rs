//! What the documents' room adds to the table of actions.

use crate::core::action::{Action, Can};
use crate::core::documents::{DocumentEvent, Purpose};
use crate::core::event::Event;
use crate::editor::Editor;
use crate::editor::actions::{Own, always};

fn file(event: DocumentEvent, out: &mut Vec<Event>) {
    out.push(Event::Documents(event));
}

fn compares(editor: &Editor) -> Can {
    match editor.compare() {
        Some(_) => Ok(()),
        None => Err("no other groom is open beside this one"),
    }
}

/// The menu "File".
pub(crate) const ACTIONS: &[Own] = &[
    Action {
        id: "file.new",
        label: "New…",
        tip: "Shipped grooms with pictures, the empty head, and one's own.",
        words: "template preset welcome start create",
        menu: "File",
        when: always,
        run: |_, out| file(DocumentEvent::Welcome(true), out),
    },
    Action {
        id: "file.empty",
        label: "New empty head",
        tip: "A head without hair.",
        words: "blank scene create bald",
        menu: "File",
        when: always,
        run: |_, out| file(DocumentEvent::New(None), out),
    },
    Action {
        id: "file.open",
        label: "Open…",
        tip: "Opens a groom (.ron).",
        words: "load read file",
        menu: "File",
        when: always,
        run: |_, out| file(DocumentEvent::Ask(Purpose::Open), out),
    },
    Action {
        id: "file.recent",
        label: "Open recent…",
        tip: "The grooms that were open lately.",
        words: "last history load",
        menu: "File",
        when: always,
        run: |_, out| file(DocumentEvent::Welcome(true), out),
    },
    Action {
        id: "file.head",
        label: "Own head…",
        tip: "A mesh (.obj, .glb, .gltf) becomes the head that hair grows on.",
        words: "import mesh scalp character model skull",
        menu: "File",
        when: always,
        run: |_, out| file(DocumentEvent::Ask(Purpose::Mesh), out),
    },
    Action {
        id: "file.save",
        label: "Save",
        tip: "Writes the groom to its file, whole or not at all.",
        words: "store write keep",
        menu: "File",
        when: always,
        run: |_, out| file(DocumentEvent::Save, out),
    },
    Action {
        id: "file.save_as",
        label: "Save as…",
        tip: "Writes the groom to another file; the meshes that it names stay found.",
        words: "store write copy rename",
        menu: "File",
        when: always,
        run: |_, out| file(DocumentEvent::Ask(Purpose::Save), out),
    },
    Action {
        id: "file.export",
        label: "Export hair…",
        tip: "Writes all hair as .usdc, .usda, .abc or .hair, the same as coif eval does. Editing goes on meanwhile.",
        words: "usd write houdini maya blender unreal curves alembic output",
        menu: "File",
        when: |editor| editor.can_export(),
        run: |_, out| file(DocumentEvent::Ask(Purpose::Export), out),
    },
    Action {
        id: "file.picture",
        label: "Save a picture…",
        tip: "Draws what the viewport looks at as .png or .exr, 1920 x 1080, as coif render does. Editing goes on meanwhile.",
        words: "render image still screenshot png exr",
        menu: "File",
        when: |editor| editor.can_export(),
        run: |_, out| file(DocumentEvent::Ask(Purpose::Picture), out),
    },
    Action {
        id: "file.stop_export",
        label: "Stop the export",
        tip: "Stops the export that goes on; nothing is written.",
        words: "cancel abort",
        menu: "",
        when: |editor| editor.exports(),
        run: |_, out| file(DocumentEvent::StopExport, out),
    },
    Action {
        id: "compare.file",
        label: "Compare with…",
        tip: "Shows another groom (.ron) beside this one, with all that differs.",
        words: "diff difference versions two side by side review",
        menu: "File",
        when: always,
        run: |_, out| file(DocumentEvent::Ask(Purpose::Compare), out),
    },
    Action {
        id: "compare.saved",
        label: "Compare with saved",
        tip: "Shows this groom beside its file as it was saved, with all that changed since.",
        words: "diff difference changes since review",
        menu: "File",
        when: |editor| match editor.state.file.path {
            Some(_) => Ok(()),
            None => Err("this groom has no file yet"),
        },
        run: |_, out| file(DocumentEvent::CompareWithSaved, out),
    },
    Action {
        id: "compare.flip",
        label: "Flip hair",
        tip: "Shows the other groom's hair in the viewport with the same camera, or one's own again.",
        words: "compare toggle swap a b wipe other",
        menu: "View",
        when: compares,
        run: |_, out| file(DocumentEvent::Flip, out),
    },
    Action {
        id: "compare.end",
        label: "End comparing",
        tip: "Shows this groom alone again.",
        words: "diff close stop",
        menu: "File",
        when: compares,
        run: |_, out| file(DocumentEvent::EndCompare, out),
    },
    Action {
        id: "file.close",
        label: "Close the window",
        tip: "Asks once when something is not saved.",
        words: "quit exit end leave",
        menu: "File",
        when: always,
        run: |_, out| file(DocumentEvent::Close, out),
    },
];
