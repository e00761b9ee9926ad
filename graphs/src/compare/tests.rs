//! Laws of diff and merge, on random documents and on what two people do to one groom.

use super::fact::{document, facts};
use super::*;
use crate::document::graph::{Fault, Severity, check, targets};
use crate::document::testing::Random;
use crate::document::{Document, NodeId};
use crate::file::merges::{Repository, hash, pair};
use crate::file::{read, write};
use crate::schedule::run::Evaluator;
use std::collections::BTreeSet;

/// A document after more edits.
fn edited(random: &mut Random, base: &Document, edits: usize) -> Document {
    let mut document = base.clone();
    for _ in 0..edits {
        let _ = random.edit(&document).apply(&mut document);
    }
    document
}

/// Random documents that people made of one: of any kind, or of a groom, by what the editor does.
fn three(seed: u64) -> [Document; 3] {
    if seed.is_multiple_of(3) {
        return pair(seed, &[], 1 + seed as usize % 9, false).0;
    }
    let mut random = Random::new(seed);
    let base = random.document();
    let (a, b) = (1 + random.below(40), 1 + random.below(40));
    let [ours, theirs] = [a, b].map(|edits| edited(&mut random, &base, edits));
    [base, ours, theirs]
}

#[test]
fn facts_are_all_that_a_document_says() {
    for seed in 0..300 {
        let all = Random::new(seed).document();
        assert_eq!(document(facts(&all)), all, "seed {seed}");
    }
}

#[test]
fn an_edit_that_changes_no_evaluation_leaves_the_same_hair() {
    let (mut still, mut kinds) = (0, BTreeSet::new());
    for seed in 0..600 {
        let mut random = Random::new(seed);
        let mut before = random.document();
        for _ in 0..20 {
            let (edit, mut after) = (random.edit(&before), before.clone());
            if edit.apply(&mut after).is_err() {
                continue;
            }
            if !edit.changes_evaluation() {
                let changes = diff(&before, &after);
                assert!(is_same_hair(&before, &after, &changes), "seed {seed}: {edit:?}");
                assert_eq!(targets(&before), targets(&after), "seed {seed}: {edit:?}");
                still += usize::from(!changes.is_empty());
                kinds.insert(format!("{edit:?}").split([' ', '(']).next().map(str::to_owned));
            }
            before = after;
        }
    }
    assert!(still > 1000 && kinds.len() >= 8, "{still} of {} kinds", kinds.len());
}

#[test]
fn a_diff_is_empty_exactly_between_equal_documents() {
    let mut others = 0;
    for seed in 0..600 {
        let mut random = Random::new(seed);
        let a = random.document();
        let b = edited(&mut random, &a, 1);
        others += usize::from(a != b);
        assert_eq!(diff(&a, &b).is_empty(), a == b, "seed {seed}");
        assert_eq!(lines(&a, &b, true).is_empty(), a == b, "seed {seed}: {:?}", diff(&a, &b));
        assert!(diff(&a, &a.clone()).is_empty() && lines(&a, &a, true).is_empty());
        let back: Vec<Change> = diff(&b, &a)
            .into_iter()
            .map(|Change { fact, from, to }| Change { fact, from: to, to: from })
            .collect();
        assert_eq!(back, diff(&a, &b), "seed {seed}");
    }
    assert!(others > 150, "{others}");
}

#[test]
fn what_only_one_changed_is_as_that_one_has_it() {
    for seed in 0..400 {
        let [base, x, _] = three(seed);
        for (ours, theirs) in [(&x, &base), (&base, &x), (&x, &x)] {
            let merged = merge(&base, ours, theirs);
            assert_eq!(
                merged,
                Merged { document: x.clone(), conflicts: vec![], yielded: vec![], lost: vec![] }
            );
        }
    }
}

/// What keeps a document from being evaluated.
fn fatal(document: &Document) -> BTreeSet<(Fault, NodeId, Option<String>)> {
    let problems = check(document).into_iter();
    let fatal = problems.filter(|p| p.needed && p.severity == Severity::Error);
    fatal.map(|problem| (problem.fault, problem.node, problem.socket)).collect()
}

/// Whether a conflict is about a fact, or about a node that the fact is about or names.
fn concerns(conflicts: &[Conflict], fact: &Fact, said: [Option<&Said>; 3]) -> bool {
    let whole = |c: &Conflict| matches!(c.clash, Clash::Removed(_) | Clash::Added | Clash::Kind);
    let named: BTreeSet<&NodeId> = said
        .into_iter()
        .flatten()
        .flat_map(|said| {
            let shown = if let Said::Node(id) = said { Some(id) } else { None };
            said.sources().map(|s| &s.node).chain(shown)
        })
        .chain(fact.node())
        .collect();
    conflicts.iter().any(|conflict| {
        conflict.fact == *fact
            || whole(conflict) && conflict.fact.node().is_some_and(|id| named.contains(id))
    })
}

/// That each fact of a merge is from whoever changed it, unless a conflict tells of it; gives how many are.
fn check_facts(seed: u64, [base, ours, theirs]: &[Document; 3], merged: &Merged) -> usize {
    let [b, o, t, m] = [base, ours, theirs, &merged.document].map(facts);
    let all: BTreeSet<&Fact> = b.keys().chain(o.keys()).chain(t.keys()).chain(m.keys()).collect();
    let mut counted = 0;
    for fact in all {
        let is_comment = matches!(fact, Fact::Comment(_));
        let [b, o, t, m] = [&b, &o, &t, &m].map(|facts| facts.get(fact));
        let gone = fact.is_canvas() && m.is_none();
        if is_comment || gone || concerns(&merged.conflicts, fact, [b, o, t]) {
            continue;
        }
        counted += 1;
        let expected = match () {
            () if o == b => t,
            () if t == b || t == o => o,
            // Both changed it, and nobody complains: lists, or places on the canvas.
            () => {
                let lists = matches!(fact, Fact::Wires(_) | Fact::Input(..) | Fact::Frame(_));
                assert!(lists || merged.yielded.contains(fact), "seed {seed}: {fact}");
                continue;
            }
        };
        assert_eq!(m, expected, "seed {seed}: {fact}");
    }
    counted
}

#[test]
fn of_any_edits_each_fact_is_from_whoever_changed_it_or_is_told() {
    let (mut clashes, mut clean, mut counted) = (BTreeSet::new(), 0, 0);
    for seed in 0..1500 {
        let all = three(seed);
        let [base, ours, theirs] = &all;
        let merged = merge(base, ours, theirs);
        counted += check_facts(seed, &all, &merged);
        // No comment is lost.
        let of = |document: &Document| -> BTreeSet<String> {
            document.comments.values().flatten().cloned().collect()
        };
        let is_told = merged
            .conflicts
            .iter()
            .any(|c| matches!(c.fact, Fact::Comment(_)) || matches!(c.clash, Clash::Removed(_)));
        for new in of(ours).union(&of(theirs)).filter(|_| !is_told) {
            assert!(of(base).contains(new) || of(&merged.document).contains(new), "seed {seed}");
        }
        // The other merges the other way, and is told the same.
        let back = merge(base, theirs, ours);
        let told = |merged: &Merged| -> BTreeSet<Fact> {
            let own = merged.conflicts.iter().filter(|c| !matches!(c.clash, Clash::Together(_)));
            own.map(|conflict| conflict.fact.clone()).collect()
        };
        assert_eq!(told(&merged), told(&back), "seed {seed}");
        if merged.conflicts.is_empty() && merged.yielded.is_empty() {
            clean += 1;
            let differ = diff(&merged.document, &back.document);
            assert_eq!(differ, [], "seed {seed}");
            assert_eq!(write(&merged.document), write(&back.document));
        }
        clashes.extend(merged.conflicts.iter().map(|c| match c.clash {
            Clash::Changed => "changed",
            Clash::Item(..) => "item",
            Clash::Order => "order",
            Clash::Added => "added",
            Clash::Kind => "kind",
            Clash::Removed(_) => "removed",
            Clash::Together(_) => "together",
        }));
        // What could be evaluated can be.
        let known = fatal(ours).union(&fatal(theirs)).cloned().collect::<BTreeSet<_>>();
        let new: Vec<_> = fatal(&merged.document).difference(&known).cloned().collect();
        assert_eq!(new, [], "seed {seed}");
        // What comes out is a file.
        let loaded = read(&write(&merged.document)).unwrap();
        assert_eq!(loaded.document, merged.document, "seed {seed}");
        let (found, told) = (loaded.conflicts.len(), merged.conflicts.len());
        // Of very many before one entry the rest is counted.
        assert!(found == told || told > 20 && found > 20, "seed {seed}: {found} of {told}");
    }
    println!("{clean} of 1500 clean, {counted} facts; {clashes:?}");
    assert!(clean > 100 && clashes.len() >= 5, "{clean} {clashes:?}");
}

#[test]
fn a_thousand_pairs_of_edits_that_do_not_meet_merge_to_the_same_bytes_either_way() {
    let mut texts = vec![];
    for seed in 0..1000 {
        let (all, _) = pair(seed, &[], 1 + seed as usize % 4, true);
        let [base, ours, theirs] = &all;
        let merged = merge(base, ours, theirs);
        assert_eq!(merged.conflicts, [], "seed {seed}");
        assert_eq!(merged.yielded, [], "seed {seed}");
        let text = write(&merged.document);
        assert_eq!(text, write(&merge(base, theirs, ours).document), "seed {seed}");
        check_facts(seed, &all, &merged);
        texts.push((all, text));
    }
    // Where git merges the text alone, it means the same hair, but for the order of what both added at one place.
    let Some(repository) = Repository::new("compare") else { return };
    let evaluator = Evaluator::new(1, 256 << 20).unwrap();
    let branches: Vec<_> = texts.iter().map(|(all, _)| all.each_ref().map(write)).collect();
    let (mut alike, mut ordered) = (0, 0);
    for ([git, _], (_, text)) in repository.merge_all(&branches).iter().zip(&texts) {
        let Some(git) = git else { continue };
        alike += 1;
        if git != text && hash(&evaluator, text) != hash(&evaluator, git) {
            ordered += 1;
            let [ours, gits] = [text, git].map(|text| read(text).unwrap().document);
            let order = |line: &String| line.ends_with("in another order");
            assert!(lines(&gits, &ours, true).iter().all(order), "{:?}", lines(&gits, &ours, true));
        }
    }
    println!("git alone merges {alike} of 1000, {ordered} in another order");
    assert!(alike > 900 && ordered < 20, "{alike} {ordered}");
}
