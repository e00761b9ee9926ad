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

/// What two people made of an interface; none where they contradict each other.
pub(super) fn merged(base: Interface, ours: Interface, theirs: Interface) -> Option<Interface> {
    let all = [base, ours, theirs];
    let inputs = side(all.map(|interface| interface.inputs()))?;
    let outputs = side(all.map(|interface| interface.outputs()))?;
    Interface::new(inputs, outputs).ok()
}

fn side([base, ours, theirs]: [&[Port]; 3]) -> Option<Vec<Port>> {
    // A port is what it was called in the base, if it was there.
    let names = |ports: &[Port]| -> Vec<String> {
        let is_there = |name: &String| base.iter().any(|port| port.name == *name);
        let of = |port: &Port| match is_there(&port.name) {
            true => port.name.clone(),
            false => port.was.iter().find(|was| is_there(was)).unwrap_or(&port.name).clone(),
        };
        ports.iter().map(of).collect()
    };
    let [b, o, t] = [base, ours, theirs].map(names);
    let by_name = |names: &[String], ports: &[Port]| -> BTreeMap<String, Port> {
        names.iter().cloned().zip(ports.iter().cloned()).collect()
    };
    let of = [by_name(&b, base), by_name(&o, ours), by_name(&t, theirs)];
    // A port that took another's place by its old name, beside one that still has it.
    if of.iter().zip([base, ours, theirs]).any(|(of, ports)| of.len() != ports.len()) {
        return None;
    }
    let mut kept = BTreeMap::new();
    for name in of.iter().flat_map(BTreeMap::keys).collect::<BTreeSet<_>>() {
        let [base, ours, theirs] = of.each_ref().map(|ports| ports.get(name).cloned());
        kept.extend(one(is_same, &base, &ours, &theirs)?.map(|port| (name.clone(), port)));
    }
    let lots = |name: &String| (lot(name), name.clone());
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
