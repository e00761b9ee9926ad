//! Recipes: pieces of a graph that are ready to be drawn into, in one undo step. Afterwards they are plain nodes.

use super::target::{self, Fresh};
use coif_graphs::document::edit::Edit;
use coif_graphs::document::{Document, Node, NodeId, Setting, Socket};
use coif_nodes::data::field::Field;
use coif_nodes::data::ramp::{Blend, Ramp};
use coif_nodes::define::Value;
use std::sync::Arc;

/// A recipe.
pub(crate) struct Recipe {
    /// What menus say.
    pub(crate) label: &'static str,
    /// What it makes.
    pub(crate) tip: &'static str,
    /// The action that makes it.
    pub(crate) action: &'static str,
    /// What the pen draws.
    pub(crate) draws: Draws,
    /// Nodes between what is drawn and the output.
    steps: fn(&mut Graph) -> Option<()>,
}

/// What the pen draws into a recipe.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Draws {
    /// Strokes that lie on the scalp.
    Rows,
    /// Strokes that hang in space.
    Free,
    /// Hair, by gestures.
    Hair,
}

/// All recipes.
pub(crate) const ALL: [Recipe; 6] = [
    Recipe {
        label: "Sketch hair",
        tip: "Draw hair on the head: press and draw to plant a cluster, lightly on from its tip, over hair to comb it.",
        action: "recipe.sketch_hair",
        draws: Draws::Hair,
        steps: |graph| {
            // A lock is widest a little above its root and runs out at its tip.
            let lock = vec![(0.0, 0.85), (0.3, 1.0), (0.75, 0.7), (1.0, 0.2)];
            let lock = Ramp::new(Blend::Smooth, lock).ok()?;
            let fill = [
                ("profile", Value::Ramp(Arc::new(lock))),
                ("strands", Value::Int(1000)),
                ("points", Value::Int(24)),
                ("length_variation", Value::Float(0.15)),
                ("jitter", Value::Float(0.06)),
                ("wisps", Value::Int(7)),
                ("tip_clump", Value::Float(0.35)),
                ("stray", Value::Float(0.03)),
                ("width_root", Value::Float(0.009)),
                ("width_tip", Value::Float(0.004)),
            ];
            graph.add("cluster_to_strands", "strands", &fill)?;
            graph.add("hair_colour", "colour", &[("from", Value::Text("own".into()))])
        },
    },
    Recipe {
        label: "Cornrows",
        tip: "Draw rows on the head; each becomes a three-strand braid that lies on it.",
        action: "recipe.cornrows",
        draws: Draws::Rows,
        steps: |graph| row(graph, "cornrows", 3, 1.2),
    },
    Recipe {
        label: "Flat twists",
        tip: "Draw rows on the head; each becomes two strands turned about each other.",
        action: "recipe.flat_twists",
        draws: Draws::Rows,
        steps: |graph| row(graph, "flat twists", 2, 1.0),
    },
    Recipe {
        label: "Box braids",
        tip: "Draw braids in space, from the root on the scalp to the tip; each hangs as three strands.",
        action: "recipe.box_braids",
        draws: Draws::Free,
        steps: |graph| hanging(graph, "braids", 3),
    },
    Recipe {
        label: "Two-strand twists",
        tip: "Draw twists in space, from the root on the scalp to the tip; each is a rope of two.",
        action: "recipe.two_strand_twists",
        draws: Draws::Free,
        steps: |graph| hanging(graph, "twists", 2),
    },
    Recipe {
        label: "Locks",
        tip: "Draw locks in space, from the root on the scalp to the tip; each is filled with hair.",
        action: "recipe.locks",
        draws: Draws::Free,
        steps: |graph| {
            let radius = Value::Field(Arc::new(Field::Attribute("radius".to_owned())));
            graph.add("cluster_to_strands", "locks", &[("radius", radius)])
        },
    },
];

/// A braid that lies on the scalp.
fn row(graph: &mut Graph, label: &str, strands: i64, width: f32) -> Option<()> {
    let braid = [
        ("strands", Value::Int(strands)),
        ("width", Value::Float(width)),
        ("root_amplitude", Value::Float(0.85)),
        ("tip_amplitude", Value::Float(0.55)),
        ("tie", Value::Float(0.96)),
        ("tuft_length", Value::Float(1.5)),
        ("flare", Value::Float(-0.6)),
    ];
    graph.add("lissajous_braid", label, &braid)?;
    fill(graph, label)
}

/// A braid that hangs.
fn hanging(graph: &mut Graph, label: &str, strands: i64) -> Option<()> {
    let braid = [
        ("strands", Value::Int(strands)),
        ("width", Value::Float(1.2)),
        ("root_amplitude", Value::Float(0.8)),
        ("tip_amplitude", Value::Float(0.7)),
        ("tuft_length", Value::Float(2.0)),
        ("flare", Value::Float(-0.3)),
    ];
    graph.add("lissajous_braid", label, &braid)?;
    fill(graph, label)
}

/// Hair in the strands of a braid.
fn fill(graph: &mut Graph, label: &str) -> Option<()> {
    let radius = Field::Product(vec![Field::Attribute("radius".to_owned()), Field::Constant(1.3)]);
    let fill = [
        ("count", Value::Int(170)),
        ("frizz", Value::Float(0.1)),
        ("frizz_step", Value::Float(1.0)),
        ("points", Value::Int(140)),
        ("radius", radius.into()),
    ];
    graph.add("cluster_to_strands", &format!("hair in the {label}"), &fill)
}

/// A chain of nodes that grows behind the strokes.
struct Graph {
    document: Document,
    head: NodeId,
    last: NodeId,
    edits: Vec<Edit>,
}

impl Graph {
    /// The next node of the chain, wired to the last one and to the head.
    fn add(&mut self, kind: &str, label: &str, set: &[(&str, Value)]) -> Option<()> {
        let def = coif_nodes::by_id(kind)?;
        let mut inputs: std::collections::BTreeMap<String, Setting> = set
            .iter()
            .map(|(name, value)| ((*name).to_owned(), Setting::Known(value.clone())))
            .collect();
        if def.input("seed").is_some() {
            let seed = Value::Int(target::free_seed(&self.document));
            inputs.insert("seed".to_owned(), Setting::Known(seed));
        }
        let id = self.document.free_id(label);
        let label = (!label.is_empty()).then(|| label.to_owned());
        let node = Node { kind: kind.to_owned(), label, inputs, ..Node::default() };
        let at = Some(target::place_beside(&self.document, &self.last, 1.0));
        self.make(Edit::AddNode { id: id.clone(), node: Arc::new(node), at })?;
        let first = |node: &NodeId, document: &Document| -> Option<Socket> {
            let kind = &document.node(node.as_str())?.kind;
            Some(Socket::new(node.clone(), coif_nodes::by_id(kind)?.outputs.first()?.name))
        };
        let curves =
            def.inputs.iter().find(|input| input.ty == coif_nodes::define::Type::Curves)?;
        let from = first(&self.last, &self.document)?;
        let to = Socket::new(id.clone(), curves.name);
        self.make(Edit::Connect { from, to, at: None })?;
        if def.input("scalp").is_some() {
            let (from, to) =
                (Socket::new(self.head.clone(), "scalp"), Socket::new(id.clone(), "scalp"));
            self.make(Edit::Connect { from, to, at: None })?;
        }
        self.last = id;
        Some(())
    }

    fn make(&mut self, edit: Edit) -> Option<()> {
        edit.apply(&mut self.document).ok()?;
        self.edits.push(edit);
        Some(())
    }
}

impl Recipe {
    /// The edits of the recipe, and the node that is to be drawn into: `strokes` when that is given and nothing takes from
    /// it yet, else a new one. None where the document has no head.
    pub(crate) fn edits(
        &self,
        document: &Document,
        strokes: Option<&NodeId>,
        mirror: bool,
    ) -> Option<(NodeId, Vec<Edit>)> {
        let head = target::head(document)?;
        let idle = |id: &&NodeId| {
            let takes = document.links.values().flatten().any(|from| from.node == **id);
            !takes && self.draws == Draws::Rows && target::draws_curves(document, id)
        };
        let free = self.draws == Draws::Free;
        let (rows, edits) = match strokes.filter(idle) {
            Some(rows) => (rows.clone(), vec![]),
            None if self.draws == Draws::Hair => super::hair::target::make(document, None)?,
            None => target::make(document, Fresh { free, mirror })?,
        };
        let mut graph =
            Graph { document: document.clone(), head, last: rows.clone(), edits: vec![] };
        for edit in edits {
            graph.make(edit)?;
        }
        (self.steps)(&mut graph)?;
        let hair = graph.last.clone();
        graph.add("groom_output", "", &[])?;
        graph.make(Edit::SetDisplay(Some(hair)))?;
        Some((rows, graph.edits))
    }
}
