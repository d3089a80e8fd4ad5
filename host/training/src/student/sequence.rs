//! Training sequences of a student, and the excerpts in batches.

use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use shared::intent::Intent;
use shared::model::LookBackLogits;
use shared::units::{CHANNELS, PATCH, WINDOW_PATCHES};

use presets::augmentation::Variation;
use presets::distillation::Distillation;
use recordings::corpus::{Corpus, padded, patch_labels};

/// Stream cut into patches, with a lead-in of one window in front.
pub(super) struct Sequence {
    pub(super) emg: Vec<[u8; CHANNELS]>,
    /// Output of a row that each patch's label asks for; none in the lead-in.
    pub(super) targets: Vec<Option<usize>>,
    /// Patches that are learnt from their labels alone, without the teacher.
    pub(super) labels_alone: Vec<bool>,
    /// Number of times that the sequence counts in a draw.
    weight: usize,
    /// The teacher's logits at every patch after the lead-in.
    pub(super) soft_targets: Option<Vec<LookBackLogits>>,
}

impl Sequence {
    pub(super) fn patches(&self) -> usize {
        self.targets.len()
    }
}

/// Builds the sequences of a corpus; `soft_targets` are the teacher's logits, stream by stream, which movement outside the vocabulary
/// has only with `teacher_on_other`.
pub(super) fn sequences(
    corpus: &Corpus,
    soft_targets: Option<Vec<Vec<LookBackLogits>>>,
    teacher_on_other: bool,
) -> Vec<Sequence> {
    let mut soft_targets = soft_targets.map(Vec::into_iter);
    let class_of_other = corpus.other.then(|| corpus.vocabulary.classes());
    corpus
        .streams
        .iter()
        .map(|stream| {
            let own = patch_labels(&stream.labels);
            let others = stream.other_movement_patches();
            let target = |(label, &other): (Option<Intent>, &bool)| match class_of_other {
                Some(class) if other => Some(class),
                _ => label.map(Intent::class),
            };
            let whole = own.len() * PATCH;
            let unknown = std::iter::repeat_n(None, WINDOW_PATCHES);
            let labels_alone = others.iter().map(|&other| other && !teacher_on_other);
            Sequence {
                weight: stream.weight,
                labels_alone: std::iter::repeat_n(false, WINDOW_PATCHES)
                    .chain(labels_alone)
                    .collect(),
                emg: padded(&stream.emg[..whole]),
                targets: unknown
                    .chain(own.into_iter().zip(&others).map(target))
                    .collect(),
                soft_targets: soft_targets
                    .as_mut()
                    .map(|streams| streams.next().unwrap_or_default()),
            }
        })
        .filter(|sequence| sequence.patches() > WINDOW_PATCHES)
        .collect()
}

/// Part of a sequence, and the variation of its EMG.
#[derive(Clone, Copy)]
pub struct Excerpt {
    /// Index of the sequence.
    pub(super) sequence: usize,
    /// Index of the first patch.
    pub(super) start: usize,
    pub(super) variation: Variation,
}

impl Excerpt {
    /// Draws an excerpt of `config.patches` patches.
    pub(super) fn draw(
        sequences: &[Sequence],
        config: &Distillation,
        rng: &mut ChaCha8Rng,
    ) -> Self {
        // Uniform over all patches, so that a sequence is drawn in proportion to its length and weight.
        let counted = |sequence: &Sequence| sequence.weight * sequence.patches();
        let total = sequences.iter().map(counted).sum();
        let mut patch = rng.random_range(0..total);
        let mut sequence = 0;
        while patch >= counted(&sequences[sequence]) {
            patch -= counted(&sequences[sequence]);
            sequence += 1;
        }
        let last_start = sequences[sequence].patches().saturating_sub(config.patches);
        let variation = match &config.augmentation {
            Some(augmentation) => augmentation.draw(rng),
            None => Variation::NONE,
        };
        Self {
            sequence,
            start: rng.random_range(0..=last_start),
            variation,
        }
    }
}
