//! Meshes on which hair is not routed around the skin: folded all over, far larger than a scalp, in hundreds of parts, or
//! tangled.
//!
//! The class depends on surface and region alone, so it is known before hair grows. Routing pays only where thousands of hairs
//! pass the same ear, which none of these meshes has. On wide meshes hair is pushed out; on folded ones only guides are
//! ([`super::skin::Skin::for_hair`]), and no farther than to their nearest side; strewn and tangled meshes have no inside, and
//! nothing is kept out of them. Steps over all but wide meshes test few triangles ([`super::skin::Skin::foot`]), and hair between
//! rows runs straight where there is no inside.

use super::scalp::HEAD_RADIUS;
use crate::maths::closest::Surface;
use glam::Vec2;

/// Why hair is not routed around the skin of a mesh.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Rough {
    /// More than a quarter of the region faces other skin within the radius of a head, as in crumpled cloth, leaves, many layers
    /// or a whole dressed figure (heads have 2 %).
    Folded,
    /// The region is larger than [`WIDE`], and not folded.
    Wide,
    /// The region has at least [`SCRAPS`] parts of similar size: leaves, cards or confetti.
    Strewn,
    /// So many triangles intersect that nothing has an inside: see [`Surface::is_tangled`].
    Tangled,
}

/// Area above which a region is wide, cm2 on a head of average size, which has 600 to 900.
pub const WIDE: f32 = 5000.0;
/// Number of parts from which a region counts as strewn; for parts of different sizes, the effective number by area.
pub const SCRAPS: f64 = 200.0;
/// Number of samples of the region that are tested for facing skin.
const LOOKS: u32 = 400;
/// Distance within which skin counts as facing, head units.
const FACED: f32 = HEAD_RADIUS;

impl Rough {
    /// The class of a surface with hair on a `region` (0 to 1 per vertex), if it is rough; `unit` is a head unit in cm.
    pub fn of(surface: &Surface, region: &[f32], unit: f32) -> Option<Self> {
        if surface.is_tangled() {
            return Some(Self::Tangled);
        }
        let area = |t: u32| {
            let [a, b, c] = surface.triangles[t as usize].map(|v| region[v as usize]);
            f64::from(surface.area_vector(t).length()) * f64::from(a.max(b).max(c).min(1.0))
        };
        let areas: Vec<f64> = (0..surface.triangles.len() as u32).map(area).collect();
        let sum = areas.iter().sum::<f64>();
        if is_strewn(surface, &areas, sum) {
            return Some(Self::Strewn);
        }
        if is_folded(surface, &areas, sum / f64::from(LOOKS), FACED * unit) {
            return Some(Self::Folded);
        }
        (0.5 * sum > f64::from(WIDE * unit * unit)).then_some(Self::Wide)
    }
}

/// Whether these areas, one per triangle with the sum `sum`, form [`SCRAPS`] parts or more of similar size.
fn is_strewn(surface: &Surface, areas: &[f64], sum: f64) -> bool {
    let mut to: Vec<u32> = (0..surface.points.len() as u32).collect();
    fn first(to: &mut [u32], mut v: u32) -> u32 {
        while to[v as usize] != v {
            to[v as usize] = to[to[v as usize] as usize];
            v = to[v as usize];
        }
        v
    }
    for [a, b, c] in &surface.triangles {
        for v in [b, c] {
            let (x, y) = (first(&mut to, *a), first(&mut to, *v));
            to[x.max(y) as usize] = x.min(y);
        }
    }
    let mut parts = vec![0.0; to.len()];
    for ([a, ..], area) in surface.triangles.iter().zip(areas) {
        parts[first(&mut to, *a) as usize] += area;
    }
    parts.iter().map(|part| part * part).sum::<f64>() * SCRAPS < sum * sum
}

/// Whether more than a quarter of these areas face skin within `reach`, by one sample per `each` of area.
fn is_folded(surface: &Surface, areas: &[f64], each: f64, reach: f32) -> bool {
    let (mut sum, mut next) = (0.0, 0.5 * each);
    let (mut looks, mut faced) = (0, 0);
    for (triangle, area) in (0..).zip(areas) {
        sum += area;
        while sum > next && looks < LOOKS {
            next += each;
            let out = surface.face_normal(triangle);
            let from = surface.at(triangle, Vec2::splat(1.0 / 3.0)) + out * (0.01 * reach);
            looks += 1;
            faced += u32::from(surface.ray_meets(from, out, reach));
        }
    }
    4 * faced > looks
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::patience::Patience;
    use crate::data::route::skin_clear::tests::{bust, hairs};
    use crate::data::scalp::{HeadFrame, REGION, Scalp};
    use crate::maths::transcendental::sin_cos_turns;
    use glam::Vec3;

    fn of(surface: Surface) -> Scalp {
        let everywhere = [(REGION.to_owned(), vec![1.0; surface.points.len()])].into();
        Scalp::new(surface, None, HeadFrame::IDENTITY, everywhere)
    }

    /// Strips of so many cm across and 40 long, each joined to the next, that lie flat or zigzag to a height.
    fn strips(count: u32, up: f32, across: f32) -> Surface {
        let at =
            |k: u32| Vec3::new(k as f32 * across, if k.is_multiple_of(2) { 0.0 } else { up }, 0.0);
        let points = (0..=count).flat_map(|k| [at(k), at(k) + Vec3::Z * 40.0]).collect();
        let quad = |k: u32| [[2 * k, 2 * k + 1, 2 * k + 3], [2 * k, 2 * k + 3, 2 * k + 2]];
        Surface::new(points, (0..count).flat_map(quad).collect())
    }

    /// Upright blades of 20 x 10 cm through the origin, turned evenly about the axis.
    fn blades(count: u32) -> Surface {
        let blade = |k: u32| {
            let (sin, cos) = sin_cos_turns(0.5 * k as f32 / count as f32);
            let side = Vec3::new(cos, 0.0, sin) * 10.0;
            [side, -side, Vec3::Y * 10.0]
        };
        let points = (0..count).flat_map(blade).collect();
        Surface::new(points, (0..count).map(|k| [3 * k, 3 * k + 1, 3 * k + 2]).collect())
    }

    /// So many triangles of 1 cm2 in a row, 4 cm apart, as leaves lie.
    fn scraps(count: u32) -> Surface {
        let corners = |k: u32| [0.0, 1.0].map(|x| Vec3::new(4.0 * k as f32 + x, 0.0, 0.0));
        let scrap = |k: u32| {
            let [a, b] = corners(k);
            [a, a + Vec3::Z * 2.0, b]
        };
        let points = (0..count).flat_map(scrap).collect();
        Surface::new(points, (0..count).map(|k| [3 * k, 3 * k + 1, 3 * k + 2]).collect())
    }

    #[test]
    fn hundreds_of_parts_are_strewn_and_a_head_among_them_is_none() {
        let check = |surface: Surface, rough: Option<Rough>| assert_eq!(of(surface).rough(), rough);
        // Of like size: 300 weigh as 300, and 100 as 100.
        check(scraps(300), Some(Rough::Strewn));
        check(scraps(100), None);
        // A ball of 995 cm2 with 300 scraps of 1 cm2 that hair grows on too: (995 + 300)^2 / (995^2 + 300) = 1.7 parts.
        let (ball, scraps) = (crate::maths::closest::tests::sphere(8.9, 12), scraps(300));
        let first = ball.points.len() as u32;
        let points =
            ball.points.iter().copied().chain(scraps.points.iter().map(|p| *p + Vec3::X * 20.0));
        let moved = scraps.triangles.iter().map(|t| t.map(|v| v + first));
        let triangles = ball.triangles.iter().copied().chain(moved).collect();
        check(Surface::new(points.collect(), triangles), None);
    }

    #[test]
    fn cloth_is_folded_what_is_huge_is_wide_crossing_blades_are_a_tangle_and_heads_are_nothing_of_it()
     {
        let check = |surface: Surface, rough: Option<Rough>| assert_eq!(of(surface).rough(), rough);
        // 20 x 10 x 40 cm2 that lie flat are 8000, and 12 of them 4800.
        check(strips(20, 0.0, 10.0), Some(Rough::Wide));
        check(strips(12, 0.0, 10.0), None);
        // Zigzags of 10 cm, 1 cm apart: 12 x 10.05 x 40.
        check(strips(12, 10.0, 1.0), Some(Rough::Folded));
        // All blades hold the axis: near it, a search that went on would look at each.
        check(blades(2000), Some(Rough::Tangled));
        check(Surface::new(vec![], vec![]), None);
        assert_eq!(bust().rough(), None);
    }

    #[test]
    fn on_a_wide_mesh_hair_makes_no_cells() {
        // 200 hairs of 16 points that dip into 64 strips of 10 x 40 cm: each point in a brick of its own would be 3200 x 600 bytes,
        // and 8 or 9 searches in place of one.
        let scalp = of(strips(64, 0.5, 10.0));
        assert_eq!(scalp.rough(), Some(Rough::Wide));
        let skin = scalp.skin();
        let (before, mut moved) = (scalp.bytes(), 0);
        for k in 0..200 {
            let root = Vec3::new(3.17 * k as f32, 3.0, 0.17 * k as f32);
            let mut hair: Vec<Vec3> =
                (0..16).map(|n| root + Vec3::new(0.3, -0.4, 0.1) * n as f32).collect();
            moved += usize::from(skin.clear(&mut hair, |_| Some(0.0)));
            assert!(hair[1..].iter().all(|p| skin.distance(*p) > -1e-3));
        }
        assert!(moved > 100, "{moved}");
        // `distance` above asks the field within a millimetre only where it is asked; the hair itself notes blocks alone.
        let made = scalp.bytes() - before;
        assert!(made < 4000 * 600, "{made} bytes");
    }

    #[test]
    fn guides_are_kept_out_of_folds_hair_is_not_and_scraps_have_no_inside() {
        // (Whether guides are pushed out, and whether there is a skin for hair.)
        let check = |surface: Surface, guides: bool, hair: bool| {
            let scalp = of(surface);
            let skin = scalp.skin();
            let moved = (0..40).any(|k| {
                let from = Vec3::new(0.1 + 0.25 * k as f32, 2.0, 0.3 + 0.2 * k as f32);
                let mut guide: Vec<Vec3> =
                    (0..9).map(|n| from - Vec3::Y * (0.5 * n as f32)).collect();
                skin.clear(&mut guide, |_| Some(0.0))
            });
            assert_eq!((moved, skin.for_hair().is_some()), (guides, hair), "{:?}", scalp.rough());
        };
        check(strips(12, 0.0, 10.0), true, true);
        check(strips(64, 0.5, 10.0), true, true);
        check(strips(12, 10.0, 1.0), true, false);
        check(scraps(300), false, false);
        check(blades(2000), false, false);
    }

    #[test]
    fn no_more_is_looked_at_than_patience_allows_and_hair_is_out_of_the_skin_all_the_same() {
        let scalp = bust();
        let skin = scalp.skin();
        let led_within = |looks: u64| {
            let patience = Patience::new(looks);
            let near = skin.within(&patience);
            let mut far = 0;
            for mut hair in hairs().into_iter().filter(|hair| skin.distance(hair[0]) > 0.0) {
                let was = hair.clone();
                near.clear(&mut hair, |_| Some(0.0));
                assert!(hair[1..].iter().all(|p| skin.distance(*p) > -1e-3));
                // Ends of the thread that an ear tears apart lie half a cm and more from each other.
                far += usize::from(hair.windows(2).any(|w| w[0].distance(w[1]) > 0.6));
                assert_eq!(was[0], hair[0]);
            }
            (far, looks - patience.left())
        };
        let (torn, looked) = led_within(200_000_000);
        let (torn_at_once, few) = led_within(100);
        assert!(looked > 3000 && few == 100, "{looked} and {few} looks");
        assert!(torn_at_once > torn, "{torn_at_once} and {torn} are torn");
    }
}
