use shared::intent::Intent;

use super::*;
use crate::fixture::{R, cells};
use crate::readers::mat::fixture;
use crate::recording::Timing;

fn read(path: &str, bytes: impl AsRef<[u8]>) -> Result<Recording, LoadError> {
    let bytes = bytes.as_ref();
    let path = Path::new(path);
    let file = PublishedFile::of(path, bytes).expect("a path of a published set");
    Ok(file.read(bytes)?.remove(0))
}

/// Count of a row: loud in the hold.
fn count(row: usize, hold: &std::ops::Range<usize>) -> i8 {
    let count = if hold.contains(&row) { 40 } else { 2 };
    if row.is_multiple_of(2) { count } else { -count }
}

fn array(rows: usize) -> Vec<u8> {
    let samples = (0..rows).map(|row| [count(row, &(500..800)); 8]);
    crate::fixture::array(&samples.collect::<Vec<_>>())
}

/// Names of what is labelled in a recording, intents first.
fn labelled(own: &Recording) -> String {
    let labels = own.labels.iter().flatten().map(|label| label.name());
    let others = own.other_movement.iter().map(|own| own.kind.name());
    let mut names: Vec<&str> = labels.chain(others).collect();
    names.dedup();
    if names.is_empty() {
        return "-".to_owned();
    }
    names.join(" ")
}

/// Path, content, name and labels of a file of each set.
const TAKEN: &str = "\
EMG_S12/5_thumb_up.npy | 900 | wang-myo/S12/5_thumb_up | relax thumb-up
EMG_S3/x/握拳_1_x.mat | mat | wang-myo/S3/1_fist | -
EMG_S3/Good_5_x.mat | mat | wang-myo/S3/5_thumb_up | -
user10/testing/055_pinch.npy | 1000 | epn/user10/testing/055_pinch | relax pinch relax
sub7/M8T1.CSV | decimals | ss-stm/sub7/M8T1 | relax close relax
EvaluationDataset/Male3/training0/classe_13.dat | int16 | cote-allard/E-Male3/training0/classe_13 | open
ciil/7/S1_R2_wavein.npy | 900 | ciil/7/S1_R2_wavein | wave-in
epn10/p3/1_doubletap_2.npy | 1000 | epn10/p3/1_doubletap_2 | relax other
pangestu/p2/waveout_T1.npy | 1000 | pangestu/p2/waveout_T1 | relax wave-out relax
dideakay/p1/close_3.npy | 1000 | dideakay/p1/close_3 | relax close relax
adl/p1/eating.npy | 1000 | adl/p1/eating | eating
psl/p2/w07_1.npy | 1000 | psl/p2/w07_1 | signing
libras/p1/C_1.npy | 1000 | libras/p1/C_1 | signing";

/// Path and content of files of no set.
const NOT_TAKEN: &str = "\
EMG_S3/握拳_1.mat | mat
EMG_S3/握拳_11_x.mat | mat
S/握拳_1_x.mat | mat
user10/training/1_wink.npy | 900
a/training/1_fist.npy | 900
user10/1_fist.npy | 900
subject/M8T1.csv | decimals
sub7/M8T1.csv | whole
s2_l_1-lizard-7-emg.csv | whole";

#[test]
fn names_say_set_person_and_motion_and_nothing_else_is_taken() {
    let bytes = |content: &str| match content {
        "mat" => fixture::file(&[fixture::doubles("data", [50, 8], &[0.5; 400])]),
        "decimals" => b"0.5,0,0,0,0,0,0,-1\n".repeat(800),
        "whole" => b"1,2,3,4,5,6,7,8\n".repeat(20),
        "int16" => [1, 0].repeat(16),
        rows => array(rows.parse().unwrap()),
    };
    for [path, content, name, labels] in cells(TAKEN) {
        let own = read(&format!("/d/{path}"), bytes(content)).unwrap();
        let found = (own.full_name(), labelled(&own));
        assert_eq!(found, (name.to_owned(), labels.to_owned()));
    }
    for [path, content] in cells(NOT_TAKEN) {
        let path = Path::new("/d").join(path);
        let found = PublishedFile::of(&path, &bytes(content));
        assert!(found.is_none(), "{}", path.display());
    }
}

#[test]
fn the_gesture_of_a_name_is_where_the_muscle_is_active() {
    let rps = |hold| {
        let counts = |at| format!(",{}", count(at, &hold)).repeat(8);
        let row = |at| format!("{at},0{}\r\n", counts(at));
        let rows: String = (0..400).map(row).collect();
        format!("index,timestamp,0,1,2,3,4,5,6,7\r\n{rows}").into_bytes()
    };
    let rock = read("/d/s2_l_1/s2_l_1-rock-7-emg.csv", rps(100..300)).unwrap();
    assert_eq!(rock.full_name(), "myo-rps/s2/l_1-rock-7");
    let found = [rock.labels[200], rock.labels[20]];
    assert_eq!(found, [Some(Intent::Close), R]);
    assert_eq!((rock.samples[201], rock.timing), ([-40; 8], Timing::Muscle));
    let scissors = read("/d/s2_l_1-scissors-7-emg.csv", rps(100..300)).unwrap();
    assert!(scissors.other_movement[0].samples.contains(&200));
    let weak = read("/d/s5_l_1-rock-7-emg.csv", rps(0..0)).unwrap();
    assert!(!weak.has_labels());
    assert_eq!(weak.notes.len(), 2, "{:?}", weak.notes);
    let rest = read("/d/user10/testing/001_noGesture.npy", array(900)).unwrap();
    assert_eq!((rest.labels, rest.timing), (vec![R; 900], Timing::Cues));
    assert!(rest.notes[0].contains("some were lost"));
}

#[test]
fn lines_of_myo_readings_end_and_are_spaced_either_way() {
    let text = "-3, 1, -2, 4, 0, 2, 0, -2, 0\r\n1,2,3,4,5,6,7,-128,7";
    let right = read("/d/12345-2/7.TXT", text).unwrap();
    let samples = [[-3, 1, -2, 4, 0, 2, 0, -2], [1, 2, 3, 4, 5, 6, 7, -128]];
    assert_eq!(right.samples, samples);
    assert_eq!(right.labels, [R, Some(Intent::Close)]);
    assert_eq!(right.full_name(), "myo-readings/12345/2/7");
    let left = read("/d/_readings_left_hand/12345-2/7.txt", text).unwrap();
    assert_eq!(left.samples[1], [7, 6, 5, 4, 3, 2, 1, -128]);
    assert_eq!(left.full_name(), "myo-readings/12345/left/2/7");
    assert!(left.notes[0].contains("mirrored"), "{:?}", left.notes);
}

#[test]
fn a_lost_newline_of_myo_readings_names_its_line() {
    let text = "0,0,0,0,0,0,0,0,0\n4,2,1,0,-1,0,0,0,00,3,2,0,1,1,-1,0,0\n0,0,0,0,0,0,0,0,0\n";
    let error = |path| read(path, text).unwrap_err().to_string();
    let own = error("/d/19999-2/12.txt");
    let words = "line 2: expected 9 values as in the rows before, found 17";
    assert!(own.ends_with(words), "{own}");
    assert!(error("/d/19999-2/2.txt").ends_with("(damaged as published)"));
}

#[test]
fn times_of_uci_gestures_that_go_back_leap_or_last_too_long_are_refused() {
    // A time, a count in all channels and a class.
    let file = |times: &mut dyn Iterator<Item = usize>| {
        let names = [1, 2, 3, 4, 5, 6, 7, 8].map(|channel| format!("channel{channel}\t"));
        let row = |(at, time)| format!("{time}{}\t0\n", format!("\t{}e-05", at % 2).repeat(8));
        let rows: String = (0..).zip(times).map(row).collect();
        format!("time\t{}class\n{rows}", names.concat())
    };
    let hours = &mut (0..3602).map(|second| 1000 * second);
    let (back, leap) = (&mut [5, 4].into_iter(), &mut [5, 2000].into_iter());
    let cases: [(&mut dyn Iterator<Item = usize>, &str); 3] = [
        (back, "line 3: expected times that rise"),
        (leap, "line 3: expected times that rise"),
        (hours, "at most 3600 s"),
    ];
    for (times, words) in cases {
        let error = read("/d/07/2_raw_data_13.txt", file(times)).unwrap_err();
        assert!(error.to_string().contains(words), "{error}");
    }
}

#[test]
fn pulses_of_myoup_are_counted_and_rest_keeps_a_second_away() {
    // 700 of rest before each pulse of 300.
    let one = [vec![0.0; 700], vec![100.0; 300]].concat();
    let emg: Vec<f64> = (0..60 * one.len() * CHANNELS)
        .map(|at| (at % 9) as f64)
        .collect();
    let file = |pulses: usize| {
        let samples = fixture::doubles("emg", [(emg.len() / CHANNELS) as i32, 8], &emg);
        let pulse = one.repeat(pulses);
        let pulse = fixture::doubles("pulse", [pulse.len() as i32, 1], &pulse);
        fixture::file(&[fixture::compressed(&samples), pulse])
    };
    let recording = read("/d/MyoUP/E2/s3e2.mat", file(60)).unwrap();
    assert_eq!(recording.full_name(), "myoup/s3/e2");
    let expected = [None, None, R, None].into_iter();
    for (at, label) in [500, 1199, 1200, 1500].into_iter().zip(expected) {
        assert_eq!(recording.labels[at], label, "{at}");
    }
    // Five pulses of each gesture; 5 is open.
    assert_eq!(recording.labels[20_800], Some(Intent::Open));
    let error = read("/d/MyoUP/E2/s3e2.mat", file(59)).unwrap_err();
    let words = "expected 60 gestures marked, found 59";
    assert!(error.to_string().contains(words), "{error}");
    assert!(has_labels(Path::new("/d/s3/e2_ann.npy")));
}

#[test]
fn a_cut_file_of_cote_allard_names_its_length_and_a_damaged_value_its_byte() {
    let path = "/d/PreTrainingDataset/Male3/training0/classe_15.DAT";
    // One value of many is damage, and no scale.
    let one = [&[1, 0].repeat(8 * 200)[..], &[1; 16]].concat();
    for (bytes, words) in [
        (&[0; 18][..], "byte 18: expected 32 bytes, found 18"),
        (
            &one,
            "byte 3200: expected a count of the armband in field 1, a whole number from -128 to 127, found 257",
        ),
    ] {
        let error = read(path, bytes).unwrap_err().to_string();
        assert!(error.contains(words), "{error}");
    }
}
