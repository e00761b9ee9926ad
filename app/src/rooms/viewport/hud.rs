//! What stands on the picture: what it is, menus of how it is looked at, the legend, and the card of a hair.

use super::drawing::HairHit;
use super::input::LIGHT_DRAG;
use super::options::{EXPOSURES, Options, SKIN_AUTO, SKIN_FILE};
use super::status::Facts;
use super::{Viewport, navigation};
use crate::core::event::Event;
use crate::core::room::Room;
use crate::core::state::{Select, State};
use crate::scene::{SHOWS, label_of};
use crate::widgets::panel;
use crate::widgets::theme;
use coif_graphs::document::edit::Edit;
use coif_graphs::document::graph::upstream;
use coif_graphs::document::{NodeId, SavedView};
use coif_nodes::data::attributes::{Column, Domain};
use coif_shaders::Camera;
use coif_shaders::camera::Viewpoint;
use coif_shaders::view::Legend;
use coif_shaders::{Model, Rig, Transform};
use egui::{Align, Align2, Color32, FontId, Layout, Pos2, Rect, RichText, Slider, UiBuilder, Vec2};
use std::collections::BTreeSet;

/// Room between what stands on the picture and its edge, points.
const EDGE: f32 = 8.0;
/// Behind text on the picture.
pub(super) const SHADE: Color32 = Color32::from_black_alpha(170);

/// All of it.
pub(super) fn ui(viewport: &mut Viewport, state: &State, ui: &mut egui::Ui, out: &mut Vec<Event>) {
    let rect = viewport.room.shrink(EDGE);
    let part = |id: &'static str, layout: Layout| {
        UiBuilder::new().id_salt(id).max_rect(rect).layout(layout)
    };
    // The picture is the same in both themes, and so is what stands on it; menus that open from it are not.
    let over = ui.ctx().style_of(egui::Theme::Dark);
    ui.scope_builder(part("tools", Layout::top_down(Align::LEFT)), |ui| {
        ui.set_style(over.clone());
        ui.horizontal_wrapped(|ui| tools(viewport, state, ui, out));
        banner(viewport, state, ui, out);
    });
    ui.scope_builder(part("status", Layout::bottom_up(Align::LEFT)), |ui| {
        ui.set_style(over);
        lines(viewport, state, ui);
    });
    if let Some(screen) = &viewport.hand().on_screen
        && let Some(found) = &screen.drawn.legend
    {
        legend(found, ui, rect.right_bottom());
    }
}

// --- what it is ---------------------------------------------------------------------------------

/// What the words are made from.
pub(super) fn facts(viewport: &Viewport, state: &State) -> Option<Facts> {
    let shown = state.shown.as_ref()?;
    let drawn = viewport.hand().on_screen.as_ref().map(|screen| &screen.drawn);
    Some(Facts {
        strands: shown.curves.curve_count(),
        final_strands: shown.final_strands,
        is_final: shown.is_final(),
        points: shown.curves.point_count(),
        evaluation_ms: shown.ms,
        stale: state.stale(),
        samples: drawn.map(|drawn| (drawn.samples, drawn.of)),
        wide: drawn.map_or(1, |drawn| drawn.wide),
        rough: drawn.is_some_and(|drawn| drawn.rough),
        draw_ms: drawn.map_or(0.0, |drawn| drawn.ends.ms()),
        share: drawn.map_or(1.0, |drawn| drawn.share),
        hidden: !state.visibility.shows_all(),
    })
}

fn line(ui: &mut egui::Ui, text: impl Into<String>, colour: Color32) {
    let text = RichText::new(text).small().color(colour).background_color(SHADE);
    ui.add(egui::Label::new(text).selectable(false).extend());
}

/// The corner, from its lowest line up.
fn lines(viewport: &Viewport, state: &State, ui: &mut egui::Ui) {
    ui.spacing_mut().item_spacing.y = 1.0;
    let Some(facts) = facts(viewport, state) else {
        if state.run.since.is_none() {
            line(
                ui,
                "nothing to show: display a node that gives curves or a head",
                theme::TEXT.dark,
            );
        }
        return;
    };
    if viewport.hand().drawing.is_some() && viewport.fault().is_none() {
        line(ui, facts.drawn(), theme::TEXT.dark);
    }
    if state.run.since.is_some() && state.shown.as_ref().is_some_and(|shown| shown.head_alone) {
        let left = state.left_to_run();
        line(ui, format!("the head; its hair is being made: {left}"), theme::WARNING.dark);
        return;
    }
    line(ui, facts.made(), if facts.stale { theme::WARNING.dark } else { theme::TEXT.dark });
    line(ui, names(viewport, state), theme::TEXT.dark);
    let notice = viewport.hand().on_screen.as_ref().and_then(|screen| screen.drawn.notice.as_ref());
    if let Some(notice) = notice {
        line(ui, notice, theme::WARNING.dark);
    }
}

/// What is displayed, what the pen works on, and what is selected.
pub(super) fn names(viewport: &Viewport, state: &State) -> String {
    let label = |id: &NodeId| state.document.name_of(id).into_owned();
    let sockets = state.shown.iter().flat_map(|shown| &shown.sockets);
    let displayed: Vec<String> = sockets.map(|socket| label(&socket.node)).collect();
    let mut text = match displayed.is_empty() {
        true => "nothing displayed".to_owned(),
        false => format!("displayed: {}", displayed.join(", ")),
    };
    if let Some(pinned) = &state.pinned {
        text += &format!("; the pen works on {}", label(pinned));
    }
    match (state.selection.curves.len(), viewport.taken()) {
        (0, _) => {}
        (n, Some(level)) => {
            text += &format!("; {} selected ({})", crate::words::grouped(n), level.name());
        }
        (n, None) => text += &format!("; {} selected", crate::words::grouped(n)),
    }
    text
}

/// Failed nodes, and why there is no picture.
fn banner(viewport: &Viewport, state: &State, ui: &mut egui::Ui, out: &mut Vec<Event>) {
    let frame = egui::Frame::new().fill(SHADE).inner_margin(4).corner_radius(3);
    if let Some(fault) = viewport.fault() {
        frame.show(ui, |ui| {
            ui.colored_label(theme::ERROR.dark, "✖ No picture");
            ui.add(egui::Label::new(RichText::new(fault).small()).wrap());
        });
    }
    let shown = state.shown.iter().flat_map(|shown| &shown.sockets);
    let way = upstream(&state.document, shown.map(|socket| &socket.node));
    let failures = state.run.reports.failures();
    let here = failures
        .iter()
        .filter(|(node, _)| way.iter().any(|id| id.as_str() == *node) || state.shown.is_none());
    // What failed twice for one reason is told once.
    let mut told = BTreeSet::new();
    for (node, what) in here.filter(|failure| told.insert((*failure).clone())).take(3) {
        frame.show(ui, |ui| {
            ui.horizontal_wrapped(|ui| {
                let name = state.called(node);
                ui.colored_label(
                    theme::ERROR.dark,
                    format!("✖ {name} failed and passes its input on"),
                );
                ui.label(RichText::new(what).small());
                let go = ui.button("Go to").on_hover_text(format!("Select {name} on the canvas."));
                if go.clicked()
                    && let Ok(id) = NodeId::new(node)
                {
                    out.push(Event::Select(Select::Nodes(vec![id])));
                    out.push(Event::Show(Room::Canvas));
                }
            });
        });
    }
}

// --- menus --------------------------------------------------------------------------------------

fn tools(viewport: &mut Viewport, state: &State, ui: &mut egui::Ui, out: &mut Vec<Event>) {
    let options = &mut viewport.options;
    ui.visuals_mut().widgets.inactive.weak_bg_fill = SHADE;
    let show = label_of(&options.show).to_owned();
    let menu = panel::menu_button(ui, format!("{show} ⏷"), |ui| shows(options, state, ui));
    menu.on_hover_text("Display mode: shaded hair, groom colours, or any attribute as a heat map.");
    let menu = panel::menu_button(ui, "Look ⏷".to_owned(), |ui| looks(options, ui, out));
    menu.on_hover_text(
        "Lights, exposure, skin and hair shading. Shift+right drag turns the light.",
    );
    let menu = panel::menu_button(ui, "Over it ⏷".to_owned(), |ui| over(options, ui));
    menu.on_hover_text("Overlays on the picture.");
    let menu = panel::menu_button(ui, "From ⏷".to_owned(), |ui| views(viewport, state, ui, out));
    menu.on_hover_text("Camera and saved views.");
    if let Some((text, colour)) = viewport.compared.as_ref().map(|compared| &compared.said) {
        let button = egui::Button::new(RichText::new(text).color(colour.dark)).truncate();
        let tip = "Switch between the other groom's hair and yours, with the same camera (F8).";
        if ui.add(button).on_hover_text(tip).clicked() {
            out.push(Event::Act("compare.flip"));
        }
    }
}

pub(super) fn over(options: &mut Options, ui: &mut egui::Ui) {
    ui.checkbox(&mut options.guides, "Guides")
        .on_hover_text("The curves that hair follows, as lines.");
    ui.checkbox(&mut options.partings, "Partings")
        .on_hover_text("Lines on the skin between hair of different braids or guides.");
    ui.checkbox(&mut options.roots, "Roots").on_hover_text("A dot at each root.");
    ui.checkbox(&mut options.handles, "Handles").on_hover_text("Handles of the active node.");
    ui.checkbox(&mut options.head, "Head").on_hover_text("Show the head under the hair.");
    ui.checkbox(&mut options.card, "Card of the hair under the pointer")
        .on_hover_text("Show the attributes of the hair under the pointer.");
}

pub(super) fn views(
    viewport: &mut Viewport,
    state: &State,
    ui: &mut egui::Ui,
    out: &mut Vec<Event>,
) {
    for name in Viewpoint::NAMES {
        if ui.button(view_label(name)).clicked() {
            out.push(Event::Act(super::actions::view_action(name)));
            ui.close();
        }
    }
    ui.separator();
    for (action, label, tip) in [
        ("view.frame_all", "Frame all", "Frame everything."),
        ("view.frame_selected", "Frame selected", "Frame the selection."),
        ("view.orthographic", "Orthographic", "Switch between perspective and orthographic."),
        ("view.back", "Previous view", "Go back to the previous view."),
        ("view.forward", "Next view", "Go forward to the next view."),
    ] {
        if ui.button(label).on_hover_text(tip).clicked() {
            out.push(Event::Act(action));
            ui.close();
        }
    }
    let mut focal = viewport.camera.focal_mm;
    let (low, high) = navigation::FOCALS;
    let lens = Slider::new(&mut focal, low..=high).logarithmic(true).suffix(" mm").text("Lens");
    let tip = "Focal length for a film 24 mm high; the subject keeps its size.";
    if ui.add(lens).on_hover_text(tip).changed() {
        viewport.camera = navigation::with_focal(&viewport.camera, focal);
    }
    ui.separator();
    for (name, saved) in &state.document.views {
        ui.horizontal(|ui| {
            if ui.button(name).on_hover_text("Look from this saved view.").clicked() {
                viewport.look(camera_of(saved));
                ui.close();
            }
            if ui.button("✖").on_hover_text(format!("Delete the view {name}.")).clicked() {
                out.push(Event::Edit(Edit::SetView { name: name.clone(), view: None }));
            }
        });
    }
    ui.horizontal(|ui| {
        let name = &mut viewport.view_name;
        let field =
            egui::TextEdit::singleline(name).desired_width(110.0).hint_text("name of this view");
        ui.add(field).on_hover_text("Name of the view, also for coif render --camera.");
        let save = ui.add_enabled(!name.trim().is_empty(), egui::Button::new("Save view"));
        let tip = "Save this view in the groom under a name, replacing one of that name.";
        if save.on_hover_text(tip).clicked() {
            let name = name.trim().to_owned();
            viewport.view_name.clear();
            let view = Some(saved_of(&viewport.camera));
            out.push(Event::Edit(Edit::SetView { name, view }));
        }
    });
}

/// A saved view's camera.
fn camera_of(saved: &SavedView) -> Camera {
    Camera {
        eye: saved.eye.into(),
        target: saved.target.into(),
        up: saved.up.into(),
        focal_mm: saved.focal_mm,
        orthographic: saved.orthographic,
    }
}

/// A camera as it is saved.
fn saved_of(camera: &Camera) -> SavedView {
    SavedView {
        eye: camera.eye.to_array(),
        target: camera.target.to_array(),
        up: camera.up.to_array(),
        focal_mm: camera.focal_mm,
        orthographic: camera.orthographic,
    }
}

/// A view's name for people.
pub(super) fn view_label(name: &str) -> String {
    let name = name.replace('-', " ");
    let mut letters = name.chars();
    letters.next().map_or(String::new(), |first| first.to_uppercase().chain(letters).collect())
}

pub(super) fn shows(options: &mut Options, state: &State, ui: &mut egui::Ui) {
    let mut of_hair = true;
    for mode in SHOWS {
        if std::mem::replace(&mut of_hair, mode.is_of_hair()) != of_hair {
            ui.separator();
        }
        if ui.radio(options.show == mode.name, mode.label).clicked() {
            mode.name.clone_into(&mut options.show);
            ui.close();
        }
    }
    let tuft = state.shown.as_ref().and_then(|shown| shown.curves.tufts().first().cloned());
    let names = tuft.iter().flat_map(|tuft| tuft.attributes()).map(|a| a.name.to_string());
    let names: Vec<String> = names.collect();
    panel::submenu(ui, "Attribute", |ui| {
        for name in &names {
            if ui.radio(options.show == *name, name).clicked() {
                options.show.clone_from(name);
                ui.close();
            }
        }
        if names.is_empty() {
            ui.label("nothing with attributes is displayed");
        }
    });
}

pub(super) fn looks(options: &mut Options, ui: &mut egui::Ui, out: &mut Vec<Event>) {
    let choice = |ui: &mut egui::Ui, label: &str, tip: &str, value: &mut String, all: &[&str]| {
        panel::submenu(ui, format!("{label}: {value}"), |ui| {
            for name in all {
                if ui.radio(value == name, *name).clicked() {
                    (*name).clone_into(value);
                }
            }
        })
        .on_hover_text(tip);
    };
    lights(options, ui, out);
    let models = Model::ALL.map(Model::name);
    choice(ui, "Model", "How hair scatters light.", &mut options.model, &models);
    let transforms = Transform::ALL.map(Transform::name);
    let tip = "Tone mapping: from scene light to display colours.";
    choice(ui, "Display", tip, &mut options.transform, &transforms);
    ui.add(
        Slider::new(&mut options.exposure, EXPOSURES.0..=EXPOSURES.1)
            .text("Exposure")
            .suffix(" stops")
            .step_by(0.25),
    )
    .on_hover_text("Exposure relative to the lights' own, in stops.");
    skins(options, ui);
    ui.add(Slider::new(&mut options.scalp_tint, 0.0..=1.0).text("Root tint"))
        .on_hover_text("How much roots darken the skin.");
    ui.add(Slider::new(&mut options.opacity, 0.0..=1.0).text("Opacity"))
        .on_hover_text("Opacity of hair: 1 is opaque, 0.1 shows roots and skin.");
    ui.add(Slider::new(&mut options.share, 0.01..=1.0).text("Share").logarithmic(true))
        .on_hover_text("Fraction of strands drawn; the rest are made up for by width.");
}

/// Rig or surroundings, and how they are turned.
fn lights(options: &mut Options, ui: &mut egui::Ui, out: &mut Vec<Event>) {
    let around = options
        .around
        .as_ref()
        .map(|around| around.path.file_name().unwrap_or_default().to_string_lossy().into_owned());
    let name = around.as_deref().unwrap_or(&options.rig);
    panel::submenu(ui, format!("Lights: {name}"), |ui| {
        for name in Rig::NAMES {
            if ui.radio(around.is_none() && options.rig == name, name).clicked() {
                name.clone_into(&mut options.rig);
                options.around = None;
            }
        }
        if let Some(name) = &around {
            ui.add(egui::RadioButton::new(true, name));
        }
        let tip = "A photographed sphere (.hdr, .exr), which can also be dropped on the window.";
        if ui.button("Surroundings…").on_hover_text(tip).clicked() {
            out.push(Event::Act("view.surroundings"));
            ui.close();
        }
    })
    .on_hover_text("What lights hair and head.");
    let turn = Slider::new(&mut options.turn, -180.0..=180.0).text("Turn").suffix("°");
    let tip = format!(
        "The lights about the head, to the right for more; or drag over the picture with {LIGHT_DRAG} button."
    );
    ui.add(turn.fixed_decimals(0)).on_hover_text(tip);
    if around.is_some() {
        let blur = Slider::new(&mut options.blur, 0.0..=45.0).text("Blur behind").suffix("°");
        ui.add(blur.fixed_decimals(0))
            .on_hover_text("Blurs what is seen behind the head; the light stays as it is.");
    }
}

/// Skin of the head: that of its file, or a tone.
fn skins(options: &mut Options, ui: &mut egui::Ui) {
    let label = |skin: u8| match skin {
        SKIN_AUTO => "From the file, where it has a colour map".to_owned(),
        SKIN_FILE => "From the file".to_owned(),
        0 => "Clay".to_owned(),
        tone => tone.min(10).to_string(),
    };
    panel::submenu(ui, format!("Skin: {}", label(options.skin)), |ui| {
        for skin in [SKIN_AUTO, SKIN_FILE].into_iter().chain(1..=10).chain([0]) {
            if ui.radio(options.skin == skin, label(skin)).clicked() {
                options.skin = skin;
            }
        }
    })
    .on_hover_text(
        "Skin: the file's own colours and normal maps, 1 (lightest) to 10 on the Monk scale, or clay.",
    );
}

// --- legend and card ----------------------------------------------------------------------------

/// The colours of a heat map, with its numbers.
fn legend(legend: &Legend, ui: &egui::Ui, corner: Pos2) {
    let painter = ui.painter();
    let size = Vec2::new(190.0, 46.0);
    let rect = Rect::from_min_size(corner - size, size);
    painter.rect_filled(rect, 3.0, SHADE);
    let name = legend.name.replace('_', " ");
    let title = match legend.unit.as_str() {
        "" => name,
        unit => format!("{name} ({unit})"),
    };
    let font = FontId::proportional(11.0);
    let text = |at: Pos2, align: Align2, text: String| {
        painter.text(at, align, text, font.clone(), theme::TEXT.dark);
    };
    text(rect.left_top() + Vec2::new(6.0, 3.0), Align2::LEFT_TOP, title);
    let over = if legend.limit.is_some() { 34.0 } else { 0.0 };
    let bar = Rect::from_min_max(
        rect.left_top() + Vec2::new(6.0, 19.0),
        rect.right_top() + Vec2::new(-6.0 - over, 28.0),
    );
    const STEPS: usize = 48;
    for i in 0..STEPS {
        let part = |k: usize| bar.left() + bar.width() * k as f32 / STEPS as f32;
        let colour = legend.ramp.at((i as f32 + 0.5) / STEPS as f32);
        let shown = Transform::Srgb.apply(colour).to_array().map(|c| (c * 255.0).round() as u8);
        let piece = Rect::from_x_y_ranges(part(i)..=part(i + 1), bar.y_range());
        painter.rect_filled(piece, 0.0, Color32::from_rgb(shown[0], shown[1], shown[2]));
    }
    let under = bar.bottom() + 2.0;
    text(Pos2::new(bar.left(), under), Align2::LEFT_TOP, number(legend.lowest));
    text(Pos2::new(bar.right(), under), Align2::RIGHT_TOP, number(legend.highest));
    if let Some(limit) = legend.limit {
        let at = Pos2::new(rect.right() - 4.0, bar.center().y);
        text(at, Align2::RIGHT_CENTER, format!("> {}", number(limit)));
    }
}

/// A number of at most three digits that count.
fn number(x: f32) -> String {
    match x.abs() {
        0.0 => "0".to_owned(),
        a if !(0.001..10_000.0).contains(&a) => format!("{x:.1e}"),
        _ => crate::words::shortest(f64::from(x), 3),
    }
}

/// The attributes of a hair.
pub(super) fn card(hair: &HairHit, ui: &mut egui::Ui) {
    let tuft = &hair.tuft;
    let points = tuft.curve(hair.curve);
    let length: f32 = points.windows(2).map(|pair| pair[0].distance(pair[1])).sum();
    egui::Grid::new("card").num_columns(2).spacing([12.0, 1.0]).show(ui, |ui| {
        let mut row = |name: &str, value: String| {
            let quiet = theme::QUIET.of(ui);
            ui.label(RichText::new(name.replace('_', " ")).small().color(quiet));
            ui.label(RichText::new(value).small());
            ui.end_row();
        };
        row("points", points.len().to_string());
        row("length", format!("{} cm", number(length)));
        for attribute in tuft.attributes() {
            let k = match attribute.domain {
                Domain::Curve => hair.curve,
                Domain::Point => tuft.range(hair.curve).start + hair.point,
            };
            row(&attribute.name, value(&attribute.values, k));
        }
    });
}

/// A column's value for people; one value may stand for all.
fn value(column: &Column, k: usize) -> String {
    fn at<T: Copy>(values: &[T], k: usize) -> Option<T> {
        if values.len() == 1 { values.first().copied() } else { values.get(k).copied() }
    }
    let text = match column {
        Column::F32(values) => at(values, k).map(number),
        Column::I32(values) => at(values, k).map(|x| x.to_string()),
        Column::U64(values) => at(values, k).map(|x| format!("{x:016x}")),
        Column::Vec2(values) => at(values, k).map(|v| format!("{} {}", number(v.x), number(v.y))),
        Column::Vec3(values) => {
            at(values, k).map(|v| format!("{} {} {}", number(v.x), number(v.y), number(v.z)))
        }
    };
    text.unwrap_or_default()
}
