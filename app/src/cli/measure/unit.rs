//! The unit that the numbers of a file are taken in which declares none (Alembic), and what told it.
//!
//! Guaranteed: it is what was asked for; else what the head tells, else what the application that wrote the file does, else the
//! centimetre; and the report says which of these it was.

use clap::ValueEnum;
use coif_nodes::define::short;
use coif_nodes::formats::abc::{cm_by_application, cm_by_head};
use coif_nodes::formats::usd::read::ReadCurves;
use coif_nodes::maths::closest::Surface;
use serde::Serialize;

/// A unit that can be asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum LengthUnit {
    Mm,
    Cm,
    In,
    Ft,
    M,
}

impl LengthUnit {
    fn cm(self) -> f32 {
        match self {
            Self::Mm => 0.1,
            Self::Cm => 1.0,
            Self::In => 2.54,
            Self::Ft => 30.48,
            Self::M => 100.0,
        }
    }
}

/// What told a unit.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub(super) enum By {
    Option,
    Head,
    Application,
    Nothing,
}

/// The unit that was taken.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(super) struct TakenUnit {
    pub(super) cm: f32,
    pub(super) by: By,
    /// What the file says of who wrote it.
    pub(super) application: String,
}

impl TakenUnit {
    pub(super) fn of(
        asked: Option<LengthUnit>,
        curves: &[ReadCurves],
        head: Option<&Surface>,
        application: String,
    ) -> Self {
        let by_head = || cm_by_head(curves, head?).map(|cm| (cm, By::Head));
        let by_application = || cm_by_application(&application).map(|cm| (cm, By::Application));
        let taken = asked.map(|unit| (unit.cm(), By::Option));
        let taken = taken.or_else(by_head).or_else(by_application);
        let (cm, by) = taken.unwrap_or((1.0, By::Nothing));
        Self { cm, by, application }
    }

    pub(super) fn in_words(&self) -> String {
        let unit = match self.cm {
            0.1 => "millimetres".to_owned(),
            1.0 => "centimetres".to_owned(),
            2.54 => "inches".to_owned(),
            10.0 => "decimetres".to_owned(),
            30.48 => "feet".to_owned(),
            100.0 => "metres".to_owned(),
            cm => format!("{cm} cm"),
        };
        let why = match self.by {
            By::Option => return format!("unit: {unit}, as --unit says"),
            By::Head => "in which the roots lie on the head".to_owned(),
            By::Application => format!("as {} writes", short(&self.application)),
            By::Nothing => {
                return "unit: not declared (Alembic has none), and nothing tells it: centimetres are taken. Give --unit, or the \
                        head with --scalp"
                    .to_owned();
            }
        };
        format!(
            "unit: not declared (Alembic has none); {unit} are taken, {why}. --unit sets another"
        )
    }
}
