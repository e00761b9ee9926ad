//! What is measured of each curves prim of a file: figures and laws by the names that `--json` has them under, a contract
//! (`docs/report.md`).
//!
//! What a file does not tell is not judged: the figure is null and the law is missing.

use super::unit::TakenUnit;
use coif_nodes::data::scalp::Scalp;
use coif_nodes::eval::Host;
use coif_nodes::formats::usd::read::{LeftOut, ReadCurves, ReadStage};
use coif_nodes::laws::braid_words::Crossing;
use coif_nodes::laws::partings::{Parted, Partings};
use coif_nodes::laws::strands::{MOST_POINTS, Strands};
use coif_nodes::laws::{
    MeasuredHair, braids, curls, depth, ids, outlines, roots, sections, stitches, strands, ties,
};
use serde::{Serialize, Serializer};
use std::collections::BTreeMap;

/// Everything measured on one curves prim.
#[derive(Serialize)]
pub(super) struct Measured {
    pub(super) path: String,
    pub(super) purpose: String,
    /// Neither it nor a prim above is invisible.
    pub(super) visible: bool,
    /// Type, basis and wrap.
    pub(super) form: String,
    /// Which unit was taken of a file that declares none.
    pub(super) unit: Option<TakenUnit>,
    /// What was left out of the prim, a sentence each.
    pub(super) notes: Vec<String>,
    /// What was left out of the file, the same with every prim.
    pub(super) left_out: Vec<NotRead>,
    #[serde(flatten, with = "StrandsNames")]
    pub(super) strands: Strands,
    /// Curves whose id another curve has too; null where the file has no ids.
    pub(super) repeated_ids: Option<usize>,
    /// Curves whose id a curve of another prim of the file has too; null where the prim has no ids.
    pub(super) ids_elsewhere: Option<usize>,
    pub(super) braids: Option<Braids>,
    #[serde(serialize_with = "of_sections")]
    pub(super) sections: Option<sections::HairBySection>,
    #[serde(serialize_with = "of_partings")]
    pub(super) partings: Option<Parted>,
    #[serde(serialize_with = "of_curls")]
    pub(super) curls: Option<curls::Curls>,
    #[serde(serialize_with = "of_puffs")]
    pub(super) puffs: Option<outlines::Puffs>,
    #[serde(serialize_with = "of_ties")]
    pub(super) ties: Option<ties::Ties>,
    pub(super) scalp: Option<OnScalp>,
    /// The laws and whether they hold.
    pub(super) laws: BTreeMap<&'static str, bool>,
}

/// Braids, and how hair joins them.
#[derive(Serialize)]
pub(super) struct Braids {
    #[serde(flatten, with = "BraidsNames")]
    pub(super) found: braids::Braids,
    #[serde(serialize_with = "of_joined")]
    pub(super) joined: Option<stitches::Joined>,
}

/// Where roots lie and how deep hair does.
#[derive(Serialize)]
pub(super) struct OnScalp {
    #[serde(flatten, with = "RootsNames")]
    pub(super) roots: roots::Roots,
    #[serde(flatten, with = "DepthNames")]
    pub(super) depth: depth::SkinDepth,
}

/// Something of a file that was not read.
#[derive(Clone, Serialize)]
pub(super) struct NotRead {
    pub(super) path: String,
    pub(super) kind: String,
    pub(super) asset: String,
    pub(super) reason: String,
    /// The file contradicts itself there.
    pub(super) broken: bool,
}

impl NotRead {
    pub(super) fn new(what: &LeftOut) -> Self {
        let LeftOut { path, kind, asset, reason, is_broken } = what.clone();
        Self { path, kind, asset, reason, broken: is_broken }
    }

    pub(super) fn in_words(&self) -> String {
        let asset = if self.asset.is_empty() { "" } else { " " };
        format!("{}: {}{asset}{}: {}", self.path, self.kind, self.asset, self.reason)
    }
}

/// In the whole file.
pub(super) const UNIQUE: &str = "ids do not repeat";
pub(super) const DEEPER: &str = "nothing is deeper under the skin than allowed";
pub(super) const ROOTED: &str = "roots lie on the scalp to 0.001 cm";

pub(super) fn measure(stage: &ReadStage, scalp: Option<&Scalp>, host: &dyn Host) -> Vec<Measured> {
    let prims: Vec<MeasuredHair> =
        stage.curves.iter().map(|read| MeasuredHair::read(read, host)).collect();
    let partings = Partings::of(&prims);
    let hair = stage.curves.iter().filter(|read| !is_guides(read));
    let hair = hair.map(|read| read.points.len()).sum();
    let left_out: Vec<NotRead> = stage.left_out.iter().map(NotRead::new).collect();
    let all = stage.curves.iter().zip(&prims).zip(ids::shared(&prims));
    all.map(|((read, prim), ids_elsewhere)| {
        let mut measured = Measured::of((read, prim), partings.as_ref(), hair, scalp);
        if ids_elsewhere.is_some_and(|shared| shared > 0) {
            measured.laws.insert(UNIQUE, false);
        }
        Measured { left_out: left_out.clone(), ids_elsewhere, ..measured }
    })
    .collect()
}

fn is_guides(read: &ReadCurves) -> bool {
    read.purpose == "guide"
}

impl Measured {
    /// Of a file with so many points of hair.
    fn of(
        (read, prim): (&ReadCurves, &MeasuredHair),
        partings: Option<&Partings>,
        hair: usize,
        scalp: Option<&Scalp>,
    ) -> Self {
        let braids = |found| Braids { found, joined: stitches::measure(prim) };
        let on = |scalp| OnScalp {
            roots: roots::measure(prim, scalp),
            depth: depth::measure(prim, scalp),
        };
        let mut out = Self {
            path: read.path.clone(),
            purpose: read.purpose.clone(),
            visible: read.is_visible,
            form: read.form.to_string(),
            unit: None,
            notes: read.notes.clone(),
            left_out: vec![],
            strands: strands::measure(prim),
            repeated_ids: ids::repeated(prim),
            ids_elsewhere: None,
            braids: braids::measure(prim, scalp).map(braids),
            sections: sections::measure(prim),
            partings: None,
            curls: curls::measure(prim),
            puffs: outlines::measure(prim),
            ties: ties::measure(prim),
            scalp: scalp.map(on),
            laws: BTreeMap::new(),
        };
        if !is_guides(read) {
            out.partings = partings.map(|partings| partings.judge(prim));
            out.laws.insert("a strand has at most 255 points", out.strands.are_short_enough());
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

    /// The laws that can be judged by what was measured.
    fn judge(&mut self) {
        let laws = &mut self.laws;
        laws.insert("every curve has two points and a length", self.strands.are_curves());
        if let Some(alike) = self.strands.read_alike() {
            laws.insert("both readings of every curve agree to 0.001 cm", alike);
        }
        if let Some(repeated) = self.repeated_ids {
            laws.insert(UNIQUE, repeated == 0);
        }
        if let Some(Braids { found, joined }) = &self.braids {
            laws.insert("braids are woven all along as they begin", found.are_woven());
            if let Some(apart) = found.keep_apart() {
                laws.insert("strands of a braid do not overlap", apart);
            }
            if let Some(joined) = joined {
                laws.insert("all hair of a braid joins at a stitch", joined.unjoined == 0);
            }
        }
        if let Some(partings) = &self.partings {
            laws.insert("no hair crosses a parting", partings.crossing == 0);
            laws.insert("no hair is rooted in a parting", partings.rooted_in == 0);
        }
        if let Some(curls) = self.curls.as_ref().filter(|curls| curls.can_be_judged()) {
            let [diameters, pitches, shrinkage] = curls.are_as_requested(0.05);
            laws.insert("curl diameters are as asked to 5 %", diameters);
            laws.insert("curl pitches are as asked to 5 %", pitches);
            laws.insert("shrinkage is as told to 5 %", shrinkage);
        }
        if let Some(puffs) = self.puffs.as_ref().filter(|puffs| puffs.can_be_judged()) {
            laws.insert("outlines of puffs are as clean as asked", puffs.are_clean());
        }
        if let Some(ties) = &self.ties {
            laws.insert("hair passes its tie", ties.beside == 0);
        }
        if let Some(OnScalp { roots, depth }) = &self.scalp {
            laws.insert(ROOTED, roots.are_on_the_skin());
            laws.insert(DEEPER, depth.too_deep == 0);
        }
    }
}

/// One stitch's factor, in the order from the left: `s1` the pair farthest left, `^-1` where the strand going right is behind.
pub(super) fn factor(kind: &braids::BraidKind) -> String {
    let one = |(p, front): (usize, &bool)| format!("s{}{}", p + 1, if *front { "" } else { "^-1" });
    kind.signs.iter().enumerate().map(one).collect::<Vec<_>>().join(" ")
}

/// `under`, `over`, `either` (both are the same braid), or `not known` where nothing in the file tells its front.
pub(super) fn crossing(kind: &braids::BraidKind) -> &'static str {
    match kind.crossing {
        None => "not known",
        Some(Crossing::Under) => "under",
        Some(Crossing::Over) => "over",
        Some(Crossing::Either) => "either",
    }
}

/// Where there is a figure, its names.
macro_rules! optional {
    ($($function:ident: $of:ty as $names:literal;)*) => {$(
        fn $function<S: Serializer>(of: &Option<$of>, to: S) -> Result<S::Ok, S::Error> {
            #[derive(Serialize)]
            struct Named<'a>(#[serde(with = $names)] &'a $of);
            of.as_ref().map(Named).serialize(to)
        }
    )*};
}
optional! {
    of_joined: stitches::Joined as "JoinedNames";
    of_sections: sections::HairBySection as "SectionsNames";
    of_partings: Parted as "PartedNames";
    of_curls: curls::Curls as "CurlsNames";
    of_puffs: outlines::Puffs as "PuffsNames";
    of_ties: ties::Ties as "TiesNames";
}

fn of_kinds<S: Serializer>(of: &[braids::BraidKind], to: S) -> Result<S::Ok, S::Error> {
    #[derive(Serialize)]
    struct Named<'a>(#[serde(with = "KindNames")] &'a braids::BraidKind);
    to.collect_seq(of.iter().map(Named))
}

// What each figure is stands with it in `coif_nodes::laws`.

#[derive(Serialize)]
#[serde(remote = "Strands")]
struct StrandsNames {
    curves: usize,
    points: usize,
    points_a_curve: [usize; 2],
    length_cm: [f32; 3],
    width_cm: Option<[f32; 2]>,
    bounds: Option<[[f32; 3]; 2]>,
    no_curve: usize,
    zero_length: usize,
    spacing_ratio: f32,
    reading_difference_cm: Option<f32>,
}

#[derive(Serialize)]
#[serde(remote = "braids::Braids")]
struct BraidsNames {
    braids: usize,
    strands: usize,
    tubes: bool,
    worst_overlap: f32,
    #[serde(serialize_with = "of_kinds")]
    kinds: Vec<braids::BraidKind>,
    broken_words: usize,
    height_cm: Option<[f32; 3]>,
    gap_cm: Option<[f32; 3]>,
}

#[derive(Serialize)]
#[serde(remote = "braids::BraidKind")]
struct KindNames {
    braids: usize,
    strands: usize,
    weave: Option<usize>,
    #[serde(getter = "factor")]
    factor: String,
    #[serde(getter = "crossing")]
    crossing: &'static str,
    stitches: [usize; 3],
}

#[derive(Serialize)]
#[serde(remote = "stitches::Joined")]
struct JoinedNames {
    grown: usize,
    fed: usize,
    unjoined: usize,
    stitches: usize,
    empty_stitches: usize,
    a_stitch: [usize; 3],
}

#[derive(Serialize)]
#[serde(remote = "sections::HairBySection")]
struct SectionsNames {
    sections: usize,
    without: usize,
    hairs: [usize; 3],
}

#[derive(Serialize)]
#[serde(remote = "Parted")]
struct PartedNames {
    partings: usize,
    half_width_cm: [f32; 2],
    crossing: usize,
    rooted_in: usize,
}

#[derive(Serialize)]
#[serde(remote = "curls::Curls")]
struct CurlsNames {
    curled: usize,
    measured: usize,
    diameter_ratio: [f32; 3],
    pitch_ratio: [f32; 3],
    shrinkage_ratio: Option<[f32; 3]>,
    diameter_cm: f32,
    pitch_cm: f32,
    shrinkage: f32,
}

#[derive(Serialize)]
#[serde(remote = "outlines::Puffs")]
struct PuffsNames {
    puffs: usize,
    hairs: usize,
    fewest: usize,
    radius_cm: [f32; 2],
    coverage: f32,
    #[serde(rename = "asked")]
    requested: Option<f32>,
    #[serde(with = "EdgeNames")]
    edge: outlines::Edge,
    a_cell: f32,
    within: f32,
    deviation: f32,
    over: f32,
}

#[derive(Serialize)]
#[serde(remote = "outlines::Edge")]
struct EdgeNames {
    deeper: f32,
    beside_cm: f32,
    over: f32,
}

#[derive(Serialize)]
#[serde(remote = "ties::Ties")]
struct TiesNames {
    ties: usize,
    hairs: usize,
    beside: usize,
    off: [f32; 2],
    behind_cm: [f32; 3],
}

#[derive(Serialize)]
#[serde(remote = "roots::Roots")]
struct RootsNames {
    #[serde(rename = "root_distance_cm")]
    distance_cm: [f32; 2],
}

#[derive(Serialize)]
#[serde(remote = "depth::SkinDepth")]
struct DepthNames {
    too_deep: usize,
    deepest_cm: f32,
    beyond_cm: f32,
    at: Option<[f32; 3]>,
    curve: Option<usize>,
}
