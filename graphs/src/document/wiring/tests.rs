//! Healing, inserting and changing kinds, on a groom and on broken documents.

use super::*;
use crate::document::Point;
use expect_test::{Expect, expect};

fn id(text: &str) -> NodeId {
    NodeId::new(text).unwrap()
}
fn ids(text: &str) -> BTreeSet<NodeId> {
    text.split_whitespace().map(id).collect()
}
fn socket(text: &str) -> Socket {
    text.parse().unwrap()
}
/// Rows, their braid and parting hairs, merged and handed out.
fn cornrows() -> Document {
    let text = r#"(format: 1, display: "braid", nodes: {
        "head": (kind: "head"), "rows": (kind: "stroke_input", inputs: {"seed": 5, "radius": 2}),
        "braid": (kind: "lissajous_braid", label: "front", note: "n", inputs: {"strands": 4, "seed": 9}),
        "hair": (kind: "cluster_to_strands"), "edges": (kind: "edge_partition"),
        "all": (kind: "merge"), "out": (kind: "groom_output"), "new": (kind: "of_tomorrow"),
        "thin": (kind: "resample"),
    }, links: {
        "rows.scalp": "head.scalp", "braid.source": "rows.curves", "braid.scalp": "head.scalp",
        "hair.curves": "braid.curves", "hair.scalp": "head.scalp",
        "edges.source": "rows.curves", "edges.scalp": "head.scalp", "edges.stitches": "braid.stitches",
        "all.curves": ["hair.curves", "edges.curves"], "out.curves": "all.curves",
    }, bends: {"hair.curves": [[(1, 2)]], "all.curves": [[], [(3, 4)]]})"#;
    crate::file::read(text).unwrap().document
}
/// The wires after an edit that must go through and be taken back exactly.
fn wires(document: &Document, edit: &Edit) -> (Document, String) {
    let mut after = document.clone();
    let undo = edit.apply(&mut after).unwrap_or_else(|err| panic!("{edit:?}: {err}"));
    let mut back = after.clone();
    undo.apply(&mut back).unwrap();
    assert_eq!(back, *document);
    let changed = after.links.iter().filter(|(to, from)| document.links.get(to) != Some(from));
    let gone = document.links.keys().filter(|to| !after.links.contains_key(to));
    let said = changed.map(|(to, from)| format!("{to} <- {from:?}\n"));
    let gone = gone.map(|to| format!("{to} <- nothing\n"));
    let said = said.chain(gone).collect();
    (after, said)
}
#[track_caller]
fn check(edit: &Edit, want: Expect) -> Document {
    let (after, said) = wires(&cornrows(), edit);
    want.assert_eq(&said);
    after
}

#[test]
fn a_removed_node_is_bridged_where_types_fit() {
    let after = check(
        &remove_healed(&cornrows(), &ids("braid")),
        expect![[r#"
        hair.curves <- [rows.curves]
        braid.scalp <- nothing
        braid.source <- nothing
        edges.stitches <- nothing
    "#]],
    );
    assert_eq!(after.display, Some(id("rows")));
    check(
        &remove_healed(&cornrows(), &ids("braid hair")),
        expect![[r#"
        all.curves <- [rows.curves, edges.curves]
        braid.scalp <- nothing
        braid.source <- nothing
        edges.stitches <- nothing
        hair.curves <- nothing
        hair.scalp <- nothing
    "#]],
    );
    check(
        &remove_healed(&cornrows(), &ids("head")),
        expect![[r#"
        braid.scalp <- nothing
        edges.scalp <- nothing
        hair.scalp <- nothing
        rows.scalp <- nothing
    "#]],
    );
    // Both ways to the same hair: it is not merged with itself.
    check(
        &remove_healed(&cornrows(), &ids("braid hair edges")),
        expect![[r#"
        all.curves <- [rows.curves]
        braid.scalp <- nothing
        braid.source <- nothing
        edges.scalp <- nothing
        edges.source <- nothing
        edges.stitches <- nothing
        hair.curves <- nothing
        hair.scalp <- nothing
    "#]],
    );
    check(
        &remove_healed(&cornrows(), &ids("out thin nobody")),
        expect![[r#"
        out.curves <- nothing
    "#]],
    );
}

#[test]
fn a_disconnected_node_stays_and_is_bridged() {
    let after = check(
        &disconnect(&cornrows(), &ids("braid")),
        expect![[r#"
        hair.curves <- [rows.curves]
        braid.scalp <- nothing
        braid.source <- nothing
        edges.stitches <- nothing
    "#]],
    );
    assert_eq!((after.nodes.len(), after.display), (9, Some(id("braid"))));
}

#[test]
fn a_node_dropped_on_a_wire_stands_between_its_ends_or_says_why_not() {
    let document = cornrows();
    let on = |node: &str, to: &str, at| insert_on_wire(&document, &id(node), &socket(to), at);
    check(
        &on("thin", "all.curves", 1).unwrap(),
        expect![[r#"
        all.curves <- [hair.curves, thin.curves]
        thin.curves <- [edges.curves]
    "#]],
    );
    check(
        &on("thin", "hair.curves", 0).unwrap(),
        expect![[r#"
        hair.curves <- [thin.curves]
        thin.curves <- [braid.curves]
    "#]],
    );
    let why = [
        on("thin", "hair.scalp", 0),
        on("head", "hair.curves", 0),
        on("all", "hair.curves", 0),
        on("hair", "hair.curves", 0),
        on("new", "hair.curves", 0),
        on("gone", "hair.curves", 0),
        on("thin", "all.curves", 2),
    ];
    expect![[r#"
        Resample takes no scalp
        Head takes no curves
        other wires end at all.curves
        Cluster to strands is an end of this wire
        nobody knows what "of_tomorrow" takes
        there is no node gone
        all.curves has no wire 2"#]]
    .assert_eq(&why.map(Result::unwrap_err).join("\n"));
}

#[test]
fn a_node_of_a_chain_dropped_on_a_wire_leaves_the_chain_healed() {
    let document = cornrows();
    let on = |node: &str, to: &str, at| insert_on_wire(&document, &id(node), &socket(to), at);
    // From before the merge to behind it: what it fed takes what fed it.
    check(
        &on("hair", "out.curves", 0).unwrap(),
        expect![[r#"
        all.curves <- [braid.curves, edges.curves]
        hair.curves <- [all.curves]
        out.curves <- [hair.curves]
    "#]],
    );
    let branch = branch_from_wire(&document, &id("hair"), &socket("out.curves"), 0);
    assert!(branch.unwrap_err().contains("circle"));
    let branch = branch_from_wire(&document, &id("thin"), &socket("out.curves"), 0);
    check(
        &branch.unwrap(),
        expect![[r#"
        thin.curves <- [all.curves]
    "#]],
    );
}

#[test]
fn a_node_put_behind_an_output_takes_all_that_it_fed() {
    let mut document = cornrows();
    let behind = |document: &Document, node: &str, from: &str| {
        insert_behind(document, &id(node), &socket(from))
    };
    document.links.insert(socket("thin.curves"), vec![socket("braid.curves")]);
    let edit = behind(&document, "thin", "braid.curves").unwrap().unwrap();
    let mut after = document.clone();
    edit.apply(&mut after).unwrap();
    assert_eq!(after.wires(&id("hair"), "curves"), [socket("thin.curves")]);
    assert_eq!(after.wires(&id("thin"), "curves"), [socket("braid.curves")]);
    // What takes something else stays where it is, and circles are refused.
    assert_eq!(behind(&document, "thin", "out.curves"), Ok(None));
    let both = vec![socket("rows.curves"), socket("hair.curves")];
    document.links.insert(socket("all.curves"), both);
    assert!(behind(&document, "all", "rows.curves").unwrap_err().contains("circle"));
}

#[test]
fn without_hair_a_head_and_its_masks_stay_and_regions_go() {
    let text = r#"(format: 1, title: "x", display: "fill", nodes: {
        "bust": (kind: "head"), "mask": (kind: "paint_mask"), "lines": (kind: "stroke_input"),
        "cut": (kind: "partings"), "fill": (kind: "interpolate"), "out": (kind: "groom_output"),
        "beard": (kind: "region"), "stubble": (kind: "scatter_guides"),
    }, links: {
        "mask.scalp": "bust.scalp", "lines.scalp": "bust.scalp", "cut.scalp": "bust.scalp",
        "beard.scalp": "bust.scalp", "stubble.scalp": "beard.scalp", "cut.lines": "lines.curves", "fill.scalp": "cut.scalp", "fill.mask": "mask.mask",
        "fill.guides": "lines.curves", "out.curves": "fill.curves",
    })"#;
    let document = crate::file::read(text).unwrap().document;
    let bare = without_hair(&document, Hair::All);
    assert_eq!(bare.nodes.keys().cloned().collect::<BTreeSet<_>>(), ids("bust mask"));
    assert!(has_hair(&document, Hair::All) && !has_hair(&bare, Hair::All));
    assert_eq!((bare.display, bare.links.len(), bare.title), (None, 1, document.title.clone()));
}

#[test]
fn hair_of_the_head_goes_without_the_hair_of_regions() {
    let text = r#"(format: 1, title: "x", nodes: {
        "bust": (kind: "head"), "fill": (kind: "scatter_guides"), "out": (kind: "groom_output"),
        "outline": (kind: "stroke_input"), "brow": (kind: "region"), "brows": (kind: "scatter_guides"),
        "all": (kind: "merge"), "brows_out": (kind: "groom_output"),
        "bare": (kind: "region", inputs: {"side": "outside"}), "all_out": (kind: "groom_output"),
    }, links: {
        "outline.scalp": "bust.scalp", "brow.scalp": "bust.scalp", "brow.outlines": "outline.curves",
        "brows.scalp": "brow.scalp", "brows_out.curves": "brows.curves",
        "bare.scalp": "bust.scalp", "fill.scalp": "bare.scalp", "out.curves": "fill.curves",
        "all.curves": ["fill.curves", "brows.curves"], "all_out.curves": "all.curves",
    })"#;
    let document = crate::file::read(text).unwrap().document;
    assert!(has_hair(&document, Hair::OfHead));
    let bare = without_hair(&document, Hair::OfHead);
    let left = ids("bust outline brow brows all brows_out bare all_out");
    assert_eq!(bare.nodes.keys().cloned().collect::<BTreeSet<_>>(), left);
    assert_eq!(bare.wires(&id("all"), "curves"), [socket("brows.curves")]);
    assert!(has_hair(&bare, Hair::All) && !has_hair(&bare, Hair::OfHead));
    assert_eq!(without_hair(&bare, Hair::OfHead), bare);
}

#[test]
fn another_kind_keeps_what_fits() {
    let document = cornrows();
    let edit = change_kind(&document, &id("braid"), "shape_list_curl").unwrap();
    let after = check(
        &edit,
        expect![[r#"
        braid.curves <- [rows.curves]
        edges.stitches <- [braid.curves]
        braid.source <- nothing
    "#]],
    );
    let node = after.node("braid").unwrap();
    assert_eq!((node.label.as_deref(), &*node.note), (Some("front"), "n"));
    assert_eq!(after.bends_of(&socket("hair.curves"), 0), [Point(1.0, 2.0)]);
    let node = change_kind(&document, &id("rows"), "scatter_guides").unwrap();
    let after = check(&node, expect![[r#""#]]);
    let seed = Setting::Known(5i64.into());
    assert_eq!(after.node("rows").unwrap().inputs["seed"], seed);
    check(
        &change_kind(&document, &id("all"), "resample").unwrap(),
        expect![[r#"
        all.curves <- [hair.curves]
    "#]],
    );
    check(
        &change_kind(&document, &id("braid"), "head").unwrap(),
        expect![[r#"
        braid.scalp <- nothing
        braid.source <- nothing
        edges.stitches <- nothing
        hair.curves <- nothing
    "#]],
    );
    assert!(change_kind(&document, &id("braid"), "of_tomorrow").is_err());
    assert!(change_kind(&document, &id("gone"), "head").is_err());
}

#[test]
fn every_kind_becomes_every_other_and_all_can_be_taken_back() {
    let document = cornrows();
    for (name, to) in document.nodes.keys().flat_map(|n| coif_nodes::all().map(move |k| (n, k))) {
        let (after, _) = wires(&document, &change_kind(&document, name, to.id).unwrap());
        let problems = graph::check(&after);
        let bad = |fault| problems.iter().find(|problem| problem.fault == fault);
        for fault in
            [graph::Fault::WrongType, graph::Fault::TooManyWires, graph::Fault::UnknownInput]
        {
            assert_eq!(bad(fault), None, "{name} to {}", to.id);
        }
        for nodes in
            [ids(name.as_str()), ids(&format!("{name} rows")), ids(&format!("{name} hair all"))]
        {
            let (after, _) = wires(&after, &remove_healed(&after, &nodes));
            wires(&after, &disconnect(&after, &ids("edges")));
            assert!(!graph::check(&after).iter().any(|p| p.fault == graph::Fault::WrongType));
        }
    }
}

#[test]
fn broken_documents_are_healed_without_end_or_panic() {
    for seed in 0..100 {
        let document = crate::document::testing::Random::new(seed).document();
        for nodes in [ids("a"), ids("a b"), ids("a b c d"), ids("e_1 far_away")] {
            wires(&document, &remove_healed(&document, &nodes));
            wires(&document, &disconnect(&document, &nodes));
        }
        for to in document.links.keys() {
            if let Ok(edit) = insert_on_wire(&document, &id("a"), to, 0) {
                wires(&document, &edit);
            }
        }
        if let Ok(edit) = change_kind(&document, &id("b"), "merge") {
            wires(&document, &edit);
        }
    }
}

#[test]
fn a_loose_wire_says_what_an_edit_would_say() {
    let mut random = crate::document::testing::Random::new(3);
    for _ in 0..400 {
        let document = cornrows();
        let sockets: Vec<Socket> = document
            .nodes
            .iter()
            .filter_map(|(id, node)| Some((id, coif_nodes::by_id(&node.kind)?)))
            .flat_map(|(id, def)| {
                let outputs = def.outputs.iter().map(|output| output.name);
                let names = def.inputs.iter().map(|input| input.name).chain(outputs);
                names.map(|name| Socket::new(id.clone(), name)).collect::<Vec<_>>()
            })
            .collect();
        let (from, to) = (random.pick(&sockets), random.pick(&sockets));
        let can = graph::wire_problem(&document, &from, &to).is_none();
        let out = LooseWire::from_output(&document, from.clone()).reason(&to);
        let back = LooseWire::from_input(&document, to.clone()).reason(&from);
        assert_eq!(out, back);
        assert_eq!(out.is_none(), can, "{from} {to}: {out:?}");
    }
    let document = cornrows();
    let loose = LooseWire::from_output(&document, socket("all.curves"));
    let why = ["rows.scalp", "braid.source", "all.curves", "thin.curves"];
    let why = why.map(|to| format!("{:?}", loose.reason(&socket(to))));
    expect![[r#"
        Some("all.curves gives curves, scalp is taken")
        Some("wires would run in a circle: front feeds Merge")
        Some("a node cannot feed itself")
        None"#]]
    .assert_eq(&why.join("\n"));
}

#[test]
fn a_dropped_wire_finds_the_kinds_that_it_fits_and_they_can_be_wired() {
    let document = cornrows();
    for from in ["head.scalp", "braid.curves"] {
        let kinds = kinds_taking(&document, &socket(from));
        assert!(kinds.len() > 5);
        for (def, input) in kinds {
            let mut document = document.clone();
            let node = document.fresh_node(def.id, &id("fresh")).into();
            let add = Edit::AddNode { id: id("fresh"), node, at: None };
            add.apply(&mut document).unwrap();
            let to = Socket::new(id("fresh"), input.name);
            Edit::Connect { from: socket(from), to, at: None }.apply(&mut document).unwrap();
        }
    }
    let names = |to: &str| {
        let kinds = kinds_giving(&document, &socket(to));
        kinds.iter().map(|(def, out)| format!("{}.{}", def.id, out.name)).collect::<Vec<_>>()
    };
    assert_eq!(names("rows.scalp"), ["head.scalp", "region.scalp", "partings.scalp"]);
    assert!(names("hair.curves").contains(&"lissajous_braid.curves".to_owned()));
    assert_eq!(kinds_taking(&document, &socket("new.out")).len(), 0);
}
