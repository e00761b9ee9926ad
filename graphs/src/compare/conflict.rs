//! What two people changed, each otherwise: told in words, and written into the document that ours is kept in.
//!
//! Guarantees: a conflict is one line, whatever its values hold; in a document it stands as a comment before the entry that it is
//! about, or before the nearest thing that is there, so that the file opens and no reader passes it in silence ([`CONFLICT`]).

use super::diff::Change;
use super::fact::{Fact, Said};
use super::words::{cut, one_line, plain};
use crate::document::{Document, FileEntry, Setting};
use crate::file::CONFLICT;
use std::collections::BTreeMap;
use std::fmt;

/// The most conflicts that are written before one entry: who finds so many merges by hand.
const MOST_LINES: usize = 20;
/// Letters of what theirs says: it is what is lost otherwise.
const MOST_OF_THEIRS: usize = 200;
/// Letters of the other two, which are in the files.
const MOST_OF_OTHERS: usize = 60;

/// Something that both changed.
#[derive(Clone, Debug, PartialEq)]
pub struct Conflict {
    /// About what.
    pub fact: Fact,
    /// What it was.
    pub base: Option<Said>,
    /// What ours says, which is kept.
    pub ours: Option<Said>,
    /// What theirs says.
    pub theirs: Option<Said>,
    /// How the two do not go together.
    pub clash: Clash,
}

/// How two changes do not go together.
#[derive(Clone, Debug, PartialEq)]
pub enum Clash {
    /// Both changed the same.
    Changed,
    /// Both changed the same stroke or gesture of a list, or one removed it; the values are that one alone.
    Item(&'static str, u64),
    /// Both brought a list into another order.
    Order,
    /// Both added a node of this id, and not the same.
    Added,
    /// One made the node another kind while the other changed what it takes.
    Kind,
    /// One removed the node while the other changed this of it, or wired it.
    Removed(Vec<Change>),
    /// Each for itself is whole, and both together are not: what a check says of it. What could not be evaluated is as ours has it;
    /// where neither value is given, nothing of either was left out.
    Together(String),
}

impl fmt::Display for Conflict {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let said = |said: &Option<Said>, most: usize| match said {
            Some(said) => cut(&exactly(said), most),
            None if matches!(self.clash, Clash::Item(..)) => "none".to_owned(),
            None => self.fact.unsaid().to_owned(),
        };
        let [base, ours] = [&self.base, &self.ours].map(|s| said(s, MOST_OF_OTHERS));
        let theirs = said(&self.theirs, MOST_OF_THEIRS);
        let values = format!("base {base}, ours {ours}, theirs {theirs}");
        let text = match &self.clash {
            Clash::Changed => format!("{}: {values}", self.fact),
            Clash::Item(word, id) => format!("{}: {word} {id}: {values}", self.fact),
            Clash::Order => format!("{}: both put them into another order: {values}", self.fact),
            Clash::Added => {
                format!("{}: both added this node: ours {ours}, theirs {theirs}", self.fact)
            }
            Clash::Kind => {
                format!(
                    "{}: one made the node another kind, the other changed it: {values}",
                    self.fact
                )
            }
            Clash::Removed(also) => {
                let (gone, there) = match &self.ours {
                    None => ("ours", "theirs"),
                    Some(_) => ("theirs", "ours"),
                };
                let node = self.fact.node().map_or_else(String::new, ToString::to_string);
                let change = |Change { fact, from, to }: &Change| {
                    let said = |said: &Option<Said>| {
                        said.as_ref().map_or(fact.unsaid().to_owned(), |said| {
                            cut(&plain(said), MOST_OF_OTHERS)
                        })
                    };
                    format!("{fact} from {} to {}", said(from), said(to))
                };
                let what: Vec<String> = also.iter().take(3).map(change).collect();
                let more = match also.len().saturating_sub(3) {
                    0 => String::new(),
                    n => format!(" and {n} more"),
                };
                format!("{node}: {gone} removed it, {there} changed {}{more}", what.join(", "))
            }
            Clash::Together(text) if self.ours == self.theirs => {
                format!("{}: both together: {text}", self.fact)
            }
            Clash::Together(text) => {
                format!("{}: both together: {text}: ours {ours}, theirs {theirs}", self.fact)
            }
        };
        f.write_str(&one_line(&text))
    }
}

/// What is said, so that nothing of a text is lost on one line: a blank that is no space, or stands behind another, is escaped.
fn exactly(said: &Said) -> String {
    let text = plain(said);
    if !matches!(said, Said::Text(_) | Said::Setting(Setting::Known(_))) {
        return text;
    }
    let (mut out, mut was_blank) = (String::new(), false);
    for c in text.chars() {
        let is_blank = c.is_whitespace();
        match is_blank && (was_blank || c != ' ') {
            true => out.extend(c.escape_unicode()),
            false => out.push(c),
        }
        was_blank = is_blank;
    }
    out
}

/// What a conflict tells of what theirs says of a fact.
pub(super) fn text_of_theirs(fact: &Fact, said: Option<&Said>) -> String {
    let text = said.map_or_else(|| fact.unsaid().to_owned(), exactly);
    one_line(&cut(&text, MOST_OF_THEIRS))
}

/// The same of ours.
pub(super) fn text_of_ours(fact: &Fact, said: Option<&Said>) -> String {
    let text = said.map_or_else(|| fact.unsaid().to_owned(), exactly);
    one_line(&cut(&text, MOST_OF_OTHERS))
}

/// The nearest place that the document has: the entry itself, what it stands in, the top.
pub(super) fn nearest(document: &Document, place: &FileEntry) -> FileEntry {
    let field = |name: &str| FileEntry::Field(name.to_owned());
    let mut place = place.clone();
    while !document.has(&place) {
        place = match place {
            FileEntry::Input(id, _)
            | FileEntry::NodeField(id, _)
            | FileEntry::Layout(id)
            | FileEntry::Collapsed(id) => FileEntry::Node(id),
            FileEntry::Link(to) | FileEntry::Bends(to) => FileEntry::Node(to.node),
            FileEntry::Node(_) => field("nodes"),
            FileEntry::Frame(_) => field("frames"),
            FileEntry::View(_) => field("views"),
            FileEntry::Field(_) | FileEntry::Top => FileEntry::Top,
        };
    }
    place
}

/// Where a fact stands in a file.
fn place(fact: &Fact) -> FileEntry {
    let field = |name: &str| FileEntry::Field(name.to_owned());
    let of_node = |id: &crate::document::NodeId, name: &str| {
        FileEntry::NodeField(id.clone(), name.to_owned())
    };
    match fact {
        Fact::Title => field("title"),
        Fact::Note => field("note"),
        Fact::Seed => field("seed"),
        Fact::Display => field("display"),
        Fact::Budget(_) => field("budget"),
        Fact::Look => field("look"),
        Fact::Thumbnail => field("thumbnail"),
        Fact::Kind(id) => of_node(id, "kind"),
        Fact::Label(id) => of_node(id, "label"),
        Fact::NodeNote(id) => of_node(id, "note"),
        Fact::Bypass(id) => of_node(id, "bypass"),
        Fact::Ports(id) => of_node(id, "interface"),
        Fact::Template(id) => of_node(id, "template"),
        Fact::Input(id, name) => FileEntry::Input(id.clone(), name.clone()),
        Fact::Wires(to) => FileEntry::Link(to.clone()),
        Fact::Frame(name) => FileEntry::Frame(name.clone()),
        Fact::View(name) => FileEntry::View(name.clone()),
        Fact::Layout(id) => FileEntry::Layout(id.clone()),
        Fact::Collapsed(id) => FileEntry::Collapsed(id.clone()),
        Fact::Comment(place) => place.clone(),
    }
}

/// Writes conflicts into a document, as comments.
pub(super) fn write(document: &mut Document, conflicts: &[Conflict]) {
    let mut by_place = BTreeMap::<FileEntry, Vec<&Conflict>>::new();
    for conflict in conflicts {
        by_place.entry(nearest(document, &place(&conflict.fact))).or_default().push(conflict);
    }
    for (place, all) in by_place {
        let more = all.len().saturating_sub(MOST_LINES);
        let lines = all.iter().take(MOST_LINES).map(|conflict| format!("{CONFLICT} {conflict}"));
        let more = (more > 0).then(|| format!("{CONFLICT} and {more} more of the kind"));
        document.comments.entry(place).or_default().extend(lines.chain(more));
    }
}
