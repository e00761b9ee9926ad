//! Small files with the right figures, worked out by hand: every basis and wrap, widths of every interpolation, what is wrong or marked.

use super::report::{DEEPER, Measured, ROOTED};
use super::*;
use coif_nodes::laws::strands::Strands;
use coif_nodes::maths::transcendental::{cos, sin};
use std::f32::consts::TAU;

/// What is measured of a file of this text.
#[track_caller]
fn measured(text: &str) -> Vec<Measured> {
    measured_on(text, None)
}

#[track_caller]
fn measured_on(text: &str, scalp: Option<&Scalp>) -> Vec<Measured> {
    let text = format!("#usda 1.0\n{text}");
    let nothing = &mut |_: &str| Err("there is nothing beside it".to_owned());
    measure(&read_stage(text.as_bytes(), "file.usda", nothing).unwrap(), scalp, &PlainHost)
}

/// A prim of one curve: type or basis, wrap, points, and more.
fn curve(basis: &str, wrap: &str, points: &[[f32; 3]], more: &str) -> String {
    let kind = match basis {
        "linear" => "linear\"".to_owned(),
        basis => format!("cubic\" uniform token basis = \"{basis}\""),
    };
    let points: Vec<String> = points.iter().map(|[x, y, z]| format!("({x}, {y}, {z})")).collect();
    format!(
        "def BasisCurves \"hair\" {{ uniform token type = \"{kind} uniform token wrap = \"{wrap}\" \
         int[] curveVertexCounts = [{}] point3f[] points = [{}] {more} }}",
        points.len(),
        points.join(", ")
    )
}

/// The length, and the box about the curve.
#[track_caller]
fn check(basis: &str, wrap: &str, points: &[[f32; 3]], length: f32, low: [f32; 3], high: [f32; 3]) {
    let found = measured(&curve(basis, wrap, points, "")).remove(0);
    assert_eq!(found.strands.no_curve, 0);
    let near = |a: f32, b: f32| (a - b).abs() <= 1e-4 * b.abs().max(1.0);
    assert!(
        near(found.strands.length_cm[1], length),
        "{basis} {wrap}: {} is not {length}",
        found.strands.length_cm[1]
    );
    let [lo, hi] = found.strands.bounds.unwrap();
    // The box is that of points no farther apart than a thousandth from the curve.
    let near = |a: [f32; 3], b: [f32; 3]| (0..3).all(|k| (a[k] - b[k]).abs() <= 1.1e-3);
    assert!(near(lo, low) && near(hi, high), "{basis} {wrap}: {lo:?} {hi:?}");
}

/// Points up along y, one a centimetre from `from` on.
fn up(from: f32, n: usize) -> Vec<[f32; 3]> {
    (0..n).map(|k| [0.0, from + k as f32, 0.0]).collect()
}

const SQUARE: [[f32; 3]; 4] = [[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
/// How far the handles of a quarter circle are out: 4/3 (root of 2 - 1).
const HANDLE: f32 = 0.552_284_8;

#[test]
fn straight_curves_are_as_long_as_what_is_drawn_of_them() {
    // Even points on a line: a B-spline runs from a sixth of the way, which is the second point, to the last but one.
    for basis in ["bspline", "catmullRom"] {
        check(basis, "nonperiodic", &up(171.5, 5), 2.0, [0.0, 172.5, 0.0], [0.0, 174.5, 0.0]);
        check(basis, "pinned", &up(171.5, 5), 4.0, [0.0, 171.5, 0.0], [0.0, 175.5, 0.0]);
        check(basis, "pinned", &up(0.0, 2), 1.0, [0.0; 3], [0.0, 1.0, 0.0]);
    }
    for wrap in ["nonperiodic", "pinned"] {
        check("linear", wrap, &up(0.0, 5), 4.0, [0.0; 3], [0.0, 4.0, 0.0]);
        check("bezier", wrap, &up(0.0, 7), 6.0, [0.0; 3], [0.0, 6.0, 0.0]);
    }
}

#[test]
fn linear_curves_have_corners() {
    // Two diagonals of 1 x 1 and two of 2 x 1: 2 (root of 2 + root of 5).
    let zigzag = [[0.0; 3], [1.0, 1.0, 0.0], [-1.0, 2.0, 0.0], [1.0, 3.0, 0.0], [0.0, 4.0, 0.0]];
    check("linear", "nonperiodic", &zigzag, 7.300_563, [-1.0, 0.0, 0.0], [1.0, 4.0, 0.0]);
}

#[test]
fn a_closed_curve_has_its_closing_segment() {
    check("linear", "periodic", &SQUARE, 4.0, [0.0; 3], [1.0, 1.0, 0.0]);
    // A circle of four Bezier quarters, whose last handles lead back to the first point: 2 pi, longer by 1 in 7000.
    let h = HANDLE;
    let ring = [
        [1.0, 0.0, 0.0],
        [1.0, h, 0.0],
        [h, 1.0, 0.0],
        [0.0, 1.0, 0.0],
        [-h, 1.0, 0.0],
        [-1.0, h, 0.0],
        [-1.0, 0.0, 0.0],
        [-1.0, -h, 0.0],
        [-h, -1.0, 0.0],
        [0.0, -1.0, 0.0],
        [h, -1.0, 0.0],
        [1.0, -h, 0.0],
    ];
    check("bezier", "periodic", &ring, 6.284_07, [-1.0, -1.0, 0.0], [1.0, 1.0, 0.0]);
    // Of 24 points on a circle, Catmull-Rom goes through them, nearly round. A B-spline lies on a smaller one: at a point it
    // is (1 + 4 + 1) / 6 of it, with cos 15° for the neighbours: (2 + cos 15°) / 3 = 0.988642.
    let turn = |k: usize| k as f32 * TAU / 24.0;
    let round: Vec<[f32; 3]> = (0..24).map(|k| [cos(turn(k)), sin(turn(k)), 0.0]).collect();
    check("catmullRom", "periodic", &round, TAU, [-1.0, -1.0, 0.0], [1.0, 1.0, 0.0]);
    let r = 0.988_642;
    check("bspline", "periodic", &round, r * TAU, [-r, -r, 0.0], [r, r, 0.0]);
}

#[test]
fn a_bezier_is_measured_on_itself_and_not_through_its_handles() {
    // A quarter circle: pi / 2, longer by 1 in 7000, within the square that its handles leave.
    let quarter = [[1.0, 0.0, 0.0], [1.0, HANDLE, 0.0], [HANDLE, 1.0, 0.0], [0.0, 1.0, 0.0]];
    check("bezier", "nonperiodic", &quarter, 1.571_02, [0.0; 3], [1.0, 1.0, 0.0]);
    // An arch with its handles straight up from both ends: 3 t (1 - t) 2 high, 1.5 in the middle.
    let arch = [[0.0; 3], [0.0, 2.0, 0.0], [0.0, 2.0, 0.0], [0.0; 3]];
    check("bezier", "nonperiodic", &arch, 3.0, [0.0; 3], [0.0, 1.5, 0.0]);
}

#[test]
fn only_catmull_rom_curves_have_two_readings() {
    let law = "both readings of every curve agree to 0.001 cm";
    let bent = [
        [0.0; 3],
        [0.0, 0.1, 0.0],
        [2.0, 0.1, 0.0],
        [2.0, 2.0, 0.0],
        [2.1, 2.0, 0.0],
        [4.0, 5.0, 1.0],
        [5.0; 3],
    ];
    let check = |basis: &str, wrap: &str, expected: Option<bool>| {
        let found = measured(&curve(basis, wrap, &bent, "")).remove(0);
        assert_eq!(found.laws.get(law).copied(), expected, "{basis} {wrap}");
        assert_eq!(found.strands.reading_difference_cm.is_some(), expected.is_some());
    };
    for wrap in ["nonperiodic", "periodic", "pinned"] {
        check("catmullRom", wrap, Some(false));
        check("bspline", wrap, None);
        check("linear", wrap, None);
    }
    check("bezier", "nonperiodic", None);
    // On a straight line both are the same, however uneven its points.
    let straight =
        [[0.0; 3], [0.0, 9.0, 0.0], [0.0, 10.0, 0.0], [0.0, 11.0, 0.0], [0.0, 20.0, 0.0]];
    let found = measured(&curve("catmullRom", "nonperiodic", &straight, "")).remove(0);
    assert!(found.laws[law]);
}

#[test]
fn counts_that_make_no_curve_are_told() {
    let check = |basis: &str, wrap: &str, n: usize, counts: &str| {
        let found = measured(&curve(basis, wrap, &up(0.0, n), "")).remove(0);
        assert_eq!((found.strands.no_curve, found.notes.len()), (1, 1), "{basis} {wrap} {n}");
        assert!(found.notes[0].contains(counts), "{}", found.notes[0]);
        assert_eq!((found.strands.undrawn(), found.strands.zero_length), (1, 0));
        assert!(!found.laws["every curve has two points and a length"]);
        assert_eq!(
            found.strands.bounds.is_some(),
            basis == "linear" && n > 0 && wrap != "periodic"
        );
    };
    for n in 0..2 {
        check("linear", "nonperiodic", n, "2 or more");
    }
    check("linear", "periodic", 2, "3 or more");
    for n in [0, 1, 2, 3, 5, 6, 8] {
        check("bezier", "nonperiodic", n, "4, 7, 10");
    }
    check("bezier", "periodic", 4, "3, 6, 9");
    // OpenUSD's table of valid counts, "Cubic Vertex Interpolation: periodic": a closed curve is not of one or two points.
    for n in 0..3 {
        check("bspline", "periodic", n, "3 or more");
        check("catmullRom", "periodic", n, "3 or more");
    }
    for n in 0..4 {
        check("bspline", "nonperiodic", n, "4 or more");
        check("catmullRom", "nonperiodic", n, "4 or more");
    }
}

#[test]
fn a_curve_without_length_is_one_of_length_0() {
    // Of four points at one place each; one of 4 cm beside them.
    let check = |basis: &str, wrap: &str| {
        let twelve = [vec![[2.0, 0.0, 0.0]; 4], vec![[5.0; 3]; 4]].concat();
        let text = curve(basis, wrap, &[twelve, up(0.0, 4)].concat(), "");
        let text = text.replace("[12]", "[4, 4, 4]");
        let found = measured(&text).remove(0);
        let Strands { curves, no_curve, zero_length, length_cm, .. } = found.strands;
        assert_eq!((curves, no_curve, zero_length), (3, 2, 2), "{basis} {wrap}");
        assert!(length_cm[..2] == [0.0, 0.0] && length_cm[2] > 0.9, "{basis}: {length_cm:?}");
        assert_eq!(found.strands.undrawn(), 0);
        assert!(found.notes.is_empty() && !found.laws["every curve has two points and a length"]);
    };
    for wrap in ["nonperiodic", "pinned"] {
        for basis in ["linear", "bezier", "bspline", "catmullRom"] {
            check(basis, wrap);
        }
    }
}

#[test]
fn widths_of_every_interpolation_count_and_primvars_win() {
    let check = |more: &str, expected: Option<[f32; 2]>| {
        let found = measured(&curve("bspline", "nonperiodic", &up(0.0, 4), more)).remove(0);
        let near = |a: [f32; 2], b: [f32; 2]| (0..2).all(|k| (a[k] - b[k]).abs() < 1e-6);
        let same = match (found.strands.width_cm, expected) {
            (Some(a), Some(b)) => near(a, b),
            (a, b) => a == b,
        };
        assert!(same, "{more}: {:?}", found.strands.width_cm);
        assert_eq!(
            found.notes.is_empty(),
            expected.is_some() || more.is_empty(),
            "{:?}",
            found.notes
        );
    };
    let of = |name: &str, values: &str, interpolation: &str| {
        format!("float[] {name} = [{values}] (interpolation = \"{interpolation}\")")
    };
    check("", None);
    check(&of("widths", "0.5", "constant"), Some([0.5; 2]));
    check(&of("widths", "0.5", "uniform"), Some([0.5; 2]));
    // One span: a value at each end.
    check(&of("widths", "0.5, 0.25", "varying"), Some([0.25, 0.5]));
    check(&of("widths", "0.5, 0.25", "faceVarying"), Some([0.25, 0.5]));
    // (0 + 4 * 3 + 3) / 6 at the ends, (0 + 23 * 3 + 23 * 3 + 0) / 48 in the middle.
    check(&of("widths", "0, 3, 3, 0", "vertex"), Some([2.5, 2.875]));
    check("float[] widths = [0, 3, 3, 0]", Some([2.5, 2.875]));
    check(&of("widths", "1, 2, 3", "varying"), None);
    check(&of("widths", "1, 2, 3", "vertex"), None);
    check(&of("widths", "1, nan, 3, 4", "vertex"), None);
    check(&of("primvars:widths", "0.02", "constant"), Some([0.02; 2]));
    let both = of("primvars:widths", "0.02", "constant") + " " + &of("widths", "0.5", "constant");
    check(&both, Some([0.02; 2]));
    let indexed =
        of("primvars:widths", "0.1, 0.3", "varying") + " int[] primvars:widths:indices = [1, 0]";
    check(&indexed, Some([0.1, 0.3]));
}

#[test]
fn one_bad_curve_or_prim_does_not_hide_the_others() {
    let two = |points: &str, counts: &str, more: &str| {
        format!(
            "def BasisCurves \"two\" {{ uniform token type = \"linear\" int[] curveVertexCounts = [{counts}]
             point3f[] points = [{points}] {more} }}"
        )
    };
    let good = curve("linear", "pinned", &up(0.0, 3), "");
    let check = |bad: &str, curves: &[usize], why: &str| {
        let found = measured(&format!("{good}\n{bad}"));
        assert_eq!(found.iter().map(|m| m.strands.curves).collect::<Vec<_>>(), curves, "{bad}");
        let told = &found[0].left_out;
        assert!(told.len() == 1 && told[0].broken && told[0].path == "/two", "{}", told.len());
        assert!(told[0].reason.contains(why), "{}", told[0].reason);
    };
    let widths = "float[] widths = [1, 2, 3, 4] (interpolation = \"vertex\") \
                  int[] primvars:id = [7, 8] (interpolation = \"uniform\")";
    let nan = two("(0, 0, 0), (0, 4, 0), (nan, 0, 0), (1, 4, 0)", "2, 2", widths);
    check(&nan, &[1, 1], "curve 1 was left out: its point 0 is (NaN, 0, 0)");
    // Columns lose the values of the curve too.
    let found = measured(&nan).remove(0);
    assert_eq!(
        (found.strands.width_cm, found.repeated_ids, found.strands.points),
        (Some([1.0, 2.0]), Some(0), 2)
    );
    check(&two("(0, 0, 0), (0, 4, 0)", "3", ""), &[1], "count 3 points, but there are 2");
    check(&two("(0, 0, 0)", "-1, 2", ""), &[1], "curve 0 has -1 points");
    check(&two("(0, 0, 0)", "2147483647, 2147483647", ""), &[1], "4294967294 points");
    check(&two("(0, 0, 0), (0, inf, 0)", "2", ""), &[1], "(0, inf, 0)");
    check(
        &two("(0, 0, 0)", "1", "uniform token wrap = \"segmented\""),
        &[1],
        "wrap: \"segmented\"",
    );
    let moved =
        "double3 xformOp:translate = (nan, 0, 0) token[] xformOpOrder = [\"xformOp:translate\"]";
    check(&two("(0, 0, 0)", "1", moved), &[1], "no finite matrix");
}

#[test]
fn what_is_read_otherwise_than_the_file_says_is_told() {
    let nothing = &mut |_: &str| Err("there is nothing beside it".to_owned());
    // The first line is the layer's own.
    let mut check = |layer: &str, more: &str, said: &str, broken: bool| {
        let hair = curve("linear", "pinned", &up(0.0, 3), more);
        let text = format!("#usda 1.0\n({layer})\n{hair}");
        let stage = read_stage(text.as_bytes(), "file.usda", nothing).unwrap();
        let found = measure(&stage, None, &PlainHost).remove(0);
        assert!(
            (found.strands.length_cm[1] - 2.0).abs() < 1e-5,
            "{more}: {}",
            found.strands.length_cm[1]
        );
        let json = serde_json::to_string(&found).unwrap();
        let words = words::in_words(&found)
            + &found.left_out.iter().map(NotRead::in_words).collect::<String>();
        if said.is_empty() {
            assert_eq!((found.notes.len(), found.left_out.len()), (0, 0), "{more}: {words}");
        }
        for said in said.split('|') {
            assert!(json.contains(said), "{layer} {more}: {said:?} is not in\n{json}");
            assert!(words.contains(said), "{layer} {more}: {said:?} is not in\n{words}");
        }
        assert_eq!(found.left_out.iter().any(|what| what.broken), broken, "{layer} {more}");
    };
    check("", "", "", false);
    check("upAxis = \"Y\"", "", "", false);
    check("upAxis = \"X\"", "", "upAxis|Y was taken", true);
    let widths = |values: &str, how: &str| {
        format!("float[] widths = [{values}] (interpolation = \"{how}\")")
    };
    let negative = "2 of 3 widths are negative, which no curve has: width 1 is -0.5 cm";
    check("", &widths("0.5, -0.5, -1", "vertex"), negative, false);
    check("", &widths("0.5", "perPoint"), "curves have no|perPoint|interpolation", false);
    check(
        "",
        &widths("1e20", "constant"),
        "width 0 is 100000000000000000000, more than 1e15 cm",
        false,
    );
    // Three samples, of which the earliest counts; as many beside a default.
    let (low, high) = ("[(0,0,0), (0,1,0), (0,2,0)]", "[(0,0,0), (0,9,0), (0,99,0)]");
    let points = format!("{{ 2: {high}, 1: {low}, 3: {high} }}");
    let of = |n: usize| format!("time samples|points: up to {n} samples are not read");
    // The default of `curve` stands before, so it counts.
    check("", &format!("point3f[] points.timeSamples = {points}"), &of(3), false);
    let widths = "float[] widths.timeSamples = { 1: [1, 1, 1], 2: [2, 2, 2] }";
    check("", widths, "widths: up to 1 samples are not read", false);
    check("", "float[] widths.timeSamples = { 1: [1, 1, 1] }", "", false);
    let both = "float[] widths.timeSamples = { 1: [1, 1, 1] } float[] widths = [2, 2, 2]";
    check("", both, "widths: up to 1 samples are not read", false);
    let order = "token[] xformOpOrder = [\"xformOp:wobble\"]";
    check("", order, "xformOpOrder|xformOp:wobble: no value that is read", false);
    // A type that is not read.
    let value = format!("matrix2d xformOp:wobble = ((1, 0), (0, 1)) {order}");
    check("", &value, "xformOpOrder|xformOp:wobble: no value that is read", false);
}

#[test]
fn lengths_beyond_all_measure_are_told() {
    let good = curve("linear", "pinned", &up(0.0, 3), "");
    let long = |y: f32| curve("linear", "pinned", &[[0.0; 3], [0.0, y, 0.0]], "");
    // 1e15 and twice that, whose squares are no more than 4e30.
    let found = measured(&curve("linear", "pinned", &[[0.0, -1e15, 0.0], [0.0, 1e15, 0.0]], ""));
    assert!(
        (found[0].strands.length_cm[1] / 2e15 - 1.0).abs() < 1e-5,
        "{}",
        found[0].strands.length_cm[1]
    );
    let found = measured(&format!("{good} {}", long(2e19).replace("\"hair\"", "\"long\"")));
    assert_eq!(found.len(), 1);
    let told = &found[0].left_out[0];
    assert!(told.broken && told.path == "/long", "{}", told.in_words());
    assert!(told.reason.contains("curve 0 was left out") && told.reason.contains("1e15"));
}

#[test]
fn what_renderers_leave_out_is_marked() {
    let hair = curve("linear", "pinned", &up(0.0, 3), "");
    let found = measured(&format!(
        "def Xform \"old\" {{ token visibility = \"invisible\" {hair} }}
         def Xform \"guides\" {{ uniform token purpose = \"guide\" {hair} }}
         def Xform \"now\" {{ token visibility = \"inherited\" {hair} }}"
    ));
    let marks: Vec<_> = found.iter().map(|m| (m.visible, m.purpose.as_str())).collect();
    assert_eq!(marks, [(false, "default"), (true, "guide"), (true, "default")]);
}

#[test]
fn what_is_left_out_is_said_with_every_prim() {
    let hair = curve("linear", "pinned", &up(0.0, 3), "");
    let found = measured(&format!("{hair} def \"b\" (references = @x.usda@</y>) {{ }}"));
    let what = &found[0].left_out[0];
    assert_eq!(what.in_words(), "/b: reference @x.usda@</y>: there is nothing beside it");
    assert!(!what.broken);
    let json = serde_json::to_value(&found).unwrap();
    assert_eq!(json[0]["left_out"][0]["asset"], "@x.usda@</y>");
}

#[test]
fn hair_that_dives_between_its_points_is_found() {
    let scalp = read_scalp(&PathBuf::from(BUILT_IN), "").unwrap().0;
    let about = scalp.frame().origin;
    let at = |x: f32| [about.x + x, about.y, about.z];
    // From one side of the head to the other, straight through it: its middle is deep, its ends are not.
    let text = curve("linear", "pinned", &[at(-30.0), at(30.0)], "");
    let found = measured_on(&text, Some(&scalp)).remove(0).scalp.unwrap().depth;
    assert_eq!(found.too_deep, 1);
    assert!(found.deepest_cm > 3.0, "{}", found.deepest_cm);
}

#[test]
fn an_id_that_curves_of_two_prims_have_breaks_the_law_of_both() {
    let prim = |name: &str, ids: &str| {
        format!(
            "def BasisCurves \"{name}\" {{ point3f[] points = [(0,0,0),(0,1,0),(1,0,0),(1,1,0)]\n int[] curveVertexCounts = \
             [2, 2]\n {ids} }}\n"
        )
    };
    let ids = |ids: &str| format!("int[] primvars:id = [{ids}] (interpolation = \"uniform\")");
    let text = format!(
        "{}{}{}",
        prim("a", &ids("7, 8")),
        prim("b", &ids("9, 8")),
        prim("c", "") + &prim("d", &ids("1, 2"))
    );
    let found = measured(&text);
    // 8 is the second curve of both a and b; c has no ids, and nothing is wrong with d.
    let shared: Vec<_> = found.iter().map(|m| m.ids_elsewhere).collect();
    assert_eq!(shared, [Some(1), Some(1), None, Some(0)]);
    let law: Vec<_> = found.iter().map(|m| m.laws.get("ids do not repeat").copied()).collect();
    assert_eq!(law, [Some(false), Some(false), None, Some(true)]);
}

#[test]
fn limits_of_points_are_laws() {
    let found = measured(&curve("catmullRom", "pinned", &up(0.0, 300), "")).remove(0);
    assert!(!found.laws["a strand has at most 255 points"]);
    assert!(found.laws["all hair has at most 16 million points"]);
}

#[test]
fn the_built_in_head_can_be_named() {
    let scalp = read_scalp(&PathBuf::from(BUILT_IN), "").unwrap().0;
    let root = scalp.closest_root(glam::Vec3::Y * 20.0).unwrap();
    let above = |height: f32| (root.point + root.normal * height).to_array();
    let on = |from: f32, to: f32, more: &str| {
        let text = curve("catmullRom", "pinned", &[above(from), above(to)], more);
        measured_on(&text, Some(&scalp)).remove(0)
    };
    assert!(on(0.0, 1.0, "").laws[ROOTED] && on(0.0, 1.0, "").laws[DEEPER]);
    let under = on(0.0, -1.0, "");
    assert!(under.laws[ROOTED] && !under.laws[DEEPER]);
    assert_eq!(under.scalp.unwrap().depth.too_deep, 1);
    // A band grows from its braid; hair that tells its place on the skin is judged by it.
    let law = |tells: &[&str]| {
        let tells = tells.iter().map(|name| format!("int[] primvars:{name} = [7]"));
        on(1.0, 2.0, &tells.collect::<Vec<_>>().join(" ")).laws.get(ROOTED).copied()
    };
    assert_eq!(law(&["clumpId"]), None);
    assert_eq!(law(&["clumpId", "skinprim"]), Some(false));
    assert_eq!(law(&[]), Some(false));
}
