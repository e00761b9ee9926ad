//! Three documents made one: what ours and theirs made of their common base.
//!
//! Guarantees: a fact that one changed is as that one has it, one that both changed alike too; lists of wires, strokes and gestures
//! merge item by item. What both changed, each otherwise, is as ours has it and in [`Merged::conflicts`]; the two who changed it
//! are told the same conflicts, whoever merges whom. What comes out can be written and read, whatever is in conflict, and evaluated
//! where ours and theirs can. A port that one renamed is followed in what the other says of it.
//!
//! A node is more than its facts: one that one person removed while the other changed or wired it, that both added, or that one made
//! another kind, is a conflict as such, and ours has it as a whole. Where things stand on the canvas is no conflict: ours counts.

use super::conflict::{Clash, Conflict, nearest, write};
use super::diff::Change;
use super::fact::{Fact, Facts, Said, Wire, facts};
use super::follow::follow;
use super::items::{ListEntry, one};
use super::lists::{in_one_order, numbered};
use super::ports;
use super::together::settle;
use crate::document::{Document, FileEntry, Frame, NodeId, Setting, Socket};
use crate::text::order::lot;
use coif_nodes::data::gestures::Gesture;
use coif_nodes::data::strokes::Stroke;
use coif_nodes::define::Arity;
use std::collections::{BTreeMap, BTreeSet};

/// What became of three documents.
#[derive(Clone, Debug, PartialEq)]
pub struct Merged {
    /// The document; with a comment that begins with [`CONFLICT`](crate::file::CONFLICT) for each conflict.
    pub document: Document,
    /// What both changed, each otherwise.
    pub conflicts: Vec<Conflict>,
    /// What both moved on the canvas: it stands where ours has it.
    pub yielded: Vec<Fact>,
    /// What one set or wired on a port that the other took away, or lets take something else: it is nowhere now, as after an
    /// upgrade. By the name that the port had there, from what the base said.
    pub lost: Vec<Change>,
}

/// Merges what two people made of `base`.
pub fn merge(base: &Document, ours: &Document, theirs: &Document) -> Merged {
    let said = [base, ours, theirs].map(facts);
    let own = said[1].clone();
    let (said, lost) = follow(said);
    let mut merge = Merge::new(said);
    merge.settle_nodes();
    let said = merge.combine();
    let Merge { mut conflicts, mut yielded, .. } = merge;
    let (mut whole, together) = settle(said, &own, [ours, theirs]);
    yielded.retain(|fact| fact.node().is_none_or(|id| whole.nodes.contains_key(id)));
    // A comment whose entry the other removed stands before what that stood in.
    let gone: Vec<FileEntry> =
        whole.comments.keys().filter(|place| !whole.has(place)).cloned().collect();
    for place in gone {
        let lines = whole.comments.remove(&place).unwrap_or_default();
        whole.comments.entry(nearest(&whole, &place)).or_default().extend(lines);
    }
    conflicts.extend(together);
    conflicts.sort_by(|a, b| a.fact.cmp(&b.fact));
    write(&mut whole, &conflicts);
    Merged { document: whole, conflicts, yielded, lost }
}

struct Merge {
    /// What base, ours and theirs say: what is a conflict hangs from these alone, so that it is the same for both.
    said: [Facts; 3],
    /// What the base says, without what [`Self::settle_nodes`] decided.
    base: Facts,
    /// What theirs says; where ours was decided for, what ours says.
    theirs: Facts,
    /// For each node the facts about it.
    of_node: BTreeMap<NodeId, BTreeSet<Fact>>,
    /// For each node the facts that name it: what it is wired to, and what is shown.
    uses: BTreeMap<NodeId, BTreeSet<Fact>>,
    conflicts: Vec<Conflict>,
    yielded: Vec<Fact>,
}

/// Whether two say the same of a wire, a value or a name; bends are for people.
fn is_alike(a: Option<&Said>, b: Option<&Said>) -> bool {
    match (a, b) {
        (Some(a @ Said::Wires(_)), Some(b @ Said::Wires(_))) => a.sources().eq(b.sources()),
        _ => a == b,
    }
}

/// The outputs of a node that a fact names.
fn named<'a>(said: Option<&'a Said>, id: &NodeId) -> BTreeSet<&'a str> {
    match said {
        Some(Said::Node(shown)) if shown == id => [""].into(),
        Some(said) => said.sources().filter(|s| s.node == *id).map(|s| &*s.name).collect(),
        None => BTreeSet::new(),
    }
}

/// Takes a node out of what names it.
fn forget_use(facts: &mut Facts, fact: &Fact, id: &NodeId, keep: &BTreeSet<&str>) {
    let is_empty = match facts.get_mut(fact) {
        Some(Said::Node(shown)) => shown == id && !keep.contains(""),
        Some(Said::Wires(wires)) => {
            wires.retain(|w| w.from.node != *id || keep.contains(&*w.from.name));
            wires.is_empty()
        }
        _ => false,
    };
    if is_empty {
        facts.remove(fact);
    }
}

impl Merge {
    fn new([base, ours, theirs]: [Facts; 3]) -> Self {
        let (mut of_node, mut uses) =
            (BTreeMap::<_, BTreeSet<_>>::new(), BTreeMap::<_, BTreeSet<_>>::new());
        for (fact, said) in base.iter().chain(&ours).chain(&theirs) {
            if let Some(id) = fact.node() {
                of_node.entry(id.clone()).or_default().insert(fact.clone());
            }
            let shown = if let Said::Node(id) = said { Some(id) } else { None };
            for id in said.sources().map(|socket| &socket.node).chain(shown) {
                uses.entry(id.clone()).or_default().insert(fact.clone());
            }
        }
        let (conflicts, yielded) = (vec![], vec![]);
        let said = [base.clone(), ours, theirs.clone()];
        Self { said, base, theirs, of_node, uses, conflicts, yielded }
    }

    fn clash(&mut self, fact: &Fact, clash: Clash) {
        let [base, ours, theirs] = self.said.each_ref().map(|facts| facts.get(fact).cloned());
        self.conflicts.push(Conflict { fact: fact.clone(), base, ours, theirs, clash });
    }

    /// Decides for ours what concerns nodes as a whole.
    fn settle_nodes(&mut self) {
        for id in self.of_node.keys().cloned().collect::<Vec<_>>() {
            let kind = Fact::Kind(id.clone());
            let [was, ours, theirs] = self.said.each_ref().map(|facts| facts.contains_key(&kind));
            match (was, ours, theirs) {
                (true, true, false) | (true, false, true) => self.settle_removed(&id, kind),
                (false, true, true) => self.settle_added(&id),
                (true, true, true) => self.settle_kind(&id, &kind),
                _ => {}
            }
        }
    }

    /// What about a node, and what names it.
    fn about(&self, id: &NodeId) -> (Vec<Fact>, Vec<Fact>) {
        let of = |map: &BTreeMap<NodeId, BTreeSet<Fact>>| {
            map.get(id).into_iter().flatten().cloned().collect()
        };
        (of(&self.of_node), of(&self.uses))
    }

    /// Of a node that one removed: a conflict where the other changed it.
    fn settle_removed(&mut self, id: &NodeId, kind: Fact) {
        let (own, uses) = self.about(id);
        let [base, ours, theirs] = &self.said;
        let is_ours = ours.contains_key(&kind);
        let side = if is_ours { ours } else { theirs };
        let changed = own
            .iter()
            .filter(|fact| !fact.is_canvas() && !is_alike(base.get(*fact), side.get(*fact)));
        let wired = uses
            .iter()
            .filter(|fact| !named(side.get(*fact), id).is_subset(&named(base.get(*fact), id)));
        let also: BTreeSet<Fact> = changed.chain(wired).cloned().collect();
        if also.is_empty() {
            return;
        }
        let change = |fact: Fact| {
            let (from, to) = (base.get(&fact).cloned(), side.get(&fact).cloned());
            Change { fact, from, to }
        };
        let also = also.into_iter().map(change).collect();
        self.clash(&kind, Clash::Removed(also));
        // As if it had never been: so it is added by ours, or by nobody.
        let nothing = BTreeSet::new();
        for fact in &own {
            self.base.remove(fact);
            if !is_ours {
                self.theirs.remove(fact);
            }
        }
        for fact in &uses {
            forget_use(&mut self.base, fact, id, &nothing);
            if self.is_put_in_place(fact, id) {
                self.take_ours(std::slice::from_ref(fact), &Clash::Changed);
            } else if !is_ours {
                self.unuse(fact, id, &nothing);
            }
        }
    }

    /// Whether one has this node, in a fact that names one alone, and the other changed that fact, too, for more than that the node
    /// is gone.
    fn is_put_in_place(&self, fact: &Fact, id: &NodeId) -> bool {
        let [_, ours, theirs] = self.said.each_ref().map(|facts| facts.get(fact));
        let many = matches!(fact, Fact::Wires(to) if self.takes_many(fact, to));
        let other = match (named(ours, id).is_empty(), named(theirs, id).is_empty()) {
            (false, true) => theirs,
            (true, false) => ours,
            _ => return false,
        };
        !many && !is_alike(other, self.base.get(fact))
    }

    /// Lets theirs not name a node, but for the outputs to `keep`; where it names nothing else, as in the base.
    fn unuse(&mut self, fact: &Fact, id: &NodeId, keep: &BTreeSet<&str>) {
        let had = self.theirs.contains_key(fact);
        forget_use(&mut self.theirs, fact, id, keep);
        if had && !self.theirs.contains_key(fact) {
            self.theirs.extend(self.base.get(fact).map(|said| (fact.clone(), said.clone())));
        }
    }

    /// Of a node that both added: a conflict unless it is the same.
    fn settle_added(&mut self, id: &NodeId) {
        let (own, uses) = self.about(id);
        let own: Vec<Fact> = own
            .into_iter()
            .filter(|fact| !fact.is_canvas() && !matches!(fact, Fact::Comment(_)))
            .collect();
        if !self.take_ours(&own, &Clash::Added) {
            return;
        }
        for fact in &uses {
            let [_, ours, theirs] = self.said.each_ref().map(|facts| facts.get(fact).cloned());
            let keep = named(ours.as_ref(), id);
            if named(theirs.as_ref(), id) != keep {
                self.clash(fact, Clash::Added);
                self.unuse(fact, id, &keep);
            }
        }
    }

    /// Of a node that somebody made another kind: a conflict where what it takes is changed by the other.
    fn settle_kind(&mut self, id: &NodeId, kind: &Fact) {
        let [was, ours, theirs] = self.said.each_ref().map(|facts| facts.get(kind));
        if ours == theirs {
            return;
        }
        let (own, _) = self.about(id);
        let own: Vec<Fact> = own
            .into_iter()
            .filter(|fact| matches!(fact, Fact::Kind(_) | Fact::Input(..) | Fact::Wires(_)))
            .collect();
        let changed =
            |side: &Facts| own.iter().any(|fact| !is_alike(self.said[0].get(fact), side.get(fact)));
        let other = if was == ours { &self.said[1] } else { &self.said[2] };
        if (was != ours && was != theirs) || changed(other) {
            self.take_ours(&own, &Clash::Kind);
        }
    }

    /// Lets theirs say what ours says of these, and tells a conflict for each that it said otherwise; whether there was one.
    fn take_ours(&mut self, facts: &[Fact], clash: &Clash) -> bool {
        let before = self.conflicts.len();
        for fact in facts {
            let [_, ours, theirs] = &self.said;
            if !is_alike(ours.get(fact), theirs.get(fact)) {
                let ours = ours.get(fact).cloned();
                self.clash(fact, clash.clone());
                match ours {
                    Some(said) => drop(self.theirs.insert(fact.clone(), said)),
                    None => drop(self.theirs.remove(fact)),
                }
            }
        }
        self.conflicts.len() > before
    }

    /// Each fact from whoever changed it.
    fn combine(&mut self) -> Facts {
        let all: BTreeSet<Fact> = self
            .base
            .keys()
            .chain(self.said[1].keys())
            .chain(self.theirs.keys())
            .cloned()
            .collect();
        let mut merged = Facts::new();
        for fact in all {
            let of = |facts: &Facts| facts.get(&fact).cloned();
            let (base, ours, theirs) = (of(&self.base), of(&self.said[1]), of(&self.theirs));
            let said = match one(PartialEq::eq, &base, &ours, &theirs) {
                Some(said) => said,
                None => self.both(&fact, base, ours, theirs),
            };
            merged.extend(said.map(|said| (fact, said)));
        }
        merged
    }

    /// What becomes of a fact that both changed, each otherwise.
    fn both(
        &mut self,
        fact: &Fact,
        base: Option<Said>,
        ours: Option<Said>,
        theirs: Option<Said>,
    ) -> Option<Said> {
        match fact {
            Fact::Layout(_) => self.yielded.push(fact.clone()),
            Fact::Wires(to) => return self.wires(fact, to, [&base, &ours, &theirs]),
            Fact::Frame(_) => {
                if let (Some(Said::Frame(b)), Some(Said::Frame(o)), Some(Said::Frame(t))) =
                    (&base, &ours, &theirs)
                    && let Some(frame) = self.frame(fact, [b, o, t])
                {
                    return Some(Said::Frame(frame));
                }
                self.clash(fact, Clash::Changed);
            }
            Fact::Ports(_) => {
                if let (Some(Said::Ports(b)), Some(Said::Ports(o)), Some(Said::Ports(t))) =
                    (&base, &ours, &theirs)
                    && let Some(ports) = ports::merged(*b, *o, *t)
                {
                    return Some(Said::Ports(ports));
                }
                self.clash(fact, Clash::Changed);
            }
            Fact::Input(..) => {
                fn setting(said: &Option<Said>) -> Option<&Setting> {
                    if let Some(Said::Setting(setting)) = said { Some(setting) } else { None }
                }
                let all = [&base, &ours, &theirs].map(setting);
                if let Some(merged) = self.items::<Stroke>(fact, all) {
                    return merged;
                }
                if let Some(merged) = self.items::<Gesture>(fact, all) {
                    return merged;
                }
                self.clash(fact, Clash::Changed);
            }
            _ => self.clash(fact, Clash::Changed),
        }
        ours
    }

    /// A frame that both changed: where it stands is for people, what stands on it is merged.
    fn frame(&mut self, fact: &Fact, [base, ours, theirs]: [&Frame; 3]) -> Option<Frame> {
        let place = |frame: &Frame| (frame.at, frame.size);
        let [b, o, t] = [base, ours, theirs].map(place);
        let text = one(PartialEq::eq, &base.text, &ours.text, &theirs.text)?;
        let colour = one(PartialEq::eq, &base.colour, &ours.colour, &theirs.colour)?;
        let (at, size) = one(PartialEq::eq, &b, &o, &t).unwrap_or_else(|| {
            self.yielded.push(fact.clone());
            o
        });
        Some(Frame { at, size, text, colour })
    }

    /// Whether an input takes many wires; of what nobody knows, whether it has many.
    fn takes_many(&self, fact: &Fact, to: &Socket) -> bool {
        let kind = Fact::Kind(to.node.clone());
        let [base, ours, theirs] = &self.said;
        let kind = [ours, theirs, base].into_iter().find_map(|facts| facts.get(&kind));
        let def = match kind {
            Some(Said::Text(kind)) => coif_nodes::by_id(kind),
            _ => None,
        };
        let input = def.and_then(|def| def.input(&to.name));
        input.map_or_else(
            || {
                self.said.iter().any(|facts| {
                    facts.get(fact).is_some_and(|said| said.sources().nth(1).is_some())
                })
            },
            |(_, input)| input.arity == Arity::Many,
        )
    }

    /// The wires of an input that both changed.
    fn wires(&mut self, fact: &Fact, to: &Socket, all: [&Option<Said>; 3]) -> Option<Said> {
        let many = self.takes_many(fact, to);
        let [base, ours, theirs] = all.map(|said| match said {
            Some(Said::Wires(wires)) => &wires[..],
            _ => &[],
        });
        let names = |wires: &[Wire]| {
            numbered(wires.iter().map(|wire| (wire.from.node.clone(), wire.from.name.clone())))
        };
        let [b, o, t] = [base, ours, theirs].map(names);
        let [of_b, of_o, of_t] = [&b, &o, &t].map(|list| list.iter().collect::<BTreeSet<_>>());
        let adds = |side: &BTreeSet<_>| side.difference(&of_b).next().is_some();
        // Who takes a wire out and puts another in has put something between: two of these would double the hair.
        let in_its_place = b.iter().any(|k| !of_o.contains(k) && !of_t.contains(k));
        let is_clash = if many {
            o != t && in_its_place && adds(&of_o) && adds(&of_t)
        } else {
            o != t && b != o && b != t
        };
        if is_clash {
            self.clash(fact, Clash::Changed);
            return all[1].clone();
        }
        let kept = |k: &_| (of_o.contains(k) && of_t.contains(k)) || !of_b.contains(k);
        let (order, contradict) = in_one_order(&b, &o, &t, kept, |((node, output), _)| {
            (lot(node.as_str()), format!("{node}.{output}"))
        });
        if contradict {
            self.clash(fact, Clash::Order);
        }
        let bends = |names: &[_], wires: &[Wire]| -> BTreeMap<_, _> {
            names.iter().cloned().zip(wires.iter().map(|wire| wire.bends.clone())).collect()
        };
        let [b, o, t] = [bends(&b, base), bends(&o, ours), bends(&t, theirs)];
        let mut yields = false;
        let wires = order.into_iter().map(|k| {
            let side = |all: &BTreeMap<_, Vec<_>>| all.get(&k).cloned();
            let (base, ours, theirs) = (side(&b), side(&o), side(&t));
            let bends =
                one(PartialEq::eq, &base, &ours.clone().or(base.clone()), &theirs.or(base.clone()))
                    .unwrap_or_else(|| {
                        yields = true;
                        ours
                    });
            let ((node, name), _) = k;
            Wire { from: Socket { node, name }, bends: bends.unwrap_or_default() }
        });
        let wires: Vec<Wire> = wires.collect();
        if yields {
            self.yielded.push(fact.clone());
        }
        (!wires.is_empty()).then_some(Said::Wires(wires))
    }

    /// The strokes or gestures of an input that both changed; none where one of the three holds something else.
    fn items<T: ListEntry>(
        &mut self,
        fact: &Fact,
        all: [Option<&Setting>; 3],
    ) -> Option<Option<Said>> {
        let [b, o, t] = [T::of(all[0])?, T::of(all[1])?, T::of(all[2])?];
        let by_id = |list: &[T]| -> BTreeMap<u64, T> {
            list.iter().map(T::id).zip(list.to_vec()).collect()
        };
        let [base, ours, theirs] = [b, o, t].map(by_id);
        let same = |a: &Option<T>, b: &Option<T>| match (a, b) {
            (Some(a), Some(b)) => a.is_same(b),
            (a, b) => a.is_none() && b.is_none(),
        };
        let mut merged = BTreeMap::<u64, T>::new();
        let ids: BTreeSet<u64> =
            base.keys().chain(ours.keys()).chain(theirs.keys()).copied().collect();
        for id in ids {
            let three = [&base, &ours, &theirs].map(|side| side.get(&id).cloned());
            let item = one(same, &three[0], &three[1], &three[2]).or_else(|| match &three {
                [Some(base), Some(ours), Some(theirs)] => T::merged(base, ours, theirs).map(Some),
                _ => None,
            });
            let item = item.unwrap_or_else(|| {
                let alone = |item: &Option<T>| {
                    item.clone().map(|item| Said::Setting(T::setting(vec![item])))
                };
                let [base, ours, theirs] = [0, 1, 2].map(|n| alone(&three[n]));
                let (fact, clash) = (fact.clone(), Clash::Item(T::WORD, id));
                self.conflicts.push(Conflict { fact, base, ours, theirs, clash });
                three[1].clone()
            });
            merged.extend(item.map(|item| (id, item)));
        }
        let ids = |list: &[T]| list.iter().map(T::id).collect::<Vec<u64>>();
        let (order, contradict) = in_one_order(
            &ids(b),
            &ids(o),
            &ids(t),
            |id| merged.contains_key(id),
            |id| (lot(&id.to_string()), *id),
        );
        if contradict {
            self.clash(fact, Clash::Order);
        }
        let list: Vec<T> = order.into_iter().filter_map(|id| merged.remove(&id)).collect();
        let is_unset = list.is_empty() && all[1..].iter().any(Option::is_none);
        Some((!is_unset).then(|| Said::Setting(T::setting(list))))
    }
}
