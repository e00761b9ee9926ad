//! A narrow-band signed distance field of a head: fast answers to "is this point under the skin?".
//!
//! Samples every 2 mm within 1 cm of the surface, each the distance of the exact closest point. A cell is sampled at the first
//! query in it, along with those of its eight corners that no cell before it has sampled: a guide or a single hair pays only for
//! the cells it passes, however large or folded the mesh is.
//!
//! Guarantees: the same bits for any number of threads and any order of queries, since a cell depends on the surface alone; error
//! under a tenth of a cell where the surface is smooth on the scale of a cell, under half a cell at sharp creases. Within a cell
//! of the surface, callers who need more ask for the closest point: of the few triangles near a cell, which are listed at the first such
//! question in it, to the bit as [`Surface::closest`] finds it.
//!
//! Tried before: the whole field at once, 1.3 s of CPU for a bust of 36,000 triangles; whole blocks of 8 x 8 x 8 cells on first
//! touch, 0.4 s for 500 guides, most of it for cells that were never used, and seconds for thin fur on a large mesh, where each
//! hair has its own blocks.

use super::brick::{
    BRICK, BRICK_CELLS, Brick, CORNERS, FAR_OFF, MORE, OFF, SIDE, UNKNOWN, UNMADE, cell_at,
    sample_at,
};
use super::closest::{Hit, Surface};
use super::drawn_span::DrawnSpan;
use super::horizon::{Cap, Horizon, View};
use super::lanes::LANES;
use super::triangle_tree::Nearby;
use glam::{IVec3, Vec3};
use std::sync::OnceLock;
use std::sync::atomic::{AtomicU16, AtomicUsize, Ordering};

/// Distance between samples, cm. Doubled as often as needed for a mesh of more than `MOST_BLOCKS`.
pub const CELL: f32 = 0.2;
/// Half the diagonal of a cell, in cells, and a little for rounding.
const HALF_DIAGONAL: f32 = 0.87;
/// Width of the band around the surface, in cells: 1 cm.
const BAND_CELLS: f32 = 5.0;
/// Cells along the edge of a block.
const BLOCK: i32 = 8;
/// Largest number of blocks in a field's bounds: 200,000 cover a figure of 1.8 x 1 x 0.4 m at 2 mm. The table of blocks then
/// takes 5 MB; only queried blocks take more.
const MOST_BLOCKS: f32 = 200_000.0;

/// What the field knows about a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Depth {
    /// Signed distance (negative inside), its gradient (about unit, outward) and the possible error, all cm: small where the skin
    /// is smooth, half a cell where it may have a crease.
    Near(f32, Vec3, f32),
    /// Inside, beyond the band.
    Inside,
    /// Outside, beyond the band.
    Outside,
}

/// The field of one surface.
pub struct DistanceField {
    cell: f32,
    per_cell: f32,
    lowest: Vec3,
    blocks_along: IVec3,
    blocks: Vec<OnceLock<Block>>,
    /// That of each triangle that a hair was rooted on.
    horizons: OnceLock<Box<[OnceLock<Horizon>]>>,
    /// Bytes of all this. (Counting them anew each time took milliseconds of every evaluation.)
    held: AtomicUsize,
}

enum Block {
    Inside,
    Outside,
    Near(Box<Near>),
}

/// A block near the surface.
struct Near {
    /// The triangle closest to its centre, and the signed distance of its centre, cm.
    triangle: u32,
    distance: f32,
    /// Direction outward from there, per axis: 1 along the axis, 0 against it.
    outward: IVec3,
    bricks: [OnceLock<Box<Brick>>; 8],
}

/// A position in a field.
enum Place<'a> {
    Inside,
    Outside,
    /// Position in cells from the lowest corner: exact, and the cell; and the block.
    Near {
        q: Vec3,
        i: IVec3,
        block: &'a Near,
    },
}

/// Index of a cell's brick in its block.
#[inline]
fn which(i: IVec3) -> usize {
    ((i.z & 4) | ((i.y & 4) >> 1) | ((i.x & 4) >> 2)) as usize
}

impl DistanceField {
    /// The field of `surface`, in cm. Nothing is computed yet.
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
            horizons: OnceLock::new(),
            held: AtomicUsize::new(count * size_of::<OnceLock<Block>>()),
        }
    }

    /// What the field knows at `p` (cm), interpolated between samples. `surface` must be the one the field was made for.
    #[inline]
    pub fn depth(&self, surface: &Surface, p: Vec3) -> Depth {
        self.looked_up(surface, p, |_, doubt| doubt)
    }

    /// [`Self::depth`] with the error, where it is under [`Self::fine`], as it is measured in the middle of the cell.
    #[inline]
    pub fn fine_depth(&self, surface: &Surface, p: Vec3) -> Depth {
        self.looked_up(surface, p, |[more, off], doubt| {
            let bent = doubt - f32::from(more) * (MORE * self.cell) - self.fine();
            let error = 1.5 * OFF * self.cell * f32::from(off) + 0.25 * bent;
            if off < FAR_OFF && error < self.fine() { error } else { doubt }
        })
    }

    /// Errors under this are those of smooth skin, cm.
    #[inline]
    pub fn fine(&self) -> f32 {
        0.05 * self.cell
    }

    /// What the field knows at `p`, with the error that is made of what is stored of its cell's centre and of the full error.
    #[inline]
    fn looked_up(&self, surface: &Surface, p: Vec3, error: impl Fn([u8; 2], f32) -> f32) -> Depth {
        let (q, i, brick) = match self.place(surface, p) {
            Place::Inside => return Depth::Inside,
            Place::Outside => return Depth::Outside,
            Place::Near { q, i, block } => (q, i, self.brick(block, i)),
        };
        let corner = sample_at(i & (BRICK - 1));
        let centre = &brick.centres[cell_at(i)];
        // A thread that reads this value also sees the corners, which were stored before it.
        let known = match centre.load(Ordering::Acquire) {
            UNMADE => self.make(surface, brick, i, corner, centre),
            known => known,
        };
        let known = known.to_le_bytes();
        let (d, gradient, doubt) = self.between(brick, corner, q - i.as_vec3());
        let doubt = doubt + f32::from(known[0]) * (MORE * self.cell);
        Depth::Near(d, gradient, error(known, doubt))
    }

    /// Whether `p` is more than `height` (cm, at least 0) outside, by one or two known distances nearby: where the surface [parts
    /// in from out](Surface::parts_in_from_out), the distance at `p` is smaller by at most the way there. False means unknown.
    /// Most CVs are slightly off the skin and need no cell of their own.
    #[inline]
    pub fn is_clear(&self, surface: &Surface, p: Vec3, height: f32) -> bool {
        self.off_at_least(surface, p, height) > height
    }

    /// A lower bound of the distance of `p` outside the surface (cm); 0 if unknown. The search ends once it exceeds `enough`.
    #[inline]
    pub fn off_at_least(&self, surface: &Surface, p: Vec3, enough: f32) -> f32 {
        let (q, i, block) = match self.place(surface, p) {
            Place::Inside => return 0.0,
            Place::Outside => return self.band(),
            Place::Near { q, i, block } => (q, i, block),
        };
        // Margin for rounding of coordinates.
        let margin = 0.01 * self.cell + 1e-6 * p.abs().max_element();
        let off = |distance: f32, cells: IVec3| {
            distance - q.distance(cells.as_vec3()) * self.cell - margin
        };
        let middle = |size: i32| (i & !(size - 1)) + size / 2;
        let mut most = off(block.distance, middle(BLOCK)).max(0.0);
        if most > enough {
            return most;
        }
        let brick = self.brick(block, i);
        // The outermost corner of a cell is the best bound.
        for cells in [middle(BRICK), i + block.outward] {
            let at = sample_at(cells - (i & !(BRICK - 1)));
            most = most.max(off(self.known(surface, brick, at, cells.as_vec3()), cells));
            if most > enough {
                break;
            }
        }
        most
    }

    /// Radius (cm) of a ball around `p`, outside, that holds no skin, by the centre of its block alone; 0 means unknown. Samples
    /// no cell.
    pub fn far(&self, surface: &Surface, p: Vec3) -> f32 {
        match self.place(surface, p) {
            Place::Inside => 0.0,
            Place::Outside => self.band(),
            Place::Near { q, i, block } => self.off_block(p, q, i, block).max(0.0),
        }
    }

    /// A lower bound of the distance of `p` outside, cm, by the centre of its block.
    #[inline]
    fn off_block(&self, p: Vec3, q: Vec3, i: IVec3, block: &Near) -> f32 {
        let middle = (i & !(BLOCK - 1)) + BLOCK / 2;
        let rounding = 0.01 * self.cell + 1e-6 * p.abs().max_element();
        block.distance - q.distance(middle.as_vec3()) * self.cell - rounding
    }

    /// Whether everything around `p` is outside and beyond the band. False means unknown.
    pub fn is_beyond(&self, surface: &Surface, p: Vec3) -> bool {
        matches!(self.place(surface, p), Place::Outside)
    }

    /// [`Surface::closest`], by the triangles near the cell of `p`, which are looked for once; `None` where these are not few, and
    /// beyond the band.
    #[inline]
    pub fn closest(&self, surface: &Surface, p: Vec3) -> Option<Hit> {
        let Place::Near { q, i, block } = self.place(surface, p) else { return None };
        let brick = self.brick(block, i);
        let (middle, nearby) = self.nearby(surface, brick, i);
        let is_in = (q - i.as_vec3() - 0.5).length_squared() < HALF_DIAGONAL * HALF_DIAGONAL;
        if is_in { surface.closest_of(p, middle, nearby) } else { None }
    }

    /// What a hair sees from a root on a triangle; `None` if it does not lie on it, or if nothing is known there. It holds where the surface
    /// [parts in from out](Surface::parts_in_from_out).
    #[inline]
    pub fn view_from(&self, surface: &Surface, root: Vec3, triangle: u32) -> Option<View> {
        let horizons = self.horizons.get_or_init(|| {
            let count = surface.triangles.len();
            self.holds(count * size_of::<OnceLock<Horizon>>());
            (0..count).map(|_| OnceLock::new()).collect()
        });
        let horizon = horizons.get(triangle as usize)?;
        let horizon = *horizon.get_or_init(|| Horizon::of(surface, triangle));
        View::new(surface, triangle, root, horizon)
    }

    /// Whether a span, in a ball with this middle and radius (cm), is outside: by the centre of its block alone, or because it lies higher than
    /// all surface beside it. It holds where the surface [parts in from out](Surface::parts_in_from_out). False means unknown.
    #[inline]
    pub fn is_over(
        &self,
        surface: &Surface,
        span: &DrawnSpan,
        (middle, radius): (Vec3, f32),
    ) -> bool {
        let (q, i, block) = match self.place(surface, middle) {
            Place::Inside => return false,
            Place::Outside => return radius < self.band(),
            Place::Near { q, i, block } => (q, i, block),
        };
        if self.off_block(middle, q, i, block) > radius {
            return true;
        }
        let caps = self.brick(block, i).caps.get_or_init(|| {
            self.holds(8 * size_of::<OnceLock<Cap>>());
            Box::new([const { OnceLock::new() }; 8])
        });
        let eighth = IVec3::new(i.x >> 1, i.y >> 1, i.z >> 1);
        let centre = self.lowest + (2.0 * eighth.as_vec3() + 1.0) * self.cell;
        let size = self.cell / CELL;
        let at = ((eighth.z & 1) << 2 | (eighth.y & 1) << 1 | (eighth.x & 1)) as usize;
        let cap = caps[at].get_or_init(|| Cap::of(surface, centre, size));
        cap.is_under(&span.bezier(), centre, size)
    }

    /// The brick of a cell.
    #[inline]
    fn brick<'b>(&self, block: &'b Near, i: IVec3) -> &'b Brick {
        block.bricks[which(i)].get_or_init(|| {
            self.holds(size_of::<Brick>());
            Brick::new(block.triangle)
        })
    }

    fn holds(&self, bytes: usize) {
        self.held.fetch_add(bytes, Ordering::Relaxed);
    }

    /// The middle of a cell (cm), and the triangles near it.
    fn nearby<'b>(&self, surface: &Surface, brick: &'b Brick, i: IVec3) -> (Vec3, &'b Nearby) {
        let middle = self.lowest + (i.as_vec3() + 0.5) * self.cell;
        let cells = brick.nearby.get_or_init(|| {
            self.holds(BRICK_CELLS * size_of::<OnceLock<Nearby>>());
            Box::new([const { OnceLock::new() }; BRICK_CELLS])
        });
        let nearby = cells[cell_at(i)].get_or_init(|| {
            let radius = HALF_DIAGONAL * self.cell + 1e-6 * middle.abs().max_element();
            let nearby = surface.nearby(middle, radius);
            self.holds(nearby.len() * size_of::<(f32, u32)>());
            nearby
        });
        (middle, nearby)
    }

    /// A triangle near `p`; `None` if there is none. Samples no cell.
    #[inline]
    pub fn hint(&self, surface: &Surface, p: Vec3) -> Option<u32> {
        let Place::Near { i, block, .. } = self.place(surface, p) else { return None };
        let brick = block.bricks[which(i)].get();
        Some(brick.map_or(block.triangle, |brick| brick.near.load(Ordering::Relaxed)))
    }

    /// The block of `p`, and its position in the field, in cells.
    #[inline]
    fn place(&self, surface: &Surface, p: Vec3) -> Place<'_> {
        let q = (p - self.lowest) * self.per_cell;
        // Truncation of a positive number: a floor without a library call.
        let i = q.as_ivec3();
        let b = IVec3::new(i.x >> 3, i.y >> 3, i.z >> 3);
        if !q.cmpge(Vec3::ZERO).all() || b.cmpge(self.blocks_along).any() {
            return Place::Outside;
        }
        let index = ((b.z * self.blocks_along.y + b.y) * self.blocks_along.x + b.x) as usize;
        match self.blocks[index].get_or_init(|| self.block(surface, b)) {
            Block::Inside => Place::Inside,
            Block::Outside => Place::Outside,
            Block::Near(block) => Place::Near { q, i, block },
        }
    }

    /// Distance, gradient and doubt at a fractional position in a cell of a brick.
    #[inline]
    fn between(&self, brick: &Brick, corner: usize, f: Vec3) -> (f32, Vec3, f32) {
        const Y: usize = SIDE;
        const Z: usize = SIDE * SIDE;
        let s = |o: usize| brick.sample(corner + o);
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
        // Over smooth skin, distances are linear: the gradient has length 1, and the eight samples fit a plane. A ridge or a
        // groove violates one or the other.
        let bent = (s(0) - s(1) - s(Y) + s(Y + 1)).abs()
            + (s(Z) - s(Z + 1) - s(Z + Y) + s(Z + Y + 1)).abs()
            + (x10 - x00 - x11 + x01).abs()
            + (s(0) + s(Y) - s(1) - s(Y + 1) - s(Z) - s(Z + Y) + s(Z + 1) + s(Z + Y + 1)).abs();
        let steep = (gradient.length_squared() - 1.0).abs();
        let doubt = (self.fine() + bent + 0.6 * self.cell * steep).min(0.5 * self.cell);
        (lerp(y0, y1, f.z), gradient, doubt)
    }

    #[cold]
    fn block(&self, surface: &Surface, b: IVec3) -> Block {
        let size = self.cell * BLOCK as f32;
        let middle = self.lowest + b.as_vec3() * size + Vec3::splat(0.5 * size);
        let Some(hit) = surface.closest(middle) else { return Block::Outside };
        let half_diagonal = 0.5 * size * 1.732_051;
        if hit.distance > BAND_CELLS * self.cell + half_diagonal {
            let inside = surface.signed_distance(middle, &hit) < 0.0;
            return if inside { Block::Inside } else { Block::Outside };
        }
        let distance = surface.signed_distance(middle, &hit);
        let outward = (middle - hit.point) * distance;
        self.holds(size_of::<Near>());
        Block::Near(Box::new(Near {
            triangle: hit.triangle,
            distance,
            outward: outward.to_array().map(|x| i32::from(x > 0.0)).into(),
            bricks: [const { OnceLock::new() }; 8],
        }))
    }

    /// Samples the missing corners of cell `i` of the field; returns and stores what the distance at its centre says of those
    /// interpolated there. What is thinner than a cell, such as the locks of a scan, does not show in the samples themselves.
    #[cold]
    fn make(
        &self,
        surface: &Surface,
        brick: &Brick,
        i: IVec3,
        corner: usize,
        centre: &AtomicU16,
    ) -> u16 {
        const CENTRE: Vec3 = Vec3::splat(0.5);
        let low = i.as_vec3();
        let at = |off: Vec3| self.lowest + (low + off) * self.cell;
        // All at once: the missing corners, and the centre where there is room.
        let (mut samples, mut points, mut count) = ([0; LANES], [at(CENTRE); LANES], 0);
        for (k, off) in CORNERS {
            if brick.sample(corner + k).to_bits() == UNKNOWN {
                (samples[count], points[count]) = (corner + k, at(Vec3::from(off)));
                count += 1;
            }
        }
        let ball = (at(CENTRE), HALF_DIAGONAL * self.cell);
        let hits = match count {
            0 => [None; LANES],
            _ => surface.closest_of_each(&points, ball, brick.near.load(Ordering::Relaxed)),
        };
        let found = |lane: usize| {
            hits[lane].map_or(self.band(), |hit| {
                brick.near.store(hit.triangle, Ordering::Relaxed);
                surface.signed_distance(points[lane], &hit)
            })
        };
        for (lane, sample) in samples[..count].iter().enumerate() {
            brick.samples[*sample].store(found(lane).to_bits(), Ordering::Relaxed);
        }
        let (d, _, doubt) = self.between(brick, corner, CENTRE);
        let mut known = [0, FAR_OFF];
        if d.abs() <= 1.5 * self.cell {
            let centre = match count {
                0 | LANES => self.exact(surface, brick, low + CENTRE),
                lane => found(lane),
            };
            let off = (centre - d).abs();
            // (All that there are; `as` turns a negative number into 0.)
            let steps = |off: f32, step: f32| (off * self.per_cell / step).ceil() as u8;
            known = [steps(off - doubt, MORE).min(u8::MAX - 1), steps(off, OFF)];
        }
        let known = u16::from_le_bytes(known);
        centre.store(known, Ordering::Release);
        known
    }

    /// The sample of a brick at this offset from its lowest corner, in cells; computed if missing.
    #[inline]
    fn known(&self, surface: &Surface, brick: &Brick, at: usize, cells: Vec3) -> f32 {
        let known = brick.sample(at);
        if known.to_bits() != UNKNOWN {
            return known;
        }
        let distance = self.exact(surface, brick, cells);
        brick.samples[at].store(distance.to_bits(), Ordering::Relaxed);
        distance
    }

    /// The signed distance at this offset from the field's lowest corner, in cells: whole numbers give the same point to every
    /// caller.
    fn exact(&self, surface: &Surface, brick: &Brick, cells: Vec3) -> f32 {
        let p = self.lowest + cells * self.cell;
        // A non-finite point has no closest point and is not near the skin.
        surface.closest_from(p, brick.near.load(Ordering::Relaxed)).map_or(self.band(), |hit| {
            brick.near.store(hit.triangle, Ordering::Relaxed);
            surface.signed_distance(p, &hit)
        })
    }

    /// Smallest distance outside the surface of all points that the field reports as outside, cm.
    #[inline]
    pub fn band(&self) -> f32 {
        BAND_CELLS * self.cell
    }

    /// One and a half times the error where the surface is smooth, cm.
    #[inline]
    pub fn error(&self) -> f32 {
        0.15 * self.cell
    }

    /// Bytes held so far.
    pub fn bytes(&self) -> usize {
        self.held.load(Ordering::Relaxed)
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
    fn over_smooth_skin_the_fine_error_is_small_and_hardly_ever_too_small() {
        let bust = crate::scalp::bust::adult();
        let surface = Surface::new(bust.points.clone(), bust.triangles.clone());
        let field = DistanceField::new(&surface);
        let dice = Dice::new(13, 0, "query");
        let (mut near, mut fine, mut whole, mut wrong, mut worst) = (0, 0.0, 0.0, 0, 0.0f32);
        for id in 0..60_000 {
            // Where hair grows, ears and brows among it.
            let way = Vec3::from([0, 1, 2].map(|k| dice.signed(id, k))) + Vec3::Y * 0.5;
            let p = surface.closest(way.normalize_or(Vec3::Y) * 10.0).unwrap().point
                + Vec3::from([3, 4, 5].map(|k| dice.signed(id, k))) * 0.06;
            let exact = surface.signed_distance(p, &surface.closest(p).unwrap());
            let Depth::Near(d, _, error) = field.fine_depth(&surface, p) else { continue };
            let Depth::Near(_, _, doubt) = field.depth(&surface, p) else { continue };
            near += 1;
            (fine, whole) = (fine + error, whole + doubt);
            let beyond = (d - exact).abs() - error;
            wrong += usize::from(beyond > 0.002);
            worst = worst.max(beyond);
        }
        let [fine, whole] = [fine, whole].map(|sum| sum / near as f32);
        println!("{near}: mean {fine} of {whole} cm, {wrong} off by more, at most by {worst}");
        assert!(
            fine < 0.5 * whole && wrong * 1000 < near,
            "{fine} of {whole}, {wrong} of {near}: {worst}"
        );
    }

    #[test]
    fn the_closest_point_of_what_is_near_a_cell_is_the_closest_of_all() {
        let bust = crate::scalp::bust::adult();
        let bust = Surface::new(bust.points.clone(), bust.triangles.clone());
        let dice = Dice::new(17, 0, "query");
        // Coarse, fine, and so fine that a cell has too many triangles to list.
        let mut found = vec![];
        for surface in [sphere(1.5, 5), sphere(6.0, 64), bust, sphere(0.3, 128)] {
            let field = DistanceField::new(&surface);
            for id in 0..5_000 {
                let on =
                    surface.triangles[(dice.unit(id, 0) * surface.triangles.len() as f32) as usize];
                let off = Vec3::from([1, 2, 3].map(|k| dice.signed(id, k)));
                let p = surface.points[on[0] as usize] + off * if id % 2 == 0 { 0.2 } else { 1.5 };
                if let Some(hit) = field.closest(&surface, p) {
                    assert_eq!(Some(hit), surface.closest(p), "{p}");
                }
            }
            found.push(listed(&field));
        }
        println!("cells and triangles listed: {found:?}");
        let all_have = |[cells, of_cells]: &[usize; 2]| *cells > 500 && *of_cells > *cells;
        assert!(found[..3].iter().all(all_have), "{found:?}");
        assert!(found[3][1] < found[3][0] / 10, "{found:?}");
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
    fn what_is_clear_is_farther_off_than_it_must_be_and_few_samples_tell() {
        let surface = sphere(6.0, 64);
        let field = DistanceField::new(&surface);
        let dice = Dice::new(11, 0, "query");
        let (mut clear, mut off) = (0, 0);
        for id in 0..5000 {
            let v = Vec3::new(dice.signed(id, 0), dice.signed(id, 1), dice.signed(id, 2));
            let p = v.normalize_or(Vec3::X) * (6.0 + 1.5 * dice.signed(id, 3));
            let height = 0.3 * dice.unit(id, 4);
            let exact = surface.signed_distance(p, &surface.closest(p).unwrap());
            let is_clear = field.is_clear(&surface, p, height);
            assert!(!is_clear || exact > height, "{p}: {exact} {height}");
            // What lies farther off is told by the outward corner of its cell, 0.35 cm off at most.
            assert!(is_clear || exact < height + 0.36, "{p}: {exact} {height}");
            clear += usize::from(is_clear);
            off += usize::from(exact > height);
        }
        assert!(clear > 1700 && off < 2400, "{clear} of {off}");
        // No cell was made, and of a thin shell of bricks one sample or two for each point.
        let (samples, cells) = made(&field);
        assert!(samples < 6000 && cells == 0, "{samples} {cells}");
        assert!(field.is_clear(&surface, Vec3::Y * 9.0, 0.5));
        assert!(!field.is_clear(&surface, Vec3::ZERO, 0.0));
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

    fn bricks(field: &DistanceField) -> impl Iterator<Item = &Brick> {
        let near = field.blocks.iter().filter_map(|block| match block.get() {
            Some(Block::Near(near)) => Some(near),
            _ => None,
        });
        near.flat_map(|near| near.bricks.iter().filter_map(|brick| Some(&**brick.get()?)))
    }

    /// How many samples and cells are made.
    fn made(field: &DistanceField) -> (usize, usize) {
        bricks(field).fold((0, 0), |(samples, cells), brick| {
            let known = brick.samples.iter().filter(|s| s.load(Ordering::Relaxed) != UNKNOWN);
            let made = brick.centres.iter().filter(|m| m.load(Ordering::Relaxed) != UNMADE);
            (samples + known.count(), cells + made.count())
        })
    }

    /// Number of cells for which the triangles near them were looked for, and of those listed, with repeats.
    fn listed(field: &DistanceField) -> [usize; 2] {
        let lists = bricks(field).filter_map(|brick| brick.nearby.get()).flat_map(|cells| &**cells);
        lists
            .filter_map(OnceLock::get)
            .fold([0, 0], |[cells, listed], nearby| [cells + 1, listed + nearby.len()])
    }

    #[test]
    fn only_what_is_asked_about_is_made() {
        let surface = sphere(6.0, 64);
        let field = DistanceField::new(&surface);
        let empty = field.bytes();
        field.depth(&surface, Vec3::Y * 6.0);
        // The eight bricks of a block are pointers but for one, and of its 125 samples the corners of a cell are known.
        let brick = size_of::<Near>() + size_of::<Brick>();
        assert_eq!((field.bytes(), listed(&field)), (empty + brick, [0, 0]));
        // A cell in which closest points are asked for lists what is near it; at a pole that is too much to list.
        assert_eq!(field.closest(&surface, Vec3::Y * 6.0), None);
        assert_eq!(listed(&field), [1, 0]);
        let lists = size_of::<[OnceLock<Nearby>; BRICK_CELLS]>();
        assert_eq!(field.bytes(), empty + brick + lists);
        assert_eq!(made(&field), (8, 1));
        // A neighbour shares four of them.
        field.depth(&surface, Vec3::Y * 6.0 + Vec3::X * CELL);
        assert_eq!(made(&field), (12, 2));
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
