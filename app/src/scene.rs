//! What stands before the camera, for pictures of the command line and of the viewport alike: heads on their ground, and
//! hair, or what it follows, in the colours of a view.

use coif_nodes::data::attributes::{Domain, ID, WIDTH};
use coif_nodes::data::curves::{Curves, Tuft};
use coif_nodes::data::scalp::Scalp;
use coif_shaders::surface::{RootGrid, SPREAD, Solid, Tone, ground, head_solid, tubes};
use coif_shaders::view::{Paint, View};
use glam::Vec3;
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

    /// `guides`, `clusters`, or the name of a view.
    fn from_str(text: &str) -> Result<Self, String> {
        Ok(match text {
            "guides" => Self::Guides,
            "clusters" => Self::Clusters,
            view => Self::Hair(view.parse()?),
        })
    }
}

/// Heads, and the ground under them.
pub(crate) fn heads(scalps: &[Arc<Scalp>], tone: Tone) -> Vec<Solid> {
    let mut solids: Vec<Solid> = scalps.iter().map(|scalp| head_solid(scalp, tone)).collect();
    solids.extend(ground(&solids));
    solids
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
}

impl Dressed {
    /// What is drawn of `hair`, or of the curves that it follows.
    ///
    /// # Errors
    /// In one line for a person: when a view cannot be made of these curves.
    pub(crate) fn of(
        show: &Show,
        hair: &Curves,
        followed: &Curves,
        scalp: Option<&Scalp>,
    ) -> Result<Self, String> {
        Ok(match show {
            Show::Hair(view) => Self {
                drawn: hair.clone(),
                paint: view.paint(hair, scalp)?,
                tubes: None,
                roots: RootGrid::of(hair, SPREAD),
            },
            Show::Guides => {
                let drawn = thick(followed);
                let paint = View::Attribute(ID.name.to_owned()).paint(&drawn, scalp)?;
                Self { drawn, paint, tubes: None, roots: None }
            }
            Show::Clusters => Self {
                drawn: Curves::default(),
                paint: Paint::plain(Vec3::ONE),
                tubes: Some(tubes(followed)),
                roots: None,
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
