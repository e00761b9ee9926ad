//! What the outliner lists: rows from documents and curves. Pure; knows no window.

use crate::core::shown::displayed;
use crate::core::state::State;
use coif_graphs::document::graph;
use coif_graphs::document::{Document, Node, NodeId};
use coif_nodes::data::attributes::{BRAID, PARENT, SIDE, STITCH, STRAND};
use coif_nodes::data::curves::{Curves, Tuft};
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

/// What a row stands for.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Item {
    /// A head, an output, or a node that made something.
    Node(NodeId),
    /// The nodes that made an output's hair.
    Makers(NodeId),
    /// All hair of an output that belongs to one braid.
    Braid(NodeId, u64),
    /// All hair of an output that runs from beside a braid into it.
    Beside(NodeId, u64),
    /// One strand of a braid.
    Strand(NodeId, u64, i32),
    /// All hair of an output made from one curve.
    Parent(NodeId, u64),
}

/// A line of the tree.
#[derive(Clone, Debug)]
pub(super) struct TreeRow {
    pub(super) item: Item,
    /// The output that it stands below, which makes rows of one node tell apart.
    pub(super) under: Option<NodeId>,
    pub(super) depth: usize,
    pub(super) name: String,
    /// What it is, in a word or two.
    pub(super) kind: String,
    pub(super) curves: Option<usize>,
    /// Whether what is below it is shown; none where nothing is.
    pub(super) open: Option<bool>,
    /// What its hair is called by, for eyes, locks and isolating; empty where it has none of its own.
    pub(super) names: Vec<u64>,
}

/// Hair that belongs together.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(super) struct Group {
    pub(super) curves: usize,
    /// By strand: how many curves, and what they are called by.
    pub(super) strands: BTreeMap<i32, (usize, BTreeSet<u64>)>,
}

/// How the hair of an output belongs together.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Groups {
    /// Hair of braids, and hair that runs into braids from beside them, both by braid.
    Braids(BTreeMap<u64, Group>, BTreeMap<u64, Group>),
    Parents(BTreeMap<u64, usize>),
    None,
}

/// What rows are made from.
pub(super) struct Tree<'a> {
    pub(super) state: &'a State,
    /// How the hair of each output belongs together.
    pub(super) groups: &'a BTreeMap<NodeId, Groups>,
    /// What was opened or closed by hand.
    pub(super) open: &'a BTreeMap<Item, bool>,
    pub(super) filter: &'a str,
}

impl Tree<'_> {
    fn is_open(&self, item: &Item, at_first: bool) -> bool {
        !self.filter.is_empty() || self.open.get(item).copied().unwrap_or(at_first)
    }

    /// The rows, from the top.
    pub(super) fn rows(&self, outputs: &[NodeId]) -> Vec<TreeRow> {
        let state = self.state;
        let document = &state.document;
        let mut all = vec![];
        let heads = document.nodes.iter().filter(|(_, node)| node.is_head());
        for (id, _) in heads {
            all.push(node_row(state, id, None, 0, None, vec![]));
        }
        for id in outputs {
            self.output(id, &mut all);
        }
        if self.filter.trim().is_empty() {
            return all;
        }
        // What is asked for, and what it stands below.
        let asked: Vec<bool> = all.iter().map(|row| fits(self.filter, &row.name)).collect();
        let mut keep = asked.clone();
        for i in 0..all.len() {
            if !asked[i] {
                continue;
            }
            let mut depth = all[i].depth;
            for j in (0..i).rev() {
                if all[j].depth < depth {
                    keep[j] = true;
                    depth = all[j].depth;
                }
            }
        }
        all.into_iter().zip(keep).filter(|(_, keep)| *keep).map(|(row, _)| row).collect()
    }

    fn output(&self, id: &NodeId, all: &mut Vec<TreeRow>) {
        let state = self.state;
        let document = &state.document;
        let groups = self.groups.get(id).unwrap_or(&Groups::None);
        let names = match groups {
            Groups::Braids(braids, beside) => braids.keys().chain(beside.keys()).copied().collect(),
            Groups::Parents(parents) => parents.keys().copied().collect(),
            Groups::None => vec![],
        };
        let item = Item::Node(id.clone());
        let open = self.is_open(&item, true);
        all.push(node_row(state, id, None, 0, Some(open), names));
        if !open {
            return;
        }
        let under = Some(id.clone());
        let row = |item: Item, depth, name, curves, open, names| TreeRow {
            item,
            under: under.clone(),
            depth,
            name,
            kind: String::new(),
            curves,
            open,
            names,
        };
        match groups {
            Groups::None => {}
            Groups::Parents(parents) => {
                for (n, (parent, curves)) in parents.iter().enumerate() {
                    let item = Item::Parent(id.clone(), *parent);
                    let (name, names) = (format!("Cluster {}", n + 1), vec![*parent]);
                    all.push(row(item, 1, name, Some(*curves), None, names));
                }
            }
            Groups::Braids(braids, beside) => {
                for (n, (braid, group)) in braids.iter().enumerate() {
                    let item = Item::Braid(id.clone(), *braid);
                    let many = group.strands.len() > 1;
                    let open = many.then(|| self.is_open(&item, false));
                    let (name, names) = (format!("Braid {}", n + 1), vec![*braid]);
                    all.push(row(item, 1, name, Some(group.curves), open, names));
                    if open != Some(true) {
                        continue;
                    }
                    for (strand, (curves, names)) in &group.strands {
                        let item = Item::Strand(id.clone(), *braid, *strand);
                        let name = format!("Strand {}", strand + 1);
                        let names = names.iter().copied().collect();
                        all.push(row(item, 2, name, Some(*curves), None, names));
                    }
                }
                // Called by what it is: some belongs to braids of other outputs.
                for (n, (braid, group)) in beside.iter().enumerate() {
                    let item = Item::Beside(id.clone(), *braid);
                    let name = format!("Parting hairs {}", n + 1);
                    let names = group.strands.values().flat_map(|(_, names)| names).copied();
                    all.push(row(item, 1, name, Some(group.curves), None, names.collect()));
                }
            }
        }
        let upstream = graph::upstream(document, [id]);
        let order = graph::order(document).unwrap_or_else(|_| upstream.iter().cloned().collect());
        let is_head = |node: &NodeId| document.node(node.as_str()).is_some_and(|n| n.is_head());
        let makers: Vec<&NodeId> = order
            .iter()
            .rev()
            .filter(|node| *node != id && upstream.contains(*node) && !is_head(node))
            .collect();
        if makers.is_empty() {
            return;
        }
        let item = Item::Makers(id.clone());
        let open = self.is_open(&item, matches!(groups, Groups::None));
        let name = format!("Made by {}", crate::words::counted(makers.len(), "node"));
        all.push(row(item, 1, name, None, Some(open), vec![]));
        if open {
            for node in makers {
                all.push(node_row(state, node, Some(id.clone()), 2, None, vec![]));
            }
        }
    }
}

fn node_row(
    state: &State,
    id: &NodeId,
    under: Option<NodeId>,
    depth: usize,
    open: Option<bool>,
    names: Vec<u64>,
) -> TreeRow {
    let kind = state.document.node(id.as_str()).map_or("", |node| node.kind.as_str());
    let label = state.document.def(id).map_or(kind, |def| def.label);
    let name = state.document.name_of(id).into_owned();
    let count = |id: &NodeId| state.run.reports.nodes.get(id).map(|report| report.curves);
    // An output that is not displayed gives what comes in, which may be.
    let comes_in = || {
        let from = state.document.wires(id, "curves");
        let from = Some(from).filter(|from| kind == "groom_output" && !from.is_empty())?;
        from.iter().map(|from| count(&from.node)).sum::<Option<usize>>()
    };
    TreeRow {
        item: Item::Node(id.clone()),
        under,
        depth,
        kind: if name == label { String::new() } else { label.to_lowercase() },
        name,
        curves: count(id).or_else(comes_in).filter(|curves| *curves > 0),
        open,
        names,
    }
}

/// The outputs of a groom; where it has none, the nodes that are displayed. Heads have rows of their own.
pub(super) fn outputs(document: &Document) -> Vec<NodeId> {
    let output = |(id, node): (&NodeId, _)| {
        let node: &Arc<Node> = node;
        (node.kind == "groom_output").then(|| id.clone())
    };
    let found: Vec<NodeId> = document.nodes.iter().filter_map(output).collect();
    if !found.is_empty() {
        return found;
    }
    let is_head = |id: &NodeId| document.node(id.as_str()).is_some_and(|node| node.is_head());
    displayed(document).into_iter().map(|socket| socket.node).filter(|id| !is_head(id)).collect()
}

/// The strand of hair that runs into a braid from beside it.
pub(super) const BESIDE: i32 = -1;

/// What a curve belongs to: its braid and strand, and its parent.
pub(super) fn kin(tuft: &Tuft, i: usize) -> (u64, i32, u64) {
    let first = tuft.offsets()[i] as usize;
    let (braid, strand) = (tuft.view(BRAID).at(i, first), tuft.view(STRAND).at(i, first));
    // Parting hairs lie on a side of their row, and join no stitch of the braid.
    let beside = tuft.view(SIDE).at(i, first) != 0 && tuft.view(STITCH).at(i, first) < 0;
    (braid, if beside { BESIDE } else { strand }, tuft.view(PARENT).at(i, first))
}

/// How curves belong together: by braid where they have one, else by parent where that says something.
pub(super) fn groups(curves: &Curves) -> Groups {
    let (mut braids, mut beside) = (BTreeMap::<u64, Group>::new(), BTreeMap::<u64, Group>::new());
    let mut parents = BTreeMap::<u64, usize>::new();
    for (tuft, i) in curves.each() {
        let (braid, strand, parent) = kin(tuft, i);
        if braid != 0 {
            let runs_in = strand == BESIDE;
            let of = if runs_in { &mut beside } else { &mut braids };
            let group = of.entry(braid).or_default();
            group.curves += 1;
            let (count, names) = group.strands.entry(strand).or_default();
            *count += 1;
            // Hair beside a braid has the row for a parent, as the braid's own hair may have: it goes by its own id.
            names.insert(if parent == 0 || runs_in { tuft.id(i) } else { parent });
        }
        if parent != 0 {
            *parents.entry(parent).or_default() += 1;
        }
    }
    if !braids.is_empty() || !beside.is_empty() {
        return Groups::Braids(braids, beside);
    }
    match parents.len() {
        0 => Groups::None,
        _ => Groups::Parents(parents),
    }
}

/// Whether a name fits a pattern: a part of it, or with `*` and `?` all of it. Letter case does not count.
pub(super) fn fits(pattern: &str, name: &str) -> bool {
    let (pattern, name) = (pattern.trim().to_lowercase(), name.to_lowercase());
    if !pattern.contains(['*', '?']) {
        return name.contains(&pattern);
    }
    let (pattern, name): (Vec<char>, Vec<char>) =
        (pattern.chars().collect(), name.chars().collect());
    let (mut p, mut n) = (0, 0);
    // The last star, and how much of the name it takes.
    let mut star: Option<(usize, usize)> = None;
    while n < name.len() {
        if p < pattern.len() && (pattern[p] == '?' || pattern[p] == name[n]) && pattern[p] != '*' {
            (p, n) = (p + 1, n + 1);
        } else if p < pattern.len() && pattern[p] == '*' {
            star = Some((p, n));
            p += 1;
        } else if let Some((at, taken)) = star {
            star = Some((at, taken + 1));
            (p, n) = (at + 1, taken + 1);
        } else {
            return false;
        }
    }
    pattern[p..].iter().all(|c| *c == '*')
}
