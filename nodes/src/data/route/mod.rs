//! The one way in which hair that exists is moved: from where a node wishes its points to where they may be.
//!
//! A node that moves hair says where it wishes each point ([`Piece::bend`]), and no more: [`Route`] keeps the hair's root and its
//! lengths, sets it out of the skin and keeps it in its section, or leaves it as it was and says why. Nothing else can write other
//! points into a tuft. Who makes hair lays its points by `makers.rs`; that its hair obeys is a test over all nodes.
//!
//! Guarantees: roots, ids, attributes and the number of points stay; a hair that nothing moves keeps its bits, and a tuft of such
//! hairs is the tuft that came in; where lengths are kept, every piece from point to point is as long as it was, but where the skin
//! pushes; on a scalp that is not rough no moved point ends deeper in the skin than the hair's `allow_depth`; as far as a hair keeps to
//! its section it still does, and none leads over a parting before it did (rather it stays as it was, which is told). What a way out
//! may take is bounded, and grows with the hair, so that more of it changes none before it. Not promised: anything for curves that are
//! no curves, which pass through; nor for a new tuft that is built of moved points, which is the work of a maker (`makers.rs`).
//!
//! [`Piece::bend`]: crate::eval::Piece::bend

use super::attributes::{ALLOW_DEPTH, ROOT_TRIANGLE};
use super::curves::{AttributeView, Tuft, TuftBuilder};
use super::patience::Patience;
use super::scalp::Scalp;
use super::skin::Skin;
use bundle::{Bend, Wished, wished};
use clearance::Clearance;
use drawn::DIP;
use glam::Vec3;
use section_guard::Home;

pub(crate) mod bundle;
mod clearance;
pub(crate) mod drawn;
pub(crate) mod makers;
mod push;
pub(crate) mod section_guard;
mod shortest_path;
pub(crate) mod skin_clear;

/// So many looks the hair of one tuft may take to find its way out of the skin, and so many more with each of its points.
const LOOKS: u64 = 1000;
const LOOKS_A_POINT: f32 = 0.25;

/// Looks that a hair of so many points adds.
fn looks(points: usize) -> u64 {
    (LOOKS_A_POINT * points as f32) as u64
}

/// So deep (cm) a point may lie for what is rounded.
const ROUNDED: f32 = 1e-3;

/// Why a hair was left as it was.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub(crate) enum Left {
    /// It keeps to its section no other way.
    #[error("a hair that would be led over a parting was left as it was")]
    Over,
    /// There is no way out of the skin that is short enough to be found.
    #[error("a hair that would be led into the skin, with no way out, was left as it was")]
    In,
    /// Its points were wished where no number tells.
    #[error("a hair that would be moved beyond all numbers was left as it was")]
    Far,
}

/// What becomes of the pieces between the points of a hair.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum Lengths {
    /// Each keeps its length and runs the way it was bent to: hair that is bent much ends elsewhere than wished.
    #[default]
    Kept,
    /// Each keeps its length and runs towards where its end was wished: hair ends as near to the wish as it can.
    KeptTowards,
    /// They come to be as long as wished.
    Free,
}

/// What hair is held by beside its root and the skin.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Policy {
    /// What becomes of its lengths.
    pub lengths: Lengths,
    /// Whether it keeps to its section; else it lies where it is wished, as hair does that is placed by hand.
    pub own_section: bool,
}

impl Policy {
    /// As an input says that is called *keep length*.
    pub(crate) fn keep_length(keep: bool) -> Self {
        let lengths = if keep { Lengths::Kept } else { Lengths::Free };
        Self { lengths, ..Self::default() }
    }
}

impl Default for Policy {
    fn default() -> Self {
        Self { lengths: Lengths::Kept, own_section: true }
    }
}

/// The way of hair on one head, or of hair that has none: then root and lengths alone are kept.
#[derive(Clone, Copy)]
pub(crate) struct Route<'a> {
    scalp: Option<&'a Scalp>,
    skin: Option<Skin<'a>>,
    policy: Policy,
}

impl<'a> Route<'a> {
    /// On this head, if any.
    pub(crate) fn new(scalp: Option<&'a Scalp>, policy: Policy) -> Self {
        Self { scalp, skin: scalp.map(Scalp::skin), policy }
    }

    /// Begins to move hairs of a tuft.
    pub(crate) fn moved<'t>(&'t self, tuft: &'t Tuft) -> Moved<'t> {
        let depth = tuft.view(ALLOW_DEPTH);
        Moved { route: self, tuft, depth, patience: Patience::new(LOOKS), asked: 0, edit: None }
    }

    /// Sets a hair that was moved from `old` to `new` where it may be; `root_triangle` is the value of its attribute, `depth` (cm) says how
    /// deep each point may lie.
    pub(crate) fn settle(
        &self,
        old: &[Vec3],
        new: &mut [Vec3],
        root_triangle: i32,
        depth: impl Fn(usize) -> f32,
    ) -> Result<(), Left> {
        if self.policy.lengths == Lengths::Kept {
            keep_lengths(old, new);
        }
        if !new.iter().all(|p| p.is_finite()) {
            return Err(Left::Far);
        }
        self.settle_wished(old, new, root_triangle, depth)
    }

    /// [`Self::settle`] for finite points whose segments already have their lengths, if the policy is [`Lengths::Kept`].
    fn settle_wished(
        &self,
        old: &[Vec3],
        new: &mut [Vec3],
        root_triangle: i32,
        depth: impl Fn(usize) -> f32,
    ) -> Result<(), Left> {
        if self.policy.lengths == Lengths::KeptTowards {
            keep_lengths_towards(old, new, self.skin.as_ref(), &depth);
        }
        let (Some(skin), Some(scalp)) = (self.skin, self.scalp) else { return Ok(()) };
        // What was not moved lies as it lay.
        let stays: Vec<bool> = old.iter().zip(&*new).map(|(old, new)| old == new).collect();
        let view = skin.view_from(old[0], root_triangle);
        let mut clearance = Clearance::new(&skin, new.len(), |_| 0.0).seen(view);
        match self.policy.lengths {
            Lengths::KeptTowards => {}
            lengths => {
                let is_off = |points: &[Vec3], k: usize| clearance.of_point(points, k, -depth(k));
                let cleared = skin.clear_where(new, |k| (!stays[k]).then(|| depth(k)), is_off);
                if cleared && lengths == Lengths::Kept {
                    keep_lengths_outside(old, new, &skin, &depth);
                }
                if cleared {
                    clearance = Clearance::new(&skin, new.len(), |_| 0.0).seen(view);
                }
            }
        }
        let home = scalp.home(old[0]).filter(|_| self.policy.own_section);
        if let Some(home) = &home {
            keep_home(home, &skin, old, new, &mut clearance, &depth);
        }
        settle_drawn((&skin, home.as_ref()), old, new, &clearance, |k| k > 0 && !stays[k], &depth)
    }

    /// The tuft with its hairs bent by `bend` as far as they may be, and the hairs that were left as they were, with the reason. Calls
    /// `tick` once per hair.
    pub(crate) fn bent<E>(
        &self,
        tuft: &Tuft,
        bend: &mut impl Bend,
        tick: impl FnMut() -> Result<(), E>,
    ) -> Result<(Tuft, Vec<(usize, Left)>), E> {
        let (mut points, became) = wished(tuft, self.policy.lengths, bend, tick)?;
        let (mut left, mut any) = (vec![], false);
        let (depth, patience) = (tuft.view(ALLOW_DEPTH), Patience::new(LOOKS));
        let root_triangle = tuft.view(ROOT_TRIANGLE);
        let skin = self.skin.map(|skin| skin.within(&patience));
        let route = Route { skin, ..*self };
        for (i, became) in became.into_iter().enumerate() {
            let range = tuft.range(i);
            patience.add(looks(range.len()));
            let (old, new) = (tuft.curve(i), &mut points[range.clone()]);
            let settled = match became {
                Wished::Stays => continue,
                Wished::Far => Err(Left::Far),
                Wished::Moved => {
                    let root = root_triangle.at(i, range.start);
                    route.settle_wished(old, new, root, |k| depth.at(i, range.start + k))
                }
            };
            match settled {
                Ok(()) => any = true,
                Err(why) => {
                    new.copy_from_slice(old);
                    left.push((i, why));
                }
            }
        }
        let out = if any { tuft.edit().with_points(points).build() } else { tuft.clone() };
        Ok((out, left))
    }

    /// Sets what a hair has grown on beyond its old points where it may be.
    pub(crate) fn settle_beyond(
        &self,
        old: &[Vec3],
        new: &mut [Vec3],
        depth: impl Fn(usize) -> f32,
    ) -> Result<(), Left> {
        if !new.iter().all(|p| p.is_finite()) {
            return Err(Left::Far);
        }
        let Some(skin) = self.skin else { return Ok(()) };
        skin.clear(new, |k| (k >= old.len()).then(|| depth(k)));
        let home = self.scalp.and_then(|scalp| scalp.home(old[0]));
        let home = home.filter(|_| self.policy.own_section);
        let clearance = Clearance::new(&skin, new.len(), |_| 0.0);
        settle_drawn((&skin, home.as_ref()), old, new, &clearance, |k| k >= old.len(), &depth)
    }

    /// A new point of a hair that lies as it lay: between two others it may dip deeper into the skin than `depth` (cm).
    pub(crate) fn between(&self, p: Vec3, depth: f32) -> Vec3 {
        self.skin.map_or(p, |skin| skin.lift_exactly(p, -depth).0)
    }
}

/// Sets the curve that is drawn through a moved hair out of the skin, as far as points of it `may` move, and says why the hair may not
/// lie so, if it may not.
fn settle_drawn(
    (skin, home): (&Skin, Option<&Home>),
    old: &[Vec3],
    new: &mut [Vec3],
    clearance: &Clearance,
    may: impl Fn(usize) -> bool,
    depth: impl Fn(usize) -> f32,
) -> Result<(), Left> {
    let moved = |k: usize| may(k) || may(k + 1);
    let is_off = |points: &[Vec3], k: usize| clearance.of_span(points, k, 0.0);
    let cleared = skin.clear_drawn_where(new, &may, &depth, is_off);
    // Bounds no longer hold for points that were moved.
    let unknown = cleared.then(Clearance::unknown);
    let clearance = unknown.as_ref().unwrap_or(clearance);
    if let Some(home) = home {
        leads_over(home, old, new, clearance)?;
    }
    is_out(skin, old, new, clearance, &depth)?;
    // What dipped before may still.
    let worst = |points: &[Vec3], asked: &dyn Fn(usize) -> bool| {
        let mut worst = 0.0f32;
        skin.dips(points, asked, &depth, |dip| worst = worst.max(dip.excess));
        worst
    };
    if cleared {
        let dips = worst(new, &moved);
        if dips > 0.0 && dips > worst(old, &|_| true) + DIP {
            return Err(Left::In);
        }
    }
    Ok(())
}

/// A tuft whose hairs are moved, one after the other.
pub(crate) struct Moved<'a> {
    route: &'a Route<'a>,
    tuft: &'a Tuft,
    depth: AttributeView<'a, f32>,
    patience: Patience,
    /// For so many hairs there is patience.
    asked: usize,
    edit: Option<TuftBuilder>,
}

impl Moved<'_> {
    /// Moves hair `i` to where it may be of what is wished, all of its points; they are then where they came to be. Hairs come in
    /// their order.
    pub(crate) fn hair(&mut self, i: usize, wish: &mut [Vec3]) -> Result<(), Left> {
        for k in self.asked..=i {
            self.patience.add(looks(self.tuft.curve(k).len()));
        }
        self.asked = i + 1;
        let (old, range) = (self.tuft.curve(i), self.tuft.range(i));
        if let (Some(to), Some(root)) = (wish.first_mut(), old.first()) {
            *to = *root;
        }
        if wish == old {
            return Ok(());
        }
        let skin = self.route.skin.map(|skin| skin.within(&self.patience));
        let route = Route { skin, ..*self.route };
        let root = self.tuft.view(ROOT_TRIANGLE).at(i, range.start);
        route.settle(old, wish, root, |k| self.depth.at(i, range.start + k))?;
        let edit = self.edit.get_or_insert_with(|| self.tuft.edit());
        edit.points_mut()[range].copy_from_slice(wish);
        Ok(())
    }

    /// The tuft with what was moved, for more to be changed; none where nothing was.
    pub(crate) fn done(self) -> Option<TuftBuilder> {
        self.edit
    }
}

/// Hair that is carried as a whole, roots and all, as objects are: neither skin nor section holds it, and whoever carries it binds its
/// roots anew.
pub(crate) fn carried(tuft: &Tuft, place: impl Fn(Vec3) -> Vec3) -> TuftBuilder {
    let mut out = tuft.edit();
    out.points_mut().iter_mut().for_each(|p| *p = place(*p));
    out
}

/// Fails where a point that was moved lies deeper in the skin than it may, or nowhere: in a crease, past all patience, what is put out of
/// one side ends in the other. A rough mesh is not asked: there it may have no inside.
fn is_out(
    skin: &Skin,
    old: &[Vec3],
    new: &[Vec3],
    clearance: &Clearance,
    depth: impl Fn(usize) -> f32,
) -> Result<(), Left> {
    if !new.iter().all(|p| p.is_finite()) {
        return Err(Left::Far);
    }
    let is_in = |k: usize| {
        !clearance.of_point(new, k, 0.0)
            && !skin.stands_off(new[k], 0.0)
            && skin.distance(new[k]) < -depth(k).max(0.0) - ROUNDED
    };
    match !skin.is_rough() && (1..new.len()).any(|k| old.get(k) != Some(&new[k]) && is_in(k)) {
        true => Err(Left::In),
        false => Ok(()),
    }
}

/// Fails where a hair leads over a parting before it did: so far as it kept off them it still does.
fn leads_over(home: &Home, old: &[Vec3], new: &[Vec3], clearance: &Clearance) -> Result<(), Left> {
    let near = clearance.near(new, home.over_lines());
    // The point after the last near one shapes the curve before it.
    if home.is_off_lines(&new[..new.len().min(near + 1)]) || !home.passes_before(new, near) {
        return Ok(());
    }
    let first = (1..old.len()).find(|k| home.passes_before(old, k + 1));
    if home.passes_before(new, first.unwrap_or(new.len())) { Err(Left::Over) } else { Ok(()) }
}

/// Keeps a hair in its section so far along it as it was there before.
fn keep_home(
    home: &Home,
    skin: &Skin,
    old: &[Vec3],
    new: &mut [Vec3],
    clearance: &mut Clearance,
    depth: impl Fn(usize) -> f32,
) {
    let (mut near, mut held) = (None, 0);
    for k in 1..new.len() {
        if old[k] == new[k] || clearance.of_point(new, k, home.free()) {
            continue;
        }
        if near.is_none() {
            near = skin.closest(old[0]).map(|root| root.triangle);
        }
        let Some(near) = &mut near else { return };
        while held < k && home.holds(old[held + 1]) {
            held += 1;
        }
        if held < k {
            return;
        }
        // Straight to the side may be into the head.
        let kept = home.keep(new[k], near, |kept| skin.push_out(kept, depth(k)).0);
        if kept != new[k] {
            new[k] = kept;
            clearance.forget(k);
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

/// Gives every piece the length that it had, from the root on, towards where its end was wished, each set out of the skin as it comes.
fn keep_lengths_towards(
    old: &[Vec3],
    new: &mut [Vec3],
    skin: Option<&Skin>,
    depth: &impl Fn(usize) -> f32,
) {
    for k in 1..old.len() {
        let length = old[k].distance(old[k - 1]);
        let before = new[k - 1];
        let straight = (old[k] - old[k - 1]).normalize_or_zero();
        let put = |p: Vec3| before + (p - before).normalize_or(straight) * length;
        let mut p = put(new[k]);
        if let Some((skin, (out, true))) = skin.map(|skin| (skin, skin.push_out(p, depth(k)))) {
            // On the skin first; the length once more as far as it stays out.
            let again = put(out);
            p = if skin.push_out(again, depth(k)).1 { out } else { again };
        }
        new[k] = p;
    }
}
