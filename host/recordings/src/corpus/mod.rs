//! Corpus of a training: streams of cleaned EMG with labels.

pub mod splice;

use std::ops::Range;

use shared::intent::{Intent, Vocabulary};
use shared::stream::preprocess::{Median, clean};
use shared::units::{CleanSample, PATCH, SAMPLE_RATE_HZ, Sample, WINDOW};

use crate::labels::runs::runs;
use crate::recording::Recording;
use crate::recording::daily_life::quiet;

/// One continuous stream: a recording, or pieces of one subject's recordings joined.
#[derive(Clone, Debug)]
pub struct Stream {
    /// Samples as the armband sends them, 200 Hz: input of most of the baselines.
    pub raw: Vec<Sample>,
    /// Cleaned samples.
    pub emg: Vec<CleanSample>,
    /// The intent at each sample, within the vocabulary; none where it is unknown.
    pub labels: Vec<Option<Intent>>,
    /// Movement outside the vocabulary, if it is a class: ranges of samples, in order.
    pub other_movement: Vec<Range<usize>>,
    /// Number of times that the stream counts where parts of streams are drawn at random.
    pub weight: usize,
}

impl Stream {
    /// Stream of samples, cleaned with the paper's median, with one label each and no movement outside the vocabulary.
    pub fn new(raw: Vec<Sample>, labels: Vec<Option<Intent>>) -> Self {
        Self {
            emg: clean(raw.iter().copied(), Median::Three).collect(),
            raw,
            labels,
            other_movement: Vec::new(),
            weight: 1,
        }
    }

    /// Stream of one person's daily life, all recordings joined, and its samples as a model takes them: relax where the
    /// muscles are quiet, otherwise movement outside the vocabulary.
    pub fn of_daily_life(recordings: &[&Recording], samples: Vec<Sample>) -> Self {
        let recorded = recordings.iter().flat_map(|recording| &recording.samples);
        let quiet = quiet(&recorded.copied().collect::<Vec<_>>());
        let relax = quiet.iter().map(|quiet| quiet.then_some(Intent::Relax));
        let active = runs(&quiet).into_iter().filter(|run| !run.label);
        Self {
            other_movement: active.map(|run| run.start..run.end).collect(),
            ..Self::new(samples, relax.collect())
        }
    }

    /// Whether most of each patch is movement outside the vocabulary; a partial last patch is left out.
    pub fn other_movement_patches(&self) -> Vec<bool> {
        let mut samples = vec![false; self.labels.len()];
        for range in &self.other_movement {
            samples[range.clone()].fill(true);
        }
        samples
            .chunks_exact(PATCH)
            .map(|patch| 2 * patch.iter().filter(|&&other| other).count() > PATCH)
            .collect()
    }
}

impl From<Recording> for Stream {
    /// Stream of a whole recording, whose [`other_movement`](Recording::other_movement) must be all movement outside
    /// the vocabulary that is a class.
    fn from(recording: Recording) -> Self {
        let movements = recording.other_movement.into_iter();
        Self {
            other_movement: movements.map(|movement| movement.samples).collect(),
            ..Self::new(recording.samples, recording.labels)
        }
    }
}

/// All streams of one side of a split.
#[derive(Clone, Debug)]
pub struct Corpus {
    /// The classes that labels are taken from.
    pub vocabulary: Vocabulary,
    /// Whether movement outside the vocabulary is a class of its own; otherwise it is unknown.
    pub other: bool,
    /// The streams; order is part of a run's reproducibility.
    pub streams: Vec<Stream>,
}

impl Corpus {
    /// Cleans all streams with this filter instead of the paper's.
    pub fn with_median(mut self, median: Median) -> Self {
        if median != Median::Three {
            for stream in &mut self.streams {
                stream.emg = clean(stream.raw.iter().copied(), median).collect();
            }
        }
        self
    }

    /// Duration of all streams, in seconds.
    pub fn seconds(&self) -> f64 {
        let samples: usize = self.streams.iter().map(|own| own.emg.len()).sum();
        samples as f64 / f64::from(SAMPLE_RATE_HZ)
    }
}

/// The label of most of a patch's samples; `None` if most are unlabelled.
fn patch_label(labels: &[Option<Intent>]) -> Option<Intent> {
    Intent::ALL.into_iter().find(|&intent| {
        let own = labels.iter().filter(|&&label| label == Some(intent));
        2 * own.count() > labels.len()
    })
}

/// The label of each patch; a partial last patch is left out.
pub fn patch_labels(labels: &[Option<Intent>]) -> Vec<Option<Intent>> {
    labels.chunks_exact(PATCH).map(patch_label).collect()
}

/// Stream with a full window in front: its first patch of 10 samples, sixty times.
///
/// Every model then has an output for every sample of a short recording. The lead-in is the first patch, which every
/// output of a model knows, so no output depends on samples after its own patch. docs/decisions.md has what was
/// measured.
pub fn padded(emg: &[CleanSample]) -> Vec<CleanSample> {
    lead_in(emg, WINDOW)
}

/// Stream of any kind with `length` samples in front: its first patch, repeated.
pub fn lead_in<T: Copy>(samples: &[T], length: usize) -> Vec<T> {
    let lead = &samples[..samples.len().min(PATCH)];
    lead.iter()
        .cycle()
        .take(if lead.is_empty() { 0 } else { length })
        .chain(samples)
        .copied()
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::catalogue::DataSet;

    #[test]
    fn daily_life_is_relax_where_the_muscles_are_quiet_and_other_movement_elsewhere() {
        let samples = crate::fixture::muscle(2000, std::slice::from_ref(&(800..1400)));
        let [first, second] = [0..1000, 1000..2000].map(|part| {
            let set = DataSet::named("adl");
            Recording::new(set, "adl/p01", samples[part].to_vec(), vec![None; 1000])
        });
        let stream = Stream::of_daily_life(&[&first, &second], samples);
        let [active] = &stream.other_movement[..] else {
            panic!("expected one stretch, found {:?}", stream.other_movement);
        };
        let is_near = active.start.abs_diff(800) < 20 && active.end.abs_diff(1400) < 20;
        assert!(is_near, "{active:?}");
        for (at, label) in stream.labels.iter().enumerate() {
            let expected = (!active.contains(&at)).then_some(Intent::Relax);
            assert_eq!(*label, expected, "sample {at}");
        }
    }

    #[test]
    fn a_patch_takes_the_label_of_its_majority() {
        let relax = Some(Intent::Relax);
        let close = Some(Intent::Close);
        let mut labels = [relax; 10];
        labels[..6].fill(close);
        assert_eq!(patch_label(&labels), close);
        labels[..5].fill(None);
        assert_eq!(patch_label(&labels), None);
    }
}
