//! A mask as heat on the head, over the picture: blue where there is little, red where it is full.
//!
//! Values are made a part in each frame, so that a frame stays short on any head; what is not yet known shows what was.

use crate::core::projection::Projection;
use crate::scene::heat::{self, LEAST, places};
use coif_nodes::data::field::Field;
use coif_nodes::data::painted::Painted;
use coif_nodes::data::scalp::{Root, Scalp};
use coif_nodes::define::Value;
use coif_nodes::maths::hash::Key;
use egui::epaint::{Mesh, Vertex};
use egui::{Color32, Painter, Pos2, Shape};
use std::sync::Arc;
use std::time::{Duration, Instant};

/// The longest that values are made in one frame.
const A_FRAME: Duration = Duration::from_millis(4);
/// Values that are made between two looks at the clock.
const AT_ONCE: usize = 256;
/// How much of what lies under it heat hides, of 255: hair stays in sight where a mask is full.
const OPACITY: f32 = 95.0;

/// Heat on one head.
#[derive(Default)]
pub(super) struct Heat {
    /// The head that the places are on.
    head: Option<Key>,
    /// What is shown.
    field: Option<Arc<Field>>,
    key: Option<Key>,
    places: Vec<Root>,
    triangles: Vec<[u32; 3]>,
    values: Vec<f32>,
    /// The next value to be made, and how many are older than the field.
    next: usize,
    old: usize,
}

impl Heat {
    /// Shows this field from now on; none: as it was. Tells whether there is more to be made in the next frame.
    pub(super) fn follow(&mut self, field: Option<Arc<Field>>, scalp: &Arc<Scalp>) -> bool {
        let head = scalp.whole();
        if self.head != Some(head) {
            let (places, triangles) = places(scalp);
            let values = vec![0.0; places.len()];
            *self = Self { head: Some(head), places, triangles, values, ..Self::default() };
        }
        if let Some(field) = field {
            let key = Value::Field(field.clone()).key();
            if self.key != Some(key) {
                (self.key, self.field, self.old) = (Some(key), Some(field), self.places.len());
            }
        }
        let Some(field) = self.field.clone() else { return false };
        match &*field {
            Field::Painted(painted) => self.make(painted),
            field => {
                self.values.fill(field.constant().unwrap_or(0.0).clamp(0.0, 1.0));
                self.old = 0;
            }
        }
        self.old > 0
    }

    /// Makes values for a while, on from where the last frame ended.
    fn make(&mut self, painted: &Painted) {
        let began = Instant::now();
        while self.old > 0 && began.elapsed() < A_FRAME {
            let from = if self.next >= self.places.len() { 0 } else { self.next };
            let to = (from + AT_ONCE.min(self.old)).min(self.places.len());
            // What cannot be read is told by the node.
            if let Ok(values) = painted.on(&self.places[from..to]) {
                self.values[from..to].copy_from_slice(&values);
            }
            (self.next, self.old) = (to, self.old - (to - from));
        }
    }

    /// Paints it over the picture.
    pub(super) fn paint(&self, painter: &Painter, view: &Projection) {
        if self.values.iter().all(|x| *x < LEAST) {
            return;
        }
        let screen: Vec<Option<Pos2>> =
            self.places.iter().map(|place| view.screen(place.point)).collect();
        let mut mesh = Mesh::default();
        let mut given = vec![u32::MAX; self.places.len()];
        for corners in &self.triangles {
            let values = corners.map(|i| self.values[i as usize]);
            let [Some(a), Some(b), Some(c)] = corners.map(|i| screen[i as usize]) else { continue };
            let ((ab, ac), shown) = ((b - a, c - a), values.iter().any(|x| *x >= LEAST));
            // Counter-clockwise from outside: with y down the other way round.
            if !shown || ab.x * ac.y - ab.y * ac.x >= 0.0 {
                continue;
            }
            for (corner, pos) in corners.iter().zip([a, b, c]) {
                let at = *corner as usize;
                if given[at] == u32::MAX {
                    given[at] = mesh.vertices.len() as u32;
                    let (uv, color) = (egui::epaint::WHITE_UV, colour(self.values[at]));
                    mesh.vertices.push(Vertex { pos, uv, color });
                }
                mesh.indices.push(given[at]);
            }
        }
        painter.add(Shape::mesh(mesh));
    }

    /// Whether all of it is as new as the field.
    #[cfg(test)]
    pub(super) fn is_done(&self) -> bool {
        self.old == 0
    }

    /// The value at the place nearest to a point, for tests.
    #[cfg(test)]
    pub(super) fn near(&self, p: glam::Vec3) -> f32 {
        let far = |i: &usize| self.places[*i].point.distance_squared(p);
        let nearest = (0..self.places.len()).min_by(|a, b| far(a).total_cmp(&far(b)));
        nearest.map_or(0.0, |i| self.values[i])
    }
}

/// What is 0 is not seen.
fn colour(value: f32) -> Color32 {
    let [r, g, b] = heat::colour(value);
    let alpha = OPACITY * (value * 5.0).clamp(0.0, 1.0);
    Color32::from_rgba_unmultiplied(r, g, b, alpha as u8)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_full_mask_lets_most_of_the_hair_through() {
        let alpha = |value| f32::from(colour(value).a()) / 255.0;
        assert_eq!(alpha(0.0), 0.0);
        assert!(alpha(0.5) > 0.25 && alpha(1.0) < 0.4, "{} {}", alpha(0.5), alpha(1.0));
    }
}
