//! A groom to bytes: curves with their attributes as USD or .hair.
//!
//! Every attribute travels: the well-known ones under the names other tools expect (`st`, `displayColor`, `id`, `clumpId`,
//! `skinprim`, `skinprimuv`), the rest under their own. Values that all hairs share are written once.
//!
//! What is read elsewhere is the same hair only once curves went through [`super::conform`].

use super::chunks::Chunks;
use super::error::FormatError;
use super::hair;
use super::usd::groom::{
    CurveSet, Interpolation, Primvar, PrimvarValues, Purpose, Stage, UpAxis, Widths, write_usda,
    write_usdc,
};
use crate::data::attributes::{
    self as a, Column, ID, Item, PARENT, ROOT_BARY, ROOT_TRIANGLE, ROOT_UV, WIDTH,
};
use crate::data::curves::{Curves, View};
use glam::{Vec2, Vec3};
use std::collections::BTreeSet;
use std::io::{Seek, Write};

/// Curves that leave the graph under one name.
#[derive(Clone, Debug)]
pub struct Group {
    /// The group's name.
    pub name: String,
    /// Whether they are guides, which renderers leave out.
    pub guides: bool,
    /// The curves, cm, Y up.
    pub curves: Curves,
}

/// What a file says about its making.
#[derive(Clone, Debug)]
pub struct About {
    /// Title of the document.
    pub title: String,
    /// Program and version.
    pub generator: String,
    /// Hash of the document that made it.
    pub graph_hash: String,
    /// The seed it ran with.
    pub seed: u64,
}

/// A file format that grooms are written in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// USD as text.
    Usda,
    /// USD as a crate file.
    Usdc,
    /// Cem Yuksel's .hair; one group, no attributes but width and colour.
    Hair,
}

impl Format {
    /// The format of a file name's extension (lower case, without the dot).
    pub fn of_extension(extension: &str) -> Option<Self> {
        match extension {
            "usda" => Some(Format::Usda),
            "usdc" | "usd" => Some(Format::Usdc),
            "hair" => Some(Format::Hair),
            _ => None,
        }
    }
    /// Extensions that [`Self::of_extension`] knows, for messages.
    pub const EXTENSIONS: &str = ".usda, .usdc, .hair";
}

/// Writes groups in a format.
///
/// # Errors
/// The output failed, or the format cannot hold the groom; place and reason say what.
pub fn write(
    format: Format,
    groups: &[Group],
    about: &About,
    out: &mut (impl Write + Seek),
) -> Result<(), FormatError> {
    if format == Format::Hair {
        return write_hair(groups, about, out);
    }
    let stage = Stage {
        name: about.title.clone(),
        doc: format!("{}, made by {}", about.title, about.generator),
        generator: about.generator.clone(),
        graph_hash: about.graph_hash.clone(),
        seed: about.seed,
        meters_per_unit: 0.01,
        up_axis: UpAxis::Y,
        groups: groups.iter().map(curve_set).collect(),
    };
    match format {
        Format::Usda => write_usda(&stage, out),
        _ => write_usdc(&stage, out),
    }
}

fn curve_set(group: &Group) -> CurveSet<'_> {
    let tufts = group.curves.tufts();
    let names: BTreeSet<&str> =
        tufts.iter().flat_map(|t| t.attributes()).map(|a| a.name.as_ref()).collect();
    let primvars = names
        .into_iter()
        .filter(|name| *name != WIDTH.name)
        .filter_map(|name| primvar(&group.curves, name))
        .collect();
    CurveSet {
        name: group.name.clone(),
        purpose: if group.guides { Purpose::Guide } else { Purpose::Render },
        counts: counts(&group.curves),
        points: tufts.iter().map(|t| t.points()).collect(),
        widths: match values(&group.curves, WIDTH.name, WIDTH.default) {
            (Interpolation::Constant, one) => {
                Widths::Constant(one.values().next().copied().unwrap_or(WIDTH.default))
            }
            _ => Widths::Vertex(spread(&group.curves, WIDTH.name, WIDTH.default)),
        },
        primvars,
        color: mean_colour(&group.curves),
    }
}

fn counts(curves: &Curves) -> Chunks<'static, i32> {
    let counts: Vec<i32> = curves
        .tufts()
        .iter()
        .flat_map(|t| t.offsets().windows(2).map(|o| (o[1] - o[0]) as i32))
        .collect();
    counts.into()
}

fn mean_colour(curves: &Curves) -> Vec3 {
    let colours = curves.tufts().iter().map(|t| t.view(a::COLOUR).at(0, 0));
    let (sum, n) = colours.fold((Vec3::ZERO, 0.0), |(sum, n), c| (sum + c, n + 1.0));
    if n > 0.0 { sum / n } else { a::COLOUR.default }
}

/// How the values of an attribute spread over the curves, and the values themselves. A tuft without it has `default`.
fn values<'c, T: Item>(
    curves: &'c Curves,
    name: &str,
    default: T,
) -> (Interpolation, Chunks<'c, T>) {
    let views = || curves.tufts().iter().map(|t| t.view_named::<T>(name));
    let mut shared = views().map(|view| match view {
        None => Some(default),
        Some(View::Shared(one)) => Some(one),
        Some(_) => None,
    });
    let first = shared.next().flatten();
    if let Some(first) = first
        && shared.all(|one| one == Some(first))
    {
        return (Interpolation::Constant, vec![first].into());
    }
    if views().any(|view| matches!(view, Some(View::Point(_)))) {
        return (Interpolation::Vertex, spread(curves, name, default));
    }
    let mut chunks = Chunks::new();
    for tuft in curves.tufts() {
        match tuft.view_named::<T>(name) {
            Some(View::Curve(all)) => chunks.push(all),
            Some(View::Shared(one)) => chunks.push(vec![one; tuft.len()]),
            _ => chunks.push(vec![default; tuft.len()]),
        }
    }
    (Interpolation::Uniform, chunks)
}

/// One value for each point, whatever the attribute's domain.
fn spread<'c, T: Item>(curves: &'c Curves, name: &str, default: T) -> Chunks<'c, T> {
    let mut chunks = Chunks::new();
    for tuft in curves.tufts() {
        match tuft.view_named::<T>(name) {
            Some(View::Point(all)) => chunks.push(all),
            Some(View::Shared(one)) => chunks.push(vec![one; tuft.points().len()]),
            Some(View::Curve(all)) => chunks.push(
                (0..tuft.len())
                    .flat_map(|i| std::iter::repeat_n(all[i], tuft.range(i).len()))
                    .collect::<Vec<T>>(),
            ),
            None => chunks.push(vec![default; tuft.points().len()]),
        }
    }
    chunks
}

fn primvar<'c>(curves: &'c Curves, name: &str) -> Option<Primvar<'c>> {
    let sample = curves.tufts().iter().find_map(|t| t.attribute(name))?;
    let own =
        |interpolation, values| Some(Primvar { name: name.to_owned(), interpolation, values });
    let mapped = |name: &str, interpolation, values| {
        Some(Primvar { name: name.to_owned(), interpolation, values })
    };
    if name == ID.name {
        return mapped("id", Interpolation::Uniform, PrimvarValues::Int(unique_ids(curves).into()));
    }
    match &sample.values {
        Column::F32(_) => {
            let (how, v) = values::<f32>(curves, name, missing(name, &sample.values)?);
            own(how, PrimvarValues::Float(v))
        }
        Column::I32(_) => {
            let (how, v) = values::<i32>(curves, name, missing(name, &sample.values)?);
            let known = if name == ROOT_TRIANGLE.name { "skinprim" } else { name };
            mapped(known, how, PrimvarValues::Int(v))
        }
        Column::U64(_) => {
            let (how, v) = values::<u64>(curves, name, missing(name, &sample.values)?);
            let folded: Vec<i32> = v.values().map(|id| fold(*id)).collect();
            let known = if name == PARENT.name { "clumpId" } else { name };
            mapped(known, how, PrimvarValues::Int(folded.into()))
        }
        Column::Vec2(_) => {
            let (how, v) = values(curves, name, missing(name, &sample.values)?);
            if name == ROOT_BARY.name {
                let uvw: Vec<Vec3> = v.values().map(|b: &Vec2| b.extend(0.0)).collect();
                return mapped("skinprimuv", how, PrimvarValues::Vector(uvw.into()));
            }
            let known = if name == ROOT_UV.name { "st" } else { name };
            mapped(known, how, PrimvarValues::TexCoord(v))
        }
        Column::Vec3(_) if name == a::COLOUR.name => {
            let (how, v) = values(curves, name, missing(name, &sample.values)?);
            mapped("displayColor", how, PrimvarValues::Color(v))
        }
        Column::Vec3(_) => {
            let (how, v) = values(curves, name, missing(name, &sample.values)?);
            own(how, PrimvarValues::Vector(v))
        }
    }
}

/// What curves without the attribute have.
fn missing<T: Item>(name: &str, like: &Column) -> Option<T> {
    T::values(&a::default_of(name, like))?.first().copied()
}

/// A stable id in the 31 bits that `int` primvars have. 0, which means none, stays 0, and nothing else becomes it.
fn fold(id: u64) -> i32 {
    let folded = ((id ^ (id >> 33)) & 0x7FFF_FFFF) as i32;
    if id == 0 { 0 } else { folded.max(1) }
}

/// Folded ids, one a curve, without repeats: among 100,000 about two pairs collide, and the larger full id of a pair
/// takes the next free number, whatever the order of the curves.
fn unique_ids(curves: &Curves) -> Vec<i32> {
    let ids: Vec<u64> = curves.each().map(|(t, i)| t.id(i)).collect();
    let mut out: Vec<i32> = ids.iter().map(|id| fold(*id)).collect();
    let mut sorted: Vec<(i32, u64, u32)> =
        out.iter().zip(&ids).zip(0..).map(|((folded, id), i)| (*folded, *id, i)).collect();
    sorted.sort_unstable();
    let repeats: Vec<u32> =
        sorted.windows(2).filter(|w| w[0].0 == w[1].0).map(|w| w[1].2).collect();
    if !repeats.is_empty() {
        let mut taken: BTreeSet<i32> = sorted.iter().map(|s| s.0).collect();
        for i in repeats {
            let mut free = out[i as usize];
            while !taken.insert(free) {
                free = if free == i32::MAX { 1 } else { free + 1 };
            }
            out[i as usize] = free;
        }
    }
    out
}

fn write_hair(groups: &[Group], about: &About, out: &mut impl Write) -> Result<(), FormatError> {
    // One set in the format: guides are left out when there is hair, for nothing could tell them apart.
    let hair = groups.iter().filter(|g| !g.guides);
    let chosen: Vec<&Group> =
        if hair.clone().next().is_some() { hair.collect() } else { groups.iter().collect() };
    let merged =
        Curves::new(chosen.iter().flat_map(|g| g.curves.tufts().iter().cloned()).collect());
    let set = hair::HairSet {
        counts: counts(&merged),
        points: merged.tufts().iter().map(|t| t.points()).collect(),
        thickness: match values(&merged, WIDTH.name, WIDTH.default) {
            (Interpolation::Constant, one) => {
                hair::Thickness::Default(one.values().next().copied().unwrap_or(WIDTH.default))
            }
            _ => hair::Thickness::Points(spread(&merged, WIDTH.name, WIDTH.default)),
        },
        colors: match values(&merged, a::COLOUR.name, a::COLOUR.default) {
            (Interpolation::Constant, one) => {
                hair::Colors::Default(one.values().next().copied().unwrap_or(a::COLOUR.default))
            }
            _ => hair::Colors::Points(spread(&merged, a::COLOUR.name, a::COLOUR.default)),
        },
        generator: about.generator.clone(),
    };
    hair::write(&set, out)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::attributes::Domain;
    use crate::data::curves::TuftBuilder;
    use std::sync::Arc;

    #[test]
    fn every_declared_attribute_travels_as_one_value_a_curve_and_a_point() {
        let of = |ty: &str, n: usize| {
            let number = |k: usize| k as f32 + 1.5;
            match ty {
                "f32" => f32::column((0..n).map(number).collect()),
                "i32" => i32::column((0..n).map(|k| k as i32 + 3).collect()),
                "u64" => u64::column((0..n).map(|k| (k as u64 + 1) << 35).collect()),
                "Vec2" => Vec2::column((0..n).map(|k| Vec2::splat(number(k))).collect()),
                _ => Vec3::column((0..n).map(|k| Vec3::splat(number(k))).collect()),
            }
        };
        for (domain, n, how) in [(Domain::Curve, 2, "uniform"), (Domain::Point, 6, "vertex")] {
            let mut b = TuftBuilder::even((0..6).map(|k| Vec3::Y * k as f32).collect(), 3);
            for (name, ty, _) in a::DECLARED {
                let values = of(ty, n);
                b.set_column(a::Attribute { name: (*name).into(), domain, values });
            }
            let curves = Curves::new(vec![Arc::new(b.build())]);
            let group =
                |name: &str| Group { name: name.into(), guides: false, curves: curves.clone() };
            let about = About {
                title: "all".into(),
                generator: "test".into(),
                graph_hash: String::new(),
                seed: 0,
            };
            let mut file = std::io::Cursor::new(vec![]);
            write(Format::Usdc, &[group("one"), group("two")], &about, &mut file).unwrap();
            let prims = super::super::usd::read::read_alone(&file.into_inner(), "usdc").unwrap();
            for (name, ty, _) in a::DECLARED.iter().filter(|(name, ..)| *name != WIDTH.name) {
                let known = match *name {
                    "parent" => "clumpId",
                    "root_triangle" => "skinprim",
                    "root_bary" => "skinprimuv",
                    "root_uv" => "st",
                    "colour" => "displayColor",
                    name => name,
                };
                let found = |k: usize| prims[k].primvars.iter().find(|p| p.name == known).unwrap();
                let (one, two) = (found(0), found(1));
                let wanted = if *name == ID.name { "uniform" } else { how };
                assert_eq!(
                    (one.interpolation.as_str(), one.values.len()),
                    (wanted, if *name == ID.name { 2 } else { n }),
                    "{name} {ty}"
                );
                assert_eq!(one.values, two.values, "{name} is the same in every prim");
            }
        }
    }

    #[test]
    fn an_id_never_folds_to_none() {
        assert_eq!(fold(0), 0);
        for id in [1 << 31, 1 | 1 << 33, 5, u64::MAX] {
            assert!(fold(id) > 0, "{id:x}");
        }
    }

    #[test]
    fn folded_ids_never_repeat() {
        let mut b = TuftBuilder::new();
        for _ in 0..4 {
            b.push_curve(&[Vec3::ZERO, Vec3::Y]);
        }
        // Bits 31 and 32 do not reach the folded id: these three collide.
        b.set(ID, Domain::Curve, vec![5, 5 | 1 << 31, 5 | 1 << 32, 6]);
        let ids = unique_ids(&Curves::new(vec![Arc::new(b.build())]));
        let set: BTreeSet<i32> = ids.iter().copied().collect();
        assert_eq!((set.len(), ids[0]), (4, 5));
    }
}
