//! How hair scatters light: three models of a hair, and the light that many hairs hand on. The Rust here
//! bakes the table that the shaders read ([`ScatterTable`]); the rest is the twin of `hair*.wgsl`, which
//! tests hold them to.

#[cfg(test)]
mod chiang;
#[cfg_attr(not(test), expect(dead_code, reason = "twins of shaders, for tests"))]
mod fibre;
#[cfg(test)]
mod kajiya_kay;
#[cfg_attr(not(test), expect(dead_code, reason = "twins of shaders, for tests"))]
mod karis;
#[cfg(test)]
mod reference;
#[cfg_attr(not(test), expect(dead_code, reason = "twins of shaders, for tests"))]
mod scatter;
#[cfg(test)]
mod tests;

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

/// Twins of the two functions of `hair.wgsl`.
#[cfg(test)]
mod twin {
    use glam::{Vec2, Vec3};

    use super::fibre::{Angles, Hair};
    use super::scatter::Scatter;
    use super::{Model, ScatterTable, chiang, kajiya_kay, karis};

    /// Of one hair alone: f cos(theta_i).
    pub(super) fn single(m: &Hair, of: &Scatter, a: &Angles, xi: f32) -> Vec3 {
        match m.model {
            Model::KajiyaKay => {
                let highlight = kajiya_kay::highlight(m, a);
                kajiya_kay::diffuse(kajiya_kay::colour(of.deep(), of.surface), a)
                    + Vec3::splat(highlight)
            }
            Model::Karis => karis::karis(m, a, of.gains),
            Model::Chiang => chiang::chiang(m, a, (2.0 * xi - 1.0).clamp(-1.0, 1.0)),
        }
    }

    pub(super) fn hair_light(
        m: &Hair,
        table: &ScatterTable,
        light: Vec3,
        viewer: Vec3,
        tangent: Vec3,
        fibres: f32,
        xi: f32,
    ) -> Vec3 {
        let a = Angles::of(light, viewer, tangent);
        let fibres = fibres.max(0.0);
        let of = table.at(m.sigma, a.sin_o);
        let direct = (-fibres).exp();
        if m.model == Model::KajiyaKay {
            let near = 0.5 + 0.5 * a.cos_phi;
            let colour = kajiya_kay::colour(of.deep(), of.surface);
            let behind = Vec3::ONE + colour * (1.6 * near * near * near);
            return of.reaches(fibres) * kajiya_kay::diffuse(colour, &a) * behind
                + Vec3::splat(direct * kajiya_kay::highlight(m, &a));
        }
        let one = if fibres < 9.0 { single(m, &of, &a, xi) } else { Vec3::ZERO };
        one * direct + of.many(&a, fibres)
    }

    pub(super) fn hair_sky(
        m: &Hair,
        table: &ScatterTable,
        sky: &dyn Fn(Vec3, Vec2) -> Vec3,
        viewer: Vec3,
        tangent: Vec3,
        facing: Vec3,
        open: f32,
    ) -> Vec3 {
        let sin_o = tangent.dot(viewer).clamp(-1.0, 1.0);
        let of = table.at(m.sigma, sin_o);
        let across = viewer - tangent * sin_o;
        let near = (across - tangent * sin_o + facing * 1e-4).normalize();
        let far = (facing * 1e-4 - across - tangent * sin_o).normalize();
        let open = open.clamp(1e-4, 1.0);
        let power = of.loss() * 0.75 + Vec3::splat(0.25);
        let reached = super::fibre::exp(power * open.ln());
        let all = sky(facing, Vec2::new(2.0 / 3.0, 0.25));
        let front = sky((near + facing * 0.5 + tangent * 1e-4).normalize(), Vec2::new(0.55, 0.15));
        if m.model == Model::KajiyaKay {
            let c = kajiya_kay::colour(of.deep(), of.surface);
            let highlight = kajiya_kay::HIGHLIGHT * m.specular;
            return reached * (c * all * (1.0 - kajiya_kay::HIGHLIGHT) + front * highlight);
        }
        let rim = sky((far + facing * 0.5 + tangent * 1e-4).normalize(), Vec2::new(0.55, 0.15));
        let inner = of.deep() * all;
        let seen = |d: Vec3| (0.5 + 0.7 * facing.dot(d)).clamp(0.0, 1.0);
        let (b, f) = (seen(near), seen(far));
        let back = of.back + Vec3::splat(0.7 * of.surface * (m.specular - 1.0));
        reached
            * (back.max(Vec3::ZERO) * (front * b + inner * (1.0 - b))
                + of.forward * (rim * f + inner * (1.0 - f)))
    }
}
