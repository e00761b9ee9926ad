//! Each shipped groom, evaluated once a head: its report, and what `coif measure` finds in the written file alone. And a tenth of its
//! hair, for what any hair tells.

use super::pages::primvars;
use coif_graphs::grooms;
use coif_tests::{Folder, RealHead, eval, run};
use serde_json::Value as Json;
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;
use std::sync::{Mutex, OnceLock};

/// A groom that was evaluated and measured.
pub(crate) struct Shipped {
    /// What `coif eval` reported.
    pub(crate) report: Json,
    /// What was measured, a prim each.
    pub(crate) prims: Vec<Json>,
    /// Whether only a tenth of its hair was made.
    pub(crate) is_tenth: bool,
    /// Name, type and interpolation of all primvars of its file.
    pub(crate) primvars: BTreeSet<(String, String, String)>,
}

impl Shipped {
    /// The prims that renderers draw.
    pub(crate) fn hair(&self) -> Vec<Json> {
        self.prims.iter().filter(|prim| prim["purpose"] != "guide").cloned().collect()
    }
}

/// Whether all hair of heroes is judged, which takes minutes: `tests/run.sh --long`.
pub(crate) fn all_of_heroes() -> bool {
    std::env::var_os("COIF_LONG").is_some()
}

/// A groom on the built-in head with all its hair, or a tenth of it where it is a hero and not [`all_of_heroes`] is judged. Evaluated by
/// whoever asks first: of grooms in turn one on one thread and one on two, which give the same hair.
pub(crate) fn shipped(name: &'static str) -> &'static Shipped {
    static ALL: OnceLock<BTreeMap<&str, OnceLock<Shipped>>> = OnceLock::new();
    let all = || grooms::ALL.iter().map(|(name, _)| (*name, OnceLock::new())).collect();
    let number = grooms::ALL.iter().position(|(known, _)| *known == name);
    let threads = if number.is_some_and(|n| n % 2 == 0) { "1" } else { "2" };
    let tenth = grooms::HEROES.contains(&name) && !all_of_heroes();
    let quality = if tenth { "preview" } else { "final" };
    ALL.get_or_init(all)[name]
        .get_or_init(|| evaluate(name, None, &["--threads", threads, "--quality", quality]))
}

/// Heroes whose text is written too; of the others `usdc` alone, for a tenth of their hair is 20 MB of text each.
const AS_TEXT: [&str; 3] = ["afro_4c", "box_braids", "ponytail"];

/// A tenth of a groom's hair on the built-in head.
pub(crate) struct Tenth {
    /// What `coif eval` reported.
    pub(crate) report: Json,
    /// What was written: `usda` and `usdc`, or `usdc` alone.
    pub(crate) files: Vec<String>,
    _folder: Folder,
}

/// A tenth of a groom's hair, evaluated on two threads by whoever asks first.
pub(crate) fn tenth(name: &'static str) -> &'static Tenth {
    static ALL: OnceLock<BTreeMap<&str, OnceLock<Tenth>>> = OnceLock::new();
    let all = || grooms::ALL.iter().map(|(name, _)| (*name, OnceLock::new())).collect();
    ALL.get_or_init(all)[name].get_or_init(|| {
        let folder = Folder::new(&format!("tenth-{name}"));
        let both = !grooms::HEROES.contains(&name) || AS_TEXT.contains(&name);
        let endings = if both { &["usda", "usdc"][..] } else { &["usdc"] };
        let file = |ending| folder.path(&format!("{name}.{ending}")).display().to_string();
        let files: Vec<String> = endings.iter().map(file).collect();
        let out = files.iter().flat_map(|file| ["--out", file]);
        let args = ["--quality", "preview", "--threads", "2"].into_iter().chain(out);
        Tenth { report: eval(name, &args.collect::<Vec<_>>()), files, _folder: folder }
    })
}

/// Evaluates a groom, by its name or its file, to a file and measures that.
#[track_caller]
pub(crate) fn evaluate(name: &str, head: Option<&RealHead>, more: &[&str]) -> Shipped {
    // Evaluations use both cores and, on a real head, a quarter of a gigabyte: one at a time.
    static TURN: Mutex<u32> = Mutex::new(0);
    let mut turn = TURN.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
    *turn += 1;
    let stem = Path::new(name).file_stem().unwrap_or_default().display();
    let folder = Folder::new(&format!("groom-{stem}-{turn}"));
    let out = folder.path("groom.usdc").display().to_string();
    let on = head.map_or(vec![], RealHead::eval_args);
    let report = eval(name, &[&["--out", &out], &on[..], more].concat());
    let mesh = head.map_or("builtin", |head| head.mesh.as_str());
    let ran = run(["measure", &out, "--json", "--scalp", mesh]);
    assert_eq!(ran.code, 0, "{name}: {}", ran.err);
    let prims = serde_json::from_str(&ran.out).unwrap_or_else(|err| panic!("{name}: {err}"));
    let primvars = primvars(folder.path("groom.usdc").as_path());
    Shipped { report, prims, is_tenth: more.contains(&"preview"), primvars }
}
