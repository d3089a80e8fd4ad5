//! Recordings that are not what they seem: none is read as if it were.

use std::fs;

use shared::units::Sample;

use super::fixture::{csv, emg, with_column};
use super::{Library, LoadOptions, load};

fn read(files: &[(&str, &str)]) -> Library {
    let folder = tempfile::tempdir().unwrap();
    for (name, text) in files {
        let path = folder.path().join(name);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, text).unwrap();
    }
    load(folder.path(), &LoadOptions::default()).unwrap()
}

fn one(text: &str) -> Library {
    read(&[("anna/anna_1.csv", text)])
}

fn counts(samples: &[Sample]) -> String {
    csv(samples, |count| count.to_string())
}

#[test]
fn volts_are_not_zeros_and_counts_over_128_are_not_out_of_range() {
    for factor in [1e-5, 1.0 / 128.0] {
        let library = one(&csv(&emg(2000, 1), |count| {
            (f64::from(count) * factor).to_string()
        }));
        assert!(library.recordings.is_empty());
        let refusal = library.skipped[0].to_string();
        assert!(refusal.contains("multiply by"), "{refusal}");
    }
}

#[test]
fn rows_that_come_three_times_are_samples_once() {
    let samples = emg(2000, 1);
    let thrice: Vec<Sample> = samples.iter().flat_map(|&sample| [sample; 3]).collect();
    assert_eq!(one(&counts(&thrice)).recordings[0].samples, samples);
}

#[test]
fn a_clock_of_100_hz_is_refused_and_a_gap_divides() {
    let text = counts(&emg(2000, 1));
    let slow = one(&with_column(&text, "time", |row| {
        (row as f64 * 0.01).to_string()
    }));
    assert!(slow.recordings.is_empty());
    let gap = |row: usize| row as f64 * 0.005 + if row < 900 { 0.0 } else { 30.0 };
    let torn = one(&with_column(&text, "time", |row| gap(row).to_string()));
    assert_eq!(torn.recordings.len(), 2);
}

#[test]
fn two_armbands_are_not_one() {
    let (left, right) = (emg(2000, 1), emg(2000, 2));
    let turns: Vec<Sample> = left
        .iter()
        .zip(&right)
        .flat_map(|(&l, &r)| [l, r])
        .collect();
    assert!(one(&counts(&turns)).recordings.is_empty());
}

#[test]
fn equal_samples_count_once() {
    let text = counts(&emg(2000, 1));
    let library = read(&[
        ("anna/anna_1.csv", &text),
        ("backup/anna/anna_1.csv", &text),
    ]);
    assert_eq!(library.recordings.len(), 1);
}
