//! Tests with defective recordings, as files below a folder.

use std::f64::consts::TAU;
use std::fs;

use shared::units::{CHANNELS, Sample};
use tempfile::TempDir;

use super::fixture::{csv, emg, with_column};
use crate::library::inspection::groups;
use crate::{Library, LoadOptions, load};

/// A folder with these files in it.
fn folder(files: &[(&str, &str)]) -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    for (name, text) in files {
        let path = folder.path().join(name);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, text).unwrap();
    }
    folder
}

fn read(files: &[(&str, &str)]) -> Library {
    load(folder(files).path(), &LoadOptions::default()).unwrap()
}

fn one(text: &str) -> Library {
    read(&[("anna/anna_1.csv", text)])
}

fn counts(samples: &[Sample]) -> String {
    csv(samples, |count| count.to_string())
}

/// Kinds of the findings.
fn kinds(library: &Library) -> Vec<&'static str> {
    groups(library).iter().map(|group| group.kind).collect()
}

/// Message that refuses the only file.
fn refusal(text: &str) -> String {
    let library = one(text);
    assert!(library.recordings.is_empty(), "{:?}", kinds(&library));
    library.skipped[0].to_string()
}

/// Samples turned by a function of their number.
fn each(samples: &[Sample], of: impl Fn(usize, Sample) -> Sample) -> Vec<Sample> {
    let numbered = samples.iter().enumerate();
    numbered.map(|(at, &sample)| of(at, sample)).collect()
}

#[test]
fn a_recording_as_it_should_be_has_no_finding() {
    for seed in 0..5 {
        let library = one(&counts(&emg(12_000, seed)));
        assert_eq!((library.recordings.len(), kinds(&library)), (1, vec![]));
    }
}

#[test]
fn values_that_are_no_counts_are_refused_with_their_scale() {
    let samples = emg(2000, 1);
    let scaled = |factor: f64| csv(&samples, |count| (f64::from(count) * factor).to_string());
    for (factor, words) in [
        (1e-5, "0.00001 a count"),
        (1e-2, "millivolts"),
        (10.0, "microvolts"),
        (1.0 / 128.0, "divided by 128"),
        (1.0 / 127.0, "divided by 127"),
        (256.0, "bytes of each value exchanged"),
        (0.0078, "multiples of 0.0078"),
        (0.37, "filtered, normalized"),
    ] {
        let refusal = refusal(&scaled(factor));
        let whole = factor == 0.37 && refusal.contains("multiples of 0.37");
        assert!(refusal.contains(words) || whole, "{factor}: {refusal}");
        assert!(refusal.contains("-128 to 127"), "{refusal}");
    }
    let unsigned = refusal(&csv(&samples, |count| count.cast_unsigned().to_string()));
    assert!(unsigned.contains("subtract 256"), "{unsigned}");
    let offset = refusal(&csv(&samples, |count| (i16::from(count) + 128).to_string()));
    assert!(offset.contains("subtract 128"), "{offset}");
    let filtered = refusal(&csv(&samples, |count| {
        (f64::from(count).powi(3) / 97.0).to_string()
    }));
    assert!(filtered.contains("filtered"), "{filtered}");
}

#[test]
fn one_damaged_value_is_told_with_its_line_and_not_as_a_scale() {
    let text = counts(&emg(1000, 1)).replacen("\n0,", "\n0,500,", 1);
    let fields = refusal(&text);
    assert!(fields.contains("line 2"), "{fields}");
    let mut lines: Vec<String> = counts(&emg(1000, 1)).lines().map(str::to_owned).collect();
    lines[500] = "0,1,2,3,4,5,6,7,500".into();
    let range = refusal(&lines.join("\n"));
    assert!(
        range.contains("line 501") && range.contains("500"),
        "{range}"
    );
}

#[test]
fn values_on_one_side_and_those_that_never_change_are_refused() {
    let samples = emg(2000, 1);
    let rectified = each(&samples, |_, sample| {
        sample.map(|count| count.saturating_abs())
    });
    assert!(refusal(&counts(&rectified)).contains("rectified"));
    assert!(refusal(&counts(&[[0; CHANNELS]; 700])).contains("throughout"));
    assert!(refusal(&counts(&[[3; CHANNELS]; 700])).contains("throughout"));
}

#[test]
fn mains_hum_is_found_at_either_frequency_and_on_one_channel() {
    for hz in [50.0, 60.0] {
        for channels in [1, CHANNELS] {
            let hummed = each(&emg(6000, 2), |at, mut sample| {
                let hum = 20.0 * (TAU * hz * at as f64 / 200.0 + 0.4).sin();
                for count in &mut sample[..channels] {
                    *count = (f64::from(*count) + hum).clamp(-128.0, 127.0) as i8;
                }
                sample
            });
            let library = one(&counts(&hummed));
            let found = &groups(&library)[0];
            assert_eq!(found.kind, "hum");
            let words = format!("at {hz} Hz, in {channels} of 8");
            assert!(found.what.contains(&words), "{}", found.what);
        }
    }
}

#[test]
fn silent_saturated_and_copied_channels_are_found() {
    let broken = each(&emg(4000, 1), |at, mut sample| {
        sample[2] = -1;
        sample[5] = sample[4];
        if at % 21 == 0 {
            sample[7] = 127;
        }
        sample
    });
    let library = one(&counts(&broken));
    let mut kinds = kinds(&library);
    kinds.sort_unstable();
    assert_eq!(
        kinds,
        ["same-channel", "saturated-channel", "silent-channel"]
    );
    let single = each(&emg(2000, 1), |_, sample| [sample[3]; CHANNELS]);
    assert!(refusal(&counts(&single)).contains("found 1 with a signal"));
}

#[test]
fn rows_at_another_rate_are_refused_in_every_unit_of_time() {
    let text = counts(&emg(3000, 1));
    for (name, step) in [
        ("time", 0.01),
        ("Timestamp", 10.0),
        ("timestamp", 20_000.0),
        ("t", 20_000_000.0),
        ("time_ms", 2.0),
        ("time (s)", 0.02),
        ("sample", 2.0),
    ] {
        let clocked = with_column(&text, name, |row| (1e6 + row as f64 * step).to_string());
        let refusal = refusal(&clocked);
        assert!(refusal.contains("200 rows a second"), "{name}: {refusal}");
    }
    let dated = with_column(&text, "time", |row| {
        let ms = row * 10;
        format!("2024-02-29 23:59:{:02}.{:03}", ms / 1000, ms % 1000)
    });
    assert!(refusal(&dated).contains("found 100 by column \"time\""));
}

#[test]
fn a_clock_of_200_hz_is_taken_in_every_unit_with_jitter_and_bursts() {
    let text = counts(&emg(3000, 1));
    let ms = |row: usize| row as f64 * 5.0;
    let clocks: [(&str, &dyn Fn(usize) -> String); 7] = [
        ("time", &|row| (ms(row) / 1000.0).to_string()),
        ("timestamp", &|row| {
            (1_444_331_136_000_000.0 + ms(row) * 1000.0).to_string()
        }),
        ("time", &|row| {
            format!("{:.0}", 1.7e12 + ms(row) + (row * 7 % 13) as f64)
        }),
        // Two samples arrive together, up to 40 ms late.
        ("timestamp", &|row| {
            (ms(row / 2 * 2) + (row / 2 * 31 % 40) as f64).to_string()
        }),
        ("unix", &|row| (1_444_331_136 + row / 200).to_string()),
        ("index", &|row| row.to_string()),
        ("counter", &|row| (row % 256).to_string()),
    ];
    for (name, clock) in clocks {
        let library = one(&with_column(&text, name, clock));
        assert_eq!(library.recordings.len(), 1, "{name}: {:?}", library.skipped);
        assert_eq!(kinds(&library), Vec::<&str>::new(), "{name}");
    }
}

#[test]
fn a_clock_that_says_nothing_is_told() {
    let text = counts(&emg(3000, 1));
    for value in ["7", "noon"] {
        let library = one(&with_column(&text, "time", |_| value.into()));
        assert_eq!(kinds(&library), ["clock-unclear"]);
    }
}

#[test]
fn nothing_is_joined_across_a_gap() {
    let samples = emg(6000, 1);
    let time = |row: usize| {
        let gap = if row >= 2500 { 30.0 } else { 0.0 };
        (row as f64 * 0.005 + gap).to_string()
    };
    let library = one(&with_column(&counts(&samples), "time", time));
    let pieces: Vec<_> = library
        .recordings
        .iter()
        .map(|r| (r.full_name(), r.samples.len()))
        .collect();
    let expected = [
        ("react-emg/anna/anna_1.1".to_owned(), 2500),
        ("react-emg/anna/anna_1.2".to_owned(), 3500),
    ];
    assert_eq!(pieces, expected);
    assert_eq!(library.recordings[1].samples, samples[2500..]);
    let what = &groups(&library)[0].what;
    assert!(what.contains("30.00 s at row 2501"), "{what}");
    let counted = with_column(&counts(&samples), "sample", |row| {
        (row + row / 3000 * 40).to_string()
    });
    assert_eq!(one(&counted).recordings.len(), 2);
    // Back to the beginning: two files joined.
    let back = with_column(&counts(&samples), "time", |row| {
        (row as f64 % 3000.0 * 0.005).to_string()
    });
    assert_eq!(one(&back).recordings.len(), 2);
    // A gap every second leaves no window.
    let torn = with_column(&counts(&samples), "time", |row| {
        (row as f64 * 0.005 + (row / 200) as f64 * 0.3).to_string()
    });
    assert!(refusal(&torn).contains("leaps 29 times"));
}

#[test]
fn even_repeats_are_dropped_with_their_labels_if_200_hz_is_left() {
    let samples = emg(4000, 1);
    for (times, every) in [(3, 1), (2, 1), (2, 4), (5, 1)] {
        let rows: Vec<usize> = (0..samples.len())
            .flat_map(|at| vec![at; if at % every == every - 1 { times } else { 1 }])
            .collect();
        let polled: Vec<Sample> = rows.iter().map(|&at| samples[at]).collect();
        let mut text = counts(&polled);
        let labels = |at: usize| super::fixture::label(rows[at]);
        let lines = text.lines().skip(1).enumerate();
        text = lines.fold(
            text.lines().next().unwrap().to_owned() + "\n",
            |text, (at, line)| {
                text + &format!("{},{}\n", labels(at), line.split_once(',').unwrap().1)
            },
        );
        let library = one(&text);
        assert_eq!(
            kinds(&library),
            ["polled"],
            "{times} {every}: {:?}",
            library.skipped
        );
        let plain = &one(&counts(&samples)).recordings[0];
        assert_eq!(library.recordings[0].samples, plain.samples);
        assert_eq!(library.recordings[0].labels, plain.labels);
    }
}

#[test]
fn repeats_are_refused_where_samples_are_missing() {
    let samples = emg(8000, 1);
    // Every second sample, twice; and at random.
    let held = each(&samples, |at, _| samples[at / 2 * 2]);
    assert!(refusal(&counts(&held)).contains("samples are missing"));
    let random = |percent: u64| -> Vec<Sample> {
        let mut seed = 7_u64;
        let mut from = 0;
        each(&samples, |at, _| {
            let _ = at;
            [0; 8]
        })
        .iter()
        .enumerate()
        .map(|(at, _)| {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            if seed >> 33 > (1 << 31) / 100 * percent || at == 0 {
                from = at;
            }
            samples[from]
        })
        .collect()
    };
    assert!(refusal(&counts(&random(30))).contains("in no pattern"));
    assert_eq!(kinds(&one(&counts(&random(6)))), ["repeats"]);
    // 66 Hz by the clock, each row three times.
    let thrice = each(&samples, |at, _| samples[at / 3]);
    let clocked = with_column(&counts(&thrice), "time", |row| {
        (row as f64 * 0.005).to_string()
    });
    assert!(refusal(&clocked).contains("3.00 times"));
}

#[test]
fn every_second_sample_without_a_clock_and_a_standstill_are_told() {
    let samples = emg(12_000, 1);
    let half: Vec<Sample> = samples.iter().step_by(2).copied().collect();
    assert_eq!(kinds(&one(&counts(&half))), ["unrelated-samples"]);
    let still = each(&samples, |at, sample| {
        if (3000..4000).contains(&at) {
            samples[3000]
        } else {
            sample
        }
    });
    let what = groups(&one(&counts(&still)))[0].what.clone();
    assert!(what.contains("5.0 s from row 3001"), "{what}");
}

#[test]
fn two_armbands_are_refused_however_they_are_written() {
    let (left, right) = (emg(2000, 1), emg(2000, 2));
    let turns = |rows: usize| -> Vec<Sample> {
        let left = left.chunks(rows);
        left.zip(right.chunks(rows))
            .flat_map(|(l, r)| [l, r].concat())
            .collect()
    };
    let named = with_column(&counts(&turns(1)), "device", |row| {
        ["left", "right"][row % 2].into()
    });
    let refused = refusal(&named);
    assert!(
        refused.contains("in column \"device\": left, right"),
        "{refused}"
    );
    for rows in [1, 2] {
        let refused = refusal(&counts(&turns(rows)));
        assert!(refused.contains(&format!("{rows} of each")), "{refused}");
    }
    let one_device = with_column(&counts(&left), "device", |_| "left".into());
    assert_eq!(kinds(&one(&one_device)), Vec::<&str>::new());
    for names in [
        (0..16).map(|at| format!("emg_{at}")).collect::<Vec<_>>(),
        ["left", "right"]
            .iter()
            .flat_map(|side| (0..8).map(move |at| format!("{side}_{at}")))
            .collect(),
        ["L", "R"]
            .iter()
            .flat_map(|side| (1..=8).map(move |at| format!("{side}_emg{at}")))
            .collect(),
    ] {
        let text = format!(
            "gt,{}\n{}",
            names.join(","),
            format!("0{}\n", ",1".repeat(16)).repeat(10)
        );
        let refused = refusal(&text);
        assert!(
            refused.contains("2 armbands") && refused.contains(&names[8]),
            "{refused}"
        );
    }
    let wide = format!("{}\n", ["1"; 17].join(",")).repeat(100);
    assert!(refusal(&wide).contains("two armbands"));
    let array = crate::npy::encode("|i1", &[100, 16], &[1; 1600]);
    let folder = folder(&[]);
    fs::write(folder.path().join("both.npy"), array).unwrap();
    let library = load(folder.path(), &LoadOptions::default()).unwrap();
    assert!(library.skipped[0].to_string().contains("two armbands"));
}

#[test]
fn sensors_of_motion_beside_the_emg_are_no_second_armband() {
    let imu: Vec<String> = (0..10).map(|at| format!("imu_{at}")).collect();
    let text = with_column(&counts(&emg(2000, 1)), &imu.join(","), |_| {
        ["0.5"; 10].join(",")
    });
    assert_eq!(kinds(&one(&text)), Vec::<&str>::new());
}

#[test]
fn equal_samples_count_once_whatever_their_folder() {
    let text = counts(&emg(4000, 1));
    let other_labels = text.replace("\n2,", "\n1,");
    for copy in [
        "anna/.ipynb_checkpoints/anna_1-checkpoint.csv",
        "anna/anna_1 (conflicted copy).csv",
        "backup/anna/anna_1.csv",
        "anna/anna_0.csv",
    ] {
        let library = read(&[("anna/anna_1.csv", &text), (copy, &text)]);
        assert_eq!(
            (library.recordings.len(), library.repeats.len()),
            (1, 1),
            "{copy}"
        );
        if copy != "anna/anna_0.csv" {
            assert!(
                library.recordings[0].path.ends_with("anna/anna_1.csv"),
                "{copy}"
            );
        }
    }
    let library = read(&[
        ("anna/anna_1.csv", &text),
        ("anna/anna_2.csv", &other_labels),
    ]);
    assert!(groups(&library)[0].what.contains("other labels"));
    let library = read(&[("anna/anna_1.csv", &text), ("bob/bob_1.csv", &text)]);
    let found = &groups(&library)[0];
    assert!(
        found.what.contains("another person's name"),
        "{}",
        found.what
    );
    assert_eq!(found.severity, crate::Severity::Serious);
}

#[test]
fn a_part_of_a_recording_is_left_out_and_an_overlap_is_told() {
    let samples = emg(8000, 1);
    let (whole, part) = (counts(&samples), counts(&samples[1003..4000]));
    let library = read(&[("anna/anna_1.csv", &whole), ("anna/anna_2.csv", &part)]);
    assert_eq!(
        (library.recordings.len(), kinds(&library)),
        (1, vec!["copy"])
    );
    let mut longer = samples[6000..].to_vec();
    longer.extend(emg(5000, 9));
    let library = read(&[
        ("anna/anna_1.csv", &whole),
        ("anna/anna_2.csv", &counts(&longer)),
    ]);
    assert_eq!(
        (library.recordings.len(), kinds(&library)),
        (2, vec!["overlap"])
    );
}

#[test]
fn different_recordings_of_one_person_are_no_copies() {
    let files: Vec<(String, String)> = (0..6)
        .map(|number| {
            (
                format!("anna/anna_{number}.csv"),
                counts(&emg(2000, number)),
            )
        })
        .collect();
    let files: Vec<(&str, &str)> = files
        .iter()
        .map(|(name, text)| (name.as_str(), text.as_str()))
        .collect();
    let library = read(&files);
    assert_eq!((library.recordings.len(), library.repeats.len()), (6, 0));
}

#[test]
fn a_column_of_sides_is_one_of_armbands_only_if_it_changes_from_row_to_row() {
    let text = counts(&emg(4000, 1));
    let parts = with_column(&text, "hand", |row| {
        if row < 2000 { "open" } else { "closed" }.into()
    });
    assert_eq!(kinds(&one(&parts)), Vec::<&str>::new());
    let turns = with_column(&text, "side", |row| ["L", "R"][row % 2].into());
    assert!(refusal(&turns).contains("in column \"side\": L, R"));
}

#[test]
fn columns_of_times_without_a_name_are_a_clock_too() {
    let numbered = |step: f64| -> String {
        let samples = emg(3000, 1);
        let row = |(at, sample): (usize, &Sample)| {
            let counts = sample.map(|count| count.to_string()).join(",");
            format!("{at},{:.3},{counts}\n", 100.0 + at as f64 * step)
        };
        samples.iter().enumerate().map(row).collect()
    };
    let read = |text: String| {
        let folder = folder(&[("anna.csv", &text)]);
        load(&folder.path().join("anna.csv"), &LoadOptions::default()).unwrap()
    };
    assert_eq!(kinds(&read(numbered(0.005))), Vec::<&str>::new());
    let slow = read(numbered(0.01)).skipped[0].to_string();
    assert!(slow.contains("found 100 by column \"number 2\""), "{slow}");
}
