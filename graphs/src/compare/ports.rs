//! Two versions of what a group takes and gives, or of the parameters of a graph, made one: port by port.
//!
//! A port is followed by its name, and by the names that it had before. Guarantees: what one changed is as that one has it,
//! whoever merges whom. No interface is made where both changed one port, each otherwise, where one removed what the other
//! changed, where both ordered ports otherwise, or where two ports would have one name.

use super::items::one;
use super::lists::in_one_order;
use crate::text::order::lot;
use coif_nodes::declared::{Interface, Port};
use std::collections::{BTreeMap, BTreeSet};

/// The port that a port of an older version is now. One of the same name, unless another has been given that name among its
/// former ones since: then the ports were renamed, and may even have changed names with each other.
pub(crate) fn successor<'a>(old: &[Port], new: &'a [Port], name: &str) -> Option<&'a Port> {
    let was = |port: &Port| port.was.iter().any(|was| was == name);
    let known = |port: &Port| old.iter().any(|before| before.name == port.name && was(before));
    let is_new = |port: &Port| old.iter().all(|before| before.name != port.name);
    let same = new.iter().find(|port| port.name == name);
    let renamed = new.iter().find(|port| was(port) && !known(port));
    match (same, renamed) {
        // Of two that may be it the one that says so, where the other is a newcomer or says that it was something else.
        (Some(same), Some(renamed)) => {
            let takes_over = is_new(renamed) || same.was.contains(&renamed.name);
            Some(if takes_over { renamed } else { same })
        }
        (same, renamed) => same.or(renamed).or_else(|| new.iter().find(|port| was(port))),
    }
}

/// What a port is called whatever names it was given: as in the base, or as it is where it came since.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Called {
    /// In the base.
    Before(String),
    /// By who added it.
    Since(String),
}

impl Called {
    fn name(&self) -> &String {
        let (Called::Before(name) | Called::Since(name)) = self;
        name
    }
}

/// What the ports of a version are called, in their order; no two alike.
pub(super) fn called(base: &[Port], ports: &[Port]) -> Vec<Called> {
    let mut before = BTreeMap::<&str, Vec<&str>>::new();
    for old in base {
        if let Some(port) = successor(base, ports, &old.name) {
            before.entry(&port.name).or_default().push(&old.name);
        }
    }
    let of = |port: &Port| {
        let all = before.get(&*port.name).map_or(&[][..], Vec::as_slice);
        let had = |name: &&&str| all.contains(name);
        let name = port.was.iter().map(String::as_str);
        let own = std::iter::once(port.name.as_str());
        match own.chain(name).find(|name| had(&name)).or(all.first().copied()) {
            Some(name) => Called::Before(name.to_owned()),
            None => Called::Since(port.name.clone()),
        }
    };
    ports.iter().map(of).collect()
}

/// What two people made of an interface; none where they contradict each other.
pub(super) fn merged(base: Interface, ours: Interface, theirs: Interface) -> Option<Interface> {
    let all = [base, ours, theirs];
    let inputs = side(all.map(|interface| interface.inputs()))?;
    let outputs = side(all.map(|interface| interface.outputs()))?;
    Interface::new(inputs, outputs).ok()
}

fn side(all: [&[Port]; 3]) -> Option<Vec<Port>> {
    let [b, o, t] = all.map(|ports| called(all[0], ports));
    let by_name = |names: &[Called], ports: &[Port]| -> BTreeMap<Called, Port> {
        names.iter().cloned().zip(ports.iter().cloned()).collect()
    };
    let of = [by_name(&b, all[0]), by_name(&o, all[1]), by_name(&t, all[2])];
    let mut kept = BTreeMap::new();
    for name in of.iter().flat_map(BTreeMap::keys).collect::<BTreeSet<_>>() {
        let [base, ours, theirs] = of.each_ref().map(|ports| ports.get(name).cloned());
        kept.extend(one(is_same, &base, &ours, &theirs)?.map(|port| (name.clone(), port)));
    }
    let lots = |name: &Called| (lot(name.name()), name.clone());
    let (order, contradict) = in_one_order(&b, &o, &t, |name| kept.contains_key(name), lots);
    (!contradict).then(|| order.into_iter().filter_map(|name| kept.remove(&name)).collect())
}

/// Interfaces are made once for a list of ports: two are the same when all that is said of their ports is.
fn is_same(a: &Option<Port>, b: &Option<Port>) -> bool {
    let alone = |port: &Option<Port>| {
        port.clone().map(|port| Interface::new(vec![port], vec![]).map_err(|err| err.to_string()))
    };
    alone(a) == alone(b)
}

#[cfg(test)]
mod tests {
    use super::*;
    use coif_nodes::define::{Type, Value};

    /// Ports as `name=default`, those of another name before as `name<was=default`.
    fn interface(text: &str) -> Interface {
        let port = |word: &str| {
            let (name, default) = word.split_once('=').unwrap();
            let (name, was) = name.split_once('<').map_or((name, None), |(n, was)| (n, Some(was)));
            Port {
                was: was.into_iter().map(str::to_owned).collect(),
                default: Some(Value::Float(default.parse().unwrap())),
                ..Port::new(name, Type::Float)
            }
        };
        Interface::new(text.split_whitespace().map(port).collect(), vec![]).unwrap()
    }

    #[track_caller]
    fn check(base: &str, ours: &str, theirs: &str, expected: Option<&str>) {
        let [base, ours, theirs] = [base, ours, theirs].map(interface);
        let expected = expected.map(interface);
        assert_eq!(merged(base, ours, theirs), expected);
        assert_eq!(merged(base, theirs, ours), expected);
    }

    #[test]
    fn ports_that_two_people_change_are_merged_one_by_one() {
        check("a=1 b=2", "a=3 b=2", "a=1 b=4", Some("a=3 b=4"));
        check("a=1 b=2", "a=1 b=2 c=5", "a=3 b=2", Some("a=3 b=2 c=5"));
        check("a=1 b=2", "a=1", "a=3 b=2", Some("a=3"));
        check("a=1 b=2", "c<a=1 b=2", "a=1 b=4", Some("c<a=1 b=4"));
        check("a=1 b=2 c=3", "b=2 a=1 c=3", "a=1 b=2 c=4", Some("b=2 a=1 c=4"));
        check("a=1", "a=1 c=1", "a=1 c=1", Some("a=1 c=1"));
        // Each otherwise.
        check("a=1 b=2", "a=3 b=2", "a=4 b=2", None);
        check("a=1 b=2", "b=2", "a=4 b=2", None);
        check("a=1", "a=1 c=1", "a=1 c=2", None);
        check("a=1 b=2 c=3", "b=2 a=1 c=3", "c=3 a=1 b=2", None);
        check("a=1 b=2", "c<a=1 b=2", "a=1 c<b=2", None);
    }
}
