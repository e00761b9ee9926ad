//! Hair by section of the scalp.

use super::hair::{MeasuredHair, quantile};

/// Hair by section.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct HairBySection {
    /// Number of sections with hair.
    pub sections: usize,
    /// Hairs without a section.
    pub without: usize,
    /// Fewest, median and most hairs of a section.
    pub hairs: [usize; 3],
}

/// Hair by section; `None` if no hair carries its section.
pub fn measure(hair: &MeasuredHair) -> Option<HairBySection> {
    let mut section = hair.whole("section")?;
    section.sort_unstable();
    let without = section.iter().filter(|s| **s == 0).count();
    let sizes = section.chunk_by(|a, b| a == b).filter(|c| c[0] != 0).map(<[i64]>::len);
    let mut sizes: Vec<f32> = sizes.map(|n| n as f32).collect();
    sizes.sort_by(f32::total_cmp);
    (!sizes.is_empty()).then(|| HairBySection {
        sections: sizes.len(),
        without,
        hairs: [0.0, 0.5, 1.0].map(|q| quantile(&sizes, q) as usize),
    })
}

#[cfg(test)]
mod tests {
    use super::super::hair::tests::read_of;
    use super::*;
    use crate::eval::PlainHost;
    use crate::formats::usd::read::ReadValues;
    use glam::Vec3;

    #[test]
    fn sections_are_counted() {
        let hair: &[Vec3] = &[Vec3::ZERO, Vec3::Y];
        let hairs = read_of(&[hair; 6], &[("section", ReadValues::Int(vec![0, 4, 4, 9, 4, 0]))]);
        let found = measure(&MeasuredHair::read(&hairs, &PlainHost)).unwrap();
        assert_eq!((found.sections, found.without, found.hairs), (2, 2, [1, 3, 3]));
    }
}
