//! What git makes of two people's edits: real merges in a real repository, without a driver. Edits are
//! the editor's own, files are written as it saves them, what comes out is evaluated.

use super::{read, write};
use crate::document::edit::Edit;
use crate::document::testing::Random;
use crate::document::{Document, Frame, Node, NodeId, Point, Setting, Socket, strokes, wiring};
use crate::schedule::files::DiskFiles;
use crate::schedule::request::plan;
use crate::schedule::result::content_hash;
use crate::schedule::run::{CancelToken, Evaluator, OnFailure, Quiet};
use coif_nodes::data::strokes::{Sample, Stroke, Strokes};
use coif_nodes::define::Value;
use coif_nodes::eval::Quality;
use std::collections::BTreeSet;
use std::fmt::Write as _;
use std::io::Write as _;
use std::path::PathBuf;
use std::process::{Command, Stdio};

/// A repository of one file in a folder of its own.
pub(crate) struct Repository(PathBuf);

/// The text of a file, and what two people made of it.
pub(crate) type Branches = [String; 3];

impl Repository {
    pub(crate) fn new(name: &str) -> Option<Self> {
        if Command::new("git").arg("--version").output().is_err() {
            println!("skipped: {name} needs git");
            return None;
        }
        let folder = std::env::temp_dir().join(format!("coif-{name}-{}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        let new = Self(folder);
        new.git(&["init", "-q"], "").unwrap();
        Some(new)
    }
    /// What git says, unless it fails. No settings but its own: neither drivers nor hooks of the machine.
    fn git(&self, args: &[&str], input: &str) -> Option<String> {
        let mut git = Command::new("git");
        git.current_dir(&self.0).args(["-c", "user.name=t", "-c", "user.email=t@t"]);
        git.env("GIT_CONFIG_GLOBAL", "/dev/null").env("GIT_CONFIG_NOSYSTEM", "1").args(args);
        let mut git = git.stdin(Stdio::piped()).stdout(Stdio::piped()).spawn().unwrap();
        let mut stdin = git.stdin.take().unwrap();
        let input = input.to_owned();
        // On a thread, for git may say much before it has heard all.
        let feed = std::thread::spawn(move || stdin.write_all(input.as_bytes()));
        let output = git.wait_with_output().unwrap();
        let is_fed = feed.join().unwrap().is_ok();
        (is_fed && output.status.success()).then(|| String::from_utf8(output.stdout).unwrap())
    }
    /// Branches ours0, theirs0, ours1, ..., each pair from its base.
    fn commit(&self, all: &[Branches]) {
        let mut stream = String::new();
        for (n, texts) in all.iter().enumerate() {
            for (k, (branch, text)) in ["base", "ours", "theirs"].iter().zip(texts).enumerate() {
                let _ = writeln!(stream, "commit refs/heads/{branch}{n}");
                let _ = writeln!(
                    stream,
                    "mark :{}\ncommitter t <t@t> 0 +0000\ndata 1\nx",
                    3 * n + k + 1
                );
                if k > 0 {
                    let _ = writeln!(stream, "from :{}", 3 * n + 1);
                }
                let _ = writeln!(stream, "M 644 inline a.ron\ndata {}\n{text}", text.len());
            }
        }
        self.git(&["fast-import", "--quiet"], &stream).unwrap();
    }
    /// What merging each pair gives: b into a, and a into b; none where git finds a conflict.
    pub(crate) fn merge_all(&self, all: &[Branches]) -> Vec<[Option<String>; 2]> {
        self.commit(all);
        let pairs: String =
            (0..all.len()).map(|n| format!("ours{n} theirs{n}\ntheirs{n} ours{n}\n")).collect();
        let said = self.git(&["merge-tree", "--stdin", "--no-messages"], &pairs).unwrap();
        let mut words = said.split('\0');
        let mut trees = vec![];
        for _ in 0..2 * all.len() {
            let (status, tree) = (words.next().unwrap(), words.next().unwrap());
            while !words.next().unwrap().is_empty() {}
            trees.push((status == "1").then_some(tree));
        }
        let blobs: String = trees.iter().flatten().map(|tree| format!("{tree}:a.ron\n")).collect();
        let said = self.git(&["cat-file", "--batch"], &blobs).unwrap();
        let mut rest = &*said;
        let mut text = |_: &str| {
            let (head, behind) = rest.split_once('\n').unwrap();
            let size: usize = head.rsplit(' ').next().unwrap().parse().unwrap();
            rest = &behind[size + 1..];
            behind[..size].to_owned()
        };
        let texts: Vec<Option<String>> = trees.iter().map(|tree| tree.map(&mut text)).collect();
        texts.chunks(2).map(|pair| [pair[0].clone(), pair[1].clone()]).collect()
    }
    /// The same of one pair, by checking one branch out and merging the other.
    fn merge(&self, n: usize) -> Option<String> {
        self.git(&["checkout", "-q", &format!("ours{n}")], "").unwrap();
        if self.git(&["merge", "-q", "-m", "x", &format!("theirs{n}")], "").is_none() {
            self.git(&["merge", "--abort"], "").unwrap();
            return None;
        }
        Some(std::fs::read_to_string(self.0.join("a.ron")).unwrap())
    }
}

impl Drop for Repository {
    fn drop(&mut self) {
        // What is left in a folder for temporaries does no harm.
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

fn id(text: &str) -> NodeId {
    NodeId::new(text).unwrap()
}
fn socket(text: &str) -> Socket {
    text.parse().unwrap()
}
fn done(document: &mut Document, edit: Edit) {
    edit.apply(document).unwrap_or_else(|err| panic!("{err}: {edit:?}"));
}

/// A line over the top of the head.
fn stroke(random: &mut Random, others: &Strokes) -> Stroke {
    let [x, bend] = [random.unit() * 8.0 - 4.0, random.unit() - 0.5];
    let at = |k: usize| {
        let t = k as f32 / 7.0 * 2.0 - 1.0;
        glam::Vec3::new(x + bend * t * t, 9.0 - 2.0 * t * t, 5.0 * t)
    };
    let sample =
        |k| Sample { position: at(k), pressure: 0.5, time: 0.1 * k as f32, ..Sample::default() };
    let samples: Vec<Sample> = (0..8).map(sample).collect();
    strokes::finish(&samples, others).unwrap()
}

const PENS: [&str; 2] = ["front", "back"];
/// Nodes that pass curves on, with an input that changes what comes out.
const KINDS: [(&str, &str); 3] =
    [("resample", "count"), ("set_width", "root"), ("set_colour", "seed")];

/// Two pens with rows, each through some nodes into one of two merges, these into the groom.
fn base(random: &mut Random) -> Document {
    let mut document = Document { title: "Rows".into(), ..Document::default() };
    let add = |document: &mut Document, name: &str, kind: &str| {
        let node = document.fresh_node(kind, &id(name)).into();
        let at = Some(Point(160.0 * document.nodes.len() as f32, 40.0));
        done(document, Edit::AddNode { id: id(name), node, at });
    };
    add(&mut document, "head", "head");
    for merge in ["all", "some"] {
        add(&mut document, merge, "merge");
    }
    add(&mut document, "out", "groom_output");
    let wire = |document: &mut Document, from: &str, to: &str| {
        done(document, Edit::Connect { from: socket(from), to: socket(to), at: None });
    };
    for (pen, merge) in PENS.into_iter().zip(["all.curves", "some.curves"]) {
        add(&mut document, pen, "stroke_input");
        wire(&mut document, "head.scalp", &format!("{pen}.scalp"));
        for _ in 0..2 + random.below(9) {
            draw(random, &mut document, pen);
        }
        let mut from = format!("{pen}.curves");
        for n in 0..2 + random.below(4) {
            let kind = random.pick(&KINDS).0;
            let name = format!("{kind}_{pen}_{n}");
            add(&mut document, &name, kind);
            wire(&mut document, &from, &format!("{name}.curves"));
            from = format!("{name}.curves");
            wire(&mut document, &from, merge);
        }
    }
    wire(&mut document, "some.curves", "all.curves");
    wire(&mut document, "all.curves", "out.curves");
    let frame =
        Frame { at: Point(0.0, 0.0), size: Point(100.0, 100.0), text: "rows".into(), colour: 1 };
    done(&mut document, Edit::SetFrame { name: "rows".into(), frame: Some(frame) });
    document
}

fn strokes_of(document: &Document, pen: &str) -> Strokes {
    match document.node(pen).and_then(|node| node.inputs.get("strokes")) {
        Some(Setting::Known(Value::Strokes(strokes))) => (**strokes).clone(),
        _ => Strokes::default(),
    }
}
/// Draws a stroke behind the others.
fn draw(random: &mut Random, document: &mut Document, pen: &str) {
    let stroke = stroke(random, &strokes_of(document, pen));
    let (node, input) = (id(pen), "strokes".to_owned());
    done(document, Edit::AddStroke { node, input, at: usize::MAX, stroke });
}
/// Any node that is there in the base, of the kinds that pass curves on.
fn passing(random: &mut Random, base: &Document) -> NodeId {
    let of = |(id, node): (&NodeId, &std::sync::Arc<Node>)| {
        KINDS.iter().any(|(kind, _)| *kind == node.kind).then(|| id.clone())
    };
    random.pick(&base.nodes.iter().filter_map(of).collect::<Vec<_>>())
}

/// Makes one edit as the editor makes it, unless one of what it is about is `taken` by the other person;
/// what it is about is added to `mine`. Says whether it was made.
fn edit(
    random: &mut Random,
    base: &Document,
    document: &mut Document,
    (who, what): (&str, usize),
    taken: &BTreeSet<String>,
    mine: &mut BTreeSet<String>,
) -> bool {
    let node = passing(random, base);
    let mut is_free = |facts: &[String]| {
        let is_free = facts.iter().all(|fact| !taken.contains(fact));
        if is_free {
            mine.extend(facts.iter().cloned());
        }
        is_free
    };
    let there = document.nodes.contains_key(&node);
    match what {
        // A node with its wires: from any node that has curves, into a merge.
        0 => {
            let kind = random.pick(&KINDS).0;
            let new = document.free_id(&format!("{kind}_{who}"));
            let fresh = document.fresh_node(kind, &new).into();
            let from = random.pick(&[node.as_str(), "front", "back"]).to_owned();
            if !is_free(&[format!("there {from}")]) || !document.nodes.contains_key(&*from) {
                return false;
            }
            let at = Some(Point(random.below(900) as f32, random.below(900) as f32));
            done(document, Edit::AddNode { id: new.clone(), node: fresh, at });
            let [from, to] = [Socket::new(id(&from), "curves"), Socket::new(new.clone(), "curves")];
            done(document, Edit::Connect { from, to: to.clone(), at: None });
            let merge = random.pick(&["all.curves", "some.curves"]);
            done(document, Edit::Connect { from: to, to: socket(merge), at: None });
        }
        1 => {
            let pen = random.pick(&PENS);
            draw(random, document, pen);
        }
        // A point of a stroke is moved.
        2 => {
            let pen = random.pick(&PENS);
            let mut stroke = random.pick(&strokes_of(base, pen).0);
            let k = random.below(stroke.samples.len());
            if !is_free(&[format!("{} {k}", stroke.id)]) {
                return false;
            }
            let now = strokes_of(document, pen);
            stroke.samples.clone_from(&now.0.iter().find(|s| s.id == stroke.id).unwrap().samples);
            stroke.samples[k].position.x += 0.5;
            let (node, input) = (id(pen), "strokes".to_owned());
            done(document, Edit::ReplaceStroke { node, input, stroke });
        }
        3 => {
            let kind = base.node(node.as_str()).unwrap().kind.clone();
            let input = KINDS.iter().find(|(known, _)| *known == kind).unwrap().1.to_owned();
            if !there || !is_free(&[format!("{node}.{input}"), format!("there {node}")]) {
                return false;
            }
            let value = match &*input {
                "count" | "seed" => Value::Int(2 + random.below(30) as i64),
                _ => Value::Float(0.01 + random.unit()),
            };
            done(document, Edit::SetInput { node, input, setting: Setting::Known(value) });
        }
        // Another wire into a merge, at any place of its list.
        4 => {
            let merge = random.pick(&["all", "some"]);
            let wires = document.wires(&id(merge), "curves");
            let from = Socket::new(node.clone(), "curves");
            let at = Some(random.below(wires.len() + 3));
            if !there || wires.contains(&from) {
                return false;
            }
            if !is_free(&[format!("{from} {merge}"), format!("there {node}")]) {
                return false;
            }
            done(document, Edit::Connect { from, to: Socket::new(id(merge), "curves"), at });
        }
        5 | 6 => {
            let any = random.pick(&base.nodes.keys().cloned().collect::<Vec<_>>());
            let fact = format!("{} {any}", if what == 5 { "move" } else { "label" });
            if !document.nodes.contains_key(&any) || !is_free(&[fact, format!("there {any}")]) {
                return false;
            }
            let to = Some(Point(random.below(900) as f32, random.below(900) as f32));
            let label = Some(format!("name {}", random.below(99)));
            done(
                document,
                if what == 5 {
                    Edit::Move { id: any, to }
                } else {
                    Edit::SetLabel { id: any, label }
                },
            );
        }
        // A node is removed, and what it fed is fed by what fed it.
        7 => {
            let beside = |(to, from): (&Socket, &Vec<Socket>)| {
                let wires = from.iter().map(|from| [to.node.clone(), from.node.clone()]);
                wires.filter(|ends| ends.contains(&node)).flatten().collect::<Vec<_>>()
            };
            let ends: BTreeSet<NodeId> = base.links.iter().flat_map(beside).collect();
            let facts = [format!("there {node}"), format!("wires {node}")];
            if !there
                || facts.iter().any(|fact| taken.contains(fact) || mine.contains(fact))
                || ends.iter().any(|end| taken.contains(&format!("gone {end}")))
            {
                return false;
            }
            mine.extend(facts);
            mine.insert(format!("gone {node}"));
            mine.extend(ends.iter().map(|end| format!("wires {end}")));
            let edit = wiring::remove_healed(document, &[node].into());
            done(document, edit);
        }
        8 => {
            if !is_free(&["display".to_owned(), format!("there {node}")]) || !there {
                return false;
            }
            done(document, Edit::SetDisplay(Some(node)));
        }
        9 => {
            let frame = Frame {
                at: Point(random.below(900) as f32, 0.0),
                size: Point(50.0, 50.0),
                text: who.into(),
                colour: 0,
            };
            let name = format!("{who} {}", random.below(1000));
            done(document, Edit::SetFrame { name, frame: Some(frame) });
        }
        _ => {
            if !there || !is_free(&[format!("note {node}"), format!("there {node}")]) {
                return false;
            }
            done(document, Edit::SetNodeNote { id: node, note: format!("by {who}") });
        }
    }
    true
}

/// The hash of all that a groom puts out.
pub(crate) fn hash(evaluator: &Evaluator, text: &str) -> String {
    let loaded = read(text).unwrap_or_else(|err| panic!("{err}\n{text}"));
    assert!(
        loaded.dropped_comments.is_empty() && loaded.warnings.is_empty(),
        "{:?}",
        loaded.warnings
    );
    let target = socket("out.curves");
    let plan = plan(&loaded.document, &[target], Quality::Final, &DiskFiles::default());
    let plan = plan.unwrap_or_else(|err| panic!("{err:?}\n{text}"));
    let outcome = evaluator.run(&plan, OnFailure::Stop, &CancelToken::default(), &Quiet);
    match &outcome.targets[0] {
        Some(Value::Curves(curves)) => content_hash(curves),
        other => panic!("{other:?} {:?}\n{text}", outcome.nodes),
    }
}

/// A groom, and what each of two people makes of it by these edits and then so many of any kind, where they keep `apart` none about
/// what the other's are about; with what each one's are about.
pub(crate) fn pair(
    seed: u64,
    first: &[usize],
    more: usize,
    apart: bool,
) -> ([Document; 3], Vec<BTreeSet<String>>) {
    let mut random = Random::new(seed);
    let base = base(&mut random);
    let mut all = vec![BTreeSet::new()];
    let both = ["a", "b"].map(|who| {
        let (mut document, mut mine) = (base.clone(), BTreeSet::new());
        let taken = if apart { all.last().unwrap() } else { &BTreeSet::new() };
        let mut one = |random: &mut Random, what| {
            edit(random, &base, &mut document, (who, what), taken, &mut mine)
        };
        for what in first {
            while !one(&mut random, *what) {}
        }
        let mut made = 0;
        for _ in 0..100 {
            let what = random.below(11);
            made += usize::from(made < more && one(&mut random, what));
        }
        all.push(mine);
        document
    });
    let [ours, theirs] = both;
    ([base, ours, theirs], all)
}

/// How many of `pairs` merge clean, where each of two people makes these edits and then so many of any
/// kind.
fn clean(name: &str, pairs: u64, first: &[usize], more: usize) -> Option<usize> {
    let repository = Repository::new(name)?;
    let evaluator = Evaluator::new(1, 64 << 20).unwrap();
    let (mut branches, mut edits) = (vec![], vec![]);
    for seed in 0..pairs {
        let (documents, all) = pair(seed, first, more, true);
        branches.push(documents.map(|document| write(&document)));
        edits.push(all);
    }
    let merged = repository.merge_all(&branches);
    let mut count = 0;
    for (n, pair) in merged.iter().enumerate() {
        if n < 3 {
            assert_eq!(repository.merge(n), pair[0], "pair {n}");
        }
        if let [Some(ours), Some(theirs)] = pair {
            count += 1;
            assert_eq!(hash(&evaluator, ours), hash(&evaluator, theirs), "pair {n}");
        } else {
            println!("pair {n}: a conflict; {:?} and {:?}", edits[n][1], edits[n][2]);
        }
    }
    println!("{count} of {pairs} merge clean: {first:?} and {more} of any kind");
    Some(count)
}

#[test]
fn of_200_pairs_of_random_edits_95_in_100_merge_clean_and_mean_the_same_either_way() {
    if let Some(count) = clean("merges", 200, &[], 2) {
        assert!(count >= 190, "{count}");
    }
}

#[test]
fn two_people_each_add_a_node_its_wires_and_a_stroke_to_one_groom() {
    if let Some(count) = clean("additions", 40, &[0, 1], 0) {
        assert!(count >= 38, "{count}");
    }
}

#[test]
fn two_people_each_wire_to_a_merge_at_any_place_of_its_list() {
    if let Some(count) = clean("wires", 40, &[4], 0) {
        assert!(count >= 34, "{count}");
    }
}

/// Counted for those who change the format; three edits each and more of a small groom do meet.
#[test]
#[ignore = "long"]
fn what_merges_of_many_edits() {
    for more in 1..=4 {
        clean("counted", 1000, &[], more);
    }
    for kind in 0..=10 {
        clean("counted", 500, &[kind], 0);
    }
}
