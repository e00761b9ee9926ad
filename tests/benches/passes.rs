//! What drawing costs: 100,000 strands of 16 points at 1280 x 720, pass by pass, and their upload.
//!
//! Prints for the adapter at hand: time to make the device and its shaders, to upload all hair and one tuft in ten, to
//! the first whole sample and to 32; then the mean wall time of each pass, which is measured by the renderer around its slices.
//! Run it alone: `cargo bench -p coif-tests --bench passes`.

use coif_nodes::data::curves::{Curves, TuftBuilder};
use coif_shaders::camera::{Subject, Viewpoint, frame};
use coif_shaders::surface::{RootGrid, SPREAD, Tone, ground, head_solid};
use coif_shaders::view::Paint;
use coif_shaders::{Renderer, Rig};
use coif_tests::{gpu, groom};
use glam::Vec3;
use std::time::Instant;

fn main() {
    // `cargo test --benches` only asks whether it starts.
    if std::env::args().any(|arg| arg == "--test") {
        return;
    }
    let ms = |began: Instant| began.elapsed().as_secs_f64() * 1e3;
    let began = Instant::now();
    let Some(gpu) = gpu("passes") else { return };
    let mut renderer = Renderer::new(gpu, 1280, 720).expect("a picture");
    println!("{}, {}", renderer.gpu().info.name, renderer.gpu().info.driver_info);
    println!("device and shaders: {:.0} ms", ms(began));
    let edits = [("hair.by", "count"), ("hair.count", "100000"), ("hair.points", "16")];
    let groom = groom("start", &edits, &[]);
    println!("{} strands, {} points", groom.hair.curve_count(), groom.hair.point_count());
    let subject = Subject {
        frame: *groom.scalp.frame(),
        surface: Some(groom.scalp.surface()),
        hair: &groom.hair,
    };
    let began = Instant::now();
    let mut solids = vec![head_solid(&groom.scalp, Tone::Monk(5))];
    solids.extend(ground(&solids, f32::INFINITY));
    renderer.set_solids(solids);
    renderer.set_roots(RootGrid::of(&groom.hair, SPREAD, 1.0));
    renderer.set_camera(&frame(&Viewpoint::ThreeQuarter, &subject, 85.0, 1280.0 / 720.0));
    renderer.set_rig(&Rig::named("studio").expect("a rig"));
    println!("scene: {:.0} ms", ms(began));
    for (name, hair) in [("all", groom.hair.clone()), ("one tuft in ten", moved(&groom.hair))] {
        let began = Instant::now();
        let sent = renderer.set_hair(&hair, &Paint::hair());
        let mib = sent.bytes as f64 / (1 << 20) as f64;
        println!("upload of {name}: {:.1} ms, {} tufts, {mib:.1} MiB", ms(began), sent.tufts);
    }
    let before = renderer.spent();
    let began = Instant::now();
    for samples in [1, 32] {
        renderer.render(samples, &|_| false);
        println!("{samples} samples: {:.2} s", ms(began) / 1e3);
    }
    for ((pass, after, _), (_, before, _)) in renderer.spent().into_iter().zip(before) {
        println!("{:14} {:9.1} ms in all", format!("{pass:?}"), after - before);
    }
}

/// The same hair with every tenth tuft elsewhere.
fn moved(hair: &Curves) -> Curves {
    let tufts = hair.tufts().iter().enumerate().map(|(i, tuft)| {
        if i % 10 > 0 {
            return tuft.clone();
        }
        let mut moved = TuftBuilder::new();
        for i in 0..tuft.len() {
            let points: Vec<Vec3> = tuft.curve(i).iter().map(|p| *p + 0.01 * Vec3::X).collect();
            moved.push_curve(&points);
        }
        tuft.attributes().iter().for_each(|attribute| moved.set_column(attribute.clone()));
        moved.build().into()
    });
    Curves::new(tufts.collect())
}
