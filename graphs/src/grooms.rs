//! The grooms and templates that come with coif, inside the program, so that they open from any folder.

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
pub const TEMPLATES: &[(&str, &str)] = &[
    ("cornrows", include_str!("../templates/cornrows.ron")),
    ("box_braids", include_str!("../templates/box_braids.ron")),
    ("two_strand_twists", include_str!("../templates/two_strand_twists.ron")),
    ("puff", include_str!("../templates/puff.ron")),
    ("coil_set", include_str!("../templates/coil_set.ron")),
    ("waves", include_str!("../templates/waves.ron")),
    ("fringe", include_str!("../templates/fringe.ron")),
    ("baby_hair", include_str!("../templates/baby_hair.ron")),
    ("pony_tail", include_str!("../templates/pony_tail.ron")),
    ("dutch_braids", include_str!("../templates/dutch_braids.ron")),
    ("coils_4a", include_str!("../templates/coils_4a.ron")),
    ("bob", include_str!("../templates/bob.ron")),
    ("afro", include_str!("../templates/afro.ron")),
    ("sketch_hair", include_str!("../templates/sketch_hair.ron")),
    ("flow_hair", include_str!("../templates/flow_hair.ron")),
    ("draw_cornrows", include_str!("../templates/draw_cornrows.ron")),
    ("flat_twists", include_str!("../templates/flat_twists.ron")),
    ("draw_box_braids", include_str!("../templates/draw_box_braids.ron")),
    ("draw_two_strand_twists", include_str!("../templates/draw_two_strand_twists.ron")),
    ("locks", include_str!("../templates/locks.ron")),
    ("long_straight", include_str!("../templates/long_straight.ron")),
    ("short_back_and_sides", include_str!("../templates/short_back_and_sides.ron")),
    ("beard", include_str!("../templates/beard.ron")),
    ("brows", include_str!("../templates/brows.ron")),
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
