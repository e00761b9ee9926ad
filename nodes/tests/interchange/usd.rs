//! USD without USD: what is written reads back equal, bytes are stable, hostile bytes are refused.

use super::common::{
    self, Tufts, both_forms, one_set, read_curves, sample, sample_stage, two_points, values_of,
};
use coif_nodes::formats::usd::form::Form;
use coif_nodes::formats::usd::groom::{
    CurveSet, GroomStage, Interpolation, Primvar, PrimvarValues, Widths, write_usda, write_usdc,
};
use coif_nodes::formats::usd::read::{ReadCurves, ReadValues, ReadWidths};
use coif_nodes::formats::usd::spec::{AttributeSpec, PrimSpec, PropertySpec, UsdLayer, UsdValue};
use coif_nodes::formats::usd::{usda, usdc};
use glam::{Vec2, Vec3};
use std::io::{Cursor, Seek, Write};

#[track_caller]
fn check_set(written: &CurveSet, read: &ReadCurves, path: &str, purpose: &str) {
    assert_eq!((read.path.as_str(), read.purpose.as_str()), (path, purpose));
    assert_eq!((read.form, read.is_visible), (Form::COIF, true));
    assert!(written.counts.values().map(|&count| count as u32).eq(read.counts.iter().copied()));
    assert!(written.points.values().eq(&read.points), "points");
    let (interpolation, values) = match &written.widths {
        Widths::Constant(width) => ("constant", vec![*width]),
        Widths::Vertex(widths) => ("vertex", widths.values().copied().collect()),
    };
    let interpolation = interpolation.to_owned();
    assert_eq!(read.widths, Some(ReadWidths { interpolation, values }));
    assert_eq!(read.primvars.len(), written.primvars.len());
    for (written, read) in written.primvars.iter().zip(&read.primvars) {
        assert_eq!(read.name, written.name.replace(' ', "_"));
        assert_eq!(read.interpolation, written.interpolation.name(), "{}", read.name);
        assert_eq!(read.values, values_of(&written.values), "{}", read.name);
    }
    assert_eq!(read.notes, [""; 0]);
}

#[test]
fn what_is_written_reads_back_equal_in_both_forms() {
    let (strands, guides) = sample();
    let stage = sample_stage(&strands, &guides);
    for (extension, bytes) in both_forms(&stage) {
        let read = read_curves(&bytes, extension).unwrap();
        assert_eq!(read.len(), 3, "{extension}");
        check_set(&stage.groups[0], &read[0], "/Head_groom_1/Strands/scalp", "default");
        check_set(&stage.groups[2], &read[1], "/Head_groom_1/Strands/scalp_1", "default");
        check_set(&stage.groups[1], &read[2], "/Head_groom_1/Guides/scalp", "guide");
    }
}

#[test]
fn bytes_are_those_of_the_last_release() {
    let (strands, guides) = sample();
    let stage = sample_stage(&strands, &guides);
    let hashes = both_forms(&stage).map(|(_, bytes)| blake3::hash(&bytes).to_hex().to_string());
    expect_test::expect![[r#"
        [
            "86aba3b1f1283c3a89413ee3e52f9ca0a8359709bb977fef56820c7162691ba6",
            "d94f5bd9cc042ffd5e8322ec00893c8833dafabc92507c78a23da2e8b1cd3101",
        ]
    "#]]
    .assert_debug_eq(&hashes);
}

#[test]
fn equal_arrays_are_in_a_crate_file_once() {
    let (strands, guides) = sample();
    let size = |stage: &GroomStage| {
        let mut crate_file = Cursor::new(vec![]);
        write_usdc(stage, &mut crate_file).unwrap();
        crate_file.into_inner().len()
    };
    // Arrays that no layout shares by itself: as they lie in memory, packed integers, floats of a table, and one uv a curve.
    let stage = sample_stage(&strands, &guides);
    for at in [0, 1, 2, 4, 5, 6] {
        let mut twice = sample_stage(&strands, &guides);
        let mut again = sample_stage(&strands, &guides).groups.remove(0).primvars.remove(at);
        again.name += "_again";
        let name = again.name.clone();
        twice.groups[0].primvars.push(again);
        let more = size(&twice) - size(&stage);
        assert!(more < 160, "{name}: {more} bytes");
    }
    // An array of another type is another, whatever its bits.
    let zeros = |values| {
        let primvar = |name: &str, values| {
            let interpolation = Interpolation::Uniform;
            Primvar { name: name.into(), interpolation, values }
        };
        let ints = PrimvarValues::Int(vec![0; 40].into());
        CurveSet {
            counts: vec![2; 40].into(),
            points: vec![Vec3::ONE; 80].into(),
            primvars: vec![primvar("ints", ints), primvar("others", values)],
            ..two_points()
        }
    };
    let mut crate_file = Cursor::new(vec![]);
    write_usdc(&one_set(zeros(PrimvarValues::Float(vec![0.0; 40].into()))), &mut crate_file)
        .unwrap();
    let read = read_curves(crate_file.get_ref(), "usdc").unwrap();
    assert_eq!(read[0].primvars[1].values, ReadValues::Float(vec![0.0; 40]));
}

#[test]
fn how_values_are_cut_into_chunks_does_not_show() {
    let (strands, guides) = sample();
    let cut = both_forms(&sample_stage(&strands, &guides));
    let whole = Tufts {
        counts: vec![strands.counts.concat()],
        points: vec![strands.points.concat()],
        widths: vec![strands.widths.concat()],
        uvs: vec![strands.uvs.concat()],
        ids: vec![strands.ids.concat()],
    };
    assert!(both_forms(&sample_stage(&whole, &guides)) == cut);
}

#[test]
fn a_small_stage_as_text() {
    let mut text = Vec::new();
    write_usda(&one_set(two_points()), &mut text).unwrap();
    expect_test::expect![[r##"
        #usda 1.0
        (
            customLayerData = {
                string generator = ""
                string graph = ""
                uint64 seed = 0
            }
            defaultPrim = "Groom"
            doc = ""
            metersPerUnit = 0.01
            upAxis = "Y"
        )

        def Xform "Groom" (
            kind = "component"
        )
        {
            def Scope "Strands"
            {
                def BasisCurves "hair" (
                    prepend apiSchemas = ["MaterialBindingAPI"]
                )
                {
                    uniform token type = "cubic"
                    uniform token basis = "catmullRom"
                    uniform token wrap = "pinned"
                    int[] curveVertexCounts = [2]
                    point3f[] points = [(1, 2, 3), (4, 6, 8)]
                    float[] widths = [0.5] (
                        interpolation = "constant"
                    )
                    float3[] extent = [(0.75, 1.75, 2.75), (4.25, 6.25, 8.25)]
                    rel material:binding = </Groom/Looks/hair>
                }
            }

            def Scope "Looks"
            {
                def Material "hair"
                {
                    token outputs:surface.connect = </Groom/Looks/hair/Surface.outputs:surface>

                    def Shader "Surface"
                    {
                        uniform token info:id = "UsdPreviewSurface"
                        color3f inputs:diffuseColor = (0, 0, 0)
                        float inputs:roughness = 0.4
                        token outputs:surface
                    }
                }
            }
        }
    "##]]
    .assert_eq(str::from_utf8(&text).unwrap());
}

#[test]
fn a_crate_file_may_follow_other_bytes() {
    let (mut alone, mut behind) = (Cursor::new(Vec::new()), Cursor::new(Vec::new()));
    write_usdc(&one_set(two_points()), &mut alone).unwrap();
    behind.write_all(b"abc").unwrap();
    write_usdc(&one_set(two_points()), &mut behind).unwrap();
    assert_eq!(behind.get_ref()[3..], alone.get_ref()[..]);
    assert_eq!(behind.stream_position().unwrap(), behind.get_ref().len() as u64);
}

#[test]
fn time_samples_and_the_other_value_types_are_written_in_both_forms() {
    let attribute = |name: &str, type_name, value| {
        let name = name.into();
        let default = Some(value);
        PropertySpec::Attribute(AttributeSpec {
            name,
            type_name,
            default,
            ..AttributeSpec::default()
        })
    };
    let at = |x: f32| UsdValue::Vec3fs(vec![Vec3::splat(x), Vec3::ONE].into());
    let layer = UsdLayer {
        prims: vec![PrimSpec {
            name: "Curves".into(),
            type_name: "BasisCurves",
            properties: vec![
                attribute("curveVertexCounts", "int[]", UsdValue::Ints(vec![2].into())),
                PropertySpec::Attribute(AttributeSpec {
                    name: "points".into(),
                    type_name: "point3f[]",
                    samples: vec![(1.0, at(1.5)), (2.5, at(-2.0))],
                    ..AttributeSpec::default()
                }),
                attribute("primvars:bool", "bool", UsdValue::Bool(true)),
                attribute("primvars:double", "double", UsdValue::Double(0.1)),
                attribute("primvars:float2", "float2", UsdValue::Vec2f(Vec2::new(0.5, -1.0))),
                attribute("primvars:asset", "asset", UsdValue::Asset("a@b.png".into())),
                attribute("primvars:int", "int", UsdValue::Int(i32::MIN)),
                attribute("primvars:int64", "int64", UsdValue::Int64(i64::MIN)),
                attribute("primvars:short64", "int64", UsdValue::Int64(-5)),
                attribute("primvars:tokens", "token[]", UsdValue::Tokens(vec!["a".into()])),
                attribute("primvars:inf", "float", UsdValue::Float(f32::NEG_INFINITY)),
                attribute("primvars:tiny", "float", UsdValue::Float(f32::from_bits(1))),
            ],
            ..PrimSpec::default()
        }],
        ..UsdLayer::default()
    };
    let (mut text, mut crate_file) = (Vec::new(), Cursor::new(Vec::new()));
    usda::write(&layer, &mut text).unwrap();
    usdc::write(&layer, &mut crate_file).unwrap();
    let from_text = read_curves(&text, "usda").unwrap();
    let from_crate = read_curves(crate_file.get_ref(), "USDC").unwrap();
    assert_eq!(from_text, from_crate);
    assert_eq!(from_text[0].points, [Vec3::splat(1.5), Vec3::ONE]);
    let values: Vec<_> = from_text[0].primvars.iter().map(|primvar| &primvar.values).collect();
    let expected = [
        ReadValues::Int(vec![1]),
        ReadValues::Float(vec![0.1]),
        ReadValues::Float2(vec![Vec2::new(0.5, -1.0)]),
        ReadValues::Text(vec!["a@b.png".into()]),
        ReadValues::Int(vec![i32::MIN]),
        ReadValues::Int64(vec![i64::MIN]),
        ReadValues::Int64(vec![-5]),
        ReadValues::Text(vec!["a".into()]),
        ReadValues::Float(vec![f32::NEG_INFINITY]),
        ReadValues::Float(vec![f32::from_bits(1)]),
    ];
    assert!(values.into_iter().eq(&expected), "{:#?}", from_text[0].primvars);
}

/// Both writers refuse the stage with this text.
#[track_caller]
fn check_refused(set: CurveSet, expected: &str) {
    let stage = one_set(set);
    let text = write_usda(&stage, &mut Vec::new()).map_err(|error| error.to_string());
    let crate_file = write_usdc(&stage, &mut Cursor::new(Vec::new()));
    assert_eq!(text, Err(expected.to_owned()));
    assert_eq!(crate_file.map_err(|error| error.to_string()), text);
}

#[test]
fn a_stage_that_contradicts_itself_is_refused_with_its_place() {
    check_refused(
        CurveSet { counts: vec![1, 1].into(), ..two_points() },
        "hair, curve 0: 1 points: a pinned cubic curve needs at least 2",
    );
    check_refused(
        CurveSet { counts: vec![2, 3].into(), ..two_points() },
        "hair: the curves count 5 points, but there are 2",
    );
    check_refused(
        CurveSet { points: vec![Vec3::ZERO, Vec3::NAN].into(), ..two_points() },
        "hair, point 1: the position is no finite number",
    );
    check_refused(
        CurveSet { widths: Widths::Vertex(vec![1.0].into()), ..two_points() },
        "hair, widths: 1 values for 2 points",
    );
    check_refused(
        CurveSet { widths: Widths::Constant(-1.0), ..two_points() },
        "hair, width 0: -1 is no diameter: it must be finite and not negative",
    );
    let primvar = Primvar {
        name: "id".into(),
        interpolation: Interpolation::Uniform,
        values: PrimvarValues::Int(vec![1, 2].into()),
    };
    check_refused(
        CurveSet { primvars: vec![primvar], ..two_points() },
        "hair, primvar id: 2 values where uniform interpolation asks for 1",
    );
    let texts = PrimvarValues::Text(vec!["a\0b".into()]);
    let primvar =
        Primvar { name: "t".into(), interpolation: Interpolation::Constant, values: texts };
    check_refused(
        CurveSet { primvars: vec![primvar], ..two_points() },
        "text \"a\\0b\": a NUL character at byte 1 cannot be written to USD",
    );
}

#[test]
fn a_failing_disk_is_an_error() {
    /// Fails after a number of bytes.
    struct Full(usize);
    impl Write for Full {
        fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
            self.0 = self.0.checked_sub(bytes.len()).ok_or(std::io::ErrorKind::StorageFull)?;
            Ok(bytes.len())
        }
        fn flush(&mut self) -> std::io::Result<()> {
            Ok(())
        }
    }
    let error = write_usda(&one_set(two_points()), &mut Full(100)).unwrap_err();
    assert_eq!(error.place, "output");
}

#[test]
fn names_become_valid_and_unique() {
    let primvar = |name: &str| Primvar {
        name: name.into(),
        interpolation: Interpolation::Constant,
        values: PrimvarValues::Int(vec![1].into()),
    };
    let names = ["a b", "a_b", "groom:1 id", "st:indices", "", "ß"];
    let set = CurveSet { primvars: names.map(primvar).into(), ..two_points() };
    let sets = ["1 top", "", "1/top"].map(|name| CurveSet { name: name.into(), ..set.clone() });
    let stage = GroomStage { name: "haar-é".into(), groups: sets.into(), ..one_set(two_points()) };
    for (extension, bytes) in both_forms(&stage) {
        let read = read_curves(&bytes, extension).unwrap();
        let paths: Vec<_> = read.iter().map(|curves| curves.path.as_str()).collect();
        assert_eq!(
            paths,
            ["/haar__/Strands/_1_top", "/haar__/Strands/_", "/haar__/Strands/_1_top_1"]
        );
        let primvars: Vec<_> = read[0].primvars.iter().map(|p| p.name.as_str()).collect();
        assert_eq!(primvars, ["a_b", "a_b_1", "groom:_1_id", "st:indices:_", "_", "__1"]);
    }
}

// ---- reading what others write -----------------------------------------------------------------

const TWO_POINTS: &str =
    "int[] curveVertexCounts = [2]\npoint3f[] points = [(1, 2, 3), (4, 6, 8)]\n";

fn read_text(text: &str) -> Result<Vec<ReadCurves>, String> {
    read_curves(format!("#usda 1.0\n{text}").as_bytes(), "usda")
}

/// The first curve's points and widths after all transforms.
#[track_caller]
fn check_world(text: &str, points: [[f32; 3]; 2], width: f32) {
    let read = read_text(text).unwrap();
    let found = read[0].points.iter().map(|point| point.to_array());
    for (found, expected) in found.zip(points) {
        for (found, expected) in found.into_iter().zip(expected) {
            assert!((found - expected).abs() < 1e-4, "{:?} is not {points:?}", read[0].points);
        }
    }
    let found = read[0].widths.as_ref().unwrap().values[0];
    assert!((found - width).abs() < 1e-5, "width {found} is not {width}");
}

#[test]
fn points_and_widths_come_in_centimetres_with_y_up() {
    let curves = format!("{TWO_POINTS}float[] widths = [0.5]\n");
    let prim = format!("def BasisCurves \"a\" {{ {curves} }}");
    check_world(&prim, [[1.0, 2.0, 3.0], [4.0, 6.0, 8.0]], 0.5);
    check_world(
        &format!("(metersPerUnit = 1\nupAxis = \"Z\")\n{prim}"),
        [[100.0, 300.0, -200.0], [400.0, 800.0, -600.0]],
        50.0,
    );
    check_world(
        &format!(
            "def Xform \"top\" {{ double3 xformOp:translate = (10, 0, 0)
             float3 xformOp:scale:big = (2, 2, 2) double xformOp:rotateZ = 90
             uniform token[] xformOpOrder = [\"xformOp:translate\", \"xformOp:rotateZ\",
             \"xformOp:scale:big\"]
             {prim} }}"
        ),
        [[6.0, 2.0, 6.0], [-2.0, 8.0, 16.0]],
        1.0,
    );
    check_world(
        &format!(
            "def Xform \"top\" {{ double3 xformOp:translate = (10, 0, 0)
             uniform token[] xformOpOrder = [\"xformOp:translate\"]
             def BasisCurves \"a\" {{ {curves}
             quatf xformOp:orient = (0, 1, 0, 0)
             uniform token[] xformOpOrder = [\"!resetXformStack!\", \"!invert!xformOp:orient\"] }} }}"
        ),
        [[1.0, -2.0, -3.0], [4.0, -6.0, -8.0]],
        0.5,
    );
}

#[test]
fn a_strange_transform_only_matters_above_curves() {
    let strange = "double3 xformOp:wobble = (1, 1, 1) token[] xformOpOrder = [\"xformOp:wobble\"]";
    let curves = format!("def BasisCurves \"b\" {{ {TWO_POINTS} }}");
    assert_eq!(read_text(&format!("def Camera \"a\" {{ {strange} }} {curves}")).unwrap().len(), 1);
    check_unreadable(
        &format!("def Xform \"a\" {{ {strange} {curves} }}"),
        "/a/b.the transform of /a: xformOp:wobble is no transform that is known",
    );
}

#[test]
fn purpose_is_inherited_and_only_live_prims_are_read() {
    let prim = |name: &str, more: &str| {
        format!("def BasisCurves \"{name}\" ({more}) {{ {TWO_POINTS} }}\n")
    };
    let text = format!(
        "def Scope \"guides\" {{ uniform token purpose = \"guide\" {} }}
         over \"o\" {{ {} }} class \"c\" {{ {} }} {} {}",
        prim("a", ""),
        prim("b", ""),
        prim("c", ""),
        prim("d", "active = false"),
        prim("e", "kind = \"prop\"; customData = { int a = 1 }"),
    );
    let read = read_text(&text).unwrap();
    let found: Vec<_> = read.iter().map(|c| (c.path.as_str(), c.purpose.as_str())).collect();
    assert_eq!(found, [("/guides/a", "guide"), ("/e", "default")]);
}

#[test]
fn indexed_primvars_are_resolved_and_misfits_are_noted() {
    let text = format!(
        "def BasisCurves \"a\" {{ {TWO_POINTS} uniform token type = \"linear\"
         float[] widths = [1, 2, 3, 4, 5] (interpolation = \"vertex\")
         color3f[] primvars:displayColor = [(1, 0, 0), (0, 1, 0)] (interpolation = \"vertex\")
         int[] primvars:displayColor:indices = [1, 0]
         float[] primvars:bad = [1] (interpolation = \"vertex\")
         int[] primvars:bad:indices = [0, 9]
         float[] primvars:long = [1, 2, 3] (interpolation = \"uniform\")
         matrix4d primvars:m = ((1,0,0,0),(0,1,0,0),(0,0,1,0),(0,0,0,1))
         float primvars:blocked = None }}"
    );
    let read = read_text(&text).unwrap().remove(0);
    let names: Vec<_> = read.primvars.iter().map(|primvar| primvar.name.as_str()).collect();
    assert_eq!(names, ["displayColor"]);
    assert_eq!(read.primvars[0].values, ReadValues::Float3(vec![Vec3::Y, Vec3::X]));
    assert_eq!(
        read.notes,
        [
            "widths were left out: 5 values where vertex asks for 2",
            "primvar bad was left out: an index is outside its values",
            "primvar long was left out: 3 values where uniform asks for 1",
            "primvar m was left out: matrix4d values are not read",
        ]
    );
}

/// Text after the first line is refused so.
#[track_caller]
fn check_unreadable(text: &str, expected: &str) {
    assert_eq!(read_text(text), Err(expected.to_owned()));
}

#[test]
fn damaged_text_is_refused_with_its_line() {
    check_unreadable("\n\ndef Xform \"a\" {", "line 4: the file ends inside a prim");
    check_unreadable("def Xform \"a {", "line 2: a text has no closing quote");
    check_unreadable("}", "line 2: a } that closes nothing");
    check_unreadable("int a = 5", "line 2: expected def, over or class");
    let curves = |body: &str| format!("def BasisCurves \"a\" {{\n{body}\n}}");
    check_unreadable(
        &curves("int[] curveVertexCounts = [1.5]"),
        "line 3: \"1.5\" is no number that fits its type",
    );
    check_unreadable(&curves("point3f[] points = [(1, 2)]"), "line 3: expected ',', found ')'");
    check_unreadable(
        &curves("int[] curveVertexCounts = [3] point3f[] points = [(1, 2, 3)]"),
        "/a.curveVertexCounts: the curves count 3 points, but there are 1",
    );
    check_unreadable(
        &curves("int[] curveVertexCounts = [1] point3f[] points = [(1, nan, 3)]"),
        "/a.points: curve 0 was left out: its point 0 is (1, NaN, 3), no finite position",
    );
    check_unreadable("(metersPerUnit = 0)", "metersPerUnit: 0 is no length");
}

#[test]
fn files_that_are_no_usd_are_refused() {
    #[track_caller]
    fn check(bytes: &[u8], extension: &str, expected: &str) {
        assert_eq!(read_curves(bytes, extension).unwrap_err(), expected);
    }
    check(b"", "usda", "byte 0: neither #usda nor a crate file begins here");
    check(b"#usda 1.0\n", "obj", "file name: .obj is no USD file");
    check(b"PXR-USDC", "usdc", "byte 8: 8 bytes are expected here, but the file ends");
    check(b"#usda 1.0\n\xFF", "usda", "byte 10: the text is no UTF-8");
    check(b"PK\x03\x04", "usdz", "byte 0, first file of the package: the file ends inside it");
}

#[test]
fn a_package_is_read_through_its_first_file() {
    let (strands, guides) = sample();
    for (extension, layer) in both_forms(&sample_stage(&strands, &guides)) {
        let name = format!("a.{extension}");
        let mut package = b"PK\x03\x04".to_vec();
        package.extend([0; 14]);
        package.extend((layer.len() as u32).to_le_bytes());
        package.extend((layer.len() as u32).to_le_bytes());
        package.extend((name.len() as u16).to_le_bytes());
        package.extend([0; 2]);
        package.extend(name.as_bytes());
        package.extend(&layer);
        assert_eq!(read_curves(&package, "usdz"), read_curves(&layer, extension));
    }
}

#[test]
fn deep_nesting_and_long_chains_end() {
    let deep = "def \"a\" {".repeat(100_000);
    assert!(read_text(&deep).is_err());
    let brackets = format!("def \"a\" {{ int x = {}", "[".repeat(100_000));
    assert!(read_text(&brackets).is_err());
    let operations = "\"xformOp:transform\",".repeat(100);
    check_unreadable(
        &format!(
            "def \"a\" {{ token[] xformOpOrder = [{operations}]
             def BasisCurves \"b\" {{ }} }}"
        ),
        "/a/b.the transform of /a: 100 transform operations, more than 64",
    );
}

// ---- hostile bytes -----------------------------------------------------------------------------

#[test]
fn mutated_files_are_read_or_refused() {
    let (strands, guides) = sample();
    let mut outcomes = [0; 2];
    for (extension, bytes) in both_forms(&sample_stage(&strands, &guides)) {
        for seed in 0..400 {
            let read = read_curves(&common::mutated(&bytes, seed), extension);
            outcomes[read.is_ok() as usize] += 1;
        }
    }
    // Flipped digits are still numbers; the rest has to be noticed.
    assert!(outcomes.iter().all(|&count| count > 50), "{outcomes:?}");
}

#[test]
fn hostile_files_are_read_or_refused() {
    let Some(folder) = common::shared("data/bad/made_here", "hostile_files_are_read_or_refused")
    else {
        return;
    };
    for file in common::files(&folder, &["usda", "usdc", "usdz"]) {
        let read = read_curves(&std::fs::read(&file).unwrap(), common::extension(&file));
        let expected = match common::file_name(&file) {
            "basiscurves_inconsistent.usda" => Err(
                "/CountsDoNotSum.curveVertexCounts: the curves count 12 points, but there are 2",
            ),
            "usdz_zip_slip.usdz" => Ok(0),
            _ => continue,
        };
        let read = read.map(|curves| curves.len());
        assert_eq!(read, expected.map_err(str::to_owned), "{}", file.display());
    }
}

#[test]
fn curves_of_other_programs_are_read() {
    let Some(folder) = common::shared("data/usd_curves", "curves_of_other_programs_are_read")
    else {
        return;
    };
    let mut found = String::new();
    for file in common::files(&folder, &["usda"]) {
        let read = read_curves(&std::fs::read(&file).unwrap(), "usda").unwrap();
        let curves: usize = read.iter().map(|curves| curves.counts.len()).sum();
        let points: usize = read.iter().map(|curves| curves.points.len()).sum();
        let notes: usize = read.iter().map(|curves| curves.notes.len()).sum();
        let name = common::file_name(&file);
        let prims = read.len();
        found +=
            &format!("{name}: {prims} prims, {curves} curves, {points} points, {notes} notes\n");
    }
    expect_test::expect![[r#"
        hair-blender-3.0.1.usda: 1 prims, 1000 curves, 9000 points, 0 notes
        openusd_BasisCurves3.usda: 1 prims, 4051 curves, 28357 points, 0 notes
        openusd_basicCurves.usda: 7 prims, 7 curves, 30 points, 1 notes
        openusd_basisCurves.usda: 1 prims, 2 curves, 10 points, 1 notes
        openusd_moreCurves.usda: 57 prims, 57 curves, 291 points, 0 notes
        openusd_pinnedCurves.usda: 1 prims, 4 curves, 11 points, 1 notes
    "#]]
    .assert_eq(&found);
}
