//! What several test programs share: a small groom with everything in it, mutations, test data.

use coif_nodes::formats::Chunks;
use coif_nodes::formats::usd::groom::{
    CurveSet, GroomStage, Interpolation, Primvar, PrimvarValues, Purpose, UpAxis, Widths,
};
use coif_nodes::formats::usd::read::{LeftOut, ReadCurves, ReadStage, ReadValues, read_stage};
use glam::{Vec2, Vec3};
use std::io::Cursor;
use std::path::{Path, PathBuf};

/// Curves in three tufts, as they lie in memory, with a value of every type for each curve or point.
pub(crate) struct Tufts {
    pub(crate) counts: Vec<Vec<i32>>,
    pub(crate) points: Vec<Vec<Vec3>>,
    pub(crate) widths: Vec<Vec<f32>>,
    pub(crate) uvs: Vec<Vec<Vec2>>,
    pub(crate) ids: Vec<Vec<i64>>,
}

impl Tufts {
    /// `n_curves` curves of 2 to 9 points, or of `points_each` points.
    pub(crate) fn new(n_curves: usize, points_each: Option<usize>) -> Self {
        let mut tufts = Self {
            counts: vec![vec![]; 3],
            points: vec![vec![]; 3],
            widths: vec![vec![]; 3],
            uvs: vec![vec![]; 3],
            ids: vec![vec![]; 3],
        };
        for curve in 0..n_curves {
            let tuft = curve * 3 / n_curves;
            let count = points_each.unwrap_or(2 + curve * 5 % 8);
            tufts.counts[tuft].push(count as i32);
            // Square roots differ in all their bits, unlike round numbers, and are exact everywhere.
            let turn = (curve as f32 + 0.5).sqrt();
            tufts.uvs[tuft].push(Vec2::new(turn.fract(), curve as f32 / n_curves as f32));
            tufts.ids[tuft].push((curve as i64) << 33 | 7);
            for point in 0..count {
                let along = point as f32 / (count - 1) as f32;
                let position = Vec3::new(turn, along * 3.25, -(along + turn).sqrt());
                tufts.points[tuft].push(position);
                tufts.widths[tuft].push(0.008 * (1.0 - 0.9 * along));
            }
        }
        tufts
    }

    pub(crate) fn n_curves(&self) -> usize {
        self.counts.iter().map(Vec::len).sum()
    }

    pub(crate) fn n_points(&self) -> usize {
        self.points.iter().map(Vec::len).sum()
    }
}

/// The pieces as one array, borrowed.
pub(crate) fn chunks<T: Clone>(pieces: &[Vec<T>]) -> Chunks<'_, T> {
    pieces.iter().map(Vec::as_slice).collect()
}

/// Strands with every kind of primvar, guides of constant width, and a set without curves.
pub(crate) fn sample_stage<'a>(strands: &'a Tufts, guides: &'a Tufts) -> GroomStage<'a> {
    GroomStage {
        name: "Head groom 1".into(),
        doc: "A \"sample\"\nwith two lines, a \\ and a \u{1}".into(),
        generator: "coif tests".into(),
        graph_hash: "00ff".into(),
        seed: u64::MAX - 1,
        meters_per_unit: 0.01,
        up_axis: UpAxis::Y,
        skins: vec![],
        groups: vec![
            strand_set(strands),
            CurveSet {
                name: "scalp".into(),
                purpose: Purpose::Guide,
                counts: chunks(&guides.counts),
                points: chunks(&guides.points),
                widths: Widths::Constant(0.1),
                primvars: vec![],
                color: Vec3::new(0.9, 0.5, 0.0),
            },
            CurveSet { name: "scalp".into(), ..CurveSet::default() },
        ],
    }
}

fn strand_set(tufts: &Tufts) -> CurveSet<'_> {
    use Interpolation::{Constant, Uniform, Vertex};
    let (curves, points) = (tufts.n_curves(), tufts.n_points());
    let colors: Vec<Vec3> = (0..curves).map(|i| Vec3::splat(i as f32).map(f32::sqrt)).collect();
    let texts = (0..curves).map(|i| format!("tuft \"{}\" é", i % 7)).collect();
    let clumps: Vec<i32> = (0..curves as i32).map(|i| i * i % 1000 - 500).collect();
    let along: Vec<f32> = (0..points).map(|i| i as f32 / points as f32).collect();
    let few: Vec<f32> = (0..points).map(|i| (i % 5) as f32 * -0.1).collect();
    let primvar = |name: &str, interpolation, values| {
        let name = name.to_owned();
        Primvar { name, interpolation, values }
    };
    CurveSet {
        name: "scalp".into(),
        purpose: Purpose::Render,
        counts: chunks(&tufts.counts),
        points: chunks(&tufts.points),
        widths: Widths::Vertex(chunks(&tufts.widths)),
        primvars: vec![
            primvar("st", Uniform, PrimvarValues::TexCoord(chunks(&tufts.uvs))),
            primvar("id", Uniform, PrimvarValues::Int64(chunks(&tufts.ids))),
            primvar("clumpId", Uniform, PrimvarValues::Int(clumps.into())),
            primvar("displayColor", Uniform, PrimvarValues::Color(colors.into())),
            primvar("curveU", Vertex, PrimvarValues::Float(along.into())),
            primvar("few", Vertex, PrimvarValues::Float(few.into())),
            primvar("rest", Vertex, PrimvarValues::Vector(chunks(&tufts.points))),
            primvar("tuft name", Uniform, PrimvarValues::Text(texts)),
            primvar("groupId", Constant, PrimvarValues::Int(vec![-3].into())),
        ],
        color: Vec3::new(0.2, 0.1, 0.05),
    }
}

/// What a reader is to give for the values.
pub(crate) fn values_of(values: &PrimvarValues) -> ReadValues {
    match values {
        PrimvarValues::Int(values) => ReadValues::Int(values.values().copied().collect()),
        PrimvarValues::Int64(values) => ReadValues::Int64(values.values().copied().collect()),
        PrimvarValues::Float(values) => ReadValues::Float(values.values().copied().collect()),
        PrimvarValues::TexCoord(values) => ReadValues::Float2(values.values().copied().collect()),
        PrimvarValues::Vector(values)
        | PrimvarValues::Color(values)
        | PrimvarValues::Point(values) => ReadValues::Float3(values.values().copied().collect()),
        PrimvarValues::Text(values) => ReadValues::Text(values.clone()),
        PrimvarValues::Named(names, indices) => {
            ReadValues::Text(indices.values().map(|i| names[*i as usize].clone()).collect())
        }
    }
}

/// The stage in both forms, with their extensions.
pub(crate) fn both_forms(stage: &GroomStage) -> [(&'static str, Vec<u8>); 2] {
    use coif_nodes::formats::usd::groom::{write_usda, write_usdc};
    let (mut text, mut crate_file) = (Vec::new(), Cursor::new(Vec::new()));
    write_usda(stage, &mut text).unwrap();
    write_usdc(stage, &mut crate_file).unwrap();
    [("usda", text), ("usdc", crate_file.into_inner())]
}

/// A sequence of numbers from a seed (splitmix64), for mutations that come again in every run.
pub(crate) struct Numbers(u64);

impl Numbers {
    pub(crate) fn below(&mut self, limit: usize) -> usize {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut mixed = self.0;
        mixed = (mixed ^ mixed >> 30).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        mixed = (mixed ^ mixed >> 27).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((mixed ^ mixed >> 31) % limit as u64) as usize
    }
}

/// The bytes cut short, or with some bits flipped: anywhere, or near the end, where tables lie.
pub(crate) fn mutated(bytes: &[u8], seed: u64) -> Vec<u8> {
    let mut numbers = Numbers(seed);
    let mut bytes = bytes.to_vec();
    match seed % 4 {
        0 => bytes.truncate(numbers.below(bytes.len())),
        kind => {
            let first = if kind == 1 { 0 } else { bytes.len().saturating_sub(600) };
            for _ in 0..[1, 2, 16][numbers.below(3)] {
                let at = first + numbers.below(bytes.len() - first);
                bytes[at] ^= 1 << numbers.below(8);
            }
        }
    }
    bytes
}

/// A folder of test data beside the workspace, or a line that says which test goes without.
pub(crate) fn shared(folder: &str, test: &str) -> Option<PathBuf> {
    let shared = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../shared"));
    if !shared.is_dir() {
        println!("skipped: {test} needs ../shared");
        return None;
    }
    Some(shared.join(folder))
}

/// Files of a folder with one of these extensions, by name.
pub(crate) fn files(folder: &Path, extensions: &[&str]) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).unwrap();
    let mut files: Vec<PathBuf> = entries.map(|entry| entry.unwrap().path()).collect();
    files.retain(|file| extensions.contains(&extension(file)));
    files.sort();
    files
}

pub(crate) fn extension(file: &Path) -> &str {
    file.extension().and_then(|extension| extension.to_str()).unwrap_or("")
}

pub(crate) fn file_name(file: &Path) -> &str {
    file.file_name().and_then(|name| name.to_str()).unwrap_or("")
}

/// What a file says that has nothing beside it.
pub(crate) fn read_alone(bytes: &[u8], extension: &str) -> Result<ReadStage, String> {
    let nothing = &mut |_: &str| Err("there is nothing beside it".to_owned());
    let read = read_stage(bytes, &format!("file.{extension}"), nothing);
    read.map_err(|error| error.to_string())
}

/// The curves of such a file, or the first thing that is wrong with it.
pub(crate) fn read_curves(bytes: &[u8], extension: &str) -> Result<Vec<ReadCurves>, String> {
    let read = read_alone(bytes, extension)?;
    match read.left_out.iter().find(|what| what.is_broken) {
        Some(LeftOut { path, reason, .. }) => Err(format!("{path}.{reason}")),
        None => Ok(read.curves),
    }
}

/// Hair and guides.
pub(crate) fn sample() -> (Tufts, Tufts) {
    (Tufts::new(40, None), Tufts::new(5, Some(8)))
}

/// A groom of one set.
pub(crate) fn one_set(set: CurveSet) -> GroomStage {
    GroomStage {
        name: "Groom".into(),
        doc: String::new(),
        generator: String::new(),
        graph_hash: String::new(),
        seed: 0,
        meters_per_unit: 0.01,
        up_axis: UpAxis::Y,
        groups: vec![set],
        skins: vec![],
    }
}

/// One straight curve.
pub(crate) fn two_points() -> CurveSet<'static> {
    CurveSet {
        name: "hair".into(),
        counts: vec![2].into(),
        points: vec![Vec3::new(1.0, 2.0, 3.0), Vec3::new(4.0, 6.0, 8.0)].into(),
        widths: Widths::Constant(0.5),
        ..CurveSet::default()
    }
}
