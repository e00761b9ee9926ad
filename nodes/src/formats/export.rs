//! Writing grooms: curves with their attributes as USD, Alembic or .hair.
//!
//! Every attribute is written: well-known ones under the names that other tools expect ([`file_name`]), others under their own,
//! and beside them what readers of grooms look for ([`ADDED`]). Values that all hairs share are written once.
//!
//! Other tools read the same hair only if curves went through [`super::conform`].

use super::abc;
use super::chunks::Chunks;
use super::error::FormatError;
use super::file_ids::FileIds;
use super::hair;
use super::usd::groom::{
    CurveSet, GroomStage, Interpolation, Primvar, PrimvarValues, Purpose, SkinMesh, UpAxis, Widths,
    write_usda, write_usdc,
};
use crate::data::attributes::{
    self as a, Column, ID, Item, PARENT, PARTING, ROOT_BARY, ROOT_TRIANGLE, ROOT_UV, WIDTH,
};
use crate::data::curves::{AttributeView, Curves, Tuft};
use crate::data::scalp::Scalp;
use crate::maths::hair_colour::{absorption_of, pigment_of};
use glam::{Vec2, Vec3};
use std::collections::{BTreeMap, BTreeSet};
use std::io::{Seek, Write};
use std::sync::Arc;

/// Curves written under one name.
#[derive(Clone, Debug)]
pub struct HairGroup {
    /// The name.
    pub name: String,
    /// Whether they are guides, which are not rendered.
    pub guides: bool,
    /// The curves, cm, Y up.
    pub curves: Curves,
}

impl HairGroup {
    /// Whether these are lines of partings written as guides, for measuring: hair does not follow them.
    pub fn is_partings(&self) -> bool {
        let tufts = self.curves.tufts();
        let parts = |t: &Arc<Tuft>| t.view(PARTING).at(0, 0) != 0;
        self.guides && !tufts.is_empty() && tufts.iter().filter(|t| !t.is_empty()).all(parts)
    }
}

/// Origin of a file.
#[derive(Clone, Debug)]
pub struct About {
    /// Title of the document.
    pub title: String,
    /// Name and version of the program.
    pub generator: String,
    /// Hash of the document.
    pub graph_hash: String,
    /// The document's seed.
    pub seed: u64,
    /// Names of the sections of scalps, by id; curves in a section carry its name beside its number ([`SECTION_NAME`]).
    pub sections: BTreeMap<u64, String>,
}

/// A file format for grooms.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// USD as text.
    Usda,
    /// USD as a crate file.
    Usdc,
    /// Alembic; see [`abc`].
    Abc,
    /// Cem Yuksel's .hair; one group, no attributes except width and colour.
    Hair,
}

impl Format {
    /// Every format with its file extension; `usd` stands for the first.
    pub const ALL: [(&str, Self); 4] =
        [("usdc", Self::Usdc), ("usda", Self::Usda), ("abc", Self::Abc), ("hair", Self::Hair)];

    /// The format of a file extension (lower case, without the dot).
    pub fn of_extension(extension: &str) -> Option<Self> {
        let extension = if extension == "usd" { Self::ALL[0].0 } else { extension };
        Self::ALL.into_iter().find(|(known, _)| *known == extension).map(|(_, format)| format)
    }
    /// Extensions that [`Self::of_extension`] knows, for messages.
    pub const EXTENSIONS: &str = ".usda, .usdc, .abc, .hair";
}

/// The file's number for each curve of each group: the primvar `id`.
///
/// # Errors
/// More curves than there are numbers.
pub fn numbers(groups: &[HairGroup]) -> Result<Vec<Vec<i32>>, FormatError> {
    let ids = FileIds::of(groups, &|| Ok(()))?;
    Ok((0..groups.len()).map(|nth| ids.of_group(nth)).collect())
}

/// Writes groups in a format. USD and Alembic also hold the meshes of `heads`. Cancellation is checked between attributes while
/// they are gathered; after that, `out` fails on cancellation.
///
/// # Errors
/// The output failed, the export was cancelled, or the format cannot hold the groom; place and reason say what.
pub fn write(
    format: Format,
    groups: &[HairGroup],
    heads: &[Arc<Scalp>],
    about: &About,
    out: &mut (impl Write + Seek),
    is_cancelled: &dyn Fn() -> bool,
) -> Result<(), FormatError> {
    if format == Format::Hair {
        return write_hair(groups, about, out);
    }
    let places = places(groups);
    // For all groups, so that every format has the same.
    let ids = FileIds::of(groups, &|| go_on(is_cancelled))?;
    let is_written =
        |group: &HairGroup| format != Format::Abc || !is_left_out_of_abc(group, groups);
    let stage = GroomStage {
        name: about.title.clone(),
        doc: format!("{}, made by {}", about.title, about.generator),
        generator: about.generator.clone(),
        graph_hash: about.graph_hash.clone(),
        seed: about.seed,
        meters_per_unit: 0.01,
        up_axis: UpAxis::Y,
        groups: groups
            .iter()
            .zip(&places)
            .enumerate()
            .filter(|(_, (group, _))| is_written(group))
            .map(|(nth, (group, place))| curve_set(group, place, (nth, &ids), about, is_cancelled))
            .collect::<Result<_, FormatError>>()?,
        skins: heads.iter().map(|head| skin(head)).collect(),
    };
    match format {
        Format::Usda => write_usda(&stage, out),
        Format::Abc => abc::write(&stage, heads, out),
        _ => write_usdc(&stage, out),
    }
}

/// File names of declared attributes that differ from their own.
const FILE_NAMES: &[(&str, &str)] = &[
    (PARENT.name, "clumpId"),
    (ROOT_TRIANGLE.name, "skinprim"),
    (ROOT_BARY.name, "skinprimuv"),
    (ROOT_UV.name, "st"),
    (a::COLOUR.name, "displayColor"),
    (WIDTH.name, "widths"),
];

/// The file name of an attribute.
pub fn file_name(attribute: &str) -> &str {
    FILE_NAMES.iter().find(|(name, _)| *name == attribute).map_or(attribute, |(_, file)| file)
}

/// Data beside attributes for readers of grooms, by Epic's schema "Alembic for Grooms": name, type, interpolation and meaning.
pub const ADDED: &[(&str, &str, &str, &str)] = &[
    ("groom_guide", "int", "constant", "1 for guides, 0 for hair."),
    (
        "groom_group_id",
        "int",
        "constant",
        "Index of the hair group, from 0 in the order of outputs. Outputs with the same name form one group. Guides take the index of \
         the hair with their name, or else that of the first group.",
    ),
    ("groom_group_name", "string", "constant", "Name of the hair group."),
    ("groom_id", "int", "uniform", "`id`, folded to 31 bits and unique in the file, as `id` is."),
    (
        "groom_root_uv",
        "float2",
        "uniform",
        "`root_uv`. Missing if the scalp has no UVs; readers then project from a sphere around the hair.",
    ),
    ("groom_color", "color3", "vertex", "`colour`, linear Rec.709. Alembic only."),
];

/// The hair group of curves.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct HairGroupId {
    /// Index, from 0.
    pub id: i32,
    /// Name, without control characters.
    pub name: String,
}

/// The hair group of each, as in [`ADDED`]. Unreal cannot hold guides without hair.
pub fn places(groups: &[HairGroup]) -> Vec<HairGroupId> {
    let is_bald = groups.iter().all(|group| group.guides);
    let mut names: Vec<&str> = vec![];
    for group in groups.iter().filter(|group| is_bald || !group.guides) {
        if !names.contains(&group.name.as_str()) {
            names.push(&group.name);
        }
    }
    let place = |group: &HairGroup| {
        let id = names.iter().position(|name| *name == group.name).unwrap_or(0);
        HairGroupId { id: id as i32, name: names[id].replace(char::is_control, "_") }
    };
    groups.iter().map(place).collect()
}

/// Whether Alembic files leave out this one of `groups`: their readers would take lines of partings for guides. They stay if
/// there is nothing else.
pub fn is_left_out_of_abc(group: &HairGroup, groups: &[HairGroup]) -> bool {
    group.is_partings() && !groups.iter().all(HairGroup::is_partings)
}

/// Data written beside the attributes of a group, except under names that it has attributes of.
fn added<'c>(
    curves: &'c Curves,
    guides: bool,
    place: &HairGroupId,
    ids: &[i32],
) -> Vec<Primvar<'c>> {
    use Interpolation::{Constant, Uniform};
    let int = |value: i32| PrimvarValues::Int(vec![value].into());
    let mut added = vec![
        ("groom_guide", Constant, int(i32::from(guides))),
        ("groom_group_id", Constant, int(place.id)),
        ("groom_group_name", Constant, PrimvarValues::Text(vec![place.name.clone()])),
        ("groom_id", Uniform, PrimvarValues::Int(ids.to_vec().into())),
    ];
    let uvs: Vec<Vec2> =
        curves.each().map(|(t, i)| t.view(ROOT_UV).at(i, t.range(i).start)).collect();
    if uvs.iter().any(|uv| *uv != Vec2::ZERO) {
        added.push(("groom_root_uv", Uniform, PrimvarValues::TexCoord(uvs.into())));
    }
    let is_free = |name: &str| curves.tufts().iter().all(|t| t.attribute(name).is_none());
    added
        .into_iter()
        .filter(|(name, ..)| is_free(name))
        .map(|(name, interpolation, values)| Primvar { name: name.into(), interpolation, values })
        .collect()
}

fn go_on(is_cancelled: &dyn Fn() -> bool) -> Result<(), FormatError> {
    if is_cancelled() { Err(FormatError::at("file", "interrupted")) } else { Ok(()) }
}

fn curve_set<'c>(
    group: &'c HairGroup,
    place: &HairGroupId,
    (nth, ids): (usize, &FileIds),
    about: &About,
    is_cancelled: &dyn Fn() -> bool,
) -> Result<CurveSet<'c>, FormatError> {
    let check = || go_on(is_cancelled);
    let own = ids.of_group(nth);
    let tufts = group.curves.tufts();
    let names: BTreeSet<&str> =
        tufts.iter().flat_map(|t| t.attributes()).map(|a| a.name.as_ref()).collect();
    let mut primvars: Vec<Primvar> = vec![];
    for name in names.into_iter().filter(|name| *name != WIDTH.name) {
        check()?;
        primvars.extend(primvar(&group.curves, name, &own, ids));
    }
    check()?;
    primvars.extend(beside(&group.curves, &about.sections));
    check()?;
    primvars.extend(added(&group.curves, group.guides, place, &own));
    check()?;
    Ok(CurveSet {
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
    })
}

/// The mesh of a head.
fn skin(head: &Scalp) -> SkinMesh<'_> {
    let surface = head.surface();
    SkinMesh {
        name: "skin".into(),
        points: &surface.points,
        triangles: &surface.triangles,
        uvs: head.uvs(),
    }
}

/// Primvar with names of sections.
pub const SECTION_NAME: &str = "section_name";

/// Data written for lookdev beside attributes: name and meaning.
pub const LOOKDEV: &[(&str, &str)] = &[
    (
        "pref",
        "Where the point rests: the groom as it was made, cm. For textures and noises that stay on moving hair.",
    ),
    (
        "melanin",
        "Pigment, 0 (white) to 1 (black), that gives `displayColor`. Not there where dye or paint colours hair.",
    ),
    ("redness", "How much of that pigment is red, 0 to 1."),
    (SECTION_NAME, "Name of the section that `section` is the number of; empty: none."),
];

/// Data written for lookdev, except under names that the curves have attributes of.
fn beside<'c>(curves: &'c Curves, sections: &BTreeMap<u64, String>) -> Vec<Primvar<'c>> {
    let rest = curves.tufts().iter().map(|t| t.points()).collect();
    let rest = (Interpolation::Vertex, PrimvarValues::Point(rest));
    let mut all = vec![("pref", rest)];
    if let Some((how, melanin, redness)) = pigment(curves) {
        all.push(("melanin", (how, PrimvarValues::Float(melanin.into()))));
        all.push(("redness", (how, PrimvarValues::Float(redness.into()))));
    }
    all.extend(section_names(curves, sections).map(|names| (SECTION_NAME, names)));
    let is_free = |name: &str| curves.tufts().iter().all(|t| t.attribute(name).is_none());
    all.into_iter()
        .filter(|(name, _)| is_free(name))
        .map(|(name, (interpolation, values))| Primvar { name: name.into(), interpolation, values })
        .collect()
}

/// Melanin and redness of coloured curves, in the domain of their colours; `None` if any colour is not a pigment's.
fn pigment(curves: &Curves) -> Option<(Interpolation, Vec<f32>, Vec<f32>)> {
    /// Distance within which a colour counts as that of a pigment.
    const NEAR: f32 = 2e-3;
    curves.tufts().iter().find(|t| t.attribute(a::COLOUR.name).is_some())?;
    let (how, colours) = values(curves, a::COLOUR.name, a::COLOUR.default);
    let (mut melanin, mut redness) = (vec![], vec![]);
    for colour in colours.values() {
        let (m, r, missed) = pigment_of(absorption_of(*colour));
        if missed > NEAR {
            return None;
        }
        melanin.push(m);
        redness.push(r);
    }
    Some((how, melanin, redness))
}

/// The section name of each curve, if the curves carry sections and these have names.
fn section_names<'c>(
    curves: &Curves,
    sections: &BTreeMap<u64, String>,
) -> Option<(Interpolation, PrimvarValues<'c>)> {
    curves.tufts().iter().find(|t| t.attribute(a::SECTION.name).is_some())?;
    if sections.is_empty() {
        return None;
    }
    let mut names: Vec<String> = vec![];
    let mut numbers: BTreeMap<&str, i32> = BTreeMap::new();
    let mut number = |id: u64| {
        let name = sections.get(&id).map_or("", String::as_str);
        *numbers.entry(name).or_insert_with(|| {
            names.push(name.replace(char::is_control, "_"));
            names.len() as i32 - 1
        })
    };
    let of = |(t, i): (&Tuft, usize)| t.view(a::SECTION).at(i, t.range(i).start);
    let indices: Vec<i32> = curves.each().map(|one| number(of(one))).collect();
    Some((Interpolation::Uniform, PrimvarValues::Named(names, indices.into())))
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

/// The domain of an attribute over all curves, and its values. A tuft without it has `default`.
fn values<'c, T: Item>(
    curves: &'c Curves,
    name: &str,
    default: T,
) -> (Interpolation, Chunks<'c, T>) {
    let views = || curves.tufts().iter().map(|t| t.view_named::<T>(name));
    let mut shared = views().map(|view| match view {
        None => Some(default),
        Some(AttributeView::Shared(one)) => Some(one),
        Some(_) => None,
    });
    let first = shared.next().flatten();
    if let Some(first) = first
        && shared.all(|one| one == Some(first))
    {
        return (Interpolation::Constant, vec![first].into());
    }
    if views().any(|view| matches!(view, Some(AttributeView::Point(_)))) {
        return (Interpolation::Vertex, spread(curves, name, default));
    }
    let mut chunks = Chunks::new();
    for tuft in curves.tufts() {
        match tuft.view_named::<T>(name) {
            Some(AttributeView::Curve(all)) => chunks.push(all),
            Some(AttributeView::Shared(one)) => chunks.push(vec![one; tuft.len()]),
            _ => chunks.push(vec![default; tuft.len()]),
        }
    }
    (Interpolation::Uniform, chunks)
}

/// One value per CV, for an attribute of any domain.
fn spread<'c, T: Item>(curves: &'c Curves, name: &str, default: T) -> Chunks<'c, T> {
    let mut chunks = Chunks::new();
    for tuft in curves.tufts() {
        match tuft.view_named::<T>(name) {
            Some(AttributeView::Point(all)) => chunks.push(all),
            Some(AttributeView::Shared(one)) => chunks.push(vec![one; tuft.points().len()]),
            Some(AttributeView::Curve(all)) => chunks.push(
                (0..tuft.len())
                    .flat_map(|i| std::iter::repeat_n(all[i], tuft.range(i).len()))
                    .collect::<Vec<T>>(),
            ),
            None => chunks.push(vec![default; tuft.points().len()]),
        }
    }
    chunks
}

fn primvar<'c>(curves: &'c Curves, name: &str, own: &[i32], ids: &FileIds) -> Option<Primvar<'c>> {
    let sample = curves.tufts().iter().find_map(|t| t.attribute(name))?;
    let of = |interpolation, values| {
        Some(Primvar { name: file_name(name).to_owned(), interpolation, values })
    };
    // An attribute that is at its default everywhere is not written.
    if name != a::COLOUR.name && a::DECLARED.iter().any(|(declared, ..)| *declared == name) {
        let default = a::default_of(name, &sample.values);
        let says_nothing = |tuft: &Arc<Tuft>| match tuft.attribute(name) {
            Some(own) => own.values == default,
            None => true,
        };
        if curves.tufts().iter().all(says_nothing) {
            return None;
        }
    }
    if name == ID.name {
        return of(Interpolation::Uniform, PrimvarValues::Int(own.to_vec().into()));
    }
    match &sample.values {
        Column::F32(_) => {
            let (how, v) = values::<f32>(curves, name, missing(name, &sample.values)?);
            of(how, PrimvarValues::Float(v))
        }
        Column::I32(_) => {
            let (how, v) = values::<i32>(curves, name, missing(name, &sample.values)?);
            of(how, PrimvarValues::Int(v))
        }
        Column::U64(_) => {
            let (how, v) = values::<u64>(curves, name, missing(name, &sample.values)?);
            let folded: Vec<i32> = v.values().map(|id| ids.number(*id)).collect();
            of(how, PrimvarValues::Int(folded.into()))
        }
        Column::Vec2(_) => {
            let (how, v) = values(curves, name, missing(name, &sample.values)?);
            if name == ROOT_BARY.name {
                let uvw: Vec<Vec3> = v.values().map(|b: &Vec2| b.extend(0.0)).collect();
                return of(how, PrimvarValues::Vector(uvw.into()));
            }
            of(how, PrimvarValues::TexCoord(v))
        }
        Column::Vec3(_) => {
            let (how, v) = values(curves, name, missing(name, &sample.values)?);
            let is_colour = name == a::COLOUR.name;
            of(how, if is_colour { PrimvarValues::Color(v) } else { PrimvarValues::Vector(v) })
        }
    }
}

/// Default of a curve without the attribute.
fn missing<T: Item>(name: &str, like: &Column) -> Option<T> {
    T::values(&a::default_of(name, like))?.first().copied()
}

fn write_hair(
    groups: &[HairGroup],
    about: &About,
    out: &mut impl Write,
) -> Result<(), FormatError> {
    // One set for the format: guides are left out if there is hair, since nothing could tell them apart.
    let hair = groups.iter().filter(|g| !g.guides);
    let chosen: Vec<&HairGroup> =
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
                |name: &str| HairGroup { name: name.into(), guides: false, curves: curves.clone() };
            let about = About {
                title: "all".into(),
                generator: "test".into(),
                graph_hash: String::new(),
                seed: 0,
                sections: BTreeMap::new(),
            };
            let mut file = std::io::Cursor::new(vec![]);
            write(Format::Usdc, &[group("one"), group("two")], &[], &about, &mut file, &|| false)
                .unwrap();
            let prims = super::super::usd::read::read_alone(&file.into_inner(), "usdc").unwrap();
            for (name, ty, _) in a::DECLARED.iter().filter(|(name, ..)| *name != WIDTH.name) {
                let known = file_name(name);
                let found = |k: usize| prims[k].primvars.iter().find(|p| p.name == known).unwrap();
                let (one, two) = (found(0), found(1));
                let wanted = if *name == ID.name { "uniform" } else { how };
                assert_eq!(
                    (one.interpolation.as_str(), one.values.len()),
                    (wanted, if *name == ID.name { 2 } else { n }),
                    "{name} {ty}"
                );
                // But for ids, which the second has anew.
                let same = one.values == two.values;
                assert_eq!(same, *name != ID.name, "{name} is the same in every prim");
            }
        }
    }

    #[test]
    fn what_readers_of_grooms_look_for_is_in_every_file_but_for_what_curves_have_themselves() {
        let mut b = TuftBuilder::even((0..6).map(|k| Vec3::Y * k as f32).collect(), 3);
        b.set(ROOT_UV, Domain::Curve, vec![Vec2::X, Vec2::Y]);
        b.set(a::COLOUR, Domain::Curve, vec![Vec3::X]);
        let group = |b: TuftBuilder| HairGroup {
            name: "a\0b".into(),
            guides: false,
            curves: Curves::new(vec![Arc::new(b.build())]),
        };
        let about = About {
            title: "all".into(),
            generator: "test".into(),
            graph_hash: String::new(),
            seed: 0,
            sections: BTreeMap::new(),
        };
        let written = |format: Format, group: &HairGroup| {
            let mut file = std::io::Cursor::new(vec![]);
            write(format, std::slice::from_ref(group), &[], &about, &mut file, &|| false).unwrap();
            let bytes = file.into_inner();
            match format {
                Format::Abc => abc::read_curves(&bytes)
                    .map(|read| read.stage.curves)
                    .map_err(|err| err.to_string()),
                _ => super::super::usd::read::read_alone(&bytes, "usd"),
            }
            .unwrap()
            .remove(0)
        };
        let plain = group(b.clone());
        for format in [Format::Usda, Format::Usdc, Format::Abc] {
            let read = written(format, &plain);
            for (name, ty, how, _) in ADDED {
                let found = read.primvars.iter().find(|p| p.name == *name);
                if *name == "groom_color" && format != Format::Abc {
                    assert!(found.is_none(), "{format:?}");
                    continue;
                }
                let found = found.expect(name);
                assert_eq!(found.interpolation, *how, "{name}");
                let wanted = ["texCoord2f[]".to_owned(), format!("{ty}[]"), format!("{ty}f[]")];
                assert!(wanted.contains(&found.type_name), "{name} is {}", found.type_name);
            }
        }
        // Without uvs no root has one, and what the curves have themselves stays.
        b.set(ROOT_UV, Domain::Curve, vec![Vec2::ZERO]);
        let values = i32::column(vec![42]);
        b.set_column(a::Attribute { name: "groom_group_id".into(), domain: Domain::Curve, values });
        let own = group(b);
        for format in [Format::Usdc, Format::Abc] {
            let read = written(format, &own);
            let of =
                |name: &str| read.primvars.iter().filter(|p| p.name == name).collect::<Vec<_>>();
            assert!(of("groom_root_uv").is_empty(), "{format:?}");
            let [id] = of("groom_group_id")[..] else { panic!("{format:?}") };
            assert_eq!(id.values, super::super::usd::read::ReadValues::Int(vec![42]));
        }
    }
}
