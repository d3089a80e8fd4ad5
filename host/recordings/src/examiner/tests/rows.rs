//! Clocks, gaps and repeated rows.

use super::*;
use crate::catalogue::DataSet;
use crate::examiner::clock::Clock;
use crate::examiner::rows::JudgedRows;
use crate::fixture::label;
use crate::recording::Recording;
use crate::recording::movement::{Movement, MovementKind};

#[test]
fn a_clock_of_200_hz_is_taken_with_jitter_bursts_and_in_whole_seconds() {
    let text = counts(&emg(3000, 1));
    let ms = |row: usize| row as f64 * 5.0;
    let with = |name, clock: &dyn Fn(usize) -> f64| {
        let timed = with_column(&text, name, |row| format!("{:.0}", clock(row)));
        taken(&timed, 1, &[]);
    };
    with("time", &|row| 1.7e12 + ms(row) + (row * 7 % 13) as f64);
    // Two samples arrive together, up to 40 ms late.
    with("timestamp", &|row| {
        ms(row / 2 * 2) + (row / 2 * 31 % 40) as f64
    });
    with("unix", &|row| (1_444_331_136 + row / 200) as f64);
    with("counter", &|row| (row % 256) as f64);
}

#[test]
fn a_clock_is_read_in_every_unit_and_known_by_its_values_whatever_its_name() {
    let text = counts(&emg(6000, 1));
    let of_day = |ms: f64| {
        let seconds = ms / 1000.0;
        format!("10:{:02}:{:06.3}", (seconds / 60.0) as u32, seconds % 60.0)
    };
    let clocks: [(&str, &dyn Fn(f64) -> String); 14] = [
        ("time", &|ms| (1e6 + ms / 1000.0).to_string()),
        ("Timestamp", &|ms| (1e6 + ms).to_string()),
        ("timestamp", &|ms| (1.4e15 + ms * 1000.0).to_string()),
        ("t", &|ms| (1e6 + ms * 1e6).to_string()),
        ("time_ms", &|ms| (1e6 + ms).to_string()),
        ("time (s)", &|ms| (1e6 + ms / 1000.0).to_string()),
        ("sample", &|ms| (1e6 + ms / 5.0).to_string()),
        ("Zeit", &|ms| (ms / 1000.0).to_string()),
        ("x", &|ms| ms.to_string()),
        ("Spalte 1", &|ms| (ms * 1000.0).to_string()),
        ("", &|ms| format!("{:.0}", 1.7e18 + ms * 1e6)),
        ("Nummer", &|ms| (ms / 5.0).to_string()),
        ("wann", &|ms| "2024-02-29T".to_owned() + &of_day(ms) + "Z"),
        ("Uhrzeit", &of_day),
    ];
    for (name, clock) in clocks {
        let at = |period: f64, gap: f64| {
            with_column(&text, name, |row| {
                clock(row as f64 * period + if row < 2500 { 0.0 } else { gap })
            })
        };
        taken(&at(5.0, 0.0), 1, &[]);
        taken(&at(5.0, 30_000.0), 2, &["gap"]);
        refused(&at(10.0, 0.0), "200 rows a second");
    }
    // A column that does not rise evenly is no clock, whatever it means.
    for value in [
        |row: usize| row / 600,
        |row| row * row,
        |row| row * 7919 % 1000,
    ] {
        let column = |row| value(row).to_string();
        taken(&with_column(&text, "x", column), 1, &[]);
    }
    // A name that says time does not hide the clock beside it.
    let dated = with_column(&text, "date", |_| "2024-02-29".into());
    let both = with_column(&dated, "Zeit", |row| (row as f64 * 0.01).to_string());
    refused(&both, "found 100 by column \"Zeit\"");
}

#[test]
fn a_clock_that_says_nothing_is_told() {
    let text = counts(&emg(3000, 1));
    for value in ["7", "noon"] {
        let timed = with_column(&text, "time", |_| value.into());
        taken(&timed, 1, &["clock-unclear"]);
    }
}

#[test]
fn nothing_is_joined_across_a_gap() {
    let samples = emg(6000, 1);
    let text = counts(&samples);
    let seconds = |row: usize, gap: f64| (row as f64 * 0.005 + gap).to_string();
    let time = |row: usize| seconds(row, if row >= 2500 { 30.0 } else { 0.0 });
    let library = one(&with_column(&text, "time", time));
    assert_eq!(names(&library), ["own/anna/anna_1.1", "own/anna/anna_1.2"]);
    assert_eq!(library.recordings[0].samples, samples[..2500]);
    assert_eq!(library.recordings[1].samples, samples[2500..]);
    assert!(first(&library).contains("30.00 s at row 2501"));
    let count = |row: usize| (row + row / 3000 * 40).to_string();
    taken(&with_column(&text, "sample", count), 2, &["gap"]);
    // Back to the beginning: two files joined.
    let back = |row: usize| seconds(row % 3000, 0.0);
    taken(&with_column(&text, "time", back), 2, &["gap"]);
    // A gap every second leaves no window.
    let torn = |row: usize| seconds(row, (row / 200) as f64 * 0.3);
    refused(&with_column(&text, "time", torn), "leaps 29 times");
}

#[test]
fn even_repeats_are_dropped_with_their_labels_if_200_hz_is_left() {
    let samples = emg(4000, 1);
    for (times, every) in [(3, 1), (2, 1), (2, 4), (5, 1)] {
        let rows: Vec<usize> = (0..samples.len())
            .flat_map(|at| vec![at; if at % every == every - 1 { times } else { 1 }])
            .collect();
        let polled: Vec<Sample> = rows.iter().map(|&at| samples[at]).collect();
        let text = counts(&polled);
        let mut lines = text.lines();
        let head = lines.next().unwrap().to_owned() + "\n";
        let labelled = rows.iter().zip(lines).fold(head, |text, (&at, line)| {
            let (_, channels) = line.split_once(',').unwrap();
            text + &format!("{},{channels}\n", label(at))
        });
        let library = one(&labelled);
        assert_eq!(kinds(&library), ["polled"], "{times} {every}");
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
    refused(&counts(&held), "samples are missing");
    let random = |percent: u64| -> Vec<Sample> {
        let mut seed = 7_u64;
        let mut from = 0;
        let drawn = (0..samples.len()).map(|at| {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            if seed >> 33 > (1 << 31) / 100 * percent || at == 0 {
                from = at;
            }
            samples[from]
        });
        drawn.collect()
    };
    refused(&counts(&random(30)), "in no pattern");
    taken(&counts(&random(6)), 1, &["repeats"]);
    // 66 Hz by the clock, each row three times.
    let thrice = each(&samples, |at, _| samples[at / 3]);
    let time = |row: usize| (row as f64 * 0.005).to_string();
    refused(&with_column(&counts(&thrice), "time", time), "3.00 times");
}

#[test]
fn every_second_sample_without_a_clock_and_a_standstill_are_told() {
    let samples = emg(12_000, 1);
    let half: Vec<Sample> = samples.iter().step_by(2).copied().collect();
    taken(&counts(&half), 1, &["unrelated-samples"]);
    let mut still = samples.clone();
    still[3000..4000].fill(samples[3000]);
    assert!(first(&one(&counts(&still))).contains("5.0 s from row 3001"));
}

#[test]
fn samples_that_resemble_the_next_are_told() {
    for (rows, own) in [(1200, 0.7), (4000, 0.8), (4000, 0.95)] {
        let mut before = [0.0; CHANNELS];
        let filtered = emg(rows, 1).into_iter().map(|sample| {
            before = std::array::from_fn(|at| own * before[at] + f64::from(sample[at]));
            before.map(|value| value.round() as i8)
        });
        let smooth: Vec<Sample> = filtered.collect();
        let library = one(&counts(&smooth));
        assert_eq!(kinds(&library)[0], "resembling-samples", "{own}");
        assert!(first(&library).contains("faster than 200 Hz"));
    }
}

#[test]
fn other_movement_goes_with_its_samples_where_a_gap_divides_them() {
    let text = counts(&emg(3000, 1));
    let seconds = |row: usize| row as f64 * 0.005 + if row < 1500 { 0.0 } else { 5.0 };
    let text = with_column(&text, "time", |row| seconds(row).to_string());
    let is_other = |row: usize| (1400..1600).contains(&row);
    let text = with_column(&text, "gt", |row| {
        if is_other(row) { "-2" } else { "0" }.into()
    });
    let recordings = one(&text).recordings;
    let found = recordings.into_iter().map(|own| own.other_movement);
    let other = |samples| vec![Movement::new(MovementKind::Other, samples)];
    let expected = [other(1400..1500), other(0..100)];
    assert_eq!(found.collect::<Vec<_>>(), expected);
}

#[test]
fn a_recording_is_cut_into_very_many_pieces() {
    let (whole, torn) = (1_000_000, 90_000);
    let rows = whole + torn;
    let samples = emg(rows, 1);
    let time = |row: usize| row as f64 * 0.005 + row.saturating_sub(whole - 1) as f64;
    let clock = Clock::of("time".to_owned(), false, (0..rows).map(time));
    let found = JudgedRows::of(&samples, clock.as_ref(), true).unwrap();
    let labels = vec![None; rows];
    let recording = Recording::new(DataSet::OWN, "anna", samples, labels);
    assert_eq!(found.apply(recording).len(), torn + 1);
}
