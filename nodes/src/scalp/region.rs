//! Region: another place where hair grows on the same head, for the nodes behind it.
//!
//! Guarantees: the mesh, its masks and what is known of the skin are shared with the head, and triangles keep their
//! numbers, so hair of several regions can be merged and reads the same masks. Hair outside the outlines is none,
//! however coarse the mesh.

use super::drawn::{self, DrawnRegionParams};
use super::hairline;
use super::head::INNER_WALL;
use super::other_side;
use super::paint_mask::on_skin;
use crate::data::landmarks::Landmark;
use crate::data::region::ChosenRegion;
use crate::data::scalp::Scalp;
use crate::data::strokes::Strokes;
use crate::define::{FieldInput, KnownInputs, NodeError, choice, node};
use crate::eval::EvalCx;
use glam::Vec3;
use std::sync::Arc;

node! {
    /// Another place on the same head where hair grows: a beard, brows, a patch of fur.
    ///
    /// Draw outlines in the viewport, wire a mask, or both: hair grows inside the outlines, where the mask says; or outside
    /// of them, which leaves out a tail, feet or eyes. Wire the
    /// resulting scalp to the nodes that grow this hair. Other hair keeps the head's own region, and the head can have as
    /// many regions as it needs. Partings come behind the region.
    "region", version 1, label "Region",
        words "beard brow eyebrow moustache mustache sideburn lash patch area face body hairline where several second outline",
        scales, refuses(refused);
    inputs {
        /// The head.
        scalp: Arc<Scalp>;
        /// Closed strokes on the skin. Hair grows inside, on the smaller of the two sides. A stroke inside another cuts
        /// a hole.
        outline: Arc<Strokes> = Strokes::default(), words("stroke edge hairline line closed");
        /// Whether hair grows inside the outlines or outside.
        side: Side = Side::Inside, words("invert exclude leave out bare not except without");
        /// Draw each outline on both sides of the head. Where these differ, or the face is turned, the other one is laid onto the skin.
        symmetric: bool = false, words("mirror both sides brows");
        /// Where hair grows, inside the outlines or, without any, on the whole head: a mask of the head such as
        /// "material:brows", a painted mask or a texture mask.
        mask: FieldInput = 1.0, hard(0.0, 1.0), unit(Ratio), words("paint texture material vertex colour");
        /// Fade width at the outlines. 0 is a sharp edge.
        edge: f32 = 0.3, hard(0.0, 10.0), soft(0.0, 2.0), unit(Length), words("soft fade falloff feather");
        /// Scale the fade width with the size of the head.
        scale_with_head: bool = true, words("head units");
    }
    outputs {
        /// The same head, with hair growing in this region.
        scalp: Arc<Scalp>;
    }
}

choice! {
    /// Whether hair grows inside the outlines or outside.
    Side {
        /// Inside the outlines, also where the head's own region is not.
        Inside = "inside",
        /// Where it grows on the incoming head, but not inside the outlines.
        Outside = "outside",
    }
}

fn refused(told: &KnownInputs) -> Result<(), NodeError> {
    on_skin(told, "mask")
}

fn eval(cx: &EvalCx, inputs: Inputs) -> Result<Outputs, NodeError> {
    let Inputs { scalp, mask, .. } = &inputs;
    let drawn = match inputs.outline.0.is_empty() {
        false => Some(inside(cx, &inputs)?),
        true if mask.constant().is_some() => {
            cx.warn(
                "hair grows on the head's own region until an outline is drawn or a mask wired",
            );
            return Ok(Outputs { scalp: scalp.clone() });
        }
        true => None,
    };
    let within = inputs.side == Side::Outside;
    let chosen = ChosenRegion::new(scalp, drawn, (&mask.field, within), &|| cx.check())?;
    match chosen.area() {
        area if area > 0.0 => cx.remark(format!("region: {}", drawn::area(area))),
        _ => cx.warn("hair grows nowhere: the region is empty"),
    }
    if scalp.sections().is_some() {
        cx.remark("the region has no partings: wire Partings behind it");
    }
    Ok(Outputs { scalp: Arc::new(scalp.with_region(chosen)) })
}

/// The region inside the outlines, or all that is outside of them.
fn inside(cx: &EvalCx, inputs: &Inputs) -> Result<crate::data::drawn::DrawnRegion, NodeError> {
    let scalp = &inputs.scalp;
    let (surface, frame) = (scalp.surface(), scalp.frame());
    // The lips join the skin to the mouth's inside, which has no hair.
    let is_head = scalp.landmarks().get(Landmark::Crown).is_some();
    let outside = inputs.side == Side::Outside;
    let mut may = match is_head && !outside {
        true => hairline::outer_skin(surface, frame, &|| cx.check())?,
        false => vec![1.0; surface.points.len()],
    };
    if let Some(wall) = scalp.mask(INNER_WALL) {
        may.iter_mut().zip(wall).for_each(|(may, wall)| *may *= 1.0 - wall);
    }
    let mut strokes = Strokes::clone(&inputs.outline);
    if inputs.symmetric {
        let mut twins = strokes.0.clone();
        for stroke in &mut twins {
            let line: Vec<Vec3> =
                stroke.samples.iter().map(|sample| scalp.place(sample.position)).collect();
            let laid = other_side::laid(surface, frame, &line, &|| cx.check())?;
            for (k, sample) in stroke.samples.iter_mut().enumerate() {
                sample.position = match &laid {
                    Some(laid) => scalp.given(laid[k]),
                    None => sample.position * Vec3::new(-1.0, 1.0, 1.0),
                };
            }
        }
        strokes.0.extend(twins);
    }
    let softness = inputs.edge;
    let params = DrawnRegionParams { strokes: &strokes, names: "", outside, softness, may };
    let regions = drawn::regions(cx, &scalp.net(), scalp.space(), params)?;
    let (_, whole) = regions.into_iter().next().expect("the region of all outlines");
    Ok(whole)
}

#[cfg(test)]
mod tests {
    use crate::data::field::Field;
    use crate::data::scalp::Scalp;
    use crate::data::strokes::{Brush, Stroke, Strokes};
    use crate::define::Value;
    use crate::testing::{area_within, curves_of, fails, head, round, run};
    use glam::Vec3;
    use std::sync::Arc;

    fn region(scalp: &Arc<Scalp>, set: &[(&'static str, Value)]) -> (Arc<Scalp>, Vec<String>) {
        let on = [("scalp", scalp.clone().into())];
        let (out, said) = run(crate::by_id("region").unwrap(), &[&on, set].concat());
        let Value::Scalp(scalp) = &out[0] else { panic!("a scalp") };
        (scalp.clone(), said)
    }

    fn outline(scalp: &Scalp, at: Vec3, radius: f32) -> (Vec3, Stroke) {
        let middle = scalp.closest_root(scalp.frame().point_from_head(at)).unwrap().point;
        (middle, round(scalp, 1, middle, radius))
    }

    fn roots(scalp: &Arc<Scalp>) -> Vec<Vec3> {
        let set = [("scalp", scalp.clone().into()), ("count", Value::Int(800))];
        let (grown, _) = run(crate::by_id("scatter_guides").unwrap(), &set);
        curves_of(&grown[0]).each().map(|(tuft, i)| tuft.curve(i)[0]).collect()
    }

    #[test]
    fn hair_grows_inside_the_outlines_alone_and_the_head_keeps_its_own_region() {
        let plain = head(&[]);
        let (jaw, line) = outline(&plain, Vec3::new(6.0, -6.0, 4.0), 2.2);
        let sharp = ("edge", Value::Float(0.0));
        let (beard, said) =
            region(&plain, &[("outline", Strokes(vec![line]).into()), sharp.clone()]);
        let told = said.iter().find_map(|s| s.strip_prefix("region: ")?.strip_suffix(" cm2"));
        let (told, wide): (f32, f32) =
            (told.unwrap().parse().unwrap(), area_within(&beard, jaw, 2.2));
        assert!((told / wide - 1.0).abs() < 0.02, "{told} cm2 of {wide}");
        let hair = roots(&beard);
        assert!(hair.len() > 700, "{}", hair.len());
        assert!(hair.iter().all(|p| p.distance(jaw) < 2.23));
        assert!(roots(&plain).iter().all(|p| p.distance(jaw) > 2.23));
        // One head: a mask that is painted on it is read by the hair of both.
        assert_eq!((plain.whole(), plain.key() == beard.key()), (beard.whole(), false));

        let (eye, line) = outline(&plain, Vec3::new(3.2, 2.0, 8.5), 1.0);
        let both = [("outline", Strokes(vec![line]).into()), ("symmetric", true.into()), sharp];
        let hair = roots(&region(&plain, &both).0);
        let other = plain.place(plain.given(eye) * Vec3::new(-1.0, 1.0, 1.0));
        let near = |middle: Vec3| hair.iter().filter(|p| p.distance(middle) < 1.1).count();
        assert_eq!(near(eye) + near(other), hair.len());
        assert!(near(eye).abs_diff(near(other)) < 40, "{} and {}", near(eye), near(other));
    }

    #[test]
    fn on_a_head_whose_face_is_turned_the_other_side_is_that_of_the_face() {
        // The built-in head is the same on both sides of its file's x = 0; its frame is turned against it.
        let (plain, turned) = (head(&[]), head(&[("turn", Value::Float(4.0))]));
        let brow = plain.frame().point_from_head(Vec3::new(3.2, -0.6, 9.0));
        let (middle, line) = outline(&turned, turned.frame().head_from_point(brow), 0.8);
        let mirror = |p: Vec3| p * Vec3::new(-1.0, 1.0, 1.0);
        let other = turned.closest_root(mirror(middle)).unwrap().point;
        let in_frame = turned.place(turned.given(middle) * Vec3::new(-1.0, 1.0, 1.0));
        assert!(other.distance(in_frame) > 1.0);
        let outline = Strokes(vec![line]).into();
        let set = [("outline", outline), ("symmetric", true.into()), ("edge", Value::Float(0.0))];
        let hair = roots(&region(&turned, &set).0);
        let near = |middle: Vec3| hair.iter().filter(|p| p.distance(middle) < 1.0).count();
        assert_eq!(near(middle) + near(other), hair.len());
        assert!(near(middle).abs_diff(near(other)) < 40, "{} and {}", near(middle), near(other));
    }

    #[test]
    fn outside_of_the_outlines_hair_grows_where_it_did() {
        let plain = head(&[]);
        let sharp = ("edge", Value::Float(0.0));
        let without = |on: &Arc<Scalp>, at: Vec3, radius: f32| {
            let (middle, line) = outline(&plain, at, radius);
            let set = [("side", "outside".into()), ("outline", Strokes(vec![line]).into())];
            let (scalp, said) = region(on, &[&set[..], std::slice::from_ref(&sharp)].concat());
            let told = said.iter().find_map(|s| s.strip_prefix("region: ")?.strip_suffix(" cm2"));
            let area: f32 = told.unwrap().parse().unwrap();
            (scalp, middle, area)
        };
        let (first, crown, left) = without(&plain, Vec3::new(2.0, 9.0, -1.0), 3.0);
        let hair = roots(&first);
        assert!(hair.len() > 700 && hair.iter().all(|p| p.distance(crown) > 2.9));
        // A bald spot: the rest of the head's own region, and nothing but it.
        assert!(hair.iter().all(|p| {
            let root = plain.closest_root(*p).unwrap();
            plain.grows(root.triangle, root.bary) > 0.0
        }));
        // One behind the other: both are left out.
        let (second, nape, less) = without(&first, Vec3::new(0.0, 3.0, -9.0), 2.0);
        let hair = roots(&second);
        let clear = |p: &Vec3| p.distance(crown) > 2.9 && p.distance(nape) > 1.9;
        assert!(hair.len() > 700 && hair.iter().all(clear));
        let spot = area_within(&plain, nape, 2.0);
        assert!(((left - less) / spot - 1.0).abs() < 0.1, "{left} to {less} cm2 by {spot}");
    }

    #[test]
    fn a_mask_alone_or_within_outlines_says_where() {
        let plain = head(&[]);
        let (middle, line) = outline(&plain, Vec3::new(0.0, 3.0, 9.0), 2.0);
        let brush = Brush { radius: 1.2, ..Brush::default() };
        let dab =
            Stroke { brush: Some(brush), samples: line.samples[..1].to_vec(), ..line.clone() };
        let centre = plain.place(dab.samples[0].position);
        let set = [("scalp", plain.clone().into()), ("strokes", Strokes(vec![dab]).into())];
        let set = [&set[..], &[("softness", Value::Float(0.0))]].concat();
        let painted = run(crate::by_id("paint_mask").unwrap(), &set).0.remove(0);
        let (scalp, _) = region(&plain, &[("mask", painted.clone())]);
        let hair = roots(&scalp);
        // As sharp as it is painted, on a mesh of half a centimetre.
        assert!(
            hair.len() > 600 && hair.iter().all(|p| p.distance(centre) < 1.21),
            "{}",
            hair.len()
        );
        assert!(hair.iter().any(|p| p.distance(middle) > 2.3));
        let outlines = Strokes(vec![line]).into();
        let (scalp, _) = region(
            &plain,
            &[("mask", painted), ("outline", outlines), ("edge", Value::Float(0.0))],
        );
        let hair = roots(&scalp);
        let within = |p: &Vec3| p.distance(centre) < 1.21 && p.distance(middle) < 2.03;
        assert!(hair.len() > 600 && hair.iter().all(within), "{}", hair.len());
    }

    #[test]
    fn what_chooses_nothing_is_told() {
        let plain = head(&[]);
        let check = |set: &[(&'static str, Value)], word: &str| {
            let (scalp, said) = region(&plain, set);
            assert!(said.iter().any(|s| s.contains(word)), "{said:?}");
            scalp
        };
        let own = check(&[], "until an outline is drawn");
        assert_eq!(own.key(), plain.key());
        let none = Field::Mask("inner_wall_of_nothing".into());
        let on = [("scalp", plain.clone().into()), ("mask", none.into())];
        let err = fails(crate::by_id("region").unwrap(), &on);
        assert!(err.contains("has no mask"), "{err}");
        let (_, line) = outline(&plain, Vec3::new(0.0, 3.0, 9.0), 2.0);
        let none = [("outline", Strokes(vec![line]).into()), ("mask", Value::Float(0.0))];
        check(&none, "hair grows nowhere");
    }
}
