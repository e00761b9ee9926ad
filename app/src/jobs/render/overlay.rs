//! What is drawn as heat on the heads of a picture.
//!
//! Guarantees: a mask that no head has is refused with the names of those that there are.

use crate::jobs::evaluate::Evaluated;
use crate::jobs::stop::Stop;
use crate::scene::heat::{self, HeatSource};
use coif_graphs::document::{Document, Socket};
use coif_nodes::data::field::Field;
use coif_nodes::data::scalp::Scalp;
use coif_nodes::define::{Type, Value};
use coif_shaders::surface::{Solid, Tone};
use std::str::FromStr;
use std::sync::Arc;

/// What is drawn as heat.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum HeatOverlay {
    /// Where hair grows: on each head, or on the scalp that a node gives.
    Region(Option<String>),
    /// A mask: of the head, a section, or what the node of this name paints.
    Mask(String),
}

impl FromStr for HeatOverlay {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text.split_once('=') {
            None if text == "region" => Ok(Self::Region(None)),
            Some(("region", node)) if !node.is_empty() => Ok(Self::Region(Some(node.to_owned()))),
            Some(("mask", name)) if !name.is_empty() => Ok(Self::Mask(name.to_owned())),
            _ => Err(format!("{text}: is not one of region, region=NODE, mask=NAME")),
        }
    }
}

impl HeatOverlay {
    /// The output to evaluate for it; `None` if the head is enough.
    pub(super) fn socket(&self, document: &Document) -> Result<Option<Socket>, Stop> {
        let (name, ty) = match self {
            Self::Region(None) => return Ok(None),
            Self::Region(Some(node)) => (node, Type::Scalp),
            Self::Mask(name) => (name, Type::Field),
        };
        let found = document.nodes.keys().find(|id| id.as_str() == name).and_then(|id| {
            let def = document.def(id)?;
            let output = def.outputs.iter().find(|output| output.ty == ty)?;
            Some(Socket::new(id.clone(), output.name))
        });
        match (self, found) {
            (Self::Region(_), None) => Err(Stop::refused(format!(
                "--overlay region={name}: no node of this name gives a scalp"
            ))),
            (_, found) => Ok(found),
        }
    }

    /// Heat on each head that has it, given what the output was evaluated to.
    pub(super) fn solids(
        &self,
        evaluated: &Evaluated,
        value: Option<&Value>,
        tone: Tone,
    ) -> Result<Vec<Solid>, Stop> {
        let on = |scalp: &Arc<Scalp>, heat: HeatSource| heat::solid(scalp, &heat, tone);
        let heads = evaluated.scalps.iter();
        let all: Vec<Result<Solid, String>> = match (self, value) {
            (Self::Region(_), Some(Value::Scalp(scalp))) => vec![on(scalp, HeatSource::Region)],
            (Self::Region(_), _) => heads.map(|scalp| on(scalp, HeatSource::Region)).collect(),
            (Self::Mask(_), Some(Value::Field(field))) => {
                heads.map(|scalp| on(scalp, HeatSource::Mask(field))).collect()
            }
            (Self::Mask(name), _) => {
                let field = Field::Mask(name.clone());
                // A parted head has its sections and the masks of the head.
                let parted = evaluated.parted.iter().rev();
                let all: Vec<_> =
                    parted.chain(heads).map(|s| on(s, HeatSource::Mask(&field))).collect();
                match all.iter().position(Result::is_ok) {
                    Some(first) => all.into_iter().skip(first).take(1).collect(),
                    None => all,
                }
            }
        };
        let all: Result<Vec<Solid>, String> = all.into_iter().collect();
        all.map_err(|fault| Stop::failed(format!("--overlay: {fault}")))
    }
}
