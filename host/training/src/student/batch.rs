//! Batches of excerpts as tensors.

use burn::tensor::{Device, Int, Tensor, TensorData};
use shared::units::{CHANNELS, LOOK_BACK, PATCH, WINDOW_PATCHES};

use super::sequence::{Excerpt, Sequence};

/// A batch of excerpts: the student's input and the targets of its outputs.
///
/// An output is the head's estimate at one patch of the intent at that patch or at one of the five before.
pub struct Batch {
    /// Input, `[b, patches, 80]`.
    pub(super) emg: Tensor<3>,
    /// Output that the label asks for, 0 without a label, `[b, patches, 6, 1]`.
    pub(super) targets: Tensor<4, Int>,
    /// Weight of each output in the label loss, 0 where there is no label, `[b, patches, 6]`.
    pub(super) label_mask: Tensor<3>,
    /// Sum of the weights in the mean of the label loss.
    pub(super) labelled: f64,
    /// Weight of each output in the distillation loss, 0 where a teacher has no targets: in the context, for patches of the
    /// lead-in, and where targets are left to the labels ([`Sequence::labels_alone`]), `[b, patches, 6]`.
    pub(super) distillation_mask: Tensor<3>,
    /// Sum of the weights in the mean of the distillation loss.
    pub(super) distilled: f64,
    /// The teacher's logits of the recordings, if there are any, `[b, patches, 6, outputs of a row]`.
    pub(super) soft_targets: Option<Tensor<4>>,
}

/// Sizes of all batches of a training.
#[derive(Clone, Copy)]
pub(super) struct BatchShape {
    /// Number of patches of an excerpt.
    pub(super) patches: usize,
    /// Number of patches at the start of an excerpt whose outputs have no target, for lack of context.
    pub(super) context: usize,
    /// Number of outputs of a row: the classes and, if the model has it, other movement.
    pub(super) outputs: usize,
}

impl Batch {
    /// Assembles a batch; where a sequence ends before its excerpt, the rest is zeros without targets.
    pub(super) fn new(
        sequences: &[Sequence],
        excerpts: &[Excerpt],
        shape: BatchShape,
        device: &Device,
    ) -> Self {
        let BatchShape {
            patches,
            context,
            outputs: row_outputs,
        } = shape;
        let b = excerpts.len();
        let mut emg = Vec::with_capacity(b * patches * PATCH * CHANNELS);
        let mut targets = vec![0_i32; b * patches * LOOK_BACK];
        let mut label_mask = vec![0.0_f32; b * patches * LOOK_BACK];
        let mut logits = vec![0.0_f32; b * patches * LOOK_BACK * row_outputs];
        let mut distillation_mask = vec![0.0_f32; b * patches * LOOK_BACK];
        let (mut labelled, mut distilled) = (0.0, 0.0);
        for (row, excerpt) in excerpts.iter().enumerate() {
            let sequence = &sequences[excerpt.sequence];
            let end = (excerpt.start + patches).min(sequence.patches());
            excerpt
                .variation
                .write(&sequence.emg[excerpt.start * PATCH..end * PATCH], &mut emg);
            emg.resize((row + 1) * patches * PATCH * CHANNELS, 0.0);
            for patch in excerpt.start + context..end {
                for back in 0..LOOK_BACK {
                    // The lead-in repeats EMG of the stream, so it has no targets.
                    let Some(estimated) = patch
                        .checked_sub(back)
                        .filter(|&estimated| estimated >= WINDOW_PATCHES)
                    else {
                        continue;
                    };
                    let output = (row * patches + patch - excerpt.start) * LOOK_BACK + back;
                    if let Some(target) = sequence.targets[estimated] {
                        targets[output] = target as i32;
                        label_mask[output] = 1.0;
                        labelled += 1.0;
                    }
                    if sequence.labels_alone[estimated] {
                        continue;
                    }
                    distillation_mask[output] = 1.0;
                    distilled += 1.0;
                    if let Some(soft_targets) = &sequence.soft_targets {
                        logits[output * row_outputs..(output + 1) * row_outputs].copy_from_slice(
                            &soft_targets[patch - WINDOW_PATCHES][back][..row_outputs],
                        );
                    }
                }
            }
        }
        let outputs = [b, patches, LOOK_BACK];
        let has_teacher = sequences
            .iter()
            .any(|sequence| sequence.soft_targets.is_some());
        Self {
            emg: Tensor::from_data(TensorData::new(emg, [b, patches, PATCH * CHANNELS]), device),
            targets: Tensor::from_data(
                TensorData::new(targets, [b, patches, LOOK_BACK, 1]),
                device,
            ),
            label_mask: Tensor::from_data(TensorData::new(label_mask, outputs), device),
            labelled,
            distillation_mask: Tensor::from_data(
                TensorData::new(distillation_mask, outputs),
                device,
            ),
            distilled,
            soft_targets: has_teacher.then(|| {
                let shape = [b, patches, LOOK_BACK, row_outputs];
                Tensor::from_data(TensorData::new(logits, shape), device)
            }),
        }
    }
}

#[cfg(test)]
mod tests {
    use shared::intent::{Intent, Vocabulary};
    use shared::model::LookBackLogits;

    use super::*;
    use crate::optimization::read_back;
    use crate::student::sequence::sequences;
    use presets::augmentation::Variation;
    use recordings::corpus::{Corpus, Stream};

    const SHAPE: BatchShape = BatchShape {
        patches: 70,
        context: 3,
        outputs: 3,
    };

    /// Corpus of one stream of 20 patches: of one label, or of none and then with movement outside the vocabulary.
    fn corpus(label: Option<Intent>, other: bool) -> Corpus {
        let samples = 20 * PATCH;
        let mut stream = Stream::new(vec![[1; CHANNELS]; samples], vec![label; samples]);
        if label.is_none() {
            stream.other_movement.push(100..150);
        }
        Corpus {
            vocabulary: Vocabulary::Three,
            other,
            streams: vec![stream],
        }
    }

    /// A stream with a label, and soft targets whose first logit is the number of the patch.
    fn sequence() -> Vec<Sequence> {
        let soft_targets = (0..20)
            .map(|patch| {
                let mut logits = LookBackLogits::default();
                for logits in &mut logits {
                    logits[0] = patch as f32;
                }
                logits
            })
            .collect();
        let corpus = corpus(Some(Intent::Open), false);
        sequences(&corpus, Some(vec![soft_targets]), true)
    }

    #[test]
    fn movement_outside_the_vocabulary_is_the_output_after_the_classes() {
        let corpus = |other| {
            let mut corpus = corpus(None, other);
            corpus.streams[0].labels[..50].fill(Some(Intent::Open));
            corpus
        };
        let found =
            |other| sequences(&corpus(other), None, true)[0].targets[WINDOW_PATCHES..].to_vec();
        let mut expected = vec![None; 20];
        expected[..5].fill(Some(1));
        assert_eq!(found(false), expected);
        expected[10..15].fill(Some(3));
        assert_eq!(found(true), expected);
        let shape = BatchShape {
            outputs: 4,
            ..SHAPE
        };
        let sequence = sequences(&corpus(true), None, true);
        let batch = Batch::new(&sequence, &[excerpt(60)], shape, &Device::default());
        let targets: Vec<i32> = batch.targets.into_data().iter::<i32>().collect();
        // Each patch is estimated six times.
        assert_eq!(targets.iter().filter(|&&target| target == 3).count(), 5 * 6);
    }

    #[test]
    fn the_own_outputs_of_a_model_teach_no_other_movement() {
        let corpus = corpus(None, true);
        let shape = BatchShape {
            outputs: 4,
            ..SHAPE
        };
        let batch = |teacher_on_other| {
            let logits = vec![LookBackLogits::default(); 20];
            let sequences = sequences(&corpus, Some(vec![logits]), teacher_on_other);
            Batch::new(&sequences, &[excerpt(60)], shape, &Device::default())
        };
        let [all, own] = [true, false].map(batch);
        // Each of the five patches is estimated six times.
        assert_eq!((own.labelled, all.labelled), (30.0, 30.0));
        assert_eq!(all.distilled - own.distilled, 30.0);
        let mask: f32 = read_back(own.distillation_mask).iter().sum();
        assert_eq!(f64::from(mask), own.distilled);
    }

    fn excerpt(start: usize) -> Excerpt {
        Excerpt {
            sequence: 0,
            start,
            variation: Variation::NONE,
        }
    }

    #[test]
    fn targets_begin_after_the_lead_in_and_need_context() {
        let device = Device::default();
        let batch = Batch::new(&sequence(), &[excerpt(0), excerpt(62)], SHAPE, &device);
        // The first excerpt has 10 patches of the stream; its first five cannot look back on five others. The second one
        // has the last 18 patches of the stream, three of them context.
        let expected = (1 + 2 + 3 + 4 + 5 + 5 * 6) + (18 - 3) * 6;
        assert_eq!(batch.labelled, f64::from(expected));
        let mask = read_back(batch.label_mask);
        assert_eq!(mask.iter().sum::<f32>(), expected as f32);
        let second = &mask[70 * LOOK_BACK..];
        let is_masked = |part: &[f32]| part.iter().all(|&own| own == 0.0);
        assert!(is_masked(&second[..3 * LOOK_BACK]));
        assert!(is_masked(&second[18 * LOOK_BACK..]));
    }

    #[test]
    fn soft_targets_are_those_of_the_patch() {
        let device = Device::default();
        let batch = Batch::new(&sequence(), &[excerpt(62)], SHAPE, &device);
        assert_eq!(batch.distilled, batch.labelled);
        let masks = [batch.distillation_mask, batch.label_mask].map(read_back);
        assert_eq!(masks[0], masks[1]);
        let logits = read_back(batch.soft_targets.unwrap());
        for patch in 3..18 {
            for back in 0..LOOK_BACK {
                let output = patch * LOOK_BACK + back;
                assert_eq!(logits[output * 3], (62 + patch - WINDOW_PATCHES) as f32);
            }
        }
    }
}
