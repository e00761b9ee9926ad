//! Drags that are over before a slow frame has seen them begin: pressed, moved and let go within one frame.
//!
//! Widgets look once a frame, and of such a drag they would see nothing but a click. It is spread over three frames: the press, the
//! way, the release. Guarantees: every event reaches the window, in order; clicks and all else come as they are.

use egui::{Event, PointerButton, Pos2};

/// Farther than this the pointer drags, points: as far as egui takes it for a click.
const CLICK: f32 = 6.0;

/// Events that wait for their frame.
#[derive(Default)]
pub(crate) struct Paced {
    later: Vec<Event>,
    /// The button of a drag whose press was seen already, and whose release is not yet due.
    drags: Option<PointerButton>,
}

impl Paced {
    /// Leaves of the events those that this frame is to see; whether others wait for the next.
    pub(crate) fn frame(&mut self, events: &mut Vec<Event>) -> bool {
        let mut all = std::mem::take(&mut self.later);
        all.append(events);
        self.later = all.split_off(self.due(&all));
        *events = all;
        !self.later.is_empty()
    }

    /// How many of the events this frame is to see.
    fn due(&mut self, all: &[Event]) -> usize {
        let mut press: Option<(PointerButton, Pos2, usize)> = None;
        let mut moved = false;
        for (i, event) in all.iter().enumerate() {
            match event {
                Event::PointerMoved(at) => {
                    moved |= press.is_none_or(|(_, from, _)| from.distance(*at) > CLICK);
                }
                Event::PointerButton { button, pos, pressed: true, .. } if press.is_none() => {
                    (press, moved) = (Some((*button, *pos, i + 1)), false);
                }
                Event::PointerButton { button, pressed: false, .. } => match press {
                    Some((pressed, _, after)) if pressed == *button => {
                        if moved {
                            self.drags = Some(*button);
                            return after;
                        }
                        press = None;
                    }
                    _ if self.drags == Some(*button) => {
                        if moved {
                            return i;
                        }
                        self.drags = None;
                    }
                    _ => {}
                },
                _ => {}
            }
        }
        all.len()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use egui::{Modifiers, Sense, pos2, vec2};
    use egui_kittest::Harness;

    fn button(x: f32, pressed: bool) -> Event {
        let (button, modifiers) = (PointerButton::Primary, Modifiers::NONE);
        Event::PointerButton { pos: pos2(x, 50.0), button, pressed, modifiers }
    }

    fn moved(x: f32) -> Event {
        Event::PointerMoved(pos2(x, 50.0))
    }

    #[track_caller]
    fn check(batch: &[Event], frames: &[usize]) {
        let (mut paced, mut events, mut seen, mut sizes) =
            (Paced::default(), batch.to_vec(), vec![], vec![]);
        loop {
            let more = paced.frame(&mut events);
            sizes.push(events.len());
            seen.append(&mut events);
            if !more {
                break;
            }
        }
        assert_eq!(sizes, frames);
        assert_eq!(seen, batch, "all of them, in order");
    }

    #[test]
    fn a_drag_within_one_frame_takes_three_and_all_else_takes_one() {
        let drag = [moved(10.0), button(10.0, true), moved(30.0), moved(60.0), button(60.0, false)];
        check(&drag, &[2, 2, 1]);
        check(&[&drag[..], &drag[..]].concat(), &[2, 2, 3, 2, 1]);
        check(&[moved(10.0), button(10.0, true), moved(12.0), button(12.0, false)], &[4]);
        check(&drag[..4], &[4]);
        check(&drag[2..], &[3]);
    }

    #[test]
    fn what_is_dragged_within_one_slow_frame_has_moved() {
        let batch =
            [moved(10.0), button(10.0, true), moved(30.0), moved(60.0), button(60.0, false)];
        let dragged = |mut paced: Option<Paced>| {
            let mut hands = Harness::builder().with_size(vec2(200.0, 100.0)).build_ui_state(
                |ui, (way, ends): &mut (f32, u32)| {
                    let rect = ui.max_rect();
                    let response = ui.interact(rect, ui.id().with("area"), Sense::drag());
                    *way += response.drag_delta().x;
                    *ends += u32::from(response.drag_stopped());
                },
                (0.0, 0),
            );
            hands.run_steps(2);
            let mut events = batch.to_vec();
            for _ in 0..4 {
                if let Some(paced) = &mut paced {
                    paced.frame(&mut events);
                }
                hands.input_mut().events.append(&mut events);
                hands.step();
            }
            *hands.state()
        };
        assert_eq!(dragged(None).0, 0.0, "egui by itself sees a click");
        assert_eq!(dragged(Some(Paced::default())), (50.0, 1));
    }
}
