//! Words of labels: how long each lasts, how loud the muscle is, and which are known.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use rayon::prelude::*;
use shared::units::{CHANNELS, SAMPLE_RATE_HZ};

use crate::description::Described;
use crate::description::pattern::Field;
use crate::description::rows::Rows;
use crate::labels::activity::activity;
use crate::labels::motion::Motion;
use crate::readers::label_file;

/// Samples of a word.
#[derive(Clone, PartialEq, Debug, Default)]
pub(super) struct Word {
    /// Files that have it.
    pub files: usize,
    samples: usize,
    /// Sum of the magnitudes of all channels.
    magnitude: f64,
}

impl Word {
    /// Seconds of the samples.
    pub fn seconds(&self) -> f64 {
        self.samples as f64 / f64::from(SAMPLE_RATE_HZ)
    }

    /// Mean magnitude in counts.
    pub fn level(&self) -> f64 {
        self.magnitude / (self.samples * CHANNELS).max(1) as f64
    }
}

/// Words of all files.
#[derive(Clone, PartialEq, Debug, Default)]
pub(super) struct Words {
    pub words: BTreeMap<String, Word>,
    /// Files with a gesture in their names, and how many of them show it between rests.
    pub gestures: usize,
    pub between_rests: usize,
    /// Files that cannot be read, and the first reason.
    pub unread: usize,
    pub first_reason: Option<String>,
}

impl Words {
    /// Words of the files that a description describes.
    pub fn of(described: &Described, files: &[PathBuf]) -> Self {
        let found: Vec<Self> = files
            .par_iter()
            .map(|file| Self::of_file(described, file))
            .collect();
        let mut all = Self::default();
        for own in found {
            for (word, counts) in own.words {
                let sum = all.words.entry(word).or_default();
                sum.files += counts.files;
                sum.samples += counts.samples;
                sum.magnitude += counts.magnitude;
            }
            all.gestures += own.gestures;
            all.between_rests += own.between_rests;
            all.unread += own.unread;
            all.first_reason = all.first_reason.or(own.first_reason);
        }
        all
    }

    fn of_file(described: &Described, file: &Path) -> Self {
        let mut own = Self::default();
        let Some(fields) = described.fields_of(file) else {
            return own;
        };
        let Rows {
            samples, labels, ..
        } = match described.rows(file, &fields) {
            Ok(rows) => rows,
            Err(error) => {
                own.unread = 1;
                own.first_reason = Some(error.line());
                return own;
            }
        };
        let Some(words) = labels.words else {
            return own;
        };
        for (word, _) in words.distinct() {
            own.words.entry(word.clone()).or_default().files = 1;
        }
        for (sample, &word) in samples.iter().zip(&words.at) {
            if let Some(counts) = own.words.get_mut(&words.distinct()[word].0) {
                let magnitudes = sample.iter().map(|value| f64::from(value.unsigned_abs()));
                counts.samples += 1;
                counts.magnitude += magnitudes.sum::<f64>();
            }
        }
        if let Some(word) = fields.get(Field::Gesture)
            && Motion::of_gesture(word) != Some(Motion::RELAX)
        {
            own.gestures = 1;
            own.between_rests = usize::from(activity(&samples).is_some());
        }
        own
    }

    /// Words in order: numbers by value, then the others.
    pub fn sorted(&self) -> Vec<&str> {
        let mut words: Vec<&str> = self.words.keys().map(String::as_str).collect();
        let value = |word: &str| word.parse::<f64>().unwrap_or(f64::INFINITY);
        words.sort_by(|a, b| value(a).total_cmp(&value(b)).then(a.cmp(b)));
        words
    }

    /// Words by class; those that nobody knows under unknown. In a column gt, numbers are ReactEMG's.
    pub fn by_class(&self, column: Option<&str>) -> BTreeMap<&'static str, Vec<&str>> {
        let mut classes: BTreeMap<&'static str, Vec<&str>> = BTreeMap::new();
        let motion = |word: &str| match column {
            Some("gt") => label_file::from_text(word).ok(),
            _ => Motion::of_gesture(word).or_else(|| Motion::from_name(word)),
        };
        for word in self.sorted() {
            let name = motion(word).unwrap_or(Motion::Unknown).name();
            classes.entry(name).or_default().push(word);
        }
        classes
    }
}
