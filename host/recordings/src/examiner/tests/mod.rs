//! Tests with defective recordings, as files below a folder.

mod copies;
mod rows;

use std::f64::consts::TAU;

use shared::units::{CHANNELS, Sample};

use crate::Library;
use crate::fixture::{counts, csv, emg, names, read, with_column};
use crate::library::inspection::groups;

fn one(text: &str) -> Library {
    read(&[("anna/anna_1.csv", text)])
}

/// Kinds of the findings.
fn kinds(library: &Library) -> Vec<&'static str> {
    let found = groups(library);
    found.iter().map(|group| group.finding.kind).collect()
}

/// Words of the first finding.
fn first(library: &Library) -> String {
    groups(library)[0].finding.what.clone()
}

/// Asserts that a table is refused in these words.
fn refused(text: &str, words: &str) {
    let library = one(text);
    let told = library.skipped.first().map(ToString::to_string);
    let told = told.unwrap_or_else(|| format!("taken, with {:?}", kinds(&library)));
    assert!(told.contains(words), "{words}: {told}");
}

/// Asserts that a table is read as so many recordings, with findings of these kinds.
fn taken(text: &str, recordings: usize, kinds: &[&str]) {
    let library = one(text);
    let found = (library.recordings.len(), self::kinds(&library));
    assert_eq!(found, (recordings, kinds.to_vec()), "{:?}", library.skipped);
}

/// Samples turned by a function of their number.
fn each(samples: &[Sample], of: impl Fn(usize, Sample) -> Sample) -> Vec<Sample> {
    let numbered = samples.iter().enumerate();
    numbered.map(|(at, &sample)| of(at, sample)).collect()
}

#[test]
fn a_recording_as_it_should_be_has_no_finding() {
    for seed in 0..5 {
        taken(&counts(&emg(12_000, seed)), 1, &[]);
    }
}

#[test]
fn values_that_are_no_counts_are_refused_with_their_scale() {
    let samples = emg(2000, 1);
    for (factor, words) in [
        (1e-5, "0.00001 a count"),
        (1e-2, "millivolts"),
        (10.0, "microvolts"),
        (1.0 / 128.0, "divided by 128"),
        (1.0 / 127.0, "divided by 127"),
        (256.0, "bytes of each value exchanged"),
        (0.0078, "multiples of 0.0078"),
        (0.37, "multiples of 0.37"),
    ] {
        let scaled = csv(&samples, |count| (f64::from(count) * factor).to_string());
        refused(&scaled, words);
        refused(&scaled, "whole numbers from -128 to 127");
    }
    let unsigned = csv(&samples, |count| count.cast_unsigned().to_string());
    refused(&unsigned, "subtract 256");
    let offset = csv(&samples, |count| (i16::from(count) + 128).to_string());
    refused(&offset, "subtract 128");
    let cubes = csv(&samples, |count| {
        (f64::from(count).powi(3) / 97.0).to_string()
    });
    refused(&cubes, "filtered, normalized");
}

#[test]
fn values_on_one_side_and_those_that_never_change_are_refused() {
    let rectified = each(&emg(2000, 1), |_, own| own.map(i8::saturating_abs));
    refused(&counts(&rectified), "rectified");
    for value in [0, 3] {
        refused(&counts(&[[value; CHANNELS]; 700]), "throughout");
    }
}

#[test]
fn a_column_that_counts_is_no_channel() {
    for modulus in [100, 128, 256] {
        let counted = each(&emg(2000, 1), |at, mut sample| {
            sample[3] = (at % modulus) as u8 as i8;
            sample
        });
        refused(&counts(&counted), "counts in channel 4");
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
    refused(&counts(&single), "found 1 with a signal");
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
    let device = |row: usize| ["left", "right"][row % 2].to_owned();
    let named = with_column(&counts(&turns(1)), "device", device);
    refused(&named, "in column \"device\": left, right");
    for rows in [1, 2] {
        refused(&counts(&turns(rows)), &format!("{rows} of each"));
    }
    let one_device = with_column(&counts(&left), "device", |_| "left".into());
    taken(&one_device, 1, &[]);
    let wide = format!("{}\n", ["1"; 17].join(",")).repeat(100);
    refused(&wide, "two armbands");
    let array = crate::npy::encode("|i1", &[100, 16], &[1; 1600]);
    let told = read(&[("both.npy", array)]).skipped[0].to_string();
    assert!(told.contains("two armbands"), "{told}");
}

#[test]
fn a_column_of_sides_is_one_of_armbands_only_if_it_changes_from_row_to_row() {
    let text = counts(&emg(4000, 1));
    let part = |row: usize| ["open", "closed"][row / 2000].to_owned();
    taken(&with_column(&text, "hand", part), 1, &[]);
    let turns = with_column(&text, "side", |row| ["L", "R"][row % 2].into());
    refused(&turns, "in column \"side\": L, R");
}
