//! Judges grooms by geometry that is not coif's: how deep their drawn curves dive under the skin of a head, and where.
//!
//! `cargo run -p coif-tests --example judge -- [GROOM|TEMPLATE|FILE.ron]... [--all] [--head builtin|NAME|FILE]... [--share 0.1]
//! [--tolerance 0.01] [--threads 2]`: `--all` stands for every groom and every recipe (`NAME.recipe` is the template of that name),
//! `--head all` for the built-in head and those of `HEADS` that are at hand. Without hair it says how it is used. Exit code 1: something
//! is too deep, off the skin or not made.

use coif_graphs::grooms;
use coif_graphs::schedule::run::Evaluator;
use coif_nodes::eval::Quality;
use coif_tests::judge::{Judge, Made, Place, make, region};
use coif_tests::{HEADS, SCAN, shared};
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Instant;

/// What is asked for.
struct Asked {
    hair: Vec<String>,
    heads: Vec<String>,
    share: f64,
    judge: Judge,
}

fn main() -> ExitCode {
    // `cargo test --examples` only asks whether it starts.
    let words: Vec<String> = std::env::args().skip(1).collect();
    match asked(&words) {
        Ok(asked) if !asked.hair.is_empty() => judge(&asked),
        Ok(_) => {
            println!(
                "judge [GROOM|NAME.recipe|FILE.ron]... [--all] [--head builtin|NAME|FILE|all]... [--share 0.1] [--tolerance 0.01] \
                 [--threads 2]"
            );
            ExitCode::SUCCESS
        }
        Err(fault) => {
            eprintln!("{fault}");
            ExitCode::from(2)
        }
    }
}

fn asked(words: &[String]) -> Result<Asked, String> {
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    let judge = Judge { threads, ..Judge::default() };
    let mut asked = Asked { hair: vec![], heads: vec![], share: 1.0, judge };
    let mut words = words.iter();
    while let Some(word) = words.next() {
        let mut value = || words.next().ok_or_else(|| format!("{word}: a value is missing"));
        fn number<T: std::str::FromStr>(word: &str, text: &str) -> Result<T, String> {
            text.parse().map_err(|_| format!("{word} {text}: expected a number"))
        }
        match word.as_str() {
            "--all" => {
                asked.hair.extend(grooms::ALL.iter().map(|(name, _)| (*name).to_owned()));
                let recipe = |(name, _): &(&str, &str)| format!("{name}.recipe");
                asked.hair.extend(grooms::TEMPLATES.iter().map(recipe));
            }
            "--head" => match value()?.as_str() {
                "all" => {
                    asked.heads.push("builtin".to_owned());
                    let smooth = HEADS.iter().filter(|(name, _)| *name != SCAN);
                    asked.heads.extend(smooth.map(|(name, _)| (*name).to_owned()));
                }
                head => asked.heads.push(head.to_owned()),
            },
            "--share" => asked.share = number(word, value()?)?,
            "--tolerance" => asked.judge.tolerance = number(word, value()?)?,
            "--threads" => asked.judge.threads = number(word, value()?)?,
            "--test" | "--nocapture" => {}
            option if option.starts_with("--") => return Err(format!("{option}: no such option")),
            hair => asked.hair.push(hair.to_owned()),
        }
    }
    if !(asked.share > 0.0 && asked.share <= 1.0) {
        return Err(format!("--share {}: expected a share of the hair, 0 to 1", asked.share));
    }
    if asked.heads.is_empty() {
        asked.heads.push("builtin".to_owned());
    }
    Ok(asked)
}

/// The text of a graph, and the folder of its paths.
fn graph(hair: &str) -> Result<(String, PathBuf), String> {
    let recipe = hair.strip_suffix(".recipe");
    let known = match recipe {
        Some(name) => grooms::TEMPLATES.iter().find(|(known, _)| *known == name),
        None => grooms::ALL.iter().find(|(known, _)| *known == hair),
    };
    if let Some((_, text)) = known {
        return Ok(((*text).to_owned(), PathBuf::new()));
    }
    let text = std::fs::read_to_string(hair).map_err(|err| format!("{hair}: {err}"))?;
    Ok((text, Path::new(hair).parent().unwrap_or(Path::new("")).to_owned()))
}

/// The mesh of a head; none for the built-in one.
fn mesh(head: &str) -> Result<Option<PathBuf>, String> {
    if head == "builtin" {
        return Ok(None);
    }
    let file = match HEADS.iter().find(|(name, _)| *name == head) {
        Some((_, path)) => shared("judge", path).ok_or(format!("{head} is not at hand"))?,
        None => PathBuf::from(head),
    };
    std::path::absolute(&file).map(Some).map_err(|err| format!("{head}: {err}"))
}

fn judge(asked: &Asked) -> ExitCode {
    // A preview is the first tenth of the strands.
    let quality = if asked.share <= 0.1 { Quality::Preview } else { Quality::Final };
    let made = if asked.share <= 0.1 { 0.1 } else { 1.0 };
    let judge = Judge { every: (made / asked.share).round().max(1.0) as usize, ..asked.judge };
    println!(
        "{:<28} {:<10} {:>7} {:>9} {:>7} {:>7} {:>7}  deepest                                       roots off, farthest; seconds",
        "hair", "head", "hairs", "samples", "deep", "hairs", "cm"
    );
    let mut holds = true;
    for head in &asked.heads {
        for hair in &asked.hair {
            let began = Instant::now();
            let made = graph(hair).and_then(|(text, folder)| {
                let evaluator = Evaluator::new(judge.threads, 0)?;
                make(&text, &folder, mesh(head)?.as_deref(), quality, &evaluator)
            });
            let took = began.elapsed().as_secs_f64();
            match made {
                Ok(made) => holds &= line(hair, head, &made, &judge, took),
                Err(fault) => {
                    holds = false;
                    println!("{hair:<28} {head:<10} {fault}");
                }
            }
        }
    }
    ExitCode::from(u8::from(!holds))
}

/// Judges one and prints it; gives whether it holds.
fn line(hair: &str, head: &str, made: &Made, judge: &Judge, took: f64) -> bool {
    let began = Instant::now();
    let found = judge.judge(&made.skin, &made.curves);
    let (by, place) = told(found.deepest, made);
    let (off, root) = told(found.farthest, made);
    let off = if found.off > 0 { format!("{} {off} {root}", found.off) } else { "0".to_owned() };
    let off = match found.rootless {
        0 => off,
        rootless => format!("{off}, {rootless} rootless"),
    };
    let astray = if made.astray > 0 { format!(", {} astray", made.astray) } else { String::new() };
    println!(
        "{hair:<28} {head:<10} {:>7} {:>9} {:>7} {:>7} {by:>7}  {place:<45} {off}{astray}; {took:.1} + {:.1}",
        found.hairs,
        found.samples,
        found.deep,
        found.deep_hairs,
        began.elapsed().as_secs_f64()
    );
    found.holds()
}

/// How much, and where.
fn told(place: Option<Place>, made: &Made) -> (String, String) {
    let Some(Place { by, hair, at, along, spans }) = place else {
        return ("-".to_owned(), String::new());
    };
    let [x, y, z] = at.to_array();
    let [prim, hair] = hair;
    let path = made.curves[prim].path.rsplit('/').next().unwrap_or("");
    let text = format!(
        "{} ({x:.2}, {y:.2}, {z:.2}) {path} {hair} at {along:.1} of {spans}",
        region(at, &made.frame)
    );
    (format!("{by:.3}"), text)
}
