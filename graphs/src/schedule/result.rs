//! What an evaluation gave: values, what ran, what was said, and the hash by which machines are compared.

use super::files::{MOST_BYTES, read_at_most, read_by};
use crate::document::Document;
use crate::file::document_hash;
use coif_nodes::data::attributes::{Attribute, Column, Domain, Item, default_of};
use coif_nodes::data::curves::{Curves, Tuft};
use coif_nodes::data::gestures::Replayed;
use coif_nodes::define::{NodeError, Value};
use coif_nodes::eval::Message;
use coif_nodes::maths::hash::canonical;
use glam::{Vec2, Vec3};
use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;

/// What happened to one node of a plan.
#[derive(Clone, Debug, Default)]
pub struct NodeReport {
    /// Its id in the document.
    pub name: String,
    /// Its kind.
    pub kind: &'static str,
    /// Wall time of its own work, milliseconds.
    pub ms: f64,
    /// Whether all of its outputs were known from before.
    pub cached: bool,
    /// Pieces of work that ran.
    pub tufts_run: u32,
    /// Pieces that were known from before.
    pub tufts_reused: u32,
    /// Curves of all its outputs.
    pub curves: usize,
    /// Points of all its outputs.
    pub points: usize,
    /// Points of all that it read.
    pub points_read: usize,
    /// Strands that it made of those that its inputs ask for, and all of these; both 0 where it makes none. A preview makes fewer.
    pub thinned: [u64; 2],
    /// Bytes that its values hold, without what they share with what it read; of a head with what was asked of it.
    pub bytes: usize,
    /// What it said.
    pub messages: Vec<Message>,
    /// What became of its gestures, one for each in their order; empty for nodes that take none.
    pub gestures: Vec<Arc<Replayed>>,
    /// Why it failed, if it did.
    pub error: Option<NodeError>,
}

/// How many strands of the final hair one strand stands for, 1 or more, where these nodes made it: pictures draw it as much wider.
pub fn stands_for<'a>(nodes: impl IntoIterator<Item = &'a NodeReport>) -> f32 {
    let sum =
        |[made, all]: [u64; 2], node: &NodeReport| [made + node.thinned[0], all + node.thinned[1]];
    match nodes.into_iter().fold([0, 0], sum) {
        [0, _] => 1.0,
        [made, all] => (all as f64 / made as f64).max(1.0) as f32,
    }
}

/// The end of an evaluation.
#[derive(Debug, Default)]
pub struct Outcome {
    /// One value for each target; none where a node on the way failed or the run was cancelled.
    pub targets: Vec<Option<Value>>,
    /// One report for each step that was reached, in the plan's order.
    pub nodes: Vec<NodeReport>,
    /// Whether somebody asked to stop before the end.
    pub cancelled: bool,
    /// Wall time of the run, milliseconds.
    pub ms: f64,
}

/// Hash of the content of curves: curves in order, attributes by name, little-endian, BLAKE3 cut to 128 bits, as 32
/// hexadecimal digits.
///
/// Independent of tuft borders, of how values are shared, and of the machine: a missing attribute counts as its declared
/// default where other tufts have it, -0.0 as 0.0.
pub fn content_hash(curves: &Curves) -> String {
    content_hash_until(curves, &|| false).unwrap_or_default()
}

/// [`content_hash`], or none once somebody asks to stop.
pub fn content_hash_until(curves: &Curves, is_cancelled: &dyn Fn() -> bool) -> Option<String> {
    let mut hash = blake3::Hasher::new();
    let mut buffer = Vec::new();
    hash.update(b"coif curves 1");
    hash.update(&(curves.curve_count() as u64).to_le_bytes());
    for tuft in curves.tufts() {
        let counts = tuft.offsets().windows(2).map(|o| o[1] - o[0]);
        put(&mut hash, &mut buffer, counts.flat_map(u32::to_le_bytes));
    }
    for tuft in curves.tufts() {
        if is_cancelled() {
            return None;
        }
        put_all(&mut hash, &mut buffer, tuft.points());
    }
    // A column that varies over points anywhere is hashed by points everywhere.
    let mut columns: BTreeMap<&str, (Domain, &Column)> = BTreeMap::new();
    for attribute in curves.tufts().iter().flat_map(|t| t.attributes()) {
        let domain = if attribute.values.len() == 1 { Domain::Curve } else { attribute.domain };
        let entry = columns.entry(&attribute.name).or_insert((domain, &attribute.values));
        entry.0 = entry.0.max(domain);
    }
    for (name, (domain, sample)) in columns {
        let ty = sample.bytes().0;
        hash.update(&(name.len() as u64).to_le_bytes());
        hash.update(name.as_bytes());
        hash.update(ty.as_bytes());
        hash.update(&[domain as u8]);
        for tuft in curves.tufts() {
            if is_cancelled() {
                return None;
            }
            column(&mut hash, &mut buffer, tuft, tuft.attribute(name), domain, name, sample);
        }
    }
    Some(hash.finalize().to_hex()[..32].to_owned())
}

/// Hash of all that an evaluation is made from, as 32 hexadecimal digits: what the document means, the bytes of the files that it
/// names (paths relative to `folder`), and `how` it is evaluated, in any words. None where one of the files is not read.
pub fn inputs_hash(document: &Document, folder: &Path, how: &str) -> Option<String> {
    let mut hash = blake3::Hasher::new();
    let mut add = |bytes: &[u8]| {
        hash.update(&(bytes.len() as u64).to_le_bytes());
        hash.update(bytes);
    };
    add(document_hash(document).as_bytes());
    add(how.as_bytes());
    for (_, path) in read_by(document, folder) {
        add(&read_at_most(&path, MOST_BYTES).ok()?);
    }
    Some(hash.finalize().to_hex()[..32].to_owned())
}

fn put(hash: &mut blake3::Hasher, buffer: &mut Vec<u8>, bytes: impl Iterator<Item = u8>) {
    buffer.clear();
    buffer.extend(bytes);
    hash.update(buffer);
}

/// A type of value as the hash reads it.
trait Hashed: Item {
    /// Whether `values` lie in memory as they are hashed.
    fn plain(values: &[Self]) -> bool;
    /// Appends the value's bytes.
    fn put(self, buffer: &mut Vec<u8>);
}

macro_rules! whole_numbers {
    ($($ty:ty),*) => {$(
        impl Hashed for $ty {
            fn plain(_: &[Self]) -> bool {
                cfg!(target_endian = "little")
            }
            fn put(self, buffer: &mut Vec<u8>) {
                buffer.extend(self.to_le_bytes());
            }
        }
    )*};
}
whole_numbers!(i32, u64);

impl Hashed for f32 {
    fn plain(values: &[Self]) -> bool {
        // -0.0 and every NaN have another spelling than their own.
        let odd = |x: &f32| x.is_nan() | (x.to_bits() == 1 << 31);
        cfg!(target_endian = "little") && !values.iter().fold(false, |any, x| any | odd(x))
    }
    fn put(self, buffer: &mut Vec<u8>) {
        buffer.extend(canonical(self).to_le_bytes());
    }
}

macro_rules! vectors {
    ($($ty:ty),*) => {$(
        impl Hashed for $ty {
            fn plain(values: &[Self]) -> bool {
                f32::plain(bytemuck::cast_slice(values))
            }
            fn put(self, buffer: &mut Vec<u8>) {
                self.to_array().into_iter().for_each(|x| x.put(buffer));
            }
        }
    )*};
}
vectors!(Vec2, Vec3);

/// Hashes one value for each item.
fn put_all<T: Hashed>(hash: &mut blake3::Hasher, buffer: &mut Vec<u8>, values: &[T]) {
    if T::plain(values) {
        hash.update(bytemuck::cast_slice::<T, u8>(values));
    } else {
        buffer.clear();
        values.iter().for_each(|value| value.put(buffer));
        hash.update(buffer);
    }
}

fn column(
    hash: &mut blake3::Hasher,
    buffer: &mut Vec<u8>,
    tuft: &Tuft,
    attribute: Option<&Attribute>,
    domain: Domain,
    name: &str,
    sample: &Column,
) {
    let default = default_of(name, sample);
    let found = attribute.map(|a| &a.values).filter(|v| v.bytes().0 == sample.bytes().0);
    let (values, own) = match (found, attribute) {
        (Some(values), Some(a)) => (values, a.domain),
        _ => (&default, Domain::Curve),
    };
    match values {
        Column::F32(v) => spread(hash, buffer, tuft, (v, own), domain),
        Column::I32(v) => spread(hash, buffer, tuft, (v, own), domain),
        Column::U64(v) => spread(hash, buffer, tuft, (v, own), domain),
        Column::Vec2(v) => spread(hash, buffer, tuft, (v, own), domain),
        Column::Vec3(v) => spread(hash, buffer, tuft, (v, own), domain),
    }
}

/// Hashes a column with one value for each item of `domain`, however it is stored.
fn spread<T: Hashed>(
    hash: &mut blake3::Hasher,
    buffer: &mut Vec<u8>,
    tuft: &Tuft,
    (values, own): (&[T], Domain),
    domain: Domain,
) {
    match (values, own, domain) {
        ([one], _, Domain::Curve) => put_all(hash, buffer, &vec![*one; tuft.len()]),
        ([one], _, Domain::Point) => put_all(hash, buffer, &vec![*one; tuft.points().len()]),
        (_, Domain::Curve, Domain::Point) => {
            let each = (0..tuft.len()).map(|i| std::iter::repeat_n(values[i], tuft.range(i).len()));
            put_all(hash, buffer, &each.flatten().collect::<Vec<T>>());
        }
        _ => put_all(hash, buffer, values),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use coif_nodes::data::attributes::{ID, RADIUS, WIDTH};
    use coif_nodes::data::curves::TuftBuilder;
    use glam::Vec3;

    fn tuft(ids: std::ops::Range<u64>, width: &[f32]) -> Arc<Tuft> {
        let mut b = TuftBuilder::new();
        for id in ids.clone() {
            b.push_curve(&[Vec3::ZERO, Vec3::Y * id as f32]);
        }
        b.set(ID, Domain::Curve, ids.collect());
        if !width.is_empty() {
            b.set(WIDTH, Domain::Curve, width.to_vec());
        }
        Arc::new(b.build())
    }

    #[test]
    fn a_documents_hash_does_not_see_what_means_nothing() {
        let full = r#"(format: 1, budget: (points: 9), nodes: {
            "pen": (kind: "stroke_input", label: "rows", note: "n", inputs: {"strokes": [
                (id: 1, x: [1,2], y: [1,0], z: [1,0], pressure: [1,0], time: [0,1],
                 drawn: (x: [1], y: [1], z: [1], pressure: [1], time: [0])),
            ]}),
            "a": (kind: "resample"),
        }, links: {"a.curves": "pen.curves"},
        frames: {"f": (at: (0, 0), size: (9, 9))}, bends: {"a.curves": [[(1, 2)]]}, collapsed: ["a"],
        views: {"v": (eye: (0, 0, 9), target: (0, 0, 0), up: (0, 1, 0), focal_mm: 50)}, layout: {"a": (1, 2)})"#;
        let plain = r#"(format: 1, nodes: {
            "pen": (kind: "stroke_input", inputs: {"strokes": [
                (id: 1, x: [1,2], y: [1,0], z: [1,0], pressure: [1,0], time: [0,1]),
            ]}),
            "a": (kind: "resample"),
        }, links: {"a.curves": "pen.curves"})"#;
        let hash = |text: &str| document_hash(&crate::file::read(text).unwrap().document);
        assert_eq!(crate::file::read(full).unwrap().warnings, []);
        assert_eq!(hash(full), hash(plain));
        assert_ne!(hash(plain), hash(&plain.replace("x: [1,2]", "x: [1,3]")));
        assert_ne!(hash(plain), hash(&plain.replace("time: [0,1]", "time: [0,1], tilt_x: [1,0]")));
    }

    #[test]
    fn the_hash_does_not_see_tuft_borders_sharing_or_defaults_written_out() {
        let whole = content_hash(&Curves::new(vec![tuft(1..5, &[0.1; 4])]));
        let cut = content_hash(&Curves::new(vec![tuft(1..3, &[0.1]), tuft(3..5, &[0.1, 0.1])]));
        assert_eq!(whole, cut);
        let plain = Curves::new(vec![tuft(1..3, &[WIDTH.default; 2]), tuft(3..5, &[])]);
        let full = Curves::new(vec![tuft(1..5, &[WIDTH.default])]);
        assert_eq!(content_hash(&plain), content_hash(&full));
        assert_ne!(whole, content_hash(&full));
    }

    #[test]
    fn a_column_by_points_counts_as_one_by_curves_only_where_none_varies() {
        let by_point = |values: Vec<f32>| {
            let mut b = tuft(1..3, &[]).edit();
            b.set(RADIUS, Domain::Point, values);
            content_hash(&Curves::new(vec![b.build().into()]))
        };
        assert_eq!(by_point(vec![2.0]), by_point(vec![2.0]));
        assert_ne!(by_point(vec![2.0, 2.0, 2.0, 1.0]), by_point(vec![2.0]));
    }
}
