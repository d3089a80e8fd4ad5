//! Inputs of tests: synthetic EMG, tables of it, and folders of files.

use std::fmt::{Display, Write as _};
use std::ops::Range;

use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;
use rand_distr::StandardNormal;
use shared::intent::Intent;
use shared::units::{CHANNELS, Sample};
use tempfile::TempDir;

use crate::{DataSet, Library, LoadOptions, Recording, load, npy};

/// Labels of relax, open, close and wave-in.
pub(crate) const R: Option<Intent> = Some(Intent::Relax);
pub(crate) const O: Option<Intent> = Some(Intent::Open);
pub(crate) const C: Option<Intent> = Some(Intent::Close);
pub(crate) const W: Option<Intent> = Some(Intent::WaveIn);

/// Labels of runs, each of so many samples.
pub(crate) fn labels<L: Copy>(runs: &[(L, usize)]) -> Vec<L> {
    let runs = runs.iter();
    runs.flat_map(|&(label, count)| vec![label; count])
        .collect()
}

/// Two empty recordings of each person of a set.
pub(crate) fn people<T: Display>(
    set: DataSet,
    names: impl IntoIterator<Item = T>,
) -> Vec<Recording> {
    let person = |name: T| {
        let subject = format!("{}/{name}", set.name());
        vec![Recording::new(set, subject, Vec::new(), Vec::new()); 2]
    };
    names.into_iter().flat_map(person).collect()
}

/// Cells of a table, ` | ` between them, row by row.
pub(crate) fn cells<const N: usize>(table: &str) -> impl Iterator<Item = [&str; N]> {
    table.lines().map(|line| {
        let cells: Vec<&str> = line.split(" | ").map(str::trim).collect();
        cells.try_into().expect(line)
    })
}

/// Uniform noise of this amplitude at each sample.
pub(crate) fn noise(count: usize, seed: u64, amplitude: impl Fn(usize) -> f64) -> Vec<Sample> {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let mut sample = |most: f64| [(); CHANNELS].map(|()| random.random_range(-most..=most).round());
    (0..count)
        .map(|at| sample(amplitude(at)).map(|value| value as i8))
        .collect()
}

/// Noise of a muscle at rest, loud in these ranges.
pub(crate) fn muscle(count: usize, loud: &[Range<usize>]) -> Vec<Sample> {
    let is_loud = |at: usize| loud.iter().any(|range| range.contains(&at));
    noise(count, 1, |at| if is_loud(at) { 40.0 } else { 3.0 })
}

/// EMG of a person at 200 Hz, noise whose neighbours correlate as the armband's: two seconds of rest and two of a gesture in
/// turn. Another seed is another person.
pub(crate) fn emg(count: usize, seed: u64) -> Vec<Sample> {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let gains: [f64; CHANNELS] = std::array::from_fn(|channel| {
        let at = (channel as f64 + seed as f64 * 2.0) % 8.0;
        6.0 + 4.0 * (at - 4.0).abs()
    });
    let mut before = [0.0; CHANNELS];
    (0..count)
        .map(|at| {
            let active = at / 400 % 2 == 1;
            std::array::from_fn(|channel| {
                let noise: f64 = random.sample(StandardNormal);
                // A moving average: neighbours correlate at -0.29, nothing else does.
                let value = noise - 0.32 * before[channel];
                before[channel] = noise;
                let gain = if active { gains[channel] } else { 2.5 };
                (gain * value - 1.0).round().clamp(-128.0, 127.0) as i8
            })
        })
        .collect()
}

/// The label of each sample of [`emg`]: 2 at the gesture.
pub(crate) fn label(at: usize) -> usize {
    2 * (at / 400 % 2)
}

/// Rows of a text, each as `row` writes a sample and its number.
pub(crate) fn rows(samples: &[Sample], row: impl Fn(usize, &Sample) -> String) -> String {
    let rows = samples.iter().enumerate();
    rows.map(|(at, sample)| row(at, sample) + "\n").collect()
}

/// Samples as numpy's array (n, 8).
pub(crate) fn array(samples: &[Sample]) -> Vec<u8> {
    let counts = samples.iter().flatten().map(|count| count.cast_unsigned());
    npy::encode(
        "|i1",
        &[samples.len(), CHANNELS],
        &counts.collect::<Vec<u8>>(),
    )
}

/// Names of the columns in ReactEMG's layout.
pub(crate) const HEADER: &str = "gt,emg_0,emg_1,emg_2,emg_3,emg_4,emg_5,emg_6,emg_7\n";

/// Samples as a csv in ReactEMG's layout; `value` writes a count.
pub(crate) fn csv(samples: &[Sample], value: impl Fn(i8) -> String) -> String {
    let mut text = HEADER.to_owned();
    for (at, sample) in samples.iter().enumerate() {
        let _ = write!(text, "{}", label(at));
        for &count in sample {
            let _ = write!(text, ",{}", value(count));
        }
        text.push('\n');
    }
    text
}

/// Samples as a csv in ReactEMG's layout.
pub(crate) fn counts(samples: &[Sample]) -> String {
    csv(samples, |count| count.to_string())
}

/// Values as text, with a mark between them.
pub(crate) fn joined<T: ToString>(values: &[T], mark: &str) -> String {
    let values: Vec<String> = values.iter().map(T::to_string).collect();
    values.join(mark)
}

/// Table with a further column in front.
pub(crate) fn with_column(text: &str, name: &str, value: impl Fn(usize) -> String) -> String {
    let mut lines = text.lines();
    let header = lines.next().unwrap_or_default();
    let mut with = format!("{name},{header}\n");
    for (row, line) in lines.enumerate() {
        let _ = writeln!(with, "{},{line}", value(row));
    }
    with
}

/// A folder with these files in it.
pub(crate) fn folder<T: AsRef<[u8]>>(files: &[(&str, T)]) -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    for (name, bytes) in files {
        let path = folder.path().join(name);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, bytes).unwrap();
    }
    folder
}

/// Library that a folder of these files is read as.
pub(crate) fn read<T: AsRef<[u8]>>(files: &[(&str, T)]) -> Library {
    load(folder(files).path(), &LoadOptions::default()).unwrap()
}

/// Full names of the recordings.
pub(crate) fn names(library: &Library) -> Vec<String> {
    let recordings = library.recordings.iter();
    recordings.map(Recording::full_name).collect()
}
