//! What stands before the camera, for pictures of the command line and of the viewport alike: heads on their ground, and
//! hair, or what it follows, in the colours of a view.

pub(crate) mod heat;
pub mod lights;
pub(crate) mod looks;

use coif_nodes::data::attributes::{Domain, ID, WIDTH};
use coif_nodes::data::curves::{Curves, Tuft};
use coif_nodes::data::scalp::Scalp;
use coif_shaders::surface::{RootGrid, SPREAD, Solid, Tone, ground, head_solid, tubes};
use coif_shaders::view::{Paint, View};
use glam::Vec3;
use looks::FileLooks;
use std::str::FromStr;
use std::sync::Arc;

/// How thick guides are drawn, cm: thin against a lock, thick against a pixel.
const GUIDE_WIDTH: f32 = 0.06;

/// What is drawn.
#[derive(Clone, Debug, PartialEq)]
pub enum Show {
    /// Hair, in the colours of a view.
    Hair(View),
    /// The curves that hair follows, as lines.
    Guides,
    /// The same as tubes.
    Clusters,
}

impl FromStr for Show {
    type Err = String;

    /// A name of [`SHOWS`], or what else a view can be called.
    fn from_str(text: &str) -> Result<Self, String> {
        let followed =
            SHOWS.iter().find(|mode| mode.name == text).and_then(|mode| mode.followed.clone());
        followed.map_or_else(|| text.parse().map(Self::Hair), Ok)
    }
}

/// A way to show hair that needs no attribute.
pub struct Mode {
    /// Its word, on the command line and in settings.
    pub name: &'static str,
    /// What menus say.
    pub label: &'static str,
    /// What is shown instead of hair; none where the name is a view's of all hair.
    followed: Option<Show>,
}

impl Mode {
    /// Whether it shows hair itself, and not what that follows.
    #[cfg(feature = "editor")]
    pub(crate) fn is_of_hair(&self) -> bool {
        self.followed.is_none()
    }
}

const fn hair(name: &'static str, label: &'static str) -> Mode {
    Mode { name, label, followed: None }
}
const fn followed(name: &'static str, label: &'static str, show: Show) -> Mode {
    Mode { name, label, followed: Some(show) }
}

/// What can be shown without attributes, in the order of menus. The first is what is shown at first.
pub const SHOWS: &[Mode] = &[
    hair("hair", "Hair"),
    hair("groom", "Groom, grey"),
    hair("cluster", "Groom by curve"),
    hair("braid", "Groom by braid"),
    hair("strand", "Groom by strand of the braid"),
    hair("section", "Groom by section"),
    followed("guides", "Guides", Show::Guides),
    followed("clusters", "Clusters as tubes", Show::Clusters),
    hair("length", "Length"),
    hair("curvature", "Curvature"),
    hair("density", "Density"),
    hair("cvs", "Points a curve"),
    hair("penetration", "Depth under the skin"),
    hair("parting", "Distance from the parting"),
    hair("width", "Width"),
    hair("u", "Place along the curve"),
    hair("tangent", "Direction"),
];

/// What menus say of something that is shown.
#[cfg(feature = "editor")]
pub(crate) fn label_of(show: &str) -> &str {
    SHOWS.iter().find(|mode| mode.name == show).map_or(show, |mode| mode.label)
}

/// What colours heads.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Skin {
    /// The colours and maps of its file where that has a colour map, else a skin tone.
    #[default]
    Auto,
    /// Whatever its file says; a skin tone where that is nothing.
    File,
    /// A skin tone.
    Tone(Tone),
}

impl Skin {
    /// The tone of what has no looks of its own.
    pub fn tone(self) -> Tone {
        match self {
            Self::Tone(tone) => tone,
            Self::Auto | Self::File => Tone::Monk(5),
        }
    }
}

impl FromStr for Skin {
    type Err = String;

    /// `auto`, `file`, `clay` (or 0), or a tone from 1 to 10.
    fn from_str(text: &str) -> Result<Self, String> {
        match (text, text.parse::<u8>()) {
            ("auto", _) => Ok(Self::Auto),
            ("file", _) => Ok(Self::File),
            ("clay" | "0", _) => Ok(Self::Tone(Tone::Clay)),
            (_, Ok(tone @ 1..=10)) => Ok(Self::Tone(Tone::Monk(tone))),
            _ => Err(format!("{text}: is not one of auto, file, 1 (lightest) to 10, clay")),
        }
    }
}

impl std::fmt::Display for Skin {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Auto => f.write_str("auto"),
            Self::File => f.write_str("file"),
            Self::Tone(Tone::Clay) => f.write_str("clay"),
            Self::Tone(Tone::Monk(tone)) => tone.fmt(f),
        }
    }
}

/// Heads with the looks of their files where these are given, then what was left out of them and is still seen; and what cannot be
/// shown.
pub(crate) fn heads(
    scalps: &[Arc<Scalp>],
    skin: Skin,
    looks: &[Option<Arc<FileLooks>>],
) -> (Vec<Solid>, Vec<String>) {
    let (mut solids, mut asides, mut remarks) = (vec![], vec![], vec![]);
    for (number, scalp) in scalps.iter().enumerate() {
        let drawn = |scalp: &Scalp| match looks.get(number).and_then(Option::as_ref) {
            Some(looks) => looks.head(scalp, skin),
            None => (head_solid(scalp, skin.tone()), vec![]),
        };
        let (head, told) = drawn(scalp);
        solids.push(head);
        remarks.extend(told);
        asides.extend(scalp.aside().map(|aside| drawn(aside).0));
    }
    solids.extend(asides);
    (solids, remarks)
}

/// Hair, or what it follows, as it is drawn.
pub(crate) struct Dressed {
    /// Curves that are drawn as strands.
    pub(crate) drawn: Curves,
    /// Their colours.
    pub(crate) paint: Paint,
    /// Curves that are drawn as tubes.
    pub(crate) tubes: Option<Solid>,
    /// Where hair darkens the skin.
    pub(crate) roots: Option<RootGrid>,
    /// How many strands of the final hair each that is drawn stands for.
    pub(crate) stands_for: f32,
}

impl Dressed {
    /// The ground under heads and all that is drawn; none without heads.
    pub(crate) fn ground(&self, heads: &[Solid]) -> Option<Solid> {
        let hair = self.drawn.tufts().iter().flat_map(|tuft| tuft.points());
        let tubes = self.tubes.iter().flat_map(|tubes| &tubes.points);
        let heights = hair.chain(tubes).map(|p| p.y).filter(|y| y.is_finite());
        ground(heads, heights.fold(f32::INFINITY, f32::min))
    }

    /// What is drawn of `hair`, each strand of which stands for so many of the final hair, or of the curves that it follows.
    ///
    /// # Errors
    /// In one line for a person: when a view cannot be made of these curves.
    pub(crate) fn of(
        show: &Show,
        (hair, stands_for): (&Curves, f32),
        followed: &Curves,
        scalp: Option<&Scalp>,
    ) -> Result<Self, String> {
        Ok(match show {
            Show::Hair(view) => Self {
                drawn: hair.clone(),
                paint: view.paint(hair, scalp)?,
                tubes: None,
                roots: RootGrid::of(hair, SPREAD, stands_for),
                stands_for,
            },
            Show::Guides => {
                let drawn = thick(followed);
                let paint = View::Attribute(ID.name.to_owned()).paint(&drawn, scalp)?;
                Self { drawn, paint, tubes: None, roots: None, stands_for: 1.0 }
            }
            Show::Clusters => Self {
                drawn: Curves::default(),
                paint: Paint::plain(Vec3::ONE),
                tubes: Some(tubes(followed)),
                roots: None,
                stands_for: 1.0,
            },
        })
    }
}

/// The same curves, thick enough to be seen one by one.
fn thick(curves: &Curves) -> Curves {
    let thick = |tuft: &Arc<Tuft>| {
        let mut edited = tuft.edit();
        edited.set(WIDTH, Domain::Curve, vec![GUIDE_WIDTH]);
        Arc::new(edited.build())
    };
    Curves::new(curves.tufts().iter().map(thick).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use coif_shaders::view::NAMES;

    #[test]
    fn the_ground_lies_under_all_that_is_drawn() {
        use coif_nodes::data::attributes::{Domain, ID};
        use coif_nodes::data::curves::TuftBuilder;
        use coif_nodes::data::scalp::{HeadFrame, REGION};
        use coif_nodes::maths::closest::Surface;
        let hanging = |from: f32, to: f32| {
            let mut tuft = TuftBuilder::new();
            tuft.push_curve(&[from, 0.5 * (from + to), to].map(|y| Vec3::new(9.0, y, 0.0)));
            tuft.set(ID, Domain::Curve, vec![1]);
            Curves::new(vec![Arc::new(tuft.build())])
        };
        let bust = coif_nodes::scalp::bust::adult();
        let masks = [(REGION.to_owned(), vec![1.0; bust.points.len()])];
        let surface = Surface::new(bust.points, bust.triangles);
        let scalp = Scalp::new(surface, None, HeadFrame::IDENTITY, masks.into());
        let head = head_solid(&scalp, Tone::Monk(5));
        let lowest = head.points.iter().fold(f32::MAX, |low, p| low.min(p.y));
        let height = |show: &Show, hair: &Curves, heads: &[Solid]| {
            let dressed = Dressed::of(show, (hair, 1.0), hair, None).expect("hair");
            dressed.ground(heads).map(|ground| ground.points[0].y)
        };
        let hair = Show::Hair(View::Hair);
        for (show, to, at) in [
            (&hair, lowest + 1.0, lowest..=lowest),
            (&hair, lowest - 40.0, lowest - 42.0..=lowest - 40.0),
            (&Show::Guides, lowest - 40.0, lowest - 42.0..=lowest - 40.0),
            (&Show::Clusters, lowest - 40.0, lowest - 43.0..=lowest - 40.0),
        ] {
            let found = height(show, &hanging(0.0, to), std::slice::from_ref(&head));
            assert!(found.is_some_and(|y| at.contains(&y)), "{show:?} {to}: {found:?}");
        }
        assert_eq!(height(&hair, &hanging(0.0, -40.0), &[]), None);
    }

    #[test]
    fn eyes_that_are_left_out_are_still_drawn() {
        use coif_nodes::define::Value;
        use coif_nodes::eval::{EvalCx, Log, PlainHost, Quality};
        use coif_nodes::maths::hash::Key;
        let head = |left_out: &str| {
            let def = coif_nodes::by_id("head").expect("a kind");
            let given = |name: &str| match name {
                "leave_out" => vec![Value::Text(left_out.into())],
                _ => vec![],
            };
            let values: Vec<Vec<Value>> = def.inputs.iter().map(|i| given(i.name)).collect();
            let (host, log) = (PlainHost, Log::default());
            let cx = EvalCx::new(0, Quality::Final, Key(1), &host, &log);
            let out = (def.run)(&cx, &values).expect("a head");
            let Some(Value::Scalp(scalp)) = out.into_iter().next() else { panic!("a scalp") };
            scalp
        };
        let count = |scalp: Arc<Scalp>| {
            let (solids, _) = heads(&[scalp], Skin::Tone(Tone::Clay), &[]);
            solids.iter().map(|solid| solid.triangles.len()).sum::<usize>()
        };
        assert_eq!(count(head("eyes, iris")), count(head("")));
    }

    #[test]
    fn every_view_of_hair_is_in_the_table_and_nothing_in_it_is_an_attribute() {
        let of_hair = SHOWS.iter().filter(|mode| mode.followed.is_none()).map(|mode| mode.name);
        assert_eq!(of_hair.collect::<Vec<_>>(), NAMES);
        for mode in SHOWS {
            let show: Show = mode.name.parse().expect("a view");
            assert!(!matches!(show, Show::Hair(View::Attribute(_))), "{}", mode.name);
            assert_eq!(
                mode.followed.as_ref().is_some_and(|followed| *followed == show),
                mode.followed.is_some()
            );
        }
    }
}
