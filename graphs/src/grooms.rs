//! The grooms and recipes that come with coif, inside the program, so that they open from any folder.

/// Name and text of every shipped groom.
pub const ALL: &[(&str, &str)] = &[
    ("start", include_str!("../grooms/start.ron")),
    ("cornrows", include_str!("../grooms/cornrows.ron")),
    ("cornrows_gathered", include_str!("../grooms/cornrows_gathered.ron")),
    ("cornrows_puffs", include_str!("../grooms/cornrows_puffs.ron")),
    ("box_braids", include_str!("../grooms/box_braids.ron")),
    ("french_braid", include_str!("../grooms/french_braid.ron")),
    ("dutch_braids", include_str!("../grooms/dutch_braids.ron")),
    ("twists", include_str!("../grooms/twists.ron")),
    ("braids", include_str!("../grooms/braids.ron")),
    ("curls", include_str!("../grooms/curls.ron")),
    ("waves_2b", include_str!("../grooms/waves_2b.ron")),
    ("curls_3b", include_str!("../grooms/curls_3b.ron")),
    ("finger_coils", include_str!("../grooms/finger_coils.ron")),
    ("coils_4a", include_str!("../grooms/coils_4a.ron")),
    ("zigzag_4b", include_str!("../grooms/zigzag_4b.ron")),
    ("afro_4c", include_str!("../grooms/afro_4c.ron")),
    ("puffs", include_str!("../grooms/puffs.ron")),
    ("ponytail", include_str!("../grooms/ponytail.ron")),
    ("clusters", include_str!("../grooms/clusters.ron")),
    ("sketch_bob", include_str!("../grooms/sketch_bob.ron")),
    ("sketch_ponytail", include_str!("../grooms/sketch_ponytail.ron")),
    ("sketch_mohawk", include_str!("../grooms/sketch_mohawk.ron")),
];

/// Name and text of every template that comes with coif.
pub const TEMPLATES: &[(&str, &str)] = &[];

/// Name and text of every recipe: a small groom on a head, to be put onto another document's. Where the pen is to draw, the node
/// that takes it is there and empty.
pub const RECIPES: &[(&str, &str)] = &[
    ("sketch_hair", include_str!("../recipes/sketch_hair.ron")),
    ("cornrows", include_str!("../recipes/cornrows.ron")),
    ("flat_twists", include_str!("../recipes/flat_twists.ron")),
    ("box_braids", include_str!("../recipes/box_braids.ron")),
    ("two_strand_twists", include_str!("../recipes/two_strand_twists.ron")),
    ("locks", include_str!("../recipes/locks.ron")),
    ("long_straight", include_str!("../recipes/long_straight.ron")),
    ("bob", include_str!("../recipes/bob.ron")),
    ("waves", include_str!("../recipes/waves.ron")),
    ("fringe", include_str!("../recipes/fringe.ron")),
    ("pony_tail", include_str!("../recipes/pony_tail.ron")),
    ("puff", include_str!("../recipes/puff.ron")),
    ("afro", include_str!("../recipes/afro.ron")),
    ("short_back_and_sides", include_str!("../recipes/short_back_and_sides.ron")),
];

/// The grooms that are as full as a film's hero: 60,000 strands and more, a few seconds to evaluate.
pub const HEROES: &[&str] = &[
    "cornrows_gathered",
    "cornrows_puffs",
    "box_braids",
    "afro_4c",
    "finger_coils",
    "waves_2b",
    "ponytail",
    "french_braid",
    "dutch_braids",
    "twists",
];

/// The groom of that name, with or without `.ron`.
pub fn by_name(name: &str) -> Option<&'static str> {
    let name = name.strip_suffix(".ron").unwrap_or(name);
    ALL.iter().find(|(known, _)| *known == name).map(|(_, text)| *text)
}
