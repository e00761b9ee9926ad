//! What a merge left to decide in a document, read back from its comments.
//!
//! Guarantees: every line that begins with [`CONFLICT`] is there, in the order of the file's places. What theirs says is offered only
//! where the comment holds all of it and it can be told for sure: a value, a name or a wire that both changed. Of a node that one
//! removed, of strokes, and of what is longer than a comment holds, the other's file knows more than the comment does.

use super::conflict::{text_of_ours, text_of_theirs};
use super::fact::{Fact, Facts, facts};
use super::words::one_line;
use crate::document::edit::Edit;
use crate::document::{Document, FileEntry, NodeId, Setting, Socket};
use crate::file::CONFLICT;
use crate::text::read_value;
use coif_nodes::define::{Type, Value};

/// One thing that a merge left to decide.
#[derive(Clone, Debug, PartialEq)]
pub struct Undecided {
    /// The node that it is about, where it is about one that is there.
    pub node: Option<NodeId>,
    /// What both changed, and what the three say.
    pub text: String,
    /// Leaves everything as it is: the comment goes.
    pub keep: Edit,
    /// Says what theirs says, and the comment goes; none where that cannot be told from the comment.
    pub take: Option<Edit>,
}

/// All that a merge left to decide.
pub fn undecided(document: &Document) -> Vec<Undecided> {
    let is_left = |line: &String| line.starts_with(CONFLICT);
    let places = document.comments.iter().filter(|(_, lines)| lines.iter().any(is_left));
    let places: Vec<_> = places.collect();
    if places.is_empty() {
        return vec![];
    }
    let said = facts(document);
    let at = |(place, lines): (&FileEntry, &Vec<String>)| {
        let of_line = |(n, line): (usize, &String)| {
            let text = line.strip_prefix(CONFLICT)?.trim().to_owned();
            let mut others = lines.clone();
            others.remove(n);
            let keep = Edit::SetComment { place: place.clone(), lines: others };
            let node = Fact::Comment(place.clone()).node().cloned();
            let take = taking(document, &said, node.as_ref(), &text);
            // The comment goes first: its place may go with what it stands before.
            let take = take.map(|take| Edit::Several(vec![keep.clone(), take]));
            Some(Undecided { node, text, keep, take })
        };
        lines.iter().enumerate().filter_map(of_line).collect::<Vec<_>>()
    };
    places.into_iter().flat_map(at).collect()
}

/// The edit that says what theirs says.
fn taking(document: &Document, said: &Facts, node: Option<&NodeId>, text: &str) -> Option<Edit> {
    let (fact, theirs) = candidates(document, said, node).into_iter().find_map(|fact| {
        let rest = text.strip_prefix(&one_line(&format!("{fact}: base ")))?;
        let ours = format!(", ours {}, theirs ", text_of_ours(&fact, said.get(&fact)));
        // Where that is there twice, one of them is within a text.
        let (_, theirs) = rest.split_once(&ours)?;
        (!theirs.contains(&ours)).then(|| (fact, theirs.to_owned()))
    })?;
    let edit = edit(document, &fact, &theirs)?;
    // It is what theirs says, or nothing.
    let mut after = document.clone();
    edit.apply(&mut after).ok()?;
    (text_of_theirs(&fact, facts(&after).get(&fact)) == theirs).then_some(edit)
}

/// The facts that a comment before this node, or before none, may be about and an edit can say.
fn candidates(document: &Document, said: &Facts, node: Option<&NodeId>) -> Vec<Fact> {
    let Some(id) = node else {
        return vec![Fact::Title, Fact::Note, Fact::Seed, Fact::Display];
    };
    let of_node =
        |fact: &&Fact| matches!(fact, Fact::Input(..) | Fact::Wires(_)) && fact.node() == Some(id);
    let mut all: Vec<Fact> = said.keys().filter(of_node).cloned().collect();
    all.extend([Fact::Label(id.clone()), Fact::NodeNote(id.clone()), Fact::Bypass(id.clone())]);
    let declared = document.def(id).map_or(&[][..], |def| def.inputs);
    all.extend(declared.iter().map(|input| Fact::Input(id.clone(), input.name.to_owned())));
    all.extend(declared.iter().map(|input| Fact::Wires(Socket::new(id.clone(), input.name))));
    all
}

/// The edit that makes a document say a text of a fact, as conflicts tell it.
fn edit(document: &Document, fact: &Fact, text: &str) -> Option<Edit> {
    let is_unsaid = text == fact.unsaid();
    let words = || match is_unsaid {
        true => Some(String::new()),
        false => match read_value(Type::Text, text).ok()? {
            Value::Text(words) => Some(words.to_string()),
            _ => None,
        },
    };
    Some(match fact {
        Fact::Title => Edit::SetTitle(words()?),
        Fact::Note => Edit::SetNote(words()?),
        Fact::Seed => Edit::SetSeed(text.parse().ok()?),
        Fact::Display => {
            let known = NodeId::new(text).ok().filter(|id| document.nodes.contains_key(id));
            match (known, is_unsaid) {
                (Some(id), false) => Edit::SetDisplay(Some(id)),
                (None, true) => Edit::SetDisplay(None),
                _ => return None,
            }
        }
        Fact::Label(id) => Edit::SetLabel { id: id.clone(), label: Some(words()?) },
        Fact::NodeNote(id) => Edit::SetNodeNote { id: id.clone(), note: words()? },
        Fact::Bypass(id) => Edit::SetBypass { id: id.clone(), bypass: !is_unsaid },
        Fact::Input(node, input) => {
            let (node, input) = (node.clone(), input.clone());
            if is_unsaid {
                return Some(Edit::UnsetInput { node, input });
            }
            let (_, def) = document.def(&node)?.input(&input)?;
            let setting = Setting::Known(read_value(def.ty, text).ok()?);
            Edit::SetInput { node, input, setting }
        }
        Fact::Wires(to) => {
            let sources = text.split(" and ").filter(|_| !is_unsaid).map(|from| {
                let from: Socket = from.parse().ok()?;
                document.nodes.contains_key(&from.node).then_some(from)
            });
            Edit::SetWires { to: to.clone(), from: sources.collect::<Option<_>>()? }
        }
        _ => return None,
    })
}

#[cfg(test)]
mod tests {
    use super::super::{Clash, Merged, Said, merge};
    use super::*;
    use crate::document::testing::Random;
    use crate::file::{read, write};

    /// A merge of what two people made of a random document, as it is read back from its file.
    fn merged(seed: u64) -> ([Document; 3], Merged) {
        let mut random = Random::new(seed);
        let base = random.document();
        let mut edited = |edits: usize| {
            let mut document = base.clone();
            for _ in 0..edits {
                let _ = random.edit(&document).apply(&mut document);
            }
            document
        };
        let all = [edited(0), edited(30), edited(30)];
        let mut merged = merge(&all[0], &all[1], &all[2]);
        merged.document = read(&write(&merged.document)).unwrap().document;
        (all, merged)
    }

    #[test]
    fn what_is_taken_is_what_theirs_says_and_what_is_kept_is_ours() {
        let (mut left, mut takes) = (0, 0);
        for seed in 0..600 {
            let ([.., theirs], merged) = merged(seed);
            let all = undecided(&merged.document);
            let told: Vec<String> = merged.conflicts.iter().map(ToString::to_string).collect();
            for one in &all {
                left += 1;
                let mut kept = merged.document.clone();
                one.keep.apply(&mut kept).unwrap();
                let changed: Vec<_> = super::super::diff(&merged.document, &kept);
                assert!(changed.iter().all(|c| matches!(c.fact, Fact::Comment(_))), "{changed:?}");
                let Some(take) = &one.take else { continue };
                takes += 1;
                let n = told.iter().position(|told| *told == one.text).unwrap();
                let conflict = &merged.conflicts[n];
                assert_eq!(conflict.clash, Clash::Changed, "seed {seed}: {one:?}");
                let mut taken = merged.document.clone();
                let undo = take.apply(&mut taken).unwrap();
                let sources = |said: Option<&Said>| -> Vec<Socket> {
                    said.into_iter().flat_map(Said::sources).cloned().collect()
                };
                let (now, asked) =
                    (facts(&taken).remove(&conflict.fact), facts(&theirs).remove(&conflict.fact));
                match &conflict.fact {
                    // Bends are for people.
                    Fact::Wires(_) => assert_eq!(
                        sources(now.as_ref()),
                        sources(asked.as_ref()),
                        "seed {seed}: {}",
                        one.text
                    ),
                    _ => assert_eq!(now, asked, "seed {seed}: {}", one.text),
                }
                undo.apply(&mut taken).unwrap();
                assert_eq!(taken, merged.document, "seed {seed}: {}", one.text);
            }
        }
        println!("theirs can be taken in {takes} of {left} conflicts");
        assert!(left > 300 && takes > 100, "{takes} of {left}");
    }

    #[test]
    fn when_all_is_decided_no_conflict_is_left_in_the_file() {
        for seed in 0..200 {
            let (_, merged) = merged(seed);
            let mut document = merged.document;
            for n in 0.. {
                let all = undecided(&document);
                let Some(one) = all.first() else { break };
                let edit = one.take.as_ref().filter(|_| n % 2 == 0).unwrap_or(&one.keep);
                edit.apply(&mut document).unwrap();
                assert!(undecided(&document).len() < all.len(), "seed {seed}: {one:?}");
            }
            assert_eq!(read(&write(&document)).unwrap().conflicts, [], "seed {seed}");
        }
    }

    #[test]
    fn texts_of_any_blanks_are_taken_as_they_are_and_long_ones_are_not_offered() {
        let document = |title: &str| Document { title: title.to_owned(), ..Document::default() };
        let long = "long ".repeat(60);
        for (theirs, is_offered) in [
            ("b", true),
            ("", true),
            ("two  blanks \u{a0}and a\nline\ttoo ", true),
            ("none", true),
            (", ours \"a\", theirs \"c\"", true),
            (&long, false),
        ] {
            let merged = merge(&document("base"), &document("a"), &document(theirs)).document;
            let all = undecided(&merged);
            assert_eq!(all.len(), 1);
            assert_eq!(all[0].take.is_some(), is_offered, "{}", all[0].text);
            if let Some(take) = &all[0].take {
                let mut taken = merged;
                take.apply(&mut taken).unwrap();
                assert_eq!(taken, document(theirs));
            }
        }
    }
}
