//! Named parts of a mesh: which are left out, and which are suggested for leaving out.
//!
//! A part is named by its node, mesh, object or group, by enclosing nodes, by its material, and, for the largest
//! connected pieces of a mesh, by "piece 1" (the largest) and so on, since some files name nothing.
//!
//! Guarantees: only named parts are left out. Parts that sound like hair or stand over the crown are suggested, but
//! never one that holds most of the head.

use super::find::Pieces;
use super::fit::Patches;
use crate::data::mesh::{Mesh, keep};
use crate::data::scalp::Part;
use crate::define::short;
use glam::Vec3;
use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write;
use std::ops::Range;

/// Number of the largest pieces with names.
const MOST_PIECES: usize = 64;
/// Number of enclosing nodes that count as names of a mesh, besides its own.
const MOST_ABOVE: usize = 4;
/// Most names in a message, and in a list.
const MOST_TOLD: usize = 40;
const MOST_LISTED: usize = 200;
/// Most names that are suggested individually.
const FEW: usize = 8;
/// A part that stands over more patches of the crown than this is in the way.
const IN_THE_WAY: u32 = 1;
/// A part that holds more than this fraction of the head is suggested only if its name says that it is hair ...
const SOME: f64 = 0.02;
/// ... and one that holds more than this fraction, not even then.
const MOST: f64 = 0.5;

/// The names in a mesh, and the triangles of each.
pub(crate) struct Parts {
    names: Vec<String>,
    columns: Vec<Column>,
    /// Whether a name covers the whole mesh.
    is_all: Vec<bool>,
    /// The first name of a piece; earlier names come from the file.
    first_piece: usize,
    is_left_out: Vec<bool>,
    is_proposed: Vec<bool>,
}

/// One naming scheme: the group of each triangle, and the name of each group.
struct Column {
    of: Vec<u32>,
    names: Vec<Option<usize>>,
}

/// What to leave out.
pub(crate) struct LeftOutParts {
    /// For each triangle, whether it is left out.
    pub(crate) gone: Vec<bool>,
    /// For each triangle, whether it is left out and still seen: an eye is no skin, and part of every picture of a head.
    pub(crate) seen: Vec<bool>,
    /// Names and patterns that match nothing.
    pub(crate) unknown: Vec<String>,
}

/// What is suggested for leaving out.
pub(crate) struct Proposal {
    /// The names of parts that stand over the crown, quoted, and their number.
    over: (String, usize),
    /// The same for all others: parts that sound like hair, or stand over the edge of the scalp.
    others: (String, usize),
    /// The suggested value of `leave_out`.
    value: String,
}

impl Proposal {
    /// The message, and whether any of the parts is in the way.
    pub(crate) fn said(&self) -> (String, bool) {
        let Self { over: (over, n_over), others: (others, n_others), value } = self;
        let s = |n: usize| if n == 1 { "s" } else { "" };
        let mut text = String::new();
        if *n_over > 0 {
            let s = s(*n_over);
            let _ = write!(
                text,
                "{over} stand{s} over the crown and count{s} as skin, on which hair grows"
            );
        }
        if *n_others > 0 {
            let and = if *n_over > 0 { ", and " } else { "" };
            let _ = write!(
                text,
                "{and}{others} may be hair or worn, and count{} as skin",
                s(*n_others)
            );
        }
        let it = if n_over + n_others == 1 { "it" } else { "them" };
        let _ = write!(text, "; to leave {it} out, set leave_out to {value:?}");
        (text, *n_over > 0)
    }
}

impl Parts {
    /// The parts of a mesh and its pieces.
    pub(crate) fn of(mesh: &Mesh, pieces: &Pieces) -> Self {
        let (mut names, mut numbers, mut columns) = (vec![], BTreeMap::new(), vec![]);
        let mut number = |name: &str| -> Option<usize> {
            let name = name.trim();
            (!name.is_empty()).then(|| {
                *numbers.entry(name.to_owned()).or_insert_with(|| {
                    names.push(name.to_owned());
                    names.len() - 1
                })
            })
        };
        let mut column = |of: &[u32], names: Vec<Option<usize>>| {
            if !of.is_empty() && names.iter().any(Option::is_some) {
                columns.push(Column { of: of.to_vec(), names });
            }
        };
        column(&mesh.part_of, mesh.parts.iter().map(|name| number(name)).collect());
        for at in 0..=MOST_ABOVE {
            let at = |also: &Vec<String>| also.get(at).and_then(|name| number(name));
            column(&mesh.also_of, mesh.also.iter().map(at).collect());
        }
        column(&mesh.material_of, mesh.materials.iter().map(|name| number(name)).collect());
        let mut of_pieces = vec![];
        if pieces.count() > 1 {
            of_pieces = (1..=pieces.count().min(MOST_PIECES))
                .map(|n| number(&format!("piece {n}")))
                .collect();
        }
        let first_piece = of_pieces.iter().flatten().min().copied();
        column(&pieces.of, of_pieces);
        let first_piece = first_piece.unwrap_or(names.len());
        let count = names.len();
        let mut is_all = vec![false; count];
        for column in &columns {
            if let Some(Some(first)) = column.each().next() {
                is_all[first] |= column.each().all(|name| name == Some(first));
            }
        }
        Self {
            names,
            columns,
            is_all,
            first_piece,
            is_left_out: vec![false; count],
            is_proposed: vec![false; count],
        }
    }

    /// What the comma-separated names and patterns of `text` leave out.
    pub(crate) fn leave_out(&mut self, text: &str) -> LeftOutParts {
        let mut unknown = vec![];
        for pattern in text.split(',').map(str::trim).filter(|pattern| !pattern.is_empty()) {
            let matches = self.names.iter().map(|name| is_match(pattern, name));
            let matched: Vec<usize> =
                matches.enumerate().filter_map(|(i, fits)| fits.then_some(i)).collect();
            if matched.is_empty() {
                unknown.push(pattern.to_owned());
            }
            matched.into_iter().for_each(|name| self.is_left_out[name] = true);
        }
        let count = self.columns.first().map_or(0, |column| column.of.len());
        let (mut gone, mut seen) = (vec![false; count], vec![false; count]);
        let in_head: Vec<bool> = self.names.iter().map(|name| is_in_the_head(name)).collect();
        for column in &self.columns {
            for ((gone, seen), name) in gone.iter_mut().zip(&mut seen).zip(column.each()) {
                let name = name.filter(|name| self.is_left_out[*name]);
                *gone |= name.is_some();
                *seen |= name.is_some_and(|name| in_head[name]);
            }
        }
        for column in &mut self.columns {
            keep(&mut column.of, &gone);
        }
        LeftOutParts { gone, seen, unknown }
    }

    /// Parts that may be hair: those that sound like it, and those that stand over the crown. `over` has one bit for
    /// each patch of the crown that a triangle stands over; `is_skin` marks what is certainly head; both may be empty.
    pub(crate) fn propose(
        &mut self,
        points: &[Vec3],
        triangles: &[[u32; 3]],
        is_skin: &[bool],
        over: &[u128],
    ) -> Option<Proposal> {
        let area = |t: &[u32; 3]| {
            let [a, b, c] = t.map(|v| points[v as usize].as_dvec3());
            (b - a).cross(c - a).length()
        };
        let areas: Vec<f64> = triangles.iter().map(area).collect();
        let skin = |t: usize| is_skin.get(t).copied().unwrap_or(is_skin.is_empty());
        let whole: f64 = areas.iter().enumerate().filter(|(t, _)| skin(*t)).map(|(_, a)| a).sum();
        // How much of the head each name covers.
        let mut holds = vec![0.0f64; self.names.len()];
        for column in &self.columns {
            for (t, name) in column.each().enumerate().filter(|(t, _)| skin(*t)) {
                name.into_iter().for_each(|name| holds[name] += areas[t]);
            }
        }
        let sounds: Vec<bool> = self.names.iter().map(|name| sounds_like_hair(name)).collect();
        let mut taken = vec![false; triangles.len()];
        let mut is_over = vec![false; self.names.len()];
        for column in &self.columns {
            let mut patches = vec![0u128; self.names.len()];
            let mut is_there = vec![false; self.names.len()];
            let left = column.each().enumerate().filter(|(t, _)| !taken[*t]);
            for (t, name) in left.filter_map(|(t, name)| Some((t, name?))) {
                is_there[name] = true;
                patches[name] |= over.get(t).copied().unwrap_or(0);
            }
            for name in 0..self.names.len() {
                let held = holds[name] / whole.max(f64::MIN_POSITIVE);
                if !is_there[name] || held > MOST {
                    continue;
                }
                let blocks = patches[name].count_ones() > IN_THE_WAY && held < SOME;
                is_over[name] |= blocks && patches[name] & Patches::UPPER != 0;
                self.is_proposed[name] |= blocks || sounds[name];
            }
            for (taken, name) in taken.iter_mut().zip(column.each()) {
                *taken |= name.is_some_and(|name| self.is_proposed[name]);
            }
        }
        let numbers: Vec<usize> =
            (0..self.names.len()).filter(|name| self.is_proposed[*name]).collect();
        let proposed: Vec<&str> = numbers.iter().map(|name| self.names[*name].as_str()).collect();
        let told = |over: bool| {
            let some = || numbers.iter().copied().filter(|name| is_over[*name] == over);
            (self.listed_names(some()), some().count())
        };
        (!proposed.is_empty()).then(|| Proposal {
            over: told(true),
            others: told(false),
            value: self.as_patterns(&proposed).join(", "),
        })
    }

    /// Names as patterns: names that differ only in their numbers become one pattern, if it matches no other name.
    fn as_patterns(&self, names: &[&str]) -> Vec<String> {
        if names.len() <= FEW {
            return names.iter().map(|name| as_pattern(name)).collect();
        }
        let stem = |name: &&str| name.trim_end_matches(|c: char| !c.is_alphabetic()).to_owned();
        let stems: BTreeSet<String> = names.iter().map(stem).collect();
        let is_own = |pattern: &str| {
            let mut all = self.names.iter().zip(&self.is_proposed);
            all.all(|(name, proposed)| *proposed || !is_match(pattern, name))
        };
        let short = stems.into_iter().filter(|stem| !stem.is_empty()).take(MOST_TOLD);
        let short: Vec<String> = short.map(|stem| as_pattern(&stem) + "*").collect();
        let mut patterns: Vec<String> = short.into_iter().filter(|p| is_own(p)).collect();
        for name in names {
            if !patterns.iter().any(|pattern| is_match(pattern, name)) {
                patterns.push(as_pattern(name));
            }
        }
        patterns
    }

    /// All names, for messages.
    pub(crate) fn listed(&self) -> String {
        self.listed_names((0..self.names.len()).filter(|i| self.is_worth_telling(*i)))
    }

    /// Some names, followed by pieces, which are identified by size.
    fn listed_names(&self, some: impl Iterator<Item = usize>) -> String {
        let (names, pieces): (Vec<usize>, Vec<usize>) = some.partition(|i| *i < self.first_piece);
        let all = |of: &[usize]| listed(&of.iter().map(|i| &self.names[*i]).collect::<Vec<_>>());
        match (names.is_empty(), pieces.is_empty()) {
            (_, true) => all(&names),
            (true, _) => all(&pieces),
            _ => format!("{} and, by size, {}", all(&names), all(&pieces)),
        }
    }

    /// For messages: the names of which more than half of the triangles are in `some`.
    pub(crate) fn listed_mostly_in(&self, some: &[bool]) -> String {
        let mut counts = vec![[0usize; 2]; self.names.len()];
        for column in &self.columns {
            for (name, some) in
                column.each().zip(some).filter_map(|(name, some)| Some((name?, some)))
            {
                counts[name][usize::from(*some)] += 1;
            }
        }
        let names = (0..self.names.len()).filter(|i| {
            let [others, some] = counts[*i];
            some > others && !self.is_all[*i] && self.is_worth_telling(*i)
        });
        self.listed_names(names)
    }

    /// Whether a name comes from the file, or is a piece without a better name.
    fn is_worth_telling(&self, name: usize) -> bool {
        let has_names = self.is_all[..self.first_piece].iter().any(|all| !all);
        name < self.first_piece || !has_names || self.is_left_out[name] || self.is_proposed[name]
    }

    /// All parts except those that cover the whole mesh, each with its triangles; suggested and left-out parts first.
    pub(crate) fn list(&self) -> Vec<Part> {
        let mut runs = self.runs();
        let part = |i: usize| Part {
            name: self.names[i].clone(),
            pattern: as_pattern(&self.names[i]),
            is_left_out: self.is_left_out[i],
            is_proposed: self.is_proposed[i],
            is_listed: self.is_worth_telling(i),
            triangles: std::mem::take(&mut runs[i]).into(),
        };
        let some = (0..self.names.len()).filter(|i| !self.is_all[*i]);
        let mut parts: Vec<Part> = some.map(part).collect();
        parts.sort_by_key(|part| (!(part.is_left_out || part.is_proposed), !part.is_listed));
        parts.truncate(MOST_LISTED);
        parts
    }

    /// The triangles of each name, as runs of numbers in rising order.
    fn runs(&self) -> Vec<Vec<Range<u32>>> {
        let mut runs: Vec<Vec<Range<u32>>> = vec![vec![]; self.names.len()];
        for column in &self.columns {
            for (t, name) in (0u32..).zip(column.each()) {
                let Some(runs) = name.map(|name| &mut runs[name]) else { continue };
                match runs.last_mut().filter(|last| last.end == t) {
                    Some(last) => last.end += 1,
                    None => runs.push(t..t + 1),
                }
            }
        }
        // Columns may share a name.
        for runs in &mut runs {
            runs.sort_by_key(|run| run.start);
            runs.dedup_by(|next, run| {
                let meets = next.start <= run.end;
                if meets {
                    run.end = run.end.max(next.end);
                }
                meets
            });
        }
        runs
    }
}

impl Column {
    /// The name of each triangle.
    fn each(&self) -> impl Iterator<Item = Option<usize>> {
        self.of.iter().map(|group| self.names.get(*group as usize).copied().flatten())
    }
}

/// The first few names, each quoted and truncated, and how many more there are.
pub(super) fn listed(names: &[impl AsRef<str>]) -> String {
    let mut text = String::new();
    for (i, name) in names.iter().take(MOST_TOLD).enumerate() {
        let _ = write!(text, "{}{:?}", if i > 0 { ", " } else { "" }, short(name.as_ref()));
    }
    if names.len() > MOST_TOLD {
        let _ = write!(text, " and {} more", names.len() - MOST_TOLD);
    }
    text
}

/// A name as a pattern that matches it.
fn as_pattern(name: &str) -> String {
    name.replace(',', "*")
}

/// Whether a name matches a pattern, ignoring case; `*` matches any text.
fn is_match(pattern: &str, name: &str) -> bool {
    let (pattern, name) = (pattern.to_lowercase(), name.trim().to_lowercase());
    let (pattern, name) = (pattern.as_bytes(), name.as_bytes());
    let (mut p, mut n) = (0, 0);
    // The last `*`, and where its match ends, before `n`.
    let mut star: Option<(usize, usize)> = None;
    while n < name.len() {
        if pattern.get(p) == Some(&b'*') {
            star = Some((p, n));
            p += 1;
        } else if pattern.get(p) == Some(&name[n]) {
            (p, n) = (p + 1, n + 1);
        } else if let Some((at, until)) = star {
            star = Some((at, until + 1));
            (p, n) = (at + 1, until + 1);
        } else {
            return false;
        }
    }
    pattern[p..].iter().all(|c| *c == b'*')
}

/// Words for hair and for things worn on a head, in the singular.
const WORDS: &[&str] = &[
    "hair",
    "brow",
    "eyebrow",
    "lash",
    "eyelash",
    "beard",
    "moustache",
    "mustache",
    "wig",
    "pony",
    "ponytail",
    "pigtail",
    "braid",
    "bun",
    "fringe",
    "bang",
    "hat",
    "cap",
    "helmet",
    "glasses",
    "hood",
    "eyeglasses",
    "sunglasses",
    "goggle",
    "headphone",
    "bandana",
    "headband",
];
/// Words that longer words may begin or end with.
const STEMS: &[&str] = &["hair", "eyebrow", "eyelash", "ponytail", "helmet", "beard", "glasses"];

/// Whether a name sounds like hair, or like something worn on a head.
fn sounds_like_hair(name: &str) -> bool {
    words(name).iter().any(|word| {
        let word = word.as_str();
        let singular = word.strip_suffix('s').unwrap_or(word);
        let shortest = singular.strip_suffix('e').unwrap_or(singular);
        let stem =
            |stem: &str| word.starts_with(stem) || singular.ends_with(stem) || word.ends_with(stem);
        WORDS.iter().any(|known| [word, singular, shortest].contains(known))
            || (!singular.ends_with("chair") && STEMS.iter().any(|known| stem(known)))
    })
}

/// Words for what a head holds and shows, in the singular.
const IN_THE_HEAD: &[&str] = &[
    "eye", "eyeball", "iris", "pupil", "cornea", "sclera", "teeth", "tooth", "tongue", "gum",
    "mouth",
];

/// Whether a name sounds like eyes, teeth or a tongue, and not like what is worn about them.
fn is_in_the_head(name: &str) -> bool {
    let is_known = |word: &String| {
        let word = word.as_str();
        IN_THE_HEAD
            .iter()
            .any(|known| [word, word.strip_suffix('s').unwrap_or(word)].contains(known))
    };
    words(name).iter().any(is_known) && !sounds_like_hair(name)
}

/// The words of a name: runs of letters, with a new word at each capital after a lowercase letter.
fn words(name: &str) -> Vec<String> {
    let (mut words, mut was_small) = (vec![String::new()], false);
    for c in name.chars() {
        if !c.is_alphabetic() || (c.is_uppercase() && was_small) {
            words.push(String::new());
        }
        was_small = c.is_lowercase();
        if c.is_alphabetic() {
            words.last_mut().unwrap_or(&mut String::new()).extend(c.to_lowercase());
        }
    }
    words.retain(|word| !word.is_empty());
    words
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pattern_stands_for_what_it_says_in_any_case() {
        for (pattern, name, fits) in [
            ("hair", "Hair", true),
            ("hair", "Hair_01", false),
            ("hair*", "Hair_01", true),
            ("*hair", "LongHair", true),
            ("*air*1", "Hair_01", true),
            ("*air*2", "Hair_01", false),
            ("a*b*c", "aXbXbXc", true),
            ("*", "", true),
            ("a**", "a", true),
            ("", "a", false),
            ("hair", " hair ", true),
            ("Ä*", "ärmel", true),
        ] {
            assert_eq!(is_match(pattern, name), fits, "{pattern:?} {name:?}");
        }
        // A comma in a name is escaped, so that the list does not end there.
        assert!(is_match(&as_pattern("hair, long"), "hair, long"));
    }

    #[test]
    fn eyes_and_teeth_are_in_the_head_and_what_is_about_them_is_not() {
        for name in
            ["Eye_L", "eyes", "leftEye", "EyeBall", "Teeth.001", "tongue", "Cornea", "Wolf3D_Eyes"]
        {
            assert!(is_in_the_head(name), "{name}");
        }
        for name in
            ["eyebrow", "eye lashes", "Eye_Glasses", "hair", "hat", "head", "eyelid", "piece 2"]
        {
            assert!(!is_in_the_head(name), "{name}");
        }
    }

    #[test]
    fn many_numbered_names_are_proposed_as_one_pattern() {
        let parts = ["head", "hairy face"].map(str::to_owned).into_iter();
        let parts = parts.chain((0..20).map(|k| format!("card.{k:03}"))).chain(["hat".to_owned()]);
        let names: Vec<String> = parts.collect();
        let is_proposed = names.iter().map(|n| n.starts_with("card") || n == "hat").collect();
        let none = vec![false; names.len()];
        let (is_all, is_left_out) = (none.clone(), none);
        let first_piece = names.len();
        let parts = Parts { names, columns: vec![], is_all, first_piece, is_left_out, is_proposed };
        let proposed: Vec<&str> = parts.names[2..].iter().map(String::as_str).collect();
        assert_eq!(parts.as_patterns(&proposed), ["card*", "hat*"]);
        assert_eq!(parts.as_patterns(&proposed[19..]), ["card.019", "hat"]);
    }

    #[test]
    fn hair_and_what_is_worn_is_known_by_its_words() {
        for name in [
            "Hair",
            "hair_01",
            "HairCap",
            "GEO-hair",
            "long_hair.002",
            "Eyebrows",
            "M_EyeLashes",
            "eyelash",
            "brow.L",
            "Hat",
            "hats",
            "Glasses",
            "sunglasses",
            "beard_mat",
            "cap",
            "Helmet2",
            "ponyTail",
            "Pony",
            "bun",
            "buns",
            "fringe",
            "Bangs",
        ] {
            assert!(sounds_like_hair(name), "{name}");
        }
        for name in [
            "chair",
            "armchairs",
            "that",
            "hatch",
            "capsule",
            "brown",
            "M_Brown",
            "splash",
            "bundle",
            "scape",
            "bunny",
            "skin",
            "head",
            "glass",
            "banger",
            "eyes",
            "",
            "0_1",
        ] {
            assert!(!sounds_like_hair(name), "{name}");
        }
    }
}
