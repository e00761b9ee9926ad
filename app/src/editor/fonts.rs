//! Letters of every script: where the window's own fonts have none, those of the system stand behind them.
//!
//! Guarantees: the window never waits for it, and what the own fonts have stays theirs. Not promised: letters of a script
//! that no font of the system has, and joined or stacked forms, which the toolkit does not make.

use egui::{FontData, FontDefinitions, FontFamily};
use fontdb::{Database, Style};
use skrifa::{FontRef, MetadataProvider as _};
use std::sync::Arc;

/// Scripts that names may be in, each by letters that its fonts have: Japanese, Chinese, Korean, Arabic, Hebrew, Devanagari,
/// Bengali, Tamil, Telugu, Thai, Georgian, Armenian, Ethiopic, Khmer, symbols and emoji.
const SCRIPTS: &[&str] = &[
    "あア漢",
    "简体",
    "한글",
    "عربي",
    "שלום",
    "नमस्ते",
    "বাংলা",
    "தமிழ்",
    "తెలుగు",
    "ไทย",
    "ქართ",
    "Հայ",
    "አማር",
    "ខ្មែ",
    "☀♥✂",
    "😀🦀🥨",
];
/// A larger file is not kept in memory for a few letters.
const MOST_BYTES: usize = 64 << 20;

/// Looks for fonts on a thread, and gives them to the context when they are found.
pub(super) fn load(ctx: &egui::Context) {
    let ctx = ctx.clone();
    // Without a thread the window has the letters of its own fonts.
    let _ = std::thread::Builder::new().name("fonts".to_owned()).spawn(move || {
        let mut system = Database::new();
        system.load_system_fonts();
        if let Some(fonts) = with_system(FontDefinitions::default(), &system) {
            ctx.set_fonts(fonts);
            ctx.request_repaint();
        }
    });
}

/// Whether a font has all of these letters.
fn has(data: &[u8], index: u32, letters: &str) -> bool {
    let Ok(font) = FontRef::from_index(data, index) else { return false };
    let map = font.charmap();
    letters.chars().all(|c| map.map(c).is_some())
}

/// Fonts with those of the system behind them that have what they lack; none where there is nothing to add.
fn with_system(mut fonts: FontDefinitions, system: &Database) -> Option<FontDefinitions> {
    let mut faces: Vec<_> =
        system.faces().filter(|face| face.style == Style::Normal && !face.monospaced).collect();
    // Plain faces first, then in an order of their own and not of the folder's.
    faces.sort_by_key(|face| {
        let name = face.families.first().map_or("", |(name, _)| name.as_str());
        let serif = name.contains("Serif") || name.contains("Mincho") || name.contains("Ming");
        (face.weight.0.abs_diff(400), serif, name.to_owned(), face.index)
    });
    let own: Vec<Arc<FontData>> = fonts.families[&FontFamily::Proportional]
        .iter()
        .filter_map(|name| fonts.font_data.get(name).cloned())
        .collect();
    let mut added: Vec<String> = vec![];
    for letters in SCRIPTS {
        let each_known = letters.chars().all(|c| {
            let c = c.to_string();
            own.iter().any(|font| has(&font.font, font.index, &c))
                || added.iter().any(|name| {
                    fonts.font_data.get(name).is_some_and(|font| has(&font.font, font.index, &c))
                })
        });
        if each_known {
            continue;
        }
        let found = faces.iter().find_map(|face| {
            let fits = |data: &[u8], index: u32| {
                let fits = data.len() <= MOST_BYTES && has(data, index, letters);
                fits.then(|| (data.to_vec(), index))
            };
            system.with_face_data(face.id, fits).flatten()
        });
        if let Some((data, index)) = found {
            let name = format!("system {letters}");
            let data = FontData { index, ..FontData::from_owned(data) };
            fonts.font_data.insert(name.clone(), data.into());
            added.push(name);
        }
    }
    for family in [FontFamily::Proportional, FontFamily::Monospace] {
        fonts.families.entry(family).or_default().extend(added.iter().cloned());
    }
    (!added.is_empty()).then_some(fonts)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn letters_that_a_font_of_the_system_has_are_drawn() {
        let mut system = Database::new();
        system.load_system_fonts();
        let known = |fonts: &FontDefinitions, letters: &str| {
            let names = &fonts.families[&FontFamily::Proportional];
            let all: Vec<_> = names.iter().map(|name| &fonts.font_data[name]).collect();
            letters.chars().all(|c| {
                let c = c.to_string();
                all.iter().any(|font| has(&font.font, font.index, &c))
            })
        };
        let own = FontDefinitions::default();
        assert!(known(&own, "Aä😀") && !known(&own, "ع"), "emoji are the window's own");
        let Some(fonts) = with_system(own.clone(), &system) else {
            println!("skipped: no font of this system has letters that the window lacks");
            return;
        };
        let names = &fonts.families[&FontFamily::Proportional];
        let before = &own.families[&FontFamily::Proportional];
        assert_eq!(&names[..before.len()], &before[..], "what the window has stays its own");
        for letters in SCRIPTS {
            let somewhere = system.faces().any(|face| {
                let plain = face.style == Style::Normal && !face.monospaced;
                let fits =
                    |data: &[u8], index| data.len() <= MOST_BYTES && has(data, index, letters);
                plain && system.with_face_data(face.id, fits).unwrap_or(false)
            });
            assert_eq!(known(&fonts, letters), somewhere || known(&own, letters), "{letters}");
        }
    }
}
