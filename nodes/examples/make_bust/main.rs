//! Makes the built-in bust, `nodes/src/scalp/bust.bin`, from nothing but the numbers in this folder.
//!
//! Run offline: `cargo run --release -p coif-nodes --example make_bust`. The shape is modelled in code
//! (`shape.rs`), after published averages of adult heads; no scan or other mesh went into it.
//! Guarantees: deterministic on one machine. Other machines' maths may differ in the last bits, so the
//! file that is checked in is the bust, and this program is how it came about.
#![allow(clippy::disallowed_methods, reason = "offline generator: its output is checked in")]
#![allow(missing_docs, unreachable_pub, reason = "an example has no public interface")]

mod finish;
mod mesher;
mod shape;
mod uv;
mod vector;

use vector::V;

fn main() {
    let bust = shape::Bust::new();
    let mut soup = mesher::cut_out(&bust, 0.16);
    println!("cut out: {} triangles in the half", soup.triangles.len());
    let size = |p: V| bust.edge_length(p).min(finish::edge_length_at_hairline(p));
    soup.remesh(&bust, &size, 7);
    println!("remeshed: {}", soup.triangles.len());
    // Edges along every border that must look clean.
    soup.cut_along(&bust, 0.38, &|p| bust.base_level(p));
    soup.ease(&bust, &size, &|p| p.y > -26.0 || p.x == 0.0 || bust.base_level(p).abs() < 0.04);
    soup.cut_along(&bust, 0.3, &|p| bust.mouth_level(p));
    soup.cut_along(&bust, 0.3, &|p| bust.lip_level(p));
    soup.cut_along(&bust, 0.3, &|p| bust.eye_level(p));
    soup.cut_along(&bust, 0.3, &|p| bust.iris_level(p));
    println!("cut along lips and eyes: {}", soup.triangles.len());
    soup.drop_slivers(0.015, &size);
    let (points, triangles) = soup.mirrored();
    println!("whole: {} points, {} triangles", points.len(), triangles.len());
    let made = finish::finish(&bust, points, triangles);
    let path = std::env::args().nth(1).unwrap_or_else(|| "nodes/src/scalp/bust.bin".into());
    let bytes = made.bytes();
    println!("{} bytes", bytes.len());
    std::fs::write(path, bytes).expect("the file can be written");
}
