//! Transforms of nodes and joints.
//!
//! Source: glTF 2.0 specification, section 3.5.3. All in doubles, so that a chain of them costs no
//! digit of a coordinate and an identity leaves each as it is in the file.

use super::json::JsonValue;
use crate::data::mesh::MeshError;
use glam::Vec3;

/// A transform: where the axes and the origin go.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Affine {
    axes: [[f64; 3]; 3],
    origin: [f64; 3],
}

impl Affine {
    pub(super) const IDENTITY: Self =
        Self { axes: [[1., 0., 0.], [0., 1., 0.], [0., 0., 1.]], origin: [0.; 3] };

    pub(super) const ZERO: Self = Self { axes: [[0.; 3]; 3], origin: [0.; 3] };

    /// The transform of a node from its `matrix` or its translation, rotation and scale.
    pub(super) fn of_node(node: JsonValue, place: &str) -> Result<Self, MeshError> {
        if let Some(m) = numbers::<16>(node, "matrix", place)? {
            return Ok(Self::of_columns(&m));
        }
        let origin = numbers(node, "translation", place)?.unwrap_or([0.; 3]);
        let scale = numbers(node, "scale", place)?.unwrap_or([1.; 3]);
        let mut axes = match numbers(node, "rotation", place)? {
            Some(rotation) => rotate(rotation),
            None => Self::IDENTITY.axes,
        };
        for (axis, scale) in axes.iter_mut().zip(scale) {
            *axis = axis.map(|x| x * scale);
        }
        Ok(Self { axes, origin })
    }

    fn turn(&self, v: [f64; 3]) -> [f64; 3] {
        let [x, y, z] = self.axes;
        [0, 1, 2].map(|i| x[i] * v[0] + y[i] * v[1] + z[i] * v[2])
    }

    fn place(&self, p: [f64; 3]) -> [f64; 3] {
        let turned = self.turn(p);
        [0, 1, 2].map(|i| turned[i] + self.origin[i])
    }

    /// This one after `inner`.
    pub(super) fn times(&self, inner: &Self) -> Self {
        Self { axes: inner.axes.map(|axis| self.turn(axis)), origin: self.place(inner.origin) }
    }

    /// Where a point goes, rounded once.
    pub(super) fn point(&self, p: [f64; 3]) -> Vec3 {
        Vec3::from_array(self.place(p).map(|x| x as f32))
    }

    /// The transform in the first three rows of a 4 by 4 matrix, which stands column by column.
    pub(super) fn of_columns(m: &[f64; 16]) -> Self {
        let column = |c: usize| [m[4 * c], m[4 * c + 1], m[4 * c + 2]];
        Self { axes: [column(0), column(1), column(2)], origin: column(3) }
    }

    /// All of its numbers, changed.
    pub(super) fn map(&self, f: impl Fn(f64) -> f64) -> Self {
        Self { axes: self.axes.map(|axis| axis.map(&f)), origin: self.origin.map(&f) }
    }

    /// Adds another, number by number.
    pub(super) fn add(&mut self, other: &Self) {
        for (axis, other) in self.axes.iter_mut().zip(other.axes) {
            axis.iter_mut().zip(other).for_each(|(x, other)| *x += other);
        }
        self.origin.iter_mut().zip(other.origin).for_each(|(x, other)| *x += other);
    }

    /// Whether it turns triangles over.
    pub(super) fn mirrors(&self) -> bool {
        let [x, y, z] = self.axes;
        let across = [0, 1, 2].map(|i| {
            let (j, k) = ((i + 1) % 3, (i + 2) % 3);
            x[j] * y[k] - x[k] * y[j]
        });
        across[0] * z[0] + across[1] * z[1] + across[2] * z[2] < 0.0
    }
}

/// The axes after a rotation by a quaternion x, y, z, w of any length but 0.
fn rotate([x, y, z, w]: [f64; 4]) -> [[f64; 3]; 3] {
    let length_squared = x * x + y * y + z * z + w * w;
    if length_squared == 0.0 {
        return Affine::IDENTITY.axes;
    }
    let s = 2.0 / length_squared;
    [
        [1.0 - s * (y * y + z * z), s * (x * y + z * w), s * (x * z - y * w)],
        [s * (x * y - z * w), 1.0 - s * (x * x + z * z), s * (y * z + x * w)],
        [s * (x * z + y * w), s * (y * z - x * w), 1.0 - s * (x * x + y * y)],
    ]
}

fn numbers<const N: usize>(
    node: JsonValue,
    key: &str,
    place: &str,
) -> Result<Option<[f64; N]>, MeshError> {
    let Some(array) = node.get(key) else { return Ok(None) };
    let mut numbers = [0.0; N];
    let mut items = array.items();
    for number in &mut numbers {
        let item = items.next().and_then(JsonValue::number);
        *number = item.ok_or_else(|| {
            MeshError::at(format!("{place}.{key}"), format!("it does not have {N} numbers"))
        })?;
    }
    Ok(Some(numbers))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rotations_turn_as_the_right_hand_does() {
        let half = std::f64::consts::FRAC_1_SQRT_2;
        let axes = rotate([0.0, 0.0, half, half]);
        for (axis, expected) in axes.iter().zip([[0., 1., 0.], [-1., 0., 0.], [0., 0., 1.]]) {
            for i in 0..3 {
                assert!((axis[i] - expected[i]).abs() < 1e-15, "{axes:?}");
            }
        }
        assert_eq!(rotate([0.0; 4]), Affine::IDENTITY.axes);
        // A quaternion that is not quite of length 1 does not scale.
        let axes = rotate([0.0, 3.0, 0.0, 0.0]);
        assert_eq!(axes, [[-1., 0., 0.], [0., 1., 0.], [0., 0., -1.]]);
    }

    #[test]
    fn a_mirror_is_known_by_its_sign() {
        let flip = Affine { axes: [[-1., 0., 0.], [0., 1., 0.], [0., 0., 1.]], ..Affine::IDENTITY };
        assert!(flip.mirrors() && !flip.times(&flip).mirrors() && !Affine::IDENTITY.mirrors());
    }

    #[test]
    fn an_identity_changes_no_bit() {
        let p = Vec3::new(0.1, -3.000_000_2, 1e30);
        let same = Affine::IDENTITY.times(&Affine::IDENTITY);
        assert_eq!(same.point(p.to_array().map(f64::from)), p);
    }
}
