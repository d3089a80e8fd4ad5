//! Tests with defective recordings, as files below a folder.

mod copies;
mod rows;

use std::f64::consts::TAU;

use shared::units::{CHANNELS, Sample};

use super::fixture::{csv, emg, with_column};
use crate::library::inspection::groups;
use crate::library::tests::folder;
use crate::{Library, LoadOptions, load};

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
    groups(library)
        .iter()
        .map(|group| group.finding.kind)
        .collect()
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
fn a_column_that_counts_is_no_channel() {
    for modulus in [100, 128, 256] {
        let counted = each(&emg(2000, 1), |at, mut sample| {
            sample[3] = (at % modulus) as u8 as i8;
            sample
        });
        assert!(
            refusal(&counts(&counted)).contains("counts in channel 4"),
            "{modulus}"
        );
    }
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
            let found = &groups(&library)[0].finding;
            assert_eq!(found.kind, "hum");
            let words = format!("at {hz} Hz, in {channels} of 8");
            assert!(found.what.contains(&words), "{}", found.what);
        }
    }
}

#[test]
fn every_channel_with_a_defect_is_named() {
    let told = |of: &dyn Fn(usize, Sample) -> Sample| -> Vec<String> {
        let found = groups(&one(&counts(&each(&emg(4000, 1), of))));
        found.iter().map(|own| own.finding.what.clone()).collect()
    };
    for (channels, words) in [
        (&[4][..], "channel 4 is silent"),
        (&[2, 8], "channels 2 and 8 are silent"),
        (&[2, 4, 6, 7], "channels 2, 4, 6 and 7 are silent"),
        (&[4, 5, 6, 7, 8], "channels 4 to 8 are silent"),
        (&[2, 4, 5, 6, 8], "channels 2, 4 to 6 and 8 are silent"),
    ] {
        let silent = |_, mut sample: Sample| {
            channels.iter().for_each(|channel| sample[channel - 1] = 0);
            sample
        };
        assert_eq!(told(&silent), [words]);
    }
    let saturated = |at: usize, mut sample: Sample| {
        if at.is_multiple_of(21) {
            (sample[0], sample[2]) = (127, -128);
        }
        sample
    };
    let words = "channels 1 and 3 are saturated in up to 5 % of the samples";
    assert_eq!(told(&saturated), [words]);
    let copied = |_, mut sample: Sample| {
        (sample[3], sample[6], sample[7]) = (sample[1], sample[1], sample[2]);
        sample
    };
    let words = "channels equal others: 4 as 2, 7 as 2, 8 as 3";
    assert_eq!(told(&copied), [words]);
    let single = each(&emg(2000, 1), |_, sample| [sample[3]; CHANNELS]);
    assert!(refusal(&counts(&single)).contains("found 1 with a signal"));
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
        (0..16)
            .map(|at| format!("{}_{}", ["left", "right"][at / 8], at % 8))
            .collect(),
        (0..16)
            .map(|at| format!("{}_emg{}", ["L", "R"][at / 8], at % 8 + 1))
            .collect(),
    ] {
        let rows = format!("0{}\n", ",1".repeat(16)).repeat(10);
        let text = format!("gt,{}\n{rows}", names.join(","));
        let refused = refusal(&text);
        assert!(
            refused.contains("2 armbands") && refused.contains(&names[8]),
            "{refused}"
        );
    }
    let wide = format!("{}\n", ["1"; 17].join(",")).repeat(100);
    assert!(refusal(&wide).contains("two armbands"));
    let array = crate::npy::encode("|i1", &[100, 16], &[1; 1600]);
    let folder = folder(&[("both.npy", array)]);
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
fn a_column_of_sides_is_one_of_armbands_only_if_it_changes_from_row_to_row() {
    let text = counts(&emg(4000, 1));
    let parts = with_column(&text, "hand", |row| {
        if row < 2000 { "open" } else { "closed" }.into()
    });
    assert_eq!(kinds(&one(&parts)), Vec::<&str>::new());
    let turns = with_column(&text, "side", |row| ["L", "R"][row % 2].into());
    assert!(refusal(&turns).contains("in column \"side\": L, R"));
}
