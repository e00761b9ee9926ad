//! `coif template` as a whole program: thumbnails are drawn into files, and refused by their headers.

use coif_tests::{Folder, adapter, program, repository, run, run_with};

fn copied(folder: &Folder, name: &str) -> String {
    let text = std::fs::read_to_string(repository().join(format!("graphs/templates/{name}.ron")));
    let path = folder.path(&format!("{name}.ron"));
    std::fs::write(&path, text.unwrap()).unwrap();
    path.display().to_string()
}

fn thumbnail(text: &str) -> Option<&str> {
    text.rsplit_once("thumbnail: \"")?.1.split_once('"').map(|(thumbnail, _)| thumbnail)
}

#[test]
fn a_thumbnail_is_drawn_into_its_file_the_same_each_time_and_is_no_part_of_the_hash() {
    if !adapter("a_thumbnail_is_drawn_into_its_file") {
        return;
    }
    let folder = Folder::new("template-thumbnail");
    let path = copied(&folder, "fringe");
    let before = std::fs::read_to_string(&path).unwrap();
    let hash = |path: &str| {
        let told = run(["template", "info", path]);
        assert_eq!(told.code, 0, "{}", told.err);
        let line = told.out.lines().find(|line| line.starts_with("hash: "));
        line.unwrap_or_default().to_owned()
    };
    let first = hash(&path);
    let mut drawn = vec![];
    for _ in 0..2 {
        let ran = run_with(program(), ["template", "thumbnail", &path, "--size", "96"]);
        assert_eq!((ran.code, ran.err.as_str()), (0, ""));
        drawn.push(std::fs::read_to_string(&path).unwrap());
    }
    assert_eq!(drawn[0], drawn[1]);
    assert_eq!(hash(&path), first);
    let [old, new] = [&before, &drawn[0]].map(|text| thumbnail(text).unwrap());
    assert_ne!(old, new);
    assert!(new.len() < 64 << 10);
    assert_eq!(before.replace(old, ""), drawn[0].replace(new, ""), "nothing else changed");
    assert_eq!(folder.names(), ["fringe.ron"]);
}

#[test]
fn a_template_made_has_a_thumbnail_and_a_groom_that_takes_it_has_none() {
    let folder = Folder::new("template-new");
    let groom = copied(&folder, "fringe");
    let made = folder.path("made.ron").display().to_string();
    let new = |more: &[&str]| {
        run_with(
            program(),
            [&["template", "new", &groom, "fringe", "--out", &made, "--name", "mine"], more]
                .concat(),
        )
    };
    let ran = new(&["--no-thumbnail"]);
    assert_eq!((ran.code, ran.err.as_str()), (0, ""));
    assert_eq!(thumbnail(&std::fs::read_to_string(&made).unwrap()), None);
    if !adapter("a_template_made_has_a_thumbnail") {
        return;
    }
    let ran = new(&[]);
    assert_eq!((ran.code, ran.err.as_str()), (0, ""));
    assert!(thumbnail(&std::fs::read_to_string(&made).unwrap()).is_some());
    let mine = folder.path("mine.ron").display().to_string();
    std::fs::write(&mine, "(format: 3, nodes: {\"head\": (kind: \"head\")})").unwrap();
    let ran = run(["template", "add", &mine, &made]);
    assert_eq!(ran.code, 0, "{}", ran.err);
    let text = std::fs::read_to_string(&mine).unwrap();
    assert!(thumbnail(&text).is_none() && text.contains("groom_output"), "it gives hair");
}

#[test]
fn a_template_is_fitted_to_the_head_of_the_graph_that_it_is_added_to() {
    let folder = Folder::new("template-fitted");
    let low = "kind: \"head\", inputs: {\"landmarks\": \"bridge 0 -3.6 9.3\"}";
    let groom = copied(&folder, "brows");
    let text = std::fs::read_to_string(&groom).unwrap();
    std::fs::write(&groom, text.replacen("kind: \"head\"", low, 1)).unwrap();
    let made = folder.path("made.ron").display().to_string();
    let ran = run([
        "template",
        "new",
        &groom,
        "brows",
        "--out",
        &made,
        "--name",
        "low",
        "--no-thumbnail",
    ]);
    assert_eq!((ran.code, ran.err.as_str()), (0, ""));
    assert!(std::fs::read_to_string(&made).unwrap().contains("\"home\": \"front "));
    let add = |name: &str, head: &str| {
        let mine = folder.path(name).display().to_string();
        std::fs::write(&mine, format!("(format: 3, nodes: {{\"head\": ({head})}})")).unwrap();
        let ran = run(["template", "add", &mine, &made]);
        assert_eq!(ran.code, 0, "{}", ran.err);
        let told = run(["template", "upgrade", &mine, "brows", "--to", &made, "--dry-run"]);
        assert_eq!(told.code, 0, "{}", told.err);
        (ran.err, told.out.contains("changes inside: lost"))
    };
    assert_eq!(add("same.ron", low), (String::new(), false));
    let (said, changed) = add("other.ron", "kind: \"head\"");
    assert!(said.contains("fitted to this head") && changed, "{said}");
}

#[test]
fn a_thumbnail_that_is_none_is_refused_by_its_header_with_the_template() {
    let folder = Folder::new("template-bomb");
    let path = copied(&folder, "fringe");
    let text = std::fs::read_to_string(&path).unwrap();
    let good = thumbnail(&text).unwrap();
    // A header that says 60,000 x 60,000 pixels.
    let bomb = format!("iVBORw0KGgoAAAANSUhEUgAA6mAAAOpg{}", &good[32..]);
    let long = "A".repeat((256 << 10) + 4);
    for (thumbnail, why) in [
        (bomb.as_str(), "thumbnail: it says 60000 x 60000 pixels, 1 to 1024"),
        (&long, "thumbnail: it is 256 KiB of text, at most 256"),
        ("R0lGODlh", "thumbnail: it is no PNG"),
        ("no base64!", "thumbnail: it is no base64"),
    ] {
        std::fs::write(&path, text.replace(good, thumbnail)).unwrap();
        let to = folder.path("shelf").display().to_string();
        for words in [vec!["info", &path], vec!["install", &path, "--to", &to]] {
            let ran = run([vec!["template"], words].concat());
            assert_eq!((ran.code, ran.out.as_str()), (2, ""));
            let lines: Vec<&str> = ran.err.lines().collect();
            let [line] = lines[..] else { panic!("{}", ran.err) };
            assert!(line.contains("fringe.ron") && line.contains(why), "{line}");
        }
        assert_eq!(folder.names(), ["fringe.ron"]);
    }
}
