//! Traces of random hairs: whatever is not listed can be off, in any choice, and nothing that is listed can.

use super::*;
use crate::document::testing::Random;
use crate::schedule::files::DiskFiles;

/// A groom, and an evaluator that keeps what it made.
struct Bench {
    document: Document,
    outputs: Vec<Socket>,
    evaluator: Evaluator,
    files: DiskFiles,
}

impl Bench {
    fn new(text: &str) -> Self {
        let document = crate::file::read(text).unwrap().document;
        let outputs = document.nodes.iter().filter(|(_, node)| node.kind == "groom_output");
        let outputs = outputs.map(|(id, _)| Socket::new(id.clone(), "curves")).collect();
        let evaluator = Evaluator::new(0, 1 << 30).unwrap();
        Self { document, outputs, evaluator, files: DiskFiles::default() }
    }

    fn groom(&self) -> Groom<'_> {
        let (document, files) = (&self.document, &self.files);
        Groom { document, files, quality: Quality::Preview, allow_large: false }
    }

    fn curves(&self, document: &Document, output: &Socket) -> Option<Value> {
        let target = std::slice::from_ref(output);
        let planned = plan(document, target, Quality::Preview, &self.files).ok()?;
        let cancel = CancelToken::default();
        self.evaluator.run(&planned, OnFailure::Stop, &cancel, &Quiet).targets.remove(0)
    }

    fn trace(&self, hair: u64) -> Result<Traced, NotTraced> {
        let (cancel, mut far) = (CancelToken::default(), vec![]);
        let session = (&self.evaluator, &cancel);
        let traced = trace(&self.groom(), &self.outputs, hair, session, &mut |p| far.push(p))?;
        assert!(far.windows(2).all(|two| two[1].open <= two[0].open), "{far:?}");
        Ok(traced)
    }

    /// Whether a hair has its bits without these.
    fn is_same<'a>(&self, traced: &Traced, off: impl IntoIterator<Item = &'a Part>) -> bool {
        let bits = |document: &Document, output: &Socket| {
            bits_of(self.curves(document, output).as_ref(), traced.hair)
        };
        let whole = bits(&self.document, &traced.output);
        assert!(whole.is_some());
        let (less, output) = without(&self.document, off, &traced.output);
        whole == output.and_then(|output| bits(&less, &output))
    }
}

/// Random hairs of an output keep their bits whatever that is not listed is off, and lose them without anything that is.
#[track_caller]
fn check(name: &str, text: &str, output: &str, hairs: usize) -> Vec<Traced> {
    let bench = Bench::new(text);
    let output: Socket = output.parse().unwrap();
    let Some(Value::Curves(curves)) = bench.curves(&bench.document, &output) else {
        panic!("{name}: {output} gives hair")
    };
    let ids: Vec<u64> = curves.each().map(|(tuft, i)| tuft.id(i)).collect();
    let mut random = Random::new(7);
    let mut all = vec![];
    for _ in 0..hairs {
        let hair = ids[random.below(ids.len())];
        let traced = bench.trace(hair).unwrap();
        assert_eq!(traced.output, output);
        let listed: Vec<&Part> = traced.found.iter().map(|found| &found.part).collect();
        let parts = parts(&bench.groom(), &output).unwrap();
        let rest: Vec<&Part> = parts.iter().filter(|part| !listed.contains(part)).collect();
        for _ in 0..4 {
            let some: Vec<&Part> = rest.iter().copied().filter(|_| random.below(2) == 0).collect();
            assert!(
                bench.is_same(&traced, some.iter().copied()),
                "{name}: {hair:x} without {some:?}"
            );
        }
        for found in traced.found.iter().filter(|found| found.alone) {
            assert!(!bench.is_same(&traced, [&found.part]), "{name}: {hair:x} without {found:?}");
        }
        all.push(traced);
    }
    all
}

fn drawn(traced: &Traced) -> Vec<u64> {
    let ids = traced.found.iter().filter_map(|found| match &found.part {
        Part::Drawn { id, .. } => Some(*id),
        Part::Node(_) => None,
    });
    ids.collect()
}

#[test]
fn gestures_that_made_a_hair_are_found_among_those_of_a_sketch() {
    let text = crate::grooms::by_name("sketch_bob").unwrap();
    for traced in check("sketch_bob", text, "node.curves", 3) {
        let drawn = drawn(&traced);
        assert!((1..10).contains(&drawn.len()), "{traced}: {drawn:?} of 35 gestures");
    }
}

#[test]
fn strokes_that_made_a_hair_are_found_among_those_of_braids() {
    let text = crate::grooms::by_name("braids").unwrap();
    for traced in check("braids", text, "sections_out.curves", 2) {
        assert_eq!(drawn(&traced).len(), 1, "{traced}");
        assert!(traced.evaluations < traced.parts, "{traced}");
    }
}

/// Guides under a mask that is painted by six strokes, of which two undo each other, in a group; beside it a second lot.
const PAINTED: &str = r#"(format: 3, nodes: {
    "head": (kind: "head"),
    "lot": (kind: "group",
        interface: (inputs: [(name: "scalp", type: "scalp")], outputs: [(name: "curves", type: "curves")]),
        links: {"scalp": "head.scalp"},
        nodes: {
            "in": (kind: "group_input"),
            "mask": (kind: "paint_mask", links: {"scalp": "in.scalp"}, inputs: {"strokes": [
                (id: 1, mode: "paint", radius: 8.0, strength: 1.0, points: [(0.0, 9.0, 5.0), (0.0, 9.8, 2.0)]),
                (id: 2, mode: "paint", radius: 8.0, strength: 0.5, points: [(0.0, 9.8, 2.0), (0.0, 9.0, -4.0)]),
                (id: 3, mode: "paint", radius: 6.0, strength: 1.0, points: [(-6.0, 6.0, 0.0)]),
                (id: 4, mode: "paint", radius: 5.0, strength: 1.0, points: [(6.0, 6.0, 0.0)]),
                (id: 5, mode: "erase", radius: 5.0, strength: 1.0, points: [(6.0, 6.0, 0.0)]),
                (id: 6, mode: "paint", radius: 6.0, strength: 0.7, points: [(0.0, 2.0, -9.0)]),
            ]}),
            "hair": (kind: "scatter_guides", links: {"scalp": "in.scalp"}, inputs: {"count": 60}),
            "width": (kind: "set_width", links: {"curves": "hair.curves", "scale": "mask.mask"}),
            "out": (kind: "group_output", links: {"curves": "width.curves"}),
        }),
    "other": (kind: "scatter_guides", links: {"scalp": "head.scalp"}, inputs: {"count": 60, "seed": 9}),
    "all": (kind: "merge", links: {"curves": ["lot.curves", "other.curves"]}),
    "out": (kind: "groom_output", links: {"curves": "all.curves"}),
})"#;

#[test]
fn strokes_of_a_mask_in_a_group_are_found_and_the_other_lot_is_not() {
    let traced = check("painted", PAINTED, "out.curves", 12);
    let nodes = |traced: &Traced| {
        let nodes = traced.found.iter().filter(|found| matches!(found.part, Part::Node(_)));
        nodes.map(|found| found.part.node().to_string()).collect::<Vec<_>>().join(" ")
    };
    let kinds: BTreeSet<(String, bool)> =
        traced.iter().map(|one| (nodes(one), !drawn(one).is_empty())).collect();
    let lots: BTreeSet<&str> = kinds.iter().map(|(nodes, _)| nodes.as_str()).collect();
    assert!(lots.contains("head other all"), "{lots:?}");
    assert!(lots.iter().any(|nodes| nodes.contains("lot/hair")), "{lots:?}");
    assert!(
        lots.iter().all(|nodes| !(nodes.contains("other") && nodes.contains("lot"))),
        "{lots:?}"
    );
    assert!(kinds.iter().any(|(_, drawn)| *drawn), "{kinds:?}");
}

#[test]
fn what_cannot_be_traced_says_why_and_a_trace_can_be_stopped() {
    let bench = Bench::new(PAINTED);
    assert_eq!(bench.trace(5), Err(NotTraced::NoHair(5)));
    let Some(Value::Curves(curves)) = bench.curves(&bench.document, &bench.outputs[0]) else {
        panic!("it gives hair")
    };
    let (tuft, i) = curves.each().next().unwrap();
    let (cancel, mut asked) = (CancelToken::default(), 0);
    let session = (&bench.evaluator, &cancel);
    let stopped = trace(&bench.groom(), &bench.outputs, tuft.id(i), session, &mut |_| {
        asked += 1;
        if asked == 3 {
            cancel.cancel();
        }
    });
    assert_eq!((stopped, asked), (Err(NotTraced::Cancelled), 3));
    let broken = PAINTED.replace("\"curves\": \"all.curves\"", "\"curves\": \"head.scalp\"");
    let bench = Bench::new(&broken);
    assert!(matches!(bench.trace(tuft.id(i)), Err(NotTraced::Bad(_))));
}
