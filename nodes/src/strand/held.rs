//! What holds hair while it is bent: its root, its length, the skin and the partings. The one way in which modifiers change hair.
//!
//! Guarantees: roots, ids, attributes and the number of points stay; a hair that nothing bends keeps its bits, and a tuft of such
//! hairs is the tuft that came in; where lengths are kept, every piece from point to point is as long as it was, but where the skin
//! pushes; on a scalp no moved point ends deeper in the skin than the hair's `allow_depth`; as far as a hair keeps to its section it
//! still does, and no hair leads over a parting that did not (rather it stays as it was, which is told). Not promised: anything
//! for curves that are no curves; they pass through.

use super::hair::Hair;
use crate::data::attributes::ALLOW_DEPTH;
use crate::data::curves::Tuft;
use crate::data::patience::Patience;
use crate::data::scalp::{Scalp, Skin};
use crate::data::section_guard::Home;
use crate::define::NodeError;
use crate::eval::Piece;
use glam::Vec3;

/// So many looks the hair of one tuft may take to find its way out of the skin, and so many more with each of its points.
const LOOKS: u64 = 1000;
const LOOKS_A_POINT: f32 = 0.25;

const OVER: &str = "a hair that would be led over a parting was left as it was";
const FAR: &str = "a hair that would be moved beyond all numbers was left as it was";

/// What hair is held by.
#[derive(Clone, Copy)]
pub(super) struct Held<'a> {
    pub scalp: Option<&'a Scalp>,
    pub keep_length: bool,
}

impl Held<'_> {
    /// The tuft with hairs as `bend` leaves them: given a hair and its number, it moves the points, all of them there as they are.
    pub(super) fn bend(
        &self,
        tuft: &Tuft,
        piece: &mut Piece,
        mut bend: impl FnMut(&Hair, usize, &mut [Vec3]),
    ) -> Result<Tuft, NodeError> {
        let patience = Patience::new(LOOKS);
        let skin = self.scalp.map(|scalp| scalp.skin().within(&patience));
        let depth = tuft.view(ALLOW_DEPTH);
        let (mut hair, mut new) = (Hair::default(), vec![]);
        let mut edit = None;
        for i in 0..tuft.len() {
            piece.tick()?;
            let (old, range) = (tuft.curve(i), tuft.range(i));
            // Grows with the hair, so that more of it changes none before it.
            patience.add((LOOKS_A_POINT * old.len() as f32) as u64);
            if !hair.read(old) {
                continue;
            }
            new.clear();
            new.extend_from_slice(old);
            bend(&hair, i, &mut new);
            new[0] = old[0];
            if new == old {
                continue;
            }
            let depth = |k: usize| depth.at(i, range.start + k);
            match self.settle(old, &mut new, depth, skin.as_ref()) {
                Err(why) => piece.trouble(tuft.id(i), why),
                Ok(()) => {
                    let edit = edit.get_or_insert_with(|| tuft.edit());
                    edit.points_mut()[range].copy_from_slice(&new);
                }
            }
        }
        Ok(edit.map_or_else(|| tuft.clone(), |edit| edit.build()))
    }

    /// Sets a hair that was bent from `old` to `new` where it may be; why not, where it may be nowhere.
    pub(super) fn settle(
        &self,
        old: &[Vec3],
        new: &mut [Vec3],
        depth: impl Fn(usize) -> f32,
        skin: Option<&Skin>,
    ) -> Result<(), &'static str> {
        if self.keep_length {
            keep_lengths(old, new);
        }
        if !new.iter().all(|p| p.is_finite()) {
            return Err(FAR);
        }
        let (Some(skin), Some(scalp)) = (skin, self.scalp) else { return Ok(()) };
        // What was not moved lies as it lay.
        let stays: Vec<bool> = old.iter().zip(&*new).map(|(old, new)| old == new).collect();
        let cleared = skin.clear(new, |k| (!stays[k]).then(|| depth(k)));
        if cleared && self.keep_length {
            keep_lengths_outside(old, new, skin, &depth);
        }
        if let Some(home) = scalp.home(old[0]) {
            self.keep_home(&home, old, new, |p, k| skin.push_out(p, depth(k)).0);
            if home.passes(new) && !home.passes(old) {
                return Err(OVER);
            }
        }
        if new.iter().all(|p| p.is_finite()) { Ok(()) } else { Err(FAR) }
    }

    /// Sets what a hair has grown on beyond its old points where it may be; why not, where it may be nowhere.
    pub(super) fn settle_beyond(
        &self,
        old: &[Vec3],
        new: &mut [Vec3],
        depth: impl Fn(usize) -> f32,
        skin: Option<&Skin>,
    ) -> Result<(), &'static str> {
        if !new.iter().all(|p| p.is_finite()) {
            return Err(FAR);
        }
        let (Some(skin), Some(scalp)) = (skin, self.scalp) else { return Ok(()) };
        skin.clear(new, |k| (k >= old.len()).then(|| depth(k)));
        let passes = |home: Home| home.passes(new) && !home.passes(old);
        if scalp.home(old[0]).is_some_and(passes) { Err(OVER) } else { Ok(()) }
    }

    /// Keeps a hair in its section so far along it as it was there before.
    fn keep_home(
        &self,
        home: &Home,
        old: &[Vec3],
        new: &mut [Vec3],
        out: impl Fn(Vec3, usize) -> Vec3,
    ) {
        let Some(root) = self.scalp.and_then(|scalp| scalp.skin().closest(old[0])) else { return };
        let mut near = root.triangle;
        for k in (1..old.len()).take_while(|k| home.holds(old[*k])) {
            if old[k] == new[k] {
                continue;
            }
            // Straight to the side may be into the head.
            if let Some(kept) = home.kept(new[k], &mut near).filter(|kept| *kept != new[k]) {
                new[k] = out(kept, k);
            }
        }
    }
}

/// Gives every piece of a bent hair the length that it had, from the root on; each runs the way it was bent to.
fn keep_lengths(old: &[Vec3], new: &mut [Vec3]) {
    let mut before = new[0];
    for k in 1..old.len() {
        let wanted = new[k];
        let was = old[k] - old[k - 1];
        // What lies where it lay has its length, to the last bit.
        if wanted != old[k] || new[k - 1] != old[k - 1] {
            let way = (wanted - before).normalize_or(was.normalize_or_zero());
            new[k] = new[k - 1] + way * was.length();
        }
        before = wanted;
    }
}

/// The same for a hair that the skin has pushed, as far as that leads no point back into the skin.
fn keep_lengths_outside(
    old: &[Vec3],
    new: &mut [Vec3],
    skin: &Skin,
    depth: &impl Fn(usize) -> f32,
) {
    for k in 1..old.len() {
        if new[k] == old[k] && new[k - 1] == old[k - 1] {
            continue;
        }
        let was = old[k] - old[k - 1];
        let way = (new[k] - new[k - 1]).normalize_or(was.normalize_or_zero());
        let again = new[k - 1] + way * was.length();
        if !skin.push_out(again, depth(k)).1 {
            new[k] = again;
        }
    }
}
