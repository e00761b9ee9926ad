//! Shape-list curl: curls whose turns draw their cross-sections from a list (Lightyear 3.1).
//!
//! Guarantees: roots stay where they are; equal ids give equal curls whatever else is there; the path is C1 while
//! `blend` is above 0; a size of 0 changes nothing; in `fibre` mode the arc length is the source's within
//! 0.5 %, or that of a `fibre_length` that the source has room for. Not promised: that hairs keep clear of each other, or that a curl much wider than its
//! source's bends does not loop through itself.

use super::preset::Numbers;
use super::section::{Shape, entries};
use super::winding::{Detail, Pattern, Sizes, Winder};
use crate::data::attributes::{ALLOW_DEPTH, Attribute, Domain, FIBRE, NORMAL, Name, PARENT, ROLL};
use crate::data::curves::{Curves, Tuft, TuftBuilder, View};
use crate::data::scalp::{Scalp, Skin};
use crate::data::shapes::ShapeList;
use crate::define::{FieldInput, NodeError, choice, node};
use crate::eval::{EvalCx, Piece};
use crate::maths::frame::carry;
use crate::maths::hash::KeyBuilder;
use crate::maths::rail::Rail;
use crate::maths::spline::Spline;
use crate::shape::resample::between;
use glam::Vec3;
use std::sync::Arc;

node! {
    /// Winds curves into waves, curls, coils and kinks whose cross-sections are drawn, turn by turn, from a list of shapes.
    ///
    /// Choose a preset and change what you like: every number left unset is the preset's, every number that is set
    /// replaces it. What was used is told in the node's messages. Hairs of one parent share a curl as far as
    /// `definition` says.
    "shape_list_curl", version 1, label "Shape-list curl",
        words "curl curly wave wavy coil coily kink kinky ringlets helix spiral perm texture type 2a 2b 2c 3a 3b 3c 4a 4b 4c zigzag guide process cross-section uniformity";
    inputs {
        /// Curves to wind, one curl along each.
        curves: Curves;
        /// Head that curls stay out of, and whose masks numbers may use. Where a curl is pushed out, its length is put right once.
        scalp: Option<Arc<Scalp>>;
        /// Type that unset numbers are taken from. Starting points, not measurements.
        preset: Preset = Preset::Type3b, words("type hair pattern chart");
        /// Cross-sections in tiers: A is the primary shape, B the secondary, C the tertiary. Unset: the preset's.
        shapes: Option<Arc<ShapeList>>, words("cross-section lame polygon ellipse circle rose");
        /// Share of turns that have a shape of tier A, from 0 (none) to 1 (all). Unset: the preset's.
        uniformity: Option<f32>, hard(0.0, 1.0), unit(Ratio);
        /// How many turns have a shape of tier B for each one of tier C. Unset: the preset's.
        b_to_c: Option<f32>, hard(0.0, 1000.0), soft(0.0, 10.0);
        /// Diameter of a coil; a flat wave of it is 1.41 times as high from crest to trough. 0 leaves curves as they are. Unset: the preset's.
        diameter: Option<FieldInput>, hard(0.0, 100.0), soft(0.1, 4.0), unit(Length), handle(Handle::Radius),
            words("amplitude radius size width");
        /// Length of the source that one turn takes; a small one makes tight curls that shrink much. Unset: the preset's.
        pitch: Option<FieldInput>, hard(0.02, 1000.0), soft(0.2, 8.0), unit(Length), handle(Handle::Along),
            words("frequency wavelength period turns");
        /// Factor of the diameter; draw a ramp to let curls grow or fade from root to tip.
        amount: FieldInput = 1.0, hard(0.0, 10.0), soft(0.0, 2.0), words("amplitude ramp taper strength");
        /// Share of turns that are Z-bends: straight legs and sharp bends in a plane that changes. Unset: the preset's.
        z_bends: Option<f32>, hard(0.0, 1.0), unit(Ratio), words("zigzag kink");
        /// How closely hairs of one parent follow the same curl, from 0 (each its own: loose, dry) to 1 (all alike: set with product). In between, hairs keep step with the others until they leave, one here and one there, for a curl of their own. Unset: the preset's.
        definition: Option<FieldInput>, hard(0.0, 1.0), unit(Ratio), words("clump product gel frizz styling");
        /// Share of turns at which the curl changes its direction, as a telephone cord does. Unset: the preset's.
        switchbacks: Option<f32>, hard(0.0, 1.0), unit(Ratio), words("perversion reversal tendril");
        /// Share of turns that are skipped, where the hair runs nearly straight for one turn. Unset: the preset's.
        skipped: Option<f32>, hard(0.0, 1.0), unit(Ratio), words("skip period straight");
        /// How much curls differ over the head in size and in pitch, from 0 (all alike) to 1 (from half to twice). No head has one curl everywhere. Unset: the preset's.
        spread: Option<f32>, hard(0.0, 1.0), unit(Ratio), words("variation random mixed");
        /// How much turns of a curl differ in size, as a share of it. Unset: the preset's.
        amplitude_range: Option<f32>, hard(0.0, 0.95), soft(0.0, 0.6), unit(Ratio), words("random irregular");
        /// How much turns of a curl differ in how many there are to a length, as a share of it. Unset: the preset's.
        frequency_range: Option<f32>, hard(0.0, 0.9), soft(0.0, 0.6), unit(Ratio), words("random irregular pitch");
        /// How far a turn may run ahead or behind, as a share of a turn. Unset: the preset's.
        phase_range: Option<f32>, hard(0.0, 0.5), soft(0.0, 0.2), unit(Ratio), words("random irregular shift");
        /// How far a turn may lie off the source curve, as a share of the curl's radius. Unset: the preset's.
        offset_range: Option<f32>, hard(0.0, 2.0), soft(0.0, 1.0), unit(Ratio), words("random irregular wander");
        /// Part of each turn over which it changes from the last one; 0 makes corners where turns differ. Unset: the preset's.
        blend: Option<f32>, hard(0.0, 1.0), unit(Ratio), words("smooth transition");
        /// Least radius of a shape's corners and of Z-bends, as a share of the shape's radius. Ellipses are not rounded. Unset: the preset's.
        rounding: Option<f32>, hard(0.05, 1.0), soft(0.05, 0.6), unit(Ratio), words("corner sharp");
        /// Length from the root that stays straight.
        start: f32 = 0.0, hard(0.0, 1000.0), soft(0.0, 10.0), unit(Length), handle(Handle::Along), words("offset root straight");
        /// Turns over which the curl grows to its full size; few let it turn away from the root at once. Unset: the preset's.
        rise: Option<f32>, hard(0.25, 100.0), soft(0.5, 6.0), words("blend root grow");
        /// Direction of the turns, seen along the hair from the root.
        hand: Hand = Hand::Random, words("handedness chirality clockwise s z");
        /// What starts in the same phase.
        phase_lock: Lock = Lock::Clump, words("clump synchronised free");
        /// Angle at which curls start; with `all`, every curl starts there.
        phase: f32 = 0.0, hard(-360.0, 360.0), soft(-180.0, 180.0), unit(Angle);
        /// Turns the cross-section about the curve; the plane of a flat wave turns with it. Added to the curves' own roll.
        roll: FieldInput = 0.0, hard(-36000.0, 36000.0), soft(-180.0, 180.0), unit(Angle), handle(Handle::Angle);
        /// Whether a hair reaches as far as before or stays as long as before.
        length: Keep = Keep::Span, words("shrinkage stretch keep");
        /// What decides the number of points.
        points: Points = Points::PerTurn, words("cvs resolution segments");
        /// Points on a turn of full size, when given by the turn. Smaller turns get fewer, but eight at least.
        points_per_turn: f32 = 12.0, hard(8.0, 256.0), soft(8.0, 32.0), unit(Count), words("cvs resolution segments");
        /// How far a coil may lie off the straight line between two points, when given by tolerance.
        tolerance: f32 = 0.01, hard(0.0001, 1.0), soft(0.001, 0.1), unit(Length), words("chord accuracy");
        /// Seed tag; stored, mixed into randomness.
        seed: i64 = 0;
    }
    outputs {
        /// The curls, one for each curve, with the same ids. `fibre_length` is the hair's length along the curl in cm,
        /// `shrinkage` the share by which its span is shorter.
        curves: Curves;
    }
}

choice! {
    /// Type of curl that fills in what is not set.
    Preset {
        /// A plain round coil: for curls whose every number you set.
        Custom = "custom",
        /// Wavy: long loose waves close to the head.
        Type2a = "2a",
        /// Wavy: S-waves from mid-length on.
        Type2b = "2b",
        /// Wavy: deep S-waves that begin to coil.
        Type2c = "2c",
        /// Curly: loose ringlets as wide as a piece of chalk.
        Type3a = "3a",
        /// Curly: springy ringlets as wide as a marker.
        Type3b = "3b",
        /// Curly: tight corkscrews as wide as a pencil.
        Type3c = "3c",
        /// Coily: small defined coils as wide as a crochet needle.
        Type4a = "4a",
        /// Coily: zigzags with sharp bends and few full turns.
        Type4b = "4b",
        /// Coily: dense small bends and coils that change direction often, hardly clumped.
        Type4c = "4c",
    }
}

choice! {
    /// Direction of the turns.
    Hand {
        /// Counter-clockwise seen from the root: a left-handed screw.
        Left = "left",
        /// Clockwise seen from the root: a right-handed screw.
        Right = "right",
        /// Drawn for each clump; loose hairs may differ from their clump.
        Random = "random",
        /// Each turn goes against the last.
        Alternating = "alternating",
    }
}

choice! {
    /// What starts in the same phase.
    Lock {
        /// Hairs of one parent share their curl; parents differ. `definition` says how closely.
        Clump = "clump",
        /// Every hair has a curl of its own.
        Free = "free",
        /// As `clump`, and all curls start at the same angle.
        All = "all",
    }
}

choice! {
    /// What the curl keeps.
    Keep {
        /// The curl ends where the curve ended: the hair becomes longer along its curl.
        Span = "span",
        /// The hair keeps its length, so the curl ends short of the curve's end. Where curves have a `fibre_length`, it is kept as far as the curve has room for it.
        Fibre = "fibre",
    }
}

choice! {
    /// What decides the number of points.
    Points {
        /// So many on a turn.
        PerTurn = "turn",
        /// As many as keep the curl within a distance.
        Tolerance = "tolerance",
    }
}

/// Name of the curve attribute that says by which share the span is shorter than the fibre.
const SHRINKAGE: Name = Name::Borrowed("shrinkage");

fn eval(cx: &EvalCx, inputs: Inputs) -> Result<Outputs, NodeError> {
    let (numbers, used) = inputs.numbers();
    cx.remark(used);
    let key = numbers.shapes.add_to(KeyBuilder::new("sections")).float(numbers.rounding).finish();
    let shapes = cx.memo(key, || {
        let of = |(_, section): &(_, _)| Shape::of(section, numbers.rounding);
        let mut shapes: Vec<Shape> = numbers.shapes.0.iter().map(of).collect();
        shapes.push(Shape::zigzag(numbers.rounding));
        let bytes = shapes.len() * 8300;
        (shapes, bytes)
    });
    let pattern = inputs.pattern(cx, &numbers, shapes.to_vec());
    let skin = inputs.scalp.as_deref().map(|scalp| cx.skin(scalp));
    let [curves] = cx.each_tuft(&inputs.curves, |tuft, piece| {
        Ok([curl(tuft, &inputs, &numbers, &pattern, skin.as_ref(), piece)?])
    })?;
    remark_on_shrinkage(cx, &curves);
    Ok(Outputs { curves })
}

impl Inputs {
    /// The preset with what is set in its place, and what that is in words.
    fn numbers(&self) -> (Numbers, String) {
        let mut numbers = self.preset.numbers();
        let mut edited = vec![];
        if let Some(shapes) = &self.shapes {
            numbers.shapes = (**shapes).clone();
            edited.push("shapes");
        }
        let mut words = vec![];
        let [a, f, p, o] = &mut numbers.ranges;
        let mut take = |name, set: Option<f32>, number: &mut f32| {
            if let Some(x) = set {
                *number = x;
                edited.push(name);
            }
            words.push(format!("{name} {}", (*number * 1e3).round() / 1e3));
        };
        // What varies over the hair is told by its preset's number or as varying, and sampled later.
        let constant = |field: &Option<FieldInput>| field.as_ref().and_then(FieldInput::constant);
        take("diameter", constant(&self.diameter), &mut numbers.diameter);
        take("pitch", constant(&self.pitch), &mut numbers.pitch);
        take("uniformity", self.uniformity, &mut numbers.uniformity);
        take("b_to_c", self.b_to_c, &mut numbers.b_to_c);
        take("z_bends", self.z_bends, &mut numbers.z_bends);
        take("definition", constant(&self.definition), &mut numbers.definition);
        take("switchbacks", self.switchbacks, &mut numbers.switchbacks);
        take("skipped", self.skipped, &mut numbers.skipped);
        take("spread", self.spread, &mut numbers.spread);
        take("amplitude_range", self.amplitude_range, a);
        take("frequency_range", self.frequency_range, f);
        take("phase_range", self.phase_range, p);
        take("offset_range", self.offset_range, o);
        take("blend", self.blend, &mut numbers.blend);
        take("rise", self.rise, &mut numbers.rise);
        take("rounding", self.rounding, &mut numbers.rounding);
        let varying = [
            ("diameter", &self.diameter),
            ("pitch", &self.pitch),
            ("definition", &self.definition),
        ];
        for (name, field) in varying {
            if field.is_some() && constant(field).is_none() {
                edited.push(name);
            }
        }
        let edits = match edited.is_empty() {
            true => String::new(),
            false => format!("; edited: {}", edited.join(", ")),
        };
        (numbers, format!("preset {}: {}{edits}", self.preset.word(), words.join(", ")))
    }

    fn pattern(&self, cx: &EvalCx, numbers: &Numbers, shapes: Vec<Shape>) -> Pattern {
        let alternating = self.hand == Hand::Alternating;
        Pattern {
            shapes,
            list: entries(&numbers.shapes, numbers.uniformity, numbers.b_to_c),
            z_bends: numbers.z_bends,
            switchbacks: if alternating { 1.0 } else { numbers.switchbacks },
            skipped: numbers.skipped,
            ranges: numbers.ranges,
            spread: numbers.spread,
            blend: numbers.blend,
            hand: match self.hand {
                Hand::Left => Some(1.0),
                Hand::Right => Some(-1.0),
                Hand::Random | Hand::Alternating => None,
            },
            phase_range: f32::from(self.phase_lock != Lock::All),
            phase: self.phase / 360.0,
            start: self.start,
            rise: numbers.rise,
            detail: match self.points {
                Points::PerTurn => Detail::PerTurn(self.points_per_turn),
                Points::Tolerance => Detail::Tolerance(self.tolerance),
            },
            turn_dice: cx.dice(self.seed, "turn"),
            curl_dice: cx.dice(self.seed, "curl"),
        }
    }
}

impl Preset {
    fn word(self) -> String {
        match crate::define::Value::from(self) {
            crate::define::Value::Text(word) => word.to_string(),
            _ => String::new(),
        }
    }
}

/// Every curve of `tuft` as a curl. Curves that cannot be wound are left out and noted.
fn curl(
    tuft: &Tuft,
    inputs: &Inputs,
    numbers: &Numbers,
    pattern: &Pattern,
    skin: Option<&Skin>,
    piece: &mut Piece,
) -> Result<Tuft, NodeError> {
    let scalp = inputs.scalp.as_deref();
    let diameter = inputs.diameter.as_ref().map(|f| f.on(tuft, scalp)).transpose()?;
    let pitch = inputs.pitch.as_ref().map(|f| f.on(tuft, scalp)).transpose()?;
    let definition = inputs.definition.as_ref().map(|f| f.on(tuft, scalp)).transpose()?;
    let amount = inputs.amount.on(tuft, scalp)?;
    let turned = inputs.roll.on(tuft, scalp)?;
    let (parent, normal, depth) = (tuft.view(PARENT), tuft.view(NORMAL), tuft.view(ALLOW_DEPTH));
    let (fibre, rolls) = (tuft.view(FIBRE), tuft.view(ROLL));
    let level = inputs.roll.constant() == Some(0.0) && matches!(rolls, View::Shared(x) if x == 0.0);
    let by_points = tuft.attributes().iter().any(|a| a.domain == Domain::Point);

    let mut out = TuftBuilder::new();
    let (mut rail, mut winder, mut spline) =
        (Rail::default(), Winder::default(), Spline::default());
    let (mut kept, mut places, mut fibres, mut shrinkages) = (vec![], vec![], vec![], vec![]);
    let mut longer: Vec<Vec3> = vec![];
    for i in 0..tuft.len() {
        piece.tick()?;
        let (points, first) = (tuft.curve(i), tuft.offsets()[i]);
        let start = |tangent| match points.is_empty() {
            false => root_normal(tangent, normal.at(i, first as usize)),
            true => Vec3::X,
        };
        if let Err(fault) = rail.rebuild(points, start) {
            piece.trouble(tuft.id(i), fault);
            continue;
        }
        let root = first as usize;
        let sizes = Sizes {
            diameter: |u| diameter.as_ref().map_or(numbers.diameter, |f| f.along(tuft, i, u)),
            pitch: |u| pitch.as_ref().map_or(numbers.pitch, |f| f.along(tuft, i, u)),
            amount: |u| amount.along(tuft, i, u),
            definition: definition.as_ref().map_or(numbers.definition, |f| f.at(i, root, 0.0)),
        };
        let eighths = (0..=8).map(|k| k as f32 / 8.0);
        if eighths.into_iter().all(|u| (sizes.diameter)(u) * (sizes.amount)(u) == 0.0) {
            winder.points.clear();
            winder.places.clear();
            winder.points.extend_from_slice(points);
            let last = points.len() - 2;
            let place = |k: usize| (k.min(last) as u32, k.saturating_sub(last) as f32);
            winder.places.extend((0..points.len()).map(place));
            fibres.push(rail.length());
            shrinkages.push(0.0);
        } else {
            let id = tuft.id(i);
            let clump = match (inputs.phase_lock, parent.at(i, root)) {
                (Lock::Free, _) | (_, 0) => id,
                (_, parent) => parent,
            };
            winder.draw(pattern, &rail, (clump, id), &sizes);
            let roll = (!level).then_some(|(cv, t): (u32, f32)| {
                // Past the source's end, as at its end.
                let last = points.len() as u32 - 2;
                let (cv, t) = if cv > last { (last, 1.0) } else { (cv, t) };
                let at = root + cv as usize;
                let (a, b) = (rolls.at(i, at), rolls.at(i, at + 1));
                let u = (cv as f32 + t) / (points.len() - 1) as f32;
                a + (b - a) * t + turned.along(tuft, i, u)
            });
            let roll = roll.as_ref();
            // As many points as the source at least: what its shape needs.
            let fewest = points.len();
            winder.lay(pattern, &rail, rail.length(), fewest, &sizes, roll);
            let mut span = rail.length();
            if inputs.length == Keep::Fibre {
                let wanted = match fibre.at(i, root) {
                    given if given > 0.0 => given,
                    _ => rail.length(),
                };
                let mut lay = |rail: &Rail, winder: &mut Winder, reach| {
                    winder.lay(pattern, rail, reach, 4, &sizes, roll);
                    spline.rebuild(&winder.points).map_or(0.0, |()| spline.length())
                };
                let mut all = lay(&rail, &mut winder, span);
                // A wave wider than its source's bends cuts across them and is shorter than the source: then the source
                // goes straight on for as much as is missing. (A fibre length that was given asks for no such thing:
                // hair made to end somewhere ends there.)
                let mut more = 0.0;
                for _ in 0..6 {
                    if all >= wanted || fibre.at(i, root) > 0.0 {
                        break;
                    }
                    more += 1.5 * (wanted - all).max(1e-3 * wanted);
                    longer.clear();
                    longer.extend_from_slice(points);
                    longer.push(rail_end(points, more));
                    if rail.rebuild(&longer, start).is_err() {
                        break;
                    }
                    winder.draw(pattern, &rail, (clump, id), &sizes);
                    span = rail.length();
                    all = lay(&rail, &mut winder, span);
                }
                span = reach_of(wanted, (span, all), |reach| lay(&rail, &mut winder, reach));
                // What lies past the source reads the source's end.
                let end = points.len() as u32 - 1;
                let past = winder.places.iter_mut().filter(|place| place.0 >= end);
                past.for_each(|place| *place = (end - 1, 1.0));
            }
            winder.points[0] = points[0];
            if let Some(skin) = skin {
                rest_on(skin, &mut winder.points, depth.at(i, root));
            }
            let length = winder.arc_length();
            fibres.push(length);
            shrinkages.push((1.0 - span / length).max(0.0));
        }
        kept.push(i as u32);
        if by_points {
            places.extend(winder.places.iter().map(|(cv, t)| (first + cv, *t)));
        }
        out.push_curve(&winder.points);
    }
    for attribute in tuft.attributes() {
        let values = match attribute.domain {
            Domain::Curve => attribute.values.gather(&kept),
            Domain::Point => between(&attribute.values, &places),
        };
        out.set_column(Attribute { values, ..attribute.clone() });
    }
    out.set(FIBRE, Domain::Curve, fibres);
    out.set_named(SHRINKAGE, Domain::Curve, shrinkages);
    Ok(out.build())
}

/// The normal that a curl's section starts from: the curve's own where it has one, else a direction that changes
/// smoothly with the tangent, so that neighbouring hairs start alike. Somewhere such a field must break:
/// here for hair that grows straight forward and down, which none does.
fn root_normal(tangent: Vec3, own: Vec3) -> Vec3 {
    const BACK_AND_UP: Vec3 = Vec3::new(0.0, 0.8, -0.6);
    if own != Vec3::ZERO && own.is_finite() {
        return own;
    }
    carry(Vec3::X, BACK_AND_UP, tangent)
}

/// A point `more` cm past the end of `points`, straight on.
fn rail_end(points: &[Vec3], more: f32) -> Vec3 {
    let last = points[points.len() - 1];
    let before = points.iter().rev().find(|p| **p != last).copied().unwrap_or(last - Vec3::Y);
    last + (last - before).normalize_or(Vec3::Y) * more
}

/// How much of the source a curl of `wanted` cm takes; all of it when that is not enough. `all` is the source's length and
/// the length of the curl along it, which is laid; `lay` lays a curl along less and tells its length.
fn reach_of(wanted: f32, all: (f32, f32), mut lay: impl FnMut(f32) -> f32) -> f32 {
    const CLOSE: f32 = 5e-4;
    // Between a reach that is too short and one that is long enough, by false position kept off the ends.
    let (mut low, mut high) = ((0.0, 0.0), all);
    if high.1 <= wanted {
        return all.0;
    }
    // The length jumps a little where a point is added: then the nearest reach tried is taken.
    let mut best = (high.1 - wanted, high.0);
    for _ in 0..24 {
        let t = ((wanted - low.1) / (high.1 - low.1)).clamp(0.02, 0.98);
        let reach = low.0 + (high.0 - low.0) * t;
        let length = lay(reach);
        let off = (length - wanted).abs();
        if off <= CLOSE * wanted {
            return reach;
        }
        if off < best.0 {
            best = (off, reach);
        }
        if length < wanted { low = (reach, length) } else { high = (reach, length) }
    }
    lay(best.1);
    best.1
}

/// Pushes points out of the skin; where any was moved, puts each chord's length right once, from the root on, and
/// pushes again.
fn rest_on(skin: &Skin, points: &mut [Vec3], depth: f32) {
    let chord = |points: &[Vec3], k: usize| points[k].distance(points[k - 1]);
    let mut chords: Option<Vec<f32>> = None;
    for k in 1..points.len() {
        let (out, moved) = skin.push_out(points[k], depth);
        if moved {
            chords.get_or_insert_with(|| {
                (0..points.len()).map(|k| if k == 0 { 0.0 } else { chord(points, k) }).collect()
            });
            points[k] = out;
        }
    }
    let Some(chords) = chords else { return };
    for k in 1..points.len() {
        let along = (points[k] - points[k - 1]).normalize_or_zero();
        points[k] = skin.push_out(points[k - 1] + along * chords[k], depth).0;
    }
}

fn remark_on_shrinkage(cx: &EvalCx, curves: &Curves) {
    let mut sum = 0.0f64;
    for tuft in curves.tufts() {
        if let Some(View::Curve(values)) = tuft.view_named::<f32>(&SHRINKAGE) {
            sum += values.iter().map(|x| f64::from(*x)).sum::<f64>();
        } else if let Some(View::Shared(value)) = tuft.view_named::<f32>(&SHRINKAGE) {
            sum += f64::from(value);
        }
    }
    let n = curves.curve_count();
    if n > 0 {
        let percent = 100.0 * sum / n as f64;
        cx.remark(format!(
            "shrinkage {percent:.0} % in the mean: a span is so much shorter than its fibre"
        ));
    }
}
