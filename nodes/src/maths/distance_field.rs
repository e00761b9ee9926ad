//! A narrow-band signed distance field of a head: fast answers to "is this point under the skin?".
//!
//! Samples every 2 mm within 1 cm of the surface, in blocks of 8 x 8 x 8 cells that carry their own border, so that
//! one lookup touches one block. A block is made when somebody first asks about a point in it: hair visits a few hundred
//! of the thousands a bust has. Its samples are exact closest points, looked for among the triangles that may be closest to a
//! brick of 4 x 4 x 4 cells, each search bounded by the last sample's triangle.
//!
//! Guarantees: the same bits for any number of threads, for a block depends on the surface alone; error under a tenth of
//! a cell where the surface is smooth on the scale of a cell, under half a cell at sharp creases. Within a cell of the
//! surface callers who need more ask [`Surface::closest`].
//!
//! Tried before: the whole field at once, exact beside the surface and handed on from sample to sample. It took
//! 1.3 s of CPU for a bust of 36,000 triangles; the blocks that a full head of hair touches take a tenth of that.

use super::closest::{Around, Surface};
use glam::{IVec3, Vec3};
use std::sync::OnceLock;

/// Distance between samples, cm. Doubled as often as needed for a mesh of more than `MOST_BLOCKS`.
pub const CELL: f32 = 0.2;
/// How many cells from the surface distances are known: 1 cm.
const BAND_CELLS: f32 = 5.0;
/// Cells along a block's edge.
const BLOCK: i32 = 8;
/// Samples along a block's edge, border included.
const SIDE: usize = BLOCK as usize + 1;
const SAMPLES: usize = SIDE * SIDE * SIDE;
/// The most blocks a field's box may have: 200,000 are a figure of 1.8 x 1 x 0.4 m at 2 mm. The table of
/// blocks then takes 5 MB; only blocks that somebody asks about cost more.
const MOST_BLOCKS: f32 = 200_000.0;

/// What the field knows about a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Depth {
    /// Signed distance (negative inside), its gradient (about unit, outward) and how far it may be wrong, cm: little where
    /// the skin is smooth, half a cell where it may have a crease.
    Near(f32, Vec3, f32),
    /// More than the band inside.
    Inside,
    /// More than the band outside.
    Outside,
}

/// The field of one surface.
pub struct DistanceField {
    cell: f32,
    per_cell: f32,
    lowest: Vec3,
    blocks_along: IVec3,
    blocks: Vec<OnceLock<Block>>,
}

enum Block {
    Inside,
    Outside,
    Samples(Box<Samples>),
}

struct Samples {
    at: [f32; SAMPLES],
    /// How much farther off than it is thought to be what lies between samples was found, cm: nothing where skin is smooth.
    more: f32,
}

/// Cells along the edge of a brick.
const BRICK: i32 = 4;

/// A part of a block, with the triangles that may be closest to its samples, unless they are very many.
struct Brick<'a> {
    low: IVec3,
    surface: &'a Surface,
    around: Option<Around<'a>>,
    /// The triangle that the last point was closest to.
    last: u32,
}

impl<'a> Brick<'a> {
    fn all() -> impl Iterator<Item = IVec3> {
        let along = || (0..BLOCK).step_by(BRICK as usize);
        along()
            .flat_map(move |z| along().flat_map(move |y| along().map(move |x| IVec3::new(x, y, z))))
    }

    fn new(surface: &'a Surface, first: Vec3, low: IVec3, cell: f32, near: u32) -> Self {
        let half = 0.5 * BRICK as f32 * cell;
        let middle = first + low.as_vec3() * cell + half;
        let around = surface.around(middle, half * 1.732_051, near);
        let last = around.as_ref().map_or(near, |around| around.nearest);
        Self { low, surface, around, last }
    }

    /// Signed distance of a point of the brick from the surface.
    fn signed_distance(&mut self, p: Vec3) -> Option<f32> {
        let hit = match &self.around {
            Some(around) => around.closest_from(p, self.last),
            None => self.surface.closest_from(p, self.last)?,
        };
        self.last = hit.triangle;
        Some(self.surface.signed_distance(p, &hit))
    }

    /// Tells of `side` x `side` x `side` places from its lowest on. There and back along rows: each lies beside the one before
    /// it, whose triangle bounds the search.
    fn each(&mut self, side: i32, mut tell: impl FnMut(&mut Self, IVec3)) {
        for z in 0..side {
            for y in 0..side {
                for k in 0..side {
                    let x = if (y + z) % 2 == 0 { k } else { side - 1 - k };
                    tell(self, self.low + IVec3::new(x, y, z));
                }
            }
        }
    }
}

impl DistanceField {
    /// The field of `surface`, whose coordinates are in cm. Costs nothing yet.
    pub fn new(surface: &Surface) -> Self {
        let (lo, hi) = surface.bounds();
        let mut cell = CELL;
        let blocks = |cell: f32| {
            (hi - lo + Vec3::splat(2.0 * (BAND_CELLS + 1.0) * cell)) / (cell * BLOCK as f32)
        };
        while blocks(cell).element_product() > MOST_BLOCKS {
            cell *= 2.0;
        }
        let blocks_along = blocks(cell).ceil().as_ivec3().max(IVec3::ONE);
        let count = (blocks_along.x * blocks_along.y * blocks_along.z) as usize;
        Self {
            cell,
            per_cell: 1.0 / cell,
            lowest: lo - Vec3::splat((BAND_CELLS + 1.0) * cell),
            blocks_along,
            blocks: (0..count).map(|_| OnceLock::new()).collect(),
        }
    }

    /// What is known at `p` (cm), interpolated between samples. `surface` is the one the field was made for.
    #[inline]
    pub fn depth(&self, surface: &Surface, p: Vec3) -> Depth {
        let q = (p - self.lowest) * self.per_cell;
        // Truncated where it is positive: a floor, without asking the library for one.
        let i = q.as_ivec3();
        let b = IVec3::new(i.x >> 3, i.y >> 3, i.z >> 3);
        if !q.cmpge(Vec3::ZERO).all() || b.cmpge(self.blocks_along).any() {
            return Depth::Outside;
        }
        let cell = i.as_vec3();
        let index = ((b.z * self.blocks_along.y + b.y) * self.blocks_along.x + b.x) as usize;
        let block = &self.blocks[index];
        let samples = match block.get_or_init(|| self.block(surface, b)) {
            Block::Inside => return Depth::Inside,
            Block::Outside => return Depth::Outside,
            Block::Samples(samples) => samples,
        };
        let (d, gradient, doubt) = self.between(samples, i, q - cell);
        Depth::Near(d, gradient, doubt + samples.more)
    }

    /// Distance, gradient and doubt at a fraction of a cell of a block.
    #[inline]
    fn between(&self, samples: &Samples, i: IVec3, f: Vec3) -> (f32, Vec3, f32) {
        let at = (((i.z & 7) as usize * SIDE) + (i.y & 7) as usize) * SIDE + (i.x & 7) as usize;
        const Y: usize = SIDE;
        const Z: usize = SIDE * SIDE;
        let s = |o: usize| samples.at[at + o];
        let lerp = |a: f32, b: f32, t: f32| a + (b - a) * t;
        let (x00, x10) = (lerp(s(0), s(1), f.x), lerp(s(Y), s(Y + 1), f.x));
        let (x01, x11) = (lerp(s(Z), s(Z + 1), f.x), lerp(s(Z + Y), s(Z + Y + 1), f.x));
        let (y0, y1) = (lerp(x00, x10, f.y), lerp(x01, x11, f.y));
        let dx = lerp(
            lerp(s(1) - s(0), s(Y + 1) - s(Y), f.y),
            lerp(s(Z + 1) - s(Z), s(Z + Y + 1) - s(Z + Y), f.y),
            f.z,
        );
        let dy = lerp(x10 - x00, x11 - x01, f.z);
        let gradient = Vec3::new(dx, dy, y1 - y0) * self.per_cell;
        // Over smooth skin distances grow evenly: the gradient has length 1, and what the eight samples differ by from a
        // plane is nothing. A ridge or a groove shows in one or the other.
        let bent = (s(0) - s(1) - s(Y) + s(Y + 1)).abs()
            + (s(Z) - s(Z + 1) - s(Z + Y) + s(Z + Y + 1)).abs()
            + (x10 - x00 - x11 + x01).abs()
            + (s(0) + s(Y) - s(1) - s(Y + 1) - s(Z) - s(Z + Y) + s(Z + 1) + s(Z + Y + 1)).abs();
        let steep = (gradient.length_squared() - 1.0).abs();
        let doubt = (0.05 * self.cell + bent + 0.6 * self.cell * steep).min(0.5 * self.cell);
        (lerp(y0, y1, f.z), gradient, doubt)
    }

    #[cold]
    fn block(&self, surface: &Surface, b: IVec3) -> Block {
        let size = self.cell * BLOCK as f32;
        let first = self.lowest + b.as_vec3() * size;
        let middle = first + Vec3::splat(0.5 * size);
        let Some(hit) = surface.closest(middle) else { return Block::Outside };
        let half_diagonal = 0.5 * size * 1.732_051;
        if hit.distance > BAND_CELLS * self.cell + half_diagonal {
            let inside = surface.signed_distance(middle, &hit) < 0.0;
            return if inside { Block::Inside } else { Block::Outside };
        }
        let mut samples = Box::new(Samples { at: [0.0; SAMPLES], more: 0.0 });
        let mut bricks: Vec<Brick> = Brick::all()
            .map(|low| Brick::new(surface, first, low, self.cell, hit.triangle))
            .collect();
        for brick in &mut bricks {
            brick.each(BRICK + 1, |brick, i| {
                // What bricks share is there.
                if (brick.low.cmpgt(IVec3::ZERO) & i.cmpeq(brick.low)).any() {
                    return;
                }
                let p = first + i.as_vec3() * self.cell;
                if let Some(d) = brick.signed_distance(p) {
                    samples.at[i.dot(IVec3::new(1, SIDE as i32, (SIDE * SIDE) as i32)) as usize] =
                        d;
                }
            });
        }
        samples.more = self.off(first, &samples, &mut bricks);
        Block::Samples(samples)
    }

    /// How much farther off than it is thought to be a block is between its samples: looked for in every other cell near the
    /// surface. What is thinner than a cell, such as the locks of a scan, does not show in the samples themselves.
    fn off(&self, first: Vec3, samples: &Samples, bricks: &mut [Brick]) -> f32 {
        let mut more = 0.0f32;
        for brick in bricks {
            brick.each(BRICK, |brick, i| {
                if i.element_sum() % 2 != 0 {
                    return;
                }
                let (d, _, doubt) = self.between(samples, i, Vec3::splat(0.5));
                if d.abs() > 1.5 * self.cell {
                    return;
                }
                let p = first + (i.as_vec3() + 0.5) * self.cell;
                if let Some(exact) = brick.signed_distance(p) {
                    more = more.max((exact - d).abs() - doubt);
                }
            });
        }
        more
    }

    /// How far outside the surface everything is that the field calls outside, cm.
    #[inline]
    pub fn band(&self) -> f32 {
        BAND_CELLS * self.cell
    }

    /// Half as much again as the error where the surface is smooth, cm.
    #[inline]
    pub fn error(&self) -> f32 {
        0.15 * self.cell
    }

    /// Bytes held so far.
    pub fn bytes(&self) -> usize {
        let made =
            self.blocks.iter().filter(|b| matches!(b.get(), Some(Block::Samples(_)))).count();
        self.blocks.len() * size_of::<OnceLock<Block>>() + made * size_of::<Samples>()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::maths::closest::tests::sphere;
    use crate::maths::hash::Dice;

    #[test]
    fn distances_in_the_band_are_right_to_a_tenth_of_a_cell() {
        let surface = sphere(6.0, 64);
        let field = DistanceField::new(&surface);
        let dice = Dice::new(5, 0, "query");
        let (mut near, mut worst) = (0, 0.0f32);
        for id in 0..5000 {
            let p = Vec3::new(dice.signed(id, 0), dice.signed(id, 1), dice.signed(id, 2)) * 7.5;
            let exact = surface.signed_distance(p, &surface.closest(p).unwrap());
            match field.depth(&surface, p) {
                Depth::Near(d, gradient, doubt) => {
                    near += 1;
                    if exact.abs() < 1.0 {
                        worst = worst.max((d - exact).abs());
                        assert!(doubt <= 0.5 * CELL);
                        assert!(gradient.dot(p.normalize()) > 0.97, "{p} {gradient}");
                    }
                }
                Depth::Inside => assert!(exact < -0.9, "{p} {exact}"),
                Depth::Outside => assert!(exact > 0.9, "{p} {exact}"),
            }
        }
        assert!(near > 1500 && worst < 0.1 * CELL, "{near} {worst}");
    }

    #[test]
    fn near_the_skin_the_field_is_no_farther_off_than_it_says() {
        for (radius, rows, least) in [(8.9, 80, 0.95), (6.0, 64, 0.9), (2.0, 8, 0.0), (1.5, 5, 0.0)]
        {
            let surface = sphere(radius, rows);
            let field = DistanceField::new(&surface);
            let dice = Dice::new(7, 0, "query");
            let (mut near, mut sure, mut wrong) = (0, 0, 0);
            for id in 0..20_000 {
                let v = Vec3::new(dice.signed(id, 0), dice.signed(id, 1), dice.signed(id, 2));
                let p = v.normalize() * (radius + 0.3 * dice.signed(id, 3));
                let exact = surface.signed_distance(p, &surface.closest(p).unwrap());
                if let Depth::Near(d, _, doubt) = field.depth(&surface, p)
                    && exact.abs() < 0.2
                {
                    near += 1;
                    sure += usize::from(doubt < 0.2 * CELL);
                    wrong += usize::from((d - exact).abs() > doubt);
                }
            }
            assert!(near > 4000 && wrong * 300 <= near, "{radius}: {wrong} of {near}");
            assert!(sure as f32 >= least * near as f32, "{radius}: {sure} of {near}");
        }
    }

    #[test]
    fn of_very_many_triangles_samples_are_as_exact_as_of_few() {
        let surface = sphere(0.3, 128);
        let field = DistanceField::new(&surface);
        let dice = Dice::new(9, 0, "query");
        for id in 0..200 {
            // Where a sample is, nothing is between samples.
            let cells = Vec3::from([0, 1, 2].map(|k| (dice.unit(id, k) * 15.0).floor()));
            let p = field.lowest + cells * CELL;
            let exact = surface.signed_distance(p, &surface.closest(p).unwrap());
            let Depth::Near(d, ..) = field.depth(&surface, p) else { panic!("{p}") };
            assert!((d - exact).abs() < 1e-4, "{p}: {d} {exact}");
        }
    }

    #[test]
    fn who_asks_first_does_not_matter() {
        let surface = sphere(3.0, 16);
        let (a, b) = (DistanceField::new(&surface), DistanceField::new(&surface));
        let dice = Dice::new(6, 0, "query");
        let p =
            |id: u64| Vec3::new(dice.signed(id, 0), dice.signed(id, 1), dice.signed(id, 2)) * 4.0;
        for id in (0..1000).rev() {
            b.depth(&surface, p(id));
        }
        for id in 0..1000 {
            assert_eq!(a.depth(&surface, p(id)), b.depth(&surface, p(id)));
        }
    }

    #[test]
    fn only_what_is_asked_about_is_made() {
        let surface = sphere(6.0, 64);
        let field = DistanceField::new(&surface);
        let empty = field.bytes();
        field.depth(&surface, Vec3::Y * 6.0);
        assert_eq!(field.bytes(), empty + size_of::<Samples>());
    }

    #[test]
    fn a_mesh_of_any_size_is_answered() {
        let surface = sphere(1e6, 8);
        let field = DistanceField::new(&surface);
        assert_eq!(field.depth(&surface, Vec3::ZERO), Depth::Inside);
        assert_eq!(field.depth(&surface, Vec3::splat(2e6)), Depth::Outside);
        assert_eq!(field.depth(&surface, Vec3::NAN), Depth::Outside);
    }
}
