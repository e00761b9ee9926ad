//! `coif batch`: a job for farms, and the reports of its tasks as one table.
//!
//! The job is an Open Job Description template (`jobtemplate-2023-09`): one step, whose tasks are every graph on every head with
//! every seed and row of a sweep. Each runs `coif eval` with files and a report of its own, under a name that no other has, and
//! does nothing where that is done. Farms schedule it; coif does not.
//!
//! Guarantees: what is written is read by any reader of YAML 1.2, for every text in it is quoted as JSON is; no task would be refused
//! before it ran ([`super::tasks`]). Not guaranteed: that tasks succeed.

use super::sweep::{Sweep, may_name_a_file};
use super::tasks::{on_head, refuse_doomed};
use super::{Exit, complain, shown, tell};
use crate::files::{Role, Together};
use crate::jobs::stop::Stop;
use clap::Args;
use coif_graphs::schedule::files::read_at_most;
use coif_graphs::schedule::run::CancelToken;
use serde_json::Value as Json;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

#[derive(Args)]
pub(crate) struct BatchArgs {
    /// Graphs: .ron files, or names of shipped grooms
    #[arg(required_unless_present = "collect", conflicts_with = "collect")]
    graph: Vec<PathBuf>,
    /// Head meshes, each in place of the graph's one head, or of the head NODE, the same in all; without any, the graph's own
    #[arg(long, value_name = "[NODE=]MESH", num_args = 1.., conflicts_with = "collect")]
    head: Vec<String>,
    /// Seeds; without any, the graph's own
    #[arg(long, value_name = "N", num_args = 1.., conflicts_with = "collect")]
    seed: Vec<u32>,
    /// Every row of a table, as of coif eval --sweep
    #[arg(long, value_name = "FILE.csv", conflicts_with = "collect")]
    sweep: Option<PathBuf>,
    /// Folder for hair and reports, in or below that of the job; a parameter of it, so it may be another when it is submitted. It
    /// has to be there then
    #[arg(
        long,
        value_name = "DIR",
        required_unless_present = "collect",
        conflicts_with = "collect"
    )]
    out_dir: Option<PathBuf>,
    /// Put the reports of a folder (.json) into one table (.csv) instead of writing a job. A cell that a spreadsheet would take for a
    /// formula begins with an apostrophe
    #[arg(long, value_name = "DIR")]
    collect: Option<PathBuf>,
    /// File to write: the job (.yaml), or the table; the table goes to stdout without
    #[arg(short, long, value_name = "FILE", required_unless_present = "collect")]
    out: Option<PathBuf>,
}

pub(crate) fn run(args: &BatchArgs) -> Exit {
    let ended = match &args.collect {
        Some(folder) => collect(folder, args.out.as_deref()),
        None => write_job(args),
    };
    ended.unwrap_or_else(|stop| {
        stop.lines().iter().for_each(complain);
        stop.exit()
    })
}

/// The most values of a parameter that the specification allows.
const MOST_VALUES: usize = 1024;

/// One parameter of tasks: its values, and what they are called in files' names.
struct Axis {
    name: &'static str,
    ty: &'static str,
    values: Vec<String>,
    labels: Vec<String>,
}

fn write_job(args: &BatchArgs) -> Result<Exit, Stop> {
    let (Some(out), Some(out_dir)) = (&args.out, &args.out_dir) else {
        return Err(Stop::refused("--out-dir and -o: a job needs both"));
    };
    let mut files = Together::default();
    let meshes: Vec<PathBuf> = args.head.iter().map(|head| on_head(head).into()).collect();
    if let Some((head, _)) =
        args.head.iter().zip(&meshes).find(|(_, mesh)| mesh.as_os_str().is_empty())
    {
        return Err(Stop::refused(format!(
            "--head {head:?}: expected a mesh, as FILE or NODE=FILE"
        )));
    }
    let reads = args.graph.iter().chain(&meshes).chain(&args.sweep);
    for path in reads {
        files
            .reads(path, format!("{}, which the job reads", shown(path)))
            .map_err(Stop::refused)?;
    }
    files.writes(out, Role::Output, format!("-o {}", shown(out))).map_err(Stop::refused)?;
    let table = args.sweep.as_deref().map(Sweep::read).transpose()?;
    let axes = axes(args, &meshes, table.as_ref())?;
    let node = node_of_heads(&args.head)?;
    refuse_doomed(&args.graph, &args.head, args.sweep.as_deref().zip(table.as_ref()))?;
    let sweep = args.sweep.as_deref().map(absolute).transpose()?;
    let text = template(&axes, node, &beside(out_dir, out)?, sweep.as_deref());
    files.allowed().map_err(Stop::failed)?;
    let cancel = CancelToken::default();
    files.write_text(out, &text, &cancel).map_err(|why| Stop::unwritten(out, &why, &cancel))?;
    files.place(&cancel).map_err(|(path, why)| Stop::unwritten(&path, &why, &cancel))?;
    let tasks: usize = axes.iter().map(|axis| axis.values.len()).product();
    tell(format_args!("{}: {tasks} tasks", shown(out)));
    Ok(Exit::Done)
}

/// The node whose mesh every `--head` replaces, if they name one.
fn node_of_heads(heads: &[String]) -> Result<Option<&str>, Stop> {
    let mut nodes = heads.iter().map(|head| {
        let (node, _) = head.split_once('=')?;
        (on_head(head) != *head).then_some(node)
    });
    let Some(first) = nodes.next() else { return Ok(None) };
    match nodes.all(|node| node == first) {
        true => Ok(first),
        false => Err(Stop::refused(
            "--head: the meshes are for several nodes; a job exchanges one head, so write the same NODE= before each",
        )),
    }
}

fn axes(args: &BatchArgs, meshes: &[PathBuf], sweep: Option<&Sweep>) -> Result<Vec<Axis>, Stop> {
    let of_files = |name, paths: &[PathBuf], shipped: bool| -> Result<Axis, Stop> {
        let values = paths.iter().map(|path| {
            let is_groom = shipped && !path.exists() && crate::jobs::open::is_shipped(path);
            if is_groom { Ok(path.display().to_string()) } else { absolute(path) }
        });
        Ok(Axis {
            name,
            ty: "PATH",
            values: values.collect::<Result<_, _>>()?,
            labels: labels(paths),
        })
    };
    let mut axes = vec![of_files("Graph", &args.graph, true)?];
    if !meshes.is_empty() {
        axes.push(of_files("Head", meshes, false)?);
    }
    if !args.seed.is_empty() {
        let values = args.seed.iter().map(ToString::to_string).collect();
        axes.push(Axis { name: "Seed", ty: "INT", values, labels: vec![] });
    }
    if let Some(sweep) = sweep {
        args.graph.iter().try_for_each(|graph| sweep.refuse_unknown_columns(graph, false))?;
        let values = sweep.names().map(ToOwned::to_owned).collect();
        axes.push(Axis { name: "Row", ty: "STRING", values, labels: vec![] });
    }
    for axis in &axes {
        let mut sorted = axis.values.clone();
        sorted.sort_unstable();
        if let Some(twice) = sorted.windows(2).find(|pair| pair[0] == pair[1]) {
            return Err(Stop::refused(format!("{}: is there twice", twice[0])));
        }
        if axis.values.len() > MOST_VALUES {
            return Err(Stop::refused(format!(
                "{}: {} values, and a job takes {MOST_VALUES} at most; make several jobs",
                axis.name.to_lowercase(),
                axis.values.len()
            )));
        }
    }
    Ok(axes)
}

/// Names of files without folders and endings, numbered where others have them too. Dots part what results are called by, so none
/// is within.
fn labels(paths: &[PathBuf]) -> Vec<String> {
    let stem = |path: &PathBuf| {
        let stem = path.file_stem().unwrap_or_default().to_string_lossy();
        let good = |c: char| if c != '.' && may_name_a_file(&format!("a{c}a")) { c } else { '_' };
        stem.chars().take(100).map(good).collect::<String>()
    };
    let mut labels: Vec<String> = vec![];
    for path in paths {
        let stem = stem(path);
        let is_free =
            |name: &String| !labels.iter().any(|had| had.to_lowercase() == name.to_lowercase());
        let numbered = (2..).map(|n| format!("{stem}-{n}"));
        let label = std::iter::once(stem.clone()).chain(numbered).find(is_free);
        labels.push(label.unwrap_or(stem));
    }
    labels
}

/// The job as YAML.
fn template(axes: &[Axis], node: Option<&str>, out_dir: &str, sweep: Option<&str>) -> String {
    let quoted = |text: &str| Json::from(text).to_string();
    let mut definitions = String::new();
    let mut add = |name: &str, ty: &str, values: &[String]| {
        definitions +=
            &format!("          - name: {name}\n            type: {ty}\n            range:\n");
        for value in values {
            let value = if ty == "INT" { value.clone() } else { quoted(value) };
            definitions += &format!("              - {value}\n");
        }
    };
    let (mut combined, mut name) = (vec![], vec![]);
    for axis in axes {
        add(axis.name, axis.ty, &axis.values);
        if axis.labels.is_empty() {
            combined.push(axis.name.to_owned());
            let letter = if axis.name == "Seed" { "s" } else { "" };
            name.push(format!("{letter}{{{{Task.Param.{}}}}}", axis.name));
        } else {
            let label = format!("{}Name", axis.name);
            add(&label, "STRING", &axis.labels);
            combined.push(format!("({}, {label})", axis.name));
            name.push(format!("{{{{Task.Param.{label}}}}}"));
        }
    }
    let file = format!("{{{{Param.OutDir}}}}/{}", name.join("."));
    let mut words = vec!["eval".to_owned(), "{{Task.Param.Graph}}".to_owned()];
    let mut word = |option: &str, value: &str| words.extend([option.to_owned(), value.to_owned()]);
    for axis in axes {
        match axis.name {
            "Head" => {
                let node = node.map_or(String::new(), |node| format!("{node}="));
                word("--scalp", &format!("{node}{{{{Task.Param.Head}}}}"));
            }
            "Seed" => word("--seed", "{{Task.Param.Seed}}"),
            "Row" => {
                word("--sweep", sweep.unwrap_or_default());
                word("--row", "{{Task.Param.Row}}");
            }
            _ => {}
        }
    }
    word("--out", &format!("{file}.{{{{Param.Format}}}}"));
    word("--report", &format!("{file}.json"));
    words.push("--skip-done".to_owned());
    let words: String =
        words.iter().map(|word| format!("            - {}\n", quoted(word))).collect();
    format!(
        "specificationVersion: jobtemplate-2023-09
name: coif
parameterDefinitions:
  - name: OutDir
    type: PATH
    objectType: DIRECTORY
    dataFlow: OUT
    description: Folder for hair and reports, which is there
    default: {}
  - name: Coif
    type: STRING
    description: The program
    default: coif
  - name: Format
    type: STRING
    description: How hair is written
    allowedValues: [usdc, usda, abc, hair]
    default: usdc
steps:
  - name: grooms
    parameterSpace:
        taskParameterDefinitions:
{definitions}        combination: {}
    script:
      actions:
        onRun:
          command: \"{{{{Param.Coif}}}}\"
          args:
{words}",
        quoted(out_dir),
        quoted(&combined.join(" * ")),
    )
}

/// A path as any machine of a farm may find it. What the specification would take for a name of its own is refused.
fn absolute(path: &Path) -> Result<String, Stop> {
    let full = std::path::absolute(path)
        .map_err(|err| Stop::refused(format!("{}: {err}", shown(path))))?;
    let text = full.to_str().filter(|text| !text.contains("{{"));
    text.map(ToOwned::to_owned).ok_or_else(|| {
        Stop::refused(format!("{}: a job has no such paths: UTF-8, without {{{{", shown(path)))
    })
}

/// A folder as the specification has it: relative to that of the job.
fn beside(folder: &Path, job: &Path) -> Result<String, Stop> {
    let (full, of_job) = (absolute(folder)?, absolute(job)?);
    let below = Path::new(&full).strip_prefix(Path::new(&of_job).parent().unwrap_or(Path::new("")));
    let below = below.map_err(|_| {
        Stop::refused(format!(
            "--out-dir {}: is not below the folder of the job {}, relative to which Open Job Description has its folders; write the \
             job beside it, and give another OutDir when it is submitted",
            shown(folder),
            shown(job)
        ))
    })?;
    Ok(below.to_str().filter(|below| !below.is_empty()).unwrap_or(".").to_owned())
}

/// Columns of the table of reports.
const COLUMNS: [&str; 13] = [
    "report",
    "graph",
    "head",
    "seed",
    "row",
    "outcome",
    "hash",
    "curves",
    "points",
    "seconds",
    "mib",
    "slowest",
    "first_error",
];

fn collect(folder: &Path, out: Option<&Path>) -> Result<Exit, Stop> {
    let fault = |err: std::io::Error| Stop::refused(format!("{}: {err}", shown(folder)));
    let mut reports = BTreeMap::new();
    for entry in std::fs::read_dir(folder).map_err(fault)? {
        let path = entry.map_err(fault)?.path();
        if path.extension().is_some_and(|ending| ending == "json") {
            let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
            reports.insert(name, path);
        }
    }
    if reports.is_empty() {
        return Err(Stop::refused(format!("{}: has no reports (.json)", shown(folder))));
    }
    let mut files = Together::default();
    for path in reports.values() {
        files.reads(path, format!("the report {}", shown(path))).map_err(Stop::refused)?;
    }
    if let Some(out) = out {
        files.writes(out, Role::Output, format!("-o {}", shown(out))).map_err(Stop::refused)?;
    }
    files.allowed().map_err(Stop::failed)?;
    let mut table = csv::Writer::from_writer(vec![]);
    let failed = |err: csv::Error| Stop::failed(format!("the table: {err}"));
    table.write_record(COLUMNS).map_err(failed)?;
    let mut exit = Exit::Done;
    for (name, path) in &reports {
        match row(name, path) {
            Ok(row) => table.write_record(row).map_err(failed)?,
            Err(why) => {
                complain(format_args!("{}: {why}; it is left out", shown(path)));
                exit = Exit::Failed;
            }
        }
    }
    let text = table.into_inner().map(|bytes| String::from_utf8_lossy(&bytes).into_owned());
    let text = text.map_err(|err| Stop::failed(format!("the table: {err}")))?;
    let cancel = CancelToken::default();
    let written = match out {
        Some(path) => files.write_text(path, &text, &cancel),
        None => files.print(&text),
    };
    let name = out.unwrap_or(Path::new("standard output"));
    written.map_err(|why| Stop::unwritten(name, &why, &cancel))?;
    files.place(&cancel).map_err(|(path, why)| Stop::unwritten(&path, &why, &cancel))?;
    Ok(exit)
}

/// The largest report that is read, bytes.
const MOST_REPORT: u64 = 256 << 20;

/// One report as a row of the table.
fn row(name: &str, path: &Path) -> Result<[String; COLUMNS.len()], String> {
    let text = read_at_most(path, MOST_REPORT)?;
    let report: Json = serde_json::from_slice(&text).map_err(|err| err.to_string())?;
    let exit = report["exit"].as_u64().ok_or("is no report of one evaluation")?;
    let text = |value: &Json| value.as_str().unwrap_or_default().to_owned();
    let outputs = report["outputs"].as_array().map(Vec::as_slice).unwrap_or_default();
    let sum =
        |field: &str| outputs.iter().filter_map(|o| o[field].as_u64()).sum::<u64>().to_string();
    let all = |list: &[Json]| list.iter().map(text).collect::<Vec<_>>().join(" ");
    // The ledger of the task in two numbers.
    let nodes = report["nodes"].as_array().map(Vec::as_slice).unwrap_or_default();
    let bytes: f64 = nodes.iter().filter_map(|node| node["bytes"].as_f64()).sum();
    let mib = format!("{:.1}", unsigned(bytes) / f64::from(1 << 20));
    let ms = |node: &&Json| node["ms"].as_f64().unwrap_or_default();
    let slowest = nodes.iter().max_by(|a, b| ms(a).total_cmp(&ms(b)));
    let outcome = match exit {
        0 => "done",
        1 => "failed",
        2 => "refused",
        _ => "interrupted",
    };
    Ok([
        name.to_owned(),
        text(&report["graph"]),
        all(report["scalp"].as_array().map(Vec::as_slice).unwrap_or_default()),
        report["seed"].to_string(),
        text(&report["row"]),
        outcome.to_owned(),
        outputs.iter().map(|o| text(&o["hash"])).collect::<Vec<_>>().join(" "),
        sum("curves"),
        sum("points"),
        format!("{:.2}", unsigned(report["total_ms"].as_f64().unwrap_or_default()) / 1e3),
        mib,
        slowest.map_or(String::new(), |node| text(&node["name"])),
        text(&report["errors"][0]),
    ]
    .map(harmless))
}

/// A number that is not negative: the sum of no floats is -0.
fn unsigned(x: f64) -> f64 {
    x.max(0.0) + 0.0
}

/// A cell that no spreadsheet takes for a formula: reports hold names that anybody may have given, and one that begins with `=` runs
/// where the table is opened. An apostrophe before it makes it text.
fn harmless(cell: String) -> String {
    const BEGINS: &[char] = &['=', '+', '-', '@', '\t', '\r', '\n', '＝', '＋', '－', '＠'];
    if cell.starts_with(BEGINS) { format!("'{cell}") } else { cell }
}
