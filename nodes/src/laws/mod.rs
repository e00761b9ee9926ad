//! Laws of hair: what coif promises of grooms, measured on finished hair from any source (methods.md 0 and 2 to 6).
//!
//! A law takes [`MeasuredHair`], curves of a groom or of a file, and a scalp where it needs one, and returns figures; methods of
//! the figures judge them. What curves carry no data for is `None` and is not judged. `coif measure`, tests of nodes and the
//! warnings of evaluation use these laws and no others; nothing that makes hair does.
//!
//! Guarantees: the same figures for a groom and for its file, on every machine and for any number of threads. Not promised:
//! figures of curves that are not finite.

mod braid_spine;
mod braid_strands;
pub mod braid_words;
pub mod braids;
pub mod curls;
pub mod depth;
mod drawn;
pub mod hair;
pub mod ids;
pub mod outlines;
pub mod partings;
pub mod roots;
pub mod sections;
pub mod stitches;
pub mod strands;
pub mod ties;

pub use hair::MeasuredHair;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::curves::Curves;
    use crate::data::scalp::tests::shared_ball;
    use crate::define::Value;
    use crate::eval::PlainHost;
    use crate::formats::export::{About, Format, HairGroup, write};
    use crate::formats::usd::read::read_alone;
    use crate::testing::{Threads, curves_of, run};
    use glam::Vec3;
    use std::io::Cursor;

    /// Every figure of hair on the ball, in words.
    fn figures(hair: &MeasuredHair) -> Vec<String> {
        let scalp = shared_ball();
        let parted = partings::Partings::of(std::slice::from_ref(hair));
        vec![
            format!("{:?}", strands::measure(hair)),
            format!("{:?}", ids::repeated(hair)),
            format!("{:?}", braids::measure(hair, Some(&scalp))),
            format!("{:?}", stitches::measure(hair)),
            format!("{:?}", sections::measure(hair)),
            format!("{:?}", parted.map(|partings| partings.judge(hair))),
            format!("{:?}", curls::measure(hair)),
            format!("{:?}", outlines::measure(hair)),
            format!("{:?}", ties::measure(hair)),
            format!("{:?}", roots::measure(hair, &scalp)),
            format!("{:?}", depth::measure(hair, &scalp)),
        ]
    }

    /// What a node makes on the ball.
    fn made(node: &str, output: usize, set: &[(&str, Value)]) -> Curves {
        let own = [("scalp", shared_ball().into())];
        curves_of(&run(crate::by_id(node).unwrap(), &[&own, set].concat()).0[output]).clone()
    }

    #[test]
    fn curves_measure_the_same_before_they_are_written_and_after_on_any_number_of_threads() {
        let check = |name: &str, curves: Curves, tells: &[usize]| {
            let before = figures(&MeasuredHair::of(&curves, &PlainHost));
            for k in tells {
                assert_ne!(before[*k], "None", "{name} tells nothing of figure {k}");
            }
            assert_eq!(
                figures(&MeasuredHair::of(&curves, &Threads(3))),
                before,
                "{name} on threads"
            );
            let about = About {
                title: name.into(),
                generator: "test".into(),
                graph_hash: String::new(),
                seed: 0,
                sections: Default::default(),
            };
            let group = [HairGroup { name: name.into(), guides: false, curves }];
            let mut file = Cursor::new(vec![]);
            write(Format::Usdc, &group, &[], &about, &mut file, &|| false).unwrap();
            let read = read_alone(&file.into_inner(), "usdc").unwrap().remove(0);
            assert_eq!(figures(&MeasuredHair::read(&read, &PlainHost)), before, "{name} of a file");
        };
        let row: Vec<Vec3> = (-20..=20).map(|k| Vec3::new(0.2 * k as f32, 20.0, 0.0)).collect();
        let row: Vec<Vec3> =
            row.iter().map(|p| shared_ball().closest_root(*p).unwrap().point).collect();
        let mut b = crate::data::curves::TuftBuilder::new();
        b.push_curve(&row);
        let row = Value::from(Curves::new(vec![b.build().into()]));
        let strands = made("lissajous_braid", 0, &[("source", row)]);
        check("braid", strands, &[0, 1, 2]);
        let guides = made("scatter_guides", 0, &[("count", Value::Int(60))]);
        let curled = [("curves", guides.into()), ("preset", "4a".into())];
        check("curls", made("shape_list_curl", 0, &curled), &[0, 1, 6]);
        check("puff", made("sphere_puff", 1, &[("count", Value::Int(900))]), &[0, 1, 7]);
        let tied = [("density", Value::Float(1.0))];
        check("gathered", made("gather", 0, &tied), &[0, 1, 8]);
    }
}
