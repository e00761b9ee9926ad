//! Grooms and recipes as the tests of this program look at them: each is evaluated once on each head that it is asked for on, to files
//! that all tests share. `coif measure` judges them by the file alone.

use super::pages::primvars;
use coif_graphs::grooms;
use coif_tests::long::is_long;
use coif_tests::{Folder, RealHead, eval, repository, run};
use serde_json::Value as Json;
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;
use std::sync::{Mutex, OnceLock, PoisonError};

/// A groom that was evaluated to files.
pub(crate) struct Shipped {
    /// What `coif eval` reported.
    pub(crate) report: Json,
    /// What was written: `usdc`, and before it `usda` on the built-in head of what is [`AS_TEXT`].
    pub(crate) files: Vec<String>,
    /// Whether only a tenth of its hair was made.
    pub(crate) is_tenth: bool,
    /// What `coif measure` takes for its head.
    scalp: String,
    measured: OnceLock<Vec<Json>>,
    _folder: Folder,
}

impl Shipped {
    /// Its `usdc` file.
    pub(crate) fn file(&self) -> &Path {
        Path::new(&self.files[self.files.len() - 1])
    }
    /// What was measured, a prim each.
    pub(crate) fn prims(&self) -> &[Json] {
        self.measured.get_or_init(|| {
            let file = self.file().display().to_string();
            let ran = run(["measure", &file, "--json", "--scalp", &self.scalp]);
            assert_eq!(ran.code, 0, "{file}: {}", ran.err);
            serde_json::from_str(&ran.out).unwrap_or_else(|err| panic!("{file}: {err}"))
        })
    }
    /// The prims that renderers draw.
    pub(crate) fn hair(&self) -> Vec<Json> {
        self.prims().iter().filter(|prim| prim["purpose"] != "guide").cloned().collect()
    }
    /// Name, type and interpolation of all primvars of its file.
    pub(crate) fn primvars(&self) -> BTreeSet<(String, String, String)> {
        primvars(self.file())
    }
}

/// Whether all hair is judged, which takes minutes: `tests/run.sh --long`.
pub(crate) fn all_hair() -> bool {
    is_long()
}

/// A groom on the built-in head, with a tenth of its hair where not [`all_hair`] is judged.
pub(crate) fn shipped(name: &str) -> &'static Shipped {
    made(name, None, !all_hair())
}

/// A tenth of the hair of a groom or a [`recipe`].
pub(crate) fn tenth(name: &str, head: Option<&RealHead>) -> &'static Shipped {
    made(name, head, true)
}

/// The file of a recipe, which stands for its name.
pub(crate) fn recipe(name: &str) -> String {
    repository().join(format!("graphs/templates/{name}.ron")).display().to_string()
}

/// Evaluated by whoever asks first; the files stay until the next run.
fn made(name: &str, head: Option<&RealHead>, is_tenth: bool) -> &'static Shipped {
    static ALL: Mutex<BTreeMap<String, &'static OnceLock<Shipped>>> = Mutex::new(BTreeMap::new());
    let kind = if name.ends_with(".ron") { "recipe" } else { "groom" };
    let stem = Path::new(name).file_stem().unwrap_or_default().display();
    let on = head.map_or("builtin", |head| head.name);
    let key = format!("{kind}-{stem}-{on}-{}", if is_tenth { "tenth" } else { "all" });
    let cell: &'static OnceLock<Shipped> = ALL
        .lock()
        .unwrap_or_else(PoisonError::into_inner)
        .entry(key.clone())
        .or_insert_with(|| Box::leak(Box::default()));
    let folder = || Folder::at(Path::new(env!("CARGO_TARGET_TMPDIR")).join("grooms").join(&key));
    cell.get_or_init(|| evaluate(name, head, is_tenth, folder()))
}

/// Grooms whose text is written too, with every kind of prim and attribute; of coils it would be 300 MB.
const AS_TEXT: [&str; 7] =
    ["start", "braids", "cornrows", "box_braids", "ponytail", "puffs", "sketch_mohawk"];

/// Evaluates a groom, by its name or its file, to files in a folder. Of shipped grooms in turn one on one thread and one on two, which
/// give the same hair.
#[track_caller]
pub(crate) fn evaluate(
    name: &str,
    head: Option<&RealHead>,
    is_tenth: bool,
    folder: Folder,
) -> Shipped {
    // Evaluations use both cores and, on a real head, a quarter of a gigabyte: one at a time.
    static TURN: Mutex<()> = Mutex::new(());
    let _turn = TURN.lock().unwrap_or_else(PoisonError::into_inner);
    let number = grooms::ALL.iter().position(|(known, _)| *known == name);
    let as_text = is_tenth && head.is_none() && AS_TEXT.contains(&name);
    let endings = if as_text { &["usda", "usdc"][..] } else { &["usdc"] };
    let file = |ending| folder.path(&format!("groom.{ending}")).display().to_string();
    let files: Vec<String> = endings.iter().map(file).collect();
    let threads = if number.is_some_and(|n| n % 2 == 0) { "1" } else { "2" };
    let mut args = vec!["--threads", threads];
    args.extend(files.iter().flat_map(|file| ["--out", file]));
    args.extend(head.map_or(vec![], RealHead::eval_args));
    args.extend(is_tenth.then_some(["--quality", "preview"]).into_iter().flatten());
    let report = eval(name, &args);
    let scalp = head.map_or("builtin", |head| &head.mesh).to_owned();
    Shipped { report, files, is_tenth, scalp, measured: OnceLock::new(), _folder: folder }
}
