//! Batches of training examples as tensors.

use burn::tensor::{Device, Int, Tensor, TensorData};
use rand::RngExt;
use shared::units::CHANNELS;

use super::model::TeacherInput;
use super::window::{Example, WindowShape, last_before_change};
use presets::augmentation::{Augmentation, Variation};
use presets::masking::Masks;
use recordings::corpus::Corpus;

/// A batch of examples: the model's input and the targets of its outputs.
#[derive(Debug)]
pub struct Batch {
    /// The model's input.
    pub input: TeacherInput,
    /// Unmasked EMG without companding, `[b, tokens, patch * 8]`.
    pub emg_target: Tensor<3>,
    /// Number of values in the EMG loss.
    pub emg_cells: usize,
    /// Class of each sample, 0 where it has no weight, `[b, window]`.
    pub intent_target: Tensor<2, Int>,
    /// Weight of each sample in the intent loss, 1 or 0, `[b, window]`.
    pub intent_weight: Tensor<2>,
    /// Number of samples in the intent loss.
    pub intent_samples: usize,
}

impl Batch {
    /// Assembles a batch; masks and variations are drawn in the order of the examples.
    pub(super) fn new(
        corpus: &Corpus,
        examples: &[Example],
        shape: WindowShape,
        augmentation: Option<&Augmentation>,
        rng: &mut impl RngExt,
        device: &Device,
    ) -> Self {
        let classes = corpus.vocabulary.classes();
        let (b, tokens) = (examples.len(), shape.tokens());
        let WindowShape { window, patch } = shape;
        let mut emg = Vec::with_capacity(b * window * CHANNELS);
        let mut emg_mask = Vec::with_capacity(b * tokens);
        let mut intent = vec![0.0_f32; b * tokens * (classes + 1)];
        let mut target = Vec::with_capacity(b * window);
        let mut weight = Vec::with_capacity(b * window);
        let mut blocked = Vec::with_capacity(b);

        for (row, example) in examples.iter().enumerate() {
            let labels = example.window.labels(corpus, window);
            let masks = example.task.draw(window, last_before_change(labels), rng);
            let variation =
                augmentation.map_or(Variation::NONE, |augmentation| augmentation.draw(rng));
            let stream = &corpus.streams[example.window.stream];
            let samples = &stream.emg[example.window.start..example.window.start + window];
            variation.write(samples, &mut emg);

            let Masks {
                emg: masked_emg,
                intent: masked_intent,
                blocked: block,
            } = masks;
            let masked_intent = whole_tokens(&masked_intent, patch);
            emg_mask.extend(
                masked_emg
                    .chunks(patch)
                    .map(|token| f32::from(u8::from(majority(token)))),
            );
            blocked.push(f32::from(u8::from(block)));
            for (sample, (&label, &masked)) in labels.iter().zip(&masked_intent).enumerate() {
                let seen = match label {
                    Some(intent) if !masked && !block => intent.class(),
                    _ => classes,
                };
                let token = row * tokens + sample / patch;
                intent[token * (classes + 1) + seen] += 1.0 / patch as f32;
                target.push(label.map_or(0, |intent| intent.class() as i32));
                weight.push(f32::from(u8::from(masked && label.is_some())));
            }
        }

        let intent_samples = weight.iter().filter(|&&weight| weight > 0.0).count();
        let emg_cells = emg_mask.iter().filter(|&&masked| masked > 0.0).count() * patch * CHANNELS;
        let any_blocked = blocked.iter().any(|&block| block > 0.0);
        let emg = Tensor::from_data(TensorData::new(emg, [b, tokens, patch * CHANNELS]), device);
        let intent = Tensor::from_data(TensorData::new(intent, [b, tokens, classes + 1]), device);
        Self {
            input: TeacherInput {
                emg: emg.clone(),
                emg_mask: Tensor::from_data(TensorData::new(emg_mask, [b, tokens, 1]), device),
                intent,
                blocked: any_blocked
                    .then(|| Tensor::from_data(TensorData::new(blocked, [b]), device)),
            },
            emg_target: emg,
            emg_cells,
            intent_target: Tensor::from_data(TensorData::new(target, [b, window]), device),
            intent_weight: Tensor::from_data(TensorData::new(weight, [b, window]), device),
            intent_samples,
        }
    }
}

/// Extends a mask drawn on samples to whole tokens: a token is masked when at least half of its samples are.
fn whole_tokens(mask: &[bool], patch: usize) -> Vec<bool> {
    mask.chunks(patch)
        .flat_map(|token| std::iter::repeat_n(majority(token), token.len()))
        .collect()
}

fn majority(token: &[bool]) -> bool {
    2 * token.iter().filter(|&&masked| masked).count() >= token.len()
}

#[cfg(test)]
mod tests {
    use rand::SeedableRng as _;
    use rand_chacha::ChaCha8Rng;
    use shared::intent::{Intent, Vocabulary};

    use super::*;
    use crate::optimization::read_back;
    use crate::teacher::window::examples;
    use presets::masking::Task;
    use recordings::corpus::Stream;

    #[test]
    fn windows_without_labels_are_trained_on_without_labels_alone() {
        let stream = |label| Stream::new(vec![[1; CHANNELS]; 700], vec![label; 700]);
        let corpus = Corpus {
            vocabulary: Vocabulary::Three,
            other: false,
            streams: vec![stream(None), stream(Some(Intent::Open))],
        };
        let tasks = [Task::Intent, Task::SelfSupervised];
        let examples = examples(&corpus, 100, 600, &tasks);
        let of = |stream| {
            let own = examples.iter().filter(move |e| e.window.stream == stream);
            own.map(|e| e.task).collect::<Vec<_>>()
        };
        assert_eq!(of(0), [Task::SelfSupervised; 2]);
        assert_eq!(of(1), [Task::Intent; 2]);

        let shape = WindowShape {
            window: 600,
            patch: 10,
        };
        let mut rng = ChaCha8Rng::seed_from_u64(1);
        let device = Device::default();
        let batch = Batch::new(&corpus, &examples, shape, None, &mut rng, &device);
        assert!(batch.emg_cells > 0);
        let blocked = read_back(batch.input.blocked.unwrap());
        assert_eq!(blocked, [1.0, 1.0, 0.0, 0.0]);
        let weights = read_back(batch.intent_weight);
        assert!(weights[..1200].iter().all(|&weight| weight == 0.0));
        let trained = weights[1200..].iter().filter(|&&weight| weight > 0.0);
        assert_eq!(batch.intent_samples, trained.count());
    }

    #[test]
    fn a_token_is_masked_when_half_of_it_is() {
        let masked = whole_tokens(&[true, false, false, false, true, true, true, true], 4);
        assert_eq!(masked, [false, false, false, false, true, true, true, true]);
        assert_eq!(whole_tokens(&[true, false], 2), [true, true]);
    }
}
