//! The pages on USD files and on reports say what is there: every primvar and every field, by name, type and spread. The pages for
//! artists and the manual's examples do what they show.

mod artists;
mod examples;

use super::shipped::shipped;
use coif_graphs::grooms;
use coif_nodes::data::attributes::DECLARED;
use coif_nodes::formats::export::{ADDED, LOOKDEV, file_name};
use coif_tests::{Folder, curves_in, eval, run};
use serde_json::Value as Json;
use std::collections::{BTreeMap, BTreeSet};

/// Rows of the tables of a page whose first column has this head: the cells of each, without the marks of code.
pub(crate) fn rows(page: &str, head: &str) -> Vec<Vec<String>> {
    let text = std::fs::read_to_string(coif_tests::repository().join("docs").join(page));
    let text = text.expect("the page");
    let mut rows = vec![];
    let mut is_in = false;
    for line in text.lines() {
        let cells: Vec<&str> = line.trim_matches('|').split('|').map(str::trim).collect();
        match line.starts_with('|') {
            false => is_in = false,
            true if cells[0] == head => is_in = true,
            true if is_in && !cells[0].starts_with("---") => {
                rows.push(cells.iter().map(|cell| cell.replace('`', "")).collect());
            }
            true => {}
        }
    }
    rows
}

#[test]
fn the_page_on_usd_has_every_primvar_of_every_shipped_groom_and_no_other() {
    let rows = rows("usd.md", "primvar");
    let page: BTreeMap<&str, (&str, BTreeSet<&str>)> = rows
        .iter()
        .map(|row| (row[0].as_str(), (row[1].as_str(), row[2].split(", ").collect())))
        .collect();
    assert_eq!(page.len(), rows.len(), "a name is there twice");
    let mut parted = 0;
    for (name, _) in grooms::ALL {
        let primvars = shipped(name).primvars();
        for (primvar, ty, how) in &primvars {
            let (wanted, hows) =
                page.get(primvar.as_str()).unwrap_or_else(|| panic!("{name}: {primvar}"));
            assert_eq!(ty, wanted, "{name}: {primvar}");
            assert!(hows.contains(how.as_str()), "{name}: {primvar} is {how}");
        }
        // Hair of a parted scalp names its section.
        let has = |primvar: &str| primvars.iter().any(|(known, ..)| known == primvar);
        assert_eq!(has("section"), has("section_name"), "{name}");
        parted += usize::from(has("section"));
    }
    assert!(parted >= 6, "{parted}");
    // What nodes declare is written where a graph makes it (`nodes/src/formats/export.rs` proves that), and nothing else is.
    let declared = DECLARED.iter().map(|(name, ..)| file_name(name));
    let added = ADDED.iter().map(|(name, ..)| *name).chain(LOOKDEV.iter().map(|(name, _)| *name));
    let written: BTreeSet<&str> = declared.chain(added).collect();
    assert_eq!(page.keys().copied().collect::<BTreeSet<_>>(), written);
}

#[test]
fn files_hold_names_as_authored_rest_pigment_and_the_skin() {
    let folder = Folder::new("pages-usd");
    let file = |ending: &str| folder.path(&format!("groom.{ending}")).display().to_string();
    let set = ["--set", "out.name=Back & \u{e9}", "--with-skin"];
    eval("start", &[&["--quality", "preview", "--out", &file("usda")], &set[..]].concat());
    let text = std::fs::read_to_string(file("usda")).expect("it was written");
    for part in [
        "displayName = \"Back & \u{e9}\"",
        "def BasisCurves \"Back____\"",
        "point3f[] primvars:pref",
        "float[] primvars:melanin",
        "float[] primvars:redness",
        "def Mesh \"skin\"",
        "color3f inputs:diffuseColor.connect = </Start/Looks/Back____/Colour.outputs:result>",
    ] {
        assert!(text.contains(part), "{part}");
    }
    assert!(!text.contains("primvars:density"));
}

/// Every field of a value by its path; what is a law has its own name.
pub(crate) fn fields(json: &Json, path: &str, all: &mut BTreeSet<String>) {
    match json {
        Json::Object(fields_of) => {
            for (name, value) in fields_of {
                let path = if path.is_empty() { name.clone() } else { format!("{path}.{name}") };
                all.insert(path.clone());
                if name != "laws" {
                    fields(value, &path, all);
                }
            }
        }
        Json::Array(values) => {
            values.iter().for_each(|value| fields(value, &format!("{path}[]"), all));
        }
        _ => {}
    }
}

#[test]
fn the_page_on_reports_has_every_field_of_reports_and_measures_and_no_other() {
    let rows = rows("report.md", "field");
    let page: BTreeSet<String> = rows.iter().map(|row| row[0].clone()).collect();
    assert_eq!(page.len(), rows.len(), "a field is there twice");
    let mut found = BTreeSet::new();
    for (name, _) in grooms::ALL {
        let shipped = shipped(name);
        fields(&shipped.report, "", &mut found);
        fields(&Json::Array(shipped.prims().to_vec()), "", &mut found);
    }
    // Reports of what fails: before anything ran, and while it did.
    for set in ["none.none=1", "guides.length=\"x\""] {
        let ran = run(["eval", "start", "--report", "-", "--set", set]);
        assert_eq!(ran.code, 2, "{}", ran.err);
        fields(&serde_json::from_str(&ran.out).expect("JSON"), "", &mut found);
    }
    // Of a row of a sweep.
    let folder = Folder::new("pages-report");
    let sweep = folder.path("sweep.csv").display().to_string();
    std::fs::write(&sweep, "guides.length\n3\n").expect("it is written");
    let of_rows = eval("start", &["--quality", "preview", "--sweep", &sweep]);
    fields(&of_rows[0], "", &mut found);
    // Of a groom with a budget.
    let text = std::fs::read_to_string(coif_tests::repository().join("graphs/grooms/start.ron"));
    let text = text.expect("the groom").replacen("seed: 0,", "seed: 0, budget: (points: 100),", 1);
    let limited = folder.path("limited.ron").display().to_string();
    std::fs::write(&limited, text).expect("it is written");
    fields(&eval(&limited, &["--quality", "preview", "--no-budget"]), "", &mut found);
    // Of a file that holds something broken.
    let file = folder.path("broken.usda");
    let good = "point3f[] points = [(0,0,0),(0,1,0)]\nint[] curveVertexCounts = [2]";
    let text = format!(
        "#usda 1.0\ndef BasisCurves \"a\" {{ {good} }}\ndef BasisCurves \"b\" {{ {} }}\n",
        good.replace("[2]", "[3]")
    );
    std::fs::write(&file, text).expect("it is written");
    let ran = run(["measure".as_ref(), file.as_os_str(), "--json".as_ref()]);
    fields(&serde_json::from_str(&ran.out).expect("JSON"), "", &mut found);
    // Of one that declares no unit.
    let file = folder.path("groom.abc").display().to_string();
    eval("start", &["--quality", "preview", "--out", &file]);
    let ran = run(["measure", &file, "--json"]);
    fields(&serde_json::from_str(&ran.out).expect("JSON"), "", &mut found);
    let unknown: Vec<&String> = found.difference(&page).collect();
    assert!(unknown.is_empty(), "not on the page: {unknown:?}");
    // Pictures need a driver, and are on the page.
    let never: Vec<&String> =
        page.difference(&found).filter(|field| !field.starts_with("picture")).collect();
    assert!(never.is_empty(), "never there: {never:?}");
}

/// Name, type and interpolation of all primvars of a file.
pub(crate) fn primvars(file: &std::path::Path) -> BTreeSet<(String, String, String)> {
    let indices = |name: &str| name.ends_with(":indices");
    let curves = curves_in(file);
    let all = curves.iter().flat_map(|curves| &curves.primvars).filter(|p| !indices(&p.name));
    all.map(|p| (p.name.clone(), p.type_name.clone(), p.interpolation.clone())).collect()
}
