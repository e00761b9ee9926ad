//! Laws of templates: what their hash sees, what an instance gives, and what an upgrade does to each value.

use super::*;
use crate::document::Point;
use crate::file;
use crate::grooms;
use crate::schedule::files::DiskFiles;
use crate::schedule::request::plan;
use crate::schedule::result::content_hash;
use crate::schedule::run::{CancelToken, Evaluator, OnFailure, Quiet};
use coif_nodes::declared::Interface;
use coif_nodes::define::{Type, Value};
use coif_nodes::eval::Quality;
use expect_test::expect;

fn id(text: &str) -> NodeId {
    NodeId::new(text).unwrap()
}
fn groom(name: &str) -> Document {
    let (_, text) = grooms::ALL.iter().find(|(known, _)| *known == name).unwrap();
    file::read(text).unwrap().document
}
fn origin(version: &str) -> Origin {
    Origin { name: "row".into(), version: version.into(), ..Origin::default() }
}
/// The start groom's braids as a template, with two of its values as its own.
fn template(version: &str) -> Document {
    let mut document = small();
    for input in ["rows.radius", "thin.count"] {
        let inner: Socket = format!("row/{input}").parse().unwrap();
        groups::expose(&document, &inner).unwrap().0.apply(&mut document).unwrap();
    }
    new(&document, &id("row"), origin(version)).unwrap()
}
fn small() -> Document {
    let plain = file::read(
        r#"(format: 3, nodes: {
            "head": (kind: "head"),
            "rows": (kind: "stroke_input", links: {"scalp": "head.scalp"}, inputs: {"radius": 0.7, "strokes": [
                (points: [(2.0, 8.5, 6.0), (2.2, 9.5, 2.0), (2.0, 8.5, -3.0)])]}),
            "thin": (kind: "resample", links: {"curves": "rows.curves"}, inputs: {"count": 9}),
            "out": (kind: "groom_output", links: {"curves": "thin.curves"}),
        })"#,
    );
    grouped(&plain.unwrap().document, "row").unwrap().0
}
fn set(document: &mut Document, node: &str, input: &str, value: Value) {
    let (node, input) = (id(node), input.to_owned());
    Edit::SetInput { node, input, setting: Setting::Known(value) }.apply(document).unwrap();
}
fn hair(document: &Document) -> Vec<String> {
    let outputs = document.nodes.iter().filter(|(_, node)| node.kind == "groom_output");
    let targets: Vec<Socket> = outputs.map(|(id, _)| Socket::new(id.clone(), "curves")).collect();
    let plan = plan(document, &targets, Quality::Final, &DiskFiles::default()).unwrap();
    let evaluator = Evaluator::new(1, 64 << 20).unwrap();
    let outcome = evaluator.run(&plan, OnFailure::Stop, &CancelToken::default(), &Quiet);
    let all = outcome.targets.iter().map(|value| match value {
        Some(Value::Curves(curves)) => content_hash(curves),
        _ => "nothing".to_owned(),
    });
    all.collect()
}

#[test]
fn an_instance_gives_the_bits_of_its_nodes_pasted_plainly() {
    let made = template("1.0");
    let head = r#"(format: 3, nodes: {"head": (kind: "head")})"#;
    let mut document = file::read(head).unwrap().document;
    let Added { edit, id: instance, .. } = add(&document, &made, Placement::default()).unwrap();
    edit.apply(&mut document).unwrap();
    set(&mut document, instance.as_str(), "radius", Value::Float(0.4));
    let out = Node { kind: "groom_output".into(), ..Node::default() };
    document.nodes.insert(id("out"), out.into());
    document.links.insert("out.curves".parse().unwrap(), vec![Socket::new(instance, "curves")]);
    let mut plain = groups::ungroup(&small(), &id("row")).unwrap().0;
    set(&mut plain, "rows", "radius", Value::Float(0.4));
    assert_eq!(hair(&document), hair(&plain));
    assert_ne!(hair(&document), ["nothing"]);
}

#[test]
fn what_is_said_of_a_template_or_set_on_it_does_not_change_its_hash() {
    let made = template("1.0");
    let row = id("row");
    let first = hash(&made, &row);
    let same = |what: &str, change: &dyn Fn(&mut Document)| {
        let mut changed = made.clone();
        change(&mut changed);
        assert_eq!(hash(&changed, &row), first, "{what}");
    };
    same("a value on it", &|d| set(d, "row", "radius", Value::Float(0.1)));
    same("its wires", &|d| drop(d.links.remove(&"row.scalp".parse().unwrap())));
    same("places", &|d| d.layout.clear());
    same("a label", &|d| {
        Edit::SetLabel { id: id("row/thin"), label: Some("x".into()) }.apply(d).unwrap();
    });
    same("its name", &|d| {
        *d = groups::renamed(d, |id| NodeId::new(&id.as_str().replacen("row", "other", 1)).unwrap())
            .renamed_back()
    });
    same("text", &|d| {
        let text = file::write(d).replace("\n", "\n\n").replace("\"row\": (", "// hm\n\"row\": (");
        *d = file::read(&text).unwrap().document;
    });
}

trait RenamedBack {
    fn renamed_back(self) -> Document;
}
impl RenamedBack for Document {
    fn renamed_back(self) -> Document {
        groups::renamed(&self, |id| NodeId::new(&id.as_str().replacen("other", "row", 1)).unwrap())
    }
}

#[test]
fn any_value_of_any_node_in_it_changes_its_hash() {
    let mut random = crate::document::testing::Random::new(9);
    let mut changed = 0;
    for def in coif_nodes::all() {
        let mut document = Document::default();
        let group = Node {
            kind: "group".into(),
            interface: Some(Interface::default()),
            template: Some(origin("1").into()),
            ..Node::default()
        };
        document.nodes.insert(id("row"), group.into());
        let inner = NodeId::new(&format!("row/{}", def.id)).unwrap();
        let node = document.fresh_node(def.id, &inner);
        document.nodes.insert(inner.clone(), node.into());
        let first = hash(&document, &id("row"));
        for input in def.inputs {
            if matches!(input.ty, Type::Curves | Type::Scalp) {
                continue;
            }
            let mut other = document.clone();
            let value = random.value(input.ty);
            let setting = Setting::Known(value.clone());
            let edit = Edit::SetInput { node: inner.clone(), input: input.name.into(), setting };
            edit.apply(&mut other).unwrap();
            let is_same = other == document;
            assert_eq!(hash(&other, &id("row")) == first, is_same, "{}.{}", def.id, input.name);
            changed += usize::from(!is_same);
        }
    }
    assert!(changed > 200, "{changed}");
}

/// An instance of version 1 with values on both ports, and what an upgrade to `change`d ports tells.
fn upgraded(change: &dyn Fn(&mut Vec<Port>)) -> (Document, Vec<String>) {
    let head = r#"(format: 3, nodes: {"head": (kind: "head")})"#;
    let mut document = file::read(head).unwrap().document;
    let Added { edit, id: row, .. } =
        add(&document, &template("1.0"), Placement::default()).unwrap();
    edit.apply(&mut document).unwrap();
    set(&mut document, "row", "radius", Value::Float(0.4));
    set(&mut document, "row", "count", Value::Int(30));
    let mut newer = template("1.1");
    let node = newer.node("row").unwrap().clone();
    let old = node.interface.unwrap();
    let mut inputs = old.inputs().to_vec();
    change(&mut inputs);
    let names: BTreeMap<String, String> = inputs
        .iter()
        .flat_map(|port| port.was.iter().map(|was| (was.clone(), port.name.clone())))
        .collect();
    let ports = Interface::new(inputs, old.outputs().to_vec()).unwrap();
    groups::set_interface(&newer, &id("row"), ports, &names).unwrap().apply(&mut newer).unwrap();
    let done = upgrade(&document, &row, &newer).unwrap();
    assert!(!done.changed_inside);
    let before = document.clone();
    let undo = done.edit.apply(&mut document).unwrap();
    let after = document.clone();
    undo.apply(&mut document).unwrap();
    assert_eq!(document, before);
    let origin = after.node("row").unwrap().template.clone().unwrap();
    assert_eq!((origin.version.as_str(), &origin.hash), ("1.1", &hash(&after, &row)));
    (after, done.overrides.iter().map(OverrideOutcome::to_string).collect())
}

#[test]
fn an_upgrade_accounts_for_every_value_and_wire() {
    let check = |change: &dyn Fn(&mut Vec<Port>), says: expect_test::Expect| {
        says.assert_eq(&upgraded(change).1.join("\n"));
    };
    check(
        &|_| {},
        expect![[r#"
            count = 30: kept
            radius = 0.4: kept
            scalp = head.scalp: kept
            curves = wired to out.curves: kept"#]],
    );
    // Renamed.
    check(
        &|ports| {
            let port = ports.iter_mut().find(|port| port.name == "radius").unwrap();
            (port.name, port.was) = ("thickness".into(), vec!["radius".into()]);
        },
        expect![[r#"
            count = 30: kept
            radius = 0.4: moved to thickness
            scalp = head.scalp: kept
            curves = wired to out.curves: kept"#]],
    );
    // Removed, and with another range.
    check(
        &|ports| {
            ports.retain(|port| port.name != "radius");
            let port = ports.iter_mut().find(|port| port.name == "count").unwrap();
            (port.hard, port.soft) = (Some((2.0, 12.0)), None);
        },
        expect![[r#"
            count = 30: kept, clamped to 2 to 12
            radius = 0.4: lost, there is no such input any more
            scalp = head.scalp: kept
            curves = wired to out.curves: kept"#]],
    );
    // Of another type.
    check(
        &|ports| {
            for port in ports.iter_mut().filter(|port| port.name != "radius") {
                *port = Port::new(&port.name, Type::Text);
            }
        },
        expect![[r#"
            count = 30: lost, takes a text, not a whole number
            radius = 0.4: kept
            scalp = head.scalp: lost, it takes text now
            curves = wired to out.curves: kept"#]],
    );
}

#[test]
fn a_lock_keeps_a_version_and_changes_inside_are_noticed() {
    let mut document = template("1.0");
    let row = id("row");
    lock(&document, &row, true).unwrap().apply(&mut document).unwrap();
    let why = upgrade(&document, &row, &template("1.1")).unwrap_err();
    assert_eq!(why, "row is locked to version 1.0: unlock it first");
    lock(&document, &row, false).unwrap().apply(&mut document).unwrap();
    set(&mut document, "row/thin", "by", Value::Text("spacing".into()));
    assert!(upgrade(&document, &row, &template("1.1")).unwrap().changed_inside);
}

#[test]
fn a_template_is_a_groom_that_opens_by_itself() {
    let made = template("1.0");
    assert_eq!(file::read(&file::write(&made)).unwrap().document, made);
    assert!(crate::document::graph::check(&made).is_empty());
    assert_eq!(group_of(&made).unwrap(), &id("row"));
    assert_eq!(group_of(&groom("start")).unwrap_err(), "no group in it is marked as a template");
    assert_ne!(hair(&made), ["nothing"]);
}

#[test]
fn an_added_template_stands_on_the_head_at_hand_gives_to_an_output_and_is_shown() {
    let made = template("1.0");
    let head = r#"(format: 3, display: "head", nodes: {"head": (kind: "head", at: (10.0, 20.0))})"#;
    let mut document = file::read(head).unwrap().document;
    let before = document.clone();
    let mut undo = vec![];
    for (instance, out) in [("row", "out"), ("row_2", "out_2")] {
        let added = add(&document, &made, Placement::default()).unwrap();
        undo.push(added.edit.apply(&mut document).unwrap());
        assert_eq!((added.id.as_str(), added.draws), (instance, None));
        let wires = |to: String| format!("{:?}", document.links.get(&to.parse().unwrap()));
        assert_eq!(wires(format!("{instance}.scalp")), "Some([head.scalp])");
        assert_eq!(wires(format!("{out}.curves")), format!("Some([{instance}.curves])"));
    }
    assert_eq!(document.nodes.values().filter(|node| node.is_head()).count(), 1);
    assert_eq!(document.display, None, "all outputs are shown");
    let places: std::collections::BTreeSet<String> =
        ["row", "row_2", "out", "out_2"].map(|id| format!("{:?}", document.layout.get(id))).into();
    assert_eq!(places.len(), if document.layout.contains_key("row") { 4 } else { 1 });
    undo.into_iter().rev().for_each(|undo| drop(undo.apply(&mut document).unwrap()));
    assert_eq!(document, before);
    // Without a head the template's own comes along; at a place that is said it lies there.
    let empty = Document::default();
    let place = Placement { at: Some(Point(500.0, 60.0)), ..Placement::default() };
    let mut document = empty.clone();
    add(&empty, &made, place).unwrap().edit.apply(&mut document).unwrap();
    assert!(document.nodes.contains_key("head"));
    assert_ne!(hair(&document), ["nothing"]);
    let at = document.layout.get("row").copied();
    assert_eq!(at, Some(Point(500.0, 60.0)));
}

#[test]
fn what_a_template_has_drawn_for_it_comes_along_empty_to_be_drawn() {
    let text = r#"(format: 3, nodes: {
        "head": (kind: "head"),
        "rows": (kind: "stroke_input", links: {"scalp": "head.scalp"}, inputs: {"radius": 0.7, "strokes": [
            (points: [(2.0, 8.5, 6.0), (2.2, 9.5, 2.0), (2.0, 8.5, -3.0)])]}),
        "row": (kind: "group", template: (name: "row"),
            interface: (inputs: [(name: "rows", type: "curves", needed: true)], outputs: [(name: "curves", type: "curves")]),
            links: {"rows": "rows.curves"},
            nodes: {
                "in": (kind: "group_input"),
                "thin": (kind: "resample", links: {"curves": "in.rows"}),
                "out": (kind: "group_output", links: {"curves": "thin.curves"}),
            }),
        "out": (kind: "groom_output", links: {"curves": "row.curves"}),
    })"#;
    let made = file::read(text).unwrap().document;
    assert_ne!(hair(&made), ["nothing"], "the file shows what is made of it");
    let head = r#"(format: 3, nodes: {"head": (kind: "head"), "mine": (kind: "stroke_input", links: {"scalp": "head.scalp"}, inputs: {"seed": 1})})"#;
    let mut document = file::read(head).unwrap().document;
    let mine = id("mine");
    let place = Placement { drawn: Some(&mine), ..Placement::default() };
    let first = add(&document, &made, place).unwrap();
    first.edit.apply(&mut document).unwrap();
    assert_eq!(first.draws, Some(mine.clone()), "it had nothing to do");
    let second = add(&document, &made, place).unwrap();
    second.edit.apply(&mut document).unwrap();
    let drawn = second.draws.unwrap();
    assert_ne!(drawn, mine, "that feeds the first");
    let node = &document.nodes[&drawn];
    assert_eq!(node.inputs.keys().collect::<Vec<_>>(), ["radius", "seed"], "no strokes");
    assert_ne!(node.inputs["seed"], document.nodes[&mine].inputs["seed"]);
}

#[test]
fn a_port_is_followed_by_who_says_that_it_was_called_so() {
    type Ports<'a> = &'a [(&'a str, &'a [&'a str])];
    let interface = |ports: Ports| {
        let port = |(name, was): &(&str, &[&str])| Port {
            was: was.iter().map(ToString::to_string).collect(),
            ..Port::new(name, Type::Float)
        };
        Interface::new(ports.iter().map(port).collect(), vec![]).unwrap()
    };
    let check = |old: Ports, new: Ports, name: &str, to: Option<&str>| {
        let (old, new) = (interface(old), interface(new));
        let found = successor(old.inputs(), new.inputs(), name).map(|port| port.name.as_str());
        assert_eq!(found, to, "{name} of {old:?} in {new:?}");
    };
    check(&[("a", &[])], &[("a", &[])], "a", Some("a"));
    check(&[("a", &[])], &[("b", &["a"])], "a", Some("b"));
    check(&[("a", &[])], &[("b", &[])], "a", None);
    // Another has the name now.
    check(&[("a", &[])], &[("a", &[]), ("b", &["a"])], "a", Some("b"));
    // That was long ago.
    let both: Ports = &[("a", &[]), ("b", &["a"])];
    check(both, both, "a", Some("a"));
    check(both, both, "b", Some("b"));
    // They changed names.
    let (before, after): (Ports, Ports) =
        (&[("a", &[]), ("b", &[])], &[("a", &["b"]), ("b", &["a"])]);
    check(before, after, "a", Some("b"));
    check(before, after, "b", Some("a"));
    check(after, after, "a", Some("a"));
}

#[test]
fn a_template_of_plain_nodes_and_their_parameters_has_these_as_its_inputs() {
    let (_, text) = grooms::TEMPLATES.iter().find(|(name, _)| *name == "bob").unwrap();
    let made = file::read(text).unwrap().document;
    let group = group_of(&made).unwrap().clone();
    let ports = |document: &Document, group: &NodeId| {
        document.nodes[group].interface.unwrap().inputs().to_vec()
    };
    let were = ports(&made, &group);
    let (made, parameters) = groups::set_by_parameters(&made, &group, "Bob").unwrap();
    let (mut plain, inside) = groups::ungroup(&made, &group).unwrap();
    let parameters = parameters.unwrap();
    set(&mut plain, parameters.as_str(), "length", Value::Float(17.0));
    set(&mut plain, parameters.as_str(), "count", Value::Int(300));
    let chosen = inside.into_iter().chain([parameters]).collect();
    let (grouped, group) = groups::make(&plain, &chosen, "mine").unwrap();
    assert_eq!(hair(&grouped), hair(&plain));
    let template = new(&grouped, &group, origin("1.0")).unwrap();
    let are = ports(&template, &group);
    assert!(template.nodes.values().all(|node| node.kind != "parameters"));
    assert_eq!(hair(&template), hair(&plain));
    for was in were.iter().filter(|port| port.default.is_some() && port.ty != Type::Strokes) {
        let is = are.iter().find(|port| port.name == was.name).expect(&was.name);
        let default = match &*was.name {
            "length" => Some(Value::Float(17.0)),
            "count" => Some(Value::Int(300)),
            _ => was.default.clone(),
        };
        assert_eq!((&is.doc, is.hard), (&was.doc, was.hard), "{}", was.name);
        assert_eq!(format!("{:?}", is.default), format!("{default:?}"), "{}", was.name);
    }
}
