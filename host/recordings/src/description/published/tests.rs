use shared::intent::Intent;

use super::*;
use crate::readers::mat::fixture;
use crate::readers::npy;
use crate::recording::Timing;
use crate::recording::movement::{Movement, MovementKind};

const RELAX: Option<Intent> = Some(Intent::Relax);

fn read(path: &str, bytes: impl AsRef<[u8]>) -> Result<Recording, LoadError> {
    let bytes = bytes.as_ref();
    let path = Path::new(path);
    let (layout, fields) = Layout::of(path, bytes).expect("a path of a published set");
    Ok(layout.read(path, bytes, &fields)?.remove(0))
}

/// Count of a row: loud in the hold.
fn count(row: usize, hold: &std::ops::Range<usize>) -> i8 {
    let count = if hold.contains(&row) { 40 } else { 2 };
    if row.is_multiple_of(2) { count } else { -count }
}

fn array(rows: usize) -> Vec<u8> {
    let counts = (0..rows * 8).map(|at| count(at / 8, &(500..800)).cast_unsigned());
    npy::encode("|i1", &[rows, 8], &counts.collect::<Vec<u8>>())
}

#[test]
fn names_say_set_person_and_motion_and_nothing_else_is_taken() {
    let mat = fixture::file(&[fixture::doubles("data", [50, 8], &[0.5; 400])]);
    let rows = b"0.5,0,0,0,0,0,0,-1\n".repeat(20);
    for (path, bytes, name) in [
        (
            "/d/EMG_S12/5_thumb_up.npy",
            array(900),
            "wang-myo/S12/5_thumb_up",
        ),
        (
            "/d/EMG_S3/x/握拳_1_x.mat",
            mat.clone(),
            "wang-myo/S3/1_fist",
        ),
        (
            "/d/EMG_S3/Good_5_x.mat",
            mat.clone(),
            "wang-myo/S3/5_thumb_up",
        ),
        (
            "/d/user10/testing/055_pinch.npy",
            array(1000),
            "epn/user10/testing/055_pinch",
        ),
        ("/d/sub7/M8T1.csv", rows.clone(), "ss-stm/sub7/M8T1"),
        (
            "/d/EvaluationDataset/Male3/training0/classe_13.dat",
            [1, 0].repeat(16),
            "cote-allard/E-Male3/training0/classe_13",
        ),
    ] {
        assert_eq!(read(path, &bytes).unwrap().full_name(), name);
    }
    let whole = b"1,2,3,4,5,6,7,8\n".repeat(20);
    for (path, bytes) in [
        ("/d/EMG_S3/握拳_1.mat", mat.clone()),
        ("/d/EMG_S3/握拳_11_x.mat", mat.clone()),
        ("/d/S/握拳_1_x.mat", mat),
        ("/d/user10/training/1_wink.npy", array(900)),
        ("/d/a/training/1_fist.npy", array(900)),
        ("/d/user10/1_fist.npy", array(900)),
        ("/d/subject/M8T1.csv", rows),
        ("/d/sub7/M8T1.csv", whole.clone()),
        ("/d/s2_l_1-lizard-7-emg.csv", whole),
    ] {
        assert!(Layout::of(Path::new(path), &bytes).is_none(), "{path}");
    }
}

/// Reads four samples of `roshambo` beside these annotations.
fn roshambo(annotations: &[u8], count: usize) -> Result<Recording, LoadError> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("subject07_session03_emg.npy");
    let data: Vec<u8> = (0..4i64).flat_map(|n| n.to_le_bytes().repeat(8)).collect();
    let partner = folder.path().join("subject07_session03_ann.npy");
    std::fs::write(partner, npy::encode("|S7", &[count], annotations)).unwrap();
    read(path.to_str().unwrap(), npy::encode("<i8", &[4, 8], &data))
}

#[test]
fn annotations_of_roshambo_are_the_labels() {
    let recording = roshambo(b"none\0\0\0paper\0\0rock\0\0\0scissor", 4).unwrap();
    let expected = [RELAX, Some(Intent::Open), Some(Intent::Close), None];
    assert_eq!(recording.labels, expected);
    let scissors = Movement::new(MovementKind::TwoFingers, 3..4);
    assert_eq!(recording.other_movement, [scissors]);
    assert_eq!(recording.notes, ["paper and scissor are not above rest"]);
    for (annotations, count, words) in [
        (&b"none\0\0\0lizard\0none\0\0\0none\0\0\0"[..], 4, "lizard"),
        (b"none\0\0\0", 1, "1 labels for 4 samples"),
    ] {
        let error = roshambo(annotations, count).unwrap_err().to_string();
        assert!(
            error.contains(words) && error.contains("_ann.npy, "),
            "{error}"
        );
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
    assert_eq!(
        [rock.labels[200], rock.labels[20]],
        [Some(Intent::Close), RELAX]
    );
    assert_eq!((rock.samples[201], rock.timing), ([-40; 8], Timing::Muscle));
    let scissors = read("/d/s2_l_1-scissors-7-emg.csv", rps(100..300)).unwrap();
    assert!(scissors.other_movement[0].samples.contains(&200));
    let weak = read("/d/s5_l_1-rock-7-emg.csv", rps(0..0)).unwrap();
    assert!(
        !weak.has_labels() && weak.notes.len() == 2,
        "{:?}",
        weak.notes
    );
    let rest = read("/d/user10/testing/001_noGesture.npy", array(900)).unwrap();
    assert_eq!((rest.labels, rest.timing), (vec![RELAX; 900], Timing::Cues));
    assert!(rest.notes[0].contains("some were lost"));
}

#[test]
fn nothing_is_labelled_after_a_motion_outside_the_six() {
    let rows = b"-0.015625,0.9921875,-1,0,0,0,0,0.0546875\n".repeat(1000);
    let [close, pronation] =
        ["M8T1", "M6T1"].map(|name| read(&format!("/d/sub7/{name}.csv"), &rows).unwrap());
    assert_eq!(close.samples[999], [-2, 127, -128, 0, 0, 0, 0, 7]);
    let fist = Some(Intent::Close);
    assert_eq!(
        [199, 200, 599, 600].map(|at| close.labels[at]),
        [RELAX, fist, fist, RELAX]
    );
    assert!(close.notes.is_empty());
    assert_eq!(
        [199, 200, 999].map(|at| pronation.labels[at]),
        [RELAX, None, None]
    );
    let movement = Movement::new(MovementKind::Pronation, 200..600);
    assert_eq!(pronation.other_movement, [movement]);
    let broken = [&rows[..], b"0,0,0.3,0,0,0,0,0\n"].concat();
    let error = read("/d/sub7/M8T1.csv", &broken).unwrap_err().to_string();
    assert!(
        error.contains("line 1001") && error.contains("field 3"),
        "{error}"
    );
}

#[test]
fn a_deviation_is_other_movement_and_a_cut_row_names_its_byte() {
    let path = "/d/PreTrainingDataset/Male3/training0/classe_15.dat";
    let radial = read(path, [255; 32]).unwrap();
    assert_eq!(radial.samples, [[-1; 8]; 2]);
    assert_eq!(
        radial.other_movement,
        [Movement::new(MovementKind::RadialDeviation, 0..2)]
    );
    for (bytes, words) in [
        (&[0; 18][..], "byte 16: expected 32 bytes, found 18"),
        (&[1; 32], "found 257"),
    ] {
        let error = read(path, bytes).unwrap_err().to_string();
        assert!(error.contains(words), "{error}");
    }
}

#[test]
fn rest_keeps_a_second_away_from_a_pulse_and_pulses_are_counted() {
    // 700 of rest before each pulse of 300, and after the last.
    let one = [vec![0.0; 700], vec![100.0; 300]].concat();
    let pulse = [one.repeat(60), vec![0.0; 700]].concat();
    let emg: Vec<f64> = (0..pulse.len() * CHANNELS)
        .map(|at| (at % 9) as f64)
        .collect();
    let file = |pulse: &[f64]| {
        let samples = fixture::doubles("emg", [(emg.len() / CHANNELS) as i32, 8], &emg);
        let pulse = fixture::doubles("pulse", [pulse.len() as i32, 1], pulse);
        fixture::file(&[fixture::compressed(&samples), pulse])
    };
    let path = "/d/MyoUP/E2/s3e2.mat";
    let recording = read(path, file(&pulse)).unwrap();
    assert_eq!(recording.full_name(), "myoup/s3/e2");
    let labels = &recording.labels;
    let expected = [
        (0, RELAX),
        (499, RELAX),
        (500, None),
        (1199, None),
        (1200, RELAX),
        (60_699, RELAX),
    ];
    for (at, label) in expected {
        assert_eq!(labels[at], label, "{at}");
    }
    // Five pulses of each gesture; 11 and 12 are left out.
    let first: Vec<_> = (0..12)
        .map(|gesture| labels[5000 * gesture + 800])
        .collect();
    let named = |gesture: usize| first[gesture - 1].map(Intent::name);
    assert_eq!(
        [5, 6, 9, 10].map(named),
        ["open", "close", "wave-out", "wave-in"].map(Some)
    );
    assert_eq!(first.iter().flatten().count(), 4);
    assert_eq!(recording.other_movement.len(), 30);
    let error = read(path, file(&pulse[1500..])).unwrap_err().to_string();
    assert!(
        error.contains("expected 60 gestures marked, found 59"),
        "{error}"
    );
    let repacked = read("/d/s3/e2_emg.npy", array(900))
        .unwrap_err()
        .to_string();
    assert!(repacked.contains("e2_ann.npy beside it"), "{repacked}");
    assert!(Layout::is_of_labels(Path::new("/d/s3/e2_ann.npy")));
    let (copy, fields) = Layout::of(Path::new("/d/E2/s2e2.mat"), &file(&pulse)).unwrap();
    assert!(copy.is_copy(&fields));
}

#[test]
fn lines_of_myo_readings_end_and_are_spaced_either_way() {
    let text = "-3, 1, -2, 4, 0, 2, 0, -2, 0\r\n1,2,3,4,5,6,7,-128,7";
    let right = read("/d/12345-2/7.txt", text).unwrap();
    let samples = [[-3, 1, -2, 4, 0, 2, 0, -2], [1, 2, 3, 4, 5, 6, 7, -128]];
    assert_eq!(right.samples, samples);
    assert_eq!(right.labels, [RELAX, Some(Intent::Close)]);
    assert_eq!(right.full_name(), "myo-readings/12345/2/7");
    let left = read("/d/_readings_left_hand/12345-2/7.txt", text).unwrap();
    assert_eq!(left.samples[1], [7, 6, 5, 4, 3, 2, 1, -128]);
    assert_eq!(left.full_name(), "myo-readings/12345/left/2/7");
}

#[test]
fn a_lost_newline_of_myo_readings_names_its_line() {
    let text = "0,0,0,0,0,0,0,0,0\n4,2,1,0,-1,0,0,0,00,3,2,0,1,1,-1,0,0\n0,0,0,0,0,0,0,0,0\n";
    let error = |path| read(path, text).unwrap_err().to_string();
    let own = error("/d/19999-2/12.txt");
    assert!(
        own.ends_with("line 2: expected 9 values as in the rows before, found 17"),
        "{own}"
    );
    assert!(error("/d/19999-2/2.txt").ends_with("(damaged as published)"));
}

#[test]
fn beside_a_motion_outside_the_six_classes_rest_of_myo_readings_has_no_label() {
    let text = "0,0,0,0,0,0,0,0,0\n0,1,0,0,0,0,0,0,4\n";
    let recording = read("/d/12345-1/4.txt", text).unwrap();
    assert!(!recording.has_labels());
    let ulnar = Movement::new(MovementKind::UlnarDeviation, 1..2);
    assert_eq!(recording.other_movement, [ulnar]);
    let error = read("/d/12345-1/7.txt", "0,0,0,0,0,0,0,0,0\n0,1,0,0,0,0,0,0,8\n").unwrap_err();
    assert!(error.to_string().contains("line 2: "), "{error}");
}

#[test]
fn rows_of_myo_readings_doubled_by_fast_polling_are_dropped_with_their_labels() {
    let samples = crate::examiner::fixture::emg(4001, 1);
    let row = |at: usize| {
        let counts = samples[at - at / 5].map(|count| count.to_string() + ",");
        counts.concat() + if at < 2500 { "0\n" } else { "1\n" }
    };
    let text: String = (0..5000).map(row).collect();
    let recording = read("/d/69069-1/1.txt", text).unwrap();
    assert_eq!(recording.samples, samples);
    assert_eq!(recording.labels[2000..2002], [RELAX, Some(Intent::WaveIn)]);
    assert_eq!(recording.findings[0].kind, "polled");
}

#[test]
fn labels_known_to_drift_are_left_out_but_not_those_of_pure_rest() {
    let text = |label| format!("0,0,0,0,0,0,0,0,0\n0,1,0,0,0,0,0,0,{label}");
    let gesture = read("/d/35622-1/1.txt", text(1)).unwrap();
    assert!(!gesture.has_labels());
    assert_eq!(gesture.notes.len(), 1);
    assert!(read("/d/35622-1/0.txt", text(0)).unwrap().has_labels());
}

#[test]
fn holds_of_one_subject_myo_are_known_by_their_samples() {
    let rows = b"1,2,3,4,5,6,7,-8\r\n".repeat(100);
    let path = Path::new("/d/trial_1/R_1_C_3.csv");
    assert!(Layout::of(path, &rows).is_none());
    // "foobarfo", by the reference implementation's rule.
    let naive = b"foobarfo"
        .iter()
        .fold(0xcbf2_9ce4_8422_2325_u64, |hash, &byte| {
            (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3)
        });
    let samples = [b"foobarfo".map(|byte| byte as i8)];
    assert_eq!(checksum(&samples), format!("{naive:016x}"));
    assert_eq!(checksum(&[]), "cbf29ce484222325");
    let read = |path: &str| {
        let own = LAYOUTS
            .iter()
            .find(|own| !own.checksums.is_empty())
            .unwrap();
        let path = Path::new(path);
        let fields = own.fields_of(&own.description.files, path).unwrap();
        own.read(path, &rows, &fields).unwrap().remove(0)
    };
    assert_eq!(
        read("/d/trial_2/R_1_C_3.csv").labels,
        [Some(Intent::WaveOut); 100]
    );
    let late = read("/d/trial_1/R_1_C_3.csv");
    assert_eq!(late.labels[59..61], [None, Some(Intent::WaveOut)]);
    assert_eq!(late.full_name(), "one-subject-myo/1/trial_1/R_1_C_3");
}

/// A file of `uci-gestures` of rows of a time, a count in all channels and a class.
fn uci(rows: impl IntoIterator<Item = (usize, i32, u8)>) -> String {
    let names: String = (1..=8)
        .map(|channel| format!("channel{channel}\t"))
        .collect();
    let row =
        |(time, count, class)| format!("{time}{}\t{class}\n", format!("\t{count}e-05").repeat(8));
    format!("time\t{names}class\n") + &rows.into_iter().map(row).collect::<String>()
}

#[test]
fn values_of_uci_gestures_are_counts_and_repeats_are_no_samples() {
    let text = uci([
        (1, -128, 0),
        (2, -128, 0),
        (6, 127, 2),
        (7, 127, 2),
        (11, 5, 5),
    ]);
    assert!(Layout::of(Path::new("/d/own.txt"), text.as_bytes()).is_none());
    let recording = read("/d/07/2_raw_data_13.txt", text).unwrap();
    assert_eq!(recording.samples, [[-128; 8], [5; 8], [5; 8]]);
    assert_eq!(recording.labels, [None, Some(Intent::Close), None]);
    assert_eq!(recording.full_name(), "uci-gestures/07/2");
    assert!(!recording.data_set.trained_by_default());
}

#[test]
fn times_of_uci_gestures_that_go_back_leap_or_last_too_long_are_refused() {
    let hours = (0..3602).map(|second| (1000 * second, (second % 2) as i32, 0));
    for (text, words) in [
        (
            uci([(5, 1, 0), (4, 2, 0)]),
            "line 3: expected times that rise",
        ),
        (
            uci([(5, 1, 0), (2000, 2, 0)]),
            "line 3: expected times that rise",
        ),
        (uci(hours), "at most 3600 s"),
    ] {
        let error = read("/d/07/2_raw_data_13.txt", text)
            .unwrap_err()
            .to_string();
        assert!(error.contains(words), "{error}");
    }
}
