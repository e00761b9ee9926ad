//! The groom nodes: pure functions from geometry to geometry, one file each.
//!
//! Folders follow the order in which hair is made (scalp, guides, braid, partition, curl, puff, sketch, cluster, strand,
//! shape, output), so the list below is also the order of the menu and of the manual.
//!
//! **Invariant:** this crate opens no files, owns no threads, reads no clock and knows nothing of documents,
//! windows or GPUs. Same arguments, same bits, on every machine.

mod braid;
mod cluster;
mod curl;
pub mod data;
pub mod declared;
pub mod define;
mod error;
pub mod eval;
pub mod formats;
#[cfg(test)]
mod growth;
mod guides;
#[cfg(test)]
mod hostile;
pub mod laws;
#[cfg(test)]
#[path = "../../tests/src/long.rs"]
mod long;
#[cfg(test)]
mod masks;
pub mod maths;
#[cfg(test)]
mod obeys;
mod output;
mod partition;
mod puff;
pub mod scalp;
mod shape;
#[cfg(test)]
mod sizes;
pub mod sketch;
mod strand;
#[cfg(test)]
mod testing;
#[cfg(test)]
#[path = "../../tests/src/waiting.rs"]
mod waiting;

use define::NodeDef;

/// The stages: folders of nodes in the order in which hair is made, with their names in the menu. None imports a later one.
pub const STAGES: &[(&str, &[&NodeDef])] = &[
    ("scalp", scalp::NODES),
    ("guides", guides::NODES),
    ("braid", braid::NODES),
    ("partition", partition::NODES),
    ("curl", curl::NODES),
    ("puff", puff::NODES),
    ("sketch", sketch::NODES),
    ("cluster", cluster::NODES),
    ("strand", strand::NODES),
    ("shape", shape::NODES),
    ("output", output::NODES),
];

/// Every node, in the order in which hair is made.
pub fn all() -> impl Iterator<Item = &'static NodeDef> {
    STAGES.iter().flat_map(|(_, nodes)| nodes.iter().copied())
}

/// The node with the id `id`.
pub fn by_id(id: &str) -> Option<&'static NodeDef> {
    all().find(|node| node.id == id)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::define::{Group, InputDef, SCALES, Type, Unit, Value};
    use std::{collections::BTreeSet, fs, path::Path};

    #[test]
    fn ids_are_unique_and_snake_case() {
        let mut seen = BTreeSet::new();
        for node in all() {
            assert!(node.id.bytes().all(|b| b.is_ascii_lowercase() || b == b'_'), "{:?}", node.id);
            assert!(seen.insert(node.id), "two nodes are called {:?}", node.id);
            let names: BTreeSet<&str> = node.inputs.iter().map(|i| i.name).collect();
            assert_eq!(names.len(), node.inputs.len(), "{}: two inputs of one name", node.id);
        }
    }

    #[test]
    fn everything_the_user_sees_is_documented() {
        for node in all() {
            assert!(!node.doc().is_empty() && !node.words.is_empty(), "{}", node.id);
            for input in node.inputs {
                assert!(!input.doc().is_empty(), "{}.{}", node.id, input.name);
            }
            for output in node.outputs {
                assert!(!output.doc().is_empty(), "{}.{}", node.id, output.name);
            }
        }
    }

    /// Few inputs are read at a glance and need no headings; many are found by them. Groups have the same order in every node.
    #[test]
    fn an_input_says_what_its_file_holds_where_it_takes_one() {
        for (def, input) in all().flat_map(|def| def.inputs.iter().map(move |input| (def, input))) {
            let takes = input.ty == crate::define::Type::File;
            assert_eq!(input.holds.is_some(), takes, "{}.{}", def.id, input.name);
        }
    }

    #[test]
    fn many_inputs_stand_in_groups_and_the_seed_is_last() {
        for node in all() {
            let set = |inputs: &[InputDef]| {
                let wired = |input: &&InputDef| matches!(input.ty, Type::Curves | Type::Scalp);
                inputs.iter().filter(|input| !wired(input)).count()
            };
            let groups: Vec<Group> = node.groups().filter_map(|(group, _)| group).collect();
            match set(node.inputs) {
                0..7 => assert!(groups.is_empty(), "{} has too few inputs for groups", node.id),
                7..10 => {}
                many => assert!(!groups.is_empty(), "{}: {many} inputs in no groups", node.id),
            }
            assert!(groups.is_sorted_by(|a, b| a < b), "{}: {groups:?}", node.id);
            for (group, inputs) in node.groups() {
                let (n, most) = (set(inputs), 11);
                assert!(group.is_none() || n >= 2, "{}: {n} in {group:?}", node.id);
                assert!(n <= most, "{}: {n} inputs in {group:?}", node.id);
            }
            let seed = node.inputs.iter().position(|input| input.name == "seed");
            assert!(seed.is_none_or(|at| at + 1 == node.inputs.len()), "{}: the seed", node.id);
        }
    }

    #[test]
    fn defaults_lie_within_their_ranges_and_sliders_within_what_is_allowed() {
        for node in all() {
            for input in node.inputs {
                let what = format!("{}.{}", node.id, input.name);
                let value = input.default();
                let number = match value {
                    Some(Value::Float(x)) => Some(f64::from(x)),
                    Some(Value::Int(x)) => Some(x as f64),
                    _ => None,
                };
                if let (Some(x), Some((lo, hi))) = (number, input.hard) {
                    // The range is written in decimals, the default rounded to f32.
                    assert!(x >= lo - 1e-6 && x <= hi + 1e-6 * hi.abs(), "{what}: {x} {lo} {hi}");
                }
                if let (Some((lo, hi)), Some((soft_lo, soft_hi))) = (input.hard, input.soft) {
                    assert!(lo <= soft_lo && soft_lo < soft_hi && soft_hi <= hi, "{what}");
                }
                if let Some(fault) = value.and_then(|value| value.fault()) {
                    panic!("{what}: {fault}");
                }
            }
        }
    }

    /// (A transform and the head itself stand in the head's own frame, or make it.)
    #[test]
    fn lengths_grow_with_the_head_where_a_node_can_be_told_so_and_the_width_of_a_hair_never_does() {
        let mut fixed = vec![];
        for node in all() {
            let told = node.input(SCALES).is_some();
            assert_eq!(node.scales, told, "{}", node.id);
            for input in node.inputs {
                let what = format!("{}.{}", node.id, input.name);
                let grown = match input.unit {
                    Unit::Length => 2.0,
                    Unit::PerCm | Unit::AnglePerCm => 0.5,
                    Unit::PerCm2 => 0.25,
                    _ => 1.0,
                };
                // An attribute that is a length is in centimetres already: of fields, lengths alone know that.
                let is_share = input.ty == Type::Field && input.unit != Unit::Length;
                assert!(!is_share || grown == 1.0, "{what}");
                match input.fixed {
                    true => fixed.push(what),
                    false => assert_eq!(input.grown(1.0, 2.0), grown, "{what}"),
                }
            }
        }
        assert_eq!(
            fixed,
            [
                "braid_hair.width_root",
                "braid_hair.width_tip",
                "edge_partition.width",
                "baby_hair.width_root",
                "baby_hair.width_tip",
                "gather.width",
                "cluster_to_strands.width",
                "interpolate.width",
            ]
        );
    }

    #[test]
    fn every_file_in_a_stage_folder_is_a_listed_node() {
        for (stage, nodes) in STAGES {
            let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("src").join(stage);
            for entry in fs::read_dir(folder).unwrap() {
                let path = entry.unwrap().path();
                let text = fs::read_to_string(&path).unwrap_or_default();
                if !text.contains("node! {") {
                    continue;
                }
                let name = path.file_stem().unwrap().to_str().unwrap();
                assert!(
                    nodes.iter().any(|n| n.id == name),
                    "{} is in no NODES list",
                    path.display()
                );
            }
        }
    }
}
