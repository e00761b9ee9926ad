//! Small things that every widget of the inspector needs: names for people, text fields, icon buttons.

use egui::{Response, TextEdit, Ui, Vec2};

/// A name of a declaration as people read it: `stitch_spacing` is "Stitch spacing".
pub(crate) fn spoken(name: &str) -> String {
    // Files keep the letters of the method; people read what they do.
    let name = match name {
        "rho" => "touch_radius",
        "tau" => "neighbour_reach",
        name => name,
    };
    let words = name.replace('_', " ");
    let mut letters = words.chars();
    letters.next().map_or(String::new(), |first| first.to_uppercase().chain(letters).collect())
}

/// Gives a widget the name by which screen readers and tests know it.
pub(crate) fn set_name(ui: &Ui, response: &Response, name: &str) {
    ui.ctx().accesskit_node_builder(response.id, |node| node.set_label(name));
}

/// A square button with a sign on it, whose tooltip is its name.
pub(crate) fn icon_button(ui: &mut Ui, sign: &str, name: &str) -> Response {
    let size = ui.spacing().interact_size.y;
    let response = ui.add_sized(
        Vec2::splat(size),
        egui::Button::new(sign).frame_when_inactive(false).min_size(Vec2::splat(size)),
    );
    set_name(ui, &response, name);
    response.on_hover_text(name)
}

/// Text that is taken when the field is left or, where it is one line, Enter is pressed; Escape leaves it as it was.
pub(crate) fn text_field(
    ui: &mut Ui,
    name: &str,
    text: &str,
    hint: &str,
    (width, lines): (f32, usize),
) -> Option<String> {
    // By name and not by order: what appears above, such as a message, must not end the typing.
    let id = ui.id().with(name);
    let mut typed = ui.data(|data| data.get_temp(id)).unwrap_or_else(|| text.to_owned());
    let edit = if lines > 1 {
        TextEdit::multiline(&mut typed).desired_rows(lines)
    } else {
        let height = ui.spacing().interact_size.y;
        TextEdit::singleline(&mut typed).min_size(Vec2::new(0.0, height))
    };
    let width = width.max(20.0);
    let edit = edit.id(id).hint_text(hint).vertical_align(egui::Align::Center);
    let output = edit.desired_width(width).show(ui);
    let response = output.response.response;
    // The press that brings the keyboard here takes all of a line: what is typed replaces it.
    let fresh = id.with("fresh");
    if response.gained_focus() {
        ui.data_mut(|data| data.insert_temp(fresh, true));
    }
    if lines == 1
        && response.clicked()
        && ui.data_mut(|data| data.remove_temp::<bool>(fresh)).unwrap_or(false)
    {
        let mut state = output.state;
        let all = egui::text::CCursorRange::select_all(&output.galley);
        state.cursor.set_char_range(Some(all));
        state.store(ui.ctx(), id);
    }
    // Where it was asked for, as renaming does, the keyboard comes here at once.
    if ui.data_mut(|data| data.remove_temp::<bool>(ui.id().with("focus"))).unwrap_or(false) {
        response.request_focus();
    }
    set_name(ui, &response, name);
    if response.lost_focus() {
        ui.data_mut(|data| data.remove::<String>(id));
        let left = ui.input(|input| input.key_pressed(egui::Key::Escape));
        return (!left && typed != text).then_some(typed);
    }
    if response.has_focus() {
        ui.data_mut(|data| data.insert_temp(id, typed));
    }
    None
}

/// What a declaration says that 0 means, where that is no amount: "0: no limit", "0 takes half the width".
pub(crate) fn zero_words(doc: &str) -> Option<&str> {
    if [" 0 takes ", " 0 finds "].iter().any(|words| doc.contains(words)) {
        return Some("auto");
    }
    let (_, words) = doc.split_once(" 0: ")?;
    let end = words.find(['.', ';', ',']).unwrap_or(words.len());
    let words = &words[..end];
    Some(if words.len() <= 18 { words } else { "auto" })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_spoken_in_sentence_case() {
        assert_eq!(spoken("stitch_spacing"), "Stitch spacing");
        assert_eq!(spoken("b_to_c"), "B to c");
        assert_eq!(spoken(""), "");
    }
}
