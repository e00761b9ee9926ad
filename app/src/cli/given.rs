//! What options change in a graph before it is evaluated: inputs and parameters by name (`--set`, columns of a sweep), and the mesh
//! of a head (`--scalp`, `--head`).
//!
//! Guarantees: a wire never stays before a value that was given; where an option is refused the graph is not evaluated. Whether a
//! value makes sense to its node is not known here.

use crate::jobs::stop::Stop;
use coif_graphs::document::{Document, NodeId, Setting, Socket};
use coif_graphs::text::parse_value;
use coif_nodes::declared::PARAMETERS;
use coif_nodes::define::{InputDef, Value, short};
use std::sync::Arc;

/// `NODE.INPUT=VALUE`, or `PARAMETER=VALUE`.
pub(super) fn apply_set(document: &mut Document, set: &str) -> Result<(), Stop> {
    let fault = |reason: String| Stop::refused(format!("--set {}: {reason}", short(set)));
    let (name, text) = set
        .split_once('=')
        .ok_or_else(|| fault("write it as NODE.INPUT=VALUE or PARAMETER=VALUE".to_owned()))?;
    set_value(document, name.trim(), text.trim()).map_err(fault)
}

/// Sets an input of a node, written `node.input`, or a parameter of the graph, written as its name.
///
/// # Errors
/// There is no such input or parameter, or the text is no value of its type.
pub(super) fn set_value(document: &mut Document, name: &str, text: &str) -> Result<(), String> {
    let (socket, input) = input_of(document, name)?;
    let value = parse_value(input.ty, text)?;
    let node = document.nodes.get_mut(&socket.node).ok_or("there is no such node")?;
    Arc::make_mut(node).inputs.insert(input.name.to_owned(), Setting::Known(value));
    document.links.remove(&Socket::new(socket.node, input.name));
    Ok(())
}

/// The input that [`set_value`] sets by this name.
///
/// # Errors
/// There is no such input or parameter.
pub(super) fn input_of(
    document: &Document,
    name: &str,
) -> Result<(Socket, &'static InputDef), String> {
    let socket = match name.contains('.') {
        true => name.parse::<Socket>().map_err(|err| err.to_string())?,
        false => parameter(document, name)?,
    };
    let def = document.def(&socket.node);
    let node = document
        .nodes
        .get(&socket.node)
        .ok_or_else(|| format!("there is no node {:?}", short(socket.node.as_str())))?;
    let def = def.ok_or_else(|| format!("its kind {:?} is not known", node.kind))?;
    let (_, input) = def.input(&socket.name).ok_or_else(|| {
        let known: Vec<&str> = def.inputs.iter().map(|i| i.name).collect();
        format!(
            "{} has no input {:?}; it has {}",
            def.with_article(),
            short(&socket.name),
            known.join(", ")
        )
    })?;
    Ok((socket, input))
}

/// The input that a parameter of the graph is set by.
fn parameter(document: &Document, name: &str) -> Result<Socket, String> {
    let all: Vec<Socket> = document
        .nodes
        .iter()
        .filter(|(id, node)| node.kind == PARAMETERS && id.group().is_none())
        .flat_map(|(id, node)| {
            let ports = node.interface.unwrap_or_default().inputs().iter();
            ports.map(|port| Socket::new(id.clone(), &port.name))
        })
        .collect();
    let mut found = all.iter().filter(|socket| *socket.name == *name);
    match (found.next(), found.next()) {
        (Some(one), None) => Ok(one.clone()),
        (Some(one), Some(other)) => {
            Err(format!("{one} and {other} are parameters of this name: write one of these"))
        }
        _ if all.is_empty() => {
            Err("the graph has no parameters: write NODE.INPUT=VALUE".to_owned())
        }
        _ => {
            let known: Vec<&str> = all.iter().map(|socket| &*socket.name).collect();
            Err(format!(
                "the graph has no parameter {:?}; it has {}",
                short(name),
                known.join(", ")
            ))
        }
    }
}

/// `[NODE=]FILE` of an option; gives the node.
pub(super) fn apply_scalp(
    document: &mut Document,
    option: &str,
    scalp: &str,
) -> Result<NodeId, Stop> {
    let fault = |reason: String| Stop::refused(format!("{option} {scalp}: {reason}"));
    let named =
        scalp.split_once('=').and_then(|(node, file)| Some((NodeId::new(node).ok()?, file)));
    let (id, path) = match named {
        Some((id, path)) if document.nodes.contains_key(&id) => (id, path),
        _ => {
            let heads: Vec<&NodeId> =
                document.nodes.iter().filter(|(_, n)| n.is_head()).map(|(id, _)| id).collect();
            match heads[..] {
                [one] => (one.clone(), scalp),
                [] => return Err(fault("the graph has no head node".to_owned())),
                _ => {
                    let names: Vec<&str> = heads.iter().map(|id| id.as_str()).collect();
                    return Err(fault(format!(
                        "the graph has several heads; write NODE=FILE with one of {}",
                        names.join(", ")
                    )));
                }
            }
        }
    };
    // The document's paths are relative to its folder, this one to where the command was given.
    let full = std::path::absolute(path).map_err(|err| fault(err.to_string()))?;
    let text: Arc<str> = full.to_string_lossy().into();
    let node = document.nodes.get_mut(&id).map(Arc::make_mut);
    if let Some(node) = node.filter(|node| node.is_head()) {
        node.inputs.insert("mesh".to_owned(), Setting::Known(Value::Text(text)));
        document.links.remove(&Socket::new(id.clone(), "mesh"));
        return Ok(id);
    }
    Err(fault(format!("{id} is no head node")))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rooms::pen::recipes;

    #[test]
    fn inputs_of_a_recipe_are_set_by_their_names_in_a_saved_groom() {
        let bob = recipes::ALL.iter().find(|recipe| recipe.template == "bob").expect("a bob");
        let put = |document: &mut Document| {
            let made = bob.edits(document, None, false, None).expect("it is made");
            made.edits
                .into_iter()
                .for_each(|edit| drop(edit.apply(document).expect("it is put in")));
        };
        let mut document = Document::default();
        put(&mut document);
        let text = coif_graphs::file::write(&document);
        let mut read = coif_graphs::file::read(&text).expect("it reads").document;
        set_value(&mut read, "length", "12").expect("a bob has a length");
        let cut = read.nodes.iter().find(|(_, node)| node.kind == "trim").expect("a cut").0;
        let at = coif_graphs::document::wiring::set_at(&read, &Socket::new(cut.clone(), "longer"));
        let set = read.nodes[&at.node].inputs.get(&*at.name);
        assert_eq!(set, Some(&Setting::Known(Value::Float(12.0))));
        // Of two bobs it says which there are.
        put(&mut document);
        let why = set_value(&mut document, "length", "12").expect_err("which?");
        assert!(why.contains("parameters.length and parameters_2.length"), "{why}");
    }
}
