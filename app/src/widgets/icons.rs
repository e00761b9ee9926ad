//! Icons of tools, drawn as lines: sharp at any scale, in the colours of the text beside them.
//!
//! Each is a few marks in a box of 20 by 20, all of one weight. Strokes are one line with square CVs; hair is several strands,
//! most of them on skin. Guarantees: marks stay inside the box; what is pressed is named for screen readers and tests, with and
//! without its words.

use Mark::{Curve, Dot, Fill, Line, Ring};
use egui::epaint::CubicBezierShape;
use egui::{
    Color32, Painter, Pos2, Rect, Response, Sense, Shape, Stroke, StrokeKind, TextStyle, Ui, Vec2,
    WidgetInfo, WidgetType,
};

/// The side of the box.
const SIDE: f32 = 20.0;
/// How wide lines are in it.
const WEIGHT: f32 = 1.4;

/// A place in the box: from the left, and from the top.
type Place = [f32; 2];

/// A part of an icon.
enum Mark {
    /// A line through places.
    Line(&'static [Place]),
    /// A cubic Bezier curve.
    Curve([Place; 4]),
    /// A circle: its middle and radius.
    Ring(Place, f32),
    /// A disc: its middle and radius.
    Dot(Place, f32),
    /// A convex area.
    Fill(&'static [Place]),
}

/// An icon.
#[derive(Clone, Copy)]
pub(crate) struct Icon(&'static [Mark]);

/// A square CV.
macro_rules! cv {
    ($x:literal, $y:literal) => {
        Fill(&[
            [$x - 1.9, $y - 1.9],
            [$x + 1.9, $y - 1.9],
            [$x + 1.9, $y + 1.9],
            [$x - 1.9, $y + 1.9],
        ])
    };
}

/// Skin that hair is rooted in.
const SKIN: Mark = Curve([[1.5, 18.0], [6.0, 15.6], [14.0, 15.6], [18.5, 18.0]]);

impl Icon {
    /// Draws it into a square.
    fn paint(self, painter: &Painter, at: Rect, colour: Color32) {
        let unit = at.width() / SIDE;
        let place = |[x, y]: Place| at.min + Vec2::new(x, y) * unit;
        let (line, none) = (Stroke::new(WEIGHT * unit, colour), Stroke::NONE);
        for mark in self.0 {
            painter.add(match mark {
                Line(places) => Shape::line(places.iter().map(|p| place(*p)).collect(), line),
                Curve(places) => {
                    let clear = Color32::TRANSPARENT;
                    CubicBezierShape::from_points_stroke(places.map(place), false, clear, line)
                        .into()
                }
                Ring(middle, radius) => Shape::circle_stroke(place(*middle), radius * unit, line),
                Dot(middle, radius) => Shape::circle_filled(place(*middle), radius * unit, colour),
                Fill(corners) => {
                    let corners: Vec<Pos2> = corners.iter().map(|p| place(*p)).collect();
                    Shape::convex_polygon(corners, colour, none)
                }
            });
        }
    }
}

/// Something to choose among others by its icon, with its name beside it where there are to be words.
pub(crate) fn choice(ui: &mut Ui, chosen: bool, icon: Icon, name: &str, words: bool) -> Response {
    let side = ui.spacing().interact_size.y;
    let font = TextStyle::Button.resolve(ui.style());
    let text = |ui: &Ui| ui.painter().layout_no_wrap(name.to_owned(), font, Color32::PLACEHOLDER);
    let text = words.then(|| text(ui));
    let wide = text.as_ref().map_or(0.0, |text| text.size().x + ui.spacing().button_padding.x);
    let (rect, response) = ui.allocate_exact_size(Vec2::new(side + wide, side), Sense::click());
    let info = || WidgetInfo::selected(WidgetType::Button, true, chosen, name);
    response.widget_info(info);
    let visuals = ui.style().interact_selectable(&response, chosen);
    let (painter, colour) = (ui.painter(), visuals.text_color());
    if chosen || response.hovered() || response.has_focus() {
        let (fill, edge) = (visuals.weak_bg_fill, visuals.bg_stroke);
        painter.rect(rect, visuals.corner_radius, fill, edge, StrokeKind::Inside);
    }
    let box_of = Rect::from_min_size(rect.min, Vec2::splat(side)).shrink(2.0);
    icon.paint(painter, box_of, colour);
    if let Some(text) = text {
        let at = Pos2::new(rect.left() + side, rect.center().y - text.size().y / 2.0);
        painter.galley(at, text, colour);
    }
    response
}

pub(crate) const SELECT: Icon = Icon(&[Line(&[
    [5.0, 2.5],
    [5.0, 15.5],
    [8.2, 12.4],
    [10.4, 17.4],
    [12.6, 16.4],
    [10.4, 11.6],
    [14.8, 11.4],
    [5.0, 2.5],
    [5.0, 15.5],
])]);
pub(crate) const STROKE_POINTS: Icon = Icon(&[
    Curve([[3.5, 16.0], [6.0, 6.0], [10.0, 4.0], [16.5, 4.5]]),
    cv!(3.5, 16.0),
    cv!(7.6, 7.6),
    cv!(16.5, 4.5),
    Line(&[[11.5, 11.5], [11.5, 18.0], [13.3, 16.4], [15.6, 16.2], [11.5, 11.5], [11.5, 18.0]]),
]);
pub(crate) const HAIR_POINTS: Icon = Icon(&[
    SKIN,
    Curve([[7.0, 16.4], [4.5, 11.0], [7.0, 5.5], [14.5, 3.0]]),
    Dot([6.3, 12.2], 1.6),
    Dot([8.3, 7.2], 2.6),
    Dot([14.5, 3.0], 1.6),
]);

pub(crate) const DRAW: Icon = Icon(&[
    Line(&[
        [13.5, 2.5],
        [17.5, 6.5],
        [7.5, 16.5],
        [2.8, 17.2],
        [3.5, 12.5],
        [13.5, 2.5],
        [17.5, 6.5],
    ]),
    Line(&[[11.0, 5.0], [15.0, 9.0]]),
]);
pub(crate) const REDRAW_STROKE: Icon = Icon(&[
    cv!(3.5, 15.0),
    cv!(16.5, 15.0),
    Line(&[[7.2, 15.0], [9.0, 15.0]]),
    Line(&[[11.0, 15.0], [12.8, 15.0]]),
    Curve([[3.5, 15.0], [4.5, 0.5], [15.5, 0.5], [16.5, 15.0]]),
]);
pub(crate) const REGION: Icon = Icon(&[
    Curve([[4.0, 9.0], [4.0, 3.5], [11.0, 2.0], [14.5, 4.5]]),
    Curve([[14.5, 4.5], [19.0, 8.0], [17.5, 15.5], [12.0, 16.5]]),
    Curve([[12.0, 16.5], [6.0, 18.0], [4.0, 14.0], [4.0, 9.0]]),
    Line(&[[6.2, 11.6], [12.4, 5.4]]),
    Line(&[[8.0, 14.4], [15.0, 7.4]]),
    Line(&[[12.0, 15.0], [15.8, 11.2]]),
]);
pub(crate) const SKETCH: Icon = Icon(&[
    Line(&[
        [2.5, 17.5],
        [4.5, 9.5],
        [10.0, 4.5],
        [15.5, 10.0],
        [10.5, 15.5],
        [2.5, 17.5],
        [4.5, 9.5],
    ]),
    Line(&[[2.5, 17.5], [8.0, 12.0]]),
    Dot([9.2, 10.8], 1.7),
    Line(&[[12.0, 2.5], [17.5, 8.0]]),
]);
pub(crate) const IMPLANT: Icon = Icon(&[
    SKIN,
    Curve([[8.5, 16.2], [8.0, 10.0], [5.5, 6.5], [6.0, 2.0]]),
    Dot([8.5, 16.2], 2.0),
    Line(&[[14.0, 3.5], [14.0, 10.5]]),
    Line(&[[10.5, 7.0], [17.5, 7.0]]),
]);
pub(crate) const LENGTHEN: Icon = Icon(&[
    SKIN,
    Curve([[6.0, 16.4], [5.5, 12.5], [6.0, 11.5], [8.0, 9.0]]),
    Dot([8.0, 9.0], 2.1),
    Line(&[[10.0, 7.2], [11.6, 5.8]]),
    Line(&[[13.0, 4.8], [16.8, 2.4]]),
    Line(&[[12.6, 2.0], [17.2, 2.2], [15.4, 6.4]]),
]);
pub(crate) const REDRAW_HAIR: Icon = Icon(&[
    SKIN,
    Curve([[6.5, 16.4], [6.3, 12.0], [9.5, 7.2], [17.0, 7.0]]),
    Line(&[[6.9, 10.2], [6.5, 8.4]]),
    Line(&[[6.1, 6.6], [5.7, 4.8]]),
    Line(&[[5.3, 3.2], [5.0, 1.6]]),
    Line(&[[14.2, 4.0], [17.4, 7.0], [14.2, 10.0]]),
]);
pub(crate) const SCATTER: Icon = Icon(&[
    SKIN,
    Curve([[3.5, 17.0], [2.0, 12.0], [2.5, 7.0], [5.0, 3.0]]),
    Curve([[9.0, 16.2], [8.0, 13.0], [8.2, 10.0], [9.8, 7.5]]),
    Curve([[13.0, 16.4], [12.0, 13.6], [12.2, 11.5], [13.6, 9.0]]),
    Curve([[17.0, 17.2], [16.2, 15.2], [16.4, 13.2], [17.6, 11.5]]),
    Dot([9.6, 2.8], 1.1),
    Dot([13.2, 3.8], 1.1),
    Dot([16.6, 5.8], 1.1),
]);
pub(crate) const SILHOUETTE: Icon = Icon(&[
    SKIN,
    Curve([[8.0, 16.2], [0.5, 10.5], [3.5, 5.0], [13.5, 1.5]]),
    Curve([[8.0, 16.2], [16.5, 13.5], [16.5, 6.5], [13.5, 1.5]]),
    Line(&[[8.6, 13.5], [9.4, 11.0]]),
    Line(&[[10.0, 9.0], [10.9, 6.8]]),
]);

pub(crate) const COMB_STROKES: Icon = Icon(&[
    Line(&[[3.0, 3.0], [17.0, 3.0]]),
    Line(&[[3.7, 3.0], [3.7, 9.0]]),
    Line(&[[6.9, 3.0], [6.9, 9.0]]),
    Line(&[[10.0, 3.0], [10.0, 9.0]]),
    Line(&[[13.1, 3.0], [13.1, 9.0]]),
    Line(&[[16.3, 3.0], [16.3, 9.0]]),
    Curve([[3.5, 16.5], [8.0, 9.0], [12.0, 22.0], [16.5, 14.0]]),
    cv!(3.5, 16.5),
    cv!(16.5, 14.0),
]);
pub(crate) const SMOOTH_STROKES: Icon = Icon(&[
    Line(&[[3.0, 6.0], [5.2, 2.8], [7.6, 7.6], [10.0, 2.8], [12.4, 7.6], [14.8, 2.8], [17.0, 6.0]]),
    Curve([[3.5, 16.0], [7.5, 10.5], [12.5, 10.5], [16.5, 16.0]]),
    cv!(3.5, 16.0),
    cv!(16.5, 16.0),
]);
pub(crate) const COMB_HAIR: Icon = Icon(&[
    Line(&[[3.0, 3.0], [17.0, 3.0]]),
    Line(&[[3.7, 3.0], [3.7, 8.5]]),
    Line(&[[6.9, 3.0], [6.9, 8.5]]),
    Line(&[[10.0, 3.0], [10.0, 8.5]]),
    Line(&[[13.1, 3.0], [13.1, 8.5]]),
    Line(&[[16.3, 3.0], [16.3, 8.5]]),
    Curve([[5.2, 10.5], [5.5, 14.0], [3.5, 15.0], [3.5, 18.5]]),
    Curve([[10.0, 10.5], [10.3, 14.0], [8.3, 15.0], [8.3, 18.5]]),
    Curve([[14.8, 10.5], [15.1, 14.0], [13.1, 15.0], [13.1, 18.5]]),
]);
pub(crate) const SMOOTH_HAIR: Icon = Icon(&[
    Line(&[[2.0, 5.0], [3.8, 3.0], [5.6, 7.0], [7.4, 3.0], [9.2, 5.6]]),
    Line(&[[2.0, 10.0], [3.8, 8.0], [5.6, 12.0], [7.4, 8.0], [9.2, 10.6]]),
    Line(&[[2.0, 15.0], [3.8, 13.0], [5.6, 17.0], [7.4, 13.0], [9.2, 15.6]]),
    Curve([[9.2, 5.6], [11.0, 7.0], [14.0, 3.5], [18.0, 4.5]]),
    Curve([[9.2, 10.6], [11.0, 12.0], [14.0, 8.5], [18.0, 9.5]]),
    Curve([[9.2, 15.6], [11.0, 17.0], [14.0, 13.5], [18.0, 14.5]]),
]);
pub(crate) const GRAB: Icon = Icon(&[
    Line(&[[6.3, 11.0], [6.3, 4.6]]),
    Line(&[[9.2, 9.6], [9.2, 2.6]]),
    Line(&[[12.1, 9.6], [12.1, 3.0]]),
    Line(&[[15.0, 11.0], [15.0, 5.0]]),
    Curve([[15.0, 10.0], [15.6, 15.0], [13.5, 18.0], [10.5, 18.0]]),
    Curve([[10.5, 18.0], [6.5, 18.0], [5.0, 14.5], [2.4, 11.0]]),
    Line(&[[2.4, 11.0], [6.3, 13.0], [6.3, 9.0]]),
]);

pub(crate) const ERASE_STROKES: Icon = Icon(&[
    Line(&[[11.0, 2.0], [17.0, 8.0], [11.5, 13.5], [5.5, 7.5], [11.0, 2.0], [17.0, 8.0]]),
    Line(&[[8.3, 4.7], [14.3, 10.7]]),
    Line(&[[3.5, 16.5], [9.0, 16.5]]),
    cv!(3.5, 16.5),
    cv!(16.5, 16.5),
]);
pub(crate) const CUT: Icon = Icon(&[
    Ring([4.8, 15.2], 2.6),
    Ring([15.2, 15.2], 2.6),
    Line(&[[6.2, 13.0], [13.8, 2.0]]),
    Line(&[[13.8, 13.0], [6.2, 2.0]]),
]);

pub(crate) const STRAIGHTEN: Icon = Icon(&[
    Curve([[4.0, 2.5], [8.0, 6.0], [0.5, 8.0], [4.0, 10.0]]),
    Curve([[4.0, 10.0], [8.0, 12.5], [0.5, 14.5], [4.0, 17.5]]),
    Line(&[[7.4, 10.0], [12.0, 10.0]]),
    Line(&[[10.2, 7.6], [12.6, 10.0], [10.2, 12.4]]),
    Line(&[[15.0, 2.5], [15.0, 17.5]]),
    Line(&[[17.8, 2.5], [17.8, 17.5]]),
]);
pub(crate) const PUFF: Icon = Icon(&[
    SKIN,
    Curve([[3.0, 17.0], [2.5, 5.5], [17.5, 5.5], [17.0, 17.0]]),
    Curve([[6.6, 16.4], [6.2, 11.0], [13.8, 11.0], [13.4, 16.4]]),
    Line(&[[10.0, 7.0], [10.0, 1.8]]),
    Line(&[[7.4, 4.2], [10.0, 1.6], [12.6, 4.2]]),
]);
pub(crate) const TWIST: Icon = Icon(&[
    Curve([[6.0, 1.5], [6.0, 6.0], [14.0, 5.5], [14.0, 10.0]]),
    Curve([[14.0, 10.0], [14.0, 14.5], [6.0, 14.0], [6.0, 18.5]]),
    Curve([[14.0, 1.5], [14.0, 6.0], [6.0, 5.5], [6.0, 10.0]]),
    Curve([[6.0, 10.0], [6.0, 14.5], [14.0, 14.0], [14.0, 18.5]]),
]);
pub(crate) const FRIZZ: Icon = Icon(&[
    SKIN,
    Line(&[
        [7.0, 16.4],
        [8.4, 14.2],
        [4.6, 12.4],
        [8.0, 10.0],
        [3.4, 8.2],
        [7.2, 5.8],
        [2.4, 4.0],
        [5.6, 1.6],
    ]),
    Line(&[
        [13.0, 16.4],
        [11.6, 14.2],
        [15.4, 12.4],
        [12.0, 10.0],
        [16.6, 8.2],
        [12.8, 5.8],
        [17.6, 4.0],
        [14.4, 1.6],
    ]),
]);
pub(crate) const DENSITY: Icon = Icon(&[
    Dot([3.5, 10.0], 1.4),
    Dot([8.0, 5.6], 1.4),
    Dot([8.0, 14.4], 1.4),
    Dot([12.2, 3.6], 1.4),
    Dot([12.2, 10.0], 1.4),
    Dot([12.2, 16.4], 1.4),
    Dot([16.4, 2.6], 1.4),
    Dot([16.4, 6.3], 1.4),
    Dot([16.4, 10.0], 1.4),
    Dot([16.4, 13.7], 1.4),
    Dot([16.4, 17.4], 1.4),
]);
pub(crate) const PIN: Icon = Icon(&[
    Curve([[6.5, 18.0], [6.5, 14.0], [4.5, 11.0], [6.5, 8.0]]),
    Curve([[6.5, 8.0], [7.5, 6.5], [6.5, 5.5], [6.5, 5.0]]),
    Curve([[6.5, 5.2], [6.7, 0.8], [13.3, 0.8], [13.5, 5.2]]),
    Line(&[[13.5, 5.0], [13.5, 18.0]]),
    Dot([6.5, 17.6], 1.3),
    Dot([13.5, 17.6], 1.3),
]);

pub(crate) const PAINT: Icon = Icon(&[
    Line(&[[17.5, 2.5], [9.6, 10.4]]),
    Line(&[[7.6, 9.2], [10.8, 12.4]]),
    Fill(&[[7.0, 10.0], [10.0, 13.0], [8.4, 16.4], [2.5, 17.5], [4.2, 13.6]]),
]);
pub(crate) const ERASE_MASK: Icon = Icon(&[
    Line(&[[12.0, 2.0], [18.0, 8.0], [12.5, 13.5], [6.5, 7.5], [12.0, 2.0], [18.0, 8.0]]),
    Line(&[[9.3, 4.7], [15.3, 10.7]]),
    Fill(&[[2.0, 13.0], [5.6, 11.0], [9.5, 15.0], [8.5, 18.0], [3.5, 18.0]]),
]);
pub(crate) const SMOOTH_MASK: Icon = Icon(&[
    Curve([[10.0, 1.8], [7.4, 6.6], [4.2, 9.0], [4.2, 12.6]]),
    Curve([[4.2, 12.6], [4.2, 20.0], [15.8, 20.0], [15.8, 12.6]]),
    Curve([[15.8, 12.6], [15.8, 9.0], [12.6, 6.6], [10.0, 1.8]]),
    Curve([[7.2, 12.6], [7.2, 14.6], [8.4, 15.4], [10.0, 15.4]]),
]);
pub(crate) const FLOOD: Icon = Icon(&[
    Line(&[[8.5, 3.0], [15.5, 10.0], [9.0, 16.5], [2.0, 9.5], [8.5, 3.0], [15.5, 10.0]]),
    Fill(&[[2.6, 10.0], [14.9, 10.0], [9.0, 15.9]]),
    Line(&[[6.0, 1.5], [10.5, 6.0]]),
    Fill(&[[17.3, 11.5], [18.8, 15.2], [18.2, 16.8], [16.4, 16.8], [15.8, 15.2]]),
]);

pub(crate) const SETTINGS: Icon = Icon(&[
    Line(&[[2.5, 5.0], [17.5, 5.0]]),
    Line(&[[2.5, 10.0], [17.5, 10.0]]),
    Line(&[[2.5, 15.0], [17.5, 15.0]]),
    Dot([13.0, 5.0], 2.4),
    Dot([6.5, 10.0], 2.4),
    Dot([11.0, 15.0], 2.4),
]);
