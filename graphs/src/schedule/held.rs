//! How many bytes the values of a node hold, counted from their buffers.
//!
//! Guarantees: a buffer that a node shares with what it reads counts where it was made and nowhere else, so a node that passes its
//! hair on holds nothing; what is set in the document is the document's. Heads are counted when a run has ended ([`of_scalps`]), for
//! what is asked of them (the distance field, the chart) is built by whoever asks first. Not counted: what allocators add.

use coif_nodes::data::field::Field;
use coif_nodes::data::scalp::Scalp;
use coif_nodes::define::Value;
use std::collections::HashSet;
use std::sync::Arc;

/// Bytes of what a node gives and was not given, without its heads.
pub(super) fn new_bytes(inputs: &[Vec<Value>], outputs: &[Value]) -> usize {
    let mut count = Count::default();
    inputs.iter().flatten().for_each(|value| count.value(value));
    count.bytes = 0;
    let without_heads = outputs.iter().filter(|value| !matches!(value, Value::Scalp(_)));
    without_heads.for_each(|value| count.value(value));
    count.bytes
}

/// Bytes of heads by the steps that gave them, in the order of the plan.
pub(super) fn of_scalps(given: &[Vec<Arc<Scalp>>]) -> Vec<usize> {
    let mut count = Count::default();
    let each = |scalps: &Vec<Arc<Scalp>>| {
        count.bytes = 0;
        scalps.iter().for_each(|scalp| scalp.buffers(&mut |at, bytes| count.buffer(at, bytes)));
        count.bytes
    };
    given.iter().map(each).collect()
}

/// Bytes of buffers, each counted once.
#[derive(Default)]
struct Count {
    known: HashSet<usize>,
    bytes: usize,
}

impl Count {
    fn buffer(&mut self, at: usize, bytes: usize) {
        self.bytes += if self.known.insert(at) { bytes } else { 0 };
    }

    fn value(&mut self, value: &Value) {
        match value {
            Value::Curves(curves) => {
                for tuft in curves.tufts() {
                    let at = Arc::as_ptr(tuft) as usize;
                    if !self.known.contains(&at) {
                        self.buffer(at, tuft.own_bytes());
                        tuft.buffers(&mut |at, bytes| self.buffer(at, bytes));
                    }
                }
            }
            Value::Scalp(scalp) => scalp.buffers(&mut |at, bytes| self.buffer(at, bytes)),
            Value::File(file) => self.buffer(Arc::as_ptr(file) as usize, file.bytes.len()),
            Value::Strokes(all) => self.buffer(Arc::as_ptr(all) as usize, all.bytes()),
            Value::Gestures(all) => self.buffer(Arc::as_ptr(all) as usize, all.bytes()),
            Value::Field(field) => self.field(field),
            _ => {}
        }
    }

    fn field(&mut self, field: &Field) {
        match field {
            Field::Painted(one) => self.buffer(Arc::as_ptr(one) as usize, one.bytes()),
            Field::Texture(one) => self.buffer(Arc::as_ptr(one) as usize, one.bytes()),
            Field::Product(parts) => parts.iter().for_each(|part| self.field(part)),
            _ => {}
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use coif_nodes::data::attributes::{Domain, ID, WIDTH};
    use coif_nodes::data::curves::{Curves, Tuft, TuftBuilder};
    use glam::Vec3;

    fn hair(n: usize) -> Tuft {
        let mut b = TuftBuilder::new();
        (0..n).for_each(|i| b.push_curve(&[Vec3::ZERO, Vec3::Y * i as f32]));
        b.set(ID, Domain::Curve, (1..=n as u64).collect());
        b.build()
    }

    #[test]
    fn what_is_shared_counts_where_it_was_made() {
        let made = hair(1000);
        let mut wider = made.edit();
        wider.set(WIDTH, Domain::Curve, (0..1000).map(|i| i as f32).collect());
        let (made, wider) = (Arc::new(made), Arc::new(wider.build()));
        let value = |tufts: &[&Arc<Tuft>]| {
            Value::Curves(Curves::new(tufts.iter().map(|tuft| (*tuft).clone()).collect()))
        };
        let all = new_bytes(&[], &[value(&[&made])]);
        // 2000 points, 1001 offsets, 1000 ids.
        assert!(all >= 24_000 + 4_004 + 8_000, "{all}");
        assert_eq!(new_bytes(&[], &[value(&[&made]), value(&[&made, &made])]), all);
        let given = [vec![value(&[&made])]];
        assert_eq!(new_bytes(&given, &[value(&[&made])]), 0);
        // Only the new column is new.
        let added = new_bytes(&given, &[value(&[&wider])]);
        assert!((4_000..5_000).contains(&added), "{added}");
        assert_eq!(new_bytes(&[], &[value(&[&made, &wider])]), all + added);
    }
}
