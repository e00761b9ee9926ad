//! Of which template a group was made, whether the library has a newer version, and what that would change.

use crate::core::event::Event;
use crate::core::state::State;
use crate::core::templates::{self, Newer, Which};
use crate::widgets::theme;
use coif_graphs::document::{NodeId, Origin};
use coif_graphs::template::{Fate, OverrideOutcome};
use egui::{Label, RichText, ScrollArea, Ui};

/// Height of the list of what would change.
const LIST: f32 = 160.0;

/// Shows it, over the inputs of an instance.
pub(super) fn show(state: &State, ui: &mut Ui, id: &NodeId, origin: &Origin, out: &mut Vec<Event>) {
    let mut say = |event: templates::TemplateEvent| out.push(Event::Templates(event));
    let made_of = format!("Made of {} {}", origin.name, origin.version);
    ui.add(Label::new(RichText::new(made_of.trim_end()).color(theme::QUIET.of(ui))).truncate())
        .on_hover_text(from(origin));
    let quiet = |ui: &mut Ui, text: &str| ui.label(RichText::new(text).color(theme::QUIET.of(ui)));
    if origin.locked {
        ui.horizontal_wrapped(|ui| {
            quiet(ui, "Kept at this version.");
            let tip = "Offer newer versions of its template again";
            if ui.button("Let it be upgraded").on_hover_text(tip).clicked() {
                say(templates::TemplateEvent::Keep { id: id.clone(), kept: false });
            }
        });
        return;
    }
    match templates::newer(state, origin) {
        Newer::Unread | Newer::Newest => {}
        Newer::Missing => {
            quiet(ui, "Its template is not in your library; the graph holds all of it.");
        }
        Newer::There(newer) => {
            let text = match newer.origin.version == origin.version {
                true => format!("The library has another version {}", newer.origin.version),
                false => format!("Version {} is in the library", newer.origin.version),
            };
            ui.label(RichText::new(format!("⬆ {text}")).color(theme::ACCENT.of(ui)));
            let offer = state.offer.as_ref().filter(|offer| offer.id == *id);
            if let Some(offer) = offer {
                told(ui, &offer.overrides, offer.changed_inside);
            }
            ui.horizontal_wrapped(|ui| {
                match offer {
                    None => {
                        let tip =
                            "List what happens to every value and wire on it. Nothing changes yet";
                        if ui.button("Show what changes").on_hover_text(tip).clicked() {
                            let template = Which(newer.clone());
                            say(templates::TemplateEvent::Compare { id: id.clone(), template });
                        }
                    }
                    Some(offer) => {
                        let words =
                            if offer.changed_inside { "Upgrade all the same" } else { "Upgrade" };
                        let tip =
                            format!("Replace it by version {}, as one undo step", offer.version());
                        if ui.button(words).on_hover_text(tip).clicked() {
                            say(templates::TemplateEvent::Upgrade);
                        }
                        if ui.button("Not now").on_hover_text("Close the list").clicked() {
                            say(templates::TemplateEvent::NotNow);
                        }
                    }
                }
                let tip = "Stay at this version and offer no newer ones";
                if ui.button("Keep this version").on_hover_text(tip).clicked() {
                    say(templates::TemplateEvent::Keep { id: id.clone(), kept: true });
                }
            });
        }
    }
}

/// Who made it and where it comes from.
fn from(origin: &Origin) -> String {
    let Origin { author, licence, source, .. } = origin;
    let lines = [("by ", author), ("licence ", licence), ("", source)];
    let lines: Vec<String> =
        lines.iter().filter(|(_, text)| !text.is_empty()).map(|(a, b)| format!("{a}{b}")).collect();
    match lines.is_empty() {
        true => "Origin not stated".to_owned(),
        false => lines.join("\n"),
    }
}

/// Every value and wire with its fate, what is lost first.
fn told(ui: &mut Ui, told: &[OverrideOutcome], changed_inside: bool) {
    if changed_inside {
        let text = "⚠ It was changed inside: these changes would be lost.";
        ui.label(RichText::new(text).color(theme::WARNING.of(ui)));
    }
    if told.is_empty() {
        ui.label("Nothing is set on it or wired to it: nothing can be lost.");
        return;
    }
    let rank = |told: &&OverrideOutcome| match told.fate {
        Fate::Lost { .. } => 0,
        Fate::Clamped { .. } => 1,
        Fate::Moved { .. } => 2,
        Fate::Kept => 3,
    };
    let mut told: Vec<&OverrideOutcome> = told.iter().collect();
    told.sort_by_key(rank);
    let list = ScrollArea::vertical().id_salt("fates").max_height(LIST).auto_shrink([false, true]);
    list.show(ui, |ui| {
        for told in told {
            let (sign, colour) = match told.fate {
                Fate::Lost { .. } => ("✖", theme::ERROR.of(ui)),
                Fate::Clamped { .. } => ("⚠", theme::WARNING.of(ui)),
                Fate::Moved { .. } => ("⏵", theme::TEXT.of(ui)),
                Fate::Kept => ("•", theme::QUIET.of(ui)),
            };
            let text = format!("{sign} {told}");
            let line = ui.add(Label::new(RichText::new(&text).color(colour)).truncate());
            line.on_hover_text(text);
        }
    });
}
