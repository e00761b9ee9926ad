//! What becomes of a groom in Unreal Engine: what its importer would cut off or leave out, and what it makes up by itself.
//!
//! Looked at is what `.abc` files hold, by the groups that readers make of it ([`export::places`]). Limits and fallbacks are those of
//! the engine's importer (`HairStrandsDefinitions.h`, `AlembicHairTranslator.cpp`, `GroomBuilder.cpp`) and of Epic's "Alembic for
//! Grooms"; the engine itself was not run.

use super::evaluate::Opened;
use super::report::Report;
use super::stop::Stop;
use coif_graphs::document::Document;
use coif_graphs::schedule::run::{CancelToken, Quiet};
use coif_nodes::data::attributes::{ROOT_UV, WIDTH};
use coif_nodes::eval::Quality;
use coif_nodes::formats::export::{self, HairGroup};
use glam::Vec2;
use std::path::PathBuf;

/// Points a curve may have.
const POINTS_A_CURVE: usize = (1 << 8) - 1;
/// Points a group may have.
const POINTS_A_GROUP: usize = (1 << 24) - 1;
/// Curves a group may have, hair and guides each.
const CURVES_A_GROUP: usize = (1 << 22) - 1;
/// Letters a name may have.
const LETTERS: usize = 1023;

/// What becomes of a groom, a line each with what to do about it.
#[derive(Debug, Default, PartialEq)]
pub(crate) struct ImportReport {
    /// What is lost.
    pub(crate) lost: Vec<String>,
    /// What the importer makes up or does otherwise than a person may think.
    pub(crate) made_up: Vec<String>,
}

/// Evaluates the document's outputs and tells what becomes of them.
pub(crate) fn found(
    document: &Document,
    folder: PathBuf,
    graph: String,
    allow_large: bool,
) -> Result<ImportReport, Stop> {
    let opened = Opened::of(document.clone(), folder, graph, allow_large)?;
    let mut report = Report::new(String::new());
    let cancel = CancelToken::default();
    let evaluated = opened.evaluate(Quality::Final, &cancel, &Quiet, &mut report)?;
    Ok(judged(&evaluated.groups))
}

/// Tells what becomes of what was evaluated.
pub(crate) fn judged(groups: &[HairGroup]) -> ImportReport {
    let mut found = ImportReport::default();
    let ImportReport { lost, made_up } = &mut found;
    let places = export::places(groups);
    let written: Vec<(&HairGroup, &export::HairGroupId)> = groups
        .iter()
        .zip(&places)
        .filter(|(group, _)| !export::is_left_out_of_abc(group, groups))
        .collect();
    for group in groups.iter().filter(|group| export::is_left_out_of_abc(group, groups)) {
        made_up.push(format!(
            "{}: lines of partings, which are no guides; .abc leaves them out",
            group.name
        ));
    }
    if written.iter().all(|(group, _)| group.guides) {
        lost.push(
            "there are guides but no hair, and Unreal makes no groom of guides alone; add a groom_output of the hair, with its \
             guides turned off"
                .to_owned(),
        );
        return found;
    }
    for (group, place) in &written {
        of_curves(group, lost, made_up);
        if group.guides && group.name != place.name {
            made_up.push(format!(
                "{}: no hair has that name, so these guides go with {:?}; give the groom_output of the guides the name of its hair",
                group.name, place.name
            ));
        }
    }
    let mut names: Vec<&str> = vec![];
    for (_, place) in &written {
        if names.contains(&place.name.as_str()) {
            continue;
        }
        of_name(&place.name, &names, made_up);
        names.push(&place.name);
        let of = |guides: bool| {
            written.iter().filter(move |(g, p)| p.id == place.id && g.guides == guides).map(|w| w.0)
        };
        for (what, guides) in [("hairs", false), ("guides", true)] {
            let curves: usize = of(guides).map(|group| group.curves.curve_count()).sum();
            let points: usize = of(guides).map(|group| group.curves.point_count()).sum();
            if curves > CURVES_A_GROUP {
                lost.push(format!(
                    "{}: {curves} {what} are more than the {CURVES_A_GROUP} of an Unreal group, and those over are left out; give \
                     part of the outputs another name",
                    place.name
                ));
            }
            if points > POINTS_A_GROUP {
                lost.push(format!(
                    "{}: {points} points of {what} are more than the {POINTS_A_GROUP} of an Unreal group; give part of the \
                     outputs another name, or put fewer points on each curve",
                    place.name
                ));
            }
        }
        if of(true).next().is_none() {
            made_up.push(format!(
                "{}: there are no guides, so Unreal picks some of the hairs for them; to choose them yourself, add a groom_output \
                 of guides that is named {:?}, with its guides turned on",
                place.name, place.name
            ));
        }
    }
    found
}

/// What becomes of the curves of one output.
fn of_curves(group: &HairGroup, lost: &mut Vec<String>, made_up: &mut Vec<String>) {
    let (name, curves) = (&group.name, &group.curves);
    let lengths = || curves.each().map(|(tuft, i)| tuft.range(i).len());
    let long = lengths().filter(|points| *points > POINTS_A_CURVE).count();
    if long > 0 {
        let most = lengths().max().unwrap_or(0);
        lost.push(format!(
            "{name}: {long} curves have more than {POINTS_A_CURVE} points (the longest {most}), and Unreal cuts off what is over; \
             resample them, or make coils with fewer points a turn"
        ));
    }
    let roots = curves.each().map(|(tuft, i)| tuft.view(ROOT_UV).at(i, tuft.range(i).start));
    let bare = roots.filter(|uv| *uv == Vec2::ZERO).count();
    if bare == curves.curve_count() {
        made_up.push(format!(
            "{name}: its roots have no uvs, so Unreal lays a sphere about the hair for them; root it on a head whose mesh has uvs"
        ));
    } else if bare > 0 {
        made_up.push(format!(
            "{name}: {bare} of {} roots have no uv and are read as 0, 0; bind these curves to the scalp",
            curves.curve_count()
        ));
    }
    if !group.guides && curves.tufts().iter().all(|tuft| tuft.attribute(WIDTH.name).is_none()) {
        made_up.push(format!(
            "{name}: the hair has no width and is written {} cm wide; give it one with set_width",
            WIDTH.default
        ));
    }
}

/// What becomes of a name in Unreal, which knows no case in names; `before` are those of the groups before.
fn of_name(name: &str, before: &[&str], made_up: &mut Vec<String>) {
    let mut say = |what: &str| {
        made_up.push(format!("{name:?}: {what}; name its groom_output otherwise"));
    };
    if before.iter().any(|other| other.eq_ignore_ascii_case(name)) {
        say("another group has this name in other case, and Unreal shows both as one");
    }
    if name.eq_ignore_ascii_case("none") {
        say("Unreal takes this for no name");
    }
    if !name.is_ascii() {
        say("Unreal reads letters beyond ASCII wrongly");
    }
    if name.len() > LETTERS {
        say(&format!("Unreal's names have at most {LETTERS} letters"));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use coif_nodes::data::attributes::{Domain, PARTING};
    use coif_nodes::data::curves::{Curves, TuftBuilder};
    use glam::Vec3;
    use std::sync::Arc;

    /// An output of three curves of `points` points with uvs and a width.
    fn output(name: &str, guides: bool, points: usize) -> HairGroup {
        let mut b =
            TuftBuilder::even((0..3 * points).map(|k| Vec3::Y * k as f32).collect(), points);
        b.set(ROOT_UV, Domain::Curve, vec![Vec2::X; 3]);
        b.set(WIDTH, Domain::Curve, vec![0.01]);
        HairGroup { name: name.into(), guides, curves: Curves::new(vec![Arc::new(b.build())]) }
    }
    fn edited(mut group: HairGroup, edit: impl Fn(&mut TuftBuilder)) -> HairGroup {
        let mut b = group.curves.tufts()[0].edit();
        edit(&mut b);
        group.curves = Curves::new(vec![Arc::new(b.build())]);
        group
    }
    fn many(mut group: HairGroup, tufts: usize) -> HairGroup {
        group.curves = Curves::new(vec![group.curves.tufts()[0].clone(); tufts]);
        group
    }

    /// What is lost and what is made up: as many lines as given, each with its words.
    #[track_caller]
    fn check(groups: &[HairGroup], lost: &[&str], made_up: &[&str]) {
        let found = judged(groups);
        for (lines, words) in [(&found.lost, lost), (&found.made_up, made_up)] {
            assert_eq!(lines.len(), words.len(), "{lines:#?}");
            for (line, words) in lines.iter().zip(words) {
                assert!(line.contains(words), "{words:?} is not in {line:?}");
            }
        }
    }

    #[test]
    fn hair_with_guides_uvs_and_width_loses_nothing() {
        check(&[output("hair", false, 255), output("hair", true, 4)], &[], &[]);
    }

    #[test]
    fn what_is_over_a_limit_is_lost() {
        let with_guides = |hair: HairGroup| [hair, output("hair", true, 4)];
        check(
            &with_guides(output("hair", false, 256)),
            &["3 curves have more than 255 points"],
            &[],
        );
        // 3 x 255 x 21,931 = 16,777,215 points are what a group holds.
        check(&with_guides(many(output("hair", false, 255), 21_931)), &[], &[]);
        let over = with_guides(many(output("hair", false, 255), 21_932));
        check(&over, &["16777980 points of hairs are more than the 16777215"], &[]);
        // 3 x 1,398,101 = 4,194,303 curves, and 1 group by two outputs of one name.
        let [half, rest] = [700_000, 698_102].map(|tufts| many(output("hair", false, 2), tufts));
        let over = [half, rest, output("hair", true, 4)];
        check(&over, &["4194306 hairs are more than the 4194303"], &[]);
        check(&[output("hair", true, 4)], &["guides but no hair"], &[]);
    }

    #[test]
    fn what_unreal_makes_up_is_told_with_its_remedy() {
        let (hair, guides) = (|| output("hair", false, 4), || output("hair", true, 4));
        check(&[hair()], &[], &["Unreal picks some of the hairs"]);
        let bare = edited(hair(), |b| b.set(ROOT_UV, Domain::Curve, vec![Vec2::ZERO; 3]));
        check(&[bare, guides()], &[], &["lays a sphere about the hair"]);
        let uvs = vec![Vec2::X, Vec2::ZERO, Vec2::Y];
        let some = edited(hair(), |b| b.set(ROOT_UV, Domain::Curve, uvs.clone()));
        check(&[some, guides()], &[], &["1 of 3 roots have no uv"]);
        let mut b = TuftBuilder::even(vec![Vec3::ZERO, Vec3::Y], 2);
        b.set(ROOT_UV, Domain::Curve, vec![Vec2::X]);
        let curves = Curves::new(vec![Arc::new(b.build())]);
        check(&[HairGroup { curves, ..hair() }, guides()], &[], &["written 0.008 cm wide"]);
        check(&[hair(), output("other", true, 4)], &[], &["go with \"hair\""]);
        let lines = edited(output("lines", true, 4), |b| b.set(PARTING, Domain::Curve, vec![3]));
        check(&[hair(), guides(), lines], &[], &["lines of partings"]);
    }

    #[test]
    fn names_that_unreal_reads_otherwise_are_told() {
        let named = |name: &str| [output(name, false, 4), output(name, true, 4)];
        check(&named("none"), &[], &["for no name"]);
        check(&named("Zöpfe"), &[], &["beyond ASCII"]);
        check(&named(&"a".repeat(1024)), &[], &["at most 1023"]);
        check(&[named("Hair"), named("hair")].concat(), &[], &["in other case"]);
    }
}
