//! How hair scatters light: three models of a hair, and the light that many hairs hand on. The Rust here
//! bakes the table that the shaders read ([`ScatterTable`]); the rest is the twin of `hair*.wgsl`, which
//! tests hold them to.

mod chiang;
mod fibre;
mod kajiya_kay;
mod karis;
mod scatter;

pub(crate) use scatter::ScatterTable;

/// How a hair scatters light.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Model {
    /// Kajiya & Kay 1989: a diffuse cylinder and a white highlight.
    KajiyaKay,
    /// Karis 2016: far-field fits of reflection and two transmissions. The one to work with.
    #[default]
    Karis,
    /// Chiang et al. 2016: near field, with a random place across the hair for every sample. For stills.
    Chiang,
}

impl Model {
    /// All models, in the order of their numbers in shaders.
    pub const ALL: [Self; 3] = [Self::KajiyaKay, Self::Karis, Self::Chiang];

    /// The name that commands and documents use.
    pub fn name(self) -> &'static str {
        match self {
            Self::KajiyaKay => "kajiya-kay",
            Self::Karis => "karis",
            Self::Chiang => "chiang",
        }
    }

    /// The model of a name.
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|model| model.name() == name)
    }
}

impl std::fmt::Display for Model {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.pad(self.name())
    }
}

/// No model has this name.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("no hair model is named {0:?}; there are kajiya-kay, karis and chiang")]
pub struct UnknownModel(pub String);

impl std::str::FromStr for Model {
    type Err = UnknownModel;

    fn from_str(name: &str) -> Result<Self, UnknownModel> {
        Self::named(name).ok_or_else(|| UnknownModel(name.to_owned()))
    }
}
