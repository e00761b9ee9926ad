//! How strands of a cluster deviate from parallel: wisps, random lengths, waves and strays.
//!
//! Guarantees: random values depend on ids, so more strands change none of the others; without strays, a strand stays within the
//! cluster's radius; settings without effect give [`None`] and cost nothing.

use super::cross_sections::{CrossSection, CrossSections};
use crate::maths::hash::Dice;
use crate::maths::low_discrepancy::disc;
use crate::maths::smoothstep;
use crate::maths::transcendental::sin_cos_turns;
use glam::{Vec2, Vec3};

/// Wavelength of `jitter`, cm: as long as hair bends by itself.
const WAVES: [f32; 2] = [3.1, 4.7];

/// Settings shared by all strands.
pub(super) struct ClusterShape {
    pub wisps: usize,
    pub root_clump: f32,
    pub tip_clump: f32,
    /// Largest shortening, as a fraction of the length.
    pub shorter: f32,
    /// Amplitude, cm.
    pub jitter: f32,
    /// Fraction of strands.
    pub stray: f32,
    /// Largest distance of a stray tip, cm.
    pub stray_amount: f32,
    pub dice: Dice,
}

/// Random values of one strand.
pub(super) struct Strand<'a> {
    shape: &'a ClusterShape,
    /// Centre it is drawn to, in the unit disc.
    middle: Vec2,
    /// Fraction of the cluster's length.
    length: f32,
    /// Number of segments of the cluster.
    steps: f32,
    phase: [f32; 2],
    /// Offset of its tip along the axes of the cross-section, cm.
    off: Vec2,
}

impl ClusterShape {
    pub(super) fn changes_anything(&self) -> bool {
        let strays = self.stray > 0.0 && self.stray_amount > 0.0;
        strays
            || self.root_clump > 0.0
            || self.tip_clump > 0.0
            || self.shorter > 0.0
            || self.jitter > 0.0
    }
    /// Centres of a cluster's wisps in the unit disc.
    pub(super) fn wisps(&self, cluster: u64) -> Vec<Vec2> {
        let shift = [self.dice.unit(cluster, 0), self.dice.unit(cluster, 1)];
        (0..self.wisps).map(|k| Vec2::from(disc(k as u32, shift))).collect()
    }
    pub(super) fn strand(
        &self,
        id: u64,
        q: Vec2,
        sections: &CrossSections,
        wisps: &[Vec2],
    ) -> Strand<'_> {
        let dice = self.dice;
        let nearest =
            wisps.iter().min_by(|a, b| a.distance_squared(q).total_cmp(&b.distance_squared(q)));
        let strays = self.stray > 0.0 && dice.unit(id, 2) < self.stray;
        let off = if strays {
            let (y, x) = sin_cos_turns(dice.unit(id, 3));
            Vec2::new(x, y) * (self.stray_amount * (0.2 + 0.8 * dice.unit(id, 4)))
        } else {
            Vec2::ZERO
        };
        // Most strands are nearly as long as the longest; few are much shorter.
        let cut = dice.unit(id, 5);
        Strand {
            shape: self,
            middle: nearest.copied().unwrap_or(Vec2::ZERO),
            length: 1.0 - self.shorter * cut * cut,
            steps: (sections.at.len().max(2) - 1) as f32,
            phase: [dice.unit(id, 6), dice.unit(id, 7)],
            off,
        }
    }
}

impl Strand<'_> {
    /// Position at the root.
    pub(super) fn root(&self, q: Vec2) -> Vec2 {
        q.lerp(self.middle, self.shape.root_clump)
    }
    /// The cross-section before its CV `k`.
    pub(super) fn before(&self, k: usize) -> usize {
        (k as f32 * self.length) as usize
    }
    /// Its CV `k`, before it is pushed out of the skin.
    #[inline]
    pub(super) fn point(
        &self,
        k: usize,
        sections: &CrossSections,
        root: Vec3,
        walked: impl Fn(&CrossSection) -> Vec2,
    ) -> Vec3 {
        let x = k as f32 * self.length;
        let first = (x as usize).min(sections.at.len() - 1);
        let f = x - first as f32;
        let p = self.at(first, sections, root, &walked);
        match sections.at.get(first + 1) {
            Some(_) if f > 1e-4 => p.lerp(self.at(first + 1, sections, root, &walked), f),
            _ => p,
        }
    }
    #[inline]
    fn at(
        &self,
        k: usize,
        sections: &CrossSections,
        root: Vec3,
        walked: &impl Fn(&CrossSection) -> Vec2,
    ) -> Vec3 {
        if k == 0 {
            return root;
        }
        let (section, shape) = (&sections.at[k], self.shape);
        let u = k as f32 / self.steps;
        let grown = smoothstep(u);
        let clump = shape.root_clump + (shape.tip_clump - shape.root_clump) * grown;
        let mut d = walked(section).lerp(self.middle, clump);
        if shape.jitter > 0.0 {
            let s = u * sections.length;
            let wave = |i: usize| sin_cos_turns(self.phase[i] + s / WAVES[i]).0;
            let radius = section.radius.max(1e-6);
            d += Vec2::new(wave(0), wave(1)) * (shape.jitter / radius * (4.0 * u).min(1.0));
            d = d.clamp_length_max(1.0);
        }
        let mut p = section.centre + section.x * d.x + section.y * d.y;
        if section.root_share > 0.0 {
            p = section.on_the_way(root - sections.root, p);
        }
        if self.off != Vec2::ZERO {
            let (x, y) = (section.x.normalize_or_zero(), section.y.normalize_or_zero());
            p += (x * self.off.x + y * self.off.y) * (u * u);
        }
        p
    }
}
