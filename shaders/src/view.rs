//! What a picture of hair shows: the hair itself, the groom in plain colours, or any number of it as a heat map.
//!
//! The shader knows two shadings only ([`Shading`]); a view is a function from a tuft to one word a point ([`Paint`]). So
//! every attribute can be seen, and none costs the shader anything.
//!
//! Guarantees: the same curves give the same words everywhere; degenerate curves (no length, one point, attributes
//! missing) have a colour too; a paint's key changes with all that its words depend on besides the tuft itself.
//! Not promised: that a paint made for some curves knows others. Tufts it has not seen are grey where the number
//! needs the whole groom (density, penetration, parting).

mod colour;
mod measure;

pub use colour::Ramp;
pub use colour::swatch;
pub(crate) use colour::{of_id, over};

use coif_nodes::data::attributes::{
    BRAID, COLOUR, Column, Domain, GROUP, PARENT, SECTION, STRAND, WIDTH, unit_of,
};
use coif_nodes::data::curves::{AttributeView, Curves, Tuft};
use coif_nodes::data::scalp::Scalp;
use coif_nodes::maths::hair_colour::absorption_of;
use coif_nodes::maths::hash::{KeyBuilder, mix};
use glam::{Vec2, Vec3};
use std::str::FromStr;
use std::sync::Arc;

/// How the shader takes a point's word.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Shading {
    /// Roots of the absorption per fibre radius, 11, 11 and 10 bits over 0 to 4.5: hair as it scatters light.
    Hair,
    /// Roots of a linear Rec.709 colour, 8, 8 and 8 bits: plain strands under the same light and shadow.
    Colour,
}

/// What the colours of a heat map mean.
#[derive(Clone, Debug, PartialEq)]
pub struct Legend {
    /// What is measured.
    pub name: String,
    /// Its unit; empty for plain numbers.
    pub unit: String,
    /// The number at the ramp's start.
    pub lowest: f32,
    /// The number at the ramp's end.
    pub highest: f32,
    /// The colours between.
    pub ramp: Ramp,
    /// Numbers above this have a loud colour of their own.
    pub limit: Option<f32>,
}

/// One word a point: what a view makes of tufts.
pub struct Paint {
    /// How the words are read.
    pub shading: Shading,
    /// Changes when the words of any tuft do.
    pub key: u64,
    /// What the colours mean, for heat maps.
    pub legend: Option<Legend>,
    of: Box<dyn Fn(&Tuft) -> Vec<u32> + Send + Sync>,
}

impl Paint {
    /// Hair as it is: what the attribute `colour` absorbs.
    pub fn hair() -> Self {
        Self {
            shading: Shading::Hair,
            key: KeyBuilder::new("paint hair").finish().0 as u64,
            legend: None,
            of: Box::new(|tuft| {
                let word = |c| colour::pack_absorption(absorption_of(c));
                words(tuft, &tuft.view(COLOUR), word)
            }),
        }
    }

    /// All in one linear colour: guides over a picture.
    pub fn plain(shade: Vec3) -> Self {
        let word = colour::pack_colour(shade);
        Self::colours("plain", u64::from(word), move |tuft| vec![word; tuft.points().len()])
    }

    /// The words of a tuft: as many as it has points.
    pub fn of(&self, tuft: &Tuft) -> Vec<u32> {
        (self.of)(tuft)
    }

    fn colours(
        name: &str,
        depends: u64,
        of: impl Fn(&Tuft) -> Vec<u32> + Send + Sync + 'static,
    ) -> Self {
        Self {
            shading: Shading::Colour,
            key: KeyBuilder::new("paint").text(name).int(depends).finish().0 as u64,
            legend: None,
            of: Box::new(of),
        }
    }
}

impl std::fmt::Debug for Paint {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "Paint({:?}, {:x})", self.shading, self.key)
    }
}

/// Colours of the groom display, which is what one edits in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum GroomColours {
    /// Mid-grey.
    Plain,
    /// By the curve that hair was made from; curves made from none by themselves.
    Cluster,
    /// By braid; hair of none is grey.
    Braid,
    /// By strand of the braid; hair of no braid is grey.
    Strand,
    /// By the section between partings that it is rooted in; without partings by group within its braid or parent, such as the
    /// hairs of a stitch.
    Section,
}

/// What Unreal Engine's importer takes on one curve.
pub const UNREAL_POINTS: u32 = 255;

/// What to show.
#[derive(Clone, Debug, PartialEq)]
pub enum View {
    /// Hair as it is.
    Hair,
    /// Plain colours.
    Groom(GroomColours),
    /// Arc length of the curve, cm.
    Length,
    /// Curvature, 1/cm.
    Curvature,
    /// Hairs that cross a square centimetre laid across them, 1/cm2.
    Density,
    /// Points of the curve; more than the limit is loud.
    Cvs(u32),
    /// How deep a point lies under the skin, cm; grey outside.
    Penetration,
    /// Distance of the root from the nearest parting, cm: the border to hair of another braid, or of another parent
    /// where there are no braids.
    Parting,
    /// Diameter, cm.
    Width,
    /// Fraction of the arc length, 0 at the root.
    Along,
    /// Direction: red, green and blue for x, y and z.
    Tangent,
    /// An attribute of any name: numbers as a heat map, ids each in a colour, vectors as directions, colours as they are.
    Attribute(String),
    /// A heat map from a lowest to a highest number of one's own choice.
    Between(Box<View>, f32, f32),
}

/// Names of all views but attributes', as [`View::from_str`] takes them.
pub const NAMES: [&str; 15] = [
    "hair",
    "groom",
    "cluster",
    "braid",
    "strand",
    "section",
    "length",
    "curvature",
    "density",
    "cvs",
    "penetration",
    "parting",
    "width",
    "u",
    "tangent",
];

impl FromStr for View {
    type Err = String;

    /// One of [`NAMES`], or the name of an attribute; `NAME:LOW..HIGH` sets the range of a heat map, `cvs:N` the limit.
    fn from_str(text: &str) -> Result<Self, String> {
        let (name, range) = match text.split_once(':') {
            Some((name, range)) if range.contains("..") || name == "cvs" => (name, Some(range)),
            _ => (text, None),
        };
        let view = match name {
            "" => return Err("a view has a name".to_owned()),
            "hair" => Self::Hair,
            "groom" => Self::Groom(GroomColours::Plain),
            "cluster" => Self::Groom(GroomColours::Cluster),
            "braid" => Self::Groom(GroomColours::Braid),
            "strand" => Self::Groom(GroomColours::Strand),
            "section" => Self::Groom(GroomColours::Section),
            "length" => Self::Length,
            "curvature" => Self::Curvature,
            "density" => Self::Density,
            "cvs" => Self::Cvs(UNREAL_POINTS),
            "penetration" => Self::Penetration,
            "parting" => Self::Parting,
            "width" => Self::Width,
            "u" => Self::Along,
            "tangent" => Self::Tangent,
            other => Self::Attribute(other.to_owned()),
        };
        let Some(range) = range else { return Ok(view) };
        if let (Self::Cvs(_), Ok(limit)) = (&view, range.parse()) {
            return Ok(Self::Cvs(limit));
        }
        let ends = range.split_once("..").and_then(|(low, high)| {
            let (low, high) = (low.trim().parse::<f32>().ok()?, high.trim().parse::<f32>().ok()?);
            (low.is_finite() && high.is_finite() && low < high).then_some((low, high))
        });
        let Some((low, high)) = ends else {
            return Err(format!("{text:?}: a range is LOW..HIGH, two numbers, the lower first"));
        };
        if !view.may_be_ranged() {
            return Err(format!("{text:?}: {name} has no range"));
        }
        Ok(Self::Between(Box::new(view), low, high))
    }
}

/// A number for each point of a tuft.
type Numbers = Box<dyn Fn(&Tuft) -> Vec<f32> + Send + Sync>;

/// A heat map before its range is known.
struct Heat {
    name: String,
    unit: &'static str,
    ramp: Ramp,
    /// Where the ramp starts whatever the numbers are.
    from: Option<f32>,
    limit: Option<f32>,
    /// Numbers below this are grey and count for no range.
    least: Option<f32>,
    /// The ramp ends no lower than here, so that next to nothing does not look like much.
    to: Option<f32>,
    numbers: Numbers,
    /// Of what else the numbers depend on.
    depends: u64,
}

impl Heat {
    fn new(
        name: &str,
        unit: &'static str,
        numbers: impl Fn(&Tuft) -> Vec<f32> + Send + Sync + 'static,
    ) -> Self {
        Self {
            name: name.to_owned(),
            unit,
            ramp: Ramp::Viridis,
            from: None,
            limit: None,
            least: None,
            to: None,
            numbers: Box::new(numbers),
            depends: 0,
        }
    }

    fn paint(self, curves: &Curves, asked: Option<(f32, f32)>) -> Paint {
        let Self { name, unit, ramp, from, limit, least, to, numbers, depends } = self;
        let (lowest, highest) = asked.unwrap_or_else(|| {
            let (low, high) = robust_range(curves, &numbers, least);
            let low = from.unwrap_or(low);
            (low, limit.unwrap_or(high).max(low).max(to.unwrap_or(low)))
        });
        let table: Vec<u32> =
            (0..256).map(|k| colour::pack_colour(ramp.at(k as f32 / 255.0))).collect();
        let (none, over) = (colour::pack_colour(colour::NONE), colour::pack_colour(over()));
        // All the same is the middle of the ramp.
        let scale = if highest > lowest { 255.0 / (highest - lowest) } else { 0.0 };
        let start = if highest > lowest { 0.5 } else { 128.0 };
        let word = move |x: f32| {
            if !x.is_finite() || least.is_some_and(|least| x < least) {
                none
            } else if limit.is_some_and(|limit| x > limit) {
                over
            } else {
                table[((x - lowest) * scale + start).clamp(0.0, 255.0) as usize]
            }
        };
        let key = KeyBuilder::new("paint numbers")
            .text(&name)
            .float(lowest)
            .float(highest)
            .float(limit.unwrap_or(f32::MAX))
            .int(depends);
        Paint {
            shading: Shading::Colour,
            key: key.finish().0 as u64,
            legend: Some(Legend { name, unit: unit.to_owned(), lowest, highest, ramp, limit }),
            of: Box::new(move |tuft| numbers(tuft).into_iter().map(&word).collect()),
        }
    }
}

impl View {
    fn may_be_ranged(&self) -> bool {
        !matches!(self, Self::Hair | Self::Groom(_) | Self::Tangent | Self::Between(..))
    }

    /// The words of this view for these curves. Heat maps run from the 1st to the 99th percentile of all points where no
    /// range is given.
    ///
    /// # Errors
    /// In one line for a person: an attribute that no curve has, a range for what has none, a view that needs a
    /// scalp without one.
    pub fn paint(&self, curves: &Curves, scalp: Option<&Scalp>) -> Result<Paint, String> {
        match self {
            Self::Between(view, low, high) if view.may_be_ranged() => {
                view.painted(curves, scalp, Some((*low, *high)))
            }
            Self::Between(view, ..) => Err(format!("{view:?} has no range")),
            view => view.painted(curves, scalp, None),
        }
    }

    fn painted(
        &self,
        curves: &Curves,
        scalp: Option<&Scalp>,
        range: Option<(f32, f32)>,
    ) -> Result<Paint, String> {
        let heat = match self {
            Self::Hair => return Ok(Paint::hair()),
            Self::Groom(colours) => return Ok(groom(*colours)),
            Self::Tangent => {
                return Ok(Paint::colours("tangent", 0, |tuft| {
                    let directions = measure::tangents(tuft);
                    directions.map(|d| colour::pack_colour(colour::of_direction(d))).collect()
                }));
            }
            Self::Between(..) => return Err("a range within a range".to_owned()),
            Self::Length => Heat::new("length", "cm", |tuft| each_curve(tuft, measure::length)),
            Self::Curvature => {
                Heat { from: Some(0.0), ..Heat::new("curvature", "1/cm", measure::curvature) }
            }
            Self::Density => {
                let grid = measure::Density::of(curves);
                let numbers =
                    move |tuft: &Tuft| tuft.points().iter().map(|p| grid.at(*p)).collect();
                let heat = Heat::new("density", "hairs/cm2", numbers);
                Heat { from: Some(0.0), depends: curves.key().0 as u64, ..heat }
            }
            Self::Cvs(limit) => {
                let count = |points: &[Vec3]| points.len() as f32;
                let heat = Heat::new("points", "", move |tuft| each_curve(tuft, count));
                Heat { from: Some(0.0), limit: Some(*limit as f32), ..heat }
            }
            Self::Penetration => {
                let Some(scalp) = scalp else {
                    return Err("penetration needs a head, and there is none".to_owned());
                };
                let depths =
                    measure::CachedNumbers::of(curves, |tuft| measure::depths(tuft, scalp));
                let heat =
                    Heat::new("depth under the skin", "cm", move |tuft| depths.of_tuft(tuft));
                let depends = KeyBuilder::new("").key(curves.key()).key(scalp.key()).finish();
                Heat {
                    ramp: Ramp::Alarm,
                    from: Some(0.0),
                    // A hundredth of a millimetre is rounding.
                    least: Some(0.001),
                    to: Some(0.1),
                    depends: depends.0 as u64,
                    ..heat
                }
            }
            Self::Parting => {
                let distances = measure::partings(curves);
                let numbers = move |tuft: &Tuft| distances.of_tuft(tuft);
                let heat = Heat::new("distance from the parting", "cm", numbers);
                Heat { from: Some(0.0), depends: curves.key().0 as u64, ..heat }
            }
            Self::Width => Heat::new("width", "cm", |tuft| words(tuft, &tuft.view(WIDTH), |w| w)),
            Self::Along => Heat { from: Some(0.0), ..Heat::new("u", "", measure::along) },
            Self::Attribute(name) => match attribute(name, curves)? {
                Shown::Heat(heat) => heat,
                Shown::Paint(_) if range.is_some() => {
                    return Err(format!("{name} holds no numbers that could have a range"));
                }
                Shown::Paint(paint) => return Ok(paint),
            },
        };
        Ok(heat.paint(curves, range))
    }
}

/// How an attribute is shown.
enum Shown {
    Heat(Heat),
    Paint(Paint),
}

fn attribute(name: &str, curves: &Curves) -> Result<Shown, String> {
    let Some(found) = curves.tufts().iter().find_map(|tuft| tuft.attribute(name)) else {
        let mut names: Vec<&str> = curves
            .tufts()
            .iter()
            .flat_map(|tuft| tuft.attributes())
            .map(|a| a.name.as_ref())
            .collect();
        names.sort_unstable();
        names.dedup();
        let have = if names.is_empty() {
            "no attributes".to_owned()
        } else {
            format!("the attributes {}", names.join(", "))
        };
        return Err(format!(
            "there is no view and no attribute {name:?}; views are {}; the curves have {have}",
            NAMES.join(", ")
        ));
    };
    let owned = name.to_owned();
    let key = name.to_owned();
    let paint = |of: fn(&Tuft, &str) -> Vec<u32>| {
        Shown::Paint(Paint::colours(&format!("attribute {key}"), 0, move |tuft| of(tuft, &owned)))
    };
    Ok(match found.values {
        Column::F32(_) => {
            let unit = unit_of(name);
            let owned = name.to_owned();
            let numbers = move |tuft: &Tuft| match tuft.view_named::<f32>(&owned) {
                Some(values) => words(tuft, &values, |x| x),
                None => vec![f32::NAN; tuft.points().len()],
            };
            Shown::Heat(Heat::new(name, unit, numbers))
        }
        Column::I32(_) => paint(|tuft, name| {
            shown(
                tuft,
                name,
                |x: i32| if x < 0 { colour::NONE } else { colour::of_number(x.into()) },
            )
        }),
        Column::U64(_) => paint(|tuft, name| shown(tuft, name, of_id)),
        Column::Vec2(_) => paint(|tuft, name| {
            shown(tuft, name, |v: Vec2| {
                let part = |x: f32| if x.is_finite() { x - x.floor() } else { 0.0 };
                Vec3::new(part(v.x), part(v.y), 0.2)
            })
        }),
        Column::Vec3(_) if name.contains("colour") || name.contains("color") => {
            paint(|tuft, name| shown(tuft, name, |c: Vec3| c))
        }
        Column::Vec3(_) => paint(|tuft, name| shown(tuft, name, colour::of_direction)),
    })
}

/// Words of an attribute whose values have colours; grey where the tuft has none of this type.
fn shown<T: coif_nodes::data::attributes::Item>(
    tuft: &Tuft,
    name: &str,
    of: impl Fn(T) -> Vec3,
) -> Vec<u32> {
    match tuft.view_named::<T>(name) {
        Some(values) => words(tuft, &values, |v| colour::pack_colour(of(v))),
        None => vec![colour::pack_colour(colour::NONE); tuft.points().len()],
    }
}

/// One result a point from an attribute, whatever its domain; what is repeated is worked out once.
fn words<T: Copy + PartialEq, R: Copy>(
    tuft: &Tuft,
    values: &AttributeView<'_, T>,
    of: impl Fn(T) -> R,
) -> Vec<R> {
    match values {
        AttributeView::Shared(value) => vec![of(*value); tuft.points().len()],
        AttributeView::Curve(values) => {
            let mut out = Vec::with_capacity(tuft.points().len());
            for (i, value) in values.iter().enumerate() {
                let word = of(*value);
                out.extend(std::iter::repeat_n(word, tuft.range(i).len()));
            }
            out
        }
        AttributeView::Point(values) => {
            // Curves of one tuft often have the same colours from root to tip.
            let first: Vec<(T, R)> = tuft.range(0).map(|k| (values[k], of(values[k]))).collect();
            let mut out = Vec::with_capacity(values.len());
            for i in 0..tuft.len() {
                for (j, k) in tuft.range(i).enumerate() {
                    out.push(match first.get(j) {
                        Some((same, word)) if *same == values[k] => *word,
                        _ => of(values[k]),
                    });
                }
            }
            out
        }
    }
}

/// One number a curve, repeated for its points.
fn each_curve(tuft: &Tuft, of: impl Fn(&[Vec3]) -> f32) -> Vec<f32> {
    let mut out = Vec::with_capacity(tuft.points().len());
    for i in 0..tuft.len() {
        out.extend(std::iter::repeat_n(of(tuft.curve(i)), tuft.range(i).len()));
    }
    out
}

fn groom(colours: GroomColours) -> Paint {
    let of: fn(&Tuft, usize) -> Vec3 = match colours {
        GroomColours::Plain => return Paint::plain(Vec3::splat(0.3)),
        GroomColours::Cluster => |tuft, i| {
            let parent = tuft.view(PARENT).at(i, tuft.range(i).start);
            of_id(if parent == 0 { tuft.id(i) } else { parent })
        },
        GroomColours::Braid => |tuft, i| of_id(tuft.view(BRAID).at(i, tuft.range(i).start)),
        GroomColours::Strand => |tuft, i| {
            let at = tuft.range(i).start;
            if tuft.view(BRAID).at(i, at) == 0 {
                return colour::NONE;
            }
            colour::of_number(tuft.view(STRAND).at(i, at).into())
        },
        GroomColours::Section => |tuft, i| {
            let at = tuft.range(i).start;
            // Sections of partings, where there are any; else the rows of a partition.
            let section = tuft.view(SECTION).at(i, at);
            if section != 0 {
                return of_id(section);
            }
            let braid = tuft.view(BRAID).at(i, at);
            let owner = if braid == 0 { tuft.view(PARENT).at(i, at) } else { braid };
            if tuft.attribute(GROUP.name).is_none() {
                return of_id(owner);
            }
            let group = tuft.view(GROUP).at(i, at) as u32;
            of_id(mix(owner ^ mix(u64::from(group).wrapping_add(1))))
        },
    };
    Paint::colours(&format!("groom {colours:?}"), 0, move |tuft| {
        let mut out = Vec::with_capacity(tuft.points().len());
        for i in 0..tuft.len() {
            // A curve without points has no value at its first point either.
            let range = tuft.range(i);
            if !range.is_empty() {
                out.extend(std::iter::repeat_n(colour::pack_colour(of(tuft, i)), range.len()));
            }
        }
        out
    })
}

/// The most numbers that a range is taken from.
const MOST_SAMPLED: usize = 1 << 18;

/// The 1st and 99th percentile of numbers that are finite and not below `least`; zeros without any.
fn robust_range(curves: &Curves, numbers: &Numbers, least: Option<f32>) -> (f32, f32) {
    let stride = curves.point_count().div_ceil(MOST_SAMPLED).max(1);
    let mut sampled: Vec<f32> = vec![];
    let mut next = 0;
    for tuft in curves.tufts() {
        let all = numbers(tuft);
        sampled.extend(
            all.iter()
                .skip(next)
                .step_by(stride)
                .filter(|x| x.is_finite() && least.is_none_or(|least| **x >= least)),
        );
        next = (next + stride - all.len() % stride) % stride;
    }
    if sampled.is_empty() {
        return (0.0, 0.0);
    }
    let last = sampled.len() - 1;
    let mut at = |share: f32| {
        let k = (last as f32 * share).round() as usize;
        *sampled.select_nth_unstable_by(k.min(last), f32::total_cmp).1
    };
    (at(0.01), at(0.99))
}

/// These curves, all `diameter` cm wide: guides drawn so that they are seen.
pub fn drawn_as(curves: &Curves, diameter: f32) -> Curves {
    let tufts = curves.tufts().iter().map(|tuft| {
        let mut edit = tuft.edit();
        edit.set(WIDTH, Domain::Curve, vec![diameter]);
        Arc::new(edit.build())
    });
    Curves::new(tufts.collect())
}

/// Colours of guides drawn over hair or clusters: each in its own, as its tube and its hair have it.
pub fn guides_paint() -> Paint {
    Paint::colours("guides", 0, |tuft| {
        let mut out = Vec::with_capacity(tuft.points().len());
        for i in 0..tuft.len() {
            let range = tuft.range(i);
            if !range.is_empty() {
                out.extend(std::iter::repeat_n(
                    colour::pack_colour(of_id(tuft.id(i))),
                    range.len(),
                ));
            }
        }
        out
    })
}

#[cfg(test)]
mod tests {
    use super::colour::tests::{unpack_absorption, unpack_colour};
    use super::*;
    use coif_nodes::data::attributes::{ID, RADIUS, ROLL};
    use coif_nodes::data::curves::TuftBuilder;
    use coif_nodes::data::scalp::{HeadFrame, REGION};
    use coif_nodes::maths::closest::Surface;
    use coif_nodes::scalp::bust;

    /// Four hairs on x = 0, 1, 2, 3, of 1, 2, 3, 4 cm, in two tufts, with all that views ask for.
    fn groom_of_four() -> Curves {
        let tuft = |first: u64| {
            let mut b = TuftBuilder::new();
            for k in first..first + 2 {
                let at = |j: u64| Vec3::new(k as f32, j as f32 * (k + 1) as f32 / 4.0, 0.0);
                b.push_curve(&(0..5).map(at).collect::<Vec<_>>());
            }
            b.set(ID, Domain::Curve, vec![first + 10, first + 11]);
            b.set(PARENT, Domain::Curve, vec![7 + first / 2]);
            b.set(BRAID, Domain::Curve, vec![50 + first / 2]);
            b.set(STRAND, Domain::Curve, vec![first as i32, first as i32 + 1]);
            b.set(GROUP, Domain::Curve, vec![0, 1]);
            b.set(ROLL, Domain::Point, (0..10).map(|k| 10.0 * k as f32).collect());
            b.set(COLOUR, Domain::Curve, vec![Vec3::splat(0.2), Vec3::new(0.4, 0.2, 0.1)]);
            Arc::new(b.build())
        };
        Curves::new(vec![tuft(0), tuft(2)])
    }

    fn bust() -> Scalp {
        let mesh = bust::adult();
        let surface = Surface::new(mesh.points, mesh.triangles);
        let region = [(REGION.to_owned(), vec![1.0; surface.points.len()])].into();
        Scalp::new(surface, None, HeadFrame::IDENTITY, region)
    }

    fn all_views() -> Vec<View> {
        let names = NAMES.iter().chain(&["roll", "id", "strand", "colour", "length:0..9", "cvs:3"]);
        names.map(|name| name.parse().unwrap()).collect()
    }

    #[test]
    fn every_view_has_a_word_for_every_point_of_any_curve() {
        let mut odd = TuftBuilder::new();
        odd.push_curve(&[]);
        odd.push_curve(&[Vec3::ONE]);
        odd.push_curve(&[Vec3::ONE; 4]);
        odd.push_curve(&[Vec3::ZERO, Vec3::X, Vec3::ZERO]);
        odd.push_curve(&[Vec3::splat(f32::NAN), Vec3::X]);
        odd.push_curve(&[Vec3::splat(f32::INFINITY), Vec3::splat(1e30)]);
        let odd = Curves::new(vec![Arc::new(odd.build())]);
        let scalp = bust();
        for view in all_views() {
            for curves in [&groom_of_four(), &odd, &Curves::default()] {
                let paint = match view.paint(curves, Some(&scalp)) {
                    Ok(paint) => paint,
                    Err(why) => {
                        assert!(matches!(view, View::Attribute(_)), "{view:?}: {why}");
                        continue;
                    }
                };
                // Curves that the paint was not made for have words too.
                for tuft in curves.tufts().iter().chain(odd.tufts()) {
                    assert_eq!(paint.of(tuft).len(), tuft.points().len(), "{view:?}");
                }
                let again = view.paint(curves, Some(&scalp)).unwrap();
                assert_eq!(again.key, paint.key, "{view:?}");
                if let Some(legend) = &paint.legend {
                    assert!(legend.lowest <= legend.highest, "{view:?}: {legend:?}");
                }
            }
        }
    }

    #[test]
    fn names_and_ranges_are_read() {
        for (text, want) in [
            ("hair", Ok(View::Hair)),
            ("cluster", Ok(View::Groom(GroomColours::Cluster))),
            ("cvs", Ok(View::Cvs(255))),
            ("cvs:64", Ok(View::Cvs(64))),
            ("my own", Ok(View::Attribute("my own".into()))),
            (
                "roll:-10..10",
                Ok(View::Between(Box::new(View::Attribute("roll".into())), -10.0, 10.0)),
            ),
            ("length:3..1", Err("a range is LOW..HIGH")),
            ("cvs:some", Err("a range is LOW..HIGH")),
            ("hair:0..1", Err("hair has no range")),
            ("", Err("a view has a name")),
        ] {
            match (text.parse::<View>(), want) {
                (Ok(view), Ok(want)) => assert_eq!(view, want),
                (Err(why), Err(want)) => assert!(why.contains(want), "{why}"),
                (got, want) => panic!("{text:?}: {got:?}, not {want:?}"),
            }
        }
        let why = View::Attribute("rol".into()).paint(&groom_of_four(), None).unwrap_err();
        assert!(
            why.ends_with("attributes braid, colour, group, id, parent, roll, strand"),
            "{why}"
        );
        assert!(View::Penetration.paint(&groom_of_four(), None).is_err());
        let ranged = View::Between(Box::new(View::Attribute("colour".into())), 0.0, 1.0);
        assert!(ranged.paint(&groom_of_four(), None).is_err());
    }

    /// The colours of a view, one a point of all tufts.
    fn shown(view: &str, curves: &Curves) -> (Vec<Vec3>, Option<Legend>) {
        let paint = view.parse::<View>().unwrap().paint(curves, Some(&bust())).unwrap();
        assert_eq!(paint.shading, Shading::Colour);
        let words = curves.tufts().iter().flat_map(|t| paint.of(t));
        (words.map(unpack_colour).collect(), paint.legend)
    }

    #[test]
    fn numbers_are_the_colours_that_the_legend_says() {
        // View, unit, range, and the number at some points.
        let cases: [(&str, &str, [f32; 2], &[(usize, f32)]); 6] = [
            ("length", "cm", [1.0, 4.0], &[(0, 1.0), (5, 2.0), (19, 4.0)]),
            ("length:0..8", "cm", [0.0, 8.0], &[(4, 1.0), (12, 3.0)]),
            ("roll", "degrees", [0.0, 90.0], &[(3, 30.0), (9, 90.0), (13, 30.0)]),
            ("u", "", [0.0, 1.0], &[(0, 0.0), (2, 0.5), (19, 1.0)]),
            ("cvs", "", [0.0, 255.0], &[(0, 5.0)]),
            ("curvature:0..1", "1/cm", [0.0, 1.0], &[(0, 0.0), (2, 0.0)]),
        ];
        for (view, unit, range, points) in cases {
            let (colours, legend) = shown(view, &groom_of_four());
            let legend = legend.unwrap();
            assert_eq!(
                (legend.unit.as_str(), [legend.lowest, legend.highest]),
                (unit, range),
                "{view}"
            );
            for (k, number) in points {
                let want = legend.ramp.at((number - range[0]) / (range[1] - range[0]));
                let off = (colours[*k] - want).abs().max_element();
                assert!(off < 0.012, "{view} {k}: {} {want}", colours[*k]);
            }
        }
    }

    #[test]
    fn too_many_points_are_loud() {
        let (colours, legend) = shown("cvs:4", &groom_of_four());
        assert!(colours.iter().all(|c| (*c - over()).abs().max_element() < 0.005));
        assert_eq!(legend.unwrap().limit, Some(4.0));
        let (colours, _) = shown("cvs:5", &groom_of_four());
        assert!((colours[0] - Ramp::Viridis.at(1.0)).abs().max_element() < 0.01);
    }

    #[test]
    fn a_few_outliers_do_not_spoil_a_range() {
        let mut b = TuftBuilder::new();
        (0..1000).for_each(|_| b.push_curve(&[Vec3::ZERO]));
        let mut values: Vec<f32> = (0..1000).map(|k| k as f32 * 0.001).collect();
        (values[3], values[500], values[7]) = (1e9, -1e9, f32::NAN);
        b.set_named("mine".into(), Domain::Curve, values);
        let curves = Curves::new(vec![Arc::new(b.build())]);
        let legend = View::Attribute("mine".into()).paint(&curves, None).unwrap().legend.unwrap();
        assert!((legend.lowest - 0.01).abs() < 0.003 && (legend.highest - 0.99).abs() < 0.003);
    }

    #[test]
    fn hair_is_what_its_colour_absorbs() {
        let curves = groom_of_four();
        let paint = Paint::hair();
        assert_eq!(paint.shading, Shading::Hair);
        let words = paint.of(&curves.tufts()[0]);
        let want = absorption_of(Vec3::new(0.4, 0.2, 0.1));
        let off = unpack_absorption(words[7]).map(f32::sqrt) - want.map(f32::sqrt);
        assert!(off.abs().max_element() < 0.0023, "{off}");
        // A colour at each point reads like one a curve.
        let mut edit = curves.tufts()[0].edit();
        let (a, b) = (Vec3::splat(0.2), Vec3::new(0.4, 0.2, 0.1));
        edit.set(COLOUR, Domain::Point, [[a; 5], [b; 5]].concat());
        assert_eq!(paint.of(&edit.build()), words);
    }

    #[test]
    fn sections_of_partings_are_coloured_as_such_whatever_hair_was_made_from() {
        let mut edit = TuftBuilder::even((0..4).map(|x| Vec3::X * x as f32).collect(), 1);
        edit.set(PARENT, Domain::Curve, vec![1, 2, 1, 2]);
        edit.set(SECTION, Domain::Curve, vec![7, 7, 9, 9]);
        let (colours, _) = shown("section", &Curves::new(vec![Arc::new(edit.build())]));
        assert_eq!(colours[0], colours[1]);
        assert_eq!(colours[2], colours[3]);
        assert_ne!(colours[0], colours[2]);
    }

    #[test]
    fn groom_colours_follow_what_hair_belongs_to() {
        let curves = groom_of_four();
        let same = |view: &str, a: usize, b: usize| {
            let (colours, legend) = shown(view, &curves);
            assert_eq!(legend, None);
            colours[a] == colours[b]
        };
        // Points 0 and 5 are of the first tuft's two hairs, 10 and 15 of the second's.
        for (view, within, across) in [
            ("groom", true, true),
            ("cluster", true, false),
            ("braid", true, false),
            ("strand", false, false),
            ("section", false, false),
            ("id", false, false),
            ("parent", true, false),
        ] {
            assert_eq!(same(view, 0, 5), within, "{view}");
            assert_eq!(same(view, 0, 10), across, "{view}");
            assert!(same(view, 0, 4), "{view}");
        }
        // A cluster's hair, its tube and its guide have one colour.
        let mut guide = TuftBuilder::new();
        guide.push_curve(&[Vec3::ZERO, Vec3::Y]);
        guide.set(ID, Domain::Curve, vec![7]);
        guide.set(RADIUS, Domain::Curve, vec![0.5]);
        let guide = Curves::new(vec![Arc::new(guide.build())]);
        let guides = guides_paint().of(&guide.tufts()[0])[0];
        assert_eq!(guides, colour::pack_colour(crate::surface::tubes(&guide).colours[0]));
        let hair = View::Groom(GroomColours::Cluster).paint(&curves, None).unwrap();
        assert_eq!(guides, hair.of(&curves.tufts()[0])[0]);
        assert_eq!(drawn_as(&guide, 0.1).tufts()[0].view(WIDTH).at(0, 1), 0.1);
    }

    #[test]
    fn directions_and_colours_are_shown_as_they_are() {
        let (colours, _) = shown("tangent", &groom_of_four());
        assert!((colours[0] - Vec3::new(0.5, 1.0, 0.5)).abs().max_element() < 0.005);
        let (colours, _) = shown("colour", &groom_of_four());
        assert!((colours[6] - Vec3::new(0.4, 0.2, 0.1)).abs().max_element() < 0.005);
    }

    #[test]
    fn curvature_of_a_circle_is_one_over_its_radius() {
        let at = |k: usize| {
            let (sin, cos) = (k as f32 * 0.4).sin_cos();
            Vec3::new(2.5 * cos, 0.0, 2.5 * sin)
        };
        let mut b = TuftBuilder::new();
        b.push_curve(&(0..9).map(at).collect::<Vec<_>>());
        for k in measure::curvature(&b.build()) {
            assert!((k - 0.4).abs() < 1e-4, "{k}");
        }
    }

    #[test]
    fn density_is_hairs_across_a_square_centimetre() {
        // 20 x 20 straight hairs, 1 mm apart, 10 cm long: 100 on a square centimetre.
        let mut b = TuftBuilder::new();
        for k in 0..400 {
            let root = Vec3::new((k % 20) as f32 * 0.1, 0.0, (k / 20) as f32 * 0.1);
            b.push_curve(&[root, root + Vec3::Y * 4.0, root + Vec3::Y * 10.0]);
        }
        let grid = measure::Density::of(&Curves::new(vec![Arc::new(b.build())]));
        for y in [2.0, 4.4, 7.9] {
            let density = grid.at(Vec3::new(0.95, y, 0.95));
            assert!((density / 100.0 - 1.0).abs() < 0.05, "{density}");
        }
        assert!(grid.at(Vec3::new(0.0, 5.0, 0.95)) < 70.0);
        assert_eq!(grid.at(Vec3::splat(50.0)), 0.0);
    }

    #[test]
    fn depth_is_the_distance_from_the_skin() {
        let scalp = bust();
        let mut b = TuftBuilder::new();
        let inwards = |k: usize| Vec3::new(0.3, 10.0 - 0.5 * k as f32, 0.1);
        b.push_curve(&(0..8).map(inwards).collect::<Vec<_>>());
        let tuft = b.build();
        let depths = measure::depths(&tuft, &scalp);
        assert!(depths[0] == 0.0 && depths[7] > 1.0, "{depths:?}");
        for (p, depth) in tuft.points().iter().zip(&depths) {
            assert_eq!(*depth, (-scalp.skin().distance(*p)).max(0.0));
        }
        let curves = Curves::new(vec![Arc::new(tuft)]);
        let paint = View::Penetration.paint(&curves, Some(&scalp)).unwrap();
        let words = paint.of(&curves.tufts()[0]);
        assert_eq!(unpack_colour(words[0]), unpack_colour(colour::pack_colour(colour::NONE)));
        assert_ne!(words[7], words[0]);
    }

    #[test]
    fn the_parting_lies_half_way_between_braids() {
        // Two fields of roots, 1 cm apart between x = -0.5 and 0.5; one wide and one narrow.
        let mut b = TuftBuilder::new();
        let mut braids = vec![];
        for i in 0..60 {
            for j in 0..20 {
                let x = if i < 40 { -0.5 - i as f32 * 0.1 } else { 0.5 + (i - 40) as f32 * 0.1 };
                let root = Vec3::new(x, 0.0, j as f32 * 0.1);
                b.push_curve(&[root, root + Vec3::Y]);
                braids.push(if i < 40 { 5u64 } else { 6 });
            }
        }
        b.set(BRAID, Domain::Curve, braids);
        let tuft = Arc::new(b.build());
        let known = measure::partings(&Curves::new(vec![tuft.clone()]));
        let distances = known.of_tuft(&tuft);
        for (i, curve) in (0..tuft.len()).map(|i| (i, tuft.curve(i))) {
            let got = distances[tuft.range(i).start];
            let want = curve[0].x.abs();
            assert!((got - want).abs() < 1e-4, "{}: {got}", curve[0]);
        }
        // One braid alone has no parting.
        let mut one = tuft.edit();
        one.set(BRAID, Domain::Curve, vec![5]);
        let one = Arc::new(one.build());
        assert!(measure::partings(&Curves::new(vec![one.clone()])).of_tuft(&one)[0].is_nan());
    }
}
