//! Values as documents hold them: whether an input may have one, and one form for each thing that can be said.
//!
//! What passes [`fit`] is written to a file and read back as the same value.

use coif_nodes::data::field::Field;
use coif_nodes::data::gestures::Gestures;
use coif_nodes::data::ramp::Ramp;
use coif_nodes::data::strokes::Strokes;
use coif_nodes::define::{Type, Value, short};
use std::sync::Arc;

pub mod grid;
pub(crate) mod suggest;

/// The deepest product of products of fields. Deeper is a mistake or an attack: readers recurse.
pub const DEEPEST_FIELD: usize = 16;

/// `value` in the form in which documents hold what an input of type `ty` takes; else why it cannot
/// be held.
///
/// Whole numbers become numbers where the input takes numbers, constant fields and constant ramps
/// have one form, files are their path, strokes and gestures are brought to the grid in which files keep
/// them.
pub fn fit(ty: Type, value: Value) -> Result<Value, String> {
    let found = value.type_name();
    let value = match (ty, value) {
        (Type::Bool, value @ Value::Bool(_))
        | (Type::Int, value @ Value::Int(_))
        | (Type::Float | Type::Field, value @ Value::Float(_))
        | (Type::Vec3 | Type::Colour, value @ Value::Vec3(_))
        | (Type::Text | Type::File, value @ Value::Text(_))
        | (Type::Ramp, value @ Value::Ramp(_))
        | (Type::Shapes, value @ Value::Shapes(_)) => value,
        (Type::Float | Type::Field, Value::Int(x)) => Value::Float(x as f32),
        (Type::Field, Value::Ramp(ramp)) => Value::Field(Arc::new(Field::Ramp((*ramp).clone()))),
        (Type::Field, Value::Field(field)) => match *field {
            Field::Constant(x) => Value::Float(x),
            _ if field.is_wired() => {
                return Err("painted masks and textures come by wire: connect a node".to_owned());
            }
            _ if depth(&field) > DEEPEST_FIELD => {
                return Err(format!("products are nested deeper than {DEEPEST_FIELD}"));
            }
            _ => Value::Field(field),
        },
        (Type::Ramp, Value::Float(x)) => Value::Ramp(Arc::new(Ramp::constant(x))),
        (Type::Ramp, Value::Int(x)) => Value::Ramp(Arc::new(Ramp::constant(x as f32))),
        (Type::File, Value::File(file)) => Value::Text(file.path.as_str().into()),
        (Type::Choice(words), Value::Text(word)) => {
            if !words.iter().any(|(known, _)| *known == &*word) {
                let known: Vec<&str> = words.iter().map(|(word, _)| *word).collect();
                return Err(no_such_word(&word, &known));
            }
            Value::Text(word)
        }
        (Type::Strokes, Value::Strokes(strokes)) => Value::Strokes(grid::strokes_on_grid(strokes)),
        (Type::Gestures, Value::Gestures(gestures)) => {
            Value::Gestures(grid::gestures_on_grid(gestures))
        }
        (Type::Curves | Type::Scalp, _) => {
            return Err(format!("{} come by wire: connect a node", ty.name()));
        }
        _ => return Err(format!("takes a {}, not a {found}", ty.name())),
    };
    match &value {
        Value::Ramp(ramp) if !ramp.stops().iter().all(|(_, y)| y.is_finite()) => {
            Err("not a finite number".to_owned())
        }
        Value::Strokes(strokes) if strokes.0.iter().any(|stroke| stroke.samples.is_empty()) => {
            Err("a stroke has no samples".to_owned())
        }
        value => value.fault().map_or(Ok(()), Err),
    }?;
    Ok(value)
}

/// Says which words there are in the place of one that is none of them.
pub(crate) fn no_such_word(word: &str, known: &[&str]) -> String {
    // A long one is no slip of the pen.
    let slip = Some(word).filter(|word| word.len() <= 64);
    let meant = slip.and_then(|word| suggest::nearest(word, known.iter().copied()));
    let meant = meant.map_or(String::new(), |meant| format!("; did you mean {meant:?}?"));
    format!("{:?} is none of {}{meant}", short(word), known.join(", "))
}

/// The first item of a list that [`fit`] refuses with those before it, and why.
pub(crate) fn wrong_item(ty: Type, list: &Value) -> Option<(usize, String)> {
    let (mut good, mut bad) = match list {
        Value::Strokes(all) => (0, all.0.len()),
        Value::Gestures(all) => (0, all.0.len()),
        _ => return None,
    };
    let why = |n: usize| {
        let first = match list {
            Value::Strokes(all) => Value::from(Strokes(all.0[..n].to_vec())),
            Value::Gestures(all) => Value::from(Gestures(all.0[..n].to_vec())),
            _ => return None,
        };
        fit(ty, first).err()
    };
    // What some of them do wrong, more of them do too.
    while bad > good + 1 {
        let middle = good + (bad - good) / 2;
        if why(middle).is_some() { bad = middle } else { good = middle }
    }
    why(bad).map(|reason| (good, reason))
}

fn depth(field: &Field) -> usize {
    // By hand and not by recursion: what is measured may be too deep for it.
    let (mut deepest, mut open) = (0, vec![(field, 1)]);
    while let Some((field, depth)) = open.pop() {
        deepest = deepest.max(depth);
        if let Field::Product(parts) = field {
            open.extend(parts.iter().map(|part| (part, depth + 1)));
        }
    }
    deepest
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::document::testing::Random;
    use coif_nodes::data::strokes::{Sample, Stroke};
    use glam::Vec3;

    #[test]
    fn what_fits_fits_again_unchanged() {
        let mut random = Random::new(6);
        let words: &[(&str, &str)] = &[("count", ""), ("spacing", "")];
        for ty in [
            Type::Float,
            Type::Field,
            Type::Ramp,
            Type::Strokes,
            Type::Gestures,
            Type::Choice(words),
        ] {
            for _ in 0..100 {
                let value = random.value(ty);
                assert_eq!(fit(ty, value.clone()).unwrap().key(), value.key());
            }
        }
    }

    #[test]
    fn what_fits_is_written_and_read_back_to_the_bit() {
        // -0.0 is no step of a grid: kept, it would come back as 0.0, under another key.
        let sample = Sample { position: Vec3::new(1.0, -0.0, 0.0), ..Sample::default() };
        let strokes = Value::from(Strokes(vec![Stroke::new(7, vec![sample])]));
        let mut gesture = Random::new(1).gesture(&Gestures::default());
        gesture.samples[0].at.x = -0.0;
        gesture.strength = -0.0;
        let gestures = Gestures(vec![gesture]);
        for (ty, value) in [(Type::Strokes, strokes), (Type::Gestures, gestures.into())] {
            let held = fit(ty, value).unwrap();
            let back = crate::text::read_value(ty, &crate::text::write_value(&held)).unwrap();
            assert_eq!(back.key(), held.key());
        }
    }

    #[test]
    fn what_cannot_be_held_is_refused_in_words() {
        let check = |ty, value: Value, why: &str| assert_eq!(fit(ty, value).unwrap_err(), why);
        check(Type::Int, 0.5.into(), "takes a whole number, not a number");
        check(Type::Float, f32::INFINITY.into(), "not a finite number");
        check(Type::Ramp, Ramp::constant(f32::NAN).into(), "not a finite number");
        let empty = Strokes(vec![Stroke::new(1, vec![])]);
        check(Type::Strokes, empty.into(), "a stroke has no samples");
        let mut deep = Field::Constant(1.0);
        for _ in 0..DEEPEST_FIELD {
            deep = Field::Product(vec![deep]);
        }
        check(Type::Field, deep.into(), "products are nested deeper than 16");
    }
}
