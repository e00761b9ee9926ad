//! How the rooms of the window are docked.

use crate::core::room::Room;
use egui_dock::{DockState, Node, NodeIndex, SurfaceIndex};

/// How rooms are docked on a first start: picture and nodes large, everything else at the right.
pub fn first_layout() -> DockState<Room> {
    let mut dock = DockState::new(vec![Room::Viewport]);
    let surface = dock.main_surface_mut();
    let [left, right] = surface.split_right(
        NodeIndex::root(),
        0.74,
        vec![Room::Inspector, Room::Templates, Room::History],
    );
    surface.split_below(right, 0.62, vec![Room::Outliner]);
    surface.split_below(left, 0.58, vec![Room::Canvas, Room::Spreadsheet, Room::Messages]);
    dock
}

/// Brings a room to the front, opening it where it is closed.
pub fn show(dock: &mut DockState<Room>, room: Room) {
    match dock.find_tab(&room) {
        Some(found) => {
            dock.set_active_tab(found).ok();
        }
        None => match dock.find_tab(&Room::Inspector) {
            // Beside what it is dragged to, not over it.
            Some(at) if room == Room::Templates => {
                dock[SurfaceIndex::main()].set_focused_node(at.node);
                dock[SurfaceIndex::main()].push_to_focused_leaf(room);
            }
            _ => dock[SurfaceIndex::main()].push_to_first_leaf(room),
        },
    }
}

/// How splits share their room, by the number of the node.
pub(super) fn shares(dock: &DockState<Room>) -> Vec<Option<f32>> {
    let share = |node: &Node<Room>| match node {
        Node::Vertical(split) | Node::Horizontal(split) => Some(split.fraction),
        _ => None,
    };
    dock.main_surface().iter().map(share).collect()
}

/// The split whose border hands move.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum SplitGrip {
    None,
    /// Of this number.
    One(usize),
    /// Keys may move any.
    Any,
}

/// How near to a border it can be taken, points.
const REACH: f32 = 6.0;

/// The split whose border the pointer holds, or that keys move.
pub(super) fn held_split(dock: &DockState<Room>, ctx: &egui::Context) -> SplitGrip {
    let id = egui::Id::new("held split");
    let (pressed, held, at) = ctx.input(|input| {
        let pointer = &input.pointer;
        let held = pointer.any_down() || pointer.any_released();
        (pointer.any_pressed(), held, pointer.press_origin().or(pointer.interact_pos()))
    });
    let (Some(at), true) = (at, held) else {
        // Borders take arrow keys once Tab led to them.
        let keys = ctx.memory(|memory| memory.focused().is_some()) && !ctx.text_edit_focused();
        return if keys { SplitGrip::Any } else { SplitGrip::None };
    };
    let is_on = |node: &Node<Room>| match node {
        Node::Vertical(split) => {
            let y = egui::lerp(split.rect.y_range(), split.fraction);
            split.rect.x_range().contains(at.x) && (at.y - y).abs() <= REACH
        }
        Node::Horizontal(split) => {
            let x = egui::lerp(split.rect.x_range(), split.fraction);
            split.rect.y_range().contains(at.y) && (at.x - x).abs() <= REACH
        }
        _ => false,
    };
    if pressed {
        let taken = dock.main_surface().iter().position(is_on);
        ctx.data_mut(|data| data.insert_temp(id, taken));
    }
    let taken = ctx.data(|data| data.get_temp::<Option<usize>>(id)).flatten();
    taken.map_or(SplitGrip::None, SplitGrip::One)
}

/// Gives splits their shares back, but for the one that is held: a window that was small for a while, where no room has
/// what it needs, changes none.
pub(super) fn keep_shares(dock: &mut DockState<Room>, before: &[Option<f32>], held: SplitGrip) {
    let now = shares(dock);
    let same = now.len() == before.len()
        && now.iter().zip(before).all(|(a, b)| a.is_some() == b.is_some());
    // Somebody docked a room elsewhere.
    if !same || held == SplitGrip::Any {
        return;
    }
    for (at, (node, share)) in dock.main_surface_mut().iter_mut().zip(before).enumerate() {
        if let (Node::Vertical(split) | Node::Horizontal(split), Some(share)) = (node, share)
            && held != SplitGrip::One(at)
        {
            split.fraction = *share;
        }
    }
}

/// A layout from text as settings keep it; none when the text is no layout or lacks the viewport.
pub fn read_layout(text: &str) -> Option<DockState<Room>> {
    let dock: DockState<Room> = ron::from_str(text).ok()?;
    let tabs: Vec<Room> = dock.iter_all_tabs().map(|(_, room)| *room).collect();
    let once = tabs.iter().enumerate().all(|(i, room)| !tabs[..i].contains(room));
    (once && tabs.contains(&Room::Viewport)).then_some(dock)
}

/// A layout as text.
pub fn write_layout(dock: &DockState<Room>) -> String {
    ron::to_string(dock).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn layouts_come_back_and_damaged_ones_do_not() {
        let dock = first_layout();
        let text = write_layout(&dock);
        let back = read_layout(&text).expect("what was written reads");
        assert_eq!(write_layout(&back), text);
        for bad in ["", "()", &text.replace("Viewport", "Canvas"), &text[..text.len() / 2]] {
            assert!(read_layout(bad).is_none(), "{bad}");
        }
    }

    #[test]
    fn a_closed_room_opens_again() {
        let mut dock = first_layout();
        let at = dock.find_tab(&Room::Canvas).expect("it is there");
        dock.remove_tab(at);
        show(&mut dock, Room::Canvas);
        assert!(dock.find_tab(&Room::Canvas).is_some());
    }
}
