//! Lissajous braid: strands woven along a source curve, free or lying on the scalp as a cornrow.
//!
//! methods.md 2, after section 2.1 of the braids-and-curls talk ("Lightyear"). The path of the strands across the braid
//! is in `weave.rs`, its layout along a source and on the skin in `strand_placement.rs`, the thickness of the tubes in `strand_radius.rs`,
//! flyaways in `flyaways.rs`.
//!
//! Guarantees: the strands' crossings, read from the evaluated curves, are those of the weave on any source (a source
//! that turns back on itself folds the braid over; between the points beside a fold nothing can be read); tubes touch
//! and never intersect wherever the source's radius of curvature is at least twice the amplitude and the source stays
//! clear of itself; even stitches are even to 1 % of arc length; flyaways and the end tuft past the source stay out of
//! the skin; a source without length or with a non-finite number is dropped and named in a message. Not promised: that
//! tubes stay clear where the source turns more sharply than that, or comes near itself.

use super::flyaways::{self, FlyawayStrand};
use super::strand_placement::{self, Advance, Below, BraidShape, Contact, Facing};
use super::strand_radius::{Near, StrandLine, touching_radii};
use super::weave::{Paths, Pitch, Weave, coprime, default_frequency};
use crate::data::attribute_transfer::{Lineage, own_parents, place_of};
use crate::data::attributes::{self as attr, Domain, ROOT_BARY, ROOT_TRIANGLE, ROOT_UV};
use crate::data::curves::{Curves, Tuft, TuftBuilder};
use crate::data::field::Sampler;
use crate::data::ramp::{Blend, Ramp};
use crate::data::scalp::Scalp;
use crate::define::{FieldInput, NodeError, Value, choice, node, unless};
use crate::eval::{EvalCx, Piece, Size, TracedScalp};
use crate::maths::hash::{Dice, curve_id};
use crate::maths::spline::Spline;
use glam::Vec3;
use std::sync::Arc;

node! {
    /// Braids two to twelve strands along each source curve.
    ///
    /// The strands are clusters whose radius makes neighbours just touch; fill them with hair downstream. With a scalp
    /// wired, the braid lies on it as a cornrow, raised by half its height, with its stitches facing outward. Wire the
    /// stitches to Edge partition to pull the surrounding hair into the braid.
    ///
    /// With stitches by spacing, a longer source adds stitches and keeps the existing ones. A varying spacing shortens
    /// stitches where the braid is thinner, down to two fifths of the longest.
    "lissajous_braid", version 1, label "Lissajous braid",
    words "braid plait cornrow canerow knots dutch french english fishtail rope twist two strand box braids fulani ghana goddess pigtail dookie hair curves", scales;
    inputs {
        /// Curves to braid along, root first; one braid each.
        source: Curves, words("guide spine path");
        /// The head. Cornrows lie on it; free braids stay out of it.
        scalp: Option<TracedScalp>;
        /// Strands in each braid.
        strands: i64 = 3, hard(2.0, 12.0), soft(2.0, 7.0), unit(Count), words("hanks sections");
        /// How often a strand goes up and down on its way across the braid and back: 1 is a rope, 2 the classic braid,
        /// one less than the strands a plain weave. Must share no divisor with the number of strands. 0 takes the
        /// smallest valid value from 2 up (a rope for two strands).
        weave: i64 = 0, hard(0.0, 11.0), soft(0.0, 5.0), unit(Count), words("pattern fishtail"),
            idle(|of| unless(of, "formula", "weave", "the formula of the talk has a path of its own"));
        /// Set the number of stitches, or their spacing.
        stitches_by: StitchesBy = StitchesBy::Spacing;
        /// Stitches (the Vs of a braid) along the curve up to the tie, when by count. An attribute or mask can set it
        /// per source.
        stitches | knots: FieldInput = 12.0f32, hard(1.0, 200.0), soft(3.0, 60.0), unit(Count), words("knots frequency"),
            idle(|of| unless(of, "stitches_by", "count", "stitches are spaced, not counted"));
        /// Length of a stitch, when by spacing. 0 takes what suits a firm braid: one and a half times the amplitude
        /// (about half the braid's width) for up to four strands, less for more. Below one amplitude, strands get thin.
        /// A ramp or an attribute such as girth may vary it.
        stitch_spacing: FieldInput = 0.0f32, hard(0.0, 100.0), soft(0.0, 4.0), unit(Length), words("knots frequency"),
            idle(|of| unless(of, "stitches_by", "spacing", "stitches are counted, not spaced"));
        /// Width of the whole braid, including its tubes. A ramp or mask may vary it.
        width: FieldInput = 1.0f32, hard(0.01, 100.0), soft(0.2, 5.0), unit(Length), handle(Handle::Radius);
        /// Height of the whole braid, front to back, including its tubes. 0 takes half the width, or the whole width
        /// for a rope.
        height: FieldInput = 0.0f32, hard(0.0, 100.0), soft(0.0, 3.0), unit(Length), words("depth thickness");
        /// Thickness of the tubes: 1 makes neighbours touch, less leaves gaps, more presses them together, which closes
        /// the gaps of braids with many strands.
        fullness: FieldInput = 1.0f32, hard(0.05, 2.0), soft(0.5, 1.1), unit(Ratio), words("volume pancake");

        [Placement]
        /// Height of the underside of a braid with scalp frames above its source. Negative is deeper.
        scalp_offset: f32 = 0.0, hard(-10.0, 10.0), soft(-0.5, 0.5), unit(Length), handle(Handle::Length);
        /// How deep a braid with scalp frames sinks in: 0 lies on the skin, 1 has its middle at the skin. Scalp
        /// intersection decides what happens to the part below the skin.
        sink: f32 = 0.0, hard(0.0, 1.0), unit(Ratio), words("embed");
        /// What happens where a braid reaches into the skin.
        scalp_intersection: Intersection = Intersection::Flatten, words("collision penetration");

        [Shape]
        /// Path of the strands across the braid.
        formula: Formula = Formula::Weave;
        /// Whether strands cross under or over on their way in. For odd weaves (a rope, four or six strands) both give
        /// the same braid; use handedness instead.
        crossing: Crossing = Crossing::Auto, words("dutch french inside out"), idle(one_braid);
        /// Handedness of the braid: the turn of a rope, or the side of the first stitch.
        handedness: Hand = Hand::Z, words("mirror direction twist");
        /// Where in their cycle the strands start; 360 degrees is once across and back.
        phase: f32 = 0.0, hard(-3600.0, 3600.0), soft(0.0, 360.0), unit(Angle);
        /// Direction that the front of the braid faces.
        frames: FramesBy = FramesBy::Auto;
        /// Direction that the front faces, when frames follow an axis.
        up_axis: Vec3 = Vec3::Y, idle(|of| unless(of, "frames", "up_axis", "frames follow no axis"));
        /// Roll of the whole braid about its source. A ramp twists it.
        roll: FieldInput = 0.0f32, hard(-36000.0, 36000.0), soft(-180.0, 180.0), unit(Angle), handle(Handle::Angle),
            words("twist");
        /// Additional roll along the source, in degrees from root to tip.
        roll_ramp: Arc<Ramp> = Ramp::constant(0.0), unit(Angle), words("twist");

        [RootAndTip]
        /// Width and height at the root, as a fraction of full size. 0 starts the braid in a point.
        root_amplitude: f32 = 1.0, hard(0.0, 4.0), soft(0.0, 1.0), unit(Ratio);
        /// Blend along the source from the root amplitude (value 0) to full size (value 1).
        root_taper: Arc<Ramp> = taper(0.0, 0.3);
        /// Length over which the strands open from a bundle at the root to the full braid. 0 starts them as they lie in
        /// the braid.
        root_gather: f32 = 0.8, hard(0.0, 100.0), soft(0.0, 3.0), unit(Length);
        /// Width and height at the tip, as a fraction of full size. 0 ends the braid in a point.
        tip_amplitude: f32 = 0.7, hard(0.0, 4.0), soft(0.0, 1.0), unit(Ratio);
        /// Blend along the source from full size (value 0) to the tip amplitude (value 1).
        tip_taper: Arc<Ramp> = taper(0.3, 1.0);

        [Tie]
        /// Position of the tie, as a fraction of the source's length. Hair beyond it hangs loose as the end tuft; 1
        /// braids to the very end.
        tie: f32 = 0.9, hard(0.05, 1.0), soft(0.5, 1.0), unit(Ratio), handle(Handle::Along), words("elastic band bead");
        /// Length of the end tuft. Past the end of the source it continues straight. 0 ends with the source.
        tuft_length: f32 = 0.0, hard(0.0, 200.0), soft(0.0, 10.0), unit(Length), handle(Handle::Length), words("tassel tail");
        /// Extra width at the end of the tuft over the tie: 0 is as wide, 1 twice as wide, -1 a point.
        flare: f32 = 0.4, hard(-1.0, 10.0), soft(-1.0, 2.0), words("tassel");

        [Detail]
        /// CVs of each strand per stitch. 8 is enough for three strands and few stitches. Weaves with many strands need
        /// no more, since a stitch is then a shorter part of the path.
        cvs_per_stitch: i64 = 12, hard(8.0, 64.0), soft(8.0, 32.0), unit(Count), words("resolution points");
        /// Scale lengths with the size of the head. Needs the scalp.
        scale_with_head: bool = true;

        [Randomness]
        /// How loosely the braid is made: its size varies and strands bulge out in places. 0 is perfectly regular.
        looseness: f32 = 0.0, hard(0.0, 1.0), unit(Ratio), words("messy random");
        /// Random variation in stitch length: 0 makes all the same, 1 makes some several times as long as others.
        uneven_stitches: f32 = 0.0, hard(0.0, 1.0), unit(Ratio), words("messy random irregular");
        /// Short hairs that stick out of the braid, per centimetre of braid. They have their own output.
        flyaways: f32 = 0.0, hard(0.0, 1000.0), soft(0.0, 40.0), unit(PerCm), words("stray frizz fuzz");
        /// Length of the longest flyaways; the shortest have a third of it.
        flyaway_length: f32 = 1.0, hard(0.01, 50.0), soft(0.2, 4.0), unit(Length),
            idle(|of| matches!(of("flyaways"), Some(Value::Float(0.0))).then_some("there are no flyaways"));
        /// Random seed for this node. It changes ids too.
        seed: i64 = 0;
    }
    outputs {
        /// The strands: one tuft per source with one curve per strand, with radius, normal and the fraction along the
        /// source at each point.
        curves: Curves;
        /// One curve per braid through its stitches (the places where a strand is outermost), in order, with side and
        /// fraction along the source at each point.
        stitches: Curves;
        /// The flyaways: fine curves rooted on the strands.
        flyaways: Curves;
    }
}

choice! {
    /// Path of the strands across the braid.
    Formula {
        /// A true weave for every number of strands.
        Weave = "weave",
        /// The formula from the Lightyear talk, as printed. Identical for three strands; with more, strands intersect.
        Lightyear = "lightyear",
    }
}

choice! {
    /// What sets the number of stitches.
    StitchesBy {
        /// The number of stitches per curve.
        Count = "count",
        /// The length of a stitch.
        Spacing = "spacing",
    }
}

choice! {
    /// Direction that the front of the braid faces.
    FramesBy {
        /// Away from the scalp if one is wired, else with as little twist as possible.
        Auto = "auto",
        /// As little twist as possible, starting at the root. For free-hanging braids.
        Minimal = "minimal",
        /// A fixed direction.
        UpAxis = "up_axis",
        /// Away from the scalp below; farther from it than the braid is wide, as little twist as possible. For
        /// cornrows.
        Scalp = "scalp",
    }
}

choice! {
    /// How strands cross on their way in.
    Crossing {
        /// Under for braids on the scalp, over for others.
        Auto = "auto",
        /// Strands pass under their neighbours and the braid stands out: cornrow, Dutch braid.
        Under = "under",
        /// Strands pass over their neighbours and the braid lies flat: English and French braid.
        Over = "over",
    }
}

choice! {
    /// What happens where a braid reaches into the skin.
    Intersection {
        /// Flattens the braid onto the skin; tubes still touch and never intersect.
        Flatten = "flatten",
        /// Keeps its cross-section and moves it off the skin.
        PushOut = "push_out",
        /// Leaves it as it is; strands may lie below the skin, and their allowed depth is set accordingly.
        Allow = "allow",
    }
}

choice! {
    /// Handedness of the braid.
    Hand {
        /// Twisted like the middle of the letter Z.
        Z = "Z",
        /// Twisted like the middle of the letter S.
        S = "S",
    }
}

fn taper(from: f32, to: f32) -> Ramp {
    Ramp::new(Blend::Smooth, vec![(from, 0.0), (to, 1.0)]).unwrap_or_else(|_| Ramp::constant(1.0))
}

/// Why the crossing has no effect: in an odd weave, over and under are the same braid.
fn one_braid(of: &dyn Fn(&str) -> Option<Value>) -> Option<&'static str> {
    let (Some(Value::Int(strands)), Some(Value::Int(asked))) = (of("strands"), of("weave")) else {
        return None;
    };
    let strands = u32::try_from(strands).ok().filter(|n| (2..=12).contains(n))?;
    let fits = |m: &u32| *m > 0 && *m < strands && coprime(*m, strands);
    let m = u32::try_from(asked).ok().filter(fits).unwrap_or(default_frequency(strands));
    let talk = matches!(of("formula"), Some(Value::Text(word)) if *word == *"lightyear");
    (m % 2 == 1 && !talk).then_some(
        "over and under are one braid in this weave (a rope, four or six strands): the handedness tells two apart",
    )
}

/// Index from which a braid's own id, and that of its stitch curve, are made from its source: beyond any strand.
const BRAID_ITSELF: u64 = 1 << 32;
const STITCHES: u64 = BRAID_ITSELF + 1;

fn eval(cx: &EvalCx, inputs: Inputs) -> Result<Outputs, NodeError> {
    let plan = Plan::new(cx, &inputs);
    let size = foreseen(&plan)?;
    let [curves, stitches, flyaways] = cx.by_place(inputs.scalp.as_ref()).each_curve(
        &inputs.source,
        &size,
        |tuft, curve, piece| match braid(&plan, tuft, curve, piece)? {
            Some(made) => Ok(made),
            None => Ok([const { TuftBuilder::new }; 3].map(|new| new().build())),
        },
    )?;
    Ok(Outputs { curves, stitches, flyaways })
}

/// Lower bound for the points of all strands up to their ties: stitches are assumed as long as they can be.
fn foreseen(plan: &Plan) -> Result<Size, NodeError> {
    let inputs = plan.inputs;
    let scalp = inputs.scalp.as_ref();
    let longest = 1.0 + 0.7 * inputs.uneven_stitches;
    let mut all = 0.0;
    for tuft in inputs.source.tufts() {
        let count = inputs.stitches.on_traced(tuft, scalp)?;
        let spacing = inputs.stitch_spacing.on_traced(tuft, scalp)?;
        let width = inputs.width.on_traced(tuft, scalp)?;
        for curve in 0..tuft.len() {
            let most = |field: &Sampler| {
                (0..=64).map(|k| field.along(tuft, curve, k as f32 / 64.0)).fold(0.0, f32::max)
            };
            let stitches = match inputs.stitches_by {
                StitchesBy::Count => count.along(tuft, curve, 0.0).round(),
                StitchesBy::Spacing => {
                    let pitch = match most(&spacing) {
                        asked if asked > 0.0 => asked,
                        // Strands swing at most half the width.
                        _ => firm_pitch(plan.weave.strands) * 0.5 * most(&width),
                    };
                    let chords = tuft.curve(curve).windows(2).map(|w| w[0].distance(w[1]));
                    (chords.sum::<f32>() * inputs.tie / (pitch * longest).max(1e-6)).floor()
                }
            };
            all += f64::from(stitches.clamp(1.0, MOST_STITCHES));
        }
    }
    Ok(Size::of(&[
        ("stitches of all sources", all),
        ("strands", f64::from(plan.weave.strands)),
        ("cvs_per_stitch", inputs.cvs_per_stitch as f64),
    ]))
}

/// Settings shared by all braids of one evaluation.
struct Plan<'a> {
    inputs: &'a Inputs,
    weave: Weave,
    paths: Paths,
    facing: Facing,
    below: Option<Below<'a>>,
    loose: Dice,
    uneven: Dice,
    stray: Dice,
}

impl<'a> Plan<'a> {
    fn new(cx: &EvalCx, inputs: &'a Inputs) -> Self {
        let strands = inputs.strands as u32;
        let mut m = inputs.weave as u32;
        if m != 0 && (m >= strands || !coprime(m, strands)) {
            m = default_frequency(strands);
            cx.warn(format!(
                "weave {} does not fit {strands} strands: it must be smaller and have no divisor in common with \
                 them; {m} was taken",
                inputs.weave
            ));
        } else if m == 0 {
            m = default_frequency(strands);
        }
        let scalp = inputs.scalp.as_ref().map(TracedScalp::head);
        let facing = match inputs.frames {
            FramesBy::Auto | FramesBy::Scalp if scalp.is_some() => Facing::Skin,
            FramesBy::UpAxis => Facing::Axis(inputs.up_axis),
            FramesBy::Scalp => {
                cx.warn("frames follow the scalp, but none is wired: minimal frames were taken");
                Facing::Carried
            }
            FramesBy::Auto | FramesBy::Minimal => Facing::Carried,
        };
        let under = match inputs.crossing {
            Crossing::Auto => facing == Facing::Skin,
            Crossing::Under => true,
            Crossing::Over => false,
        };
        let mirrored = inputs.handedness == Hand::S;
        let weave = match inputs.formula {
            Formula::Weave => Weave::new(strands, m, under, mirrored),
            Formula::Lightyear => Weave::lightyear(strands, under, mirrored),
        };
        if inputs.formula == Formula::Lightyear && strands != 3 {
            cx.warn(format!(
                "the formula of the talk lets {strands} strands pass through each other; formula weave does not"
            ));
        }
        let contact = match inputs.scalp_intersection {
            Intersection::Flatten => Contact::Flatten,
            Intersection::PushOut => Contact::PushOut,
            Intersection::Allow => Contact::Allow,
        };
        Self {
            inputs,
            weave,
            paths: Paths::new(&weave),
            facing,
            below: scalp.map(|scalp| Below { scalp, skin: cx.skin(scalp), contact }),
            loose: cx.dice(inputs.seed, "looseness"),
            uneven: cx.dice(inputs.seed, "uneven stitches"),
            stray: cx.dice(inputs.seed, "flyaways"),
        }
    }
}

/// The most stitches that a spacing may produce on one source.
const MOST_STITCHES: f32 = 400.0;
/// Stitches are at least this fraction of the longest: hair gets points for a few per stitch, and passes through more.
const SHORTEST: f32 = 0.4;
/// Stitches shorter than this many amplitudes anywhere on a braid are reported.
const CROWDED: f32 = 0.7;

/// The strands, stitches and flyaways of one source; `None` if the source is not a curve.
fn braid(
    plan: &Plan,
    tuft: &Tuft,
    curve: usize,
    piece: &mut Piece,
) -> Result<Option<[Tuft; 3]>, NodeError> {
    let (inputs, source_id) = (plan.inputs, tuft.id(curve));
    let source = match Spline::new(tuft.curve(curve)) {
        Ok(source) => source,
        Err(fault) => {
            piece.trouble(source_id, fault);
            return Ok(None);
        }
    };
    let (tag, strands) = (inputs.seed as u64, plan.weave.strands);
    let braid_id = curve_id(source_id, tag, BRAID_ITSELF);
    let ids: Vec<u64> = (0..u64::from(strands)).map(|i| curve_id(source_id, tag, i)).collect();
    let scalp = piece.scalp();
    let [width, height, spacing, roll, fullness, count] = [
        &inputs.width,
        &inputs.height,
        &inputs.stitch_spacing,
        &inputs.roll,
        &inputs.fullness,
        &inputs.stitches,
    ]
    .map(|field| field.on(tuft, scalp));
    let (width, height, roll, fullness) = (width?, height?, roll?, fullness?);

    // A rope is as high as it is wide.
    let flat = if plan.weave.waves() == 1 { 1.0 } else { 0.5 };
    // The full size is that of the widest position; elsewhere it is scaled.
    let outer = |u: f32| {
        let (w, h) = (width.along(tuft, curve, u), height.along(tuft, curve, u));
        (w, if h > 0.0 { h } else { flat * w })
    };
    let (mut full_w, mut full_h) = (0.0f32, 0.0f32);
    for k in 0..=16 {
        let (w, h) = outer(k as f32 / 16.0);
        (full_w, full_h) = (full_w.max(w), full_h.max(h));
    }
    let scale = |u: f32| {
        let (w, h) = outer(u);
        let root = lerp(inputs.root_amplitude, 1.0, inputs.root_taper.at(u));
        let tip = lerp(1.0, inputs.tip_amplitude, inputs.tip_taper.at(u));
        // Amplitude 0 would put all strands at one point, where no tube has any thickness.
        let taper = (root * tip).max(0.02);
        (taper * w / full_w, taper * h / full_h)
    };
    // A braid that sinks into skin it is pressed onto is a flatter braid.
    let offset = inputs.scalp_offset;
    let pressing = plan.facing == Facing::Skin
        && plan.below.as_ref().is_some_and(|below| below.contact == Contact::Flatten);
    let (depth, raise) = if pressing {
        let depth = (full_h * (1.0 - 0.5 * inputs.sink) + offset.min(0.0)).max(0.2 * full_h);
        (depth, (offset.max(0.0), 0.5 * depth))
    } else {
        (full_h, (offset, 0.5 * full_h * (1.0 - inputs.sink)))
    };

    let length = source.length();
    let tied_at = length * inputs.tie;
    let tuft_length = match inputs.tuft_length {
        asked if asked > 0.0 => asked,
        _ => length - tied_at,
    };
    let spacing = spacing?;
    let spacing_at = |u: f32| spacing.along(tuft, curve, u);
    let varies = inputs.stitches_by == StitchesBy::Spacing && !spacing.is_of_curves();
    // Inner sizes are those of the widest position, where stitches are longest.
    let spacing = match varies {
        true => (0..=64).map(|k| spacing_at(k as f32 / 64.0)).fold(0.0, f32::max),
        false => spacing_at(0.0),
    };
    let asked = match inputs.stitches_by {
        StitchesBy::Count => Pitch::Cm(tied_at / count?.along(tuft, curve, 0.0).round().max(1.0)),
        StitchesBy::Spacing if spacing > 0.0 => Pitch::Cm(spacing),
        StitchesBy::Spacing => Pitch::Amplitudes(firm_pitch(strands)),
    };
    let at_full = fullness.along(tuft, curve, 0.5).min(1.0);
    let mut size = plan.paths.size(full_w, depth, asked, at_full);
    let limited = size.pitch.clamp(tied_at / MOST_STITCHES, tied_at);
    if limited > size.pitch {
        piece.trouble(source_id, "stitches were limited to 400 on a curve");
    }
    if limited != size.pitch {
        size = plan.paths.size(full_w, depth, Pitch::Cm(limited), at_full);
    }
    let least = SHORTEST * size.pitch;
    let along = |s: f32| spacing_at(s / length).clamp(least, size.pitch);
    // Width and stitches that do not vary together may fit only at the widest position.
    let closest = |k: usize| {
        let s = tied_at * k as f32 / 16.0;
        let pitch = if varies { along(s) } else { size.pitch };
        pitch / (size.a * scale(s / length).0).max(1e-6)
    };
    if size.pitch < 0.98 * size.a || (0..=16).map(closest).fold(f32::MAX, f32::min) < CROWDED {
        piece.trouble(
            source_id,
            "stitches are closer than the amplitude of the braid, so strands are thin",
        );
    }
    let along: Option<&dyn Fn(f32) -> f32> = if varies { Some(&along) } else { None };
    let (advance, stitches) = advance(plan, braid_id, size.pitch, along, tied_at);

    let start = tuft.view(attr::NORMAL).at(curve, tuft.range(curve).start);
    let start = (start != Vec3::ZERO)
        .then_some(start)
        .or_else(|| scalp.map(|scalp| source.at(0.5) - scalp.frame().origin));
    let shape = BraidShape {
        weave: plan.weave,
        size,
        advance,
        stitches,
        tied_at,
        tuft: if tuft_length > 1e-3 * length { tuft_length } else { 0.0 },
        flare: inputs.flare,
        phase: f64::from(inputs.phase) / 360.0,
        cvs_per_stitch: inputs.cvs_per_stitch as usize,
        gather: inputs.root_gather,
        scale: &scale,
        roll: &|u| (roll.along(tuft, curve, u) + inputs.roll_ramp.at(u)).to_radians(),
        facing: plan.facing,
        start,
        raise,
        looseness: inputs.looseness,
        loose: plan.loose,
        braid: braid_id,
        ids: &ids,
        below: plan.below,
    };
    let laid = match shape.lay(&source) {
        Ok(laid) => laid,
        Err(fault) => {
            piece.trouble(source_id, fault);
            return Ok(None);
        }
    };
    // A search this far along the source finds the nearest point of another strand even where a bend of radius 2A
    // halves distances on its inner side.
    let window = 1.5 * size.pitch.max(1.2 * size.a);
    let fill = |u: f32| fullness.along(tuft, curve, u);
    let stitch = laid.cvs_per_stitch(stitches);
    let wave = stitch * strands as f32 / plan.weave.waves() as f32;
    let near = Near { window, stitch, wave };
    let mut radii = touching_radii(&laid.lines, near, piece)?;
    let mut depths: Vec<Vec<f32>> = vec![];
    for (line, radii) in laid.lines.iter().zip(&mut radii) {
        let mut depth = vec![];
        for (k, radius) in radii.iter_mut().enumerate() {
            let p = line.spline.point(line.spline.place_of_cv(k));
            *radius *= fill((line.s[k] / length).min(1.0));
            depth.push(
                plan.below
                    .as_ref()
                    .map_or(0.0, |below| rest(below, p, laid.grip(line.s[k]), radius)),
            );
        }
        depths.push(depth);
    }

    let n = laid.lines[0].s.len();
    let mut out = TuftBuilder::even(
        laid.lines
            .iter()
            .flat_map(|line| (0..n).map(|k| line.spline.point(line.spline.place_of_cv(k))))
            .collect(),
        n,
    );
    let along = |line: &StrandLine| -> Vec<f32> {
        line.s.iter().map(|s| (s / length).clamp(0.0, 1.0)).collect()
    };
    out.set(attr::ID, Domain::Curve, ids.clone());
    out.set(attr::PARENT, Domain::Curve, vec![source_id]);
    out.set(attr::BRAID, Domain::Curve, vec![braid_id]);
    out.set(attr::TIED, Domain::Curve, vec![(shape.tied_at / length).min(1.0)]);
    out.set(attr::STRAND, Domain::Curve, (0..strands as i32).collect());
    let phases = (0..strands).map(|i| {
        let cycle = shape.phase + plan.weave.ahead(i);
        (cycle - cycle.floor()) as f32
    });
    out.set(attr::PHASE, Domain::Curve, phases.collect());
    out.set(attr::ALONG, Domain::Point, laid.lines.iter().flat_map(along).collect());
    out.set(attr::RADIUS, Domain::Point, radii.concat());
    out.set(attr::NORMAL, Domain::Point, laid.normals.concat());
    if depths.iter().flatten().any(|depth| *depth > 0.0) {
        out.set(attr::ALLOW_DEPTH, Domain::Point, depths.concat());
    }
    bind(&mut out, tuft, curve, source.at(0.0), scalp);
    let own = own_parents(strands as usize);
    let lineage = Lineage {
        parent: &|_| (tuft, curve),
        of: &|strand| &own[strand],
        places: &|strand| {
            let line = &laid.lines[strand as usize];
            line.s.iter().map(|s| place_of(source.locate(s / length))).collect()
        },
        takes: &|_| true,
    };
    lineage.pass_on(&mut out);
    let out = out.build();

    let mut stitch_curve = TuftBuilder::new();
    let all = shape.stitches();
    let places: Vec<(Vec3, f32, Vec3)> =
        all.iter().map(|stitch| laid.stitch(stitch, stitches)).collect();
    if places.len() > 1 {
        stitch_curve.push_curve(&places.iter().map(|(p, ..)| *p).collect::<Vec<_>>());
        stitch_curve.set(attr::ID, Domain::Curve, vec![curve_id(source_id, tag, STITCHES)]);
        stitch_curve.set(attr::PARENT, Domain::Curve, vec![source_id]);
        stitch_curve.set(attr::BRAID, Domain::Curve, vec![braid_id]);
        let along = places.iter().map(|(_, s, _)| (s / length).clamp(0.0, 1.0));
        stitch_curve.set(attr::ALONG, Domain::Point, along.collect());
        stitch_curve.set(attr::SIDE, Domain::Point, all.iter().map(|s| s.side).collect());
        stitch_curve.set(
            attr::STRAND,
            Domain::Point,
            all.iter().map(|s| s.strand as i32).collect(),
        );
        stitch_curve.set(attr::NORMAL, Domain::Point, places.iter().map(|(.., n)| *n).collect());
        bind(&mut stitch_curve, tuft, curve, source.at(0.0), scalp);
    }

    let fine: Vec<FlyawayStrand> = laid
        .lines
        .iter()
        .zip(&radii)
        .enumerate()
        .map(|(strand, (line, radii))| FlyawayStrand {
            spline: &line.spline,
            radii,
            centres: line.s.iter().map(|s| laid.centre(*s)).collect(),
            hair: (&out, strand),
        })
        .collect();
    let hairs = (inputs.flyaways * tied_at).round() as usize;
    let longest = inputs.flyaway_length;
    let skin = plan.below.as_ref().filter(|below| below.contact != Contact::Allow);
    let skin = skin.map(|below| &below.skin);
    let strays =
        flyaways::flyaways(&fine, (braid_id, tag), hairs, longest, skin, plan.stray, piece)?;
    Ok(Some([out, stitch_curve.build(), strays]))
}

/// Stitch length of a firm braid, in amplitudes. Strands cross at about 45 degrees and close the gaps between them; at
/// twice the amplitude, three strands half as high as wide leave the scalp visible. Below one amplitude, tubes get
/// thin.
fn firm_pitch(strands: u32) -> f32 {
    (6.0 / strands as f32).clamp(1.0, 1.5)
}

fn lerp(a: f32, b: f32, t: f32) -> f32 {
    a + (b - a) * t
}

/// Positions of the stitches up to the tie, and their number. `along` gives the length of a stitch at a position (cm)
/// if it varies.
fn advance(
    plan: &Plan,
    braid_id: u64,
    pitch: f32,
    along: Option<&dyn Fn(f32) -> f32>,
    tied_at: f32,
) -> (Advance, f64) {
    let mut even = f64::from(tied_at) / f64::from(pitch);
    if plan.inputs.stitches_by == StitchesBy::Count {
        even = even.round().max(1.0);
    }
    if plan.inputs.uneven_stitches <= 0.0 && along.is_none() {
        return (Advance::even(pitch), even);
    }
    let uneven = |k: u64| 1.0 + 0.7 * plan.inputs.uneven_stitches * plan.uneven.signed(braid_id, k);
    let draw = |k: u64| pitch * uneven(k);
    match plan.inputs.stitches_by {
        // The requested number shares the length.
        StitchesBy::Count => {
            let n = even as u64;
            let fit = tied_at / (0..n).map(draw).sum::<f32>();
            (Advance::uneven(pitch, (0..n).map(|k| draw(k) * fit)), n as f64)
        }
        // As many as fit: a longer source changes none of them.
        StitchesBy::Spacing => {
            let mut reached = 0.0;
            let lengths = (0..).map_while(|k| {
                let length = along.map_or(pitch, |along| along(reached)) * uneven(k);
                let more = reached < tied_at;
                reached += length;
                more.then_some(length)
            });
            let advance = Advance::uneven(pitch, lengths);
            let stitches = advance.q(tied_at);
            (advance, stitches)
        }
    }
}

/// Lets a tube rest on the skin: limits its radius to the height of its centre where the skin counts, and returns how
/// deep below the skin it still reaches.
fn rest(below: &Below, p: Vec3, grip: f32, radius: &mut f32) -> f32 {
    let Some(d) = strand_placement::distance(below, p, 1.5 * *radius) else { return 0.0 };
    if below.contact != Contact::Allow {
        let free = (1.0 - grip) * *radius;
        *radius = radius.min(d.max(0.02 * *radius) + free);
    }
    // A thousandth extra, for the parts between CVs.
    if *radius > d + 1e-4 { (*radius - d) + 1e-3 } else { 0.0 }
}

/// Binds curves to the scalp where their source is bound, or else at the closest point.
fn bind(out: &mut TuftBuilder, tuft: &Tuft, curve: usize, root: Vec3, scalp: Option<&Scalp>) {
    let at = tuft.range(curve).start;
    let triangle = tuft.view(ROOT_TRIANGLE).at(curve, at);
    if triangle >= 0 {
        out.set(ROOT_TRIANGLE, Domain::Curve, vec![triangle]);
        out.set(ROOT_BARY, Domain::Curve, vec![tuft.view(ROOT_BARY).at(curve, at)]);
        out.set(ROOT_UV, Domain::Curve, vec![tuft.view(ROOT_UV).at(curve, at)]);
    } else if let Some(bound) = scalp.and_then(|scalp| scalp.closest_root(root)) {
        out.set(ROOT_TRIANGLE, Domain::Curve, vec![bound.triangle as i32]);
        out.set(ROOT_BARY, Domain::Curve, vec![bound.bary]);
        out.set(ROOT_UV, Domain::Curve, vec![bound.uv]);
    }
}
