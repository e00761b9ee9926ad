//! What a node may ask of its surroundings, and the four ways in which it can run.
//!
//! **Invariant:** nodes own no threads, no cache and no clock; [`EvalCx`] lends them the host's. Which
//! thread does what, and what was reused, never shows in a result.
//!
//! The ways: [`EvalCx::each_tuft`] (tufts to tufts), [`EvalCx::each_curve`] (one tuft from each curve),
//! [`EvalCx::each_tuft_with`] (tufts that read other tufts), [`EvalCx::fold`] (a list replayed on a
//! state). Each derives the key of a piece of work from the node, its values and the tufts it reads, and asks the host
//! for that piece before doing it.
//!
//! Before any piece runs, a node says how much all of them will make ([`Size`]); what is more than its [`Room`] ends there, with
//! the inputs that make the number.
//!
//! Pieces that ask a parted scalp about places only may run by place ([`EvalCx::by_place`]): where a parting moves, those run
//! again that read what is there.

use crate::data::curves::{Curves, Tuft, TuftBuilder};
use crate::data::gestures::Replayed;
use crate::data::read_set::{Footprint, traced};
use crate::data::route::Route;
use crate::data::route::hair::Hair;
use crate::data::scalp::{Scalp, Skin};
use crate::data::sections::Sections;
use crate::error::NodeError;
use crate::maths::hash::{Dice, Key, KeyBuilder};
use glam::Vec3;
use std::any::Any;
use std::collections::BTreeMap;
use std::sync::atomic::{AtomicBool, AtomicU32, AtomicU64, Ordering};
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

/// How much hair is made.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Quality {
    /// While something is dragged: nodes that make strands make the first tenth of each tuft.
    Preview,
    /// All of it.
    #[default]
    Final,
}

/// A result as the cache keeps it.
pub type Kept = Arc<dyn Any + Send + Sync>;

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

/// What the surroundings of an evaluation lend to nodes.
pub trait Host: Sync {
    /// How much a node may make.
    fn room(&self) -> Room {
        Room::default()
    }
    /// Runs `f(0)..f(n)`, in any order, maybe at once.
    fn for_each(&self, n: usize, f: &(dyn Fn(usize) + Sync));
    /// Whether somebody asked to stop.
    fn cancelled(&self) -> bool;
    /// What was kept under a key.
    fn find(&self, key: Key) -> Option<Kept>;
    /// Offers something of so many bytes to the cache, which may keep it.
    fn keep(&self, key: Key, value: Kept, bytes: usize);
    /// One more of the node's pieces of work is done, of so many.
    fn progress(&self, done: usize, of: usize);
}

/// Trouble with single curves, told once with their number.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Message {
    /// Whether something was left out or changed (else it is a remark).
    pub warning: bool,
    /// What happened, without the curves.
    pub text: String,
    /// How many curves it happened to; 0: it is not about single curves.
    pub count: u32,
    /// Ids of the first few.
    pub curves: Vec<u64>,
}

impl std::fmt::Display for Message {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self.count {
            0 => f.write_str(&self.text),
            1 => write!(f, "{} (curve {:016x})", self.text, self.curves[0]),
            n => write!(f, "{} ({n} curves, first {:016x})", self.text, self.curves[0]),
        }
    }
}

/// What an evaluation of one node counted and said.
#[derive(Debug, Default)]
pub struct Log {
    /// Pieces of work (tufts) that ran.
    pub tufts_run: AtomicU32,
    /// Pieces that the cache had.
    pub tufts_reused: AtomicU32,
    messages: Mutex<Vec<Message>>,
    gestures: Mutex<Vec<Arc<Replayed>>>,
}

impl Log {
    /// What became of the node's gestures, one for each in their order.
    pub fn gestures(&self) -> Vec<Arc<Replayed>> {
        self.gestures.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }
    /// Everything said, repeats joined.
    pub fn messages(&self) -> Vec<Message> {
        self.messages.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }
    fn say(&self, message: Message) {
        let mut all = self.messages.lock().unwrap_or_else(PoisonError::into_inner);
        match all.iter_mut().find(|m| m.text == message.text && m.warning == message.warning) {
            Some(same) => {
                same.count += message.count;
                same.curves.extend(message.curves);
                same.curves.truncate(MOST_NAMED);
            }
            None => all.push(message),
        }
    }
}

/// A number of points in words.
fn millions(points: f64) -> String {
    format!("{:.1} million points", points / 1e6)
}

/// How many curves a message names.
const MOST_NAMED: usize = 8;

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
    /// The same without what partings the scalp has; none where it has none, or where an input asks for a mask, which may be a
    /// section.
    pub node_by_place: Option<Key>,
    /// The surroundings.
    pub host: &'a dyn Host,
    /// What is counted and said.
    pub log: &'a Log,
    /// True centimetres for each that was typed.
    unit: f32,
    /// The key and the sections of pieces that run by place.
    by_place: Option<(Key, &'a Sections)>,
}

/// One piece of work while it runs.
pub struct Piece<'a> {
    host: &'a dyn Host,
    since: u32,
    troubles: BTreeMap<String, (u32, Vec<u64>)>,
}

impl Piece<'_> {
    /// To be called for every curve: now and then looks whether somebody asked to stop.
    #[inline]
    pub fn tick(&mut self) -> Result<(), NodeError> {
        self.since += 1;
        if self.since.is_multiple_of(64) && self.host.cancelled() {
            return Err(NodeError::Cancelled);
        }
        Ok(())
    }
    /// Notes trouble with one curve. The text is the same for all curves it happens to.
    pub fn trouble(&mut self, curve: u64, text: impl std::fmt::Display) {
        let (count, curves) = self.troubles.entry(text.to_string()).or_default();
        *count += 1;
        if curves.len() < MOST_NAMED {
            curves.push(curve);
        }
    }
}

impl Piece<'_> {
    /// The tuft with hairs where they may be of what `bend` wishes: given a hair and its number, it moves the points, all of them there
    /// as they are. Hair that may be nowhere near is left as it was, which is told.
    pub(crate) fn bend(
        &mut self,
        route: &Route,
        tuft: &Tuft,
        mut bend: impl FnMut(&Hair, usize, &mut [Vec3]),
    ) -> Result<Tuft, NodeError> {
        let (mut hair, mut new) = (Hair::default(), vec![]);
        let mut moved = route.moved(tuft);
        for i in 0..tuft.len() {
            self.tick()?;
            if !hair.read(tuft.curve(i)) {
                continue;
            }
            new.clear();
            new.extend_from_slice(tuft.curve(i));
            bend(&hair, i, &mut new);
            if let Err(why) = moved.hair(i, &mut new) {
                self.trouble(tuft.id(i), why);
            }
        }
        Ok(moved.done().map_or_else(|| tuft.clone(), TuftBuilder::build))
    }
}

struct Made {
    tufts: Vec<Vec<Arc<Tuft>>>,
    troubles: Vec<Message>,
}

impl Made {
    fn bytes(&self) -> usize {
        self.tufts.iter().flatten().map(|t| t.bytes()).sum::<usize>() + 256
    }
}

/// A piece by place: what was made last, each with what it read of the sections.
struct ByPlace(Vec<(Footprint, Arc<Made>)>);

/// For how many ways in which a scalp was parted a piece is kept: back and forth.
const WAYS: usize = 2;

impl<'a> EvalCx<'a> {
    /// An evaluation of a node with this key.
    pub fn new(seed: u64, quality: Quality, node: Key, host: &'a dyn Host, log: &'a Log) -> Self {
        Self { seed, quality, node, node_by_place: None, host, log, unit: 1.0, by_place: None }
    }
    /// For pieces that read of the node's scalp's sections what is told by place, in the piece, and nothing else that comes from
    /// them: neither what they hold from outside nor what several of them share. They run again only where partings changed
    /// that they read.
    pub fn by_place<'s>(&'s self, scalp: Option<&'s Scalp>) -> EvalCx<'s> {
        EvalCx { by_place: self.node_by_place.zip(scalp.and_then(Scalp::sections)), ..*self }
    }
    /// Dice of this document for a node's seed tag and a purpose.
    pub fn dice(&self, tag: i64, purpose: &str) -> Dice {
        Dice::new(self.seed, tag as u64, purpose)
    }
    /// How many of `n` strands are made at this quality: all, or the first max(16, n / 10).
    pub fn thinned(&self, n: usize) -> usize {
        match self.quality {
            Quality::Final => n,
            Quality::Preview => n.min(16.max(n / 10)),
        }
    }
    /// The skin of a head, for inside tests.
    pub fn skin<'s>(&self, scalp: &'s Scalp) -> Skin<'s> {
        scalp.skin()
    }
    /// The same where lengths grow with a head, which is remarked; where there is none, a typed centimetre is a centimetre.
    pub(crate) fn on_head(&self, scalp: Option<&Arc<Scalp>>) -> EvalCx<'a> {
        let unit = scalp.map_or(1.0, |scalp| scalp.frame().unit());
        if unit != 1.0 {
            self.remark(format!("lengths are multiplied by {unit:.3} for the size of the head"));
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

    /// Tufts to tufts: each output tuft reads one input tuft and nothing else that varies. As many points as come in are
    /// foreseen; who makes more asks [`Self::may_make`] first.
    pub fn each_tuft<const N: usize>(
        &self,
        curves: &Curves,
        make: impl Fn(&Tuft, &mut Piece) -> Result<[Tuft; N], NodeError> + Sync,
    ) -> Result<[Curves; N], NodeError> {
        self.may_make(&Size::as_many([curves]))?;
        let tufts = curves.tufts();
        let key = |i: usize| KeyBuilder::new("tuft").key(tufts[i].key());
        self.pieces(tufts.len(), key, |i, piece| make(&tufts[i], piece))
    }

    /// One tuft from each curve, all of them of this size.
    pub fn each_curve<const N: usize>(
        &self,
        curves: &Curves,
        size: &Size,
        make: impl Fn(&Tuft, usize, &mut Piece) -> Result<[Tuft; N], NodeError> + Sync,
    ) -> Result<[Curves; N], NodeError> {
        self.may_make(size)?;
        let all: Vec<(&Tuft, usize)> = curves.each().collect();
        let key = |i: usize| {
            let (tuft, curve) = all[i];
            KeyBuilder::new("curve").key(tuft.key()).int(curve as u64)
        };
        self.pieces(all.len(), key, |i, piece| make(all[i].0, all[i].1, piece))
    }

    /// Tufts that read other tufts: `needs` names, by number, the tufts of `sources` that an output reads; they are
    /// handed to `make` in that order. An output is made again only when its own tuft or one of these
    /// changes. As many points as come in are foreseen.
    pub fn each_tuft_with<const N: usize>(
        &self,
        curves: &Curves,
        sources: &Curves,
        needs: impl Fn(usize, &Tuft) -> Vec<u32>,
        make: impl Fn(&Tuft, &[&Tuft], &mut Piece) -> Result<[Tuft; N], NodeError> + Sync,
    ) -> Result<[Curves; N], NodeError> {
        self.may_make(&Size::as_many([curves]))?;
        let tufts = curves.tufts();
        let needed: Vec<Vec<u32>> = tufts.iter().enumerate().map(|(i, t)| needs(i, t)).collect();
        let key = |i: usize| {
            let key = KeyBuilder::new("gather").key(tufts[i].key());
            needed[i].iter().fold(key, |key, n| key.key(sources.tufts()[*n as usize].key()))
        };
        self.pieces(tufts.len(), key, |i, piece| {
            let read: Vec<&Tuft> =
                needed[i].iter().map(|n| &*sources.tufts()[*n as usize]).collect();
            make(&tufts[i], &read, piece)
        })
    }

    /// `n` tufts, all of them of this size, each told by the key of its own item (a stroke, a region of the scalp). The key names
    /// all that the item reads of curves, too.
    pub fn each_item<const N: usize>(
        &self,
        n: usize,
        size: &Size,
        item: impl Fn(usize) -> Key + Sync,
        make: impl Fn(usize, &mut Piece) -> Result<[Tuft; N], NodeError> + Sync,
    ) -> Result<[Curves; N], NodeError> {
        self.may_make(size)?;
        self.pieces(n, |i| KeyBuilder::new("item").key(item(i)), make)
    }

    fn pieces<const N: usize>(
        &self,
        n: usize,
        key: impl Fn(usize) -> KeyBuilder + Sync,
        make: impl Fn(usize, &mut Piece) -> Result<[Tuft; N], NodeError> + Sync,
    ) -> Result<[Curves; N], NodeError> {
        let made: Vec<OnceLock<Result<Arc<Made>, NodeError>>> =
            (0..n).map(|_| OnceLock::new()).collect();
        let node = self.by_place.map_or(self.node, |(node, _)| node);
        // What could not be foreseen is found when it is made: so much is, or not, whatever the order of pieces.
        let most = self.host.room().points.unwrap_or(u64::MAX);
        let (done, points, is_full) =
            (AtomicU32::new(0), AtomicU64::new(0), AtomicBool::new(false));
        self.host.for_each(n, &|i| {
            if points.load(Ordering::Relaxed) <= most && !is_full.load(Ordering::Relaxed) {
                let piece = self.piece(key(i).key(node).finish(), i, &make);
                let tufts = piece.iter().flat_map(|made| made.tufts.iter().flatten());
                let more = tufts.map(|t| t.points().len() as u64).sum();
                let before = points.fetch_add(more, Ordering::Relaxed);
                if before / FEW_POINTS != (before + more) / FEW_POINTS
                    && self.host.room().bytes.is_some_and(|free| free < SPARE)
                {
                    is_full.store(true, Ordering::Relaxed);
                }
                let _ = made[i].set(piece);
            }
            self.host.progress(done.fetch_add(1, Ordering::Relaxed) as usize + 1, n);
        });
        if points.into_inner() > most {
            let said = format!("would make more than {}", millions(most as f64));
            return Err(NodeError::TooLarge(said));
        }
        if is_full.into_inner() {
            return Err(NodeError::failed(
                "there is no memory left for what it makes: ask for less hair, or for fewer points on each",
            ));
        }
        let mut outputs = [const { Vec::new() }; N];
        for made in made {
            let made = made.into_inner().unwrap_or(Err(NodeError::Cancelled))?;
            for (output, tufts) in outputs.iter_mut().zip(&made.tufts) {
                output.extend(tufts.iter().cloned());
            }
            made.troubles.iter().for_each(|trouble| self.log.say(trouble.clone()));
        }
        Ok(outputs.map(Curves::new))
    }

    fn piece<const N: usize>(
        &self,
        key: Key,
        i: usize,
        make: &(impl Fn(usize, &mut Piece) -> Result<[Tuft; N], NodeError> + Sync),
    ) -> Result<Arc<Made>, NodeError> {
        self.check()?;
        let Some((_, sections)) = self.by_place else {
            if let Some(made) = self.host.find(key).and_then(|kept| kept.downcast().ok()) {
                self.log.tufts_reused.fetch_add(1, Ordering::Relaxed);
                return Ok(made);
            }
            let made = Arc::new(self.made(i, make)?);
            self.host.keep(key, made.clone(), made.bytes());
            return Ok(made);
        };
        let known = self.host.find(key).and_then(|kept| kept.downcast::<ByPlace>().ok());
        let known = known.as_deref().map_or(&[][..], |known| &known.0);
        if let Some((_, made)) = known.iter().find(|(read, _)| read.is_same_on(sections)) {
            self.log.tufts_reused.fetch_add(1, Ordering::Relaxed);
            return Ok(made.clone());
        }
        let (made, read) = traced(sections, || self.made(i, make));
        let made = Arc::new(made?);
        let before = known.iter().take(WAYS - 1);
        let before = before.map(|(read, made)| (read.clone(), made.clone()));
        let kept: Vec<_> = std::iter::once((read, made.clone())).chain(before).collect();
        let bytes = kept.iter().map(|(read, made)| read.bytes() + made.bytes()).sum();
        self.host.keep(key, Arc::new(ByPlace(kept)), bytes);
        Ok(made)
    }

    fn made<const N: usize>(
        &self,
        i: usize,
        make: &(impl Fn(usize, &mut Piece) -> Result<[Tuft; N], NodeError> + Sync),
    ) -> Result<Made, NodeError> {
        self.log.tufts_run.fetch_add(1, Ordering::Relaxed);
        let mut piece = Piece { host: self.host, since: 0, troubles: BTreeMap::new() };
        let tufts: Vec<Vec<Arc<Tuft>>> =
            make(i, &mut piece)?.into_iter().map(Tuft::split).collect();
        let troubles = piece
            .troubles
            .into_iter()
            .map(|(text, (count, curves))| Message { warning: true, text, count, curves })
            .collect();
        Ok(Made { tufts, troubles })
    }

    /// A list replayed on a state. The states after every item are kept, so that adding to the end runs one step
    /// and changing an item runs from there on.
    pub fn fold<S: Send + Sync + 'static, I>(
        &self,
        start: (Key, impl FnOnce() -> Result<S, NodeError>),
        items: &[(Key, I)],
        step: impl Fn(&S, &I) -> Result<S, NodeError>,
        bytes: impl Fn(&S) -> usize,
    ) -> Result<Arc<S>, NodeError> {
        let mut keys = vec![KeyBuilder::new("fold").key(self.node).key(start.0).finish()];
        for (key, _) in items {
            let last = keys[keys.len() - 1];
            keys.push(KeyBuilder::new("fold").key(last).key(*key).finish());
        }
        let known = (0..keys.len())
            .rev()
            .find_map(|i| Some((i, self.host.find(keys[i])?.downcast::<S>().ok()?)));
        let (mut done, mut state) = match known {
            Some(known) => known,
            None => {
                let state = Arc::new(start.1()?);
                self.host.keep(keys[0], state.clone(), bytes(&state));
                (0, state)
            }
        };
        self.log.tufts_reused.fetch_add(done as u32, Ordering::Relaxed);
        while done < items.len() {
            self.check()?;
            state = Arc::new(step(&state, &items[done].1)?);
            self.log.tufts_run.fetch_add(1, Ordering::Relaxed);
            done += 1;
            self.host.keep(keys[done], state.clone(), bytes(&state));
        }
        Ok(state)
    }

    /// Something derived from `key` alone that several evaluations may share, such as a tree over roots.
    pub fn memo<T: Send + Sync + 'static>(
        &self,
        key: Key,
        make: impl FnOnce() -> (T, usize),
    ) -> Arc<T> {
        let key = KeyBuilder::new("memo").key(key).finish();
        if let Some(found) = self.host.find(key).and_then(|kept| kept.downcast::<T>().ok()) {
            return found;
        }
        let (value, bytes) = make();
        let value = Arc::new(value);
        self.host.keep(key, value.clone(), bytes);
        value
    }
}

/// A host without threads or memory, for tests of single nodes and for tools.
#[derive(Debug, Default)]
pub struct PlainHost;

impl Host for PlainHost {
    fn for_each(&self, n: usize, f: &(dyn Fn(usize) + Sync)) {
        (0..n).for_each(f);
    }
    fn cancelled(&self) -> bool {
        false
    }
    fn find(&self, _: Key) -> Option<Kept> {
        None
    }
    fn keep(&self, _: Key, _: Kept, _: usize) {}
    fn progress(&self, _: usize, _: usize) {}
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::define::Value;
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
        let said: Vec<String> = log.messages().iter().map(ToString::to_string).collect();
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
        let most = int("most_points", 1000);
        let set = vec![hair(9), int("count", 65_536), int("points", 1000), most];
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
    fn preview_makes_a_tenth_but_never_under_sixteen() {
        let (log, host) = (Log::default(), PlainHost);
        let cx = |quality| EvalCx::new(0, quality, Key(1), &host, &log);
        let thinned = |n| cx(Quality::Preview).thinned(n);
        assert_eq!([10, 100, 1000].map(thinned), [10, 16, 100]);
        assert_eq!(cx(Quality::Final).thinned(1000), 1000);
    }
}
