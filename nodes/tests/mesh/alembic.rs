//! What reading curves of damaged Alembic files takes: never more than the file is worth.

use crate::work::count;
use coif_nodes::data::attributes::{Attribute, COLOUR, Domain, ID, Item, ROOT_UV};
use coif_nodes::data::curves::{Curves, TuftBuilder};
use coif_nodes::formats::abc::read_curves;
use coif_nodes::formats::export::{About, Format, HairGroup, write};
use glam::{Vec2, Vec3};
use std::sync::Arc;

/// A file of `n` curves of 8 points with `more` attributes of points that are all alike, so that the file holds them once.
fn file(n: usize, more: usize) -> Vec<u8> {
    let mut b = TuftBuilder::even((0..8 * n).map(|k| Vec3::splat(k as f32)).collect(), 8);
    b.set(ID, Domain::Curve, (1..=n as u64).collect());
    b.set(ROOT_UV, Domain::Curve, (0..n).map(|k| Vec2::splat(k as f32)).collect());
    b.set(COLOUR, Domain::Curve, vec![Vec3::X]);
    for k in 0..more {
        let values = f32::column((0..8 * n).map(|k| k as f32).collect());
        let name = format!("more{k}").into();
        b.set_column(Attribute { name, domain: Domain::Point, values });
    }
    let curves = Curves::new(vec![Arc::new(b.build())]);
    let about = About {
        title: "x".into(),
        generator: "x".into(),
        graph_hash: String::new(),
        seed: 0,
        sections: Default::default(),
    };
    let mut out = std::io::Cursor::new(vec![]);
    let group = HairGroup { name: "hair".into(), guides: false, curves };
    write(Format::Abc, &[group], &[], &about, &mut out, &|| false).unwrap();
    out.into_inner()
}

/// Whether curves are read from bytes, which may take 128 KiB and five times the file at most.
#[track_caller]
fn check(bytes: &[u8]) -> bool {
    let (read, work) = count(|| read_curves(bytes).is_ok());
    let allowed = (128 << 10) + 5 * bytes.len() as u64;
    assert!(work.held <= allowed, "{} bytes, where {allowed} are allowed", work.held);
    read
}

#[test]
fn damaged_alembic_takes_no_more_memory_than_it_is_worth() {
    let whole = file(600, 2);
    assert!(check(&whole));
    for length in (0..whole.len()).step_by(whole.len() / 60) {
        assert!(!check(&whole[..length]), "{length}");
    }
    // Every byte of the last 6,000, where headers lie, and some of the rest.
    let from = whole.len() - 6_000;
    let mut read = 0;
    for at in (from..whole.len()).chain((0..from).step_by(97)) {
        let mut bytes = whole.clone();
        bytes[at] ^= 1 << (at % 8);
        read += usize::from(check(&bytes));
    }
    assert!(read > 500, "{read}");
}

#[test]
fn a_file_that_means_the_same_values_a_thousand_times_is_refused() {
    // A thousand times 4,800 values of 4 bytes: 19 MB out of a file of less than 400 kB.
    let bomb = file(600, 1000);
    assert!(bomb.len() < 400_000, "{}", bomb.len());
    assert!(!check(&bomb));
}
