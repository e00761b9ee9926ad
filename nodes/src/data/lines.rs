//! The lines of partings, and what is asked about them by place: which lie in a cell of the map, or near a point in space.
//!
//! Guarantees: whoever looks at a place does so through [`LinesView`], which notes it where its piece of work notes what it reads
//! (`read_set.rs`); no other module can look. Digests hold all that a look at a place can find. Not promised: that all segments that
//! are listed for a place are near it.

use super::chart::{CELL, CELLS, around, cell_of, cross, middle};
use super::places::{Places, place_of};
use super::read_set::{Digests, Reads, block_of};
use super::scalp::Scalp;
use super::sections::{FAR, NONE, Parting};
use crate::maths::hash::{Key, KeyBuilder};
use crate::maths::nearest_on;
use glam::{IVec2, Vec2, Vec3};
use std::collections::BTreeMap;

/// A segment of a parting, on the map and on the scalp.
#[derive(Clone, Copy, Debug)]
pub(super) struct PartingSegment {
    pub(super) flat: [Vec2; 2],
    pub(super) ends: [Vec3; 2],
    /// Direction off the scalp.
    up: Vec3,
    /// Half the width of its parting, cm.
    pub(super) half_width: f32,
    pub(super) parting: u32,
    /// Fraction along its parting.
    pub(super) along: f32,
}

/// The segments of all partings, indexed by cell and by position in space.
pub(super) struct Lines {
    pieces: Vec<PartingSegment>,
    /// Start of each cell's segments in `listed`: those in the cell and in the cells around it.
    starts: Vec<u32>,
    listed: Vec<u32>,
    /// The segment nearest to each cell's centre, or [`NONE`], and its distance, cm.
    nearest: Vec<u32>,
    clear: Vec<f32>,
    /// Segments indexed by position in space, for points that are near one in space but not on the map, as on an ear.
    places: Places,
}

/// Lines, and the sections between them, as somebody looks at them who may note where.
#[derive(Clone, Copy)]
pub(super) struct LinesView<'a> {
    lines: &'a Lines,
    labels: &'a [u32],
    reads: Option<&'a Reads>,
}

/// A cell of the map that is looked at, and with it those around it.
#[derive(Clone, Copy)]
pub(super) struct MapCell<'a> {
    seen: LinesView<'a>,
    number: usize,
}

/// Direction off the scalp at each point of a line: the mean of the normals around it, weighted by proximity. A fold
/// that the line crosses has no side of its own.
pub(crate) fn off_the_scalp(scalp: &Scalp, line: &[Vec3]) -> Vec<Vec3> {
    /// Distance along the line over which they count, head units.
    const REACH: f32 = 0.8;
    let reach = REACH * scalp.frame().unit();
    let normal = |p: &Vec3| scalp.closest_root(*p).map_or(Vec3::ZERO, |root| root.normal);
    let normals: Vec<Vec3> = line.iter().map(normal).collect();
    let mean = |k: usize| {
        let one = |i: usize| {
            let near = 1.0 - line[i].distance(line[k]) / reach;
            (near > 0.0).then(|| normals[i] * near)
        };
        let after = (k..line.len()).map_while(one);
        let before = (0..k).rev().map_while(one);
        after.chain(before).sum::<Vec3>().try_normalize().unwrap_or(normals[k])
    };
    (0..line.len()).map(mean).collect()
}

impl PartingSegment {
    /// Whether the straight segment between two points crosses this piece, or comes as near to the plane between its
    /// sides as the fraction `near` of half its width, at most `off` (cm) off it.
    fn is_passed(&self, from: Vec3, to: Vec3, near: f32, off: f32) -> bool {
        let near = near * self.half_width;
        let [a, b] = self.ends;
        let along = b - a;
        let aside = self.up.cross(along).normalize_or_zero();
        let (before, after) = ((from - a).dot(aside), (to - a).dot(aside));
        let on = if (before > 0.0) != (after > 0.0) {
            from.lerp(to, before / (before - after)) - a
        } else if before.abs().min(after.abs()) < near {
            if before.abs() < after.abs() { from - a } else { to - a }
        } else {
            return false;
        };
        let t = on.dot(along) / along.length_squared().max(1e-12);
        (0.0..1.0).contains(&t) && on.distance(along * t) < off
    }
}

impl Lines {
    pub(super) fn new(scalp: &Scalp, partings: &[Parting]) -> Self {
        let spread = scalp.chart().spread();
        let mut pieces = vec![];
        for (parting, line) in (0..).zip(partings) {
            let last = line.points.len().saturating_sub(1) as f32;
            let ups = off_the_scalp(scalp, &line.points);
            for (k, w) in line.points.windows(2).enumerate() {
                let ends = [w[0], w[1]];
                let flat = ends.map(|p| spread.flat(p));
                let up = (ups[k] + ups[k + 1]).normalize_or_zero();
                let (along, half_width) = ((k as f32 + 0.5) / last, line.half_width);
                pieces.push(PartingSegment { flat, ends, up, half_width, parting, along });
            }
        }
        let mut starts = vec![0u32; CELLS * CELLS + 1];
        for piece in &pieces {
            covered(&piece.flat, 1).for_each(|cell| starts[cell + 1] += 1);
        }
        for cell in 0..CELLS * CELLS {
            starts[cell + 1] += starts[cell];
        }
        let mut next = starts.clone();
        let mut listed = vec![0; starts[CELLS * CELLS] as usize];
        for (i, piece) in (0..).zip(&pieces) {
            for cell in covered(&piece.flat, 1) {
                listed[next[cell] as usize] = i;
                next[cell] += 1;
            }
        }
        let places = Places::new(&pieces, spread.unit());
        let mut lines = Self { pieces, starts, listed, nearest: vec![], clear: vec![], places };
        lines.near(scalp);
        lines
    }

    /// These lines and the section of each cell, or [`NONE`], seen by who notes in `reads`, if anywhere.
    pub(super) fn seen<'a>(&'a self, labels: &'a [u32], reads: Option<&'a Reads>) -> LinesView<'a> {
        LinesView { lines: self, labels, reads }
    }

    /// All segments, for who cuts.
    pub(super) fn pieces(&self) -> &[PartingSegment] {
        &self.pieces
    }

    /// Finds the nearest segment to every cell: each cell passes its own on to its neighbours, forward and back.
    fn near(&mut self, scalp: &Scalp) {
        let spots = scalp.chart().spots();
        let mut best = vec![(FAR * FAR, NONE); CELLS * CELLS];
        for (i, piece) in (0..).zip(&self.pieces) {
            for cell in covered(&piece.flat, 0) {
                let d = square_to(piece.ends, spots[cell].point);
                if (d, i) < best[cell] {
                    best[cell] = (d, i);
                }
            }
        }
        let pass = |best: &mut Vec<(f32, u32)>, cell: usize, others: &[usize]| {
            for other in others {
                let (_, i) = best[*other];
                if i != NONE && i != best[cell].1 {
                    let d = square_to(self.pieces[i as usize].ends, spots[cell].point);
                    if (d, i) < best[cell] {
                        best[cell] = (d, i);
                    }
                }
            }
        };
        for _ in 0..2 {
            for cell in CELLS + 1..CELLS * CELLS {
                let above = cell - CELLS;
                pass(&mut best, cell, &[cell - 1, above, above - 1, above + 1]);
            }
            for cell in (0..CELLS * CELLS - CELLS - 1).rev() {
                let below = cell + CELLS;
                pass(&mut best, cell, &[cell + 1, below, below + 1, below - 1]);
            }
        }
        self.clear = best.iter().map(|(d, _)| d.sqrt()).collect();
        self.nearest = best.into_iter().map(|(_, i)| i).collect();
    }

    /// Digests of these lines and of the sections with these ids, for each part of the map and of space: everything
    /// that queries of a cell, with its neighbours, and of a place can find.
    pub(super) fn digests(&self, labels: &[u32], ids: impl Fn(u32) -> u64, widest: f32) -> Digests {
        let piece = |piece: &PartingSegment| {
            let PartingSegment { flat, ends, up, half_width, .. } = piece;
            let key = KeyBuilder::new("piece").float(*half_width).vec3(*up);
            let key = ends.iter().fold(key, |key, end| key.vec3(*end));
            flat.iter().fold(key, |key, q| key.float(q.x).float(q.y)).finish()
        };
        let pieces: Vec<Key> = self.pieces.iter().map(piece).collect();
        let of = |i: u32| pieces.get(i as usize).copied().unwrap_or_default();
        let mut tiles: Vec<KeyBuilder> =
            (0..Digests::COUNT).map(|_| KeyBuilder::new("tile")).collect();
        for cell in 0..CELLS * CELLS {
            let near = of(self.nearest[cell]);
            let clear = self.clear[cell].to_bits();
            let key = |key: KeyBuilder| {
                let key = key.int(ids(labels[cell])).key(near).int(u64::from(clear));
                self.seen(labels, None)
                    .cell(cell)
                    .listed()
                    .iter()
                    .fold(key, |key, i| key.key(of(*i)))
            };
            let tile = &mut tiles[Digests::tile(cell)];
            *tile = key(std::mem::replace(tile, KeyBuilder::new("")));
        }
        let mut blocks: BTreeMap<_, KeyBuilder> = BTreeMap::new();
        for (place, listed) in self.places.each() {
            let block = blocks.entry(block_of(place)).or_insert_with(|| KeyBuilder::new("block"));
            let key = std::mem::replace(block, KeyBuilder::new(""));
            let key = place.iter().fold(key, |key, x| key.int(*x as u64));
            *block = listed.iter().fold(key, |key, i| key.key(of(*i)));
        }
        Digests {
            tiles: tiles.into_iter().map(KeyBuilder::finish).collect(),
            blocks: blocks.into_iter().map(|(block, key)| (block, key.finish())).collect(),
            common: KeyBuilder::new("common").float(self.places.side()).float(widest).finish(),
        }
    }

    pub(super) fn bytes(&self) -> usize {
        self.pieces.len() * size_of::<PartingSegment>()
            + 4 * (self.starts.len() + self.listed.len() + self.nearest.len() + self.clear.len())
            + self.places.bytes()
    }
}

/// All that is told by place goes through [`LinesView::cell`], [`LinesView::near_place`] and [`LinesView::are_empty`], which note it.
/// What a segment is needs no note: its number comes from one of them.
impl<'a> LinesView<'a> {
    /// A cell of the map.
    #[inline]
    pub(super) fn cell(self, number: usize) -> MapCell<'a> {
        if let Some(reads) = self.reads {
            reads.cell(number);
        }
        MapCell { seen: self, number }
    }

    /// The segments near a point in space: all within half a place, and some slightly farther.
    #[inline]
    pub(super) fn near_place(self, p: Vec3) -> &'a [u32] {
        let place = place_of(p, self.lines.places.side());
        if let Some(reads) = self.reads {
            reads.places(place, place);
        }
        self.lines.places.near(place)
    }

    /// Whether a quick test shows that no segment is near any point of a box.
    fn are_empty(self, low: Vec3, high: Vec3) -> bool {
        /// Larger boxes (in places) are not tested.
        const LARGE: u32 = 8;
        let places = &self.lines.places;
        let (low, high) = (place_of(low, places.side()), place_of(high, places.side()));
        if (0..3).any(|k| high[k].abs_diff(low[k]) > LARGE) {
            return false;
        }
        if let Some(reads) = self.reads {
            reads.places(low, high);
        }
        places.are_empty(low, high)
    }

    /// A segment by its number; `None` for [`NONE`].
    #[inline]
    pub(super) fn piece(self, number: u32) -> Option<&'a PartingSegment> {
        self.lines.pieces.get(number as usize)
    }

    /// Largest distance from a segment at which hair counts as crossing it, cm.
    pub(super) fn half_place(self) -> f32 {
        self.lines.places.half()
    }

    /// Half the width of the parting of a segment, cm; 0 for none.
    pub(super) fn half_width(self, piece: u32) -> f32 {
        self.piece(piece).map_or(0.0, |piece| piece.half_width)
    }

    /// The segments that lie between the centres of two neighbours.
    pub(super) fn between(self, a: usize, b: usize) -> impl Iterator<Item = &'a PartingSegment> {
        let (p, q) = (middle(a), middle(b));
        let pieces = self.cell(a).listed().iter().filter_map(move |i| self.piece(*i));
        pieces.filter(move |piece| cross(p, q, piece.flat[0], piece.flat[1]))
    }

    /// The label of a cell whose centre can be reached from a point of the map without crossing a parting.
    pub(super) fn label_at(self, q: Vec2) -> Option<u32> {
        let own = self.cell(cell_of(q)?);
        let reached = |(cell, label): (usize, u32)| {
            let to = middle(cell);
            let open = |i: &u32| {
                let [a, b] = self.lines.pieces[*i as usize].flat;
                !cross(q, to, a, b)
            };
            (label != NONE && own.listed().iter().all(open)).then_some(label)
        };
        reached((own.number, own.label())).or_else(|| own.labels_around().find_map(reached))
    }

    /// The sections on the left and on the right of a segment.
    pub(super) fn sides(self, piece: &PartingSegment) -> [Option<u32>; 2] {
        let [a, b] = piece.flat;
        let (middle, aside) = ((a + b) * 0.5, (b - a).perp().normalize_or_zero() * CELL);
        // Where two lines coincide, nothing is between them.
        let on =
            |way: Vec2| [0.3, 0.8, 1.5].iter().find_map(|far| self.label_at(middle + way * *far));
        [aside, -aside].map(on)
    }

    /// The segment whose bare skin is nearest to a point over a cell, and the distance to the segment (not to its bare skin), cm.
    pub(super) fn nearest_at(self, own: Option<usize>, p: Vec3) -> Option<(f32, u32)> {
        let mut best = (FAR, NONE, FAR);
        let mut see = |i: u32| {
            if let Some(piece) = self.piece(i) {
                let distance = square_to(piece.ends, p).sqrt();
                let clear = distance - piece.half_width;
                if clear < best.0 {
                    best = (clear, i, distance);
                }
            }
        };
        // This list has all segments within a cell's width; the cells' own lists have those beyond.
        self.near_place(p).iter().for_each(|i| see(*i));
        if let Some(own) = own {
            let own = self.cell(own);
            own.listed().iter().for_each(|i| see(*i));
            see(own.nearest());
            own.nearest_around().for_each(&mut see);
        }
        (best.1 != NONE).then_some((best.2, best.1))
    }

    /// Whether the straight way between two points of the map crosses a segment.
    pub(super) fn crosses(self, p: Vec2, q: Vec2) -> bool {
        let steps = ((q - p).length() / CELL).ceil().clamp(1.0, 1e4) as usize;
        let crossed = |i: &u32| {
            let [a, b] = self.lines.pieces[*i as usize].flat;
            cross(p, q, a, b)
        };
        let mut cells = (0..=steps).filter_map(|k| cell_of(p.lerp(q, k as f32 / steps as f32)));
        cells.any(|cell| self.cell(cell).listed().iter().any(crossed))
    }

    /// The last of the segments between `n` points in space that crosses a parting, or comes as near to it as the
    /// fraction `aside` of half its width, at most half a place off it; as the index of its end point.
    pub(super) fn last_passed(
        self,
        n: usize,
        at: impl Fn(usize) -> Vec3,
        aside: f32,
    ) -> Option<usize> {
        /// Number of segments tested together, since most are near no parting; and the largest size of their box, in
        /// places.
        const TOGETHER: (usize, f32) = (12, 5.0);
        let half = self.lines.places.half();
        let passes = |from: Vec3, to: Vec3| {
            let parts = (from.distance(to) / (0.4 * half)).ceil().clamp(1.0, 200.0);
            (0..parts as u32).any(|k| {
                let at = |k: u32| from.lerp(to, k as f32 / parts);
                let (a, b) = (at(k), at(k + 1));
                let near = self.near_place((a + b) * 0.5);
                near.iter().any(|i| self.lines.pieces[*i as usize].is_passed(a, b, aside, half))
            })
        };
        let mut last = n.saturating_sub(1);
        while last > 0 {
            let mut first = last - 1;
            let (a, b) = (at(first), at(last));
            let (mut low, mut high) = (a.min(b), a.max(b));
            while first > 0 && last - first < TOGETHER.0 {
                let p = at(first - 1);
                let wider = (low.min(p), high.max(p));
                if (wider.1 - wider.0).max_element() > TOGETHER.1 * self.lines.places.side() {
                    break;
                }
                ((low, high), first) = (wider, first - 1);
            }
            if !self.are_empty(low, high)
                && let Some(k) = (first..last).rev().find(|k| passes(at(*k), at(k + 1)))
            {
                return Some(k + 1);
            }
            last = first;
        }
        None
    }
}

impl<'a> MapCell<'a> {
    /// Index of its section, or [`NONE`].
    #[inline]
    pub(super) fn label(self) -> u32 {
        self.seen.labels[self.number]
    }
    /// The segments in it and in the cells around it.
    #[inline]
    pub(super) fn listed(self) -> &'a [u32] {
        let Lines { starts, listed, .. } = self.seen.lines;
        &listed[starts[self.number] as usize..starts[self.number + 1] as usize]
    }
    /// The segment nearest to its centre, or [`NONE`].
    pub(super) fn nearest(self) -> u32 {
        self.seen.lines.nearest[self.number]
    }
    /// The distance of its centre from that segment, cm.
    #[inline]
    pub(super) fn clear(self) -> f32 {
        self.seen.lines.clear[self.number]
    }
    /// The cells around it, each with its label.
    pub(super) fn labels_around(self) -> impl Iterator<Item = (usize, u32)> {
        around(self.number).map(move |cell| (cell, self.seen.labels[cell]))
    }
    /// The segments nearest to the centres of the cells around it.
    fn nearest_around(self) -> impl Iterator<Item = u32> {
        around(self.number).map(move |cell| self.seen.lines.nearest[cell])
    }
}

/// The cells of the box around a segment, and `more` around it.
pub(super) fn covered(flat: &[Vec2; 2], more: i32) -> impl Iterator<Item = usize> {
    let at = |q: Vec2| ((q / CELL).floor().as_ivec2()) + CELLS as i32 / 2;
    let (a, b) = (at(flat[0].min(flat[1])) - more, at(flat[0].max(flat[1])) + more);
    let last = CELLS as i32 - 1;
    let (low, high) = (a.max(IVec2::ZERO), b.min(IVec2::splat(last)));
    (low.y..=high.y)
        .flat_map(move |y| (low.x..=high.x).map(move |x| y as usize * CELLS + x as usize))
}

/// Squared distance of a point from a segment.
#[inline]
pub(super) fn square_to(segment: [Vec3; 2], p: Vec3) -> f32 {
    p.distance_squared(nearest_on(segment, p).0)
}
