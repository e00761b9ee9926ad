//! How the groom is looked at: colours, lights, what is laid over it. Never part of a groom.

use crate::jobs::render::RenderRequest;
use crate::scene::lights::{Lights, Surroundings};
use crate::scene::{Show, Skin};
use coif_graphs::document::SavedLook;
use coif_shaders::surface::Tone;
use coif_shaders::view::View;
use coif_shaders::{Look, Model, Rig, Transform};
use serde::{Deserialize, Serialize};

/// Exposures that can be set, stops around the lights' own.
pub const EXPOSURES: (f32, f32) = (-8.0, 8.0);

/// Skins that are no tone.
pub const SKIN_FILE: u8 = 11;
/// The head's own looks where its file has a colour map.
pub const SKIN_AUTO: u8 = 12;

/// How the groom is looked at. Every field has a default, so that saved ones may lack any.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Options {
    /// What is shown, in the words of `coif render --view`.
    pub show: String,
    /// What the key for the groom display goes to and comes back from.
    pub groom: String,
    /// Name of the lights.
    pub rig: String,
    /// A photographed sphere instead of them, for as long as the window is open.
    #[serde(skip)]
    pub around: Option<Surroundings>,
    /// Degrees that such a sphere is blurred by behind the head.
    pub blur: f32,
    /// Degrees that the light is turned by about the vertical, anticlockwise as seen from above.
    pub turn: f32,
    /// Brighter than the lights' own exposure, stops.
    pub exposure: f32,
    /// How light is made into what the display is sent.
    pub transform: String,
    /// How hair scatters light.
    pub model: String,
    /// Skin of the head, 1 to 10 on the Monk scale; 0 is clay, [`SKIN_FILE`] what the head's file says, and [`SKIN_AUTO`] the same
    /// where that has a colour map.
    pub skin: u8,
    /// Whether the head is drawn.
    pub head: bool,
    /// Share of the strands that is drawn.
    pub share: f32,
    /// How little one sees through hair, 0 to 1.
    pub opacity: f32,
    /// How strongly roots darken the skin, 0 to 1.
    pub scalp_tint: f32,
    /// Guides are drawn over the picture.
    pub guides: bool,
    /// Partings are drawn over the picture.
    pub partings: bool,
    /// Roots are drawn over the picture.
    pub roots: bool,
    /// Handles of the active node are drawn.
    pub handles: bool,
    /// A card tells about the hair under the pointer.
    pub card: bool,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            show: "hair".to_owned(),
            groom: "groom".to_owned(),
            rig: Rig::NAMES[0].to_owned(),
            around: None,
            blur: 0.0,
            turn: 0.0,
            exposure: 0.0,
            transform: Transform::default().name().to_owned(),
            model: Model::default().name().to_owned(),
            skin: SKIN_AUTO,
            head: true,
            share: 1.0,
            opacity: 1.0,
            scalp_tint: Look::default().scalp_tint,
            guides: false,
            partings: false,
            roots: false,
            handles: true,
            card: true,
        }
    }
}

impl Options {
    /// What is shown; hair for words that mean nothing.
    pub fn shown(&self) -> Show {
        self.show.parse().unwrap_or(Show::Hair(View::Hair))
    }
    /// The same as a picture that is asked for.
    pub(crate) fn picture(&self) -> RenderRequest {
        let (show, view) = self.show_and_name();
        RenderRequest {
            show,
            view,
            lights: self.lights(),
            exposure: self.exposure,
            transform: self.transform(),
            look: Look { scalp_tint: Look::default().scalp_tint, ..self.look() },
            skin: self.skin(),
            head: self.head,
            ..RenderRequest::default()
        }
    }
    /// What is shown, and what it is called.
    fn show_and_name(&self) -> (Show, String) {
        match self.show.parse() {
            Ok(show) => (show, self.show.clone()),
            Err(_) => (self.shown(), "hair".to_owned()),
        }
    }
    /// The lights' name as the shaders know it.
    pub fn rig(&self) -> &'static str {
        Rig::NAMES.into_iter().find(|name| *name == self.rig).unwrap_or(Rig::NAMES[0])
    }
    /// What lights the picture.
    pub fn lights(&self) -> Lights {
        let around = self.around.clone().map(|around| (around, self.blur));
        Lights { name: self.rig(), around, turn: self.turn }
    }
    /// Turns the light by so many degrees.
    pub fn turn_light(&mut self, degrees: f32) {
        if degrees.is_finite() {
            self.turn = (self.turn + degrees + 180.0).rem_euclid(360.0) - 180.0;
        }
    }
    /// The display transform.
    pub fn transform(&self) -> Transform {
        Transform::named(&self.transform).unwrap_or_default()
    }
    /// The skin.
    pub fn skin(&self) -> Skin {
        match self.skin {
            SKIN_AUTO => Skin::Auto,
            SKIN_FILE => Skin::File,
            0 => Skin::Tone(Tone::Clay),
            n => Skin::Tone(Tone::Monk(n.min(10))),
        }
    }
    /// How hair is drawn.
    pub fn look(&self) -> Look {
        let within =
            |value: f32, low: f32| if value.is_finite() { value.clamp(low, 1.0) } else { 1.0 };
        Look {
            model: Model::named(&self.model).unwrap_or_default(),
            share: within(self.share, 0.001),
            opacity: within(self.opacity, 0.0),
            scalp_tint: within(self.scalp_tint, 0.0),
            ..Look::default()
        }
    }
    /// Goes to the groom display, or back to hair.
    pub fn toggle_groom(&mut self) {
        let groom = std::mem::replace(&mut self.groom, self.show.clone());
        self.show = groom;
    }
    /// Light and skin, as a groom keeps them.
    pub fn saved(&self) -> SavedLook {
        let (light, skin) = (self.rig().to_owned(), self.skin().to_string());
        // Finer than anybody sees, and short in the file.
        let turn = (self.turn * 10.0).round() / 10.0;
        SavedLook { light, exposure: self.exposure, turn, skin }
    }
    /// Takes the light and skin that a groom keeps, else those of the beginning. What means nothing here is left.
    pub fn take(&mut self, look: Option<&SavedLook>) {
        let first = Self::default();
        let Some(look) = look else {
            (self.rig, self.exposure, self.skin) = (first.rig, first.exposure, first.skin);
            self.turn = first.turn;
            return;
        };
        self.turn = look.turn;
        self.rig = look.light.clone();
        self.exposure = look.exposure.clamp(EXPOSURES.0, EXPOSURES.1);
        let known = look.skin.parse().ok();
        self.skin = known.map_or(first.skin, |skin| match skin {
            Skin::Auto => SKIN_AUTO,
            Skin::File => SKIN_FILE,
            Skin::Tone(Tone::Clay) => 0,
            Skin::Tone(Tone::Monk(n)) => n,
        });
    }
    /// Changes the exposure by so many stops.
    pub fn expose(&mut self, stops: f32) {
        self.exposure = (self.exposure + stops).clamp(EXPOSURES.0, EXPOSURES.1);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::label_of;

    #[test]
    fn what_is_set_at_first_is_among_what_can_be() {
        let options = Options::default();
        assert_eq!(options.shown(), Show::Hair(View::Hair));
        assert_eq!((options.rig(), options.look()), ("studio", Look::default()));
        assert_eq!(label_of("my_attribute"), "my_attribute");
        assert_eq!(label_of(&options.show), "Hair");
    }

    #[test]
    fn every_skin_is_a_word_of_the_command_line() {
        for (skin, word) in
            [(0, "clay"), (1, "1"), (10, "10"), (SKIN_FILE, "file"), (SKIN_AUTO, "auto")]
        {
            let options = Options { skin, ..Options::default() };
            assert_eq!(options.skin().to_string(), word);
            assert_eq!(word.parse(), Ok(options.skin()));
            assert_eq!(options.picture().skin, options.skin());
        }
        assert_eq!(Options::default().skin(), Skin::Auto);
    }

    #[test]
    fn the_groom_display_is_one_key_away_and_back() {
        let mut options = Options { show: "length".to_owned(), ..Options::default() };
        options.toggle_groom();
        assert_eq!(options.show, "groom");
        options.toggle_groom();
        assert_eq!(options.show, "length");
    }

    #[test]
    fn damaged_options_are_within_bounds() {
        let options = Options {
            show: "curvature:x".to_owned(),
            rig: "disco".to_owned(),
            share: f32::NAN,
            opacity: -3.0,
            skin: 200,
            ..Options::default()
        };
        assert_eq!((options.look().share, options.look().opacity), (1.0, 0.0));
        assert_eq!((options.skin(), options.rig()), (Skin::Tone(Tone::Monk(10)), "studio"));
        let read: Options = ron::from_str("(skin: 2)").expect("fields may lack");
        assert_eq!(read, Options { skin: 2, ..Options::default() });
    }

    #[test]
    fn what_a_groom_keeps_comes_back_and_what_means_nothing_here_is_left() {
        let mine = Options {
            rig: "dark-hair".into(),
            exposure: 1.5,
            turn: 40.0,
            skin: 0,
            ..Options::default()
        };
        let mut other = Options { show: "braid".into(), ..Options::default() };
        other.take(Some(&mine.saved()));
        assert_eq!((other.rig(), other.exposure, other.skin), ("dark-hair", 1.5, 0));
        assert_eq!((other.turn, other.picture().lights), (40.0, mine.picture().lights));
        assert_eq!(other.show, "braid");
        let (light, skin) = ("disco".into(), "furry".into());
        let odd = SavedLook { light, exposure: 19.0, turn: 0.0, skin };
        other.take(Some(&odd));
        assert_eq!((other.rig(), other.exposure, other.skin), ("studio", 8.0, SKIN_AUTO));
        other.take(None);
        assert_eq!(other.exposure, 0.0);
    }

    #[test]
    fn light_turns_round_and_round() {
        for (turns, expected) in
            [(&[30.0, 40.0][..], 70.0), (&[170.0, 20.0], -170.0), (&[-190.0], 170.0)]
        {
            let mut options = Options::default();
            turns.iter().for_each(|degrees| options.turn_light(*degrees));
            assert!((options.turn - expected).abs() < 1e-3, "{turns:?}: {}", options.turn);
            assert_eq!(options.saved().fault(), None);
        }
    }
}
