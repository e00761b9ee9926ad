//! Windows that stand over the rooms, and lists in menus: none covers the menu bar, none is larger than the window.
//!
//! Guarantees: all that a panel or a menu holds can be reached, at any size of the window, by scrolling.

use egui::{
    Context, Id, Popup, Pos2, Rect, Response, ScrollArea, SetOpenCommand, Ui, Vec2, Window,
};
use std::ops::RangeInclusive;

/// Height of a panel's title, and what its frame takes.
const TITLE: f32 = 46.0;
/// Width of a question, in points.
const QUESTION: f32 = 280.0;
/// What frames round a menu take.
const MENU_FRAME: f32 = 24.0;

fn area_id() -> Id {
    Id::new("room for panels")
}

/// Remembers what lies between the menu bar and the status line.
pub(crate) fn keep_room(ctx: &Context, room: Rect) {
    ctx.data_mut(|data| data.insert_temp(area_id(), room));
}

/// What lies between the menu bar and the status line: where panels may stand.
pub(crate) fn room(ctx: &Context) -> Rect {
    let kept = ctx.data(|data| data.get_temp(area_id()));
    kept.unwrap_or_else(|| ctx.content_rect())
}

/// Where a panel stands at first: in the wider room beside the picture, as wide as there is room, within limits, so that it hides as
/// little as can be of what it is about.
pub(crate) fn beside(room: Rect, picture: Option<Rect>, wide: RangeInclusive<f32>) -> Rect {
    let sides = picture.map(|it| (it.left() - room.left(), room.right() - it.right()));
    let (left, right) = sides.unwrap_or((0.0, *wide.end()));
    let width = left.max(right).clamp(*wide.start(), *wide.end()).min(room.width());
    let x = if left > right { room.left() } else { room.right() - width };
    Rect::from_min_size(Pos2::new(x, room.top()), Vec2::new(width, room.height()))
}

/// The id of a panel. Its place and size are remembered for each size of the window, so that they come back after a smaller
/// one, in which they had less room.
pub(crate) fn id(name: &str, ctx: &Context) -> Id {
    let steps = |length: f32| (length / 32.0).round() as i32;
    let room = room(ctx).size();
    Id::new((name, steps(room.x), steps(room.y)))
}

/// A panel over the rooms.
pub(crate) fn window<'a>(
    title: impl Into<egui::WidgetText>,
    name: &str,
    ctx: &Context,
) -> Window<'a> {
    let room = room(ctx);
    Window::new(title.into())
        .id(id(name, ctx))
        .constrain_to(room)
        .default_size([400.0_f32.min(room.width() - 2.0), room.height() - TITLE])
        .max_width((room.width() - 2.0).max(1.0))
        .max_height((room.height() - 2.0).max(1.0))
}

/// What a panel holds, which is made to be `wide` points wide: scrolls where the window is smaller.
pub(crate) fn body<R>(ui: &mut Ui, wide: f32, add: impl FnOnce(&mut Ui) -> R) -> R {
    let room = room(ui.ctx()).size() - Vec2::new(28.0, TITLE);
    let narrow = room.x < wide;
    let area = ScrollArea::new([narrow, true])
        .max_width(room.x.max(24.0))
        .max_height(room.y.max(6.0))
        .min_scrolled_height(6.0)
        .auto_shrink([narrow, true]);
    let add = |ui: &mut Ui| {
        if narrow {
            ui.set_max_width(wide);
        }
        add(ui)
    };
    area.show(ui, add).inner
}

/// Asks a question over the rooms: its text, a button with a tooltip for each answer, and *Cancel*. Gives `None` while it is open;
/// then the index of the answer, or `None` inside if it was cancelled or closed.
pub(crate) fn question(
    title: impl Into<egui::WidgetText>,
    name: &str,
    text: &str,
    answers: &[(&str, &str)],
    ctx: &Context,
) -> Option<Option<usize>> {
    let (mut open, mut answered) = (true, None);
    window(title, name, ctx)
        .open(&mut open)
        .collapsible(false)
        .resizable(false)
        .pivot(egui::Align2::CENTER_CENTER)
        .default_pos(room(ctx).center())
        .show(ctx, |ui| {
            body(ui, QUESTION, |ui| {
                ui.label(text);
                ui.horizontal_wrapped(|ui| {
                    for (number, (label, tip)) in answers.iter().enumerate() {
                        if ui.button(*label).on_hover_text(*tip).clicked() {
                            answered = Some(Some(number));
                        }
                    }
                    if ui.button("Cancel").clicked() {
                        answered = Some(None);
                    }
                });
            });
        });
    if open { answered } else { Some(None) }
}

/// What a menu lists: scrolls where that is more than the window has room for under the menu bar.
pub(crate) fn list<R>(ui: &mut Ui, add: impl FnOnce(&mut Ui) -> R) -> R {
    let room = (ui.ctx().content_rect().bottom() - room(ui.ctx()).top() - MENU_FRAME).max(24.0);
    ui.set_max_height(room);
    let area = ScrollArea::vertical().max_height(room).min_scrolled_height(16.0);
    area.show(ui, add).inner
}

/// A button that opens a menu below it; where there is no room, that is moved up as far as it must be, and never over the menu bar.
pub(crate) fn menu_button(ui: &mut Ui, label: String, add: impl FnOnce(&mut Ui)) -> Response {
    let response = ui.button(label);
    Popup::menu(&response).align_alternatives(&[]).show(|ui| list(ui, add));
    response
}

/// A menu within a menu. Where a window has no room for one beside the other, it opens within: turned up it would cover the menu bar.
pub(crate) fn submenu(
    ui: &mut Ui,
    label: impl Into<String>,
    add: impl FnOnce(&mut Ui),
) -> Response {
    let label = label.into();
    match room(ui.ctx()).height() < ROOM_FOR_TWO {
        true => egui::CollapsingHeader::new(label).show(ui, add).header_response,
        false => ui.menu_button(label, |ui| list(ui, add)).response,
    }
}

/// Windows with less height than this under the menu bar have no room for a menu beside another, points.
const ROOM_FOR_TWO: f32 = 260.0;

/// The menu of a widget that opens at a place, and stays there until something is picked or pressed beside it.
pub(crate) fn menu_at(response: &Response, opens: Option<Pos2>, add: impl FnOnce(&mut Ui)) {
    let kept = response.id.with("menu at");
    let data = |opens: Option<Pos2>| {
        response.ctx.data_mut(|data| {
            if let Some(at) = opens {
                data.insert_temp(kept, at);
            }
            data.get_temp(kept)
        })
    };
    let Some(at) = data(opens) else { return };
    let opens = opens.map(|_| SetOpenCommand::Bool(true));
    // Where there is no room below, it is moved up as far as it must be; turned up it would cover the menu bar.
    let menu = Popup::menu(response).open_memory(opens).at_position(at).align_alternatives(&[]);
    menu.show(|ui| list(ui, add));
}

/// Where the right button was pressed on a widget, and let go.
pub(crate) fn right_click(response: &Response) -> Option<Pos2> {
    response.secondary_clicked().then(|| response.ctx.pointer_latest_pos()).flatten()
}
