//! Laws of groups: what is grouped gives what it gave, and what is wrong with groups is said.

use super::super::edit::between;
use super::super::testing::Random;
use super::*;
use crate::file;
use crate::schedule::files::DiskFiles;
use crate::schedule::plan::{Plan, Source as From_};
use crate::schedule::request::plan_possible;
use coif_nodes::define::Value;
use coif_nodes::eval::Quality;
use coif_nodes::maths::hash::{Key, KeyBuilder};
use expect_test::expect;

fn id(text: &str) -> NodeId {
    NodeId::new(text).unwrap()
}
fn ids(text: &str) -> BTreeSet<NodeId> {
    text.split_whitespace().map(id).collect()
}
fn socket(text: &str) -> Socket {
    text.parse().unwrap()
}
fn read(text: &str) -> Document {
    let loaded = file::read(text).unwrap_or_else(|err| panic!("{err}\n{text}"));
    assert!(loaded.warnings.is_empty(), "{:?}", loaded.warnings);
    loaded.document
}
fn braids() -> Document {
    read(
        r#"(format: 3, nodes: {
            "head": (kind: "head", at: (0, 0)),
            "rows": (kind: "stroke_input", at: (300, 0), links: {"scalp": "head.scalp"}, inputs: {"radius": 0.7}),
            "thin": (kind: "resample", at: (600, 0), links: {"curves": "rows.curves"}, inputs: {"count": 9}),
            "short": (kind: "trim", at: (900, 0), links: {"curves": "thin.curves", "scalp": "head.scalp"}),
            "all": (kind: "merge", at: (1200, 0), links: {"curves": ["thin.curves", "short.curves"]}),
            "out": (kind: "groom_output", at: (1500, 0), links: {"curves": "all.curves"}),
        })"#,
    )
}

/// What is evaluated for the outputs of all nodes, whatever nodes are called; none where it cannot be.
fn evaluated(document: &Document, targets: &[Socket]) -> Vec<Option<Key>> {
    let files = DiskFiles::default();
    let (plan, refused) = plan_possible(document, targets, Quality::Final, &files);
    let mut keys: Vec<Key> = vec![];
    for step in &plan.steps {
        let mut key = KeyBuilder::new(step.def.id).int(u64::from(step.bypass));
        for (input, sources) in step.def.inputs.iter().zip(&step.inputs) {
            // A value that says what the default says is the same value.
            let value = |value: &Value| KeyBuilder::new("value").key(value.key()).finish();
            let default = input.default().and_then(|v| values::fit(input.ty, v).ok());
            let all: Vec<Key> = sources
                .iter()
                .map(|source| match source {
                    From_::Value(it) => value(it),
                    From_::Wire { step, output } => {
                        KeyBuilder::new("wire").key(keys[*step]).int(*output as u64).finish()
                    }
                })
                .collect();
            if all.is_empty() || default.is_some_and(|it| all == [value(&it)]) {
                continue;
            }
            key = all.into_iter().fold(key.text(input.name), KeyBuilder::key);
        }
        keys.push(key.finish());
    }
    let of = |plan: &Plan, n: usize| {
        let (step, output) = plan.targets[n];
        KeyBuilder::new("target").key(keys[step]).int(output as u64).finish()
    };
    let mut next = 0;
    let mut one = |why: &Option<_>| {
        why.is_none().then(|| {
            next += 1;
            of(&plan, next - 1)
        })
    };
    refused.iter().map(|why| one(&why.as_ref())).collect()
}

fn applied(before: &Document, after: &Document) {
    let mut changed = before.clone();
    let undo = between(before, after).apply(&mut changed).unwrap();
    assert_eq!(changed, *after);
    undo.apply(&mut changed).unwrap();
    assert_eq!(changed, *before);
}

#[test]
fn a_group_is_text_that_people_can_read_and_gives_what_its_nodes_gave() {
    let plain = braids();
    let (grouped, group) = make(&plain, &ids("rows thin short"), "cornrow row").unwrap();
    assert_eq!(group.as_str(), "cornrow_row");
    applied(&plain, &grouped);
    let text = file::write(&grouped);
    let group_text: String = text
        .lines()
        .skip_while(|line| !line.contains("\"cornrow_row\": ("))
        .take_while(|line| *line != "        ),")
        .filter(|line| !line.is_empty())
        .map(|line| format!("{}\n", &line[8..]))
        .collect();
    expect![[r#"
                "cornrow_row": (
                    at: (600.0, 0.0),
                    kind: "group",
                    label: "cornrow row",
                    interface: (
                        inputs: [
                            (name: "scalp", type: "scalp", needed: true, doc: "The head that the strokes are drawn on."),
                        ],
                        outputs: [
                            (name: "curves", type: "curves", doc: "The resampled curves."),
                            (name: "curves_2", type: "curves", doc: "The same hair, cut to the shape."),
                        ],
                    ),
                    links: {
                        "scalp": "head.scalp",
                    },
                    into: [
                        "curves to all.curves",
                        "curves_2 to all.curves",
                    ],
                    nodes: {
                        "thin": (
                            at: (600.0, 0.0),
                            kind: "resample",
                            inputs: {
                                "count": 9,
                            },
                            links: {
                                "curves": "rows.curves",
                            },
                        ),
                        "out": (
                            at: (1160.0, 0.0),
                            kind: "group_output",
                            links: {
                                "curves": "thin.curves",
                                "curves_2": "short.curves",
                            },
                        ),
                        "in": (
                            at: (40.0, 0.0),
                            kind: "group_input",
                        ),
                        "short": (
                            at: (900.0, 0.0),
                            kind: "trim",
                            links: {
                                "curves": "thin.curves",
                                "scalp": "in.scalp",
                            },
                        ),
                        "rows": (
                            at: (300.0, 0.0),
                            kind: "stroke_input",
                            inputs: {
                                "radius": 0.7,
                            },
                            links: {
                                "scalp": "in.scalp",
                            },
                        ),
                    },
    "#]]
    .assert_eq(&group_text);
    assert_eq!(read(&text), grouped);
    assert!(graph::check(&grouped).is_empty(), "{:?}", graph::check(&grouped));
    let outs = [socket("out.curves")];
    assert_eq!(evaluated(&plain, &outs), evaluated(&grouped, &outs));
    let (apart, freed) = ungroup(&grouped, &group).unwrap();
    assert_eq!(freed, ids("rows thin short"));
    assert_eq!(apart.links, plain.links);
    assert_eq!(apart.nodes, plain.nodes);
    applied(&grouped, &apart);
}

#[test]
fn random_groups_give_what_their_nodes_gave_and_come_apart_again() {
    let mut made = 0;
    for seed in 0..400 {
        let mut random = Random::new(seed);
        let document = random.document();
        let top: Vec<NodeId> =
            document.nodes.keys().filter(|id| id.group().is_none()).cloned().collect();
        let chosen: BTreeSet<NodeId> =
            top.iter().filter(|_| random.below(2) == 0).cloned().collect();
        let Ok((grouped, group)) = make(&document, &chosen, "Of many") else { continue };
        made += 1;
        applied(&document, &grouped);
        assert_eq!(file::read(&file::write(&grouped)).unwrap().document, grouped, "seed {seed}");
        // What stayed outside is evaluated as before.
        let stayed = document.nodes.keys().filter(|id| grouped.nodes.contains_key(*id));
        let targets: Vec<Socket> = stayed.map(|id| Socket::new(id.clone(), "curves")).collect();
        let (before, after) = (evaluated(&document, &targets), evaluated(&grouped, &targets));
        for ((target, before), after) in targets.iter().zip(before).zip(after) {
            // A circle through the group may be none that runs outside of it.
            if before.is_some() && after.is_some() {
                assert_eq!(before, after, "seed {seed} {target}");
            }
        }
        let (apart, _) = ungroup(&grouped, &group).unwrap();
        applied(&grouped, &apart);
        assert_eq!(apart.nodes.len(), document.nodes.len(), "seed {seed}");
        let (before, after) = (evaluated(&document, &targets), evaluated(&apart, &targets));
        assert_eq!(before, after, "seed {seed}");
    }
    assert!(made > 100, "{made} groups");
}

#[test]
fn what_is_between_two_documents_leads_from_one_to_the_other() {
    for seed in 0..200 {
        let mut random = Random::new(seed);
        let (mut before, mut after) = (random.document(), random.document());
        before.settle();
        after.settle();
        applied(&before, &after);
    }
}

#[test]
fn a_value_of_a_group_and_a_parameter_of_the_graph_reach_what_reads_them() {
    let (grouped, _) = make(&braids(), &ids("rows thin short"), "row").unwrap();
    let mut document = grouped;
    let apply = |document: &mut Document, edit: Edit| {
        let before = document.clone();
        let undo = edit.apply(document).unwrap();
        let mut back = document.clone();
        undo.apply(&mut back).unwrap();
        assert_eq!(back, before);
    };
    let (edit, port) = expose(&document, &socket("row/rows.radius")).unwrap();
    apply(&mut document, edit);
    assert_eq!(port, socket("row.radius"));
    // What it was set to is the default of the group.
    let said = |document: &Document| evaluated(document, &[socket("out.curves")]);
    assert_eq!(said(&document), said(&braids()));
    let set = |input: &str, value: Value| {
        let at = socket(input);
        let (node, input) = (at.node, at.name.to_string());
        Edit::SetInput { node, input, setting: Setting::Known(value) }
    };
    let mut other = braids();
    apply(&mut other, set("rows.radius", Value::Float(0.3)));
    apply(&mut document, set("row.radius", Value::Float(0.3)));
    assert_eq!(said(&document), said(&other));
    // And from there to the graph.
    apply(&mut document, Edit::UnsetInput { node: id("row"), input: "radius".into() });
    let (edit, port) = expose(&document, &socket("row.radius")).unwrap();
    apply(&mut document, edit);
    assert_eq!(port, socket("parameters.radius"));
    apply(&mut document, set("parameters.radius", Value::Float(0.3)));
    assert_eq!(said(&document), said(&other));
    // Another input reads the same.
    let edit = read_port(&document, &socket("row.radius"), "radius").unwrap();
    apply(&mut document, edit);
    assert_eq!(said(&document), said(&other));
    assert_eq!(read(&file::write(&document)), document);
    assert!(graph::check(&document).is_empty(), "{:?}", graph::check(&document));
    // Values outside the port's range are clamped there.
    apply(&mut document, set("parameters.radius", Value::Float(1e6)));
    assert!(graph::check(&document).iter().any(|p| p.fault == Fault::OutOfRange));
    let why = read_port(&document, &socket("row.scalp"), "radius").unwrap_err();
    assert_eq!(
        why,
        "parameters.radius gives field (number, ramp, attribute or mask), scalp is taken"
    );
}

#[test]
fn ports_keep_what_is_wired_and_set_under_other_names_and_types() {
    let (mut document, group) = make(&braids(), &ids("rows thin short"), "row").unwrap();
    let (edit, _) = expose(&document, &socket("row/thin.count")).unwrap();
    edit.apply(&mut document).unwrap();
    let set = Edit::SetInput {
        node: group.clone(),
        input: "count".into(),
        setting: Setting::Known(Value::Int(20)),
    };
    set.apply(&mut document).unwrap();
    let before = evaluated(&document, &[socket("out.curves")]);
    let old = document.node("row").unwrap().interface.unwrap();
    let mut inputs = old.inputs().to_vec();
    inputs.iter_mut().for_each(|port| port.name = format!("my_{}", port.name));
    let new = Interface::new(inputs, old.outputs().to_vec()).unwrap();
    let names = [("scalp", "my_scalp"), ("count", "my_count")];
    let names = names.map(|(old, new)| (old.to_owned(), new.to_owned())).into_iter().collect();
    let mut renamed = document.clone();
    set_interface(&document, &group, new, &names).unwrap().apply(&mut renamed).unwrap();
    assert_eq!(evaluated(&renamed, &[socket("out.curves")]), before);
    assert!(graph::check(&renamed).is_empty());
    // Without its names all that was wired and set has no port any more.
    let mut lost = document.clone();
    set_interface(&document, &group, new, &BTreeMap::new()).unwrap().apply(&mut lost).unwrap();
    assert!(lost.node("row").unwrap().inputs.is_empty());
    let wires: Vec<String> = lost.links.keys().map(Socket::to_string).collect();
    assert!(!wires.iter().any(|to| to == "row.my_scalp" || to == "row/rows.scalp"), "{wires:?}");
}

#[test]
fn a_group_that_comes_apart_leaves_what_was_set_on_it_as_parameters() {
    let (mut document, group) = make(&braids(), &ids("rows thin short"), "row").unwrap();
    for input in ["row/rows.radius", "row/thin.count"] {
        let (edit, _) = expose(&document, &socket(input)).unwrap();
        edit.apply(&mut document).unwrap();
    }
    let said = |document: &Document| evaluated(document, &[socket("out.curves")]);
    let set = |document: &Document, at: &str, value: Value| {
        let (mut document, at) = (document.clone(), socket(at));
        let (node, input) = (at.node, at.name.to_string());
        let setting = Setting::Known(value);
        Edit::SetInput { node, input, setting }.apply(&mut document).unwrap();
        document
    };
    let on_group = set(&document, "row.count", Value::Int(5));
    let (lifted, parameters) = set_by_parameters(&on_group, &group, "Row").unwrap();
    applied(&on_group, &lifted);
    assert_eq!(said(&lifted), said(&on_group));
    let (plain, _) = ungroup(&lifted, &group).unwrap();
    applied(&lifted, &plain);
    assert!(graph::check(&plain).is_empty(), "{:?}", graph::check(&plain));
    assert_eq!(said(&plain), said(&on_group));
    let node = plain.node(parameters.unwrap().as_str()).unwrap();
    assert_eq!((node.kind.as_str(), node.label.as_deref()), ("parameters", Some("Row")));
    assert_eq!(node.inputs.keys().collect::<Vec<_>>(), ["count"]);
    assert!(plain.layout.contains_key(&id("parameters")));
    // What is set there is what nodes read, and where the nodes' own inputs are set.
    let changed = set(&plain, "parameters.radius", Value::Float(0.3));
    assert_ne!(said(&changed), said(&plain));
    assert_eq!(said(&changed), said(&set(&on_group, "row.radius", Value::Float(0.3))));
    let at = |document: &Document, input: &str| {
        crate::document::wiring::set_at(document, &socket(input)).to_string()
    };
    assert_eq!(at(&plain, "rows.radius"), "parameters.radius");
    assert_eq!(at(&plain, "rows.offset"), "rows.offset");
    assert_eq!(at(&lifted, "row/rows.radius"), "parameters.radius");
    assert_eq!(at(&document, "row/thin.count"), "row.count");
    assert_eq!(at(&plain, "thin.curves"), "thin.curves", "what is made is set nowhere");
    // A group with nothing to set leaves nothing.
    let (bare, group) = make(&braids(), &ids("rows thin short"), "row").unwrap();
    assert_eq!(set_by_parameters(&bare, &group, "Row").unwrap(), (bare.clone(), None));
    assert!(set_by_parameters(&bare, &id("head"), "Row").is_err());
}

#[test]
fn a_bypassed_group_passes_on_what_comes_in() {
    let (mut document, _) = make(&braids(), &ids("thin short"), "pair").unwrap();
    Edit::SetBypass { id: id("pair"), bypass: true }.apply(&mut document).unwrap();
    let targets = [socket("pair.curves"), socket("rows.curves")];
    let said = evaluated(&document, &targets);
    assert_eq!(said[0], said[1]);
    assert_eq!(ungroup(&document, &id("pair")).unwrap_err(), "pair is bypassed: let it work first");
}

#[test]
fn what_is_wired_to_a_group_and_feeds_nothing_in_it_is_not_evaluated() {
    let (mut document, group) = make(&braids(), &ids("rows thin short"), "row").unwrap();
    let old = document.node("row").unwrap().interface.unwrap();
    let mut inputs = old.inputs().to_vec();
    inputs.push(Port::new("spare", Type::Curves));
    let new = Interface::new(inputs, old.outputs().to_vec()).unwrap();
    set_interface(&document, &group, new, &BTreeMap::new()).unwrap().apply(&mut document).unwrap();
    document.nodes.insert(id("other"), document.nodes["row/thin"].clone());
    document.links.insert(socket("row.spare"), vec![socket("other.curves")]);
    let files = DiskFiles::default();
    let (plan, _) = plan_possible(&document, &[socket("row.curves")], Quality::Final, &files);
    let steps: Vec<&str> = plan.steps.iter().map(|step| step.name.as_str()).collect();
    assert_eq!(steps, ["head", "row/rows", "row/thin"]);
}

#[test]
fn what_is_wrong_with_groups_is_said_with_what_to_do() {
    #[track_caller]
    fn check(text: &str, says: &str) {
        let document = file::read(text).unwrap().document;
        let found: Vec<String> = graph::check(&document).iter().map(Problem::to_string).collect();
        assert_eq!(found.join("\n"), says);
    }
    check(
        r#"(format: 3, nodes: {"a/b": (kind: "head")})"#,
        "a/b: it is in a, and there is no such node; add the group, or remove this node",
    );
    check(
        r#"(format: 3, nodes: {"in": (kind: "group_input")})"#,
        "in: a group_input stands in a group, and this is in none; remove it",
    );
    check(
        r#"(format: 3, nodes: {"a": (kind: "group", interface: (outputs: [(name: "x", type: "curves")]))})"#,
        "a: nothing in it says what it gives; add a group_output in it and wire its outputs",
    );
    check(
        r#"(format: 3, nodes: {"h": (kind: "head"), "a": (kind: "group", nodes: {"s": (kind: "stroke_input")})},
            links: {"a/s.scalp": "h.scalp"})"#,
        "a/s.scalp: a wire from h.scalp crosses the border of a group; give the group an input or an output, and wire these",
    );
    check(
        r#"(format: 3, nodes: {"a": (kind: "group", interface: (inputs: [(name: "x", type: "curves")],
            outputs: [(name: "y", type: "curves")]), links: {"x": "a.y"}, nodes: {
            "in": (kind: "group_input"), "out": (kind: "group_output", links: {"y": "in.x"})})})"#,
        "a: wires run in a circle: a -> a; remove one of these wires",
    );
}

#[test]
fn groups_that_are_an_attack_are_refused_and_nothing_is_lost_in_silence() {
    // 10,000 groups within each other: the reader says where, and stays.
    let deep = |n: usize| {
        let open = "\"a\": (kind: \"group\", nodes: {".repeat(n);
        format!("(format: 3, nodes: {{{open}{}}})", "})".repeat(n))
    };
    let err = file::read(&deep(10_000)).unwrap_err();
    assert!(err.message.contains("nested too deeply"), "{err}");
    let loaded = file::read(&deep(20)).unwrap();
    assert_eq!(loaded.document.nodes.len(), 16);
    expect![[r#"a in a/a/a/a/a/a/a/a/a/a/a/a/a/a/a/a: groups are nested deeper than 16: dropped"#]]
        .assert_eq(&loaded.warnings[0].message);
    // Wires that double at each of 60 steps.
    let steps: String = (0..60)
        .map(|n| {
            let from = if n == 0 { "h".to_owned() } else { format!("p{}", n - 1) };
            format!(
                "\"p{n}\": (kind: \"parameters\", interface: (inputs: [(name: \"scalp\", type: \"scalp\", many: true)]), \
                 links: {{\"scalp\": [\"{from}.scalp\", \"{from}.scalp\"]}}),"
            )
        })
        .collect();
    let text = format!("(format: 3, nodes: {{\"h\": (kind: \"head\"), {steps}}})");
    let document = file::read(&text).unwrap().document;
    let files = DiskFiles::default();
    let targets = [socket("p59.scalp")];
    let (_, refused) = plan_possible(&document, &targets, Quality::Final, &files);
    assert_eq!(
        refused[0].as_ref().unwrap().to_string(),
        "p13: 16384 wires lead to scalp: merge some before"
    );
    // Ports that cannot be are dropped with a word each.
    let text = r#"(format: 3, nodes: {"a": (kind: "group", interface: (inputs: [
        (name: "x", type: "number", default: "much", range: (2, 1)), (name: "x", type: "curves")]))})"#;
    let said: Vec<String> =
        file::read(text).unwrap().warnings.into_iter().map(|said| said.message).collect();
    expect![[r#"
        a: port x: its default "much" is no number: expected a number; write it like 1.5: dropped
        a: port x: its range is 2 to 1: dropped
        a: port x: there is another of this name: dropped"#]]
    .assert_eq(&said.join("\n"));
}
