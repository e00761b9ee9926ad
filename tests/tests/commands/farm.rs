//! Many evaluations of one command, or of one job: every row of a sweep, every task of a farm.

use coif_tests::{Folder, Ran, run};
use serde_json::Value as Json;
use std::path::Path;

const GRAPH: &str = r#"(
    format: 3,
    title: "Test",
    seed: 0,
    nodes: {
        "head": (
            kind: "head",
        ),
        "guides": (
            kind: "scatter_guides",
            inputs: {
                "count": 40,
            },
        ),
        "hair": (
            kind: "interpolate",
            inputs: {
                "by": "count",
                "count": 200,
            },
        ),
        "out": (
            kind: "groom_output",
        ),
    },
    links: {
        "guides.scalp": "head.scalp",
        "hair.guides": "guides.curves",
        "hair.scalp": "head.scalp",
        "out.curves": "hair.curves",
    },
)
"#;

fn text(path: &Path) -> String {
    path.display().to_string()
}

fn json(path: &Path) -> Json {
    let text = std::fs::read_to_string(path).expect("it was written");
    serde_json::from_str(&text).expect("it is JSON")
}

/// Evaluates the rows of a table into `hair_{name}.usda`, with a report: what was said, the report, the files there are.
fn sweep(test: &str, table: &str, more: &[&str]) -> (Ran, Json, Vec<String>) {
    let folder = Folder::new(test);
    std::fs::write(folder.path("graph.ron"), GRAPH).unwrap();
    std::fs::write(folder.path("table.csv"), table).unwrap();
    let path = |name: &str| text(&folder.path(name));
    let mut args = vec!["eval".to_owned(), path("graph.ron")];
    args.extend(["--sweep".to_owned(), path("table.csv"), "--report".to_owned(), path("r.json")]);
    args.extend(["--out".to_owned(), path("hair_{name}.usda")]);
    args.extend(more.iter().map(|word| (*word).to_owned()));
    let ran = run(&args);
    let names = folder.names();
    let hair = names
        .into_iter()
        .filter(|name| !["graph.ron", "table.csv", "r.json"].contains(&name.as_str()));
    (ran, json(&folder.path("r.json")), hair.collect())
}

fn node<'a>(report: &'a Json, name: &str) -> &'a Json {
    let nodes = report["nodes"].as_array().expect("nodes");
    nodes.iter().find(|node| node["name"] == name).expect("the node")
}

#[test]
fn rows_of_a_sweep_are_what_each_is_alone_and_share_what_is_the_same() {
    let table =
        "name,guides.count,hair.count,seed\nfew,40,200,\nmany,40.0,300.0,\nother,40,3e2,7.0\n";
    let (ran, report, files) = sweep("sweep-rows", table, &[]);
    assert_eq!(ran.code, 0, "{}", ran.err);
    assert_eq!(files, ["hair_few.usda", "hair_many.usda", "hair_other.usda"]);
    let rows = report.as_array().expect("an object a row");
    let hashes: Vec<&Json> = rows.iter().map(|row| &row["outputs"][0]["hash"]).collect();
    for (row, more) in rows.iter().zip([
        &["hair.count=200", "0"],
        &["hair.count=300", "0"],
        &["hair.count=300", "7"],
    ]) {
        let folder = Folder::new("sweep-alone");
        std::fs::write(folder.path("graph.ron"), GRAPH).unwrap();
        let graph = text(&folder.path("graph.ron"));
        let alone = coif_tests::eval(&graph, &["--set", more[0], "--seed", more[1]]);
        assert_eq!(row["outputs"][0]["hash"], alone["outputs"][0]["hash"], "{more:?}");
    }
    assert!(hashes[0] != hashes[1] && hashes[1] != hashes[2], "{hashes:?}");
    assert_eq!(node(&rows[0], "guides")["cached"], false);
    assert_eq!(node(&rows[1], "guides")["cached"], true, "the guides are those of the row before");
    assert_eq!(node(&rows[1], "hair")["cached"], false);
    assert_eq!(node(&rows[2], "guides")["cached"], false, "another seed");
    assert_eq!(rows[1]["row"], "many");
}

#[test]
fn a_row_that_fails_stops_no_other_and_leaves_nothing() {
    let table = "guides.count,hair.count\n40,200\n40,many\n0,\n,\"300\"\n";
    let (ran, report, files) = sweep("sweep-fails", table, &[]);
    assert_eq!(ran.code, 1, "{}", ran.err);
    assert_eq!(files, ["hair_1.usda", "hair_4.usda"]);
    assert!(ran.err.contains("2: --set hair.count=many: "), "{}", ran.err);
    let exits: Vec<&Json> = report.as_array().unwrap().iter().map(|row| &row["exit"]).collect();
    assert_eq!(exits, [0, 2, 1, 0]);
    assert_eq!(report[2]["errors"].as_array().unwrap().len(), 1);
}

#[test]
fn a_table_that_is_wrong_is_refused_before_anything_runs() {
    let long = "guides.count\n".to_owned() + &"1\n".repeat(100_001);
    for (table, said) in [
        ("", "no rows"),
        ("guides.count\n", "no rows"),
        ("guides.cuont\n1\n", "cuont"),
        ("length\n1\n", "no parameters"),
        (
            "hair.count,guides.count,hair.count\n1,2,3\n",
            "columns 1 and 3 are both called \"hair.count\"",
        ),
        (
            "name,guides.count\na,1\nA,2\n",
            "line 3: \"A\" is the name of the row of line 2, \"a\", too",
        ),
        ("name,guides.count\n../a,1\n", "no name"),
        ("guides.count,hair.count\n1\n", "1 field"),
        ("guides.count,guides.count\n1,2\n", "columns 1 and 2 are both called \"guides.count\""),
        ("seed\n-1\n", "whole number"),
        (&long, "more than 100000 rows"),
    ] {
        let (ran, report, files) = sweep("sweep-table", table, &[]);
        let short: String = table.chars().take(60).collect();
        assert_eq!(ran.code, 2, "{short:?}: {}", ran.err);
        assert!(ran.err.contains(said), "{short:?}: {}", ran.err);
        assert!(!report[0]["errors"].as_array().unwrap().is_empty(), "{short:?}");
        assert!(files.is_empty(), "{short:?}");
    }
    let table = "guides.count\n20\n30\n";
    let (ran, ..) = sweep("sweep-one-file", table, &["--out", "hair.usda"]);
    assert!(ran.code == 2 && ran.err.contains("{name}"), "{}", ran.err);
}

#[test]
fn one_row_of_a_sweep_is_an_evaluation_like_any_other() {
    let table = "name,hair.count\nfew,200\nmany,300\n";
    let (ran, report, files) = sweep("sweep-row", table, &["--row", "many"]);
    assert_eq!(ran.code, 0, "{}", ran.err);
    assert_eq!(files, ["hair_many.usda"]);
    assert_eq!(report["set"], serde_json::json!(["hair.count=300"]));
    assert_eq!(report["row"], "many");
    let (ran, report, files) = sweep("sweep-no-row", table, &["--row", "none"]);
    assert!(report["exit"] == 2 && files.is_empty(), "{report}");
    assert!(ran.code == 2 && ran.err.contains("few, many"), "{}", ran.err);
}

/// Runs a job with the farm's own program.
fn openjd(test: &str, words: &[&str]) -> Option<Ran> {
    let program = coif_tests::repository().join("target/venv/bin/openjd");
    if !program.exists() {
        println!("skipped: {test} needs openjd-cli in target/venv (tests/run.sh installs it)");
        return None;
    }
    Some(coif_tests::run_with(std::process::Command::new(program), words))
}

#[test]
fn a_job_of_three_tasks_loses_one_and_a_second_run_makes_that_one() {
    let test = "a_job_of_three_tasks_loses_one_and_a_second_run_makes_that_one";
    let folder = Folder::new("batch");
    let path = |name: &str| text(&folder.path(name));
    std::fs::write(path("graph.ron"), GRAPH).unwrap();
    std::fs::create_dir(path("hair")).unwrap();
    let mesh = coif_tests::shared(test, "data/lps_head/LeePerrySmith.glb");
    let Some(mesh) = mesh else { return };
    for n in 1..=3 {
        std::fs::copy(&mesh, path(&format!("head{n}.glb"))).unwrap();
    }
    let heads: Vec<String> = (1..=3).map(|n| path(&format!("head{n}.glb"))).collect();
    let (graph, job, hair) = (path("graph.ron"), path("job.yaml"), path("hair"));
    let mut words = vec!["batch", &graph, "--out-dir", &hair, "-o", &job, "--seed", "3", "--head"];
    words.extend(heads.iter().map(String::as_str));
    let ran = run(&words);
    assert_eq!(ran.code, 0, "{}", ran.err);
    assert!(ran.err.contains("3 tasks"), "{}", ran.err);
    // The last task's head goes: openjd stops at the first that fails.
    std::fs::remove_file(&heads[2]).unwrap();
    let program = text(Path::new(coif_tests::coif().get_program()));
    let program = format!("Coif={program}");
    let go = || openjd(test, &["run", &job, "--step", "grooms", "-p", &program]);
    let Some(first) = go() else { return };
    assert_ne!(first.code, 0, "{}", first.out);
    let count = |ending: &str| {
        let names = std::fs::read_dir(&hair).unwrap().flatten();
        names.filter(|f| text(&f.path()).ends_with(ending)).count()
    };
    assert_eq!((count(".usdc"), count(".json")), (2, 3), "{}", first.out);
    let table = || run(["batch", "--collect", &hair]);
    let rows = table().out;
    assert_eq!(rows.matches(",done,").count(), 2, "{rows}");
    assert!(rows.contains(",refused,") && rows.contains("no such file"), "{rows}");
    std::fs::copy(&mesh, &heads[2]).unwrap();
    let second = go().expect("it was there");
    assert_eq!(second.code, 0, "{}", second.out);
    assert_eq!(second.out.matches("is done already").count(), 2, "{}", second.out);
    assert_eq!(count(".usdc"), 3);
    let rows = table().out;
    assert_eq!(rows.matches(",done,").count(), 3, "{rows}");
    // One head, one hash: where a task ran makes no difference.
    let hashes: std::collections::BTreeSet<&str> =
        rows.lines().skip(1).filter_map(|row| row.split(',').nth(6)).collect();
    assert_eq!(hashes.len(), 1, "{rows}");
}

#[test]
fn a_table_of_reports_holds_no_formulas_and_no_minus_zero() {
    let folder = Folder::new("batch-formulas");
    let report = serde_json::json!({
        "exit": 1, "graph": "=cmd|' /C calc'!A1", "scalp": ["@a.obj"], "seed": 1, "row": "+1",
        "outputs": [], "nodes": [{"name": "-hair", "ms": 1.0}], "total_ms": -0.0,
        "errors": ["\tA1, \"quoted\""],
    });
    std::fs::write(folder.path("-1.json"), report.to_string()).unwrap();
    let bald = serde_json::json!({"exit": 2, "graph": "a=b.ron", "seed": 1, "errors": ["\rA1"]});
    std::fs::write(folder.path("b.json"), bald.to_string()).unwrap();
    let ran = run(["batch", "--collect", &text(&folder.path(""))]);
    assert_eq!(ran.code, 0, "{}", ran.err);
    let first = "'-1,'=cmd|' /C calc'!A1,'@a.obj,1,'+1,failed,,0,0,0.00,0.0,'-hair,\"'\tA1, \"\"quoted\"\"\"";
    // What holds such a letter elsewhere is as it was.
    let second = "b,a=b.ron,,1,,refused,,0,0,0.00,0.0,,\"'\rA1\"";
    let rows: Vec<&str> = ran.out.trim_end().split('\n').skip(1).collect();
    assert_eq!(rows, [first, second]);
}

#[test]
fn results_of_a_job_have_names_that_no_other_has() {
    let folder = Folder::new("batch-names");
    let path = |name: &str| text(&folder.path(name));
    let job = path("job.yaml");
    for name in ["a.ron", "a.b.ron", "A.B.ron"] {
        std::fs::write(path(name), GRAPH).unwrap();
    }
    for name in ["b.c.obj", "c.obj"] {
        std::fs::write(path(name), "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").unwrap();
    }
    let graphs = ["a.ron", "a.b.ron", "A.B.ron"].map(path);
    let words = ["batch", &graphs[0], &graphs[1], &graphs[2], "-o", &job];
    let more = [path("b.c.obj"), path("c.obj"), path("hair")];
    let ran = run([&words[..], &["--head", &more[0], &more[1], "--out-dir", &more[2]]].concat());
    assert_eq!(ran.code, 0, "{}", ran.err);
    let yaml = std::fs::read_to_string(&job).unwrap();
    for label in ["\"a\"", "\"a_b\"", "\"A_B-2\"", "\"b_c\"", "\"c\""] {
        assert!(yaml.contains(&format!("- {label}\n")), "{label}: {yaml}");
    }
    let (beside, twice) = (path("hair"), path("b.c.obj"));
    for (more, said) in [
        (&["--out-dir", "/"][..], "is not below"),
        (&["--out-dir", &beside, "--head", &twice, &twice], "is there twice"),
        (&["--out-dir", &beside, "--sweep", "none.csv"], "no such file"),
    ] {
        let ran = run([&words[..], more].concat());
        assert!(ran.code == 2 && ran.err.contains(said), "{more:?}: {}", ran.err);
    }
    assert_eq!(std::fs::read_to_string(&job).unwrap(), yaml, "what was there is there");
}

/// Evaluates the graph with a budget over hair that is there: what was said, the report, and that the hair is as it was on failure.
#[track_caller]
fn budgeted(test: &str, budget: &str, more: &[&str], code: i32) -> (Ran, Json) {
    let folder = Folder::new(test);
    let graph = GRAPH.replace("seed: 0,", &format!("seed: 0, budget: ({budget}),"));
    std::fs::write(folder.path("graph.ron"), graph).unwrap();
    std::fs::write(folder.path("hair.usda"), "what was there").unwrap();
    let path = |name: &str| text(&folder.path(name));
    let words = ["graph.ron", "hair.usda", "r.json"].map(path);
    let args = ["eval", &words[0], "--out", &words[1], "--report", &words[2]];
    let ran = run([&args[..], more].concat());
    assert_eq!(ran.code, code, "{budget}: {}", ran.err);
    let kept = std::fs::read_to_string(folder.path("hair.usda")).unwrap() == "what was there";
    assert_eq!(kept, code != 0, "{budget}");
    assert_eq!(folder.names(), ["graph.ron", "hair.usda", "r.json"]);
    (ran, json(&folder.path("r.json")))
}

#[test]
fn what_is_over_the_budget_writes_nothing_and_names_the_node_that_uses_most() {
    for (budget, said) in [
        ("seconds: 0.000001", "budget: seconds: at most 0.000001 s, and it takes "),
        ("points: 1000", "and the groom's budget of points is 1000"),
        ("mib: 0.125", "budget: mib: at most 0.125 MiB, and it takes "),
    ] {
        let (ran, report) = budgeted("budget-over", budget, &[], 1);
        assert!(ran.err.contains(said), "{}", ran.err);
        assert!(ran.err.contains("no hair was written"), "{}", ran.err);
        assert!(report["errors"][0].as_str().unwrap().contains("hair"), "{}", report["errors"][0]);
        let (ran, report) = budgeted("budget-not-held", budget, &["--no-budget"], 0);
        assert!(ran.err.contains("its budget is not held: budget: "), "{}", ran.err);
        assert_eq!(report["budget"][0]["over"], true);
    }
    let (_, held) = budgeted("budget-held", "seconds: 600, points: 1000000, mib: 900", &[], 0);
    let terms = held["budget"].as_array().unwrap().iter();
    assert!(terms.clone().all(|term| term["over"] == false), "{}", held["budget"]);
    let used = terms.map(|term| term["used"].as_f64().unwrap()).collect::<Vec<_>>();
    assert_eq!(used[1], held["nodes"][2]["points"].as_f64().unwrap());
    let bytes =
        held["nodes"].as_array().unwrap().iter().map(|node| node["bytes"].as_f64().unwrap());
    assert!((used[2] - bytes.sum::<f64>() / 1048576.0).abs() < 1e-3, "{}", used[2]);
    // The same hair as without, under the same hashes.
    let folder = Folder::new("budget-none");
    std::fs::write(folder.path("graph.ron"), GRAPH).unwrap();
    let plain = coif_tests::eval(&text(&folder.path("graph.ron")), &[]);
    assert_eq!(held["outputs"][0]["hash"], plain["outputs"][0]["hash"]);
    assert!(plain.get("budget").is_none());
}

#[test]
fn a_budget_that_is_none_is_refused_with_its_value() {
    for (budget, said) in [
        ("points: 0", "points: 0.0 is no limit"),
        ("mib: -4", "mib: -4.0 is no limit"),
        ("seconds: NaN", "seconds: NaN is no limit"),
        ("hours: 1", "`hours`"),
    ] {
        let (ran, _) = budgeted("budget-refused", budget, &[], 2);
        assert!(ran.err.contains(said) && ran.err.contains("graph.ron:"), "{}", ran.err);
    }
}

#[test]
fn the_ledger_is_the_report_as_a_table_for_each_row() {
    let folder = Folder::new("ledger");
    let path = |name: &str| text(&folder.path(name));
    std::fs::write(path("graph.ron"), GRAPH).unwrap();
    std::fs::write(path("table.csv"), "name,hair.count\nfew,200\nmany,300\n").unwrap();
    let words = ["graph.ron", "table.csv", "r.json"].map(path);
    let args = ["eval", &words[0], "--sweep", &words[1], "--report", &words[2], "--ledger"];
    let ran = run(args);
    assert_eq!(ran.code, 0, "{}", ran.err);
    let report = json(&folder.path("r.json"));
    let tables: Vec<&str> = ran.out.split("slowest first").collect();
    assert_eq!(tables.len(), 3, "{}", ran.out);
    for (table, row) in tables[1..].iter().zip(report.as_array().unwrap()) {
        let nodes = row["nodes"].as_array().unwrap();
        let line = |name: &str| table.lines().find(|line| line.starts_with(name)).unwrap();
        for node in nodes {
            let line = line(node["name"].as_str().unwrap());
            let number = |at: usize| line.split_whitespace().nth(at).unwrap().to_owned();
            assert_eq!(number(3), node["points"].to_string(), "{line}");
            assert_eq!(number(4), node["curves"].to_string(), "{line}");
            let mib = node["bytes"].as_f64().unwrap() / 1048576.0;
            assert_eq!(number(5), format!("{mib:.2}"), "{line}");
            assert_eq!(line.ends_with("all known"), node["cached"] == true, "{line}");
        }
        // What passes its curves on holds nothing.
        assert_eq!(node(row, "out")["bytes"], 0);
        assert!(node(row, "hair")["bytes"].as_u64().unwrap() > 20_000);
        assert!(line("all nodes").contains("100.0"));
    }
}
