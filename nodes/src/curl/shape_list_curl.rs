//! Shape-list curl: curls whose turns draw their profiles from a list (Lightyear 3.1).
//!
//! Guarantees: roots stay in place; equal ids give equal curls, whatever else is there; the path is C1 while `blend` is
//! above 0; a size of 0 changes nothing; in `fibre` mode the arc length equals the source's within 0.5 %, or a
//! `fibre_length` that the source has room for. On a parted scalp, a hair whose curl would cross a parting that its
//! source does not cross is straight from its root to past that point, or entirely if that is not enough. A curl with
//! more turns than its points can show is drawn larger, with the same form, and a warning. Not promised: that hairs
//! stay clear of each other, that a curl has the requested size if points are few, or that a curl much wider than its
//! source's bends does not loop through itself.

mod foreseen;

use self::foreseen::foreseen;
use super::drawn::with_drawn;
use super::pattern::{Detail, Pattern, TurnFactors};
use super::preset::PresetValues;
use super::profile::{ProfileCurve, entries};
use super::winding::{Goal, Sizes, Winder, arc_length};
use crate::data::attribute_transfer;
use crate::data::attributes::{
    ALLOW_DEPTH, CURL_DIAMETER, CURL_PITCH, Domain, FIBRE, ID, NORMAL, PARENT, ROLL, SHRINKAGE,
};
use crate::data::curves::MOST_A_CURVE;
use crate::data::curves::{AttributeView, Curves, Tuft, TuftBuilder};
use crate::data::route::makers::rest_evenly;
use crate::data::scalp::{Scalp, Skin};
use crate::data::sections::Sections;
use crate::data::shapes::{ShapeList, Tier};
use crate::define::{FieldInput, NodeError, choice, node};
use crate::eval::{EvalCx, Piece, TracedScalp};
use crate::maths::frame::carry;
use crate::maths::hash::KeyBuilder;
use crate::maths::rail::Rail;
use crate::maths::spline::Spline;
use glam::Vec3;
use std::sync::Arc;

node! {
    /// Winds curves into waves, curls, coils and kinks, turn by turn, from a list of profiles.
    ///
    /// Pick a preset and change what you like: unset values come from the preset, set values replace it. The node's
    /// messages list the values used. Hairs of one parent share a curl as closely as `definition` says.
    "shape_list_curl", version 2, label "Shape-list curl",
        words "curl curly wave wavy coil coily kink kinky ringlets helix spiral perm texture type 2a 2b 2c 3a 3b 3c 4a 4b 4c zigzag guide process cross-section uniformity";
    inputs {
        /// Curves to wind; each becomes one curl.
        curves: Curves;
        /// Head that curls stay out of, and whose masks the inputs can read. A curl that would cross a parting begins
        /// farther from the root. Lengths are corrected once after a curl is pushed out of the head.
        scalp: Option<TracedScalp>;
        /// Curl type that fills in unset values. A starting point, not a measurement.
        preset: Preset = Preset::Type3b, words("type hair pattern chart");
        /// Diameter of a coil; a flat wave of the same diameter is 1.41 times as high from crest to trough. 0 leaves
        /// curves as they are. Unset: the preset's.
        diameter: Option<FieldInput>, hard(0.0, 100.0), soft(0.1, 4.0), unit(Length), handle(Handle::Radius),
            words("amplitude radius size width");
        /// Length of the source curve per turn. A small pitch makes tight curls that shrink a lot. Unset: the preset's.
        pitch: Option<FieldInput>, hard(0.02, 1000.0), soft(0.2, 8.0), unit(Length), handle(Handle::Along),
            words("frequency wavelength period turns");
        /// Multiplies the diameter. A ramp makes curls grow or fade from root to tip.
        amount: FieldInput = 1.0, hard(0.0, 10.0), soft(0.0, 2.0), words("amplitude ramp taper strength");
        /// How closely hairs of one parent follow the same curl, from 0 (each its own: loose, dry) to 1 (all alike: set
        /// with product). In between, hairs follow the shared curl until each leaves it at a random point. Unset: the
        /// preset's.
        definition: Option<FieldInput>, hard(0.0, 1.0), unit(Ratio), words("clump product gel frizz styling");
        /// Keep the reach of the hair, or its length.
        length: Keep = Keep::Span, words("shrinkage stretch keep");
        /// Length of each hair, when `length` is `visible` or `stretched`.
        hair_length: FieldInput = 15.0, hard(0.1, 1000.0), soft(1.0, 60.0), unit(Length), words("ask visible stretched grown long short"),
            idle(|of| matches!(of("length"), Some(Value::Text(is)) if !["visible", "stretched"].contains(&&*is)).then_some("hairs keep what they have"));

        [Shape]
        /// Profiles in tiers: A is primary, B secondary, C tertiary. Unset: the preset's.
        shapes: Option<Arc<ShapeList>>, words("cross-section lame polygon ellipse circle rose");
        /// Drawn profiles: each curve is flattened to its own plane, closed and scaled to the curl. They replace the
        /// other profiles of their tier.
        shape_curves: Option<Curves>, words("custom drawn sketch cross-section profile outline");
        /// Tier that drawn profiles belong to.
        drawn_tier: DrawnTier = DrawnTier::A, words("custom drawn sketch");
        /// Fraction of turns with a profile of tier A, from 0 (none) to 1 (all). Unset: the preset's.
        uniformity: Option<f32>, hard(0.0, 1.0), unit(Ratio);
        /// Turns with a tier B profile per turn with a tier C profile. Unset: the preset's.
        b_to_c: Option<f32>, hard(0.0, 1000.0), soft(0.0, 10.0);
        /// Fraction of turns that are Z-bends: straight legs and sharp bends in a changing plane. Unset: the preset's.
        z_bends: Option<f32>, hard(0.0, 1.0), unit(Ratio), words("zigzag kink");
        /// Fraction of turns at which the curl reverses its direction, like a tangled telephone cord. Unset: the
        /// preset's.
        switchbacks: Option<f32>, hard(0.0, 1.0), unit(Ratio), words("perversion reversal tendril");
        /// Fraction of turns to skip: hair runs nearly straight for one turn; at 1, everywhere. The other turns keep
        /// their size, so the reported diameter is the mean over all turns. Unset: the preset's.
        skipped: Option<f32>, hard(0.0, 1.0), unit(Ratio), words("skip period straight");
        /// Fraction of each turn over which it blends from the previous one; 0 makes corners where turns differ. Unset:
        /// the preset's.
        blend: Option<f32>, hard(0.0, 1.0), unit(Ratio), words("smooth transition");
        /// Smallest corner radius of profiles and Z-bends, as a fraction of the profile's radius. Ellipses are not
        /// rounded. Unset: the preset's.
        rounding: Option<f32>, hard(0.05, 1.0), soft(0.05, 0.6), unit(Ratio), words("corner sharp");
        /// Rotates the profiles about the curve, and with them the plane of a flat wave. Added to the curves' own roll.
        roll: FieldInput = 0.0, hard(-36000.0, 36000.0), soft(-180.0, 180.0), unit(Angle), handle(Handle::Angle);

        [RootAndTip]
        /// Length from the root that stays straight.
        start: f32 = 0.0, hard(0.0, 1000.0), soft(0.0, 10.0), unit(Length), handle(Handle::Along), words("offset root straight");
        /// Turns over which the curl grows to full size; a small value makes it leave the root at once. Unset: the
        /// preset's.
        rise: Option<f32>, hard(0.25, 100.0), soft(0.5, 6.0), words("blend root grow");
        /// Length at the root where the curl is still forming: smaller, tighter turns, half of full size at the skin.
        /// Gives coily hair its spongy root. 0: none.
        sponge: f32 = 0.0, hard(0.0, 100.0), soft(0.0, 3.0), unit(Length), handle(Handle::Along), words("spongy root new growth density lift");

        [Clumping]
        /// Which curls start in phase.
        phase_lock: Lock = Lock::Clump, words("clump synchronised free");
        /// Angle at which curls start; with `all`, every curl starts there.
        phase: f32 = 0.0, hard(-360.0, 360.0), soft(-180.0, 180.0), unit(Angle);
        /// Handedness of the turns, seen along the hair from the root.
        hand: Hand = Hand::Random, words("handedness chirality clockwise s z");

        [Detail]
        /// What sets the number of CVs.
        points: Points = Points::Auto, words("cvs resolution segments");
        /// CVs per turn of full size, when given per turn. Smaller turns get fewer, but at least eight. Unset: as many
        /// as the tolerance asks for, or 12.
        points_per_turn: Option<f32>, hard(8.0, 256.0), soft(8.0, 32.0), unit(Count), words("cvs resolution segments"),
            idle(|of| matches!(of("points"), Some(Value::Text(is)) if *is == *"tolerance").then_some("points go by the tolerance"));
        /// Largest distance of a coil from the straight line between two CVs, as a fraction of its radius: 3 % gives 13
        /// CVs per turn, 1 % gives 22. Sharp profiles get more, small turns fewer. It may double where a turn meets one
        /// of another size or kind.
        tolerance: f32 = 0.03, hard(0.0005, 0.2), soft(0.01, 0.1), unit(Ratio), words("chord error accuracy cvs"),
            idle(|of| matches!(of("points"), Some(Value::Text(is)) if *is == *"turn").then_some("points go by the turn"));
        /// Largest number of CVs per hair. A hair that needs more is sampled evenly and coarser, and counted in a
        /// message. If a turn would get fewer than seven CVs, the curl is made larger in diameter and pitch, and the
        /// hairs are listed.
        most_points: i64 = MOST_A_CURVE as i64, hard(4.0, 16384.0), soft(32.0, 1024.0), unit(Count), words("limit budget cvs segments");

        [Randomness]
        /// Variation of size and pitch over the head, from 0 (all alike) to 1 (from half to twice). No head has one
        /// curl everywhere. Unset: the preset's.
        spread: Option<f32>, hard(0.0, 1.0), unit(Ratio), words("variation random mixed");
        /// Random variation in size between turns of a curl, as a fraction of it. Unset: the preset's.
        amplitude_range: Option<f32>, hard(0.0, 0.95), soft(0.0, 0.6), unit(Ratio), words("random irregular");
        /// Random variation in frequency between turns of a curl, as a fraction of it. Unset: the preset's.
        frequency_range: Option<f32>, hard(0.0, 0.9), soft(0.0, 0.6), unit(Ratio), words("random irregular pitch");
        /// How far a turn may run ahead or behind, as a fraction of a turn. Unset: the preset's.
        phase_range: Option<f32>, hard(0.0, 0.5), soft(0.0, 0.2), unit(Ratio), words("random irregular shift");
        /// How far a turn may shift off the source curve, as a fraction of the curl's radius. Unset: the preset's.
        offset_range: Option<f32>, hard(0.0, 2.0), soft(0.0, 1.0), unit(Ratio), words("random irregular wander");
        /// Random seed for this node.
        seed: i64 = 0;
    }
    outputs {
        /// The curls, one per curve, with the same ids. `fibre_length` is the length along the curl in cm, `shrinkage`
        /// the fraction by which the span is shorter.
        curves: Curves;
    }
}

choice! {
    /// Curl type that fills in unset values.
    Preset {
        /// A plain round coil, for curls whose every value you set.
        Custom = "custom",
        /// Waves 12 mm high every 80 mm (2a): long, loose, close to the head.
        Type2a = "2a",
        /// Waves 14 mm high every 60 mm (2b): S-waves from mid-length on.
        Type2b = "2b",
        /// Waves 16 mm high every 40 mm (2c): deep S-waves that begin to coil.
        Type2c = "2c",
        /// Curls 25 mm wide every 60 mm (3a): loose ringlets as wide as a piece of chalk.
        Type3a = "3a",
        /// Curls 15 mm wide every 30 mm (3b): springy ringlets as wide as a marker.
        Type3b = "3b",
        /// Curls 8 mm wide every 14 mm (3c): tight corkscrews as wide as a pencil.
        Type3c = "3c",
        /// Coils 5 mm wide every 7 mm (4a): small and defined, as wide as a crochet needle.
        Type4a = "4a",
        /// Zigzags 4 mm wide every 4.5 mm (4b): sharp bends and few full turns.
        Type4b = "4b",
        /// Kinks and coils 3 mm wide every 2.5 mm (4c): dense, small, often changing direction, barely clumped.
        Type4c = "4c",
    }
}

choice! {
    /// Tier that drawn profiles belong to.
    DrawnTier {
        /// Primary: as often as the uniformity says.
        A = "a",
        /// Secondary.
        B = "b",
        /// Tertiary.
        C = "c",
    }
}

choice! {
    /// Handedness of the turns.
    Hand {
        /// Counterclockwise seen from the root: a left-handed screw.
        Left = "left",
        /// Clockwise seen from the root: a right-handed screw.
        Right = "right",
        /// Random per clump; loose hairs may differ from their clump.
        Random = "random",
        /// Each turn reverses the previous one.
        Alternating = "alternating",
    }
}

choice! {
    /// Which curls start in phase.
    Lock {
        /// Hairs of one parent share their curl as closely as `definition` says; parents differ.
        Clump = "clump",
        /// Every hair has its own curl.
        Free = "free",
        /// Like `clump`, with all curls starting at the same angle.
        All = "all",
    }
}

choice! {
    /// What the curl preserves.
    Keep {
        /// The curl ends where the curve ended, so the hair gets longer along its curl.
        Span = "span",
        /// The hair keeps its length, so the curl ends before the curve's end. If curves have a `fibre_length`, that
        /// length is used as far as the curve has room.
        Fibre = "fibre",
        /// The hair looks `hair_length` long: its curl uses that much of the curve, or continues straight past its end.
        Visible = "visible",
        /// The hair is `hair_length` long when pulled straight; its curl makes it look shorter.
        Stretched = "stretched",
    }
}

choice! {
    /// What sets the number of CVs.
    Points {
        /// Per turn if `points_per_turn` is set, else by tolerance.
        Auto = "auto",
        /// A fixed number per turn.
        PerTurn = "turn",
        /// As many as the tolerance needs.
        Tolerance = "tolerance",
    }
}

fn eval(cx: &EvalCx, inputs: Inputs) -> Result<Outputs, NodeError> {
    let (mut numbers, used) = inputs.numbers();
    cx.remark(used);
    if let Some(drawn) = &inputs.shape_curves {
        let tier = match inputs.drawn_tier {
            DrawnTier::A => Tier::A,
            DrawnTier::B => Tier::B,
            DrawnTier::C => Tier::C,
        };
        numbers.shapes = with_drawn(cx, &numbers.shapes, drawn, tier);
    }
    let key = numbers.shapes.add_to(KeyBuilder::new("sections")).float(numbers.rounding).finish();
    let shapes = cx.memo(key, || {
        let of = |(_, section): &(_, _)| ProfileCurve::of(section, numbers.rounding);
        let mut shapes: Vec<ProfileCurve> = numbers.shapes.0.iter().map(of).collect();
        shapes.push(ProfileCurve::zigzag(numbers.rounding));
        let bytes = shapes.len() * 8300;
        Ok((shapes, bytes))
    })?;
    let pattern = inputs.pattern(cx, &numbers, shapes.to_vec());
    cx.may_make_most(inputs.curves.curve_count() as f64 * inputs.most_points as f64, || {
        foreseen(&inputs, &numbers, &pattern)
    })?;
    let skin = inputs.scalp.as_ref().map(|scalp| cx.skin(scalp.head()));
    let [curves, coarse] =
        cx.by_place(inputs.scalp.as_ref()).each_tuft(&inputs.curves, |tuft, piece| {
            curl(tuft, &inputs, &numbers, &pattern, skin.as_ref(), piece)
        })?;
    remark_on_shrinkage(cx, &curves);
    remark_on_limit(cx, &curves, &coarse, inputs.most_points);
    Ok(Outputs { curves })
}

impl Inputs {
    /// The preset with the set values in place, and a description of them.
    fn numbers(&self) -> (PresetValues, String) {
        let mut numbers = self.preset.numbers();
        let mut edited = vec![];
        if let Some(shapes) = &self.shapes {
            numbers.shapes = (**shapes).clone();
            edited.push("shapes");
        }
        let [a, f, p, o] = &mut numbers.ranges;
        let mut take = |name, set: Option<f32>, number: &mut f32| {
            if let Some(x) = set {
                *number = x;
                edited.push(name);
            }
        };
        // A value that varies over the hair is described as its preset's number or as varying, and sampled later.
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
            false => format!("; changed: {}", edited.join(", ").replace('_', " ")),
        };
        (numbers, format!("preset {}{edits}", self.preset.word()))
    }

    fn pattern(&self, cx: &EvalCx, numbers: &PresetValues, shapes: Vec<ProfileCurve>) -> Pattern {
        let alternating = self.hand == Hand::Alternating;
        Pattern {
            widest: shapes.iter().fold(0.0, |most, shape| shape.widest.max(most)),
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
            sponge: self.sponge,
            detail: match (self.points, self.points_per_turn) {
                (Points::PerTurn, n) => Detail::PerTurn(n.unwrap_or(12.0)),
                (Points::Auto, Some(n)) => Detail::PerTurn(n),
                (Points::Auto, None) | (Points::Tolerance, _) => Detail::Tolerance(self.tolerance),
            },
            most: self.most_points as usize,
            even: TurnFactors::default(),
            turn_dice: cx.dice(self.seed, "turn"),
            curl_dice: cx.dice(self.seed, "curl"),
        }
        .evened()
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

/// How often a curl that crosses a parting is wound again, each time starting farther from its root.
const HELD: usize = 4;

/// How much larger than requested the curl of a hair with too few points is.
const LARGER: &str = "larger";

/// Every curve of `tuft` as a curl, and those with fewer points than requested, by their roots and [`LARGER`]. Curves
/// that cannot be wound are dropped and reported.
fn curl(
    tuft: &Tuft,
    inputs: &Inputs,
    numbers: &PresetValues,
    pattern: &Pattern,
    skin: Option<&Skin>,
    piece: &mut Piece,
) -> Result<[Tuft; 2], NodeError> {
    let scalp = piece.scalp();
    let diameter = inputs.diameter.as_ref().map(|f| f.on(tuft, scalp)).transpose()?;
    let pitch = inputs.pitch.as_ref().map(|f| f.on(tuft, scalp)).transpose()?;
    let definition = inputs.definition.as_ref().map(|f| f.on(tuft, scalp)).transpose()?;
    let amount = inputs.amount.on(tuft, scalp)?;
    let turned = inputs.roll.on(tuft, scalp)?;
    let (parent, normal, depth) = (tuft.view(PARENT), tuft.view(NORMAL), tuft.view(ALLOW_DEPTH));
    let (fibre, rolls) = (tuft.view(FIBRE), tuft.view(ROLL));
    let level = inputs.roll.constant() == Some(0.0)
        && matches!(rolls, AttributeView::Shared(x) if x == 0.0);
    let by_points = tuft.differs_by_point();

    let mut out = TuftBuilder::new();
    let asked_length = inputs.hair_length.on(tuft, scalp)?;
    let (mut rail, mut winder, mut spline) =
        (Rail::default(), Winder::default(), Spline::default());
    let (mut kept, mut places, mut fibres, mut shrinkages) = (vec![], vec![], vec![], vec![]);
    let (mut diameters, mut pitches) = (vec![], vec![]);
    // The root of each hair with too few points.
    let (mut coarse, mut coarse_ids, mut larger) = (TuftBuilder::new(), vec![], vec![]);
    let (mut longer, mut near): (Vec<Vec3>, Vec<bool>) = (vec![], vec![]);
    let sections = scalp.and_then(Scalp::sections);
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
            fibres.push(rail.length());
            shrinkages.push(0.0);
            diameters.push(0.0);
            pitches.push(0.0);
            kept.push(i as u32);
            if by_points {
                let last = points.len() - 2;
                let place = |k: usize| (first + k.min(last) as u32, k.saturating_sub(last) as f32);
                places.extend((0..points.len()).map(place));
            }
            out.push_curve(points);
            continue;
        }
        let id = tuft.id(i);
        let clump = match (inputs.phase_lock, parent.at(i, root)) {
            (Lock::Free, _) | (_, 0) => id,
            (_, parent) => parent,
        };
        let roll = (!level).then_some(|(cv, t): (u32, f32)| {
            // Past the source's end, the attributes of its end apply.
            let last = points.len() as u32 - 2;
            let (cv, t) = if cv > last { (last, 1.0) } else { (cv, t) };
            let at = root + cv as usize;
            let (a, b) = (rolls.at(i, at), rolls.at(i, at + 1));
            let u = (cv as f32 + t) / (points.len() - 1) as f32;
            a + (b - a) * t + turned.along(tuft, i, u)
        });
        let roll = roll.as_ref();
        // Where the source ends too early, it is extended straight.
        let mut extend = |rail: &mut Rail, more: f32| {
            longer.clear();
            longer.extend_from_slice(points);
            longer.push(rail_end(points, more));
            rail.rebuild(&longer, start).is_ok()
        };
        let long = asked_length.at(i, root, 0.0);
        // What is preserved, whether the source is extended for it, and the fewest points: for a whole source, as many
        // as it has, since its shape needs them.
        let (mut goal, goes_on, fewest) = match inputs.length {
            Keep::Span => {
                (Goal { reach: rail.length(), fibre: f32::INFINITY }, false, points.len())
            }
            Keep::Visible => (Goal { reach: long, fibre: f32::INFINITY }, false, points.len()),
            Keep::Stretched => (Goal { reach: rail.length(), fibre: long }, true, 4),
            // A given fiber length does not require that: hair made to end somewhere ends there.
            Keep::Fibre => match fibre.at(i, root) {
                given if given > 0.0 => (Goal { reach: rail.length(), fibre: given }, false, 4),
                _ => (Goal { reach: rail.length(), fibre: rail.length() }, true, 4),
            },
        };
        let missing = goal.reach - rail.length();
        if missing > 0.0 && extend(&mut rail, missing) {
            goal.reach = rail.length();
        }
        (winder.held, winder.larger) = (0.0, 1.0);
        for tries in (0..HELD).rev() {
            winder.wind(pattern, &rail, (clump, id), &sizes, (goal, fewest), roll);
            // A wave wider than its source's bends cuts across them and may even be shorter than the source.
            let mut more = 0.0;
            for _ in 0..6 {
                if !goes_on || winder.fibre >= 0.997 * goal.fibre {
                    break;
                }
                more += 1.5 * (goal.fibre - winder.fibre).max(1e-3 * goal.fibre);
                if !extend(&mut rail, more) {
                    break;
                }
                goal.reach = rail.length();
                winder.wind(pattern, &rail, (clump, id), &sizes, (goal, fewest), roll);
            }
            winder.points[0] = points[0];
            if let Some(skin) = skin {
                // Where a curl runs beside its source, no single source point is below it: the smallest allowed depth
                // of all of them.
                let depth = tuft.range(i).map(|k| depth.at(i, k)).fold(f32::MAX, f32::min);
                let clear = |middle, radius| skin.is_clear(middle, radius);
                winder.near(&rail, pattern, clear, &mut near);
                rest_evenly(skin, &mut winder.points, &near, depth, &mut spline);
            }
            let passing = sections.and_then(|sections| last_over(sections, &winder.points));
            match passing {
                // Where its source crosses a parting, so may the curl.
                Some(k)
                    if tries > 0 && sections.is_some_and(|s| last_over(s, points).is_none()) =>
                {
                    // After three attempts, what still crosses the parting becomes straight.
                    winder.held = if tries > 1 { winder.end_of_turn(k) } else { rail.length() };
                }
                _ => break,
            }
        }
        if !winder.enough {
            coarse.push_curve(&winder.points[..1]);
            coarse_ids.push(id);
            larger.push(winder.larger);
        }
        let length = arc_length(&winder.points);
        fibres.push(length);
        shrinkages.push((1.0 - winder.span / length).max(0.0));
        diameters.push(winder.params.diameter);
        pitches.push(winder.params.pitch);
        if by_points {
            // What lies past the source reads the source's end.
            let end = points.len() as u32 - 1;
            let place = |(cv, t): (u32, f32)| if cv >= end { (end - 1, 1.0) } else { (cv, t) };
            places.extend(
                winder.places(&rail, pattern.blend).map(place).map(|(cv, t)| (first + cv, t)),
            );
        }
        kept.push(i as u32);
        out.push_curve(&winder.points);
    }
    attribute_transfer::carry(tuft, &kept, &places, &mut out);
    out.set(FIBRE, Domain::Curve, fibres);
    out.set(SHRINKAGE, Domain::Curve, shrinkages);
    out.set(CURL_DIAMETER, Domain::Curve, diameters);
    out.set(CURL_PITCH, Domain::Curve, pitches);
    coarse.set(ID, Domain::Curve, coarse_ids);
    coarse.set_named(LARGER.into(), Domain::Curve, larger);
    Ok([out.build(), coarse.build()])
}

/// The last point of a curl that lies over a parting; `None` if there is none.
fn last_over(sections: &Sections, points: &[Vec3]) -> Option<usize> {
    sections.last_passed(points.len(), |k| points[k])
}

/// The initial normal of a curl's profile: the curve's own if it has one, else a direction that changes smoothly with
/// the tangent, so that neighbouring hairs start alike. Such a field must be discontinuous somewhere: here for hair that
/// grows straight forward and down, which no hair does.
fn root_normal(tangent: Vec3, own: Vec3) -> Vec3 {
    const BACK_AND_UP: Vec3 = Vec3::new(0.0, 0.8, -0.6);
    if own != Vec3::ZERO && own.is_finite() {
        return own;
    }
    carry(Vec3::X, BACK_AND_UP, tangent)
}

/// A point `more` cm straight past the end of `points`.
fn rail_end(points: &[Vec3], more: f32) -> Vec3 {
    let last = points[points.len() - 1];
    let before = points.iter().rev().find(|p| **p != last).copied().unwrap_or(last - Vec3::Y);
    last + (last - before).normalize_or(Vec3::Y) * more
}

/// Reports how many hairs are coarser than requested, and warns of those with a larger curl because they have so few
/// points.
fn remark_on_limit(cx: &EvalCx, curves: &Curves, coarse: &Curves, most: i64) {
    let larger = |(tuft, i): (&Tuft, usize)| {
        tuft.view_named::<f32>(LARGER).map_or(1.0, |larger| larger.at(i, 0))
    };
    let grown: Vec<(&Tuft, usize)> = coarse.each().filter(|at| larger(*at) > 1.0).collect();
    let (n, all) = (coarse.curve_count() - grown.len(), curves.curve_count());
    if n > 0 {
        cx.remark(format!(
            "{n} of {all} hairs would have more than the {most} points that a hair may have, and are coarser than asked"
        ));
    }
    let by = grown.iter().map(|at| larger(*at)).fold(1.0, f32::max);
    // Rounded up: no curl is larger than reported.
    let by = (by * 100.0).ceil() / 100.0;
    let text = format!(
        "a curl of more turns than {most} points can show is drawn larger than asked, by up to {by} times; shorten the hair, \
         raise most_points, or ask for a larger diameter and pitch"
    );
    grown.iter().for_each(|(tuft, i)| cx.trouble(tuft.id(*i), &text));
}

fn remark_on_shrinkage(cx: &EvalCx, curves: &Curves) {
    let mut sum = 0.0f64;
    for tuft in curves.tufts() {
        let values = tuft.view(SHRINKAGE);
        sum += (0..tuft.len()).map(|i| f64::from(values.at(i, 0))).sum::<f64>();
    }
    let n = curves.curve_count();
    if n > 0 {
        let percent = 100.0 * sum / n as f64;
        cx.remark(format!(
            "shrinkage {percent:.0} % in the mean: a span is so much shorter than its fibre"
        ));
    }
}
