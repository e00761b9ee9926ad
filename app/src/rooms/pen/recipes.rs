//! Recipes: templates that are put onto the head at hand and taken apart, in one undo step: plain nodes, to go on from.
//!
//! What a template has as inputs stays in one place: a node of parameters, called as the recipe is, that the plain nodes read.
//! Seeds follow on those that the document has, so that the same recipe twice is not the same hair twice. Who wants what can be upgraded
//! takes the template itself.

use super::target;
use crate::core::faces::Faces;
use crate::core::faces::arrange::{GAP, free_place, point};
use crate::core::shown::Reports;
use crate::library;
use coif_graphs::document::edit::{Edit, between};
use coif_graphs::document::{
    Document, Node, NodeId, Point, Setting, Socket, graph, groups, wiring,
};
use coif_graphs::grooms;
use coif_graphs::template::{self, Placement};
use coif_nodes::data::landmarks::Landmarks;
use coif_nodes::define::Value;
use egui::{Rect, vec2};
use std::cmp::Ordering;
use std::collections::BTreeSet;
use std::sync::Arc;

/// A recipe.
pub(crate) struct Recipe {
    /// The template that it puts in, of those that come with coif.
    pub(crate) template: &'static str,
    /// What menus say.
    pub(crate) label: &'static str,
    /// What it makes.
    pub(crate) tip: &'static str,
    /// The action that makes it.
    pub(crate) action: &'static str,
    /// What the pen draws.
    pub(crate) draws: Draws,
}

/// Fills what is sketched on a bare head: [`ALL`] by number.
pub(crate) const SKETCH: usize = 1;

/// The kind of node that gives hair to files.
const OUTPUT: &str = "groom_output";

/// What the pen draws into a recipe.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Draws {
    /// Strokes that lie on the scalp.
    Rows,
    /// Strokes that hang in space.
    Free,
    /// Hair, by gestures.
    Hair,
    /// Nothing: the hair is there.
    Nothing,
}

/// All recipes: first those to draw into.
pub(crate) const ALL: [Recipe; 17] = [
    Recipe {
        template: "flow_hair",
        label: "Draw a hairstyle",
        tip: "Draw a few strokes from root to tip, such as ten for a bob: hair fills the head between them, and parts where they leave each other.",
        action: "recipe.flow_hair",
        draws: Draws::Hair,
    },
    Recipe {
        template: "sketch_hair",
        label: "Sketch hair",
        tip: "Draw hair on the head: press to implant a cluster, draw lightly from its tip to lengthen it, over hair to comb.",
        action: "recipe.sketch_hair",
        draws: Draws::Hair,
    },
    Recipe {
        template: "draw_cornrows",
        label: "Cornrows",
        tip: "Draw rows on the head; each becomes a cornrow of three strands.",
        action: "recipe.cornrows",
        draws: Draws::Rows,
    },
    Recipe {
        template: "flat_twists",
        label: "Flat twists",
        tip: "Draw rows on the head; each becomes a flat twist of two strands.",
        action: "recipe.flat_twists",
        draws: Draws::Rows,
    },
    Recipe {
        template: "draw_box_braids",
        label: "Box braids",
        tip: "Draw braids in space, from root to tip; each becomes a hanging braid of three strands.",
        action: "recipe.box_braids",
        draws: Draws::Free,
    },
    Recipe {
        template: "draw_two_strand_twists",
        label: "Two-strand twists",
        tip: "Draw twists in space, from root to tip; each becomes a rope of two strands.",
        action: "recipe.two_strand_twists",
        draws: Draws::Free,
    },
    Recipe {
        template: "locks",
        label: "Locks",
        tip: "Draw locks in space, from root to tip; each is filled with hair.",
        action: "recipe.locks",
        draws: Draws::Free,
    },
    Recipe {
        template: "long_straight",
        label: "Long straight",
        tip: "Long hair, parted in the middle and cut to one length.",
        action: "recipe.long_straight",
        draws: Draws::Nothing,
    },
    Recipe {
        template: "bob",
        label: "Bob with a side parting",
        tip: "Cut level at the jaw and parted at the side.",
        action: "recipe.bob",
        draws: Draws::Nothing,
    },
    Recipe {
        template: "waves",
        label: "Waves",
        tip: "Shoulder-length waves with a side parting, in locks of many sizes.",
        action: "recipe.waves",
        draws: Draws::Nothing,
    },
    Recipe {
        template: "fringe",
        label: "Fringe",
        tip: "A fringe from a wedge above the forehead, combed forward and cut level above the brows.",
        action: "recipe.fringe",
        draws: Draws::Nothing,
    },
    Recipe {
        template: "pony_tail",
        label: "Ponytail",
        tip: "All hair combed into a tie at the back, with a lock wound around the band.",
        action: "recipe.pony_tail",
        draws: Draws::Nothing,
    },
    Recipe {
        template: "puff",
        label: "Puff",
        tip: "A round puff at the back of the crown, in coils. Drag its handle to move it.",
        action: "recipe.puff",
        draws: Draws::Nothing,
    },
    Recipe {
        template: "afro",
        label: "Afro",
        tip: "Kinky hair, picked out and cut round.",
        action: "recipe.afro",
        draws: Draws::Nothing,
    },
    Recipe {
        template: "short_back_and_sides",
        label: "Short back and sides",
        tip: "Clipped at the back and over the ears, longer on top and combed forward.",
        action: "recipe.short_back_and_sides",
        draws: Draws::Nothing,
    },
    Recipe {
        template: "beard",
        label: "Beard",
        tip: "A full beard and moustache in a region of its own, whose outline you can draw anew.",
        action: "recipe.beard",
        draws: Draws::Nothing,
    },
    Recipe {
        template: "brows",
        label: "Brows",
        tip: "Eyebrows in a region of their own, whose outline you can draw anew.",
        action: "recipe.brows",
        draws: Draws::Nothing,
    },
];

/// A recipe as it is put into a document.
pub(crate) struct RecipeEdits {
    /// The node that holds its inputs, to be selected.
    pub(crate) inputs: NodeId,
    /// The node that the pen draws into, where it draws.
    pub(crate) drawn: Option<NodeId>,
    /// All of it.
    pub(crate) edits: Vec<Edit>,
}

impl Recipe {
    /// Whether the pen is to draw it.
    pub(crate) fn is_drawn(&self) -> bool {
        self.draws != Draws::Nothing
    }

    /// Whether it grows in a region of its own, beside whatever hair the head has.
    pub(crate) fn grows_elsewhere(&self) -> bool {
        matches!(self.template, "beard" | "brows")
    }

    /// The same on the bare head: the hair that is there goes.
    ///
    /// # Errors
    /// As [`Recipe::edits`].
    pub(crate) fn instead(
        &self,
        document: &Document,
        mirror: bool,
        here: Option<&Landmarks>,
    ) -> Result<RecipeEdits, String> {
        let bare = wiring::without_hair(document, wiring::Hair::OfHead);
        let made = self.edits(&bare, None, mirror, here)?;
        let edits = [between(document, &bare)].into_iter().chain(made.edits).collect();
        Ok(RecipeEdits { edits, ..made })
    }

    /// The edits of the recipe. Its head is the one at hand, where the document has one; rows are drawn into `strokes`, when
    /// nothing takes from it yet. `mirror`: what is drawn is drawn on both sides. What the recipe itself has drawn, such as a parting or
    /// the outline of a beard, lies between the landmarks `here` as it does on the built-in head.
    ///
    /// # Errors
    /// Why it cannot be made, for people.
    pub(crate) fn edits(
        &self,
        document: &Document,
        strokes: Option<&NodeId>,
        mirror: bool,
        here: Option<&Landmarks>,
    ) -> Result<RecipeEdits, String> {
        let found = grooms::TEMPLATES.iter().find(|(name, _)| *name == self.template);
        let (_, text) = found.ok_or("it does not come with this version")?;
        let template = library::shipped(text)?.fitted(here);
        let drawn = strokes.filter(|_| self.draws == Draws::Rows);
        // Where it stands in its own file, until all of it is moved.
        let at = template::group_of(&template)?;
        let at = Some(template.layout.get(at).copied().unwrap_or_default());
        let added =
            template::add(document, &template, Placement { drawn, at, ..Placement::default() })?;
        let mut grouped = document.clone();
        added.edit.apply(&mut grouped).map_err(|err| err.to_string())?;
        let (grouped, inputs) = groups::set_by_parameters(&grouped, &added.id, self.label)?;
        let inputs = inputs.ok_or("it has no inputs")?;
        let (mut plain, _) = groups::ungroup(&grouped, &added.id)?;
        let after = last_seed(document);
        let is_new = |id: &NodeId| !document.nodes.contains_key(id);
        for (id, node) in plain.nodes.iter_mut().filter(|(id, _)| is_new(id)) {
            let node = Arc::make_mut(node);
            match added.draws.as_ref() == Some(id) {
                true => drop(node.inputs.remove("seed")),
                false => follow(node, after),
            }
        }
        leave_out(document, &mut plain);
        place(document, &mut plain, &template);
        let seed = graph::free_seed(&plain);
        if let Some(node) = added.draws.as_ref().and_then(|id| plain.nodes.get_mut(id)) {
            let node = Arc::make_mut(node);
            node.inputs.entry("seed".to_owned()).or_insert(Setting::Known(Value::Int(seed)));
            if mirror && self.draws != Draws::Hair {
                let both = Setting::Known(Value::Text("both".into()));
                node.inputs.insert("mirror".to_owned(), both);
            }
        }
        self.name_outputs(document, &mut plain);
        let kind = |id: &NodeId, kind: &str| plain.nodes[id].kind == kind;
        let outputs =
            plain.links.iter().filter(|(to, _)| is_new(&to.node) && kind(&to.node, OUTPUT));
        let hair = outputs.flat_map(|(_, from)| from).find(|from| kind(&from.node, "hair_colour"));
        let hair = hair.map(|from| from.node.clone()).ok_or("it gives no hair")?;
        // With other hair all outputs are shown, or the one would hide the other.
        let rest = document.nodes.values().any(|node| node.kind == OUTPUT);
        let show = (!rest).then_some(hair);
        plain.display = None;
        let edits = vec![between(document, &plain), Edit::SetDisplay(show)];
        Ok(RecipeEdits { inputs, drawn: added.draws, edits })
    }

    /// Calls the new outputs that have no name as the recipe is, with a number where hair of that name is there already.
    fn name_outputs(&self, document: &Document, plain: &mut Document) {
        let stem = self.template.strip_prefix("draw_").unwrap_or(self.template);
        let name_of = |node: &Arc<Node>| match node.inputs.get("name") {
            Some(Setting::Known(Value::Text(name))) if node.kind == OUTPUT => Some(name.clone()),
            _ => None,
        };
        let taken: BTreeSet<Arc<str>> = document.nodes.values().filter_map(name_of).collect();
        let mut names = (1..).map(|n| match n {
            1 => Arc::<str>::from(stem),
            n => format!("{stem}_{n}").into(),
        });
        let free = names.find(|name| !taken.contains(name)).unwrap_or_else(|| stem.into());
        let is_new = |id: &NodeId| !document.nodes.contains_key(id);
        let new = plain.nodes.iter_mut().filter(|(id, node)| is_new(id) && node.kind == OUTPUT);
        for (_, node) in new {
            let name = Setting::Known(Value::Text(free.clone()));
            Arc::make_mut(node).inputs.entry("name".to_owned()).or_insert(name);
        }
    }
}

/// What is left out of the head at hand is left out of what is new, too; regions of their own stay these.
fn leave_out(document: &Document, plain: &mut Document) {
    let Some((region, edits)) = super::leave_out::region(document, false) else { return };
    let Some(head) = graph::head_at_hand(document).filter(|_| edits.is_empty()) else { return };
    let [from, to] = [head, region].map(|id| Socket::new(id, "scalp"));
    let takes = |id: &NodeId| !document.nodes.contains_key(id) && !target::is_region(plain, id);
    let taking: Vec<Socket> =
        plain.links.keys().filter(|input| takes(&input.node)).cloned().collect();
    for input in taking {
        let wires = plain.links.get_mut(&input).into_iter().flatten();
        wires.filter(|wire| **wire == from).for_each(|wire| wire.clone_from(&to));
    }
}

/// Places what is new: its head onto the head at hand, but under everything else that is there, and no node over another.
fn place(document: &Document, plain: &mut Document, template: &Document) {
    let head = |of: &Document| of.layout.get(&graph::head_at_hand(of)?).copied();
    let (from, to) = (head(template).unwrap_or_default(), head(document).unwrap_or_default());
    let is_new = |id: &NodeId| !document.nodes.contains_key(id);
    let known = graph::head_at_hand(document);
    let faces = Faces::new(plain, &Reports::default(), &BTreeSet::new(), None, None);
    let rects = || faces.all.keys().filter_map(|id| Some((id, faces.rect(id)?)));
    let theirs = rects().filter(|(id, _)| !is_new(id) && known.as_ref() != Some(*id));
    let lowest = theirs.map(|(_, rect)| rect.bottom()).reduce(f32::max);
    let top = rects().filter(|(id, _)| is_new(id)).map(|(_, rect)| rect.top()).reduce(f32::min);
    let by = to.1 - from.1;
    let down = lowest.zip(top).map_or(by, |(lowest, top)| by.max(lowest + 2.0 * GAP.y - top));
    let shift = vec2(to.0 - from.0, down);
    let mut taken: Vec<Rect> = rects().filter(|(id, _)| !is_new(id)).map(|(_, it)| it).collect();
    let mut new: Vec<(&NodeId, Rect)> = rects().filter(|(id, _)| is_new(id)).collect();
    new.sort_by(|(_, a), (_, b)| {
        (a.top(), a.left()).partial_cmp(&(b.top(), b.left())).unwrap_or(Ordering::Equal)
    });
    for (id, rect) in new {
        let at = free_place(&taken, rect.min + shift, rect.size());
        taken.push(Rect::from_min_size(at, rect.size()));
        plain.layout.insert(id.clone(), point(at));
    }
    let bends = plain.bends.iter_mut().filter(|(to, _)| is_new(&to.node));
    let moved = |at: &mut Point| *at = Point(at.0 + shift.x, at.1 + shift.y);
    bends.flat_map(|(_, wires)| wires).flatten().for_each(moved);
}

fn last_seed(document: &Document) -> i64 {
    document.nodes.values().filter_map(|node| node.seed()).max().unwrap_or(0).max(0)
}

/// Where a document ended with its seeds a recipe goes on.
fn follow(node: &mut Node, after: i64) {
    if let Some(seed) = node.seed() {
        let seed = Value::Int(seed.saturating_add(after));
        node.inputs.insert("seed".to_owned(), Setting::Known(seed));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::core::event::Event;
    use crate::core::state::Select;
    use crate::rooms::pen::PenTool;
    use crate::rooms::pen::tests::{Table, draw_on, head, row};
    use coif_graphs::schedule::files::DiskFiles;
    use coif_graphs::schedule::request::plan;
    use coif_graphs::schedule::run::{CancelToken, Evaluator, OnFailure, Quiet};
    use coif_nodes::eval::Quality;
    use egui::Pos2;
    use std::path::Path;

    fn table_with(recipe: &Recipe) -> Table {
        let mut table = draw_on(head());
        table.editor().act(recipe.action);
        assert_eq!(table.done(), 1, "{}", recipe.label);
        let problems = coif_graphs::document::graph::check(&table.editor().state.document);
        assert!(problems.is_empty(), "{}: {problems:?}", recipe.label);
        table
    }

    #[test]
    fn recipes_are_templates_and_those_to_draw_bring_what_is_drawn_into() {
        for recipe in &ALL {
            let text = grooms::TEMPLATES.iter().find(|(name, _)| *name == recipe.template);
            let template = library::shipped(text.unwrap().1).unwrap().document;
            let added = template::add(&head(), &template, Placement::default()).unwrap();
            assert_eq!(added.draws.is_some(), recipe.is_drawn(), "{}", recipe.label);
        }
    }

    #[test]
    fn recipes_are_one_step_of_plain_nodes_and_a_row_drawn_is_a_braid() {
        for recipe in ALL.iter().filter(|recipe| recipe.is_drawn()) {
            let mut table = table_with(recipe);
            // Hair is planted with a heavy hand.
            let hair = recipe.draws == Draws::Hair;
            let row: Vec<(Pos2, f32)> =
                row(300.0).into_iter().map(|(at, p)| (at, if hair { 0.9 } else { p })).collect();
            table.draw(&row);
            table.rest();
            while table.editor().pen.touches.is_busy() {
                table.rest();
            }
            assert_eq!(table.done(), 2, "{}", recipe.label);
            let shown = table.editor().state.shown.clone().expect("a result");
            let count = shown.curves.curve_count();
            assert!(count > 50, "{}: {count}", recipe.label);
            table.editor().apply(Event::Undo);
            table.editor().apply(Event::Undo);
            assert_eq!(table.editor().state.document, head());
        }
    }

    #[test]
    fn a_beard_and_brows_join_the_hair_of_the_head_and_their_outline_is_drawn_anew() {
        let mut table = table_with(&ALL[14]);
        for recipe in &ALL[15..] {
            table.editor().act(recipe.action);
            let pen = &table.editor().pen;
            assert!(pen.asked.is_none() && pen.tool == PenTool::Select, "{}", recipe.label);
        }
        let state = &table.editor().state;
        let of = |kind: &str| state.document.nodes.iter().filter(|(_, n)| n.kind == kind).count();
        assert_eq!((of("head"), of("region"), of("groom_output")), (1, 2, 3));
        let region = state.document.nodes.iter().find(|(_, node)| node.kind == "region");
        let region = region.map(|(id, _)| id.clone()).expect("a region");
        table.editor().apply(Event::Select(Select::Nodes(vec![region.clone()])));
        table.editor().act("pen.region");
        assert_eq!(target::of(&table.editor().state, target::Fills::Strokes), Some(region));
    }

    #[test]
    fn loose_hair_is_there_in_one_step_with_its_inputs_selected() {
        let mut table = table_with(&ALL[14]);
        table.rest();
        let shown = table.editor().state.shown.clone().expect("a result");
        assert!(shown.curves.curve_count() > 5000, "{}", shown.curves.curve_count());
        let state = &table.editor().state;
        let active = state.active().and_then(|id| state.document.node(id.as_str()));
        assert_eq!(active.map(|node| node.kind.as_str()), Some("parameters"));
        table.editor().apply(Event::Undo);
        assert_eq!(table.editor().state.document, head());
        for recipe in ALL.iter().filter(|recipe| !recipe.is_drawn()) {
            let made = recipe.edits(&head(), None, false, None).expect(recipe.label);
            let mut document = head();
            Edit::Several(made.edits).apply(&mut document).expect(recipe.label);
            let problems = coif_graphs::document::graph::check(&document);
            assert!(problems.is_empty(), "{}: {problems:?}", recipe.label);
            let output = document.links.iter().find(|(to, _)| to.node.as_str() == "out").unwrap();
            assert_eq!(document.display, Some(output.1[0].node.clone()), "{}", recipe.label);
            let inputs = document.node(made.inputs.as_str());
            assert_eq!(inputs.and_then(|node| node.label.as_deref()), Some(recipe.label));
            let kinds: Vec<&str> = document.nodes.values().map(|node| node.kind.as_str()).collect();
            for kind in ["hair_colour", "head"] {
                let count = kinds.iter().filter(|it| **it == kind).count();
                assert_eq!(count, 1, "{}: {kind}", recipe.label);
            }
            assert!(!kinds.contains(&"group"), "{}: plain nodes", recipe.label);
        }
    }

    #[test]
    fn over_hair_a_recipe_asks_instead_or_as_well() {
        use egui_kittest::kittest::Queryable as _;
        let outputs = |table: &mut Table| {
            let document = &table.editor().state.document;
            let kinds = document.nodes.values().filter(|node| node.kind == "groom_output");
            (kinds.count(), document.nodes.contains_key(&NodeId::new("head").unwrap()))
        };
        let mut table = table_with(&ALL[2]);
        let before = table.editor().state.document.clone();
        for (words, expected) in [("Cancel", 1), ("As well", 2), ("Instead", 1)] {
            table.editor().act(ALL[6].action);
            table.step();
            table.step();
            assert_eq!(table.editor().state.document, before, "nothing is done before it is asked");
            table.harness.get_by_label(words).click();
            table.step();
            table.step();
            assert_eq!(outputs(&mut table), (expected, true), "{words}");
            let nodes = table.editor().state.document.nodes.clone();
            let inputs = nodes.values().filter(|node| node.kind == "parameters").count();
            assert_eq!(inputs, expected, "{words}: hair goes with its inputs");
            assert!(table.harness.query_by_label("Instead").is_none());
            if words != "Cancel" {
                assert_eq!(table.done(), 2, "one step");
                table.editor().apply(Event::Undo);
            }
        }
        assert_eq!(table.editor().state.document, before);
    }

    #[test]
    fn recipes_name_no_colour_that_somebody_may_change() {
        for recipe in &ALL {
            let made = recipe.edits(&head(), None, false, None).expect(recipe.label);
            let mut document = head();
            Edit::Several(made.edits).apply(&mut document).expect(recipe.label);
            for node in document.nodes.values().filter(|node| node.kind == "hair_colour") {
                let said = format!("{}{}", node.label.clone().unwrap_or_default(), node.note);
                assert_eq!(said, "colour", "{}", recipe.label);
            }
        }
    }

    #[test]
    fn a_second_recipe_shows_beside_the_first_on_the_same_head_and_has_seeds_of_its_own() {
        let mut document = head();
        let bob = &ALL[8];
        for recipe in [bob, bob, &ALL[10]] {
            let made = recipe.edits(&document, None, false, None).unwrap();
            Edit::Several(made.edits).apply(&mut document).unwrap();
        }
        assert_eq!(document.display, None, "all outputs are shown");
        let count = |kind: &str| document.nodes.values().filter(|node| node.kind == kind).count();
        assert_eq!((count("head"), count("groom_output")), (1, 3));
        // What makes a hair and what cuts it may share one.
        let seeds = document.nodes.values().filter_map(|node| Some((&node.kind, node.seed()?)));
        let seeds: Vec<_> = seeds.collect();
        assert_eq!(seeds.len(), seeds.iter().collect::<BTreeSet<_>>().len(), "{seeds:?}");
        let places: BTreeSet<String> =
            document.layout.values().map(|at| format!("{at:?}")).collect();
        assert_eq!(places.len(), document.layout.len(), "no node lies on another");
        // A document without a head gets the recipe's own.
        let made = bob.edits(&Document::default(), None, false, None).unwrap();
        let mut document = Document::default();
        Edit::Several(made.edits).apply(&mut document).unwrap();
        assert_eq!(document.nodes.values().filter(|node| node.is_head()).count(), 1);
    }

    #[test]
    fn rows_are_drawn_into_idle_strokes_and_on_both_sides_where_the_pen_does() {
        let document = head();
        let (strokes, edits) = target::make(&document, false).unwrap();
        let mut document = document;
        Edit::Several(edits).apply(&mut document).unwrap();
        let rows = ALL[2].edits(&document, Some(&strokes), false, None).unwrap();
        assert_eq!(rows.drawn.as_ref(), Some(&strokes));
        let fresh = ALL[2].edits(&head(), None, true, None).unwrap();
        let mut document = head();
        Edit::Several(fresh.edits).apply(&mut document).unwrap();
        let drawn = fresh.drawn.expect("strokes");
        assert_eq!(target::choice(&document, &drawn, "mirror").as_deref(), Some("both"));
    }

    /// What a recipe is drawn into holds what its template's file has drawn there.
    fn as_drawn(recipe: &Recipe, document: &mut Document, into: &NodeId) {
        let text = grooms::TEMPLATES.iter().find(|(name, _)| *name == recipe.template);
        let template = library::shipped(text.unwrap().1).unwrap().document;
        let kind = document.nodes[into].kind.clone();
        let theirs = template.nodes.values().find(|node| node.kind == kind).expect(recipe.label);
        let drawn = theirs.inputs.iter().filter(|(_, setting)| {
            matches!(setting, Setting::Known(Value::Strokes(_) | Value::Gestures(_)))
        });
        let node = Arc::make_mut(document.nodes.get_mut(into).unwrap());
        let before = node.inputs.len();
        node.inputs.extend(drawn.map(|(name, value)| (name.clone(), value.clone())));
        assert!(node.inputs.len() > before, "{}: something is drawn", recipe.label);
    }

    /// How a recipe's input is turned: amounts become small, so that the rest is quick.
    fn turned(port: &coif_nodes::declared::Port) -> Value {
        use coif_nodes::define::Type;
        let (lo, hi) = port.soft.or(port.hard).unwrap_or((0.0, 1.0));
        let now = port.default.clone();
        match (port.ty, now) {
            (Type::Int, Some(Value::Int(n))) => {
                Value::Int(if n as f64 > lo { n - 1 } else { n + 1 })
            }
            (Type::Vec3, Some(Value::Vec3(at))) => {
                Value::Vec3(at + glam::Vec3::new(0.4, 0.3, -0.2))
            }
            (Type::Float | Type::Field, Some(value)) => {
                let x = match value {
                    Value::Float(x) => f64::from(x),
                    Value::Field(field) => field.constant().map_or(0.5 * (lo + hi), f64::from),
                    _ => 0.5 * (lo + hi),
                };
                // Most of the way to the farther end.
                let end = if x - lo > hi - x { lo } else { hi };
                Value::Float((x + 0.75 * (end - x)) as f32)
            }
            other => panic!("{}: {other:?}", port.name),
        }
    }

    #[test]
    fn every_recipe_says_its_length_or_size_and_its_amount_of_hair_first_and_each_input_changes_the_hair()
     {
        const SIZES: [&str; 3] = ["length", "size", "width"];
        const AMOUNTS: [(&str, f64); 4] =
            [("count", 400.0), ("density", 20.0), ("hairs", 8.0), ("strands", 200.0)];
        let evaluator = Evaluator::new(1, 256 << 20).expect("a thread");
        for recipe in &ALL {
            let mut table = draw_on(head());
            table.editor().act(recipe.action);
            table.step();
            // The inspector shows them: they are active at once.
            let active = table.editor().state.active().cloned().expect(recipe.label);
            let mut document = table.editor().state.document.clone();
            let node = document.nodes[&active].clone();
            assert_eq!((&*node.kind, node.label.as_deref()), ("parameters", Some(recipe.label)));
            let ports = node.interface.expect("ports").inputs();
            let names: Vec<&str> = ports.iter().map(|port| port.name.as_str()).collect();
            assert!(SIZES.contains(&names[0]), "{}: {names:?}", recipe.label);
            let amount = ports.iter().find_map(|port| {
                let (_, few) = AMOUNTS.iter().find(|(name, _)| *name == port.name)?;
                // Of braids the strands are no amount.
                (port.default.as_ref().is_some_and(|it| !matches!(it, Value::Int(n) if *n < 20)))
                    .then_some((port, *few))
            });
            let (amount, few) = amount.unwrap_or_else(|| panic!("{}: {names:?}", recipe.label));
            for port in ports {
                let has_range = port.hard.is_some() || port.ty == coif_nodes::define::Type::Vec3;
                assert!(has_range && port.default.is_some(), "{}: {}", recipe.label, port.name);
                assert!(
                    port.doc.len() > 10 && port.doc.ends_with('.'),
                    "{}: {}",
                    recipe.label,
                    port.name
                );
            }
            if let Some(pinned) = table.editor().state.pinned.clone() {
                as_drawn(recipe, &mut document, &pinned);
            }
            let few = match amount.ty {
                coif_nodes::define::Type::Int => Value::Int(few as i64),
                _ => Value::Float(few as f32),
            };
            let set = |document: &mut Document, name: &str, value: Value| {
                let (node, input, setting) =
                    (active.clone(), name.to_owned(), Setting::Known(value));
                Edit::SetInput { node, input, setting }.apply(document).expect(name);
            };
            set(&mut document, &amount.name, few);
            let hair = Socket::new(document.display.clone().expect(recipe.label), "curves");
            let seen = |document: &Document| {
                let files = DiskFiles::new(Path::new(""));
                let wanted = std::slice::from_ref(&hair);
                let plan = plan(document, wanted, Quality::Preview, &files).expect(recipe.label);
                let run = evaluator.run(&plan, OnFailure::Stop, &CancelToken::default(), &Quiet);
                let Some(Some(Value::Curves(curves))) = run.targets.first() else {
                    panic!("{}: no hair", recipe.label);
                };
                assert!(curves.curve_count() > 4, "{}", recipe.label);
                curves.key()
            };
            let as_made = seen(&document);
            for port in ports {
                let mut turned_one = document.clone();
                let value = match port.name == amount.name {
                    true => match document.nodes[&active].inputs.get(&port.name) {
                        Some(Setting::Known(Value::Int(n))) => Value::Int(n * 2),
                        Some(Setting::Known(Value::Float(x))) => Value::Float(x * 2.0),
                        other => panic!("{other:?}"),
                    },
                    false => turned(port),
                };
                set(&mut turned_one, &port.name, value);
                assert_ne!(seen(&turned_one), as_made, "{}: {}", recipe.label, port.name);
            }
        }
    }

    #[test]
    fn a_saved_groom_of_a_recipe_takes_its_inputs_on_the_command_line() {
        let mut document = head();
        let made = ALL[8].edits(&document, None, false, None).unwrap();
        Edit::Several(made.edits).apply(&mut document).unwrap();
        let text = coif_graphs::file::write(&document);
        let read = coif_graphs::file::read(&text).unwrap();
        assert!(read.warnings.is_empty() && read.document == document, "{:?}", read.warnings);
        // Two of a kind: each has its own, and the second its name in files.
        let made = ALL[8].edits(&document, None, false, None).unwrap();
        Edit::Several(made.edits).apply(&mut document).unwrap();
        let parameters: Vec<&str> = document
            .nodes
            .iter()
            .filter(|(_, n)| n.kind == "parameters")
            .map(|(id, _)| id.as_str())
            .collect();
        assert_eq!(parameters, ["parameters", "parameters_2"]);
        let outputs = crate::jobs::evaluate::outputs(&document, &[]).ok().expect("outputs");
        let groups: Vec<&str> = outputs.iter().map(|output| output.group.as_str()).collect();
        assert_eq!(groups, ["bob", "bob_2"]);
    }

    #[test]
    fn nodes_of_a_recipe_cover_no_other_node() {
        let cornrows =
            coif_graphs::file::read(grooms::by_name("cornrows").unwrap()).unwrap().document;
        for recipe in &ALL {
            let mut document = cornrows.clone();
            for _ in 0..2 {
                let made = recipe.edits(&document, None, false, None).expect(recipe.label);
                Edit::Several(made.edits).apply(&mut document).expect(recipe.label);
            }
            let faces = Faces::new(&document, &Reports::default(), &BTreeSet::new(), None, None);
            let rects: Vec<Rect> = faces.all.keys().filter_map(|id| faces.rect(id)).collect();
            assert_eq!(rects.len(), document.nodes.len());
            for (i, a) in rects.iter().enumerate() {
                assert!(rects[..i].iter().all(|b| !a.intersects(*b)), "{}", recipe.label);
            }
        }
    }

    #[test]
    fn what_is_left_out_of_a_head_stays_so_under_other_hair() {
        let mut document = head();
        let apply = |document: &mut Document, edits: Vec<Edit>| {
            Edit::Several(edits).apply(document).expect("it is made");
        };
        let made = ALL[8].edits(&document, None, false, None).unwrap();
        apply(&mut document, made.edits);
        let (bare, edits) = crate::rooms::pen::leave_out::region(&document, false).unwrap();
        apply(&mut document, edits);
        for recipe in [&ALL[7], &ALL[15]] {
            let made = recipe.instead(&document, false, None).unwrap();
            let mut document = document.clone();
            apply(&mut document, made.edits);
            let head = graph::head_at_hand(&document).unwrap();
            let reads = |from: &NodeId| {
                let readers = document.links.iter();
                let readers = readers.filter(|(_, wires)| wires.iter().any(|w| w.node == *from));
                readers
                    .map(|(to, _)| document.nodes[&to.node].kind.as_str())
                    .collect::<BTreeSet<_>>()
            };
            // A beard's own region is where it is.
            assert_eq!(reads(&head), ["region"].into(), "{}", recipe.label);
            assert_eq!(reads(&bare).is_empty(), recipe.grows_elsewhere(), "{}", recipe.label);
        }
    }
}
