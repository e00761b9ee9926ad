//! `.hair`: what is written reads back equal, limits are told, hostile bytes are refused.

use super::common::{self, Tufts, chunks};
use coif_nodes::formats::hair::{Colors, HairSet, Thickness, read, write};
use glam::Vec3;

fn hair(tufts: &Tufts) -> HairSet<'_> {
    HairSet {
        counts: chunks(&tufts.counts),
        points: chunks(&tufts.points),
        thickness: Thickness::Points(chunks(&tufts.widths)),
        colors: Colors::Default(Vec3::new(0.2, 0.1, 0.05)),
        generator: "coif tests".into(),
    }
}

fn bytes_of(hair: &HairSet) -> Vec<u8> {
    let mut bytes = Vec::new();
    write(hair, &mut bytes).unwrap();
    bytes
}

#[track_caller]
fn check_round_trip(tufts: &Tufts, expected_length: usize) {
    let bytes = bytes_of(&hair(tufts));
    assert_eq!(bytes.len(), expected_length);
    let read = read(&bytes).unwrap();
    let counts: Vec<u32> = tufts.counts.concat().iter().map(|&count| count as u32).collect();
    assert_eq!(read.counts, counts);
    assert_eq!(read.points, tufts.points.concat());
    assert_eq!(read.thickness, tufts.widths.concat());
    assert_eq!(read.info, "units cm, Y up, coif tests");
}

#[test]
fn strands_read_back_equal() {
    let uneven = Tufts::new(40, None);
    check_round_trip(&uneven, 128 + 2 * 40 + 16 * uneven.n_points());
}

#[test]
fn equally_long_strands_need_no_segments() {
    check_round_trip(&Tufts::new(30, Some(16)), 128 + 16 * 30 * 16);
}

#[test]
fn colours_lie_behind_the_thickness() {
    let tufts = Tufts::new(3, Some(4));
    let without = bytes_of(&hair(&tufts));
    let colors = Colors::Points(vec![Vec3::X; 12].into());
    let with = bytes_of(&HairSet { colors, ..hair(&tufts) });
    assert_eq!(with.len(), without.len() + 12 * 12);
    assert_eq!(with[128..without.len()], without[128..]);
    assert_eq!(read(&with).unwrap().points, read(&without).unwrap().points);
}

#[test]
fn no_strands_are_a_valid_file() {
    let empty = HairSet {
        counts: vec![].into(),
        points: vec![].into(),
        thickness: Thickness::Default(0.01),
        colors: Colors::Default(Vec3::ONE),
        generator: "é".repeat(100),
    };
    let bytes = bytes_of(&empty);
    assert_eq!(bytes.len(), 128);
    let read = read(&bytes).unwrap();
    assert_eq!((read.counts.len(), read.thickness), (0, vec![0.01]));
    // Cut between characters, with the last byte left as the end.
    assert_eq!(read.info, format!("units cm, Y up, {}", "é".repeat(35)));
}

#[track_caller]
fn check_refused(hair: HairSet, expected: &str) {
    let written = write(&hair, &mut Vec::new()).map_err(|error| error.to_string());
    assert_eq!(written, Err(expected.to_owned()));
}

#[test]
fn what_the_format_cannot_count_is_refused() {
    let tufts = Tufts::new(3, Some(4));
    let long = vec![Vec3::ZERO; 65_537];
    check_refused(
        HairSet {
            counts: vec![65_537].into(),
            points: long.as_slice().into(),
            thickness: Thickness::Default(0.1),
            ..hair(&tufts)
        },
        "strand 0: 65537 points: a .hair strand has 1 to 65536, that is 0 to 65535 segments",
    );
    check_refused(
        HairSet { counts: vec![4, 4].into(), ..hair(&tufts) },
        "strands: they count 8 points, but there are 12",
    );
    check_refused(
        HairSet { thickness: Thickness::Points(vec![1.0].into()), ..hair(&tufts) },
        "thickness: 1 values for 12 points",
    );
}

#[test]
fn mutated_hair_is_read_or_refused() {
    let bytes = bytes_of(&hair(&Tufts::new(40, None)));
    let mut outcomes = [0; 2];
    for seed in 0..400 {
        outcomes[read(&common::mutated(&bytes, seed)).is_ok() as usize] += 1;
    }
    assert!(outcomes.iter().all(|&count| count > 50), "{outcomes:?}");
}

#[test]
fn hostile_hair_is_read_or_refused() {
    let Some(folder) = common::shared("data/bad/made_here", "hostile_hair_is_read_or_refused")
    else {
        return;
    };
    let mut found = String::new();
    for file in common::files(&folder, &["hair"]) {
        let outcome = match read(&std::fs::read(&file).unwrap()) {
            Ok(read) => format!("{} strands, {} points", read.counts.len(), read.points.len()),
            Err(error) => error.to_string(),
        };
        found += &format!("{}: {outcome}\n", common::file_name(&file));
    }
    expect_test::expect![[r#"
        default_segments_zero.hair: 4 strands, 4 points
        empty_file.hair: header: 0 bytes, shorter than the 128 of it
        header_127.hair: header: 127 bytes, shorter than the 128 of it
        huge_hair_count.hair: byte 128: the header states 4294967295 segments, but only 128 bytes follow
        huge_point_count_x12_overflow.hair: segments: 1 strands count 2 points, but the header says 357913942
        info_not_terminated_nonutf8.hair: 1 strands, 3 points
        magic_only.hair: header: 4 bytes, shorter than the 128 of it
        nan_inf_points.hair: point 1: the value is no finite number
        nan_inf_thickness.hair: thickness 0: the value is no finite number
        no_points_flag.hair: byte 12: the file has no points
        segments_sum_too_big.hair: segments: 2 strands count 131072 points, but the header says 6
        segments_sum_too_small.hair: segments: 2 strands count 6 points, but the header says 60
        trailing_garbage.hair: 11400 strands, 182400 points
        truncated_half.hair: byte 128: the header states 182400 points, but only 1094336 bytes follow
        truncated_in_segments.hair: byte 128: the header states 1000 segments, but only 600 bytes follow
        unknown_flag_bits.hair: 1 strands, 3 points
        wrong_magic.hair: byte 0: no .hair file: it does not begin with HAIR
        zero_hairs.hair: 0 strands, 0 points
        zero_length_strand.hair: 3 strands, 9 points
        zero_segments_array.hair: 4 strands, 4 points
    "#]].assert_eq(&found);
}

#[test]
fn a_groom_of_another_program_is_read() {
    let Some(folder) = common::shared("data/sintel", "a_groom_of_another_program_is_read") else {
        return;
    };
    let read = read(&std::fs::read(folder.join("sintel_groom.hair")).unwrap()).unwrap();
    assert_eq!(read.counts.len(), 11_400);
    assert_eq!(read.counts.iter().sum::<u32>() as usize, read.points.len());
}
