//! The hairline of a head, shown while strokes are drawn, and by the hair tools until there is hair: on a bald head, nothing else says
//! where hair grows.
//!
//! It is found once a head, as pieces of straight lines across the triangles in which the region passes one half.

use crate::core::projection::Projection;
use coif_nodes::data::scalp::Scalp;
use coif_nodes::maths::hash::Key;
use egui::{Color32, Painter, Stroke};
use glam::{Vec2, Vec3};

/// The hairline of the head that was seen last.
#[derive(Default)]
pub(super) struct Hairline {
    of: Option<Key>,
    pieces: Vec<Piece>,
}

/// A piece of it, and the skin's normal there.
struct Piece {
    ends: [Vec3; 2],
    normal: Vec3,
}

/// So far out of the skin it is drawn, cm: eyes see it on the head, not in it.
const OVER: f32 = 0.03;
const COLOUR: Color32 = Color32::from_rgb(235, 196, 138);

impl Hairline {
    /// Paints what of it faces the eye.
    pub(super) fn paint(&mut self, painter: &Painter, view: &Projection, scalp: &Scalp) {
        let key = scalp.whole();
        if self.of != Some(key) {
            (self.of, self.pieces) = (Some(key), pieces(scalp));
        }
        let eye = view.camera.eye;
        for Piece { ends, normal } in &self.pieces {
            if (eye - ends[0]).dot(*normal) <= 0.0 {
                continue;
            }
            let [a, b] = ends.map(|end| view.screen(end + *normal * OVER));
            if let (Some(a), Some(b)) = (a, b) {
                painter.line_segment([a, b], Stroke::new(1.5, COLOUR));
            }
        }
    }
}

/// Where the region passes one half.
fn pieces(scalp: &Scalp) -> Vec<Piece> {
    const CORNERS: [Vec2; 3] = [Vec2::ZERO, Vec2::X, Vec2::Y];
    let surface = scalp.surface();
    let mut pieces = vec![];
    for (number, _) in surface.triangles.iter().enumerate() {
        let triangle = number as u32;
        let grows = CORNERS.map(|bary| scalp.grows(triangle, bary) - 0.5);
        let points = surface.corners(triangle);
        let crossing = |(a, b): (usize, usize)| {
            let (from, to) = (grows[a], grows[b]);
            let share = from / (from - to);
            ((from < 0.0) != (to < 0.0)).then(|| points[a].lerp(points[b], share))
        };
        let mut ends = [(0, 1), (1, 2), (2, 0)].into_iter().filter_map(crossing);
        if let (Some(a), Some(b)) = (ends.next(), ends.next()) {
            pieces.push(Piece { ends: [a, b], normal: surface.face_normal(triangle) });
        }
    }
    pieces
}

#[cfg(test)]
mod tests {
    use crate::rooms::pen::tests::{draw_on, head};

    #[test]
    fn a_bald_head_shows_its_hairline_over_the_brow_while_rows_or_hair_are_drawn() {
        let mut table = draw_on(head());
        table.rest();
        let shown = table.editor().state.shown.clone().expect("a head");
        let scalp = shown.scalp().expect("a head");
        let pieces = super::pieces(scalp);
        let is_front = |at: glam::Vec3| at.x.abs() < 1.0 && at.y > 2.0 && at.z > 3.0;
        let front = pieces.iter().filter(|piece| is_front(scalp.given(piece.ends[0]))).count();
        assert!(front > 2, "{front} of {}", pieces.len());
        for piece in &pieces {
            let hit = scalp.closest_root(piece.ends[0]).expect("skin");
            assert!(hit.point.distance(piece.ends[0]) < 1e-3);
        }
        // And it is painted.
        let colours = |table: &mut crate::rooms::pen::tests::Table| {
            let shapes = table.harness.output().shapes.iter();
            let is = |shape: &&egui::epaint::ClippedShape| matches!(&shape.shape, egui::Shape::LineSegment { stroke, .. } if stroke.color == super::COLOUR);
            shapes.filter(is).count()
        };
        assert!(colours(&mut table) > 20);
        table.editor().act("hair.implant");
        table.rest();
        assert!(colours(&mut table) > 20, "before the first hair");
        table.editor().act("pen.select");
        table.rest();
        assert_eq!(colours(&mut table), 0);
    }
}
