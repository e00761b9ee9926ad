//! Where a curve comes from: the node that made it, and its ancestors with the nodes that made those.
//!
//! Curves carry their own id and their parent's. A node made a curve when it gives it and nothing it reads does; a
//! node that only reshapes hair keeps its ids and made nothing.

use coif_graphs::document::NodeId;
use coif_nodes::data::attributes::{ID, PARENT};
use coif_nodes::data::curves::Curves;

/// A curve and who made it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Ancestor {
    /// The curve's id.
    pub id: u64,
    /// The first node that gives it.
    pub node: NodeId,
}

/// The longest line of ancestors that is followed: a hair, its strand, its braid, its stroke, and some to spare.
const MOST: usize = 16;

/// The line of a curve from itself upwards. `outputs` are the curves of every node on the way, sources first.
pub fn lineage(outputs: &[(NodeId, Curves)], id: u64) -> Vec<Ancestor> {
    let mut line: Vec<Ancestor> = vec![];
    let mut wanted = id;
    while line.len() < MOST && wanted != 0 && line.iter().all(|known| known.id != wanted) {
        let Some((node, parent)) = maker(outputs, wanted) else { break };
        line.push(Ancestor { id: wanted, node });
        wanted = parent;
    }
    line
}

/// The first node that gives a curve, and the curve's parent there.
fn maker(outputs: &[(NodeId, Curves)], id: u64) -> Option<(NodeId, u64)> {
    outputs.iter().find_map(|(node, curves)| {
        curves.tufts().iter().find_map(|tuft| {
            let ids = tuft.view(ID);
            let i = (0..tuft.len()).find(|i| ids.at(*i, 0) == id)?;
            Some((node.clone(), tuft.view(PARENT).at(i, 0)))
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use coif_nodes::data::attributes::Domain;
    use coif_nodes::data::curves::TuftBuilder;
    use glam::Vec3;

    fn curves(ids: &[(u64, u64)]) -> Curves {
        let mut tuft = TuftBuilder::new();
        for _ in ids {
            tuft.push_curve(&[Vec3::ZERO, Vec3::Y]);
        }
        tuft.set(ID, Domain::Curve, ids.iter().map(|(id, _)| *id).collect());
        tuft.set(PARENT, Domain::Curve, ids.iter().map(|(_, parent)| *parent).collect());
        Curves::new(vec![tuft.build().into()])
    }

    #[test]
    fn a_hair_leads_to_the_first_node_that_gives_it_and_so_do_its_ancestors() {
        let node = |name: &str| NodeId::new(name).expect("an id");
        let outputs = [
            (node("rows"), curves(&[(1, 0), (2, 0)])),
            (node("braid"), curves(&[(11, 1), (12, 2)])),
            (node("fill"), curves(&[(101, 11), (102, 12)])),
            (node("curl"), curves(&[(101, 11), (102, 12)])),
        ];
        let found: Vec<(u64, String)> =
            lineage(&outputs, 102).into_iter().map(|a| (a.id, a.node.to_string())).collect();
        assert_eq!(
            found,
            [(102, "fill".to_owned()), (12, "braid".to_owned()), (2, "rows".to_owned())]
        );
        assert_eq!(lineage(&outputs, 7), []);
        // Curves that are their own parents do not lead round for ever.
        let round = [(node("a"), curves(&[(1, 2), (2, 1)]))];
        assert_eq!(lineage(&round, 1).len(), 2);
    }
}
