//! Pictures: each view, light and model against one that was looked at, and the laws that every picture keeps.
//!
//! On the adapter that the goldens were drawn by ([`PINNED`], on a processor of the kind that `hashes.txt` names, for the
//! adapter compiles for it) pictures are the same to the last bit, by hash. Any other adapter
//! rounds differently, so that single samples of a pixel fall to the other side of a hair's edge; there the mean FLIP error
//! (Andersson et al. 2020) stays under [`OTHER_ADAPTER`].
//!
//! A picture changes only when it is meant to. `UPDATE_EXPECT=1 cargo test -p coif-tests --test pictures` on the pinned adapter
//! then writes new ones; look at them.

use coif_nodes::data::attributes::{BRAID, COLOUR, Domain, ID, WIDTH};
use coif_nodes::data::curves::Curves;
use coif_nodes::eval::Quality;
use coif_nodes::maths::hair_colour::{absorption_of_melanin, colour_of};
use coif_nodes::maths::hash::KeyBuilder;
use coif_shaders::camera::{Subject, Viewpoint, frame};
use coif_shaders::surface::{RootGrid, SPREAD, Solid, Tone, ground, head_solid, tubes};
use coif_shaders::view::{Paint, View};
use coif_shaders::{Environment, Look, Model, Picture, Renderer, Rig, Transform};
use coif_tests::{Groom, gpu, groom, groom_made, repository};
use glam::Vec3;
use nv_flip::{DEFAULT_PIXELS_PER_DEGREE, FlipImageRgb8, FlipPool, flip, magma_lut};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, OnceLock, PoisonError};

/// The adapter whose bits the goldens are: Mesa's software adapter of this version on 256-bit vectors.
const PINNED: &str = "lavapipe-22.3.6-256";
/// The largest mean FLIP error between two adapters. The same pictures with other grain differ by 0.007 to 0.019 at the samples
/// used here, so another adapter may even draw its own grain; a light, colour or pass that is wrong gives more.
const OTHER_ADAPTER: f32 = 0.02;

const WIDTH_PIXELS: u32 = 320;
const HEIGHT_PIXELS: u32 = 180;
const SAMPLES: u32 = 2;

/// The one renderer of this program; tests take turns.
fn renderer(test: &str) -> Option<MutexGuard<'static, Renderer>> {
    static RENDERER: OnceLock<Mutex<Renderer>> = OnceLock::new();
    let gpu = gpu(test)?;
    let renderer = RENDERER.get_or_init(|| {
        Mutex::new(Renderer::new(gpu, WIDTH_PIXELS, HEIGHT_PIXELS).expect("a small picture"))
    });
    Some(renderer.lock().unwrap_or_else(PoisonError::into_inner))
}

/// What is drawn.
struct Scene<'a> {
    groom: &'a Groom,
    drawn: Curves,
    paint: Paint,
    solids: Vec<Solid>,
    rooted: bool,
    viewpoint: Viewpoint,
    rig: Rig,
    look: Look,
    samples: u32,
}

impl<'a> Scene<'a> {
    /// A groom on its head in the studio.
    fn of(groom: &'a Groom) -> Self {
        Self {
            groom,
            drawn: groom.hair.clone(),
            paint: Paint::hair(),
            solids: with_ground(head_solid(&groom.scalp, Tone::Monk(5))),
            rooted: true,
            viewpoint: Viewpoint::ThreeQuarter,
            rig: Rig::named("studio").unwrap(),
            look: Look::default(),
            samples: SAMPLES,
        }
    }
    /// Only hair, before black.
    fn of_hair(groom: &'a Groom) -> Self {
        let mut rig = Rig::named("neutral").unwrap();
        rig.environment =
            Environment { backdrop: coif_shaders::Backdrop::Plain(Vec3::ZERO), ..rig.environment };
        let points = groom.hair.tufts().iter().flat_map(|tuft| tuft.points()).copied();
        let viewpoint = Viewpoint::Close(points.collect());
        Self { solids: vec![], rooted: false, rig, viewpoint, samples: 16, ..Self::of(groom) }
    }

    fn draw(&self, renderer: &mut Renderer) -> Picture {
        let subject = Subject {
            frame: *self.groom.scalp.frame(),
            surface: Some(self.groom.scalp.surface()),
            hair: &self.groom.hair,
        };
        let aspect = WIDTH_PIXELS as f32 / HEIGHT_PIXELS as f32;
        renderer.set_camera(&frame(&self.viewpoint, &subject, 85.0, aspect));
        renderer.set_rig(&self.rig);
        renderer.set_look(&Look { stands_for: self.groom.stands_for, ..self.look });
        renderer.set_solids(self.solids.clone());
        let roots = self
            .rooted
            .then(|| RootGrid::of(&self.groom.hair, SPREAD, self.groom.stands_for))
            .flatten();
        renderer.set_roots(roots);
        renderer.set_hair(&self.drawn, &self.paint);
        assert!(renderer.render(self.samples, &|_| false));
        let picture = renderer.picture();
        assert!(picture.linear.iter().flatten().all(|x| x.is_finite()), "a number that is none");
        picture
    }
}

fn with_ground(head: Solid) -> Vec<Solid> {
    let mut solids = vec![head];
    solids.extend(ground(&solids, f32::INFINITY));
    solids
}

/// The start-up groom with so many of its 60,000 hairs, wider by as much as keeps the head covered.
fn start(count: u32) -> Groom {
    let wider = |width: f32| (width * (60_000.0 / count as f32).sqrt()).to_string();
    let edits = [
        ("hair.by", "count"),
        ("hair.count", &count.to_string()),
        ("width.root", &wider(0.008)),
        ("width.tip", &wider(0.002)),
    ];
    groom("start", &edits, &["guides.curves"])
}

/// The cornrows with a tenth of their hair, each ten times as wide.
fn cornrows() -> Groom {
    let edits = [
        ("fill.count", "24"),
        ("fill.points", "120"),
        ("fill_width.root", "0.02"),
        ("fill_width.tip", "0.015"),
        ("partings.per_cm", "12"),
    ];
    groom("cornrows", &edits, &["braid.curves"])
}

/// The same hair in one colour.
fn coloured(hair: &Curves, colour: Vec3) -> Curves {
    let each = hair.tufts().iter().map(|tuft| {
        let mut tuft = tuft.edit();
        tuft.set(COLOUR, Domain::Curve, vec![colour]);
        tuft.build().into()
    });
    Curves::new(each.collect())
}

fn luminance(pixel: &[f32; 4]) -> f32 {
    0.2126 * pixel[0] + 0.7152 * pixel[1] + 0.0722 * pixel[2]
}

fn coverage(picture: &Picture) -> f32 {
    picture.linear.iter().map(|p| p[3]).sum::<f32>() / picture.linear.len() as f32
}

/// What the adapter at hand is called among the goldens.
fn adapter(renderer: &Renderer) -> String {
    let info = &renderer.gpu().info;
    let version = info.driver_info.split(' ').nth(1).unwrap_or("");
    let bits = info.name.split([' ', ',']).rev().nth(1).unwrap_or("");
    match &*info.driver {
        "llvmpipe" => format!("lavapipe-{version}-{bits}"),
        other => other.to_owned(),
    }
}

/// Every golden picture, by name.
fn pictures(renderer: &mut Renderer) -> Vec<(String, Picture, Transform)> {
    let (start, cornrows) = (start(4000), cornrows());
    let mut all = vec![];
    let mut add = |name: String, scene: Scene, transform| {
        all.push((name, scene.draw(renderer), transform));
    };
    for name in Rig::NAMES {
        let rig = Rig::named(name).unwrap();
        add(format!("light-{name}"), Scene { rig, ..Scene::of(&start) }, Transform::Agx);
    }
    for model in Model::ALL {
        let look = Look { model, ..Look::default() };
        add(format!("model-{model}"), Scene { look, ..Scene::of(&start) }, Transform::Agx);
    }
    for (name, transform) in [("srgb", Transform::Srgb), ("rec1886", Transform::Rec1886)] {
        let tone = if name == "srgb" { Tone::Clay } else { Tone::Monk(10) };
        let solids = with_ground(head_solid(&start.scalp, tone));
        add(format!("display-{name}"), Scene { solids, ..Scene::of(&start) }, transform);
    }
    let see_through = Look { opacity: 0.12, ..Look::default() };
    add(
        "see-through".to_owned(),
        Scene { look: see_through, ..Scene::of(&cornrows) },
        Transform::Agx,
    );
    for name in [
        "hair",
        "groom",
        "cluster",
        "braid",
        "strand",
        "section",
        "length",
        "curvature",
        "density",
        "cvs:100",
        "penetration",
        "parting",
        "width",
        "u",
        "tangent",
        "along",
    ] {
        let view: View = name.parse().unwrap();
        let paint = view.paint(&cornrows.hair, Some(&cornrows.scalp)).unwrap();
        let scene = Scene { paint, viewpoint: Viewpoint::Back, ..Scene::of(&cornrows) };
        add(format!("view-{}", name.replace(':', "-")), scene, Transform::Agx);
    }
    let by_id = View::Attribute(ID.name.to_owned()).paint(&start.more[0], None).unwrap();
    let guides = Curves::new(
        start.more[0]
            .tufts()
            .iter()
            .map(|tuft| {
                let mut thick = tuft.edit();
                thick.set(WIDTH, Domain::Curve, vec![0.06]);
                thick.build().into()
            })
            .collect(),
    );
    let scene = Scene { drawn: guides, paint: by_id, rooted: false, ..Scene::of(&start) };
    add("view-guides".to_owned(), scene, Transform::Agx);
    let mut solids = with_ground(head_solid(&cornrows.scalp, Tone::Monk(5)));
    solids.push(tubes(&cornrows.more[0]));
    let scene = Scene { drawn: Curves::default(), solids, rooted: false, ..Scene::of(&cornrows) };
    add("view-clusters".to_owned(), scene, Transform::Agx);
    for name in ["crown", "nape", "hairline", "temple-left"] {
        let viewpoint = Viewpoint::named(name).unwrap();
        add(format!("camera-{name}"), Scene { viewpoint, ..Scene::of(&cornrows) }, Transform::Agx);
    }
    all
}

fn flip_image(picture: &Picture, transform: Transform) -> FlipImageRgb8 {
    let bytes = picture.encoded(transform, 0.0);
    let rgb: Vec<u8> = bytes.chunks(4).flat_map(|p| &p[..3]).copied().collect();
    FlipImageRgb8::with_data(picture.width, picture.height, &rgb)
}

fn read_png(path: &Path) -> FlipImageRgb8 {
    let file = std::fs::File::open(path).unwrap_or_else(|err| panic!("{}: {err}", path.display()));
    let mut reader = png::Decoder::new(std::io::BufReader::new(file)).read_info().unwrap();
    let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
    let info = reader.next_frame(&mut pixels).unwrap();
    assert_eq!(info.color_type, png::ColorType::Rgb);
    FlipImageRgb8::with_data(info.width, info.height, &pixels)
}

fn write_png(path: &Path, width: u32, height: u32, rgb: &[u8]) {
    let mut encoder = png::Encoder::new(std::fs::File::create(path).unwrap(), width, height);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_compression(png::Compression::High);
    encoder.write_header().unwrap().write_image_data(rgb).unwrap();
}

fn hash(picture: &Picture) -> String {
    let bytes: Vec<u8> = picture.linear.iter().flatten().flat_map(|x| x.to_le_bytes()).collect();
    format!("{:032x}", KeyBuilder::new("picture").column(&bytes).finish().0)
}

/// The kind of processor, as far as a software adapter's code depends on it.
fn processor() -> String {
    let about = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let value = |key: &str| {
        let line = about.lines().find(|line| line.starts_with(key))?;
        line.split_once(':').map(|(_, value)| value.trim().to_owned())
    };
    let flags = value("flags").unwrap_or_default();
    let has = |flag: &&str| flags.split(' ').any(|f| f == *flag);
    let known: Vec<&str> = ["avx2", "fma", "avx512f"].into_iter().filter(has).collect();
    format!("{} {}", value("vendor_id").unwrap_or_default(), known.join(" "))
}

fn goldens() -> PathBuf {
    repository().join("tests/goldens/pictures").join(PINNED)
}

#[test]
fn every_view_light_and_model_looks_as_it_did() {
    let Some(mut renderer) = renderer("every_view_light_and_model_looks_as_it_did") else { return };
    let folder = goldens();
    let pinned = adapter(&renderer) == PINNED;
    let drawn = pictures(&mut renderer);
    drop(renderer);
    if std::env::var_os("UPDATE_EXPECT").is_some() {
        assert!(pinned, "goldens are drawn on {PINNED}");
        let _ = std::fs::remove_dir_all(&folder);
        std::fs::create_dir_all(&folder).unwrap();
        let mut lines = format!("processor {}\n", processor());
        for (name, picture, transform) in &drawn {
            lines += &format!("{name} {}\n", hash(picture));
            let rgb = flip_image(picture, *transform).to_vec();
            write_png(&folder.join(format!("{name}.png")), picture.width, picture.height, &rgb);
        }
        std::fs::write(folder.join("hashes.txt"), lines).unwrap();
        return;
    }
    let lines =
        std::fs::read_to_string(folder.join("hashes.txt")).expect("UPDATE_EXPECT=1 makes them");
    let mut hashes: BTreeMap<&str, &str> =
        lines.lines().filter_map(|l| l.split_once(' ')).collect();
    let pinned = pinned && hashes.remove("processor") == Some(processor().as_str());
    hashes.remove("processor");
    let mut wrong = vec![];
    for (name, picture, transform) in &drawn {
        if pinned && hashes.get(&**name) == Some(&&*hash(picture)) {
            continue;
        }
        let golden = folder.join(format!("{name}.png"));
        if !golden.exists() {
            wrong.push(format!("{name}: there is no golden"));
            continue;
        }
        let image = flip_image(picture, *transform);
        let rgb = image.to_vec();
        let errors = flip(read_png(&golden), image, DEFAULT_PIXELS_PER_DEGREE);
        let mean = FlipPool::from_image(&errors).mean();
        if pinned || mean > OTHER_ADAPTER {
            write_png(&folder.join(format!("{name}.new.png")), picture.width, picture.height, &rgb);
            let shown = errors.apply_color_lut(&magma_lut()).to_vec();
            write_png(
                &folder.join(format!("{name}.diff.png")),
                picture.width,
                picture.height,
                &shown,
            );
            wrong.push(format!("{name}: mean FLIP error {mean:.4}"));
        }
    }
    let names: Vec<&str> = drawn.iter().map(|(name, ..)| &**name).collect();
    wrong.extend(
        hashes.keys().filter(|n| !names.contains(n)).map(|n| format!("{n}: not drawn any more")),
    );
    assert!(
        wrong.is_empty(),
        "see *.new.png and *.diff.png in {}:\n{}",
        folder.display(),
        wrong.join("\n")
    );
}

#[test]
fn fewer_strands_with_their_widths_made_up_cover_the_same() {
    let test = "fewer_strands_with_their_widths_made_up_cover_the_same";
    let Some(mut renderer) = renderer(test) else { return };
    let groom = start(3000);
    let drawn = |share: f32, renderer: &mut Renderer| {
        let look = Look { share, ..Look::default() };
        let picture = Scene { look, ..Scene::of_hair(&groom) }.draw(renderer);
        let light: f32 = picture.linear.iter().map(luminance).sum();
        (coverage(&picture), light / picture.linear.len() as f32)
    };
    let (full, lit) = drawn(1.0, &mut renderer);
    assert!(full > 0.05, "there is hair: {full}");
    let (covered, light) = drawn(0.25, &mut renderer);
    for (what, fewer, all) in [("coverage", covered, full), ("light", light, lit)] {
        let off = (fewer / all - 1.0).abs();
        assert!(off < 0.02, "{what}: {fewer} instead of {all}, {off}");
    }
}

#[test]
fn the_more_hair_is_seen_through_the_less_it_covers() {
    let Some(mut renderer) = renderer("the_more_hair_is_seen_through_the_less_it_covers") else {
        return;
    };
    let groom = start(4000);
    let mut before = -1.0;
    for opacity in [0.0, 0.12, 0.4, 0.7, 1.0] {
        let look = Look { opacity, ..Look::default() };
        let covered = coverage(&Scene { look, ..Scene::of_hair(&groom) }.draw(&mut renderer));
        assert!(covered > before, "{opacity}: {covered} after {before}");
        assert!(opacity > 0.0 || covered == 0.0, "nothing is left of hair at 0: {covered}");
        before = covered;
    }
}

#[test]
fn brown_hair_is_brown_and_not_auburn() {
    let Some(mut renderer) = renderer("brown_hair_is_brown_and_not_auburn") else { return };
    let groom = start(6000);
    let brown = colour_of(absorption_of_melanin(0.87, 0.0));
    for model in [Model::Karis, Model::Chiang] {
        let look = Look { model, ..Look::default() };
        let drawn = coloured(&groom.hair, brown);
        let picture = Scene { drawn, look, ..Scene::of_hair(&groom) }.draw(&mut renderer);
        let hair: Vec<&[f32; 4]> = picture.linear.iter().filter(|p| p[3] > 0.9).collect();
        assert!(hair.len() > 300, "{} pixels of hair", hair.len());
        let mean = |k: usize| hair.iter().map(|p| p[k]).sum::<f32>() / hair.len() as f32;
        let ratio = mean(0) / mean(1);
        assert!((1.0..1.3).contains(&ratio), "{model}: red over green is {ratio}");
    }
}

#[test]
fn dark_hair_can_be_judged_on_any_skin() {
    let Some(mut renderer) = renderer("dark_hair_can_be_judged_on_any_skin") else { return };
    let groom = groom("cornrows", &[("fill.points", "120")], &["rows.curves"]);
    let black = coloured(&groom.hair, colour_of(absorption_of_melanin(0.97, 0.0)));
    let skin = groom.scalp.skin();
    let from_row = |p: Vec3| {
        let rows = groom.more[0].each().flat_map(|(tuft, i)| tuft.curve(i).windows(2));
        let distances = rows.map(|ends| {
            let (start, along) = (ends[0], ends[1] - ends[0]);
            let t = ((p - start).dot(along) / along.length_squared()).clamp(0.0, 1.0);
            p.distance(start + along * t)
        });
        distances.fold(f32::MAX, f32::min)
    };
    // A few braids behind the top of the head, as close as one judges them.
    let head = groom.scalp.frame();
    let middle = head.origin + (0.9 * head.up - 0.45 * head.forward) * head.radius;
    let points = groom.hair.tufts().iter().flat_map(|tuft| tuft.points()).copied();
    let near: Vec<Vec3> = points.filter(|p| p.distance(middle) < 2.5).collect();
    for tone in [1, 10] {
        let scene = Scene {
            drawn: black.clone(),
            solids: with_ground(head_solid(&groom.scalp, Tone::Monk(tone))),
            viewpoint: Viewpoint::Close(near.clone()),
            rig: Rig::named("dark-hair").unwrap(),
            samples: 8,
            ..Scene::of(&groom)
        };
        let picture = scene.draw(&mut renderer);
        // What the middle of the picture shows: how high over the scalp, for hair of a braid.
        let (left, top, columns, rows) = (100, 50, 120, 80);
        let shown: Vec<Option<Vec3>> = (0..rows * columns)
            .map(|i| {
                let (tuft, curve, point) =
                    renderer.pick(left + i % columns, top + i / columns, 0)?;
                let braid = tuft.view(BRAID).at(curve, point) != 0;
                Some(if braid { tuft.points()[point] } else { Vec3::NAN })
            })
            .collect();
        // Only pixels that are not on an edge count: what lies among its like.
        let (mut braids, mut hair, mut parting) = (vec![], vec![], vec![]);
        for (x, y) in (1..rows - 1).flat_map(|y| (1..columns - 1).map(move |x| (x, y))) {
            let near = |dx: u32, dy: u32| shown[((y + dy - 1) * columns + x + dx - 1) as usize];
            let around = || (0..9).map(|k| near(k % 3, k / 3));
            let light = luminance(&picture.linear[((top + y) * WIDTH_PIXELS + left + x) as usize]);
            match near(1, 1) {
                // Along the middle of the braid, where strands rise and dive; its flanks are no valleys.
                Some(p) if around().flatten().filter(|p| p.is_finite()).count() == 9 => {
                    hair.push(light);
                    let height = |p: Vec3| skin.distance(p) / 9.0;
                    if from_row(skin.closest(p).expect("a head").point) < 0.3 {
                        braids.push((around().flatten().map(height).sum::<f32>(), light));
                    }
                }
                None if around().all(|h| h.is_none()) => parting.push(light),
                _ => {}
            }
        }
        braids.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mean = |of: &[(f32, f32)]| of.iter().map(|p| p.1).sum::<f32>() / of.len() as f32;
        let fifth = braids.len() / 5;
        let (valley, crown) = (mean(&braids[..fifth]), mean(&braids[braids.len() - fifth..]));
        let mean = |of: &[f32]| of.iter().sum::<f32>() / of.len() as f32;
        let (hair, skin) = (mean(&hair), mean(&parting));
        assert!(braids.len() > 500 && parting.len() > 50);
        let apart = |a: f32, b: f32| (a / b).max(b / a);
        assert!(apart(crown, valley) >= 1.5, "skin {tone}: crown {crown}, valley {valley}");
        assert!(apart(skin, hair) >= 2.0, "skin {tone}: parting {skin}, hair {hair}");
    }
}

/// A tenth of the strands, each as much wider as there are fewer, looks as full as all of them: on the head it is as bright, and
/// alone it covers as much.
#[test]
fn a_preview_covers_the_head_and_shines_as_the_final_hair_does() {
    let Some(mut renderer) =
        renderer("a_preview_covers_the_head_and_shines_as_the_final_hair_does")
    else {
        return;
    };
    type Edits = &'static [(&'static str, &'static str)];
    let cases: [(&str, Edits); 3] = [
        ("start", &[("hair.count", "30000"), ("guides.count", "100")]),
        ("curls_3b", &[("guides.count", "80"), ("loose.count", "400")]),
        ("braids", &[("fill.points", "40"), ("sections.count", "60000")]),
    ];
    for (name, edits) in cases {
        let [all, few] =
            [Quality::Final, Quality::Preview].map(|quality| groom_made(name, edits, &[], quality));
        let strands = [&all, &few].map(|groom| groom.hair.curve_count());
        assert!(2 * strands[1] < strands[0], "{name}: {strands:?} strands");
        let [lit, thin_lit] = [&all, &few].map(|groom| {
            let picture =
                Scene { viewpoint: Viewpoint::Crown, ..Scene::of(groom) }.draw(&mut renderer);
            picture.linear.iter().map(luminance).sum::<f32>() / picture.linear.len() as f32
        });
        let [covered, thin_covered] = [&all, &few].map(|groom| {
            let scene = Scene { viewpoint: Viewpoint::Crown, samples: 4, ..Scene::of_hair(groom) };
            coverage(&scene.draw(&mut renderer))
        });
        assert!((thin_lit / lit - 1.0).abs() < 0.1, "{name}: luminance {thin_lit}, final {lit}");
        let off = (thin_covered / covered - 1.0).abs();
        assert!(off < 0.1, "{name}: coverage {thin_covered}, final {covered}");
    }
}
