//! Which node is meant by a few typed letters: a pure ranking over the nodes' declarations.
//!
//! Label, words of the trade and of other tools, parameters and manual are looked through, in that
//! order; one slip of the finger still finds. The same letters and hints always give the same list.
//! Knows nothing of windows; what is typed may be in any script.

use coif_nodes::define::{InputDef, NodeDef, Type};
use std::collections::BTreeMap;

/// How well something fits what was typed; smaller is better.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Score {
    /// What kind of match, summed over the typed words.
    tier: u32,
    /// Where in the list of words it matched: the first words are what a thing is mostly called.
    place: u32,
}

/// What can be searched for, beyond a label.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct SearchEntry<'a> {
    /// What people read.
    pub label: &'a str,
    /// Its name in files.
    pub id: &'a str,
    /// Other words for it, the most usual first.
    pub words: &'a str,
    /// Words for parts of it, such as its parameters.
    pub parts: &'a str,
    /// Its manual.
    pub doc: &'a str,
}

const EXACT: u32 = 0;
const PREFIX: u32 = 1;
const WORD_START: u32 = 2;
const SEARCH_WORD: u32 = 3;
const SEARCH_WORD_START: u32 = 4;
const LETTERS: u32 = 5;
const SLIP: u32 = 6;
const PART: u32 = 8;
const MANUAL: u32 = 10;

/// Lower case, with one space between words; hyphens and underscores part words.
fn fold(text: &str) -> String {
    let spaced: String = text
        .chars()
        .flat_map(char::to_lowercase)
        .map(|c| if c.is_alphanumeric() { c } else { ' ' })
        .collect();
    spaced.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// How well `entry` fits what was typed; none when it does not. Nothing typed fits everything.
pub(crate) fn score(typed: &str, entry: &SearchEntry<'_>) -> Option<Score> {
    let typed = fold(typed);
    if typed.is_empty() {
        return Some(Score { tier: EXACT, place: 0 });
    }
    let label = fold(entry.label);
    if label == typed || fold(entry.id) == typed {
        return Some(Score { tier: EXACT, place: 0 });
    }
    if label.starts_with(&typed) {
        return Some(Score { tier: PREFIX, place: 0 });
    }
    let words = fold(entry.words);
    let mut total = Score { tier: 0, place: 0 };
    for word in typed.split(' ') {
        let one = score_word(word, &label, &words, entry)?;
        total.tier += one.tier;
        total.place += one.place;
    }
    Some(total)
}

fn score_word(typed: &str, label: &str, words: &str, entry: &SearchEntry<'_>) -> Option<Score> {
    let at = |tier, place: usize| Some(Score { tier, place: place as u32 });
    let starts = |text: &str| text.split(' ').position(|word| word.starts_with(typed));
    if let Some(place) = starts(label) {
        return at(WORD_START, place);
    }
    if let Some(place) = words.split(' ').position(|word| word == typed) {
        return at(SEARCH_WORD, place);
    }
    if let Some(place) = starts(words) {
        return at(SEARCH_WORD_START, place);
    }
    if letters_in_order(typed, label) {
        return at(LETTERS, 0);
    }
    let slip = |text: &str| text.split(' ').position(|word| is_slip(typed, word));
    if let Some(place) = slip(label) {
        return at(SLIP, place);
    }
    if let Some(place) = slip(words) {
        return at(SLIP, place + 1);
    }
    if let Some(place) = starts(&fold(entry.parts)) {
        return at(PART, place);
    }
    // Short words stand in every manual.
    let manual = typed.chars().count() > 2 && starts(&fold(entry.doc)).is_some();
    if manual { at(MANUAL, 0) } else { None }
}

/// Whether the letters stand in the label in their order, the first one at the start of a word:
/// `cts` for cluster to strands.
fn letters_in_order(typed: &str, label: &str) -> bool {
    let mut letters = typed.chars();
    let Some(first) = letters.next() else { return false };
    let starts = std::iter::once(0).chain(label.match_indices(' ').map(|(at, _)| at + 1));
    let rest: Vec<char> = letters.collect();
    starts.filter(|at| label[*at..].starts_with(first)).any(|at| {
        let mut left = label[at..].chars().skip(1);
        rest.iter().all(|wanted| left.any(|c| c == *wanted))
    })
}

/// Whether `word`, or as much of it as was typed, is one change of a letter away: replaced, missing,
/// doubled, or swapped with its neighbour. Words of three letters and fewer have no slips: they
/// would find everything.
fn is_slip(typed: &str, word: &str) -> bool {
    let (a, b): (Vec<char>, Vec<char>) = (typed.chars().collect(), word.chars().collect());
    if a.len() < 4 || a.first() != b.first() && a.get(1) != b.get(1) && a.get(1) != b.first() {
        return false;
    }
    one_change(&a, &b) || b.len() > a.len() + 1 && a.len() > 4 && one_change(&a, &b[..a.len()])
}

/// Whether two words are equal but for one change.
fn one_change(a: &[char], b: &[char]) -> bool {
    let same = a.iter().zip(b).take_while(|(a, b)| a == b).count();
    let (a, b) = (&a[same..], &b[same..]);
    match (a, b) {
        ([_, a @ ..], [_, b @ ..]) if a == b => true,
        ([_, a @ ..], b) if a == b => true,
        (a, [_, b @ ..]) if a == b => true,
        ([x, y, a @ ..], [z, w, b @ ..]) => x == w && y == z && a == b,
        _ => a == b,
    }
}

/// What else than the typed letters says which node is meant.
#[derive(Clone, Debug, Default)]
pub(crate) struct Hints<'a> {
    /// Kinds that were added lately, the last first.
    pub recent: &'a [String],
    /// How often each kind follows the one that a wire comes from.
    pub after: BTreeMap<&'a str, usize>,
}

/// The nodes of `among` that what was typed may mean, the best first.
pub(crate) fn find(
    typed: &str,
    among: impl Iterator<Item = &'static NodeDef>,
    hints: &Hints<'_>,
) -> Vec<&'static NodeDef> {
    let mut found: Vec<_> = among
        .enumerate()
        .filter_map(|(order, def)| {
            let score = score_node(typed, def)?;
            let recent = hints.recent.iter().position(|kind| kind == def.id);
            let after = hints.after.get(def.id).copied().unwrap_or(0);
            let recent = recent.unwrap_or(usize::MAX);
            let tier = score.tier;
            Some(((tier, score.place, recent, std::cmp::Reverse(after), order), def))
        })
        .collect();
    if fold(typed).is_empty() {
        // Nothing was typed: what usually follows goes before what was used lately.
        found.sort_by_key(|((_, _, recent, after, order), _)| (*after, *recent, *order));
    } else {
        found.sort_by_key(|(key, _)| *key);
    }
    found.into_iter().map(|(_, def)| def).collect()
}

/// Why a node was found whose label does not say it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Why {
    /// A choice that it has: the input and its word, which can be set.
    Choice(&'static str, &'static str),
    /// An input of it.
    Input(&'static str),
    /// Another word for it.
    Word(&'static str),
    /// Its manual has the words.
    Manual,
}

impl Why {
    /// What stands behind the node's label.
    pub(crate) fn text(self) -> String {
        let spoken = |name: &str| name.replace('_', " ");
        match self {
            Self::Choice(input, word) => format!("{} {}", spoken(input), spoken(word)),
            Self::Input(input) => spoken(input),
            Self::Word(word) => format!("\u{201C}{word}\u{201D}"),
            Self::Manual => "in its manual".to_owned(),
        }
    }
}

/// Why a node fits what was typed; none where its label says so.
pub(crate) fn why(typed: &str, def: &'static NodeDef) -> Option<Why> {
    let typed = fold(typed);
    let label = fold(def.label);
    if typed.is_empty() || fold(def.id) == typed || label.starts_with(&typed) {
        return None;
    }
    let in_label = |word: &&str| label.split(' ').any(|part| part.starts_with(*word));
    // The words that the label does not explain.
    let odd: Vec<&str> = typed.split(' ').filter(|word| !in_label(word)).collect();
    if odd.is_empty() {
        return None;
    }
    let mut choices = def.inputs.iter().flat_map(|input| match input.ty {
        Type::Choice(words) => words.iter().map(|(word, doc)| (input.name, *word, *doc)).collect(),
        _ => vec![],
    });
    let named = |input: &str, word: &str| fold(input).split(' ').any(|part| part == word);
    let says = |(input, choice, _): &(&str, &str, &str)| {
        let choice = fold(choice);
        odd.contains(&&*choice) && odd.iter().all(|word| choice == *word || named(input, word))
    };
    if let Some((input, word, _)) = choices.clone().find(says) {
        return Some(Why::Choice(input, word));
    }
    let all_in = |text: &str| {
        let text = fold(text);
        odd.iter().all(|word| text.split(' ').any(|part| part.starts_with(word)))
    };
    let input = def.inputs.iter().find(|input| all_in(input.name));
    // A choice that is described as what was typed: waves are a preset of curls.
    let described = |(_, _, doc): &(&str, &str, &str)| {
        let doc = fold(doc);
        let first = doc.split(' ').next().unwrap_or_default();
        odd.iter().all(|word| word.chars().count() > 3 && stem(word) == stem(first))
    };
    if let (None, Some((input, word, _))) = (input, choices.find(described)) {
        return Some(Why::Choice(input, word));
    }
    // Of several, the one that is called so before all else.
    let place = |input: &&InputDef| {
        let words = fold(input.words);
        words.split(' ').position(|word| odd.iter().any(|typed| word.starts_with(typed)))
    };
    let input = input.or_else(|| {
        let all = def.inputs.iter().filter(|input| all_in(input.words));
        all.min_by_key(place)
    });
    // An input says more than the word alone.
    if let Some(input) = input {
        return Some(Why::Input(input.name));
    }
    let word = |word: &&'static str| odd.iter().any(|typed| fold(word).starts_with(typed));
    if let Some(word) = def.words.split(' ').find(word) {
        return Some(Why::Word(word));
    }
    let manual = fold(&def.doc());
    odd.iter()
        .all(|word| manual.split(' ').any(|part| part.starts_with(word)))
        .then_some(Why::Manual)
}

/// A word without what makes it one or many, or a quality: wave, waves and wavy are the same.
fn stem(word: &str) -> &str {
    let word = word.strip_suffix('s').unwrap_or(word);
    word.strip_suffix(['e', 'y']).unwrap_or(word)
}

fn score_node(typed: &str, def: &'static NodeDef) -> Option<Score> {
    let (label, id, words) = (def.label, def.id, def.words);
    // Manuals are long; most searches end before them.
    let short = SearchEntry { label, id, words, ..SearchEntry::default() };
    score(typed, &short).or_else(|| {
        let mut parts: Vec<&str> =
            def.inputs.iter().flat_map(|input| [input.name, input.words]).collect();
        for input in def.inputs {
            if let Type::Choice(words) = input.ty {
                parts.extend(words.iter().map(|(word, _)| *word));
            }
        }
        let (parts, doc) = (parts.join(" "), def.doc());
        score(typed, &SearchEntry { parts: &parts, doc: &doc, ..short })
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn first(typed: &str) -> &'static str {
        find(typed, coif_nodes::all(), &Hints::default()).first().map_or("nothing", |def| def.id)
    }

    /// What people of the trade and of other tools type, and what they mean.
    const TABLE: &[(&str, &str)] = &[
        // Labels, whole and in part.
        ("Head", "head"),
        ("merge", "merge"),
        ("lissajous braid", "lissajous_braid"),
        ("liss", "lissajous_braid"),
        ("braid", "lissajous_braid"),
        ("curl", "shape_list_curl"),
        ("shape list", "shape_list_curl"),
        ("shape-list", "shape_list_curl"),
        ("puff", "sphere_puff"),
        ("edge", "edge_partition"),
        ("set w", "set_width"),
        ("set_colour", "set_colour"),
        ("cts", "cluster_to_strands"),
        ("grout", "groom_output"),
        ("scpr", "scalp_projection"),
        // Words of the trade.
        ("plait", "lissajous_braid"),
        ("cornrow", "lissajous_braid"),
        ("canerow", "lissajous_braid"),
        ("box braids", "lissajous_braid"),
        ("fishtail", "lissajous_braid"),
        ("two-strand twist", "lissajous_braid"),
        ("knotless", "braid_hair"),
        ("feed in", "braid_territory"),
        ("locs", "cluster_to_strands"),
        ("afro", "sphere_puff"),
        ("bun", "bun"),
        ("pom pom", "sphere_puff"),
        ("space buns", "sphere_puff"),
        ("parting", "partings"),
        ("side part", "edge_partition"),
        ("coil", "shape_list_curl"),
        ("kinky", "shape_list_curl"),
        ("ringlets", "shape_list_curl"),
        ("wavy", "shape_list_curl"),
        ("4c", "shape_list_curl"),
        ("waves", "shape_list_curl"),
        ("perm", "shape_list_curl"),
        ("wisp", "cluster_to_strands"),
        ("fill", "cluster_to_strands"),
        ("frizz", "frizz"),
        ("flyaways", "stray"),
        ("melanin", "hair_colour"),
        ("ombre", "hair_colour"),
        ("balayage", "hair_colour"),
        ("grey hair", "hair_colour"),
        ("bleach", "hair_colour"),
        ("draw", "stroke_input"),
        ("pencil", "stroke_input"),
        ("skull", "head"),
        ("bust", "head"),
        ("whorl", "scatter_guides"),
        ("thickness", "set_width"),
        ("taper", "set_width"),
        ("mirror", "transform"),
        ("combine", "merge"),
        ("export", "groom_output"),
        ("alembic", "groom_output"),
        // Nodes of other tools.
        ("Guide Process", "shape_list_curl"),
        ("Guide Init", "scatter_guides"),
        ("Hair Generate", "interpolate"),
        ("Hair Clump", "clump"),
        ("Hair from guides", "interpolate"),
        ("scraggle", "frizz"),
        ("Guide Partition", "edge_partition"),
        ("Attach Hair Curves to Surface", "scalp_projection"),
        ("shrinkwrap", "scalp_projection"),
        ("Interpolate Hair Curves", "interpolate"),
        ("Set Hair Curve Profile", "set_width"),
        ("Braid Hair Curves", "lissajous_braid"),
        ("Strand multiplier", "cluster_to_strands"),
        ("clumping modifier", "clump"),
        ("trim", "trim"),
        ("shears", "trim"),
        ("haircut", "trim"),
        ("cut hair", "trim"),
        ("clump", "clump"),
        ("clumping", "clump"),
        ("noise", "noise"),
        ("flyaway", "stray"),
        ("length", "length"),
        ("extend", "length"),
        ("longer", "length"),
        ("kink", "frizz"),
        ("Hair Curves Noise", "noise"),
        ("Frizz Hair Curves", "frizz"),
        ("Clump Hair Curves", "clump"),
        ("rebuild", "resample"),
        ("subdivide", "resample"),
        ("xform", "transform"),
        // Slips.
        ("briad", "lissajous_braid"),
        ("cornow", "lissajous_braid"),
        ("plaitt", "lissajous_braid"),
        ("merhe", "merge"),
        ("transfrm", "transform"),
        ("interpolte", "interpolate"),
        ("resmaple", "resample"),
    ];

    #[test]
    fn the_first_hit_is_what_was_meant() {
        assert!(TABLE.len() >= 60);
        let wrong: Vec<String> = TABLE
            .iter()
            .filter(|(typed, wanted)| first(typed) != *wanted)
            .map(|(typed, wanted)| format!("{typed:?} finds {}, not {wanted}", first(typed)))
            .collect();
        assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    }

    #[test]
    fn a_hit_says_why_it_is_one_and_a_choice_can_be_set() {
        let check = |typed: &str, id: &str, expected: Option<Why>| {
            let found = find(typed, coif_nodes::all(), &Hints::default());
            let def = found.iter().find(|def| def.id == id);
            let def = def.unwrap_or_else(|| panic!("{typed:?} does not find {id}"));
            assert_eq!(why(typed, def), expected, "{typed}");
        };
        check("noise", "cluster_to_strands", Some(Why::Input("frizz")));
        check("4c", "shape_list_curl", Some(Why::Choice("preset", "4c")));
        check("curl 4c", "shape_list_curl", Some(Why::Choice("preset", "4c")));
        check("preset 2b", "shape_list_curl", Some(Why::Choice("preset", "2b")));
        check("plait", "lissajous_braid", Some(Why::Word("plait")));
        // The first words of its choices: "Waves 12 mm high every 80 mm (2a)", "Zigzags 4 mm wide (4b)".
        check("waves", "shape_list_curl", Some(Why::Choice("preset", "2a")));
        check("wavy", "shape_list_curl", Some(Why::Choice("preset", "2a")));
        check("zigzags", "shape_list_curl", Some(Why::Choice("preset", "4b")));
        check("kinky", "shape_list_curl", Some(Why::Choice("preset", "4c")));
        check("curl", "shape_list_curl", None);
        check("shape list", "shape_list_curl", None);
        // Whatever finds a node says why, but for its own name and a slip of the finger.
        for (typed, id) in TABLE {
            let def = coif_nodes::by_id(id).unwrap();
            let label = fold(def.label);
            let plain = fold(typed).split(' ').all(|word| label.contains(word));
            let score = score_node(typed, def).unwrap();
            let odd = score.tier >= LETTERS && score.tier < PART;
            assert!(plain || odd || why(typed, def).is_some(), "{typed} finds {id}, but why?");
        }
    }

    #[test]
    fn one_slip_in_any_label_still_finds_it() {
        for def in coif_nodes::all() {
            let letters: Vec<char> = fold(def.label).chars().collect();
            for at in 1..letters.len() - 1 {
                // A slip that makes, breaks or joins words is two mistakes.
                if letters[at - 1..=at + 1].contains(&' ') {
                    continue;
                }
                let mut swapped = letters.clone();
                swapped.swap(at, at + 1);
                let mut missing = letters.clone();
                missing.remove(at);
                for typed in [swapped, missing] {
                    let typed: String = typed.into_iter().collect();
                    if typed.split(' ').any(|word| word.chars().count() < 4 && word != "to") {
                        continue;
                    }
                    let found = find(&typed, coif_nodes::all(), &Hints::default());
                    assert_eq!(found.first().map(|d| d.id), Some(def.id), "{typed:?}");
                }
            }
        }
    }

    #[test]
    fn nothing_typed_lists_all_and_nonsense_nothing() {
        let hints = Hints::default();
        assert_eq!(find("", coif_nodes::all(), &hints).len(), coif_nodes::all().count());
        assert_eq!(find(" - ", coif_nodes::all(), &hints).len(), coif_nodes::all().count());
        for nonsense in ["qqqqq", "\u{6F22}\u{5B57}", "xylophone trombone"] {
            assert!(find(nonsense, coif_nodes::all(), &hints).is_empty(), "{nonsense}");
        }
    }

    #[test]
    fn hints_decide_between_equals() {
        let hints = |recent: &'static [String], after: &[(&'static str, usize)]| Hints {
            recent,
            after: after.iter().copied().collect(),
        };
        let ids = |hints: &Hints<'_>| -> Vec<&str> {
            find("", coif_nodes::all(), hints).iter().take(2).map(|def| def.id).collect()
        };
        assert_eq!(ids(&hints(&[], &[("merge", 2), ("transform", 3)])), ["transform", "merge"]);
        let recent: &'static [String] = Box::leak(Box::new(["puff".into(), "merge".into()]));
        assert_eq!(ids(&hints(recent, &[]))[0], "merge");
        // They never lift what fits the letters less.
        let found = find("braid", coif_nodes::all(), &hints(recent, &[("edge_partition", 9)]));
        assert_eq!(found[0].id, "lissajous_braid");
    }

    #[test]
    fn any_script_can_be_searched() {
        let entry =
            SearchEntry {
                label: "косы спереди", words: "辫子 τάσι", ..SearchEntry::default()
            };
        for typed in ["Косы", "спер", "辫子", "ΤΆΣΙ"] {
            assert!(score(typed, &entry).is_some(), "{typed}");
        }
        assert!(score("сзади", &entry).is_none());
    }
}
