//! `coif measure`: the laws of hair, measured on an exported file alone (methods.md 0, 2, 6).
//!
//! What coif promises of its own grooms is measured on whatever is in the file, by whomever it was written: lengths, widths, spacing of
//! CVs, stable ids, agreement of the two Catmull-Rom readings, braids that touch and do not pass through each other,
//! and, with a scalp, roots on the skin and nothing under it.

use super::{Exit, complain, extension_of, print, report::rounded, shown};
use clap::Args;
use coif_graphs::schedule::files::{DiskFiles, Files};
use coif_nodes::data::scalp::Scalp;
use coif_nodes::define::Value;
use coif_nodes::eval::{EvalCx, Log, PlainHost, Quality};
use coif_nodes::formats::export::{AGREE, readings_differ};
use coif_nodes::formats::usd::read::{ReadCurves, ReadValues, read_curves};
use coif_nodes::maths::hash::Key;
use coif_nodes::maths::spline::Spline;
use glam::Vec3;
use serde::Serialize;
use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::Arc;

#[derive(Args)]
pub(crate) struct MeasureArgs {
    /// USD file with BasisCurves: .usda, .usdc, .usd or .usdz
    file: PathBuf,
    /// Head mesh that the roots should lie on: .obj, .gltf or .glb
    #[arg(long, value_name = "FILE")]
    scalp: Option<PathBuf>,
    /// Print JSON for other tools
    #[arg(long)]
    json: bool,
}

/// Everything measured on one curves prim.
#[derive(Serialize)]
struct Measured {
    path: String,
    purpose: String,
    curves: usize,
    points: usize,
    points_a_curve: [usize; 2],
    /// Smallest, middle and largest arc length, cm.
    length_cm: [f32; 3],
    /// Smallest and largest diameter, cm.
    width_cm: Option<[f32; 2]>,
    bounds: Option<[[f32; 3]; 2]>,
    /// Curves of fewer than 2 points or without length.
    no_curve: usize,
    /// Largest ratio of two neighbouring segments' lengths.
    spacing_ratio: f32,
    /// Largest distance, cm, between the uniform and the centripetal reading of a curve.
    reading_difference_cm: f32,
    /// Curves whose id another curve has too; null where the file has no ids.
    repeated_ids: Option<usize>,
    braids: Option<Braids>,
    scalp: Option<OnScalp>,
    /// The laws and whether they hold.
    laws: BTreeMap<&'static str, bool>,
}

#[derive(Serialize)]
struct Braids {
    braids: usize,
    strands: usize,
    /// Largest (r_i + r_j) / distance of two strands of a braid: 1 touches, more than 1.02 overlaps.
    worst_overlap: f32,
}

#[derive(Serialize)]
struct OnScalp {
    /// Middle and largest distance of a root from the skin, cm.
    root_distance_cm: [f32; 2],
    /// Points deeper under the skin than their curve allows (and 0.001 cm of rounding).
    too_deep: usize,
    /// The deepest point's depth, cm.
    deepest_cm: f32,
}

pub(crate) fn run(args: MeasureArgs) -> Exit {
    let refuse = |file: &PathBuf, reason: String| {
        complain(format!("{}: {reason}", shown(file)));
        Exit::Refused
    };
    let bytes = match std::fs::metadata(&args.file) {
        Ok(about) if !about.is_file() => return refuse(&args.file, "is not a file".to_owned()),
        Ok(_) => std::fs::read(&args.file),
        Err(err) => Err(err),
    };
    let bytes = match bytes {
        Ok(bytes) => bytes,
        Err(err) => return refuse(&args.file, err.to_string()),
    };
    let prims = match read_curves(&bytes, &extension_of(&args.file)) {
        Ok(prims) if prims.is_empty() => {
            return refuse(&args.file, "there are no BasisCurves in it".to_owned());
        }
        Ok(prims) => prims,
        Err(err) => return refuse(&args.file, err.to_string()),
    };
    let scalp = match args.scalp.as_ref().map(read_scalp).transpose() {
        Ok(scalp) => scalp,
        Err(reason) => return refuse(args.scalp.as_ref().unwrap_or(&args.file), reason),
    };
    let all: Vec<Measured> = prims.iter().map(|p| measure(p, scalp.as_deref())).collect();
    if args.json {
        print(&serde_json::to_string_pretty(&all).unwrap_or_default());
    } else {
        all.iter().for_each(|m| print(&in_words(m)));
    }
    Exit::Done
}

/// The scalp of a mesh file, as the `head` node makes it with its defaults.
fn read_scalp(path: &PathBuf) -> Result<Arc<Scalp>, String> {
    let path = std::path::absolute(path).map_err(|err| err.to_string())?;
    let file = DiskFiles::new("/").read(&path.to_string_lossy())?;
    let node = coif_nodes::by_id("head").ok_or("this build has no head node")?;
    let (at, _) = node.input("mesh").ok_or("this build's head node takes no mesh")?;
    let mut inputs = vec![vec![]; node.inputs.len()];
    inputs[at].push(Value::File(file));
    let log = Log::default();
    let cx = EvalCx {
        seed: 0,
        quality: Quality::Final,
        node: Key::default(),
        host: &PlainHost,
        log: &log,
    };
    match (node.run)(&cx, &inputs).map_err(|err| err.to_string())?.into_iter().next() {
        Some(Value::Scalp(scalp)) => Ok(scalp),
        _ => Err("the head node gave no scalp".to_owned()),
    }
}

fn measure(prim: &ReadCurves, scalp: Option<&Scalp>) -> Measured {
    let mut offsets = vec![0usize];
    for count in &prim.counts {
        offsets.push(offsets[offsets.len() - 1] + *count as usize);
    }
    let curve = |i: usize| &prim.points[offsets[i]..offsets[i + 1]];
    let n = prim.counts.len();
    let (mut lengths, mut spacing, mut difference) = (vec![], 1.0f32, 0.0f32);
    let mut spline = Spline::default();
    for i in 0..n {
        if spline.rebuild(curve(i)).is_err() {
            continue;
        }
        lengths.push(spline.length());
        difference = difference.max(readings_differ(curve(i)));
        for w in curve(i).windows(3) {
            let (a, b) = (w[0].distance(w[1]), w[1].distance(w[2]));
            spacing = spacing.max(a.max(b) / a.min(b).max(1e-9));
        }
    }
    lengths.sort_by(f32::total_cmp);
    let middle = |v: &[f32]| v.get(v.len() / 2).copied().unwrap_or(0.0);
    let ends = |v: &[f32]| [v.first().copied().unwrap_or(0.0), v.last().copied().unwrap_or(0.0)];
    let low_high = prim.points.iter().fold(None, |box_: Option<(Vec3, Vec3)>, p| {
        Some(box_.map_or((*p, *p), |(lo, hi)| (lo.min(*p), hi.max(*p))))
    });
    let widths = prim.widths.as_ref().filter(|w| !w.values.is_empty()).map(|w| {
        w.values.iter().fold([f32::MAX, f32::MIN], |[lo, hi], x| [lo.min(*x), hi.max(*x)])
    });
    let whole = |name: &str| whole_numbers(prim, name, n);
    let repeated_ids = whole("id").map(|mut ids| {
        ids.sort_unstable();
        ids.windows(2).filter(|w| w[0] == w[1]).count()
    });
    let no_curve = n - lengths.len();
    let braids = braids(prim, &offsets);
    let on_scalp = scalp.map(|scalp| on_scalp(prim, &offsets, scalp));
    let mut laws = BTreeMap::new();
    laws.insert("every curve has two points and a length", no_curve == 0);
    laws.insert("both readings of every curve agree to 0.001 cm", difference <= AGREE);
    laws.insert("CVs are spaced within 1.2 : 1", spacing <= 1.2);
    if let Some(repeated) = repeated_ids {
        laws.insert("ids do not repeat", repeated == 0);
    }
    if let Some(braids) = &braids {
        laws.insert("strands of a braid do not overlap", braids.worst_overlap <= 1.02);
    }
    if let Some(on) = &on_scalp {
        laws.insert("roots lie on the scalp to 0.001 cm", on.root_distance_cm[1] <= 1e-3);
        laws.insert("nothing is deeper under the skin than allowed", on.too_deep == 0);
    }
    Measured {
        path: prim.path.clone(),
        purpose: prim.purpose.clone(),
        curves: n,
        points: prim.points.len(),
        points_a_curve: [
            prim.counts.iter().min().copied().unwrap_or(0) as usize,
            prim.counts.iter().max().copied().unwrap_or(0) as usize,
        ],
        length_cm: [ends(&lengths)[0], middle(&lengths), ends(&lengths)[1]],
        width_cm: widths,
        bounds: low_high.map(|(lo, hi)| [lo.to_array(), hi.to_array()]),
        no_curve,
        spacing_ratio: spacing,
        reading_difference_cm: difference,
        repeated_ids,
        braids,
        scalp: on_scalp,
        laws,
    }
}

/// One whole number for each curve from a primvar of any whole type.
fn whole_numbers(prim: &ReadCurves, name: &str, n: usize) -> Option<Vec<i64>> {
    let found = prim.primvars.iter().find(|p| p.name == name)?;
    let values: Vec<i64> = match &found.values {
        ReadValues::Int(v) => v.iter().map(|x| i64::from(*x)).collect(),
        ReadValues::Int64(v) => v.clone(),
        _ => return None,
    };
    match values.len() {
        1 => Some(vec![values[0]; n]),
        len if len == n => Some(values),
        _ => None,
    }
}

/// A number for each point from a primvar, however it is spread.
fn numbers(prim: &ReadCurves, name: &str, offsets: &[usize]) -> Option<Vec<f32>> {
    let ReadValues::Float(v) = &prim.primvars.iter().find(|p| p.name == name)?.values else {
        return None;
    };
    let (n, points) = (offsets.len() - 1, prim.points.len());
    match v.len() {
        1 => Some(vec![v[0]; points]),
        len if len == points => Some(v.clone()),
        len if len == n => Some(
            (0..n).flat_map(|i| std::iter::repeat_n(v[i], offsets[i + 1] - offsets[i])).collect(),
        ),
        _ => None,
    }
}

fn braids(prim: &ReadCurves, offsets: &[usize]) -> Option<Braids> {
    let n = offsets.len() - 1;
    let braid = whole_numbers(prim, "braid", n)?;
    let strand = whole_numbers(prim, "strand", n)?;
    let radius = numbers(prim, "radius", offsets)?;
    let mut members: BTreeMap<i64, Vec<usize>> = BTreeMap::new();
    for i in (0..n).filter(|i| braid[*i] != 0) {
        members.entry(braid[i]).or_default().push(i);
    }
    // Hair filled into strands carries their numbers too; only braids of single tubes are measured.
    members.retain(|_, curves| {
        let mut numbers: Vec<i64> = curves.iter().map(|i| strand[*i]).collect();
        numbers.sort_unstable();
        curves.len() > 1 && numbers.windows(2).all(|w| w[0] < w[1])
    });
    let mut worst = 0.0f32;
    for curves in members.values() {
        let samples: Vec<Vec<(Vec3, f32)>> = curves
            .iter()
            .map(|i| tube(&prim.points[offsets[*i]..offsets[i + 1]], &radius[offsets[*i]..]))
            .collect();
        for (a, one) in samples.iter().enumerate() {
            for other in &samples[a + 1..] {
                worst = worst.max(overlap(one, other));
            }
        }
    }
    let strands = members.values().map(Vec::len).sum();
    (!members.is_empty()).then_some(Braids { braids: members.len(), strands, worst_overlap: worst })
}

/// Samples of a strand's centre line and radius, eight a span.
fn tube(points: &[Vec3], radius: &[f32]) -> Vec<(Vec3, f32)> {
    let Ok(spline) = Spline::new(points) else { return vec![] };
    (0..spline.span_count() * 8)
        .map(|k| {
            let (span, t) = (k / 8, (k % 8) as f32 / 8.0);
            let point = spline.point(coif_nodes::maths::spline::Place { span, t });
            (point, radius[span] + (radius[span + 1] - radius[span]) * t)
        })
        .collect()
}

fn overlap(one: &[(Vec3, f32)], other: &[(Vec3, f32)]) -> f32 {
    let mut worst = 0.0f32;
    for (p, r) in one {
        for (q, s) in other {
            let sum = r + s;
            let d2 = p.distance_squared(*q);
            if d2 < sum * sum * 4.0 && sum > 0.0 {
                worst = worst.max(sum / d2.sqrt().max(1e-9));
            }
        }
    }
    worst
}

fn on_scalp(prim: &ReadCurves, offsets: &[usize], scalp: &Scalp) -> OnScalp {
    let n = offsets.len() - 1;
    let surface = scalp.surface();
    let allowed = numbers(prim, "allow_depth", offsets);
    let skin = scalp.skin();
    let mut distances: Vec<f32> = (0..n)
        .filter(|i| offsets[i + 1] > offsets[*i])
        .filter_map(|i| surface.closest(prim.points[offsets[i]]).map(|hit| hit.distance))
        .collect();
    distances.sort_by(f32::total_cmp);
    let (mut too_deep, mut deepest) = (0, 0.0f32);
    for (i, p) in prim.points.iter().enumerate() {
        // The field is quick and may be wrong at creases; what it finds deep is measured exactly.
        if skin.distance(*p) >= 0.0 {
            continue;
        }
        let depth = surface.closest(*p).map_or(0.0, |hit| -surface.signed_distance(*p, &hit));
        deepest = deepest.max(depth);
        if depth > allowed.as_ref().map_or(0.0, |a| a[i]) + 1e-3 {
            too_deep += 1;
        }
    }
    OnScalp {
        root_distance_cm: [
            distances.get(distances.len() / 2).copied().unwrap_or(0.0),
            distances.last().copied().unwrap_or(0.0),
        ],
        too_deep,
        deepest_cm: deepest,
    }
}

fn in_words(m: &Measured) -> String {
    let f = |x: f32| rounded(f64::from(x));
    let mut text = format!(
        "{}: {} curves, {} points ({} to {} a curve)\n",
        m.path, m.curves, m.points, m.points_a_curve[0], m.points_a_curve[1]
    );
    let [lo, mid, hi] = m.length_cm.map(f);
    text += &format!("  length {lo} to {hi} cm, middle {mid}\n");
    if let Some([lo, hi]) = m.width_cm {
        text += &format!("  width {lo} to {hi} cm\n");
    }
    text += &format!(
        "  neighbouring segments at most {} : 1, readings differ by {} cm\n",
        f(m.spacing_ratio),
        m.reading_difference_cm
    );
    if let Some(b) = &m.braids {
        text += &format!(
            "  {} braids of {} strands in all, closest approach {} of touching\n",
            b.braids,
            b.strands,
            f(1.0 / b.worst_overlap.max(1e-6))
        );
    }
    if let Some(s) = &m.scalp {
        text += &format!(
            "  roots {} cm from the scalp (middle), {} at most; {} points too deep, deepest {} cm\n",
            s.root_distance_cm[0], s.root_distance_cm[1], s.too_deep, s.deepest_cm
        );
    }
    for (law, holds) in &m.laws {
        text += &format!("  {} {law}\n", if *holds { "holds:" } else { "BROKEN:" });
    }
    text
}
