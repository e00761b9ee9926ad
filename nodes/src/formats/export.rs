//! A groom to bytes: curves with their attributes as USD or .hair.
//!
//! Every attribute travels: the well-known ones under the names other tools expect (`st`, `displayColor`, `id`, `clumpId`,
//! `skinprim`, `skinprimuv`), the rest under their own. Values that all hairs share are written once.
//!
//! Other readers take `catmullRom` as uniform, coif means centripetal (methods.md 0): [`conform`] resamples the
//! curves for which the two differ, so that what is read elsewhere is the same hair to 1e-3 cm.

use super::chunks::Chunks;
use super::error::FormatError;
use super::hair;
use super::usd::groom::{
    CurveSet, Interpolation, Primvar, PrimvarValues, Purpose, Stage, UpAxis, Widths, write_usda,
    write_usdc,
};
use crate::data::attributes::{
    self as a, Column, Domain, ID, Item, PARENT, ROOT_BARY, ROOT_TRIANGLE, ROOT_UV, WIDTH,
};
use crate::data::curves::{Curves, Tuft, TuftBuilder, View};
use crate::data::scalp::Skin;
use crate::maths::spline::{Place, Spline};
use crate::shape::resample::between;
use glam::{Vec2, Vec3};
use std::collections::BTreeSet;
use std::io::{Seek, Write};
use std::sync::Arc;

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

/// Curves as other tools will read them, and how far the two readings differ.
#[derive(Clone, Debug)]
pub struct Conformed {
    /// The curves, resampled where needed. Tufts that need nothing are the same.
    pub curves: Curves,
    /// How many curves were resampled.
    pub resampled: usize,
    /// The largest distance between the two readings, cm.
    pub difference: f32,
    /// Curves of fewer than two points, which no format holds: left out.
    pub left_out: usize,
}

/// The largest distance between the two readings of a curve that is let pass, cm (methods.md 0).
pub const AGREE: f32 = 1e-3;

/// Resamples the curves whose uneven CVs would be read as another curve elsewhere: both ends stay, all other points are new
/// ones of the same curve, as far out of `skin` as it allows. A curve that passes through a thin part of the skin, such as an
/// ear, between its CVs is led round it.
pub fn conform(curves: &Curves, skin: Option<Skin>, for_each: crate::eval::ForEach) -> Conformed {
    let cells: Vec<std::sync::OnceLock<(Arc<Tuft>, usize, f32, usize)>> =
        curves.tufts().iter().map(|_| std::sync::OnceLock::new()).collect();
    for_each(cells.len(), &|i| {
        let _ = cells[i].set(conform_tuft(&curves.tufts()[i], skin.as_ref()));
    });
    let mut out =
        Conformed { curves: Curves::default(), resampled: 0, difference: 0.0, left_out: 0 };
    let mut tufts = vec![];
    for (tuft, resampled, difference, left_out) in cells.into_iter().filter_map(|c| c.into_inner())
    {
        tufts.push(tuft);
        out.resampled += resampled;
        out.difference = out.difference.max(difference);
        out.left_out += left_out;
    }
    out.curves = Curves::new(tufts);
    out
}

/// How many times as many segments a resampled curve is given, and whether it is first led round what the skin tears it at:
/// tried in turn until both readings agree. More points do not mend a torn curve.
const TRIES: [(f32, bool); 5] =
    [(1.0, false), (1.25, false), (1.0, true), (1.25, true), (1.6, true)];
/// The most points that resampling gives a curve: what game engines take. Where that is not enough, the difference that is
/// left is told.
pub const MOST_POINTS: usize = 255;
/// Rounds in which chords are made alike.
const ROUNDS: usize = 16;
/// Chords within this ratio are alike.
const ALIKE: f32 = 1.01;

fn conform_tuft(tuft: &Arc<Tuft>, skin: Option<&Skin>) -> (Arc<Tuft>, usize, f32, usize) {
    let mut worst = 0.0f32;
    let mut change = vec![false; tuft.len()];
    let mut left_out = 0;
    for (i, change) in change.iter_mut().enumerate() {
        let points = tuft.curve(i);
        if points.len() < 2 {
            left_out += 1;
            continue;
        }
        let difference = readings_differ(points);
        if difference > AGREE {
            *change = true;
        } else {
            worst = worst.max(difference);
        }
    }
    if left_out == 0 && !change.contains(&true) {
        return (tuft.clone(), 0, worst, 0);
    }
    let allowed = tuft.view(a::ALLOW_DEPTH);
    let mut out = TuftBuilder::new();
    let (mut kept, mut places, mut points, mut stops) = (vec![], vec![], vec![], vec![]);
    let (mut spline, mut led, mut resampled) = (Spline::default(), Spline::default(), 0);
    for (i, change) in change.into_iter().enumerate() {
        let old = tuft.curve(i);
        if old.len() < 2 {
            continue;
        }
        kept.push(i as u32);
        let first = tuft.offsets()[i];
        if !change || spline.rebuild(old).is_err() {
            let last = old.len() - 1;
            places.extend((0..=last).map(|k| {
                let span = k.min(last - 1);
                (first + span as u32, (k - span) as f32)
            }));
            out.push_curve(old);
            continue;
        }
        resampled += 1;
        let depth = |place: Place| {
            let near = first as usize + place.span + usize::from(place.t > 0.5);
            allowed.at(i, near)
        };
        for (finer, lead) in TRIES {
            let last = ((old.len() - 1) as f32 * finer) as usize;
            if last >= MOST_POINTS && finer > 1.0 {
                continue;
            }
            let ends = |k: usize| match k {
                0 => Some(old[0]),
                k if k == last => Some(old[old.len() - 1]),
                _ => None,
            };
            let clear = |p: Vec3, place| skin.map_or(p, |skin| skin.push_out(p, depth(place)).0);
            if let (true, Some(skin)) = (lead, skin) {
                let plain = |_, place| spline.point(place);
                alike_chords(&spline, last, &mut stops, &mut points, plain);
                skin.clear(&mut points, |k| Some(depth(stops[k].1)));
                if led.rebuild(&points).is_err() {
                    break;
                }
                let (of, to) = (spline.length(), led.length());
                // Its points are evenly spaced.
                let place_of =
                    |place: Place| spline.locate((place.span as f32 + place.t) / last as f32);
                let led_to =
                    |k, place| ends(k).unwrap_or_else(|| clear(led.point(place), place_of(place)));
                alike_chords(&led, last, &mut stops, &mut points, led_to);
                stops.iter_mut().for_each(|(s, place)| {
                    *s *= of / to;
                    *place = spline.locate_length(*s);
                });
            } else {
                let pushed =
                    |k, place| ends(k).unwrap_or_else(|| clear(spline.point(place), place));
                alike_chords(&spline, last, &mut stops, &mut points, pushed);
            }
            if readings_differ(&points) <= AGREE {
                break;
            }
        }
        places.extend(stops.iter().map(|(_, place)| (first + place.span as u32, place.t)));
        worst = worst.max(readings_differ(&points));
        out.push_curve(&points);
    }
    for attribute in tuft.attributes() {
        let values = match attribute.domain {
            Domain::Curve => attribute.values.gather(&kept),
            Domain::Point => between(&attribute.values, &places),
        };
        out.set_column(a::Attribute { values, ..attribute.clone() });
    }
    (Arc::new(out.build()), resampled, worst, left_out)
}

/// `last` + 1 points of the spline whose chords are so much alike that both readings agree, and where they lie on it (arc
/// length and place): through such points both are one curve, however sharply it bends; points at even arc length have
/// shorter chords where it bends. `point` gives the point of a place, which may have to keep clear of the skin.
fn alike_chords(
    spline: &Spline,
    last: usize,
    stops: &mut Vec<(f32, Place)>,
    points: &mut Vec<Vec3>,
    point: impl Fn(usize, Place) -> Vec3,
) {
    // Places the points at these arc lengths; gives the longest chord over the shortest.
    let sample = |wanted: &[f32], stops: &mut Vec<(f32, Place)>, points: &mut Vec<Vec3>| -> f32 {
        let mut cursor = 0;
        stops.clear();
        stops.extend(wanted.iter().map(|s| (*s, spline.locate_rising(&mut cursor, *s))));
        points.clear();
        points.extend(stops.iter().enumerate().map(|(k, (_, place))| point(k, *place)));
        let chords = points.windows(2).map(|w| w[0].distance(w[1]));
        let (least, most) = chords.fold((f32::MAX, 0.0f32), |(a, b), c| (a.min(c), b.max(c)));
        most / least.max(1e-9)
    };
    let mut wanted: Vec<f32> =
        (0..=last).map(|k| k as f32 / last as f32 * spline.length()).collect();
    // Where the skin makes a curve leap, more points make no shorter chords: the best round counts.
    let mut best = (f32::MAX, wanted.clone());
    for _ in 0..ROUNDS {
        let ratio = sample(&wanted, stops, points);
        if ratio <= ALIKE || readings_differ(points) <= AGREE {
            return;
        }
        if ratio < best.0 {
            best = (ratio, wanted.clone());
        }
        // What arc length has come where the chords have come to their even share.
        let total: f32 = points.windows(2).map(|w| w[0].distance(w[1])).sum();
        let (mut k, mut come) = (0, 0.0);
        for (n, stop) in wanted.iter_mut().enumerate().take(last).skip(1) {
            let share = total * n as f32 / last as f32;
            while k + 1 < last && come + points[k].distance(points[k + 1]) < share {
                come += points[k].distance(points[k + 1]);
                k += 1;
            }
            let chord = points[k].distance(points[k + 1]);
            let part = if chord > 0.0 { ((share - come) / chord).clamp(0.0, 1.0) } else { 0.0 };
            *stop = stops[k].0 + (stops[k + 1].0 - stops[k].0) * part;
        }
    }
    if sample(&wanted, stops, points) > best.0 {
        sample(&best.1, stops, points);
    }
}

/// The largest distance, cm, between the uniform and the centripetal Catmull-Rom spline through the points: the two have the
/// same ends in each span and differ in their tangents there. Sliding along the curve counts nothing.
pub fn readings_differ(points: &[Vec3]) -> f32 {
    let n = points.len();
    let knot = |i: usize| points[i].distance(points[i + 1]).sqrt();
    // Tangents at the inner point `i`, whose segments have the knots `a` and `b`: per unit of the centripetal
    // parameter, and of the uniform one.
    let tangents = |i: usize, a: f32, b: f32| -> (Vec3, Vec3) {
        let (p0, p1, p2) = (points[i - 1], points[i], points[i + 1]);
        let centripetal = if a > 0.0 && b > 0.0 {
            (p1 - p0) / a - (p2 - p0) / (a + b) + (p2 - p1) / b
        } else {
            Vec3::ZERO
        };
        (centripetal, (p2 - p0) * 0.5)
    };
    let mut worst = 0.0f32;
    let mut before = None;
    let mut d = if n > 1 { knot(0) } else { 0.0 };
    for i in 0..n.saturating_sub(1) {
        let next = if i + 2 < n { knot(i + 1) } else { 0.0 };
        let after = (i + 2 < n).then(|| tangents(i + 1, d, next));
        let delta = |t: Option<(Vec3, Vec3)>| t.map_or(Vec3::ZERO, |(c, u)| c * d - u);
        let (d1, d2) = (delta(before), delta(after));
        // 4/27 is the largest value of either Hermite basis.
        let bound = (d1.length() + d2.length()) * (4.0 / 27.0);
        if bound > AGREE && d > 0.0 {
            let chord = points[i + 1] - points[i];
            let (m1, m2) = (before.map_or(chord, |(_, u)| u), after.map_or(chord, |(_, u)| u));
            for t in [0.2f32, 0.4, 0.6, 0.8] {
                let gap = d1 * (t * (1.0 - t) * (1.0 - t)) - d2 * (t * t * (1.0 - t));
                let along = chord * (6.0 * t * (1.0 - t))
                    + m1 * (1.0 - 4.0 * t + 3.0 * t * t)
                    + m2 * (3.0 * t * t - 2.0 * t);
                let slide = along * (gap.dot(along) / along.length_squared().max(1e-20));
                worst = worst.max((gap - slide).length());
            }
        } else {
            worst = worst.max(bound.min(AGREE));
        }
        (before, d) = (after, next);
    }
    worst
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::scalp::tests::in_order;

    fn curves(lists: &[&[Vec3]]) -> Curves {
        let mut b = TuftBuilder::new();
        lists.iter().for_each(|points| b.push_curve(points));
        b.set(ID, Domain::Curve, (1..=lists.len() as u64).collect());
        Curves::new(vec![Arc::new(b.build())])
    }

    #[test]
    fn uneven_curves_are_resampled_until_both_readings_agree_and_even_ones_are_left() {
        let uneven = [0.0, 0.2, 3.0, 3.3, 7.0f32].map(|x| Vec3::new(x, (x * x) * 0.2, 0.0));
        let even = [0.0, 1.0, 2.0, 3.0f32].map(|x| Vec3::new(x, x * 0.1, 0.0));
        let before = curves(&[&uneven, &even, &[Vec3::ONE]]);
        assert!(readings_differ(&uneven) > 0.05);
        let after = conform(&before, None, &in_order);
        assert_eq!((after.resampled, after.left_out), (1, 1));
        assert!(after.difference <= AGREE, "{}", after.difference);
        let tuft = &after.curves.tufts()[0];
        assert_eq!(tuft.curve(1), even);
        assert_eq!(
            (tuft.curve(0)[0], tuft.curve(0)[tuft.curve(0).len() - 1]),
            (uneven[0], uneven[4])
        );
        let again = conform(&after.curves, None, &in_order);
        assert!(Arc::ptr_eq(&again.curves.tufts()[0], tuft), "what agrees is not copied");
    }

    #[test]
    fn hairpins_and_coarse_coils_are_read_alike_after_resampling() {
        let hairpin: Vec<Vec3> = (0..40)
            .map(|k| Vec3::new(4.0 - (k as f32 - 19.7).abs() * 0.2, 0.05 * k as f32, 0.0))
            .collect();
        let coil: Vec<Vec3> = (0..200)
            .map(|k| {
                let k = k as f32 + 0.35 * ((k % 3) as f32);
                let (sin, cos) = crate::maths::transcendental::sin_cos_turns(k * 0.13);
                Vec3::new(cos * 0.2, k * 0.02, sin * 0.2)
            })
            .collect();
        for curve in [hairpin, coil] {
            assert!(readings_differ(&curve) > 3.0 * AGREE, "{}", readings_differ(&curve));
            let after = conform(&curves(&[&curve]), None, &in_order);
            assert!(after.difference <= AGREE, "{}", after.difference);
            let points = after.curves.tufts()[0].curve(0);
            assert!(points.len() <= MOST_POINTS && points[0] == curve[0], "{}", points.len());
        }
    }

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
            let prims = super::super::usd::read::read_curves(&file.into_inner(), "usdc").unwrap();
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
