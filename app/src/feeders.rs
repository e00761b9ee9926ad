//! The curves that hair follows: what feeds the strand-making nodes on the way to outputs.
//!
//! Found from the nodes' declarations, so that a new kind of node needs no line here: a kind that makes fewer
//! strands in preview makes strands; what they follow is wired to its inputs named `guides`, `clusters` or `curves`,
//! and an output named `guides` is what it lays them along itself. Rows that hair is parted along are none of these.

use coif_graphs::document::graph::upstream;
use coif_graphs::document::{Document, NodeId, Socket};
use coif_nodes::define::{InputDef, Type};

/// Outputs whose curves are followed by the hair of `targets`: each once, in the order of the nodes' ids.
pub(crate) fn feeders<'a>(
    document: &Document,
    targets: impl IntoIterator<Item = &'a NodeId>,
) -> Vec<Socket> {
    let mut found: Vec<Socket> = vec![];
    for id in upstream(document, targets) {
        let Some(def) = document.def(&id).filter(|def| def.thins) else { continue };
        let followed = |input: &&InputDef| {
            input.ty == Type::Curves && ["guides", "clusters", "curves"].contains(&input.name)
        };
        for input in def.inputs.iter().filter(followed) {
            found.extend(document.wires(&id, input.name).iter().cloned());
        }
        if def.output("guides").is_some_and(|(_, output)| output.ty == Type::Curves) {
            found.push(Socket::new(id, "guides"));
        }
    }
    let mut once = vec![];
    for socket in found {
        if !once.contains(&socket) {
            once.push(socket);
        }
    }
    once
}

#[cfg(test)]
mod tests {
    use super::*;
    use coif_graphs::{file, grooms};

    #[track_caller]
    fn check(groom: &str, outputs: &[&str], expected: &[&str]) {
        let text = grooms::by_name(groom).unwrap();
        let document = file::read_bytes(text.as_bytes()).unwrap().document;
        let outputs: Vec<NodeId> = outputs.iter().map(|id| NodeId::new(id).unwrap()).collect();
        let found: Vec<String> =
            feeders(&document, &outputs).iter().map(ToString::to_string).collect();
        assert_eq!(found, expected, "{groom}");
    }

    #[test]
    fn the_curves_that_hair_follows_are_found_in_every_kind_of_groom() {
        check("start", &["out"], &["guides.curves"]);
        check("clusters", &["out"], &["clusters.curves"]);
        check("cornrows", &["braids_out"], &["braid.curves"]);
        check("cornrows", &["braids_out", "partings_out"], &["braid.curves"]);
        check("cornrows", &["partings_out"], &[]);
        check("puffs", &["puffs_out"], &["left.guides", "right.guides"]);
        check("puffs", &["base_out"], &["combed.curves"]);
    }
}
