//! The pen's bar over the picture, and the settings of each device with a strip to try them on.

use super::target::{self, Fills};
use super::{Pen, PenTool, TOOLS, edits, recipes};
use crate::core::action::Of;
use crate::core::event::Event;
use crate::core::pen::{Along, Curve, Feel, MOUSE, PenSettings, TOUCH};
use crate::core::state::State;
use crate::widgets::{icons, panel, theme};
use coif_graphs::document::edit::Edit;
use coif_nodes::data::gestures::{Layer, Tool};
use egui::{ComboBox, Pos2, Sense, Shape, Slider, Stroke, Ui, Vec2};

/// The bar takes no more than this of the room's height.
const SHARE: f32 = 0.4;
/// Between groups of tools, points.
const GAP: f32 = 8.0;

/// The keys of an action, for people; none where it has none.
type KeyNames<'a> = &'a dyn Fn(&str) -> Option<String>;

impl Pen {
    /// The bar: tools, and under them what the tool in hand needs. Where all of it would take more than its share of the room it
    /// scrolls: the picture is what is worked on. `keys` gives the keys of an action, for people.
    pub fn bar(&mut self, state: &State, keys: KeyNames, ui: &mut Ui, out: &mut Vec<Event>) {
        let line = ui.spacing().interact_size.y + ui.spacing().item_spacing.y;
        let most = (ui.available_height() * SHARE).max(line);
        let bar = egui::ScrollArea::vertical().id_salt("pen bar").max_height(most);
        bar.min_scrolled_height(0.0).auto_shrink([false, true]).show(ui, |ui| {
            let style = ui.style_mut();
            style.wrap_mode = Some(egui::TextWrapMode::Extend);
            // The wheel scrolls a row that is wider than the room.
            style.always_scroll_the_only_direction = true;
            if state.settings.pen.words {
                ui.horizontal_wrapped(|ui| self.tools(state, keys, ui, out));
            } else {
                let row = egui::ScrollArea::horizontal().id_salt("pen tools");
                row.show(ui, |ui| ui.horizontal(|ui| self.tools(state, keys, ui, out)));
            }
            self.settings_line(state, ui, out);
        });
    }

    /// Tools to take up, then what is not of any.
    fn tools(&mut self, state: &State, keys: KeyNames, ui: &mut Ui, out: &mut Vec<Event>) {
        let words = state.settings.pen.words;
        ui.spacing_mut().item_spacing.x = 2.0;
        for group in TOOLS {
            for (tool, label, action, icon) in *group {
                let chosen = icons::choice(ui, self.tool == *tool, *icon, label, words);
                if chosen.on_hover_text(tip(action, keys)).clicked() {
                    // Not by the action: its key means the same on hair, strokes and masks, this one of them.
                    self.tool = *tool;
                }
            }
            ui.add_space(GAP);
        }
        let mut act = |icon, on, action: &'static str, ui: &mut Ui| {
            let label = named(action).map_or("", |action| action.label);
            let chosen = icons::choice(ui, on, icon, label, words);
            if chosen.on_hover_text(tip(action, keys)).clicked() {
                out.push(Event::Act(action));
            }
        };
        let region = state.pinned.is_some() && state.pinned == target::region(state);
        act(icons::REGION, region, "pen.region", ui);
        act(icons::SETTINGS, self.settings_open, "pen.settings", ui);
        let menu = ui.menu_button("Recipes", |ui| {
            panel::list(ui, |ui| {
                let mut entry = |label, tip, action, ui: &mut Ui| {
                    if ui.button(label).on_hover_text(tip).clicked() {
                        out.push(Event::Act(action));
                        ui.close();
                    }
                };
                for recipe in &recipes::ALL {
                    entry(recipe.label, recipe.tip, recipe.action, ui);
                }
                if let Some(puffs) = (state.table)("recipe.puffs_at_ends") {
                    entry(puffs.label, puffs.tip, puffs.id, ui);
                }
            });
        });
        menu.response.on_hover_text("Ready-made parts of a graph to draw into.");
        let switch = theme::choice(ui, words, "Words");
        if switch.on_hover_text(tip("pen.words", keys)).clicked() {
            out.push(Event::Act("pen.words"));
        }
    }

    /// The tool in hand, and what it needs: one line whatever that is, so that the picture under it keeps its place.
    fn settings_line(&mut self, state: &State, ui: &mut Ui, out: &mut Vec<Event>) {
        let mut settings = state.settings.pen.clone();
        let action = self.tool.entry().and_then(|(_, _, action, _)| named(action));
        let line = egui::ScrollArea::horizontal().id_salt("pen settings line");
        line.show(ui, |ui| {
            ui.horizontal(|ui| {
                if let Some(Of { label, tip, .. }) = action {
                    let quiet = egui::RichText::new(*label).color(theme::QUIET.of(ui));
                    ui.label(quiet).on_hover_text(*tip);
                }
                match self.tool {
                    PenTool::Select => {
                        // As high as it is with a tool.
                        ui.set_min_height(ui.spacing().interact_size.y);
                    }
                    PenTool::Mask(mode) => self.mask_settings(mode, &mut settings, ui),
                    PenTool::Hair(tool) => {
                        self.hair_settings(tool, &mut settings, ui);
                        act(ui, settings.strands, "hair.strands", out);
                        act(ui, settings.symmetry, "pen.symmetry", out);
                    }
                    _ => {
                        self.tool_settings(&mut settings, ui);
                        self.height(state, ui, out);
                        let node = target::of(state, Fills::Strokes);
                        let mirrored =
                            node.and_then(|id| target::choice(&state.document, &id, "mirror"));
                        let on = mirrored.map_or(settings.symmetry, |word| word == "both");
                        act(ui, on, "pen.symmetry", out);
                    }
                }
            })
        });
        if settings != state.settings.pen {
            let settings =
                crate::core::settings::Settings { pen: settings, ..state.settings.clone() };
            out.push(Event::Settings(settings.into()));
        }
    }

    /// What the tool in hand needs.
    fn tool_settings(&mut self, settings: &mut PenSettings, ui: &mut Ui) {
        let number = |ui: &mut Ui, value: &mut f32, range, unit: &str, name: &str, tip: &str| {
            let drag = egui::DragValue::new(value).range(range).speed(0.02).suffix(unit);
            ui.add(drag.prefix(format!("{name} "))).on_hover_text(tip);
        };
        if self.tool.has_brush() {
            number(
                ui,
                &mut settings.brush,
                0.05..=20.0,
                " cm",
                "Size",
                "Radius of the brush on the scalp.",
            );
        }
        if matches!(self.tool, PenTool::Comb | PenTool::Smooth) {
            let tip = "Strength of one pass, multiplied by pressure.";
            number(ui, &mut settings.strength, 0.01..=1.0, "", "Strength", tip);
        }
        if self.tool == PenTool::Draw {
            let tip = "Pressure of the mouse. Shift is full pressure; the wheel changes it while drawing.";
            number(ui, &mut settings.mouse_pressure, 0.0..=1.0, "", "Mouse pressure", tip);
        }
        if self.tool == PenTool::Points {
            let name = |along: Along| match along {
                Along::Scalp => "on the scalp",
                Along::View => "in the view",
                Along::Normal => "off the scalp",
            };
            let combo = ComboBox::from_id_salt("along").selected_text(name(settings.along));
            let response = combo.show_ui(ui, |ui| {
                for along in [Along::Scalp, Along::View, Along::Normal] {
                    ui.selectable_value(&mut settings.along, along, name(along));
                }
            });
            response.response.on_hover_text("Surface that dragged points move along.");
            let tip =
                "Length along the stroke over which neighbouring points follow a dragged one.";
            number(ui, &mut settings.falloff, 0.0..=50.0, " cm", "Falloff", tip);
        }
    }

    /// What a tool on hair needs: how deep it reaches, its brush, the colour of what it plants.
    fn hair_settings(&mut self, tool: Option<Tool>, settings: &mut PenSettings, ui: &mut Ui) {
        let levels = [
            (Layer::Nearest, "1", "Level 1: the cluster nearest to the eye."),
            (Layer::Through, "2", "Level 2: all hair down to the head."),
            (Layer::Scalp, "3", "Level 3: the skin, and what is rooted there."),
        ];
        ui.label("Level").on_hover_text(
            "How deep a touch reaches. With none chosen: by pen pressure, or by what a mouse touches.",
        );
        for (level, label, tip) in levels {
            let on = self.hair.level == Some(level);
            if ui.selectable_label(on, label).on_hover_text(tip).clicked() {
                self.hair.level = Some(level).filter(|_| !on);
            }
        }
        let brush = matches!(tool, Some(Tool::Smooth | Tool::Puff | Tool::Grab | Tool::Straighten));
        let drag = |value, range, prefix: &str, unit: &str| {
            let drag = egui::DragValue::new(value).range(range).speed(0.02).max_decimals(2);
            drag.prefix(prefix.to_owned()).suffix(unit.to_owned())
        };
        if super::hair::has_brush(tool) {
            let drag = drag(&mut settings.hair_brush, 0.1..=50.0, "Size ", " cm");
            ui.add(drag).on_hover_text("Radius of the brush on the head.");
        }
        if tool.is_some_and(Tool::is_soft) {
            let drag = drag(&mut settings.hair_soft, 0.0..=50.0, "Soft ", " cm");
            ui.add(drag)
                .on_hover_text("Radius within which hair around follows, the less the farther it is. 0: none does.");
        }
        if brush && tool != Some(Tool::Grab) || matches!(tool, None | Some(Tool::Comb)) {
            let drag = drag(&mut settings.strength, 0.01..=1.0, "Strength ", "");
            ui.add(drag)
                .on_hover_text("Strength: from 0.5 on, combed hair moves as far as the pen.");
        }
        if matches!(tool, None | Some(Tool::Implant | Tool::Silhouette)) {
            let mut own = settings.hair_colour.is_some();
            let tip = "Give implanted clusters their own colour instead of the hair's.";
            if ui.checkbox(&mut own, "Colour").on_hover_text(tip).changed() {
                settings.hair_colour = own.then_some([120, 60, 30]);
            }
            if let Some(colour) = &mut settings.hair_colour {
                ui.color_edit_button_srgb(colour);
            }
        }
    }

    /// How high the picked points are over the scalp, as a number. What is typed or dragged holds for all of them.
    fn height(&self, state: &State, ui: &mut Ui, out: &mut Vec<Event>) {
        let scalp = state.shown.as_ref().and_then(|shown| shown.scalp());
        let (Some(scalp), Some(node), Some((id, at)), PenTool::Points) =
            (scalp, target::of(state, Fills::Strokes), self.picked.points.first(), self.tool)
        else {
            return;
        };
        let strokes = target::strokes(&state.document, &node);
        let first = strokes.0.iter().find(|stroke| stroke.id == *id);
        let Some(p) = first.and_then(|stroke| edits::path(scalp, stroke).get(*at).copied()) else {
            return;
        };
        let Some(mut height) = edits::height(scalp, p) else { return };
        let drag = egui::DragValue::new(&mut height).range(-20.0..=100.0).speed(0.02).suffix(" cm");
        let drag = drag.fixed_decimals(2);
        let tip = "Height of the picked points above the scalp.";
        if !ui.add(drag.prefix("Height ")).on_hover_text(tip).changed() {
            return;
        }
        let kind = state.document.node(node.as_str()).map_or("", |node| &node.kind);
        let Some(input) = target::strokes_input(kind) else { return };
        let touched = self.picked.touched();
        let raised = strokes.0.iter().filter(|stroke| touched.contains(&stroke.id)).map(|stroke| {
            let stroke = edits::raised(scalp, stroke, &self.picked.points_of(stroke.id), height);
            Edit::ReplaceStroke { node: node.clone(), input: input.to_owned(), stroke }
        });
        out.push(Event::Nudge(Edit::Several(raised.collect())));
    }

    /// Asks whether the hair that is there stays under a recipe.
    pub(crate) fn recipe_window(
        &mut self,
        state: &State,
        ctx: &egui::Context,
        out: &mut Vec<Event>,
    ) {
        let Some(recipe) = self.asked.and_then(|at| recipes::ALL.get(at)) else { return };
        let at = self.asked.unwrap_or_default();
        let text = "There is hair on the head already.";
        let answers = [
            (
                "Instead",
                "Remove the hair that is there. The head, its masks, and hair in regions of its own (brows, a beard) stay.",
            ),
            ("As well", "Keep the hair that is there."),
        ];
        let answered = panel::question(recipe.label, "recipe over hair", text, &answers, ctx);
        if let Some(Some(answer)) = answered {
            super::actions::cook(self, state, at, answer == 0, out);
        }
        if answered.is_some() {
            self.asked = None;
        }
    }

    /// The window with the settings of devices, when it is open.
    pub fn settings_window(&mut self, state: &State, ctx: &egui::Context, out: &mut Vec<Event>) {
        if !self.settings_open {
            return;
        }
        let mut settings = state.settings.pen.clone();
        let mut open = true;
        panel::window("Pen settings", "pen settings", ctx)
            .open(&mut open)
            .default_pos([24.0, 120.0])
            .default_width(320.0)
            .show(ctx, |ui| {
                panel::body(ui, 300.0, |ui| {
                    let mut names: Vec<String> = self.devices.pens().map(str::to_owned).collect();
                    names.extend([TOUCH.to_owned(), MOUSE.to_owned()]);
                    names.dedup();
                    if self.devices.pens().next().is_none() {
                        ui.label("No pen with pressure is plugged in.");
                        if !self.devices.why_not().is_empty() {
                            ui.label(self.devices.why_not());
                        }
                    }
                    for name in names {
                        let mut feel = settings.feel(&name);
                        let before = feel;
                        let label = match name.as_str() {
                            TOUCH => "Touch screen",
                            MOUSE => "Mouse",
                            pen => pen,
                        };
                        egui::CollapsingHeader::new(label).default_open(true).show(ui, |ui| {
                            self.feel(&mut feel, name == MOUSE, ui);
                        });
                        if feel != before {
                            settings.devices.insert(name, feel);
                        }
                    }
                    ui.separator();
                    ui.checkbox(&mut settings.level_by_mean, "Level by the first 2 pixels")
                        .on_hover_text(
                            "Set the level of a touch by the mean pressure of its first 2 pixels, not the highest of its first 80 ms or 12 pixels.",
                        );
                    ui.checkbox(&mut settings.fingers_draw, "Fingers draw")
                        .on_hover_text("Draw with a finger, unless a pen is near.");
                    ui.label("Last touch");
                    strip(ui, &self.strip);
                })
            });
        self.settings_open = open;
        if settings != state.settings.pen {
            let settings =
                crate::core::settings::Settings { pen: settings, ..state.settings.clone() };
            out.push(Event::Settings(settings.into()));
        }
    }

    fn feel(&self, feel: &mut Feel, mouse: bool, ui: &mut Ui) {
        if !mouse {
            ui.horizontal(|ui| {
                curve(ui, &mut feel.curve);
                ui.vertical(|ui| {
                    for (name, curve) in
                        [("Soft", Curve::SOFT), ("Linear", Curve::LINEAR), ("Firm", Curve::FIRM)]
                    {
                        if ui.selectable_label(feel.curve == curve, name).clicked() {
                            feel.curve = curve;
                        }
                    }
                });
            });
            ui.add(Slider::new(&mut feel.minimum, 0.0..=0.9).text("Minimum pressure"))
                .on_hover_text("Smallest pressure that counts, for worn tips that never lift.");
        }
        ui.add(Slider::new(&mut feel.stabiliser, 0.0..=1.0).text("Stabiliser"))
            .on_hover_text("Lag of the line that smooths out tremor: 1 is 150 ms.");
        ui.add(Slider::new(&mut feel.double_tap, 0.0..=60.0).text("Double tap distance"))
            .on_hover_text("Largest distance between the two taps of a double tap.");
        ui.checkbox(&mut feel.left_handed, "Left-handed").on_hover_text(
            "Put labels to the left of the pen, where the hand does not cover them.",
        );
    }
}

/// The pen's own action of an id.
fn named(id: &str) -> Option<&'static Of<Pen>> {
    super::ACTIONS.iter().copied().flatten().find(|action| action.id == id)
}

/// What is said of an action over its icon: its name, keys and tip.
fn tip(action: &str, keys: KeyNames) -> String {
    let Some(Of { label, tip, .. }) = named(action) else { return String::new() };
    let keys = keys(action).map_or_else(String::new, |keys| format!(" ({keys})"));
    format!("{label}{keys}\n{tip}")
}

/// An action to press, lit while it is on.
fn act(ui: &mut Ui, on: bool, id: &'static str, out: &mut Vec<Event>) {
    if let Some(action) = named(id)
        && theme::choice(ui, on, action.label).on_hover_text(action.tip).clicked()
    {
        out.push(Event::Act(id));
    }
}

/// A pressure curve whose two inner points are dragged.
fn curve(ui: &mut Ui, curve: &mut Curve) {
    let (response, painter) = ui.allocate_painter(Vec2::splat(120.0), Sense::click_and_drag());
    let rect = response.rect.shrink(8.0);
    let on = |(x, y): (f32, f32)| rect.left_bottom() + Vec2::new(x, -y) * rect.size();
    let off = |p: Pos2| {
        let v = (p - rect.left_bottom()) / rect.size();
        (v.x.clamp(0.0, 1.0), (-v.y).clamp(0.0, 1.0))
    };
    let response = response.on_hover_text("Right: pressure of the pen. Up: the pressure used.");
    if let Some(p) = response.interact_pointer_pos() {
        // A drag keeps the point that it took.
        let id = response.id;
        if response.drag_started() || response.clicked() {
            let light = on(curve.light).distance(p) < on(curve.heavy).distance(p);
            ui.data_mut(|data| data.insert_temp(id, light));
        }
        let light = ui.data(|data| data.get_temp(id)).unwrap_or(true);
        *(if light { &mut curve.light } else { &mut curve.heavy }) = off(p);
    }
    painter.rect_filled(response.rect, 3.0, theme::SUNKEN.of(ui));
    let line = (0..=48).map(|k| k as f32 / 48.0).map(|x| on((x, curve.at(x)))).collect();
    for (end, inner) in [((0.0, 0.0), curve.light), ((1.0, 1.0), curve.heavy)] {
        painter.line_segment([on(end), on(inner)], Stroke::new(1.0, theme::LINE.of(ui)));
    }
    painter.add(Shape::line(line, Stroke::new(2.0, theme::ACCENT.of(ui))));
    for inner in [curve.light, curve.heavy] {
        painter.circle(
            on(inner),
            4.0,
            theme::STRONG.of(ui),
            Stroke::new(1.0, theme::GROUND.of(ui)),
        );
    }
}

/// The pressures of a touch, from its begin to its end.
fn strip(ui: &mut Ui, pressures: &[f32]) {
    let size = Vec2::new(ui.available_width(), 48.0);
    let (response, painter) = ui.allocate_painter(size, Sense::hover());
    let rect = response.rect;
    painter.rect_filled(rect, 3.0, theme::SUNKEN.of(ui));
    let step = rect.width() / (pressures.len().max(2) - 1) as f32;
    let at = |(i, p): (usize, &f32)| {
        Pos2::new(rect.left() + step * i as f32, rect.bottom() - p * rect.height())
    };
    let line: Vec<Pos2> = pressures.iter().enumerate().map(at).collect();
    for pair in line.windows(2) {
        let below = |p: Pos2| Pos2::new(p.x, rect.bottom());
        let filled = vec![pair[0], pair[1], below(pair[1]), below(pair[0])];
        painter.add(Shape::convex_polygon(filled, theme::SELECTED.of(ui), Stroke::NONE));
        painter.line_segment([pair[0], pair[1]], Stroke::new(1.5, theme::ACCENT.of(ui)));
    }
}
