//! What a node may ask of its surroundings, and the ways in which it can run.
//!
//! **Invariant:** nodes own no threads, no cache and no clock; [`EvalCx`] lends them the host's. Which
//! thread does what, and what was reused, never shows in a result.
//!
//! The ways to hair: [`EvalCx::each_tuft`] (tufts to tufts), [`EvalCx::each_curve`] (one tuft from each curve),
//! [`EvalCx::each_tuft_with`] (tufts that read other tufts), [`EvalCx::each_item`] (one from each stroke or region). Each derives the
//! key of a piece of work from the node, its values and the tufts it reads, and asks the host for that piece before doing it. The ways
//! to what hair is made by: [`EvalCx::map`] (all at once), [`EvalCx::whole`] (one piece of work for the whole node), [`EvalCx::memo`]
//! (something that several evaluations share), [`EvalCx::fold`] (a list replayed on a state).
//!
//! Before any piece runs, a node says how much all of them will make ([`Size`]); what is more than its [`Room`] ends there, with
//! the inputs that make the number.
//!
//! A node whose scalp is a [`TracedScalp`] asks its sections in its pieces alone ([`EvalCx::by_place`]): where a parting moves, those
//! run again that read what is there.

mod log;
mod pieces;
mod shared;
mod traced;

use crate::data::curves::Curves;
use crate::data::gestures::Replayed;
use crate::data::scalp::{HeadFrame, Scalp, Skin};
use crate::error::NodeError;
use crate::maths::hash::{Dice, Key, KeyBuilder};
pub use log::{Log, Message};
pub use pieces::Piece;
use std::any::Any;
use std::sync::{Arc, PoisonError};
pub use traced::TracedScalp;

/// How much hair is made.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Quality {
    /// While something is dragged: nodes that make strands make the first tenth of each tuft.
    Preview,
    /// All of it.
    #[default]
    Final,
    /// Before a groom was ever seen: the first hundredth of each tuft.
    FirstLook,
}

/// A result as the cache keeps it.
pub type Kept = Arc<dyn Any + Send + Sync>;

/// Heads whose size is within this percentage of the average get no remark: the difference cannot be seen.
const SAME_SIZE: f32 = 0.5;
/// The most points that one node makes where nobody has allowed more: what all hair of a groom is to have.
pub const MOST_POINTS: u64 = 1 << 24;
/// Bytes that a point takes while a node works, its share of attributes and of room to grow counted in.
const BYTES_A_POINT: u64 = 32;
/// Fewer points than this are made without asking for room.
const FEW_POINTS: u64 = 1 << 20;
/// Bytes that are left to others.
const SPARE: u64 = 128 << 20;

/// How much one node may make.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Room {
    /// Points; none: as many as memory holds.
    pub points: Option<u64>,
    /// Bytes of memory that are free; none where that is not known.
    pub bytes: Option<u64>,
}

impl Default for Room {
    fn default() -> Self {
        Self { points: Some(MOST_POINTS), bytes: None }
    }
}

/// How many points a node is about to make, and what makes the number.
#[derive(Clone, Debug, PartialEq)]
pub struct Size {
    points: f64,
    of: String,
}

impl Size {
    /// The product of numbers, each with the name of its input or of what there is so many of.
    pub fn of(factors: &[(&str, f64)]) -> Self {
        let points = factors.iter().map(|(_, n)| n.max(0.0)).product();
        let of: Vec<String> = factors.iter().map(|(name, n)| format!("{name} {n:.0}")).collect();
        Self { points, of: of.join(" x ") }
    }
    /// As many as come in.
    pub fn as_many<'a>(lots: impl IntoIterator<Item = &'a Curves>) -> Self {
        let points: usize = lots.into_iter().map(Curves::point_count).sum();
        Self::of(&[("points that come in", points as f64)])
    }
}

/// A number of points in words.
fn millions(points: f64) -> String {
    format!("{:.1} million points", points / 1e6)
}

/// What the surroundings of an evaluation lend to nodes. One that only runs things is not asked to stop, and has no memory.
pub trait Host: Sync {
    /// How much a node may make.
    fn room(&self) -> Room {
        Room::default()
    }
    /// Runs `f(0)..f(n)`, in any order, maybe at once.
    fn for_each(&self, n: usize, f: &(dyn Fn(usize) + Sync));
    /// Whether somebody asked to stop.
    fn cancelled(&self) -> bool {
        false
    }
    /// What was kept under a key.
    fn find(&self, _key: Key) -> Option<Kept> {
        None
    }
    /// Offers something of so many bytes to the cache, which may keep it.
    fn keep(&self, _key: Key, _value: Kept, _bytes: usize) {}
    /// One more of the node's pieces of work is done, of so many.
    fn progress(&self, _done: usize, _of: usize) {}
}

/// One evaluation of one node.
pub struct EvalCx<'a> {
    /// The document's seed; nodes mix their own in through [`EvalCx::dice`].
    pub seed: u64,
    /// How much hair is made.
    pub quality: Quality,
    /// Hash of the node's kind and version, the seed, the quality where the node thins, and every input that is neither
    /// curves nor strokes: these enter the keys of the pieces that read them, so that one more stroke makes
    /// one more tuft.
    pub node: Key,
    /// The same without what pieces note that they read of it ([`crate::define::InputDef::key_untraced`]); none where that is nothing,
    /// or where nothing is kept.
    pub node_untraced: Option<Key>,
    /// The surroundings.
    host: &'a dyn Host,
    /// What is counted and said.
    pub log: &'a Log,
    /// True centimetres for each that was typed.
    unit: f32,
    /// The scalp of pieces that run by place.
    scalp: Option<&'a TracedScalp>,
    /// The fewest strands to make of each lot, if it has that many.
    least: usize,
}

/// The fewest strands that a preview makes of each lot, and the most that this minimum may add up to over all lots; then the same for a
/// first look.
const PREVIEW_LEAST: (usize, usize) = (16, 10_000);
const FIRST_LEAST: (usize, usize) = (4, 1_000);

impl<'a> EvalCx<'a> {
    /// An evaluation of a node with this key.
    pub fn new(seed: u64, quality: Quality, node: Key, host: &'a dyn Host, log: &'a Log) -> Self {
        let least = match quality {
            Quality::Final => usize::MAX,
            Quality::Preview => PREVIEW_LEAST.0,
            Quality::FirstLook => FIRST_LEAST.0,
        };
        Self { seed, quality, node, node_untraced: None, host, log, unit: 1.0, scalp: None, least }
    }
    /// For nodes that make `lots` separate lots of strands: with many lots, a preview makes fewer strands of each, so that it stays small.
    pub fn in_lots(&self, lots: usize) -> EvalCx<'a> {
        let most = match self.quality {
            Quality::Final => return EvalCx { ..*self },
            Quality::Preview => PREVIEW_LEAST.1,
            Quality::FirstLook => FIRST_LEAST.1,
        };
        let least = (most / lots.max(1)).clamp(1, self.least);
        if least == self.least {
            return EvalCx { ..*self };
        }
        let key = |key: Key| KeyBuilder::new("lots").key(key).int(least as u64).finish();
        let (node, node_untraced) = (key(self.node), self.node_untraced.map(key));
        EvalCx { node, node_untraced, least, ..*self }
    }
    /// For pieces that ask this scalp, if any, about its sections: they see it through [`Piece::scalp`], which notes what they read, and
    /// run again only where partings changed that they read.
    pub fn by_place<'s>(&'s self, scalp: Option<&'s TracedScalp>) -> EvalCx<'s> {
        EvalCx { scalp, ..*self }
    }
    /// Dice of this document for a node's seed tag and a purpose.
    pub fn dice(&self, tag: i64, purpose: &str) -> Dice {
        Dice::new(self.seed, tag as u64, purpose)
    }
    /// How many of `n` strands are made at this quality: all, the first max(16, n / 10), or the first max(4, n / 100); fewer than 16 or 4
    /// [in many lots](Self::in_lots).
    pub fn thinned(&self, n: usize) -> usize {
        match self.quality {
            Quality::Final => n,
            Quality::Preview => n.min(self.least.max(n / 10)),
            Quality::FirstLook => n.min(self.least.max(n / 100)),
        }
    }
    /// The same, once for each lot of strands that the node makes: pictures of a preview draw strands as much wider as there are
    /// fewer. To be asked outside pieces of work, which may be known from before.
    pub fn makes(&self, n: usize) -> usize {
        self.makes_each(1, n)
    }
    /// [`Self::makes`] for `lots` of `n` strands each; how many of each are made.
    pub fn makes_each(&self, lots: usize, n: usize) -> usize {
        let made = self.thinned(n);
        self.log.add_thinned([made, n].map(|n| n.saturating_mul(lots)));
        made
    }
    /// The skin of a head, for inside tests.
    pub fn skin<'s>(&self, scalp: &'s Scalp) -> Skin<'s> {
        scalp.skin()
    }
    /// The same where lengths grow with a head, which is remarked; where there is none, a typed centimetre is a centimetre.
    pub(crate) fn on_head(&self, head: Option<&HeadFrame>) -> EvalCx<'a> {
        let unit = head.map_or(1.0, HeadFrame::unit);
        let more = (unit - 1.0) * 100.0;
        if more.abs() >= SAME_SIZE {
            let (by, way) = (more.abs(), if more > 0.0 { "longer" } else { "shorter" });
            self.remark(format!(
                "lengths are {by:.0} % {way} than typed, with the size of the head"
            ));
        }
        EvalCx { unit, ..*self }
    }
    /// True centimetres for each that was typed. Inputs are multiplied already; this is for what else grows with the head.
    pub fn unit(&self) -> f32 {
        self.unit
    }
    /// Says something about the whole node.
    pub fn warn(&self, text: impl Into<String>) {
        self.log.say(Message { warning: true, text: text.into(), count: 0, curves: vec![] });
    }
    /// Remarks on something that is as it should be.
    pub fn remark(&self, text: impl Into<String>) {
        self.log.say(Message { warning: false, text: text.into(), count: 0, curves: vec![] });
    }
    /// Notes what became of the node's gestures.
    pub fn replayed(&self, gestures: Vec<Arc<Replayed>>) {
        *self.log.gestures.lock().unwrap_or_else(PoisonError::into_inner) = gestures;
    }
    /// Notes trouble with one curve outside a piece of work.
    pub fn trouble(&self, curve: u64, text: impl std::fmt::Display) {
        let curves = vec![curve];
        self.log.say(Message { warning: true, text: text.to_string(), count: 1, curves });
    }
    /// Fails when somebody asked to stop.
    pub fn check(&self) -> Result<(), NodeError> {
        if self.host.cancelled() { Err(NodeError::Cancelled) } else { Ok(()) }
    }

    /// Fails where so much is more than may be made. To be asked before anything is made, so that the answer costs nothing.
    pub fn may_make(&self, size: &Size) -> Result<(), NodeError> {
        if size.points <= FEW_POINTS as f64 {
            return Ok(());
        }
        let room = self.host.room();
        let Size { points, of } = size;
        if room.points.is_some_and(|most| *points > most as f64) {
            return Err(NodeError::TooLarge(format!("would make {} ({of})", millions(*points))));
        }
        let bytes = points * BYTES_A_POINT as f64;
        match room.bytes {
            Some(free) if bytes > free.saturating_sub(SPARE) as f64 => {
                Err(NodeError::failed(format!(
                    "would take some {:.1} GB of memory for {} ({of}), and {:.1} are free: ask for less hair, or for fewer \
                     points on each",
                    bytes / 1e9,
                    millions(*points),
                    free as f64 / 1e9
                )))
            }
            _ => Ok(()),
        }
    }

    /// The same for a size that takes a walk over all curves to foresee, asked only where it may be `most`.
    pub fn may_make_most(
        &self,
        most: f64,
        size: impl FnOnce() -> Result<Size, NodeError>,
    ) -> Result<(), NodeError> {
        if most <= FEW_POINTS as f64 { Ok(()) } else { self.may_make(&size()?) }
    }
}

/// A host without threads or memory, for tests of single nodes and for tools.
#[derive(Debug, Default)]
pub struct PlainHost;

impl Host for PlainHost {
    fn for_each(&self, n: usize, f: &(dyn Fn(usize) + Sync)) {
        (0..n).for_each(f);
    }
}

#[cfg(test)]
mod tests {
    use super::log::MOST_NAMED;
    use super::*;
    use crate::define::Value;
    use crate::maths::hash::KeyBuilder;
    use crate::testing::{Lends, Memory};

    /// Replays numbers on a sum; gives the sum, and how many steps ran and were reused.
    fn replay(host: &Memory, numbers: &[u64]) -> (u64, u32, u32) {
        let log = Log::default();
        let cx = EvalCx::new(0, Quality::Final, Key(1), host, &log);
        let items: Vec<(Key, u64)> =
            numbers.iter().map(|n| (KeyBuilder::new("item").int(*n).finish(), *n)).collect();
        let sum = cx.fold((Key(2), || Ok(0u64)), &items, |sum, n| Ok(sum * 10 + n), |_| 8).unwrap();
        (*sum, log.tufts_run.into_inner(), log.tufts_reused.into_inner())
    }

    #[test]
    fn a_fold_runs_on_from_the_longest_known_beginning() {
        let host = Memory::default();
        assert_eq!(replay(&host, &[1, 2, 3]), (123, 3, 0));
        assert_eq!(replay(&host, &[1, 2, 3]), (123, 0, 3));
        assert_eq!(replay(&host, &[1, 2, 3, 4]), (1234, 1, 3), "one more at the end");
        assert_eq!(replay(&host, &[1, 2]), (12, 0, 2), "undo");
        assert_eq!(replay(&host, &[1, 5, 3]), (153, 2, 1), "changed in the middle");
    }

    #[test]
    fn messages_join_repeats_and_name_the_first_few() {
        let log = Log::default();
        let host = PlainHost;
        let cx = EvalCx::new(0, Quality::Final, Key(1), &host, &log);
        (1..=20).for_each(|curve| cx.trouble(curve, "was left out"));
        let said: Vec<String> = log.messages().iter().map(Message::with_id).collect();
        assert_eq!(said, ["was left out (20 curves, first 0000000000000001)"]);
        assert_eq!(log.messages()[0].curves.len(), MOST_NAMED);
    }

    #[test]
    fn what_is_more_than_may_be_made_is_told_before_any_piece_runs() {
        let scalp = || crate::data::scalp::tests::shared_ball().into();
        let hair = |points: i64| {
            let set = [("scalp", scalp()), ("count", 30i32.into()), ("points", Value::Int(points))];
            let made = crate::testing::run(crate::by_id("scatter_guides").unwrap(), &set);
            ("curves", made.0.into_iter().next().unwrap())
        };
        let int = |name, n: i64| (name, Value::Int(n));
        let check = |id: &str, room: Room, mut set: Vec<(&str, Value)>, said: &str| {
            let node = crate::by_id(id).unwrap();
            if node.input("scalp").is_some() {
                set.push(("scalp", scalp()));
            }
            let (host, log) = (Lends(room), Log::default());
            let failed = crate::testing::run_on(node, &set, &host, &log, Quality::Final);
            let failed = failed.map(|_| ()).unwrap_err().to_string();
            assert!(failed.starts_with(said), "{id}: {failed}");
            assert_eq!(log.tufts_run.into_inner(), 0, "{id}");
        };
        let usual = Room::default();
        // 30 clusters x 65,536 strands x 1,000 points.
        let set = vec![hair(9), int("count", 65_536), int("points", 1000)];
        let said = "would make 1966.1 million points (clusters 30 x count 65536 x points 1000)";
        check("cluster_to_strands", usual, set.clone(), said);
        // All that is allowed still has to be held: 1.97 x 10^9 x 32 bytes.
        let full = Room { points: None, bytes: Some(8_000_000_000) };
        check("cluster_to_strands", full, set, "would take some 62.9 GB of memory for 1966.1");
        let set = vec![int("count", 1_000_000), int("points", 1000)];
        let said = "would make 1000.0 million points (puffs 1 x count 1000000 x points 1000)";
        check("sphere_puff", usual, set, said);
        let (_, guides) = hair(9);
        let by = ("by", "count".into());
        let set = vec![("guides", guides), by, int("count", 2_000_000), int("points", 1024)];
        let said = "would make 2048.0 million points (count 2000000 x points 1024)";
        check("interpolate", usual, set, said);
        let set = vec![int("count", 100_000), int("points", 1024)];
        let said = "would make 102.4 million points (count 100000 x points 1024)";
        check("scatter_guides", usual, set, said);
        // 40 lots of 30 curves of 1,000 points.
        let few = Room { points: Some(100_000), bytes: None };
        let lots: Vec<(&str, Value)> = (0..40).map(|_| hair(1000)).collect();
        check("merge", few, lots, "would make 1.2 million points (points that come in 1200000)");
    }

    #[test]
    fn preview_makes_a_tenth_and_sixteen_of_a_lot_unless_lots_are_many() {
        let (log, host) = (Log::default(), PlainHost);
        let cx = |quality| EvalCx::new(0, quality, Key(1), &host, &log);
        let thinned = |n| cx(Quality::Preview).thinned(n);
        assert_eq!([10, 100, 1000].map(thinned), [10, 16, 100]);
        assert_eq!([3, 100, 1000].map(|n| cx(Quality::FirstLook).thinned(n)), [3, 4, 10]);
        assert_eq!(cx(Quality::Final).thinned(1000), 1000);
        let in_lots = |quality, lots, n| {
            let cx = cx(quality);
            let many = cx.in_lots(lots);
            (many.thinned(n), many.node != cx.node)
        };
        assert_eq!(in_lots(Quality::Preview, 600, 30), (16, false));
        assert_eq!(in_lots(Quality::Preview, 2500, 30), (4, true));
        assert_eq!(in_lots(Quality::Preview, 1_000_000, 30), (3, true));
        assert_eq!(in_lots(Quality::FirstLook, 500, 30), (2, true));
        assert_eq!(in_lots(Quality::Final, 1_000_000, 30), (30, false));
    }
}
