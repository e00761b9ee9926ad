//! What two people changed, each well, and what does not go together: a circle of wires, a wire that nothing gives.
//!
//! Guarantees: the document that comes out can be evaluated where ours and theirs can: theirs is taken back where both together
//! cannot, and each fact of it is told, in the order of the facts. What harms no evaluation is told, and stays.

use super::conflict::{Clash, Conflict};
use super::fact::{Fact, Facts, Said, document};
use crate::document::graph::{Cycle, Fault, Problem, Severity, check, cycles};
use crate::document::{Document, NodeId, Setting, Socket};
use crate::text::write_value;
use coif_nodes::declared::KINDS;
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

/// What a problem is known by: its kind, its place, and whether it keeps a groom from being evaluated.
type Known = (Fault, NodeId, Option<String>, bool);

fn known(problem: &Problem) -> Known {
    let Problem { fault, node, socket, .. } = problem;
    (*fault, node.clone(), socket.clone(), is_fatal(problem))
}

fn is_fatal(problem: &Problem) -> bool {
    problem.needed && problem.severity == Severity::Error
}

/// So many wires away from a problem what theirs says is taken back, round by round; then everything of all nodes, and what is shown.
const REACH: [usize; 6] = [0, 3, 15, 63, 255, usize::MAX];

/// Puts a merged document together, with what ours says in the place of what keeps it from being evaluated and is wrong in neither.
pub(super) fn settle(
    mut said: Facts,
    own: &Facts,
    sides: [&Document; 2],
) -> (Document, Vec<Conflict>) {
    let known_before: BTreeSet<Known> =
        sides.into_iter().flat_map(check).map(|problem| known(&problem)).collect();
    let mut taken = BTreeMap::<Fact, Conflict>::new();
    let mut rounds = BTreeMap::<(Fault, NodeId, Option<String>), usize>::new();
    loop {
        let mut whole = document(said.clone());
        forget_types(&mut whole);
        let new: Vec<Problem> = check(&whole)
            .into_iter()
            // A value out of range is one person's own.
            .filter(|it| it.fault != Fault::OutOfRange && !known_before.contains(&known(it)))
            .collect();
        let is_left = |problem: &&Problem| {
            let place = (problem.fault, problem.node.clone(), problem.socket.clone());
            is_fatal(problem) && rounds.get(&place).is_none_or(|round| *round <= REACH.len() + 1)
        };
        let Some(problem) = new.iter().find(is_left) else {
            let mut conflicts: Vec<Conflict> = taken.into_values().collect();
            conflicts.extend(new.iter().map(told));
            return (whole, conflicts);
        };
        let place = (problem.fault, problem.node.clone(), problem.socket.clone());
        let round = rounds.entry(place).or_default();
        let mut facts: BTreeSet<Fact> =
            match (*round, round.checked_sub(1).and_then(|n| REACH.get(n))) {
                (0, _) => own_facts(&whole, problem),
                (_, Some(wires)) => facts_about(&problem.node, *wires, [&said, own]),
                (_, None) => {
                    let all = said.keys().chain(own.keys()).filter(|fact| fact.node().is_some());
                    all.filter(|fact| !stays(fact)).cloned().chain([Fact::Display]).collect()
                }
            };
        *round += 1;
        // What shows a node that is taken back is taken back with it.
        if let Some(Said::Node(id)) = said.get(&Fact::Display) {
            let kind = Fact::Kind(id.clone());
            if facts.contains(&kind) && !own.contains_key(&kind) {
                facts.insert(Fact::Display);
            }
        }
        for fact in facts {
            let (now, ours) = (said.get(&fact).cloned(), own.get(&fact).cloned());
            if now == ours {
                continue;
            }
            match &ours {
                Some(ours) => drop(said.insert(fact.clone(), ours.clone())),
                None => drop(said.remove(&fact)),
            }
            let conflict = || {
                let clash = Clash::Together(words(problem));
                Conflict { fact: fact.clone(), base: None, ours, theirs: now, clash }
            };
            taken.entry(fact.clone()).or_insert_with(conflict);
        }
    }
}

fn words(problem: &Problem) -> String {
    format!("{}; {}", problem.text, problem.remedy)
}

/// A problem of both together that stays.
fn told(problem: &Problem) -> Conflict {
    let fact = match &problem.socket {
        Some(name) => Fact::Wires(Socket::new(problem.node.clone(), name)),
        None => Fact::Kind(problem.node.clone()),
    };
    let clash = Clash::Together(words(problem));
    Conflict { fact, base: None, ours: None, theirs: None, clash }
}

/// The facts that a problem names.
fn own_facts(whole: &Document, problem: &Problem) -> BTreeSet<Fact> {
    if problem.fault == Fault::Cycle {
        let all = cycles(whole).into_iter();
        let circle = all.map(|Cycle(nodes)| nodes).find(|nodes| nodes[0] == problem.node);
        let circle: BTreeSet<NodeId> = circle.into_iter().flatten().collect();
        let within = |(to, from): &(&Socket, &Vec<Socket>)| {
            circle.contains(&to.node) && from.iter().any(|from| circle.contains(&from.node))
        };
        return whole.links.iter().filter(within).map(|(to, _)| Fact::Wires(to.clone())).collect();
    }
    let Some(name) = &problem.socket else { return BTreeSet::new() };
    let id = &problem.node;
    [Fact::Input(id.clone(), name.clone()), Fact::Wires(Socket::new(id.clone(), name))].into()
}

/// Whether nobody needs it for evaluating.
fn stays(fact: &Fact) -> bool {
    matches!(fact, Fact::Comment(_)) || fact.is_canvas()
}

/// All facts about the nodes within `wires` wires of a node. A group whose ports changed counts as one node with its contents.
fn facts_about(id: &NodeId, wires: usize, both: [&Facts; 2]) -> BTreeSet<Fact> {
    let mut beside = BTreeMap::<&NodeId, BTreeSet<&NodeId>>::new();
    for (fact, said) in both.into_iter().flatten() {
        let Fact::Wires(to) = fact else { continue };
        for from in said.sources() {
            beside.entry(&to.node).or_default().insert(&from.node);
            beside.entry(&from.node).or_default().insert(&to.node);
        }
    }
    let ports = |id: &NodeId| both.map(|facts| facts.get(&Fact::Ports(id.clone())));
    let whole = |id: &NodeId| {
        let around = std::iter::successors(Some(id.clone()), NodeId::group);
        let changed = around.filter(|group| ports(group)[0] != ports(group)[1]);
        changed.last().unwrap_or_else(|| id.clone())
    };
    let (mut found, mut edge) = (BTreeSet::from([id.clone()]), vec![id.clone()]);
    for _ in 0..wires {
        let beside = edge.iter().flat_map(|id| beside.get(id).into_iter().flatten().copied());
        let next: BTreeSet<NodeId> =
            beside.cloned().chain(edge.iter().filter_map(NodeId::group)).collect();
        edge = next.into_iter().filter(|id| found.insert(id.clone())).collect();
        if edge.is_empty() {
            break;
        }
    }
    let found: BTreeSet<NodeId> = found.iter().map(whole).collect();
    let counts =
        |fact: &&Fact| !stays(fact) && fact.node().is_some_and(|id| found.contains(&whole(id)));
    both.into_iter().flat_map(Facts::keys).filter(counts).cloned().collect()
}

/// A value that one set on a port which the other took away is text that nothing reads, as in a file.
fn forget_types(document: &mut Document) {
    let declared: Vec<NodeId> = document
        .nodes
        .iter()
        .filter(|(_, node)| KINDS.contains(&node.kind.as_str()))
        .map(|(id, _)| id.clone())
        .collect();
    for id in declared {
        let def = document.def(&id);
        let Some(node) = document.nodes.get_mut(&id) else { continue };
        let is_read = |name: &str| def.is_some_and(|def| def.input(name).is_some());
        if node.inputs.keys().all(|name| is_read(name)) {
            continue;
        }
        for (name, setting) in &mut Arc::make_mut(node).inputs {
            if let (Setting::Known(value), false) = (&*setting, is_read(name)) {
                *setting = Setting::Raw(write_value(value).into());
            }
        }
    }
}
