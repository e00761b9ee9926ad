//! Stages of several layers: what is brought in is read where it lies, what is not followed is told, hostile webs of arcs end.
//!
//! With OpenUSD (see `openusd.rs`) the same stages are composed by it, and read as text and as crate files: points must be the same.

use super::common::read_curves;
use super::openusd::{check_read, folder, passed, validate};
use coif_nodes::formats::usd::read::{ReadStage, read_stage};
use serde_json::Value;
use std::collections::BTreeMap;

type Files = &'static [(&'static str, &'static str)];

/// A hair of two points, 4 units long.
const HAIR: &str = "uniform token type = \"linear\"\nint[] curveVertexCounts = [2]\n\
                    point3f[] points = [(0, 0, 0), (0, 4, 0)]";
/// Ten units to the right.
const MOVED: &str = "double3 xformOp:translate = (10, 0, 0)\n\
                     uniform token[] xformOpOrder = [\"xformOp:translate\"]";

/// A stage: its layers, with HAIR and MOVED as written above, and the first points of the curves that are in it.
struct Case {
    name: &'static str,
    files: Files,
    curves: &'static [(&'static str, [f32; 3])],
    /// Of what is left out: where, what, and a part of why.
    left_out: &'static [[&'static str; 3]],
}

const CASES: &[Case] = &[
    Case {
        name: "a_reference_within_the_layer",
        files: &[(
            "root.usd",
            "def BasisCurves \"hair\" { HAIR }
             def \"brows\" (prepend references = </hair>) { MOVED }",
        )],
        curves: &[("/hair", [0.0, 0.0, 0.0]), ("/brows", [10.0, 0.0, 0.0])],
        left_out: &[],
    },
    Case {
        name: "references_to_other_layers_with_their_transforms_and_opinions_over_them",
        files: &[
            (
                "root.usd",
                "def \"a\" (references = @parts/hair.usd@) { MOVED }
                 def \"b\" (references = @./parts/hair.usd@</set/long>) { }
                 def Xform \"c\" (references = @parts/hair.usd@) {
                     over \"short\" { point3f[] points = [(1, 1, 1), (1, 5, 1)] }
                     def BasisCurves \"own\" { HAIR }
                 }",
            ),
            (
                "parts/hair.usd",
                "(defaultPrim = \"set\")
                 def Xform \"set\" {
                     def BasisCurves \"short\" { HAIR MOVED }
                     def BasisCurves \"long\" (references = @../deeper.usd@</x>) { MOVED }
                 }",
            ),
            ("deeper.usd", "over \"x\" { HAIR }"),
        ],
        curves: &[
            ("/a/short", [20.0, 0.0, 0.0]),
            ("/a/long", [20.0, 0.0, 0.0]),
            ("/b", [10.0, 0.0, 0.0]),
            ("/c/short", [11.0, 1.0, 1.0]),
            ("/c/own", [0.0, 0.0, 0.0]),
            ("/c/long", [10.0, 0.0, 0.0]),
        ],
        left_out: &[],
    },
    Case {
        name: "sublayers_in_their_order_and_lists_edited_by_stronger_ones",
        files: &[
            (
                "root.usd",
                "(subLayers = [@strong.usd@, @weak.usd@ (offset = 2)])
                 over \"hair\" { MOVED }",
            ),
            (
                "strong.usd",
                "over \"hair\" { point3f[] points = [(1, 0, 0), (1, 4, 0)] }
                 over \"no\" (delete references = </hair>) { }
                 over \"yes\" (prepend references = </proto>) { }
                 over \"gone\" (active = false) { }",
            ),
            (
                "weak.usd",
                "def BasisCurves \"hair\" { HAIR }
                 def \"no\" (prepend references = </hair>) { }
                 def \"yes\" (prepend references = </hair>) { }
                 def BasisCurves \"gone\" { HAIR }
                 class BasisCurves \"proto\" { point3f[] points = [(7, 0, 0), (7, 4, 0)] }",
            ),
        ],
        curves: &[("/hair", [11.0, 0.0, 0.0]), ("/yes", [17.0, 0.0, 0.0])],
        left_out: &[],
    },
    Case {
        name: "payloads_and_classes",
        files: &[
            (
                "root.usd",
                "class BasisCurves \"_strand\" { HAIR }
                 def \"a\" (payload = @p.usd@</p>) { }
                 def \"b\" (inherits = </_strand>) { MOVED }
                 def \"c\" (inherits = </_strand>; payload = @p.usd@</p>) { }
                 def \"d\" (specializes = </_strand>; payload = @p.usd@</p>) { }",
            ),
            ("p.usd", "def BasisCurves \"p\" { uniform token type = \"linear\"; int[] curveVertexCounts = [2]
             point3f[] points = [(3, 0, 0), (3, 4, 0)] }"),
        ],
        curves: &[
            ("/a", [3.0, 0.0, 0.0]),
            ("/b", [10.0, 0.0, 0.0]),
            ("/c", [0.0, 0.0, 0.0]),
            ("/d", [3.0, 0.0, 0.0]),
        ],
        left_out: &[],
    },
    Case {
        name: "selected_variants_alone",
        files: &[
            (
                "root.usd",
                "def Xform \"a\" (references = @v.usd@</v>; variants = { string lod = \"low\" }) { }
                 def Xform \"b\" (references = @v.usd@</v>) { }
                 def Xform \"c\" (references = @v.usd@</v>; variants = { string lod = \"none\" }) { }
                 def Xform \"d\" (prepend variantSets = \"set\") {
                     variantSet \"set\" = { \"one\" { def BasisCurves \"unseen\" { HAIR } } }
                 }",
            ),
            (
                "v.usd",
                "def Xform \"v\" (
                     variants = { string lod = \"high\"; string tint = \"red\" }
                     prepend variantSets = [\"lod\", \"tint\"]
                 ) {
                     def BasisCurves \"always\" { HAIR }
                     variantSet \"lod\" = {
                         \"high\" (prepend references = </more>) { def BasisCurves \"fine\" { HAIR } }
                         \"low\" { over \"always\" { MOVED } }
                     }
                     variantSet \"tint\" = { \"red\" { } \"blue\" { def BasisCurves \"blue\" { HAIR } } }
                 }
                 def Xform \"more\" { def BasisCurves \"extra\" { HAIR } }",
            ),
        ],
        curves: &[
            ("/a/always", [10.0, 0.0, 0.0]),
            ("/b/always", [0.0, 0.0, 0.0]),
            ("/b/fine", [0.0, 0.0, 0.0]),
            ("/b/extra", [0.0, 0.0, 0.0]),
            ("/c/always", [0.0, 0.0, 0.0]),
        ],
        left_out: &[["/c", "variant set", "no \"none\""], ["/d", "variant set", "selected"]],
    },
    Case {
        name: "instances_and_what_is_said_over_them",
        files: &[(
            "root.usd",
            "class Xform \"proto\" { def BasisCurves \"hair\" { HAIR } }
             def Xform \"a\" (instanceable = true; references = </proto>) { MOVED
                 over \"hair\" { point3f[] points = [(9, 9, 9), (9, 10, 9)] } }
             def Xform \"b\" (references = </proto>) {
                 over \"hair\" { point3f[] points = [(9, 9, 9), (9, 10, 9)] } }
             def Xform \"c\" (instanceable = true) { def BasisCurves \"own\" { HAIR } }",
        )],
        curves: &[
            ("/a/hair", [10.0, 0.0, 0.0]),
            ("/b/hair", [9.0, 9.0, 9.0]),
            ("/c/own", [0.0, 0.0, 0.0]),
        ],
        left_out: &[],
    },
    Case {
        name: "what_is_referenced_brings_what_lies_above_it",
        files: &[(
            "root.usd",
            "def Xform \"world\" (references = </lib>) {
                 def \"x\" (references = </world/tuft>) { }
                 def \"tuft\" (references = </other>) { }
             }
             class Xform \"lib\" { def BasisCurves \"tuft\" { HAIR } }
             class BasisCurves \"other\" { point3f[] points = [(5, 0, 0), (5, 4, 0)] }",
        )],
        curves: &[("/world/x", [5.0, 0.0, 0.0]), ("/world/tuft", [5.0, 0.0, 0.0])],
        left_out: &[],
    },
    Case {
        name: "a_blocked_value_stays_blocked",
        files: &[(
            "root.usd",
            "def BasisCurves \"hair\" { HAIR }
             def \"a\" (references = </hair>) { point3f[] points = None }",
        )],
        curves: &[("/hair", [0.0, 0.0, 0.0])],
        left_out: &[["/a", "curves", "no points"]],
    },
];

/// What is not followed, and hostile stages: OpenUSD is not asked.
const ALONE: &[Case] = &[
    Case {
        name: "what_is_not_there",
        files: &[
            (
                "root.usd",
                "(subLayers = [@gone.usd@])
                 def BasisCurves \"hair\" { HAIR }
                 def \"a\" (references = [@gone.usd@</x>, @there.usd@</x>]) { }
                 def \"b\" (references = @there.usd@) { }
                 def \"c\" (payload = @../../outside.usd@) { }
                 def \"d\" (references = [@http://x.y/z.usd@, @/etc/z.usd@]) { }
                 def \"e\" (references = @there.abc@) { }",
            ),
            ("there.usd", "def \"y\" { }"),
            ("there.abc", "OGAWA"),
        ],
        curves: &[("/hair", [0.0, 0.0, 0.0])],
        left_out: &[
            ["/", "sublayer", "not there"],
            ["/a", "reference", "not there"],
            ["/a", "reference", "no prim </x>"],
            ["/b", "reference", "defaultPrim"],
            ["/c", "payload", "outside"],
            ["/d", "reference", "beside"],
            ["/d", "reference", "beside"],
            ["/e", "reference", "expected def"],
        ],
    },
    Case {
        name: "what_comes_back_to_itself",
        files: &[
            (
                "root.usd",
                "(subLayers = [@root.usd@, @sub.usd@])
                 def BasisCurves \"hair\" { HAIR }
                 def \"a\" (references = </b>) { }
                 def \"b\" (references = </a>) { }
                 def \"c\" { def \"d\" (references = </c>) { } }
                 def \"e\" (references = @sub.usd@</e>) { }",
            ),
            ("sub.usd", "(subLayers = [@root.usd@]) def \"e\" (references = @root.usd@</e>) { }"),
        ],
        curves: &[("/hair", [0.0, 0.0, 0.0])],
        left_out: &[
            ["/", "sublayer", "back"],
            ["/", "sublayer", "back"],
            ["/a", "reference", "back"],
            ["/b", "reference", "back"],
            ["/c/d", "reference", "back"],
            ["/", "sublayer", "back"],
            ["/e", "reference", "back"],
        ],
    },
    Case {
        name: "kinds_that_are_not_read",
        files: &[(
            "root.usd",
            "def BasisCurves \"hair\" { HAIR }
             def NurbsCurves \"n\" { }
             def PointInstancer \"p\" { def BasisCurves \"proto\" { HAIR } }
             def BasisCurves \"clip\" (clips = { dictionary default = { } }) { HAIR }
             def BasisCurves \"empty\" { }
             def BasisCurves \"twice\" { HAIR }
             def BasisCurves \"twice\" { HAIR }",
        )],
        curves: &[
            ("/hair", [0.0, 0.0, 0.0]),
            ("/clip", [0.0, 0.0, 0.0]),
            ("/twice", [0.0, 0.0, 0.0]),
        ],
        left_out: &[
            ["/twice", "prim", "twice"],
            ["/n", "NurbsCurves", "BasisCurves"],
            ["/p", "PointInstancer", "instances"],
            ["/clip", "clips", "not read"],
            ["/empty", "curves", "no points"],
        ],
    },
];

/// The text as OpenUSD wants it, one statement a line.
fn text(file: &str) -> String {
    let lines = file.replace("{ ", "{\n").replace(" }", "\n}").replace("HAIR MOVED", "HAIR\nMOVED");
    format!("#usda 1.0\n{}\n", lines.replace("HAIR", HAIR).replace("MOVED", MOVED))
}

/// Reads a stage whose root is `root.usd`.
fn read(files: &BTreeMap<String, Vec<u8>>) -> ReadStage {
    let mut beside =
        |path: &str| files.get(path).cloned().ok_or_else(|| "it is not there".to_owned());
    read_stage(&files["root.usd"], "root.usd", &mut beside).unwrap()
}

#[track_caller]
fn check(case: &Case, read: &ReadStage) {
    let mut found: Vec<_> =
        read.curves.iter().map(|c| (c.path.as_str(), c.points[0].to_array())).collect();
    let mut expected = case.curves.to_vec();
    // OpenUSD has another order of children.
    found.sort_by_key(|(path, _)| *path);
    expected.sort_by_key(|(path, _)| *path);
    assert_eq!(found, expected, "{}: {:?}", case.name, read.left_out);
    let told = read.left_out.iter().zip(case.left_out);
    for (what, [path, kind, why]) in told {
        let is_it = what.path == *path && what.kind == *kind && what.reason.contains(why);
        assert!(is_it, "{}: {what:?} is not {path} {kind} {why}", case.name);
    }
    assert_eq!(read.left_out.len(), case.left_out.len(), "{}: {:?}", case.name, read.left_out);
}

#[test]
fn what_is_brought_in_is_read_and_what_is_not_is_told() {
    for case in CASES.iter().chain(ALONE) {
        let files =
            case.files.iter().map(|(name, file)| ((*name).to_owned(), text(file).into_bytes()));
        check(case, &read(&files.collect()));
    }
}

#[test]
fn openusd_composes_the_same() {
    let at = folder("composed");
    for case in CASES {
        for (name, file) in case.files {
            let path = at.join(case.name).join(name);
            std::fs::create_dir_all(path.parent().unwrap()).unwrap();
            std::fs::write(path, text(file)).unwrap();
        }
    }
    let test = "openusd_composes_the_same";
    let Some(output) = validate(test, &["compose", at.to_str().unwrap()]) else { return };
    let reports: Value = serde_json::from_str(passed(&output)).unwrap();
    for case in CASES {
        for form in ["", "_crate"] {
            let of = |name: &str| at.join(format!("{}{form}", case.name)).join(name);
            let bytes = |name: &str| (name.to_owned(), std::fs::read(of(name)).unwrap());
            let found = read(&case.files.iter().map(|(name, _)| bytes(name)).collect());
            check(case, &found);
            let report = reports[case.name].as_object().unwrap();
            let blocked = report.iter().filter(|(_, prim)| prim["points"] == Value::Null).count();
            assert_eq!(found.curves.len(), report.len() - blocked, "{}", case.name);
            for curves in &found.curves {
                check_read(curves, &report[&curves.path]);
            }
        }
    }
}

#[test]
fn packages_bring_in_their_own_files_alone() {
    let root = text(
        "def \"a\" (references = @in/hair.usda@</x>) { }
                     def \"b\" (references = @gone.usda@</x>) { }",
    );
    let hair = text("def BasisCurves \"x\" { HAIR }");
    let mut package = vec![];
    for (name, content) in [("root.usda", &root), ("in/hair.usda", &hair)] {
        package.extend(b"PK\x03\x04");
        package.extend([0; 14]);
        package.extend((content.len() as u32).to_le_bytes());
        package.extend((content.len() as u32).to_le_bytes());
        package.extend((name.len() as u16).to_le_bytes());
        package.extend([0; 2]);
        package.extend(name.as_bytes());
        package.extend(content.as_bytes());
    }
    let nothing = &mut |_: &str| -> Result<Vec<u8>, String> { panic!("asked for outside") };
    let found = read_stage(&package, "hair.usdz", nothing).unwrap();
    assert_eq!((found.curves.len(), found.left_out.len()), (1, 1));
    assert_eq!(found.left_out[0].asset, "@gone.usda@</x>");
    // From outside, through its first file or one that is named.
    let beside = text(
        "def \"c\" (references = @hair.usdz@</a>) { }
                       def \"d\" (references = @hair.usdz[in/hair.usda]@</x>) { }",
    );
    let files = [("root.usd", beside.into_bytes()), ("hair.usdz", package)];
    let found = read(&files.map(|(name, bytes)| (name.to_owned(), bytes)).into());
    let paths: Vec<_> = found.curves.iter().map(|curves| curves.path.as_str()).collect();
    assert_eq!((paths, found.left_out.len()), (vec!["/c", "/d"], 0));
}

#[test]
fn webs_of_arcs_end() {
    // Each level brings in the next twice: 2^60 prims.
    let levels: String = (0..60)
        .map(|k| {
            let next = k + 1;
            format!("class \"p{k}\" {{ def \"a\" (references = </p{next}>) {{}} def \"b\" (references = </p{next}>) {{}} }}\n")
        })
        .collect();
    let web =
        format!("#usda 1.0\n{levels} class \"p60\" {{}} def \"all\" (references = </p0>) {{}}");
    assert!(read_curves(web.as_bytes(), "usda").unwrap_err().contains("unfolds"));
    // A chain of references, and one of prims, longer than any in use.
    let chain: String =
        (0..1000).map(|k| format!("def \"p{k}\" (references = </p{}>) {{}}\n", k + 1)).collect();
    let read = read_curves(format!("#usda 1.0\n{chain}").as_bytes(), "usda");
    assert_eq!(read.map(|curves| curves.len()), Ok(0));
    let deep = format!("#usda 1.0\n{}{}", "def \"a\" {".repeat(50_000), "}".repeat(50_000));
    assert_eq!(read_curves(deep.as_bytes(), "usda").map(|curves| curves.len()), Ok(0));
    // As long in text as a list of references may be.
    let list = "</p>,".repeat(20_000);
    let all = format!("#usda 1.0\ndef \"p\" {{}} def \"a\" (references = [{list}]) {{}}");
    let _ = read_curves(all.as_bytes(), "usda");
}

#[test]
fn values_brought_in_many_times_are_bounded() {
    // 10,000 points take 120 kB of 256 MiB, a hundred times.
    let points = "(0, 0, 0), (0, 4, 0), ".repeat(5000);
    let curves = format!(
        "class BasisCurves \"p\" {{ int[] curveVertexCounts = [10000] point3f[] points = [{points}] \
         uniform token type = \"linear\" }}\n"
    );
    let copies: String =
        (0..100).map(|k| format!("def \"c{k}\" (references = </p>) {{}}\n")).collect();
    let read = read_curves(format!("#usda 1.0\n{curves}{copies}").as_bytes(), "usda").unwrap();
    assert_eq!(read.len(), 100);
}
