//! Partings: lines that cut the scalp into sections, drawn or from a pattern.
//!
//! methods.md 3, "partings first". Lines are brought to the flat map of the scalp, made uneven as asked, ended where they meet one
//! another or the hairline, and handed to [`crate::data::sections`], which does the cutting. The scalp that comes out is the one
//! that went in with its sections on it, so every node with a scalp input knows them.
//!
//! Guarantees: everything is measured on the head, so that a pattern fits another; on a symmetric head patterns are symmetric
//! but for wobble; a section's curves change only when it does. A drawn line that ends in the middle of hair parts what is beside
//! it and cuts no section, which is said.

use super::between::between;
use super::given::Maker;
use super::lines::{End, Uneven, end, fine, laid, uneven};
use super::pattern::{self, Cut, Drawn, Flat, Rows, Wish};
use super::territory::Row;
use crate::data::attributes::{DRIFT, Domain, ROOT_BARY, ROOT_TRIANGLE};
use crate::data::chart::{CELLS, Chart};
use crate::data::curves::{Curves, TuftBuilder};
use crate::data::scalp::{HEAD_RADIUS, Scalp};
use crate::data::sections::{Parting, Sections};
use crate::define::{FieldInput, NodeError, choice, node};
use crate::eval::EvalCx;
use crate::maths::hash::curve_id;
use crate::maths::spline::Spline;
use glam::{Vec2, Vec3};
use std::sync::Arc;

node! {
    /// Part the hair: cut the scalp into sections along drawn lines or in a pattern.
    ///
    /// Wire the scalp that comes out to the nodes that grow hair: none of it is rooted on a parting, and none is led by hair of
    /// another section. Braid along the rows, put puffs and free braids on the middles. A second Partings node cuts the
    /// sections of the first, in all of them or where a mask says; every section is a mask by its name.
    "partings", version 1, label "Partings", words "part parting section sections grid line cornrow canerow rows boxes triangles zigzag zig-zag halo brick pattern comb rat tail scalp divide split";
    inputs {
        /// The head, or a head that has partings already.
        scalp: Arc<Scalp>;
        /// Drawn partings. Lines that end near another one or near the hairline are brought to it.
        lines: Option<Curves>, words("strokes drawn");
        /// Rows that are drawn already: hair is parted half-way between each two that lie beside each other, so that every
        /// row has a section of its own. The output rows is these then.
        between: Option<Curves>, words("braids first rows neighbours half-way territory");
        /// Rows of a pattern, beside the drawn lines.
        pattern: Pattern = Pattern::None, words("rows generator cornrow layout style");
        /// How many rows: on both sides together, or rings.
        count: i64 = 8, hard(1.0, 100.0), soft(2.0, 24.0), unit(Count), words("number amount rows");
        /// What the rows are cut into.
        cells: Cells = Cells::Whole, words("box boxes triangle grid squares brick");
        /// Length of a box or triangle along its row. It is changed a little so that a row holds a whole number.
        cell_length: f32 = 2.5, hard(0.2, 50.0), soft(0.8, 6.0), unit(Length), words("size box");
        /// Lay boxes like bricks, each over the gap of the row before, which hides the partings.
        brick: bool = true, words("offset stagger");
        /// How far zig-zag lines go to each side. 0 is straight.
        zigzag: f32 = 0.0, hard(0.0, 10.0), soft(0.0, 1.0), unit(Length), words("zig zag amplitude lightning");
        /// Length of one zig and one zag.
        zigzag_period: f32 = 2.0, hard(0.1, 50.0), soft(0.5, 6.0), unit(Length), words("wavelength");
        /// How far lines stray as a hand's do. 0 is drawn with a ruler.
        wobble: f32 = 0.04, hard(0.0, 5.0), soft(0.0, 0.3), unit(Length), words("uneven hand natural random");
        /// Turns the rows about the head, or says how far curved rows sweep.
        turn: f32 = 0.0, hard(-180.0, 180.0), soft(-90.0, 90.0), unit(Angle), handle(Handle::Angle), words("rotate slant sweep");
        /// Where rows gather or what rings lie about, in the head frame (x to the head's left, y up, z forward), centimetres on a
        /// head of average size.
        centre: Vec3 = Vec3::new(0.0, 7.6, -4.6), handle(Handle::Point), words("center crown bun ponytail");
        /// Radius of the round section in which gathered rows end.
        gather_radius: f32 = 2.5, hard(0.1, 20.0), soft(0.5, 6.0), unit(Length), handle(Handle::Radius), words("bun ponytail tie");
        /// Lay the rows alike on both sides of the head.
        symmetric: bool = true, words("mirror");
        /// Where the pattern is drawn; usually the name of a section as a mask.
        area: FieldInput = 1.0, hard(0.0, 1.0), unit(Ratio), words("mask region front back section where");
        /// Width of the bare skin along a line.
        width: f32 = 0.16, hard(0.0, 5.0), soft(0.0, 0.5), unit(Length), words("gap skin line thickness");
        /// Line ends this near to another line or to the hairline are brought to it.
        join: f32 = 0.6, hard(0.0, 10.0), soft(0.0, 2.0), unit(Length), words("snap weld extend close");
        /// Names for sections: a name and a point in it, in the head frame as above, such as `left puff 4 7 -3; fringe 0 6 8`.
        names: Arc<str> = "", words("name label");
        /// Seed tag; stored, mixed into ids and randomness.
        seed: i64 = 0;
        /// Whether lengths grow with the size of the head.
        scale_with_head: bool = true, words("head units");
    }
    outputs {
        /// The head with its sections, for every node that asks for a scalp.
        scalp: Arc<Scalp>;
        /// The lines, lying on the scalp; over an ear or what is too rough to lie on, straight on.
        partings: Curves;
        /// The middle line of each section, from the hairline on, as wide as the section: to braid along. The round section
        /// that gathered rows end at has none. Where rows are drawn already, those, each with its section.
        rows: Curves;
        /// A short curve standing in the middle of each section: for free braids, twists and puffs.
        middles: Curves;
    }
}

choice! {
    /// How rows run.
    Pattern {
        /// Drawn lines only.
        None = "none",
        /// From the forehead straight back to the nape.
        StraightBack = "straight_back",
        /// From a middle parting round both sides of the head to the nape.
        Curved = "curved",
        /// From ear to ear.
        Across = "across",
        /// From the hairline all round to one point, for a bun or a ponytail.
        Gathered = "gathered",
        /// Rings round the head, as far from the hairline everywhere.
        Halo = "halo",
    }
}

choice! {
    /// What rows are cut into.
    Cells {
        /// Nothing: whole rows.
        Whole = "whole",
        /// Boxes.
        Boxes = "boxes",
        /// Triangles.
        Triangles = "triangles",
    }
}

fn eval(cx: &EvalCx, inputs: Inputs) -> Result<Outputs, NodeError> {
    let scalp = &*inputs.scalp;
    let unit = cx.head_unit(Some(scalp), inputs.scale_with_head);
    let chart = scalp.chart();
    cx.check()?;
    let part = part(&inputs, chart)?;
    let Drawn { mut lines, middles } = lines(cx, &inputs, unit, &part)?;
    cx.check()?;
    let old: Vec<Vec<Vec2>> = scalp
        .sections()
        .map_or(&[][..], |s| s.partings())
        .iter()
        .map(|p| p.points.iter().map(|p| chart.flat(*p)).collect())
        .collect();
    bring_together(cx, chart, &mut lines, &old, inputs.join * unit);
    cx.check()?;
    let mut partings = scalp.sections().map_or(vec![], |s| s.partings().to_vec());
    let before = partings.len();
    for line in &lines {
        let points = laid(scalp, chart, &line.points);
        let (of_pattern, half_width) = (!line.by_hand, 0.5 * inputs.width * unit);
        partings.push(Parting { id: line.id, points, of_pattern, half_width });
    }
    // Names given by a node before stay where they were put, unless this one names that section anew.
    let mut names = names(cx, &inputs.names, scalp);
    names.extend(scalp.sections().map_or(&[][..], Sections::given).iter().cloned());
    let (sections, said) = Sections::new(scalp, partings, &names);
    for text in said {
        cx.warn(text);
    }
    let area = |s: &crate::data::sections::Section| format!("{} {:.1} cm2", s.name, s.area);
    let list: Vec<String> = sections.list().iter().take(40).map(area).collect();
    cx.remark(format!("{} sections: {}", sections.list().len(), list.join(", ")));
    for (name, parts) in cut_up(scalp, &sections) {
        cx.remark(format!("{name:?} is cut into {parts}; the one about the name's point keeps it"));
    }
    let sections = Arc::new(sections);
    let parted = Arc::new(scalp.parted(sections.clone()));
    cx.check()?;
    let seed = inputs.seed as u64;
    let drawn = inputs.lines.iter().flat_map(|lines| lines.each());
    let drifted = drawn.filter(|(tuft, _)| tuft.attribute(DRIFT.name).is_some());
    let drift = drifted
        .map(|(tuft, i)| {
            let drift = tuft.view(DRIFT).at(i, tuft.range(i).start);
            (curve_id(tuft.id(i), seed, 0), drift)
        })
        .collect();
    let maker = Maker { scalp: &parted, chart, unit, seed, part: &part, drift };
    let lines = sections.partings()[before..].iter().map(|p| maker.parting(p));
    let partings = Curves::new(lines.flatten().map(Arc::new).collect());
    // What rows are gathered to is no row.
    let tied = (inputs.pattern == Pattern::Gathered)
        .then(|| sections.at(scalp.frame().point_from_head(gathered_to(&inputs) * HEAD_RADIUS)))
        .flatten()
        .map(|place| place.section);
    let rows = match &inputs.between {
        Some(rows) => maker.known_rows(cx, &sections, rows)?,
        None => maker.rows(cx, &sections, &middles, tied)?,
    };
    let middles = maker.middles(&sections);
    Ok(Outputs { scalp: parted, partings, rows, middles })
}

/// The cells of the map on which the pattern is drawn.
fn part(inputs: &Inputs, chart: &Chart) -> Result<Vec<bool>, NodeError> {
    let scalp = &*inputs.scalp;
    let spots = chart.spots();
    let grows = spots.iter().map(|spot| spot.grows > 0.0);
    if inputs.area.constant() == Some(1.0) {
        return Ok(grows.collect());
    }
    // Fields read roots: those of all cells where hair grows, as curves of one point.
    let cells: Vec<usize> = (0..CELLS * CELLS).filter(|c| spots[*c].grows > 0.0).collect();
    let mut near = 0;
    let hit = |c: &usize| {
        let hit = scalp.surface().closest_from(spots[*c].point, near)?;
        near = hit.triangle;
        Some(hit)
    };
    let hits: Vec<_> = cells.iter().filter_map(hit).collect();
    let mut b = TuftBuilder::even(hits.iter().map(|h| h.point).collect(), 1);
    b.set(ROOT_TRIANGLE, Domain::Curve, hits.iter().map(|h| h.triangle as i32).collect());
    b.set(ROOT_BARY, Domain::Curve, hits.iter().map(|h| h.bary).collect());
    let tuft = b.build();
    let area = inputs.area.on(&tuft, Some(scalp))?;
    let mut out = vec![false; CELLS * CELLS];
    for (slot, cell) in cells.into_iter().enumerate().take(hits.len()) {
        out[cell] = area.at(slot, slot, 0.0) >= 0.5;
    }
    Ok(out)
}

/// Drawn lines and those of the pattern, on the map.
fn lines(cx: &EvalCx, inputs: &Inputs, unit: f32, part: &[bool]) -> Result<Drawn, NodeError> {
    let scalp = &*inputs.scalp;
    let chart = scalp.chart();
    let mut drawn = Drawn::default();
    for (tuft, i) in inputs.lines.iter().flat_map(|curves| curves.each()) {
        let id = tuft.id(i);
        let spline = match Spline::new(tuft.curve(i)) {
            Ok(spline) => spline,
            Err(fault) => {
                cx.trouble(id, fault);
                continue;
            }
        };
        let n = ((spline.length() / 0.2).ceil() as usize).clamp(2, 4096);
        let mut points = Vec::with_capacity(n);
        spline.resample(n, |p| points.push(chart.flat(p)));
        let (first, last) = (spline.at(0.0), spline.at(1.0));
        let closed = first.distance(last) < (inputs.join * unit).min(0.25 * spline.length());
        if closed {
            points.push(points[0]);
        }
        let id = curve_id(id, inputs.seed as u64, 0);
        drawn.lines.push(Flat { id, points, closed, tied: [false; 2], row: true, by_hand: true });
    }
    let rows = match inputs.pattern {
        Pattern::None => None,
        Pattern::StraightBack => Some(Rows::Back),
        Pattern::Curved => Some(Rows::Curved),
        Pattern::Across => Some(Rows::Across),
        Pattern::Gathered => Some(Rows::Gathered),
        Pattern::Halo => Some(Rows::Rings),
    };
    if let Some(rows) = rows {
        let wish = Wish {
            rows,
            count: inputs.count as usize,
            cut: match inputs.cells {
                Cells::Whole => Cut::Whole,
                Cells::Boxes => Cut::Boxes,
                Cells::Triangles => Cut::Triangles,
            },
            cell: inputs.cell_length * unit,
            brick: inputs.brick,
            turn: inputs.turn.to_radians(),
            centre: gathered_to(inputs),
            gather: inputs.gather_radius * unit,
            mirror: inputs.symmetric,
            tag: curve_id(0, inputs.seed as u64, 0x9A77),
        };
        let pattern = pattern::drawn(chart, scalp.frame(), part, &wish);
        drawn.lines.extend(pattern.lines);
        drawn.middles = pattern.middles;
    }
    let mut beside = vec![];
    for (tuft, i) in inputs.between.iter().flat_map(|curves| curves.each()) {
        match Row::new(tuft.id(i), tuft.curve(i)) {
            Ok(row) => beside.push(row),
            Err(fault) => cx.trouble(tuft.id(i), fault),
        }
    }
    if beside.len() > 1 {
        drawn.lines.extend(between(cx, scalp, part, beside, inputs.seed as u64)?);
    }
    let how = Uneven {
        amplitude: inputs.zigzag * unit,
        period: inputs.zigzag_period * unit,
        wobble: inputs.wobble * unit,
        dice: cx.dice(inputs.seed, "wobble"),
    };
    for line in &mut drawn.lines {
        uneven(chart, line, &how);
        line.points = fine(chart, &line.points);
    }
    Ok(drawn)
}

/// Where rows gather, as a direction of the head frame.
fn gathered_to(inputs: &Inputs) -> Vec3 {
    inputs.centre.try_normalize().unwrap_or(Vec3::Y)
}

/// How far a line of a pattern is led on, cm.
const FARTHEST: f32 = 4.0;

/// Ends lines where they meet: rows first, then what cuts rows. Rows twice, for what one was ended at may itself have been
/// ended nearer since.
fn bring_together(cx: &EvalCx, chart: &Chart, lines: &mut [Flat], old: &[Vec<Vec2>], join: f32) {
    let mut loose_ends = 0;
    for (rows, last) in [(true, false), (true, true), (false, true)] {
        for i in 0..lines.len() {
            if lines[i].row != rows || lines[i].closed {
                continue;
            }
            let mut points = std::mem::take(&mut lines[i].points);
            let mine = lines.iter().enumerate().filter(|(k, line)| *k != i && line.row);
            let others: Vec<&[Vec2]> = old
                .iter()
                .map(Vec::as_slice)
                .chain(mine.map(|(_, line)| line.points.as_slice()))
                .collect();
            // What cuts a row reaches over by a share of the row, which may be more.
            let join = if rows { join } else { join.max(2.0) };
            // Lines of a pattern go on until they meet something.
            let reach = if lines[i].by_hand { join } else { join.max(FARTHEST) };
            let mut loose = 0;
            let [first, last_tied] = lines[i].tied;
            for tied in [last_tied, first] {
                let end = match tied {
                    true => End::Met,
                    false => end(chart, &mut points, &others, [join, reach]),
                };
                loose += usize::from(end == End::Loose);
                points.reverse();
            }
            // What of a pattern parts nothing is left out when the scalp is cut.
            if loose > 0 && last && lines[i].by_hand {
                loose_ends += 1;
            }
            lines[i].points = points;
        }
    }
    if loose_ends > 0 {
        cx.remark(format!(
            "{loose_ends} partings end in the middle of hair: they part it and cut no section"
        ));
    }
}

/// The named sections of a scalp that are several now, and how many.
fn cut_up(scalp: &Scalp, now: &Sections) -> Vec<(String, usize)> {
    let Some(before) = scalp.sections() else { return vec![] };
    let parts = |old: u32| {
        now.list()
            .iter()
            .filter(|s| before.at(s.middle).is_some_and(|at| at.section == old))
            .count()
    };
    let mut out = vec![];
    for (name, _) in before.given() {
        let Some(old) = before.named(name) else { continue };
        let parts = parts(old);
        if parts > 1 {
            out.push((name.clone(), parts));
        }
    }
    out
}

/// Given names with their points, read from text.
fn names(cx: &EvalCx, text: &str, scalp: &Scalp) -> Vec<(String, Vec3)> {
    let mut out = vec![];
    for entry in text.split([';', '\n']).map(str::trim).filter(|e| !e.is_empty()) {
        let words: Vec<&str> = entry.split_whitespace().collect();
        let at = words.len().saturating_sub(3);
        let numbers: Vec<f32> = words[at..].iter().filter_map(|w| w.parse().ok()).collect();
        match numbers[..] {
            [x, y, z] if at > 0 && x.is_finite() && y.is_finite() && z.is_finite() => {
                let p = scalp.frame().point_from_head(Vec3::new(x, y, z));
                out.push((words[..at].join(" "), p));
            }
            _ => cx.warn(format!("{entry:?} is no name with a point, such as \"fringe 0 6 8\"")),
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::attributes::{ID, PARENT, PARTING, RADIUS, SECTION};
    use crate::data::field::Field;
    use crate::define::Value;
    use crate::testing::{curves_of, run};
    use std::collections::BTreeMap;

    fn head() -> Arc<Scalp> {
        static HEAD: std::sync::OnceLock<Arc<Scalp>> = std::sync::OnceLock::new();
        let make = || match run(crate::by_id("head").unwrap(), &[]).0.remove(0) {
            Value::Scalp(scalp) => scalp,
            other => panic!("a {}", other.type_name()),
        };
        HEAD.get_or_init(make).clone()
    }
    fn scalp_of(value: &Value) -> Arc<Scalp> {
        match value {
            Value::Scalp(scalp) => scalp.clone(),
            other => panic!("a {}", other.type_name()),
        }
    }
    #[track_caller]
    fn part(scalp: &Arc<Scalp>, set: &[(&str, Value)]) -> (Vec<Value>, Vec<String>) {
        let (out, mut said) = run(&NODE, &[&[("scalp", scalp.clone().into())], set].concat());
        said.retain(|s| !["sections:", "lengths"].iter().any(|word| s.contains(word)));
        (out, said)
    }

    #[test]
    fn every_pattern_cuts_the_head_into_the_sections_that_were_asked_for() {
        let check =
            |pattern: &str, count: i64, cells: &str, want: std::ops::RangeInclusive<usize>| {
                let set = [
                    ("pattern", pattern.into()),
                    ("count", Value::Int(count)),
                    ("cells", cells.into()),
                ];
                let (out, said) = part(&head(), &set);
                let what = format!("{pattern} {cells}");
                assert!(said.is_empty(), "{what}: {said:?}");
                let scalp = scalp_of(&out[0]);
                let list = scalp.sections().unwrap().list();
                assert!(want.contains(&list.len()), "{what}: {}", list.len());
                let ids: std::collections::BTreeSet<u64> = list.iter().map(|s| s.id).collect();
                assert_eq!(ids.len(), list.len(), "{what}: ids are unique");
                let mean = list.iter().map(|s| s.area).sum::<f32>() / list.len() as f32;
                let least = list.iter().map(|s| s.area).fold(f32::MAX, f32::min);
                // The middle of rings is small, and so are cells beside the ears.
                let small = match (pattern, cells) {
                    ("halo", _) => 0.05,
                    (_, "whole") => 0.2,
                    _ => 0.05,
                };
                assert!(least > small * mean, "{what}: {least} where {mean} is the mean");
                assert_eq!(curves_of(&out[3]).curve_count(), list.len(), "{what}");
                assert!(curves_of(&out[2]).curve_count() + 1 >= list.len(), "{what}");
                // But where they go on over an ear.
                let lines: Vec<Vec3> =
                    curves_of(&out[1]).each().flat_map(|(t, i)| t.curve(i).to_vec()).collect();
                let off = |p: &&Vec3| scalp.surface().closest(**p).unwrap().distance > 1e-3;
                let off = lines.iter().filter(off).count();
                assert!(off * 50 <= lines.len(), "{what}: {off} of {}", lines.len());
            };
        check("straight_back", 9, "whole", 9..=9);
        check("straight_back", 6, "whole", 6..=6);
        check("curved", 8, "whole", 8..=8);
        check("across", 7, "whole", 7..=7);
        check("gathered", 12, "whole", 13..=13);
        check("halo", 4, "whole", 5..=5);
        check("halo", 4, "boxes", 60..=110);
        check("across", 9, "boxes", 60..=120);
        check("across", 7, "triangles", 80..=180);
    }

    #[test]
    fn rows_run_in_their_section_as_wide_as_it_is() {
        let (out, _) = part(&head(), &[("pattern", "straight_back".into())]);
        let scalp = scalp_of(&out[0]);
        let sections = scalp.sections().unwrap();
        for (tuft, i) in curves_of(&out[2]).each() {
            let points = tuft.curve(i);
            for (k, p) in points.iter().enumerate().skip(2).take(points.len() - 4) {
                assert_eq!(sections.id_at(*p), Some(tuft.view(SECTION).at(i, 0)));
                let (half, to) = (tuft.view(RADIUS).at(i, k), sections.at(*p).unwrap().distance);
                assert!(half < 4.0 && half > 0.5 * to.min(half), "{half} {to}");
            }
            // From the forehead to the nape.
            assert!(points[0].z > points[points.len() - 1].z + 5.0);
        }
    }

    #[test]
    fn rows_that_are_drawn_already_are_parted_half_way_between_them() {
        let (out, _) = part(&head(), &[("pattern", "straight_back".into())]);
        let rows = curves_of(&out[2]).clone();
        let between = |rows: &Curves| {
            let set = [("between", Value::from(rows.clone())), ("wobble", Value::Float(0.0))];
            let (out, said) = part(&head(), &set);
            assert!(said.is_empty(), "{said:?}");
            (scalp_of(&out[0]), curves_of(&out[1]).clone())
        };
        let (scalp, lines) = between(&rows);
        let sections = scalp.sections().unwrap();
        assert_eq!(sections.list().len(), rows.curve_count());
        let own: std::collections::BTreeSet<u64> = rows
            .each()
            .map(|(tuft, i)| {
                let ids: Vec<Option<u64>> =
                    tuft.curve(i).iter().skip(1).map(|p| sections.id_at(*p)).collect();
                assert!(ids.windows(2).all(|w| w[0] == w[1]), "a row leaves its section");
                ids[0].unwrap()
            })
            .collect();
        assert_eq!(own.len(), rows.curve_count(), "each row has a section of its own");
        let known: Vec<Row> =
            rows.each().map(|(tuft, i)| Row::new(tuft.id(i), tuft.curve(i)).unwrap()).collect();
        // Half-way but where a line is led straight on to the hairline, beyond the rows' ends.
        let mut off: Vec<f32> = vec![];
        for p in lines.each().flat_map(|(tuft, i)| tuft.curve(i)) {
            let mut far: Vec<f32> = known.iter().map(|row| row.nearest(*p).1).collect();
            far.sort_by(f32::total_cmp);
            off.push(far[1] - far[0]);
        }
        off.sort_by(f32::total_cmp);
        let (most, last) = (off[off.len() * 95 / 100], off[off.len() - 1]);
        assert!(most < 0.1 && last < 0.3, "{most} {last}");
        // A row that has drifted still tells how far; and so does a parting that was drawn.
        let mut b = rows.tufts()[0].edit();
        b.set(DRIFT, Domain::Curve, vec![0.25]);
        let drifted = Curves::new(vec![Arc::new(b.build()), rows.tufts()[1].clone()]);
        let set = [("between", Value::from(drifted.clone())), ("lines", drifted.into())];
        let (out, _) = part(&head(), &set);
        let told = |curves: &Curves| -> Vec<f32> {
            let each = curves.each().filter(|(tuft, _)| tuft.attribute(DRIFT.name).is_some());
            each.map(|(tuft, i)| tuft.view(DRIFT).at(i, tuft.range(i).start)).collect()
        };
        assert_eq!(told(curves_of(&out[1])), [0.25]);
        assert_eq!(told(curves_of(&out[2])), [0.25]);
        assert!(curves_of(&out[1]).each().all(|(tuft, i)| tuft.view(PARTING).at(i, 0) != 0));
        // What lies beside other rows stays what it is.
        let ids = |lines: &Curves| -> std::collections::BTreeSet<u64> {
            lines.each().map(|(tuft, i)| tuft.id(i)).collect()
        };
        let fewer = Curves::new(rows.tufts()[1..].to_vec());
        let (_, fewer) = between(&fewer);
        assert!(ids(&fewer).intersection(&ids(&lines)).count() + 2 >= ids(&fewer).len());
    }

    #[test]
    fn rows_that_lie_about_scattered_have_a_section_each() {
        let check = |count: i64, apart: f32| {
            let scatter = crate::by_id("scatter_guides").unwrap();
            let set = [
                ("scalp", head().into()),
                ("count", Value::Int(count)),
                ("min_distance", Value::Float(apart)),
                ("length", Value::Float(0.4 * apart)),
                ("lie", Value::Float(0.0)),
            ];
            let rows = curves_of(&run(scatter, &set).0[0]).clone();
            assert_eq!(rows.curve_count(), count as usize);
            let (out, said) = part(&head(), &[("between", rows.clone().into())]);
            assert!(said.is_empty(), "{said:?}");
            let scalp = scalp_of(&out[0]);
            let sections = scalp.sections().unwrap();
            let own: std::collections::BTreeSet<u64> =
                rows.each().filter_map(|(tuft, i)| sections.id_at(tuft.curve(i)[0])).collect();
            let (n, each) = (sections.list().len(), own.len());
            // Narrow strips behind the ears are too small to cut.
            assert!(n == each && each * 100 >= rows.curve_count() * 95, "{n} {each} of {count}");
        };
        check(20, 3.0);
        check(60, 2.0);
        check(120, 1.5);
    }

    #[test]
    fn hair_wired_where_rows_belong_is_refused() {
        let mut b = TuftBuilder::new();
        for k in 0..5000 {
            let x = k as f32 * 1e-3;
            b.push_curve(&[Vec3::new(x, 9.0, 0.0), Vec3::new(x, 9.0, 1.0)]);
        }
        b.set(crate::data::attributes::ID, Domain::Curve, (1..=5000).collect::<Vec<u64>>());
        let hair = Curves::new(vec![Arc::new(b.build())]);
        let set = [("scalp", head().into()), ("between", Value::from(hair))];
        let fault = crate::testing::fails(&NODE, &set);
        assert!(fault.contains("5000 rows") && fault.contains("4096"), "{fault}");
    }

    #[test]
    fn a_second_node_cuts_the_sections_of_the_first_where_a_mask_says() {
        let half = [("pattern", "across".into()), ("count", Value::Int(2))];
        let names = [("names", "front 0 7 6; back 0 3 -8".into()), ("seed", Value::Int(1))];
        let (out, _) = part(&head(), &[&half[..], &names].concat());
        let parted = scalp_of(&out[0]);
        let set = [
            ("pattern", "straight_back".into()),
            ("count", Value::Int(6)),
            ("area", Field::Mask("front".into()).into()),
        ];
        let (out, said) = part(&parted, &set);
        assert_eq!(said, ["\"front\" is cut into 6; the one about the name's point keeps it"]);
        let scalp = scalp_of(&out[0]);
        assert_eq!(scalp.sections().unwrap().list().len(), 7);
        assert_eq!(curves_of(&out[2]).curve_count(), 6);
        assert!(std::ptr::eq(scalp.surface(), head().surface()), "the head itself is shared");
        assert_ne!(scalp.key(), parted.key());
    }

    #[test]
    fn hair_keeps_to_its_section_and_off_the_partings() {
        let set = [("pattern", "straight_back".into()), ("width", Value::Float(0.3))];
        let (out, _) = part(&head(), &set);
        let (scalp, number) = (scalp_of(&out[0]), Value::Int(400));
        let guides = crate::by_id("scatter_guides").unwrap();
        let (grown, _) = run(guides, &[("scalp", scalp.clone().into()), ("count", number)]);
        // A guide says by its width which section it stands in.
        let sections = scalp.sections().unwrap();
        let hair = crate::by_id("interpolate").unwrap();
        let set = [
            ("guides", grown[0].clone()),
            ("scalp", scalp.clone().into()),
            ("density", Value::Float(20.0)),
        ];
        let (hair, _) = run(hair, &set);
        let home: BTreeMap<u64, u64> = curves_of(&grown[0])
            .each()
            .map(|(t, i)| (t.id(i), sections.id_at(t.curve(i)[0]).unwrap()))
            .collect();
        let mut hairs = 0;
        for (tuft, i) in curves_of(&hair[0]).each() {
            let place = sections.at(tuft.curve(i)[0]).unwrap();
            assert!(place.distance >= 0.15, "{place:?}");
            let id = sections.list()[place.section as usize].id;
            assert_eq!(tuft.view(SECTION).at(i, 0), id);
            assert_eq!(home[&tuft.view(PARENT).at(i, 0)], id);
            hairs += 1;
        }
        assert!(hairs > 5000, "{hairs}");
    }

    #[test]
    fn hair_drawn_to_the_middle_of_its_box_crosses_no_parting() {
        let set = [
            ("pattern", "across".into()),
            ("cells", "boxes".into()),
            ("cell_length", Value::Float(3.0)),
            ("width", Value::Float(0.2)),
            ("wobble", Value::Float(0.05)),
        ];
        let (out, said) = part(&head(), &set);
        assert!(said.is_empty(), "{said:?}");
        let scalp = scalp_of(&out[0]);
        let sections = scalp.sections().unwrap();
        let set = [
            ("guides", out[3].clone()),
            ("scalp", scalp.clone().into()),
            ("density", Value::Float(30.0)),
            ("guides_per_hair", Value::Int(1)),
            ("clump", Value::Float(1.0)),
            ("points", Value::Int(7)),
        ];
        let (hair, _) = run(crate::by_id("interpolate").unwrap(), &set);
        let (mut hairs, mut crossing) = (0, 0);
        for (tuft, i) in curves_of(&hair[0]).each() {
            let points = tuft.curve(i);
            let on_skin = |p: &Vec3| scalp.surface().closest(*p).unwrap().point;
            let way: Vec<Vec3> = points.iter().map(on_skin).collect();
            let home = sections.id_at(points[0]);
            // Where no hair grows, as behind an ear, is no other section.
            let elsewhere = |p: &Vec3| sections.id_at(*p).is_some_and(|id| Some(id) != home);
            let passes = sections.is_over_line(points);
            let strays = passes || way[1..].iter().any(elsewhere);
            (hairs, crossing) = (hairs + 1, crossing + usize::from(strays));
        }
        assert!(hairs > 10_000 && crossing == 0, "{crossing} of {hairs}");
    }

    #[test]
    fn a_parting_that_ends_in_hair_parts_the_hair_beside_it_and_curls_keep_off_it() {
        let whole = head();
        let on_skin = |p: Vec3| whole.closest_root(p).unwrap();
        // From the forehead over the top, where it ends.
        let line: Vec<Vec3> =
            (0..=24).map(|k| on_skin(Vec3::new(2.0, 11.0, 7.0 - 0.4 * k as f32)).point).collect();
        let mut b = TuftBuilder::new();
        b.push_curve(&line);
        b.set(ID, Domain::Curve, vec![5]);
        let drawn = Curves::new(vec![Arc::new(b.build())]);
        let set = [("lines", drawn.into()), ("wobble", Value::Float(0.0))];
        let (out, said) = part(&whole, &set);
        assert!(said.len() == 1 && said[0].contains("cut no section"), "{said:?}");
        let scalp = scalp_of(&out[0]);
        let sections = scalp.sections().unwrap();
        assert_eq!(sections.list().len(), 1);
        // Hair swept aside, each from its own side of the line.
        let set = [("scalp", scalp.clone().into()), ("count", Value::Int(900))];
        let (grown, _) = run(crate::by_id("scatter_guides").unwrap(), &set);
        let swept = curves_of(&grown[0]).each().map(|(tuft, i)| {
            let root = tuft.curve(i)[0];
            let aside = Vec3::X * (root.x - 2.0).signum() * 0.4;
            let mut b = TuftBuilder::new();
            let mut points = vec![root];
            for k in 0..8 {
                let next = on_skin(points[k] + aside);
                points.push(next.point + next.normal * 0.06);
            }
            b.push_curve(&points);
            b.set(ID, Domain::Curve, vec![tuft.id(i)]);
            Arc::new(b.build())
        });
        let guides = Curves::new(swept.collect());
        let over = |curves: &Curves| {
            let leads = |points: &[Vec3]| sections.is_over_line(points);
            curves.each().filter(|(tuft, i)| leads(tuft.curve(*i))).count()
        };
        let grow = |scalp: &Arc<Scalp>| {
            let set = [
                ("guides", guides.clone().into()),
                ("scalp", scalp.clone().into()),
                ("density", Value::Float(60.0)),
                ("clump", Value::Float(0.7)),
            ];
            run(crate::by_id("interpolate").unwrap(), &set).0.remove(0)
        };
        let curl = |hair: &Value, scalp: &Arc<Scalp>| {
            let set = [
                ("curves", hair.clone()),
                ("scalp", scalp.clone().into()),
                ("preset", "2b".into()),
                ("diameter", Value::Float(1.6)),
                ("pitch", Value::Float(2.0)),
            ];
            run(crate::by_id("shape_list_curl").unwrap(), &set).0.remove(0)
        };
        let (hair, without) = (grow(&scalp), grow(&whole));
        let n = curves_of(&hair).curve_count();
        assert!(n > 10_000, "{n}");
        let unparted = over(curves_of(&without));
        assert!(over(curves_of(&hair)) == 0 && unparted > 50, "{unparted}");
        let (curled, free) = (curl(&hair, &scalp), curl(&hair, &whole));
        let (kept, crossing) = (over(curves_of(&curled)), over(curves_of(&free)));
        assert!(kept == 0 && crossing > 10, "{kept} of {crossing}");
        // What would lead over none is the same.
        let (curled, free) = (curves_of(&curled), curves_of(&free));
        assert_eq!(curled.curve_count(), n);
        let changed = curled.each().zip(free.each());
        let changed = changed.filter(|((a, i), (b, j))| a.curve(*i) != b.curve(*j)).count();
        assert_eq!(changed, crossing);
    }

    #[test]
    fn hair_that_hangs_from_its_box_gathers_before_it_leaves_it() {
        let check = |cells: &str, lost: f32| {
            let set = [("count", Value::Int(9)), ("cells", cells.into())];
            let (out, _) = part(&head(), &set);
            let scalp = scalp_of(&out[0]);
            let sections = scalp.sections().unwrap();
            let set = [("roots", out[3].clone()), ("scalp", scalp.clone().into())];
            let set = [&set[..], &[("length", Value::Float(12.0))]].concat();
            let (hung, _) = run(crate::by_id("hang").unwrap(), &set);
            let over = |points: &[Vec3]| sections.is_over_line(points);
            // A guide that itself lies over a parting leads its hair there.
            let low: Vec<u64> = curves_of(&hung[0])
                .each()
                .filter(|(tuft, i)| over(tuft.curve(*i)))
                .map(|(tuft, i)| tuft.id(i))
                .collect();
            assert!(low.len() * 8 < curves_of(&hung[0]).curve_count(), "{cells}: {low:?}");
            let set = [
                ("guides", hung[0].clone()),
                ("scalp", scalp.clone().into()),
                ("density", Value::Float(20.0)),
                ("clump", Value::Float(0.9)),
                ("points", Value::Int(40)),
            ];
            let (hair, said) = run(crate::by_id("interpolate").unwrap(), &set);
            let hair = curves_of(&hair[0]);
            let crossing = hair
                .each()
                .filter(|(tuft, i)| !low.contains(&tuft.view(PARENT).at(*i, 0)))
                .filter(|(tuft, i)| over(tuft.curve(*i)))
                .count();
            assert_eq!(crossing, 0, "{cells}");
            // What is left out is told with its number.
            let told = said.iter().find(|line| line.contains("left out")).map_or(0.0, |line| {
                let number = line.split_once(" (").map(|(_, rest)| rest.split(' ').next());
                number.flatten().and_then(|n| n.parse().ok()).unwrap_or(f32::NAN)
            });
            let share = told / hair.curve_count() as f32;
            assert!(hair.curve_count() > 7_000 && share < lost, "{cells}: {share} {said:?}");
        };
        check("boxes", 0.02);
        check("triangles", 0.06);
    }
}
