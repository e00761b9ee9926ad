//! The pages for artists, `docs/artists`: links lead somewhere and nothing lies there unlinked, commands run and say no warning,
//! and each picture is what its page's command draws of the groom beside it. Pages are found by their links, from the README on.

use coif_nodes::scalp::bust;
use coif_tests::{Folder, adapter, coif, program, repository, run_with};
use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

/// Where the pages lie, and their pictures.
const PAGES: &str = "docs/artists";
const PICTURES: &str = "docs/pictures/artists";
/// Cells of a picture that is compared, across and down: so few that the grain of few samples goes out in each.
const CELLS: [usize; 2] = [40, 30];
/// Pixels across and down of a cell that is drawn anew, and samples of each. The pictures of the pages are larger.
const DRAWN: usize = 4;
const SAMPLES: &str = "4";
/// The largest difference between the picture of a page and the same drawn anew, as a root mean square over cells: grain gives
/// 0.007 to 0.016, coils 3 cm shorter 0.04, a row that is missing 0.13, and two rows more on a head 0.14.
const GRAIN: f32 = 0.03;

/// The local files that a page links to, by their paths in the repository, with the part after `#`.
fn links(page: &Path, text: &str) -> Vec<(PathBuf, Option<String>)> {
    let targets = text.split("](").skip(1).filter_map(|rest| rest.split(')').next());
    let local = targets.filter(|target| !target.contains("://"));
    let split = local.map(|target| match target.split_once('#') {
        Some((path, part)) => (path, Some(part.to_owned())),
        None => (target, None),
    });
    split
        .map(|(path, part)| {
            let mut full = match path.is_empty() {
                true => page.to_owned(),
                false => page.parent().expect("a page has a folder").to_owned(),
            };
            for step in Path::new(path).components() {
                match step.as_os_str().to_str() {
                    Some("..") => {
                        assert!(full.pop(), "{}: {path} leaves the repository", page.display())
                    }
                    _ => full.push(step),
                }
            }
            (full, part)
        })
        .collect()
}

fn text_of(page: &Path) -> String {
    let text = std::fs::read_to_string(repository().join(page));
    text.unwrap_or_else(|err| panic!("{}: {err}", page.display()))
}

/// The pages for artists that can be reached from the README, with their text.
fn pages() -> BTreeMap<PathBuf, String> {
    let mut found = BTreeMap::new();
    let mut open = vec![PathBuf::from("README.md")];
    while let Some(page) = open.pop() {
        let text = text_of(&page);
        let next = links(&page, &text).into_iter().map(|(path, _)| path);
        let next =
            next.filter(|path| path.starts_with(PAGES) && path.extension() == Some("md".as_ref()));
        open.extend(next.filter(|path| !found.contains_key(path)));
        if page.starts_with(PAGES) {
            found.insert(page, text);
        }
    }
    assert!(!found.is_empty(), "the README links to no page in {PAGES}");
    found
}

/// The parts of a page that a link may name.
fn headings(text: &str) -> BTreeSet<String> {
    let titles = text.lines().filter_map(|line| line.strip_prefix('#'));
    let slug = |title: &str| {
        let title = title.trim_start_matches('#').trim().to_lowercase().replace(' ', "-");
        title.chars().filter(|c| c.is_alphanumeric() || "-_".contains(*c)).collect()
    };
    titles.map(slug).collect()
}

#[test]
fn every_link_of_the_pages_for_artists_leads_somewhere_and_nothing_lies_there_unlinked() {
    let mut linked: BTreeSet<PathBuf> = pages().into_keys().collect();
    for (page, text) in pages() {
        for (path, part) in links(&page, &text) {
            let full = repository().join(&path);
            assert!(full.exists(), "{}: there is no {}", page.display(), path.display());
            if let Some(part) = part {
                let there = headings(&text_of(&path)).contains(&part);
                assert!(there, "{}: {} has no part {part}", page.display(), path.display());
            }
            linked.insert(path);
        }
    }
    for folder in [PAGES, PICTURES] {
        for entry in std::fs::read_dir(repository().join(folder)).expect("the folder").flatten() {
            let path = Path::new(folder).join(entry.file_name());
            assert!(linked.contains(&path), "{}: no page links to it", path.display());
        }
    }
}

/// The commands that the code blocks of a page show: the words of each.
fn commands(text: &str) -> Vec<Vec<String>> {
    let blocks = text.split("```").skip(1).step_by(2);
    let lines = blocks.flat_map(str::lines).filter(|line| line.starts_with("coif "));
    lines.map(|line| line.split_whitespace().skip(1).map(str::to_owned).collect()).collect()
}

/// The word after an option.
fn given<'a>(command: &'a mut [String], option: &str) -> &'a mut String {
    let at = command.iter().position(|word| word == option);
    let at = at.unwrap_or_else(|| panic!("{command:?} has no {option}"));
    &mut command[at + 1]
}

/// The mesh that the pages call `my_head.obj`: the built-in bust, narrower and longer from front to back.
fn my_head() -> String {
    let mesh = bust::adult();
    let mut text = String::new();
    for p in &mesh.points {
        let _ = writeln!(text, "v {} {} {}", p.x * 0.94, p.y, p.z * 1.06);
    }
    for [a, b, c] in &mesh.triangles {
        let _ = writeln!(text, "f {} {} {}", a + 1, b + 1, c + 1);
    }
    text
}

/// A picture as cells, each the mean of its pixels: red, green and blue of one after another, 0 to 1.
fn cells(file: &Path) -> Vec<f32> {
    let bytes = std::fs::File::open(file).unwrap_or_else(|err| panic!("{}: {err}", file.display()));
    let mut decoder = png::Decoder::new(std::io::BufReader::new(bytes));
    decoder.set_transformations(png::Transformations::EXPAND | png::Transformations::STRIP_16);
    let mut reader = decoder.read_info().expect("a PNG");
    let mut pixels = vec![0; reader.output_buffer_size().expect("a size")];
    let info = reader.next_frame(&mut pixels).expect("whole");
    let width = info.width as usize;
    let side = width / CELLS[0];
    let size = CELLS.map(|cells| cells * side);
    assert_eq!(size, [width, info.height as usize], "{}", file.display());
    let channels = info.color_type.samples();
    assert!(channels >= 3, "{} has no colours", file.display());
    let mut cells = vec![0.0; CELLS[0] * CELLS[1] * 3];
    for (i, pixel) in pixels.chunks_exact(channels).enumerate() {
        let cell = i / width / side * CELLS[0] + i % width / side;
        for channel in 0..3 {
            cells[cell * 3 + channel] += f32::from(pixel[channel]) / 255.0 / (side * side) as f32;
        }
    }
    cells
}

/// How far two pictures differ: the root mean square over their cells.
fn difference(a: &Path, b: &Path) -> f32 {
    let (a, b) = (cells(a), cells(b));
    let squares: f32 = a.iter().zip(&b).map(|(a, b)| (a - b) * (a - b)).sum();
    (squares / a.len() as f32).sqrt()
}

#[test]
fn the_commands_of_the_pages_for_artists_run_and_draw_their_pictures() {
    let draws = adapter("the pictures of the pages for artists");
    let mut drawn: Vec<String> = vec![];
    for (page, text) in pages() {
        let stem = page.file_stem().expect("a page").to_string_lossy().into_owned();
        let folder = Folder::new(&format!("artists-{stem}"));
        for (graph, _) in links(&page, &text).iter().filter(|(path, _)| is_graph(path)) {
            let name = graph.file_name().expect("a graph");
            std::fs::copy(repository().join(graph), folder.path("").join(name)).expect("copied");
        }
        for mut command in commands(&text) {
            bring(&folder, &command);
            let picture = (command[0] == "render").then(|| given(&mut command, "--out").clone());
            if picture.is_some() {
                if !draws {
                    continue;
                }
                *given(&mut command, "--size") =
                    format!("{}x{}", CELLS[0] * DRAWN, CELLS[1] * DRAWN);
                *given(&mut command, "--samples") = SAMPLES.to_owned();
            }
            let mut coif = if picture.is_some() { program() } else { coif() };
            coif.current_dir(folder.path(""));
            let ran = run_with(coif, &command);
            assert_eq!(ran.code, 0, "{stem}: {command:?}: {}", ran.err);
            assert!(!ran.err.contains("warning"), "{stem}: {command:?}: {}", ran.err);
            if let Some(picture) = picture {
                let kept = repository().join(PICTURES).join(&picture);
                let found = difference(&kept, &folder.path(&picture));
                assert!(found < GRAIN, "{stem}: {picture} is drawn otherwise, by {found:.4}");
                drawn.push(picture);
            }
        }
    }
    if !draws {
        return;
    }
    // Every picture has its command, and another page's picture would not do.
    let kept = std::fs::read_dir(repository().join(PICTURES)).expect("the pictures").flatten();
    let kept: BTreeSet<String> =
        kept.map(|e| e.file_name().to_string_lossy().into_owned()).collect();
    assert_eq!(drawn.iter().cloned().collect::<BTreeSet<_>>(), kept);
    let file = |name: &String| repository().join(PICTURES).join(name);
    for pair in drawn.windows(2) {
        let found = difference(&file(&pair[0]), &file(&pair[1]));
        assert!(found > 2.0 * GRAIN, "{pair:?} are alike: {found:.4}");
    }
}

fn is_graph(path: &Path) -> bool {
    path.extension() == Some("ron".as_ref())
}

/// Puts the mesh that stands for the reader's head into the folder, if a command asks for it.
fn bring(folder: &Folder, command: &[String]) {
    let mesh = "my_head.obj";
    if command.iter().any(|word| word == mesh) {
        std::fs::write(folder.path(mesh), my_head()).expect("the mesh is written");
    }
}
