//! What was measured, in words.

use super::super::report::rounded;
use super::report::{Braids, Measured, OnScalp, crossing, factor};
use coif_nodes::formats::usd::form::Form;

pub(super) fn in_words(m: &Measured) -> String {
    let f = |x: f32| rounded(f64::from(x));
    let s = &m.strands;
    let mut text = format!(
        "{}: {} curves, {} points ({} to {} a curve)\n",
        m.path, s.curves, s.points, s.points_a_curve[0], s.points_a_curve[1]
    );
    if !m.visible {
        text += "  invisible: renderers leave it out\n";
    }
    if m.purpose != "default" {
        text += &format!("  purpose {}\n", m.purpose);
    }
    if m.form != Form::COIF.to_string() {
        text += &format!("  {}\n", m.form);
    }
    let [lo, mid, hi] = s.length_cm.map(f);
    text += &format!("  length {lo} to {hi} cm, middle {mid}\n");
    if let Some([lo, hi]) = s.width_cm {
        text += &format!("  width {lo} to {hi} cm\n");
    }
    match s.zero_length {
        0 => {}
        1 => text += "  1 curve without length: all its points are at one place\n",
        n => text += &format!("  {n} curves without length: all points of each are at one place\n"),
    }
    for (count, text_of) in [
        (m.repeated_ids, "have the id of another"),
        (m.ids_elsewhere, "have an id that a curve of another prim has"),
    ] {
        if let Some(count) = count.filter(|count| *count > 0) {
            text += &format!("  {count} curves {text_of}\n");
        }
    }
    text += &format!("  neighbouring segments at most {} : 1", f(s.spacing_ratio));
    text += &match s.reading_difference_cm {
        Some(difference) => format!(", readings differ by {difference} cm\n"),
        None => "\n".to_owned(),
    };
    if let Some(Braids { found: b, joined }) = &m.braids {
        let of = if b.tubes { "strands" } else { "strands of hair" };
        text += &format!(
            "  {} braids of {} {of} in all, closest approach {} of touching\n",
            b.braids,
            b.strands,
            f(1.0 / b.worst_overlap.max(1e-6))
        );
        for k in &b.kinds {
            let weave = k.weave.map_or("no weave".to_owned(), |m| format!("weave {m}"));
            text += &format!(
                "    {}: {} strands, {weave}, ({})^stitches, crossing {}, {} to {} stitches\n",
                k.braids,
                k.strands,
                factor(k),
                crossing(k),
                k.stitches[0],
                k.stitches[2]
            );
        }
        if let Some([lo, mid, hi]) = b.height_cm.map(|h| h.map(f)) {
            text += &format!("    middle lines {lo} to {hi} cm from the skin, middle {mid}\n");
        }
        if let Some([lo, mid, hi]) = b.gap_cm.map(|h| h.map(f)) {
            text +=
                &format!("    strands come to {lo} cm of the skin, middle {mid}, at most {hi}\n");
        }
        if let Some(j) = joined {
            let [lo, mid, hi] = j.a_stitch;
            text += &format!(
                "    {} hairs join at {} stitches ({lo} to {hi} each, middle {mid}; {} between are empty), {} fed in, {} \
                 join nowhere\n",
                j.grown, j.stitches, j.empty_stitches, j.fed, j.unjoined
            );
        }
    }
    if let Some(s) = &m.sections {
        let [lo, mid, hi] = s.hairs;
        text += &format!(
            "  {} sections of {lo} to {hi} hairs, middle {mid}; {} hairs in none\n",
            s.sections, s.without
        );
    }
    if let Some(p) = &m.partings {
        text += &format!(
            "  {} partings: {} hairs cross one, {} are rooted in one (half width {} cm)\n",
            p.partings,
            p.crossing,
            p.rooted_in,
            f(p.half_width_cm[1])
        );
    }
    if let Some(c) = m.curls.as_ref().filter(|c| !c.can_be_judged()) {
        text += &format!(
            "  curls of {} hairs: {} turn often enough to be measured, too few to judge them by\n",
            c.curled, c.measured
        );
    }
    if let Some(c) = m.curls.as_ref().filter(|c| c.can_be_judged()) {
        let of = |ratio: [f32; 3]| {
            let [lo, mid, hi] = ratio.map(f);
            format!("{mid} of what was asked ({lo} to {hi})")
        };
        text += &format!(
            "  curls of {} hairs, {} measured: diameter {} cm, {}; pitch {} cm, {}\n",
            c.curled,
            c.measured,
            f(c.diameter_cm),
            of(c.diameter_ratio),
            f(c.pitch_cm),
            of(c.pitch_ratio)
        );
        if let Some(ratio) = c.shrinkage_ratio {
            text += &format!("    shrinkage {}, {}\n", f(c.shrinkage), of(ratio));
        }
    }
    if let Some(p) = &m.puffs {
        text += &format!(
            "  {} puffs of {} hairs: filled to {} degrees{}, {} % of cells within 3 % of the outline, 95 % within {} %\n",
            p.puffs,
            p.hairs,
            f(p.coverage),
            p.requested.map_or(String::new(), |asked| format!(" of {} asked", f(asked))),
            f(100.0 * p.within),
            f(100.0 * p.deviation)
        );
        if p.edge != Default::default() {
            text += &format!(
                "    asked: tips up to {} % deeper, up to {} cm beside the outline, {} % of hairs over it\n",
                f(100.0 * p.edge.deeper),
                f(p.edge.beside_cm),
                f(100.0 * p.edge.over)
            );
        }
    }
    if let Some(t) = &m.ties {
        let [lo, mid, hi] = t.behind_cm.map(f);
        text += &format!(
            "  {} hairs held by {} ties: {} do not pass theirs, the farthest at {} of its radius; {lo} to {hi} cm hang behind, \
             middle {mid}\n",
            t.hairs,
            t.ties,
            t.beside,
            f(t.off[1])
        );
    }
    if let Some(OnScalp { roots, depth }) = &m.scalp {
        let worst = match (depth.at, depth.curve) {
            (Some([x, y, z]), Some(curve)) if depth.too_deep > 0 => format!(
                "; worst {} cm deeper than allowed, at ({}, {}, {}) on curve {curve}",
                f(depth.beyond_cm),
                f(x),
                f(y),
                f(z)
            ),
            _ => String::new(),
        };
        text += &format!(
            "  roots {} cm from the scalp (middle), {} at most; {} points too deep, deepest {} cm{}\n",
            roots.distance_cm[0], roots.distance_cm[1], depth.too_deep, depth.deepest_cm, worst
        );
    }
    for note in &m.notes {
        text += &format!("  note: {note}\n");
    }
    for (law, holds) in &m.laws {
        text += &format!("  {} {law}\n", if *holds { "holds:" } else { "BROKEN:" });
    }
    text
}
