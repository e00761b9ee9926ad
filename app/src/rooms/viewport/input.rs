//! Which buttons and keys move the eye.

use super::navigation::Motion;
use crate::core::settings::Navigation;
use egui::{Modifiers, PointerButton};

/// What a drag with this button does to the view; none where it is no drag of the view. Space counts as Alt, for desktops
/// that take Alt and for pens. Shift and Ctrl let one button do all three.
pub fn motion(
    preset: Navigation,
    trackball: bool,
    button: PointerButton,
    keys: Modifiers,
    space: bool,
) -> Option<Motion> {
    use PointerButton::{Middle, Primary, Secondary};
    let turn = if trackball { Motion::Trackball } else { Motion::Orbit };
    let by_keys = match (keys.shift, keys.ctrl || keys.command) {
        (true, false) => Motion::Pan,
        (false, true) => Motion::Dolly,
        _ => turn,
    };
    let held = space || (keys.alt && preset == Navigation::Maya);
    match (preset, button) {
        (_, Primary) if held => Some(by_keys),
        (_, Middle) if held => Some(Motion::Pan),
        (_, Secondary) if held => Some(Motion::Dolly),
        (Navigation::Blender, Middle) => Some(by_keys),
        _ => None,
    }
}

/// Whether a drag with this button turns the light.
pub fn turns_light(button: PointerButton, keys: Modifiers, space: bool) -> bool {
    let others = keys.alt || keys.ctrl || keys.command || space;
    button == PointerButton::Secondary && keys.shift && !others
}

/// What drags do over the picture, for people: each with its buttons and keys.
pub(crate) fn drags(preset: Navigation) -> Vec<(&'static str, &'static str)> {
    let (orbit, pan, dolly) = match preset {
        Navigation::Maya => ("Alt+left", "Alt+middle", "Alt+right"),
        Navigation::Blender => ("middle", "Shift+middle", "Ctrl+middle"),
    };
    vec![("Orbit", orbit), ("Pan", pan), ("Dolly", dolly), ("Turn the light", LIGHT_DRAG)]
}

/// The drag that turns the light, in words.
pub(super) const LIGHT_DRAG: &str = "Shift+right";

/// What a drag with a pen's barrel button does: turn, with Shift pan, with Ctrl dolly.
pub fn barrel_motion(trackball: bool, keys: Modifiers) -> Motion {
    motion(Navigation::Blender, trackball, PointerButton::Middle, keys, false)
        .unwrap_or(Motion::Orbit)
}

/// How turning a wheel by so many points scales the distance; away from the hand comes closer.
pub fn wheel_factor(points: f32) -> f32 {
    (-points.clamp(-2000.0, 2000.0) * 0.002).exp()
}

#[cfg(test)]
mod tests {
    use super::*;
    use PointerButton::{Middle, Primary, Secondary};

    #[test]
    fn buttons_and_keys_move_the_eye_as_each_preset_says() {
        const NONE: Modifiers = Modifiers::NONE;
        const ALT: Modifiers = Modifiers::ALT;
        const SHIFT: Modifiers = Modifiers::SHIFT;
        const CTRL: Modifiers = Modifiers::CTRL;
        let check = |preset, button, keys, space, expected: Option<Motion>| {
            let found = motion(preset, false, button, keys, space);
            assert_eq!(found, expected, "{preset:?} {button:?} {keys:?} {space}");
        };
        let maya = Navigation::Maya;
        check(maya, Primary, ALT, false, Some(Motion::Orbit));
        check(maya, Middle, ALT, false, Some(Motion::Pan));
        check(maya, Secondary, ALT, false, Some(Motion::Dolly));
        check(maya, Primary, NONE, true, Some(Motion::Orbit));
        check(maya, Middle, NONE, true, Some(Motion::Pan));
        check(maya, Secondary, NONE, true, Some(Motion::Dolly));
        check(maya, Primary, SHIFT, true, Some(Motion::Pan));
        check(maya, Primary, CTRL, true, Some(Motion::Dolly));
        check(maya, Primary, NONE, false, None);
        check(maya, Middle, NONE, false, None);
        check(maya, Secondary, SHIFT, false, None);
        let blender = Navigation::Blender;
        check(blender, Middle, NONE, false, Some(Motion::Orbit));
        check(blender, Middle, SHIFT, false, Some(Motion::Pan));
        check(blender, Middle, CTRL, false, Some(Motion::Dolly));
        check(blender, Primary, ALT, false, None);
        check(blender, Primary, NONE, true, Some(Motion::Orbit));
        for preset in [maya, blender] {
            assert!(turns_light(Secondary, SHIFT, false));
            assert_eq!(motion(preset, false, Secondary, SHIFT, false), None, "that is the light's");
        }
        let other = [(Primary, SHIFT, false), (Secondary, NONE, false), (Secondary, SHIFT, true)];
        assert!(!other.into_iter().any(|(button, keys, space)| turns_light(button, keys, space)));
        assert!(!turns_light(Secondary, SHIFT | ALT, false));
        assert_eq!(motion(maya, true, Primary, ALT, false), Some(Motion::Trackball));
        assert_eq!(barrel_motion(false, NONE), Motion::Orbit);
        assert_eq!(barrel_motion(true, NONE), Motion::Trackball);
        assert_eq!(barrel_motion(false, SHIFT), Motion::Pan);
        assert_eq!(barrel_motion(false, CTRL), Motion::Dolly);
    }

    #[test]
    fn a_wheel_turned_back_and_forth_ends_where_it_began() {
        for points in [1.0, 50.0, 300.0, 1e9] {
            let both = wheel_factor(points) * wheel_factor(-points);
            assert!((both - 1.0).abs() < 1e-4 && wheel_factor(points) < 1.0);
        }
    }
}
