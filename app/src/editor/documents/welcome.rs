//! The welcome panel: shipped grooms with pictures, the empty head, one's own head, and what was open lately. It never blocks
//! anything.

use super::DocumentEvent;
use super::recent::Recent;
use crate::core::documents::Purpose;
use crate::core::event::Event;
use crate::core::settings::Settings;
use crate::core::state::State;
use crate::rooms::pen::recipes;
use crate::widgets::panel;
use coif_graphs::document::Thumbnail;
use coif_graphs::grooms;
use egui::{
    Align, Button, ColorImage, Image, Layout, Rect, RichText, ScrollArea, TextureHandle, Vec2,
};
use std::collections::BTreeMap;

/// Pictures of the shipped grooms, 160 x 120, drawn by `coif render`.
const PICTURES: &[(&str, &[u8])] = &[
    ("start", include_bytes!("thumbnails/start.png")),
    ("cornrows", include_bytes!("thumbnails/cornrows.png")),
    ("cornrows_gathered", include_bytes!("thumbnails/cornrows_gathered.png")),
    ("cornrows_puffs", include_bytes!("thumbnails/cornrows_puffs.png")),
    ("box_braids", include_bytes!("thumbnails/box_braids.png")),
    ("french_braid", include_bytes!("thumbnails/french_braid.png")),
    ("dutch_braids", include_bytes!("thumbnails/dutch_braids.png")),
    ("twists", include_bytes!("thumbnails/twists.png")),
    ("braids", include_bytes!("thumbnails/braids.png")),
    ("curls", include_bytes!("thumbnails/curls.png")),
    ("waves_2b", include_bytes!("thumbnails/waves_2b.png")),
    ("curls_3b", include_bytes!("thumbnails/curls_3b.png")),
    ("finger_coils", include_bytes!("thumbnails/finger_coils.png")),
    ("coils_4a", include_bytes!("thumbnails/coils_4a.png")),
    ("zigzag_4b", include_bytes!("thumbnails/zigzag_4b.png")),
    ("afro_4c", include_bytes!("thumbnails/afro_4c.png")),
    ("puffs", include_bytes!("thumbnails/puffs.png")),
    ("ponytail", include_bytes!("thumbnails/ponytail.png")),
    ("clusters", include_bytes!("thumbnails/clusters.png")),
    ("sketch_bob", include_bytes!("thumbnails/sketch_bob.png")),
    ("sketch_ponytail", include_bytes!("thumbnails/sketch_ponytail.png")),
    ("sketch_mohawk", include_bytes!("thumbnails/sketch_mohawk.png")),
];

const SIZE: Vec2 = Vec2::new(160.0, 120.0);
/// The panel has two pictures side by side where there is room for them.
const WIDTH: f32 = 376.0;
/// What the panel's frame and scroll bar take beside the pictures.
const FRAME: f32 = 34.0;
const SCROLL_BAR: f32 = 10.0;
/// What a card is larger than its picture, with the room to the next.
const CARD: Vec2 = Vec2::new(18.0, 30.0);

/// Whether the panel is open, and its pictures once it was.
#[derive(Default)]
pub(crate) struct Welcome {
    pub(crate) is_open: bool,
    pictures: BTreeMap<&'static str, TextureHandle>,
}

/// Shows it, when it is open.
pub(super) fn window(
    welcome: &mut Welcome,
    recent: &Recent,
    state: &State,
    picture_at: Option<Rect>,
    ctx: &egui::Context,
    out: &mut Vec<Event>,
) {
    if !welcome.is_open {
        return;
    }
    let mut said = vec![];
    let mut say = |event: DocumentEvent| said.push(event);
    let mut tour = false;
    let (mut open, mut shows) = (true, state.settings.welcome);
    let place = panel::beside(panel::room(ctx), picture_at, SIZE.x + FRAME..=WIDTH);
    panel::window("Welcome", "welcome", ctx)
        .open(&mut open)
        .collapsible(false)
        .default_size(place.size())
        .default_pos(place.min)
        .show(ctx, |ui| {
            panel::body(ui, 140.0, |ui| {
                // The last line stays in sight, where there is room for more.
                let room = panel::room(ctx).height();
                let rest = if room < 240.0 { f32::INFINITY } else { room - 130.0 };
                ScrollArea::vertical().max_height(rest).show(ui, |ui| {
                    ui.heading("Begin with");
                    ui.horizontal_wrapped(|ui| {
                        let button = ui.button("Empty head").on_hover_text("A head without hair");
                        if button.clicked() {
                            say(DocumentEvent::New(None));
                        }
                        let tip = "A new groom on your own mesh (.obj, .glb, .gltf, .vrm)";
                        if ui.button("Your own head…").on_hover_text(tip).clicked() {
                            say(DocumentEvent::Ask(Purpose::NewHead));
                        }
                        if ui.button("Open a groom…").on_hover_text("A .ron file").clicked() {
                            say(DocumentEvent::Ask(Purpose::Open));
                        }
                        let tip =
                            "Five minutes on the cornrows: look around, draw, braid, part, save";
                        tour = ui.button("Take the tour").on_hover_text(tip).clicked();
                    });
                    ui.label(
                        RichText::new("A mesh or a groom can also be dropped on the window.")
                            .weak(),
                    );
                    ui.add_space(8.0);
                    ui.heading("Draw").on_hover_text("An empty head with the pen ready to draw");
                    ui.horizontal_wrapped(|ui| {
                        for recipe in recipes::ALL.iter().filter(|it| it.is_drawn()) {
                            if ui.button(recipe.label).on_hover_text(recipe.tip).clicked() {
                                say(DocumentEvent::Begin(recipe.action));
                            }
                        }
                    });
                    recent_files(recent, ui, &mut say);
                    ui.add_space(8.0);
                    let wide = ui.available_width() - SCROLL_BAR;
                    let columns = (wide / (SIZE.x * 0.75)).floor().max(1.0);
                    let size = SIZE * ((wide / columns - CARD.x) / SIZE.x).clamp(0.25, 1.0);
                    ui.heading("Recipes").on_hover_text("Start with this hair on an empty head");
                    ui.horizontal_wrapped(|ui| {
                        // Templates have square pictures.
                        let size = Vec2::splat(size.y);
                        for recipe in recipes::ALL.iter().filter(|it| !it.is_drawn()) {
                            let picture = of_template(&mut welcome.pictures, recipe, ctx);
                            if card(ui, recipe.tip, recipe.label, picture, size) {
                                say(DocumentEvent::Begin(recipe.action));
                            }
                        }
                    });
                    ui.add_space(8.0);
                    ui.heading("Grooms");
                    ui.horizontal_wrapped(|ui| {
                        for (name, text) in grooms::ALL {
                            let bytes = PICTURES.iter().find(|(known, _)| known == name);
                            let picture =
                                bytes.and_then(|found| picture(&mut welcome.pictures, *found, ctx));
                            let title = title_of(text);
                            let tip = format!("A new groom like {title}");
                            if card(ui, &tip, title, picture, size) {
                                say(DocumentEvent::New(Some(name)));
                            }
                        }
                    });
                });
                ui.separator();
                ui.checkbox(&mut shows, "Show this at every start");
            })
        });
    if tour {
        said.push(DocumentEvent::New(Some("cornrows")));
    }
    out.extend(said.into_iter().map(Event::Documents));
    if tour {
        out.push(Event::Act("help.tour"));
    }
    if shows != state.settings.welcome {
        let settings = Settings { welcome: shows, ..state.settings.clone() };
        out.push(Event::Settings(Box::new(settings)));
    }
    if !open {
        out.push(Event::Documents(DocumentEvent::Welcome(false)));
    }
}

fn recent_files(recent: &Recent, ui: &mut egui::Ui, say: &mut dyn FnMut(DocumentEvent)) {
    if recent.files().is_empty() {
        return;
    }
    ui.add_space(8.0);
    ui.heading("Recent");
    for path in recent.files() {
        ui.horizontal(|ui| {
            let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
            let missing = recent.is_missing(path);
            let words = if missing { format!("{name} (missing)") } else { name.clone() };
            let line = ui.add_enabled(!missing, Button::new(words).frame(false));
            let shown = path.display().to_string();
            if line.on_hover_text(&shown).on_disabled_hover_text(&shown).clicked() {
                say(DocumentEvent::Open(path.clone()));
            }
            if missing
                && ui.small_button("Forget").on_hover_text("Remove it from this list").clicked()
            {
                say(DocumentEvent::Forget(path.clone()));
            }
        });
    }
}

/// A picture with its name, to press on.
fn card(
    ui: &mut egui::Ui,
    tip: &str,
    title: &str,
    picture: Option<&TextureHandle>,
    size: Vec2,
) -> bool {
    let mut clicked = false;
    let room = size + Vec2::new(12.0, 30.0);
    ui.allocate_ui_with_layout(room, Layout::top_down(Align::Min), |ui| {
        ui.set_max_width(room.x);
        let button = match picture {
            Some(picture) => {
                let image = Image::from_texture((picture.id(), size)).alt_text(title);
                ui.add(Button::image(image))
            }
            None => ui.add_sized(size, Button::new(title)),
        };
        clicked = button.on_hover_text(tip).clicked();
        ui.add(egui::Label::new(RichText::new(title).small()).truncate());
    });
    clicked
}

fn picture<'a>(
    known: &'a mut BTreeMap<&'static str, TextureHandle>,
    (name, bytes): (&'static str, &[u8]),
    ctx: &egui::Context,
) -> Option<&'a TextureHandle> {
    if !known.contains_key(name) {
        let icon = eframe::icon_data::from_png_bytes(bytes).ok()?;
        let size = [icon.width as usize, icon.height as usize];
        let image = ColorImage::from_rgba_unmultiplied(size, &icon.rgba);
        known.insert(name, ctx.load_texture(format!("groom {name}"), image, Default::default()));
    }
    known.get(name)
}

/// The picture that a recipe's template has in its file.
fn of_template<'a>(
    known: &'a mut BTreeMap<&'static str, TextureHandle>,
    recipe: &recipes::Recipe,
    ctx: &egui::Context,
) -> Option<&'a TextureHandle> {
    if known.contains_key(recipe.action) {
        return known.get(recipe.action);
    }
    picture(known, (recipe.action, thumbnail_of(recipe.template)?.png()), ctx)
}

/// The picture of a template that comes with coif, from its text, where it stands last.
fn thumbnail_of(name: &str) -> Option<Thumbnail> {
    let (_, text) = grooms::TEMPLATES.iter().find(|(known, _)| *known == name)?;
    let (_, last) = text.rsplit_once("thumbnail: \"")?;
    Thumbnail::from_text(last.split_once('"')?.0).ok()
}

/// The title of a shipped groom, from its text.
fn title_of(text: &str) -> &str {
    let found = text.lines().find_map(|line| line.trim().strip_prefix("title: \""));
    found.and_then(|rest| rest.strip_suffix("\",")).unwrap_or("Groom")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_shipped_groom_has_a_small_picture_and_its_title() {
        for (name, text) in grooms::ALL {
            let (_, bytes) = PICTURES.iter().find(|(known, _)| known == name).unwrap();
            assert!(bytes.len() <= 12 << 10, "{name}: {} bytes", bytes.len());
            let icon = eframe::icon_data::from_png_bytes(bytes).unwrap();
            assert_eq!((icon.width, icon.height), (160, 120), "{name}");
            assert_eq!(title_of(text), coif_graphs::file::read(text).unwrap().document.title);
        }
        assert_eq!(PICTURES.len(), grooms::ALL.len());
        for recipe in recipes::ALL.iter().filter(|it| !it.is_drawn()) {
            let thumbnail = thumbnail_of(recipe.template).expect(recipe.template);
            assert_eq!(thumbnail.size(), [160, 160], "{}", recipe.template);
            assert!(eframe::icon_data::from_png_bytes(thumbnail.png()).is_ok());
        }
    }
}
