//! Renamed ports in a merge: values and wires follow a port to its new name.
//!
//! Before three documents are merged, each is rewritten for the ports that the merged groups and parameters will have. One branch can
//! therefore upgrade a template while another sets or wires its ports, without a conflict. As in an upgrade, a value is lost if its
//! port is gone or takes another type.
//!
//! Guarantees: facts about unchanged ports are unchanged, and merging either way round gives the same result, unless two interfaces
//! contradict each other; then ours wins. Wires from an output that is gone are left as they are.

use super::diff::Change;
use super::fact::{Fact, Facts, Said, Wire};
use super::items::one;
use super::ports::{Called, called, merged};
use crate::document::{FileEntry, NodeId, Setting, Socket};
use crate::text::proven_value;
use crate::values;
use coif_nodes::declared::{GROUP, GROUP_INPUT, GROUP_OUTPUT, Interface, Port};
use std::collections::BTreeMap;

/// A port as a side calls it, and what became of it.
struct Renamed {
    /// Its name in the base; `None` if it was added since.
    before: Option<String>,
    /// `None` if it was removed.
    now: Option<&'static Port>,
}

/// The ports of a node on one side, by their names there.
type Names = BTreeMap<&'static str, Renamed>;

/// What became of the ports of a side: for each node its inputs and its outputs.
type Renames = BTreeMap<NodeId, [Names; 2]>;

const INPUTS: usize = 0;
const OUTPUTS: usize = 1;

/// Base, ours and theirs with the ports that the merged document will have, and what ours and theirs set or wired that no port takes
/// any more: each from what the base said to what that side says, by the name that the port had there.
pub(super) fn follow(all: [Facts; 3]) -> ([Facts; 3], Vec<Change>) {
    let renames = renames(all.each_ref());
    let mut lost = vec![];
    let told = [0, 1, 2].map(|side| {
        renamed(&all[side], &renames[side], |fact, before| {
            let from = before.and_then(|before| all[0].get(&before));
            let to = all[side].get(fact);
            // What only the other took away was never this side's own.
            if side > 0 && from != to {
                let (from, to) = (from.cloned(), to.cloned());
                lost.push(Change { fact: fact.clone(), from, to });
            }
            false
        })
    });
    lost.sort_by(|a, b| a.fact.cmp(&b.fact));
    lost.dedup();
    (told, lost)
}

/// What a document says, with the ports that a later one has, but for what these do not take, which is as it was.
pub(super) fn led_to(before: &Facts, later: &Facts) -> Facts {
    let [_, renames, _] = renames([before, before, later]);
    renamed(before, &renames, |_, _| true)
}

/// The facts of a side by the names that ports have now. Of what no port takes, the function is asked whether it stays, given what the
/// base calls it.
fn renamed(
    side: &Facts,
    renames: &Renames,
    mut stays: impl FnMut(&Fact, Option<Fact>) -> bool,
) -> Facts {
    if renames.is_empty() {
        return side.clone();
    }
    let mut told = Facts::new();
    for (fact, said) in side {
        let (followed, before) = fact_now(fact, side, renames);
        let taken = match (followed, said) {
            (Followed::Gone, _) => None,
            (Followed::Is(fact, Some(port)), Said::Setting(setting)) => {
                fitting(port, setting).map(|setting| (fact, Said::Setting(setting)))
            }
            (Followed::Is(fact, _), said) => Some((fact, with_sources(said, side, renames))),
        };
        match taken {
            Some((now, said)) => drop(told.insert(now, said)),
            None if stays(fact, before) => drop(told.insert(fact.clone(), said.clone())),
            None => {}
        }
    }
    told
}

/// What became of ports on each side, where all three have the node and do not say the same of it.
fn renames(all: [&Facts; 3]) -> [Renames; 3] {
    let mut found = [(); 3].map(|()| Renames::new());
    for (fact, said) in all[0] {
        let (Fact::Ports(id), Said::Ports(base)) = (fact, said) else { continue };
        let (Some(Said::Ports(ours)), Some(Said::Ports(theirs))) =
            (all[1].get(fact), all[2].get(fact))
        else {
            continue;
        };
        let three = [*base, *ours, *theirs];
        // Where both changed it and contradict each other, ours stays.
        let now = one(PartialEq::eq, base, ours, theirs)
            .or_else(|| merged(*base, *ours, *theirs))
            .unwrap_or(*ours);
        for (found, side) in found.iter_mut().zip(three) {
            if side != now {
                let sides: [fn(Interface) -> &'static [Port]; 2] =
                    [Interface::inputs, Interface::outputs];
                let names = sides.map(|of| names(of(*base), of(side), of(now)));
                found.insert(id.clone(), names);
            }
        }
    }
    found
}

fn names(base: &'static [Port], side: &'static [Port], now: &'static [Port]) -> Names {
    let of_now: BTreeMap<Called, &Port> = called(base, now).into_iter().zip(now).collect();
    let one = |(port, called): (&'static Port, Called)| {
        let now = of_now.get(&called).copied();
        let before = if let Called::Before(name) = called { Some(name) } else { None };
        (port.name.as_str(), Renamed { before, now })
    };
    side.iter().zip(called(base, side)).map(one).collect()
}

enum Followed {
    /// It is this fact; where it is about a port that has another name or type, of this port.
    Is(Fact, Option<&'static Port>),
    /// Its port is gone.
    Gone,
}

/// What a fact of a side is called now, and what it was called in the base.
fn fact_now(fact: &Fact, side: &Facts, renames: &Renames) -> (Followed, Option<Fact>) {
    let same = || (Followed::Is(fact.clone(), None), Some(fact.clone()));
    let (id, name) = match fact {
        Fact::Input(id, name) => (id, name.as_str()),
        Fact::Wires(to) => (&to.node, &*to.name),
        Fact::Comment(FileEntry::Input(id, name)) => (id, name.as_str()),
        Fact::Comment(FileEntry::Link(to) | FileEntry::Bends(to)) => (&to.node, &*to.name),
        _ => return same(),
    };
    let names = match renames.get(id) {
        Some(names) => Some(&names[INPUTS]),
        None if is_kind(side, id, GROUP_OUTPUT) => {
            id.group().and_then(|group| renames.get(&group)).map(|names| &names[OUTPUTS])
        }
        None => None,
    };
    let Some(port) = names.and_then(|names| names.get(name)) else { return same() };
    let before = port.before.as_ref().map(|name| named(fact, name));
    match port.now {
        Some(now) => (Followed::Is(named(fact, &now.name), Some(now)), before),
        // A comment finds a place where its entry is gone.
        None if matches!(fact, Fact::Comment(_)) => same(),
        None => (Followed::Gone, before),
    }
}

/// The same fact of another input of its node.
fn named(fact: &Fact, name: &str) -> Fact {
    let socket = |to: &Socket| Socket::new(to.node.clone(), name);
    match fact {
        Fact::Input(id, _) => Fact::Input(id.clone(), name.to_owned()),
        Fact::Wires(to) => Fact::Wires(socket(to)),
        Fact::Comment(FileEntry::Input(id, _)) => {
            Fact::Comment(FileEntry::Input(id.clone(), name.to_owned()))
        }
        Fact::Comment(FileEntry::Link(to)) => Fact::Comment(FileEntry::Link(socket(to))),
        Fact::Comment(FileEntry::Bends(to)) => Fact::Comment(FileEntry::Bends(socket(to))),
        fact => fact.clone(),
    }
}

fn is_kind(side: &Facts, id: &NodeId, kind: &str) -> bool {
    matches!(side.get(&Fact::Kind(id.clone())), Some(Said::Text(it)) if it == kind)
}

/// Wires that come from the outputs that there are now.
fn with_sources(said: &Said, side: &Facts, renames: &Renames) -> Said {
    let Said::Wires(wires) = said else { return said.clone() };
    let now = |from: &Socket| -> Option<Socket> {
        let names = match renames.get(&from.node) {
            // Parameters give what they are set to.
            Some(names) if is_kind(side, &from.node, GROUP) => &names[OUTPUTS],
            Some(names) => &names[INPUTS],
            None if is_kind(side, &from.node, GROUP_INPUT) => {
                &renames.get(&from.node.group()?)?[INPUTS]
            }
            None => return None,
        };
        let port = names.get(&*from.name)?.now?;
        Some(Socket::new(from.node.clone(), &port.name))
    };
    let wire = |wire: &Wire| Wire {
        from: now(&wire.from).unwrap_or_else(|| wire.from.clone()),
        bends: wire.bends.clone(),
    };
    Said::Wires(wires.iter().map(wire).collect())
}

/// A setting converted to the type of the port; `None` if that is impossible.
fn fitting(port: &Port, setting: &Setting) -> Option<Setting> {
    match setting {
        Setting::Known(value) => values::fit(port.ty, value.clone()).ok().map(Setting::Known),
        Setting::Raw(text) => {
            let value = proven_value(port.ty, text).ok();
            Some(value.map_or_else(|| setting.clone(), Setting::Known))
        }
    }
}
