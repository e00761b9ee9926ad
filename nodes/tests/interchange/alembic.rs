//! Alembic without Alembic: what is written reads back equal, lies where readers look for it, and hostile bytes are refused.

use super::common::{self, Tufts, one_set, sample, sample_stage, two_points, values_of};
use coif_nodes::data::attributes as a;
use coif_nodes::data::curves::{Curves, TuftBuilder};
use coif_nodes::data::scalp::{HeadFrame, REGION, Scalp};
use coif_nodes::formats::abc::read::{AbcObject, AbcProperty, AbcPropertyKind, Archive, entry};
use coif_nodes::formats::abc::{self, write};
use coif_nodes::formats::export::{self, About, Format, HairGroup};
use coif_nodes::formats::usd::form::Form;
use coif_nodes::formats::usd::groom::{
    CurveSet, GroomStage, Interpolation, Primvar, PrimvarValues, Widths,
};
use coif_nodes::formats::usd::read::{ReadCurves, ReadValues};
use coif_nodes::maths::closest::Surface;
use glam::{Vec2, Vec3};
use std::collections::BTreeMap;
use std::io::Cursor;
use std::sync::Arc;

/// The curves, and what is wrong with others as text.
fn read_curves(bytes: &[u8]) -> Result<Vec<ReadCurves>, String> {
    let stage = abc::read_curves(bytes).map_err(|err| err.to_string())?.stage;
    match &stage.left_out[..] {
        [] => Ok(stage.curves),
        [first, ..] => Err(format!("{}: {}", first.path, first.reason)),
    }
}

fn bytes_of(stage: &GroomStage) -> Vec<u8> {
    let mut file = Cursor::new(vec![]);
    write(stage, &[], &mut file).unwrap();
    file.into_inner()
}

/// Curves with each kind of attribute that a groom has; ids that fold to one number.
fn groups() -> Vec<HairGroup> {
    let group = |name: &str, guides: bool, parting: u64| {
        let mut b = TuftBuilder::even((0..12).map(|k| Vec3::Y * k as f32).collect(), 4);
        b.set(a::ID, a::Domain::Curve, vec![5, 5 | 1 << 31, 6]);
        b.set(a::ROOT_UV, a::Domain::Curve, vec![Vec2::X, Vec2::Y, Vec2::splat(0.25)]);
        b.set(a::COLOUR, a::Domain::Curve, vec![Vec3::X, Vec3::Y, Vec3::Z]);
        b.set(a::PARTING, a::Domain::Curve, vec![parting]);
        let curves = Curves::new(vec![Arc::new(b.build())]);
        HairGroup { name: name.into(), guides, curves }
    };
    vec![
        group("hair", false, 0),
        group("brows", false, 0),
        group("brows", true, 0),
        group("ties", true, 0),
        group("partings", true, 9),
    ]
}

fn exported(format: Format, groups: &[HairGroup]) -> Vec<u8> {
    let about = About {
        title: "Head".into(),
        generator: "coif tests".into(),
        graph_hash: "00ff".into(),
        seed: 7,
        sections: Default::default(),
    };
    let mut file = Cursor::new(vec![]);
    export::write(format, groups, &[], &about, &mut file, &|| false).unwrap();
    file.into_inner()
}

#[track_caller]
fn check_set(written: &CurveSet, read: &ReadCurves, path: &str) {
    assert_eq!((read.path.as_str(), read.purpose.as_str()), (path, "default"));
    assert_eq!(read.form, Form::COIF);
    assert!(written.counts.values().map(|&count| count as u32).eq(read.counts.iter().copied()));
    let bits = |points: &mut dyn Iterator<Item = &Vec3>| -> Vec<[u32; 3]> {
        points.map(|p| p.to_array().map(f32::to_bits)).collect()
    };
    assert_eq!(bits(&mut written.points.values()), bits(&mut read.points.iter()), "points");
    // One width a point, for Blender passes over a single one.
    let widths = match &written.widths {
        Widths::Constant(width) => vec![*width; read.points.len()],
        Widths::Vertex(widths) => widths.values().copied().collect(),
    };
    let found = read.widths.as_ref().unwrap();
    assert_eq!((found.interpolation.as_str(), &found.values), ("vertex", &widths));
    for (written, read) in written.primvars.iter().zip(&read.primvars) {
        assert_eq!(read.name, written.name);
        assert_eq!(read.interpolation, written.interpolation.name(), "{}", read.name);
        assert_eq!(read.values, values_of(&written.values), "{}", read.name);
    }
    assert_eq!(read.notes, [""; 0]);
}

#[test]
fn what_is_written_reads_back_equal() {
    let (strands, guides) = sample();
    let stage = sample_stage(&strands, &guides);
    let read = read_curves(&bytes_of(&stage)).unwrap();
    // The third set has no points and is no curves to a reader.
    assert_eq!(read.len(), 2);
    check_set(&stage.groups[0], &read[0], "/Head groom 1/scalp/scalpShape");
    check_set(&stage.groups[1], &read[1], "/Head groom 1/scalp_guides/scalp_guidesShape");
    // Colours of curves once more, one a point.
    let set = &stage.groups[0];
    assert_eq!(read[0].primvars.len(), set.primvars.len() + 1);
    let PrimvarValues::Color(colours) = &set.primvars[3].values else { panic!() };
    let spread: Vec<Vec3> = colours
        .values()
        .zip(set.counts.values())
        .flat_map(|(colour, count)| vec![*colour; *count as usize])
        .collect();
    let last = read[0].primvars.last().unwrap();
    assert_eq!((last.name.as_str(), last.interpolation.as_str()), ("groom_color", "vertex"));
    assert_eq!(last.values, ReadValues::Float3(spread));
}

#[test]
fn bytes_are_those_of_the_last_release_however_values_are_cut_into_chunks() {
    let (strands, guides) = sample();
    let cut = bytes_of(&sample_stage(&strands, &guides));
    let whole = Tufts {
        counts: vec![strands.counts.concat()],
        points: vec![strands.points.concat()],
        widths: vec![strands.widths.concat()],
        uvs: vec![strands.uvs.concat()],
        ids: vec![strands.ids.concat()],
    };
    assert!(bytes_of(&sample_stage(&whole, &guides)) == cut);
    expect_test::expect!["a03381c9d93d6f40aa785184057a304da289bb0490a771fb1a7e9c50051cefcf"]
        .assert_eq(&blake3::hash(&cut).to_hex());
}

#[test]
fn an_archive_may_follow_other_bytes() {
    let alone = bytes_of(&one_set(two_points()));
    let mut behind = Cursor::new(vec![1, 2, 3]);
    behind.set_position(3);
    write(&one_set(two_points()), &[], &mut behind).unwrap();
    assert_eq!(behind.position(), 3 + alone.len() as u64);
    assert_eq!(behind.into_inner()[3..], alone);
}

/// Every object and property as a line: what other readers meet.
fn listing(bytes: &[u8]) -> String {
    fn properties(archive: &Archive, all: Vec<AbcProperty>, indent: usize, text: &mut String) {
        for property in all {
            let of = |key| entry(property.metadata, key).unwrap_or("");
            let scope = [of("geoScope"), of("interpretation")].join(" ");
            *text += &format!("{:indent$}{} ", "", property.name);
            match property.kind {
                AbcPropertyKind::Compound(place) => {
                    *text += "\n";
                    let inner = archive.properties(place).unwrap();
                    properties(archive, inner, indent + 2, text);
                }
                AbcPropertyKind::Values { pod, extent, is_scalar, bytes, .. } => {
                    let how = if is_scalar { "scalar" } else { "array" };
                    let told = format!("{how} {pod}x{extent} {scope} {} bytes", bytes.len());
                    *text += &(told.split_whitespace().collect::<Vec<_>>().join(" ") + "\n");
                }
            }
        }
    }
    fn objects(archive: &Archive, object: AbcObject, indent: usize, text: &mut String) {
        let (place, children) = archive.open_object(&object).unwrap();
        let schema = entry(object.metadata, "schema").unwrap_or("");
        *text += &format!("{:indent$}/{} {schema}\n", "", object.name);
        properties(archive, archive.properties(place).unwrap(), indent + 2, text);
        children.into_iter().for_each(|child| objects(archive, child, indent + 2, text));
    }
    let archive = Archive::open(bytes).unwrap();
    let mut text = String::new();
    objects(&archive, archive.top().unwrap(), 0, &mut text);
    text
}

#[test]
fn a_groom_lies_where_unreal_maya_and_blender_look_for_it() {
    // Types are 0 bool, 1 uint8, 4 int16, 6 int32, 10 float32, 11 float64, 12 text. Of 3 curves of 4 points: 12 bytes a position
    // are 144, 4 a width or count 48 or 12, 8 a uv 24.
    let hair = &groups()[..1];
    expect_test::expect![[r#"
        / 
          /Head AbcGeom_Xform_v3
            .xform 
              .inherits scalar 0x1 1 bytes
              .userProperties 
                groom_version_major scalar 4x1 2 bytes
                groom_version_minor scalar 4x1 2 bytes
                groom_tool scalar 12x1 11 bytes
                groom_properties scalar 12x1 19 bytes
            /hair AbcGeom_Xform_v3
              .xform 
                .inherits scalar 0x1 1 bytes
              /hairShape AbcGeom_Curve_v2
                .geom 
                  .selfBnds scalar 11x6 box 48 bytes
                  P array 10x3 vtx point 144 bytes
                  nVertices array 6x1 12 bytes
                  curveBasisAndType scalar 1x4 4 bytes
                  width array 10x1 vtx 48 bytes
                  uv array 10x2 uni vector 24 bytes
                  .arbGeomParams 
                    displayColor array 10x3 uni rgb 36 bytes
                    id array 6x1 uni 12 bytes
                    st array 10x2 uni vector 24 bytes
                    pref array 10x3 vtx point 144 bytes
                    groom_guide array 6x1 con 4 bytes
                    groom_group_id array 6x1 con 4 bytes
                    groom_group_name array 12x1 con 5 bytes
                    groom_id array 6x1 uni 12 bytes
                    groom_root_uv array 10x2 uni vector 24 bytes
                    groom_color array 10x3 vtx rgb 144 bytes
    "#]]
    .assert_eq(&listing(&exported(Format::Abc, hair)));
}

#[test]
fn guides_belong_to_the_hair_of_their_name_or_to_the_first_and_partings_to_usd_alone() {
    let groups = groups();
    // Guide, group id, group name of each in the order that files have it. All have the ids 5, 5 + 2^31 and 6: the first two fold to
    // one number, and the next free one is 7, for 6 is taken. The first guides keep theirs, all others get new ones.
    let place = |guide: i32, id: i32, name: &str| (guide, id, name.to_owned());
    let mut expected =
        vec![place(0, 0, "hair"), place(0, 1, "brows"), place(1, 1, "brows"), place(1, 0, "hair")];
    let of = |read: &ReadCurves| {
        let one = |name: &str| {
            let found = read.primvars.iter().find(|p| p.name == name).expect(name);
            (found.interpolation.clone(), found.values.clone())
        };
        let ids = match one("groom_id") {
            (how, ReadValues::Int(ids)) if how == "uniform" => ids,
            other => panic!("{other:?}"),
        };
        assert_eq!(ids.len(), 3);
        let uvs = ReadValues::Float2(vec![Vec2::X, Vec2::Y, Vec2::splat(0.25)]);
        assert_eq!(one("groom_root_uv"), ("uniform".into(), uvs));
        let int = |name: &str| match one(name) {
            (how, ReadValues::Int(v)) if how == "constant" && v.len() == 1 => v[0],
            other => panic!("{name}: {other:?}"),
        };
        let name = match one("groom_group_name") {
            (how, ReadValues::Text(mut v)) if how == "constant" && v.len() == 1 => v.remove(0),
            other => panic!("{other:?}"),
        };
        (ids, (int("groom_guide"), int("groom_group_id"), name))
    };
    // What the sets of a file are; no id is twice in it.
    let of = |sets: &[ReadCurves]| -> Vec<(i32, i32, String)> {
        let (ids, places): (Vec<Vec<i32>>, Vec<_>) = sets.iter().map(of).unzip();
        let all: std::collections::BTreeSet<i32> = ids.concat().into_iter().collect();
        assert_eq!(all.len(), ids.concat().len(), "{ids:?}");
        let first_guides = places.iter().position(|(guide, ..)| *guide == 1).expect("guides");
        assert_eq!(ids[first_guides], [5, 7, 6]);
        places
    };
    let abc = read_curves(&exported(Format::Abc, &groups)).unwrap();
    assert_eq!(of(&abc), expected);
    let paths: Vec<&str> = abc.iter().map(|read| read.path.as_str()).collect();
    assert_eq!(
        paths,
        [
            "/Head/hair/hairShape",
            "/Head/brows/browsShape",
            "/Head/brows_guides/brows_guidesShape",
            "/Head/ties_guides/ties_guidesShape"
        ]
    );
    expected.push(place(1, 0, "hair"));
    for (format, extension) in [(Format::Usda, "usda"), (Format::Usdc, "usdc")] {
        let bytes = exported(format, &groups);
        let usd = super::common::read_curves(&bytes, extension).unwrap();
        assert_eq!(of(&usd), expected, "{extension}");
    }
    // Where there is nothing else, partings are what was asked for.
    assert_eq!(read_curves(&exported(Format::Abc, &groups[4..])).unwrap().len(), 1);
}

#[test]
fn values_that_are_the_same_are_written_once() {
    let (strands, guides) = sample();
    let mut stage = sample_stage(&strands, &guides);
    let before = bytes_of(&stage).len();
    let again = stage.groups[0].primvars[6].clone();
    let size = strands.n_points() * 12;
    stage.groups[0].primvars.push(Primvar { name: "again".into(), ..again });
    let more = bytes_of(&stage).len() - before;
    assert!(more < 100 && size > 1000, "{more} bytes for {size}");
}

#[test]
fn names_hold_nothing_that_paths_or_metadata_are_made_of() {
    let names = ["a/b", "a;b", "a=b", "a\0b", "", "Zöpfe"];
    let sets = names.map(|name| CurveSet { name: name.into(), ..two_points() });
    let primvar = |name: &str| Primvar {
        name: name.into(),
        interpolation: Interpolation::Constant,
        values: PrimvarValues::Int(vec![1].into()),
    };
    let mut stage =
        GroomStage { name: "a/b;c".into(), groups: sets.into(), ..one_set(two_points()) };
    stage.doc = "x;_ai_Application=y".into();
    stage.groups[0].primvars = names.map(primvar).into();
    let read = read_curves(&bytes_of(&stage)).unwrap();
    let paths: Vec<&str> = read.iter().map(|curves| curves.path.as_str()).collect();
    let of = |name: &str| format!("/a_b_c/{name}/{name}Shape");
    assert_eq!(paths, ["a_b", "a_b_1", "a_b_2", "a_b_3", "_", "Zöpfe"].map(of));
    let primvars: Vec<&str> = read[0].primvars.iter().map(|p| p.name.as_str()).collect();
    assert_eq!(primvars, ["a_b", "a_b_1", "a_b_2", "a_b_3", "_", "Zöpfe"]);
}

#[test]
fn a_stage_that_contradicts_itself_is_refused_with_its_place() {
    let check = |set: CurveSet, expected: &str| {
        let said = write(&one_set(set), &[], &mut Cursor::new(vec![])).unwrap_err();
        assert_eq!(said.to_string(), expected);
    };
    check(
        CurveSet { counts: vec![2, 3].into(), ..two_points() },
        "hair: the curves count 5 points, but there are 2",
    );
    check(
        CurveSet { points: vec![Vec3::ZERO, Vec3::NAN].into(), ..two_points() },
        "hair, point 1: the position is no finite number",
    );
    let text = Primvar {
        name: "t".into(),
        interpolation: Interpolation::Constant,
        values: PrimvarValues::Text(vec!["a\0b".into()]),
    };
    check(
        CurveSet { primvars: vec![text], ..two_points() },
        "hair, primvar t: a text holds a NUL character, which ends texts in Alembic",
    );
}

#[test]
fn faces_of_a_head_are_clockwise_and_keep_their_corners_uvs() {
    let points = vec![Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z];
    let triangles = vec![[0, 1, 2], [0, 2, 3]];
    let uvs = vec![[Vec2::ZERO, Vec2::X, Vec2::Y]; 2];
    let masks = BTreeMap::from([(REGION.to_owned(), vec![1.0; 4])]);
    let surface = Surface::new(points, triangles);
    let head = Arc::new(Scalp::new(surface, Some(uvs), HeadFrame::IDENTITY, masks));
    let mut file = Cursor::new(vec![]);
    write(&one_set(two_points()), &[head], &mut file).unwrap();
    let bytes = file.into_inner();
    let archive = Archive::open(&bytes).unwrap();
    let (_, top) = archive.open_object(&archive.top().unwrap()).unwrap();
    let (_, sets) = archive.open_object(&top[0]).unwrap();
    let names: Vec<&str> = sets.iter().map(|set| set.name).collect();
    assert_eq!(names, ["hair", "head"]);
    let (_, shapes) = archive.open_object(&sets[1]).unwrap();
    let (place, _) = archive.open_object(&shapes[0]).unwrap();
    let AbcPropertyKind::Compound(geom) = archive.properties(place).unwrap()[0].kind else {
        panic!()
    };
    let geom = archive.properties(geom).unwrap();
    let of = |name: &str| match geom.iter().find(|p| p.name == name).expect(name).kind {
        AbcPropertyKind::Values { bytes, .. } => bytes.to_vec(),
        AbcPropertyKind::Compound(_) => panic!("{name}"),
    };
    let ints = |values: &[i32]| bytemuck::cast_slice::<i32, u8>(values).to_vec();
    assert_eq!(of(".faceCounts"), ints(&[3, 3]));
    assert_eq!(of(".faceIndices"), ints(&[0, 2, 1, 0, 3, 2]));
    let turned = [Vec2::ZERO, Vec2::Y, Vec2::X, Vec2::ZERO, Vec2::Y, Vec2::X];
    assert_eq!(of("uv"), bytemuck::cast_slice::<Vec2, u8>(&turned));
    assert_eq!(of("P").len(), 48);
}

// ---- other programs' and hostile bytes ---------------------------------------------------------

#[test]
fn curves_of_other_programs_are_read() {
    let Some(folder) = common::shared("data/abc_curves", "curves_of_other_programs_are_read")
    else {
        return;
    };
    let mut found = String::new();
    for file in common::files(&folder, &["abc"]) {
        let name = common::file_name(&file);
        match read_curves(&std::fs::read(&file).unwrap()) {
            Ok(read) => {
                let curves: usize = read.iter().map(|curves| curves.counts.len()).sum();
                let points: usize = read.iter().map(|curves| curves.points.len()).sum();
                let widths = read.iter().filter(|curves| curves.widths.is_some()).count();
                let notes: usize = read.iter().map(|curves| curves.notes.len()).sum();
                let n = read.len();
                found += &format!(
                    "{name}: {n} objects, {curves} curves, {points} points, {widths} with widths, {notes} notes\n"
                );
            }
            Err(reason) => found += &format!("{name}: {reason}\n"),
        }
    }
    expect_test::expect![[r#"
        cortex_coloredMesh.abc: 0 objects, 0 curves, 0 points, 0 with widths, 0 notes
        cortex_curves.abc: 3 objects, 3 curves, 17 points, 0 with widths, 0 notes
        cortex_varyingPoints.abc: 0 objects, 0 curves, 0 points, 0 with widths, 0 notes
        cortex_widthTest.abc: 2 objects, 2 curves, 8 points, 2 with widths, 1 notes
    "#]]
    .assert_eq(&found);
}

#[test]
fn mutated_files_are_read_or_refused() {
    let (strands, guides) = sample();
    let bytes = bytes_of(&sample_stage(&strands, &guides));
    let mut outcomes = [0; 2];
    for seed in 0..2000 {
        outcomes[read_curves(&common::mutated(&bytes, seed)).is_ok() as usize] += 1;
    }
    // Flipped bits of numbers are still numbers; the rest has to be noticed.
    assert!(outcomes.iter().all(|&count| count > 200), "{outcomes:?}");
    for length in (0..bytes.len()).step_by(13) {
        assert!(read_curves(&bytes[..length]).is_err(), "{length}");
    }
}

#[test]
fn a_group_that_holds_itself_ends() {
    let mut bytes = bytes_of(&one_set(two_points()));
    // The root's third child, the top object, becomes the root itself: an object whose children never end.
    let place = |at: usize| u64::from_le_bytes(bytes[at..at + 8].try_into().unwrap());
    let root = place(8);
    let top = place(root as usize + 8 + 16) as usize;
    let children = place(top) as usize;
    assert_eq!(children, 3, "properties, the groom, headers");
    bytes[top + 16..top + 24].copy_from_slice(&(top as u64).to_le_bytes());
    let said = read_curves(&bytes).unwrap_err();
    assert!(said.starts_with("file: its groups are more than"), "{said}");
}
