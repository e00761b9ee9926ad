//! What whole-program tests share: the program itself, the heads they run on, and how they say that they cannot run.

use coif_shaders::{Gpu, Precision};
use serde_json::Value as Json;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
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

/// The heads that every shipped groom must sit on: a name, and its mesh.
pub const HEADS: &[(&str, &str)] = &[
    ("lps_head", "data/lps_head/LeePerrySmith.glb"),
    ("ict_head", "data/ict_head/generic_neutral_mesh.obj"),
    ("sintel", "data/sintel/sintel.obj"),
];

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

/// The `coif` program of the profile that this test was built in, built anew if need be.
pub fn coif() -> Command {
    static PATH: OnceLock<PathBuf> = OnceLock::new();
    let path = PATH.get_or_init(|| {
        // target/<profile>/deps/<test> -> target/<profile>/coif
        let exe = std::env::current_exe().expect("a test knows its own path");
        let profile = exe.ancestors().nth(2).expect("tests lie in target/<profile>/deps");
        let mut build = Command::new(env!("CARGO"));
        build.args(["build", "-q", "-p", "coif"]).current_dir(repository());
        if profile.ends_with("release") {
            build.arg("--release");
        }
        assert!(build.status().expect("cargo runs").success(), "coif builds");
        profile.join(format!("coif{}", std::env::consts::EXE_SUFFIX))
    });
    Command::new(path)
}

/// A fresh folder for one test, removed when it ends.
pub struct Folder(PathBuf);

impl Folder {
    /// An empty folder.
    pub fn new(test: &str) -> Self {
        let path = std::env::temp_dir().join(format!("coif-{test}-{}", std::process::id()));
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

/// Runs `coif` with arguments.
pub fn run<S: AsRef<std::ffi::OsStr>>(args: impl IntoIterator<Item = S>) -> Ran {
    let Output { status, stdout, stderr } = coif().args(args).output().expect("coif starts");
    Ran {
        code: status.code().unwrap_or(-1),
        out: String::from_utf8_lossy(&stdout).into_owned(),
        err: String::from_utf8_lossy(&stderr).into_owned(),
    }
}

/// Evaluates a graph and gives the report; it must end well.
#[track_caller]
pub fn eval(graph: &str, more: &[&str]) -> Json {
    let args = ["eval", graph, "--report", "-"].into_iter().chain(more.iter().copied());
    let ran = run(args);
    assert_eq!(ran.code, 0, "{graph} {more:?}: {}", ran.err);
    serde_json::from_str(&ran.out).unwrap_or_else(|err| panic!("{graph}: {err}\n{}", ran.out))
}
