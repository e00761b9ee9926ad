//! A template fitted to the head that it is put on: what is drawn in it lies between the same landmarks.
//!
//! Guarantees: on a head with the same landmarks, and where no map leads to a head, not a bit changes; what is drawn lies where
//! `coif fit --bake` would bring it. Not promised: anything for a template that does not say between which landmarks it was drawn, which
//! is taken as it is.

use super::bake::bake;
use coif_graphs::document::graph::head_at_hand;
use coif_graphs::document::{Document, NodeId, Setting, Socket};
use coif_graphs::file;
use coif_graphs::schedule::files::DiskFiles;
use coif_graphs::schedule::request::plan;
use coif_graphs::schedule::run::{CancelToken, Evaluator, OnFailure, Quiet};
use coif_nodes::data::carry::Carry;
use coif_nodes::data::landmarks::Landmarks;
use coif_nodes::data::scalp::{HeadFrame, HeadSpace};
use coif_nodes::define::Value;
use coif_nodes::eval::Quality;
use std::path::Path;
use std::sync::{Arc, OnceLock};

/// The template, drawn for a head with the landmarks `here`.
pub(crate) fn fitted(mut template: Document, here: &Landmarks) -> Document {
    let Some(head) = head_at_hand(&template) else { return template };
    let Some(home) = given_between(&template, &head, None) else { return template };
    let (map, _) = Carry::between(&home, here);
    if map.is_some() {
        // Directions are in the frame of a head on all of them.
        let space = HeadSpace::new(HeadFrame::IDENTITY, map);
        bake(&mut template, &head, &space, &mut vec![]);
    }
    template
}

/// Lets the head of a template say between which landmarks what is drawn on it is given, where it does not say so already. `own` knows
/// the landmarks of a head as it was evaluated.
pub(crate) fn say_home(template: &mut Document, own: impl FnOnce(&NodeId) -> Option<Landmarks>) {
    let Some(head) = head_at_hand(template) else { return };
    if is_built_in(template, &head) || given_between(template, &head, None).is_some() {
        return;
    }
    let known = own(&head).filter(|marks| *marks != Landmarks::default());
    if let (Some(marks), Some(node)) = (known, template.nodes.get_mut(&head)) {
        let home = Setting::Known(Value::Text(marks.to_string().into()));
        Arc::make_mut(node).inputs.insert("home".to_owned(), home);
    }
}

/// The landmarks that what is drawn on a head is given between: those of its home, else its own, as `shown` or of the built-in head as it
/// comes.
pub(crate) fn given_between(
    document: &Document,
    head: &NodeId,
    shown: Option<&Landmarks>,
) -> Option<Landmarks> {
    let node = document.node(head.as_str())?;
    match node.inputs.get("home") {
        Some(Setting::Known(Value::Text(home))) if !home.trim().is_empty() => {
            Some(Landmarks::parse(home).0)
        }
        _ => shown.copied().or_else(|| is_built_in(document, head).then(|| *built_in())),
    }
}

/// Whether a head node is the built-in head, as it comes.
fn is_built_in(document: &Document, head: &NodeId) -> bool {
    document.node(head.as_str()).is_some_and(|node| node.inputs.is_empty())
        && !document.links.keys().any(|to| to.node == *head)
}

/// A groom of the built-in head alone.
const BUILT_IN: &str = r#"(format: 3, title: "", seed: 0, nodes: { "head": (kind: "head") })"#;

/// The landmarks of the built-in head.
fn built_in() -> &'static Landmarks {
    static KNOWN: OnceLock<Landmarks> = OnceLock::new();
    KNOWN.get_or_init(|| {
        let Ok(read) = file::read(BUILT_IN) else { return Landmarks::default() };
        let Some(head) = head_at_hand(&read.document) else { return Landmarks::default() };
        evaluated(&read.document, &head, Path::new("")).unwrap_or_default()
    })
}

/// The landmarks of a head, evaluated alone; the document lies in `folder`.
///
/// # Errors
/// Why the head cannot be evaluated.
pub(crate) fn evaluated(
    document: &Document,
    head: &NodeId,
    folder: &Path,
) -> Result<Landmarks, String> {
    let wanted = [Socket::new(head.clone(), "scalp")];
    let plan = plan(document, &wanted, Quality::Final, &DiskFiles::new(folder))
        .map_err(|err| err.to_string())?;
    let evaluator = Evaluator::new(1, 0)?;
    let mut run = evaluator.run(&plan, OnFailure::Stop, &CancelToken::default(), &Quiet);
    match run.targets.pop() {
        Some(Some(Value::Scalp(scalp))) => Ok(*scalp.landmarks()),
        _ => {
            let failed = run.nodes.iter().filter_map(|node| Some((node, node.error.as_ref()?)));
            let said: Vec<String> =
                failed.map(|(node, err)| format!("{}: {err}", node.name)).collect();
            Err(said.join("; "))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::library;
    use coif_graphs::grooms;
    use glam::Vec3;

    /// As they are guessed on a scan with a high face, and on a character with a low one.
    const OTHERS: [&str; 2] = [
        "front 0 4.577 8.637; nape 0 -8.05 -6.412; left temple 5.952 0.827 4.168; right temple -6.276 1.018 4.395; \
         left ear 6.811 -0.797 -0.104; right ear -6.972 -0.893 -0.087; crown 0 8.157 -3.804; chin 0 -11.303 9.718; \
         bridge 0 -0.89 9.328; nose 0 -4.361 11.463; mouth 0 -7.232 10.05",
        "front 0 4.441 8.474; nape 0 -7.043 -5.211; left temple 6.574 1.193 4.603; right temple -6.577 1.194 4.605; \
         left ear 8.421 -0.643 -1.258; right ear -8.418 -0.643 -1.258; crown 0 8.114 -3.784; chin 0 -12.905 7.822; \
         bridge 0 -3.204 9.332; nose 0 -6.942 10.847; mouth 0 -9.59 9.185",
    ];

    fn template(name: &str) -> Document {
        let (_, text) =
            grooms::TEMPLATES.iter().find(|(it, _)| *it == name).expect("it is shipped");
        library::shipped(text).expect("a template").document
    }

    /// All that is drawn in a template, head units.
    fn drawn(document: &Document) -> Vec<Vec3> {
        let values = document.nodes.values().flat_map(|node| node.inputs.values());
        let strokes = values.filter_map(|setting| match setting {
            Setting::Known(Value::Strokes(strokes)) => Some(strokes.0.iter()),
            _ => None,
        });
        strokes.flatten().flat_map(|s| &s.samples).map(|s| s.position).collect()
    }

    fn middle(of: &[Vec3]) -> Vec3 {
        of.iter().sum::<Vec3>() / of.len() as f32
    }

    #[test]
    fn brows_lie_over_the_bridge_of_any_nose_and_a_beard_around_any_mouth() {
        use coif_nodes::data::landmarks::Landmark;
        for (name, mark) in [("brows", Landmark::Bridge), ("beard", Landmark::Mouth)] {
            // How far it lies above the landmark.
            let over = |template: Document, here: &Landmarks| {
                middle(&drawn(&template)).y - here.get(mark).expect("a face").y
            };
            let home = over(template(name), built_in());
            let mut sums = [0.0; 2];
            for here in OTHERS.map(|other| Landmarks::parse(other).0) {
                let both = [template(name), fitted(template(name), &here)];
                let [plain, off] = both.map(|it| (over(it, &here) - home).abs());
                println!("{name}: {off} head units off, {plain} as it was drawn");
                assert!(off < 0.8, "{name}: {off}");
                sums = [sums[0] + plain, sums[1] + off];
            }
            // Not nought: the map lets foreheads and chins meet, too.
            assert!(sums[1] < 0.6 * sums[0], "{name}: {sums:?}");
        }
    }

    #[test]
    fn what_was_drawn_on_another_head_says_between_which_landmarks_and_comes_to_lie_between_those_of_this_one()
     {
        use coif_nodes::data::landmarks::Landmark;
        let [there, _] = OTHERS.map(|other| Landmarks::parse(other).0);
        // As somebody with that head has it: drawn there, and saved.
        let mut theirs = fitted(template("brows"), &there);
        let head = head_at_hand(&theirs).expect("a head");
        let node = Arc::make_mut(theirs.nodes.get_mut(&head).expect("a node"));
        node.inputs.insert("mesh".into(), Setting::Known(Value::Text("scan.obj".into())));
        let unsaid = theirs.clone();
        say_home(&mut theirs, |_| Some(there));
        assert_ne!(theirs, unsaid);
        assert_eq!(fitted(theirs.clone(), &there), theirs, "on the same head not a bit changes");
        assert_eq!(fitted(unsaid.clone(), built_in()), unsaid, "nothing is known of it");
        let over = |template: &Document| {
            middle(&drawn(template)).y - built_in().get(Landmark::Bridge).expect("a face").y
        };
        let here = fitted(theirs.clone(), built_in());
        let [home, off] = [over(&template("brows")), over(&here)];
        assert!((off - home).abs() < 0.05 && (over(&theirs) - home).abs() > 0.5, "{home} {off}");
        // What says where it is from is not told anew, and the built-in head needs not be told.
        let known = theirs.clone();
        say_home(&mut theirs, |_| Some(*built_in()));
        let mut plain = template("brows");
        say_home(&mut plain, |_| panic!("nobody asks"));
        assert!(theirs == known && plain == template("brows"));
    }

    #[test]
    fn on_the_built_in_head_not_a_bit_changes_nor_on_a_head_without_landmarks() {
        for (name, _) in grooms::TEMPLATES {
            let plain = template(name);
            for here in [*built_in(), Landmarks::default()] {
                assert_eq!(fitted(plain.clone(), &here), plain, "{name}");
            }
        }
    }
}
