//! What whole-program tests share: the program itself, the heads they run on, and how they say that they cannot run.

pub mod judge;
pub mod long;
pub mod screen;
#[cfg(unix)]
pub mod tablet;
pub mod waiting;

use coif_graphs::document::{Setting, Socket};
use coif_graphs::schedule::files::DiskFiles;
use coif_graphs::schedule::request::plan;
use coif_graphs::schedule::result::stands_for;
use coif_graphs::schedule::run::{CancelToken, Evaluator, OnFailure, Quiet};
use coif_graphs::{file, grooms, text};
use coif_nodes::data::curves::Curves;
use coif_nodes::data::scalp::Scalp;
use coif_nodes::define::Value;
use coif_nodes::eval::Quality;
use coif_nodes::formats::usd::read::{ReadCurves, read_stage};
use coif_shaders::{Gpu, Precision};
use long::is_long;
use serde_json::Value as Json;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output};
use std::sync::{Arc, OnceLock};

/// The repository.
pub fn repository() -> &'static Path {
    Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/.."))
}

/// A file of the data that stands beside the project; none in a clone without it. The caller returns then, having
/// named itself.
pub fn shared(test: &str, path: &str) -> Option<PathBuf> {
    let full = repository().join("../shared").join(path);
    if full.exists() {
        return Some(full.canonicalize().unwrap_or(full));
    }
    println!("skipped: {test} needs ../shared/{path}");
    None
}

/// The heads that grooms must sit on, heroes on all of them, the others on all but [`SCAN`]: a name and its mesh.
pub const HEADS: &[(&str, &str)] = &[
    ("lps_head", "data/lps_head/LeePerrySmith.glb"),
    ("ict_head", "data/ict_head/generic_neutral_mesh.obj"),
    ("sintel", "data/sintel/sintel.obj"),
    (SCAN, "data/snowden_scan/snowden.obj"),
];

/// The scan of a bust, whose hair is a rough surface of folds and whose face is turned.
pub const SCAN: &str = "snowden_scan";

/// A head of [`HEADS`] that is on this machine.
pub struct RealHead {
    /// What it is called.
    pub name: &'static str,
    /// Its mesh.
    pub mesh: String,
}

impl RealHead {
    /// Arguments of `coif eval` that put a groom on it.
    pub fn eval_args(&self) -> Vec<&str> {
        vec!["--scalp", &self.mesh]
    }
}

/// The real heads at hand; a test that misses one has named itself.
pub fn real_heads(test: &str) -> impl Iterator<Item = RealHead> {
    HEADS.iter().filter_map(move |(name, path)| {
        let mesh = shared(&format!("{test}:{name}"), path)?.display().to_string();
        Some(RealHead { name, mesh })
    })
}

/// The same without the scan, whose skin is as rough as what it was scanned from.
pub fn smooth_heads(test: &str) -> impl Iterator<Item = RealHead> {
    real_heads(test).filter(|head| head.name != SCAN)
}

/// One of these heads, another for each number in turn, so that many grooms together meet all of them; all where `COIF_LONG` is set
/// (`tests/run.sh --long`).
pub fn one_of<T>(heads: &[T], number: usize) -> impl Iterator<Item = &T> {
    let all = heads.len();
    let some = if is_long() { all } else { all.min(1) };
    (0..some).map(move |k| &heads[(number + k) % all])
}

/// What to evaluate a shipped groom with where the number of its strands does not matter: every tenth of a hero's.
pub fn lean(groom: &str) -> &'static [&'static str] {
    if grooms::HEROES.contains(&groom) { &["--quality", "preview"] } else { &[] }
}

/// The Python with usd-core that `tests/run.sh` sets up; none when it could not.
pub fn usd_python(test: &str) -> Option<PathBuf> {
    let python = repository().join("target/venv/bin/python");
    if python.exists() {
        return Some(python);
    }
    println!("skipped: {test} needs usd-core in target/venv (tests/run.sh installs it)");
    None
}

/// The one device that a test program draws on; none where there is no adapter. The caller returns then, having named
/// itself.
pub fn gpu(test: &str) -> Option<Arc<Gpu>> {
    static GPU: OnceLock<Option<Arc<Gpu>>> = OnceLock::new();
    let gpu = GPU.get_or_init(|| Gpu::new(Precision::Best).ok().map(Arc::new));
    if gpu.is_none() {
        println!("skipped: {test} needs a graphics adapter (libvulkan1 mesa-vulkan-drivers)");
    }
    gpu.clone()
}

/// Whether there is an adapter to draw on. The caller returns where there is none, having named itself.
pub fn adapter(test: &str) -> bool {
    gpu(test).is_some()
}

/// A shipped groom with other values, evaluated in this process: the curves of its outputs together, those of further
/// `sockets` in turn, and its head.
///
/// # Panics
/// When an edit names nothing or the evaluation fails.
pub fn groom(name: &str, edits: &[(&str, &str)], sockets: &[&str]) -> Groom {
    groom_made(name, edits, sockets, Quality::Final)
}

/// [`groom`] of any quality.
///
/// # Panics
/// When an edit names nothing or the evaluation fails.
pub fn groom_made(name: &str, edits: &[(&str, &str)], sockets: &[&str], quality: Quality) -> Groom {
    let text = grooms::by_name(name).expect("a shipped groom");
    let mut document = file::read(text).expect("shipped grooms are valid").document;
    for (socket, text) in edits {
        let socket: Socket = socket.parse().expect("NODE.INPUT");
        let node = document.nodes.get_mut(&socket.node).expect("a node");
        let def = coif_nodes::by_id(&node.kind).expect("a kind");
        let (_, input) = def.input(&socket.name).expect("an input");
        let value = text::parse_value(input.ty, text).expect("a value");
        Arc::make_mut(node).inputs.insert(input.name.to_owned(), Setting::Known(value));
    }
    let of = |kind: &str, output: &str| -> Vec<Socket> {
        let nodes = document.nodes.iter().filter(|(_, node)| node.kind == kind);
        nodes.map(|(id, _)| Socket::new(id.clone(), output)).collect()
    };
    let mut targets = of("groom_output", "curves");
    let outputs = targets.len();
    targets.extend(sockets.iter().map(|text| text.parse::<Socket>().expect("NODE.OUTPUT")));
    targets.extend(of("head", "scalp"));
    let plan = plan(&document, &targets, quality, &DiskFiles::default()).expect("a plan");
    let evaluator = Evaluator::new(2, 0).expect("threads");
    let outcome = evaluator.run(&plan, OnFailure::Stop, &CancelToken::default(), &Quiet);
    let stands_for = stands_for(&outcome.nodes);
    let mut curves = outcome.targets.into_iter().map(|value| match value {
        Some(Value::Curves(curves)) => Ok(curves),
        Some(Value::Scalp(scalp)) => Err(scalp),
        other => panic!("{name}: {other:?}"),
    });
    let hair = curves.by_ref().take(outputs).flatten().flat_map(|c| c.tufts().to_vec()).collect();
    let more = curves.by_ref().take(sockets.len()).flatten().collect();
    let scalp = curves.next().and_then(Result::err).expect("a head");
    Groom { hair: Curves::new(hair), stands_for, more, scalp }
}

/// A groom in memory.
pub struct Groom {
    /// All its hair.
    pub hair: Curves,
    /// How many strands of the final hair each stands for: 1 where all was made.
    pub stands_for: f32,
    /// Other curves that were asked for.
    pub more: Vec<Curves>,
    /// Its head.
    pub scalp: Arc<Scalp>,
}

/// The `coif` program with window and pictures, of the profile that this test was built in, built anew if need be.
pub fn program() -> Command {
    static PATH: OnceLock<PathBuf> = OnceLock::new();
    let path = PATH.get_or_init(|| {
        // target/<profile>/deps/<test> -> target/<profile>/coif
        let exe = std::env::current_exe().expect("a test knows its own path");
        let profile = exe.ancestors().nth(2).expect("tests lie in target/<profile>/deps");
        let mut build = Command::new(env!("CARGO"));
        build.args(["build", "-q", "-p", "coif"]).current_dir(repository());
        // Set for the tests, to be told how long they take; for the compiler it would make all of it out of date.
        build.env_remove("RUSTC_BOOTSTRAP");
        if profile.ends_with("release") {
            build.arg("--release");
        }
        assert!(build.status().expect("cargo runs").success(), "coif builds");
        profile.join(format!("coif{}", std::env::consts::EXE_SUFFIX))
    });
    Command::new(path)
}

/// The program for what needs neither window nor pictures: the one that `COIF_PROGRAM` names (`tests/run.sh --long` names the
/// release build for farms), or [`program`].
pub fn coif() -> Command {
    std::env::var_os("COIF_PROGRAM").map_or_else(program, Command::new)
}

/// A fresh folder for one test, removed when it ends.
pub struct Folder(PathBuf);

impl Folder {
    /// An empty folder.
    pub fn new(test: &str) -> Self {
        Self::at(std::env::temp_dir().join(format!("coif-{test}-{}", std::process::id())))
    }
    /// An empty folder at this path, without what was there.
    pub fn at(path: PathBuf) -> Self {
        let _ = std::fs::remove_dir_all(&path);
        std::fs::create_dir_all(&path).expect("a temporary folder");
        Self(path)
    }
    /// A path in it.
    pub fn path(&self, name: &str) -> PathBuf {
        self.0.join(name)
    }
    /// Names of all that is in it, sorted.
    pub fn names(&self) -> Vec<String> {
        let entries = std::fs::read_dir(&self.0).expect("the folder is there");
        let mut names: Vec<String> =
            entries.flatten().map(|e| e.file_name().to_string_lossy().into_owned()).collect();
        names.sort();
        names
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

/// What a run of `coif` said.
pub struct Ran {
    /// Exit code.
    pub code: i32,
    /// What it wrote to stdout.
    pub out: String,
    /// What it wrote to stderr.
    pub err: String,
}

/// Runs [`coif()`] with arguments.
pub fn run<S: AsRef<std::ffi::OsStr>>(args: impl IntoIterator<Item = S>) -> Ran {
    run_with(coif(), args)
}

/// Runs a program with arguments.
pub fn run_with<S: AsRef<std::ffi::OsStr>>(
    mut program: Command,
    args: impl IntoIterator<Item = S>,
) -> Ran {
    let Output { status, stdout, stderr } = program.args(args).output().expect("coif starts");
    Ran {
        code: status.code().unwrap_or(-1),
        out: String::from_utf8_lossy(&stdout).into_owned(),
        err: String::from_utf8_lossy(&stderr).into_owned(),
    }
}

/// Waits until a program that was started would hear whoever asks it to end, which Linux tells: it has a handler for Ctrl-C, or is
/// at its end. Elsewhere a moment must do.
///
/// # Panics
/// When it never would.
pub fn until_it_hears(program: &mut Child) {
    /// Bit of SIGINT in the mask of signals that are caught.
    const INTERRUPT: u64 = 1 << 1;
    let status = format!("/proc/{}/status", program.id());
    let hears = || {
        let text = std::fs::read_to_string(&status).unwrap_or_default();
        let caught = text.lines().find_map(|line| line.strip_prefix("SigCgt:"));
        let caught = caught.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok());
        caught.is_some_and(|caught| caught & INTERRUPT != 0)
    };
    if !Path::new(&status).exists() {
        std::thread::sleep(std::time::Duration::from_millis(700));
        return;
    }
    waiting::until("it hears Ctrl-C", || hears() || matches!(program.try_wait(), Ok(Some(_))));
}

/// The curves of a written USD file, in which nothing may be amiss.
///
/// # Panics
/// When it is not read, or something in it is left out.
pub fn curves_in(file: &Path) -> Vec<ReadCurves> {
    let bytes = std::fs::read(file).expect("it was written");
    let name = file.file_name().expect("a file").to_string_lossy();
    let nothing = &mut |_: &str| Err("there is nothing beside it".to_owned());
    let read = read_stage(&bytes, &name, nothing).expect("it is read");
    assert_eq!(read.left_out, []);
    read.curves
}

/// Evaluates a graph and gives the report; it must end well.
#[track_caller]
pub fn eval(graph: &str, more: &[&str]) -> Json {
    let args = ["eval", graph, "--report", "-"].into_iter().chain(more.iter().copied());
    let ran = run(args);
    assert_eq!(ran.code, 0, "{graph} {more:?}: {}", ran.err);
    serde_json::from_str(&ran.out).unwrap_or_else(|err| panic!("{graph}: {err}\n{}", ran.out))
}
