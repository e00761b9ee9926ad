//! The interface of a group and its template, as files have them.

use crate::document::Origin;
use crate::text::there;
use crate::text::tokens::trimmed;
use crate::text::values::{placed_value, quoted, write_to};
use crate::values::no_such_word;
use coif_nodes::declared::{self, Interface, Port};
use coif_nodes::define::{Arity, Type, Unit};
use ron::value::RawValue;
use serde::Deserialize;
use std::collections::BTreeSet;
use std::fmt::Write as _;

/// What a group declares.
#[derive(Default, Deserialize)]
#[serde(deny_unknown_fields, rename = "Interface")]
pub(super) struct FileInterface<'a> {
    #[serde(borrow, default)]
    inputs: Vec<FilePort<'a>>,
    #[serde(borrow, default)]
    outputs: Vec<FilePort<'a>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields, rename = "Port")]
struct FilePort<'a> {
    name: Name,
    #[serde(default)]
    was: Vec<Name>,
    r#type: Kind,
    #[serde(default)]
    doc: String,
    #[serde(borrow, default, deserialize_with = "there")]
    default: Option<&'a RawValue>,
    #[serde(default, deserialize_with = "there")]
    range: Option<(f64, f64)>,
    #[serde(default, deserialize_with = "there")]
    slider: Option<(f64, f64)>,
    #[serde(default)]
    unit: Counts,
    #[serde(default)]
    section: String,
    #[serde(default)]
    choices: Vec<(String, String)>,
    #[serde(default)]
    needed: bool,
    #[serde(default)]
    many: bool,
}

/// As [`crate::document::Origin`].
#[derive(Deserialize)]
#[serde(deny_unknown_fields, rename = "Template")]
pub(super) struct FileOrigin {
    pub(super) name: String,
    #[serde(default)]
    pub(super) version: String,
    #[serde(default)]
    pub(super) hash: String,
    #[serde(default)]
    pub(super) locked: bool,
    #[serde(default)]
    pub(super) author: String,
    #[serde(default)]
    pub(super) licence: String,
    #[serde(default)]
    pub(super) tags: Vec<String>,
    #[serde(default)]
    pub(super) source: String,
    #[serde(default)]
    pub(super) needs: Vec<String>,
}

impl From<FileOrigin> for Origin {
    fn from(file: FileOrigin) -> Self {
        let FileOrigin { name, version, hash, locked, author, licence, tags, source, needs } = file;
        Self { name, version, hash, locked, author, licence, tags, source, needs }
    }
}

/// What a template says of itself: a field a line, those that say something.
pub(super) fn origin_fields(origin: &Origin) -> Vec<String> {
    let Origin { name, version, hash, locked, author, licence, tags, source, needs } = origin;
    let mut fields = vec![];
    let texts = [
        ("name", name),
        ("version", version),
        ("hash", hash),
        ("author", author),
        ("licence", licence),
        ("source", source),
    ];
    for (field, text) in texts {
        if !text.is_empty() || field == "name" {
            let mut line = format!("{field}: ");
            quoted(&mut line, text);
            fields.push(line);
        }
    }
    for (field, texts) in [("tags", tags), ("needs", needs)] {
        if !texts.is_empty() {
            let mut line = format!("{field}: ");
            write_texts(&mut line, texts);
            fields.push(line);
        }
    }
    if *locked {
        fields.push("locked: true".to_owned());
    }
    fields
}

/// Words of a file, read where the reader knows the line.
macro_rules! word {
    ($name:ident($inner:ty), $read:expr) => {
        struct $name($inner);
        impl<'de> Deserialize<'de> for $name {
            fn deserialize<D: serde::Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
                let text = String::deserialize(from)?;
                let read: fn(String) -> Result<$inner, String> = $read;
                read(text).map($name).map_err(serde::de::Error::custom)
            }
        }
    };
}
word!(Name(String), |text| match declared::is_name(&text) {
    true => Ok(text),
    false => Err(declared::BadInterface::Name(text.chars().take(64).collect()).to_string()),
});
word!(Kind(Type), |text| {
    let found = TYPES.iter().find(|(word, _)| *word == text).map(|(_, ty)| *ty);
    found.ok_or_else(|| {
        let known: Vec<&str> = TYPES.iter().map(|(word, _)| *word).collect();
        no_such_word(&text, &known)
    })
});
word!(Counts(Unit), |text| {
    let found = UNITS.iter().find(|(word, _)| *word == text).map(|(_, unit)| *unit);
    found.ok_or_else(|| {
        let known: Vec<&str> = UNITS.iter().skip(1).map(|(word, _)| *word).collect();
        no_such_word(&text, &known)
    })
});
impl Default for Counts {
    fn default() -> Self {
        Self(Unit::None)
    }
}

/// What ports carry, in the words of the manual.
pub const TYPES: [(&str, Type); 15] = [
    ("true or false", Type::Bool),
    ("whole number", Type::Int),
    ("number", Type::Float),
    ("field", Type::Field),
    ("vector", Type::Vec3),
    ("colour", Type::Colour),
    ("text", Type::Text),
    ("choice", Type::Choice(&[])),
    ("file", Type::File),
    ("ramp", Type::Ramp),
    ("shape list", Type::Shapes),
    ("strokes", Type::Strokes),
    ("gestures", Type::Gestures),
    ("curves", Type::Curves),
    ("scalp", Type::Scalp),
];

/// What numbers of ports count.
pub const UNITS: [(&str, Unit); 8] = [
    ("", Unit::None),
    ("ratio", Unit::Ratio),
    ("cm", Unit::Length),
    ("degrees", Unit::Angle),
    ("count", Unit::Count),
    ("per cm", Unit::PerCm),
    ("per cm2", Unit::PerCm2),
    ("degrees per cm", Unit::AnglePerCm),
];

/// The interface that a file declares, without what cannot be used of it, and what that is.
pub(super) fn interface(file: FileInterface) -> (Interface, Vec<String>) {
    let mut said = vec![];
    let [inputs, outputs] = [file.inputs, file.outputs].map(|side| ports(side, &mut said));
    let interface = Interface::new(inputs, outputs).unwrap_or_else(|err| {
        said.push(format!("interface: {err}: dropped"));
        Interface::default()
    });
    (interface, said)
}

fn ports(side: Vec<FilePort>, said: &mut Vec<String>) -> Vec<Port> {
    let (mut ports, mut seen) = (vec![], BTreeSet::new());
    for file in side {
        let name = file.name.0;
        let mut say = |what: String| said.push(format!("port {name}: {what}: dropped"));
        if !seen.insert(name.clone()) {
            say("there is another of this name".to_owned());
            continue;
        }
        if ports.len() == declared::MOST_PORTS {
            say(format!("there are {} before it, and no more can be", declared::MOST_PORTS));
            continue;
        }
        let ty = match file.r#type.0 {
            Type::Choice(_) => declared::choice(&file.choices),
            ty => ty,
        };
        let read = file.default.map(|raw| placed_value(ty, trimmed(raw.get_ron())));
        let default = match read {
            Some(Ok(value)) => Some(value),
            Some(Err(wrong)) => {
                say(format!("its default {}", wrong.reason));
                None
            }
            None => None,
        };
        let mut range = |what: &str, range: Option<(f64, f64)>| {
            range.filter(|(lo, hi)| {
                let fits = lo.is_finite() && hi.is_finite() && lo < hi;
                if !fits {
                    say(format!("its {what} is {lo} to {hi}"));
                }
                fits
            })
        };
        let (hard, soft) = (range("range", file.range), range("slider", file.slider));
        let arity = match (file.many, file.needed) {
            (true, _) => Arity::Many,
            (false, true) => Arity::One,
            (false, false) => Arity::Optional,
        };
        let (doc, unit, section) = (file.doc, file.unit.0, file.section);
        let was = file.was.into_iter().map(|name| name.0).collect();
        ports.push(Port { name, was, doc, ty, arity, default, hard, soft, unit, section });
    }
    ports
}

/// A list of texts on one line.
pub(super) fn write_texts(out: &mut String, texts: &[String]) {
    out.push('[');
    for (n, text) in texts.iter().enumerate() {
        out.push_str(if n > 0 { ", " } else { "" });
        quoted(out, text);
    }
    out.push(']');
}

/// One port on one line.
pub(super) fn write_port(out: &mut String, port: &Port) {
    let Port { name, was, doc, ty, arity, default, hard, soft, unit, section } = port;
    let text = |out: &mut String, field: &str, text: &str| {
        if !text.is_empty() {
            let _ = write!(out, ", {field}: ");
            quoted(out, text);
        }
    };
    out.push_str("(name: ");
    quoted(out, name);
    let same = |known: &Type| std::mem::discriminant(known) == std::mem::discriminant(ty);
    let word = TYPES.iter().find(|(_, known)| same(known)).map_or("", |(word, _)| word);
    text(out, "type", word);
    if !was.is_empty() {
        out.push_str(", was: ");
        write_texts(out, was);
    }
    if let Some(value) = default {
        out.push_str(", default: ");
        write_to(out, value, None);
    }
    for (field, range) in [("range", hard), ("slider", soft)] {
        if let Some((lo, hi)) = range {
            let _ = write!(out, ", {field}: ({lo:?}, {hi:?})");
        }
    }
    let word = UNITS.iter().find(|(_, known)| known == unit).map_or("", |(word, _)| word);
    text(out, "unit", word);
    match arity {
        Arity::One => out.push_str(", needed: true"),
        Arity::Many => out.push_str(", many: true"),
        Arity::Optional => {}
    }
    text(out, "section", section);
    if let Type::Choice(words) = ty {
        out.push_str(", choices: [");
        for (n, (word, doc)) in words.iter().enumerate() {
            out.push_str(if n > 0 { ", (" } else { "(" });
            quoted(out, word);
            out.push_str(", ");
            quoted(out, doc);
            out.push(')');
        }
        out.push(']');
    }
    text(out, "doc", doc);
    out.push(')');
}
