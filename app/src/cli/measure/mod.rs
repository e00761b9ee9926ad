//! `coif measure`: the laws of hair, measured on an exported file alone (methods.md 0 and 2 to 6).
//!
//! What coif promises of its own grooms is measured on whatever is in the file, by whomever it was written, on the curve that its
//! type, basis and wrap define: lengths, widths, spacing of CVs, stable ids, agreement of the two Catmull-Rom readings, braids (word, crossing, how near strands come, hair per
//! stitch), partings that no hair crosses, hair of sections, curls as asked, clean outlines of puffs, hair that passes its tie, and,
//! with a scalp, roots on the skin and nothing under it. What a file does not tell is not judged: the figure is null and the law is missing.
//! What was not read of the file is said with every report; a prim or curve that contradicts itself is named, the others are measured,
//! and the command ends with 1.
//!
//! `drawn.rs` finds points on curves, `prim.rs` reads columns, `beside.rs` files that a file names, `strands.rs` finds the strands of braids; the other files measure one thing each.

mod beside;
mod braids;
#[cfg(test)]
mod cases;
mod curls;
pub(super) mod depth;
mod drawn;
mod parted;
mod prim;
mod puffs;
mod spine;
mod strands;
mod ties;
mod word;
mod words;

use super::{Exit, complain, complain_of, ending, extension_of, print, print_plain, shown};
use crate::words::plain_json;
use clap::Args;
use coif_graphs::schedule::files::{DiskFiles, Files};
use coif_nodes::data::scalp::Scalp;
use coif_nodes::define::Value;
use coif_nodes::eval::{EvalCx, Log, PlainHost, Quality};
use coif_nodes::formats::abc;
use coif_nodes::formats::usd::form::Basis;
use coif_nodes::formats::usd::read::{LeftOut, ReadStage, read_stage};
use coif_nodes::maths::hash::Key;
use coif_nodes::maths::readings::AGREE;
use coif_nodes::maths::spline::Spline;
use glam::Vec3;
use parted::Partings;
use prim::{Prim, in_parts};
use serde::Serialize;
use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::Arc;

#[derive(Args)]
pub(crate) struct MeasureArgs {
    /// File with curves: .usda, .usdc, .usd, .usdz or .abc
    file: PathBuf,
    /// Head mesh that the roots should lie on: .obj, .gltf or .glb, also one of a pack (groom.coif:head.obj); "builtin" for the built-in
    /// head
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
    /// Neither it nor a prim above is invisible.
    visible: bool,
    /// Type, basis and wrap.
    form: String,
    /// What was left out of the prim, a sentence each.
    notes: Vec<String>,
    /// What was left out of the file, the same with every prim.
    left_out: Vec<NotRead>,
    curves: usize,
    points: usize,
    points_a_curve: [usize; 2],
    /// Smallest, middle and largest arc length, cm.
    length_cm: [f32; 3],
    /// Smallest and largest diameter, cm.
    width_cm: Option<[f32; 2]>,
    bounds: Option<[[f32; 3]; 2]>,
    /// Curves without length, or of a number of points that makes none.
    no_curve: usize,
    /// Largest ratio of two neighbouring segments' lengths.
    spacing_ratio: f32,
    /// Largest distance, cm, between the uniform and the centripetal reading of a curve; null where it is no Catmull-Rom spline.
    reading_difference_cm: Option<f32>,
    /// Curves whose id another curve has too; null where the file has no ids.
    repeated_ids: Option<usize>,
    /// Curves whose id a curve of another prim of the file has too; null where the prim has no ids.
    ids_elsewhere: Option<usize>,
    braids: Option<braids::Braids>,
    sections: Option<parted::BySection>,
    partings: Option<parted::Parted>,
    curls: Option<curls::Curls>,
    puffs: Option<puffs::Puffs>,
    ties: Option<ties::Ties>,
    scalp: Option<depth::OnScalp>,
    /// The laws and whether they hold.
    laws: BTreeMap<&'static str, bool>,
}

/// Something of a file that was not read.
#[derive(Clone, Serialize)]
struct NotRead {
    path: String,
    kind: String,
    asset: String,
    reason: String,
    /// The file contradicts itself there.
    broken: bool,
}

impl NotRead {
    fn new(what: &LeftOut) -> Self {
        let LeftOut { path, kind, asset, reason, is_broken } = what.clone();
        Self { path, kind, asset, reason, broken: is_broken }
    }

    fn in_words(&self) -> String {
        let asset = if self.asset.is_empty() { "" } else { " " };
        format!("{}: {}{asset}{}: {}", self.path, self.kind, self.asset, self.reason)
    }
}

/// The most points of a strand (the limit of engines) and of all hair of a file.
const MOST_A_CURVE: usize = 255;
pub(crate) const MOST_POINTS: usize = 16_000_000;
/// Tubes may overlap by this share of their distance.
const TOUCH: f32 = 1.02;

pub(crate) fn run(args: MeasureArgs) -> Exit {
    ending::at_once();
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
    let name = args.file.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let mut beside = beside::Folder::of(&args.file);
    let read = match &*extension_of(&args.file) {
        "abc" => abc::read_curves(&bytes).map(|curves| ReadStage { curves, left_out: vec![] }),
        _ => read_stage(&bytes, &name, &mut |path| beside.read(path)),
    };
    let stage = match read {
        Ok(stage) => stage,
        Err(err) => return refuse(&args.file, err.to_string()),
    };
    drop(bytes);
    let left_out: Vec<NotRead> = stage.left_out.iter().map(NotRead::new).collect();
    // A prim may say that it has none.
    let is_bald = stage.curves.iter().all(|curves| curves.counts.is_empty());
    // The report says the rest.
    let of_note = left_out.iter().filter(|what| what.broken || is_bald);
    let of_note =
        of_note.map(|what| format!("{}: not read: {}", shown(&args.file), what.in_words()));
    complain_of(of_note.collect());
    if is_bald {
        let none = if left_out.is_empty() {
            "there are no curves in it"
        } else {
            "there are no curves in it that could be read"
        };
        return refuse(&args.file, none.to_owned());
    }
    let scalp = match args.scalp.as_ref().map(read_scalp).transpose() {
        Ok(scalp) => scalp,
        Err(reason) => return refuse(args.scalp.as_ref().unwrap_or(&args.file), reason),
    };
    let all = measure(&stage, scalp.as_deref());
    let printed = if args.json {
        print(&plain_json(&serde_json::to_string_pretty(&all).unwrap_or_default()))
    } else {
        let left_out = left_out.iter().map(|what| format!("not read: {}", what.in_words()));
        let lines: Vec<String> = all.iter().map(words::in_words).chain(left_out).collect();
        print_plain(&lines.join("\n"))
    };
    if all.iter().all(|m| m.no_curve == m.curves) {
        complain(format!("{}: there is no curve in it that can be measured", shown(&args.file)));
        return Exit::Failed;
    }
    if left_out.iter().any(|what| what.broken) { Exit::Failed } else { printed }
}

/// What `--scalp` takes for the head that is part of the program.
const BUILT_IN: &str = "builtin";

/// The scalp of a mesh file or of the built-in head, as the `head` node makes it with its defaults.
fn read_scalp(path: &PathBuf) -> Result<Arc<Scalp>, String> {
    let node = coif_nodes::by_id("head").ok_or("this build has no head node")?;
    let (at, _) = node.input("mesh").ok_or("this build's head node takes no mesh")?;
    let mut inputs = vec![vec![]; node.inputs.len()];
    if path.as_os_str() != BUILT_IN {
        let path = std::path::absolute(path).map_err(|err| err.to_string())?;
        let path = crate::pack::led_into(path)?;
        inputs[at].push(Value::File(DiskFiles::new("/").read(&path.to_string_lossy())?));
    }
    let log = Log::default();
    let cx = EvalCx::new(0, Quality::Final, Key::default(), &PlainHost, &log);
    match (node.run)(&cx, &inputs).map_err(|err| err.to_string())?.into_iter().next() {
        Some(Value::Scalp(scalp)) => Ok(scalp),
        _ => Err("the head node gave no scalp".to_owned()),
    }
}

/// In the whole file.
const UNIQUE: &str = "ids do not repeat";
const DEEPER: &str = "nothing is deeper under the skin than allowed";
const ROOTED: &str = "roots lie on the scalp to 0.001 cm";

fn measure(stage: &ReadStage, scalp: Option<&Scalp>) -> Vec<Measured> {
    let prims: Vec<Prim> = stage.curves.iter().map(Prim::new).collect();
    let partings = Partings::of(&prims);
    let hair = prims.iter().filter(|p| !p.is_guides()).map(|p| p.read.points.len()).sum();
    let left_out: Vec<NotRead> = stage.left_out.iter().map(NotRead::new).collect();
    let elsewhere = ids_elsewhere(&prims);
    let all = prims.iter().zip(elsewhere).map(|(prim, ids_elsewhere)| {
        let mut measured = of_prim(prim, partings.as_ref(), hair, scalp);
        if ids_elsewhere.is_some_and(|shared| shared > 0) {
            measured.laws.insert(UNIQUE, false);
        }
        Measured { left_out: left_out.clone(), ids_elsewhere, ..measured }
    });
    all.collect()
}

/// For each prim that has ids, how many of its curves share theirs with a curve of another.
fn ids_elsewhere(prims: &[Prim]) -> Vec<Option<usize>> {
    let ids: Vec<Option<Vec<i64>>> = prims.iter().map(|prim| prim.whole("id")).collect();
    let of_prim = |(p, ids): (usize, &Option<Vec<i64>>)| {
        ids.iter().flatten().map(|id| (*id, p)).collect::<Vec<_>>()
    };
    let mut all: Vec<(i64, usize)> = ids.iter().enumerate().flat_map(of_prim).collect();
    all.sort_unstable();
    let mut shared: Vec<Option<usize>> = ids.iter().map(|ids| ids.as_ref().map(|_| 0)).collect();
    for same in all.chunk_by(|a, b| a.0 == b.0).filter(|same| same[0].1 != same[same.len() - 1].1) {
        same.iter().for_each(|(_, p)| *shared[*p].get_or_insert(0) += 1);
    }
    shared
}

/// Figures of every curve, joined over parts of a prim.
struct Shapes {
    lengths: Vec<f32>,
    spacing: f32,
    difference: f32,
}

impl Shapes {
    fn of(prim: &Prim) -> Self {
        let parts = in_parts(prim.len(), 500, |part| {
            let mut out = Self { lengths: vec![], spacing: 1.0, difference: 0.0 };
            let mut spline = Spline::default();
            for i in part {
                if prim.spline(i, &mut spline).is_err() {
                    continue;
                }
                out.lengths.push(spline.length());
                out.difference = out.difference.max(prim.readings_differ(i));
                let mut before = None;
                prim.each_part(i, &spline, |b| {
                    let a = before.replace(b).unwrap_or(b);
                    out.spacing = out.spacing.max(a.max(b) / a.min(b).max(1e-9));
                });
            }
            out
        });
        let mut all = Self { lengths: vec![], spacing: 1.0, difference: 0.0 };
        for part in parts {
            all.lengths.extend(part.lengths);
            all.spacing = all.spacing.max(part.spacing);
            all.difference = all.difference.max(part.difference);
        }
        all.lengths.sort_by(f32::total_cmp);
        all
    }
}

fn of_prim(
    prim: &Prim,
    partings: Option<&Partings>,
    hair: usize,
    scalp: Option<&Scalp>,
) -> Measured {
    let read = prim.read;
    let n = prim.len();
    let shapes = Shapes::of(prim);
    let low_high = prim.points().iter().fold(None, |box_: Option<(Vec3, Vec3)>, p| {
        Some(box_.map_or((*p, *p), |(lo, hi)| (lo.min(*p), hi.max(*p))))
    });
    let repeated_ids = prim.whole("id").map(|mut ids| {
        ids.sort_unstable();
        ids.windows(2).filter(|w| w[0] == w[1]).count()
    });
    let most = read.counts.iter().max().copied().unwrap_or(0) as usize;
    let lengths = &shapes.lengths;
    let mut out = Measured {
        path: read.path.clone(),
        purpose: read.purpose.clone(),
        visible: read.is_visible,
        form: read.form.to_string(),
        notes: read.notes.clone(),
        left_out: vec![],
        curves: n,
        points: read.points.len(),
        points_a_curve: [read.counts.iter().min().copied().unwrap_or(0) as usize, most],
        length_cm: [0.0, 0.5, 1.0].map(|q| prim::quantile(lengths, q)),
        width_cm: prim.widths(),
        bounds: low_high.map(|(lo, hi)| [lo.to_array(), hi.to_array()]),
        no_curve: n - lengths.len(),
        spacing_ratio: shapes.spacing,
        reading_difference_cm: (read.form.basis == Basis::CatmullRom).then_some(shapes.difference),
        repeated_ids,
        ids_elsewhere: None,
        braids: braids::measure(prim, scalp),
        sections: parted::by_section(prim),
        partings: None,
        curls: curls::measure(prim),
        puffs: puffs::measure(prim),
        ties: ties::measure(prim),
        scalp: scalp.map(|scalp| depth::measure(prim, scalp)),
        laws: BTreeMap::new(),
    };
    if !prim.is_guides() {
        out.partings = partings.map(|partings| partings.judge(prim));
        out.laws.insert("a strand has at most 255 points", most <= MOST_A_CURVE);
        out.laws.insert("all hair has at most 16 million points", hair <= MOST_POINTS);
    }
    out.judge();
    if prim.whole("parting").is_some() {
        // Partings are lines that hair is judged by, and run straight on through ears and folds: no hair lies there.
        out.laws.remove(DEEPER);
    }
    if prim.whole("clumpId").is_some() && prim.whole("skinprim").is_none() {
        // What grows from other curves and tells no place on the skin, such as the band of a braid, has no root there.
        out.laws.remove(ROOTED);
    }
    out
}

impl Measured {
    /// The laws that can be judged by what was measured.
    fn judge(&mut self) {
        let mut laws = std::mem::take(&mut self.laws);
        laws.insert("every curve has two points and a length", self.no_curve == 0);
        if let Some(difference) = self.reading_difference_cm {
            laws.insert("both readings of every curve agree to 0.001 cm", difference <= AGREE);
        }
        if let Some(repeated) = self.repeated_ids {
            laws.insert(UNIQUE, repeated == 0);
        }
        if let Some(braids) = &self.braids {
            laws.insert("braids are woven all along as they begin", braids.broken_words == 0);
            if braids.tubes {
                laws.insert("strands of a braid do not overlap", braids.worst_overlap <= TOUCH);
            }
            if let Some(joined) = &braids.joined {
                laws.insert("all hair of a braid joins at a stitch", joined.unjoined == 0);
            }
        }
        if let Some(partings) = &self.partings {
            laws.insert("no hair crosses a parting", partings.crossing == 0);
            laws.insert("no hair is rooted in a parting", partings.rooted_in == 0);
        }
        if let Some(curls) = self.curls.as_ref().filter(|curls| curls.can_be_judged()) {
            laws.extend(curls.as_asked(0.05));
        }
        if let Some(puffs) = self.puffs.as_ref().filter(|puffs| puffs.can_be_judged()) {
            laws.insert(
                "outlines of puffs are as clean as asked",
                puffs.within >= 0.95 && puffs.is_covered(),
            );
        }
        if let Some(ties) = &self.ties {
            laws.insert("hair passes its tie", ties.beside == 0);
        }
        if let Some(on) = &self.scalp {
            laws.insert(ROOTED, on.root_distance_cm[1] <= 1e-3);
            laws.insert(DEEPER, on.too_deep == 0);
        }
        self.laws = laws;
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use coif_nodes::formats::usd::form::Form;
    use coif_nodes::formats::usd::read::{ReadCurves, ReadPrimvar, ReadValues};

    /// A prim of these curves with these primvars.
    pub(super) fn prim_of(curves: &[&[Vec3]], primvars: &[(&str, ReadValues)]) -> ReadCurves {
        let points: Vec<Vec3> = curves.concat();
        let interpolation = |n: usize| match n {
            1 => "constant",
            n if n == curves.len() => "uniform",
            _ => "vertex",
        };
        ReadCurves {
            path: "/groom/hair".into(),
            purpose: "default".into(),
            is_visible: true,
            counts: curves.iter().map(|c| c.len() as u32).collect(),
            points,
            form: Form::COIF,
            widths: None,
            primvars: primvars
                .iter()
                .map(|(name, values)| ReadPrimvar {
                    name: (*name).into(),
                    type_name: String::new(),
                    interpolation: interpolation(values.len()).into(),
                    values: values.clone(),
                })
                .collect(),
            notes: vec![],
        }
    }

    /// Three strands of a braid of `stitches` stitches an amplitude of 0.4 cm wide, hanging down, as one tube each or as
    /// `hairs` hairs; front is +z.
    fn braid(stitches: f32, hairs: usize, depth: f32, wrong: bool) -> ReadCurves {
        let each = (stitches * 12.0) as usize;
        let (mut curves, mut strand, mut along) = (vec![], vec![], vec![]);
        for i in 0..3 {
            for hair in 0..hairs {
                let turn = hair as f32 * 2.4;
                let out = 0.12 * ((hair as f32 + 0.5) / hairs as f32).sqrt();
                let off = if hairs > 1 {
                    Vec3::new(turn.cos(), 0.0, turn.sin()) * out
                } else {
                    Vec3::ZERO
                };
                let at = |k: usize| {
                    let u = k as f32 / each as f32 * stitches;
                    let c = (u / 3.0 + i as f32 / 3.0) * std::f32::consts::TAU;
                    let flip = if wrong && (3.0..3.6).contains(&u) { -1.0 } else { 1.0 };
                    Vec3::new(-0.4 * c.sin(), -0.6 * u, 0.2 * depth * flip * (2.0 * c).sin()) + off
                };
                curves.push((0..each).map(at).collect::<Vec<Vec3>>());
                strand.push(i);
                along.extend((0..each).map(|k| (k + 1) as f32 / each as f32));
            }
        }
        let points = curves.iter().map(Vec::len).sum();
        let refs: Vec<&[Vec3]> = curves.iter().map(Vec::as_slice).collect();
        let mut primvars = vec![
            ("braid", ReadValues::Int(vec![5])),
            ("strand", ReadValues::Int(strand)),
            ("along", ReadValues::Float(along)),
            ("scalp_normal", ReadValues::Float3(vec![Vec3::Z])),
        ];
        if hairs == 1 {
            primvars.push(("radius", ReadValues::Float(vec![0.12; points])));
        }
        prim_of(&refs, &primvars)
    }

    fn on(read: &ReadCurves, scalp: Option<&Scalp>) -> Measured {
        measure(&ReadStage { curves: vec![read.clone()], left_out: vec![] }, scalp).remove(0)
    }

    #[track_caller]
    fn measured(read: &ReadCurves) -> Measured {
        on(read, None)
    }

    #[test]
    fn braids_of_tubes_and_of_hair_are_read_alike() {
        for hairs in [1, 40] {
            for (depth, crossing) in [(1.0, "under"), (-1.0, "over")] {
                let found = measured(&braid(9.0, hairs, depth, false)).braids.unwrap();
                assert_eq!((found.braids, found.strands, found.broken_words), (1, 3, 0));
                let kind = &found.kinds[0];
                assert_eq!((kind.weave, kind.crossing), (Some(2), crossing), "{hairs}");
                assert!((8..=9).contains(&kind.stitches[0]), "{:?}", kind.stitches);
                assert!((0.5..1.1).contains(&found.worst_overlap), "{}", found.worst_overlap);
            }
        }
    }

    #[test]
    fn strands_whose_hair_comes_from_farther_are_read_at_the_same_places() {
        let read = braid(9.0, 40, 1.0, false);
        let ReadValues::Float(along) = &read.primvars[2].values else { panic!() };
        // The hair of the first strand comes a long way in many points.
        let (mut points, mut alongs, mut counts, mut first) = (vec![], vec![], vec![], 0);
        for (i, count) in read.counts.iter().enumerate() {
            let way = if i < 40 { 60 } else { 2 };
            let (from, u) = (read.points[first], along[first]);
            points.extend((0..way).map(|k| from + Vec3::X * (0.05 * (way - k) as f32)));
            alongs.extend(std::iter::repeat_n(u, way));
            let all = first..first + *count as usize;
            points.extend_from_slice(&read.points[all.clone()]);
            alongs.extend_from_slice(&along[all.clone()]);
            counts.push(count + way as u32);
            first = all.end;
        }
        let mut read = ReadCurves { points, counts, ..read };
        read.primvars[2].values = ReadValues::Float(alongs);
        let found = measured(&read).braids.unwrap();
        assert_eq!((found.braids, found.broken_words, found.kinds[0].weave), (1, 0, Some(2)));
    }

    #[test]
    fn a_crossing_the_wrong_way_breaks_the_law() {
        let law = "braids are woven all along as they begin";
        for hairs in [1, 40] {
            assert!(measured(&braid(9.0, hairs, 1.0, false)).laws[law]);
            assert!(!measured(&braid(9.0, hairs, 1.0, true)).laws[law], "{hairs}");
        }
    }

    #[test]
    fn limits_of_points_are_laws() {
        let long: Vec<Vec3> = (0..300).map(|k| Vec3::Y * k as f32).collect();
        let found = measured(&prim_of(&[&long], &[]));
        assert!(!found.laws["a strand has at most 255 points"]);
        assert!(found.laws["all hair has at most 16 million points"]);
    }

    #[test]
    fn hair_per_stitch_is_counted() {
        let hair: &[Vec3] = &[Vec3::ZERO, Vec3::Y];
        let stitch = ReadValues::Int(vec![0, 0, 0, 2, 2, -1, 1, 1]);
        let primvars = [
            ("braid", ReadValues::Int(vec![5, 5, 5, 5, 5, 5, 0, 6])),
            ("stitch", stitch),
            ("fed", ReadValues::Int(vec![0, 0, 0, 0, 1, 0, 0, 0])),
        ];
        let read = prim_of(&[hair; 8], &primvars);
        let joined = braids::joined(&Prim::new(&read)).unwrap();
        assert_eq!((joined.grown, joined.fed, joined.unjoined), (5, 1, 1));
        assert_eq!((joined.stitches, joined.empty_stitches, joined.a_stitch), (3, 1, [1, 1, 3]));
    }

    #[test]
    fn the_built_in_head_can_be_named() {
        let scalp = read_scalp(&PathBuf::from(BUILT_IN)).unwrap();
        let root = scalp.closest_root(Vec3::Y * 20.0).unwrap();
        let hair: &[Vec3] = &[root.point, root.point + root.normal];
        let read = prim_of(&[hair, &[root.point, root.point - root.normal]], &[]);
        let found = on(&read, Some(&scalp));
        assert!(found.laws[ROOTED]);
        assert!(!found.laws[DEEPER]);
        assert_eq!(found.scalp.unwrap().too_deep, 1);
        // A band grows from its braid; hair that tells its place on the skin is judged by it.
        let off: &[Vec3] = &[root.point + root.normal, root.point + root.normal * 2.0];
        let law = |tells: &[&str]| {
            let tells: Vec<_> =
                tells.iter().map(|name| (*name, ReadValues::Int(vec![7]))).collect();
            let read = prim_of(&[off], &tells);
            on(&read, Some(&scalp)).laws.get(ROOTED).copied()
        };
        assert_eq!(law(&["clumpId"]), None);
        assert_eq!(law(&["clumpId", "skinprim"]), Some(false));
        assert_eq!(law(&[]), Some(false));
    }
}
