//! Composes the prims of a stage from its layers: sublayers, references, payloads, classes, selected variants and instances, with
//! the opinions over them, in the order of strength that USD has.
//!
//! A prim is a tree of nodes, the strongest first. A node is what the layers of one layer stack say of it at one path; below it are
//! the nodes that its arcs bring in. Children have the same tree one name deeper, and the arcs that they add themselves, which are
//! stronger than those of the same kind from above.
//!
//! Guaranteed: what is not followed is told, once for each prim; arcs that come back to themselves are not followed; depth of prims
//! and of arcs is bounded, and every node is charged to the budget, so that no web of arcs unfolds without end. Not promised: classes
//! of layers that reference (implied inherits), relocates, value clips, prototypes of point instancers.

use super::super::super::FormatError;
use super::budget::ReadBudget;
use super::layers::Layers;
use super::tree::{
    Arc, Edit, ParsedValue, Prim, PrimAttribute, Specifier, Stage, Target, is_passed_down,
};
use super::{LeftOut, Told};
use std::cmp::Reverse;
use std::collections::{BTreeMap, BTreeSet};

/// How deep prims may lie.
const MOST_DEPTH: usize = 500;
/// How many arcs may lead from one to the next.
const MOST_ARCS: usize = 64;
/// How many bytes the values of prims may take that are brought in more than once.
const MOST_COPIED: u64 = 256 << 20;

/// What the layers of a stack say of a prim at one path.
#[derive(Debug)]
struct Node {
    arc: Arc,
    /// When it was brought in: later is deeper.
    age: u64,
    stack: usize,
    /// Layer and spec, the strongest first.
    sites: Vec<(usize, usize)>,
    /// What its arcs bring in, the strongest first.
    nodes: Vec<Node>,
    /// Sets of which a variant was looked for.
    sets: Vec<String>,
}

/// The prims of the stage of a file of so many bytes, in its order.
pub(super) fn compose(
    layers: &mut Layers,
    length: usize,
    told: &mut Told,
    budget: &mut ReadBudget,
) -> Result<Stage, FormatError> {
    let mut composer = Composer {
        layers,
        told,
        budget,
        stacks: Vec::new(),
        stage: Stage::default(),
        sites: Vec::new(),
        work: ReadBudget::for_arcs(length),
        clock: 0,
        age: 0,
        chain: Vec::new(),
    };
    composer.prims()?;
    composer.values()?;
    let Composer { mut stage, layers, .. } = composer;
    stage.meters_per_unit = layers.layer(0).meters_per_unit;
    stage.up_axis = layers.layer(0).up_axis.clone();
    Ok(stage)
}

struct Composer<'a, 'b> {
    layers: &'a mut Layers<'b>,
    told: &'a mut Told,
    budget: &'a mut ReadBudget,
    /// The layers of each stack, the strongest first; the first is its root.
    stacks: Vec<Vec<usize>>,
    stage: Stage,
    /// The layers and specs that speak of each prim of the stage, the strongest first.
    sites: Vec<Vec<(usize, usize)>>,
    /// For nodes and names, which are gone when all is composed.
    work: ReadBudget,
    /// How many prims were followed, those on the way to targets too, and the one that is.
    clock: u64,
    age: u64,
    /// Stacks and paths from which arcs are being followed.
    chain: Vec<(usize, String)>,
}

/// A prim that is still to be composed.
struct Open {
    parent: Option<usize>,
    depth: usize,
    name: String,
    node: Node,
}

type Done = Result<(), FormatError>;

impl Composer<'_, '_> {
    fn prims(&mut self) -> Done {
        let stack = self.stack(0)?;
        let roots = self.stacks[stack].iter().map(|layer| (*layer, None)).collect::<Vec<_>>();
        let mut open = Vec::new();
        for name in self.child_names(&roots)?.into_iter().rev() {
            let sites = self.sites_below(&roots, &name);
            let node = self.node(Arc::Inherit, stack, sites)?;
            open.push(Open { parent: None, depth: 1, name, node });
        }
        while let Some(Open { parent, depth, name, mut node }) = open.pop() {
            if self.first(&node, |spec| spec.is_active) == Some(false) {
                continue;
            }
            let here = self.stage.prims.len();
            self.budget.charge(name.len() as u64)?;
            let prim = Prim { parent, name, type_name: String::new(), attributes: Vec::new() };
            self.budget.push(&mut self.stage.prims, prim)?;
            self.clock += 1;
            self.age = self.clock;
            self.arcs(&mut node, here)?;
            self.variants(&mut node, here)?;
            let specifier =
                self.first(&node, |s| (s.specifier != Specifier::Over).then_some(s.specifier));
            let is_active = self.first(&node, |spec| spec.is_active) != Some(false);
            if specifier != Some(Specifier::Def) || !is_active {
                self.stage.prims.pop();
                continue;
            }
            if !self.prim(&node, here)? {
                continue;
            }
            if depth >= MOST_DEPTH {
                let reason = format!("prims more than {MOST_DEPTH} deep are not read");
                self.leave_out(here, "prims", &Target::default(), reason)?;
                continue;
            }
            if self.first(&node, |spec| spec.is_instanceable) == Some(true) {
                node.keep_instance(self.age);
            }
            let sites = all_sites(&node);
            for child in self.child_names(&sites)?.into_iter().rev() {
                if let Some(below) = self.below(&node, &child)? {
                    let depth = depth + 1;
                    open.push(Open { parent: Some(here), depth, name: child, node: below });
                }
            }
        }
        Ok(())
    }

    /// Type and attributes of the prim `here`, and whether prims below it are drawn.
    fn prim(&mut self, node: &Node, here: usize) -> Result<bool, FormatError> {
        let sites = all_sites(node);
        let type_of = |site: &(usize, Option<usize>)| {
            let type_name = &self.layers.layer(site.0).specs[site.1?].type_name;
            (!type_name.is_empty()).then(|| type_name.clone())
        };
        let type_name = sites.iter().find_map(type_of).unwrap_or_default();
        if self.first(node, |spec| spec.has_clips.then_some(())).is_some() {
            let reason = "values that lie in clips are not read".to_owned();
            self.leave_out(here, "clips", &Target::default(), reason)?;
        }
        let is_other_curves = matches!(type_name.as_str(), "NurbsCurves" | "HermiteCurves");
        let is_instancer = type_name == "PointInstancer";
        if is_other_curves || is_instancer {
            let reason = match is_instancer {
                true => "its instances are not read, nor what lies below it",
                false => "only BasisCurves are read",
            };
            self.leave_out(here, &type_name, &Target::default(), reason.to_owned())?;
        }
        self.stage.prims[here].type_name = self.budget.text(&type_name)?;
        let sites: Vec<_> =
            sites.iter().filter_map(|(layer, spec)| Some((*layer, (*spec)?))).collect();
        for (layer, spec) in &sites {
            self.layers.layer_mut(*layer).specs[*spec].uses += 1;
        }
        self.budget.charge_items::<(usize, usize)>(sites.len() as u64)?;
        self.budget.push(&mut self.sites, sites)?;
        Ok(!is_instancer)
    }

    /// Takes the values that the prims of the stage have, or copies them where others have them too.
    fn values(&mut self) -> Done {
        let mut copied = 0;
        for (here, sites) in std::mem::take(&mut self.sites).into_iter().enumerate() {
            let is_curves = self.stage.prims[here].type_name == "BasisCurves";
            let mut attributes: Vec<PrimAttribute> = Vec::new();
            let mut own_copies = 0;
            for (layer, spec) in sites {
                let spec = &mut self.layers.layer_mut(layer).specs[spec];
                spec.uses = spec.uses.saturating_sub(1);
                if spec.uses == 0 && attributes.is_empty() {
                    attributes = std::mem::take(&mut spec.attributes);
                    continue;
                }
                // A layer does not say the same twice.
                let known: BTreeMap<String, usize> =
                    attributes.iter().enumerate().map(|(at, a)| (a.name.clone(), at)).collect();
                for weaker in &spec.attributes {
                    if !is_curves && !is_passed_down(&weaker.name) {
                        continue;
                    }
                    let own = match known.get(&weaker.name) {
                        Some(own) => *own,
                        None => {
                            let (name, type_name) = (weaker.name.clone(), weaker.type_name.clone());
                            self.budget.charge((name.len() + type_name.len()) as u64)?;
                            let new = PrimAttribute { name, type_name, ..PrimAttribute::default() };
                            self.budget.push(&mut attributes, new)?;
                            attributes.len() - 1
                        }
                    };
                    let own = &mut attributes[own];
                    if own.interpolation.is_none() {
                        own.interpolation.clone_from(&weaker.interpolation);
                    }
                    if own.value.is_none() && !own.is_blocked {
                        own.is_blocked = weaker.is_blocked;
                        own.unread = weaker.unread;
                        if is_curves {
                            own_copies += weaker.value.as_ref().map_or(0, ParsedValue::bytes);
                        }
                        if copied + own_copies <= MOST_COPIED {
                            own.value.clone_from(&weaker.value);
                        }
                    }
                }
                if spec.uses == 0 {
                    spec.attributes = Vec::new();
                }
            }
            if copied + own_copies <= MOST_COPIED {
                copied += own_copies;
            } else {
                let megabytes = MOST_COPIED >> 20;
                let reason =
                    format!("copies of referenced curves would take more than {megabytes} MiB");
                self.leave_out(here, "curves", &Target::default(), reason)?;
                attributes.clear();
                self.stage.prims[here].type_name.clear();
            }
            self.stage.prims[here].attributes = attributes;
        }
        Ok(())
    }

    // ---- nodes -------------------------------------------------------------------------------

    fn node(
        &mut self,
        arc: Arc,
        stack: usize,
        sites: Vec<(usize, usize)>,
    ) -> Result<Node, FormatError> {
        self.work.charge_items::<Node>(1)?;
        self.work.charge_items::<(usize, usize)>(sites.len() as u64)?;
        Ok(Node { arc, age: self.age, stack, sites, nodes: Vec::new(), sets: Vec::new() })
    }

    /// The first that any layer says, the strongest asked first.
    fn first<T>(
        &self,
        node: &Node,
        say: impl Fn(&super::tree::Spec) -> Option<T> + Copy,
    ) -> Option<T> {
        let own = |(layer, spec): &(usize, usize)| say(&self.layers.layer(*layer).specs[*spec]);
        node.sites
            .iter()
            .find_map(own)
            .or_else(|| node.nodes.iter().find_map(|node| self.first(node, say)))
    }

    /// Names of all children of these specs, or of layers, in order.
    fn child_names(
        &mut self,
        sites: &[(usize, Option<usize>)],
    ) -> Result<Vec<String>, FormatError> {
        let mut names = Vec::new();
        let mut known = BTreeSet::new();
        for (layer, spec) in sites {
            let layer = self.layers.layer(*layer);
            let children = spec.map_or(&layer.roots, |spec| &layer.specs[spec].children);
            for child in children {
                let name = &layer.specs[*child as usize].name;
                self.work.charge(2 * name.len() as u64 + 64)?;
                if layer.child(*spec, name) != Some(*child as usize) {
                    let path = layer.path(*child as usize, &mut self.work)?;
                    let (kind, asset) = ("prim".to_owned(), String::new());
                    let reason = "its layer has it twice; the first counts".to_owned();
                    self.told.leave_out(LeftOut { path, kind, asset, reason, is_broken: true });
                }
                if known.insert(name.clone()) {
                    names.push(name.clone());
                }
            }
        }
        Ok(names)
    }

    fn sites_below(&self, sites: &[(usize, Option<usize>)], name: &str) -> Vec<(usize, usize)> {
        let child = |(layer, spec): &(usize, Option<usize>)| {
            Some((*layer, self.layers.layer(*layer).child(*spec, name)?))
        };
        sites.iter().filter_map(child).collect()
    }

    /// The node of a child, without the arcs of its own; none where nothing says anything of it.
    fn below(&mut self, node: &Node, name: &str) -> Result<Option<Node>, FormatError> {
        let own: Vec<_> = node.sites.iter().map(|(layer, spec)| (*layer, Some(*spec))).collect();
        let sites = self.sites_below(&own, name);
        let mut nodes = Vec::new();
        for node in &node.nodes {
            nodes.extend(self.below(node, name)?);
        }
        if sites.is_empty() && nodes.is_empty() {
            return Ok(None);
        }
        let below = self.node(node.arc, node.stack, sites)?;
        Ok(Some(Node { age: node.age, nodes, ..below }))
    }

    // ---- arcs --------------------------------------------------------------------------------

    /// Brings in what the arcs of a prim's nodes lead to, but for variants.
    fn arcs(&mut self, node: &mut Node, here: usize) -> Done {
        let spec = |(layer, spec): &(usize, usize)| &self.layers.layer(*layer).specs[*spec];
        let has_arcs = node.sites.iter().any(|site| !spec(site).arcs.is_empty());
        if !has_arcs && node.nodes.is_empty() {
            return Ok(());
        }
        let linked = match node.sites.first() {
            Some((layer, spec)) => {
                let path = self.layers.layer(*layer).path(*spec, &mut self.work)?;
                self.chain.push((node.stack, path));
                true
            }
            None => false,
        };
        for below in &mut node.nodes {
            self.arcs(below, here)?;
        }
        for arc in [Arc::Inherit, Arc::Reference, Arc::Payload, Arc::Specialize] {
            for (layer, target) in self.targets(node, arc)? {
                match self.brought_in(arc, node.stack, layer, &target, here)? {
                    Ok(below) => node.nodes.extend(below),
                    Err(reason) => self.leave_out(here, name_of(arc), &target, reason)?,
                }
            }
        }
        node.nodes.sort_by_key(|node| (node.arc, Reverse(node.age)));
        if linked {
            self.chain.pop();
        }
        Ok(())
    }

    /// Where the arcs of a kind lead, and the layer that says so, once all layers of the stack have edited the list.
    fn targets(&mut self, node: &Node, arc: Arc) -> Result<Vec<(usize, Target)>, FormatError> {
        let mut list: Vec<(usize, Target)> = Vec::new();
        for (layer, spec) in node.sites.iter().rev() {
            let edits = &self.layers.layer(*layer).specs[*spec].arcs;
            for edit in edits.iter().filter(|edit| edit.arc == arc) {
                let targets = edit.targets.iter();
                // A hostile list must not take the square of its length.
                let known: BTreeSet<(&str, &str)> =
                    targets.clone().map(|t| (t.asset.as_str(), t.path.as_str())).collect();
                let is_known = |target: &Target| known.contains(&(&*target.asset, &*target.path));
                let bytes = |target: &Target| (target.asset.len() + target.path.len() + 128) as u64;
                self.work.charge(targets.clone().map(bytes).sum())?;
                let new = targets.map(|target| (*layer, target.clone()));
                match edit.edit {
                    Edit::Explicit => list = new.collect(),
                    Edit::Prepend => {
                        list.retain(|(_, target)| !is_known(target));
                        list.splice(0..0, new);
                    }
                    Edit::Append | Edit::Add => {
                        list.retain(|(_, target)| !is_known(target));
                        list.extend(new);
                    }
                    Edit::Delete => list.retain(|(_, target)| !is_known(target)),
                    Edit::Reorder => {}
                }
            }
        }
        Ok(list)
    }

    /// The node at the end of an arc; none where a class is nowhere written. The inner error says why it is not followed.
    fn brought_in(
        &mut self,
        arc: Arc,
        stack: usize,
        layer: usize,
        target: &Target,
        here: usize,
    ) -> Result<Result<Option<Node>, String>, FormatError> {
        if self.chain.len() >= MOST_ARCS {
            return Ok(Err(format!("more than {MOST_ARCS} arcs in a row are not followed")));
        }
        let stack = if target.asset.is_empty() {
            stack
        } else {
            match self.layers.find(layer, &target.asset, self.budget) {
                Ok(layer) => self.stack(layer)?,
                Err(reason) => return Ok(Err(reason)),
            }
        };
        let path = if target.path.is_empty() {
            let root = self.layers.layer(self.stacks[stack][0]);
            match &root.default_prim {
                Some(name) => format!("/{}", name.trim_start_matches('/')),
                None => {
                    return Ok(Err("it names no prim, and the layer no defaultPrim".to_owned()));
                }
            }
        } else {
            target.path.clone()
        };
        let begins = |path: &str, with: &str| {
            path.strip_prefix(with).is_some_and(|rest| rest.is_empty() || rest.starts_with('/'))
        };
        let comes_back = |(other, from): &(usize, String)| {
            *other == stack && (begins(from, &path) || begins(&path, from))
        };
        if self.chain.iter().any(comes_back) {
            return Ok(Err("it leads back to where it comes from".to_owned()));
        }
        let Some(names) = path.strip_prefix('/').filter(|names| !names.is_empty()) else {
            return Ok(Err("its path does not lead to a prim".to_owned()));
        };
        let names: Vec<&str> = names.split('/').collect();
        if names.len() > MOST_DEPTH {
            return Ok(Err(format!("prims more than {MOST_DEPTH} deep are not read")));
        }
        let roots: Vec<_> = self.stacks[stack].iter().map(|layer| (*layer, None)).collect();
        let age = self.age;
        let sites = self.sites_below(&roots, names[0]);
        let mut found = match sites.is_empty() {
            true => None,
            false => Some(self.node(arc, stack, sites)?),
        };
        for (at, name) in names.iter().enumerate() {
            let Some(mut node) = found else { break };
            if at > 0 {
                let Some(below) = self.below(&node, name)? else {
                    found = None;
                    break;
                };
                node = below;
            }
            self.clock += 1;
            self.age = self.clock;
            self.arcs(&mut node, here)?;
            if at + 1 < names.len() {
                self.variants(&mut node, here)?;
            }
            found = Some(node);
        }
        self.age = age;
        let is_missing = found.is_none() && !matches!(arc, Arc::Inherit | Arc::Specialize);
        if is_missing {
            return Ok(Err(format!("there is no prim <{path}>")));
        }
        Ok(Ok(found.map(|node| Node { arc, age, ..node })))
    }

    /// Brings in the selected variants of a prim.
    fn variants(&mut self, root: &mut Node, here: usize) -> Done {
        while let Some((mut way, set)) = self.next_set(root) {
            let selects = |spec: &super::tree::Spec| {
                let of_set = spec.selections.iter().find(|[other, _]| *other == set);
                of_set.map(|[_, name]| name.clone())
            };
            let selected = self.first(root, selects);
            let mut node = &mut *root;
            let depth = self.chain.len();
            loop {
                if let Some((layer, spec)) = node.sites.first() {
                    let path = self.layers.layer(*layer).path(*spec, &mut self.work)?;
                    self.chain.push((node.stack, path));
                }
                match way.pop() {
                    Some(below) => node = &mut node.nodes[below],
                    None => break,
                }
            }
            let variant = |(layer, spec): &(usize, usize)| {
                let all = self.layers.layer(*layer);
                let is_it = |at: &&u32| {
                    let spec = &all.specs[**at as usize];
                    spec.variant_of.as_ref() == Some(&set) && Some(&spec.name) == selected.as_ref()
                };
                Some((*layer, *all.specs[*spec].variants.iter().find(is_it)? as usize))
            };
            let sites: Vec<_> = node.sites.iter().filter_map(variant).collect();
            let reason = match (&selected, sites.is_empty()) {
                (None, _) => Some("no variant of it is selected".to_owned()),
                (Some(name), true) if !name.is_empty() => Some(format!("it has no {name:?}")),
                _ => None,
            };
            if let Some(reason) = reason {
                let set = Target { asset: String::new(), path: set.clone() };
                self.leave_out(here, "variant set", &set, reason)?;
            }
            if !sites.is_empty() {
                let mut below = self.node(Arc::Variant, node.stack, sites)?;
                self.arcs(&mut below, here)?;
                node.nodes.push(below);
                node.nodes.sort_by_key(|node| (node.arc, Reverse(node.age)));
            }
            self.chain.truncate(depth);
            self.work.charge(set.len() as u64 + 32)?;
            node.sets.push(set);
        }
        Ok(())
    }

    /// The strongest set of variants that was not looked at: the way to its node, the last step first, and its name.
    fn next_set(&self, node: &Node) -> Option<(Vec<usize>, String)> {
        for (layer, spec) in &node.sites {
            let layer = self.layers.layer(*layer);
            for variant in &layer.specs[*spec].variants {
                let set = layer.specs[*variant as usize].variant_of.as_ref();
                if let Some(set) = set.filter(|set| !node.sets.contains(set)) {
                    return Some((Vec::new(), set.clone()));
                }
            }
        }
        node.nodes.iter().enumerate().find_map(|(at, node)| {
            let (mut way, set) = self.next_set(node)?;
            way.push(at);
            Some((way, set))
        })
    }

    // ---- layer stacks ------------------------------------------------------------------------

    /// The stack of a layer and its sublayers.
    fn stack(&mut self, root: usize) -> Result<usize, FormatError> {
        if let Some(known) = self.stacks.iter().position(|stack| stack[0] == root) {
            return Ok(known);
        }
        let mut stack = Vec::new();
        let mut open = vec![root];
        while let Some(layer) = open.pop() {
            if stack.contains(&layer) {
                continue;
            }
            stack.push(layer);
            let assets = self.layers.layer(layer).sub_layers.clone();
            for asset in assets.iter().rev() {
                match self.layers.find(layer, asset, self.budget) {
                    Ok(below) if below == root => {
                        self.leave_out_layer(asset, "it leads back to where it comes from".into());
                    }
                    Ok(below) => open.push(below),
                    Err(reason) => self.leave_out_layer(asset, reason),
                }
            }
        }
        self.work.charge_items::<usize>(stack.len() as u64)?;
        self.stacks.push(stack);
        Ok(self.stacks.len() - 1)
    }

    // ---- what is left out --------------------------------------------------------------------

    fn leave_out(&mut self, here: usize, kind: &str, target: &Target, reason: String) -> Done {
        if self.told.is_full() {
            self.told.more();
            return Ok(());
        }
        let path = self.stage.path(here, &mut self.work)?;
        let asset = match (target.asset.as_str(), target.path.as_str()) {
            ("", path) if path.starts_with('/') => format!("<{path}>"),
            ("", path) => path.to_owned(),
            (asset, "") => format!("@{asset}@"),
            (asset, path) => format!("@{asset}@<{path}>"),
        };
        self.told.leave_out(LeftOut { path, kind: kind.into(), asset, reason, is_broken: false });
        Ok(())
    }

    fn leave_out_layer(&mut self, asset: &str, reason: String) {
        let (path, kind) = ("/".to_owned(), "sublayer".to_owned());
        let asset = format!("@{asset}@");
        self.told.leave_out(LeftOut { path, kind, asset, reason, is_broken: false });
    }
}

impl Node {
    /// Leaves of an instance what its own arcs bring in: what is said from outside of prims below it counts nothing.
    fn keep_instance(&mut self, age: u64) {
        if !self.has(age) {
            return;
        }
        self.sites.clear();
        self.nodes.retain_mut(|node| {
            let is_own = node.age == age;
            if !is_own {
                node.keep_instance(age);
            }
            is_own || node.has(age)
        });
    }

    fn has(&self, age: u64) -> bool {
        self.nodes.iter().any(|node| node.age == age || node.has(age))
    }
}

/// Layers and specs of all nodes, the strongest first.
fn all_sites(node: &Node) -> Vec<(usize, Option<usize>)> {
    let mut sites: Vec<_> = node.sites.iter().map(|(layer, spec)| (*layer, Some(*spec))).collect();
    for node in &node.nodes {
        sites.extend(all_sites(node));
    }
    sites
}

fn name_of(arc: Arc) -> &'static str {
    match arc {
        Arc::Inherit => "inherit",
        Arc::Variant => "variant",
        Arc::Reference => "reference",
        Arc::Payload => "payload",
        Arc::Specialize => "specialize",
    }
}
