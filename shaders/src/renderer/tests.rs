//! What the renderer promises, on a few hundred made-up curves: pictures do not depend on what was uploaded, interrupted or
//! sliced before; upload sends what differs; odd scenes give finite pictures.

use super::*;
use crate::Precision;
use crate::camera::{Subject, Viewpoint, frame};
use crate::display::Transform;
use crate::environment::{Backdrop, Environment};
use crate::surface::Material;
use coif_nodes::data::attributes::{COLOUR, Domain, WIDTH};
use coif_nodes::data::curves::TuftBuilder;
use coif_nodes::data::scalp::HeadFrame;
use coif_nodes::maths::closest::Surface;
use coif_nodes::maths::hash::Dice;
use glam::{Mat4, Vec2};
use std::sync::{Mutex, MutexGuard, OnceLock, PoisonError};

mod maps;

const SIZE: [u32; 2] = [96, 64];

/// The device and a renderer, the same for all tests here, which take turns. Says so where there is no adapter.
fn renderer(test: &str) -> Option<MutexGuard<'static, Renderer>> {
    static SHARED: OnceLock<Option<Mutex<Renderer>>> = OnceLock::new();
    let made = SHARED.get_or_init(|| {
        let gpu = Arc::new(Gpu::new(Precision::Best).ok()?);
        Some(Mutex::new(Renderer::new(gpu, SIZE[0], SIZE[1]).expect("a small picture")))
    });
    let Some(shared) = made else {
        println!("skipped: {test} no graphics adapter");
        return None;
    };
    let mut renderer = shared.lock().unwrap_or_else(PoisonError::into_inner);
    renderer.resize(SIZE[0], SIZE[1]).expect("a small picture");
    forget(&mut renderer);
    Some(renderer)
}

/// Takes all that was uploaded away, as if the renderer were new.
fn forget(renderer: &mut Renderer) {
    renderer.strands = Strands::new(&renderer.gpu);
    renderer.drawn = renderer.strands.blocks(&renderer.gpu, 1.0, 1.0);
    renderer.shadowing = renderer.strands.blocks(&renderer.gpu, 1.0, 1.0);
    renderer.stale = Stale::ALL;
    renderer.rates = [None; PASSES];
    renderer.restart();
}

/// A tuft of wavy curves, each with a colour of its own.
fn tuft(seed: u64, curves: u64, points: usize) -> Arc<Tuft> {
    let dice = Dice::new(seed, 1, "tuft");
    let mut tuft = TuftBuilder::new();
    let corner = Vec3::new(dice.range(0, 1, -7.0, 7.0), 4.0, dice.range(0, 2, -3.0, 3.0));
    let mut colours = vec![];
    for i in 1..=curves {
        let root =
            corner + 1.5 * Vec3::new(dice.signed(i, 1), dice.signed(i, 2), dice.signed(i, 3));
        let turn = dice.range(i, 4, 0.0, 6.0);
        let length = dice.range(i, 5, 3.0, 9.0);
        let place = |j: usize| {
            let t = j as f32 / (points - 1).max(1) as f32;
            root + Vec3::new((turn + 5.0 * t).cos(), -length * t, (turn + 4.0 * t).sin())
        };
        tuft.push_curve(&(0..points).map(place).collect::<Vec<_>>());
        colours.push(Vec3::new(dice.unit(i, 6), dice.unit(i, 7), dice.unit(i, 8)));
    }
    tuft.set(COLOUR, Domain::Curve, colours);
    tuft.set(WIDTH, Domain::Curve, vec![0.04]);
    Arc::new(tuft.build())
}

fn tufts(range: std::ops::Range<u64>) -> Vec<Arc<Tuft>> {
    range.map(|seed| tuft(seed, 5 + seed % 11, 6 + (seed % 5) as usize)).collect()
}

fn curve(points: &[Vec3], width: f32) -> Curves {
    let mut tuft = TuftBuilder::new();
    tuft.push_curve(points);
    tuft.set(WIDTH, Domain::Curve, vec![width]);
    Curves::new(vec![Arc::new(tuft.build())])
}

/// A square sheet, facing the viewer.
fn sheet(z: f32) -> Solid {
    let points = [(-4.0, -4.0), (4.0, -4.0), (4.0, 4.0), (-4.0, 4.0)];
    Solid {
        points: points.map(|(x, y)| Vec3::new(x, y, z)).to_vec(),
        normals: vec![Vec3::Z; 4],
        colours: vec![Vec3::splat(0.4); 4],
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        material: Material::Clay,
        casts: true,
        maps: None,
    }
}

/// What is drawn, all of it.
struct Scene {
    hair: Curves,
    paint: Paint,
    solids: Vec<Solid>,
    camera: Camera,
    rig: Rig,
    look: Look,
    samples: u32,
}

impl Scene {
    fn of(tufts: Vec<Arc<Tuft>>) -> Self {
        let mut rig = Rig::named("studio").expect("a rig");
        rig.environment =
            Environment { backdrop: Backdrop::Plain(Vec3::splat(0.1)), ..rig.environment };
        Self {
            hair: Curves::new(tufts),
            paint: Paint::hair(),
            solids: vec![sheet(-2.0)],
            camera: Camera {
                eye: Vec3::new(6.0, 3.0, 40.0),
                target: Vec3::ZERO,
                up: Vec3::Y,
                focal_mm: 50.0,
                orthographic: None,
            },
            rig,
            look: Look::default(),
            samples: 2,
        }
    }

    /// Hair alone under rays that are parallel: ten pixels a cm.
    fn flat(hair: Curves) -> Self {
        let mut scene = Self { hair, solids: vec![], ..Self::of(vec![]) };
        scene.camera = Camera { eye: Vec3::Z * 50.0, orthographic: Some(6.4), ..scene.camera };
        scene
    }

    fn set(&self, renderer: &mut Renderer) {
        renderer.set_camera(&self.camera);
        renderer.set_rig(&self.rig);
        renderer.set_look(&self.look);
        renderer.set_solids(self.solids.clone());
        renderer.set_hair(&self.hair, &self.paint);
    }

    fn draw(&self, renderer: &mut Renderer) -> Picture {
        self.set(renderer);
        finish(renderer, self.samples)
    }
}

/// The finished picture, whose numbers are sound.
#[track_caller]
fn finish(renderer: &mut Renderer, samples: u32) -> Picture {
    assert!(renderer.render(samples, &|_| false));
    let picture = renderer.picture();
    check_sound(&picture, renderer.size());
    picture
}

#[track_caller]
fn check_sound(picture: &Picture, (width, height): (u32, u32)) {
    assert_eq!((picture.width, picture.height), (width, height));
    assert_eq!(picture.linear.len(), (width * height) as usize);
    for pixel in &picture.linear {
        assert!(pixel.iter().all(|x| x.is_finite()), "{pixel:?}");
        assert!((0.0..=1.0).contains(&pixel[3]), "coverage {}", pixel[3]);
    }
}

#[track_caller]
fn check_same(ours: &Picture, other: &Picture, what: &str) {
    assert_eq!((ours.width, ours.height), (other.width, other.height), "{what}");
    let bits =
        |p: &Picture| -> Vec<[u32; 4]> { p.linear.iter().map(|c| c.map(f32::to_bits)).collect() };
    let (a, b) = (bits(ours), bits(other));
    let differ = a.iter().zip(&b).filter(|(a, b)| a != b).count();
    assert_eq!(differ, 0, "{what}: so many pixels of {} differ", a.len());
}

fn coverage(picture: &Picture) -> f64 {
    picture.linear.iter().map(|c| f64::from(c[3])).sum()
}

/// What every third pixel of every third row names: key of the tuft, curve and point.
fn picks(renderer: &mut Renderer) -> Vec<Option<(Arc<Tuft>, usize, usize)>> {
    let (width, height) = renderer.size();
    let pixels = (0..height).step_by(3).flat_map(|y| (0..width).step_by(3).map(move |x| (x, y)));
    pixels.map(|(x, y)| renderer.pick(x, y, 0)).collect()
}

#[test]
fn what_is_shown_is_the_picture_encoded() {
    let Some(mut renderer) = renderer("what_is_shown_is_the_picture_encoded") else { return };
    let black = [0, 0, 0, 255].repeat((SIZE[0] * SIZE[1]) as usize);
    assert_eq!(renderer.shown(Transform::Agx, 0.0), black, "before the first sample");
    let scene = Scene::of(tufts(0..20));
    for (samples, size) in [(1, SIZE), (3, [67, 41])] {
        renderer.resize(size[0], size[1]).expect("a small picture");
        scene.set(&mut renderer);
        let picture = finish(&mut renderer, samples);
        for (transform, exposure) in
            [(Transform::Agx, 0.0), (Transform::Srgb, 1.5), (Transform::Rec1886, -2.0)]
        {
            let theirs = renderer.shown(transform, exposure);
            let ours = picture.encoded(transform, exposure);
            assert_eq!(theirs.len(), ours.len());
            let off = theirs.iter().zip(&ours).map(|(a, b)| a.abs_diff(*b));
            let most = off.clone().max();
            let differ = off.filter(|off| *off > 0).count();
            assert!(
                most <= Some(1) && differ * 50 < ours.len(),
                "{transform:?}: {differ} {most:?}"
            );
            assert!(ours.iter().any(|b| *b > 40 && *b < 255), "something is seen");
        }
        assert_eq!(renderer.progress().samples, samples, "showing changes nothing");
    }
}

// --- upload -------------------------------------------------------------------------------------

/// Nothing that is exported was ever computed on the GPU: it gets positions and gives none back. So that what it shows is what
/// is exported, it must have them bit for bit.
#[test]
fn the_gpu_holds_the_positions_bit_for_bit() {
    let Some(mut renderer) = renderer("the_gpu_holds_the_positions_bit_for_bit") else { return };
    let mut odd = TuftBuilder::new();
    odd.push_curve(&[]);
    odd.push_curve(&[Vec3::X]);
    odd.push_curve(&[Vec3::ONE; 3]);
    odd.push_curve(&[Vec3::new(-0.0, 1e-40, 3.0e7), Vec3::splat(f32::MIN_POSITIVE)]);
    odd.push_curve(&[Vec3::ZERO, Vec3::new(f32::NAN, f32::INFINITY, 1.0), Vec3::Y]);
    let mut all = tufts(0..9);
    all.push(Arc::new(odd.build()));
    renderer.strands.limit_chunks(150);
    renderer.set_hair(&Curves::new(all.clone()), &Paint::hair());
    let places = renderer.strands.places();
    assert_eq!(places.len(), all.len());
    assert!(renderer.strands.chunks.len() > 2);
    for ((tuft, chunk, first), sent) in places.iter().zip(&all) {
        assert_eq!(tuft.key(), sent.key());
        let size = 16 * tuft.points().len() as u64;
        let points = &renderer.strands.chunks[*chunk].points;
        let bytes = read(&renderer.gpu, points, u64::from(*first) * 16, size);
        let words: Vec<[u32; 4]> = bytemuck::pod_collect_to_vec(&bytes);
        for i in 0..tuft.len() {
            let sound = tuft.curve(i).iter().all(|p| p.is_finite());
            for (j, k) in tuft.range(i).enumerate() {
                let [x, y, z, word] = words[k];
                let place = tuft.points()[k].to_array().map(f32::to_bits);
                assert_eq!([x, y, z], place, "curve {i}, point {j}");
                let (u, last) = ((word >> 16) & 0x7fff, word >> 31 == 1);
                assert_eq!(u == 0, j == 0, "curve {i}, point {j}: only roots have u 0");
                let ends = j + 1 == tuft.curve(i).len();
                assert_eq!(last, ends || !sound, "curve {i}, point {j}: the last bit");
                let radius = half::f16::from_bits(word as u16).to_f32();
                let width = tuft.view(WIDTH).at(i, k);
                assert!((2.0 * radius - width).abs() <= 0.001 * width, "{radius} of {width}");
            }
        }
    }
}

#[test]
fn only_what_differs_is_sent() {
    let Some(mut renderer) = renderer("only_what_differs_is_sent") else { return };
    let scene = Scene::of(tufts(0..12));
    let points = |t: &[Arc<Tuft>]| t.iter().map(|t| t.points().len() as u64).sum::<u64>();
    let mut all = tufts(0..12);
    let hair = Paint::hair();
    let grey = Paint::plain(Vec3::splat(0.3));
    let mut check = |tufts: &[Arc<Tuft>], paint: &Paint, sent, kept, removed, bytes, what: &str| {
        let uploaded = renderer.set_hair(&Curves::new(tufts.to_vec()), paint);
        assert_eq!(uploaded, Uploaded { tufts: sent, kept, removed, bytes }, "{what}");
    };
    check(&all, &hair, 12, 0, 0, 20 * points(&all), "all at first");
    check(&all, &hair, 0, 12, 0, 0, "the same again");
    let copies: Vec<Arc<Tuft>> = scene.hair.tufts().to_vec();
    check(&copies, &hair, 0, 12, 0, 0, "the same, made anew");
    check(&all, &grey, 0, 12, 0, 4 * points(&all), "another paint");
    check(&all, &grey, 0, 12, 0, 0, "the same paint again");
    check(&all, &hair, 0, 12, 0, 4 * points(&all), "the first paint again");
    all[5] = tuft(77, 9, 8);
    check(&all, &hair, 1, 11, 1, 20 * 72, "one changed");
    all.reverse();
    check(&all, &hair, 0, 12, 0, 0, "reordered");
    all.remove(3);
    check(&all, &hair, 0, 11, 1, 0, "one less");
    all.push(all[0].clone());
    let twin = 20 * points(&all[..1]);
    check(&all, &hair, 1, 11, 0, twin, "one twice");
    check(&[], &hair, 0, 0, 12, 0, "none");
    check(&[], &hair, 0, 0, 0, 0, "none again");
    // What is not there any more is not kept for later either.
    check(&all, &hair, 12, 0, 0, 20 * points(&all), "all again");
}

#[test]
fn a_picture_goes_on_where_nothing_differs() {
    let Some(mut renderer) = renderer("a_picture_goes_on_where_nothing_differs") else { return };
    let mut scene = Scene::of(tufts(0..12));
    scene.draw(&mut renderer);
    renderer.set_hair(&scene.hair, &scene.paint);
    assert_eq!(renderer.progress().samples, scene.samples);
    // Another paint begins anew, but light is as it was.
    scene.paint = Paint::plain(Vec3::splat(0.3));
    renderer.set_hair(&scene.hair, &scene.paint);
    assert_eq!(renderer.progress().samples, 0);
    assert_eq!(renderer.stale, Stale::default());
    let picture = finish(&mut renderer, scene.samples);
    forget(&mut renderer);
    check_same(&picture, &scene.draw(&mut renderer), "repainted");
}

#[test]
fn pictures_do_not_depend_on_what_was_uploaded_before() {
    let test = "pictures_do_not_depend_on_what_was_uploaded_before";
    let Some(mut edited) = renderer(test) else { return };
    let mut fresh = Renderer::new(edited.gpu.clone(), SIZE[0], SIZE[1]).expect("a small picture");
    edited.strands.limit_chunks(700);
    let dice = Dice::new(5, 1, "edits");
    let mut all = tufts(0..20);
    let (mut most_chunks, mut begun_anew) = (0, 0);
    for edit in 0..40 {
        let pick = |index, n: usize| dice.below(edit, index, n.max(1) as u32) as usize;
        let at = pick(1, all.len());
        let made = tuft(100 + edit, 1 + pick(2, 16) as u64, 2 + pick(3, 12));
        match pick(4, 8) {
            0 if !all.is_empty() => all[at] = made,
            1 if !all.is_empty() => drop(all.remove(at)),
            2 => all.insert(at, made),
            3 => all.reverse(),
            // Grown and shrunk: the same curves and more, or some of them.
            4 if !all.is_empty() => {
                let mut grown = all[at].gather(&(0..all[at].len() as u32).collect::<Vec<_>>());
                grown.push_curve(&[Vec3::ZERO, Vec3::new(2.0, 1.0, 3.0), Vec3::X * 5.0]);
                grown.remove(COLOUR.name);
                all[at] = Arc::new(grown.build());
            }
            5 if !all.is_empty() => {
                let some: Vec<u32> = (0..all[at].len() as u32).step_by(2).collect();
                all[at] = Arc::new(all[at].gather(&some).build());
            }
            6 => all.truncate(at / 2),
            _ => all.extend(tufts(200 + 20 * edit..200 + 20 * edit + 1 + pick(5, 14) as u64)),
        }
        let scene = Scene { samples: 1, ..Scene::of(all.clone()) };
        let before = edited.strands.places();
        let sent = edited.set_hair(&scene.hair, &scene.paint);
        let kept = before.iter().filter(|(t, ..)| all.iter().any(|a| a.key() == t.key())).count();
        begun_anew += usize::from(sent.kept == 0 && kept > 0);
        most_chunks = most_chunks.max(edited.strands.chunks.len());
        if edit % 4 == 3 {
            let picture = scene.draw(&mut edited);
            forget(&mut fresh);
            check_same(&picture, &scene.draw(&mut fresh), &format!("after edit {edit}"));
            let (ours, theirs) = (picks(&mut edited), picks(&mut fresh));
            for (ours, theirs) in ours.iter().zip(&theirs) {
                let name = |(t, i, j): &(Arc<Tuft>, usize, usize)| (t.key(), *i, *j);
                assert_eq!(ours.as_ref().map(name), theirs.as_ref().map(name), "edit {edit}");
            }
        }
    }
    // The edits were such that all of it was needed.
    assert!(most_chunks > 2, "{most_chunks} chunks");
    assert!(begun_anew > 0, "never laid out anew");
}

#[test]
fn a_pixel_names_the_hair_that_it_shows() {
    let Some(mut renderer) = renderer("a_pixel_names_the_hair_that_it_shows") else { return };
    renderer.strands.limit_chunks(300);
    let scene = Scene { samples: 1, ..Scene::of(tufts(0..30)) };
    let picture = scene.draw(&mut renderer);
    let clip = Mat4::from_cols_array_2d(&renderer.frame.clip_from_world);
    let pixel_of = |p: Vec3| {
        let p = clip.project_point3(p);
        Vec2::new(p.x * 0.5 + 0.5, 0.5 - p.y * 0.5) * Vec2::new(SIZE[0] as f32, SIZE[1] as f32)
    };
    let mut named = 0;
    for y in (0..SIZE[1]).step_by(2) {
        for x in (0..SIZE[0]).step_by(2) {
            let Some((tuft, i, point)) = renderer.pick(x, y, 0) else { continue };
            named += 1;
            assert!(picture.linear[(y * SIZE[0] + x) as usize][3] == 1.0);
            assert!(tuft.range(i).contains(&point) && tuft.range(i).contains(&(point + 1)));
            let [a, b] = [0, 1].map(|k| pixel_of(tuft.points()[point + k]));
            let at = Vec2::new(x as f32 + 0.5, y as f32 + 0.5);
            let t = ((at - a).dot(b - a) / (b - a).length_squared().max(1e-6)).clamp(0.0, 1.0);
            let off = at.distance(a.lerp(b, t));
            assert!(off < 3.0, "pixel {x}, {y} is {off} pixels from what it names");
        }
    }
    assert!(named > 100, "{named}");
    assert!(renderer.pick(SIZE[0], 0, 0).is_none() && renderer.pick(0, SIZE[1], 0).is_none());
}

// --- slices -------------------------------------------------------------------------------------

/// One step as small as steps can be.
fn crawl(renderer: &mut Renderer, samples: u32) {
    renderer.rates = [Some(1e9); PASSES];
    renderer.advance(samples, Duration::ZERO);
}

#[test]
fn slices_of_any_size_give_the_same_picture() {
    let Some(mut renderer) = renderer("slices_of_any_size_give_the_same_picture") else { return };
    let scene = Scene { samples: 3, ..Scene::of(tufts(0..40)) };
    let whole = scene.draw(&mut renderer);
    forget(&mut renderer);
    scene.set(&mut renderer);
    let mut steps = 0;
    while renderer.progress().samples < scene.samples {
        crawl(&mut renderer, scene.samples);
        steps += 1;
    }
    assert!(steps > 60, "{steps}");
    check_same(&whole, &renderer.picture(), "tiny slices");
    forget(&mut renderer);
    scene.set(&mut renderer);
    renderer.rates = [Some(0.0); PASSES];
    check_same(&whole, &finish(&mut renderer, scene.samples), "large slices");
    // A GPU gets several passes in one submission.
    let mut gpu = Gpu::new(Precision::Best).expect("as before");
    gpu.info.device_type = wgpu::DeviceType::DiscreteGpu;
    let mut batched = Renderer::new(Arc::new(gpu), SIZE[0], SIZE[1]).expect("a small picture");
    scene.draw(&mut batched);
    batched.rates = [Some(1e-6); PASSES];
    forget(&mut batched);
    batched.rates = [Some(1e-6); PASSES];
    check_same(&whole, &scene.draw(&mut batched), "passes in one submission");
}

#[test]
fn a_picture_is_a_sum_of_whole_samples_whenever_it_is_asked_for() {
    let test = "a_picture_is_a_sum_of_whole_samples_whenever_it_is_asked_for";
    let Some(mut renderer) = renderer(test) else { return };
    let scene = Scene::of(tufts(0..30));
    scene.set(&mut renderer);
    let nothing = renderer.picture();
    assert!(nothing.linear.iter().flatten().all(|x| *x == 0.0), "before the first sample");
    let wholes: Vec<Picture> = (0..3)
        .map(|n| {
            forget(&mut renderer);
            scene.set(&mut renderer);
            if n > 0 { finish(&mut renderer, n) } else { renderer.picture() }
        })
        .collect();
    for slices in (0..140).step_by(3) {
        renderer.restart();
        for _ in 0..slices {
            crawl(&mut renderer, 2);
        }
        let picture = renderer.picture();
        let samples = renderer.progress().samples;
        check_same(&picture, &wholes[samples as usize], &format!("after {slices} slices"));
        let seen = renderer.pick(40, 30, 0).map(|(t, i, j)| (t.key(), i, j));
        let again = renderer.pick(40, 30, 0).map(|(t, i, j)| (t.key(), i, j));
        assert_eq!(seen, again);
    }
}

#[test]
fn an_interruption_leaves_no_trace() {
    let Some(mut renderer) = renderer("an_interruption_leaves_no_trace") else { return };
    let first = Scene::of(tufts(0..25));
    let turned = Camera { eye: Vec3::new(-30.0, 10.0, 20.0), ..first.camera };
    let thin = Look { share: 0.3, beta_m: 0.5, scalp_tint: 0.0, ..Look::default() };
    let base = || Scene::of(tufts(0..25));
    let changes: [(&str, Scene); 8] = [
        ("camera", Scene { camera: turned, ..base() }),
        ("hair", Scene { hair: Curves::new(tufts(10..45)), ..base() }),
        ("no hair", Scene { hair: Curves::default(), ..base() }),
        ("paint", Scene { paint: Paint::plain(Vec3::splat(0.3)), ..base() }),
        ("solids", Scene { solids: vec![sheet(3.0), sheet(-5.0)], ..base() }),
        ("no solids", Scene { solids: vec![], ..base() }),
        ("rig", Scene { rig: Rig::named("backlit").expect("a rig"), ..base() }),
        ("look", Scene { look: thin, ..base() }),
    ];
    // Only what differs is set, as a viewport does.
    let change = |renderer: &mut Renderer, what: &str, to: &Scene| match what {
        "camera" => renderer.set_camera(&to.camera),
        "hair" | "no hair" | "paint" => drop(renderer.set_hair(&to.hair, &to.paint)),
        "solids" | "no solids" => renderer.set_solids(to.solids.clone()),
        "rig" => renderer.set_rig(&to.rig),
        _ => renderer.set_look(&to.look),
    };
    forget(&mut renderer);
    let at_first = first.draw(&mut renderer);
    for (what, other) in &changes {
        forget(&mut renderer);
        let wanted = other.draw(&mut renderer);
        for slices in [0, 40] {
            // From nothing to the first scene, so far; then to the other.
            forget(&mut renderer);
            first.set(&mut renderer);
            (0..slices).for_each(|_| crawl(&mut renderer, first.samples));
            change(&mut renderer, what, other);
            renderer.rates = [None; PASSES];
            let name = format!("{what} changed after {slices} slices");
            check_same(&finish(&mut renderer, other.samples), &wanted, &name);
            // Half way back, to the other again, and back.
            change(&mut renderer, what, &first);
            (0..slices).for_each(|_| crawl(&mut renderer, first.samples));
            change(&mut renderer, what, other);
            (0..slices).for_each(|_| crawl(&mut renderer, first.samples));
            change(&mut renderer, what, &first);
            renderer.rates = [None; PASSES];
            let name = format!("{what} changed back after {slices} slices");
            check_same(&finish(&mut renderer, first.samples), &at_first, &name);
        }
    }
}

#[test]
fn warming_up_changes_no_picture() {
    let Some(mut renderer) = renderer("warming_up_changes_no_picture") else { return };
    let scene = Scene::of(tufts(0..25));
    let wanted = scene.draw(&mut renderer);
    for slices in [0, 5, 20, 40, 50, 60] {
        renderer.restart();
        (0..slices).for_each(|_| crawl(&mut renderer, scene.samples));
        renderer.warm_up(&Look { model: Model::Chiang, ..Look::default() }, Shading::Colour);
        renderer.rates = [None; PASSES];
        let name = format!("after {slices} slices");
        check_same(&finish(&mut renderer, scene.samples), &wanted, &name);
    }
}

#[test]
fn a_size_is_as_if_there_had_never_been_another() {
    let test = "a_size_is_as_if_there_had_never_been_another";
    let Some(mut renderer) = renderer(test) else { return };
    let scene = Scene::of(tufts(0..25));
    let wanted = scene.draw(&mut renderer);
    let mut small = Renderer::new(renderer.gpu.clone(), 37, 50).expect("a small picture");
    let wanted_small = scene.draw(&mut small);
    renderer.resize(37, 50).expect("a small picture");
    assert!(renderer.picture().linear.iter().flatten().all(|x| *x == 0.0));
    check_same(&finish(&mut renderer, scene.samples), &wanted_small, "smaller");
    (0..10).for_each(|_| crawl(&mut renderer, 9));
    renderer.resize(SIZE[0], SIZE[1]).expect("a small picture");
    check_same(&finish(&mut renderer, scene.samples), &wanted, "as at first");
    for (width, height) in [(0, 5), (5, 0), (u32::MAX, u32::MAX), (1 << 14, 1 << 14)] {
        assert!(renderer.resize(width, height).is_err(), "{width} x {height}");
        assert_eq!(renderer.size(), (SIZE[0], SIZE[1]));
    }
    check_same(&finish(&mut renderer, scene.samples), &wanted, "after sizes that cannot be");
    renderer.resize(1, 1).expect("a very small picture");
    scene.draw(&mut renderer);
}

// --- what is drawn ------------------------------------------------------------------------------

#[test]
fn visibility_of_32_bits_shows_what_64_show() {
    let Some(mut wide) = renderer("visibility_of_32_bits_shows_what_64_show") else { return };
    let gpu = Arc::new(Gpu::new(Precision::Narrow).expect("as before"));
    assert!(!gpu.wide);
    let mut narrow = Renderer::new(gpu, SIZE[0], SIZE[1]).expect("a small picture");
    let scene = Scene { samples: 4, ..Scene::of(tufts(0..60)) };
    let (a, b) = (scene.draw(&mut wide), scene.draw(&mut narrow));
    let differ = a.linear.iter().flatten().zip(b.linear.iter().flatten());
    let mean = differ.map(|(a, b)| (a - b).abs()).sum::<f32>() / (4 * a.linear.len()) as f32;
    assert!(mean < 1e-3, "{mean}");
    // The same hair, elsewhere in memory.
    forget(&mut narrow);
    narrow.strands.limit_chunks(500);
    narrow.set_hair(&Curves::new(tufts(100..160)), &scene.paint);
    check_same(&b, &scene.draw(&mut narrow), "32 bits, again");
    assert!(narrow.strands.chunks.len() > 2);
    let (ours, theirs) = (picks(&mut wide), picks(&mut narrow));
    let named = |(t, i, j): &(Arc<Tuft>, usize, usize)| (t.key(), *i, *j);
    let same = ours.iter().zip(&theirs);
    let same = same.filter(|(a, b)| a.as_ref().map(named) == b.as_ref().map(named)).count();
    assert!(same * 100 >= ours.len() * 99, "{same} of {} pixels name the same", ours.len());
}

/// A hair covers its length times its width, however thin or wide, within what so few samples can tell.
#[test]
fn a_hair_covers_its_length_times_its_width() {
    let test = "a_hair_covers_its_length_times_its_width";
    let Some(mut renderer) = renderer(test) else { return };
    let mut check = |pixels: f32, to: Vec3, bend: f32, opacity: f32| {
        let middle = to * 0.5 + Vec3::new(-to.y, to.x, 0.0) * bend;
        let hair = curve(&[Vec3::ZERO, middle, to].map(|p| p - to * 0.5), pixels * 0.1);
        let mut scene = Scene { samples: 48, ..Scene::flat(hair) };
        scene.look.opacity = opacity;
        let covered = coverage(&scene.draw(&mut renderer));
        let [seen, half] = [to, middle].map(|p| p.truncate());
        let length = f64::from(half.length() + half.distance(seen)) * 10.0;
        let expected = length * f64::from(pixels * opacity);
        // One hit in so many, four times its standard error, and the ends' and the bend's share.
        let noise = 4.0 * (expected / 48.0).sqrt();
        let off = (covered - expected).abs();
        assert!(
            off <= noise + 0.02 * expected,
            "{pixels} pixels wide to {to}, opacity {opacity}: {covered} for {expected}"
        );
    };
    for pixels in [1e-4, 0.02, 0.3, 0.97, 2.5, 12.0] {
        check(pixels, Vec3::new(0.1, 4.0, 0.0), 0.0, 1.0);
        check(pixels, Vec3::new(6.0, 1.0, 0.0), 0.0, 1.0);
        check(pixels, Vec3::new(4.0, 2.0, 1.0), 0.02, 1.0);
    }
    for opacity in [0.5, 0.01, 1e-5, 1e-7, 1e-8, 0.0] {
        check(0.5, Vec3::new(6.0, 1.0, 0.0), 0.0, opacity);
    }
}

#[test]
fn what_cannot_be_drawn_draws_nothing_and_harms_nothing() {
    let test = "what_cannot_be_drawn_draws_nothing_and_harms_nothing";
    let Some(mut renderer) = renderer(test) else { return };
    let good = Scene::of(tufts(0..20));
    let wanted = good.draw(&mut renderer);
    let far = Vec3::splat(3e38);
    let nowhere: [(&str, Vec<Vec3>); 8] = [
        ("no point", vec![]),
        ("one point", vec![Vec3::ZERO]),
        ("one far point", vec![far]),
        ("no number", vec![Vec3::ZERO, Vec3::NAN, Vec3::ONE, Vec3::X]),
        ("no number at the root", vec![Vec3::NAN, Vec3::ONE, Vec3::X]),
        ("no number at the tip", vec![Vec3::ONE, Vec3::X, Vec3::NAN]),
        ("endless", vec![Vec3::ZERO, Vec3::INFINITY]),
        ("too long to measure", vec![-far, far]),
    ];
    for (what, points) in nowhere {
        // Before, between and behind hair, within its tufts and in tufts of its own.
        let mut odd = TuftBuilder::new();
        odd.push_curve(&points);
        odd.push_curve(&points);
        let odd = Arc::new(odd.build());
        let mut all = vec![odd.clone()];
        for tuft in good.hair.tufts() {
            all.extend([tuft.clone(), odd.clone()]);
        }
        forget(&mut renderer);
        let scene = Scene { hair: Curves::new(all), ..Scene::of(vec![]) };
        check_same(&scene.draw(&mut renderer), &wanted, what);
        let within = good.hair.tufts().iter().map(|tuft| {
            let mut mixed = TuftBuilder::new();
            for i in 0..tuft.len() {
                mixed.push_curve(tuft.curve(i));
                mixed.push_curve(&points);
            }
            let colour = |i: usize| tuft.view(COLOUR).at(i / 2, 0);
            mixed.set(COLOUR, Domain::Curve, (0..2 * tuft.len()).map(colour).collect());
            mixed.set(WIDTH, Domain::Curve, vec![0.04]);
            Arc::new(mixed.build())
        });
        let scene = Scene { hair: Curves::new(within.collect()), ..Scene::of(vec![]) };
        check_same(&scene.draw(&mut renderer), &wanted, &format!("{what}, within tufts"));
    }
}

/// A change to the usual scene.
type Odd = fn(&mut Scene);

#[test]
fn odd_scenes_give_finite_pictures() {
    let Some(mut renderer) = renderer("odd_scenes_give_finite_pictures") else { return };
    let with_width = |width: f32| {
        let hair = tufts(0..25).into_iter().map(move |tuft| {
            let mut tuft = tuft.edit();
            tuft.set(WIDTH, Domain::Curve, vec![width]);
            Arc::new(tuft.build())
        });
        Curves::new(hair.collect())
    };
    let full = Scene::of(tufts(0..25));
    let wanted = full.draw(&mut renderer);
    let odd: [(&str, Odd); 17] = [
        ("no hair", |s| s.hair = Curves::default()),
        ("no solids", |s| s.solids = vec![]),
        ("nothing", |s| (s.hair, s.solids) = (Curves::default(), vec![])),
        ("a solid without triangles", |s| s.solids[0].triangles = vec![]),
        ("within hair", |s| s.camera.eye = s.hair.tufts()[3].points()[4] + 0.01),
        ("at a point", |s| s.camera.eye = s.hair.tufts()[3].points()[4]),
        ("away", |s| s.camera.target = s.camera.eye + Vec3::Z),
        ("eye at the target", |s| s.camera.target = s.camera.eye),
        ("up along the view", |s| s.camera.up = s.camera.target - s.camera.eye),
        ("parallel rays from within", |s| {
            (s.camera.eye, s.camera.orthographic) = (Vec3::X, Some(20.0));
        }),
        ("very far", |s| s.camera.eye *= 1e6),
        ("fully see-through", |s| s.look.opacity = 0.0),
        ("a thousandth of the strands", |s| s.look.share = 0.001),
        ("no strands", |s| s.look.share = 0.0),
        ("no light", |s| s.rig = Rig { lights: [crate::light::Light::OFF; 3], ..s.rig.clone() }),
        ("hair at the ends of the world", |s| {
            let ends = [Vec3::splat(3e38), Vec3::splat(-3e38), Vec3::splat(1e18), Vec3::X];
            let mut all = s.hair.tufts().to_vec();
            all.extend(ends.map(|p| curve(&[p, p * 0.999_999], 0.1).tufts()[0].clone()));
            s.hair = Curves::new(all);
        }),
        ("curves without length", |s| {
            s.hair = curve(&[Vec3::ZERO, Vec3::ZERO, Vec3::X, Vec3::X], 0.1);
        }),
    ];
    for (what, change) in odd {
        for paint in [Paint::hair(), Paint::plain(Vec3::splat(0.5))] {
            let mut scene = Scene { paint, samples: 1, ..Scene::of(tufts(0..25)) };
            change(&mut scene);
            let picture = scene.draw(&mut renderer);
            let covered = coverage(&picture);
            match what {
                "nothing" | "away" => assert_eq!(covered, 0.0, "{what}"),
                "no hair" | "no solids" | "a thousandth of the strands" => {
                    assert!(covered > 10.0, "{what}: {covered}");
                }
                _ => {}
            }
        }
    }
    for width in [0.0, 1e-9, 1.0, 1e3, f32::INFINITY, f32::NAN, -1.0] {
        let scene = Scene { hair: with_width(width), samples: 1, ..Scene::of(vec![]) };
        let covered = coverage(&scene.draw(&mut renderer));
        if width == 1e3 {
            assert!(covered > 4000.0, "wider than the picture: {covered}");
        }
    }
    check_same(&full.draw(&mut renderer), &wanted, "after all of that");
}

#[test]
fn from_below_the_ground_hides_nothing_and_from_the_front_it_is_seen() {
    let Some(mut renderer) = renderer("from_below_the_ground_hides_nothing") else { return };
    let scene = Scene::of(tufts(0..9));
    let ground = crate::surface::ground(&scene.solids, f32::INFINITY).expect("a ground");
    let with = [scene.solids.clone(), vec![ground]].concat();
    for (view, hides) in [(Viewpoint::Under, false), (Viewpoint::ThreeQuarter, true)] {
        let surface = Surface::new(scene.solids[0].points.clone(), vec![[0, 1, 2], [0, 2, 3]]);
        let subject =
            Subject { frame: HeadFrame::IDENTITY, surface: Some(&surface), hair: &scene.hair };
        for flat in [false, true] {
            let camera = frame(&view, &subject, 85.0, 1.5);
            let camera = if flat { camera.flattened() } else { camera };
            let draw = |solids: &[Solid], renderer: &mut Renderer| {
                let (hair, rig) = (scene.hair.clone(), scene.rig.clone());
                Scene { hair, rig, camera, solids: solids.to_vec(), ..Scene::of(vec![]) }
                    .draw(renderer)
            };
            let (bare, on_ground) =
                (draw(&scene.solids, &mut renderer), draw(&with, &mut renderer));
            assert_eq!(bare.linear != on_ground.linear, hides, "{view:?} {flat}");
        }
    }
}

#[test]
fn hair_that_hangs_below_the_head_is_seen_down_to_its_tip() {
    let Some(mut renderer) = renderer("hair_that_hangs_below_the_head") else { return };
    let scene = Scene::of(vec![]);
    let low = scene.solids[0].points.iter().fold(f32::MAX, |low, p| low.min(p.y));
    let hair = curve(&[Vec3::new(0.0, 0.0, 0.0), Vec3::new(0.0, low - 30.0, 0.0)], 0.4);
    let mut camera = scene.camera;
    camera.eye = Vec3::new(0.0, low + 40.0, 90.0);
    camera.target = Vec3::new(0.0, low - 10.0, 0.0);
    // Hair alone, and with the ground that lies under it: it is as long in both.
    let seen = |lowest: Option<f32>, renderer: &mut Renderer| {
        let solids = crate::surface::ground(&scene.solids, lowest.unwrap_or(f32::INFINITY));
        let solids = if lowest.is_some() { solids.into_iter().collect() } else { vec![] };
        let paint = Paint::plain(Vec3::X);
        Scene { hair: hair.clone(), paint, camera, solids, ..Scene::of(vec![]) }.draw(renderer)
    };
    let red = |picture: &Picture| {
        picture.linear.iter().filter(|c| c[0] > 4.0 * c[1].max(c[2]) && c[3] > 0.0).count()
    };
    let bare = red(&seen(None, &mut renderer));
    assert!(bare > 20, "{bare}");
    assert!(
        red(&seen(Some(f32::INFINITY), &mut renderer)) < bare,
        "a floor at the neck hides some"
    );
    assert_eq!(red(&seen(Some(low - 30.0), &mut renderer)), bare);
}

#[test]
fn hair_behind_the_eye_is_not_seen() {
    let Some(mut renderer) = renderer("hair_behind_the_eye_is_not_seen") else { return };
    let hair = curve(&[Vec3::new(-2.0, 0.0, 60.0), Vec3::new(2.0, 1.0, 60.0)], 0.2);
    for orthographic in [None, Some(6.4)] {
        let mut scene = Scene { samples: 1, ..Scene::flat(hair.clone()) };
        scene.camera.orthographic = orthographic;
        assert_eq!(coverage(&scene.draw(&mut renderer)), 0.0, "behind");
        scene.camera.eye.z = 90.0;
        assert!(coverage(&scene.draw(&mut renderer)) > 5.0, "ahead");
    }
}

#[test]
fn a_lost_device_ends_drawing_and_says_so() {
    let Some(shared) = renderer("a_lost_device_ends_drawing_and_says_so") else { return };
    assert_eq!(shared.lost(), None);
    drop(shared);
    let gpu = Arc::new(Gpu::new(Precision::Best).expect("as before"));
    let mut renderer = Renderer::new(gpu.clone(), 8, 8).expect("a small picture");
    Scene::of(tufts(0..3)).draw(&mut renderer);
    renderer.restart();
    gpu.device.destroy();
    gpu.wait();
    assert!(matches!(renderer.lost(), Some(RenderError::Lost(_))));
    assert!(!renderer.render(4, &|_| false));
    check_sound(&renderer.picture(), (8, 8));
    assert!(renderer.pick(1, 1, 0).is_none());
}
