//! Chooses the head of a mesh, and says first what is doubtful about it.
//!
//! Doubtful is a head without a face, one among several that are alike, and a mesh with nothing that is plainly a head. Each is said
//! in words, with what the parts of the mesh look like and how to choose another one.
//!
//! Guarantees: nothing is said of a single head with a face. A cranium above which the mesh goes on, such as a knee, is never taken
//! for a head. Not promised: that a statue of several people in one piece shows all of them.

use super::axes::{Forward, Up};
use super::face::{By, FACE};
use super::find::{FoundHead, Look, Pieces, Search, Tried};
use super::fit::{self, Fit};
use super::parts::Parts;
use crate::define::NodeError;
use crate::eval::EvalCx;
use glam::Vec3;

/// Number of other axes, the most promising ones, that are examined closely.
const MOST_AXES: usize = 2;
/// The most heads of one piece whose places are told.
const MOST_PLACES: usize = 6;

/// A mesh to find a head in, in the file's axes.
#[derive(Clone, Copy)]
pub(super) struct Choice<'a> {
    pub(super) points: &'a [Vec3],
    pub(super) triangles: &'a [[u32; 3]],
    pub(super) pieces: &'a Pieces,
}

impl Choice<'_> {
    /// The head with the given axis up; if there is none, with another axis that clearly shows one. A cranium that is not
    /// one is dropped and reported.
    pub(super) fn head(
        &self,
        cx: &EvalCx,
        parts: &Parts,
        up: Up,
        forward: Forward,
    ) -> Result<(Up, FoundHead), NodeError> {
        let mut search = Search::new(self.points, self.triangles, self.pieces);
        let check = || cx.check();
        let tried = search.try_up(up, &check)?;
        let asked = search.head(&tried, true, &check)?;
        if asked.is_sure() {
            let found = search.with_joined(&tried, asked, &check)?;
            self.tell_others(cx, &tried, &found, parts);
            return Ok((up, found));
        }
        if let Some(found) = search.one_of_many(&tried, &check)? {
            let found = search.with_joined(&tried, found, &check)?;
            self.tell_others(cx, &tried, &found, parts);
            return Ok((up, found));
        }
        // Messages about the face have to stay true.
        let stays_true = |other: &Up| forward.axis().is_none_or(|axis| other.turned(axis).y == 0.0);
        let others = Up::ALL.into_iter().filter(|other| *other != up).filter(stays_true);
        let mut promising =
            others.map(|other| search.try_up(other, &check)).collect::<Result<Vec<_>, _>>()?;
        promising.sort_by(|a, b| b.promises().total_cmp(&a.promises()));
        let mut best = None::<(&Tried, FoundHead)>;
        for other in promising.iter().filter(|other| other.promises() > 0.0).take(MOST_AXES) {
            let found = search.head(other, false, &check)?;
            let before = best.as_ref().map_or(FACE, |(_, found)| found.likeness());
            if found.is_sure() && found.is_bare() && found.likeness() > before {
                best = Some((other, found));
            }
        }
        if let Some((other, found)) = best {
            let (was, is) = (up.name(), other.up().name());
            cx.remark(format!(
                "no head was found with {was} up, and one with {is} up: the mesh was turned so (up: {is})"
            ));
            let found = search.with_joined(other, found, &check)?;
            self.tell_others(cx, other, &found, parts);
            return Ok((other.up(), found));
        }
        let account = self.account(&tried, parts);
        if let Some(fit) = asked.fit.filter(Fit::head_like) {
            let neck = search.has_neck(&tried, &fit);
            self.doubt_face(cx, &asked, parts, neck, &account);
            return Ok((up, asked));
        }
        doubt_all(cx, up, asked.fit, &account);
        Ok((up, FoundHead::default()))
    }

    /// The names of the pieces for which `is` holds.
    fn named(&self, parts: &Parts, is: impl Fn(u32) -> bool) -> String {
        parts.listed_mostly_in(&self.pieces.of.iter().map(|of| is(*of)).collect::<Vec<_>>())
    }

    /// What the parts look like, as a sentence after others; empty for a mesh in one piece.
    fn account(&self, tried: &Tried, parts: &Parts) -> String {
        if self.pieces.count() <= 1 {
            return String::new();
        }
        let looks: Vec<(u32, Look)> = tried.looks().collect();
        let look = |piece: u32| looks.iter().find(|(of, _)| *of == piece).map(|(_, look)| *look);
        let kinds = [
            (Some(Look::Head), "like a head"),
            (Some(Look::Beneath), "like a cranium, but the mesh goes on above it, as above a knee"),
            (Some(Look::Round), "round as a cranium, without a face"),
            (None, "without a cranium"),
        ];
        let told: Vec<String> = kinds
            .into_iter()
            .map(|(kind, words)| (self.named(parts, |piece| look(piece) == kind), words))
            .filter(|(names, _)| !names.is_empty())
            .map(|(names, words)| format!("{names}: {words}"))
            .collect();
        match told.is_empty() {
            true => String::new(),
            false => format!(". Its parts: {}", told.join("; ")),
        }
    }

    /// Reports additional heads.
    fn tell_others(&self, cx: &EvalCx, tried: &Tried, found: &FoundHead, parts: &Parts) {
        if let (Some(piece), false) = (found.piece, found.others.is_empty()) {
            let this = self.named(parts, |of| of == piece);
            let others = self.named(parts, |of| found.others.contains(&of));
            let many = if found.others.len() == 1 { "another head" } else { "other heads" };
            let (which, this) = match this.is_empty() || others.is_empty() {
                true => (String::new(), "one of them".to_owned()),
                false => (format!(", {others}"), this),
            };
            cx.warn(format!(
                "the mesh has {many}{which}: hair grows on {this} alone. For hair on another one leave this one out \
                 (leave_out), or choose where it grows (region){}",
                self.account(tried, parts)
            ));
        }
        if let (Some(fit), false) = (found.fit, found.joined.is_empty()) {
            // Three turns undo one, and half turns undo themselves.
            let up = tried.up();
            let place = |at: &Vec3| {
                let at = (0..3).fold(*at, |at, _| up.turned(at));
                format!("({:.4} {:.4} {:.4})", at.x, at.y, at.z)
            };
            let places: Vec<String> = found.joined.iter().take(MOST_PLACES).map(place).collect();
            let count = found.joined.len();
            let heads = if count == 1 { "another head" } else { "other heads" };
            cx.warn(format!(
                "{} alike: the mesh has {heads} at {} in the file's units: hair grows on the one at {} alone. For hair on \
                 another one leave this one out (leave_out), or, where they are one part, cut them apart in the program that \
                 made them or choose where it grows (region){}",
                count + 1,
                places.join(", "),
                place(&fit.centre),
                self.account(tried, parts)
            ));
        }
    }

    /// Reports a head that shows no face.
    fn doubt_face(&self, cx: &EvalCx, found: &FoundHead, parts: &Parts, neck: bool, account: &str) {
        let piece = found.piece.map(|piece| self.named(parts, |of| of == piece));
        let what =
            piece.filter(|names| !names.is_empty()).map_or("what".to_owned(), |n| n + ", which");
        let face = match (found.likeness() >= FACE, found.face.map(|face| face.by)) {
            (true, Some(By::Likeness)) => {
                "has a face, if it is one, beside the plane in which it mirrors"
            }
            (true, _) => "is no whole cranium",
            (false, _) => "has no face",
        };
        let neck = if neck { "" } else { " and no neck under it" };
        cx.warn(format!(
            "{what} was taken for the head {face}{neck}. If it is no head, tick \"No human head\" (fit: none); if another \
             part is, leave this one out (leave_out){account}"
        ));
    }
}

/// Reports a mesh without a head.
fn doubt_all(cx: &EvalCx, up: Up, fit: Option<Fit>, account: &str) {
    let up = up.name();
    let seen = match fit.filter(|fit| fit.p50.is_finite()) {
        Some(fit) => format!(
            "with {up} up half of what lies under the highest point is farther than {:.0} % of the radius from a sphere, of a \
             head less than {:.0} %",
            fit.p50 * 100.0,
            fit::HEAD_LIKE * 100.0
        ),
        None => format!("with {up} up no sphere fits what lies under the highest point"),
    };
    let ask = match account.is_empty() {
        true => "",
        false => ". If one of them is the head, name the others in leave_out",
    };
    cx.warn(format!(
        "no human cranium was found: {seen}; with another axis up no head was found either. So the mesh keeps its own \
         coordinates. If it is an animal or a thing, tick \"No human head\" (fit: none); if it is a person, set up, or name \
         in leave_out what stands on the head{account}{ask}"
    ));
}

/// Reports if something on the crown may have disturbed the sphere's fit.
pub(super) fn doubt_crown(cx: &EvalCx, fit: Option<&Fit>, parts: &Parts) {
    let Some(fit) = fit.filter(|fit| !fit.is_bare()) else { return };
    let told = parts.listed();
    let parts = match told.is_empty() {
        true => "the mesh has no parts that could be left out".to_owned(),
        false => format!("leave it out (leave_out; the parts are {told})"),
    };
    cx.warn(format!(
        "the crown is no good sphere: 5 % of it is farther off than {:.0} % of the radius, of a head less than {:.0} %. If hair \
         or a hat stands on it, {parts}, or set radius and centre",
        fit.p95 * 100.0,
        fit::BARE * 100.0
    ));
}
