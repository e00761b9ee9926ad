//! Partings: lines that cut the scalp into sections, drawn or from a pattern.
//!
//! methods.md 3, "partings first". Lines are projected to the flat map of the scalp, made uneven as requested, ended
//! where they meet each other or the hairline, and passed to [`crate::data::sections`], which does the cutting. The
//! output is the input scalp with its sections, so every node with a scalp input knows them.
//!
//! Guarantees: everything is measured on the head, so that a pattern fits another head; on a symmetric head patterns
//! are symmetric except for wobble; a section's curves change only if the section does. A drawn line that ends in the
//! middle of hair parts the hair beside it and cuts no section, which is reported.

use super::given::Maker;
use super::lines::{LineEnd, Uneven, end, fine, laid, uneven};
use super::midlines::between;
use super::pattern::{self, CellShape, Flat, PatternLines, PatternParams, Rows};
use crate::data::attributes::DRIFT;
use crate::data::chart::{CELLS, Chart, cell_of};
use crate::data::curves::{Curves, Tuft};
use crate::data::scalp::{HEAD_RADIUS, HeadSpace, Scalp};
use crate::data::sections::{Parting, Sections, named_points};
use crate::define::{FieldInput, NodeError, choice, node};
use crate::eval::EvalCx;
use crate::maths::hash::curve_id;
use crate::maths::spline::Spline;
use crate::scalp::territory::Row;
use glam::{Vec2, Vec3};
use std::sync::Arc;

node! {
    /// Parts the hair: cuts the scalp into sections along drawn lines or in a pattern.
    ///
    /// Wire the resulting scalp to every node that grows hair: nothing roots in a parting, and hair is not shaped by
    /// guides of another section. Braid along the rows; put puffs and free braids on the middles. A second Partings
    /// node cuts the sections again, all of them or where a mask says. Each section is a mask by its name, and keeps
    /// that name for all its parts when it is cut again. On animals and other meshes, only drawn lines cut, along the
    /// triangles; patterns need a head.
    "partings", version 1, label "Partings", words "part parting section sections grid line cornrow canerow rows boxes triangles zigzag zig-zag halo brick pattern comb rat tail scalp divide split", scales;
    inputs {
        /// The head; it may have partings already.
        scalp: Arc<Scalp>;
        /// Drawn partings. Ends near another line or the hairline snap to it.
        lines: Option<Curves>, words("strokes drawn");
        /// Rows that are already drawn. The hair is parted halfway between neighbouring rows, so that each row gets its
        /// own section. The rows output then returns these rows.
        between: Option<Curves>, words("braids first rows neighbours half-way territory");
        /// Part only where neighbouring rows leave each other by more than this angle, as drawn hair does at a parting. 0 parts between
        /// all rows.
        leave: f32 = 0.0, hard(0.0, 180.0), soft(0.0, 120.0), unit(Angle), words("diverge flow strokes hair natural");
        /// Pattern of rows, added to the drawn lines.
        pattern: Pattern = Pattern::None, words("rows generator cornrow layout style");
        /// Number of rows (both sides together), or of rings.
        count: i64 = 8, hard(1.0, 100.0), soft(2.0, 24.0), unit(Count), words("number amount rows");
        /// What the rows are cut into.
        cells: Cells = Cells::Whole, words("box boxes triangle grid squares brick");
        /// Length of a box or triangle along its row, adjusted so that a whole number fits.
        cell_length: f32 = 2.5, hard(0.2, 50.0), soft(0.8, 6.0), unit(Length), words("size box");
        /// Stagger boxes like bricks, so that the partings do not line up.
        brick: bool = true, words("offset stagger");
        /// Width of the bare skin along a line.
        width: f32 = 0.16, hard(0.0, 5.0), soft(0.0, 0.5), unit(Length), words("gap skin line thickness");

        [Placement]
        /// Where the pattern is drawn; usually the name of a section, as a mask.
        area: FieldInput = 1.0, hard(0.0, 1.0), unit(Ratio), words("mask region front back section where");
        /// Names for sections, each with a point inside it in the head frame, such as `left puff 4 7 -3; fringe 0 6 8`.
        names: Arc<str> = "", words("name label");

        [Shape]
        /// Amplitude of a zigzag parting, to each side. 0 is straight.
        zigzag: f32 = 0.0, hard(0.0, 10.0), soft(0.0, 1.0), unit(Length), words("zig zag amplitude lightning");
        /// Length of one full zigzag.
        zigzag_period: f32 = 2.0, hard(0.1, 50.0), soft(0.5, 6.0), unit(Length), words("wavelength");
        /// Rotation of the rows around the head, or the sweep of curved rows.
        turn: f32 = 0.0, hard(-180.0, 180.0), soft(-90.0, 90.0), unit(Angle), handle(Handle::Angle), words("rotate slant sweep");
        /// Point where rows gather or that rings surround, in the head frame (x to the head's left, y up, z forward),
        /// in head units.
        centre: Vec3 = Vec3::new(0.0, 7.6, -4.6), handle(Handle::Point), words("center crown bun ponytail");
        /// Radius of the round section that gathered rows end at.
        gather_radius: f32 = 2.5, hard(0.1, 20.0), soft(0.5, 6.0), unit(Length), handle(Handle::Radius), words("bun ponytail tie");
        /// Mirror the rows across the midline.
        symmetric: bool = true, words("mirror");

        [Detail]
        /// Line ends within this distance of another line or the hairline snap to it.
        join: f32 = 0.6, hard(0.0, 10.0), soft(0.0, 2.0), unit(Length), words("snap weld extend close");
        /// Scale lengths with the size of the head.
        scale_with_head: bool = true, words("head units");

        [Randomness]
        /// Random deviation of the lines, as drawn by hand. 0 is ruler-straight.
        wobble: f32 = 0.04, hard(0.0, 5.0), soft(0.0, 0.3), unit(Length), words("uneven hand natural random");
        /// Random seed for this node. It changes ids too.
        seed: i64 = 0;
    }
    outputs {
        /// The head with its sections, for every node with a scalp input.
        scalp: Arc<Scalp>;
        /// The parting lines on the scalp. Over ears and rough skin they run straight.
        partings: Curves;
        /// Centre line of each section, starting at the hairline, as wide as the section, to braid along; or the rows
        /// given, each with its section. The round section of a gathered pattern has none.
        rows: Curves;
        /// A short curve standing in the middle of each section, for free braids, twists and puffs.
        middles: Curves;
    }
}

choice! {
    /// Layout of the rows.
    Pattern {
        /// Drawn lines only.
        None = "none",
        /// From the forehead straight back to the nape.
        StraightBack = "straight_back",
        /// From a middle parting around both sides of the head to the nape.
        Curved = "curved",
        /// From ear to ear.
        Across = "across",
        /// From all around the hairline to one point, for a bun or ponytail.
        Gathered = "gathered",
        /// Rings around the head, each at a constant distance from the hairline.
        Halo = "halo",
    }
}

choice! {
    /// What rows are cut into.
    Cells {
        /// Whole rows.
        Whole = "whole",
        /// Boxes.
        Boxes = "boxes",
        /// Triangles.
        Triangles = "triangles",
    }
}

fn eval(cx: &EvalCx, inputs: Inputs) -> Result<Outputs, NodeError> {
    let scalp = &*inputs.scalp;
    let chart = scalp.chart();
    cx.check()?;
    let mut partings = scalp.sections().map_or(vec![], |s| s.partings().to_vec());
    let before: Vec<u64> = partings.iter().map(|p| p.id).collect();
    let mut before = before.into_iter();
    let is_on_map = scalp.is_on_map();
    let (mut part, mut middles) = (vec![], vec![]);
    if is_on_map {
        part = self::part(&inputs, chart)?;
        middles = on_the_map(cx, &inputs, &part, &mut partings)?;
    } else {
        on_the_mesh(cx, &inputs, &mut partings)?;
    }
    let (mut names, faults) = named_points(&inputs.names);
    names.iter_mut().for_each(|(_, p)| *p = scalp.place(*p));
    faults.into_iter().for_each(|fault| cx.warn(fault));
    let (sections, said) = Sections::new(scalp, partings, &names);
    for text in said {
        cx.warn(text);
    }
    let area = |s: &crate::data::sections::Section| format!("{} {:.1} cm2", s.name, s.area);
    let list: Vec<String> = sections.list().iter().take(40).map(area).collect();
    cx.remark(format!("{} sections: {}", sections.list().len(), list.join(", ")));
    for (name, parts) in sections.names().each().filter(|(_, parts)| parts.len() > 1).take(40) {
        let part = |number: &u32| sections.list()[*number as usize].name.as_str();
        let list: Vec<&str> = parts.iter().take(8).map(part).collect();
        let more = if parts.len() > 8 { ", ..." } else { "" };
        cx.remark(format!("{name:?} means {} sections: {}{more}", parts.len(), list.join(", ")));
    }
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
    let maker = Maker { scalp: &parted, chart, unit: cx.unit(), seed, part: &part, drift };
    // What cuts nothing is not kept, of those that were there too.
    let was_there = sections.partings().iter().take_while(|p| before.any(|id| id == p.id)).count();
    let lines = sections.partings()[was_there..].iter().map(|p| maker.parting(p));
    let partings = Curves::new(lines.flatten().map(Arc::new).collect());
    // The section that rows gather to is not a row.
    let tied = (inputs.pattern == Pattern::Gathered)
        .then(|| {
            sections.at(scalp.frame().point_from_head(gathered_to(&inputs, scalp) * HEAD_RADIUS))
        })
        .flatten()
        .map(|place| place.section);
    let rows = match &inputs.between {
        _ if !is_on_map => Curves::default(),
        Some(rows) => maker.drawn_rows(cx, &sections, rows)?,
        None => maker.rows(cx, &sections, &middles, tied)?,
    };
    let middles = maker.middles(&sections);
    Ok(Outputs { scalp: parted, partings, rows, middles })
}

/// Puts drawn lines and pattern lines on the map of a head, and returns the centre lines of the pattern's rows.
fn on_the_map(
    cx: &EvalCx,
    inputs: &Inputs,
    part: &[bool],
    partings: &mut Vec<Parting>,
) -> Result<Vec<Vec<Vec2>>, NodeError> {
    let scalp = &*inputs.scalp;
    let chart = scalp.chart();
    let PatternLines { mut lines, middles } = lines(cx, inputs, part)?;
    cx.check()?;
    let flat = |p: &Parting| p.points.iter().map(|p| chart.flat(*p)).collect();
    let old: Vec<Vec<Vec2>> = partings.iter().map(flat).collect();
    let told = inputs.lines.is_some();
    bring_together(cx, scalp.space(), chart, &mut lines, &old, (inputs.join, told));
    cx.check()?;
    for line in &lines {
        let points = laid(scalp, chart, &line.points);
        let (of_pattern, half_width) = (!line.by_hand, 0.5 * inputs.width);
        partings.push(Parting { id: line.id, points, of_pattern, half_width });
    }
    Ok(middles)
}

/// Puts drawn lines on a mesh without a map, such as an animal's.
fn on_the_mesh(cx: &EvalCx, inputs: &Inputs, partings: &mut Vec<Parting>) -> Result<(), NodeError> {
    let scalp = &*inputs.scalp;
    if inputs.pattern != Pattern::None || inputs.between.is_some() {
        cx.warn(
            "patterns and lines between rows are laid out about a head, and this mesh is none: only drawn lines part it",
        );
    }
    for (id, spline) in by_hand(cx, inputs) {
        cx.check()?;
        let n = ((spline.length() / (0.1 * scalp.frame().unit())).ceil() as usize).clamp(16, 4096);
        let mut points = Vec::with_capacity(n + 1);
        spline.resample(n, |p| points.extend(scalp.closest_root(p).map(|root| root.point)));
        if is_closed(&spline, inputs.join) {
            points.extend(points.first().copied());
        } else {
            let [first, last] = [0.0, 1.0].map(|end| {
                let p = spline.at(end);
                let p = scalp.given(p);
                format!("({:.1}, {:.1}, {:.1})", p.x, p.y, p.z)
            });
            cx.remark(format!(
                "a parting is open, from {first} to {last}: it cuts a section where it ends at others or at the edge of the mesh"
            ));
        }
        let half_width = 0.5 * inputs.width;
        let id = curve_id(id, inputs.seed as u64, 0);
        partings.push(Parting { id, points, of_pattern: false, half_width });
    }
    Ok(())
}

/// The drawn lines by id; invalid ones are reported.
fn by_hand(cx: &EvalCx, inputs: &Inputs) -> Vec<(u64, Spline)> {
    let lines = inputs.lines.iter().flat_map(|curves| curves.each());
    let one = |(tuft, i): (&Tuft, usize)| {
        let spline = Spline::new(tuft.curve(i));
        Some((tuft.id(i), spline.map_err(|fault| cx.trouble(tuft.id(i), fault)).ok()?))
    };
    lines.filter_map(one).collect()
}

/// Whether a line ends where it began, within `join` and a quarter of its length.
fn is_closed(line: &Spline, join: f32) -> bool {
    line.at(0.0).distance(line.at(1.0)) < join.min(0.25 * line.length())
}

/// The cells of the map on which the pattern is drawn.
fn part(inputs: &Inputs, chart: &Chart) -> Result<Vec<bool>, NodeError> {
    let scalp = &*inputs.scalp;
    let spots = chart.spots();
    let grows = spots.iter().map(|spot| spot.grows > 0.0);
    if inputs.area.constant() == Some(1.0) {
        return Ok(grows.collect());
    }
    let cells: Vec<usize> = (0..CELLS * CELLS).filter(|c| spots[*c].grows > 0.0).collect();
    let mut near = 0;
    let root = |c: &usize| {
        let hit = scalp.surface().closest_from(spots[*c].point, near)?;
        near = hit.triangle;
        Some(scalp.root(hit.triangle, hit.bary))
    };
    let roots: Vec<_> = cells.iter().filter_map(root).collect();
    let area = inputs.area.field.on_skin(&roots, scalp)?;
    let mut out = vec![false; CELLS * CELLS];
    for (cell, area) in cells.into_iter().zip(area) {
        out[cell] = area >= 0.5;
    }
    Ok(out)
}

/// Drawn lines and pattern lines, on the map.
fn lines(cx: &EvalCx, inputs: &Inputs, part: &[bool]) -> Result<PatternLines, NodeError> {
    let scalp = &*inputs.scalp;
    let chart = scalp.chart();
    let mut drawn = PatternLines::default();
    for (id, spline) in by_hand(cx, inputs) {
        let n = ((spline.length() / (0.2 * chart.unit())).ceil() as usize).clamp(2, 4096);
        let mut points = Vec::with_capacity(n);
        spline.resample(n, |p| points.push(chart.flat(p)));
        let closed = is_closed(&spline, inputs.join);
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
        let wish = PatternParams {
            rows,
            count: inputs.count as usize,
            cut: match inputs.cells {
                Cells::Whole => CellShape::Whole,
                Cells::Boxes => CellShape::Boxes,
                Cells::Triangles => CellShape::Triangles,
            },
            cell: inputs.cell_length,
            brick: inputs.brick,
            turn: inputs.turn.to_radians(),
            centre: gathered_to(inputs, scalp),
            gather: inputs.gather_radius,
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
        drawn.lines.extend(between(cx, scalp, part, beside, inputs.leave, inputs.seed as u64)?);
    }
    let how = Uneven {
        amplitude: inputs.zigzag,
        period: inputs.zigzag_period,
        wobble: inputs.wobble,
        dice: cx.dice(inputs.seed, "wobble"),
    };
    for line in &mut drawn.lines {
        uneven(chart, line, &how);
        line.points = fine(chart, &line.points);
    }
    Ok(drawn)
}

/// Where rows gather, as a direction in the head frame.
fn gathered_to(inputs: &Inputs, scalp: &Scalp) -> Vec3 {
    scalp.space().direction(inputs.centre).unwrap_or(Vec3::Y)
}

/// How far a pattern line is extended, head units.
const FARTHEST: f32 = 4.0;

/// Ends lines where they meet: rows first, then the lines that cut rows. Rows twice, since the line that one was ended
/// at may have been shortened since. Loose ends of drawn lines are `told`.
fn bring_together(
    cx: &EvalCx,
    space: &HeadSpace,
    chart: &Chart,
    lines: &mut [Flat],
    old: &[Vec<Vec2>],
    (join, told): (f32, bool),
) {
    let (mut loose_ends, mut first_end) = (0, None);
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
            // Lines that cut a row extend past it by a fraction of the row, which may be more.
            let join = if rows { join } else { join.max(2.0 * chart.unit()) };
            // Pattern lines are extended until they meet something.
            let reach = if lines[i].by_hand { join } else { join.max(FARTHEST * chart.unit()) };
            let mut loose = 0;
            let [first, last_tied] = lines[i].tied;
            for tied in [last_tied, first] {
                let end = match tied {
                    true => LineEnd::Met,
                    false => end(chart, &mut points, &others, [join, reach]),
                };
                if end == LineEnd::Loose {
                    loose += 1;
                    if last && lines[i].by_hand {
                        first_end = first_end.or(points.last().copied());
                    }
                }
                points.reverse();
            }
            // Pattern lines that divide nothing are dropped when the scalp is cut.
            if loose > 0 && last && lines[i].by_hand {
                loose_ends += 1;
            }
            lines[i].points = points;
        }
    }
    if told && loose_ends > 0 {
        let at = first_end.and_then(|q| {
            let out = chart.out(cell_of(q)?);
            let p = space.given(chart.origin() + chart.direction(q) * out);
            Some(format!(", the first at ({:.1}, {:.1}, {:.1})", p.x, p.y, p.z))
        });
        let partings = if loose_ends == 1 { "parting ends" } else { "partings end" };
        cx.remark(format!(
            "{loose_ends} {partings} in the middle of hair{}, farther than {join:.1} cm from the hairline and other partings: they part it and \
             cut no section; draw on, or raise join",
            at.unwrap_or_default()
        ));
    }
}

#[cfg(test)]
mod tests;
