//! Hair in pieces: each made by itself, on any thread, kept under the key of what it reads, and made again when that changes.
//!
//! Guarantees: tufts come in the order of their pieces; no piece is run whose key is known; what could not be foreseen to be too much
//! ends when it is, whatever the order. Not promised: anything for a piece that reads what its key does not tell.

use super::log::MOST_NAMED;
use super::traced::ByPlace;
use super::{EvalCx, FEW_POINTS, Host, Message, SPARE, Size, TracedScalp, millions};
use crate::data::curves::{Curves, Tuft};
use crate::data::route::bundle::{Bend, Tell, told};
use crate::data::route::{Policy, Route};
use crate::data::scalp::Scalp;
use crate::data::sections::Sections;
use crate::error::NodeError;
use crate::maths::hash::{Key, KeyBuilder};
use std::collections::BTreeMap;
use std::sync::atomic::{AtomicBool, AtomicU32, AtomicU64, Ordering};
use std::sync::{Arc, OnceLock};

/// One piece of work while it runs.
pub struct Piece<'a> {
    host: &'a dyn Host,
    scalp: Option<&'a Scalp>,
    since: u32,
    /// By whether it is a warning, and text.
    said: BTreeMap<(bool, String), (u32, Vec<u64>)>,
}

impl<'a> Piece<'a> {
    /// The scalp of a node that runs by place, as this piece sees it: what it asks of the sections is noted. No other piece may be given
    /// what came of it.
    pub fn scalp(&self) -> Option<&'a Scalp> {
        self.scalp
    }
    /// The way of hair on that scalp.
    pub(crate) fn route(&self, policy: Policy) -> Route<'a> {
        Route::new(self.scalp, policy)
    }
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
        self.say(true, curve, text.to_string());
    }
    /// Remarks on one curve that is as it should be. The text is the same for all curves that it is said of.
    pub fn remark(&mut self, curve: u64, text: impl std::fmt::Display) {
        self.say(false, curve, text.to_string());
    }
    fn say(&mut self, warning: bool, curve: u64, text: String) {
        let (count, curves) = self.said.entry((warning, text)).or_default();
        *count += 1;
        if curves.len() < MOST_NAMED {
            curves.push(curve);
        }
    }
    /// The tuft with its hairs bent by `bend` as far as they may be. Hair that may not be moved is left as it was and reported.
    pub(crate) fn bend(
        &mut self,
        route: &Route,
        tuft: &Tuft,
        bend: &mut impl Bend,
    ) -> Result<Tuft, NodeError> {
        let (bent, left) = route.bent(tuft, bend, || self.tick())?;
        left.into_iter().for_each(|(i, why)| self.trouble(tuft.id(i), why));
        Ok(bent)
    }
    /// A number for each point of a tuft.
    pub(crate) fn tell(
        &mut self,
        tuft: &Tuft,
        tell: &mut impl Tell,
    ) -> Result<Vec<f32>, NodeError> {
        told(tuft, tell, || self.tick())
    }
}

/// Makes the tufts of a piece, one for each output.
type Make<'m> = dyn Fn(usize, &mut Piece) -> Result<Vec<Tuft>, NodeError> + Sync + 'm;

struct Made {
    tufts: Vec<Vec<Arc<Tuft>>>,
    said: Vec<Message>,
}

impl Made {
    fn bytes(&self) -> usize {
        self.tufts.iter().flatten().map(|t| t.bytes()).sum::<usize>() + 256
    }
}

impl EvalCx<'_> {
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
        let make = |i: usize, piece: &mut Piece| make(i, piece).map(Vec::from);
        let mut outputs = self.all_pieces(n, N, &key, &make)?.into_iter();
        Ok([(); N].map(|()| outputs.next().unwrap_or_default()))
    }

    // (Below, what makes a piece is called through a pointer: one copy of this code serves all nodes.)
    fn all_pieces(
        &self,
        n: usize,
        outputs: usize,
        key: &(dyn Fn(usize) -> KeyBuilder + Sync),
        make: &Make,
    ) -> Result<Vec<Curves>, NodeError> {
        let made: Vec<OnceLock<Result<Arc<Made>, NodeError>>> =
            (0..n).map(|_| OnceLock::new()).collect();
        let node = self.traced().map_or(self.node, |(node, _)| node);
        // What could not be foreseen is found when it is made: so much is, or not, whatever the order of pieces.
        let most = self.host.room().points.unwrap_or(u64::MAX);
        let (done, points, is_full) =
            (AtomicU32::new(0), AtomicU64::new(0), AtomicBool::new(false));
        self.host.for_each(n, &|i| {
            if points.load(Ordering::Relaxed) <= most && !is_full.load(Ordering::Relaxed) {
                let piece = self.piece(key(i).key(node).finish(), i, make);
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
        let mut outputs = vec![vec![]; outputs];
        for made in made {
            let made = made.into_inner().unwrap_or(Err(NodeError::Cancelled))?;
            for (output, tufts) in outputs.iter_mut().zip(&made.tufts) {
                output.extend(tufts.iter().cloned());
            }
            made.said.iter().for_each(|message| self.log.say(message.clone()));
        }
        Ok(outputs.into_iter().map(Curves::new).collect())
    }

    fn piece(&self, key: Key, i: usize, make: &Make) -> Result<Arc<Made>, NodeError> {
        self.check()?;
        let Some((_, sections)) = self.traced() else {
            if let Some(made) = self.host.find(key).and_then(|kept| kept.downcast().ok()) {
                self.log.tufts_reused.fetch_add(1, Ordering::Relaxed);
                return Ok(made);
            }
            let made = Arc::new(self.made(i, self.scalp.map(TracedScalp::seen), make)?);
            self.host.keep(key, made.clone(), made.bytes());
            return Ok(made);
        };
        let known = self.host.find(key).and_then(|kept| kept.downcast::<ByPlace<Made>>().ok());
        if let Some(made) = known.as_ref().and_then(|known| known.on(sections)) {
            self.log.tufts_reused.fetch_add(1, Ordering::Relaxed);
            return Ok(made);
        }
        let scalp = self.scalp.map(TracedScalp::noting);
        let made = Arc::new(self.made(i, scalp.as_ref(), make)?);
        let read = scalp.as_ref().and_then(Scalp::sections).map(Sections::footprint);
        if let Some(read) = read {
            let kept = ByPlace::with(known.as_deref(), read, made.clone());
            let bytes = kept.bytes(Made::bytes);
            self.host.keep(key, Arc::new(kept), bytes);
        }
        Ok(made)
    }

    fn made(&self, i: usize, scalp: Option<&Scalp>, make: &Make) -> Result<Made, NodeError> {
        self.log.tufts_run.fetch_add(1, Ordering::Relaxed);
        let mut piece = Piece { host: self.host, scalp, since: 0, said: BTreeMap::new() };
        let tufts: Vec<Vec<Arc<Tuft>>> =
            make(i, &mut piece)?.into_iter().map(Tuft::split).collect();
        let said = piece.said.into_iter().map(|((warning, text), (count, curves))| Message {
            warning,
            text,
            count,
            curves,
        });
        Ok(Made { tufts, said: said.collect() })
    }
}
