//! The list of a curl's cross-sections: thumbnails, tiers, numbers, order.

use super::number::Scale;
use super::slider::{Done, NumberField};
use super::target::How;
use crate::widgets::panel;
use crate::widgets::text::{set_name, spoken};
use crate::widgets::theme;
use coif_nodes::data::shapes::{ShapeList, Tier, TurnProfile};
use coif_nodes::define::Unit;
use egui::{ComboBox, Pos2, Rect, Sense, Shape, Stroke, StrokeKind, Ui, Vec2};
use glam::Vec2 as Point;

/// The most points of a drawn section.
const MOST_POINTS: usize = 256;
const THUMBNAIL: f32 = 40.0;
const DRAWING: f32 = 140.0;

const KINDS: [(&str, &str); 6] = [
    ("Circle", "The helix."),
    ("Ellipse", "A flattened circle: makes waves rather than coils."),
    ("Lamé", "A superellipse: 2 is a circle, less is pinched, more is square."),
    ("Polygon", "Sharp bends between straight runs."),
    ("Rose", "Petals: loops and kinks."),
    ("Drawn", "A closed curve through points that you drag."),
];

fn kind(section: &TurnProfile) -> usize {
    match section {
        TurnProfile::Circle => 0,
        TurnProfile::Ellipse(_) => 1,
        TurnProfile::Lame(_) => 2,
        TurnProfile::Polygon(_) => 3,
        TurnProfile::Rose { .. } => 4,
        TurnProfile::Custom(_) => 5,
    }
}

/// A section of another kind; a drawn one begins as what was there.
fn of_kind(kind: usize, old: &TurnProfile) -> TurnProfile {
    match kind {
        0 => TurnProfile::Circle,
        1 => TurnProfile::Ellipse(0.6),
        2 => TurnProfile::Lame(4.0),
        3 => TurnProfile::Polygon(5),
        4 => TurnProfile::Rose { petals: 4, depth: 0.4 },
        _ => TurnProfile::Custom(outline(old, 8)),
    }
}

/// `n` points around a section, its radius about 1.
pub(crate) fn outline(section: &TurnProfile, n: usize) -> Vec<Point> {
    let around = |radius: &dyn Fn(f32) -> f32| {
        let at = |i: usize| {
            let phi = std::f32::consts::TAU * i as f32 / n as f32;
            Point::from_angle(phi) * radius(phi)
        };
        (0..n).map(at).collect::<Vec<_>>()
    };
    match section {
        TurnProfile::Circle => around(&|_| 1.0),
        TurnProfile::Ellipse(ratio) => {
            around(&|_| 1.0).into_iter().map(|p| Point::new(p.x, p.y * ratio)).collect()
        }
        TurnProfile::Lame(e) => around(&|phi| {
            let (sin, cos) = phi.sin_cos();
            (cos.abs().powf(*e) + sin.abs().powf(*e)).powf(-1.0 / e)
        }),
        TurnProfile::Polygon(sides) => {
            let part = std::f32::consts::TAU / (*sides).max(3) as f32;
            around(&|phi| {
                let within = phi.rem_euclid(part) - part / 2.0;
                (part / 2.0).cos() / within.cos()
            })
        }
        TurnProfile::Rose { petals, depth } => {
            around(&|phi| 1.0 + depth * (*petals as f32 * phi).cos())
        }
        TurnProfile::Custom(points) if points.len() < 3 => points.clone(),
        TurnProfile::Custom(points) => {
            let count = points.len();
            (0..n)
                .map(|i| {
                    let u = i as f32 / n as f32 * count as f32;
                    let (k, t) = (u as usize, u.fract());
                    let [a, b, c, d] = [count - 1, 0, 1, 2].map(|o| points[(k + o) % count]);
                    // Catmull-Rom, closed.
                    (b * 2.0
                        + (c - a) * t
                        + (a * 2.0 - b * 5.0 + c * 4.0 - d) * t * t
                        + (b * 3.0 - a - c * 3.0 + d) * t * t * t)
                        * 0.5
                })
                .collect()
        }
    }
}

/// The section drawn within `rect`, a unit `unit` points long (else as large as fits); gives the places of its points.
fn paint(
    ui: &Ui,
    rect: Rect,
    section: &TurnProfile,
    unit: Option<f32>,
) -> impl Fn(Point) -> Pos2 + use<> {
    let points = outline(section, 96);
    let finite = points.iter().filter(|p| p.is_finite());
    let reach = finite.fold(0.01f32, |most, p| most.max(p.x.abs()).max(p.y.abs()));
    let fits = rect.width().min(rect.height()) * 0.42 / reach.max(1.0);
    let scale = unit.unwrap_or(fits);
    let centre = rect.center();
    let to = move |p: Point| centre + Vec2::new(p.x, -p.y) * scale;
    let line: Vec<Pos2> = points.iter().filter(|p| p.is_finite()).map(|p| to(*p)).collect();
    let painter = ui.painter_at(rect);
    let frame = Stroke::new(1.0, theme::LINE.of(ui));
    painter.rect(rect, 3, theme::SUNKEN.of(ui), frame, StrokeKind::Inside);
    painter.add(Shape::closed_line(line, Stroke::new(1.5, theme::ACCENT.of(ui))));
    to
}

/// Shows the list and gives the list it becomes.
pub(crate) fn show(
    ui: &mut Ui,
    name: &str,
    list: &ShapeList,
    width: f32,
) -> Option<(ShapeList, How)> {
    let mut new = None;
    ui.vertical(|ui| {
        for i in 0..list.0.len() {
            ui.push_id(i, |ui| {
                let one = format!("{name} {}", i + 1);
                new = row(ui, &one, list, i, width).or(new.take());
            });
        }
        let add = ui.button("Add a shape").on_hover_text("Add an ellipse in tier B.");
        set_name(ui, &add, &format!("{name}: add a shape"));
        if add.clicked() {
            let tier = if list.0.is_empty() { Tier::A } else { Tier::B };
            let more = [&list.0[..], &[(tier, TurnProfile::Ellipse(0.6))]].concat();
            new = Some((ShapeList(more), How::Once));
        }
    });
    new
}

fn row(
    ui: &mut Ui,
    name: &str,
    list: &ShapeList,
    i: usize,
    width: f32,
) -> Option<(ShapeList, How)> {
    let (tier, section) = &list.0[i];
    let mut new: Option<(ShapeList, How)> = None;
    let with = |tier: Tier, section: TurnProfile| {
        let mut all = list.0.clone();
        all[i] = (tier, section);
        ShapeList(all)
    };
    ui.horizontal_top(|ui| {
        ui.spacing_mut().item_spacing.x = 3.0;
        let (rect, _) = ui.allocate_exact_size(Vec2::splat(THUMBNAIL), Sense::hover());
        let _ = paint(ui, rect, section, None);
        ui.vertical(|ui| {
            ui.spacing_mut().item_spacing.y = 2.0;
            ui.horizontal(|ui| {
                let tiers = ComboBox::from_id_salt("tier")
                    .width(26.0)
                    .selected_text(format!("{tier:?}"))
                    .show_ui(ui, |ui| {
                        for (other, tip) in [
                            (Tier::A, "Primary: as often as the uniformity says."),
                            (Tier::B, "Secondary."),
                            (Tier::C, "Tertiary."),
                        ] {
                            let chosen = ui.selectable_label(*tier == other, format!("{other:?}"));
                            if chosen.on_hover_text(tip).clicked() {
                                new = Some((with(other, section.clone()), How::Once));
                            }
                        }
                    });
                set_name(ui, &tiers.response, &format!("{name} tier"));
                let kinds = ComboBox::from_id_salt("kind")
                    .width(62.0)
                    .selected_text(KINDS[kind(section)].0)
                    .show_ui(ui, |ui| {
                        for (k, (label, tip)) in KINDS.iter().enumerate() {
                            let chosen = ui.selectable_label(kind(section) == k, *label);
                            if chosen.on_hover_text(*tip).clicked() && k != kind(section) {
                                new = Some((with(*tier, of_kind(k, section)), How::Once));
                            }
                        }
                    });
                set_name(ui, &kinds.response, &format!("{name} shape"));
                if let Some(list) = row_menu(ui, name, list, i) {
                    new = Some((list, How::Once));
                }
            });
            let rest = (width - THUMBNAIL - 3.0).max(60.0);
            if let Some((section, how)) = numbers(ui, name, section, rest) {
                new = Some((with(*tier, section), how));
            }
        });
    });
    new
}

/// What can be done with a shape of the list as a whole.
fn row_menu(ui: &mut Ui, name: &str, list: &ShapeList, i: usize) -> Option<ShapeList> {
    let (mut all, last) = (list.0.clone(), list.0.len() - 1);
    let menu = ui.menu_button("…", |ui| {
        panel::list(ui, |ui| {
            if ui.add_enabled(i > 0, egui::Button::new("Move up")).clicked() {
                all.swap(i, i - 1);
            }
            if ui.add_enabled(i < last, egui::Button::new("Move down")).clicked() {
                all.swap(i, i + 1);
            }
            if ui.button("Duplicate").clicked() {
                all.insert(i, all[i].clone());
            }
            if ui.add_enabled(last > 0, egui::Button::new("Remove")).clicked() {
                all.remove(i);
            }
        })
    });
    set_name(ui, &menu.response, &format!("{name}: more"));
    (all != list.0).then_some(ShapeList(all))
}

/// The numbers of a section, or its drawing.
fn numbers(
    ui: &mut Ui,
    name: &str,
    section: &TurnProfile,
    width: f32,
) -> Option<(TurnProfile, How)> {
    let number = |ui: &mut Ui, what: &str, x: f32, hard: (f64, f64), whole: bool, width: f32| {
        let unit = if what == "depth" { Unit::Ratio } else { Unit::None };
        let scale = Scale::new(unit, Some(hard), Some(hard), whole);
        let name = format!("{name} {what}");
        let x = f64::from(x);
        let field =
            NumberField { name: &name, value: Some(x), instead: None, unset: None, scale: &scale };
        let (response, done) = field.show(ui, width);
        let range = scale.range(hard);
        response.on_hover_text(format!("{}, {range}", spoken(what)));
        let (to, how) = match done? {
            Done::Dragged(to) => (to, How::Drag),
            Done::Typed(entry) => (entry.apply(x), How::Once),
            Done::Nudged(by) => (x + by, How::Nudge),
            Done::Refused(_) | Done::Reset => return None,
        };
        Some((scale.clamp(to).0 as f32, how))
    };
    match section {
        TurnProfile::Circle => None,
        TurnProfile::Ellipse(ratio) => {
            let (ratio, how) = number(ui, "ratio", *ratio, (0.01, 1.0), false, width)?;
            Some((TurnProfile::Ellipse(ratio), how))
        }
        TurnProfile::Lame(e) => {
            let (e, how) = number(ui, "exponent", *e, (0.3, 20.0), false, width)?;
            Some((TurnProfile::Lame(e), how))
        }
        TurnProfile::Polygon(n) => {
            let (n, how) = number(ui, "sides", *n as f32, (3.0, 12.0), true, width)?;
            Some((TurnProfile::Polygon(n as u32), how))
        }
        TurnProfile::Rose { petals, depth } => {
            ui.horizontal(|ui| {
                let half = (width - 3.0) / 2.0;
                let (old, deep) = (*petals as f32, *depth);
                if let Some((n, how)) = number(ui, "petals", old, (2.0, 12.0), true, half) {
                    number(ui, "depth", deep, (0.0, 0.95), false, half);
                    return Some((TurnProfile::Rose { petals: n as u32, depth: deep }, how));
                }
                let (depth, how) = number(ui, "depth", deep, (0.0, 0.95), false, half)?;
                Some((TurnProfile::Rose { petals: *petals, depth }, how))
            })
            .inner
        }
        TurnProfile::Custom(points) => drawing(ui, name, points, width),
    }
}

/// A drawn section: drag points, double click adds one, right click removes it.
fn drawing(ui: &mut Ui, name: &str, points: &[Point], width: f32) -> Option<(TurnProfile, How)> {
    let size = Vec2::new(width, DRAWING);
    let (rect, response) = ui.allocate_exact_size(size, Sense::click_and_drag());
    set_name(ui, &response, &format!("{name} drawing"));
    let id = response.id;
    let section = TurnProfile::Custom(points.to_vec());
    // The scale stays while a point is dragged, or it would run from the hand.
    let kept = ui.data(|data| data.get_temp::<f32>(id)).filter(|_| response.dragged());
    let to = paint(ui, rect, &section, kept);
    let unit = (to(Point::X) - to(Point::ZERO)).x.max(1e-3);
    let at = |p: Pos2| Point::new(p.x - rect.center().x, rect.center().y - p.y) / unit;
    let near = |p: Pos2| {
        let far = |q: &Point| to(*q).distance(p);
        let nearest =
            (0..points.len()).min_by(|a, b| far(&points[*a]).total_cmp(&far(&points[*b])));
        nearest.filter(|i| far(&points[*i]) < 10.0)
    };
    for p in points.iter().filter(|p| p.is_finite()) {
        let dot = ui.painter_at(rect);
        dot.circle(to(*p), 4.0, theme::PANEL.of(ui), Stroke::new(1.5, theme::ACCENT.of(ui)));
    }
    let key = id.with("point");
    if response.drag_started() {
        let grabbed = ui.input(|input| input.pointer.press_origin()).and_then(near);
        ui.data_mut(|data| {
            data.insert_temp(key, grabbed);
            data.insert_temp(id, unit);
        });
    }
    let mut new = points.to_vec();
    let mut how = How::Once;
    if response.dragged()
        && let Some(i) = ui.data(|data| data.get_temp::<Option<usize>>(key)).flatten()
        && let (Some(p), Some(slot)) = (response.interact_pointer_pos(), new.get_mut(i))
    {
        *slot = at(p);
        how = How::Drag;
    } else if let Some(p) = response.interact_pointer_pos() {
        if response.double_clicked() && near(p).is_none() && points.len() < MOST_POINTS {
            // Into the side that it lies nearest to.
            let p = at(p);
            let far = |i: usize| {
                let (a, b) = (points[i], points[(i + 1) % points.len()]);
                ((a + b) / 2.0).distance(p)
            };
            let side = (0..points.len()).min_by(|a, b| far(*a).total_cmp(&far(*b)));
            new.insert(side.map_or(0, |i| i + 1), p);
        } else if response.secondary_clicked()
            && points.len() > 3
            && let Some(i) = near(p)
        {
            new.remove(i);
        }
    }
    response.on_hover_text("Drag points. Double-click adds one, right-click removes one.");
    let usable = ShapeList(vec![(Tier::A, TurnProfile::Custom(new.clone()))]).fault().is_none();
    (usable && new != points).then_some((TurnProfile::Custom(new), how))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn outlines_of_all_kinds_are_closed_curves_of_about_unit_radius() {
        let mut section = TurnProfile::Rose { petals: 5, depth: 0.3 };
        for kind_wanted in 0..KINDS.len() {
            section = of_kind(kind_wanted, &section);
            assert_eq!(kind(&section), kind_wanted);
            let points = outline(&section, 64);
            assert_eq!(points.len(), 64);
            assert!(points.iter().all(|p| p.is_finite() && p.length() < 2.0), "{section:?}");
            let list = ShapeList(vec![(Tier::A, section.clone())]);
            assert_eq!(list.fault(), None);
        }
    }

    #[test]
    fn odd_sections_are_drawn_all_the_same() {
        for odd in [
            TurnProfile::Polygon(0),
            TurnProfile::Lame(0.0),
            TurnProfile::Custom(vec![]),
            TurnProfile::Custom(vec![Point::NAN; 4]),
            TurnProfile::Rose { petals: 0, depth: f32::INFINITY },
        ] {
            outline(&odd, 96);
        }
    }
}
