//! What the documents' room adds to the table of actions.

use crate::core::action::{Action, Can};
use crate::core::documents::{DocumentEvent, Purpose};
use crate::core::event::Event;
use crate::core::shown::Sides;
use crate::core::templates::TemplateEvent;
use crate::editor::Editor;
use crate::editor::actions::{Own, always};
use crate::editor::compare::Compare;

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
        tip: "Start from a shipped groom, an empty head or your own head.",
        words: "template preset welcome start create",
        menu: "File",
        when: always,
        run: |_, out| file(DocumentEvent::Welcome(true), out),
    },
    Action {
        id: "file.empty",
        label: "New empty head",
        tip: "New groom: a head without hair.",
        words: "blank scene create bald",
        menu: "File",
        when: always,
        run: |_, out| file(DocumentEvent::New(None), out),
    },
    Action {
        id: "file.open",
        label: "Open…",
        tip: "Open a groom (.ron).",
        words: "load read file",
        menu: "File",
        when: always,
        run: |_, out| file(DocumentEvent::Ask(Purpose::Open), out),
    },
    Action {
        id: "file.recent",
        label: "Open recent…",
        tip: "Recently opened grooms.",
        words: "last history load",
        menu: "File",
        when: always,
        run: |_, out| file(DocumentEvent::Welcome(true), out),
    },
    Action {
        id: "file.head",
        label: "Own head…",
        tip: "Use a mesh (.obj, .glb, .gltf, .vrm) as the head that hair grows on.",
        words: "import mesh scalp character model skull",
        menu: "File",
        when: always,
        run: |_, out| file(DocumentEvent::Ask(Purpose::Mesh), out),
    },
    Action {
        id: "file.save",
        label: "Save",
        tip: "Save the groom to its file. A failed save leaves the old file as it was.",
        words: "store write keep",
        menu: "File",
        when: always,
        run: |_, out| file(DocumentEvent::Save, out),
    },
    Action {
        id: "file.save_as",
        label: "Save as…",
        tip: "Save the groom to another file. Paths to meshes are adjusted.",
        words: "store write copy rename",
        menu: "File",
        when: always,
        run: |_, out| file(DocumentEvent::Ask(Purpose::Save), out),
    },
    Action {
        id: "template.save",
        label: "Save as template…",
        tip: "Make a template of the selected group or nodes, or of the whole groom: name, inputs, picture, folder.",
        words: "template new preset asset library share export recipe",
        menu: "File",
        when: |editor| match editor.state.document.nodes.is_empty() {
            true => Err("there are no nodes"),
            false => Ok(()),
        },
        run: |_, out| out.push(Event::Templates(TemplateEvent::Save)),
    },
    Action {
        id: "file.export",
        label: "Export hair…",
        tip: "Export hair as .usdc, .usda, .abc or .hair, as coif eval does. You can go on editing.",
        words: "usd write houdini maya blender unreal curves alembic output",
        menu: "File",
        when: |editor| editor.can_export(),
        run: |_, out| file(DocumentEvent::ExportPanel, out),
    },
    Action {
        id: "file.picture",
        label: "Save a picture…",
        tip: "Render a still or a turntable as .png or .exr, as coif render does. You can go on editing.",
        words: "render image still screenshot png exr turntable light sweep",
        menu: "File",
        when: |editor| editor.can_export(),
        run: |_, out| file(DocumentEvent::PicturePanel, out),
    },
    Action {
        id: "file.stop_export",
        label: "Stop the export",
        tip: "Stop what is being written; nothing of it is left. What waits goes on.",
        words: "cancel abort",
        menu: "",
        when: |editor| editor.exports(),
        run: |_, out| file(DocumentEvent::StopExport, out),
    },
    Action {
        id: "compare.file",
        label: "Compare with…",
        tip: "Show another groom (.ron) beside this one, with all differences.",
        words: "diff difference versions two side by side review",
        menu: "File",
        when: always,
        run: |_, out| file(DocumentEvent::Ask(Purpose::Compare), out),
    },
    Action {
        id: "compare.saved",
        label: "Compare with saved",
        tip: "Show this groom beside its saved file, with all changes since.",
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
        tip: "Switch the viewport between the other groom's hair and yours, with the same camera.",
        words: "compare toggle swap a b other",
        menu: "View",
        when: compares,
        run: |editor, out| {
            let sides = editor.compare().map(Compare::sides).unwrap_or_default();
            file(DocumentEvent::Sides(sides.flipped()), out);
        },
    },
    Action {
        id: "compare.wipe",
        label: "Wipe between both",
        tip: "Show both grooms in one picture, with a divider to drag between them.",
        words: "compare a b split curtain slider before after other",
        menu: "View",
        when: compares,
        run: |_, out| file(DocumentEvent::Sides(Sides::Wipe), out),
    },
    Action {
        id: "compare.beside",
        label: "Both side by side",
        tip: "Show one groom's hair beside the other's, with one camera.",
        words: "compare a b split two pictures next other",
        menu: "View",
        when: compares,
        run: |_, out| file(DocumentEvent::Sides(Sides::Beside), out),
    },
    Action {
        id: "compare.end",
        label: "End comparing",
        tip: "Show this groom alone again.",
        words: "diff close stop",
        menu: "File",
        when: compares,
        run: |_, out| file(DocumentEvent::EndCompare, out),
    },
    Action {
        id: "file.close",
        label: "Close the window",
        tip: "Close the window. Unsaved changes are asked about first.",
        words: "quit exit end leave",
        menu: "File",
        when: always,
        run: |_, out| file(DocumentEvent::Close, out),
    },
];
