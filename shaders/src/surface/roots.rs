//! How densely hair is rooted, in a grid around all roots: the skin between dense roots looks darker, partings do not.
//!
//! Guarantees: where roots are even, what is read on the skin is their density, whatever way it faces and wherever it lies
//! between the middles of cells, within a tenth; three cells beside the last root there is nothing. The same bits for
//! the same roots in the same order.

use coif_nodes::data::attributes::COLOUR;
use coif_nodes::data::curves::Curves;
use glam::Vec3;

/// Roots on a square centimetre that are as dense as can be seen: a full head of hair.
const FULL: f32 = 120.0;
/// What cells of 255 have, in full heads: more than hair grows, for a cell that is cut off would show in its neighbours.
/// A twin of `MOST_ROOTS` in `skin.wgsl`.
const MOST: f32 = 3.0;
/// How far roots are blurred by default, cm: less than half a parting's width.
pub const SPREAD: f32 = 0.12;
/// The most cells of a grid; larger heads get larger cells.
const MOST_CELLS: f32 = 6.0e6;
/// A cell's size over the distance that roots are blurred over.
const CELL_OVER_SPREAD: f32 = 1.1;

/// Density of roots in cells, x fastest.
#[derive(Clone, Debug, PartialEq)]
pub struct RootGrid {
    /// Lower corner of the first cell, cm.
    pub lower: Vec3,
    /// Size of a cell, cm.
    pub cell: f32,
    /// Cells along x, y and z.
    pub size: [u32; 3],
    /// 0 without roots, 255 where they are three times as dense as on a full head.
    pub values: Vec<u8>,
    /// How dark the hair is at its roots: 0 white, 1 black. Scales the tint: the roots of fair hair hardly show.
    pub darkness: f32,
}

impl RootGrid {
    /// The grid of these curves' first points, blurred over `spread` cm; none without roots or for a spread that is not over 0. Each
    /// root stands for so many of the final hair ([`crate::Look::stands_for`]), which lie as much farther around it as there are more.
    pub fn of(curves: &Curves, spread: f32, stands_for: f32) -> Option<Self> {
        let first = curves.each().filter_map(|(tuft, i)| tuft.curve(i).first().copied());
        let roots: Vec<Vec3> = first.filter(|p| p.is_finite()).collect();
        let one = *roots.first()?;
        if !(spread.is_finite() && spread > 0.0) {
            return None;
        }
        let (least, most) = roots.iter().fold((one, one), |(lo, hi), p| (lo.min(*p), hi.max(*p)));
        let extent = most - least;
        let mut cell = spread * stands_for.sqrt() * CELL_OVER_SPREAD;
        // Three cells around, so that what is blurred and read fades before the grid ends.
        let count = |cell: f32| (extent / cell).floor() + 7.0;
        while count(cell).element_product() > MOST_CELLS {
            cell *= 1.1;
        }
        // Odd, never a power of two: software adapters compile shaders anew for those.
        let size = count(cell).to_array().map(|n| n as u32 | 1);
        let lower = least - cell * 3.0;
        let counts = spread_out(&roots, lower, cell, size);
        // A root on a flat skin gives its weight to layers of cells across it; what the quadratic B-spline reads of them on
        // the skin is on average the middle value of the quintic one, 11 / 20.
        let scale = stands_for * 255.0 / (MOST * FULL * cell * cell * (11.0 / 20.0));
        let values = counts.into_iter().map(|n| (n * scale + 0.5).min(255.0) as u8).collect();
        Some(Self { lower, cell, size, values, darkness: darkness(curves) })
    }
}

/// Weights of a cell's neighbour before it, itself and the one behind, `t` from its middle (-0.5 to 0.5).
fn quadratic(t: f32) -> [f32; 3] {
    [0.5 * (0.5 - t) * (0.5 - t), 0.75 - t * t, 0.5 * (0.5 + t) * (0.5 + t)]
}

/// Every root spread over 27 cells by the quadratic B-spline, which adds up to 1 wherever the root lies in its cell.
fn spread_out(roots: &[Vec3], lower: Vec3, cell: f32, size: [u32; 3]) -> Vec<f32> {
    let [row, rows, layers] = size.map(|n| n as usize);
    let layer = row * rows;
    let mut counts = vec![0.0; layer * layers];
    let inverse = 1.0 / cell;
    for p in roots {
        let at = (*p - lower) * inverse;
        let own = at.floor();
        let off = at - own - 0.5;
        let [x, y, z] = off.to_array().map(quadratic);
        // The margin keeps all neighbours within the grid.
        let [i, j, k] = own.to_array().map(|n| n as usize - 1);
        let first = i + j * row + k * layer;
        for (k, wz) in z.into_iter().enumerate() {
            for (j, wy) in y.into_iter().enumerate() {
                let start = first + k * layer + j * row;
                for (count, wx) in counts[start..start + 3].iter_mut().zip(x) {
                    *count += wx * wy * wz;
                }
            }
        }
    }
    counts
}

/// One less the root of the mean luminance of up to some thousand roots: roughly how dark they look.
fn darkness(curves: &Curves) -> f32 {
    let stride = (curves.curve_count() / 4096).max(1);
    let mut sum = 0.0;
    let mut count = 0.0;
    for (tuft, i) in curves.each().step_by(stride) {
        let range = tuft.range(i);
        if !range.is_empty() {
            let colour = tuft.view(COLOUR).at(i, range.start);
            sum += super::luminance(colour).clamp(0.0, 1.0);
            count += 1.0;
        }
    }
    if count > 0.0 { 1.0 - (sum / count).sqrt() } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use coif_nodes::data::attributes::Domain;
    use coif_nodes::data::curves::TuftBuilder;
    use coif_nodes::maths::low_discrepancy::r2;
    use std::sync::Arc;

    fn rooted(points: impl IntoIterator<Item = Vec3>) -> Curves {
        let mut b = TuftBuilder::new();
        points.into_iter().for_each(|p| b.push_curve(&[p, p + Vec3::Y]));
        Curves::new(b.build().split())
    }

    /// What the quadratic B-spline reads of the grid at `p`, in full heads, as `skin.wgsl` does it.
    fn read(grid: &RootGrid, p: Vec3) -> f32 {
        let at = (p - grid.lower) / grid.cell;
        let off = at - at.floor() - 0.5;
        let weights = off.to_array().map(quadratic);
        let mut sum = 0.0;
        for cell in 0..27 {
            let step = [cell % 3, cell / 3 % 3, cell / 9];
            let most = Vec3::from(grid.size.map(|n| n as f32 - 1.0));
            let of = at.floor() + Vec3::from(step.map(|n| n as f32 - 1.0));
            let [i, j, k] = of.clamp(Vec3::ZERO, most).to_array().map(|n| n as usize);
            let share: f32 = (0..3).map(|axis| weights[axis][step[axis]]).product();
            let [row, rows, _] = grid.size.map(|n| n as usize);
            sum += share * f32::from(grid.values[(k * rows + j) * row + i]) / 255.0 * MOST;
        }
        sum
    }

    /// 4 x 4 cm of roots, 96 on a square centimetre, in a plane with these axes.
    fn patch(x: Vec3, y: Vec3) -> impl Iterator<Item = Vec3> {
        (0..1536u32).map(move |i| {
            let [u, v] = r2(i, [0.0; 2]);
            x * (u * 4.0 - 2.0) + y * (v * 4.0 - 2.0)
        })
    }

    #[test]
    fn a_cell_holds_the_density_of_roots_whatever_way_the_skin_faces() {
        for (x, y) in [
            (Vec3::X, Vec3::Y),
            (Vec3::Z, Vec3::X),
            (Vec3::new(1.0, 1.0, 0.0).normalize(), Vec3::Z),
            (Vec3::new(1.0, 1.0, 1.0).normalize(), Vec3::new(1.0, -1.0, 0.0).normalize()),
        ] {
            // A root below moves the cells' middles against the skin.
            for below in [0.0, 0.61, 0.63, 0.65, 0.67, 0.69, 0.71] {
                let below = x.cross(y) * -below;
                let grid = RootGrid::of(&rooted(patch(x, y).chain([below])), SPREAD, 1.0).unwrap();
                let mut sum = 0.0;
                for k in 0..100 {
                    let [u, v] = r2(k, [0.0; 2]);
                    sum += read(&grid, x * (u * 2.0 - 1.0) + y * (v * 2.0 - 1.0));
                }
                let found = sum / 100.0 / (96.0 / FULL);
                assert!((found - 1.0).abs() < 0.1, "{x} {y} {below}: {found}");
                assert!(read(&grid, x * 2.4) < 0.02);
            }
        }
    }

    #[test]
    fn a_parting_stays_skin() {
        let apart = |p: &Vec3| p.x.abs() > 0.15;
        let grid =
            RootGrid::of(&rooted(patch(Vec3::X, Vec3::Z).filter(apart)), SPREAD, 1.0).unwrap();
        let mean = |x: f32| {
            let all = (0..40).map(|k| read(&grid, Vec3::new(x, 0.0, k as f32 * 0.05 - 1.0)));
            all.sum::<f32>() / 40.0
        };
        assert!(mean(0.0) < 0.15 * mean(1.0), "{} {}", mean(0.0), mean(1.0));
        assert!(mean(0.4) > 0.8 * mean(1.0), "{} {}", mean(0.4), mean(1.0));
    }

    #[test]
    fn roots_that_are_no_places_are_no_roots() {
        assert_eq!(RootGrid::of(&Curves::default(), SPREAD, 1.0), None);
        assert_eq!(RootGrid::of(&rooted([Vec3::splat(f32::NAN)]), SPREAD, 1.0), None);
        assert_eq!(RootGrid::of(&rooted([Vec3::ONE]), 0.0, 1.0), None);
        assert_eq!(RootGrid::of(&rooted([Vec3::ONE]), f32::NAN, 1.0), None);
        let one =
            RootGrid::of(&rooted([Vec3::ONE, Vec3::splat(f32::INFINITY)]), SPREAD, 1.0).unwrap();
        assert_eq!(one.size, [7, 7, 7]);
        // Far apart: larger cells, not more memory.
        let far = RootGrid::of(&rooted([Vec3::ZERO, Vec3::splat(900.0)]), SPREAD, 1.0).unwrap();
        assert!(far.values.len() <= MOST_CELLS as usize && far.cell > 5.0);
    }

    #[test]
    fn fair_roots_are_no_dark_roots() {
        let mut b = TuftBuilder::new();
        b.push_curve(&[Vec3::ZERO, Vec3::Y]);
        b.set(COLOUR, Domain::Curve, vec![Vec3::splat(0.64)]);
        let fair = Curves::new(vec![Arc::new(b.build())]);
        assert!((RootGrid::of(&fair, SPREAD, 1.0).unwrap().darkness - 0.2).abs() < 1e-5);
    }
}
