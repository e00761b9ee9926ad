//! Pieces that run by place: kept under a key without partings, with what each read of them.
//!
//! Guarantees: what comes of partings reaches a node whose scalp is a [`TracedScalp`] in its pieces alone, where it is noted
//! ([`super::Piece::scalp`]), and by fields; those that may read sections, which are masks, keep a node from running by place. So a piece
//! is taken again only where it would come out the same. Not promised: anything where one piece hands to another what it read.

use super::EvalCx;
use crate::data::read_set::Footprint;
use crate::data::scalp::Scalp;
use crate::data::sections::Sections;
use crate::maths::hash::Key;
use std::sync::Arc;

/// A scalp as a node holds it whose pieces run by place.
#[derive(Clone, Debug)]
pub struct TracedScalp {
    scalp: Arc<Scalp>,
    head: Arc<Scalp>,
}

impl TracedScalp {
    /// This scalp, for a node that reads its sections in pieces alone.
    pub fn new(scalp: Arc<Scalp>) -> Self {
        let head = match scalp.sections() {
            Some(_) => scalp.unparted().into(),
            None => scalp.clone(),
        };
        Self { scalp, head }
    }
    /// The head without partings, for what pieces share.
    pub fn head(&self) -> &Scalp {
        &self.head
    }
    /// With partings, for [`crate::define::FieldInput::on_traced`], and for what is made before pieces run and enters their keys.
    pub(crate) fn whole(&self) -> &Scalp {
        &self.scalp
    }
    /// As a piece sees it that is kept under a key with partings.
    pub(super) fn seen(&self) -> &Scalp {
        &self.scalp
    }
    /// As one piece sees it that runs by place.
    pub(super) fn noting(&self) -> Scalp {
        self.scalp.noting()
    }
}

impl EvalCx<'_> {
    /// The key of pieces that run by place, and the sections that they are of; none where they do not.
    pub(super) fn traced(&self) -> Option<(Key, &Sections)> {
        self.node_untraced.zip(self.scalp?.scalp.sections())
    }
}

/// A piece by place: what was made last, each with what it read of the sections.
pub(super) struct ByPlace<T>(Vec<(Footprint, Arc<T>)>);

/// For how many ways in which a scalp was parted a piece is kept: back and forth.
const WAYS: usize = 2;

impl<T> ByPlace<T> {
    /// What was made where sections said the same, wherever it read them.
    pub(super) fn on(&self, sections: &Sections) -> Option<Arc<T>> {
        self.0.iter().find(|(read, _)| read.is_same_on(sections)).map(|(_, made)| made.clone())
    }
    /// Something newly made, with what was known before.
    pub(super) fn with(before: Option<&Self>, read: Footprint, made: Arc<T>) -> Self {
        let before = before.into_iter().flat_map(|known| &known.0).take(WAYS - 1).cloned();
        Self(std::iter::once((read, made)).chain(before).collect())
    }
    /// Bytes held, where each that was made holds so many.
    pub(super) fn bytes(&self, each: impl Fn(&T) -> usize) -> usize {
        self.0.iter().map(|(read, made)| read.bytes() + each(made)).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::attributes::{Domain, ID, ROLL};
    use crate::data::curves::{Curves, TuftBuilder};
    use crate::data::scalp::tests::shared_ball;
    use crate::data::sections::{Parting, Sections};
    use crate::eval::{Log, Piece, Quality};
    use crate::testing::Memory;
    use glam::Vec3;

    /// The ball, parted by lines over it at these places to the side.
    fn parted(sides: &[f32]) -> TracedScalp {
        let ball = shared_ball();
        let line = |(id, x): (u64, &f32)| {
            let on_ball = |k: i32| ball.closest_root(Vec3::new(*x, 8.0, 0.2 * k as f32));
            let points = (-30..=30).filter_map(on_ball).map(|root| root.point);
            Parting { id, points: points.collect(), half_width: 0.08, of_pattern: false }
        };
        let lines = (1..).zip(sides).map(line).collect();
        TracedScalp::new(ball.parted(Sections::new(&ball, lines, &[]).0).into())
    }

    /// Six hairs, one a tuft, side by side.
    fn hair() -> Curves {
        let tuft = |i: u16| {
            let root = Vec3::new(2.0 * f32::from(i) - 5.0, 7.0, 0.0);
            let root = shared_ball().closest_root(root).unwrap().point;
            let mut b = TuftBuilder::new();
            b.push_curve(&[root, root * 1.3]);
            b.set(ID, Domain::Curve, vec![u64::from(i) + 1]);
            Arc::new(b.build())
        };
        Curves::new((0..6).map(tuft).collect())
    }

    /// Notes at each hair how far its root is from a parting; gives the numbers, and how many were asked.
    fn distances(host: &Memory, scalp: &TracedScalp, by_place: bool) -> (Vec<f32>, u32) {
        let log = Log::default();
        let mut cx = EvalCx::new(0, Quality::Final, scalp.scalp.key(), host, &log);
        cx.node_untraced = by_place.then(|| scalp.scalp.key_untraced());
        let ask = |tuft: &crate::data::curves::Tuft, piece: &mut Piece| {
            let sections = piece.scalp().and_then(Scalp::sections);
            let place = sections.and_then(|sections| sections.at(tuft.points()[0]));
            let mut b = tuft.edit();
            b.set(ROLL, Domain::Curve, vec![place.map_or(-1.0, |place| place.distance)]);
            Ok([b.build()])
        };
        let [out] = cx.by_place(Some(scalp)).each_tuft(&hair(), ask).unwrap();
        let distance = |(tuft, i): (&crate::data::curves::Tuft, usize)| tuft.view(ROLL).at(i, 0);
        (out.each().map(distance).collect(), log.tufts_run.into_inner())
    }

    #[test]
    fn pieces_run_again_where_they_read_what_changed_and_what_pieces_share_knows_no_parting() {
        let host = Memory::default();
        let ways: [(&[f32], u32); 5] = [
            (&[-4.0, 4.0], 6),
            // The three hairs that are nearest to that line.
            (&[-4.0, 4.3], 3),
            (&[-4.0, 4.0], 0),
            (&[-4.4, 4.0], 3),
            (&[-4.0, 4.0], 0),
        ];
        for (sides, ran) in ways {
            let scalp = parted(sides);
            assert!(scalp.head().sections().is_none() && scalp.whole().sections().is_some());
            let (found, pieces) = distances(&host, &scalp, true);
            let (fresh, _) = distances(&Memory::default(), &scalp, false);
            assert_eq!(found, fresh, "{sides:?}");
            assert!(found.iter().all(|distance| *distance > 0.0), "{found:?}");
            assert_eq!(pieces, ran, "{sides:?}");
        }
    }
}
