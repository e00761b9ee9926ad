//! Override strands: single hairs changed by hand, each identified by its id.
//!
//! methods.md 6, "Beyond": per-strand overrides. Ids do not depend on the amount of hair, so an override survives a
//! change of density, of upstream nodes and of the head.
//!
//! Guarantees: hairs that no override names keep their bits; roots and ids stay; turning and lifting keep a hair's
//! shape, as far as the skin leaves room; no point ends up deeper in the skin than allowed. Not promised: that a hair's
//! values follow its length (each point keeps its own); that a hair of two or three points, which cannot bend, stays
//! out of the skin in between.

use crate::data::attributes::{COLOUR, Domain, FIBRE, WIDTH};
use crate::data::curves::{Curves, Tuft};
use crate::data::route::{Lengths, Policy, Route};
use crate::data::scalp::Scalp;
use crate::define::{NodeError, node, short};
use crate::eval::{EvalCx, Piece, Quality};
use crate::maths::spline::{CurveFault, Spline};
use crate::maths::transcendental::sin_cos;
use glam::{Quat, Vec3};
use std::collections::BTreeMap;
use std::sync::Arc;

node! {
    /// Changes single hairs by hand: remove, shorten, turn, lift, thicken or colour them.
    ///
    /// The spreadsheet and the viewport show a hair's id. An override affects that hair only, and stays with it at any
    /// density.
    ///
    /// Changes: `remove`; `length` in cm (cut, or stretched in proportion); `turn` in degrees about the scalp normal,
    /// counterclockwise seen from outside; `lift` in degrees off the skin; `width` as a factor; `colour` as linear red,
    /// green, blue. Angles run from -180 to 180.
    "override_strands", version 1, label "Override strands",
        words "override edit single hair strand stray pluck remove delete tweak manual hand paint fix flyaway select id", thins;
    inputs {
        /// Hair to change.
        curves: Curves;
        /// The head.
        scalp: Arc<Scalp>;
        /// Overrides, each an id and its changes (remove, length, turn, lift, width, colour), such as `57d468d8e00ddc87
        /// turn 20, lift 10; 4d36 remove`.
        overrides: Arc<str> = "", words("ids list edits");
    }
    outputs {
        /// The hair, with the named ones changed or removed.
        curves: Curves;
    }
}

/// Changes of one hair.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Change {
    remove: bool,
    /// In cm; `None`: unchanged.
    length: Option<f32>,
    /// Degrees.
    turn: f32,
    lift: f32,
    width: Option<f32>,
    colour: Option<Vec3>,
}

/// Range of lengths, cm.
const LENGTHS: std::ops::RangeInclusive<f32> = 0.01..=1000.0;
/// The most ids that a message names.
const NAMED: usize = 4;

fn eval(cx: &EvalCx, inputs: Inputs) -> Result<Outputs, NodeError> {
    let (changes, wrong) = read(&inputs.overrides);
    wrong.iter().take(NAMED).for_each(|wrong| cx.warn(wrong));
    if wrong.len() > NAMED {
        cx.warn(format!("{} more overrides are wrong", wrong.len() - NAMED));
    }
    if changes.is_empty() {
        return Ok(Outputs { curves: inputs.curves });
    }
    let [curves] = cx.each_tuft(&inputs.curves, |tuft, piece| {
        let asked = (0..tuft.len()).filter(|i| !tuft.curve(*i).is_empty());
        let asked = asked.filter_map(|i| Some((i, *changes.get(&tuft.id(i))?)));
        let asked: Vec<(usize, Change)> = asked.collect();
        piece.tick()?;
        changed(tuft, &asked, &inputs.scalp, piece).map(|tuft| [tuft])
    })?;
    let mut missing: BTreeMap<u64, &Change> = changes.iter().map(|(id, c)| (*id, c)).collect();
    for (tuft, i) in inputs.curves.each() {
        missing.remove(&tuft.id(i));
    }
    // At preview quality most ids are missing, which is not an error.
    if !missing.is_empty() && cx.quality == Quality::Final {
        let ids: Vec<String> = missing.keys().take(NAMED).map(|id| format!("{id:016x}")).collect();
        let more = if missing.len() > NAMED { ", ..." } else { "" };
        cx.warn(format!(
            "{} of {} overridden hairs are not there: {}{more}",
            missing.len(),
            changes.len(),
            ids.join(", ")
        ));
    }
    Ok(Outputs { curves })
}

/// The changes in a text, and messages for invalid entries.
fn read(text: &str) -> (BTreeMap<u64, Change>, Vec<String>) {
    let (mut found, mut wrong): (BTreeMap<u64, Change>, _) = (BTreeMap::new(), vec![]);
    for entry in text.split([';', '\n']).map(str::trim).filter(|entry| !entry.is_empty()) {
        let (id, asked) = entry.split_once(char::is_whitespace).unwrap_or((entry, ""));
        let Ok(id) = u64::from_str_radix(id, 16) else {
            wrong.push(format!(
                "{:?} does not begin with a hair's id, such as 57d468d8e00ddc87",
                short(entry)
            ));
            continue;
        };
        let mut change = found.get(&id).copied().unwrap_or_default();
        let all = asked.split(',').try_for_each(|one| change.take(one));
        match all {
            Ok(()) => drop(found.insert(id, change)),
            Err(reason) => wrong.push(format!("{:?}: {reason}", short(entry))),
        }
    }
    (found, wrong)
}

impl Change {
    /// Parses one word with its numbers.
    fn take(&mut self, one: &str) -> Result<(), String> {
        let mut words = one.split_whitespace();
        let word = words.next().unwrap_or_default();
        let numbers: Vec<f32> = words
            .map(|w| w.parse().map_err(|_| format!("{:?} is no number", short(w))))
            .collect::<Result<_, _>>()?;
        let within = |range: std::ops::RangeInclusive<f32>| match numbers[..] {
            [x] if range.contains(&x) => Ok(x),
            _ => Err(format!("{word} takes one number from {} to {}", range.start(), range.end())),
        };
        match word {
            "remove" if numbers.is_empty() => self.remove = true,
            "length" => self.length = Some(within(LENGTHS)?),
            "turn" => self.turn = within(-180.0..=180.0)?,
            "lift" => self.lift = within(-180.0..=180.0)?,
            "width" => self.width = Some(within(0.0..=100.0)?),
            "colour" => match numbers[..] {
                [r, g, b] if [r, g, b].iter().all(|c| (0.0..=100.0).contains(c)) => {
                    self.colour = Some(Vec3::new(r, g, b));
                }
                _ => {
                    return Err("colour takes red, green and blue from 0 to 100, 1 is white".into());
                }
            },
            _ => return Err("expected remove, length, turn, lift, width or colour".into()),
        }
        Ok(())
    }
    /// Shapes a curve about its root; returns its length relative to the original.
    fn shape(&self, curve: &mut [Vec3], scalp: &Scalp) -> Result<f32, CurveFault> {
        let (root, mut share) = (curve[0], 1.0);
        if let Some(length) = self.length {
            let spline = Spline::new(curve)?;
            share = length / spline.length();
            if share > 1.0 {
                curve.iter_mut().skip(1).for_each(|p| *p = root + (*p - root) * share);
            } else {
                let at = |k: usize| spline.at(spline.u_of_cv(k) * share);
                let cut: Vec<Vec3> = (0..curve.len()).map(at).collect();
                curve[1..].copy_from_slice(&cut[1..]);
            }
        }
        if self.turn == 0.0 && self.lift == 0.0 {
            return Ok(share);
        }
        let Some(normal) = scalp.closest_root(root).map(|root| root.normal) else {
            return Ok(share);
        };
        let turn = turned(normal, self.turn);
        // Its direction is that of its middle; an upright hair has none and is lifted in any direction.
        let way = turn * (curve[curve.len() / 2] - root);
        let aside = way.cross(normal).try_normalize();
        let lift = aside.map_or(Quat::IDENTITY, |aside| turned(aside, self.lift));
        curve.iter_mut().skip(1).for_each(|p| *p = root + lift * (turn * (*p - root)));
        Ok(share)
    }
}

fn changed(
    tuft: &Tuft,
    asked: &[(usize, Change)],
    scalp: &Scalp,
    piece: &mut Piece,
) -> Result<Tuft, NodeError> {
    if asked.is_empty() {
        return Ok(tuft.edit().build());
    }
    // Whoever places a hair by hand says where it lies, over partings too.
    let policy = Policy { lengths: Lengths::Free, own_section: false };
    let route = Route::new(Some(scalp), policy);
    let mut moved = route.moved(tuft);
    let mut shares = vec![1.0f32; tuft.len()];
    for (i, change) in asked {
        piece.tick()?;
        let mut curve = tuft.curve(*i).to_vec();
        let shaped = change.shape(&mut curve, scalp);
        match (shaped, moved.hair(*i, &mut curve)) {
            (Err(fault), _) => piece.trouble(tuft.id(*i), fault),
            (Ok(share), Ok(())) => shares[*i] = share,
            (Ok(_), Err(why)) => piece.trouble(tuft.id(*i), why),
        }
    }
    let mut edit = moved.done().unwrap_or_else(|| tuft.edit());
    if shares.iter().any(|share| *share != 1.0) && tuft.attribute(FIBRE.name).is_some() {
        let fibre = tuft.view(FIBRE);
        let of = |i: usize| match tuft.curve(i) {
            [] => 0.0,
            _ => fibre.at(i, tuft.range(i).start) * shares[i],
        };
        edit.set(FIBRE, Domain::Curve, (0..tuft.len()).map(of).collect());
    }
    if asked.iter().any(|(_, change)| change.width.is_some()) {
        let width = tuft.view(WIDTH);
        let mut all = on_points(tuft, |i, k| width.at(i, k));
        for (i, change) in asked {
            all[tuft.range(*i)].iter_mut().for_each(|w| *w *= change.width.unwrap_or(1.0));
        }
        edit.set(WIDTH, Domain::Point, all);
    }
    if asked.iter().any(|(_, change)| change.colour.is_some()) {
        let colour = tuft.view(COLOUR);
        let mut all = on_points(tuft, |i, k| colour.at(i, k));
        for (i, change) in asked {
            all[tuft.range(*i)].iter_mut().for_each(|c| *c = change.colour.unwrap_or(*c));
        }
        edit.set(COLOUR, Domain::Point, all);
    }
    let edited = edit.build();
    let mut gone = asked.iter().filter(|(_, change)| change.remove).map(|(i, _)| *i).peekable();
    if gone.peek().is_none() {
        return Ok(edited);
    }
    let mut stays = vec![true; tuft.len()];
    gone.for_each(|i| stays[i] = false);
    let kept: Vec<u32> = (0..).zip(&stays).filter(|(_, stays)| **stays).map(|(i, _)| i).collect();
    Ok(edited.gather(&kept).build())
}

fn on_points<T>(tuft: &Tuft, at: impl Fn(usize, usize) -> T) -> Vec<T> {
    (0..tuft.len())
        .flat_map(|i| tuft.range(i).map(move |k| (i, k)))
        .map(|(i, k)| at(i, k))
        .collect()
}

/// A rotation by this angle about a unit axis.
fn turned(axis: Vec3, degrees: f32) -> Quat {
    let (sin, cos) = sin_cos(0.5 * degrees.to_radians());
    Quat::from_xyzw(axis.x * sin, axis.y * sin, axis.z * sin, cos)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::attributes::ID;
    use crate::data::curves::TuftBuilder;
    use crate::data::scalp::tests::shared_ball;
    use crate::testing::{curves_of, run};

    /// Hairs that lean off the top of the ball along x, 6 cm long; ids 0x10 to 0x14.
    fn hair() -> Curves {
        let mut b = TuftBuilder::new();
        for i in 0..5 {
            let root = shared_ball().closest_root(Vec3::new(0.0, 9.0, i as f32)).unwrap().point;
            let at = |k: i32| root + Vec3::new(0.3 * k as f32, 0.4 * k as f32, 0.0);
            b.push_curve(&(0..13).map(at).collect::<Vec<_>>());
        }
        b.set(ID, Domain::Curve, (0x10..0x15).collect());
        b.set(WIDTH, Domain::Curve, vec![0.01; 5]);
        b.set(FIBRE, Domain::Curve, vec![12.0; 5]);
        Curves::new(vec![b.build().into()])
    }

    fn with(text: &str) -> (Curves, Vec<String>) {
        let set = [
            ("curves", hair().into()),
            ("scalp", shared_ball().into()),
            ("overrides", text.into()),
        ];
        let (out, said) = run(&NODE, &set);
        (curves_of(&out[0]).clone(), said)
    }

    #[test]
    fn only_what_is_named_changes() {
        let (out, said) = with("11 turn 90; 12 length 3, width 2; 14 remove");
        assert!(said.is_empty(), "{said:?}");
        let (old, new) = (&hair().tufts()[0].clone(), &out.tufts()[0].clone());
        assert_eq!((0..4).map(|i| new.id(i)).collect::<Vec<_>>(), [0x10, 0x11, 0x12, 0x13]);
        assert_eq!((new.len(), new.curve(0), new.curve(3)), (4, old.curve(0), old.curve(3)));
        for i in 0..4 {
            assert_eq!(old.curve(i)[0], new.curve(i)[0]);
        }
        let widths = new.view(WIDTH);
        assert_eq!((widths.at(1, 20), widths.at(2, 30)), (0.01, 0.02));
        let cut = Spline::new(new.curve(2)).unwrap().length();
        assert!((cut - 3.0).abs() < 1e-3, "{cut}");
        assert!((new.view(FIBRE).at(2, 26) - 6.0).abs() < 1e-3);
        let (a, b) = (old.curve(1), new.curve(1));
        let far = |c: &[Vec3]| c[0].distance(c[12]);
        assert!((far(a) - far(b)).abs() < 1e-4);
        // A quarter turn from x, counterclockwise seen from above: toward -z.
        let way = b[12] - b[0];
        assert!(way.z < -2.9 && way.x.abs() < 1.0, "{way}");
    }

    #[test]
    fn hair_is_lifted_and_laid_but_never_into_the_head() {
        let tip = |text: &str| {
            let (out, _) = with(text);
            let curve = out.tufts()[0].curve(0).to_vec();
            (curve[12] - curve[0], curve)
        };
        let (up, _) = tip("10 lift 30");
        assert!(up.y > 5.5, "{up}");
        let (_, laid) = tip("10 lift -170");
        let skin = shared_ball().clone();
        let skin = skin.skin();
        assert!(laid.iter().skip(1).all(|p| skin.distance(*p) > -1e-3), "{laid:?}");
        let (longer, _) = tip("10 length 12");
        assert!((longer.length() - 12.0).abs() < 1e-3, "{longer}");
        let (_, same) = tip("10 turn 0");
        assert_eq!(same, hair().tufts()[0].curve(0));
    }

    #[test]
    fn what_cannot_be_done_is_told_and_left() {
        for (text, said) in [
            ("zz turn 3", "does not begin with a hair's id"),
            ("10 spin 3", "expected remove, length, turn, lift, width or colour"),
            ("10", "expected remove"),
            ("10 turn", "turn takes one number from -180 to 180"),
            ("10 turn 300", "turn takes one number from -180 to 180"),
            ("10 length nan", "length takes one number from 0.01 to 1000"),
            ("10 colour 1 2", "colour takes red, green and blue"),
            ("10 width two", "\"two\" is no number"),
            (&format!("10 width {}", "9x".repeat(100_000)), "is no number"),
            ("99 remove; 9a remove", "2 of 2 overridden hairs are not there: 0000000000000099"),
        ] {
            let (out, told) = with(text);
            assert!(told.len() == 1 && told[0].contains(said), "{text}: {told:?}");
            assert!(told[0].len() < 300, "a message quotes no more than it must");
            assert_eq!(out.key(), hair().key(), "{text}");
        }
        let (out, _) = with("10 colour 1 0 0.5");
        assert_eq!(out.tufts()[0].view(COLOUR).at(0, 5), Vec3::new(1.0, 0.0, 0.5));
    }
}
